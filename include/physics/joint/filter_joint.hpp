// The filter joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Keeps two bodies from colliding, and does nothing else: they move, sleep and wake apart. Rows: none.
template <class S, int D>
struct filter_joint {
    static constexpr int row_count = 0;
    template <class Self, class F>
    static constexpr void each_member(Self&, F&&) {}

    void rows(const joint_frames<S, D>&, joint_row<S, D>*) const {}
};

template <class S, int D>
bool check(const filter_joint<S, D>&, const char*) {
    return true;
}

PHYSICS_HPP_END
