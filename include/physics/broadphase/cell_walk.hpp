// Rays through cells.
#pragma once

#include "physics/broadphase/box_tests.hpp"
#include "physics/broadphase/cell_level.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A ray that walks through layers of cells across the axis along which it moves most: boxes that it meets begin in
/// the layer or in the few cells before, and each cell is in one layer. Source: after Amanatides, Woo, A fast voxel
/// traversal algorithm (1987), in blocks of cells for boxes that are not points.
template <class S, int D>
class cell_walk {
public:
    cell_walk(const ray<S, D>& r, const vec<S, D>& origin, float step) : step_(static_cast<double>(step)) {
        for (int i = 0; i < D; ++i) {
            from_[i] = static_cast<double>(r.origin[i]) - static_cast<double>(origin[i]);
            way_[i] = static_cast<double>(r.translation[i]);
            extent_[i] = static_cast<double>(r.extent[i]);
            const double size = (from_[i] < 0 ? -from_[i] : from_[i]) + (way_[i] < 0 ? -way_[i] : way_[i]) + extent_[i];
            largest_ = size > largest_ ? size : largest_;
            main_ = way_[i] * way_[i] > way_[main_] * way_[main_] ? i : main_;
        }
    }

    /// Calls visit(range) for blocks of cells of a level in which there may be boxes that the ray meets, in the order
    /// of the ray, until it returns false or `reach`, a fraction of the translation that visit may lower, is passed.
    /// False, and nothing is visited, where that would be more than so many cells.
    template <class Visit>
    bool each_layer(const cell_level<D>& level, const float& reach, std::uint32_t max_cells, Visit&& visit) const {
        const int m = main_;
        const double side = static_cast<double>(level.reach), cell = static_cast<double>(level.cell);
        // As exact as coordinates of cells, and as numbers of the exact test.
        const double pad = cell / 4 + largest_ * (1e-6 + step_), limit = static_cast<double>(reach);
        if (!(largest_ < 1e18) || !(side < 1e30) || way_[m] == 0) return false;
        const bool forward = way_[m] > 0;
        const double end = from_[m] + way_[m] * limit;
        const double low_end = (forward ? from_[m] : end) - extent_[m] - side - pad;
        const double high_end = (forward ? end : from_[m]) + extent_[m] + pad;
        const std::uint32_t lowest = level.at(m, to_float(low_end)), highest = level.at(m, to_float(high_end));
        const std::uint32_t layers = highest - lowest + 1;
        double cells = layers;
        for (int i = 0; i < D; ++i)
            if (i != m) cells *= (2 * extent_[i] + side) / cell + 2;
        if (cells > max_cells) return false;
        for (std::uint32_t n = 0; n < layers; ++n) {
            const std::uint32_t at = forward ? lowest + n : highest - n;
            const double low = static_cast<double>(level.low[m]) + at * cell - pad - extent_[m];
            const double high = low + cell + side + 2 * (pad + extent_[m]);
            double enter = ((forward ? low : high) - from_[m]) / way_[m];
            double leave = ((forward ? high : low) - from_[m]) / way_[m];
            // Those at the border have no end.
            if (at == 0) (forward ? enter : leave) = forward ? 0 : limit;
            if (at == static_cast<std::uint32_t>(level.maximum[m])) (forward ? leave : enter) = forward ? limit : 0;
            enter = enter > step_ ? enter - step_ : -step_;
            leave = leave < limit ? leave + step_ : limit;
            if (enter > static_cast<double>(reach)) break;
            if (leave < enter) continue;
            float_box<D> slice;
            for (int i = 0; i < D; ++i) {
                const double a = from_[i] + way_[i] * enter, b = from_[i] + way_[i] * leave;
                slice.lower[i] = to_float((a < b ? a : b) - extent_[i] - pad);
                slice.upper[i] = to_float((a < b ? b : a) + extent_[i] + pad);
            }
            cell_range<D> range(level, slice);
            range.first[m] = range.last[m] = at;
            if (!visit(range)) break;
        }
        return true;
    }

private:
    double from_[D], way_[D], extent_[D], largest_ = 0, step_;
    int main_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
