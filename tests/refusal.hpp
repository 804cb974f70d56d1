// How a refused call is checked: its sentence, and that the world is as it was.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "world_cell.hpp"

namespace {

/// A world in which things touch, move and wait: what a refused call must not disturb.
struct scenery {
    world w;
    body_id ground, platform, box, ball;
    shape_id floor, face;

    scenery() {
        ground = add_ground(w);
        floor = *w.shapes(ground).begin();
        platform = w.create_body({.type = body_type::kinematic_body, .position = at(4, 0.5)});
        w.create_shape(platform, world::box{});
        box = add_box(w, at(0, 0.5));
        ball = add_ball(w, at(0.25, 1.5));
        face = *w.shapes(ball).begin();
        run(w, 5);
        w.apply_force(ball, along(0, 1));
        w.move_to(platform, at(4, 1), {});
    }
};
struct facts {
    std::uint64_t hash, steps;
    std::uint32_t bodies, shapes, contacts;
    bool operator==(const facts&) const = default;
};
inline facts facts_of(const world& w) {
    return {w.state_hash(), w.steps(), w.body_count(), w.shape_count(), w.contacts().size()};
}

/// A call with arguments that are still to come. It refers to the function, so that no check is a template:
/// the many checks of this file would take minutes to compile.
template <class... Arguments>
class call {
public:
    template <class F>
    call(const F& f)
        : object_(&f),
          run_([](const void* object, Arguments... arguments) { (*static_cast<const F*>(object))(arguments...); }) {}
    void operator()(Arguments... arguments) const { run_(object_, arguments...); }

private:
    const void* object_;
    void (*run_)(const void*, Arguments...);
};

inline std::string refusal(call<> call) {
    try {
        call();
    } catch (const physics::error& error) {
        return error.what();
    }
    return "not refused";
}
/// Checks that the call is refused by `function` because `field` is `value` (any, if that is empty).
inline void refuses(const world& w, const std::string& function, const std::string& field, const std::string& value,
                    call<> call) {
    const facts before = facts_of(w);
    const std::string said = refusal(call),
                      expected = "physics: " + function + ": " + field + " is " + value + (value.empty() ? "" : ";");
    CAPTURE(said);
    CHECK(said.substr(0, expected.size()) == expected);
    CHECK((facts_of(w) == before));
}

/// What a number must be.
enum class rule { finite, not_negative, positive };
struct bad_value {
    S value;
    std::string text;
};
inline std::vector<bad_value> bad_values(rule rule) {
    std::vector<bad_value> bad;
    if (!cell::is_fixed) {
        const S huge = cell::traits::max();
        const S infinity = huge + huge;
        bad = {{infinity - infinity, "nan"}, {infinity, "inf"}, {-infinity, "-inf"}};
    }
    if (rule != rule::finite) bad.push_back({S(-1), "-1"});
    if (rule == rule::positive) bad.push_back({S(0), "0"});
    return bad;
}
inline void refuses_number(const world& w, const std::string& function, const std::string& field, rule rule,
                           call<S> call) {
    for (const bad_value& bad : bad_values(rule)) refuses(w, function, field, bad.text, [&] { call(bad.value); });
}
inline void refuses_vec(const world& w, const std::string& function, const std::string& field, rule rule,
                        call<vec> call) {
    for (int i = 0; i < cell::dimension; ++i)
        refuses_number(w, function, field + "." + "xyz"[i], rule, [&](S bad) {
            vec v = vec::filled(S(1));
            v[i] = bad;
            call(v);
        });
}
template <class Angular = angular>
void refuses_angular(const world& w, const std::string& function, const std::string& field,
                     std::type_identity_t<call<Angular>> call) {
    if constexpr (cell::is_2d) refuses_number(w, function, field, rule::finite, call);
    else refuses_vec(w, function, field, rule::finite, call);
}
template <class Rotation>
std::vector<Rotation> bad_rotations() {
    std::vector<Rotation> bad;
    std::vector<S> parts{S(0), S(1.01), S(0.99), S(-2), S(65536)};
    for (const bad_value& value : bad_values(rule::finite)) parts.push_back(value.value);
    for (const S part : parts) {
        if constexpr (cell::is_2d) bad.insert(bad.end(), {{part, S(0)}, {S(0), part}});
        else
            bad.insert(bad.end(), {{part, S(0), S(0), S(0)},
                                   {S(0), part, S(0), S(0)},
                                   {S(0), S(0), part, S(0)},
                                   {S(0), S(0), S(0), part}});
    }
    return bad;
}
inline void refuses_rotation(const world& w, const std::string& function, call<const world::rotation_type&> call) {
    for (const auto& r : bad_rotations<world::rotation_type>())
        refuses(w, function, "error of rotation", "", [&] { call(r); });
}

}  // namespace
