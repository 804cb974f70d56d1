// Contact of two boxes in 2D, in lanes across pairs: separating axes and clipping without a branch.
#pragma once

#include "physics/base/lane_math.hpp"
#include "physics/collide/box_pair.hpp"
#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The numbers of W pairs of boxes: half extents of A and B, the position and the rotation of B in A's frame.
template <class P>
struct box_lanes2 {
    P ax, ay, bx, by, px, py, cosine, sine;
};

/// The manifolds of W pairs of boxes, and what the corners need where no edge leads.
template <class P>
struct box_contact_lanes2 {
    P normal_x, normal_y;
    P x[2], y[2], gap[2], feature[2];
    P count;
    /// Positive where boxes are near and their edges do not say how near: then a corner does.
    P missed;
    /// How far the best edge parts the boxes.
    P apart;
    /// Names the reference edge and the edge that faces it. Bit 1: whether the reference edge is one of B's.
    P edges;
};

/// Clips the edge of one box that faces the best edge of the other.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE box_contact_lanes2<P> touch_boxes(const box_lanes2<P>& in, const P& margin) {
    using S = typename P::scalar;
    const auto value = [](double x) { return P::broadcast(S(x)); };
    const P zero = value(0), half = value(0.5), one = value(1), two = value(2), c = in.cosine, s = in.sine;
    // A's center in B's frame is -q.
    const P qx = lane_sum(c, in.px, s, in.py), qy = lane_difference(c, in.py, s, in.px);
    const P apx = lane_abs(in.px), apy = lane_abs(in.py), ac = lane_abs(c), as = lane_abs(s);

    const P gap_ax = apx - in.ax - lane_sum(ac, in.bx, as, in.by);
    const P gap_ay = apy - in.ay - lane_sum(as, in.bx, ac, in.by);
    const P gap_bx = lane_abs(qx) - in.bx - lane_sum(ac, in.ax, as, in.ay);
    const P gap_by = lane_abs(qy) - in.by - lane_sum(as, in.ax, ac, in.ay);
    const P best_a = max(gap_ax, gap_ay), best_b = max(gap_bx, gap_by), apart = max(best_a, best_b);

    P size = max(in.ax, in.ay) + max(in.bx, in.by) + max(apx, apy);
    if constexpr (is_fixed<S>) size = max(size, one);
    const P smallest = min(min(in.ax, in.ay), min(in.bx, in.by));
    const P slack = max(smallest * value(1.0 / 1024), size * P::broadcast(rounding_of(S(1))));
    const P twice = slack + slack;

    // The boxes' turn but for quarters: which edge faces which. Of two that are as good the same one wins, so that
    // rounding does not choose. (A sign is one minus zero or two: those need no blend, and name the edges below.)
    const P minimum = ac + value(1.0 / 1024);
    const auto by_quarter = [&](const P& even, const P& odd) { return select_greater(as, minimum, odd, even); };
    const P quarter = by_quarter(zero, one), run = by_quarter(ac, as), nearest = by_quarter(c, s);
    const P back = select_greater(zero, nearest, two, zero), lean = by_quarter(s, -c) * (one - back);
    const P slope_in_a = lean / run;

    // A preference for A's edge keeps the reference from flipping between two that are alike.
    const P minimum_b = best_a + twice;
    const auto of_reference = [&](const P& a, const P& b) { return select_greater(best_b, minimum_b, b, a); };
    const P reference_x = of_reference(in.ax, in.bx), reference_y = of_reference(in.ay, in.by);
    const P incident_x = of_reference(in.bx, in.ax), incident_y = of_reference(in.by, in.ay);
    const P from_b = of_reference(zero, two), direction = one - from_b, flipped = from_b - one;
    const P steeper = of_reference(gap_ay - gap_ax, gap_by - gap_bx);
    const auto along_axis = [&](const P& x, const P& y) { return select_greater(steeper, zero, y, x); };
    const P axis = along_axis(zero, one), odd = axis - quarter, odd_square = odd * odd;
    const auto facing = [&](const P& x, const P& y) { return select_greater(odd_square, zero, y, x); };
    const P half_u = along_axis(reference_x, reference_y), half_v = along_axis(reference_y, reference_x);
    const P depth = facing(incident_x, incident_y), length = facing(incident_y, incident_x);

    // The reference edge's normal in A's frame, u, points at the other box; v leads along the edge.
    const P base_c = of_reference(one, c), base_s = of_reference(zero, s);
    const P axis_x = along_axis(base_c, -base_s), axis_y = along_axis(base_s, base_c);
    const P center_u = lane_sum(axis_x, in.px, axis_y, in.py) * direction;
    const P backward = select_greater(zero, center_u, two, zero), side = one - backward;
    const P n_x = axis_x * side, n_y = axis_y * side, normal_x = n_x * direction, normal_y = n_y * direction;

    // The incident edge: its middle, and its ends where they are within the reference edge's. Those are a little
    // farther out, so that rounding does not cut the corners of equal boxes.
    const P slope = slope_in_a * flipped, limit = half_v + slack, reach = run * length;
    const P middle_gap = center_u * side - half_u - run * depth;
    const P middle_v = lane_difference(normal_x, in.py, normal_y, in.px) + lean * flipped * depth;
    const P v0 = max(middle_v - reach, -limit), v1 = min(middle_v + reach, limit);
    const P gap0 = middle_gap + (v0 - middle_v) * slope, gap1 = middle_gap + (v1 - middle_v) * slope;

    // Halfway between the edges; B's edges stand around its center.
    const P origin_x = of_reference(zero, in.px), origin_y = of_reference(zero, in.py);
    const P u0 = half_u + gap0 * half, u1 = half_u + gap1 * half;
    const P x0 = origin_x + lane_difference(n_x, u0, n_y, v0), y0 = origin_y + lane_sum(n_y, u0, n_x, v0);
    const P x1 = origin_x + lane_difference(n_x, u1, n_y, v1), y1 = origin_y + lane_sum(n_y, u1, n_x, v1);

    box_contact_lanes2<P> out;
    out.normal_x = normal_x;
    out.normal_y = normal_y;
    out.apart = apart;
    out.missed = select_greater(apart, margin, zero, max(v0 - v1, min(gap0, gap1) - (apart + twice)));
    // A's edge and the quarters by which B is turned name both edges, whichever of them is the reference.
    const P edge_of_a = of_reference(axis, lane_abs(odd));
    const P along_edge = select_greater(edge_of_a, zero, normal_y, normal_x);
    out.edges = (back + back + select_greater(zero, along_edge, two, zero) + quarter) * value(4) + from_b + edge_of_a;

    // Of ends beyond the margin nothing is left, and the second takes the place of the first.
    const P far0 = max(gap0, apart), far1 = max(gap1, apart);
    const auto keep = [&](const P& first, const P& second, P* to) {
        const P other = select_greater(far1, margin, zero, second);
        to[0] = select_greater(far0, margin, other, first);
        to[1] = select_greater(far0, margin, zero, other);
    };
    keep(x0, x1, out.x);
    keep(y0, y1, out.y);
    keep(gap0, gap1, out.gap);
    // Of the two ends the one that B's edge calls first is A's second.
    const P name = out.edges - from_b;
    keep(name + from_b * value(16), name + direction * value(16) + value(16), out.feature);
    out.count = select_greater(far0, margin, zero, one) + select_greater(far1, margin, zero, one);
    return out;
}

/// The contact of a corner at an end of the reference edge, which B has or A, and the point of the other box that is
/// closest to it. `parting` is the edge's normal from A to B, `axis_gap` how far the best edge parts the boxes.
template <class S>
void touch_box_corner(const box_pair<S, 2>& pair, bool of_b, vec<S, 2> parting, S axis_gap, S margin,
                      manifold<S, 2>& out) {
    const transform<S, 2>& b_in_a = *pair.b_in_a;
    const rotation<S, 2> r = b_in_a.rotation;
    const vec<S, 2> half = of_b ? pair.b->half_extents : pair.a->half_extents;
    const vec<S, 2> other_half = of_b ? pair.a->half_extents : pair.b->half_extents;
    // It is the end beyond which the other box's deepest corner lies.
    const vec<S, 2> parting_in_b = inverse_rotate(r, parting), n = of_b ? -parting_in_b : parting;
    const vec<S, 2> deepest =
        of_b ? inverse_transform(b_in_a, support(*pair.a, parting)) : b_in_a * support(*pair.b, -parting_in_b);
    const bool along_y = abs(n.y) > abs(n.x);
    const bool right = (along_y ? deepest.x : n.x) > S(0), upper = (along_y ? n.y : deepest.y) > S(0);
    const vec<S, 2> corner{right ? half.x : -half.x, upper ? half.y : -half.y};
    const vec<S, 2> local = of_b ? b_in_a * corner : inverse_transform(b_in_a, corner);
    const vec<S, 2> beyond = local - max(-other_half, min(other_half, local));

    auto [direction, gap] = direction_and_length_of(beyond);
    const vec<S, 2> in_a = of_b ? direction : -(r * direction), in_b = of_b ? inverse_rotate(r, direction) : -direction;
    const S along =
        dot(in_a, b_in_a.position) - dot(abs(in_a), pair.a->half_extents) - dot(abs(in_b), pair.b->half_extents);
    // Of points that all but coincide the direction is chance.
    const S rounding = rounding_of(largest(half) + largest(other_half) + largest(b_in_a.position));
    const bool clear = gap > S(0) && !(along < axis_gap - rounding);
    if (!clear) gap = axis_gap;
    out = {};
    if (gap > margin) return;
    out.normal = clear ? in_a : parting;
    // Two corners have one name, whichever was found.
    const std::uint32_t number = std::uint32_t{right} | std::uint32_t{upper} << 1;
    const std::uint32_t nearest = std::uint32_t{beyond.x > S(0)} | std::uint32_t{beyond.y > S(0)} << 1;
    const bool in_x = beyond.x == S(0), in_y = beyond.y == S(0);
    const std::uint32_t feature = in_x || in_y ? 0x200u | std::uint32_t{in_x} << 6 | std::uint32_t{in_y} << 5 |
                                                     std::uint32_t{of_b} << 4 | nearest << 2 | number
                                               : 0x100u | (of_b ? nearest << 2 | number : number << 2 | nearest);
    out.add(of_b ? local - out.normal * (gap * S(0.5)) : corner + out.normal * (gap * S(0.5)), gap, feature);
}

/// Writes the manifold of one lane.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE void write_box_contact(const box_contact_lanes2<P>& found, int lane,
                                                 const box_pair<S, 2>& pair, S margin, manifold<S, 2>& out) {
    const auto number = [](S x) { return static_cast<std::uint32_t>(static_cast<int>(to_double(x))); };
    out.normal = {found.normal_x.lane(lane), found.normal_y.lane(lane)};
    for (int k = 0; k < 2; ++k)
        out.points[k] = {{found.x[k].lane(lane), found.y[k].lane(lane)},
                         found.gap[k].lane(lane),
                         number(found.feature[k].lane(lane))};
    out.count = static_cast<int>(number(found.count.lane(lane)));
    if (found.missed.lane(lane) > S(0))
        touch_box_corner(pair, (number(found.edges.lane(lane)) >> 1 & 1u) != 0, out.normal, found.apart.lane(lane),
                         margin, out);
}

/// The manifolds of W pairs.
template <class S, int W>
void collide_box_lanes(const box_pair<S, 2>* pairs, S margin, manifold<S, 2>* out) {
    using P = pack<S, W>;
    box_lanes2<P> in;
    for (int i = 0; i < W; ++i) {
        const box_pair<S, 2>& pair = pairs[i];
        in.ax.set_lane(i, pair.a->half_extents.x);
        in.ay.set_lane(i, pair.a->half_extents.y);
        in.bx.set_lane(i, pair.b->half_extents.x);
        in.by.set_lane(i, pair.b->half_extents.y);
        in.px.set_lane(i, pair.b_in_a->position.x);
        in.py.set_lane(i, pair.b_in_a->position.y);
        in.cosine.set_lane(i, pair.b_in_a->rotation.cosine);
        in.sine.set_lane(i, pair.b_in_a->rotation.sine);
    }
    const box_contact_lanes2<P> found = touch_boxes(in, P::broadcast(margin));
    for (int i = 0; i < W; ++i) write_box_contact(found, i, pairs[i], margin, out[i]);
}

/// out[i] becomes what collide() of pair i gives from an empty manifold, bit for bit, whatever `count` is.
template <class S>
void collide_boxes(const box_pair<S, 2>* pairs, std::uint32_t count, S margin, manifold<S, 2>* out) {
    constexpr std::uint32_t width = native_width<S>;
    std::uint32_t i = 0;
    for (; count - i >= width; i += width) collide_box_lanes<S, width>(pairs + i, margin, out + i);
    if (i == count) return;
    // The lanes that are left over repeat a pair.
    box_pair<S, 2> last[width];
    manifold<S, 2> found[width];
    for (std::uint32_t k = 0; k < width; ++k) last[k] = pairs[k < count - i ? i + k : i];
    collide_box_lanes<S, width>(last, margin, found);
    for (std::uint32_t k = 0; k < count - i; ++k) out[i + k] = found[k];
}

}  // namespace detail

/// Contact of two boxes: four separating axes and clipping, or the nearest corners. To keep the features of bodies at
/// rest, contacts may deviate by 1/512 of the smallest half extent, never more. Cost: 28-33 ns, in batches 14 a pair;
/// corners 40 ns more.
template <class S>
void collide(const box<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    // Equal lanes, as one scalar's selections would become branches that nothing predicts.
    using P = detail::pack<S, detail::native_width<S>>;
    const auto same = [](S x) { return P::broadcast(x); };
    const vec<S, 2> of_a = a.half_extents, of_b = b.half_extents, at = b_in_a.position;
    const rotation<S, 2> turned = b_in_a.rotation;
    const detail::box_lanes2<P> in{same(of_a.x), same(of_a.y), same(of_b.x),        same(of_b.y),
                                   same(at.x),   same(at.y),   same(turned.cosine), same(turned.sine)};
    detail::write_box_contact(detail::touch_boxes(in, same(margin)), 0, {&a, &b, &b_in_a}, margin, out);
}

PHYSICS_HPP_END
