// What bodies weigh: from their shapes, or as they are told.
#pragma once

#include "physics/world/extents.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class T, class S>
rotation<T, 2> converted(const rotation<S, 2>& r) {
    return {static_cast<T>(r.cosine), static_cast<T>(r.sine)};
}
template <class T, class S>
rotation<T, 3> converted(const rotation<S, 3>& r) {
    return {static_cast<T>(r.x), static_cast<T>(r.y), static_cast<T>(r.z), static_cast<T>(r.w)};
}
template <class T, class S, int D>
vec<T, D> converted(vec<S, D> v) {
    vec<T, D> result;
    for (int i = 0; i < D; ++i) result[i] = static_cast<T>(v[i]);
    return result;
}
template <class T, class S, int D>
transform<T, D> converted(const transform<S, D>& t) {
    return {converted<T>(t.position), converted<T>(t.rotation)};
}
template <class T, scalar_type S>
T converted(S x) {
    return static_cast<T>(x);
}
template <class T, class S>
symmetric<T> converted(const symmetric<S>& m) {
    return {static_cast<T>(m.xx), static_cast<T>(m.yy), static_cast<T>(m.zz),
            static_cast<T>(m.xy), static_cast<T>(m.xz), static_cast<T>(m.yz)};
}
template <class T, class S, int D>
twist<T, D> converted(const twist<S, D>& v) {
    return {converted<T>(v.linear), converted<T>(v.angular)};
}
template <class T, class S, int D>
linear_twist<T, D> converted(const linear_twist<S, D>& v) {
    return {converted<T>(v.linear)};
}
template <class T, class S, int D>
mass_properties<T, D> converted(const mass_properties<S, D>& m) {
    return {static_cast<T>(m.mass), converted<T>(m.center), converted<T>(m.inertia)};
}

/// The mass of one shape in its body's frame, computed with the scalar T; none for shapes without mass.
template <class T, class Plan>
auto mass_of_shape(const shape_record<Plan>& record) {
    return record.shape.visit([&](const auto& shape) -> mass_properties<T, Plan::dimension> {
        if constexpr (solid_shape_for<std::remove_cvref_t<decltype(shape)>, typename Plan::scalar, Plan::dimension>)
            return transformed(mass_of(shape.template as<T>(), static_cast<T>(record.density)),
                               converted<T>(record.local));
        else return {};
    });
}
/// The mass of all shapes of a body but one, computed with the scalar T; or of one more, which is to be inserted next.
template <class T, class Plan>
auto mass_of_shapes(const state<Plan>& s, std::uint32_t body, std::uint32_t but = no_shape,
                    const shape_record<Plan>* more = nullptr) {
    mass_properties<T, Plan::dimension> sum;
    // In the order in which a body has its shapes, so that it is the sum that it will have, to the bit.
    const auto add_more = [&] { sum = combined(sum, mass_of_shape<T>(*std::exchange(more, nullptr))); };
    each_shape(s, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        if (more && i < s.shapes.next_index()) add_more();
        if (i != but) sum = combined(sum, mass_of_shape<T>(shape));
    });
    if (more) add_more();
    return sum;
}

/// An inertia as bodies turn by it: with what rounding makes of its largest moment as they turn added to all. A needle
/// 10,000 times as long as thick, whose least moment a float does not tell from that, would gain energy.
template <class S>
S as_turning(S inertia) {
    return inertia;
}
template <class S>
symmetric<S> as_turning(symmetric<S> inertia) {
    if constexpr (!is_fixed<S>) {
        const S more = S(4) * scalar_traits<S>::epsilon() * (inertia.xx + inertia.yy + inertia.zz);
        inertia.xx += more;
        inertia.yy += more;
        inertia.zz += more;
    }
    return inertia;
}

/// Gives a body its mass, its centre and what follows from them. The frame stays where it is, and the
/// velocity of the body's material points and the points of its contacts with it.
template <class Plan>
void set_mass_properties(state<Plan>& s, std::uint32_t index,
                         const mass_properties<typename Plan::scalar, Plan::dimension>& mass) {
    using S = typename Plan::scalar;
    auto& b = s.bodies[index];
    if (!(mass.center == b.mass.center)) {
        const vec<S, Plan::dimension> center = b.pose() * mass.center, shift = mass.center - b.mass.center;
        b.velocity.linear = velocity_at(b.velocity, center - b.center);
        b.center = center;
        const vec<S, Plan::dimension> turned_shift = s.contact_starts[index].rotation * shift;
        for (auto& c : s.contacts) {
            if (c.bodies.body_a == index) c.r_a -= turned_shift;
            if (c.bodies.body_b == index) c.r_b -= turned_shift;
        }
    }
    b.mass = mass;
    each_shape(s, index, [&](std::uint32_t, auto& shape) { update_pose(shape, b.pose(), b.center); });
    refresh_extent(s, index);
    b.inverse_mass = b.is_dynamic() ? reciprocal<inverse_of<S>>(mass.mass) : inverse_of<S>(0);
    if constexpr (Plan::rotates) {
        const bool rotates = b.is_dynamic() && !b.rotation_locked;
        const auto inertia = as_turning(mass.inertia);
        b.inverse_inertia = {};
        if (rotates) b.inverse_inertia = inverted_inertia(inertia);
        b.is_gyroscopic = rotates && !is_isotropic(mass.inertia);
        if (b.is_gyroscopic) b.spin = free_spin<S, Plan::dimension>(inertia);
    }
}
/// Mass from shapes, unless the user has set it. A dynamic body without any mass is a point of 1 kg at its
/// origin; static and kinematic bodies take no mass from shapes.
template <class Plan>
void refresh_mass(state<Plan>& s, std::uint32_t index) {
    using S = typename Plan::scalar;
    const auto& b = s.bodies[index];
    mass_properties<S, Plan::dimension> mass;
    if (b.mass_is_set) mass = b.mass;
    else if (b.is_dynamic()) mass = mass_of_shapes<S>(s, index);
    if (b.is_dynamic() && !(mass.mass > S(0))) mass = {S(1), {}, {}};
    set_mass_properties(s, index, mass);
}

}  // namespace detail

PHYSICS_HPP_END
