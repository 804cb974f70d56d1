// Corners, edges and faces of the judge's bodies, and how those of two are made to meet.
#pragma once

#include "judge.hpp"

namespace {

namespace judge {

inline point wide_direction(cell::dice& dice) { return wide(random_direction(dice)); }
inline point across(point n, cell::dice& dice) {
    for (;;) {
        const point v = wide_direction(dice), u = v - n * dot(n, v);
        if (oracle::size(u) > 0.1L) return unit_of(u);
    }
}

/// A unit vector that points out of a corner, an edge or a face of a body.
inline point outward(const body& b, cell::dice& dice) {
    const int feature = dice.below(3);
    const point any = wide_direction(dice);
    if (feature == 0) return any;
    if (b.of == body::kind::discs) {
        if (feature == 1) return {any.x < 0 ? -1.0L : 1.0L, 0, 0};
        // Out of the side, along an axis half of the time.
        point n{0, 1, 0};
        if (dice.below(2)) n = unit_of({0, any.y, any.z});
        return unit_of(point{b.half.y - b.half.z, 0, 0} + n * (2 * b.half.x));
    }
    if (feature == 2 && !b.edges.empty()) {
        const body::edge& e = b.edges[static_cast<std::size_t>(dice.below(int(b.edges.size())))];
        for (int tries = 0; tries < 8; ++tries) {
            const point n = across(e.along, dice);
            bool out = true;
            for (std::size_t i = e.first; i < e.last; ++i) out = out && dot(n, b.beside[i]) <= 0;
            if (out) return n;
        }
    }
    return b.normals.empty() ? any : b.normals[static_cast<std::size_t>(dice.below(int(b.normals.size())))];
}

/// The corners of a body's core that lie farthest along n, but for rounding; of discs points of their rims.
inline std::vector<point> farthest_corners(const body& b, point n, cell::dice& dice) {
    std::vector<point> all = b.corners, farthest;
    if (b.of == body::kind::discs) {
        point out{0, 1, 0};
        const real aside = std::hypot(n.y, n.z);
        if (aside > 1e-12L) out = point{0, n.y, n.z} * (1 / aside);
        else if (dice.below(2)) out = across({1, 0, 0}, dice);
        all = {point{-b.half.x, 0, 0} + out * b.half.y, point{b.half.x, 0, 0} + out * b.half.z};
        if (aside <= 1e-12L) {
            all.push_back({-b.half.x, 0, 0});
            all.push_back({b.half.x, 0, 0});
        }
    }
    const real most = b.reach(n);
    for (const point& p : all)
        if (dot(p, n) >= most - 1e-9L * b.extent) farthest.push_back(p);
    return farthest.empty() ? all : farthest;
}
/// The mean of some of them: a corner, or a point in an edge or face that is no rounder a number than they are.
inline point mean_of_some(const std::vector<point>& all, cell::dice& dice) {
    const int picks = 1 << dice.below(3);
    point sum;
    for (int i = 0; i < picks; ++i) sum = sum + all[static_cast<std::size_t>(dice.below(int(all.size())))];
    return sum * (1.0L / picks);
}
/// A unit vector across n, along an edge there if there is one.
inline point tangent(const body& b, const std::vector<point>& corners, point n, cell::dice& dice) {
    if (corners.size() > 1) {
        const point e = corners[1] - corners[0], t = e - n * dot(n, e);
        if (oracle::size(t) > 1e-6L * b.extent) return unit_of(t);
    }
    return across(n, dice);
}

/// The rotation that takes the axes of one frame to those of another, as a quaternion (x, y, z, w): all of its
/// components are found from the largest.
inline std::vector<S> quaternion_between(const point (&from)[3], const point (&to)[3]) {
    real m[3][3] = {};
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m[i][j] += to[k][i] * from[k][j];
    const real trace = m[0][0] + m[1][1] + m[2][2];
    real q[4];
    int largest = 3;
    real most = trace;
    for (int i = 0; i < 3; ++i)
        if (m[i][i] > most) most = m[i][i], largest = i;
    if (largest == 3) {
        q[3] = 1 + trace;
        for (int i = 0; i < 3; ++i) q[i] = m[(i + 2) % 3][(i + 1) % 3] - m[(i + 1) % 3][(i + 2) % 3];
    } else {
        const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
        q[i] = 1 + 2 * m[i][i] - trace;
        q[j] = m[i][j] + m[j][i];
        q[k] = m[i][k] + m[k][i];
        q[3] = m[k][j] - m[j][k];
    }
    const real scale = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    return {S(double(q[0] * scale)), S(double(q[1] * scale)), S(double(q[2] * scale)), S(double(q[3] * scale))};
}

/// A rotation whose numbers every scalar holds exactly.
inline rotation exact_rotation(cell::dice& dice) {
    if constexpr (cell::is_2d) {
        constexpr int turns[][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        const auto& t = turns[dice.below(4)];
        return rotation_of({S(t[0]), S(t[1])});
    } else {
        const int i = dice.below(12);
        if (i < 4) return rotation_of({S(i == 1 ? 1 : 0), S(i == 2 ? 1 : 0), S(i == 3 ? 1 : 0), S(i == 0 ? 1 : 0)});
        return rotation_of({S(i & 1 ? 0.5 : -0.5), S(i & 2 ? 0.5 : -0.5), S(i & 4 ? 0.5 : -0.5), S(0.5)});
    }
}
/// The rotation that takes m to n and s, across m, to t, across n; and then turns by an angle about any axis.
inline rotation rotation_between(point m, point s, point n, point t, real angle, cell::dice& dice) {
    if constexpr (cell::is_2d) {
        // s and t are not needed: there is only one.
        const real turn = std::atan2(n.y, n.x) - std::atan2(m.y, m.x) + angle;
        return rotation_of({S(double(std::cos(turn))), S(double(std::sin(turn)))});
    } else {
        const point axis = wide_direction(dice);
        const auto turned = [&](point v) {
            const real c = std::cos(angle), one_less = 2 * std::sin(angle / 2) * std::sin(angle / 2);
            return v * c + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * one_less);
        };
        return rotation_of(quaternion_between({m, s, cross(m, s)}, {turned(n), turned(t), turned(cross(n, t))}));
    }
}

}  // namespace judge

}  // namespace
