// Sorting by bits, flags in bits, and comparisons of lanes: against plain loops.
#include <doctest/doctest.h>

#include "physics/base/bit_array.hpp"
#include "physics/base/pack_mask.hpp"
#include "physics/base/sort.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace physics::detail;

TEST_CASE("radix_sort: stable, by the bits asked for, in any number") {
    std::mt19937_64 random(1);
    for (const std::uint32_t count : {0u, 1u, 2u, 47u, 48u, 49u, 100u, 4095u, 4096u, 20000u})
        for (const auto& [low, high] : {std::pair{0, 64}, {0, 1}, {32, 64}, {5, 28}, {0, 11}, {40, 63}})
            for (const std::uint64_t mask : {~std::uint64_t{0}, std::uint64_t{0xff00ff}, std::uint64_t{1} << 41}) {
                std::vector<std::uint64_t> keys(count), spare(count);
                for (auto& k : keys) k = random() & mask;
                std::vector<std::uint64_t> expected = keys;
                const std::uint64_t bits =
                    high - low == 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << (high - low)) - 1) << low;
                std::stable_sort(expected.begin(), expected.end(),
                                 [&](std::uint64_t a, std::uint64_t b) { return (a & bits) < (b & bits); });
                const std::uint64_t* sorted = radix_sort(keys.data(), spare.data(), count, low, high);
                REQUIRE(std::equal(expected.begin(), expected.end(), sorted));
            }
}

TEST_CASE("bit_array: each bit stands alone, and those that come later are clear") {
    bit_array bits;
    std::vector<bool> plain;
    std::mt19937 random(2);
    for (std::uint32_t size : {1u, 64u, 65u, 500u}) {
        bits.grow(size);
        plain.resize(size);
        for (int i = 0; i < 300; ++i) {
            const auto at = static_cast<std::uint32_t>(random() % size);
            if (random() % 2) {
                bits.set(at);
                plain[at] = true;
            } else {
                bits.clear(at);
                plain[at] = false;
            }
        }
        for (std::uint32_t i = 0; i < size; ++i) REQUIRE(bits[i] == plain[i]);
    }
}

template <class S, int W>
void compares() {
    const S numbers[] = {S(0),
                         -S(0),
                         S(1),
                         S(-1),
                         std::numeric_limits<S>::infinity(),
                         std::numeric_limits<S>::quiet_NaN(),
                         std::numeric_limits<S>::denorm_min(),
                         std::numeric_limits<S>::max()};
    std::mt19937 random(3);
    for (int run = 0; run < 2000; ++run) {
        S a[W], b[W];
        std::uint32_t expected = 0, either = 0;
        for (int i = 0; i < W; ++i) {
            a[i] = numbers[random() % 8];
            b[i] = numbers[random() % 8];
            expected |= std::uint32_t{a[i] > b[i]} << i;
            either |= std::uint32_t{a[i] > b[i] || b[i] > a[i]} << i;
        }
        const auto x = pack<S, W>::load(a), y = pack<S, W>::load(b);
        REQUIRE(greater(x, y).bits() == expected);
        REQUIRE((greater(x, y) | greater(y, x)).bits() == either);
    }
}

TEST_CASE("pack_mask: a bit for each lane that is greater") {
    compares<float, 2>();
    compares<float, 4>();
    compares<float, 8>();
    compares<float, 16>();
    compares<double, 2>();
    compares<double, 4>();
    compares<double, 8>();
}
