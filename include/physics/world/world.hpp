// The world: what users hold.
#pragma once

#include "physics/world/body_functions.hpp"
#include "physics/world/contact_functions.hpp"
#include "physics/world/energy.hpp"
#include "physics/world/joints.hpp"
#include "physics/world/query_functions.hpp"
#include "physics/world/user_functions.hpp"
#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

/// A world of rigid bodies, made of what a recipe names.
///
/// SI units; x to the right, y up. Vectors, points and rotations are in world axes unless a name says
/// "local", which means the body's own frame. Change a world between steps; loops over it, and visitors of its queries,
/// may change it too. Every function refuses bad numbers and null, foreign or stale handles with physics::error (see
/// there for builds without exceptions) and then leaves the world as it was. A copy of a world is a world in the same
/// state, and handles serve both; a world that was moved from is empty. Two worlds may be used on two threads.
/// Functions cost O(1) unless they say otherwise, and O(bodies + shapes of the island) where they wake one.
///
/// Plan follows from the recipe and is never written. It makes two recipes of the same name in two units two types.
template <class Recipe, class Plan = typename detail::plan_of<Recipe>::type>
class world : public detail::shape_aliases<typename detail::plan_of<Recipe>::type::scalar,
                                           detail::plan_of<Recipe>::type::dimension>,
              public joint_functions<world<Recipe, Plan>, typename detail::plan_of<Recipe>::type>,
              public query_functions<world<Recipe, Plan>, typename detail::plan_of<Recipe>::type>,
              public contact_functions<world<Recipe, Plan>, typename detail::plan_of<Recipe>::type>,
              public body_functions<world<Recipe, Plan>, typename detail::plan_of<Recipe>::type>,
              public user_functions<world<Recipe, Plan>, typename detail::plan_of<Recipe>::type> {
    friend detail::world_access;
    using plan = typename detail::plan_of<Recipe>::type;
    using of_joints = joint_functions<world, plan>;
    using code = detail::world_code<plan>;
    static_assert(sizeof(detail::audit<Recipe>) > 0);
    static_assert(std::same_as<plan, Plan>, "physics::world: the second argument is not for you; write world<mine>");

public:
    using scalar = typename plan::scalar;
    static constexpr int dimension = plan::dimension;
    using vec = physics::vec<scalar, dimension>;
    /// Angular velocity, torque...: a scalar in 2D, a vector in 3D.
    using angular = physics::angular<scalar, dimension>;
    using rotation_type = physics::rotation<scalar, dimension>;
    using transform = physics::transform<scalar, dimension>;
    using mass_properties = physics::mass_properties<scalar, dimension>;
    using settings_type = typename plan::settings;
    using body_def = physics::body_def<scalar, dimension>;
    using shape_def = typename plan::shape_def;
    using contact_view = physics::contact_view<scalar, dimension>;
    using material_type = physics::material<scalar, dimension>;
    using any_shape = typename plan::shape;
    /// The kinds of joints of the recipe.
    using joint_list = typename plan::joints;
    using world_hit = physics::world_hit<scalar, dimension>;
    using closest_hit = physics::closest_hit<scalar, dimension>;
    using ray_query = physics::ray_query<scalar, dimension>;
    using shape_query = physics::shape_query<scalar, dimension>;
    using shape_contact = physics::shape_contact<scalar, dimension>;
    using of_joints::contains, of_joints::user_data, of_joints::set_user_data;
    using user_functions<world, plan>::data;

    /// An empty world. Refuses settings out of range, and a build whose arithmetic would not give the same
    /// bits as every other (see float_environment).
    explicit world(const settings_type& settings = {}) {
        if (detail::check_settings<plan>(settings, "world") && detail::check_environment<scalar>("world"))
            code::change_settings(data_, settings);
        data_.tag = {detail::next_world_tag()};
    }

    /// Advances time by dt seconds (greater than 0). Forces and torques act for this step and are then
    /// forgotten. Steps may differ in length: none from 1 us to 1/15 s throws what rests. Cost: see the policies.
    /// Refused, with nothing changed, if a number would leave its range.
    void step(scalar dt) { code::step(data_, dt, {}); }
    /// The same, with the work shared out by an executor, such as a thread_pool; the bits do not depend on it.
    template <executor Executor>
    void step(scalar dt, Executor& by) {
        code::step(data_, dt, {by, data_.step.tasks_done, data_.step.batch_scratch});
    }
    /// Steps, and tells what that did to the energy: a net under scenes that must not gain any. O(bodies + contacts).
    [[nodiscard]] energy_report step_with_energy_report(scalar dt) {
        const detail::energy_balance<plan> balance(data_);
        step(dt);
        return balance.after();
    }
    template <executor Executor>
    [[nodiscard]] energy_report step_with_energy_report(scalar dt, Executor& by) {
        const detail::energy_balance<plan> balance(data_);
        step(dt, by);
        return balance.after();
    }
    /// Kinetic and potential energy as bodies are now. O(bodies).
    [[nodiscard]] energy_report energy() const { return detail::energy_of(data_); }
    /// Number of steps taken.
    [[nodiscard]] std::uint64_t steps() const { return data_.steps; }
    /// A number that worlds in the same state share, on any machine. User data and settings do not enter.
    /// O(bodies + shapes + contacts).
    [[nodiscard]] std::uint64_t state_hash() const { return code::state_hash(data_); }
    [[nodiscard]] const settings_type& settings() const { return data_.settings; }
    /// Changes the settings from the next step on. O(shapes).
    void set_settings(const settings_type& settings) { code::set_settings(data_, settings); }

    /// Adds a body; shapes give it extent and, if it is dynamic, mass. Without mass from shapes it is a point of
    /// 1 kg that nothing turns.
    body_id create_body(const body_def& def = {}) { return code::create_body(data_, def); }
    /// Removes a body with its shapes and contacts. O(its shapes); that of contacts(id) in recipes with contact events
    /// and where a static body bears sleepers.
    void destroy_body(body_id id) {
        if (const auto b = find(id, "destroy_body")) code::destroy_body(data_, b.index);
    }
    /// Removes several at once, and wakes what slept on them in one pass. Refused where one is listed twice.
    void destroy_bodies(const body_id* ids, std::uint32_t count) { code::destroy_bodies(data_, ids, count); }
    template <array_of<body_id> Ids>
    void destroy_bodies(const Ids& ids) {
        if (detail::check_count("destroy_bodies", "ids", ids))
            code::destroy_bodies(data_, ids.data(), detail::count_of(ids));
    }
    /// Removes all bodies with all that they have; settings and the number of steps stay. O(shapes + contacts).
    void clear() { code::clear(data_); }
    /// Makes a point the origin: all that is in the world, static bodies too, comes to lie so much nearer or farther,
    /// and goes on as it did; nothing wakes. Refused where anything would leave the scalar's range. O(bodies + shapes).
    void shift_origin(vec to) { code::shift_origin(data_, to); }
    /// Adds a shape of the recipe's set to a body; unless the body's mass is set, it changes with it. Refuses a mass
    /// that the scalar cannot hold. O(1) on static and kinematic bodies; on a dynamic one O(its shapes), and
    /// that of contacts(id) where the centre of mass moves.
    template <class Shape>
    shape_id create_shape(body_id body, const Shape& shape, const shape_def& def = {}) {
        constexpr bool known = any_shape::template kind_of<Shape>() >= 0;
        static_assert(
            known,
            "physics::world::create_shape: the recipe's set of shapes lacks this one; name it in physics::shapes<...>");
        if constexpr (known) return detail::create_shape(data_, body, shape, def);
        else return {};
    }
    /// The same for a shape that is given with its place, as capsule::upright() and between() give it; the pose of
    /// `def` moves that.
    template <class Shape>
    shape_id create_shape(body_id body, const placed_shape<Shape, dimension>& placed, const shape_def& def = {}) {
        return create_shape(body, placed.shape, detail::moved_def(def, placed));
    }
    /// Removes a shape and its contacts. Refused where the rest's mass is one that the scalar cannot hold. Cost: as of
    /// destroy_body.
    void destroy_shape(shape_id id) {
        const auto s = detail::find_shape(data_, id, "destroy_shape");
        if (s) code::destroy_shape(data_, s.index);
    }
    /// True if the handle names a living thing of this world; never an error.
    [[nodiscard]] bool contains(body_id id) const { return detail::contains(data_, data_.bodies, id); }
    [[nodiscard]] bool contains(shape_id id) const { return detail::contains(data_, data_.shapes, id); }
    [[nodiscard]] std::uint32_t body_count() const { return data_.bodies.count(); }
    [[nodiscard]] std::uint32_t shape_count() const { return data_.shapes.count(); }

    /// All bodies: `for (physics::body_id b : world.bodies())`.
    [[nodiscard]] auto bodies() const { return detail::body_range<plan>(data_); }
    /// All shapes of a body.
    [[nodiscard]] auto shapes(body_id id) const {
        return detail::shape_range<plan>(data_, find(id, "shapes") ? id : body_id());
    }

    /// Where the body's frame is: origin, rotation, both; and where its centre of mass is.
    [[nodiscard]] vec position(body_id id) const {
        return get(id, "position", [](const auto& b) { return b.pose().position; });
    }
    [[nodiscard]] rotation_type rotation(body_id id) const {
        return get(id, "rotation", [](const auto& b) { return b.rotation; });
    }
    [[nodiscard]] transform pose(body_id id) const {
        return get(id, "pose", [](const auto& b) { return b.pose(); });
    }
    [[nodiscard]] vec center_of_mass(body_id id) const {
        return get(id, "center_of_mass", [](const auto& b) { return b.center; });
    }
    /// Moves a body at once, without a path in between. Velocities stay.
    void set_pose(body_id id, vec position, const rotation_type& rotation) {
        const auto b = find(id, "set_pose");
        if (b && detail::check_pose("set_pose", position, rotation))
            code::set_pose(data_, b.index, {position, rotation});
    }
    void set_pose(body_id id, const transform& pose) { set_pose(id, pose.position, pose.rotation); }
    /// Lets a kinematic body reach a pose by the end of the next step, and pushes what it touches as the velocity would
    /// that takes it there; what else is in its way a swept recipe moves to its front (see swept). That velocity is the
    /// body's until the step after, in which it stands unless told to go on. In recipes without rotation it cannot turn
    /// on the way: only set_pose does that.
    void move_to(body_id id, vec position, const rotation_type& rotation) {
        const auto b = detail::if_enabled(data_, detail::find_kinematic(data_, id, "move_to"), "move_to");
        if (b && detail::check_pose("move_to", position, rotation)) code::move_to(data_, b.index, position, rotation);
    }
    void move_to(body_id id, const transform& pose) { move_to(id, pose.position, pose.rotation); }

    /// Velocity of the centre of mass (m/s), angular velocity (rad/s), velocity of the body at a point.
    [[nodiscard]] vec linear_velocity(body_id id) const {
        return get(id, "linear_velocity", [](const auto& b) { return b.velocity.linear; });
    }
    [[nodiscard]] angular angular_velocity(body_id id) const {
        return get(id, "angular_velocity",
                   [](const auto& b) -> angular { return detail::value_of(b.velocity.angular); });
    }
    [[nodiscard]] vec velocity_at(body_id id, vec point) const { return code::velocity_of_point(data_, id, point); }
    /// Velocities of dynamic and kinematic bodies; static ones have none, and locked rotations stay at 0.
    void set_linear_velocity(body_id id, vec v) {
        const auto b = find_moving(id, "set_linear_velocity");
        if (!b || !detail::check_in_range("set_linear_velocity", "v", v)) return;
        if (!(v == vec{})) code::wake_affected(data_, b.index);
        detail::velocity_to_set(data_, b.index).linear = v;
    }
    void set_angular_velocity(body_id id, angular w) requires plan::rotates {
        const auto b = find_moving(id, "set_angular_velocity");
        if (!b ||
            !detail::check_angular_velocity("set_angular_velocity", "w", w, data_.bodies[b.index].rotation_locked))
            return;
        if (!(w == angular{})) code::wake_affected(data_, b.index);
        detail::velocity_to_set(data_, b.index).angular = w;
    }

    /// A force (N) on a dynamic body during the next step, at its centre of mass or at a point; "local"
    /// takes force and point in the body's frame. Forces add up; refused where the sum would leave the scalar's range.
    /// In recipes without rotation the point does not matter.
    void apply_force(body_id id, vec force) { add_force(id, "apply_force", force, false, nullptr); }
    void apply_force_at(body_id id, vec force, vec point) { add_force(id, "apply_force_at", force, false, &point); }
    void apply_local_force(body_id id, vec force) { add_force(id, "apply_local_force", force, true, nullptr); }
    void apply_local_force_at(body_id id, vec force, vec point) {
        add_force(id, "apply_local_force_at", force, true, &point);
    }
    /// A torque (N m) during the next step.
    void apply_torque(body_id id, angular torque) requires plan::rotates { code::add_torque(data_, id, torque); }
    /// Forgets the forces and torques that wait for the next step.
    void clear_forces(body_id id) {
        const auto b = detail::find_dynamic(data_, id, "clear_forces");
        if (!b) return;
        data_.bodies[b.index].force = {};
        data_.bodies[b.index].torque = {};
    }
    /// An impulse (N s): changes velocities at once.
    void apply_impulse(body_id id, vec impulse) { add_impulse(id, "apply_impulse", impulse, false, nullptr); }
    void apply_impulse_at(body_id id, vec impulse, vec point) {
        add_impulse(id, "apply_impulse_at", impulse, false, &point);
    }
    void apply_local_impulse(body_id id, vec impulse) {
        add_impulse(id, "apply_local_impulse", impulse, true, nullptr);
    }
    void apply_local_impulse_at(body_id id, vec impulse, vec point) {
        add_impulse(id, "apply_local_impulse_at", impulse, true, &point);
    }
    /// An angular impulse (N m s).
    void apply_angular_impulse(body_id id, angular impulse) requires plan::rotates {
        code::add_angular_impulse(data_, id, impulse);
    }

    /// Mass (kg), centre (m) and inertia about it (kg m^2) in the body's frame. Static and kinematic bodies take none
    /// from their shapes: they have mass 0 and their centre at the origin.
    [[nodiscard]] mass_properties mass(body_id id) const {
        return get(id, "mass", [](const auto& b) -> mass_properties { return b.mass; });
    }
    /// Sets them for a dynamic body, until reset_mass, whatever its shapes are; with an inertia of 0, the only one in
    /// recipes without rotation, nothing turns it. Refuses what the scalar cannot hold, and tensors that are not
    /// positive definite.
    void set_mass(body_id id, const mass_properties& mass) {
        const auto b = detail::find_dynamic(data_, id, "set_mass");
        if (b) code::set_mass(data_, b.index, mass);
    }
    /// Takes the mass from the shapes again. O(shapes).
    void reset_mass(body_id id) {
        const auto b = detail::find_dynamic(data_, id, "reset_mass");
        if (b) code::reset_mass(data_, b.index);
    }
    [[nodiscard]] scalar linear_damping(body_id id) const {
        return get(id, "linear_damping", [](const auto& b) { return b.linear_damping; });
    }
    [[nodiscard]] scalar angular_damping(body_id id) const {
        return get(id, "angular_damping", [](const auto& b) { return detail::value_of(b.angular_damping); });
    }
    /// Rates (1/s), at least 0, at which the velocities of a dynamic body decay without force.
    void set_damping(body_id id, scalar linear_rate, scalar angular_rate) {
        const auto b = find(id, "set_damping");
        if (!b || !detail::check_not_negative("set_damping", "linear_rate", linear_rate) ||
            !detail::check_not_negative("set_damping", "angular_rate", angular_rate) ||
            (!plan::rotates && !detail::check_left_out("set_damping", "angular_rate", angular_rate)))
            return;
        data_.bodies[b.index].linear_damping = linear_rate;
        if constexpr (plan::rotates) data_.bodies[b.index].angular_damping = angular_rate;
    }
    [[nodiscard]] scalar gravity_scale(body_id id) const {
        return get(id, "gravity_scale", [](const auto& b) { return b.gravity_scale; });
    }
    void set_gravity_scale(body_id id, scalar factor) {
        const auto b = find(id, "set_gravity_scale");
        if (!b || !detail::check_in_range("set_gravity_scale", "factor", factor)) return;
        code::wake_affected(data_, b.index);
        data_.bodies[b.index].gravity_scale = factor;
    }
    [[nodiscard]] bool rotation_locked(body_id id) const {
        return get(id, "rotation_locked", [](const auto& b) { return b.rotation_locked; });
    }
    /// Locks or frees rotation; locking stops it.
    void set_rotation_locked(body_id id, bool locked) requires plan::rotates {
        const auto b = find(id, "set_rotation_locked");
        if (b) code::set_rotation_locked(data_, b.index, locked);
    }
    /// Whether moving bodies stop it too on its way through a step (see swept), and what the last step's sweeps did.
    [[nodiscard]] bool continuous(body_id id) const { return detail::is_continuous(data_, id); }
    void set_continuous(body_id id, bool on) { detail::set_continuous(data_, id, on); }
    [[nodiscard]] auto continuous_report() const { return detail::report_of(data_); }
    [[nodiscard]] std::uint64_t user_data(body_id id) const {
        return get(id, "user_data", [](const auto& b) { return b.user_data; });
    }
    void set_user_data(body_id id, std::uint64_t value) {
        if (const auto b = find(id, "set_user_data")) data_.bodies[b.index].user_data = value;
    }

    [[nodiscard]] body_id body(shape_id id) const {
        const auto s = detail::find_shape(data_, id, "body");
        if (!s) return {};
        const std::uint32_t b = data_.shapes[s.index].body;
        return {b, data_.bodies.generation(b), data_.tag};
    }
    /// The shape itself, and its pose in the body's frame: visit it to learn its kind.
    [[nodiscard]] any_shape shape(shape_id id) const {
        return get(id, "shape", [](const auto& s) { return s.shape; });
    }
    [[nodiscard]] transform local_pose(shape_id id) const {
        return get(id, "local_pose", [](const auto& s) { return s.local; });
    }
    [[nodiscard]] material_type material(shape_id id) const {
        return get(id, "material", [this](const auto& s) { return detail::surface_of(data_, s); });
    }
    /// Changes a shape's material from the next step on; without feature::materials set_settings changes that of all.
    void set_material(shape_id id, const material_type& m) requires(plan::features::materials) {
        detail::scoped([&] { detail::set_material(data_, id, m); });
    }
    [[nodiscard]] collision_filter filter(shape_id id) const {
        return get(id, "filter", [](const auto& s) { return s.filter; });
    }
    /// Changes which shapes a shape meets. Contacts with those that it meets no longer are gone at once, others keep
    /// their impulses; sleepers that it begins or ceases to touch wake. O(shapes of its body), and that of
    /// contacts(id).
    void set_filter(shape_id id, const collision_filter& filter) {
        const auto s = detail::find_shape(data_, id, "set_filter");
        if (s) code::set_filter(data_, s.index, filter);
    }
    [[nodiscard]] std::uint64_t user_data(shape_id id) const {
        return get(id, "user_data", [](const auto& s) { return s.user_data; });
    }
    void set_user_data(shape_id id, std::uint64_t value) {
        if (const auto s = detail::find_shape(data_, id, "set_user_data")) data_.shapes[s.index].user_data = value;
    }

private:
    detail::lookup find(body_id id, const char* function) const { return detail::find_body(data_, id, function); }
    detail::lookup find(body_id id, const char* function) { return detail::find_body(data_, id, function); }
    detail::lookup find_moving(body_id id, const char* function) { return detail::find_moving(data_, id, function); }
    /// f of the thing that the handle names, or a default value after refusing the handle.
    template <class F>
    auto get(body_id id, const char* function, F&& f) const -> decltype(f(std::declval<const typename plan::body&>())) {
        const auto b = find(id, function);
        return b ? f(data_.bodies[b.index]) : decltype(f(data_.bodies[0])){};
    }
    template <class F>
    auto get(shape_id id, const char* function, F&& f) const
        -> decltype(f(std::declval<const detail::shape_record<plan>&>())) {
        const auto s = detail::find_shape(data_, id, function);
        return s ? f(data_.shapes[s.index]) : decltype(f(data_.shapes[0])){};
    }
    void add_force(body_id id, const char* function, vec force, bool local, const vec* point) {
        code::add_force(data_, id, function, force, local, point);
    }
    void add_impulse(body_id id, const char* function, vec impulse, bool local, const vec* point) {
        code::add_impulse(data_, id, function, impulse, local, point);
    }

    detail::world_data<plan> data_;
};

PHYSICS_HPP_END
