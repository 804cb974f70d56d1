// A pair of boxes, as batches of them are passed.
#pragma once

#include "physics/shape/box.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Two boxes, and where B stands in A's frame.
template <class S, int D>
struct box_pair {
    const box<S, D>* a;
    const box<S, D>* b;
    const transform<S, D>* b_in_a;
};

}  // namespace detail

PHYSICS_HPP_END
