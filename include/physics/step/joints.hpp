// The joints of a world, and those of a step.
#pragma once

#include "physics/base/pool.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/dynamics/constraints.hpp"
#include "physics/dynamics/convert.hpp"
#include "physics/step/awake.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Behind the last joint of a body.
inline constexpr std::uint32_t no_joint = null_index;

/// What a world keeps of a joint, whatever its kind.
struct joint_record {
    std::uint32_t body_a = 0, body_b = 0;
    /// The next joint of A, and of B.
    std::uint32_t next_a = no_joint, next_b = no_joint;
    /// Which kind it is of, and which of that kind.
    std::uint32_t kind = 0, slot = 0;
    bool enabled = true, collide_connected = false;
    /// Whether both of its bodies are enabled.
    bool bodies_enabled = true;
    /// By which force and torque it breaks (N, N m); 0: by none.
    double break_force = 0, break_torque = 0;
    std::uint64_t user_data = 0;
    PHYSICS_HPP_MEMBERS(body_a, body_b, next_a, next_b, kind, slot, enabled, collide_connected, bodies_enabled,
                        break_force, break_torque, user_data)

    [[nodiscard]] bool holds() const { return enabled && bodies_enabled; }
    [[nodiscard]] bool can_break() const { return break_force > 0 || break_torque > 0; }

    [[nodiscard]] std::uint32_t other(std::uint32_t body) const { return body == body_a ? body_b : body_a; }
    std::uint32_t& next(std::uint32_t body) { return body == body_a ? next_a : next_b; }
    [[nodiscard]] std::uint32_t next(std::uint32_t body) const { return body == body_a ? next_a : next_b; }
};
/// A joint of a kind, and what its rows gave in a substep of that length, and in the last step (N s, s).
template <class Joint, class S>
struct stored_joint {
    Joint joint;
    [[no_unique_address]] fixed_list<S, Joint::row_count> impulse{};
    S substep{};
    [[no_unique_address]] fixed_list<S, Joint::row_count> sum{};
    S step{};
    /// Of joints that count their turns.
    [[no_unique_address]] angle_list<Joint, S> turned{};
    /// Its record.
    std::uint32_t number = 0;
    PHYSICS_HPP_MEMBERS(joint, impulse, substep, sum, step, turned, number)
};
/// A joint that broke, and what it gave in that step.
template <class S, int D>
struct broken_record {
    std::uint32_t number;
    std::uint16_t generation;
    joint_reaction<S, D> reaction;
};
template <class Joint, class S>
struct joint_pool : pool<stored_joint<Joint, S>> {};

/// The joints of a world: records, the joints of each kind by themselves, and a list for each body.
template <class S, int D, class Joints>
struct joint_set;
template <class S, int D, template <class, int> class... Joints>
struct joint_set<S, D, joints<Joints...>> : joint_pool<Joints<S, D>, S>... {
    pool<joint_record> records;
    /// Of each body its last joint.
    buffer<std::uint32_t> first;
    /// What broke in the last step, in the order of the numbers.
    buffer<broken_record<S, D>> broken;

    template <class Joint>
    static constexpr bool knows = (std::same_as<Joint, Joints<S, D>> || ...);
    template <class Joint>
    static constexpr std::uint32_t kind_of() {
        std::uint32_t kind = 0, result = 0;
        ((result = std::same_as<Joint, Joints<S, D>> ? kind : result, ++kind), ...);
        return result;
    }
    /// Whether joints of a kind hold bodies together: they have rows.
    static constexpr bool holds(std::uint32_t kind) {
        constexpr bool has_rows[] = {(Joints<S, D>::row_count > 0)...};
        return has_rows[kind];
    }
    template <class Joint>
    pool<stored_joint<Joint, S>>& of_kind() {
        return static_cast<joint_pool<Joint, S>&>(*this);
    }
    template <class Joint>
    const pool<stored_joint<Joint, S>>& of_kind() const {
        return static_cast<const joint_pool<Joint, S>&>(*this);
    }
    /// Calls f(number of the kind, its joints) for each kind.
    template <class Self, class F>
    static void each_kind(Self& self, F&& f) {
        std::uint32_t kind = 0;
        (f(kind++, self.template of_kind<Joints<S, D>>()), ...);
    }
    template <class Self, class F>
    static void each_member(Self& self, F&& f) {
        each_kind(self, [&](std::uint32_t, auto& of_kind) { f(of_kind); });
        f(self.records);
        f(self.first);
        f(self.broken);
    }
    /// Calls f(number, joint) for each joint of a body; f may take it out.
    template <class F>
    void each_of(std::uint32_t body, F&& f) const {
        for (std::uint32_t i = first[body]; i != no_joint;) {
            const std::uint32_t next = records[i].next(body);
            f(i, records[i]);
            i = next;
        }
    }
    /// Whether a joint keeps two bodies from colliding.
    [[nodiscard]] bool keep_apart(std::uint32_t a, std::uint32_t b) const {
        if (first[a] == no_joint || first[b] == no_joint) return false;
        bool result = false;
        each_of(a, [&](std::uint32_t, const joint_record& r) {
            result = result || (r.holds() && !r.collide_connected && r.other(a) == b);
        });
        return result;
    }
};
struct no_joints {};

/// The joints of a step, kind by kind, and the edges that they are.
template <class S, int D, class Joints>
struct step_joints;
template <class S, int D, template <class, int> class... Joints>
struct step_joints<S, D, joints<Joints...>> : buffer<step_joint<Joints<S, D>, S, D>>... {
    /// Where the edges of each kind begin, and after the last one.
    std::uint32_t begin[sizeof...(Joints) + 1] = {};
    /// Pairs of shapes that no joint keeps from colliding.
    buffer<proxy_pair> pairs;

    template <class Joint>
    buffer<step_joint<Joint, S, D>>& of_kind() {
        return *this;
    }
    template <class Joint>
    const buffer<step_joint<Joint, S, D>>& of_kind() const {
        return *this;
    }
    [[nodiscard]] std::uint32_t edge_count() const { return begin[sizeof...(Joints)] - begin[0]; }

    /// The constraints of a batch: its contacts, and its edges, which are in ascending order.
    template <class Features>
    constraints<S, D, Features, joints<Joints...>> add_to(const contact_constraints<S, D, Features>& contacts,
                                                          const std::uint32_t* order, const body_pair* ends,
                                                          std::uint32_t count) {
        std::uint32_t kind = 0, at = contacts.size();
        const auto list = [&]<class Joint>(buffer<step_joint<Joint, S, D>>& all) {
            const std::uint32_t from = at, first = begin[kind], end = begin[++kind];
            while (at < count && order[at] < end) ++at;
            return joint_list<Joint, S, D>(all.begin(), order + from, first, ends + from, at - from);
        };
        // In braces, as the lists follow each other.
        return constraints<S, D, Features, joints<Joints...>>{contacts, list(of_kind<Joints<S, D>>())...};
    }
};
struct no_step_joints {};

/// Where the bodies of a joint are.
template <class Joint, class S, int D, bool Rotates>
frames_for<Joint, S, D> frames_between(const body<S, D, Rotates>& a, const body<S, D, Rotates>& b) {
    const joint_frames<S, D> at{a.rotation, b.rotation, a.mass.center, b.mass.center, b.center - a.center};
    if constexpr (has_two_directions<Joint>()) return {at, a.center};
    else return at;
}
/// Joints, and which bodies move -> those of the step, where their bodies are, and their edges. O(joints).
template <class S, int D, class Joints, bool Rotates>
void list_joints(joint_set<S, D, Joints>& all, const pool<body<S, D, Rotates>>& bodies, const awake_list& awake,
                 buffer<edge>& edges, step_joints<S, D, Joints>& found) {
    std::uint32_t can_break = 0;
    const auto is_pushed = [&](std::uint32_t i) { return awake.has(i) && bodies[i].is_dynamic(); };
    all.each_kind(all, [&]<class Joint>(std::uint32_t kind, const pool<stored_joint<Joint, S>>& of_kind) {
        auto& to = found.template of_kind<Joint>();
        to.clear();
        found.begin[kind] = edges.size();
        if constexpr (Joint::row_count > 0)
            of_kind.each([&](std::uint32_t slot, const stored_joint<Joint, S>& from) {
                const joint_record& record = all.records[from.number];
                if (!record.holds() || (!is_pushed(record.body_a) && !is_pushed(record.body_b))) return;
                const auto &a = bodies[record.body_a], &b = bodies[record.body_b];
                auto& j = to.emplace_back(&from.joint, frames_between<Joint>(a, b));
                for (int k = 0; k < Joint::row_count; ++k) j.impulse[k] = from.impulse[k];
                j.substep = from.substep;
                j.turned = from.turned;
                j.slot = slot;
                edges.push_back({record.body_a, record.body_b});
                if (record.can_break()) ++can_break;
            });
        found.begin[kind + 1] = edges.size();
    });
    // Nothing fails when they break.
    all.broken.reserve(can_break);
}
/// What the joints of a step of h seconds gave -> the world's.
template <class S, int D, class Joints>
void publish_joints(step_joints<S, D, Joints>& found, S h, joint_set<S, D, Joints>& all) {
    all.each_kind(all, [&]<class Joint>(std::uint32_t, pool<stored_joint<Joint, S>>& of_kind) {
        for (const auto& j : found.template of_kind<Joint>()) {
            for (int k = 0; k < Joint::row_count; ++k) of_kind[j.slot].impulse[k] = j.impulse[k];
            for (int k = 0; k < Joint::row_count; ++k) of_kind[j.slot].sum[k] = j.sum[k];
            of_kind[j.slot].substep = j.substep;
            of_kind[j.slot].step = h;
            of_kind[j.slot].turned = j.turned;
        }
    });
}

/// What a joint gave in the last step, along its rows where its bodies are. In fixed point a force may be beyond the
/// range where its impulse is not: it is the largest then.
template <class Joint, class S, int D, bool Rotates>
joint_reaction<S, D> reaction_of(const stored_joint<Joint, S>& j, const body<S, D, Rotates>& a,
                                 const body<S, D, Rotates>& b) {
    using C = std::conditional_t<is_fixed<S>, double, S>;
    joint_reaction<C, D> sum{};
    if (j.step > S(0)) {
        auto at = frames_between<Joint>(a, b);
        const auto turned = count_turns(j.joint, at, j.turned);
        at.turned = turned.begin();
        row_list<S, D, Joint::row_count, has_two_directions<Joint>()> rows;
        rows_of(j.joint, at, rows.target());
        const auto& row = rows.row;
        for (int k = 0; k < Joint::row_count; ++k) {
            const C force = static_cast<C>(j.sum[k]) / static_cast<C>(j.step);
            const auto about = row[k].angular_b - cross(row[k].r_b, row[k].direction);
            sum.force += converted<C>(row[k].direction) * force;
            sum.torque += converted<C>(about) * force;
        }
    }
    return {converted<S>(sum.force), converted<S>(sum.torque)};
}
/// Joints that gave more than they can bear are no longer enabled; their bodies start to be still anew.
template <class S, int D, class Joints, bool Rotates, class Sleep>
void break_joints(const step_joints<S, D, Joints>& found, const pool<body<S, D, Rotates>>& bodies,
                  joint_set<S, D, Joints>& all, Sleep& sleep) {
    all.broken.clear();
    all.each_kind(all, [&]<class Joint>(std::uint32_t, const pool<stored_joint<Joint, S>>& of_kind) {
        for (const auto& j : found.template of_kind<Joint>()) {
            const std::uint32_t number = of_kind[j.slot].number;
            joint_record& record = all.records[number];
            if (!record.can_break()) continue;
            const auto gave = reaction_of(of_kind[j.slot], bodies[record.body_a], bodies[record.body_b]);
            const auto is_more = [](const auto& x, double limit) {
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(x)>, S>)
                    return limit > 0 && to_double(abs(x)) > limit;
                else return limit > 0 && to_double(length(x)) > limit;
            };
            if (!is_more(gave.force, record.break_force) && !is_more(gave.torque, record.break_torque)) continue;
            record.enabled = false;
            auto& broken = all.broken;
            broken.push_back({number, all.records.generation(number), gave});
            for (std::uint32_t k = broken.size() - 1; k > 0 && broken[k - 1].number > broken[k].number; --k)
                std::swap(broken[k - 1], broken[k]);
            for (const std::uint32_t body : {record.body_a, record.body_b})
                if constexpr (requires { sleep.sleep_time; }) sleep.sleep_time[body] = {};
        }
    });
}

/// Calls f(body) for each that a joint holds to one.
template <class F>
void each_connected(const no_joints&, std::uint32_t, F&&) {}
template <class Joints, class F>
void each_connected(const Joints& joints, std::uint32_t body, F&& f) {
    joints.each_of(body, [&](std::uint32_t, const joint_record& r) {
        if (r.holds() && joints.holds(r.kind)) f(r.other(body));
    });
}

/// Pairs of shapes -> those that no joint keeps from colliding.
template <class Shapes>
const buffer<proxy_pair>& without_connected(const buffer<proxy_pair>& pairs, const no_joints&, const Shapes&,
                                            no_step_joints&) {
    return pairs;
}
template <class Joints, class Shapes, class StepJoints>
const buffer<proxy_pair>& without_connected(const buffer<proxy_pair>& pairs, const Joints& joints, const Shapes& shapes,
                                            StepJoints& found) {
    if (joints.records.count() == 0) return pairs;
    found.pairs.clear();
    for (const proxy_pair& p : pairs)
        if (!joints.keep_apart(shapes[p.a].body, shapes[p.b].body)) found.pairs.push_back(p);
    return found.pairs;
}

}  // namespace detail

PHYSICS_HPP_END
