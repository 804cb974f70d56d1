// Packs in memory: as arrays, and as the columns of rows of four scalars.
#include <doctest/doctest.h>

#include "physics/base/pack_rows.hpp"

#include "lanes.hpp"

// All below is engine code in the sense of the determinism region: it has packs inlined into it.
PHYSICS_HPP_REGION_PUSH

namespace {

template <class P>
void check_memory() {
    using S = typename P::scalar;
    constexpr int w = P::width;
    CAPTURE(w);
    static_assert(sizeof(P) == w * sizeof(S), "a pack is an array of its scalars");
    static_assert(std::is_trivially_copyable_v<P>, "blocks of packs are copied byte by byte");
    numbers<S> random;
    tally seen;
    for (int round = 0; round < 200; ++round) {
        S source[w + 2], target[w + 2], want[w + 2], picked[w];
        for (int i = 0; i < w + 2; ++i) source[i] = random.next(), target[i] = want[i] = random.next();
        // Any address will do: one scalar further than the start of the array is aligned for nothing else.
        P p = P::load(source + 1);
        p.store(target + 1);
        for (int i = 0; i < w; ++i) want[i + 1] = source[i + 1], picked[i] = p.lane(i);
        seen.same_all("load and store", target, want, w + 2);
        seen.same_all("lane", picked, source + 1, w);

        alignas(P) S aligned[2 * w], copy[2 * w];
        for (S& x : aligned) x = random.next();
        P::load_aligned(aligned + w).store_aligned(copy);
        P::load_aligned(aligned).store_aligned(copy + w);
        seen.same_all("aligned", copy, aligned + w, w);
        seen.same_all("aligned", copy + w, aligned, w);

        const S x = random.next();
        const int changed = round % w;
        p.set_lane(changed, x);
        std::memcpy(static_cast<void*>(picked), static_cast<const void*>(&p), sizeof p);
        source[changed + 1] = x;
        seen.same_all("set_lane", picked, source + 1, w);
        P::broadcast(x).store(picked);
        for (S& lane : copy) lane = x;
        seen.same_all("broadcast", picked, copy, w);
    }
    INFO(seen.first);
    CHECK(seen.scalars >= 200 * 6 * w);
    CHECK(seen.wrong == 0);
}

template <class P, int Stride>
void check_rows() {
    using S = typename P::scalar;
    using physics::detail::consecutive_rows;
    using physics::detail::indexed_rows;
    using physics::detail::quad;
    constexpr int w = P::width, rows = 40;
    CAPTURE(w);
    numbers<S> random;
    std::mt19937_64 dice{99};
    tally seen;
    for (int round = 0; round < 100; ++round) {
        const int first = round % 3;
        std::vector<S> memory(static_cast<std::size_t>(rows * Stride + first));
        for (S& x : memory) x = random.next();
        // Distinct rows in random order: the first w of a permutation of all.
        std::uint32_t index[rows];
        for (std::uint32_t i = 0; i < rows; ++i) index[i] = i;
        for (std::size_t i = rows - 1; i > 0; --i) std::swap(index[i], index[dice() % (i + 1)]);

        const auto place = [&](std::uint32_t row) { return static_cast<int>(row) * Stride + first; };
        const auto check = [&](const char* what, const quad<P>& got, auto row) {
            S columns[4][w], want[4][w];
            got.x.store(columns[0]);
            got.y.store(columns[1]);
            got.z.store(columns[2]);
            got.w.store(columns[3]);
            for (int i = 0; i < w; ++i)
                for (int column = 0; column < 4; ++column) want[column][i] = memory.data()[place(row(i)) + column];
            for (int column = 0; column < 4; ++column) seen.same_all(what, columns[column], want[column], w);
        };
        const auto gathered = physics::detail::load4<P>(indexed_rows<const S, Stride>{memory.data() + first, index});
        check("load4", gathered, [&](int i) { return index[i]; });
        const consecutive_rows<const S, Stride> third_on{memory.data() + first + 3 * Stride};
        const auto third_row = [](int i) { return 3u + static_cast<std::uint32_t>(i); };
        check("load4, consecutive", physics::detail::load4<P>(third_on), third_row);

        // Scatter to other rows: these change, in lane order, and nothing else does. A fifth of the rows repeat.
        std::uint32_t target[w];
        for (int i = 0; i < w; ++i) target[i] = i % 5 == 4 ? target[i - 1] : index[rows - 1 - i];
        std::vector<S> want = memory;
        for (int i = 0; i < w; ++i)
            for (int column = 0; column < 4; ++column)
                want.data()[place(target[i]) + column] = memory.data()[place(index[i]) + column];
        physics::detail::store4(indexed_rows<S, Stride>{memory.data() + first, target}, gathered);
        seen.same_all("store4", memory.data(), want.data(), static_cast<int>(want.size()));

        // There and back is nothing.
        const consecutive_rows<S, Stride> all{memory.data() + first};
        physics::detail::store4(all, physics::detail::load4<P>(all));
        seen.same_all("there and back", memory.data(), want.data(), static_cast<int>(want.size()));
    }
    INFO(seen.first);
    CHECK(seen.scalars > 10000);
    CHECK(seen.wrong == 0);
}

}  // namespace

TEST_CASE("pack: is an array in memory, at any address") {
    const auto memory = []<class P>() { check_memory<P>(); };
    for_all_widths<float>(memory);
    for_all_widths<double>(memory);
    for_all_widths<physics::fixed32>(memory);
    for_all_widths<physics::fixed16, 4>(memory);
    for_all_widths<plain, 4>(memory);
}

TEST_CASE("pack: rows of four scalars go to lanes and back") {
    const auto rows = []<class P>() {
        check_rows<P, 4>();
        if constexpr (native_width < typename P::scalar >> 1) check_rows<P, 7>();
    };
    for_all_widths<float>(rows);
    for_all_widths<double>(rows);
    for_all_widths<physics::fixed32, 4>(rows);
    for_all_widths<physics::fixed16, 4>(rows);
    for_all_widths<plain, 4>(rows);
}

PHYSICS_HPP_REGION_POP
