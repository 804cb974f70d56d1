// Calls to a world, in any order, out of a fuzzer's bytes.
#pragma once

#include "world_session.hpp"

namespace fuzz {

template <class Recipe>
class session : session_base<Recipe> {
    using base = session_base<Recipe>;
    using base::apply, base::apply_to, base::v, base::w, base::twin, base::known, base::lives, base::any_body,
        base::any_shape, base::any_joint, base::quietly;
    using typename base::S;
    using typename base::stepped;
    using typename base::world;
    static constexpr int D = base::D;
    using vec = physics::vec<S, D>;
    using transform = physics::transform<S, D>;

public:
    using base::trace;
    explicit session(input& in) : base(in) {
        typename world::settings_type with;
        change(with);
        quietly([&] { w.set_settings(with); });
        if (v.rarely(4)) return;
        const body_id ground = add_body({.type = body_type::static_body});
        switch (v.below(4)) {
            case 0: create(ground, typename world::box{vec::filled(S(4))}, {.position = on_y(-4)}); break;
            case 1: create(ground, typename world::halfspace{}, {}); break;
            default: with_parts(v, [&](const auto& shape) { create(ground, shape, {}); });
        }
        heap();
    }
    void run() {
        for (int i = 0; i < 60 && !v.empty(); ++i) {
            one();
            this->after_change();
        }
        // Long enough for all that has ended to be told, and to fall asleep.
        for (int i = 0; i < 4; ++i) this->step(S(1.0 / 64));
        if (apply([](world& on) { on.clear(); })) {
            for (const body_id b : std::vector(known.bodies)) known.destroy(b);
            this->step(S(1.0 / 64));
            FUZZ_REQUIRE(this->told.touching.empty() && this->told.inside.empty() && this->told.asleep.empty());
            FUZZ_REQUIRE(this->told.at_limits.empty());
        }
    }

private:
    void change(typename world::settings_type& s) {
        if (v.rarely(2)) s.gravity = v.vector(10);
        if (v.rarely(4)) s.contact_margin = v.share(0.1);
        if (v.rarely(4)) s.broadphase.margin = v.share(0.5);
        if (v.rarely(4)) s.broadphase.prediction = v.share(4);
        if (v.rarely(2)) s.solver.substeps = v.below(10) - 1;
        if (v.rarely(2)) s.sleeping.time = v.share(0.25), s.sleeping.speed = S(0.5);
        if (v.rarely(8)) s.sleeping.enabled = false;
        if (v.rarely(2)) s.events.hit_speed = v.share(2);
    }
    body_id add_body(const typename world::body_def& def) {
        body_id made;
        if (known.bodies.size() >= 24) return made;
        apply([&](world& on) {
            const body_id b = on.create_body(def);
            FUZZ_REQUIRE(!made || made == b);
            made = b;
        });
        if (made) known.bodies.push_back(made);
        return made;
    }
    template <class Shape>
    void create(body_id b, const Shape& shape, const typename world::shape_def& def) {
        if (known.shapes.size() >= 40) return;
        shape_id made;
        apply_to(lives(b), [&](world& on) {
            const shape_id s = on.create_shape(b, shape, def);
            FUZZ_REQUIRE(!made || made == s);
            made = s;
        });
        if (made) known.shapes.push_back({made, b});
    }
    static vec on_y(double y) {
        vec at;
        at[1] = S(y);
        return at;
    }
    /// Bodies that lie on each other, or fall so as to.
    void heap() {
        const unsigned kinds = v.byte(), places = v.byte();
        for (int i = v.below(8); i >= 0; --i) {
            vec at = on_y(0.3 + 0.55 * i + (places & 1 ? 0.05 * i : 0.0));
            at[0] = S((places >> 1 & 3) * 0.1 * (i % 3));
            const body_id b = add_body({.position = at, .user_data = next_data++});
            const auto kind = (kinds >> (i % 4 * 2)) & 3;
            if (kind == 0) create(b, typename world::ball{S(0.3)}, {});
            if (kind == 1) create(b, typename world::box{vec::filled(S(0.25))}, {});
            if (kind == 2) create(b, typename world::capsule{S(0.25), S(0.2)}, {.user_data = next_data++});
            if (kind == 3) create(b, typename world::box{vec::filled(S(0.3))}, {.sensor = i % 2 == 1});
        }
    }
    typename world::body_def body_def() {
        typename world::body_def def;
        const unsigned b = v.byte();
        def.type = static_cast<body_type>(b % 8 < 3 ? b % 8 : 2);
        def.rotation_locked = (b & 8) != 0 && (b & 16) != 0;
        def.can_sleep = (b & 96) != 96;
        def.continuous = (b & 128) != 0;
        def.position = v.vector(2);
        if (def.position.y < S(0) && !v.is_wild()) def.position.y = -def.position.y;
        if (v.rarely(2)) def.rotation = v.turn();
        if (v.rarely(2)) def.linear_velocity = v.vector(v.rarely(4) ? 100 : 4);
        if (v.rarely(4)) def.angular_velocity = v.angular(8);
        if (v.rarely(8))
            def.linear_damping = v.share(2), def.angular_damping = v.share(2), def.gravity_scale = v.real(2);
        def.user_data = next_data++;
        return def;
    }
    void add_shape(body_id b) {
        typename world::shape_def def;
        if (v.rarely(3)) {
            def.position = v.vector(1);
            def.rotation = v.turn();
        }
        if (v.rarely(4)) def.density = v.share(8);
        def.material = v.material();
        def.filter = v.filter();
        def.sensor = v.rarely(4);
        def.senses_static = def.sensor && v.rarely(3);
        def.user_data = next_data++;
        v.shape([&](const auto& shape) { create(b, shape, def); });
    }
    template <class Joint>
    void add_joint() {
        const body_id a = any_body(), b = any_body();
        physics::joint_def def;
        const unsigned flags = v.byte();
        def.collide_connected = flags & 1;
        def.enabled = (flags & 14) != 14;
        if (flags & 16) def.break_force = as_double(v.share(50));
        if (flags & 32) def.break_torque = as_double(v.share(50));
        Joint joint{};
        if (v.rarely(2)) v.change(joint);
        const bool placed = flags & 64;
        const transform frame = placed ? v.pose(3) : transform{};
        joint_id made;
        if (known.joints.size() >= 12) return;
        apply_to(lives(a) && lives(b), [&](world& on) {
            joint_id j;
            if constexpr (requires { on.create_joint_at(a, b, frame, joint, def); }) {
                j = placed ? on.create_joint_at(a, b, frame, joint, def) : on.create_joint(a, b, joint, def);
            } else {
                j = on.create_joint(a, b, joint, def);
            }
            FUZZ_REQUIRE(!made || made == j);
            made = j;
        });
        if (made) known.joints.push_back({made, a, b});
    }
    template <template <class, int> class... Joints>
    static std::tuple<const Joints<S, D>*...> kinds_of(const physics::joints<Joints...>&);
    using kinds = decltype(kinds_of(typename world::joint_list{}));
    static constexpr int kind_count = std::tuple_size_v<kinds>;
    /// Calls f(a null pointer to a kind) with the kind of that number.
    template <class F>
    static void with_kind(int number, F&& f) {
        std::apply([&](auto... kind) { ((number-- == 0 ? f(kind) : void()), ...); }, kinds{});
    }
    void set_joint() {
        const joint_id j = any_joint();
        with_kind(v.below(kind_count), [&]<class Joint>(const Joint*) {
            Joint joint{};
            const bool lives_so = lives(j) && w.template is_joint<Joint>(j);
            if (lives_so) joint = w.template joint<Joint>(j);
            v.change(joint);
            apply_to(lives_so, [&](world& on) { on.set_joint(j, joint); });
        });
    }

    physics::query_filter query_filter() {
        physics::query_filter f;
        if (!v.rarely(3)) return f;
        const unsigned b = v.byte();
        f.mask = b & 1 ? 3u : physics::all_categories;
        f.kinds = b & 2 ? physics::all_bodies : (b >> 2) & 7;
        f.any_category = b & 32;
        f.sensors = b & 64;
        f.inside = !(b & 128);
        if (v.rarely(4)) f.except = any_body();
        return f;
    }
    void ask() {
        const physics::query_filter by = query_filter();
        const transform at = v.pose(4);
        const vec way = v.vector(8);
        const S reach = v.positive(4);
        int what = v.below(5);
        // Far out, where distances are roundings, all that counts is that there is an answer.
        bool is_far = as_double(reach) > 1e6;
        for (int i = 0; i < D; ++i)
            is_far = is_far || std::abs(as_double(at.position[i])) > 1e6 || std::abs(as_double(way[i])) > 1e6;
        if (is_far) what += 5;
        // The world stays as it is, whatever it says.
        apply([&](world& on) {
            const query_check<world> check{on, by};
            const std::uint64_t hash = on.state_hash();
            if (what == 0) check.ray(at.position, way);
            if (what == 1) check.overlaps(typename world::box{vec::filled(reach)}, at);
            if (what == 2) check.cast(typename world::capsule{reach, S(0.25)}, at, way);
            if (what == 3) check.closest(at.position, reach);
            if (what == 4) check.collide(typename world::capsule{S(0.5), reach}, at, S(0.125));
            if (what == 4) check.batches(at, way), check.draw();
            if (what == 5) static_cast<void>(on.cast_ray(at.position, way, by));
            if (what == 6) on.each_overlapping(typename world::box{vec::filled(reach)}, at, by, [](shape_id) {});
            if (what == 7) static_cast<void>(on.cast_shape(typename world::capsule{reach, S(0.25)}, at, way, by));
            if (what == 8) static_cast<void>(on.closest_shape(at.position, reach, by));
            if (what == 9) on.collide_shape(typename world::box{vec::filled(reach)}, at, S(1), by, [](const auto&) {});
            FUZZ_REQUIRE(on.state_hash() == hash);
        });
    }
    /// What a visitor does with a shape that it is told of.
    static void meddle(world& on, shape_id s, int how, vec by) {
        if (!on.contains(s)) return;
        const body_id b = on.body(s);
        quietly([&] {
            switch (how) {
                case 0: on.destroy_body(b); break;
                case 1: on.destroy_shape(s); break;
                case 2: on.apply_impulse(b, by); break;
                case 3: on.set_pose(b, on.position(b) + by, on.rotation(b)); break;
                case 4: on.set_type(b, body_type::kinematic_body); break;
                case 5: on.create_shape(b, typename world::ball{S(0.25)}); break;
                case 6: on.wake(b); break;
                case 7: on.create_body({.position = by}); break;
                case 8: on.set_filter(s, {1, 5, -1}); break;
                case 9: on.create_joint(b, *on.bodies().begin(), typename world::distance_joint{}); break;
                case 10: on.set_enabled(b, false); break;
                default: on.clear();
            }
        });
    }
    void ask_and_meddle() {
        const transform at = v.pose(3);
        const vec way = v.vector(6), by = v.vector(2);
        const int what = v.below(6), how = v.below(12);
        const S reach = v.positive(3);
        apply([&](world& on) {
            int calls = 0;
            const auto visit = [&](shape_id s) {
                FUZZ_REQUIRE(on.contains(s));
                FUZZ_REQUIRE(++calls < 1000);
                meddle(on, s, how, by);
            };
            quietly([&] {
                if (what == 0) on.each_overlapping(typename world::ball{reach}, at, {}, visit);
                if (what == 1) on.each_hit_along_ray(at.position, way, {}, [&](const auto& h) { visit(h.shape); });
                if (what == 2)
                    on.collide_shape(typename world::ball{reach}, at, S(0.25), {},
                                     [&](const auto& c) { visit(c.shape); });
                if (what == 3)
                    for (const auto& c : on.contacts()) visit(calls % 2 ? c.shape_a : c.shape_b);
                if (what == 4)
                    for (const body_id b : on.bodies()) {
                        if (calls++ % 3 == 0) quietly([&] { on.set_pose(b, on.position(b) + by, on.rotation(b)); });
                        if (how == 0) on.destroy_body(b);
                    }
                if (what == 5)
                    for (const shape_id sensor : shapes_of(on))
                        if (on.contains(sensor) && on.is_sensor(sensor)) on.each_visitor(sensor, visit);
            });
        });
        known.adopt(w);
    }
    void steps() {
        constexpr double lengths[] = {1.0 / 64, 1.0 / 60, 1.0 / 30, 1.0 / 240, 1.0 / 8};
        const S dt = v.rarely(8) ? v.positive(0.5) : S(lengths[v.below(5)]);
        for (int n = v.below(4) == 0 ? 16 : 1 + v.below(4); n > 0 && steps_left > 0; --n, --steps_left) this->step(dt);
    }
    void double_up() {
        ++operations;
        twin.reset();
        constexpr stepped ways[] = {stepped::plainly, stepped::by_two, stepped::by_three, stepped::backwards};
        this->twin_steps = ways[v.below(4)];
        if (v.rarely(3)) {
            world other = w;
            twin.emplace(std::move(other));
            FUZZ_REQUIRE(other.body_count() == 0);
            other.step(S(1.0 / 64));
        } else {
            twin.emplace(w);
        }
    }
    void change_body();
    void change_shape();
    void walk();
    void act_on_all();
    void one();

    using character = physics::character<world>;
    std::optional<character> walker;
    bool pushes = false;

    typename base::moment moments[2];
    std::uint64_t next_data = 1;
    int steps_left = 40;
};

template <class Recipe>
void session<Recipe>::one() {
    switch (v.below(36)) {
        case 0: heap(); break;
        case 1:
        case 2:
        case 3:
        case 4: {
            const body_id b = add_body(body_def());
            if (!b) break;
            for (int n = 1 + v.below(8) / 6; n > 0; --n) add_shape(b);
            break;
        }
        case 5:
        case 6: add_shape(any_body()); break;
        case 7: {
            const body_id b = any_body();
            if (apply_to(lives(b), [&](world& on) { on.destroy_body(b); })) known.destroy(b);
            break;
        }
        case 8: {
            std::vector<body_id> list;
            bool good = true;
            for (int n = v.below(5); n > 0; --n) {
                list.push_back(any_body());
                good = good && lives(list.back()) && std::count(list.begin(), list.end(), list.back()) == 1;
            }
            if (apply_to(good, [&](world& on) { on.destroy_bodies(list); }))
                for (const body_id b : list) known.destroy(b);
            break;
        }
        case 9:
            if (v.rarely(4)) {
                apply([](world& on) { on.clear(); });
                for (const body_id b : std::vector(known.bodies)) known.destroy(b);
            } else {
                change_shape();
            }
            break;
        case 10: change_shape(); break;
        case 11:
        case 12:
        case 13: with_kind(v.below(kind_count), [&]<class Joint>(const Joint*) { add_joint<Joint>(); }); break;
        case 14: {
            const joint_id j = any_joint();
            const int what = v.below(3);
            if (what == 0) {
                if (apply_to(lives(j), [&](world& on) { on.destroy_joint(j); })) known.destroy(j);
            } else {
                apply_to(lives(j), [&](world& on) { on.set_joint_enabled(j, what == 1); });
            }
            break;
        }
        case 15: set_joint(); break;
        case 16: {
            auto with = w.settings();
            change(with);
            apply([&](world& on) { on.set_settings(with); });
            break;
        }
        case 17: ask_and_meddle(); break;
        case 18:
        case 19: ask(); break;
        case 20: double_up(); break;
        case 21: this->keep(moments[v.below(2)]); break;
        case 22: this->go_back(moments[v.below(2)], v.rarely(2)); break;
        case 23:
        case 24:
        case 25:
        case 26: change_body(); break;
        case 27:
        case 28: walk(); break;
        case 29: act_on_all(); break;
        default: steps();
    }
}

template <class Recipe>
std::vector<std::uint64_t> play(input in) {
    session<Recipe> s(in);
    s.run();
    return s.trace;
}

}  // namespace fuzz
