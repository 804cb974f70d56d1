// Scenes in the plane: those of Box2D v3's benchmark, with its sizes, materials, orders and numbers of steps. Two
// things are told otherwise: drums and paddles turn by themselves where joints with motors turn them, and what is hit
// in smash does not begin asleep.
#include "makers.hpp"
#include "parts.hpp"

namespace bench {

namespace {

constexpr double pi = 3.14159265358979323846;

/// A pyramid of squares of 1 m whose lowest row stands on y and begins at x.
void add_pyramid(scene& s, int base, double x, double y) {
    for (int row = 0; row < base; ++row)
        for (int i = row; i < base; ++i)
            s.add(solid({x + 0.5 * (row + 1) + (i - row), y + 0.5 + row, 0}, box({0.5, 0.5, 0.5})));
    s.tops.push_back(static_cast<int>(s.bodies.size()) - 1);
}

scene large_pyramid(bool quick) { return pyramid(quick ? 30 : 100, quick ? 60 : 500); }

scene small_pyramids(bool quick) { return quick ? many_pyramids(4, 5, 40) : many_pyramids(20, 20, 200); }

scene tumbler(bool quick) {
    const int side = quick ? 20 : 45;
    scene s = named("tumbler", 2, quick ? 200 : 750);
    body drum;
    drum.kind = role::driven;
    drum.at = {0, 10, 0};
    drum.spin = {0, 0, 25 * pi / 180};
    for (const double way : {-1.0, 1.0}) {
        drum.shapes.push_back(placed(box({0.5, 10, 1}), {10 * way, 0, 0}));
        drum.shapes.push_back(placed(box({10, 0.5, 1}), {0, 10 * way, 0}));
    }
    s.add(drum);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) s.add(solid({-9 + 0.4 * j, 1 + 0.4 * i, 0}, box({0.125, 0.125, 1})));
    s.lower = {-15, -5, -1};
    s.upper = {15, 25, 1};
    return s;
}

/// A quad between two radii and two angles.
shape sector(double inner, double outer, double from, double to) {
    shape quad;
    quad.kind = form::hull;
    quad.points = {{inner * std::cos(from), inner * std::sin(from), 0},
                   {outer * std::cos(from), outer * std::sin(from), 0},
                   {outer * std::cos(to), outer * std::sin(to), 0},
                   {inner * std::cos(to), inner * std::sin(to), 0}};
    return quad;
}

scene washer(bool quick) {
    const int side = quick ? 30 : 90;
    scene s = named("washer", 2, quick ? 150 : 500);
    body drum;
    drum.kind = role::driven;
    drum.at = {0, 10, 0};
    drum.spin = {0, 0, 25 * pi / 180};
    drum.velocity = {0.001, -0.002, 0};
    const double degree = pi / 180;
    for (int i = 0; i < 36; ++i) {
        // Those of the ring reach a degree into their neighbours, ribs do not.
        drum.shapes.push_back(sector(16, 18, (10 * i - 1) * degree, (10 * i + 11) * degree));
        if (i % 9 == 0) drum.shapes.push_back(sector(14, 16, 10 * i * degree, 10 * (i + 1) * degree));
    }
    s.add(drum);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) s.add(solid({-9.9 + 0.21 * j, 0.1 + 0.21 * i, 0}, box({0.1, 0.1, 1})));
    s.lower = {-19, -9, -1};
    s.upper = {19, 29, 1};
    return s;
}

scene spinner(bool quick) {
    scene s = named("spinner", 2, quick ? 60 : 500);
    const int count = quick ? 1500 : 6076, sides = 360;
    shape ring;
    ring.kind = form::chain;
    ring.friction = 0.1;
    // Clockwise, so that its front is inside.
    for (int i = 0; i < sides; ++i)
        ring.points.push_back({40 * std::cos(2 * pi * i / sides), 32 - 40 * std::sin(2 * pi * i / sides), 0});
    s.add(ground({}, ring));
    body paddle;
    paddle.kind = role::driven;
    paddle.at = {0, 12, 0};
    paddle.spin = {0, 0, 5};
    shape blade = box({0.4, 20, 1});
    blade.radius = 0.2;
    blade.friction = 0;
    paddle.shapes.push_back(blade);
    s.add(paddle);
    double x = -23, y = 2;
    for (int i = 0; i < count; ++i) {
        shape piece = box({0.35, 0.35, 1});
        if (i % 3 == 0) {
            piece.kind = form::capsule;
            piece.half = {0.25, 0, 0};
            piece.radius = 0.25;
        } else if (i % 3 == 1) {
            piece.kind = form::ball;
            piece.radius = 0.35;
        }
        piece.density = 0.25;
        piece.friction = 0.1;
        piece.restitution = 0.1;
        s.add(solid({x, y, 0}, piece));
        x += 0.5;
        if (x >= 23) {
            x = -23;
            y += 0.5;
        }
    }
    s.lower = {-41, -9, -1};
    s.upper = {41, 73, 1};
    return s;
}

scene smash(bool quick) {
    scene s = named("smash", 2, quick ? 100 : 300);
    s.gravity = {};
    shape ram = box({4, 4, 1});
    ram.density = 8;
    body b = solid({-20, 0, 0}, ram);
    b.velocity = {40, 0, 0};
    s.add(b);
    const int columns = quick ? 40 : 120, rows = quick ? 40 : 80;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) s.add(solid({0.4 * i + 30, 0.4 * (j - rows / 2), 0}, box({0.2, 0.2, 1})));
    return s;
}

/// One body of boxes: a floor from x = -half to half, and walls at its ends.
body bin(int half, int height) {
    body b;
    b.kind = role::fixed;
    for (int i = -half; i <= half; ++i) b.shapes.push_back(placed(box({0.55, 0.5, 1}), {1.0 * i, 0, 0}));
    for (const double x : {-1.0 * half, 1.0 * half})
        for (int i = 1; i <= height; ++i) b.shapes.push_back(placed(box({0.5, 0.55, 1}), {x, 1.0 * i, 0}));
    return b;
}

scene compounds(bool quick) {
    scene s = named("compounds", 2, quick ? 100 : 500);
    const int rows = quick ? 40 : 150;
    body base = bin(40, 100);
    base.shapes.push_back(placed(segment(800), {0, -80, 0}));
    s.add(base);
    double side = 0.25;
    // Column by column: neighbours above each other are half a metre to the side of each other.
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < rows; ++j) {
            body b = solid({2.0 * i - 19 + side, 2.25 * j + 5.575, 0}, {});
            b.shapes.clear();
            for (const auto& points : {std::vector<triple>{{-1, 0, 0}, {0.5, 1, 0}, {0, 2, 0}},
                                       std::vector<triple>{{1, 0, 0}, {0, 2, 0}, {-0.5, 1, 0}}}) {
                shape half;
                half.kind = form::hull;
                half.points = points;
                half.friction = 0.5;
                b.shapes.push_back(half);
            }
            s.add(b);
            side = -side;
        }
    s.lower = {-41, -0.5, -1};
    s.upper = {41, 1000, 1};
    return s;
}

scene junkyard(bool quick) {
    scene s = named("junkyard", 2, quick ? 100 : 800);
    s.add(bin(80, 50));
    shape pentagon;
    pentagon.kind = form::hull;
    // Five points at multiples of the golden angle, put in order.
    for (const int k : {0, 3, 1, 4, 2}) {
        const double angle = k * pi * (std::sqrt(5.0) - 1);
        pentagon.points.push_back({0.25 * std::cos(angle), 0.25 * std::sin(angle), 0});
    }
    make_counter_clockwise(pentagon.points);
    double side = -0.1;
    for (int i = 0; i < 200; ++i)
        for (int j = 0; j < (quick ? 8 : 40); ++j) {
            s.add(solid({0.375 * (2.0 * i - 200) + side, 15.0 + j, 0}, pentagon));
            side = -side;
        }
    body pusher;
    pusher.kind = role::driven;
    pusher.shapes.push_back(placed(box({2, 4, 1}), {0, 4, 0}));
    s.swings.push_back({s.add(pusher), 60, 0.2});
    s.lower = {-81, -0.5, -1};
    s.upper = {81, 1000, 1};
    return s;
}

}  // namespace

scene pyramid(int base, int steps) {
    scene s = named("pyramid", 2, steps);
    s.add(ground({0, -1, 0}, box({std::max(100.0, 1.0 * base), 1, 1})));
    add_pyramid(s, base, -base / 2.0, 0);
    s.lower = {-1.0 * base, -0.5, -1};
    return s;
}

scene many_pyramids(int rows, int columns, int steps) {
    scene s = named("many_pyramids", 2, steps);
    body floors;
    floors.kind = role::fixed;
    for (int r = 0; r < rows; ++r) floors.shapes.push_back(placed(segment(5.5 * columns), {0, 11.0 * r, 0}));
    s.add(floors);
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) add_pyramid(s, 10, 11.0 * c - 5.5 * columns + 0.5, 11.0 * r);
    s.lower = {-1e5, -0.5, -1};
    s.upper = {1e5, 1e5, 1};
    return s;
}

const std::vector<maker>& flat_makers() {
    static const std::vector<maker> all = {
        {"pyramid", 2, "one pyramid, 100 squares wide", large_pyramid},
        {"many_pyramids", 2, "400 pyramids, 10 squares wide", small_pyramids},
        {"tumbler", 2, "squares in a turning drum", tumbler},
        {"washer", 2, "small squares in a round drum with ribs", washer},
        {"spinner", 2, "capsules, circles and squares in a ring, and a paddle as fast as 100 m/s", spinner},
        {"smash", 2, "a block that flies into 9,600 squares, no gravity", smash},
        {"compounds", 2, "bodies of two triangles that rain into a bin", compounds},
        {"junkyard", 2, "pentagons and a sweeping pusher", junkyard},
    };
    return all;
}

}  // namespace bench
