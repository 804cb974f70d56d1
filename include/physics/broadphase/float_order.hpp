// Floats as integers that sort alike.
#pragma once

#include <cstring>

#include "physics/base/sort.hpp"

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
    static constexpr std::uint32_t capacity = 512;

    void add(float x) { keys_[count_++] = std::uint64_t{to_ordered(x)} << 32; }
    void sort() {
        std::uint64_t scratch[capacity];
        const std::uint64_t* sorted = radix_sort(keys_, scratch, count_, 32, 64);
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
    std::uint64_t keys_[capacity];
    std::uint32_t count_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
