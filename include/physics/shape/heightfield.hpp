// The heightfield: a surface by its heights above a regular grid, such as a landscape.
#pragma once

#include <initializer_list>

#include "physics/base/probe.hpp"
#include "physics/shape/concept.hpp"
#include "physics/shape/heightfield_data.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of a surface that has one height y for each x (and z) of the shape's frame.
/// It has no mass, so it serves static and kinematic bodies. A heightfield_geometry or a world keeps the heights: as
/// long as one of them does, the shape is good.
template <class S, int D>
struct heightfield {
    using scalar = S;
    const detail::heightfield_data<detail::hull_real<S>, D>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return heightfield<T, D>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, heightfield>{*this};
    }
};

template <class S, int D>
bool check(const heightfield<S, D>& h, const char* function) {
    return detail::check_surface(h, "it must be the shape of a heightfield_geometry that was built", function);
}
/// Tight up to 64 samples; around at most 64 boxes where there are more. Holes count.
template <class S, int D>
aabb<S, D> bounds(const heightfield<S, D>& h, const transform<S, D>& at) {
    const auto& g = *h.geometry;
    detail::turned_bounds<S, D> around(at);
    if (g.heights.size() <= detail::points_to_bound) {
        for (std::uint32_t z = 0; z < g.rows; ++z)
            for (std::uint32_t x = 0; x < g.columns; ++x) around.add(g.sample(x, z));
    } else {
        for (const aabb<float, D>& box : g.cover) around.add(box);
    }
    return around.box(h.radius, g.box);
}
/// For the narrowphase: calls f with the segments or triangles that may reach into a box of the shape's frame. Cost:
/// O(cells above or below the box).
template <class S, int D, class F>
void each_part(const heightfield<S, D>& h, const aabb<double, D>& box, F&& f) {
    const auto& g = *h.geometry;
    if (!overlap(g.box, box)) return;
    const detail::cells_between along_x(box.lower.x, box.upper.x, g.step_x, g.cells_x());
    detail::cells_between along_z(0, 0, 1, 1);
    if constexpr (D == 3) along_z = detail::cells_between(box.lower.z, box.upper.z, g.step_z, g.cells_z());
    for (std::uint32_t z = along_z.first; z < along_z.last; ++z)
        for (std::uint32_t x = along_x.first; x < along_x.last; ++x) {
            double low = min(g.height(x, z), g.height(x + 1, z)), high = max(g.height(x, z), g.height(x + 1, z));
            if constexpr (D == 3) {
                low = min(low, min(g.height(x, z + 1), g.height(x + 1, z + 1)));
                high = max(high, max(g.height(x, z + 1), g.height(x + 1, z + 1)));
            }
            if (low > box.upper.y || high < box.lower.y || !g.solid(x, z)) continue;
            detail::cell_parts(g, x, z, f);
        }
}
/// For rays: calls f with the parts that a segment may meet; f returns up to which part of it the search goes on. Cost:
/// O(cells above or below it, and rows between its ends).
template <class S, int D, class F>
void each_part_along(const heightfield<S, D>& h, const detail::box_ray<D>& ray, F&& f) {
    const auto& g = *h.geometry;
    aabb<double, D> around = ray.bounds();
    double maximum = 1;
    if (!overlap(g.box, around)) return;
    detail::cells_between along_z(0, 0, 1, 1);
    if constexpr (D == 3) along_z = detail::cells_between(around.lower.z, around.upper.z, g.step_z, g.cells_z());
    for (std::uint32_t z = along_z.first; z < along_z.last; ++z) {
        if (D == 3 && !ray.bounds_between(D - 1, z * g.step_z, (z + 1) * g.step_z, around)) continue;
        const detail::cells_between along_x(around.lower.x, around.upper.x, g.step_x, g.cells_x());
        for (std::uint32_t x = along_x.first; x < along_x.last; ++x) {
            if (!ray.meets(cell_box(g, x, z), maximum) || !g.solid(x, z)) continue;
            for (int k = 0; k < D - 1; ++k) maximum = f(cell_face(g, x, z, k));
        }
    }
}

/// What a heightfield is like besides its heights.
struct heightfield_settings {
    /// Null, or one byte for each cell between samples, row by row: cells with a byte other than 0 are holes.
    const std::uint8_t* holes = nullptr;
    /// In 3D cells are cut along the diagonal from the sample with the lowest x and z to that with the highest; if
    /// this is true, every second one along the other, as on a chessboard.
    bool alternating = false;
    /// Bodies are stopped from below too.
    bool two_sided = false;
};

/// Heights above a regular grid, built once and shared by all heightfields made of it, and by worlds that hold such:
/// one number a sample, found by arithmetic. Bodies glide from cell to cell without a bump. The first sample is at
/// x = 0 (and z = 0) of the shape's frame; y is up. Contacts name cells by their number, of triangles twice that and 1
/// more for the one at the higher x.
///
/// A body whose centre is below the surface passes through it, unless it is two-sided: a surface is no volume.
template <class S, int D>
class heightfield_geometry {
public:
    /// No heightfield: what build() gives in builds without exceptions when it has refused.
    heightfield_geometry() = default;

    /// In 2D: heights (m) from left to right, spacing (m) apart. Refuses NaN and infinity, fewer than 2 samples,
    /// a spacing that is not greater than 0, and coordinates beyond 1e30 or a quarter of the range of S. O(n).
    [[nodiscard]] static heightfield_geometry build(const S* heights, std::uint32_t count, S spacing,
                                                    const heightfield_settings& settings = {}) requires(D == 2) {
        return heightfield_geometry(build_in_float_scope(heights, count, 1, spacing, S(1), settings));
    }
    template <array_of<S> Heights>
    [[nodiscard]] static heightfield_geometry build(const Heights& heights, S spacing,
                                                    const heightfield_settings& settings = {}) requires(D == 2) {
        if (!detail::check_count("heightfield_geometry::build", "heights", heights)) return {};
        return build(heights.data(), detail::count_of(heights), spacing, settings);
    }
    [[nodiscard]] static heightfield_geometry build(std::initializer_list<S> heights, S spacing,
                                                    const heightfield_settings& settings = {}) requires(D == 2) {
        return heightfield_geometry(build_in_float_scope(heights.begin(), static_cast<std::uint32_t>(heights.size()), 1,
                                                         spacing, S(1), settings));
    }
    /// In 3D: heights[row * columns + column] (m), columns spacing_x apart along x, rows spacing_z along z. Refuses
    /// what the other does, fewer than 2 columns or rows, and more than 2^31 samples. O(n).
    [[nodiscard]] static heightfield_geometry build(const S* heights, std::uint32_t columns, std::uint32_t rows,
                                                    S spacing_x, S spacing_z,
                                                    const heightfield_settings& settings = {}) requires(D == 3) {
        return heightfield_geometry(build_in_float_scope(heights, columns, rows, spacing_x, spacing_z, settings));
    }
    template <array_of<S> Heights>
    [[nodiscard]] static heightfield_geometry build(const Heights& heights, std::uint32_t columns, std::uint32_t rows,
                                                    S spacing_x, S spacing_z,
                                                    const heightfield_settings& settings = {}) requires(D == 3) {
        if (!detail::check_grid("heightfield_geometry::build", "heights", heights, columns, rows)) return {};
        return build(heights.data(), columns, rows, spacing_x, spacing_z, settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] heightfield<S, D> shape(S radius = S(0)) const { return {data(), radius}; }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::heightfield_data<detail::hull_real<S>, D>* data() const { return owner_.get(); }

private:
    using real = detail::hull_real<S>;
    using block = detail::heightfield_data<real, D>;

    explicit heightfield_geometry(const block* built) : owner_(built) {}
    static const block* build_in_float_scope(const S* heights, std::uint32_t columns, std::uint32_t rows, S spacing_x,
                                             S spacing_z, const heightfield_settings& settings) {
        return detail::scoped([&] { return built(heights, columns, rows, spacing_x, spacing_z, settings); });
    }
    static const block* built(const S* heights, std::uint32_t columns, std::uint32_t rows, S spacing_x, S spacing_z,
                              const heightfield_settings& settings) {
        constexpr const char* f = "heightfield_geometry::build";
        const std::uint64_t samples = std::uint64_t{columns} * rows;
        if (!at_least_2(f, D == 2 ? "number of samples" : "columns", columns) ||
            (D == 3 && !at_least_2(f, "rows", rows)) ||
            !detail::check_spacing(f, D == 2 ? "spacing" : "spacing_x", spacing_x) ||
            !detail::check_spacing(f, "spacing_z", spacing_z))
            return nullptr;
        if (samples > 0x80000000u) {
            detail::refuse(f, "number of samples", static_cast<double>(samples), "it must be at most 2^31");
            return nullptr;
        }
        if (!detail::check_array(f, "heights", heights, samples)) return nullptr;
        const auto n = static_cast<std::uint32_t>(samples);
        double reach = max(static_cast<double>(spacing_x) * (columns - 1), static_cast<double>(spacing_z) * (rows - 1));
        buffer<real> taken;
        taken.reserve(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            if (!detail::check_item(f, "heights", i, heights[i])) return nullptr;
            const double height = static_cast<double>(heights[i]);
            taken.push_back(static_cast<real>(height));
            reach = max(reach, abs(height));
        }
        if (!detail::check_reach<S>(f, reach)) return nullptr;
        return block::make(taken.begin(), columns, rows, static_cast<double>(spacing_x), static_cast<double>(spacing_z),
                           settings.holes, settings.alternating, settings.two_sided);
    }
    static bool at_least_2(const char* function, const char* field, std::uint32_t n) {
        return n >= 2 || detail::refuse(function, field, static_cast<double>(n), "it must be at least 2");
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END
