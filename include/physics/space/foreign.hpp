// Vectors of other libraries: what they look like, so that none of them is included.
#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How many components a type says that it has, in the manner of std::array or of Eigen; 0: it does not say.
template <class V>
constexpr int stated_size() {
    if constexpr (requires { std::tuple_size<V>::value; }) return static_cast<int>(std::tuple_size<V>::value);
    else if constexpr (requires { V::SizeAtCompileTime; }) return static_cast<int>(V::SizeAtCompileTime);
    else return 0;
}
/// Members x, y (and z) and no more, as those of glm, raylib, SDL and ImGui have.
template <class V, int D>
concept has_xyz = requires(const V& v) {
    {v.x + v.y};
}
&&requires(const V& v) { v.z; }
== (D == 3) && !requires(const V& v) { v.w; };
/// Components by index, as those of std::array and Eigen.
template <class V, int D>
concept has_indices = !has_xyz<V, D> && stated_size<V>() == D && requires(const V& v) {
    {v[0] + v[1]};
};
template <class V, int D>
concept has_components = std::is_class_v<V> &&(has_xyz<V, D> || has_indices<V, D>);

template <int I, class V, int D>
constexpr auto component_of(const V& v) {
    if constexpr (has_indices<V, D>) return v[I];
    else if constexpr (I == 0) return v.x;
    else if constexpr (I == 1) return v.y;
    else return v.z;
}
/// Whether its components are an S as they are.
template <class V, class S, int D>
concept has_components_of = has_components<V, D> && requires(const V& v) {
    { component_of<0, V, D>(v) } -> std::same_as<S>;
};

}  // namespace detail

PHYSICS_HPP_END
