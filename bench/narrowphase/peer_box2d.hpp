// Box2D 2.4's GJK and its polygon manifold, for the narrowphase benchmark. Float.
#pragma once

#include <box2d/b2_collision.h>
#include <box2d/b2_distance.h>
#include <box2d/b2_polygon_shape.h>

#include "scene.hpp"

namespace bench {

class box2d_solver final : public solver {
public:
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == 2 && t != task::penetration;
    }
    [[nodiscard]] bool remembers(task t) const override { return t == task::distance; }
    void load(const pair_set& s) override {
        set_ = &s;
        a_.clear();
        b_.clear();
        for (const solid& one : s.solids_a) a_.push_back(shape_of(one));
        for (const solid& one : s.solids_b) b_.push_back(shape_of(one));
        caches_.assign(s.pairs(), {});
        for (int frame = 0; frame < pair_set::frames; ++frame) {
            poses_[frame].clear();
            for (const pose& p : s.poses[frame]) {
                b2Transform at;
                at.p = vector(p.at);
                at.q.s = static_cast<float>(2 * p.turn[2] * p.turn[3]);
                at.q.c = static_cast<float>(p.turn[3] * p.turn[3] - p.turn[2] * p.turn[2]);
                poses_[frame].push_back(at);
            }
        }
    }
    void run(task t, int frame, bool warm, outcome* out) override {
        b2Transform origin;
        origin.SetIdentity();
        for (std::size_t i = 0; i < set_->pairs(); ++i) {
            const b2PolygonShape& a = a_[set_->number_a(i)];
            const b2PolygonShape& b = b_[set_->number_b(i)];
            const b2Transform& at = poses_[frame][i];
            if (t == task::manifold) {
                b2Manifold m;
                m.pointCount = 0;
                b2CollidePolygons(&m, &a, origin, &b, at);
                b2WorldManifold world;
                world.Initialize(&m, origin, 0, at, 0);
                outcome& o = out[i];
                o.distance = 1;
                for (int k = 0; k < m.pointCount; ++k)
                    if (static_cast<double>(world.separations[k]) < o.distance)
                        o.distance = static_cast<double>(world.separations[k]);
                if (m.pointCount > 0) o.normal[0] = static_cast<double>(world.normal.x);
                if (m.pointCount > 0) o.normal[1] = static_cast<double>(world.normal.y);
                continue;
            }
            b2DistanceInput input;
            input.proxyA.Set(&a, 0);
            input.proxyB.Set(&b, 0);
            input.transformA = origin;
            input.transformB = at;
            input.useRadii = false;
            if (!warm || t == task::boolean) caches_[i].count = 0;
            b2DistanceOutput found;
            b2Distance(&found, &caches_[i], &input);
            const double distance = static_cast<double>(found.distance);
            // As b2TestOverlap() does.
            out[i].distance = t == task::distance ? distance : found.distance < 10.0f * b2_epsilon ? -1 : 1;
        }
    }

private:
    static b2Vec2 vector(const std::array<double, 3>& v) {
        return {static_cast<float>(v[0]), static_cast<float>(v[1])};
    }
    static b2PolygonShape shape_of(const solid& s) {
        b2PolygonShape result;
        if (s.of == solid::kind::box) {
            result.SetAsBox(static_cast<float>(s.half[0]), static_cast<float>(s.half[1]));
        } else {
            std::vector<b2Vec2> corners;
            for (const auto& p : s.points) corners.push_back(vector(p));
            result.Set(corners.data(), static_cast<int32>(corners.size()));
        }
        // Without the skin that Box2D gives polygons.
        result.m_radius = 0;
        return result;
    }

    const pair_set* set_ = nullptr;
    std::vector<b2PolygonShape> a_, b_;
    std::vector<b2Transform> poses_[pair_set::frames];
    std::vector<b2SimplexCache> caches_;
};

}  // namespace bench
