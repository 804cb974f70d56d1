// Packs against their twin: the same operation on each scalar, for every scalar, width and register size.
#include <doctest/doctest.h>

#include "physics/base/pack.hpp"
#include "physics/base/pack_rows.hpp"

#include "lanes.hpp"

// All below is engine code in the sense of the determinism region: it has packs inlined into it.
PHYSICS_HPP_REGION_PUSH

namespace {

constexpr const char* operations[] = {
    "+", "-", "*", "/", "+=", "-=", "*=", "/=", "min", "max", "sqrt", "sel", "neg", "mul", "narrow"};
constexpr int operation_count = sizeof operations / sizeof *operations;

/// A row of results for each operation.
template <class S>
using results = S[operation_count][most_lanes];

template <class S>
void by_scalars(int width, const S* a, const S* b, const S* x, const S* y, results<S>& out) {
    for (int i = 0; i < width; ++i) {
        out[0][i] = out[4][i] = a[i] + b[i];
        out[1][i] = out[5][i] = a[i] - b[i];
        out[2][i] = out[6][i] = a[i] * b[i];
        out[3][i] = out[7][i] = a[i] / b[i];
        out[8][i] = physics::min(a[i], b[i]);
        out[9][i] = physics::max(a[i], b[i]);
        out[10][i] = physics::sqrt(a[i]);
        out[11][i] = a[i] > b[i] ? x[i] : y[i];
        out[12][i] = -a[i];
        out[13][i] = physics::mul<S>(a[i], b[i]);
        out[14][i] = physics::narrow<S>(physics::product(a[i], b[i]) + physics::product(x[i], y[i]));
    }
}

template <class P, class S = typename P::scalar>
void by_packs(const S* a, const S* b, const S* x, const S* y, results<S>& out) {
    const P pa = P::load(a), pb = P::load(b), px = P::load(x), py = P::load(y);
    P plus = pa, minus = pa, times = pa, over = pa;
    plus += pb;
    minus -= pb;
    times *= pb;
    over /= pb;
    const P all[] = {pa + pb,     pa - pb,        pa * pb,
                     pa / pb,     plus,           minus,
                     times,       over,           min(pa, pb),
                     max(pa, pb), sqrt(pa),       select_greater(pa, pb, px, py),
                     -pa,         mul<S>(pa, pb), narrow<S>(product(pa, pb) + product(px, py))};
    for (int i = 0; i < operation_count; ++i) all[i].store(out[i]);
}

template <class P>
void check_operations() {
    using S = typename P::scalar;
    constexpr int w = P::width;
    CAPTURE(w);
    tally seen;
    S a[w], b[w], x[w], y[w];
    results<S> got, want;
    const auto compare = [&] {
        by_packs<P>(a, b, x, y, got);
        by_scalars(w, a, b, x, y, want);
        for (int i = 0; i < operation_count; ++i) seen.same_all(operations[i], got[i], want[i], w);
    };
    numbers<S> random;
    const std::vector<S> adversaries = numbers<S>::adversaries();
    const std::size_t n = adversaries.size();
    // Every ordered pair of adversaries, in every lane and with every neighbour sooner or later.
    for (std::size_t start = 0; start < n * n; ++start) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(w); ++i) {
            a[i] = adversaries[(start + i) / n % n];
            b[i] = adversaries[(start + i) % n];
            x[i] = adversaries[(start + 3 * i) % n];
            y[i] = random.next();
        }
        compare();
    }
    for (int round = 0; round < 3000; ++round) {
        for (S* operand : {a, b, x, y})
            for (int i = 0; i < w; ++i) operand[i] = random.next();
        compare();
    }
    INFO(seen.first);
    CHECK(seen.scalars >= operation_count * w * 3000);
    CHECK(seen.wrong == 0);
}

/// Arithmetic as solvers have it, with products that a compiler would like to fuse into sums.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE void iterate(const typename P::scalar* from, typename P::scalar* to) {
    using S = typename P::scalar;
    const P one = P::broadcast(S(1)), zero = P::broadcast(S(0)), third = P::broadcast(S(1) / S(3));
    P x = P::load(from), v = one - x * x, sum = zero;
    for (int i = 0; i < 20; ++i) {
        const P bias = max(-one, third * x - v * v);
        const P impulse = max(sum - (v * x + bias) * third, zero);
        v = v + (impulse - sum) * third;
        sum = impulse;
        x = select_greater(x * x + v * v, one, x / sqrt(x * x + v * v + one), x + v * third);
        v = min(v - x * third, one);
    }
    (x * third + v * sum).store(to);
}

template <class P>
std::vector<typename P::scalar> iterated(const std::vector<typename P::scalar>& input) {
    std::vector<typename P::scalar> output(input.size());
    for (std::size_t i = 0; i < input.size(); i += P::width) iterate<P>(input.data() + i, output.data() + i);
    return output;
}

template <class S>
std::vector<S> starts() {
    numbers<S> random;
    std::vector<S> result;
    while (result.size() < 512) {
        const S x = random.next();
        if (static_cast<double>(x) > -4 && static_cast<double>(x) < 4) result.push_back(x);
    }
    return result;
}

template <class S>
int differences(const std::vector<S>& a, const std::vector<S>& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += !same(a[i], b[i]);
    return count;
}

template <class S>
void check_widths_agree() {
    const std::vector<S> input = starts<S>(), want = iterated<pack<S, 1>>(input);
    CHECK(differences(input, want) > 400);
    for_all_widths<S, (native_width<S> > 1 ? most_lanes : 4)>([&]<class P>() {
        CAPTURE(P::width);
        CHECK(differences(iterated<P>(input), want) == 0);
    });
}

#if PHYSICS_HPP_VECTOR_BYTES > 0 && (defined(__x86_64__) || defined(__i386__))
// How kernels use wider registers than the unit was compiled for: such a function takes pointers, and its packs name
// their registers' size.
#define WIDE_REGISTERS __attribute__((noinline, target("avx2")))
template <class P>
WIDE_REGISTERS void iterate_wide(const typename P::scalar* from, typename P::scalar* to, std::size_t n) {
    for (std::size_t i = 0; i < n; i += P::width) iterate<P>(from + i, to + i);
}

template <class P, class S = typename P::scalar>
WIDE_REGISTERS void transpose_wide(const S* rows, S* columns, S* rows_again) {
    using physics::detail::consecutive_rows;
    const auto got = physics::detail::load4<P>(consecutive_rows<const S, 4>{rows});
    got.x.store(columns);
    got.y.store(columns + P::width);
    got.z.store(columns + 2 * P::width);
    got.w.store(columns + 3 * P::width);
    physics::detail::store4(consecutive_rows<S, 4>{rows_again}, got);
}

template <class S>
void check_wide_registers() {
    using P = pack<S, 32 / sizeof(S), 32>;
    const std::vector<S> input = starts<S>(), want = iterated<pack<S, 1>>(input);
    std::vector<S> got(input.size());
    iterate_wide<P>(input.data(), got.data(), got.size());
    CHECK(differences(got, want) == 0);

    const std::vector<S> rows(input.begin(), input.begin() + 4 * P::width);
    std::vector<S> columns(rows.size()), rows_again(rows.size());
    transpose_wide<P>(rows.data(), columns.data(), rows_again.data());
    CHECK(differences(rows, rows_again) == 0);
    for (std::size_t i = 0; i < columns.size(); ++i) {
        CAPTURE(i);
        CHECK(same(columns[i], rows[i % P::width * 4 + i / P::width]));
    }
}
#endif

}  // namespace

TEST_CASE("pack: every operation is the scalar one") {
    const auto check = []<class P>() { check_operations<P>(); };
    SUBCASE("float") { for_all_widths<float>(check); }
    SUBCASE("double") { for_all_widths<double>(check); }
    SUBCASE("fixed32") { for_all_widths<physics::fixed32>(check); }
    SUBCASE("fixed16") { for_all_widths<physics::fixed16>(check); }
    SUBCASE("a user's scalar") { for_all_widths<plain>(check); }
}

TEST_CASE("pack: an inverse mass in its own format meets an impulse") {
    using inverse = physics::inverse_of<physics::fixed32>;
    numbers<inverse> masses;
    numbers<physics::fixed32> impulses;
    tally seen;
    for (int round = 0; round < 2000; ++round) {
        inverse a[4];
        physics::fixed32 b[4];
        physics::fixed32 got[4], want[4];
        for (inverse& x : a) x = masses.next();
        for (physics::fixed32& x : b) x = impulses.next();
        mul<physics::fixed32>(pack<inverse, 4>::load(a), pack<physics::fixed32, 4>::load(b)).store(got);
        for (int i = 0; i < 4; ++i) want[i] = physics::mul<physics::fixed32>(a[i], b[i]);
        seen.same_all("mul", got, want, 4);
    }
    CHECK(seen.scalars == 8000);
    CHECK(seen.wrong == 0);
}

TEST_CASE("pack: a kernel gives the same bits at any width") {
    check_widths_agree<float>();
    check_widths_agree<double>();
    check_widths_agree<physics::fixed32>();
    check_widths_agree<physics::fixed16>();
    check_widths_agree<plain>();
}

#ifdef WIDE_REGISTERS
TEST_CASE("pack: a kernel for wider registers than the unit's gives the same bits") {
    if (!__builtin_cpu_supports("avx2")) return;
    check_wide_registers<float>();
    check_wide_registers<double>();
}
#endif

TEST_CASE("pack: native widths are those of the registers") {
    CHECK(native_width<float> == (vector_bytes ? vector_bytes / 4 : 1));
    CHECK(native_width<double> == (vector_bytes ? vector_bytes / 8 : 1));
    CHECK(native_width<physics::fixed32> == 1);
    CHECK(native_width<plain> == 1);
    CHECK(sizeof(pack<float, native_width<float>>) == (vector_bytes ? vector_bytes : sizeof(float)));
}

PHYSICS_HPP_REGION_POP
