// The default broadphase: trees of boxes.
#pragma once

#include "physics/broadphase/indexed.hpp"
#include "physics/broadphase/tree_index.hpp"

PHYSICS_HPP_BEGIN

/// Trees of boxes without bounds: for every scene, whatever moves and however sizes differ. Nodes hold eight boxes in
/// float lanes, whatever the scalar. Movable proxies and the others have trees of their own; boxes that move a little
/// stay in their place, and where more than a quarter has moved, a tree is packed anew, along a Morton curve. Resting
/// proxies cost nothing, and neither the order of insertion nor teleports make a tree worse.
/// Cost of a step: 100 to 200 ns for each proxy that left its box. Queries: O(log n + found).
struct dynamic_tree {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::tree_index<Space>>;
};

PHYSICS_HPP_END
