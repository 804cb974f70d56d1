// What surfaces are made of, and what two of them make of a contact.
#pragma once

#include "physics/dynamics/features.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// How a surface runs against its own shape: a speed in 2D, a vector in 3D.
template <class S, int D>
using surface_motion = std::conditional_t<D == 2, S, vec<S, 3>>;

/// How a shape's surface answers to contact. What two surfaces make of it is the recipe's mixing rule. What the recipe
/// leaves out must stay 0; friction, which has a default, then counts for nothing.
template <class S, int D>
struct material {
    /// Coulomb friction coefficient, at least 0.
    S friction = S(0.6);
    /// Share of the approach speed that a bounce gives back, at least 0. Above 1 a bounce adds energy, as the bumpers
    /// of a pinball do.
    S restitution = S(0);
    /// Arm of rolling friction (m), at least 0: a torque of up to this times the normal force resists rolling. A ball
    /// of radius r stays on slopes up to the angle of tangent rolling_resistance / r. Source: Coulomb, Théorie des
    /// machines simples (1785).
    S rolling_resistance = S(0);
    /// How the surface itself runs, as a conveyor belt's (m/s): friction drives what touches it along. In 2D
    /// clockwise about the shape: on top of it to the right, +x. In 3D a vector in the shape's frame, of which
    /// counts what lies in the surface.
    surface_motion<S, D> surface_velocity{};

    friend bool operator==(const material&, const material&) = default;
};

/// What a mixing rule offers: `in<Space>` with friction(a, b), restitution(a, b) and rolling_resistance(a, b), static
/// functions of two materials. They are called for each contact in each step, with the material of the shape whose kind
/// comes first in the recipe's set, among equals with that of the lower number; so a rule should be symmetric. If all
/// surfaces are of one material they are called once a step, with it and itself. Refused by the step: results that are
/// negative or not finite. Velocities of surfaces need no rule: how fast two of them run
/// against each other is their difference.
template <class Rule, class Space>
concept mixing_for = requires(const material<typename Space::scalar, Space::dimension>& m) {
    { Rule::template in<Space>::friction(m, m) } -> std::same_as<typename Space::scalar>;
    { Rule::template in<Space>::restitution(m, m) } -> std::same_as<typename Space::scalar>;
    { Rule::template in<Space>::rolling_resistance(m, m) } -> std::same_as<typename Space::scalar>;
};

/// Friction: the root of the product, so that ice stays slippery under rubber; restitution and rolling resistance: the
/// larger one.
struct geometric_mixing {
    using stage = physics::stage::mixing;

    template <class Space>
    struct in {
        using S = typename Space::scalar;
        using material = physics::material<S, Space::dimension>;

        static S friction(const material& a, const material& b) { return root<S>(product(a.friction, b.friction)); }
        static S restitution(const material& a, const material& b) { return max(a.restitution, b.restitution); }
        static S rolling_resistance(const material& a, const material& b) {
            return max(a.rolling_resistance, b.rolling_resistance);
        }
    };
};

/// Friction and restitution: the product; rolling resistance, a length, the larger one.
struct product_mixing {
    using stage = physics::stage::mixing;

    template <class Space>
    struct in : geometric_mixing::in<Space> {
        using S = typename Space::scalar;
        using material = physics::material<S, Space::dimension>;

        static S friction(const material& a, const material& b) { return a.friction * b.friction; }
        static S restitution(const material& a, const material& b) { return a.restitution * b.restitution; }
    };
};

namespace detail {

/// As much of a material as a recipe keeps of each shape.
template <class S, int D, class Features>
struct stored_material {
    static constexpr bool each = Features::materials;

    [[no_unique_address]] optional_member<each && Features::friction, S, feature::friction> friction{};
    [[no_unique_address]] optional_member<each && Features::restitution, S, feature::restitution> restitution{};
    [[no_unique_address]] optional_member<each && Features::rolling_resistance, S, feature::rolling_resistance>
        rolling_resistance{};
    [[no_unique_address]] optional_member<Features::surface_velocity, surface_motion<S, D>, feature::surface_velocity>
        surface_velocity{};

    constexpr stored_material() = default;
    constexpr stored_material(const material<S, D>& m)
        : friction(m.friction),
          restitution(m.restitution),
          rolling_resistance(m.rolling_resistance),
          surface_velocity(m.surface_velocity) {}
    [[nodiscard]] constexpr material<S, D> whole() const {
        return {friction, restitution, rolling_resistance, surface_velocity};
    }
};

/// In place of a coefficient that all contacts share. Not a number, so reading it from the contact by mistake does not
/// compile.
template <class Feature>
struct common_coefficient {};
/// A coefficient of two surfaces, as a contact holds it.
template <bool Kept, class S, class Feature, class Features>
using coefficient_of_contact =
    std::conditional_t<Kept && !Features::materials, common_coefficient<Feature>, optional_member<Kept, S, Feature>>;

/// What the surfaces of any contact make of each other, as far as contacts do not hold it themselves.
template <class S, class Features>
struct combined_material {
    static constexpr bool common = !Features::materials;

    [[no_unique_address]] optional_member<common && Features::friction, S, feature::friction> friction{};
    [[no_unique_address]] optional_member<common && Features::restitution, S, feature::restitution> restitution{};
    [[no_unique_address]] optional_member<common && Features::rolling_resistance, S, feature::rolling_resistance>
        rolling_resistance{};

    /// Coefficients of a contact; 0 of what the recipe leaves out.
    template <class Contact>
    [[nodiscard]] constexpr S friction_of(const Contact& c) const {
        if constexpr (common) return friction;
        else return c.friction;
    }
    template <class Contact>
    [[nodiscard]] constexpr S restitution_of(const Contact& c) const {
        if constexpr (common) return restitution;
        else return c.restitution;
    }
    template <class Contact>
    [[nodiscard]] constexpr S rolling_resistance_of(const Contact& c) const {
        if constexpr (common) return rolling_resistance;
        else return c.rolling_resistance;
    }
};

/// A rule that does the same to all three coefficients: Same::of(a, b).
template <class Same>
struct mixing_by {
    using stage = physics::stage::mixing;

    template <class Space>
    struct in {
        using S = typename Space::scalar;
        using material = physics::material<S, Space::dimension>;

        static S friction(const material& a, const material& b) { return Same::of(a.friction, b.friction); }
        static S restitution(const material& a, const material& b) { return Same::of(a.restitution, b.restitution); }
        static S rolling_resistance(const material& a, const material& b) {
            return Same::of(a.rolling_resistance, b.rolling_resistance);
        }
    };
};

}  // namespace detail

/// The smaller one of each coefficient.
struct minimum_mixing : detail::mixing_by<minimum_mixing> {
    template <class S>
    static constexpr S of(S a, S b) {
        return min(a, b);
    }
};
/// The larger one of each coefficient.
struct maximum_mixing : detail::mixing_by<maximum_mixing> {
    template <class S>
    static constexpr S of(S a, S b) {
        return max(a, b);
    }
};
/// The mean of each coefficient.
struct average_mixing : detail::mixing_by<average_mixing> {
    template <class S>
    static constexpr S of(S a, S b) {
        return a * S(0.5) + b * S(0.5);
    }
};

PHYSICS_HPP_END
