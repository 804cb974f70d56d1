// Islands: bodies that hang together by their contacts, and so fall asleep and wake together.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

/// When bodies fall asleep.
template <class S>
struct sleep_settings {
    /// False: no body does.
    bool enabled = true;
    /// For so long an island must be still (s),
    S time = S(0.5);
    /// which is while no body of it is faster than this (m/s),
    S speed = S(0.05);
    /// turns faster than this (rad/s),
    S spin = S(0.05);
    /// or gets farther than this from where it was when it became still (m): what begins to slip stays awake. What
    /// lies on other bodies only may go along with those, as long as the island slows down.
    S drift = S(0.0009);
};

template <class S>
bool check(const sleep_settings<S>& with, const char* function) {
    return detail::check_not_negative(function, "sleeping.time", with.time) &&
           detail::check_not_negative(function, "sleeping.speed", with.speed) &&
           detail::check_not_negative(function, "sleeping.spin", with.spin) &&
           detail::check_not_negative(function, "sleeping.drift", with.drift);
}

namespace detail {

/// Sets of numbers below a count, named by their least member. Source: Tarjan, Efficiency of a good but not linear set
/// union algorithm (1975), with halving of paths; the least number rules, so that names follow from the sets alone.
class disjoint_sets {
public:
    disjoint_sets(std::uint32_t count, arena& scratch) : disjoint_sets(count, scratch.allocate<std::uint32_t>(count)) {}
    /// In memory of the caller's, for so many numbers.
    disjoint_sets(std::uint32_t count, std::uint32_t* memory) : parent_(memory) {
        for (std::uint32_t i = 0; i < count; ++i) parent_[i] = i;
    }
    [[nodiscard]] std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a < b) parent_[b] = a;
        else parent_[a] = b;
    }

private:
    std::uint32_t* parent_;
};

/// True if two bodies of these velocities touch within two steps of h, or would if something drew them together by
/// `slack` (m) more. Two, since the last round of a solver looks ahead as far as another part of a step.
template <class S, int D, class Features, class Twist>
bool will_touch(const contact<S, D, Features>& c, const Twist& a, const Twist& b, S h, S slack) {
    for (int k = 0; k < c.count; ++k) {
        const auto [to_a, to_b] = c.anchors(k);
        const S speed = dot(c.normal, velocity_at(b, to_b) - velocity_at(a, to_a));
        if (c.points[k].separation + min(speed, S(0)) * (h + h) <= slack) return true;
    }
    return false;
}

}  // namespace detail

PHYSICS_HPP_END
