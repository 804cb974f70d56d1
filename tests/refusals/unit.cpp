// What a user's unit looks like to the library: prints the probe's masks for the library's code, for this unit's own
// code, and for the library's code within a float_control_scope.
#include "physics/base/math.hpp"
#include "physics/base/pack_rows.hpp"
#include "physics/base/probe.hpp"

#include <cstdio>

PHYSICS_HPP_DEFINE_PROBED_ARITHMETIC(own_code, PHYSICS_HPP_NOINLINE)

int main() {
    const auto library = static_cast<unsigned>(physics::float_environment());
    const auto own = static_cast<unsigned>(physics::float_environment<own_code>());
    const physics::float_control_scope scope;
    std::printf("%u %u %u\n", library, own, static_cast<unsigned>(physics::float_environment()));
}
