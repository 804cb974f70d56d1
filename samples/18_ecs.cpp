// Entities and components: bodies in a sparse set, hits that become damage, frames drawn between steps.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

using entity = std::uint32_t;

/// Components of one kind, side by side, with the entities that have them.
template <class Component>
class component_set {
public:
    Component& add(entity e, const Component& component) {
        if (e >= slots_.size()) slots_.resize(e + 1, none);
        slots_[e] = static_cast<std::uint32_t>(owners_.size());
        owners_.push_back(e);
        return components_.emplace_back(component);
    }
    /// The last one takes its place.
    void remove(entity e) {
        if (!has(e)) return;
        const std::uint32_t slot = slots_[e];
        slots_[owners_.back()] = slot;
        slots_[e] = none;
        owners_[slot] = owners_.back();
        components_[slot] = components_.back();
        owners_.pop_back();
        components_.pop_back();
    }
    [[nodiscard]] bool has(entity e) const { return e < slots_.size() && slots_[e] != none; }
    Component* find(entity e) { return has(e) ? &components_[slots_[e]] : nullptr; }
    /// Calls f(entity, component) from the last one on, so that f may remove the one that it is at.
    template <class F>
    void each(F&& f) {
        for (std::size_t i = owners_.size(); i-- > 0;) f(owners_[i], components_[i]);
    }
    [[nodiscard]] std::size_t size() const { return owners_.size(); }

private:
    static constexpr std::uint32_t none = 0xffffffff;
    std::vector<std::uint32_t> slots_;
    std::vector<entity> owners_;
    std::vector<Component> components_;
};

struct crates : physics::recipe<float, 2, physics::events<physics::event::hit>> {};
using world = physics::world<crates>;

struct rigid_body {
    physics::body_id id;
};
struct transform {
    world::transform pose;
};
struct health {
    float points;
};

struct registry {
    component_set<rigid_body> bodies;
    component_set<transform> transforms;
    component_set<health> healths;
    entity next = 1;

    void destroy(entity e) {
        bodies.remove(e);
        transforms.remove(e);
        healths.remove(e);
    }
};

entity spawn(registry& all, world& arena, float x, float y, float points) {
    const entity e = all.next++;
    const physics::body_id id = arena.create_body({.position = {x, y}, .user_data = e});
    arena.create_shape(id, world::box{{0.4f, 0.4f}});
    all.bodies.add(e, {id});
    all.transforms.add(e, {arena.pose(id)});
    all.healths.add(e, {points});
    return e;
}

}  // namespace

int main() {
    samples::film film("Entities", "a sparse set, and a world", "");
    world arena = scenes::grounded<world>();
    registry all;
    for (int i = 0; i < 60; ++i)
        spawn(all, arena, static_cast<float>(i % 10) * 1.1f, 1 + 1.5f * static_cast<float>(i / 10), 9);
    const std::size_t spawned = all.bodies.size();

    physics::accumulator<world> clock{{.step = 1.0f / 60}};
    std::size_t destroyed = 0;
    int steps = 0, dangling = 0;
    float largest_jump = 0;
    // Frames of 144 Hz, of which some take no step and others take one.
    for (int frame = 0; frame < 144 * 10; ++frame) {
        const auto report = clock.advance(arena, 1.0f / 144, physics::no_hook{}, [&](world& w) {
            // Events are those of the last step: they are read after each.
            for (const auto& h : w.hit_events())
                for (const physics::body_id body : {h.body_a, h.body_b})
                    if (health* hurt = all.healths.find(static_cast<entity>(w.user_data(body))))
                        hurt->points -= h.impulse;
            all.healths.each([&](entity e, const health& h) {
                if (h.points > 0) return;
                w.destroy_body(all.bodies.find(e)->id);
                all.destroy(e);
                ++destroyed;
            });
        });
        steps += report.steps;
        all.transforms.each([&](entity e, transform& t) {
            const physics::body_id id = all.bodies.find(e)->id;
            dangling += !arena.contains(id);
            const world::transform last = std::exchange(t.pose, clock.interpolated(arena, id));
            largest_jump = std::max(largest_jump, length(t.pose.position - last.position));
        });
    }
    film.expect("steps in ten seconds of frames of 1/144 s", steps, 599, 600);
    film.expect("entities with bodies, and bodies in the world", static_cast<double>(all.bodies.size()),
                arena.body_count() - 1);
    film.expect("entities destroyed by hits", static_cast<double>(destroyed), 1, static_cast<double>(spawned) - 1);
    film.expect("entities left", static_cast<double>(all.bodies.size()), static_cast<double>(spawned - destroyed));
    film.expect("components whose body is gone", dangling, 0);
    film.expect("farthest from frame to frame, m", largest_jump, 0.01, 0.11);
    return film.finish();
}
