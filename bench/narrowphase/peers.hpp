// Narrowphases of other libraries as contestants of the narrowphase benchmark: those whose headers are there.
#pragma once

#include <memory>
#include <vector>

#include "scene.hpp"

#if __has_include(<BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>)
#include "peer_bullet.hpp"
#endif
#if __has_include(<fcl/narrowphase/detail/gjk_solver_libccd.h>)
#include "peer_fcl.hpp"
#endif
#if __has_include(<ccd/ccd.h>)
#include "peer_ccd.hpp"
#endif
#if __has_include(<box2d/b2_distance.h>)
#include "peer_box2d.hpp"
#endif

namespace bench {

inline void add_peers([[maybe_unused]] std::vector<contestant>& to) {
#if __has_include(<BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>)
    to.push_back({"bullet_detector", "float", std::make_unique<bullet_detector>()});
    to.push_back({"bullet_epa2", "float", std::make_unique<bullet_epa2>()});
    to.push_back({"bullet_boxes", "float", std::make_unique<bullet_boxes>()});
#endif
#if __has_include(<fcl/narrowphase/detail/gjk_solver_libccd.h>)
    to.push_back({"fcl_libccd", "double", std::make_unique<fcl_solver<fcl::detail::GJKSolver_libccdd>>()});
    to.push_back({"fcl_indep", "double", std::make_unique<fcl_solver<fcl::detail::GJKSolver_indepd>>()});
#endif
#if __has_include(<ccd/ccd.h>)
    to.push_back({"libccd_gjk", "double", std::make_unique<ccd_solver>(false)});
    to.push_back({"libccd_mpr", "double", std::make_unique<ccd_solver>(true)});
#endif
#if __has_include(<box2d/b2_distance.h>)
    to.push_back({"box2d_2.4", "float", std::make_unique<box2d_solver>()});
#endif
}

}  // namespace bench
