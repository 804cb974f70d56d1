// Changes of a body, of a shape and of all bodies, in any order; and a character among them.
#pragma once

#include "world_calls.hpp"

namespace fuzz {

template <class Recipe>
void session<Recipe>::change_body() {
    const body_id b = any_body();
    const bool is = lives(b);
    const int what = v.below(26);
    const vec x = v.vector(what < 3 ? 4 : 8), at = v.vector(2);
    const auto to = [&](auto&& f) { return apply_to(is, f); };
    switch (what) {
        case 0:
        case 1: {
            const auto turn = v.turn();
            to([&](world& on) { on.set_pose(b, x, turn); });
            break;
        }
        case 2: {
            const auto turn = v.turn();
            to([&](world& on) { on.move_to(b, x, turn); });
            break;
        }
        case 3: to([&](world& on) { on.set_linear_velocity(b, x); }); break;
        case 4: {
            const auto spin = v.angular(8);
            to([&](world& on) { on.set_angular_velocity(b, spin); });
            break;
        }
        case 5: to([&](world& on) { on.apply_force(b, x); }); break;
        case 6: to([&](world& on) { on.apply_force_at(b, x, at); }); break;
        case 7: to([&](world& on) { on.apply_local_force_at(b, x, at); }); break;
        case 8: to([&](world& on) { on.apply_impulse(b, x); }); break;
        case 9: to([&](world& on) { on.apply_impulse_at(b, x, at); }); break;
        case 10: to([&](world& on) { on.apply_local_impulse_at(b, x, at); }); break;
        case 11: {
            const auto spin = v.angular(8);
            to([&](world& on) { on.apply_torque(b, spin); });
            break;
        }
        case 12: {
            const auto spin = v.angular(8);
            to([&](world& on) { on.apply_angular_impulse(b, spin); });
            break;
        }
        case 13: to([&](world& on) { on.clear_forces(b); }); break;
        case 14:
        case 15: {
            const auto type = static_cast<body_type>(v.below(v.is_wild() ? 4 : 3));
            to([&](world& on) { on.set_type(b, type); });
            break;
        }
        case 16: {
            const auto mass = v.mass();
            to([&](world& on) { on.set_mass(b, mass); });
            break;
        }
        case 17: to([&](world& on) { on.reset_mass(b); }); break;
        case 18: {
            const S linear = v.share(3), angular = v.share(3);
            to([&](world& on) { on.set_damping(b, linear, angular); });
            break;
        }
        case 19: to([&](world& on) { on.set_gravity_scale(b, x[0]); }); break;
        case 20: to([&](world& on) { on.set_rotation_locked(b, !on.rotation_locked(b)); }); break;
        case 21: to([&](world& on) { on.set_can_sleep(b, !on.can_sleep(b)); }); break;
        case 22: to([&](world& on) { on.wake(b); }); break;
        case 23:
        case 24: to([&](world& on) { on.set_enabled(b, !on.enabled(b)); }); break;
        default:
            to([&](world& on) {
                on.set_continuous(b, !on.continuous(b));
                quietly([&] { static_cast<void>(on.velocity_at(b, at)); });
            });
    }
}

template <class Recipe>
void session<Recipe>::change_shape() {
    const shape_id s = any_shape();
    const bool is = lives(s);
    switch (v.below(4)) {
        case 0: {
            const auto m = v.material();
            apply_to(is, [&](world& on) { on.set_material(s, m); });
            break;
        }
        case 1: {
            const auto f = v.filter();
            apply_to(is, [&](world& on) { on.set_filter(s, f); });
            break;
        }
        default:
            if (apply_to(is, [&](world& on) { on.destroy_shape(s); })) known.destroy(s);
    }
}

template <class Recipe>
void session<Recipe>::act_on_all() {
    const vec at = v.vector(3);
    const S size = v.positive(3), much = v.real(20);
    switch (v.below(5)) {
        case 0: this->apply_several([&](world& on) { apply_gravity_well(on, {at, size, much}); }); break;
        case 1: this->apply_several([&](world& on) { apply_wind(on, {at, size}, S(1.0 / 64)); }); break;
        case 2: this->apply_several([&](world& on) { explode(on, {at, size, size, much, {}}); }); break;
        case 3: {
            physics::water<S, D> water;
            water.height = at[0];
            water.velocity[0] = at[1];
            water.density = size;
            this->apply_several([&](world& on) { apply_buoyancy(on, water, S(1.0 / 64)); });
            break;
        }
        default: apply([&](world& on) { on.shift_origin(at); });
    }
}

template <class Recipe>
void session<Recipe>::walk() {
    const vec way = v.vector(6);
    if (!walker || v.rarely(6)) {
        typename character::settings_type with;
        const unsigned flags = v.byte();
        pushes = flags & 1;
        if (!pushes) with.strength = with.mass = S(0);
        if (flags & 2) with.step_height = v.share(1), with.snap_distance = v.share(1);
        if (flags & 4) with.skin = v.positive(0.125), with.max_slope = v.positive(1.5);
        const auto body = world::capsule::upright(S(1.25), S(0.25));
        walker.reset();
        quietly([&] { walker.emplace(body, v.vector(3), on_y(1), with); });
        if (!walker) return;
    }
    const int how = v.below(8);
    quietly([&] {
        if (how == 0) walker->jump(v.positive(8));
        if (how == 1) walker->set_fall_velocity(v.vector(8));
        if (how == 2) walker->set_feet(v.vector(3));
    });
    for (int n = 1 + v.below(3); n > 0; --n) {
        std::optional<character> moved;
        const auto move = [&](world& on) {
            const std::uint64_t hash = on.state_hash();
            character next = *walker;
            next.move(on, way, S(1.0 / 64));
            if (!pushes) FUZZ_REQUIRE(on.state_hash() == hash);
            // The same in each of the worlds.
            if (moved) FUZZ_REQUIRE(moved->pose().position == next.pose().position);
            moved = next;
        };
        if (pushes) this->apply_several(move);
        else apply(move);
        if (!moved) return;
        walker = moved;
        FUZZ_REQUIRE(is_sound(walker->pose().position) && is_sound(walker->velocity()));
        if (walker->ground()) FUZZ_REQUIRE(is_unit(walker->ground().normal));
    }
}

}  // namespace fuzz
