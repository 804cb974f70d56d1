// Which shapes are near.
#pragma once

#include "physics/broadphase/queries.hpp"
#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(shape's number) for shapes whose boxes reach into a box. Of the world it reads bodies, shapes, which sleep,
/// the broadphase and the contact margin. Shapes of what can be pushed may be left out unless movable is true.
template <class World, class S, int D, class F>
void each_near(const World& w, const aabb<S, D>& box, const query_filter& filter, F&& f, bool movable = true) {
    if constexpr (requires { w.broadphase.each_overlapping(box, filter, f, movable); }) {
        w.broadphase.each_overlapping(box, filter, f, movable);
    } else if constexpr (requires { w.broadphase.each_overlapping(box, filter, f); }) {
        w.broadphase.each_overlapping(box, filter, f);
    } else {
        w.shapes.each([&](std::uint32_t i, const auto& shape) {
            if (filter.sees(filter_of(w, shape)) && overlap(query_bounds(w, shape), box)) f(i);
        });
    }
}

}  // namespace detail

PHYSICS_HPP_END
