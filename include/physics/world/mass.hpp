// What bodies weigh: from their shapes, or as they are told.
#pragma once

#include "physics/dynamics/convert.hpp"
#include "physics/step/extents.hpp"
#include "physics/world/world_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Keeps these of a body whose shapes or centre of mass have changed. O(shapes of the body).
template <class Plan>
void refresh_extent(world_data<Plan>& s, std::uint32_t index) {
    if constexpr (Plan::is_continuous) {
        s.continuous.extents.resize(s.bodies.slots());
        s.continuous.extents[index] = measure_body<Plan>(s.bodies, s.shapes, index);
    }
}
/// The same where nothing has changed but that a shape has come.
template <class Plan>
void extend_extent(world_data<Plan>& s, const shape_record<Plan>& shape) {
    if constexpr (Plan::is_continuous) {
        auto& extent = s.continuous.extents[shape.body];
        extent = merged(extent, measure_shape(shape, s.bodies[shape.body]));
    }
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
        if (i != but && !shape.sensor) sum = combined(sum, mass_of_shape<T>(shape));
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
void set_mass_properties(world_data<Plan>& s, std::uint32_t index,
                         const mass_properties<typename Plan::scalar, Plan::dimension>& mass) {
    using S = typename Plan::scalar;
    auto& b = s.bodies[index];
    if (!(mass.center == b.mass.center)) {
        const vec<S, Plan::dimension> center = b.pose() * mass.center, shift = mass.center - b.mass.center;
        b.velocity.linear = velocity_at(b.velocity, center - b.center);
        b.center = center;
        const vec<S, Plan::dimension> turned_shift = s.contact_starts[index].rotation * shift;
        const auto move = [&](auto& c) {
            if (c.bodies.body_a == index) c.r_a -= turned_shift;
            if (c.bodies.body_b == index) c.r_b -= turned_shift;
        };
        if (run_if_memory_lasts([&] { index_contacts(s); })) {
            each_contact(s, index, [&](auto& in, std::uint32_t at) { move(in[at]); });
        } else {
            for (auto& c : s.contacts) move(c);
            if constexpr (Plan::sleeps)
                for (auto& c : s.sleep.contacts) move(c);
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
void refresh_mass(world_data<Plan>& s, std::uint32_t index) {
    using S = typename Plan::scalar;
    const auto& b = s.bodies[index];
    const bool is_dynamic = b.given_type == body_type::dynamic_body;
    mass_properties<S, Plan::dimension> mass;
    if (b.mass_is_set) mass = b.mass;
    else if (is_dynamic) mass = mass_of_shapes<S>(s, index);
    if (is_dynamic && !(mass.mass > S(0))) mass = {S(1), {}, {}};
    set_mass_properties(s, index, mass);
}

}  // namespace detail

PHYSICS_HPP_END
