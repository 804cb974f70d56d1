// Changes of a body and of a shape, in any order.
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

}  // namespace fuzz
