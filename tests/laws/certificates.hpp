// Laws of the narrowphase on as many pairs as one likes: each answer comes with its proof, so that none is searched
// for.
//
// What is proven, and how:
//   the cores are apart    Any two points of A and B are at least as far apart as A and B are; along any unit vector, A
//                          and B are at most as far apart as their signed distance says. The answer's points and its
//                          normal give both bounds; where they meet within the tolerance, it is proven.
//   polytopes overlap      The normal parts them by as much as it says, and no face of the difference is nearer: all
//                          directions in which one may point are tried. Proven too; of hulls of many edges one in 16.
//   round cores overlap    (cylinders, cones) Some 80 directions about the normal, along axes and across faces must not
//                          part them sooner: an attempt to refute, no proof. Nor is it one of the hulls left out above.
//   halfspaces             By the formula: how far the other reaches across the plane.
// Manifolds are judged against the signed distance that was proven.
//
// CERTIFICATE_PAIRS in the environment (default 600, and 60 where the scalar is not double) says how many pairs of each
// two kinds; with that, a line for each two kinds is printed. For example a million of each, and what was the worst:
//     CERTIFICATE_PAIRS=1000000 build/clang/tests/shapes_double_3D --test-case='double/3D: certificates: every*'
// CERTIFICATE_KINDS=capsule,hull limits it to two kinds, CERTIFICATE_STATE=swollen to one state, CERTIFICATE_SEED=n
// draws other pairs.
#pragma once

#include <chrono>
#include <cstdlib>
#include <memory>

#include "half_certificates.hpp"

namespace {
namespace certificates_laws {

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
        to.note(law::apart_proven, m, double(most) - std::fmax(cores, 0), m.short_of());
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
/// Judges a manifold by the signed distance. To keep the features of bodies at rest, contacts may deviate by 1/128 of
/// the thinner one's half width; a round side that lies within five degrees of flat is taken for flat.
inline void judge_contact(const meet& m, const physics::manifold<S, D>& c, double margin, double exact, tally& to) {
    const judge::couple k = m.couple();
    const double thin = double(std::min(k.a->thin, k.b->thin)), tolerance = m.tolerance();
    const double allowed = tolerance + thin / 128;
    const double lies =
        double(k.a->radius + k.b->radius) / 255 + (m.is_round() ? double(k.a->thin + k.b->thin) / 128 : 0);
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
    // Of cores that are apart one of both answers may fall short of the distance.
    const bool apart = exact + double(m.couple().radii()) >= -tolerance;
    const double differ = tolerance + (apart ? m.short_of() : tolerance);
    const auto same = [&](law::name l, const meet& q, const closest& other) {
        if (other.status == physics::query_status::converged)
            to.note(l, q, std::abs(cell::number(other.distance) - exact), differ);
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
                const double open = cell::number(distance(a, b, m.b_in_a).distance);
                to.note(law::agreed, m, std::abs(open - std::fmax(exact, 0)), tolerance);
                // Those that touch are taken for one: see overlap().
                const double clearly = std::fmax(tolerance, (m.is_round() ? 5e-10 : 5e-13) * m.reach());
                if (exact > clearly || exact < -tolerance)
                    to.note(law::agreed, m, overlap(a, b, m.b_in_a) != (exact < 0), 0);
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
            if (!random_hull(dice, 10, stretch, {}, b)) continue;
            const judge::body exact(b);
            for (const judge::point& p : b.hull.points)
                worst = std::fmax(worst, double(exact.distance(p)) / b.geometry.data()->tolerance);
        }
        // Its tolerance is 8 spacings.
        CAPTURE(thin);
        CHECK(worst <= (thin < 1e-3 ? 8 : 1));
    }
}

/// Judges a pair by all laws, and its signed distance by what is known. `axis`: what a cache holds at first.
inline void prove(state in, const convex_body& a, const convex_body& b, const transform& b_in_a, double gap,
                  reals axis = {}) {
    const specimen first(a), second(b);
    const meet m{&first, &second, b_in_a, in};
    cell::dice dice(78);
    tally here;
    gjk_cache foreign;
    foreign.count = size(axis) > 0;
    for (int i = 0; i < D; ++i) foreign.axis[i] = static_cast<float>(axis[i]);
    for (std::uint64_t i = 0; i < 3000; ++i) judge_meet(m, i, dice, foreign, here);
    for (const tally::entry& e : here.of) CHECK_MESSAGE(e.broken == 0, e.text);
    const double found = cell::number(separation_of(m).distance);
    CHECK_MESSAGE(std::abs(found - gap) <= m.tolerance(), "distance " << found - gap << " more than " << gap);
}
inline convex_body stick(reals a, reals b) { return body_of(segment{from_reals(a), from_reals(b), S(0)}); }

#if CELL_DIMENSION == 2
CELL_CASE("certificates: pairs whose contacts were once too inexact") {
    // Of Q32.32 what counted as rounding was more than it is: half a micrometre.
    const auto turn = [](double c, double s) { return normalized(rotation_of(std::vector<S>{S(c), S(s)})); };
    prove(state::unequal, stick({7.7076135494280607, 7.9318315498530865}, {-31.368446884676814, 10.511730087921023}),
          body_of(triangle{from_reals({-0.0042542889714241028, 0.033303825650364161}),
                           from_reals({-0.0046761932317167521, -0.033175028860569}),
                           from_reals({0.014907400356605649, -0.02540197572670877}), S(0)}),
          {from_reals({7.7365026036277413, 7.9375549491960555}), turn(-0.32881427323445678, -0.94439460709691048)},
          -2.3072256945e-6);
    // Beside an edge of 0.1 mm rounding turned the normal out of what a corner of the difference allows.
    prove(state::thin, body_of(box{from_reals({5e-05, 3.1961942339589711})}),
          body_of(box{from_reals({0.44869715725240772, 0.15722307159435578})}),
          {from_reals({0.15727261849665963, -3.6448915499936581}), turn(-1.0099186247406398e-06, -0.99999999999949007)},
          5.000001e-11);
    // Of two segments on one line the difference is so thin that its short edges' normals are 2e-12 off: 0.6 nm.
    prove(state::ratio,
          stick({0.00089597287133880512, 9.7026467318278722e-05}, {-0.00042503734251538521, 0.00012997892304203229}),
          stick({-564.45523125935256, 395.97692575577094}, {309.62208448189256, -237.67320721606785}),
          {from_reals({-149.83789959198688, -6.9664697212193847}), turn(-0.82401972077067753, -0.56656111742777993)},
          0);
}
#else
CELL_CASE("certificates: pairs whose answers were once too inexact") {
    const auto expect = [](state in, const convex_body& a, const convex_body& b, reals position, reals about, double w,
                           double gap, reals axis = {}) {
        const std::vector<S> turn{S(about.x), S(about.y), S(about.z), S(w)};
        prove(in, a, b, {from_reals(position), normalized(rotation_of(turn))}, gap, axis);
    };
    const auto drum = [](double half, double radius, double rounding = 0) {
        return body_of(cylinder<>{S(half), S(radius), S(rounding)});
    };
    const auto stump = [](double half, double low, double high) {
        return body_of(cone<>{S(half), S(low), S(high), S(0)});
    };
    const auto plate = [](reals a, reals b, reals c, double radius = 0) {
        return body_of(triangle{from_reals(a), from_reals(b), from_reals(c), S(radius)});
    };
    // Points 2e-9 m off, as the search between two corners of a rim went by a normal of its longer edges.
    expect(state::far,
           stick({-0.37916505975198739, 0.36013107092124441, 0.21436966070429975},
                 {0.28378127625497551, -0.08422881824773909, -0.14523297857765721}),
           drum(0.1662121478613216, 0.29556167044683024),
           {0.20601664298710073, 0.3695313701166949, -0.064231633326053139},
           {-0.66870116542887259, -0.39918519077225834, 0.62579326707360616}, -0.043274954737422128, 0);
    // The same of a small drum on a large triangle: 1.12 um apart, and overlap() said they meet.
    expect(state::unequal,
           plate({19.378682539058438, 23.0920973472243, -8.2852996249559414},
                 {-25.049831439059567, -21.682857588641582, -4.998462189593984},
                 {-14.489518405339984, 24.363410979721944, -6.0943921327540034}),
           drum(0.0080515120601994984, 0.0077864271150477329),
           {4.0205060786873759, 7.6058944875082908, -7.1392463770912551},
           {-0.29281580791819589, -0.53428386413826179, 0.43762149264381051}, -0.66127685906200051, 1.12007e-6);
    // A wire whose end touches: the search stalled while its normal was still turning. Points 5e-8 m off.
    expect(state::thin, drum(1.8919002268695126, 5e-5),
           stick({-0.85062657289909793, 1.4015401522113171, 1.0236434189808981},
                 {1.6585976917914678, 1.3001818020247793, 1.7244048848175098e-05}),
           {1.7492132319752705, 1.8812536234853721, -0.41982856624391784},
           {0.17752894040828318, 0.22825994857392873, -0.948873836285412}, -0.12656742869926921, 0);
    // Beside the tip of a cone the normal of an edge may turn where the distance no longer tells.
    expect(state::unequal,
           stick({-0.14127900735312687, 0.15050157104695322, 0.06123360924832897},
                 {0.049848200672171758, -0.088565480983080952, 0.000350099270919009}),
           stump(34.439939082304591, 49.543159199086759, 0),
           {-19.012482544419843, 16.501722654430562, -23.65845132371593},
           {-0.69548953459371821, 0.45302794602506069, -0.14419780449777939}, -0.53876430892269411, 1.771945e-7);
    // From some caches a tetrahedron without volume led back to the triangle that it grew from.
    expect(state::unequal,
           stick({-0.0027917843185889337, 0.0019192828288756114, 0.0033362028717233158},
                 {0.0020239092688412166, -0.0029679044701016954, 0.0013619997993756542}),
           stump(14.470595759798849, 48.529775480283007, 72.794663220424511),
           {-69.410205928719435, 11.150135941248738, 23.810671474772938},
           {0.065024858099308178, 0.40741286104190777, 0.39195669734824795}, -0.82228734387114688, 2.68235e-7);
    // A side that touches a rim from within where both have one tangent: from that axis on a normal 2e-8 off.
    const convex_body round_drum = drum(0.31919751163626109, 0.49651993496440539, 0.12045006258680176);
    expect(state::aligned, round_drum, round_drum, {0, -0.99303986992881077, 0.49651993496440539}, {0.5, 0.5, 0.5}, 0.5,
           -0.063577701845459217, {0.402075171, -0.632772565, 0.972604692});
    // Beyond the sharp tip of a triangle that leans: 11 slacks, as its cut leant too and missed what lay deep below.
    expect(state::huge, body_of(box{from_reals({248.78004441102348, 429.49516697760168, 352.22850859770551})}),
           plate({-147.45239470524234, 276.72946971062959, -138.97734959664515},
                 {-13.089959134526698, -358.90450126072517, -45.650262107336857},
                 {-118.7014942778376, 181.48202359776644, -216.10684900510719}),
           {-459.97751428513038, 160.29698471515843, 157.21378816430365},
           {0.91682191000087165, -0.38861229908236611, 0.076505346881193967}, -0.050645811701059251,
           -23.775210387155795);
    // A round triangle with an obtuse corner leans by 30 degrees, the edge there by 5: points 0.05 m below its surface.
    expect(state::shallow, body_of(box{from_reals({20, 20, 1})}), plate({}, {1, 0, 0}, {-10, 1, 0}, 0.45), {0, 0, 1.52},
           {-0.9530081464594773, 0.15297159827894913, 0}, 0.26148644879200766, -0.01);
    // From that axis on rounding chose a wrong side of a flat tetrahedron: 87 um apart after 128 steps.
    expect(state::unequal,
           body_of(box{from_reals({0.0047522573731839657, 0.0096825254149734974, 0.003491041949018836})}),
           stump(31.533223623409867, 19.916750115575269, 29.875125173479319),
           {-25.477060851640999, -33.524679676862434, -10.7097604253795},
           {-0.27928426419384778, -0.63905682740733027, 0.16580439242534339}, 0.69721988984383643, 9.44e-10,
           {0.0697041899, -0.448912144, 0.35552001});
    // Of fixed point the normal across two edges was no unit vector where these are nearly parallel.
    expect(state::thin, body_of(box{from_reals({4.9999915063381195e-05, 4.1857783894520253, 3.2665331531316042})}),
           body_of(box{from_reals({2.5812747257295996, 4.2745270528830588, 4.9999915063381195e-05})}),
           {3.1618101967032999, 6.8014126480557024, -0.42113500740379095},
           {-0.66214588447473943, 0.65767040010541677, -0.25611214176751673}, 0.25187108456157148, 3.6736e-10);
    // Of hulls of floats supports are off by more than what parted the two where they touch: points off by 6 mm.
    const auto block = [](const std::vector<reals>& corners) {
        std::vector<vec> points;
        convex_body b;
        for (const reals& p : corners) points.push_back(from_reals(p));
        b.geometry = hull_geometry::build(points.data(), static_cast<std::uint32_t>(points.size()));
        b.kind = of::hull;
        b.shape = b.geometry.shape(S(0));
        for (const vec& p : points) b.hull.points.push_back(wide(p));
        return b;
    };
    const double x = 0.1639978289604187, y = 0.2781347930431366, z = 0.20315521955490112;
    expect(state::tilted, body_of(box{from_reals({0.25496882200241089, 0.269563227891922, 0.48359322547912598})}),
           block({{0, y, z},
                  {-x, y, -z},
                  {x, -y, 0},
                  {-x, y, 0},
                  {0, 0, -z},
                  {x, 0, -z},
                  {0, -y, z},
                  {-x, 0, 0},
                  {x, 0, 0},
                  {0, -y, 0},
                  {0, y, 0},
                  {0, 0, z}}),
           {0.18697597086429596, 0.0088763069361448288, 0.68674749135971069},
           {2.6575138534212783e-08, 6.1820696828362998e-07, 0}, 1, -1.0377417801646814e-06);
    // A small ball above a large box: the normal of an edge of the difference was 3e-10 off, as that is so long.
    expect(state::ratio, body_of(ball{S(0.00015604249008947276)}),
           body_of(box{from_reals({480.35099823348685, 156.41593260497729, 293.56178794370589})}),
           {155.32842900182348, -14.965720185039473, 10.728427232923877},
           {-0.67067668348292175, 0.74015787507021635, -0.048511167954018698}, -0.0024026626121283704, -1.5609e-10);
    // Of two triangles of 300 m and 0.3 mm 0.3 nm apart, but for their radii, the normal was 1e-5 off: 4 mm.
    expect(state::ratio,
           plate({-46.359371250405353, -21.050044364832289, -239.07734174324676},
                 {91.194708721284229, -69.303681215303342, -147.76523900365066},
                 {-99.895472452916565, 99.294264603092174, -14.521274275819311}, 15.932254954851132),
           plate({-8.1427998087188261e-05, -0.0001980481500866885, -0.00019793251718607348},
                 {-0.00061199819241854344, -7.0706207883563184e-05, -4.2163574980497001e-05},
                 {-0.00024026332782882293, 7.0646993910696422e-05, -0.00025262448950874307}, 0.00027279080898260749),
           {-73.12763809566097, 39.122065045551977, -126.79912944220392},
           {-0.20023316747045761, 0.3168552830716031, 0.87859543421480135}, -0.29593828953223789, -15.93252774538733);
    // A segment that leans by 1e-7 along an edge: a face of the difference so thin that its normal was 1e-10 off.
    expect(state::leaning,
           stick({-0.20797412724190295, -0.15334284677375598, 0.052280315676066336},
                 {0.022450929890817151, -0.067138047495767877, -0.13576275997869255}),
           body_of(box{from_reals({0.25231993532002062, 0.35526233355404863, 0.32134871603077403})}),
           {-0.035544360013563869, -0.52203141060144864, -0.032925179241549751},
           {0.58928064689144133, -0.59967456309874778, -0.54031685422923781}, -0.034589515858868186, 0);
    // An edge of a thin plate through a ball's middle: points 0.7 m off, as no normal parts the two.
    expect(state::exact, body_of(ball{S(4.9999915063381195e-05)}),
           body_of(rounded_box{from_reals({2.272492996416986, 4.9999915063381195e-05, 4.6434194897301495}),
                               S(0.71526640770025547)}),
           {-3.5689727482385933, 2.2862975625321269, 2.9598726246040314},
           {-0.060633333399891853, 0.46371519821695983, 0.84011826268397272}, -0.27476011053659022,
           -0.71531640762340072);
    // Of fixed point the offset of a capsule of 0.05 mm has four digits: its normal was 5e-6 off, along 2 m of it.
    expect(state::thin, body_of(box{from_reals({0.1572230716701597, 0.17013990064151585, 0.36400486761704087})}),
           body_of(physics::capsule<S, D>{S(2.6318779704160988), S(4.9999915063381195e-05)}),
           {0.15724751795642078, 0.17018351680599153, 0.36400486761704087},
           {0.65006153169088066, 0.27823990886099637, -0.65006521623581648}, 0.27824049489572644, -3.3389522129e-06);
}
#endif

CELL_CASE("certificates: every answer proves itself") {
    const bool told = std::getenv("CERTIFICATE_PAIRS") != nullptr;
    const std::uint64_t pairs =
        std::strtoull(from_environment("CERTIFICATE_PAIRS", cell::draws(600) == 600 ? "600" : "60"), nullptr, 10);
    const std::uint64_t seed = std::strtoull(from_environment("CERTIFICATE_SEED", "1"), nullptr, 10);
    const std::string wanted = from_environment("CERTIFICATE_KINDS", "");
    const std::string state_wanted = from_environment("CERTIFICATE_STATE", "");
    state only{};
    const bool any_state = state_wanted.empty();
    for (int in = 0; in < states; ++in)
        if (name_of(state(in)) == state_wanted) only = state(in);
    std::vector<std::unique_ptr<pool>> pools(convex_set::kinds);
    for (int kind = of::ball; kind < convex_set::kinds; ++kind)
        pools[static_cast<std::size_t>(kind)] = std::make_unique<pool>(kind, kind == of::hull ? told ? 96 : 16 : 16);
    tally total;
    gjk_cache foreign;
    for (int ka = 0; ka < convex_set::kinds; ++ka)
        for (int kb = ka > of::ball ? ka : of::ball; kb < convex_set::kinds; ++kb) {
            if (!wanted.empty() && convex_name(ka) + "," + convex_name(kb) != wanted) continue;
            const auto begin = std::chrono::steady_clock::now();
            cell::dice dice(seed * 10000 + static_cast<std::uint64_t>(ka * 100 + kb));
            tally here;
            for (std::uint64_t i = 0; i < pairs; ++i) {
                const state in = any_state ? state(dice.below(states)) : only;
                const pool& of_b = *pools[static_cast<std::size_t>(kb)];
                if (ka == 0) judge_ground(of_b, in, dice, here);
                else judge_meet(random_meet(*pools[std::size_t(ka)], of_b, in, dice), i, dice, foreign, here);
            }
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

}  // namespace certificates_laws
}  // namespace
