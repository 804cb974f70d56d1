// Bits by number.
#pragma once

#include "physics/base/buffer.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A growable array of bits: a flag for each of many things in little memory, so that looking up any is cheap.
class bit_array {
public:
    /// Makes room for bits below `size`, new ones clear.
    void grow(std::uint32_t size) {
        if ((size + 63) / 64 > words_.size()) words_.resize((size + 63) / 64, 0);
    }
    /// Takes the memory for that.
    void reserve(std::uint32_t size) { words_.reserve((size + 63) / 64); }
    /// Makes all bits clear, and takes their room.
    void clear() { words_.clear(); }
    [[nodiscard]] bool empty() const { return words_.empty(); }
    /// Whether there is room for a bit, and it is set.
    [[nodiscard]] bool has(std::uint32_t i) const { return i / 64 < words_.size() && (*this)[i]; }
    bool operator[](std::uint32_t i) const { return (words_[i / 64] >> i % 64 & 1) != 0; }
    void set(std::uint32_t i) { words_[i / 64] |= std::uint64_t{1} << i % 64; }
    void clear(std::uint32_t i) { words_[i / 64] &= ~(std::uint64_t{1} << i % 64); }

    PHYSICS_HPP_MEMBERS(words_)

private:
    buffer<std::uint64_t> words_;
};

}  // namespace detail

PHYSICS_HPP_END
