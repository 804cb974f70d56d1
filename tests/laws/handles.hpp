// Laws of ids: keys of maps, that name nothing of another.
#pragma once

#include <algorithm>
#include <map>
#include <unordered_map>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace handles_laws {

CELL_CASE("handles: ids are keys of maps, and those of a slot that is used again are others") {
    world w;
    std::vector<body_id> bodies;
    std::map<body_id, int> ordered;
    std::unordered_map<body_id, int> hashed;
    std::unordered_map<shape_id, int> of_shapes;
    for (int i = 0; i < 500; ++i) {
        const body_id id = add_ball(w, at(2 * i, 0));
        bodies.push_back(id);
        ordered[id] = hashed[id] = i;
        of_shapes[*w.shapes(id).begin()] = i;
    }
    CHECK(ordered.size() + hashed.size() + of_shapes.size() == 1500);
    const body_id gone = bodies[7];
    w.destroy_body(gone);
    const body_id next = w.create_body();
    REQUIRE(next.index == gone.index);
    CHECK(ordered.count(next) + hashed.count(next) == 0);
    CHECK(ordered.at(gone) == 7);
    CHECK(hashed.at(gone) == 7);
    // Of a copy they are the same, of another world they are not.
    const world copy = w;
    world other;
    CHECK(copy.contains(bodies[8]));
    CHECK(hashed.count(add_ball(other, {})) == 0);
    std::size_t fullest = 0;
    for (std::size_t i = 0; i < hashed.bucket_count(); ++i) fullest = std::max(fullest, hashed.bucket_size(i));
    CHECK(fullest <= 8);
}

}  // namespace handles_laws
}  // namespace
