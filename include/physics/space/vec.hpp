// Vectors of two and three components, and their products.
#pragma once

#include "physics/base/math.hpp"
#include "physics/base/scalar.hpp"
#include "physics/space/foreign.hpp"

PHYSICS_HPP_BEGIN

/// A vector of D scalars with the members x, y (and z).
template <class S, int D>
struct vec;

namespace detail {
/// Plain numbers that may fill a vector of S, so that `{0, -10}` serves every scalar.
template <class T, class S>
concept literal_for = std::is_arithmetic_v<T> && !std::same_as<T, S>;
/// Such a number as S, through double where S takes nothing nearer.
template <class S, class T>
constexpr S from_literal(T x) {
    if constexpr (std::constructible_from<S, T>) return static_cast<S>(x);
    else return static_cast<S>(static_cast<double>(x));
}
}  // namespace detail

template <class S>
struct vec<S, 2> {
    S x{}, y{};

    constexpr vec() = default;
    constexpr vec(S x_, S y_) : x(x_), y(y_) {}
    template <class A, class B>
        requires detail::literal_for<A, S> || detail::literal_for<B, S>
    constexpr vec(A x_, B y_) : x(detail::from_literal<S>(x_)), y(detail::from_literal<S>(y_)) {}
    /// From a vector of another library, with members x and y, or two components by index.
    template <class V>
        requires(!std::same_as<V, vec>)
    &&detail::has_components<V, 2> constexpr explicit(!detail::has_components_of<V, S, 2>) vec(const V& v)
        : x(static_cast<S>(detail::component_of<0, V, 2>(v))),
    y(static_cast<S>(detail::component_of<1, V, 2>(v))) {}

    static constexpr int size = 2;
    constexpr S& operator[](int i) { return i == 0 ? x : y; }
    constexpr const S& operator[](int i) const { return i == 0 ? x : y; }
    static constexpr vec filled(S value) { return {value, value}; }

    constexpr vec& operator+=(vec b) {
        x += b.x;
        y += b.y;
        return *this;
    }
    constexpr vec& operator-=(vec b) {
        x -= b.x;
        y -= b.y;
        return *this;
    }
    constexpr vec& operator*=(S s) {
        x *= s;
        y *= s;
        return *this;
    }
    friend bool operator==(vec, vec) = default;
};

template <class S>
constexpr vec<S, 2> operator+(vec<S, 2> a, vec<S, 2> b) {
    return {a.x + b.x, a.y + b.y};
}
template <class S>
constexpr vec<S, 2> operator-(vec<S, 2> a, vec<S, 2> b) {
    return {a.x - b.x, a.y - b.y};
}
template <class S>
constexpr vec<S, 2> operator-(vec<S, 2> a) {
    return {-a.x, -a.y};
}
template <class S>
constexpr vec<S, 2> operator*(vec<S, 2> a, std::type_identity_t<S> s) {
    return {a.x * s, a.y * s};
}
template <class S>
constexpr vec<S, 2> operator/(vec<S, 2> a, std::type_identity_t<S> s) {
    return {a.x / s, a.y / s};
}

template <class S>
struct vec<S, 3> {
    S x{}, y{}, z{};

    constexpr vec() = default;
    constexpr vec(S x_, S y_, S z_) : x(x_), y(y_), z(z_) {}
    template <class A, class B, class C>
        requires detail::literal_for<A, S> || detail::literal_for<B, S> || detail::literal_for<C, S>
    constexpr vec(A x_, B y_, C z_)
        : x(detail::from_literal<S>(x_)), y(detail::from_literal<S>(y_)), z(detail::from_literal<S>(z_)) {}
    /// From a vector of another library, with members x, y and z, or three components by index.
    template <class V>
        requires(!std::same_as<V, vec>)
    &&detail::has_components<V, 3> constexpr explicit(!detail::has_components_of<V, S, 3>) vec(const V& v)
        : x(static_cast<S>(detail::component_of<0, V, 3>(v))),
    y(static_cast<S>(detail::component_of<1, V, 3>(v))), z(static_cast<S>(detail::component_of<2, V, 3>(v))) {}

    static constexpr int size = 3;
    constexpr S& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr const S& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    static constexpr vec filled(S value) { return {value, value, value}; }

    constexpr vec& operator+=(vec b) {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    constexpr vec& operator-=(vec b) {
        x -= b.x;
        y -= b.y;
        z -= b.z;
        return *this;
    }
    constexpr vec& operator*=(S s) {
        x *= s;
        y *= s;
        z *= s;
        return *this;
    }
    friend bool operator==(vec, vec) = default;
};

template <class S>
constexpr vec<S, 3> operator+(vec<S, 3> a, vec<S, 3> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class S>
constexpr vec<S, 3> operator-(vec<S, 3> a, vec<S, 3> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class S>
constexpr vec<S, 3> operator-(vec<S, 3> a) {
    return {-a.x, -a.y, -a.z};
}
template <class S>
constexpr vec<S, 3> operator*(vec<S, 3> a, std::type_identity_t<S> s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class S>
constexpr vec<S, 3> operator/(vec<S, 3> a, std::type_identity_t<S> s) {
    return {a.x / s, a.y / s, a.z / s};
}
template <class S, int D>
constexpr vec<S, D> operator*(std::type_identity_t<S> s, vec<S, D> a) {
    return a * s;
}

/// A vector as one of another library: physics::to<glm::vec3>(world.position(body)).
template <class V, class S, int D>
    requires detail::has_components<V, D>
constexpr V to(const vec<S, D>& v) {
    V r{};
    const auto set = [](auto& component, S x) { component = static_cast<std::remove_cvref_t<decltype(component)>>(x); };
    if constexpr (detail::has_indices<V, D>) {
        set(r[0], v.x);
        set(r[1], v.y);
        if constexpr (D == 3) set(r[2], v.z);
    } else {
        set(r.x, v.x);
        set(r.y, v.y);
        if constexpr (D == 3) set(r.z, v.z);
    }
    return r;
}

/// Angular quantities (velocity, impulse, torque): a scalar in 2D, counter-clockwise; a vector in 3D.
template <class S, int D>
using angular = std::conditional_t<D == 2, S, vec<S, 3>>;

/// a * b + c * d, rounded once where S can.
template <class S>
constexpr S sum_of_products(S a, S b, S c, S d) {
    return narrow<S>(product(a, b) + product(c, d));
}
/// a * b - c * d, rounded once where S can.
template <class S>
constexpr S difference_of_products(S a, S b, S c, S d) {
    return narrow<S>(product(a, b) - product(c, d));
}

/// The dot product, not rounded where S can.
template <class S>
constexpr wide_of<S> wide_dot(vec<S, 2> a, vec<S, 2> b) {
    return product(a.x, b.x) + product(a.y, b.y);
}
template <class S>
constexpr wide_of<S> wide_dot(vec<S, 3> a, vec<S, 3> b) {
    return product(a.x, b.x) + product(a.y, b.y) + product(a.z, b.z);
}
/// The dot product.
template <class S, int D>
constexpr S dot(vec<S, D> a, vec<S, D> b) {
    return narrow<S>(wide_dot(a, b));
}

/// The cross product: in 2D its one component, positive where b lies counter-clockwise of a.
template <class S>
constexpr S cross(vec<S, 2> a, vec<S, 2> b) {
    return difference_of_products(a.x, b.y, a.y, b.x);
}
template <class S>
constexpr vec<S, 3> cross(vec<S, 3> a, vec<S, 3> b) {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}
/// The velocity at lever r of a body that turns with w; in 3D it is cross(w, r).
template <class S>
constexpr vec<S, 2> cross(S w, vec<S, 2> r) {
    return {-(w * r.y), w * r.x};
}

/// The squared length, not rounded where S can: compare it with other wide numbers.
template <class S, int D>
constexpr wide_of<S> length_squared(vec<S, D> v) {
    return wide_dot(v, v);
}
/// The length.
template <class S, int D>
constexpr S length(vec<S, D> v) {
    return root<S>(length_squared(v));
}

/// The largest component by magnitude.
template <class S>
constexpr S largest(vec<S, 2> v) {
    return max(abs(v.x), abs(v.y));
}
template <class S>
constexpr S largest(vec<S, 3> v) {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

/// A vector as unit direction and length.
template <class S, int D>
struct direction_and_length {
    vec<S, D> direction;
    S length{};
};

/// Splits a vector into direction and length; a null vector gives a null direction. Scales by the largest
/// component first, so that neither tiny nor huge vectors lose their direction to underflow or overflow.
// By reference: with -flto, g++ 12 drops what is stored for an argument that is handed on by value in memory.
template <class S, int D>
constexpr direction_and_length<S, D> direction_and_length_of(const vec<S, D>& v) {
    const S scale = largest(v);
    if (!(scale > S(0))) return {};
    const vec<S, D> scaled = v / scale;
    const S scaled_length = length(scaled);
    return {scaled / scaled_length, scaled_length * scale};
}

/// The unit vector along v; the null vector for the null vector.
template <class S, int D>
constexpr vec<S, D> normalized(const vec<S, D>& v) {
    return direction_and_length_of(v).direction;
}

/// A unit vector across the unit vector n; in 2D n turned clockwise by a quarter.
template <class S>
constexpr vec<S, 2> perpendicular(vec<S, 2> n) {
    return {n.y, -n.x};
}
template <class S>
constexpr vec<S, 3> perpendicular(vec<S, 3> n) {
    // The branch keeps the longer of two candidates, so that its length is at least sqrt(1/2).
    return abs(n.x) > abs(n.z) ? normalized(vec<S, 3>{-n.y, n.x, S(0)}) : normalized(vec<S, 3>{S(0), -n.z, n.y});
}

template <class S>
constexpr vec<S, 2> min(vec<S, 2> a, vec<S, 2> b) {
    return {min(a.x, b.x), min(a.y, b.y)};
}
template <class S>
constexpr vec<S, 3> min(vec<S, 3> a, vec<S, 3> b) {
    return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class S>
constexpr vec<S, 2> max(vec<S, 2> a, vec<S, 2> b) {
    return {max(a.x, b.x), max(a.y, b.y)};
}
template <class S>
constexpr vec<S, 3> max(vec<S, 3> a, vec<S, 3> b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <class S>
constexpr vec<S, 2> abs(vec<S, 2> v) {
    return {abs(v.x), abs(v.y)};
}
template <class S>
constexpr vec<S, 3> abs(vec<S, 3> v) {
    return {abs(v.x), abs(v.y), abs(v.z)};
}
template <class S>
constexpr bool is_finite(vec<S, 2> v) {
    return is_finite(v.x) && is_finite(v.y);
}
template <class S>
constexpr bool is_finite(vec<S, 3> v) {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}

PHYSICS_HPP_END
