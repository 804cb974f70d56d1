// Pairs of convex shapes by kind and by state, and what the oracle says of an answer. Corners and poses are those that
// S holds after rounding: the oracle judges the algorithm, not what its input lost.
#pragma once

#include <cstdio>
#include <string>

#include "convex_oracle.hpp"
#include "reals.hpp"

namespace {

/// What shapes are made of: the hull of some points in their own frame, grown by a radius.
struct solid {
    enum class kind { ball, capsule, box, cloud, prism, lattice, simplex, flat };
    static constexpr int kinds = 8;

    kind of = kind::ball;
    std::vector<vec> points;
    S radius{};

    /// Of a box: the last corner; of a capsule: half its length along x.
    [[nodiscard]] vec half_extents() const { return points.back(); }
    [[nodiscard]] oracle::polytope exact() const {
        std::vector<oracle::point> corners;
        for (const vec& p : points) {
            const reals r = to_reals(p);
            corners.push_back({r.x, r.y, r.z});
        }
        return {D, corners, cell::number(radius)};
    }
};
inline const char* name_of(solid::kind of) {
    constexpr const char* names[] = {"ball", "capsule", "box", "cloud", "prism", "lattice", "simplex", "flat"};
    return names[static_cast<int>(of)];
}

inline oracle::frame to_frame(const physics::transform<S, 2>& t) {
    const reals p = to_reals(t.position);
    return oracle::frame::of_turn(cell::number(t.rotation.cosine), cell::number(t.rotation.sine), {p.x, p.y, 0});
}
inline oracle::frame to_frame(const physics::transform<S, 3>& t) {
    const reals v = to_reals(t.rotation.imaginary()), p = to_reals(t.position);
    return oracle::frame::of_quaternion(v.x, v.y, v.z, cell::number(t.rotation.w), {p.x, p.y, p.z});
}

/// A solid of about a size: extents along the axes from a quarter of it to all of it, times `stretch`.
inline solid random_solid(solid::kind of, cell::dice& dice, double size, reals stretch = {1, 1, 1}) {
    solid s;
    s.of = of;
    reals half;
    for (int i = 0; i < D; ++i) half[i] = size * stretch[i] * dice.number(0.125, 0.5);
    const auto add = [&](reals p) { s.points.push_back(from_reals({p.x * half.x, p.y * half.y, p.z * half.z})); };
    const auto ring = [&](int corners, double radius, double z) {
        const double first = dice.number(0, 2 * M_PI);
        for (int i = 0; i < corners; ++i) {
            const double angle = first + 2 * M_PI * i / corners;
            add({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    };
    switch (of) {
        case solid::kind::ball:
            s.radius = S(half.x);
            s.points.push_back({});
            break;
        case solid::kind::capsule:
            s.radius = S(half.y);
            add({-1, 0, 0}), add({1, 0, 0});
            break;
        case solid::kind::box:
            for (int i = 0; i < (1 << D); ++i) add({i & 1 ? 1.0 : -1, i & 2 ? 1.0 : -1, i & 4 ? 1.0 : -1});
            break;
        case solid::kind::cloud: {
            const int most[] = {6, 8, 12, 24, 32};
            for (int i = most[dice.below(cell::is_2d ? 3 : 5)]; i > 0; --i) add(random_direction(dice));
            break;
        }
        case solid::kind::prism:
            // Faces with many corners; a narrower top leans its sides, the same one makes them meet parallels.
            if (cell::is_2d) {
                ring(8, 1, 0);
            } else {
                const int corners = 3 + dice.below(6);
                const double first = dice.number(0, 2 * M_PI), top = dice.below(2) ? 1 : 0.7;
                for (int i = 0; i < 2 * corners; ++i) {
                    const double angle = first + 2 * M_PI * (i / 2) / corners, r = i & 1 ? top : 1;
                    add({r * std::cos(angle), r * std::sin(angle), i & 1 ? 1.0 : -1});
                }
            }
            break;
        case solid::kind::lattice:
            // Whole numbers: points that repeat, lie on edges, on faces and within; edges parallel to others'.
            for (int i = 0; i < 10; ++i)
                add({dice.below(3) - 1.0, dice.below(3) - 1.0, cell::is_2d ? 0 : dice.below(3) - 1.0});
            for (int i = 0; i < D; ++i)
                for (const double side : {-1.0, 1.0}) {
                    reals p;
                    p[i] = side;
                    add(p);
                }
            break;
        case solid::kind::simplex:
            for (int i = 0; i <= D; ++i) add(random_direction(dice));
            break;
        case solid::kind::flat:
            // Without volume: a segment in the plane, a polygon or a segment in space.
            half[D - 1] = 0;
            if (cell::is_2d) add({-1, 0, 0}), add({1, 0, 0});
            else ring(2 + dice.below(5), 1, 0);
            break;
    }
    return s;
}

struct convex_pair {
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
        aligned
    };
    static constexpr int states = 12;

    solid a, b;
    transform b_in_a;
    state in = state::separated;

    [[nodiscard]] oracle::polytope exact_a() const { return a.exact(); }
    [[nodiscard]] oracle::polytope exact_b() const { return b.exact().moved(to_frame(b_in_a)); }
    [[nodiscard]] oracle::answer exact() const { return signed_distance(exact_a(), exact_b()); }
    /// What roundings are relative to: sizes, and how far from their frames the points lie.
    [[nodiscard]] double reach() const {
        double most = cell::number(a.radius) + cell::number(b.radius) + size(to_reals(b_in_a.position));
        for (const solid* s : {&a, &b})
            for (const vec& p : s->points) most = std::fmax(most, size(to_reals(p)));
        return most + (cell::is_fixed ? 1 : 0);
    }
    [[nodiscard]] convex_pair swapped() const { return {b, a, inverse(b_in_a), in}; }
};
inline const char* name_of(convex_pair::state in) {
    constexpr const char* names[] = {"separated", "touching", "shallow", "deep",    "coincident", "thin",
                                     "tiny",      "huge",     "far",     "unequal", "tilted",     "aligned"};
    return names[static_cast<int>(in)];
}

/// B's position, moved along the normal until the signed distance is the one wanted; but for rounding to S. Where they
/// shall overlap that is the distance along this normal: there may be a shorter way out.
inline void place(convex_pair& p, double wanted) {
    const oracle::answer at = p.exact();
    const reals n{static_cast<double>(at.normal.x), static_cast<double>(at.normal.y), static_cast<double>(at.normal.z)};
    p.b_in_a.position = from_reals(to_reals(p.b_in_a.position) + n * (wanted - static_cast<double>(at.distance)));
}

/// The faces of two solids that have one along an axis, against each other, and B tilted by 1e-3 to 1e-8 rad.
inline void stack(convex_pair& p, cell::dice& dice, double scale) {
    const double tilt = std::pow(10, -dice.number(3, 8)) * (dice.below(4) > 0);
    const reals about = cell::is_2d ? reals{0, 0, 1} : unit({dice.number(-1, 1), dice.number(-1, 1), 0});
    // Directly, as sines and cosines of S would swallow it.
    if constexpr (cell::is_2d) p.b_in_a.rotation = rotation_of({S(std::cos(tilt)), S(std::sin(tilt))});
    else
        p.b_in_a.rotation = rotation_of(
            {S(about.x * std::sin(tilt / 2)), S(about.y * std::sin(tilt / 2)), S(0), S(std::cos(tilt / 2))});
    reals aside{dice.number(-0.4, 0.4) * scale, dice.number(-0.4, 0.4) * scale, 0};
    aside[D - 1] = 4 * scale;
    p.b_in_a.position = from_reals(aside);
    const double gaps[] = {0, 1e-6, -1e-6, 0.01, -0.01};
    place(p, gaps[dice.below(5)] * scale);
}

inline convex_pair random_pair(solid::kind of_a, solid::kind of_b, convex_pair::state in, cell::dice& dice) {
    using state = convex_pair::state;
    double scale = 1, of_b_to_a = 1;
    reals stretch{1, 1, 1};
    if (in == state::tiny) scale = 1e-3;
    if (in == state::huge) scale = 1e3;
    if (in == state::unequal) of_b_to_a = std::pow(10, dice.number(-4, -2)), scale = 100;
    if (in == state::thin) stretch[dice.below(D)] = 1e-5, scale = 10;

    convex_pair p;
    p.in = in;
    p.a = random_solid(of_a, dice, scale, stretch);
    p.b = random_solid(of_b, dice, scale * of_b_to_a, in == state::unequal ? reals{1, 1, 1} : stretch);
    if (dice.below(2) && in == state::unequal) std::swap(p.a, p.b);
    const double least = scale * std::fmin(of_b_to_a, 1);
    p.b_in_a.rotation = random_rotation(dice);
    p.b_in_a.position = from_reals(random_direction(dice) * (3 * scale));
    // States that are about sizes or places: all the ways in which they may lie.
    const double gaps[] = {0.25, 0.01, 1e-4, 0, -1e-4, -0.01, -0.1};
    switch (in) {
        case state::separated: place(p, 0.25 * least); break;
        case state::touching: place(p, 0); break;
        case state::shallow: place(p, -0.01 * least); break;
        case state::deep: p.b_in_a.position = from_reals(random_direction(dice) * dice.number(0, 0.15 * scale)); break;
        case state::coincident:
            p.b = p.a;
            p.b_in_a = {};
            break;
        case state::thin:
        case state::tiny:
        case state::huge:
        case state::unequal: place(p, gaps[dice.below(7)] * least); break;
        case state::far: {
            // As two bodies of a large world meet.
            place(p, gaps[dice.below(7)] * least);
            const transform a{from_reals(random_direction(dice) * 1e4), random_rotation(dice)};
            p.b_in_a = relative(a, a * p.b_in_a);
            break;
        }
        case state::tilted: stack(p, dice, scale); break;
        case state::aligned: {
            // The same shape, turned by nothing or exactly, aside by multiples of a corner: corners, edges and faces of
            // the difference fall together.
            p.b = p.a;
            const rotation turns[] = {
                {},
                cell::is_2d ? rotation_of({S(0), S(1), S(0), S(0)}) : rotation_of({S(0.5), S(0.5), S(0.5), S(0.5)})};
            p.b_in_a.rotation = turns[dice.below(2)];
            const reals corner = to_reals(p.a.points[static_cast<std::size_t>(dice.below(int(p.a.points.size())))]);
            reals step;
            for (int i = 0; i < D; ++i) step[i] = corner[i] * (dice.below(5) - 2);
            p.b_in_a.position = from_reals(step);
            break;
        }
    }
    return p;
}

inline std::string text_of(const convex_pair& p) {
    std::string text = std::string(name_of(p.a.of)) + " and " + name_of(p.b.of) + ", " + name_of(p.in);
    const auto add = [&](double x) {
        char part[40];
        std::snprintf(part, sizeof part, " %.17g", x);
        text += part;
    };
    for (const solid* s : {&p.a, &p.b}) {
        text += s == &p.a ? "\nA:" : "\nB:";
        for (const vec& v : s->points) {
            for (int i = 0; i < D; ++i) add(cell::number(v[i]));
            text += ",";
        }
        text += " radius";
        add(cell::number(s->radius));
    }
    text += "\nB in A:";
    for (int i = 0; i < D; ++i) add(cell::number(p.b_in_a.position[i]));
    for (const S part : parts_of(p.b_in_a.rotation)) add(cell::number(part));
    return text;
}

/// An answer as any of the functions may give it, in A's frame.
struct claim {
    double distance;
    reals normal, on_a, on_b;
};
/// The first law that an answer breaks, by more than the tolerance (m); empty if it keeps them all. Across a small gap
/// a normal turns by the roundings of the points over the gap: where it is computed from them, it needs a tolerance of
/// its own, that angle times the sizes.
inline std::string broken_law(const convex_pair& p, const claim& c, double tolerance, double of_normal = 0) {
    const auto wide = [](reals r) { return oracle::point{r.x, r.y, r.z}; };
    const auto says = [](const char* what, oracle::real x, oracle::real y) {
        char text[160];
        std::snprintf(text, sizeof text, "%s: %.12Lg, %.12Lg", what, x, y);
        return std::string(text);
    };
    const oracle::polytope a = p.exact_a(), b = p.exact_b();
    const oracle::answer exact = signed_distance(a, b);
    const oracle::point n = wide(c.normal);
    if (!(std::fabs(c.distance - exact.distance) <= tolerance)) return says("the distance", c.distance, exact.distance);
    if (!(std::fabs(size(n) - 1) <= 32 * epsilon)) return says("the normal is no unit vector", size(n), 1);
    const oracle::real along = separation_along(a, b, n * (1 / size(n)));
    if (!(along >= exact.distance - std::fmax(tolerance, of_normal)))
        return says("the normal parts them worse", along, exact.distance);
    const oracle::real off_a = off_surface(a, wide(c.on_a)), off_b = off_surface(b, wide(c.on_b));
    if (!(std::fabs(off_a) <= tolerance)) return says("the point on A is not", off_a, exact.distance);
    if (!(std::fabs(off_b) <= tolerance)) return says("the point on B is not", off_b, exact.distance);
    const reals across = c.on_b - c.on_a - c.normal * c.distance;
    if (!(size(across) <= 4 * tolerance)) return says("the points do not lie across", size(across), exact.distance);
    return "";
}

}  // namespace
