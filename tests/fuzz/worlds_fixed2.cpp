// See world_cell.hpp.
#include "world_cell.hpp"

namespace {
struct recipe : fuzz::cell<physics::fixed32, 2, physics::soft_step> {};
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    static const fuzz::report at_end;
    return fuzz::play_input<recipe>(bytes, size);
}
