// What stops a body on its way through a step: the shapes near by, and when it meets them.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/step/contact_rule.hpp"
#include "physics/step/extents.hpp"
#include "physics/step/nearby.hpp"
#include "physics/step/sweep_paths.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Sweeps a body along a way, from piece to piece and from shape to shape.
template <class Plan>
class sweep_search : protected body_paths<Plan> {
    using paths = body_paths<Plan>;

protected:
    using paths::contact_margin, paths::D, paths::motion_of, paths::moved_, paths::in_, paths::data_;
    using typename paths::body_sweep;
    using typename paths::S;
    using typename paths::swept_body_type;

    using paths::body_paths;

    /// Shapes that a body may meet on a way in a box, in ascending order.
    PHYSICS_HPP_COLD bool find_candidates(std::uint32_t body, const aabb<double, D>& path, bool everything) {
        auto& found = data_.candidates;
        found.clear();
        aabb<S, D> box;
        const double maximum = static_cast<double>(scalar_traits<S>::max());
        const double pose_error = 2 * static_cast<double>(scalar_traits<S>::epsilon());
        for (int i = 0; i < D; ++i) {
            if (!(path.lower[i] > -maximum && path.upper[i] < maximum)) return false;
            box.lower[i] = static_cast<S>(path.lower[i] - pose_error * (abs(path.lower[i]) + 1));
            box.upper[i] = static_cast<S>(path.upper[i] + pose_error * (abs(path.upper[i]) + 1));
        }
        if (!is_box(box)) return false;
        const auto add = [&](std::uint32_t shape) {
            const auto& record = in_.shapes[shape];
            if (record.body == body) return;
            if (!everything && in_.bodies[record.body].type != body_type::static_body) return;
            if constexpr (Plan::has_joints)
                if (in_.joints.keep_apart(body, record.body)) return;
            found.push_back(shape);
        };
        each_near(in_, box, query_filter{.any_category = true}, add, everything);
        if (everything)
            for (const auto& partner : data_.moving_bodies)
                if (overlap(partner.box, path))
                    each_solid_shape<Plan>(in_.bodies, in_.shapes, partner.body,
                                           [&](std::uint32_t k, const auto&) { add(k); });
        sort_once(found, data_.spare);
        return true;
    }
    static void sort_once(buffer<std::uint64_t>& numbers, buffer<std::uint64_t>& spare) {
        if (numbers.size() < 2) return;
        spare.resize(numbers.size());
        if (radix_sort(numbers.begin(), spare.begin(), numbers.size(), 0, 32) != numbers.begin()) numbers.swap(spare);
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < numbers.size(); ++i)
            if (kept == 0 || numbers[kept - 1] != numbers[i]) numbers[kept++] = numbers[i];
        numbers.resize(kept);
    }

    PHYSICS_HPP_COLD bool ends_in_something(const swept_body_type& m, const body_sweep& path) {
        const transform<S, D> end{path.end, path.turn == angular<S, D>{} ? path.rotation : path.at(S(1)).rotation};
        swept_body_type probe(m.body, m.number);
        probe.goes_far = false;
        sweep_body(probe, {end.position, end.position, end.rotation, {}, {}});
        return probe.stops;
    }
    /// Finds the first of the candidates that stops a body, of several at once that of the lowest number.
    PHYSICS_HPP_COLD void sweep_body(swept_body_type& m, const body_sweep& path) {
        m.stops = false;
        m.time = 1;
        each_solid_shape<Plan>(
            in_.bodies, in_.shapes, m.body, [&](std::uint32_t own, const shape_record<Plan>& record) {
                const mat<double, D> axes = to_matrix(record.local.rotation);
                const point<D> at = to_point(record.local.position) - to_point(in_.bodies[m.body].mass.center);
                record.shape.visit([&](const auto& shape) {
                    each_swept_piece(shape, everywhere(record.local.rotation),
                                     [&](const core<D>& c, const mat<double, D>& turned, const point<D>& where) {
                                         sweep_piece(m, path, own, c, axes * turned, axes * where + at);
                                     });
                });
            });
    }
    PHYSICS_HPP_COLD void sweep_piece(swept_body_type& m, const body_sweep& path, std::uint32_t own,
                                      const core<D>& piece, const mat<double, D>& axes, const point<D>& at) {
        const double thickness = inradius_of<Plan::few_corners>(piece);
        for (const std::uint64_t k : data_.candidates) {
            const auto number = static_cast<std::uint32_t>(k);
            const auto& record = in_.shapes[number];
            if (!may_meet(in_.shapes[own].filter, record.filter)) continue;
            if constexpr (Plan::has_contact_rule)
                if (in_.passing.has(own < number ? proxy_pair{own, number} : proxy_pair{number, own})) continue;
            const body_sweep other = motion_of(record.body);
            const obstacle o{
                other,
                moving_core<D>(piece, path, axes, at, to_point(other.start)),
                (to_point(path.end) - to_point(path.start)) - (to_point(other.end) - to_point(other.start)),
                to_matrix(record.local.rotation),
                to_point(record.local.position) - to_point(in_.bodies[record.body].mass.center),
                thickness,
                record.body,
                number,
                own};
            record.shape.visit([&](const auto& shape) { sweep_shape(shape, o, m); });
        }
    }
    /// A shape on the way of a piece: where it is on its body, and how the piece moves as seen from the body's centre.
    struct obstacle {
        const body_sweep& other;
        moving_core<D> mine;
        point<D> path;
        mat<double, D> axes;
        point<D> at;
        double thickness;
        std::uint32_t body, shape, own_shape;
    };

    template <class Shape>
    void sweep_shape(const Shape& shape, const obstacle& o, swept_body_type& m) {
        if constexpr (is_halfspace<Shape>) {
            const bounding_half<D> half(shape);
            sweep_core(half.surface_point(), mat<double, D>::identity(), {}, &half.normal, o, m);
        } else if constexpr (has_parts<Shape, D>) {
            point<D> center;
            const aabb<double, D> box = box_of_path(o, center);
            each_piece(
                shape, box, [&](const auto& part) { return faces(part, center); },
                [&](const core<D>& piece, const mat<double, D>& turned, const point<D>& where, std::uint32_t) {
                    sweep_core(piece, turned, where, nullptr, o, m);
                });
        } else if constexpr (has_core<Shape>) {
            sweep_core(core_of(shape), mat<double, D>::identity(), {}, nullptr, o, m);
        }
    }
    /// Whether the recipe's contact rule lets a shape stop what comes from afar.
    PHYSICS_HPP_COLD bool stops_by_rule([[maybe_unused]] const obstacle& o,
                                        [[maybe_unused]] const first_penetration<D>& found) const {
        if constexpr (Plan::has_contact_rule) {
            const typename contact_candidate<Plan>::context context{
                in_.bodies, in_.shapes, in_.contacts, in_.settings.contact_margin, this->h_, in_.tag};
            contact_candidate<Plan> candidate(context, o.shape, o.own_shape, from_point<S>(found.normal),
                                              static_cast<S>(found.gap));
            return accepts(candidate);
        }
        return true;
    }
    /// What a piece fills on its way, and its middle at the step's start, in the frame of the obstacle.
    PHYSICS_HPP_COLD aabb<double, D> box_of_path(const obstacle& o, point<D>& center) const {
        const mat<double, D> body = to_matrix(o.other.rotation), seen = transposed(body * o.axes);
        const point<D> origin = body * o.at, start = o.mine.start, end = o.mine.start + o.path;
        const double reach = (o.mine.reach + o.mine.shape.radius) + 2 * contact_margin();
        const placed_core<D> mine = o.mine.at(0, start);
        center = seen * (mine.axes * o.mine.shape.center + mine.at - origin);
        if (!(o.other.turn == angular<S, D>{})) {
            const point<D> middle = -transposed_times(o.axes, o.at);
            return grown(aabb<double, D>{middle, middle}, reach + max(length(start), length(end)));
        }
        const point<D> from = seen * (start - origin), to = seen * (end - origin);
        return grown(aabb<double, D>{min(from, to), max(from, to)}, reach);
    }
    /// A piece of an obstacle, which stands in its frame as given; of a halfspace a point, with its normal.
    PHYSICS_HPP_COLD void sweep_core(const core<D>& piece, const mat<double, D>& turned, const point<D>& where,
                                     const point<D>* face, const obstacle& o, swept_body_type& m) {
        const moving_core<D> a(piece, o.other, o.axes * turned, o.axes * where + o.at, to_point(o.other.start));
        const moving_core<D>& b = o.mine;
        const cast_precision precision = cast_precision::of<S>(piece, b.shape);
        const moving_pair<D> pair{
            a, b, o.path, face, piece.radius + b.shape.radius, precision.error, precision.relative};
        const double margin = contact_margin();
        if (!m.goes_far) {
            m.stops = m.stops || is_deeper<Plan::few_corners>(pair, margin * (1.0 / 32));
            return;
        }
        // What rounding of poses may do to a gap.
        const double epsilon = static_cast<double>(scalar_traits<S>::epsilon());
        const double size = largest(to_point(o.other.start)) + largest(b.start) + largest(o.path);
        const double pose_error = 4 * epsilon * (is_fixed<S> ? 1 + b.reach : size + b.reach);
        const bool thin = in_.bodies[o.body].is_dynamic();
        const double depth = detail::to_double(data_.depths[m.body]);
        const penetration_limits rule{margin + pose_error,
                                      margin * (1.0 / 64),
                                      margin * (1.0 / 64),
                                      thin ? min(o.thickness, inradius_of<Plan::few_corners>(piece)) : o.thickness,
                                      margin * (1.0 / 16) + pose_error,
                                      margin * (1.0 / 4) + depth + pose_error,
                                      pose_error,
                                      thin};
        const auto found = find_first_penetration<Plan::few_corners>(pair, rule, m.stops ? m.time : 1.0);
        m.converged = m.converged && found.converged;
        if (!found.stops || (m.stops && !(found.time < m.time)) || !stops_by_rule(o, found)) return;
        m.stops = true;
        m.time = found.time;
        m.other = o.body;
        m.normal = found.normal;
        m.gap = found.gap;
        m.touching = found.touching;
        m.push_out = found.push_out;
    }
};

}  // namespace detail

PHYSICS_HPP_END
