// A world in several units, compiled in one of them: this one takes a fifth of the time.
// units: two_units/arena.cpp
#include "two_units/arena.hpp"

#include <cinttypes>
#include <cstdio>

int main() {
    arena level{{.gravity = {0, -10}}};
    level.create_shape(level.create_body({.type = physics::body_type::static_body}), arena::box{{20, 0.5f}});
    for (int i = 0; i < 5; ++i)
        level.create_shape(level.create_body({.position = {0, 1.25f + 1.5f * static_cast<float>(i)}}),
                           arena::box{{0.5f, 0.5f}});
    for (int frame = 0; frame < 120; ++frame) level.step(1.0f / 60);
    for (const physics::body_id crate : level.bodies())
        std::printf("%6.3f %6.3f\n", static_cast<double>(level.position(crate).x),
                    static_cast<double>(level.position(crate).y));
    std::printf("state %016" PRIx64 "\n", level.state_hash());
}
