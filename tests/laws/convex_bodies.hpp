// Convex shapes of every kind, as the library has them and as oracles do, and pairs of them in every state.
#pragma once

#include "convex_pairs.hpp"

namespace {

/// The shapes that have cores, and the halfspace; balls, capsules and boxes with the closed forms they have.
template <template <class, int> class... Shapes>
struct shape_list {
    using any = physics::any_shape<S, D, Shapes...>;
    using query = physics::narrowphase_query<S, D, Shapes...>;
    static constexpr int kinds = sizeof...(Shapes);

    template <class Policy>
    using narrowphase = typename Policy::template in<S, D, Shapes...>;

    template <class Policy>
    static physics::manifold<S, D> collide(const any& a, const any& b, const transform& b_in_a, double margin) {
        const query q{&a, &b, b_in_a};
        physics::manifold_list<S, D> found;
        narrowphase<Policy>::collide(&q, 1, S(margin), found);
        return found.empty() ? physics::manifold<S, D>{} : found[0].contact;
    }
};
template <int N>
struct shape_lists
    : shape_list<physics::halfspace, physics::ball, physics::capsule, physics::box, physics::hull, physics::segment,
                 physics::triangle, physics::rounded_box, physics::cylinder, physics::cone> {};
template <>
struct shape_lists<2> : shape_list<physics::halfspace, physics::ball, physics::capsule, physics::box, physics::hull,
                                   physics::segment, physics::triangle, physics::rounded_box> {};
using convex_set = shape_lists<D>;
using convex_any = convex_set::any;

using ball = physics::ball<S, D>;
using box = physics::box<S, D>;
using segment = physics::segment<S, D>;
using triangle = physics::triangle<S, D>;
using rounded_box = physics::rounded_box<S, D>;
using halfspace = physics::halfspace<S, D>;
template <class T = S>
using cylinder = physics::cylinder<T, 3>;
template <class T = S>
using cone = physics::cone<T, 3>;

namespace of {
enum kind { ball = 1, capsule, box, hull, segment, triangle, rounded_box, cylinder, cone };
}
inline std::string convex_name(int kind) {
    constexpr const char* names[] = {"halfspace", "ball",     "capsule",     "box",      "hull",
                                     "segment",   "triangle", "rounded box", "cylinder", "cone"};
    return names[kind];
}

/// Two discs on the x axis, all between them, and all within a rounding of that.
struct round_solid {
    double half, low, high, rounding;

    double reach(oracle::point n) const {
        const double across = std::hypot(double(n.y), double(n.z)), x = double(n.x) * half;
        return std::fmax(across * low - x, across * high + x) + rounding * double(size(n));
    }
    /// The signed distance of a point from the surface: in the half plane of x and the distance from the axis.
    double distance(oracle::point p) const {
        const double x = double(p.x), q = std::hypot(double(p.y), double(p.z));
        const double corner[4][2] = {{-half, 0}, {-half, low}, {half, high}, {half, 0}};
        double nearest = HUGE_VAL;
        for (int i = 0; i < 3; ++i) {
            const double ex = corner[i + 1][0] - corner[i][0], ey = corner[i + 1][1] - corner[i][1];
            const double whole = ex * ex + ey * ey;
            double t = whole > 0 ? ((x - corner[i][0]) * ex + (q - corner[i][1]) * ey) / whole : 0;
            t = std::fmin(std::fmax(t, 0), 1);
            nearest = std::fmin(nearest, std::hypot(x - corner[i][0] - ex * t, q - corner[i][1] - ey * t));
        }
        const bool inside = std::abs(x) <= half && q * 2 * half <= low * (half - x) + high * (half + x);
        return (inside ? -nearest : nearest) - rounding;
    }
};

/// A shape, and what it is exactly: the numbers that S holds after rounding.
struct convex_body {
    int kind = of::ball;
    convex_any shape;
    bool round = false;
    round_solid discs{};
    oracle::polytope hull;
    /// Keeps the hull of a hull shape.
    physics::hull_geometry<S, D> geometry;

    double reach(oracle::point n) const {
        return round ? discs.reach(n) : double(hull.reach(n) + hull.radius * size(n));
    }
    double distance(oracle::point p) const { return round ? discs.distance(p) : double(off_surface(hull, p)); }
    /// How large it is, seen from its frame's origin.
    double extent() const {
        double most = 0;
        for (int i = 0; i < 6; ++i) {
            oracle::point n;
            n[i / 2] = i % 2 ? 1 : -1;
            most = std::fmax(most, reach(n));
        }
        return most;
    }
    /// Half of the smallest width, about: what may count as small.
    double thin() const {
        if (round) return std::fmin(discs.half, std::fmax(discs.low, discs.high)) + discs.rounding;
        double least = extent();
        for (int i = 0; i < D; ++i) {
            oracle::point n;
            n[i] = 1;
            least = std::fmin(least, 0.5 * (reach(n) + reach(-n)));
        }
        return least;
    }
};

inline oracle::point wide(vec v) {
    const reals r = to_reals(v);
    return {r.x, r.y, r.z};
}
inline oracle::point wide(reals r) { return {r.x, r.y, r.z}; }
inline reals narrow(oracle::point p) { return {double(p.x), double(p.y), double(p.z)}; }

inline convex_body polytope_body(int kind, const convex_any& shape, const std::vector<vec>& points, S radius) {
    std::vector<oracle::point> corners;
    for (const vec& v : points) corners.push_back(wide(v));
    convex_body b;
    b.kind = kind;
    b.shape = shape;
    b.hull = oracle::polytope(D, corners, cell::number(radius));
    return b;
}
inline std::vector<vec> corners_of(vec half) {
    std::vector<vec> all;
    for (int i = 0; i < (1 << D); ++i) {
        vec v = half;
        for (int k = 0; k < D; ++k)
            if (i >> k & 1) v[k] = -v[k];
        all.push_back(v);
    }
    return all;
}
inline convex_body body_of(const ball& b) { return polytope_body(of::ball, b, {vec{}}, b.radius); }
inline convex_body body_of(const box& b) { return polytope_body(of::box, b, corners_of(b.half_extents), S(0)); }
inline convex_body body_of(const rounded_box& b) {
    return polytope_body(of::rounded_box, b, corners_of(b.half_extents), b.radius);
}
inline convex_body body_of(const segment& s) { return polytope_body(of::segment, s, {s.a, s.b}, s.radius); }
inline convex_body body_of(const triangle& t) { return polytope_body(of::triangle, t, {t.a, t.b, t.c}, t.radius); }
inline convex_body body_of(const physics::capsule<S, D>& c) {
    vec end{};
    end[0] = c.half_length;
    return polytope_body(of::capsule, c, {-end, end}, c.radius);
}
template <class T>
convex_body body_of(const cylinder<T>& c) {
    convex_body b;
    b.kind = of::cylinder;
    if constexpr (D == 3) b.shape = c;
    b.round = true;
    b.discs = {cell::number(c.half_length), cell::number(c.radius), cell::number(c.radius), cell::number(c.rounding)};
    return b;
}
template <class T>
convex_body body_of(const cone<T>& c) {
    convex_body b;
    b.kind = of::cone;
    if constexpr (D == 3) b.shape = c;
    b.round = true;
    b.discs = {cell::number(c.half_length), cell::number(c.lower_radius), cell::number(c.upper_radius),
               cell::number(c.rounding)};
    return b;
}

/// What is special about a body that is drawn.
struct body_wish {
    /// Thin along one axis, by 1e-5 of its size.
    bool thin = false;
    /// The radius around it, where its kind has one; negative: any or none.
    double radius = -1;
    /// All numbers are multiples of that; 0: any numbers.
    double step = 0;
};
/// A body of a kind, of about a size.
inline convex_body random_body(int kind, cell::dice& dice, double size, body_wish wish = {}) {
    const bool thin = wish.thin;
    const auto stepped = [&](double a) { return wish.step > 0 ? std::ceil(a / wish.step) * wish.step : a; };
    reals half;
    for (int i = 0; i < D; ++i) half[i] = stepped(size * dice.number(0.125, 0.5));
    if (thin) half[dice.below(D)] = size * 0.5e-5;
    const bool rounded = dice.below(2) > 0;
    const auto radius_of = [&](bool any) {
        const double r = any ? stepped(size * dice.number(0.01, 0.2)) : 0;
        return S(wish.radius >= 0 ? wish.radius : r);
    };
    const S radius = radius_of(rounded), x = S(half.x), y = S(half.y);
    const auto anywhere = [&] {
        const reals d = random_direction(dice);
        return from_reals({stepped(d.x * half.x), stepped(d.y * half.y), stepped(d.z * half.z)});
    };
    switch (kind) {
        case of::ball: return body_of(ball{x});
        case of::capsule: return body_of(physics::capsule<S, D>{x, wish.radius >= 0 ? radius : y});
        case of::box: return body_of(box{from_reals(half)});
        case of::rounded_box: return body_of(rounded_box{from_reals(half), radius_of(true)});
        case of::segment: {
            const reals displacement = random_direction(dice) * (0.3 * size);
            const vec aside = from_reals({stepped(displacement.x), stepped(displacement.y), stepped(displacement.z)}),
                      a = anywhere() + aside;
            return body_of(segment{a, aside - a, radius});
        }
        case of::triangle:
            for (;;) {
                const vec a = anywhere(), b = anywhere();
                vec c = anywhere();
                if (thin) c = a + (b - a) * S(0.4);
                if (thin) c[1] += S(size * 1e-5);
                const triangle t{a, b, c, radius};
                if (physics::detail::sizes_of(t).height > (thin ? 2e-6 : 0.05) * size) return body_of(t);
            }
        case of::hull: {
            std::vector<vec> points;
            for (int i = 0; i < 9; ++i) points.push_back(anywhere());
            auto geometry = physics::hull_geometry<S, D>::build(points.data(), std::uint32_t(points.size()));
            convex_body b = polytope_body(of::hull, geometry.shape(radius), points, radius);
            b.geometry = geometry;
            return b;
        }
        default: break;
    }
    if (kind == of::cylinder) return body_of(cylinder<>{x, y, radius});
    const double top[] = {0, 0.5, 0.99, 1.5};
    return body_of(cone<>{x, y, S(half.y * top[dice.below(4)]), radius});
}

/// How far apart two bodies are along a unit vector from A to B, in A's frame; negative where they overlap.
inline double along(const convex_body& a, const convex_body& b, const oracle::frame& at, oracle::point n) {
    const oracle::point m{-dot(at.axis[0], n), -dot(at.axis[1], n), -dot(at.axis[2], n)};
    return double(dot(at.origin, n)) - a.reach(n) - b.reach(m);
}
/// The largest of that over many directions, from many starts: the signed distance or a little less.
inline double best_along(const convex_body& a, const convex_body& b, const oracle::frame& at, cell::dice& dice) {
    double best = -HUGE_VAL;
    std::vector<reals> starts;
    for (int i = 0; i < D; ++i)
        for (const double sign : {-1.0, 1.0}) {
            reals e;
            e[i] = sign;
            starts.push_back(e);
            starts.push_back(narrow(at.axis[i]) * sign);
        }
    for (int i = 0; i < 24; ++i) starts.push_back(random_direction(dice));
    for (reals n : starts) {
        double here = along(a, b, at, wide(n));
        for (double step = 0.3; step > 1e-5; step *= 0.7)
            for (int k = 0; k < 5; ++k) {
                const reals m = unit(n + random_direction(dice) * step);
                const double there = along(a, b, at, wide(m));
                if (there > here) here = there, n = m;
            }
        best = std::fmax(best, here);
    }
    return best;
}

struct convex_encounter {
    convex_body a, b;
    transform b_in_a;

    /// What roundings are relative to.
    double reach() const {
        return a.extent() + b.extent() + size(to_reals(b_in_a.position)) + (cell::is_fixed ? 1 : 0);
    }
};

/// B, moved until it is that far from A along a direction.
inline void move_to(convex_encounter& e, reals n, double wanted) {
    const double now = along(e.a, e.b, to_frame(e.b_in_a), wide(n));
    e.b_in_a.position = from_reals(to_reals(e.b_in_a.position) + n * (wanted - now));
}
enum class meeting { separated, near, touching, shallow, deep, coincident, thin, tiny, huge };
constexpr int meetings = 9;
inline const char* name_of(meeting in) {
    constexpr const char* names[] = {"separated",  "near", "touching", "shallow", "deep",
                                     "coincident", "thin", "tiny",     "huge"};
    return names[static_cast<int>(in)];
}
inline convex_encounter random_encounter(int kind_a, int kind_b, meeting in, cell::dice& dice) {
    const double scale = in == meeting::tiny ? 1e-3 : in == meeting::huge ? 1e3 : in == meeting::thin ? 10 : 1;
    convex_encounter e{random_body(kind_a, dice, scale, {.thin = in == meeting::thin}),
                       random_body(kind_b, dice, scale, {.thin = in == meeting::thin}),
                       {{}, random_rotation(dice)}};
    reals n = random_direction(dice);
    // Along the axes, and with axes parallel or across, they meet by faces, sides and edges.
    if (dice.below(3) == 0) {
        n = {};
        n[dice.below(D)] = dice.below(2) ? 1 : -1;
    }
    if (dice.below(3) == 0) {
        e.b_in_a.rotation = {};
        reals about;
        about[cell::is_2d ? 2 : dice.below(3)] = 1;
        if (dice.below(2)) e.b_in_a.rotation = rotation_about(about, M_PI / 2);
    }
    const double gaps[] = {0.3, 1e-3, 0, -1e-3, -0.05, -0.3};
    double gap = gaps[dice.below(6)];
    if (in == meeting::separated) gap = 0.3;
    if (in == meeting::near) gap = 1e-3;
    if (in == meeting::touching) gap = 0;
    if (in == meeting::shallow) gap = -0.01;
    if (in == meeting::deep) gap = -0.3;
    const double away = dice.number(0, 0.4) * scale;
    const bool beside = dice.below(2) > 0;
    if (beside) e.b_in_a.position = from_reals(random_direction(dice) * away);
    move_to(e, n, gap * scale);
    if (in == meeting::coincident) {
        if (kind_a == kind_b) e.b = e.a;
        e.b_in_a.position = {};
        if (dice.below(2)) e.b_in_a.rotation = {};
    }
    return e;
}

inline std::string text_of_pair(const char* what, double x, double y) {
    char text[160];
    std::snprintf(text, sizeof text, "%s: %.12g, %.12g", what, x, y);
    return text;
}
inline std::string text_of(const convex_encounter& e) {
    std::string text = "\n" + convex_name(e.a.kind) + " and " + convex_name(e.b.kind);
    const auto add = [&](double x) {
        char part[40];
        std::snprintf(part, sizeof part, " %.17g", x);
        text += part;
    };
    for (const convex_body* b : {&e.a, &e.b}) {
        text += b == &e.a ? "\nA:" : "\nB:";
        if (b->round)
            for (const double x : {b->discs.half, b->discs.low, b->discs.high, b->discs.rounding}) add(x);
        for (const oracle::point& p : b->hull.points) {
            for (int i = 0; i < D; ++i) add(double(p[i]));
            text += ",";
        }
        add(double(b->hull.radius));
    }
    text += "\nB in A:";
    for (int i = 0; i < D; ++i) add(cell::number(e.b_in_a.position[i]));
    for (const S part : parts_of(e.b_in_a.rotation)) add(cell::number(part));
    return text;
}

}  // namespace
