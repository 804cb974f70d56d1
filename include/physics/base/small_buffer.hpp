// A growable array whose first values are on the stack.
#pragma once

#include "physics/base/buffer.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Like a buffer, but takes memory from the heap only for more than Few values. Not copied.
template <class T, std::uint32_t Few>
class small_buffer {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    // Nothing is made yet of the few.
    small_buffer() {}  // NOLINT(modernize-use-equals-default)
    small_buffer(const small_buffer&) = delete;
    small_buffer& operator=(const small_buffer&) = delete;

    void push_back(const T& value) {
        if (size_ < Few) {
            new (static_cast<void*>(few_ + size_++)) T(value);
            return;
        }
        if (size_ == Few) {
            T* const all = many_.extend(Few);
            for (std::uint32_t i = 0; i < Few; ++i) all[i] = few_[i];
        }
        many_.push_back(value);
        ++size_;
    }
    [[nodiscard]] std::uint32_t size() const { return size_; }
    T* begin() { return size_ > Few ? many_.begin() : few_; }
    T* end() { return begin() + size_; }
    [[nodiscard]] const T* begin() const { return size_ > Few ? many_.begin() : few_; }
    [[nodiscard]] const T* end() const { return begin() + size_; }

private:
    union {
        T few_[Few];
    };
    buffer<T> many_;
    std::uint32_t size_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
