// One world, what has been made in it, and a double that must go the same way.
#pragma once

#include <optional>
#include <string>
#include <tuple>

#include "world_queries.hpp"

namespace fuzz {

/// What a model says there is, so that the world is not asked.
struct things {
    struct owned {
        shape_id shape;
        body_id body;
    };
    struct tie {
        joint_id joint;
        body_id a, b;
    };
    std::vector<body_id> bodies, dead_bodies;
    std::vector<owned> shapes;
    std::vector<shape_id> dead_shapes;
    std::vector<tie> joints;
    std::vector<joint_id> dead_joints;

    void destroy(body_id b) {
        std::erase(bodies, b);
        dead_bodies.push_back(b);
        for (const owned& s : shapes)
            if (s.body == b) dead_shapes.push_back(s.shape);
        std::erase_if(shapes, [&](const owned& s) { return s.body == b; });
        for (const tie& j : joints)
            if (j.a == b || j.b == b) dead_joints.push_back(j.joint);
        std::erase_if(joints, [&](const tie& j) { return j.a == b || j.b == b; });
    }
    void destroy(shape_id s) {
        std::erase_if(shapes, [&](const owned& o) { return o.shape == s; });
        dead_shapes.push_back(s);
    }
    void destroy(joint_id j) {
        std::erase_if(joints, [&](const tie& t) { return t.joint == j; });
        dead_joints.push_back(j);
    }
    template <class World>
    void check(const World& w) const {
        FUZZ_REQUIRE(w.body_count() == bodies.size() && w.shape_count() == shapes.size());
        FUZZ_REQUIRE(w.joint_count() == joints.size());
        for (const body_id b : bodies) FUZZ_REQUIRE(w.contains(b));
        for (const owned& s : shapes) FUZZ_REQUIRE(w.contains(s.shape) && w.body(s.shape) == s.body);
        for (const tie& j : joints) FUZZ_REQUIRE(w.body_a(j.joint) == j.a && w.body_b(j.joint) == j.b);
        for (const body_id b : dead_bodies) FUZZ_REQUIRE(!w.contains(b));
        for (const shape_id s : dead_shapes) FUZZ_REQUIRE(!w.contains(s));
        for (const joint_id j : dead_joints) FUZZ_REQUIRE(!w.contains(j));
    }
    /// Takes over what there is, where calls within calls have changed it.
    template <class World>
    void adopt(const World& w) {
        const things before = std::exchange(*this, {});
        for (const body_id b : w.bodies()) {
            bodies.push_back(b);
            for (const shape_id s : w.shapes(b)) shapes.push_back({s, b});
        }
        for (const joint_id j : w.joints()) joints.push_back({j, w.body_a(j), w.body_b(j)});
        const auto bury = [&](auto id, auto& dead) {
            if (!w.contains(id)) dead.push_back(id);
        };
        dead_bodies = before.dead_bodies;
        dead_shapes = before.dead_shapes;
        dead_joints = before.dead_joints;
        for (const body_id b : before.bodies) bury(b, dead_bodies);
        for (const owned& s : before.shapes) bury(s.shape, dead_shapes);
        for (const tie& j : before.joints) bury(j.joint, dead_joints);
    }
};

/// Calls of worlds so far: each changes the world, asks it or takes a step, and is checked.
inline unsigned long operations = 0;

/// A call of a world, so that what is checked around calls is compiled once for all of them.
template <class World>
class world_call {
public:
    template <class F>
    explicit world_call(F& f)
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(f)))),
          run_([](void* object, World& on) { (*static_cast<F*>(object))(on); }) {}
    void operator()(World& on) const { run_(object_, on); }

private:
    void* object_;
    void (*run_)(void*, World&);
};

/// Two workers or three, as threads that outlive inputs.
inline physics::thread_pool& pool_of(int workers) {
    static physics::thread_pool two(2), three(3);
    return workers == 2 ? two : three;
}
/// Parts in the wrong order, by several workers, without a thread.
struct backwards {
    [[nodiscard]] std::uint32_t workers() const { return 5; }
    void run(std::uint32_t count, const physics::task_set& tasks) const {
        for (std::uint32_t k = count; k-- > 0;) tasks(k, (k * 7) % 5);
    }
};

template <class Recipe>
class session_base {
public:
    using world = physics::world<Recipe>;
    using S = typename world::scalar;
    static constexpr int D = world::dimension;
    using snapshot = physics::detail::raw_snapshot<typename physics::detail::plan_of<Recipe>::type>;
    using access = physics::detail::world_access;

    /// The hash after each step.
    std::vector<std::uint64_t> trace;

protected:
    explicit session_base(input& in) : v(in) {}

    enum class stepped { plainly, by_two, by_three, backwards };

    /// What was kept of a moment.
    struct moment {
        std::optional<world> copy;
        snapshot image;
        things known;
        listener<world> told;
        std::uint64_t hash = 0;
    };

    using call = world_call<world>;

    /// Calls f(world); a refusal leaves it as it was, to the last byte. Says whether it was done.
    bool attempt(world& on, const call& f) {
        const std::uint64_t hash = on.state_hash();
        before_.save(access::state_of(on));
        try {
            f(on);
            return true;
        } catch (const physics::error& e) {
            said = e.what();
            FUZZ_REQUIRE(said.rfind("physics: ", 0) == 0);
        }
        FUZZ_REQUIRE(on.state_hash() == hash);
        after_.save(access::state_of(on));
        FUZZ_REQUIRE(before_.size() == after_.size());
        FUZZ_REQUIRE(std::memcmp(before_.data(), after_.data(), after_.size()) == 0);
        return false;
    }
    /// Now and then the same in a copy, which has no room to spare and finds no memory at first: as it was then.
    std::optional<world> starve(const call& f) {
        if (++calls_made_ % 4 != 0) return {};
        std::optional<world> scarce(w);
        const std::uint64_t hash = w.state_hash();
        all_are_refused_then = calls_made_ % 8 == 0;
        calls_until_refused = calls_made_ / 4 * 7 % 40;
        bool refused = false;
        try {
            f(*scarce);
        } catch (const physics::out_of_memory&) {
            refused = true;
        } catch (const physics::error&) {
        }
        calls_until_refused = -1;
        if (!refused) return {};
        FUZZ_REQUIRE(scarce->state_hash() == hash && scarce->awake_count() == w.awake_count());
        known.check(*scarce);
        check_contacts(*scarce);
        return scarce;
    }
    /// And again with memory: it goes on as the world, which has made the call.
    void feed(std::optional<world>& scarce, const call& f) {
        if (!scarce) return;
        quietly([&] { f(*scarce); });
        // Far out, where distances are roundings, contacts may be found between boxes of which a refused step leaves
        // none of their margins.
        if (!query_check<world>{w, {}}.is_near()) return;
        FUZZ_REQUIRE(scarce->state_hash() == w.state_hash());
        world next = w;
        for (world* on : {&next, &*scarce}) quietly([&] { on->step(S(1.0 / 64)); });
        FUZZ_REQUIRE(scarce->state_hash() == next.state_hash());
    }
    /// The same for the world and its double, which must agree.
    template <class F>
    bool apply(F&& f) {
        return apply_call(call(f));
    }
    bool apply_call(const call& f) {
        ++operations;
        std::optional<world> scarce = starve(f);
        const bool done = attempt(w, f);
        feed(scarce, f);
        if (twin) {
            const std::string first = said;
            FUZZ_REQUIRE(attempt(*twin, f) == done && (done || said == first));
            FUZZ_REQUIRE(twin->state_hash() == w.state_hash());
        }
        return done;
    }
    /// For what makes several calls, of which the last ones may be refused.
    template <class F>
    void apply_several(F&& f) {
        ++operations;
        quietly([&] { f(w); });
        if (!twin) return;
        quietly([&] { f(*twin); });
        FUZZ_REQUIRE(twin->state_hash() == w.state_hash());
    }
    /// For calls that name something: what does not live is refused.
    template <class F>
    bool apply_to(bool lives, F&& f) {
        const bool done = apply(f);
        FUZZ_REQUIRE(lives || !done);
        return done;
    }
    /// Where refusals are allowed and nothing is promised of what went before.
    template <class F>
    static void quietly(F&& f) {
        try {
            f();
        } catch (const physics::error&) {
        }
    }

    /// Mostly one that lives, sometimes one that is gone, null or of another world.
    body_id any_body() {
        const int n = v.below(256);
        if (n < 240 && !known.bodies.empty()) return known.bodies[static_cast<unsigned>(n) % known.bodies.size()];
        if (n < 252 && !known.dead_bodies.empty())
            return known.dead_bodies[static_cast<unsigned>(n) % known.dead_bodies.size()];
        body_id stranger = known.bodies.empty() ? body_id{} : known.bodies[0];
        ++stranger.world;
        return n == 255 ? body_id{} : stranger;
    }
    shape_id any_shape() {
        const int n = v.below(256);
        if (n < 240 && !known.shapes.empty()) return known.shapes[static_cast<unsigned>(n) % known.shapes.size()].shape;
        if (n < 252 && !known.dead_shapes.empty())
            return known.dead_shapes[static_cast<unsigned>(n) % known.dead_shapes.size()];
        return {static_cast<std::uint32_t>(n), 1, 0};
    }
    joint_id any_joint() {
        const int n = v.below(256);
        if (n < 240 && !known.joints.empty()) return known.joints[static_cast<unsigned>(n) % known.joints.size()].joint;
        if (n < 252 && !known.dead_joints.empty())
            return known.dead_joints[static_cast<unsigned>(n) % known.dead_joints.size()];
        return {static_cast<std::uint32_t>(n), 1, 0};
    }
    [[nodiscard]] bool lives(body_id b) const {
        return std::find(known.bodies.begin(), known.bodies.end(), b) != known.bodies.end();
    }
    [[nodiscard]] bool lives(shape_id s) const {
        return std::any_of(known.shapes.begin(), known.shapes.end(), [&](const auto& o) { return o.shape == s; });
    }
    [[nodiscard]] bool lives(joint_id j) const {
        return std::any_of(known.joints.begin(), known.joints.end(), [&](const auto& t) { return t.joint == j; });
    }

    void step(S dt) {
        // Where no double lives, one stays behind in case the step is refused.
        std::optional<world> behind;
        if (v.is_wild() && !twin) behind = w;
        const auto plainly = [&](world& on) { on.step(dt); };
        ++operations;
        std::optional<world> scarce = starve(call(plainly));
        const bool done = step_one(w, dt, stepped::plainly);
        feed(scarce, call(plainly));
        if (twin) FUZZ_REQUIRE(step_one(*twin, dt, twin_steps) == done);
        if (!done) {
            if (behind) twin.swap(behind);
            trace.push_back(0);
            return;
        }
        trace.push_back(w.state_hash());
        told.hear(w);
        check_sensors(w);
        if (twin) check_twin();
        after_change();
    }
    void after_change() {
        check_numbers(w);
        check_contacts(w);
        known.check(w);
    }
    void keep(moment& m) {
        ++operations;
        m.image.save(access::state_of(w));
        m.copy = w;
        m.known = known;
        m.told = told;
        m.hash = w.state_hash();
        FUZZ_REQUIRE(m.copy->state_hash() == m.hash);
    }
    /// Goes back to a moment, by its copy or by its image; the double goes the other way.
    void go_back(const moment& m, bool by_image) {
        if (!m.copy) return;
        ++operations;
        // A stranger with another past.
        twin.emplace(w);
        const auto restore = [&](world& on) { m.image.restore(access::data_of(on)); };
        if (by_image) {
            restore(w);
            *twin = *m.copy;
        } else {
            w = *m.copy;
            restore(*twin);
        }
        FUZZ_REQUIRE(w.state_hash() == m.hash && twin->state_hash() == m.hash);
        known = m.known;
        told = m.told;
        // Numbers and generations come again.
        known.dead_bodies.clear();
        known.dead_shapes.clear();
        known.dead_joints.clear();
        twin_steps = stepped::plainly;
    }

    values<S, D> v;
    world w;
    std::optional<world> twin;
    stepped twin_steps = stepped::plainly;
    things known;
    listener<world> told;
    std::string said;

private:
    bool step_one(world& on, S dt, stepped how) {
        const std::uint64_t hash = on.state_hash();
        try {
            switch (how) {
                case stepped::plainly: on.step(dt); break;
                case stepped::by_two: on.step(dt, pool_of(2)); break;
                case stepped::by_three: on.step(dt, pool_of(3)); break;
                case stepped::backwards: {
                    backwards by;
                    on.step(dt, by);
                }
            }
            return true;
        } catch (const physics::error&) {
            FUZZ_REQUIRE(on.state_hash() == hash);
            return false;
        }
    }
    void check_twin() const {
        FUZZ_REQUIRE(twin->state_hash() == w.state_hash());
        FUZZ_REQUIRE(twin->contact_begin_events().size() == w.contact_begin_events().size());
        FUZZ_REQUIRE(twin->contact_end_events().size() == w.contact_end_events().size());
        FUZZ_REQUIRE(twin->hit_events().size() == w.hit_events().size());
        FUZZ_REQUIRE(twin->sensor_begin_events().size() == w.sensor_begin_events().size());
        FUZZ_REQUIRE(twin->sensor_end_events().size() == w.sensor_end_events().size());
        FUZZ_REQUIRE(twin->sleep_events().size() == w.sleep_events().size());
        FUZZ_REQUIRE(twin->wake_events().size() == w.wake_events().size());
        FUZZ_REQUIRE(twin->broken_joints().size() == w.broken_joints().size());
        FUZZ_REQUIRE(twin->joint_limit_begin_events().size() == w.joint_limit_begin_events().size());
        FUZZ_REQUIRE(twin->joint_limit_end_events().size() == w.joint_limit_end_events().size());
        for (std::uint32_t i = 0; i < w.contact_end_events().size(); ++i)
            FUZZ_REQUIRE(twin->contact_end_events()[i].shape_a == w.contact_end_events()[i].shape_a);
        check_contacts(*twin);
    }

    snapshot before_, after_;
    long calls_made_ = 0;
};

}  // namespace fuzz
