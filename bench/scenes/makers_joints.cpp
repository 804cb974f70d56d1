// Scenes with joints: those of Box2D v3 and Box3D, with their sizes and masses. Told otherwise: nothing is damped, no
// joint has a spring, and whatever is not joined collides, as not all engines can leave that out. Ragdolls are of
// eleven bodies whose limbs begin beside each other.
#include "makers.hpp"
#include "parts.hpp"

namespace bench {

namespace {

constexpr double pi = 3.14159265358979323846, heavy = 1000;

shape ball(double radius, double density) {
    shape s;
    s.kind = form::ball;
    s.radius = radius;
    s.density = density;
    return s;
}
shape capsule(double half, double radius, double density) {
    shape s;
    s.kind = form::capsule;
    s.half = {half, 0, 0};
    s.radius = radius;
    s.density = density;
    return s;
}
int add_hook(scene& s, const triple& at) { return s.add(ground(at, box({0.05, 0.05, 0.05}))); }

/// Balls joined to those above and beside them, of which some of the upper row are fixed.
scene grid(const char* name, int dimension, int side, int first_fixed, int last_fixed, int steps) {
    scene s = named(name, dimension, steps);
    const shape node = ball(0.4, dimension == 2 ? 1 : heavy);
    for (int k = 0; k < side; ++k)
        for (int i = 0; i < side; ++i) {
            body b = solid({1.0 * k, -1.0 * i, 0}, node);
            if (i == 0 && k >= first_fixed && k <= last_fixed) b.kind = role::fixed;
            const int me = s.add(b);
            if (i > 0) s.pin(me - 1, me, {1.0 * k, 0.5 - i, 0});
            // Two that are fixed need none.
            if (k > 0 && !(b.kind == role::fixed && k > first_fixed)) s.pin(me - side, me, {k - 0.5, -1.0 * i, 0});
        }
    return s;
}
scene joint_grid(bool quick) {
    return quick ? grid("joint_grid", 2, 30, 14, 16, 60) : grid("joint_grid", 2, 100, 47, 53, 500);
}
scene joint_grid3(bool quick) {
    return quick ? grid("joint_grid3", 3, 30, 0, 29, 60) : grid("joint_grid3", 3, 100, 0, 99, 100);
}

/// A level net of balls whose edges are fixed.
scene chain_mail(bool quick) {
    const int side = quick ? 20 : 60;
    scene s = named("chain_mail", 3, quick ? 60 : 300);
    const shape node = ball(0.4, heavy);
    const auto is_fixed = [=](int i) { return i == 0 || i + 1 == side; };
    for (int k = 0; k < side; ++k)
        for (int i = 0; i < side; ++i) {
            body b = solid({1.0 * k, 0, 1.0 * i}, node);
            const bool fixed = is_fixed(i) || is_fixed(k);
            if (fixed) b.kind = role::fixed;
            const int me = s.add(b);
            // Two that are fixed need none.
            if (i > 0 && !(fixed && (is_fixed(i - 1) || is_fixed(k)))) s.pin(me - 1, me, {1.0 * k, 0, i - 0.5});
            if (k > 0 && !(fixed && (is_fixed(k - 1) || is_fixed(i)))) s.pin(me - side, me, {k - 0.5, 0, 1.0 * i});
        }
    return s;
}

scene bridge(bool quick) {
    const int planks = quick ? 40 : 160;
    scene s = named("bridge", 2, quick ? 120 : 600);
    const auto hinge = [&](int a, int b, double x) { s.pin(a, b, {x, 20, 0}).friction = 200; };
    int last = add_hook(s, {-planks / 2.0, 20, 0});
    for (int i = 0; i < planks; ++i) {
        shape plank = box({0.5, 0.125, 1});
        plank.density = 20;
        const int next = s.add(solid({i - planks / 2.0 + 0.5, 20, 0}, plank));
        hinge(last, next, i - planks / 2.0);
        last = next;
    }
    hinge(last, add_hook(s, {planks / 2.0, 20, 0}), planks / 2.0);
    shape wedge;
    wedge.kind = form::hull;
    wedge.points = {{-0.5, 0, 0}, {0.5, 0, 0}, {0, 1.5, 0}};
    wedge.density = 20;
    for (const double x : {-8.0, 0.0}) s.add(solid({x, 22, 0}, wedge));
    for (const double x : {-6.0, 0.0, 6.0}) s.add(solid({x, 25, 0}, ball(0.5, 20)));
    return s;
}
/// Planks with a ball joint at each end of their edges.
scene bridge3(bool quick) {
    const int planks = quick ? 40 : 150;
    scene s = named("bridge3", 3, quick ? 120 : 600);
    const auto hinges = [&](int a, int b, int i) {
        for (const double z : {-0.5, 0.5}) s.pin(a, b, {0.25 * (i - planks / 2.0) - 0.125, 0, z});
    };
    int last = add_hook(s, {-0.125 * planks - 0.125, 0, 0});
    for (int i = 0; i < planks; ++i) {
        shape plank = box({0.125, 0.125, 0.5});
        plank.density = 20;
        const int next = s.add(solid({0.25 * (i - planks / 2.0), 0, 0}, plank));
        hinges(last, next, i);
        last = next;
    }
    hinges(last, add_hook(s, {0.125 * planks - 0.125, 0, 0}), planks);
    return s;
}

/// Capsules of 1 m in a row from a hook at the origin, and a ball.
scene chain(const char* name, int dimension, int links, double density, double radius, double friction, int steps) {
    scene s = named(name, dimension, steps);
    int last = add_hook(s, {});
    for (int i = 0; i <= links; ++i) {
        const bool is_ball = i == links;
        const int next = s.add(is_ball ? solid({links + radius, 0, 0}, ball(radius, density))
                                       : solid({i + 0.5, 0, 0}, capsule(0.5, 0.125, density)));
        s.pin(last, next, {1.0 * i, 0, 0}).friction = friction;
        last = next;
    }
    return s;
}
scene ball_and_chain(bool quick) { return chain("ball_and_chain", 2, 30, 20, 4, 100, quick ? 200 : 600); }
scene ball_and_chain3(bool quick) { return chain("ball_and_chain3", 3, 32, heavy, 2, 0, quick ? 200 : 600); }

scene cantilever(bool quick) {
    scene s = named("cantilever", 2, quick ? 120 : 600);
    int last = add_hook(s, {});
    for (int i = 0; i < 8; ++i) {
        const int next = s.add(solid({i + 0.5, 0, 0}, capsule(0.5, 0.125, 20)));
        s.pin(last, next, {1.0 * i, 0, 0}).rigid = true;
        last = next;
    }
    s.tops = {last};
    return s;
}

/// A person whose feet are there; in the plane hinges have limits and friction.
void add_ragdoll(scene& s, const triple& at, double density, const triple& velocity = {}, int born = 0) {
    const bool flat = s.dimension == 2;
    const auto part = [&](const triple& center, shape form) {
        form.density = density;
        body b = solid(at + center, form);
        b.rotation = turned(pi / 2);
        b.velocity = velocity;
        b.born = born;
        return s.add(b);
    };
    const auto pin = [&](int a, int b, double x, double y, double lower, double upper) {
        joint& j = s.pin(a, b, at + triple{x, y, 0});
        if (!flat) return;
        j.lower = lower, j.upper = upper;
        j.friction = 0.05 * density;
    };
    const int pelvis = part({0, 0.96, 0}, box({0.08, 0.16, 0.09})), trunk = part({0, 1.27, 0}, box({0.2, 0.18, 0.1}));
    pin(pelvis, trunk, 0, 1.05, -0.4, 0.4);
    pin(trunk, part({0, 1.62, 0}, ball(0.12, 1)), 0, 1.5, -0.4, 0.4);
    for (const double side : {-1.0, 1.0}) {
        const auto limb = [&](int body, double x, double top, double middle, double bottom, double thick, double out) {
            const auto bone = [&](double from, double to, double radius) {
                return part({x * side, (from + to) / 2, 0}, capsule((from - to) / 2 - radius, radius, 1));
            };
            const int upper = bone(top, middle, thick), lower = bone(middle, bottom, 0.9 * thick);
            // Outwards it is counter-clockwise to the right.
            pin(body, upper, x * side, top, side > 0 ? -0.1 : -out, side > 0 ? out : 0.1);
            pin(upper, lower, x * side, middle, -0.5, 0.5);
        };
        limb(pelvis, 0.1, 0.92, 0.47, 0, 0.08, 0.8);
        limb(trunk, 0.26, 1.44, 1.12, 0.8, 0.05, 2.5);
    }
}

scene rain_of_ragdolls(bool quick) {
    scene s = named("rain_of_ragdolls", 2, quick ? 200 : 600);
    s.add(ground({0, -1, 0}, box({25, 1, 1})));
    for (const double way : {-1.0, 1.0}) s.add(ground({24 * way, 20, 0}, box({1, 20, 1})));
    for (int i = 0; i < (quick ? 60 : 400); ++i)
        add_ragdoll(s, {4.5 * (i % 10) - 21.5 + 1.5 * (i / 10 % 3), 25, 0}, 1, {0, -10, 0}, 8 * (i / 10));
    s.lower = {-25, -0.5, -1};
    s.upper = {25, 1000, 1};
    return s;
}
scene rain_of_ragdolls3(bool quick) {
    scene s = named("rain_of_ragdolls3", 3, quick ? 150 : 500);
    s.add(ground({0, -1, 0}, box({8, 1, 8})));
    for (const double side : {-1.0, 1.0}) {
        s.add(ground({9 * side, 10, 0}, box({1, 10, 8})));
        s.add(ground({0, 10, 9 * side}, box({8, 10, 1})));
    }
    for (int i = 0; i < (quick ? 25 : 125); ++i)
        add_ragdoll(s, {3.0 * (i % 5) - 6, 12, 3.0 * (i / 5 % 5) - 6 + 0.5 * (i / 25 % 2)}, heavy, {0, -10, 0},
                    60 * (i / 25));
    s.lower = {-8, -0.5, -8};
    s.upper = {8, 1000, 8};
    return s;
}
scene ragdoll_pile(bool quick) {
    scene s = named("ragdoll_pile", 3, quick ? 120 : 600);
    s.add(ground({0, -1, 0}, box({20, 1, 20})));
    dice d;
    for (int i = 0; i < (quick ? 10 : 20); ++i)
        add_ragdoll(s, {2 * d.next(), 2 + 2.0 * (i / 4), 1.0 * (i % 4) - 1.5 + 0.2 * d.next()}, heavy);
    s.lower = {-20, -0.5, -20};
    s.upper = {20, 1000, 20};
    return s;
}

/// A field of short chains, whose last links are kicked.
scene chains(bool quick) {
    const int side = quick ? 8 : 25;
    scene s = named("chains", 3, quick ? 100 : 400);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const double x = 2.0 * (i - side / 2), z = 2.0 * (j - side / 2);
            int last = add_hook(s, {x, 3.5, z});
            for (int k = 0; k < 4; ++k) {
                body link = solid({x, 3.25 - 0.5 * k, z}, capsule(0.25, 0.125, heavy));
                link.rotation = turned(pi / 2);
                if (k == 3) link.velocity = {5, 0, 0};
                const int next = s.add(link);
                s.pin(last, next, {x, 3.5 - 0.5 * k, z});
                last = next;
            }
        }
    return s;
}

}  // namespace

const std::vector<maker>& joint_makers() {
    static const std::vector<maker> all = {
        {"joint_grid", 2, "100 by 100 circles with revolute joints, hung by seven of them", joint_grid},
        {"bridge", 2, "160 planks with friction in their joints, and what falls on them", bridge},
        {"ball_and_chain", 2, "30 capsules and a ball of 168 times the mass of one", ball_and_chain},
        {"cantilever", 2, "8 capsules welded to each other and to a wall", cantilever},
        {"rain_of_ragdolls", 2, "400 ragdolls that rain into a bin", rain_of_ragdolls},
        {"joint_grid3", 3, "100 by 100 balls with ball joints, hung by a row", joint_grid3},
        {"ball_and_chain3", 3, "32 capsules and a ball of 585 times the mass of one", ball_and_chain3},
        {"bridge3", 3, "150 planks with two ball joints to each neighbour", bridge3},
        {"chain_mail", 3, "60 by 60 balls with ball joints, laid level, whose edges are fixed", chain_mail},
        {"rain_of_ragdolls3", 3, "125 ragdolls with bare ball joints that rain into a bin", rain_of_ragdolls3},
        {"ragdoll_pile", 3, "20 ragdolls with bare ball joints that fall on a heap", ragdoll_pile},
        {"chains", 3, "625 chains of four capsules, kicked", chains},
    };
    return all;
}

}  // namespace bench
