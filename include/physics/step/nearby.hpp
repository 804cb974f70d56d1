// Which shapes are near.
#pragma once

#include "physics/broadphase/queries.hpp"
#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(shape's number) for shapes whose boxes reach into a box.
template <class Plan, class F>
void each_near(const state<Plan>& s, const aabb<typename Plan::scalar, Plan::dimension>& box,
               const query_filter& filter, F&& f) {
    if constexpr (requires { s.broadphase.each_overlapping(box, filter, f); }) {
        s.broadphase.each_overlapping(box, filter, f);
    } else {
        s.shapes.each([&](std::uint32_t i, const auto& shape) {
            if (filter.sees(filter_of(s, shape)) && overlap(query_bounds(s, shape), box)) f(i);
        });
    }
}

}  // namespace detail

PHYSICS_HPP_END
