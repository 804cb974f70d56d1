// expect: physics::recipe: the solver's in<Space, Features> needs a struct settings with a function check, and a function solve
#include <physics.hpp>

struct lazy {
    using stage = physics::stage::solver;
    template <class Space, class Features>
    struct in {
        using settings = physics::sequential_impulse_settings<typename Space::scalar>;
    };
};
struct mine : physics::recipe<float, 2, lazy> {};

physics::world<mine> world;
