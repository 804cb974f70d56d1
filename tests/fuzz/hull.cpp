// Fuzzes the hull builder: any points give a hull that holds them all, or a refusal.
#include "input.hpp"

namespace {

template <class S, int D>
void build(fuzz::input& in) {
    const double scale = fuzz::size<S>(in);
    const auto points = fuzz::points<S, D>(in, 40, scale);
    physics::hull_geometry<S, D> hull;
    try {
        hull = physics::hull_geometry<S, D>::build(points.data(), static_cast<std::uint32_t>(points.size()));
    } catch (const physics::error&) {
        return;
    }
    FUZZ_REQUIRE(hull.vertex_count() > D && hull.face_count() > D);
    FUZZ_REQUIRE(hull.volume() > 0);
    const auto& data = *hull.data();
    for (std::uint32_t f = 0; f < data.face_count; ++f) {
        const auto n = data.normal(f);
        FUZZ_REQUIRE(std::abs(dot(n, n) - 1) < 1e-12);
        for (const auto& p : points) {
            const auto q = physics::detail::to_point(p);
            // The builder's own account of what is flat: some of its tolerances where the input is all of that size.
            FUZZ_REQUIRE(dot(n, q) <= data.offset(f) + 8 * data.tolerance);
        }
    }
    if (D == 3) FUZZ_REQUIRE(data.vertex_count + data.face_count == data.edge_count + 2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz::input in(bytes, size);
    switch (in.below(6)) {
        case 0: build<float, 2>(in); break;
        case 1: build<float, 3>(in); break;
        case 2: build<double, 2>(in); break;
        case 3: build<double, 3>(in); break;
        case 4: build<physics::fixed32, 2>(in); break;
        default: build<physics::fixed32, 3>(in); break;
    }
    return 0;
}
