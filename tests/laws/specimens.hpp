// Pairs of convex shapes to be judged by certificates: each shape as the library has it and as the judge does.
#pragma once

#include "judge.hpp"

namespace {

using closest = physics::closest_points<S, D>;
using physics::gjk_cache;
using hull_geometry = physics::hull_geometry<S, D>;
using judge::real;
using state = convex_pair::state;

/// A shape as the library has it and as the judge does.
struct specimen {
    convex_body shape;
    judge::body exact;

    explicit specimen(const convex_body& b) : shape(b), exact(b) {}
};

/// Classes of shapes to draw from; unequal pairs are of a large one and a small one.
enum class size_class { common, thin, tiny, huge, large, small };
constexpr int size_classes = 6;

/// Hulls of all sorts of corners; no hull where the scalar sees no volume.
inline bool random_hull(cell::dice& dice, double size, reals stretch, convex_body& to) {
    constexpr solid::kind kinds[] = {solid::kind::cloud, solid::kind::prism, solid::kind::lattice, solid::kind::simplex};
    const solid s = random_solid(kinds[dice.below(4)], dice, size, stretch);
    try {
        to.geometry = hull_geometry::build(s.points.data(), static_cast<std::uint32_t>(s.points.size()));
    } catch (const physics::error&) {
        return false;
    }
    const S radius = S(dice.below(2) ? size * dice.number(0.01, 0.2) : 0);
    to.kind = of::hull;
    to.shape = to.geometry.shape(radius);
    to.hull = oracle::polytope();
    for (const vec& v : s.points) to.hull.points.push_back(wide(v));
    to.hull.radius = cell::number(radius);
    return true;
}

/// Shapes of a kind in all classes, built once.
class pool {
public:
    pool(int kind, int each) {
        cell::dice dice(4000 + static_cast<std::uint64_t>(kind));
        for (int c = 0; c < size_classes; ++c)
            while (static_cast<int>(of_[c].size()) < each) {
                const size_class in = size_class(c);
                const double size = in == size_class::tiny                                ? 1e-3
                                    : in == size_class::huge                              ? 1e3
                                    : in == size_class::large                             ? 100
                                    : in == size_class::small ? 100 * std::pow(10, dice.number(-4, -2))
                                    : in == size_class::thin  ? 10
                                                              : 1;
                convex_body b;
                if (kind != of::hull) {
                    b = random_body(kind, dice, size, in == size_class::thin);
                } else {
                    reals stretch{1, 1, 1};
                    if (in == size_class::thin) stretch[dice.below(D)] = 1e-5;
                    if (!random_hull(dice, size, stretch, b)) continue;
                }
                of_[c].emplace_back(b);
            }
    }
    const specimen& any(size_class c, cell::dice& dice) const {
        const auto& all = of_[static_cast<int>(c)];
        return all[static_cast<std::size_t>(dice.below(static_cast<int>(all.size())))];
    }

private:
    std::vector<specimen> of_[size_classes];
};

/// Two specimens as they meet.
struct meet {
    const specimen *a, *b;
    transform b_in_a;
    state in;

    [[nodiscard]] judge::couple couple() const { return {&a->exact, &b->exact, to_frame(b_in_a)}; }
    [[nodiscard]] meet swapped() const { return {b, a, inverse(b_in_a), in}; }
    [[nodiscard]] bool is_round() const { return a->shape.round || b->shape.round; }
    /// What roundings are relative to: sizes, and how far from their frames the points lie.
    [[nodiscard]] double reach() const {
        return double(a->exact.extent + b->exact.extent) + size(to_reals(b_in_a.position)) + (cell::is_fixed ? 1 : 0);
    }
    /// What rounding may cost; GJK between round shapes may stall at 1e-10 of the sizes.
    [[nodiscard]] double tolerance() const {
        return (is_round() ? 64 * std::fmax(epsilon, 1e-11) : 32 * std::fmax(epsilon, 2.3e-16)) * reach();
    }
    /// The same of points. Of round shapes their error goes with the root of the distance's; along faces of 1:10^5 and
    /// across sizes as unequal as that the vertices of B - A lose digits of double.
    [[nodiscard]] double of_points() const {
        const bool lost = in == state::thin || in == state::unequal;
        return (is_round() ? 2 : 1) * tolerance() + ((is_round() ? 4e-9 : 0) + (lost ? 0x1p13 * 2.3e-16 : 0)) * reach();
    }
    /// By how much an answer may fall short of the distance; it exceeds it by no more than the tolerance.
    [[nodiscard]] double short_of() const {
        return in == state::thin || in == state::unequal ? of_points() : tolerance();
    }
};
template <class F>
void with_shapes(const meet& m, F&& f) {
    m.a->shape.shape.visit([&](const auto& a) {
        m.b->shape.shape.visit([&](const auto& b) {
            if constexpr (requires { separation(a, b, m.b_in_a); }) f(a, b);
        });
    });
}
inline closest separation_of(const meet& m, gjk_cache* cache = nullptr) {
    closest c;
    with_shapes(m, [&](const auto& a, const auto& b) {
        c = cache ? separation(a, b, m.b_in_a, *cache) : separation(a, b, m.b_in_a);
    });
    return c;
}
/// B, moved along the normal until the distance along it is the one wanted, by the library's own word.
inline void place(meet& m, double wanted) {
    const closest c = separation_of(m);
    m.b_in_a.position = from_reals(to_reals(m.b_in_a.position) + to_reals(c.normal) * (wanted - cell::number(c.distance)));
}

inline meet random_meet(const pool& of_a, const pool& of_b, cell::dice& dice) {
    const state in = state(dice.below(convex_pair::states));
    const size_class c = in == state::thin   ? size_class::thin
                         : in == state::tiny ? size_class::tiny
                         : in == state::huge ? size_class::huge
                                             : size_class::common;
    const double scale = c == size_class::thin ? 10 : c == size_class::tiny ? 1e-3 : c == size_class::huge ? 1e3 : 1;
    const bool unequal = in == state::unequal, large_first = dice.below(2) > 0;
    meet m{&of_a.any(unequal ? large_first ? size_class::large : size_class::small : c, dice),
           &of_b.any(unequal ? large_first ? size_class::small : size_class::large : c, dice),
           {{}, random_rotation(dice)},
           in};
    const double least = unequal ? double(std::fmin(m.a->exact.extent, m.b->exact.extent)) : scale;
    const double apart = double(m.a->exact.extent + m.b->exact.extent);
    m.b_in_a.position = from_reals(random_direction(dice) * (1.5 * apart));
    const double gaps[] = {0.25, 0.01, 1e-4, 0, -1e-4, -0.01, -0.1};
    const double gap = gaps[dice.below(7)] * least;
    switch (in) {
        case state::separated: place(m, 0.25 * least * dice.number(0, 4)); break;
        case state::touching: place(m, 0); break;
        case state::shallow: place(m, -0.01 * least); break;
        case state::deep:
            m.b_in_a.position = from_reals(random_direction(dice) * dice.number(0, 0.15 * scale));
            break;
        case state::coincident:
            if (m.a->shape.kind == m.b->shape.kind) m.b = m.a;
            m.b_in_a = {};
            break;
        case state::thin:
        case state::tiny:
        case state::huge:
        case state::unequal: place(m, gap); break;
        case state::far: {
            place(m, gap);
            const transform at{from_reals(random_direction(dice) * 1e4), random_rotation(dice)};
            m.b_in_a = relative(at, at * m.b_in_a);
            break;
        }
        case state::tilted: {
            const double tilt = std::pow(10, -dice.number(3, 8)) * (dice.below(4) > 0);
            const reals about = cell::is_2d ? reals{0, 0, 1} : unit({dice.number(-1, 1), dice.number(-1, 1), 0});
            if constexpr (cell::is_2d)
                m.b_in_a.rotation = rotation_of({S(std::cos(tilt)), S(std::sin(tilt))});
            else
                m.b_in_a.rotation = rotation_of({S(about.x * std::sin(tilt / 2)), S(about.y * std::sin(tilt / 2)), S(0),
                                                 S(std::cos(tilt / 2))});
            reals aside{dice.number(-0.4, 0.4), dice.number(-0.4, 0.4), 0};
            aside[D - 1] = 4;
            m.b_in_a.position = from_reals(aside);
            const double nearly[] = {0, 1e-6, -1e-6, 0.01, -0.01};
            place(m, nearly[dice.below(5)]);
            break;
        }
        case state::aligned: {
            if (m.a->shape.kind == m.b->shape.kind) m.b = m.a;
            const rotation turns[] = {{}, cell::is_2d ? rotation_of({S(0), S(1), S(0), S(0)})
                                                      : rotation_of({S(0.5), S(0.5), S(0.5), S(0.5)})};
            m.b_in_a.rotation = turns[dice.below(2)];
            const auto& all = m.a->exact.corners;
            const judge::point corner = all.empty() ? m.a->exact.half
                                                    : all[static_cast<std::size_t>(dice.below(int(all.size())))];
            reals step;
            for (int i = 0; i < D; ++i) step[i] = double(corner[i]) * (dice.below(5) - 2);
            m.b_in_a.position = from_reals(step);
            break;
        }
    }
    return m;
}

}  // namespace
