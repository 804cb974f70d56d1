// Sleep: islands that are still leave the step until something happens to them.
#pragma once

#include "physics/dynamics/islands.hpp"
#include "physics/step/nearby.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Keeps, in order, the contacts for which stays(contact) is true, and hands the others to out.
template <class Contacts, class Stays, class Out>
void partition_contacts(Contacts& contacts, Stays&& stays, Out&& out) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (!stays(contacts[i])) {
            out(contacts[i]);
            continue;
        }
        if (kept != i) contacts[kept] = contacts[i];
        ++kept;
    }
    while (contacts.size() > kept) contacts.pop_back();
}
/// Adds contacts to others; both lists, and the result, are in ascending order of their pairs.
template <class Contact>
void merge_contacts(buffer<Contact>& to, const buffer<Contact>& more) {
    std::uint32_t i = to.size(), j = more.size();
    if (j == 0) return;
    to.resize(i + j, more[0]);
    for (std::uint32_t at = to.size(); j > 0;) {
        const bool is_last = i > 0 && more[j - 1].key() < to[i - 1].key();
        to[--at] = is_last ? to[--i] : more[--j];
    }
}

/// Calls f(body) for all of a sleeper's island, itself included; f may wake them.
template <class Plan, class F>
void each_of_island(state<Plan>& s, std::uint32_t body, F&& f) {
    std::uint32_t i = body;
    do {
        const std::uint32_t next = s.sleep.island_next[i];
        f(i);
        i = next;
    } while (i != body);
}

/// Brings bodies back that were asleep, listed in s.step.woken: they can be pushed again, and what touches them is
/// looked at again.
template <class Plan>
void finish_waking(state<Plan>& s) {
    for (const std::uint32_t i : s.step.woken) {
        s.sleep.island_next[i] = no_sleeper;
        s.sleep.sleep_time[i] = {};
        reinsert_proxies(s, i);
    }
    if (!s.step.woken.empty()) s.awake.is_stale = true;
    s.step.woken.clear();
}
/// True if neither body of the contact is dynamic and awake.
template <class Plan, class Contact>
bool touches_no_awake_body(const state<Plan>& s, const Contact& c) {
    return !s.is_awake_dynamic(c.bodies.body_a) && !s.is_awake_dynamic(c.bodies.body_b);
}
/// Wakes the islands of those that each(f) calls f(body) for, at once, with their contacts. O(contacts of sleepers).
template <class Plan, class Each>
void wake_islands(state<Plan>& s, Each&& each) {
    // A step that was refused may have left its list.
    s.step.woken.clear();
    bool any = false;
    each([&](std::uint32_t body) {
        if (!s.is_asleep(body)) return;
        any = true;
        each_of_island(s, body, [&](std::uint32_t i) { s.step.woken.push_back(i); });
        finish_waking(s);
    });
    if (!any) return;
    s.step.new_contacts.clear();
    partition_contacts(
        s.sleep.contacts, [&](const auto& c) { return touches_no_awake_body(s, c); },
        [&](const auto& c) { s.step.new_contacts.push_back(c); });
    rescale_impulses(s.step.new_contacts.begin(), s.step.new_contacts.end(), {s.sleep.step, s.sleep.step},
                     s.step_lengths);
    merge_contacts(s.contacts, s.step.new_contacts);
}
template <class Plan>
void wake(state<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) wake_islands(s, [&](auto&& f) { f(body); });
}
/// Wakes those that touch a body.
template <class Plan>
void wake_touching(state<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) {
        auto& touching = s.step.near;
        touching.clear();
        for (const auto& c : s.sleep.contacts) {
            if (c.bodies.body_a == body) touching.push_back(c.bodies.body_b);
            if (c.bodies.body_b == body) touching.push_back(c.bodies.body_a);
        }
        wake_islands(s, [&](auto&& f) {
            for (const std::uint32_t i : touching) f(i);
        });
    }
}
/// A body has changed: wakes its island if it is dynamic, else the islands that touch it.
template <class Plan>
void wake_affected(state<Plan>& s, std::uint32_t body) {
    if (s.bodies[body].is_dynamic()) wake(s, body);
    else wake_touching(s, body);
}
/// Wakes those that lie where a body is, or on its way to another pose.
template <class Plan>
void wake_near(state<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps) {
        auto& near = s.step.near;
        near.clear();
        each_shape(s, body, [&](std::uint32_t, const auto& shape) {
            const auto box = merged(query_bounds(s, shape), bounds(shape.shape, to * shape.local));
            each_near(s, box, query_filter{}, [&](std::uint32_t other) {
                if (s.is_asleep(s.shapes[other].body)) near.push_back(s.shapes[other].body);
                return true;
            });
        });
        wake_islands(s, [&](auto&& f) {
            for (const std::uint32_t i : near) f(i);
        });
    }
}
template <class Plan>
void wake_near(state<Plan>& s, std::uint32_t body) {
    wake_near(s, body, s.bodies[body].pose());
}
template <class Plan>
void wake_all(state<Plan>& s) {
    if constexpr (Plan::sleeps)
        wake_islands(s, [&](auto&& f) { s.bodies.each([&](std::uint32_t i, const auto&) { f(i); }); });
}

template <class Plan>
std::uint32_t count_awake(const state<Plan>& s) {
    std::uint32_t count = 0;
    s.bodies.each(
        [&](std::uint32_t i, const auto& b) { count += b.type != body_type::static_body && !s.is_asleep(i); });
    return count;
}

/// How far gravity draws bodies together within a step, at most.
template <class Plan>
auto gravity_slack(const state<Plan>& s, typename Plan::scalar h) {
    return length(s.settings.gravity) * h * h;
}

/// Adds to the awake list the islands of sleeping bodies that a body will touch in this step; they wake for good when
/// the step has succeeded. True if there are any.
template <class Plan>
bool list_woken(state<Plan>& s, bool any_near, typename Plan::scalar h) {
    s.step.woken.clear();
    if (!any_near) return false;
    const auto slack = gravity_slack(s, h);
    for (const auto& c : s.step.new_contacts) {
        const std::uint32_t a = c.bodies.body_a, b = c.bodies.body_b;
        const bool of_a = s.is_asleep(a);
        if (of_a == s.is_asleep(b)) continue;
        const std::uint32_t sleeper = of_a ? a : b;
        if (s.awake.has(sleeper) ||
            !will_touch(c, s.bodies[a].velocity_ahead(h), s.bodies[b].velocity_ahead(h), h, slack))
            continue;
        each_of_island(s, sleeper, [&](std::uint32_t i) {
            s.awake.index_of[i] = 0;
            s.step.woken.push_back(i);
        });
    }
    if (s.step.woken.empty()) return false;
    for (const std::uint32_t i : s.step.woken) s.awake.bodies.push_back(i);
    s.awake.is_stale = true;
    return true;
}

/// The step has succeeded: they are awake for good.
template <class Plan>
void commit_woken(state<Plan>& s) {
    if (s.step.woken.empty()) return;
    finish_waking(s);
    partition_contacts(
        s.sleep.contacts, [&](const auto& c) { return touches_no_awake_body(s, c); }, [](const auto&) {});
}

/// Notes how long each body has been still, and lets islands sleep that have been so for long enough and rest on
/// something, or do not move at all: a slow drift in free space goes on for ever. What lies on other bodies only may go
/// along with them: the upper rows of a large pile breathe by centimetres while no two that touch move against each
/// other. Then the island must have lost half of that energy since, so that what tips, or moves steadily, stays awake.
template <class Plan>
class sleep_update {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    sleep_update(state<Plan>& s, S h) : s_(s), step_(h) {
        if (!update_sleep_times()) return;
        count_ = s.awake.size();
        disjoint_sets sets(count_, s.step.scratch);
        island_ = s.step.scratch.template allocate<island>(count_);
        for (std::uint32_t k = 0; k < count_; ++k) new (island_ + k) island{};
        const S slack = gravity_slack(s, h);
        for (const auto& c : s.contacts) {
            const auto [a, b] = awake_pair(c);
            if (is_dynamic(a) && is_dynamic(b) && touch(c, slack)) sets.unite(a, b);
        }
        for (std::uint32_t k = 0; k < count_; ++k)
            if (is_dynamic(k)) add_to_island(k, island_[sets.find(k)]);
        for (const auto& c : s.contacts) {
            const auto [a, b] = awake_pair(c);
            if (is_dynamic(a) != is_dynamic(b) && touch(c, slack))
                add_support(a, b, island_[sets.find(is_dynamic(a) ? a : b)]);
        }
        bool any = false;
        for (std::uint32_t k = 0; k < count_; ++k) {
            if (!is_dynamic(k)) continue;
            island& of = island_[sets.find(k)];
            if (!of.is_still || !(of.rests || of.is_stopped) || of.now > 0.5 * of.before) continue;
            fall_asleep(s.awake[k], of);
            any = true;
        }
        if (any) move_contacts_to_sleepers();
    }

private:
    struct island {
        bool is_still = true, is_stopped = true, rests = false;
        /// Of bodies that went along with others, mass times speed squared now, and when they began to.
        double now = 0, before = 0;
        std::uint32_t first = no_sleeper, last = no_sleeper;
    };

    /// True if any body has been still for long enough.
    bool update_sleep_times() {
        const auto& with = s_.settings.sleeping;
        if (!with.enabled) return false;
        const auto fast = product(with.speed, with.speed), spinning = product(with.spin, with.spin),
                   far = product(with.drift, with.drift);
        const auto is_slow = [&](const auto& b) {
            return !(length_squared(b.velocity.linear) > fast || spin_squared(value_of(b.velocity.angular)) > spinning);
        };
        const auto is_far = [&](std::uint32_t i) {
            return length_squared(s_.bodies[i].center - s_.sleep.sleep_anchor[i]) > far;
        };
        const support* supports = find_supports(is_slow, is_far);
        bool any = false;
        for (std::uint32_t k = 0; k < s_.awake.size(); ++k) {
            const std::uint32_t i = s_.awake[k];
            const auto& b = s_.bodies[i];
            S &sleep_time = s_.sleep.sleep_time[i], &carried_from = s_.sleep.carried_from[i];
            const bool moved = is_far(i), is_carried = supports != nullptr && supports[k] == support::carried;
            if (!(sleep_time > S(0))) carried_from = S(-1);
            if (!is_slow(b) || !b.can_sleep || (moved && !is_carried)) sleep_time = S(0);
            else if (sleep_time < with.time) sleep_time += step_;
            if (!(sleep_time > S(0))) carried_from = S(-1);
            else if (moved && carried_from < S(0))
                carried_from =
                    static_cast<S>(min(square_of(b.velocity.linear), to_double(scalar_traits<S>::max()) / 2));
            if (moved || !(sleep_time > S(0))) s_.sleep.sleep_anchor[i] = b.center;
            any = any || (b.is_dynamic() && !(sleep_time < with.time));
        }
        return any;
    }
    /// What a slow body that has moved far lies on: nothing, other bodies that move as it does, or anything else.
    enum class support : std::uint8_t { unasked, none, carried, other };

    /// Of each body that moves; null if none of the slow ones has moved far.
    template <class IsSlow, class IsFar>
    const support* find_supports(IsSlow&& is_slow, IsFar&& is_far) {
        const std::uint32_t count = s_.awake.size();
        auto* found = s_.step.scratch.template allocate<support>(count + 1);
        bool any = false;
        for (std::uint32_t k = 0; k < count; ++k) {
            const bool asked = is_slow(s_.bodies[s_.awake[k]]) && is_far(s_.awake[k]);
            found[k] = asked ? support::none : support::unasked;
            any = any || asked;
        }
        found[count] = support::unasked;
        if (!any || !(s_.settings.sleeping.time > S(0))) return nullptr;
        const double fast = to_double(s_.settings.sleeping.drift) / to_double(s_.settings.sleeping.time);
        for (const auto& c : s_.contacts) {
            const auto [a, b] = awake_pair(c);
            support &one = found[a < count ? a : count], &other = found[b < count ? b : count];
            if (one == support::unasked && other == support::unasked) continue;
            bool bears = false;
            for (int k = 0; k < c.count; ++k) bears = bears || c.points[k].normal_impulse > S(0);
            if (!bears) continue;
            const auto &of_a = s_.bodies[c.bodies.body_a], &of_b = s_.bodies[c.bodies.body_b];
            const auto apart = to_point(of_b.velocity.linear) - to_point(of_a.velocity.linear);
            const bool along = of_a.is_dynamic() && of_b.is_dynamic() && !(dot(apart, apart) > fast * fast);
            for (support* on : {&one, &other})
                if (*on != support::unasked) *on = along && *on != support::other ? support::carried : support::other;
        }
        return found;
    }
    static double square_of(const vec<S, D>& v) { return dot(to_point(v), to_point(v)); }
    static auto spin_squared(const vec<S, 3>& w) { return length_squared(w); }
    static auto spin_squared(S w) { return product(w, w); }

    [[nodiscard]] bool is_dynamic(std::uint32_t k) const { return k < count_ && s_.bodies[s_.awake[k]].is_dynamic(); }
    [[nodiscard]] body_pair awake_pair(const typename Plan::contact& c) const {
        return {s_.awake.index_of[c.bodies.body_a], s_.awake.index_of[c.bodies.body_b]};
    }
    [[nodiscard]] bool touch(const typename Plan::contact& c, S slack) const {
        return will_touch(c, s_.bodies[c.bodies.body_a].velocity, s_.bodies[c.bodies.body_b].velocity, step_, slack);
    }
    void add_to_island(std::uint32_t k, island& of) {
        const std::uint32_t i = s_.awake[k];
        of.is_still = of.is_still && s_.bodies[i].can_sleep && !(s_.sleep.sleep_time[i] < s_.settings.sleeping.time);
        if (const S from = s_.sleep.carried_from[i]; !(from < S(0))) {
            const double mass = to_double(s_.bodies[i].mass.mass);
            of.now += mass * square_of(s_.bodies[i].velocity.linear);
            of.before += mass * to_double(from);
        }
        of.is_stopped = of.is_stopped && s_.bodies[i].velocity == twist_of<S, D, Plan::rotates>{};
    }
    /// One of the two is not dynamic: it carries the island if it stands still, and keeps it awake if it moves.
    void add_support(std::uint32_t a, std::uint32_t b, island& of) {
        const std::uint32_t other = is_dynamic(a) ? b : a;
        const twist_of<S, D, Plan::rotates> sleep_time{};
        if (other < count_ && !(s_.bodies[s_.awake[other]].velocity == sleep_time)) of.is_still = false;
        else of.rests = true;
    }
    void fall_asleep(std::uint32_t i, island& of) {
        s_.bodies[i].velocity = {};
        if (of.first == no_sleeper) of.first = i;
        else s_.sleep.island_next[of.last] = i;
        of.last = i;
        s_.sleep.island_next[i] = of.first;
        reinsert_proxies(s_, i);
        s_.awake.is_stale = true;
    }
    void move_contacts_to_sleepers() {
        s_.step.new_contacts.clear();
        partition_contacts(
            s_.contacts, [&](const auto& c) { return !touches_no_awake_body(s_, c); },
            [&](const auto& c) { s_.step.new_contacts.push_back(c); });
        if (s_.sleep.contacts.empty()) s_.sleep.step = s_.step_lengths.usual;
        rescale_impulses(s_.step.new_contacts.begin(), s_.step.new_contacts.end(), s_.step_lengths,
                         {s_.sleep.step, s_.sleep.step});
        merge_contacts(s_.sleep.contacts, s_.step.new_contacts);
        if constexpr (Plan::remembers)
            s_.memories.drop([&](std::uint32_t shape) { return s_.is_asleep(s_.shapes[shape].body); });
    }

    state<Plan>& s_;
    S step_;
    std::uint32_t count_ = 0;
    island* island_ = nullptr;
};

}  // namespace detail

PHYSICS_HPP_END
