// The floating-point environment: a proof at run time that arithmetic rounds as it should, and a guard that sees to it.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

#include "physics/base/root.hpp"

// What the probe looks at: arithmetic that is compiled where the macro stands, by the rules that hold there. Hence
// no function may be inlined. Define one in your own code to learn about that: float_environment<Name>().
#if defined(__GNUC__) || defined(__clang__)
#define PHYSICS_HPP_WRITTEN_ROOT(F, x) (sizeof(F) == 4 ? F(__builtin_sqrtf(float(x))) : F(__builtin_sqrt(double(x))))
#else
#define PHYSICS_HPP_WRITTEN_ROOT(F, x) ::physics::detail::hardware_root(x)
#endif
#define PHYSICS_HPP_DEFINE_PROBED_ARITHMETIC(Name, Attributes)          \
    struct Name {                                                       \
        template <class F>                                              \
        Attributes static F sum(F a, F b) {                             \
            return a + b;                                               \
        }                                                               \
        template <class F>                                              \
        Attributes static F product(F a, F b) {                         \
            return a * b;                                               \
        }                                                               \
        template <class F>                                              \
        Attributes static bool product_differs(F a, F b, F expected) {  \
            return a * b != expected;                                   \
        }                                                               \
        template <class F>                                              \
        Attributes static F product_sum(F a, F b, F c) {                \
            return a * b + c;                                           \
        }                                                               \
        template <class F>                                              \
        Attributes static F sum_difference(F a, F b) {                  \
            return (a + b) - a;                                         \
        }                                                               \
        template <class F>                                              \
        Attributes static F sum_with_zero(F a) {                        \
            return a + F(0);                                            \
        }                                                               \
        template <class F>                                              \
        Attributes static void quotients(const F* a, F b, F* results) { \
            for (int i = 0; i < 3; ++i) results[i] = a[i] / b;          \
            results[3] = a[0] / F(49);                                  \
        }                                                               \
        template <class F>                                              \
        Attributes static F root(F a) {                                 \
            return F(PHYSICS_HPP_WRITTEN_ROOT(F, a));                   \
        }                                                               \
    };

PHYSICS_HPP_BEGIN

/// What may be wrong with floating-point arithmetic; float_environment() returns a sum of these bits. The values are
/// written into recordings and never change their meaning.
enum class float_fault : std::uint32_t {
    contraction = 1,           ///< a * b + c is rounded once instead of twice (a compiler's fused multiply-add)
    extended_precision = 2,    ///< intermediate results are wider than their type (x87)
    reassociation = 4,         ///< sums are regrouped
    signed_zeros = 8,          ///< the sign of zero is not kept
    division = 16,             ///< quotients are products with a reciprocal, or estimates
    square_root = 32,          ///< roots are estimates
    rounding_mode = 64,        ///< rounding is not to nearest
    flush_to_zero = 128,       ///< results below the normal range become zero
    denormals_are_zero = 256,  ///< operands below the normal range count as zero
};

/// The fault in words, such as `flush to zero`.
constexpr const char* to_text(float_fault fault) noexcept {
    switch (fault) {
        case float_fault::contraction: return "contraction of a * b + c";
        case float_fault::extended_precision: return "extended precision";
        case float_fault::reassociation: return "reassociation";
        case float_fault::signed_zeros: return "lost signs of zeros";
        case float_fault::division: return "inexact division";
        case float_fault::square_root: return "inexact square roots";
        case float_fault::rounding_mode: return "rounding not to nearest";
        case float_fault::flush_to_zero: return "flush to zero";
        case float_fault::denormals_are_zero: return "denormals are zero";
    }
    return "unknown";
}

/// All faults of a mask in words, for messages: `contraction of a * b + c, flush to zero`; `none` for 0.
class float_fault_names {
public:
    PHYSICS_HPP_COLD explicit float_fault_names(std::uint32_t mask) noexcept {
        std::size_t used = 0;
        const auto append = [&](const char* word) noexcept {
            const std::size_t length = std::strlen(word);
            std::memcpy(text_ + used, word, length);
            used += length;
        };
        for (std::uint32_t bit = 1; bit <= 256; bit *= 2) {
            if ((mask & bit) == 0) continue;
            if (used > 0) append(", ");
            append(to_text(static_cast<float_fault>(bit)));
        }
        if (used == 0) append("none");
    }
    [[nodiscard]] const char* c_str() const noexcept { return text_; }

private:
    char text_[256] = {};
};

namespace detail {

// The control word of this thread's floating-point unit, and the one that the library runs under: round to nearest,
// subnormals kept. Traps, NaN handling and the flags of past exceptions stay as the user has them.
#if (defined(__GNUC__) || defined(__clang__)) && defined(__SSE__)
using float_control = unsigned;
inline float_control read_float_control() noexcept { return __builtin_ia32_stmxcsr(); }
inline void write_float_control(float_control word) noexcept {
    __asm__ volatile("" : : : "memory");
    __builtin_ia32_ldmxcsr(word);
    __asm__ volatile("" : : : "memory");
}
inline float_control exact_float_control(float_control word) noexcept {
    return word & ~0xe040u;  // rounding control, flush to zero, denormals are zero
}
#elif (defined(__GNUC__) || defined(__clang__)) && defined(__aarch64__)
using float_control = std::uint64_t;
inline float_control read_float_control() noexcept {
    float_control word;
    __asm__ volatile("mrs %0, fpcr" : "=r"(word));
    return word;
}
inline void write_float_control(float_control word) noexcept {
    __asm__ volatile("msr fpcr, %0" : : "r"(word) : "memory");
}
inline float_control exact_float_control(float_control word) noexcept {
    return word & ~float_control{0x1c80003};  // RMode, FZ, FZ16, and FIZ, AH of newer processors
}
#else
using float_control = unsigned;
inline float_control read_float_control() noexcept { return 0; }
inline void write_float_control(float_control) noexcept {}
inline float_control exact_float_control(float_control word) noexcept { return word; }
#endif

}  // namespace detail

/// While it lives, this thread's arithmetic rounds to nearest and keeps subnormal numbers, whatever the program or a
/// shared library that was linked with -ffast-math has switched on; then the control word is as it was. A step opens
/// one on every thread that it uses. ~10 ns, ~15 ns where there is something to repair. Does nothing on processors
/// other than x86 with SSE and 64-bit ARM.
/// Compilers may move arithmetic on values in registers across it: do the work in a function that is not inlined.
class float_control_scope {
public:
    float_control_scope() noexcept : saved_(detail::read_float_control()), exact_(detail::exact_float_control(saved_)) {
        if (exact_ != saved_) detail::write_float_control(exact_);
    }
    ~float_control_scope() {
        if (exact_ != saved_) detail::write_float_control(saved_);
    }
    float_control_scope(const float_control_scope&) = delete;
    float_control_scope& operator=(const float_control_scope&) = delete;

private:
    detail::float_control saved_, exact_;
};

namespace detail {

template <class F>
PHYSICS_HPP_NOINLINE auto call_noinline(F& f) {
    return f();
}
/// f() in a float_control_scope: the bits of a step, whatever modes the host has set.
template <class F>
auto scoped(F&& f) {
    const float_control_scope control;
    return call_noinline(f);
}

PHYSICS_HPP_DEFINE_PROBED_ARITHMETIC(region_arithmetic, PHYSICS_HPP_NOINLINE)

template <class F>
struct probe_numbers;
template <>
struct probe_numbers<float> {
    using word = std::uint32_t;
    static constexpr float small = 0x1p-14f, huge = 0x1p80f, lift = 0x1p120f;
    static constexpr float quotients[3] = {0x1.a1f58ep-4f, 0x1.e0a73p-2f, 0x1.6db6dcp-1f};
    static constexpr float roots[3] = {0x1.a8872ap+1f, 0x1.deeea2p+1f, 0x1.16f834p+2f};
};
template <>
struct probe_numbers<double> {
    using word = std::uint64_t;
    static constexpr double small = 0x1p-30, huge = 0x1p80, lift = 0x1p1000;
    static constexpr double quotients[3] = {0x1.a1f58d0fac688p-4, 0x1.e0a72f0539783p-2, 0x1.6db6db6db6db7p-1};
    static constexpr double roots[3] = {0x1.a887293fd6f34p+1, 0x1.deeea11683f49p+1, 0x1.16f8334644df9p+2};
};

/// x, of which the optimiser knows nothing; rounded to F where registers are wider.
template <class F>
F hidden(F x) noexcept {
    volatile F value = x;
    return value;
}
/// Comparing numbers would take a subnormal for zero where that is the fault.
template <class F>
bool is_positive_zero(F x) noexcept {
    typename probe_numbers<F>::word word;
    std::memcpy(&word, &x, sizeof x);
    return word == 0;
}

constexpr std::uint32_t fault(bool found, float_fault which) noexcept {
    return found ? static_cast<std::uint32_t>(which) : 0;
}

/// The faults of the processor's control word.
template <class A, class F>
PHYSICS_HPP_COLD std::uint32_t control_faults() noexcept {
    using limits = std::numeric_limits<F>;
    constexpr F one = 1, step = limits::epsilon();
    const bool up = hidden(A::sum(hidden(one), hidden(step / 4))) != one;
    const bool down = hidden(A::sum(hidden(one), hidden(step / 4 * 3))) != one + step;
    const F subnormal = hidden(A::product(hidden(limits::min()), hidden(F(0.5))));
    const F lifted = hidden(A::product(hidden(limits::denorm_min()), hidden(probe_numbers<F>::lift)));
    return fault(up || down, float_fault::rounding_mode) |
           fault(is_positive_zero(subnormal), float_fault::flush_to_zero) |
           fault(is_positive_zero(lifted), float_fault::denormals_are_zero);
}

/// The faults of compiled code, under a good control word.
template <class A, class F>
PHYSICS_HPP_COLD std::uint32_t code_faults() noexcept {
    using numbers = probe_numbers<F>;
    // The square of 1 + h is 1 + 2h and a rest that F has no bits for.
    const F factor = hidden(F(1) + numbers::small), square = hidden(F(1) + 2 * numbers::small);
    const bool extended = A::product_differs(factor, factor, square);
    const bool contracted = !extended && hidden(A::product_sum(factor, factor, hidden(-square))) != F(0);
    const bool regrouped = hidden(A::sum_difference(hidden(numbers::huge), hidden(F(1)))) != F(0);
    const bool signs = !is_positive_zero(hidden(A::sum_with_zero(hidden(-F(0)))));
    // Numbers whose products with the rounded reciprocal of 49 are off by a unit, and those whose roots by estimate
    // and Newton step are.
    const F numerators[3] = {hidden(F(5)), hidden(F(23)), hidden(F(35))};
    const F radicands[3] = {hidden(F(11)), hidden(F(14)), hidden(F(19))};
    F quotients[4];
    A::quotients(numerators, hidden(F(49)), quotients);
    bool inexact = hidden(quotients[3]) != numbers::quotients[0], estimated = false;
    for (int i = 0; i < 3; ++i) {
        inexact = inexact || hidden(quotients[i]) != numbers::quotients[i];
        estimated = estimated || hidden(A::root(radicands[i])) != numbers::roots[i];
    }
    return fault(contracted, float_fault::contraction) | fault(extended, float_fault::extended_precision) |
           fault(regrouped, float_fault::reassociation) | fault(signs, float_fault::signed_zeros) |
           fault(inexact, float_fault::division) | fault(estimated, float_fault::square_root);
}

}  // namespace detail

/// What is wrong with float and double arithmetic in this unit and on this thread, as a sum of float_fault bits; 0 is
/// well. Looks at the library's own code, or with an argument at the code where that was defined by
/// PHYSICS_HPP_DEFINE_PROBED_ARITHMETIC. Within a float_control_scope only what that can't repair is left. Where
/// rounding is off for good, faults of code are not looked for. ~0.1 us.
template <class Arithmetic = detail::region_arithmetic>
PHYSICS_HPP_NOINLINE std::uint32_t float_environment() noexcept {
    const std::uint32_t control =
        detail::control_faults<Arithmetic, float>() | detail::control_faults<Arithmetic, double>();
    const float_control_scope scope;
    const std::uint32_t rest =
        detail::control_faults<Arithmetic, float>() | detail::control_faults<Arithmetic, double>();
    if ((rest & static_cast<std::uint32_t>(float_fault::rounding_mode)) != 0) return control;
    return control | detail::code_faults<Arithmetic, float>() | detail::code_faults<Arithmetic, double>();
}

PHYSICS_HPP_END
