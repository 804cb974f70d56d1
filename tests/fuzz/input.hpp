// Shapes and poses from a fuzzer's bytes, biased towards what breaks geometry: repeats, lattices, hair's breadths.
#pragma once

#include "../refused_memory.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace fuzz {

/// Stops the fuzzer with what it found.
#define FUZZ_REQUIRE(condition)                                                  \
    do {                                                                         \
        if (!(condition)) {                                                      \
            std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                        \
        }                                                                        \
    } while (false)

/// Numbers out of bytes; zeros once they are used up.
class input {
public:
    input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
    bool empty() const { return at_ >= size_; }
    unsigned byte() { return empty() ? 0u : data_[at_++]; }
    int below(int n) { return static_cast<int>(byte()) % n; }
    /// Of magnitude 1 or less: mostly multiples of 1/8, sometimes a hair beside one, sometimes any.
    double number() {
        const unsigned kind = byte();
        const double coarse = (static_cast<int>(byte()) - 128) / 128.0;
        const double rounded = std::floor(coarse * 8 + 0.5) / 8;
        if (kind < 128) return rounded;
        if (kind < 192) return rounded + std::ldexp(coarse, -(10 + static_cast<int>(kind % 40)));
        return coarse + (static_cast<int>(byte()) - 128) / 32768.0;
    }

private:
    const std::uint8_t* data_;
    std::size_t size_;
    std::size_t at_ = 0;
};

template <class S, int D>
physics::vec<S, D> vector(input& in, double scale) {
    physics::vec<S, D> v;
    for (int i = 0; i < D; ++i) v[i] = static_cast<S>(in.number() * scale);
    return v;
}
template <class S>
physics::rotation<S, 2> turn(input& in, const physics::vec<S, 2>*) {
    const double angle = in.number() * 4;
    return physics::rotation<S, 2>::from_angle(static_cast<S>(in.below(2) ? angle * 0.78539816339744831 : angle));
}
template <class S>
physics::rotation<S, 3> turn(input& in, const physics::vec<S, 3>*) {
    const double x = in.number(), y = in.number(), z = in.number(), w = in.number(),
                 size = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(size > 0.01)) return {};
    return {static_cast<S>(x / size), static_cast<S>(y / size), static_cast<S>(z / size), static_cast<S>(w / size)};
}
template <class S, int D>
physics::transform<S, D> pose(input& in, double scale) {
    physics::transform<S, D> t;
    t.rotation = turn<S>(in, static_cast<const physics::vec<S, D>*>(nullptr));
    t.position = vector<S, D>(in, 2 * scale);
    return t;
}
template <class S, int D>
std::vector<physics::vec<S, D>> points(input& in, int most, double scale) {
    std::vector<physics::vec<S, D>> p;
    for (int i = D + 1 + in.below(most); i > 0; --i) p.push_back(vector<S, D>(in, scale));
    return p;
}
/// Of a power of ten from 1e-3 to 1e3; fixed point keeps to what it resolves.
template <class S>
double size(input& in) {
    const int power = in.below(7) - 3;
    return std::pow(10, physics::detail::is_fixed<S> ? power / 2 : power);
}

/// Calls f with a ball, a capsule, a box or a hull; not at all where the points have no volume.
template <class S, int D, class F>
void with_shape(input& in, double scale, F&& f) {
    const auto positive = [&] { return static_cast<S>((std::abs(in.number()) + 0.01) * scale); };
    switch (in.below(4)) {
        case 0: f(physics::ball<S, D>{positive()}); break;
        case 1: {
            const S half = positive();
            f(physics::capsule<S, D>{half, positive()});
            break;
        }
        case 2: {
            physics::box<S, D> box;
            for (int i = 0; i < D; ++i) box.half_extents[i] = positive();
            f(box);
            break;
        }
        default: {
            const auto cloud = points<S, D>(in, 16, scale);
            const S radius = in.below(2) ? positive() : S(0);
            physics::hull_geometry<S, D> hull;
            try {
                hull = physics::hull_geometry<S, D>::build(cloud.data(), static_cast<std::uint32_t>(cloud.size()));
            } catch (const physics::error&) {
                return;
            }
            f(hull.shape(radius));
        }
    }
}

}  // namespace fuzz
