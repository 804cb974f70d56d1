// Which shapes touch as a step ends, and what it tells of that.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/step/events.hpp"
#include "physics/step/sleep.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Shapes touch whose contact has pressed in the step, and those that are so close, in contact margins, as it ends.
/// Those that touched before do so until they are farther apart: contacts that tremble tell nothing.
inline constexpr double touch_margin = 1.0 / 20, release_margin = 1.0 / 4;

/// Of each point of a contact a bit: whether it has pressed.
template <class S, int D, class Features>
unsigned pressed_points(const contact<S, D, Features>& c) {
    unsigned pressed = 0;
    for (int k = 0; k < c.count; ++k) pressed |= unsigned{c.points[k].normal_impulse > S(0)} << k;
    return pressed;
}

/// The ids, the bodies and the user data of two shapes.
template <class Event, class Plan>
Event event_of(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes, proxy_pair p) {
    const std::uint32_t a = shapes[p.a].body, b = shapes[p.b].body;
    Event e;
    e.shape_a = {p.a, shapes.generation(p.a), 0};
    e.shape_b = {p.b, shapes.generation(p.b), 0};
    e.body_a = {a, bodies.generation(a), 0};
    e.body_b = {b, bodies.generation(b), 0};
    if constexpr (requires { e.shape_data_a; }) {
        e.shape_data_a = shapes[p.a].user_data;
        e.shape_data_b = shapes[p.b].user_data;
        e.body_data_a = bodies[a].user_data;
        e.body_data_b = bodies[b].user_data;
    }
    return e;
}
inline proxy_pair key_of(const contact_event& e) { return {e.shape_a.index, e.shape_b.index}; }
/// Notes a contact that goes by what a user does.
template <class Plan>
void note_dropped(const typename Plan::contact& c, const pool<typename Plan::body>& bodies,
                  const shape_pool<Plan>& shapes, buffer<contact_event>& to) {
    if (!c.touching) return;
    // Of several contacts of a pair, which follow each other, one.
    if (!to.empty() && key_of(to.back()) == c.key()) return;
    to.push_back(event_of<contact_event, Plan>(bodies, shapes, c.key()));
}

/// What touching is told from.
template <class Plan>
struct touch_input {
    using S = typename Plan::scalar;

    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const awake_list& awake;
    const sleep_of<Plan>& sleep;
    /// The last step's.
    const buffer<typename Plan::contact>& before;
    const buffer<std::uint32_t>& woken;
    S margin, h;
    std::uint16_t tag;
};

/// Bodies as they were and as they have moved, the contacts of the step -> which of these touch; pairs that have begun
/// to and have ceased to, hits.
template <class Plan, class Moved>
class touch_events {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using contact = typename Plan::contact;

public:
    touch_events(const touch_input<Plan>& in, const Moved& moved, step_events<S, D>& to)
        : in_(in), moved_(moved), to_(to) {}
    touch_events(const touch_events&) = delete;
    touch_events& operator=(const touch_events&) = delete;
    /// Of a step that fails nothing is told, and the pairs are listed anew.
    ~touch_events() {
        if (!is_kept_) to_.forget();
    }

    void find_touching(buffer<contact_event>& dropped, buffer<contact>& contacts) {
        auto &before = to_.touching, &now = to_.now_touching;
        if (to_.is_stale) list_touching(dropped);
        add_woken();
        to_.contact_begin.clear();
        to_.contact_end.clear();
        sort_in_place(dropped.begin(), dropped.size(),
                      [](const contact_event& x, const contact_event& y) { return key_of(x) < key_of(y); });
        for (contact_event& e : dropped) {
            e.gone = !in_.shapes.contains(e.shape_a.index, e.shape_a.generation) ||
                     !in_.shapes.contains(e.shape_b.index, e.shape_b.generation);
            // Another shape may bear its number by now.
            if (e.gone) to_.contact_end.push_back(e);
        }
        if (!to_.contact_end.empty()) forget_gone(before);
        mark_touching(before, contacts, now);
        if (now.size() != before.size() ||
            (now.size() > 0 && std::memcmp(now.begin(), before.begin(), now.size() * sizeof(proxy_pair)) != 0))
            compare(before, now, dropped);
        for (auto* events : {&to_.contact_begin, &to_.contact_end})
            for (contact_event& e : *events) set_tags(e);
    }
    /// The step has succeeded.
    void keep(buffer<contact_event>& dropped) {
        keep();
        to_.touching.swap(to_.now_touching);
        dropped.clear();
        to_.is_stale = false;
    }
    void keep() { is_kept_ = true; }

    void find_hits(const buffer<contact>& contacts, S threshold) {
        to_.hits.clear();
        for (std::uint32_t i = 0; i < contacts.size(); ++i) {
            if (new_loads(contacts[i]) == 0) continue;
            const proxy_pair pair = contacts[i].key();
            while (i > 0 && contacts[i - 1].key() == pair) --i;
            auto hit = event_of<hit_event<S, D>, Plan>(in_.bodies, in_.shapes, pair);
            hit.approach_speed = threshold;
            bool is_fast = false;
            for (;; ++i) {
                is_fast = take_fastest(contacts[i], hit) || is_fast;
                for (int k = 0; k < contacts[i].count; ++k) hit.impulse += contacts[i].points[k].normal_impulse;
                if (i + 1 == contacts.size() || !(contacts[i + 1].key() == pair)) break;
            }
            if (!is_fast) continue;
            set_tags(hit);
            to_.hits.push_back(hit);
        }
    }

private:
    template <class Event>
    void set_tags(Event& e) const {
        e.shape_a.world = e.shape_b.world = e.body_a.world = e.body_b.world = in_.tag;
    }
    static bool is_less(proxy_pair x, proxy_pair y) { return x < y; }
    static void add(buffer<proxy_pair>& to, proxy_pair pair) {
        if (to.empty() || !(to.back() == pair)) to.push_back(pair);
    }
    static void sort(buffer<proxy_pair>& pairs) {
        sort_in_place(pairs.begin(), pairs.size(), is_less);
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < pairs.size(); ++i)
            if (kept == 0 || !(pairs[kept - 1] == pairs[i])) pairs[kept++] = pairs[i];
        pairs.resize(kept);
    }

    void list_touching(const buffer<contact_event>& dropped) {
        auto& before = to_.touching;
        before.clear();
        for (const contact& c : in_.before)
            if (c.touching) add(before, c.key());
        if (dropped.empty()) return;
        for (const contact_event& e : dropped) before.push_back(key_of(e));
        sort(before);
    }
    /// Those of islands that this step has woken.
    void add_woken() {
        if constexpr (Plan::sleeps) {
            if (in_.woken.empty()) return;
            const auto is_woken = [&](std::uint32_t i) { return in_.bodies[i].is_dynamic() && in_.awake.has(i); };
            for (const contact& c : in_.sleep.contacts)
                if (c.touching && (is_woken(c.bodies.body_a) || is_woken(c.bodies.body_b)))
                    to_.touching.push_back(c.key());
            sort(to_.touching);
        }
    }
    void forget_gone(buffer<proxy_pair>& before) const {
        std::uint32_t kept = 0, gone = 0;
        for (const proxy_pair p : before) {
            while (gone < to_.contact_end.size() && key_of(to_.contact_end[gone]) < p) ++gone;
            if (gone < to_.contact_end.size() && key_of(to_.contact_end[gone]) == p) continue;
            before[kept++] = p;
        }
        before.resize(kept);
    }

    void mark_touching(const buffer<proxy_pair>& before, buffer<contact>& contacts, buffer<proxy_pair>& now) const {
        now.clear();
        std::uint32_t at = 0;
        for (contact& c : contacts) {
            const proxy_pair pair = c.key();
            while (at < before.size() && before[at] < pair) ++at;
            const bool touched = at < before.size() && before[at] == pair;
            c.touching = pressed_points(c) != 0 || is_close(c, in_.margin * S(touched ? release_margin : touch_margin));
            if (c.touching) add(now, pair);
        }
    }
    [[nodiscard]] bool is_close(const contact& c, S within) const {
        for (int k = 0; k < c.count; ++k) {
            const auto [a, b] = c.anchors(k);
            const vec<S, D> apart = displacement(c.bodies.body_b, b) - displacement(c.bodies.body_a, a);
            if (c.points[k].separation + dot(c.normal, apart) <= within) return true;
        }
        return false;
    }
    /// How far a point of a body has come in the step, of where it was from the centre.
    [[nodiscard]] vec<S, D> displacement(std::uint32_t body, const vec<S, D>& from) const {
        const std::uint32_t k = in_.awake.index_of[body];
        if (!(k < in_.awake.size())) return {};
        const auto& b = in_.bodies[body];
        vec<S, D> by = moved_[k].center - b.center;
        if constexpr (Plan::rotates) by += moved_[k].rotation * inverse_rotate(b.rotation, from) - from;
        return by;
    }

    /// What of two ascending lists is in one of them only.
    void compare(const buffer<proxy_pair>& before, const buffer<proxy_pair>& now,
                 const buffer<contact_event>& dropped) {
        const bool any_gone = !to_.contact_end.empty();
        std::uint32_t i = 0, k = 0, known = 0;
        while (i < before.size() || k < now.size()) {
            if (i < before.size() && k < now.size() && before[i] == now[k]) {
                ++i, ++k;
            } else if (k == now.size() || (i < before.size() && before[i] < now[k])) {
                const proxy_pair pair = before[i++];
                while (known < dropped.size() && key_of(dropped[known]) < pair) ++known;
                const bool is_known = known < dropped.size() && key_of(dropped[known]) == pair;
                to_.contact_end.push_back(is_known ? dropped[known]
                                                   : event_of<contact_event, Plan>(in_.bodies, in_.shapes, pair));
            } else {
                to_.contact_begin.push_back(event_of<contact_event, Plan>(in_.bodies, in_.shapes, now[k++]));
            }
        }
        if (any_gone)
            sort_in_place(to_.contact_end.begin(), to_.contact_end.size(),
                          [](const contact_event& x, const contact_event& y) { return key_of(x) < key_of(y); });
    }

    /// Of each point a bit: whether it has pressed in this step, but bore nothing before.
    [[nodiscard]] static unsigned new_loads(const contact& c) { return pressed_points(c) & ~unsigned{c.loaded_mask}; }
    /// Describes a hit by the point of new load at which the shapes approach each other faster than it says.
    bool take_fastest(const contact& c, hit_event<S, D>& hit) const {
        const unsigned loads = new_loads(c);
        bool found = false;
        for (int k = 0; k < c.count; ++k) {
            if ((loads >> k & 1) == 0) continue;
            const auto [a, b] = c.anchors(k);
            const S speed = dot(c.normal, velocity_at(c.bodies.body_a, a) - velocity_at(c.bodies.body_b, b));
            if (!(speed > hit.approach_speed)) continue;
            found = true;
            hit.approach_speed = speed;
            hit.point = in_.bodies[c.bodies.body_a].center + a;
            hit.normal = c.shape_a < c.shape_b ? c.normal : -c.normal;
        }
        return found;
    }
    /// As the step began.
    [[nodiscard]] vec<S, D> velocity_at(std::uint32_t body, const vec<S, D>& from) const {
        const auto v = in_.bodies[body].velocity_ahead(in_.h);
        if constexpr (Plan::rotates) return v.linear + cross(v.angular, from);
        else return v.linear;
    }

    const touch_input<Plan>& in_;
    const Moved& moved_;
    step_events<S, D>& to_;
    bool is_kept_ = false;
};

/// Notes which points bear something as a step begins, by what they have inherited.
template <class S, int D, class Features>
void note_loads(contact<S, D, Features>* first, const contact<S, D, Features>* end) {
    for (; first != end; ++first)
        first->loaded_mask = static_cast<std::uint8_t>(pressed_points(*first) & first->persisted_mask);
}

}  // namespace detail

PHYSICS_HPP_END
