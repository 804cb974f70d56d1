// Coulomb friction at one point, and resistance to rolling: an interval in the plane, a circular cone in space.
#pragma once

#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How much a unit impulse along n at lever r changes the velocity along m at the same point, by rotation
/// alone, in the inverse format.
template <class S>
constexpr inverse_of<S> angular_answer(inverse_of<S> inverse_inertia, vec<S, 2> r, vec<S, 2> n, vec<S, 2> m) {
    using I = inverse_of<S>;
    return mul<I>(mul<I>(inverse_inertia, cross(r, n)), cross(r, m));
}
/// The change of angular velocity about b by an angular impulse about a.
template <class S>
constexpr inverse_of<S> torque_answer(const symmetric<inverse_of<S>>& inverse_inertia, vec<S, 3> a, vec<S, 3> b) {
    using I = inverse_of<S>;
    const auto& k = inverse_inertia;
    const I x = narrow<I>(product(k.xx, a.x) + product(k.xy, a.y) + product(k.xz, a.z));
    const I y = narrow<I>(product(k.xy, a.x) + product(k.yy, a.y) + product(k.yz, a.z));
    const I z = narrow<I>(product(k.xz, a.x) + product(k.yz, a.y) + product(k.zz, a.z));
    return narrow<I>(product(x, b.x) + product(y, b.y) + product(z, b.z));
}
template <class S>
constexpr inverse_of<S> angular_answer(const symmetric<inverse_of<S>>& inverse_inertia, vec<S, 3> r, vec<S, 3> n,
                                       vec<S, 3> m) {
    return torque_answer<S>(inverse_inertia, cross(r, n), cross(r, m));
}

/// Both bodies' answer along m to a unit impulse along n at a contact point, by rotation alone.
template <class S, int D, bool Turns>
constexpr inverse_of<S> answer([[maybe_unused]] const solver_body<S, D, Turns>& a,
                               [[maybe_unused]] const solver_body<S, D, Turns>& b,
                               [[maybe_unused]] const levers<S, D>& to, [[maybe_unused]] vec<S, D> n,
                               [[maybe_unused]] vec<S, D> m) {
    if constexpr (Turns)
        return angular_answer<S>(a.inverse_inertia, to.a, n, m) + angular_answer<S>(b.inverse_inertia, to.b, n, m);
    else return inverse_of<S>(0);
}

/// The effective mass along n: the impulse that changes the relative velocity along n by 1.
template <class S, int D, bool Turns>
constexpr S effective_mass(const solver_body<S, D, Turns>& a, const solver_body<S, D, Turns>& b, const levers<S, D>& to,
                           vec<S, D> n) {
    const inverse_of<S> k = a.inverse_mass + b.inverse_mass + answer(a, b, to, n, n);
    return k > inverse_of<S>(0) ? reciprocal<S>(k) : S(0);
}

}  // namespace detail

/// Friction of a point in the plane.
template <class S>
struct friction2 {
    S mass{};

    constexpr friction2() = default;
    template <bool Turns>
    constexpr friction2(const solver_body<S, 2, Turns>& a, const solver_body<S, 2, Turns>& b, const levers<S, 2>& to,
                        const tangents2<S>& frame)
        : mass(detail::effective_mass(a, b, to, frame.t)) {}

    /// The accumulated impulse that stops the slip v, or the largest that friction can give.
    [[nodiscard]] constexpr S next(S impulse, S v, S limit) const { return clamp(impulse - mass * v, -limit, limit); }
};

/// Two impulses about which only the length is limited, as friction along both tangents. Sticking is solved exactly,
/// by the inverse of their 2 x 2 answer. Slipping takes a gradient step, scaled by the largest eigenvalue, onto the
/// circular cone: its fixed point opposes the slip in any direction, which per-tangent limits do not.
template <class S>
struct circular_cone {
    S xx{}, xy{}, yy{};
    S slip{};

    constexpr circular_cone() = default;
    /// Of the speeds' answers to unit impulses.
    constexpr circular_cone(inverse_of<S> kxx, inverse_of<S> kxy, inverse_of<S> kyy) {
        using I = inverse_of<S>;
        const auto determinant = product(kxx, kyy) - product(kxy, kxy);
        if (!(determinant > wide_of<I>{})) return;
        xx = quotient<S>(kyy, determinant);
        yy = quotient<S>(kxx, determinant);
        xy = -quotient<S>(kxy, determinant);
        const I half = mul<I>(kxx - kyy, S(0.5));
        slip = reciprocal<S>(mul<I>(kxx + kyy, S(0.5)) + root<I>(product(half, half) + product(kxy, kxy)));
    }

    [[nodiscard]] constexpr vec<S, 2> next(vec<S, 2> impulse, vec<S, 2> v, S limit) const {
        const vec<S, 2> stick =
            impulse - vec<S, 2>{sum_of_products(xx, v.x, xy, v.y), sum_of_products(xy, v.x, yy, v.y)};
        const wide_of<S> most = product(limit, limit);
        if (!(length_squared(stick) > most)) return stick;
        const vec<S, 2> slide = impulse - v * slip;
        if (!(length_squared(slide) > most)) return slide;
        return normalized(slide) * limit;
    }
};

/// Friction of a point in space.
template <class S>
struct friction3 : circular_cone<S> {
    constexpr friction3() = default;
    template <bool Turns>
    constexpr friction3(const solver_body<S, 3, Turns>& a, const solver_body<S, 3, Turns>& b, const levers<S, 3>& to,
                        const tangents3<S>& frame)
        : circular_cone<S>(a.inverse_mass + b.inverse_mass + detail::answer(a, b, to, frame.t, frame.t),
                           detail::answer(a, b, to, frame.t, frame.u),
                           a.inverse_mass + b.inverse_mass + detail::answer(a, b, to, frame.u, frame.u)) {}
};

/// Friction of a point in D dimensions.
template <class S, int D>
using friction_at = std::conditional_t<D == 2, friction2<S>, friction3<S>>;

/// Resistance to rolling in the plane: a limited angular impulse about z.
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
/// Resistance to rolling in space: a limited angular impulse about both tangents.
template <class S>
struct rolling3 : circular_cone<S> {
    constexpr rolling3() = default;
    constexpr rolling3(const solver_body<S, 3>& a, const solver_body<S, 3>& b, const tangents3<S>& frame)
        : circular_cone<S>(both(a, b, frame.t, frame.t), both(a, b, frame.t, frame.u), both(a, b, frame.u, frame.u)) {}

    [[nodiscard]] static constexpr vec<S, 2> components(const tangents3<S>& frame, vec<S, 3> w) {
        return frame.components(w);
    }
    [[nodiscard]] static constexpr vec<S, 3> combine(const tangents3<S>& frame, vec<S, 2> w) {
        return frame.combine(w);
    }

private:
    static constexpr inverse_of<S> both(const solver_body<S, 3>& a, const solver_body<S, 3>& b, vec<S, 3> of,
                                        vec<S, 3> about) {
        return detail::torque_answer<S>(a.inverse_inertia, of, about) +
               detail::torque_answer<S>(b.inverse_inertia, of, about);
    }
};

/// Resistance to rolling in D dimensions.
template <class S, int D>
using rolling_at = std::conditional_t<D == 2, rolling2<S>, rolling3<S>>;

PHYSICS_HPP_END
