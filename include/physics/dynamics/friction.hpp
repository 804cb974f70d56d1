// Coulomb friction at one point, and resistance to rolling: an interval in 2D, a circular cone in 3D.
#pragma once

#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How much a unit impulse along n at lever r changes the velocity along m at the same point, by rotation
/// alone, in the inverse format.
template <class S>
constexpr inverse_of<S> angular_k_of_body(inverse_of<S> inverse_inertia, vec<S, 2> r, vec<S, 2> n, vec<S, 2> m) {
    using I = inverse_of<S>;
    return mul<I>(mul<I>(inverse_inertia, cross(r, n)), cross(r, m));
}
/// The change of angular velocity about b by an angular impulse about a.
template <class S>
constexpr inverse_of<S> torque_k(const symmetric<inverse_of<S>>& inverse_inertia, vec<S, 3> a, vec<S, 3> b) {
    using I = inverse_of<S>;
    const auto& k = inverse_inertia;
    const I x = narrow<I>(product(k.xx, a.x) + product(k.xy, a.y) + product(k.xz, a.z));
    const I y = narrow<I>(product(k.xy, a.x) + product(k.yy, a.y) + product(k.yz, a.z));
    const I z = narrow<I>(product(k.xz, a.x) + product(k.yz, a.y) + product(k.zz, a.z));
    return narrow<I>(product(x, b.x) + product(y, b.y) + product(z, b.z));
}
template <class S>
constexpr inverse_of<S> angular_k_of_body(const symmetric<inverse_of<S>>& inverse_inertia, vec<S, 3> r, vec<S, 3> n,
                                          vec<S, 3> m) {
    return torque_k<S>(inverse_inertia, cross(r, n), cross(r, m));
}

/// Both bodies' answer along m to a unit impulse along n at a contact point, by rotation alone.
template <class S, int D, bool Rotates>
constexpr inverse_of<S> angular_k([[maybe_unused]] const solver_body<S, D, Rotates>& a,
                                  [[maybe_unused]] const solver_body<S, D, Rotates>& b,
                                  [[maybe_unused]] const anchors<S, D>& to, [[maybe_unused]] vec<S, D> n,
                                  [[maybe_unused]] vec<S, D> m) {
    if constexpr (Rotates)
        return angular_k_of_body<S>(a.inverse_inertia, to.a, n, m) +
               angular_k_of_body<S>(b.inverse_inertia, to.b, n, m);
    else return inverse_of<S>(0);
}

/// The effective mass along n: the impulse that changes the relative velocity along n by 1.
template <class S, int D, bool Rotates>
constexpr S effective_mass(const solver_body<S, D, Rotates>& a, const solver_body<S, D, Rotates>& b,
                           const anchors<S, D>& to, vec<S, D> n) {
    const inverse_of<S> k = a.inverse_mass + b.inverse_mass + angular_k(a, b, to, n, n);
    return k > inverse_of<S>(0) ? reciprocal<S>(k) : S(0);
}

}  // namespace detail

namespace solver_api {

/// Friction of a point in 2D.
template <class S>
struct friction2 {
    S mass{};

    constexpr friction2() = default;
    template <bool Rotates>
    constexpr friction2(const solver_body<S, 2, Rotates>& a, const solver_body<S, 2, Rotates>& b,
                        const anchors<S, 2>& to, const tangents2<S>& frame)
        : mass(detail::effective_mass(a, b, to, frame.t)) {}

    /// The accumulated impulse that stops the slip v, or the largest that friction can give.
    [[nodiscard]] constexpr S next(S impulse, S v, S limit) const { return clamp(impulse - mass * v, -limit, limit); }
};

/// Two impulses about which only the length is limited, as friction along both tangents. Sticking is solved exactly,
/// by the inverse of their 2 x 2 answer. Slipping takes a gradient step, scaled by the largest eigenvalue, onto the
/// circular cone: its fixed point opposes the slip in any direction, which per-tangent limits do not.
template <class S>
struct friction_cone {
    S xx{}, xy{}, yy{};
    S gradient_step{};

    constexpr friction_cone() = default;
    /// Of the speeds' answers to unit impulses.
    constexpr friction_cone(inverse_of<S> kxx, inverse_of<S> kxy, inverse_of<S> kyy) {
        using I = inverse_of<S>;
        const auto determinant = product(kxx, kyy) - product(kxy, kxy);
        if (!(determinant > wide_of<I>{})) return;
        xx = quotient<S>(kyy, determinant);
        yy = quotient<S>(kxx, determinant);
        xy = -quotient<S>(kxy, determinant);
        const I half = mul<I>(kxx - kyy, S(0.5));
        gradient_step = reciprocal<S>(mul<I>(kxx + kyy, S(0.5)) + root<I>(product(half, half) + product(kxy, kxy)));
    }

    [[nodiscard]] constexpr vec<S, 2> next(vec<S, 2> impulse, vec<S, 2> v, S limit) const {
        const vec<S, 2> stick =
            impulse - vec<S, 2>{sum_of_products(xx, v.x, xy, v.y), sum_of_products(xy, v.x, yy, v.y)};
        const wide_of<S> maximum = product(limit, limit);
        if (!(length_squared(stick) > maximum)) return stick;
        const vec<S, 2> slide = impulse - v * gradient_step;
        if (!(length_squared(slide) > maximum)) return slide;
        return normalized(slide) * limit;
    }
};

/// Friction of a point in 3D.
template <class S>
struct friction3 : friction_cone<S> {
    constexpr friction3() = default;
    template <bool Rotates>
    constexpr friction3(const solver_body<S, 3, Rotates>& a, const solver_body<S, 3, Rotates>& b,
                        const anchors<S, 3>& to, const tangents3<S>& frame)
        : friction_cone<S>(a.inverse_mass + b.inverse_mass + detail::angular_k(a, b, to, frame.t, frame.t),
                           detail::angular_k(a, b, to, frame.t, frame.u),
                           a.inverse_mass + b.inverse_mass + detail::angular_k(a, b, to, frame.u, frame.u)) {}
};

/// Friction of a point in D dimensions.
template <class S, int D>
using friction_at = std::conditional_t<D == 2, friction2<S>, friction3<S>>;

/// Resistance to rolling in 2D: a limited angular impulse about z.
template <class S>
struct rolling2 {
    S inertia{};

    constexpr rolling2() = default;
    constexpr rolling2(const solver_body<S, 2>& a, const solver_body<S, 2>& b, const tangents2<S>&) {
        const inverse_of<S> k = a.inverse_inertia + b.inverse_inertia;
        if (k > inverse_of<S>(0)) inertia = reciprocal<S>(k);
    }

    /// The part of an angular quantity that is rolling, and back.
    [[nodiscard]] static constexpr S components(const tangents2<S>&, S w) { return w; }
    [[nodiscard]] static constexpr S combine(const tangents2<S>&, S w) { return w; }
    [[nodiscard]] constexpr S next(S impulse, S w, S limit) const {
        return clamp(impulse - inertia * w, -limit, limit);
    }
};
/// Resistance to rolling in 3D: a limited angular impulse about both tangents.
template <class S>
struct rolling3 : friction_cone<S> {
    constexpr rolling3() = default;
    constexpr rolling3(const solver_body<S, 3>& a, const solver_body<S, 3>& b, const tangents3<S>& frame)
        : friction_cone<S>(both(a, b, frame.t, frame.t), both(a, b, frame.t, frame.u), both(a, b, frame.u, frame.u)) {}

    [[nodiscard]] static constexpr vec<S, 2> components(const tangents3<S>& frame, vec<S, 3> w) {
        return frame.components(w);
    }
    [[nodiscard]] static constexpr vec<S, 3> combine(const tangents3<S>& frame, vec<S, 2> w) {
        return frame.combine(w);
    }

private:
    static constexpr inverse_of<S> both(const solver_body<S, 3>& a, const solver_body<S, 3>& b, vec<S, 3> of,
                                        vec<S, 3> about) {
        return detail::torque_k<S>(a.inverse_inertia, of, about) + detail::torque_k<S>(b.inverse_inertia, of, about);
    }
};

/// Resistance to rolling in D dimensions.
template <class S, int D>
using rolling_at = std::conditional_t<D == 2, rolling2<S>, rolling3<S>>;

}  // namespace solver_api

PHYSICS_HPP_END
