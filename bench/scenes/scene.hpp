// What a scene is, told to all engines alike: plain numbers in double, SI units, y up.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace bench {

using triple = std::array<double, 3>;
/// A unit quaternion x, y, z, w; scenes in the plane turn about z.
using turn = std::array<double, 4>;

inline turn turned(double angle) { return {0, 0, std::sin(angle / 2), std::cos(angle / 2)}; }
inline double angle_of(const turn& q) { return 2 * std::atan2(q[2], q[3]); }

inline triple operator+(const triple& a, const triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline triple operator-(const triple& a, const triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline triple operator*(const triple& a, double k) { return {a[0] * k, a[1] * k, a[2] * k}; }
inline double dot(const triple& a, const triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline triple cross(const triple& a, const triple& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const triple& a) { return std::sqrt(dot(a, a)); }
inline triple rotated(const turn& q, const triple& v) {
    const triple u = {q[0], q[1], q[2]}, t = cross(u, v) * 2;
    return v + t * q[3] + cross(u, t);
}
inline turn inverse(const turn& q) { return {-q[0], -q[1], -q[2], q[3]}; }

/// Cylinders and meshes are of space, segments and chains of the plane; the last three have no mass.
enum class form { ball, capsule, box, hull, cylinder, segment, chain, mesh };
enum class role { fixed, driven, free };

struct shape {
    form kind = form::box;
    /// Of a box: half its extents. Of a capsule, cylinder or segment: half[0] is half its length, along x and without
    /// what is round of a capsule.
    triple half = {};
    /// Of a ball, capsule or cylinder; by how much a box is grown and rounded.
    double radius = 0;
    /// Of a hull; in the plane counter-clockwise. Engines may want at most 8. Of a chain, a loop whose front is to the
    /// right on the way. Of a mesh.
    std::vector<triple> points;
    /// Of a mesh: three numbers of points for each, counter-clockwise as seen from the front.
    std::vector<std::uint32_t> triangles;
    triple at = {};
    turn rotation = {0, 0, 0, 1};
    double density = 1, friction = 0.6, restitution = 0;
};

struct body {
    role kind = role::free;
    triple at = {};
    turn rotation = {0, 0, 0, 1};
    /// At the start of free bodies, for good of driven ones.
    triple velocity = {}, spin = {};
    std::vector<shape> shapes;
    /// The step before which it enters.
    int born = 0;
};

/// A driven body that goes to and fro: x = reach * sin(rate * t).
struct swing {
    int body = 0;
    double reach = 0, rate = 0;

    /// The speed that brings it in one step from where it should be at time t to where at t + dt.
    [[nodiscard]] double speed(double t, double dt) const {
        return reach * (std::sin(rate * (t + dt)) - std::sin(rate * t)) / dt;
    }
};

/// Holds a point of one body to a point of another, whose bodies then do not collide.
struct joint {
    int a = 0, b = 0;
    /// In the frames of the bodies.
    triple point_a = {}, point_b = {};
    /// In the plane: whether B keeps its turn too, up to which torque it does not turn (N m), and how far it turns
    /// counter-clockwise from where it starts (rad), if lower < upper.
    bool rigid = false;
    double friction = 0, lower = 0, upper = 0;
};

struct scene {
    std::string name;
    int dimension = 2;
    triple gravity = {0, -10, 0};
    double dt = 1.0 / 60;
    int steps = 300;
    /// How hard engines try; 0: as they ship. Who has no substeps takes no notice of them.
    int substeps = 0, iterations = 0;
    /// Whether bodies may fall asleep.
    bool sleeps = false;
    std::vector<body> bodies;
    /// Made as soon as both bodies are there; in the order of the younger of the two.
    std::vector<joint> joints;
    std::vector<swing> swings;
    /// Bodies on top of structures, which should stay where they are.
    std::vector<int> tops;
    /// Whoever is outside has escaped.
    triple lower = {-1000, -1000, -1000}, upper = {1000, 1000, 1000};

    int add(body b) {
        bodies.push_back(std::move(b));
        return static_cast<int>(bodies.size()) - 1;
    }
    /// Joins two bodies at a place in the world.
    joint& pin(int a, int b, const triple& place) {
        const auto in = [&](int i) {
            const body& it = bodies[static_cast<std::size_t>(i)];
            return rotated(inverse(it.rotation), place - it.at);
        };
        return joints.emplace_back(joint{a, b, in(a), in(b)});
    }
    [[nodiscard]] bool has(form kind) const {
        for (const body& b : bodies)
            for (const shape& s : b.shapes)
                if (s.kind == kind) return true;
        return false;
    }
    [[nodiscard]] bool drives() const {
        for (const body& b : bodies)
            if (b.kind == role::driven) return true;
        return false;
    }
    [[nodiscard]] int free_bodies() const {
        int count = 0;
        for (const body& b : bodies) count += b.kind == role::free;
        return count;
    }
};

/// What can be seen of a body from outside of an engine.
struct state {
    /// Of the body's frame.
    triple at = {};
    turn rotation = {0, 0, 0, 1};
    /// Of the centre of mass.
    triple velocity = {}, spin = {};
    double mass = 0;
};

}  // namespace bench
