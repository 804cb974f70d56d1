// The default broadphase: trees of boxes.
#pragma once

#include "physics/broadphase/indexed.hpp"
#include "physics/broadphase/tree_index.hpp"

PHYSICS_HPP_BEGIN

/// Trees of boxes without bounds: for every scene, whatever moves and however sizes differ. Nodes hold eight boxes in
/// float lanes, whatever the scalar. Movable proxies and the others have trees of their own. Boxes that move keep their
/// places; what strays from its neighbours is packed with others that did, and all is packed anew, by halving along
/// the longest side, once a tree has grown by a fifth. Resting proxies cost nothing, and neither the order of insertion
/// nor teleports make a tree worse for long.
/// Cost of a step: 50 to 250 ns for each proxy that left its box, 200 to 400 ns for all where a tree is packed anew.
/// Queries: O(log n + found).
/// Source: Kay, Kajiya, Ray tracing complex scenes (1986); Wald, Benthin, Boulos, Getting rid of packets (2008).
struct dynamic_tree {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::tree_index<Space>>;
};

PHYSICS_HPP_END
