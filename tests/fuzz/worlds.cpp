// Fuzzes whole worlds: calls in any order, good and bad, with what must hold after each of them.
//
// For a long hunt: FUZZ_SECONDS=3600 bash tests/run fuzz, or by hand
//     clang++ -std=c++20 -O1 -g1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined -Iinclude
//         tests/fuzz/worlds.cpp -o worlds
//     ./worlds -max_len=400 -timeout=20 -artifact_prefix=found_ corpus tests/fuzz/corpus/worlds
// An input that it found plays again by ./worlds found_crash-...
#define PHYSICS_HPP_THREADS

#include "world_changes.hpp"

namespace {

struct flat : physics::recipe<float, 2, fuzz::all_shapes, fuzz::all_events,
                              physics::joints<physics::distance_joint, physics::revolute_joint>> {
    template <class S, int D>
    using kinds = fuzz::few_joints<S, D>;
};
/// The same, by another broadphase.
struct sorted : physics::recipe<float, 2, fuzz::all_shapes, fuzz::all_events, physics::sweep_and_prune,
                                physics::joints<physics::distance_joint, physics::revolute_joint>> {
    template <class S, int D>
    using kinds = fuzz::few_joints<S, D>;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz::input in(bytes, size);
    if (in.below(2)) fuzz::play<flat>(in);
    else FUZZ_REQUIRE(fuzz::play<flat>(in) == fuzz::play<sorted>(in));
    return 0;
}
