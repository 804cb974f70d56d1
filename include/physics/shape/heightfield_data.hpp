// What a heightfield is in memory: its heights, row by row; parts and their neighbours follow by arithmetic.
#pragma once

#include "physics/shape/surface_shape.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Heights in R above a regular grid; in 2D it has one row.
template <class R, int D>
struct heightfield_data : geometry_block {
    std::uint32_t columns, rows;
    bool alternating, two_sided;
    /// The distance of columns and of rows (m).
    double step_x, step_z;
    std::uint64_t digest;
    aabb<double, D> box;
    block_array<R> heights;
    /// A bit for each cell; none where no cell is a hole.
    block_array<std::uint32_t> holes;
    /// At most 64 boxes around all.
    block_array<aabb<float, D>> cover;

    [[nodiscard]] std::uint32_t cells_x() const { return columns - 1; }
    [[nodiscard]] std::uint32_t cells_z() const { return D == 2 ? 1 : rows - 1; }
    /// Whether there is a surface in a cell; numbers that have wrapped below 0 are beyond the edge.
    [[nodiscard]] bool solid(std::uint32_t x, std::uint32_t z) const {
        if (x >= cells_x() || z >= cells_z()) return false;
        const std::uint32_t i = z * cells_x() + x;
        return holes.size() == 0 || (holes[i >> 5] >> (i & 31) & 1u) == 0;
    }
    [[nodiscard]] double height(std::uint32_t x, std::uint32_t z) const {
        return static_cast<double>(heights[z * columns + x]);
    }
    [[nodiscard]] vec<double, D> sample(std::uint32_t x, std::uint32_t z) const {
        vec<double, D> p;
        p.x = x * step_x;
        p.y = height(x, z);
        if constexpr (D == 3) p.z = z * step_z;
        return p;
    }

    /// A block with one owner: the caller. Holes are null or a byte for each cell, other than 0 where there is one.
    static const heightfield_data* make(const R* heights, std::uint32_t columns, std::uint32_t rows, double step_x,
                                        double step_z, const std::uint8_t* holes, bool alternating, bool two_sided);
};

/// The normal of cell x.
template <class R>
vec<double, 2> cell_normal(const heightfield_data<R, 2>& h, std::uint32_t x) {
    return normalized(vec<double, 2>{h.height(x, 0) - h.height(x + 1, 0), h.step_x});
}
template <class R>
aabb<double, 2> cell_box(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t) {
    const vec<double, 2> a = h.sample(x, 0), b = h.sample(x + 1, 0);
    return {min(a, b), max(a, b)};
}
/// What a ray needs to know of part x.
template <class R>
surface_face<2> cell_face(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t, int) {
    return {{h.sample(x + 1, 0), h.sample(x, 0)}, h.two_sided};
}
/// Calls f with part x, which leads from sample x + 1 back to sample x: the solid is below.
template <class R, class F>
void cell_parts(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t, F&& f) {
    surface_part<2> p;
    p.corner[0] = h.sample(x + 1, 0);
    p.corner[1] = h.sample(x, 0);
    p.normal = cell_normal(h, x);
    for (int i = 0; i < 2; ++i) {
        const std::uint32_t other = i == 0 ? x + 1 : x - 1;
        p.continues[i] = h.solid(other, 0);
        if (p.continues[i]) p.beyond[i] = cell_normal(h, other);
    }
    p.two_sided = h.two_sided;
    p.number = x;
    f(p);
}

/// The normal of triangle k of a cell. The first triangle holds the cell's side at the lower x, the second the opposite
/// one; by the diagonal from the first corner to the last, or by the other.
template <class R>
vec<double, 3> cell_normal(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, int k) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    // The side along x that the triangle holds, and the one along z.
    const std::uint32_t far_z = (k == 0) != other ? z + 1 : z, far_x = k == 0 ? x : x + 1;
    const double rise_x = h.height(x + 1, far_z) - h.height(x, far_z);
    const double rise_z = h.height(far_x, z + 1) - h.height(far_x, z);
    return normalized(vec<double, 3>{-rise_x * h.step_z, h.step_x * h.step_z, -rise_z * h.step_x});
}
template <class R>
aabb<double, 3> cell_box(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z) {
    const vec<double, 3> a = h.sample(x, z), b = h.sample(x + 1, z), c = h.sample(x, z + 1), d = h.sample(x + 1, z + 1);
    return {min(min(a, b), min(c, d)), max(max(a, b), max(c, d))};
}
/// The corners of the triangles of a cell, without and with the other diagonal. They count along x, then along z.
inline constexpr std::uint8_t cell_corners[2][2][3] = {{{0, 2, 3}, {0, 3, 1}}, {{0, 2, 1}, {1, 2, 3}}};
/// What a ray needs to know of triangle k of a cell.
template <class R>
surface_face<3> cell_face(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, int k) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    surface_face<3> face{{}, h.two_sided};
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t corner = cell_corners[other][k][i];
        face.corner[i] = h.sample(x + (corner & 1), z + (corner >> 1));
    }
    return face;
}
template <class R, class F>
void cell_parts(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, F&& f) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    // Those at the lower x, upper z, upper x, lower z; 4 the diagonal.
    static constexpr std::uint8_t sides[2][2][3] = {{{0, 1, 4}, {4, 2, 3}}, {{0, 4, 3}, {4, 1, 2}}};
    for (int k = 0; k < 2; ++k) {
        surface_part<3> p;
        p.normal = cell_normal(h, x, z, k);
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t corner = cell_corners[other][k][i];
            p.corner[i] = h.sample(x + (corner & 1), z + (corner >> 1));
            const int side = sides[other][k][i];
            const std::uint32_t u = side == 0 ? x - 1 : side == 2 ? x + 1 : x;
            const std::uint32_t v = side == 1 ? z + 1 : side == 3 ? z - 1 : z;
            p.continues[i] = h.solid(u, v);
            if (!p.continues[i]) continue;
            const bool other_there = h.alternating && ((u + v) & 1u) != 0;
            // Of the cell there the triangle that holds the opposite side.
            const int there = side == 4 ? 1 - k : side == 0 ? 1 : side == 2 ? 0 : (side == 1) != other_there ? 1 : 0;
            p.beyond[i] = cell_normal(h, u, v, there);
        }
        p.two_sided = h.two_sided;
        p.number = 2 * (z * h.cells_x() + x) + static_cast<std::uint32_t>(k);
        f(p);
    }
}

/// The cells from `first` to before `last` that an interval may touch.
struct cells_between {
    std::uint32_t first, last;

    cells_between(double low, double high, double step, std::uint32_t cells) {
        const double from = low / step - 1e-9, to = high / step + 1e-9;
        first = from < 0 ? 0 : from < cells ? static_cast<std::uint32_t>(from) : cells;
        last = to < 0 ? 0 : to < cells ? static_cast<std::uint32_t>(to) + 1 : cells;
    }
};

template <class R, int D>
const heightfield_data<R, D>* heightfield_data<R, D>::make(const R* heights, std::uint32_t columns, std::uint32_t rows,
                                                           double step_x, double step_z, const std::uint8_t* holes,
                                                           bool alternating, bool two_sided) {
    const std::uint32_t cells = (columns - 1) * (D == 2 ? 1 : rows - 1);
    const auto groups = [](std::uint32_t n) { return n < 8 ? n : 8u; };
    const std::uint32_t along_x = D == 2 ? (columns - 1 < 64 ? columns - 1 : 64) : groups(columns - 1);
    const std::uint32_t along_z = D == 2 ? 1 : groups(rows - 1);
    block_layout layout(sizeof(heightfield_data));
    const std::size_t at_heights = layout.place<R>(std::size_t{columns} * rows);
    const std::uint32_t words = holes == nullptr ? 0 : (cells + 31) / 32;
    const std::size_t at_holes = layout.place<std::uint32_t>(words);
    const std::size_t at_cover = layout.place<aabb<float, D>>(along_x * along_z);
    auto* h = new_geometry<heightfield_data>(layout.bytes());
    h->columns = columns;
    h->rows = rows;
    h->alternating = alternating;
    h->two_sided = two_sided;
    h->step_x = step_x;
    h->step_z = step_z;
    h->heights.attach(h, at_heights, columns * rows);
    h->holes.attach(h, at_holes, words);
    h->cover.attach(h, at_cover, along_x * along_z);
    h->digest = std::uint64_t{columns} << 32 | rows;
    mix_digest(h->digest, std::uint64_t{alternating} << 1 | std::uint64_t{two_sided});
    mix_digest(h->digest, scalar_traits<double>::bits(step_x));
    mix_digest(h->digest, scalar_traits<double>::bits(step_z));
    for (std::uint32_t i = 0; i < columns * rows; ++i) {
        h->heights[i] = heights[i];
        mix_digest(h->digest, scalar_traits<double>::bits(static_cast<double>(heights[i])));
    }
    for (std::uint32_t i = 0; i < (words > 0 ? cells : 0); ++i)
        if (holes[i] != 0) h->holes[i >> 5] |= 1u << (i & 31);
    for (const std::uint32_t word : h->holes) mix_digest(h->digest, word);
    for (std::uint32_t v = 0; v < along_z; ++v)
        for (std::uint32_t u = 0; u < along_x; ++u) {
            const auto split_at = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) {
                return static_cast<std::uint32_t>(std::uint64_t{i} * n / of);
            };
            const std::uint32_t x = split_at(u, columns - 1, along_x), z = split_at(v, rows - 1, along_z);
            aabb<double, D> around{h->sample(x, z), h->sample(x, z)};
            for (std::uint32_t j = z; j <= split_at(v + 1, rows - 1, along_z); ++j)
                for (std::uint32_t i = x; i <= split_at(u + 1, columns - 1, along_x); ++i)
                    around = {min(around.lower, h->sample(i, j)), max(around.upper, h->sample(i, j))};
            h->cover[v * along_x + u] = outward_floats(around);
            h->box = u + v == 0 ? around : merged(h->box, around);
        }
    return h;
}

}  // namespace detail

PHYSICS_HPP_END
