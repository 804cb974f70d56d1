// Sleep: islands that are still leave the step until something happens to them.
#pragma once

#include "physics/world/queries.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Keeps, in order, the contacts for which stays(contact) is true, and hands the others to out.
template <class Contacts, class Stays, class Out>
void part_contacts(Contacts& contacts, Stays&& stays, Out&& out) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (!stays(contacts[i])) {
            out(contacts[i]);
            continue;
        }
        if (kept != i) contacts[kept] = contacts[i];
        ++kept;
    }
    while (contacts.size() > kept) contacts.pop();
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
        const std::uint32_t next = s.sleep.ring[i];
        f(i);
        i = next;
    } while (i != body);
}

/// Brings bodies back that were asleep, listed in s.sleep.woken: they can be pushed again, and what touches them is
/// looked at again.
template <class Plan>
void rise(state<Plan>& s) {
    for (const std::uint32_t i : s.sleep.woken) {
        s.sleep.ring[i] = no_sleeper;
        s.sleep.still[i] = {};
        refile_proxies(s, i);
    }
    if (!s.sleep.woken.empty()) s.movers_changed = true;
    s.sleep.woken.clear();
}
/// Whether nobody who can be pushed and is awake has a part in a contact.
template <class Plan, class Contact>
bool is_of_sleepers(const state<Plan>& s, const Contact& c) {
    return !s.is_awake_dynamic(body_a(s, c)) && !s.is_awake_dynamic(body_b(s, c));
}
/// Wakes the islands of those that each(f) calls f(body) for, at once, with their contacts. O(contacts of sleepers).
template <class Plan, class Each>
void wake_islands(state<Plan>& s, Each&& each) {
    // A step that was refused may have left its list.
    s.sleep.woken.clear();
    bool any = false;
    each([&](std::uint32_t body) {
        if (!s.is_asleep(body)) return;
        any = true;
        each_of_island(s, body, [&](std::uint32_t i) { s.sleep.woken.push(i); });
        rise(s);
    });
    if (!any) return;
    s.found.clear();
    part_contacts(
        s.sleep.contacts, [&](const auto& c) { return is_of_sleepers(s, c); }, [&](const auto& c) { s.found.push(c); });
    stretch(s.found.begin(), s.found.end(), s.sleep.step, s.last_step);
    merge_contacts(s.contacts, s.found);
}
template <class Plan>
void wake(state<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) wake_islands(s, [&](auto&& f) { f(body); });
}
/// Wakes those that touch a body.
template <class Plan>
void wake_touching(state<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) {
        auto& touching = s.sleep.near;
        touching.clear();
        for (const auto& c : s.sleep.contacts) {
            if (body_a(s, c) == body) touching.push(body_b(s, c));
            if (body_b(s, c) == body) touching.push(body_a(s, c));
        }
        wake_islands(s, [&](auto&& f) {
            for (const std::uint32_t i : touching) f(i);
        });
    }
}
/// Something happens to a body: it wakes, or those that lie on it if it never sleeps.
template <class Plan>
void rouse(state<Plan>& s, std::uint32_t body) {
    if (s.bodies[body].is_dynamic()) wake(s, body);
    else wake_touching(s, body);
}
/// Wakes those that lie where a body is, or on its way to another pose.
template <class Plan>
void rouse_near(state<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps) {
        auto& near = s.sleep.near;
        near.clear();
        each_shape(s, body, [&](std::uint32_t, const auto& shape) {
            const auto box = merged(needed_box(s, shape), bounds(shape.shape, to * shape.local));
            each_near(s, box, query_filter{}, [&](std::uint32_t other) {
                if (s.is_asleep(s.shapes[other].body)) near.push(s.shapes[other].body);
                return true;
            });
        });
        wake_islands(s, [&](auto&& f) {
            for (const std::uint32_t i : near) f(i);
        });
    }
}
template <class Plan>
void rouse_near(state<Plan>& s, std::uint32_t body) {
    rouse_near(s, body, s.bodies[body].pose());
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
auto pull_of(const state<Plan>& s, typename Plan::scalar h) {
    return length(s.settings.gravity) * h * h;
}

/// Lists the sleepers that something comes to touch in this step, with their islands, among those that move; they rise
/// when the step has succeeded. True if there are any; if nobody who is awake is near one, there are none.
template <class Plan>
bool disturb_sleepers(state<Plan>& s, bool any_near, typename Plan::scalar h) {
    s.sleep.woken.clear();
    if (!any_near) return false;
    const auto slack = pull_of(s, h);
    for (const auto& c : s.found) {
        const std::uint32_t a = body_a(s, c), b = body_b(s, c);
        const bool of_a = s.is_asleep(a);
        if (of_a == s.is_asleep(b)) continue;
        const std::uint32_t sleeper = of_a ? a : b;
        if (s.mover_of[sleeper] < s.movers.size() ||
            !comes_to_touch(c, s.bodies[a].velocity_ahead(h), s.bodies[b].velocity_ahead(h), h, slack))
            continue;
        each_of_island(s, sleeper, [&](std::uint32_t i) {
            s.mover_of[i] = 0;
            s.sleep.woken.push(i);
        });
    }
    if (s.sleep.woken.empty()) return false;
    for (const std::uint32_t i : s.sleep.woken) s.movers.push(i);
    s.movers_changed = true;
    return true;
}

/// The step has succeeded: they are awake for good.
template <class Plan>
void wake_disturbed(state<Plan>& s) {
    if (s.sleep.woken.empty()) return;
    rise(s);
    part_contacts(
        s.sleep.contacts, [&](const auto& c) { return is_of_sleepers(s, c); }, [](const auto&) {});
}

/// Notes how long each body has been still, and lets islands sleep that have been so for long enough and rest on
/// something, or do not move at all: a slow drift in free space goes on for ever.
template <class Plan>
class falling_asleep {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    falling_asleep(state<Plan>& s, S h) : s_(s), step_(h) {
        if (!note_stillness()) return;
        count_ = s.movers.size();
        disjoint_sets sets(count_, s.scratch);
        island_ = s.scratch.template take<island>(count_);
        for (std::uint32_t k = 0; k < count_; ++k) new (island_ + k) island{};
        const S slack = pull_of(s, h);
        for (const auto& c : s.contacts) {
            const auto [a, b] = movers_of(c);
            if (is_dynamic(a) && is_dynamic(b) && touch(c, slack)) sets.unite(a, b);
        }
        for (std::uint32_t k = 0; k < count_; ++k)
            if (is_dynamic(k)) judge(k, island_[sets.find(k)]);
        for (const auto& c : s.contacts) {
            const auto [a, b] = movers_of(c);
            if (is_dynamic(a) != is_dynamic(b) && touch(c, slack))
                support(a, b, island_[sets.find(is_dynamic(a) ? a : b)]);
        }
        bool any = false;
        for (std::uint32_t k = 0; k < count_; ++k) {
            if (!is_dynamic(k)) continue;
            island& of = island_[sets.find(k)];
            if (!of.is_still || !(of.rests || of.is_stopped)) continue;
            fall_asleep(s.movers[k], of);
            any = true;
        }
        if (any) take_contacts();
    }

private:
    struct island {
        bool is_still = true, is_stopped = true, rests = false;
        std::uint32_t first = no_sleeper, last = no_sleeper;
    };

    /// True if any body has been still for long enough.
    bool note_stillness() {
        const auto& with = s_.settings.sleeping;
        if (!with.enabled) return false;
        const auto fast = product(with.speed, with.speed), twirling = product(with.spin, with.spin),
                   far = product(with.drift, with.drift);
        bool any = false;
        for (const std::uint32_t i : s_.movers) {
            const auto& b = s_.bodies[i];
            S& still = s_.sleep.still[i];
            const bool moves = length_squared(b.velocity.linear) > fast ||
                               spin_squared(value_of(b.velocity.angular)) > twirling ||
                               length_squared(b.center - s_.sleep.since[i]) > far;
            if (moves || !b.can_sleep) {
                still = S(0);
                s_.sleep.since[i] = b.center;
            } else if (still < with.time) {
                still += step_;
            }
            any = any || (b.is_dynamic() && !(still < with.time));
        }
        return any;
    }
    static auto spin_squared(const vec<S, 3>& w) { return length_squared(w); }
    static auto spin_squared(S w) { return product(w, w); }

    [[nodiscard]] bool is_dynamic(std::uint32_t k) const { return k < count_ && s_.bodies[s_.movers[k]].is_dynamic(); }
    struct sides {
        std::uint32_t a, b;
    };
    [[nodiscard]] sides movers_of(const typename Plan::contact& c) const {
        return {s_.mover_of[body_a(s_, c)], s_.mover_of[body_b(s_, c)]};
    }
    [[nodiscard]] bool touch(const typename Plan::contact& c, S slack) const {
        return comes_to_touch(c, s_.bodies[body_a(s_, c)].velocity, s_.bodies[body_b(s_, c)].velocity, step_, slack);
    }
    void judge(std::uint32_t k, island& of) {
        const std::uint32_t i = s_.movers[k];
        of.is_still = of.is_still && s_.bodies[i].can_sleep && !(s_.sleep.still[i] < s_.settings.sleeping.time);
        of.is_stopped = of.is_stopped && s_.bodies[i].velocity == twist_of<S, D, Plan::turns>{};
    }
    /// One of the two is not dynamic: it carries the island if it stands still, and keeps it awake if it moves.
    void support(std::uint32_t a, std::uint32_t b, island& of) {
        const std::uint32_t other = is_dynamic(a) ? b : a;
        const twist_of<S, D, Plan::turns> still{};
        if (other < count_ && !(s_.bodies[s_.movers[other]].velocity == still)) of.is_still = false;
        else of.rests = true;
    }
    void fall_asleep(std::uint32_t i, island& of) {
        s_.bodies[i].velocity = {};
        if (of.first == no_sleeper) of.first = i;
        else s_.sleep.ring[of.last] = i;
        of.last = i;
        s_.sleep.ring[i] = of.first;
        refile_proxies(s_, i);
        s_.movers_changed = true;
    }
    void take_contacts() {
        s_.found.clear();
        part_contacts(
            s_.contacts, [&](const auto& c) { return !is_of_sleepers(s_, c); },
            [&](const auto& c) { s_.found.push(c); });
        if (s_.sleep.contacts.empty()) s_.sleep.step = step_;
        stretch(s_.found.begin(), s_.found.end(), step_, s_.sleep.step);
        merge_contacts(s_.sleep.contacts, s_.found);
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
