// The probe finds each fault, alone and together with others, and finds none where there is none.
#include <doctest/doctest.h>

#include "physics/base/probe.hpp"

#include <cstdint>
#include <string>

using physics::float_control_scope;
using physics::float_environment;
using physics::float_fault;
using physics::float_fault_names;
using physics::detail::read_float_control;
using physics::detail::write_float_control;

namespace {

constexpr std::uint32_t operator|(float_fault a, float_fault b) {
    return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b);
}
constexpr std::uint32_t mask(float_fault fault) { return static_cast<std::uint32_t>(fault); }

/// Arithmetic with one fault, made by hand and so the same with every compiler and flag.
template <float_fault Fault>
struct faulty : physics::detail::region_arithmetic {
    using well = physics::detail::region_arithmetic;

    template <class F>
    static F product_sum(F a, F b, F c) {
        if constexpr (Fault != float_fault::contraction) return well::product_sum(a, b, c);
        else if constexpr (sizeof(F) == 4) return __builtin_fmaf(a, b, c);
        else return __builtin_fma(a, b, c);
    }
    template <class F>
    static bool product_differs(F a, F b, F expected) {
        if constexpr (Fault != float_fault::extended_precision) return well::product_differs(a, b, expected);
        else if constexpr (sizeof(F) == 4) return static_cast<double>(a) * b != expected;
        else return __builtin_fma(a, b, -expected) != 0;
    }
    template <class F>
    static F sum_difference(F a, F b) {
        return Fault == float_fault::reassociation ? b : well::sum_difference(a, b);
    }
    template <class F>
    static F sum_with_zero(F a) {
        return Fault == float_fault::signed_zeros ? a : well::sum_with_zero(a);
    }
    template <class F>
    static void quotients(const F* a, F b, F* results) {
        well::quotients(a, b, results);
        if (Fault == float_fault::division) results[1] = a[1] * (F(1) / b);
    }
    template <class F>
    static F root(F a) {
        const F root = well::root(a);
        return Fault == float_fault::square_root && a > F(12) ? root + root * std::numeric_limits<F>::epsilon() : root;
    }
};

/// As above, with faults of the control word.
template <float_fault Fault>
struct mistuned : physics::detail::region_arithmetic {
    using well = physics::detail::region_arithmetic;
    static constexpr bool is_subnormal(auto x) {
        return x != 0 && (x < 0 ? -x : x) < std::numeric_limits<decltype(x)>::min();
    }

    template <class F>
    static F product(F a, F b) {
        if (Fault == float_fault::denormals_are_zero && (is_subnormal(a) || is_subnormal(b))) return 0;
        const F result = well::product(a, b);
        return Fault == float_fault::flush_to_zero && is_subnormal(result) ? 0 : result;
    }
    template <class F>
    static F sum(F a, F b) {
        const F result = well::sum(a, b);
        return Fault == float_fault::rounding_mode && result > a ? a : result;
    }
};

#if defined(__SSE__)
constexpr unsigned flags = 0x3f;
#else
constexpr unsigned flags = 0;
#endif

/// The control word with these bits turned on, for as long as this lives.
class mistuning {
public:
    explicit mistuning(physics::detail::float_control bits) : saved_(read_float_control()) {
        write_float_control(saved_ | bits);
    }
    ~mistuning() { write_float_control(saved_); }
    mistuning(const mistuning&) = delete;
    mistuning& operator=(const mistuning&) = delete;

private:
    physics::detail::float_control saved_;
};

/// The control word without the flags that x86 keeps in it too, and that any inexact result raises.
physics::detail::float_control tuning() { return read_float_control() & ~physics::detail::float_control{flags}; }

struct setting {
    const char* name;
    physics::detail::float_control bits;
    std::uint32_t faults;
};
#if defined(__SSE__)
constexpr setting settings[] = {
    {"downwards", 0x2000, mask(float_fault::rounding_mode)},
    {"upwards", 0x4000, mask(float_fault::rounding_mode)},
    {"towards zero", 0x6000, mask(float_fault::rounding_mode)},
    {"flush to zero", 0x8000, mask(float_fault::flush_to_zero)},
    {"denormals are zero", 0x0040, mask(float_fault::denormals_are_zero)},
    {"what loading a library linked with -ffast-math does", 0x8040,
     float_fault::flush_to_zero | float_fault::denormals_are_zero},
    {"all", 0xe040, mask(float_fault::rounding_mode) | (float_fault::flush_to_zero | float_fault::denormals_are_zero)},
};
#elif defined(__aarch64__)
constexpr setting settings[] = {
    {"upwards", 0x400000, mask(float_fault::rounding_mode)},
    {"downwards", 0x800000, mask(float_fault::rounding_mode)},
    {"towards zero", 0xc00000, mask(float_fault::rounding_mode)},
    {"flush to zero", 0x1000000, float_fault::flush_to_zero | float_fault::denormals_are_zero},
};
#else
constexpr setting settings[] = {{"no control word is known here", 0, 0}};
#endif

}  // namespace

// What both compilers do by default with user code for a processor that has the instruction.
#if defined(__x86_64__) && defined(__clang__)
#define FUSING __attribute__((noinline, target("fma")))
#elif defined(__x86_64__) && defined(__GNUC__)
#define FUSING __attribute__((noinline, target("fma"), optimize("O2", "fp-contract=fast")))
#endif
#ifdef FUSING
PHYSICS_HPP_DEFINE_PROBED_ARITHMETIC(fused_code, FUSING)
#endif

TEST_CASE("probe: the library's own code is well in this build") {
    INFO(float_fault_names(float_environment()).c_str());
    CHECK(float_environment() == 0);
}

TEST_CASE("probe: each fault of code is found, and nothing else") {
    CHECK(float_environment<faulty<float_fault::contraction>>() == mask(float_fault::contraction));
    CHECK(float_environment<faulty<float_fault::extended_precision>>() == mask(float_fault::extended_precision));
    CHECK(float_environment<faulty<float_fault::reassociation>>() == mask(float_fault::reassociation));
    CHECK(float_environment<faulty<float_fault::signed_zeros>>() == mask(float_fault::signed_zeros));
    CHECK(float_environment<faulty<float_fault::division>>() == mask(float_fault::division));
    CHECK(float_environment<faulty<float_fault::square_root>>() == mask(float_fault::square_root));
}

TEST_CASE("probe: each fault of the control word is found, and nothing else") {
    CHECK(float_environment<mistuned<float_fault::rounding_mode>>() == mask(float_fault::rounding_mode));
    CHECK(float_environment<mistuned<float_fault::flush_to_zero>>() == mask(float_fault::flush_to_zero));
    CHECK(float_environment<mistuned<float_fault::denormals_are_zero>>() == mask(float_fault::denormals_are_zero));
}

#ifdef FUSING
TEST_CASE("probe: contraction in user code is found, and stays out of the region") {
    if (!__builtin_cpu_supports("fma")) return;
    CHECK(float_environment<fused_code>() == mask(float_fault::contraction));
    CHECK(float_environment() == 0);
}
#endif

TEST_CASE("probe: a control word that is off is found, repaired in a scope and restored after it") {
    for (const setting& s : settings) {
        CAPTURE(s.name);
        const mistuning wrong(s.bits);
        const auto before = tuning();
        CHECK(float_environment() == s.faults);
        CHECK(tuning() == before);
        {
            const float_control_scope outer;
            CHECK(float_environment() == 0);
            {
                const float_control_scope inner;
                CHECK(float_environment() == 0);
            }
            CHECK(float_environment() == 0);
        }
        CHECK(tuning() == before);
        CHECK(float_environment() == s.faults);
    }
    CHECK(float_environment() == 0);
}

TEST_CASE("probe: a scope changes nothing but what it must") {
    const auto before = tuning();
    for (const setting& s : settings) {
        const mistuning wrong(s.bits);
        const float_control_scope scope;
        CHECK((tuning() | s.bits) == (before | s.bits));
        CHECK((tuning() & s.bits) == 0);
    }
}

TEST_CASE("probe: masks are told in words") {
    CHECK(std::string(float_fault_names(0).c_str()) == "none");
    CHECK(std::string(float_fault_names(mask(float_fault::contraction)).c_str()) == "contraction of a * b + c");
    CHECK(std::string(float_fault_names(float_fault::flush_to_zero | float_fault::denormals_are_zero).c_str()) ==
          "flush to zero, denormals are zero");
    // All at once still fit, and each is there once.
    const std::string all = float_fault_names(~std::uint32_t{0}).c_str();
    std::size_t length = 0;
    for (std::uint32_t bit = 1; bit <= 256; bit *= 2) {
        const std::string name = to_text(static_cast<float_fault>(bit));
        CHECK(name != "unknown");
        CHECK(all.find(name) != std::string::npos);
        length += name.size() + 2;
    }
    CHECK(all.size() + 2 == length);
    CHECK(std::string(to_text(static_cast<float_fault>(512))) == "unknown");
}
