// Continuous collision in a world: fast bodies are stopped where they would pass into something.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/world/extents.hpp"
#include "physics/world/queries.hpp"
#include "physics/world/ways.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The sweeps of one step. It reads poses at the step's start and the solver's; what stops bodies is applied when all
/// is known, so that no order of bodies matters.
template <class Plan>
class body_sweeps : body_paths<Plan> {
    using paths = body_paths<Plan>;
    using paths::box_of, paths::crosses, paths::D, paths::h_, paths::keeps_clear, paths::contact_margin,
        paths::length_of, paths::motion_of, paths::moved_, paths::s_, paths::motion_of_body;
    using typename paths::body_sweep;
    using typename paths::S;
    using typename paths::swept_body_type;
    using policy = typename Plan::continuous;

public:
    using paths::paths;

    PHYSICS_HPP_NOINLINE void run() {
        auto& report = s_.continuous.report;
        report = {};
        if (find_swept_bodies()) sweep_all(report);
    }

private:
    buffer<swept_body_type>& swept_bodies() { return s_.continuous.swept_bodies; }

    PHYSICS_HPP_COLD void sweep_all(continuous_report<S>& report) {
        report.swept = swept_bodies().size();
        if (any_flagged_) list_moving_bodies();
        for (swept_body_type& m : swept_bodies()) find_stop(m);
        for (swept_body_type& m : swept_bodies()) stop_other(m);
        for (swept_body_type& m : swept_bodies()) stop(m);
    }
    bool find_swept_bodies() {
        auto& pushers = s_.continuous.pushers;
        pushers.clear();
        const S thinnest = list_swept_bodies();
        if (fastest_ > detail::to_double(thinnest)) {
            for (auto& p : pushers) p.box = box_of(motion_of(p.body), s_.continuous.extents[p.body].outer);
            list_swept_bodies();
        }
        return !swept_bodies().empty();
    }
    /// Gives the thickness of the thinnest dynamic body, so that what slow kinematic ones pass is not looked for.
    S list_swept_bodies() {
        swept_bodies().clear();
        const bool anew = !s_.continuous.pushers.empty();
        S thinnest = scalar_traits<S>::max();
        for (std::uint32_t k = 0; k < s_.awake.size(); ++k) {
            const std::uint32_t i = s_.awake[k];
            const auto& b = s_.bodies[i];
            const body_motion<S, D> own = motion_of_body(k, b);
            if (!b.is_dynamic()) {
                double far = detail::to_double(length_of(own.turn)) * s_.continuous.extents[i].outer;
                for (int axis = 0; axis < D; ++axis) far += abs(detail::to_double(own.translation[axis]));
                // By velocities drums and paddles go far all the time: what they pass is not looked for.
                if (anew || !b.has_target || !(far > 0)) continue;
                s_.continuous.pushers.push_back({i, {}});
                fastest_ = max(fastest_, far);
                continue;
            }
            thinnest = min(thinnest, own.thickness);
            const body_motion<S, D> path = anew ? as_pushed(k, b, own) : own;
            const auto against = policy::sweep_against(path);
            if (against == sweep_target::nothing) continue;
            const bool everything = against == sweep_target::everything;
            swept_body_type m(i, k, against);
            m.goes_far = everything || path.bound() > path.thickness * S(0.5) - path.depth;
            swept_bodies().push_back(m);
            any_flagged_ = any_flagged_ || everything;
        }
        return thinnest;
    }
    /// The stride of a body as seen from the first kinematic one that may pass its middle; it counts as flagged then.
    PHYSICS_HPP_COLD body_motion<S, D> as_pushed(std::uint32_t k, const typename Plan::body& b,
                                                 const body_motion<S, D>& own) {
        const point<D> start = to_point(b.center), end = to_point(moved_[k].center);
        const aabb<double, D> box =
            grown(aabb<double, D>{min(start, end), max(start, end)}, s_.continuous.extents[s_.awake[k]].outer);
        for (const auto& p : s_.continuous.pushers) {
            if (!overlap(p.box, box)) continue;
            const auto& from = s_.bodies[p.body];
            const vec<S, D> velocity_of_pusher =
                velocity_at(moved_.velocity(s_.awake_index[p.body]), b.center - from.center) * h_;
            body_motion<S, D> seen = own, alone = own;
            seen.translation -= velocity_of_pusher;
            alone.translation = velocity_of_pusher;
            seen.flagged = true;
            if (seen.bound() > own.thickness && alone.bound() > own.thickness && crosses(k, b, p.body)) return seen;
        }
        return own;
    }

    /// What moves, and may be far from where the broadphase knows it.
    void list_moving_bodies() {
        s_.continuous.moving_bodies.clear();
        const auto add = [&](std::uint32_t i) {
            s_.continuous.moving_bodies.push_back({i, box_of(motion_of(i), s_.continuous.extents[i].outer)});
        };
        std::uint32_t next = 0;
        for (std::uint32_t k = 0; k < s_.awake.size(); ++k) {
            const std::uint32_t i = s_.awake[k];
            const bool goes_far = next < swept_bodies().size() && swept_bodies()[next].number == k;
            if (goes_far) ++next;
            if (goes_far || !s_.bodies[i].is_dynamic()) add(i);
        }
    }

    /// Shapes that a body may meet on a way in a box, in ascending order.
    PHYSICS_HPP_COLD bool find_candidates(std::uint32_t body, const aabb<double, D>& path, bool everything) {
        auto& found = s_.continuous.candidates;
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
        const proxy_filter own{.owner = body, .movable = true};
        const auto add = [&](std::uint32_t shape) {
            const auto& record = s_.shapes[shape];
            if (!everything && s_.bodies[record.body].type != body_type::static_body) return;
            if (may_meet(own, filter_of(s_, record))) found.push_back(shape);
        };
        each_near(s_, box, query_filter{.category = all_categories, .movable = everything}, add);
        if (everything)
            for (const auto& partner : s_.continuous.moving_bodies)
                if (overlap(partner.box, path))
                    each_shape(s_, partner.body, [&](std::uint32_t k, const auto&) { add(k); });
        sort_once(found, s_.continuous.spare);
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

    /// What does not go far passes through nothing: it is enough to look where it ends.
    void find_stop(swept_body_type& m) {
        const bool everything = m.against == sweep_target::everything;
        aabb<double, D> box;
        if (keeps_clear(m, box) && !everything) return;
        if (!find_candidates(m.body, box, everything)) m.converged = false;
        if (s_.continuous.candidates.empty()) return;
        const body_sweep path = motion_of(m.body);
        m.goes_far = m.goes_far || ends_in_something(m, path);
        if (m.goes_far) sweep_body(m, path);
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
        each_shape(s_, m.body, [&](std::uint32_t, const shape_record<Plan>& record) {
            const mat<double, D> axes = to_matrix(record.local.rotation);
            const point<D> at = to_point(record.local.position) - to_point(s_.bodies[m.body].mass.center);
            record.shape.visit([&](const auto& shape) {
                each_swept_piece(shape, everywhere(record.local.rotation),
                                 [&](const core<D>& c, const mat<double, D>& turned, const point<D>& where) {
                                     sweep_piece(m, path, c, axes * turned, axes * where + at);
                                 });
            });
        });
    }
    PHYSICS_HPP_COLD void sweep_piece(swept_body_type& m, const body_sweep& path, const core<D>& piece,
                                      const mat<double, D>& axes, const point<D>& at) {
        const double thickness = inradius_of<Plan::few_corners>(piece);
        for (const std::uint64_t k : s_.continuous.candidates) {
            const auto& record = s_.shapes[static_cast<std::uint32_t>(k)];
            const body_sweep other = motion_of(record.body);
            const obstacle o{
                other,
                moving_core<D>(piece, path, axes, at, to_point(other.start)),
                (to_point(path.end) - to_point(path.start)) - (to_point(other.end) - to_point(other.start)),
                to_matrix(record.local.rotation),
                to_point(record.local.position) - to_point(s_.bodies[record.body].mass.center),
                thickness,
                record.body};
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
        std::uint32_t body;
    };

    template <class Shape>
    void sweep_shape(const Shape& shape, const obstacle& o, swept_body_type& m) {
        if constexpr (is_halfspace<Shape>) {
            const bounding_half<D> half(shape);
            core<D> surface;
            surface.corner[0] = half.normal * half.offset;
            sweep_core(surface, mat<double, D>::identity(), {}, &half.normal, o, m);
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
        const bool thin = s_.bodies[o.body].is_dynamic();
        const double depth = detail::to_double(s_.continuous.depths[m.body]);
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
        if (!found.stops || (m.stops && !(found.time < m.time))) return;
        m.stops = true;
        m.time = found.time;
        m.other = o.body;
        m.normal = found.normal;
        m.gap = found.gap;
        m.touching = found.touching;
    }

    /// A dynamic body that goes far itself must not go on through the body that was stopped on its way.
    void stop_other(const swept_body_type& m) {
        if (!m.stops || !s_.bodies[m.other].is_dynamic()) return;
        swept_body_type* other = find_swept_body(s_.awake_index[m.other]);
        if (other == nullptr || (other->cut && !(m.time < other->cut_time))) return;
        other->cut = true;
        other->cut_time = m.time;
    }
    swept_body_type* find_swept_body(std::uint32_t number) {
        std::uint32_t low = 0, high = swept_bodies().size();
        while (low < high) {
            const std::uint32_t middle = (low + high) / 2;
            if (number > swept_bodies()[middle].number) low = middle + 1;
            else high = middle;
        }
        return low < swept_bodies().size() && swept_bodies()[low].number == number ? &swept_bodies()[low] : nullptr;
    }

    /// A body whose inertia depends on the axis spins on as seen from itself: else it would change its energy.
    void turn_back(std::uint32_t number, const rotation<S, D>& to) {
        auto& b = moved_[number];
        if constexpr (D == 3)
            if (b.gyroscopic) {
                vec<S, 3>& w = moved_.velocity(number).angular;
                w = to * inverse_rotate(b.rotation, w);
            }
        b.rotation = to;
    }
    PHYSICS_HPP_COLD void stop(swept_body_type& m) {
        const bool is_cut = m.cut && !(m.stops && m.time < m.cut_time);
        const double time = is_cut ? m.cut_time : m.time;
        auto& report = s_.continuous.report;
        if ((is_cut || m.stops) && time < 1) {
            const body_sweep path = motion_of(m.body);
            transform<S, D> at = path.at(rounded_down<S>(time));
            const body_type type = s_.bodies[m.other].type;
            const bool slides = !is_cut && type == body_type::static_body && m.against == sweep_target::fixed;
            if (slides) at.position = slid_along(m, at, path.end);
            else if (!is_cut && type == body_type::kinematic_body) at = carried(m, at);
            moved_[m.number].center = at.position;
            if constexpr (Plan::rotates)
                if (!slides || !(path.turn == angular<S, D>{})) turn_back(m.number, at.rotation);
            const S lost = static_cast<S>(1 - time) * h_;
            // What gravity has given for the lost time would make a bounce higher than the fall.
            vec<S, D>& v = moved_.velocity(m.number).linear;
            const vec<S, D> ahead = slides ? from_point<S>(m.normal) : normalized(v);
            if (!slides || !m.touching)
                v -= ahead * (dot(ahead, s_.settings.gravity) * s_.bodies[m.body].gravity_scale * lost);
            ++report.stopped;
            report.lost = max(report.lost, lost);
        }
        if (!m.converged) ++report.unconverged;
    }
    /// What a static body has stopped goes on along its surface for the rest of the step, until something else stops
    /// it.
    PHYSICS_HPP_COLD vec<S, D> slid_along(swept_body_type& m, const transform<S, D>& at, const vec<S, D>& end) {
        const double margin = contact_margin();
        point<D> path = to_point(end) - to_point(at.position);
        path -= m.normal * dot(m.normal, path);
        // Just outside, the solver stops it at once.
        if (m.gap > margin * (-1.0 / 8)) path += m.normal * max(margin * (1.0 / 64) - m.gap, 0.0);
        const body_sweep along{at.position, at.position + from_point<S>(path), at.rotation, {}, {}};
        if (dot(path, path) <= margin * margin * (1.0 / 64)) return along.end;
        return continue_from(m, along).position;
    }
    /// Where a body comes on a way after its stop, as far as static ones let it.
    PHYSICS_HPP_COLD transform<S, D> continue_from(swept_body_type& m, const body_sweep& path) {
        swept_body_type again(m.body, m.number);
        const double reach = s_.continuous.extents[m.body].outer + contact_margin();
        again.converged = find_candidates(m.body, box_of(path, reach), false);
        sweep_body(again, path);
        m.converged = m.converged && again.converged;
        return path.at(rounded_down<S>(again.time));
    }
    /// What a kinematic body has caught it takes along for the rest of the step, as far as static ones let it: nothing
    /// holds the kinematic one up.
    PHYSICS_HPP_COLD transform<S, D> carried(swept_body_type& m, const transform<S, D>& at) {
        const body_sweep other = motion_of(m.other);
        const transform<S, D> there = other.at(rounded_down<S>(m.time));
        const auto& moved = moved_[s_.awake_index[m.other]];
        const transform<S, D> then{moved.center, rotation_after(moved, s_.bodies[m.other])};
        const transform<S, D> end = then * relative(there, at);
        const body_sweep path = sweep_between<S, D>(at, {end.position, normalized(end.rotation)});
        return continue_from(m, path);
    }

    bool any_flagged_ = false;
    /// How far a point of a kinematic body goes, at most.
    double fastest_ = 0;
};

/// Stops bodies that would have passed into something; see the recipe's policy.
template <class Plan>
void sweep_fast_bodies(state<Plan>& s, moved_bodies<typename Plan::scalar, Plan::dimension, Plan::rotates> moved,
                       typename Plan::scalar h) {
    if constexpr (Plan::sweeps) body_sweeps<Plan>(s, moved, h).run();
}

}  // namespace detail

PHYSICS_HPP_END
