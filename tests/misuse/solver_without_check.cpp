// expect: physics::recipe: the solver's in<Space, Features> needs a struct settings with a function check, and a function solve
#include <physics.hpp>

struct plain {
    using stage = physics::stage::solver;
    template <class Space, class Features>
    struct in {
        struct settings {
            int iterations = 4;
        };
        template <class... Arguments>
        static void solve(Arguments&&...);
    };
};
struct mine : physics::recipe<float, 2, plain> {};

physics::world<mine> world;
