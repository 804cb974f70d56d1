// The growable array: against std::vector, and the ways in which such arrays go wrong.
#include <doctest/doctest.h>

#include <physics/base/buffer.hpp>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace {

struct item {
    std::uint64_t value;
    std::uint32_t more;
};

bool same(const physics::buffer<item>& a, const std::vector<item>& b) {
    if (a.size() != b.size() || a.empty() != b.empty() || a.size() > a.capacity()) return false;
    std::size_t i = 0;
    for (const item& x : a) {
        if (x.value != b[i].value || x.more != b[i].more) return false;
        ++i;
    }
    return i == b.size();
}

}  // namespace

TEST_CASE("buffer: does what std::vector does, in long random sequences") {
    std::mt19937_64 engine(1);
    for (int round = 0; round < 20; ++round) {
        physics::buffer<item> a;
        std::vector<item> b;
        for (int i = 0; i < 2000; ++i) {
            const item x{engine(), static_cast<std::uint32_t>(i)};
            const auto below = [&](std::uint64_t n) { return static_cast<std::uint32_t>(engine() % n); };
            switch (below(8)) {
                case 0:
                    if (b.empty()) break;
                    a.pop_back();
                    b.pop_back();
                    break;
                case 1: {
                    const std::uint32_t size = below(64);
                    a.resize(size, x);
                    b.resize(size, x);
                    break;
                }
                case 2:
                    if (below(16) != 0) break;
                    a.clear();
                    b.clear();
                    break;
                case 3: a.reserve(below(256)); break;
                case 4:
                    if (b.empty()) break;
                    a[below(b.size())] = x;
                    a.back() = x;
                    b.assign(a.begin(), a.end());
                    break;
                default: CHECK(a.push_back(x).value == x.value); b.push_back(x);
            }
            REQUIRE(same(a, b));
        }
    }
}

TEST_CASE("buffer: what is added may lie within the buffer that grows for it") {
    physics::buffer<item> a;
    a.push_back({7, 7});
    while (a.size() < a.capacity()) a.push_back({1, 1});
    a.push_back(a[0]);
    CHECK(a.back().value == 7);
    a.resize(a.capacity() + 1, a[0]);
    CHECK(a.back().value == 7);
}

TEST_CASE("buffer: copies are separate, a moved-from buffer is empty and serves again") {
    physics::buffer<item> a;
    for (std::uint32_t i = 0; i < 100; ++i) a.push_back({i, i});
    physics::buffer<item> b = a;
    b[0].value = 5;
    CHECK(a[0].value == 0);
    const physics::buffer<item>& self = a;
    a = self;
    CHECK(a.size() == 100);
    b = physics::buffer<item>();
    CHECK(b.empty());
    b = a;
    CHECK(b.size() == 100);

    physics::buffer<item> c = std::move(a);
    CHECK(c.size() == 100);
    CHECK(a.empty());
    a.push_back({3, 3});
    b = std::move(c);
    CHECK(b.size() == 100);
    CHECK(c.empty());
    c = b;
    CHECK(c[99].value == 99);
    physics::buffer<item>& same_one = c;
    c = std::move(same_one);
    CHECK(c.size() == 100);
    a.swap(c);
    CHECK(a.size() == 100);
    CHECK(c.size() == 1);
}

TEST_CASE("buffer: capacity doubles and is kept") {
    physics::buffer<int> a;
    int grown = 0;
    for (int i = 0; i < 100000; ++i) {
        const std::uint32_t before = a.capacity();
        a.push_back(i);
        grown += a.capacity() != before;
    }
    CHECK(grown <= 14);
    const std::uint32_t capacity = a.capacity();
    const int* place = a.begin();
    for (int round = 0; round < 10; ++round) {
        a.clear();
        CHECK(a.empty());
        for (int i = 0; i < 100000; ++i) a.push_back(i);
    }
    CHECK(a.capacity() == capacity);
    CHECK(a.begin() == place);
}

TEST_CASE("buffer: what no memory can hold is refused, and the buffer is as it was") {
    struct huge {
        char bytes[sizeof(std::size_t) < 8 ? 1u << 28 : std::size_t{1} << 33];
    };
    physics::buffer<huge> a;
    CHECK_THROWS_WITH_AS(a.reserve(0xffffffffu), doctest::Contains("physics: buffer: memory is "), physics::error);
    CHECK(a.capacity() == 0);
    CHECK(a.empty());
}
