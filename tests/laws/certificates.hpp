// Laws of the narrowphase on as many pairs as one likes: each answer comes with its proof, so that none is searched for.
//
// What is proven, and how:
//   the cores are apart    Any two points of A and B are at least as far apart as A and B are; along any unit vector, A
//                          and B are at most as far apart as their signed distance says. The answer's points and its
//                          normal give both bounds; where they meet within the tolerance, it is proven.
//   polytopes overlap      The normal parts them by as much as it says, and no face of the difference is nearer: all
//                          directions in which one may point are tried. Proven too; of hulls of many edges one in 16.
//   round cores overlap    (cylinders, cones) Some 80 directions about the normal, along axes and across faces must not
//                          part them sooner: an attempt to refute, no proof. Nor is it one of the hulls left out above.
// Manifolds are judged against the signed distance that was proven.
//
// CERTIFICATE_PAIRS in the environment (default 600) says how many pairs of each two kinds; with that, a line for each
// two kinds is printed. For example a million of each, and what was the worst:
//     CERTIFICATE_PAIRS=1000000 build/gcc/tests/certificates --test-case='double/3D: *'
// CERTIFICATE_KINDS=capsule,hull limits it to two kinds, CERTIFICATE_SEED=n draws other pairs.
#pragma once

#include <chrono>
#include <cstdlib>
#include <memory>

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

namespace law {
enum name {
    converged, unit_normal, parts_so_far, apart_proven, on_surfaces, across, least_proven, least_refuted, warm, mirrored,
    agreed, touching, contact_normal, contact_points, contact_depth, contact_features, count
};
}
inline const char* name_of(law::name of) {
    constexpr const char* names[] = {"the search converged", "the normal is a unit vector",
                                     "the normal parts them as far as it says", "apart: proven by points and normal",
                                     "the points are on the surfaces", "the points lie across",
                                     "overlap: proven by all faces", "overlap: not refuted by directions",
                                     "warm equals cold", "swapped mirrors", "distance and overlap agree",
                                     "a contact is there if it must be", "contact: the normal",
                                     "contact: points on both surfaces", "contact: depths", "contact: features differ"};
    return names[of];
}

/// How often a law was kept, and how nearly not.
class tally {
public:
    struct entry {
        std::uint64_t judged = 0, broken = 0, broken_in[convex_pair::states] = {};
        /// The largest error, in parts of what is allowed.
        double worst = 0;
        std::string text;
    };
    entry of[law::count];

    void note(law::name l, const meet& m, double off, double allowed) {
        entry& e = of[l];
        ++e.judged;
        const bool broken = !(off <= allowed);
        e.broken += broken;
        e.broken_in[static_cast<int>(m.in)] += broken;
        const double part = allowed > 0 ? off / allowed : broken ? HUGE_VAL : 0;
        if (!(part > e.worst) && !(broken && e.text.empty())) return;
        e.worst = part;
        if (!broken) return;
        char text[120];
        std::snprintf(text, sizeof text, "%s: off by %.6g, allowed %.6g, %s", name_of(l), off, allowed, name_of(m.in));
        e.text = text + text_of(convex_encounter{m.a->shape, m.b->shape, m.b_in_a});
    }
    void add(const tally& t) {
        for (int l = 0; l < law::count; ++l) {
            of[l].judged += t.of[l].judged;
            of[l].broken += t.of[l].broken;
            for (int in = 0; in < convex_pair::states; ++in) of[l].broken_in[in] += t.of[l].broken_in[in];
            if (t.of[l].worst > of[l].worst) of[l].worst = t.of[l].worst;
        }
    }
    void print() const {
        for (int l = 0; l < law::count; ++l) {
            if (of[l].judged == 0) continue;
            std::printf("    %-42s %12llu judged %8llu broken, worst %.3g", name_of(law::name(l)),
                        static_cast<unsigned long long>(of[l].judged), static_cast<unsigned long long>(of[l].broken),
                        of[l].worst);
            for (int in = 0; in < convex_pair::states; ++in)
                if (of[l].broken_in[in] > 0)
                    std::printf(" %s %llu", name_of(state(in)), static_cast<unsigned long long>(of[l].broken_in[in]));
            std::printf("\n");
        }
    }
};

/// Judges a claim of the signed distance. `all`: of hulls of many edges as well.
inline void judge_claim(const meet& m, const closest& c, bool all, tally& to) {
    const judge::couple k = m.couple();
    const bool limited = c.status != physics::query_status::converged;
    const double tolerance = m.tolerance(), limit = limited && m.is_round() ? 2e-3 * m.reach() : 0;
    const double of_points = m.of_points() + limit;
    const double d = cell::number(c.distance);
    const judge::point given = wide(c.normal), n = judge::unit_of(given), on_a = wide(c.on_a), on_b = wide(c.on_b);
    // Coaxial round shapes have as many ways out as a circle has points; EPA may stop among them.
    to.note(law::converged, m, limited && !m.is_round(), 0);
    to.note(law::unit_normal, m, std::abs(double(oracle::size(given)) - 1), 32 * epsilon);
    to.note(law::parts_so_far, m, std::abs(double(k.along(n) - k.radii()) - d), tolerance * (m.is_round() ? 2 : 1));
    to.note(law::on_surfaces, m, std::abs(double(k.a->distance(on_a) - k.a->radius)), of_points);
    to.note(law::on_surfaces, m, std::abs(double(k.b->distance(k.at.undo(on_b)) - k.b->radius)), of_points);
    to.note(law::across, m, double(oracle::size(on_b - on_a - given * d)), 4 * of_points);
    const double cores = d + double(k.radii());
    if (cores >= -tolerance) {
        const real most = std::min(k.from_a(on_a - n * k.a->radius), k.from_b(on_b + n * k.b->radius));
        to.note(law::apart_proven, m, double(most) - std::fmax(cores, 0),
                m.in == state::thin || m.in == state::unequal ? m.of_points() : tolerance);
    } else if (k.is_polytopes() && (k.work() <= 1600 || all)) {
        to.note(law::least_proven, m, double(k.best_of_all()) - cores, tolerance);
    } else {
        to.note(law::least_refuted, m, double(k.best_about(n)) - cores, tolerance + limit);
    }
}

template <class Policy>
physics::manifold<S, D> touch(const meet& m, double margin) {
    return convex_set::collide<Policy>(m.a->shape.shape, m.b->shape.shape, m.b_in_a, margin);
}
/// Judges a manifold by the signed distance. To keep the features of bodies at rest, contacts may deviate by 1/128 of the
/// thinner one's half width; a round side that lies within five degrees of flat is taken for flat.
inline void judge_contact(const meet& m, const physics::manifold<S, D>& c, double margin, double exact, tally& to) {
    const judge::couple k = m.couple();
    const double thin = double(std::min(k.a->thin, k.b->thin)), tolerance = m.tolerance();
    const double allowed = tolerance + thin / 128;
    const double lies = double(k.a->radius + k.b->radius) / 255 + (m.is_round() ? double(k.a->thin + k.b->thin) / 128 : 0);
    // Points are cut from points that were cut: each cut rounds.
    const double of_points = 2 * allowed + 2 * m.of_points() + lies;
    to.note(law::touching, m, c.count > 0 ? exact - margin : margin - exact, allowed);
    if (c.count == 0) return;
    const judge::point given = wide(c.normal), n = judge::unit_of(given);
    to.note(law::contact_normal, m, std::abs(double(oracle::size(given)) - 1), 32 * epsilon);
    to.note(law::contact_normal, m, exact - double(k.along(n) - k.radii()), allowed);
    double deepest = HUGE_VAL, farthest = -HUGE_VAL;
    bool repeated = false;
    for (int i = 0; i < c.count; ++i) {
        const double gap = cell::number(c.points[i].separation);
        deepest = std::fmin(deepest, gap);
        farthest = std::fmax(farthest, gap);
        const judge::point p = wide(c.points[i].position), half = given * (real(gap) / 2);
        to.note(law::contact_points, m, std::abs(double(k.a->distance(p - half) - k.a->radius)), of_points);
        to.note(law::contact_points, m, std::abs(double(k.b->distance(k.at.undo(p + half)) - k.b->radius)), of_points);
        for (int j = 0; j < i; ++j) repeated = repeated || c.points[j].feature == c.points[i].feature;
    }
    to.note(law::contact_depth, m, std::abs(deepest - exact), allowed);
    to.note(law::contact_depth, m, farthest - margin, tolerance);
    to.note(law::contact_features, m, repeated || c.count > physics::manifold<S, D>::capacity, 0);
}

/// All laws of one pair; those that cost more than they tell only now and then.
inline void judge_meet(const meet& m, std::uint64_t number, cell::dice& dice, gjk_cache& foreign, tally& to) {
    const closest c = separation_of(m);
    judge_claim(m, c, number % 16 == 0, to);
    const double exact = cell::number(c.distance), tolerance = m.tolerance();
    // Where the search for a way out ended early, nothing else can be held to it.
    if (c.status != physics::query_status::converged) return;
    const double margin = cell::number(cell::real(0.05 * double(std::min(m.a->exact.extent, m.b->exact.extent))));
    judge_contact(m, touch<physics::best_per_pair>(m, margin), margin, exact, to);
    const auto same = [&](law::name l, const meet& q, const closest& other) {
        if (other.status == physics::query_status::converged)
            to.note(l, q, std::abs(cell::number(other.distance) - exact), 2 * tolerance);
    };
    switch (number % 5) {
        case 0: {
            gjk_cache random, own;
            random.count = static_cast<std::uint8_t>(dice.below(8));
            for (std::uint32_t& v : random.vertex) v = static_cast<std::uint32_t>(dice.bits());
            for (float& x : random.axis) x = static_cast<float>(dice.number(-1, 1));
            separation_of(m, &own);
            for (gjk_cache* cache : {&foreign, &random, &own}) {
                const closest warm = separation_of(m, cache);
                same(law::warm, m, warm);
                judge_claim(m, warm, false, to);
            }
            break;
        }
        case 1: {
            const meet q = m.swapped();
            const closest other = separation_of(q);
            same(law::mirrored, m, other);
            judge_claim(q, other, false, to);
            judge_contact(q, touch<physics::best_per_pair>(q, margin), margin, exact, to);
            break;
        }
        case 2:
            with_shapes(m, [&](const auto& a, const auto& b) {
                const double apart = cell::number(distance(a, b, m.b_in_a).distance);
                to.note(law::agreed, m, std::abs(apart - std::fmax(exact, 0)), tolerance);
                if (std::abs(exact) > tolerance) to.note(law::agreed, m, overlap(a, b, m.b_in_a) != (exact < 0), 0);
            });
            break;
        case 3: judge_contact(m, touch<physics::gjk_epa>(m, margin), margin, exact, to); break;
        default: break;
    }
}

inline const char* from_environment(const char* name, const char* otherwise) {
    const char* const set = std::getenv(name);
    return set != nullptr ? set : otherwise;
}

CELL_CASE("certificates: points lie in their hull, but for what its builder takes for flat or for one") {
    cell::dice dice(77);
    for (const double thin : {1.0, 1e-2, 1e-4, 1e-5, 1e-6}) {
        double worst = 0;
        for (int i = 0; i < 200; ++i) {
            reals stretch{1, 1, 1};
            stretch[dice.below(D)] = thin;
            convex_body b;
            if (!random_hull(dice, 10, stretch, b)) continue;
            const judge::body exact(b);
            for (const judge::point& p : b.hull.points)
                worst = std::fmax(worst, double(exact.distance(p)) / b.geometry.data()->tolerance);
        }
        // Its tolerance is 8 spacings.
        CAPTURE(thin);
        CHECK(worst <= (thin < 1e-3 ? 8 : 1));
    }
}

CELL_CASE("certificates: every answer proves itself") {
    const bool told = std::getenv("CERTIFICATE_PAIRS") != nullptr;
    const std::uint64_t pairs = std::strtoull(from_environment("CERTIFICATE_PAIRS", "600"), nullptr, 10);
    const std::uint64_t seed = std::strtoull(from_environment("CERTIFICATE_SEED", "1"), nullptr, 10);
    const std::string wanted = from_environment("CERTIFICATE_KINDS", "");
    std::vector<std::unique_ptr<pool>> pools(convex_set::kinds);
    for (int kind = of::ball; kind < convex_set::kinds; ++kind)
        pools[static_cast<std::size_t>(kind)] = std::make_unique<pool>(kind, kind == of::hull ? told ? 96 : 16 : 16);
    tally total;
    gjk_cache foreign;
    for (int ka = of::ball; ka < convex_set::kinds; ++ka)
        for (int kb = ka; kb < convex_set::kinds; ++kb) {
            if (!wanted.empty() && convex_name(ka) + "," + convex_name(kb) != wanted) continue;
            const auto begin = std::chrono::steady_clock::now();
            cell::dice dice(seed * 10000 + static_cast<std::uint64_t>(ka * 100 + kb));
            tally here;
            for (std::uint64_t i = 0; i < pairs; ++i)
                judge_meet(random_meet(*pools[static_cast<std::size_t>(ka)], *pools[static_cast<std::size_t>(kb)], dice), i,
                           dice, foreign, here);
            for (const tally::entry& e : here.of) CHECK_MESSAGE(e.broken == 0, e.text);
            total.add(here);
            if (!told) continue;
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
            std::printf("%s: %s and %s: %llu pairs in %.1f s\n", cell::name, convex_name(ka).c_str(),
                        convex_name(kb).c_str(), static_cast<unsigned long long>(pairs), took.count());
            here.print();
            std::fflush(stdout);
        }
    if (!told) return;
    std::printf("%s: all\n", cell::name);
    total.print();
}

}  // namespace
