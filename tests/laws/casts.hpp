// Laws of casts: rays, moving and turning shapes meet what a look at all times on their way says.
#pragma once

#include <string>

#include "reals.hpp"

namespace {
namespace casts_laws {

using doubles = physics::vec<double, D>;
using stand = physics::transform<double, D>;
using sweep = physics::sweep<S, D>;
using physics::impact_state;

/// A shape of the user's own, known by its support points only: an ellipsoid.
template <class T, int N>
struct egg {
    using scalar = T;
    physics::vec<T, N> half;
};
template <class T, int N>
physics::aabb<T, N> bounds(const egg<T, N>& e, const physics::transform<T, N>& at) {
    const auto reach = physics::vec<T, N>::filled(length(e.half));
    return {at.position - reach, at.position + reach};
}
template <class T, int N>
physics::vec<T, N> support(const egg<T, N>& e, physics::vec<T, N> direction) {
    physics::vec<T, N> p;
    for (int i = 0; i < N; ++i) p[i] = direction[i] * e.half[i];
    p = normalized(p);
    for (int i = 0; i < N; ++i) p[i] = p[i] * e.half[i];
    return p;
}

/// The same hull in S and in double: points around a ball, some nearly on a plane.
struct rock {
    physics::hull_geometry<S, D> hull;
    physics::hull_geometry<double, D> exact;

    rock(cell::dice& dice, double scale, double flatness) {
        std::vector<vec> points;
        std::vector<doubles> exact_points;
        for (int k = 0, n = D + 3 + dice.below(14); k < n; ++k) {
            reals p = random_direction(dice) * (0.5 * scale);
            p.x *= flatness;
            points.push_back(from_reals(p));
            exact_points.push_back(physics::detail::to_point(points.back()));
        }
        const auto n = static_cast<std::uint32_t>(points.size());
        hull = physics::hull_geometry<S, D>::build(points.data(), n);
        exact = physics::hull_geometry<double, D>::build(exact_points.data(), n);
    }
};
inline const rock& rock_of(int i, double scale) {
    static std::vector<rock> rocks[3];
    std::vector<rock>& list = rocks[scale < 0.1 ? 0 : scale < 2 ? 1 : 2];
    if (list.empty()) {
        cell::dice dice(90);
        for (int k = 0; k < 6; ++k) list.emplace_back(dice, scale, k % 3 == 2 ? 0.05 : 1);
    }
    return list[static_cast<std::size_t>(i)];
}

template <class T>
physics::triangle<T, 2> special_of(physics::vec<T, 2> half, T radius) {
    return {-half, {half.x, T(0)}, {T(0), half.y}, radius};
}
template <class T>
physics::cylinder<T, 3> special_of(physics::vec<T, 3> half, T radius) {
    return {half.x, half.y, radius};
}

/// A shape by numbers of S, to be had in S and in double.
struct sample {
    enum kind { capsule, box, hull, egg, special, ball, rounded_box };
    kind of = ball;
    vec half;
    S radius{};
    const rock* made_of = nullptr;

    /// Calls f with both; `special` is a triangle in the plane, a cylinder in space.
    template <class F>
    decltype(auto) visit(F&& f) const {
        const doubles h = exact_half();
        if (of == ball) return f(physics::ball<S, D>{half.x}, physics::ball<double, D>{h.x});
        if (of == rounded_box)
            return f(physics::rounded_box<S, D>{half, radius},
                     physics::rounded_box<double, D>{h, cell::number(radius)});
        return visit_some(f);
    }
    /// Of the kinds up to `special`.
    template <class F>
    decltype(auto) visit_some(F&& f) const {
        const doubles h = exact_half();
        const double r = cell::number(radius);
        if (of == capsule) return f(physics::capsule<S, D>{half.x, half.y}, physics::capsule<double, D>{h.x, h.y});
        if (of == box) return f(physics::box<S, D>{half}, physics::box<double, D>{h});
        if (of == hull) return f(made_of->hull.shape(radius), made_of->exact.shape(r));
        if (of == egg) return f(casts_laws::egg<S, D>{half}, casts_laws::egg<double, D>{h});
        return f(special_of(half, radius), special_of(h, r));
    }
    [[nodiscard]] doubles exact_half() const { return physics::detail::to_point(half); }
    [[nodiscard]] double size() const { return ::size(to_reals(half)) + cell::number(radius); }
    /// How far answers about it may be off: of an egg, which calculates in S; of a hull, which takes points for flat;
    /// of round cores, near which GJK knows a distance better than a normal.
    [[nodiscard]] double blur() const {
        const double whole = size() + (cell::is_fixed ? 1 : 0);
        if (of == egg) return std::fmax(64 * epsilon, 4e-9) * whole;
        if (of == hull) return 16 * std::fmax(epsilon, 1e-13) * whole;
        return of == special && cell::is_3d ? 4e-9 * whole : 0;
    }
    [[nodiscard]] std::string text() const {
        constexpr const char* names[] = {"capsule", "box", "hull", "egg", "special", "ball", "rounded box"};
        char text[160];
        const reals h = to_reals(half);
        std::snprintf(text, sizeof text, "%s %.17g %.17g %.17g radius %.17g", names[of], h.x, h.y, h.z,
                      cell::number(radius));
        return text;
    }
};
inline sample random_sample(cell::dice& dice, double scale, int kinds) {
    sample s;
    s.of = static_cast<sample::kind>(dice.below(kinds));
    s.half = dice.vec<vec>(0.1 * scale, 0.5 * scale);
    if (s.of == sample::box && dice.below(3) == 0) s.half.x = S(0.005 * scale);
    if (s.of == sample::hull) {
        s.made_of = &rock_of(dice.below(6), scale);
        s.half = vec::filled(S(0.5 * scale));
    }
    if (s.of == sample::rounded_box || dice.below(2)) s.radius = dice.real(0.05 * scale, 0.2 * scale);
    return s;
}

inline doubles exact(const vec& v) { return physics::detail::to_point(v); }
inline physics::rotation<double, 2> exact(const physics::rotation<S, 2>& r) {
    return normalized(physics::rotation<double, 2>{cell::number(r.cosine), cell::number(r.sine)});
}
inline physics::rotation<double, 3> exact(const physics::rotation<S, 3>& r) {
    return normalized(
        physics::rotation<double, 3>{cell::number(r.x), cell::number(r.y), cell::number(r.z), cell::number(r.w)});
}
inline stand exact(const transform& t) { return {exact(t.position), exact(t.rotation)}; }
inline doubles on_axes(reals r) {
    doubles v;
    for (int i = 0; i < D; ++i) v[i] = r[i];
    return v;
}
/// The least of a convex function of [0, 1].
template <class F>
double least_of(F&& f) {
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double low = 0, high = 1, x = 1 - ratio, y = ratio, at_x = f(x), at_y = f(y), least = std::fmin(f(0), f(1));
    for (int i = 0; i < 40 && high - low > 1e-15; ++i) {
        if (at_x < at_y) {
            high = y, y = x, at_y = at_x;
            x = high - ratio * (high - low), at_x = f(x);
        } else {
            low = x, x = y, at_x = at_y;
            y = low + ratio * (high - low), at_y = f(y);
        }
        least = std::fmin(least, std::fmin(at_x, at_y));
    }
    return least;
}
/// How far B is beyond A along a vector; both in A's frame, at most by their distance.
template <class A, class B>
double apart_along(const A& a, const B& b, const stand& at, doubles n) {
    const auto core_a = physics::core_of(a), core_b = physics::core_of(b);
    const physics::detail::placed_core<D> placed{&core_b, physics::detail::to_matrix(at.rotation), at.position};
    return dot(n, placed.support(-n).at - core_a.support(n).at) - (core_a.radius + core_b.radius) * length(n);
}
/// What a fraction of S may err by, on a way of that length (m).
inline double rounding_along(double length) { return 2 * epsilon * length; }

inline std::string said(const char* what, double x, double y) {
    char text[200];
    std::snprintf(text, sizeof text, "%s: %.17g, %.17g; ", what, x, y);
    return text;
}

struct ray_case {
    sample shape;
    transform at;
    vec origin, translation;

    [[nodiscard]] std::string text() const {
        std::string t = shape.text() + "\nat";
        for (const S x : parts_of(at.rotation)) t += said("", cell::number(x), 0);
        for (const vec& v : {at.position, origin, translation})
            t += said("", cell::number(v[0]), cell::number(v[1])) + said("", to_reals(v).z, 0);
        return t;
    }
};
/// The law that a ray breaks; empty if it keeps all.
inline std::string broken_law(const ray_case& r) {
    return r.shape.visit([&](const auto& shape, const auto& twin) -> std::string {
        const auto hit = cast_ray(shape, r.at, r.origin, r.translation);
        const stand at = exact(r.at);
        const doubles from = inverse_transform(at, exact(r.origin));
        const doubles displacement = inverse_rotate(at.rotation, exact(r.translation));
        const auto distance = [&](double t) {
            return separation(twin, physics::ball<double, D>{0}, stand{from + displacement * t, {}}).distance;
        };
        const double reach = length(from) + length(displacement) + r.shape.size();
        const double tolerance = rounding_along(length(displacement)) + 1e-13 * reach + r.shape.blur();
        if (!hit) {
            const double least = least_of(distance);
            return least < -tolerance ? said("missed", least, tolerance) : "";
        }
        const double t = cell::number(hit.fraction);
        if (!(t >= 0 && t <= 1)) return said("fraction", t, 0);
        const reals n = to_reals(hit.normal);
        if (size(to_reals(hit.point) - to_reals(r.origin) - to_reals(r.translation) * t) >
            8 * tolerance + 4 * epsilon * (size(to_reals(r.origin)) + 1))
            return said("point", size(to_reals(hit.point)), t);
        if (size(n) == 0) return t == 0 && distance(0) <= tolerance ? "" : said("no normal", t, distance(0));
        if (!(std::abs(size(n) - 1) <= 8 * epsilon)) return said("unit", size(n), 0);
        if (std::abs(distance(t)) > tolerance) return said("not on the surface", distance(t), tolerance);
        for (int k = 0; k < 6; ++k)
            if (distance(t * k / 6) < -tolerance) return said("entered before", distance(t * k / 6), t * k / 6);
        const doubles out = inverse_rotate(at.rotation, on_axes(unit(n)));
        if (dot(out, displacement) > 16 * epsilon * length(displacement) + 1e-14 * reach)
            return said("leaves along the normal", dot(out, displacement), 0);
        const double above = apart_along(twin, physics::ball<double, D>{0}, stand{from + displacement * t, {}}, out);
        if (above < -tolerance - 8 * epsilon * r.shape.size()) return said("normal", above, tolerance);
        return "";
    });
}

CELL_CASE("casts: rays meet shapes where their distance from a point says") {
    cell::dice dice(91);
    int hits = 0;
    for (int i = 0; i < cell::draws(60000); ++i) {
        const double scale = i % 5 == 3 ? 1e-2 : 1;
        ray_case r;
        r.shape = random_sample(dice, scale, 7);
        r.at = random_transform(dice, i % 7 == 0 ? 1000 : 2);
        // A point of the surface or within, and a way past it; grazing ones lie across the normal there.
        reals through, along = random_direction(dice);
        const reals n = random_direction(dice);
        r.shape.visit([&](const auto&, const auto& twin) {
            const auto core = physics::core_of(twin);
            const doubles p = core.support(on_axes(n)).at + on_axes(n) * core.radius;
            for (int k = 0; k < D; ++k) through[k] = p[k];
        });
        if (i % 3 == 0) {
            const double off[] = {0, 1e-9, -1e-9, 1e-5, -1e-5, 1e-2, -1e-2};
            along = cell::is_2d ? cross(n, {0, 0, 1}) : unit(cross(n, random_direction(dice)));
            through = through + n * (scale * off[dice.below(7)]);
        } else if (i % 3 == 1) {
            through = through * dice.number(-1.5, 1.5);
        }
        const double far = i % 11 == 0 ? 1e4 : dice.number(0, 4) * scale;
        const stand at = exact(r.at);
        const double onwards[] = {0.5, 1, 1.25, 2};
        r.origin = from_reals(to_reals(r.at.position));
        const doubles start = at * on_axes(through - along * far);
        for (int k = 0; k < D; ++k) r.origin[k] = S(start[k]);
        const doubles displacement = at.rotation * on_axes(along * (far * onwards[dice.below(4)]));
        for (int k = 0; k < D; ++k) r.translation[k] = S(displacement[k]);
        if (i % 50 == 0) r.translation = {};
        const std::string broken = broken_law(r);
        if (!broken.empty()) FAIL_CHECK(broken << r.text());
        hits += r.shape.visit(
            [&](const auto& s, const auto&) { return cast_ray(s, r.at, r.origin, r.translation).hit ? 1 : 0; });
    }
    CHECK(hits > cell::draws(16000));
    CHECK(hits < 50000);
}

CELL_CASE("casts: rays in the planes of faces, along edges, through corners, without length, as boxes of proxies") {
    cell::dice dice(92);
    int hits = 0;
    for (int i = 0; i < cell::draws(20000); ++i) {
        physics::box<S, D> box;
        transform at;
        vec from, displacement;
        for (int k = 0; k < D; ++k) {
            box.half_extents[k] = S(1 + dice.below(3));
            at.position[k] = S(dice.below(5) - 2);
            from[k] = S(dice.below(13) - 6);
            displacement[k] = S(dice.below(3) ? dice.below(17) - 8 : 0);
        }
        const physics::ray<S, D> ray{from, displacement};
        S fraction{};
        const bool meets_box = physics::detail::meets(ray, bounds(box, at), S(1), fraction);
        // One that begins on the surface has to go inwards.
        bool is_within = true, begins_on = false, leaves = false;
        for (int k = 0; k < D; ++k) {
            const S local = from[k] - at.position[k], half = box.half_extents[k];
            is_within = is_within && local <= half && -local <= half;
            if (local != half && -local != half) continue;
            begins_on = true;
            leaves = leaves || !(local > S(0) ? displacement[k] < S(0) : displacement[k] > S(0));
        }
        begins_on = begins_on && is_within;
        const bool expected = meets_box && !(begins_on && leaves);
        const auto hit = cast_ray(box, at, from, displacement);
        REQUIRE(hit.hit == expected);
        if (hit) REQUIRE((hit.normal == vec{}) == (is_within && !begins_on));
        hits += hit.hit;
        if (hit) REQUIRE(cell::near(hit.fraction, fraction, 1));
        // The same by GJK.
        const auto grown = cast_ray(physics::rounded_box<S, D>{box.half_extents, S(0)}, at, from, displacement);
        REQUIRE(grown.hit == meets_box);
        if (hit) REQUIRE(cell::near(grown.fraction, fraction, 1));
    }
    CHECK(hits > cell::draws(1200));
    // Tangents.
    const auto meets = [](const auto& shape, reals from, reals displacement) {
        return cast_ray(shape, transform{}, from_reals(from), from_reals(displacement)).hit;
    };
    CHECK(meets(physics::ball<S, D>{S(3)}, {-8, 3, 0}, {16, 0, 0}));
    CHECK(meets(physics::ball<S, D>{S(5)}, {-1, 7, 0}, {8, -6, 0}));
    CHECK(!meets(physics::ball<S, D>{S(3)}, {-8, 3.00001, 0}, {16, 0, 0}));
    CHECK(meets(physics::capsule<S, D>{S(2), S(1)}, {-8, 1, 0}, {16, 0, 0}));
    CHECK(meets(physics::capsule<S, D>{S(2), S(1)}, {3, -9, 0}, {0, 18, 0}));
    CHECK(!meets(physics::capsule<S, D>{S(2), S(1)}, {-3, 0, 0}, {}));
    CHECK(!meets(physics::capsule<S, D>{S(2), S(1)}, {-3.001, 0, 0}, {-1, 0, 0}));
    const physics::halfspace<S, D> ground;
    CHECK(meets(ground, {0, 1, 0}, {9, -1, 0}));
    CHECK(!meets(ground, {0, 0, 0}, {0, 1, 0}));
    CHECK(!meets(ground, {-2, 0, 0}, {4, 0, 0}));
    CHECK(!meets(ground, {0, 1, 0}, {9, 0, 0}));
    CHECK(!meets(ground, {0, 1, 0}, {9, -0.999, 0}));
}

struct cast_case {
    sample a, b;
    transform b_in_a;
    vec displacement;

    [[nodiscard]] std::string text() const {
        std::string t = a.text() + "\n" + b.text() + "\nat";
        for (const S x : parts_of(b_in_a.rotation)) t += said("", cell::number(x), 0);
        for (const vec& v : {b_in_a.position, displacement})
            t += said("", cell::number(v[0]), cell::number(v[1])) + said("", to_reals(v).z, 0);
        return t;
    }
    [[nodiscard]] physics::cast_hit<S, D> cast(S most = S(1)) const {
        return a.visit_some([&](const auto& sa, const auto&) {
            return b.visit_some(
                [&](const auto& sb, const auto&) { return cast_shape(sa, sb, b_in_a, displacement, most); });
        });
    }
};
inline std::string broken_law(const cast_case& c) {
    const physics::cast_hit<S, D> hit = c.cast();
    return c.a.visit_some([&](const auto&, const auto& a) {
        return c.b.visit_some([&](const auto&, const auto& b) -> std::string {
            const stand at = exact(c.b_in_a);
            const doubles displacement = exact(c.displacement);
            const auto there = [&](double t) { return stand{at.position + displacement * t, at.rotation}; };
            const auto distance = [&](double t) { return separation(a, b, there(t)).distance; };
            const double sizes = c.a.size() + c.b.size(), reach = length(at.position) + length(displacement) + sizes;
            const double tolerance = rounding_along(length(displacement)) + 1e-12 * reach + c.a.blur() + c.b.blur();
            const double touch = 10 * epsilon * (length(at.position) + sizes * 2 + 1);
            if (!hit) {
                const double least = least_of(distance);
                return least < -tolerance - touch ? said("missed", least, tolerance) : "";
            }
            const double t = cell::number(hit.fraction);
            const doubles n = on_axes(unit(to_reals(hit.normal)));
            if (!(t >= 0 && t <= 1)) return said("fraction", t, 0);
            if (!(std::abs(size(to_reals(hit.normal)) - 1) <= 8 * epsilon)) return said("unit", t, 0);
            // EPA may not find the last digits of a normal between two round cores.
            if (t > 0 && hit.status != physics::query_status::converged) return said("status", t, 0);
            const double here = distance(t), along = apart_along(a, b, there(t), n);
            const double of_normal = tolerance + 16 * epsilon * (sizes + cell::is_fixed);
            if (along < std::fmin(here, 0) - of_normal) return said("normal", along, here);
            const double off_a = separation(a, physics::ball<double, D>{0}, stand{exact(hit.point), {}}).distance;
            // EPA's faces are chords of a round core.
            const double of_point = t == 0 && c.a.blur() + c.b.blur() > 0 ? 1e-4 * sizes : of_normal;
            if (std::abs(off_a) > of_point) return said("the point on A", off_a, tolerance);
            if (t == 0 && here <= tolerance) return "";
            if (std::abs(here) > tolerance) return said("not in touch", here, tolerance);
            if (dot(n, displacement) > 16 * epsilon * length(displacement))
                return said("moves apart", dot(n, displacement), t);
            for (int k = 0; k < 6; ++k)
                if (distance(t * k / 6) < -tolerance) return said("entered before", distance(t * k / 6), t * k / 6);
            return "";
        });
    });
}
/// B on its way towards A or past it.
inline cast_case random_cast(cell::dice& dice, int i) {
    const double scale = i % 5 == 3 ? 1e-2 : 1;
    cast_case c;
    c.a = random_sample(dice, scale, 5);
    c.b = random_sample(dice, scale, 5);
    c.b_in_a.rotation = i % 6 == 0 ? rotation{} : random_rotation(dice);
    const reals along = random_direction(dice);
    const double far = i % 13 == 0 ? 1e4 : dice.number(0, 3) * scale;
    const double onwards[] = {0.5, 1, 1.5, 2};
    reals aside = random_direction(dice) * (dice.number(0, 1) * scale);
    if (i % 4 == 0) {
        // Past it, by less and less: B begins where it touches A along a normal, and goes back across that.
        c.a.visit_some([&](const auto&, const auto& a) {
            c.b.visit_some([&](const auto&, const auto& b) {
                const reals n = random_direction(dice);
                const double off[] = {0, 1e-9, -1e-9, 1e-5, -1e-5, 1e-2, -1e-2};
                const double gap = apart_along(a, b, stand{{}, exact(c.b_in_a.rotation)}, on_axes(n));
                const reals across = cell::is_2d ? cross(n, {0, 0, 1}) : unit(cross(n, random_direction(dice)));
                aside = n * (off[dice.below(7)] * scale - gap);
                c.b_in_a.position = from_reals(aside - across * far);
                c.displacement = from_reals(across * (far * onwards[dice.below(4)]));
            });
        });
        return c;
    }
    c.b_in_a.position = from_reals(aside - along * far);
    c.displacement = from_reals(along * (far * onwards[dice.below(4)]));
    return c;
}

CELL_CASE("casts: shapes that move touch where their distance says, in either order") {
    cell::dice dice(93);
    int hits = 0;
    for (int i = 0; i < cell::draws(40000); ++i) {
        const cast_case c = random_cast(dice, i);
        std::string broken = broken_law(c);
        if (!broken.empty()) FAIL_CHECK(broken << c.text());
        hits += c.cast().hit;
        if (i % 4 != 1) continue;
        cast_case swapped = c;
        std::swap(swapped.a, swapped.b);
        swapped.b_in_a = inverse(c.b_in_a);
        swapped.displacement = -inverse_rotate(c.b_in_a.rotation, c.displacement);
        broken = broken_law(swapped);
        if (!broken.empty()) FAIL_CHECK("swapped, " << broken << swapped.text());
    }
    CHECK(hits > cell::draws(10000));
    CHECK(hits < 36000);
}

CELL_CASE("casts: a part of the way gives the hits of that part") {
    cell::dice dice(94);
    for (int i = 0; i < cell::draws(3000); ++i) {
        const cast_case c = random_cast(dice, 1 + 4 * i);
        const auto whole = c.cast();
        const S most = dice.real(0, 1);
        const auto part = c.cast(most);
        if (whole && whole.fraction == S(0)) continue;
        REQUIRE(part.hit == (whole.hit && whole.fraction <= most));
        if (part) REQUIRE(part.fraction == whole.fraction);
    }
}

CELL_CASE("casts: boxes that touch hit only if they approach along all faces that touch") {
    const physics::box<S, D> box{vec::filled(S(1))};
    int all = 1;
    for (int i = 0; i < D; ++i) all *= 9;
    for (int code = 0; code < all * all; ++code) {
        vec at, displacement;
        bool touching = false, overlapping = true, approaching = true;
        for (int i = 0, rest = code; i < D; ++i) {
            const int x = rest / 9 % 9 - 4;
            at[i] = S(0.5 * x);
            displacement[i] = S(rest % 9 - 4);
            const int toward = -(rest % 9 - 4) * (x < 0 ? -1 : 1);
            touching = touching || std::abs(x) == 4;
            overlapping = overlapping && std::abs(x) < 4;
            if (std::abs(x) == 4) approaching = approaching && toward > 0;
            rest /= 81;
        }
        if (!touching) continue;
        const auto hit = cast_shape(box, box, transform{at, {}}, displacement);
        CAPTURE(at);
        CAPTURE(displacement);
        REQUIRE(hit.hit == approaching);
        REQUIRE((!hit || hit.fraction == S(0)));
    }
}

CELL_CASE("casts: on a halfspace, in either order") {
    cell::dice dice(96);
    int hits = 0;
    for (int i = 0; i < cell::draws(10000); ++i) {
        const sample s = random_sample(dice, 1, 5);
        const physics::halfspace<S, D> ground{from_reals(random_direction(dice)), dice.real(-1, 1)};
        const transform at{dice.vec<vec>(-3, 3), random_rotation(dice)};
        const vec displacement = dice.vec<vec>(-6, 6);
        s.visit_some([&](const auto& shape, const auto& twin) {
            const physics::halfspace<double, D> plane{exact(ground.normal), cell::number(ground.offset)};
            const auto distance = [&](double t) {
                const stand there{exact(at.position) + exact(displacement) * t, exact(at.rotation)};
                return separation(plane, twin, there).distance;
            };
            const double tolerance = 64 * epsilon + s.blur() + 1e-12;
            for (const bool first : {true, false}) {
                const auto hit =
                    first ? cast_shape(ground, shape, at, displacement)
                          : cast_shape(shape, ground, inverse(at), -inverse_rotate(at.rotation, displacement));
                if (!hit) {
                    REQUIRE(std::fmin(distance(0), distance(1)) > -tolerance);
                    continue;
                }
                ++hits;
                const double t = cell::number(hit.fraction);
                REQUIRE((t == 0 ? distance(0) < tolerance : std::abs(distance(t)) < tolerance));
                const vec n = first ? hit.normal : -(at.rotation * hit.normal);
                REQUIRE(near(to_reals(n), unit(to_reals(ground.normal)), 16));
                if (t == 0 || first) continue;
                const auto on_shape =
                    separation(twin, physics::ball<double, D>{0}, stand{exact(hit.point), {}}).distance;
                REQUIRE(std::abs(on_shape) < tolerance);
            }
        });
    }
    CHECK(hits > cell::draws(8000));
    // At rest on the ground: along it and away from it nothing is hit.
    const physics::box<S, D> box;
    const auto from = [&](reals p, reals displacement) {
        return cast_shape(physics::halfspace<S, D>{}, box, transform{from_reals(p), {}}, from_reals(displacement)).hit;
    };
    CHECK(!from({0, 0.5, 0}, {3, 0, 0}));
    CHECK(!from({0, 0.5, 0}, {3, 1, 0}));
    CHECK(from({0, 0.5, 0}, {3, -1, 0}));
    CHECK(from({0, 0.25, 0}, {0, 1, 0}));
}

template <int N>
physics::rotation<double, N> exact_rotation(double angle, reals v, double w) {
    if constexpr (N == 2) return {std::cos(angle), std::sin(angle)};
    else return {v.x, v.y, v.z, w};
}
/// Where a sweep leads, by the standard's sine and cosine.
inline stand stand_at(const sweep& s, double t) {
    const reals turn = to_reals(s.turn) * t;
    const double angle = size(turn);
    const reals v = angle > 0 ? turn * (std::sin(angle / 2) / angle) : reals{};
    const auto by = exact_rotation<D>(turn.z, v, std::cos(angle / 2));
    const physics::rotation<double, D> r = normalized(by * exact(s.rotation));
    const doubles start = exact(s.start), center = start + (exact(s.end) - start) * t;
    return stand{center, r} * exact(s.shape);
}
struct impact_case {
    sample a, b;
    sweep of_a, of_b;
    physics::impact_settings<S> settings;

    [[nodiscard]] std::string text() const {
        std::string t = a.text() + "\n" + b.text();
        for (const sweep* s : {&of_a, &of_b}) {
            for (const vec& v : {s->start, s->end, s->shape.position})
                t += said("", cell::number(v[0]), cell::number(v[1])) + said("", to_reals(v).z, 0);
            for (const rotation& r : {s->rotation, s->shape.rotation})
                for (const S x : parts_of(r)) t += said("", cell::number(x), 0);
            t += said("turn", to_reals(s->turn).x, to_reals(s->turn).y) + said("", to_reals(s->turn).z, 0);
        }
        return t;
    }
    [[nodiscard]] physics::impact<S, D> run() const {
        return a.visit_some([&](const auto& sa, const auto&) {
            return b.visit_some(
                [&](const auto& sb, const auto&) { return time_of_impact(sa, of_a, sb, of_b, settings); });
        });
    }
    template <class F>
    decltype(auto) with_distance(F&& f) const {
        return a.visit_some([&](const auto&, const auto& ea) {
            return b.visit_some([&](const auto&, const auto& eb) {
                return f([&](double t) {
                    return separation(ea, eb, relative(stand_at(of_a, t), stand_at(of_b, t))).distance;
                });
            });
        });
    }
};
inline std::string broken_law(const impact_case& c, int samples) {
    const physics::impact<S, D> found = c.run();
    return c.with_distance([&](auto&& distance) -> std::string {
        const double t = cell::number(found.fraction), start = distance(0),
                     speed = size(to_reals(c.of_a.end) - to_reals(c.of_a.start)) +
                             size(to_reals(c.of_b.end) - to_reals(c.of_b.start)) +
                             (size(to_reals(c.of_a.turn)) + size(to_reals(c.of_b.turn))) * 2;
        const double tolerance = rounding_along(speed) + 1e-11 + c.a.blur() + c.b.blur();
        const double target = cell::number(c.settings.target), slack = cell::number(c.settings.tolerance);
        if (!(t >= 0 && t <= 1)) return said("fraction", t, 0);
        if (found.state == impact_state::overlapping)
            return t != 0 || start > tolerance ? said("overlapping", start, t) : "";
        if (start < -tolerance) return said("overlap not seen", start, t);
        if (start < tolerance) return "";
        const double goal = start > target + slack + tolerance ? target : 0.5 * start;
        const double least = std::fmin(goal, 0.5 * start) - tolerance;
        for (int k = 0; k <= samples; ++k) {
            const double at = t * k / samples, gap = distance(at);
            if (gap < (start > target + slack + tolerance ? goal - tolerance : least))
                return said("too close", gap, at) + said("start, t", start, t);
        }
        if (found.state == impact_state::separated) return t == 1 ? "" : said("separated before the end", t, 0);
        if (found.state != impact_state::hit) return said("given up", t, distance(t));
        const double gap = distance(t);
        if (gap > target + slack + tolerance) return said("stopped too early", gap, t);
        const reals n = to_reals(found.normal);
        if (!(std::abs(size(n) - 1) <= 8 * epsilon)) return said("unit", size(n), 0);
        return c.a.visit_some([&](const auto&, const auto& ea) {
            return c.b.visit_some([&](const auto&, const auto& eb) -> std::string {
                const stand a = stand_at(c.of_a, t), b = stand_at(c.of_b, t);
                const double along = apart_along(ea, eb, relative(a, b), inverse_rotate(a.rotation, on_axes(unit(n))));
                const double off =
                    separation(ea, physics::ball<double, D>{0}, stand{inverse_transform(a, exact(found.point)), {}})
                        .distance;
                const double rough = 4 * tolerance + 64 * epsilon * (1 + size(to_reals(found.point)));
                if (along < gap - rough) return said("normal", along, gap);
                return std::abs(off) > rough ? said("the point on A", off, gap) : "";
            });
        });
    });
}
inline cell::space::angular random_turn(cell::dice& dice, double most) {
    return to_angular(random_axis(dice) * dice.number(-most, most));
}

CELL_CASE("casts: shapes that move and turn stay apart until the time of impact") {
    cell::dice dice(97);
    int states[4] = {};
    for (int i = 0; i < cell::draws(20000); ++i) {
        impact_case c;
        c.a = random_sample(dice, 1, 5);
        c.b = random_sample(dice, 1, 5);
        const double turns[] = {0, 0.1, 1, 4, 20};
        for (sweep* s : {&c.of_a, &c.of_b}) {
            s->start = dice.vec<vec>(-1.2, 1.2);
            s->end = s->start;
            if (dice.below(4)) s->end += dice.vec<vec>(-2, 2);
            s->rotation = random_rotation(dice);
            s->turn = random_turn(dice, turns[dice.below(5)]);
            if (dice.below(2)) s->shape = random_transform(dice, 0.3);
        }
        const std::string broken = broken_law(c, 60);
        if (!broken.empty()) FAIL_CHECK(broken << c.text());
        ++states[static_cast<int>(c.run().state)];
    }
    CHECK(states[0] > cell::draws(5000));
    CHECK(states[1] > cell::draws(1500));
    CHECK(states[3] == 0);
}

CELL_CASE("casts: powers of two change no bit of a fraction or a normal") {
    if (cell::is_fixed) return;
    cell::dice dice(95);
    int hits = 0;
    for (int i = 0; i < cell::draws(4000); ++i) {
        cast_case c = random_cast(dice, 1 + 5 * i);
        if (c.a.of == sample::hull || c.b.of == sample::hull) continue;
        impact_case m{c.a, c.b, {}, {}, {S(0.01), S(0.001)}};
        m.of_a.turn = random_turn(dice, 2);
        m.of_b.turn = random_turn(dice, 2);
        m.of_b.start = c.b_in_a.position;
        m.of_b.end = c.b_in_a.position + c.displacement;
        const auto ray = [&] {
            return c.a.visit_some([&](const auto& s, const auto&) {
                return cast_ray(s, transform{{}, c.b_in_a.rotation}, c.b_in_a.position, c.displacement);
            });
        };
        const auto hit = c.cast();
        const auto met = m.run();
        const auto seen = ray();
        const S factor = S(i % 2 ? 0x1p-50 : 0x1p50);
        for (sample* s : {&c.a, &c.b}) s->half *= factor, s->radius *= factor;
        m.a = c.a, m.b = c.b;
        for (vec* v : {&c.b_in_a.position, &c.displacement, &m.of_b.start, &m.of_b.end}) *v *= factor;
        m.settings.target *= factor;
        m.settings.tolerance *= factor;
        const auto scaled = c.cast();
        REQUIRE(scaled.hit == hit.hit);
        REQUIRE(scaled.fraction == hit.fraction);
        REQUIRE(scaled.normal == hit.normal);
        const auto met_there = m.run();
        REQUIRE(met_there.state == met.state);
        REQUIRE(met_there.fraction == met.fraction);
        REQUIRE(met_there.normal == met.normal);
        const auto seen_there = ray();
        REQUIRE(seen_there.hit == seen.hit);
        REQUIRE(seen_there.fraction == seen.fraction);
        hits += hit.hit + seen.hit + (met.state == impact_state::hit);
    }
    CHECK(hits > cell::draws(1000));
}

CELL_CASE("casts: thin blades that spin by half a turn and more hit small balls in their way") {
    cell::dice dice(98);
    for (int i = 0; i < cell::draws(10000); ++i) {
        const physics::box<S, D> blade{[] {
            vec h = vec::filled(S(0.125));
            h.x = S(2), h.y = S(0.001);
            return h;
        }()};
        const double from = dice.number(0.3, 2.8), turn = dice.number(3.3, 40) * (dice.below(2) ? 1 : -1);
        const double radius = dice.number(0.002, 0.02), far = dice.number(0.2, 1.9);
        sweep of_blade, of_ball;
        of_blade.turn = to_angular({0, 0, turn});
        of_ball.start = of_ball.end = from_reals({far * std::cos(from), far * std::sin(from), 0});
        const physics::ball<S, D> pellet{S(radius)};
        const auto found = i % 2 ? time_of_impact(blade, of_blade, pellet, of_ball, {S(1e-4), S(1e-4)})
                                 : time_of_impact(pellet, of_ball, blade, of_blade, {S(1e-4), S(1e-4)});
        REQUIRE(found.state == impact_state::hit);
        // The blade turns until its side is at the ball: sin(angle left) = reach / far.
        const double left = std::asin((0.001 + radius) / far), displacement = turn > 0 ? from : M_PI - from;
        const double angle = std::abs(turn) * cell::number(found.fraction);
        REQUIRE(angle < displacement - left + 1e-5);
        REQUIRE(angle > displacement - left - 0.0004 / far);
    }
}

CELL_CASE("casts: what rests or slides at a small distance is not stopped, what comes closer is") {
    const physics::box<S, D> box;
    const physics::halfspace<S, D> ground;
    for (const double gap : {0.0001, 0.002, 0.005, 0.0055}) {
        sweep still, moving;
        moving.start = from_reals({0, 1 + gap, 0});
        for (const double drop : {0.0, -0.1, -10.0}) {
            moving.end = from_reals({30, 1 + gap + drop, 0});
            const auto found = time_of_impact(box, still, box, moving), back = time_of_impact(box, moving, box, still);
            const bool falls = drop < -1;
            if (!falls && drop < 0) continue;
            CHECK((found.state == impact_state::hit) == falls);
            CHECK((back.state == impact_state::hit) == falls);
            moving.start = from_reals({0, 0.5 + gap, 0});
            moving.end = from_reals({30, 0.5 + gap + drop, 0});
            const auto down = time_of_impact(ground, still, box, moving);
            const auto turned_round = time_of_impact(box, moving, ground, still);
            CHECK((down.state == impact_state::hit) == falls);
            CHECK((turned_round.state == impact_state::hit) == falls);
            CHECK(down.fraction == turned_round.fraction);
            moving.start = from_reals({0, 1 + gap, 0});
        }
    }
}

CELL_CASE("casts: shapes that tumble onto the ground, in either order") {
    cell::dice dice(99);
    int hits = 0;
    for (int i = 0; i < cell::draws(10000); ++i) {
        const sample s = random_sample(dice, 1, 5);
        sweep still, moving;
        still.rotation = random_rotation(dice);
        if (i % 2) still.turn = random_turn(dice, 0.5);
        const physics::halfspace<S, D> ground{from_reals(random_direction(dice)), dice.real(-1, 1)};
        const double turns[] = {0, 0.3, 3, 20};
        moving.start = dice.vec<vec>(-3, 3);
        moving.end = dice.vec<vec>(-3, 3);
        moving.rotation = random_rotation(dice);
        moving.turn = random_turn(dice, turns[dice.below(4)]);
        s.visit_some([&](const auto& shape, const auto& twin) {
            const physics::halfspace<double, D> plane{exact(ground.normal), cell::number(ground.offset)};
            const auto distance = [&](double t) {
                return separation(plane, twin, relative(stand_at(still, t), stand_at(moving, t))).distance;
            };
            const auto found = time_of_impact(ground, still, shape, moving);
            const auto swapped = time_of_impact(shape, moving, ground, still);
            REQUIRE(found.state == swapped.state);
            REQUIRE(found.fraction == swapped.fraction);
            const double start = distance(0), t = cell::number(found.fraction),
                         tolerance = 256 * epsilon + s.blur() + 1e-11;
            if (found.state == impact_state::overlapping) {
                REQUIRE(start < tolerance);
                return;
            }
            REQUIRE(found.state != impact_state::iteration_limit);
            const double least = start > 0.00625 + tolerance ? 0.005 : std::fmin(0.5 * start, 0.005);
            for (int k = 0; k <= 60; ++k) REQUIRE(distance(t * k / 60) > least - tolerance);
            if (found.state != impact_state::hit) return;
            ++hits;
            REQUIRE(distance(t) < 0.00625 + tolerance);
            const stand at = stand_at(moving, t);
            const auto off =
                separation(twin, physics::ball<double, D>{0}, stand{inverse_transform(at, exact(swapped.point)), {}})
                    .distance;
            REQUIRE(std::abs(off) < 4 * tolerance);
        });
    }
    CHECK(hits > cell::draws(500));
}

CELL_CASE("casts: a sweep leads from its start to its end") {
    cell::dice dice(100);
    for (int i = 0; i < 500; ++i) {
        const transform start = random_transform(dice, 3), end = random_transform(dice, 3);
        const transform shape = random_transform(dice, 1);
        const sweep s = physics::sweep_between(start, end, shape);
        for (const S t : {S(0), S(1)}) {
            const transform there = s.at(t), expected = (t == S(0) ? start : end) * shape;
            CHECK(near(to_reals(there.position), to_reals(expected.position), 32));
            CHECK(near_rotation(there.rotation, expected.rotation, 32));
        }
        CHECK(size(to_reals(s.turn)) < M_PI + 1e-5);
    }
}

}  // namespace casts_laws
}  // namespace
