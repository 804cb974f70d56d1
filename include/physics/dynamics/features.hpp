// What contacts and surfaces can do, and what a recipe leaves out of it.
#pragma once

#include <concepts>

#include "physics/base/stage.hpp"

PHYSICS_HPP_BEGIN

/// Features that a recipe can leave out; what is left out costs nothing.
namespace feature {
/// Coulomb friction of contacts. Without it no surface drives another either.
struct friction {};
/// Bouncing.
struct restitution {};
/// Bodies turn. Without it they keep the rotation that they are given, nothing rolls, and solvers see no levers.
struct rotation {};
/// Islands that are still leave the step until they are touched.
struct sleeping {};
/// Resistance to rolling.
struct rolling_resistance {};
/// Surfaces that run, as conveyor belts do.
struct surface_velocity {};
/// Looking after fast bodies on their way through a step.
struct continuous {};
/// Per-shape materials. Without them settings.material applies to all shapes, and surface velocities are 0.
struct materials {};
}  // namespace feature

/// Leaves features out: without<feature::friction, feature::restitution>.
template <class... Features>
struct without {
    using stage = physics::stage::features;

private:
    template <class Feature>
    static constexpr bool lacks = (std::same_as<Features, Feature> || ...);
    template <class Any, class... Known>
    static constexpr bool is_one_of = (std::same_as<Any, Known> || ...);

public:
    static constexpr bool friction = !lacks<feature::friction>;
    static constexpr bool restitution = !lacks<feature::restitution>;
    static constexpr bool rotation = !lacks<feature::rotation>;
    static constexpr bool rolling_resistance = rotation && !lacks<feature::rolling_resistance>;
    static constexpr bool materials = !lacks<feature::materials>;
    static constexpr bool surface_velocity = friction && materials && !lacks<feature::surface_velocity>;
    static constexpr bool sleeping = !lacks<feature::sleeping>;
    static constexpr bool continuous = !lacks<feature::continuous>;
    static constexpr bool known =
        (is_one_of<Features, feature::friction, feature::restitution, feature::rotation, feature::rolling_resistance,
                   feature::surface_velocity, feature::sleeping, feature::continuous, feature::materials> &&
         ...);
};

namespace detail {

/// Stands where a value is left out: it takes no room, is not written, and reads as 0. Nth tells two in one struct
/// apart, which would take room for that.
template <class T, class Feature, int Nth>
struct absent {
    constexpr absent() = default;
    constexpr explicit absent(const T&) {}
    constexpr operator T() const { return T{}; }
    friend constexpr bool operator==(const absent&, const absent&) = default;
};
/// What a value that may be left out reads as.
template <class T>
constexpr const T& value_of(const T& value) {
    return value;
}
template <class T, class Feature, int Nth>
constexpr T value_of(const absent<T, Feature, Nth>& value) {
    return value;
}
/// A value that is there if `Kept`.
template <bool Kept, class T, class Feature, int Nth = 0>
using optional_member = std::conditional_t<Kept, T, absent<T, Feature, Nth>>;

}  // namespace detail

PHYSICS_HPP_END
