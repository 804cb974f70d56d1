// physics.hpp 0.1.0
// SPDX-License-Identifier: MIT
// Copyright (c) 2026 the physics authors
//
// Rigid-body physics for games, in 2D and 3D, in float, double and fixed point: the same bits everywhere.
//
// This one header is all there is: copy it into your project, compile as C++20, no flags, nothing to link.
// From a checkout, -I. gives the single header and -Iinclude its parts; both are #include <physics.hpp>.
// Options, off unless defined before the include:
//   PHYSICS_HPP_NONDETERMINISTIC  accept fast-math, x87 and contraction; the bits then depend on the build
//   PHYSICS_HPP_AUDIT             count every fixed-point overflow (see overflow_count)
//   PHYSICS_HPP_NO_INT128         take the portable 128-bit path even where the compiler has __int128
//
// Made from include/physics.hpp and its parts by include/amalgamate.py: change those, not this file.
#ifndef PHYSICS_HPP
#define PHYSICS_HPP

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

// =================================================================================================
// physics/base/config.hpp
// =================================================================================================
// Compiler facts, options, the determinism region and what is refused at compile time.

// One place holds the version; meson.build and the banner of the single header read it from here.
#define PHYSICS_HPP_VERSION_MAJOR 0
#define PHYSICS_HPP_VERSION_MINOR 1
#define PHYSICS_HPP_VERSION_PATCH 0

// Options, all off unless the user defines them before including:
//   PHYSICS_HPP_NONDETERMINISTIC  accept fast-math, x87 and contraction; the bits then depend on the build
//   PHYSICS_HPP_AUDIT             count every fixed-point overflow (see overflow_count)
//   PHYSICS_HPP_NO_INT128         take the portable 128-bit path even where the compiler has __int128

#if defined(_MSVC_LANG)
#define PHYSICS_HPP_CPLUSPLUS _MSVC_LANG
#else
#define PHYSICS_HPP_CPLUSPLUS __cplusplus
#endif
#if PHYSICS_HPP_CPLUSPLUS < 202002L
#error "physics.hpp needs C++20: compile with -std=c++20 or later"
// Ends the compilation, for want of such a file: hundreds of errors would bury the one that counts.
#pragma GCC dependency "C++20"
#endif

#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define PHYSICS_HPP_EXCEPTIONS 1
#else
#define PHYSICS_HPP_EXCEPTIONS 0
#endif

#if defined(__SIZEOF_INT128__) && !defined(PHYSICS_HPP_NO_INT128)
#define PHYSICS_HPP_INT128 1
#else
#define PHYSICS_HPP_INT128 0
#endif

#ifndef PHYSICS_HPP_NONDETERMINISTIC
#if defined(__FAST_MATH__) || defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0 || defined(_M_FP_FAST)
#error \
    "physics.hpp promises the same bits everywhere, which -ffast-math breaks: drop that flag for this file, or define PHYSICS_HPP_NONDETERMINISTIC"
#elif defined(__GCC_IEC_559) && __GCC_IEC_559 == 0
#error \
    "physics.hpp promises the same bits everywhere, which flags such as -fassociative-math break: drop them for this file, or define PHYSICS_HPP_NONDETERMINISTIC"
#elif defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
// 16 is what gcc says where _Float16 has arithmetic of its own; float and double then have too.
#error \
    "physics.hpp promises the same bits everywhere, which x87 arithmetic breaks: add -msse2 -mfpmath=sse, or define PHYSICS_HPP_NONDETERMINISTIC"
#endif
#endif

// Options that change types or results enter the name of the inline namespace, so that units built
// differently never share an instantiation by accident.
#if PHYSICS_HPP_INT128
#define PHYSICS_HPP_ABI_WIDE
#else
#define PHYSICS_HPP_ABI_WIDE _portable
#endif
#ifdef PHYSICS_HPP_AUDIT
#define PHYSICS_HPP_ABI_AUDIT _audit
#else
#define PHYSICS_HPP_ABI_AUDIT
#endif
#ifdef PHYSICS_HPP_NONDETERMINISTIC
#define PHYSICS_HPP_ABI_FLOAT _loose
#else
#define PHYSICS_HPP_ABI_FLOAT
#endif
#define PHYSICS_HPP_JOIN_(a, b, c, d) a##b##c##d
#define PHYSICS_HPP_JOIN(a, b, c, d) PHYSICS_HPP_JOIN_(a, b, c, d)
#define PHYSICS_HPP_ABI PHYSICS_HPP_JOIN(v0_1, PHYSICS_HPP_ABI_WIDE, PHYSICS_HPP_ABI_AUDIT, PHYSICS_HPP_ABI_FLOAT)

// The determinism region. Compilers fuse a * b + c into one rounding where the target has such an
// instruction (gcc also under -std=c++20), so each part of the library opens a region that forbids it.
// gcc's pragma keeps region code from inlining into user code, so it is set only where fusing is possible.
// gcc contracts always_inline functions again in the caller, hence the library's are plain inline.
#ifdef PHYSICS_HPP_NONDETERMINISTIC
#define PHYSICS_HPP_REGION_PUSH
#define PHYSICS_HPP_REGION_POP
#elif defined(__clang__) && (defined(__wasm__) || defined(__arm__) || defined(__aarch64__) && __clang_major__ < 15)
// Here clang ignores float_control(push): the pragma reaches to the end of the user's file.
#define PHYSICS_HPP_REGION_PUSH _Pragma("clang fp contract(off)")
#define PHYSICS_HPP_REGION_POP
#elif defined(__clang__)
// Precise as well, since no macro shows flags such as -fassociative-math. Only -ffp-contract=fast gets through, and
// flags that imply it: clang fuses after it has forgotten the pragma. The probe reports it.
#define PHYSICS_HPP_REGION_PUSH _Pragma("float_control(precise, on, push)") _Pragma("clang fp contract(off)")
#define PHYSICS_HPP_REGION_POP _Pragma("float_control(pop)")
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
// gcc's vectoriser forms fused multiply-addsub from paired products even so, hence it stays out; packs are explicit.
#define PHYSICS_HPP_REGION_PUSH   \
    _Pragma("GCC push_options")   \
    _Pragma("GCC optimize(\"fp-contract=off\", \"no-tree-slp-vectorize\", \"no-tree-loop-vectorize\")")
#define PHYSICS_HPP_REGION_POP _Pragma("GCC pop_options")
#elif defined(_MSC_VER)
#define PHYSICS_HPP_REGION_PUSH __pragma(float_control(precise, on, push)) __pragma(fp_contract(off))
#define PHYSICS_HPP_REGION_POP __pragma(float_control(pop))
#else
#define PHYSICS_HPP_REGION_PUSH
#define PHYSICS_HPP_REGION_POP
#endif

#define PHYSICS_HPP_BEGIN  \
    PHYSICS_HPP_REGION_PUSH \
    namespace physics {    \
    inline namespace PHYSICS_HPP_ABI {
#define PHYSICS_HPP_END \
    }                   \
    }                   \
    PHYSICS_HPP_REGION_POP

#if defined(__GNUC__)
#define PHYSICS_HPP_COLD __attribute__((noinline, cold))
#elif defined(_MSC_VER)
#define PHYSICS_HPP_COLD __declspec(noinline)
#else
#define PHYSICS_HPP_COLD
#endif

// A hint that the memory at an address is wanted soon.
#if defined(__GNUC__)
#define PHYSICS_HPP_PREFETCH(address) __builtin_prefetch(address)
#else
#define PHYSICS_HPP_PREFETCH(address) static_cast<void>(address)
#endif

// =================================================================================================
// physics/base/error.hpp
// =================================================================================================
// What happens with bad input: a message that names the function, the field and the value.

PHYSICS_HPP_BEGIN

/// A refused call: which function, which field, which value, and what was expected. The world is as it
/// was before the call. Thrown where exceptions are on, otherwise handed to the error handler.
class error : public std::exception {
public:
    error(const char* function, const char* field, const char* value, const char* rule) noexcept {
        std::snprintf(text_, sizeof text_, "physics: %s: %s is %s; %s", function, field, value, rule);
    }
    /// The whole sentence, for example `physics: create_body: position.x is nan; it must be finite`.
    [[nodiscard]] const char* what() const noexcept override { return text_; }

private:
    char text_[256];
};

/// Called with every refused call in builds without exceptions.
using error_handler = void (*)(const error&);

namespace detail {
[[noreturn]] inline void print_and_abort(const error& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    std::abort();
}
inline error_handler& current_error_handler() noexcept {
    static error_handler handler = print_and_abort;
    return handler;
}
}  // namespace detail

/// Sets what builds without exceptions (-fno-exceptions) do with a refused call, and returns the former
/// handler; nullptr restores the default, which prints and aborts. If the handler returns, the refused
/// function returns too, with a null handle or a zero, and nothing has changed. Not thread-safe: set it
/// once, at the start. Builds with exceptions throw instead and never call it.
inline error_handler set_error_handler(error_handler handler) noexcept {
    error_handler former = detail::current_error_handler();
    detail::current_error_handler() = handler ? handler : detail::print_and_abort;
    return former;
}

namespace detail {

/// Throws the error, or calls the handler and returns false where exceptions are off.
PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, const char* value, const char* rule) {
#if PHYSICS_HPP_EXCEPTIONS
    throw error(function, field, value, rule);
#else
    current_error_handler()(error(function, field, value, rule));
    return false;
#endif
}

PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, double value, const char* rule) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    // Some systems write nan with a sign.
    return refuse(function, field, value != value ? "nan" : text, rule);
}

/// The same for a component of a field, such as ".x" of "position".
PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, const char* component, double value,
                                    const char* rule) {
    char name[80];
    std::snprintf(name, sizeof name, "%s%s", field, component);
    return refuse(function, name, value, rule);
}

}  // namespace detail

/// For the checks of your own shapes and policies: refuse(function, field, value, rule) throws the error, or calls the
/// handler and returns false; the value is text or a number.
using detail::refuse;

PHYSICS_HPP_END

// =================================================================================================
// physics/base/buffer.hpp
// =================================================================================================
// A growable array of plain values: what all state of a world is made of.

PHYSICS_HPP_BEGIN

/// A growable array of trivially copyable values without pointers into itself, so that a copy is a memcpy.
/// Capacity doubles and is kept by clear(): a steady step allocates nothing. Moving from a buffer empties it.
template <class T>
class buffer {
    static_assert(std::is_trivially_copyable_v<T>, "physics::buffer: the values must be trivially copyable");

public:
    buffer() = default;
    buffer(const buffer& other) { *this = other; }
    buffer(buffer&& other) noexcept { swap(other); }
    buffer& operator=(const buffer& other) {
        if (this == &other) return *this;
        reserve(other.size_);
        if (other.size_ > 0) std::memcpy(static_cast<void*>(data_), other.data_, other.size_ * sizeof(T));
        size_ = other.size_;
        return *this;
    }
    buffer& operator=(buffer&& other) noexcept {
        buffer taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~buffer() { std::free(data_); }
    void swap(buffer& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
    }

    [[nodiscard]] std::uint32_t size() const { return size_; }
    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    T& operator[](std::uint32_t i) { return data_[i]; }
    const T& operator[](std::uint32_t i) const { return data_[i]; }
    T& back() { return data_[size_ - 1]; }
    const T& back() const { return data_[size_ - 1]; }

    void clear() { size_ = 0; }
    void reserve(std::uint32_t capacity) {
        if (capacity > capacity_) grow_to(capacity);
    }
    /// Adds a copy of value at the end; the value may lie within the buffer.
    T& push(const T& value) {
        const T copy = value;
        if (size_ == capacity_) grow_to(std::uint64_t{size_} + 1);
        return *new (static_cast<void*>(data_ + size_++)) T(copy);
    }
    /// Adds T{parts...} at the end; nothing of it may lie within the buffer.
    template <class... Parts>
    T& emplace(Parts&&... parts) {
        if (size_ == capacity_) grow_to(std::uint64_t{size_} + 1);
        return *new (static_cast<void*>(data_ + size_++)) T{static_cast<Parts&&>(parts)...};
    }
    void pop() { --size_; }
    /// Shortens the buffer, or fills it up with copies of value, which may lie within the buffer.
    void resize(std::uint32_t size, const T& value = T{}) {
        const T copy = value;
        reserve(size);
        for (std::uint32_t i = size_; i < size; ++i) new (static_cast<void*>(data_ + i)) T(copy);
        size_ = size;
    }

private:
    static_assert(alignof(T) <= alignof(std::max_align_t));

    PHYSICS_HPP_COLD void grow_to(std::uint64_t needed) {
        constexpr std::uint64_t most = 0xffffffffu < SIZE_MAX / sizeof(T) ? 0xffffffffu : SIZE_MAX / sizeof(T);
        std::uint64_t capacity = capacity_ < 8 ? 16 : std::uint64_t{capacity_} * 2;
        if (capacity < needed) capacity = needed;
        if (capacity > most && needed <= most) capacity = most;
        void* grown = capacity > most
                          ? nullptr
                          : std::realloc(static_cast<void*>(data_), static_cast<std::size_t>(capacity) * sizeof(T));
        if (grown == nullptr) {
            // Nobody can go on without the memory, so a handler that returns must not reach the caller.
            detail::refuse("buffer", "memory", static_cast<double>(capacity) * sizeof(T),
                           "the bytes are not available");
            std::abort();
        }
        data_ = static_cast<T*>(grown);
        capacity_ = static_cast<std::uint32_t>(capacity);
    }

    T* data_ = nullptr;
    std::uint32_t size_ = 0;
    std::uint32_t capacity_ = 0;
};

namespace detail {

/// A number beside buffers: 0 once it was moved from, as they are empty.
template <class T>
class reset_on_move {
public:
    reset_on_move() = default;
    reset_on_move(T value) : value_(value) {}
    reset_on_move(const reset_on_move&) = default;
    reset_on_move(reset_on_move&& other) noexcept : value_(std::exchange(other.value_, T{})) {}
    reset_on_move& operator=(const reset_on_move&) = default;
    reset_on_move& operator=(reset_on_move&& other) noexcept {
        value_ = std::exchange(other.value_, T{});
        return *this;
    }
    operator T() const { return value_; }
    T operator++() { return ++value_; }
    T operator--() { return --value_; }

private:
    T value_{};
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/arena.hpp
// =================================================================================================
// Memory for one step: taken piece by piece, given back all at once.

PHYSICS_HPP_BEGIN

/// Scratch memory. take() costs a few instructions; reset() frees everything and, where the last round did
/// not fit into one block, merges the blocks, so that a steady step allocates nothing. A copy starts empty.
class arena {
public:
    arena() = default;
    arena(const arena&) {}
    arena(arena&& other) noexcept { swap(other); }
    arena& operator=(const arena&) { return *this; }
    arena& operator=(arena&& other) noexcept {
        arena taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~arena() {
        for (block& b : blocks_) std::free(b.memory);
    }

    /// Room for count values, not initialised, aligned for T and to at least 16 bytes; valid until reset().
    template <class T>
    T* take(std::uint32_t count) {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
        const std::size_t bytes = (std::size_t{count} * sizeof(T) + alignment - 1) / alignment * alignment;
        if (blocks_.empty() || blocks_.back().size - used_ < bytes) add_block(bytes);
        void* place = blocks_.back().memory + used_;
        used_ += bytes;
        return static_cast<T*>(place);
    }

    void reset() {
        if (blocks_.size() > 1) {
            std::size_t total = 0;
            for (block& b : blocks_) {
                total += b.size;
                std::free(b.memory);
            }
            blocks_.clear();
            add_block(total);
        }
        used_ = blocks_.empty() ? 0 : start(blocks_.back());
    }

    /// Bytes that the arena holds.
    [[nodiscard]] std::size_t capacity() const {
        std::size_t total = 0;
        for (const block& b : blocks_) total += b.size;
        return total;
    }

private:
    static constexpr std::size_t alignment = alignof(std::max_align_t) < 16 ? 16 : alignof(std::max_align_t);
    struct block {
        unsigned char* memory;
        std::size_t size;
    };
    /// Where a block's first aligned byte is: malloc aligns to 8 bytes only on some systems.
    static std::size_t start(const block& b) {
        return (alignment - reinterpret_cast<std::uintptr_t>(b.memory) % alignment) % alignment;
    }

    void swap(arena& other) noexcept {
        blocks_.swap(other.blocks_);
        std::swap(used_, other.used_);
    }
    PHYSICS_HPP_COLD void add_block(std::size_t bytes) {
        std::size_t size = blocks_.empty() ? 4096 : blocks_.back().size * 2;
        if (size < bytes + alignment) size = bytes + alignment;
        void* memory = std::malloc(size);
        if (memory == nullptr) {
            detail::refuse("arena", "memory", static_cast<double>(size), "the bytes are not available");
            std::abort();
        }
        blocks_.push({static_cast<unsigned char*>(memory), size});
        used_ = start(blocks_.back());
    }

    buffer<block> blocks_;
    std::size_t used_ = 0;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/base/bit_array.hpp
// =================================================================================================
// Bits by number.

PHYSICS_HPP_BEGIN

namespace detail {

/// A growable array of bits: a flag for each of many things in little memory, so that looking up any is cheap.
class bit_array {
public:
    /// Makes room for bits below `size`, new ones clear.
    void grow(std::uint32_t size) {
        if ((size + 63) / 64 > words_.size()) words_.resize((size + 63) / 64, 0);
    }
    bool operator[](std::uint32_t i) const { return (words_[i / 64] >> i % 64 & 1) != 0; }
    void set(std::uint32_t i) { words_[i / 64] |= std::uint64_t{1} << i % 64; }
    void clear(std::uint32_t i) { words_[i / 64] &= ~(std::uint64_t{1} << i % 64); }

private:
    buffer<std::uint64_t> words_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/wide.hpp
// =================================================================================================
// 128-bit integers for exact products, quotients and roots: the compiler's, and a portable twin.

PHYSICS_HPP_BEGIN

namespace detail {

/// Unsigned 128-bit integer from two 64-bit halves; the twin of the compiler's, for targets without one
/// and for wasm, where it is the faster of the two.
struct portable_uint128 {
    std::uint64_t low = 0;
    std::uint64_t high = 0;

    constexpr portable_uint128() = default;
    constexpr portable_uint128(std::uint64_t value) : low(value) {}
    constexpr portable_uint128(std::uint64_t high_half, std::uint64_t low_half) : low(low_half), high(high_half) {}
    constexpr explicit operator std::uint64_t() const { return low; }

    friend bool operator==(portable_uint128 a, portable_uint128 b) = default;
};

constexpr portable_uint128 operator+(portable_uint128 a, portable_uint128 b) {
    const std::uint64_t sum = a.low + b.low;
    return {a.high + b.high + (sum < a.low), sum};
}
constexpr portable_uint128 operator~(portable_uint128 a) { return {~a.high, ~a.low}; }
constexpr portable_uint128 operator-(portable_uint128 a) { return ~a + portable_uint128(1); }
constexpr portable_uint128 operator-(portable_uint128 a, portable_uint128 b) { return a + -b; }
constexpr portable_uint128 operator<<(portable_uint128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) return {a.low << (n - 64), 0};
    return {(a.high << n) | (a.low >> (64 - n)), a.low << n};
}
constexpr portable_uint128 operator>>(portable_uint128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) return {0, a.high >> (n - 64)};
    return {a.high >> n, (a.low >> n) | (a.high << (64 - n))};
}
constexpr portable_uint128 operator|(portable_uint128 a, portable_uint128 b) {
    return {a.high | b.high, a.low | b.low};
}
constexpr bool operator<(portable_uint128 a, portable_uint128 b) {
    return a.high != b.high ? a.high < b.high : a.low < b.low;
}
constexpr bool operator>=(portable_uint128 a, portable_uint128 b) { return !(a < b); }
constexpr bool operator>(portable_uint128 a, portable_uint128 b) { return b < a; }
constexpr bool operator<=(portable_uint128 a, portable_uint128 b) { return !(b < a); }

/// The exact product of two 64-bit integers, by four 32-bit products.
constexpr portable_uint128 portable_product(std::uint64_t a, std::uint64_t b) {
    const std::uint64_t mask = 0xffffffffu;
    const std::uint64_t low = (a & mask) * (b & mask);
    const std::uint64_t mid = (a >> 32) * (b & mask) + (low >> 32);
    const std::uint64_t mid2 = (a & mask) * (b >> 32) + (mid & mask);
    return {(a >> 32) * (b >> 32) + (mid >> 32) + (mid2 >> 32), (mid2 << 32) | (low & mask)};
}

/// Bits needed to hold the value; 0 for zero.
constexpr int bit_width(portable_uint128 a) {
    return a.high != 0 ? 64 + static_cast<int>(std::bit_width(a.high)) : static_cast<int>(std::bit_width(a.low));
}

/// The next 32 bits of a long division by a normalised divisor: high becomes the rest. The guess from the
/// divisor's upper half is at most two too large (Knuth, The Art of Computer Programming 2, 4.3.1, D).
constexpr std::uint64_t quotient_digit(std::uint64_t& high, std::uint64_t next, std::uint64_t d) {
    const std::uint64_t mask = 0xffffffffu, d_high = d >> 32, d_low = d & mask;
    std::uint64_t guess = high / d_high, rest = high % d_high;
    while (rest <= mask && (guess > mask || guess * d_low > ((rest << 32) | next))) {
        --guess;
        rest += d_high;
    }
    high = ((high << 32) | next) - guess * d;
    return guess;
}

/// (high * 2^64 + low) / d and its remainder, for high < d.
constexpr std::uint64_t portable_divide(std::uint64_t high, std::uint64_t low, std::uint64_t d,
                                        std::uint64_t& remainder) {
    if (high == 0) {
        remainder = low % d;
        return low / d;
    }
    const int shift = std::countl_zero(d);
    const portable_uint128 a = portable_uint128(high, low) << shift;
    d <<= shift;
    remainder = a.high;
    const std::uint64_t first = quotient_digit(remainder, a.low >> 32, d);
    const std::uint64_t second = quotient_digit(remainder, a.low & 0xffffffffu, d);
    remainder >>= shift;
    return (first << 32) | second;
}

/// Quotient and remainder of a 128-bit by a 128-bit integer; b must not be zero. ~10 ns.
constexpr portable_uint128 portable_divide(portable_uint128 a, portable_uint128 b, portable_uint128& remainder) {
    if (b.high == 0) {
        portable_uint128 quotient(a.high / b.low, 0);
        std::uint64_t rest = 0;
        quotient.low = portable_divide(a.high % b.low, a.low, b.low, rest);
        remainder = rest;
        return quotient;
    }
    // The quotient by the divisor's upper 64 bits is right or one too large; half of a keeps its upper word
    // below the divisor's.
    const int shift = std::countl_zero(b.high);
    const portable_uint128 half = a >> 1;
    std::uint64_t unused = 0;
    std::uint64_t quotient = portable_divide(half.high, half.low, (b << shift).high, unused) >> (63 - shift);
    if (quotient != 0) --quotient;
    portable_uint128 back = portable_product(quotient, b.low);
    back.high += quotient * b.high;
    remainder = a - back;
    if (remainder >= b) {
        remainder = remainder - b;
        ++quotient;
    }
    return quotient;
}

#if PHYSICS_HPP_INT128
__extension__ typedef unsigned __int128 uint128;
constexpr uint128 product128(std::uint64_t a, std::uint64_t b) { return static_cast<uint128>(a) * b; }
constexpr uint128 divide128(uint128 a, uint128 b, uint128& remainder) {
    const uint128 quotient = a / b;
    remainder = a - quotient * b;
    return quotient;
}
constexpr std::uint64_t divide128(std::uint64_t high, std::uint64_t low, std::uint64_t d, std::uint64_t& remainder) {
    const std::uint64_t quotient =
        high == 0 ? low / d : static_cast<std::uint64_t>(((static_cast<uint128>(high) << 64) | low) / d);
    remainder = low - quotient * d;
    return quotient;
}
constexpr int bit_width(uint128 a) {
    return bit_width(portable_uint128(static_cast<std::uint64_t>(a >> 64), static_cast<std::uint64_t>(a)));
}
__extension__ typedef __int128 native_int128;
constexpr uint128 shift_signed(uint128 a, int n) { return static_cast<uint128>(static_cast<native_int128>(a) >> n); }
constexpr std::uint64_t high_half(uint128 a) { return static_cast<std::uint64_t>(a >> 64); }
#else
using uint128 = portable_uint128;
constexpr uint128 product128(std::uint64_t a, std::uint64_t b) { return portable_product(a, b); }
constexpr uint128 divide128(uint128 a, uint128 b, uint128& remainder) { return portable_divide(a, b, remainder); }
constexpr std::uint64_t divide128(std::uint64_t high, std::uint64_t low, std::uint64_t d, std::uint64_t& remainder) {
    return portable_divide(high, low, d, remainder);
}
#endif
/// Arithmetic shift: rounds towards minus infinity.
constexpr portable_uint128 shift_signed(portable_uint128 a, int n) { return a.high >> 63 != 0 ? ~(~a >> n) : a >> n; }
constexpr std::uint64_t high_half(portable_uint128 a) { return a.high; }
constexpr std::uint64_t low_half(uint128 a) { return static_cast<std::uint64_t>(a); }
/// The upper half of the product of two 64-bit integers.
constexpr std::uint64_t mul_high(std::uint64_t a, std::uint64_t b) { return high_half(product128(a, b)); }

/// Two's-complement 128-bit integer over either representation; wraps, never undefined.
template <class Unsigned>
struct basic_int128 {
    Unsigned bits{};

    constexpr basic_int128() = default;
    constexpr explicit basic_int128(Unsigned value) : bits(value) {}
    constexpr basic_int128(std::int64_t value)
        : bits(value < 0 ? -Unsigned(std::uint64_t{0} - static_cast<std::uint64_t>(value))
                         : Unsigned(static_cast<std::uint64_t>(value))) {}

    constexpr bool negative() const { return static_cast<std::uint64_t>(bits >> 127) != 0; }
    constexpr Unsigned magnitude() const { return negative() ? -bits : bits; }
    constexpr std::int64_t low() const { return static_cast<std::int64_t>(static_cast<std::uint64_t>(bits)); }
};

template <class Unsigned>
constexpr basic_int128<Unsigned> operator+(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return basic_int128<Unsigned>(a.bits + b.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator-(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return basic_int128<Unsigned>(a.bits - b.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator-(basic_int128<Unsigned> a) {
    return basic_int128<Unsigned>(-a.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator<<(basic_int128<Unsigned> a, int n) {
    return basic_int128<Unsigned>(a.bits << n);
}
/// Arithmetic shift: rounds towards minus infinity.
template <class Unsigned>
constexpr basic_int128<Unsigned> operator>>(basic_int128<Unsigned> a, int n) {
    return basic_int128<Unsigned>(shift_signed(a.bits, n));
}
template <class Unsigned>
constexpr bool operator==(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return a.bits == b.bits;
}
template <class Unsigned>
constexpr bool operator<(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return a.negative() != b.negative() ? a.negative() : a.bits < b.bits;
}
template <class Unsigned>
constexpr bool operator>(basic_int128<Unsigned> a, basic_int128<Unsigned> b) { return b < a; }
template <class Unsigned>
constexpr bool operator<=(basic_int128<Unsigned> a, basic_int128<Unsigned> b) { return !(b < a); }
template <class Unsigned>
constexpr bool operator>=(basic_int128<Unsigned> a, basic_int128<Unsigned> b) { return !(a < b); }

using int128 = basic_int128<uint128>;

constexpr int128 product128(std::int64_t a, std::int64_t b) {
#if PHYSICS_HPP_INT128
    return int128(static_cast<uint128>(static_cast<native_int128>(a) * b));
#else
    // The product of the bit patterns is too large by 2^64 times the other factor for each negative one.
    const std::uint64_t ua = static_cast<std::uint64_t>(a), ub = static_cast<std::uint64_t>(b);
    uint128 result = product128(ua, ub);
    result.high -= (a < 0 ? ub : 0) + (b < 0 ? ua : 0);
    return int128(result);
#endif
}

/// a / 2^n to nearest, ties away from zero; n from 1 to 126. Symmetric: f(-a) == -f(a).
template <class Unsigned>
constexpr basic_int128<Unsigned> shift_nearest(basic_int128<Unsigned> a, int n) {
    const basic_int128<Unsigned> half = basic_int128<Unsigned>(Unsigned(1) << (n - 1));
    return (a + half - basic_int128<Unsigned>(std::int64_t{a.negative()})) >> n;
}

constexpr std::int64_t shift_nearest(std::int64_t a, int n) {
    const std::int64_t half = std::int64_t{1} << (n - 1);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(half) -
                                     static_cast<std::uint64_t>(a < 0)) >>
           n;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/root.hpp
// =================================================================================================
// Square roots by the processor, and of 128-bit integers.

#if !defined(__GNUC__)
#include <cmath>
#endif

PHYSICS_HPP_BEGIN

namespace detail {

// __builtin_sqrt tests for negative arguments and calls the C library for errno's sake; the instruction does not.
#if defined(__SSE2__) && defined(__has_builtin)
#if __has_builtin(__builtin_ia32_sqrtsd) && __has_builtin(__builtin_ia32_sqrtss)
#define PHYSICS_HPP_SQRT_INSTRUCTION
#endif
#endif

/// The correctly rounded square root; NaN of negative numbers.
inline double hardware_root(double x) {
#if defined(PHYSICS_HPP_SQRT_INSTRUCTION)
    typedef double lanes __attribute__((vector_size(16)));
    return __builtin_ia32_sqrtsd(lanes{x, 0})[0];
#elif defined(__GNUC__)
    return __builtin_sqrt(x);
#else
    return std::sqrt(x);
#endif
}
inline float hardware_root(float x) {
#if defined(PHYSICS_HPP_SQRT_INSTRUCTION)
    typedef float lanes __attribute__((vector_size(16)));
    return __builtin_ia32_sqrtss(lanes{x, 0, 0, 0})[0];
#elif defined(__GNUC__)
    return __builtin_sqrtf(x);
#else
    return std::sqrt(x);
#endif
}
#undef PHYSICS_HPP_SQRT_INSTRUCTION

/// A square root rounded down, and what it leaves: a == root^2 + rest, 0 <= rest <= 2 root.
struct integer_root {
    std::uint64_t root = 0;
    uint128 rest{};
    /// The root to nearest; it is never a tie.
    constexpr std::uint64_t nearest() const { return root + std::uint64_t{rest > uint128(root)}; }
};

/// Two bits of a a round: for constant expressions, and for numbers above 125 bits.
constexpr integer_root root_by_digits(uint128 a) {
    uint128 root{}, rest = a;
    for (uint128 bit = uint128(std::uint64_t{1}) << 126; bit > uint128(std::uint64_t{0}); bit = bit >> 2) {
        const uint128 least = root + bit;
        root = root >> 1;
        if (rest >= least) {
            rest = rest - least;
            root = root + bit;
        }
    }
    return {low_half(root), rest};
}

/// The root of up to 125 bits: a hardware double gives its first 53 bits, a Newton step in doubles the others,
/// and integers repair the last unit, so that nothing depends on the floating-point environment. ~5 ns.
inline integer_root root_by_double(uint128 a) {
    const std::uint64_t high = high_half(a), low = low_half(a);
    if (high == 0 && low >> 62 == 0) {
        const std::int64_t whole = static_cast<std::int64_t>(low);
        std::int64_t root = static_cast<std::int64_t>(hardware_root(static_cast<double>(whole)));
        std::int64_t rest = whole - root * root;
        while (rest < 0) rest += 2 * --root + 1;
        while (rest > 2 * root) rest -= 2 * root++ + 1;
        return {static_cast<std::uint64_t>(root), uint128(static_cast<std::uint64_t>(rest))};
    }
    const double leading = static_cast<double>(static_cast<std::int64_t>(high)) * 0x1p64 +
                           static_cast<double>(static_cast<std::int64_t>(low >> 1)) * 2;
    // A guess that is a little too low makes the step positive, so that truncation is almost always right.
    const double guess = hardware_root(leading) * (1 - 0x1p-50);
    const double slope = 32768 / guess;
    std::uint64_t root = static_cast<std::uint64_t>(static_cast<std::int64_t>(guess));
    const int128 first_rest(a - product128(root, root));
    // |first_rest| < 2^77, since the guess is off by 2^13 at most.
    root +=
        static_cast<std::uint64_t>(static_cast<std::int64_t>(static_cast<double>((first_rest >> 16).low()) * slope));
    int128 rest(a - product128(root, root));
    while (rest.negative()) {
        --root;
        rest = rest + int128((uint128(root) << 1) + uint128(std::uint64_t{1}));
    }
    while (rest.bits > uint128(root) << 1) {
        rest = rest - int128((uint128(root) << 1) + uint128(std::uint64_t{1}));
        ++root;
    }
    return {root, rest.bits};
}

constexpr integer_root root_of(uint128 a) {
    return std::is_constant_evaluated() || bit_width(a) > 125 ? root_by_digits(a) : root_by_double(a);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/fixed.hpp
// =================================================================================================
// Fixed-point numbers with exact wide products: integers only, hence the same bits by construction.

PHYSICS_HPP_BEGIN

/// How many fixed-point results left their range on this thread since the last reset: sums and products
/// that wrapped, and quotients, roots and conversions that saturated. Counts only where the user defines
/// PHYSICS_HPP_AUDIT; always 0 otherwise.
std::uint64_t overflow_count() noexcept;
/// Sets this thread's overflow_count back to 0.
void reset_overflow_count() noexcept;

namespace detail {

#ifdef PHYSICS_HPP_AUDIT
inline thread_local std::uint64_t overflow_counter = 0;
#endif

constexpr void note_overflow([[maybe_unused]] bool happened) noexcept {
#ifdef PHYSICS_HPP_AUDIT
    if (!std::is_constant_evaluated() && happened) ++overflow_counter;
#endif
}

/// The integer that holds a product of two representations exactly.
template <class A, class B>
using product_integer = std::conditional_t<sizeof(A) == 4 && sizeof(B) == 4, std::int64_t, int128>;

constexpr std::int64_t low_word(std::int64_t a) { return a; }
constexpr std::int64_t low_word(int128 a) { return a.low(); }

template <class Rep, class Int>
constexpr bool fits(Int a) {
    return a >= Int(std::int64_t{std::numeric_limits<Rep>::min()}) &&
           a <= Int(std::int64_t{std::numeric_limits<Rep>::max()});
}

/// Takes the low bits, so that a result out of range wraps; the audit counts it.
template <class Rep, class Int>
constexpr Rep wrap(Int a) {
    note_overflow(!fits<Rep>(a));
    return static_cast<Rep>(low_word(a));
}

template <class Rep>
constexpr Rep saturated(bool negative) {
    note_overflow(true);
    return negative ? std::numeric_limits<Rep>::min() : std::numeric_limits<Rep>::max();
}

/// sign * magnitude, saturating.
template <class Rep>
constexpr Rep signed_saturating(bool negative, std::uint64_t magnitude) {
    const std::uint64_t most = static_cast<std::uint64_t>(std::numeric_limits<Rep>::max()) + std::uint64_t{negative};
    if (magnitude > most) return saturated<Rep>(negative);
    return static_cast<Rep>(static_cast<std::int64_t>(negative ? std::uint64_t{0} - magnitude : magnitude));
}
template <class Rep>
constexpr Rep signed_saturating(bool negative, uint128 magnitude) {
    return high_half(magnitude) != 0 ? saturated<Rep>(negative) : signed_saturating<Rep>(negative, low_half(magnitude));
}

constexpr std::uint64_t magnitude64(std::int64_t a) {
    return a < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(a) : static_cast<std::uint64_t>(a);
}
constexpr uint128 magnitude128(std::int64_t a) { return uint128(magnitude64(a)); }
constexpr uint128 magnitude128(int128 a) { return a.magnitude(); }

/// 0 / 0 is 0; other numbers by zero saturate.
template <class Rep>
constexpr Rep quotient_by_zero(bool negative, bool of_zero) {
    if (!of_zero) return saturated<Rep>(negative);
    note_overflow(true);
    return 0;
}

/// n * 2^shift / d to nearest, ties away from zero, saturating; shift from 1 to 63. One hardware division.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, std::uint64_t n, int shift, std::uint64_t d) {
    if (d == 0) return quotient_by_zero<Rep>(negative, n == 0);
    const std::uint64_t high = n >> (64 - shift);
    if (high >= d) return saturated<Rep>(negative);
    std::uint64_t rest = 0;
    const std::uint64_t quotient = divide128(high, n << shift, d, rest);
    // No carry out of 64 bits: where the quotient is that large d <= 2^shift, of which the dividend is a multiple.
    return signed_saturating<Rep>(negative, quotient + std::uint64_t{rest >= d - rest});
}

/// a * 2^shift / b to nearest, ties away from zero, saturating; shift from -126 up, a and b up to 2^127.
/// Exact: where a * 2^shift has more than 128 bits, the division goes on with the rest, as many bits a round
/// as there is room for.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, uint128 a, int shift, uint128 b) {
    if (b == uint128(0)) return quotient_by_zero<Rep>(negative, a == uint128(0));
    uint128 quotient{}, rest = a;
    do {
        const int room = 128 - bit_width(rest | uint128(1));
        const int step = shift < 0 ? 0 : shift < room ? shift : room;
        if (bit_width(quotient) + step > 127) return saturated<Rep>(negative);
        const uint128 dividend = rest << step;
        quotient = (quotient << step) + divide128(dividend, b, rest);
        shift -= step;
    } while (shift > 0);
    if (shift < 0) return signed_saturating<Rep>(negative, ((quotient >> (-shift - 1)) + uint128(1)) >> 1);
    return signed_saturating<Rep>(negative, rest >= b - rest ? quotient + uint128(1) : quotient);
}

}  // namespace detail

/// An exact product of two fixed-point numbers, or a sum of such: compare it as it is, or narrow it once.
/// Range: 128 bits for 64-bit operands, 64 for 32-bit ones; wraps beyond.
template <class Int, int FractionBits>
struct wide_fixed {
    Int raw{};
};

namespace detail {
constexpr int128 wide_sum(int128 a, int128 b) { return a + b; }
constexpr std::int64_t wide_sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
constexpr int128 wide_negated(int128 a) { return -a; }
constexpr std::int64_t wide_negated(std::int64_t a) {
    return static_cast<std::int64_t>(std::uint64_t{0} - static_cast<std::uint64_t>(a));
}
}  // namespace detail

template <class Int, int F>
constexpr wide_fixed<Int, F> operator+(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return {detail::wide_sum(a.raw, b.raw)};
}
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a + -b; }
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a) { return {detail::wide_negated(a.raw)}; }
template <class Int, int F>
constexpr bool operator==(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a.raw == b.raw; }
template <class Int, int F>
constexpr bool operator<(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a.raw < b.raw; }
template <class Int, int F>
constexpr bool operator>(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return b.raw < a.raw; }
template <class Int, int F>
constexpr bool operator<=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return !(b.raw < a.raw); }
template <class Int, int F>
constexpr bool operator>=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return !(a.raw < b.raw); }

/// A fixed-point number: an integer of type Rep that counts units of 2^-FractionBits.
/// Sums and products wrap, quotients, roots and conversions saturate, all rounding is to nearest with ties
/// away from zero, so that f(-x) == -f(x). Every operation is exact integer arithmetic: no result depends
/// on compiler, processor or floating-point environment. Cost: sums as integers, product 1 ns,
/// quotient 2-4 ns, root 3-8 ns (two to three times that where there is no __int128).
template <class Rep, int FractionBits>
class fixed {
    static_assert(std::is_same_v<Rep, std::int32_t> || std::is_same_v<Rep, std::int64_t>,
                  "physics::fixed: the representation must be std::int32_t or std::int64_t");
    static_assert(
        FractionBits > 0 && FractionBits < std::numeric_limits<Rep>::digits,
        "physics::fixed: the fraction must have at least one bit and leave at least one for the integer part");

public:
    using rep = Rep;
    static constexpr int fraction_bits = FractionBits;

    constexpr fixed() = default;
    /// From an integer; saturates.
    template <std::integral Integer>
    constexpr explicit fixed(Integer value) : raw_(from_integer(static_cast<std::int64_t>(value))) {
        static_assert(sizeof(Integer) < 8 || std::is_signed_v<Integer>,
                      "physics::fixed: converts from integers that fit in std::int64_t");
    }
    /// From a floating-point number, to nearest; saturates, and takes NaN as 0 (both counted by the audit).
    template <std::floating_point Real>
    constexpr explicit fixed(Real value) : raw_(from_double(static_cast<double>(value))) {}
    /// From another format, to nearest; saturates.
    template <class OtherRep, int OtherBits>
    constexpr explicit fixed(fixed<OtherRep, OtherBits> other) : raw_(from_fixed(other.raw(), OtherBits)) {}

    static constexpr fixed from_raw(Rep raw) {
        fixed result;
        result.raw_ = raw;
        return result;
    }
    [[nodiscard]] constexpr Rep raw() const { return raw_; }

    constexpr explicit operator double() const { return static_cast<double>(raw_) * unit; }
    constexpr explicit operator float() const { return static_cast<float>(raw_) * static_cast<float>(unit); }
    /// The integer part, towards zero; saturates.
    constexpr explicit operator int() const {
        const Rep whole = raw_ / (Rep{1} << FractionBits);
        return detail::fits<int>(std::int64_t{whole}) ? static_cast<int>(whole) : detail::saturated<int>(raw_ < 0);
    }

    constexpr fixed& operator+=(fixed other) { return *this = add(raw_, other.raw_); }
    constexpr fixed& operator-=(fixed other) { return *this = subtract(raw_, other.raw_); }
    constexpr fixed& operator*=(fixed other) {
        return *this = from_raw(
                   detail::wrap<Rep>(detail::shift_nearest(raw_product(raw_, other.raw_), FractionBits)));
    }
    constexpr fixed& operator/=(fixed other) {
        return *this = from_raw(detail::scaled_quotient<Rep>((raw_ < 0) != (other.raw_ < 0), detail::magnitude64(raw_),
                                                             FractionBits, detail::magnitude64(other.raw_)));
    }

private:
    using limits = std::numeric_limits<Rep>;
    using unsigned_rep = std::make_unsigned_t<Rep>;
    static constexpr double unit = 1.0 / static_cast<double>(std::int64_t{1} << FractionBits);

    static constexpr detail::int128 raw_product(std::int64_t a, std::int64_t b) { return detail::product128(a, b); }
    static constexpr std::int64_t raw_product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }

    static constexpr fixed add(Rep a, Rep b) {
        const Rep sum = static_cast<Rep>(static_cast<unsigned_rep>(a) + static_cast<unsigned_rep>(b));
        detail::note_overflow((a < 0) == (b < 0) && (sum < 0) != (a < 0));
        return from_raw(sum);
    }
    static constexpr fixed subtract(Rep a, Rep b) {
        const Rep difference = static_cast<Rep>(static_cast<unsigned_rep>(a) - static_cast<unsigned_rep>(b));
        detail::note_overflow((a < 0) != (b < 0) && (difference < 0) != (a < 0));
        return from_raw(difference);
    }
    static constexpr Rep from_integer(std::int64_t value) {
        const std::int64_t most = static_cast<std::int64_t>(limits::max() >> FractionBits);
        if (value > most || value < -most - 1) return detail::saturated<Rep>(value < 0);
        return static_cast<Rep>(value * (std::int64_t{1} << FractionBits));
    }
    static constexpr Rep from_double(double value) {
        constexpr double end = -static_cast<double>(limits::min());
        const double scaled = value * static_cast<double>(std::int64_t{1} << FractionBits);
        // Next to the ends of a 64-bit representation doubles are whole, so there is no half to round.
        const bool inside =
            sizeof(Rep) == 4 ? scaled > -end - 0.5 && scaled < end - 0.5 : scaled >= -end && scaled < end;
        if (!inside) return value != value ? (detail::note_overflow(true), Rep{0}) : detail::saturated<Rep>(value < 0);
        const std::int64_t whole = static_cast<std::int64_t>(scaled);
        const double rest = scaled - static_cast<double>(whole);
        return static_cast<Rep>(whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0));
    }
    static constexpr Rep from_fixed(std::int64_t raw, int bits) {
        if (bits >= FractionBits) {
            const std::int64_t rounded =
                bits == FractionBits ? raw : detail::shift_nearest(detail::int128(raw), bits - FractionBits).low();
            return detail::fits<Rep>(rounded) ? static_cast<Rep>(rounded) : detail::saturated<Rep>(raw < 0);
        }
        return detail::signed_saturating<Rep>(raw < 0, detail::magnitude128(raw) << (FractionBits - bits));
    }

    Rep raw_ = 0;
};

// Operators stand outside of their classes, here and wherever they compute: gcc takes friends that are defined within
// a class template out of the determinism region, and then neither keeps products apart in them nor inlines into them.
template <class Rep, int F>
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a, fixed<Rep, F> b) { return a += b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a, fixed<Rep, F> b) { return a -= b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator*(fixed<Rep, F> a, fixed<Rep, F> b) { return a *= b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator/(fixed<Rep, F> a, fixed<Rep, F> b) { return a /= b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a) { return fixed<Rep, F>() -= a; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a) { return a; }
template <class Rep, int F>
constexpr bool operator==(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() == b.raw(); }
template <class Rep, int F>
constexpr bool operator!=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() != b.raw(); }
template <class Rep, int F>
constexpr bool operator<(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() < b.raw(); }
template <class Rep, int F>
constexpr bool operator>(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() > b.raw(); }
template <class Rep, int F>
constexpr bool operator<=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() <= b.raw(); }
template <class Rep, int F>
constexpr bool operator>=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() >= b.raw(); }

/// Q32.32, the default fixed point: range +-2.1e9, step 2.3e-10.
using fixed32 = fixed<std::int64_t, 32>;
/// Q48.16, for huge worlds: range +-1.4e14, step 1.5e-5.
using fixed48 = fixed<std::int64_t, 16>;
/// Q16.16, for particles and toys: range +-32,768, step 1.5e-5. A contact solver's impulses leave its range
/// in all but small scenes.
using fixed16 = fixed<std::int32_t, 16>;

template <class A, int FA, class B, int FB>
constexpr auto product(fixed<A, FA> a, fixed<B, FB> b) {
    using integer = detail::product_integer<A, B>;
    if constexpr (std::is_same_v<integer, std::int64_t>) {
        return wide_fixed<integer, FA + FB>{std::int64_t{a.raw()} * b.raw()};
    } else {
        return wide_fixed<integer, FA + FB>{detail::product128(std::int64_t{a.raw()}, std::int64_t{b.raw()})};
    }
}

namespace detail {
template <class Rep, int FractionBits>
constexpr std::int64_t raw_of(fixed<Rep, FractionBits> a) {
    return a.raw();
}
template <class Int, int FractionBits>
constexpr Int raw_of(wide_fixed<Int, FractionBits> a) {
    return a.raw;
}
}  // namespace detail

/// The wide number in format R, to nearest; wraps.
template <class R, class Int, int FractionBits>
constexpr R narrow(wide_fixed<Int, FractionBits> a) {
    constexpr int shift = FractionBits - R::fraction_bits;
    static_assert(shift > 0, "physics::narrow: the result must have fewer fraction bits than the product");
    return R::from_raw(detail::wrap<typename R::rep>(detail::shift_nearest(a.raw, shift)));
}

/// numerator / denominator in format R, to nearest; saturates. Operands are fixed or wide.
template <class R, template <class, int> class N, class RepN, int FN, template <class, int> class D, class RepD, int FD>
constexpr R quotient(N<RepN, FN> numerator, D<RepD, FD> denominator) {
    const auto n = detail::raw_of(numerator);
    const auto d = detail::raw_of(denominator);
    const bool negative = (n < decltype(n)(std::int64_t{0})) != (d < decltype(d)(std::int64_t{0}));
    return R::from_raw(detail::scaled_quotient<typename R::rep>(negative, detail::magnitude128(n),
                                                                R::fraction_bits + FD - FN, detail::magnitude128(d)));
}

/// The square root of a wide number in format R, to nearest; 0 for negative numbers (counted by the audit).
template <class R, class Int, int FractionBits>
constexpr R root(wide_fixed<Int, FractionBits> a) {
    constexpr int shift = 2 * R::fraction_bits - FractionBits;
    static_assert(shift <= 0 && shift % 2 == 0,
                  "physics::root: the operand must have at least twice the result's fraction bits");
    if (a < wide_fixed<Int, FractionBits>{}) return detail::note_overflow(true), R{};
    const detail::integer_root found = detail::root_of(detail::magnitude128(a.raw));
    if constexpr (shift == 0)
        return R::from_raw(detail::signed_saturating<typename R::rep>(false, found.nearest()));
    else
        return R::from_raw(
            detail::signed_saturating<typename R::rep>(false, ((found.root >> (-shift / 2 - 1)) + 1) >> 1));
}

inline std::uint64_t overflow_count() noexcept {
#ifdef PHYSICS_HPP_AUDIT
    return detail::overflow_counter;
#else
    return 0;
#endif
}
inline void reset_overflow_count() noexcept {
#ifdef PHYSICS_HPP_AUDIT
    detail::overflow_counter = 0;
#endif
}

PHYSICS_HPP_END

// =================================================================================================
// physics/base/handle.hpp
// =================================================================================================
// Names of things in a world that know when the thing is gone.

PHYSICS_HPP_BEGIN

/// A small value that names a body, a shape... of one world. It stays unique when its slot is used again,
/// and a world recognises handles of another. The default one is null.
template <class Tag>
struct handle {
    std::uint32_t index = 0xffffffffu;
    std::uint16_t generation = 0;
    std::uint16_t world = 0;

    /// False for the null handle; true says nothing about whether the thing still lives.
    constexpr explicit operator bool() const { return index != 0xffffffffu; }
    friend bool operator==(handle, handle) = default;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/base/math_reduce.hpp
// =================================================================================================
// Angles modulo a quarter turn, exactly enough for any finite number.

PHYSICS_HPP_BEGIN

namespace detail {

/// The unevaluated sum of two doubles, the second far below the first: ~106 bits.
struct double_pair {
    double high = 0;
    double low = 0;
};

/// a + b without error (Knuth, The Art of Computer Programming 2, 4.2.2).
constexpr double_pair two_sum(double a, double b) {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}
/// a + b without error where |a| >= |b| (Dekker 1971).
constexpr double_pair fast_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}
/// a * b without error, for magnitudes from 2^-450 to 2^450 (Veltkamp's split, Dekker 1971). A fused
/// multiply-add would be shorter, but where the processor has none it is a slow call.
constexpr double_pair two_product(double a, double b) {
    constexpr double splitter = 134217729;  // 2^27 + 1
    const double a_scaled = a * splitter, b_scaled = b * splitter;
    const double a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double product = a * b;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// 2^n as a double; n from -1022 to 1023.
constexpr double power_of_two(int n) { return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52); }

/// The integer nearest to x; ties away from zero. |x| < 2^31.
constexpr int nearest_int(double x) { return static_cast<int>(x < 0 ? x - 0.5 : x + 0.5); }

/// 2 / pi, 1,216 bits after the binary point; the word of zeros before it serves small arguments.
inline constexpr std::uint64_t two_over_pi[] = {
    0x0000000000000000, 0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561,
    0xb7246e3a424dd2e0, 0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41,
    0x3991d639835339f4, 0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d, 0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab};
/// pi / 2 in units of 2^-63.
inline constexpr std::uint64_t half_pi_word = 0xc90fdaa22168c235;

/// An angle as a number of quarter turns (only the last two bits count) and a rest of at most pi / 4.
struct reduced_angle {
    unsigned quadrant = 0;
    double high = 0;
    double low = 0;
};

/// For |x| >= 1. The method of Payne & Hanek (1983), in integers: x = m * 2^e, and of 2/pi only the 192 bits
/// count that are neither multiples of 4 after the product nor below 2^-137. No double comes closer than
/// 2^-62 to a multiple of pi/2 (relative to pi/2), so 64 good bits remain. ~15 ns.
PHYSICS_HPP_COLD constexpr reduced_angle reduce_huge(double x) {
    const std::uint64_t word = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t m = (word & 0xfffffffffffffu) | 0x10000000000000u;
    const int e = static_cast<int>((word >> 52) & 0x7ff) - 1075;
    const int first = e - 2 + 64;
    const std::uint64_t* words = two_over_pi + first / 64;
    const int shift = first % 64;
    std::uint64_t window[3] = {};
    for (int i = 0; i < 3; ++i)
        window[i] = shift == 0 ? words[i] : (words[i] << shift) | (words[i + 1] >> (64 - shift));

    const uint128 low = product128(m, window[2]);
    const uint128 middle = product128(m, window[1]) + uint128(high_half(low));
    const std::uint64_t top = m * window[0] + high_half(middle);
    // The binary point is below the top two bits, which hold the quarter turns.
    unsigned quadrant = static_cast<unsigned>(top >> 62);
    uint128 turn = (uint128(top) << 66) | (uint128(low_half(middle)) << 2) | uint128(low_half(low) >> 62);
    bool negative = high_half(turn) >> 63 != 0;
    if (negative) {
        ++quadrant;
        turn = -turn;
    }
    const int zeros = 128 - bit_width(turn);
    const std::uint64_t angle = mul_high(high_half(turn << zeros), half_pi_word);
    const double scale = power_of_two(-63 - zeros);
    double_pair rest = fast_two_sum(static_cast<double>(static_cast<std::int64_t>(angle >> 11)) * 2048,
                                    static_cast<double>(static_cast<std::int64_t>(angle & 2047)));
    if (x < 0) {
        quadrant = 0u - quadrant;
        negative = !negative;
    }
    const double unit = negative ? -scale : scale;
    return {quadrant, rest.high * unit, rest.low * unit};
}

/// For every finite x. Cody & Waite (1980): pi/2 in parts of 33, 33 and 53 bits, so that the first two
/// products are exact up to 2^20 quarter turns; where the rest nearly vanishes, integers take over.
/// Relative error of high + low < 2^-62, or < 2^-30 where not precise.
template <bool Precise>
constexpr reduced_angle reduce(double x) {
    const double size = x < 0 ? -x : x;
    if (size <= 0x1.921fb54442d18p-1) return {0, x, 0};
    if (size < 0x1p20) {
        const int turns = nearest_int(x * 0x1.45f306dc9c883p-1);
        const double n = static_cast<double>(turns);
        const double first = x - n * 0x1.921fb544p+0;
        if constexpr (!Precise) {
            return {static_cast<unsigned>(turns), first - n * 0x1.0b4611a626331p-34, 0};
        } else {
            const double_pair second = two_sum(first, -(n * 0x1.0b4611a6p-34));
            const double_pair rest = fast_two_sum(second.high, second.low - n * 0x1.3198a2e037073p-69);
            if (rest.high > 0x1p-30 || rest.high < -0x1p-30) return {static_cast<unsigned>(turns), rest.high, rest.low};
        }
    }
    // Field by field, so that compilers keep the common case in registers.
    const reduced_angle huge = reduce_huge(x);
    return {huge.quadrant, huge.high, huge.low};
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/math_fixed.hpp
// =================================================================================================
// Elementary functions of fixed point: 64-bit integers, every format from one set of series.

PHYSICS_HPP_BEGIN

// Inside, numbers from 0 to 1 are counts of 2^-64, so that a product is the upper half of an integer product.
// The series are Taylor's, on ranges so short that a minimax fit would save one term; each format takes the
// terms that it can see. What is odd or symmetric is computed from magnitudes, hence f(-x) == -f(x) exactly.

namespace detail {

/// (pi/4)^(2k+1) / (2k+1)!: the sine of z^(1/2) eighths of a turn, over z^(1/2), with alternating signs.
inline constexpr std::uint64_t fixed_sine_series[] = {
    0xc90fdaa22168c235, 0x14abbce625be52bf, 0x00a335e33bad570f, 0x000265a599cc57b1, 0x00000541e0d21fba,
    0x000000078c1d3f7a, 0x0000000007a3d0d3, 0x000000000005beb7, 0x0000000000000356, 0x0000000000000002};
/// (pi/4)^(2k) / (2k)!, k from 1: one minus that cosine, over z, with alternating signs.
inline constexpr std::uint64_t fixed_cosine_series[] = {0x4ef4f326f9177969, 0x040f07c206d6b0ed, 0x00155d3c7e3cbffa,
                                                        0x00003c3ea0d12375, 0x00000069b47ca881, 0x000000007e74e28e,
                                                        0x00000000006db894, 0x0000000000004832, 0x0000000000000025};
/// 16 (log(2)/16)^k / k!, k from 1: 16 (2^(g/16) - 1), over g; the factor keeps four more bits.
inline constexpr std::uint64_t fixed_exp_series[] = {
    0xb17217f7d1cf79ac, 0x03d7f7bff058b1d5, 0x000e35846b825060, 0x0000276556df749d, 0x0000005761ff9e2a,
    0x00000000a184897c, 0x0000000000ffe5fe, 0x00000000000162c0, 0x00000000000001b5, 0x0000000000000002};
/// 2^(i/16) - 1.
inline constexpr std::uint64_t fixed_powers[] = {
    0x0000000000000000, 0x0b5586cf9890f62a, 0x172b83c7d517adce, 0x2387a6e75623866c,
    0x306fe0a31b7152df, 0x3dea64c12342235b, 0x4bfdad5362a271d4, 0x5ab07dd48542958d,
    0x6a09e667f3bcc909, 0x7a11473eb0186d7d, 0x8ace5422aa0db5ba, 0x9c49182a3f0901c8,
    0xae89f995ad3ad5e8, 0xc199bdd85529c222, 0xd5818dcfba48725e, 0xea4afa2a490d9859};

/// How many coefficients of a series on [0, 1] reach 2^-(bits + 7).
template <int N>
constexpr int terms_above(int bits, const std::uint64_t (&c)[N]) {
    int n = 1;
    while (n < N && (bits >= 57 || c[n] >> (57 - bits) != 0)) ++n;
    return n;
}
/// c[0] - z (c[1] - z (c[2] - ...)), or with sums instead.
template <int Terms, bool Alternating, int I = 0, int N>
constexpr std::uint64_t series(std::uint64_t z, const std::uint64_t (&c)[N]) {
    if constexpr (I + 1 >= Terms) {
        return c[I];
    } else {
        const std::uint64_t rest = mul_high(z, series<Terms, Alternating, I + 1>(z, c));
        return Alternating ? c[I] - rest : c[I] + rest;
    }
}
/// z (1/3 - z (1/5 - z (1/7 - ...))), or with sums instead: what atan u = u (1 - ...) and atanh u = u (1 + ...)
/// have beyond u, z = u^2. Enough terms for |u| < 0.172.
template <int FractionBits, bool Alternating, int I = 1>
constexpr std::uint64_t reciprocal_series(std::uint64_t z) {
    constexpr std::uint64_t c = ~std::uint64_t{0} / (2 * I + 1);
    if constexpr (I > (FractionBits + 4) / 6) {
        return mul_high(z, c);
    } else {
        const std::uint64_t rest = reciprocal_series<FractionBits, Alternating, I + 1>(z);
        return mul_high(z, Alternating ? c - rest : c + rest);
    }
}

/// A count of 2^-64 as one of 2^-FractionBits, to nearest.
template <int FractionBits>
constexpr std::uint64_t rounded(std::uint64_t a) {
    return ((a >> (63 - FractionBits)) + 1) >> 1;
}
/// A count of 2^-Bits as one of 2^-FractionBits, to nearest.
template <int FractionBits, int Bits>
constexpr uint128 rounded(uint128 a) {
    return ((a >> (Bits - 1 - FractionBits)) + uint128(std::uint64_t{1})) >> 1;
}
constexpr uint128 words128(std::uint64_t high, std::uint64_t low) { return (uint128(high) << 64) | uint128(low); }

/// An angle in eighths of a turn from the nearest axis, as a count of 2^-128, below 1.
struct fixed_angle {
    bool swapped;        // the nearest axis is the vertical one: sine and cosine change places
    bool sine_negative;  // for positive angles
    bool cosine_negative;
    uint128 eighths;
};

/// Multiplies by 2/pi. One word of it for 32-bit numbers and two for 64-bit ones leave an error below 2^-32 of the
/// format's step; with one more, the angle is right to 64 bits wherever its tangent is in range.
template <class Rep, int FractionBits, bool Fine = false>
constexpr fixed_angle reduce(Rep raw) {
    const std::uint64_t m = magnitude64(raw);
    constexpr int words = (sizeof(Rep) == 4 ? 1 : 2) + Fine;
    uint128 turns = product128(m, two_over_pi[1]), low{};
    if constexpr (words > 1) {
        low = product128(m, two_over_pi[2]);
        if constexpr (words > 2) low = low + uint128(mul_high(m, two_over_pi[3]));
        turns = turns + uint128(high_half(low));
    }
    const uint128 fraction = (turns << (64 - FractionBits)) | uint128(low_half(low) >> FractionBits);
    const unsigned quadrant = static_cast<unsigned>(low_half(turns >> (64 + FractionBits)) & 3);
    const bool upper = high_half(fraction) >> 63 != 0;
    // ~ for -: an exact half stays below 1.
    return {upper != ((quadrant & 1) != 0), (quadrant & 2) != 0, ((quadrant + 1) & 2) != 0,
            (upper ? ~fraction : fraction) << 1};
}

/// The sine of p eighths of a turn over p, z = p^2.
template <int Bits>
constexpr std::uint64_t fixed_sine_ratio(std::uint64_t z) {
    return series<terms_above(Bits, fixed_sine_series), true>(z, fixed_sine_series);
}
/// One minus the cosine of p eighths of a turn.
template <int Bits>
constexpr std::uint64_t fixed_versine(std::uint64_t z) {
    return mul_high(z, series<terms_above(Bits, fixed_cosine_series), true>(z, fixed_cosine_series));
}

template <class Rep>
constexpr Rep with_sign(bool negative, std::uint64_t magnitude) {
    const Rep value = static_cast<Rep>(magnitude);
    return negative ? static_cast<Rep>(-value) : value;
}

/// Sine of a reduced angle, or its cosine where swapped.
template <int FractionBits>
constexpr std::uint64_t fixed_wave(uint128 eighths, bool swapped) {
    const std::uint64_t p = high_half(eighths), z = mul_high(p, p);
    if (swapped) return (std::uint64_t{1} << FractionBits) - rounded<FractionBits>(fixed_versine<FractionBits>(z));
    return rounded<FractionBits>(mul_high(p, fixed_sine_ratio<FractionBits>(z)));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_sine(Rep raw) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    return with_sign<Rep>(a.sine_negative != (raw < 0), fixed_wave<FractionBits>(a.eighths, a.swapped));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_cosine(Rep raw) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    return with_sign<Rep>(a.cosine_negative, fixed_wave<FractionBits>(a.eighths, !a.swapped));
}
template <class Rep, int FractionBits>
constexpr void fixed_sine_and_cosine(Rep raw, Rep& sine, Rep& cosine) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    sine = with_sign<Rep>(a.sine_negative != (raw < 0), fixed_wave<FractionBits>(a.eighths, a.swapped));
    cosine = with_sign<Rep>(a.cosine_negative, fixed_wave<FractionBits>(a.eighths, !a.swapped));
}

/// Near a pole the result has all the bits of Rep, so the sine is normalised before its last digits are dropped.
template <class Rep, int FractionBits>
constexpr Rep fixed_tangent(Rep raw) {
    constexpr int bits = std::numeric_limits<Rep>::digits;
    const fixed_angle a = reduce<Rep, FractionBits, true>(raw);
    const bool negative = (a.sine_negative != a.cosine_negative) != (raw < 0);
    const std::uint64_t p = high_half(a.eighths), z = mul_high(p, p);
    const std::uint64_t ratio = fixed_sine_ratio<bits>(z), versine = fixed_versine<bits>(z);
    const std::uint64_t cosine = versine == 0 ? ~versine : std::uint64_t{0} - versine;
    if (!a.swapped) return scaled_quotient<Rep>(negative, mul_high(p, ratio), FractionBits, cosine);
    const int zeros = 128 - bit_width(a.eighths);
    if (zeros + FractionBits > 63) return saturated<Rep>(negative);
    const std::uint64_t sine =
        high_half(product128(high_half(a.eighths << zeros), ratio) + (uint128(std::uint64_t{1}) << 63));
    return scaled_quotient<Rep>(negative, cosine, zeros + FractionBits, sine);
}

/// atan(n / d) as a count of 2^-126, for n <= d. Subtracts the nearest of atan(0, 1/4, 1/2, 1), since
/// atan(n/d) - atan(c) = atan((n - c d) / (d + c n)); |u| <= 0.164 remains.
template <int FractionBits>
constexpr uint128 fixed_arctangent(std::uint64_t n, std::uint64_t d) {
    if (n == 0) return uint128(std::uint64_t{0});
    const int zeros = std::countl_zero(d);
    n <<= zeros;
    d <<= zeros;
    uint128 known{}, top = uint128(n) << 2, bottom = uint128(d) << 2;
    bool below = false;
    if (n > d / 8) {
        const int shift = n > d / 32 * 23 ? 2 : n > d / 8 * 3 ? 1 : 0;
        known = shift == 2   ? words128(0x3243f6a8885a308d, 0x313198a2e0370734)
                : shift == 1 ? words128(0x1dac670561bb4f68, 0xadfc88bd978751a0)
                             : words128(0x0fadbafc96406eb1, 0x56dc79ef5f7a217e);
        const uint128 subtracted = uint128(d) << shift;
        below = top < subtracted;
        top = below ? subtracted - top : top - subtracted;
        bottom = bottom + (uint128(n) << shift);
    }
    const uint128 dividend = top << 63;
    std::uint64_t unused = 0;
    const std::uint64_t u4 = divide128(high_half(dividend), low_half(dividend), low_half(bottom >> 3), unused);
    const std::uint64_t z = mul_high(u4, u4) >> 4;
    const uint128 rest = uint128(u4 - mul_high(u4, reciprocal_series<FractionBits, true>(z))) << 60;
    return below ? known - rest : known + rest;
}
/// The angle of (x, y), 0 to pi, y upwards, as a count of 2^-126.
template <int FractionBits>
constexpr uint128 fixed_direction(std::uint64_t y, bool x_negative, std::uint64_t x) {
    const bool steep = y > x;
    const uint128 angle = fixed_arctangent<FractionBits>(steep ? x : y, steep ? y : x);
    if (!steep && !x_negative) return angle;
    const uint128 pi = words128(0xc90fdaa22168c234, 0xc4c6628b80dc1cd1);
    const uint128 base = steep ? pi >> 1 : pi;
    return steep && x_negative ? base + angle : base - angle;
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arctangent2(Rep y, Rep x) {
    const uint128 angle = fixed_direction<FractionBits>(magnitude64(y), x < 0, magnitude64(x));
    return signed_saturating<Rep>(y < 0, rounded<FractionBits, 126>(angle));
}

/// sqrt(1 - x^2) as a count of 2^-62; clamps |x| > 1 to 1.
template <int FractionBits>
constexpr std::uint64_t fixed_complement(std::uint64_t& x) {
    constexpr std::uint64_t one = std::uint64_t{1} << FractionBits;
    note_overflow(x > one);
    if (x > one) x = one;
    const uint128 square = product128(one - x, one + x) << (124 - 2 * FractionBits);
    x <<= 62 - FractionBits;
    return root_of(square).nearest();
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arccosine(Rep raw) {
    std::uint64_t x = magnitude64(raw);
    const std::uint64_t y = fixed_complement<FractionBits>(x);
    return signed_saturating<Rep>(false, rounded<FractionBits, 126>(fixed_direction<FractionBits>(y, raw < 0, x)));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arcsine(Rep raw) {
    std::uint64_t y = magnitude64(raw);
    const std::uint64_t x = fixed_complement<FractionBits>(y);
    return signed_saturating<Rep>(raw < 0, rounded<FractionBits, 126>(fixed_direction<FractionBits>(y, false, x)));
}

/// x log2(e) = k + i/16 + g/16, k and i integers, 0 <= g < 1; exp x = 2^k 2^(i/16) 2^(g/16).
template <class Rep, int FractionBits>
constexpr Rep fixed_exponential(Rep raw) {
    constexpr int digits = std::numeric_limits<Rep>::digits;
    const std::uint64_t m = magnitude64(raw);
    // log2(e) / 2 to 128 bits makes this a count of 2^-(63 + FractionBits).
    const uint128 scaled = product128(m, 0xb8aa3b295c17f0bb) + uint128(mul_high(m, 0xbe87fed0691d3e88));
    const int128 exponent = raw < 0 ? -int128(scaled) : int128(scaled);
    const std::int64_t k = (exponent >> (63 + FractionBits)).low();
    if (k >= digits - FractionBits) return saturated<Rep>(false);
    if (k < -FractionBits - 1) return 0;
    const std::uint64_t fraction = low_half((exponent >> (FractionBits - 1)).bits);
    const std::uint64_t g = fraction << 4, power = fixed_powers[fraction >> 60];
    const std::uint64_t rest = mul_high(g, series<terms_above(digits, fixed_exp_series), false>(g, fixed_exp_series));
    const uint128 value = words128(1, power) + ((uint128(rest) + uint128(mul_high(power, rest))) >> 4);
    const int shift = 64 - FractionBits - static_cast<int>(k);
    return signed_saturating<Rep>(false, ((value >> (shift - 1)) + uint128(std::uint64_t{1})) >> 1);
}

/// log(2^k m) = k log 2 + 2 atanh((m - 1) / (m + 1)), sqrt(1/2) <= m < sqrt(2).
template <class Rep, int FractionBits>
constexpr Rep fixed_logarithm(Rep raw) {
    if (raw == 0) return saturated<Rep>(true);
    if (raw < 0) {
        note_overflow(true);
        return 0;
    }
    const std::uint64_t one = std::uint64_t{1} << 63;
    const int zeros = std::countl_zero(magnitude64(raw));
    const std::uint64_t m = magnitude64(raw) << zeros;
    const bool below = m > 0xb504f333f9de6484;  // sqrt(2): compare with 2 instead of 1
    const int k = 63 - zeros - FractionBits + below;
    const std::uint64_t top = below ? std::uint64_t{0} - m : m - one;
    std::uint64_t unused = 0;
    const std::uint64_t s4 = divide128(top << 1, 0, (m >> 1) + (below ? one : one >> 1), unused);
    const std::uint64_t z = mul_high(s4, s4) >> 4;
    // From here counts of 2^-65.
    const int128 rest{uint128(s4) + uint128(mul_high(s4, reciprocal_series<FractionBits, false>(z)))};
    const std::uint64_t doublings = magnitude64(k);
    const int128 whole{(product128(doublings, 0xb17217f7d1cf79ab) << 1) +
                       uint128(mul_high(doublings << 1, 0xc9e3b39803f2f6af))};
    const int128 value = (k < 0 ? -whole : whole) + (below ? -rest : rest);
    const int128 nearest = shift_nearest(value, 65 - FractionBits);
    return signed_saturating<Rep>(nearest.negative(), nearest.magnitude());
}

template <class Rep, int FractionBits>
constexpr Rep fixed_root(Rep raw) {
    if (raw < 0) {
        note_overflow(true);
        return 0;
    }
    return static_cast<Rep>(root_of(uint128(magnitude64(raw)) << FractionBits).nearest());
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/math_real.hpp
// =================================================================================================
// Elementary functions of float and double: the same bits everywhere, from + - * / and sqrt alone.

PHYSICS_HPP_BEGIN

// All kernels take and return double. Precise ones keep the parts of a result that do not fit in a double
// until the last addition, for errors below 1 ulp of double; the others stop their series at 2^-31 and serve
// float, whose only visible rounding is then the last one. The polynomials are relative minimax fits (Remez'
// exchange in 200-bit arithmetic) to what follows the leading terms of each Taylor series; their first terms
// are so close to Taylor's that float takes a beginning of the same table.

namespace detail {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr double_pair pi_pair{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
inline constexpr double_pair half_pi_pair{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

/// (sin x - x) / x^3 in x^2, |x| <= pi/4; error of the sine 2^-58.
inline constexpr double sine_series[] = {-0x1.5555555555549p-3, 0x1.111111110f8a6p-7,   -0x1.a01a019c1619ep-13,
                                         0x1.71de357b1c021p-19, -0x1.ae5e689f1914fp-26, 0x1.5d93a47bc7c21p-33};
/// (cos x - 1 + x^2/2) / x^4 in x^2, |x| <= pi/4; error of the cosine 2^-64.
inline constexpr double cosine_series[] = {0x1.555555555554cp-5,   -0x1.6c16c16c1521fp-10, 0x1.a01a019cbf634p-16,
                                           -0x1.27e4f812b76b4p-22, 0x1.1ee9f153733fap-29,  -0x1.8fb13176f7930p-37};
/// (exp x - 1 - x) / x^2 in x, |x| <= log(2)/2; error of the exponential 2^-56.
inline constexpr double exp_series[] = {
    0x1.000000000000bp-1,  0x1.5555555555561p-3,  0x1.555555555001cp-5,  0x1.111111110d612p-7,  0x1.6c16c185ac392p-10,
    0x1.a01a01baf110cp-13, 0x1.a01996850cf70p-16, 0x1.71dddfa9da093p-19, 0x1.28b057f105d9bp-22, 0x1.af85bd3f177a1p-26};
/// (2 atanh s - 2 s) / s^3 in s^2, |s| <= (sqrt(2) - 1) / (sqrt(2) + 1); error of the logarithm 2^-59.
inline constexpr double log_series[] = {0x1.5555555555592p-1, 0x1.999999997ff18p-2, 0x1.24924941e16d9p-2,
                                        0x1.c71c52143773cp-3, 0x1.74663cf3c5182p-3, 0x1.39a1e80a6e733p-3,
                                        0x1.2f03c2b77e2b3p-3};
/// (atan u - u) / u^3 in u^2, |u| <= 0.1638; error of the arctangent 2^-60.
inline constexpr double arctangent_series[] = {-0x1.555555555553cp-2, 0x1.999999998dbdbp-3,  -0x1.2492491594086p-3,
                                               0x1.c71c5fce129e2p-4,  -0x1.7457528af2ff3p-4, 0x1.3a0e5503996aap-4,
                                               -0x1.f1be9b5d729d9p-5};
/// (asin x - x) / x^3 in x^2, |x| <= 1/2; error of the arcsine 2^-59.
inline constexpr double arcsine_series[] = {
    0x1.5555555555578p-3, 0x1.333333332df1fp-4,  0x1.6db6db722abbdp-5, 0x1.f1c71a8bebd1ap-6, 0x1.6e8bdfdc83fc0p-6,
    0x1.1c49decb2c3f1p-6, 0x1.ca212fb7b03dap-7,  0x1.7578420cf7d3cp-7, 0x1.6186833457bc3p-7, 0x1.e19e9ca2d18a3p-9,
    0x1.64ec74b91c73ap-6, -0x1.59d68e3a47e11p-6, 0x1.0bd9f58ddc882p-5};

template <int I, int Terms, int N>
constexpr double every_second_term(double xx, const double (&c)[N]) {
    if constexpr (I + 2 >= Terms)
        return c[I];
    else
        return c[I] + xx * every_second_term<I + 2, Terms>(xx, c);
}
/// The first Terms terms of a polynomial; even and odd terms side by side, which halves the latency.
template <int Terms, int N>
constexpr double polynomial(double x, const double (&c)[N]) {
    static_assert(Terms >= 2 && Terms <= N);
    const double xx = x * x;
    return every_second_term<0, Terms>(xx, c) + x * every_second_term<1, Terms>(xx, c);
}

/// The sine of a reduced angle, as a head and a tail of at most a ninth of it.
template <bool Precise>
constexpr double_pair sine_of(const reduced_angle& a) {
    const double z = a.high * a.high;
    const double cubic = a.high * z * polynomial < Precise ? 6 : 5 > (z, sine_series);
    return {a.high, Precise ? cubic + a.low * (1 - 0.5 * z) : cubic};
}
template <bool Precise>
constexpr double_pair cosine_of(const reduced_angle& a) {
    const double z = a.high * a.high;
    const double half = 0.5 * z;
    const double quartic = z * z * polynomial < Precise ? 6 : 5 > (z, cosine_series);
    const double head = 1 - half;
    return {head, Precise ? ((1 - head) - half) + (quartic - a.high * a.low) : quartic};
}
constexpr double sum(double_pair a) { return a.high + a.low; }

/// Below 2^-27 sine, tangent and arcsine are their argument, sign of zero included.
constexpr bool tiny(double x) { return x > -0x1p-27 && x < 0x1p-27; }

template <bool Precise>
constexpr double sine(double x) {
    if (x - x != 0) return not_a_number;
    if (tiny(x)) return x;
    const reduced_angle a = reduce<Precise>(x);
    const double value = a.quadrant & 1 ? sum(cosine_of<Precise>(a)) : sum(sine_of<Precise>(a));
    return a.quadrant & 2 ? -value : value;
}
template <bool Precise>
constexpr double cosine(double x) {
    if (x - x != 0) return not_a_number;
    const reduced_angle a = reduce<Precise>(x);
    const double value = a.quadrant & 1 ? sum(sine_of<Precise>(a)) : sum(cosine_of<Precise>(a));
    return (a.quadrant + 1) & 2 ? -value : value;
}
/// Sine (high) and cosine (low) from one reduction.
template <bool Precise>
constexpr double_pair sine_and_cosine(double x) {
    if (x - x != 0) return {not_a_number, not_a_number};
    if (tiny(x)) return {x, 1};
    const reduced_angle a = reduce<Precise>(x);
    const double s = sum(sine_of<Precise>(a)), c = sum(cosine_of<Precise>(a));
    const double first = a.quadrant & 1 ? c : s, second = a.quadrant & 1 ? s : c;
    return {a.quadrant & 2 ? -first : first, (a.quadrant + 1) & 2 ? -second : second};
}
template <bool Precise>
constexpr double tangent(double x) {
    if (x - x != 0) return not_a_number;
    if (tiny(x)) return x;
    const reduced_angle a = reduce<Precise>(x);
    const double_pair s = sine_of<Precise>(a);
    double_pair c = cosine_of<Precise>(a);
    if constexpr (Precise) c.low -= 0.5 * two_product(a.high, a.high).low;  // the rounding of x^2 in cosine_of
    const bool odd = a.quadrant & 1;
    const double_pair n = odd ? fast_two_sum(-c.high, -c.low) : fast_two_sum(s.high, s.low);
    const double_pair d = odd ? fast_two_sum(s.high, s.low) : fast_two_sum(c.high, c.low);
    const double quotient = n.high / d.high;
    if constexpr (!Precise) return quotient;
    const double_pair back = two_product(quotient, d.high);
    return quotient + (((n.high - back.high) - back.low) + (n.low - quotient * d.low)) / d.high;
}

/// atan(n / d) for 0 <= n <= d, n not below d / 2^60. Subtracts the nearest of atan(0, 1/4, 1/2, 1), since
/// atan(n/d) - atan(c) = atan((n - c d) / (d + c n)): those products are exact, and |u| <= 0.1638 remains.
template <bool Precise>
constexpr double_pair arctangent(double n, double d) {
    constexpr double_pair known[] = {{0, 0},
                                     {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                     {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                     {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
    constexpr double tangents[] = {0, 0.25, 0.5, 1};
    const int i = (8 * n > d) + (8 * n > 3 * d) + (32 * n > 23 * d);
    const double c = tangents[i];
    if constexpr (!Precise) {
        const double u = (n - c * d) / (d + c * n);
        const double z = u * u;
        return {known[i].high, u + u * z * polynomial<6>(z, arctangent_series)};
    } else {
        const double_pair top = two_sum(n, -c * d), bottom = two_sum(d, c * n);
        const double inverse = 1 / bottom.high;
        const double u = top.high * inverse;
        const double_pair back = two_product(u, bottom.high);
        const double rest = (((top.high - back.high) - back.low) + (top.low - u * bottom.low)) * inverse;
        const double z = u * u;
        const double_pair whole = two_sum(known[i].high, u);
        return {whole.high, whole.low + (known[i].low + (rest + u * z * polynomial<7>(z, arctangent_series)))};
    }
}

template <bool Precise>
constexpr double arctangent2(double y, double x) {
    if (x != x || y != y) return not_a_number;
    const bool y_negative = std::bit_cast<std::uint64_t>(y) >> 63 != 0;
    const bool x_negative = std::bit_cast<std::uint64_t>(x) >> 63 != 0;
    double height = y_negative ? -y : y, width = x_negative ? -x : x;
    if (height == infinite || width == infinite) {
        const bool both = height == width;
        height = both || height == infinite ? 1 : 0;
        width = both || height == 0 ? 1 : 0;
    }
    const bool steep = height > width;
    double shorter = steep ? width : height, longer = steep ? height : width;
    const double_pair base = steep ? half_pi_pair : pi_pair;
    const double sign = y_negative ? -1 : 1;
    if (shorter <= longer * 0x1p-60) {
        if (steep || x_negative) return sign * base.high;
        return height == 0 ? sign * 0.0 : sign * (height / width);
    }
    if constexpr (Precise) {
        const double scale = longer > 0x1p400 ? 0x1p-600 : longer < 0x1p-400 ? 0x1p600 : 1;
        shorter *= scale;
        longer *= scale;
    }
    const double_pair angle = arctangent<Precise>(shorter, longer);
    if (!steep && !x_negative) return sign * sum(angle);
    const double turn = steep && x_negative ? 1 : -1;
    const double_pair total = two_sum(base.high, turn * angle.high);
    return sign * (total.high + (total.low + (base.low + turn * angle.low)));
}

/// asin(root) - root for root = sqrt(z) <= 1/2.
constexpr double arcsine_tail(double root, double z) { return root * z * polynomial<13>(z, arcsine_series); }
/// asin(sqrt(z)) for 0 < z <= 1/4, with the part of the root that a double can't hold.
template <bool Precise>
inline double_pair arcsine_of_root(double z) {
    const double root = hardware_root(z);
    double tail = arcsine_tail(root, z);
    if constexpr (Precise) {
        const double_pair square = two_product(root, root);
        tail += ((z - square.high) - square.low) / (2 * root);
    }
    return {root, tail};
}
/// Near the ends acos x = 2 asin(sqrt((1 - x) / 2)), whose argument is exact under the root.
template <bool Precise>
inline double arccosine(double x) {
    const double size = x < 0 ? -x : x;
    if (!(size <= 1)) return not_a_number;
    if (size <= 0.5) return half_pi_pair.high - (x - (half_pi_pair.low - arcsine_tail(x, x * x)));
    if (size == 1) return x < 0 ? pi_pair.high : 0;
    const double_pair half = arcsine_of_root<Precise>(0.5 * (1 - size));
    if (x > 0) return 2 * sum(half);
    return pi_pair.high - 2 * (half.high + (half.low - 0.5 * pi_pair.low));
}
template <bool Precise>
inline double arcsine(double x) {
    const double size = x < 0 ? -x : x;
    if (!(size <= 1)) return not_a_number;
    if (tiny(x)) return x;
    if (size <= 0.5) return x + arcsine_tail(x, x * x);
    if (size == 1) return x < 0 ? -half_pi_pair.high : half_pi_pair.high;
    const double_pair half = arcsine_of_root<Precise>(0.5 * (1 - size));
    const double_pair rest = two_sum(half_pi_pair.high, -2 * half.high);
    const double value = rest.high + (rest.low + (half_pi_pair.low - 2 * half.low));
    return x < 0 ? -value : value;
}

/// exp(n log 2 + r) = 2^n exp(r), |r| <= log(2)/2 (Cody & Waite 1980).
template <bool Precise>
constexpr double exponential(double x) {
    if (x != x) return not_a_number;
    if (x > 709.8) return infinite;
    if (x < -745.2) return 0;
    const int n = nearest_int(x * 0x1.71547652b82fep+0);
    const double turns = static_cast<double>(n);
    double_pair r{x - turns * 0x1.62e42fefa39efp-1, 0};
    if constexpr (Precise) r = two_sum(x - turns * 0x1.62e42fefa38p-1, -(turns * 0x1.ef35793c7673p-45));
    const double square = r.high * r.high * polynomial < Precise ? 10 : 8 > (r.high, exp_series);
    const double_pair head = fast_two_sum(1, r.high);
    const double value = head.high + (head.low + (r.low + square));
    // In two steps, since 2^n alone may leave the range of double; the second step rounds subnormal results.
    return value * power_of_two(n / 2) * power_of_two(n - n / 2);
}

/// log(2^n m) = n log 2 + log(1 + f), sqrt(1/2) <= m < sqrt(2). With s = f / (2 + f), log(1 + f) = 2 atanh(s)
/// = 2 s + s R(s^2) and 2 s = f - s f, hence = f - s (f - R) = f - f^2/2 + s (f^2/2 + R): the large terms
/// are exact or nearly so.
template <bool Precise>
constexpr double logarithm(double x) {
    if (!(x > 0)) return x == 0 ? -infinite : not_a_number;
    if (x == infinite) return infinite;
    int n = -1023;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        n -= 54;
    }
    constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000;
    const std::uint64_t word = std::bit_cast<std::uint64_t>(x) - root_half + one;
    n += static_cast<int>(word >> 52);
    const double m = std::bit_cast<double>((word & 0xfffffffffffff) + root_half);
    const double turns = static_cast<double>(n);
    const double f = m - 1;
    const double s = f / (2 + f);
    const double z = s * s;
    const double tail = z * polynomial < Precise ? 7 : 6 > (z, log_series);
    if constexpr (!Precise) return turns * 0x1.62e42fefa39efp-1 + (f - s * (f - tail));
    const double half = 0.5 * f * f;
    const double_pair head = two_sum(turns * 0x1.62e42fefa38p-1, f);
    return head.high + (head.low - (half - (s * (half + tail) + turns * 0x1.ef35793c7673p-45)));
}

/// The largest integer not above x.
template <class Real>
constexpr Real floor_of(Real x) {
    using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    constexpr Real whole = Real(1) / std::numeric_limits<Real>::epsilon();
    if (!(x < whole && x > -whole) || x == 0) return x;
    const Real cut = static_cast<Real>(static_cast<Integer>(x));
    return cut > x ? cut - 1 : cut;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/scalar.hpp
// =================================================================================================
// What a number type must offer to run the engine, and the few operations in which number types differ.

PHYSICS_HPP_BEGIN

/// Facts about a scalar type. Specialise it for your own:
///   wide       holds products and sums of products without rounding, where the type can; else the scalar itself
///   inverse    holds inverse masses and inertias: finer than the scalar where that is fixed point
///   name()     for tables and cell names
///   epsilon()  the spacing of numbers next to 1
///   max()      the largest number
///   is_finite(x)
///   bits(x)    equal numbers give equal bits, for hashing; both zeros give 0
///   sqrt, floor, sin, cos, tan, exp, log, acos (x) and atan2(y, x), needed only of types the library does not
///   know (see math.hpp)
template <class S>
struct scalar_traits;

template <std::floating_point S>
    requires(!std::same_as<S, long double>)
struct scalar_traits<S> {
    using wide = S;
    using inverse = S;
    static constexpr const char* name() { return sizeof(S) == 4 ? "float" : "double"; }
    static constexpr S epsilon() { return std::numeric_limits<S>::epsilon(); }
    static constexpr S max() { return std::numeric_limits<S>::max(); }
    static constexpr bool is_finite(S x) { return x - x == S(0); }
    static std::uint64_t bits(S x) {
        if (x == S(0)) return 0;
        std::uint64_t result = 0;
        if constexpr (sizeof(S) == 4) {
            std::uint32_t word = 0;
            std::memcpy(&word, &x, sizeof x);
            result = word;
        } else {
            std::memcpy(&result, &x, sizeof x);
        }
        return result;
    }
};

template <class Rep, int FractionBits>
struct scalar_traits<fixed<Rep, FractionBits>> {
    using scalar = fixed<Rep, FractionBits>;
    using wide = wide_fixed<detail::product_integer<Rep, Rep>, 2 * FractionBits>;
    /// Q24.40 for every format: inverse masses from 1e-12 to 8e6.
    using inverse = fixed<std::int64_t, 40>;
    static constexpr const char* name() {
        if constexpr (std::is_same_v<scalar, fixed32>) return "fixed32";
        else if constexpr (std::is_same_v<scalar, fixed16>) return "fixed16";
        else if constexpr (std::is_same_v<scalar, fixed48>) return "fixed48";
        else return "fixed";
    }
    static constexpr scalar epsilon() { return scalar::from_raw(1); }
    static constexpr scalar max() { return scalar::from_raw(std::numeric_limits<Rep>::max()); }
    static constexpr bool is_finite(scalar) { return true; }
    static constexpr std::uint64_t bits(scalar x) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(x.raw()));
    }
};

/// A number type that the engine can run on. It asks only what fixed point can give: explicit construction
/// from int and double, conversion to double for messages, order, + - * /, and scalar_traits. No implicit
/// conversion, no infinity, no NaN.
template <class S>
concept scalar_type = std::regular<S> && std::totally_ordered<S> && requires(S a, const S b) {
    S(1);
    S(0.5);
    { static_cast<double>(b) } -> std::same_as<double>;
    { a + b } -> std::same_as<S>;
    { a - b } -> std::same_as<S>;
    { a * b } -> std::same_as<S>;
    { a / b } -> std::same_as<S>;
    { -b } -> std::same_as<S>;
    a += b;
    a -= b;
    a *= b;
    a /= b;
    typename scalar_traits<S>::wide;
    typename scalar_traits<S>::inverse;
    { scalar_traits<S>::epsilon() } -> std::same_as<S>;
    { scalar_traits<S>::max() } -> std::same_as<S>;
    { scalar_traits<S>::is_finite(b) } -> std::same_as<bool>;
    { scalar_traits<S>::bits(b) } -> std::same_as<std::uint64_t>;
} && !std::integral<S>;

/// The type of exact products of S.
template <class S>
using wide_of = typename scalar_traits<S>::wide;
/// The type of inverse masses and inertias of S.
template <class S>
using inverse_of = typename scalar_traits<S>::inverse;

namespace detail {
/// Scalars whose products have the scalar's own type.
template <class S>
concept self_wide = std::same_as<wide_of<S>, S>;
}  // namespace detail

/// a * b without rounding where S can.
template <detail::self_wide S>
constexpr S product(S a, S b) {
    return a * b;
}
/// A wide number as R, rounded once.
template <class R>
    requires detail::self_wide<R>
constexpr R narrow(R a) {
    return a;
}
/// numerator / denominator as R, rounded once; each may be wide.
template <class R>
    requires detail::self_wide<R>
constexpr R quotient(R numerator, R denominator) {
    return numerator / denominator;
}
/// a * b rounded once to R; the operands may be a scalar and its inverse type.
template <class R, class A, class B>
constexpr R mul(A a, B b) {
    return narrow<R>(product(a, b));
}
/// 1 / a rounded once to R.
template <class R, class A>
constexpr R reciprocal(A a) {
    return quotient<R>(A(1), a);
}
/// a as a wide number, to compare with products.
template <scalar_type S>
constexpr wide_of<S> widen(S a) {
    return product(a, S(1));
}

namespace detail {
/// x as a double. Through an opaque step for floats: the vectoriser of gcc 12 forgets the rounding of floats that are
/// made of doubles and become doubles again in the same function.
template <scalar_type S>
constexpr double to_double(S x) {
#if defined(__GNUC__) && !defined(__clang__)
    if constexpr (std::is_same_v<S, float>)
        if (!std::is_constant_evaluated()) {
#if defined(__SSE2__)
            __asm__("" : "+x"(x));
#elif defined(__aarch64__)
            __asm__("" : "+w"(x));
#else
            __asm__("" : "+m"(x));
#endif
        }
#endif
    return static_cast<double>(x);
}
}  // namespace detail

template <scalar_type S>
constexpr S min(S a, S b) {
    return b < a ? b : a;
}
template <scalar_type S>
constexpr S max(S a, S b) {
    return a < b ? b : a;
}
template <scalar_type S>
constexpr S clamp(S x, S low, S high) {
    return x < low ? low : (high < x ? high : x);
}
template <scalar_type S>
constexpr S abs(S x) {
    return x < S(0) ? -x : x;
}
template <scalar_type S>
constexpr bool is_finite(S x) {
    return scalar_traits<S>::is_finite(x);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/base/math.hpp
// =================================================================================================
// Elementary functions and constants for every scalar: the same bits on every compiler and processor.

PHYSICS_HPP_BEGIN

// Errors are in units in the last place of the result and hold over the whole range, huge arguments included.
//   float   computed in double, rounded once: <= 0.501 ulp
//   double  <= 1 ulp; sqrt <= 0.5
//   fixed   sqrt <= 0.5 ulp; the others <= 0.51 where the format has up to 48 fraction bits and the result at
//           most 56 bits, <= 2 at the limits of the representation. A result out of range saturates, and the
//           audit counts it.
// Cost, on one core of 2022: float 3-10 ns, double 4-19, Q32.32 7-33; two to four times that for fixed point where
// there is no __int128.
// Float and double take and return infinities, NaN, signed zeros and subnormal numbers as IEEE 754 has it.
// Fixed point has no NaN: an argument outside the domain gives what is said below, and the audit counts it.
// Scalars of your own go to scalar_traits<S>.

namespace detail {
template <class S>
inline constexpr bool is_fixed = false;
template <class Rep, int FractionBits>
inline constexpr bool is_fixed<fixed<Rep, FractionBits>> = true;
/// Double keeps the tails of its results, float needs none.
template <class S>
inline constexpr bool is_precise = sizeof(S) > sizeof(float);

/// pi * 2^shift in S, to nearest; saturates.
template <class S>
constexpr S pi_times(int shift) {
    const double factor = shift == 0 ? 1 : shift < 0 ? 0.5 : 2;
    if constexpr (is_fixed<S>) {
        const uint128 twice = words128(0x6487ed5110b4611a, 0x62633145c06e0e68);  // 2 pi as a count of 2^-124
        return S::from_raw(
            signed_saturating<typename S::rep>(false, rounded<S::fraction_bits, 124>(twice >> (1 - shift))));
    } else {
        return S(3.14159265358979323846 * factor);
    }
}
}  // namespace detail

/// The circle constant, correctly rounded. A format too small for it gets its largest number.
template <class S>
inline const S pi = detail::pi_times<S>(0);
template <std::floating_point S>
inline constexpr S pi<S> = detail::pi_times<S>(0);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> pi<fixed<Rep, FractionBits>> = detail::pi_times<fixed<Rep, FractionBits>>(0);

/// A quarter turn in radians, correctly rounded.
template <class S>
inline const S half_pi = detail::pi_times<S>(-1);
template <std::floating_point S>
inline constexpr S half_pi<S> = detail::pi_times<S>(-1);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> half_pi<fixed<Rep, FractionBits>> =
    detail::pi_times<fixed<Rep, FractionBits>>(-1);

/// A full turn in radians, correctly rounded. A format too small for it gets its largest number.
template <class S>
inline const S two_pi = detail::pi_times<S>(1);
template <std::floating_point S>
inline constexpr S two_pi<S> = detail::pi_times<S>(1);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> two_pi<fixed<Rep, FractionBits>> =
    detail::pi_times<fixed<Rep, FractionBits>>(1);

/// The square root, correctly rounded. Negative numbers: NaN, in fixed point 0.
template <scalar_type S>
constexpr S sqrt(S x) {
    if constexpr (std::floating_point<S>)
        return detail::hardware_root(x);
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_root<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::sqrt(x);
}
/// The square root of a wide number, for scalars that are their own wide type.
template <class R>
    requires detail::self_wide<R>
constexpr R root(R a) { return sqrt(a); }

/// The largest whole number not above x.
template <scalar_type S>
constexpr S floor(S x) {
    if constexpr (std::floating_point<S>)
        return detail::floor_of(x);
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(x.raw() >> S::fraction_bits << S::fraction_bits);
    else
        return scalar_traits<S>::floor(x);
}

/// The sine of x radians. Cody & Waite (1980) reduction, Payne & Hanek (1983) for huge arguments.
template <scalar_type S>
constexpr S sin(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::sine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_sine<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::sin(x);
}
/// The cosine of x radians.
template <scalar_type S>
constexpr S cos(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::cosine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_cosine<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::cos(x);
}

/// A sine and the cosine of the same angle.
template <class S>
struct sine_cosine_of {
    S sine;
    S cosine;
};
/// Both at once, the same numbers as sin and cos, for less than the price of two calls.
template <scalar_type S>
constexpr sine_cosine_of<S> sine_cosine(S x) {
    if constexpr (std::floating_point<S>) {
        const detail::double_pair both = detail::sine_and_cosine<detail::is_precise<S>>(x);
        return {static_cast<S>(both.high), static_cast<S>(both.low)};
    } else if constexpr (detail::is_fixed<S>) {
        typename S::rep sine = 0, cosine = 0;
        detail::fixed_sine_and_cosine<typename S::rep, S::fraction_bits>(x.raw(), sine, cosine);
        return {S::from_raw(sine), S::from_raw(cosine)};
    } else {
        return {scalar_traits<S>::sin(x), scalar_traits<S>::cos(x)};
    }
}

/// The tangent of x radians.
template <scalar_type S>
constexpr S tan(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::tangent<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_tangent<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::tan(x);
}

/// The angle of the vector (x, y) in radians, -pi to pi; 0 for the zero vector of fixed point, by the signs of
/// the zeros for float and double.
template <scalar_type S>
constexpr S atan2(S y, S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::arctangent2<detail::is_precise<S>>(detail::to_double(y), detail::to_double(x)));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arctangent2<typename S::rep, S::fraction_bits>(y.raw(), x.raw()));
    else
        return scalar_traits<S>::atan2(y, x);
}

/// The angle from 0 to pi with cosine x. |x| > 1: NaN, in fixed point as 1 or -1.
template <scalar_type S>
constexpr S acos(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::arccosine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arccosine<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::acos(x);
}
/// The angle from -pi/2 to pi/2 with sine x. |x| > 1: NaN, in fixed point as 1 or -1.
template <scalar_type S>
constexpr S asin(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::arcsine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arcsine<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::atan2(x, scalar_traits<S>::sqrt((S(1) - x) * (S(1) + x)));
}

/// e^x. Overflow: infinity, in fixed point the largest number.
template <scalar_type S>
constexpr S exp(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::exponential<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_exponential<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::exp(x);
}
/// The natural logarithm. Of 0: -infinity, in fixed point the smallest number; of negative numbers: NaN, in
/// fixed point 0.
template <scalar_type S>
constexpr S log(S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::logarithm<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_logarithm<typename S::rep, S::fraction_bits>(x.raw()));
    else
        return scalar_traits<S>::log(x);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/base/pack.hpp
// =================================================================================================
// Lanes: W scalars that go through the same arithmetic, in vector registers where the target has them.

// The widest vector register that this unit may use, in bytes; 0 where there is none that keeps IEEE 754 (32-bit
// ARM flushes subnormals) or where the compiler has no vector types: lanes are then plain scalars.
#if !defined(__GNUC__) && !defined(__clang__)
#define PHYSICS_HPP_VECTOR_BYTES 0
#elif defined(__AVX2__)
#define PHYSICS_HPP_VECTOR_BYTES 32
#elif defined(__SSE2__) || defined(__aarch64__) || defined(__wasm_simd128__) || defined(__VSX__)
#define PHYSICS_HPP_VECTOR_BYTES 16
#else
#define PHYSICS_HPP_VECTOR_BYTES 0
#endif

// For lanes and the kernels made of them, never for what users call: gcc contracts a * b + c again where an
// always_inline function lands in code outside the determinism region. Within it, forced inlining keeps packs in
// registers at every optimisation level, and makes calls between functions of different targets harmless.
#if defined(__GNUC__) || defined(__clang__)
#define PHYSICS_HPP_ALWAYS_INLINE inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define PHYSICS_HPP_ALWAYS_INLINE __forceinline
#else
#define PHYSICS_HPP_ALWAYS_INLINE inline
#endif

PHYSICS_HPP_BEGIN

namespace detail {

inline constexpr int vector_bytes = PHYSICS_HPP_VECTOR_BYTES;

/// The number of lanes that fill one vector register of that many bytes: 4 or 8 for float, 2 or 4 for double, 1 for
/// all other scalars.
template <class S, int Bytes = vector_bytes>
inline constexpr int native_width =
    (std::is_same_v<S, float> || std::is_same_v<S, double>) && Bytes >= 16 ? Bytes / static_cast<int>(sizeof(S)) : 1;

/// Whether W lanes are one vector; one lane is a scalar, and all other packs are made of two halves.
template <class S, int W, int Bytes>
inline constexpr bool is_vector = W > 1 && W <= native_width<S, Bytes> && W * sizeof(S) >= 16;

template <class S, int W>
struct lane_storage {
#if PHYSICS_HPP_VECTOR_BYTES > 0
    typedef S type __attribute__((vector_size(W * sizeof(S))));
    typedef S unaligned __attribute__((vector_size(W * sizeof(S)), aligned(alignof(S)), may_alias));
    typedef S aligned __attribute__((vector_size(W * sizeof(S)), may_alias));
#endif
};
template <class S>
struct lane_storage<S, 1> {
    using type = S;
};

/// W scalars, a power of two, that go through the same arithmetic: lane i of a result is what the scalar operation
/// gives for lane i of the operands, bit for bit, at any width and any Bytes (only the sign and the payload of a NaN
/// are left open). In memory it is an array of W scalars; trivially copyable where S is. Operands are references since
/// by value unoptimised builds copy them (1.5 to 4 times slower) and gcc warns of vectors wider than the unit's.
///
/// Internal machinery of kernels: use it only between PHYSICS_HPP_BEGIN and PHYSICS_HPP_END (see
/// PHYSICS_HPP_ALWAYS_INLINE). A kernel for wider registers than the unit's is a noinline function with, say,
/// target("avx2"), without fma, that takes pointers only and works on pack<S, W, 32>.
template <class S, int W, int Bytes = vector_bytes>
struct pack {
    static_assert(W > 1 && (W & (W - 1)) == 0, "physics::detail::pack: the width must be a power of two");
    using scalar = S;
    using half = pack<S, W / 2, Bytes>;
    static constexpr int width = W;

    half low, high;

    /// x in every lane.
    PHYSICS_HPP_ALWAYS_INLINE static pack broadcast(S x) { return {half::broadcast(x), half::broadcast(x)}; }
    /// W scalars in a row, at any address.
    PHYSICS_HPP_ALWAYS_INLINE static pack load(const S* from) { return {half::load(from), half::load(from + W / 2)}; }
    /// W scalars in a row, at a multiple of alignof(pack).
    PHYSICS_HPP_ALWAYS_INLINE static pack load_aligned(const S* from) {
        return {half::load_aligned(from), half::load_aligned(from + W / 2)};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(S* to) const {
        low.store(to);
        high.store(to + W / 2);
    }
    PHYSICS_HPP_ALWAYS_INLINE void store_aligned(S* to) const {
        low.store_aligned(to);
        high.store_aligned(to + W / 2);
    }
    /// For messages, tests and rare paths: a kernel that picks lanes is slower than one without packs.
    PHYSICS_HPP_ALWAYS_INLINE S lane(int i) const { return i < W / 2 ? low.lane(i) : high.lane(i - W / 2); }
    /// Writes one scalar, to fill the lanes of a block in memory one by one.
    PHYSICS_HPP_ALWAYS_INLINE void set_lane(int i, S x) { (i < W / 2 ? low : high).set_lane(i & (W / 2 - 1), x); }

    PHYSICS_HPP_ALWAYS_INLINE friend pack operator+(const pack& a, const pack& b) {
        return {a.low + b.low, a.high + b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a, const pack& b) {
        return {a.low - b.low, a.high - b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator*(const pack& a, const pack& b) {
        return {a.low * b.low, a.high * b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator/(const pack& a, const pack& b) {
        return {a.low / b.low, a.high / b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a) { return {-a.low, -a.high}; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator+=(const pack& b) { return *this = *this + b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator-=(const pack& b) { return *this = *this - b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator*=(const pack& b) { return *this = *this * b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator/=(const pack& b) { return *this = *this / b; }

    PHYSICS_HPP_ALWAYS_INLINE friend pack min(const pack& a, const pack& b) {
        return {min(a.low, b.low), min(a.high, b.high)};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack max(const pack& a, const pack& b) {
        return {max(a.low, b.low), max(a.high, b.high)};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack sqrt(const pack& a) { return {sqrt(a.low), sqrt(a.high)}; }
    /// a > b ? x : y in each lane; y where a or b is NaN.
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<T, W, Bytes> select_greater(const pack& a, const pack& b,
                                                                     const pack<T, W, Bytes>& x,
                                                                     const pack<T, W, Bytes>& y) {
        return {select_greater(a.low, b.low, x.low, y.low), select_greater(a.high, b.high, x.high, y.high)};
    }
    /// The lanes' products without rounding where S can: the twin of product(S, S).
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend auto product(const pack& a, const pack<T, W, Bytes>& b) {
        using result = typename decltype(product(a.low, b.low))::scalar;
        return pack<result, W, Bytes>{product(a.low, b.low), product(a.high, b.high)};
    }
    /// The lanes of products, and sums of such, rounded once to R: the twin of narrow<R>(wide).
    template <class R>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> narrow(const pack& a) {
        return {narrow<R>(a.low), narrow<R>(a.high)};
    }
    /// a * b rounded once to R; the operands may be a scalar and its inverse type.
    template <class R, class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> mul(const pack& a, const pack<T, W, Bytes>& b) {
        return narrow<R>(product(a, b));
    }
};

/// One scalar, or one vector: compilers give both the same operators, and turn the ternaries into min, max and blend.
template <class S, int W, int Bytes>
    requires(W == 1 || is_vector<S, W, Bytes>)
struct pack<S, W, Bytes> {
    using scalar = S;
    using storage = typename lane_storage<S, W>::type;
    static constexpr int width = W;

    storage value;

    PHYSICS_HPP_ALWAYS_INLINE static pack broadcast(S x) {
        if constexpr (W == 1) return {x};
        else if constexpr (W == 2) return {storage{x, x}};
        else if constexpr (W == 4) return {storage{x, x, x, x}};
        else return {storage{x, x, x, x, x, x, x, x}};
    }
    PHYSICS_HPP_ALWAYS_INLINE static pack load(const S* from) {
        if constexpr (W == 1) return {*from};
        else return {*reinterpret_cast<const typename lane_storage<S, W>::unaligned*>(from)};
    }
    PHYSICS_HPP_ALWAYS_INLINE static pack load_aligned(const S* from) {
        if constexpr (W == 1) return {*from};
        else return {*reinterpret_cast<const typename lane_storage<S, W>::aligned*>(from)};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(S* to) const {
        if constexpr (W == 1) *to = value;
        else *reinterpret_cast<typename lane_storage<S, W>::unaligned*>(to) = value;
    }
    PHYSICS_HPP_ALWAYS_INLINE void store_aligned(S* to) const {
        if constexpr (W == 1) *to = value;
        else *reinterpret_cast<typename lane_storage<S, W>::aligned*>(to) = value;
    }
    PHYSICS_HPP_ALWAYS_INLINE S lane([[maybe_unused]] int i) const {
        if constexpr (W == 1) return value;
        else return value[i];
    }
    PHYSICS_HPP_ALWAYS_INLINE void set_lane([[maybe_unused]] int i, S x) {
        // Not value[i] = x, which clang makes a load, an insertion and a store of the whole vector.
        if constexpr (W == 1) value = x;
        else std::memcpy(reinterpret_cast<char*>(&value) + i * static_cast<int>(sizeof x), &x, sizeof x);
    }

    PHYSICS_HPP_ALWAYS_INLINE friend pack operator+(const pack& a, const pack& b) { return {a.value + b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a, const pack& b) { return {a.value - b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator*(const pack& a, const pack& b) { return {a.value * b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator/(const pack& a, const pack& b) { return {a.value / b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a) { return {-a.value}; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator+=(const pack& b) { return *this = *this + b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator-=(const pack& b) { return *this = *this - b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator*=(const pack& b) { return *this = *this * b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator/=(const pack& b) { return *this = *this / b; }

    PHYSICS_HPP_ALWAYS_INLINE friend pack min(const pack& a, const pack& b) {
        return {b.value < a.value ? b.value : a.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack max(const pack& a, const pack& b) {
        return {a.value < b.value ? b.value : a.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack sqrt(const pack& a) {
        if constexpr (W == 1) return {physics::sqrt(a.value)};
        else return {vector_sqrt(a)};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<T, W, Bytes> select_greater(const pack& a, const pack& b,
                                                                     const pack<T, W, Bytes>& x,
                                                                     const pack<T, W, Bytes>& y) {
        return {a.value > b.value ? x.value : y.value};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend auto product(const pack& a, const pack<T, W, Bytes>& b) {
        using physics::product;
        if constexpr (W > 1) return a * b;
        else return pack<decltype(product(a.value, b.value)), W, Bytes>{product(a.value, b.value)};
    }
    template <class R>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> narrow(const pack& a) {
        using physics::narrow;
        if constexpr (W > 1) return a;
        else return {narrow<R>(a.value)};
    }
    template <class R, class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> mul(const pack& a, const pack<T, W, Bytes>& b) {
        return narrow<R>(product(a, b));
    }
};

#if PHYSICS_HPP_VECTOR_BYTES > 0

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define PHYSICS_HPP_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#endif
#if __has_builtin(__builtin_elementwise_sqrt)
#define PHYSICS_HPP_ELEMENTWISE_SQRT
#endif
#endif
#ifndef PHYSICS_HPP_SHUFFLE  // gcc before 12
#define PHYSICS_HPP_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, decltype((a) < (b)){__VA_ARGS__})
#define PHYSICS_HPP_NO_SHUFFLEVECTOR
#endif

/// One vector from two of half its size.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P join(const pack<S, P::width / 2, 16>& low, const pack<S, P::width / 2, 16>& high) {
#ifdef PHYSICS_HPP_NO_SHUFFLEVECTOR
    const pack<S, P::width / 2, 16> halves[2] = {low, high};
    return P::load(reinterpret_cast<const S*>(halves));
#else
    if constexpr (P::width == 4) return {PHYSICS_HPP_SHUFFLE(low.value, high.value, 0, 1, 2, 3)};
    else return {PHYSICS_HPP_SHUFFLE(low.value, high.value, 0, 1, 2, 3, 4, 5, 6, 7)};
#endif
}

/// The lower or upper half of a vector.
template <bool Upper, class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack<S, W / 2, 16> half_of(const pack<S, W, Bytes>& a) {
#ifdef PHYSICS_HPP_NO_SHUFFLEVECTOR
    S lanes[W];
    a.store(lanes);
    return pack<S, W / 2, 16>::load(lanes + (Upper ? W / 2 : 0));
#else
    constexpr int first = Upper ? W / 2 : 0;
    if constexpr (W == 4) return {PHYSICS_HPP_SHUFFLE(a.value, a.value, first, first + 1)};
    else return {PHYSICS_HPP_SHUFFLE(a.value, a.value, first, first + 1, first + 2, first + 3)};
#endif
}

/// The root of each lane by the target's own instruction: a loop over scalar roots stays scalar, with calls of libm.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P vector_sqrt(const P& a) {
    using S = typename P::scalar;
    if constexpr (P::width * sizeof(S) == 32) {
        // Two steps here as well: the 32-byte instruction can't be named in code for targets without it.
        return join<P>(vector_sqrt(half_of<false>(a)), vector_sqrt(half_of<true>(a)));
    } else {
#ifdef PHYSICS_HPP_ELEMENTWISE_SQRT
        return {__builtin_elementwise_sqrt(a.value)};
#elif defined(__SSE2__)
        if constexpr (sizeof(S) == 4) return {__builtin_ia32_sqrtps(a.value)};
        else return {__builtin_ia32_sqrtpd(a.value)};
#elif defined(__aarch64__)
        P root;
        if constexpr (sizeof(S) == 4) __asm__("fsqrt %0.4s, %1.4s" : "=w"(root.value) : "w"(a.value));
        else __asm__("fsqrt %0.2d, %1.2d" : "=w"(root.value) : "w"(a.value));
        return root;
#elif defined(__wasm_simd128__)
        if constexpr (sizeof(S) == 4) return {__builtin_wasm_sqrt_f32x4(a.value)};
        else return {__builtin_wasm_sqrt_f64x2(a.value)};
#else
        P root = a;
        for (int i = 0; i < P::width; ++i) root.value[i] = physics::sqrt(a.value[i]);
        return root;
#endif
    }
}

#endif

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/pack_mask.hpp
// =================================================================================================
// Comparisons of lanes, as bits.

PHYSICS_HPP_BEGIN

namespace detail {

/// The answers of a comparison of packs: all bits of a lane, or none.
template <class S, int W, int Bytes = vector_bytes>
struct pack_mask {
    using half = pack_mask<S, W / 2, Bytes>;

    half low, high;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {a.low | b.low, a.high | b.high};
    }
    /// Bit i is set where lane i is.
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const { return low.bits() | high.bits() << (W / 2); }
};

template <class S, int W, int Bytes>
    requires(W == 1)
struct pack_mask<S, W, Bytes> {
    bool value;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {static_cast<bool>(a.value | b.value)};
    }
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const { return value; }
};

#if PHYSICS_HPP_VECTOR_BYTES > 0

template <class S, int W, int Bytes>
    requires is_vector<S, W, Bytes>
struct pack_mask<S, W, Bytes> {
    using lanes = typename lane_storage<S, W>::type;
    using storage = decltype(lanes{} < lanes{});

    storage value;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {a.value | b.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const {
#if defined(__SSE2__)
        if constexpr (W * sizeof(S) == 16 && sizeof(S) == 4)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskps(reinterpret_cast<lanes>(value)));
        else if constexpr (W * sizeof(S) == 16)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskpd(reinterpret_cast<lanes>(value)));
#if defined(__AVX2__)
        else if constexpr (sizeof(S) == 4)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<lanes>(value)));
        else return static_cast<std::uint32_t>(__builtin_ia32_movmskpd256(reinterpret_cast<lanes>(value)));
#endif
#else
        std::uint32_t result = 0;
        for (int i = 0; i < W; ++i) result |= static_cast<std::uint32_t>(value[i] & 1) << i;
        return result;
#endif
    }
};

#endif

/// a > b in each lane; false where either is NaN.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack_mask<S, W, Bytes> greater(const pack<S, W, Bytes>& a, const pack<S, W, Bytes>& b) {
    if constexpr (W == 1 || is_vector<S, W, Bytes>) return {a.value > b.value};
    else return {greater(a.low, b.low), greater(a.high, b.high)};
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/lane_math.hpp
// =================================================================================================
// Short formulas in lanes.

PHYSICS_HPP_BEGIN

namespace detail {

/// The magnitude of each lane; of both zeros the same zero.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack<S, W, Bytes> lane_abs(const pack<S, W, Bytes>& x) {
    if constexpr (!std::is_floating_point_v<S>) {
        return max(x, -x);
    } else if constexpr (W == 1) {
        using bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
        return {std::bit_cast<S>(std::bit_cast<bits>(x.value) & ~std::bit_cast<bits>(S(-0.0)))};
    } else if constexpr (requires { x.low; }) {
        return {lane_abs(x.low), lane_abs(x.high)};
    } else {
        using lanes = decltype(x.value < x.value);
        const auto sign = pack<S, W, Bytes>::broadcast(S(-0.0));
        return {reinterpret_cast<typename pack<S, W, Bytes>::storage>(reinterpret_cast<lanes>(x.value) &
                                                                      ~reinterpret_cast<lanes>(sign.value))};
    }
}
/// Four scalars as lanes.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P lanes_of(S a, S b, S c, S d) {
    if constexpr (!requires(P x) { x.low; })
        return {typename P::storage{a, b, c, d}};
    else if constexpr (requires(P x) { x.low.low; })
        return {{{a}, {b}}, {{c}, {d}}};
    else
        return {{typename P::half::storage{a, b}}, {typename P::half::storage{c, d}}};
}
/// a * b + c * d, rounded once where the scalar can.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_sum(const P& a, const P& b, const P& c, const P& d) {
    return narrow<typename P::scalar>(product(a, b) + product(c, d));
}
/// a * b - c * d, rounded once where the scalar can.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_difference(const P& a, const P& b, const P& c, const P& d) {
    return narrow<typename P::scalar>(product(a, b) - product(c, d));
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_dot(const P* a, const P& x, const P& y, const P& z) {
    return narrow<typename P::scalar>(product(a[0], x) + product(a[1], y) + product(a[2], z));
}
/// The length of (a, b).
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_length(const P& a, const P& b) {
    // One lane takes the root of what has not been rounded yet.
    if constexpr (P::width == 1)
        return {root<typename P::scalar>(product(a.value, a.value) + product(b.value, b.value))};
    else
        return sqrt(a * a + b * b);
}
/// The greatest of eight lanes, or of one.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE typename P::scalar greatest_lane(const P& x) {
    if constexpr (P::width == 1) {
        return x.value;
    } else {
        const auto half = max(x.low, x.high);
        return max(max(half.lane(0), half.lane(1)), max(half.lane(2), half.lane(3)));
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/pack_rows.hpp
// =================================================================================================
// Rows of four scalars into lanes and back: how kernels read and write bodies.

PHYSICS_HPP_BEGIN

namespace detail {

/// Four packs that come from, or go to, W rows of four scalars: x holds the rows' first scalars.
template <class P>
struct quad {
    P x, y, z, w;
};

/// Rows of Stride scalars one after the other; lane i stands for the first four of row index[i]. Add 4 to base for the
/// next four. S is const where the rows are only read. (The stride is known here, since from one at run time clang
/// computes addresses in vectors and takes them apart again: 1.4 times slower.)
template <class S, int Stride>
struct indexed_rows {
    S* base;
    const std::uint32_t* index;

    using row = S[Stride];
    PHYSICS_HPP_ALWAYS_INLINE S* operator[](int lane) const { return reinterpret_cast<row*>(base)[index[lane]]; }
    PHYSICS_HPP_ALWAYS_INLINE indexed_rows from(int lane) const { return {base, index + lane}; }
};

/// Rows of Stride scalars one after the other; lane i stands for the first four of row i.
template <class S, int Stride>
struct consecutive_rows {
    S* base;

    PHYSICS_HPP_ALWAYS_INLINE S* operator[](int lane) const { return base + Stride * lane; }
    PHYSICS_HPP_ALWAYS_INLINE consecutive_rows from(int lane) const { return {base + Stride * lane}; }
};

#if PHYSICS_HPP_VECTOR_BYTES > 0

/// The transpose of four rows of four scalars; eight floats are two such rows side by side. Its own inverse. The order
/// of the shuffles is the one that stays within 16 bytes as long as possible.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE quad<P> transposed(const P& r0, const P& r1, const P& r2, const P& r3) {
    if constexpr (P::width == 8) {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 8, 1, 9, 4, 12, 5, 13)};
        const P b{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 8, 1, 9, 4, 12, 5, 13)};
        const P c{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 2, 10, 3, 11, 6, 14, 7, 15)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 2, 10, 3, 11, 6, 14, 7, 15)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 1, 8, 9, 4, 5, 12, 13)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 2, 3, 10, 11, 6, 7, 14, 15)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 1, 8, 9, 4, 5, 12, 13)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 2, 3, 10, 11, 6, 7, 14, 15)}};
    } else if constexpr (sizeof(P) == 16) {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 4, 1, 5)};
        const P b{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 4, 1, 5)};
        const P c{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 2, 6, 3, 7)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 2, 6, 3, 7)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 2, 3, 6, 7)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 2, 3, 6, 7)}};
    } else {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 4, 2, 6)};
        const P b{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 1, 5, 3, 7)};
        const P c{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 4, 2, 6)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 1, 5, 3, 7)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, c.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(b.value, d.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(a.value, c.value, 2, 3, 6, 7)},
                {PHYSICS_HPP_SHUFFLE(b.value, d.value, 2, 3, 6, 7)}};
    }
}

#endif

/// Reads a row of four scalars for each lane: load4<P>(indexed_rows<const S, 8>{base, index}). Vectors transpose,
/// which takes half the time of picking scalars.
template <class P, class Rows>
PHYSICS_HPP_ALWAYS_INLINE quad<P> load4(Rows rows) {
    using S = typename P::scalar;
    if constexpr (P::width == 1) {
        const S* row = rows[0];
        return {{row[0]}, {row[1]}, {row[2]}, {row[3]}};
    } else if constexpr (requires { typename P::half; }) {
        const auto low = load4<typename P::half>(rows);
        const auto high = load4<typename P::half>(rows.from(P::width / 2));
        return {{low.x, high.x}, {low.y, high.y}, {low.z, high.z}, {low.w, high.w}};
#if PHYSICS_HPP_VECTOR_BYTES > 0
    } else if constexpr (P::width == 8) {
        using row = pack<S, 4, 16>;
        return transposed(join<P>(row::load(rows[0]), row::load(rows[4])),
                          join<P>(row::load(rows[1]), row::load(rows[5])),
                          join<P>(row::load(rows[2]), row::load(rows[6])),
                          join<P>(row::load(rows[3]), row::load(rows[7])));
    } else if constexpr (P::width == 4) {
        return transposed(P::load(rows[0]), P::load(rows[1]), P::load(rows[2]), P::load(rows[3]));
    } else {
        const P a = P::load(rows[0]), b = P::load(rows[1]), c = P::load(rows[0] + 2), d = P::load(rows[1] + 2);
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 2)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 1, 3)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 2)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 1, 3)}};
#endif
    }
}

/// Writes a row of four scalars for each lane, in the order of the lanes: where two lanes stand for one row, the later
/// one stays.
template <class P, class Rows>
PHYSICS_HPP_ALWAYS_INLINE void store4(Rows rows, const quad<P>& columns) {
    if constexpr (P::width == 1) {
        auto* row = rows[0];
        row[0] = columns.x.value;
        row[1] = columns.y.value;
        row[2] = columns.z.value;
        row[3] = columns.w.value;
    } else if constexpr (requires { typename P::half; }) {
        using half = typename P::half;
        store4(rows, quad<half>{columns.x.low, columns.y.low, columns.z.low, columns.w.low});
        store4(rows.from(P::width / 2), quad<half>{columns.x.high, columns.y.high, columns.z.high, columns.w.high});
#if PHYSICS_HPP_VECTOR_BYTES > 0
    } else if constexpr (P::width == 2) {
        const auto x = columns.x.value, y = columns.y.value, z = columns.z.value, w = columns.w.value;
        P{PHYSICS_HPP_SHUFFLE(x, y, 0, 2)}.store(rows[0]);
        P{PHYSICS_HPP_SHUFFLE(z, w, 0, 2)}.store(rows[0] + 2);
        P{PHYSICS_HPP_SHUFFLE(x, y, 1, 3)}.store(rows[1]);
        P{PHYSICS_HPP_SHUFFLE(z, w, 1, 3)}.store(rows[1] + 2);
    } else {
        const quad<P> r = transposed(columns.x, columns.y, columns.z, columns.w);
        if constexpr (P::width == 4) {
            r.x.store(rows[0]);
            r.y.store(rows[1]);
            r.z.store(rows[2]);
            r.w.store(rows[3]);
        } else {
            half_of<false>(r.x).store(rows[0]);
            half_of<false>(r.y).store(rows[1]);
            half_of<false>(r.z).store(rows[2]);
            half_of<false>(r.w).store(rows[3]);
            half_of<true>(r.x).store(rows[4]);
            half_of<true>(r.y).store(rows[5]);
            half_of<true>(r.z).store(rows[6]);
            half_of<true>(r.w).store(rows[7]);
        }
#endif
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/pool.hpp
// =================================================================================================
// Slots with stable numbers: things come and go, handles go stale and know it.

PHYSICS_HPP_BEGIN

/// Items in numbered slots. A freed slot is used again, last freed first, under a new generation; a slot
/// whose generations are used up is retired, so a stale handle can never come alive. The order of slots
/// depends on the calls alone, never on memory. Moving from a pool empties it. Insert, erase, look-up: O(1).
template <class T>
class pool {
public:
    /// What a slot looks like from outside.
    struct place {
        std::uint32_t index;
        std::uint16_t generation;
    };

    pool() = default;
    pool(const pool&) = default;
    pool(pool&& other) noexcept { swap(other); }
    pool& operator=(const pool&) = default;
    pool& operator=(pool&& other) noexcept {
        pool taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~pool() = default;
    void swap(pool& other) noexcept {
        items_.swap(other.items_);
        slots_.swap(other.slots_);
        std::swap(free_, other.free_);
        std::swap(count_, other.count_);
    }

    place insert(const T& item) {
        std::uint32_t index = free_;
        if (index == none) {
            index = items_.size();
            items_.push(item);
            slots_.push({occupied, 1});
        } else {
            free_ = slots_[index].next;
            slots_[index].next = occupied;
            items_[index] = item;
        }
        ++count_;
        return {index, slots_[index].generation};
    }
    void erase(std::uint32_t index) {
        slot& s = slots_[index];
        --count_;
        if (s.generation == 0xffff) {
            s.next = retired;
            return;
        }
        ++s.generation;
        s.next = free_;
        free_ = index;
    }
    [[nodiscard]] bool contains(std::uint32_t index, std::uint16_t generation) const {
        return alive(index) && slots_[index].generation == generation;
    }
    [[nodiscard]] bool alive(std::uint32_t index) const {
        return index < slots_.size() && slots_[index].next == occupied;
    }
    [[nodiscard]] std::uint16_t generation(std::uint32_t index) const { return slots_[index].generation; }
    T& operator[](std::uint32_t index) { return items_[index]; }
    const T& operator[](std::uint32_t index) const { return items_[index]; }

    /// Number of items.
    [[nodiscard]] std::uint32_t count() const { return count_; }
    /// Number of slots, free ones included: every index is below it.
    [[nodiscard]] std::uint32_t slots() const { return slots_.size(); }
    /// The first occupied slot from index on, or slots() where there is none.
    [[nodiscard]] std::uint32_t next(std::uint32_t index) const {
        while (index < slots_.size() && slots_[index].next != occupied) ++index;
        return index;
    }
    /// Calls f(index, item) for every item in the order of slots.
    template <class F>
    void each(F&& f) {
        for (std::uint32_t i = next(0); i < slots(); i = next(i + 1)) f(i, items_[i]);
    }
    template <class F>
    void each(F&& f) const {
        for (std::uint32_t i = next(0); i < slots(); i = next(i + 1)) f(i, items_[i]);
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu, occupied = 0xfffffffeu, retired = 0xfffffffdu;
    struct slot {
        std::uint32_t next;  // the next free slot, or what the slot is
        std::uint16_t generation;
    };

    buffer<T> items_;
    buffer<slot> slots_;
    std::uint32_t free_ = none;
    std::uint32_t count_ = 0;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/base/probe.hpp
// =================================================================================================
// The floating-point environment: a proof at run time that arithmetic rounds as it should, and a guard that sees to it.

// What the probe looks at: arithmetic that is compiled where the macro stands, by the rules that hold there. Hence
// no function may be inlined. Define one in your own code to learn about that: float_environment<Name>().
#if defined(__GNUC__) || defined(__clang__)
#define PHYSICS_HPP_NOINLINE __attribute__((noinline))
#define PHYSICS_HPP_WRITTEN_ROOT(F, x) (sizeof(F) == 4 ? F(__builtin_sqrtf(float(x))) : F(__builtin_sqrt(double(x))))
#else
#define PHYSICS_HPP_NOINLINE __declspec(noinline)
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
    explicit float_fault_names(std::uint32_t mask) noexcept {
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
    float_control_scope() noexcept
        : saved_(detail::read_float_control()), exact_(detail::exact_float_control(saved_)) {
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
std::uint32_t control_faults() noexcept {
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
std::uint32_t code_faults() noexcept {
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

// =================================================================================================
// physics/base/raw_array.hpp
// =================================================================================================
// An array that nobody fills until it is used.

PHYSICS_HPP_BEGIN

namespace detail {

/// N values without a value: scratch on the stack, of which little is used. Write a place before you read it.
template <class T, int N>
struct raw_array {
    static_assert(std::is_trivially_copyable_v<T>);

    raw_array() {}
    template <std::integral I>
    T& operator[](I i) {
        return items[i];
    }
    template <std::integral I>
    const T& operator[](I i) const {
        return items[i];
    }

    union {
        T items[N];
    };
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/sort.hpp
// =================================================================================================
// Sorting numbers in linear time.

PHYSICS_HPP_BEGIN

namespace detail {

/// Sorts keys by their bits from `low` to below `high`, those that are alike in the order in which they came. Returns
/// where the sorted keys are: in `keys`, or in `spare`, which has room for as many. Cost: 2 ns a key for every 8 to 11
/// bits in which keys differ. Source: radix sort from the least digit (Seward 1954).
inline std::uint64_t* radix_sort(std::uint64_t* keys, std::uint64_t* spare, std::uint32_t count, int low, int high) {
    if (count <= 48) {
        const std::uint64_t mask =
            high - low >= 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << (high - low)) - 1) << low;
        for (std::uint32_t i = 1; i < count; ++i) {
            const std::uint64_t key = keys[i];
            std::uint32_t k = i;
            for (; k > 0 && (keys[k - 1] & mask) > (key & mask); --k) keys[k] = keys[k - 1];
            keys[k] = key;
        }
        return keys;
    }
    const int most = count < 4096 ? 8 : 11;
    const int passes = (high - low + most - 1) / most;
    for (int pass = 0; pass < passes; ++pass) {
        // Digits of even width: a last one of few bits would cost as much as a full one.
        const int from = low + (high - low) * pass / passes, to = low + (high - low) * (pass + 1) / passes;
        const std::uint32_t buckets = 1u << (to - from);
        std::uint32_t starts[2048];
        std::memset(starts, 0, buckets * sizeof *starts);
        for (std::uint32_t i = 0; i < count; ++i) ++starts[keys[i] >> from & (buckets - 1)];
        if (starts[keys[0] >> from & (buckets - 1)] == count) continue;
        std::uint32_t sum = 0;
        for (std::uint32_t b = 0; b < buckets; ++b) {
            const std::uint32_t here = starts[b];
            starts[b] = sum;
            sum += here;
        }
        for (std::uint32_t i = 0; i < count; ++i) spare[starts[keys[i] >> from & (buckets - 1)]++] = keys[i];
        std::uint64_t* sorted = spare;
        spare = keys;
        keys = sorted;
    }
    return keys;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/base/stage.hpp
// =================================================================================================
// The stages of a step. Policies name theirs, so that a recipe can list them in any order.

PHYSICS_HPP_BEGIN

namespace stage {
/// Which shapes a world knows: shapes<...>.
struct shapes {};
/// From boxes to pairs: all_pairs.
struct broadphase {};
/// From pairs to manifolds: best_per_pair.
struct narrowphase {};
/// From contacts to velocities: sequential_impulse.
struct solver {};
/// How velocities and poses advance: semi_implicit_euler.
struct integrator {};
/// Which features are left out: without<...>.
struct features {};
}  // namespace stage

PHYSICS_HPP_END

// =================================================================================================
// physics/space/vec.hpp
// =================================================================================================
// Vectors of two and three components, and their products.

PHYSICS_HPP_BEGIN

/// A vector of D scalars with the members x, y (and z).
template <class S, int D>
struct vec;

namespace detail {
/// Plain numbers that may fill a vector of S, so that `{0, -10}` serves every scalar.
template <class T, class S>
concept literal_for = std::is_arithmetic_v<T> && !std::same_as<T, S>;
/// Such a number as S, through double where S takes nothing nearer.
template <class S, class T>
constexpr S from_literal(T x) {
    if constexpr (std::constructible_from<S, T>)
        return static_cast<S>(x);
    else
        return static_cast<S>(static_cast<double>(x));
}
}  // namespace detail

template <class S>
struct vec<S, 2> {
    S x{}, y{};

    constexpr vec() = default;
    constexpr vec(S x_, S y_) : x(x_), y(y_) {}
    template <class A, class B>
        requires detail::literal_for<A, S> || detail::literal_for<B, S>
    constexpr vec(A x_, B y_) : x(detail::from_literal<S>(x_)), y(detail::from_literal<S>(y_)) {}

    static constexpr int size = 2;
    constexpr S& operator[](int i) { return i == 0 ? x : y; }
    constexpr const S& operator[](int i) const { return i == 0 ? x : y; }
    static constexpr vec filled(S value) { return {value, value}; }

    constexpr vec& operator+=(vec b) {
        x += b.x;
        y += b.y;
        return *this;
    }
    constexpr vec& operator-=(vec b) {
        x -= b.x;
        y -= b.y;
        return *this;
    }
    constexpr vec& operator*=(S s) {
        x *= s;
        y *= s;
        return *this;
    }
    friend bool operator==(vec, vec) = default;
};

template <class S>
constexpr vec<S, 2> operator+(vec<S, 2> a, vec<S, 2> b) {
    return {a.x + b.x, a.y + b.y};
}
template <class S>
constexpr vec<S, 2> operator-(vec<S, 2> a, vec<S, 2> b) {
    return {a.x - b.x, a.y - b.y};
}
template <class S>
constexpr vec<S, 2> operator-(vec<S, 2> a) {
    return {-a.x, -a.y};
}
template <class S>
constexpr vec<S, 2> operator*(vec<S, 2> a, std::type_identity_t<S> s) {
    return {a.x * s, a.y * s};
}
template <class S>
constexpr vec<S, 2> operator/(vec<S, 2> a, std::type_identity_t<S> s) {
    return {a.x / s, a.y / s};
}

template <class S>
struct vec<S, 3> {
    S x{}, y{}, z{};

    constexpr vec() = default;
    constexpr vec(S x_, S y_, S z_) : x(x_), y(y_), z(z_) {}
    template <class A, class B, class C>
        requires detail::literal_for<A, S> || detail::literal_for<B, S> || detail::literal_for<C, S>
    constexpr vec(A x_, B y_, C z_)
        : x(detail::from_literal<S>(x_)), y(detail::from_literal<S>(y_)), z(detail::from_literal<S>(z_)) {}

    static constexpr int size = 3;
    constexpr S& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr const S& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    static constexpr vec filled(S value) { return {value, value, value}; }

    constexpr vec& operator+=(vec b) {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    constexpr vec& operator-=(vec b) {
        x -= b.x;
        y -= b.y;
        z -= b.z;
        return *this;
    }
    constexpr vec& operator*=(S s) {
        x *= s;
        y *= s;
        z *= s;
        return *this;
    }
    friend bool operator==(vec, vec) = default;
};

template <class S>
constexpr vec<S, 3> operator+(vec<S, 3> a, vec<S, 3> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class S>
constexpr vec<S, 3> operator-(vec<S, 3> a, vec<S, 3> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class S>
constexpr vec<S, 3> operator-(vec<S, 3> a) {
    return {-a.x, -a.y, -a.z};
}
template <class S>
constexpr vec<S, 3> operator*(vec<S, 3> a, std::type_identity_t<S> s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class S>
constexpr vec<S, 3> operator/(vec<S, 3> a, std::type_identity_t<S> s) {
    return {a.x / s, a.y / s, a.z / s};
}
template <class S, int D>
constexpr vec<S, D> operator*(std::type_identity_t<S> s, vec<S, D> a) {
    return a * s;
}

/// Angular quantities (velocity, impulse, torque): a scalar in 2D, counter-clockwise; a vector in 3D.
template <class S, int D>
using angular = std::conditional_t<D == 2, S, vec<S, 3>>;

/// a * b + c * d, rounded once where S can.
template <class S>
constexpr S sum_of_products(S a, S b, S c, S d) {
    return narrow<S>(product(a, b) + product(c, d));
}
/// a * b - c * d, rounded once where S can.
template <class S>
constexpr S difference_of_products(S a, S b, S c, S d) {
    return narrow<S>(product(a, b) - product(c, d));
}

/// The dot product, not rounded where S can.
template <class S>
constexpr wide_of<S> wide_dot(vec<S, 2> a, vec<S, 2> b) {
    return product(a.x, b.x) + product(a.y, b.y);
}
template <class S>
constexpr wide_of<S> wide_dot(vec<S, 3> a, vec<S, 3> b) {
    return product(a.x, b.x) + product(a.y, b.y) + product(a.z, b.z);
}
/// The dot product.
template <class S, int D>
constexpr S dot(vec<S, D> a, vec<S, D> b) {
    return narrow<S>(wide_dot(a, b));
}

/// The cross product: in 2D its one component, positive where b lies counter-clockwise of a.
template <class S>
constexpr S cross(vec<S, 2> a, vec<S, 2> b) {
    return difference_of_products(a.x, b.y, a.y, b.x);
}
template <class S>
constexpr vec<S, 3> cross(vec<S, 3> a, vec<S, 3> b) {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}
/// The velocity at lever r of a body that turns with w; in 3D it is cross(w, r).
template <class S>
constexpr vec<S, 2> cross(S w, vec<S, 2> r) {
    return {-(w * r.y), w * r.x};
}

/// The squared length, not rounded where S can: compare it with other wide numbers.
template <class S, int D>
constexpr wide_of<S> length_squared(vec<S, D> v) {
    return wide_dot(v, v);
}
/// The length.
template <class S, int D>
constexpr S length(vec<S, D> v) {
    return root<S>(length_squared(v));
}

/// The largest component by magnitude.
template <class S>
constexpr S largest(vec<S, 2> v) {
    return max(abs(v.x), abs(v.y));
}
template <class S>
constexpr S largest(vec<S, 3> v) {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

/// A vector as unit direction and length.
template <class S, int D>
struct direction_and_length {
    vec<S, D> direction;
    S length{};
};

/// Splits a vector into direction and length; a null vector gives a null direction. Scales by the largest
/// component first, so that neither tiny nor huge vectors lose their direction to underflow or overflow.
template <class S, int D>
constexpr direction_and_length<S, D> split(vec<S, D> v) {
    const S scale = largest(v);
    if (!(scale > S(0))) return {};
    const vec<S, D> scaled = v / scale;
    const S scaled_length = length(scaled);
    return {scaled / scaled_length, scaled_length * scale};
}

/// The unit vector along v; the null vector for the null vector.
template <class S, int D>
constexpr vec<S, D> normalized(vec<S, D> v) {
    return split(v).direction;
}

/// A unit vector across the unit vector n; in 2D n turned clockwise by a quarter.
template <class S>
constexpr vec<S, 2> perpendicular(vec<S, 2> n) {
    return {n.y, -n.x};
}
template <class S>
constexpr vec<S, 3> perpendicular(vec<S, 3> n) {
    // The branch keeps the longer of two candidates, so that its length is at least sqrt(1/2).
    return abs(n.x) > abs(n.z) ? normalized(vec<S, 3>{-n.y, n.x, S(0)}) : normalized(vec<S, 3>{S(0), -n.z, n.y});
}

template <class S>
constexpr vec<S, 2> min(vec<S, 2> a, vec<S, 2> b) {
    return {min(a.x, b.x), min(a.y, b.y)};
}
template <class S>
constexpr vec<S, 3> min(vec<S, 3> a, vec<S, 3> b) {
    return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class S>
constexpr vec<S, 2> max(vec<S, 2> a, vec<S, 2> b) {
    return {max(a.x, b.x), max(a.y, b.y)};
}
template <class S>
constexpr vec<S, 3> max(vec<S, 3> a, vec<S, 3> b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <class S>
constexpr vec<S, 2> abs(vec<S, 2> v) {
    return {abs(v.x), abs(v.y)};
}
template <class S>
constexpr vec<S, 3> abs(vec<S, 3> v) {
    return {abs(v.x), abs(v.y), abs(v.z)};
}
template <class S>
constexpr bool is_finite(vec<S, 2> v) {
    return is_finite(v.x) && is_finite(v.y);
}
template <class S>
constexpr bool is_finite(vec<S, 3> v) {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/aabb.hpp
// =================================================================================================
// Axis-aligned bounding boxes.

PHYSICS_HPP_BEGIN

/// An axis-aligned box from its lower to its upper corner; both belong to it.
template <class S, int D>
struct aabb {
    vec<S, D> lower;
    vec<S, D> upper;

    friend bool operator==(const aabb&, const aabb&) = default;
};

/// True if both corners are finite and none is on the wrong side of the other.
template <class S, int D>
constexpr bool is_box(const aabb<S, D>& a) {
    for (int i = 0; i < D; ++i)
        if (!(a.lower[i] <= a.upper[i])) return false;
    return is_finite(a.lower) && is_finite(a.upper);
}
/// True if the boxes share a point.
template <class S, int D>
constexpr bool overlap(const aabb<S, D>& a, const aabb<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
    return true;
}
/// True if a contains all of b.
template <class S, int D>
constexpr bool contains(const aabb<S, D>& a, const aabb<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (b.lower[i] < a.lower[i] || b.upper[i] > a.upper[i]) return false;
    return true;
}
/// The smallest box around both.
template <class S, int D>
constexpr aabb<S, D> merged(const aabb<S, D>& a, const aabb<S, D>& b) {
    return {min(a.lower, b.lower), max(a.upper, b.upper)};
}
/// The box, grown by a margin on every side.
template <class S, int D>
constexpr aabb<S, D> grown(const aabb<S, D>& a, S margin) {
    const vec<S, D> m = vec<S, D>::filled(margin);
    return {a.lower - m, a.upper + m};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/check.hpp
// =================================================================================================
// Checks of the user's numbers: each refuses a bad one by name and value, and says whether it was good.

PHYSICS_HPP_BEGIN

namespace detail {

template <class S>
bool check_finite(const char* function, const char* field, S value) {
    return is_finite(value) || refuse(function, field, static_cast<double>(value), "it must be finite");
}
template <class S, int D>
bool check_finite(const char* function, const char* field, vec<S, D> value) {
    for (int i = 0; i < D; ++i) {
        if (is_finite(value[i])) continue;
        const char component[] = {'.', "xyz"[i], '\0'};
        return refuse(function, field, component, static_cast<double>(value[i]), "it must be finite");
    }
    return true;
}
template <class S>
bool check_positive(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (value > S(0) || refuse(function, field, static_cast<double>(value), "it must be greater than 0"));
}
template <class S>
bool check_not_negative(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (!(value < S(0)) || refuse(function, field, static_cast<double>(value), "it must not be negative"));
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/space/mat.hpp
// =================================================================================================
// Square matrices, by columns, and symmetric 3x3 matrices.

PHYSICS_HPP_BEGIN

/// A D x D matrix, stored by columns.
template <class S, int D>
struct mat {
    vec<S, D> column[D];

    static constexpr mat identity() {
        mat m{};
        for (int i = 0; i < D; ++i) m.column[i][i] = S(1);
        return m;
    }
};

template <class S, int D>
constexpr vec<S, D> operator*(const mat<S, D>& m, vec<S, D> v) {
    vec<S, D> result;
    for (int i = 0; i < D; ++i) {
        wide_of<S> sum = product(m.column[0][i], v[0]) + product(m.column[1][i], v[1]);
        if constexpr (D == 3) sum = sum + product(m.column[2][i], v[2]);
        result[i] = narrow<S>(sum);
    }
    return result;
}
template <class S, int D>
constexpr mat<S, D> operator*(const mat<S, D>& a, const mat<S, D>& b) {
    mat<S, D> m{};
    for (int i = 0; i < D; ++i) m.column[i] = a * b.column[i];
    return m;
}
template <class S, int D>
constexpr bool operator==(const mat<S, D>& a, const mat<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (!(a.column[i] == b.column[i])) return false;
    return true;
}

/// The transposed matrix times v: the dot products of the columns with v.
template <class S>
constexpr vec<S, 2> transposed_times(const mat<S, 2>& m, vec<S, 2> v) {
    return {dot(m.column[0], v), dot(m.column[1], v)};
}
template <class S>
constexpr vec<S, 3> transposed_times(const mat<S, 3>& m, vec<S, 3> v) {
    return {dot(m.column[0], v), dot(m.column[1], v), dot(m.column[2], v)};
}
template <class S, int D>
constexpr mat<S, D> transposed(const mat<S, D>& m) {
    mat<S, D> t{};
    for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) t.column[i][j] = m.column[j][i];
    return t;
}

/// A symmetric 3x3 matrix by its six entries.
template <class S>
struct symmetric {
    S xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

    static constexpr symmetric diagonal(S x, S y, S z) { return {x, y, z, S(0), S(0), S(0)}; }
    friend bool operator==(const symmetric&, const symmetric&) = default;
};

template <class S>
constexpr symmetric<S> operator+(const symmetric<S>& a, const symmetric<S>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
template <class S>
constexpr symmetric<S> operator*(const symmetric<S>& a, std::type_identity_t<S> s) {
    return {a.xx * s, a.yy * s, a.zz * s, a.xy * s, a.xz * s, a.yz * s};
}

/// Matrix times vector; the matrix may be of a finer format than the vector.
template <class I, class S>
constexpr vec<S, 3> times(const symmetric<I>& m, vec<S, 3> v) {
    return {narrow<S>(product(m.xx, v.x) + product(m.xy, v.y) + product(m.xz, v.z)),
            narrow<S>(product(m.xy, v.x) + product(m.yy, v.y) + product(m.yz, v.z)),
            narrow<S>(product(m.xz, v.x) + product(m.yz, v.y) + product(m.zz, v.z))};
}

/// r * m * r^T for a rotation matrix r: m as seen from the frame that r leads to.
template <class I, class S>
constexpr symmetric<I> rotated(const symmetric<I>& m, const mat<S, 3>& r) {
    const auto row = [&](int i) {
        const S x = r.column[0][i], y = r.column[1][i], z = r.column[2][i];
        struct {
            I x, y, z;
        } result{narrow<I>(product(m.xx, x) + product(m.xy, y) + product(m.xz, z)),
                 narrow<I>(product(m.xy, x) + product(m.yy, y) + product(m.yz, z)),
                 narrow<I>(product(m.xz, x) + product(m.yz, y) + product(m.zz, z))};
        return result;
    };
    const auto entry = [&](const auto& a, int j) {
        return narrow<I>(product(a.x, r.column[0][j]) + product(a.y, r.column[1][j]) + product(a.z, r.column[2][j]));
    };
    const auto x = row(0), y = row(1), z = row(2);
    return {entry(x, 0), entry(y, 1), entry(z, 2), entry(x, 1), entry(x, 2), entry(y, 2)};
}

/// The inverse of a positive definite matrix in the finer format I; all zero if it is not positive
/// definite. By L D L^T, which needs no determinant: that would leave a fixed-point range.
template <class I, class S>
constexpr symmetric<I> inverse(const symmetric<S>& m) {
    const S d1 = m.xx;
    if (!(d1 > S(0))) return {};
    const S l21 = m.xy / d1, l31 = m.xz / d1;
    const S d2 = m.yy - l21 * m.xy;
    if (!(d2 > S(0))) return {};
    const S l32 = (m.yz - l21 * m.xz) / d2;
    const S d3 = m.zz - l31 * m.xz - l32 * (l32 * d2);
    if (!(d3 > S(0))) return {};
    const I e1 = reciprocal<I>(d1), e2 = reciprocal<I>(d2), e3 = reciprocal<I>(d3);
    const S m31 = l21 * l32 - l31;
    const I xy2 = -mul<I>(e2, l21), yz3 = -mul<I>(e3, l32), xz3 = mul<I>(e3, m31);
    return {e1 - mul<I>(xy2, l21) + mul<I>(xz3, m31), e2 - mul<I>(yz3, l32), e3, xy2 - mul<I>(xz3, l32), xz3, yz3};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/rotation2.hpp
// =================================================================================================
// Rotation in the plane: a unit complex number.

PHYSICS_HPP_BEGIN

/// A rotation in D dimensions. Both kinds offer: identity (the default), a * b (b first), a * v, inverse(a),
/// matrix(a), normalized(a), turned(a, angle) and is_finite(a).
template <class S, int D>
struct rotation;

/// A rotation in the plane, counter-clockwise, by its cosine and sine.
template <class S>
struct rotation<S, 2> {
    S cosine = S(1);
    S sine = S(0);

    constexpr rotation() = default;
    constexpr rotation(S cosine_, S sine_) : cosine(cosine_), sine(sine_) {}
    /// From an angle in radians; any scalar angle or plain number.
    static rotation from_angle(S radians) {
        const auto [s, c] = sine_cosine(radians);
        return {c, s};
    }
    /// The angle in radians, in [-pi, pi].
    [[nodiscard]] S angle() const { return atan2(sine, cosine); }

    friend bool operator==(rotation, rotation) = default;
};

template <class S>
constexpr rotation<S, 2> operator*(rotation<S, 2> a, rotation<S, 2> b) {
    return {difference_of_products(a.cosine, b.cosine, a.sine, b.sine),
            sum_of_products(a.sine, b.cosine, a.cosine, b.sine)};
}
template <class S>
constexpr vec<S, 2> operator*(rotation<S, 2> a, vec<S, 2> v) {
    return {difference_of_products(a.cosine, v.x, a.sine, v.y), sum_of_products(a.sine, v.x, a.cosine, v.y)};
}

template <class S>
constexpr rotation<S, 2> inverse(rotation<S, 2> a) {
    return {a.cosine, -a.sine};
}
/// The rotation that undoes a, times v.
template <class S>
constexpr vec<S, 2> inverse_rotate(rotation<S, 2> a, vec<S, 2> v) {
    return {sum_of_products(a.cosine, v.x, a.sine, v.y), difference_of_products(a.cosine, v.y, a.sine, v.x)};
}
template <class S>
constexpr mat<S, 2> matrix(rotation<S, 2> a) {
    return {{{a.cosine, a.sine}, {-a.sine, a.cosine}}};
}
template <class S>
constexpr bool is_finite(rotation<S, 2> a) {
    return is_finite(a.cosine) && is_finite(a.sine);
}
/// | |a|^2 - 1 |: how far a is from a rotation.
template <class S>
constexpr S norm_error(rotation<S, 2> a) {
    return abs(sum_of_products(a.cosine, a.cosine, a.sine, a.sine) - S(1));
}
/// a with length 1; the identity if a is null.
template <class S>
constexpr rotation<S, 2> normalized(rotation<S, 2> a) {
    const auto [unit, length] = split(vec<S, 2>{a.cosine, a.sine});
    if (!(length > S(0))) return {};
    return {unit.x, unit.y};
}

/// The angle of a in radians, in [-pi, pi]; in space the rotation vector, axis times angle.
template <class S>
S rotation_vector(rotation<S, 2> a) {
    return a.angle();
}

namespace detail {
/// tan(x) / x by its series for x^2 = xx <= 1/16, relative error < 9e-9 there and 9e-16 at x = 1/20. A
/// rotation built from the tangent has length 1 whatever its error, so a cut series costs angle, never scale.
template <class S>
constexpr S tangent_ratio(S xx) {
    return S(1) + xx * (S(1.0 / 3) + xx * (S(2.0 / 15) + xx * (S(17.0 / 315) + xx * S(62.0 / 2835))));
}
/// The factor of one Newton step towards length 1: enough for the rounding of one product.
template <class S>
constexpr S length_repair(S squared_length) {
    return S(1.5) - S(0.5) * squared_length;
}
}  // namespace detail

/// a, turned further by an angle in radians; keeps length 1. Half a radian at most goes without trigonometry
/// (relative error of the angle < 9e-9), more through sine and cosine. Source: the Cayley map.
template <class S>
constexpr rotation<S, 2> turned(rotation<S, 2> a, S angle) {
    const S half = angle * S(0.5);
    if (abs(half) > S(0.25)) return normalized(rotation<S, 2>::from_angle(angle) * a);
    const S t = half * detail::tangent_ratio(half * half);
    const S scale = S(1) / (S(1) + t * t);
    const rotation<S, 2> r = rotation<S, 2>{(S(1) - t * t) * scale, (t + t) * scale} * a;
    const S repair = detail::length_repair(sum_of_products(r.cosine, r.cosine, r.sine, r.sine));
    return {r.cosine * repair, r.sine * repair};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/rotation3.hpp
// =================================================================================================
// Rotation in space: a unit quaternion.

PHYSICS_HPP_BEGIN

/// A rotation in space as a unit quaternion x i + y j + z k + w.
template <class S>
struct rotation<S, 3> {
    S x{}, y{}, z{};
    S w = S(1);

    constexpr rotation() = default;
    constexpr rotation(S x_, S y_, S z_, S w_) : x(x_), y(y_), z(z_), w(w_) {}
    /// By an angle in radians about a unit axis, counter-clockwise as seen from its tip.
    static rotation from_axis_angle(vec<S, 3> axis, S radians) {
        const auto [s, c] = sine_cosine(radians * S(0.5));
        return {axis.x * s, axis.y * s, axis.z * s, c};
    }
    [[nodiscard]] constexpr vec<S, 3> imaginary() const { return {x, y, z}; }

    friend bool operator==(rotation, rotation) = default;
};

template <class S>
constexpr rotation<S, 3> operator*(rotation<S, 3> a, rotation<S, 3> b) {
    const auto sum = [](auto p, auto q, auto r, auto s) { return narrow<S>(p + q + r + s); };
    return {sum(product(a.w, b.x), product(a.x, b.w), product(a.y, b.z), -product(a.z, b.y)),
            sum(product(a.w, b.y), product(a.y, b.w), product(a.z, b.x), -product(a.x, b.z)),
            sum(product(a.w, b.z), product(a.z, b.w), product(a.x, b.y), -product(a.y, b.x)),
            sum(product(a.w, b.w), -product(a.x, b.x), -product(a.y, b.y), -product(a.z, b.z))};
}
template <class S>
constexpr vec<S, 3> operator*(rotation<S, 3> a, vec<S, 3> v) {
    const vec<S, 3> t = cross(a.imaginary(), v) * S(2);
    return v + t * a.w + cross(a.imaginary(), t);
}

template <class S>
constexpr rotation<S, 3> inverse(rotation<S, 3> a) {
    return {-a.x, -a.y, -a.z, a.w};
}
/// The rotation that undoes a, times v.
template <class S>
constexpr vec<S, 3> inverse_rotate(rotation<S, 3> a, vec<S, 3> v) {
    return inverse(a) * v;
}
template <class S>
constexpr mat<S, 3> matrix(rotation<S, 3> a) {
    const S x2 = a.x + a.x, y2 = a.y + a.y, z2 = a.z + a.z;
    return {{{S(1) - sum_of_products(a.y, y2, a.z, z2), sum_of_products(a.x, y2, a.w, z2),
              difference_of_products(a.x, z2, a.w, y2)},
             {difference_of_products(a.x, y2, a.w, z2), S(1) - sum_of_products(a.x, x2, a.z, z2),
              sum_of_products(a.y, z2, a.w, x2)},
             {sum_of_products(a.x, z2, a.w, y2), difference_of_products(a.y, z2, a.w, x2),
              S(1) - sum_of_products(a.x, x2, a.y, y2)}}};
}
template <class S>
constexpr bool is_finite(rotation<S, 3> a) {
    return is_finite(a.imaginary()) && is_finite(a.w);
}

namespace detail {
template <class S>
constexpr S squared_norm(rotation<S, 3> a) {
    return narrow<S>(wide_dot(a.imaginary(), a.imaginary()) + product(a.w, a.w));
}
}  // namespace detail

/// | |a|^2 - 1 |: how far a is from a rotation.
template <class S>
constexpr S norm_error(rotation<S, 3> a) {
    return abs(detail::squared_norm(a) - S(1));
}
/// a with length 1; the identity if a is null.
template <class S>
constexpr rotation<S, 3> normalized(rotation<S, 3> a) {
    const S scale = max(largest(a.imaginary()), abs(a.w));
    if (!(scale > S(0))) return {};
    const rotation<S, 3> b{a.x / scale, a.y / scale, a.z / scale, a.w / scale};
    const S norm = sqrt(detail::squared_norm(b));
    return {b.x / norm, b.y / norm, b.z / norm, b.w / norm};
}

/// Axis times angle of a (radians, at most pi), so that turned({}, rotation_vector(a)) is a again.
template <class S>
vec<S, 3> rotation_vector(rotation<S, 3> a) {
    const auto [axis, sine] = split(a.w < S(0) ? -a.imaginary() : a.imaginary());
    return axis * (atan2(sine, abs(a.w)) * S(2));
}

/// a, turned further by a rotation vector (axis times angle, radians, in the outer frame); keeps length 1.
/// One radian at most goes without trigonometry, as in the plane.
template <class S>
constexpr rotation<S, 3> turned(rotation<S, 3> a, vec<S, 3> angle) {
    const vec<S, 3> quarter = angle * S(0.25);
    const S xx = dot(quarter, quarter);
    if (largest(quarter) > S(0.25) || xx > S(0.0625)) {
        const auto [axis, radians] = split(angle);
        return normalized(rotation<S, 3>::from_axis_angle(axis, radians) * a);
    }
    const vec<S, 3> t = quarter * detail::tangent_ratio(xx);
    const S tt = dot(t, t);
    const S scale = S(1) / (S(1) + tt);
    const vec<S, 3> v = t * (scale + scale);
    const rotation<S, 3> r = rotation<S, 3>{v.x, v.y, v.z, (S(1) - tt) * scale} * a;
    const S repair = detail::length_repair(detail::squared_norm(r));
    return {r.x * repair, r.y * repair, r.z * repair, r.w * repair};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/transform.hpp
// =================================================================================================
// Rigid transforms, twists and boxes.

PHYSICS_HPP_BEGIN

/// A rigid transform: first the rotation, then the translation to position (metres).
template <class S, int D>
struct transform {
    vec<S, D> position;
    physics::rotation<S, D> rotation;

    friend bool operator==(const transform&, const transform&) = default;
};

/// The point p, given in the inner frame, in the outer one.
template <class S, int D>
constexpr vec<S, D> operator*(const transform<S, D>& t, vec<S, D> p) { return t.rotation * p + t.position; }
/// b first, then a.
template <class S, int D>
constexpr transform<S, D> operator*(const transform<S, D>& a, const transform<S, D>& b) {
    return {a * b.position, a.rotation * b.rotation};
}

/// The transform that undoes t.
template <class S, int D>
constexpr transform<S, D> inverse(const transform<S, D>& t) {
    return {-inverse_rotate(t.rotation, t.position), inverse(t.rotation)};
}
/// The point p, given in the outer frame, in the inner one.
template <class S, int D>
constexpr vec<S, D> inverse_transform(const transform<S, D>& t, vec<S, D> p) {
    return inverse_rotate(t.rotation, p - t.position);
}
/// The frame b as seen from a: a * relative(a, b) == b. Subtracts positions first, so that two bodies far
/// from the origin keep the precision of their distance.
template <class S, int D>
constexpr transform<S, D> relative(const transform<S, D>& a, const transform<S, D>& b) {
    return {inverse_rotate(a.rotation, b.position - a.position), inverse(a.rotation) * b.rotation};
}
template <class S, int D>
constexpr bool is_finite(const transform<S, D>& t) {
    return is_finite(t.position) && is_finite(t.rotation);
}

/// Linear velocity (m/s) and angular velocity (rad/s) of a body, or an impulse and its moment.
template <class S, int D>
struct twist {
    vec<S, D> linear;
    physics::angular<S, D> angular{};

    friend bool operator==(const twist&, const twist&) = default;
};

template <class S, int D>
constexpr twist<S, D> operator+(const twist<S, D>& a, const twist<S, D>& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}

/// The velocity of the point at lever r from the centre of mass.
template <class S, int D>
constexpr vec<S, D> velocity_at(const twist<S, D>& v, vec<S, D> r) {
    return v.linear + cross(v.angular, r);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/space/inertia.hpp
// =================================================================================================
// Mass, centre and rotational inertia: a scalar in 2D, a symmetric tensor in 3D.

PHYSICS_HPP_BEGIN

/// Rotational inertia: kg m^2 about the axis out of the plane in 2D, a symmetric tensor in 3D.
template <class S, int D>
using inertia = std::conditional_t<D == 2, S, symmetric<S>>;
/// The inverse of an inertia, in the scalar's inverse format.
template <class S, int D>
using inverse_inertia = std::conditional_t<D == 2, inverse_of<S>, symmetric<inverse_of<S>>>;

/// Mass (kg), centre of mass (m) and inertia about that centre (kg m^2).
template <class S, int D>
struct mass_properties {
    S mass{};
    vec<S, D> center;
    physics::inertia<S, D> inertia{};
};

/// The inertia of a point mass at r: what the parallel-axis theorem adds.
template <class S>
constexpr S point_inertia(S mass, vec<S, 2> r) {
    return mass * dot(r, r);
}
template <class S>
constexpr symmetric<S> point_inertia(S mass, vec<S, 3> r) {
    const S xx = r.x * r.x, yy = r.y * r.y, zz = r.z * r.z;
    return symmetric<S>{yy + zz, xx + zz, xx + yy, -(r.x * r.y), -(r.x * r.z), -(r.y * r.z)} * mass;
}

/// The mass properties as seen from the frame that t leads to.
template <class S>
constexpr mass_properties<S, 2> transformed(const mass_properties<S, 2>& m, const transform<S, 2>& t) {
    return {m.mass, t * m.center, m.inertia};
}
template <class S>
constexpr mass_properties<S, 3> transformed(const mass_properties<S, 3>& m, const transform<S, 3>& t) {
    return {m.mass, t * m.center, rotated(m.inertia, matrix(t.rotation))};
}

/// Two rigidly joined masses as one. Source: the parallel-axis (Huygens-Steiner) theorem.
template <class S, int D>
constexpr mass_properties<S, D> combined(const mass_properties<S, D>& a, const mass_properties<S, D>& b) {
    const S mass = a.mass + b.mass;
    if (!(mass > S(0))) return a;
    const vec<S, D> center = a.center + (b.center - a.center) * (b.mass / mass);
    return {
        mass, center,
        a.inertia + point_inertia(a.mass, a.center - center) + b.inertia + point_inertia(b.mass, b.center - center)};
}

/// The inverse inertia; zero if the inertia is not positive (definite).
template <class S>
constexpr inverse_of<S> inverted_inertia(S inertia) {
    return inertia > S(0) ? reciprocal<inverse_of<S>>(inertia) : inverse_of<S>(0);
}
template <class S>
constexpr symmetric<inverse_of<S>> inverted_inertia(const symmetric<S>& inertia) {
    return inverse<inverse_of<S>>(inertia);
}

/// True if the inertia is the same about every axis.
template <class S>
constexpr bool is_isotropic(S) {
    return true;
}
template <class S>
constexpr bool is_isotropic(const symmetric<S>& m) {
    return m.xx == m.yy && m.yy == m.zz && m.xy == S(0) && m.xz == S(0) && m.yz == S(0);
}

/// The inverse inertia of a body with the given rotation, in world axes.
template <class S>
constexpr inverse_of<S> in_world(inverse_of<S> local, const rotation<S, 2>&) {
    return local;
}
template <class S>
constexpr symmetric<inverse_of<S>> in_world(const symmetric<inverse_of<S>>& local, const rotation<S, 3>& r) {
    return rotated(local, matrix(r));
}

/// Inverse inertia times an angular impulse: the change of angular velocity.
template <class I, class S>
    requires std::same_as<I, inverse_of<S>>
constexpr S times(I inverse_inertia, S moment) { return mul<S>(inverse_inertia, moment); }

PHYSICS_HPP_END

// =================================================================================================
// physics/space/orientation.hpp
// =================================================================================================
// On which side of a line or plane a point lies: never wrong, so that what is built on it never breaks.

PHYSICS_HPP_BEGIN

namespace detail {

/// The smallest power of two above |x|; x finite and normal, or 0, which gives the smallest of all.
inline double power_above(double x) {
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff;
    return std::bit_cast<double>((exponent < 2046 ? exponent + 1 : exponent) << 52);
}

/// high * 2^64 + low, of which the sign is wanted.
struct sum192 {
    int128 high, low;

    /// Adds m * d, |d| < 2^61, for |m| < 2^122.
    void add(int128 m, std::int64_t d) {
        high = high + product128((m >> 64).low(), d);
        const int128 rest(product128(static_cast<std::uint64_t>(m.low()), magnitude64(d)));
        low = d < 0 ? low - rest : low + rest;
    }
    [[nodiscard]] int sign() const {
        const int128 top = high + (low >> 64);
        if (top.negative()) return -1;
        return top == int128{} && low.low() == 0 ? 0 : 1;
    }
};

/// Orientation of points whose coordinates are below `size` in magnitude: the exact answer for the points' places on
/// a grid of size * 2^-59, which is finer than the spacing of numbers near size. As a function of fixed points it has
/// no contradictions, whatever rounding does. Cost: 2 ns where doubles decide, 20-40 ns where integers have to.
/// Source: the idea of filters is Shewchuk's, Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates (1997); integers take the place of his expansions.
class orientation {
public:
    /// size: a power of two from 2^-900 to 2^900.
    explicit orientation(double size) : scale_(0x1p59 / size), step_(size * 0x1p-59) {}

    /// 1 if d lies where (b - a) x (c - a) points, -1 on the other side, 0 in the plane.
    [[nodiscard]] int of(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c,
                         const vec<double, 3>& d) const {
        return side(plane(*this, a, b, c), a, b, c, d);
    }
    /// 1 if c lies to the left of the line from a to b, -1 to its right, 0 on it.
    [[nodiscard]] int of(const vec<double, 2>& a, const vec<double, 2>& b, const vec<double, 2>& c) const {
        const vec<double, 2> e = b - a, f = c - a;
        const double det = e.x * f.y - e.y * f.x, le = largest(e), lf = largest(f);
        const double error = 0x1p-49 * le * lf + 8 * step_ * (le + lf + step_);
        if (det > error) return 1;
        if (det < -error) return -1;
        const int128 exact = product128(at(b.x) - at(a.x), at(c.y) - at(a.y)) -
                             product128(at(b.y) - at(a.y), at(c.x) - at(a.x));
        return exact.negative() ? -1 : exact == int128{} ? 0 : 1;
    }

    /// A plane through three points, to be asked about many. The points are its caller's.
    class plane {
    public:
        plane() = default;
        plane(const orientation& grid, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c)
            : normal_(cross(b - a, c - a)) {
            const double e = largest(b - a), f = largest(c - a), step = grid.step_;
            // Rounding of 6 products of three differences, and differences that the grid moves by up to 2 steps.
            constant_ = 16 * step * (e * f + step * (e + f + step));
            slope_ = 0x1p-46 * e * f + 16 * step * (e + f + step);
        }
        /// (b - a) x (c - a).
        [[nodiscard]] const vec<double, 3>& normal() const { return normal_; }

    private:
        friend class orientation;
        vec<double, 3> normal_;
        double constant_ = 0, slope_ = 0;
    };
    /// On which side of the plane through a, b and c the point p lies: 1 where the normal points, 0 in the plane.
    [[nodiscard]] int side(const plane& through, const vec<double, 3>& a, const vec<double, 3>& b,
                           const vec<double, 3>& c, const vec<double, 3>& p) const {
        const vec<double, 3> q = p - a;
        const double det = dot(through.normal_, q), error = through.constant_ + through.slope_ * largest(q);
        if (det > error) return 1;
        if (det < -error) return -1;
        return exact_side(a, b, c, p);
    }
    /// The same without asking doubles first.
    [[nodiscard]] PHYSICS_HPP_COLD int exact_side(const vec<double, 3>& a, const vec<double, 3>& b,
                                                  const vec<double, 3>& c, const vec<double, 3>& p) const {
        std::int64_t e[3], f[3], q[3];
        for (int i = 0; i < 3; ++i) {
            const std::int64_t from = at(a[i]);
            e[i] = at(b[i]) - from;
            f[i] = at(c[i]) - from;
            q[i] = at(p[i]) - from;
        }
        sum192 det{};
        for (int i = 0; i < 3; ++i) {
            const int j = i < 2 ? i + 1 : 0, k = i > 0 ? i - 1 : 2;
            det.add(product128(e[j], f[k]) - product128(e[k], f[j]), q[i]);
        }
        return det.sign();
    }

private:
    [[nodiscard]] std::int64_t at(double x) const { return static_cast<std::int64_t>(x * scale_); }

    double scale_, step_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/space/space.hpp
// =================================================================================================
// One name for all types of a world's space.

PHYSICS_HPP_BEGIN

/// The types of a world with scalar S in D dimensions; policies rebind themselves to one of these.
template <class S, int D>
struct space {
    using scalar = S;
    static constexpr int dimension = D;
    using vec = physics::vec<S, D>;
    using angular = physics::angular<S, D>;
    using rotation = physics::rotation<S, D>;
    using transform = physics::transform<S, D>;
    using twist = physics::twist<S, D>;
    using aabb = physics::aabb<S, D>;
    using inertia = physics::inertia<S, D>;
    using inverse = inverse_of<S>;
    using inverse_inertia = physics::inverse_inertia<S, D>;
    using mass_properties = physics::mass_properties<S, D>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/concept.hpp
// =================================================================================================
// What a shape must offer.

PHYSICS_HPP_BEGIN

/// A shape for the scalar S in D dimensions: a trivially copyable value with free functions
///   check(shape, function)       refuses bad numbers (see error.hpp) and says whether all are good
///   bounds(shape, transform)     the axis-aligned box around the shape at that transform
///   as<T>()                      a member: the same shape with the scalar T
/// and, where dynamic bodies may carry it,
///   mass_of(shape, density)      mass properties; density in kg/m^3 (kg/m^2 in 2D)
///   support(shape, direction)    the farthest point of the shape along a direction, in its own frame
template <class Shape, class S, int D>
concept shape_for = std::is_trivially_copyable_v<Shape> && requires(const Shape shape, const transform<S, D> at) {
    { check(shape, "function") } -> std::same_as<bool>;
    { bounds(shape, at) } -> std::same_as<aabb<S, D>>;
    shape.template as<double>();
};

/// A shape that has a mass.
template <class Shape, class S, int D>
concept solid_shape_for = shape_for<Shape, S, D> && requires(const Shape shape, S density, vec<S, D> direction) {
    { mass_of(shape, density) } -> std::same_as<mass_properties<S, D>>;
    { support(shape, direction) } -> std::same_as<vec<S, D>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/ball.hpp
// =================================================================================================
// The ball: a circle in 2D, a sphere in 3D.

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the centre, which is the origin of the shape's frame.
template <class S, int D>
struct ball {
    using scalar = S;
    S radius = S(0.5);

    /// The same shape with another scalar.
    template <class T>
    [[nodiscard]] constexpr ball<T, D> as() const {
        return {static_cast<T>(radius)};
    }
};
/// A ball, by its name in 2D.
template <class S, int D = 2>
using circle = ball<S, D>;
/// A ball, by its name in 3D.
template <class S, int D = 3>
using sphere = ball<S, D>;

template <class S, int D>
bool check(const ball<S, D>& b, const char* function) {
    return detail::check_positive(function, "radius", b.radius);
}
template <class S, int D>
constexpr aabb<S, D> bounds(const ball<S, D>& b, const transform<S, D>& at) {
    return grown(aabb<S, D>{at.position, at.position}, b.radius);
}
template <class S, int D>
constexpr vec<S, D> support(const ball<S, D>& b, vec<S, D> direction) {
    return normalized(direction) * b.radius;
}
template <class S>
constexpr mass_properties<S, 2> mass_of(const ball<S, 2>& b, S density) {
    const S rr = b.radius * b.radius;
    const S mass = density * pi<S> * rr;
    return {mass, {}, mass * (rr * S(0.5))};
}
template <class S>
constexpr mass_properties<S, 3> mass_of(const ball<S, 3>& b, S density) {
    const S rr = b.radius * b.radius;
    const S mass = density * (S(4) * pi<S> / S(3)) * rr * b.radius;
    const S i = mass * (rr * S(0.4));
    return {mass, {}, symmetric<S>::diagonal(i, i, i)};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/geometry.hpp
// =================================================================================================
// Blocks of immutable geometry, such as the vertices of a hull, that many shapes share; and who owns them.

#if !defined(__GNUC__) && !defined(__clang__)
#include <intrin.h>
#endif

PHYSICS_HPP_BEGIN

namespace detail {

/// The head of a block of memory that is filled once and never changes: how many own it. Arrays follow at offsets.
/// Blocks have no destructors; the last release() frees the memory.
struct geometry_block {
    /// What malloc gave; the block begins at the next multiple of `alignment`.
    void* memory = nullptr;
    mutable long owners = 1;
    /// Called, unless null, before the memory goes: with it goes what the block owns.
    void (*gone)(const geometry_block*) = nullptr;

    static constexpr std::size_t alignment = 32;
};

/// A block of so many bytes, owned once, its head constructed and the rest zero.
template <class Block>
Block* new_geometry(std::size_t bytes) {
    static_assert(std::is_base_of_v<geometry_block, Block> && std::is_trivially_destructible_v<Block> &&
                  alignof(Block) <= geometry_block::alignment);
    void* memory = std::calloc(bytes + geometry_block::alignment, 1);
    if (memory == nullptr) {
        // As for buffers: nobody can go on without the memory.
        refuse("geometry", "memory", static_cast<double>(bytes), "the bytes are not available");
        std::abort();
    }
    const std::uintptr_t place = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t ahead = geometry_block::alignment - place % geometry_block::alignment;
    Block* block = new (static_cast<void*>(static_cast<unsigned char*>(memory) + ahead)) Block;
    block->memory = memory;
    return block;
}

/// One owner more; any thread, null does nothing.
inline void retain(const geometry_block* block) {
    if (block == nullptr) return;
#if defined(__GNUC__) || defined(__clang__)
    __atomic_fetch_add(&block->owners, 1, __ATOMIC_RELAXED);
#else
    _InterlockedIncrement(&block->owners);
#endif
}
/// One owner less; the last one frees the block. Any thread, null does nothing.
inline void release(const geometry_block* block) {
    if (block == nullptr) return;
#if defined(__GNUC__) || defined(__clang__)
    const long left = __atomic_sub_fetch(&block->owners, 1, __ATOMIC_ACQ_REL);
#else
    const long left = _InterlockedDecrement(&block->owners);
#endif
    if (left != 0) return;
    if (block->gone != nullptr) block->gone(block);
    std::free(block->memory);
}

/// One of the owners of a block, or of none: copies share it.
template <class Block>
class geometry_owner {
public:
    geometry_owner() = default;
    /// Takes over the ownership that the caller has.
    explicit geometry_owner(const Block* owned) : block_(owned) {}
    geometry_owner(const geometry_owner& other) : block_(other.block_) { retain(block_); }
    geometry_owner(geometry_owner&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
    geometry_owner& operator=(geometry_owner other) noexcept {
        std::swap(block_, other.block_);
        return *this;
    }
    ~geometry_owner() { release(block_); }

    [[nodiscard]] const Block* get() const { return block_; }

private:
    const Block* block_ = nullptr;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/block_array.hpp
// =================================================================================================
// Arrays inside of a block of geometry.

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up how large a block gets, and where in it arrays begin: each at a multiple of 32 bytes.
class block_layout {
public:
    explicit block_layout(std::size_t head) : end_(head) {}
    template <class T>
    std::size_t place(std::size_t count) {
        const std::size_t begin = (end_ + 31) & ~std::size_t{31};
        end_ = begin + count * sizeof(T);
        return begin;
    }
    [[nodiscard]] std::size_t bytes() const { return end_; }

private:
    std::size_t end_;
};

/// An array that lies further on in the block of which this is a member. It knows how far, so that it holds no pointer
/// and cannot be copied.
template <class T>
class block_array {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    block_array() = default;
    block_array(const block_array&) = delete;
    block_array& operator=(const block_array&) = delete;

    /// Lets the array begin so many bytes into the block, whose memory is zero.
    void attach(const geometry_block* block, std::size_t offset, std::uint32_t count) {
        distance_ = reinterpret_cast<std::uintptr_t>(block) + offset - reinterpret_cast<std::uintptr_t>(this);
        size_ = count;
    }
    [[nodiscard]] std::uint32_t size() const { return size_; }
    [[nodiscard]] const T* begin() const {
        return reinterpret_cast<const T*>(reinterpret_cast<const unsigned char*>(this) + distance_);
    }
    [[nodiscard]] const T* end() const { return begin() + size_; }
    [[nodiscard]] T* begin() { return reinterpret_cast<T*>(reinterpret_cast<unsigned char*>(this) + distance_); }
    [[nodiscard]] const T& operator[](std::uint32_t i) const { return begin()[i]; }
    [[nodiscard]] T& operator[](std::uint32_t i) { return begin()[i]; }

private:
    std::size_t distance_ = 0;
    std::uint32_t size_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/box.hpp
// =================================================================================================
// The box: a rectangle in 2D, a cuboid in 3D.

PHYSICS_HPP_BEGIN

/// All points p with |p_i| <= half_extents_i (m) in the shape's frame.
template <class S, int D>
struct box {
    using scalar = S;
    vec<S, D> half_extents = vec<S, D>::filled(S(0.5));

    template <class T>
    [[nodiscard]] constexpr box<T, D> as() const {
        box<T, D> result;
        for (int i = 0; i < D; ++i) result.half_extents[i] = static_cast<T>(half_extents[i]);
        return result;
    }
};

template <class S, int D>
bool check(const box<S, D>& b, const char* function) {
    constexpr const char* names[] = {"half_extents.x", "half_extents.y", "half_extents.z"};
    for (int i = 0; i < D; ++i)
        if (!detail::check_positive(function, names[i], b.half_extents[i])) return false;
    return true;
}
template <class S, int D>
constexpr aabb<S, D> bounds(const box<S, D>& b, const transform<S, D>& at) {
    const mat<S, D> m = matrix(at.rotation);
    vec<S, D> reach;
    for (int i = 0; i < D; ++i) reach += abs(m.column[i] * b.half_extents[i]);
    return {at.position - reach, at.position + reach};
}
template <class S, int D>
constexpr vec<S, D> support(const box<S, D>& b, vec<S, D> direction) {
    vec<S, D> corner = b.half_extents;
    for (int i = 0; i < D; ++i)
        if (direction[i] < S(0)) corner[i] = -corner[i];
    return corner;
}
template <class S>
constexpr mass_properties<S, 2> mass_of(const box<S, 2>& b, S density) {
    const vec<S, 2> h = b.half_extents;
    const S mass = density * S(4) * h.x * h.y;
    return {mass, {}, mass * (dot(h, h) / S(3))};
}
template <class S>
constexpr mass_properties<S, 3> mass_of(const box<S, 3>& b, S density) {
    const vec<S, 3> h = b.half_extents;
    const S mass = density * S(8) * h.x * h.y * h.z;
    const S xx = h.x * h.x, yy = h.y * h.y, zz = h.z * h.z;
    return {mass,
            {},
            symmetric<S>::diagonal(mass * ((yy + zz) / S(3)), mass * ((xx + zz) / S(3)), mass * ((xx + yy) / S(3)))};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/box_ray.hpp
// =================================================================================================
// Which boxes a line segment meets.

PHYSICS_HPP_BEGIN

namespace detail {

/// A line segment that searches for boxes: no answer leaves out what it meets, some include what it passes by less than
/// rounding.
template <int D>
class box_ray {
public:
    /// From `origin` along `way`; `reach` is what boxes are to be grown by.
    box_ray(const vec<double, D>& origin, const vec<double, D>& way, double reach) : origin_(origin), way_(way) {
        // The coordinates may be off by as much already.
        reach_ = reach + 0x1p-46 * (largest(origin) + largest(way));
        for (int i = 0; i < D; ++i) {
            crosses_[i] = abs(way[i]) > 1e-250;
            inverse_[i] = crosses_[i] ? 1 / way[i] : 0;
        }
    }
    /// Whether it may meet the box before it has made more than the part `most` of its way.
    template <class R>
    [[nodiscard]] bool meets(const aabb<R, D>& box, double most) const {
        double near = 0, far = most;
        for (int i = 0; i < D; ++i) {
            const double lower = static_cast<double>(box.lower[i]) - reach_ - origin_[i];
            const double upper = static_cast<double>(box.upper[i]) + reach_ - origin_[i];
            if (crosses_[i]) {
                const double a = lower * inverse_[i], b = upper * inverse_[i];
                near = max(near, min(a, b));
                far = min(far, max(a, b));
            } else if (lower > abs(way_[i]) || upper < -abs(way_[i])) {
                return false;
            }
        }
        // Each of them is known to three roundings.
        return near <= far * (1 + 0x1p-49);
    }
    /// The box around all of it.
    [[nodiscard]] aabb<double, D> bounds() const { return box_of_part(0, 1); }
    /// The box around what is between two coordinates along an axis; false if nothing is.
    [[nodiscard]] bool bounds_between(int axis, double low, double high, aabb<double, D>& box) const {
        double near = 0, far = 1;
        if (crosses_[axis]) {
            const double a = (low - reach_ - origin_[axis]) * inverse_[axis];
            const double b = (high + reach_ - origin_[axis]) * inverse_[axis];
            near = max(near, min(a, b) * (1 - 0x1p-50));
            far = min(far, max(a, b) * (1 + 0x1p-50));
        }
        box = box_of_part(near, far);
        return near <= far;
    }

private:
    aabb<double, D> box_of_part(double near, double far) const {
        const vec<double, D> a = origin_ + way_ * near, b = origin_ + way_ * far;
        return grown(aabb<double, D>{min(a, b), max(a, b)}, reach_);
    }

    vec<double, D> origin_, way_, inverse_;
    double reach_;
    bool crosses_[D];
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/capsule.hpp
// =================================================================================================
// The capsule: all points near a segment.

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the segment from (-half_length, 0) to (half_length, 0) on the x axis of
/// the shape's frame.
template <class S, int D>
struct capsule {
    using scalar = S;
    S half_length = S(0.5);
    S radius = S(0.25);

    template <class T>
    [[nodiscard]] constexpr capsule<T, D> as() const {
        return {static_cast<T>(half_length), static_cast<T>(radius)};
    }
};

template <class S, int D>
bool check(const capsule<S, D>& c, const char* function) {
    return detail::check_positive(function, "half_length", c.half_length) &&
           detail::check_positive(function, "radius", c.radius);
}
namespace detail {
template <class S, int D>
constexpr vec<S, D> along_x(S x) {
    vec<S, D> v;
    v.x = x;
    return v;
}
}  // namespace detail
template <class S, int D>
constexpr aabb<S, D> bounds(const capsule<S, D>& c, const transform<S, D>& at) {
    const vec<S, D> reach = abs(at.rotation * detail::along_x<S, D>(c.half_length)) + vec<S, D>::filled(c.radius);
    return {at.position - reach, at.position + reach};
}
template <class S, int D>
constexpr vec<S, D> support(const capsule<S, D>& c, vec<S, D> direction) {
    return detail::along_x<S, D>(direction.x < S(0) ? -c.half_length : c.half_length) +
           normalized(direction) * c.radius;
}
/// Rectangle and two half discs, whose centroids lie 4 r / (3 pi) outwards of their flat sides.
template <class S>
constexpr mass_properties<S, 2> mass_of(const capsule<S, 2>& c, S density) {
    const S l = c.half_length, r = c.radius, rr = r * r, ll = l * l;
    const S middle = density * S(4) * l * r;
    const S ends = density * pi<S> * rr;
    const S offset = r * (S(4.0 / 3) / pi<S>);
    return {middle + ends, {}, middle * ((ll + rr) / S(3)) + ends * (rr * S(0.5) + ll + S(2) * l * offset)};
}
/// Cylinder and two half balls, whose centroids lie 3 r / 8 outwards of their flat sides.
template <class S>
constexpr mass_properties<S, 3> mass_of(const capsule<S, 3>& c, S density) {
    const S l = c.half_length, r = c.radius, rr = r * r, ll = l * l;
    const S middle = density * pi<S> * rr * (l + l);
    const S ends = density * (S(4) * pi<S> / S(3)) * rr * r;
    const S along = middle * (rr * S(0.5)) + ends * (rr * S(0.4));
    const S across = middle * (rr * S(0.25) + ll / S(3)) + ends * (rr * S(0.4) + ll + l * r * S(0.75));
    return {middle + ends, {}, symmetric<S>::diagonal(along, across, across)};
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/farthest.hpp
// =================================================================================================
// The farthest of many points along a direction, in lanes.

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of the first of n vertices that lies farthest along d; n is a multiple of 8. The coordinates come one
/// array an axis.
template <class R, int D>
std::uint32_t farthest_vertex(const R* const (&coordinate)[D], std::uint32_t n, const vec<double, D>& d) {
    constexpr int width = 8 / static_cast<int>(sizeof(R) / 4);
    using lanes = pack<R, width>;
    static constexpr R first_numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    lanes along[D];
    for (int k = 0; k < D; ++k) along[k] = lanes::broadcast(static_cast<R>(d[k]));
    const auto reach = [&](std::uint32_t i) {
        lanes sum = lanes::load(coordinate[0] + i) * along[0] + lanes::load(coordinate[1] + i) * along[1];
        if constexpr (D == 3) sum = sum + lanes::load(coordinate[2] + i) * along[2];
        return sum;
    };
    lanes best = reach(0), number = lanes::load(first_numbers), best_number = number;
    const lanes step = lanes::broadcast(R(width));
    for (std::uint32_t i = width; i < n; i += width) {
        const lanes here = reach(i);
        number = number + step;
        best_number = select_greater(here, best, number, best_number);
        best = max(best, here);
    }
    R values[width], numbers[width];
    best.store(values);
    best_number.store(numbers);
    int k = 0;
    for (int i = 1; i < width; ++i)
        if (values[i] > values[k] || (values[i] == values[k] && numbers[i] < numbers[k])) k = i;
    return static_cast<std::uint32_t>(numbers[k]);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull_moments.hpp
// =================================================================================================
// Volume, centroid and second moments of convex hulls, rounded by any radius.

PHYSICS_HPP_BEGIN

namespace detail {

/// a b^T + b a^T.
inline symmetric<double> both_products(const vec<double, 3>& a, const vec<double, 3>& b) {
    return {2 * a.x * b.x, 2 * a.y * b.y, 2 * a.z * b.z, a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x,
            a.y * b.z + a.z * b.y};
}
/// a a^T.
inline symmetric<double> square_of(const vec<double, 3>& a) { return both_products(a, a) * 0.5; }

inline vec<double, 3> in_space(const vec<double, 2>& v) { return {v.x, v.y, 0.0}; }
inline vec<double, 3> in_space(const vec<double, 3>& v) { return v; }

/// The integrals of 1, p and p p^T over all points within r of a hull, with p from the hull's centroid, as polynomials
/// in r: volume[k] is the factor of r^k, and so on. Exact: a hull is its core, a prism on each face, a wedge of a
/// cylinder along each edge and of a ball at each vertex. In 2D the hull lies at z = 0, integrals are over its plane.
/// Source: Steiner's formula; of p and p p^T see Schneider, Convex Bodies, 5.4 (tensor valuations).
struct hull_moments {
    double volume[4] = {};
    vec<double, 3> first[5] = {};
    symmetric<double> second[6] = {};

    /// A piece of so much volume, whose p sum up to `sum` and p p^T to `squares`, extended by r along the unit normal.
    void add_prism(double size, const vec<double, 3>& sum, const symmetric<double>& squares, const vec<double, 3>& n) {
        volume[1] += size;
        first[1] += sum;
        first[2] += n * (0.5 * size);
        second[1] = second[1] + squares;
        second[2] = second[2] + both_products(sum, n) * 0.5;
        second[3] = second[3] + square_of(n) * (size / 3);
    }
    /// The same by all directions from n towards the unit vector t across it, up to an angle (rad).
    void add_wedge(double size, const vec<double, 3>& sum, const symmetric<double>& squares, const vec<double, 3>& n,
                   const vec<double, 3>& t, double angle, double cosine, double sine) {
        const vec<double, 3> arc = n * sine + t * (1 - cosine);
        const symmetric<double> arc_squares = square_of(n) * (0.5 * (angle + sine * cosine)) +
                                              square_of(t) * (0.5 * (angle - sine * cosine)) +
                                              both_products(n, t) * (0.5 * sine * sine);
        volume[2] += 0.5 * angle * size;
        first[2] += sum * (0.5 * angle);
        first[3] += arc * (size / 3);
        second[2] = second[2] + squares * (0.5 * angle);
        second[3] = second[3] + both_products(sum, arc) * (1.0 / 3);
        second[4] = second[4] + arc_squares * (0.25 * size);
    }

    template <class T>
    static T at(const T* factors, int degree, double r) {
        T sum = factors[degree];
        for (int k = degree - 1; k >= 0; --k) sum = sum * r + factors[k];
        return sum;
    }
    /// Mass properties of the hull with the centroid c, rounded by r (m), by density.
    [[nodiscard]] PHYSICS_HPP_COLD mass_properties<double, 3> mass(const vec<double, 3>& c, double r,
                                                                   double density) const {
        const double size = at(volume, 3, r);
        const vec<double, 3> shift = at(first, 4, r) / size;
        const symmetric<double> m = (at(second, 5, r) + square_of(shift) * -size) * density;
        return {density * size, c + shift, {m.yy + m.zz, m.xx + m.zz, m.xx + m.yy, -m.xy, -m.xz, -m.yz}};
    }
};

/// The unit outward normal of an edge.
inline vec<double, 2> hull_normal(const vec<double, 2>* points, const std::uint16_t* corners, std::uint32_t) {
    return normalized(perpendicular(points[corners[1]] - points[corners[0]]));
}
/// The unit normal of a triangle, across its edges to rounding even where it is a needle: there a cross product of
/// two edges is not, by rounding over the angle between them.
inline vec<double, 3> triangle_normal(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
    vec<double, 3> e = b - a, f = c - b, g = a - c;
    // The longest edge first, in the same order.
    for (int i = 0; i < 2 && (dot(e, e) < dot(f, f) || dot(e, e) < dot(g, g)); ++i) {
        const vec<double, 3> first = e;
        e = f;
        f = g;
        g = first;
    }
    e = normalized(e);
    return normalized(cross(e, normalized(f - e * dot(e, f))));
}
/// The unit outward normal of a polygon: of its area (Newell's formula), or of its widest triangle if that is flatter,
/// as on long thin polygons.
template <class Index>
vec<double, 3> hull_normal(const vec<double, 3>* points, const Index* corners, std::uint32_t count) {
    const auto point = [&](std::uint32_t i) -> const vec<double, 3>& { return points[corners[i]]; };
    if (count == 3) return triangle_normal(point(0), point(1), point(2));
    const auto farthest = [&](auto&& distance) {
        std::uint32_t best = 0;
        for (std::uint32_t i = 1; i < count; ++i)
            if (distance(point(i)) > distance(point(best))) best = i;
        return best;
    };
    const std::uint32_t a = farthest([&](const vec<double, 3>& p) { return length(p - point(0)); });
    const std::uint32_t b = farthest([&](const vec<double, 3>& p) { return length(p - point(a)); });
    const vec<double, 3> along = normalized(point(b) - point(a));
    const std::uint32_t c = farthest([&](const vec<double, 3>& p) {
        const vec<double, 3> q = p - point(a);
        return length(q - along * dot(along, q));
    });
    vec<double, 3> sum, edge = point(1) - point(0);
    for (std::uint32_t i = 2; i < count; ++i) {
        const vec<double, 3> next = point(i) - point(0);
        sum += cross(edge, next);
        edge = next;
    }
    const vec<double, 3> by_area = normalized(sum), by_triangle = triangle_normal(point(a), point(b), point(c));
    const auto thickness = [&](const vec<double, 3>& n) {
        double low = 0, high = 0;
        for (std::uint32_t i = 1; i < count; ++i) {
            const double height = dot(n, point(i) - point(0));
            low = min(low, height);
            high = max(high, height);
        }
        return high - low;
    };
    if (!(thickness(by_triangle) < thickness(by_area))) return by_area;
    return dot(by_triangle, by_area) < 0 ? -by_triangle : by_triangle;
}

/// The integrals over a polygon with doubled area `doubled`, less by its factor: over the triangle a, b, c.
struct simplex_sums {
    vec<double, 3> first;
    symmetric<double> second;
};
inline simplex_sums over_triangle(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
    const vec<double, 3> sum = a + b + c;
    return {sum * (1.0 / 3), (square_of(sum) + square_of(a) + square_of(b) + square_of(c)) * (1.0 / 12)};
}

/// A polygon's area, first and second moments.
template <class Hull>
vec<double, 2> compute_hull_moments(const Hull& h, hull_moments& m)
    requires(Hull::dimension == 2)
{
    const std::uint32_t n = h.vertex_count;
    const vec<double, 2> base = h.exact_vertex(0);
    double area = 0;
    vec<double, 2> centroid;
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
        const vec<double, 2> a = h.exact_vertex(i) - base, b = h.exact_vertex(i + 1) - base;
        const double part = 0.5 * cross(a, b);
        area += part;
        centroid += (a + b) * (part / 3);
    }
    centroid = centroid / area + base;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = i + 1 < n ? i + 1 : 0;
        const vec<double, 3> a = in_space(h.exact_vertex(i) - centroid), b = in_space(h.exact_vertex(next) - centroid);
        const double part = 0.5 * cross(a, b).z;
        m.volume[0] += part;
        m.second[0] = m.second[0] + over_triangle({}, a, b).second * part;
        const double size = length(b - a);
        const vec<double, 3> n1 = in_space(h.normal(i)), n2 = in_space(h.normal(next));
        m.add_prism(size, (a + b) * (0.5 * size), (square_of(a) + square_of(b) + square_of(a + b)) * (size / 6), n1);
        const vec<double, 3> t{-n1.y, n1.x, 0.0};
        const double cosine = dot(n1, n2), sine = dot(t, n2);
        m.add_wedge(1, b, square_of(b), n1, t, atan2(sine, cosine), cosine, sine);
    }
    return centroid;
}

/// A polyhedron's volume, first and second moments. The wedges of balls at vertices come from the arcs on the unit
/// sphere that bound them, since n and n n^T - 1/3 are eigenfunctions of the sphere's Laplacian (-2 and -6).
template <class Hull>
vec<double, 3> compute_hull_moments(const Hull& h, hull_moments& m)
    requires(Hull::dimension == 3)
{
    const auto each_triangle = [&](const vec<double, 3>& origin, auto&& use) {
        for (std::uint32_t f = 0; f < h.face_count; ++f) {
            const std::uint16_t* corners = h.face_vertices();
            const std::uint32_t begin = h.face_begin(f), end = h.face_end(f);
            const vec<double, 3> a = h.exact_vertex(corners[begin]) - origin;
            for (std::uint32_t i = begin + 1; i + 1 < end; ++i)
                use(f, a, h.exact_vertex(corners[i]) - origin, h.exact_vertex(corners[i + 1]) - origin);
        }
    };
    const vec<double, 3> base = h.exact_vertex(0);
    double volume = 0;
    vec<double, 3> centroid;
    each_triangle(base, [&](std::uint32_t, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
        const double part = dot(a, cross(b, c)) / 6;
        volume += part;
        centroid += (a + b + c) * (0.25 * part);
    });
    centroid = centroid / volume + base;
    each_triangle(centroid,
                  [&](std::uint32_t f, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
                      const double part = dot(a, cross(b, c)) / 6;
                      m.volume[0] += part;
                      // A tetrahedron's second moment is 3/5 of its base's, at a third of the base's height.
                      const simplex_sums sums = over_triangle(a, b, c);
                      m.second[0] = m.second[0] + sums.second * (0.6 * part);
                      const vec<double, 3> n = h.normal(f);
                      const double area = 0.5 * dot(n, cross(b - a, c - a));
                      m.add_prism(area, sums.first * area, sums.second * area, n);
                  });
    const auto ball_wedge = [&](const vec<double, 3>& p, const vec<double, 3>& out, double angle,
                                const vec<double, 3>& arc) {
        // Of the ball's part between the planes across edges; their solid angles are added by corners below.
        const vec<double, 3> n1 = out * (-0.5 * angle);
        const symmetric<double> n2 = both_products(out, arc) * (-1.0 / 6);
        m.first[4] += n1 * 0.25;
        m.second[4] = m.second[4] + both_products(p, n1) * 0.25;
        m.second[5] = m.second[5] + n2 * 0.2;
    };
    for (std::uint32_t i = 0; i < h.edge_count; ++i) {
        const auto& e = h.edge(i);
        const vec<double, 3> a = h.exact_vertex(e.vertex[0]) - centroid, b = h.exact_vertex(e.vertex[1]) - centroid;
        const auto [d, size] = split(b - a);
        const vec<double, 3> n = h.normal(e.face[0]), other = h.normal(e.face[1]), t = normalized(cross(d, n));
        const double cosine = dot(n, other), sine = dot(t, other), angle = atan2(sine, cosine);
        m.add_wedge(size, (a + b) * (0.5 * size), (square_of(a) + square_of(b) + square_of(a + b)) * (size / 6), n, t,
                    angle, cosine, sine);
        const vec<double, 3> arc = n * sine + t * (1 - cosine);
        ball_wedge(a, d, angle, arc);
        ball_wedge(b, -d, angle, arc);
    }
    const auto solid_angle = [&](const vec<double, 3>& p, double angle) {
        m.volume[3] += angle / 3;
        m.first[3] += p * (angle / 3);
        m.second[3] = m.second[3] + square_of(p) * (angle / 3);
        // 2 * angle / 6 in all directions, times r^5 / 5.
        m.second[5] = m.second[5] + symmetric<double>::diagonal(1, 1, 1) * (angle / 15);
    };
    // A vertex is rounded by the solid angle that its faces' corners lack of a full turn.
    constexpr double turn = 6.283185307179586;
    for (std::uint32_t v = 0; v < h.vertex_count; ++v) solid_angle(h.exact_vertex(v) - centroid, turn);
    for (std::uint32_t f = 0; f < h.face_count; ++f) {
        const std::uint32_t begin = h.face_begin(f), end = h.face_end(f);
        const auto corner = [&](std::uint32_t i) { return h.exact_vertex(h.face_vertices()[i]) - centroid; };
        for (std::uint32_t i = begin; i < end; ++i) {
            const vec<double, 3> p = corner(i), to = corner(i + 1 < end ? i + 1 : begin) - p,
                                 from = corner(i > begin ? i - 1 : end - 1) - p;
            solid_angle(p, -atan2(length(cross(to, from)), dot(to, from)));
        }
    }
    return centroid;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull_data.hpp
// =================================================================================================
// What a convex hull is in memory: one block of vertices, faces, edges, neighbours and integrals.

PHYSICS_HPP_BEGIN

namespace detail {

/// The numbers in which a hull's vertices lie in lanes: float for float, double for all others. Fixed point converts
/// to double exactly as long as its coordinates have 53 bits; those of Q32.32 to 2^20 m.
template <class S>
using hull_real = std::conditional_t<std::is_same_v<S, float>, float, double>;

/// An edge from vertex[0] to vertex[1]: face[0] runs along it in this direction, face[1] in the other.
struct hull_edge {
    std::uint16_t vertex[2];
    std::uint32_t face[2];
};

/// A hull as its builder gives it, in double. Faces are counter-clockwise as seen from outside.
template <int D>
struct hull_outline {
    buffer<vec<double, D>> vertices;
    /// Where each face begins in face_vertices, and where the last one ends.
    buffer<std::uint32_t> face_begin;
    buffer<std::uint16_t> face_vertices;
    /// In 3D each edge once, with vertex[0] < vertex[1], ascending; empty in 2D, where vertices take that place.
    buffer<hull_edge> edges;
    /// How far (m) points may lie outside faces that were taken for flat.
    double tolerance = 0;
    /// How far (m) points lie outside of a face since only so many vertices were wanted.
    double shortfall = 0;

    [[nodiscard]] bool empty() const { return vertices.empty(); }
    [[nodiscard]] std::uint32_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
};

/// A convex hull with coordinates in R. In 2D vertices are counter-clockwise and face i is the edge from vertex i to
/// the next; in 3D faces are polygons. Arrays of vertices and of normals are rows of R, one for each axis, padded to a
/// multiple of 8 by repeating the last and aligned to 32 bytes.
template <class R, int D>
struct hull_data : geometry_block {
    static constexpr int dimension = D;
    static constexpr std::uint32_t most_vertices = 65535;

    std::uint32_t vertex_count, face_count, edge_count, padded_vertices, padded_faces;
    /// How far the vertices of a face may be from its plane (m), by the rounding of the numbers that were given.
    double tolerance;
    /// How far points lie outside of a face (m) since only so many vertices were wanted.
    double shortfall;
    /// The largest coordinate by magnitude.
    double reach;
    /// The distance of the centroid from the nearest face (m).
    double inradius;
    /// A number that hulls with the same vertices share on every system.
    std::uint64_t digest;
    vec<double, D> lower, upper, centroid;
    hull_moments moments;

    /// The vertices' coordinates along an axis: padded_vertices numbers.
    [[nodiscard]] const R* coordinate(int axis) const {
        return at<R>(coordinates_) + static_cast<std::uint32_t>(axis) * padded_vertices;
    }
    [[nodiscard]] vec<R, D> vertex(std::uint32_t i) const {
        vec<R, D> v;
        for (int axis = 0; axis < D; ++axis) v[axis] = coordinate(axis)[i];
        return v;
    }
    [[nodiscard]] vec<double, D> exact_vertex(std::uint32_t i) const {
        vec<double, D> v;
        for (int axis = 0; axis < D; ++axis) v[axis] = static_cast<double>(coordinate(axis)[i]);
        return v;
    }
    /// The unit outward normal of face i; dot(normal, v) <= offset for every vertex v, up to rounding in double.
    [[nodiscard]] const vec<double, D>& normal(std::uint32_t i) const { return at<vec<double, D>>(normals_)[i]; }
    [[nodiscard]] double offset(std::uint32_t i) const { return at<double>(offsets_)[i]; }
    /// The normals' components along an axis: padded_faces numbers.
    [[nodiscard]] const R* face_normal(int axis) const {
        return at<R>(normal_lanes_) + static_cast<std::uint32_t>(axis) * padded_faces;
    }
    /// The vertices of face i: face_vertices()[face_begin(i)] to before face_vertices()[face_end(i)].
    [[nodiscard]] std::uint32_t face_begin(std::uint32_t i) const { return at<std::uint32_t>(face_begin_)[i]; }
    [[nodiscard]] std::uint32_t face_end(std::uint32_t i) const { return at<std::uint32_t>(face_begin_)[i + 1]; }
    [[nodiscard]] const std::uint16_t* face_vertices() const { return at<std::uint16_t>(face_vertices_); }
    /// The vertices that share an edge with vertex v: neighbours()[neighbours_begin(v)] to before its end, ascending.
    [[nodiscard]] std::uint32_t neighbours_begin(std::uint32_t v) const {
        return at<std::uint32_t>(neighbours_begin_)[v];
    }
    [[nodiscard]] std::uint32_t neighbours_end(std::uint32_t v) const {
        return at<std::uint32_t>(neighbours_begin_)[v + 1];
    }
    [[nodiscard]] const std::uint16_t* neighbours() const { return at<std::uint16_t>(neighbours_); }
    /// Edge i of edge_count; in 2D there are none, vertices take their place.
    [[nodiscard]] const hull_edge& edge(std::uint32_t i) const { return at<hull_edge>(edges_)[i]; }

    /// In 3D the edge between two vertices, which must be there. Cost: O(log n).
    [[nodiscard]] const hull_edge& edge_between(std::uint32_t a, std::uint32_t b) const {
        const std::uint32_t key = a < b ? a << 16 | b : b << 16 | a;
        std::uint32_t low = 0, high = edge_count;
        while (high - low > 1) {
            const std::uint32_t middle = low + (high - low) / 2;
            const hull_edge& e = edge(middle);
            (key < (std::uint32_t{e.vertex[0]} << 16 | e.vertex[1]) ? high : low) = middle;
        }
        return edge(low);
    }

    /// The volume (m^3; in 2D the area, m^2).
    [[nodiscard]] double volume() const { return moments.volume[0]; }
    /// The integral of (p - centroid) (p - centroid)^T over the hull (m^5; m^4 in 2D, where z is 0).
    [[nodiscard]] const symmetric<double>& second_moments() const { return moments.second[0]; }

    /// A block from an outline, with one owner: the caller.
    static const hull_data* make(const hull_outline<D>& outline);

private:
    std::size_t coordinates_, normals_, offsets_, normal_lanes_, face_begin_, face_vertices_, neighbours_begin_,
        neighbours_, edges_;

    template <class T>
    [[nodiscard]] const T* at(std::size_t offset) const {
        return reinterpret_cast<const T*>(reinterpret_cast<const unsigned char*>(this) + offset);
    }
    template <class T>
    [[nodiscard]] T* at(std::size_t offset) {
        return reinterpret_cast<T*>(reinterpret_cast<unsigned char*>(this) + offset);
    }
    void link(const hull_outline<D>& outline);
    void set_normal(std::uint32_t f, const vec<double, D>& n);
    void lift_offsets();
    void lift_offset(std::uint32_t f, buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo, std::uint32_t stamp);
    PHYSICS_HPP_COLD void straighten(buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo);
};

inline std::uint32_t padded_to_8(std::uint32_t n) { return (n + 7) & ~std::uint32_t{7}; }

template <class R, int D>
const hull_data<R, D>* hull_data<R, D>::make(const hull_outline<D>& outline) {
    const std::uint32_t vertices = outline.vertices.size(), faces = outline.face_count();
    const std::uint32_t corners = outline.face_vertices.size();
    std::size_t end = sizeof(hull_data);
    const auto place = [&](std::size_t count, std::size_t bytes) {
        const std::size_t begin = (end + 31) & ~std::size_t{31};
        end = begin + count * bytes;
        return begin;
    };
    const std::size_t coordinates = place(std::size_t{D} * padded_to_8(vertices), sizeof(R));
    const std::size_t normal_lanes = place(std::size_t{D} * padded_to_8(faces), sizeof(R));
    const std::size_t normals = place(faces, sizeof(vec<double, D>)), offsets = place(faces, sizeof(double));
    const std::size_t begins = place(std::size_t{faces} + 1, sizeof(std::uint32_t));
    const std::size_t neighbour_begins = place(std::size_t{vertices} + 1, sizeof(std::uint32_t));
    const std::size_t face_corners = place(corners, sizeof(std::uint16_t));
    // In 2D a vertex has two neighbours and a face two corners, in 3D a face's corner gives its vertex a neighbour.
    const std::size_t neighbours = place(corners, sizeof(std::uint16_t));
    const std::size_t edges = place(outline.edges.size(), sizeof(hull_edge));

    hull_data* h = new_geometry<hull_data>(end);
    h->vertex_count = vertices;
    h->face_count = faces;
    h->edge_count = outline.edges.size();
    h->padded_vertices = padded_to_8(vertices);
    h->padded_faces = padded_to_8(faces);
    h->tolerance = outline.tolerance;
    h->shortfall = outline.shortfall;
    h->coordinates_ = coordinates;
    h->normal_lanes_ = normal_lanes;
    h->normals_ = normals;
    h->offsets_ = offsets;
    h->face_begin_ = begins;
    h->neighbours_begin_ = neighbour_begins;
    h->face_vertices_ = face_corners;
    h->neighbours_ = neighbours;
    h->edges_ = edges;

    h->lower = h->upper = outline.vertices[0];
    h->reach = 0;
    h->digest = vertices;
    for (std::uint32_t i = 0; i < h->padded_vertices; ++i)
        for (int axis = 0; axis < D; ++axis) {
            const double x = outline.vertices[i < vertices ? i : vertices - 1][axis];
            h->template at<R>(coordinates)[static_cast<std::uint32_t>(axis) * h->padded_vertices + i] =
                static_cast<R>(x);
            h->lower[axis] = min(h->lower[axis], x);
            h->upper[axis] = max(h->upper[axis], x);
            h->reach = max(h->reach, abs(x));
            if (i < vertices) h->digest = (h->digest ^ scalar_traits<double>::bits(x)) * 0xff51afd7ed558ccdu;
            h->digest ^= h->digest >> 32;
        }
    for (std::uint32_t i = 0; i <= faces; ++i) h->template at<std::uint32_t>(begins)[i] = outline.face_begin[i];
    for (std::uint32_t i = 0; i < corners; ++i)
        h->template at<std::uint16_t>(face_corners)[i] = outline.face_vertices[i];
    for (std::uint32_t i = 0; i < h->edge_count; ++i) h->template at<hull_edge>(edges)[i] = outline.edges[i];
    h->link(outline);
    for (std::uint32_t f = 0; f < faces; ++f)
        h->set_normal(f, hull_normal(outline.vertices.begin(), h->face_vertices() + h->face_begin(f),
                                     h->face_end(f) - h->face_begin(f)));
    h->lift_offsets();
    h->centroid = compute_hull_moments(*h, h->moments);
    h->inradius = h->offset(0) - dot(h->normal(0), h->centroid);
    for (std::uint32_t i = 1; i < faces; ++i)
        h->inradius = min(h->inradius, h->offset(i) - dot(h->normal(i), h->centroid));
    return h;
}

/// Fills the lists of neighbours. They ascend since edges do.
template <class R, int D>
void hull_data<R, D>::link(const hull_outline<D>& outline) {
    std::uint32_t* begins = at<std::uint32_t>(neighbours_begin_);
    std::uint16_t* list = at<std::uint16_t>(neighbours_);
    if constexpr (D == 2) {
        for (std::uint32_t v = 0; v < vertex_count; ++v) {
            const std::uint32_t before = v > 0 ? v - 1 : vertex_count - 1, after = v + 1 < vertex_count ? v + 1 : 0;
            begins[v] = 2 * v;
            list[2 * v] = static_cast<std::uint16_t>(before < after ? before : after);
            list[2 * v + 1] = static_cast<std::uint16_t>(before < after ? after : before);
        }
        begins[vertex_count] = 2 * vertex_count;
    } else {
        for (const hull_edge& e : outline.edges)
            for (const std::uint16_t v : e.vertex) ++begins[v + 1];
        for (std::uint32_t v = 0; v < vertex_count; ++v) begins[v + 1] += begins[v];
        buffer<std::uint32_t> next;
        for (std::uint32_t v = 0; v < vertex_count; ++v) next.push(begins[v]);
        for (const hull_edge& e : outline.edges)
            for (int k = 0; k < 2; ++k) list[next[e.vertex[k]]++] = e.vertex[1 - k];
    }
}

template <class R, int D>
void hull_data<R, D>::set_normal(std::uint32_t f, const vec<double, D>& n) {
    at<vec<double, D>>(normals_)[f] = n;
    for (std::uint32_t i = f; i < (f + 1 < face_count ? f + 1 : padded_faces); ++i)
        for (int axis = 0; axis < D; ++axis)
            at<R>(normal_lanes_)[static_cast<std::uint32_t>(axis) * padded_faces + i] = static_cast<R>(n[axis]);
}

/// An offset that no vertex exceeds. Faces that were merged have vertices above and below their planes, and rounding
/// may put a neighbour of theirs a little higher: what lies near the plane is searched from the face's own vertices, by
/// which all of it is connected.
template <class R, int D>
void hull_data<R, D>::lift_offset(std::uint32_t f, buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo,
                                  std::uint32_t stamp) {
    const vec<double, D> n = normal(f);
    double most = dot(n, exact_vertex(face_vertices()[face_begin(f)]));
    todo.clear();
    const auto visit = [&](std::uint32_t v) {
        if (seen_by[v] == stamp) return;
        seen_by[v] = stamp;
        const double height = dot(n, exact_vertex(v));
        if (height < most - 4 * tolerance) return;
        most = max(most, height);
        todo.push(v);
    };
    for (std::uint32_t i = face_begin(f); i < face_end(f); ++i) visit(face_vertices()[i]);
    while (!todo.empty()) {
        const std::uint32_t v = todo.back();
        todo.pop();
        for (std::uint32_t i = neighbours_begin(v); i < neighbours_end(v); ++i) visit(neighbours()[i]);
    }
    at<double>(offsets_)[f] = most;
}
template <class R, int D>
void hull_data<R, D>::lift_offsets() {
    buffer<std::uint32_t> seen_by, todo;
    seen_by.resize(vertex_count, 0);
    for (std::uint32_t f = 0; f < face_count; ++f) lift_offset(f, seen_by, todo, f + 1);
    if constexpr (D == 3) straighten(seen_by, todo);
}

/// A face hardly wider than the tolerance does not say how it is tilted about its length, so that its plane may cut
/// the hull: it then takes the middle between the faces along it.
template <class R, int D>
void hull_data<R, D>::straighten(buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo) {
    buffer<std::uint32_t> cutting;
    const auto cuts = [&](std::uint32_t f) {
        double least = offset(f);
        for (std::uint32_t i = face_begin(f); i < face_end(f); ++i)
            least = min(least, dot(normal(f), exact_vertex(face_vertices()[i])));
        return offset(f) - least > 2 * tolerance;
    };
    buffer<bool> bad;
    for (std::uint32_t f = 0; f < face_count; ++f) {
        bad.push(cuts(f));
        if (bad[f]) cutting.push(f);
    }
    std::uint32_t stamp = face_count;
    for (const std::uint32_t f : cutting) {
        vec<double, D> sum, along;
        for (std::uint32_t i = face_begin(f); i < face_end(f); ++i) {
            const hull_edge& e =
                edge_between(face_vertices()[i], face_vertices()[i + 1 < face_end(f) ? i + 1 : face_begin(f)]);
            const std::uint32_t other = e.face[0] == f ? e.face[1] : e.face[0];
            const vec<double, D> way = exact_vertex(e.vertex[1]) - exact_vertex(e.vertex[0]);
            if (length(way) > length(along)) along = way;
            if (!bad[other]) sum += normal(other) * length(way);
        }
        along = normalized(along);
        const vec<double, D> n = normalized(sum - along * dot(along, sum));
        if (n == vec<double, D>{}) continue;
        set_normal(f, n);
        lift_offset(f, seen_by, todo, ++stamp);
        bad[f] = cuts(f);
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull_builder2.hpp
// =================================================================================================
// Convex polygons from points, and what hulls of both dimensions begin with.

PHYSICS_HPP_BEGIN

namespace detail {

/// Sorts items[0] to before items[count] with room for as many, so that alike ones keep their order: merge sort.
template <class T, class Less>
void merge_sort(T* items, T* spare, std::uint32_t count, Less&& less) {
    if (count < 2) return;
    const std::uint32_t half = count / 2;
    merge_sort(items, spare, half, less);
    merge_sort(items + half, spare, count - half, less);
    std::memcpy(static_cast<void*>(spare), items, half * sizeof(T));
    std::uint32_t a = 0, b = half, to = 0;
    while (a < half && b < count) {
        if (less(items[b], spare[a])) items[to++] = items[b++];
        else items[to++] = spare[a++];
    }
    while (a < half) items[to++] = spare[a++];
}

/// Points by x, then y (then z), each once: all that follows depends on the set of points only. By their places on the
/// grid of predicates about them, that is, lest these contradict the order; see orientation. Those at one place count
/// as one.
template <int D>
void sort_points(buffer<vec<double, D>>& points, double size) {
    const double scale = 0x1p59 / size;
    const auto place = [&](double x) { return static_cast<std::int64_t>(x * scale); };
    buffer<vec<double, D>> spare;
    spare.resize(points.size() / 2 + 1);
    merge_sort(points.begin(), spare.begin(), points.size(), [&](const vec<double, D>& a, const vec<double, D>& b) {
        for (int i = 0; i < D; ++i)
            if (a[i] != b[i] && place(a[i]) != place(b[i])) return a[i] < b[i];
        for (int i = 0; i < D; ++i)
            if (a[i] != b[i]) return a[i] < b[i];
        return false;
    });
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        bool known = count > 0;
        for (int k = 0; k < D && known; ++k) known = place(points[count - 1][k]) == place(points[i][k]);
        if (!known) points[count++] = points[i];
    }
    points.resize(count);
}

/// The largest coordinate by magnitude.
template <int D>
double reach_of(const buffer<vec<double, D>>& points) {
    double most = 0;
    for (const auto& p : points) most = max(most, largest(p));
    return most;
}

/// The distance of p from the segment from a to b.
template <int D>
double segment_distance(const vec<double, D>& p, const vec<double, D>& a, const vec<double, D>& b) {
    const vec<double, D> along = b - a, q = p - a;
    const double t = dot(q, along), whole = dot(along, along);
    if (!(t > 0)) return length(q);
    return t < whole ? length(q - along * (t / whole)) : length(p - b);
}

/// Of a chain of points by their numbers, marks those to drop that lie within tolerance of the segments between those
/// that stay; the ends stay. Source: Ramer (1972), Douglas and Peucker (1973).
template <int D>
void simplify_chain(const vec<double, D>* points, const std::uint32_t* chain, std::uint32_t count, double tolerance,
                    buffer<bool>& drop) {
    struct range {
        std::uint32_t first, last;
    };
    buffer<range> todo;
    todo.push({0, count - 1});
    while (!todo.empty()) {
        const range r = todo.back();
        todo.pop();
        std::uint32_t farthest = r.first;
        double most = tolerance;
        for (std::uint32_t i = r.first + 1; i < r.last; ++i) {
            const double distance = segment_distance(points[chain[i]], points[chain[r.first]], points[chain[r.last]]);
            if (!(distance > most)) continue;
            most = distance;
            farthest = i;
        }
        if (farthest == r.first) {
            for (std::uint32_t i = r.first + 1; i < r.last; ++i) drop[chain[i]] = true;
        } else {
            todo.push({farthest, r.last});
            todo.push({r.first, farthest});
        }
    }
}

/// The farthest of the points from p; the first of equals.
template <int D>
std::uint32_t farthest_from(const vec<double, D>& p, const buffer<vec<double, D>>& points) {
    std::uint32_t best = 0;
    double most = -1;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const vec<double, D> d = points[i] - p;
        const double distance = dot(d, d);
        if (!(distance > most)) continue;
        most = distance;
        best = i;
    }
    return best;
}

template <int D>
bool refuse_thickness(const char* function, double thickness) {
    return refuse(function, "thickness of the points", thickness,
                  D == 2 ? "they must not lie on one line, to the rounding of their coordinates"
                         : "they must not lie in one plane, to the rounding of their coordinates");
}
template <int D>
bool check_hull_size(const char* function, std::uint32_t vertices) {
    return vertices <= hull_data<double, D>::most_vertices ||
           refuse(function, "number of vertices", static_cast<double>(vertices), "it must be at most 65535");
}

/// Thins out a convex polygon to so many corners: takes the one farthest outside of the others, again and again.
/// Returns how far the next one lies outside. Cost: O(n) a corner.
inline double keep_farthest(buffer<vec<double, 2>>& corners, std::uint32_t first, std::uint32_t most) {
    const std::uint32_t n = corners.size();
    buffer<bool> keep;
    keep.resize(n, false);
    keep[first] = keep[farthest_from(corners[first], corners)] = true;
    double distance = 0;
    for (std::uint32_t kept = 2;; ++kept) {
        std::uint32_t best = first;
        distance = 0;
        for (std::uint32_t i = 0, from = first, to = first; i < n; ++i) {
            const std::uint32_t at = first + i < n ? first + i : first + i - n;
            if (keep[at]) {
                from = at;
                do to = to + 1 < n ? to + 1 : 0;
                while (!keep[to]);
                continue;
            }
            const double d = segment_distance(corners[at], corners[from], corners[to]);
            if (!(d > distance)) continue;
            distance = d;
            best = at;
        }
        if (kept >= most || best == first) break;
        keep[best] = true;
    }
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < n; ++i)
        if (keep[i]) corners[count++] = corners[i];
    corners.resize(count);
    return distance;
}

/// The convex polygon around points that it sorts; empty after a refusal. Vertices within `tolerance` (m) of the line
/// between their neighbours are left out; what remains is strictly convex. most: if not 0, no more vertices than that.
/// Cost: O(n log n), 60 ns a point.
/// Source: monotone chains, Andrew (1979).
inline hull_outline<2> build_outline(buffer<vec<double, 2>>& points, double tolerance, std::uint32_t most,
                                     const char* function) {
    hull_outline<2> result;
    const double size = power_above(reach_of(points));
    sort_points(points, size);
    const orientation turn(size);
    buffer<std::uint32_t> chain;
    const auto advance = [&](std::uint32_t from, std::uint32_t i) {
        while (chain.size() >= from + 2 &&
               turn.of(points[chain[chain.size() - 2]], points[chain.back()], points[i]) <= 0)
            chain.pop();
        chain.push(i);
    };
    for (std::uint32_t i = 0; i < points.size(); ++i) advance(0, i);
    const std::uint32_t last = chain.size() - 1;
    for (std::uint32_t i = points.size() - 1; i-- > 0;) advance(last, i);
    if (chain.size() > 1) chain.pop();

    // Two vertices that stick out whatever rounding did: the farthest from the middle, and the farthest from that.
    buffer<vec<double, 2>> corners;
    for (const std::uint32_t i : chain) corners.push(points[i]);
    vec<double, 2> middle;
    for (const auto& p : corners) middle += (p - corners[0]) / corners.size();
    const std::uint32_t a = farthest_from(middle + corners[0], corners), b = farthest_from(corners[a], corners);
    double thickness = 0;
    if (corners.size() > 2) {
        const vec<double, 2> across = perpendicular(normalized(corners[b] - corners[a]));
        double low = 0, high = 0;
        for (const auto& p : corners) {
            const double height = dot(across, p - corners[a]);
            low = min(low, height);
            high = max(high, height);
        }
        thickness = high - low;
    }
    if (!(thickness > tolerance)) {
        refuse_thickness<2>(function, thickness);
        return result;
    }
    buffer<bool> drop;
    drop.resize(corners.size(), false);
    const auto simplify = [&](std::uint32_t from, std::uint32_t to) {
        chain.clear();
        for (std::uint32_t i = from; i != to; i = i + 1 < corners.size() ? i + 1 : 0) chain.push(i);
        chain.push(to);
        simplify_chain(corners.begin(), chain.begin(), chain.size(), tolerance, drop);
    };
    simplify(a, b);
    simplify(b, a);
    for (std::uint32_t i = 0; i < corners.size(); ++i)
        if (!drop[i]) result.vertices.push(corners[i]);
    if (most > 0 && result.vertices.size() > most)
        result.shortfall = keep_farthest(result.vertices, farthest_from(middle + corners[0], result.vertices), most);
    const std::uint32_t n = result.vertices.size();
    if (n < 3) refuse_thickness<2>(function, thickness);
    if (n < 3 || !check_hull_size<2>(function, n)) return {};
    for (std::uint32_t i = 0; i < n; ++i) {
        result.face_begin.push(2 * i);
        result.face_vertices.push(static_cast<std::uint16_t>(i));
        result.face_vertices.push(static_cast<std::uint16_t>(i + 1 < n ? i + 1 : 0));
    }
    result.face_begin.push(2 * n);
    result.tolerance = tolerance;
    return result;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/quickhull.hpp
// =================================================================================================
// The convex hull of points in space, as triangles: exact, whatever lies in one plane or on one line.

PHYSICS_HPP_BEGIN

namespace detail {

/// Triangles that enclose all points: corners counter-clockwise as seen from outside; next[i] is the triangle across
/// the edge from corner[i] to corner[i + 1].
struct hull_triangle {
    std::uint32_t corner[3];
    std::uint32_t next[3];

    /// Which of its corners a vertex is.
    [[nodiscard]] std::uint32_t find(std::uint32_t vertex) const {
        return corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2;
    }
};
inline std::uint32_t next_corner(std::uint32_t i) { return i < 2 ? i + 1 : 0; }
inline std::uint32_t previous_corner(std::uint32_t i) { return i > 0 ? i - 1 : 2; }

/// Quickhull with exact predicates: no triangle ever has a point outside that was taken for inside. A face of more
/// corners comes as triangles in one plane; points within it or on its edges may or may not be corners of these. What
/// it gives depends on the order of the points. Cost: O(n log n) on most input, 0.5 us a point where all are vertices.
/// Source: Barber, Dobkin, Huhdanpaa, The quickhull algorithm for convex hulls (1996).
class quickhull {
public:
    /// points: each once. False, and the thickness by which the points miss a volume, if it is at most `tolerance`.
    /// most: if not 0, takes the point that lies farthest outside of all until there are so many vertices, O(n) each.
    bool build(const vec<double, 3>* points, std::uint32_t count, double tolerance, double& thickness,
               std::uint32_t most = 0) {
        points_ = points;
        double reach = 0;
        for (std::uint32_t i = 0; i < count; ++i) reach = max(reach, largest(points[i]));
        grid_ = orientation(power_above(reach));
        std::uint32_t simplex[4];
        if (!choose_simplex(count, tolerance, simplex, thickness)) return false;
        next_point_.resize(count, none);
        facet_from_.resize(count, none);
        start(count, simplex);
        for (std::uint32_t vertices = 4; most > 0; ++vertices) {
            const std::uint32_t f = farthest_facet();
            if (f == none || vertices >= most) return true;
            add_farthest(f);
        }
        while (!pending_.empty()) {
            const std::uint32_t f = pending_.back();
            pending_.pop();
            if (facets_[f].alive && facets_[f].outside != none) add_farthest(f);
        }
        return true;
    }
    /// The triangles, packed.
    void collect(buffer<hull_triangle>& triangles) {
        buffer<std::uint32_t> number;
        number.resize(facets_.size(), none);
        std::uint32_t count = 0;
        for (std::uint32_t f = 0; f < facets_.size(); ++f)
            if (facets_[f].alive) number[f] = count++;
        triangles.clear();
        for (const facet& f : facets_) {
            if (!f.alive) continue;
            hull_triangle t = f.triangle;
            for (std::uint32_t& n : t.next) n = number[n];
            triangles.push(t);
        }
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    struct facet {
        hull_triangle triangle;
        /// The points that it sees, a list, and the farthest of them with its height times twice the facet's area.
        std::uint32_t outside, farthest;
        double height;
        std::uint32_t seen_at;
        bool visible, alive;
        orientation::plane plane;
    };
    struct horizon_edge {
        std::uint32_t from, to, beyond;
    };

    /// Four points far apart. thickness: the largest distance from the first, the line or the plane of those before.
    bool choose_simplex(std::uint32_t count, double tolerance, std::uint32_t* simplex, double& thickness) const {
        const vec<double, 3> a = points_[0];
        const auto farthest = [&](auto&& distance) {
            std::uint32_t best = 0;
            thickness = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const double d = abs(distance(points_[i] - a));
                if (!(d > thickness)) continue;
                thickness = d;
                best = i;
            }
            return best;
        };
        simplex[0] = 0;
        simplex[1] = farthest([](const vec<double, 3>& q) { return length(q); });
        if (!(thickness > tolerance)) return false;
        const vec<double, 3> along = normalized(points_[simplex[1]] - a);
        simplex[2] = farthest([&](const vec<double, 3>& q) { return length(cross(along, q)); });
        if (!(thickness > tolerance)) return false;
        const vec<double, 3> n = normalized(cross(along, points_[simplex[2]] - a));
        simplex[3] = farthest([&](const vec<double, 3>& q) { return dot(n, q); });
        // Of three points near a line the normal is rounding, which makes them seem to lie beside their own plane.
        if (!(thickness > tolerance) || grid_.of(a, points_[simplex[1]], points_[simplex[2]], points_[simplex[3]]) == 0)
            return false;
        if (dot(n, points_[simplex[3]] - a) > 0) std::swap(simplex[1], simplex[2]);
        return true;
    }

    std::uint32_t new_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        std::uint32_t f = facets_.size();
        if (free_.empty()) {
            facets_.resize(f + 1);
        } else {
            f = free_.back();
            free_.pop();
        }
        facet& made = facets_[f];
        made = {};
        made.triangle = {{a, b, c}, {none, none, none}};
        made.outside = made.farthest = none;
        made.alive = true;
        made.plane = {grid_, points_[a], points_[b], points_[c]};
        return f;
    }
    [[nodiscard]] bool sees(const facet& f, std::uint32_t point) const {
        const std::uint32_t* c = f.triangle.corner;
        return grid_.side(f.plane, points_[c[0]], points_[c[1]], points_[c[2]], points_[point]) > 0;
    }
    /// Whether a facet sees the point, which is then in its list.
    bool take(facet& f, std::uint32_t point) {
        if (!sees(f, point)) return false;
        const double height = dot(f.plane.normal(), points_[point] - points_[f.triangle.corner[0]]);
        if (f.outside == none || height > f.height) {
            f.farthest = point;
            f.height = height;
        }
        next_point_[point] = f.outside;
        f.outside = point;
        return true;
    }

    /// s[3] lies below the plane of the three others, which are counter-clockwise from above.
    void start(std::uint32_t count, const std::uint32_t* s) {
        new_facet(s[0], s[1], s[2]);
        new_facet(s[0], s[3], s[1]);
        new_facet(s[1], s[3], s[2]);
        new_facet(s[2], s[3], s[0]);
        constexpr std::uint32_t next[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
        for (std::uint32_t f = 0; f < 4; ++f) {
            for (int k = 0; k < 3; ++k) facets_[f].triangle.next[k] = next[f][k];
            pending_.push(f);
        }
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t f = 0; f < 4; ++f)
                if (take(facets_[f], i)) break;
    }

    /// The facet that sees a point from farthest.
    [[nodiscard]] std::uint32_t farthest_facet() const {
        std::uint32_t best = none;
        double distance = 0;
        for (std::uint32_t f = 0; f < facets_.size(); ++f) {
            if (!facets_[f].alive || facets_[f].outside == none) continue;
            const double d = facets_[f].height / length(facets_[f].plane.normal());
            if (!(d > distance)) continue;
            distance = d;
            best = f;
        }
        return best;
    }
    /// Replaces all facets that see the farthest point of facet f by those from it to their rim. The rim is one ring,
    /// and the point is on none of its edges' lines, since what sees it is exact.
    void add_farthest(std::uint32_t f) {
        const std::uint32_t p = facets_[f].farthest;
        ++stamp_;
        visible_.clear();
        horizon_.clear();
        facets_[f].seen_at = stamp_;
        facets_[f].visible = true;
        visible_.push(f);
        for (std::uint32_t i = 0; i < visible_.size(); ++i) {
            const hull_triangle t = facets_[visible_[i]].triangle;
            for (std::uint32_t k = 0; k < 3; ++k) {
                facet& g = facets_[t.next[k]];
                if (g.seen_at != stamp_) {
                    g.seen_at = stamp_;
                    g.visible = sees(g, p);
                    if (g.visible) visible_.push(t.next[k]);
                }
                if (!g.visible) horizon_.push({t.corner[k], t.corner[next_corner(k)], t.next[k]});
            }
        }
        made_.clear();
        for (const horizon_edge& e : horizon_) {
            const std::uint32_t made = new_facet(e.from, e.to, p);
            hull_triangle& beyond = facets_[e.beyond].triangle;
            beyond.next[beyond.find(e.to)] = made;
            facets_[made].triangle.next[0] = e.beyond;
            facet_from_[e.from] = made;
            made_.push(made);
        }
        for (const std::uint32_t made : made_) {
            hull_triangle& t = facets_[made].triangle;
            t.next[1] = facet_from_[t.corner[1]];
            facets_[t.next[1]].triangle.next[2] = made;
        }
        for (const std::uint32_t gone : visible_) {
            facets_[gone].alive = false;
            free_.push(gone);
            std::uint32_t next = none;
            for (std::uint32_t i = facets_[gone].outside; i != none; i = next) {
                next = next_point_[i];
                if (i == p) continue;
                for (const std::uint32_t made : made_)
                    if (take(facets_[made], i)) break;
            }
        }
        for (const std::uint32_t made : made_)
            if (facets_[made].outside != none) pending_.push(made);
    }

    const vec<double, 3>* points_ = nullptr;
    orientation grid_{1};
    buffer<facet> facets_;
    buffer<std::uint32_t> free_, pending_, next_point_, facet_from_, visible_, made_;
    buffer<horizon_edge> horizon_;
    std::uint32_t stamp_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull_faces.hpp
// =================================================================================================
// From the triangles of a hull to its faces: what rounding bent is flat again.

PHYSICS_HPP_BEGIN

namespace detail {

/// Finds the flat regions of a hull of triangles, the vertices that these make superfluous, and, once there are none,
/// the faces. All within a tolerance: corners of a face are at most that far apart across its plane, and vertices that
/// go were at most that far outside of what stays. Cost: O(n log n) on most input.
class hull_faces {
public:
    hull_faces(const vec<double, 3>* points, const buffer<hull_triangle>& triangles, double tolerance)
        : points_(points), triangles_(triangles), tolerance_(tolerance) {
        find_regions();
    }

    /// Marks of two vertices that nearly coincide one; or where there are none, the vertices within a region, and those
    /// on an edge of two regions near the line between its ends.
    bool drop_superfluous(std::uint32_t count, buffer<bool>& drop) {
        buffer<std::uint32_t> corner_of, links;
        corner_of.resize(count, none);
        links.resize(2 * count, none);
        buffer<std::uint8_t> borders;
        borders.resize(count, 0);
        drop.clear();
        drop.resize(count, false);
        bool any = false;
        for (const hull_triangle& t : triangles_)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t.corner[k], b = t.corner[next_corner(k)];
                if (a < b && !drop[a] && !drop[b] && length(points_[a] - points_[b]) <= weld * tolerance_)
                    drop[b] = any = true;
            }
        // Alone: what else goes may hold on to one of these.
        if (any) return true;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t v = triangles_[t].corner[k];
                corner_of[v] = t;
                if (region_[t] == region_[triangles_[t].next[k]]) continue;
                // Each border edge leaves each of its ends once.
                if (borders[v] < 2) links[2 * v + borders[v]] = triangles_[t].corner[next_corner(k)];
                if (borders[v] < 3) ++borders[v];
            }
        for (std::uint32_t v = 0; v < count; ++v)
            if (corner_of[v] != none && borders[v] == 0) drop[v] = any = true;
        buffer<std::uint32_t> chain;
        buffer<bool> done;
        done.resize(count, false);
        for (std::uint32_t start = 0; start < count; ++start) {
            if (corner_of[start] == none || borders[start] != 3) continue;
            for (const std::uint32_t first : border_neighbours(start, corner_of[start])) {
                if (borders[first] != 2 || done[first]) continue;
                chain.clear();
                chain.push(start);
                for (std::uint32_t v = first, from = start; chain.back() != v;) {
                    chain.push(v);
                    if (borders[v] != 2) break;
                    done[v] = true;
                    const std::uint32_t to = links[2 * v] == from ? links[2 * v + 1] : links[2 * v];
                    from = v;
                    v = to;
                }
                simplify_chain(points_, chain.begin(), chain.size(), tolerance_, drop);
                for (const std::uint32_t v : chain) any = any || drop[v];
            }
        }
        return any;
    }

    /// Joins the triangles of each region to polygons, as far as these are convex, and writes the outline.
    void join(std::uint32_t count, hull_outline<3>& outline) {
        const std::uint32_t n = 3 * triangles_.size();
        degree_.resize(count, 0);
        for (std::uint32_t h = 0; h < n; ++h) {
            const std::uint32_t t = h / 3, k = h % 3;
            next_.push(3 * t + next_corner(k));
            previous_.push(3 * t + previous_corner(k));
            const hull_triangle& g = triangles_[triangles_[t].next[k]];
            twin_.push(3 * triangles_[t].next[k] + g.find(triangles_[t].corner[next_corner(k)]));
            ++degree_[origin(h)];
            if (k == 0) {
                polygon_.push(t);
                size_.push(3);
                bent_.push(false);
            }
        }
        gone_.resize(n, false);
        for (bool again = true; again;) {
            again = false;
            for (std::uint32_t h = 0; h < n; ++h)
                if (h < twin_[h] && !gone_[h] && join_across(h)) again = true;
        }
        write(count, outline);
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    /// Vertices as near as so many tolerances count as one: faces of that size would point anywhere.
    static constexpr double weld = 4;

    [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return triangles_[h / 3].corner[h % 3]; }
    [[nodiscard]] const vec<double, 3>& point(std::uint32_t h) const { return points_[origin(h)]; }

    /// Grows regions from the largest triangles: the larger a region, the better its plane is known.
    void find_regions() {
        const std::uint32_t count = triangles_.size();
        struct entry {
            double size;
            std::uint32_t triangle;
        };
        buffer<entry> order, spare;
        for (std::uint32_t t = 0; t < count; ++t) {
            const std::uint32_t* c = triangles_[t].corner;
            const vec<double, 3>&p = points_[c[0]], &q = points_[c[1]], &r = points_[c[2]];
            const double size = length(cross(q - p, r - p));
            const double longest = max(length(q - p), max(length(r - q), length(p - r)));
            area_.push(size > tolerance_ * longest ? triangle_normal(p, q, r) * size : vec<double, 3>{});
            order.push({size, t});
        }
        spare.resize(count / 2 + 1);
        merge_sort(order.begin(), spare.begin(), count,
                   [](const entry& a, const entry& b) { return a.size > b.size; });
        region_.resize(count, none);
        for (const entry& e : order)
            if (region_[e.triangle] == none && !is_needle(e.triangle)) grow(e.triangle);
        // A needle is flat with what lies across its longest edge. Those that share that edge have gone on other ways,
        // or stay alone.
        for (bool again = true; again;) {
            again = false;
            for (const entry& e : order) {
                if (region_[e.triangle] != none) continue;
                region_[e.triangle] = region_[triangles_[e.triangle].next[longest_edge(e.triangle)]];
                again = again || region_[e.triangle] != none;
            }
        }
        for (const entry& e : order)
            if (region_[e.triangle] == none) grow(e.triangle);
    }
    /// A triangle that is no wider than the tolerance may point anywhere: its area was set to 0.
    [[nodiscard]] bool is_needle(std::uint32_t t) const { return area_[t] == vec<double, 3>{}; }
    [[nodiscard]] std::uint32_t longest_edge(std::uint32_t t) const {
        std::uint32_t best = 0;
        double most = 0;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t* c = triangles_[t].corner;
            const double size = length(points_[c[next_corner(k)]] - points_[c[k]]);
            if (size > most) best = k;
            most = max(most, size);
        }
        return best;
    }
    void grow(std::uint32_t seed) {
        const std::uint32_t id = regions_.size();
        const std::uint32_t* c = triangles_[seed].corner;
        const vec<double, 3> base = points_[c[0]];
        vec<double, 3> sum = area_[seed], plane = normalized(sum);
        double low = 0, high = 0, radius = 0;
        corners_.clear();
        for (int k = 0; k < 3; ++k) {
            corners_.push(c[k]);
            radius = max(radius, length(points_[c[k]] - base));
        }
        todo_.clear();
        todo_.push(seed);
        region_[seed] = id;
        for (std::uint32_t i = 0; i < todo_.size() && !is_needle(seed); ++i)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t g = triangles_[todo_[i]].next[k];
                if (region_[g] != none || dot(sum, area_[g]) < 0) continue;
                const std::uint32_t edge_end = triangles_[todo_[i]].corner[k];
                const std::uint32_t apex = triangles_[g].corner[next_corner(triangles_[g].find(edge_end))];
                const vec<double, 3> q = points_[apex] - base;
                const double height = dot(plane, q), reach = max(radius, length(q));
                // A plane known from little says nothing of a needle that leads far away.
                if (is_needle(g) && reach > 2 * radius) continue;
                double from = min(low, height), to = max(high, height);
                if (to - from > tolerance_) {
                    // Another plane may fit all of them, unless it would have to turn too far.
                    const vec<double, 3> turned = normalized(sum + area_[g]);
                    if (to - from - tolerance_ > 2 * reach * length(turned - plane)) continue;
                    from = to = dot(turned, q);
                    for (const std::uint32_t v : corners_) {
                        const double other = dot(turned, points_[v] - base);
                        from = min(from, other);
                        to = max(to, other);
                    }
                    if (to - from > tolerance_) continue;
                    plane = turned;
                }
                low = from;
                high = to;
                radius = reach;
                sum += area_[g];
                region_[g] = id;
                corners_.push(apex);
                todo_.push(g);
            }
        regions_.push(normalized(sum));
    }

    struct few {
        std::uint32_t* first;
        std::uint32_t* last;
        [[nodiscard]] std::uint32_t* begin() const { return first; }
        [[nodiscard]] std::uint32_t* end() const { return last; }
    };
    /// The other ends of the edges at v between two regions.
    few border_neighbours(std::uint32_t v, std::uint32_t start) {
        todo_.clear();
        std::uint32_t t = start;
        do {
            const std::uint32_t k = triangles_[t].find(v), g = triangles_[t].next[k];
            if (region_[t] != region_[g]) todo_.push(triangles_[t].corner[next_corner(k)]);
            t = g;
        } while (t != start);
        return {todo_.begin(), todo_.end()};
    }

    std::uint32_t polygon_of(std::uint32_t h) {
        std::uint32_t t = h / 3;
        while (polygon_[t] != t) t = polygon_[t] = polygon_[polygon_[t]];
        return t;
    }
    /// How far b lies outside of the line from a to c, seen from the side to which n points.
    static double bulge(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c,
                        const vec<double, 3>& n) {
        return dot(n, cross(b - a, normalized(c - a)));
    }
    /// Takes the edge of half-edge h away, if the polygons on its two sides make a convex one.
    bool join_across(std::uint32_t h) {
        const std::uint32_t t = twin_[h], a = polygon_of(h), b = polygon_of(t);
        if (a == b || region_[a] != region_[b] || degree_[origin(h)] < 4 || degree_[origin(t)] < 4) return false;
        const bool first_smaller = size_[a] < size_[b];
        const std::uint32_t smaller = first_smaller ? h : t, larger = first_smaller ? b : a;
        for (std::uint32_t e = next_[smaller]; e != smaller; e = next_[e])
            if (polygon_of(twin_[e]) == larger) return false;
        const vec<double, 3>& n = regions_[region_[a]];
        const double u = bulge(point(previous_[h]), point(h), point(next_[next_[t]]), n);
        const double v = bulge(point(previous_[t]), point(t), point(next_[next_[h]]), n);
        if (u < -tolerance_ || v < -tolerance_) return false;
        // Corners that hardly stick out are bent, on another plane through the same points; of many corners no plane
        // is in doubt.
        const double least = size_[a] + size_[b] < 64 ? tolerance_ : 0;
        const bool bent = bent_[a] || bent_[b] || !(u > least) || !(v > least);
        unlink(h, t);
        if (bent && !convex(next_[t])) {
            link(h, t);
            return false;
        }
        const std::uint32_t joined = first_smaller ? b : a;
        polygon_[a] = polygon_[b] = joined;
        size_[joined] = size_[a] + size_[b] - 2;
        bent_[joined] = bent;
        gone_[h] = gone_[t] = true;
        --degree_[origin(h)];
        --degree_[origin(t)];
        return true;
    }
    void unlink(std::uint32_t h, std::uint32_t t) {
        next_[previous_[h]] = next_[t];
        previous_[next_[t]] = previous_[h];
        next_[previous_[t]] = next_[h];
        previous_[next_[h]] = previous_[t];
    }
    /// Undoes unlink(h, t): both still know where they were.
    void link(std::uint32_t h, std::uint32_t t) {
        next_[previous_[h]] = previous_[next_[h]] = h;
        next_[previous_[t]] = previous_[next_[t]] = t;
    }
    /// Whether no corner of a polygon is farther than the tolerance outside of any of its edges' lines.
    [[nodiscard]] PHYSICS_HPP_COLD bool convex(std::uint32_t start) {
        corners_.clear();
        std::uint32_t e = start;
        do {
            corners_.push(origin(e));
            e = next_[e];
        } while (e != start);
        const vec<double, 3> n = hull_normal(points_, corners_.begin(), corners_.size());
        do {
            const vec<double, 3> a = point(e), along = point(next_[e]) - a;
            if (length(along) > tolerance_) {
                const vec<double, 3> inwards = cross(n, normalized(along));
                for (std::uint32_t i = next_[next_[e]]; i != e; i = next_[i])
                    if (dot(inwards, point(i) - a) < -tolerance_) return false;
            }
            e = next_[e];
        } while (e != start);
        return true;
    }

    void write(std::uint32_t count, hull_outline<3>& outline) {
        const std::uint32_t n = next_.size();
        buffer<std::uint32_t> number, face;
        number.resize(count, none);
        face.resize(n, none);
        outline.vertices.clear();
        for (std::uint32_t v = 0; v < count; ++v) {
            if (degree_[v] == 0) continue;
            number[v] = outline.vertices.size();
            outline.vertices.push(points_[v]);
        }
        if (outline.vertices.size() > hull_data<double, 3>::most_vertices) return;
        outline.face_begin.push(0);
        buffer<std::uint64_t> keys;
        for (std::uint32_t start = 0; start < n; ++start) {
            if (gone_[start] || face[start] != none) continue;
            std::uint32_t h = start;
            do {
                face[h] = outline.face_begin.size() - 1;
                outline.face_vertices.push(static_cast<std::uint16_t>(number[origin(h)]));
                const std::uint32_t from = number[origin(h)], to = number[origin(twin_[h])];
                if (from < to) keys.push(std::uint64_t{h} << 32 | from << 16 | to);
                h = next_[h];
            } while (h != start);
            outline.face_begin.push(outline.face_vertices.size());
        }
        buffer<std::uint64_t> spare;
        spare.resize(keys.size());
        const std::uint64_t* sorted = radix_sort(keys.begin(), spare.begin(), keys.size(), 0, 32);
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            const std::uint32_t h = static_cast<std::uint32_t>(sorted[i] >> 32);
            outline.edges.push({{static_cast<std::uint16_t>(sorted[i] >> 16 & 0xffff),
                                 static_cast<std::uint16_t>(sorted[i] & 0xffff)},
                                {face[h], face[twin_[h]]}});
        }
    }

    const vec<double, 3>* points_;
    const buffer<hull_triangle>& triangles_;
    double tolerance_;
    buffer<vec<double, 3>> area_, regions_;
    buffer<std::uint32_t> region_, corners_, todo_;
    buffer<std::uint32_t> next_, previous_, twin_, polygon_, size_, degree_;
    buffer<bool> gone_, bent_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull_builder3.hpp
// =================================================================================================
// Convex polyhedra from points.

PHYSICS_HPP_BEGIN

namespace detail {

/// Shortens the list to those points that are corners of triangles and not to be dropped.
inline void keep_corners(buffer<vec<double, 3>>& points, const buffer<hull_triangle>& triangles,
                         const buffer<bool>& drop) {
    buffer<bool> used;
    used.resize(points.size(), false);
    for (const hull_triangle& t : triangles)
        for (const std::uint32_t v : t.corner) used[v] = true;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (used[i] && !drop[i]) points[count++] = points[i];
    points.resize(count);
}

/// The convex polyhedron around points that it sorts; empty after a refusal. Exact but for what a tolerance (m) allows:
/// faces join triangles that are flat within it, and vertices go that are within it of a face or of an edge's line, or
/// within four of it of another vertex. Without superfluous vertices, regions are joined to convex faces in any order;
/// hence hulls are built anew of the others, at most six times. Points end up at most one tolerance outside, among
/// noise of the tolerance's size eight. most: if not 0, no more vertices than that, those that reach farthest.
/// Cost: see quickhull.
inline hull_outline<3> build_outline(buffer<vec<double, 3>>& points, double tolerance, std::uint32_t most,
                                     const char* function) {
    hull_outline<3> result;
    sort_points(points, power_above(reach_of(points)));
    buffer<hull_triangle> triangles;
    buffer<bool> drop;
    buffer<vec<double, 3>> all;
    double thickness = 0;
    for (int round = 0;; ++round) {
        quickhull hull;
        if (!hull.build(points.begin(), points.size(), tolerance, thickness)) break;
        hull.collect(triangles);
        hull_faces faces(points.begin(), triangles, tolerance);
        if (round < 6 && faces.drop_superfluous(points.size(), drop)) {
            keep_corners(points, triangles, drop);
            if (points.size() < 4) break;
            continue;
        }
        faces.join(points.size(), result);
        if (most > 0 && result.vertices.size() > most) {
            quickhull simpler;
            all = points = result.vertices;
            result = {};
            if (!simpler.build(points.begin(), points.size(), tolerance, thickness, most)) break;
            simpler.collect(triangles);
            drop.clear();
            drop.resize(points.size(), false);
            keep_corners(points, triangles, drop);
            round = 0;
            continue;
        }
        if (!check_hull_size<3>(function, result.vertices.size())) return {};
        if (result.vertices.size() < 4 || result.face_count() < 4) break;
        result.tolerance = tolerance;
        for (std::uint32_t f = 0; f < result.face_count() && !all.empty(); ++f) {
            const std::uint16_t* corners = result.face_vertices.begin() + result.face_begin[f];
            const vec<double, 3>& on = result.vertices[corners[0]];
            const vec<double, 3> n =
                hull_normal(result.vertices.begin(), corners, result.face_begin[f + 1] - result.face_begin[f]);
            for (const vec<double, 3>& p : all) result.shortfall = max(result.shortfall, dot(n, p - on));
        }
        return result;
    }
    refuse_thickness<3>(function, thickness);
    return {};
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/hull.hpp
// =================================================================================================
// The convex hull: a polygon in 2D, a polyhedron in 3D, of any number of vertices up to 65,535.

PHYSICS_HPP_BEGIN

/// The shape, see below.
template <class S, int D>
struct hull;

namespace detail {

template <class S, int D>
using hull_block = hull_data<hull_real<S>, D>;

/// A hull for calculations with the scalar T, whose geometry is stored for S: what as<T>() gives where the two store
/// differently. It has a mass, and goes back.
template <class T, class S, int D>
struct foreign_hull {
    using scalar = T;
    const hull_block<S, D>* geometry;
    T radius;

    template <class U>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (std::is_same_v<hull_real<U>, hull_real<S>>)
            return hull<U, D>{geometry, static_cast<U>(radius)};
        else
            return foreign_hull<U, S, D>{geometry, static_cast<U>(radius)};
    }
};

}  // namespace detail

/// All points within radius (m, 0 or more) of a convex polygon or polyhedron in the shape's frame, whose vertices are
/// in a block of memory that a hull_geometry or a world keeps: as long as one of them does, the shape is good.
template <class S, int D>
struct hull {
    using scalar = S;
    const detail::hull_block<S, D>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        return detail::foreign_hull<S, S, D>{geometry, radius}.template as<T>();
    }
};

/// How to build a hull.
struct hull_settings {
    /// At most so many vertices, of those that reach farthest; at least 3, in 3D 4. The others then lie outside, see
    /// hull_geometry::shortfall(). 0: all.
    std::uint32_t most_vertices = 0;
};

namespace detail {

/// How far rounding to S may bend what was flat, for coordinates up to `reach`: 8 spacings.
template <class S>
double hull_tolerance(double reach) {
    const double spacing = static_cast<double>(scalar_traits<S>::epsilon());
    return 8 * max(self_wide<S> ? spacing * reach : spacing, 0x1p-52 * reach);
}

/// A block around points, owned once; null after a refusal.
template <class S, int D>
const hull_block<S, D>* build_hull(const vec<S, D>* points, std::uint32_t count, const hull_settings& settings) {
    constexpr const char* function = "hull_geometry::build";
    buffer<vec<double, D>> exact;
    exact.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        vec<double, D> p;
        for (int k = 0; k < D; ++k) p[k] = static_cast<double>(points[i][k]);
        // Without the sign of zeros, which would count as a difference in the digest.
        exact.push(p + vec<double, D>{});
        if (is_finite(p)) continue;
        char field[24];
        std::snprintf(field, sizeof field, "points[%u]", static_cast<unsigned>(i));
        check_finite(function, field, p);
        return nullptr;
    }
    if (count < D + 1) {
        refuse(function, "number of points", static_cast<double>(count),
               D == 2 ? "a polygon needs at least 3" : "a polyhedron needs at least 4");
        return nullptr;
    }
    const std::uint32_t most = settings.most_vertices;
    if (most > 0 && most < D + 1) {
        refuse(function, "most_vertices", static_cast<double>(most),
               D == 2 ? "it must be at least 3, or 0 for all" : "it must be at least 4, or 0 for all");
        return nullptr;
    }
    const double reach = reach_of(exact);
    if (!(reach > 0)) {
        refuse_thickness<D>(function, 0);
        return nullptr;
    }
    if (reach > 1e30 || reach < 1e-30) {
        refuse(function, "largest coordinate", reach, "it must be from 1e-30 to 1e30");
        return nullptr;
    }
    const hull_outline<D> outline = build_outline(exact, hull_tolerance<S>(reach), most, function);
    if (outline.empty()) return nullptr;
    const hull_block<S, D>* built = hull_block<S, D>::make(outline);
    if (built->volume() > 0) return built;
    release(built);
    refuse_thickness<D>(function, outline.tolerance);
    return nullptr;
}

/// The least and the largest dot products of vertices with D rows.
template <class R, int D>
void vertex_ranges(const hull_data<R, D>& h, const vec<R, D> (&rows)[D], vec<R, D>& lower, vec<R, D>& upper) {
    constexpr int width = sizeof(R) == 4 ? 8 : 4;
    using lanes = pack<R, width>;
    for (int axis = 0; axis < D; ++axis) {
        const auto height = [&](std::uint32_t i) {
            lanes sum = lanes::broadcast(rows[axis].x) * lanes::load(h.coordinate(0) + i) +
                        lanes::broadcast(rows[axis].y) * lanes::load(h.coordinate(1) + i);
            if constexpr (D == 3)
                sum = sum + lanes::broadcast(rows[axis].z) * lanes::load(h.coordinate(2) + i);
            return sum;
        };
        lanes low = height(0), high = low;
        for (std::uint32_t i = width; i < h.padded_vertices; i += width) {
            const lanes here = height(i);
            low = min(low, here);
            high = max(high, here);
        }
        R least[width], most[width];
        low.store(least);
        high.store(most);
        for (int i = 1; i < width; ++i) {
            least[0] = least[i] < least[0] ? least[i] : least[0];
            most[0] = most[i] > most[0] ? most[i] : most[0];
        }
        lower[axis] = least[0];
        upper[axis] = most[0];
    }
}

template <class T>
mass_properties<T, 2> narrowed_mass(const mass_properties<double, 3>& m, mass_properties<T, 2>*) {
    return {T(m.mass), {T(m.center.x), T(m.center.y)}, T(m.inertia.zz)};
}
template <class T>
mass_properties<T, 3> narrowed_mass(const mass_properties<double, 3>& m, mass_properties<T, 3>*) {
    const symmetric<double>& i = m.inertia;
    return {T(m.mass),
            {T(m.center.x), T(m.center.y), T(m.center.z)},
            {T(i.xx), T(i.yy), T(i.zz), T(i.xy), T(i.xz), T(i.yz)}};
}
template <class T, class Data>
mass_properties<T, Data::dimension> mass_of_hull(const Data& h, T radius, T density) {
    const double r = static_cast<double>(radius), d = static_cast<double>(density);
    return narrowed_mass(h.moments.mass(in_space(h.centroid), r, d),
                         static_cast<mass_properties<T, Data::dimension>*>(nullptr));
}

template <class T, class S, int D>
mass_properties<T, D> mass_of(const foreign_hull<T, S, D>& h, std::type_identity_t<T> density) {
    return mass_of_hull(*h.geometry, h.radius, density);
}

}  // namespace detail

template <class S, int D>
bool check(const hull<S, D>& h, const char* function) {
    if (h.geometry == nullptr)
        return detail::refuse(function, "geometry", "null", "it must be the shape of a hull_geometry that was built");
    return detail::check_not_negative(function, "radius", h.radius);
}
/// Tight, and around all vertices whatever rounding does. Cost: 1 to 3 ns a vertex.
template <class S, int D>
aabb<S, D> bounds(const hull<S, D>& h, const transform<S, D>& at) {
    using R = detail::hull_real<S>;
    const mat<S, D> m = matrix(at.rotation);
    vec<R, D> rows[D], low, high;
    for (int i = 0; i < D; ++i)
        for (int k = 0; k < D; ++k) rows[i][k] = static_cast<R>(static_cast<double>(m.column[k][i]));
    detail::vertex_ranges(*h.geometry, rows, low, high);
    S slack = S(4 * static_cast<double>(scalar_traits<S>::epsilon()) * h.geometry->reach);
    if (!(slack > S(0))) slack = scalar_traits<S>::epsilon();
    aabb<S, D> box;
    for (int i = 0; i < D; ++i) {
        box.lower[i] = S(static_cast<double>(low[i])) - (h.radius + slack);
        box.upper[i] = S(static_cast<double>(high[i])) + (h.radius + slack);
    }
    return {at.position + box.lower, at.position + box.upper};
}
/// Of vertices at the same distance the first.
template <class S, int D>
vec<S, D> support(const hull<S, D>& h, vec<S, D> direction) {
    const detail::hull_real<S>* rows[D];
    vec<double, D> d;
    for (int i = 0; i < D; ++i) {
        rows[i] = h.geometry->coordinate(i);
        d[i] = static_cast<double>(direction[i]);
    }
    const std::uint32_t farthest = detail::farthest_vertex(rows, h.geometry->padded_vertices, d);
    const vec<double, D> v = h.geometry->exact_vertex(farthest);
    vec<S, D> p;
    for (int i = 0; i < D; ++i) p[i] = S(v[i]);
    return h.radius > S(0) ? p + normalized(direction) * h.radius : p;
}
/// Exact, rounding included; calculated in double.
template <class S, int D>
mass_properties<S, D> mass_of(const hull<S, D>& h, std::type_identity_t<S> density) {
    return detail::mass_of_hull(*h.geometry, h.radius, density);
}

/// The convex hull of points, built once and then shared by all hull shapes that are made of it, and by worlds that
/// hold such; copies share it too.
///
///     const auto rock = physics::hull_geometry<float, 3>::build(points, count);
///     world.create_shape(body, {.shape = rock.shape()});
template <class S, int D>
class hull_geometry {
public:
    /// No hull: what build() gives in builds without exceptions when it has refused.
    hull_geometry() = default;

    /// The hull of points in any order, at least 3 (4 in 3D), not all on one line (in one plane). Duplicates, points
    /// inside, on edges and in faces do no harm. Exact, but that what rounding of coordinates to S bent by at most 8
    /// spacings is flat: the corners of a rotated box give six quads. Vertices are some of the points, unchanged, in
    /// an order that depends on the set of points only. Refuses NaN and infinity, points without area or volume, and
    /// more than 65,535 vertices. Cost: O(n log n), in 3D 1 us a vertex and 0.1 to 0.5 us a point.
    [[nodiscard]] static hull_geometry build(const vec<S, D>* points, std::uint32_t count,
                                             const hull_settings& settings = {}) {
        return hull_geometry(detail::build_hull(points, count, settings));
    }
    template <std::size_t N>
    [[nodiscard]] static hull_geometry build(const vec<S, D> (&points)[N], const hull_settings& settings = {}) {
        return build(points, static_cast<std::uint32_t>(N), settings);
    }
    [[nodiscard]] static hull_geometry build(std::initializer_list<vec<S, D>> points,
                                             const hull_settings& settings = {}) {
        return build(points.begin(), static_cast<std::uint32_t>(points.size()), settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] hull<S, D> shape(S radius = S(0)) const { return {data(), radius}; }

    /// In 2D counter-clockwise, in 3D by x, y and z.
    [[nodiscard]] std::uint32_t vertex_count() const { return data()->vertex_count; }
    [[nodiscard]] vec<S, D> vertex(std::uint32_t i) const { return narrowed(data()->exact_vertex(i)); }
    /// Edges in 2D, edge i from vertex i to the next; polygons in 3D.
    [[nodiscard]] std::uint32_t face_count() const { return data()->face_count; }
    [[nodiscard]] std::uint32_t face_size(std::uint32_t face) const {
        return data()->face_end(face) - data()->face_begin(face);
    }
    /// The number of the k-th vertex of a face, counter-clockwise as seen from outside.
    [[nodiscard]] std::uint32_t face_vertex(std::uint32_t face, std::uint32_t k) const {
        return data()->face_vertices()[data()->face_begin(face) + k];
    }
    /// The unit outward normal of a face.
    [[nodiscard]] vec<S, D> face_normal(std::uint32_t face) const { return narrowed(data()->normal(face)); }
    /// The volume (m^3; in 2D the area, m^2) and the centroid, without any radius.
    [[nodiscard]] double volume() const { return data()->volume(); }
    [[nodiscard]] vec<double, D> centroid() const { return data()->centroid; }

    /// How far (m) points lie outside of a face since settings allowed only so many vertices.
    [[nodiscard]] double shortfall() const { return data()->shortfall; }
    /// The block itself; null if there is none.
    [[nodiscard]] const detail::hull_block<S, D>* data() const { return owner_.get(); }

private:
    explicit hull_geometry(const detail::hull_block<S, D>* built) : owner_(built) {}
    static vec<S, D> narrowed(const vec<double, D>& v) {
        vec<S, D> result;
        for (int i = 0; i < D; ++i) result[i] = S(v[i]);
        return result;
    }

    detail::geometry_owner<detail::hull_block<S, D>> owner_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/halfspace.hpp
// =================================================================================================
// The halfspace: endless ground or wall.

PHYSICS_HPP_BEGIN

/// All points p with dot(normal, p) <= offset (m) in the shape's frame; normal is a unit vector, four digits
/// of it suffice. It has no mass, so it serves static and kinematic bodies.
template <class S, int D>
struct halfspace {
    using scalar = S;
    vec<S, D> normal = upward();
    S offset = S(0);

    template <class T>
    [[nodiscard]] constexpr halfspace<T, D> as() const {
        halfspace<T, D> result;
        for (int i = 0; i < D; ++i) result.normal[i] = static_cast<T>(normal[i]);
        result.offset = static_cast<T>(offset);
        return result;
    }

private:
    static constexpr vec<S, D> upward() {
        vec<S, D> up;
        up.y = S(1);
        return up;
    }
};

template <class S, int D>
bool check(const halfspace<S, D>& h, const char* function) {
    if (!detail::check_finite(function, "normal", h.normal) || !detail::check_finite(function, "offset", h.offset))
        return false;
    const S l = length(h.normal);
    if (abs(l - S(1)) > S(64) * scalar_traits<S>::epsilon() + S(1e-4))
        return detail::refuse(function, "length of normal", static_cast<double>(l), "it must be 1");
    return true;
}
namespace detail {
/// The normal with length 1: two Newton steps bring the error that check() admits below rounding.
template <class S, int D>
constexpr vec<S, D> unit_normal(const halfspace<S, D>& h) {
    const vec<S, D> n = h.normal * length_repair(dot(h.normal, h.normal));
    return n * length_repair(dot(n, n));
}
}  // namespace detail
/// Endless in most directions: a quarter of the scalar's range stands for infinity, so that margins do not
/// overflow.
template <class S, int D>
constexpr aabb<S, D> bounds(const halfspace<S, D>& h, const transform<S, D>& at) {
    const S far = scalar_traits<S>::max() * S(0.25);
    aabb<S, D> box{vec<S, D>::filled(-far), vec<S, D>::filled(far)};
    const vec<S, D> n = at.rotation * detail::unit_normal(h);
    const S height = h.offset + dot(n, at.position);
    for (int i = 0; i < D; ++i) {
        bool aligned = true;
        for (int j = 0; j < D; ++j) aligned = aligned && (i == j || n[j] == S(0));
        if (aligned && n[i] > S(0)) box.upper[i] = height;
        if (aligned && n[i] < S(0)) box.lower[i] = -height;
    }
    return box;
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/shapes.hpp
// =================================================================================================
// The closed set of shapes that a recipe uses: one value that holds any of them, no virtual calls.

PHYSICS_HPP_BEGIN

namespace detail {
/// A shape that refers to a block of geometry.
template <class Shape>
concept refers_to_geometry = requires(const Shape s) {
    { s.geometry } -> std::convertible_to<const geometry_block*>;
};
}  // namespace detail

/// A value that holds one shape of a closed set. Size: the largest shape and its number.
template <class S, int D, template <class, int> class... Shapes>
class any_shape {
public:
    static constexpr int kinds = sizeof...(Shapes);
    /// The number of a shape within the set, -1 if it is not of the set.
    template <class Shape>
    static constexpr int kind_of() {
        constexpr bool same[] = {std::is_same_v<Shape, Shapes<S, D>>...};
        for (int i = 0; i < kinds; ++i)
            if (same[i]) return i;
        return -1;
    }

    any_shape() : any_shape(first{}) {}
    template <class Shape>
        requires(kind_of<Shape>() >= 0)
    any_shape(const Shape& shape) : kind_(kind_of<Shape>()) { new (static_cast<void*>(bytes_)) Shape(shape); }

    [[nodiscard]] int kind() const { return kind_; }
    /// The shape, which must be of that type.
    template <class Shape>
    [[nodiscard]] const Shape& get() const {
        return *std::launder(reinterpret_cast<const Shape*>(bytes_));
    }
    /// Whether any shape of the set refers to geometry, and the block that this one refers to; null if to none.
    static constexpr bool has_geometry = (detail::refers_to_geometry<Shapes<S, D>> || ...);
    [[nodiscard]] const detail::geometry_block* geometry() const {
        if constexpr (has_geometry)
            return visit([](const auto& shape) -> const detail::geometry_block* {
                if constexpr (detail::refers_to_geometry<std::remove_cvref_t<decltype(shape)>>) return shape.geometry;
                else return nullptr;
            });
        else return nullptr;
    }
    /// Calls f with the shape in its own type.
    template <class F>
    decltype(auto) visit(F&& f) const {
        return visit_from<0, F, Shapes<S, D>...>(f);
    }

private:
    template <int I, class F, class First, class... Rest>
    decltype(auto) visit_from(F& f) const {
        if constexpr (sizeof...(Rest) == 0)
            return f(get<First>());
        else
            return kind_ == I ? f(get<First>()) : visit_from<I + 1, F, Rest...>(f);
    }
    template <class First, class...>
    struct head {
        using type = First;
    };
    using first = typename head<Shapes<S, D>...>::type;
    static constexpr std::size_t bytes = [] {
        std::size_t most = 0;
        ((most = sizeof(Shapes<S, D>) > most ? sizeof(Shapes<S, D>) : most), ...);
        return most;
    }();

    alignas(Shapes<S, D>...) unsigned char bytes_[bytes] = {};
    std::int32_t kind_ = 0;
};

template <class S, int D, template <class, int> class... Shapes>
aabb<S, D> bounds(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& at) {
    return shape.visit([&](const auto& s) { return bounds(s, at); });
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/core.hpp
// =================================================================================================
// Convex shapes as the general kernels see them: a core with support points, and a radius around it.

PHYSICS_HPP_BEGIN

// The general kernels (GJK, EPA, MPR, patches) compute in double for every scalar: it holds floats and Q32.32 numbers
// exactly, its products of floats too, and one copy of the code serves all. Results are rounded once to the scalar.

namespace detail {

/// A point or vector of the general kernels.
template <int D>
using point = vec<double, D>;

template <int D, class S>
constexpr point<D> to_point(const vec<S, D>& v) {
    point<D> p;
    for (int i = 0; i < D; ++i) p[i] = detail::to_double(v[i]);
    return p;
}
template <class S, int D>
constexpr vec<S, D> from_point(const point<D>& p) {
    vec<S, D> v;
    for (int i = 0; i < D; ++i) v[i] = static_cast<S>(p[i]);
    return v;
}

/// The rotation matrix in double; of a rotation whose length rounding has changed, that of the unit one.
template <class S>
mat<double, 2> to_matrix(const rotation<S, 2>& r) {
    const double c = detail::to_double(r.cosine), s = detail::to_double(r.sine);
    // One step of Newton from 1: what is left of an error e of the length is e^2.
    const double scale = 1.5 - 0.5 * (c * c + s * s);
    return {{{c * scale, s * scale}, {-s * scale, c * scale}}};
}
template <class S>
mat<double, 3> to_matrix(const rotation<S, 3>& r) {
    const double x = detail::to_double(r.x), y = detail::to_double(r.y), z = detail::to_double(r.z),
                 w = detail::to_double(r.w), s = 2 / ((x * x + y * y) + (z * z + w * w));
    return {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
             {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
             {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

/// A support point and the number of the vertex that it is; 0 where the core has no vertices.
template <int D>
struct support_point {
    point<D> at;
    std::uint32_t vertex = 0;
};

enum class core_kind : std::uint8_t { point, segment, triangle, box, hull_of_floats, hull_of_doubles, disc, custom };

/// A convex set in its own frame, to which a radius may be added on all sides.
template <int D>
struct core {
    core_kind kind = core_kind::point;
    /// Vertices of a hull, a multiple of 8.
    std::uint32_t count = 0;
    /// Beyond the core (m).
    double radius = 0;
    /// No point of the core is farther from the frame's origin along any direction.
    double extent = 0;
    /// Half of the smallest width, which says what deviation is small; 0 for points, segments and triangles.
    double thickness = 0;
    /// The vertices of point, segment or triangle; in corner[0] the half extents of a box, or the half length, radius
    /// at the lower and at the upper end of discs.
    point<D> corner[3];
    /// A point inside.
    point<D> center;
    /// What a hull or a custom core is made of.
    const void* data = nullptr;
    const void* coordinate[D] = {};
    point<D> (*custom)(const void*, const point<D>&) = nullptr;

    /// The farthest point along d, which need not be a unit vector, nor be other than null.
    [[nodiscard]] support_point<D> support(const point<D>& d) const {
        switch (kind) {
        case core_kind::point: return {corner[0], 0};
        case core_kind::segment: return nearer(d, 0, 1);
        case core_kind::triangle: {
            const support_point<D> best = nearer(d, 0, 1);
            return dot(d, corner[2] - best.at) > 0 ? support_point<D>{corner[2], 2} : best;
        }
        case core_kind::box: {
            support_point<D> result{corner[0], 0};
            for (int i = 0; i < D; ++i)
                if (d[i] < 0) result.at[i] = -result.at[i], result.vertex |= 1u << i;
            return result;
        }
        case core_kind::hull_of_floats: return from_hull<float>(d);
        case core_kind::hull_of_doubles: return from_hull<double>(d);
        case core_kind::disc: return {from_disc(d), 0};
        case core_kind::custom: return {custom(data, d), 0};
        }
        return {};
    }
    /// The vertex of that number; the number may be a wrong one, from another shape.
    [[nodiscard]] support_point<D> vertex(std::uint32_t i) const {
        switch (kind) {
        case core_kind::point: return {corner[0], 0};
        case core_kind::segment: i &= 1u; return {corner[i], i};
        case core_kind::triangle: i = i < 3 ? i : 0; return {corner[i], i};
        case core_kind::box: {
            i &= (1u << D) - 1;
            support_point<D> result{corner[0], i};
            for (int k = 0; k < D; ++k)
                if (i >> k & 1u) result.at[k] = -result.at[k];
            return result;
        }
        case core_kind::hull_of_floats: return vertex_of_hull<float>(i < count ? i : 0);
        case core_kind::hull_of_doubles: return vertex_of_hull<double>(i < count ? i : 0);
        default: return {};
        }
    }
    /// Whether a vertex's number names it, so that a simplex can be found again.
    [[nodiscard]] bool has_vertices() const { return kind < core_kind::disc; }

private:
    [[nodiscard]] support_point<D> nearer(const point<D>& d, std::uint32_t i, std::uint32_t j) const {
        return dot(d, corner[j] - corner[i]) > 0 ? support_point<D>{corner[j], j} : support_point<D>{corner[i], i};
    }
    template <class R>
    [[nodiscard]] support_point<D> vertex_of_hull(std::uint32_t i) const {
        support_point<D> result{{}, i};
        for (int k = 0; k < D; ++k) result.at[k] = static_cast<double>(static_cast<const R*>(coordinate[k])[i]);
        return result;
    }
    template <class R>
    [[nodiscard]] support_point<D> from_hull(const point<D>& d) const {
        const R* rows[D];
        for (int k = 0; k < D; ++k) rows[k] = static_cast<const R*>(coordinate[k]);
        return vertex_of_hull<R>(farthest_vertex<R, D>(rows, count, d));
    }
    /// Of two coaxial discs and all between them; the axis is x.
    [[nodiscard]] point<D> from_disc(const point<D>& d) const {
        if constexpr (D == 3) {
            const double across = physics::sqrt(d.y * d.y + d.z * d.z), half = corner[0].x, low = corner[0].y,
                         high = corner[0].z;
            const bool upper = d.x * half + across * high > across * low - d.x * half;
            const double r = upper ? high : low, scale = across > 0 ? r / across : 0;
            return {upper ? half : -half, across > 0 ? d.y * scale : r, d.z * scale};
        } else {
            return {};
        }
    }
};

/// A core where it stands.
template <int D>
struct placed_core {
    const core<D>* shape;
    mat<double, D> axes;
    point<D> at;

    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> support(const point<D>& d) const {
        support_point<D> s = shape->support(transposed_times(axes, d));
        s.at = axes * s.at + at;
        return s;
    }
    [[nodiscard]] support_point<D> vertex(std::uint32_t i) const {
        support_point<D> s = shape->vertex(i);
        s.at = axes * s.at + at;
        return s;
    }
};

}  // namespace detail

// core_of(shape) gives the core of a shape, which must outlive it. Shapes of your own have one too if they have a
// function support(shape, direction).

template <class S, int D>
detail::core<D> core_of(const ball<S, D>& b) {
    detail::core<D> c;
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const capsule<S, D>& b) {
    detail::core<D> c;
    c.kind = detail::core_kind::segment;
    c.extent = detail::to_double(b.half_length);
    c.corner[0].x = -c.extent;
    c.corner[1].x = c.extent;
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const box<S, D>& b) {
    detail::core<D> c;
    c.kind = detail::core_kind::box;
    c.corner[0] = detail::to_point(b.half_extents);
    c.thickness = c.corner[0].x;
    for (int i = 0; i < D; ++i) {
        c.extent += c.corner[0][i];
        c.thickness = min(c.thickness, c.corner[0][i]);
    }
    return c;
}
template <class S, int D>
detail::core<D> core_of(const hull<S, D>& b) {
    const auto& h = *b.geometry;
    detail::core<D> c;
    c.kind = std::is_same_v<detail::hull_real<S>, float> ? detail::core_kind::hull_of_floats
                                                         : detail::core_kind::hull_of_doubles;
    c.count = h.padded_vertices;
    c.radius = detail::to_double(b.radius);
    c.data = &h;
    for (int i = 0; i < D; ++i) {
        c.coordinate[i] = h.coordinate(i);
        c.extent += max(-h.lower[i], h.upper[i]);
    }
    c.center = h.centroid;
    c.thickness = h.inradius;
    return c;
}
/// Of a shape that is known by its support function alone.
template <template <class, int> class Shape, class S, int D>
    requires requires(const Shape<S, D>& s, vec<S, D> direction) {
        { support(s, direction) } -> std::same_as<vec<S, D>>;
    }
detail::core<D> core_of(const Shape<S, D>& shape) {
    detail::core<D> c;
    c.kind = detail::core_kind::custom;
    c.data = &shape;
    c.custom = [](const void* data, const detail::point<D>& d) {
        const vec<S, D> along = detail::from_point<S>(normalized(d));
        return detail::to_point(support(*static_cast<const Shape<S, D>*>(data), along));
    };
    const aabb<S, D> box = bounds(shape, transform<S, D>{});
    for (int i = 0; i < D; ++i)
        c.extent += detail::to_double(max(abs(box.lower[i]), abs(box.upper[i])));
    return c;
}

namespace detail {

/// A shape that the general kernels take.
template <class Shape>
concept has_core = requires(const Shape& s) { core_of(s); };

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/part_tree.hpp
// =================================================================================================
// A tree of boxes over the parts of a shape, built once.

PHYSICS_HPP_BEGIN

namespace detail {

/// The nearest float below x, or one a little lower; 3e38 is endless.
inline float float_below(double x) {
    const double lower = x - abs(x) * 0x1p-23 - 0x1p-120;
    return static_cast<float>(lower > 3e38 ? 3e38 : lower < -3e38 ? -3e38 : lower);
}
/// A box in float that contains the box in double.
template <int D>
aabb<float, D> outward_floats(const aabb<double, D>& box) {
    aabb<float, D> result;
    for (int i = 0; i < D; ++i) {
        result.lower[i] = float_below(box.lower[i]);
        result.upper[i] = -float_below(-box.upper[i]);
    }
    return result;
}

/// A tree of boxes over numbered parts: nodes in the order of a walk that goes down first, each with the number of the
/// node that follows what is below it. Parts are halved by their middles along the axis on which these spread most,
/// down to four, so that no input makes it deeper than log2(n). Memory: 20 bytes a part in space, 16 in the plane.
/// Source: stackless walks are those of Smits, Efficiency issues for ray tracing (1998).
template <int D>
class part_tree {
public:
    static constexpr std::uint32_t parts_of_leaf = 4;
    static constexpr std::uint32_t nodes_for(std::uint32_t parts) {
        return parts == 0 ? 0 : 2 * ((parts - 1) / parts_of_leaf + 1) - 1;
    }

    /// The places that it needs in a block.
    struct places {
        std::size_t nodes, parts;
    };
    static places place(block_layout& layout, std::uint32_t parts) {
        const std::size_t nodes = layout.place<node>(nodes_for(parts));
        return {nodes, layout.place<std::uint32_t>(parts)};
    }
    /// Builds the tree over parts by their boxes. Cost: 0.3 us a part, and 16 bytes of scratch.
    void build(const geometry_block* block, places at, const aabb<float, D>* boxes, std::uint32_t count);

    [[nodiscard]] std::uint32_t size() const { return parts_.size(); }
    /// Calls f(number) for the parts in leaves whose boxes overlap the box: for all that do, and a few more. Neither
    /// recursion nor allocation. Cost: O(log n) and 5 ns a node.
    template <class F>
    void visit(const aabb<double, D>& box, F&& f) const {
        const aabb<float, D> wanted = outward_floats(box);
        const node* const nodes = nodes_.begin();
        const std::uint32_t end = nodes_.size();
        for (std::uint32_t i = 0; i < end;) {
            const node& n = nodes[i];
            if (!overlap(n.box, wanted)) {
                i = n.next;
                continue;
            }
            if (n.first != none) {
                const std::uint32_t last = min(n.first + parts_of_leaf, parts_.size());
                for (std::uint32_t k = n.first; k < last; ++k) f(parts_[k]);
            }
            ++i;
        }
    }
    /// Calls f(number) for the parts in leaves whose boxes a segment may meet, in the order of the tree; f returns the
    /// part of the segment up to which the search goes on. Cost: O(log n + parts met) and 10 ns a node.
    template <class F>
    void visit(const box_ray<D>& ray, F&& f) const {
        const node* const nodes = nodes_.begin();
        const std::uint32_t end = nodes_.size();
        double most = 1;
        for (std::uint32_t i = 0; i < end;) {
            const node& n = nodes[i];
            if (!ray.meets(n.box, most)) {
                i = n.next;
                continue;
            }
            if (n.first != none) {
                const std::uint32_t last = min(n.first + parts_of_leaf, parts_.size());
                for (std::uint32_t k = n.first; k < last; ++k) most = f(parts_[k]);
            }
            ++i;
        }
    }
    /// Calls f(box) for 32 to 64 boxes that contain all parts; for fewer where there are few.
    template <class F>
    void cover(F&& f) const {
        const std::uint32_t most = nodes_.size() / 32;
        for (std::uint32_t i = 0; i < nodes_.size();) {
            const node& n = nodes_[i];
            if (n.first != none || n.next - i <= most) {
                f(n.box);
                i = n.next;
            } else {
                ++i;
            }
        }
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    struct node {
        aabb<float, D> box;
        std::uint32_t next;
        /// Of leaves where their parts begin, a multiple of 4.
        std::uint32_t first;
    };
    static std::uint32_t min(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
    static void halve(std::uint64_t* keys, std::uint64_t* spare, std::uint32_t count, const aabb<float, D>* boxes);

    block_array<node> nodes_;
    block_array<std::uint32_t> parts_;
};

/// Brings keys, whose lower halves number parts, into the order of their middles along the axis on which they differ
/// most.
template <int D>
void part_tree<D>::halve(std::uint64_t* keys, std::uint64_t* spare, std::uint32_t count, const aabb<float, D>* boxes) {
    // Half of the sums, so that none overflows.
    const auto middle = [&](std::uint64_t key) {
        const aabb<float, D>& box = boxes[static_cast<std::uint32_t>(key)];
        return box.lower * 0.5f + box.upper * 0.5f;
    };
    vec<float, D> low = middle(keys[0]), high = low;
    for (std::uint32_t i = 1; i < count; ++i) {
        const vec<float, D> m = middle(keys[i]);
        low = physics::min(low, m);
        high = physics::max(high, m);
    }
    int axis = 0;
    for (int i = 1; i < D; ++i)
        if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
    for (std::uint32_t i = 0; i < count; ++i) {
        // Zero without a sign; then numbers ascend with their bits, negative ones descend.
        const auto bits = static_cast<std::uint32_t>(scalar_traits<float>::bits(middle(keys[i])[axis] + 0.0f));
        const std::uint32_t rank = bits >> 31 ? ~bits : bits | 0x80000000u;
        keys[i] = std::uint64_t{rank} << 32 | (keys[i] & 0xffffffffu);
    }
    const std::uint64_t* sorted = radix_sort(keys, spare, count, 32, 64);
    if (sorted != keys) std::memcpy(keys, sorted, count * sizeof *keys);
}

template <int D>
void part_tree<D>::build(const geometry_block* block, places at, const aabb<float, D>* boxes, std::uint32_t count) {
    nodes_.attach(block, at.nodes, nodes_for(count));
    parts_.attach(block, at.parts, count);
    if (count == 0) return;
    buffer<std::uint64_t> keys, spare;
    keys.resize(count);
    spare.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) keys[i] = i;
    struct range {
        std::uint32_t first, count;
    } todo[40];
    int waiting = 0;
    todo[waiting++] = {0, count};
    // What waits longest is what lies to the right: nodes come in the order of the walk.
    for (std::uint32_t i = 0; waiting > 0; ++i) {
        const range r = todo[--waiting];
        nodes_[i].next = i + nodes_for(r.count);
        nodes_[i].first = none;
        if (r.count <= parts_of_leaf) {
            nodes_[i].first = r.first;
            continue;
        }
        halve(keys.begin() + r.first, spare.begin() + r.first, r.count, boxes);
        const std::uint32_t left = (r.count / 2 + parts_of_leaf - 1) / parts_of_leaf * parts_of_leaf;
        todo[waiting++] = {r.first + left, r.count - left};
        todo[waiting++] = {r.first, left};
    }
    for (std::uint32_t i = 0; i < count; ++i) parts_[i] = static_cast<std::uint32_t>(keys[i]);
    for (std::uint32_t i = nodes_.size(); i-- > 0;) {
        node& n = nodes_[i];
        if (n.first == none) {
            n.box = merged(nodes_[i + 1].box, nodes_[nodes_[i + 1].next].box);
            continue;
        }
        n.box = boxes[parts_[n.first]];
        for (std::uint32_t k = n.first + 1; k < min(n.first + parts_of_leaf, count); ++k)
            n.box = merged(n.box, boxes[parts_[k]]);
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/surface_part.hpp
// =================================================================================================
// What surfaces such as meshes and chains are made of.

PHYSICS_HPP_BEGIN

namespace detail {

/// One flat part of a surface, in the surface's frame: a segment in the plane, a triangle in space.
template <int D>
struct surface_part {
    /// In the plane the ends, the solid being to the left on the way from the first to the second; in space
    /// counter-clockwise as seen from outside.
    vec<double, D> corner[D];
    /// Unit normal outwards.
    vec<double, D> normal;
    /// Unit normals of the parts that follow beyond the ends or, in space, beyond edge i from corner i to the next.
    vec<double, D> beyond[D];
    /// Whether anything follows there.
    bool continues[D] = {};
    /// Whether it stops bodies on its back too.
    bool two_sided = false;
    std::uint32_t number = 0;
};

/// What a ray needs to know of a part; corners as there.
template <int D>
struct surface_face {
    vec<double, D> corner[D];
    bool two_sided;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/surface_shape.hpp
// =================================================================================================
// What shapes made of parts share: how their geometry is stored, checked and bounded.

PHYSICS_HPP_BEGIN

namespace detail {

/// A shape for calculations with the scalar T where that stores geometry in other numbers: it goes back.
template <class T, class Shape>
struct foreign_shape {
    using scalar = T;
    Shape shape;

    template <class U>
    [[nodiscard]] constexpr auto as() const {
        return shape.template as<U>();
    }
};
/// Whether shapes for S and T can refer to the same geometry.
template <class S, class T>
constexpr bool same_storage = std::is_same_v<hull_real<S>, hull_real<T>>;

/// Mixes a word into a number that geometries of the same content share on every system.
inline void mix_digest(std::uint64_t& digest, std::uint64_t word) {
    digest = (digest ^ word) * 0xff51afd7ed558ccdu;
    digest ^= digest >> 32;
}
template <int D>
void mix_digest(std::uint64_t& digest, const vec<double, D>& p) {
    for (int i = 0; i < D; ++i) mix_digest(digest, scalar_traits<double>::bits(p[i]));
}

/// Coordinates that S can hold with room to spare, floats can bound and doubles can multiply.
template <class S>
bool check_reach(const char* function, double reach) {
    const double most = min(1e30, static_cast<double>(scalar_traits<S>::max()) * 0.25);
    return reach <= most || refuse(function, "largest coordinate", reach,
                                   "it must be at most 1e30, and a quarter of the scalar's range");
}
/// A distance between parts whose square is a number too.
template <class S>
bool check_spacing(const char* function, const char* field, S spacing) {
    if (!check_positive(function, field, spacing)) return false;
    const double exact = static_cast<double>(spacing);
    return exact >= 1e-30 || refuse(function, field, exact, "it must be at least 1e-30");
}
/// Refuses a number or a point of an array by its place where it is not finite.
template <class T>
bool check_item(const char* function, const char* name, std::uint32_t i, const T& item) {
    if (is_finite(item)) return true;
    char field[40];
    std::snprintf(field, sizeof field, "%s[%u]", name, static_cast<unsigned>(i));
    return check_finite(function, field, item);
}
/// Points in double; false after a refusal.
template <class S, int D>
bool take_points(const char* function, const char* name, const vec<S, D>* points, std::uint32_t count,
                 buffer<vec<double, D>>& taken) {
    taken.reserve(count);
    double reach = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!check_item(function, name, i, points[i])) return false;
        reach = max(reach, largest(taken.push(to_point(points[i]))));
    }
    return check_reach<S>(function, reach);
}

/// The box around points, at least one.
template <int D>
aabb<double, D> box_around(const buffer<vec<double, D>>& points) {
    aabb<double, D> box{points[0], points[0]};
    for (const vec<double, D>& p : points) box = {min(box.lower, p), max(box.upper, p)};
    return box;
}
/// The largest coordinate of a box by magnitude.
template <int D>
double reach_of(const aabb<double, D>& box) {
    return max(largest(box.lower), largest(box.upper));
}

/// Whether a shape's geometry was built, and its radius is one.
template <class Shape>
bool check_surface(const Shape& shape, const char* owner, const char* function) {
    if (shape.geometry == nullptr) return refuse(function, "geometry", "null", owner);
    return check_not_negative(function, "radius", shape.radius);
}

/// Collects points and boxes of a frame, and gives the box around them where the frame stands.
template <class S, int D>
class turned_bounds {
public:
    explicit turned_bounds(const transform<S, D>& at) : at_(at), axes_(to_matrix(at.rotation)) {
        for (int i = 0; i < D; ++i) low_[i] = 1e300, high_[i] = -1e300;
    }
    void add(const vec<double, D>& p) {
        const vec<double, D> q = axes_ * p;
        low_ = min(low_, q);
        high_ = max(high_, q);
    }
    template <class R>
    void add(const aabb<R, D>& box) {
        vec<double, D> middle, reach;
        for (int i = 0; i < D; ++i) {
            const double lower = static_cast<double>(box.lower[i]), upper = static_cast<double>(box.upper[i]);
            middle += axes_.column[i] * ((lower + upper) * 0.5);
            reach += abs(axes_.column[i]) * ((upper - lower) * 0.5);
        }
        low_ = min(low_, middle - reach);
        high_ = max(high_, middle + reach);
    }
    /// Grown by a radius and by what rounding to S does to coordinates as large as those of `around`.
    [[nodiscard]] aabb<S, D> box(S radius, const aabb<double, D>& around) const {
        S slack = S(4 * static_cast<double>(scalar_traits<S>::epsilon()) * reach_of(around));
        if (!(slack > S(0))) slack = scalar_traits<S>::epsilon();
        aabb<S, D> result;
        for (int i = 0; i < D; ++i) {
            result.lower[i] = S(low_[i]) - (radius + slack);
            result.upper[i] = S(high_[i]) + (radius + slack);
        }
        return {at_.position + result.lower, at_.position + result.upper};
    }

private:
    const transform<S, D>& at_;
    mat<double, D> axes_;
    vec<double, D> low_, high_;
};
/// From how many points on the boxes of the tree stand for them.
inline constexpr std::uint32_t points_to_bound = 64;

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/chain_data.hpp
// =================================================================================================
// What chains and tile grids are in memory: points, what follows what, and a tree over the segments.

PHYSICS_HPP_BEGIN

namespace detail {

/// The segments before and after one; itself where nothing follows.
struct chain_links {
    std::uint32_t before, after;
};

/// Segments with coordinates in R. Segment i leads from point i to the point at which the segment after it begins; the
/// last of an open chain to the point after it. Without links segments follow one another as they are numbered.
template <class R>
struct chain_data : geometry_block {
    bool loop, two_sided;
    std::uint64_t digest;
    aabb<double, 2> box;
    block_array<vec<R, 2>> points;
    block_array<chain_links> links;
    part_tree<2> tree;

    [[nodiscard]] std::uint32_t segment_count() const { return tree.size(); }
    [[nodiscard]] vec<double, 2> point(std::uint32_t i) const { return to_point(points[i]); }
    [[nodiscard]] chain_links links_of(std::uint32_t i) const {
        if (links.size() > 0) return links[i];
        const std::uint32_t last = segment_count() - 1;
        return {i > 0 ? i - 1 : loop ? last : i, i < last ? i + 1 : loop ? 0 : i};
    }
    [[nodiscard]] vec<double, 2> end_of(std::uint32_t i) const {
        const std::uint32_t after = links_of(i).after;
        return point(after == i ? i + 1 : after);
    }
    [[nodiscard]] vec<double, 2> normal_of(std::uint32_t i) const {
        return normalized(perpendicular(end_of(i) - point(i)));
    }
    [[nodiscard]] surface_part<2> part(std::uint32_t i) const {
        const chain_links l = links_of(i);
        surface_part<2> p;
        p.corner[0] = point(i);
        p.corner[1] = point(l.after == i ? i + 1 : l.after);
        p.normal = normalized(perpendicular(p.corner[1] - p.corner[0]));
        p.continues[0] = l.before != i;
        p.continues[1] = l.after != i;
        if (p.continues[0]) p.beyond[0] = normal_of(l.before);
        if (p.continues[1]) p.beyond[1] = normal_of(l.after);
        p.two_sided = two_sided;
        p.number = i;
        return p;
    }

    /// A block with one owner: the caller. Links are null or one for each segment.
    static const chain_data* make(const buffer<vec<double, 2>>& points, const buffer<chain_links>& links, bool loop,
                                  bool two_sided);
};

/// The parts of a surface whose boxes reach into a box.
template <class R, class F>
void each_segment(const chain_data<R>& c, const aabb<double, 2>& box, F&& f) {
    c.tree.visit(box, [&](std::uint32_t i) {
        const vec<double, 2> a = c.point(i), b = c.end_of(i);
        if (overlap(aabb<double, 2>{min(a, b), max(a, b)}, box)) f(c.part(i));
    });
}
/// The parts that a segment may meet, as for rays on meshes.
template <class R, class F>
void each_segment_along(const chain_data<R>& c, const box_ray<2>& ray, F&& f) {
    c.tree.visit(ray, [&](std::uint32_t i) {
        return f(surface_face<2>{{c.point(i), c.end_of(i)}, c.two_sided});
    });
}

template <class R>
const chain_data<R>* chain_data<R>::make(const buffer<vec<double, 2>>& points, const buffer<chain_links>& links,
                                         bool loop, bool two_sided) {
    const bool linked = links.size() > 0;
    const std::uint32_t segments = points.size() - (loop || linked ? 0 : 1);
    block_layout layout(sizeof(chain_data));
    const std::size_t at_points = layout.place<vec<R, 2>>(points.size());
    const std::size_t at_links = layout.place<chain_links>(links.size());
    const auto at_tree = part_tree<2>::place(layout, segments);
    auto* c = new_geometry<chain_data>(layout.bytes());
    c->loop = loop;
    c->two_sided = two_sided;
    c->box = box_around(points);
    c->digest = points.size() * 4ull + std::uint64_t{loop} * 2 + std::uint64_t{two_sided};
    c->points.attach(c, at_points, points.size());
    c->links.attach(c, at_links, links.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        c->points[i] = from_point<R>(points[i]);
        mix_digest(c->digest, points[i]);
    }
    for (std::uint32_t i = 0; i < links.size(); ++i) {
        c->links[i] = links[i];
        mix_digest(c->digest, std::uint64_t{links[i].before} << 32 | links[i].after);
    }
    buffer<aabb<float, 2>> boxes;
    boxes.reserve(segments);
    for (std::uint32_t i = 0; i < segments; ++i) {
        const vec<double, 2> a = points[i], b = points[linked ? links[i].after : i + 1 < points.size() ? i + 1 : 0];
        boxes.push(outward_floats(aabb<double, 2>{min(a, b), max(a, b)}));
    }
    c->tree.build(c, at_tree, boxes.begin(), segments);
    return c;
}

template <class R, class S>
aabb<S, 2> bounds_of_chain(const chain_data<R>& c, S radius, const transform<S, 2>& at) {
    turned_bounds<S, 2> around(at);
    if (c.points.size() <= points_to_bound)
        for (std::uint32_t i = 0; i < c.points.size(); ++i) around.add(c.point(i));
    else c.tree.cover([&](const aabb<float, 2>& box) { around.add(box); });
    return around.box(radius, c.box);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/chain.hpp
// =================================================================================================
// The chain: a line of segments in the plane, such as the ground of a level.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of a line of segments in the shape's frame; it exists in the plane. It has
/// no mass, so it serves static and kinematic bodies. A chain_geometry or a world keeps the points: as long as one of
/// them does, the shape is good.
template <class S, int D>
struct chain;
template <class S>
struct chain<S, 2> {
    using scalar = S;
    const detail::chain_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return chain<T, 2>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, chain>{*this};
    }
};

template <class S>
bool check(const chain<S, 2>& c, const char* function) {
    return detail::check_surface(c, "it must be the shape of a chain_geometry that was built", function);
}
/// Tight up to 64 points; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 2> bounds(const chain<S, 2>& c, const transform<S, 2>& at) {
    return detail::bounds_of_chain(*c.geometry, c.radius, at);
}
/// For the narrowphase: calls f with the segments that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const chain<S, 2>& c, const aabb<double, 2>& box, F&& f) {
    detail::each_segment(*c.geometry, box, f);
}
/// For rays: calls f with the segments that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const chain<S, 2>& c, const detail::box_ray<2>& ray, F&& f) {
    detail::each_segment_along(*c.geometry, ray, f);
}

/// How the points of a chain are joined.
struct chain_settings {
    /// The last point is joined to the first.
    bool loop = false;
    /// Bodies are stopped on the back too.
    bool two_sided = false;
};

/// The line of segments from each point to the next, built once and shared by all chains made of it, and by worlds that
/// hold such. Bodies glide from segment to segment without a bump. The solid is to the left on the way, the front to
/// the right: the ground leads from right to left, a ceiling from left to right, and the outline of an island, as of a
/// polygon, counter-clockwise.
/// Walk along a chain with your left hand on the solid: what comes from the right is stopped.
///
/// A body whose centre is behind a segment passes through it, unless the chain is two-sided. An open chain ends in
/// corners that bodies can hit from the side.
template <class S, int D>
class chain_geometry;
template <class S>
class chain_geometry<S, 2> {
public:
    /// No chain: what build() gives in builds without exceptions when it has refused.
    chain_geometry() = default;

    /// Refuses NaN and infinity, coordinates beyond 1e30 or a quarter of the range of S, fewer than 2 points (3 for a
    /// loop), and equal points next to each other. Cost: O(n log n), 0.5 us a point.
    [[nodiscard]] static chain_geometry build(const vec<S, 2>* points, std::uint32_t count,
                                              const chain_settings& settings = {}) {
        return chain_geometry(built(points, count, settings));
    }
    template <std::size_t N>
    [[nodiscard]] static chain_geometry build(const vec<S, 2> (&points)[N], const chain_settings& settings = {}) {
        return build(points, static_cast<std::uint32_t>(N), settings);
    }
    [[nodiscard]] static chain_geometry build(std::initializer_list<vec<S, 2>> points,
                                              const chain_settings& settings = {}) {
        return build(points.begin(), static_cast<std::uint32_t>(points.size()), settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] chain<S, 2> shape(S radius = S(0)) const { return {data(), radius}; }
    /// Segment i leads from point i to the next; contacts name it as their part.
    [[nodiscard]] std::uint32_t segment_count() const { return data()->segment_count(); }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::chain_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::chain_data<detail::hull_real<S>>;

    explicit chain_geometry(const block* built) : owner_(built) {}
    static const block* built(const vec<S, 2>* points, std::uint32_t count, const chain_settings& settings) {
        constexpr const char* f = "chain_geometry::build";
        buffer<vec<double, 2>> exact;
        if (!detail::take_points(f, "points", points, count, exact)) return nullptr;
        if (count < (settings.loop ? 3u : 2u)) {
            detail::refuse(f, "number of points", static_cast<double>(count),
                           settings.loop ? "a loop needs at least 3" : "a chain needs at least 2");
            return nullptr;
        }
        for (std::uint32_t i = 0; i < (settings.loop ? count : count - 1); ++i) {
            const std::uint32_t next = i + 1 < count ? i + 1 : 0;
            const vec<double, 2> way = exact[next] - exact[i];
            // Points so close that this underflows have no direction either.
            if (dot(way, way) > 0) continue;
            char field[40];
            std::snprintf(field, sizeof field, "points[%u].x", static_cast<unsigned>(next));
            detail::refuse(f, field, exact[next].x, "it must not be the same point as the one before");
            return nullptr;
        }
        return block::make(exact, {}, settings.loop, settings.two_sided);
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/compound_data.hpp
// =================================================================================================
// What a compound is in memory: children with their cores and places, and a tree over them.

PHYSICS_HPP_BEGIN

namespace detail {

/// What a compound needs to know of a shape whose type is forgotten.
template <int D>
struct solid_functions {
    bool (*check)(const void*, const char* function);
    detail::core<D> (*core)(const void*);
    /// With density 1.
    mass_properties<double, D> (*mass)(const void*);
    const geometry_block* (*geometry)(const void*);
    std::uint64_t (*digest)(const void*);
};
template <class Shape, int D>
inline constexpr solid_functions<D> solid_functions_of = {
    [](const void* s, const char* function) { return check(*static_cast<const Shape*>(s), function); },
    [](const void* s) { return core_of(*static_cast<const Shape*>(s)); },
    [](const void* s) -> mass_properties<double, D> {
        const auto exact = static_cast<const Shape*>(s)->template as<double>();
        if constexpr (requires { mass_of(exact, 1.0); }) return mass_of(exact, 1.0);
        else return {};
    },
    [](const void* s) -> const geometry_block* {
        if constexpr (refers_to_geometry<Shape>) return static_cast<const Shape*>(s)->geometry;
        else return static_cast<void>(s), nullptr;
    },
    [](const void* s) -> std::uint64_t {
        if constexpr (refers_to_geometry<Shape>) return static_cast<const Shape*>(s)->geometry->digest;
        else return static_cast<void>(s), 0;
    }};

/// The bytes of any shape.
struct solid_bytes {
    static constexpr std::size_t most = 64;
    alignas(8) unsigned char bytes[most] = {};
};
/// A shape and its place, before they become a child.
template <int D>
struct loose_solid {
    const solid_functions<D>* functions;
    solid_bytes shape;
    mat<double, D> axes;
    vec<double, D> at;
};

/// A child of a compound, as each_child() gives it.
template <int D>
struct placed_child {
    detail::core<D> shape;
    mat<double, D> axes;
    vec<double, D> at;
    std::uint32_t number;
};

/// Children in double for every scalar. It owns the geometry that they refer to.
template <int D>
struct compound_data : geometry_block {
    std::uint64_t digest;
    aabb<double, D> box;
    /// With density 1.
    mass_properties<double, D> mass;
    block_array<placed_child<D>> children;
    block_array<aabb<float, D>> boxes;
    block_array<solid_bytes> shapes;
    block_array<const geometry_block*> owned;
    part_tree<D> tree;

    /// The farthest point of child i along a direction of any length, radius included.
    [[nodiscard]] vec<double, D> farthest(std::uint32_t i, const vec<double, D>& d) const {
        const placed_child<D>& c = children[i];
        return c.axes * c.shape.support(transposed_times(c.axes, d)).at + c.at + normalized(d) * c.shape.radius;
    }
    /// A block with one owner: the caller.
    static const compound_data* make(const buffer<loose_solid<D>>& solids);
};

/// A mass as seen from where the frame of its shape stands.
inline mass_properties<double, 2> placed_mass(const mass_properties<double, 2>& m, const mat<double, 2>& axes,
                                              const vec<double, 2>& at) {
    return {m.mass, axes * m.center + at, m.inertia};
}
inline mass_properties<double, 3> placed_mass(const mass_properties<double, 3>& m, const mat<double, 3>& axes,
                                              const vec<double, 3>& at) {
    return {m.mass, axes * m.center + at, rotated(m.inertia, axes)};
}

template <int D>
const compound_data<D>* compound_data<D>::make(const buffer<loose_solid<D>>& solids) {
    const std::uint32_t count = solids.size();
    block_layout layout(sizeof(compound_data));
    const std::size_t at_children = layout.place<placed_child<D>>(count);
    const std::size_t at_boxes = layout.place<aabb<float, D>>(count);
    const std::size_t at_shapes = layout.place<solid_bytes>(count);
    const std::size_t at_owned = layout.place<const geometry_block*>(count);
    const auto at_tree = part_tree<D>::place(layout, count);
    auto* c = new_geometry<compound_data>(layout.bytes());
    c->gone = [](const geometry_block* block) {
        for (const geometry_block* held : static_cast<const compound_data*>(block)->owned) release(held);
    };
    c->digest = count;
    c->mass = {};
    c->children.attach(c, at_children, count);
    c->boxes.attach(c, at_boxes, count);
    c->shapes.attach(c, at_shapes, count);
    c->owned.attach(c, at_owned, count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const loose_solid<D>& s = solids[i];
        // Cores may refer to their shape.
        const void* const shape = new (&c->shapes[i]) solid_bytes(s.shape);
        const placed_child<D>& child =
            *new (&c->children[i]) placed_child<D>{s.functions->core(shape), s.axes, s.at, i};
        c->owned[i] = s.functions->geometry(shape);
        retain(c->owned[i]);
        c->mass = combined(c->mass, placed_mass(s.functions->mass(shape), s.axes, s.at));
        aabb<double, D> around;
        for (int k = 0; k < D; ++k) {
            vec<double, D> along;
            along[k] = 1;
            around.upper[k] = c->farthest(i, along)[k];
            around.lower[k] = c->farthest(i, -along)[k];
        }
        c->box = i == 0 ? around : merged(c->box, around);
        c->boxes[i] = outward_floats(around);
        mix_digest(c->digest, static_cast<std::uint64_t>(child.shape.kind));
        mix_digest(c->digest, s.functions->digest(shape));
        mix_digest(c->digest, scalar_traits<double>::bits(child.shape.radius));
        for (const vec<double, D>& p : child.shape.corner) mix_digest(c->digest, p);
        for (const vec<double, D>& p : s.axes.column) mix_digest(c->digest, p);
        for (const vec<double, D>& p : {s.at, around.lower, around.upper}) mix_digest(c->digest, p);
    }
    c->tree.build(c, at_tree, c->boxes.begin(), count);
    return c;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/compound.hpp
// =================================================================================================
// The compound: several convex shapes as one, such as a table.

PHYSICS_HPP_BEGIN

/// Convex shapes, the children, each at a place of its own in the shape's frame. A compound_geometry or a world keeps
/// them: as long as one of them does, the shape is good.
template <class S, int D>
struct compound {
    using scalar = S;
    const detail::compound_data<D>* geometry = nullptr;

    template <class T>
    [[nodiscard]] constexpr compound<T, D> as() const {
        return {geometry};
    }
};

/// It meets other shapes child by child: there is no convex core for all.
template <class S, int D>
detail::core<D> core_of(const compound<S, D>&) = delete;

template <class S, int D>
bool check(const compound<S, D>& c, const char* function) {
    return c.geometry != nullptr ||
           detail::refuse(function, "geometry", "null", "it must be the shape of a compound_geometry that was built");
}
/// Tight up to 64 children; around 32 to 64 boxes of the tree where there are more.
template <class S, int D>
aabb<S, D> bounds(const compound<S, D>& c, const transform<S, D>& at) {
    const auto& g = *c.geometry;
    detail::turned_bounds<S, D> around(at);
    if (g.children.size() > detail::points_to_bound) {
        g.tree.cover([&](const aabb<float, D>& box) { around.add(box); });
        return around.box(S(0), g.box);
    }
    const mat<double, D> rows = transposed(detail::to_matrix(at.rotation));
    for (std::uint32_t i = 0; i < g.children.size(); ++i)
        for (int k = 0; k < D; ++k) {
            around.add(g.farthest(i, rows.column[k]));
            around.add(g.farthest(i, -rows.column[k]));
        }
    return around.box(S(0), g.box);
}
/// The farthest point of all children; of those at the same distance the first one's. Cost: O(children).
template <class S, int D>
vec<S, D> support(const compound<S, D>& c, vec<S, D> direction) {
    const vec<double, D> d = detail::to_point(direction);
    vec<double, D> best = c.geometry->farthest(0, d);
    for (std::uint32_t i = 1; i < c.geometry->children.size(); ++i) {
        const vec<double, D> p = c.geometry->farthest(i, d);
        if (dot(d, p) > dot(d, best)) best = p;
    }
    return detail::from_point<S>(best);
}
/// The sum over all children, each of that density: what they share counts as often as they share it. Calculated in
/// double when the geometry is built.
template <class S, int D>
mass_properties<S, D> mass_of(const compound<S, D>& c, std::type_identity_t<S> density) {
    const double d = static_cast<double>(density);
    const mass_properties<double, D>& m = c.geometry->mass;
    mass_properties<S, D> result{S(m.mass * d), detail::from_point<S>(m.center), {}};
    if constexpr (D == 2) {
        result.inertia = S(m.inertia * d);
    } else {
        const symmetric<double> i = m.inertia * d;
        result.inertia = {S(i.xx), S(i.yy), S(i.zz), S(i.xy), S(i.xz), S(i.yz)};
    }
    return result;
}
/// For the narrowphase: calls f with the children that may reach into a box of the shape's frame.
template <class S, int D, class F>
void each_child(const compound<S, D>& c, const aabb<double, D>& box, F&& f) {
    const auto& g = *c.geometry;
    const aabb<float, D> wanted = detail::outward_floats(box);
    g.tree.visit(box, [&](std::uint32_t i) {
        if (overlap(g.boxes[i], wanted)) f(g.children[i]);
    });
}
/// For rays: calls f with the children that a segment may meet; f returns up to which part of it the search goes on.
template <class S, int D, class F>
void each_child_along(const compound<S, D>& c, const detail::box_ray<D>& ray, F&& f) {
    const auto& g = *c.geometry;
    double most = 1;
    g.tree.visit(ray, [&](std::uint32_t i) {
        if (ray.meets(g.boxes[i], most)) most = f(g.children[i]);
        return most;
    });
}

/// A child of a compound to be: any convex shape of up to 64 bytes, where its frame stands in the compound's (m), and
/// how it is turned. The rotation must be one, as for bodies.
template <class S, int D>
class compound_child {
public:
    template <class Shape>
        requires detail::has_core<Shape>
    compound_child(const Shape& shape, vec<S, D> position = {}, const rotation<S, D>& turned = {})
        : position_(position), rotation_(turned) {
        static_assert(sizeof(Shape) <= detail::solid_bytes::most && alignof(Shape) <= alignof(detail::solid_bytes),
                      "physics::compound_child: the shape is larger than 64 bytes");
        solid_.functions = &detail::solid_functions_of<Shape, D>;
        new (static_cast<void*>(solid_.shape.bytes)) Shape(shape);
    }

private:
    template <class, int>
    friend class compound_geometry;

    detail::loose_solid<D> solid_{};
    vec<S, D> position_;
    rotation<S, D> rotation_;
};

/// Convex shapes as one, built once and shared by all compounds made of it, and by worlds that hold such.
///
///     const auto hammer = physics::compound_geometry<float, 2>::build({
///         {physics::box<float, 2>{{0.05f, 0.5f}}}, {physics::box<float, 2>{{0.3f, 0.1f}}, {0, 0.6f}}});
///     world.create_shape(body, hammer.shape());
///
/// Bodies with few shapes need no compound: each may have its own material there. A compound is one shape for the
/// broadphase, and finds its children by a tree. It keeps the hulls of its children.
template <class S, int D>
class compound_geometry {
public:
    /// No compound: what build() gives in builds without exceptions when it has refused.
    compound_geometry() = default;

    /// Refuses what the shapes themselves do, naming the child, places that are not finite or too far out for S, and no
    /// children at all. Contacts name children by their order. Cost: O(n log n), 1 us a child, 0.3 KB each.
    [[nodiscard]] static compound_geometry build(const compound_child<S, D>* children, std::uint32_t count) {
        return compound_geometry(built(children, count));
    }
    [[nodiscard]] static compound_geometry build(std::initializer_list<compound_child<S, D>> children) {
        return build(children.begin(), static_cast<std::uint32_t>(children.size()));
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape. It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] compound<S, D> shape() const { return {data()}; }
    [[nodiscard]] std::uint32_t child_count() const { return data()->children.size(); }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::compound_data<D>* data() const { return owner_.get(); }

private:
    explicit compound_geometry(const detail::compound_data<D>* built) : owner_(built) {}
    static const detail::compound_data<D>* built(const compound_child<S, D>* children, std::uint32_t count) {
        constexpr const char* f = "compound_geometry::build";
        if (count == 0) {
            detail::refuse(f, "number of children", 0.0, "a compound needs at least 1");
            return nullptr;
        }
        buffer<detail::loose_solid<D>> solids;
        solids.reserve(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const compound_child<S, D>& child = children[i];
            char name[64];
            std::snprintf(name, sizeof name, "%s: child %u", f, static_cast<unsigned>(i));
            if (!child.solid_.functions->check(child.solid_.shape.bytes, name) ||
                !detail::check_finite(name, "position", child.position_) || !check_rotation(name, child.rotation_))
                return nullptr;
            detail::loose_solid<D>& s = solids.push(child.solid_);
            s.axes = detail::to_matrix(child.rotation_);
            s.at = detail::to_point(child.position_);
            if (!detail::check_reach<S>(name, largest(s.at))) return nullptr;
        }
        return detail::compound_data<D>::make(solids);
    }
    static bool check_rotation(const char* function, const rotation<S, 2>& r) {
        const double c = static_cast<double>(r.cosine), s = static_cast<double>(r.sine);
        return check_length(function, c * c + s * s);
    }
    static bool check_rotation(const char* function, const rotation<S, 3>& r) {
        const double x = static_cast<double>(r.x), y = static_cast<double>(r.y), z = static_cast<double>(r.z),
                     w = static_cast<double>(r.w);
        return check_length(function, (x * x + y * y) + (z * z + w * w));
    }
    static bool check_length(const char* function, double squared) {
        return abs(squared - 1) < 1e-3 || detail::refuse(function, "squared length of rotation", squared,
                                                         "it must be 1, to less than 0.001");
    }

    detail::geometry_owner<detail::compound_data<D>> owner_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/solid_moments.hpp
// =================================================================================================
// Volume, centroid and second moments of solids that are put together of pieces.

PHYSICS_HPP_BEGIN

namespace detail {

/// The integrals of 1, p and p p^T over a solid, with p from a place near it, summed in double over its pieces. In the
/// plane z is 0, and integrals are over the plane.
struct solid_moments {
    double volume = 0;
    vec<double, 3> first;
    symmetric<double> second;

    /// Adds a piece of so much volume at a place, whose p and p p^T from that place sum up to `sum` and `squares`.
    void add(double size, const vec<double, 3>& at, const vec<double, 3>& sum, const symmetric<double>& squares) {
        volume += size;
        first += at * size + sum;
        second = second + square_of(at) * size + both_products(at, sum) + squares;
    }
    /// By density; `origin` is where p begins. None if there is no volume.
    template <class T, int D>
    [[nodiscard]] mass_properties<T, D> mass(const vec<double, 3>& origin, T density) const {
        if (!(volume > 0)) return {};
        const double d = static_cast<double>(density);
        const vec<double, 3> shift = first / volume, c = origin + shift;
        const symmetric<double> m = (second + square_of(shift) * -volume) * d;
        if constexpr (D == 2)
            return {T(d * volume), {T(c.x), T(c.y)}, T(m.xx + m.yy)};
        else
            return {T(d * volume),
                    {T(c.x), T(c.y), T(c.z)},
                    {T(m.yy + m.zz), T(m.xx + m.zz), T(m.xx + m.yy), T(-m.xy), T(-m.xz), T(-m.yz)}};
    }
};

/// A point of a shape in double, in space.
template <class S, int D>
vec<double, 3> exact_in_space(const vec<S, D>& v) {
    vec<double, 3> p;
    for (int i = 0; i < D; ++i) p[i] = static_cast<double>(v[i]);
    return p;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/discs.hpp
// =================================================================================================
// Two coaxial discs and all between them, rounded or not: what cylinders and cones are.

PHYSICS_HPP_BEGIN

namespace detail {

/// Discs of the radii low and high at -half and half on the x axis, and all within `rounding` of what is between.
template <class S>
struct discs {
    S half, low, high, rounding;
};

template <class S>
constexpr aabb<S, 3> bounds_of(const discs<S>& d, const transform<S, 3>& at) {
    const mat<S, 3> m = matrix(at.rotation);
    aabb<S, 3> box;
    for (int i = 0; i < 3; ++i) {
        // How far a disc of radius 1 reaches. Of the axis alone, 1 - x * x would lose half of the digits.
        const S across = length(vec<S, 2>{m.column[1][i], m.column[2][i]}), along = m.column[0][i] * d.half;
        const S at_low = across * d.low, at_high = across * d.high;
        box.lower[i] = min(-along - at_low, along - at_high) - d.rounding;
        box.upper[i] = max(-along + at_low, along + at_high) + d.rounding;
    }
    return {at.position + box.lower, at.position + box.upper};
}
template <class S>
constexpr vec<S, 3> support_of(const discs<S>& d, vec<S, 3> direction) {
    const vec<S, 3> n = normalized(direction);
    const auto [aside, across] = split(vec<S, 2>{n.y, n.z});
    const bool upper = !(n.x * (d.half + d.half) < across * (d.low - d.high));
    const S r = upper ? d.high : d.low;
    return vec<S, 3>{upper ? d.half : -d.half, aside.x * r, aside.y * r} + n * d.rounding;
}
/// Exact; calculated in double. Slices across the axis, whose radius is a line between two arcs.
template <class S>
mass_properties<S, 3> mass_of_discs(const discs<S>& d, S density) {
    const double half = static_cast<double>(d.half), low = static_cast<double>(d.low),
                 high = static_cast<double>(d.high), r = static_cast<double>(d.rounding);
    // Integrals over x of R^2, x R^2, x^2 R^2 and R^4 for the radius R of the slice at x.
    double area = 0, first = 0, along = 0, fourth = 0;
    const double slope = low - high, side = sqrt(4 * half * half + slope * slope);
    const double sine = slope / side, cosine = 2 * half / side;
    {
        // The side: polynomials up to the fourth degree, exact by three points of Gauss.
        const double begin = low + r * cosine, end = high + r * cosine;
        constexpr double gauss[3][2] = {{-0.77459666924148338, 5.0 / 9}, {0, 8.0 / 9}, {0.77459666924148338, 5.0 / 9}};
        for (const auto& g : gauss) {
            const double x = r * sine + half * g[0], radius = 0.5 * (begin + end) + 0.5 * (end - begin) * g[0];
            const double rr = radius * radius, weight = half * g[1];
            area += weight * rr;
            first += weight * x * rr;
            along += weight * x * x * rr;
            fourth += weight * rr * rr;
        }
    }
    // An arc about (x, q): slices at x + r * sin, of the radius q + r * cos, between two angles that differ by `angle`.
    const auto arc = [&](double x, double q, double angle, double s0, double c0, double s1, double c1) {
        // The integrals of cos^k, and of sin cos^k and sin^2 cos^k.
        double powers[8] = {angle, s1 - s0}, odd[5] = {0, 0.5 * (c0 * c0 - c1 * c1)}, p0 = c0, p1 = c1;
        for (int k = 2; k < 8; ++k) {
            powers[k] = (p1 * s1 - p0 * s0) / k + powers[k - 2] * (k - 1) / k;
            p0 *= c0;
            p1 *= c1;
            if (k < 5) odd[k] = (p0 * c0 - p1 * c1) / (k + 1);
        }
        const double square[3] = {q * q * r, 2 * q * r * r, r * r * r};
        for (int k = 0; k < 3; ++k) {
            const double even = powers[k + 1] - powers[k + 3];
            area += square[k] * powers[k + 1];
            first += square[k] * (x * powers[k + 1] + r * odd[k + 1]);
            along += square[k] * (x * x * powers[k + 1] + 2 * x * r * odd[k + 1] + r * r * even);
        }
        const double qq = q * q, rr = r * r;
        const double quartic[5] = {qq * qq, 4 * qq * q * r, 6 * qq * rr, 4 * q * r * rr, rr * rr};
        for (int k = 0; k < 5; ++k) fourth += r * quartic[k] * powers[k + 1];
    };
    if (r > 0) {
        const double angle = atan2(slope, 2 * half), quarter = 0.5 * pi<double>;
        arc(-half, low, angle + quarter, -1, 0, sine, cosine);
        arc(half, high, quarter - angle, sine, cosine, 1, 0);
    }
    const double across = 0.25 * pi<double> * fourth;
    solid_moments m;
    m.add(pi<double> * area, {}, vec<double, 3>{pi<double> * first, 0.0, 0.0},
          symmetric<double>::diagonal(pi<double> * along, across, across));
    return m.template mass<S, 3>({}, density);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/cone.hpp
// =================================================================================================
// The cone, pointed or cut off: two discs of different radii on an axis and all between them.

PHYSICS_HPP_BEGIN

/// All points within rounding (m, 0 or more) of the cone about the x axis of the shape's frame, with the lower radius
/// (m) at -half_length (m) and the upper one at half_length: a frustum, or a pointed cone where one of the radii is 0.
/// The frame's origin is the middle of the axis, not the centre of mass: a pointed cone's lies a quarter of the height
/// from its base. In 3D only: in 2D it is a polygon.
template <class S, int D>
struct cone;

template <class S>
struct cone<S, 3> {
    using scalar = S;
    S half_length = S(0.5);
    S lower_radius = S(0.5);
    S upper_radius{};
    S rounding{};

    template <class T>
    [[nodiscard]] constexpr cone<T, 3> as() const {
        return {static_cast<T>(half_length), static_cast<T>(lower_radius), static_cast<T>(upper_radius),
                static_cast<T>(rounding)};
    }
};

namespace detail {
template <class S>
constexpr discs<S> discs_of(const cone<S, 3>& c) {
    return {c.half_length, c.lower_radius, c.upper_radius, c.rounding};
}
}  // namespace detail

template <class S>
bool check(const cone<S, 3>& c, const char* function) {
    if (!detail::check_positive(function, "half_length", c.half_length) ||
        !detail::check_not_negative(function, "lower_radius", c.lower_radius) ||
        !detail::check_not_negative(function, "upper_radius", c.upper_radius) ||
        !detail::check_not_negative(function, "rounding", c.rounding))
        return false;
    return c.lower_radius > S(0) || c.upper_radius > S(0) ||
           detail::refuse(function, "upper_radius", 0.0, "one of the radii must be greater than 0");
}
template <class S>
constexpr aabb<S, 3> bounds(const cone<S, 3>& c, const transform<S, 3>& at) {
    return detail::bounds_of(detail::discs_of(c), at);
}
template <class S>
constexpr vec<S, 3> support(const cone<S, 3>& c, vec<S, 3> direction) {
    return detail::support_of(detail::discs_of(c), direction);
}
/// Exact, rounding included; calculated in double.
template <class S>
mass_properties<S, 3> mass_of(const cone<S, 3>& c, std::type_identity_t<S> density) {
    return detail::mass_of_discs(detail::discs_of(c), density);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/cylinder.hpp
// =================================================================================================
// The cylinder: two discs on an axis and all between them.

PHYSICS_HPP_BEGIN

/// All points within rounding (m, 0 or more) of the cylinder about the x axis of the shape's frame, from -half_length
/// to half_length (m), with that radius (m). With rounding it reaches beyond both by as much. In 3D only: in 2D it is
/// a box.
template <class S, int D>
struct cylinder;

template <class S>
struct cylinder<S, 3> {
    using scalar = S;
    S half_length = S(0.5);
    S radius = S(0.5);
    S rounding{};

    template <class T>
    [[nodiscard]] constexpr cylinder<T, 3> as() const {
        return {static_cast<T>(half_length), static_cast<T>(radius), static_cast<T>(rounding)};
    }
};

namespace detail {
template <class S>
constexpr discs<S> discs_of(const cylinder<S, 3>& c) {
    return {c.half_length, c.radius, c.radius, c.rounding};
}
}  // namespace detail

template <class S>
bool check(const cylinder<S, 3>& c, const char* function) {
    return detail::check_positive(function, "half_length", c.half_length) &&
           detail::check_positive(function, "radius", c.radius) &&
           detail::check_not_negative(function, "rounding", c.rounding);
}
template <class S>
constexpr aabb<S, 3> bounds(const cylinder<S, 3>& c, const transform<S, 3>& at) {
    return detail::bounds_of(detail::discs_of(c), at);
}
template <class S>
constexpr vec<S, 3> support(const cylinder<S, 3>& c, vec<S, 3> direction) {
    return detail::support_of(detail::discs_of(c), direction);
}
/// Exact, rounding included; calculated in double.
template <class S>
mass_properties<S, 3> mass_of(const cylinder<S, 3>& c, std::type_identity_t<S> density) {
    return detail::mass_of_discs(detail::discs_of(c), density);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/heightfield_data.hpp
// =================================================================================================
// What a heightfield is in memory: its heights, row by row; parts and their neighbours follow by arithmetic.

PHYSICS_HPP_BEGIN

namespace detail {

/// Heights in R above a regular grid; in the plane it has one row.
template <class R, int D>
struct heightfield_data : geometry_block {
    std::uint32_t columns, rows;
    bool alternating, two_sided;
    /// The distance of columns and of rows (m).
    double step_x, step_z;
    std::uint64_t digest;
    aabb<double, D> box;
    block_array<R> heights;
    /// A bit for each cell; none where no cell is a hole.
    block_array<std::uint32_t> holes;
    /// At most 64 boxes around all.
    block_array<aabb<float, D>> cover;

    [[nodiscard]] std::uint32_t cells_x() const { return columns - 1; }
    [[nodiscard]] std::uint32_t cells_z() const { return D == 2 ? 1 : rows - 1; }
    /// Whether there is a surface in a cell; numbers that have wrapped below 0 are beyond the edge.
    [[nodiscard]] bool solid(std::uint32_t x, std::uint32_t z) const {
        if (x >= cells_x() || z >= cells_z()) return false;
        const std::uint32_t i = z * cells_x() + x;
        return holes.size() == 0 || (holes[i >> 5] >> (i & 31) & 1u) == 0;
    }
    [[nodiscard]] double height(std::uint32_t x, std::uint32_t z) const {
        return static_cast<double>(heights[z * columns + x]);
    }
    [[nodiscard]] vec<double, D> sample(std::uint32_t x, std::uint32_t z) const {
        vec<double, D> p;
        p.x = x * step_x;
        p.y = height(x, z);
        if constexpr (D == 3) p.z = z * step_z;
        return p;
    }

    /// A block with one owner: the caller. Holes are null or a byte for each cell, other than 0 where there is one.
    static const heightfield_data* make(const R* heights, std::uint32_t columns, std::uint32_t rows, double step_x,
                                        double step_z, const std::uint8_t* holes, bool alternating, bool two_sided);
};

/// The normal of cell x.
template <class R>
vec<double, 2> cell_normal(const heightfield_data<R, 2>& h, std::uint32_t x) {
    return normalized(vec<double, 2>{h.height(x, 0) - h.height(x + 1, 0), h.step_x});
}
template <class R>
aabb<double, 2> cell_box(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t) {
    const vec<double, 2> a = h.sample(x, 0), b = h.sample(x + 1, 0);
    return {min(a, b), max(a, b)};
}
/// What a ray needs to know of part x.
template <class R>
surface_face<2> cell_face(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t, int) {
    return {{h.sample(x + 1, 0), h.sample(x, 0)}, h.two_sided};
}
/// Calls f with part x, which leads from sample x + 1 back to sample x: the solid is below.
template <class R, class F>
void cell_parts(const heightfield_data<R, 2>& h, std::uint32_t x, std::uint32_t, F&& f) {
    surface_part<2> p;
    p.corner[0] = h.sample(x + 1, 0);
    p.corner[1] = h.sample(x, 0);
    p.normal = cell_normal(h, x);
    for (int i = 0; i < 2; ++i) {
        const std::uint32_t other = i == 0 ? x + 1 : x - 1;
        p.continues[i] = h.solid(other, 0);
        if (p.continues[i]) p.beyond[i] = cell_normal(h, other);
    }
    p.two_sided = h.two_sided;
    p.number = x;
    f(p);
}

/// The normal of triangle k of a cell. The first triangle holds the cell's side at the lower x, the second the opposite
/// one; by the diagonal from the first corner to the last, or by the other.
template <class R>
vec<double, 3> cell_normal(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, int k) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    // The side along x that the triangle holds, and the one along z.
    const std::uint32_t far_z = (k == 0) != other ? z + 1 : z, far_x = k == 0 ? x : x + 1;
    const double rise_x = h.height(x + 1, far_z) - h.height(x, far_z);
    const double rise_z = h.height(far_x, z + 1) - h.height(far_x, z);
    return normalized(vec<double, 3>{-rise_x * h.step_z, h.step_x * h.step_z, -rise_z * h.step_x});
}
template <class R>
aabb<double, 3> cell_box(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z) {
    const vec<double, 3> a = h.sample(x, z), b = h.sample(x + 1, z), c = h.sample(x, z + 1), d = h.sample(x + 1, z + 1);
    return {min(min(a, b), min(c, d)), max(max(a, b), max(c, d))};
}
/// The corners of the triangles of a cell, without and with the other diagonal. They count along x, then along z.
inline constexpr std::uint8_t cell_corners[2][2][3] = {{{0, 2, 3}, {0, 3, 1}}, {{0, 2, 1}, {1, 2, 3}}};
/// What a ray needs to know of triangle k of a cell.
template <class R>
surface_face<3> cell_face(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, int k) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    surface_face<3> face{{}, h.two_sided};
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t corner = cell_corners[other][k][i];
        face.corner[i] = h.sample(x + (corner & 1), z + (corner >> 1));
    }
    return face;
}
template <class R, class F>
void cell_parts(const heightfield_data<R, 3>& h, std::uint32_t x, std::uint32_t z, F&& f) {
    const bool other = h.alternating && ((x + z) & 1u) != 0;
    // Those at the lower x, upper z, upper x, lower z; 4 the diagonal.
    static constexpr std::uint8_t sides[2][2][3] = {{{0, 1, 4}, {4, 2, 3}}, {{0, 4, 3}, {4, 1, 2}}};
    for (int k = 0; k < 2; ++k) {
        surface_part<3> p;
        p.normal = cell_normal(h, x, z, k);
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t corner = cell_corners[other][k][i];
            p.corner[i] = h.sample(x + (corner & 1), z + (corner >> 1));
            const int side = sides[other][k][i];
            const std::uint32_t u = side == 0 ? x - 1 : side == 2 ? x + 1 : x;
            const std::uint32_t v = side == 1 ? z + 1 : side == 3 ? z - 1 : z;
            p.continues[i] = h.solid(u, v);
            if (!p.continues[i]) continue;
            const bool other_there = h.alternating && ((u + v) & 1u) != 0;
            // Of the cell there the triangle that holds the opposite side.
            const int there = side == 4 ? 1 - k
                              : side == 0 ? 1
                              : side == 2 ? 0
                              : (side == 1) != other_there ? 1 : 0;
            p.beyond[i] = cell_normal(h, u, v, there);
        }
        p.two_sided = h.two_sided;
        p.number = 2 * (z * h.cells_x() + x) + static_cast<std::uint32_t>(k);
        f(p);
    }
}

/// The cells from `first` to before `last` that an interval may touch.
struct cells_between {
    std::uint32_t first, last;

    cells_between(double low, double high, double step, std::uint32_t cells) {
        const double from = low / step - 1e-9, to = high / step + 1e-9;
        first = from < 0 ? 0 : from < cells ? static_cast<std::uint32_t>(from) : cells;
        last = to < 0 ? 0 : to < cells ? static_cast<std::uint32_t>(to) + 1 : cells;
    }
};

template <class R, int D>
const heightfield_data<R, D>* heightfield_data<R, D>::make(const R* heights, std::uint32_t columns, std::uint32_t rows,
                                                           double step_x, double step_z, const std::uint8_t* holes,
                                                           bool alternating, bool two_sided) {
    const std::uint32_t cells = (columns - 1) * (D == 2 ? 1 : rows - 1);
    const auto groups = [](std::uint32_t n) { return n < 8 ? n : 8u; };
    const std::uint32_t along_x = D == 2 ? (columns - 1 < 64 ? columns - 1 : 64) : groups(columns - 1);
    const std::uint32_t along_z = D == 2 ? 1 : groups(rows - 1);
    block_layout layout(sizeof(heightfield_data));
    const std::size_t at_heights = layout.place<R>(std::size_t{columns} * rows);
    const std::uint32_t words = holes == nullptr ? 0 : (cells + 31) / 32;
    const std::size_t at_holes = layout.place<std::uint32_t>(words);
    const std::size_t at_cover = layout.place<aabb<float, D>>(along_x * along_z);
    auto* h = new_geometry<heightfield_data>(layout.bytes());
    h->columns = columns;
    h->rows = rows;
    h->alternating = alternating;
    h->two_sided = two_sided;
    h->step_x = step_x;
    h->step_z = step_z;
    h->heights.attach(h, at_heights, columns * rows);
    h->holes.attach(h, at_holes, words);
    h->cover.attach(h, at_cover, along_x * along_z);
    h->digest = std::uint64_t{columns} << 32 | rows;
    mix_digest(h->digest, std::uint64_t{alternating} << 1 | std::uint64_t{two_sided});
    mix_digest(h->digest, scalar_traits<double>::bits(step_x));
    mix_digest(h->digest, scalar_traits<double>::bits(step_z));
    for (std::uint32_t i = 0; i < columns * rows; ++i) {
        h->heights[i] = heights[i];
        mix_digest(h->digest, scalar_traits<double>::bits(static_cast<double>(heights[i])));
    }
    for (std::uint32_t i = 0; i < (words > 0 ? cells : 0); ++i)
        if (holes[i] != 0) h->holes[i >> 5] |= 1u << (i & 31);
    for (const std::uint32_t word : h->holes) mix_digest(h->digest, word);
    for (std::uint32_t v = 0; v < along_z; ++v)
        for (std::uint32_t u = 0; u < along_x; ++u) {
            const auto part = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) {
                return static_cast<std::uint32_t>(std::uint64_t{i} * n / of);
            };
            const std::uint32_t x = part(u, columns - 1, along_x), z = part(v, rows - 1, along_z);
            aabb<double, D> around{h->sample(x, z), h->sample(x, z)};
            for (std::uint32_t j = z; j <= part(v + 1, rows - 1, along_z); ++j)
                for (std::uint32_t i = x; i <= part(u + 1, columns - 1, along_x); ++i)
                    around = {min(around.lower, h->sample(i, j)), max(around.upper, h->sample(i, j))};
            h->cover[v * along_x + u] = outward_floats(around);
            h->box = u + v == 0 ? around : merged(h->box, around);
        }
    return h;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/heightfield.hpp
// =================================================================================================
// The heightfield: a surface by its heights above a regular grid, such as a landscape.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of a surface that has one height y for each x (and z) of the shape's frame.
/// It has no mass, so it serves static and kinematic bodies. A heightfield_geometry or a world keeps the heights: as
/// long as one of them does, the shape is good.
template <class S, int D>
struct heightfield {
    using scalar = S;
    const detail::heightfield_data<detail::hull_real<S>, D>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return heightfield<T, D>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, heightfield>{*this};
    }
};

template <class S, int D>
bool check(const heightfield<S, D>& h, const char* function) {
    return detail::check_surface(h, "it must be the shape of a heightfield_geometry that was built", function);
}
/// Tight up to 64 samples; around at most 64 boxes where there are more. Holes count.
template <class S, int D>
aabb<S, D> bounds(const heightfield<S, D>& h, const transform<S, D>& at) {
    const auto& g = *h.geometry;
    detail::turned_bounds<S, D> around(at);
    if (g.heights.size() <= detail::points_to_bound) {
        for (std::uint32_t z = 0; z < g.rows; ++z)
            for (std::uint32_t x = 0; x < g.columns; ++x) around.add(g.sample(x, z));
    } else {
        for (const aabb<float, D>& box : g.cover) around.add(box);
    }
    return around.box(h.radius, g.box);
}
/// For the narrowphase: calls f with the segments or triangles that may reach into a box of the shape's frame. Cost:
/// O(cells above or below the box).
template <class S, int D, class F>
void each_part(const heightfield<S, D>& h, const aabb<double, D>& box, F&& f) {
    const auto& g = *h.geometry;
    if (!overlap(g.box, box)) return;
    const detail::cells_between along_x(box.lower.x, box.upper.x, g.step_x, g.cells_x());
    detail::cells_between along_z(0, 0, 1, 1);
    if constexpr (D == 3) along_z = detail::cells_between(box.lower.z, box.upper.z, g.step_z, g.cells_z());
    for (std::uint32_t z = along_z.first; z < along_z.last; ++z)
        for (std::uint32_t x = along_x.first; x < along_x.last; ++x) {
            double low = min(g.height(x, z), g.height(x + 1, z)), high = max(g.height(x, z), g.height(x + 1, z));
            if constexpr (D == 3) {
                low = min(low, min(g.height(x, z + 1), g.height(x + 1, z + 1)));
                high = max(high, max(g.height(x, z + 1), g.height(x + 1, z + 1)));
            }
            if (low > box.upper.y || high < box.lower.y || !g.solid(x, z)) continue;
            detail::cell_parts(g, x, z, f);
        }
}
/// For rays: calls f with the parts that a segment may meet; f returns up to which part of it the search goes on. Cost:
/// O(cells above or below it, and rows between its ends).
template <class S, int D, class F>
void each_part_along(const heightfield<S, D>& h, const detail::box_ray<D>& ray, F&& f) {
    const auto& g = *h.geometry;
    aabb<double, D> around = ray.bounds();
    double most = 1;
    if (!overlap(g.box, around)) return;
    detail::cells_between along_z(0, 0, 1, 1);
    if constexpr (D == 3) along_z = detail::cells_between(around.lower.z, around.upper.z, g.step_z, g.cells_z());
    for (std::uint32_t z = along_z.first; z < along_z.last; ++z) {
        if (D == 3 && !ray.bounds_between(D - 1, z * g.step_z, (z + 1) * g.step_z, around)) continue;
        const detail::cells_between along_x(around.lower.x, around.upper.x, g.step_x, g.cells_x());
        for (std::uint32_t x = along_x.first; x < along_x.last; ++x) {
            if (!ray.meets(cell_box(g, x, z), most) || !g.solid(x, z)) continue;
            for (int k = 0; k < D - 1; ++k) most = f(cell_face(g, x, z, k));
        }
    }
}

/// What a heightfield is like besides its heights.
struct heightfield_settings {
    /// Null, or one byte for each cell between samples, row by row: cells with a byte other than 0 are holes.
    const std::uint8_t* holes = nullptr;
    /// In space cells are cut along the diagonal from the sample with the lowest x and z to that with the highest; if
    /// this is true, every second one along the other, as on a chessboard.
    bool alternating = false;
    /// Bodies are stopped from below too.
    bool two_sided = false;
};

/// Heights above a regular grid, built once and shared by all heightfields made of it, and by worlds that hold such:
/// one number a sample, found by arithmetic. Bodies glide from cell to cell without a bump. The first sample is at
/// x = 0 (and z = 0) of the shape's frame; y is up. Contacts name cells by their number, of triangles twice that and 1
/// more for the one at the higher x.
///
/// A body whose centre is below the surface passes through it, unless it is two-sided: a surface is no volume.
template <class S, int D>
class heightfield_geometry {
public:
    /// No heightfield: what build() gives in builds without exceptions when it has refused.
    heightfield_geometry() = default;

    /// In the plane: heights (m) from left to right, spacing (m) apart. Refuses NaN and infinity, fewer than 2 samples,
    /// a spacing that is not greater than 0, and coordinates beyond 1e30 or a quarter of the range of S. O(n).
    [[nodiscard]] static heightfield_geometry build(const S* heights, std::uint32_t count, S spacing,
                                                    const heightfield_settings& settings = {})
        requires(D == 2)
    {
        return heightfield_geometry(built(heights, count, 1, spacing, S(1), settings));
    }
    [[nodiscard]] static heightfield_geometry build(std::initializer_list<S> heights, S spacing,
                                                    const heightfield_settings& settings = {})
        requires(D == 2)
    {
        return heightfield_geometry(
            built(heights.begin(), static_cast<std::uint32_t>(heights.size()), 1, spacing, S(1), settings));
    }
    /// In space: heights[row * columns + column] (m), columns spacing_x apart along x, rows spacing_z along z. Refuses
    /// what the other does, fewer than 2 columns or rows, and more than 2^31 samples. O(n).
    [[nodiscard]] static heightfield_geometry build(const S* heights, std::uint32_t columns, std::uint32_t rows,
                                                    S spacing_x, S spacing_z, const heightfield_settings& settings = {})
        requires(D == 3)
    {
        return heightfield_geometry(built(heights, columns, rows, spacing_x, spacing_z, settings));
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] heightfield<S, D> shape(S radius = S(0)) const { return {data(), radius}; }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::heightfield_data<detail::hull_real<S>, D>* data() const { return owner_.get(); }

private:
    using real = detail::hull_real<S>;
    using block = detail::heightfield_data<real, D>;

    explicit heightfield_geometry(const block* built) : owner_(built) {}
    static const block* built(const S* heights, std::uint32_t columns, std::uint32_t rows, S spacing_x, S spacing_z,
                              const heightfield_settings& settings) {
        constexpr const char* f = "heightfield_geometry::build";
        const std::uint64_t samples = std::uint64_t{columns} * rows;
        if (!at_least_2(f, D == 2 ? "number of samples" : "columns", columns) ||
            (D == 3 && !at_least_2(f, "rows", rows)) ||
            !detail::check_spacing(f, D == 2 ? "spacing" : "spacing_x", spacing_x) ||
            !detail::check_spacing(f, "spacing_z", spacing_z))
            return nullptr;
        if (samples > 0x80000000u) {
            detail::refuse(f, "number of samples", static_cast<double>(samples), "it must be at most 2^31");
            return nullptr;
        }
        const auto n = static_cast<std::uint32_t>(samples);
        double reach = max(static_cast<double>(spacing_x) * (columns - 1), static_cast<double>(spacing_z) * (rows - 1));
        buffer<real> taken;
        taken.reserve(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            if (!detail::check_item(f, "heights", i, heights[i])) return nullptr;
            const double height = static_cast<double>(heights[i]);
            taken.push(static_cast<real>(height));
            reach = max(reach, abs(height));
        }
        if (!detail::check_reach<S>(f, reach)) return nullptr;
        return block::make(taken.begin(), columns, rows, static_cast<double>(spacing_x), static_cast<double>(spacing_z),
                           settings.holes, settings.alternating, settings.two_sided);
    }
    static bool at_least_2(const char* function, const char* field, std::uint32_t n) {
        return n >= 2 || detail::refuse(function, field, static_cast<double>(n), "it must be at least 2");
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/mesh_links.hpp
// =================================================================================================
// From loose triangles to a mesh: equal vertices made one, slivers dropped, neighbours found.

PHYSICS_HPP_BEGIN

namespace detail {

/// Numbers that are found again by what they stand for, in expected constant time; the hash decides nothing but speed.
class number_table {
public:
    explicit number_table(std::uint32_t most) {
        std::uint32_t slots = 16;
        while (slots < most * std::uint64_t{2} && slots < 0x80000000u) slots *= 2;
        slots_.resize(slots, none);
    }
    static constexpr std::uint32_t none = 0xffffffffu;
    /// The place of the number for which same(number), or an empty one.
    template <class Same>
    std::uint32_t& find(std::uint64_t hash, Same&& same) {
        hash *= 0x9e3779b97f4a7c15u;
        const std::uint32_t mask = slots_.size() - 1;
        std::uint32_t i = static_cast<std::uint32_t>(hash >> 32) & mask;
        while (slots_[i] != none && !same(slots_[i])) i = (i + 1) & mask;
        return slots_[i];
    }

private:
    buffer<std::uint32_t> slots_;
};

/// A mesh in the making.
struct mesh_outline {
    struct triangle {
        std::uint32_t vertex[3];
        /// The triangles beyond the edges from vertex i to the next; none where there is none.
        std::uint32_t beyond[3];
        vec<double, 3> normal;
    };
    static constexpr std::uint32_t none = 0xffffffffu;

    buffer<vec<double, 3>> vertices;
    buffer<triangle> triangles;
    /// The numbers that triangles had as they were given.
    buffer<std::uint32_t> numbers;

    /// Gives each vertex the number of the first at its place, and keeps only those.
    void weld(buffer<std::uint32_t>& new_numbers) {
        number_table table(vertices.size());
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < vertices.size(); ++i) {
            std::uint64_t hash = 0;
            mix_digest(hash, vertices[i]);
            std::uint32_t& place = table.find(hash, [&](std::uint32_t k) { return vertices[k] == vertices[i]; });
            if (place == number_table::none) vertices[place = kept++] = vertices[i];
            new_numbers.push(place);
        }
        vertices.resize(kept);
    }

    /// Twice the area along the normal, null for slivers: those less high than `spacing` (relative to their largest
    /// coordinate, or as it is for fixed point) has their corners rounded.
    [[nodiscard]] vec<double, 3> area(const triangle& t, double spacing, bool relative) const {
        const vec<double, 3>&a = vertices[t.vertex[0]], &b = vertices[t.vertex[1]], &c = vertices[t.vertex[2]];
        const vec<double, 3> n = cross(b - a, c - a);
        const double longest = sqrt(max(dot(b - a, b - a), max(dot(c - b, c - b), dot(a - c, a - c))));
        const double reach = max(largest(a), max(largest(b), largest(c)));
        const double least = max(relative ? spacing * reach : spacing, 1e-12 * longest);
        return length(n) > least * longest ? n : vec<double, 3>{};
    }

    /// Finds what lies beyond each edge: the one triangle that runs along it the other way. Where several do, or one
    /// runs along it the same way, the edge is a free one.
    void link();
    /// Drops the triangles without a normal; what they lay between become neighbours.
    void drop_slivers();

private:
    /// Where one comes out who enters a sliver over edge e: over its longest edge, or if that is e, the longer one of
    /// the others.
    [[nodiscard]] std::uint32_t way_out(const triangle& t, int e) const {
        double longest = -1;
        int best = e;
        for (int i = 0; i < 3; ++i) {
            const vec<double, 3> edge = vertices[t.vertex[i < 2 ? i + 1 : 0]] - vertices[t.vertex[i]];
            if (i != e && dot(edge, edge) > longest) longest = dot(edge, edge), best = i;
        }
        return t.beyond[best];
    }
};

inline void mesh_outline::link() {
    const std::uint32_t edges = triangles.size() * 3;
    const auto from = [&](std::uint32_t e) { return triangles[e / 3].vertex[e % 3]; };
    const auto to = [&](std::uint32_t e) { return triangles[e / 3].vertex[(e + 1) % 3]; };
    const auto hash = [](std::uint32_t a, std::uint32_t b) {
        std::uint64_t h = 0;
        mix_digest(h, std::uint64_t{a} << 32 | b);
        return h;
    };
    number_table table(edges);
    const auto along = [&](std::uint32_t a, std::uint32_t b) -> std::uint32_t& {
        return table.find(hash(a, b), [&](std::uint32_t e) { return from(e) == a && to(e) == b; });
    };
    // The first edge of each direction stands for all of them.
    buffer<bool> shared;
    shared.resize(edges, false);
    for (std::uint32_t e = 0; e < edges; ++e) {
        std::uint32_t& first = along(from(e), to(e));
        if (first == number_table::none) first = e;
        else shared[first] = shared[e] = true;
    }
    for (std::uint32_t e = 0; e < edges; ++e) {
        const std::uint32_t other = along(to(e), from(e));
        const bool alone = !shared[e] && other != number_table::none && !shared[other];
        triangles[e / 3].beyond[e % 3] = alone ? other / 3 : none;
    }
}

inline void mesh_outline::drop_slivers() {
    const auto is_sliver = [&](std::uint32_t t) { return triangles[t].normal == vec<double, 3>{}; };
    buffer<std::uint32_t> new_numbers;
    std::uint32_t kept = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) new_numbers.push(is_sliver(t) ? none : kept++);
    if (kept == triangles.size()) return;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (is_sliver(t)) continue;
        for (std::uint32_t& beyond : triangles[t].beyond) {
            std::uint32_t here = t, next = beyond;
            for (int i = 0; i < 16 && next != none && is_sliver(next); ++i) {
                const triangle& s = triangles[next];
                int e = 0;
                while (e < 2 && s.beyond[e] != here) ++e;
                here = next;
                next = way_out(s, e);
            }
            beyond = next == none || is_sliver(next) || next == t ? none : next;
        }
    }
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (is_sliver(t)) continue;
        triangle moved = triangles[t];
        for (std::uint32_t& beyond : moved.beyond) beyond = beyond == none ? none : new_numbers[beyond];
        numbers[new_numbers[t]] = numbers[t];
        triangles[new_numbers[t]] = moved;
    }
    triangles.resize(kept);
    numbers.resize(kept);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/mesh_data.hpp
// =================================================================================================
// What a mesh is in memory: vertices, triangles with their neighbours, and a tree over them.

PHYSICS_HPP_BEGIN

namespace detail {

/// Triangles with coordinates in R.
template <class R>
struct mesh_data : geometry_block {
    struct triangle {
        std::uint32_t vertex[3];
        std::uint32_t beyond[3];
        /// The number that it was given with.
        std::uint32_t number;
        vec<R, 3> normal;
    };
    static constexpr std::uint32_t none = mesh_outline::none;

    bool two_sided;
    std::uint32_t dropped;
    std::uint64_t digest;
    aabb<double, 3> box;
    block_array<vec<R, 3>> vertices;
    block_array<triangle> triangles;
    part_tree<3> tree;

    [[nodiscard]] vec<double, 3> vertex(std::uint32_t i) const { return to_point(vertices[i]); }
    [[nodiscard]] aabb<double, 3> box_of(const triangle& t) const {
        const vec<double, 3> a = vertex(t.vertex[0]), b = vertex(t.vertex[1]), c = vertex(t.vertex[2]);
        return {min(a, min(b, c)), max(a, max(b, c))};
    }
    [[nodiscard]] surface_face<3> face(const triangle& t) const {
        return {{vertex(t.vertex[0]), vertex(t.vertex[1]), vertex(t.vertex[2])}, two_sided};
    }
    [[nodiscard]] surface_part<3> part(const triangle& t) const {
        surface_part<3> p;
        p.normal = to_point(t.normal);
        for (int i = 0; i < 3; ++i) {
            p.corner[i] = vertex(t.vertex[i]);
            p.continues[i] = t.beyond[i] != none;
            if (p.continues[i]) p.beyond[i] = to_point(triangles[t.beyond[i]].normal);
        }
        p.two_sided = two_sided;
        p.number = t.number;
        return p;
    }

    /// A block with one owner: the caller.
    static const mesh_data* make(const mesh_outline& outline, bool two_sided, std::uint32_t dropped);
};

template <class R>
const mesh_data<R>* mesh_data<R>::make(const mesh_outline& outline, bool two_sided, std::uint32_t dropped) {
    const std::uint32_t vertices = outline.vertices.size(), triangles = outline.triangles.size();
    block_layout layout(sizeof(mesh_data));
    const std::size_t at_vertices = layout.place<vec<R, 3>>(vertices);
    const std::size_t at_triangles = layout.place<triangle>(triangles);
    const auto at_tree = part_tree<3>::place(layout, triangles);
    auto* m = new_geometry<mesh_data>(layout.bytes());
    m->two_sided = two_sided;
    m->dropped = dropped;
    m->box = box_around(outline.vertices);
    m->digest = triangles * 2ull + std::uint64_t{two_sided};
    m->vertices.attach(m, at_vertices, vertices);
    m->triangles.attach(m, at_triangles, triangles);
    for (std::uint32_t i = 0; i < vertices; ++i) {
        m->vertices[i] = from_point<R>(outline.vertices[i]);
        mix_digest(m->digest, outline.vertices[i]);
    }
    buffer<aabb<float, 3>> boxes;
    boxes.reserve(triangles);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const auto& given = outline.triangles[i];
        triangle& t = m->triangles[i];
        for (int k = 0; k < 3; ++k) {
            t.vertex[k] = given.vertex[k];
            t.beyond[k] = given.beyond[k];
            mix_digest(m->digest, given.vertex[k]);
        }
        t.number = outline.numbers[i];
        mix_digest(m->digest, t.number);
        t.normal = from_point<R>(given.normal);
        boxes.push(outward_floats(m->box_of(t)));
    }
    m->tree.build(m, at_tree, boxes.begin(), triangles);
    return m;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/mesh.hpp
// =================================================================================================
// The mesh: a surface of triangles in space, such as the ground of a level.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of triangles in the shape's frame; it exists in space. It has no mass, so it
/// serves static and kinematic bodies. A mesh_geometry or a world keeps the triangles: as long as one of them does, the
/// shape is good.
template <class S, int D>
struct mesh;
template <class S>
struct mesh<S, 3> {
    using scalar = S;
    const detail::mesh_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return mesh<T, 3>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, mesh>{*this};
    }
};

template <class S>
bool check(const mesh<S, 3>& m, const char* function) {
    return detail::check_surface(m, "it must be the shape of a mesh_geometry that was built", function);
}
/// Tight up to 64 vertices; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 3> bounds(const mesh<S, 3>& m, const transform<S, 3>& at) {
    const auto& g = *m.geometry;
    detail::turned_bounds<S, 3> around(at);
    if (g.vertices.size() <= detail::points_to_bound)
        for (std::uint32_t i = 0; i < g.vertices.size(); ++i) around.add(g.vertex(i));
    else g.tree.cover([&](const aabb<float, 3>& box) { around.add(box); });
    return around.box(m.radius, g.box);
}
/// For the narrowphase: calls f with the triangles that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const mesh<S, 3>& m, const aabb<double, 3>& box, F&& f) {
    const auto& g = *m.geometry;
    g.tree.visit(box, [&](std::uint32_t i) {
        const auto& t = g.triangles[i];
        if (overlap(g.box_of(t), box)) f(g.part(t));
    });
}
/// For rays: calls f with the triangles that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const mesh<S, 3>& m, const detail::box_ray<3>& ray, F&& f) {
    const auto& g = *m.geometry;
    g.tree.visit(ray, [&](std::uint32_t i) { return f(g.face(g.triangles[i])); });
}

/// How triangles stop bodies.
struct mesh_settings {
    /// On the back too.
    bool two_sided = false;
};

/// A surface of triangles, built once and shared by all meshes made of it, and by worlds that hold such. Bodies glide
/// over the edges between triangles without a bump: vertices at the same place are one, and of the triangles that share
/// an edge each knows the other.
///
/// A body whose centre is behind a triangle passes through it, unless the mesh is two-sided. Where no triangle follows
/// beyond an edge, or more than one, or one of the other orientation, or one whose edge begins or ends elsewhere, the
/// edge is a free one: it can be hit from the side.
template <class S, int D>
class mesh_geometry;
template <class S>
class mesh_geometry<S, 3> {
public:
    /// No mesh: what build() gives in builds without exceptions when it has refused.
    mesh_geometry() = default;

    /// Triangles by three numbers of vertices each, counter-clockwise as seen from outside: triangle_count times 3
    /// indices. Triangles without area, as far as S can tell, are dropped and counted; what they lay between become
    /// neighbours. Refuses NaN and infinity, coordinates beyond 1e30 or a quarter of the range of S, numbers of
    /// vertices that do not exist, and meshes without any triangle. Cost: O(n log n), 1 us a triangle.
    [[nodiscard]] static mesh_geometry build(const vec<S, 3>* vertices, std::uint32_t vertex_count,
                                             const std::uint32_t* triangles, std::uint32_t triangle_count,
                                             const mesh_settings& settings = {}) {
        return mesh_geometry(built(vertices, vertex_count, triangles, triangle_count, settings));
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] mesh<S, 3> shape(S radius = S(0)) const { return {data(), radius}; }
    /// Contacts name triangles by the numbers that they were given with; the dropped ones count.
    [[nodiscard]] std::uint32_t triangle_count() const { return data()->triangles.size(); }
    [[nodiscard]] std::uint32_t dropped_triangles() const { return data()->dropped; }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::mesh_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::mesh_data<detail::hull_real<S>>;

    explicit mesh_geometry(const block* built) : owner_(built) {}
    static const block* built(const vec<S, 3>* vertices, std::uint32_t vertex_count, const std::uint32_t* triangles,
                              std::uint32_t triangle_count, const mesh_settings& settings);

    detail::geometry_owner<block> owner_;
};

template <class S>
const detail::mesh_data<detail::hull_real<S>>* mesh_geometry<S, 3>::built(const vec<S, 3>* vertices,
                                                                          std::uint32_t vertex_count,
                                                                          const std::uint32_t* triangles,
                                                                          std::uint32_t triangle_count,
                                                                          const mesh_settings& settings) {
    constexpr const char* f = "mesh_geometry::build";
    if (triangle_count > 0xffffffffu / 3) {
        detail::refuse(f, "triangle_count", triangle_count, "it must be at most 1431655765");
        return nullptr;
    }
    detail::mesh_outline outline;
    if (!detail::take_points(f, "vertices", vertices, vertex_count, outline.vertices)) return nullptr;
    for (std::uint32_t i = 0; i < triangle_count * 3; ++i) {
        if (triangles[i] < vertex_count) continue;
        char field[40];
        std::snprintf(field, sizeof field, "triangles[%u]", static_cast<unsigned>(i));
        detail::refuse(f, field, triangles[i], "it must be less than the number of vertices");
        return nullptr;
    }
    buffer<std::uint32_t> welded;
    outline.weld(welded);
    const double spacing = 2 * static_cast<double>(scalar_traits<S>::epsilon());
    outline.triangles.reserve(triangle_count);
    for (std::uint32_t i = 0; i < triangle_count; ++i) {
        const std::uint32_t* v = triangles + std::size_t{i} * 3;
        detail::mesh_outline::triangle t{{welded[v[0]], welded[v[1]], welded[v[2]]}, {}, {}};
        if (t.vertex[0] == t.vertex[1] || t.vertex[1] == t.vertex[2] || t.vertex[2] == t.vertex[0]) continue;
        t.normal = normalized(outline.area(t, spacing, detail::self_wide<S>));
        outline.triangles.push(t);
        outline.numbers.push(i);
    }
    outline.link();
    outline.drop_slivers();
    const std::uint32_t kept = outline.triangles.size();
    if (kept == 0) {
        detail::refuse(f, "number of triangles with an area", 0.0, "a mesh needs at least 1");
        return nullptr;
    }
    return block::make(outline, settings.two_sided, triangle_count - kept);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/rounded_box.hpp
// =================================================================================================
// The rounded box: a box whose edges and corners are round.

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the box |p_i| <= half_extents_i (m) in the shape's frame: it reaches
/// half_extents_i + radius along each axis.
template <class S, int D>
struct rounded_box {
    using scalar = S;
    vec<S, D> half_extents = vec<S, D>::filled(S(0.375));
    S radius = S(0.125);

    template <class T>
    [[nodiscard]] constexpr rounded_box<T, D> as() const {
        rounded_box<T, D> result;
        for (int i = 0; i < D; ++i) result.half_extents[i] = static_cast<T>(half_extents[i]);
        result.radius = static_cast<T>(radius);
        return result;
    }
};

template <class S, int D>
bool check(const rounded_box<S, D>& b, const char* function) {
    return check(box<S, D>{b.half_extents}, function) && detail::check_positive(function, "radius", b.radius);
}
template <class S, int D>
constexpr aabb<S, D> bounds(const rounded_box<S, D>& b, const transform<S, D>& at) {
    return grown(bounds(box<S, D>{b.half_extents}, at), b.radius);
}
template <class S, int D>
constexpr vec<S, D> support(const rounded_box<S, D>& b, vec<S, D> direction) {
    return support(box<S, D>{b.half_extents}, direction) + normalized(direction) * b.radius;
}
/// Exact; calculated in double. The box, slabs on its sides, quarters of discs or cylinders at its edges, and in 3D
/// eighths of a ball at its corners.
template <class S, int D>
mass_properties<S, D> mass_of(const rounded_box<S, D>& b, std::type_identity_t<S> density) {
    const vec<double, 3> h = detail::exact_in_space(b.half_extents);
    const double r = static_cast<double>(b.radius), rr = r * r;
    double volume = 0, squares[3] = {};
    for (int i = 0; i < D; ++i) {
        const int j = i + 1 < D ? i + 1 : 0, k = D == 2 ? j : i > 0 ? i - 1 : 2;
        const double a = h[i], aa = a * a;
        // What lies between this axis' sides, and beyond them. Together the same volume for each axis.
        const double within = D == 2 ? 4 * a * (h[j] + r)
                                     : 8 * a * (h[j] * h[k] + r * (h[j] + h[k])) + 2 * pi<double> * rr * a;
        const double slabs = r * (D == 2 ? 4 * h[j] : 8 * h[j] * h[k]);
        const double quarters = pi<double> * rr * (D == 2 ? 1 : 2 * (h[j] + h[k]));
        const double balls = D == 2 ? 0 : pi<double> * (4.0 / 3) * rr * r;
        volume = within + slabs + quarters + balls;
        squares[i] = within * (aa / 3) + slabs * (aa + a * r + rr / 3) +
                     quarters * (aa + a * r * (8.0 / 3) / pi<double> + rr / 4) +
                     balls * (aa + a * r * 0.75 + rr / 5);
    }
    detail::solid_moments m;
    m.add(volume, {}, {}, symmetric<double>::diagonal(squares[0], squares[1], squares[2]));
    return m.template mass<S, D>({}, density);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/segment.hpp
// =================================================================================================
// The segment: a line between two points, thick or not.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the line from a to b (m) in the shape's frame: a capsule anywhere, or
/// with radius 0 an edge of a level, which has no mass. a and b must differ.
template <class S, int D>
struct segment {
    using scalar = S;
    vec<S, D> a = at_x(S(-0.5));
    vec<S, D> b = at_x(S(0.5));
    S radius{};

    template <class T>
    [[nodiscard]] constexpr segment<T, D> as() const {
        segment<T, D> result;
        for (int i = 0; i < D; ++i) {
            result.a[i] = static_cast<T>(a[i]);
            result.b[i] = static_cast<T>(b[i]);
        }
        result.radius = static_cast<T>(radius);
        return result;
    }

private:
    static constexpr vec<S, D> at_x(S x) {
        vec<S, D> v;
        v.x = x;
        return v;
    }
};

template <class S, int D>
bool check(const segment<S, D>& s, const char* function) {
    if (!detail::check_finite(function, "a", s.a) || !detail::check_finite(function, "b", s.b) ||
        !detail::check_not_negative(function, "radius", s.radius))
        return false;
    return !(s.a == s.b) || detail::refuse(function, "length", 0.0, "the ends must differ; a point is a ball");
}
template <class S, int D>
constexpr aabb<S, D> bounds(const segment<S, D>& s, const transform<S, D>& at) {
    const vec<S, D> a = at.rotation * s.a, b = at.rotation * s.b;
    const aabb<S, D> box = grown(aabb<S, D>{min(a, b), max(a, b)}, s.radius);
    return {at.position + box.lower, at.position + box.upper};
}
template <class S, int D>
constexpr vec<S, D> support(const segment<S, D>& s, vec<S, D> direction) {
    const vec<S, D> end = wide_dot(direction, s.b) > wide_dot(direction, s.a) ? s.b : s.a;
    return s.radius > S(0) ? end + normalized(direction) * s.radius : end;
}
/// Exact; calculated in double. A rectangle or cylinder and two half balls; none where radius is 0.
template <class S, int D>
mass_properties<S, D> mass_of(const segment<S, D>& s, std::type_identity_t<S> density) {
    const vec<double, 3> a = detail::exact_in_space(s.a), b = detail::exact_in_space(s.b);
    const auto [u, whole] = split(b - a);
    const double l = 0.5 * whole, r = static_cast<double>(s.radius), rr = r * r;
    // Sizes of middle and ends, and the means of squares along and across.
    const double middle = D == 2 ? 4 * l * r : 2 * pi<double> * rr * l;
    const double ends = D == 2 ? pi<double> * rr : pi<double> * (4.0 / 3) * rr * r;
    const double outwards = D == 2 ? r * (4.0 / 3) / pi<double> : r * (3.0 / 8);
    const double along = middle * (l * l / 3) + ends * (l * l + 2 * l * outwards + rr / (D + 2));
    const double across = middle * (rr / (D == 2 ? 3 : 4)) + ends * (rr / (D + 2));
    const symmetric<double> space = symmetric<double>::diagonal(1, 1, D == 2 ? 0 : 1);
    detail::solid_moments m;
    m.add(middle + ends, {}, {}, space * across + detail::square_of(u) * (along - across));
    return m.template mass<S, D>(a + (b - a) * 0.5, density);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/tile_outline.hpp
// =================================================================================================
// The outline of solid cells in a grid, by its straight runs.

PHYSICS_HPP_BEGIN

namespace detail {

/// Finds the closed lines around the solid cells of a grid, the solid on the left, as segments from corner to corner.
/// Cells that touch in one corner only count as joined there: floor meets wall on either side of that corner, since no
/// body passes between. Cost: 2 to 5 ns a cell and 20 ns a side.
class tile_outline {
public:
    tile_outline(const std::uint8_t* cells, std::uint32_t columns, std::uint32_t rows)
        : cells_(cells), columns_(columns), rows_(rows) {}

    /// Where segments begin, in corners of cells, and what follows what.
    buffer<vec<double, 2>> points;
    buffer<chain_links> links;

    void trace() {
        first_.reserve((columns_ + 1) * (rows_ + 1));
        for (std::uint32_t y = 0; y <= rows_; ++y)
            for (std::uint32_t x = 0; x <= columns_; ++x) {
                first_.push(starts_.size());
                for (int d = 0; d < 4; ++d)
                    if (side(x, y, d) && !arrives(x, y, d)) starts_.push({x, y, d});
            }
        links.resize(starts_.size());
        for (std::uint32_t i = 0; i < starts_.size(); ++i) {
            corner c = starts_[i];
            points.push({static_cast<double>(c.x), static_cast<double>(c.y)});
            do walk(c);
            while (side(c.x, c.y, c.direction));
            // Where both turns are open two cells touch: the right one keeps to the same air.
            const int right = (c.direction + 3) & 3;
            const std::uint32_t next = number(c.x, c.y, side(c.x, c.y, right) ? right : (c.direction + 1) & 3);
            links[i].after = next;
            links[next].before = i;
        }
    }

private:
    struct corner {
        std::uint32_t x, y;
        /// 0 to the right, then counter-clockwise.
        int direction;
    };
    /// Cells beyond the grid are empty; x = 0 is the one to the left of it.
    [[nodiscard]] bool solid(std::uint32_t x, std::uint32_t y) const {
        return x > 0 && y > 0 && x <= columns_ && y <= rows_ &&
               cells_[std::size_t{y - 1} * columns_ + (x - 1)] != 0;
    }
    /// Whether a side of the outline leads from a corner in a direction.
    [[nodiscard]] bool side(std::uint32_t x, std::uint32_t y, int direction) const {
        // The cells around a corner are (x, y) to (x + 1, y + 1) as solid() counts.
        static constexpr std::uint8_t left[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
        static constexpr std::uint8_t right[4][2] = {{1, 0}, {1, 1}, {0, 1}, {0, 0}};
        return solid(x + left[direction][0], y + left[direction][1]) &&
               !solid(x + right[direction][0], y + right[direction][1]);
    }
    /// Whether a side arrives at a corner in a direction.
    [[nodiscard]] bool arrives(std::uint32_t x, std::uint32_t y, int direction) const {
        if ((direction == 0 && x == 0) || (direction == 2 && x == columns_) || (direction == 1 && y == 0) ||
            (direction == 3 && y == rows_))
            return false;
        corner before{x, y, (direction + 2) & 3};
        walk(before);
        return side(before.x, before.y, direction);
    }
    static void walk(corner& c) {
        if (c.direction == 0) ++c.x;
        if (c.direction == 1) ++c.y;
        if (c.direction == 2) --c.x;
        if (c.direction == 3) --c.y;
    }
    [[nodiscard]] std::uint32_t number(std::uint32_t x, std::uint32_t y, int direction) const {
        std::uint32_t i = first_[y * (columns_ + 1) + x];
        while (starts_[i].direction != direction) ++i;
        return i;
    }

    const std::uint8_t* cells_;
    std::uint32_t columns_, rows_;
    buffer<corner> starts_;
    /// For each corner the first segment that begins there or later.
    buffer<std::uint32_t> first_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/tile_grid.hpp
// =================================================================================================
// The tile grid: solid and empty cells in the plane, such as the level of a platformer.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the outline of solid cells; it exists in the plane. It has no mass, so it
/// serves static and kinematic bodies. A tile_grid_geometry or a world keeps the outline: as long as one of them does,
/// the shape is good.
template <class S, int D>
struct tile_grid;
template <class S>
struct tile_grid<S, 2> {
    using scalar = S;
    const detail::chain_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return tile_grid<T, 2>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, tile_grid>{*this};
    }
};

template <class S>
bool check(const tile_grid<S, 2>& g, const char* function) {
    return detail::check_surface(g, "it must be the shape of a tile_grid_geometry that was built", function);
}
/// Tight up to 64 corners; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 2> bounds(const tile_grid<S, 2>& g, const transform<S, 2>& at) {
    return detail::bounds_of_chain(*g.geometry, g.radius, at);
}
/// For the narrowphase: calls f with the straight runs that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const tile_grid<S, 2>& g, const aabb<double, 2>& box, F&& f) {
    detail::each_segment(*g.geometry, box, f);
}
/// For rays: calls f with the runs that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const tile_grid<S, 2>& g, const detail::box_ray<2>& ray, F&& f) {
    detail::each_segment_along(*g.geometry, ray, f);
}

/// The outline of solid cells, built once and shared by all tile grids made of it, and by worlds that hold such. Sides
/// in a row are one segment, however many cells it runs along, so that nothing can stumble over the joints between
/// cells. Cells that touch in one corner only count as joined there: nothing falls through, and what slides into such a
/// corner meets floor and wall.
///
/// A body whose centre is inside of a solid cell passes through the sides from within, as it does with chains.
template <class S, int D>
class tile_grid_geometry;
template <class S>
class tile_grid_geometry<S, 2> {
public:
    /// No grid: what build() gives in builds without exceptions when it has refused.
    tile_grid_geometry() = default;

    /// A grid of columns times rows square cells with sides of cell_size (m), whose lower left corner is the origin of
    /// the shape's frame: cells[row * columns + column] is 0 where the cell is empty, rows counted upwards. Refuses a
    /// size that is not greater than 0, grids too large for S or of 2^31 cells and more, and grids without any solid
    /// cell. Cost: 2 to 5 ns a cell, 0.3 us a corner; memory for corners only.
    [[nodiscard]] static tile_grid_geometry build(const std::uint8_t* cells, std::uint32_t columns, std::uint32_t rows,
                                                  S cell_size) {
        return tile_grid_geometry(built(cells, columns, rows, cell_size));
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] tile_grid<S, 2> shape(S radius = S(0)) const { return {data(), radius}; }
    /// The straight runs of the outline; contacts name them as their part.
    [[nodiscard]] std::uint32_t segment_count() const { return data()->segment_count(); }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::chain_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::chain_data<detail::hull_real<S>>;

    explicit tile_grid_geometry(const block* built) : owner_(built) {}
    static const block* built(const std::uint8_t* cells, std::uint32_t columns, std::uint32_t rows, S cell_size) {
        constexpr const char* f = "tile_grid_geometry::build";
        if (!detail::check_spacing(f, "cell_size", cell_size)) return nullptr;
        const std::uint64_t corners = (std::uint64_t{columns} + 1) * (std::uint64_t{rows} + 1);
        if (corners > 0x7fffffffu) {
            detail::refuse(f, "number of corners", static_cast<double>(corners), "it must be less than 2^31");
            return nullptr;
        }
        const double size = static_cast<double>(cell_size);
        if (!detail::check_reach<S>(f, size * (columns > rows ? columns : rows))) return nullptr;
        detail::tile_outline outline(cells, columns, rows);
        outline.trace();
        if (outline.points.empty()) {
            detail::refuse(f, "number of solid cells", 0.0, "a tile grid needs at least 1");
            return nullptr;
        }
        for (vec<double, 2>& p : outline.points) p = p * size;
        return block::make(outline.points, outline.links, true, false);
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/shape/triangle.hpp
// =================================================================================================
// The triangle: solid in 2D; in 3D a sheet, thick or not.

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the triangle with the corners a, b, c (m) in the shape's frame, which may
/// go round either way and must not lie on one line. In 3D it has two sides, and a mass only if radius is not 0.
template <class S, int D>
struct triangle {
    using scalar = S;
    vec<S, D> a = corner(-0.5, -0.5);
    vec<S, D> b = corner(0.5, -0.5);
    vec<S, D> c = corner(0, 0.5);
    S radius{};

    template <class T>
    [[nodiscard]] constexpr triangle<T, D> as() const {
        triangle<T, D> result;
        for (int i = 0; i < D; ++i) {
            result.a[i] = static_cast<T>(a[i]);
            result.b[i] = static_cast<T>(b[i]);
            result.c[i] = static_cast<T>(c[i]);
        }
        result.radius = static_cast<T>(radius);
        return result;
    }

private:
    static constexpr vec<S, D> corner(double x, double y) {
        vec<S, D> v;
        v.x = S(x);
        v.y = S(y);
        return v;
    }
};

namespace detail {

/// The longest edge of a triangle, the height over it, and the largest coordinate.
struct triangle_sizes {
    double longest, height, reach;
};
template <class S, int D>
triangle_sizes sizes_of(const triangle<S, D>& t) {
    const vec<double, 3> corner[3] = {exact_in_space(t.a), exact_in_space(t.b), exact_in_space(t.c)};
    triangle_sizes s{};
    int from = 0;
    for (int i = 0; i < 3; ++i) {
        s.reach = max(s.reach, largest(corner[i]));
        const double l = length(corner[i < 2 ? i + 1 : 0] - corner[i]);
        if (l > s.longest) s.longest = l, from = i;
    }
    // Both ends give the same height, but for rounding: it is less from the nearer one.
    const vec<double, 3>& p = corner[from];
    const vec<double, 3>& q = corner[from < 2 ? from + 1 : 0];
    const vec<double, 3>& top = corner[from > 0 ? from - 1 : 2];
    const vec<double, 3> e = normalized(q - p);
    s.height = min(length(cross(e, top - p)), length(cross(e, top - q)));
    return s;
}

}  // namespace detail

template <class S, int D>
bool check(const triangle<S, D>& t, const char* function) {
    if (!detail::check_finite(function, "a", t.a) || !detail::check_finite(function, "b", t.b) ||
        !detail::check_finite(function, "c", t.c) || !detail::check_not_negative(function, "radius", t.radius))
        return false;
    const detail::triangle_sizes s = detail::sizes_of(t);
    // What rounding of the corners to S may make of three points on a line: 4 spacings.
    const double spacing = static_cast<double>(scalar_traits<S>::epsilon());
    const double least = 4 * max(detail::is_fixed<S> ? spacing : spacing * s.reach, 0x1p-52 * s.reach);
    return s.height > least ||
           detail::refuse(function, "area", 0.5 * s.longest * s.height, "the corners must not lie on one line");
}
template <class S, int D>
constexpr aabb<S, D> bounds(const triangle<S, D>& t, const transform<S, D>& at) {
    const vec<S, D> a = at.rotation * t.a, b = at.rotation * t.b, c = at.rotation * t.c;
    const aabb<S, D> box = grown(aabb<S, D>{min(a, min(b, c)), max(a, max(b, c))}, t.radius);
    return {at.position + box.lower, at.position + box.upper};
}
/// Of corners at the same distance the first.
template <class S, int D>
constexpr vec<S, D> support(const triangle<S, D>& t, vec<S, D> direction) {
    const wide_of<S> a = wide_dot(direction, t.a), b = wide_dot(direction, t.b), c = wide_dot(direction, t.c);
    const vec<S, D> corner = c > a && c > b ? t.c : b > a ? t.b : t.a;
    return t.radius > S(0) ? corner + normalized(direction) * t.radius : corner;
}
/// Exact; calculated in double. In 2D the triangle, a strip along each edge and a sector at each corner; in 3D a slab,
/// half a cylinder along each edge and a wedge of a ball at each corner: none where radius is 0.
template <class S, int D>
mass_properties<S, D> mass_of(const triangle<S, D>& t, std::type_identity_t<S> density) {
    using detail::square_of;
    const vec<double, 3> first = detail::exact_in_space(t.a), origin =
        first + (detail::exact_in_space(t.b) - first + (detail::exact_in_space(t.c) - first)) * (1.0 / 3);
    vec<double, 3> corner[3] = {first - origin, detail::exact_in_space(t.b) - origin,
                                detail::exact_in_space(t.c) - origin};
    vec<double, 3> n{0.0, 0.0, 1.0}, edge[3];
    if (D == 3) n = detail::triangle_normal(corner[0], corner[1], corner[2]);
    // Counter-clockwise as seen from where n points.
    if (dot(cross(corner[1] - corner[0], corner[2] - corner[0]), n) < 0) std::swap(corner[1], corner[2]);
    const double r = static_cast<double>(t.radius), rr = r * r, rrr = rr * r;
    const symmetric<double> nn = square_of(n) * (D == 2 ? 0 : 1);

    detail::solid_moments m;
    const double area = 0.5 * dot(n, cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double slab = D == 2 ? area : 2 * r * area;
    const detail::simplex_sums mean = detail::over_triangle(corner[0], corner[1], corner[2]);
    m.add(slab, {}, mean.first * slab, mean.second * slab + nn * (slab * rr / 3));
    for (int i = 0; i < 3; ++i) {
        const auto [u, l] = split(corner[i < 2 ? i + 1 : 0] - corner[i]);
        edge[i] = u;
        const vec<double, 3> out = cross(u, n);
        const double strip = l * (D == 2 ? r : 0.5 * pi<double> * rr);
        const double outwards = l * (D == 2 ? 0.5 * rr : rrr * (2.0 / 3));
        const double squares = l * (D == 2 ? rrr / 3 : pi<double> / 8 * rr * rr);
        m.add(strip, corner[i] + u * (0.5 * l), out * outwards,
              square_of(u) * (strip * l * l / 12) + (square_of(out) + nn) * squares);
    }
    for (int i = 0; i < 3; ++i) {
        const vec<double, 3>& before = edge[i > 0 ? i - 1 : 2];
        const vec<double, 3>& after = edge[i];
        // By which the direction turns here; twice the sine of half of it is the length of the difference.
        const double sine = dot(cross(before, after), n), angle = atan2(sine, dot(before, after));
        const vec<double, 3> difference = before - after, out = normalized(difference), aside = cross(n, out);
        const double wedge = angle * (D == 2 ? 0.5 * rr : rrr * (2.0 / 3));
        const double outwards = 0.5 * (D == 2 ? rrr * (2.0 / 3) : 0.25 * pi<double> * rr * rr);
        const double squares = D == 2 ? rr * rr / 8 : rrr * rr * (2.0 / 15);
        m.add(wedge, corner[i], difference * outwards,
              square_of(out) * (squares * (angle + sine)) + square_of(aside) * (squares * (angle - sine)) +
                  nn * (squares * angle));
    }
    return m.template mass<S, D>(origin, density);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/bounding_half.hpp
// =================================================================================================
// A halfspace as the general kernels see it.

PHYSICS_HPP_BEGIN

namespace detail {

/// The points for which dot(normal, p) <= offset.
template <int D>
struct bounding_half {
    /// Of unit length, outwards.
    point<D> normal;
    double offset;

    template <class S>
    explicit bounding_half(const halfspace<S, D>& h)
        : normal(normalized(to_point(h.normal))), offset(detail::to_double(h.offset)) {}
    /// The same as seen from the frame in which it stands.
    template <class S>
    bounding_half(const halfspace<S, D>& h, const transform<S, D>& at)
        : normal(normalized(to_matrix(at.rotation) * to_point(h.normal))),
          offset(detail::to_double(h.offset) + dot(normal, to_point(at.position))) {}

    /// How far a point lies outside.
    [[nodiscard]] double height(const point<D>& p) const { return dot(normal, p) - offset; }
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/box_pair.hpp
// =================================================================================================
// A pair of boxes, as batches of them are passed.

PHYSICS_HPP_BEGIN

namespace detail {

/// Two boxes, and where B stands in A's frame.
template <class S, int D>
struct box_pair {
    const box<S, D>* a;
    const box<S, D>* b;
    const transform<S, D>* b_in_a;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/manifold.hpp
// =================================================================================================
// What the narrowphase says of a pair of shapes.

PHYSICS_HPP_BEGIN

/// One point of contact, in the frame of shape A.
template <class S, int D>
struct manifold_point {
    /// Halfway between the two surfaces (m).
    vec<S, D> position;
    /// Distance of the surfaces along the normal (m); negative where they overlap.
    S separation{};
    /// Names the features that touch: equal in the next step if the same ones still do.
    std::uint32_t feature = 0;
};

/// The points in which two shapes touch or nearly touch: at most 2 in the plane and 4 in space.
template <class S, int D>
struct manifold {
    static constexpr int capacity = D == 2 ? 2 : 4;

    /// Unit normal from A to B, in the frame of shape A.
    vec<S, D> normal;
    manifold_point<S, D> points[capacity];
    int count = 0;

    constexpr void add(vec<S, D> position, S separation, std::uint32_t feature) {
        points[count++] = {position, separation, feature};
    }
};

/// Adds the point between the surfaces of two rounded features: their cores lie at a and b, the distance of
/// the cores along the normal is gap.
template <class S, int D>
constexpr void add_rounded(manifold<S, D>& m, vec<S, D> a, S radius_a, vec<S, D> b, S radius_b, S gap,
                           std::uint32_t feature) {
    const vec<S, D> on_a = a + m.normal * radius_a;
    const vec<S, D> on_b = b - m.normal * radius_b;
    m.add((on_a + on_b) * S(0.5), gap - radius_a - radius_b, feature);
}

/// Two round cores (points with radius): one point, if they are within margin. Coincident centres get the
/// fallback normal.
template <class S, int D>
constexpr void collide_round(vec<S, D> a, S radius_a, vec<S, D> b, S radius_b, vec<S, D> fallback, S margin,
                             std::uint32_t feature, manifold<S, D>& out) {
    const vec<S, D> offset = b - a;
    const S reach = radius_a + radius_b + margin;
    if (largest(offset) > reach) return;
    const auto [direction, gap] = split(offset);
    if (gap > reach) return;
    out.normal = gap > S(0) ? direction : fallback;
    add_rounded(out, a, radius_a, b, radius_b, gap, feature);
}

namespace detail {
/// What a few roundings of numbers as large as `size` may come to.
template <class S>
constexpr S rounding_of(S size) {
    return S(16) * scalar_traits<S>::epsilon() * (is_fixed<S> ? max(size, S(1)) : size);
}
}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/box2.hpp
// =================================================================================================
// Contact of two boxes in the plane, in lanes across pairs: separating axes and clipping without a branch.

PHYSICS_HPP_BEGIN

namespace detail {

/// The numbers of W pairs of boxes: half extents of A and B, the position and the rotation of B in A's frame.
template <class P>
struct box_lanes2 {
    P ax, ay, bx, by, px, py, cosine, sine;
};

/// The manifolds of W pairs of boxes, and what the corners need where no edge leads.
template <class P>
struct box_contact_lanes2 {
    P normal_x, normal_y;
    P x[2], y[2], gap[2], feature[2];
    P count;
    /// Positive where boxes are near and their edges do not say how near: then a corner does.
    P missed;
    /// How far the best edge parts the boxes.
    P apart;
    /// Names the reference edge and the edge that faces it. Bit 1: whether the reference edge is one of B's.
    P edges;
};

/// Clips the edge of one box that faces the best edge of the other.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE box_contact_lanes2<P> touch_boxes(const box_lanes2<P>& in, const P& margin) {
    using S = typename P::scalar;
    const auto value = [](double x) { return P::broadcast(S(x)); };
    const P zero = value(0), half = value(0.5), one = value(1), two = value(2), c = in.cosine, s = in.sine;
    // A's center in B's frame is -q.
    const P qx = lane_sum(c, in.px, s, in.py), qy = lane_difference(c, in.py, s, in.px);
    const P apx = lane_abs(in.px), apy = lane_abs(in.py), ac = lane_abs(c), as = lane_abs(s);

    const P gap_ax = apx - in.ax - lane_sum(ac, in.bx, as, in.by);
    const P gap_ay = apy - in.ay - lane_sum(as, in.bx, ac, in.by);
    const P gap_bx = lane_abs(qx) - in.bx - lane_sum(ac, in.ax, as, in.ay);
    const P gap_by = lane_abs(qy) - in.by - lane_sum(as, in.ax, ac, in.ay);
    const P best_a = max(gap_ax, gap_ay), best_b = max(gap_bx, gap_by), apart = max(best_a, best_b);

    P size = max(in.ax, in.ay) + max(in.bx, in.by) + max(apx, apy);
    if constexpr (is_fixed<S>) size = max(size, one);
    const P smallest = min(min(in.ax, in.ay), min(in.bx, in.by));
    const P slack = max(smallest * value(1.0 / 1024), size * P::broadcast(rounding_of(S(1))));
    const P twice = slack + slack;

    // The boxes' turn but for quarters: which edge faces which. Of two that are as good the same one wins, so that
    // rounding does not choose. (A sign is one minus zero or two: those need no blend, and name the edges below.)
    const P least = ac + value(1.0 / 1024);
    const auto by_quarter = [&](const P& even, const P& odd) { return select_greater(as, least, odd, even); };
    const P quarter = by_quarter(zero, one), run = by_quarter(ac, as), nearest = by_quarter(c, s);
    const P back = select_greater(zero, nearest, two, zero), lean = by_quarter(s, -c) * (one - back);
    const P slope_in_a = lean / run;

    // A preference for A's edge keeps the reference from flipping between two that are alike.
    const P least_b = best_a + twice;
    const auto of_reference = [&](const P& a, const P& b) { return select_greater(best_b, least_b, b, a); };
    const P reference_x = of_reference(in.ax, in.bx), reference_y = of_reference(in.ay, in.by);
    const P incident_x = of_reference(in.bx, in.ax), incident_y = of_reference(in.by, in.ay);
    const P from_b = of_reference(zero, two), direction = one - from_b, flipped = from_b - one;
    const P steeper = of_reference(gap_ay - gap_ax, gap_by - gap_bx);
    const auto along_axis = [&](const P& x, const P& y) { return select_greater(steeper, zero, y, x); };
    const P axis = along_axis(zero, one), odd = axis - quarter, odd_square = odd * odd;
    const auto facing = [&](const P& x, const P& y) { return select_greater(odd_square, zero, y, x); };
    const P half_u = along_axis(reference_x, reference_y), half_v = along_axis(reference_y, reference_x);
    const P depth = facing(incident_x, incident_y), length = facing(incident_y, incident_x);

    // The reference edge's normal in A's frame, u, points at the other box; v leads along the edge.
    const P base_c = of_reference(one, c), base_s = of_reference(zero, s);
    const P axis_x = along_axis(base_c, -base_s), axis_y = along_axis(base_s, base_c);
    const P center_u = lane_sum(axis_x, in.px, axis_y, in.py) * direction;
    const P backward = select_greater(zero, center_u, two, zero), side = one - backward;
    const P n_x = axis_x * side, n_y = axis_y * side, normal_x = n_x * direction, normal_y = n_y * direction;

    // The incident edge: its middle, and its ends where they are within the reference edge's. Those are a little
    // farther out, so that rounding does not cut the corners of equal boxes.
    const P slope = slope_in_a * flipped, limit = half_v + slack, reach = run * length;
    const P middle_gap = center_u * side - half_u - run * depth;
    const P middle_v = lane_difference(normal_x, in.py, normal_y, in.px) + lean * flipped * depth;
    const P v0 = max(middle_v - reach, -limit), v1 = min(middle_v + reach, limit);
    const P gap0 = middle_gap + (v0 - middle_v) * slope, gap1 = middle_gap + (v1 - middle_v) * slope;

    // Halfway between the edges; B's edges stand around its center.
    const P origin_x = of_reference(zero, in.px), origin_y = of_reference(zero, in.py);
    const P u0 = half_u + gap0 * half, u1 = half_u + gap1 * half;
    const P x0 = origin_x + lane_difference(n_x, u0, n_y, v0), y0 = origin_y + lane_sum(n_y, u0, n_x, v0);
    const P x1 = origin_x + lane_difference(n_x, u1, n_y, v1), y1 = origin_y + lane_sum(n_y, u1, n_x, v1);

    box_contact_lanes2<P> out;
    out.normal_x = normal_x;
    out.normal_y = normal_y;
    out.apart = apart;
    out.missed = select_greater(apart, margin, zero, max(v0 - v1, min(gap0, gap1) - (apart + twice)));
    out.edges = (back + back + backward + quarter) * value(4) + from_b + axis;

    // Of ends beyond the margin nothing is left, and the second takes the place of the first.
    const P far0 = max(gap0, apart), far1 = max(gap1, apart);
    const auto keep = [&](const P& first, const P& second, P* to) {
        const P other = select_greater(far1, margin, zero, second);
        to[0] = select_greater(far0, margin, other, first);
        to[1] = select_greater(far0, margin, zero, other);
    };
    keep(x0, x1, out.x);
    keep(y0, y1, out.y);
    keep(gap0, gap1, out.gap);
    keep(out.edges, out.edges + value(32), out.feature);
    out.count = select_greater(far0, margin, zero, one) + select_greater(far1, margin, zero, one);
    return out;
}

/// The contact of a corner at an end of the reference edge, which B has or A, and the point of the other box that is
/// closest to it. `parting` is the edge's normal from A to B, `parted` how far the best edge parts the boxes.
template <class S>
void touch_box_corner(const box_pair<S, 2>& pair, bool of_b, vec<S, 2> parting, S parted, S margin,
                      manifold<S, 2>& out) {
    const transform<S, 2>& b_in_a = *pair.b_in_a;
    const rotation<S, 2> r = b_in_a.rotation;
    const vec<S, 2> half = of_b ? pair.b->half_extents : pair.a->half_extents;
    const vec<S, 2> other_half = of_b ? pair.a->half_extents : pair.b->half_extents;
    // It is the end beyond which the other box's deepest corner lies.
    const vec<S, 2> parting_in_b = inverse_rotate(r, parting), n = of_b ? -parting_in_b : parting;
    const vec<S, 2> deepest =
        of_b ? inverse_transform(b_in_a, support(*pair.a, parting)) : b_in_a * support(*pair.b, -parting_in_b);
    const bool along_y = abs(n.y) > abs(n.x);
    const bool right = (along_y ? deepest.x : n.x) > S(0), upper = (along_y ? n.y : deepest.y) > S(0);
    const vec<S, 2> corner{right ? half.x : -half.x, upper ? half.y : -half.y};
    const vec<S, 2> local = of_b ? b_in_a * corner : inverse_transform(b_in_a, corner);
    const vec<S, 2> beyond = local - max(-other_half, min(other_half, local));

    auto [direction, gap] = split(beyond);
    const vec<S, 2> in_a = of_b ? direction : -(r * direction), in_b = of_b ? inverse_rotate(r, direction) : -direction;
    const S along =
        dot(in_a, b_in_a.position) - dot(abs(in_a), pair.a->half_extents) - dot(abs(in_b), pair.b->half_extents);
    // Of points that all but coincide the direction is chance.
    const S rounding = rounding_of(largest(half) + largest(other_half) + largest(b_in_a.position));
    const bool clear = gap > S(0) && !(along < parted - rounding);
    if (!clear) gap = parted;
    out = {};
    if (gap > margin) return;
    out.normal = clear ? in_a : parting;
    // Two corners have one name, whichever was found.
    const std::uint32_t number = std::uint32_t{right} | std::uint32_t{upper} << 1;
    const std::uint32_t nearest = std::uint32_t{beyond.x > S(0)} | std::uint32_t{beyond.y > S(0)} << 1;
    const bool in_x = beyond.x == S(0), in_y = beyond.y == S(0);
    const std::uint32_t feature = in_x || in_y ? 0x200u | std::uint32_t{in_x} << 6 | std::uint32_t{in_y} << 5 |
                                                     std::uint32_t{of_b} << 4 | nearest << 2 | number
                                               : 0x100u | (of_b ? nearest << 2 | number : number << 2 | nearest);
    out.add(of_b ? local - out.normal * (gap * S(0.5)) : corner + out.normal * (gap * S(0.5)), gap, feature);
}

/// Writes the manifold of one lane.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE void write_box_contact(const box_contact_lanes2<P>& found, int lane,
                                                 const box_pair<S, 2>& pair, S margin, manifold<S, 2>& out) {
    const auto number = [](S x) { return static_cast<std::uint32_t>(static_cast<int>(to_double(x))); };
    out.normal = {found.normal_x.lane(lane), found.normal_y.lane(lane)};
    for (int k = 0; k < 2; ++k)
        out.points[k] = {{found.x[k].lane(lane), found.y[k].lane(lane)},
                         found.gap[k].lane(lane),
                         number(found.feature[k].lane(lane))};
    out.count = static_cast<int>(number(found.count.lane(lane)));
    if (found.missed.lane(lane) > S(0))
        touch_box_corner(pair, (number(found.edges.lane(lane)) >> 1 & 1u) != 0, out.normal, found.apart.lane(lane),
                         margin, out);
}

/// The manifolds of W pairs.
template <class S, int W>
void collide_box_lanes(const box_pair<S, 2>* pairs, S margin, manifold<S, 2>* out) {
    using P = pack<S, W>;
    box_lanes2<P> in;
    for (int i = 0; i < W; ++i) {
        const box_pair<S, 2>& pair = pairs[i];
        in.ax.set_lane(i, pair.a->half_extents.x);
        in.ay.set_lane(i, pair.a->half_extents.y);
        in.bx.set_lane(i, pair.b->half_extents.x);
        in.by.set_lane(i, pair.b->half_extents.y);
        in.px.set_lane(i, pair.b_in_a->position.x);
        in.py.set_lane(i, pair.b_in_a->position.y);
        in.cosine.set_lane(i, pair.b_in_a->rotation.cosine);
        in.sine.set_lane(i, pair.b_in_a->rotation.sine);
    }
    const box_contact_lanes2<P> found = touch_boxes(in, P::broadcast(margin));
    for (int i = 0; i < W; ++i) write_box_contact(found, i, pairs[i], margin, out[i]);
}

/// out[i] becomes what collide() of pair i gives from an empty manifold, bit for bit, whatever `count` is.
template <class S>
void collide_boxes(const box_pair<S, 2>* pairs, std::uint32_t count, S margin, manifold<S, 2>* out) {
    constexpr std::uint32_t width = native_width<S>;
    std::uint32_t i = 0;
    for (; count - i >= width; i += width) collide_box_lanes<S, width>(pairs + i, margin, out + i);
    if (i == count) return;
    // The lanes that are left over repeat a pair.
    box_pair<S, 2> last[width];
    manifold<S, 2> found[width];
    for (std::uint32_t k = 0; k < width; ++k) last[k] = pairs[k < count - i ? i + k : i];
    collide_box_lanes<S, width>(last, margin, found);
    for (std::uint32_t k = 0; k < count - i; ++k) out[i + k] = found[k];
}

}  // namespace detail

/// Contact of two boxes: four separating axes and clipping, or the nearest corners. To keep the features of bodies at
/// rest, contacts may deviate by 1/512 of the smallest half extent, never more. Cost: 28-33 ns, in batches 14 a pair;
/// corners 40 ns more.
template <class S>
void collide(const box<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    // Equal lanes, as one scalar's selections would become branches that nothing predicts.
    using P = detail::pack<S, detail::native_width<S>>;
    const auto same = [](S x) { return P::broadcast(x); };
    const detail::box_lanes2<P> in{same(a.half_extents.x),       same(a.half_extents.y),    same(b.half_extents.x),
                                   same(b.half_extents.y),       same(b_in_a.position.x),   same(b_in_a.position.y),
                                   same(b_in_a.rotation.cosine), same(b_in_a.rotation.sine)};
    detail::write_box_contact(detail::touch_boxes(in, same(margin)), 0, {&a, &b, &b_in_a}, margin, out);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/box_axes3.hpp
// =================================================================================================
// The search for the axis that parts two boxes in space best, in lanes across pairs.

PHYSICS_HPP_BEGIN

namespace detail {

/// Pairs of boxes in lanes: the arithmetic of their 15 axes, the same bits at any width.
template <class P>
struct box_lanes {
    using S = typename P::scalar;

    P half_a[3], half_b[3];
    /// From A's centre to B's, in A's frame and in B's.
    P offset[3], offset_in_b[3];
    /// Coordinate i of B's axis j.
    P turn[3][3];
    /// What a few roundings may come to, and what deviation is small (m).
    P rounding, slack;

    /// Fills in what follows from the half extents, the offset and B's rotation.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const P& x, const P& y, const P& z, const P& w) {
        const P one = P::broadcast(S(1)), x2 = x + x, y2 = y + y, z2 = z + z;
        turn[0][0] = one - lane_sum(y, y2, z, z2);
        turn[1][0] = lane_sum(x, y2, w, z2);
        turn[2][0] = lane_difference(x, z2, w, y2);
        turn[0][1] = lane_difference(x, y2, w, z2);
        turn[1][1] = one - lane_sum(x, x2, z, z2);
        turn[2][1] = lane_sum(y, z2, w, x2);
        turn[0][2] = lane_sum(x, z2, w, y2);
        turn[1][2] = lane_difference(y, z2, w, x2);
        turn[2][2] = one - lane_sum(x, x2, y, y2);
        for (int j = 0; j < 3; ++j) offset_in_b[j] = lane_dot(offset, turn[0][j], turn[1][j], turn[2][j]);
        const P smallest = min(min(half_a[0], min(half_a[1], half_a[2])), min(half_b[0], min(half_b[1], half_b[2])));
        P size = max(half_a[0], max(half_a[1], half_a[2])) + max(half_b[0], max(half_b[1], half_b[2])) +
                 max(lane_abs(offset[0]), max(lane_abs(offset[1]), lane_abs(offset[2])));
        if constexpr (is_fixed<S>) size = max(size, one);
        rounding = P::broadcast(rounding_of(S(1))) * size;
        slack = max(smallest * P::broadcast(S(1.0 / 512)), rounding);
    }
    /// How far the faces of A across axis i part the boxes.
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_a(int i) const {
        return lane_abs(offset[i]) - half_a[i] -
               lane_dot(half_b, lane_abs(turn[i][0]), lane_abs(turn[i][1]), lane_abs(turn[i][2]));
    }
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_b(int j) const {
        return lane_abs(offset_in_b[j]) - half_b[j] -
               lane_dot(half_a, lane_abs(turn[0][j]), lane_abs(turn[1][j]), lane_abs(turn[2][j]));
    }
    /// How far the normal across axis i of A and axis j of B parts the boxes; `scale` becomes 1 / sine of their angle.
    /// Edges so nearly parallel that a face says the same part nothing.
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_edges(int i, int j, P& scale) const {
        const int u = i < 2 ? i + 1 : 0, v = i > 0 ? i - 1 : 2, k = j < 2 ? j + 1 : 0, l = j > 0 ? j - 1 : 2;
        const P sine = lane_length(turn[u][j], turn[v][j]);
        // No sine that counts is smaller, since the slack is not.
        scale = P::broadcast(S(1)) / max(sine, P::broadcast(rounding_of(S(1))));
        // The normal's coordinates, at v and, negated, at u.
        const P p = turn[u][j] * scale, q = turn[v][j] * scale;
        const P along = lane_difference(offset[v], p, offset[u], q);
        const P reach_a = lane_sum(half_a[u], lane_abs(q), half_a[v], lane_abs(p));
        // B's axis j lies across it. By the true products, since sums of entries err by more where the sine is small.
        const P reach_b = lane_sum(half_b[k], lane_abs(lane_difference(turn[v][k], p, turn[u][k], q)), half_b[l],
                                   lane_abs(lane_difference(turn[v][l], p, turn[u][l], q)));
        return select_greater(sine * (half_a[i] + half_b[j]), slack, lane_abs(along) - reach_a - reach_b,
                              P::broadcast(-scalar_traits<S>::max()));
    }
};

/// The best of some axes: the first of those that part the boxes the farthest.
template <class P>
struct best_axis {
    using S = typename P::scalar;

    P gap = P::broadcast(-scalar_traits<S>::max()), number = P::broadcast(S(0)), next = number;

    PHYSICS_HPP_ALWAYS_INLINE void weigh(const P& other) {
        number = select_greater(other, gap, next, number);
        gap = max(gap, other);
        next = next + P::broadcast(S(1));
    }
};

/// What the search finds of W pairs. Axes have numbers: 0-2 the faces of A, 3-5 those of B, from 6 on A's axis times 3
/// plus B's axis, of two edges.
template <class S, int W>
struct box_axes {
    using lanes = pack<S, W>;

    /// Of A and of B: the half extents, and the other's centre in its frame.
    alignas(lanes) S half[2][3][W];
    S center[2][3][W];
    /// How B is turned, as a quaternion.
    S rotation[4][W];
    /// In each one's frame, coordinate i of the other's axis j.
    S turn[2][3][3][W];
    S rounding[W], slack[W];
    /// The best face of each and how far it parts the boxes, and the best two edges.
    S face[2][W], face_gap[2][W], edges[W], edge_gap[W];
    /// 1 / sine of the angle of two edges.
    S scale[9][W];
    /// Bit i is set where no gap of lane i is above the margin.
    std::uint32_t meet = 0;

    /// Puts each number of a pair that the search starts from into its row.
    template <class Put>
    PHYSICS_HPP_ALWAYS_INLINE void each_input(const box_pair<S, 3>& pair, const Put& put) {
        for (int i = 0; i < 3; ++i) {
            put(half[0][i], pair.a->half_extents[i]);
            put(half[1][i], pair.b->half_extents[i]);
            put(center[0][i], pair.b_in_a->position[i]);
        }
        const physics::rotation<S, 3>& turned = pair.b_in_a->rotation;
        put(rotation[0], turned.x);
        put(rotation[1], turned.y);
        put(rotation[2], turned.z);
        put(rotation[3], turned.w);
    }
    void put(int lane, const box_pair<S, 3>& pair) {
        each_input(pair, [lane](S(&row)[W], S x) { row[lane] = x; });
    }
    void put_everywhere(const box_pair<S, 3>& pair) {
        each_input(pair, [](S(&row)[W], S x) { lanes::broadcast(x).store(row); });
    }
    static int whole(S number) { return static_cast<int>(static_cast<double>(number)); }
    /// Which axis parts the boxes of a lane that do not meet: of faces the best, and edges only where no face does.
    int parting(int lane, S margin) const {
        const int by = face_gap[1][lane] > face_gap[0][lane] ? 1 : 0;
        return face_gap[by][lane] > margin ? 3 * by + whole(face[by][lane]) : 6 + whole(edges[lane]);
    }
};

/// One search for all lanes, whose pairs have been put in.
template <class S, int W>
void find_axes(S margin, box_axes<S, W>& out) {
    using P = pack<S, W>;
    box_lanes<P> box;
    for (int i = 0; i < 3; ++i) {
        box.half_a[i] = P::load(out.half[0][i]);
        box.half_b[i] = P::load(out.half[1][i]);
        box.offset[i] = P::load(out.center[0][i]);
    }
    box.prepare(P::load(out.rotation[0]), P::load(out.rotation[1]), P::load(out.rotation[2]), P::load(out.rotation[3]));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            box.turn[i][j].store(out.turn[0][i][j]);
            box.turn[i][j].store(out.turn[1][j][i]);
        }
        (-box.offset_in_b[i]).store(out.center[1][i]);
    }
    box.rounding.store(out.rounding);
    box.slack.store(out.slack);

    const P limit = P::broadcast(margin);
    P scale[3];
    best_axis<P> face_a, face_b, edges;
    face_a.weigh(box.gap_of_a(0));
    face_a.weigh(box.gap_of_a(1));
    face_a.weigh(box.gap_of_a(2));
    face_b.weigh(box.gap_of_b(0));
    face_b.weigh(box.gap_of_b(1));
    face_b.weigh(box.gap_of_b(2));
    constexpr std::uint32_t all = (std::uint32_t{1} << W) - 1;
    const P faces = max(face_a.gap, face_b.gap);
    // A shortcut only: edges do not matter where a face parts the boxes.
    if (greater(faces, limit).bits() != all)
        for (int i = 0; i < 3; ++i) {
            edges.weigh(box.gap_of_edges(i, 0, scale[0]));
            edges.weigh(box.gap_of_edges(i, 1, scale[1]));
            edges.weigh(box.gap_of_edges(i, 2, scale[2]));
            for (int j = 0; j < 3; ++j) scale[j].store(out.scale[3 * i + j]);
        }
    face_a.number.store(out.face[0]);
    face_b.number.store(out.face[1]);
    edges.number.store(out.edges);
    face_a.gap.store(out.face_gap[0]);
    face_b.gap.store(out.face_gap[1]);
    edges.gap.store(out.edge_gap);
    out.meet = ~greater(max(faces, edges.gap), limit).bits() & all;
}

/// True if the axis of that number parts the boxes by more than margin; any number is safe. Cost: 20 ns.
template <class S>
bool parted_along(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, int axis, S margin) {
    if (axis < 0 || axis > 14) return false;
    using P = pack<S, 1>;
    box_lanes<P> box;
    for (int i = 0; i < 3; ++i) {
        box.half_a[i] = {a.half_extents[i]};
        box.half_b[i] = {b.half_extents[i]};
        box.offset[i] = {b_in_a.position[i]};
    }
    const rotation<S, 3>& r = b_in_a.rotation;
    box.prepare({r.x}, {r.y}, {r.z}, {r.w});
    P scale;
    const P gap = axis < 3   ? box.gap_of_a(axis)
                  : axis < 6 ? box.gap_of_b(axis - 3)
                             : box.gap_of_edges((axis - 6) / 3, (axis - 6) % 3, scale);
    return gap.value > margin;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/reduce3.hpp
// =================================================================================================
// Four of many contact points that span what all of them hold.

PHYSICS_HPP_BEGIN

namespace detail {

/// The most points that reduce() chooses from.
inline constexpr int most_candidates = 72;

/// Points of a plane in lanes, each with a depth.
template <class P>
struct flat_points {
    P u, v, separation;
};

/// Takes points one by one, by score. `Source` has the points from about their middle, in packs, of which the last is
/// filled up with copies of others.
template <class Source>
struct point_choice {
    using P = typename Source::lanes;
    using S = typename P::scalar;
    static constexpr bool one = Source::most_packs == 1;

    const Source& source;
    int packs;
    P scores[Source::most_packs];
    /// Which points are not taken.
    std::uint32_t free[Source::most_packs];

    PHYSICS_HPP_ALWAYS_INLINE point_choice(const Source& from, int count)
        : source(from), packs(one ? 1 : (count + P::width - 1) / P::width) {
        for (int i = 0; i < packs; ++i) free[i] = (1u << P::width) - 1;
        free[packs - 1] >>= packs * P::width - count;
    }
    /// The highest of all scores, of points taken as well.
    template <class Score>
    PHYSICS_HPP_ALWAYS_INLINE S weigh(const Score& score) {
        P high = scores[0] = score(source.points(0));
        for (int i = 1; i < packs; ++i) {
            scores[i] = score(source.points(i));
            high = max(high, scores[i]);
        }
        return greatest_lane(high);
    }
    /// Takes the first point whose score is about that high, or where all of these are taken the first that is not.
    PHYSICS_HPP_ALWAYS_INLINE int take(S highest) {
        const P least = P::broadcast(highest * S(31.0 / 32));
        int best = 0, first = 0;
        std::uint32_t bits = 0;
        for (int i = packs - 1; i >= 0; --i) {
            const std::uint32_t here = free[i] & ~greater(least, scores[i]).bits();
            if (one || here != 0) bits = here, best = i;
            if (one || free[i] != 0) first = i;
        }
        if (bits == 0) bits = free[best = first];
        free[best] &= ~(bits & (0u - bits));
        return P::width * best + std::countr_zero(bits);
    }
};

/// The point that lies the farthest beyond a side of a triangle, whose corners go clockwise, times that side's length.
template <class S, class Source>
int beyond_triangle(const Source& source, int count, const int (&corner)[3]) {
    int best = -1;
    S highest{};
    for (int i = 0; i < count; ++i) {
        S score = -scalar_traits<S>::max();
        for (int k = 0; k < 3; ++k) {
            const int from = corner[k], to = corner[k < 2 ? k + 1 : 0];
            const S u = source.u(i) - source.u(from), v = source.v(i) - source.v(from);
            score =
                max(score, difference_of_products(v, source.u(to) - source.u(from), u, source.v(to) - source.v(from)));
        }
        const bool taken = i == corner[0] || i == corner[1] || i == corner[2];
        if (taken || (best >= 0 && !(score > highest + abs(highest) * S(1.0 / 32)))) continue;
        best = i;
        highest = score;
    }
    return best;
}

/// Four of at least as many points, by number: the deepest, the farthest beside it, then the points that open the
/// widest triangles on the sides of what the others span. Depth counts before distance, so that no overlap is left
/// without a point near it. Among points that are alike, depths within `slack` and distances within a few percent, the
/// first wins: rounding would choose others in each step.
template <class Source, class S>
void choose_four(const Source& source, int count, S slack, int (&chosen)[4]) {
    using P = typename Source::lanes;
    using points = flat_points<P>;
    struct place {
        P u, v;
    };
    const auto at = [&](int i) { return place{P::broadcast(source.u(i)), P::broadcast(source.v(i))}; };
    point_choice<Source> left(source, count);
    P low = source.points(0).separation;
    for (int i = 1; i < left.packs; ++i) low = min(low, source.points(i).separation);
    const P most = P::broadcast(slack - greatest_lane(-low)), none = P::broadcast(S(-1));
    // The first is one of the deepest; of those that are alike the one farthest out.
    chosen[0] = left.take(left.weigh(
        [&](const points& p) { return select_greater(p.separation, most, none, lane_sum(p.u, p.u, p.v, p.v)); }));
    const place a = at(chosen[0]);
    chosen[1] = left.take(left.weigh([&](const points& p) {
        const P du = p.u - a.u, dv = p.v - a.v;
        return lane_sum(du, du, dv, dv);
    }));
    // How far on the right of the line from one place to another, times their distance.
    const auto beside = [](const place& from, const place& to, const points& p) {
        return lane_difference(p.u - from.u, to.v - from.v, p.v - from.v, to.u - from.u);
    };
    const place b = at(chosen[1]);
    point_choice<Source> right = left;
    const S on_left = left.weigh([&](const points&p) { return -beside(a, b, p); }),
            on_right = right.weigh([&](const points&p) { return beside(a, b, p); });
    chosen[2] = right.take(on_right);
    chosen[3] = left.take(on_left);
    // Where one side holds next to nothing, there may be more beyond the triangle's others.
    if (S(8) * min(on_left, on_right) > max(on_left, on_right)) return;
    const bool clockwise = on_right > on_left;
    if (!clockwise) chosen[2] = chosen[3];
    const int triangle[3] = {chosen[0], chosen[clockwise ? 1 : 2], chosen[clockwise ? 2 : 1]};
    chosen[3] = beyond_triangle<S>(source, count, triangle);
}

/// Contact points as seen along a normal, from their middle.
template <class S>
struct seen_points {
    /// There may be many, and few pairs have them: scalars compile faster.
    using lanes = pack<S, 1>;
    static constexpr int most_packs = most_candidates;

    flat_points<lanes> all[most_candidates];

    seen_points(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal) {
        const vec<S, 3> first = candidates[0].position, u_axis = perpendicular(normal), v_axis = cross(normal, u_axis);
        vec<S, 3> middle;
        for (int i = 0; i < count; ++i) middle += (candidates[i].position - first) / S(count);
        for (int i = 0; i < count; ++i) {
            const vec<S, 3> from = candidates[i].position - first - middle;
            all[i] = {{dot(u_axis, from)}, {dot(v_axis, from)}, {candidates[i].separation}};
        }
    }
    S u(int i) const { return all[i].u.value; }
    S v(int i) const { return all[i].v.value; }
    const flat_points<lanes>& points(int i) const { return all[i]; }
};

/// Adds up to four of the candidates to the manifold, which choose_four() chooses across the normal.
template <class S>
void reduce(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal, S slack, manifold<S, 3>& out) {
    if (count <= manifold<S, 3>::capacity) {
        for (int i = 0; i < count; ++i) out.points[out.count++] = candidates[i];
        return;
    }
    int chosen[4];
    choose_four(seen_points<S>(candidates, count, normal), count, slack, chosen);
    for (const int i : chosen) out.points[out.count++] = candidates[i];
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/clip3.hpp
// =================================================================================================
// The faces of two boxes in space, clipped to what they share.

PHYSICS_HPP_BEGIN

namespace detail {

/// The coordinate that follows another, round and round.
inline constexpr int next_coordinate[3] = {1, 2, 0};

/// x by magnitude, without a branch.
template <class S>
constexpr S size_of(S x) {
    return max(x, -x);
}
/// -1 or 1; by address, since signs are hard to predict.
template <class S>
S sign_of(bool positive) {
    const S signs[2] = {S(-1), S(1)};
    return signs[positive];
}

/// The normal across an edge of A and one of B, from A to B, both given by their axes.
template <class S>
struct edge_normal {
    int a, b;
    S normal[3];
};

/// A face as seen along a normal from the reference face: where on that it lies, and how far beyond it.
template <class S>
struct seen_face {
    /// Each by u, v and separation: the middle, and what one metre along each of two sides adds.
    S middle[3], along[2][3];
    S half[2];
};

/// What is left of a face within limits: where its edges start (0-3) and where they were cut off (4-7), and the corners
/// of the limits (8-11).
template <class S>
struct clipped_face {
    S u[12], v[12], separation[12];
    /// A point's name: two of the face's edges 0-3 and of the limits 4-7.
    S name[12];
    /// Which points exist within the margin, and whether any is as deep as it must be.
    std::uint32_t within = 0;
    bool deep = false;

    PHYSICS_HPP_ALWAYS_INLINE void put(int at, const pack<S, 4>& pu, const pack<S, 4>& pv, const pack<S, 4>& depth,
                                       const pack<S, 4>& names, std::uint32_t exist, S most, S margin) {
        using P = pack<S, 4>;
        pu.store(u + at);
        pv.store(v + at);
        depth.store(separation + at);
        names.store(name + at);
        within |= (exist & ~greater(depth, P::broadcast(margin)).bits()) << at;
        deep = deep || (exist & ~greater(depth, P::broadcast(most)).bits()) != 0;
    }
};

/// Eight of the points that are left of a face, by number.
template <class S>
struct picked_points {
    /// Of vectors of 16 bytes at most, which scalars fill.
    using lanes = pack < S, 8, vector_bytes<16 ? vector_bytes : 16>;
    static constexpr int most_packs = 1;

    flat_points<lanes> all;
    S at_u[8], at_v[8];

    PHYSICS_HPP_ALWAYS_INLINE picked_points(const clipped_face<S>& face, const int (&numbers)[12])
        : all{row(face.u, numbers), row(face.v, numbers), row(face.separation, numbers)} {
        all.u.store(at_u);
        all.v.store(at_v);
    }
    PHYSICS_HPP_ALWAYS_INLINE static lanes row(const S* from, const int* n) {
        using half = typename lanes::half;
        return {lanes_of<half>(from[n[0]], from[n[1]], from[n[2]], from[n[3]]),
                lanes_of<half>(from[n[4]], from[n[5]], from[n[6]], from[n[7]])};
    }
    S u(int i) const { return at_u[i]; }
    S v(int i) const { return at_v[i]; }
    PHYSICS_HPP_ALWAYS_INLINE const flat_points<lanes>& points(int) const { return all; }
};

/// Four corners, from the middle along +a +b, -a +b, -a -b, +a -b.
template <class S>
PHYSICS_HPP_ALWAYS_INLINE pack<S, 4> corners_of(S middle, S a, S b) {
    using P = pack<S, 4>;
    if constexpr (native_width < S >> 1) {
        constexpr S outer[4] = {1, -1, -1, 1}, upper[4] = {1, 1, -1, -1};
        return P::broadcast(middle) + P::broadcast(a) * P::load(outer) + P::broadcast(b) * P::load(upper);
    } else {
        const S high = middle + a, low = middle - a;
        return lanes_of<P>(high + b, low + b, low - b, high - b);
    }
}
/// In each lane what the next one holds, round and round.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P next_of(const P& x) {
    return lanes_of<P>(x.lane(1), x.lane(2), x.lane(3), x.lane(0));
}

/// Cuts a face down to |u| <= limit_u, |v| <= limit_v, and keeps what is within the margin. Each edge goes for itself,
/// all four in lanes. Source: Liang, Barsky, A new concept and method for line clipping (1984).
template <class S>
PHYSICS_HPP_ALWAYS_INLINE void clip_face(const seen_face<S>& face, S limit_u, S limit_v, S rounding, S most, S margin,
                                         clipped_face<S>& out) {
    using P = pack<S, 4>;
    const auto &m = face.middle, &x = face.along[0], &y = face.along[1];
    const S xu = x[0] * face.half[0], xv = x[1] * face.half[0], xs = x[2] * face.half[0];
    const S yu = y[0] * face.half[1], yv = y[1] * face.half[1], ys = y[2] * face.half[1];
    const P u = corners_of(m[0], xu, yu), v = corners_of(m[1], xv, yv), s = corners_of(m[2], xs, ys);
    const P corner = lanes_of<P>(S(0), S(0x11), S(0x22), S(0x33));
    const S beyond_u = size_of(m[0]) + size_of(xu) + size_of(yu) - limit_u,
            beyond_v = size_of(m[1]) + size_of(xv) + size_of(yv) - limit_v;
    if (!(max(beyond_u, beyond_v) > S(0))) {
        out.put(0, u, v, s, corner, 0xfu, most, margin);
        return;
    }

    const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), hair = P::broadcast(rounding);
    const P reach_u = P::broadcast(limit_u), reach_v = P::broadcast(limit_v);
    const P du = next_of(u) - u, dv = next_of(v) - v, ds = next_of(s) - s;
    // How far the ends lie beyond the limits, as shares of the edge's extent across them. The two shares of an edge
    // that lies beyond make more than the whole.
    const P extent_u = max(lane_abs(du), hair), extent_v = max(lane_abs(dv), hair);
    const P over_u = max(lane_abs(u) - reach_u, zero), over_v = max(lane_abs(v) - reach_v, zero);
    const P start_u = over_u / extent_u, start_v = over_v / extent_v;
    const P stop_u = next_of(over_u) / extent_u, stop_v = next_of(over_v) / extent_v;
    const P start = min(max(start_u, start_v), one), rest = min(max(stop_u, stop_v), one), stop = one - rest;
    const P name_u = select_greater(zero, u, P::broadcast(S(5)), P::broadcast(S(4))),
            name_v = select_greater(zero, v, P::broadcast(S(7)), P::broadcast(S(6)));
    const P start_name =
        select_greater(start_u, start_v, name_u, name_v) * P::broadcast(S(0x10)) + lanes_of<P>(S(0), S(1), S(2), S(3));
    const P stop_name =
        select_greater(stop_u, stop_v, next_of(name_u), next_of(name_v)) + lanes_of<P>(S(0), S(0x10), S(0x20), S(0x30));
    const std::uint32_t left = greater(stop, start).bits(), cut = greater(rest, zero).bits();
    out.put(0, u + du * start, v + dv * start, s + ds * start, select_greater(start, zero, start_name, corner),
            left | (~greater(start, zero).bits() & 0xfu), most, margin);
    out.put(4, u + du * stop, v + dv * stop, s + ds * stop, stop_name, left & cut, most, margin);

    // The corners of the limits, by how far along the face's sides they lie. Those that miss the face by a hair count:
    // the edge that passes there may have been lost to rounding.
    const P corner_u = corners_of(S(0), limit_u, S(0)), corner_v = corners_of(S(0), S(0), limit_v);
    const P from_u = corner_u - P::broadcast(m[0]), from_v = corner_v - P::broadcast(m[1]);
    const P scale = P::broadcast(S(1) / difference_of_products(x[0], y[1], x[1], y[0]));
    const P at_x = lane_difference(from_u, P::broadcast(y[1]), from_v, P::broadcast(y[0])) * scale;
    const P at_y = lane_difference(from_v, P::broadcast(x[0]), from_u, P::broadcast(x[1])) * scale;
    const P half_x = P::broadcast(face.half[0]), half_y = P::broadcast(face.half[1]);
    const P outside = max(lane_abs(at_x) - half_x, lane_abs(at_y) - half_y);
    const P depth = P::broadcast(m[2]) + lane_sum(P::broadcast(x[2]), max(-half_x, min(half_x, at_x)),
                                                  P::broadcast(y[2]), max(-half_y, min(half_y, at_y)));
    out.put(8, corner_u, corner_v, depth, lanes_of<P>(S(0x46), S(0x56), S(0x57), S(0x47)),
            ~greater(outside, hair + hair).bits() & 0xfu, most, margin);
}

/// Clips the face of the other box that faces the best face of the reference box to the latter's sides, and adds what
/// is left within the margin. The reference box is A (0) or B (1). The normal is its face's, or the `lean` if that is
/// not null (the reference is A then); gap is how far it parts the boxes. False, with nothing added, if the point in
/// which it finds the other box closest was cut off: then the boxes do not touch face to face.
template <class S, int W>
bool clip_faces(const box_axes<S, W>& boxes, int lane, int reference, const edge_normal<S>* lean, S gap, S margin,
                manifold<S, 3>& out) {
    const int w = boxes.whole(boxes.face[reference][lane]), u = next_coordinate[w], v = next_coordinate[u];
    const auto& center = boxes.center[reference];
    const auto &half = boxes.half[reference], &other = boxes.half[1 - reference];
    const S sign = sign_of<S>(!(center[w][lane] < S(0))), slack = boxes.slack[lane];
    const auto &turn_u = boxes.turn[reference][u], &turn_v = boxes.turn[reference][v],
               &turn_w = boxes.turn[reference][w];
    // A lower number wins unless another face is clearly better, so that rounding does not choose.
    const S facing[3] = {size_of(turn_w[0][lane]), size_of(turn_w[1][lane]), size_of(turn_w[2][lane])};
    int across = facing[1] > facing[0] + S(1.0 / 1024) ? 1 : 0;
    across = facing[2] > facing[across] + S(1.0 / 1024) ? 2 : across;
    const bool upper = !(turn_w[across][lane] * sign > S(0));
    const S depth = sign_of<S>(upper) * other[across][lane];

    seen_face<S> face;
    const int x = next_coordinate[across], y = next_coordinate[x];
    face.middle[0] = center[u][lane] + turn_u[across][lane] * depth;
    face.middle[1] = center[v][lane] + turn_v[across][lane] * depth;
    face.middle[2] = (center[w][lane] + turn_w[across][lane] * depth) * sign - half[w][lane];
    face.along[0][0] = turn_u[x][lane];
    face.along[0][1] = turn_v[x][lane];
    face.along[0][2] = turn_w[x][lane] * sign;
    face.along[1][0] = turn_u[y][lane];
    face.along[1][1] = turn_v[y][lane];
    face.along[1][2] = turn_w[y][lane] * sign;
    face.half[0] = other[x][lane];
    face.half[1] = other[y][lane];
    S normal[3];
    normal[u] = normal[v] = S(0);
    normal[w] = sign;
    if (lean != nullptr) {
        for (int k = 0; k < 3; ++k) normal[k] = lean->normal[k];
        const S steep = S(1) / (normal[w] * sign), lean_u = normal[u] * steep, lean_v = normal[v] * steep;
        const auto lean_back = [&](S(&place)[3]) {
            place[0] -= lean_u * place[2];
            place[1] -= lean_v * place[2];
            place[2] *= steep;
        };
        lean_back(face.middle);
        lean_back(face.along[0]);
        lean_back(face.along[1]);
    }
    // A little beyond the face, so that rounding does not decide whether the corners of equal boxes are cut, and named
    // anew, in each step.
    clipped_face<S> left;
    clip_face(face, half[u][lane] + slack, half[v][lane] + slack, boxes.rounding[lane], gap + slack + slack, margin,
              left);
    if (!left.deep) return false;

    int count = 0, numbers[12] = {}, chosen[4] = {};
    for (std::uint32_t bits = left.within; bits != 0; bits &= bits - 1) numbers[count++] = std::countr_zero(bits);
    if (count > 4) {
        // More than eight there are only where rounding makes two of one.
        for (int i = count; i < 8; ++i) numbers[i] = numbers[0];
        choose_four(picked_points<S>(left, numbers), count < 8 ? count : 8, slack, chosen);
        count = 4;
    } else {
        for (int k = 0; k < count; ++k) chosen[k] = k;
    }
    for (int& k : chosen) k = numbers[k];
    using P = pack<S, 4>;
    const auto picked = [&](const S* from) {
        return lanes_of<P>(from[chosen[0]], from[chosen[1]], from[chosen[2]], from[chosen[3]]);
    };
    const P separations = picked(left.separation), halfway = separations * P::broadcast(S(0.5));
    P p[3];
    p[u] = picked(left.u);
    p[v] = picked(left.v);
    p[w] = P::broadcast(half[w][lane] * sign) + halfway * P::broadcast(normal[w]);
    if (lean != nullptr) {
        p[u] += halfway * P::broadcast(normal[u]);
        p[v] += halfway * P::broadcast(normal[v]);
    }
    if (reference != 0) {
        const P q[3] = {p[0], p[1], p[2]};
        for (int k = 0; k < 3; ++k) {
            const auto& axes = boxes.turn[0][k];
            normal[k] = -axes[w][lane] * sign;
            p[k] = P::broadcast(boxes.center[0][k][lane]) +
                   lane_dot(q, P::broadcast(axes[0][lane]), P::broadcast(axes[1][lane]), P::broadcast(axes[2][lane]));
        }
    }
    S at[4][4];
    for (int k = 0; k < 3; ++k) p[k].store(at[k]);
    separations.store(at[3]);
    out.normal = {normal[0], normal[1], normal[2]};
    const auto faces =
        static_cast<std::uint32_t>(reference << 16 | (2 * w + int{sign > S(0)}) << 12 | (2 * across + int{upper}) << 8);
    for (int k = 0; k < count; ++k) {
        const auto name = static_cast<std::uint32_t>(boxes.whole(left.name[chosen[k]]));
        out.points[out.count + k] = {{at[0][k], at[1][k], at[2][k]}, at[3][k], faces | name};
    }
    out.count += count;
    return true;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/segment.hpp
// =================================================================================================
// Closest points on segments, and segments cut by planes.

PHYSICS_HPP_BEGIN

/// Where the point of the segment a-b closest to p lies: 0 at a, 1 at b. Source: Ericson, Real-Time
/// Collision Detection, 5.1.2.
template <class S, int D>
constexpr S closest_parameter(vec<S, D> a, vec<S, D> b, vec<S, D> p) {
    const vec<S, D> d = b - a;
    const wide_of<S> along = wide_dot(p - a, d);
    const wide_of<S> whole = length_squared(d);
    if (!(along > wide_of<S>{})) return S(0);
    if (!(along < whole)) return S(1);
    return quotient<S>(along, whole);
}

/// Where on two segments the points lie that are closest to each other, as distances from their middles.
template <class S>
struct segment_parameters {
    S on_a{};
    S on_b{};
};

/// The closest points of the segment |x| <= half_a of the coordinate axis a, and of the segment
/// center + t * b, |t| <= half_b, of unit direction b. For parallel segments one of the pairs that are closest.
/// Seen along the axis this is a point and a line, which keeps its precision where the two are nearly parallel.
template <class S>
constexpr segment_parameters<S> closest_to_axis(int a, S half_a, vec<S, 3> center, vec<S, 3> b, S half_b) {
    vec<S, 3> beside = center, across = b;
    beside[a] = across[a] = S(0);
    const auto [direction, sine] = split(across);
    const S along = -dot(beside, direction), most = half_b * sine;
    S t = !(along < most) ? half_b : !(along > -most) ? -half_b : along / sine;
    S s = clamp(center[a] + b[a] * t, -half_a, half_a);
    t = clamp(b[a] * s - dot(b, center), -half_b, half_b);
    s = clamp(center[a] + b[a] * t, -half_a, half_a);
    return {s, t};
}

/// Cuts a segment middle + t * direction, start <= t <= stop, seen along one coordinate, down to what lies
/// within |p| <= limit; false if nothing does.
template <class S>
constexpr bool clip_segment(S middle, S direction, S limit, S& start, S& stop) {
    const S sides[2] = {S(-1), S(1)};
    for (const S side : sides) {
        const S at_start = side * (middle + direction * start) - limit,
                at_stop = side * (middle + direction * stop) - limit;
        if (at_start > S(0) && at_stop > S(0)) return false;
        if (at_start > S(0))
            start += (stop - start) * (at_start / (at_start - at_stop));
        else if (at_stop > S(0))
            stop -= (stop - start) * (at_stop / (at_stop - at_start));
    }
    return true;
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/box3.hpp
// =================================================================================================
// Contact of two boxes in space: separating axes, then clipping, a pair of edges, or the nearest corner.

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds the closest points of an edge of A and an edge of B. False, with nothing added, if they are not what the
/// normal found closest.
template <class S, int W>
bool touch_edges(const box_axes<S, W>& boxes, int lane, const edge_normal<S>& e, S gap, manifold<S, 3>& out) {
    // A's edge lies along w, B's along its axis z.
    const int w = e.a, u = next_coordinate[w], v = next_coordinate[u];
    const int z = e.b, x = next_coordinate[z], y = next_coordinate[x];
    const S nu = e.normal[u], nv = e.normal[v];
    const auto turn = [&](int i, int j) { return boxes.turn[0][i][j][lane]; };
    const bool u_up = nu > S(0), v_up = nv > S(0);
    const bool x_up = sum_of_products(turn(u, x), nu, turn(v, x), nv) < S(0),
               y_up = sum_of_products(turn(u, y), nu, turn(v, y), nv) < S(0);
    const S half_a = boxes.half[0][w][lane], half_b = boxes.half[1][z][lane];
    const S on_u = sign_of<S>(u_up) * boxes.half[0][u][lane], on_v = sign_of<S>(v_up) * boxes.half[0][v][lane];
    const S on_x = sign_of<S>(x_up) * boxes.half[1][x][lane], on_y = sign_of<S>(y_up) * boxes.half[1][y][lane];
    // From the middle of A's edge to that of B's, and the direction of B's.
    const auto offset = [&](int i) {
        return boxes.center[0][i][lane] + sum_of_products(turn(i, x), on_x, turn(i, y), on_y);
    };
    const S ow = offset(w), ou = offset(u) - on_u, ov = offset(v) - on_v;
    const S dw = turn(w, z), du = turn(u, z), dv = turn(v, z);
    // Seen along A's edge, a point and a line: this keeps its precision where the edges are nearly parallel.
    const S scale = boxes.scale[3 * w + z][lane], su = du * scale, sv = dv * scale;
    const S most = half_b * sum_of_products(du, su, dv, sv), along = -sum_of_products(ou, su, ov, sv);
    const auto within = [](S value, S limit) { return max(-limit, min(limit, value)); };
    S t = within(along, most) * scale;
    S s = within(ow + dw * t, half_a);
    t = within(dw * s - narrow<S>(product(dw, ow) + product(du, ou) + product(dv, ov)), half_b);
    s = within(ow + dw * t, half_a);
    const S bw = ow + dw * t - s, bu = ou + du * t, bv = ov + dv * t;
    const S apart = max(size_of(bw), max(size_of(bu - nu * gap), size_of(bv - nv * gap)));
    if (apart > boxes.slack[lane]) return false;
    S p[3];
    p[w] = s + bw * S(0.5);
    p[u] = on_u + bu * S(0.5);
    p[v] = on_v + bv * S(0.5);
    out.normal = {e.normal[0], e.normal[1], e.normal[2]};
    const int name_a = w << 2 | int{u_up} << 1 | int{v_up}, name_b = z << 2 | int{x_up} << 1 | int{y_up};
    out.add({p[0], p[1], p[2]}, gap, static_cast<std::uint32_t>(0x20000 | name_a << 4 | name_b));
    return true;
}

/// A corner of one box and the point of another box that is closest to it.
template <class S>
struct corner_distance {
    /// In the other box's frame: the corner, and how far beyond the other box it lies.
    vec<S, 3> corner, offset;
    vec<S, 3> direction;
    S gap{};
    std::uint32_t number = 0;

    /// Where the other box is closest: along each axis inside (0), at its lower end (1) or at its upper (2).
    std::uint32_t region(int k) const { return offset[k] > S(0) ? 2u : offset[k] < S(0) ? 1u : 0u; }
};
/// Of a box by its centre, axes and half extents, seen from another.
template <class S>
corner_distance<S> closest_corner(vec<S, 3> center, const mat<S, 3>& axes, vec<S, 3> half, vec<S, 3> whole) {
    corner_distance<S> best;
    wide_of<S> least{};
    for (std::uint32_t i = 0; i < 8; ++i) {
        vec<S, 3> p = center;
        for (int k = 0; k < 3; ++k) p += axes.column[k] * ((i >> k & 1u) != 0 ? half[k] : -half[k]);
        const vec<S, 3> beyond = p - max(-whole, min(whole, p));
        const wide_of<S> distance = length_squared(beyond);
        if (i > 0 && !(distance < least)) continue;
        least = distance;
        best.corner = p;
        best.offset = beyond;
        best.number = i;
    }
    const auto [direction, gap] = split(best.offset);
    best.direction = direction;
    best.gap = gap;
    return best;
}

/// Adds the closest pair of a corner of one box and a point of the other, for boxes that do not overlap. `n` is
/// the best separating axis, from A to B, and `parted` how far it parts them.
template <class S, int W>
void touch_corner(const box_axes<S, W>& boxes, int lane, vec<S, 3> n, S parted, S margin, manifold<S, 3>& out) {
    const auto row = [&](const auto& from) { return vec<S, 3>{from[0][lane], from[1][lane], from[2][lane]}; };
    const vec<S, 3> half_a = row(boxes.half[0]), half_b = row(boxes.half[1]), offset = row(boxes.center[0]);
    const mat<S, 3> to_b{{row(boxes.turn[0][0]), row(boxes.turn[0][1]), row(boxes.turn[0][2])}},
        axes = transposed(to_b);
    const corner_distance<S> of_a = closest_corner(row(boxes.center[1]), to_b, half_a, half_b),
                             of_b = closest_corner(offset, axes, half_b, half_a);
    const auto parts = [&](vec<S, 3> m) { return dot(m, offset) - dot(abs(m), half_a) - dot(abs(to_b * m), half_b); };
    // Where both are as close, one of the normals may be chance; and so may both where all but coincides.
    const vec<S, 3> from_a = -(axes * of_a.direction);
    const S by_a = parts(from_a), by_b = parts(of_b.direction);
    const bool use_a = by_a > by_b;
    const corner_distance<S>& best = use_a ? of_a : of_b;
    const bool clear = best.gap > S(0) && !(max(by_a, by_b) < parted - boxes.rounding[lane]);
    out.normal = !clear ? n : use_a ? from_a : best.direction;
    const S gap = clear ? best.gap : parted;
    if (gap > margin) return;
    vec<S, 3> corner = best.corner;
    if (use_a)
        for (int k = 0; k < 3; ++k) corner[k] = sign_of<S>((best.number >> k & 1u) != 0) * half_a[k];
    // Two corners have one name, whichever was found.
    const std::uint32_t x = best.region(0), y = best.region(1), z = best.region(2);
    std::uint32_t feature = 0x80000u | std::uint32_t{use_a} << 12 | (x * 9 + y * 3 + z) << 4 | best.number;
    if (x != 0 && y != 0 && z != 0) {
        const std::uint32_t other = (x - 1) | (y - 1) << 1 | (z - 1) << 2;
        feature = 0x40000u | (use_a ? best.number << 4 | other : other << 4 | best.number);
    }
    out.add(corner + out.normal * ((use_a ? gap : -gap) * S(0.5)), gap, feature);
}

/// Adds the contact of the boxes of a lane, which no axis parts by more than the margin.
template <class S, int W>
void touch_boxes(const box_axes<S, W>& boxes, int lane, S margin, manifold<S, 3>& out) {
    const S gap_a = boxes.face_gap[0][lane], gap_b = boxes.face_gap[1][lane], gap_edges = boxes.edge_gap[lane];
    const S hair = boxes.slack[lane] + boxes.slack[lane];
    const auto meet_at_face = [&](int by) {
        return clip_faces<S>(boxes, lane, by, nullptr, boxes.face_gap[by][lane], margin, out);
    };
    // Faces before edges and A's before B's where they are alike, so that the choice does not flicker.
    const int preferred = gap_b > gap_a + hair ? 1 : 0, better = gap_b > gap_a ? 1 : 0;
    if (!(gap_edges > boxes.face_gap[preferred][lane] + hair) && meet_at_face(preferred)) return;

    if (gap_edges > boxes.face_gap[better][lane]) {
        const int number = boxes.whole(boxes.edges[lane]);
        edge_normal<S> e{number / 3, number % 3, {}};
        const int u = next_coordinate[e.a], v = next_coordinate[u];
        const S su = boxes.turn[0][u][e.b][lane] * boxes.scale[number][lane],
                sv = boxes.turn[0][v][e.b][lane] * boxes.scale[number][lane];
        const S sign =
            sign_of<S>(!(difference_of_products(boxes.center[0][v][lane], su, boxes.center[0][u][lane], sv) < S(0)));
        e.normal[u] = -sv * sign;
        e.normal[v] = su * sign;
        // Faces that all but face each other keep their points where an edge gives the normal.
        const int face = boxes.whole(boxes.face[0][lane]);
        const S upright = boxes.center[0][face][lane] < S(0) ? -e.normal[face] : e.normal[face];
        if (upright > S(0.9986) && clip_faces(boxes, lane, 0, &e, gap_edges, margin, out)) return;
        if (touch_edges(boxes, lane, e, gap_edges, out)) return;
        touch_corner(boxes, lane, {e.normal[0], e.normal[1], e.normal[2]}, gap_edges, margin, out);
        return;
    }
    if (better != preferred && meet_at_face(better)) return;
    const int axis = boxes.whole(boxes.face[better][lane]);
    const S sign = sign_of<S>(!(boxes.center[better][axis][lane] < S(0)));
    vec<S, 3> n;
    n[axis] = sign;
    if (better == 1) {
        const auto& towards = boxes.turn[1][axis];
        n = {-towards[0][lane] * sign, -towards[1][lane] * sign, -towards[2][lane] * sign};
    }
    touch_corner(boxes, lane, n, boxes.face_gap[better][lane], margin, out);
}

/// out[i] becomes what collide() of pair i gives from an empty manifold, bit for bit, whatever `count` is. `parted`,
/// where it is not null, gets the number of the axis that parts pair i by more than the margin, for parted_along();
/// -1 where none does.
template <class S>
void collide_boxes(const box_pair<S, 3>* pairs, std::uint32_t count, S margin, manifold<S, 3>* out,
                   int* parted = nullptr) {
    constexpr std::uint32_t width = native_width<S>;
    for (std::uint32_t first = 0; first < count; first += width) {
        const std::uint32_t here = count - first < width ? count - first : width;
        box_axes<S, static_cast<int>(width)> found;
        for (std::uint32_t i = 0; i < width; ++i) found.put(static_cast<int>(i), pairs[i < here ? first + i : first]);
        find_axes(margin, found);
        for (std::uint32_t i = 0; i < here; ++i) {
            const int lane = static_cast<int>(i);
            const bool meet = (found.meet >> i & 1u) != 0;
            out[first + i] = {};
            if (parted != nullptr) parted[first + i] = meet ? -1 : found.parting(lane, margin);
            if (meet) touch_boxes(found, lane, margin, out[first + i]);
        }
    }
}

}  // namespace detail

/// Contact of two boxes: 15 separating axes, then face clipping with reduction to four points, one point between
/// two edges, or the nearest corner. To keep the features of bodies at rest, contacts may deviate by 1/256 of the
/// smallest half extent, never more. Source: Gottschalk, Lin, Manocha, OBBTree (1996), section 5.
template <class S>
void collide(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, S margin, manifold<S, 3>& out) {
    detail::box_axes<S, detail::native_width<S>> found;
    found.put_everywhere({&a, &b, &b_in_a});
    detail::find_axes(margin, found);
    if (found.meet != 0) detail::touch_boxes(found, 0, margin, out);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/core_shapes.hpp
// =================================================================================================
// The cores of segments, triangles, rounded boxes, cylinders and cones.

PHYSICS_HPP_BEGIN

namespace detail {

/// How far a core with these corners reaches along any direction, or more.
template <int D>
double extent_of_corners(const core<D>& c, int count) {
    double most = 0;
    for (int i = 0; i < count; ++i) {
        double sum = 0;
        for (int k = 0; k < D; ++k) sum += abs(c.corner[i][k]);
        most = max(most, sum);
    }
    return most;
}
inline core<3> core_of_discs(const discs<double>& d) {
    core<3> c;
    c.kind = core_kind::disc;
    c.corner[0] = {d.half, d.low, d.high};
    c.radius = d.rounding;
    c.extent = d.half + max(d.low, d.high);
    // Across the side, or along the axis.
    const double slope = d.low - d.high, side = sqrt(4 * d.half * d.half + slope * slope);
    c.thickness = min(d.half, max(d.low, d.high) * (2 * d.half / side));
    return c;
}

}  // namespace detail

template <class S, int D>
detail::core<D> core_of(const segment<S, D>& s) {
    detail::core<D> c;
    c.kind = detail::core_kind::segment;
    c.corner[0] = detail::to_point(s.a);
    c.corner[1] = detail::to_point(s.b);
    c.center = (c.corner[0] + c.corner[1]) * 0.5;
    c.extent = detail::extent_of_corners(c, 2);
    c.radius = detail::to_double(s.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const triangle<S, D>& t) {
    detail::core<D> c;
    c.kind = detail::core_kind::triangle;
    c.corner[0] = detail::to_point(t.a);
    c.corner[1] = detail::to_point(t.b);
    c.corner[2] = detail::to_point(t.c);
    c.center = c.corner[0] + (c.corner[1] - c.corner[0] + (c.corner[2] - c.corner[0])) * (1.0 / 3);
    c.extent = detail::extent_of_corners(c, 3);
    if (D == 2) c.thickness = 0.5 * detail::sizes_of(t).height;
    c.radius = detail::to_double(t.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const rounded_box<S, D>& b) {
    detail::core<D> c = core_of(box<S, D>{b.half_extents});
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S>
detail::core<3> core_of(const cylinder<S, 3>& c) {
    return detail::core_of_discs(detail::discs_of(c.template as<double>()));
}
template <class S>
detail::core<3> core_of(const cone<S, 3>& c) {
    return detail::core_of_discs(detail::discs_of(c.template as<double>()));
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/simplex.hpp
// =================================================================================================
// The point of a simplex that is closest to the origin.

PHYSICS_HPP_BEGIN

namespace detail {

/// v / |v| for vectors whose squared length double holds; null for the null vector.
template <int D>
point<D> unit(const point<D>& v) {
    const double squared = dot(v, v);
    return squared > 0 ? v * (1 / physics::sqrt(squared)) : point<D>{};
}

/// A vertex of the configuration space obstacle B - A: a point of B as seen from a point of A.
template <int D>
struct cso_vertex {
    point<D> w;
    point<D> on_a;
    /// The vertices of A and B, 16 bits each.
    std::uint32_t name = 0;
};

/// What lies closest to the origin of a simplex: the point, and the vertices that it needs, with their weights.
template <int D>
struct closest_of {
    point<D> at;
    double weight[3] = {};
    int vertex[3] = {0, 1, 2};
    int count = 1;
};

/// Up to D + 1 vertices, and the weights that make of them the point closest to the origin.
template <int D>
struct simplex {
    raw_array<cso_vertex<D>, D + 1> vertex;
    double weight[3] = {};
    int count = 0;

    /// Drops the vertices that the closest point does not need.
    void keep(const closest_of<D>& c) {
        count = c.count;
        for (int i = 0; i < c.count; ++i) {
            if (c.vertex[i] != i) vertex[i] = vertex[c.vertex[i]];
            weight[i] = c.weight[i];
        }
    }
    [[nodiscard]] point<D> on_a() const {
        point<D> p = vertex[0].on_a * weight[0];
        for (int i = 1; i < count && i < 3; ++i) p += vertex[i].on_a * weight[i];
        return p;
    }
};

template <int D>
closest_of<D> closest_on_edge(const point<D>& a, const point<D>& b, int i = 0, int j = 1) {
    const point<D> e = b - a;
    const double along = -dot(a, e), whole = dot(e, e);
    if (!(along > 0)) return {a, {1}, {i}, 1};
    if (!(along < whole)) return {b, {1}, {j}, 1};
    const double t = along / whole;
    // Across the edge to the last digit: where the point is near, the direction of a sum would be rounding.
    point<D> at;
    if constexpr (D == 2) {
        const point<2> n = perpendicular(e);
        at = n * (dot(n, t < 0.5 ? a : b) / whole);
    } else {
        at = t < 0.5 ? a + e * t : b - e * (1 - t);
        at -= e * (dot(at, e) / whole);
    }
    return {at, {1 - t, t}, {i, j}, 2};
}

inline closest_of<3> nearer(const closest_of<3>& a, const closest_of<3>& b) {
    return dot(b.at, b.at) < dot(a.at, a.at) ? b : a;
}

/// Source: Ericson, Real-Time Collision Detection (2005), 5.1.5, with the areas taken from the normal, which keeps
/// their signs where the triangle is small and far away.
inline closest_of<3> closest_on_triangle(const point<3>& a, const point<3>& b, const point<3>& c, int i = 0, int j = 1,
                                         int k = 2) {
    const point<3> ab = b - a, ac = c - a;
    const double a1 = -dot(ab, a), a2 = -dot(ac, a);
    if (a1 <= 0 && a2 <= 0) return {a, {1}, {i}, 1};
    const double b1 = -dot(ab, b), b2 = -dot(ac, b);
    if (b1 >= 0 && b2 <= b1) return {b, {1}, {j}, 1};
    const double c1 = -dot(ab, c), c2 = -dot(ac, c);
    if (c2 >= 0 && c1 <= c2) return {c, {1}, {k}, 1};
    const point<3> n = cross(ab, ac);
    const double of_c = dot(n, cross(a, ab)), of_b = dot(n, cross(ac, a)), of_a = dot(n, cross(b, c - b));
    if (of_c <= 0 && a1 >= 0 && b1 <= 0) return closest_on_edge(a, b, i, j);
    if (of_b <= 0 && a2 >= 0 && c2 <= 0) return closest_on_edge(a, c, i, k);
    if (of_a <= 0 && b2 - b1 >= 0 && c1 - c2 >= 0) return closest_on_edge(b, c, j, k);
    const double sum = of_a + of_b + of_c;
    // Without area one of the edges has it all.
    if (!(sum > 0))
        return nearer(nearer(closest_on_edge(a, b, i, j), closest_on_edge(b, c, j, k)), closest_on_edge(a, c, i, k));
    const double scale = 1 / sum;
    return {n * (dot(n, a) / dot(n, n)), {of_a * scale, of_b * scale, of_c * scale}, {i, j, k}, 3};
}

/// The same; quicker where the origin lies beyond the last corner or one of its edges, since GJK has just added it.
PHYSICS_HPP_ALWAYS_INLINE closest_of<3> closest_on_grown_triangle(const point<3>& a, const point<3>& b,
                                                                  const point<3>& c, int i, int j, int k) {
    const point<3> e = a - c, f = b - c;
    const double along_e = -dot(c, e), along_f = -dot(c, f);
    if (along_e <= 0 && along_f <= 0) return {c, {1}, {k}, 1};
    const double ee = dot(e, e), ff = dot(f, f), ef = dot(e, f);
    const double whole = ee * ff - ef * ef;
    // Of thin triangles these differences are rounding.
    if (!(whole > 0x1p-20 * ee * ff)) return closest_on_triangle(a, b, c, i, j, k);
    const double of_a = along_e * ff - along_f * ef, of_b = along_f * ee - along_e * ef;
    if (of_b <= 0 && along_e > 0 && along_e < ee) return closest_on_edge(a, c, i, k);
    if (of_a <= 0 && along_f > 0 && along_f < ff) return closest_on_edge(b, c, j, k);
    const double of_c = whole - of_a - of_b;
    if (!(of_a > 0 && of_b > 0 && of_c > 0)) return closest_on_triangle(a, b, c, i, j, k);
    const point<3> n = cross(e, f);
    const double scale = 1 / whole;
    return {n * (dot(n, c) / dot(n, n)), {of_a * scale, of_b * scale, of_c * scale}, {i, j, k}, 3};
}

/// The point of a simplex that is closest to the origin; of count D + 1, and the origin itself, if that lies within.
/// `grown` says that the last vertex has just been added beyond the closest point of the others.
inline closest_of<2> closest_of_simplex(const simplex<2>& s, bool) {
    if (s.count == 1) return {s.vertex[0].w, {1}, {0}, 1};
    if (s.count == 2) return closest_on_edge(s.vertex[0].w, s.vertex[1].w);
    const point<2> p[3] = {s.vertex[0].w, s.vertex[1].w, s.vertex[2].w};
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    closest_of<2> best;
    best.count = 3;
    double least = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = i < 2 ? i + 1 : 0, k = i > 0 ? i - 1 : 2;
        const point<2> e = p[j] - p[i];
        // Where the triangle has no area to speak of, every edge is outside.
        const bool flat = !(abs(area) > 0x1p-50 * largest(e) * largest(p[k] - p[i]));
        if (!flat && (cross(p[i], e) < 0) == (area < 0)) continue;
        const closest_of<2> c = closest_on_edge(p[i], p[j], i, j);
        const double distance = dot(c.at, c.at);
        if (best.count < 3 && !(distance < least)) continue;
        least = distance;
        best = c;
    }
    // In ascending order, so that none is overwritten before it has moved.
    if (best.count == 2 && best.vertex[1] < best.vertex[0]) {
        std::swap(best.vertex[0], best.vertex[1]);
        std::swap(best.weight[0], best.weight[1]);
    }
    return best;
}

inline closest_of<3> closest_of_simplex(const simplex<3>& s, bool grown) {
    if (s.count == 1) return {s.vertex[0].w, {1}, {0}, 1};
    if (s.count == 2) return closest_on_edge(s.vertex[0].w, s.vertex[1].w);
    if (s.count == 3) return closest_on_grown_triangle(s.vertex[0].w, s.vertex[1].w, s.vertex[2].w, 0, 1, 2);
    // The faces at the last vertex, and their normals; the one opposite lies behind if the simplex has grown.
    const point<3>& d = s.vertex[3].w;
    const point<3> e[3] = {s.vertex[0].w - d, s.vertex[1].w - d, s.vertex[2].w - d};
    const point<3> n[3] = {cross(e[0], e[1]), cross(e[1], e[2]), cross(e[2], e[0])};
    const double volume = dot(n[0], e[2]);
    // Where the tetrahedron has no volume to speak of, every face is outside.
    const bool flat = !(abs(volume) > 0x1p-48 * largest(e[0]) * largest(e[1]) * largest(e[2]));
    closest_of<3> best;
    best.count = 4;
    double least = 0;
    const auto consider = [&](int i, int j, int k) {
        const closest_of<3> c = closest_on_grown_triangle(s.vertex[i].w, s.vertex[j].w, s.vertex[k].w, i, j, k);
        const double distance = dot(c.at, c.at);
        if (best.count < 4 && !(distance < least)) return;
        least = distance;
        best = c;
    };
    for (int i = 0; i < 3; ++i) {
        if (!flat && (dot(n[i], d) > 0) != (volume > 0)) continue;
        if (i < 2) consider(i, i + 1, 3);
        else consider(0, 2, 3);
    }
    if (!grown || flat) {
        const point<3> behind = cross(e[1] - e[0], e[2] - e[0]);
        if (flat || (dot(behind, s.vertex[0].w) < 0) == (volume > 0)) consider(0, 1, 2);
    }
    return best;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/gjk.hpp
// =================================================================================================
// The distance of two convex sets: GJK.

PHYSICS_HPP_BEGIN

/// How a query ended.
enum class query_status : std::uint8_t {
    /// The answer is as exact as the numbers allow.
    converged,
    /// The limit of iterations was reached: the answer is the best one found, and its distance too long by an
    /// unknown part.
    iteration_limit,
};

/// What a query of two shapes leaves for the next one of the same pair: the simplex by vertices, and an axis. Start
/// with an empty one. Any content is safe, also that of another pair: it costs time, never a wrong answer.
struct gjk_cache {
    std::uint32_t vertex[4] = {};
    float axis[3] = {};
    std::uint8_t count = 0;
};

namespace detail {

/// Where GJK ended.
template <int D>
struct gjk_result {
    /// The simplex; of D + 1 vertices around the origin where the cores overlap.
    simplex<D> at;
    /// From A to B, of unit length where the cores are apart; else null.
    point<D> normal;
    /// Of the cores; 0 where they overlap. A lower bound where they are `beyond`.
    double distance = 0;
    /// The cores overlap, or touch within rounding.
    bool overlapping = false;
    /// The search ended since the distance exceeds what was asked for.
    bool beyond = false;
    query_status status = query_status::converged;
};

/// Above the largest coordinate that any vertex of B - A can have.
template <int D>
double extent_of(const core<D>& a, const placed_core<D>& b) {
    return a.extent + b.shape->extent + largest(b.at);
}

template <int D>
PHYSICS_HPP_ALWAYS_INLINE cso_vertex<D> support_along(const core<D>& a, const placed_core<D>& b, const point<D>& v) {
    const support_point<D> on_a = a.support(v), on_b = b.support(-v);
    return {on_b.at - on_a.at, on_a.at, on_a.vertex << 16 | on_b.vertex};
}

template <int D>
void start_from(const gjk_cache& cache, const core<D>& a, const placed_core<D>& b, simplex<D>& s) {
    for (int i = 0; i < cache.count && s.count <= D; ++i) {
        const support_point<D> on_a = a.vertex(cache.vertex[i] >> 16), on_b = b.vertex(cache.vertex[i] & 0xffffu);
        s.vertex[s.count++] = {on_b.at - on_a.at, on_a.at, on_a.vertex << 16 | on_b.vertex};
    }
}

/// The normal and the distance that a simplex of fewer than D + 1 vertices gives, from the directions of its edges:
/// more exact than those of the closest point where that is near. Where the two disagree the cores touch, and the
/// closest point is what rounding left.
template <int D>
void measure(gjk_result<D>& r, point<D> v) {
    const auto& vertex = r.at.vertex;
    const double vv = dot(v, v);
    if (r.at.count == D) {
        const point<D> e = vertex[1].w - vertex[0].w;
        point<D> n;
        if constexpr (D == 2) n = perpendicular(e);
        else n = cross(e, vertex[2].w - vertex[0].w);
        const double along = dot(n, v);
        r.overlapping = !(along * along > 0.9 * dot(n, n) * vv);
        v = along < 0 ? -n : n;
    } else if (r.at.count == 2) {
        const point<D> e = vertex[1].w - vertex[0].w;
        const double along = dot(v, e), ee = dot(e, e);
        r.overlapping = !(along * along < 0.1 * vv * ee);
        v -= e * (along / ee);
    }
    r.normal = unit(v);
    r.distance = dot(r.normal, vertex[0].w);
    for (int i = 1; i < r.at.count; ++i) r.distance = min(r.distance, dot(r.normal, vertex[i].w));
    r.overlapping = r.overlapping || !(r.distance > 0);
    if (r.overlapping) r.normal = {}, r.distance = 0;
}

/// The distance of two cores, in A's frame; gives up as soon as it is known to exceed `most`, and ends where it is
/// known within the part `tolerance`. Source: Gilbert, Johnson, Keerthi (1988); van den Bergen, Collision detection in
/// interactive 3D environments (2003), 4.3. Cost: 4 to 10 supports of both, 1 or 2 with a cache.
template <int D>
gjk_result<D> gjk(const core<D>& a, const placed_core<D>& b, double most, double tolerance, gjk_cache* cache) {
    constexpr int most_iterations = 128, most_stalls = 4;
    gjk_result<D> r;
    int stalls = 0;
    // What rounding may do to a coordinate of the vertices.
    const double noise = 0x1p-51 * extent_of(a, b), squared_noise = noise * noise;
    const bool smooth = !a.has_vertices() || !b.shape->has_vertices();
    point<D> v = b.at;
    if (cache != nullptr && cache->count > 0) {
        point<D> axis;
        for (int i = 0; i < D; ++i) axis[i] = detail::to_double(cache->axis[i]);
        const double squared = dot(axis, axis);
        if (squared > 0) {
            v = axis;
            // What parted the two may part them still.
            const cso_vertex<D> next = support_along(a, b, v);
            const double along = dot(v, next.w);
            if (along > 0 && along * along > most * most * squared) {
                r.beyond = true;
                r.normal = unit(v);
                r.distance = dot(r.normal, next.w);
                r.at.vertex[0] = next;
                r.at.count = 1;
                return r;
            }
        }
        if (!smooth) {
            start_from(*cache, a, b, r.at);
            const closest_of<D> c = closest_of_simplex(r.at, false);
            if (c.count <= D) r.at.keep(c);
            v = c.at;
        }
    }
    if (!(dot(v, v) > 0) && r.at.count == 0) v = {}, v[0] = 1;

    const auto finish = [&] {
        if (cache == nullptr) return;
        cache->count = static_cast<std::uint8_t>(r.at.count);
        for (int i = 0; i < r.at.count; ++i) cache->vertex[i] = r.at.vertex[i].name;
        for (int i = 0; i < D; ++i) cache->axis[i] = static_cast<float>(r.normal[i]);
    };
    for (int iteration = 0;; ++iteration) {
        const double vv = dot(v, v);
        if (r.at.count > 0 && (r.at.count == D + 1 || vv <= squared_noise)) {
            r.overlapping = true;
            break;
        }
        cso_vertex<D>& next = r.at.vertex[r.at.count];
        next = support_along(a, b, v);
        const double vw = dot(v, next.w);
        if (vw > 0 && vw * vw > most * most * vv) {
            r.beyond = true;
            r.normal = unit(v);
            r.distance = dot(r.normal, next.w);
            if (r.at.count == 0) r.at.count = 1;
            break;
        }
        if (r.at.count > 0) {
            const double gap = vv - vw;
            bool known = gap <= tolerance * vv || gap * gap <= squared_noise * vv;
            for (int i = 0; i < r.at.count && !known; ++i)
                known = smooth ? r.at.vertex[i].w == next.w : r.at.vertex[i].name == next.name;
            if (known || iteration >= most_iterations) {
                measure(r, v);
                if (!known) r.status = query_status::iteration_limit;
                break;
            }
        }
        ++r.at.count;
        const closest_of<D> closest = closest_of_simplex(r.at, r.at.count > 1);
        if (r.at.count > 1 && closest.count <= D && !(dot(closest.at, closest.at) < vv)) {
            // Rounding lets it come no closer. The normal may still gain: the distance is flat where that is best.
            const bool taken = closest.vertex[closest.count - 1] == r.at.count - 1;
            if (!taken || ++stalls > most_stalls) {
                --r.at.count;
                measure(r, v);
                break;
            }
        }
        if (closest.count <= D) r.at.keep(closest);
        v = closest.at;
    }
    finish();
    return r;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/epa3.hpp
// =================================================================================================
// How deep two convex sets in space overlap: EPA.

PHYSICS_HPP_BEGIN

namespace detail {

/// How deep two cores overlap: the least translation of B along `normal` that parts them.
template <int D>
struct penetration {
    /// Of unit length, from A to B.
    point<D> normal;
    /// Negative where rounding has parted the cores.
    double depth = 0;
    /// The points that touch once B has been moved by depth along the normal; A's. Not so where it is not `located`:
    /// then only near, see locate().
    point<D> on_a;
    bool located = true;
    /// The vertices between which that point lies, as in cso_vertex.
    std::uint32_t names[3] = {};
    query_status status = query_status::converged;
};

/// A growing convex polyhedron of vertices of B - A. Its faces are found by exact orientation, so that it stays closed
/// and convex whatever rounding does: each new vertex lies beyond at least one face, and no face is ever without area.
class cso_hull {
public:
    static constexpr int most_vertices = 160, most_faces = 2 * most_vertices;
    using index = std::uint16_t;

    struct face {
        index vertex[3];
        /// Across the edges 0-1, 1-2, 2-0.
        index neighbour[3];
        /// Outwards, of twice the triangle's area.
        point<3> normal;
        double squared_normal;
        /// dot(normal, p) of its points, and what rounding and the grid may change in such a product.
        double height, error;
    };

    /// Begins with a tetrahedron, of points that do not lie in one plane.
    cso_hull(const orientation& grid, double size, const cso_vertex<3> (&v)[4]) : grid_(grid), size_(size) {
        const bool outwards = grid.of(v[0].w, v[1].w, v[2].w, v[3].w) < 0;
        vertices_[0] = v[0];
        vertices_[1] = v[outwards ? 1 : 2];
        vertices_[2] = v[outwards ? 2 : 1];
        vertices_[3] = v[3];
        vertex_count_ = 4;
        set(0, 0, 1, 2, 1, 2, 3);
        set(1, 0, 3, 1, 3, 2, 0);
        set(2, 1, 3, 2, 1, 3, 0);
        set(3, 2, 3, 0, 2, 1, 0);
        face_count_ = 4;
    }

    [[nodiscard]] const cso_vertex<3>& vertex(int i) const { return vertices_[i]; }
    [[nodiscard]] const face& at(int i) const { return faces_[i]; }
    [[nodiscard]] bool full() const { return vertex_count_ == most_vertices; }
    /// The face that is closest to the origin, seen from within; its distance is negative if the origin is outside.
    [[nodiscard]] int closest() const {
        int best = 0;
        for (int i = 1; i < face_count_; ++i)
            if (key_[i] < key_[best]) best = i;
        return best;
    }
    [[nodiscard]] point<3> unit_normal(int f) const { return unit(faces_[f].normal); }
    [[nodiscard]] double distance(int f) const { return key_[f] < 0 ? -sqrt(-key_[f]) : sqrt(key_[f]); }
    /// Corrects the distance of a face whose normal is not what its corners say exactly, since it is thin.
    void set_distance(int f, double distance) { key_[f] = distance * abs(distance); }
    /// On which side of a face a point lies: 1 where it sees it.
    [[nodiscard]] int side(int f, const point<3>& p) const {
        const face& it = faces_[f];
        const double det = dot(it.normal, p) - it.height;
        if (det > it.error) return 1;
        if (det < -it.error) return -1;
        return grid_.exact_side(w(it.vertex[0]), w(it.vertex[1]), w(it.vertex[2]), p);
    }

    /// Adds a vertex that lies beyond the face `seen`. The hull must not be full.
    void add(const cso_vertex<3>& v, int seen) {
        const index apex = static_cast<index>(vertex_count_);
        vertices_[vertex_count_++] = v;
        // All faces that see the vertex, and the edges between them and the others.
        int open = 0;
        visible_count_ = 0;
        horizon_count_ = 0;
        mark_visible(seen);
        while (open < visible_count_) {
            const index f = visible_[open++];
            for (int e = 0; e < 3; ++e) {
                const index other = faces_[f].neighbour[e];
                if (is_visible(other)) continue;
                if (side(other, v.w) > 0) mark_visible(other);
                else horizon_[horizon_count_++] = {faces_[f].vertex[e], faces_[f].vertex[e < 2 ? e + 1 : 0], f, other};
            }
        }
        for (int i = 0; i < visible_count_; ++i) spare_[spare_count_++] = visible_[i];
        for (int i = 0; i < horizon_count_; ++i) {
            edge& h = horizon_[i];
            h.face = spare_count_ > 0 ? spare_[--spare_count_] : static_cast<index>(face_count_++);
            face_from_[h.from] = h.face;
        }
        for (int i = 0; i < horizon_count_; ++i) {
            const edge& h = horizon_[i];
            replace_neighbour(h.beyond, h.to, h.from, h.face);
            set(h.face, h.from, h.to, apex, h.beyond, face_from_[h.to], 0);
        }
        for (int i = 0; i < horizon_count_; ++i) faces_[face_from_[horizon_[i].to]].neighbour[2] = horizon_[i].face;
    }

private:
    struct edge {
        index from, to;
        index face, beyond;
    };

    [[nodiscard]] const point<3>& w(int i) const { return vertices_[i].w; }
    void set(int f, int a, int b, int c, int ab, int bc, int ca) {
        face& it = faces_[f];
        it.vertex[0] = static_cast<index>(a);
        it.vertex[1] = static_cast<index>(b);
        it.vertex[2] = static_cast<index>(c);
        it.neighbour[0] = static_cast<index>(ab);
        it.neighbour[1] = static_cast<index>(bc);
        it.neighbour[2] = static_cast<index>(ca);
        const point<3> e = w(b) - w(a), g = w(c) - w(a);
        const double ee = dot(e, e), gg = dot(g, g);
        it.normal = cross(e, g);
        it.squared_normal = dot(it.normal, it.normal);
        // Of thin triangles the shorter edges give the better normal.
        if (!(it.squared_normal > 0x1p-8 * ee * gg)) {
            it.normal = normal_of_thin(a, b, c);
            it.squared_normal = dot(it.normal, it.normal);
        }
        it.height = dot(it.normal, w(a));
        // Products of coordinates below size, and differences that the grid moves by 2 steps of size * 2^-59.
        it.error = size_ * ((ee + gg) * 0x1p-44 + size_ * size_ * 0x1p-53);
        // Faces so thin that rounding leaves no normal take no part: beside them are others in the same plane.
        key_[f] = it.squared_normal > 0 ? it.height * abs(it.height) / it.squared_normal : never;
    }
    [[nodiscard]] point<3> normal_of_thin(int a, int b, int c) const {
        const point<3> sides[3] = {w(b) - w(a), w(c) - w(b), w(a) - w(c)};
        int longest = 0;
        for (int i = 1; i < 3; ++i)
            if (dot(sides[i], sides[i]) > dot(sides[longest], sides[longest])) longest = i;
        return cross(sides[longest < 2 ? longest + 1 : 0], sides[longest > 0 ? longest - 1 : 2]);
    }
    void mark_visible(int f) {
        visible_[visible_count_++] = static_cast<index>(f);
        key_[f] = gone;
    }
    [[nodiscard]] bool is_visible(index f) const { return key_[f] == gone; }
    void replace_neighbour(index f, index from, index to, index by) {
        face& it = faces_[f];
        for (int e = 0; e < 3; ++e)
            if (it.vertex[e] == from && it.vertex[e < 2 ? e + 1 : 0] == to) it.neighbour[e] = by;
    }

    /// In place of a face's key: it is none to be chosen; no face is here, but for one that is about to go.
    static constexpr double never = 1e300, gone = 1.7976931348623157e308;

    orientation grid_;
    double size_;
    int vertex_count_ = 0, face_count_ = 0, visible_count_ = 0, horizon_count_ = 0, spare_count_ = 0;
    raw_array<cso_vertex<3>, most_vertices> vertices_;
    raw_array<face, most_faces> faces_;
    /// The squares of the faces' distances from the origin, with the distances' signs.
    raw_array<double, most_faces> key_;
    raw_array<index, most_faces> visible_, spare_;
    raw_array<edge, most_faces> horizon_;
    raw_array<index, most_vertices> face_from_;
};

/// Completes a simplex to a tetrahedron with the farthest points beside it; false if B - A is flat. Of that, `normal`
/// is then a unit vector across it.
inline bool make_tetrahedron(const core<3>& a, const placed_core<3>& b, const simplex<3>& s, double noise,
                             const orientation& grid, cso_vertex<3> (&v)[4], point<3>& normal) {
    int count = s.count;
    for (int i = 0; i < count; ++i) v[i] = s.vertex[i];
    if (count == 4 && grid.of(v[0].w, v[1].w, v[2].w, v[3].w) != 0) return true;
    // The farthest of the supports along n and -n from what measure() takes for the simplex so far.
    double farthest = 0;
    const auto look = [&](const point<3>& n, int into, auto&& measure) {
        for (const double sign : {1.0, -1.0}) {
            const cso_vertex<3> p = support_along(a, b, n * sign);
            const double far = measure(p.w - v[0].w);
            if (!(far > farthest)) continue;
            farthest = far;
            v[into] = p;
        }
    };
    if (count < 2 || !(largest(v[1].w - v[0].w) > noise)) {
        for (int i = 0; i < 3; ++i) {
            point<3> n;
            n[i] = 1;
            look(n, 1, [](const point<3>& e) { return dot(e, e); });
        }
        normal = {1, 0, 0};
        if (!(farthest > noise * noise)) return false;
        count = 2;
    }
    const point<3> e = unit(v[1].w - v[0].w);
    const auto beside_line = [&](const point<3>& p) {
        const point<3> c = cross(e, p);
        return dot(c, c);
    };
    if (count < 3 || !(beside_line(v[2].w - v[0].w) > noise * noise)) {
        farthest = 0;
        normal = perpendicular(e);
        look(normal, 2, beside_line);
        look(cross(e, normal), 2, beside_line);
        if (!(farthest > noise * noise)) return false;
    }
    normal = unit(cross(e, v[2].w - v[0].w));
    farthest = 0;
    look(normal, 3, [&](const point<3>& p) { return abs(dot(normal, p)); });
    return farthest > 0 && grid.of(v[0].w, v[1].w, v[2].w, v[3].w) != 0;
}

/// Finds where two cores touch once `p` has parted them, if that is not known: of faces of B - A of which only some
/// vertices were found.
template <int D>
void locate(const core<D>& a, const placed_core<D>& b, double size, penetration<D>& p) {
    if (p.located) return;
    p.located = true;
    placed_core<D> apart = b;
    apart.at += p.normal * (p.depth + 0x1p-30 * size);
    gjk_cache near;
    near.count = D;
    for (int i = 0; i < D; ++i) near.vertex[i] = p.names[i];
    const gjk_result<D> r = gjk(a, apart, size, 0x1p-30, &near);
    if (r.overlapping || r.beyond) return;
    p.on_a = r.at.on_a();
    for (int i = 0; i < D; ++i) p.names[i] = r.at.vertex[i < r.at.count ? i : 0].name;
}

/// Takes the normal of a face of B - A from the edges of A and B that it is made of: where one shape is much larger
/// than the other, the vertices of B - A have lost digits that these still have.
inline void sharpen(const core<3>& a, const placed_core<3>& b, const point<3>& farthest, penetration<3>& p) {
    if (!a.has_vertices() || !b.shape->has_vertices()) return;
    point<3> of_a[3], of_b[3];
    for (int i = 0; i < 3; ++i) {
        of_a[i] = a.vertex(p.names[i] >> 16).at;
        of_b[i] = b.shape->vertex(p.names[i] & 0xffffu).at;
    }
    point<3> edge[3];
    int longest = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = i < 2 ? i + 1 : 0;
        edge[i] = b.axes * (of_b[j] - of_b[i]) - (of_a[j] - of_a[i]);
        if (dot(edge[i], edge[i]) > dot(edge[longest], edge[longest])) longest = i;
    }
    const point<3> n = unit(cross(edge[longest < 2 ? longest + 1 : 0], edge[longest > 0 ? longest - 1 : 2]));
    const point<3> m = dot(n, p.normal) < 0 ? -n : n;
    const double depth = -dot(m, farthest);
    if (!(dot(m, p.normal) > 0.999999) || !(abs(depth - p.depth) < 1e-6 * a.extent + 1e-6 * b.shape->extent)) return;
    p.normal = m;
    p.depth = depth;
}

/// Improves a way out on round shapes: parted along it, where they are closest shows a shorter one. Ends at a way that
/// is shorter than all others near it.
inline void shorten(const core<3>& a, const placed_core<3>& b, double size, double tolerance, penetration<3>& p) {
    constexpr int most_iterations = 32;
    for (int i = 0; i < most_iterations; ++i) {
        placed_core<3> apart = b;
        apart.at += p.normal * (p.depth + 0x1p-10 * size);
        const gjk_result<3> r = gjk(a, apart, size, 0x1p-50, nullptr);
        if (r.overlapping || r.beyond) return;
        const double depth = -dot(r.normal, support_along(a, b, r.normal).w);
        if (!(depth < p.depth)) return;
        const bool last = p.depth - depth <= tolerance;
        p.normal = r.normal;
        p.depth = depth;
        if (last) return;
    }
}

/// The penetration of two cores that GJK found to overlap; `from` is where it ended, `tolerance` (m) ends the search
/// of round ones. Source: van den Bergen, Proximity queries and penetration depth computation on 3D game objects
/// (2001), with the hull of Barber, Dobkin, Huhdanpaa, The quickhull algorithm (1996). Cost: 5 to 60 supports.
inline penetration<3> epa(const core<3>& a, const placed_core<3>& b, const simplex<3>& from, double tolerance) {
    const double size = power_above(extent_of(a, b)), noise = 0x1p-48 * size;
    penetration<3> best;
    const orientation grid(size);
    cso_vertex<3> first[4];
    point<3> flat;
    if (!make_tetrahedron(a, b, from, noise, grid, first, flat)) {
        best.normal = dot(flat, b.at) < 0 ? -flat : flat;
        best.on_a = from.count < 4 ? from.on_a() : from.vertex[0].on_a;
        for (int i = 0; i < 3; ++i) best.names[i] = from.vertex[i < from.count ? i : 0].name;
        return best;
    }
    cso_hull hull(grid, size, first);
    for (;;) {
        const int f = hull.closest();
        const auto& face = hull.at(f);
        const point<3> n = hull.unit_normal(f);
        const cso_vertex<3> next = support_along(a, b, -n);
        const double h = dot(n, next.w);
        const bool converged = h - hull.distance(f) <= tolerance;
        if (!converged && hull.side(f, next.w) <= 0) {
            hull.set_distance(f, h);
            continue;
        }
        if (converged || hull.full()) {
            if (!converged) best.status = query_status::iteration_limit;
            best.normal = -n;
            best.depth = h;
            point<3> w[3];
            for (int i = 0; i < 3; ++i) w[i] = hull.vertex(face.vertex[i]).w;
            const closest_of<3> at = closest_on_triangle(w[0], w[1], w[2]);
            for (int i = 0; i < 3; ++i) best.names[i] = hull.vertex(face.vertex[i]).name;
            for (int i = 0; i < at.count; ++i)
                best.on_a += hull.vertex(face.vertex[at.vertex[i]]).on_a * at.weight[i];
            sharpen(a, b, next.w, best);
            if (!converged) shorten(a, b, size, tolerance, best);
            best.located = at.count == 3 && converged;
            return best;
        }
        hull.add(next, f);
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/epa2.hpp
// =================================================================================================
// How deep two convex sets in the plane overlap: EPA.

PHYSICS_HPP_BEGIN

namespace detail {

/// A growing convex polygon of vertices of B - A, counter-clockwise; edge i leads from vertex i to the next.
class cso_polygon {
public:
    static constexpr int most_vertices = 128;

    cso_polygon(const cso_vertex<2>& a, const cso_vertex<2>& b, const cso_vertex<2>& c) {
        put(a, b);
        put(b, c);
        put(c, a);
    }
    [[nodiscard]] const cso_vertex<2>& vertex(int i) const { return at(i).vertex; }
    [[nodiscard]] const point<2>& normal(int i) const { return at(i).normal; }
    [[nodiscard]] double distance(int i) const { return at(i).distance; }
    [[nodiscard]] int after(int i) const { return i + 1 < count_ ? i + 1 : 0; }
    [[nodiscard]] bool full() const { return count_ == most_vertices; }
    /// The edge that is closest to the origin, seen from within; its distance is negative if the origin is outside.
    [[nodiscard]] int closest() const {
        int best = 0;
        for (int i = 1; i < count_; ++i)
            if (distance(i) < distance(best)) best = i;
        return best;
    }
    /// Adds a vertex that lies beyond the edge `seen`; what it sees besides goes too.
    void add(const cso_vertex<2>& v, int seen, const orientation& grid) {
        const auto before = [&](int i) { return i > 0 ? i - 1 : count_ - 1; };
        const auto sees = [&](int i) { return grid.of(vertex(i).w, vertex(after(i)).w, v.w) < 0; };
        int first = seen, last = after(seen);
        while (sees(before(first)) && before(first) != last) first = before(first);
        while (sees(last) && after(last) != first) last = after(last);
        const auto& old = rings_[now_];
        auto& grown = rings_[1 - now_];
        int kept = 0;
        for (int i = last; i != first; i = after(i)) grown[kept++] = old[i];
        now_ = 1 - now_;
        count_ = kept;
        put(old[first].vertex, v);
        put(v, old[last].vertex);
    }

private:
    struct corner {
        cso_vertex<2> vertex;
        point<2> normal;
        double distance;
    };
    [[nodiscard]] const corner& at(int i) const { return rings_[now_][i]; }
    void put(const cso_vertex<2>& from, const cso_vertex<2>& to) {
        const point<2> n = unit(perpendicular(to.w - from.w));
        rings_[now_][count_++] = {from, n, dot(n, from.w)};
    }

    raw_array<corner, most_vertices> rings_[2];
    int now_ = 0, count_ = 0;
};

/// Completes a simplex to a triangle; false if B - A is flat. Of that, `normal` is then a unit vector across it.
inline bool make_triangle(const core<2>& a, const placed_core<2>& b, const simplex<2>& s, double noise,
                          const orientation& grid, cso_vertex<2> (&v)[3], point<2>& normal) {
    int count = s.count;
    for (int i = 0; i < count; ++i) v[i] = s.vertex[i];
    if (count < 2 || !(largest(v[1].w - v[0].w) > noise)) {
        double farthest = 0;
        for (int i = 0; i < 4; ++i) {
            point<2> n;
            n[i & 1] = i < 2 ? 1 : -1;
            const cso_vertex<2> p = support_along(a, b, n);
            if (!(largest(p.w - v[0].w) > farthest)) continue;
            farthest = largest(p.w - v[0].w);
            v[1] = p;
        }
        normal = {1, 0};
        if (!(farthest > noise)) return false;
        count = 2;
    }
    normal = perpendicular(unit(v[1].w - v[0].w));
    if (count < 3 || !(abs(dot(normal, v[2].w - v[0].w)) > noise)) {
        const cso_vertex<2> p = support_along(a, b, normal), q = support_along(a, b, -normal);
        v[2] = abs(dot(normal, p.w - v[0].w)) > abs(dot(normal, q.w - v[0].w)) ? p : q;
    }
    const int side = grid.of(v[0].w, v[1].w, v[2].w);
    if (side < 0) std::swap(v[1], v[2]);
    return side != 0;
}

/// The penetration of two cores in the plane that GJK found to overlap; see the one in space.
inline penetration<2> epa(const core<2>& a, const placed_core<2>& b, const simplex<2>& from, double tolerance) {
    const double size = power_above(extent_of(a, b)), noise = 0x1p-48 * size;
    const orientation grid(size);
    penetration<2> best;
    cso_vertex<2> first[3];
    point<2> flat;
    if (!make_triangle(a, b, from, noise, grid, first, flat)) {
        best.normal = dot(flat, b.at) < 0 ? -flat : flat;
        best.on_a = from.count < 3 ? from.on_a() : from.vertex[0].on_a;
        for (int i = 0; i < 3; ++i) best.names[i] = from.vertex[i < from.count ? i : 0].name;
        return best;
    }
    cso_polygon hull(first[0], first[1], first[2]);
    for (;;) {
        const int f = hull.closest();
        const point<2> n = hull.normal(f);
        const cso_vertex<2> next = support_along(a, b, -n);
        const double h = dot(n, next.w);
        const cso_vertex<2> p = hull.vertex(f);
        const cso_vertex<2> q = hull.vertex(hull.after(f));
        const bool converged = h - hull.distance(f) <= tolerance || grid.of(p.w, q.w, next.w) >= 0;
        if (converged || hull.full()) {
            if (!converged) best.status = query_status::iteration_limit;
            best.normal = -n;
            best.depth = h;
            const closest_of<2> at = closest_on_edge(p.w, q.w);
            for (int i = 0; i < at.count; ++i) best.on_a += (at.vertex[i] == 0 ? p : q).on_a * at.weight[i];
            best.names[0] = p.name;
            best.names[1] = best.names[2] = q.name;
            best.located = at.count == 2;
            return best;
        }
        hull.add(next, f, grid);
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/mpr.hpp
// =================================================================================================
// A way to part two convex sets that overlap, found fast, not always the shortest: MPR.

PHYSICS_HPP_BEGIN

namespace detail {

/// The sine of the angle between a ray and a portal that is too small to tell whether the ray passes.
inline constexpr double grazing = 0x1p-20;

/// The point of B - A that is farthest along n.
template <int D>
cso_vertex<D> farthest_along(const core<D>& a, const placed_core<D>& b, const point<D>& n) {
    return support_along(a, b, -n);
}

inline penetration<3> portal_penetration(const cso_vertex<3> (&v)[3], const point<3>& n, double depth) {
    penetration<3> p;
    p.normal = -n;
    p.depth = depth;
    const closest_of<3> at = closest_on_triangle(v[0].w, v[1].w, v[2].w);
    for (int i = 0; i < 3; ++i) p.names[i] = v[i].name;
    for (int i = 0; i < at.count; ++i) p.on_a += v[at.vertex[i]].on_a * at.weight[i];
    p.located = at.count == 3;
    return p;
}

/// A translation that parts two cores that overlap: along the normal of that part of the surface of B - A which the
/// ray from its inside through the origin leaves it by. Never shorter than what EPA finds, for deep overlaps often
/// longer. It starts at the difference of the cores' centres. Source: Snethen,
/// XenoCollide: complex collision made simple, Game Programming Gems 7 (2008). Cost: about half of EPA's.
inline penetration<3> mpr(const core<3>& a, const placed_core<3>& b, const simplex<3>& from, double tolerance) {
    constexpr int most_iterations = 64;
    const double noise = 0x1p-48 * extent_of(a, b);
    point<3> inside = b.axes * b.shape->center + b.at - a.center;
    if (!(largest(inside) > noise)) inside = {4 * noise, 0, 0};
    cso_vertex<3> v[3];
    point<3> n = -inside;
    v[0] = farthest_along(a, b, n);
    n = cross(v[0].w, inside);
    if (!(largest(n) > noise * largest(inside))) n = perpendicular(normalized(inside));
    v[1] = farthest_along(a, b, n);
    n = cross(v[0].w - inside, v[1].w - inside);
    if (dot(n, inside) > 0) std::swap(v[0], v[1]), n = -n;
    // The portal: a triangle that the ray passes.
    for (int i = 0;; ++i) {
        v[2] = farthest_along(a, b, n);
        if (dot(cross(v[0].w, v[2].w), inside) < 0) v[1] = v[2];
        else if (dot(cross(v[2].w, v[1].w), inside) < 0) v[0] = v[2];
        else break;
        // Flat sets have no portal.
        if (i == most_iterations) return epa(a, b, from, tolerance);
        n = cross(v[0].w - inside, v[1].w - inside);
    }
    for (int i = 0; i < most_iterations; ++i) {
        n = unit(cross(v[1].w - v[0].w, v[2].w - v[0].w));
        if (dot(n, v[0].w - inside) < 0) n = -n;
        // Where the ray only grazes the portal, what was found may be one that it does not pass.
        if (!(-dot(n, inside) > grazing * length(inside))) break;
        const cso_vertex<3> next = farthest_along(a, b, n);
        const double h = dot(n, next.w);
        if (!(h - dot(n, v[0].w) > max(tolerance, noise))) return portal_penetration(v, n, h);
        const point<3> c = cross(next.w, inside);
        const int replaced = dot(v[0].w, c) > 0 ? (dot(v[1].w, c) > 0 ? 0 : 2) : (dot(v[2].w, c) > 0 ? 1 : 0);
        v[replaced] = next;
    }
    return epa(a, b, from, tolerance);
}

/// The same in the plane.
inline penetration<2> mpr(const core<2>& a, const placed_core<2>& b, const simplex<2>& from, double tolerance) {
    constexpr int most_iterations = 64;
    const double noise = 0x1p-48 * extent_of(a, b);
    point<2> inside = b.axes * b.shape->center + b.at - a.center;
    if (!(largest(inside) > noise)) inside = {4 * noise, 0};
    cso_vertex<2> v[2];
    v[0] = farthest_along(a, b, -inside);
    // The farthest on that side of the first vertex where the ray passes.
    const double side = cross(v[0].w - inside, -inside);
    point<2> n = perpendicular(v[0].w - inside);
    v[1] = farthest_along(a, b, side > 0 ? -n : n);
    for (int i = 0; i < most_iterations; ++i) {
        n = unit(perpendicular(v[1].w - v[0].w));
        if (dot(n, v[0].w - inside) < 0) n = -n;
        if (!(-dot(n, inside) > grazing * length(inside))) break;
        const cso_vertex<2> next = farthest_along(a, b, n);
        const double h = dot(n, next.w);
        if (!(h - dot(n, v[0].w) > max(tolerance, noise))) {
            penetration<2> p;
            p.normal = -n;
            p.depth = h;
            const closest_of<2> at = closest_on_edge(v[0].w, v[1].w);
            for (int k = 0; k < at.count; ++k) p.on_a += v[at.vertex[k]].on_a * at.weight[k];
            p.located = at.count == 2;
            p.names[0] = v[0].name;
            p.names[1] = p.names[2] = v[1].name;
            return p;
        }
        // Which of the two stays, so that the ray still passes between.
        const bool beyond = (cross(next.w - inside, -inside) > 0) == (cross(v[0].w - inside, -inside) > 0);
        v[beyond ? 0 : 1] = next;
    }
    return epa(a, b, from, tolerance);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/convex.hpp
// =================================================================================================
// Distance, overlap and penetration of any two convex shapes.

PHYSICS_HPP_BEGIN

/// Where two shapes are closest to each other, or how to part them; all in the frame of shape A.
template <class S, int D>
struct closest_points {
    /// Unit vector from A to B. Where points, lines or flat shapes lie in one another one of those that part them.
    vec<S, D> normal;
    /// Between the surfaces (m). Negative where they overlap: moving B along the normal by as much parts them.
    S distance{};
    vec<S, D> on_a;
    vec<S, D> on_b;
    query_status status = query_status::converged;
};

namespace detail {

/// How exactly the general kernels need to know a distance: what the scalar resolves. Polytopes they know to the last
/// digit of double.
template <class S>
constexpr double relative_tolerance() {
    return is_fixed<S> ? 0x1p-50 : static_cast<double>(scalar_traits<S>::epsilon()) * 0.25;
}
/// The same for a depth of overlap between shapes of that size (m).
template <class S>
constexpr double depth_tolerance(double size) {
    const double epsilon = static_cast<double>(scalar_traits<S>::epsilon());
    return is_fixed<S> ? max(epsilon * 0.25, size * 0x1p-51) : size * epsilon * 0.25;
}

inline constexpr double no_limit = 1e300;

/// Two shapes as the general kernels take them, in A's frame.
template <int D>
struct core_pair {
    core<D> a, b;
    placed_core<D> placed;

    template <class A, class B, class S>
    core_pair(const A& shape_a, const B& shape_b, const transform<S, D>& b_in_a)
        : a(core_of(shape_a)), b(core_of(shape_b)),
          placed{&b, to_matrix(b_in_a.rotation), to_point(b_in_a.position)} {}
    core_pair(const core<D>& core_a, const core<D>& core_b, const mat<double, D>& axes, const point<D>& at)
        : a(core_a), b(core_b), placed{&b, axes, at} {}
    core_pair(const core_pair&) = delete;
    core_pair& operator=(const core_pair&) = delete;
};

/// Where the cores of two shapes are closest: the point on A's and what lies between, negative where they overlap.
template <int D>
struct core_separation {
    point<D> normal;
    double gap = 0;
    /// As in penetration.
    point<D> on_a;
    bool located = true;
    std::uint32_t names[3] = {};
    int name_count = 0;
    bool beyond = false;
    query_status status = query_status::converged;
};

/// What finds the way out of an overlap.
enum class overlap_method { epa, mpr };

template <class S, int D>
core_separation<D> separate(const core_pair<D>& pair, double most, gjk_cache* cache,
                            overlap_method method = overlap_method::epa) {
    const gjk_result<D> r = gjk(pair.a, pair.placed, most, relative_tolerance<S>(), cache);
    core_separation<D> result;
    result.status = r.status;
    if (!r.overlapping) {
        result.normal = r.normal;
        result.gap = r.distance;
        result.beyond = r.beyond;
        if (!r.beyond) result.on_a = r.at.on_a();
        result.name_count = r.at.count;
        for (int i = 0; i < r.at.count; ++i) result.names[i] = r.at.vertex[i].name;
        return result;
    }
    const double tolerance = depth_tolerance<S>(extent_of(pair.a, pair.placed));
    const penetration<D> p = method == overlap_method::mpr ? mpr(pair.a, pair.placed, r.at, tolerance)
                                                           : epa(pair.a, pair.placed, r.at, tolerance);
    result.normal = p.normal;
    result.gap = -p.depth;
    result.on_a = p.on_a;
    result.located = p.located;
    result.name_count = D;
    for (int i = 0; i < D; ++i) result.names[i] = p.names[i];
    result.status = p.status;
    return result;
}

/// Finds the points that touch, where the way to part the cores was all that was found.
template <int D>
void locate(const core_pair<D>& pair, core_separation<D>& s) {
    if (s.located) return;
    penetration<D> p{s.normal, -s.gap, s.on_a, false, {}, s.status};
    for (int i = 0; i < 3; ++i) p.names[i] = s.names[i];
    locate(pair.a, pair.placed, extent_of(pair.a, pair.placed), p);
    s.on_a = p.on_a;
    for (int i = 0; i < 3; ++i) s.names[i] = p.names[i];
    s.located = true;
}

template <class S, int D>
closest_points<S, D> rounded(const core_pair<D>& pair, core_separation<D> s) {
    locate(pair, s);
    const point<D> on_b = s.on_a + s.normal * (s.gap - pair.b.radius);
    return {from_point<S>(s.normal), static_cast<S>(s.gap - pair.a.radius - pair.b.radius),
            from_point<S>(s.on_a + s.normal * pair.a.radius), from_point<S>(on_b), s.status};
}

}  // namespace detail

/// How far apart two convex shapes are, and where they are closest; or how deep they overlap, and how to part them.
/// Exact to a few roundings of the shapes' sizes: those of double for polytopes, with a radius or without; cylinders
/// and cones to 1e-8 of their sizes or to roundings of S, whichever is more. Source: GJK and, where cores overlap, EPA
/// (see gjk.hpp, epa3.hpp). Cost: 0.1-0.5 us apart, 0.5-4 us where they overlap; hulls of more than 32 vertices more.
/// `cache` makes the next call for the same pair cheaper where the two have moved little.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
closest_points<S, D> separation(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache& cache) {
    const detail::core_pair<D> pair(a, b, b_in_a);
    return detail::rounded<S>(pair, detail::separate<S>(pair, detail::no_limit, &cache));
}
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
closest_points<S, D> separation(const A& a, const B& b, const transform<S, D>& b_in_a) {
    const detail::core_pair<D> pair(a, b, b_in_a);
    return detail::rounded<S>(pair, detail::separate<S>(pair, detail::no_limit, nullptr));
}

/// How far apart two convex shapes are, 0 where they touch or overlap; normal and points are then those of the cores
/// where only the rounded parts overlap, else null. Cost: GJK alone.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
closest_points<S, D> distance(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache& cache) {
    const detail::core_pair<D> pair(a, b, b_in_a);
    const detail::gjk_result<D> r =
        detail::gjk(pair.a, pair.placed, detail::no_limit, detail::relative_tolerance<S>(), &cache);
    if (r.overlapping) return {{}, S(0), {}, {}, r.status};
    closest_points<S, D> result = detail::rounded<S>(
        pair, detail::core_separation<D>{r.normal, r.distance, r.at.on_a(), true, {}, 0, false, r.status});
    result.distance = max(result.distance, S(0));
    return result;
}
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
closest_points<S, D> distance(const A& a, const B& b, const transform<S, D>& b_in_a) {
    gjk_cache cache;
    return distance(a, b, b_in_a, cache);
}

/// Whether two convex shapes share a point. Cost: GJK until an axis parts them.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache& cache) {
    const detail::core_pair<D> pair(a, b, b_in_a);
    const double reach = pair.a.radius + pair.b.radius;
    const detail::gjk_result<D> r =
        detail::gjk(pair.a, pair.placed, reach, detail::relative_tolerance<S>(), &cache);
    return r.overlapping || (!r.beyond && r.distance <= reach);
}
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a) {
    gjk_cache cache;
    return overlap(a, b, b_in_a, cache);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/facet.hpp
// =================================================================================================
// The face, edge or corner of a convex shape that touches what lies along a direction.

PHYSICS_HPP_BEGIN

namespace detail {

/// A face of a core, or what there is in place of one: an edge, a corner. Hulls' faces of more vertices are thinned
/// out.
template <int D>
struct facet {
    static constexpr int most = D == 2 ? 2 : 32;
    /// Counter-clockwise as seen from outside; in the plane the right end first.
    point<D> corner[most];
    int count = 0;
    /// Unit vector outwards, of a face.
    point<D> normal;
    bool flat = false;
    /// The number of the face, to name contacts.
    std::uint32_t number = 0;
};

inline void add_corner(facet<3>& f, double x, double y, double z) { f.corner[f.count++] = {x, y, z}; }

template <class R>
facet<3> hull_facet(const hull_data<R, 3>& h, const point<3>& n) {
    const R* const rows[3] = {h.face_normal(0), h.face_normal(1), h.face_normal(2)};
    facet<3> f;
    f.number = farthest_vertex<R, 3>(rows, h.padded_faces, n);
    f.normal = h.normal(f.number);
    f.flat = true;
    const std::uint32_t begin = h.face_begin(f.number), count = h.face_end(f.number) - begin;
    const std::uint32_t kept = count < std::uint32_t{facet<3>::most} ? count : std::uint32_t{facet<3>::most};
    for (std::uint32_t i = 0; i < kept; ++i) {
        const std::uint32_t v = h.face_vertices()[begin + i * count / kept];
        add_corner(f, static_cast<double>(h.coordinate(0)[v]), static_cast<double>(h.coordinate(1)[v]),
                   static_cast<double>(h.coordinate(2)[v]));
    }
    return f;
}
template <class R>
facet<2> hull_facet(const hull_data<R, 2>& h, const point<2>& n) {
    const R* const rows[2] = {h.face_normal(0), h.face_normal(1)};
    facet<2> f;
    f.number = farthest_vertex<R, 2>(rows, h.padded_faces, n);
    f.normal = h.normal(f.number);
    f.flat = true;
    f.count = 2;
    const std::uint32_t ends[2] = {f.number, f.number + 1 < h.vertex_count ? f.number + 1 : 0};
    for (int k = 0; k < 2; ++k)
        f.corner[k] = {static_cast<double>(h.coordinate(0)[ends[k]]), static_cast<double>(h.coordinate(1)[ends[k]])};
    return f;
}

/// The face of discs, or what there is in place of it that a unit vector points out of most: a point of the rim, or the
/// line on the side.
inline facet<3> disc_facet(const core<3>& c, const point<3>& n) {
    // The tilt (rad) above which nothing lies on a face any more, so that its rim touches in one point.
    constexpr double tilted = 0.1;
    facet<3> f;
    const double half = c.corner[0].x, low = c.corner[0].y, high = c.corner[0].z;
    const double across = physics::sqrt(n.y * n.y + n.z * n.z);
    // The outward normal of the side, in the plane of the axis and n.
    const double slope = low - high, side = physics::sqrt(4 * half * half + slope * slope);
    const double of_side = (n.x * slope + across * (2 * half)) / side;
    const bool upper = n.x > 0;
    const double r = upper ? high : low, x = upper ? half : -half;
    if (abs(n.x) > of_side && r > 0) {
        f.number = upper ? 2 : 1;
        if (across > tilted) {
            add_corner(f, x, r * (n.y / across), r * (n.z / across));
            return f;
        }
        // Corners that stay where they are on the disc as n changes.
        static constexpr double c1 = 0.92387953251128674, s1 = 0.38268343236508977, d = 0.70710678118654752;
        static constexpr double around[8][2] = {{1, 0},   {c1, s1},  {d, d},  {s1, c1},
                                                {0, 1}, {-s1, c1}, {-d, d}, {-c1, s1}};
        int lowest = 0;
        double most = 0;
        for (int i = 0; i < 16; ++i) {
            const int k = upper ? i : 15 - i;
            const double sign = k < 8 ? r : -r;
            add_corner(f, x, sign * around[k & 7][0], sign * around[k & 7][1]);
            const double out = n.y * f.corner[i].y + n.z * f.corner[i].z;
            if (out > most) most = out, lowest = i;
        }
        // But where the farthest point of the rim lies clearly beyond them, the nearest of them goes there.
        if (r * across - most > c.thickness * (1.0 / 1024))
            f.corner[lowest] = {x, r * (n.y / across), r * (n.z / across)};
        f.normal.x = upper ? 1 : -1;
        f.flat = true;
        return f;
    }
    const double y = across > 0 ? n.y / across : 1, z = across > 0 ? n.z / across : 0;
    add_corner(f, -half, low * y, low * z);
    add_corner(f, half, high * y, high * z);
    return f;
}

inline facet<3> triangle_facet(const core<3>& c, const point<3>& n) {
    facet<3> f;
    const point<3> e = c.corner[1] - c.corner[0], g = c.corner[2] - c.corner[0], h = g - e;
    const auto [up, doubled_area] = split(cross(e, g));
    const double facing = dot(up, n);
    const bool back = facing < 0;
    f.number = std::uint32_t{back};
    // Of a needle there is no more than an edge.
    const bool needle = doubled_area * 256 < max(max(dot(e, e), dot(g, g)), dot(h, h));
    // Where it leans more, only an edge of it touches: by that it may lie on another one or on a side.
    if (abs(facing) > 0.9 && !needle) {
        f.count = 3;
        f.flat = true;
        f.normal = back ? -up : up;
        for (int i = 0; i < 3; ++i) f.corner[i] = c.corner[back ? 2 - i : i];
        return f;
    }
    // The edge that lies farthest out.
    int out = 0;
    const double reach[3] = {dot(n, c.corner[0]), dot(n, c.corner[1]), dot(n, c.corner[2])};
    for (int i = 1; i < 3; ++i)
        if (reach[i] + reach[i < 2 ? i + 1 : 0] > reach[out] + reach[out < 2 ? out + 1 : 0]) out = i;
    f.count = 2;
    f.number = 2 + static_cast<std::uint32_t>(out);
    f.corner[0] = c.corner[out];
    f.corner[1] = c.corner[out < 2 ? out + 1 : 0];
    return f;
}

/// What a core turns towards the unit vector n, in the core's frame.
inline facet<3> facet_of(const core<3>& c, const point<3>& n) {
    facet<3> f;
    switch (c.kind) {
    case core_kind::segment:
        f.count = 2;
        f.corner[0] = c.corner[0];
        f.corner[1] = c.corner[1];
        break;
    case core_kind::triangle: return triangle_facet(c, n);
    case core_kind::box: {
        int axis = 0;
        // A lower number wins unless another face is clearly better, so that rounding does not choose.
        for (int i = 1; i < 3; ++i)
            if (abs(n[i]) > abs(n[axis]) + 1.0 / 1024) axis = i;
        const int u = axis < 2 ? axis + 1 : 0, v = axis > 0 ? axis - 1 : 2;
        const double sign = n[axis] < 0 ? -1 : 1;
        static constexpr double around[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
        f.count = 4;
        f.flat = true;
        f.normal[axis] = sign;
        f.number = static_cast<std::uint32_t>(axis) << 1 | std::uint32_t{sign > 0};
        for (int i = 0; i < 4; ++i) {
            f.corner[i][axis] = sign * c.corner[0][axis];
            f.corner[i][u] = sign * around[i][0] * c.corner[0][u];
            f.corner[i][v] = around[i][1] * c.corner[0][v];
        }
        break;
    }
    case core_kind::hull_of_floats: return hull_facet(*static_cast<const hull_data<float, 3>*>(c.data), n);
    case core_kind::hull_of_doubles: return hull_facet(*static_cast<const hull_data<double, 3>*>(c.data), n);
    case core_kind::disc: return disc_facet(c, n);
    case core_kind::point:
    case core_kind::custom: break;
    }
    return f;
}
inline facet<2> facet_of(const core<2>& c, const point<2>& n) {
    facet<2> f;
    switch (c.kind) {
    case core_kind::segment: {
        // Flat on both sides.
        const bool back = dot(perpendicular(c.corner[1] - c.corner[0]), n) < 0;
        f.corner[0] = c.corner[back ? 1 : 0];
        f.corner[1] = c.corner[back ? 0 : 1];
        f.number = std::uint32_t{back};
        break;
    }
    case core_kind::triangle: {
        int out = 0;
        double best = -2;
        const bool clockwise = cross(c.corner[1] - c.corner[0], c.corner[2] - c.corner[0]) < 0;
        for (int i = 0; i < 3; ++i) {
            const point<2> e = c.corner[i < 2 ? i + 1 : 0] - c.corner[i];
            const double facing = dot(normalized(perpendicular(clockwise ? -e : e)), n);
            if (facing > best) best = facing, out = i;
        }
        f.corner[clockwise ? 1 : 0] = c.corner[out];
        f.corner[clockwise ? 0 : 1] = c.corner[out < 2 ? out + 1 : 0];
        f.number = static_cast<std::uint32_t>(out);
        break;
    }
    case core_kind::box: {
        const int axis = abs(n.y) > abs(n.x) + 1.0 / 1024 ? 1 : 0;
        const double sign = n[axis] < 0 ? -1 : 1, across = axis == 0 ? sign : -sign;
        f.corner[0][axis] = f.corner[1][axis] = sign * c.corner[0][axis];
        f.corner[0][1 - axis] = -across * c.corner[0][1 - axis];
        f.corner[1][1 - axis] = across * c.corner[0][1 - axis];
        f.number = static_cast<std::uint32_t>(axis) << 1 | std::uint32_t{sign > 0};
        break;
    }
    case core_kind::hull_of_floats: return hull_facet(*static_cast<const hull_data<float, 2>*>(c.data), n);
    case core_kind::hull_of_doubles: return hull_facet(*static_cast<const hull_data<double, 2>*>(c.data), n);
    default: return f;
    }
    f.count = 2;
    f.flat = true;
    f.normal = normalized(perpendicular(f.corner[1] - f.corner[0]));
    return f;
}

template <int D>
facet<D> facet_of(const placed_core<D>& c, const point<D>& n) {
    facet<D> f = facet_of(*c.shape, transposed_times(c.axes, n));
    f.normal = c.axes * f.normal;
    for (int i = 0; i < f.count; ++i) f.corner[i] = c.axes * f.corner[i] + c.at;
    return f;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/reduce2.hpp
// =================================================================================================
// Two of many contact points that span what all of them hold.

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up to two of the candidates to the manifold: the deepest, and the farthest beside it. Among candidates that
/// are alike, within `slack`, the first wins: rounding would choose others in each step.
template <class S>
constexpr void reduce(const manifold_point<S, 2>* candidates, int count, vec<S, 2> normal, S slack,
                      manifold<S, 2>& out) {
    if (count == 0) return;
    int deepest = 0, farthest = 0;
    for (int i = 1; i < count; ++i)
        if (candidates[i].separation < candidates[deepest].separation - slack) deepest = i;
    const vec<S, 2> along = perpendicular(normal);
    const auto apart = [&](int i) { return abs(dot(along, candidates[i].position - candidates[deepest].position)); };
    for (int i = 0; i < count; ++i)
        if (apart(i) > apart(farthest) + slack) farthest = i;
    out.points[out.count++] = candidates[deepest];
    if (farthest != deepest && apart(farthest) > slack) out.points[out.count++] = candidates[farthest];
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/patch.hpp
// =================================================================================================
// Contact of any two convex shapes: the patch that their faces share, or the points where they are closest.

PHYSICS_HPP_BEGIN

namespace detail {

/// What limits a patch: the roundings of the two shapes, how far apart their surfaces may be, and what deviation of
/// the cores is small (m).
struct patch_limits {
    double reference_radius, incident_radius, margin, slack;
};

inline std::uint32_t mixed(std::uint32_t a, std::uint32_t b) { return (a ^ b * 0x9e3779b1u) * 0x85ebca6bu ^ a >> 15; }

/// Adds the contact of a core point of the incident shape that lies `gap` beyond the reference's core, seen along n
/// from the reference.
template <int D>
manifold_point<double, D> touching(const point<D>& on_incident, const point<D>& n, double gap, const patch_limits& by,
                                   std::uint32_t feature) {
    const double surfaces = gap - by.reference_radius - by.incident_radius;
    return {on_incident - n * (by.incident_radius + surfaces * 0.5), surfaces, feature};
}

/// Whether a facet lies within five degrees of the plane across n. A round edge leads its surface along its own normal:
/// where it tilts more, only its deepest point touches.
template <int D>
bool lies_flat(const facet<D>& f, const point<D>& n) {
    if (f.flat) return dot(f.normal, n) < -1 + 1.0 / 256;
    const point<D> edge = f.corner[1] - f.corner[0];
    const double tilt = dot(edge, n);
    return tilt * tilt < dot(edge, edge) * (1.0 / 128);
}

/// Keeps what the incident facet has within the sides of the reference facet, seen along n, and adds it to `out` where
/// it is within the margin; `gap` is how far n parts the cores. False, with nothing added, if what n finds closest was
/// cut off: then the two do not touch face to face. Seen in a frame of the caller's; `flip` says that the reference is
/// shape B. Source: Sutherland, Hodgman, Reentrant polygon clipping (1974).
inline bool clip_facets(const facet<3>& reference, const point<3>& n, double gap, const facet<3>& incident, bool flip,
                        const patch_limits& by, manifold<double, 3>& out) {
    struct corner {
        point<3> at;
        std::uint8_t before, after;
    };
    static_assert(2 * facet<3>::most + 2 <= most_candidates);
    raw_array<corner, most_candidates> rings[2];
    int count = incident.count, ring = 0;
    for (int i = 0; i < count; ++i)
        rings[0][i] = {incident.corner[i], static_cast<std::uint8_t>(i > 0 ? i - 1 : count - 1),
                       static_cast<std::uint8_t>(i)};
    // The corners of a face may lie below it by rounding; and where equal boxes meet, rounding must not decide
    // whether corners are cut and named anew.
    const point<3>& base = reference.corner[0];
    for (int e = 0; e < reference.count && count > 0; ++e) {
        const point<3>& from = reference.corner[e];
        const point<3> edge = reference.corner[e + 1 < reference.count ? e + 1 : 0] - from;
        // Of a line only the ends limit; a face is limited by its edges.
        const point<3> m = reference.count == 2 ? n * dot(edge, n) - edge : cross(edge, n);
        const double limit = by.slack * length(m);
        const auto name = static_cast<std::uint8_t>(facet<3>::most + e);
        const auto& in = rings[ring];
        auto& kept = rings[1 - ring];
        int left = 0;
        double beyond = dot(m, in[count - 1].at - from) - limit;
        for (int i = 0; i < count; ++i) {
            const corner& a = in[i > 0 ? i - 1 : count - 1];
            const corner& b = in[i];
            const double next = dot(m, b.at - from) - limit;
            if ((beyond > 0) != (next > 0) && (count > 2 || i > 0)) {
                const point<3> cut = a.at + (b.at - a.at) * (beyond / (beyond - next));
                kept[left++] = next > 0 ? corner{cut, a.after, name} : corner{cut, name, b.before};
            }
            if (!(next > 0)) kept[left++] = b;
            beyond = next;
        }
        count = left;
        ring = 1 - ring;
    }
    point<3> up = reference.normal, aside;
    if (!reference.flat) {
        const point<3> edge = reference.corner[1] - base;
        up = normalized(n - edge * (dot(n, edge) / dot(edge, edge)));
        aside = normalized(cross(edge, up));
    }
    const double steep = 1 / dot(up, n);
    raw_array<manifold_point<double, 3>, most_candidates> found;
    int candidates = 0;
    double deepest = gap + 3 * by.slack;
    const std::uint32_t faces = mixed(reference.number << 1 | std::uint32_t{flip}, incident.number);
    for (int i = 0; i < count; ++i) {
        const corner& c = rings[ring][i];
        const double here = dot(up, c.at - base) * steep;
        deepest = min(deepest, here);
        // Two lines touch side by side only where one lies above the other.
        if (!reference.flat && abs(dot(aside, c.at - base)) > by.slack) return false;
        const std::uint32_t feature = mixed(faces, static_cast<std::uint32_t>(c.before << 8 | c.after));
        const manifold_point<double, 3> p = touching(c.at, n, here, by, feature);
        if (!(p.separation > by.margin)) found[candidates++] = p;
    }
    if (deepest > gap + 2 * by.slack) return false;
    out.normal = flip ? -n : n;
    if (by.incident_radius > 0 && !lies_flat(incident, n)) {
        for (int i = 1; i < candidates; ++i)
            if (found[i].separation < found[0].separation) found[0] = found[i];
        candidates = candidates > 1 ? 1 : candidates;
    }
    reduce(found.items, candidates, n, by.slack, out);
    return true;
}

inline bool clip_facets(const facet<2>& reference, const point<2>& n, double gap, const facet<2>& incident, bool flip,
                        const patch_limits& by, manifold<double, 2>& out) {
    const point<2> from = reference.corner[0], edge = reference.corner[1] - from;
    const point<2> up = reference.normal;
    const double whole = dot(edge, edge), limit = by.slack * sqrt(whole), steep = 1 / dot(up, n);
    // Seen along n: along the edge, less what leans.
    const point<2> along = edge - up * (dot(edge, n) * steep);
    const double at[2] = {dot(along, incident.corner[0] - from), dot(along, incident.corner[1] - from)};
    const double low = -limit, high = whole + limit;
    if ((at[0] < low && at[1] < low) || (at[0] > high && at[1] > high)) return false;
    manifold_point<double, 2> found[2];
    double gaps[2];
    for (int k = 0; k < 2; ++k) {
        point<2> p = incident.corner[k];
        const double stop = at[k] < low ? low : at[k] > high ? high : at[k];
        if (stop != at[k]) p += (incident.corner[1 - k] - p) * ((stop - at[k]) / (at[1 - k] - at[k]));
        gaps[k] = dot(up, p - from) * steep;
        // Whether the end is a corner or a cut stays out of the name: of equal boxes it changes with rounding.
        const std::uint32_t feature =
            mixed(mixed(reference.number << 1 | std::uint32_t{flip}, incident.number), static_cast<std::uint32_t>(k));
        found[k] = touching(p, n, gaps[k], by, feature);
    }
    if (min(gaps[0], gaps[1]) > gap + 2 * by.slack) return false;
    const int deeper = gaps[1] < gaps[0] ? 1 : 0;
    const bool whole_edge = !(by.incident_radius > 0) || lies_flat(incident, n);
    out.normal = flip ? -n : n;
    for (int k = 0; k < 2; ++k)
        if (!(found[k].separation > by.margin) && (k == deeper || whole_edge)) out.points[out.count++] = found[k];
    return true;
}

/// What deviation of two cores is small (m): 1/512 of the smaller one's smallest half extent, or rounding.
template <class S, int D>
double slack_of(const core_pair<D>& pair) {
    const double size = extent_of(pair.a, pair.placed);
    // The extents add up all coordinates.
    const double rounding = static_cast<double>(rounding_of(S(1))) * (is_fixed<S> ? max(size, 1.0) : size * 0.5);
    const double smallest = min(pair.a.thickness + pair.a.radius, pair.b.thickness + pair.b.radius);
    return max(smallest * (1.0 / 512), rounding);
}

/// Contact of two cores with their roundings, in A's frame, once it is known how to part them: faces that all but face
/// each other share a patch, which is found by clipping; all others touch in the points that GJK or EPA found. To keep
/// the features of bodies at rest, contacts may deviate by two slacks, never more.
template <int D>
void touch_parted(const core_pair<D>& pair, core_separation<D> s, double margin, double slack,
                  manifold<double, D>& out) {
    const facet<D> of_a = facet_of(pair.a, s.normal), of_b = facet_of(pair.placed, -s.normal);
    const patch_limits from_a{pair.a.radius, pair.b.radius, margin, slack};
    const patch_limits from_b{pair.b.radius, pair.a.radius, margin, slack};
    const auto by_face_of_a = [&](const point<D>& n, double gap) {
        return of_b.count > 1 && clip_facets(of_a, n, gap, of_b, false, from_a, out);
    };
    const auto by_face_of_b = [&](const point<D>& n, double gap) {
        return of_a.count > 1 && clip_facets(of_b, n, gap, of_a, true, from_b, out);
    };
    // Faces before edges and a's before b's where they are alike, so that the choice does not flicker.
    const double gap_a =
        of_a.flat ? dot(of_a.normal, pair.placed.support(-of_a.normal).at - of_a.corner[0]) : -no_limit;
    const double gap_b = of_b.flat ? dot(of_b.normal, pair.a.support(-of_b.normal).at - of_b.corner[0]) : -no_limit;
    const bool use_b = gap_b > gap_a + 2 * slack;
    const bool facing = s.gap <= (use_b ? gap_b : gap_a) + 2 * slack;
    if (facing && !use_b && by_face_of_a(of_a.normal, gap_a)) return;
    if (facing && (use_b || gap_b > s.gap - 2 * slack) && by_face_of_b(of_b.normal, gap_b)) return;
    // Faces that all but face each other keep their points where an edge gives the normal; so do edges side by side.
    constexpr double nearly = 0.9986;
    if (of_a.flat && dot(of_a.normal, s.normal) > nearly && by_face_of_a(s.normal, s.gap)) return;
    if (of_b.flat && dot(of_b.normal, s.normal) < -nearly && by_face_of_b(-s.normal, s.gap)) return;
    if (!of_a.flat && !of_b.flat && of_a.count == 2 && lies_flat(of_a, s.normal) && by_face_of_a(s.normal, s.gap))
        return;

    locate(pair, s);
    std::uint32_t feature = 0x80000000u;
    for (int i = 0; i < s.name_count; ++i) feature += mixed(s.names[i], 0x51u);
    out.normal = s.normal;
    out.points[out.count++] = touching<D>(s.on_a + s.normal * s.gap, s.normal, s.gap, from_a, feature);
}

/// Contact of two cores; what pairs without a function of their own get.
template <class S, int D>
void touch_cores(const core_pair<D>& pair, double margin, gjk_cache* cache, overlap_method method,
                 manifold<double, D>& out) {
    const double reach = pair.a.radius + pair.b.radius + margin;
    const core_separation<D> s = separate<S>(pair, reach, cache, method);
    if (!s.beyond && !(s.gap > reach)) touch_parted(pair, s, margin, slack_of<S>(pair), out);
}

template <class S, int D>
void add_rounded_once(const manifold<double, D>& m, manifold<S, D>& out) {
    out.normal = from_point<S>(m.normal);
    for (int i = 0; i < m.count; ++i)
        out.add(from_point<S>(m.points[i].position), static_cast<S>(m.points[i].separation), m.points[i].feature);
}

/// The same for any two shapes that have cores.
template <class A, class B, class S, int D>
void collide_cores(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                   overlap_method method, manifold<S, D>& out) {
    const core_pair<D> pair(a, b, b_in_a);
    manifold<double, D> m;
    touch_cores<S>(pair, detail::to_double(margin), cache, method, m);
    add_rounded_once(m, out);
}

/// Contact of a core with a halfspace: the corners of what the core turns towards it.
template <class S, int D>
void touch_half(const placed_core<D>& c, const bounding_half<D>& half, double margin, manifold<double, D>& out) {
    const point<D>& n = half.normal;
    const facet<D> f = facet_of(c, -n);
    raw_array<manifold_point<double, D>, facet<D>::most + 1> found;
    const patch_limits by{0, c.shape->radius, margin, 0};
    int count = 0;
    const auto touch = [&](const point<D>& p, std::uint32_t feature) {
        const manifold_point<double, D> at = touching(p, n, half.height(p), by, feature);
        if (!(at.separation > by.margin)) found[count++] = at;
    };
    double deepest = no_limit;
    for (int i = 0; i < f.count; ++i) {
        deepest = min(deepest, dot(n, f.corner[i]));
        touch(f.corner[i], mixed(f.number, static_cast<std::uint32_t>(i)));
    }
    // The lowest point may be none of the corners, of round shapes and of faces that were thinned out.
    const support_point<D> lowest = c.support(-n);
    const double slack =
        max(c.shape->thickness * (1.0 / 512), static_cast<double>(rounding_of(S(1))) * c.shape->extent);
    if (dot(n, lowest.at) < deepest - slack) touch(lowest.at, mixed(0x80000000u, lowest.vertex));
    out.normal = -n;
    reduce(found.items, count, n, slack, out);
}
/// Contact of any shape that has a core with a halfspace.
template <class A, class S, int D>
void collide_with_plane(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                        manifold<S, D>& out) {
    const core<D> c = core_of(a);
    manifold<double, D> m;
    touch_half<S>(placed_core<D>{&c, mat<double, D>::identity(), {}}, bounding_half<D>(b, b_in_a),
                  detail::to_double(margin), m);
    add_rounded_once(m, out);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/polygon2.hpp
// =================================================================================================
// Contact of rounded polygons in the plane: boxes, capsules, small hulls.

PHYSICS_HPP_BEGIN

namespace detail {

/// A convex polygon, counter-clockwise, grown by a radius; edge i leads from vertex i to the next. Two
/// vertices make a segment with two opposite edges. N: room for vertices, 4 or 8.
template <class S, int N = 4>
struct rounded_polygon {
    vec<S, 2> vertex[N];
    vec<S, 2> normal[N];
    int count = 0;
    S radius{};
    S size{};

    constexpr int next(int i) const { return i + 1 < count ? i + 1 : 0; }
};

template <int N = 4, class S>
constexpr rounded_polygon<S, N> polygon_of(const box<S, 2>& b, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * b.half_extents.x, y = m.column[1] * b.half_extents.y, p = at.position;
    return {{p - x - y, p + x - y, p + x + y, p - x + y},
            {-m.column[1], m.column[0], m.column[1], -m.column[0]},
            4,
            S(0),
            min(b.half_extents.x, b.half_extents.y)};
}
template <int N = 4, class S>
constexpr rounded_polygon<S, N> polygon_of(const capsule<S, 2>& c, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * c.half_length;
    return {{at.position - x, at.position + x}, {-m.column[1], m.column[1]}, 2, c.radius, c.radius};
}

/// The edge of a from which b lies farthest, and how far.
template <class S>
struct edge_distance {
    int edge = 0;
    S distance{};
};
template <class S, int N>
constexpr edge_distance<S> farthest_edge(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b) {
    edge_distance<S> best;
    for (int i = 0; i < a.count; ++i) {
        S nearest = dot(a.normal[i], b.vertex[0] - a.vertex[i]);
        for (int j = 1; j < b.count; ++j) nearest = min(nearest, dot(a.normal[i], b.vertex[j] - a.vertex[i]));
        if (i == 0 || nearest > best.distance) best = {i, nearest};
    }
    return best;
}
/// How far apart the cores are along a unit vector from a to b.
template <class S, int N>
constexpr S distance_along(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b, vec<S, 2> n) {
    S last = dot(n, a.vertex[0]), first = dot(n, b.vertex[0]);
    for (int i = 1; i < a.count; ++i) last = max(last, dot(n, a.vertex[i]));
    for (int i = 1; i < b.count; ++i) first = min(first, dot(n, b.vertex[i]));
    return first - last;
}

/// Clips the edge of `incident` that faces the reference edge to the length of the latter, and adds the ends
/// that are left. False, with nothing added, if the point in which the edge finds `incident` closest was cut
/// off: then the edge's normal is not the direction of least distance.
template <class S, int N>
constexpr bool clip_edges(const rounded_polygon<S, N>& reference, edge_distance<S> found,
                          const rounded_polygon<S, N>& incident, bool flip, S slack, S margin, manifold<S, 2>& out) {
    const int edge = found.edge;
    const vec<S, 2> n = reference.normal[edge], t{-n.y, n.x}, from = reference.vertex[edge];
    int facing = 0;
    // A lower number wins unless another edge is clearly better, so that rounding does not choose.
    for (int i = 1; i < incident.count; ++i)
        if (dot(incident.normal[i], n) < dot(incident.normal[facing], n) - S(1.0 / 1024)) facing = i;

    // Along the reference edge the incident edge runs backwards: its end comes first.
    const vec<S, 2> first = incident.vertex[incident.next(facing)] - from, last = incident.vertex[facing] - from;
    const S at_first = dot(first, t), at_last = dot(last, t), span = at_last - at_first;
    // Reference ends are a little farther out, so that rounding does not cut the corners of equal boxes.
    const S low = -slack, high = dot(reference.vertex[reference.next(edge)] - from, t) + slack;
    if (at_first > high || at_last < low) return false;
    const auto point_at = [&](S at) {
        return span > S(0) ? first + (last - first) * clamp((at - at_first) / span, S(0), S(1)) : first;
    };
    const vec<S, 2> ends[2] = {at_first < low ? point_at(low) : first, at_last > high ? point_at(high) : last};
    const S gaps[2] = {dot(n, ends[0]), dot(n, ends[1])};
    const int deeper = gaps[1] < gaps[0] ? 1 : 0;
    if (gaps[deeper] > found.distance + slack + slack) return false;
    // A round edge leads its surface along its own normal: beyond five degrees of tilt only the deeper end touches.
    const bool flat = !(incident.radius > S(0)) || dot(incident.normal[facing], n) < S(-1 + 1.0 / 256);

    out.normal = flip ? -n : n;
    for (int k = 0; k < 2; ++k) {
        if (gaps[k] - reference.radius - incident.radius > margin || (k != deeper && !flat)) continue;
        const vec<S, 2> on_incident = from + ends[k], on_reference = on_incident - n * gaps[k];
        // Whether the end is a corner or a cut stays out of the name: of equal boxes it changes with rounding.
        const std::uint32_t feature = static_cast<std::uint32_t>(edge << 12 | facing << 8 | k << 4 | int{flip});
        if (flip)
            add_rounded(out, on_incident, incident.radius, on_reference, reference.radius, gaps[k], feature);
        else
            add_rounded(out, on_reference, reference.radius, on_incident, incident.radius, gaps[k], feature);
    }
    return true;
}

/// Adds the closest pair of a vertex of one polygon and an edge or vertex of the other, for cores that do not
/// overlap. `parting` is the best of the edges' normals, from a to b, and `parted` how far it parts the cores.
template <class S, int N>
constexpr void collide_nearest(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b, vec<S, 2> parting,
                               S parted, S rounding, S margin, manifold<S, 2>& out) {
    vec<S, 2> on_a, on_b;
    wide_of<S> best{};
    std::uint32_t feature = 0;
    for (int flip = 0; flip < 2; ++flip) {
        const rounded_polygon<S, N>& edges = flip ? b : a;
        const rounded_polygon<S, N>& vertices = flip ? a : b;
        for (int i = 0; i < edges.count; ++i) {
            const vec<S, 2> from = edges.vertex[i], to = edges.vertex[edges.next(i)];
            for (int j = 0; j < vertices.count; ++j) {
                const vec<S, 2> v = vertices.vertex[j];
                const S t = closest_parameter(from, to, v);
                const vec<S, 2> p = t < S(1) ? from + (to - from) * t : to;
                const wide_of<S> distance = length_squared(v - p);
                if (feature != 0 && !(distance < best)) continue;
                best = distance;
                on_a = flip ? v : p;
                on_b = flip ? p : v;
                // Two vertices have one name, whichever edge found them.
                const bool inside = t > S(0) && t < S(1);
                const int vertex = t > S(0) ? edges.next(i) : i;
                feature = static_cast<std::uint32_t>(inside ? 0x20000 | i << 8 | j << 4 | flip
                                                            : 0x10000 | (flip ? j << 4 | vertex : vertex << 4 | j));
            }
        }
    }
    auto [n, gap] = split(on_b - on_a);
    // Of points that all but coincide the direction is chance.
    if (!(gap > S(0)) || distance_along(a, b, n) < parted - rounding) {
        n = parting;
        gap = parted;
    }
    if (gap - a.radius - b.radius > margin) return;
    out.normal = n;
    add_rounded(out, on_a, a.radius, on_b, b.radius, gap, feature);
}

}  // namespace detail

/// Contact of two rounded convex polygons: separating axes over the edges and clipping, or the nearest features
/// where a corner meets a corner. The result lies in the frame of a and b's vertices. To keep the features of
/// bodies at rest, contacts may deviate by 1/512 of the smaller size, never more.
template <class S, int N>
constexpr void collide_polygons(const detail::rounded_polygon<S, N>& a, const detail::rounded_polygon<S, N>& b,
                                S margin, manifold<S, 2>& out) {
    const S reach = a.radius + b.radius + margin;
    const auto from_a = detail::farthest_edge(a, b);
    if (from_a.distance > reach) return;
    const auto from_b = detail::farthest_edge(b, a);
    if (from_b.distance > reach) return;

    // A preference for a's edge keeps the reference from flipping between two that are alike.
    const S rounding = detail::rounding_of(largest(a.vertex[0]) + largest(b.vertex[0]));
    const S slack = max(min(a.size, b.size) * S(1.0 / 1024), rounding);
    const bool better_b = from_b.distance > from_a.distance;
    if (!(from_b.distance > from_a.distance + slack + slack) &&
        detail::clip_edges(a, from_a, b, false, slack, margin, out))
        return;
    if (better_b && detail::clip_edges(b, from_b, a, true, slack, margin, out)) return;
    detail::collide_nearest(a, b, better_b ? -b.normal[from_b.edge] : a.normal[from_a.edge],
                            better_b ? from_b.distance : from_a.distance, rounding, margin, out);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/hull2.hpp
// =================================================================================================
// Contact of convex polygons of a few vertices in the plane.

PHYSICS_HPP_BEGIN

namespace detail {

/// Polygons of more vertices are quicker by GJK; thin ones need its precision.
inline constexpr int most_separating_edges = 8;

template <class S>
bool is_small(const hull<S, 2>& h) {
    return h.geometry->vertex_count <= std::uint32_t{most_separating_edges} &&
           h.geometry->inradius > 0x1p-7 * h.geometry->reach;
}
template <int N, class S>
rounded_polygon<S, N> polygon_of(const hull<S, 2>& h, const transform<S, 2>& at) {
    const auto& data = *h.geometry;
    const mat<S, 2> m = matrix(at.rotation);
    rounded_polygon<S, N> p;
    p.count = static_cast<int>(data.vertex_count);
    p.radius = h.radius;
    p.size = static_cast<S>(data.inradius) + h.radius;
    for (int i = 0; i < p.count; ++i) {
        const auto k = static_cast<std::uint32_t>(i);
        p.vertex[i] = m * from_point<S>(data.exact_vertex(k)) + at.position;
        p.normal[i] = m * from_point<S>(data.normal(k));
    }
    return p;
}
/// By separating edges where both are small.
template <class A, class S>
void collide_with_hull(const A& a, const hull<S, 2>& b, bool small, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    constexpr int most = most_separating_edges;
    if (small) collide_polygons(polygon_of<most>(a, {}), polygon_of<most>(b, b_in_a), margin, out);
    else collide_cores(a, b, b_in_a, margin, nullptr, overlap_method::epa, out);
}

}  // namespace detail

template <class S>
void collide(const capsule<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
             manifold<S, 2>& out) {
    detail::collide_with_hull(a, b, detail::is_small(b), b_in_a, margin, out);
}
template <class S>
void collide(const box<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    detail::collide_with_hull(a, b, detail::is_small(b), b_in_a, margin, out);
}
template <class S>
void collide(const hull<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    detail::collide_with_hull(a, b, detail::is_small(a) && detail::is_small(b), b_in_a, margin, out);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/pair_memory.hpp
// =================================================================================================
// What is remembered of a pair of shapes from step to step, and contacts that are carried along while it rests.

PHYSICS_HPP_BEGIN

/// What a narrowphase remembers of a pair: where GJK ended, which axis parted it, its last manifold and how long that
/// stays good. Start with an empty one, and use it for one pair of shapes and one margin only.
template <class S, int D>
struct pair_memory {
    gjk_cache cache;
    /// Numbers the axis that parted two boxes; -1 if none did.
    std::int32_t parting = -1;
    manifold<S, D> contact;
    /// Where B stood in A's frame when that was found.
    transform<S, D> b_in_a;
    /// How far B reaches from its origin, and how far its points may move while the manifold is carried along (m).
    S reach{};
    S still{};
};

namespace detail {

/// The largest component of what one rotation differs from another by, times the length of the arm that they turn.
template <class S>
constexpr S turned_by(rotation<S, 2> a, rotation<S, 2> b, S arm) {
    return max(abs(a.cosine - b.cosine), abs(a.sine - b.sine)) * arm;
}
template <class S>
constexpr S turned_by(rotation<S, 3> a, rotation<S, 3> b, S arm) {
    return max(largest(a.imaginary() - b.imaginary()), abs(a.w - b.w)) * (arm + arm);
}

/// Whether the pair has moved so little since its manifold was found that it may be carried along.
template <class S, int D>
constexpr bool is_still(const pair_memory<S, D>& m, const transform<S, D>& b_in_a) {
    return m.contact.count > 0 && !(largest(b_in_a.position - m.b_in_a.position) > m.still) &&
           !(turned_by(b_in_a.rotation, m.b_in_a.rotation, m.reach) > m.still);
}

/// The manifold that was remembered, its points carried along with their shapes: those of B by what it has moved in
/// A's frame, along a normal that stays. Exact but for products of small motions.
template <class S, int D>
constexpr void carry_along(const pair_memory<S, D>& m, const transform<S, D>& b_in_a, S margin, manifold<S, D>& out) {
    if (b_in_a == m.b_in_a) {
        out = m.contact;
        return;
    }
    const rotation<S, D> turn = b_in_a.rotation * inverse(m.b_in_a.rotation);
    const vec<S, D> shift = b_in_a.position - turn * m.b_in_a.position;
    const vec<S, D> n = out.normal = m.contact.normal;
    for (int i = 0; i < m.contact.count; ++i) {
        const manifold_point<S, D>& p = m.contact.points[i];
        const vec<S, D> half = n * (p.separation * S(0.5)), on_a = p.position - half;
        const vec<S, D> on_b = turn * (p.position + half) + shift;
        const S separation = dot(on_b - on_a, n);
        if (!(separation > margin)) out.add(on_a + (on_b - on_a) * S(0.5), separation, p.feature);
    }
}

/// Remembers what was found: contacts stay good while the pair moves by no more than they may deviate by anyway.
/// `reach`: of B from its origin; `thin`: the smallest half extent of both (m).
template <class S, int D>
void remember(const manifold<S, D>& found, const transform<S, D>& b_in_a, S reach, S thin, pair_memory<S, D>& m) {
    m.contact = found;
    m.b_in_a = b_in_a;
    m.reach = reach;
    m.still = thin * S(1.0 / 512);
}
template <class A, class B, class S, int D>
void remember(const A& a, const B& b, const transform<S, D>& b_in_a, const manifold<S, D>& found,
              pair_memory<S, D>& m) {
    if (found.count == 0) {
        m.contact.count = 0;
        m.cache.count = 0;
        return;
    }
    const core<D> of_a = core_of(a), of_b = core_of(b);
    remember(found, b_in_a, static_cast<S>(of_b.extent + of_b.radius),
             static_cast<S>(min(of_a.thickness + of_a.radius, of_b.thickness + of_b.radius)), m);
}
template <class S>
void remember(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, const manifold<S, 3>& found,
              pair_memory<S, 3>& m) {
    const vec<S, 3> least = min(a.half_extents, b.half_extents), of_b = b.half_extents;
    remember(found, b_in_a, of_b.x + of_b.y + of_b.z, min(least.x, min(least.y, least.z)), m);
}

/// True if the axis that parted the pair last parts it still, by more than the margin. Clearly so, that a search from
/// scratch would say the same: then what is remembered of pairs that do not touch bears on no result.
template <class A, class B, class S, int D>
bool still_parted(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, const gjk_cache& cache) {
    point<D> axis;
    for (int i = 0; i < D; ++i) axis[i] = detail::to_double(cache.axis[i]);
    if (!(dot(axis, axis) > 0)) return false;
    const core_pair<D> pair(a, b, b_in_a);
    const double reach = pair.a.radius + pair.b.radius + detail::to_double(margin);
    const double parted = dot(axis, support_along(pair.a, pair.placed, axis).w) / length(axis);
    return parted > reach + 0x1p-30 * (reach + extent_of(pair.a, pair.placed));
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/round.hpp
// =================================================================================================
// Contact of the pairs that read alike in the plane and in space: balls, and round shapes on a halfspace.

PHYSICS_HPP_BEGIN

// collide(a, b, b_in_a, margin, out) fills `out`, which must be empty, with the contact of a and b, in a's
// frame, if the shapes are within `margin` (m) of each other. Pairs come in the order ball, capsule, box,
// halfspace. No shape is refused here: the world has checked them.

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const ball<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    vec<S, D> up;
    up.y = S(1);
    collide_round(vec<S, D>{}, a.radius, b_in_a.position, b.radius, up, margin, 0u, out);
}

namespace detail {
/// A ball against a box that may be flat and rounded: all points within radius_b of |p_i| <= half_i.
template <class S, int D>
constexpr void collide_ball(S radius_a, vec<S, D> half, S radius_b, const transform<S, D>& b_in_a, S margin,
                            manifold<S, D>& out) {
    // In the box's frame, where the components of the normal along a face are exactly zero.
    const vec<S, D> center = inverse_transform(b_in_a, vec<S, D>{});
    const vec<S, D> nearest = max(-half, min(half, center));
    auto [direction, gap] = split(nearest - center);
    if (gap > radius_a + radius_b + margin) return;
    std::uint32_t feature = 0;
    if (!(gap > S(0))) {
        int axis = 0;
        for (int i = 1; i < D; ++i)
            if (half[i] - abs(center[i]) < half[axis] - abs(center[axis])) axis = i;
        const bool below = center[axis] < S(0);
        direction[axis] = S(below ? 1 : -1);
        gap = abs(center[axis]) - half[axis];
        feature = static_cast<std::uint32_t>(1 + 2 * axis + int{below});
    }
    out.normal = b_in_a.rotation * direction;
    add_rounded(out, vec<S, D>{}, radius_a, out.normal * gap, radius_b, gap, feature);
}
}  // namespace detail

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const capsule<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    detail::collide_ball(a.radius, detail::along_x<S, D>(b.half_length), b.radius, b_in_a, margin, out);
}

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const box<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    detail::collide_ball(a.radius, b.half_extents, S(0), b_in_a, margin, out);
}

namespace detail {
/// Adds the contact of a core point p of A (with radius) and the halfspace B, both in A's frame.
template <class S, int D>
constexpr void touch_plane(vec<S, D> p, S radius, vec<S, D> normal, S offset, S margin, std::uint32_t feature,
                           manifold<S, D>& out) {
    const S gap = dot(normal, p) - offset;
    if (gap - radius > margin) return;
    out.normal = -normal;
    add_rounded(out, p, radius, p - normal * gap, S(0), gap, feature);
}
/// The plane of a halfspace in A's frame: its normal and offset.
template <class S, int D>
struct plane {
    vec<S, D> normal;
    S offset;
};
template <class S, int D>
constexpr plane<S, D> plane_of(const halfspace<S, D>& h, const transform<S, D>& at) {
    const vec<S, D> n = at.rotation * unit_normal(h);
    return {n, h.offset + dot(n, at.position)};
}
}  // namespace detail

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    detail::touch_plane(vec<S, D>{}, a.radius, plane.normal, plane.offset, margin, 0u, out);
}

template <class S, int D>
constexpr void collide(const capsule<S, D>& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    const vec<S, D> x = detail::along_x<S, D>(a.half_length);
    detail::touch_plane(-x, a.radius, plane.normal, plane.offset, margin, 0u, out);
    detail::touch_plane(x, a.radius, plane.normal, plane.offset, margin, 1u, out);
}

/// Halfspaces carry no mass, so two of them never push each other.
template <class S, int D>
constexpr void collide(const halfspace<S, D>&, const halfspace<S, D>&, const transform<S, D>&, S, manifold<S, D>&) {}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/pairs2.hpp
// =================================================================================================
// Contact of the pairs that are particular to the plane.

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 2>& a, const halfspace<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    // The corners of the edge that faces the plane most; one of them is the lowest of all.
    const vec<S, 2> n = plane.normal;
    const int across = abs(n.x) > abs(n.y) ? 0 : 1;
    for (std::uint32_t k = 0; k < 2; ++k) {
        vec<S, 2> corner = a.half_extents;
        if (n[across] > S(0)) corner[across] = -corner[across];
        if (k == 0) corner[1 - across] = -corner[1 - across];
        const std::uint32_t name = std::uint32_t{corner.x > S(0)} | std::uint32_t{corner.y > S(0)} << 1;
        detail::touch_plane(corner, S(0), n, plane.offset, margin, name, out);
    }
}

template <class S>
constexpr void collide(const capsule<S, 2>& a, const capsule<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a, {}), detail::polygon_of(b, b_in_a), margin, out);
}
template <class S>
constexpr void collide(const capsule<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a, {}), detail::polygon_of(b, b_in_a), margin, out);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/capsule3.hpp
// =================================================================================================
// Contact of capsules with capsules and boxes in space.

PHYSICS_HPP_BEGIN

namespace detail {

/// A capsule's axis: middle, unit direction and half length.
template <class S>
struct axis_segment {
    vec<S, 3> middle;
    vec<S, 3> direction;
    S half;

    constexpr vec<S, 3> at(S t) const { return middle + direction * t; }
    /// Half of its extent along a direction.
    constexpr S reach(vec<S, 3> n) const { return abs(dot(n, direction)) * half; }
};

/// Where on a segment the point lies that is closest to the box |p_i| <= half_i. The squared distance is convex
/// and its slope piecewise linear, with a knee where a coordinate meets a face: the root lies between two
/// neighbouring knees and is found there exactly. Within a flat stretch, its middle.
template <class S>
constexpr S closest_to_box(const axis_segment<S>& s, vec<S, 3> half) {
    S knees[8] = {-s.half, s.half};
    int count = 2;
    for (int i = 0; i < 3; ++i) {
        const S reach = abs(s.direction[i]) * s.half;
        const S ends[2] = {-half[i] - s.middle[i], half[i] - s.middle[i]};
        for (const S end : ends)
            if (abs(end) < reach) knees[count++] = end / s.direction[i];
    }
    for (int i = 1; i < count; ++i)
        for (int j = i; j > 0 && knees[j] < knees[j - 1]; --j) std::swap(knees[j], knees[j - 1]);
    const auto slope = [&](S t) {
        const vec<S, 3> p = s.at(t);
        return wide_dot(p - max(-half, min(half, p)), s.direction);
    };
    const wide_of<S> zero{};
    S before = knees[0];
    wide_of<S> slope_before = slope(before);
    for (int i = 0; i < count; ++i) {
        const wide_of<S> here = i == 0 ? slope_before : slope(knees[i]);
        if (here > zero) {
            if (i == 0) return knees[0];
            // From the knee where the slope is less, since the other may be far away.
            const wide_of<S> rise = here - slope_before;
            return here + slope_before > zero ? before - (knees[i] - before) * quotient<S>(slope_before, rise)
                                              : knees[i] - (knees[i] - before) * quotient<S>(here, rise);
        }
        if (here == zero) {
            S end = knees[i];
            for (int j = i + 1; j < count && slope(knees[j]) == zero; ++j) end = knees[j];
            return (knees[i] + end) * S(0.5);
        }
        before = knees[i];
        slope_before = here;
    }
    return s.half;
}

/// The direction in which a segment is to be moved out of a box, and what it then leads past.
template <class S>
struct parting {
    vec<S, 3> normal;
    S gap{};
    /// Where on the segment the box is nearest.
    S at{};
};
/// The best separating axis of a segment and the box |p_i| <= half_i, from the box to the segment: the faces,
/// then the edges across the segment, which have to be better by `slack`.
template <class S>
constexpr parting<S> part_from_box(const axis_segment<S>& s, vec<S, 3> half, S slack) {
    parting<S> best;
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(s.middle[i]) - half[i] - abs(s.direction[i]) * s.half;
        if (i > 0 && !(gap > best.gap)) continue;
        best.gap = gap;
        best.normal = {};
        best.normal[i] = s.middle[i] < S(0) ? S(-1) : S(1);
        best.at = dot(best.normal, s.direction) > S(0) ? -s.half : s.half;
    }
    const S best_face = best.gap;
    for (int i = 0; i < 3; ++i) {
        vec<S, 3> e;
        e[i] = S(1);
        const auto [n, sine] = split(cross(e, s.direction));
        // An edge so nearly parallel to the segment that a face says the same.
        if (sine * (half[i] + s.half) < slack) continue;
        const S along = dot(n, s.middle);
        const S gap = abs(along) - dot(abs(n), half);
        if (!(gap > best.gap) || !(gap > best_face + slack)) continue;
        best.gap = gap;
        best.normal = along < S(0) ? -n : n;
        vec<S, 3> edge;
        for (int k = 0; k < 3; ++k)
            if (k != i) edge[k] = best.normal[k] > S(0) ? half[k] : -half[k];
        best.at = closest_to_axis(i, half[i], s.middle - edge, s.direction, s.half).on_b;
    }
    return best;
}

}  // namespace detail

/// Two capsules: one point between the axes, or two where the axes lie side by side.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const capsule<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const detail::axis_segment<S> s{b_in_a.position, b_in_a.rotation * vec<S, 3>{S(1), S(0), S(0)}, b.half_length};
    const auto closest = closest_to_axis(0, a.half_length, s.middle, s.direction, s.half);
    const vec<S, 3> on_a{closest.on_a, S(0), S(0)}, on_b = s.at(closest.on_b);
    auto [n, gap] = split(on_b - on_a);
    const S reach = a.radius + b.radius, thinner = min(a.radius, b.radius);
    if (gap > reach + margin) return;

    // Of points that all but coincide the direction is chance: try what is across one axis or both.
    const auto parted = [&](vec<S, 3> m) { return dot(m, s.middle) - abs(m.x) * a.half_length - s.reach(m); };
    const S rounding = detail::rounding_of(a.half_length + b.half_length);
    if (!(gap > S(0)) || parted(n) < gap - rounding) {
        const vec<S, 3> d = s.direction;
        vec<S, 3> across{S(0), -d.z, d.y};
        if (across == vec<S, 3>{}) across.y = S(1);
        if (dot(across, s.middle) < S(0)) across = -across;
        const vec<S, 3> along = n - d * dot(d, n),
                        candidates[3] = {across, {S(0), n.y, n.z}, along - d * dot(d, along)};
        bool found = gap > S(0);
        gap = parted(n);
        for (const vec<S, 3>& candidate : candidates) {
            const vec<S, 3> m = normalized(candidate);
            const S by = parted(m);
            if (m == vec<S, 3>{} || (found && !(by > gap))) continue;
            found = true;
            n = m;
            gap = by;
        }
    }
    out.normal = n;

    // Side by side: both ends of what they share, if the axes stay within three degrees of each other there and
    // the surfaces meet along the normal.
    const vec<S, 3> d = s.direction;
    if (abs(n.x) < S(0.05) && max(abs(d.y), abs(d.z)) < S(0.05)) {
        S ends[2] = {-s.half, s.half};
        if (clip_segment(s.middle.x, d.x, a.half_length, ends[0], ends[1]) && ends[1] > ends[0]) {
            vec<S, 3> from_a[2];
            S gaps[2];
            bool beside = true;
            for (int k = 0; k < 2; ++k) {
                from_a[k] = s.at(ends[k]);
                from_a[k].x = S(0);
                gaps[k] = dot(n, from_a[k]);
                beside = beside && largest(from_a[k] - n * gaps[k]) < thinner * S(0.1);
            }
            if (beside && !(min(gaps[0], gaps[1]) > gap + max(thinner * S(1.0 / 512), rounding))) {
                for (int k = 0; k < 2; ++k) {
                    if (gaps[k] - reach > margin) continue;
                    const vec<S, 3> p = s.at(ends[k]);
                    add_rounded(out, p - from_a[k], a.radius, p, b.radius, gaps[k], static_cast<std::uint32_t>(1 + k));
                }
                return;
            }
        }
    }
    if (!(gap - reach > margin)) add_rounded(out, on_a, a.radius, on_b, b.radius, gap, 0u);
}

/// A capsule and a box: the closest points where the axis is outside of the box, the axis of least overlap where
/// it is not; two points where the capsule lies on a face. To keep the features of bodies at rest, contacts may
/// deviate by 1/256 of the smallest size, never more.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    // In the box's frame, with the normal from the box to the capsule until the end.
    const vec<S, 3> h = b.half_extents;
    const detail::axis_segment<S> s{inverse_transform(b_in_a, vec<S, 3>{}),
                                    inverse_rotate(b_in_a.rotation, vec<S, 3>{S(1), S(0), S(0)}), a.half_length};
    const S rounding = detail::rounding_of(s.half + largest(h) + largest(s.middle));
    const S slack = max(min(a.radius, min(h.x, min(h.y, h.z))) * S(1.0 / 512), rounding);
    S at = closest_to_box(s, h);
    const vec<S, 3> nearest = s.at(at);
    const vec<S, 3> offset = nearest - max(-h, min(h, nearest));
    const auto parting = split(offset);
    vec<S, 3> n = parting.direction;
    S gap = parting.length;
    if (gap > a.radius + margin) return;
    // A corner of the box beside the axis: rounding must not tilt the normal along the axis.
    if (abs(at) < s.half && offset.x != S(0) && offset.y != S(0) && offset.z != S(0))
        n = normalized(n - s.direction * dot(s.direction, n));
    // Of points that all but coincide the direction is chance.
    const S parted = dot(n, s.middle) - dot(abs(n), h) - s.reach(n);
    if (!(gap > S(0)) || parted < gap - rounding) {
        const auto best = detail::part_from_box(s, h, slack);
        if (!(gap > S(0)) || best.gap > parted) {
            n = best.normal;
            gap = best.gap;
            at = best.at;
        }
    }

    int face = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(n[i]) > abs(n[face])) face = i;
    const bool upper = n[face] > S(0);
    const std::uint32_t name = static_cast<std::uint32_t>(face << 3 | int{upper} << 2);
    out.normal = -(b_in_a.rotation * n);
    const auto add = [&](S t, S local, std::uint32_t feature) {
        if (local - a.radius > margin) return;
        out.add(b_in_a * (s.at(t) - n * ((local + a.radius) * S(0.5))), local - a.radius, feature);
    };
    // On a face: the part of the axis that the normal leads to the face, both ends of it within three degrees.
    if (abs(n[face]) > S(0.9986)) {
        const S height = s.middle[face] - (upper ? h[face] : -h[face]), rise = s.direction[face];
        S ends[2] = {-s.half, s.half};
        bool above = true;
        for (int i = 0; i < 3 && above; ++i) {
            if (i == face) continue;
            const S lean = n[i] / n[face];
            above =
                clip_segment(s.middle[i] - lean * height, s.direction[i] - lean * rise, h[i] + slack, ends[0], ends[1]);
        }
        const S gaps[2] = {(height + rise * ends[0]) / n[face], (height + rise * ends[1]) / n[face]};
        const std::uint32_t deeper = gaps[1] < gaps[0] ? 1 : 0;
        if (above && !(gaps[deeper] > gap + slack + slack)) {
            const bool lies = abs(dot(n, s.direction)) < S(0.05) && ends[1] > ends[0];
            for (std::uint32_t k = 0; k < 2; ++k)
                if (lies || k == deeper) add(ends[k], gaps[k], name | 2u | k);
            return;
        }
    }
    add(at, gap, name);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/pairs3.hpp
// =================================================================================================
// Contact of the pairs that are particular to space.

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 3>& a, const halfspace<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    // The corners of the face that faces the plane most; one of them is the lowest of all.
    const vec<S, 3> n = plane.normal;
    int across = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(n[i]) > abs(n[across])) across = i;
    for (std::uint32_t name = 0; name < 8; ++name) {
        if ((name >> across & 1u) == std::uint32_t{n[across] > S(0)}) continue;
        vec<S, 3> corner = a.half_extents;
        for (int i = 0; i < 3; ++i)
            if ((name >> i & 1u) == 0) corner[i] = -corner[i];
        detail::touch_plane(corner, S(0), n, plane.offset, margin, name, out);
    }
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/surface.hpp
// =================================================================================================
// Contact with surfaces made of flat parts, such as meshes and chains, without bumps where parts meet.

PHYSICS_HPP_BEGIN

namespace detail {

/// The direction in the part's plane that leads out over end or edge i, of any length.
inline point<2> outwards(const surface_part<2>& p, int i) {
    const point<2> e = p.corner[1] - p.corner[0];
    return i == 0 ? -e : e;
}
inline point<3> outwards(const surface_part<3>& p, int i) {
    return cross(p.corner[i < 2 ? i + 1 : 0] - p.corner[i], p.normal);
}

inline void turn_round(surface_part<2>& p) {
    std::swap(p.corner[0], p.corner[1]);
    std::swap(p.beyond[0], p.beyond[1]);
    std::swap(p.continues[0], p.continues[1]);
}
inline void turn_round(surface_part<3>& p) {
    std::swap(p.corner[0], p.corner[1]);
    std::swap(p.beyond[1], p.beyond[2]);
    std::swap(p.continues[1], p.continues[2]);
}

/// Unit vectors may deviate by as much and count as the same.
inline constexpr double same_direction = 1e-4;

/// Whether a body that touches the part along the unit vector m touches the part itself: m leads out over no end or
/// edge beyond which the surface goes on, unless that bends away and m lies before its normal. Source: the idea is that
/// of ghost vertices, Catto, Box2D (2010).
template <int D>
bool owns(const surface_part<D>& p, const point<D>& m) {
    constexpr double blur = same_direction;
    const double up = dot(m, p.normal);
    bool around_edge = false;
    for (int i = 0; i < D; ++i) {
        const point<D> out = unit(outwards(p, i));
        const double lean = dot(m, out);
        if (!(lean > blur)) continue;
        around_edge = true;
        if (!p.continues[i]) continue;
        const double bend = dot(p.beyond[i], out), beyond_up = dot(p.beyond[i], p.normal);
        if (!(bend > blur) || lean * beyond_up - up * bend > blur) return false;
    }
    return around_edge || up > 0;
}

template <int D>
core<D> core_of_part(const surface_part<D>& p, double radius) {
    core<D> c;
    c.kind = D == 2 ? core_kind::segment : core_kind::triangle;
    c.radius = radius;
    for (int i = 0; i < D; ++i) {
        c.corner[i] = p.corner[i];
        c.center += p.corner[i] * (1.0 / D);
        for (int k = 0; k < D; ++k) c.extent = max(c.extent, abs(p.corner[i][k]) * D);
    }
    // A surface has no thickness that would be small beside the body's.
    c.thickness = no_limit;
    return c;
}

/// What deviation is small where a body touches a part (m): that of slack_of(), since parts have no thickness.
template <class S, int D>
double slack_beside(const surface_part<D>& part, const placed_core<D>& body) {
    double size = body.shape->extent + largest(body.at);
    for (int i = 0; i < D; ++i) size = max(size, largest(part.corner[i]) * D);
    const double rounding = static_cast<double>(rounding_of(S(1))) * (is_fixed<S> ? max(size, 1.0) : size);
    return max((body.shape->thickness + body.shape->radius) * (1.0 / 512), rounding);
}

/// Adds the body's lowest point where it stands above the part and lies deeper than the points that were found: of
/// round shapes, of faces that were thinned out, and of hulls that turn another face to the part.
template <int D>
void touch_lowest(const surface_part<D>& p, const point<D>& lowest, const patch_limits& by, manifold<double, D>& out) {
    const manifold_point<double, D> found =
        touching(lowest, p.normal, dot(p.normal, lowest - p.corner[0]), by, 0x80000000u);
    double deepest = by.margin + by.slack;
    int shallowest = 0;
    for (int i = 0; i < out.count; ++i) {
        deepest = min(deepest, out.points[i].separation);
        if (out.points[i].separation > out.points[shallowest].separation) shallowest = i;
    }
    if (!(found.separation < deepest - by.slack)) return;
    for (int i = 0; i < D; ++i) {
        const point<D> over = outwards(p, i);
        const double beyond = dot(over, lowest - p.corner[i]);
        if (beyond > 0 && beyond * beyond > by.slack * by.slack * dot(over, over)) return;
    }
    out.normal = p.normal;
    out.points[out.count < manifold<double, D>::capacity ? out.count++ : shallowest] = found;
}

/// What a body turns towards parts, kept from part to part: most lie in few planes.
template <int D>
struct turned_facet {
    facet<D> ground, above;
    /// The normal of the parts that `above` is for; null at first.
    point<D> normal;

    const facet<D>& of(const placed_core<D>& body, const point<D>& n) {
        if (n == normal) return above;
        normal = n;
        above = facet_of(body, -n);
        return above;
    }
};

/// What stands above a part, and how far.
template <int D>
void touch_above(const surface_part<D>& part, const placed_core<D>& body, const point<D>& lowest,
                 const patch_limits& by, turned_facet<D>& facets, manifold<double, D>& out) {
    const facet<D>& above = facets.of(body, part.normal);
    if (above.count == 0) {
        touch_lowest(part, lowest, by, out);
        return;
    }
    facet<D>& ground = facets.ground;
    ground.count = D;
    ground.flat = true;
    ground.normal = part.normal;
    for (int i = 0; i < D; ++i) ground.corner[i] = part.corner[i];
    clip_facets(ground, part.normal, no_limit, above, false, by, out);
    if constexpr (D == 3) touch_lowest(part, lowest, by, out);
}

/// Contact of one part of a surface, rounded by `radius`, with a core that stands in the surface's frame. The normal is
/// the part's own but where the core touches an end or an edge that stands out. False if the contact is in doubt: there
/// is a shorter way to part the two, over an edge that the surface goes on beyond, so that the body may as well stand
/// beside the part and touch a neighbour of it. Where the two overlap and nothing is found, `last_resort` becomes the
/// way to part them, if it holds no deeper one.
template <class S, int D>
bool touch_part(surface_part<D> part, double radius, const placed_core<D>& body, double margin, overlap_method method,
                turned_facet<D>& facets, manifold<double, D>& out, manifold<double, D>& last_resort) {
    const point<D> center = body.axes * body.shape->center + body.at;
    if (dot(part.normal, center - part.corner[0]) < 0) {
        if (!part.two_sided) return true;
        turn_round(part);
        part.normal = -part.normal;
        for (point<D>& n : part.beyond) n = -n;
    }
    const point<D> n = part.normal, lowest = body.support(-n).at;
    const double radii = radius + body.shape->radius, reach = radii + margin;
    const double height = dot(n, lowest - part.corner[0]);
    if (height > reach) return true;
    // The ways out over ends or edges, and whether the surface goes on there as it is or rises.
    double aside = -no_limit;
    bool closed = true;
    for (int i = 0; i < D; ++i) {
        const point<D> over = unit(outwards(part, i));
        aside = max(aside, dot(over, body.support(-over).at - part.corner[i]));
        closed = closed && part.continues[i] && !(dot(part.beyond[i], over) > same_direction);
    }
    if (aside > reach) return true;

    const double slack = slack_beside<S>(part, body);
    const patch_limits by{radius, body.shape->radius, margin, slack};
    touch_above(part, body, lowest, by, facets, out);
    double deepest = no_limit;
    for (int i = 0; i < out.count; ++i) deepest = min(deepest, out.points[i].separation);
    // Neighbours that rise leave a body no way out over an edge; and where its lowest point stands above the part, none
    // can be much shorter than a short way up.
    const bool upwards = height >= 0 || aside <= height + 2 * slack;
    const bool above = height >= -8 * slack && deepest <= height - radii + slack;
    if (closed || (upwards && above)) return upwards;

    const core_pair<D> pair(core_of_part(part, radius), *body.shape, body.axes, body.at);
    core_separation<D> s = separate<S>(pair, reach, nullptr, method);
    if (s.beyond || s.gap > reach) {
        out = {};
        return true;
    }
    const bool flat = height >= s.gap - 2 * slack, own = owns(part, s.normal);
    const auto touch_once = [&](manifold<double, D>& m) {
        locate(pair, s);
        m = {};
        m.normal = s.normal;
        m.points[m.count++] = touching<D>(s.on_a + s.normal * s.gap, s.normal, s.gap, by, 0x80000000u);
    };
    if (!own) {
        const double depth = radii - s.gap;
        if (out.count == 0 && depth > 0 && (last_resort.count == 0 || depth > -last_resort.points[0].separation))
            touch_once(last_resort);
        return flat;
    }
    if (flat && deepest < s.gap - radii + 2 * slack) return true;
    out = {};
    touch_parted(pair, s, margin, slack, out);
    if (out.count > 0 && owns(part, out.normal)) return true;
    touch_once(out);
    return true;
}

/// Whether a part and a core that has moved are parted, or all but.
template <class S, int D>
bool parted(const surface_part<D>& part, double radius, const placed_core<D>& body, const point<D>& moved) {
    const core_pair<D> pair(core_of_part(part, radius), *body.shape, body.axes, body.at + moved);
    const double reach = radius + body.shape->radius;
    const gjk_result<D> r = gjk(pair.a, pair.placed, reach, relative_tolerance<S>(), nullptr);
    return r.beyond || (!r.overlapping && r.distance >= reach);
}

/// The parts of a surface that a body touches and that are in doubt; where there are more, the rest counts as certain.
template <int D>
struct doubtful_parts {
    static constexpr int most = 16;
    raw_array<surface_part<D>, most> part;
    std::uint32_t place[most];
    int count = 0;

    void add(const surface_part<D>& p, std::uint32_t in_list) {
        if (count == most) return;
        part[count] = p;
        place[count++] = in_list;
    }
    [[nodiscard]] bool holds(std::uint32_t in_list) const {
        for (int k = 0; k < count; ++k)
            if (place[k] == in_list) return true;
        return false;
    }
    void remove(int k) {
        part[k] = part[--count];
        place[k] = place[count];
    }
};

template <class S, int D>
double depth_of(const manifold<S, D>& m) {
    double depth = 0;
    for (int i = 0; i < m.count; ++i) depth = max(depth, -static_cast<double>(m.points[i].separation));
    return depth;
}

/// Drops the doubtful ones among the contacts of a body, from `first` on, that another contact undoes: with the body
/// moved out of that, it does not touch the part any more. The least deep ones are believed first.
template <class S, int D, class List>
void drop_doubtful(List& list, std::uint32_t first, doubtful_parts<D>& doubtful, double radius,
                   const placed_core<D>& body, double slack) {
    const auto other_way = [&](std::uint32_t i, std::uint32_t j) {
        return !(dot(list[i].contact.normal, list[j].contact.normal) > S(0.875));
    };
    bool one_way = true;
    for (std::uint32_t i = first; i < list.size(); ++i) one_way = one_way && !other_way(first, i);
    while (!one_way && doubtful.count > 0) {
        int least = 0;
        for (int k = 1; k < doubtful.count; ++k)
            if (depth_of(list[doubtful.place[k]].contact) < depth_of(list[doubtful.place[least]].contact)) least = k;
        const std::uint32_t here = doubtful.place[least];
        auto& contact = list[here].contact;
        for (std::uint32_t i = first; i < list.size() && contact.count > 0; ++i) {
            const auto& other = list[i].contact;
            const double depth = depth_of(other);
            if (depth > 0 && other_way(i, here) && !doubtful.holds(i) &&
                parted<S>(doubtful.part[least], radius, body, to_point(other.normal) * (depth + 2 * slack)))
                contact.count = 0;
        }
        doubtful.remove(least);
    }
}

/// Joins the manifolds from `first` on whose normals are alike, and reduces the points of each.
template <class S, int D, class List>
void join_alike(List& list, std::uint32_t first, S slack) {
    const S alike = S(0.9995);
    std::uint32_t kept = first;
    for (std::uint32_t i = first; i < list.size(); ++i) {
        if (list[i].contact.count == 0) continue;
        auto joined = list[i];
        manifold_point<S, D> points[most_candidates];
        int count = 0;
        const auto thin_out = [&] {
            manifold<S, D> fewer;
            fewer.normal = joined.contact.normal;
            reduce(points, count, joined.contact.normal, slack, fewer);
            count = fewer.count;
            for (int k = 0; k < count; ++k) points[k] = fewer.points[k];
        };
        for (std::uint32_t j = i; j < list.size(); ++j) {
            auto& other = list[j].contact;
            if (other.count == 0 || !(dot(other.normal, joined.contact.normal) > alike)) continue;
            if (count + other.count > most_candidates) thin_out();
            for (int k = 0; k < other.count; ++k) points[count++] = other.points[k];
            joined.part = list[j].part < joined.part ? list[j].part : joined.part;
            other.count = 0;
        }
        if (count > manifold<S, D>::capacity) thin_out();
        joined.contact.count = count;
        for (int k = 0; k < count; ++k) joined.contact.points[k] = points[k];
        list[kept++] = joined;
    }
    while (list.size() > kept) list.pop();
}

/// The box around a core that stands somewhere, grown by a margin.
template <int D>
aabb<double, D> bounds_of(const placed_core<D>& c, double margin) {
    aabb<double, D> box;
    for (int i = 0; i < D; ++i) {
        point<D> n;
        n[i] = 1;
        box.upper[i] = c.support(n).at[i] + c.shape->radius + margin;
        box.lower[i] = c.support(-n).at[i] - c.shape->radius - margin;
    }
    return box;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/parts.hpp
// =================================================================================================
// Contact of shapes that are made of parts: surfaces and compounds.

PHYSICS_HPP_BEGIN

/// What a narrowphase found: a manifold, the number of the query that it answers, and of which part of concave shapes.
template <class S, int D>
struct found_manifold {
    std::uint32_t query;
    std::uint32_t part;
    manifold<S, D> contact = {};
};
/// Manifolds in ascending order of queries; none for shapes that are too far apart, several for concave shapes.
template <class S, int D>
using manifold_list = buffer<found_manifold<S, D>>;

namespace detail {

struct nobody {
    template <class T>
    void operator()(const T&) const {}
};
/// A shape made of flat parts: each_part(shape, box, f) calls f(surface_part) for those that may reach into the box, in
/// the shape's frame; it has a `radius`.
template <class Shape, int D>
concept is_surface = requires(const Shape s, const aabb<double, D> box) { each_part(s, box, nobody{}); };
/// A shape made of convex shapes: each_child(shape, box, f) calls f(compound_child) likewise.
template <class Shape, int D>
concept is_compound = requires(const Shape s, const aabb<double, D> box) { each_child(s, box, nobody{}); };

/// Calls f(core where it stands, number) for the convex shapes that a solid consists of and that may reach into the
/// box, which is given in the frame that `axes` and `at` lead to.
template <class Shape, int D, class F>
void each_solid(const Shape& shape, const mat<double, D>& axes, const point<D>& at, const aabb<double, D>& box, F&& f) {
    if constexpr (has_core<Shape>) {
        const core<D> c = core_of(shape);
        f(placed_core<D>{&c, axes, at}, 0u);
    } else {
        // The box as seen from the compound, by its middle and half extents.
        const point<D> middle = transposed_times(axes, (box.lower + box.upper) * 0.5 - at);
        const point<D> half = (box.upper - box.lower) * 0.5;
        point<D> reach;
        for (int i = 0; i < D; ++i)
            for (int k = 0; k < D; ++k) reach[i] += abs(axes.column[i][k]) * half[k];
        each_child(shape, aabb<double, D>{middle - reach, middle + reach}, [&](const auto& child) {
            f(placed_core<D>{&child.shape, axes * child.axes, axes * child.at + at}, child.number);
        });
    }
}
template <class S>
aabb<double, 2> everywhere(const rotation<S, 2>&) {
    return {{-no_limit, -no_limit}, {no_limit, no_limit}};
}
template <class S>
aabb<double, 3> everywhere(const rotation<S, 3>&) {
    return {{-no_limit, -no_limit, -no_limit}, {no_limit, no_limit, no_limit}};
}
/// Where a shape made of parts can be touched; everywhere unless its geometry says what box it fills.
template <class A, class S, int D>
aabb<double, D> box_of_parts(const A& a, const transform<S, D>& b_in_a, double reach) {
    if constexpr (requires { { a.geometry->box } -> std::convertible_to<aabb<double, D>>; })
        return grown(a.geometry->box, reach);
    else
        return everywhere(b_in_a.rotation);
}

/// Adds the contacts of A, a compound, with a halfspace.
template <class A, class S, int D>
void collide_children_with_plane(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                                 std::uint32_t query, manifold_list<S, D>& out) {
    const bounding_half<D> half(b, b_in_a);
    each_child(a, everywhere(b_in_a.rotation), [&](const auto& child) {
        manifold<double, D> m;
        touch_half<S>(placed_core<D>{&child.shape, child.axes, child.at}, half, detail::to_double(margin), m);
        if (m.count == 0) return;
        add_rounded_once(m, out.emplace(query, child.number).contact);
        for (int i = 0; i < m.count; ++i) out.back().contact.points[i].feature += mixed(child.number, 0);
    });
}

/// Adds the contacts of A, a surface or a compound, with B, a compound or any shape that has a core.
template <class A, class B, class S, int D>
void collide_parts(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, overlap_method method,
                   std::uint32_t query, manifold_list<S, D>& out) {
    const mat<double, D> axes = to_matrix(b_in_a.rotation);
    const point<D> at = to_point(b_in_a.position);
    const double reach = detail::to_double(margin);
    const std::uint32_t first = out.size();
    double slack = 0;
    const auto add = [&](const manifold<double, D>& m, std::uint32_t of_a, std::uint32_t of_b) {
        if (m.count == 0) return;
        auto& found = out.emplace(query, of_a);
        add_rounded_once(m, found.contact);
        for (int i = 0; i < m.count; ++i) found.contact.points[i].feature += mixed(of_a, of_b);
    };
    if constexpr (is_surface<A, D>) {
        const double radius = detail::to_double(a.radius);
        each_solid(b, axes, at, box_of_parts(a, b_in_a, radius + reach), [&](const auto& body, std::uint32_t of_b) {
            const double slack_of_body = (body.shape->thickness + body.shape->radius) * (1.0 / 512);
            const std::uint32_t first_of_body = out.size();
            doubtful_parts<D> doubtful;
            manifold<double, D> last_resort;
            turned_facet<D> facets;
            std::uint32_t last_part = 0xffffffffu;
            slack = max(slack, slack_of_body);
            each_part(a, bounds_of(body, radius + reach), [&](const surface_part<D>& part) {
                manifold<double, D> m;
                const bool certain = touch_part<S>(part, radius, body, reach, method, facets, m, last_resort);
                add(m, part.number, of_b);
                if (!certain && m.count > 0) doubtful.add(part, out.size() - 1);
                last_part = part.number < last_part ? part.number : last_part;
            });
            if (out.size() == first_of_body) add(last_resort, last_part, of_b);
            drop_doubtful<S, D>(out, first_of_body, doubtful, radius, body, slack_of_body);
        });
        join_alike<S, D>(out, first, static_cast<S>(slack));
    } else {
        each_solid(b, axes, at, box_of_parts(a, b_in_a, reach), [&](const placed_core<D>& body, std::uint32_t of_b) {
            each_child(a, bounds_of(body, reach), [&](const auto& child) {
                const mat<double, D> back = transposed(child.axes);
                const core_pair<D> pair(child.shape, *body.shape, back * body.axes, back * (body.at - child.at));
                manifold<double, D> m;
                touch_cores<S>(pair, reach, nullptr, method, m);
                m.normal = child.axes * m.normal;
                for (int i = 0; i < m.count; ++i) m.points[i].position = child.axes * m.points[i].position + child.at;
                add(m, child.number, of_b);
            });
        });
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/persistent_manifold.hpp
// =================================================================================================
// Manifolds that gather one point a step.

PHYSICS_HPP_BEGIN

/// What an incremental narrowphase remembers of a pair: where GJK ended, and the deepest points of the last steps, each
/// in the frames of both shapes. Start with an empty one, and use it for one pair of shapes only.
template <class S, int D>
struct persistent_manifold {
    struct point {
        vec<S, D> on_a, on_b;
        std::uint32_t feature = 0;
    };
    gjk_cache cache;
    point points[manifold<S, D>::capacity];
    std::int32_t count = 0;
    /// How many points there have been, which names them.
    std::uint32_t named = 0;
};

namespace detail {

/// Where a remembered point lies now, seen from A along the normal.
template <class S, int D>
constexpr manifold_point<S, D> where_now(const typename persistent_manifold<S, D>::point& p,
                                         const transform<S, D>& b_in_a, vec<S, D> n) {
    const vec<S, D> apart = b_in_a * p.on_b - p.on_a;
    return {p.on_a + apart * S(0.5), dot(apart, n), p.feature};
}

/// Forgets the points that have parted, or slid aside, by more than they may.
template <class S, int D>
constexpr void drop_stale(persistent_manifold<S, D>& m, const transform<S, D>& b_in_a, vec<S, D> n, S margin, S far) {
    std::int32_t kept = 0;
    for (std::int32_t i = 0; i < m.count; ++i) {
        const vec<S, D> apart = b_in_a * m.points[i].on_b - m.points[i].on_a;
        const S along = dot(apart, n);
        if (!(along > margin) && !(largest(apart - n * along) > far)) m.points[kept++] = m.points[i];
    }
    m.count = kept;
}

/// Adds a point; one that lies as near as `far` to another takes its place and name. Where there is no room, what
/// spans least of the contact goes.
template <class S, int D>
constexpr void add_point(persistent_manifold<S, D>& m, vec<S, D> on_a, vec<S, D> on_b, const transform<S, D>& b_in_a,
                         vec<S, D> n, S far, S slack) {
    for (std::int32_t i = 0; i < m.count; ++i) {
        if (largest(m.points[i].on_a - on_a) > far && largest(m.points[i].on_b - on_b) > far) continue;
        m.points[i].on_a = on_a;
        m.points[i].on_b = on_b;
        return;
    }
    constexpr int most = manifold<S, D>::capacity;
    const typename persistent_manifold<S, D>::point added{on_a, on_b, m.named++};
    if (m.count < most) {
        m.points[m.count++] = added;
        return;
    }
    manifold_point<S, D> all[most + 1];
    all[0] = where_now<S, D>(added, b_in_a, n);
    for (int i = 0; i < most; ++i) all[i + 1] = where_now<S, D>(m.points[i], b_in_a, n);
    manifold<S, D> kept;
    reduce(all, most + 1, n, slack, kept);
    const auto is_kept = [&](std::uint32_t feature) {
        for (int i = 0; i < kept.count; ++i)
            if (kept.points[i].feature == feature) return true;
        return false;
    };
    for (auto& p : m.points) {
        if (is_kept(p.feature)) continue;
        p = added;
        return;
    }
}

/// Contact of two shapes by the deepest point of this step and those of the last ones that still hold. Source: van den
/// Bergen, Collision detection in interactive 3D environments (2003), 4.3.6; Coumans, Contact generation (GDC 2010).
template <class A, class B, class S, int D>
void gather_contact(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, overlap_method method,
                    persistent_manifold<S, D>& m, manifold<S, D>& out) {
    if (m.count == 0) {
        if (still_parted(a, b, b_in_a, margin, m.cache)) return;
        m.cache = {};
    }
    const core_pair<D> pair(a, b, b_in_a);
    const double reach = pair.a.radius + pair.b.radius + detail::to_double(margin);
    core_separation<D> s = separate<S>(pair, reach, &m.cache, method);
    if (s.beyond || s.gap > reach) {
        m.count = 0;
        m.cache.count = 0;
        return;
    }
    const closest_points<S, D> now = rounded<S>(pair, s);
    // A point holds while it slides by no more than a small part of the smaller shape.
    const S far = static_cast<S>(min(pair.a.extent + pair.a.radius, pair.b.extent + pair.b.radius) * (1.0 / 32));
    drop_stale(m, b_in_a, now.normal, margin, far);
    add_point(m, now.on_a, inverse_transform(b_in_a, now.on_b), b_in_a, now.normal, far,
              static_cast<S>(slack_of<S>(pair)));
    out.normal = now.normal;
    for (std::int32_t i = 0; i < m.count; ++i)
        out.points[out.count++] = where_now<S, D>(m.points[i], b_in_a, now.normal);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/pair_table.hpp
// =================================================================================================
// What each pair of kinds of shapes does to meet.

PHYSICS_HPP_BEGIN

/// True if the pair has a function of its own, in this order.
template <class A, class B, class S, int D>
concept collides_by_itself = requires(const A a, const B b, const transform<S, D> t, S margin, manifold<S, D> out) {
    collide(a, b, t, margin, out);
};

/// One pair of shapes to test.
template <class S, int D, template <class, int> class... Shapes>
struct narrowphase_query {
    const any_shape<S, D, Shapes...>* a;
    const any_shape<S, D, Shapes...>* b;
    transform<S, D> b_in_a;
    /// Which of the memories is this pair's.
    std::uint32_t memory = no_memory;

    static constexpr std::uint32_t no_memory = 0xffffffffu;
};

namespace detail {

template <class Shape>
constexpr bool is_halfspace = false;
template <class S, int D>
constexpr bool is_halfspace<halfspace<S, D>> = true;

/// True if the general kernels serve a pair, in this order.
template <class A, class B>
concept collides_by_cores = has_core<A> && (has_core<B> || is_halfspace<B>);

/// True if a pair meets part by part, in this order. Surfaces and halfspaces carry no mass and never meet.
template <class A, class B, int D>
concept collides_by_parts =
    (is_surface<A, D> && (has_core<B> || is_compound<B, D> || is_surface<B, D> || is_halfspace<B>)) ||
    (is_compound<A, D> && (has_core<B> || is_compound<B, D> || is_halfspace<B>));

/// How a narrowphase treats pairs of convex shapes.
struct pair_methods {
    /// Whether closed forms serve pairs that the general kernels could.
    bool closed_forms = true;
    /// Whether a manifold gathers the deepest points of several steps; otherwise each step finds all of it.
    bool persistent = false;
    overlap_method overlaps = overlap_method::epa;
};

/// Whether a closed form serves a pair, in either order.
template <pair_methods Methods, class A, class B, class S, int D>
constexpr bool is_closed = (Methods.closed_forms || !(collides_by_cores<A, B> || collides_by_cores<B, A>)) &&
                           (collides_by_itself<A, B, S, D> || collides_by_itself<B, A, S, D>);

/// Whether a closed form costs more than to carry along what it found.
template <class A, class B>
constexpr bool is_dear = false;
template <class S>
constexpr bool is_dear<box<S, 3>, box<S, 3>> = true;
template <class S>
constexpr bool is_dear<capsule<S, 3>, box<S, 3>> = true;
template <class A, class S>
constexpr bool is_dear<A, hull<S, 2>> = true;

/// Whether it pays to remember what was found of a pair.
template <pair_methods Methods, class A, class B, class S, int D>
constexpr bool is_remembered = has_core<A> && has_core<B> &&
                               (!is_closed<Methods, A, B, S, D> || is_dear<A, B> || is_dear<B, A>);

/// Functions for every ordered pair of a closed set of shapes, by their numbers within it.
template <pair_methods Methods, class S, int D, template <class, int> class... Shapes>
struct pair_table {
    using any = any_shape<S, D, Shapes...>;
    using query = narrowphase_query<S, D, Shapes...>;
    using memory = std::conditional_t<Methods.persistent, persistent_manifold<S, D>, pair_memory<S, D>>;
    using function = void (*)(const query&, std::uint32_t, S, memory*, manifold_list<S, D>&);

    /// What is remembered of a query's pair; null if nothing is.
    static memory* recalled(const query& q, memory* memories) {
        return memories != nullptr && q.memory != query::no_memory ? memories + q.memory : nullptr;
    }
    /// Adds what query q, of that number, finds; with what is remembered of the pair, if it is worth it.
    template <class A, class B>
    static void run(const query& q, std::uint32_t number, S margin, memory* m, manifold_list<S, D>& out) {
        const A& a = q.a->template get<A>();
        const B& b = q.b->template get<B>();
        if constexpr (collides_by_parts<A, B, D>) {
            run_parts(a, b, q.b_in_a, number, margin, out);
        } else if constexpr (collides_by_parts<B, A, D>) {
            const std::uint32_t first = out.size();
            run_parts(b, a, inverse(q.b_in_a), number, margin, out);
            for (std::uint32_t i = first; i < out.size(); ++i) turn_round(out[i].contact, q.b_in_a);
        } else {
            found_manifold<S, D>& found = out.emplace(number, 0u);
            run_convex(a, b, q.b_in_a, margin, m, found.contact);
            if (found.contact.count == 0) out.pop();
        }
    }
    template <class A, class B>
    static void run_parts(const A& a, const B& b, const transform<S, D>& b_in_a, std::uint32_t number, S margin,
                          manifold_list<S, D>& out) {
        if constexpr (has_core<B> || is_compound<B, D>)
            collide_parts(a, b, b_in_a, margin, Methods.overlaps, number, out);
        else if constexpr (is_compound<A, D> && is_halfspace<B>)
            collide_children_with_plane(a, b, b_in_a, margin, number, out);
    }
    static void turn_round(manifold<S, D>& m, const transform<S, D>& b_in_a) {
        m.normal = -(b_in_a.rotation * m.normal);
        for (int i = 0; i < m.count; ++i) m.points[i].position = b_in_a * m.points[i].position;
    }
    template <class A, class B>
    static void run_convex(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, memory* m,
                           manifold<S, D>& out) {
        if constexpr (!is_remembered<Methods, A, B, S, D>) {
            run(a, b, b_in_a, margin, nullptr, out);
        } else if constexpr (Methods.persistent) {
            memory none;
            gather_contact(a, b, b_in_a, margin, Methods.overlaps, m != nullptr ? *m : none, out);
        } else if (m == nullptr) {
            run(a, b, b_in_a, margin, nullptr, out);
        } else if (is_still(*m, b_in_a)) {
            carry_along(*m, b_in_a, margin, out);
        } else {
            if (m->contact.count == 0) {
                if (still_parted(a, b, b_in_a, margin, m->cache)) return;
                m->cache = {};
            }
            run(a, b, b_in_a, margin, &m->cache, out);
            remember(a, b, b_in_a, out, *m);
        }
    }
    template <class A, class B>
    static void run(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                    manifold<S, D>& out) {
        if constexpr (is_closed<Methods, A, B, S, D>) {
            if constexpr (collides_by_itself<A, B, S, D>) collide(a, b, b_in_a, margin, out);
            else run_swapped(a, b, b_in_a, margin, cache, out);
        } else if constexpr (has_core<A> && has_core<B>) {
            // One order is made of the other, so that both say the same.
            if constexpr (any::template kind_of<A>() > any::template kind_of<B>())
                run_swapped(a, b, b_in_a, margin, cache, out);
            else
                collide_cores(a, b, b_in_a, margin, cache, Methods.overlaps, out);
        } else if constexpr (has_core<A> && is_halfspace<B>) {
            collide_with_plane(a, b, b_in_a, margin, out);
        } else {
            run_swapped(a, b, b_in_a, margin, cache, out);
        }
    }
    template <class A, class B>
    static void run_swapped(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                            manifold<S, D>& out) {
        run(b, a, inverse(b_in_a), margin, cache, out);
        turn_round(out, b_in_a);
    }
    template <class A>
    static constexpr void fill_row(function* row, bool* remembered) {
        int i = 0;
        ((row[i] = run<A, Shapes<S, D>>, remembered[i++] = is_remembered<Methods, A, Shapes<S, D>, S, D>), ...);
    }
    struct rows {
        function entry[sizeof...(Shapes)][sizeof...(Shapes)];
        bool remembered[sizeof...(Shapes)][sizeof...(Shapes)];
    };
    static constexpr rows make() {
        rows t{};
        int i = 0;
        ((fill_row<Shapes<S, D>>(t.entry[i], t.remembered[i]), ++i), ...);
        return t;
    }
    static constexpr rows table = make();
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/box_batch.hpp
// =================================================================================================
// Boxes among the pairs of a narrowphase: met in lanes, and handed back to their places.

PHYSICS_HPP_BEGIN

namespace detail {

template <class Shape, class... Shapes>
constexpr bool is_among = (std::same_as<Shape, Shapes> || ...);

/// The manifolds of the pairs of boxes among some queries of a narrowphase.
template <pair_methods Methods, class S, int D, template <class, int> class... Shapes>
class box_batch {
    using table = pair_table<Methods, S, D, Shapes...>;
    using query = typename table::query;
    using memory = typename table::memory;
    using box = physics::box<S, D>;

public:
    static constexpr std::uint32_t most = 64;
    static constexpr bool is_used = Methods.closed_forms && !Methods.persistent && is_among<box, Shapes<S, D>...>;

    /// Meets the boxes among up to `most` queries.
    box_batch(const query* queries, std::uint32_t count, S margin, memory* memories) {
        constexpr int kind = table::any::template kind_of<box>();
        for (std::uint32_t i = 0; i < count; ++i) {
            const query& q = queries[i];
            const bool boxes = q.a->kind() == kind && q.b->kind() == kind;
            place_[i] = boxes ? place_of({&q.a->template get<box>(), &q.b->template get<box>(), &q.b_in_a},
                                         table::recalled(q, memories), margin)
                              : elsewhere;
        }
        if constexpr (D == 2) {
            collide_boxes(pairs_.items, met_, margin, found_.items);
        } else {
            raw_array<int, most> parting;
            collide_boxes(pairs_.items, met_, margin, found_.items, parting.items);
            for (std::uint32_t k = 0; k < met_; ++k) {
                if (owner_[k] == nullptr) continue;
                remember(*pairs_[k].a, *pairs_[k].b, *pairs_[k].b_in_a, found_[k], *owner_[k]);
                owner_[k]->parting = parting[k];
            }
        }
    }
    /// Whether query i is a pair of boxes, and adds its manifold to the list if it has one, under that number.
    bool add(std::uint32_t i, std::uint32_t number, manifold_list<S, D>& out) const {
        if (place_[i] == elsewhere) return false;
        if (place_[i] != apart && found_[place_[i]].count > 0) out.emplace(number, 0u, found_[place_[i]]);
        return true;
    }

private:
    static constexpr std::uint8_t elsewhere = 0xff, apart = 0xfe;

    std::uint8_t place_of(const box_pair<S, D>& pair, memory* m, S margin) {
        if constexpr (D == 3)
            if (m != nullptr) {
                if (is_still(*m, *pair.b_in_a)) {
                    // From behind: those that are met lie side by side.
                    manifold<S, D>& carried = found_[most - ++carried_];
                    carried = {};
                    carry_along(*m, *pair.b_in_a, margin, carried);
                    return static_cast<std::uint8_t>(most - carried_);
                }
                if (m->contact.count == 0 && m->parting >= 0 &&
                    parted_along(*pair.a, *pair.b, *pair.b_in_a, m->parting, margin))
                    return apart;
            }
        owner_[met_] = m;
        pairs_[met_] = pair;
        return static_cast<std::uint8_t>(met_++);
    }

    std::uint32_t met_ = 0, carried_ = 0;
    raw_array<std::uint8_t, most> place_;
    raw_array<memory*, most> owner_;
    raw_array<box_pair<S, D>, most> pairs_;
    raw_array<manifold<S, D>, most> found_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/narrowphase.hpp
// =================================================================================================
// The narrowphase policy: from pairs of shapes to manifolds.

PHYSICS_HPP_BEGIN

/// True if the pair can meet: a function collide(a, b, ...) exists in either order, or the general kernels serve it, as
/// both have a core (see core.hpp) or consist of parts (see parts.hpp).
template <class A, class B, class S, int D>
concept collidable = collides_by_itself<A, B, S, D> || collides_by_itself<B, A, S, D> ||
                     detail::collides_by_cores<A, B> || detail::collides_by_cores<B, A> ||
                     detail::collides_by_parts<A, B, D> || detail::collides_by_parts<B, A, D>;

/// A narrowphase policy: turns a batch of pairs into manifolds. Its in<S, D, Shapes...> has
///   collide(queries, count, margin, list)   adds to a manifold_list where shapes touch that are within margin (m)
///                                           of each other
/// and, if it remembers something of pairs from step to step,
///   memory                                  what it remembers of one pair; trivially copyable, new ones are made by
///                                           memory{}, digest() is 64 bits of it for world.state_hash()
///   remembers(kind, kind)                   whether it does so of shapes of those kinds
///   collide(queries, count, margin, memories, list)
///                                           the same; queries name their memory among these
/// What it remembers of pairs that do not touch must not bear on any result, and have the digest 0: which of these
/// there are depends on the broadphase.
template <class Policy, class S, int D, template <class, int> class... Shapes>
concept narrowphase_for =
    requires(const narrowphase_query<S, D, Shapes...>* queries, manifold_list<S, D> found) {
        Policy::template in<S, D, Shapes...>::collide(queries, std::uint32_t{}, S(0), found);
    };

namespace detail {

/// A narrowphase that treats each pair with the function that its table has for it; pairs of boxes several at a time.
template <pair_methods Methods>
struct pairwise_narrowphase {
    using stage = physics::stage::narrowphase;

    template <class S, int D, template <class, int> class... Shapes>
    struct in {
        using query = narrowphase_query<S, D, Shapes...>;
        using pairs = pair_table<Methods, S, D, Shapes...>;
        using memory = typename pairs::memory;

        static constexpr bool remembers(int kind_a, int kind_b) {
            return pairs::table.remembered[kind_a][kind_b];
        }
        static void collide(const query* queries, std::uint32_t count, S margin, memory* memories,
                            manifold_list<S, D>& found) {
            using boxes = box_batch<Methods, S, D, Shapes...>;
            if constexpr (boxes::is_used) {
                for (std::uint32_t first = 0; first < count; first += boxes::most) {
                    const std::uint32_t part = count - first < boxes::most ? count - first : boxes::most;
                    const boxes batch(queries + first, part, margin, memories);
                    for (std::uint32_t i = 0; i < part; ++i)
                        if (!batch.add(i, first + i, found)) collide_one(queries, first + i, margin, memories, found);
                }
            } else {
                for (std::uint32_t i = 0; i < count; ++i) collide_one(queries, i, margin, memories, found);
            }
        }
        static void collide(const query* queries, std::uint32_t count, S margin, manifold_list<S, D>& found) {
            collide(queries, count, margin, nullptr, found);
        }

    private:
        static void collide_one(const query* queries, std::uint32_t i, S margin, memory* memories,
                                manifold_list<S, D>& found) {
            const query& q = queries[i];
            pairs::table.entry[q.a->kind()][q.b->kind()](q, i, margin, pairs::recalled(q, memories), found);
        }
    };
};

}  // namespace detail

/// The default narrowphase: for each pair of kinds the method that suits it best: closed forms, separating axes with
/// clipping, and for all others GJK, EPA and clipping. Manifolds that are dear to find are carried along while their
/// pair moves by less than 1/512 of its smaller half extent. Cost: 0.1-0.5 us a pair; 0.3-7 us by GJK and EPA.
struct best_per_pair : detail::pairwise_narrowphase<detail::pair_methods{}> {};
/// GJK and EPA for all pairs of convex shapes, also where a closed form is faster.
struct gjk_epa : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false}> {};
/// GJK while shapes are apart, MPR where they overlap: faster than EPA, and deep overlaps may be parted by a longer way
/// than the shortest.
struct gjk_mpr : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false,
                                                                    .overlaps = detail::overlap_method::mpr}> {};
/// GJK and EPA, which add their one deepest point a step to a manifold that persists: no clipping, and a face that
/// lands has all its points after some steps only. Pairs without memory get one point.
struct incremental_manifolds : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false,
                                                                                  .persistent = true}> {};

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/plane_queries.hpp
// =================================================================================================
// Distance, overlap and penetration of any shape that has a core and a halfspace.

PHYSICS_HPP_BEGIN

namespace detail {

/// The point of a core that lies lowest above a halfspace, both in A's frame.
template <int D>
struct lowest_point {
    point<D> normal, at;
    double radius, gap;

    /// Where the halfspace is shape B.
    template <class A, class S>
    lowest_point(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a)
        : lowest_point(core_of(a), mat<double, D>::identity(), {}, bounding_half<D>(b, b_in_a)) {}
    /// Where it is shape A.
    template <class B, class S>
    lowest_point(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a)
        : lowest_point(core_of(b), to_matrix(b_in_a.rotation), to_point(b_in_a.position), bounding_half<D>(a)) {}
    lowest_point(const core<D>& c, const mat<double, D>& axes, const point<D>& where, const bounding_half<D>& half)
        : normal(half.normal), at(placed_core<D>{&c, axes, where}.support(-normal).at), radius(c.radius),
          gap(half.height(at)) {}

    /// The plane is shape A if `up` is 1, B if it is -1.
    template <class S>
    [[nodiscard]] closest_points<S, D> found(int up) const {
        const vec<S, D> on_shape = from_point<S>(at - normal * radius), on_plane = from_point<S>(at - normal * gap);
        return {from_point<S>(normal * up), static_cast<S>(gap - radius), up > 0 ? on_plane : on_shape,
                up > 0 ? on_shape : on_plane, query_status::converged};
    }
    /// The same, without overlaps.
    template <class S>
    [[nodiscard]] closest_points<S, D> found_apart(int up) const {
        if (!(gap > 0)) return {};
        closest_points<S, D> result = found<S>(up);
        result.distance = max(result.distance, S(0));
        return result;
    }
};

}  // namespace detail

/// How far a convex shape and a halfspace are apart, or how deep they overlap, and where: as of two convex shapes (see
/// convex.hpp), in either order. Exact, with or without a cache, which stays as it is. Cost: one support, 20 ns.
template <class A, class S, int D>
    requires detail::has_core<A>
closest_points<S, D> separation(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a) {
    return detail::lowest_point<D>(a, b, b_in_a).template found<S>(-1);
}
template <class B, class S, int D>
    requires detail::has_core<B>
closest_points<S, D> separation(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a) {
    return detail::lowest_point<D>(a, b, b_in_a).template found<S>(1);
}

/// How far apart they are, 0 where they touch or overlap; normal and points are null where the core enters the
/// halfspace.
template <class A, class S, int D>
    requires detail::has_core<A>
closest_points<S, D> distance(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a) {
    return detail::lowest_point<D>(a, b, b_in_a).template found_apart<S>(-1);
}
template <class B, class S, int D>
    requires detail::has_core<B>
closest_points<S, D> distance(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a) {
    return detail::lowest_point<D>(a, b, b_in_a).template found_apart<S>(1);
}

/// Whether they share a point.
template <class A, class S, int D>
    requires detail::has_core<A>
bool overlap(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a) {
    const detail::lowest_point<D> p(a, b, b_in_a);
    return p.gap <= p.radius;
}
template <class B, class S, int D>
    requires detail::has_core<B>
bool overlap(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a) {
    const detail::lowest_point<D> p(a, b, b_in_a);
    return p.gap <= p.radius;
}

namespace detail {

template <class Shape>
constexpr bool is_plane = false;
template <class S, int D>
constexpr bool is_plane<halfspace<S, D>> = true;
template <class A, class B>
concept plane_pair = (is_plane<A> && has_core<B>) || (has_core<A> && is_plane<B>);

}  // namespace detail

template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B>
closest_points<S, D> separation(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache&) {
    return separation(a, b, b_in_a);
}
template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B>
closest_points<S, D> distance(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache&) {
    return distance(a, b, b_in_a);
}
template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache&) {
    return overlap(a, b, b_in_a);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/ray_solids.hpp
// =================================================================================================
// Where a ray meets solids that have a closed form.

PHYSICS_HPP_BEGIN

namespace detail {

/// A ray in a shape's frame, and where it meets the shape; the normal stays null where it begins within.
template <int D>
struct local_ray {
    point<D> origin, way;
};
template <int D>
struct local_hit {
    bool hit = false;
    double fraction = 0;
    point<D> normal;
};

/// The times at which a ray that moves is within r of the frame's origin, ends included; those may lie before its
/// start. Source: Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems (2019), 7.
template <int D>
bool ball_span(const local_ray<D>& ray, double r, double& near, double& far) {
    const auto [direction, length] = split(ray.way);
    const double along = -dot(ray.origin, direction), from = physics::length(ray.origin);
    const double aside = physics::length(ray.origin + direction * along);
    if (!(length > 0) || aside > r) return false;
    const double half = physics::sqrt((r - aside) * (r + aside)), c = (from - r) * (from + r);
    // Of each pair of roots the one that does not cancel gives the other.
    near = (along > 0 ? c / (along + half) : along - half) / length;
    far = (along > 0 ? along + half : along - half < 0 ? c / (along - half) : 0) / length;
    return true;
}

template <int D>
local_hit<D> cast_on_ball(const local_ray<D>& ray, double r) {
    if (dot(ray.origin, ray.origin) <= r * r) return {true, 0, {}};
    double near = 0, far = 0;
    if (!ball_span(ray, r, near, far) || near < 0 || near > 1) return {};
    return {true, near, normalized(ray.origin + ray.way * near)};
}

/// First the endless cylinder around the axis, then the side or the ball at the end where the ray enters that.
template <int D>
local_hit<D> cast_on_capsule(const local_ray<D>& ray, double half_length, double r) {
    local_ray<D> across = ray;
    across.origin.x = across.way.x = 0;
    double near = 0, far = 0;
    const bool begins_beside = dot(across.origin, across.origin) <= r * r;
    if (!begins_beside && (!ball_span(across, r, near, far) || near < 0 || near > 1)) return {};
    const double x = ray.origin.x + ray.way.x * near;
    if (abs(x) <= half_length) {
        if (begins_beside) return {true, 0, {}};
        return {true, near, normalized(across.origin + across.way * near)};
    }
    local_ray<D> to_end = ray;
    to_end.origin.x -= x < 0 ? -half_length : half_length;
    return cast_on_ball(to_end, r);
}

/// The part of a ray that is left after clipping by halfspaces.
template <int D>
struct clipped_ray {
    double near = 0, far = 1;
    point<D> normal;

    /// Keeps what lies on the inner side of a plane: `height` is how far outside the ray begins, `climb` how fast it
    /// moves outwards. False if nothing is left.
    bool keep(double height, double climb, const point<D>& n) {
        if (climb < 0) {
            if (height > -climb * near) near = height / -climb, normal = n;
        } else if (climb > 0) {
            if (-height < climb * far) far = -height / climb;
        } else if (height > 0) {
            return false;
        }
        return near <= far;
    }
    [[nodiscard]] local_hit<D> hit() const { return {true, near, normal}; }
};

template <int D>
local_hit<D> cast_on_box(const local_ray<D>& ray, const point<D>& half) {
    clipped_ray<D> left;
    for (int i = 0; i < D; ++i)
        for (const double side : {1.0, -1.0}) {
            point<D> n;
            n[i] = side;
            if (!left.keep(side * ray.origin[i] - half[i], side * ray.way[i], n)) return {};
        }
    return left.hit();
}

template <class R, int D>
local_hit<D> cast_on_hull(const local_ray<D>& ray, const hull_data<R, D>& h) {
    clipped_ray<D> left;
    for (std::uint32_t i = 0; i < h.face_count; ++i) {
        const point<D>& n = h.normal(i);
        if (!left.keep(dot(n, ray.origin) - h.offset(i), dot(n, ray.way), n)) return {};
    }
    return left.hit();
}

/// The caps' planes, then the endless cylinder around the axis.
inline local_hit<3> cast_on_cylinder(const local_ray<3>& ray, double half, double r) {
    clipped_ray<3> left;
    for (const double side : {1.0, -1.0})
        if (!left.keep(side * ray.origin.x - half, side * ray.way.x, {side, 0, 0})) return {};
    local_ray<3> across = ray;
    across.origin.x = across.way.x = 0;
    const bool begins_beside = dot(across.origin, across.origin) <= r * r;
    if (largest(across.way) == 0) return begins_beside ? left.hit() : local_hit<3>{};
    double near = 0, far = 0;
    if (!ball_span(across, r, near, far)) return {};
    if (begins_beside) return left.near <= max(far, 0.0) ? left.hit() : local_hit<3>{};
    if (near > left.near) left = {near, left.far, normalized(across.origin + across.way * near)};
    return left.near <= min(left.far, far) ? left.hit() : local_hit<3>{};
}

/// The part of a line, by its length from `base` along the unit vector u, that is within a cone around the x axis whose
/// radius is radius + slope * x, where that is not negative. False if there is none; ends may be infinite.
inline bool cone_span(const point<3>& base, const point<3>& u, double radius, double slope, double& near, double& far) {
    constexpr double endless = 1e300;
    const double growth = slope * u.x, aside = length(vec<double, 2>{base.y, base.z});
    const double across = length(vec<double, 2>{u.y, u.z});
    radius += slope * base.x;
    // Along the line the squared distance from the axis less the squared radius is a s^2 + 2 b s + c.
    const double a = (across - growth) * (across + growth), b = base.y * u.y + base.z * u.z - radius * growth;
    const double c = (aside - radius) * (aside + radius), square = b * b - a * c;
    if (square < 0 && a > 0) return false;
    // Of the roots the one that does not cancel gives the other.
    const double root = sqrt(max(square, 0.0)), sum = b > 0 ? -b - root : root - b;
    if (sum == 0) {
        // The line is one of the cone's own, or leads through its tip.
        near = a > 0 ? 0 : -endless;
        far = a > 0 ? 0 : endless;
        return a > 0 || c <= 0;
    }
    const double small = c / sum;
    const double large = abs(sum) < endless * abs(a) ? sum / a : (sum > 0) == (a > 0) ? endless : -endless;
    if (a > 0) {
        near = min(small, large);
        far = max(small, large);
        return true;
    }
    // It climbs as fast as the cone widens, or faster: the other root is on the other side of the tip.
    if (a == 0 && (growth > 0) == (b > 0)) return false;
    near = growth > 0 ? (a == 0 ? small : max(small, large)) : -endless;
    far = growth > 0 ? endless : a == 0 ? small : min(small, large);
    return true;
}

/// The caps' planes, then the endless cone around the axis.
inline local_hit<3> cast_on_cone(const local_ray<3>& ray, double half, double low, double high) {
    clipped_ray<3> left;
    for (const double side : {1.0, -1.0})
        if (!left.keep(side * ray.origin.x - half, side * ray.way.x, {side, 0, 0})) return {};
    const double slope = (high - low) / (2 * half), aside = length(vec<double, 2>{ray.origin.y, ray.origin.z});
    // As seen from the narrow end: there the digits count.
    const point<3> end{low < high ? -half : half, 0, 0}, origin = ray.origin - end;
    const double narrow = min(low, high);
    const bool begins_beside = aside <= narrow + slope * origin.x;
    const auto [u, length] = split(ray.way);
    if (!(length > 0)) return begins_beside ? left.hit() : local_hit<3>{};
    const double start = -dot(origin, u);
    double near = 0, far = 0;
    if (!cone_span(origin + u * start, u, narrow, slope, near, far)) return {};
    near = (near + start) / length;
    far = (far + start) / length;
    if (begins_beside) return left.near <= max(far, 0.0) ? left.hit() : local_hit<3>{};
    if (near > left.near) {
        const point<3> at = origin + ray.way * near;
        vec<double, 2> out{at.y, at.z};
        // At the tip the side that the ray sees.
        if (largest(out) <= 0x1p-40 * (half + largest(origin))) out = {-u.y, -u.z};
        out = normalized(out);
        left = {near, left.far, normalized(point<3>{-slope, out.x, out.y})};
    }
    return left.near <= min(left.far, far) ? left.hit() : local_hit<3>{};
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/shape_cast.hpp
// =================================================================================================
// When a convex shape that moves in a straight line first touches another: shape casts.

PHYSICS_HPP_BEGIN

/// Where shape B, moved along a translation, first touches shape A; all in A's frame.
template <class S, int D>
struct cast_hit {
    bool hit = false;
    /// The part of the translation that B has made, 0 where the shapes overlap from the start.
    S fraction = S(1);
    /// Unit vector from A to B.
    vec<S, D> normal;
    /// On the surface of A, where they touch.
    vec<S, D> point;
    /// At the limit of iterations a hit is reported, never too late.
    query_status status = query_status::converged;

    explicit operator bool() const { return hit; }
};

namespace detail {

/// What a cast of cores has to know of the scalar.
struct cast_precision {
    /// Of GJK: the part of a distance.
    double relative;
    /// How far supports may be off (m): of cores that calculate in S, and of hulls that look for vertices in float.
    double error;

    template <class S, int D>
    static cast_precision of(const core<D>& a, const core<D>& b) {
        const double epsilon = static_cast<double>(scalar_traits<S>::epsilon()), whole = is_fixed<S> ? 1 : 0;
        cast_precision p{0x1p-50, 0};
        for (const core<D>* c : {&a, &b}) {
            if (c->kind == core_kind::hull_of_floats) p.error += 0x1p-21 * c->extent;
            if (c->kind != core_kind::custom) continue;
            p.relative = max(relative_tolerance<S>(), 0x1p-50);
            p.error += 4 * epsilon * (c->extent + whole);
        }
        return p;
    }
};

/// Where the cast of a core ended.
template <int D>
struct core_cast {
    enum class outcome : std::uint8_t { missed, began_in_touch, hit };
    outcome ended = outcome::missed;
    query_status status = query_status::converged;
    double fraction = 0;
    /// A plane with this normal, from A to B, parts the shapes until they touch.
    point<D> normal;
    /// The cores at that fraction.
    gjk_result<D> at;
};

/// When B, moving by `most` times `way` in A's frame, comes as close as the radii of both. Their distance is a convex
/// function of the time, and a plane that parts them says until when at least they can't meet: this is Newton's method,
/// which never passes the first root. Any plane will do for that, so that no error of GJK is one of the answer's.
/// Source: van den Bergen, Ray casting against general convex objects (2004); Mirtich, Impulse-based dynamic simulation
/// of rigid body systems (1996), 2.3. Cost: one GJK, then 1 to 5 that begin with the last one's features; where the
/// shapes graze each other up to 25.
template <int D>
core_cast<D> cast(const core<D>& a, placed_core<D> b, const point<D>& way, double most,
                  const cast_precision& precision) {
    constexpr int most_iterations = 100;
    const double reach = a.radius + b.shape->radius, length = physics::length(way);
    const point<D> start = b.at;
    gjk_cache cache;
    core_cast<D> c;
    for (int i = 0;; ++i) {
        b.at = start + way * c.fraction;
        const double noise = 0x1p-49 * (extent_of(a, b) + largest(start) + reach) + precision.error;
        const double rest = (most - c.fraction) * length;
        c.at = gjk(a, b, rest + 0x1p-40 * rest + reach + 2 * noise, precision.relative, &cache);
        if (c.at.beyond) return c;
        const double distance = c.at.overlapping ? 0 : c.at.distance;
        if (distance <= reach + noise + 2 * precision.relative * distance) {
            // Across a gap no wider than rounding the direction of the last plane is the better one.
            const bool clear = distance > 0x1p20 * noise && dot(c.at.normal, way) < 0;
            if (clear || c.fraction == 0) c.normal = c.at.normal;
            c.ended = c.fraction > 0 ? core_cast<D>::outcome::hit : core_cast<D>::outcome::began_in_touch;
            return c;
        }
        const double gap = dot(c.at.normal, support_along(a, b, c.at.normal).w) - reach;
        const double speed = -dot(c.at.normal, way);
        if (gap > 0 && (!(speed > 0) || gap > speed * (most - c.fraction) + noise)) return c;
        const double step = gap > 0 ? min(gap / speed, most - c.fraction) : 0;
        if (step > 0 || c.fraction == 0) c.normal = c.at.normal;
        if (!(c.fraction + step > c.fraction) || i == most_iterations) {
            if (!(gap > 0) || i == most_iterations) c.status = query_status::iteration_limit;
            c.ended = core_cast<D>::outcome::hit;
            return c;
        }
        c.fraction += step;
        // Often the features that were closest are those that touch: then GJK need not look again.
        for (int k = 0; k < c.at.at.count; ++k) c.at.at.vertex[k].w += way * step;
        const closest_of<D> near = closest_of_simplex(c.at.at, false);
        if (near.count <= D && dot(near.at, near.at) <= (reach + noise) * (reach + noise)) {
            c.at.at.keep(near);
            c.ended = core_cast<D>::outcome::hit;
            return c;
        }
    }
}

/// The point of A's core that touches B's, where a cast has ended.
template <int D>
point<D> touching_point(const core<D>& a, const placed_core<D>& b, const core_cast<D>& c) {
    if (c.at.at.count <= D) return c.at.at.on_a();
    penetration<D> p;
    p.normal = c.normal;
    p.on_a = c.at.at.vertex[0].on_a;
    p.located = false;
    locate(a, b, extent_of(a, b), p);
    return p.on_a;
}

/// How deep shapes may overlap that touch, by the rounding of the numbers that place them.
template <class S>
double touch_tolerance(double size) {
    return 8 * static_cast<double>(scalar_traits<S>::epsilon()) * (size + (is_fixed<S> ? 1 : 0));
}

/// Whether two cores that touch, or overlap by no more than `touch`, never get deeper on the way; there may be several
/// planes between them, so that one is sought a little later. `normal` and `gap` are those of the start.
template <int D>
bool parts(const core<D>& a, placed_core<D> b, const point<D>& way, const point<D>& normal, double gap, double touch) {
    const auto stays_out = [&](const point<D>& n, double height) {
        return height >= -touch && height + min(dot(n, way), 0.0) >= -touch;
    };
    if (stays_out(normal, gap)) return true;
    const double reach = a.radius + b.shape->radius;
    if (gap < -touch || reach > 0x1p-20 * extent_of(a, b)) return false;
    const point<D> start = b.at;
    const double little = 0x1p-20 * (a.extent + b.shape->extent), length = physics::length(way);
    b.at += length > little ? way * (little / length) : way;
    const gjk_result<D> r = gjk(a, b, no_limit, 0x1p-50, nullptr);
    const point<D> n = r.distance > 0x1p-10 * little ? r.normal : epa(a, b, r.at, 0x1p-10 * little).normal;
    b.at = start;
    return stays_out(n, dot(n, support_along(a, b, n).w) - reach);
}

template <class S, int D>
cast_hit<S, D> rounded_hit(double fraction, const point<D>& normal, const point<D>& at, query_status status) {
    return {true, static_cast<S>(fraction), from_point<S>(normal), from_point<S>(at), status};
}

template <class S, int D>
cast_hit<S, D> cast_shapes(const core_pair<D>& pair, const point<D>& way, double most) {
    const core<D>&a = pair.a, &b = pair.b;
    core_cast<D> c = cast(a, pair.placed, way, most, cast_precision::of<S>(a, b));
    if (c.ended == core_cast<D>::outcome::missed) return {};
    placed_core<D> there = pair.placed;
    there.at += way * c.fraction;
    if (c.ended == core_cast<D>::outcome::hit)
        return rounded_hit<S>(c.fraction, c.normal, touching_point(a, there, c) + c.normal * a.radius, c.status);
    const double size = extent_of(a, there), reach = a.radius + b.radius, touch = touch_tolerance<S>(size + reach);
    double gap = c.at.distance - reach;
    point<D> on_a = c.at.at.on_a();
    if (c.at.overlapping || c.at.distance <= 0x1p-40 * size) {
        penetration<D> p = epa(a, there, c.at.at, depth_tolerance<S>(size));
        locate(a, there, size, p);
        c.normal = p.normal;
        c.status = p.status;
        gap = -p.depth - reach;
        on_a = p.on_a;
    }
    if (parts(a, there, way * most, c.normal, gap, touch)) return {};
    return rounded_hit<S>(0, c.normal, on_a + c.normal * a.radius, c.status);
}

/// When a core that moves meets a halfspace, and which of its points; all in the halfspace's frame.
template <int D>
struct half_cast {
    bool hit;
    double fraction;
    point<D> at;
};
template <int D>
half_cast<D> cast_on_half(const bounding_half<D>& h, const placed_core<D>& b, const point<D>& way, double most,
                          double touch) {
    const point<D> lowest = b.support(-h.normal).at - h.normal * b.shape->radius;
    const double height = dot(h.normal, lowest) - h.offset, speed = -dot(h.normal, way);
    const double fraction = height > 0 && speed > 0 ? height / speed : 0;
    const bool in_touch = height <= 0 && height >= -touch && height - max(speed, 0.0) * most >= -touch;
    const bool hit = height > 0 ? speed > 0 && fraction <= most : !in_touch;
    return {hit, fraction, lowest + way * fraction};
}

}  // namespace detail

/// The first time at which shape B, moving by `translation` (m) in A's frame without turning, touches shape A, if it
/// has made at most the part `most` of its way by then. Shapes that overlap from the start hit at 0, with the normal
/// along which they part soonest. Shapes that touch within rounding (8 spacings of S, of their sizes) and move apart or
/// along each other don't hit. Exact to a few roundings of double, of the sizes and of the way: only ways that graze A
/// by less may be judged either way. Cost: 0.3 us in the plane, 1 us in space;
/// hulls of many vertices 1 to 3 us.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
cast_hit<S, D> shape_cast(const A& a, const B& b, const transform<S, D>& b_in_a,
                          std::type_identity_t<vec<S, D>> translation, std::type_identity_t<S> most = S(1)) {
    const detail::core_pair<D> pair(a, b, b_in_a);
    return detail::cast_shapes<S>(pair, detail::to_point(translation), detail::to_double(most));
}
/// The same where A is a halfspace. Cost: 50 ns.
template <class B, class S, int D>
    requires detail::has_core<B>
cast_hit<S, D> shape_cast(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a,
                          std::type_identity_t<vec<S, D>> translation, std::type_identity_t<S> most = S(1)) {
    const detail::bounding_half<D> half(a);
    const detail::core<D> shape = core_of(b);
    const detail::placed_core<D> placed{&shape, detail::to_matrix(b_in_a.rotation), detail::to_point(b_in_a.position)};
    const double touch = detail::touch_tolerance<S>(shape.extent + shape.radius + largest(placed.at));
    const detail::half_cast<D> c =
        detail::cast_on_half(half, placed, detail::to_point(translation), detail::to_double(most), touch);
    if (!c.hit) return {};
    const detail::point<D> onto = half.normal * (half.offset - dot(half.normal, c.at));
    return detail::rounded_hit<S>(c.fraction, half.normal, c.at + onto, query_status::converged);
}
/// The same where B is a halfspace.
template <class A, class S, int D>
    requires detail::has_core<A>
cast_hit<S, D> shape_cast(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a,
                          std::type_identity_t<vec<S, D>> translation, std::type_identity_t<S> most = S(1)) {
    const detail::bounding_half<D> half(b, b_in_a);
    const detail::core<D> shape = core_of(a);
    const detail::placed_core<D> placed{&shape, mat<double, D>::identity(), {}};
    const detail::point<D> way = detail::to_point(translation);
    const double touch = detail::touch_tolerance<S>(shape.extent + shape.radius + abs(half.offset));
    const detail::half_cast<D> c = detail::cast_on_half(half, placed, -way, detail::to_double(most), touch);
    if (!c.hit) return {};
    return detail::rounded_hit<S>(c.fraction, -half.normal, c.at + way * c.fraction, query_status::converged);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/ray_cast.hpp
// =================================================================================================
// Where a ray meets a shape.

PHYSICS_HPP_BEGIN

/// Where a ray enters a shape, in the frame that both are given in.
template <class S, int D>
struct ray_hit {
    bool hit = false;
    /// The part of the ray's translation up to there; 0 if it begins within, or on the surface.
    S fraction = S(1);
    /// Unit vector outwards; null if the ray begins within.
    vec<S, D> normal;
    vec<S, D> point;

    explicit operator bool() const { return hit; }
};

namespace detail {

template <class S, int D>
local_hit<D> cast_on_core(const local_ray<D>& ray, const core<D>& shape, double most = 1) {
    const core<D> tip;
    const core_cast<D> c = cast(shape, placed_core<D>{&tip, mat<double, D>::identity(), ray.origin}, ray.way, most,
                                cast_precision::of<S>(shape, tip));
    if (c.ended == core_cast<D>::outcome::missed) return {};
    return {true, c.fraction, c.ended == core_cast<D>::outcome::hit ? c.normal : point<D>{}};
}

// What ray_cast() calls, by the kind of shape.
template <class S, int D>
local_hit<D> cast_on(const ball<S, D>& b, const local_ray<D>& ray) {
    return cast_on_ball(ray, detail::to_double(b.radius));
}
template <class S, int D>
local_hit<D> cast_on(const capsule<S, D>& c, const local_ray<D>& ray) {
    return cast_on_capsule(ray, detail::to_double(c.half_length), detail::to_double(c.radius));
}
template <class S, int D>
local_hit<D> cast_on(const box<S, D>& b, const local_ray<D>& ray) {
    return cast_on_box(ray, to_point(b.half_extents));
}
template <class S, int D>
local_hit<D> cast_on(const halfspace<S, D>& h, const local_ray<D>& ray) {
    const bounding_half<D> half(h);
    clipped_ray<D> left;
    if (!left.keep(dot(half.normal, ray.origin) - half.offset, dot(half.normal, ray.way), half.normal)) return {};
    return left.hit();
}
template <class S, int D>
local_hit<D> cast_on(const hull<S, D>& h, const local_ray<D>& ray) {
    return h.radius > S(0) ? cast_on_core<S>(ray, core_of(h)) : cast_on_hull(ray, *h.geometry);
}
template <class S>
local_hit<3> cast_on(const cylinder<S, 3>& c, const local_ray<3>& ray) {
    if (c.rounding > S(0)) return cast_on_core<S>(ray, core_of(c));
    return cast_on_cylinder(ray, detail::to_double(c.half_length), detail::to_double(c.radius));
}
template <class S>
local_hit<3> cast_on(const cone<S, 3>& c, const local_ray<3>& ray) {
    if (c.rounding > S(0)) return cast_on_core<S>(ray, core_of(c));
    return cast_on_cone(ray, detail::to_double(c.half_length), detail::to_double(c.lower_radius),
                        detail::to_double(c.upper_radius));
}
template <template <class, int> class Shape, class S, int D>
    requires has_core<Shape<S, D>>
local_hit<D> cast_on(const Shape<S, D>& shape, const local_ray<D>& ray) {
    return cast_on_core<S>(ray, core_of(shape));
}

}  // namespace detail

/// Where a ray, from `origin` along `translation` (m), first meets a shape that stands at `at`. Surfaces belong to
/// shapes: a ray that begins on one hits at 0, one in the plane of a face at its edge, one without length hits what it
/// is in. Exact to a few roundings of double, of the sizes and of the distance: only rays that graze the shape by less
/// may be judged either way; none passes between parts of a surface that share corners. Cost: 15 to 100 ns; hulls 3 ns
/// a face; rounded hulls and boxes and other shapes 0.3 to 1.5 us, rounded cylinders and cones up to 8; surfaces and
/// compounds 0.1 us and more, O(log n) and the parts on the way.
template <class Shape, class S, int D>
    requires requires(const Shape& s, const detail::local_ray<D>& r) { cast_on(s, r); }
ray_hit<S, D> ray_cast(const Shape& shape, const transform<S, D>& at, std::type_identity_t<vec<S, D>> origin,
                       std::type_identity_t<vec<S, D>> translation) {
    const mat<double, D> axes = detail::to_matrix(at.rotation);
    const detail::point<D> from = detail::to_point(origin), way = detail::to_point(translation);
    const detail::local_hit<D> h =
        cast_on(shape, detail::local_ray<D>{transposed_times(axes, from - detail::to_point(at.position)),
                                                    transposed_times(axes, way)});
    if (!h.hit) return {};
    return {true, static_cast<S>(h.fraction), detail::from_point<S>(axes * h.normal),
            detail::from_point<S>(from + way * h.fraction)};
}
/// The same for a shape of a set.
template <class S, int D, template <class, int> class... Shapes>
ray_hit<S, D> ray_cast(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& at,
                       std::type_identity_t<vec<S, D>> origin, std::type_identity_t<vec<S, D>> translation) {
    return shape.visit([&](const auto& s) { return ray_cast(s, at, origin, translation); });
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/ray_parts.hpp
// =================================================================================================
// Where a ray meets a shape that is made of parts: a surface or a compound.

PHYSICS_HPP_BEGIN

namespace detail {

template <class Shape, int D>
concept has_parts = is_surface<Shape, D> || is_compound<Shape, D>;

/// What a ray sees: how far aside of it things are, along the axes other than the one that it follows most. Each corner
/// is seen at one place, and rounding never turns round which of two products is the larger: so no ray passes between
/// parts that share corners. Source: Woop, Benthin, Wald: Watertight ray/triangle intersection (2013); here without its
/// division, so that what is exact in the numbers given is judged exactly.
template <int D>
class ray_view {
public:
    explicit ray_view(const point<D>& way) : way_(way) {
        for (int i = 1; i < D; ++i)
            if (abs(way[i]) > abs(way[axis_])) axis_ = i;
    }
    /// Whether it passes between corners that are given as seen from its origin, ends included.
    [[nodiscard]] bool passes(const point<2> (&c)[2]) const {
        const double a = aside(c[0], 0), b = aside(c[1], 0);
        return (a <= 0 && b >= 0) || (a >= 0 && b <= 0);
    }
    [[nodiscard]] bool passes(const point<3> (&c)[3]) const {
        vec<double, 2> p[3];
        for (int i = 0; i < 3; ++i) p[i] = {aside(c[i], 0), aside(c[i], 1)};
        const double u = cross(p[1], p[2]), v = cross(p[2], p[0]), w = cross(p[0], p[1]);
        return (u <= 0 && v <= 0 && w <= 0) || (u >= 0 && v >= 0 && w >= 0);
    }

private:
    /// Times the way along its own axis.
    [[nodiscard]] double aside(const point<D>& c, int i) const {
        const int other = i < axis_ ? i : i + 1;
        return c[other] * way_[axis_] - way_[other] * c[axis_];
    }

    point<D> way_;
    int axis_ = 0;
};
/// A vector across the part, out of its front.
inline point<2> across(const point<2> (&c)[2]) { return perpendicular(c[1] - c[0]); }
inline point<3> across(const point<3> (&c)[3]) { return cross(c[1] - c[0], c[2] - c[0]); }

inline core<2> core_of_face(const surface_face<2>& face, double radius) {
    return core_of(segment<double, 2>{face.corner[0], face.corner[1], radius});
}
inline core<3> core_of_face(const surface_face<3>& face, double radius) {
    return core_of(triangle<double, 3>{face.corner[0], face.corner[1], face.corner[2], radius});
}

/// The first of the hits that a ray has had so far; the normals may have any length.
template <class S, int D>
struct first_hit {
    const local_ray<D>& ray;
    ray_view<D> view;
    local_hit<D> hit;

    explicit first_hit(const local_ray<D>& r) : ray(r), view(r.way) {}
    [[nodiscard]] double most() const { return hit.hit ? hit.fraction : 1; }
    void take(const local_hit<D>& other) {
        if (other.hit && (!hit.hit || other.fraction < hit.fraction)) hit = other;
    }
    /// A part without a radius stops what comes from its front, or from both sides.
    void meet(const surface_face<D>& face) {
        point<D> corner[D];
        double size = 0;
        for (int i = 0; i < D; ++i) {
            corner[i] = face.corner[i] - ray.origin;
            size = max(size, largest(face.corner[i]));
        }
        const point<D> out = detail::across(corner);
        // How far the origin is behind the part, times the length of `out`.
        const double behind = dot(out, corner[0]), climb = dot(out, ray.way);
        const double noise = 0x1p-49 * (size + largest(ray.origin)) * largest(out);
        if (abs(behind) <= noise) return take(cast_on_core<S>(ray, core_of_face(face, 0), most()));
        if ((behind > 0 && !face.two_sided) || (behind > 0) != (climb > 0)) return;
        if (abs(behind) > abs(climb) * most() + noise || !view.passes(corner)) return;
        take({true, min(behind / climb, most()), behind > 0 ? -out : out});
    }
    /// The same of a part with a radius.
    void meet(const surface_face<D>& face, double radius) {
        const double behind = dot(across(face.corner), face.corner[0] - ray.origin);
        if (face.two_sided || !(behind > 0)) take(cast_on_core<S>(ray, core_of_face(face, radius), most()));
    }
};

/// A ray and a convex shape whose type is forgotten: by a closed form, if its core has one in its own frame.
template <class S, int D>
local_hit<D> cast_on_solid(const local_ray<D>& ray, const core<D>& shape, double most) {
    if (shape.radius == 0 && shape.kind == core_kind::box) return cast_on_box(ray, shape.corner[0]);
    if constexpr (D == 3)
        if (shape.radius == 0 && shape.kind == core_kind::disc)
            return cast_on_cone(ray, shape.corner[0].x, shape.corner[0].y, shape.corner[0].z);
    if (shape.radius > 0 && shape.kind == core_kind::point)
        return cast_on_ball(local_ray<D>{ray.origin - shape.corner[0], ray.way}, shape.radius);
    return cast_on_core<S>(ray, shape, most);
}

template <class Shape, int D>
    requires has_parts<Shape, D>
local_hit<D> cast_on(const Shape& shape, const local_ray<D>& ray) {
    using S = typename Shape::scalar;
    first_hit<S, D> first(ray);
    if constexpr (is_surface<Shape, D>) {
        const double radius = detail::to_double(shape.radius);
        const auto meet = [&](const surface_face<D>& face) {
            if (radius > 0) first.meet(face, radius);
            else first.meet(face);
            return first.most();
        };
        const box_ray<D> search(ray.origin, ray.way, radius);
        if constexpr (requires { each_part_along(shape, search, meet); }) {
            each_part_along(shape, search, meet);
        } else {
            each_part(shape, search.bounds(), [&](const surface_part<D>& part) {
                surface_face<D> face{{}, part.two_sided};
                for (int i = 0; i < D; ++i) face.corner[i] = part.corner[i];
                meet(face);
            });
        }
    } else {
        const auto meet = [&](const auto& child) {
            const local_ray<D> seen{transposed_times(child.axes, ray.origin - child.at),
                                    transposed_times(child.axes, ray.way)};
            local_hit<D> hit = cast_on_solid<S>(seen, child.shape, first.most());
            hit.normal = child.axes * hit.normal;
            first.take(hit);
            return first.most();
        };
        const box_ray<D> search(ray.origin, ray.way, 0);
        if constexpr (requires { each_child_along(shape, search, meet); }) each_child_along(shape, search, meet);
        else each_child(shape, search.bounds(), meet);
    }
    first.hit.normal = normalized(first.hit.normal);
    return first.hit;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/part_queries.hpp
// =================================================================================================
// Casts and distances of shapes that are made of parts: surfaces and compounds.

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(core, axes, at, number) for the convex pieces of a shape with parts that may reach into a box: triangles or
/// segments with the surface's rounding, or children. `sees(part)` says which parts of surfaces are meant.
template <class Shape, int D, class Sees, class F>
void each_piece(const Shape& shape, const aabb<double, D>& box, Sees&& sees, F&& f) {
    if constexpr (is_surface<Shape, D>) {
        const double radius = detail::to_double(shape.radius);
        each_part(shape, grown(box, radius), [&](const surface_part<D>& part) {
            if (sees(part)) f(core_of_part(part, radius), mat<double, D>::identity(), point<D>{}, part.number);
        });
    } else {
        each_child(shape, box, [&](const auto& child) { f(child.shape, child.axes, child.at, child.number); });
    }
}
/// Of a one-sided part only the front is seen.
template <int D>
bool faces(const surface_part<D>& part, const point<D>& from) {
    return part.two_sided || dot(part.normal, from - part.corner[0]) >= 0;
}

}  // namespace detail

/// When shape B, moving by `translation`, first touches a surface or a compound; see shape_cast of convex shapes.
/// One-sided parts stop what begins before them. Cost: a cast for each part near the way.
template <class A, class B, class S, int D>
    requires detail::has_parts<A, D> && detail::has_core<B>
cast_hit<S, D> shape_cast(const A& a, const B& b, const transform<S, D>& b_in_a,
                          std::type_identity_t<vec<S, D>> translation, std::type_identity_t<S> most = S(1)) {
    using detail::point;
    const detail::core<D> shape = core_of(b);
    const mat<double, D> axes = detail::to_matrix(b_in_a.rotation);
    const point<D> from = detail::to_point(b_in_a.position), way = detail::to_point(translation);
    const aabb<double, D> start = detail::bounds_of(detail::placed_core<D>{&shape, axes, from}, 0.0);
    const aabb<double, D> box{min(start.lower, start.lower + way), max(start.upper, start.upper + way)};
    cast_hit<S, D> first;
    detail::each_piece(
        a, box, [&](const auto& part) { return detail::faces(part, axes * shape.center + from); },
        [&](const detail::core<D>& piece, const mat<double, D>& piece_axes, const point<D>& at, std::uint32_t) {
            const mat<double, D> back = transposed(piece_axes);
            const detail::core_pair<D> pair(piece, shape, back * axes, back * (from - at));
            const double left = detail::to_double(first ? first.fraction : most);
            cast_hit<S, D> hit = detail::cast_shapes<S>(pair, back * way, left);
            if (!hit || (first && !(hit.fraction < first.fraction))) return;
            hit.normal = detail::from_point<S>(piece_axes * detail::to_point(hit.normal));
            hit.point = detail::from_point<S>(piece_axes * detail::to_point(hit.point) + at);
            first = hit;
        });
    return first;
}

/// Where a surface or a compound and a convex shape are closest, if they are not farther apart than `reach` (m); see
/// separation of convex shapes. Cost: one for each part within reach.
template <class A, class B, class S, int D>
    requires detail::has_parts<A, D> && detail::has_core<B>
closest_points<S, D> separation(const A& a, const B& b, const transform<S, D>& b_in_a, std::type_identity_t<S> reach) {
    using detail::point;
    const detail::core<D> shape = core_of(b);
    const mat<double, D> axes = detail::to_matrix(b_in_a.rotation);
    const point<D> from = detail::to_point(b_in_a.position);
    closest_points<S, D> best;
    best.distance = scalar_traits<S>::max();
    detail::each_piece(
        a, detail::bounds_of(detail::placed_core<D>{&shape, axes, from}, detail::to_double(reach)),
        [](const auto&) { return true; },
        [&](const detail::core<D>& piece, const mat<double, D>& piece_axes, const point<D>& at, std::uint32_t) {
            const mat<double, D> back = transposed(piece_axes);
            const detail::core_pair<D> pair(piece, shape, back * axes, back * (from - at));
            const auto s = detail::separate<S>(pair, detail::no_limit, nullptr);
            closest_points<S, D> c = detail::rounded<S>(pair, s);
            if (c.distance > reach || !(c.distance < best.distance)) return;
            c.normal = detail::from_point<S>(piece_axes * s.normal);
            c.on_a = detail::from_point<S>(piece_axes * detail::to_point(c.on_a) + at);
            c.on_b = detail::from_point<S>(piece_axes * detail::to_point(c.on_b) + at);
            best = c;
        });
    return best;
}

PHYSICS_HPP_END

// =================================================================================================
// physics/collide/time_of_impact.hpp
// =================================================================================================
// When two convex shapes that move and turn first touch: conservative advancement.

PHYSICS_HPP_BEGIN

namespace detail {

template <class S>
physics::rotation<S, 2> rotation_by(S turn) { return physics::rotation<S, 2>::from_angle(turn); }
template <class S>
physics::rotation<S, 3> rotation_by(const vec<S, 3>& turn) {
    const auto [axis, angle] = split(turn);
    return physics::rotation<S, 3>::from_axis_angle(axis, angle);
}

}  // namespace detail

/// How a shape moves within a step: its body's centre of mass in a straight line, about which it turns at a constant
/// rate.
template <class S, int D>
struct sweep {
    /// The centre of mass at the beginning and at the end (m).
    vec<S, D> start, end;
    /// The body's rotation at the beginning.
    physics::rotation<S, D> rotation;
    /// How far it turns until the end: the angle, in space axis times angle (rad), in the outer frame; any number of
    /// times around.
    angular<S, D> turn{};
    /// The shape's frame, as seen from the centre of mass in a frame that turns with the body.
    transform<S, D> shape;

    /// Where the shape's frame is after a part of the motion. The angle is exact to rounding.
    [[nodiscard]] transform<S, D> at(S fraction) const {
        const physics::rotation<S, D> r = detail::rotation_by(turn * fraction) * rotation;
        const vec<S, D> center = start + (end - start) * fraction;
        return {center + r * shape.position, normalized(r * shape.rotation)};
    }
};

/// The motion between two poses of the centre of mass, the shorter way around: at most half a turn.
template <class S, int D>
sweep<S, D> sweep_between(const transform<S, D>& start, const transform<S, D>& end, const transform<S, D>& shape = {}) {
    return {start.position, end.position, start.rotation, rotation_vector(end.rotation * inverse(start.rotation)),
            shape};
}

/// How a search for the time of impact ended.
enum class impact_state : std::uint8_t {
    /// The shapes do not come as close as the target; the fraction is 1.
    separated,
    /// At the fraction they are as far apart as the target, at most by the tolerance farther.
    hit,
    /// They overlap at the beginning, or touch within rounding; the fraction is 0.
    overlapping,
    /// The search was given up. Up to the fraction the shapes are apart, at least by the target.
    iteration_limit,
};

/// When two shapes that move come close to each other.
template <class S, int D>
struct impact {
    impact_state state = impact_state::separated;
    S fraction = S(1);
    /// Of a hit: unit vector from A to B in the outer frame, and the point of A's surface that is closest to B.
    vec<S, D> normal;
    vec<S, D> point;
};

/// What a search for the time of impact aims at.
template <class S>
struct impact_settings {
    /// How far apart the shapes are left (m). Those that begin closer are left half as far apart as they begin.
    S target = S(0.005);
    /// How much farther apart they may be left (m): a larger one costs less.
    S tolerance = S(0.00125);
};

namespace detail {

// Turns, their lengths and the lengths of their cross products, in the plane and in space.
inline double magnitude(double w) { return abs(w); }
inline double magnitude(const point<3>& w) { return length(w); }
inline double magnitude_of_cross(double, double) { return 0; }
inline double magnitude_of_cross(const point<3>& a, const point<3>& b) { return length(cross(a, b)); }
inline mat<double, 2> turning(double angle) {
    const auto [s, c] = sine_cosine(angle);
    return {{{c, s}, {-s, c}}};
}
/// Source: Rodrigues.
inline mat<double, 3> turning(const point<3>& turn) {
    const auto [k, angle] = split(turn);
    const auto [s, c] = sine_cosine(angle);
    const double half = sine_cosine(angle * 0.5).sine, v = 2 * half * half;
    return {{{c + k.x * k.x * v, k.x * k.y * v + k.z * s, k.x * k.z * v - k.y * s},
             {k.x * k.y * v - k.z * s, c + k.y * k.y * v, k.y * k.z * v + k.x * s},
             {k.x * k.z * v + k.y * s, k.y * k.z * v - k.x * s, c + k.z * k.z * v}}};
}
template <class S>
double to_turn(S w) { return detail::to_double(w); }
template <class S>
point<3> to_turn(const vec<S, 3>& w) { return to_point(w); }

/// A core that moves; time runs from 0 to 1.
template <int D>
struct moving_core {
    core<D> shape;
    /// Of the centre of mass, at time 0.
    point<D> start;
    /// The turn until time 1.
    angular<double, D> turn;
    mat<double, D> axes;
    /// From the centre of mass to the shape's frame, at time 0.
    point<D> lever;
    /// No point of the core is farther from the centre of mass.
    double reach;

    template <class S>
    moving_core(const core<D>& c, const sweep<S, D>& s, const point<D>& origin) : shape(c), turn(to_turn(s.turn)) {
        const mat<double, D> body = to_matrix(s.rotation), local = to_matrix(s.shape.rotation);
        start = to_point(s.start) - origin;
        axes = body * local;
        const point<D> arm = to_point(s.shape.position);
        lever = body * arm;
        // The box around the core in its own frame, seen from the centre of mass.
        const point<D> center = -transposed_times(local, arm);
        double square = 0;
        for (int i = 0; i < D; ++i) {
            point<D> n;
            n[i] = 1;
            const double far = max(abs(shape.support(n).at[i] - center[i]), abs(shape.support(-n).at[i] - center[i]));
            square += far * far;
        }
        reach = physics::sqrt(square);
    }
    /// Where it is at a time, its centre of mass having moved to `center`.
    [[nodiscard]] placed_core<D> at(double time, const point<D>& center) const {
        if (!(magnitude(turn) > 0)) return {&shape, axes, center + lever};
        const mat<double, D> m = turning(turn * time);
        return {&shape, m * axes, center + m * lever};
    }
};

/// The rate of an axis that stays across an edge of A and an edge of B; left as it is where they are parallel.
inline void across_edges(const point<3>& n, const point<3>& edge_a, const point<3>& edge_b, const point<3>& turn_a,
                         const point<3>& turn_b, point<3>& turn) {
    const point<3> u = normalized(cross(n, edge_a)), w = normalized(cross(n, edge_b));
    const double uw = dot(u, w), det = 1 - uw * uw;
    const double of_a = dot(turn_a, u), of_b = dot(turn_b, w);
    if (det > 1.0 / 64) turn = u * ((of_a - uw * of_b) / det) + w * ((of_b - uw * of_a) / det);
}
inline void across_edges(const point<2>&, const point<2>&, const point<2>&, double, double, double&) {}

/// Two cores in motion; A's centre of mass is the origin at all times. A halfspace as A is the point of its surface
/// that is closest to the origin of its frame, with a normal.
template <int D>
struct moving_pair {
    const moving_core<D>&a, &b;
    point<D> way;
    /// Of the halfspace, in A's own frame; else null.
    const point<D>* face;
    /// The radii of both.
    double radii;
    double error;
    double tolerance;

    [[nodiscard]] point<D> center(double t) const { return b.start + way * t; }
    /// What rounding may do to a distance.
    [[nodiscard]] double noise() const {
        const double far = max(largest(b.start), largest(b.start + way));
        return 0x1p-48 * (a.reach + b.reach + radii + far) + error;
    }
    /// The halfspace's point.
    [[nodiscard]] point<D> on_face(const placed_core<D>& on_a) const { return on_a.axes * a.shape.corner[0] + on_a.at; }
    /// How far apart they are along n.
    [[nodiscard]] double gap(double t, const point<D>& n) const {
        const placed_core<D> on_a = a.at(t, {}), on_b = b.at(t, center(t));
        const point<D> top = face != nullptr ? on_face(on_a) : on_a.support(n).at;
        return (dot(n, on_b.support(-n).at) - dot(n, top)) - radii;
    }
};

/// The axis along which a moving pair is farthest apart at a time, null if it overlaps; at what rate that should turn
/// so that the features it stands on stay the closest ones; and the point of A's core.
template <int D>
struct parting_axis {
    point<D> normal, on_a;
    angular<double, D> turn{};
};

template <int D>
parting_axis<D> closest_features(const moving_pair<D>& p, double t, gjk_cache& cache) {
    parting_axis<D> axis;
    const placed_core<D> on_a = p.a.at(t, {}), on_b = p.b.at(t, p.center(t));
    if (p.face != nullptr) {
        axis.normal = on_a.axes * *p.face;
        axis.turn = p.a.turn;
        const point<D> lowest = on_b.support(-axis.normal).at;
        axis.on_a = lowest + axis.normal * dot(axis.normal, p.on_face(on_a) - lowest);
        return axis;
    }
    mat<double, D> seen;
    for (int i = 0; i < D; ++i) seen.column[i] = transposed_times(on_a.axes, on_b.axes.column[i]);
    const placed_core<D> b_in_a{&p.b.shape, seen, transposed_times(on_a.axes, on_b.at - on_a.at)};
    const gjk_result<D> r = gjk(p.a.shape, b_in_a, no_limit, p.tolerance, &cache);
    if (r.overlapping) return axis;
    axis.normal = on_a.axes * r.normal;
    axis.on_a = on_a.axes * r.at.on_a() + on_a.at;
    // What the shapes turn towards each other: how many corners, and an edge between two of them. Corners that are
    // close count as one: round shapes have many that differ a little.
    const auto& v = r.at.vertex;
    int corners_a = 1, corners_b = 1;
    point<D> edge_a, edge_b;
    for (int i = 1; i < r.at.count; ++i) {
        bool new_a = true, new_b = true;
        for (int k = 0; k < i; ++k) {
            const point<D> from_a = v[i].on_a - v[k].on_a, from_b = (v[i].w - v[k].w) + from_a;
            if (largest(from_a) > 0x1p-5 * p.a.reach) edge_a = from_a;
            else new_a = false;
            if (largest(from_b) > 0x1p-5 * p.b.reach) edge_b = from_b;
            else new_b = false;
        }
        corners_a += new_a;
        corners_b += new_b;
    }
    if (corners_a == 1 && corners_b == 1) return axis;
    const bool of_a = corners_a > corners_b || (corners_a == corners_b && largest(edge_a) >= largest(edge_b));
    axis.turn = of_a ? p.a.turn : p.b.turn;
    if (D == 3 && corners_a == 2 && corners_b == 2)
        across_edges(axis.normal, on_a.axes * edge_a, on_a.axes * edge_b, p.a.turn, p.b.turn, axis.turn);
    return axis;
}

/// How long a pair certainly stays apart by `goal`, from a time on, along an axis that turns: at most until `end`. The
/// gap along such an axis is the least of functions of time whose second derivative is at most `bend`; so it lies above
/// the chord between two times, less bend / 2 times the product of the times since and until. At both ends it is known
/// from supports. Some second times are tried, and the best bound taken.
template <int D>
double proven_advance(const moving_pair<D>& p, const parting_axis<D>& axis, double t, double gap, double end,
                      double goal) {
    const auto &a = p.a, &b = p.b;
    const auto curving = [&](const moving_core<D>& c) {
        const auto spin = c.turn - axis.turn;
        return (magnitude(spin) * magnitude(spin) + magnitude_of_cross(spin, axis.turn)) * c.reach;
    };
    const double whirl = length(cross(axis.turn, axis.normal));
    const double far = max(length(cross(axis.turn, p.center(t))), length(cross(axis.turn, p.center(end))));
    const double bend = curving(a) + curving(b) + whirl * (far + 2 * length(p.way)), spare = gap - goal;
    double best = 0, span = end - t;
    if (bend * span * span > 8 * spare) span = physics::sqrt(8 * spare / bend);
    for (int i = 0; i < 4 && span > best; ++i) {
        const point<D> n = turning(axis.turn * span) * axis.normal;
        const double there = p.gap(t + span, n) - goal, slope = (there - spare) / span, sag = 0.5 * bend;
        // The first root of spare + slope x - sag x (span - x).
        const double b1 = slope - sag * span, square = b1 * b1 - 4 * sag * spare;
        double safe = span;
        if (b1 < 0 && square >= 0) safe = min(span, 2 * spare / (physics::sqrt(square) - b1));
        best = max(best, safe);
        if (safe >= span) break;
        // Where the chord would meet the goal, unless even a straight path could not be proven that far.
        double next = there < 0 ? span * (spare / (spare - there)) : 0.5 * span;
        if (bend * next * next > 2 * spare) next = min(next, max(physics::sqrt(2 * spare / bend), 0.125 * span));
        span = next;
    }
    return best;
}

/// Where a search for the time of impact ended.
template <int D>
struct moving_impact {
    impact_state state = impact_state::separated;
    double time = 1;
    /// With A's centre of mass as the origin.
    point<D> normal, on_a;
    double gap = 0;
    int iterations = 0;
};

template <int D>
moving_impact<D> first_impact(const moving_pair<D>& p, double target, double tolerance) {
    constexpr int most_iterations = 100;
    const double noise = p.noise();
    double t = 0, end = 1, goal = max(target, 0.0), slack = max(tolerance, 4 * noise);
    // Apart from the times at which the balls around them, about the centres of mass, are close, nothing can happen.
    if (p.face == nullptr) {
        const double near_by = (p.a.reach + p.b.reach + p.radii + goal) + noise;
        const local_ray<D> ray{p.b.start, p.way};
        const bool begins = dot(ray.origin, ray.origin) <= near_by * near_by;
        double from = 0, to = 1;
        const bool meets = ball_span(ray, near_by, from, to);
        if (!begins && (!meets || from < 0 || from > 1)) return {};
        if (!begins) t = from;
        if (meets && to < end) end = max(to, t);
    }
    gjk_cache cache;
    for (int iterations = 0;; ++iterations) {
        const parting_axis<D> axis = closest_features(p, t, cache);
        const double gap = axis.normal == point<D>{} ? 0 : p.gap(t, axis.normal);
        if (iterations == 0 && t == 0) {
            if (!(gap > noise)) return {impact_state::overlapping, 0, {}, {}, 0, 0};
            if (gap <= goal + slack) goal = 0.5 * gap, slack = min(slack, 0.25 * gap);
        }
        if (gap <= goal + slack) return {impact_state::hit, t, axis.normal, axis.on_a, gap, iterations};
        const double next = t + proven_advance(p, axis, t, gap, end, goal);
        if (next >= end) return {impact_state::separated, 1, {}, {}, 0, iterations};
        if (!(next > t) || iterations == most_iterations)
            return {impact_state::iteration_limit, t, {}, {}, 0, iterations};
        t = next;
    }
}

/// The largest number of S not above x.
template <class S>
S rounded_down(double x) {
    const S r = static_cast<S>(x), step = scalar_traits<S>::epsilon();
    if (!(detail::to_double(r) > x)) return r;
    return r - (self_wide<S> ? r * step : step);
}

/// A may be a halfspace, whose normal is `face` then.
template <class S, int D>
moving_impact<D> swept_impact(const core<D>& a, const sweep<S, D>& motion_a, const core<D>& b,
                              const sweep<S, D>& motion_b, const std::type_identity_t<point<D>>* face,
                              const impact_settings<S>& settings) {
    const cast_precision precision = cast_precision::of<S>(a, b);
    const point<D> origin = to_point(motion_a.start);
    const moving_core<D> moving_a(a, motion_a, origin), moving_b(b, motion_b, origin);
    const point<D> way =
        (to_point(motion_b.end) - to_point(motion_b.start)) - (to_point(motion_a.end) - to_point(motion_a.start));
    const moving_pair<D> pair{moving_a, moving_b, way, face, a.radius + b.radius, precision.error, precision.relative};
    return first_impact(pair, detail::to_double(settings.target), detail::to_double(settings.tolerance));
}
template <class S, int D>
impact<S, D> rounded_impact(const moving_impact<D>& m, const sweep<S, D>& motion, const point<D>& normal,
                            const point<D>& at) {
    impact<S, D> result{m.state, rounded_down<S>(m.time), {}, {}};
    if (m.state != impact_state::hit) return result;
    const point<D> start = to_point(motion.start), center = start + (to_point(motion.end) - start) * m.time;
    result.normal = from_point<S>(normal);
    result.point = from_point<S>(center + at);
    return result;
}

}  // namespace detail

/// The first time at which two shapes that move and turn come as close as a target, if they do. Up to the fraction they
/// are apart, whatever the spin and the speed, at least by the target, or by half of what they have at the beginning
/// where that is less; rounding of double aside. So shapes that rest on each other or slide are not stopped. Any number
/// of turns within the motion is seen. Source: Mirtich, Impulse-based dynamic simulation of rigid body systems (1996);
/// the separating axis that turns along is Catto's, Continuous collision, GDC (2013), here with a bound that proves it.
/// Cost: 0.1 us where they stay far apart, else 0.6 to 2 us in the plane, 1.5 to 5 us in space; more for many turns.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
impact<S, D> time_of_impact(const A& a, const sweep<S, D>& motion_a, const B& b, const sweep<S, D>& motion_b,
                            const std::type_identity_t<impact_settings<S>>& settings = {}) {
    const detail::core<D> core_a = core_of(a);
    const auto m = detail::swept_impact(core_a, motion_a, core_of(b), motion_b, nullptr, settings);
    return detail::rounded_impact(m, motion_a, m.normal, m.on_a + m.normal * core_a.radius);
}
/// The same where A is a halfspace.
template <class B, class S, int D>
    requires detail::has_core<B>
impact<S, D> time_of_impact(const halfspace<S, D>& a, const sweep<S, D>& motion_a, const B& b,
                            const sweep<S, D>& motion_b,
                            const std::type_identity_t<impact_settings<S>>& settings = {}) {
    const detail::bounding_half<D> half(a);
    detail::core<D> surface;
    surface.corner[0] = half.normal * half.offset;
    const auto m = detail::swept_impact(surface, motion_a, core_of(b), motion_b, &half.normal, settings);
    return detail::rounded_impact(m, motion_a, m.normal, m.on_a);
}
/// The same where B is a halfspace.
template <class A, class S, int D>
    requires detail::has_core<A>
impact<S, D> time_of_impact(const A& a, const sweep<S, D>& motion_a, const halfspace<S, D>& b,
                            const sweep<S, D>& motion_b,
                            const std::type_identity_t<impact_settings<S>>& settings = {}) {
    const detail::bounding_half<D> half(b);
    detail::core<D> surface;
    surface.corner[0] = half.normal * half.offset;
    const auto m = detail::swept_impact(surface, motion_b, core_of(a), motion_a, &half.normal, settings);
    return detail::rounded_impact(m, motion_b, -m.normal, m.on_a + m.normal * m.gap);
}

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/guard.hpp
// =================================================================================================
// Changes are refused while a query runs.

PHYSICS_HPP_BEGIN

namespace detail {

/// Marks an object as being queried by this thread, as long as the scope lives. A chain on the stack, so that queries
/// of several threads at once write nothing that they share.
class query_scope {
public:
    explicit query_scope(const void* what) : what_(what), outer_(innermost()) { innermost() = this; }
    query_scope(const query_scope&) = delete;
    query_scope& operator=(const query_scope&) = delete;
    ~query_scope() { innermost() = outer_; }

    /// Refuses to change what is being queried.
    static bool allows_change(const void* what, const char* function) {
        for (const query_scope* s = innermost(); s != nullptr; s = s->outer_)
            if (s->what_ == what)
                return refuse(function, "broadphase", "being queried", "it must not change until the query has ended");
        return true;
    }

private:
    static const query_scope*& innermost() {
        constinit static thread_local const query_scope* scope = nullptr;
        return scope;
    }

    const void* what_;
    const query_scope* outer_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/proxies.hpp
// =================================================================================================
// What a broadphase knows of its proxies: a box for each, who may meet whom, and which have moved.

PHYSICS_HPP_BEGIN

/// Who may meet whom: each side's category must be in the other's mask, the owners must differ, and one side at least
/// must be movable.
struct proxy_filter {
    std::uint32_t category = 1;
    std::uint32_t mask = 0xffffffffu;
    /// Proxies of one owner, say shapes of one body, never meet; none by default.
    std::uint32_t owner = 0xffffffffu;
    /// False for what nothing pushes: static and kinematic geometry. Such proxies never meet each other, and cost
    /// nothing while they rest.
    bool movable = true;

    friend bool operator==(const proxy_filter&, const proxy_filter&) = default;
};

/// True if the two may meet.
constexpr bool may_meet(const proxy_filter& a, const proxy_filter& b) {
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0 && (a.owner != b.owner || a.owner == 0xffffffffu) &&
           (a.movable || b.movable);
}

/// How much larger than their proxies boxes are kept, so that small moves leave them alone.
template <class S>
struct broadphase_settings {
    /// By how much on every side (m).
    S margin = S(0.05);
    /// How many times the last move ahead.
    S prediction = S(2);
};

template <class S>
bool check(const broadphase_settings<S>& with, const char* function) {
    return detail::check_not_negative(function, "broadphase.margin", with.margin) &&
           detail::check_not_negative(function, "broadphase.prediction", with.prediction);
}

namespace detail {

/// What a query may look at: a proxy, with what an index has at hand of it.
template <class Space>
struct candidate {
    std::uint32_t id;
    proxy_filter filter;
    typename Space::aabb box;
};

/// No proxy has this number.
inline constexpr std::uint32_t no_proxy = 0xffffffffu;

/// The proxies of a broadphase by number.
template <class Space>
class proxies {
public:
    using S = typename Space::scalar;
    using vec = typename Space::vec;
    using aabb = typename Space::aabb;
    static constexpr int D = Space::dimension;

    broadphase_settings<S> settings;

    [[nodiscard]] std::uint32_t size() const { return entries_.size(); }
    [[nodiscard]] std::uint32_t count() const { return count_; }
    [[nodiscard]] bool has(std::uint32_t id) const { return id < entries_.size() && used_[id]; }
    /// The box, with its margins.
    [[nodiscard]] const aabb& box(std::uint32_t id) const { return boxes_[id]; }
    [[nodiscard]] const proxy_filter& filter(std::uint32_t id) const { return entries_[id].filter; }
    [[nodiscard]] bool is_movable(std::uint32_t id) const { return entries_[id].filter.movable; }
    /// Asks the memory for a proxy that is going to be looked at.
    void fetch(std::uint32_t id) const {
        PHYSICS_HPP_PREFETCH(&boxes_[id]);
        PHYSICS_HPP_PREFETCH(&entries_[id]);
    }
    /// Whether the proxy came, went or left its box since the last search for pairs.
    [[nodiscard]] bool stale(std::uint32_t id) const { return stale_[id]; }
    /// Whether the number was given up since then, and perhaps given to another proxy.
    [[nodiscard]] bool given_up(std::uint32_t id) const { return any_given_up_ && entries_[id].given_up; }
    [[nodiscard]] candidate<Space> candidate_at(std::uint32_t id) const { return {id, filter(id), box(id)}; }
    [[nodiscard]] const candidate<Space>& candidate_at(const candidate<Space>& c) const { return c; }
    [[nodiscard]] bool may_meet(std::uint32_t a, std::uint32_t b) const {
        return physics::may_meet(entries_[a].filter, entries_[b].filter);
    }
    /// Those that came, went or left their box since then, once each.
    [[nodiscard]] const buffer<std::uint32_t>& changed() const { return changed_; }
    /// Those that left their box since the index last heard of it, once each.
    [[nodiscard]] const buffer<std::uint32_t>& unseen() const { return unseen_; }
    void show() {
        for (const std::uint32_t id : unseen_) entries_[id].unseen = false;
        unseen_.clear();
    }

    void insert(std::uint32_t id, const aabb& box, const proxy_filter& filter) {
        if (id >= entries_.size()) {
            entries_.resize(id + 1);
            boxes_.resize(id + 1);
            used_.grow(id + 1);
            stale_.grow(id + 1);
        }
        entries_[id].filter = filter;
        used_.set(id);
        boxes_[id] = grown(box, settings.margin);
        ++count_;
        note(id);
    }
    void erase(std::uint32_t id) {
        used_.clear(id);
        entries_[id].given_up = any_given_up_ = true;
        --count_;
        note(id);
    }
    /// Whether a proxy in this box keeps within its margins; false for no box at all.
    [[nodiscard]] bool holds(std::uint32_t id, const aabb& box) const {
        const aabb& own = boxes_[id];
        for (int i = 0; i < D; ++i)
            if (!(own.lower[i] <= box.lower[i] && box.lower[i] <= box.upper[i] && box.upper[i] <= own.upper[i]))
                return false;
        return true;
    }
    /// Gives a proxy a new box around this one, wider on the way ahead.
    void move(std::uint32_t id, const aabb& box, const vec& way) {
        boxes_[id] = grown(box, settings.margin);
        for (int i = 0; i < D; ++i) {
            // No farther than the box is wide: a teleport is no velocity.
            const S most = box.upper[i] - box.lower[i] + settings.margin;
            const S ahead = clamp(way[i] * settings.prediction, -most, most);
            if (ahead > S(0)) boxes_[id].upper[i] += ahead;
            else boxes_[id].lower[i] += ahead;
        }
        note(id);
        if (!entries_[id].unseen) unseen_.push(id);
        entries_[id].unseen = true;
    }
    /// Forgets which have changed.
    void settle() {
        for (const std::uint32_t id : changed_) {
            stale_.clear(id);
            if (any_given_up_) entries_[id].given_up = false;
        }
        changed_.clear();
        any_given_up_ = false;
    }

private:
    struct entry {
        proxy_filter filter;
        bool given_up = false, unseen = false;
    };

    void note(std::uint32_t id) {
        if (stale_[id]) return;
        stale_.set(id);
        changed_.push(id);
    }

    buffer<aabb> boxes_;
    buffer<entry> entries_;
    buffer<std::uint32_t> changed_, unseen_;
    bit_array used_, stale_;
    reset_on_move<std::uint32_t> count_;
    bool any_given_up_ = false;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/concept.hpp
// =================================================================================================
// What a broadphase must offer.

PHYSICS_HPP_BEGIN

/// Two proxies whose boxes overlap; a < b.
struct proxy_pair {
    std::uint32_t a;
    std::uint32_t b;

    friend bool operator==(proxy_pair, proxy_pair) = default;
};
constexpr bool operator<(proxy_pair x, proxy_pair y) {
    return x.a != y.a ? x.a < y.a : x.b < y.b;
}

/// A broadphase bound to a space: a copyable set of boxes by number, with
///   insert(id, box, filter), erase(id)   numbers are small and may come again after erase
///   move(id, box, way)   the proxy is in this box now, and moves that way (m a step)
///   pairs(accept)        a buffer of all pairs of overlapping boxes for which may_meet(filter, filter) and
///                        accept(a, b) are true, each once, in ascending order; pairs of boxes that are close may be
///                        among them
/// and, if it likes, configure(broadphase_settings) and update(), which is called when boxes have moved, so that
/// queries see them. A policy is a type with `using stage = physics::stage::broadphase` and such a class as
/// `in<Space>`: of your own, or an indexed_broadphase around an index of your own.
template <class B, class Space>
concept broadphase_for = std::copyable<B> && std::default_initializable<B> &&
    requires(B b, std::uint32_t id, const typename Space::aabb box, const typename Space::vec way,
             const proxy_filter filter, bool (*accept)(std::uint32_t, std::uint32_t)) {
    b.insert(id, box, filter);
    b.move(id, box, way);
    b.erase(id);
    { b.pairs(accept) } -> std::convertible_to<const buffer<proxy_pair>&>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/pair_set.hpp
// =================================================================================================
// The pairs of a broadphase from search to search: which go on, which begin, which end.

PHYSICS_HPP_BEGIN

namespace detail {

/// Pairs in ascending order. What a search finds is sorted and merged with what was there before: no hashing, and the
/// order depends on the numbers alone.
class pair_set {
public:
    [[nodiscard]] const buffer<proxy_pair>& pairs() const { return pairs_; }
    [[nodiscard]] const buffer<proxy_pair>& begun() const { return begun_; }
    [[nodiscard]] const buffer<proxy_pair>& ended() const { return ended_; }

    /// Before a search among numbers below `size`.
    void start(std::uint32_t size) {
        bits_ = static_cast<int>(std::bit_width(size));
        found_.clear();
    }
    void add(std::uint32_t a, std::uint32_t b) {
        found_.push(a < b ? std::uint64_t{a} << bits_ | b : std::uint64_t{b} << bits_ | a);
    }
    /// After a search that found the pairs of all proxies, or of those that are stale.
    template <class Table>
    void finish(const Table& all, bool everything) {
        begun_.clear();
        ended_.clear();
        if (found_.empty() && all.changed().empty()) return;
        spare_.resize(found_.size());
        const std::uint64_t* now = radix_sort(found_.begin(), spare_.begin(), found_.size(), 0, 2 * bits_);
        const std::uint64_t* const end = now + found_.size();
        next_.clear();
        next_.reserve(pairs_.size() + found_.size());
        const auto begin_pair = [&](std::uint64_t key) {
            const proxy_pair p{static_cast<std::uint32_t>(key >> bits_),
                               static_cast<std::uint32_t>(key & ((std::uint64_t{1} << bits_) - 1))};
            begun_.push(p);
            next_.push(p);
        };
        for (const proxy_pair& p : pairs_) {
            const std::uint64_t key = std::uint64_t{p.a} << bits_ | p.b;
            while (now < end && *now < key) begin_pair(*now++);
            if (now < end && *now == key) {
                ++now;
                next_.push(p);
                if (!all.given_up(p.a) && !all.given_up(p.b)) continue;
                // Other proxies that bear the same numbers.
                ended_.push(p);
                begun_.push(p);
            } else if (everything || all.stale(p.a) || all.stale(p.b)) {
                ended_.push(p);
            } else {
                next_.push(p);
            }
        }
        while (now < end) begin_pair(*now++);
        pairs_.swap(next_);
    }

private:
    buffer<proxy_pair> pairs_, next_, begun_, ended_;
    buffer<std::uint64_t> found_, spare_;
    int bits_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/queries.hpp
// =================================================================================================
// What can be asked of boxes: exact answers, the same from every broadphase.

PHYSICS_HPP_BEGIN

/// Which proxies a query sees: those whose category is in its mask and whose mask holds its category.
struct query_filter {
    std::uint32_t category = 1;
    std::uint32_t mask = 0xffffffffu;

    [[nodiscard]] constexpr bool sees(const proxy_filter& p) const {
        return (p.category & mask) != 0 && (category & p.mask) != 0;
    }
};

/// A way through space: from an origin along a translation (m). A box of half size `extent` may be swept along it.
template <class S, int D>
struct ray {
    vec<S, D> origin;
    vec<S, D> translation;
    vec<S, D> extent = {};
};

/// The half of space where dot(normal, p) <= offset; the normal need not have length 1.
template <class S, int D>
struct bounding_plane {
    vec<S, D> normal;
    S offset;
};

/// Where a ray enters the box of a proxy: at `fraction` of its translation, 0 if it begins within.
template <class S>
struct proxy_hit {
    std::uint32_t id = 0xffffffffu;
    S fraction = S(1);

    explicit operator bool() const { return id != 0xffffffffu; }
};

namespace detail {

/// Whether a ray meets a closed box within `limit` of its translation, and where it enters. Along an axis in which it
/// does not move, it meets what it is within, faces included. Source: Kay, Kajiya, Ray tracing complex scenes (1986).
template <class S, int D>
constexpr bool meets(const ray<S, D>& r, const aabb<S, D>& box, S limit, S& fraction) {
    S near = S(0), far = limit;
    for (int i = 0; i < D; ++i) {
        // Wide, since boxes may be as large as the range.
        const wide_of<S> way = widen(r.translation[i]), extent = widen(r.extent[i]), origin = widen(r.origin[i]);
        const wide_of<S> to_lower = widen(box.lower[i]) - extent - origin;
        const wide_of<S> to_upper = widen(box.upper[i]) + extent - origin;
        if (r.translation[i] == S(0)) {
            if (to_lower > wide_of<S>{} || to_upper < wide_of<S>{}) return false;
            continue;
        }
        const bool forward = r.translation[i] > S(0);
        near = max(near, quotient<S>(forward ? to_lower : to_upper, way));
        far = min(far, quotient<S>(forward ? to_upper : to_lower, way));
        if (near > far) return false;
    }
    fraction = near;
    return true;
}

/// The box around a whole ray, no larger than the range, with room for what meets() rounds.
template <class S, int D>
constexpr aabb<S, D> around(const ray<S, D>& r) {
    const S most = scalar_traits<S>::max(), step = scalar_traits<S>::epsilon() * S(4);
    aabb<S, D> box;
    for (int i = 0; i < D; ++i) {
        const S end = r.origin[i] + r.translation[i], low = min(r.origin[i], end), high = max(r.origin[i], end);
        const S rounded = abs(r.translation[i]) * step + (abs(low) * step + abs(high) * step) + step;
        const S reach = r.extent[i] > most - rounded ? most : r.extent[i] + rounded;
        box.lower[i] = low < reach - most ? -most : low - reach;
        box.upper[i] = high > most - reach ? most : high + reach;
    }
    return box;
}

/// The square of the distance from a point to a box, without rounding where the scalar can; 0 within.
template <class S, int D>
constexpr wide_of<S> distance_squared(const aabb<S, D>& box, const vec<S, D>& point) {
    vec<S, D> apart;
    for (int i = 0; i < D; ++i) {
        const bool below = point[i] < box.lower[i];
        if (!below && !(point[i] > box.upper[i])) continue;
        apart[i] = below ? box.lower[i] - point[i] : point[i] - box.upper[i];
        // Farther than the range.
        if (apart[i] < S(0)) apart[i] = scalar_traits<S>::max();
    }
    return length_squared(apart);
}

/// Whether a box lies wholly beyond a plane.
template <class S, int D>
constexpr bool beyond(const bounding_plane<S, D>& plane, const aabb<S, D>& box) {
    wide_of<S> least{};
    for (int i = 0; i < D; ++i)
        least = least + product(plane.normal[i], plane.normal[i] > S(0) ? box.lower[i] : box.upper[i]);
    return least > widen(plane.offset);
}

/// Puts an item into a sorted list of at most `most`, before all that come after it by after(other); the last one is
/// lost where the list is full.
template <class T, class After>
constexpr void insert_sorted(T* list, std::uint32_t& count, std::uint32_t most, const T& item, After&& after) {
    std::uint32_t at = count;
    while (at > 0 && after(list[at - 1])) --at;
    if (at == most) return;
    if (count < most) ++count;
    for (std::uint32_t i = count - 1; i > at; --i) list[i] = list[i - 1];
    list[at] = item;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/indexed.hpp
// =================================================================================================
// A broadphase made of an index of boxes: what all that the library ships have in common.

PHYSICS_HPP_BEGIN

/// A broadphase: boxes by number, with margins, filters and what persists of their pairs; queries with exact answers,
/// the same whatever the index, in which boxes have their margins. Only speed depends on the index, and its class
/// says what it costs. Numbers are small and may come again after erase. Functions that change anything refuse to do
/// so from within a visitor, where the query has not ended.
/// An index has, each with the table of proxies first (`all.box(id)`, `all.has(id)`, ...):
///   insert(all, id), erase(all, id)   at once; erase is called while the table still knows the proxy
///   update(all, ids, count)           these have another box than before
///   find(all, emit)                   emit(a, b) once for each two proxies, one of which is all.stale(), whose boxes
///                                     may overlap; true if those were all pairs there are. An index with
///                                     `static constexpr bool exact = true` emits just those that do overlap and that
///                                     all.may_meet(a, b)
///   each_near(all, box, visit)        visit(id) where the box may overlap, until it returns false; or, of an index
///                                     that keeps them itself, visit(candidate) with filter and box
/// and, where it knows a better way than to search boxes, each_along, each_around, each_inside (see tree_index).
template <class Space, class Index>
class indexed_broadphase {
public:
    using S = typename Space::scalar;
    using vec = typename Space::vec;
    using aabb = typename Space::aabb;
    static constexpr int D = Space::dimension;

    /// From now on; boxes stay as they are until they are left.
    void configure(const broadphase_settings<S>& settings) {
        if (check(settings, "configure")) all_.settings = settings;
    }
    [[nodiscard]] std::uint32_t count() const { return all_.count(); }
    /// The box of a proxy, with its margins.
    [[nodiscard]] const aabb& box(std::uint32_t id) const { return all_.box(id); }

    /// Adds a proxy under a number that is free. False where a call was refused and errors do not throw.
    bool insert(std::uint32_t id, const aabb& box, const proxy_filter& filter = {}) {
        const char* f = "insert";
        if (!query_scope_allows(f) || !check_box(f, box)) return false;
        if (id == detail::no_proxy || all_.has(id)) return refuse(f, "id", id, "it must not be in use");
        all_.insert(id, box, filter);
        index_.insert(all_, id);
        return true;
    }
    bool erase(std::uint32_t id) {
        const char* f = "erase";
        if (!query_scope_allows(f) || !check_id(f, id)) return false;
        index_.erase(all_, id);
        all_.erase(id);
        return true;
    }
    /// The proxy is in this box now, and on the way (m a step); nothing happens as long as it keeps within its
    /// margins. Queries see it after update() or pairs(). Cost: 3 to 5 ns.
    bool move(std::uint32_t id, const aabb& box, const vec& way = {}) {
        const char* f = "move";
        if (!check_id(f, id)) return false;
        if (all_.holds(id, box)) return true;
        if (!query_scope_allows(f) || !check_box(f, box)) return false;
        all_.move(id, box, way);
        return true;
    }
    /// Shows what has moved to queries.
    void update() {
        if (!query_scope_allows("update")) return;
        index_.update(all_, all_.unseen().begin(), all_.unseen().size());
        all_.show();
    }

    /// All pairs of proxies that may meet, whose boxes overlap and that accept(a, b) takes, in ascending order. It is
    /// asked when a pair is found, and again when one of the two has left its box.
    template <class Accept>
    const buffer<proxy_pair>& pairs(Accept&& accept) {
        if (!query_scope_allows("pairs")) return pairs_.pairs();
        update();
        pairs_.start(all_.size());
        const bool everything = index_.find(all_, [&](std::uint32_t a, std::uint32_t b) {
            if constexpr (!requires { requires Index::exact; })
                if (!all_.may_meet(a, b) || !overlap(all_.box(a), all_.box(b))) return;
            if (accept(a < b ? a : b, a < b ? b : a)) pairs_.add(a, b);
        });
        pairs_.finish(all_, everything);
        all_.settle();
        return pairs_.pairs();
    }
    /// What the last call of pairs() had and the one before it had not, in ascending order; and the reverse. A number
    /// that was given to another proxy in between ends its pairs and begins them.
    [[nodiscard]] const buffer<proxy_pair>& begun() const { return pairs_.begun(); }
    [[nodiscard]] const buffer<proxy_pair>& ended() const { return pairs_.ended(); }

    /// Calls visit(id) for every proxy whose box shares a point with this one, in any order. Where visit returns a
    /// bool, false ends the query.
    template <class Visit>
    void each_overlapping(const aabb& box, const query_filter& filter, Visit&& visit) const {
        if (!check_box("each_overlapping", box)) return;
        const detail::query_scope scope(this);
        index_.each_near(all_, box, [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            return !filter.sees(c.filter) || !overlap(c.box, box) || go_on(visit, c.id);
        });
    }
    /// Writes up to `most` of them to `out` instead; returns how many there are.
    std::uint32_t overlapping(const aabb& box, const query_filter& filter, std::uint32_t* out,
                              std::uint32_t most) const {
        std::uint32_t count = 0;
        each_overlapping(box, filter, [&](std::uint32_t id) {
            if (count < most) out[count] = id;
            ++count;
        });
        return count;
    }
    /// The same for a point.
    template <class Visit>
    void each_at(const vec& point, const query_filter& filter, Visit&& visit) const {
        if (detail::check_finite("each_at", "point", point)) each_overlapping({point, point}, filter, visit);
    }
    /// Calls visit(id) for every proxy whose box does not lie wholly beyond one of the planes: boxes in a convex
    /// region, and a few beside its edges.
    template <class Visit>
    void each_inside(const bounding_plane<S, D>* planes, std::uint32_t count, const query_filter& filter,
                     Visit&& visit) const {
        for (std::uint32_t i = 0; i < count; ++i)
            if (!detail::check_finite("each_inside", "normal", planes[i].normal) ||
                !detail::check_finite("each_inside", "offset", planes[i].offset))
                return;
        const detail::query_scope scope(this);
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            if (!filter.sees(c.filter)) return true;
            for (std::uint32_t i = 0; i < count; ++i)
                if (detail::beyond(planes[i], c.box)) return true;
            return go_on(visit, c.id);
        };
        if constexpr (requires { index_.each_inside(all_, planes, count, see); })
            index_.each_inside(all_, planes, count, see);
        else index_.each_near(all_, everywhere(), see);
    }
    /// Calls visit(hit) for proxies whose boxes the ray meets, the first ones early. visit returns the fraction of the
    /// translation up to which the ray goes on: hit.fraction for the closest, 1 for all, -1 to stop.
    template <class Visit>
    void each_along(const ray<S, D>& r, const query_filter& filter, Visit&& visit) const {
        if (!check_ray("each_along", r)) return;
        const detail::query_scope scope(this);
        S limit = S(1);
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            proxy_hit<S> hit{c.id};
            if (limit >= S(0) && filter.sees(c.filter) && detail::meets(r, c.box, limit, hit.fraction))
                limit = min(limit, visit(hit));
            return limit;
        };
        if constexpr (requires { index_.each_along(all_, r, limit, see); }) {
            index_.each_along(all_, r, limit, see);
        } else {
            index_.each_near(all_, detail::around(r), [&](const auto& at) { return see(at) >= S(0); });
        }
    }
    /// The first proxy on the ray, that of the least number among equals; one with no proxy where there is none.
    [[nodiscard]] proxy_hit<S> closest(const ray<S, D>& r, const query_filter& filter = {}) const {
        proxy_hit<S> best;
        each_along(r, filter, [&](const proxy_hit<S>& hit) {
            if (hit.fraction < best.fraction || (hit.fraction == best.fraction && hit.id < best.id)) best = hit;
            return best.fraction;
        });
        return best;
    }
    /// Writes up to `most` hits to `out`, the first ones, in order; of equal fractions that of the least number first.
    /// Returns how many.
    std::uint32_t along(const ray<S, D>& r, const query_filter& filter, proxy_hit<S>* out, std::uint32_t most) const {
        std::uint32_t count = 0;
        each_along(r, filter, [&](const proxy_hit<S>& hit) {
            const auto after = [&](const proxy_hit<S>& other) {
                return other.fraction > hit.fraction || (other.fraction == hit.fraction && other.id > hit.id);
            };
            detail::insert_sorted(out, count, most, hit, after);
            return count < most ? S(1) : most == 0 ? S(-1) : out[most - 1].fraction;
        });
        return count;
    }
    /// Whether there is any. Stops at the first found.
    [[nodiscard]] bool any(const ray<S, D>& r, const query_filter& filter = {}) const {
        bool found = false;
        each_along(r, filter, [&](const proxy_hit<S>&) {
            found = true;
            return S(-1);
        });
        return found;
    }
    /// Writes up to `most` proxies to `out`, the nearest to the point first, of equals that of the least number, none
    /// farther than `reach`; returns how many.
    std::uint32_t nearest(const vec& point, S reach, const query_filter& filter, std::uint32_t* out,
                          std::uint32_t most) const {
        const char* f = "nearest";
        if (!detail::check_finite(f, "point", point) || !detail::check_not_negative(f, "reach", reach) || most == 0)
            return 0;
        const detail::query_scope scope(this);
        std::uint32_t count = 0;
        const wide_of<S> farthest = product(reach, reach);
        const auto square = [&](std::uint32_t id) { return detail::distance_squared(all_.box(id), point); };
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            const std::uint32_t id = c.id;
            const wide_of<S> here = detail::distance_squared(c.box, point);
            if (filter.sees(c.filter) && !(here > farthest)) {
                const auto after = [&](std::uint32_t other) {
                    return square(other) > here || (square(other) == here && other > id);
                };
                detail::insert_sorted(out, count, most, id, after);
            }
            return count < most ? farthest : square(out[count - 1]);
        };
        if constexpr (requires { index_.each_around(all_, point, farthest, see); })
            index_.each_around(all_, point, farthest, see);
        else
            index_.each_near(all_, everywhere(), [&](const auto& at) {
                see(at);
                return true;
            });
        return count;
    }

private:
    bool query_scope_allows(const char* function) const { return detail::query_scope::allows_change(this, function); }
    bool check_id(const char* function, std::uint32_t id) const {
        return all_.has(id) || refuse(function, "id", id, "it must have been inserted");
    }
    static bool check_box(const char* function, const aabb& box) {
        if (!detail::check_finite(function, "lower", box.lower) || !detail::check_finite(function, "upper", box.upper))
            return false;
        for (int i = 0; i < D; ++i) {
            const char component[] = {'.', "xyz"[i], '\0'};
            if (box.lower[i] > box.upper[i])
                return detail::refuse(function, "lower", component, static_cast<double>(box.lower[i]),
                                      "it must not be greater than upper");
        }
        return true;
    }
    static bool check_ray(const char* function, const ray<S, D>& r) {
        if (!detail::check_finite(function, "origin", r.origin) ||
            !detail::check_finite(function, "translation", r.translation))
            return false;
        for (int i = 0; i < D; ++i) {
            if (!detail::check_not_negative(function, "extent", r.extent[i])) return false;
            const S end = r.origin[i] + r.translation[i];
            if (!is_finite(end) || (end > r.origin[i]) != (r.translation[i] > S(0)))
                return detail::refuse(function, "translation", static_cast<double>(r.translation[i]),
                                      "it must end within the scalar's range");
        }
        return true;
    }
    static aabb everywhere() {
        const vec far = vec::filled(scalar_traits<S>::max());
        return {-far, far};
    }
    template <class Visit>
    static bool go_on(Visit& visit, std::uint32_t id) {
        if constexpr (std::is_void_v<decltype(visit(id))>) return visit(id), true;
        else return visit(id);
    }

    detail::proxies<Space> all_;
    Index index_;
    detail::pair_set pairs_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/all_pairs.hpp
// =================================================================================================
// The slow, obviously right broadphase: every box against every other.

PHYSICS_HPP_BEGIN

namespace detail {

/// No index: all boxes, one by one.
template <class Space>
class no_index {
public:
    using table = proxies<Space>;

    void insert(const table&, std::uint32_t) {}
    void erase(const table&, std::uint32_t) {}
    void update(const table&, const std::uint32_t*, std::uint32_t) {}
    template <class Emit>
    bool find(const table& all, Emit&& emit) const {
        for (const std::uint32_t a : all.changed())
            for (std::uint32_t b = 0; b < all.size() && all.has(a); ++b)
                if (all.has(b) && a != b && !(all.stale(b) && b < a)) emit(a, b);
        return false;
    }
    template <class Visit>
    void each_near(const table& all, const typename Space::aabb&, Visit&& visit) const {
        for (std::uint32_t id = 0; id < all.size(); ++id)
            if (all.has(id) && !visit(id)) return;
    }
};

}  // namespace detail

/// Tests what has left its box against all others: the oracle of the other broadphases. No memory but the boxes; from a
/// few dozen boxes on the others are faster. Cost: 2 to 4 ns a test; insert, move and erase O(1), queries O(n).
struct all_pairs {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::no_index<Space>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/box_block.hpp
// =================================================================================================
// Eight boxes side by side: what trees are made of.

PHYSICS_HPP_BEGIN

namespace detail {

/// A box in float, whatever the scalar: it holds the exact box, so that a search in float misses nothing.
template <int D>
struct float_box {
    float lower[D], upper[D];
};

/// The next float below or above x, or the end of the range.
inline float stepped(float x, bool up) {
    constexpr float most = std::numeric_limits<float>::max();
    if (x != x) return up ? most : -most;
    if (up ? x >= most : x <= -most) return up ? most : -most;
    std::int32_t bits = 0;
    if (x == 0.0f) {
        bits = up ? 1 : static_cast<std::int32_t>(0x80000001u);
    } else {
        std::memcpy(&bits, &x, sizeof bits);
        bits += (x > 0.0f) == up ? 1 : -1;
    }
    std::memcpy(&x, &bits, sizeof x);
    return x < -most ? -most : x > most ? most : x;
}
inline float to_float(double x) {
    constexpr double most = std::numeric_limits<float>::max();
    return static_cast<float>(x > most ? most : x < -most ? -most : x);
}

/// The smallest float box around a box, seen from an origin. Of float itself it is the box, and the origin is 0.
template <class S, int D>
float_box<D> enclosing(const aabb<S, D>& box, const vec<S, D>& origin) {
    float_box<D> result;
    for (int i = 0; i < D; ++i) {
        if constexpr (std::is_same_v<S, float>) {
            result.lower[i] = box.lower[i];
            result.upper[i] = box.upper[i];
        } else {
            // Two roundings to nearest are off by less than one step.
            const double from = static_cast<double>(origin[i]);
            result.lower[i] = stepped(to_float(static_cast<double>(box.lower[i]) - from), false);
            result.upper[i] = stepped(to_float(static_cast<double>(box.upper[i]) - from), true);
        }
    }
    return result;
}

/// Eight boxes in lanes; an empty lane overlaps nothing finite.
template <int D>
struct box_block {
    static constexpr int size = 8;
    using lanes = pack<float, size>;

    float lower[D][size], upper[D][size];

    /// The lower sides by axis, then the upper ones.
    const float* row(int i) const { return i < D ? lower[i] : upper[i - D]; }
    void set(std::uint32_t lane, const float_box<D>& box) {
        for (int i = 0; i < D; ++i) {
            lower[i][lane] = box.lower[i];
            upper[i][lane] = box.upper[i];
        }
    }
    void clear(std::uint32_t lane) {
        constexpr float infinity = std::numeric_limits<float>::infinity();
        for (int i = 0; i < D; ++i) {
            lower[i][lane] = infinity;
            upper[i][lane] = -infinity;
        }
    }
    float_box<D> get(std::uint32_t lane) const {
        float_box<D> box;
        for (int i = 0; i < D; ++i) {
            box.lower[i] = lower[i][lane];
            box.upper[i] = upper[i][lane];
        }
        return box;
    }
    /// The box around all eight.
    float_box<D> all() const {
        float_box<D> box;
        for (int i = 0; i < D; ++i) {
            const lanes l = lanes::load(lower[i]), u = lanes::load(upper[i]);
            box.lower[i] = least<false>(l);
            box.upper[i] = least<true>(u);
        }
        return box;
    }
    /// Which lanes are empty.
    PHYSICS_HPP_ALWAYS_INLINE pack_mask<float, size> empty() const {
        return greater(lanes::load(lower[0]), lanes::load(upper[0]));
    }
    /// Bit i is set where box i shares a point with the given one.
    std::uint32_t overlapping(const float_box<D>& box) const {
        auto apart = beside(box, 0);
        for (int i = 1; i < D; ++i) apart = apart | beside(box, i);
        return ~apart.bits() & 0xffu;
    }

private:
    PHYSICS_HPP_ALWAYS_INLINE pack_mask<float, size> beside(const float_box<D>& box, int axis) const {
        return greater(lanes::load(lower[axis]), lanes::broadcast(box.upper[axis])) |
               greater(lanes::broadcast(box.lower[axis]), lanes::load(upper[axis]));
    }
    /// The smallest lane, or the largest.
    template <bool Largest, class P>
    PHYSICS_HPP_ALWAYS_INLINE static float least(const P& a) {
        float lane[size];
        a.store(lane);
        float best = lane[0];
        for (int i = 1; i < size; ++i) best = (Largest ? lane[i] > best : lane[i] < best) ? lane[i] : best;
        return best;
    }
};

/// Calls f(i) for every bit i that is set.
template <class F>
void each_bit(std::uint32_t bits, F&& f) {
    for (; bits != 0; bits &= bits - 1) f(static_cast<std::uint32_t>(std::countr_zero(bits)));
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/arrange.hpp
// =================================================================================================
// The order in which a tree is packed: neighbours in space next to each other.

PHYSICS_HPP_BEGIN

namespace detail {

/// A box by its middle, for sorting.
struct packed_item {
    float middle[3];
    std::uint32_t id;
};

/// Numbers enclosed: empty, until some come.
struct float_range {
    float low = std::numeric_limits<float>::max(), high = -std::numeric_limits<float>::max();

    void add(float x) {
        low = x < low ? x : low;
        high = x > high ? x : high;
    }
    /// Bins to put numbers into; 0 where they are too close to tell apart.
    float scale(int bins) const {
        const float width = high - low, most = std::numeric_limits<float>::max();
        return width > static_cast<float>(bins) / most ? static_cast<float>(bins) / width : 0;
    }
};

/// Orders items so that the first `count_left` have the smallest middles along an axis. Each round counts items in bins
/// and goes on in the one that holds the border, so that no input takes more than a few rounds. `spare` has room for
/// as many. Cost: 4 ns an item.
inline void split_items(packed_item* items, packed_item* spare, std::uint32_t count, std::uint32_t count_left, int axis,
                        float_range range) {
    while (count > 24) {
        constexpr int most_bins = 256;
        const int bins = count < 512 ? 32 : most_bins;
        const float scale = range.scale(bins);
        if (!(scale > 0)) return;
        const auto bin_of = [&](const packed_item& item) {
            const int bin = static_cast<int>((item.middle[axis] - range.low) * scale);
            return bin < bins ? bin : bins - 1;
        };
        std::uint32_t sizes[most_bins] = {};
        for (std::uint32_t i = 0; i < count; ++i) ++sizes[bin_of(items[i])];
        std::uint32_t before = 0;
        int border = 0;
        while (before + sizes[border] <= count_left) before += sizes[border++];
        // Left of the border bin, in it, and right of it; each in the order as it was.
        const std::uint32_t within = sizes[border];
        std::uint32_t places[3] = {0, before, before + within};
        for (std::uint32_t i = 0; i < count; ++i) {
            const int bin = bin_of(items[i]);
            spare[places[int{bin >= border} + int{bin > border}]++] = items[i];
        }
        std::memcpy(items, spare, count * sizeof *items);
        items += before;
        count = within;
        count_left -= before;
        if (count_left == 0) return;
        range = {};
        for (std::uint32_t i = 0; i < count; ++i) range.add(items[i].middle[axis]);
    }
    for (std::uint32_t i = 1; i < count; ++i) {
        const packed_item item = items[i];
        std::uint32_t k = i;
        for (; k > 0 && items[k - 1].middle[axis] > item.middle[axis]; --k) items[k] = items[k - 1];
        items[k] = item;
    }
}

/// Orders items for a tree of eights: halves them along their longest side, at the border of a full subtree, again and
/// again, so that eights of items, eights of eights and so on are compact. Distant strays and clusters do not spoil
/// it. Cost: 4 ns an item for each halving, 50 to 80 ns in all.
template <int D>
void arrange(packed_item* items, packed_item* spare, std::uint32_t count) {
    while (count > 8) {
        float_range ranges[D];
        for (std::uint32_t i = 0; i < count; ++i)
            for (int k = 0; k < D; ++k) ranges[k].add(items[i].middle[k]);
        int longest = 0;
        for (int k = 1; k < D; ++k)
            if (ranges[k].high - ranges[k].low > ranges[longest].high - ranges[longest].low) longest = k;
        std::uint32_t subtree = 8;
        while (std::uint64_t{subtree} * 8 < count) subtree *= 8;
        const std::uint32_t left = (count + subtree - 1) / subtree / 2 * subtree;
        split_items(items, spare, count, left, longest, ranges[longest]);
        arrange<D>(items, spare, left);
        items += left;
        count -= left;
    }
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/float_order.hpp
// =================================================================================================
// Floats as integers that sort alike.

PHYSICS_HPP_BEGIN

namespace detail {

/// Greater for greater floats; both zeros are alike.
inline std::uint32_t to_ordered(float x) {
    std::uint32_t bits = 0;
    x += 0.0f;
    std::memcpy(&bits, &x, sizeof bits);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
}
inline float from_ordered(std::uint32_t key) {
    const std::uint32_t bits = key >> 31 ? key & 0x7fffffffu : ~key;
    float x = 0;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

/// A few numbers of many, to learn how they are spread without being misled by the outermost.
class float_sample {
public:
    static constexpr std::uint32_t most = 512;

    void add(float x) { keys_[count_++] = std::uint64_t{to_ordered(x)} << 32; }
    void sort() {
        std::uint64_t spare[most];
        const std::uint64_t* sorted = radix_sort(keys_, spare, count_, 32, 64);
        if (sorted != keys_) std::memcpy(keys_, sorted, count_ * sizeof *keys_);
    }
    [[nodiscard]] std::uint32_t size() const { return count_; }
    /// After sort(): the number that a share of all is below; 0 where there is none.
    [[nodiscard]] float at(float share) const {
        if (count_ == 0) return 0;
        const auto i = static_cast<std::uint32_t>(share * static_cast<float>(count_));
        return from_ordered(static_cast<std::uint32_t>(keys_[i < count_ ? i : count_ - 1] >> 32));
    }

private:
    std::uint64_t keys_[most];
    std::uint32_t count_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/axis_order.hpp
// =================================================================================================
// Boxes in the order in which they begin along an axis.

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes sorted by their lower sides along one axis, eight to a block. Above the blocks lies how far any of 8, 64, ...
/// boxes reaches, so that a search finds what began long before without looking at all. What was erased leaves an
/// empty lane with its key until the order is sorted anew.
template <int D>
class axis_order {
public:
    using box = float_box<D>;
    using block = box_block<D>;

    [[nodiscard]] std::uint32_t size() const { return keys_.size(); }
    [[nodiscard]] std::uint32_t live() const { return live_; }
    [[nodiscard]] std::uint32_t blocks() const { return blocks_.size(); }
    [[nodiscard]] const block& operator[](std::uint32_t b) const { return blocks_[b]; }
    [[nodiscard]] std::uint32_t id(std::uint32_t slot) const { return static_cast<std::uint32_t>(keys_[slot]); }
    [[nodiscard]] int axis() const { return axis_; }
    /// About how large boxes are.
    [[nodiscard]] float usual_size() const { return usual_size_; }
    /// Where the middle half of them is when they are sorted: its middle along any axis, its width along the best one.
    [[nodiscard]] float middle(int axis) const { return middle_[axis]; }
    [[nodiscard]] float width() const { return width_; }

    /// Adds a proxy, in no order: to be followed by sort().
    void add(std::uint32_t id) { keys_.push(id); }
    void remove(std::uint32_t slot) {
        clear(slot);
        keys_[slot] |= no_proxy;
        --live_;
    }
    /// Sorts everything, along the axis that suits it best; get(id) gives a box, and at(id, slot) is told where it is.
    template <class Get, class At>
    void sort(Get&& get, At&& at) {
        ids_.clear();
        for (const std::uint64_t key : keys_)
            if (static_cast<std::uint32_t>(key) != no_proxy) ids_.push(static_cast<std::uint32_t>(key));
        const std::uint32_t count = ids_.size();
        boxes_.clear();
        boxes_.reserve(count);
        for (const std::uint32_t id : ids_) boxes_.push(get(id));
        live_ = used_ = count;
        choose_axis();
        keys_.resize(count);
        for (std::uint32_t k = 0; k < count; ++k) keys_[k] = key_of(boxes_[k], k);
        spare_.resize(count);
        if (radix_sort(keys_.begin(), spare_.begin(), count, 32, 64) != keys_.begin()) keys_.swap(spare_);
        // Behind the last one, room for some that come.
        const std::uint32_t blocks = count == 0 ? 0 : (count + count / 16 + 32) / 8;
        keys_.resize(blocks * 8, ~std::uint64_t{0});
        block empty;
        for (std::uint32_t lane = 0; lane < 8; ++lane) empty.clear(lane);
        blocks_.clear();
        blocks_.resize(blocks, empty);
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            const auto k = static_cast<std::uint32_t>(keys_[slot]);
            keys_[slot] = keys_[slot] >> 32 << 32 | ids_[k];
            blocks_[slot / 8].set(slot % 8, boxes_[k]);
            at(ids_[k], slot);
        }
        starts_.clear();
        reaches_.clear();
        for (std::uint32_t n = blocks_.size(); n > 0; n = n > 1 ? (n + 7) / 8 : 0) {
            starts_.push(reaches_.size());
            // Whole eights, the last ones reaching nowhere.
            reaches_.resize(reaches_.size() + (n + 7) / 8 * 8, -std::numeric_limits<float>::infinity());
        }
        for (std::uint32_t b = 0; b < blocks_.size(); ++b) lift(b);
        settle();
    }
    /// Whether there is room for one more without sorting everything.
    [[nodiscard]] bool has_room() const { return used_ < size(); }
    /// Puts a proxy that has come where it belongs; the rest is as with move().
    template <class At>
    std::uint32_t insert(std::uint32_t id, const box& to, std::uint32_t most, At&& at) {
        keys_[used_] = keys_[used_] >> 32 << 32 | id;
        ++live_;
        const std::uint32_t slot = used_;
        used_ = slot + 1;
        return move(slot, to, most, at);
    }
    /// Puts a proxy with another box where it belongs, and tells where the others are now. Returns past how many it
    /// went, or stops after `most`; then the order is to be sorted.
    template <class At>
    std::uint32_t move(std::uint32_t slot, const box& to, std::uint32_t most, At&& at) {
        const std::uint64_t key = key_of(to, id(slot));
        const std::uint32_t from = slot, front = static_cast<std::uint32_t>(key >> 32);
        const auto shift = [&](std::uint32_t other) {
            keys_[slot] = keys_[other];
            blocks_[slot / 8].set(slot % 8, blocks_[other / 8].get(other % 8));
            if (id(slot) != no_proxy) at(id(slot), slot);
            slot = other;
            return --most > 0;
        };
        bool on = most > 0;
        while (on && slot > 0 && keys_[slot - 1] >> 32 > front) on = shift(slot - 1);
        while (on && slot + 1 < size() && keys_[slot + 1] >> 32 < front) on = shift(slot + 1);
        keys_[slot] = key;
        blocks_[slot / 8].set(slot % 8, to);
        at(id(slot), slot);
        const std::uint32_t first = slot < from ? slot : from, last = slot < from ? from : slot;
        for (std::uint32_t b = first / 8; b <= last / 8; ++b) lift(b);
        return last - first;
    }

    /// To be called after moves, before searches.
    void settle() {
        float reach = -std::numeric_limits<float>::infinity();
        before_.resize(blocks_.size());
        for (std::uint32_t b = 0; b < blocks_.size(); ++b) before_[b] = reach = max(reach, reaches_[b]);
    }

    /// How many blocks begin no later than there; best found from a number nearby.
    [[nodiscard]] std::uint32_t begun(float end, std::uint32_t guess) const {
        std::uint32_t low = 0, high = blocks_.size();
        for (std::uint32_t step = 2; guess > low && guess < high; step *= 4) {
            if (begins(guess) > end) {
                high = guess;
                guess -= step < guess ? step : guess;
            } else {
                low = guess + 1;
                guess += step;
            }
        }
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            if (begins(middle) > end) high = middle;
            else low = middle + 1;
        }
        return low;
    }
    /// Calls visit(b) for blocks with boxes that reach as far as this one, from the one before `last` downwards, until
    /// it returns false.
    template <class Visit>
    void search(const box& near, std::uint32_t last, Visit&& visit) const {
        const float from = near.lower[axis_];
        for (std::uint32_t b = last; b > 0 && !(before_[b - 1] < from);) {
            // Past long ones far away by leaps.
            int level = std::countr_zero(b) / 3;
            level = level < levels() ? level : levels() - 1;
            while (level >= 0 && !(reaches_[starts_[static_cast<std::uint32_t>(level)] + (b >> 3 * level) - 1] < from))
                --level;
            if (level >= 0) b -= 1u << 3 * level;
            else if (!visit(--b)) return;
        }
    }
    /// Calls visit(b, lanes) for boxes behind a slot that meet its box.
    template <class Visit>
    void sweep(std::uint32_t slot, const box& own, Visit&& visit) const {
        using lanes = typename block::lanes;
        const std::uint32_t blocks = blocks_.size();
        const float end = own.upper[axis_];
        // Along the axis only those of the last block can be apart.
        const int u = (axis_ + 1) % D, v = (axis_ + 2) % D;
        const lanes u_lower = lanes::broadcast(own.lower[u]), u_upper = lanes::broadcast(own.upper[u]);
        const lanes v_lower = lanes::broadcast(own.lower[v]), v_upper = lanes::broadcast(own.upper[v]);
        std::uint32_t mask = 0xfeu << slot % 8 & 0xffu;
        for (std::uint32_t b = slot / 8; b < blocks; ++b, mask = 0xffu) {
            const block& other = blocks_[b];
            if (other.lower[axis_][0] > end) return;
            auto apart = greater(lanes::load(other.lower[u]), u_upper) | greater(u_lower, lanes::load(other.upper[u]));
            if constexpr (D == 3)
                apart = apart | greater(lanes::load(other.lower[v]), v_upper) |
                        greater(v_lower, lanes::load(other.upper[v]));
            const std::uint32_t near = ~apart.bits() & mask;
            if (near != 0) visit(b, near & other.overlapping(own));
        }
    }

private:
    [[nodiscard]] int levels() const { return static_cast<int>(starts_.size()); }
    [[nodiscard]] float begins(std::uint32_t b) const { return blocks_[b].lower[axis_][0]; }
    std::uint64_t key_of(const box& b, std::uint64_t id) const {
        return std::uint64_t{to_ordered(b.lower[axis_])} << 32 | id;
    }
    /// An empty lane that still says where it is.
    void clear(std::uint32_t slot) {
        block& b = blocks_[slot / 8];
        const float at = b.lower[axis_][slot % 8];
        b.clear(slot % 8);
        b.lower[axis_][slot % 8] = at;
    }
    /// Brings up to date how far blocks reach above this one.
    void lift(std::uint32_t b) {
        float reach = blocks_[b].upper[axis_][0];
        for (int lane = 1; lane < 8; ++lane) reach = max(reach, blocks_[b].upper[axis_][lane]);
        for (std::uint32_t level = 0; level < starts_.size(); ++level, b /= 8) {
            float* all = &reaches_[starts_[level]];
            if (all[b] == reach) return;
            all[b] = reach;
            all += b / 8 * 8;
            for (int i = 0; i < 8; ++i) reach = max(reach, all[i]);
        }
    }
    /// The axis along which the middle half of the boxes is spread widest, unless the present one is about as good.
    void choose_axis() {
        const std::uint32_t stride = boxes_.size() / float_sample::most + 1;
        float best = 0;
        int best_axis = axis_;
        float_sample sizes;
        for (std::uint32_t k = 0; k < boxes_.size(); k += stride)
            sizes.add(boxes_[k].upper[axis_] - boxes_[k].lower[axis_]);
        if (sizes.size() == 0) return;
        sizes.sort();
        usual_size_ = max(sizes.at(0.5f), 1e-10f);
        for (int i = 0; i < D; ++i) {
            const int axis = (axis_ + i) % D;
            float_sample sample;
            for (std::uint32_t k = 0; k < boxes_.size(); k += stride) sample.add(boxes_[k].lower[axis]);
            sample.sort();
            const float wide = sample.at(0.75f) - sample.at(0.25f);
            middle_[axis] = sample.at(0.5f);
            width_ = i == 0 || wide > width_ ? wide : width_;
            if (i == 0 || wide > best) {
                best = i == 0 ? wide * 1.25f : wide;
                best_axis = axis;
            }
        }
        axis_ = best_axis;
    }

    /// Where boxes begin, as integers that sort alike, above their proxies.
    buffer<std::uint64_t> keys_, spare_;
    buffer<block> blocks_;
    /// While everything is sorted.
    buffer<std::uint32_t> ids_;
    buffer<box> boxes_;
    /// How far blocks reach, level by level.
    buffer<float> reaches_;
    /// How far any block up to this one reaches.
    buffer<float> before_;
    buffer<std::uint32_t> starts_;
    /// How many there are, and how many lanes before those that were never used.
    reset_on_move<std::uint32_t> live_, used_;
    int axis_ = 0;
    float usual_size_ = 1, width_ = 0, middle_[D]{};
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/box_tests.hpp
// =================================================================================================
// Searches in float for queries of any scalar: they miss nothing that the exact answer holds.

PHYSICS_HPP_BEGIN

namespace detail {

/// A float at least as large as x; infinity where no number is.
template <class T>
float above(T x) {
    if constexpr (std::is_same_v<T, float>) return x;
    constexpr float most = std::numeric_limits<float>::max();
    const float f = stepped(to_float(static_cast<double>(x)), true);
    return f < most ? f : std::numeric_limits<float>::infinity();
}

/// How far apart neighbouring numbers of a scalar are, wherever they are; 0 for floats, whose steps shrink with them.
template <class S>
constexpr double step_of() {
    return std::is_floating_point_v<S> ? 0 : static_cast<double>(scalar_traits<S>::epsilon());
}
/// The same as above() of a square that may be beyond the scalar.
template <class S>
float above_square(wide_of<S> square) {
    // The root may be off by a rounding.
    const double root_of = static_cast<double>(root<S>(square)) * (1 + 0x1p-20) + step_of<S>();
    return above(root_of * root_of);
}

/// How far a coordinate may be off after its way to float, a few roundings included.
inline float doubt(float x) { return (x < 0 ? -x : x) * 0x1p-21f; }

/// A ray among boxes in float.
template <int D>
struct float_ray {
    static constexpr float tiny = 1e-30f, slack = 0x1p-20f;

    /// Along one axis: which sides the ray enters and leaves by, as rows of a block, and from where the distances to
    /// them are measured; the extent is in these. The inverse translation, for entries a little less than it is, for
    /// exits a little more.
    struct along {
        int in, out;
        float from_in, from_out, to_in, to_out;
    };
    along axes[D];
    bool moves[D];
    bool moves_along_all = true;
    /// How far the scalar may have rounded a fraction.
    float step = 0;

    template <class S>
    float_ray(const ray<S, D>& r, const vec<S, D>& origin) {
        step = to_float(2 * step_of<S>());
        for (int i = 0; i < D; ++i) {
            float f, from_lower, from_upper, pad = 0;
            if constexpr (std::is_same_v<S, float>) {
                f = r.translation[i];
                from_lower = r.origin[i] + r.extent[i];
                from_upper = r.origin[i] - r.extent[i];
                // A ray in float is what it is, a box may be rounded.
                if (r.extent[i] != 0) pad = doubt(r.origin[i]) + doubt(r.extent[i]);
            } else {
                const double o = static_cast<double>(r.origin[i]) - static_cast<double>(origin[i]);
                const double e = static_cast<double>(r.extent[i]);
                f = to_float(static_cast<double>(r.translation[i]));
                from_lower = to_float(o + e);
                from_upper = to_float(o - e);
                pad = doubt(to_float(o)) + doubt(to_float(e));
            }
            moves[i] = f > tiny || f < -tiny;
            moves_along_all = moves_along_all && moves[i];
            if (!moves[i] && !(r.translation[i] == S(0))) pad += 2 * tiny;
            from_lower += pad;
            from_upper -= pad;
            const float inverse = moves[i] ? 1 / f : 0;
            const bool forward = !moves[i] || f > 0;
            axes[i] = {forward ? i : D + i,
                       forward ? D + i : i,
                       forward ? from_lower : from_upper,
                       forward ? from_upper : from_lower,
                       inverse * (1 - slack),
                       inverse * (1 + slack)};
        }
    }
    /// Which of eight boxes the ray meets within the limit, and about where.
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t meets(const box_block<D>& boxes, float limit, float (&near)[8]) const {
        return moves_along_all ? find<true>(boxes, limit, near) : find<false>(boxes, limit, near);
    }

private:
    template <bool MovesAlongAll>
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t find(const box_block<D>& boxes, float limit, float (&near)[8]) const {
        using lanes = typename box_block<D>::lanes;
        lanes first = lanes::broadcast(0), last = lanes::broadcast(limit);
        auto apart = greater(first, last);
        for (int i = 0; i < D; ++i) {
            const along& a = axes[i];
            const lanes in = lanes::load(boxes.row(a.in)) - lanes::broadcast(a.from_in);
            const lanes out = lanes::load(boxes.row(a.out)) - lanes::broadcast(a.from_out);
            if (!MovesAlongAll && !moves[i]) {
                apart = apart | greater(in, lanes::broadcast(0)) | greater(lanes::broadcast(0), out);
                continue;
            }
            first = max(first, in * lanes::broadcast(a.to_in));
            last = min(last, out * lanes::broadcast(a.to_out));
        }
        first.store(near);
        apart = apart | greater(first, last + lanes::broadcast(step));
        return ~apart.bits() & 0xffu;
    }
};

/// A point among boxes in float.
template <int D>
struct float_point {
    float lower[D], upper[D];

    template <class S>
    float_point(const vec<S, D>& p, const vec<S, D>& origin) {
        for (int i = 0; i < D; ++i) {
            const float f = to_float(static_cast<double>(p[i]) - static_cast<double>(origin[i]));
            const float pad = std::is_same_v<S, float> ? 0 : doubt(f);
            lower[i] = f - pad;
            upper[i] = f + pad;
        }
    }
    /// Which of eight boxes are within the square of a distance, and about at which.
    std::uint32_t within(const box_block<D>& boxes, float limit, float (&squares)[8]) const {
        using lanes = typename box_block<D>::lanes;
        const lanes zero = lanes::broadcast(0);
        lanes sum = zero;
        for (int i = 0; i < D; ++i) {
            const lanes below = lanes::load(boxes.lower[i]) - lanes::broadcast(upper[i]);
            const lanes above = lanes::broadcast(lower[i]) - lanes::load(boxes.upper[i]);
            const lanes apart = max(max(below, above), zero);
            sum += apart * apart;
        }
        sum = sum * lanes::broadcast(1 - 0x1p-20f);
        sum.store(squares);
        const auto outside = greater(sum, lanes::broadcast(limit)) | boxes.empty();
        return ~outside.bits() & 0xffu;
    }
};

/// A bounding plane among boxes in float.
template <int D>
struct float_plane {
    float normal[D];
    float offset;

    float_plane() = default;
    template <class S>
    float_plane(const bounding_plane<S, D>& plane, const vec<S, D>& origin) {
        // Scaled to a normal of about 1; how far the offset may be off depends on what it is a sum of.
        double largest = 0;
        for (int i = 0; i < D; ++i) {
            const double n = static_cast<double>(plane.normal[i]);
            largest = n > largest ? n : -n > largest ? -n : largest;
        }
        const double scale = largest > 0 ? 1 / largest : 1;
        double sum = static_cast<double>(plane.offset) * scale, parts = sum < 0 ? -sum : sum;
        for (int i = 0; i < D; ++i) {
            const double n = static_cast<double>(plane.normal[i]) * scale, o = n * static_cast<double>(origin[i]);
            normal[i] = to_float(n);
            sum -= o;
            parts += o < 0 ? -o : o;
        }
        offset = above(sum + parts * 0x1p-40);
        offset += doubt(offset);
    }
    /// Which of eight boxes are not wholly beyond.
    std::uint32_t reaches(const box_block<D>& boxes) const {
        using lanes = typename box_block<D>::lanes;
        lanes sum = lanes::broadcast(-offset), error = lanes::broadcast(0);
        for (int i = 0; i < D; ++i) {
            const lanes corner = lanes::load(normal[i] > 0 ? boxes.lower[i] : boxes.upper[i]);
            // The ends of float stand for whatever is beyond them.
            const lanes product_of = corner * lanes::broadcast(normal[i]), away = max(corner, -corner);
            const lanes along = select_greater(away, lanes::broadcast(3.4e38f), -away, product_of);
            sum += along;
            error += max(along, -along);
        }
        return ~greater(sum, error * lanes::broadcast(0x1p-20f)).bits() & 0xffu;
    }
};

/// A convex region among boxes in float: its first planes, which exclude most; the exact test knows the others.
template <int D>
class float_region {
public:
    template <class S>
    float_region(const bounding_plane<S, D>* planes, std::uint32_t count, const vec<S, D>& origin)
        : count_(count < most ? count : most) {
        for (std::uint32_t i = 0; i < count_; ++i) planes_[i] = {planes[i], origin};
    }
    /// Which of eight boxes are not wholly beyond any of them.
    std::uint32_t reaches(const box_block<D>& boxes) const {
        std::uint32_t lanes = ~boxes.empty().bits() & 0xffu;
        for (std::uint32_t i = 0; i < count_ && lanes != 0; ++i) lanes &= planes_[i].reaches(boxes);
        return lanes;
    }

private:
    static constexpr std::uint32_t most = 16;

    std::uint32_t count_;
    float_plane<D> planes_[most];
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/block_scan.hpp
// =================================================================================================
// Queries that indices of blocks of boxes have in common.

PHYSICS_HPP_BEGIN

namespace detail {

/// Queries for an index whose boxes lie in blocks:
///   each_eight(f)        f(block, id_of) for each, where id_of(lane) is a proxy, until it returns false
///   each_eight(box, f)   the same for those with boxes that may meet a box
///   each_loose(visit)    visit(id) for what is in no block
///   usual_size()         how far to look for neighbours at first
/// Costs: each_inside 0.3 to 0.5 ns a proxy, wherever it is.
template <class Index, class Space>
class block_scan {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;

    template <class Table, class Visit>
    void each_inside(const Table&, const bounding_plane<S, D>* planes, std::uint32_t count, Visit&& visit) const {
        const float_region<D> region(planes, count, self().origin());
        bool on = true;
        self().each_loose([&](std::uint32_t id) { on = on && visit(id); });
        self().each_eight([&](const box_block<D>& block, auto&& id_of) {
            each_bit(region.reaches(block), [&](std::uint32_t lane) { on = on && visit(id_of(lane)); });
            return on;
        });
    }
    /// In boxes around the point, each twice as wide as the one before; the rest at once.
    template <class Table, class Visit>
    void each_around(const Table&, const typename Space::vec& point, wide_of<S> limit, Visit&& visit) const {
        const float_point<D> at(point, self().origin());
        float reach = above_square<S>(limit), squares[8], done = -1;
        const auto see = [&](std::uint32_t id) { reach = above_square<S>(visit(id)); };
        const auto scan = [&](float most, const box_block<D>& block, auto&& id_of) {
            each_bit(at.within(block, min(most, reach), squares), [&](std::uint32_t lane) {
                if (squares[lane] > done && !(squares[lane] > reach)) see(id_of(lane));
            });
            return true;
        };
        self().each_loose(see);
        float radius = self().usual_size();
        for (int round = 0; round < 6 && done < reach; ++round, radius *= 2) {
            float_box<D> near;
            for (int i = 0; i < D; ++i) {
                near.lower[i] = at.lower[i] - radius * 1.00001f;
                near.upper[i] = at.upper[i] + radius * 1.00001f;
            }
            const float most = radius * radius;
            self().each_eight(near, [&](const auto& block, auto&& id_of) { return scan(most, block, id_of); });
            done = most;
        }
        if (done < reach) self().each_eight([&](const auto& block, auto&& id_of) { return scan(reach, block, id_of); });
    }

private:
    const Index& self() const { return static_cast<const Index&>(*this); }
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/cell_blocks.hpp
// =================================================================================================
// Boxes in cells, eight to a block.

PHYSICS_HPP_BEGIN

namespace detail {

inline constexpr std::uint32_t no_block = 0xffffffffu;

/// Up to eight boxes of one cell. Lanes from 0 to count - 1 are in use, the others empty.
template <int D>
struct cell_block {
    box_block<D> boxes;
    std::uint64_t key;
    std::uint32_t ids[8];
    /// The next block of the same cell.
    std::uint32_t next;
    std::uint8_t count;
    std::uint8_t level;
    /// By lane: whether the proxy is movable, and whether it has moved (only while pairs are searched).
    std::uint8_t movable, moved;
};

/// Blocks in chains, one chain a cell. All blocks of a chain but its first are full, so that adding and removing cost
/// the same however many share a cell.
template <int D>
class cell_blocks {
public:
    using block = cell_block<D>;

    [[nodiscard]] std::uint32_t size() const { return blocks_.size(); }
    [[nodiscard]] const block& operator[](std::uint32_t b) const { return blocks_[b]; }
    block& operator[](std::uint32_t b) { return blocks_[b]; }

    void clear() {
        blocks_.clear();
        free_.clear();
    }
    /// Adds a box to the chain that begins at `head`; returns its slot, eight a block.
    std::uint32_t add(std::uint32_t& head, std::uint64_t key, std::uint32_t level, const float_box<D>& box,
                      std::uint32_t id, bool movable) {
        if (head == no_block || blocks_[head].count == 8) {
            const std::uint32_t fresh = take();
            blocks_[fresh].key = key;
            blocks_[fresh].level = static_cast<std::uint8_t>(level);
            blocks_[fresh].next = head;
            head = fresh;
        }
        block& b = blocks_[head];
        const std::uint32_t lane = b.count++;
        b.boxes.set(lane, box);
        b.ids[lane] = id;
        set_bit(b.movable, lane, movable);
        return head * 8 + lane;
    }
    /// Takes a box out of its chain. The last one of the first block goes to its place: no_proxy, or the proxy that
    /// is in `slot` now.
    std::uint32_t remove(std::uint32_t& head, std::uint32_t slot) {
        block &to = blocks_[slot / 8], &from = blocks_[head];
        const std::uint32_t hole = slot % 8, last = --from.count;
        std::uint32_t moved = no_proxy;
        if (head != slot / 8 || hole != last) {
            moved = to.ids[hole] = from.ids[last];
            to.boxes.set(hole, from.boxes.get(last));
            set_bit(to.movable, hole, from.movable >> last & 1);
        }
        from.boxes.clear(last);
        set_bit(from.movable, last, false);
        if (last == 0) {
            free_.push(head);
            head = from.next;
        }
        return moved;
    }

private:
    static void set_bit(std::uint8_t& bits, std::uint32_t bit, bool value) {
        bits = static_cast<std::uint8_t>((bits & ~(1u << bit)) | (value ? 1u << bit : 0u));
    }
    std::uint32_t take() {
        if (!free_.empty()) {
            const std::uint32_t b = free_.back();
            free_.pop();
            return b;
        }
        block empty{};
        for (std::uint32_t lane = 0; lane < 8; ++lane) empty.boxes.clear(lane);
        blocks_.push(empty);
        return blocks_.size() - 1;
    }

    buffer<block> blocks_;
    buffer<std::uint32_t> free_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/cell_level.hpp
// =================================================================================================
// Cells of one size.

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells for boxes up to some side, each in the cell of its lower corner. A box that meets another begins no farther
/// below it than its own side: all that may meet it are in a few cells in a row. What lies outside of the region is in
/// the cells at its border. Coordinates rise with the position, whatever is rounded, so that nothing is missed.
template <int D>
struct cell_level {
    /// The longest side of a box, and the same with room for rounding.
    float side, reach;
    float cell, inverse;
    float low[D];
    /// The last coordinate.
    float most[D];
    /// The key of a cell is base + the sum of coordinate * stride.
    std::uint64_t base, stride[D];
    /// How many boxes there are, and how many cells have any.
    std::uint32_t count, cells;

    [[nodiscard]] std::uint32_t at(int axis, float x) const {
        const float t = (x - low[axis]) * inverse;
        return t > 0 ? static_cast<std::uint32_t>(t < most[axis] ? t : most[axis]) : 0;
    }
    [[nodiscard]] bool outside(int axis, float x) const {
        const float t = (x - low[axis]) * inverse;
        return t < 0 || t > most[axis] + 1;
    }
    void set_cell(float size) {
        cell = size;
        inverse = 1 / size;
    }
};

/// A block of cells, as coordinates; both corners belong to it.
template <int D>
struct cell_range {
    std::uint32_t first[D], last[D];

    /// All cells with boxes that may meet this one.
    cell_range(const cell_level<D>& level, const float_box<D>& box) {
        for (int i = 0; i < D; ++i) {
            first[i] = level.at(i, box.lower[i] - level.reach);
            last[i] = level.at(i, box.upper[i]);
        }
    }
    [[nodiscard]] double size() const {
        double product = 1;
        for (int i = 0; i < D; ++i) product *= static_cast<double>(last[i] - first[i]) + 1;
        return product;
    }
    /// Calls visit(key) for each until it returns false.
    template <class Visit>
    bool each(const cell_level<D>& level, Visit&& visit) const {
        const std::uint32_t from = D == 3 ? first[D - 1] : 0, to = D == 3 ? last[D - 1] : 0;
        for (std::uint32_t z = from; z <= to; ++z)
            for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
                std::uint64_t key = level.base + first[0] + y * level.stride[1];
                if constexpr (D == 3) key += z * level.stride[2];
                for (std::uint32_t x = first[0]; x <= last[0]; ++x, ++key)
                    if (!visit(key)) return false;
            }
        return true;
    }
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/cell_walk.hpp
// =================================================================================================
// Rays through cells.

PHYSICS_HPP_BEGIN

namespace detail {

/// A ray that walks through layers of cells across the axis along which it moves most: boxes that it meets begin in
/// the layer or in the few cells before, and each cell is in one layer. Source: after Amanatides, Woo, A fast voxel
/// traversal algorithm (1987), in blocks of cells for boxes that are not points.
template <class S, int D>
class cell_walk {
public:
    cell_walk(const ray<S, D>& r, const vec<S, D>& origin, float step) : step_(static_cast<double>(step)) {
        for (int i = 0; i < D; ++i) {
            from_[i] = static_cast<double>(r.origin[i]) - static_cast<double>(origin[i]);
            way_[i] = static_cast<double>(r.translation[i]);
            extent_[i] = static_cast<double>(r.extent[i]);
            const double size = (from_[i] < 0 ? -from_[i] : from_[i]) + (way_[i] < 0 ? -way_[i] : way_[i]) + extent_[i];
            largest_ = size > largest_ ? size : largest_;
            main_ = way_[i] * way_[i] > way_[main_] * way_[main_] ? i : main_;
        }
    }

    /// Calls visit(range) for blocks of cells of a level in which there may be boxes that the ray meets, in the order
    /// of the ray, until it returns false or `reach`, a fraction of the translation that visit may lower, is passed.
    /// False, and nothing is visited, where that would be more than so many cells.
    template <class Visit>
    bool each_layer(const cell_level<D>& level, const float& reach, std::uint32_t most_cells, Visit&& visit) const {
        const int m = main_;
        const double side = static_cast<double>(level.reach), cell = static_cast<double>(level.cell);
        // As exact as coordinates of cells, and as numbers of the exact test.
        const double pad = cell / 4 + largest_ * (1e-6 + step_), limit = static_cast<double>(reach);
        if (!(largest_ < 1e18) || !(side < 1e30) || way_[m] == 0) return false;
        const bool forward = way_[m] > 0;
        const double end = from_[m] + way_[m] * limit;
        const double low_end = (forward ? from_[m] : end) - extent_[m] - side - pad;
        const double high_end = (forward ? end : from_[m]) + extent_[m] + pad;
        const std::uint32_t lowest = level.at(m, to_float(low_end)), highest = level.at(m, to_float(high_end));
        const std::uint32_t layers = highest - lowest + 1;
        double cells = layers;
        for (int i = 0; i < D; ++i)
            if (i != m) cells *= (2 * extent_[i] + side) / cell + 2;
        if (cells > most_cells) return false;
        for (std::uint32_t n = 0; n < layers; ++n) {
            const std::uint32_t at = forward ? lowest + n : highest - n;
            const double low = static_cast<double>(level.low[m]) + at * cell - pad - extent_[m];
            const double high = low + cell + side + 2 * (pad + extent_[m]);
            double enter = ((forward ? low : high) - from_[m]) / way_[m];
            double leave = ((forward ? high : low) - from_[m]) / way_[m];
            // Those at the border have no end.
            if (at == 0) (forward ? enter : leave) = forward ? 0 : limit;
            if (at == static_cast<std::uint32_t>(level.most[m])) (forward ? leave : enter) = forward ? limit : 0;
            enter = enter > step_ ? enter - step_ : -step_;
            leave = leave < limit ? leave + step_ : limit;
            if (enter > static_cast<double>(reach)) break;
            if (leave < enter) continue;
            float_box<D> part;
            for (int i = 0; i < D; ++i) {
                const double a = from_[i] + way_[i] * enter, b = from_[i] + way_[i] * leave;
                part.lower[i] = to_float((a < b ? a : b) - extent_[i] - pad);
                part.upper[i] = to_float((a < b ? b : a) + extent_[i] + pad);
            }
            cell_range<D> range(level, part);
            range.first[m] = range.last[m] = at;
            if (!visit(range)) break;
        }
        return true;
    }

private:
    double from_[D], way_[D], extent_[D], largest_ = 0, step_;
    int main_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/cell_index.hpp
// =================================================================================================
// The index behind grid and hash_grid: boxes in cells of their size.

PHYSICS_HPP_BEGIN

namespace detail {

/// Levels of cells, each four times as wide as the one before; a box is in the level of its longest side. Cells, a
/// dense array or a hash table, says where the chain of a cell begins:
///   arrange(levels, count, usual, region, population)   how large cells are, and where; forgets all chains
///   adapt(levels, count)   after everything was put in: whether other cells would be better
///   head(key), at(key)     the first block of a cell
/// A box that moves within its cell is only written; one that leaves it costs the same wherever it goes.
template <class Space, class Cells>
class cell_index : public block_scan<cell_index<Space, Cells>, Space> {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using box = float_box<D>;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        // Early ones of many: an update will see to how cells suit them all.
        if (levels_.empty() || all.count() > 4 * packed_ + 64) pack(all);
        else put(all, id, box_of(all, id));
    }
    void erase(const table&, std::uint32_t id) {
        take_out(id);
        wear_ = wear_ + 8;
    }
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t id = ids[i];
            if (!all.has(id)) continue;
            const box b = box_of(all, id);
            auto& block = blocks_[places_[id] / 8];
            if (block.key == key_of(level_of(b), b)) {
                block.boxes.set(places_[id] % 8, b);
            } else {
                take_out(id);
                put(all, id, b);
            }
        }
        if (worn(all)) pack(all);
    }

    /// See tree_index: the pairs of which one at least has moved.
    template <class Emit>
    bool find(const table& all, Emit&& emit) {
        // Some are left where the caller threw out of the last search.
        for (const std::uint32_t b : touched_) blocks_[b].moved = 0;
        touched_.clear();
        std::uint32_t movable = 0, moved[level_count]{};
        for (const std::uint32_t id : all.changed()) {
            if (!all.has(id)) continue;
            auto& block = blocks_[places_[id] / 8];
            ++moved[block.level];
            if (block.moved == 0) touched_.push(places_[id] / 8);
            block.moved = static_cast<std::uint8_t>(block.moved | 1u << places_[id] % 8);
            movable += all.is_movable(id);
        }
        // Where all of a level have moved, they find what is on coarser ones.
        std::uint32_t partly = 0;
        for (std::uint32_t l = 0; l < levels_.size(); ++l) partly |= (moved[l] < levels_[l].count ? 1u : 0u) << l;
        // In the order in which blocks lie in memory, where that is worth a look at each.
        if (touched_.size() > blocks_.size() / 16) {
            for (std::uint32_t b = 0; b < blocks_.size(); ++b)
                if (blocks_[b].moved != 0) find_from(b, partly, emit);
        } else {
            for (const std::uint32_t b : touched_) find_from(b, partly, emit);
        }
        for (const std::uint32_t b : touched_) blocks_[b].moved = 0;
        touched_.clear();
        return movable == movable_;
    }

    template <class Visit>
    void each_near(const table&, const typename Space::aabb& near, Visit&& visit) const {
        const box reach = enclosing(near, origin_);
        each_block(all_levels, reach, [&](std::uint32_t b) {
            bool on = true;
            each_bit(blocks_[b].boxes.overlapping(reach),
                     [&](std::uint32_t lane) { on = on && visit(blocks_[b].ids[lane]); });
            return on;
        });
    }
    /// Along the cells that the ray goes through, layer by layer.
    template <class Visit>
    void each_along(const table&, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> way(r, origin_);
        float reach = above(limit) + way.step, near[8];
        const auto meet = [&](std::uint32_t b) {
            each_bit(way.meets(blocks_[b].boxes, reach, near),
                     [&](std::uint32_t lane) { reach = above(visit(blocks_[b].ids[lane])) + way.step; });
            return !(reach < 0);
        };
        const cell_walk<S, D> cells(r, origin_, way.step);
        std::uint32_t wide = 0;
        // Large ones first: they are few, and likely to end it.
        for (std::uint32_t l = levels_.size(); l-- > 0 && !(reach < 0);) {
            const cell_level<D>& level = levels_[l];
            const auto visit_range = [&](const cell_range<D>& range) { return each_in(level, range, meet); };
            if (level.count > 0 && !cells.each_layer(level, reach, blocks_.size(), visit_range)) wide |= 1u << l;
        }
        if (!(reach < 0)) each_of(wide, meet);
    }

    // For block_scan.
    template <class F>
    void each_eight(F&& f) const {
        for (std::uint32_t b = 0; b < blocks_.size(); ++b)
            if (blocks_[b].count > 0 && !f(blocks_[b].boxes, [&](std::uint32_t lane) { return blocks_[b].ids[lane]; }))
                return;
    }
    template <class F>
    void each_eight(const box& near, F&& f) const {
        each_block(all_levels, near, [&](std::uint32_t b) {
            return f(blocks_[b].boxes, [&](std::uint32_t lane) { return blocks_[b].ids[lane]; });
        });
    }
    [[nodiscard]] float usual_size() const { return levels_.empty() ? 1 : levels_[usual].cell; }
    template <class F>
    void each_loose(F&&) const {}
    [[nodiscard]] const typename Space::vec& origin() const { return origin_; }

private:
    /// Below and above the level that most boxes are in; the last one has no bounds, and one cell.
    static constexpr std::uint32_t finer = 4, coarser = 4, level_count = finer + coarser + 2, usual = finer;
    static constexpr std::uint32_t all_levels = ~0u;

    box box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }
    static float side_of(const box& b) {
        float side = 0;
        for (int i = 0; i < D; ++i) side = b.upper[i] - b.lower[i] > side ? b.upper[i] - b.lower[i] : side;
        return side;
    }
    std::uint32_t level_of(const box& b) const {
        const float side = side_of(b);
        std::uint32_t l = usual;
        while (l + 1 < level_count && side > levels_[l].side) ++l;
        while (l > 0 && !(side > levels_[l - 1].side)) --l;
        return l;
    }
    std::uint64_t key_of(std::uint32_t l, const box& b) const {
        const cell_level<D>& level = levels_[l];
        std::uint64_t key = level.base;
        for (int i = 0; i < D; ++i) key += level.at(i, b.lower[i]) * level.stride[i];
        return key;
    }
    void put(const table& all, std::uint32_t id, const box& b) {
        const std::uint32_t l = level_of(b);
        cell_level<D>& level = levels_[l];
        const std::uint64_t key = key_of(l, b);
        std::uint32_t& head = cells_.at(key);
        level.cells += head == no_block;
        ++level.count;
        movable_ = movable_ + all.is_movable(id);
        places_[id] = blocks_.add(head, key, l, b, id, all.is_movable(id));
        // Far from all cells, where each more makes the others slower.
        for (int i = 0; i < D; ++i) wear_ = wear_ + (l + 1 < level_count && level.outside(i, b.lower[i]) ? 16 : 0);
        ++wear_;
    }
    void take_out(std::uint32_t id) {
        const std::uint32_t slot = places_[id];
        auto& block = blocks_[slot / 8];
        cell_level<D>& level = levels_[block.level];
        std::uint32_t& head = cells_.at(block.key);
        movable_ = movable_ - (block.movable >> slot % 8 & 1);
        const std::uint32_t moved = blocks_.remove(head, slot);
        if (moved != no_proxy) places_[moved] = slot;
        level.cells -= head == no_block;
        --level.count;
    }

    /// So much has come, gone or wandered off that other cells, or another order in memory, are likely to be better.
    bool worn(const table& all) const {
        return wear_ > 8 * std::uint64_t{all.count()} + 512 || all.count() > packed_ + packed_ / 2 + 64;
    }

    /// Looks at what there is, arranges cells for it and puts everything in anew.
    void pack(const table& all) {
        float_sample sides, lows[D];
        const std::uint32_t stride = all.count() / float_sample::most + 1;
        const auto sample = [&](auto&& use) {
            std::uint32_t seen = 0;
            for (std::uint32_t id = 0; id < all.size(); ++id)
                if (all.has(id) && seen++ % stride == 0) use(box_of(all, id));
        };
        const auto middle = [&] {
            for (float_sample& s : lows) s = {};
            sample([&](const box& b) {
                for (int i = 0; i < D; ++i) lows[i].add(b.lower[i]);
            });
            for (float_sample& s : lows) s.sort();
        };
        middle();
        if constexpr (!std::is_same_v<S, float>) {
            // Floats are finest near their origin.
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(lows[i].at(0.5f)));
            middle();
        }
        sample([&](const box& b) { sides.add(side_of(b)); });
        sides.sort();
        box region;
        for (int i = 0; i < D; ++i) {
            // What is beyond by more than that is a stray.
            const float low = lows[i].at(0.02f), high = lows[i].at(0.98f), more = (high - low) * 0.25f;
            region.lower[i] = lows[i].at(0) > low - more ? lows[i].at(0) : low - more;
            region.upper[i] = lows[i].at(1) < high + more ? lows[i].at(1) : high + more;
        }
        std::uint32_t population[level_count]{};
        levels_.resize(level_count);
        const float infinity = std::numeric_limits<float>::infinity();
        const float typical = sides.at(0.9f) * 1.25f;
        float side = (typical > 1e-20f ? typical < 1e20f ? typical : 1e20f : 1e-20f) / (1 << 2 * finer);
        for (std::uint32_t l = 0; l < level_count; ++l, side *= 4) {
            levels_[l] = {};
            levels_[l].side = l + 1 < level_count ? side : infinity;
            levels_[l].reach = levels_[l].side * 1.000001f;
        }
        sample([&](const box& b) { population[level_of(b)] += stride; });
        keys_.clear();
        for (std::uint32_t id = 0; id < all.size(); ++id)
            if (all.has(id)) keys_.push(std::uint64_t{place_of(box_of(all, id), region)} << 32 | id);
        const std::uint32_t count = keys_.size();
        spare_.resize(count);
        const std::uint64_t* order = radix_sort(keys_.begin(), spare_.begin(), count, 32, 62);
        for (int attempt = 0;; ++attempt) {
            cells_.arrange(levels_.begin(), level_count, usual, region, population);
            blocks_.clear();
            touched_.clear();
            movable_ = 0;
            for (cell_level<D>& level : levels_) level.count = level.cells = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto id = static_cast<std::uint32_t>(order[i]);
                put(all, id, box_of(all, id));
            }
            if (attempt == 6 || !cells_.adapt(levels_.begin(), level_count)) break;
        }
        wear_ = 0;
        packed_ = count;
    }

    /// Where a box is on a curve through a region that keeps neighbours together in memory.
    /// Source: Morton, A computer oriented geodetic data base (1966).
    static std::uint32_t place_of(const box& b, const box& region) {
        constexpr int bits = 30 / D;
        std::uint32_t place = 0;
        for (int i = 0; i < D; ++i) {
            const float part = (b.lower[i] - region.lower[i]) / (region.upper[i] - region.lower[i]);
            // Not a number where the region is flat.
            const auto cell = static_cast<std::uint32_t>(part > 0 ? (part < 1 ? part : 1) * ((1 << bits) - 1) : 0);
            for (int bit = 0; bit < bits; ++bit) place |= (cell >> bit & 1u) << (bit * D + i);
        }
        return place;
    }

    /// Calls visit(b) for the blocks of some levels with boxes that may meet this one, until it returns false.
    template <class Visit>
    void each_block(std::uint32_t levels, const box& reach, Visit&& visit) const {
        std::uint32_t wide = 0;
        for (std::uint32_t l = 0; l < levels_.size(); ++l) {
            if (levels_[l].count == 0 || !(levels >> l & 1)) continue;
            const cell_range<D> range(levels_[l], reach);
            if (range.size() > blocks_.size()) wide |= 1u << l;
            else if (!each_in(levels_[l], range, visit)) return;
        }
        each_of(wide, visit);
    }
    template <class Visit>
    bool each_in(const cell_level<D>& level, const cell_range<D>& range, Visit&& visit) const {
        return range.each(level, [&](std::uint64_t key) {
            for (std::uint32_t b = cells_.head(key); b != no_block; b = blocks_[b].next)
                if (!visit(b)) return false;
            return true;
        });
    }
    /// The same for all blocks of some levels: where there are more cells than blocks.
    template <class Visit>
    void each_of(std::uint32_t levels, Visit&& visit) const {
        if (levels == 0) return;
        for (std::uint32_t b = 0; b < blocks_.size(); ++b)
            if (blocks_[b].count > 0 && levels >> blocks_[b].level & 1 && !visit(b)) return;
    }

    /// The pairs of the boxes of a block that have moved.
    template <class Emit>
    void find_from(std::uint32_t b, std::uint32_t partly, Emit&& emit) {
        const auto& block = blocks_[b];
        const float room = levels_[block.level].cell * 2;
        const std::uint32_t levels = partly | all_levels << block.level;
        box around{};
        std::uint32_t lanes = 0;
        each_bit(block.moved, [&](std::uint32_t lane) {
            const box own = block.boxes.get(lane);
            if (lanes == 0) around = own;
            box both = around;
            for (int i = 0; i < D; ++i) {
                both.lower[i] = own.lower[i] < both.lower[i] ? own.lower[i] : both.lower[i];
                both.upper[i] = own.upper[i] > both.upper[i] ? own.upper[i] : both.upper[i];
            }
            // Strays may share a cell at the border and yet be far from each other.
            if (lanes != 0 && side_of(both) > room) {
                find_lanes(b, lanes, around, levels, emit);
                lanes = 0;
                both = own;
            }
            around = both;
            lanes |= 1u << lane;
        });
        find_lanes(b, lanes, around, levels, emit);
    }
    template <class Emit>
    void find_lanes(std::uint32_t b, std::uint32_t lanes, const box& around, std::uint32_t levels, Emit&& emit) {
        const auto& block = blocks_[b];
        const std::uint32_t movable = lanes & block.movable;
        const bool alone = (lanes & (lanes - 1)) == 0;
        each_block(levels, around, [&](std::uint32_t o) {
            const auto& other = blocks_[o];
            // Of two that have moved, the one on the finer level finds the other, or that in the earlier block.
            std::uint32_t wanted = movable != 0 ? 0xffu : other.movable;
            const bool finds = block.level != other.level ? block.level < other.level : b < o;
            if (!finds && b != o) wanted &= ~std::uint32_t{other.moved};
            if (wanted == 0) return true;
            each_bit(wanted & other.boxes.overlapping(around), [&](std::uint32_t k) {
                std::uint32_t met = other.movable >> k & 1 ? lanes : movable;
                if (!alone || b == o) met &= block.boxes.overlapping(other.boxes.get(k));
                if (b == o && other.moved >> k & 1) met &= ~((2u << k) - 1);
                each_bit(met, [&](std::uint32_t i) { emit(block.ids[i], other.ids[k]); });
            });
            return true;
        });
    }

    Cells cells_;
    cell_blocks<D> blocks_;
    buffer<cell_level<D>> levels_;
    /// By proxy: its slot, eight a block.
    buffer<std::uint32_t> places_, touched_;
    buffer<std::uint64_t> keys_, spare_;
    typename Space::vec origin_{};
    /// How many there were when cells were arranged, and how many are movable.
    reset_on_move<std::uint32_t> packed_, movable_;
    reset_on_move<std::uint64_t> wear_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/packed_tree.hpp
// =================================================================================================
// A tree of boxes without pointers: eight children a node, every level full but its last node.

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes in eights, eights of these in eights, and so on, in the order in which they were built: neighbours in the
/// order should be neighbours in space. Node n of a level holds the boxes of the nodes 8 n to 8 n + 7 below; the
/// lowest level, 0, holds the boxes of proxies, slot by slot. Boxes may change where they are: `mark` them, and
/// `refit` brings the levels above up to date.
template <int D>
class packed_tree {
public:
    using block = box_block<D>;
    using box = float_box<D>;
    static constexpr int most_levels = 11;

    /// Holds the proxies of these items, in their order; box_at(i) gives the box of item i, filter_of(id) a filter.
    template <class Box, class Filter>
    void build(const packed_item* items, std::uint32_t count, Box&& box_at, Filter&& filter_of) {
        clear();
        const std::uint32_t leaves = (count + 7) / 8;
        ids_.resize(leaves * 8, no_proxy);
        marks_.resize(leaves, 0);
        live_ = count;
        if (leaves == 0) return;
        std::uint32_t total = 0;
        for (std::uint32_t n = leaves;; n = (n + 7) / 8) {
            starts_[levels_] = total;
            ++levels_;
            total += n;
            if (n == 1) break;
        }
        filters_.resize(leaves * 8);
        block empty;
        for (std::uint32_t i = 0; i < 8; ++i) empty.clear(i);
        nodes_.resize(total, empty);
        for (std::uint32_t i = 0; i < count; ++i) {
            nodes_[i / 8].set(i % 8, box_at(i));
            ids_[i] = items[i].id;
            filters_[i] = filter_of(items[i].id);
        }
        for (int level = 1; level < levels_; ++level)
            for (std::uint32_t n = 0; n < nodes_at(level - 1); ++n) lift(level - 1, n);
    }
    void clear() {
        nodes_.clear();
        ids_.clear();
        filters_.clear();
        marks_.clear();
        levels_ = 0;
        live_ = 0;
        marked_ = 0;
    }

    /// The box around everything; of an empty tree none.
    [[nodiscard]] box around() const { return nodes_.back().all(); }
    [[nodiscard]] std::uint32_t live() const { return live_; }
    [[nodiscard]] std::uint32_t leaves() const { return marks_.size(); }
    [[nodiscard]] std::uint32_t nodes_at(int level) const {
        return (level + 1 < levels_ ? starts_[level + 1] : nodes_.size()) - starts_[level];
    }
    [[nodiscard]] const block& node(int level, std::uint32_t n) const { return nodes_[starts_[level] + n]; }
    [[nodiscard]] const block& leaf(std::uint32_t n) const { return nodes_[n]; }
    /// The box around a leaf.
    [[nodiscard]] box around(std::uint32_t leaf) const {
        return levels_ > 1 ? node(1, leaf / 8).get(leaf % 8) : nodes_[leaf].all();
    }
    /// The box around some of a leaf's boxes.
    [[nodiscard]] box around(std::uint32_t leaf, std::uint32_t lanes) const {
        box all;
        for (int i = 0; i < D; ++i) {
            all.lower[i] = std::numeric_limits<float>::infinity();
            all.upper[i] = -all.lower[i];
        }
        each_bit(lanes, [&](std::uint32_t lane) {
            for (int i = 0; i < D; ++i) {
                const float l = nodes_[leaf].lower[i][lane], u = nodes_[leaf].upper[i][lane];
                all.lower[i] = l < all.lower[i] ? l : all.lower[i];
                all.upper[i] = u > all.upper[i] ? u : all.upper[i];
            }
        });
        return all;
    }
    [[nodiscard]] std::uint32_t id(std::uint32_t slot) const { return ids_[slot]; }
    [[nodiscard]] const proxy_filter& filter(std::uint32_t slot) const { return filters_[slot]; }
    [[nodiscard]] bool all_marked() const { return marked_ == live_; }
    /// The slots of a leaf that have been marked.
    [[nodiscard]] std::uint32_t marked(std::uint32_t leaf) const { return marks_[leaf]; }

    void set(std::uint32_t slot, const box& b) { nodes_[slot / 8].set(slot % 8, b); }
    [[nodiscard]] bool any_marked() const { return marked_ > 0; }
    void mark(std::uint32_t slot) {
        const std::uint32_t bit = 1u << slot % 8;
        if (marks_[slot / 8] & bit) return;
        marks_[slot / 8] = static_cast<std::uint8_t>(marks_[slot / 8] | bit);
        ++marked_;
    }
    void clear_marks() {
        if (marked_ == 0) return;
        for (std::uint8_t& m : marks_) m = 0;
        marked_ = 0;
    }
    void remove(std::uint32_t slot) {
        const std::uint32_t bit = 1u << slot % 8;
        nodes_[slot / 8].clear(slot % 8);
        if (marks_[slot / 8] & bit) --marked_;
        marks_[slot / 8] = static_cast<std::uint8_t>(marks_[slot / 8] & ~bit);
        ids_[slot] = no_proxy;
        --live_;
    }
    /// Makes the boxes above these leaves, in ascending order, fit; uses the list up. Returns by how much they have
    /// grown.
    double refit(buffer<std::uint32_t>& touched) {
        double grown = 0;
        for (int level = 0; level + 1 < levels_; ++level) {
            std::uint32_t kept = 0;
            for (std::uint32_t i = 0; i < touched.size(); ++i) {
                const std::uint32_t n = touched[i];
                const box before = node(level + 1, n / 8).get(n % 8), after = node(level, n).all();
                grown += size_of(after) - size_of(before);
                nodes_[starts_[level + 1] + n / 8].set(n % 8, after);
                if (kept == 0 || touched[kept - 1] != n / 8) touched[kept++] = n / 8;
            }
            while (touched.size() > kept) touched.pop();
        }
        return grown;
    }
    /// The sides of the boxes around leaves and whatever is above, but for the top.
    [[nodiscard]] double size() const {
        double sum = 0;
        for (int level = 0; level + 1 < levels_; ++level)
            for (std::uint32_t n = 0; n < nodes_at(level); ++n) sum += size_of(node(level + 1, n / 8).get(n % 8));
        return sum;
    }

    /// Calls visit(leaf, lanes) for each leaf from `first` on that has boxes within reach of the test: test(block)
    /// says which of eight boxes are, and must say so of a box around any that is.
    template <class Test, class Visit>
    void search(std::uint32_t first, Test&& test, Visit&& visit) const {
        if (levels_ == 0) return;
        struct {
            std::uint32_t node, lanes;
        } path[most_levels];
        int level = levels_ - 1;
        path[level] = {0, test(node(level, 0))};
        for (;;) {
            if (level == 0) {
                if (path[0].lanes != 0) visit(path[0].node, path[0].lanes);
                path[0].lanes = 0;
            }
            while (path[level].lanes == 0)
                if (++level == levels_) return;
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(path[level].lanes));
            path[level].lanes &= path[level].lanes - 1;
            const std::uint32_t child = path[level].node * 8 + lane;
            --level;
            // Ends before the first leaf: all of it was visited from there.
            if ((std::uint64_t{child} + 1) << 3 * level <= first) {
                ++level;
                continue;
            }
            path[level] = {child, test(node(level, child))};
        }
    }

    /// Calls visit(slot) for boxes, the ones with small keys early: test(block, keys) says which of eight boxes are
    /// within reach, and writes a key for each, no less than that of a box around it; what has come out of reach by
    /// then, by outside(key), is left out.
    template <class Test, class Outside, class Visit>
    void search_in_order(Test&& test, Outside&& outside, Visit&& visit) const {
        struct entry {
            float key;
            std::uint32_t node;
            int level;
        };
        if (levels_ == 0) return;
        entry stack[7 * most_levels];
        entry next{0, 0, levels_ - 1};
        int top = 0;
        for (;;) {
            float keys[8];
            std::uint32_t lanes = test(node(next.level, next.node), keys);
            if (next.level == 0) {
                each_bit(lanes, [&](std::uint32_t lane) {
                    if (!outside(keys[lane])) visit(next.node * 8 + lane);
                });
            } else if (lanes != 0) {
                // On into the first one, the others later.
                const auto child = [&](std::uint32_t lane) {
                    return entry{keys[lane], next.node * 8 + lane, next.level - 1};
                };
                auto nearest = static_cast<std::uint32_t>(std::countr_zero(lanes));
                each_bit(lanes & (lanes - 1), [&](std::uint32_t lane) {
                    const bool nearer = keys[lane] < keys[nearest];
                    stack[top] = child(nearer ? nearest : lane);
                    fetch(stack[top].level, stack[top].node);
                    ++top;
                    nearest = nearer ? lane : nearest;
                });
                next = child(nearest);
                continue;
            }
            do {
                if (top == 0) return;
                next = stack[--top];
            } while (outside(next.key));
        }
    }

private:
    void fetch(int level, std::uint32_t n) const {
        const char* from = reinterpret_cast<const char*>(&node(level, n));
        for (std::size_t line = 0; line < sizeof(block); line += 64) PHYSICS_HPP_PREFETCH(from + line);
    }
    static double size_of(const box& b) {
        double sum = 0;
        if (b.lower[0] > b.upper[0]) return sum;
        for (int i = 0; i < D; ++i) sum += static_cast<double>(b.upper[i]) - static_cast<double>(b.lower[i]);
        return sum;
    }
    /// Writes the box around a node into the level above.
    void lift(int level, std::uint32_t n) { nodes_[starts_[level + 1] + n / 8].set(n % 8, node(level, n).all()); }

    buffer<block> nodes_;
    buffer<std::uint32_t> ids_;
    /// Copies, so that pairs are filtered without a look at proxies far away in memory.
    buffer<proxy_filter> filters_;
    buffer<std::uint8_t> marks_;
    std::uint32_t starts_[most_levels]{};
    reset_on_move<int> levels_;
    reset_on_move<std::uint32_t> live_, marked_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/tree_index.hpp
// =================================================================================================
// The index behind dynamic_tree: where boxes are, in trees that are packed anew as the boxes move.

PHYSICS_HPP_BEGIN

namespace detail {

/// Movable proxies and those that are not live in trees of their own, and each kind in two: a main tree, in which
/// boxes that move keep their places, and a young one for what came or strayed from its neighbours, packed anew with
/// every change. Once the main tree has grown by a fifth, or an eighth of all is young, everything goes into a new
/// main tree. What has just come or strayed waits in a short tail, searched one by one.
template <class Space>
class tree_index {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using tree = packed_tree<D>;
    static constexpr bool exact = true;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        kind& k = kinds_[all.is_movable(id)];
        places_[id] = tail_place | k.tail.size();
        k.tail.push(id);
        shorten_tail(all, k);
    }
    void erase(const table& all, std::uint32_t id) { take_out(kinds_[all.is_movable(id)], id); }

    /// Brings the trees up to date with the boxes of these proxies.
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (int m = 0; m < 2; ++m) {
            kind& k = kinds_[m];
            keys_.clear();
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint32_t id = ids[i];
                if (!all.has(id) || all.is_movable(id) != (m == 1)) continue;
                if (places_[id] & young_place)
                    send_to_tail(k, id);
                else if (!(places_[id] & tail_place))
                    keys_.push(std::uint64_t{places_[id]} << 32 | id);
            }
            const std::uint32_t young = k.young.live() + k.tail.size(), live = k.main.live() + young;
            if (young > live / 8 || (k.size > most_growth * k.packed_size && !keys_.empty())) {
                pack_all(all, k);
                if (m == 1) follow(all);
                continue;
            }
            touched_.clear();
            if (keys_.size() > live / 8) {
                for (std::uint32_t slot = 0; slot < k.main.leaves() * 8; ++slot) {
                    fetch_ahead(all, k.main, slot);
                    const std::uint32_t id = k.main.id(slot);
                    if (id != no_proxy && all.stale(id)) place(all, k, id);
                }
            } else {
                spare_.resize(keys_.size());
                const std::uint64_t* sorted = radix_sort(keys_.begin(), spare_.begin(), keys_.size(), 32, 64);
                for (std::uint32_t i = 0; i < keys_.size(); ++i) place(all, k, static_cast<std::uint32_t>(sorted[i]));
            }
            k.size += k.main.refit(touched_);
            shorten_tail(all, k);
        }
    }

    /// Calls emit(a, b) for each two proxies of which one at least is stale, that may meet and whose boxes overlap;
    /// once for each two. Returns true if these were all pairs that there are. To be called after an update with
    /// everything that has changed.
    template <class Emit>
    bool find(const table& all, Emit&& emit_pair) {
        const auto emit = [&](const tree& x, std::uint32_t i, const tree& y, std::uint32_t k) {
            if (!may_meet(x.filter(i), y.filter(k))) return;
            const std::uint32_t a = x.id(i), b = y.id(k);
            if constexpr (!std::is_same_v<S, float>)
                if (!overlap(all.box(a), all.box(b))) return;
            emit_pair(a, b);
        };
        for (kind& k : kinds_)
            if (!k.tail.empty()) pack_young(all, k);
        kind &fixed = kinds_[0], &movable = kinds_[1];
        bool everything = true;
        for (tree* x : {&movable.main, &movable.young}) everything = everything && x->all_marked();
        for (tree* x : {&movable.main, &movable.young}) {
            const bool first = x == &movable.main;
            find_pairs(*x, movable.main, first ? same : before, everything, emit);
            find_pairs(*x, movable.young, first ? after : same, everything, emit);
            find_pairs(*x, fixed.main, after, false, emit);
            find_pairs(*x, fixed.young, after, false, emit);
        }
        for (tree* x : {&fixed.main, &fixed.young})
            for (tree* y : {&movable.main, &movable.young}) find_pairs(*x, *y, before, false, emit);
        for (kind& k : kinds_) {
            k.main.clear_marks();
            k.young.clear_marks();
        }
        return everything;
    }

    /// How many blocks of eight boxes a search for this box looks at: what a query costs.
    [[nodiscard]] std::uint32_t blocks_tested(const typename Space::aabb& box) const {
        const float_box<D> reach = enclosing(box, origin_);
        std::uint32_t count = 0;
        for (const kind& k : kinds_)
            for (const tree* t : {&k.main, &k.young})
                t->search(0, [&](const auto& block) { return ++count, block.overlapping(reach); },
                          [](std::uint32_t, std::uint32_t) {});
        return count;
    }
    /// Calls visit(id) for every proxy whose box may overlap this one, until it returns false.
    template <class Visit>
    void each_near(const table& all, const typename Space::aabb& box, Visit&& visit) const {
        const float_box<D> reach = enclosing(box, origin_);
        each_where(
            all, [&](const auto& block) { return block.overlapping(reach); }, visit);
    }
    /// The same for every proxy that may not lie wholly beyond a plane.
    template <class Visit>
    void each_inside(const table& all, const bounding_plane<S, D>* planes, std::uint32_t count, Visit&& visit) const {
        const float_region<D> region(planes, count, origin_);
        each_where(
            all, [&](const auto& block) { return region.reaches(block); }, visit);
    }
    /// Calls visit(id) for proxies that the ray may meet, the first ones early. It returns how far along the
    /// translation the search is to go on.
    template <class Visit>
    void each_along(const table& all, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> way(r, origin_);
        float reach = above(limit) + way.step;
        each_in_order(
            all, [&](const auto& block, auto& keys) { return way.meets(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](const auto& c) { reach = above(visit(c)) + way.step; });
    }
    /// Calls visit(id) for proxies near a point, the nearest ones early. It returns the square of the distance up to
    /// which the search is to go on.
    template <class Visit>
    void each_around(const table& all, const typename Space::vec& point, wide_of<S> limit, Visit&& visit) const {
        const float_point<D> at(point, origin_);
        float reach = above_square<S>(limit);
        each_in_order(
            all, [&](const auto& block, auto& keys) { return at.within(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](const auto& c) { reach = above_square<S>(visit(c)); });
    }

private:
    /// What is in a slot; of float the box in the lane is the exact one, and near in memory.
    static candidate<Space> candidate_in(const table& all, const tree& t, std::uint32_t slot) {
        const std::uint32_t id = t.id(slot);
        if constexpr (!std::is_same_v<S, float>) {
            return {id, t.filter(slot), all.box(id)};
        } else {
            const float_box<D> box = t.leaf(slot / 8).get(slot % 8);
            candidate<Space> c{id, t.filter(slot), {}};
            for (int i = 0; i < D; ++i) {
                c.box.lower[i] = box.lower[i];
                c.box.upper[i] = box.upper[i];
            }
            return c;
        }
    }
    template <class Test, class Visit>
    void each_where(const table& all, Test&& test, Visit&& visit) const {
        bool on = true;
        for (const kind& k : kinds_) {
            for (const tree* t : {&k.main, &k.young})
                t->search(
                    0, [&](const auto& block) { return on ? test(block) : 0u; },
                    [&](std::uint32_t leaf, std::uint32_t lanes) {
                        each_bit(lanes,
                                 [&](std::uint32_t i) { on = on && visit(candidate_in(all, *t, leaf * 8 + i)); });
                    });
            for (std::uint32_t i = 0; i < k.tail.size() && on; ++i) on = visit(all.candidate_at(k.tail[i]));
        }
    }
    template <class Test, class Outside, class Visit>
    void each_in_order(const table& all, Test&& test, Outside&& outside, Visit&& visit) const {
        for (const kind& k : kinds_) {
            for (const tree* t : {&k.main, &k.young})
                t->search_in_order(test, outside, [&](std::uint32_t slot) { visit(candidate_in(all, *t, slot)); });
            for (const std::uint32_t id : k.tail) visit(all.candidate_at(id));
        }
    }

    enum : std::uint32_t { young_place = 1u << 30, tail_place = 2u << 30, slot_mask = (1u << 30) - 1 };
    enum order { before, same, after };
    /// How much larger leaves may get by moving before the tree is packed anew.
    static constexpr double most_growth = 1.2;

    struct kind {
        tree main, young;
        buffer<std::uint32_t> tail;
        /// The sides of the boxes around leaves of the main tree, and above: as they are, and as they were packed.
        double size = 0, packed_size = 0;
    };

    auto box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }

    /// Takes a proxy out of where it is.
    void take_out(kind& k, std::uint32_t id) {
        const std::uint32_t place = places_[id], slot = place & slot_mask;
        if (place & tail_place) {
            k.tail[slot] = k.tail.back();
            places_[k.tail[slot]] = place;
            k.tail.pop();
        } else {
            (place & young_place ? k.young : k.main).remove(slot);
        }
    }

    /// Writes a box where its proxy is in the main tree, or sends the proxy to the tail if that is far from there.
    void place(const table& all, kind& k, std::uint32_t id) {
        const std::uint32_t p = places_[id];
        const float_box<D> box = box_of(all, id);
        const float_box<D> around = k.main.around(p / 8);
        float growth = 0, size = 0;
        for (int i = 0; i < D; ++i) {
            const float below = around.lower[i] - box.lower[i], above_it = box.upper[i] - around.upper[i];
            growth += (below > 0 ? below : 0) + (above_it > 0 ? above_it : 0);
            size += box.upper[i] - box.lower[i];
        }
        if (growth > 0.5f * size) {
            send_to_tail(k, id);
            return;
        }
        k.main.set(p, box);
        k.main.mark(p);
        if (touched_.empty() || touched_.back() != p / 8) touched_.push(p / 8);
    }
    void send_to_tail(kind& k, std::uint32_t id) {
        take_out(k, id);
        places_[id] = tail_place | k.tail.size();
        k.tail.push(id);
    }

    void gather(const table& all, const tree& from) {
        for (std::uint32_t slot = 0; slot < from.leaves() * 8; ++slot) {
            fetch_ahead(all, from, slot);
            if (from.id(slot) != no_proxy) add_item(all, from.id(slot));
        }
    }
    /// Numbers are in no order in memory, so what a loop over slots will look up is asked for in time.
    static void fetch_ahead(const table& all, const tree& t, std::uint32_t slot) {
        constexpr std::uint32_t ahead = 16;
        if (slot + ahead < t.leaves() * 8 && t.id(slot + ahead) != no_proxy) all.fetch(t.id(slot + ahead));
    }
    void add_item(const table& all, std::uint32_t id) {
        const float_box<D> box = box_of(all, id);
        packed_item item{{}, id};
        // A quarter of the sum of both ends: differences stay within the range.
        for (int i = 0; i < D; ++i) item.middle[i] = box.lower[i] * 0.25f + box.upper[i] * 0.25f;
        items_.push(item);
    }
    void pack(const table& all, kind& k, tree& to, std::uint32_t tag) {
        for (const std::uint32_t id : k.tail) add_item(all, id);
        k.tail.clear();
        spare_items_.resize(items_.size());
        arrange<D>(items_.begin(), spare_items_.begin(), items_.size());
        to.build(
            items_.begin(), items_.size(),
            [&](std::uint32_t i) {
                constexpr std::uint32_t ahead = 16;
                if (i + ahead < items_.size()) all.fetch(items_[i + ahead].id);
                return box_of(all, items_[i].id);
            },
            [&](std::uint32_t id) -> const proxy_filter& { return all.filter(id); });
        for (std::uint32_t i = 0; i < items_.size(); ++i) {
            const std::uint32_t id = items_[i].id;
            places_[id] = tag | i;
            if (all.stale(id)) to.mark(i);
        }
        items_.clear();
    }
    /// Packs what waits in the tail once it is long for a search one by one; a search for pairs does so in any case.
    void shorten_tail(const table& all, kind& k) {
        if (k.tail.size() > 64 + k.young.live()) pack_young(all, k);
    }
    void pack_young(const table& all, kind& k) {
        gather(all, k.young);
        pack(all, k, k.young, young_place);
    }
    void pack_all(const table& all, kind& k) {
        gather(all, k.main);
        gather(all, k.young);
        k.young.clear();
        pack(all, k, k.main, 0);
        k.size = k.packed_size = k.main.size();
    }
    /// Moves the origin to where the movable proxies are, once that is far away for a float.
    void follow(const table& all) {
        if constexpr (!std::is_same_v<S, float>) {
            if (kinds_[1].main.live() == 0) return;
            const float_box<D> box = kinds_[1].main.around();
            float far = 0, wide = 0;
            for (int i = 0; i < D; ++i) {
                const float middle = box.lower[i] * 0.5f + box.upper[i] * 0.5f, size = box.upper[i] - box.lower[i];
                far = middle > far ? middle : -middle > far ? -middle : far;
                wide = size > wide ? size : wide;
            }
            if (!(far > 8 * wide)) return;
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(box.lower[i] * 0.5f + box.upper[i] * 0.5f));
            for (kind& k : kinds_) pack_all(all, k);
        }
    }

    /// The pairs of a marked box of x with a box of y; where y's is marked as well, from the side of the earlier leaf.
    template <class Emit>
    void find_pairs(const tree& x, const tree& y, order y_is, bool all_marked, Emit&& emit) {
        if (!x.any_marked()) return;
        for (std::uint32_t l = 0; l < x.leaves(); ++l) {
            const std::uint32_t moved = x.marked(l);
            if (moved == 0) continue;
            const float_box<D> reach = moved == 0xffu ? x.around(l) : x.around(l, moved);
            const auto& leaf = x.leaf(l);
            y.search(
                y_is == same && all_marked ? l : 0, [&](const auto& block) { return block.overlapping(reach); },
                [&](std::uint32_t m, std::uint32_t near) {
                    const auto& other = y.leaf(m);
                    const bool itself = y_is == same && m == l;
                    const std::uint32_t twice = y_is == after || (y_is == same && m > l) ? 0 : y.marked(m);
                    if (itself) {
                        each_bit(moved, [&](std::uint32_t i) {
                            const std::uint32_t earlier = (moved & ((1u << i) - 1)) | 1u << i;
                            each_bit(leaf.overlapping(leaf.get(i)) & ~earlier,
                                     [&](std::uint32_t k) { emit(x, l * 8 + i, x, l * 8 + k); });
                        });
                        return;
                    }
                    near &= ~twice;
                    if (near == 0) return;
                    const std::uint32_t mine = moved & leaf.overlapping(y.around(m));
                    each_bit(mine, [&](std::uint32_t i) {
                        each_bit(near & other.overlapping(leaf.get(i)),
                                 [&](std::uint32_t k) { emit(x, l * 8 + i, y, m * 8 + k); });
                    });
                });
        }
    }

    kind kinds_[2];
    /// By proxy: a place in the main tree, in the young one or in the tail of its kind.
    buffer<std::uint32_t> places_;
    typename Space::vec origin_{};
    buffer<std::uint64_t> keys_, spare_;
    buffer<packed_item> items_, spare_items_;
    buffer<std::uint32_t> touched_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/dynamic_tree.hpp
// =================================================================================================
// The default broadphase: trees of boxes.

PHYSICS_HPP_BEGIN

/// Trees of boxes without bounds: for every scene, whatever moves and however sizes differ. Nodes hold eight boxes in
/// float lanes, whatever the scalar. Movable proxies and the others have trees of their own. Boxes that move keep their
/// places; what strays from its neighbours is packed with others that did, and all is packed anew, by halving along
/// the longest side, once a tree has grown by a fifth. Resting proxies cost nothing, and neither the order of insertion
/// nor teleports make a tree worse for long.
/// Cost of a step: 50 to 250 ns for each proxy that left its box, 200 to 400 ns for all where a tree is packed anew.
/// Queries: O(log n + found).
/// Source: Kay, Kajiya, Ray tracing complex scenes (1986); Wald, Benthin, Boulos, Getting rid of packets (2008).
struct dynamic_tree {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::tree_index<Space>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/grid.hpp
// =================================================================================================
// A dense grid of cells.

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells in an array: as many as fill the region.
template <int D>
class dense_cells {
public:
    void arrange(cell_level<D>* levels, std::uint32_t count, std::uint32_t, const float_box<D>& region,
                 const std::uint32_t* population) {
        std::uint32_t total = 0;
        for (std::uint32_t l = 0; l < count; ++l) {
            cell_level<D>& level = levels[l];
            const auto dimension = [&](int i, float cell) {
                const double wide = static_cast<double>(region.upper[i]) - static_cast<double>(region.lower[i]);
                const double cells = wide / static_cast<double>(cell);
                return cells < 1e6 ? static_cast<double>(static_cast<std::uint32_t>(cells)) + 1 : 1e6;
            };
            const auto number = [&](float cell) {
                double product = 1;
                for (int i = 0; i < D; ++i) product *= dimension(i, cell);
                return product;
            };
            float cell = l + 1 < count ? level.side : std::numeric_limits<float>::max();
            const double most = population[l] / 4 + 1;
            while (number(cell) > most) cell *= 1.1f;
            level.set_cell(cell);
            level.base = total;
            std::uint32_t stride = 1;
            for (int i = 0; i < D; ++i) {
                level.low[i] = region.lower[i];
                level.most[i] = static_cast<float>(dimension(i, cell) - 1);
                level.stride[i] = stride;
                stride *= static_cast<std::uint32_t>(dimension(i, cell));
            }
            total += stride;
        }
        heads_.clear();
        heads_.resize(total, no_block);
    }
    bool adapt(const cell_level<D>*, std::uint32_t) { return false; }
    [[nodiscard]] std::uint32_t head(std::uint64_t key) const { return heads_[static_cast<std::uint32_t>(key)]; }
    std::uint32_t& at(std::uint64_t key) { return heads_[static_cast<std::uint32_t>(key)]; }

private:
    buffer<std::uint32_t> heads_;
};

}  // namespace detail

/// A dense grid: an array of cells over the region where things are. For worlds that are filled about evenly: there it
/// is as fast as dynamic_tree, within a tenth or so either way, and takes less memory. A move within a cell is one
/// write, and one into another cell costs the same wherever that is.
/// It measures by itself how large boxes are, how many and where, and arranges its cells anew when that has changed
/// much; each box is in cells of about its size, so that sizes may differ. The region is no wall: what lies outside
/// (the ends of the world, a few strays) is in the cells at the border and found like the rest; many there make each
/// other slow until the region follows them.
/// Choose another where things are in clusters far apart, or sizes differ a hundredfold (dynamic_tree takes half the
/// time): all cells of a level are of one size, so that clusters fill but few.
/// Cost of a step, for each proxy that left its box: 70 to 110 ns in 2D, 150 to 350 ns in 3D; resting ones cost
/// nothing. Arranging cells anew: 100 to 200 ns a proxy, in one step. Queries: O(cells in reach +
/// found); each_inside looks at all.
/// Source: Ericson, Real-time collision detection (2005), 7.1 and 7.2.
struct grid {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::cell_index<Space, detail::dense_cells<Space::dimension>>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/hash_grid.hpp
// =================================================================================================
// A grid without bounds, of which only cells with something in them exist.

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells in a hash table with open addressing. Nothing walks through the table in its order.
template <int D>
class hashed_cells {
public:
    void arrange(cell_level<D>* levels, std::uint32_t count, std::uint32_t usual,
                 const float_box<D>& region, const std::uint32_t*) {
        // Cells of small ones not much smaller than of most: large ones look through them.
        for (std::uint32_t l = stretch_.size(); l < count; ++l)
            stretch_.push(l + 1 < usual ? static_cast<float>(1 << 2 * (usual - l - 1)) : 1.0f);
        for (std::uint32_t l = 0; l < count; ++l) {
            cell_level<D>& level = levels[l];
            const bool endless = l + 1 == count;
            level.set_cell(endless ? std::numeric_limits<float>::max() : level.side * stretch_[l]);
            level.base = std::uint64_t{l} << 60;
            for (int i = 0; i < D; ++i) {
                // A million cells along each axis, what there is in their middle.
                const float middle = region.lower[i] * 0.5f + region.upper[i] * 0.5f;
                level.low[i] = endless ? 0 : middle - level.cell * (1 << (bits - 1));
                level.most[i] = endless ? 0.0f : static_cast<float>((1 << bits) - 1);
                level.stride[i] = std::uint64_t{1} << i * bits;
            }
        }
        entries_.clear();
        used_ = 0;
    }
    /// Wider cells, where most would have but one or two boxes.
    bool adapt(const cell_level<D>* levels, std::uint32_t count) {
        bool better = false;
        for (std::uint32_t l = 0; l + 1 < count; ++l) {
            if (levels[l].count < 64) continue;
            const bool sparse = levels[l].count < 3 * levels[l].cells && stretch_[l] < 256;
            const bool dense = levels[l].count > 32 * levels[l].cells && stretch_[l] > 1.01f;
            if (sparse || dense) stretch_[l] *= sparse ? 1.5f : 1 / 1.5f;
            better = better || sparse || dense;
        }
        return better;
    }
    [[nodiscard]] std::uint32_t head(std::uint64_t key) const {
        if (entries_.empty()) return no_block;
        for (std::uint32_t i = first(key);; i = i + 1 == entries_.size() ? 0 : i + 1)
            if (entries_[i].key == key || entries_[i].key == no_key) return entries_[i].head;
    }
    std::uint32_t& at(std::uint64_t key) {
        if (2 * (used_ + 1) > entries_.size()) grow();
        std::uint32_t i = first(key);
        while (entries_[i].key != key && entries_[i].key != no_key) i = i + 1 == entries_.size() ? 0 : i + 1;
        if (entries_[i].key == no_key) ++used_;
        entries_[i].key = key;
        return entries_[i].head;
    }

private:
    static constexpr int bits = 20;
    static constexpr std::uint64_t no_key = ~std::uint64_t{0};
    struct entry {
        std::uint64_t key;
        std::uint32_t head;
    };

    [[nodiscard]] std::uint32_t first(std::uint64_t key) const {
        const std::uint64_t mixed = (key ^ key >> 29) * 0x9e3779b97f4a7c15u;
        return static_cast<std::uint32_t>(mixed >> 32) & (entries_.size() - 1);
    }
    /// Makes room; entries of cells that are empty by now go.
    void grow() {
        std::uint32_t live = 0;
        for (const entry& e : entries_) live += e.head != no_block;
        std::uint32_t size = 64;
        while (size < 4 * (live + 1)) size *= 2;
        spare_.clear();
        spare_.resize(size, entry{no_key, no_block});
        entries_.swap(spare_);
        used_ = 0;
        for (const entry& e : spare_)
            if (e.head != no_block) at(e.key) = e.head;
    }

    buffer<entry> entries_, spare_;
    /// By level, how much wider a cell is than its boxes may be.
    buffer<float> stretch_;
    reset_on_move<std::uint32_t> used_;
};

}  // namespace detail

/// A hashed grid: the cells of grid, without its region. Only cells with something in them exist, found by a hash of
/// their coordinates, a million along each axis about where most things are; beyond, those at the border serve. For
/// open worlds in which things are scattered unevenly over a large area, and come and go everywhere: its memory and
/// time depend on them alone.
/// Choose grid where the world is filled evenly, which spares a tenth to a quarter, and dynamic_tree where sizes
/// differ tenfold and more or queries matter: each size of cells in use adds to every search.
/// Cost of a step, for each proxy that left its box: 80 to 120 ns in 2D, 200 to 400 ns in 3D; resting ones cost
/// nothing. Arranging cells anew: 100 to 300 ns a proxy, in one step. Queries:
/// O(cells in reach + found), but never much worse than a look at all boxes; each_inside looks at all.
/// Source: Teschner, Heidelberger, Mueller, Pomeranets, Gross, Optimized spatial hashing for collision detection of
/// deformable objects (2003); levels: Ericson, Real-time collision detection (2005), 7.2.1.
struct hash_grid {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::cell_index<Space, detail::hashed_cells<Space::dimension>>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/broadphase/sweep_and_prune.hpp
// =================================================================================================
// Sweep and prune: boxes in order along one axis.

PHYSICS_HPP_BEGIN

namespace detail {

/// Movable proxies and the others in an order each. What has just come waits in a tail, searched one by one, until
/// the next update.
template <class Space>
class sweep_index : public block_scan<sweep_index<Space>, Space> {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using box = float_box<D>;
    using order = axis_order<D>;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        kind& k = kinds_[all.is_movable(id)];
        places_[id] = tail_place | k.tail.size();
        k.tail.push(id);
        if (k.tail.size() > 64 + k.order.live() / 4) sort(all, k);
    }
    void erase(const table& all, std::uint32_t id) {
        kind& k = kinds_[all.is_movable(id)];
        const std::uint32_t slot = places_[id] & ~tail_place;
        if (places_[id] == slot) {
            k.order.remove(slot);
        } else {
            k.tail[slot] = k.tail.back();
            places_[k.tail[slot]] = tail_place | slot;
            k.tail.pop();
        }
    }
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (int m = 0; m < 2; ++m) {
            kind& k = kinds_[m];
            const auto ours = [&](std::uint32_t id) { return all.has(id) && all.is_movable(id) == (m == 1); };
            std::uint32_t moves = k.tail.size();
            for (std::uint32_t i = 0; i < count; ++i) moves += ours(ids[i]);
            bool sorted = moves < k.too_many && k.order.live() + k.order.live() / 4 + 64 > k.order.size() &&
                          k.since_sorted < 32 * (std::uint64_t{k.order.live()} + 64);
            k.since_sorted += moves;
            // So much work in small steps costs as much as to sort everything.
            std::uint32_t left = 4 * k.order.size() + 64;
            const auto spend = [&](std::uint32_t steps) {
                left = left > steps + 1 ? left - steps - 1 : 0;
                if (left == 0) k.too_many = moves;
                return left > 0;
            };
            while (!k.tail.empty() && (sorted = sorted && k.order.has_room())) {
                const std::uint32_t id = k.tail.back();
                k.tail.pop();
                sorted = spend(k.order.insert(id, box_of(all, id), left, at()));
            }
            for (std::uint32_t i = 0; i < count && sorted; ++i)
                if (ours(ids[i])) sorted = spend(k.order.move(places_[ids[i]], box_of(all, ids[i]), left, at()));
            // Now and then it is worth another try.
            if (!sorted && k.too_many < 1u << 30) k.too_many += k.too_many / 16 + 1;
            if (sorted) k.order.settle();
            else if (moves > 0 || k.order.size() > 0) sort(all, k);
        }
    }

    /// See tree_index: the pairs of which one at least has moved.
    template <class Emit>
    bool find(const table& all, Emit&& emit) {
        std::uint32_t moved[2] = {0, 0};
        for (kind& k : kinds_) {
            // Some are left where the caller threw out of the last search.
            if (searching_) k.moved.clear();
            k.moved.resize(k.order.blocks());
        }
        searching_ = true;
        for (const std::uint32_t id : all.changed()) {
            if (!all.has(id)) continue;
            mark(all, id, true);
            ++moved[all.is_movable(id)];
        }
        kind &fixed = kinds_[0], &movable = kinds_[1];
        const bool everything = moved[1] == movable.order.live();
        std::uint32_t guess = 0;
        if (moved[1] > 0)
            each_moved(movable, [&](std::uint32_t slot) {
                const box own = movable.order[slot / 8].get(slot % 8);
                const auto meet = [&](const order& other, std::uint32_t b, std::uint32_t lanes) {
                    each_bit(lanes, [&](std::uint32_t lane) { emit(movable.order.id(slot), other.id(b * 8 + lane)); });
                };
                movable.order.sweep(slot, own,
                                    [&](std::uint32_t b, std::uint32_t lanes) { meet(movable.order, b, lanes); });
                // Those before it that have moved have swept over it.
                if (!everything)
                    movable.order.search(own, slot / 8 + 1, [&](std::uint32_t b) {
                        std::uint32_t wanted = ~std::uint32_t{movable.moved[b]} & 0xffu;
                        if (b == slot / 8) wanted &= (1u << slot % 8) - 1;
                        if (wanted != 0) meet(movable.order, b, wanted & movable.order[b].overlapping(own));
                        return true;
                    });
                guess = fixed.order.begun(own.upper[fixed.order.axis()], guess);
                fixed.order.search(own, guess, [&](std::uint32_t b) {
                    meet(fixed.order, b, fixed.order[b].overlapping(own));
                    return true;
                });
            });
        if (moved[0] > 0)
            each_moved(fixed, [&](std::uint32_t slot) {
                const box own = fixed.order[slot / 8].get(slot % 8);
                guess = movable.order.begun(own.upper[movable.order.axis()], guess);
                movable.order.search(own, guess, [&](std::uint32_t b) {
                    each_bit(movable.order[b].overlapping(own) & ~std::uint32_t{movable.moved[b]},
                             [&](std::uint32_t lane) { emit(fixed.order.id(slot), movable.order.id(b * 8 + lane)); });
                    return true;
                });
            });
        for (const std::uint32_t id : all.changed())
            if (all.has(id)) mark(all, id, false);
        searching_ = false;
        return everything;
    }

    template <class Visit>
    void each_near(const table&, const typename Space::aabb& near, Visit&& visit) const {
        const box reach = enclosing(near, origin_);
        bool on = true;
        each_loose([&](std::uint32_t id) { on = on && visit(id); });
        each_eight(reach, [&](const auto& block, auto&& id_of) {
            each_bit(on ? block.overlapping(reach) : 0, [&](std::uint32_t lane) { on = on && visit(id_of(lane)); });
            return on;
        });
    }
    template <class Visit>
    void each_along(const table&, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> way(r, origin_);
        float reach = above(limit) + way.step, near[8];
        const auto see = [&](std::uint32_t id) { reach = above(visit(id)) + way.step; };
        each_loose(see);
        box near_way;
        for (int i = 0; i < D; ++i) {
            const double from = static_cast<double>(r.origin[i]) - static_cast<double>(origin_[i]);
            const double to = from + static_cast<double>(r.translation[i]);
            const double low = from < to ? from : to, high = from < to ? to : from;
            // The exact test may round a fraction, and take what is a little beside the way.
            const double room = (high - low) * static_cast<double>(way.step) + static_cast<double>(r.extent[i]) +
                                ((low < 0 ? -low : low) + (high < 0 ? -high : high)) * 1e-6;
            near_way.lower[i] = to_float(low - room);
            near_way.upper[i] = to_float(high + room);
        }
        each_eight(near_way, [&](const auto& block, auto&& id_of) {
            each_bit(way.meets(block, reach, near), [&](std::uint32_t lane) { see(id_of(lane)); });
            return !(reach < 0);
        });
    }

    // For block_scan.
    template <class F>
    void each_eight(F&& f) const {
        for (const kind& k : kinds_)
            for (std::uint32_t b = 0; b < k.order.blocks(); ++b)
                if (!f(k.order[b], [&](std::uint32_t lane) { return k.order.id(b * 8 + lane); })) return;
    }
    template <class F>
    void each_eight(const box& near, F&& f) const {
        for (const kind& k : kinds_)
            k.order.search(near, k.order.begun(near.upper[k.order.axis()], 0), [&](std::uint32_t b) {
                return f(k.order[b], [&](std::uint32_t lane) { return k.order.id(b * 8 + lane); });
            });
    }
    [[nodiscard]] float usual_size() const { return kinds_[1].order.usual_size(); }
    template <class F>
    void each_loose(F&& f) const {
        for (const kind& k : kinds_)
            for (const std::uint32_t id : k.tail) f(id);
    }
    [[nodiscard]] const typename Space::vec& origin() const { return origin_; }

private:
    static constexpr std::uint32_t tail_place = 1u << 31;

    struct kind {
        detail::axis_order<D> order;
        buffer<std::uint32_t> tail;
        /// By block, a bit for each box that has moved; all 0 but while pairs are searched.
        buffer<std::uint8_t> moved;
        /// So many moves at once have been too many for small steps.
        std::uint32_t too_many = 1u << 31;
        /// Moves in small steps: after many, another axis may be better.
        std::uint64_t since_sorted = 0;
    };

    box box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }
    auto at() {
        return [&](std::uint32_t id, std::uint32_t slot) { places_[id] = slot; };
    }
    void sort(const table& all, kind& k) {
        for (const std::uint32_t id : k.tail) k.order.add(id);
        k.tail.clear();
        k.since_sorted = 0;
        k.order.sort([&](std::uint32_t id) { return box_of(all, id); }, at());
        if (&k == &kinds_[1]) follow(all);
    }
    /// Moves the origin to where the movable proxies are, once that is far away for a float.
    void follow(const table& all) {
        if constexpr (!std::is_same_v<S, float>) {
            const order& movable = kinds_[1].order;
            if (movable.live() == 0) return;
            bool far = false;
            for (int i = 0; i < D; ++i) {
                const float middle = movable.middle(i);
                far = far || max(middle, -middle) > 64 * max(movable.usual_size(), movable.width());
            }
            if (!far) return;
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(movable.middle(i)));
            for (kind& k : kinds_) k.order.sort([&](std::uint32_t id) { return box_of(all, id); }, at());
        }
    }
    void mark(const table& all, std::uint32_t id, bool value) {
        std::uint8_t& bits = kinds_[all.is_movable(id)].moved[places_[id] / 8];
        bits = static_cast<std::uint8_t>(value ? bits | 1u << places_[id] % 8 : 0u);
    }
    template <class F>
    static void each_moved(const kind& k, F&& f) {
        for (std::uint32_t b = 0; b < k.moved.size(); ++b)
            each_bit(k.moved[b], [&](std::uint32_t lane) { f(b * 8 + lane); });
    }

    kind kinds_[2];
    /// By proxy: its slot in the order of its kind, or in the tail.
    buffer<std::uint32_t> places_;
    typename Space::vec origin_{};
    bool searching_ = false;
};

}  // namespace detail

/// Boxes in order along the axis on which they are spread widest, swept eight at a time in float lanes: for worlds
/// that are long and narrow, such as side-scrollers, roads and corridors: there it takes up to a sixth less time than
/// dynamic_tree, above all where few move. What moves a little stays near its place in the
/// order (insertion sort), what jumps costs no more than sorting everything (radix sort). Movable proxies and the
/// others have orders of their own; resting ones cost nothing.
/// Choose another where a world of thousands is as wide as it is long: what is passed over in a sweep grows with the
/// root of their number, in a cube with its power of 2/3.
/// Cost of a step, for each proxy that left its box: in a corridor 80 to 150 ns, however long; in a square of 10,000
/// or 100,000 100 or 200 ns, in a cube 0.4 or 1.7 us (dynamic_tree: 80 or 100 ns, 0.2 or 0.3 us). What comes costs up
/// to 3 ns a proxy in the world. Rays and boxes: all boxes beside them along the axis, 3 to 10 times a tree's;
/// each_inside looks at all.
/// Source: Baraff, Dynamic simulation of non-penetrating rigid bodies (1992); Cohen, Lin, Manocha, Ponamgi, I-COLLIDE
/// (1995); Ericson, Real-time collision detection (2005), 7.5.
struct sweep_and_prune {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::sweep_index<Space>>;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/dynamics/body.hpp
// =================================================================================================
// The state of a body.

PHYSICS_HPP_BEGIN

/// How a body moves.
enum class body_type : std::uint8_t {
    /// Never moves; infinite mass.
    static_body,
    /// Moves as told, by velocities or poses; pushes dynamic bodies and is not pushed.
    kinematic_body,
    /// Moved by forces, impulses and contacts.
    dynamic_body,
};

/// Everything that a world keeps of one body.
template <class S, int D>
struct body {
    // Moves every step. The centre of mass is the integrated position; the body's origin follows from it.
    vec<S, D> center;
    physics::rotation<S, D> rotation;
    twist<S, D> velocity;
    vec<S, D> force;
    angular<S, D> torque{};

    // Changes when shapes, masses or settings do.
    mass_properties<S, D> mass;
    inverse_of<S> inverse_mass{};
    physics::inverse_inertia<S, D> inverse_inertia{};
    S linear_damping{};
    S angular_damping{};
    S gravity_scale = S(1);
    transform<S, D> target;
    std::uint64_t user_data = 0;
    std::uint32_t first_shape = 0xffffffffu;
    body_type type = body_type::dynamic_body;
    bool rotation_locked = false;
    /// True if the inertia depends on the axis: then the spin changes even without torque.
    bool is_gyroscopic = false;
    bool mass_is_set = false;
    bool has_target = false;

    /// The pose of the body's own frame, in which its shapes lie.
    [[nodiscard]] constexpr transform<S, D> pose() const { return {center - rotation * mass.center, rotation}; }
    constexpr void set_pose(const transform<S, D>& pose) {
        rotation = pose.rotation;
        center = pose * mass.center;
    }
    [[nodiscard]] constexpr bool is_dynamic() const { return type == body_type::dynamic_body; }
};

/// What a solver sees of a body: velocity and how it answers to impulses. Bodies that nothing pushes have
/// the inverse mass 0.
template <class S, int D>
struct solver_body {
    twist<S, D> velocity;
    inverse_of<S> inverse_mass{};
    physics::inverse_inertia<S, D> inverse_inertia{};

    /// The impulse p (kg m/s) acts at lever r from the centre of mass.
    constexpr void apply(vec<S, D> p, vec<S, D> r) {
        for (int i = 0; i < D; ++i) velocity.linear[i] += mul<S>(inverse_mass, p[i]);
        velocity.angular += times(inverse_inertia, cross(r, p));
    }
};

PHYSICS_HPP_END

// =================================================================================================
// physics/dynamics/contact.hpp
// =================================================================================================
// Contacts: manifolds in the world, with what is remembered of them from step to step.

PHYSICS_HPP_BEGIN

/// How a shape's surface answers to contact.
template <class S>
struct material {
    /// Coulomb friction coefficient; two surfaces meet with the square root of their product.
    S friction = S(0.6);
    /// Share of the approach speed that a bounce gives back, 0 to 1; two surfaces meet with the larger one.
    S restitution = S(0);
};

/// Friction impulses along the tangents of a contact: one in the plane, two in space.
template <class S, int D>
using tangential = std::conditional_t<D == 2, S, vec<S, 2>>;

/// One point of a contact.
template <class S, int D>
struct contact_point {
    /// Lever from the centre of mass of either body to the point, in world axes (m).
    vec<S, D> lever_a;
    vec<S, D> lever_b;
    /// Distance of the surfaces along the normal (m); negative where they overlap.
    S separation{};
    /// Sum of the impulses of the last step along the normal, at least 0, and along the tangents (N s).
    S normal_impulse{};
    physics::tangential<S, D> friction_impulse{};
    std::uint32_t feature = 0;
    /// True if the same features touched in the step before.
    bool persisted = false;
};

/// Two shapes of different bodies that touch or are about to.
template <class S, int D>
struct contact {
    /// Numbers of the shapes and bodies; the normal points from A to B.
    std::uint32_t shape_a, shape_b;
    std::uint32_t body_a, body_b;
    /// Which part of a concave shape touches; 0 of convex ones.
    std::uint32_t part = 0;
    vec<S, D> normal;
    contact_point<S, D> points[manifold<S, D>::capacity];
    int count = 0;
    /// Of both surfaces together.
    S friction{};
    S restitution{};

    [[nodiscard]] constexpr proxy_pair key() const {
        return shape_a < shape_b ? proxy_pair{shape_a, shape_b} : proxy_pair{shape_b, shape_a};
    }
};

/// The tangent of a contact normal in the plane.
template <class S>
struct tangents2 {
    vec<S, 2> t;

    constexpr explicit tangents2(vec<S, 2> normal) : t(perpendicular(normal)) {}
    [[nodiscard]] constexpr S components(vec<S, 2> v) const { return dot(t, v); }
    [[nodiscard]] constexpr vec<S, 2> combine(S along) const { return t * along; }
};
/// The same in space.
template <class S>
struct tangents3 {
    vec<S, 3> t, u;

    constexpr explicit tangents3(vec<S, 3> normal) : t(perpendicular(normal)), u(cross(normal, t)) {}
    [[nodiscard]] constexpr vec<S, 2> components(vec<S, 3> v) const { return {dot(t, v), dot(u, v)}; }
    [[nodiscard]] constexpr vec<S, 3> combine(vec<S, 2> along) const { return t * along.x + u * along.y; }
};
/// The tangents of a contact normal in D dimensions.
template <class S, int D>
using tangents = std::conditional_t<D == 2, tangents2<S>, tangents3<S>>;

/// Hands the impulse of the same feature in an old contact to a point.
template <class S, int D>
void inherit_impulse(const contact<S, D>& old, const tangents<S, D>& frame, contact_point<S, D>& point) {
    for (int j = 0; j < old.count && !point.persisted; ++j) {
        if (old.points[j].feature != point.feature) continue;
        point.normal_impulse = old.points[j].normal_impulse;
        point.friction_impulse =
            frame.components(tangents<S, D>(old.normal).combine(old.points[j].friction_impulse));
        point.persisted = true;
    }
}

/// Hands the impulses of last step's contacts to the same features of this step's. Both lists are in
/// ascending order of their pairs, so one walk along both finds the matches: O(n), no hashing; a pair of several
/// contacts is searched whole. Points that are new start from zero: only what outlives a step is warm.
template <class S, int D>
void inherit_impulses(const buffer<contact<S, D>>& before, buffer<contact<S, D>>& now) {
    std::uint32_t i = 0;
    for (contact<S, D>& c : now) {
        while (i < before.size() && before[i].key() < c.key()) ++i;
        if (i == before.size()) return;
        const tangents<S, D> frame(c.normal);
        for (std::uint32_t n = i; n < before.size() && before[n].key() == c.key(); ++n)
            for (int k = 0; k < c.count; ++k) inherit_impulse(before[n], frame, c.points[k]);
    }
}

PHYSICS_HPP_END

// =================================================================================================
// physics/dynamics/friction.hpp
// =================================================================================================
// Coulomb friction at one point: an interval in the plane, a circular cone in space.

PHYSICS_HPP_BEGIN

namespace detail {

/// How much a unit impulse along n at lever r changes the velocity along m at the same point, by rotation
/// alone, in the inverse format.
template <class S>
constexpr inverse_of<S> angular_answer(inverse_of<S> inverse_inertia, vec<S, 2> r, vec<S, 2> n, vec<S, 2> m) {
    using I = inverse_of<S>;
    return mul<I>(mul<I>(inverse_inertia, cross(r, n)), cross(r, m));
}
template <class S>
constexpr inverse_of<S> angular_answer(const symmetric<inverse_of<S>>& inverse_inertia, vec<S, 3> r, vec<S, 3> n,
                                       vec<S, 3> m) {
    using I = inverse_of<S>;
    const vec<S, 3> a = cross(r, n), b = cross(r, m);
    const auto& k = inverse_inertia;
    const I x = narrow<I>(product(k.xx, a.x) + product(k.xy, a.y) + product(k.xz, a.z));
    const I y = narrow<I>(product(k.xy, a.x) + product(k.yy, a.y) + product(k.yz, a.z));
    const I z = narrow<I>(product(k.xz, a.x) + product(k.yz, a.y) + product(k.zz, a.z));
    return narrow<I>(product(x, b.x) + product(y, b.y) + product(z, b.z));
}

/// Both bodies' answer along m to a unit impulse along n at a contact point.
template <class S, int D>
constexpr inverse_of<S> answer(const solver_body<S, D>& a, const solver_body<S, D>& b, const contact_point<S, D>& p,
                               vec<S, D> n, vec<S, D> m) {
    return angular_answer<S>(a.inverse_inertia, p.lever_a, n, m) +
           angular_answer<S>(b.inverse_inertia, p.lever_b, n, m);
}

/// The effective mass along n: the impulse that changes the relative velocity along n by 1.
template <class S, int D>
constexpr S effective_mass(const solver_body<S, D>& a, const solver_body<S, D>& b, const contact_point<S, D>& p,
                           vec<S, D> n) {
    const inverse_of<S> k = a.inverse_mass + b.inverse_mass + answer(a, b, p, n, n);
    return k > inverse_of<S>(0) ? reciprocal<S>(k) : S(0);
}

}  // namespace detail

/// Friction of a point in the plane.
template <class S>
struct friction2 {
    S mass{};

    constexpr friction2() = default;
    constexpr friction2(const solver_body<S, 2>& a, const solver_body<S, 2>& b, const contact_point<S, 2>& p,
                        const tangents2<S>& frame)
        : mass(detail::effective_mass(a, b, p, frame.t)) {}

    /// The accumulated impulse that stops the slip v, or the largest that friction can give.
    [[nodiscard]] constexpr S next(S impulse, S v, S limit) const { return clamp(impulse - mass * v, -limit, limit); }
};

/// Friction of a point in space. Sticking is solved exactly, by the inverse of the 2 x 2 answer of both
/// tangents. Slipping takes a gradient step, scaled by the largest eigenvalue, onto the circular cone: its
/// fixed point opposes the slip in any direction, which per-tangent limits do not.
template <class S>
struct friction3 {
    S xx{}, xy{}, yy{};
    S slip{};

    constexpr friction3() = default;
    constexpr friction3(const solver_body<S, 3>& a, const solver_body<S, 3>& b, const contact_point<S, 3>& p,
                        const tangents3<S>& frame) {
        using I = inverse_of<S>;
        const I m = a.inverse_mass + b.inverse_mass;
        const I kxx = m + detail::answer(a, b, p, frame.t, frame.t);
        const I kyy = m + detail::answer(a, b, p, frame.u, frame.u);
        const I kxy = detail::answer(a, b, p, frame.t, frame.u);
        const auto determinant = product(kxx, kyy) - product(kxy, kxy);
        if (!(determinant > wide_of<I>{})) return;
        xx = quotient<S>(kyy, determinant);
        yy = quotient<S>(kxx, determinant);
        xy = -quotient<S>(kxy, determinant);
        const I half = mul<I>(kxx - kyy, S(0.5));
        slip = reciprocal<S>(mul<I>(kxx + kyy, S(0.5)) + root<I>(product(half, half) + product(kxy, kxy)));
    }

    [[nodiscard]] constexpr vec<S, 2> next(vec<S, 2> impulse, vec<S, 2> v, S limit) const {
        const vec<S, 2> stick =
            impulse - vec<S, 2>{sum_of_products(xx, v.x, xy, v.y), sum_of_products(xy, v.x, yy, v.y)};
        const wide_of<S> most = product(limit, limit);
        if (!(length_squared(stick) > most)) return stick;
        const vec<S, 2> slide = impulse - v * slip;
        if (!(length_squared(slide) > most)) return slide;
        return normalized(slide) * limit;
    }
};

/// Friction of a point in D dimensions.
template <class S, int D>
using point_friction = std::conditional_t<D == 2, friction2<S>, friction3<S>>;

PHYSICS_HPP_END

// =================================================================================================
// physics/dynamics/integrator.hpp
// =================================================================================================
// How velocities and poses advance by a step.

PHYSICS_HPP_BEGIN

namespace detail {

/// Turns a body on which no torque acts for a time h, by the midpoint rule on a constant angular momentum:
/// that is kept to rounding, whatever the spin; the energy errs with the third power of h.
template <class S>
constexpr void turn_freely(body<S, 3>& b, vec<S, 3>& angular_velocity, S h) {
    const rotation<S, 3> start = b.rotation;
    const vec<S, 3> momentum = start * times(b.mass.inertia, inverse_rotate(start, angular_velocity));
    const auto spin = [&](const rotation<S, 3>& r) {
        return r * times(b.inverse_inertia, inverse_rotate(r, momentum));
    };
    const rotation<S, 3> half_way = turned(start, angular_velocity * (h * S(0.5)));
    b.rotation = turned(start, spin(half_way) * h);
    angular_velocity = spin(b.rotation);
}
/// In the plane nothing precesses.
template <class S>
constexpr void turn_freely(body<S, 2>&, S, S) {}

}  // namespace detail

/// Semi-implicit (symplectic) Euler: velocities from forces first, then poses from the new velocities. Bodies
/// in space whose inertia depends on the axis keep their angular momentum as they turn (gyroscopic motion).
/// Error of order h, energy of an oscillator bounded while w h < 2; in free fall the position is short of
/// the exact one by g t h / 2. Damping is implicit, v / (1 + c h), and stays stable for any c h.
/// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2.
struct semi_implicit_euler {
    using stage = physics::stage::integrator;

    template <class Space>
    struct in {
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;

        /// Advances the velocity of a dynamic body by gravity (m/s^2), force, torque and damping.
        static constexpr void advance_velocity(solver_body<S, D>& v, const body<S, D>& b, vec<S, D> gravity, S h) {
            vec<S, D> acceleration = gravity * b.gravity_scale;
            for (int i = 0; i < D; ++i) acceleration[i] += mul<S>(v.inverse_mass, b.force[i]);
            v.velocity.linear = (v.velocity.linear + acceleration * h) * damped(b.linear_damping, h);
            v.velocity.angular =
                (v.velocity.angular + times(v.inverse_inertia, b.torque) * h) * damped(b.angular_damping, h);
        }
        /// Advances the pose of a body by its velocity, and the angular velocity of a free top with it.
        static constexpr void advance_pose(body<S, D>& b, twist<S, D>& v, S h) {
            b.center += v.linear * h;
            if (b.is_gyroscopic) detail::turn_freely(b, v.angular, h);
            else b.rotation = turned(b.rotation, v.angular * h);
        }

    private:
        static constexpr S damped(S damping, S h) {
            return damping == S(0) ? S(1) : S(1) / (S(1) + damping * h);
        }
    };
};

PHYSICS_HPP_END

// =================================================================================================
// physics/dynamics/sequential_impulse.hpp
// =================================================================================================
// The sequential impulse solver: one constraint at a time, impulses accumulated and clamped.

PHYSICS_HPP_BEGIN

/// Numbers of the sequential impulse solver; lengths in metres, speeds in m/s.
template <class S>
struct sequential_impulse_settings {
    /// Rounds over all contacts; more make tall stacks and heavy loads stiffer. At least 1.
    int iterations = 20;
    /// Share of an overlap that one step takes back (the factor beta of Baumgarte), 0 to 1.
    S baumgarte = S(0.2);
    /// Overlap that is left alone, so that resting contacts persist.
    S penetration_slop = S(0.005);
    /// Speed at which overlaps are pushed apart, at most.
    S max_push_speed = S(3);
    /// Approaches slower than this do not bounce.
    S restitution_slop = S(0.5);
};

template <class S>
bool check(const sequential_impulse_settings<S>& with, const char* function) {
    if (with.iterations < 1)
        return detail::refuse(function, "solver.iterations", with.iterations, "it must be at least 1");
    if (with.baumgarte > S(1))
        return detail::refuse(function, "solver.baumgarte", static_cast<double>(with.baumgarte),
                              "it must be at most 1");
    return detail::check_not_negative(function, "solver.baumgarte", with.baumgarte) &&
           detail::check_not_negative(function, "solver.penetration_slop", with.penetration_slop) &&
           detail::check_not_negative(function, "solver.max_push_speed", with.max_push_speed) &&
           detail::check_not_negative(function, "solver.restitution_slop", with.restitution_slop);
}

/// Sequential impulses (projected Gauss-Seidel on velocities): accumulated impulses clamped to what contact
/// can give, warm starting of points that outlive a step, Baumgarte's term with a penetration slop,
/// restitution with its slop, Coulomb friction on a circular cone. Error: of order h; stacks settle into
/// the slop, mass ratios beyond 1:10 need more iterations. Cost: iterations x points.
/// Source: Catto, Iterative Dynamics with Temporal Coherence (2005); Catto, Modeling and Solving
/// Constraints (2009); Baumgarte (1972).
struct sequential_impulse {
    using stage = physics::stage::solver;

    template <class Space, class Features>
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        using settings = sequential_impulse_settings<S>;

        /// Advances velocities and poses by h: `motion` offers advance_velocities(h) and advance_poses(h).
        template <class Motion>
        static void solve(solver_body<S, D>* bodies, buffer<contact<S, D>>& contacts, const settings& with, S h,
                          arena& scratch, Motion&& motion) {
            block* blocks = scratch.template take<block>(contacts.size());
            for (std::uint32_t i = 0; i < contacts.size(); ++i) new (blocks + i) block(contacts[i], bodies, with, h);
            motion.advance_velocities(h);
            for (std::uint32_t i = 0; i < contacts.size(); ++i) warm_start(contacts[i], blocks[i], bodies);
            // Forth and back in turns: loads and corrections travel as far one way as the other.
            for (int round = 0; round < with.iterations; ++round) {
                const bool back = round % 2 != 0;
                for (std::uint32_t i = 0; i < contacts.size(); ++i) {
                    const std::uint32_t at = back ? contacts.size() - 1 - i : i;
                    solve_contact(contacts[at], blocks[at], bodies, back);
                }
            }
            motion.advance_poses(h);
        }

    private:
        struct no_friction {
            constexpr no_friction() = default;
            constexpr no_friction(const solver_body<S, D>&, const solver_body<S, D>&, const contact_point<S, D>&,
                                  const tangents<S, D>&) {}
        };
        /// What one point needs while iterating; target_speed is the speed along the normal with which the
        /// surfaces must part, at least.
        struct row {
            [[no_unique_address]] std::conditional_t<Features::friction, point_friction<S, D>, no_friction> friction;
            S normal_mass;
            S target_speed;
        };
        struct block {
            tangents<S, D> frame;
            row rows[manifold<S, D>::capacity];

            block(const contact<S, D>& c, const solver_body<S, D>* bodies, const settings& with, S h)
                : frame(c.normal) {
                const solver_body<S, D>& a = bodies[c.body_a];
                const solver_body<S, D>& b = bodies[c.body_b];
                for (int k = 0; k < c.count; ++k) {
                    const contact_point<S, D>& p = c.points[k];
                    rows[k] = {
                        {a, b, p, frame}, detail::effective_mass(a, b, p, c.normal), target_speed(c, p, a, b, with, h)};
                }
            }
        };

        /// Apart, the surfaces may close the gap; overlapping, they part slowly; a bounce parts them with its
        /// share of the approach.
        static S target_speed(const contact<S, D>& c, const contact_point<S, D>& p, const solver_body<S, D>& a,
                              const solver_body<S, D>& b, const settings& with, S h) {
            S target = -p.separation / h;
            if (p.separation < S(0)) {
                const S overlap = max(-p.separation - with.penetration_slop, S(0));
                target = min(overlap * with.baumgarte / h, with.max_push_speed);
            }
            if constexpr (Features::restitution) {
                // A bounce starts where the gap is: the speed that closes it first would be lost.
                if (!(c.restitution > S(0))) return target;
                const S speed = dot(c.normal, velocity_at(b.velocity, p.lever_b) - velocity_at(a.velocity, p.lever_a));
                const bool meets = p.separation + speed * h < S(0);
                if (meets && -speed > with.restitution_slop) target = max(target, -(c.restitution * speed));
            }
            return target;
        }

        static void warm_start(const contact<S, D>& c, const block& with, solver_body<S, D>* bodies) {
            for (int k = 0; k < c.count; ++k) {
                const contact_point<S, D>& p = c.points[k];
                if (!p.persisted) continue;
                vec<S, D> impulse = c.normal * p.normal_impulse;
                if constexpr (Features::friction) impulse += with.frame.combine(p.friction_impulse);
                bodies[c.body_a].apply(-impulse, p.lever_a);
                bodies[c.body_b].apply(impulse, p.lever_b);
            }
        }

        static void solve_contact(contact<S, D>& c, const block& with, solver_body<S, D>* bodies, bool back) {
            solver_body<S, D>& a = bodies[c.body_a];
            solver_body<S, D>& b = bodies[c.body_b];
            if constexpr (Features::friction) {
                const auto& frame = with.frame;
                for (int i = 0; i < c.count; ++i) {
                    const int k = back ? c.count - 1 - i : i;
                    contact_point<S, D>& p = c.points[k];
                    const vec<S, D> v = velocity_at(b.velocity, p.lever_b) - velocity_at(a.velocity, p.lever_a);
                    const auto impulse = with.rows[k].friction.next(p.friction_impulse, frame.components(v),
                                                                    c.friction * p.normal_impulse);
                    const vec<S, D> change = frame.combine(impulse - p.friction_impulse);
                    p.friction_impulse = impulse;
                    a.apply(-change, p.lever_a);
                    b.apply(change, p.lever_b);
                }
            }
            // Normals last: not sinking in matters more than not sliding. Across and back, because the points of
            // one contact depend on each other the most: what they leave open lets a stack sway.
            const int visits = 2 * c.count - 1;
            for (int i = 0; i < visits; ++i) {
                const int across = i < c.count ? i : visits - 1 - i;
                const int k = back ? c.count - 1 - across : across;
                contact_point<S, D>& p = c.points[k];
                const vec<S, D> v = velocity_at(b.velocity, p.lever_b) - velocity_at(a.velocity, p.lever_a);
                const S impulse = max(
                    p.normal_impulse + with.rows[k].normal_mass * (with.rows[k].target_speed - dot(c.normal, v)), S(0));
                const vec<S, D> change = c.normal * (impulse - p.normal_impulse);
                p.normal_impulse = impulse;
                a.apply(-change, p.lever_a);
                b.apply(change, p.lever_b);
            }
        }
    };
};

PHYSICS_HPP_END

// =================================================================================================
// physics/world/settings.hpp
// =================================================================================================
// Plain structs that users fill in: of a world, a body, a shape.

PHYSICS_HPP_BEGIN

/// Numbers of a world. Lengths in metres, times in seconds, masses in kilograms; a world in other units
/// scales the lengths and speeds here with them.
template <class S, int D, class SolverSettings>
struct world_settings {
    /// Acceleration of every body, times its gravity scale (m/s^2).
    vec<S, D> gravity = downward();
    /// Surfaces closer than this are contacts already, so that the solver can stop them at the surface (m).
    S contact_margin = S(0.02);
    /// Margins of the boxes in the broadphase.
    broadphase_settings<S> broadphase = {};
    /// Numbers of the solver that the recipe names.
    SolverSettings solver = {};

private:
    static constexpr vec<S, D> downward() {
        vec<S, D> g;
        g.y = S(-9.81);
        return g;
    }
};

/// A body to be.
template <class S, int D>
struct body_def {
    body_type type = body_type::dynamic_body;
    /// Where the origin of the body's frame is (m), and how the frame is turned.
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
    /// Velocity of the centre of mass (m/s) and angular velocity (rad/s).
    vec<S, D> linear_velocity = {};
    physics::angular<S, D> angular_velocity = {};
    /// Rates at which velocities decay without force (1/s), at least 0.
    S linear_damping = S(0);
    S angular_damping = S(0);
    /// Factor of the world's gravity for this body.
    S gravity_scale = S(1);
    /// True if nothing turns the body.
    bool rotation_locked = false;
    /// Anything of the user's; the library never looks at it.
    std::uint64_t user_data = 0;
};

/// How a shape sits on its body, and what it is made of.
template <class S, int D>
struct shape_def {
    /// Pose of the shape's frame in the body's frame.
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
    /// kg/m^3 in space, kg/m^2 in the plane; at least 0. Only ratios matter until forces act.
    S density = S(1);
    physics::material<S> material = {};
    std::uint64_t user_data = 0;
};

/// Tells handles of bodies from others.
struct body_tag;
/// Tells handles of shapes from others.
struct shape_tag;
/// Names a body of a world.
using body_id = handle<body_tag>;
/// Names a shape of a world.
using shape_id = handle<shape_tag>;

/// One contact as it is reported: both sides, and up to 2 (plane) or 4 (space) points.
template <class S, int D>
struct contact_view {
    struct point {
        /// Halfway between the surfaces at the step's start, carried along with body A since (m).
        vec<S, D> position;
        /// The same point in the frames of both bodies, in which it stays.
        vec<S, D> local_a, local_b;
        /// Distance of the surfaces at the step's start (m); negative is the depth of their overlap.
        S separation;
        /// Sums of the last step's impulses (N s): along the normal, and along the tangents.
        S normal_impulse;
        physics::tangential<S, D> friction_impulse;
        /// True if the point had been in contact in the step before.
        bool persisted;
    };

    shape_id shape_a, shape_b;
    body_id body_a, body_b;
    /// Which part of a concave shape touches: the number of a triangle, segment or child; 0 of convex shapes.
    std::uint32_t part;
    /// Unit normal from A to B, and unit tangents (one in the plane, two in space), in world axes.
    vec<S, D> normal;
    physics::tangents<S, D> tangents;
    point points[manifold<S, D>::capacity];
    int count;
    /// Coefficients of the two surfaces together.
    S friction, restitution;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/world/recipe.hpp
// =================================================================================================
// Recipes: which types make up a world.

PHYSICS_HPP_BEGIN

namespace detail {
template <class... Policies>
struct policy_list {};
}  // namespace detail

/// What a world is made of: a scalar, a dimension (2 or 3) and policies in any order. Derive a struct from
/// it, so that the world has a short name:
///
///     struct crates : physics::recipe<float, 2> {};
///     struct lockstep : physics::recipe<physics::fixed32, 3, physics::shapes<physics::sphere, physics::box>> {};
///     physics::world<lockstep> arena;
///
/// A policy is a type that names its stage (`using stage = physics::stage::solver`) and rebinds itself to
/// the recipe's space, so changing the scalar changes everything. Stages without a policy get the default.
template <class Scalar, int Dimension, class... Policies>
struct recipe {
    using scalar = Scalar;
    static constexpr int dimension = Dimension;
    using policies = detail::policy_list<Policies...>;
};

/// The shapes that a world knows, of those in shape/ or your own. Default: ball (or circle, sphere), capsule, box,
/// halfspace. A world's shapes are as large as the largest of the set, and each kind adds code for its pairs.
template <template <class, int> class... Shapes>
struct shapes {
    using stage = physics::stage::shapes;
};

/// Features that a recipe can leave out; what is left out costs nothing.
namespace feature {
/// Coulomb friction of contacts.
struct friction {};
/// Bouncing.
struct restitution {};
}  // namespace feature

/// Leaves features out: without<feature::friction, feature::restitution>.
template <class... Features>
struct without {
    using stage = physics::stage::features;
    static constexpr bool friction = !(std::same_as<Features, feature::friction> || ...);
    static constexpr bool restitution = !(std::same_as<Features, feature::restitution> || ...);
    static constexpr bool known =
        ((std::same_as<Features, feature::friction> || std::same_as<Features, feature::restitution>)&&...);
};

namespace detail {

/// The stage of a policy; void for a type that names none.
template <class Policy>
struct stage_of {
    using type = void;
};
template <class Policy>
    requires requires { typename Policy::stage; }
struct stage_of<Policy> {
    using type = typename Policy::stage;
};

/// The first policy of a list that serves a stage, or the default.
template <class Stage, class Default, class... Policies>
struct policy_for {
    using type = Default;
};
template <class Stage, class Default, class First, class... Rest>
struct policy_for<Stage, Default, First, Rest...> {
    using type = typename std::conditional_t<std::same_as<typename stage_of<First>::type, Stage>,
                                             policy_for<Stage, First>, policy_for<Stage, Default, Rest...>>::type;
};

/// The names of shapes inside a world: physics::world<recipe>::box.
template <class S, int D>
struct shape_names {
    using ball = physics::ball<S, D>;
    using capsule = physics::capsule<S, D>;
    using box = physics::box<S, D>;
    using halfspace = physics::halfspace<S, D>;
    using segment = physics::segment<S, D>;
    using triangle = physics::triangle<S, D>;
    using rounded_box = physics::rounded_box<S, D>;
    using hull = physics::hull<S, D>;
    using hull_geometry = physics::hull_geometry<S, D>;
    using heightfield = physics::heightfield<S, D>;
    using heightfield_geometry = physics::heightfield_geometry<S, D>;
    using compound = physics::compound<S, D>;
    using compound_child = physics::compound_child<S, D>;
    using compound_geometry = physics::compound_geometry<S, D>;
};
template <class S, int D>
struct shape_aliases;
template <class S>
struct shape_aliases<S, 2> : shape_names<S, 2> {
    using circle = physics::ball<S, 2>;
    using chain = physics::chain<S, 2>;
    using chain_geometry = physics::chain_geometry<S, 2>;
    using tile_grid = physics::tile_grid<S, 2>;
    using tile_grid_geometry = physics::tile_grid_geometry<S, 2>;
};
template <class S>
struct shape_aliases<S, 3> : shape_names<S, 3> {
    using sphere = physics::ball<S, 3>;
    using cylinder = physics::cylinder<S, 3>;
    using cone = physics::cone<S, 3>;
    using mesh = physics::mesh<S, 3>;
    using mesh_geometry = physics::mesh_geometry<S, 3>;
};

/// What a narrowphase remembers of a pair, if anything.
template <class Narrowphase>
struct memory_of {
    struct type {};
};
template <class Narrowphase>
    requires requires { typename Narrowphase::memory; }
struct memory_of<Narrowphase> {
    using type = typename Narrowphase::memory;
};

/// A recipe's choices, resolved: every stage with its type in the recipe's space.
template <class S, int D, class ShapeSet, class... Policies>
struct plan;
template <class S, int D, template <class, int> class... Shapes, class... Policies>
struct plan<S, D, shapes<Shapes...>, Policies...> {
    using scalar = S;
    static constexpr int dimension = D;
    using space = physics::space<S, D>;
    using features = typename policy_for<stage::features, without<>, Policies...>::type;
    using shape = any_shape<S, D, Shapes...>;
    using query = narrowphase_query<S, D, Shapes...>;
    using broadphase = typename policy_for<stage::broadphase, dynamic_tree, Policies...>::type::template in<space>;
    using narrowphase =
        typename policy_for<stage::narrowphase, best_per_pair, Policies...>::type::template in<S, D, Shapes...>;
    static constexpr bool remembers = requires { typename narrowphase::memory; };
    using pair_memory = typename memory_of<narrowphase>::type;
    using integrator =
        typename policy_for<stage::integrator, semi_implicit_euler, Policies...>::type::template in<space>;
    using solver =
        typename policy_for<stage::solver, sequential_impulse, Policies...>::type::template in<space, features>;
    using settings = world_settings<S, D, typename solver::settings>;
};

template <class... Policies>
using shape_set_for = typename policy_for<stage::shapes, shapes<ball, capsule, box, halfspace>, Policies...>::type;

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/audit.hpp
// =================================================================================================
// Every way to misuse a recipe, each with its one sentence.

PHYSICS_HPP_BEGIN

namespace detail {

enum class recipe_problem {
    none,
    not_a_recipe,
    bad_scalar,
    bad_dimension,
    policy_without_stage,
    unknown_stage,
    not_shapes_or_without,
    two_policies_for_a_stage,
    no_shapes,
    same_shape_twice,
    not_a_shape,
    pair_without_contact,
    unknown_feature,
    bad_broadphase,
    bad_narrowphase,
    bad_integrator,
    bad_solver,
};

template <class T>
constexpr bool is_policy_list = false;
template <class... Policies>
constexpr bool is_policy_list<policy_list<Policies...>> = true;

template <class Recipe>
concept recipe_like = requires {
    typename Recipe::scalar;
    typename std::integral_constant<int, Recipe::dimension>;
    typename Recipe::policies;
} && is_policy_list<typename Recipe::policies>;

template <class Stage>
constexpr bool known_stage = std::same_as<Stage, stage::shapes> || std::same_as<Stage, stage::broadphase> ||
                             std::same_as<Stage, stage::narrowphase> || std::same_as<Stage, stage::solver> ||
                             std::same_as<Stage, stage::integrator> || std::same_as<Stage, stage::features>;

/// False for a policy that claims a stage of the library's own.
template <class Policy, class Stage = typename stage_of<Policy>::type>
constexpr bool may_serve = !std::same_as<Stage, stage::shapes> && !std::same_as<Stage, stage::features>;
template <template <class, int> class... Shapes>
constexpr bool may_serve<shapes<Shapes...>, stage::shapes> = true;
template <class... Features>
constexpr bool may_serve<without<Features...>, stage::features> = true;

/// How many of the policies serve the stage.
template <class Stage, class... Policies>
constexpr int policies_for = (0 + ... + int{std::same_as<typename stage_of<Policies>::type, Stage>});

template <class A, class S, int D, template <class, int> class... Shapes>
constexpr bool meets_all = (collidable<A, Shapes<S, D>, S, D> && ...);
template <class A, class S, int D, template <class, int> class... Shapes>
constexpr int times_among = (0 + ... + int{std::same_as<A, Shapes<S, D>>});

template <class T>
concept complete = requires { sizeof(T); };
template <class Shape, class S, int D>
concept usable_shape = complete<Shape> && shape_for<Shape, S, D>;
template <class S, int D, template <class, int> class... Shapes>
constexpr recipe_problem problem_of_shapes(const shapes<Shapes...>*) {
    if constexpr (sizeof...(Shapes) == 0) return recipe_problem::no_shapes;
    else if constexpr (((times_among<Shapes<S, D>, S, D, Shapes...> > 1) || ...))
        return recipe_problem::same_shape_twice;
    else if constexpr (!(usable_shape<Shapes<S, D>, S, D> && ...)) return recipe_problem::not_a_shape;
    else if constexpr (!(meets_all<Shapes<S, D>, S, D, Shapes...> && ...)) return recipe_problem::pair_without_contact;
    else return recipe_problem::none;
}

template <class Policy, class Space>
concept broadphase_policy = requires {
    typename Policy::template in<Space>;
}
&&broadphase_for<typename Policy::template in<Space>, Space>;

template <class Policy, class S, int D, template <class, int> class... Shapes>
constexpr bool narrowphase_serves(const shapes<Shapes...>*) {
    return narrowphase_for<Policy, S, D, Shapes...>;
}

/// What an integrator must offer: advance_velocity(velocity, body, gravity, h), advance_pose(body, velocity, h).
template <class Policy, class S, int D>
concept integrator_policy = requires(solver_body<S, D> v, body<S, D> b, twist<S, D> t) {
    Policy::template in<space<S, D>>::advance_velocity(v, b, vec<S, D>{}, S(1));
    Policy::template in<space<S, D>>::advance_pose(b, t, S(1));
};

/// What a solver asks of the world that it advances.
template <class S>
struct any_motion {
    void advance_velocities(S) {}
    void advance_poses(S) {}
};
/// What a solver must offer: settings with a function check(settings, function) like that of shapes, and
/// solve(bodies, contacts, settings, h, scratch, motion).
template <class Policy, class S, int D, class Features>
concept solver_policy = requires(solver_body<S, D>* bodies, buffer<contact<S, D>> contacts, arena scratch,
                                 any_motion<S> motion,
                                 const typename Policy::template in<space<S, D>, Features>::settings settings) {
    { check(settings, "function") } -> std::same_as<bool>;
    Policy::template in<space<S, D>, Features>::solve(bodies, contacts, settings, S(1), scratch, motion);
};

template <class S, int D, class... Policies>
constexpr recipe_problem problem_of_policies(const policy_list<Policies...>*) {
    if constexpr ((std::is_void_v<typename stage_of<Policies>::type> || ...)) {
        return recipe_problem::policy_without_stage;
    } else if constexpr (!(known_stage<typename stage_of<Policies>::type> && ...)) {
        return recipe_problem::unknown_stage;
    } else if constexpr (!(may_serve<Policies> && ...)) {
        return recipe_problem::not_shapes_or_without;
    } else if constexpr (((policies_for<typename stage_of<Policies>::type, Policies...> > 1) || ...)) {
        return recipe_problem::two_policies_for_a_stage;
    } else {
        using set = shape_set_for<Policies...>;
        using features = typename policy_for<stage::features, without<>, Policies...>::type;
        constexpr recipe_problem of_shapes = problem_of_shapes<S, D>(static_cast<const set*>(nullptr));
        if constexpr (of_shapes != recipe_problem::none) return of_shapes;
        else if constexpr (!features::known) return recipe_problem::unknown_feature;
        else if constexpr (!broadphase_policy<typename policy_for<stage::broadphase, dynamic_tree, Policies...>::type,
                                              space<S, D>>)
            return recipe_problem::bad_broadphase;
        else if constexpr (!narrowphase_serves<
                               typename policy_for<stage::narrowphase, best_per_pair, Policies...>::type, S, D>(
                               static_cast<const set*>(nullptr)))
            return recipe_problem::bad_narrowphase;
        else if constexpr (!integrator_policy<
                               typename policy_for<stage::integrator, semi_implicit_euler, Policies...>::type, S, D>)
            return recipe_problem::bad_integrator;
        else if constexpr (!solver_policy<typename policy_for<stage::solver, sequential_impulse, Policies...>::type, S,
                                          D, features>)
            return recipe_problem::bad_solver;
        else return recipe_problem::none;
    }
}

template <class Recipe>
constexpr recipe_problem problem_of() {
    if constexpr (!recipe_like<Recipe>) return recipe_problem::not_a_recipe;
    else if constexpr (!scalar_type<typename Recipe::scalar>) return recipe_problem::bad_scalar;
    else if constexpr (Recipe::dimension != 2 && Recipe::dimension != 3) return recipe_problem::bad_dimension;
    else
        return problem_of_policies<typename Recipe::scalar, Recipe::dimension>(
            static_cast<const typename Recipe::policies*>(nullptr));
}

template <class S, int D, class... Policies>
plan<S, D, shape_set_for<Policies...>, Policies...> planned(const policy_list<Policies...>*);

/// The plan of a recipe. A recipe that fails its audit gets the default plan, so that its one sentence is
/// the only error.
template <class Recipe, bool Good = problem_of<Recipe>() == recipe_problem::none>
struct plan_of {
    using type = decltype(planned<typename Recipe::scalar, Recipe::dimension>(
        static_cast<const typename Recipe::policies*>(nullptr)));
};
template <class Recipe>
struct plan_of<Recipe, false> : plan_of<recipe<float, 2>> {};

/// Says in one sentence what is wrong with a recipe.
template <class Recipe>
struct audit {
    static constexpr recipe_problem problem = problem_of<Recipe>();
    static_assert(problem != recipe_problem::not_a_recipe,
                  "physics::world: the argument is not a recipe; write struct mine : physics::recipe<float, 2> {} and "
                  "physics::world<mine>");
    static_assert(problem != recipe_problem::bad_scalar,
                  "physics::recipe: the scalar is not a physics::scalar_type; use float, double, physics::fixed32, or "
                  "specialise physics::scalar_traits");
    static_assert(problem != recipe_problem::bad_dimension, "physics::recipe: the dimension must be 2 or 3");
    static_assert(problem != recipe_problem::policy_without_stage,
                  "physics::recipe: a policy names no stage; give it `using stage = physics::stage::...`");
    static_assert(problem != recipe_problem::unknown_stage,
                  "physics::recipe: a policy names a stage that does not exist; the stages are those of namespace "
                  "physics::stage");
    static_assert(
        problem != recipe_problem::not_shapes_or_without,
        "physics::recipe: a policy names a stage that only physics::shapes<...> or physics::without<...> may serve");
    static_assert(problem != recipe_problem::two_policies_for_a_stage,
                  "physics::recipe: two policies serve the same stage; keep one of them");
    static_assert(problem != recipe_problem::no_shapes, "physics::shapes: the set is empty; name at least one shape");
    static_assert(problem != recipe_problem::same_shape_twice, "physics::shapes: a shape stands in the set twice");
    static_assert(
        problem != recipe_problem::not_a_shape,
        "physics::shapes: a type of the set does not model physics::shape_for; it needs check, bounds and as<T>()");
    static_assert(problem != recipe_problem::pair_without_contact,
                  "physics::shapes: two shapes of the set have no function collide(a, b, b_in_a, margin, manifold)");
    static_assert(
        problem != recipe_problem::unknown_feature,
        "physics::without: an argument is not a feature; the features are those of namespace physics::feature");
    static_assert(problem != recipe_problem::bad_broadphase,
                  "physics::recipe: the broadphase does not model physics::broadphase_for; its in<Space> needs insert, "
                  "move, erase and pairs");
    static_assert(problem != recipe_problem::bad_narrowphase,
                  "physics::recipe: the narrowphase does not model physics::narrowphase_for; its in<S, D, Shapes...> "
                  "needs collide");
    static_assert(problem != recipe_problem::bad_integrator,
                  "physics::recipe: the integrator's in<Space> needs advance_velocity and advance_pose");
    static_assert(problem != recipe_problem::bad_solver,
                  "physics::recipe: the solver's in<Space, Features> needs a struct settings with a function check, "
                  "and a function solve");
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/state.hpp
// =================================================================================================
// Everything that a world holds, as plain arrays.

PHYSICS_HPP_BEGIN

namespace detail {

/// Everything that a world keeps of one shape.
template <class Plan>
struct shape_record {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    typename Plan::shape shape;
    transform<S, D> local;
    physics::material<S> material;
    S density{};
    std::uint32_t body = 0;
    /// The next shape of the same body.
    std::uint32_t next = 0xffffffffu;
    std::uint64_t user_data = 0;
};

/// The shapes of a world. It is one of the owners of the geometry that its shapes are made of.
template <class Plan>
class shape_pool : public pool<shape_record<Plan>> {
    using base = pool<shape_record<Plan>>;

public:
    shape_pool() = default;
    shape_pool(const shape_pool& other) : base(other) { each_geometry(retain); }
    shape_pool(shape_pool&& other) noexcept = default;
    shape_pool& operator=(shape_pool other) noexcept {
        base::swap(other);
        return *this;
    }
    ~shape_pool() { each_geometry(release); }

    typename base::place insert(const shape_record<Plan>& record) {
        retain(record.shape.geometry());
        return base::insert(record);
    }
    void erase(std::uint32_t index) {
        release((*this)[index].shape.geometry());
        base::erase(index);
    }

private:
    void each_geometry(void (*change)(const geometry_block*)) const {
        if constexpr (Plan::shape::has_geometry)
            base::each([&](std::uint32_t, const auto& record) { change(record.shape.geometry()); });
    }
};

/// What a narrowphase remembers of pairs, in ascending order of the pairs; nothing of kinds of pairs that it does not
/// care to remember.
template <class Plan>
struct pair_memories {
    using memory = typename Plan::pair_memory;

    buffer<proxy_pair> pairs;
    buffer<memory> items;

    void clear() {
        pairs.clear();
        items.clear();
    }
    void add(proxy_pair pair, const memory& item) {
        pairs.push(pair);
        items.push(item);
    }
    void swap(pair_memories& other) noexcept {
        pairs.swap(other.pairs);
        items.swap(other.items);
    }
    /// Forgets the pairs that have a shape for which gone(shape) is true.
    template <class Gone>
    void drop(Gone&& gone) {
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < pairs.size(); ++i) {
            if (gone(pairs[i].a) || gone(pairs[i].b)) continue;
            pairs[kept] = pairs[i];
            items[kept++] = items[i];
        }
        while (pairs.size() > kept) {
            pairs.pop();
            items.pop();
        }
    }
};

/// The state of a world. Copying it copies the world.
template <class Plan>
struct state {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    typename Plan::settings settings;
    pool<body<S, D>> bodies;
    shape_pool<Plan> shapes;
    typename Plan::broadphase broadphase;
    /// Contacts of the last step, in ascending order of their pairs.
    buffer<contact<S, D>> contacts;
    /// Where the centres of bodies were, and how bodies were turned, when these contacts were found.
    buffer<transform<S, D>> contact_starts;
    /// What the narrowphase remembers of the last step's pairs.
    pair_memories<Plan> memories;
    std::uint64_t steps = 0;
    std::uint16_t tag = 0;

    // Scratch of the step: nothing in it outlives one.
    manifold_list<S, D> manifolds;
    buffer<contact<S, D>> found;
    pair_memories<Plan> found_memories;
    buffer<transform<S, D>> starts;
    arena scratch;
};

/// The pose of a shape in the world.
template <class Plan>
auto world_pose(const state<Plan>& s, const shape_record<Plan>& shape) {
    return s.bodies[shape.body].pose() * shape.local;
}

/// The box that the narrowphase needs the broadphase to know: all within half the contact margin.
template <class Plan>
auto needed_box(const state<Plan>& s, const shape_record<Plan>& shape) {
    return grown(bounds(shape.shape, world_pose(s, shape)), s.settings.contact_margin / typename Plan::scalar(2));
}
/// What the broadphase knows of a shape besides.
template <class Plan>
proxy_filter filter_of(const state<Plan>& s, const shape_record<Plan>& shape) {
    return {.owner = shape.body, .movable = s.bodies[shape.body].is_dynamic()};
}
template <class Plan>
void configure_broadphase(state<Plan>& s) {
    if constexpr (requires { s.broadphase.configure(s.settings.broadphase); })
        s.broadphase.configure(s.settings.broadphase);
}
/// Lets queries see where shapes are, if the broadphase wants to be told.
template <class Plan>
void update_broadphase(state<Plan>& s) {
    if constexpr (requires { s.broadphase.update(); }) s.broadphase.update();
}

/// Calls f(index, shape) for every shape of a body.
template <class State, class F>
void each_shape(State& s, std::uint32_t body, F&& f) {
    for (std::uint32_t i = s.bodies[body].first_shape; i != 0xffffffffu;) {
        const std::uint32_t next = s.shapes[i].next;
        f(i, s.shapes[i]);
        i = next;
    }
}

/// A number for each world of the program, to recognise foreign handles; after 65535 worlds numbers come again. It
/// never enters any result.
inline std::uint16_t next_world_tag() noexcept {
    static std::uint32_t count = 0;
#if defined(__GNUC__)
    return static_cast<std::uint16_t>(__atomic_add_fetch(&count, 1u, __ATOMIC_RELAXED));
#else
    return static_cast<std::uint16_t>(++count);
#endif
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/mass.hpp
// =================================================================================================
// What bodies weigh: from their shapes, or as they are told.

PHYSICS_HPP_BEGIN

namespace detail {

template <class T, class S>
rotation<T, 2> converted(const rotation<S, 2>& r) {
    return {static_cast<T>(r.cosine), static_cast<T>(r.sine)};
}
template <class T, class S>
rotation<T, 3> converted(const rotation<S, 3>& r) {
    return {static_cast<T>(r.x), static_cast<T>(r.y), static_cast<T>(r.z), static_cast<T>(r.w)};
}
template <class T, class S, int D>
vec<T, D> converted(vec<S, D> v) {
    vec<T, D> result;
    for (int i = 0; i < D; ++i) result[i] = static_cast<T>(v[i]);
    return result;
}
template <class T, class S, int D>
transform<T, D> converted(const transform<S, D>& t) {
    return {converted<T>(t.position), converted<T>(t.rotation)};
}
template <class T, scalar_type S>
T converted(S x) {
    return static_cast<T>(x);
}
template <class T, class S>
symmetric<T> converted(const symmetric<S>& m) {
    return {static_cast<T>(m.xx), static_cast<T>(m.yy), static_cast<T>(m.zz),
            static_cast<T>(m.xy), static_cast<T>(m.xz), static_cast<T>(m.yz)};
}
template <class T, class S, int D>
mass_properties<T, D> converted(const mass_properties<S, D>& m) {
    return {static_cast<T>(m.mass), converted<T>(m.center), converted<T>(m.inertia)};
}

/// The mass of one shape in its body's frame, computed with the scalar T; none for shapes without mass.
template <class T, class Plan>
auto mass_of_shape(const shape_record<Plan>& record) {
    return record.shape.visit([&](const auto& shape) -> mass_properties<T, Plan::dimension> {
        if constexpr (solid_shape_for<std::remove_cvref_t<decltype(shape)>, typename Plan::scalar, Plan::dimension>)
            return transformed(mass_of(shape.template as<T>(), static_cast<T>(record.density)),
                               converted<T>(record.local));
        else return {};
    });
}
/// The mass of all shapes of a body but one, computed with the scalar T.
template <class T, class Plan>
auto mass_of_shapes(const state<Plan>& s, std::uint32_t body, std::uint32_t but = 0xffffffffu) {
    mass_properties<T, Plan::dimension> sum;
    each_shape(s, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        if (i != but) sum = combined(sum, mass_of_shape<T>(shape));
    });
    return sum;
}

/// Gives a body its mass, its centre and what follows from them. The frame stays where it is, and the
/// velocity of the body's material points and the points of its contacts with it.
template <class Plan>
void set_mass_properties(state<Plan>& s, std::uint32_t index,
                         const mass_properties<typename Plan::scalar, Plan::dimension>& mass) {
    using S = typename Plan::scalar;
    auto& b = s.bodies[index];
    if (!(mass.center == b.mass.center)) {
        const vec<S, Plan::dimension> center = b.pose() * mass.center, shift = mass.center - b.mass.center;
        b.velocity.linear += cross(b.velocity.angular, center - b.center);
        b.center = center;
        for (auto& c : s.contacts)
            for (int k = 0; k < c.count; ++k) {
                if (c.body_a == index) c.points[k].lever_a -= s.contact_starts[index].rotation * shift;
                if (c.body_b == index) c.points[k].lever_b -= s.contact_starts[index].rotation * shift;
            }
    }
    b.mass = mass;
    b.inverse_mass = {};
    b.inverse_inertia = {};
    b.is_gyroscopic = b.is_dynamic() && !b.rotation_locked && !is_isotropic(mass.inertia);
    if (!b.is_dynamic()) return;
    b.inverse_mass = reciprocal<inverse_of<S>>(mass.mass);
    if (!b.rotation_locked) b.inverse_inertia = inverted_inertia(mass.inertia);
}
/// Mass from shapes, unless the user has set it. A dynamic body without any mass is a point of 1 kg at its
/// origin; static and kinematic bodies take no mass from shapes.
template <class Plan>
void refresh_mass(state<Plan>& s, std::uint32_t index) {
    using S = typename Plan::scalar;
    const auto& b = s.bodies[index];
    mass_properties<S, Plan::dimension> mass;
    if (b.mass_is_set) mass = b.mass;
    else if (b.is_dynamic()) mass = mass_of_shapes<S>(s, index);
    if (b.is_dynamic() && !(mass.mass > S(0))) mass = {S(1), {}, {}};
    set_mass_properties(s, index, mass);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/check.hpp
// =================================================================================================
// Every check of the user's handles and numbers: each refuses what is bad by name, and says whether all was good.

PHYSICS_HPP_BEGIN

namespace detail {

/// What a handle names: its number, where ok.
struct found {
    std::uint32_t index;
    bool ok;
    explicit operator bool() const { return ok; }
};
template <class Plan, class Pool, class Tag>
found find(const state<Plan>& s, const Pool& pool, handle<Tag> id, const char* function, const char* what) {
    if (!id) return {0, refuse(function, what, "null", "it must name something that this world has created")};
    char name[32];
    std::snprintf(name, sizeof name, "#%u", static_cast<unsigned>(id.index));
    if (id.world != s.tag) return {0, refuse(function, what, name, "it belongs to another world")};
    if (!pool.contains(id.index, id.generation)) return {0, refuse(function, what, name, "it has been destroyed")};
    return {id.index, true};
}
template <class Plan>
found find_body(const state<Plan>& s, body_id id, const char* function) {
    return find(s, s.bodies, id, function, "body");
}
template <class Plan>
found find_shape(const state<Plan>& s, shape_id id, const char* function) {
    return find(s, s.shapes, id, function, "shape");
}
inline const char* name_of(body_type type) {
    return type == body_type::static_body ? "static" : type == body_type::kinematic_body ? "kinematic" : "dynamic";
}
/// The same for calls that only dynamic bodies take,
template <class Plan>
found find_dynamic(const state<Plan>& s, body_id id, const char* function) {
    const found f = find_body(s, id, function);
    if (f && !s.bodies[f.index].is_dynamic())
        return {0, refuse(function, "body", name_of(s.bodies[f.index].type), "it must be dynamic")};
    return f;
}
/// only kinematic ones,
template <class Plan>
found find_kinematic(const state<Plan>& s, body_id id, const char* function) {
    const found f = find_body(s, id, function);
    if (f && s.bodies[f.index].type != body_type::kinematic_body)
        return {0, refuse(function, "body", name_of(s.bodies[f.index].type), "it must be kinematic")};
    return f;
}
/// and only those that have a velocity.
template <class Plan>
found find_moving(const state<Plan>& s, body_id id, const char* function) {
    const found f = find_body(s, id, function);
    if (f && s.bodies[f.index].type == body_type::static_body)
        return {0, refuse(function, "body", "static", "it must be dynamic or kinematic")};
    return f;
}

/// The largest part of a number or vector, for messages.
template <scalar_type S>
double size_of(S x) {
    return static_cast<double>(abs(x));
}
template <class S, int D>
double size_of(vec<S, D> v) {
    return static_cast<double>(largest(v));
}

template <class S, int D>
bool check_pose(const char* function, vec<S, D> position, const rotation<S, D>& r) {
    if (!check_finite(function, "position", position)) return false;
    // In double, where the squares of no format overflow.
    const double error = norm_error(converted<double>(r));
    return error < 1e-3 ||
           refuse(function, "error of rotation", error, "its squared length must be 1, to less than 0.001");
}
template <class Angular>
bool check_angular_velocity(const char* function, const char* field, Angular w, bool rotation_locked) {
    if (!check_finite(function, field, w)) return false;
    return !rotation_locked || w == Angular{} ||
           refuse(function, field, size_of(w), "it must be 0, since the body's rotation is locked");
}
inline bool check_type(const char* function, body_type type) {
    return type <= body_type::dynamic_body ||
           refuse(function, "type", static_cast<double>(type), "it must be a body_type");
}
template <class S, int D>
bool check_body(const body_def<S, D>& def) {
    const char* f = "create_body";
    return check_type(f, def.type) && check_pose(f, def.position, def.rotation) &&
           check_finite(f, "linear_velocity", def.linear_velocity) &&
           check_angular_velocity(f, "angular_velocity", def.angular_velocity, def.rotation_locked) &&
           check_not_negative(f, "linear_damping", def.linear_damping) &&
           check_not_negative(f, "angular_damping", def.angular_damping) &&
           check_finite(f, "gravity_scale", def.gravity_scale);
}
template <class S>
bool check_material(const char* function, const material<S>& m) {
    if (!check_not_negative(function, "friction", m.friction) ||
        !check_not_negative(function, "restitution", m.restitution))
        return false;
    return !(m.restitution > S(1)) ||
           refuse(function, "restitution", static_cast<double>(m.restitution), "it must be at most 1");
}
template <class Settings>
bool check_settings(const Settings& with, const char* function) {
    return check_finite(function, "gravity", with.gravity) &&
           check_not_negative(function, "contact_margin", with.contact_margin) &&
           check(with.broadphase, function) && check(with.solver, function);
}

/// Refuses to make a world of floating-point numbers where arithmetic would not give the same bits as
/// everywhere. What the step itself repairs, rounding modes and flushing to zero, is no reason to refuse.
template <class S>
bool check_environment([[maybe_unused]] const char* function) {
#ifndef PHYSICS_HPP_NONDETERMINISTIC
    if constexpr (std::floating_point<S>) {
        const float_control_scope control;
        const auto faults = float_environment();
        if (faults != 0)
            return refuse(function, "arithmetic", float_fault_names(faults).c_str(),
                          "compile without the flags that allow it, or define PHYSICS_HPP_NONDETERMINISTIC");
    }
#endif
    return true;
}

/// True if the type can hold the positive value to one percent: it is not rounded away, and leaves room for the
/// rounding of other ways to compute it below the end of the range.
template <class S>
bool representable(double value) {
    if (!(value < 0.9375 * static_cast<double>(scalar_traits<S>::max()))) return false;
    const double error = static_cast<double>(static_cast<S>(value)) / value - 1;
    return error <= 0.01 && error >= -0.01;
}
template <class S>
bool check_mass_value(const char* function, const char* field, double value, double inverse_value) {
    if (!(value > 0)) return refuse(function, field, value, "it must be greater than 0");
    if (!representable<S>(value) || !representable<inverse_of<S>>(inverse_value))
        return refuse(function, field, value,
                      "it or its inverse is beyond the scalar's range; use other units of length or mass");
    return true;
}
template <class S>
bool check_inertia(const char* function, double inertia) {
    return check_mass_value<S>(function, "inertia", inertia, 1 / inertia);
}
template <class S>
bool check_inertia(const char* function, const symmetric<double>& i) {
    if (!check_finite(function, "inertia.xy", i.xy) || !check_finite(function, "inertia.xz", i.xz) ||
        !check_finite(function, "inertia.yz", i.yz))
        return false;
    const symmetric<double> inverted = inverse<double>(i);
    const double diagonal[] = {i.xx, i.yy, i.zz}, of_inverse[] = {inverted.xx, inverted.yy, inverted.zz};
    constexpr const char* names[] = {"inertia.xx", "inertia.yy", "inertia.zz"};
    for (int k = 0; k < 3; ++k)
        if (!check_mass_value<S>(function, names[k], diagonal[k], inverted.xx > 0 ? of_inverse[k] : 1 / diagonal[k]))
            return false;
    const bool definite = inverted.xx > 0 && inverted_inertia(converted<S>(i)).xx > inverse_of<S>(0);
    return definite || refuse(function, "inertia.xx", i.xx, "the tensor that it begins must be positive definite");
}
/// Whether a dynamic body can have these mass properties, given in double, where it is now.
template <class S, int D>
bool check_mass(const char* function, const body<S, D>& b, const mass_properties<double, D>& m,
                bool without_inertia = false) {
    if (!check_mass_value<S>(function, "mass", m.mass, 1 / m.mass)) return false;
    if (!without_inertia && !check_inertia<S>(function, m.inertia)) return false;
    const vec<S, D> center = converted<S>(m.center), moved = b.pose() * center;
    return (is_finite(center) && is_finite(moved) && is_finite(velocity_at(b.velocity, moved - b.center))) ||
           refuse(function, "center", size_of(m.center),
                  "the body's centre of mass or its velocity would be beyond the scalar's range");
}
/// Whether a dynamic body can take its mass from its shapes, but one.
template <class Plan>
bool check_shapes_mass(const state<Plan>& s, std::uint32_t body, const char* function,
                       std::uint32_t but = 0xffffffffu) {
    const auto mass = mass_of_shapes<double>(s, body, but);
    return !(mass.mass > 0) || check_mass(function, s.bodies[body], mass);
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/edit.hpp
// =================================================================================================
// How bodies and shapes come, go and change between steps.

PHYSICS_HPP_BEGIN

namespace detail {

/// Tells the broadphase where the shapes of a body are now.
template <class Plan>
void refresh_boxes(state<Plan>& s, std::uint32_t body) {
    each_shape(s, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        s.broadphase.move(i, needed_box(s, shape), {});
    });
    update_broadphase(s);
}
/// The same where it has become another kind of proxy.
template <class Plan>
void renew_proxies(state<Plan>& s, std::uint32_t body) {
    each_shape(s, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        s.broadphase.erase(i);
        s.broadphase.insert(i, needed_box(s, shape), filter_of(s, shape));
    });
}

/// Forgets the contacts for which gone(contact) is true; the others keep their order.
template <class Plan, class Gone>
void drop_contacts(state<Plan>& s, Gone&& gone) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < s.contacts.size(); ++i)
        if (!gone(s.contacts[i])) s.contacts[kept++] = s.contacts[i];
    while (s.contacts.size() > kept) s.contacts.pop();
}

template <class Plan>
body_id create_body(state<Plan>& s, const body_def<typename Plan::scalar, Plan::dimension>& def) {
    if (!check_body(def)) return {};
    body<typename Plan::scalar, Plan::dimension> b;
    b.type = def.type;
    b.rotation = normalized(def.rotation);
    b.center = def.position;
    if (def.type != body_type::static_body) b.velocity = {def.linear_velocity, def.angular_velocity};
    b.linear_damping = def.linear_damping;
    b.angular_damping = def.angular_damping;
    b.gravity_scale = def.gravity_scale;
    b.rotation_locked = def.rotation_locked;
    b.user_data = def.user_data;
    const auto place = s.bodies.insert(b);
    refresh_mass(s, place.index);
    return {place.index, place.generation, s.tag};
}

template <class Plan>
void destroy_body(state<Plan>& s, std::uint32_t index) {
    drop_contacts(s, [&](const auto& c) { return c.body_a == index || c.body_b == index; });
    s.memories.drop([&](std::uint32_t shape) { return s.shapes[shape].body == index; });
    each_shape(s, index, [&](std::uint32_t i, const shape_record<Plan>&) {
        s.broadphase.erase(i);
        s.shapes.erase(i);
    });
    s.bodies.erase(index);
}

template <class Plan, class Shape>
shape_id create_shape(state<Plan>& s, body_id body, const Shape& shape,
                      const shape_def<typename Plan::scalar, Plan::dimension>& def) {
    using S = typename Plan::scalar;
    const char* f = "create_shape";
    const found at = find_body(s, body, f);
    if (!at || !check(shape, f) || !check_pose(f, def.position, def.rotation) ||
        !check_not_negative(f, "density", def.density) || !check_material(f, def.material))
        return {};
    const auto& owner = s.bodies[at.index];
    if (!solid_shape_for<Shape, S, Plan::dimension> && owner.is_dynamic()) {
        refuse(f, "shape", "without mass", "a dynamic body needs shapes that have a mass");
        return {};
    }
    shape_record<Plan> record;
    record.shape = shape;
    record.local = {def.position, normalized(def.rotation)};
    record.material = def.material;
    record.density = def.density;
    record.body = at.index;
    record.next = owner.first_shape;
    record.user_data = def.user_data;
    const auto box = needed_box(s, record);
    if (!check_finite(f, "lower end of the box", box.lower) || !check_finite(f, "upper end of the box", box.upper))
        return {};
    if (def.density > S(0) && owner.is_dynamic() && !owner.mass_is_set &&
        !check_mass(f, owner, combined(mass_of_shapes<double>(s, at.index), mass_of_shape<double>(record))))
        return {};
    const auto place = s.shapes.insert(record);
    s.bodies[at.index].first_shape = place.index;
    s.broadphase.insert(place.index, box, filter_of(s, record));
    refresh_mass(s, at.index);
    return {place.index, place.generation, s.tag};
}

template <class Plan>
void destroy_shape(state<Plan>& s, std::uint32_t index) {
    const std::uint32_t body = s.shapes[index].body;
    const auto& owner = s.bodies[body];
    if (owner.is_dynamic() && !owner.mass_is_set && !check_shapes_mass(s, body, "destroy_shape", index)) return;
    drop_contacts(s, [&](const auto& c) { return c.shape_a == index || c.shape_b == index; });
    s.memories.drop([&](std::uint32_t shape) { return shape == index; });
    std::uint32_t* link = &s.bodies[body].first_shape;
    while (*link != index) link = &s.shapes[*link].next;
    *link = s.shapes[index].next;
    s.broadphase.erase(index);
    s.shapes.erase(index);
    refresh_mass(s, body);
}

template <class Plan>
void set_pose(state<Plan>& s, std::uint32_t index, const transform<typename Plan::scalar, Plan::dimension>& pose) {
    auto& b = s.bodies[index];
    if (!check_finite("set_pose", "centre of mass", pose * b.mass.center)) return;
    b.set_pose(pose);
    refresh_boxes(s, index);
}

template <class Plan>
void set_type(state<Plan>& s, std::uint32_t index, body_type type) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "set_type";
    auto& b = s.bodies[index];
    if (!check_type(f, type) || type == b.type) return;
    if (type == body_type::dynamic_body) {
        bool solid = true;
        each_shape(s, index, [&](std::uint32_t, const auto& record) {
            record.shape.visit([&](const auto& shape) {
                solid = solid && solid_shape_for<std::remove_cvref_t<decltype(shape)>, S, D>;
            });
        });
        if (!solid) {
            refuse(f, "shape", "without mass", "a dynamic body needs shapes that have a mass");
            return;
        }
        if (!b.mass_is_set && !check_shapes_mass(s, index, f)) return;
    }
    if (type == body_type::static_body) b.velocity = {};
    if (type != body_type::dynamic_body) {
        b.force = {};
        b.torque = {};
    }
    b.has_target = false;
    b.type = type;
    refresh_mass(s, index);
    renew_proxies(s, index);
    drop_contacts(s, [&](const auto& c) {
        return (c.body_a == index || c.body_b == index) && !s.bodies[c.body_a].is_dynamic() &&
               !s.bodies[c.body_b].is_dynamic();
    });
}

template <class Plan>
void set_mass(state<Plan>& s, std::uint32_t index,
              const mass_properties<typename Plan::scalar, Plan::dimension>& mass) {
    const char* f = "set_mass";
    const bool nothing_turns_it = mass.inertia == decltype(mass.inertia){};
    if (!check_finite(f, "center", mass.center) ||
        !check_mass(f, s.bodies[index], converted<double>(mass), nothing_turns_it))
        return;
    s.bodies[index].mass_is_set = true;
    set_mass_properties(s, index, mass);
}
template <class Plan>
void reset_mass(state<Plan>& s, std::uint32_t index) {
    if (!check_shapes_mass(s, index, "reset_mass")) return;
    s.bodies[index].mass_is_set = false;
    refresh_mass(s, index);
}

template <class Plan>
void set_rotation_locked(state<Plan>& s, std::uint32_t index, bool locked) {
    auto& b = s.bodies[index];
    b.rotation_locked = locked;
    if (locked) b.velocity.angular = {};
    refresh_mass(s, index);
}

template <class Plan>
void change_settings(state<Plan>& s, const typename Plan::settings& settings) {
    // What was carried along was found within the old margin.
    if (settings.contact_margin != s.settings.contact_margin) s.memories.clear();
    s.settings = settings;
    configure_broadphase(s);
    s.bodies.each([&](std::uint32_t i, const auto&) { refresh_boxes(s, i); });
}

/// Stores a quantity that an action has changed, unless it left the scalar's range: false then.
template <class Quantity>
bool assign(Quantity& to, const Quantity& value) {
    if (!is_finite(value)) return false;
    to = value;
    return true;
}
inline bool refuse_action(const char* function, const char* field, double size) {
    return refuse(function, field, size, "with it a force or velocity of the body would be beyond the scalar's range");
}

/// Calls f(body, force, lever) with a force or impulse and its lever from the centre of mass, in world axes;
/// f says whether the body can take it.
template <class Plan, class F>
void act(state<Plan>& s, body_id id, const char* function, const char* field,
         vec<typename Plan::scalar, Plan::dimension> force, bool local,
         const vec<typename Plan::scalar, Plan::dimension>* point, F&& f) {
    const found at = find_dynamic(s, id, function);
    if (!at || !check_finite(function, field, force) || (point && !check_finite(function, "point", *point))) return;
    auto& b = s.bodies[at.index];
    vec<typename Plan::scalar, Plan::dimension> lever;
    if (point) lever = local ? b.rotation * (*point - b.mass.center) : *point - b.center;
    if (!f(b, local ? b.rotation * force : force, lever)) refuse_action(function, field, size_of(force));
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/hash.hpp
// =================================================================================================
// A number that worlds in the same state share.

PHYSICS_HPP_BEGIN

namespace detail {

/// Mixes words into 64 bits, by value: neither byte order nor padding enters. Source: the finaliser of
/// Steele, Lea, Flood, Fast splittable pseudorandom number generators (2014).
class hasher {
public:
    void add(std::uint64_t word) {
        hash_ = (hash_ ^ word) * 0xff51afd7ed558ccdu;
        hash_ ^= hash_ >> 32;
        hash_ *= 0xc4ceb9fe1a85ec53u;
        hash_ ^= hash_ >> 29;
    }
    template <scalar_type S>
    void add(S x) {
        add(scalar_traits<S>::bits(x));
    }
    template <class S, int D>
    void add(vec<S, D> v) {
        for (int i = 0; i < D; ++i) add(v[i]);
    }
    template <class S>
    void add(rotation<S, 2> r) {
        add(r.cosine);
        add(r.sine);
    }
    template <class S>
    void add(rotation<S, 3> r) {
        add(r.imaginary());
        add(r.w);
    }
    template <class S>
    void add(const symmetric<S>& m) {
        add(vec<S, 3>{m.xx, m.yy, m.zz});
        add(vec<S, 3>{m.xy, m.xz, m.yz});
    }
    template <class S, int D>
    void add(const transform<S, D>& t) {
        add(t.position);
        add(t.rotation);
    }
    template <class S, int D>
    void add(const body<S, D>& b) {
        add(static_cast<std::uint64_t>(b.type) | std::uint64_t{b.rotation_locked} << 8 |
            std::uint64_t{b.mass_is_set} << 9 | std::uint64_t{b.has_target} << 10);
        add(b.center);
        add(b.rotation);
        add(b.velocity.linear);
        add(b.velocity.angular);
        add(b.force);
        add(b.torque);
        add(b.mass.mass);
        add(b.mass.center);
        add(b.mass.inertia);
        add(b.linear_damping);
        add(b.angular_damping);
        add(b.gravity_scale);
        if (b.has_target) add(b.target);
    }
    template <class Plan>
    void add(const shape_record<Plan>& s) {
        add(static_cast<std::uint64_t>(s.shape.kind()) << 32 | s.body);
        add(s.local);
        add(s.material.friction);
        add(s.material.restitution);
        add(s.density);
        const auto box = bounds(s.shape, s.local);
        add(box.lower);
        add(box.upper);
        s.shape.visit([&](const auto& shape) {
            if constexpr (refers_to_geometry<std::remove_cvref_t<decltype(shape)>>) add(shape.geometry->digest);
        });
    }
    template <class S, int D>
    void add(const contact<S, D>& c) {
        add(c.normal);
        add(static_cast<std::uint64_t>(c.count) | std::uint64_t{c.part} << 32);
        for (int k = 0; k < c.count; ++k) {
            add(std::uint64_t{c.points[k].feature});
            add(c.points[k].normal_impulse);
            add(c.points[k].friction_impulse);
        }
    }
    /// The manifold follows from the rest.
    template <class S, int D>
    void add(const pair_memory<S, D>& m) {
        add(m.b_in_a);
        add(m.cache);
        add(std::uint64_t{static_cast<std::uint32_t>(m.contact.count)});
    }
    template <class S, int D>
    void add(const persistent_manifold<S, D>& m) {
        add(m.cache);
        add(std::uint64_t{m.named} << 32 | static_cast<std::uint32_t>(m.count));
        for (std::int32_t i = 0; i < m.count; ++i) {
            add(m.points[i].on_a);
            add(m.points[i].on_b);
            add(std::uint64_t{m.points[i].feature});
        }
    }
    void add(const gjk_cache& c) {
        add(std::uint64_t{c.count});
        for (int i = 0; i < c.count; ++i) add(std::uint64_t{c.vertex[i]});
        for (const float x : c.axis) add(x);
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0x9e3779b97f4a7c15u;
};

/// One number for one thing: processors work on several at a time, and a difference can be traced to its thing.
template <class Item>
std::uint64_t hash_of(std::uint64_t name, const Item& item) {
    hasher h;
    h.add(name);
    h.add(item);
    return h.value();
}

/// Of what is remembered of a pair; 0 where that bears on no result, as of pairs that do not touch.
template <class S, int D>
std::uint64_t digest_of(const pair_memory<S, D>& m, std::uint64_t name) {
    return m.contact.count > 0 ? hash_of(name, m) : 0;
}
template <class S, int D>
std::uint64_t digest_of(const persistent_manifold<S, D>& m, std::uint64_t name) {
    return m.count > 0 ? hash_of(name, m) : 0;
}
template <class Memory>
    requires requires(const Memory& m) { m.digest(); }
std::uint64_t digest_of(const Memory& m, std::uint64_t name) {
    return m.digest() != 0 ? hash_of(name, m.digest()) : 0;
}

/// Of everything in a world that bears on its future, but for the settings: neither user data nor what only
/// saves work, like the boxes of the broadphase. The dimensions of a shape enter by its bounds.
template <class Plan>
std::uint64_t state_hash(const state<Plan>& s) {
    hasher h;
    const auto add_all = [&](const auto& pool) {
        h.add(std::uint64_t{pool.count()});
        pool.each([&](std::uint32_t i, const auto& item) {
            h.add(hash_of(std::uint64_t{i} << 32 | pool.generation(i), item));
        });
    };
    h.add(s.steps);
    add_all(s.bodies);
    add_all(s.shapes);
    h.add(std::uint64_t{s.contacts.size()});
    for (const auto& c : s.contacts) h.add(hash_of(std::uint64_t{c.shape_a} << 32 | c.shape_b, c));
    if constexpr (Plan::remembers)
        for (std::uint32_t i = 0; i < s.memories.pairs.size(); ++i) {
            const auto [a, b] = s.memories.pairs[i];
            const std::uint64_t digest = digest_of(s.memories.items[i], std::uint64_t{a} << 32 | b);
            if (digest != 0) h.add(digest);
        }
    return h.value();
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/queries.hpp
// =================================================================================================
// What can be asked of a world: rays, casts, overlaps, the closest thing.

PHYSICS_HPP_BEGIN

/// The shape that a ray or a moving shape meets first, and where, in world axes.
template <class S, int D>
struct world_hit {
    shape_id shape;
    body_id body;
    /// The part of the translation up to there; 0 if it begins in touch.
    S fraction = S(1);
    /// On the shape's surface.
    vec<S, D> point;
    /// Unit vector out of the shape; null where a ray begins within.
    vec<S, D> normal;

    /// True if anything is hit.
    explicit operator bool() const { return static_cast<bool>(shape); }
};

/// The shape closest to a point.
template <class S, int D>
struct nearest_shape {
    shape_id shape;
    body_id body;
    /// From the surface to the point (m); negative within.
    S distance{};
    /// On the surface.
    vec<S, D> point;
    /// Unit vector out of the shape.
    vec<S, D> normal;

    explicit operator bool() const { return static_cast<bool>(shape); }
};

namespace detail {

/// A point, as a shape to ask with.
template <class S, int D>
struct tip {};
template <class S, int D>
bool check(const tip<S, D>&, const char*) {
    return true;
}
template <class S, int D>
aabb<S, D> bounds(const tip<S, D>&, const transform<S, D>& at) {
    return {at.position, at.position};
}
template <class S, int D>
core<D> core_of(const tip<S, D>&) {
    return {};
}

template <class Plan>
shape_id id_of_shape(const state<Plan>& s, std::uint32_t i) {
    return {i, s.shapes.generation(i), s.tag};
}
template <class Plan>
body_id body_of_shape(const state<Plan>& s, std::uint32_t i) {
    const std::uint32_t b = s.shapes[i].body;
    return {b, s.bodies.generation(b), s.tag};
}

/// Calls f(shape's number) for shapes whose boxes reach into a box.
template <class Plan, class F>
void each_near(const state<Plan>& s, const aabb<typename Plan::scalar, Plan::dimension>& box,
               const query_filter& filter, F&& f) {
    if constexpr (requires { s.broadphase.each_overlapping(box, filter, f); }) {
        s.broadphase.each_overlapping(box, filter, f);
    } else {
        s.shapes.each([&](std::uint32_t i, const auto& shape) {
            if (filter.sees(filter_of(s, shape)) && overlap(needed_box(s, shape), box)) f(i);
        });
    }
}
/// Calls f(shape's number) for shapes whose boxes a ray meets; f returns the fraction up to which it goes on.
template <class Plan, class F>
void each_on(const state<Plan>& s, const ray<typename Plan::scalar, Plan::dimension>& r, const query_filter& filter,
             F&& f) {
    using S = typename Plan::scalar;
    if constexpr (requires { s.broadphase.each_along(r, filter, [](const proxy_hit<S>&) { return S(1); }); }) {
        s.broadphase.each_along(r, filter, [&](const proxy_hit<S>& hit) { return f(hit.id); });
    } else {
        S limit(1), at{};
        s.shapes.each([&](std::uint32_t i, const auto& shape) {
            if (limit >= S(0) && filter.sees(filter_of(s, shape)) && meets(r, needed_box(s, shape), limit, at))
                limit = min(limit, f(i));
        });
    }
}
template <class S, int D>
bool check_way(const char* function, const char* from, vec<S, D> origin, vec<S, D> translation) {
    return check_finite(function, from, origin) && check_finite(function, "translation", translation) &&
           check_finite(function, "end of the way", origin + translation);
}

template <class Plan, class Visit>
void cast_ray(const state<Plan>& s, const char* function, vec<typename Plan::scalar, Plan::dimension> origin,
              vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter, Visit&& visit) {
    using S = typename Plan::scalar;
    if (!check_way(function, "origin", origin, translation)) return;
    S limit(1);
    each_on(s, {origin, translation}, filter, [&](std::uint32_t i) {
        const auto hit = ray_cast(s.shapes[i].shape, world_pose(s, s.shapes[i]), origin, translation);
        if (hit && !(hit.fraction > limit))
            limit = min(limit, visit(world_hit<S, Plan::dimension>{id_of_shape(s, i), body_of_shape(s, i), hit.fraction,
                                                                   hit.point, hit.normal}));
        return limit;
    });
}

/// Whether the first of two hits comes first: the numbers of shapes decide where both come at once.
template <class Hit>
bool comes_first(const Hit& a, const Hit& b) {
    return !b || a.fraction < b.fraction || (a.fraction == b.fraction && a.shape.index < b.shape.index);
}

template <class Plan, class Shape>
world_hit<typename Plan::scalar, Plan::dimension> cast_shape(
    const state<Plan>& s, const Shape& shape, const transform<typename Plan::scalar, Plan::dimension>& pose,
    vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "cast_shape";
    world_hit<S, D> first;
    if (!check(shape, f) || !check_pose(f, pose.position, pose.rotation) ||
        !check_way(f, "position", pose.position, translation))
        return first;
    const aabb<S, D> box = bounds(shape, pose);
    const vec<S, D> middle = box.lower + (box.upper - box.lower) * S(0.5);
    each_on(s, {middle, translation, (box.upper - box.lower) * S(0.5)}, filter, [&](std::uint32_t i) {
        const transform<S, D> at = world_pose(s, s.shapes[i]);
        s.shapes[i].shape.visit([&](const auto& other) {
            const auto hit = shape_cast(other, shape, relative(at, pose), inverse_rotate(at.rotation, translation));
            const world_hit<S, D> found{id_of_shape(s, i), body_of_shape(s, i), hit.fraction, at * hit.point,
                                        at.rotation * hit.normal};
            if (hit && comes_first(found, first)) first = found;
        });
        return first ? first.fraction : S(1);
    });
    return first;
}

/// The separation of any shape and a convex one, if it is at most `reach`; else more than that.
template <class A, class B, class S, int D>
closest_points<S, D> separation_within(const A& a, const B& b, const transform<S, D>& b_in_a, S reach) {
    if constexpr (has_parts<A, D>) return separation(a, b, b_in_a, reach);
    else return separation(a, b, b_in_a);
}

template <class Plan, class Shape, class Visit>
void each_overlapping(const state<Plan>& s, const Shape& shape,
                      const transform<typename Plan::scalar, Plan::dimension>& pose, const query_filter& filter,
                      Visit&& visit) {
    using S = typename Plan::scalar;
    const char* f = "each_overlapping";
    if (!check(shape, f) || !check_pose(f, pose.position, pose.rotation)) return;
    each_near(s, bounds(shape, pose), filter, [&](std::uint32_t i) {
        const auto at = relative(world_pose(s, s.shapes[i]), pose);
        const bool touches = s.shapes[i].shape.visit(
            [&](const auto& other) { return !(separation_within(other, shape, at, S(0)).distance > S(0)); });
        if (touches) visit(id_of_shape(s, i));
    });
}

template <class Plan>
nearest_shape<typename Plan::scalar, Plan::dimension> closest_shape(const state<Plan>& s,
                                                                    vec<typename Plan::scalar, Plan::dimension> point,
                                                                    typename Plan::scalar reach,
                                                                    const query_filter& filter) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "closest_shape";
    nearest_shape<S, D> best;
    if (!check_finite(f, "point", point) || !check_not_negative(f, "reach", reach)) return best;
    each_near(s, grown(aabb<S, D>{point, point}, reach), filter, [&](std::uint32_t i) {
        const transform<S, D> at = world_pose(s, s.shapes[i]);
        s.shapes[i].shape.visit([&](const auto& other) {
            const auto c = separation_within(other, tip<S, D>{}, relative(at, transform<S, D>{point, {}}), reach);
            const bool nearer = !best || c.distance < best.distance ||
                                (c.distance == best.distance && i < best.shape.index);
            if (c.distance > reach || !nearer) return;
            best = {id_of_shape(s, i), body_of_shape(s, i), c.distance, at * c.on_a, at.rotation * c.normal};
        });
    });
    return best;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/ranges.hpp
// =================================================================================================
// What a loop over a world's bodies and contacts walks along.

PHYSICS_HPP_BEGIN

namespace detail {

/// Where a loop ends.
struct range_end {};

/// The bodies of a world, in the order of their numbers.
template <class Plan>
class body_range {
public:
    explicit body_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(s.bodies.next(at)) {}
        body_id operator*() const { return {at_, state_->bodies.generation(at_), state_->tag}; }
        iterator& operator++() {
            at_ = state_->bodies.next(at_ + 1);
            return *this;
        }
        bool operator==(range_end) const { return at_ == state_->bodies.slots(); }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, 0}; }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
};

/// The shapes of one body, the latest first.
template <class Plan>
class shape_range {
public:
    shape_range(const state<Plan>& s, std::uint32_t first) : state_(&s), first_(first) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(at) {}
        shape_id operator*() const { return {at_, state_->shapes.generation(at_), state_->tag}; }
        iterator& operator++() {
            at_ = state_->shapes[at_].next;
            return *this;
        }
        bool operator==(range_end) const { return at_ == 0xffffffffu; }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, first_}; }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
    std::uint32_t first_;
};

template <class Plan>
auto view_of(const state<Plan>& s, const contact<typename Plan::scalar, Plan::dimension>& c) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const body<S, D>& a = s.bodies[c.body_a];
    const body<S, D>& b = s.bodies[c.body_b];
    contact_view<S, D> view{
        {c.shape_a, s.shapes.generation(c.shape_a), s.tag}, {c.shape_b, s.shapes.generation(c.shape_b), s.tag},
        {c.body_a, s.bodies.generation(c.body_a), s.tag},   {c.body_b, s.bodies.generation(c.body_b), s.tag},
        c.part, c.normal, tangents<S, D>(c.normal), {}, c.count, c.friction, c.restitution};
    for (int k = 0; k < c.count; ++k) {
        const contact_point<S, D>& p = c.points[k];
        const vec<S, D> local_a = inverse_rotate(s.contact_starts[c.body_a].rotation, p.lever_a) + a.mass.center;
        const vec<S, D> local_b = inverse_rotate(s.contact_starts[c.body_b].rotation, p.lever_b) + b.mass.center;
        view.points[k] = {a.pose() * local_a, local_a,    local_b, p.separation, p.normal_impulse,
                          p.friction_impulse, p.persisted};
    }
    return view;
}

/// The contacts of a world's last step, in ascending order of their shapes' numbers.
template <class Plan>
class contact_range {
public:
    explicit contact_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(at) {}
        auto operator*() const { return view_of(*state_, state_->contacts[at_]); }
        iterator& operator++() {
            ++at_;
            return *this;
        }
        bool operator==(range_end) const { return at_ == state_->contacts.size(); }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, 0}; }
    range_end end() const { return {}; }
    /// Number of contacts.
    [[nodiscard]] std::uint32_t size() const { return state_->contacts.size(); }

private:
    const state<Plan>* state_;
};

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/step.hpp
// =================================================================================================
// One step of a world: the page to read first.

PHYSICS_HPP_BEGIN

namespace detail {

/// Broadphase: pairs of shapes whose boxes overlap, of two bodies of which one at least can be pushed: the filters that
/// shapes were inserted with say so.
template <class Plan>
const buffer<proxy_pair>& find_pairs(state<Plan>& s) {
    return s.broadphase.pairs([](std::uint32_t, std::uint32_t) { return true; });
}

/// The narrowphase wants the shape of the lower kind first.
template <class Plan>
proxy_pair in_order_of_kinds(const state<Plan>& s, proxy_pair p) {
    return s.shapes[p.a].shape.kind() > s.shapes[p.b].shape.kind() ? proxy_pair{p.b, p.a} : p;
}

/// Hands on what the last step remembered of the pairs that are still there. Both lists are in ascending order, so one
/// walk along both finds it. Gives the query of each pair.
template <class Plan>
auto* recall_pairs(state<Plan>& s, const buffer<proxy_pair>& pairs) {
    using narrowphase = typename Plan::narrowphase;
    auto* queries = s.scratch.template take<typename Plan::query>(pairs.size());
    s.found_memories.clear();
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
        const proxy_pair p = in_order_of_kinds(s, pairs[i]);
        const auto& a = s.shapes[p.a];
        const auto& b = s.shapes[p.b];
        new (queries + i) typename Plan::query{&a.shape, &b.shape, relative(world_pose(s, a), world_pose(s, b))};
        if constexpr (Plan::remembers) {
            if (!narrowphase::remembers(a.shape.kind(), b.shape.kind())) continue;
            const auto& [before, items] = s.memories;
            while (last < before.size() && before[last] < pairs[i]) ++last;
            const bool known = last < before.size() && before[last] == pairs[i];
            queries[i].memory = s.found_memories.pairs.size();
            s.found_memories.add(pairs[i], known ? items[last] : typename Plan::pair_memory{});
        }
    }
    return queries;
}

/// Narrowphase: contacts of the pairs that touch or nearly do, in the order of the pairs.
template <class Plan>
void find_contacts(state<Plan>& s, const buffer<proxy_pair>& pairs) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const auto* queries = recall_pairs(s, pairs);
    const S margin = s.settings.contact_margin;
    s.manifolds.clear();
    if constexpr (Plan::remembers)
        Plan::narrowphase::collide(queries, pairs.size(), margin, s.found_memories.items.begin(), s.manifolds);
    else
        Plan::narrowphase::collide(queries, pairs.size(), margin, s.manifolds);

    s.found.clear();
    for (const auto& [query, part, m] : s.manifolds) {
        const proxy_pair p = in_order_of_kinds(s, pairs[query]);
        const auto& a = s.shapes[p.a];
        const auto& b = s.shapes[p.b];
        const transform<S, D> pose = world_pose(s, a);
        const vec<S, D> from_a = pose.position - s.bodies[a.body].center;
        const vec<S, D> from_b = pose.position - s.bodies[b.body].center;
        contact<S, D> c{p.a, p.b, a.body, b.body, part, pose.rotation * m.normal, {}, m.count, S(0), S(0)};
        for (int k = 0; k < m.count; ++k) {
            const vec<S, D> at = pose.rotation * m.points[k].position;
            c.points[k].lever_a = from_a + at;
            c.points[k].lever_b = from_b + at;
            c.points[k].separation = m.points[k].separation;
            c.points[k].feature = m.points[k].feature;
        }
        c.friction = root<S>(product(a.material.friction, b.material.friction));
        c.restitution = max(a.material.restitution, b.material.restitution);
        s.found.push(c);
    }
}

/// Where bodies are as the step begins: what contacts refer to, and what a refused step goes back to.
template <class Plan>
void remember_poses(state<Plan>& s) {
    s.starts.resize(s.bodies.slots());
    s.bodies.each([&](std::uint32_t i, const auto& b) { s.starts[i] = {b.center, b.rotation}; });
}
template <class Plan>
void restore_poses(state<Plan>& s) {
    s.bodies.each([&](std::uint32_t i, auto& b) {
        b.center = s.starts[i].position;
        b.rotation = s.starts[i].rotation;
        refresh_boxes(s, i);
    });
}

/// What the solver sees of the bodies; bodies with a target pose get the velocity that reaches it.
template <class Plan>
auto* gather_bodies(state<Plan>& s, typename Plan::scalar h) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    auto* bodies = s.scratch.template take<solver_body<S, D>>(s.bodies.slots());
    s.bodies.each([&](std::uint32_t i, const body<S, D>& b) {
        new (bodies + i) solver_body<S, D>{b.velocity, b.inverse_mass, in_world(b.inverse_inertia, b.rotation)};
        if (!b.has_target) return;
        bodies[i].velocity.linear = (b.target * b.mass.center - b.center) / h;
        bodies[i].velocity.angular = rotation_vector(b.target.rotation * inverse(b.rotation)) / h;
    });
    return bodies;
}

/// How the solver moves the world: it asks for velocities and poses to advance, once or in substeps.
template <class Plan>
struct motion {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    state<Plan>& s;
    solver_body<S, D>* bodies;
    bool finite = true;

    void advance_velocities(S h) {
        s.bodies.each([&](std::uint32_t i, const body<S, D>& b) {
            if (b.is_dynamic()) Plan::integrator::advance_velocity(bodies[i], b, s.settings.gravity, h);
        });
    }
    void advance_poses(S h) {
        s.bodies.each([&](std::uint32_t i, body<S, D>& b) {
            twist<S, D>& v = bodies[i].velocity;
            if (b.type != body_type::static_body) Plan::integrator::advance_pose(b, v, h);
            finite =
                finite && is_finite(b.center) && is_finite(b.rotation) && is_finite(v.linear) && is_finite(v.angular);
        });
    }
};

/// Stores what the step found: velocities, contacts with their impulses. Forces act for one step, and bodies
/// that had a target stand still.
template <class Plan>
void finish(state<Plan>& s, const solver_body<typename Plan::scalar, Plan::dimension>* bodies) {
    s.bodies.each([&](std::uint32_t i, auto& b) {
        b.velocity = bodies[i].velocity;
        b.force = {};
        b.torque = {};
        if (!b.has_target) return;
        b.velocity = {};
        b.has_target = false;
    });
    s.contacts.swap(s.found);
    s.contact_starts.swap(s.starts);
    s.memories.swap(s.found_memories);
    ++s.steps;
}

/// Bounds: tells the broadphase where shapes are and where they are heading; bodies with a target are there, to the
/// bit. False if a box is beyond the scalar's range.
template <class Plan>
bool update_boxes(state<Plan>& s, const solver_body<typename Plan::scalar, Plan::dimension>* bodies,
                  typename Plan::scalar h) {
    bool fit = true;
    s.bodies.each([&](std::uint32_t i, auto& b) {
        if (b.type == body_type::static_body) return;
        if (b.has_target) b.set_pose(b.target);
        each_shape(s, i, [&](std::uint32_t k, const auto& shape) {
            const auto box = needed_box(s, shape);
            if (fit = fit && is_box(box); fit) s.broadphase.move(k, box, bodies[i].velocity.linear * h);
        });
    });
    update_broadphase(s);
    return fit;
}

/// Advances a world by h seconds. Each stage reads and writes plain arrays; only this function knows their
/// order. False, and the world as it was, if a velocity or a position would leave the range of numbers.
/// Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan>
PHYSICS_HPP_NOINLINE bool step(state<Plan>& s, typename Plan::scalar h) {
    s.scratch.reset();
    const auto& pairs = find_pairs(s);           // boxes             -> pairs, in order
    find_contacts(s, pairs);                     // pairs and poses   -> contacts with feature ids
    inherit_impulses(s.contacts, s.found);       // last step's       -> warm impulses of what persists
    remember_poses(s);                           // poses             -> where the step began
    auto* bodies = gather_bodies(s, h);          // bodies            -> what the solver sees of them
    motion<Plan> moving{s, bodies};
    Plan::solver::solve(bodies, s.found, s.settings.solver, h, s.scratch, moving);  // -> velocities, poses
    if (!moving.finite) return restore_poses(s), false;
    if (!update_boxes(s, bodies, h)) return restore_poses(s), false;  // poses -> boxes of what has moved
    finish(s, bodies);                           // results           -> bodies and contacts
    return true;
}

}  // namespace detail

PHYSICS_HPP_END

// =================================================================================================
// physics/world/world.hpp
// =================================================================================================
// The world: what users hold.

PHYSICS_HPP_BEGIN

/// A world of rigid bodies, made of what a recipe names.
///
/// SI units; x to the right, y up. Vectors, points and rotations are in world axes unless a name says
/// "local", which means the body's own frame. Change a world between steps only. Every function refuses bad
/// numbers and null, foreign or stale handles with physics::error (see there for builds without exceptions)
/// and then leaves the world as it was. A copy of a world is a world in the same state, and handles serve both; a
/// world that was moved from is empty.
/// Two worlds may be used on two threads. Functions cost O(1) unless they say otherwise.
template <class Recipe>
class world : public detail::shape_aliases<typename detail::plan_of<Recipe>::type::scalar,
                                           detail::plan_of<Recipe>::type::dimension> {
    using plan = typename detail::plan_of<Recipe>::type;
    static_assert(sizeof(detail::audit<Recipe>) > 0);

public:
    using scalar = typename plan::scalar;
    static constexpr int dimension = plan::dimension;
    using vec = physics::vec<scalar, dimension>;
    /// Angular velocity, torque...: a scalar in the plane, a vector in space.
    using angular = physics::angular<scalar, dimension>;
    using rotation = physics::rotation<scalar, dimension>;
    using transform = physics::transform<scalar, dimension>;
    using mass_properties = physics::mass_properties<scalar, dimension>;
    using settings_type = typename plan::settings;
    using body_def = physics::body_def<scalar, dimension>;
    using shape_def = physics::shape_def<scalar, dimension>;
    using contact_view = physics::contact_view<scalar, dimension>;
    using material = physics::material<scalar>;
    using any_shape = typename plan::shape;
    using world_hit = physics::world_hit<scalar, dimension>;
    using nearest_shape = physics::nearest_shape<scalar, dimension>;

    /// An empty world. Refuses settings out of range, and a build whose arithmetic would not give the same
    /// bits as every other (see float_environment).
    explicit world(const settings_type& settings = {}) {
        if (detail::check_settings(settings, "world") && detail::check_environment<scalar>("world"))
            detail::change_settings(state_, settings);
        state_.tag = detail::next_world_tag();
    }

    /// Advances time by dt seconds (greater than 0). Forces and torques act for this step and are then
    /// forgotten. Cost: see the policies. Refused, with nothing changed, if a number would leave its range.
    void step(scalar dt) {
        if (!detail::check_positive("step", "dt", dt)) return;
        const float_control_scope control;
        if (!detail::step(state_, dt))
            detail::refuse("step", "a velocity", "not finite",
                           "a force, a speed or a mass is beyond the scalar's range");
    }
    /// Number of steps taken.
    [[nodiscard]] std::uint64_t steps() const { return state_.steps; }
    /// A number that worlds in the same state share, on any machine. User data and settings do not enter.
    /// O(bodies + shapes + contacts).
    [[nodiscard]] std::uint64_t state_hash() const { return detail::state_hash(state_); }
    [[nodiscard]] const settings_type& settings() const { return state_.settings; }
    /// Changes the settings from the next step on.
    void set_settings(const settings_type& settings) {
        if (detail::check_settings(settings, "set_settings")) detail::change_settings(state_, settings);
    }

    /// Adds a body; shapes give it extent and, if it is dynamic, mass. Without mass from shapes it is a point of
    /// 1 kg that nothing turns.
    body_id create_body(const body_def& def = {}) { return detail::create_body(state_, def); }
    /// Removes a body with its shapes and contacts. O(shapes + contacts).
    void destroy_body(body_id id) {
        if (const auto b = find(id, "destroy_body")) detail::destroy_body(state_, b.index);
    }
    /// Adds a shape of the recipe's set to a body; unless the body's mass is set, it changes with it. Refuses a mass
    /// that the scalar cannot hold. O(shapes of the body), and O(contacts) where the centre of mass moves.
    template <class Shape>
    shape_id create_shape(body_id body, const Shape& shape, const shape_def& def = {}) {
        constexpr bool known = any_shape::template kind_of<Shape>() >= 0;
        static_assert(
            known,
            "physics::world::create_shape: the recipe's set of shapes lacks this one; name it in physics::shapes<...>");
        if constexpr (known) return detail::create_shape(state_, body, shape, def);
        else return {};
    }
    /// Removes a shape and its contacts. Refused where the rest's mass is one that the scalar cannot hold. O(contacts).
    void destroy_shape(shape_id id) {
        if (const auto s = detail::find_shape(state_, id, "destroy_shape")) detail::destroy_shape(state_, s.index);
    }
    /// True if the handle names a living thing of this world; never an error.
    [[nodiscard]] bool contains(body_id id) const {
        return id.world == state_.tag && state_.bodies.contains(id.index, id.generation);
    }
    [[nodiscard]] bool contains(shape_id id) const {
        return id.world == state_.tag && state_.shapes.contains(id.index, id.generation);
    }
    [[nodiscard]] std::uint32_t body_count() const { return state_.bodies.count(); }
    [[nodiscard]] std::uint32_t shape_count() const { return state_.shapes.count(); }

    /// All bodies: `for (physics::body_id b : world.bodies())`.
    [[nodiscard]] auto bodies() const { return detail::body_range<plan>(state_); }
    /// All shapes of a body.
    [[nodiscard]] auto shapes(body_id id) const {
        const auto b = find(id, "shapes");
        return detail::shape_range<plan>(state_, b ? state_.bodies[b.index].first_shape : 0xffffffffu);
    }
    /// All contacts of the last step, each as a contact_view.
    [[nodiscard]] auto contacts() const { return detail::contact_range<plan>(state_); }

    /// Where the body's frame is: origin, rotation, both; and where its centre of mass is.
    [[nodiscard]] vec position(body_id id) const {
        return get(id, "position", [](const auto& b) { return b.pose().position; });
    }
    [[nodiscard]] rotation orientation(body_id id) const {
        return get(id, "orientation", [](const auto& b) { return b.rotation; });
    }
    [[nodiscard]] transform pose(body_id id) const { return get(id, "pose", [](const auto& b) { return b.pose(); }); }
    [[nodiscard]] vec center_of_mass(body_id id) const {
        return get(id, "center_of_mass", [](const auto& b) { return b.center; });
    }
    /// Moves a body at once, without a path in between. Velocities stay.
    void set_pose(body_id id, vec position, const rotation& orientation) {
        const auto b = find(id, "set_pose");
        if (b && detail::check_pose("set_pose", position, orientation))
            detail::set_pose(state_, b.index, {position, normalized(orientation)});
    }
    void set_pose(body_id id, const transform& pose) { set_pose(id, pose.position, pose.rotation); }
    /// Lets a kinematic body reach a pose by the end of the next step, pushing what is in its way; then it stands.
    void move_to(body_id id, vec position, const rotation& orientation) {
        const auto b = detail::find_kinematic(state_, id, "move_to");
        if (!b || !detail::check_pose("move_to", position, orientation)) return;
        state_.bodies[b.index].target = {position, normalized(orientation)};
        state_.bodies[b.index].has_target = true;
    }
    void move_to(body_id id, const transform& pose) { move_to(id, pose.position, pose.rotation); }

    /// Velocity of the centre of mass (m/s), angular velocity (rad/s), velocity of the body at a point.
    [[nodiscard]] vec linear_velocity(body_id id) const {
        return get(id, "linear_velocity", [](const auto& b) { return b.velocity.linear; });
    }
    [[nodiscard]] angular angular_velocity(body_id id) const {
        return get(id, "angular_velocity", [](const auto& b) { return b.velocity.angular; });
    }
    [[nodiscard]] vec velocity_at(body_id id, vec point) const {
        const auto b = find(id, "velocity_at");
        if (!b || !detail::check_finite("velocity_at", "point", point)) return {};
        return physics::velocity_at(state_.bodies[b.index].velocity, point - state_.bodies[b.index].center);
    }
    /// Velocities of dynamic and kinematic bodies; static ones have none, and locked rotations stay at 0.
    void set_linear_velocity(body_id id, vec v) {
        const auto b = find_moving(id, "set_linear_velocity");
        if (b && detail::check_finite("set_linear_velocity", "v", v)) state_.bodies[b.index].velocity.linear = v;
    }
    void set_angular_velocity(body_id id, angular w) {
        const auto b = find_moving(id, "set_angular_velocity");
        if (b && detail::check_angular_velocity("set_angular_velocity", "w", w, state_.bodies[b.index].rotation_locked))
            state_.bodies[b.index].velocity.angular = w;
    }

    /// A force (N) on a dynamic body during the next step, at its centre of mass or at a point; "local"
    /// takes force and point in the body's frame. Forces add up; refused where the sum would leave the scalar's range.
    void apply_force(body_id id, vec force) { push(id, "apply_force", force, false, nullptr); }
    void apply_force_at(body_id id, vec force, vec point) { push(id, "apply_force_at", force, false, &point); }
    void apply_local_force(body_id id, vec force) { push(id, "apply_local_force", force, true, nullptr); }
    void apply_local_force_at(body_id id, vec force, vec point) {
        push(id, "apply_local_force_at", force, true, &point);
    }
    /// A torque (N m) during the next step.
    void apply_torque(body_id id, angular torque) {
        const auto b = dynamic(id, "apply_torque");
        if (!b || !detail::check_finite("apply_torque", "torque", torque)) return;
        auto& sum = state_.bodies[b.index].torque;
        if (!detail::assign(sum, sum + torque))
            detail::refuse_action("apply_torque", "torque", detail::size_of(torque));
    }
    /// Forgets the forces and torques that wait for the next step.
    void clear_forces(body_id id) {
        const auto b = dynamic(id, "clear_forces");
        if (!b) return;
        state_.bodies[b.index].force = {};
        state_.bodies[b.index].torque = {};
    }
    /// An impulse (N s): changes velocities at once.
    void apply_impulse(body_id id, vec impulse) { kick(id, "apply_impulse", impulse, false, nullptr); }
    void apply_impulse_at(body_id id, vec impulse, vec point) { kick(id, "apply_impulse_at", impulse, false, &point); }
    void apply_local_impulse(body_id id, vec impulse) { kick(id, "apply_local_impulse", impulse, true, nullptr); }
    void apply_local_impulse_at(body_id id, vec impulse, vec point) {
        kick(id, "apply_local_impulse_at", impulse, true, &point);
    }
    /// An angular impulse (N m s).
    void apply_angular_impulse(body_id id, angular impulse) {
        const auto at = dynamic(id, "apply_angular_impulse");
        if (!at || !detail::check_finite("apply_angular_impulse", "impulse", impulse)) return;
        auto& b = state_.bodies[at.index];
        if (!detail::assign(b.velocity.angular,
                            b.velocity.angular + times(in_world(b.inverse_inertia, b.rotation), impulse)))
            detail::refuse_action("apply_angular_impulse", "impulse", detail::size_of(impulse));
    }

    [[nodiscard]] body_type type(body_id id) const {
        const auto b = find(id, "type");
        return b ? state_.bodies[b.index].type : body_type::static_body;
    }
    /// Changes how a body moves; a static body loses its velocity. O(shapes + contacts).
    void set_type(body_id id, body_type type) {
        if (const auto b = find(id, "set_type")) detail::set_type(state_, b.index, type);
    }
    /// Mass (kg), centre (m) and inertia about it (kg m^2) in the body's frame. Static and kinematic bodies take none
    /// from their shapes: they have mass 0 and their centre at the origin.
    [[nodiscard]] mass_properties mass(body_id id) const {
        return get(id, "mass", [](const auto& b) { return b.mass; });
    }
    /// Sets them for a dynamic body, until reset_mass, whatever its shapes are; with an inertia of 0 nothing turns it.
    /// Refuses what the scalar cannot hold, and tensors that are not positive definite.
    void set_mass(body_id id, const mass_properties& mass) {
        if (const auto b = dynamic(id, "set_mass")) detail::set_mass(state_, b.index, mass);
    }
    /// Takes the mass from the shapes again. O(shapes).
    void reset_mass(body_id id) {
        if (const auto b = dynamic(id, "reset_mass")) detail::reset_mass(state_, b.index);
    }
    [[nodiscard]] scalar linear_damping(body_id id) const {
        return get(id, "linear_damping", [](const auto& b) { return b.linear_damping; });
    }
    [[nodiscard]] scalar angular_damping(body_id id) const {
        return get(id, "angular_damping", [](const auto& b) { return b.angular_damping; });
    }
    /// Rates (1/s), at least 0, at which the velocities of a dynamic body decay without force.
    void set_damping(body_id id, scalar linear_rate, scalar angular_rate) {
        const auto b = find(id, "set_damping");
        if (!b || !detail::check_not_negative("set_damping", "linear_rate", linear_rate) ||
            !detail::check_not_negative("set_damping", "angular_rate", angular_rate))
            return;
        state_.bodies[b.index].linear_damping = linear_rate;
        state_.bodies[b.index].angular_damping = angular_rate;
    }
    [[nodiscard]] scalar gravity_scale(body_id id) const {
        return get(id, "gravity_scale", [](const auto& b) { return b.gravity_scale; });
    }
    void set_gravity_scale(body_id id, scalar factor) {
        const auto b = find(id, "set_gravity_scale");
        if (b && detail::check_finite("set_gravity_scale", "factor", factor))
            state_.bodies[b.index].gravity_scale = factor;
    }
    [[nodiscard]] bool rotation_locked(body_id id) const {
        return get(id, "rotation_locked", [](const auto& b) { return b.rotation_locked; });
    }
    /// Locks or frees rotation; locking stops it.
    void set_rotation_locked(body_id id, bool locked) {
        if (const auto b = find(id, "set_rotation_locked")) detail::set_rotation_locked(state_, b.index, locked);
    }
    [[nodiscard]] std::uint64_t user_data(body_id id) const {
        return get(id, "user_data", [](const auto& b) { return b.user_data; });
    }
    void set_user_data(body_id id, std::uint64_t data) {
        if (const auto b = find(id, "set_user_data")) state_.bodies[b.index].user_data = data;
    }

    [[nodiscard]] body_id body(shape_id id) const {
        const auto s = detail::find_shape(state_, id, "body");
        if (!s) return {};
        const std::uint32_t b = state_.shapes[s.index].body;
        return {b, state_.bodies.generation(b), state_.tag};
    }
    /// The shape itself, and its pose in the body's frame: visit it to learn its kind.
    [[nodiscard]] any_shape shape(shape_id id) const { return get(id, "shape", [](const auto& s) { return s.shape; }); }
    [[nodiscard]] transform local_pose(shape_id id) const {
        return get(id, "local_pose", [](const auto& s) { return s.local; });
    }
    [[nodiscard]] material surface(shape_id id) const {
        return get(id, "surface", [](const auto& s) { return s.material; });
    }
    /// Changes a shape's material from the next step on.
    void set_surface(shape_id id, const material& m) {
        const auto s = detail::find_shape(state_, id, "set_surface");
        if (s && detail::check_material("set_surface", m)) state_.shapes[s.index].material = m;
    }
    [[nodiscard]] std::uint64_t user_data(shape_id id) const {
        return get(id, "user_data", [](const auto& s) { return s.user_data; });
    }
    void set_user_data(shape_id id, std::uint64_t data) {
        if (const auto s = detail::find_shape(state_, id, "set_user_data")) state_.shapes[s.index].user_data = data;
    }

    /// Queries see shapes where they are now; the filter says which (see query_filter). O(log shapes) where the
    /// broadphase answers queries, as those of the library do; else O(shapes).
    /// The first shape that a ray meets on its way from a point, along a translation (m); of several at once that of
    /// the least number.
    [[nodiscard]] world_hit cast_ray(vec origin, vec translation, const query_filter& filter = {}) const {
        world_hit first;
        detail::cast_ray(state_, "cast_ray", origin, translation, filter, [&](const world_hit& hit) {
            if (detail::comes_first(hit, first)) first = hit;
            return first.fraction;
        });
        return first;
    }
    /// Calls visit(hit) for shapes that the ray meets, in any order. visit returns the fraction of the translation up
    /// to which the ray goes on: hit.fraction for the closest, 1 for all, -1 to stop.
    template <class Visit>
    void each_on_ray(vec origin, vec translation, const query_filter& filter, Visit&& visit) const {
        detail::cast_ray(state_, "each_on_ray", origin, translation, filter, visit);
    }
    /// The first shape that a convex shape meets on its way from a pose along a translation, without turning.
    template <class Shape>
    [[nodiscard]] world_hit cast_shape(const Shape& shape, const transform& pose, vec translation,
                                       const query_filter& filter = {}) const {
        return detail::cast_shape(state_, shape, pose, translation, filter);
    }
    /// Calls visit(shape_id) for every shape that a convex shape at that pose touches or overlaps, in any order.
    template <class Shape, class Visit>
    void each_overlapping(const Shape& shape, const transform& pose, const query_filter& filter, Visit&& visit) const {
        detail::each_overlapping(state_, shape, pose, filter, visit);
    }
    /// Calls visit(shape_id) for every shape that holds a point, in any order.
    template <class Visit>
    void each_at(vec point, const query_filter& filter, Visit&& visit) const {
        if (detail::check_finite("each_at", "point", point))
            detail::each_overlapping(state_, detail::tip<scalar, dimension>{}, {point, {}}, filter, visit);
    }
    /// The shape closest to a point, none farther than `reach` (m).
    [[nodiscard]] nearest_shape closest_shape(vec point, scalar reach, const query_filter& filter = {}) const {
        return detail::closest_shape(state_, point, reach, filter);
    }

private:
    detail::found find(body_id id, const char* function) const { return detail::find_body(state_, id, function); }
    detail::found dynamic(body_id id, const char* function) const { return detail::find_dynamic(state_, id, function); }
    detail::found find_moving(body_id id, const char* function) const {
        return detail::find_moving(state_, id, function);
    }

    /// f of the thing that the handle names, or a default value after refusing the handle.
    template <class F>
    auto get(body_id id, const char* function, F&& f) const
        -> decltype(f(std::declval<const physics::body<scalar, dimension>&>())) {
        const auto b = find(id, function);
        return b ? f(state_.bodies[b.index]) : decltype(f(state_.bodies[0])){};
    }
    template <class F>
    auto get(shape_id id, const char* function, F&& f) const
        -> decltype(f(std::declval<const detail::shape_record<plan>&>())) {
        const auto s = detail::find_shape(state_, id, function);
        return s ? f(state_.shapes[s.index]) : decltype(f(state_.shapes[0])){};
    }
    void push(body_id id, const char* function, vec force, bool local, const vec* point) {
        detail::act(state_, id, function, "force", force, local, point, [](auto& b, vec f, vec lever) {
            const angular torque = b.torque + cross(lever, f);
            return is_finite(torque) && detail::assign(b.force, b.force + f) && detail::assign(b.torque, torque);
        });
    }
    void kick(body_id id, const char* function, vec impulse, bool local, const vec* point) {
        detail::act(state_, id, function, "impulse", impulse, local, point, [](auto& b, vec p, vec lever) {
            solver_body<scalar, dimension> v{b.velocity, b.inverse_mass, in_world(b.inverse_inertia, b.rotation)};
            v.apply(p, lever);
            return is_finite(v.velocity.linear) && detail::assign(b.velocity.angular, v.velocity.angular) &&
                   detail::assign(b.velocity.linear, v.velocity.linear);
        });
    }

    detail::state<plan> state_;
};

PHYSICS_HPP_END

// =================================================================================================
// physics/loop/accumulator.hpp
// =================================================================================================
// From the time of a frame to fixed steps: the accumulator.

PHYSICS_HPP_BEGIN

/// Numbers of an accumulator, in seconds.
template <class S>
struct accumulator_settings {
    /// Length of one step.
    S step = S(1.0 / 60);
    /// Time that one call may consume at most, 1 to 65536 steps; what a longer frame brings beyond it is dropped and
    /// reported.
    S longest_frame = S(0.25);
};

/// What one call of accumulator::advance did.
template <class S>
struct advance_report {
    /// Fixed steps taken.
    int steps = 0;
    /// Time that was dropped because the frame was too long or a step was refused (s); 0 in a healthy game.
    S dropped{};
};

namespace detail {
template <class World>
concept world_like = requires {
    typename World::scalar;
    typename World::transform;
};
}  // namespace detail

/// Does nothing: the default of the hooks around a step.
struct no_hook {
    template <class World>
    void operator()(World&) const {}
};

/// Advances a world in fixed steps by whatever time has really passed, so that the motion does not depend
/// on the frame rate. Time that does not fill a step is carried over; interpolated() shows the world in
/// between. It remembers the poses before the last step: 24 to 64 bytes a body.
/// Source: Fiedler, Fix Your Timestep! (2004).
template <class World>
class accumulator {
    static constexpr bool of_world = detail::world_like<World>;
    static_assert(
        of_world,
        "physics::accumulator: the argument is not a world; write physics::accumulator<physics::world<mine>>");
    // Any world does after the sentence above, so that it stays the only error.
    using world_type = std::conditional_t<of_world, World, world<recipe<float, 2>>>;

public:
    using scalar = typename world_type::scalar;
    using transform = typename world_type::transform;
    using settings_type = accumulator_settings<scalar>;

    /// Refuses a step that is not positive and a longest frame that is not 1 to 65536 steps.
    explicit accumulator(const settings_type& settings = {}) {
        if (!detail::check_positive("accumulator", "step", settings.step) ||
            !detail::check_finite("accumulator", "longest_frame", settings.longest_frame))
            return;
        if (settings.longest_frame < settings.step || settings.longest_frame / S(65536) > settings.step) {
            detail::refuse("accumulator", "longest_frame", static_cast<double>(settings.longest_frame),
                           "it must be 1 to 65536 steps");
            return;
        }
        settings_ = settings;
    }

    /// Consumes `elapsed` seconds (at least 0) of real time: calls before(world), world.step and
    /// after(world) for every whole step, and keeps the rest for the next call. A step that is refused, or a hook that
    /// throws, ends the call, and the time of the steps that were due is dropped: they are not tried again.
    template <class Before = no_hook, class After = no_hook>
    advance_report<scalar> advance(World& world, scalar elapsed, Before&& before = {}, After&& after = {}) {
        if (!detail::check_not_negative("advance", "elapsed", elapsed)) return {};
        advance_report<scalar> report;
        if (elapsed > settings_.longest_frame) {
            report.dropped = elapsed - settings_.longest_frame;
            elapsed = settings_.longest_frame;
        }
        int due = 0;
        for (rest_ += elapsed; !(rest_ < settings_.step); rest_ -= settings_.step) ++due;
        for (; report.steps < due; ++report.steps) {
            before(world);
            remember(world);
            const std::uint64_t steps = world.steps();
            world.step(settings_.step);
            if (world.steps() == steps) {  // refused, in a build without exceptions
                report.dropped += settings_.step * S(due - report.steps);
                break;
            }
            after(world);
        }
        return report;
    }

    /// How far real time is ahead of the last step, as a share of a step: 0 up to 1.
    [[nodiscard]] scalar factor() const { return rest_ / settings_.step; }
    /// Real time that waits for the next step (s).
    [[nodiscard]] scalar rest() const { return rest_; }
    [[nodiscard]] const settings_type& settings() const { return settings_; }

    /// The pose to draw: between the poses before and after the last step, by factor(). Bodies that are newer
    /// than the last step stand where they are. Turns by the shorter way, at constant speed.
    [[nodiscard]] transform interpolated(const World& world, body_id id) const {
        const transform now = world.pose(id);
        if (!(id.index < before_.size()) || !(before_[id.index].id == id) || !world.contains(id)) return now;
        const transform& then = before_[id.index].pose;
        const auto turn = rotation_vector(now.rotation * inverse(then.rotation));
        return {then.position + (now.position - then.position) * factor(), turned(then.rotation, turn * factor())};
    }

private:
    using S = scalar;
    struct memory {
        body_id id;
        transform pose;
    };

    void remember(const World& world) {
        before_.clear();
        for (const body_id id : world.bodies()) {
            before_.resize(id.index + 1);
            before_[id.index] = {id, world.pose(id)};
        }
    }

    settings_type settings_;
    scalar rest_{};
    buffer<memory> before_;
};

PHYSICS_HPP_END

#endif  // PHYSICS_HPP
