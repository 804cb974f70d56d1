// libccd's GJK, EPA and MPR, for the narrowphase benchmark. Double; knows no distances.
#pragma once

#include <ccd/ccd.h>
#include <ccd/quat.h>

#include "scene.hpp"

namespace bench {

class ccd_solver final : public solver {
public:
    explicit ccd_solver(bool portal) : portal_(portal) {
        CCD_INIT(&settings_);
        settings_.support1 = settings_.support2 = support;
        settings_.center1 = settings_.center2 = centre;
        // The default is no limit.
        settings_.max_iterations = 500;
        settings_.epa_tolerance = settings_.mpr_tolerance = 1e-6;
    }
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == 3 && (t == task::boolean || t == task::penetration);
    }
    void load(const pair_set& s) override { set_ = &s; }
    void run(task t, int frame, bool, outcome* out) override {
        for (std::size_t i = 0; i < set_->pairs(); ++i) {
            const body a(set_->a(i), {}), b(set_->b(i), set_->poses[frame][i]);
            if (t == task::boolean) {
                out[i].distance = (portal_ ? ccdMPRIntersect : ccdGJKIntersect)(&a, &b, &settings_) ? -1 : 1;
                continue;
            }
            ccd_real_t depth;
            ccd_vec3_t way, at;
            const int missed = (portal_ ? ccdMPRPenetration : ccdGJKPenetration)(&a, &b, &settings_, &depth, &way, &at);
            // Negative: apart, or, for -2, without memory.
            out[i].distance = missed == -1 ? 1 : missed ? NAN : -depth;
            for (int k = 0; k < 3; ++k) out[i].normal[k] = missed ? 0 : way.v[k];
        }
    }

private:
    struct body {
        const solid* shape;
        double axis[3][3];
        double at[3];

        body(const solid& s, const pose& p) : shape(&s), at{p.at[0], p.at[1], p.at[2]} {
            const double x = p.turn[0], y = p.turn[1], z = p.turn[2], w = p.turn[3];
            const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                                       {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                                       {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) axis[i][k] = rows[i][k];
        }
    };
    static void centre(const void* of, ccd_vec3_t* to) {
        const body& b = *static_cast<const body*>(of);
        ccdVec3Set(to, b.at[0], b.at[1], b.at[2]);
    }
    static void support(const void* of, const ccd_vec3_t* along, ccd_vec3_t* to) {
        const body& b = *static_cast<const body*>(of);
        const solid& s = *b.shape;
        double d[3], p[3] = {};
        for (int i = 0; i < 3; ++i)
            d[i] = b.axis[i][0] * along->v[0] + b.axis[i][1] * along->v[1] + b.axis[i][2] * along->v[2];
        switch (s.of) {
            case solid::kind::sphere: break;
            case solid::kind::capsule: p[0] = d[0] < 0 ? -s.half[0] : s.half[0]; break;
            case solid::kind::box:
                for (int i = 0; i < 3; ++i) p[i] = d[i] < 0 ? -s.half[i] : s.half[i];
                break;
            case solid::kind::hull: {
                double most = -HUGE_VAL;
                for (const auto& q : s.points) {
                    const double reach = d[0] * q[0] + d[1] * q[1] + d[2] * q[2];
                    if (reach > most) most = reach, p[0] = q[0], p[1] = q[1], p[2] = q[2];
                }
                break;
            }
        }
        if (s.radius > 0) {
            const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            for (int i = 0; i < 3; ++i) p[i] += s.radius * d[i] / length;
        }
        for (int k = 0; k < 3; ++k)
            to->v[k] = b.at[k] + b.axis[0][k] * p[0] + b.axis[1][k] * p[1] + b.axis[2][k] * p[2];
    }

    ccd_t settings_;
    bool portal_;
    const pair_set* set_ = nullptr;
};

}  // namespace bench
