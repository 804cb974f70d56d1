// An array whose elements are not initialised.
#pragma once

#include <concepts>
#include <type_traits>

#include "physics/base/config.hpp"

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
