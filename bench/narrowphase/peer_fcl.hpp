// FCL's solvers, one on libccd and one of its own, for the narrowphase benchmark. Double.
#pragma once

#include <exception>
#include <memory>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include "scene.hpp"

namespace bench {

/// Two boxes have a method of their own, from ODE, which is the manifold; the solvers' contacts are one point. Depths
/// are EPA's: of the one on libccd those of the signed distance, as its contacts are MPR's; of its own one those of
/// contacts, for which boxes are hulls.
template <class Solver>
class fcl_solver final : public solver {
public:
    fcl_solver() {
        if constexpr (requires { solver_.epa_tolerance; }) solver_.epa_tolerance = solver_.gjk_tolerance = 1e-6;
    }
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == 3 && (t != task::manifold || (s.first == "box" && s.second == "box"));
    }
    void load(const pair_set& s) override {
        set_ = &s;
        fill(s.solids_a, a_);
        fill(s.solids_b, b_);
        for (int frame = 0; frame < pair_set::frames; ++frame) {
            poses_[frame].clear();
            for (const pose& p : s.poses[frame]) {
                fcl::Transform3d at = fcl::Transform3d::Identity();
                at.linear() = Eigen::Quaterniond(p.turn[3], p.turn[0], p.turn[1], p.turn[2]).toRotationMatrix();
                at.translation() = fcl::Vector3d(p.at[0], p.at[1], p.at[2]);
                if (s.solids_b[0].of == solid::kind::capsule) at.linear() = at.linear() * along_x();
                poses_[frame].push_back(at);
            }
        }
        origin_ = fcl::Transform3d::Identity();
        if (s.solids_a[0].of == solid::kind::capsule) origin_.linear() = along_x();
    }
    void run(task t, int frame, bool, outcome* out) override {
        const auto kind_a = set_->solids_a[0].of;
        const bool sharp = t == task::penetration && !signed_distances;
        if (kind_a == solid::kind::sphere) pairs(t, frame, out, a_.spheres, b_.hulls);
        else if (kind_a == solid::kind::capsule && sharp) pairs(t, frame, out, a_.capsules, b_.hulls);
        else if (kind_a == solid::kind::capsule) pairs(t, frame, out, a_.capsules, b_.boxes);
        else if (kind_a == solid::kind::box && !sharp) pairs(t, frame, out, a_.boxes, b_.boxes);
        else pairs(t, frame, out, a_.hulls, b_.hulls);
    }

private:
    static constexpr bool signed_distances = std::is_same_v<Solver, fcl::detail::GJKSolver_libccdd>;

    struct shapes {
        std::vector<fcl::Sphered> spheres;
        std::vector<fcl::Capsuled> capsules;
        std::vector<fcl::Boxd> boxes;
        std::vector<fcl::Convexd> hulls;
    };
    /// FCL's capsules lie along z.
    static fcl::Matrix3d along_x() {
        fcl::Matrix3d m;
        m << 0, 0, 1, 0, 1, 0, -1, 0, 0;
        return m;
    }
    static void fill(const std::vector<solid>& from, shapes& to) {
        to = {};
        for (const solid& s : from) {
            if (s.of == solid::kind::sphere) to.spheres.emplace_back(s.radius);
            if (s.of == solid::kind::capsule) to.capsules.emplace_back(s.radius, 2 * s.half[0]);
            if (s.of == solid::kind::box) to.boxes.emplace_back(2 * s.half[0], 2 * s.half[1], 2 * s.half[2]);
            if (s.faces.empty()) continue;
            auto corners = std::make_shared<std::vector<fcl::Vector3d>>();
            for (const auto& p : s.points) corners->push_back({p[0], p[1], p[2]});
            auto faces = std::make_shared<std::vector<int>>();
            for (const auto& f : s.faces) faces->insert(faces->end(), {3, f[0], f[1], f[2]});
            to.hulls.emplace_back(corners, static_cast<int>(s.faces.size()), faces);
        }
    }
    template <class A, class B>
    void pairs(task t, int frame, outcome* out, const std::vector<A>& a, const std::vector<B>& b) {
        for (std::size_t i = 0; i < set_->pairs(); ++i) {
            try {
                ask(t, a[set_->number_a(i)], b[set_->number_b(i)], poses_[frame][i], out[i]);
            } catch (const std::exception&) {
                out[i] = {};
            }
        }
    }
    template <class A, class B>
    void ask(task t, const A& a, const B& b, const fcl::Transform3d& at, outcome& out) {
        if (t == task::distance) {
            fcl::Vector3d on_a, on_b;
            solver_.shapeDistance(a, origin_, b, at, &out.distance, &on_a, &on_b);
        } else if (t == task::boolean) {
            out.distance = solver_.shapeIntersect(a, origin_, b, at, nullptr) ? -1 : 1;
        } else if (t == task::penetration && signed_distances) {
            fcl::Vector3d on_a, on_b;
            solver_.shapeSignedDistance(a, origin_, b, at, &out.distance, &on_a, &on_b);
            // The points have changed sides.
            const fcl::Vector3d way = on_a - on_b;
            for (int k = 0; k < 3; ++k) out.normal[k] = way[k];
        } else {
            contacts_.clear();
            out.distance = 1;
            if (!solver_.shapeIntersect(a, origin_, b, at, &contacts_)) return;
            if (contacts_.empty()) out.distance = NAN;
            for (const auto& c : contacts_) {
                // Its own solver's are negative.
                const double depth = std::abs(c.penetration_depth);
                if (out.distance <= -depth) continue;
                out.distance = -depth;
                for (int k = 0; k < 3; ++k) out.normal[k] = c.normal[k];
            }
        }
    }

    Solver solver_;
    const pair_set* set_ = nullptr;
    shapes a_, b_;
    fcl::Transform3d origin_;
    std::vector<fcl::Transform3d> poses_[pair_set::frames];
    std::vector<fcl::ContactPointd> contacts_;
};

}  // namespace bench
