// Where bodies go in a step, as the sweeps see it, and what the contacts of the step tell them.
#pragma once

#include "physics/collide/first_penetration.hpp"
#include "physics/step/state.hpp"

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
    const auto [axis, fast] = direction_and_length_of(rate);
    if (!(fast > pi<S>)) return turn;
    const auto [own, angle] = direction_and_length_of(turn);
    // A small turn's axis is mostly rounding.
    const vec<S, 3> about = angle > S(0.0625) ? own : axis;
    const S first = dot(turn, about);
    return about * with_whole_turns(first, dot(rate, about));
}

/// How a body moves in a step of h seconds, of its centre and its rotation before and after, and its velocity.
template <bool Rotates, class S, int D, class Twist>
sweep<S, D> sweep_of_step(const transform<S, D>& start, const transform<S, D>& end,
                          [[maybe_unused]] const Twist& velocity, [[maybe_unused]] S h) {
    sweep<S, D> m{start.position, end.position, start.rotation, {}, {}};
    // What does not turn gets no turn from rounding either.
    if (!(end.rotation == start.rotation)) m = sweep_between<S, D>(start, end);
    if constexpr (Rotates) m.turn = with_whole_turns(m.turn, velocity.angular * h);
    return m;
}

/// What sweeps read of a world.
template <class Plan>
struct sweep_input {
    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const typename Plan::broadphase& broadphase;
    const awake_list& awake;
    const sleep_of<Plan>& sleep;
    const joints_of<Plan>& joints;
    const buffer<body_extent<typename Plan::scalar>>& extents;
    const typename Plan::settings& settings;
    /// What the contact rule has let pass, and what it has not.
    const passing_pairs<Plan>& passing;
    const buffer<typename Plan::contact>& contacts;
    std::uint16_t tag;
};

/// The ways of bodies through a step: from the poses at its start to the solver's.
template <class Plan>
class body_paths {
public:
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    body_paths(const sweep_input<Plan>& in, moved_bodies<S, D, Plan::rotates> moved, S h, sweep_data<Plan>& data)
        : in_(in), data_(data), moved_(moved), h_(h) {}

protected:
    using body_sweep = sweep<S, D>;
    using swept_body_type = swept_body<D>;

    [[nodiscard]] double contact_margin() const { return detail::to_double(in_.settings.contact_margin); }
    static S length_of(S w) { return abs(w); }
    static S length_of(const vec<S, 2>& w) { return abs(w.x) + abs(w.y); }
    static S length_of(const vec<S, 3>& w) { return abs(w.x) + abs(w.y) + abs(w.z); }
    /// The farther of what it did and what it was about to.
    body_motion<S, D> motion_of_body(std::uint32_t k, const typename Plan::body& b) const {
        const std::uint32_t i = in_.awake[k];
        const auto& extent = in_.extents[i];
        const angular<S, D> w = value_of(moved_.velocity(k).angular), before = value_of(b.velocity.angular);
        const vec<S, D> path = moved_[k].center - b.center, aimed = b.velocity.linear * h_;
        const bool slower = length_of(w) < length_of(before), shorter = length_of(path) < length_of(aimed);
        // A body that was stopped in this step may now overlap what stopped it.
        return {shorter ? aimed : path, (slower ? before : w) * h_, extent.reach, extent.thickness, data_.depths[i],
                b.continuous,           in_.settings.contact_margin};
    }

    /// Whether a shape of a kinematic body may pass the middle of another in this step, by its way as seen from there.
    PHYSICS_HPP_COLD bool crosses(std::uint32_t k, const typename Plan::body& b, std::uint32_t pusher) {
        const auto& from = in_.bodies[pusher];
        const auto& moved = moved_[in_.awake.index_of[pusher]];
        const rotation<S, D> turned = rotation_after(moved, from);
        const vec<S, D> start = inverse_transform(from.pose(), b.center),
                        end = inverse_transform(transform<S, D>{moved.center - turned * from.mass.center, turned},
                                                moved_[k].center);
        // What turns leads the way around, not along the chord.
        const double angle =
            detail::to_double(length_of(value_of(moved_.velocity(in_.awake.index_of[pusher]).angular) * h_));
        const double far = detail::to_double(length_of(start)) + detail::to_double(length_of(end));
        const double reach = contact_margin() + far * angle * angle / 8;
        if (!(angle < 1) || !(reach < detail::to_double(scalar_traits<S>::max()) / 4)) return true;
        const aabb<S, D> path = grown(aabb<S, D>{min(start, end), max(start, end)}, static_cast<S>(reach));
        bool crossed = false;
        each_solid_shape<Plan>(in_.bodies, in_.shapes, pusher, [&](std::uint32_t, const shape_record<Plan>& record) {
            crossed = crossed || overlap(bounds(record.shape, record.local), path);
        });
        return crossed;
    }
    /// The shape's frame is the body's.
    PHYSICS_HPP_COLD body_sweep motion_of(std::uint32_t i) const {
        const auto& b = in_.bodies[i];
        const std::uint32_t k = in_.awake.index_of[i];
        const transform<S, D> start{b.center, b.rotation};
        if (!(k < in_.awake.size())) return {start.position, start.position, start.rotation, {}, {}};
        const rotation<S, D>& turn = rotation_after(moved_[k], b);
        return sweep_of_step<Plan::rotates>(start, {moved_[k].center, turn}, moved_.velocity(k), h_);
    }
    /// All places of a body on its way.
    aabb<double, D> box_of(const body_sweep& m, double reach) const {
        const point<D> start = to_point(m.start), end = to_point(m.end);
        return grown(aabb<double, D>{min(start, end), max(start, end)}, reach);
    }

    /// Whether a body stays within boxes near which the broadphase knew nothing that stands; and what it fills on its
    /// way, or, where it does not go far, at the end.
    bool keeps_clear(const swept_body_type& m, aabb<double, D>& box) const {
        const std::uint32_t i = m.body;
        const auto& b = in_.bodies[i];
        const auto& extent = in_.extents[i];
        const point<D> start = to_point(b.center), end = to_point(moved_[m.number].center);
        const rotation<S, D>& turn = rotation_after(moved_[m.number], b);
        double spare = 0.5 * contact_margin();
        if (Plan::rotates && m.goes_far) {
            // Points on arcs of the radius r leave their chords by up to r sin^2(angle / 2), and the squares of what
            // unit vectors move by sum up to 8 sin^2(angle / 2).
            double square = 0;
            for (int k = 0; k < D; ++k) {
                vec<S, D> unit;
                unit[k] = S(1);
                const point<D> by = to_point(turn * unit - b.rotation * unit);
                square += dot(by, by);
            }
            spare += extent.outer * square * (1.0 / 8);
            if (m.against == sweep_target::everything ||
                !(length_of(value_of(moved_.velocity(m.number).angular)) * h_ < S(2))) {
                box = grown(aabb<double, D>{min(start, end), max(start, end)}, extent.outer + spare);
                return false;
            }
        }
        const transform<S, D> pose{moved_[m.number].center - turn * b.mass.center, turn};
        bool within = !data_.near_static[i] && !in_.sleep.is_asleep(i);
        bool first = true;
        each_solid_shape<Plan>(in_.bodies, in_.shapes, i, [&](std::uint32_t k, const shape_record<Plan>& record) {
            aabb<double, D> own = box_at(record, pose * record.local);
            if (m.goes_far) own = merged(own, box_at(record, record.pose));
            own = grown(own, spare);
            box = first ? own : merged(box, own);
            first = false;
            if constexpr (requires { in_.broadphase.box(k); })
                within = within && contains(wide(in_.broadphase.box(k)), own);
            else within = false;
        });
        return within;
    }

    const sweep_input<Plan>& in_;
    sweep_data<Plan>& data_;
    moved_bodies<S, D, Plan::rotates> moved_;
    S h_;

private:
    static aabb<double, D> wide(const aabb<S, D>& box) { return {to_point(box.lower), to_point(box.upper)}; }
    static aabb<double, D> box_at(const shape_record<Plan>& record, const transform<S, D>& pose) {
        return wide(bounds(record.shape, pose));
    }
};

}  // namespace detail

PHYSICS_HPP_END
