// A tree of boxes over the parts of a shape, built once.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/handle.hpp"
#include "physics/base/sort.hpp"
#include "physics/shape/block_array.hpp"
#include "physics/shape/box_ray.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The nearest float below x, or one a little lower; 3e38 is endless.
inline float float_below(double x) {
    const double lower = x - abs(x) * 0x1p-23 - 0x1p-120;
    return static_cast<float>(lower > 3e38 ? 3e38 : lower < -3e38 ? -3e38 : lower);
}
/// A box in float that contains the box in double.
template <int D>
aabb<float, D> outward_floats(const aabb<double, D>& box) {
    aabb<float, D> result;
    for (int i = 0; i < D; ++i) {
        result.lower[i] = float_below(box.lower[i]);
        result.upper[i] = -float_below(-box.upper[i]);
    }
    return result;
}

/// A tree of boxes over numbered parts: nodes in the order of a walk that goes down first, each with the number of the
/// node that follows what is below it. Parts are halved by their middles along the axis on which these spread most,
/// down to four, so that no input makes it deeper than log2(n). Memory: 20 bytes a part in 3D, 16 in 2D.
/// Source: stackless walks are those of Smits, Efficiency issues for ray tracing (1998).
template <int D>
class part_tree {
public:
    static constexpr std::uint32_t parts_of_leaf = 4;
    static constexpr std::uint32_t nodes_for(std::uint32_t parts) {
        return parts == 0 ? 0 : 2 * ((parts - 1) / parts_of_leaf + 1) - 1;
    }

    /// The places that it needs in a block.
    struct places {
        std::size_t nodes, parts;
    };
    static places place(block_layout& layout, std::uint32_t parts) {
        const std::size_t nodes = layout.place<node>(nodes_for(parts));
        return {nodes, layout.place<std::uint32_t>(parts)};
    }
    /// Builds the tree over parts by their boxes. Cost: 0.3 us a part, and 16 bytes of scratch.
    void build(const geometry_block* block, places at, const aabb<float, D>* boxes, std::uint32_t count);

    [[nodiscard]] std::uint32_t size() const { return parts_.size(); }
    /// Calls f(number) for the parts in leaves whose boxes overlap the box: for all that do, and a few more. Neither
    /// recursion nor allocation. Cost: O(log n) and 5 ns a node.
    template <class F>
    void visit(const aabb<double, D>& box, F&& f) const {
        const aabb<float, D> wanted = outward_floats(box);
        const node* const nodes = nodes_.begin();
        const std::uint32_t end = nodes_.size();
        for (std::uint32_t i = 0; i < end;) {
            const node& n = nodes[i];
            if (!overlap(n.box, wanted)) {
                i = n.next;
                continue;
            }
            if (n.first != none) {
                const std::uint32_t last = min(n.first + parts_of_leaf, parts_.size());
                for (std::uint32_t k = n.first; k < last; ++k) f(parts_[k]);
            }
            ++i;
        }
    }
    /// Calls f(number) for the parts in leaves whose boxes a segment may meet, in the order of the tree; f returns the
    /// part of the segment up to which the search goes on. Cost: O(log n + parts met) and 10 ns a node.
    template <class F>
    void visit(const box_ray<D>& ray, F&& f) const {
        const node* const nodes = nodes_.begin();
        const std::uint32_t end = nodes_.size();
        double maximum = 1;
        for (std::uint32_t i = 0; i < end;) {
            const node& n = nodes[i];
            if (!ray.meets(n.box, maximum)) {
                i = n.next;
                continue;
            }
            if (n.first != none) {
                const std::uint32_t last = min(n.first + parts_of_leaf, parts_.size());
                for (std::uint32_t k = n.first; k < last; ++k) maximum = f(parts_[k]);
            }
            ++i;
        }
    }
    /// Calls f(box) for 32 to 64 boxes that contain all parts; for fewer where there are few.
    template <class F>
    void cover(F&& f) const {
        const std::uint32_t maximum = nodes_.size() / 32;
        for (std::uint32_t i = 0; i < nodes_.size();) {
            const node& n = nodes_[i];
            if (n.first != none || n.next - i <= maximum) {
                f(n.box);
                i = n.next;
            } else {
                ++i;
            }
        }
    }

private:
    static constexpr std::uint32_t none = null_index;
    struct node {
        aabb<float, D> box;
        std::uint32_t next;
        /// Of leaves where their parts begin, a multiple of 4.
        std::uint32_t first;
    };
    static std::uint32_t min(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
    static void halve(std::uint64_t* keys, std::uint64_t* scratch, std::uint32_t count, const aabb<float, D>* boxes);

    block_array<node> nodes_;
    block_array<std::uint32_t> parts_;
};

/// Brings keys, whose lower halves number parts, into the order of their middles along the axis on which they differ
/// most.
template <int D>
void part_tree<D>::halve(std::uint64_t* keys, std::uint64_t* scratch, std::uint32_t count,
                         const aabb<float, D>* boxes) {
    // Half of the sums, so that none overflows.
    const auto middle = [&](std::uint64_t key) {
        const aabb<float, D>& box = boxes[static_cast<std::uint32_t>(key)];
        return box.lower * 0.5f + box.upper * 0.5f;
    };
    vec<float, D> low = middle(keys[0]), high = low;
    for (std::uint32_t i = 1; i < count; ++i) {
        const vec<float, D> m = middle(keys[i]);
        low = physics::min(low, m);
        high = physics::max(high, m);
    }
    int axis = 0;
    for (int i = 1; i < D; ++i)
        if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
    for (std::uint32_t i = 0; i < count; ++i) {
        // Zero without a sign; then numbers ascend with their bits, negative ones descend.
        const auto bits = static_cast<std::uint32_t>(scalar_traits<float>::bits(middle(keys[i])[axis] + 0.0f));
        const std::uint32_t rank = bits >> 31 ? ~bits : bits | 0x80000000u;
        keys[i] = std::uint64_t{rank} << 32 | (keys[i] & 0xffffffffu);
    }
    const std::uint64_t* sorted = radix_sort(keys, scratch, count, 32, 64);
    if (sorted != keys) std::memcpy(keys, sorted, count * sizeof *keys);
}

template <int D>
void part_tree<D>::build(const geometry_block* block, places at, const aabb<float, D>* boxes, std::uint32_t count) {
    nodes_.attach(block, at.nodes, nodes_for(count));
    parts_.attach(block, at.parts, count);
    if (count == 0) return;
    buffer<std::uint64_t> keys, scratch;
    keys.resize(count);
    scratch.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) keys[i] = i;
    struct range {
        std::uint32_t first, count;
    } todo[40];
    int waiting = 0;
    todo[waiting++] = {0, count};
    // What waits longest is what lies to the right: nodes come in the order of the walk.
    for (std::uint32_t i = 0; waiting > 0; ++i) {
        const range r = todo[--waiting];
        nodes_[i].next = i + nodes_for(r.count);
        nodes_[i].first = none;
        if (r.count <= parts_of_leaf) {
            nodes_[i].first = r.first;
            continue;
        }
        halve(keys.begin() + r.first, scratch.begin() + r.first, r.count, boxes);
        const std::uint32_t left = (r.count / 2 + parts_of_leaf - 1) / parts_of_leaf * parts_of_leaf;
        todo[waiting++] = {r.first + left, r.count - left};
        todo[waiting++] = {r.first, left};
    }
    for (std::uint32_t i = 0; i < count; ++i) parts_[i] = static_cast<std::uint32_t>(keys[i]);
    for (std::uint32_t i = nodes_.size(); i-- > 0;) {
        node& n = nodes_[i];
        if (n.first == none) {
            n.box = merged(nodes_[i + 1].box, nodes_[nodes_[i + 1].next].box);
            continue;
        }
        n.box = boxes[parts_[n.first]];
        for (std::uint32_t k = n.first + 1; k < min(n.first + parts_of_leaf, count); ++k)
            n.box = merged(n.box, boxes[parts_[k]]);
    }
}

}  // namespace detail

PHYSICS_HPP_END
