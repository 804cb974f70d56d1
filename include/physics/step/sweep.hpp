// Continuous collision in a world: fast bodies are stopped where they would pass into something.
#pragma once

#include "physics/collide/time_of_impact.hpp"
#include "physics/step/sweep_search.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The sweeps of one step. It reads poses at the step's start and the solver's; what stops bodies is applied when all
/// is known, so that no order of bodies matters.
template <class Plan>
class body_sweeps : sweep_search<Plan> {
    using search = sweep_search<Plan>;
    using search::box_of, search::crosses, search::D, search::h_, search::keeps_clear, search::contact_margin,
        search::length_of, search::motion_of, search::moved_, search::in_, search::data_, search::motion_of_body,
        search::find_candidates, search::ends_in_something, search::sweep_body;
    using typename search::body_sweep;
    using typename search::S;
    using typename search::swept_body_type;
    using policy = typename Plan::continuous;

public:
    using search::sweep_search;

    PHYSICS_HPP_NOINLINE continuous_report<S> run() {
        if (find_swept_bodies()) sweep_all();
        return report_;
    }

private:
    buffer<swept_body_type>& swept_bodies() { return data_.swept_bodies; }

    PHYSICS_HPP_COLD void sweep_all() {
        report_.swept = swept_bodies().size();
        if (any_flagged_) list_moving_bodies();
        for (swept_body_type& m : swept_bodies()) find_stop(m);
        for (swept_body_type& m : swept_bodies()) stop_other(m);
        for (swept_body_type& m : swept_bodies()) stop(m);
    }
    bool find_swept_bodies() {
        auto& pushers = data_.pushers;
        pushers.clear();
        const S thinnest = list_swept_bodies();
        if (fastest_ > detail::to_double(thinnest)) {
            for (auto& p : pushers) p.box = box_of(motion_of(p.body), in_.extents[p.body].outer);
            list_swept_bodies();
        }
        return !swept_bodies().empty();
    }
    /// Gives the thickness of the thinnest dynamic body, so that what slow kinematic ones pass is not looked for.
    S list_swept_bodies() {
        swept_bodies().clear();
        const bool anew = !data_.pushers.empty();
        S thinnest = scalar_traits<S>::max();
        for (std::uint32_t k = 0; k < in_.awake.size(); ++k) {
            const std::uint32_t i = in_.awake[k];
            const auto& b = in_.bodies[i];
            const body_motion<S, D> own = motion_of_body(k, b);
            if (!b.is_dynamic()) {
                double far = detail::to_double(length_of(own.turn)) * in_.extents[i].outer;
                for (int axis = 0; axis < D; ++axis) far += abs(detail::to_double(own.translation[axis]));
                // By velocities drums and paddles go far all the time: what they pass is not looked for.
                if (anew || !b.has_target || !(far > 0)) continue;
                data_.pushers.push_back({i, {}});
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
            grown(aabb<double, D>{min(start, end), max(start, end)}, in_.extents[in_.awake[k]].outer);
        for (const auto& p : data_.pushers) {
            if (!overlap(p.box, box)) continue;
            const auto& from = in_.bodies[p.body];
            const vec<S, D> velocity_of_pusher =
                velocity_at(moved_.velocity(in_.awake.index_of[p.body]), b.center - from.center) * h_;
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
        data_.moving_bodies.clear();
        const auto add = [&](std::uint32_t i) {
            data_.moving_bodies.push_back({i, box_of(motion_of(i), in_.extents[i].outer)});
        };
        std::uint32_t next = 0;
        for (std::uint32_t k = 0; k < in_.awake.size(); ++k) {
            const std::uint32_t i = in_.awake[k];
            const bool goes_far = next < swept_bodies().size() && swept_bodies()[next].number == k;
            if (goes_far) ++next;
            if (goes_far || !in_.bodies[i].is_dynamic()) add(i);
        }
    }

    /// What does not go far passes through nothing: it is enough to look where it ends.
    void find_stop(swept_body_type& m) {
        const bool everything = m.against == sweep_target::everything;
        aabb<double, D> box;
        if (keeps_clear(m, box) && !everything) return;
        if (!find_candidates(m.body, box, everything)) m.converged = false;
        if (data_.candidates.empty()) return;
        const body_sweep path = motion_of(m.body);
        m.goes_far = m.goes_far || ends_in_something(m, path);
        if (m.goes_far) sweep_body(m, path);
    }

    /// A dynamic body that goes far itself must not go on through the body that was stopped on its way.
    void stop_other(const swept_body_type& m) {
        if (!m.stops || !in_.bodies[m.other].is_dynamic()) return;
        swept_body_type* other = find_swept_body(in_.awake.index_of[m.other]);
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
        const body_type type = in_.bodies[m.other].type;
        const bool slides = !is_cut && m.stops && type == body_type::static_body && m.against == sweep_target::fixed;
        if ((is_cut || m.stops) && time < 1 && !(slides && is_pushed_out(m))) {
            const body_sweep path = motion_of(m.body);
            transform<S, D> at = path.at(rounded_down<S>(time));
            if (slides) at.position = slid_along(m, at, path.end);
            else if (!is_cut && type == body_type::kinematic_body) at = carried(m, at);
            moved_[m.number].center = at.position;
            if constexpr (Plan::rotates)
                if (!slides || !(path.turn == angular<S, D>{})) turn_back(m.number, at.rotation);
            const S lost = static_cast<S>(1 - time) * h_;
            // What gravity has given for the lost time would make a bounce higher than the fall.
            if (slides && m.touching) {
                take_from_speed(m, at.position - path.end);
            } else {
                vec<S, D>& v = moved_.velocity(m.number).linear;
                const vec<S, D> ahead = slides ? from_point<S>(m.normal) : normalized(v);
                v -= ahead * (dot(ahead, in_.settings.gravity) * in_.bodies[m.body].gravity_scale * lost);
            }
            ++report_.stopped;
            report_.lost = max(report_.lost, lost);
        }
        if (!m.converged) ++report_.unconverged;
    }
    /// What turns about a point of contact leaves the tangent along which the solver moves that point: rims of coins
    /// would be stopped in every step. Where it is no deeper than that explains, it is pushed out at the end of the
    /// step, and loses no time.
    PHYSICS_HPP_COLD bool is_pushed_out(const swept_body_type& m) {
        if constexpr (!Plan::rotates) return false;
        body_sweep path = motion_of(m.body);
        const double turn = detail::to_double(length_of(path.turn)),
                     maximum = 0.5 * turn * turn * in_.extents[m.body].outer;
        swept_body_type deepest = m;
        // Twice, for what is in a corner.
        for (int i = 0; i < 2; ++i) {
            if (!deepest.touching || !(deepest.push_out <= maximum)) return false;
            path.end += from_point<S>(deepest.normal * max(deepest.push_out, 0.0));
            deepest = continue_on(m, path);
            if (deepest.stops) continue;
            vec<S, D>& center = moved_[m.number].center;
            take_from_speed(m, path.end - center);
            center = path.end;
            return true;
        }
        return false;
    }
    /// Takes from the speed of a body what it has gained by being moved against gravity.
    PHYSICS_HPP_COLD void take_from_speed(const swept_body_type& m, const vec<S, D>& by) {
        const auto& b = in_.bodies[m.body];
        const double gain = -dot(to_point(by), to_point(in_.settings.gravity)) * detail::to_double(b.gravity_scale);
        if (!(gain > 0)) return;
        auto& v = moved_.velocity(m.number);
        double square = dot(to_point(v.linear), to_point(v.linear));
        if constexpr (Plan::rotates)
            square += twice_spin_energy(b.mass.inertia, moved_[m.number].rotation, v.angular) /
                      detail::to_double(b.mass.mass);
        const S kept = square > 2 * gain ? static_cast<S>(physics::sqrt(1 - 2 * gain / square)) : S(0);
        v.linear *= kept;
        if constexpr (Plan::rotates) v.angular *= kept;
    }
    /// What stops a body on another way, among static ones.
    PHYSICS_HPP_COLD swept_body_type continue_on(const swept_body_type& m, const body_sweep& path) {
        swept_body_type again(m.body, m.number);
        const double reach = in_.extents[m.body].outer + contact_margin();
        again.converged = find_candidates(m.body, box_of(path, reach), false);
        sweep_body(again, path);
        return again;
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
        const swept_body_type again = continue_on(m, path);
        m.converged = m.converged && again.converged;
        return path.at(rounded_down<S>(again.time));
    }
    /// What a kinematic body has caught it takes along for the rest of the step, as far as static ones let it: nothing
    /// holds the kinematic one up.
    PHYSICS_HPP_COLD transform<S, D> carried(swept_body_type& m, const transform<S, D>& at) {
        const body_sweep other = motion_of(m.other);
        const transform<S, D> there = other.at(rounded_down<S>(m.time));
        const auto& moved = moved_[in_.awake.index_of[m.other]];
        const transform<S, D> then{moved.center, rotation_after(moved, in_.bodies[m.other])};
        const transform<S, D> end = then * relative(there, at);
        const body_sweep path = sweep_between<S, D>(at, {end.position, normalized(end.rotation)});
        return continue_from(m, path);
    }

    continuous_report<S> report_;
    bool any_flagged_ = false;
    /// How far a point of a kinematic body goes, at most.
    double fastest_ = 0;
};

/// Poses -> poses short of what bodies would have passed into, and how often that was; see the recipe's policy.
template <class Plan, class Moved>
continuous_report<typename Plan::scalar> sweep(const sweep_input<Plan>& in, const Moved& moved, typename Plan::scalar h,
                                               sweep_data<Plan>& data) {
    return body_sweeps<Plan>(in, moved, h, data).run();
}

}  // namespace detail

PHYSICS_HPP_END
