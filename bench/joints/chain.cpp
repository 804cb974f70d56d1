// Prints a line of CSV for each way to solve and number of substeps: the largest gap of a chain of 40 capsules that
// swings a ball of 672 times the mass of one, and the CPU time of a step; see bench/joints.py.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "../timing.hpp"

namespace {

template <class S, int D>
struct chains
    : physics::recipe<S, D, physics::shapes<physics::ball, physics::capsule>, physics::joints<physics::ball_joint>> {};

template <class S, int D>
class chain {
    using world = physics::world<chains<S, D>>;
    using vec = typename world::vec;
    using joint = physics::ball_joint<S, D>;

public:
    chain(int substeps, bool direct) {
        auto settings = w_.settings();
        settings.gravity[1] = S(-10);
        settings.solver.substeps = substeps;
        if (!direct) settings.solver.max_direct_cost = 0;
        w_.set_settings(settings);
        physics::body_id last = w_.create_body({.type = physics::body_type::static_body});
        for (int i = 0; i < length; ++i) {
            const physics::body_id b = add(at(i + 0.5));
            w_.create_shape(b, typename world::capsule{S(0.5), S(0.125)});
            joints_.push_back({last, b, i == 0 ? at(0) : at(0.5), at(-0.5)});
            last = b;
        }
        const physics::body_id ball = add(at(length + radius));
        const double mass = 672 * static_cast<double>(w_.mass(last).mass), r = radius;
        w_.create_shape(ball, typename world::ball{S(r)},
                        {.density = S(mass / (D == 2 ? 3.14159265 * r * r : 4.18879020 * r * r * r))});
        joints_.push_back({last, ball, at(0.5), at(-radius)});
        for (const ends& j : joints_) w_.create_joint(j.a, j.b, joint{j.on_a, j.on_b});
    }
    void step() { w_.step(S(1.0 / 60)); }
    [[nodiscard]] double gap() const {
        double worst = 0;
        for (const ends& j : joints_) {
            const vec apart = w_.pose(j.b) * j.on_b - w_.pose(j.a) * j.on_a;
            double sum = 0;
            for (int i = 0; i < D; ++i) sum += static_cast<double>(apart[i]) * static_cast<double>(apart[i]);
            worst = std::max(worst, std::sqrt(sum));
        }
        return worst;
    }

private:
    static constexpr int length = 40;
    static constexpr double radius = 8;
    struct ends {
        physics::body_id a, b;
        vec on_a, on_b;
    };
    static vec at(double x) {
        vec v;
        v[0] = S(x);
        return v;
    }
    physics::body_id add(const vec& where) {
        return w_.create_body({.position = where, .linear_damping = S(0.1), .angular_damping = S(0.1)});
    }

    world w_;
    std::vector<ends> joints_;
};

template <class S, int D>
void measure(const char* scalar, int steps) {
    for (const bool direct : {true, false})
        for (const int substeps : {1, 2, 4, 8, 16, 32, 64}) {
            chain<S, D> c(substeps, direct);
            double worst = 0, ns = 0;
            for (int i = 0; i < steps; ++i) {
                const bench::stopwatch clock;
                c.step();
                ns += clock.ns();
                worst = std::max(worst, c.gap());
            }
            std::printf("%d,%s,%s,%d,%.3g,%.0f\n", D, scalar, direct ? "direct" : "iterations", substeps, worst,
                        ns / steps);
        }
}

}  // namespace

int main(int count, char** arguments) {
    const int steps = count > 1 ? std::atoi(arguments[1]) : 1200;
    std::puts("dimension,scalar,solved,substeps,gap,ns");
    measure<float, 2>("float", steps);
    measure<float, 3>("float", steps);
}
