// Broadphases of other libraries as contestants of the broadphase benchmark: those whose headers are there.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "scene.hpp"

#if __has_include(<BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>)
#include "peer_bullet.hpp"
#endif
#if __has_include(<box2d/b2_broad_phase.h>)
#include "peer_box2d.hpp"
#endif
#if __has_include(<embree3/rtcore.h>)
#include "peer_embree.hpp"
#endif

namespace bench {

template <int D>
void add_peers([[maybe_unused]] std::vector<contestant>& to) {
    if constexpr (D == 3) {
#if __has_include(<BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>)
        to.push_back({"bullet_dbvt", "float", 100'000, make<bullet<btDbvtBroadphase>>});
        // Inserting is quadratic.
        to.push_back({"bullet_sweep32", "float", 10'000, make<bullet<bt32BitAxisSweep3>>});
        to.push_back({"bullet_sweep16", "float", 10'000, make<bullet<btAxisSweep3>>});
#endif
#if __has_include(<embree3/rtcore.h>)
        to.push_back({"embree", "float", 4'000'000, make<embree>});
#endif
    } else {
#if __has_include(<box2d/b2_broad_phase.h>)
        to.push_back({"box2d_2.4", "float", 100'000, make<box2d>});
#endif
    }
}

}  // namespace bench
