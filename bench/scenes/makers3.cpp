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

scene large_pyramid(bool quick) { return square_pyramid(quick ? 10 : 30, quick ? 40 : 120); }

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

scene many_stacks(bool quick) { return quick ? stacks(10, 5, 10, 60) : stacks(40, 25, 10, 200); }

turn random_turn(dice& d) {
    for (;;) {
        turn q = {d.next(), d.next(), d.next(), d.next()};
        const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (n > 1 || n < 0.1) continue;
        for (double& x : q) x /= n;
        return q;
    }
}

/// 12 points of an icosahedron, stretched to these half extents.
shape pebble_of(const triple& half) {
    shape s;
    s.kind = form::hull;
    s.density = density;
    const double golden = (1 + std::sqrt(5.0)) / 2, norm = std::sqrt(1 + golden * golden);
    for (int axis = 0; axis < 3; ++axis)
        for (const double a : {-1.0, 1.0})
            for (const double b : {-golden, golden}) {
                triple p = {};
                p[static_cast<std::size_t>(axis)] = a / norm;
                p[static_cast<std::size_t>(axis + 1) % 3] = b / norm;
                s.points.push_back({half[0] * p[0], half[1] * p[1], half[2] * p[2]});
            }
    return s;
}

scene rain(bool quick) {
    const int layers = quick ? 6 : 40;
    scene s = named("rain", 3, quick ? 120 : 600);
    add_floor(s, 15);
    add_walls(s, 12, 40);
    shape stone = box({0.4, 0.5, 0.6});
    stone.density = density;
    const shape pebble = pebble_of({0.6, 0.5, 0.7});
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
        s.add(solid(
            {1.05 * (n % 11 - 5) + 0.02 * d.next(), 0.6 + 1.05 * (n / 121), 1.05 * (n / 11 % 11 - 5) + 0.02 * d.next()},
            ball));
    return s;
}

/// A bowl about the y axis, 5 m deep where it is 20 m wide: a grid of 100 by 100 squares, cut in two.
shape bowl_of_triangles() {
    constexpr std::uint32_t cells = 100, row = cells + 1;
    shape s;
    s.kind = form::mesh;
    for (std::uint32_t j = 0; j < row; ++j)
        for (std::uint32_t i = 0; i < row; ++i) {
            const double x = 0.2 * i - 10, z = 0.2 * j - 10;
            s.points.push_back({x, 0.05 * (x * x + z * z), z});
        }
    for (std::uint32_t j = 0; j < cells; ++j)
        for (std::uint32_t i = 0; i < cells; ++i) {
            const std::uint32_t at = j * row + i;
            for (const std::uint32_t corner : {at, at + row, at + 1, at + 1, at + row, at + row + 1})
                s.triangles.push_back(corner);
        }
    return s;
}

scene bowl(bool quick) {
    scene s = named("bowl", 3, quick ? 150 : 600);
    s.add(ground({}, bowl_of_triangles()));
    shape block = box({0.3, 0.25, 0.2}), pill, barrel;
    pill.kind = form::capsule;
    pill.half = {0.25, 0, 0};
    pill.radius = 0.2;
    barrel.kind = form::cylinder;
    barrel.half = {0.25, 0, 0};
    barrel.radius = 0.22;
    shape kinds[] = {block, pill, barrel, pebble_of({0.3, 0.25, 0.35})};
    for (shape& kind : kinds) kind.density = density;
    dice d;
    // A layer of 10 by 10 bodies each sixth of a second.
    for (int n = 0; n < (quick ? 1000 : 3000); ++n) {
        const int i = n % 10, j = n / 10 % 10;
        body b = solid({0.95 * (i - 4.5) + 0.02 * d.next(), 14, 0.95 * (j - 4.5) + 0.02 * d.next()},
                       kinds[(i + 2 * j + n / 100) % 4]);
        b.rotation = random_turn(d);
        b.velocity = {0, -8, 0};
        b.born = 10 * (n / 100);
        s.add(b);
    }
    s.lower = {-10, -0.5, -10};
    s.upper = {10, 30, 10};
    return s;
}

}  // namespace

scene square_pyramid(int base, int steps) {
    scene s = named("pyramid3", 3, steps);
    add_floor(s, 50);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            for (int j = 0; j < base - row; ++j)
                s.add(cube((i - (base - 1 - row) / 2.0) * 1.1, 0.5 + row, (j - (base - 1 - row) / 2.0) * 1.1));
    s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
    return s;
}

scene stacks(int columns, int rows, int height, int steps) {
    scene s = named("stacks", 3, steps);
    add_floor(s, 100);
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            for (int k = 0; k < height; ++k) s.add(cube(3 * (i - columns / 2.0), 0.5 + k, 3 * (j - rows / 2.0)));
            s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
        }
    return s;
}

const std::vector<maker>& solid_makers() {
    static const std::vector<maker> all = {
        {"pyramid3", 3, "a square pyramid, 30 cubes wide", large_pyramid},
        {"wall", 3, "a brick wall, 50 by 20", wall},
        {"stacks", 3, "1,000 stacks of 10 cubes", many_stacks},
        {"rain", 3, "boxes and hulls of 12 corners that fall into a bin", rain},
        {"spheres", 3, "spheres in a bin", spheres},
        {"bowl", 3, "boxes, capsules, cylinders and hulls poured into a bowl of 20,000 triangles", bowl},
    };
    return all;
}

const std::vector<maker>& piles() {
    static const std::vector<maker> all = {
        {"pyramid", 2, "100 squares wide", [](bool quick) { return quick ? pyramid(30, 600) : pyramid(100, 10'000); }},
        {"pyramid200", 2, "200 squares wide",
         [](bool quick) {
             scene s = quick ? pyramid(60, 600) : pyramid(200, 3000);
             s.name = "pyramid200";
             return s;
         }},
        {"pyramid3", 3, "a square pyramid, 30 cubes wide",
         [](bool quick) { return quick ? square_pyramid(10, 600) : square_pyramid(30, 2000); }},
        {"stacks", 3, "1,000 stacks of 10 cubes",
         [](bool quick) { return quick ? stacks(10, 5, 10, 600) : stacks(40, 25, 10, 2000); }},
    };
    return all;
}

const std::vector<maker>& makers() {
    static const std::vector<maker> all = [] {
        std::vector<maker> every = flat_makers();
        every.insert(every.end(), solid_makers().begin(), solid_makers().end());
        every.insert(every.end(), joint_makers().begin(), joint_makers().end());
        return every;
    }();
    return all;
}

}  // namespace bench
