// Where a ray meets a shape that is made of parts: a surface or a compound.
#pragma once

#include "physics/collide/parts.hpp"
#include "physics/collide/ray_cast.hpp"
#include "physics/shape/box_ray.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class Shape, int D>
concept has_parts = is_surface<Shape, D> || is_compound<Shape, D>;

/// What a ray sees: how far aside of it things are, along the axes other than the one that it follows most. Each corner
/// is seen at one place, and rounding never turns round which of two products is the larger: so no ray passes between
/// parts that share corners. Source: Woop, Benthin, Wald: Watertight ray/triangle intersection (2013); here without its
/// division, so that what is exact in the numbers given is judged exactly.
template <int D>
class ray_view {
public:
    explicit ray_view(const point<D>& displacement) : displacement_(displacement) {
        for (int i = 1; i < D; ++i)
            if (abs(displacement[i]) > abs(displacement[axis_])) axis_ = i;
    }
    /// Whether it passes between corners that are given as seen from its origin, ends included.
    [[nodiscard]] bool passes(const point<2> (&c)[2]) const {
        const double a = aside(c[0], 0), b = aside(c[1], 0);
        return (a <= 0 && b >= 0) || (a >= 0 && b <= 0);
    }
    [[nodiscard]] bool passes(const point<3> (&c)[3]) const {
        vec<double, 2> p[3];
        for (int i = 0; i < 3; ++i) p[i] = {aside(c[i], 0), aside(c[i], 1)};
        const double u = cross(p[1], p[2]), v = cross(p[2], p[0]), w = cross(p[0], p[1]);
        return (u <= 0 && v <= 0 && w <= 0) || (u >= 0 && v >= 0 && w >= 0);
    }

private:
    /// Times the way along its own axis.
    [[nodiscard]] double aside(const point<D>& c, int i) const {
        const int other = i < axis_ ? i : i + 1;
        return c[other] * displacement_[axis_] - displacement_[other] * c[axis_];
    }

    point<D> displacement_;
    int axis_ = 0;
};
/// A vector across the part, out of its front.
inline point<2> across(const point<2> (&c)[2]) { return perpendicular(c[1] - c[0]); }
inline point<3> across(const point<3> (&c)[3]) { return cross(c[1] - c[0], c[2] - c[0]); }

inline core<2> core_of_face(const surface_face<2>& face, double radius) {
    return core_of(segment<double, 2>{face.corner[0], face.corner[1], radius});
}
inline core<3> core_of_face(const surface_face<3>& face, double radius) {
    return core_of(triangle<double, 3>{face.corner[0], face.corner[1], face.corner[2], radius});
}

/// The first of the hits that a ray has had so far; the normals may have any length.
template <class S, int D>
struct first_hit {
    const local_ray<D>& ray;
    ray_view<D> view;
    local_hit<D> hit;

    explicit first_hit(const local_ray<D>& r) : ray(r), view(r.displacement) {}
    [[nodiscard]] double maximum() const { return hit.hit ? hit.fraction : 1; }
    void keep_first(const local_hit<D>& other) {
        if (other.hit && (!hit.hit || other.fraction < hit.fraction)) hit = other;
    }
    /// A part without a radius stops what comes from its front, or from both sides.
    void meet(const surface_face<D>& face) {
        point<D> corner[D];
        double size = 0;
        for (int i = 0; i < D; ++i) {
            corner[i] = face.corner[i] - ray.origin;
            size = max(size, largest(face.corner[i]));
        }
        const point<D> out = detail::across(corner);
        // How far the origin is behind the part, times the length of `out`.
        const double behind = dot(out, corner[0]), climb = dot(out, ray.displacement);
        const double noise = 0x1p-49 * (size + largest(ray.origin)) * largest(out);
        if (abs(behind) <= noise) {
            // It begins in the plane of the part: it enters by the front, or misses.
            const double along = 0x1p-49 * largest(ray.displacement) * largest(out);
            if (!face.two_sided && climb < -along && view.passes(corner)) keep_first({true, 0, out});
            return;
        }
        if ((behind > 0 && !face.two_sided) || (behind > 0) != (climb > 0)) return;
        if (abs(behind) > abs(climb) * maximum() + noise || !view.passes(corner)) return;
        keep_first({true, min(behind / climb, maximum()), behind > 0 ? -out : out});
    }
    /// The same of a part with a radius.
    void meet(const surface_face<D>& face, double radius) {
        const double behind = dot(across(face.corner), face.corner[0] - ray.origin);
        if (face.two_sided || !(behind > 0)) keep_first(cast_on_core<S>(ray, core_of_face(face, radius), maximum()));
    }
};

/// A ray and a convex shape whose type is forgotten: by a closed form, if its core has one in its own frame.
template <class S, int D>
local_hit<D> cast_on_solid(const local_ray<D>& ray, const core<D>& shape, double maximum) {
    if (shape.radius == 0 && shape.kind == core_kind::box) return cast_on_box(ray, shape.corner[0]);
    if constexpr (D == 3)
        if (shape.radius == 0 && shape.kind == core_kind::disc)
            return cast_on_cone(ray, shape.corner[0].x, shape.corner[0].y, shape.corner[0].z);
    if (shape.radius > 0 && shape.kind == core_kind::point)
        return cast_on_ball(local_ray<D>{ray.origin - shape.corner[0], ray.displacement}, shape.radius);
    return cast_on_core<S>(ray, shape, maximum);
}

template <class Shape, int D>
    requires has_parts<Shape, D> local_hit<D> cast_on(const Shape& shape, const local_ray<D>& ray) {
        using S = typename Shape::scalar;
        first_hit<S, D> first(ray);
        if constexpr (is_surface<Shape, D>) {
            const double radius = detail::to_double(shape.radius);
            const auto meet = [&](const surface_face<D>& face) {
                if (radius > 0) first.meet(face, radius);
                else first.meet(face);
                return first.maximum();
            };
            const box_ray<D> search(ray.origin, ray.displacement, radius);
            if constexpr (requires { each_part_along(shape, search, meet); }) {
                each_part_along(shape, search, meet);
            } else {
                each_part(shape, search.bounds(), [&](const surface_part<D>& part) {
                    surface_face<D> face{{}, part.two_sided};
                    for (int i = 0; i < D; ++i) face.corner[i] = part.corner[i];
                    meet(face);
                });
            }
        } else {
            const auto meet = [&](const auto& child) {
                const local_ray<D> seen{transposed_times(child.axes, ray.origin - child.at),
                                        transposed_times(child.axes, ray.displacement)};
                local_hit<D> hit = cast_on_solid<S>(seen, child.shape, first.maximum());
                hit.normal = child.axes * hit.normal;
                first.keep_first(hit);
                return first.maximum();
            };
            const box_ray<D> search(ray.origin, ray.displacement, 0);
            if constexpr (requires { each_child_along(shape, search, meet); }) each_child_along(shape, search, meet);
            else each_child(shape, search.bounds(), meet);
        }
        first.hit.normal = normalized(first.hit.normal);
        return first.hit;
    }

}  // namespace detail

PHYSICS_HPP_END
