// Which islands fall asleep after a step.
#pragma once

#include "physics/step/sleep.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Notes how long each body has been still, and lets islands sleep that have been so for long enough and rest on
/// something, or do not move at all: a slow drift in free space goes on for ever. What lies on other bodies only may go
/// along with them: the upper rows of a large pile breathe by centimetres while no two that touch move against each
/// other. Then the island must have lost half of that energy since, so that what tips, or moves steadily, stays awake.
template <class Plan>
class sleep_judge {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

public:
    sleep_judge(const buffer<typename Plan::contact>& contacts, edge_range joints,
                const typename Plan::settings& settings, S h, const awake_list& awake,
                pool<typename Plan::body>& bodies, sleep_state<Plan>& sleep, arena& scratch)
        : contacts_(contacts),
          joints_(joints),
          settings_(settings),
          step_(h),
          awake_(awake),
          bodies_(bodies),
          sleep_(sleep),
          count_(awake.size()),
          parents_(scratch.template allocate<std::uint32_t>(count_)),
          island_(scratch.template allocate<island>(count_)),
          support_(scratch.template allocate<support>(count_ + 1)) {}

    /// Calls asleep(body) for those that fall asleep, once they are.
    template <class Asleep>
    void run(Asleep&& asleep) {
        if (!update_sleep_times()) return;
        disjoint_sets sets(count_, parents_);
        for (std::uint32_t k = 0; k < count_; ++k) new (island_ + k) island{};
        const S slack = gravity_slack(settings_.gravity, step_);
        each_edge(slack, [&](std::uint32_t a, std::uint32_t b, auto&& holds) {
            if (is_dynamic(a) && is_dynamic(b) && holds()) sets.unite(a, b);
        });
        for (std::uint32_t k = 0; k < count_; ++k)
            if (is_dynamic(k)) add_to_island(k, island_[sets.find(k)]);
        each_edge(slack, [&](std::uint32_t a, std::uint32_t b, auto&& holds) {
            if (is_dynamic(a) != is_dynamic(b) && holds()) add_support(a, b, island_[sets.find(is_dynamic(a) ? a : b)]);
        });
        for (std::uint32_t k = 0; k < count_; ++k) {
            if (!is_dynamic(k)) continue;
            island& of = island_[sets.find(k)];
            if (!of.is_still || !(of.rests || of.is_stopped) || of.now > 0.5 * of.before) continue;
            fall_asleep(awake_[k], of);
            asleep(awake_[k]);
        }
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
        const auto& with = settings_.sleeping;
        if (!with.enabled) return false;
        const auto fast = product(with.speed, with.speed), spinning = product(with.spin, with.spin),
                   far = product(with.drift, with.drift);
        const auto is_slow = [&](const auto& b) {
            return !(length_squared(b.velocity.linear) > fast || spin_squared(value_of(b.velocity.angular)) > spinning);
        };
        const auto is_far = [&](std::uint32_t i) {
            return length_squared(bodies_[i].center - sleep_.sleep_anchor[i]) > far;
        };
        const support* supports = find_supports(is_slow, is_far);
        bool any = false;
        for (std::uint32_t k = 0; k < awake_.size(); ++k) {
            const std::uint32_t i = awake_[k];
            const auto& b = bodies_[i];
            S &sleep_time = sleep_.sleep_time[i], &carried_from = sleep_.carried_from[i];
            const bool moved = is_far(i), is_carried = supports != nullptr && supports[k] == support::carried;
            if (!(sleep_time > S(0))) carried_from = S(-1);
            if (!is_slow(b) || !b.can_sleep || (moved && !is_carried)) sleep_time = S(0);
            else if (sleep_time < with.time) sleep_time += step_;
            if (!(sleep_time > S(0))) carried_from = S(-1);
            else if (moved && carried_from < S(0))
                carried_from =
                    static_cast<S>(min(square_of(b.velocity.linear), to_double(scalar_traits<S>::max()) / 2));
            if (moved || !(sleep_time > S(0))) sleep_.sleep_anchor[i] = b.center;
            any = any || (b.is_dynamic() && !(sleep_time < with.time));
        }
        return any;
    }
    /// What a slow body that has moved far lies on: nothing, other bodies that move as it does, or anything else.
    enum class support : std::uint8_t { unasked, none, carried, other };

    /// Of each body that moves; null if none of the slow ones has moved far.
    template <class IsSlow, class IsFar>
    const support* find_supports(IsSlow&& is_slow, IsFar&& is_far) {
        const std::uint32_t count = count_;
        support* const found = support_;
        bool any = false;
        for (std::uint32_t k = 0; k < count; ++k) {
            const bool asked = is_slow(bodies_[awake_[k]]) && is_far(awake_[k]);
            found[k] = asked ? support::none : support::unasked;
            any = any || asked;
        }
        found[count] = support::unasked;
        if (!any || !(settings_.sleeping.time > S(0))) return nullptr;
        const double fast = to_double(settings_.sleeping.drift) / to_double(settings_.sleeping.time);
        for (const auto& c : contacts_) {
            const auto [a, b] = awake_pair(c.bodies);
            support &one = found[a < count ? a : count], &other = found[b < count ? b : count];
            if (one == support::unasked && other == support::unasked) continue;
            bool bears = false;
            for (int k = 0; k < c.count; ++k) bears = bears || c.points[k].normal_impulse > S(0);
            if (!bears) continue;
            const auto &of_a = bodies_[c.bodies.body_a], &of_b = bodies_[c.bodies.body_b];
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

    [[nodiscard]] bool is_dynamic(std::uint32_t k) const { return k < count_ && bodies_[awake_[k]].is_dynamic(); }
    [[nodiscard]] body_pair awake_pair(const edge& e) const {
        return {awake_.index_of[e.body_a], awake_.index_of[e.body_b]};
    }
    /// Calls f(a, b, holds) with the numbers among awake bodies of what contacts and joints may hold together.
    template <class F>
    void each_edge(S slack, F&& f) const {
        for (const auto& c : contacts_) {
            const auto [a, b] = awake_pair(c.bodies);
            f(a, b, [&] { return touch(c, slack); });
        }
        if constexpr (Plan::has_joints)
            for (const edge& e : joints_) {
                const auto [a, b] = awake_pair(e);
                f(a, b, [] { return true; });
            }
    }
    [[nodiscard]] bool touch(const typename Plan::contact& c, S slack) const {
        return will_touch(c, bodies_[c.bodies.body_a].velocity, bodies_[c.bodies.body_b].velocity, step_, slack);
    }
    void add_to_island(std::uint32_t k, island& of) {
        const std::uint32_t i = awake_[k];
        of.is_still = of.is_still && bodies_[i].can_sleep && !(sleep_.sleep_time[i] < settings_.sleeping.time);
        if (const S from = sleep_.carried_from[i]; !(from < S(0))) {
            const double mass = to_double(bodies_[i].mass.mass);
            of.now += mass * square_of(bodies_[i].velocity.linear);
            of.before += mass * to_double(from);
        }
        of.is_stopped = of.is_stopped && bodies_[i].velocity == twist_of<S, D, Plan::rotates>{};
    }
    /// One of the two is not dynamic: it carries the island if it stands still, and keeps it awake if it moves.
    void add_support(std::uint32_t a, std::uint32_t b, island& of) {
        const std::uint32_t other = is_dynamic(a) ? b : a;
        const twist_of<S, D, Plan::rotates> sleep_time{};
        if (other < count_ && !(bodies_[awake_[other]].velocity == sleep_time)) of.is_still = false;
        else of.rests = true;
    }
    void fall_asleep(std::uint32_t i, island& of) {
        bodies_[i].velocity = {};
        if (!sleep_.is_asleep(i)) ++sleep_.sleepers;
        if (of.first == no_sleeper) of.first = i;
        else sleep_.island_next[of.last] = i;
        of.last = i;
        sleep_.island_next[i] = of.first;
    }

    const buffer<typename Plan::contact>& contacts_;
    edge_range joints_;
    const typename Plan::settings& settings_;
    S step_;
    const awake_list& awake_;
    pool<typename Plan::body>& bodies_;
    sleep_state<Plan>& sleep_;
    std::uint32_t count_;
    // Taken before anything changes, so that nothing fails later.
    std::uint32_t* parents_;
    island* island_;
    support* support_;
};

struct no_sleep_judge {};
/// With the memory that it needs.
template <class Plan>
auto make_sleep_judge([[maybe_unused]] const buffer<typename Plan::contact>& contacts,
                      [[maybe_unused]] edge_range joints, [[maybe_unused]] const typename Plan::settings& settings,
                      [[maybe_unused]] typename Plan::scalar h, [[maybe_unused]] const awake_list& awake,
                      [[maybe_unused]] pool<typename Plan::body>& bodies, [[maybe_unused]] sleep_of<Plan>& sleep,
                      [[maybe_unused]] arena& scratch) {
    if constexpr (Plan::sleeps) return sleep_judge<Plan>(contacts, joints, settings, h, awake, bodies, sleep, scratch);
    else return no_sleep_judge{};
}
/// The step's contacts and joints, and how bodies move -> which of them sleep. True if any have fallen asleep. O(bodies
/// + contacts).
template <class Plan>
bool fall_asleep(sleep_judge<Plan>& judge, const typename Plan::settings& settings, const shape_pool<Plan>& shapes,
                 awake_list& awake, pool<typename Plan::body>& bodies, sleep_state<Plan>& sleep,
                 typename Plan::broadphase& broadphase) {
    bool any = false;
    judge.run([&](std::uint32_t i) {
        reinsert_proxies<Plan>(bodies, shapes, sleep, settings.contact_margin, broadphase, i);
        if constexpr (Plan::events::sleep) sleep.changes.slept.push_back({i, bodies.generation(i), 0});
        any = true;
    });
    if (any) awake.is_stale = true;
    return any;
}

/// Hands contacts of which no body that can be pushed is awake any more to the sleeping islands.
template <class Plan>
void move_contacts_to_sleepers(const pool<typename Plan::body>& bodies,
                               const step_lengths<typename Plan::scalar>& lengths,
                               buffer<typename Plan::contact>& contacts, sleep_state<Plan>& sleep,
                               buffer<typename Plan::contact>& moved) {
    moved.clear();
    partition_contacts(
        contacts, [&](const auto& c) { return can_be_pushed(c, bodies, sleep); },
        [&](const auto& c) { moved.push_back(c); });
    if (sleep.contacts.empty()) sleep.step = lengths.usual;
    rescale_impulses(moved.begin(), moved.end(), lengths, {sleep.step, sleep.step});
    merge_contacts(sleep.contacts, moved);
}

}  // namespace detail

PHYSICS_HPP_END
