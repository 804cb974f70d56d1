// Laws of GJK and EPA: against an exact search over all features, for every kind of pair in every kind of trouble.
//
// SEPARATION_ROUNDS in the environment (default 3) says how often each kind meets each other in each state.
#pragma once

#include <cstdlib>
#include <string>

#include "convex_pairs.hpp"

namespace {
namespace separation_laws {

using hull_geometry = physics::hull_geometry<S, D>;

/// Calls f with the solid as a shape; false for those that the library has no shape for.
template <class F>
bool with_shape(const solid& s, F&& f) {
    switch (s.of) {
        case solid::kind::ball: f(physics::ball<S, D>{s.radius}); return true;
        case solid::kind::capsule: f(physics::capsule<S, D>{s.half_extents().x, s.radius}); return true;
        case solid::kind::box: f(physics::box<S, D>{s.half_extents()}); return true;
        case solid::kind::flat: return false;
        default: {
            hull_geometry g;
            try {
                g = hull_geometry::build(s.points.data(), static_cast<std::uint32_t>(s.points.size()));
            } catch (const physics::error&) {
                // So thin that the scalar sees no volume.
                return false;
            }
            f(g.shape(s.radius));
            return true;
        }
    }
}
template <class F>
bool with_shapes(const convex_pair& p, F&& f) {
    bool both = false;
    with_shape(p.a, [&](auto a) { both = with_shape(p.b, [&](auto b) { f(a, b); }); });
    return both;
}

inline int rounds() {
    const char* wanted = std::getenv("SEPARATION_ROUNDS");
    return wanted ? std::atoi(wanted) : cell::draws(3);
}

/// Calls check(pair, shape a, shape b) for every two kinds of solids in each state; it returns a complaint.
template <class Check>
void every_convex_pair(std::uint64_t seed, Check&& check) {
    for (int state = 0; state < convex_pair::states; ++state) {
        cell::dice dice(seed + static_cast<std::uint64_t>(state));
        int met = 0;
        std::string said;
        for (int round = 0; round < rounds() && said.empty(); ++round)
            for (int ka = 0; ka < solid::kinds && said.empty(); ++ka)
                for (int kb = 0; kb < solid::kinds && said.empty(); ++kb) {
                    const convex_pair p =
                        random_pair(solid::kind(ka), solid::kind(kb), convex_pair::state(state), dice);
                    met += with_shapes(p, [&](auto a, auto b) { said = check(p, a, b); });
                    if (!said.empty()) said += "\n" + text_of(p);
                }
        CHECK_MESSAGE(said.empty(), said);
        CHECK(met > rounds() * 30);
    }
}

/// What rounding may cost: builders take for flat what 8 spacings of the scalar bent.
inline double tolerance_of(const convex_pair& p) { return 32 * std::fmax(epsilon, 2.3e-16) * p.reach(); }
inline claim to_claim(const physics::closest_points<S, D>& c) {
    return {cell::number(c.distance), to_reals(c.normal), to_reals(c.on_a), to_reals(c.on_b)};
}
/// Points that are computed across sizes as unequal as these may lose digits along the surfaces.
inline double points_of(const convex_pair& p) {
    return p.in == convex_pair::state::unequal || p.in == convex_pair::state::thin ? 256 : 1;
}

CELL_CASE("separation: agrees with the exact one, cold, warm, and with any cache") {
    physics::gjk_cache of_another;
    cell::dice dice(5);
    every_convex_pair(500, [&](const convex_pair& p, const auto& a, const auto& b) -> std::string {
        const double tolerance = tolerance_of(p) * points_of(p);
        physics::gjk_cache own, random;
        random.count = static_cast<std::uint8_t>(dice.below(8));
        for (std::uint32_t& v : random.vertex) v = static_cast<std::uint32_t>(dice.bits());
        for (float& x : random.axis) x = static_cast<float>(dice.number(-1, 1));
        for (const auto& c :
             {separation(a, b, p.b_in_a), separation(a, b, p.b_in_a, own), separation(a, b, p.b_in_a, own),
              separation(a, b, p.b_in_a, of_another), separation(a, b, p.b_in_a, random)}) {
            const std::string law = broken_law(p, to_claim(c), tolerance);
            if (!law.empty()) return law;
            if (c.status != physics::query_status::converged) return "the limit of iterations was reached";
        }
        return "";
    });
}

CELL_CASE("separation: distances and overlaps say the same") {
    every_convex_pair(700, [&](const convex_pair& p, const auto& a, const auto& b) -> std::string {
        const double tolerance = tolerance_of(p), exact = static_cast<double>(p.exact().distance);
        const auto d = distance(a, b, p.b_in_a);
        if (!(std::abs(cell::number(d.distance) - std::fmax(exact, 0)) <= tolerance)) return "the distance";
        if (std::abs(exact) > tolerance && overlap(a, b, p.b_in_a) != (exact <= 0)) return "whether they overlap";
        return "";
    });
}

CELL_CASE("separation: swapping the shapes mirrors the answer") {
    every_convex_pair(900, [&](const convex_pair& p, const auto& a, const auto& b) -> std::string {
        const convex_pair q = p.swapped();
        const auto first = separation(a, b, p.b_in_a), second = separation(b, a, q.b_in_a);
        if (!(std::abs(cell::number(first.distance - second.distance)) <= 2 * tolerance_of(p)))
            return "the distances differ";
        return broken_law(q, to_claim(second), tolerance_of(p) * points_of(p));
    });
}

CELL_CASE("separation: MPR parts what overlaps, never by less than the shortest way") {
    every_convex_pair(1000, [&](const convex_pair& p, const auto& a, const auto& b) -> std::string {
        const physics::detail::core_pair<D> pair(a, b, p.b_in_a);
        const auto found = physics::detail::separate<S>(pair, physics::detail::no_limit, nullptr,
                                                        physics::detail::overlap_method::mpr);
        const claim c = to_claim(physics::detail::rounded<S>(pair, found));
        const double tolerance = tolerance_of(p) * points_of(p), exact = static_cast<double>(p.exact().distance);
        const oracle::point n{c.normal.x, c.normal.y, c.normal.z};
        if (!(std::abs(static_cast<double>(oracle::size(n)) - 1) <= 32 * epsilon))
            return "the normal is no unit vector";
        const double along = static_cast<double>(separation_along(p.exact_a(), p.exact_b(), n * (1 / oracle::size(n))));
        if (!(std::abs(along - c.distance) <= tolerance)) return "the normal does not part them as far as it says";
        if (c.distance > exact + tolerance) return "it says less than the shortest way";
        return "";
    });
}

inline std::string off_by(const char* what, double off, double allowed) {
    char text[120];
    std::snprintf(text, sizeof text, "%s: off by %.3g, allowed %.3g", what, off, allowed);
    return text;
}

CELL_CASE("separation: manifolds of every pair agree with the exact distance") {
    using any =
        physics::any_shape<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull>;
    using query = physics::narrowphase_query<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace,
                                             physics::hull>;
    every_convex_pair(1100, [&](const convex_pair& p, const auto& a, const auto& b) -> std::string {
        const double exact = static_cast<double>(p.exact().distance);
        double scale = HUGE_VAL, smallest = HUGE_VAL;
        for (const solid* s : {&p.a, &p.b}) {
            double largest = 0, least = HUGE_VAL;
            for (int i = 0; i < D; ++i) {
                double low = HUGE_VAL, high = -HUGE_VAL;
                for (const vec& v : s->points) {
                    low = std::fmin(low, cell::number(v[i]));
                    high = std::fmax(high, cell::number(v[i]));
                }
                largest = std::fmax(largest, high - low + cell::number(s->radius));
                least = std::fmin(least, (high - low) / 2 + cell::number(s->radius));
            }
            scale = std::fmin(scale, largest);
            smallest = std::fmin(smallest, least);
        }
        const double tolerance = tolerance_of(p) * points_of(p), allowed = tolerance + smallest / 128;
        // A round side that lies within five degrees of flat is taken for flat: a sine of at most the root of 1/128
        // leads the points off it by 1/255 of the radius.
        const double lies = (cell::number(p.a.radius) + cell::number(p.b.radius)) / 255;
        const double of_points = 2 * allowed + lies;
        const any shape_a(a), shape_b(b);
        const query q{&shape_a, &shape_b, p.b_in_a};
        const S margin = cell::real(0.05 * scale);
        physics::manifold_list<S, D> found;
        physics::best_per_pair::in<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace,
                                   physics::hull>::collide(&q, 1, margin, found);
        if (found.empty()) return exact < cell::number(margin) - allowed ? "a contact is missing" : "";
        const physics::manifold<S, D>& m = found[0].contact;
        if (exact > cell::number(margin) + allowed) return "a contact beyond the margin";
        const reals n = to_reals(m.normal);
        const oracle::point wide{n.x, n.y, n.z};
        if (!(std::abs(size(n) - 1) <= 32 * epsilon)) return "the normal is no unit vector";
        const double along =
            static_cast<double>(separation_along(p.exact_a(), p.exact_b(), wide * (1 / oracle::size(wide))));
        if (!(along >= exact - allowed)) return "the normal parts them worse";
        double deepest = HUGE_VAL;
        for (int i = 0; i < m.count; ++i) {
            const double gap = cell::number(m.points[i].separation);
            deepest = std::fmin(deepest, gap);
            const reals at = to_reals(m.points[i].position), on_a = at - n * (gap / 2), on_b = at + n * (gap / 2);
            const double off_a = static_cast<double>(off_surface(p.exact_a(), {on_a.x, on_a.y, on_a.z}));
            const double off_b = static_cast<double>(off_surface(p.exact_b(), {on_b.x, on_b.y, on_b.z}));
            if (!(std::abs(off_a) <= of_points)) return off_by("a point is not on A", off_a, of_points);
            if (!(std::abs(off_b) <= of_points)) return off_by("a point is not on B", off_b, of_points);
            for (int k = 0; k < i; ++k)
                if (m.points[k].feature == m.points[i].feature) return "two points of one feature";
        }
        if (!(std::abs(deepest - exact) <= allowed)) return "the depth";
        return "";
    });
}

}  // namespace separation_laws
}  // namespace
