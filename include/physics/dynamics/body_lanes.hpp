// Bodies in lanes, as contact solvers read and write them.
#pragma once

#include "physics/base/pack_rows.hpp"
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/lane_vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class P, int D, bool Rotates = true>
struct body_lanes;
template <class P>
struct body_lanes<P, 2> {
    using S = typename P::scalar;
    static constexpr int stride = sizeof(solver_body<S, 2>) / sizeof(S);

    lane_twist<P, 2> velocity, displacement;

    PHYSICS_HPP_ALWAYS_INLINE void load(const solver_body<S, 2>* bodies, const std::uint32_t* index) {
        const auto* first = reinterpret_cast<const S*>(bodies);
        const quad<P> v = load4<P>(indexed_rows<const S, stride>{first, index});
        velocity = {{v.x, v.y}, v.z};
        const quad<P> w = load4<P>(indexed_rows<const S, stride>{first + 4, index});
        displacement = {{v.w, w.x}, w.y};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(solver_body<S, 2>* bodies, const std::uint32_t* index) const {
        store4(indexed_rows<S, stride>{reinterpret_cast<S*>(bodies), index},
               quad<P>{velocity.linear.x, velocity.linear.y, velocity.angular, displacement.linear.x});
    }
};
/// Writes how bodies in 2D answer to impulses into lanes.
template <class S, int W>
PHYSICS_HPP_ALWAYS_INLINE void load_inverse_masses(const solver_body<S, 2>* bodies, const std::uint32_t (&index)[W],
                                                   inverse_of<S> (&mass)[W], inverse_of<S> (&inertia)[W]) {
    if constexpr (std::is_floating_point_v<S>) {
        using P = kernel_pack<S, W>;
        constexpr int stride = sizeof(solver_body<S, 2>) / sizeof(S);
        const quad<P> row = load4<P>(indexed_rows<const S, stride>{reinterpret_cast<const S*>(bodies) + 4, index});
        row.z.store(mass);
        row.w.store(inertia);
    } else {
        for (int lane = 0; lane < W; ++lane) {
            mass[lane] = bodies[index[lane]].inverse_mass;
            inertia[lane] = bodies[index[lane]].inverse_inertia;
        }
    }
}
/// The same in 3D.
template <class S, int W>
PHYSICS_HPP_ALWAYS_INLINE void load_inverse_masses(const solver_body<S, 3>* bodies, const std::uint32_t (&index)[W],
                                                   inverse_of<S> (&mass)[W], inverse_of<S> (&inertia)[6][W]) {
    if constexpr (std::is_floating_point_v<S>) {
        using P = kernel_pack<S, W>;
        constexpr int stride = sizeof(solver_body<S, 3>) / sizeof(S);
        const auto* first = reinterpret_cast<const S*>(bodies);
        const quad<P> a = load4<P>(indexed_rows<const S, stride>{first + 12, index});
        const quad<P> b = load4<P>(indexed_rows<const S, stride>{first + 16, index});
        a.x.store(mass);
        lane_symmetric<P, 3>{a.y, a.z, a.w, b.x, b.y, b.z}.store(inertia);
    } else {
        for (int lane = 0; lane < W; ++lane) {
            const solver_body<S, 3>& of = bodies[index[lane]];
            const auto& m = of.inverse_inertia;
            const inverse_of<S> six[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
            mass[lane] = of.inverse_mass;
            for (int i = 0; i < 6; ++i) inertia[i][lane] = six[i];
        }
    }
}

template <class P>
struct body_lanes<P, 3> {
    using S = typename P::scalar;
    static constexpr int stride = sizeof(solver_body<S, 3>) / sizeof(S);

    lane_twist<P, 3> velocity, displacement;

    PHYSICS_HPP_ALWAYS_INLINE void load(const solver_body<S, 3>* bodies, const std::uint32_t* index) {
        const auto* first = reinterpret_cast<const S*>(bodies);
        const quad<P> a = load4<P>(indexed_rows<const S, stride>{first, index});
        const quad<P> b = load4<P>(indexed_rows<const S, stride>{first + 4, index});
        const quad<P> c = load4<P>(indexed_rows<const S, stride>{first + 8, index});
        velocity = {{a.x, a.y, a.z}, {a.w, b.x, b.y}};
        displacement = {{b.z, b.w, c.x}, {c.y, c.z, c.w}};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(solver_body<S, 3>* bodies, const std::uint32_t* index) const {
        auto* first = reinterpret_cast<S*>(bodies);
        const auto& [v, w] = velocity;
        store4(indexed_rows<S, stride>{first, index}, quad<P>{v.x, v.y, v.z, w.x});
        store4(indexed_rows<S, stride>{first + 4, index},
               quad<P>{w.y, w.z, displacement.linear.x, displacement.linear.y});
    }
    /// With the displacements.
    PHYSICS_HPP_ALWAYS_INLINE void store_all(solver_body<S, 3>* bodies, const std::uint32_t* index) const {
        store(bodies, index);
        auto* first = reinterpret_cast<S*>(bodies);
        store4(indexed_rows<S, stride>{first + 8, index},
               quad<P>{displacement.linear.z, displacement.angular.x, displacement.angular.y, displacement.angular.z});
    }
};

/// What does not turn: velocities and displacements.
template <class P, int D>
struct body_lanes<P, D, false> {
    using S = typename P::scalar;
    static constexpr int stride = sizeof(solver_body<S, D, false>) / sizeof(S);
    static_assert(sizeof(linear_twist<S, D>) == D * sizeof(S));

    lane_vec<P, D> velocity, displacement;

    PHYSICS_HPP_ALWAYS_INLINE void load(const solver_body<S, D, false>* bodies, const std::uint32_t* index) {
        const auto* first = reinterpret_cast<const S*>(bodies);
        const quad<P> p = load4<P>(indexed_rows<const S, stride>{first, index});
        if constexpr (D == 2) {
            velocity = {p.x, p.y};
            displacement = {p.z, p.w};
        } else {
            const quad<P> q = load4<P>(indexed_rows<const S, stride>{first + 4, index});
            velocity = {p.x, p.y, p.z};
            displacement = {p.w, q.x, q.y};
        }
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(solver_body<S, D, false>* bodies, const std::uint32_t* index) const {
        const indexed_rows<S, stride> to{reinterpret_cast<S*>(bodies), index};
        const auto& [v, moved] = *this;
        if constexpr (D == 2) store4(to, quad<P>{v.x, v.y, moved.x, moved.y});
        else store4(to, quad<P>{v.x, v.y, v.z, moved.x});
    }
};

/// The bodies of W contacts.
template <class P, int D, bool Rotates = true>
struct body_pair_lanes {
    body_lanes<P, D, Rotates> a, b;

    template <class Block, class Body>
    PHYSICS_HPP_ALWAYS_INLINE void load(const Block& of, const Body* bodies) {
        a.load(bodies, of.a);
        b.load(bodies, of.b);
    }
    /// Writes back those that are pushed.
    template <class Block, class Body>
    PHYSICS_HPP_ALWAYS_INLINE void store(const Block& of, Body* bodies) const {
        if (of.moves_a) a.store(bodies, of.a);
        if (of.moves_b) b.store(bodies, of.b);
    }
};

}  // namespace detail

PHYSICS_HPP_END
