// A pyramid of boxes at rest, as one build plays it: for each round the least CPU time of a step (ms), and the state's
// hash in the end.  pyramid ROWS ROUNDS STEPS
#include <physics.hpp>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <ctime>

struct boxes : physics::recipe<SCALAR, DIMENSION, physics::shapes<physics::box, physics::halfspace>> {};
using world = physics::world<boxes>;
using S = world::scalar;

static double cpu_ms() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

int main(int, char** argument) {
    const int rows = std::atoi(argument[1]), rounds = std::atoi(argument[2]), steps = std::atoi(argument[3]);
    world::settings_type settings;
    settings.gravity = {};
    settings.gravity.y = S(-10);
    settings.sleeping.enabled = false;
    world w(settings);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), world::halfspace{});
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < rows - i; ++j)
            for (int k = 0; k < (DIMENSION == 3 ? rows - i : 1); ++k) {
                world::body_def def;
                const double middle = 0.5 * (rows - 1 - i);
                def.position[0] = S(1.1 * (j - middle));
                def.position[1] = S(0.5 + i);
                if (DIMENSION == 3) def.position[DIMENSION - 1] = S(1.1 * (k - middle));
                w.create_shape(w.create_body(def), world::box{world::vec::filled(S(0.5))});
            }
    for (int round = 0; round < rounds; ++round) {
        double least = 1e300;
        for (int i = 0; i < steps; ++i) {
            const double start = cpu_ms();
            w.step(S(1.0 / 60));
            const double took = cpu_ms() - start;
            if (took < least) least = took;
        }
        std::printf("%.6f\n", least);
    }
    std::printf("%016" PRIx64 "\n", w.state_hash());
}
