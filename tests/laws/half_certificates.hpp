// Laws of halfspaces with shapes of every kind, against the formula.
#pragma once

#include "tally.hpp"

namespace {
namespace certificates_laws {

/// A body and a halfspace whose plane is known in the frame of shape A, in either order.
struct ground_meet {
    const specimen* body;
    halfspace ground;
    transform b_in_a;
    bool ground_first;
    state in;

    [[nodiscard]] oracle::frame frame() const { return to_frame(b_in_a); }
    [[nodiscard]] oracle::frame body_frame() const { return ground_first ? frame() : oracle::frame(); }
    /// Out of the halfspace, in A's frame.
    [[nodiscard]] judge::point up() const {
        const judge::point n = judge::unit_of(wide(ground.normal));
        return ground_first ? n : frame().rotate(n);
    }
    [[nodiscard]] real offset() const {
        return cell::number(ground.offset) + (ground_first ? 0 : dot(up(), frame().origin));
    }
    [[nodiscard]] real exact() const {
        const oracle::frame at = body_frame();
        const judge::body& b = body->exact;
        return dot(at.origin, up()) - b.reach(-judge::unrotate(at, up())) - b.radius - offset();
    }
    [[nodiscard]] double reach() const {
        return double(body->exact.extent) + size(to_reals(b_in_a.position)) + std::abs(cell::number(ground.offset)) +
               (cell::is_fixed ? 1 : 0);
    }
    [[nodiscard]] double tolerance() const { return 32 * std::fmax(epsilon, 2.3e-16) * reach(); }
    /// How far a point lies outside of the body.
    [[nodiscard]] double outside(judge::point p) const {
        return double(body->exact.distance(body_frame().undo(p)) - body->exact.radius);
    }
    [[nodiscard]] double off_plane(judge::point p) const { return double(std::abs(dot(up(), p) - offset())); }
    /// The same seen from the other: as rounded as the inverse of the pose is.
    [[nodiscard]] ground_meet swapped() const { return {body, ground, inverse(b_in_a), !ground_first, in}; }
    /// For reports.
    [[nodiscard]] std::string text() const {
        const reals n = to_reals(ground.normal);
        return text_of(convex_encounter{body->shape, body->shape, b_in_a}) + (ground_first ? "\nA" : "\nB") +
               " is a halfspace " + text_of_pair("x, y", n.x, n.y) +
               text_of_pair(", z, offset", n.z, cell::number(ground.offset));
    }
};

/// The lowest point of a contact lies on the body; above it are corners of what the body turns to the ground, with its
/// radius around them, and that may be within.
template <class Policy>
void judge_ground_contact(const ground_meet& m, double margin, const meet& note_as, tally& to) {
    const convex_any plane = m.ground, &other = m.body->shape.shape;
    const physics::manifold<S, D> c = m.ground_first ? convex_set::collide<Policy>(plane, other, m.b_in_a, margin)
                                                     : convex_set::collide<Policy>(other, plane, m.b_in_a, margin);
    const double exact = double(m.exact()), tolerance = m.tolerance();
    const double allowed = tolerance + double(m.body->exact.thin) / 128;
    to.note(law::touching, note_as, c.count > 0 ? exact - margin : margin - exact, allowed);
    if (c.count == 0) return;
    const judge::point wanted = m.up() * (m.ground_first ? 1 : -1), n = wide(c.normal);
    to.note(law::contact_normal, note_as, double(oracle::size(n - wanted)), 32 * std::fmax(epsilon, 2.3e-16));
    double deepest = HUGE_VAL, farthest = -HUGE_VAL;
    bool repeated = false;
    for (int i = 0; i < c.count; ++i) {
        const double gap = cell::number(c.points[i].separation);
        deepest = std::fmin(deepest, gap);
        farthest = std::fmax(farthest, gap);
        const judge::point p = wide(c.points[i].position), half = n * (real(gap) / 2);
        to.note(law::contact_points, note_as, m.off_plane(m.ground_first ? p - half : p + half), 2 * tolerance);
        const double outside = m.outside(m.ground_first ? p + half : p - half);
        const bool lowest = gap <= exact + tolerance;
        to.note(law::contact_points, note_as, lowest ? std::abs(outside) : outside, 2 * allowed);
        for (int j = 0; j < i; ++j) repeated = repeated || c.points[j].feature == c.points[i].feature;
    }
    to.note(law::contact_depth, note_as, std::abs(deepest - exact), allowed);
    to.note(law::contact_depth, note_as, farthest - margin, tolerance);
    to.note(law::contact_features, note_as, repeated || c.count > physics::manifold<S, D>::capacity, 0);
}

inline void judge_ground_once(const ground_meet& m, tally& to) {
    const meet as{m.body, m.body, m.b_in_a, m.in};
    const double exact = double(m.exact()), tolerance = m.tolerance();
    m.body->shape.shape.visit([&](const auto& shape) {
        if constexpr (physics::detail::has_core<std::remove_cvref_t<decltype(shape)>>) {
            const auto of_both = [&](auto&& query) {
                return m.ground_first ? query(m.ground, shape) : query(shape, m.ground);
            };
            const closest c = of_both([&](const auto& a, const auto& b) { return separation(a, b, m.b_in_a); });
            const double d = cell::number(c.distance);
            const judge::point n = wide(c.normal), on_a = wide(c.on_a), on_b = wide(c.on_b);
            const judge::point wanted = m.up() * (m.ground_first ? 1 : -1);
            to.note(law::converged, as, c.status != physics::query_status::converged, 0);
            to.note(law::unit_normal, as, double(oracle::size(n - wanted)), 32 * std::fmax(epsilon, 2.3e-16));
            to.note(law::parts_so_far, as, std::abs(d - exact), tolerance);
            to.note(law::on_surfaces, as, m.off_plane(m.ground_first ? on_a : on_b), tolerance);
            to.note(law::on_surfaces, as, std::abs(m.outside(m.ground_first ? on_b : on_a)), tolerance);
            to.note(law::across, as, double(oracle::size(on_b - on_a - n * d)), 4 * tolerance);
            const closest open = of_both([&](const auto& a, const auto& b) { return distance(a, b, m.b_in_a); });
            to.note(law::agreed, as, std::abs(cell::number(open.distance) - std::fmax(exact, 0)), tolerance);
            const bool meets = of_both([&](const auto& a, const auto& b) { return overlap(a, b, m.b_in_a); });
            if (std::abs(exact) > tolerance) to.note(law::agreed, as, meets != (exact < 0), 0);
        }
    });
    const double margin = cell::number(cell::real(0.05 * double(m.body->exact.extent)));
    judge_ground_contact<physics::best_per_pair>(m, margin, as, to);
    judge_ground_contact<physics::gjk_epa>(m, margin, as, to);
}

/// A body of the sizes that meet so, above or in a plane that is inclined in any way; now and then with numbers as
/// round as may be, or with a corner, edge or face that leans by little.
inline void judge_ground(const pool& of_body, state in, cell::dice& dice, tally& to) {
    const specimen& s = of_body.any(random_classes(in, dice).a, dice);
    const judge::body& b = s.exact;
    ground_meet m{&s, {}, {{}, random_rotation(dice)}, true, in};
    if (dice.below(2)) m.ground.normal = from_reals(random_direction(dice));
    const double far = in == state::far ? 1e4 : double(b.extent);
    if (dice.below(2)) m.ground.offset = S(dice.number(-far, far));
    if (in == state::exact && dice.below(2)) {
        m.b_in_a.rotation = judge::exact_rotation(dice);
    } else if (in == state::leaning || in == state::tilted || in == state::exact) {
        const judge::point out = outward(b, dice), up = m.up();
        const real angle = in == state::exact ? 0 : std::pow(real(10), -real(dice.number(3, 7)));
        const judge::point beside = judge::across(out, dice);
        m.b_in_a.rotation = judge::rotation_between(out, beside, -up, judge::across(up, dice), angle, dice);
    }
    m.b_in_a.position = from_reals(random_direction(dice) * dice.number(0, far));
    const double gaps[] = {0.25, 0.01, 1e-6, 0, 0, -1e-6, -0.01, -0.5};
    const double gap = gaps[dice.below(8)] * double(b.extent);
    m.b_in_a.position = from_reals(to_reals(m.b_in_a.position) + narrow(m.up()) * (gap - double(m.exact())));
    judge_ground_once(m, to);
    judge_ground_once(m.swapped(), to);
}

}  // namespace certificates_laws
}  // namespace
