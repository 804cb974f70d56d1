// Scenes whose every bit has to be the same in all builds; prints one `NAME HASH` line each (see check.py).
// This file is a user's: outside the determinism region. Its own arithmetic is exact, so that all that can differ
// is the library's.
#include <physics.hpp>

#include <cinttypes>
#include <cstdint>
#include <cstdio>

#include "../../samples/scenes.hpp"

namespace {

/// FNV-1a over 64-bit words, byte by byte from the low end, so that byte order does not matter.
class digest {
public:
    void word(std::uint64_t value) {
        for (int i = 0; i < 64; i += 8) state_ = (state_ ^ ((value >> i) & 0xff)) * 0x100000001b3u;
    }
    template <physics::scalar_type S>
    void add(S x) {
        word(physics::scalar_traits<S>::bits(x));
    }
    template <class S, int D>
    void add(const physics::vec<S, D>& v) {
        for (int i = 0; i < D; ++i) add(v[i]);
    }
    template <class S>
    void add(const physics::rotation<S, 2>& r) {
        add(r.cosine);
        add(r.sine);
    }
    template <class S>
    void add(const physics::rotation<S, 3>& r) {
        add(r.imaginary());
        add(r.w);
    }
    void print(const char* scene, const char* cell) const {
        std::printf("%s-%s %016" PRIx64 "\n", scene, cell, state_);
    }

private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// The elementary functions over an even net of arguments; i / 64 is exact in every scalar.
template <class S>
void functions() {
    digest sum;
    for (int i = -4096; i <= 4096; ++i) {
        const S x = S(i) / S(64);
        sum.add(physics::sin(x));
        sum.add(physics::cos(x));
        sum.add(physics::tan(x));
        sum.add(physics::atan2(x, S(3)));
        sum.add(physics::atan2(S(-5), x));
        sum.add(physics::exp(x / S(8)));
        if (x > S(0)) sum.add(physics::log(x));
        if (x >= S(0)) sum.add(physics::sqrt(x));
        if (physics::abs(x) <= S(1)) sum.add(physics::acos(x));
    }
    sum.print("functions", physics::scalar_traits<S>::name());
}

template <class S>
physics::rotation<S, 2> turned_once(physics::rotation<S, 2> r, const physics::vec<S, 2>& by) {
    return physics::turned(r, by.x);
}
template <class S>
physics::rotation<S, 3> turned_once(physics::rotation<S, 3> r, const physics::vec<S, 3>& by) {
    return physics::turned(r, by);
}

/// A frame that tumbles through space: each turn depends on the last position, so that one wrong bit grows.
template <class S, int D>
void tumble(const char* cell) {
    digest sum;
    const physics::vec<S, D> one = physics::vec<S, D>::filled(S(1));
    physics::transform<S, D> frame;
    physics::vec<S, D> lever = one;
    for (int i = 0; i < 4096; ++i) {
        frame.rotation = turned_once(frame.rotation, lever / (physics::length(lever) + S(1)));
        lever = frame * one - frame.position / S(4);
        frame.position = physics::inverse_transform(frame, lever);
        sum.add(frame.rotation);
        sum.add(frame.position);
        sum.add(physics::dot(lever, frame.position));
        // What the compiler is free to inline here, outside of the region.
        sum.add(frame.rotation * lever);
        sum.add(frame.rotation * frame.rotation);
        sum.add((frame * frame).position);
        sum.add(matrix(frame.rotation) * lever);
        sum.add(physics::velocity_at(physics::twist<S, D>{lever, {}}, frame.position));
    }
    sum.print("tumble", cell);
}

/// Most scenes share the recipe of their scalar and dimension, since worlds take long to compile; some have no joints.
template <class S, int D, class... Policies>
struct joined : physics::recipe<S, D, scenes::joints, Policies...> {};
template <class S, int D, class... Policies>
struct plain : physics::recipe<S, D, Policies...> {};

/// Balls, capsules and boxes fall into a heap on tilted ground; the hash of every 16th state of 4 seconds.
template <class Recipe>
void heap(const char* cell) {
    using S = typename Recipe::scalar;
    constexpr int D = Recipe::dimension;
    using world = physics::world<Recipe>;
    world w;
    typename world::halfspace slope;
    slope.normal.x = S(0.28);
    slope.normal.y = S(0.96);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), slope);
    for (int i = 0; i < 30; ++i) {
        typename world::body_def def;
        def.position.x = S(i % 5) - S(2);
        def.position.y = S(i / 5) + S(i % 3) / S(4) + S(2);
        def.position[D - 1] += S(i % 2) / S(8);
        const auto body = w.create_body(def);
        if (i % 3 == 0) w.create_shape(body, typename world::ball{S(0.5)});
        if (i % 3 == 1) w.create_shape(body, typename world::capsule{S(0.25), S(0.25)});
        if (i % 3 == 2) w.create_shape(body, typename world::box{physics::vec<S, D>::filled(S(0.375))});
    }
    digest sum;
    for (int i = 1; i <= 256; ++i) {
        w.step(S(1.0 / 64));
        if (i % 16 == 0) sum.word(w.state_hash());
    }
    sum.print("heap", cell);
}

/// Balls and boxes on belts that resist rolling: a slope that runs uphill, and a slab that turns upon it. They lie far
/// and wide, so that their contacts fill the widest lanes that a solver may choose.
template <class Recipe>
void belts(const char* cell) {
    using S = typename Recipe::scalar;
    constexpr int D = Recipe::dimension;
    using world = physics::world<Recipe>;
    using motion = physics::surface_motion<S, D>;
    const auto running = [](S speed) {
        if constexpr (std::is_same_v<motion, S>) return motion(speed);
        else return motion{speed, S(0), speed / S(4)};
    };
    world w;
    typename world::halfspace slope;
    slope.normal.x = S(0.28);
    slope.normal.y = S(0.96);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), slope,
                   {.material = {.rolling_resistance = S(1.0 / 32), .surface_velocity = running(S(-2))}});
    for (int i = 0; i < 72; ++i) {
        typename world::body_def def;
        def.position.x = S(i % 24) * S(1.25) - S(15);
        def.position.y = S(i / 24) * S(1.25) + S(6);
        def.position[D - 1] += S(i % 2) / S(8);
        const auto body = w.create_body(def);
        const physics::material<S, D> surface{.rolling_resistance = S(i % 2) / S(64),
                                              .surface_velocity = running(S(i % 3))};
        if (i % 2 == 0) w.create_shape(body, typename world::ball{S(0.5)}, {.material = surface});
        else w.create_shape(body, typename world::box{physics::vec<S, D>::filled(S(0.375))}, {.material = surface});
    }
    digest sum;
    for (int i = 1; i <= 256; ++i) {
        w.step(S(1.0 / 64));
        if (i % 16 == 0) sum.word(w.state_hash());
    }
    sum.print("belts", cell);
}

/// Hulls, cylinders and cones rain on a mesh, some of them thrown at it so fast that they are swept; and what rays and
/// shapes that are cast find there.
template <class S>
void rubble(const char* cell) {
    struct quarry
        : physics::recipe<S, 3, physics::shapes<physics::hull, physics::cylinder, physics::cone, physics::mesh>> {};
    using world = physics::world<quarry>;
    using vec = typename world::vec;
    std::uint32_t seed = 1;
    // From -1 to 1, in steps of 1/64.
    const auto random = [&seed] {
        seed = seed * 1664525u + 1013904223u;
        return S(static_cast<int>(seed >> 25) - 64) / S(64);
    };
    constexpr std::uint32_t side = 9;
    vec ground[side * side];
    std::uint32_t triangles[6 * (side - 1) * (side - 1)], count = 0;
    for (std::uint32_t i = 0; i < side * side; ++i)
        ground[i] = {S(static_cast<int>(i % side) - 4), random() / S(2), S(static_cast<int>(i / side) - 4)};
    for (std::uint32_t z = 0; z + 1 < side; ++z)
        for (std::uint32_t x = 0; x + 1 < side; ++x) {
            const std::uint32_t at = z * side + x;
            for (const std::uint32_t corner : {at, at + side, at + 1, at + 1, at + side, at + side + 1})
                triangles[count++] = corner;
        }
    const auto mesh = physics::mesh_geometry<S, 3>::build(ground, side * side, triangles, count / 3);
    world w;
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), mesh.shape());
    for (int i = 0; i < 24; ++i) {
        typename world::body_def def;
        def.position = {S(i % 4 - 2) + random() / S(4), S(i / 4 + 2), S(i / 2 % 4 - 2) + random() / S(4)};
        if (i % 6 == 5) def.linear_velocity = {random(), S(-64), random()};
        def.angular_velocity = {random(), random(), random()};
        const auto body = w.create_body(def);
        vec points[12];
        for (vec& p : points) p = {random() / S(2), random() / S(2), random() / S(2)};
        if (i % 3 == 0) w.create_shape(body, physics::cylinder<S, 3>{S(0.25), S(0.375)});
        if (i % 3 == 1) w.create_shape(body, physics::cone<S, 3>{S(0.25), S(0.375)});
        if (i % 3 == 2) w.create_shape(body, physics::hull_geometry<S, 3>::build(points, 12).shape());
    }
    digest sum;
    for (int i = 1; i <= 128; ++i) {
        w.step(S(1.0 / 64));
        if (i % 8 == 0) sum.word(w.state_hash());
    }
    for (int i = 0; i < 64; ++i) {
        const vec from{random() * S(4), S(8), random() * S(4)}, along{random() * S(4), S(-12), random() * S(4)};
        const auto ray = w.cast_ray(from, along);
        const auto swept = w.cast_shape(physics::cylinder<S, 3>{S(0.5), S(0.25)}, {from, {}}, along);
        sum.add(ray.fraction);
        sum.add(ray.normal);
        sum.add(swept.fraction);
        sum.add(swept.normal);
    }
    sum.print("rubble", cell);
}

/// A net of rods, ropes and springs that falls over a bar; the hash of every 16th state of 4 seconds.
template <class Recipe>
void net(const char* cell) {
    using S = typename Recipe::scalar;
    constexpr int D = Recipe::dimension;
    using world = physics::world<Recipe>;
    world w;
    typename world::halfspace ground;
    ground.normal.x = S(0);
    ground.normal.y = S(1);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), ground);
    typename world::body_def bar{.type = physics::body_type::static_body};
    bar.position.x = S(1.25);
    bar.position.y = S(1.5);
    w.create_shape(w.create_body(bar), typename world::box{physics::vec<S, D>::filled(S(0.25))});
    physics::body_id all[48];
    for (int i = 0; i < 48; ++i) {
        typename world::body_def def;
        def.position.x = S(i % 8) / S(2);
        def.position.y = S(2.5);
        def.position[D - 1] += S(i / 8) / S(2);
        all[i] = w.create_body(def);
        w.create_shape(all[i], typename world::box{physics::vec<S, D>::filled(S(0.125))});
        typename world::distance_joint joint{.length = S(0.5)};
        joint.anchor_a[0] = S(0.125);
        if (i % 3 == 1) joint.frequency = S(4), joint.damping_ratio = S(0.5), joint.max_length = S(0.75);
        if (i % 3 == 2) joint.min_length = S(0);
        if (i % 8 > 0) w.create_joint(all[i - 1], all[i], joint);
        if (i >= 8) w.create_joint(all[i - 8], all[i], joint, {.collide_connected = i % 2 == 0});
    }
    digest sum;
    for (int i = 1; i <= 256; ++i) {
        w.step(S(1.0 / 64));
        if (i % 16 == 0) sum.word(w.state_hash());
    }
    sum.print("net", cell);
}

/// The scenes of the flagship sample, with ball joints, hinges and ropes; the hash of every 30th state.
template <class S, int D, class Build>
void flagship(const char* scene, const char* cell, Build&& build) {
    digest sum;
    scenes::flagship<physics::world<joined<S, D>>>(build, 600, [&](const auto& world, int step) {
        if (step % 30 == 0) sum.word(world.state_hash());
    });
    sum.print(scene, cell);
}
template <class S>
void flagships(const char* in_plane, const char* in_space) {
    flagship<S, 2>("wrecked", in_plane, [](auto& w) { scenes::wrecked_pyramid(w); });
    flagship<S, 3>("ragdolls", in_space, [](auto& w) { scenes::ragdoll_tower(w); });
}

}  // namespace

int main() {
    functions<float>();
    functions<double>();
    functions<physics::fixed32>();
    functions<physics::fixed16>();
    tumble<float, 2>("float/2D");
    tumble<float, 3>("float/3D");
    tumble<double, 2>("double/2D");
    tumble<double, 3>("double/3D");
    tumble<physics::fixed32, 2>("fixed32/2D");
    tumble<physics::fixed32, 3>("fixed32/3D");
    heap<plain<float, 2>>("float/2D");
#ifndef CONTROL  // Which only has to show that flags can change bits.
    heap<joined<float, 3>>("float/3D");
    heap<joined<double, 2>>("double/2D");
    heap<joined<double, 3>>("double/3D");
    heap<joined<physics::fixed32, 2>>("fixed32/2D");
    heap<joined<physics::fixed32, 3>>("fixed32/3D");
    belts<joined<float, 2>>("float/2D");
    belts<joined<float, 3>>("float/3D");
    belts<plain<double, 3, physics::soft_step_with<physics::point_friction>>>("double/3D");
    belts<joined<physics::fixed32, 3>>("fixed32/3D");
    rubble<float>("float/3D");
    rubble<physics::fixed32>("fixed32/3D");
    net<joined<float, 2>>("float/2D");
    net<joined<float, 3>>("float/3D");
    net<joined<double, 3, physics::sequential_impulse>>("double/3D");
    net<joined<physics::fixed32, 2>>("fixed32/2D");
    net<joined<physics::fixed32, 3>>("fixed32/3D");
    flagships<float>("float/2D", "float/3D");
    flagships<double>("double/2D", "double/3D");
    flagships<physics::fixed32>("fixed32/2D", "fixed32/3D");
#endif
}
