// expect: physics::events: an argument is not an event; the events are those of namespace physics::event
#include <physics.hpp>

struct explosion {};
struct mine : physics::recipe<float, 2, physics::events<physics::event::contact, explosion>> {};

physics::world<mine> world;
