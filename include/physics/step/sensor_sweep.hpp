// What passes through sensors within a step.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/collide/time_of_impact.hpp"
#include "physics/step/extents.hpp"
#include "physics/step/nearby.hpp"
#include "physics/step/sweep_paths.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What a search for what passes through sensors reads of a world, after its step.
template <class Plan>
struct sensor_sweep_input {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const typename Plan::broadphase& broadphase;
    const awake_list& awake;
    const sleep_of<Plan>& sleep;
    const joints_of<Plan>& joints;
    const buffer<body_extent<S>>& extents;
    const typename Plan::settings& settings;
    /// Where the centres of awake bodies were as the step began, and how they were turned.
    const buffer<transform<S, D>>& starts;
};

/// Poses before and after a step -> pairs of a sensor and a shape that overlapped during it, though they may be apart
/// again. Bodies that go no farther than their shapes are thick are not looked at: only corners could be missed. Paths
/// are straight lines, on which bodies turn evenly. O(awake bodies + what is near those that go far).
template <class Plan>
class sensor_sweep {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    sensor_sweep(const sensor_sweep_input<Plan>& in, S h) : in_(in), h_(h) {}

    PHYSICS_HPP_NOINLINE void run(const sensor_state& sensors, buffer<far_body<D>>& far, buffer<proxy_pair>& passed) {
        passed.clear();
        far.clear();
        if (sensors.count == 0) return;
        for (const std::uint32_t i : in_.awake) list_if_far(i, far);
        for (std::uint32_t k = 0; k < far.size(); ++k) list_near(k, far, passed);
        sort_in_place(passed.begin(), passed.size(), [](proxy_pair x, proxy_pair y) { return x < y; });
        std::uint32_t kept = 0;
        proxy_pair last{};
        for (std::uint32_t i = 0; i < passed.size(); ++i) {
            const proxy_pair p = passed[i];
            if (p == std::exchange(last, p)) continue;
            // What was inside is there, or leaves.
            const std::uint32_t at = count_before(sensors.inside, [&](const proxy_pair& q) { return q < p; });
            if (at < sensors.inside.size() && sensors.inside[at] == p && !sensors.gone.has(at)) continue;
            if (meet(in_.shapes[p.a], in_.shapes[p.b])) passed[kept++] = p;
        }
        passed.resize(kept);
    }

private:
    using body_sweep = sweep<S, D>;

    void list_if_far(std::uint32_t i, buffer<far_body<D>>& far) const {
        const auto& b = in_.bodies[i];
        const point<D> start = to_point(in_.starts[i].position), end = to_point(b.center);
        bool has_sensors = false;
        double thickness = to_double(in_.extents[i].thickness), reach = in_.extents[i].outer;
        each_shape(in_.bodies, in_.shapes, i, [&](std::uint32_t, const shape_record<Plan>& shape) {
            if (!shape.sensor) return;
            has_sensors = true;
            const auto own = measure_shape(shape, b);
            thickness = min(thickness, to_double(own.thickness));
            reach = max(reach, own.outer);
        });
        if (length(end - start) + angle_of(b, in_.starts[i].rotation) * reach > thickness)
            far.push_back({i, grown(aabb<double, D>{min(start, end), max(start, end)}, reach), has_sensors});
    }
    /// By which angle a body has turned, at most.
    [[nodiscard]] double angle_of([[maybe_unused]] const typename Plan::body& b,
                                  [[maybe_unused]] const rotation<S, D>& start) const {
        if constexpr (!Plan::rotates) {
            return 0;
        } else {
            const double by_speed = magnitude(to_turn(b.velocity.angular)) * to_double(h_);
            if (b.rotation == start || by_speed > 2) return by_speed;
            // Of a rotation by a the numbers differ by 2 sin(a / 2) in 2D, of a quaternion by 2 sin(a / 4).
            const auto squared = [](S x, S y) { return (to_double(x) - to_double(y)) * (to_double(x) - to_double(y)); };
            if constexpr (D == 2) {
                return pi<double> / 2 *
                       sqrt(squared(b.rotation.cosine, start.cosine) + squared(b.rotation.sine, start.sine));
            } else {
                const vec<S, D> v = b.rotation.imaginary(), from = start.imaginary();
                return pi<double> * sqrt(squared(v.x, from.x) + squared(v.y, from.y) + squared(v.z, from.z) +
                                         squared(b.rotation.w, start.w));
            }
        }
    }
    /// Pairs of a body that goes far: with shapes near its path, and with others that go far.
    PHYSICS_HPP_COLD void list_near(std::uint32_t number, const buffer<far_body<D>>& far,
                                    buffer<proxy_pair>& to) const {
        const far_body<D>& own = far[number];
        aabb<S, D> box;
        // Of fixed point the range in double may be rounded up.
        const double maximum = to_double(scalar_traits<S>::max()) * (1 - 0x1p-24);
        for (int i = 0; i < D; ++i) {
            // Both ends by both: the body may be where the range ends.
            box.lower[i] = static_cast<S>(clamp(own.box.lower[i], -maximum, maximum));
            box.upper[i] = static_cast<S>(clamp(own.box.upper[i], -maximum, maximum));
        }
        const auto add = [&](std::uint32_t other) {
            each_shape(in_.bodies, in_.shapes, own.body, [&](std::uint32_t i, const shape_record<Plan>& shape) {
                if (shape.sensor && may_visit(shape, in_.shapes[other])) to.push_back({i, other});
                if (in_.shapes[other].sensor && may_visit(in_.shapes[other], shape)) to.push_back({other, i});
            });
        };
        each_near(in_, box, query_filter{.any_category = true, .sensors = true}, add);
        for (std::uint32_t k = number + 1; k < far.size(); ++k)
            if ((own.has_sensors || far[k].has_sensors) && overlap(far[k].box, own.box))
                each_shape(in_.bodies, in_.shapes, far[k].body,
                           [&](std::uint32_t i, const shape_record<Plan>&) { add(i); });
    }
    [[nodiscard]] bool may_visit(const shape_record<Plan>& sensor, const shape_record<Plan>& visitor) const {
        if (visitor.sensor || visitor.body == sensor.body || !may_meet(sensor.filter, visitor.filter)) return false;
        if (in_.bodies[visitor.body].type == body_type::static_body) return false;
        if constexpr (Plan::has_joints) return !in_.joints.keep_apart(sensor.body, visitor.body);
        return true;
    }

    [[nodiscard]] body_sweep motion_of(std::uint32_t i) const {
        const auto& b = in_.bodies[i];
        if (!in_.awake.has(i)) return {b.center, b.center, b.rotation, {}, {}};
        return sweep_of_step<Plan::rotates>(in_.starts[i], {b.center, b.rotation}, b.velocity, h_);
    }
    /// Calls f(piece, how it moves as seen from a point) for the convex pieces of a shape.
    template <class F>
    void each_moving_piece(const shape_record<Plan>& record, const body_sweep& w, const point<D>& origin, F&& f) const {
        const mat<double, D> axes = to_matrix(record.local.rotation);
        const point<D> at = to_point(record.local.position) - to_point(in_.bodies[record.body].mass.center);
        record.shape.visit([&](const auto& shape) {
            each_swept_piece(shape, everywhere(record.local.rotation),
                             [&](const core<D>& c, const mat<double, D>& turned, const point<D>& where) {
                                 f(c, moving_core<D>(c, w, axes * turned, axes * where + at, origin),
                                   static_cast<const point<D>*>(nullptr));
                             });
            if constexpr (is_halfspace<std::remove_cvref_t<decltype(shape)>>) {
                const bounding_half<D> half(shape);
                f(half.surface_point(), moving_core<D>(half.surface_point(), w, axes, at, origin), &half.normal);
            }
        });
    }
    PHYSICS_HPP_COLD bool meet(const shape_record<Plan>& sensor, const shape_record<Plan>& visitor) const {
        const body_sweep of_a = motion_of(sensor.body), of_b = motion_of(visitor.body);
        const point<D> origin = to_point(of_a.start);
        const point<D> path = (to_point(of_b.end) - to_point(of_b.start)) - (to_point(of_a.end) - to_point(of_a.start));
        bool found = false;
        each_moving_piece(
            sensor, of_a, origin, [&](const core<D>& a, const moving_core<D>& sensor_moves, const point<D>* face) {
                each_moving_piece(visitor, of_b, origin,
                                  [&](const core<D>& b, const moving_core<D>& moves, const point<D>* other_face) {
                                      if (found || other_face != nullptr) return;
                                      const cast_precision precision = cast_precision::of<S>(a, b);
                                      const moving_pair<D> pair{
                                          sensor_moves,      moves, path, face, a.radius + b.radius, precision.error,
                                          precision.relative};
                                      const impact_state state = first_impact(pair, 0, 0).state;
                                      found = state == impact_state::hit || state == impact_state::overlapping;
                                  });
            });
        return found;
    }

    const sensor_sweep_input<Plan>& in_;
    S h_;
};

}  // namespace detail

PHYSICS_HPP_END
