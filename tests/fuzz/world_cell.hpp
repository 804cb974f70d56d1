// A fuzzer of whole worlds of one scalar and dimension: calls in any order, good and bad, with what must hold after
// each.
//
// For a long hunt: FUZZ_SECONDS=3600 bash tests/run fuzz, or by hand
//     clang++ -std=c++20 -O1 -g1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined -Iinclude
//         tests/fuzz/worlds_float2.cpp -o worlds_float2
//     ./worlds_float2 -max_len=400 -timeout=60 -runs=RUNS -artifact_prefix=found_ corpus tests/fuzz/corpus/worlds
// where an empty folder `corpus` takes new inputs. It says at the end how many calls of a world that were; RUNS = 10000
// is a million. An input that it found plays again by ./worlds_float2 found_crash-...
#pragma once

#define PHYSICS_HPP_THREADS

#include "world_broadphases.hpp"
#include "world_changes.hpp"

namespace fuzz {

using all_events = physics::events<physics::event::contact, physics::event::hit, physics::event::sensor,
                                   physics::event::sleep, physics::event::move, physics::event::joint_limit>;
using plane_shapes = physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                                     physics::segment, physics::triangle, physics::rounded_box, physics::compound,
                                     physics::chain, physics::heightfield, physics::tile_grid>;
using space_shapes = physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                                     physics::segment, physics::triangle, physics::rounded_box, physics::cylinder,
                                     physics::cone, physics::compound, physics::mesh, physics::heightfield>;
using plane_joints =
    physics::joints<physics::ball_joint, physics::distance_joint, physics::filter_joint, physics::gear_joint,
                    physics::motor_joint, physics::prismatic_joint, physics::pulley_joint, physics::rack_joint,
                    physics::revolute_joint, physics::six_degrees_joint, physics::target_joint, physics::weld_joint,
                    physics::wheel_joint>;
using space_joints =
    physics::joints<physics::ball_joint, physics::cone_joint, physics::distance_joint, physics::filter_joint,
                    physics::gear_joint, physics::motor_joint, physics::prismatic_joint, physics::pulley_joint,
                    physics::rack_joint, physics::revolute_joint, physics::six_degrees_joint,
                    physics::swing_twist_joint, physics::target_joint, physics::weld_joint, physics::wheel_joint>;

template <class S, int D, class Solver>
using cell =
    physics::recipe<S, D, all_events, Solver, any_broadphase, std::conditional_t<D == 2, plane_shapes, space_shapes>,
                    std::conditional_t<D == 2, plane_joints, space_joints>>;

/// Plays an input by one of the broadphases, or by two of them, which must come to the same.
template <class Recipe>
int play_input(const std::uint8_t* bytes, std::size_t size) {
    input in(bytes, size);
    const int first = in.below(broadphase_kinds), second = in.below(2 * broadphase_kinds);
    next_broadphase = static_cast<broadphase_kind>(first);
    const auto trace = play<Recipe>(in);
    if (second >= broadphase_kinds || second == first) return 0;
    next_broadphase = static_cast<broadphase_kind>(second);
    FUZZ_REQUIRE(play<Recipe>(in) == trace);
    return 0;
}
/// Says at the end how much has been done.
struct report {
    ~report() { std::fprintf(stderr, "stat::operations: %lu\n", operations); }
};

}  // namespace fuzz
