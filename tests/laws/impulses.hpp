// Random bodies in contact, and what acts between them in double: what the solver's laws are stated over.
#pragma once

#include "reals.hpp"

namespace {

using contact = physics::solver_api::contact<S, D>;
using complete = physics::without<>;
using frictionless = physics::without<physics::feature::friction>;
template <class Features>
using solver = physics::sequential_impulse::in<cell::space, Features>;
using solver_settings = physics::sequential_impulse_settings<S>;

/// Bodies and contacts as a solver gets them; the first body may be fixed.
struct problem {
    std::vector<physics::solver_api::solver_body<S, D>> bodies;
    physics::buffer<contact> contacts;
    solver_settings settings;
    /// Of the bodies, for those who weigh them: centres of mass, and inertias in world axes.
    std::vector<reals> places;
    std::vector<physics::inertia<S, D>> inertias;
};

inline std::uint8_t number_of(int count) { return static_cast<std::uint8_t>(count); }

/// Copies what contacts with and without features have in common.
template <class To, class From>
void copy_common(To& to, const From& from) {
    to.bodies = from.bodies;
    to.normal = from.normal;
    to.r_a = from.r_a;
    to.r_b = from.r_b;
    to.count = from.count;
    to.persisted_mask = from.persisted_mask;
    for (int k = 0; k < from.count; ++k) {
        to.points[k].position = from.points[k].position;
        to.points[k].separation = from.points[k].separation;
        to.points[k].normal_impulse = from.points[k].normal_impulse;
        to.points[k].substep_impulse = from.points[k].substep_impulse;
    }
}
/// Calls f with the contacts of a problem as a solver of these features takes them, and takes over what becomes of
/// them.
template <class Features, class F>
void with_contacts(problem& p, F&& f) {
    if constexpr (std::is_same_v<Features, complete>) {
        f(p.contacts);
    } else {
        physics::buffer<physics::solver_api::contact<S, D, Features>> contacts;
        for (const contact& c : p.contacts) copy_common(contacts.emplace_back(), c);
        f(contacts);
        for (std::uint32_t i = 0; i < contacts.size(); ++i) copy_common(p.contacts[i], contacts[i]);
    }
}

template <class Features>
void solve(problem& p, int rounds) {
    struct still {
        void integrate_velocities(S) {}
        void integrate_positions(S) {}
    };
    physics::arena scratch;
    p.settings.substeps = 1;
    p.settings.iterations = rounds;
    const physics::solver_api::solver_bodies<S, D> bodies{p.bodies.data(), static_cast<std::uint32_t>(p.bodies.size())};
    with_contacts<Features>(p, [&](auto& contacts) {
        solver<Features>::solve(bodies, {contacts, scratch}, p.settings, S(1.0 / 64), scratch, still{});
    });
}

/// The part of a contact point that acts on one of its bodies, in double.
struct side_of {
    std::size_t body;
    double sign;
    reals anchor;
    double inverse_mass;
    reals k_matrix[3];

    side_of(const std::vector<physics::solver_api::solver_body<S, D>>& bodies, std::size_t number, vec r,
            double direction)
        : body(number), sign(direction), anchor(to_reals(r)) {
        const auto& b = bodies[number];
        inverse_mass = static_cast<double>(b.inverse_mass);
        for (int i = 0; i < 3; ++i) {
            if (cell::is_2d && i < 2) continue;
            reals axis;
            axis[i] = 1;
            k_matrix[i] = to_reals(physics::times(b.inverse_inertia, to_angular(axis)));
        }
    }
    /// The change of angular velocity by an angular impulse.
    reals turn(reals moment) const { return k_matrix[0] * moment.x + k_matrix[1] * moment.y + k_matrix[2] * moment.z; }
};

/// A contact point in double: the speed `target` along the normal with which its sides have to part.
struct point_of {
    std::vector<side_of> sides;
    reals normal, friction;
    double target, impulse, coefficient;
};

inline reals friction_of(const contact& c, const physics::solver_api::contact_point<S, D>& p) {
    return to_reals(physics::tangents<S, D>(c.normal).combine(p.friction_impulse));
}

inline std::vector<point_of> points_of(const problem& p) {
    std::vector<point_of> all;
    for (const contact& c : p.contacts)
        for (int k = 0; k < c.count; ++k) {
            const auto& q = c.points[k];
            const auto [to_a, to_b] = c.anchors(k);
            // Only gaps: how overlaps and bounces set the target has a law of its own.
            const double target = -cell::number(q.separation) * 64;
            all.push_back({{{p.bodies, c.bodies.body_a, to_a, -1}, {p.bodies, c.bodies.body_b, to_b, 1}},
                           to_reals(c.normal),
                           friction_of(c, q),
                           target,
                           cell::number(q.normal_impulse),
                           cell::number(c.friction)});
        }
    return all;
}

/// The velocity of the second body at the point, seen from the first.
inline reals slip_of(const std::vector<physics::solver_api::solver_body<S, D>>& bodies, const point_of& p) {
    reals sum;
    for (const side_of& s : p.sides) {
        const auto& v = bodies[s.body].velocity;
        sum = sum + (to_reals(v.linear) + cross(to_reals(v.angular), s.anchor)) * s.sign;
    }
    return sum;
}

inline void draw(cell::dice& dice, S& friction) { friction = dice.real(-2, 2); }
inline void draw(cell::dice& dice, physics::vec<S, 2>& friction) { friction = dice.vec<physics::vec<S, 2>>(-2, 2); }

/// As heavy to turn as a body of about a kilogram, in any orientation.
inline void draw_inertia(cell::dice& dice, S& inertia) { inertia = dice.real(0.2, 1); }
inline void draw_inertia(cell::dice& dice, physics::symmetric<S>& inertia) {
    const auto axes = dice.vec<physics::vec<S, 3>>(0.5, 1);
    const auto turned = matrix(random_rotation<3>(dice));
    inertia = rotated(physics::symmetric<S>{axes.x, axes.y, axes.z, S(0), S(0), S(0)}, turned);
}
inline reals times_inertia(S inertia, reals w) { return w * cell::number(inertia); }
inline reals times_inertia(const physics::symmetric<S>& inertia, reals w) {
    return to_reals(times(inertia, physics::vec<S, 3>{S(w.x), S(w.y), S(w.z)}));
}

/// Four bodies of 0.5 to 2 kg at random places, the first of them fixed if asked for, and points where two meet.
inline problem random_problem(cell::dice& dice, int points, double friction, bool fixed = true) {
    problem p;
    for (int i = 0; i < 4; ++i) {
        physics::solver_api::solver_body<S, D> b;
        physics::inertia<S, D> inertia{};
        if (i > 0 || !fixed) {
            b.inverse_mass = physics::inverse_of<S>(dice.number(0.5, 2));
            draw_inertia(dice, inertia);
            b.inverse_inertia = physics::inverted_inertia(inertia);
            b.velocity.linear = dice.vec<vec>(-2, 2);
            const double spin = dice.number(-2, 2);
            b.velocity.angular = to_angular(random_axis(dice) * spin);
        }
        p.bodies.push_back(b);
        p.inertias.push_back(inertia);
        const double far = dice.number(0.5, 1.5);
        p.places.push_back(random_direction(dice) * far);
    }
    for (int i = 0; i < points; ++i) {
        contact c{};
        c.bodies.body_a = static_cast<std::uint32_t>(dice.below(3));
        c.bodies.body_b =
            c.bodies.body_a + 1 + static_cast<std::uint32_t>(dice.below(3 - static_cast<int>(c.bodies.body_a)));
        c.normal = normalized(from_reals(random_direction(dice)));
        c.count = 1;
        const reals at = random_direction(dice);
        c.r_a = from_reals(at - p.places[c.bodies.body_a]);
        c.r_b = from_reals(at - p.places[c.bodies.body_b]);
        c.points[0].separation = dice.real(0, 0.02);
        c.friction = S(friction);
        p.contacts.push_back(c);
    }
    return p;
}

struct momenta {
    reals linear, angular;
};
/// Of all bodies, about the origin.
inline momenta momenta_of(const problem& p) {
    momenta sum;
    for (std::size_t i = 0; i < p.bodies.size(); ++i) {
        const auto& b = p.bodies[i];
        const double inverse_mass = static_cast<double>(b.inverse_mass);
        if (inverse_mass == 0) continue;
        const reals linear = to_reals(b.velocity.linear) * (1 / inverse_mass);
        sum.linear = sum.linear + linear;
        sum.angular = sum.angular + cross(p.places[i], linear);
        sum.angular = sum.angular + times_inertia(p.inertias[i], to_reals(b.velocity.angular));
    }
    return sum;
}

}  // namespace
