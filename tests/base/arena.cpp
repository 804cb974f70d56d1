// Scratch memory: pieces that do not overlap, aligned, and no allocation once it has seen the largest round.
#include <doctest/doctest.h>

#include <physics/base/arena.hpp>

#include <cstdint>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

namespace {

struct alignas(16) wide {
    std::uint64_t a, b;
};

template <class T>
bool aligned(const T* p) {
    return reinterpret_cast<std::uintptr_t>(p) % 16 == 0 && reinterpret_cast<std::uintptr_t>(p) % alignof(T) == 0;
}

}  // namespace

TEST_CASE("arena: pieces are aligned and keep what is written, in random rounds") {
    std::mt19937_64 engine(2);
    physics::arena arena;
    struct piece {
        unsigned char* begin;
        std::uint32_t size;
    };
    for (int round = 0; round < 50; ++round) {
        std::vector<piece> pieces;
        for (int i = 0; i < 40; ++i) {
            const auto size = static_cast<std::uint32_t>(engine() % (i % 8 == 0 ? 20000 : 200));
            unsigned char* memory = nullptr;
            if (i % 2 == 0) {
                memory = arena.allocate<unsigned char>(size * 16);
                CHECK(aligned(memory));
            } else {
                wide* many = arena.allocate<wide>(size);
                CHECK(aligned(many));
                memory = reinterpret_cast<unsigned char*>(many);
            }
            std::memset(memory, i, size * 16);
            pieces.push_back({memory, size * 16});
        }
        bool kept = true;
        for (std::size_t i = 0; i < pieces.size(); ++i)
            for (std::uint32_t k = 0; k < pieces[i].size; ++k) kept = kept && pieces[i].begin[k] == i;
        CHECK(kept);
        arena.reset();
    }
}

TEST_CASE("arena: after one round, the same round allocates nothing") {
    physics::arena arena;
    const auto round = [&] {
        arena.reset();
        for (std::uint32_t i = 0; i < 100; ++i) arena.allocate<double>(i * 10);
        arena.allocate<int>(0);
    };
    round();
    arena.reset();
    const std::size_t capacity = arena.capacity();
    CHECK(capacity >= 99 * 100 / 2 * 10 * sizeof(double));
    CHECK(capacity <= 8 * 99 * 100 / 2 * 10 * sizeof(double));
    for (int i = 0; i < 10; ++i) {
        round();
        CHECK(arena.capacity() == capacity);
    }
}

TEST_CASE("arena: a copy starts empty, a moved-from arena serves again") {
    physics::arena a;
    int* number = a.allocate<int>(1);
    *number = 5;
    const physics::arena copied = a;
    CHECK(copied.capacity() == 0);
    physics::arena b;
    b.allocate<int>(100000);
    const std::size_t capacity = b.capacity();
    b = copied;
    CHECK(b.capacity() == capacity);

    physics::arena c = std::move(a);
    CHECK(*number == 5);
    CHECK(a.capacity() == 0);
    CHECK(aligned(a.allocate<int>(3)));
    c = std::move(b);
    CHECK(c.capacity() == capacity);
    CHECK(b.capacity() == 0);
    b.reset();
    CHECK(aligned(b.allocate<wide>(3)));
}
