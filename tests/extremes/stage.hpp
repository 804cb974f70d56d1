// A world in which extremes are played, told and read in double.
#pragma once

#include <physics.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "row.hpp"

namespace extremes {

using physics::body_id;
using physics::body_type;

constexpr double pi = 3.14159265358979323846, infinity = std::numeric_limits<double>::infinity();
constexpr double frame = 1.0 / 60;

using triple = std::array<double, 3>;
inline triple operator+(const triple& a, const triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline triple operator-(const triple& a, const triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline triple operator*(const triple& a, double k) { return {a[0] * k, a[1] * k, a[2] * k}; }
inline double dot(const triple& a, const triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline triple cross(const triple& a, const triple& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const triple& a) { return std::sqrt(dot(a, a)); }
/// By a unit quaternion x, y, z, w.
inline triple rotated(const std::array<double, 4>& q, const triple& v) {
    const triple u = {q[0], q[1], q[2]}, t = cross(u, v) * 2;
    return v + t * q[3] + cross(u, t);
}
/// The larger one, and NaN if one of them is.
inline double worse(double a, double b) { return a != a || a > b ? a : b; }

/// A body and what it is made of.
struct solid {
    triple at = {};
    /// Half the extents of a box; of a ball the first is its radius.
    triple half = {0.5, 0.5, 0.5};
    double density = 1, friction = 0.6, restitution = 0;
    /// About z (rad).
    double angle = 0;
    triple velocity = {}, spin = {};
    /// Whether moving bodies stop it too where it is fast.
    bool continuous = false;
    body_type type = body_type::dynamic_body;
    /// Of its surface, along x (m/s).
    double belt = 0;
    /// Of both its velocities (1/s).
    double damping = 0;
};

template <class World>
class stage {
public:
    using S = typename World::scalar;
    static constexpr int D = World::dimension;
    using vec = typename World::vec;
    using settings_type = typename World::settings_type;

    explicit stage(const settings_type& settings) : world(settings) {}
    explicit stage(const work& with, const triple& gravity = {0, -10, 0}) : world(settings_for(with, gravity)) {}

    /// The defaults, but that nothing sleeps and everything bounces that can, however slowly.
    static settings_type settings_for(const work& with, const triple& gravity = {0, -10, 0}) {
        settings_type s;
        s.gravity = to(gravity);
        s.solver.substeps = with.substeps;
        s.solver.restitution_threshold = S(0);
        s.sleeping.enabled = false;
        return s;
    }
    static vec to(const triple& from) {
        vec v;
        for (int k = 0; k < D; ++k) v[k] = S(from[static_cast<std::size_t>(k)]);
        return v;
    }

    body_id body(const solid& b) {
        typename World::body_def def;
        def.type = b.type;
        def.position = to(b.at);
        def.linear_velocity = to(b.velocity);
        def.continuous = b.continuous;
        def.linear_damping = def.angular_damping = S(b.damping);
        if constexpr (D == 2) {
            def.rotation = World::rotation_type::from_angle(S(b.angle));
            def.angular_velocity = S(b.spin[2]);
        } else {
            def.rotation = World::rotation_type::from_axis_angle({S(0), S(0), S(1)}, S(b.angle));
            def.angular_velocity = to(b.spin);
        }
        bodies.push_back(world.create_body(def));
        return bodies.back();
    }
    typename World::shape_def surface(const solid& b) const {
        typename World::shape_def def;
        def.density = S(b.density);
        def.material.friction = S(b.friction);
        def.material.restitution = S(b.restitution);
        if constexpr (D == 2) def.material.surface_velocity = S(b.belt);
        else def.material.surface_velocity.x = S(b.belt);
        return def;
    }
    body_id box(const solid& b) {
        const body_id id = body(b);
        static_cast<void>(world.create_shape(id, typename World::box{to(b.half)}, surface(b)));
        return id;
    }
    body_id ball(const solid& b) {
        const body_id id = body(b);
        static_cast<void>(world.create_shape(id, typename World::ball{S(b.half[0])}, surface(b)));
        return id;
    }
    /// A box of 200 m times a scale whose top is at y = 0.
    body_id floor(double friction = 0.6, double restitution = 0, const triple& from = {}, double scale = 1) {
        solid b;
        b.at = from + triple{0, -scale, 0};
        b.half = {100 * scale, scale, 100 * scale};
        b.friction = friction, b.restitution = restitution;
        b.type = body_type::static_body;
        return box(b);
    }
    body_id cube(const triple& at, double mass = 1, double friction = 0.6) {
        solid b;
        b.at = at, b.density = mass, b.friction = friction;
        return box(b);
    }

    static triple from(const vec& v) {
        triple t = {};
        for (int k = 0; k < D; ++k) t[static_cast<std::size_t>(k)] = static_cast<double>(v[k]);
        return t;
    }
    triple place(body_id id) const { return from(world.position(id)); }
    triple velocity(body_id id) const { return from(world.linear_velocity(id)); }
    triple spin(body_id id) const {
        if constexpr (D == 2) return {0, 0, static_cast<double>(world.angular_velocity(id))};
        else return from(world.angular_velocity(id));
    }
    std::array<double, 4> rotation(body_id id) const {
        const auto r = world.rotation(id);
        if constexpr (D == 2) {
            const double half = std::atan2(static_cast<double>(r.sine), static_cast<double>(r.cosine)) / 2;
            return {0, 0, std::sin(half), std::cos(half)};
        } else {
            return {static_cast<double>(r.x), static_cast<double>(r.y), static_cast<double>(r.z),
                    static_cast<double>(r.w)};
        }
    }
    /// A vector of the world in the body's frame, and back.
    triple into(body_id id, const triple& v) const {
        const auto q = rotation(id);
        return rotated({-q[0], -q[1], -q[2], q[3]}, v);
    }
    triple out_of(body_id id, const triple& v) const { return rotated(rotation(id), v); }

    /// Of a homogeneous box of some half extents: its moments by its mass.
    static triple gyration(const triple& half) {
        const double x = half[0] * half[0], y = half[1] * half[1], z = D == 2 ? 0 : half[2] * half[2];
        return {(y + z) / 3, (x + z) / 3, (x + y) / 3};
    }
    /// Kinetic energy of such a box by its mass, and its angular momentum by its mass.
    double motion(body_id id, const triple& half) const {
        const triple v = velocity(id), w = into(id, spin(id)), k = gyration(half);
        return (dot(v, v) + k[0] * w[0] * w[0] + k[1] * w[1] * w[1] + k[2] * w[2] * w[2]) / 2;
    }
    triple angular_momentum(body_id id, const triple& half) const {
        const triple w = into(id, spin(id)), k = gyration(half);
        return out_of(id, {k[0] * w[0], k[1] * w[1], k[2] * w[2]});
    }

    /// Energy of such a box by its mass, as in the middle of the last substep of a frame: where bodies fly, velocities
    /// are those of a substep's end, and places those of a mean speed.
    double energy(body_id id, const triple& half) const {
        const triple v = velocity(id);
        return motion(id, half) + 10 * (place(id)[1] - v[1] * frame / world.settings().solver.substeps / 2);
    }

    void step(double dt = frame) { world.step(S(dt)); }
    /// Takes frames for some seconds; the largest figure after any of them.
    template <class F>
    double largest(double seconds, F&& figure) {
        double most = 0;
        const int count = static_cast<int>(std::lround(seconds / frame));
        for (int i = 0; i < count; ++i) {
            step();
            most = worse(figure(), most);
            if (!(most < infinity)) return infinity;
        }
        return most;
    }
    /// How far any body is from where it began, and how fast the fastest one is.
    void remember() {
        start.clear();
        for (const body_id id : bodies) start.push_back(place(id));
    }
    double moved() const {
        double most = 0;
        for (std::size_t i = 0; i < start.size(); ++i) most = worse(length(place(bodies[i]) - start[i]), most);
        return most;
    }
    double fastest() const {
        double most = 0;
        for (const body_id id : bodies) most = worse(length(velocity(id)), most);
        return most;
    }

    World world;
    std::vector<body_id> bodies;
    std::vector<triple> start;
};

/// The figure, or that the scene was refused.
template <class World>
double measured(const row<World>& r, const work& with) {
    try {
        return r.measure(r.parameter, with);
    } catch (const physics::error&) {
        return refused;
    }
}

}  // namespace extremes
