// What of a state lasts from step to step, named part by part: what an image of it is made of.
#pragma once

#include "physics/base/buffer.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Stands for whatever asks for parts.
struct asks_for_parts {
    template <class Part>
    void operator()(Part&) const;
};

/// A class whose `static void each_part(self, f)` calls f(part), for self const or not and always in the same order,
/// for everything in it that lasts from step to step: buffers, plain values, and other such classes. Copied as bytes to
/// another object, at other addresses, they must mean the same: no pointer is among them, unless somebody keeps what
/// it points to. Scratch, which no step hands to the next one, is no part. A class derived from one with parts says
/// anew which are its own.
template <class T>
concept names_parts = requires(T& self) {
    T::each_part(self, asks_for_parts{});
};

template <class T>
inline constexpr bool is_buffer = false;
template <class T>
inline constexpr bool is_buffer<buffer<T>> = true;

/// Calls f for each buffer and each plain value that something is made of, parts of parts included, in order.
template <class Part, class F>
void each_piece_of(Part& part, F&& f) {
    using T = std::remove_const_t<Part>;
    if constexpr (names_parts<T>) {
        T::each_part(part, [&](auto& inner) { each_piece_of(inner, f); });
    } else if constexpr (!std::is_empty_v<T>) {
        static_assert(is_buffer<T> || std::is_trivially_copyable_v<T>,
                      "physics::detail::each_piece_of: what lasts is a buffer, a plain value, or names its parts");
        f(part);
    }
}

}  // namespace detail

PHYSICS_HPP_END
