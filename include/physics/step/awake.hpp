// Which bodies a step moves.
#pragma once

#include "physics/base/pool.hpp"
#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Bodies that are neither static nor asleep: in ascending order, behind them those that have been woken in the step.
struct awake_list {
    buffer<std::uint32_t> bodies;
    /// Of each body its number among them; of all others how many they are.
    buffer<std::uint32_t> index_of;
    /// Whether other bodies move, or bodies that do not have been put elsewhere, since that was found.
    bool is_stale = true;
    PHYSICS_HPP_MEMBERS(bodies, index_of, is_stale)

    [[nodiscard]] std::uint32_t size() const { return bodies.size(); }
    [[nodiscard]] bool has(std::uint32_t body) const { return index_of[body] < size(); }
    std::uint32_t operator[](std::uint32_t k) const { return bodies[k]; }
    [[nodiscard]] const std::uint32_t* begin() const { return bodies.begin(); }
    [[nodiscard]] const std::uint32_t* end() const { return bodies.end(); }

    /// After bodies have come, of so many that there may be.
    void number(std::uint32_t slots) {
        index_of.clear();
        index_of.resize(slots, size());
        for (std::uint32_t k = 0; k < size(); ++k) index_of[bodies[k]] = k;
    }
};

/// Bodies, and which of them sleep -> which of them move, where that has changed. O(bodies).
template <class Body, class Sleep>
void list_awake(const pool<Body>& bodies, const Sleep& sleep, awake_list& to) {
    if (!to.is_stale) return;
    to.bodies.clear();
    bodies.each([&](std::uint32_t i, const auto& b) {
        if (b.type != body_type::static_body && !sleep.is_asleep(i)) to.bodies.push_back(i);
    });
    to.number(bodies.slots());
}

}  // namespace detail

PHYSICS_HPP_END
