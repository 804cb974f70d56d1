// Continuous collision in a world: fast bodies are stopped where they would pass into something.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/world/extents.hpp"
#include "physics/world/queries.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds whole turns to a turn of at most half of one, as a rate says (rad a step).
template <class S>
S with_whole_turns(S turn, S rate) {
    constexpr double whole = 6.283185307179586;
    return turn + static_cast<S>(physics::floor((to_double(rate) - to_double(turn)) / whole + 0.5) * whole);
}
template <class S>
vec<S, 3> with_whole_turns(const vec<S, 3>& turn, const vec<S, 3>& rate) {
    const auto [axis, fast] = split(rate);
    if (!(fast > pi<S>)) return turn;
    const auto [own, angle] = split(turn);
    // A small turn's axis is mostly rounding.
    const vec<S, 3> about = angle > S(0.0625) ? own : axis;
    const S first = dot(turn, about);
    return about * with_whole_turns(first, dot(rate, about));
}

/// The sweeps of one step. It reads poses at the step's start and the solver's; what stops bodies is applied when all
/// is known, so that no order of bodies matters.
template <class Plan>
class body_sweeps {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using motion = sweep<S, D>;
    using policy = typename Plan::continuous;
    using mover = swept_mover;

public:
    body_sweeps(state<Plan>& s, moved_bodies<S, D, Plan::turns> moved, S h) : s_(s), moved_(moved), h_(h) {}

    PHYSICS_HPP_NOINLINE void run() {
        auto& report = s_.continuous.report;
        report = {};
        if (find_movers()) sweep_movers(report);
    }

private:
    buffer<mover>& movers() { return s_.continuous.movers; }

    PHYSICS_HPP_COLD void sweep_movers(continuous_report<S>& report) {
        report.swept = movers().size();
        if (any_flagged_) find_partners();
        for (mover& m : movers()) find_stop(m);
        for (mover& m : movers()) stop_other(m);
        for (mover& m : movers()) stop(m);
    }
    bool find_movers() {
        auto& pushers = s_.continuous.pushers;
        pushers.clear();
        const S thinnest = list_movers();
        if (fastest_ > detail::to_double(thinnest)) {
            for (auto& p : pushers) p.box = box_of(motion_of(p.body), s_.continuous.extents[p.body].outer);
            list_movers();
        }
        return !movers().empty();
    }
    /// Gives the thickness of the thinnest dynamic body, so that nobody looks for what slow kinematic ones pass.
    S list_movers() {
        movers().clear();
        const bool anew = !s_.continuous.pushers.empty();
        S thinnest = scalar_traits<S>::max();
        for (std::uint32_t k = 0; k < s_.movers.size(); ++k) {
            const std::uint32_t i = s_.movers[k];
            const auto& b = s_.bodies[i];
            const stride<S, D> own = stride_of(k, b);
            if (!b.is_dynamic()) {
                double far = detail::to_double(length_of(own.turn)) * s_.continuous.extents[i].outer;
                for (int axis = 0; axis < D; ++axis) far += abs(detail::to_double(own.way[axis]));
                if (anew || !(far > 0)) continue;
                s_.continuous.pushers.push({i, {}});
                fastest_ = max(fastest_, far);
                continue;
            }
            thinnest = min(thinnest, own.thickness);
            const auto against = policy::aim(anew ? as_pushed(k, b, own) : own);
            if (against == swept_against::nothing) continue;
            movers().push({s_.movers[k], k, against});
            any_flagged_ = any_flagged_ || against == swept_against::everything;
        }
        return thinnest;
    }
    /// The stride of a body as seen from the first kinematic one that may pass its middle; it counts as flagged then.
    PHYSICS_HPP_COLD stride<S, D> as_pushed(std::uint32_t k, const typename Plan::body& b, const stride<S, D>& own) {
        const point<D> start = to_point(b.center), end = to_point(moved_[k].center);
        const aabb<double, D> box =
            grown(aabb<double, D>{min(start, end), max(start, end)}, s_.continuous.extents[s_.movers[k]].outer);
        for (const auto& p : s_.continuous.pushers) {
            if (!overlap(p.box, box)) continue;
            const auto& from = s_.bodies[p.body];
            stride<S, D> seen = own;
            seen.way -= velocity_at(moved_.velocity(s_.mover_of[p.body]), b.center - from.center) * h_;
            seen.flagged = true;
            if (seen.bound() > own.thickness) return seen;
        }
        return own;
    }
    stride<S, D> stride_of(std::uint32_t k, const typename Plan::body& b) const {
        const std::uint32_t i = s_.movers[k];
        const auto& extent = s_.continuous.extents[i];
        const angular<S, D> w = value_of(moved_.velocity(k).angular), before = value_of(b.velocity.angular);
        const bool slower = length_of(w) < length_of(before);
        return {moved_[k].center - b.center, (slower ? before : w) * h_, extent.reach, extent.thickness,
                s_.continuous.depths[i],     b.continuous};
    }
    static S length_of(S w) { return abs(w); }
    static S length_of(const vec<S, 3>& w) { return abs(w.x) + abs(w.y) + abs(w.z); }

    /// The shape's frame is the body's.
    PHYSICS_HPP_COLD motion motion_of(std::uint32_t i) const {
        const auto& b = s_.bodies[i];
        const std::uint32_t k = s_.mover_of[i];
        const transform<S, D> start{b.center, b.rotation};
        if (!(k < s_.movers.size())) return {start.position, start.position, start.rotation, {}, {}};
        motion m = sweep_between<S, D>(start, {moved_[k].center, rotation_after(moved_[k], b)});
        if constexpr (Plan::turns) m.turn = with_whole_turns(m.turn, moved_.velocity(k).angular * h_);
        return m;
    }
    /// All places of a body on its way.
    aabb<double, D> box_of(const motion& m, double reach) const {
        const point<D> start = to_point(m.start), end = to_point(m.end);
        return grown(aabb<double, D>{min(start, end), max(start, end)}, reach);
    }

    /// What moves, and may be far from where the broadphase knows it.
    void find_partners() {
        s_.continuous.partners.clear();
        const auto add = [&](std::uint32_t i) {
            s_.continuous.partners.push({i, box_of(motion_of(i), s_.continuous.extents[i].outer)});
        };
        std::uint32_t next = 0;
        for (std::uint32_t k = 0; k < s_.movers.size(); ++k) {
            const std::uint32_t i = s_.movers[k];
            const bool goes_far = next < movers().size() && movers()[next].number == k;
            if (goes_far) ++next;
            if (goes_far || !s_.bodies[i].is_dynamic()) add(i);
        }
    }

    /// Shapes that a body may meet, in ascending order.
    PHYSICS_HPP_COLD bool find_candidates(std::uint32_t body, const motion& m, bool everything) {
        auto& found = s_.continuous.candidates;
        found.clear();
        const double rest = 2 * detail::to_double(s_.settings.contact_margin);
        const aabb<double, D> way = box_of(m, s_.continuous.extents[body].outer + rest);
        aabb<S, D> box;
        const double most = static_cast<double>(scalar_traits<S>::max());
        const double blur = 2 * static_cast<double>(scalar_traits<S>::epsilon());
        for (int i = 0; i < D; ++i) {
            if (!(way.lower[i] > -most && way.upper[i] < most)) return false;
            box.lower[i] = static_cast<S>(way.lower[i] - blur * (abs(way.lower[i]) + 1));
            box.upper[i] = static_cast<S>(way.upper[i] + blur * (abs(way.upper[i]) + 1));
        }
        if (!is_box(box)) return false;
        const proxy_filter own{.owner = body, .movable = true};
        const auto add = [&](std::uint32_t shape) {
            const auto& record = s_.shapes[shape];
            if (!everything && s_.bodies[record.body].type != body_type::static_body) return;
            if (may_meet(own, filter_of(s_, record))) found.push(shape);
        };
        each_near(s_, box, query_filter{.category = 0xffffffffu, .movable = everything}, add);
        if (everything)
            for (const auto& partner : s_.continuous.partners)
                if (overlap(partner.box, way))
                    each_shape(s_, partner.body, [&](std::uint32_t k, const auto&) { add(k); });
        sort_once(found, s_.continuous.spare);
        return true;
    }
    static void sort_once(buffer<std::uint64_t>& numbers, buffer<std::uint64_t>& spare) {
        spare.resize(numbers.size());
        if (radix_sort(numbers.begin(), spare.begin(), numbers.size(), 0, 32) != numbers.begin()) numbers.swap(spare);
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < numbers.size(); ++i)
            if (kept == 0 || numbers[kept - 1] != numbers[i]) numbers[kept++] = numbers[i];
        numbers.resize(kept);
    }

    void find_stop(mover& m) {
        sweep_body(m, motion_of(m.body), m.against == swept_against::everything);
    }
    /// Finds the first shape that stops a body, of several at once that of the lowest number.
    PHYSICS_HPP_COLD void sweep_body(mover& m, const motion& way, bool everything) {
        m.stops = false;
        m.time = 1;
        if (!find_candidates(m.body, way, everything)) {
            m.converged = false;
            return;
        }
        if (s_.continuous.candidates.empty()) return;
        each_shape(s_, m.body, [&](std::uint32_t, const shape_record<Plan>& record) {
            const mat<double, D> axes = to_matrix(record.local.rotation);
            const point<D> at = to_point(record.local.position) - to_point(s_.bodies[m.body].mass.center);
            record.shape.visit([&](const auto& shape) {
                each_swept_piece(shape, everywhere(record.local.rotation),
                                 [&](const core<D>& c, const mat<double, D>& turned, const point<D>& where) {
                                     sweep_piece(m, way, c, axes * turned, axes * where + at);
                                 });
            });
        });
    }
    PHYSICS_HPP_COLD void sweep_piece(mover& m, const motion& way, const core<D>& piece, const mat<double, D>& axes,
                                      const point<D>& at) {
        const double thickness = inner_radius<Plan::few_corners>(piece);
        for (const std::uint64_t k : s_.continuous.candidates) {
            const auto& record = s_.shapes[static_cast<std::uint32_t>(k)];
            const motion other = motion_of(record.body);
            const obstacle o{other,
                             moving_core<D>(piece, way, axes, at, to_point(other.start)),
                             (to_point(way.end) - to_point(way.start)) - (to_point(other.end) - to_point(other.start)),
                             to_matrix(record.local.rotation),
                             to_point(record.local.position) - to_point(s_.bodies[record.body].mass.center),
                             thickness,
                             record.body};
            record.shape.visit([&](const auto& shape) { meet(shape, o, m); });
        }
    }
    /// A shape on the way of a piece: where it is on its body, and how the piece moves as seen from the body's centre.
    struct obstacle {
        const motion& other;
        moving_core<D> mine;
        point<D> way;
        mat<double, D> axes;
        point<D> at;
        double thickness;
        std::uint32_t body;
    };

    template <class Shape>
    void meet(const Shape& shape, const obstacle& o, mover& m) {
        if constexpr (is_plane<Shape>) {
            const bounding_half<D> half(shape);
            core<D> surface;
            surface.corner[0] = half.normal * half.offset;
            pass(surface, mat<double, D>::identity(), {}, &half.normal, o, m);
        } else if constexpr (has_parts<Shape, D>) {
            point<D> center;
            const aabb<double, D> box = box_of_way(o, center);
            each_piece(
                shape, box, [&](const auto& part) { return faces(part, center); },
                [&](const core<D>& piece, const mat<double, D>& turned, const point<D>& where, std::uint32_t) {
                    pass(piece, turned, where, nullptr, o, m);
                });
        } else if constexpr (has_core<Shape>) {
            pass(core_of(shape), mat<double, D>::identity(), {}, nullptr, o, m);
        }
    }
    /// What a piece fills on its way, and its middle at the step's start, in the frame of the obstacle.
    PHYSICS_HPP_COLD aabb<double, D> box_of_way(const obstacle& o, point<D>& center) const {
        const mat<double, D> body = to_matrix(o.other.rotation), seen = transposed(body * o.axes);
        const point<D> origin = body * o.at, start = o.mine.start, end = o.mine.start + o.way;
        const double reach = (o.mine.reach + o.mine.shape.radius) + 2 * detail::to_double(s_.settings.contact_margin);
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
    PHYSICS_HPP_COLD void pass(const core<D>& piece, const mat<double, D>& turned, const point<D>& where,
                               const point<D>* face, const obstacle& o, mover& m) {
        const moving_core<D> a(piece, o.other, o.axes * turned, o.axes * where + o.at, to_point(o.other.start));
        const moving_core<D>& b = o.mine;
        const cast_precision precision = cast_precision::of<S>(piece, b.shape);
        const moving_pair<D> pair{a, b, o.way, face, piece.radius + b.shape.radius, precision.error,
                                  precision.relative};
        const double margin = detail::to_double(s_.settings.contact_margin);
        // What rounding of poses may do to a gap.
        const double epsilon = static_cast<double>(scalar_traits<S>::epsilon());
        const double size = largest(to_point(o.other.start)) + largest(b.start) + largest(o.way);
        const double blur = 4 * epsilon * (is_fixed<S> ? 1 + b.reach : size + b.reach);
        const bool thin = s_.bodies[o.body].is_dynamic();
        const passage_rule rule{margin + blur, 0.25 * margin, 0.25 * margin,
                                thin ? min(o.thickness, inner_radius<Plan::few_corners>(piece)) : o.thickness, blur};
        const passage found = find_passage<Plan::few_corners>(pair, rule, m.stops ? m.time : 1.0);
        m.converged = m.converged && found.converged;
        if (!found.stops || (m.stops && !(found.time < m.time))) return;
        m.stops = true;
        m.time = found.time;
        m.other = o.body;
    }

    /// A dynamic body that goes far itself must not go on through the body that was stopped on its way.
    void stop_other(const mover& m) {
        if (!m.stops || !s_.bodies[m.other].is_dynamic()) return;
        mover* other = find_mover(s_.mover_of[m.other]);
        if (other == nullptr || (other->cut && !(m.time < other->cut_time))) return;
        other->cut = true;
        other->cut_time = m.time;
    }
    mover* find_mover(std::uint32_t number) {
        std::uint32_t low = 0, high = movers().size();
        while (low < high) {
            const std::uint32_t middle = (low + high) / 2;
            if (number > movers()[middle].number) low = middle + 1;
            else high = middle;
        }
        return low < movers().size() && movers()[low].number == number ? &movers()[low] : nullptr;
    }

    PHYSICS_HPP_COLD void stop(mover& m) {
        const bool is_cut = m.cut && !(m.stops && m.time < m.cut_time);
        const double time = is_cut ? m.cut_time : m.time;
        auto& report = s_.continuous.report;
        if ((is_cut || m.stops) && time < 1) {
            const motion way = motion_of(m.body);
            transform<S, D> at = way.at(rounded_down<S>(time));
            if (!is_cut && s_.bodies[m.other].type == body_type::kinematic_body) at = carried(m, at);
            moved_[m.number].center = at.position;
            if constexpr (Plan::turns) moved_[m.number].rotation = at.rotation;
            const S lost = static_cast<S>(1 - time) * h_;
            // What gravity has given for the lost time would make a bounce higher than the fall.
            vec<S, D>& v = moved_.velocity(m.number).linear;
            const vec<S, D> ahead = normalized(v);
            v -= ahead * (dot(ahead, s_.settings.gravity) * s_.bodies[m.body].gravity_scale * lost);
            ++report.stopped;
            report.lost = max(report.lost, lost);
        }
        if (!m.converged) ++report.unconverged;
    }
    /// What a kinematic body has caught it takes along for the rest of the step, as far as static ones let it: nothing
    /// holds the kinematic one up.
    PHYSICS_HPP_COLD transform<S, D> carried(mover& m, const transform<S, D>& at) {
        const motion other = motion_of(m.other);
        const transform<S, D> there = other.at(rounded_down<S>(m.time));
        const auto& moved = moved_[s_.mover_of[m.other]];
        const transform<S, D> then{moved.center, rotation_after(moved, s_.bodies[m.other])};
        const transform<S, D> end = then * relative(there, at);
        const motion way = sweep_between<S, D>(at, {end.position, normalized(end.rotation)});
        mover again{m.body, m.number};
        sweep_body(again, way, false);
        m.converged = m.converged && again.converged;
        return way.at(rounded_down<S>(again.time));
    }

    state<Plan>& s_;
    moved_bodies<S, D, Plan::turns> moved_;
    S h_;
    bool any_flagged_ = false;
    /// How far a point of a kinematic body goes, at most.
    double fastest_ = 0;
};

/// Forgets which bodies the contacts of the last step have found deep in static ones.
template <class Plan>
void clear_depths(state<Plan>& s) {
    if constexpr (Plan::sweeps) {
        for (const std::uint32_t i : s.continuous.deep) s.continuous.depths[i] = {};
        s.continuous.deep.clear();
        s.continuous.depths.resize(s.bodies.slots());
    }
}
/// Whether a contact is deeper than usual, and the note of it.
template <class Plan, class Contact>
bool is_deep(const state<Plan>& s, const Contact& c) {
    if constexpr (Plan::sweeps)
        for (int k = 0; k < c.count; ++k)
            if (-c.points[k].separation > s.settings.contact_margin * typename Plan::scalar(0.5)) return true;
    return false;
}
template <class Plan, class Contact>
void note_depth(state<Plan>& s, const Contact& c) {
    if constexpr (Plan::sweeps) {
        if (!is_deep(s, c)) return;
        typename Plan::scalar depth{};
        for (int k = 0; k < c.count; ++k) depth = max(depth, -c.points[k].separation);
        const std::uint32_t a = body_a(s, c), b = body_b(s, c);
        const auto note = [&](std::uint32_t i) {
            s.continuous.depths[i] = max(s.continuous.depths[i], depth);
            s.continuous.deep.push(i);
        };
        if (s.bodies[a].type == body_type::static_body) note(b);
        if (s.bodies[b].type == body_type::static_body) note(a);
    }
}

/// Stops bodies that would have passed into something; see the recipe's policy.
template <class Plan>
void sweep_fast_bodies(state<Plan>& s, moved_bodies<typename Plan::scalar, Plan::dimension, Plan::turns> moved,
                       typename Plan::scalar h) {
    if constexpr (Plan::sweeps) body_sweeps<Plan>(s, moved, h).run();
}

}  // namespace detail

PHYSICS_HPP_END
