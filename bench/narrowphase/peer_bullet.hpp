// Bullet's pair detector, its second GJK/EPA and its box-box manifold, for the narrowphase benchmark. Float.
#pragma once

#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "scene.hpp"

namespace bench {

/// Shapes without the margin around corners that Bullet gives them, and their poses.
class bullet_scene {
public:
    void load(const pair_set& s) {
        set_ = &s;
        shapes_[0].clear();
        shapes_[1].clear();
        for (const solid& one : s.solids_a) shapes_[0].push_back(shape_of(one));
        for (const solid& one : s.solids_b) shapes_[1].push_back(shape_of(one));
        for (int frame = 0; frame < pair_set::frames; ++frame) {
            poses_[frame].clear();
            for (const pose& p : s.poses[frame])
                poses_[frame].emplace_back(
                    btQuaternion(real(p.turn[0]), real(p.turn[1]), real(p.turn[2]), real(p.turn[3])), vector(p.at));
        }
    }
    [[nodiscard]] std::size_t pairs() const { return poses_[0].size(); }
    [[nodiscard]] const btConvexShape* a(std::size_t i) const { return shapes_[0][set_->number_a(i)].get(); }
    [[nodiscard]] const btConvexShape* b(std::size_t i) const { return shapes_[1][set_->number_b(i)].get(); }
    [[nodiscard]] const btTransform& at(int frame, std::size_t i) const { return poses_[frame][i]; }

private:
    static btScalar real(double x) { return static_cast<btScalar>(x); }
    static btVector3 vector(const std::array<double, 3>& v) { return {real(v[0]), real(v[1]), real(v[2])}; }
    static std::unique_ptr<btConvexShape> shape_of(const solid& s) {
        if (s.of == solid::kind::sphere) return std::make_unique<btSphereShape>(real(s.radius));
        if (s.of == solid::kind::capsule) return std::make_unique<btCapsuleShapeX>(real(s.radius), real(2 * s.half[0]));
        std::unique_ptr<btConvexShape> result;
        if (s.of == solid::kind::box) {
            result = std::make_unique<btBoxShape>(vector(s.half));
        } else {
            auto hull = std::make_unique<btConvexHullShape>();
            for (const auto& p : s.points) hull->addPoint(vector(p), false);
            hull->recalcLocalAabb();
            result = std::move(hull);
        }
        result->setMargin(0);
        return result;
    }

    const pair_set* set_ = nullptr;
    std::vector<std::unique_ptr<btConvexShape>> shapes_[2];
    std::vector<btTransform> poses_[pair_set::frames];
};

/// Margins of sharp shapes are 0 here.
inline btScalar radius_of(const btConvexShape* s) { return s->getMargin(); }

/// Bullet's normals lead from B to A.
inline void tell(outcome& out, double distance, const btVector3& from_b) {
    out.distance = distance;
    for (int k = 0; k < 3; ++k) out.normal[k] = -static_cast<double>(from_b[k]);
}

class bullet_detector final : public solver {
public:
    [[nodiscard]] bool can(const pair_set& s, task t) const override { return s.dimension == 3 && t != task::manifold; }
    [[nodiscard]] bool remembers(task) const override { return true; }
    void load(const pair_set& s) override {
        scene_.load(s);
        detectors_.clear();
        for (std::size_t i = 0; i < scene_.pairs(); ++i)
            detectors_.emplace_back(scene_.a(i), scene_.b(i), &simplex_, &epa_);
    }
    void run(task t, int frame, bool warm, outcome* out) override {
        btGjkPairDetector::ClosestPointInput input;
        input.m_transformA.setIdentity();
        for (std::size_t i = 0; i < scene_.pairs(); ++i) {
            btPointCollector found;
            btGjkPairDetector& detector = detectors_[i];
            if (!warm) detector.setCachedSeparatingAxis(btVector3(0, 1, 0));
            input.m_transformB = scene_.at(frame, i);
            // Of the cores, beyond which it need not look.
            const btScalar near = radius_of(scene_.a(i)) + radius_of(scene_.b(i)) + btScalar(1e-4);
            input.m_maximumDistanceSquared = t == task::boolean ? near * near : BT_LARGE_FLOAT;
            detector.getClosestPoints(input, found, nullptr);
            if (t == task::boolean) out[i].distance = found.m_hasResult && found.m_distance <= 0 ? -1 : 1;
            else if (!found.m_hasResult) out[i].distance = t == task::penetration ? 1 : NAN;
            else tell(out[i], static_cast<double>(found.m_distance), found.m_normalOnBInWorld);
        }
    }

private:
    bullet_scene scene_;
    btVoronoiSimplexSolver simplex_;
    btGjkEpaPenetrationDepthSolver epa_;
    std::vector<btGjkPairDetector> detectors_;
};

class bullet_epa2 final : public solver {
public:
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == 3 && (t == task::distance || t == task::penetration);
    }
    void load(const pair_set& s) override { scene_.load(s); }
    void run(task t, int frame, bool, outcome* out) override {
        const btTransform origin = btTransform::getIdentity();
        for (std::size_t i = 0; i < scene_.pairs(); ++i) {
            const btTransform& at = scene_.at(frame, i);
            btGjkEpaSolver2::sResults found;
            const btVector3 guess = at.getOrigin();
            const bool ok = (t == task::distance)
                                ? btGjkEpaSolver2::Distance(scene_.a(i), origin, scene_.b(i), at, guess, found)
                                : btGjkEpaSolver2::Penetration(scene_.a(i), origin, scene_.b(i), at, guess, found);
            // Distance() leaves radii out.
            const double radii =
                t == task::distance ? static_cast<double>(radius_of(scene_.a(i)) + radius_of(scene_.b(i))) : 0;
            if (ok) tell(out[i], static_cast<double>(found.distance) - radii, found.normal);
            else out[i].distance = t == task::penetration ? 1 : NAN;
        }
    }

private:
    bullet_scene scene_;
};

class bullet_boxes final : public solver {
public:
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == 3 && t == task::manifold && s.first == "box" && s.second == "box";
    }
    void load(const pair_set& s) override { scene_.load(s); }
    void run(task, int frame, bool, outcome* out) override {
        struct points final : btDiscreteCollisionDetectorInterface::Result {
            outcome least;
            btVector3 at[8];
            int count = 0;
            void setShapeIdentifiersA(int, int) override {}
            void setShapeIdentifiersB(int, int) override {}
            void addContactPoint(const btVector3& normal, const btVector3& point, btScalar depth) override {
                at[count++ & 7] = point;
                if (!(least.distance < static_cast<double>(depth))) tell(least, static_cast<double>(depth), normal);
            }
        };
        btBoxBoxDetector::ClosestPointInput input;
        input.m_transformA.setIdentity();
        for (std::size_t i = 0; i < scene_.pairs(); ++i) {
            points found;
            btBoxBoxDetector detector(static_cast<const btBoxShape*>(scene_.a(i)),
                                      static_cast<const btBoxShape*>(scene_.b(i)));
            input.m_transformB = scene_.at(frame, i);
            detector.getClosestPoints(input, found, nullptr);
            out[i] = found.least;
            if (found.count == 0) out[i].distance = 1;
        }
    }

private:
    bullet_scene scene_;
};

}  // namespace bench
