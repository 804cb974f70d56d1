// The library as a contestant.
#pragma once

#include <map>
#include <physics.hpp>

#include "engine.hpp"
#include "inside.hpp"

namespace bench {

/// The kinds of shapes that scenes name.
template <int D>
struct kinds;
template <>
struct kinds<2> {
    using type = physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::rounded_box,
                                 physics::segment, physics::chain>;
};
template <>
struct kinds<3> {
    using type =
        physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::cylinder, physics::mesh>;
};
/// What plays: the default narrowphase, broadphase and integrator, the solver by name.
template <class S, int D, class Solver, class Joints = physics::joints<>>
struct lineup : physics::recipe<S, D, typename kinds<D>::type, Solver, Joints> {};

/// The one place where settings are made.
template <class Settings>
Settings settings_for(const scene& s) {
    Settings with;
    for (int k = 0; k < s.dimension; ++k)
        with.gravity[k] = std::remove_cvref_t<decltype(with.gravity.x)>(s.gravity[static_cast<std::size_t>(k)]);
    with.sleeping.enabled = s.sleeps;
    if (s.substeps > 0) with.solver.substeps = s.substeps;
    if constexpr (requires { with.solver.iterations; })
        if (s.iterations > 0) with.solver.iterations = s.iterations;
    return with;
}

template <class S, int D>
physics::vec<S, D> to_vec(const triple& from) {
    physics::vec<S, D> v;
    for (int k = 0; k < D; ++k) v[k] = S(from[static_cast<std::size_t>(k)]);
    return v;
}
template <class S, int D>
physics::rotation<S, D> to_rotation(const turn& q) {
    if constexpr (D == 2) return physics::rotation<S, 2>{S(q[3] * q[3] - q[2] * q[2]), S(2 * q[2] * q[3])};
    else return physics::rotation<S, 3>{S(q[0]), S(q[1]), S(q[2]), S(q[3])};
}
template <class S, int D>
physics::angular<S, D> to_spin(const triple& w) {
    if constexpr (D == 2) return S(w[2]);
    else return to_vec<S, 3>(w);
}
template <class S, int D>
triple from_vec(const physics::vec<S, D>& v) {
    triple t = {};
    for (int k = 0; k < D; ++k) t[static_cast<std::size_t>(k)] = static_cast<double>(v[k]);
    return t;
}
template <class S, int D>
turn from_rotation(const physics::rotation<S, D>& r) {
    if constexpr (D == 2) return turned(std::atan2(static_cast<double>(r.sine), static_cast<double>(r.cosine)));
    else
        return {static_cast<double>(r.x), static_cast<double>(r.y), static_cast<double>(r.z), static_cast<double>(r.w)};
}
template <class S, int D>
triple from_spin(const physics::angular<S, D>& w) {
    if constexpr (D == 2) return {0, 0, static_cast<double>(w)};
    else return from_vec<S, 3>(w);
}

template <class S, int D>
physics::body_def<S, D> def_of(const body& b) {
    physics::body_def<S, D> def;
    def.type = b.kind == role::fixed    ? physics::body_type::static_body
               : b.kind == role::driven ? physics::body_type::kinematic_body
                                        : physics::body_type::dynamic_body;
    def.position = to_vec<S, D>(b.at);
    def.rotation = to_rotation<S, D>(b.rotation);
    def.linear_velocity = to_vec<S, D>(b.velocity);
    def.angular_velocity = to_spin<S, D>(b.spin);
    return def;
}
/// Shapes in the library's types; hulls of the same points share their geometry.
template <class S, int D>
class shape_maker {
public:
    /// Calls create(shape, def).
    template <class Create>
    void make(const shape& s, Create&& create) {
        physics::shape_def<S, D> def;
        def.position = to_vec<S, D>(s.at);
        def.rotation = to_rotation<S, D>(s.rotation);
        def.density = S(s.density);
        def.material = {S(s.friction), S(s.restitution)};
        if (s.kind == form::ball) create(physics::ball<S, D>{S(s.radius)}, def);
        else if (s.kind == form::capsule) create(physics::capsule<S, D>{S(s.half[0]), S(s.radius)}, def);
        else if (s.kind == form::box && s.radius == 0) create(physics::box<S, D>{to_vec<S, D>(s.half)}, def);
        else if (s.kind == form::hull) create(hull_of(s), def);
        else if constexpr (D == 2) make_flat(s, create, def);
        else make_solid(s, create, def);
    }

private:
    template <class Create, class Def>
    static void make_flat(const shape& s, Create& create, const Def& def) {
        const triple end = {s.half[0], 0, 0};
        if (s.kind == form::box) create(physics::rounded_box<S, 2>{to_vec<S, 2>(s.half), S(s.radius)}, def);
        else if (s.kind == form::segment)
            create(physics::segment<S, 2>{to_vec<S, 2>(end * -1), to_vec<S, 2>(end), S(0)}, def);
        else {
            const auto points = points_of(s);
            create(physics::chain_geometry<S, 2>::build(points.data(), static_cast<std::uint32_t>(points.size()),
                                                        {.loop = true})
                       .shape(),
                   def);
        }
    }
    template <class Create, class Def>
    static void make_solid(const shape& s, Create& create, const Def& def) {
        if (s.kind == form::cylinder) return create(physics::cylinder<S, 3>{S(s.half[0]), S(s.radius), S(0)}, def);
        const auto points = points_of(s);
        const auto built =
            physics::mesh_geometry<S, 3>::build(points.data(), static_cast<std::uint32_t>(points.size()),
                                                s.triangles.data(), static_cast<std::uint32_t>(s.triangles.size() / 3));
        create(built.shape(), def);
    }
    static std::vector<physics::vec<S, D>> points_of(const shape& s) {
        std::vector<physics::vec<S, D>> points;
        for (const triple& p : s.points) points.push_back(to_vec<S, D>(p));
        return points;
    }
    physics::hull<S, D> hull_of(const shape& s) {
        const auto known = hulls_.find(s.points);
        if (known != hulls_.end()) return known->second.shape();
        const auto points = points_of(s);
        const auto built =
            physics::hull_geometry<S, D>::build(points.data(), static_cast<std::uint32_t>(points.size()));
        return hulls_.emplace(s.points, built).first->second.shape();
    }

    std::map<std::vector<triple>, physics::hull_geometry<S, D>> hulls_;
};

/// Steps on the caller's thread alone.
struct by_oneself {
    template <class World, class S>
    void step(World& w, S dt) {
        w.step(dt);
    }
};

template <class S, int D, class Solver, class Way = by_oneself, class Joints = physics::joints<>>
class ours final : public engine {
public:
    void begin(const scene& s) override {
        world_ = std::make_unique<world>(settings_for<typename world::settings_type>(s));
    }
    void add(const body& b) override {
        ids_.push_back(world_->create_body(def_of<S, D>(b)));
        for (const shape& s : b.shapes)
            maker_.make(s, [&](const auto& it, const auto& def) {
                static_cast<void>(world_->create_shape(ids_.back(), it, def));
            });
    }
    void join(const joint& j) override {
        if constexpr (!std::is_same_v<Joints, physics::joints<>>) {
            const physics::body_id a = ids_[static_cast<std::size_t>(j.a)], b = ids_[static_cast<std::size_t>(j.b)];
            const auto point_a = to_vec<S, D>(j.point_a), point_b = to_vec<S, D>(j.point_b);
            if constexpr (D == 3) {
                world_->create_joint(a, b, physics::ball_joint<S, 3>{point_a, point_b});
            } else {
                // Its frame in B is turned so that the angle is 0 now.
                const auto turned = inverse(world_->rotation(b)) * world_->rotation(a);
                if (j.rigid) {
                    world_->create_joint(a, b, physics::weld_joint<S, 2>{{point_a, {}}, {point_b, turned}});
                    return;
                }
                physics::revolute_joint<S, 2> pin{{point_a, {}}, {point_b, turned}};
                pin.max_motor_torque = S(j.friction);
                if (j.lower < j.upper) pin.min_angle = S(j.lower), pin.max_angle = S(j.upper);
                world_->create_joint(a, b, pin);
            }
        }
    }
    void drive(int body, const triple& velocity, const triple& spin) override {
        const physics::body_id id = ids_[static_cast<std::size_t>(body)];
        world_->set_linear_velocity(id, to_vec<S, D>(velocity));
        world_->set_angular_velocity(id, to_spin<S, D>(spin));
    }
    void step(double dt) override { way_.step(*world_, S(dt)); }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (const physics::body_id id : ids_)
            states.push_back({from_vec<S, D>(world_->position(id)), from_rotation<S, D>(world_->rotation(id)),
                              from_vec<S, D>(world_->linear_velocity(id)),
                              from_spin<S, D>(world_->angular_velocity(id)),
                              static_cast<double>(world_->mass(id).mass)});
    }
    [[nodiscard]] triple gravity() const override { return from_vec<S, D>(world_->settings().gravity); }
    [[nodiscard]] int contacts() const override {
        int count = 0;
        for (const auto& c : world_->contacts()) {
            bool touching = false;
            for (int k = 0; k < c.count; ++k) touching = touching || c.points[k].normal_impulse > S(0);
            count += touching;
        }
        return count;
    }
    [[nodiscard]] int awake() const override {
        int count = 0;
        for (const physics::body_id id : ids_)
            count += world_->type(id) == physics::body_type::dynamic_body && !world_->is_asleep(id);
        return count;
    }
    [[nodiscard]] double contact_bytes() const override { return bytes_a_contact(*world_); }

private:
    using world = physics::world<lineup<S, D, Solver, Joints>>;

    std::unique_ptr<world> world_;
    std::vector<physics::body_id> ids_;
    shape_maker<S, D> maker_;
    Way way_;
};

template <class S, class Solver, class Way = by_oneself, class Joints = physics::joints<>>
std::unique_ptr<engine> make_ours(int dimension) {
    if (dimension == 2) return std::make_unique<ours<S, 2, Solver, Way, Joints>>();
    return std::make_unique<ours<S, 3, Solver, Way, Joints>>();
}

}  // namespace bench
