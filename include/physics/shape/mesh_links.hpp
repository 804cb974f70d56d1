// From loose triangles to a mesh: equal vertices made one, slivers dropped, neighbours found.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/shape/surface_shape.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Numbers that are found again by what they stand for, in expected constant time; the hash decides nothing but speed.
class number_table {
public:
    explicit number_table(std::uint32_t maximum) {
        std::uint32_t slots = 16;
        while (slots < maximum * std::uint64_t{2} && slots < 0x80000000u) slots *= 2;
        slots_.resize(slots, none);
    }
    static constexpr std::uint32_t none = null_index;
    /// The place of the number for which same(number), or an empty one.
    template <class Same>
    std::uint32_t& find(std::uint64_t hash, Same&& same) {
        hash *= 0x9e3779b97f4a7c15u;
        const std::uint32_t mask = slots_.size() - 1;
        std::uint32_t i = static_cast<std::uint32_t>(hash >> 32) & mask;
        while (slots_[i] != none && !same(slots_[i])) i = (i + 1) & mask;
        return slots_[i];
    }

private:
    buffer<std::uint32_t> slots_;
};

/// A mesh in the making.
struct mesh_outline {
    struct triangle {
        std::uint32_t vertex[3];
        /// The triangles beyond the edges from vertex i to the next; none where there is none.
        std::uint32_t beyond[3];
        vec<double, 3> normal;
    };
    static constexpr std::uint32_t none = null_index;

    buffer<vec<double, 3>> vertices;
    buffer<triangle> triangles;
    /// The numbers that triangles had as they were given.
    buffer<std::uint32_t> numbers;

    /// Gives each vertex the number of the first at its place, and keeps only those.
    void weld(buffer<std::uint32_t>& new_numbers) {
        number_table table(vertices.size());
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < vertices.size(); ++i) {
            std::uint64_t hash = 0;
            mix_digest(hash, vertices[i]);
            std::uint32_t& place = table.find(hash, [&](std::uint32_t k) { return vertices[k] == vertices[i]; });
            if (place == number_table::none) vertices[place = kept++] = vertices[i];
            new_numbers.push_back(place);
        }
        vertices.resize(kept);
    }

    /// Twice the area along the normal, null for slivers: those less high than `spacing` (relative to their largest
    /// coordinate, or as it is for fixed point) has their corners rounded.
    [[nodiscard]] vec<double, 3> area(const triangle& t, double spacing, bool relative) const {
        const vec<double, 3>&a = vertices[t.vertex[0]], &b = vertices[t.vertex[1]], &c = vertices[t.vertex[2]];
        const vec<double, 3> n = cross(b - a, c - a);
        const double longest = sqrt(max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c))));
        const double reach = max(largest(a), max(largest(b), largest(c)));
        const double minimum = max(relative ? spacing * reach : spacing, 1e-12 * longest);
        return length(n) > minimum * longest ? n : vec<double, 3>{};
    }

    /// Finds what lies beyond each edge: the one triangle that runs along it the other way. Where several do, or one
    /// runs along it the same way, the edge is a free one.
    void link();
    /// Drops the triangles without a normal; what they lay between become neighbours.
    void drop_slivers();

private:
    /// The edge through which a walk that enters a sliver over edge e leaves it: its longest edge, or if that is e, the
    /// longer one of the others.
    [[nodiscard]] std::uint32_t way_out(const triangle& t, int e) const {
        double longest = -1;
        int best = e;
        for (int i = 0; i < 3; ++i) {
            const vec<double, 3> edge = vertices[t.vertex[i < 2 ? i + 1 : 0]] - vertices[t.vertex[i]];
            if (i != e && dot(edge, edge) > longest) longest = dot(edge, edge), best = i;
        }
        return t.beyond[best];
    }
};

inline void mesh_outline::link() {
    const std::uint32_t edges = triangles.size() * 3;
    const auto from = [&](std::uint32_t e) { return triangles[e / 3].vertex[e % 3]; };
    const auto to = [&](std::uint32_t e) { return triangles[e / 3].vertex[(e + 1) % 3]; };
    const auto hash = [](std::uint32_t a, std::uint32_t b) {
        std::uint64_t h = 0;
        mix_digest(h, std::uint64_t{a} << 32 | b);
        return h;
    };
    number_table table(edges);
    const auto along = [&](std::uint32_t a, std::uint32_t b) -> std::uint32_t& {
        return table.find(hash(a, b), [&](std::uint32_t e) { return from(e) == a && to(e) == b; });
    };
    // The first edge of each direction stands for all of them.
    buffer<bool> shared;
    shared.resize(edges, false);
    for (std::uint32_t e = 0; e < edges; ++e) {
        std::uint32_t& first = along(from(e), to(e));
        if (first == number_table::none) first = e;
        else shared[first] = shared[e] = true;
    }
    for (std::uint32_t e = 0; e < edges; ++e) {
        const std::uint32_t other = along(to(e), from(e));
        const bool alone = !shared[e] && other != number_table::none && !shared[other];
        triangles[e / 3].beyond[e % 3] = alone ? other / 3 : none;
    }
}

inline void mesh_outline::drop_slivers() {
    const auto is_sliver = [&](std::uint32_t t) { return triangles[t].normal == vec<double, 3>{}; };
    buffer<std::uint32_t> new_numbers;
    std::uint32_t kept = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) new_numbers.push_back(is_sliver(t) ? none : kept++);
    if (kept == triangles.size()) return;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (is_sliver(t)) continue;
        for (std::uint32_t& beyond : triangles[t].beyond) {
            std::uint32_t here = t, next = beyond;
            for (int i = 0; i < 16 && next != none && is_sliver(next); ++i) {
                const triangle& s = triangles[next];
                int e = 0;
                while (e < 2 && s.beyond[e] != here) ++e;
                here = next;
                next = way_out(s, e);
            }
            beyond = next == none || is_sliver(next) || next == t ? none : next;
        }
    }
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (is_sliver(t)) continue;
        triangle moved = triangles[t];
        for (std::uint32_t& beyond : moved.beyond) beyond = beyond == none ? none : new_numbers[beyond];
        numbers[new_numbers[t]] = numbers[t];
        triangles[new_numbers[t]] = moved;
    }
    triangles.resize(kept);
    numbers.resize(kept);
}

}  // namespace detail

PHYSICS_HPP_END
