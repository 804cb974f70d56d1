// Every check of the user's handles and numbers: each refuses what is bad by name, and says whether all was good.
#pragma once

#include "physics/base/probe.hpp"
#include "physics/world/audit.hpp"
#include "physics/world/mass.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What a handle names: its number, where ok.
struct lookup {
    std::uint32_t index;
    bool ok;
    explicit operator bool() const { return ok; }
};
/// Refuses to change a world in the middle of its step, from an executor or a policy.
template <class Plan>
bool check_not_in_step(const world_data<Plan>& s, const char* function) {
    return !s.step.in_step.on || refuse(function, "world", "in a step", "it can be changed before and after");
}
/// A state that is not const is asked for in order to change it.
template <class State, class Pool, class Tag>
lookup find(State& s, const Pool& pool, handle<Tag> id, const char* function, const char* what) {
    if constexpr (!std::is_const_v<State>)
        if (!check_not_in_step(s, function)) return {0, false};
    if (!id) return {0, refuse(function, what, "null", "it must name something that this world has created")};
    char name[32];
    std::snprintf(name, sizeof name, "#%u", static_cast<unsigned>(id.index));
    if (id.world != s.tag) return {0, refuse(function, what, name, "it belongs to another world")};
    if (!pool.contains(id.index, id.generation)) return {0, refuse(function, what, name, "it has been destroyed")};
    return {id.index, true};
}
template <class State, class Pool, class Tag>
bool contains(const State& s, const Pool& pool, handle<Tag> id) {
    return id.world == s.tag && pool.contains(id.index, id.generation);
}
template <class State>
lookup find_body(State& s, body_id id, const char* function) {
    return find(s, s.bodies, id, function, "body");
}
template <class State>
lookup find_joint(State& s, joint_id id, const char* function) {
    return find(s, s.joints.records, id, function, "joint");
}
template <class State>
lookup find_shape(State& s, shape_id id, const char* function) {
    return find(s, s.shapes, id, function, "shape");
}
inline const char* name_of(body_type type) {
    return type == body_type::static_body ? "static" : type == body_type::kinematic_body ? "kinematic" : "dynamic";
}
/// The same for calls that only bodies of a type take, enabled or not,
template <class State>
lookup find_of_type(State& s, body_id id, const char* function, body_type type, const char* must) {
    const lookup f = find_body(s, id, function);
    if (f && s.bodies[f.index].given_type != type)
        return {0, refuse(function, "body", name_of(s.bodies[f.index].given_type), must)};
    return f;
}
template <class State>
lookup find_dynamic(State& s, body_id id, const char* function) {
    return find_of_type(s, id, function, body_type::dynamic_body, "it must be dynamic");
}
template <class State>
lookup find_kinematic(State& s, body_id id, const char* function) {
    return find_of_type(s, id, function, body_type::kinematic_body, "it must be kinematic");
}
/// only enabled ones,
template <class State>
lookup if_enabled(State& s, const lookup& f, const char* function) {
    if (f && !s.bodies[f.index].enabled) return {0, refuse(function, "body", "disabled", "it must be enabled")};
    return f;
}
/// and only those that have a velocity.
template <class State>
lookup find_moving(State& s, body_id id, const char* function) {
    const lookup f = find_body(s, id, function);
    if (f && s.bodies[f.index].given_type == body_type::static_body)
        return {0, refuse(function, "body", "static", "it must be dynamic or kinematic")};
    return f;
}

template <class S, int D>
bool check_pose(const char* function, vec<S, D> position, const rotation<S, D>& r) {
    if (!check_in_range(function, "position", position)) return false;
    // In double, where the squares of no format overflow.
    const double error = norm_error(converted<double>(r));
    return error < 1e-3 ||
           refuse(function, "error of rotation", error, "its squared length must be 1, to less than 0.001");
}
template <class Angular>
bool check_angular_velocity(const char* function, const char* field, Angular w, bool rotation_locked) {
    if (!check_in_range(function, field, w)) return false;
    return !rotation_locked || w == Angular{} ||
           refuse(function, field, largest_magnitude(w), "it must be 0, since the body's rotation is locked");
}
inline bool check_type(const char* function, body_type type) {
    return type <= body_type::dynamic_body ||
           refuse(function, "type", static_cast<double>(type), "it must be a body_type");
}
template <class S, int D>
bool check_body(const body_def<S, D>& def) {
    const char* f = "create_body";
    return check_type(f, def.type) && check_pose(f, def.position, def.rotation) &&
           check_in_range(f, "linear_velocity", def.linear_velocity) &&
           check_angular_velocity(f, "angular_velocity", def.angular_velocity, def.rotation_locked) &&
           check_not_negative(f, "linear_damping", def.linear_damping) &&
           check_not_negative(f, "angular_damping", def.angular_damping) &&
           check_in_range(f, "gravity_scale", def.gravity_scale);
}
/// A recipe without rotation takes none.
template <class Plan, class Angular, class S>
bool check_turn(const char* function, Angular velocity, S damping) {
    return Plan::rotates || (check_left_out(function, "angular_velocity", velocity) &&
                             check_left_out(function, "angular_damping", damping));
}
/// A recipe that looks after no body takes no flag.
template <class Plan>
bool check_continuous(const char* function, bool continuous) {
    return !continuous || Plan::is_continuous ||
           refuse(function, "continuous", "true", "the recipe leaves continuous collision out");
}
/// What messages call the parts of a material.
struct names_of_material {
    const char *friction, *restitution, *rolling_resistance, *surface_velocity;
};
inline constexpr names_of_material material_of_shape = {"friction", "restitution", "rolling_resistance",
                                                        "surface_velocity"};
inline constexpr names_of_material material_of_settings = {"material.friction", "material.restitution",
                                                           "material.rolling_resistance", "material.surface_velocity"};
template <class Plan, class S, int D>
bool check_material(const char* function, const material<S, D>& m, const names_of_material& name = material_of_shape) {
    using features = typename Plan::features;
    if (!check_not_negative(function, name.friction, m.friction) ||
        !check_not_negative(function, name.restitution, m.restitution) ||
        !check_not_negative(function, name.rolling_resistance, m.rolling_resistance) ||
        !check_finite(function, name.surface_velocity, m.surface_velocity))
        return false;
    return (features::restitution || check_left_out(function, name.restitution, m.restitution)) &&
           (features::rolling_resistance || check_left_out(function, name.rolling_resistance, m.rolling_resistance)) &&
           (features::surface_velocity || check_left_out(function, name.surface_velocity, m.surface_velocity));
}
template <class Plan>
bool check_settings(const typename Plan::settings& with, const char* function) {
    if constexpr (!Plan::features::materials)
        if (!check_material<Plan>(function, with.material, material_of_settings)) return false;
    return check_in_range(function, "gravity", with.gravity) &&
           check_not_negative(function, "contact_margin", with.contact_margin) && check(with.broadphase, function) &&
           check(with.solver, function) && check(with.sleeping, function) && check(with.events, function);
}

/// Refuses to make a world of floating-point numbers where arithmetic would not give the same bits as
/// everywhere. What the step itself repairs, rounding modes and flushing to zero, is no reason to refuse.
template <class S>
bool check_environment([[maybe_unused]] const char* function) {
#ifndef PHYSICS_HPP_NONDETERMINISTIC
    if constexpr (std::floating_point<S>) {
        const float_control_scope control;
        const auto faults = float_environment();
        if (faults != 0)
            return refuse(function, "arithmetic", float_fault_names(faults).c_str(),
                          "compile without the flags that allow it, or define PHYSICS_HPP_NONDETERMINISTIC");
    }
#endif
    return true;
}

/// True if the type can hold the positive value to one percent: it is not rounded away, and leaves room for the
/// rounding of other ways to compute it below the end of the range.
template <class S>
bool representable(double value) {
    if (!(value < 0.9375 * static_cast<double>(scalar_traits<S>::max()))) return false;
    const double error = static_cast<double>(static_cast<S>(value)) / value - 1;
    return error <= 0.01 && error >= -0.01;
}
template <class S>
bool check_mass_value(const char* function, const char* field, double value, double inverse_value) {
    if (!(value > 0)) return refuse(function, field, value, "it must be greater than 0");
    if (!representable<S>(value) || !representable<inverse_of<S>>(inverse_value))
        return refuse(function, field, value,
                      "it or its inverse is beyond the scalar's range; use other units of length or mass");
    return true;
}
template <class S>
bool check_inertia(const char* function, double inertia) {
    return check_mass_value<S>(function, "inertia", inertia, 1 / inertia);
}
template <class S>
bool check_inertia(const char* function, const symmetric<double>& i) {
    if (!check_finite(function, "inertia.xy", i.xy) || !check_finite(function, "inertia.xz", i.xz) ||
        !check_finite(function, "inertia.yz", i.yz))
        return false;
    const symmetric<double> inverted = inverse<double>(i);
    const double diagonal[] = {i.xx, i.yy, i.zz}, of_inverse[] = {inverted.xx, inverted.yy, inverted.zz};
    constexpr const char* names[] = {"inertia.xx", "inertia.yy", "inertia.zz"};
    for (int k = 0; k < 3; ++k)
        if (!check_mass_value<S>(function, names[k], diagonal[k], inverted.xx > 0 ? of_inverse[k] : 1 / diagonal[k]))
            return false;
    if (!(inverted.xx > 0) || !(inverted_inertia(converted<S>(i)).xx > inverse_of<S>(0)))
        return refuse(function, "inertia.xx", i.xx, "the tensor that it begins must be positive definite");
    // About an axis between those of the frame a body may turn more easily than about any of them, or less.
    const double maximum = i.xx + i.yy + i.zz, minimum = 1 / (inverted.xx + inverted.yy + inverted.zz);
    if (representable<S>(maximum) && representable<S>(minimum) && representable<inverse_of<S>>(1 / minimum) &&
        representable<inverse_of<S>>(1 / maximum))
        return true;
    const principal_axes principal = principal_axes_of(i);
    for (const double moment : principal.moments)
        if (!check_mass_value<S>(function, "principal moment of inertia", moment, 1 / moment)) return false;
    return true;
}
template <class Quantity>
struct scalar_in {
    using type = Quantity;
};
template <class S, int D>
struct scalar_in<vec<S, D>> {
    using type = S;
};
/// The scalar of a number or vector.
template <class Quantity>
using scalar_of = typename scalar_in<Quantity>::type;

/// Whether what was computed may become state: in fixed point, which wraps on the way, it must be near the exact value.
template <scalar_type S>
bool is_representable(S x, double exact) {
    const double error = static_cast<double>(x) - exact, slack = 1e-3 * (1 + (exact < 0 ? -exact : exact));
    return is_in_range(x) && (!is_fixed<S> || (error <= slack && error >= -slack));
}
template <class S, int D>
bool is_representable(const vec<S, D>& v, const vec<double, D>& exact) {
    for (int i = 0; i < D; ++i)
        if (!is_representable(v[i], exact[i])) return false;
    return true;
}
/// Where a point of a body is in the world, if that is in range: says whether.
template <class S, int D>
bool has_point(const transform<S, D>& pose, const vec<S, D>& local) {
    return is_representable(pose * local, converted<double>(pose) * converted<double>(local));
}
/// Whether the velocity of a body at r from its centre of mass is in range.
template <class Twist, class S, int D>
bool has_velocity_at(const Twist& v, const vec<S, D>& r) {
    return is_representable(velocity_at(v, r), velocity_at(converted<double>(v), converted<double>(r)));
}

/// Whether a dynamic body can have these mass properties, given in double, where it is now.
template <class S, int D, bool Rotates>
bool check_mass(const char* function, const body<S, D, Rotates>& b, const mass_properties<double, D>& m,
                bool without_inertia = !Rotates) {
    if (!check_mass_value<S>(function, "mass", m.mass, 1 / m.mass)) return false;
    if (!without_inertia && !check_inertia<S>(function, m.inertia)) return false;
    const vec<S, D> center = converted<S>(m.center), moved = b.pose() * center;
    return (is_representable(center, m.center) && has_point(b.pose(), center) &&
            has_velocity_at(b.velocity, moved - b.center)) ||
           refuse(function, "center", largest_magnitude(m.center),
                  "the body's centre of mass or its velocity would be beyond the scalar's range");
}
/// Whether matter can be spread so that a body has this inertia, to a thousandth: no principal moment is above the sum
/// of the two others.
inline bool check_spread(const char*, double) { return true; }
inline bool check_spread(const char* function, const symmetric<double>& i) {
    // Then half the trace less the tensor is positive.
    const double half = 0.501 * (i.xx + i.yy + i.zz), a = half - i.xx, b = half - i.yy, c = half - i.zz;
    return (a > 0 && a * b > i.xy * i.xy &&
            a * (b * c - i.yz * i.yz) > i.xy * (i.xy * c + i.xz * i.yz) + i.xz * (i.xy * i.yz + b * i.xz)) ||
           refuse(function, "inertia.xx", i.xx,
                  "no principal moment of the tensor that it begins may be above the sum of the two others");
}
/// The inertia about one of the axes.
template <class S>
double moment(S inertia, int) {
    return static_cast<double>(inertia);
}
template <class S>
double moment(const symmetric<S>& i, int axis) {
    return static_cast<double>(axis == 0 ? i.xx : axis == 1 ? i.yy : i.zz);
}
/// Whether the scalar's own sums come near those in double: if not, one has left its range on the way.
template <class S, int D>
bool check_sums(const char* function, const mass_properties<S, D>& sums, const mass_properties<double, D>& exact) {
    const auto agree = [](double x, double y, double size) { return x - y <= 0.25 * size && y - x <= 0.25 * size; };
    bool sound = agree(static_cast<double>(sums.mass), exact.mass, exact.mass);
    for (int k = 0; k < D; ++k) {
        sound =
            sound && agree(static_cast<double>(sums.center[k]), exact.center[k], 1 + largest_magnitude(exact.center));
        sound = sound && agree(moment(sums.inertia, k), moment(exact.inertia, k), moment(exact.inertia, k));
    }
    return sound || refuse(function, "mass", exact.mass,
                           "it or its moments leave the scalar's range on the way; use other units of length or mass");
}
/// Whether a dynamic body can take its mass from its shapes, but one, or with one more.
template <class Plan>
bool check_shapes_mass(const state<Plan>& s, std::uint32_t body, const char* function, std::uint32_t but = no_shape,
                       const shape_record<Plan>* more = nullptr) {
    const auto exact = mass_of_shapes<double>(s, body, but, more);
    if (!more && !(exact.mass > 0)) return true;
    return check_mass(function, s.bodies[body], exact) &&
           check_sums(function, mass_of_shapes<typename Plan::scalar>(s, body, but, more), exact);
}
/// Whether a box lies within the scalar's range: ends that have wrapped are on the wrong side.
template <class S, int D>
bool check_extent(const char* function, const aabb<S, D>& box) {
    if (!check_bounded(function, "lower end of the box", box.lower) ||
        !check_bounded(function, "upper end of the box", box.upper))
        return false;
    return is_box(box) ||
           refuse(function, "size of the box", "too large", "both ends must lie within the scalar's range");
}

}  // namespace detail

PHYSICS_HPP_END
