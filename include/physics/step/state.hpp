// Everything that a world holds, as plain arrays.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/base/pool.hpp"
#include "physics/step/awake.hpp"
#include "physics/step/contact_lists.hpp"
#include "physics/step/joints.hpp"
#include "physics/step/step_data.hpp"
#include "physics/step/user_types.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Behind the last shape of a body.
inline constexpr std::uint32_t no_shape = null_index;

/// Everything that a world keeps of one shape.
template <class Plan>
struct shape_record {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    typename Plan::shape shape;
    transform<S, D> local;
    /// Where it is in the world, and its origin relative to the body's centre of mass, in world axes.
    transform<S, D> pose;
    vec<S, D> r;
    [[no_unique_address]] stored_material<S, D, typename Plan::features> material;
    S density{};
    collision_filter filter;
    bool sensor = false, senses_static = false, one_way = false;
    std::uint32_t body = 0;
    /// The body's shape of the next lower number.
    std::uint32_t next = no_shape;
    std::uint64_t user_data = 0;
    PHYSICS_HPP_MEMBERS(shape, local, pose, r, material, density, filter, sensor, senses_static, one_way, body, next,
                        user_data)
};

/// The shapes of a world. It is one of the owners of the geometry that its shapes are made of.
template <class Plan>
class shape_pool : public pool<shape_record<Plan>> {
    using base = pool<shape_record<Plan>>;

public:
    shape_pool() = default;
    shape_pool(const shape_pool& other) : base(other) { each_geometry(retain); }
    shape_pool(shape_pool&& other) noexcept = default;
    shape_pool& operator=(const shape_pool& other) {
        if (this == &other) return *this;
        // What may fail comes first.
        base::reserve(other.slots());
        other.each_geometry(retain);
        each_geometry(release);
        base::operator=(other);
        return *this;
    }
    shape_pool& operator=(shape_pool&& other) noexcept {
        shape_pool taken(std::move(other));
        base::swap(taken);
        return *this;
    }
    ~shape_pool() { each_geometry(release); }

    typename base::place insert(const shape_record<Plan>& record) {
        retain(record.shape.geometry());
        return base::insert(record);
    }
    void erase(std::uint32_t index) {
        release((*this)[index].shape.geometry());
        base::erase(index);
    }

    /// Calls f with the block of geometry of each shape, null for those that have none.
    template <class F>
    void each_geometry(F&& f) const {
        if constexpr (Plan::shape::has_geometry)
            base::each([&](std::uint32_t, const auto& record) { f(record.shape.geometry()); });
    }
};

/// Stands for the next sleeper of a body that is awake.
inline constexpr std::uint32_t no_sleeper = null_index;

/// Which bodies sleep. Arrays by the numbers of bodies.
template <class Plan>
struct sleep_state {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    /// For how long each body has been still (s), up to the time that it takes to fall asleep.
    buffer<S> sleep_time;
    /// Where its centre of mass was when it became so.
    buffer<vec<S, D>> sleep_anchor;
    /// How fast it was, squared, when it first went along with others since then; -1: it has not.
    buffer<S> carried_from;
    /// Of each sleeper the next one of its island, in a ring.
    buffer<std::uint32_t> island_next;
    /// How many bodies are asleep.
    std::uint32_t sleepers = 0;
    /// Contacts of which no body that can be pushed is awake, in ascending order of their pairs. Those of bodies that
    /// have woken up since the last step are still there: the next one begins by taking them back, in one pass for all.
    buffer<typename Plan::contact> contacts;
    bool has_woken_contacts = false;
    /// Length of the step in which their impulses acted (s).
    S step{};
    /// Bodies that have woken up or fallen asleep since the last step told of such.
    [[no_unique_address]] std::conditional_t<Plan::events::sleep, sleep_changes, no_changes> changes;

    [[nodiscard]] bool is_asleep(std::uint32_t body) const { return island_next[body] != no_sleeper; }
    void reserve(std::uint32_t bodies) {
        sleep_time.reserve(bodies);
        sleep_anchor.reserve(bodies);
        carried_from.reserve(bodies);
        island_next.reserve(bodies);
    }
    /// A body has come, awake.
    void start(std::uint32_t body, vec<S, D> center) {
        if (body >= island_next.size()) {
            sleep_time.resize(body + 1);
            sleep_anchor.resize(body + 1);
            carried_from.resize(body + 1);
            island_next.resize(body + 1);
        }
        sleep_time[body] = {};
        sleep_anchor[body] = center;
        carried_from[body] = S(-1);
        island_next[body] = no_sleeper;
    }
    PHYSICS_HPP_MEMBERS(sleep_time, sleep_anchor, carried_from, island_next, sleepers, contacts, has_woken_contacts,
                        step, changes)
};
struct no_sleep_state {
    static constexpr bool is_asleep(std::uint32_t) { return false; }
};
template <class Plan>
using sleep_of = std::conditional_t<Plan::sleeps, sleep_state<Plan>, no_sleep_state>;

/// Whether a body can be pushed in this step.
template <class Bodies, class Sleep>
bool is_awake_dynamic(const Bodies& bodies, const Sleep& sleep, std::uint32_t body) {
    return bodies[body].is_dynamic() && !sleep.is_asleep(body);
}

/// Whether a body of a contact can.
template <class Contact, class Bodies, class Sleep>
bool can_be_pushed(const Contact& c, const Bodies& bodies, const Sleep& sleep) {
    return is_awake_dynamic(bodies, sleep, c.bodies.body_a) || is_awake_dynamic(bodies, sleep, c.bodies.body_b);
}

/// How far a body's shapes reach from its centre of mass; see stride.
template <class S>
struct body_extent {
    S thickness{}, reach{};
    /// No point of the body is farther from it.
    double outer = 0;
};
/// What continuous collision needs.
template <class Plan>
struct continuous_state {
    using S = typename Plan::scalar;

    /// Of every body; follow from shapes and masses.
    buffer<body_extent<S>> extents;
    continuous_report<S> report;

    PHYSICS_HPP_MEMBERS(extents, report)
};
struct nothing_continuous {};
template <class Plan>
using joints_of =
    std::conditional_t<Plan::has_joints, joint_set<typename Plan::scalar, Plan::dimension, typename Plan::joints>,
                       no_joints>;

template <class Plan>
using joint_limits_of =
    std::conditional_t<Plan::has_joints && Plan::events::joint_limits, joint_limit_state, no_joint_limits>;

/// The state of a world. Copying it copies the world.
template <class Plan>
struct state {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    typename Plan::settings settings;
    pool<typename Plan::body> bodies;
    shape_pool<Plan> shapes;
    typename Plan::broadphase broadphase;
    /// Contacts of the last step with at least one awake dynamic body, in ascending order of their pairs.
    buffer<typename Plan::contact> contacts;
    /// What the surfaces of these contacts, and of those of sleepers, make of each other.
    [[no_unique_address]] combined_material<S, typename Plan::features> surfaces;
    /// Where the centres of bodies were, and how bodies were turned, when these contacts were found.
    buffer<transform<S, D>> contact_starts;
    awake_list awake;
    /// What the narrowphase remembers of the last step's pairs.
    pair_cache<Plan> memories;
    removed_shapes removed;
    [[no_unique_address]] sleep_of<Plan> sleep;
    [[no_unique_address]] std::conditional_t<Plan::is_continuous, continuous_state<Plan>, nothing_continuous>
        continuous;
    [[no_unique_address]] joints_of<Plan> joints;
    /// Shapes that touched each other until users took their contacts away since the last step.
    [[no_unique_address]] std::conditional_t<Plan::events::contacts, dropped_contacts, no_changes> dropped;
    [[no_unique_address]] std::conditional_t<Plan::events::sensors, sensor_state, no_changes> sensors;
    [[no_unique_address]] joint_limits_of<Plan> joint_limits;
    [[no_unique_address]] user_values<body_tag, typename Plan::user_types::body> body_values;
    [[no_unique_address]] user_values<shape_tag, typename Plan::user_types::shape> shape_values;
    [[no_unique_address]] user_values<joint_tag, typename Plan::user_types::joint> joint_values;
    std::uint64_t steps = 0;
    /// Lengths of the steps in which the contacts' impulses act.
    solver_api::step_lengths<S> step_lengths;
    /// By which handles know the world; no part of what lasts, so that they serve it whatever state it is brought to.
    unsaved<std::uint16_t> tag;
    PHYSICS_HPP_MEMBERS(settings, bodies, shapes, broadphase, contacts, surfaces, contact_starts, awake, memories,
                        removed, sleep, continuous, joints, dropped, sensors, joint_limits, body_values, shape_values,
                        joint_values, steps, step_lengths, tag)

    [[nodiscard]] bool is_asleep(std::uint32_t body) const { return sleep.is_asleep(body); }
    [[nodiscard]] bool is_awake_dynamic(std::uint32_t body) const {
        return detail::is_awake_dynamic(bodies, sleep, body);
    }
};

template <class Plan>
continuous_report<typename Plan::scalar> report_of(const state<Plan>& s) {
    if constexpr (Plan::sweeps) return s.continuous.report;
    else return {};
}

/// What a shape's surface is made of.
template <class Plan>
auto surface_of([[maybe_unused]] const state<Plan>& s, const shape_record<Plan>& shape) {
    if constexpr (Plan::features::materials) return shape.material.whole();
    else return s.settings.material;
}

/// Says where a shape is, of a body whose frame and whose centre of mass are there.
template <class Plan, class Vec, class Pose>
void update_pose(shape_record<Plan>& shape, const Pose& body, const Vec& center) {
    shape.pose = body * shape.local;
    shape.r = shape.pose.position - center;
}

/// The box that the narrowphase needs the broadphase to know: all within half the contact margin.
template <class Plan>
auto box_within(typename Plan::scalar contact_margin, const shape_record<Plan>& shape) {
    return grown(bounds(shape.shape, shape.pose), contact_margin / typename Plan::scalar(2));
}
template <class World, class Plan>
auto query_bounds(const World& w, const shape_record<Plan>& shape) {
    return box_within(w.settings.contact_margin, shape);
}
/// Whether the broadphase is to find what a body meets: it can be pushed, or moves where sensors may see it.
template <class Plan>
bool is_movable(const pool<typename Plan::body>& bodies, const sleep_of<Plan>& sleep, std::uint32_t body) {
    return is_awake_dynamic(bodies, sleep, body) ||
           (Plan::events::sensors && bodies[body].type == body_type::kinematic_body);
}
/// What the broadphase knows of a shape besides.
template <class Plan>
proxy_filter filter_of(const pool<typename Plan::body>& bodies, const sleep_of<Plan>& sleep,
                       const shape_record<Plan>& shape) {
    const collision_filter& f = shape.filter;
    // Of no category and no kind, it is found by nothing.
    if (!bodies[shape.body].enabled) return {0, 0, 0, shape.body, false, shape.sensor, 0};
    const auto kinds = static_cast<std::uint8_t>(1u << static_cast<unsigned>(bodies[shape.body].type));
    return {f.category, f.mask, f.group, shape.body, is_movable<Plan>(bodies, sleep, shape.body), shape.sensor, kinds};
}
template <class World, class Plan>
proxy_filter filter_of(const World& w, const shape_record<Plan>& shape) {
    return filter_of<Plan>(w.bodies, w.sleep, shape);
}
template <class Plan>
void configure_broadphase(state<Plan>& s) {
    if constexpr (requires { s.broadphase.configure(s.settings.broadphase); })
        s.broadphase.configure(s.settings.broadphase);
}
/// Lets queries see where shapes are, if the broadphase wants to be told.
template <class Plan>
void update_broadphase(state<Plan>& s) {
    if constexpr (requires { s.broadphase.update(); }) s.broadphase.update();
}

/// Calls f(index, shape) for every shape of a body.
template <class Bodies, class Shapes, class F>
void each_shape(const Bodies& bodies, Shapes& shapes, std::uint32_t body, F&& f) {
    for (std::uint32_t i = bodies[body].first_shape; i != no_shape;) {
        const std::uint32_t next = shapes[i].next;
        f(i, shapes[i]);
        i = next;
    }
}
template <class State, class F>
void each_shape(State& s, std::uint32_t body, F&& f) {
    each_shape(s.bodies, s.shapes, body, f);
}
/// The same for those that are no sensors.
template <class Plan, class F>
void each_solid_shape(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes, std::uint32_t body,
                      F&& f) {
    each_shape(bodies, shapes, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        if constexpr (Plan::events::sensors)
            if (shape.sensor) return;
        f(i, shape);
    });
}

/// Takes the memory for so many changes of the broadphase, of shapes of numbers below `slots`.
template <class Broadphase>
void reserve_changes(Broadphase& broadphase, std::uint32_t slots, std::uint32_t changes) {
    if constexpr (requires { broadphase.reserve(slots, changes); }) broadphase.reserve(slots, changes);
}
/// Enters the shapes of a body into the broadphase anew: it has become another kind of proxy.
template <class Plan>
void reinsert_proxies(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes,
                      const sleep_of<Plan>& sleep, typename Plan::scalar margin, typename Plan::broadphase& broadphase,
                      std::uint32_t body) {
    each_shape(bodies, shapes, body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
        broadphase.erase(i);
        broadphase.insert(i, box_within(margin, shape), filter_of<Plan>(bodies, sleep, shape));
    });
}
template <class Plan>
void reinsert_proxies(state<Plan>& s, std::uint32_t body) {
    reinsert_proxies<Plan>(s.bodies, s.shapes, s.sleep, s.settings.contact_margin, s.broadphase, body);
}

/// Tells the broadphase where the shapes of a body are now.
template <class Plan>
void refresh_boxes(const pool<typename Plan::body>& bodies, typename Plan::scalar margin, shape_pool<Plan>& shapes,
                   typename Plan::broadphase& broadphase, std::uint32_t body) {
    const auto& b = bodies[body];
    each_shape(bodies, shapes, body, [&](std::uint32_t i, shape_record<Plan>& shape) {
        update_pose(shape, b.pose(), b.center);
        broadphase.move(i, box_within(margin, shape), {});
    });
}
template <class Plan>
void refresh_boxes(state<Plan>& s, std::uint32_t body) {
    refresh_boxes<Plan>(s.bodies, s.settings.contact_margin, s.shapes, s.broadphase, body);
    update_broadphase(s);
}

/// A number for each world of the program, to recognise foreign handles; after 65535 worlds numbers come again. It
/// never enters any result.
inline std::uint16_t next_world_tag() noexcept {
    static std::uint32_t count = 0;
#if defined(__GNUC__)
    return static_cast<std::uint16_t>(__atomic_add_fetch(&count, 1u, __ATOMIC_RELAXED));
#else
    return static_cast<std::uint16_t>(++count);
#endif
}

}  // namespace detail

PHYSICS_HPP_END
