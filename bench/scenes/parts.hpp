// What scenes are put together from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "makers.hpp"

namespace bench {

const std::vector<maker>& flat_makers();
const std::vector<maker>& solid_makers();

inline scene named(const char* name, int dimension, int steps) {
    scene s;
    s.name = name;
    s.dimension = dimension;
    s.steps = steps;
    return s;
}
inline shape box(const triple& half) {
    shape s;
    s.half = half;
    return s;
}
/// A line in the plane, along x.
inline shape segment(double half) {
    shape s;
    s.kind = form::segment;
    s.half = {half, 0, 0};
    return s;
}
inline shape placed(shape s, const triple& at) {
    s.at = at;
    return s;
}
inline body solid(const triple& at, const shape& s) {
    body b;
    b.at = at;
    b.shapes = {s};
    return b;
}
inline body ground(const triple& at, const shape& s) {
    body b = solid(at, s);
    b.kind = role::fixed;
    return b;
}
/// Puts points around the origin in order of their angles.
inline void make_counter_clockwise(std::vector<triple>& points) {
    std::sort(points.begin(), points.end(),
              [](const triple& a, const triple& b) { return std::atan2(a[1], a[0]) < std::atan2(b[1], b[0]); });
}

/// Numbers that are the same everywhere (splitmix64).
class dice {
public:
    /// From -1 to 1.
    double next() {
        std::uint64_t z = seed_ += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-52 - 1;
    }

private:
    std::uint64_t seed_ = 1;
};

}  // namespace bench
