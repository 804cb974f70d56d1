// What a world keeps for its user.
#pragma once

#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

/// Values of a user's own types, in recipes that name them (see user_types): what is created begins with T{}. Null
/// where a handle is refused; an address is good until the next thing of that kind is created.
template <class World, class Plan>
class user_functions {
    using types = typename Plan::user_types;
    template <class T>
    static constexpr bool is_kept = !std::same_as<T, no_user_type>;

public:
    [[nodiscard]] auto* data(body_id id) requires(is_kept<typename types::body>) { return of_body(world(), id); }
    [[nodiscard]] const auto* data(body_id id) const requires(is_kept<typename types::body>) {
        return of_body(world(), id);
    }
    [[nodiscard]] auto* data(shape_id id) requires(is_kept<typename types::shape>) { return of_shape(world(), id); }
    [[nodiscard]] const auto* data(shape_id id) const requires(is_kept<typename types::shape>) {
        return of_shape(world(), id);
    }
    [[nodiscard]] auto* data(joint_id id) requires(is_kept<typename types::joint>&& Plan::has_joints) {
        return of_joint(world(), id);
    }
    [[nodiscard]] const auto* data(joint_id id) const requires(is_kept<typename types::joint>&& Plan::has_joints) {
        return of_joint(world(), id);
    }

private:
    auto& world() { return detail::world_access::data_of(static_cast<World&>(*this)); }
    const auto& world() const { return detail::world_access::data_of(static_cast<const World&>(*this)); }
    template <class Data>
    static auto of_body(Data& s, body_id id) {
        const detail::lookup at = detail::find_body(s, id, "data");
        return at ? &s.body_values.list[at.index] : nullptr;
    }
    template <class Data>
    static auto of_shape(Data& s, shape_id id) {
        const detail::lookup at = detail::find_shape(s, id, "data");
        return at ? &s.shape_values.list[at.index] : nullptr;
    }
    template <class Data>
    static auto of_joint(Data& s, joint_id id) {
        const detail::lookup at = detail::find_joint(s, id, "data");
        return at ? &s.joint_values.list[at.index] : nullptr;
    }
};

PHYSICS_HPP_END
