// Sensors: shapes that stop nothing, and tell what is inside them.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/step/collide.hpp"
#include "physics/step/find_pairs.hpp"
#include "physics/step/nearby.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Which pairs of shapes a world with sensors looks at: kinematic bodies are movable in its broadphase, so that sensors
/// see them, but push nothing that cannot be pushed.
template <class Plan>
struct sensor_pair_filter {
    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const sleep_of<Plan>& sleep;
    const bit_array& is_sensor;

    bool operator()(std::uint32_t a, std::uint32_t b) const {
        return is_sensor[a] || is_sensor[b] || is_awake_dynamic(bodies, sleep, shapes[a].body) ||
               is_awake_dynamic(bodies, sleep, shapes[b].body);
    }
};
/// Pairs of shapes whose boxes overlap, of which one can be pushed, or is a sensor.
template <class Plan>
const buffer<proxy_pair>& find_pairs(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes,
                                     const sleep_of<Plan>& sleep, const sensor_state& sensors,
                                     typename Plan::broadphase& broadphase, arena& scratch) {
    return find_pairs(broadphase, sensor_pair_filter<Plan>{bodies, shapes, sleep, sensors.is_sensor}, scratch);
}
/// Those of shapes that are no sensors.
inline const buffer<proxy_pair>& without_sensors(const buffer<proxy_pair>& pairs, const sensor_state& sensors,
                                                 buffer<proxy_pair>& spare) {
    if (sensors.count == 0) return pairs;
    spare.clear();
    for (const proxy_pair& p : pairs)
        if (!sensors.is_sensor[p.a] && !sensors.is_sensor[p.b]) spare.push_back(p);
    return spare;
}

/// Of a sensor and a visitor.
template <class Plan>
sensor_event sensor_event_of(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes, proxy_pair p) {
    const auto e = event_of<contact_event, Plan>(bodies, shapes, p);
    return {e.shape_a,      e.shape_b,     e.body_a,      e.body_b, e.shape_data_a,
            e.shape_data_b, e.body_data_a, e.body_data_b, false};
}
/// Forgets what is in a shape, and in which sensors it is. Nothing fails after sensors.prepare_removal.
template <class Plan>
void drop_visitors(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes, sensor_state& sensors,
                   std::uint32_t shape) {
    const auto drop = [&](std::uint32_t i) {
        sensors.dropped.push_back(sensor_event_of<Plan>(bodies, shapes, sensors.inside[i]));
        sensors.dropped.back().gone = true;
        sensors.gone.set(i);
    };
    sensors.each_of_sensor(shape, drop);
    sensors.each_of_visitor(shape, drop);
}

/// What the sensors of a world see.
template <class Plan>
struct sensor_input {
    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const awake_list& awake;
    const joints_of<Plan>& joints;
    const sleep_of<Plan>& sleep;
    const typename Plan::settings& settings;
    const typename Plan::broadphase& broadphase;
    std::uint16_t tag;
};

/// Poses at the end of a step, pairs of boxes -> what is in which sensor, and what has come and gone.
template <class Plan>
class sensor_update {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    sensor_update(const sensor_input<Plan>& in, manifold_list<S, D>& manifolds) : in_(in), manifolds_(manifolds) {}

    void run(const buffer<proxy_pair>& pairs, sensor_state& sensors, step_events<S, D>& to) {
        to.clear_sensor_events();
        list_inside(pairs, sensors, to.passed, to.overlaps);
        auto &before = sensors.inside, &now = to.overlaps, &next = to.now_inside;
        next.clear();
        for (std::uint32_t i = 0, k = 0; i < before.size() || k < now.size();) {
            if (i < before.size() && sensors.gone.has(i)) {
                ++i;
            } else if (i < before.size() && k < now.size() && before[i] == now[k]) {
                next.push_back(now[k]);
                ++i, ++k;
            } else if (k == now.size() || (i < before.size() && before[i] < now[k])) {
                const proxy_pair p = before[i++];
                if (rests(p)) next.push_back(p);
                else to.sensor_end.push_back(sensor_event_of<Plan>(in_.bodies, in_.shapes, p));
            } else {
                next.push_back(now[k]);
                to.sensor_begin.push_back(sensor_event_of<Plan>(in_.bodies, in_.shapes, now[k++]));
            }
        }
        to.sensor_end.reserve(to.sensor_end.size() + sensors.dropped.size());
        for (const sensor_event& e : sensors.dropped) to.sensor_end.push_back(e);
        if (!sensors.dropped.empty())
            sort_in_place(
                to.sensor_end.begin(), to.sensor_end.size(), [](const sensor_event& x, const sensor_event& y) {
                    return proxy_pair{x.sensor.index, x.visitor.index} < proxy_pair{y.sensor.index, y.visitor.index};
                });
        sensors.set_inside(next);
        for (auto* events : {&to.sensor_begin, &to.sensor_end})
            for (sensor_event& e : *events)
                e.sensor.world = e.visitor.world = e.sensor_body.world = e.visitor_body.world = in_.tag;
    }

private:
    void list_inside(const buffer<proxy_pair>& pairs, const sensor_state& sensors, const buffer<proxy_pair>& passed,
                     buffer<proxy_pair>& now) {
        now.clear();
        for (const proxy_pair& p : pairs) {
            const bool a = sensors.is_sensor[p.a];
            if (!a && !sensors.is_sensor[p.b]) continue;
            const proxy_pair of = a ? p : proxy_pair{p.b, p.a};
            const std::uint32_t visitor = in_.shapes[of.b].body;
            if (in_.bodies[visitor].type != body_type::static_body && sees(of)) now.push_back(of);
        }
        for (const std::uint32_t i : sensors.of_static) add_static(i, now);
        for (const proxy_pair p : passed) now.push_back(p);
        sort_in_place(now.begin(), now.size(), [](proxy_pair x, proxy_pair y) { return x < y; });
        std::uint32_t kept = 0;
        for (const proxy_pair p : now)
            if (kept == 0 || !(now[kept - 1] == p)) now[kept++] = p;
        now.resize(kept);
    }
    /// What stands has no pairs in the broadphase.
    PHYSICS_HPP_COLD void add_static(std::uint32_t sensor, buffer<proxy_pair>& now) {
        const auto& from = in_.shapes[sensor];
        if (!in_.bodies[from.body].enabled) return;
        query_filter filter{.any_category = true};
        filter.kinds = static_bodies;
        each_near(
            in_, query_bounds(in_, from), filter,
            [&](std::uint32_t other) {
                const auto& there = in_.shapes[other];
                if (there.body != from.body && may_meet(from.filter, there.filter) && sees({sensor, other}))
                    now.push_back({sensor, other});
                return true;
            },
            false);
    }
    /// Whether what is not kept apart by joints overlaps.
    [[nodiscard]] bool sees(proxy_pair of) {
        if constexpr (Plan::has_joints)
            if (in_.joints.keep_apart(in_.shapes[of.a].body, in_.shapes[of.b].body)) return false;
        return overlap(of);
    }
    [[nodiscard]] bool overlap(proxy_pair pair) {
        const proxy_pair p = in_order_of_kinds(in_.shapes, pair);
        const auto& a = in_.shapes[p.a];
        const auto& b = in_.shapes[p.b];
        const typename Plan::query query{&a.shape, &b.shape, relative(a.pose, b.pose)};
        collide_once<Plan>(query, S(0), manifolds_);
        for (const auto& [number, part, m] : manifolds_)
            for (int k = 0; k < m.count; ++k)
                if (!(m.points[k].separation > S(0))) return true;
        return false;
    }
    /// Pairs of what stands and what sleeps are not among those of the broadphase; static visitors are always looked
    /// for.
    [[nodiscard]] bool rests(proxy_pair p) const {
        const std::uint32_t a = in_.shapes[p.a].body, b = in_.shapes[p.b].body;
        return !in_.awake.has(a) && !in_.awake.has(b) && in_.bodies[b].type != body_type::static_body;
    }

    const sensor_input<Plan>& in_;
    manifold_list<S, D>& manifolds_;
};

}  // namespace detail

PHYSICS_HPP_END
