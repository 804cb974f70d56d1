// Crowds of boxes: arrangements that have been trouble to broadphases, and how they move.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "reals.hpp"

namespace {

using aabb = cell::space::aabb;

/// Calls check(policy, name) for every broadphase that the library ships.
template <class Check>
void each_broadphase(Check&& check) {
    check(physics::all_pairs{}, "all_pairs");
    check(physics::dynamic_tree{}, "dynamic_tree");
    check(physics::sweep_and_prune{}, "sweep_and_prune");
    check(physics::grid{}, "grid");
    check(physics::hash_grid{}, "hash_grid");
}

enum class layout { uniform, clusters, line, grid, huge_and_tiny, far_away, teleporting, flat };
constexpr layout layouts[] = {layout::uniform,       layout::clusters, layout::line,        layout::grid,
                              layout::huge_and_tiny, layout::far_away, layout::teleporting, layout::flat};

struct member {
    aabb box;
    /// With margins, as the broadphase should keep it.
    aabb wide;
    physics::proxy_filter filter;
};

/// Written out, so as not to trust the library's.
inline bool share_a_point(const aabb& a, const aabb& b) {
    for (int i = 0; i < D; ++i)
        if (a.upper[i] < b.lower[i] || b.upper[i] < a.lower[i]) return false;
    return true;
}
inline bool allowed(const physics::proxy_filter& a, const physics::proxy_filter& b) {
    const bool one_group = a.group == b.group && a.group != 0;
    const bool by_mask = one_group ? a.group > 0 : (a.category & b.mask) && (b.category & a.mask);
    const bool siblings = a.owner == b.owner && a.owner != 0xffffffffu;
    return by_mask && !siblings && (a.movable || b.movable) && !(a.sensor && b.sensor);
}

/// Boxes by number, and what a broadphase should know of them.
struct crowd {
    layout kind = layout::uniform;
    std::map<std::uint32_t, member> members;
    double side = 10;

    crowd() = default;
    crowd(layout of, std::uint32_t count, cell::dice& dice) : kind(of) {
        for (std::uint32_t id = 0; id < count; ++id) add(id, dice);
    }
    void add(std::uint32_t id, cell::dice& dice) {
        member m;
        reals at = anywhere(dice), half;
        for (int i = 0; i < D; ++i) half[i] = dice.number(0.1, 0.8);
        if (kind == layout::line) at = {0.9 * id, 0, 0};
        if (kind == layout::grid) {
            at = {double(id % 5), double(id / 5 % 5), cell::is_2d ? 0 : double(id / 25)};
            half = {0.5, 0.5, 0.5};
        }
        if (kind == layout::huge_and_tiny) half = half * (dice.below(10) == 0 ? 20 : dice.below(2) ? 0.01 : 1);
        if (kind == layout::flat) half.y = 0;
        if (kind == layout::far_away) at = at + reals{4000, -3000, cell::is_2d ? 0 : 2000};
        m.box.lower = from_reals(at - half);
        m.box.upper = from_reals(at + half);
        // Endless in one direction, as the ground is.
        if (kind == layout::uniform && dice.below(40) == 0) m.box.lower.y = -(cell::traits::max() * S(0.25));
        if (dice.below(8) == 0) m.filter.movable = false;
        if (dice.below(8) == 0) m.filter.sensor = true;
        if (dice.below(4) == 0) m.filter.kinds = static_cast<std::uint8_t>(dice.below(8));
        if (dice.below(8) == 0) m.filter.category = 1u << dice.below(4);
        if (dice.below(8) == 0) m.filter.mask = static_cast<std::uint32_t>(dice.below(16));
        if (dice.below(6) == 0) m.filter.group = dice.below(5) - 2;
        if (dice.below(4) == 0) m.filter.owner = static_cast<std::uint32_t>(dice.below(4));
        widen(m, {});
        members[id] = m;
    }
    reals anywhere(cell::dice& dice) const {
        reals at;
        for (int i = 0; i < D; ++i) at[i] = dice.number(0, side);
        if (kind == layout::clusters)
            for (int i = 0; i < D; ++i) at[i] = 50 * dice.below(3) + dice.number(0, 1.5);
        return at;
    }
    /// Margins of 0.05 m and twice the way, but no more than the box is wide.
    void widen(member& m, vec displacement) const {
        const S margin = cell::real(0.05);
        m.wide = {m.box.lower - vec::filled(margin), m.box.upper + vec::filled(margin)};
        for (int i = 0; i < D; ++i) {
            const S most = m.box.upper[i] - m.box.lower[i] + margin;
            S ahead = displacement[i] * S(2);
            if (ahead > most) ahead = most;
            if (ahead < -most) ahead = -most;
            (ahead > S(0) ? m.wide.upper : m.wide.lower)[i] += ahead;
        }
    }
    /// Moves some of them a little, or anywhere, and tells of each.
    template <class Tell>
    void move(double share, cell::dice& dice, Tell&& tell) {
        for (auto& [id, m] : members)
            if (dice.number(0, 1) < share) move_one(id, dice, tell);
    }
    template <class Tell>
    void move_one(std::uint32_t id, cell::dice& dice, Tell&& tell) {
        member& m = members[id];
        const bool teleports = kind == layout::teleporting || dice.below(50) == 0;
        vec displacement = dice.vec<vec>(-0.1, 0.1);
        if (teleports) {
            const reals to = anywhere(dice) * (dice.below(10) == 0 ? 100 : 1);
            displacement = from_reals(to) - m.box.lower;
        }
        if (m.box.lower.y < S(-100000)) displacement.y = S(0);
        m.box.lower += displacement;
        m.box.upper += displacement;
        // A number may round so that the box turns inside out where it was flat.
        for (int i = 0; i < D; ++i)
            if (m.box.upper[i] < m.box.lower[i]) m.box.upper[i] = m.box.lower[i];
        bool within = true;
        for (int i = 0; i < D; ++i)
            within = within && !(m.box.lower[i] < m.wide.lower[i]) && !(m.box.upper[i] > m.wide.upper[i]);
        if (!within) widen(m, displacement);
        tell(id, m.box, displacement);
    }
};

}  // namespace
