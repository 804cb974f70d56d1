// What a world tells of contacts, and what its last step did.
#pragma once

#include "physics/world/ranges.hpp"
#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

/// Contacts and events of a world. Events are told of the last step, in ascending order of shapes' numbers, and stay
/// until the next one, whatever changes in between; several steps a frame tell of the last one only, so read them after
/// each (see accumulator). For each pair of shapes a begin is followed by one end, in the step after what ended it:
/// also where a shape was destroyed, moved, filtered out or changed its type. To fall asleep ends no contact. A copy of
/// a world, and one that is restored, has no events until it steps; then it tells what the first one would. What a
/// refused step would have told is not told.
template <class World, class Plan>
class contact_functions {
    static constexpr int D = Plan::dimension;
    using S = typename Plan::scalar;

public:
    /// All contacts of the last step, each as a contact_view; those of sleepers as they were.
    [[nodiscard]] auto contacts() const { return detail::contact_range<Plan>(data()); }
    /// Those of one body, or of one shape. O(their number); O(bodies + contacts) for the first one that is asked for
    /// after a step, or after contacts have gone.
    [[nodiscard]] auto contacts(body_id id) const {
        const detail::lookup at = detail::find_body(data(), id, "contacts");
        return at ? range(data(), at.index, detail::no_shape) : range(data());
    }
    [[nodiscard]] auto contacts(shape_id id) const {
        const detail::lookup at = detail::find_shape(data(), id, "contacts");
        return at ? range(data(), data().shapes[at.index].body, at.index) : range(data());
    }
    /// Whether any of their contacts is touching (see contact_view). Cost: that of contacts(a).
    [[nodiscard]] bool touching(body_id a, body_id b) const {
        if (!detail::find_body(data(), b, "touching")) return false;
        const detail::lookup at = detail::find_body(data(), a, "touching");
        return at && any_touching(at.index, [&](const auto& c) { return c.other(a) == b; });
    }
    [[nodiscard]] bool touching(shape_id a, shape_id b) const {
        if (!detail::find_shape(data(), b, "touching")) return false;
        const detail::lookup at = detail::find_shape(data(), a, "touching");
        return at && any_touching(data().shapes[at.index].body, [&](const auto& c) {
                   return (c.shape_a == a && c.shape_b == b) || (c.shape_a == b && c.shape_b == a);
               });
    }

    /// Shapes that have begun to touch in the last step, as contact_events, and those that have ceased to.
    [[nodiscard]] const buffer<contact_event>& contact_begin_events() const requires(Plan::events::contacts) {
        return data().step.events.contact_begin;
    }
    [[nodiscard]] const buffer<contact_event>& contact_end_events() const requires(Plan::events::contacts) {
        return data().step.events.contact_end;
    }
    /// Shapes that have hit each other in the last step.
    [[nodiscard]] const buffer<hit_event<S, D>>& hit_events() const requires(Plan::events::hits) {
        return data().step.events.hits;
    }
    /// Whether a shape is a sensor: it has no mass, stops nothing and is seen by no query unless that asks for sensors.
    /// Shapes of dynamic and kinematic bodies, and of static ones if it senses_static, are in it that are no sensors,
    /// which its filter meets, and whose surface or inside, of concave ones the surface, overlaps it. It tells of poses
    /// at the end of the step, whoever sleeps; in recipes that sweep also of what passes through it within the step,
    /// which leaves it in the next one, unless one of the two is a surface. To change a static one wakes what sleeps
    /// there.
    [[nodiscard]] bool is_sensor(shape_id id) const {
        const detail::lookup at = detail::find_shape(data(), id, "is_sensor");
        return at && data().shapes[at.index].sensor;
    }
    /// Whether a sensor sees the shapes of static bodies too, as they stand at the end of each step.
    [[nodiscard]] bool senses_static(shape_id id) const {
        const detail::lookup at = detail::find_shape(data(), id, "senses_static");
        return at && data().shapes[at.index].senses_static;
    }
    /// Whether a shape holds only what comes from its upper side (see one_way_platforms).
    [[nodiscard]] bool is_one_way(shape_id id) const {
        const detail::lookup at = detail::find_shape(data(), id, "is_one_way");
        return at && data().shapes[at.index].one_way;
    }
    /// Calls visit(shape_id) for what was in a sensor as the last step ended, or has passed through it then, and is not
    /// destroyed since, in ascending order; visit may change the world. O(log of all such pairs + their number).
    template <class Visit>
    void each_visitor(shape_id sensor, Visit&& visit) const requires(Plan::events::sensors) {
        const detail::lookup at = detail::find_shape(data(), sensor, "each_visitor");
        if (!at) return;
        small_list found;
        const auto& s = data();
        s.sensors.each_of_sensor(at.index, [&](std::uint32_t i) {
            const std::uint32_t visitor = s.sensors.inside[i].b;
            found.push_back({visitor, s.shapes.generation(visitor), s.tag});
        });
        for (const shape_id visitor : found)
            if (visitor.world == data().tag && s.shapes.contains(visitor.index, visitor.generation)) visit(visitor);
    }
    /// Shapes that have come into sensors in the last step, as sensor_events, and those that have left them.
    [[nodiscard]] const buffer<sensor_event>& sensor_begin_events() const requires(Plan::events::sensors) {
        return data().step.events.sensor_begin;
    }
    [[nodiscard]] const buffer<sensor_event>& sensor_end_events() const requires(Plan::events::sensors) {
        return data().step.events.sensor_end;
    }
    /// Bodies that have fallen asleep in the last step, and those that have woken up in it or between it and the one
    /// before, in no order. They may have been destroyed since.
    [[nodiscard]] const buffer<body_id>& sleep_events() const requires(Plan::events::sleep) {
        return data().step.events.slept;
    }
    [[nodiscard]] const buffer<body_id>& wake_events() const requires(Plan::events::sleep) {
        return data().step.events.woken;
    }
    /// Bodies that the last step has moved or turned, in ascending order: those whose poses are to be written back to
    /// what is drawn. They may have been destroyed since.
    [[nodiscard]] const buffer<move_event>& move_events() const requires(Plan::events::moves) {
        return data().step.events.moved;
    }

private:
    using range = detail::own_contact_range<Plan>;
    using small_list = detail::small_buffer<shape_id, 16>;

    const auto& data() const { return detail::world_access::data_of(static_cast<const World&>(*this)); }
    template <class Which>
    [[nodiscard]] bool any_touching(std::uint32_t body, Which&& which) const {
        return detail::scoped([&] {
            for (const auto& c : range(data(), body, detail::no_shape))
                if (c.touching && which(c)) return true;
            return false;
        });
    }
};

PHYSICS_HPP_END
