// Where a ray meets solids that have a closed form.
#pragma once

#include "physics/shape/core.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A ray in a shape's frame, and where it meets the shape; the normal stays null where it begins strictly within.
template <int D>
struct local_ray {
    point<D> origin, displacement;
};
template <int D>
struct local_hit {
    bool hit = false;
    double fraction = 0;
    point<D> normal;
};

/// The times at which a ray that moves is within r of the frame's origin, ends included; those may lie before its
/// start. Source: Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems (2019), 7.
template <int D>
bool ball_span(const local_ray<D>& ray, double r, double& near, double& far) {
    const auto [direction, length] = direction_and_length_of(ray.displacement);
    const double along = -dot(ray.origin, direction), from = physics::length(ray.origin);
    const double aside = physics::length(ray.origin + direction * along);
    if (!(length > 0) || aside > r) return false;
    const double half = physics::sqrt((r - aside) * (r + aside)), c = (from - r) * (from + r);
    // Of each pair of roots the one that does not cancel gives the other.
    near = (along > 0 ? c / (along + half) : along - half) / length;
    far = (along > 0 ? along + half : along - half < 0 ? c / (along - half) : 0) / length;
    return true;
}

/// A ray that begins on a surface, whose normal there may have any length: it enters, or misses.
template <int D>
local_hit<D> enter(const local_ray<D>& ray, const point<D>& out) {
    if (!(dot(out, ray.displacement) < 0)) return {};
    return {true, 0, normalized(out)};
}

template <int D>
local_hit<D> cast_on_ball(const local_ray<D>& ray, double r) {
    const double square = dot(ray.origin, ray.origin);
    if (square < r * r) return {true, 0, {}};
    if (square == r * r) return enter(ray, ray.origin);
    double near = 0, far = 0;
    if (!ball_span(ray, r, near, far) || near < 0 || near > 1) return {};
    return {true, near, normalized(ray.origin + ray.displacement * near)};
}

/// First the endless cylinder around the axis, then the side or the ball at the end where the ray enters that.
template <int D>
local_hit<D> cast_on_capsule(const local_ray<D>& ray, double half_length, double r) {
    local_ray<D> across = ray;
    across.origin.x = across.displacement.x = 0;
    double near = 0, far = 0;
    const double square = dot(across.origin, across.origin);
    const bool begins_beside = square <= r * r;
    if (!begins_beside && (!ball_span(across, r, near, far) || near < 0 || near > 1)) return {};
    const double x = ray.origin.x + ray.displacement.x * near;
    if (abs(x) <= half_length) {
        if (square < r * r) return {true, 0, {}};
        if (begins_beside) return enter(ray, across.origin);
        return {true, near, normalized(across.origin + across.displacement * near)};
    }
    local_ray<D> to_end = ray;
    to_end.origin.x -= x < 0 ? -half_length : half_length;
    return cast_on_ball(to_end, r);
}

/// The part of a ray that is left after clipping by halfspaces.
template <int D>
struct clipped_ray {
    double near = 0, far = 1;
    point<D> normal;
    /// Whether it has come in from outside, or begins on a surface; whether that is one that it does not enter by.
    bool enters = false, begins_on = false;

    /// Keeps what lies on the inner side of a plane: `height` is how far outside the ray begins, `climb` how fast it
    /// moves outwards. False if nothing is left.
    bool keep(double height, double climb, const point<D>& n) {
        if (height == 0 && !(climb < 0)) begins_on = true;
        if (climb < 0) {
            if (height > -climb * near || (height == 0 && !enters)) enter(height / -climb, n);
        } else if (climb > 0) {
            if (-height < climb * far) far = -height / climb;
        } else if (height > 0) {
            return false;
        }
        return near <= far;
    }
    void enter(double at, const point<D>& n) {
        near = at;
        normal = n;
        enters = true;
    }
    /// It begins on a round side, whose normal there may have any length.
    void begin_on(const point<D>& out, const point<D>& displacement) {
        if (largest(out) == 0) return;  // the tip of a cone
        if (!(dot(out, displacement) < 0)) begins_on = true;
        else if (!(near > 0) && !enters) enter(0, normalized(out));
    }
    /// One that begins on a face, and leaves it or goes along it, does not enter there.
    [[nodiscard]] local_hit<D> hit() const {
        if (begins_on && !(near > 0)) return {};
        return {true, near, normal};
    }
};

template <int D>
local_hit<D> cast_on_box(const local_ray<D>& ray, const point<D>& half) {
    clipped_ray<D> left;
    for (int i = 0; i < D; ++i)
        for (const double side : {1.0, -1.0}) {
            point<D> n;
            n[i] = side;
            if (!left.keep(side * ray.origin[i] - half[i], side * ray.displacement[i], n)) return {};
        }
    return left.hit();
}

template <class R, int D>
local_hit<D> cast_on_hull(const local_ray<D>& ray, const hull_data<R, D>& h) {
    clipped_ray<D> left;
    for (std::uint32_t i = 0; i < h.face_count; ++i) {
        const point<D>& n = h.normal(i);
        if (!left.keep(dot(n, ray.origin) - h.offset(i), dot(n, ray.displacement), n)) return {};
    }
    return left.hit();
}

/// The caps' planes, then the endless cylinder around the axis.
inline local_hit<3> cast_on_cylinder(const local_ray<3>& ray, double half, double r) {
    clipped_ray<3> left;
    for (const double side : {1.0, -1.0})
        if (!left.keep(side * ray.origin.x - half, side * ray.displacement.x, {side, 0, 0})) return {};
    local_ray<3> across = ray;
    across.origin.x = across.displacement.x = 0;
    const double square = dot(across.origin, across.origin);
    const bool begins_beside = square <= r * r;
    if (square == r * r) left.begin_on(across.origin, across.displacement);
    if (largest(across.displacement) == 0) return begins_beside ? left.hit() : local_hit<3>{};
    double near = 0, far = 0;
    if (!ball_span(across, r, near, far)) return {};
    if (begins_beside) return left.near <= max(far, 0.0) ? left.hit() : local_hit<3>{};
    if (near > left.near) left.enter(near, normalized(across.origin + across.displacement * near));
    return left.near <= min(left.far, far) ? left.hit() : local_hit<3>{};
}

/// The part of a line, by its length from `base` along the unit vector u, that is within a cone around the x axis whose
/// radius is radius + slope * x, where that is not negative. False if there is none; ends may be infinite.
inline bool cone_span(const point<3>& base, const point<3>& u, double radius, double slope, double& near, double& far) {
    constexpr double endless = 1e300;
    const double growth = slope * u.x, aside = length(vec<double, 2>{base.y, base.z});
    const double across = length(vec<double, 2>{u.y, u.z});
    radius += slope * base.x;
    // Along the line the squared distance from the axis less the squared radius is a s^2 + 2 b s + c.
    const double a = (across - growth) * (across + growth), b = base.y * u.y + base.z * u.z - radius * growth;
    const double c = (aside - radius) * (aside + radius), square = b * b - a * c;
    if (square < 0 && a > 0) return false;
    // Of the roots the one that does not cancel gives the other.
    const double root = sqrt(max(square, 0.0)), sum = b > 0 ? -b - root : root - b;
    if (sum == 0) {
        // The line is one of the cone's own, or leads through its tip.
        near = a > 0 ? 0 : -endless;
        far = a > 0 ? 0 : endless;
        return a > 0 || c <= 0;
    }
    const double small = c / sum;
    const double large = abs(sum) < endless * abs(a) ? sum / a : (sum > 0) == (a > 0) ? endless : -endless;
    if (a > 0) {
        near = min(small, large);
        far = max(small, large);
        return true;
    }
    // It climbs as fast as the cone widens, or faster: the other root is on the other side of the tip.
    if (a == 0 && (growth > 0) == (b > 0)) return false;
    near = growth > 0 ? (a == 0 ? small : max(small, large)) : -endless;
    far = growth > 0 ? endless : a == 0 ? small : min(small, large);
    return true;
}

/// The caps' planes, then the endless cone around the axis.
inline local_hit<3> cast_on_cone(const local_ray<3>& ray, double half, double low, double high) {
    clipped_ray<3> left;
    for (const double side : {1.0, -1.0})
        if (!left.keep(side * ray.origin.x - half, side * ray.displacement.x, {side, 0, 0})) return {};
    const double slope = (high - low) / (2 * half), aside = length(vec<double, 2>{ray.origin.y, ray.origin.z});
    // As seen from the narrow end: there the digits count.
    const point<3> end{low < high ? -half : half, 0, 0}, origin = ray.origin - end;
    const double narrow = min(low, high);
    const double radius = narrow + slope * origin.x;
    const bool begins_beside = aside <= radius;
    if (aside == radius) left.begin_on(point<3>{-slope * aside, origin.y, origin.z}, ray.displacement);
    const auto [u, length] = direction_and_length_of(ray.displacement);
    if (!(length > 0)) return begins_beside ? left.hit() : local_hit<3>{};
    const double start = -dot(origin, u);
    double near = 0, far = 0;
    if (!cone_span(origin + u * start, u, narrow, slope, near, far)) return {};
    near = (near + start) / length;
    far = (far + start) / length;
    if (begins_beside) return left.near <= max(far, 0.0) ? left.hit() : local_hit<3>{};
    if (near > left.near) {
        const point<3> at = origin + ray.displacement * near;
        vec<double, 2> out{at.y, at.z};
        // At the tip the side that the ray sees.
        if (largest(out) <= 0x1p-40 * (half + largest(origin))) out = {-u.y, -u.z};
        out = normalized(out);
        left.enter(near, normalized(point<3>{-slope, out.x, out.y}));
    }
    return left.near <= min(left.far, far) ? left.hit() : local_hit<3>{};
}

}  // namespace detail

PHYSICS_HPP_END
