// What of a state lasts from step to step, named part by part: what a snapshot of it is made of.
#pragma once

#include "physics/base/buffer.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Stands for whatever asks for parts.
struct member_visitor {
    template <class Member>
    void operator()(Member&) const;
};

/// A class whose `static void each_member(self, f)` calls f(member), for const and non-const self and always in the
/// same order, for every member that lasts from step to step: buffers, plain values, and other such classes. They are
/// copied as bytes, also to other addresses, so they hold no pointers, except to memory that something else keeps
/// alive. Scratch is no member. A derived class with members of its own names them anew.
template <class T>
concept names_members = requires(T& self) {
    T::each_member(self, member_visitor{});
};

template <class T>
inline constexpr bool is_buffer = false;
template <class T>
inline constexpr bool is_buffer<buffer<T>> = true;

/// Calls f for each buffer and each plain value that something is made of, parts of parts included, in order.
template <class Member, class F>
void each_value_of(Member& member, F&& f) {
    using T = std::remove_const_t<Member>;
    if constexpr (names_members<T>) {
        T::each_member(member, [&](auto& inner) { each_value_of(inner, f); });
    } else if constexpr (!std::is_empty_v<T>) {
        static_assert(is_buffer<T> || std::is_trivially_copyable_v<T>,
                      "physics::detail::each_piece_of: what lasts is a buffer, a plain value, or names its parts");
        f(member);
    }
}

}  // namespace detail

PHYSICS_HPP_END
