// Laws of the host's arithmetic: whatever it has switched on around a call, rounding, flushing or both, worlds are
// made, changed and asked to the same bits.
#pragma once

#include <cfenv>
#include <string>
#include <vector>

#include "world_cell.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace {
namespace modes_laws {

/// The host's arithmetic while it lives.
class host_mode {
public:
    host_mode(int rounding, [[maybe_unused]] bool flushes) : rounding_(std::fegetround()) {
        std::fesetround(rounding);
#if defined(__SSE2__)
        before_ = _mm_getcsr();
        // To zero: results that are subnormal, and operands.
        if (flushes) _mm_setcsr(before_ | 0x8040u);
#endif
    }
    host_mode(const host_mode&) = delete;
    host_mode& operator=(const host_mode&) = delete;
    ~host_mode() {
#if defined(__SSE2__)
        _mm_setcsr(before_);
#endif
        std::fesetround(rounding_);
    }

private:
    int rounding_;
    unsigned before_ = 0;
};

/// What a world was seen to be: numbers of any kind, as they are.
struct record {
    std::vector<double> numbers;
    std::vector<std::uint64_t> hashes;
    bool operator==(const record&) const = default;
};

/// Does everything that can be done to a world, each call in the host's mode; inputs are made outside of it.
record play(int rounding, bool flushes) {
    record all;
    const auto in_mode = [&](auto&& call) {
        const host_mode mode(rounding, flushes);
        return call();
    };
    const world::settings_type settings{.gravity = at(0.1, -9.7), .contact_margin = S(0.017)};
    auto holder = in_mode([&] { return world(settings); });
    world& w = holder;
    const auto hash = [&] { all.hashes.push_back(in_mode([&] { return w.state_hash(); })); };
    const auto add = [&](const auto& v) {
        if constexpr (requires { v[0]; })
            for (int i = 0; i < cell::dimension; ++i) all.numbers.push_back(number(v[i]));
        else all.numbers.push_back(number(v));
    };
    const auto step = [&](int count) {
        const S dt = cell::real(1.0 / 60);
        for (int i = 0; i < count; ++i) in_mode([&] { w.step(dt); });
        hash();
    };
    const auto body = [&](const world::body_def& def) { return in_mode([&] { return w.create_body(def); }); };
    const auto shape = [&](body_id b, const auto& what, const world::shape_def& def) {
        return in_mode([&] { return w.create_shape(b, what, def); });
    };
    cell::dice dice(7);
    const body_id ground = body({.type = body_type::static_body, .position = along(1, -0.31)});
    vec half = vec::filled(S(12.3));
    half[1] = S(0.3);
    shape(ground, world::box{half}, {});
    std::vector<body_id> bodies;
    std::vector<shape_id> shapes;
    for (int i = 0; i < 14; ++i) {
        const auto turn = random_rotation(dice);
        bodies.push_back(body({.position = at(0.37 * i - 2.3, 0.7 + 0.61 * (i % 5)), .rotation = turn}));
        const world::shape_def def{
            .position = dice.vec<vec>(-0.2, 0.2), .rotation = random_rotation(dice), .density = S(0.7)};
        shapes.push_back(i % 2 ? shape(bodies.back(), world::ball{S(0.23)}, def)
                               : shape(bodies.back(), world::box{vec::filled(S(0.19))}, def));
        if (i % 3 == 0) shape(bodies.back(), world::capsule{S(0.21), S(0.07)}, {.density = S(0.3)});
        hash();
    }
    step(20);
    const vec v = at(0.13, 0.71), p = at(0.33, 0.77);
    const angular turn = skew(1.3);
    const auto pose = random_rotation(dice);
    in_mode([&] { w.apply_impulse_at(bodies[0], v, p); });
    in_mode([&] { w.apply_local_impulse_at(bodies[1], v, p); });
    in_mode([&] { w.apply_force_at(bodies[2], v, p); });
    in_mode([&] { w.apply_local_force_at(bodies[3], v, p); });
    in_mode([&] { w.apply_force_at(bodies[2], p, v); });
    in_mode([&] { w.apply_torque(bodies[4], turn); });
    in_mode([&] { w.apply_torque(bodies[4], turn); });
    in_mode([&] { w.apply_angular_impulse(bodies[5], turn); });
    hash();
    step(2);
    in_mode([&] { w.set_pose(bodies[6], p, pose); });
    in_mode([&] { w.set_type(bodies[7], body_type::kinematic_body); });
    in_mode([&] { w.set_type(bodies[8], body_type::static_body); });
    hash();
    in_mode([&] { w.move_to(bodies[7], p, pose); });
    step(2);
    in_mode([&] { w.set_type(bodies[8], body_type::dynamic_body); });
    in_mode([&] { w.destroy_shape(shapes[9]); });
    in_mode([&] { w.set_rotation_locked(bodies[10], true); });
    in_mode([&] { w.set_rotation_locked(bodies[10], false); });
    const auto mass = w.mass(bodies[11]);
    in_mode([&] { w.set_mass(bodies[11], mass); });
    in_mode([&] { w.reset_mass(bodies[11]); });
    hash();
    step(20);
    const vec origin = at(-6.1, 1.03), displacement = at(11.7, -0.41);
    const world::box probe{vec::filled(S(0.83))};
    const world::transform where{at(0.29, 0.93), pose};
    const auto hit = in_mode([&] { return w.cast_ray(origin, displacement); });
    const auto sweep = in_mode([&] { return w.cast_shape(probe, {origin, pose}, displacement); });
    const auto near = in_mode([&] { return w.closest_shape(p, S(3)); });
    add(hit.fraction), add(hit.point), add(hit.normal);
    add(sweep.fraction), add(sweep.point), add(sweep.normal);
    add(near.distance), add(near.point), add(near.normal);
    in_mode([&] {
        w.each_overlapping(probe, where, {}, [&](shape_id id) { all.hashes.push_back(id.index); });
        w.each_hit_along_ray(origin, displacement, {}, [&](const auto& h) { all.hashes.push_back(h.shape.index); });
    });
    step(200);
    in_mode([&] { w.set_linear_velocity(bodies[0], v); });
    in_mode([&] { w.wake(bodies[1]); });
    in_mode([&] { w.destroy_body(bodies[2]); });
    in_mode([&] { w.set_settings(settings); });
    step(5);
    for (const body_id b : w.bodies()) add(w.position(b)), add(w.linear_velocity(b));
    return all;
}

CELL_CASE("modes: whatever the host's arithmetic does around calls, worlds come to the same bits") {
    const record nearest = play(FE_TONEAREST, false);
    CHECK(nearest.hashes.size() > 30);
#if defined(__SSE2__) || defined(__aarch64__)
    CHECK(play(FE_TONEAREST, true) == nearest);
    CHECK(play(FE_UPWARD, false) == nearest);
    CHECK(play(FE_DOWNWARD, true) == nearest);
    CHECK(play(FE_TOWARDZERO, false) == nearest);
#endif
    CHECK(std::fegetround() == FE_TONEAREST);
}

/// Builds geometry of every kind, each in the host's mode; inputs are made outside of it.
std::vector<std::uint64_t> build_all(int rounding, bool flushes) {
    std::vector<std::uint64_t> digests;
    cell::dice dice(11);
    std::vector<vec> points;
    std::vector<S> heights;
    for (int i = 0; i < 64; ++i) points.push_back(dice.vec<vec>(-2, 2)), heights.push_back(dice.real(-1, 1));
    const auto add = [&](auto&& build) {
        const host_mode mode(rounding, flushes);
        const auto geometry = build();
        digests.push_back(geometry.data()->digest);
    };
    using hull = physics::hull_geometry<S, cell::dimension>;
    using compound = physics::compound_geometry<S, cell::dimension>;
    using heightfield = physics::heightfield_geometry<S, cell::dimension>;
    const auto solid = hull::build(points.data(), 30);
    const typename world::box plank{vec::filled(S(0.37))};
    add([&] { return hull::build(points.data(), 64); });
    add([&] { return hull::build(points.data(), 64, {.max_vertices = 9}); });
    add([&] { return compound::build({{plank, points[0]}, {solid.shape(S(0.11)), points[1]}}); });
#if CELL_DIMENSION == 2
    const std::uint8_t tiles[6] = {1, 0, 1, 1, 1, 0};
    add([&] { return heightfield::build(heights.data(), 64, S(0.13)); });
    add([&] { return physics::chain_geometry<S, cell::dimension>::build(points.data(), 64); });
    add([&] { return physics::tile_grid_geometry<S, cell::dimension>::build(tiles, 3, 2, S(0.13)); });
#else
    const std::uint32_t triangles[] = {0, 1, 2, 2, 1, 3, 3, 1, 4, 5, 6, 7};
    add([&] { return heightfield::build(heights.data(), 8, 8, S(0.13), S(0.17)); });
    add([&] { return physics::mesh_geometry<S, cell::dimension>::build(points.data(), 64, triangles, 4); });
#endif
    return digests;
}

CELL_CASE("modes: whatever the host's arithmetic does around calls, geometry is built to the same bits") {
    const std::vector<std::uint64_t> nearest = build_all(FE_TONEAREST, false);
#if defined(__SSE2__) || defined(__aarch64__)
    CHECK(build_all(FE_UPWARD, false) == nearest);
    CHECK(build_all(FE_DOWNWARD, true) == nearest);
    CHECK(build_all(FE_TOWARDZERO, false) == nearest);
#endif
    CHECK(nearest.size() >= 5);
}

}  // namespace modes_laws
}  // namespace
