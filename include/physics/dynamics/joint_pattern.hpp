// Which joints are solved directly, and in what order their rows are eliminated.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/dynamics/graph.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A joint as a part of a graph.
struct graph_joint {
    body_pair ends;
    bool pushes_a, pushes_b;
    /// Of a list of kinds, and of the joints of that kind.
    std::uint32_t kind, number;
    /// Bit k: row k is on, and is a spring, and has bounds.
    std::uint32_t rows, springs, bounded;
};

/// The matrix of the rows of some joints, J M^-1 J^T, and its factors: where each entry is. Joints that push the same
/// body are coupled. Joints are eliminated in their order here; of each the rows and what they are coupled to later on
/// form a panel, by rows: its own rows, then those of later joints.
struct joint_pattern {
    struct joint {
        std::uint32_t kind, rows;
        /// Bodies by their numbers in the pattern.
        std::uint32_t a, b;
        std::uint32_t first_row, row_count;
        std::uint32_t panel, height;
        /// Where the numbers of the panel's rows begin in `panel_rows`, and its updates and couplings in the lists.
        std::uint32_t panel_rows, updates, couplings;

        /// Calls f(row, which of the joint's rows it is).
        template <class F>
        void each_row(F&& f) const {
            std::uint32_t r = first_row;
            for (int k = 0; k < 32; ++k)
                if ((rows >> k & 1) != 0) f(r++, k);
        }
    };
    /// Rows of a panel that are to be taken, times others of it, from a later panel.
    struct update {
        std::uint32_t to, stride, first, rows, other, columns;
    };
    /// Two joints that push the same body: the entries of the later one's rows in the panel of the first.
    struct coupling {
        std::uint32_t later, to, body;
        bool first_is_b, later_is_b;
    };

    /// With one more joint, where lists end.
    joint* joints;
    std::uint32_t joint_count, body_count, row_count, entries;
    std::uint32_t* panel_rows;
    update* updates;
    coupling* couplings;
    /// Multiplications of a factorisation.
    std::uint64_t cost;
};

/// The components of a graph of joints, with a pattern if they are worth solving directly: equal ones share it.
class joint_patterns {
public:
    struct component {
        /// Its joints in the order of elimination, as a range of `order`, and the pattern; null: too dear.
        std::uint32_t first, count;
        const joint_pattern* pattern;
    };

    /// Of joints in a world of so many bodies; those whose factorisation takes more than `max_cost` multiplications a
    /// row have no pattern. O(joints), and where they are solved directly the size of their factors.
    joint_patterns(const graph_joint* joints, std::uint32_t count, std::uint32_t bodies, std::uint32_t max_cost,
                   arena& scratch)
        : joints_(joints), count_(count), max_cost_(max_cost), scratch_(scratch) {
        order_ = scratch.allocate<std::uint32_t>(count);
        components_ = scratch.allocate<component>(count);
        first_ = filled(bodies, none);
        next_ = scratch.allocate<std::uint32_t>(2 * count);
        for (std::uint32_t j = count; j-- > 0;) {
            if (joints[j].pushes_a) link(j, 0, joints[j].ends.a);
            if (joints[j].pushes_b) link(j, 1, joints[j].ends.b);
        }
        seen_ = filled(count, 0);
        local_ = filled(bodies, none);
        std::uint32_t at = 0;
        for (std::uint32_t j = 0; j < count; ++j)
            if (seen_[j] == 0) at = add_component(j, at);
    }

    [[nodiscard]] std::uint32_t size() const { return component_count_; }
    [[nodiscard]] const component& operator[](std::uint32_t i) const { return components_[i]; }
    /// Numbers of the component's joints.
    [[nodiscard]] const std::uint32_t* order() const { return order_; }

private:
    static constexpr std::uint32_t none = null_index;

    std::uint32_t* filled(std::uint32_t count, std::uint32_t value) {
        auto* const all = scratch_.allocate<std::uint32_t>(count);
        for (std::uint32_t i = 0; i < count; ++i) all[i] = value;
        return all;
    }
    void link(std::uint32_t j, std::uint32_t side, std::uint32_t body) {
        next_[2 * j + side] = first_[body];
        first_[body] = 2 * j + side;
    }
    /// Calls f(joint, whether the body is its B) for those that push a body.
    template <class F>
    void each_of(std::uint32_t body, F&& f) const {
        for (std::uint32_t n = first_[body]; n != none; n = next_[n]) f(n / 2, n % 2 == 1);
    }
    /// Calls f(body) for those that a joint pushes.
    template <class F>
    static void each_pushed(const graph_joint& j, F&& f) {
        if (j.pushes_a) f(j.ends.a);
        if (j.pushes_b) f(j.ends.b);
    }
    /// Breadth first from a joint; writes to order_ from `at` on, and gives the end.
    std::uint32_t walk(std::uint32_t from, std::uint32_t at, std::uint32_t mark) {
        std::uint32_t end = at;
        order_[end++] = from;
        seen_[from] = mark;
        for (std::uint32_t i = at; i < end; ++i)
            each_pushed(joints_[order_[i]], [&](std::uint32_t body) {
                each_of(body, [&](std::uint32_t j, bool) {
                    if (seen_[j] == mark) return;
                    seen_[j] = mark;
                    order_[end++] = j;
                });
            });
        return end;
    }
    /// The component of a joint, whose joints begin at `at` in the order; gives where they end. From what is fixed on
    /// outwards; leaves are eliminated first, which couples no joints of a tree that were not.
    std::uint32_t add_component(std::uint32_t j, std::uint32_t at) {
        std::uint32_t end = walk(j, at, 1), from = j;
        for (std::uint32_t i = at; i < end; ++i) {
            const graph_joint& one = joints_[order_[i]];
            const graph_joint& best = joints_[from];
            const bool is_fixed = !one.pushes_a || !one.pushes_b, was_fixed = !best.pushes_a || !best.pushes_b;
            if ((is_fixed && !was_fixed) || (is_fixed == was_fixed && order_[i] < from)) from = order_[i];
        }
        end = walk(from, at, 2);
        for (std::uint32_t i = at, k = end; i + 1 < k;) std::swap(order_[i++], order_[--k]);
        components_[component_count_++] = {at, end - at, pattern_of(order_ + at, end - at)};
        return end;
    }

    struct known {
        const joint_pattern* pattern;
        std::uint64_t hash;
        known* next;
        /// Of a pattern that was found to be too dear there is none.
        const std::uint32_t* order;
        std::uint32_t count;
    };
    /// A pattern that is alike, or a new one.
    const joint_pattern* pattern_of(const std::uint32_t* order, std::uint32_t count) {
        auto* const joints = scratch_.allocate<joint_pattern::joint>(count + 1);
        std::uint32_t bodies = 0, rows = 0;
        const auto number = [&](std::uint32_t body, bool is_pushed) {
            if (!is_pushed) return bodies++;
            if (local_[body] == none) local_[body] = bodies++;
            return local_[body];
        };
        std::uint64_t hash = count;
        const auto add = [&](std::uint64_t word) { hash = (hash ^ word) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29; };
        for (std::uint32_t i = 0; i < count; ++i) {
            const graph_joint& j = joints_[order[i]];
            joint_pattern::joint& to = joints[i] = {};
            to.kind = j.kind;
            to.rows = j.rows;
            to.a = number(j.ends.a, j.pushes_a);
            to.b = number(j.ends.b, j.pushes_b);
            to.first_row = rows;
            to.row_count = static_cast<std::uint32_t>(std::popcount(j.rows));
            rows += to.row_count;
            add(std::uint64_t{to.kind} << 34 | std::uint64_t{j.pushes_a} << 33 | std::uint64_t{j.pushes_b} << 32 |
                to.rows);
            add(std::uint64_t{to.a} << 32 | to.b);
            add(std::uint64_t{j.springs} << 32 | j.bounded);
        }
        for (std::uint32_t i = 0; i < count; ++i)
            each_pushed(joints_[order[i]], [&](std::uint32_t body) { local_[body] = none; });
        const auto is_alike = [&](const known& k) {
            if (k.hash != hash || k.count != count) return false;
            for (std::uint32_t i = 0; i < count; ++i) {
                const graph_joint &one = joints_[order[i]], &other = joints_[k.order[i]];
                if (one.kind != other.kind || one.rows != other.rows || one.springs != other.springs ||
                    one.bounded != other.bounded || one.pushes_a != other.pushes_a || one.pushes_b != other.pushes_b)
                    return false;
                if (k.pattern != nullptr &&
                    (joints[i].a != k.pattern->joints[i].a || joints[i].b != k.pattern->joints[i].b))
                    return false;
            }
            return true;
        };
        for (const known* k = known_[hash % buckets]; k != nullptr; k = k->next)
            if (is_alike(*k)) return k->pattern;
        auto* const pattern = scratch_.allocate<joint_pattern>(1);
        *pattern = {joints, count, bodies, rows, 0, nullptr, nullptr, nullptr, 0};
        const joint_pattern* const result = rows > 0 && find_entries(*pattern, order) ? pattern : nullptr;
        known_[hash % buckets] =
            new (scratch_.allocate<known>(1)) known{result, hash, known_[hash % buckets], order, count};
        return result;
    }

    /// Which entries there are, and what is to be done with them; false if that is too much.
    bool find_entries(joint_pattern& of, const std::uint32_t* order) {
        const std::uint32_t count = of.joint_count;
        // Of each joint the later ones that it is coupled to, by itself or by what was eliminated before.
        const std::uint32_t** later = scratch_.allocate<const std::uint32_t*>(count);
        std::uint32_t* later_count = scratch_.allocate<std::uint32_t>(count);
        std::uint32_t *child = filled(count, none), *sibling = filled(count, none), *marked = filled(count, none);
        std::uint32_t* place = scratch_.allocate<std::uint32_t>(count_);
        for (std::uint32_t i = 0; i < count; ++i) place[order[i]] = i;
        std::uint32_t* found = scratch_.allocate<std::uint32_t>(count);
        std::uint32_t panel_rows = 0, updates = 0, couplings = 0;
        const std::uint64_t limit = std::uint64_t{max_cost_} * of.row_count;
        for (std::uint32_t i = 0; i < count; ++i) {
            std::uint32_t n = 0;
            const auto add = [&](std::uint32_t k) {
                if (k <= i || marked[k] == i) return;
                marked[k] = i;
                found[n++] = k;
            };
            each_pushed(joints_[order[i]], [&](std::uint32_t body) {
                each_of(body, [&](std::uint32_t j, bool) {
                    add(place[j]);
                    if (place[j] > i) ++couplings;
                });
            });
            for (std::uint32_t c = child[i]; c != none; c = sibling[c])
                for (std::uint32_t k = 0; k < later_count[c]; ++k) add(later[c][k]);
            for (std::uint32_t k = 1; k < n; ++k)
                for (std::uint32_t l = k; l > 0 && found[l - 1] > found[l]; --l) std::swap(found[l - 1], found[l]);
            joint_pattern::joint& at = of.joints[i];
            at.panel = of.entries;
            at.height = at.row_count;
            at.panel_rows = panel_rows;
            for (std::uint32_t k = 0; k < n; ++k) at.height += of.joints[found[k]].row_count;
            of.entries += at.height * at.row_count;
            panel_rows += at.height;
            of.cost += std::uint64_t{at.height} * at.height * at.row_count;
            if (of.cost > limit || of.entries > max_entries) return false;
            updates += n * (n + 1) / 2;
            auto* const kept = scratch_.allocate<std::uint32_t>(n);
            for (std::uint32_t k = 0; k < n; ++k) kept[k] = found[k];
            later[i] = kept;
            later_count[i] = n;
            if (n > 0) {
                sibling[i] = child[kept[0]];
                child[kept[0]] = i;
            }
        }
        of.panel_rows = scratch_.allocate<std::uint32_t>(panel_rows);
        of.updates = scratch_.allocate<joint_pattern::update>(updates);
        of.couplings = scratch_.allocate<joint_pattern::coupling>(couplings);
        updates = couplings = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            joint_pattern::joint& at = of.joints[i];
            at.updates = updates;
            at.couplings = couplings;
            std::uint32_t row = at.panel_rows;
            const auto list_rows = [&](const joint_pattern::joint& j) {
                for (std::uint32_t k = 0; k < j.row_count; ++k) of.panel_rows[row++] = j.first_row + k;
            };
            list_rows(at);
            for (std::uint32_t k = 0; k < later_count[i]; ++k) list_rows(of.joints[later[i][k]]);
            // Where a later joint's rows are in the panel of another.
            const auto row_in = [&](std::uint32_t panel, std::uint32_t joint) {
                std::uint32_t result = of.joints[panel].row_count;
                for (std::uint32_t k = 0; later[panel][k] != joint; ++k) result += of.joints[later[panel][k]].row_count;
                return result;
            };
            std::uint32_t other = at.row_count;
            for (std::uint32_t k = 0; k < later_count[i]; ++k) {
                const joint_pattern::joint& to = of.joints[later[i][k]];
                std::uint32_t first = other;
                for (std::uint32_t l = k; l < later_count[i]; ++l) {
                    const joint_pattern::joint& from = of.joints[later[i][l]];
                    const std::uint32_t in = l == k ? 0 : row_in(later[i][k], later[i][l]);
                    of.updates[updates++] = {
                        to.panel + in * to.row_count, to.row_count, first, from.row_count, other, to.row_count};
                    first += from.row_count;
                }
                other += to.row_count;
            }
            const graph_joint& one = joints_[order[i]];
            for (const bool is_b : {false, true}) {
                if (!(is_b ? one.pushes_b : one.pushes_a)) continue;
                each_of(is_b ? one.ends.b : one.ends.a, [&](std::uint32_t j, bool later_is_b) {
                    if (place[j] <= i) return;
                    of.couplings[couplings++] = {place[j], at.panel + row_in(i, place[j]) * at.row_count,
                                                 is_b ? at.b : at.a, is_b, later_is_b};
                });
            }
        }
        of.joints[count] = {};
        of.joints[count].updates = updates;
        of.joints[count].couplings = couplings;
        return true;
    }

    static constexpr std::uint32_t buckets = 64, max_entries = 1u << 22;

    const graph_joint* joints_;
    std::uint32_t count_, max_cost_;
    arena& scratch_;
    std::uint32_t* order_;
    component* components_;
    std::uint32_t component_count_ = 0;
    /// Of each body its joints, as a list of 2 joint + side.
    std::uint32_t *first_, *next_;
    std::uint32_t *seen_, *local_;
    known* known_[buckets] = {};
};

}  // namespace detail

PHYSICS_HPP_END
