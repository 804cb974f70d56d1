// Joints as users make, read and change them.
#pragma once

#include "physics/world/ranges.hpp"
#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class Plan>
void wake_connected(world_data<Plan>& s, std::uint32_t joint) {
    // By what runs in a float_control_scope: impulses are rescaled.
    world_code<Plan>::wake(s, s.joints.records[joint].body_a, s.joints.records[joint].body_b);
}

/// Whether two values have equal members. Taken for different: members without a ==, and more than 32 of them.
template <class T>
bool has_equal_members(const T& a, const T& b) {
    if constexpr (names_members<T>) {
        constexpr int limit = 32;
        const void* of_a[limit] = {};
        int count = 0, at = 0;
        T::each_member(a, [&](const auto& member) {
            if (count < limit) of_a[count] = &member;
            ++count;
        });
        if (count > limit) return false;
        bool result = true;
        T::each_member(b, [&]<class Member>(const Member& member) {
            result = has_equal_members(*static_cast<const Member*>(of_a[at++]), member) && result;
        });
        return result;
    } else if constexpr (requires {
                             { a == b } -> std::convertible_to<bool>;
                         }) {
        return a == b;
    } else {
        return false;
    }
}
/// Whether a joint may be made or set between these bodies where they are.
template <class Plan, class Joint>
bool check_joint(const state<Plan>& s, const Joint& joint, std::uint32_t a, std::uint32_t b, const char* function) {
    if (!check(joint, function)) return false;
    const auto at = frames_between<Joint>(s.bodies[a], s.bodies[b]);
    if constexpr (requires { joint.check_at(at, function); }) return joint.check_at(at, function);
    else return true;
}
/// Has a joint that is made or set fill in what it leaves open.
template <class Plan, class Joint>
void fill_in([[maybe_unused]] state<Plan>& s, [[maybe_unused]] std::uint32_t number, [[maybe_unused]] Joint& joint) {
    using frames = frames_for<Joint, typename Plan::scalar, Plan::dimension>;
    if constexpr (requires(Joint & j, const frames& at) { j.fill_in(at); }) {
        const joint_record& record = s.joints.records[number];
        auto& j = s.joints.template of_kind<Joint>()[record.slot];
        frames at = frames_between<Joint>(s.bodies[record.body_a], s.bodies[record.body_b]);
        j.turned = count_turns(joint, at, j.turned);
        at.turned = j.turned.begin();
        joint.fill_in(at);
    }
}
template <class Plan, class Joint>
void set_joint(world_data<Plan>& s, std::uint32_t number, Joint joint) {
    const joint_record& record = s.joints.records[number];
    if (!check_joint<Plan>(s, joint, record.body_a, record.body_b, "set_joint")) return;
    Joint& now = s.joints.template of_kind<Joint>()[record.slot].joint;
    fill_in<Plan>(s, number, joint);
    if (has_equal_members(now, joint)) return;
    wake_connected(s, number);
    now = joint;
}
template <class Plan, class Joint>
joint_id create_joint(world_data<Plan>& s, body_id body_a, body_id body_b, const Joint& joint, const joint_def& def) {
    const char* f = "create_joint";
    const lookup a = find(s, s.bodies, body_a, f, "body_a"), b = find(s, s.bodies, body_b, f, "body_b");
    if (!a || !b) return {};
    if (a.index == b.index) {
        refuse(f, "body_b", "the same as body_a", "a joint holds two bodies");
        return {};
    }
    if (!check_joint<Plan>(s, joint, a.index, b.index, f) || !check_not_negative(f, "break_force", def.break_force) ||
        !check_not_negative(f, "break_torque", def.break_torque))
        return {};
    auto& of_kind = s.joints.template of_kind<Joint>();
    // What may fail comes first.
    s.joints.records.reserve(s.joints.records.slots() + 1);
    s.joint_values.reserve(s.joints.records.slots() + 1);
    of_kind.reserve(of_kind.slots() + 1);
    world_code<Plan>::wake(s, a.index, b.index);
    joint_record record{a.index, b.index, s.joints.first[a.index], s.joints.first[b.index]};
    record.kind = s.joints.template kind_of<Joint>();
    record.slot = of_kind.next_index();
    record.enabled = def.enabled;
    record.collide_connected = def.collide_connected;
    record.bodies_enabled = s.bodies[a.index].enabled && s.bodies[b.index].enabled;
    record.break_force = def.break_force;
    record.break_torque = def.break_torque;
    record.user_data = def.user_data;
    const auto place = s.joints.records.insert(record);
    s.joint_values.start(place.index);
    stored_joint<Joint, typename Plan::scalar> stored;
    stored.joint = joint;
    stored.number = place.index;
    of_kind.insert(stored);
    s.joints.first[a.index] = s.joints.first[b.index] = place.index;
    fill_in<Plan, Joint>(s, place.index, of_kind[record.slot].joint);
    return {place.index, place.generation, s.tag};
}

/// Calls f(the joint with what it gave, its bodies) for one of any kind.
template <class Plan, class F>
void with_joint(const state<Plan>& s, std::uint32_t joint, F&& f) {
    const joint_record& record = s.joints.records[joint];
    s.joints.each_kind(s.joints, [&](std::uint32_t kind, const auto& of_kind) {
        if (kind == record.kind) f(of_kind[record.slot], s.bodies[record.body_a], s.bodies[record.body_b]);
    });
}
/// How far a joint is turned, by the first of its angles.
template <class Plan>
typename Plan::scalar angle_of(const state<Plan>& s, std::uint32_t joint) {
    using S = typename Plan::scalar;
    S result{};
    const auto angle = [&]<class Joint>(const stored_joint<Joint, S>& j, const auto& a, const auto& b) {
        if constexpr (angles_of<Joint>() > 0)
            result = count_turns(j.joint, frames_between<Joint>(a, b), j.turned)[0].total();
    };
    with_joint<Plan>(s, joint, angle);
    return result;
}
/// The joints of a world, in the order of their numbers, or those of one body. A loop may change the world: it leaves
/// out what has been destroyed, and goes no farther than the numbers that there were when it began.
template <class Plan>
class joint_range {
public:
    joint_range(const state<Plan>& s, body_id body) : state_(&s), body_(body) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, body_id body) : state_(&s), body_(body), end_(s.joints.records.slots()) {
            find(0);
        }
        joint_id operator*() const { return {at_, state_->joints.records.generation(at_), state_->tag}; }
        iterator& operator++() {
            find(at_ + 1);
            return *this;
        }
        bool operator==(range_end) const { return at_ >= end_ || at_ >= state_->joints.records.slots(); }

    private:
        void find(std::uint32_t from) {
            const auto& records = state_->joints.records;
            for (at_ = records.next(from); at_ < records.slots() && body_; at_ = records.next(at_ + 1))
                if (records[at_].body_a == body_.index || records[at_].body_b == body_.index) return;
        }

        const state<Plan>* state_;
        body_id body_;
        std::uint32_t end_, at_ = 0;
    };
    iterator begin() const { return iterator(*state_, body_); }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
    body_id body_;
};

/// The joints that broke in the last step.
template <class Plan>
class broken_range {
public:
    explicit broken_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(at) {}
        broken_joint<typename Plan::scalar, Plan::dimension> operator*() const {
            const auto& broken = state_->joints.broken[at_];
            return {{broken.number, broken.generation, state_->tag}, broken.reaction};
        }
        iterator& operator++() {
            ++at_;
            return *this;
        }
        bool operator==(range_end) const { return at_ >= state_->joints.broken.size(); }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, 0}; }
    range_end end() const { return {}; }
    [[nodiscard]] std::uint32_t size() const { return state_->joints.broken.size(); }

private:
    const state<Plan>* state_;
};

}  // namespace detail

/// What a world can do with joints, where its recipe names kinds of them: joints<distance_joint>. A joint goes with its
/// bodies. Making, changing and destroying one wakes them. O(1), and where they wake as said of world.
template <class World, class Plan, bool = Plan::has_joints>
class joint_functions {
    static constexpr int D = Plan::dimension;
    using S = typename Plan::scalar;

public:
    /// Joins two bodies, of which those that are not dynamic feel nothing of it. They collide no longer, unless the
    /// definition says so.
    template <class Joint>
    joint_id create_joint(body_id body_a, body_id body_b, const Joint& joint, const joint_def& def = {}) {
        check_kind<Joint>();
        if constexpr (knows<Joint>)
            return detail::scoped([&] { return detail::create_joint(state(), body_a, body_b, joint, def); });
        else return {};
    }
    /// The same for a frame in the world as it stands, which takes the place of the joint's own: of kinds that hold
    /// frames, or a point.
    template <detail::placed_by_frame Joint>
    joint_id create_joint_at(body_id body_a, body_id body_b, const transform<S, D>& frame, Joint joint,
                             const joint_def& def = {}) {
        const auto& world = static_cast<const World&>(*this);
        if (!world.contains(body_a) || !world.contains(body_b)) return create_joint(body_a, body_b, joint, def);
        if (!detail::check_frame("create_joint_at", "frame.position", "frame.rotation", frame)) return {};
        detail::scoped([&] {
            const transform<S, D> a = relative(world.pose(body_a), frame), b = relative(world.pose(body_b), frame);
            if constexpr (detail::holds_frames<Joint>) {
                joint.frame_a = a;
                joint.frame_b = b;
            } else {
                joint.anchor_a = a.position;
                joint.anchor_b = b.position;
            }
        });
        return create_joint(body_a, body_b, joint, def);
    }
    void destroy_joint(joint_id id) {
        const auto at = find(state(), id, "destroy_joint");
        if (!at) return;
        if constexpr (Plan::events::joint_limits)
            state().joint_limits.dropped.reserve(state().joint_limits.dropped.size() + 1);
        detail::wake_connected(state(), at.index);
        detail::erase_joint(state(), at.index);
    }
    /// True if the handle names a living joint of this world; never an error.
    [[nodiscard]] bool contains(joint_id id) const { return detail::contains(state(), state().joints.records, id); }
    [[nodiscard]] std::uint32_t joint_count() const { return state().joints.records.count(); }
    /// All joints: `for (physics::joint_id j : world.joints())`.
    [[nodiscard]] auto joints() const { return detail::joint_range<Plan>(state(), {}); }

    /// What a joint is: of another kind it is refused.
    template <class Joint>
    [[nodiscard]] Joint joint(joint_id id) const {
        const auto at = find_kind<Joint>(state(), id, "joint");
        return at ? state().joints.template of_kind<Joint>()[record(at).slot].joint : Joint{};
    }
    /// Whether a joint is of a kind: is_joint<world::revolute_joint>(id).
    template <class Joint>
    [[nodiscard]] bool is_joint(joint_id id) const {
        check_kind<Joint>();
        const auto at = find(state(), id, "is_joint");
        return at && record(at).kind == state().joints.template kind_of<Joint>();
    }
    /// Changes it to another joint of its kind; what it gave it begins with. If it is as it was, what sleeps goes on.
    template <class Joint>
    void set_joint(joint_id id, const Joint& joint) {
        const auto at = find_kind<Joint>(state(), id, "set_joint");
        if (at) detail::scoped([&] { detail::set_joint<Plan>(state(), at.index, joint); });
    }
    [[nodiscard]] body_id body_a(joint_id id) const {
        const auto at = find(state(), id, "body_a");
        return at ? name_of(record(at).body_a) : body_id{};
    }
    [[nodiscard]] body_id body_b(joint_id id) const {
        const auto at = find(state(), id, "body_b");
        return at ? name_of(record(at).body_b) : body_id{};
    }
    [[nodiscard]] bool joint_enabled(joint_id id) const {
        const auto at = find(state(), id, "joint_enabled");
        return at && record(at).enabled;
    }
    /// A joint that is not enabled holds nothing, and lets its bodies collide.
    void set_joint_enabled(joint_id id, bool enabled) {
        const auto at = find(state(), id, "set_joint_enabled");
        if (!at || record(at).enabled == enabled) return;
        detail::wake_connected(state(), at.index);
        state().joints.records[at.index].enabled = enabled;
    }
    /// What it gave in the last step in which it was awake, all of its rows and all substeps together, along its
    /// rows where its bodies are now.
    [[nodiscard]] joint_reaction<S, D> reaction(joint_id id) const {
        joint_reaction<S, D> result{};
        if (const auto at = find(state(), id, "reaction"))
            detail::scoped([&] {
                detail::with_joint<Plan>(state(), at.index, [&](const auto& j, const auto& a, const auto& b) {
                    result = detail::reaction_of(j, a, b);
                });
            });
        return result;
    }
    /// The joints that broke in the last step, in the order of their numbers. What has been destroyed since is no
    /// longer a joint of this world.
    [[nodiscard]] auto broken_joints() const { return detail::broken_range<Plan>(state()); }
    /// Joints that have come to one of their limits in the last step, in the order of their numbers, and those that
    /// have left all of theirs, been disabled or destroyed at one: each begin is followed by one end. A joint that
    /// falls asleep at its limit stays there.
    [[nodiscard]] const buffer<joint_limit_event>& joint_limit_begin_events() const
        requires(Plan::events::joint_limits) {
        return state().step.events.limit_begin;
    }
    [[nodiscard]] const buffer<joint_limit_event>& joint_limit_end_events() const requires(Plan::events::joint_limits) {
        return state().step.events.limit_end;
    }
    /// The angle of a joint that turns, over any number of turns (rad), where its bodies are; of others 0.
    [[nodiscard]] S joint_angle(joint_id id) const {
        const auto at = find(state(), id, "joint_angle");
        return at ? detail::scoped([&] { return detail::angle_of(state(), at.index); }) : S(0);
    }
    [[nodiscard]] std::uint64_t user_data(joint_id id) const {
        const auto at = find(state(), id, "user_data");
        return at ? record(at).user_data : 0;
    }
    void set_user_data(joint_id id, std::uint64_t value) {
        if (const auto at = find(state(), id, "set_user_data")) state().joints.records[at.index].user_data = value;
    }

private:
    auto& state() { return detail::world_access::data_of(static_cast<World&>(*this)); }
    const auto& state() const { return detail::world_access::data_of(static_cast<const World&>(*this)); }
    template <class State>
    static detail::lookup find(State& s, joint_id id, const char* function) {
        return detail::find_joint(s, id, function);
    }
    template <class Joint>
    static constexpr bool knows = detail::joints_of<Plan>::template knows<Joint>;
    template <class Joint>
    static constexpr void check_kind() {
        static_assert(knows<Joint>,
                      "physics::world: the recipe's set of joints lacks this one; name it in physics::joints<...>");
    }
    template <class Joint, class State>
    static detail::lookup find_kind(State& s, joint_id id, const char* function) {
        check_kind<Joint>();
        const auto at = find(s, id, function);
        if (!at) return at;
        if (s.joints.records[at.index].kind == s.joints.template kind_of<Joint>()) return at;
        return {0, detail::refuse(function, "joint", "of another kind", "it must be of the kind that is asked for")};
    }
    const auto& record(const detail::lookup& at) const { return state().joints.records[at.index]; }
    [[nodiscard]] body_id name_of(std::uint32_t body) const {
        return {body, state().bodies.generation(body), state().tag};
    }
};
/// Of a recipe without joints.
template <class World, class Plan>
class joint_functions<World, Plan, false> {
public:
    template <class Joint>
    joint_id create_joint(body_id, body_id, const Joint&, const joint_def& = {}) {
        static_assert(sizeof(Joint) == 0,
                      "physics::world: the recipe knows no joints; name their kinds in physics::joints<...>");
        return {};
    }
    [[nodiscard]] bool contains(joint_id) const { return false; }
    [[nodiscard]] std::uint32_t joint_count() const { return 0; }
    std::uint64_t user_data(joint_id) const = delete;
    void set_user_data(joint_id, std::uint64_t) = delete;
};

PHYSICS_HPP_END
