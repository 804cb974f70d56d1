// Springs of joints, as users describe them.
#pragma once

#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// A damped spring: by a frequency (Hz, with the mass that the bodies have along it) and a part of the critical
/// damping; or by a stiffness (N/m, N m/rad) and a damping (N s/m, N m s/rad), whatever the masses are.
template <class S>
struct joint_spring {
    S frequency{}, damping_ratio{}, stiffness{}, damping{};

    [[nodiscard]] constexpr bool is_physical() const { return stiffness > S(0) || damping > S(0); }
    [[nodiscard]] constexpr bool is_on() const { return frequency > S(0) || is_physical(); }
};

namespace detail {

/// What the fields of a spring are called.
struct spring_names {
    const char *frequency, *damping_ratio, *stiffness, *damping, *both;
};
inline constexpr spring_names plain_spring{"frequency", "damping_ratio", "stiffness", "damping",
                                           "beside frequency and damping_ratio it must be 0"};
inline constexpr spring_names linear_spring{"linear_frequency", "linear_damping_ratio", "linear_stiffness",
                                            "linear_damping",
                                            "beside linear_frequency and linear_damping_ratio it must be 0"};
inline constexpr spring_names angular_spring{"angular_frequency", "angular_damping_ratio", "angular_stiffness",
                                             "angular_damping",
                                             "beside angular_frequency and angular_damping_ratio it must be 0"};
/// Of an axis: behind its name.
inline constexpr spring_names axis_spring{".frequency", ".damping_ratio", ".stiffness", ".damping",
                                          "beside frequency and damping_ratio it must be 0"};
template <class S>
bool check_spring(const char* function, const joint_spring<S>& spring, const spring_names& names = plain_spring,
                  const char* of = "") {
    const auto good = [&](const char* field, S value) {
        if (!is_finite(value)) return refuse(function, of, field, static_cast<double>(value), "it must be finite");
        return value >= S(0) || refuse(function, of, field, static_cast<double>(value), "it must not be negative");
    };
    if (!good(names.frequency, spring.frequency) || !good(names.damping_ratio, spring.damping_ratio) ||
        !good(names.stiffness, spring.stiffness) || !good(names.damping, spring.damping))
        return false;
    if (!spring.is_physical() || !(spring.frequency > S(0) || spring.damping_ratio > S(0))) return true;
    const bool is_stiff = spring.stiffness > S(0);
    return refuse(function, of, is_stiff ? names.stiffness : names.damping,
                  static_cast<double>(is_stiff ? spring.stiffness : spring.damping), names.both);
}

}  // namespace detail

PHYSICS_HPP_END
