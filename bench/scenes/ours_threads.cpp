// The library in float on two threads: the same bits as on one.
#define PHYSICS_HPP_THREADS
#include "ours.hpp"

namespace bench {

namespace {

struct by_two {
    physics::thread_pool pool{2};

    template <class World, class S>
    void step(World& w, S dt) {
        w.step(dt, pool);
    }
};

const enlisted threads({.name = "ours-2",
                        .settings = "as ours, by a thread_pool of two; times are those of the caller, who never sleeps",
                        .order = 3,
                        .make = make_ours<float, physics::soft_step, by_two>});

}  // namespace

}  // namespace bench
