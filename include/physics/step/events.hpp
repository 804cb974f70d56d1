// Events: what a step tells of contacts and sleep, where a recipe asks for it.
#pragma once

#include "physics/base/bit_array.hpp"
#include "physics/base/buffer.hpp"
#include "physics/base/handle.hpp"
#include "physics/base/sort.hpp"
#include "physics/base/stage.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/space/aabb.hpp"
#include "physics/space/check.hpp"
#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

/// Kinds of events that a recipe can ask for.
namespace event {
/// Shapes that begin and cease to touch.
struct contact {};
/// Shapes that hit each other.
struct hit {};
/// Shapes that come into sensors and leave them; only then can shapes be sensors.
struct sensor {};
/// Bodies that fall asleep and wake up.
struct sleep {};
/// Bodies that a step moves.
struct move {};
/// Joints that come to their limits and leave them.
struct joint_limit {};
}  // namespace event

/// Which events a world tells of: events<event::contact, event::hit>. None by default; others cost nothing.
template <class... Kinds>
struct events {
    using stage = physics::stage::events;

private:
    template <class Kind>
    static constexpr bool has = (std::same_as<Kinds, Kind> || ...);
    template <class Any, class... Known>
    static constexpr bool is_one_of = (std::same_as<Any, Known> || ...);

public:
    static constexpr bool contacts = has<event::contact>;
    static constexpr bool hits = has<event::hit>;
    static constexpr bool sensors = has<event::sensor>;
    static constexpr bool sleep = has<event::sleep>;
    static constexpr bool moves = has<event::move>;
    static constexpr bool joint_limits = has<event::joint_limit>;
    static constexpr bool any = sizeof...(Kinds) > 0;
    static constexpr bool known =
        (is_one_of<Kinds, event::contact, event::hit, event::sensor, event::sleep, event::move, event::joint_limit> &&
         ...);
};

/// When events are told of.
template <class S>
struct event_settings {
    /// Shapes that approach each other no faster do not hit each other (m/s, at least 0).
    S hit_speed = S(1);
};
template <class S>
bool check(const event_settings<S>& with, const char* function) {
    return detail::check_not_negative(function, "events.hit_speed", with.hit_speed);
}

/// Two shapes that have begun to touch in the last step, or have ceased to. A is the shape of the lower number.
struct contact_event {
    shape_id shape_a, shape_b;
    body_id body_a, body_b;
    /// What users had given the shapes and their bodies.
    std::uint64_t shape_data_a = 0, shape_data_b = 0, body_data_a = 0, body_data_b = 0;
    /// True if one of the shapes has been destroyed.
    bool gone = false;
};

/// Two shapes that have hit each other in the last step: at a point of their contact that bore nothing before they
/// approached each other faster than settings().events.hit_speed. A is the shape of the lower number.
template <class S, int D>
struct hit_event {
    shape_id shape_a, shape_b;
    body_id body_a, body_b;
    /// Where they approached each other fastest, as the step began (m), and the unit normal from A to B there.
    vec<S, D> point, normal;
    /// How fast they did (m/s), and what all points of the contact gave along their normals in the step (N s).
    S approach_speed{}, impulse{};
};

/// A shape that has come into a sensor in the last step, or has left it.
struct sensor_event {
    shape_id sensor, visitor;
    body_id sensor_body, visitor_body;
    /// What users had given the shapes and their bodies.
    std::uint64_t sensor_data = 0, visitor_data = 0, sensor_body_data = 0, visitor_body_data = 0;
    /// True if one of the shapes has been destroyed.
    bool gone = false;
};

/// A body that the last step has moved or turned.
struct move_event {
    body_id body;
    std::uint64_t user_data = 0;
    /// True if it sleeps now: it stays there until it wakes.
    bool fell_asleep = false;
};

/// A joint that has come to a limit in the last step, or has left all of them. It comes to one as a row presses that
/// pushes in one direction only, as the stop of a door that is pushed against it or a rope that becomes taut, and
/// leaves it once none presses and it is farther away than a quarter of the contact margin (m, rad).
struct joint_limit_event {
    joint_id joint;
    body_id body_a, body_b;
    /// What the user had given the joint.
    std::uint64_t user_data = 0;
    /// True if the joint has been destroyed.
    bool gone = false;
};

namespace detail {

struct no_event_settings {};
inline bool check(const no_event_settings&, const char*) { return true; }

/// What is to be told by the next step, and lasts until then.
struct dropped_contacts {
    /// Shapes that touched each other, and whose contacts went by what users did: as they were then.
    buffer<contact_event> list;
    PHYSICS_HPP_MEMBERS(list)
};
struct sleep_changes {
    buffer<body_id> slept, woken;
    PHYSICS_HPP_MEMBERS(slept, woken)
};
struct no_changes {};
struct no_joint_limits {};
/// What lasts of the limits of joints.
struct joint_limit_state {
    /// Joints that are at one, in ascending order.
    buffer<std::uint32_t> at_limit;
    /// What left them by being destroyed since the last step.
    buffer<joint_limit_event> dropped;
    PHYSICS_HPP_MEMBERS(at_limit, dropped)
};
/// What lasts of sensors.
struct sensor_state {
    /// Of each shape, and how many are.
    bit_array is_sensor;
    reset_on_move<std::uint32_t> count;
    /// Those that see static bodies too.
    buffer<std::uint32_t> of_static;
    /// Pairs of a sensor and what is in it, in ascending order.
    buffer<proxy_pair> inside;
    /// Their numbers by visitor; made when the first shape is removed after a step.
    buffer<std::uint32_t> by_visitor;
    /// Those of which a shape has been removed since.
    bit_array gone;
    /// What left by being destroyed since the last step; each pair that is gone is among it.
    buffer<sensor_event> dropped;
    PHYSICS_HPP_MEMBERS(is_sensor, count, of_static, inside, by_visitor, gone, dropped)

    /// Takes the memory to remove shapes: O(n log n) in pairs once after a step, then O(1).
    void prepare_removal() {
        gone.grow(inside.size());
        dropped.reserve(inside.size());
        if (by_visitor.size() == inside.size()) return;
        by_visitor.resize(inside.size());
        for (std::uint32_t i = 0; i < inside.size(); ++i) by_visitor[i] = i;
        sort_in_place(by_visitor.begin(), by_visitor.size(), [this](std::uint32_t x, std::uint32_t y) {
            return inside[x].b != inside[y].b ? inside[x].b < inside[y].b : x < y;
        });
    }
    /// Calls f(number) for all pairs of a sensor, or a visitor.
    template <class F>
    void each_of_sensor(std::uint32_t shape, F&& f) const {
        std::uint32_t i = count_before(inside, [&](const proxy_pair& p) { return p.a < shape; });
        for (; i < inside.size() && inside[i].a == shape; ++i)
            if (!gone.has(i)) f(i);
    }
    template <class F>
    void each_of_visitor(std::uint32_t shape, F&& f) const {
        std::uint32_t k = count_before(by_visitor, [&](std::uint32_t i) { return inside[i].b < shape; });
        for (; k < by_visitor.size() && inside[by_visitor[k]].b == shape; ++k)
            if (!gone.has(by_visitor[k])) f(by_visitor[k]);
    }
    /// Others are inside now.
    void set_inside(buffer<proxy_pair>& now) {
        inside.swap(now);
        by_visitor.clear();
        gone.clear();
        dropped.clear();
    }
};

/// A body that goes far in a step, and what it fills on its way.
template <int D>
struct far_body {
    std::uint32_t body = 0;
    aabb<double, D> box;
    bool has_sensors = false;
};

/// What the last step told, and what that followed from.
template <class S, int D>
struct step_events {
    buffer<contact_event> contact_begin, contact_end;
    buffer<hit_event<S, D>> hits;
    buffer<sensor_event> sensor_begin, sensor_end;
    buffer<body_id> slept, woken;
    buffer<move_event> moved;
    buffer<joint_limit_event> limit_begin, limit_end;
    /// Joints that are at limits, and those of the step.
    buffer<std::uint32_t> now_at_limit;
    bit_array looked_at;
    /// Pairs that have begun to touch and not ceased to, with a body that can be pushed: those of the last step, in
    /// ascending order, unless they have to be listed anew.
    buffer<proxy_pair> touching, now_touching;
    bool is_stale = true;
    /// Pairs without sensors; pairs of sensors and what is in them, or passed through them.
    buffer<proxy_pair> solid_pairs, overlaps, now_inside, passed;
    buffer<far_body<D>> far;

    void clear_sensor_events() {
        sensor_begin.clear();
        sensor_end.clear();
    }
    void forget() {
        contact_begin.clear();
        contact_end.clear();
        hits.clear();
        clear_sensor_events();
        slept.clear();
        woken.clear();
        moved.clear();
        limit_begin.clear();
        limit_end.clear();
        is_stale = true;
    }
};
struct no_events {
    void forget() {}
};
template <class Plan>
using step_events_of =
    std::conditional_t<Plan::events::any, step_events<typename Plan::scalar, Plan::dimension>, no_events>;

/// Changes since the last step told of such -> what this one tells.
template <class S, int D>
void publish_sleep_changes(sleep_changes& changes, std::uint16_t tag, step_events<S, D>& to) {
    to.slept.swap(changes.slept);
    to.woken.swap(changes.woken);
    changes.slept.clear();
    changes.woken.clear();
    for (auto* ids : {&to.slept, &to.woken})
        for (body_id& id : *ids) id.world = tag;
}

}  // namespace detail

PHYSICS_HPP_END
