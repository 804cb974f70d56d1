// A growable array of plain values: what all state of a world is made of.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

#include "physics/base/error.hpp"
#include "physics/base/members.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Twice the capacity of a block of values of that size, or what is needed; one function for the buffers of all types.
/// Where there is no memory, refused if it is needed, else null.
PHYSICS_HPP_COLD inline void* reallocate(void* data, std::uint32_t& capacity, std::uint64_t needed, std::size_t size,
                                         bool must) {
    const std::uint64_t maximum = UINT32_MAX < SIZE_MAX / size ? UINT32_MAX : SIZE_MAX / size;
    std::uint64_t count = capacity < 8 ? 16 : std::uint64_t{capacity} * 2;
    if (count < needed) count = needed;
    if (count > maximum && needed <= maximum) count = maximum;
    void* grown = count > maximum ? nullptr : std::realloc(data, static_cast<std::size_t>(count) * size);
    if (grown == nullptr && !must) return nullptr;
    if (grown == nullptr) refuse_memory("buffer", static_cast<double>(count) * static_cast<double>(size));
    capacity = static_cast<std::uint32_t>(count);
    return grown;
}

}  // namespace detail

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
    T* data() { return data_; }
    [[nodiscard]] const T* data() const { return data_; }
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
    /// False where there is no memory for so many, and it is not needed.
    [[nodiscard]] bool try_reserve(std::uint32_t capacity, bool must) {
        if (capacity <= capacity_) return true;
        void* const grown = detail::reallocate(data_, capacity_, capacity, sizeof(T), must);
        if (grown != nullptr) data_ = static_cast<T*>(grown);
        return grown != nullptr;
    }
    /// Adds a copy of value at the end; the value may lie within the buffer.
    T& push_back(const T& value) {
        if (size_ == capacity_) return push_back_grown(value);
        return *new (static_cast<void*>(data_ + size_++)) T(value);
    }
    /// Adds T{parts...} at the end; nothing of it may lie within the buffer.
    template <class... Parts>
    T& emplace_back(Parts&&... parts) {
        if (size_ == capacity_) grow_to(std::uint64_t{size_} + 1);
        return *new (static_cast<void*>(data_ + size_++)) T{static_cast<Parts&&>(parts)...};
    }
    /// Room for so many values more at the end, for the caller to make there.
    T* extend(std::uint32_t count) {
        reserve(size_ + count);
        size_ += count;
        return end() - count;
    }
    void pop_back() { --size_; }
    /// Shortens the buffer, or fills it up with copies of value, which may lie within the buffer.
    void resize(std::uint32_t size, const T& value = T{}) {
        const T copy = value;
        reserve(size);
        for (std::uint32_t i = size_; i < size; ++i) new (static_cast<void*>(data_ + i)) T(copy);
        size_ = size;
    }

private:
    static_assert(alignof(T) <= alignof(std::max_align_t));

    // What grows may move the value away from under the caller.
    PHYSICS_HPP_COLD T& push_back_grown(const T& value) {
        const T copy = value;
        grow_to(std::uint64_t{size_} + 1);
        return *new (static_cast<void*>(data_ + size_++)) T(copy);
    }

    PHYSICS_HPP_COLD void grow_to(std::uint64_t needed) {
        data_ = static_cast<T*>(detail::reallocate(data_, capacity_, needed, sizeof(T), true));
    }

    T* data_ = nullptr;
    std::uint32_t size_ = 0;
    std::uint32_t capacity_ = 0;
};

/// An array of T with data() and size(), as std::vector, std::array, std::span and buffer are.
template <class Array, class T>
concept array_of = requires(const Array& a) {
    { a.data() } -> std::convertible_to<const T*>;
    { a.size() } -> std::convertible_to<std::size_t>;
};

namespace detail {

/// Whether an array is no longer than counts reach; refused by the name of a field.
template <class Array>
bool check_count(const char* function, const char* field, const Array& a) {
    return static_cast<std::size_t>(a.size()) <= 0xfffffffeu ||
           refuse(function, field, static_cast<double>(a.size()), "there may be 4,294,967,294 at most");
}
/// The same, where there must be just so many values in rows.
template <class Array>
bool check_grid(const char* function, const char* field, const Array& a, std::uint32_t columns, std::uint32_t rows) {
    return static_cast<std::uint64_t>(a.size()) == std::uint64_t{columns} * rows ||
           refuse(function, field, static_cast<double>(a.size()), "there must be columns times rows");
}
template <class Array>
std::uint32_t count_of(const Array& a) {
    return static_cast<std::uint32_t>(a.size());
}

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
    PHYSICS_HPP_MEMBERS(value_)
    T operator++() { return ++value_; }
    T operator--() { return --value_; }

private:
    T value_{};
};

/// How many values of a list is_before(value) is true of, where those come first. O(log n).
template <class T, class IsBefore>
std::uint32_t count_before(const buffer<T>& in, IsBefore&& is_before) {
    std::uint32_t at = 0;
    for (std::uint32_t size = in.size(); size > 0;) {
        const std::uint32_t half = size / 2;
        const bool before = is_before(in[at + half]);
        at += before ? half + 1 : 0;
        size = before ? size - half - 1 : half;
    }
    return at;
}

/// A T that lasts for a step: copies of it begin empty, and assigning leaves its memory as it is.
template <class T>
struct step_scratch : T {
    using is_scratch = void;

    step_scratch() = default;
    step_scratch(const step_scratch&) : T() {}
    step_scratch(step_scratch&&) noexcept = default;
    step_scratch& operator=(const step_scratch&) {
        if constexpr (requires(T & t) { t.forget(); }) T::forget();
        return *this;
    }
    step_scratch& operator=(step_scratch&&) noexcept = default;
};

/// A value that snapshots leave out; copies have it.
template <class T>
struct unsaved {
    using is_scratch = void;

    T value{};

    constexpr operator T() const { return value; }
};

template <class T>
inline constexpr bool is_buffer = false;
template <class T>
inline constexpr bool is_buffer<buffer<T>> = true;

/// Calls f for each buffer and each plain value that something is made of, members of members included, in order;
/// scratch is left out.
template <class Member, class F>
void each_value_of(Member& member, F&& f) {
    using T = std::remove_const_t<Member>;
    if constexpr (scratch_member<T>) {
        return;
    } else if constexpr (names_members<T>) {
        T::each_member(member, [&](auto& inner) { each_value_of(inner, f); });
    } else if constexpr (std::is_array_v<T> && !std::is_trivially_copyable_v<T>) {
        for (auto& element : member) each_value_of(element, f);
    } else if constexpr (!std::is_empty_v<T>) {
        static_assert(is_buffer<T> || std::is_trivially_copyable_v<T>,
                      "physics::detail::each_value_of: what lasts is a buffer, a plain value, or names its members");
        f(member);
    }
}

}  // namespace detail

PHYSICS_HPP_END
