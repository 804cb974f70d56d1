// Prints what joints of the world that is linked in take: bytes of a joint in a copy, bytes a joint that a step works
// with, and CPU time a joint and step (ns); see bench/joints.py.
#include <malloc.h>

#include "../timing.hpp"
#include "world.hpp"

namespace bench {

namespace {

constexpr int pairs = 512, steps = 200;

double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}
struct figures {
    double copy_bytes, step_bytes, ns;
};
figures measure(bool joined) {
    void* const w = make(pairs, joined);
    const double before = held_bytes();
    void* const other = copy(w);
    const double copied = held_bytes();
    step(other);
    const double stepped = held_bytes();
    samples ns;
    for (int i = 0; i < steps; ++i) {
        const stopwatch clock;
        step(other);
        ns.push_back(clock.ns());
    }
    drop(other);
    drop(w);
    return {copied - before, stepped - copied, minimum(ns)};
}

}  // namespace

}  // namespace bench

int main() {
    const bench::figures without = bench::measure(false), with = bench::measure(true);
    std::printf("%.1f,%.1f,%.1f\n", (with.copy_bytes - without.copy_bytes) / bench::pairs,
                (with.step_bytes - without.step_bytes) / bench::pairs, (with.ns - without.ns) / bench::pairs);
}
