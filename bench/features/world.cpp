// One world of the benchmark of features: its DIMENSION, the features LEFT_OUT, and the NAME of that set.
#include <physics.hpp>

#include "subject.hpp"

namespace bench {

#define PASTED(start, name) start##name
#define WITHOUT(name) PASTED(without_, name)
#define TEXT_OF(name) #name
#define TEXT(name) TEXT_OF(name)

using namespace physics::feature;
struct WITHOUT(NAME)
    : physics::recipe<float, DIMENSION, physics::shapes<physics::ball, physics::box>, physics::without<LEFT_OUT>> {};

namespace {

using world = physics::world<WITHOUT(NAME)>;
using vec = world::vec;

world& of(void* w) { return *static_cast<world*>(w); }
const world& of(const void* w) { return *static_cast<const world*>(w); }

vec to_vec(const double* from) {
    vec v;
    for (int k = 0; k < DIMENSION; ++k) v[k] = static_cast<float>(from[k]);
    return v;
}
#if DIMENSION == 2
world::rotation_type to_rotation(const double* q) {
    return {static_cast<float>(q[3] * q[3] - q[2] * q[2]), static_cast<float>(2 * q[2] * q[3])};
}
float to_spin(const double* w) { return static_cast<float>(w[2]); }
#else
world::rotation_type to_rotation(const double* q) {
    return {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2]), static_cast<float>(q[3])};
}
vec to_spin(const double* w) { return to_vec(w); }
#endif

/// Nobody sleeps, but all are watched: what sleepers spare is not the question here.
template <class Settings>
void keep_awake([[maybe_unused]] Settings& sleeping) {
    if constexpr (requires { sleeping.time; }) sleeping.time = 1e6f;
}
template <class World>
concept turns = requires(World& w, physics::body_id b, typename World::angular spin) {
    w.set_angular_velocity(b, spin);
};
/// Of a shape, or of all in settings: whichever has a material.
template <class Settings>
void set_friction([[maybe_unused]] Settings& of, [[maybe_unused]] double friction) {
    if constexpr (requires { of.material.friction; }) of.material.friction = static_cast<float>(friction);
}
void* make(const double* gravity, double friction) {
    world::settings_type with;
    with.gravity = to_vec(gravity);
    set_friction(with, friction);
    keep_awake(with.sleeping);
    return new world(with);
}
void add(void* w, const plain_body& b) {
    constexpr physics::body_type kinds[] = {physics::body_type::static_body, physics::body_type::kinematic_body,
                                            physics::body_type::dynamic_body};
    world::body_def body;
    body.type = kinds[b.kind];
    body.position = to_vec(b.at);
    body.rotation = to_rotation(b.rotation);
    body.linear_velocity = to_vec(b.velocity);
    if constexpr (turns<world>) body.angular_velocity = to_spin(b.spin);
    const physics::body_id id = of(w).create_body(body);
    for (int i = 0; i < b.count; ++i) {
        const plain_shape& s = b.shapes[i];
        world::shape_def def;
        def.position = to_vec(s.at);
        def.density = static_cast<float>(s.density);
        set_friction(def, s.friction);
        if (s.is_ball) static_cast<void>(of(w).create_shape(id, world::ball{static_cast<float>(s.radius)}, def));
        else static_cast<void>(of(w).create_shape(id, world::box{to_vec(s.half)}, def));
    }
}
void step(void* w, double dt) { of(w).step(static_cast<float>(dt)); }
void* copy(const void* w) { return new world(of(w)); }
void drop(void* w) { delete &of(w); }
std::uint32_t contacts(const void* w) { return of(w).contacts().size(); }
std::uint64_t places(const void* w) {
    std::uint64_t sum = 0;
    for (const physics::body_id id : of(w).bodies()) {
        const vec p = of(w).center_of_mass(id);
        for (int k = 0; k < DIMENSION; ++k) sum = (sum ^ __builtin_bit_cast(std::uint32_t, p[k])) * 0x100000001b3u;
    }
    return sum;
}

subject here{TEXT(NAME), DIMENSION, make, add, step, copy, drop, contacts, places, nullptr};
const bool listed = (here.next = subject::first, subject::first = &here, true);

}  // namespace

}  // namespace bench
