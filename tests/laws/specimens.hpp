// Pairs of convex shapes to be judged by certificates: each shape as the library has it and as the judge does.
#pragma once

#include "features.hpp"

namespace {

using closest = physics::closest_points<S, D>;
using physics::gjk_cache;
using hull_geometry = physics::hull_geometry<S, D>;
using judge::real;

/// A shape as the library has it and as the judge does.
struct specimen {
    convex_body shape;
    judge::body exact;

    explicit specimen(const convex_body& b) : shape(b), exact(b) {}
};

/// How two shapes meet; the first ones as in convex_pair. In `ratio` one is 10^4 to 10^6 times as large as the other:
/// up to 1 km against 1 mm, in every scalar. In `swollen` the radius is 10^3 to 10^5 times as large as the core: 1 mm,
/// and 1 to 100 m around it. In `leaning` and `exact` a corner, edge or face of the one meets one of the other, of any
/// size: 10^-7 to 10^-3 rad from flat, or exactly where the numbers allow it.
enum class state {
    separated,
    touching,
    shallow,
    deep,
    coincident,
    thin,
    tiny,
    huge,
    far,
    unequal,
    tilted,
    aligned,
    ratio,
    swollen,
    leaning,
    exact
};
constexpr int states = 16;
inline const char* name_of(state in) {
    constexpr const char* names[] = {"ratio", "swollen", "leaning", "exact"};
    const int i = static_cast<int>(in) - convex_pair::states;
    return i < 0 ? name_of(convex_pair::state(in)) : names[i];
}

/// Classes of shapes to draw from; unequal pairs are of a large one and a small one, pairs of a ratio of a huge one and
/// a mite. Those of `grid` have numbers that are multiples of 1/64.
enum class size_class { common, thin, tiny, huge, large, small, mite, swollen, grid };
constexpr int size_classes = 9;

/// Hulls of all sorts of corners; no hull where the scalar sees no volume.
inline bool random_hull(cell::dice& dice, double size, reals stretch, body_wish wish, convex_body& to) {
    constexpr solid::kind kinds[] = {solid::kind::cloud, solid::kind::prism, solid::kind::lattice,
                                     solid::kind::simplex};
    solid s = random_solid(kinds[dice.below(4)], dice, size, stretch);
    if (wish.step > 0)
        for (vec& v : s.points)
            for (int i = 0; i < D; ++i) v[i] = S(std::round(cell::number(v[i]) / wish.step) * wish.step);
    try {
        to.geometry = hull_geometry::build(s.points.data(), static_cast<std::uint32_t>(s.points.size()));
    } catch (const physics::error&) {
        return false;
    }
    const double any_radius = dice.below(2) ? size * dice.number(0.01, 0.2) : 0;
    const S radius = S(wish.radius >= 0 ? wish.radius : any_radius);
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
                const double size = size_of(in, dice);
                const body_wish wish{in == size_class::thin,
                                     in == size_class::swollen ? size * std::pow(10, dice.number(3, 5)) : -1,
                                     in == size_class::grid ? 1.0 / 64 : 0};
                convex_body b;
                if (kind != of::hull) {
                    b = random_body(kind, dice, size, wish);
                } else {
                    reals stretch{1, 1, 1};
                    if (in == size_class::thin) stretch[dice.below(D)] = 1e-5;
                    if (!random_hull(dice, size, stretch, wish, b)) continue;
                }
                of_[c].emplace_back(b);
            }
    }
    const specimen& any(size_class c, cell::dice& dice) const {
        const auto& all = of_[static_cast<int>(c)];
        return all[static_cast<std::size_t>(dice.below(static_cast<int>(all.size())))];
    }

private:
    static double size_of(size_class in, cell::dice& dice) {
        switch (in) {
            case size_class::thin: return 10;
            case size_class::tiny:
            case size_class::swollen: return 1e-3;
            case size_class::huge: return 1e3;
            case size_class::large: return 100;
            case size_class::small: return 100 * std::pow(10, dice.number(-4, -2));
            case size_class::mite: return 1e3 * std::pow(10, dice.number(-6, -4));
            default: return 1;
        }
    }

    std::vector<specimen> of_[size_classes];
};

/// Two specimens as they meet.
struct meet {
    const specimen *a, *b;
    transform b_in_a;
    state in;
    /// One is thin, or small beside the other: along faces of 1:10^5 and across sizes as unequal as that the vertices
    /// of B - A lose digits of double.
    bool uneven = in == state::thin || in == state::unequal || in == state::ratio;

    [[nodiscard]] judge::couple couple() const { return {&a->exact, &b->exact, to_frame(b_in_a)}; }
    [[nodiscard]] meet swapped() const { return {b, a, inverse(b_in_a), in, uneven}; }
    [[nodiscard]] bool is_round() const { return a->shape.round || b->shape.round; }
    /// What roundings are relative to: sizes, and how far from their frames the points lie.
    [[nodiscard]] double reach() const {
        return double(a->exact.extent + b->exact.extent) + size(to_reals(b_in_a.position)) + (cell::is_fixed ? 1 : 0);
    }
    /// What rounding may cost; GJK between round shapes may stall at 1e-10 of the sizes.
    [[nodiscard]] double tolerance() const {
        return (is_round() ? 64 * std::fmax(epsilon, 1e-11) : 32 * std::fmax(epsilon, 2.3e-16)) * reach();
    }
    /// The same of points. Of round shapes their error goes with the root of the distance's.
    [[nodiscard]] double of_points() const {
        const double lost = (is_round() ? 4e-9 : 0) + (uneven ? 0x1p13 * 2.3e-16 : 0);
        return (is_round() ? 2 : 1) * tolerance() + lost * reach();
    }
    /// By how much an answer may fall short of the distance; it exceeds it by no more than the tolerance.
    [[nodiscard]] double short_of() const { return uneven ? of_points() : tolerance(); }
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
    m.b_in_a.position =
        from_reals(to_reals(m.b_in_a.position) + to_reals(c.normal) * (wanted - cell::number(c.distance)));
}

/// A point of a corner, edge or face of A is laid on one of B, and turned so that both are flat on each other or lean
/// by 10^-7 to 10^-3 rad; or, with numbers as round as may be, as any exact rotation has it.
inline void meet_by_features(meet& m, bool leaning, cell::dice& dice) {
    using judge::point;
    const judge::body &a = m.a->exact, &b = m.b->exact;
    const point n = outward(a, dice);
    const auto corners_a = farthest_corners(a, n, dice);
    point out_of_b;
    if (!leaning && dice.below(2)) {
        m.b_in_a.rotation = judge::exact_rotation(dice);
        // Flat on each other, or, with B on the inside, in each other.
        out_of_b = judge::unrotate(to_frame(m.b_in_a), dice.below(4) ? -n : n);
    } else {
        const real angle = leaning ? std::pow(real(10), -real(dice.number(3, 7))) * (dice.below(2) ? 1 : -1) : 0;
        out_of_b = outward(b, dice);
        const point s = tangent(b, farthest_corners(b, out_of_b, dice), out_of_b, dice);
        const point t = tangent(a, corners_a, n, dice);
        m.b_in_a.rotation = judge::rotation_between(out_of_b, s, -n, t, angle, dice);
    }
    const oracle::frame at = to_frame(m.b_in_a);
    const point p = judge::mean_of_some(corners_a, dice);
    const point q = at.rotate(judge::mean_of_some(farthest_corners(b, out_of_b, dice), dice));
    const double gaps[] = {0, 0, 0, 1e-6, -1e-6, 1e-3, -1e-3, -0.1};
    const real gap = real(gaps[dice.below(8)]) * std::min(a.thin, b.thin);
    // Now and then it is the cores that touch.
    const real radii = dice.below(8) ? a.radius + b.radius : 0;
    m.b_in_a.position = from_reals(narrow(p - q + n * (radii + gap)));
}

/// The sizes of two that meet so.
struct class_pair {
    size_class a, b;
};
inline class_pair random_classes(state in, cell::dice& dice) {
    using of_size = size_class;
    class_pair c{of_size::common, of_size::common};
    switch (in) {
        case state::thin: return {of_size::thin, of_size::thin};
        case state::tiny: return {of_size::tiny, of_size::tiny};
        case state::huge: return {of_size::huge, of_size::huge};
        case state::unequal: c = {of_size::large, of_size::small}; break;
        case state::ratio: c = {of_size::huge, of_size::mite}; break;
        case state::swollen: {
            constexpr of_size others[] = {of_size::swollen, of_size::tiny, of_size::common, of_size::large};
            c = {of_size::swollen, others[dice.below(4)]};
            break;
        }
        case state::leaning:
        case state::exact: {
            constexpr class_pair of_two[] = {
                {of_size::grid, of_size::grid},    {of_size::grid, of_size::grid},   {of_size::common, of_size::common},
                {of_size::thin, of_size::thin},    {of_size::common, of_size::thin}, {of_size::large, of_size::small},
                {of_size::huge, of_size::mite},    {of_size::huge, of_size::tiny},   {of_size::tiny, of_size::common},
                {of_size::swollen, of_size::grid}, {of_size::thin, of_size::swollen}};
            c = of_two[dice.below(11)];
            break;
        }
        default: return c;
    }
    return dice.below(2) ? c : class_pair{c.b, c.a};
}

inline meet random_meet(const pool& of_a, const pool& of_b, state in, cell::dice& dice) {
    const class_pair c = random_classes(in, dice);
    const double scale = in == state::thin ? 10 : in == state::tiny ? 1e-3 : in == state::huge ? 1e3 : 1;
    meet m{&of_a.any(c.a, dice), &of_b.any(c.b, dice), {{}, random_rotation(dice)}, in};
    const bool unequal = in == state::unequal || in == state::ratio || in == state::swollen;
    if (in == state::leaning || in == state::exact) {
        const auto thin_or_small = [](size_class s) { return s != size_class::common && s != size_class::grid; };
        m.uneven = thin_or_small(c.a) || thin_or_small(c.b);
        meet_by_features(m, in == state::leaning, dice);
        return m;
    }
    const double least = unequal ? double(std::fmin(m.a->exact.extent, m.b->exact.extent)) : scale;
    const double apart = double(m.a->exact.extent + m.b->exact.extent);
    m.b_in_a.position = from_reals(random_direction(dice) * (1.5 * apart));
    const double gaps[] = {0.25, 0.01, 1e-4, 0, -1e-4, -0.01, -0.1};
    const double gap = gaps[dice.below(7)] * least;
    switch (in) {
        case state::separated: place(m, 0.25 * least * dice.number(0, 4)); break;
        case state::touching: place(m, 0); break;
        case state::shallow: place(m, -0.01 * least); break;
        case state::deep: m.b_in_a.position = from_reals(random_direction(dice) * dice.number(0, 0.15 * scale)); break;
        case state::coincident:
            if (m.a->shape.kind == m.b->shape.kind) m.b = m.a;
            m.b_in_a = {};
            break;
        case state::thin:
        case state::tiny:
        case state::huge:
        case state::unequal:
        case state::ratio: place(m, gap); break;
        case state::swollen: {
            place(m, gap);
            const judge::body &a = m.a->exact, &b = m.b->exact;
            const double cores = double(std::fmin(a.extent - a.radius, b.extent - b.radius));
            // Around where the cores themselves touch, and deep in each other.
            const double about[] = {0, 1e-3, -1e-3, -0.1};
            const int displacement = dice.below(8);
            if (displacement < 4) place(m, about[displacement] * cores - double(m.couple().radii()));
            if (displacement == 4)
                m.b_in_a.position = from_reals(random_direction(dice) * (dice.number(0, 0.3) * cores));
            break;
        }
        case state::leaning:
        case state::exact: break;
        case state::far: {
            place(m, gap);
            const transform at{from_reals(random_direction(dice) * 1e4), random_rotation(dice)};
            m.b_in_a = relative(at, at * m.b_in_a);
            break;
        }
        case state::tilted: {
            const double tilt = std::pow(10, -dice.number(3, 8)) * (dice.below(4) > 0);
            const reals about = cell::is_2d ? reals{0, 0, 1} : unit({dice.number(-1, 1), dice.number(-1, 1), 0});
            if constexpr (cell::is_2d) m.b_in_a.rotation = rotation_of({S(std::cos(tilt)), S(std::sin(tilt))});
            else
                m.b_in_a.rotation = rotation_of(
                    {S(about.x * std::sin(tilt / 2)), S(about.y * std::sin(tilt / 2)), S(0), S(std::cos(tilt / 2))});
            reals aside{dice.number(-0.4, 0.4), dice.number(-0.4, 0.4), 0};
            aside[D - 1] = 4;
            m.b_in_a.position = from_reals(aside);
            const double nearly[] = {0, 1e-6, -1e-6, 0.01, -0.01};
            place(m, nearly[dice.below(5)]);
            break;
        }
        case state::aligned: {
            if (m.a->shape.kind == m.b->shape.kind) m.b = m.a;
            const rotation turns[] = {
                {},
                cell::is_2d ? rotation_of({S(0), S(1), S(0), S(0)}) : rotation_of({S(0.5), S(0.5), S(0.5), S(0.5)})};
            m.b_in_a.rotation = turns[dice.below(2)];
            const auto& all = m.a->exact.corners;
            const judge::point corner =
                all.empty() ? m.a->exact.half : all[static_cast<std::size_t>(dice.below(int(all.size())))];
            reals step;
            for (int i = 0; i < D; ++i) step[i] = double(corner[i]) * (dice.below(5) - 2);
            m.b_in_a.position = from_reals(step);
            break;
        }
    }
    return m;
}

}  // namespace
