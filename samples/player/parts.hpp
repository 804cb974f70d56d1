// What a recorded run is made of: poses, shapes, contacts, and lines of debug drawing.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace samples {

/// Where something is: metres, and a unit quaternion. Make it with `flat` or `solid`.
struct pose {
    double x = 0, y = 0, z = 0;
    double qx = 0, qy = 0, qz = 0, qw = 1;
};
/// A pose in the plane, turned counter-clockwise by the angle in radians.
inline pose flat(double x, double y, double angle = 0) {
    return {x, y, 0, 0, 0, std::sin(angle / 2), std::cos(angle / 2)};
}
/// A pose in the plane, its rotation given as a cosine and a sine.
inline pose flat(double x, double y, double cosine, double sine) { return flat(x, y, std::atan2(sine, cosine)); }
/// A pose in space; the quaternion has length one, its real part comes last.
inline pose solid(double x, double y, double z, double qx = 0, double qy = 0, double qz = 0, double qw = 1) {
    return {x, y, z, qx, qy, qz, qw};
}

/// A shape to draw, placed in its body. Make it with one of the functions below.
struct shape {
    std::string_view form;
    std::vector<double> size;
    pose local;
    bool hollow = false;  ///< Drawn as an outline, as sensors are.
};
/// A ball, or in the plane a disc, by its radius.
inline shape sphere(double radius, pose local = {}) { return {"sphere", {radius}, local, false}; }
/// A capsule around the segment from -half_length to +half_length on the local x axis.
inline shape capsule(double radius, double half_length, pose local = {}) {
    return {"capsule", {radius, half_length}, local, false};
}
/// A box by its half extents; leave out the third in the plane.
inline shape box(double hx, double hy, double hz = 0, pose local = {}) { return {"box", {hx, hy, hz}, local, false}; }
/// All points with normal . point <= offset; the normal has length one, nz is 0 in the plane.
inline shape halfspace(double nx, double ny, double nz, double offset, pose local = {}) {
    return {"halfspace", {nx, ny, nz, offset}, local, false};
}
/// In the plane, x and y of points in a row: a filled outline, counter-clockwise, whose holes are clockwise ones.
inline shape polygon(std::vector<double> points, pose local = {}) {
    return {"polygon", std::move(points), local, false};
}
/// In the plane, x and y of points that lines join.
inline shape line(std::vector<double> points, pose local = {}) { return {"line", std::move(points), local, false}; }

/// How a body moves. Static bodies are stored once; the others at every recorded frame.
enum class motion : std::uint8_t { fixed, kinematic, dynamic };

/// A touching point: metres, a unit normal (either direction), and the impulse in N s.
struct touch {
    double x = 0, y = 0, z = 0;
    double nx = 0, ny = 0, nz = 0;
    double impulse = 0;
};

/// A line of debug drawing, a dot where its ends are one: metres, a colour as 0xrrggbb, and, where it is of a body, the
/// body's number.
struct drawn_line {
    std::array<double, 3> from{}, to{};
    std::uint32_t colour = 0;
    int body = -1;
};

}  // namespace samples
