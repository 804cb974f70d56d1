// expect: physics::user_types: a type is not plain; it must be trivially copyable and have a default value
#include <physics.hpp>
#include <string>

struct mine : physics::recipe<float, 2, physics::user_types<std::string>> {};

physics::world<mine> world;
