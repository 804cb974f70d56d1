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
            for (std::uint32_t l = 0; l < j.height; ++l) {
                const std::uint32_t at = of.panel_rows[j.panel_rows + l];
                for (std::uint32_t k = 0; k < j.row_count && k <= l; ++k) {
                    const std::uint32_t r = j.first_row + k;
                    const K& a = matrix[j.panel + l * j.row_count + k];
                    result[at] = result[at] + a * x[r];
                    if (l != k) result[r] = result[r] + a * x[at];
                }
            }
        }
    }
    /// L D L^T of the rows that are in; the others have a diagonal of 1.
    void factorise(bool corrects) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            for (std::uint32_t l = 0; l < j.height; ++l) {
                const std::uint32_t at = of.panel_rows[j.panel_rows + l];
                for (std::uint32_t k = 0; k < j.row_count; ++k) {
                    const std::uint32_t n = j.panel + l * j.row_count + k;
                    const entry& w = row[j.first_row + k];
                    if (l == k)
                        factors[n] = select_greater(
                            w.in, zero, matrix[n] + matrix[n] * (corrects ? w.slack + w.far : w.slack) + w.softness,
                            one);
                    else factors[n] = matrix[n] * (w.in * row[at].in);
                }
            }
        }
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            const std::uint32_t width = j.row_count;
            K* const panel = factors + j.panel;
            for (std::uint32_t k = 0; k < width; ++k) {
                entry& w = row[j.first_row + k];
                // What is left of a row that others say already is rounding: it gives way.
                const K own = matrix[j.panel + k * width + k], left = panel[k * width + k];
                const K says_nothing = select_greater(own * K::broadcast(tolerance), left, one, zero);
                w.leak = own * says_nothing * w.in * K::broadcast(C(give_way));
                w.inverse_pivot = lane_reciprocal(max(left, zero) + w.leak);
                for (std::uint32_t l = k + 1; l < j.height; ++l) {
                    const K kept = panel[l * width + k], scaled = kept * w.inverse_pivot;
                    panel_[l * width + k] = kept;
                    for (std::uint32_t m = k + 1; m <= l && m < width; ++m)
                        panel[l * width + m] = panel[l * width + m] - scaled * panel_[m * width + k];
                    panel[l * width + k] = scaled;
                }
            }
            for (std::uint32_t n = j.updates; n < of.joints[i + 1].updates; ++n) {
                const joint_pattern::update& u = of.updates[n];
                for (std::uint32_t l = 0; l < u.rows; ++l)
                    for (std::uint32_t m = 0; m < u.columns; ++m) {
                        K sum = panel[(u.first + l) * width] * panel_[(u.other + m) * width];
                        for (std::uint32_t k = 1; k < width; ++k)
                            sum = sum + panel[(u.first + l) * width + k] * panel_[(u.other + m) * width + k];
                        factors[u.to + l * u.stride + m] = factors[u.to + l * u.stride + m] - sum;
                    }
            }
        }
    }
    /// The right-hand sides become what rows are to give.
    void substitute() {
        for (std::uint32_t r = 0; r < of.row_count; ++r) row[r].right_hand = row[r].right_hand * row[r].in;
        for (std::uint32_t i = 0; i < of.joint_count; ++i) {
            const joint_pattern::joint& j = of.joints[i];
            const K* const panel = factors + j.panel;
            for (std::uint32_t k = 0; k < j.row_count; ++k) {
                const K x = row[j.first_row + k].right_hand;
                for (std::uint32_t l = k + 1; l < j.height; ++l) {
                    K& to = row[of.panel_rows[j.panel_rows + l]].right_hand;
                    to = to - panel[l * j.row_count + k] * x;
                }
            }
        }
        for (std::uint32_t i = of.joint_count; i-- > 0;) {
            const joint_pattern::joint& j = of.joints[i];
            const K* const panel = factors + j.panel;
            for (std::uint32_t k = j.row_count; k-- > 0;) {
                entry& w = row[j.first_row + k];
                K x = w.right_hand * w.inverse_pivot;
                for (std::uint32_t l = k + 1; l < j.height; ++l)
                    x = x - panel[l * j.row_count + k] * row[of.panel_rows[j.panel_rows + l]].right_hand;
                w.right_hand = x;
            }
        }
    }

private:
    /// How far a row gives way that others say already, as a part of its diagonal.
    static constexpr double give_way = 0x1p-10;

    /// Of the panel that is eliminated, before it is divided by its pivots.
    K* panel_;
};

}  // namespace detail

PHYSICS_HPP_END
