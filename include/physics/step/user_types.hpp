// Types of a user's own on bodies, shapes and joints.
#pragma once

#include <type_traits>

#include "physics/base/buffer.hpp"
#include "physics/base/stage.hpp"

PHYSICS_HPP_BEGIN

/// Stands for no type of a user's.
struct no_user_type {};

/// What a user's own types are, of which a world keeps one value for each body, shape or joint: user_types<actor>,
/// user_types<actor, surface>, user_types<no_user_type, no_user_type, lock>. Plain values without pointers into
/// themselves, which copies and snapshots of the world have too; they enter no hash. Default: none, at no cost.
template <class Body = no_user_type, class Shape = no_user_type, class Joint = no_user_type>
struct user_types {
    using stage = physics::stage::user_types;
    using body = Body;
    using shape = Shape;
    using joint = Joint;
    template <class T>
    static constexpr bool is_plain = std::is_trivially_copyable_v<T>&& std::is_default_constructible_v<T>;
    static constexpr bool are_plain = is_plain<Body> && is_plain<Shape> && is_plain<Joint>;
};

namespace detail {

/// A value of a user's type by number. `Of` tells the lists of a world apart.
template <class Of, class T>
struct user_values {
    buffer<T> list;
    PHYSICS_HPP_MEMBERS(list)

    void reserve(std::uint32_t count) { list.reserve(count); }
    /// Makes room for a number, and begins anew there.
    void start(std::uint32_t i) {
        if (i >= list.size()) list.resize(i + 1);
        list[i] = T{};
    }
};
template <class Of>
struct user_values<Of, no_user_type> {
    void reserve(std::uint32_t) {}
    void start(std::uint32_t) {}
};

}  // namespace detail

PHYSICS_HPP_END
