// The matrix of the rows of joints, J M^-1 J^T, and its factors.
#pragma once

#include "physics/base/lane_math.hpp"
#include "physics/dynamics/joint_pattern.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Memory of a step for values that are set to T(): vectors may be aligned to more than what an arena gives.
template <class T>
T* made(std::uint32_t count, arena& scratch) {
    const auto bytes = static_cast<std::uint32_t>(count * sizeof(T) + alignof(T));
    auto* const place = scratch.template allocate<unsigned char>(bytes);
    const std::uintptr_t off = reinterpret_cast<std::uintptr_t>(place) % alignof(T);
    auto* const all = reinterpret_cast<T*>(place + (off == 0 ? 0 : alignof(T) - off));
    for (std::uint32_t i = 0; i < count; ++i) new (all + i) T();
    return all;
}

/// Matrices with a pattern, one in each lane. `tolerance`: what is left of a row's diagonal is more as it is
/// eliminated, unless other rows say the same.
template <class K>
struct joint_matrix {
    using C = typename K::scalar;
    /// What is kept of a row.
    struct entry {
        /// Whether it is in the solve (1) or not (0); and of springs what is added to the diagonal.
        K in, softness;
        /// As parts of their diagonals, how far rows give way: that have bounds; and, where errors are taken back, that
        /// are far from what they are to hold.
        K slack, far;
        /// As a part of its diagonal, what may be noise of a row in a loop, since directions are as far off as joints
        /// are: speeds are solved for as if no less were left of it, and so approached in several solves.
        K noise;
        /// Of rows that others say already: how much they give way under what they bear.
        K leak;
        K right_hand, inverse_pivot;
    };

    const joint_pattern& of;
    C tolerance;
    entry* row;
    K *matrix, *factors;

    joint_matrix(const joint_pattern& pattern, C tolerance_, arena& scratch) : of(pattern), tolerance(tolerance_) {
        row = made<entry>(of.row_count, scratch);
        matrix = made<K>(of.entries, scratch);
        factors = made<K>(of.entries, scratch);
        std::uint32_t largest = 0;
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const std::uint32_t size = of.joints[i].height * of.joints[i].row_count;
            largest = size > largest ? size : largest;
        }
        panel_ = made<K>(largest, scratch);
    }

    [[nodiscard]] const K& diagonal(const joint_pattern::joint& j, std::uint32_t r) const {
        return matrix[j.panel + (r - j.first_row) * (j.row_count + 1)];
    }
    /// The matrix times x, of all rows.
    void multiply(const K* x, K* result) const {
        for (std::uint32_t r = 0; r < of.row_count; ++r) result[r] = K::broadcast(C(0));
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            const std::uint32_t width = j.row_count;
            const K* const own_x = x + j.first_row;
            K* const own = result + j.first_row;
            const K* a = matrix + j.panel;
            for (std::uint32_t l = 0; l < width; ++l, a += width) {
                K sum = own[l] + a[l] * own_x[l];
                for (std::uint32_t k = 0; k < l; ++k) {
                    sum = sum + a[k] * own_x[k];
                    own[k] = own[k] + a[k] * own_x[l];
                }
                own[l] = sum;
            }
            for (std::uint32_t l = width; l < j.height; ++l, a += width) {
                const std::uint32_t at = of.panel_rows[j.panel_rows + l];
                const K of_later = x[at];
                K sum = result[at];
                for (std::uint32_t k = 0; k < width; ++k) {
                    sum = sum + a[k] * own_x[k];
                    own[k] = own[k] + a[k] * of_later;
                }
                result[at] = sum;
            }
        }
    }
    /// L D L^T of the rows that are in; the others have a diagonal of 1.
    void factorise(bool corrects) {
        fill(corrects);
        for (std::uint32_t i = 0; i < of.joint_count; ++i) eliminate(i, corrects);
    }
    /// The right-hand sides become what rows are to give.
    void substitute() {
        for (std::uint32_t r = 0; r < of.row_count; ++r) row[r].right_hand = row[r].right_hand * row[r].in;
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            entry* const own = row + j.first_row;
            const K* a = factors + j.panel;
            for (std::uint32_t l = 0; l < j.height; ++l, a += j.row_count) {
                K& to = row[of.panel_rows[j.panel_rows + l]].right_hand;
                K x = to;
                for (std::uint32_t k = 0; k < l && k < j.row_count; ++k) x = x - a[k] * own[k].right_hand;
                to = x;
            }
        }
        for (std::uint32_t i = of.joint_count; i-- > 0;) {
            const joint_pattern::joint& j = of.joints[i];
            entry* const own = row + j.first_row;
            for (std::uint32_t k = 0; k < j.row_count; ++k)
                own[k].right_hand = own[k].right_hand * own[k].inverse_pivot;
            const K* a = factors + j.panel + j.height * j.row_count;
            for (std::uint32_t l = j.height; l-- > 0;) {
                a -= j.row_count;
                const K x = row[of.panel_rows[j.panel_rows + l]].right_hand;
                for (std::uint32_t k = 0; k < l && k < j.row_count; ++k)
                    own[k].right_hand = own[k].right_hand - a[k] * x;
            }
        }
    }

private:
    /// The factors as the matrix, of the rows that are in.
    void fill(bool corrects) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            const std::uint32_t width = j.row_count;
            const entry* const own = row + j.first_row;
            const K* from = matrix + j.panel;
            K* to = factors + j.panel;
            for (std::uint32_t l = 0; l < j.height; ++l, from += width, to += width) {
                const K in = row[of.panel_rows[j.panel_rows + l]].in;
                for (std::uint32_t k = 0; k < width; ++k) to[k] = from[k] * (own[k].in * in);
                if (l >= width) continue;
                const entry& w = own[l];
                const K gives = corrects ? w.slack + w.far : w.slack;
                to[l] = select_greater(w.in, zero, from[l] + from[l] * gives + w.softness, one);
            }
        }
    }
    /// The rows of a joint: its panel, and what that takes from later ones.
    void eliminate(std::uint32_t i, bool corrects) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        const joint_pattern::joint& j = of.joints[i];
        const std::uint32_t width = j.row_count;
        K* const panel = factors + j.panel;
        for (std::uint32_t k = 0; k < width; ++k) {
            entry& w = row[j.first_row + k];
            // What is left of a row that others say already is rounding: it gives way.
            const K own = matrix[j.panel + k * width + k], left = panel[k * width + k];
            const K says_nothing = select_greater(own * K::broadcast(tolerance), left, one, zero);
            w.leak = own * says_nothing * w.in * K::broadcast(C(give_way));
            const K floor = corrects ? zero : own * w.noise * w.in;
            const K inverse_pivot = lane_reciprocal(max(max(left, zero) + w.leak, floor));
            w.inverse_pivot = inverse_pivot;
            for (std::uint32_t l = k + 1; l < j.height; ++l) {
                K* const at = panel + l * width;
                const K kept = at[k], scaled = kept * inverse_pivot;
                panel_[l * width + k] = kept;
                for (std::uint32_t m = k + 1; m <= l && m < width; ++m) at[m] = at[m] - scaled * panel_[m * width + k];
                at[k] = scaled;
            }
        }
        for (std::uint32_t n = j.updates; n < of.joints[i + 1].updates; ++n) {
            const joint_pattern::update& u = of.updates[n];
            for (std::uint32_t l = 0; l < u.rows; ++l) {
                const K* const x = panel + (u.first + l) * width;
                K* const to = factors + u.to + l * u.stride;
                // Of a joint with itself half is enough.
                const std::uint32_t columns = u.first == u.other ? l + 1 : u.columns;
                for (std::uint32_t m = 0; m < columns; ++m) {
                    const K* const y = panel_ + (u.other + m) * width;
                    K sum = x[0] * y[0];
                    for (std::uint32_t k = 1; k < width; ++k) sum = sum + x[k] * y[k];
                    to[m] = to[m] - sum;
                }
            }
        }
    }

    /// How far a row gives way that others say already, as a part of its diagonal.
    static constexpr double give_way = 0x1p-10;

    /// Of the panel that is eliminated, before it is divided by its pivots.
    K* panel_;
};

}  // namespace detail

PHYSICS_HPP_END
