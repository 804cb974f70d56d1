// The members of a struct, listed once: what snapshots, the hash and whoever compares two states are made of.
#pragma once

#include <type_traits>

#include "physics/base/config.hpp"

/// Lists all data members of a struct, in the order in which they are declared: one more or less does not compile.
/// Gives it each_member(self, f), which calls f(member) for each, of const and other structs, and member_names.
/// For structs whose data is all in one class of the hierarchy.
#define PHYSICS_HPP_MEMBERS(...)                              \
    static constexpr const char* member_names = #__VA_ARGS__; \
    template <class Self, class F>                            \
    static constexpr void each_member(Self& self, F&& f) {    \
        auto& [__VA_ARGS__] = self;                           \
        ::physics::detail::call_with_each(f, __VA_ARGS__);    \
    }

PHYSICS_HPP_BEGIN

namespace detail {

template <class F, class... Members>
constexpr void call_with_each(F& f, Members&... members) {
    (f(members), ...);
}

/// Stands for whatever asks for members.
struct member_visitor {
    template <class Member>
    void operator()(Member&) const;
};

/// A class that lists its members, or whose each_member(self, f) calls f(member) for const and non-const self and
/// always in the same order. What lasts from step to step is buffers, plain values, and other such classes. They are
/// copied as bytes, also to other addresses, so they hold no pointers, except to memory that something else keeps
/// alive.
template <class T>
concept names_members = requires(T& self) {
    T::each_member(self, member_visitor{});
};

/// What does not last: snapshots leave it out.
template <class T>
concept scratch_member = requires {
    typename T::is_scratch;
};

}  // namespace detail

PHYSICS_HPP_END
