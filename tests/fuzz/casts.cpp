// Fuzzes rays, shape casts and times of impact: what is hit is touched, and nothing is touched before.
#include "input.hpp"

namespace {

template <class S>
double as_double(S x) {
    return static_cast<double>(x);
}
template <class S, int D>
void check_normal(const physics::vec<S, D>& normal, bool may_be_null, double spacing) {
    const auto n = physics::detail::to_point(normal);
    FUZZ_REQUIRE(std::abs(dot(n, n) - 1) < 64 * spacing + 1e-14 || (may_be_null && dot(n, n) == 0));
}

template <class S, int D, class A, class B>
void meet(fuzz::input& in, const A& a, const B& b, double scale) {
    const auto start = fuzz::pose<S, D>(in, scale), end = fuzz::pose<S, D>(in, scale);
    const auto way = fuzz::vector<S, D>(in, 4 * scale);
    const double spacing = as_double(physics::scalar_traits<S>::epsilon());
    const auto gap_at = [&](const physics::transform<S, D>& pose) {
        return as_double(separation(a, b, pose).distance);
    };
    double size = 8 * scale;
    for (const auto& c : {core_of(a), core_of(b)}) size += c.extent + c.radius;
    const double tolerance = 256 * (physics::detail::is_fixed<S> ? spacing * (1 + size) : spacing * size);

    const auto ray = cast_ray(a, start, end.position, way);
    FUZZ_REQUIRE(as_double(ray.fraction) >= 0 && as_double(ray.fraction) <= 1);
    if (ray) check_normal(ray.normal, true, spacing);
    const physics::ball<S, D> tip{static_cast<S>(spacing * scale)};
    if (ray) {
        // Along a ray that grazes the surface rounding moves the point where it enters.
        const auto n = physics::detail::to_point(ray.normal), w = physics::detail::unit(physics::detail::to_point(way));
        const double steep = dot(n, n) > 0 ? std::abs(dot(n, w)) : 1;
        FUZZ_REQUIRE(as_double(separation(a, tip, relative(start, {ray.point, {}})).distance) * steep <= tolerance);
    }

    const auto cast = cast_shape(a, b, start, way);
    FUZZ_REQUIRE(as_double(cast.fraction) >= 0 && as_double(cast.fraction) <= 1);
    if (cast) check_normal(cast.normal, false, spacing);
    const auto along = [&](double fraction) {
        physics::transform<S, D> pose = start;
        pose.position += way * static_cast<S>(fraction);
        return gap_at(pose);
    };
    if (cast) FUZZ_REQUIRE(along(as_double(cast.fraction)) <= tolerance);
    const double until = cast ? as_double(cast.fraction) : 1;
    // Where they begin in touch, what parts or slides does not count.
    if (along(0) > tolerance)
        for (int i = 1; i < 8; ++i) FUZZ_REQUIRE(along(until * i / 8) >= -tolerance);

    physics::impact_settings<S> settings;
    settings.target = static_cast<S>(0.001 * scale);
    settings.tolerance = static_cast<S>(0.0005 * scale);
    if (!(as_double(settings.tolerance) > 64 * tolerance)) return;
    const auto rest = physics::sweep_between(physics::transform<S, D>{}, physics::transform<S, D>{});
    const auto motion = physics::sweep_between(start, end);
    const auto impact = time_of_impact(a, rest, b, motion, settings);
    FUZZ_REQUIRE(as_double(impact.fraction) >= 0 && as_double(impact.fraction) <= 1);
    if (impact.state == physics::impact_state::overlapping) return;
    // Safe up to there, whether it has hit, parted or given up.
    for (int i = 0; i <= 8; ++i)
        FUZZ_REQUIRE(gap_at(motion.at(static_cast<S>(as_double(impact.fraction) * i / 8))) >= -tolerance);
}

template <class S, int D>
void run(fuzz::input& in) {
    const double scale = fuzz::size<S>(in);
    fuzz::with_shape<S, D>(in, scale, [&](const auto& a) {
        fuzz::with_shape<S, D>(in, scale, [&](const auto& b) { meet<S, D>(in, a, b, scale); });
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
