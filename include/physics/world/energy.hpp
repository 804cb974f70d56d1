// The energy of a world, and what a step does to it.
#pragma once

#include "physics/world/ranges.hpp"

PHYSICS_HPP_BEGIN

/// The energy of all dynamic bodies after a step, and where it came from (J).
struct energy_report {
    double kinetic = 0;
    /// In gravity, 0 where a centre of mass is at the origin.
    double potential = 0;
    /// What forces, torques, kinematic bodies and moving surfaces gave in the step.
    double work = 0;
    /// What the step gained beyond that: at most 0 but for rounding, for overlaps that were pushed apart, for what a
    /// kinematic body took along (see swept), and for joints: what springs give back, and what they and limits push.
    double made = 0;
};

namespace detail {

template <class Plan>
void add_energy_of_body(const state<Plan>& s, const typename Plan::body& b, energy_report& to) {
    if (!b.is_dynamic()) return;
    const double mass = to_double(b.mass.mass), scale = to_double(b.gravity_scale);
    const auto v = to_point(b.velocity.linear);
    to.kinetic += 0.5 * mass * dot(v, v);
    if constexpr (Plan::rotates) to.kinetic += 0.5 * twice_spin_energy(b.mass.inertia, b.rotation, b.velocity.angular);
    to.potential -= mass * scale * dot(to_point(s.settings.gravity), to_point(b.center));
}
template <class Plan>
energy_report energy_of(const state<Plan>& s) {
    energy_report sum;
    s.bodies.each([&](std::uint32_t, const auto& b) { add_energy_of_body(s, b, sum); });
    return sum;
}

/// Compares the energy before a step with that after it.
template <class Plan>
class energy_balance {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    explicit energy_balance(const state<Plan>& s) : s_(s), before_(energy_of(s)) {
        s.bodies.each([&](std::uint32_t i, const auto& b) {
            if (b.is_dynamic() && b.has_external_force())
                pushed_.push_back({i, b.center, b.rotation, b.force, b.torque});
        });
    }
    [[nodiscard]] energy_report after() const {
        energy_report r = energy_of(s_);
        for (const pushed& p : pushed_) {
            const auto& b = s_.bodies[p.body];
            r.work += product_of(p.force, b.center - p.center);
            if constexpr (Plan::rotates)
                r.work += product_of(p.torque, rotation_vector(b.rotation * inverse(p.rotation)));
        }
        for (const auto& c : s_.contacts) r.work += work_at(c);
        r.made = (r.kinetic + r.potential) - (before_.kinetic + before_.potential) - r.work;
        return r;
    }

private:
    struct pushed {
        std::uint32_t body;
        vec<S, D> center;
        physics::rotation<S, D> rotation;
        vec<S, D> force;
        [[no_unique_address]] decltype(Plan::body::torque) torque;
    };

    static double product_of(S a, S b) { return to_double(a) * to_double(b); }
    template <int N>
    static double product_of(const vec<S, N>& a, const vec<S, N>& b) {
        return dot(to_point(a), to_point(b));
    }

    /// What a kinematic body or the run of a surface gives by a contact's impulses.
    [[nodiscard]] double work_at(const typename Plan::contact& c) const {
        const auto &a = s_.bodies[c.bodies.body_a], &b = s_.bodies[c.bodies.body_b];
        const bool from_a = !a.is_dynamic(), from_b = !b.is_dynamic();
        const tangents<S, D> frame(c.normal);
        double work = 0;
        for (int k = 0; k < c.count; ++k) {
            const auto& p = c.points[k];
            vec<S, D> impulse = c.normal * p.normal_impulse;
            if constexpr (Plan::features::friction) {
                impulse += frame.combine(p.friction_impulse);
                if constexpr (Plan::features::surface_velocity)
                    work += product_of(p.friction_impulse, c.surface_velocity);
            }
            const auto r = c.anchors(k);
            if (from_a) work += product_of(impulse, velocity_at(a.velocity, r.a));
            if (from_b) work -= product_of(impulse, velocity_at(b.velocity, r.b));
        }
        if constexpr (Plan::rotates && D == 3 && Plan::features::friction) {
            const vec<S, 3> twist = c.normal * c.twist_impulse;
            if (from_a) work += product_of(twist, a.velocity.angular);
            if (from_b) work -= product_of(twist, b.velocity.angular);
        }
        if constexpr (Plan::rotates && Plan::features::rolling_resistance) {
            const angular<S, D> moment = moment_of(frame, c.rolling_impulse);
            if (from_a) work += product_of(moment, a.velocity.angular);
            if (from_b) work -= product_of(moment, b.velocity.angular);
        }
        return work;
    }
    static S moment_of(const tangents2<S>&, S about) { return about; }
    static vec<S, 3> moment_of(const tangents3<S>& frame, const vec<S, 2>& about) { return frame.combine(about); }

    const state<Plan>& s_;
    energy_report before_;
    buffer<pushed> pushed_;
};

}  // namespace detail

PHYSICS_HPP_END
