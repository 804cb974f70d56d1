// Arrays inside of a block of geometry.
#pragma once

#include "physics/shape/geometry.hpp"

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
