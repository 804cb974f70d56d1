// How a body takes part in its world: as what type, enabled or not, awake or asleep.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/world/ranges.hpp"
#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The bodies of a dynamic body's island, in ascending order; none of others.
template <class Plan>
buffer<body_id> island_of(const world_data<Plan>& s, std::uint32_t body) {
    buffer<std::uint32_t> found;
    if (s.is_awake_dynamic(body)) {
        bit_array seen;
        seen.grow(s.bodies.slots());
        const auto add = [&](std::uint32_t i) {
            if (!s.is_awake_dynamic(i) || seen[i]) return;
            seen.set(i);
            found.push_back(i);
        };
        add(body);
        for (std::uint32_t k = 0; k < found.size(); ++k) {
            const std::uint32_t i = found[k];
            const body_id self{i, s.bodies.generation(i), s.tag};
            for (const auto& c : own_contact_range<Plan>(s, i, no_shape))
                if (c.touching) add(c.other(self).index);
            each_connected(s.joints, i, add);
        }
    } else if constexpr (Plan::sleeps) {
        if (s.is_asleep(body)) each_of_island(s.sleep, body, [&](std::uint32_t i) { found.push_back(i); });
    }
    sort_in_place(found.begin(), found.size(), [](std::uint32_t a, std::uint32_t b) { return a < b; });
    buffer<body_id> result;
    for (const std::uint32_t i : found) result.push_back({i, s.bodies.generation(i), s.tag});
    return result;
}

}  // namespace detail

/// Types and sleep of the bodies of a world.
template <class World, class Plan>
class body_functions {
    using code = detail::world_code<Plan>;

public:
    [[nodiscard]] body_type type(body_id id) const {
        const auto b = detail::find_body(data(), id, "type");
        return b ? data().bodies[b.index].given_type : body_type::static_body;
    }
    /// Changes how a body moves; a static body loses its velocity. O(shapes + contacts).
    void set_type(body_id id, body_type type) {
        if (const auto b = detail::find_body(data(), id, "set_type")) code::set_type(data(), b.index, type);
    }
    [[nodiscard]] bool enabled(body_id id) const {
        const auto b = detail::find_body(data(), id, "enabled");
        return b && data().bodies[b.index].enabled;
    }
    /// Takes a body out of the simulation, or puts it back, as it is: it stands where it is, meets nothing, no query
    /// finds it and its joints hold nothing. All of it may be changed meanwhile, but forces, impulses and targets,
    /// which are refused. Its contacts end, and what touched it wakes; so does what it meets when it comes back. In
    /// contrast to destroy_body its handle, shapes, joints and velocities stay. Nothing of it counts as energy.
    /// Cost: as of destroy_body.
    void set_enabled(body_id id, bool enabled) {
        if (const auto b = detail::find_body(data(), id, "set_enabled")) code::set_enabled(data(), b.index, enabled);
    }

    /// True while the body sleeps: an island of bodies that has been still for long enough (settings().sleeping) leaves
    /// the step, until something touches it or a call changes it. Sleepers cost nothing.
    [[nodiscard]] bool is_asleep(body_id id) const {
        const auto b = detail::find_body(data(), id, "is_asleep");
        return b && data().is_asleep(b.index);
    }
    /// Wakes a body and its island. O(bodies + shapes of the island).
    void wake(body_id id) {
        if (const auto b = detail::find_body(data(), id, "wake")) code::wake(data(), b.index, b.index);
    }
    /// False keeps a body awake, and those that touch it.
    [[nodiscard]] bool can_sleep(body_id id) const {
        const auto b = detail::find_body(data(), id, "can_sleep");
        return b && data().bodies[b.index].can_sleep;
    }
    void set_can_sleep(body_id id, bool can) {
        const auto b = detail::find_body(data(), id, "set_can_sleep");
        if (!b) return;
        if (!can) code::wake(data(), b.index, b.index);
        data().bodies[b.index].can_sleep = can;
    }
    /// Number of dynamic bodies that are awake, and of kinematic ones that move. O(bodies).
    [[nodiscard]] std::uint32_t awake_count() const { return detail::count_awake(data()); }
    /// The island of a dynamic body, in ascending order: itself, and all dynamic ones that touch it or are held to it
    /// by joints, directly or through others; of a sleeper those that fell asleep with it. Empty for other bodies.
    /// O(bodies / 64 + contacts and joints of the island).
    [[nodiscard]] buffer<body_id> island(body_id id) const {
        const auto b = detail::find_body(data(), id, "island");
        return b ? detail::scoped([&] { return detail::island_of(data(), b.index); }) : buffer<body_id>{};
    }

private:
    const auto& data() const { return detail::world_access::data_of(static_cast<const World&>(*this)); }
    auto& data() { return detail::world_access::data_of(static_cast<World&>(*this)); }
};

PHYSICS_HPP_END
