// Scenes in space: cubes of 1 m and 1,000 kg unless said otherwise, on a block whose top is y = 0.
#include "makers.hpp"
#include "parts.hpp"

namespace bench {

namespace {

constexpr double density = 1000;

body cube(double x, double y, double z) {
    shape s = box({0.5, 0.5, 0.5});
    s.density = density;
    return solid({x, y, z}, s);
}
void add_floor(scene& s, double half) {
    s.add(ground({0, -1, 0}, box({half, 1, half})));
    s.lower = {-half, -0.5, -half};
    s.upper = {half, 1000, half};
}
/// Four walls around a square, 1 m thick.
void add_walls(scene& s, double half, double height) {
    const double y = height / 2, at = half + 0.5;
    for (const double way : {-1.0, 1.0}) {
        s.add(ground({way * at, y, 0}, box({0.5, y, half + 1})));
        s.add(ground({0, y, way * at}, box({half + 1, y, 0.5})));
    }
    s.lower = {-half - 0.5, -0.5, -half - 0.5};
    s.upper = {half + 0.5, 1000, half + 0.5};
}

scene square_pyramid(bool quick) {
    const int base = quick ? 10 : 30;
    scene s = named("pyramid3", 3, quick ? 40 : 120);
    add_floor(s, 50);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            for (int j = 0; j < base - row; ++j)
                s.add(cube((i - (base - 1 - row) / 2.0) * 1.1, 0.5 + row, (j - (base - 1 - row) / 2.0) * 1.1));
    s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
    return s;
}

scene wall(bool quick) {
    const int rows = 20, columns = quick ? 10 : 50;
    scene s = named("wall", 3, quick ? 60 : 300);
    add_floor(s, 50);
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < columns; ++i) {
            shape brick = box({0.5, 0.25, 0.25});
            brick.density = density;
            // A quarter of a brick to the side, so that those at the ends do not fall off.
            s.add(solid({1.05 * (i - columns / 2.0) + 0.25 * (row % 2), 0.25 + 0.5 * row, 0}, brick));
            if (row == rows - 1) s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
        }
    return s;
}

scene stacks(bool quick) {
    const int columns = quick ? 10 : 40, rows = quick ? 5 : 25;
    scene s = named("stacks", 3, quick ? 60 : 200);
    add_floor(s, 100);
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            for (int k = 0; k < 10; ++k)
                s.add(cube(3 * (i - columns / 2.0), 0.5 + k, 3 * (j - rows / 2.0)));
            s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
        }
    return s;
}

turn random_turn(dice& d) {
    for (;;) {
        turn q = {d.next(), d.next(), d.next(), d.next()};
        const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (n > 1 || n < 0.1) continue;
        for (double& x : q) x /= n;
        return q;
    }
}

scene rain(bool quick) {
    const int layers = quick ? 6 : 40;
    scene s = named("rain", 3, quick ? 120 : 600);
    add_floor(s, 15);
    add_walls(s, 12, 40);
    shape stone = box({0.4, 0.5, 0.6});
    stone.density = density;
    shape pebble;
    pebble.kind = form::hull;
    pebble.density = density;
    const double golden = (1 + std::sqrt(5.0)) / 2, norm = std::sqrt(1 + golden * golden);
    for (int axis = 0; axis < 3; ++axis)
        for (const double a : {-1.0, 1.0})
            for (const double b : {-golden, golden}) {
                triple p = {};
                p[static_cast<std::size_t>(axis)] = a / norm;
                p[static_cast<std::size_t>(axis + 1) % 3] = b / norm;
                pebble.points.push_back({0.6 * p[0], 0.5 * p[1], 0.7 * p[2]});
            }
    dice d;
    for (int layer = 0; layer < layers; ++layer)
        for (int i = 0; i < 10; ++i)
            for (int j = 0; j < 10; ++j) {
                body b = solid({2.2 * (i - 4.5) + 0.2 * d.next(), 25, 2.2 * (j - 4.5) + 0.2 * d.next()},
                               (i + j) % 2 == 0 ? stone : pebble);
                b.rotation = random_turn(d);
                b.velocity = {0, -10, 0};
                b.born = 12 * layer;
                s.add(b);
            }
    return s;
}

scene spheres(bool quick) {
    scene s = named("spheres", 3, quick ? 100 : 300);
    add_floor(s, 15);
    add_walls(s, 6, 30);
    shape ball;
    ball.kind = form::ball;
    ball.radius = 0.5;
    ball.density = density;
    dice d;
    for (int n = 0; n < (quick ? 500 : 2000); ++n)
        s.add(solid({1.05 * (n % 11 - 5) + 0.02 * d.next(), 0.6 + 1.05 * (n / 121),
                     1.05 * (n / 11 % 11 - 5) + 0.02 * d.next()},
                    ball));
    return s;
}

}  // namespace

const std::vector<maker>& solid_makers() {
    static const std::vector<maker> all = {
        {"pyramid3", 3, "a square pyramid, 30 cubes wide", square_pyramid},
        {"wall", 3, "a brick wall, 50 by 20", wall},
        {"stacks", 3, "1,000 stacks of 10 cubes", stacks},
        {"rain", 3, "boxes and hulls of 12 corners that fall into a bin", rain},
        {"spheres", 3, "spheres in a bin", spheres},
    };
    return all;
}

const std::vector<maker>& makers() {
    static const std::vector<maker> all = [] {
        std::vector<maker> both = flat_makers();
        both.insert(both.end(), solid_makers().begin(), solid_makers().end());
        return both;
    }();
    return all;
}

}  // namespace bench
