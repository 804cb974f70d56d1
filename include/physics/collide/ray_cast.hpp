// Where a ray meets a shape.
#pragma once

#include "physics/collide/ray_solids.hpp"
#include "physics/collide/shape_cast.hpp"

PHYSICS_HPP_BEGIN

/// Where a ray enters a shape, in the frame that both are given in.
template <class S, int D>
struct ray_hit {
    bool hit = false;
    /// The part of the ray's translation up to there; 0 if it begins within, or on the surface that it enters.
    S fraction = S(1);
    /// Unit vector outwards; null if the ray begins strictly within.
    vec<S, D> normal;
    vec<S, D> point;

    explicit operator bool() const { return hit; }
};

namespace detail {

template <class S, int D>
local_hit<D> cast_on_core(const local_ray<D>& ray, const core<D>& shape, double maximum = 1) {
    const core<D> center_point;
    const core_cast<D> c = cast(shape, placed_core<D>{&center_point, mat<double, D>::identity(), ray.origin},
                                ray.displacement, maximum, cast_precision::of<S>(shape, center_point));
    if (c.ended == core_cast<D>::outcome::missed) return {};
    return {true, c.fraction, c.ended == core_cast<D>::outcome::hit ? c.normal : point<D>{}};
}

// What ray_cast() calls, by the kind of shape.
template <class S, int D>
local_hit<D> cast_on(const ball<S, D>& b, const local_ray<D>& ray) {
    return cast_on_ball(ray, detail::to_double(b.radius));
}
template <class S, int D>
local_hit<D> cast_on(const capsule<S, D>& c, const local_ray<D>& ray) {
    return cast_on_capsule(ray, detail::to_double(c.half_length), detail::to_double(c.radius));
}
template <class S, int D>
local_hit<D> cast_on(const box<S, D>& b, const local_ray<D>& ray) {
    return cast_on_box(ray, to_point(b.half_extents));
}
template <class S, int D>
local_hit<D> cast_on(const halfspace<S, D>& h, const local_ray<D>& ray) {
    const bounding_half<D> half(h);
    clipped_ray<D> left;
    if (!left.keep(dot(half.normal, ray.origin) - half.offset, dot(half.normal, ray.displacement), half.normal))
        return {};
    return left.hit();
}
template <class S, int D>
local_hit<D> cast_on(const hull<S, D>& h, const local_ray<D>& ray) {
    return h.radius > S(0) ? cast_on_core<S>(ray, core_of(h)) : cast_on_hull(ray, *h.geometry);
}
template <class S>
local_hit<3> cast_on(const cylinder<S, 3>& c, const local_ray<3>& ray) {
    if (c.rounding > S(0)) return cast_on_core<S>(ray, core_of(c));
    return cast_on_cylinder(ray, detail::to_double(c.half_length), detail::to_double(c.radius));
}
template <class S>
local_hit<3> cast_on(const cone<S, 3>& c, const local_ray<3>& ray) {
    if (c.rounding > S(0)) return cast_on_core<S>(ray, core_of(c));
    return cast_on_cone(ray, detail::to_double(c.half_length), detail::to_double(c.lower_radius),
                        detail::to_double(c.upper_radius));
}
template <template <class, int> class Shape, class S, int D>
    requires has_core<Shape<S, D>> local_hit<D> cast_on(const Shape<S, D>& shape, const local_ray<D>& ray) {
        return cast_on_core<S>(ray, core_of(shape));
    }

}  // namespace detail

/// Where a ray, from `origin` along `translation` (m), first meets a shape that stands at `local` in the frame of a
/// body at `body`. A ray that begins strictly within hits at 0, without a normal; one that begins on the surface hits
/// at 0, with the normal, if it goes inwards, and misses if it leaves or goes along, as it does on two-sided surfaces
/// either way; what is cast by the general method (triangles, shapes of your own) counts its surface as its inside. A
/// ray along a face of a solid hits its edge, one along a part of a surface misses that; one without length hits what
/// it is strictly within. Exact to a few roundings of
/// double, of the sizes and of the distance: only rays that graze the shape by less may be judged either way; none
/// passes between parts of a surface that share corners. Cost: 15 to 100 ns; hulls 3 ns a face; rounded hulls and boxes
/// and other shapes 0.3 to 1.5 us, rounded cylinders and cones up to 8; surfaces and compounds 0.1 us and more, O(log
/// n) and the parts on the way.
template <class Shape, class S, int D>
    requires requires(const Shape& s, const detail::local_ray<D>& r) { cast_on(s, r); }
ray_hit<S, D> cast_ray(const Shape& shape, const transform<S, D>& body, const transform<S, D>& local,
                       std::type_identity_t<vec<S, D>> origin, std::type_identity_t<vec<S, D>> translation) {
    const mat<double, D> outer = detail::to_matrix(body.rotation), inner = detail::to_matrix(local.rotation);
    const detail::point<D> from = detail::to_point(origin), displacement = detail::to_point(translation),
                           seen = transposed_times(outer, from - detail::to_point(body.position));
    const detail::local_hit<D> h =
        cast_on(shape, detail::local_ray<D>{transposed_times(inner, seen - detail::to_point(local.position)),
                                            transposed_times(inner, transposed_times(outer, displacement))});
    if (!h.hit) return {};
    return {true, static_cast<S>(h.fraction), detail::from_point<S>(outer * (inner * h.normal)),
            detail::from_point<S>(from + displacement * h.fraction)};
}
/// The same for a shape that stands at `at`.
template <class Shape, class S, int D>
    requires requires(const Shape& s, const detail::local_ray<D>& r) { cast_on(s, r); }
ray_hit<S, D> cast_ray(const Shape& shape, const transform<S, D>& at, std::type_identity_t<vec<S, D>> origin,
                       std::type_identity_t<vec<S, D>> translation) {
    return cast_ray(shape, at, transform<S, D>{}, origin, translation);
}
/// The same for a shape of a set.
template <class S, int D, template <class, int> class... Shapes>
ray_hit<S, D> cast_ray(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& body,
                       const transform<S, D>& local, std::type_identity_t<vec<S, D>> origin,
                       std::type_identity_t<vec<S, D>> translation) {
    return shape.visit([&](const auto& s) { return cast_ray(s, body, local, origin, translation); });
}
template <class S, int D, template <class, int> class... Shapes>
ray_hit<S, D> cast_ray(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& at,
                       std::type_identity_t<vec<S, D>> origin, std::type_identity_t<vec<S, D>> translation) {
    return cast_ray(shape, at, transform<S, D>{}, origin, translation);
}

PHYSICS_HPP_END
