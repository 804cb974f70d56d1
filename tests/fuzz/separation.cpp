// Fuzzes GJK, EPA, MPR and manifolds: each answer has to prove itself.
#include "input.hpp"

namespace {

template <class S, int D>
using shape =
    physics::any_shape<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull>;
template <class S, int D>
using query =
    physics::narrowphase_query<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull>;

/// How far a direction parts the shapes; of a unit vector from A to B never more than the signed distance.
template <int D>
double parted(const physics::detail::core_pair<D>& pair, const physics::detail::point<D>& n) {
    return dot(n, pair.placed.support(-n).at - pair.a.support(n).at) - pair.a.radius - pair.b.radius;
}

template <class S, int D, class A, class B>
void meet(fuzz::input& in, const A& a, const B& b, const physics::transform<S, D>& t) {
    using physics::detail::to_point;
    const physics::detail::core_pair<D> pair(a, b, t);
    const double size = physics::detail::extent_of(pair.a, pair.placed) + pair.a.radius + pair.b.radius;
    const double spacing = static_cast<double>(physics::scalar_traits<S>::epsilon());
    const double tolerance = 256 * (physics::detail::is_fixed<S> ? spacing * (1 + size) : spacing * size);
    physics::gjk_cache cache;
    cache.count = static_cast<std::uint8_t>(in.below(6));
    for (std::uint32_t& v : cache.vertex) v = in.byte() << 16 | in.byte();
    for (float& x : cache.axis) x = static_cast<float>(in.number());
    const auto cold = separation(a, b, t), warm = separation(a, b, t, cache), again = separation(a, b, t, cache);
    for (const auto& c : {cold, warm, again}) {
        const auto n = to_point(c.normal);
        FUZZ_REQUIRE(std::abs(dot(n, n) - 1) < 64 * spacing + 1e-14);
        FUZZ_REQUIRE(c.status == physics::query_status::converged);
        const double d = static_cast<double>(c.distance);
        // The normal parts them as far as it is said to; across a small gap it is only as good as the points.
        FUZZ_REQUIRE(parted(pair, physics::detail::unit(n)) >= d - tolerance);
        FUZZ_REQUIRE(std::abs(static_cast<double>(cold.distance) - d) <= tolerance);
        // The points lie across the gap, and in the shapes.
        const auto across = to_point(c.on_b) - to_point(c.on_a) - n * d;
        FUZZ_REQUIRE(largest(across) <= tolerance);
    }
    // Depths are minimal: no direction parts them by less.
    physics::detail::point<D> n;
    for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < D; ++k) n[k] = in.number();
        if (!(dot(n, n) > 1e-4)) continue;
        FUZZ_REQUIRE(parted(pair, physics::detail::unit(n)) <= static_cast<double>(cold.distance) + tolerance);
    }
    FUZZ_REQUIRE(overlap(a, b, t) == (static_cast<double>(cold.distance) <= 0) ||
                 std::abs(static_cast<double>(cold.distance)) <= tolerance);

    const shape<S, D> any_a(a), any_b(b);
    const query<S, D> q{&any_a, &any_b, t};
    const S margin = static_cast<S>(0.02 * size);
    const auto check = [&](auto policy) {
        physics::manifold_list<S, D> found;
        decltype(policy)::template in<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace,
                                      physics::hull>::collide(&q, 1, margin, found);
        for (const auto& f : found) {
            FUZZ_REQUIRE(f.contact.count > 0 && f.contact.count <= (physics::manifold<S, D>::capacity));
            FUZZ_REQUIRE(physics::is_finite(f.contact.normal));
            for (int i = 0; i < f.contact.count; ++i) {
                FUZZ_REQUIRE(physics::is_finite(f.contact.points[i].position) &&
                             physics::is_finite(f.contact.points[i].separation));
                FUZZ_REQUIRE(!(f.contact.points[i].separation > margin));
            }
        }
        if (static_cast<double>(cold.distance) < static_cast<double>(margin) * 0.5 - tolerance)
            FUZZ_REQUIRE(!found.empty());
    };
    check(physics::best_per_pair{});
    check(physics::gjk_epa{});
    check(physics::gjk_mpr{});
}

template <class S, int D>
void run(fuzz::input& in) {
    const double scale = fuzz::size<S>(in), other = in.below(3) ? scale : fuzz::size<S>(in);
    fuzz::with_shape<S, D>(in, scale, [&](const auto& a) {
        fuzz::with_shape<S, D>(in, other, [&](const auto& b) {
            meet<S, D>(in, a, b, fuzz::pose<S, D>(in, scale > other ? scale : other));
        });
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz::input in(bytes, size);
    switch (in.below(6)) {
        case 0: run<float, 2>(in); break;
        case 1: run<float, 3>(in); break;
        case 2: run<double, 2>(in); break;
        case 3: run<double, 3>(in); break;
        case 4: run<physics::fixed32, 2>(in); break;
        default: run<physics::fixed32, 3>(in); break;
    }
    return 0;
}
