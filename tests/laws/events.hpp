// Events of contacts and of sleep, and the contacts of a body: against a model that is told nothing but them.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace events_laws {

struct eventful : physics::recipe<S, cell::dimension,
                                  physics::shapes<physics::ball, physics::box, physics::halfspace, physics::compound>,
                                  physics::events<physics::event::contact, physics::event::hit, physics::event::sensor,
                                                  physics::event::sleep, physics::event::move>> {};
struct silent : physics::recipe<S, cell::dimension,
                                physics::shapes<physics::ball, physics::box, physics::halfspace, physics::compound>> {};
using world = physics::world<eventful>;
using snapshot = physics::detail::raw_snapshot<physics::detail::plan_of<eventful>::type>;
using contact_list = std::vector<physics::contact_event>;
using pair = std::pair<shape_id, shape_id>;

template <class World>
body_id add_floor(World& w) {
    const body_id floor = w.create_body({.type = body_type::static_body});
    w.create_shape(floor, typename World::halfspace{});
    return floor;
}
template <class World>
body_id add(World& w, vec position, double radius = 0.5, double restitution = 0) {
    const body_id b = w.create_body({.position = position});
    w.create_shape(b, typename World::ball{S(radius)}, {.material = {.restitution = S(restitution)}});
    return b;
}
template <class Shape>
bool is_ordered(const Shape& x, const Shape& y) {
    return std::pair(x.shape_a.index, x.shape_b.index) < std::pair(y.shape_a.index, y.shape_b.index);
}

/// Which pairs touch and which bodies sleep, as far as events have told.
struct listener {
    std::map<pair, std::pair<std::uint64_t, std::uint64_t>> touching;
    std::set<body_id> asleep;
    int begins = 0, ends = 0, gone = 0;

    void hear(const world& w) {
        const auto &begin = w.contact_begin_events(), &end = w.contact_end_events();
        CHECK(std::is_sorted(begin.begin(), begin.end(), is_ordered<physics::contact_event>));
        CHECK(std::is_sorted(end.begin(), end.end(), is_ordered<physics::contact_event>));
        for (const auto& e : end) {
            CHECK(e.shape_a.index < e.shape_b.index);
            const auto known = touching.find({e.shape_a, e.shape_b});
            REQUIRE(known != touching.end());
            CHECK(known->second == std::pair(e.shape_data_a, e.shape_data_b));
            CHECK(e.gone == !(w.contains(e.shape_a) && w.contains(e.shape_b)));
            gone += e.gone;
            touching.erase(known);
            ++ends;
        }
        for (const auto& e : begin) {
            CHECK(e.shape_a.index < e.shape_b.index);
            CHECK(w.body(e.shape_a) == e.body_a);
            CHECK(w.body(e.shape_b) == e.body_b);
            CHECK(e.body_data_a == w.user_data(e.body_a));
            CHECK(!e.gone);
            CHECK(touching.try_emplace({e.shape_a, e.shape_b}, e.shape_data_a, e.shape_data_b).second);
            ++begins;
        }
        // In the order in which they may have come: what has woken may have fallen asleep since.
        for (const body_id b : w.wake_events()) asleep.erase(b);
        for (const body_id b : w.sleep_events()) asleep.insert(b);
    }
};
/// How far apart the surfaces of a contact are now, of the nearest of its points.
double gap_of(const world& w, const world::contact_view& c) {
    double nearest = 1e9;
    for (int k = 0; k < c.count; ++k) {
        const auto& p = c.points[k];
        const vec a = w.pose(c.body_a) * p.local_a, b = w.pose(c.body_b) * p.local_b;
        nearest = std::min(nearest, number(p.separation) + number(dot(c.normal, b - a)));
    }
    return nearest;
}
bool is_pressed(const world::contact_view& c) { return c.normal_impulse() > S(0); }

/// The world says what events have told, and touching is by the rule: `before` is what touched before the step.
template <class Known>
void check_touching(const world& w, const listener& told, const Known& before) {
    std::set<pair> touching;
    for (const auto& c : w.contacts()) {
        const pair key = c.shape_a < c.shape_b ? pair{c.shape_a, c.shape_b} : pair{c.shape_b, c.shape_a};
        if (c.touching) touching.insert(key);
        // Contacts of sleepers are as they were.
        if (w.is_asleep(c.body_a) || w.is_asleep(c.body_b)) continue;
        const double within = number(w.settings().contact_margin) / (before.count(key) ? 4 : 20), now = gap_of(w, c);
        if (is_pressed(c)) CHECK(c.touching);
        else if (std::abs(now - within) > rounding(64, 8)) CHECK(c.touching == now < within);
    }
    std::set<pair> expected;
    for (const auto& known : told.touching) expected.insert(known.first);
    CHECK(touching == expected);
}

/// Balls, boxes and compounds that fall into a heap, and are moved, changed and destroyed.
struct crowd {
    world w;
    listener told;
    std::vector<body_id> bodies;
    std::uint64_t next_data = 1;
    int moved = 0;

    crowd() { bodies.push_back(add_floor(w)); }
    void add_shape(body_id b, cell::dice& dice) {
        const vec local = dice.vec<vec>(-0.25, 0.25);
        if (dice.below(2)) w.create_shape(b, world::ball{S(0.3)}, {.position = local, .user_data = next_data++});
        else w.create_shape(b, world::box{vec::filled(S(0.25))}, {.position = local, .user_data = next_data++});
    }
    body_id any(cell::dice& dice) const {
        return bodies[static_cast<std::size_t>(dice.below(static_cast<int>(bodies.size())))];
    }
    void change(cell::dice& dice) {
        const int what = dice.below(18);
        if (bodies.size() < 4 || what < 5) {
            vec where = dice.vec<vec>(-1, 1);
            where.y = S(dice.number(0, 2.5));
            bodies.push_back(w.create_body({.position = where, .user_data = next_data++}));
            for (int k = dice.below(2); k >= 0; --k) add_shape(bodies.back(), dice);
            return;
        }
        const body_id b = any(dice);
        if (b == bodies[0]) return;
        if (what < 8) {
            w.destroy_body(b);
            bodies.erase(std::find(bodies.begin(), bodies.end(), b));
        } else if (what == 8) {
            if (w.shapes(b).begin() != w.shapes(b).end()) w.destroy_shape(*w.shapes(b).begin());
            add_shape(b, dice);
        } else if (what == 9) {
            // Away and back, or by less than a step goes.
            const auto pose = w.pose(b);
            w.set_pose(b, pose.position + along(0, dice.number(-0.01, 0.01)), pose.rotation);
        } else if (what == 10) {
            w.set_pose(b, dice.vec<vec>(-2, 2), {});
        } else if (what == 11) {
            w.set_type(b, static_cast<body_type>(dice.below(3)));
        } else if (what == 12) {
            for (const shape_id s : w.shapes(b)) w.set_filter(s, {.mask = dice.below(2) ? 0u : 1u});
        } else if (what == 13) {
            w.set_can_sleep(b, dice.below(2) == 0);
        } else if (what == 14) {
            w.wake(b);
        } else if (what > 15) {
            w.set_enabled(b, !w.enabled(b));
        } else if (w.type(b) == body_type::dynamic_body && w.enabled(b)) {
            w.apply_impulse(b, dice.vec<vec>(-1, 1));
        }
    }
    /// Moved is what is elsewhere than before.
    void step() {
        const auto before = told.touching;
        std::map<body_id, world::transform> poses;
        for (const body_id b : w.bodies()) poses[b] = w.pose(b);
        w.step(S(1.0 / 64));
        told.hear(w);
        check_touching(w, told, before);
        const auto& moves = w.move_events();
        CHECK(std::is_sorted(moves.begin(), moves.end(), [](const auto& x, const auto& y) { return x.body < y.body; }));
        for (const auto& e : moves) {
            CHECK(w.user_data(e.body) == e.user_data);
            CHECK(w.is_asleep(e.body) == e.fell_asleep);
            // A centre may move by less than a pose shows.
            moved += poses.erase(e.body) == 1 && !w.is_asleep(e.body);
        }
        for (const auto& [b, pose] : poses) CHECK(w.pose(b) == pose);
        std::set<body_id> asleep;
        for (const body_id b : w.bodies())
            if (w.is_asleep(b)) asleep.insert(b);
        for (auto b = told.asleep.begin(); b != told.asleep.end();)
            b = w.contains(*b) ? std::next(b) : told.asleep.erase(b);
        CHECK(told.asleep == asleep);
    }
};
CELL_CASE("events: each begin has one end, and what touches is what they tell, whatever changes") {
    int begins = 0, gone = 0, slept = 0, moved = 0;
    for (int seed = 0; seed < 16; ++seed) {
        cell::dice dice(static_cast<std::uint64_t>(7100 + seed));
        crowd t;
        for (int i = 0; i < 240; ++i) {
            if (i < 60 || i % 48 == 0)
                for (int k = dice.below(5); k > 0; --k) t.change(dice);
            t.step();
            slept += static_cast<int>(t.w.sleep_events().size());
        }
        t.w.clear();
        t.step();
        CHECK(t.told.touching.empty());
        CHECK(t.told.begins == t.told.ends);
        moved += t.moved;
        begins += t.told.begins;
        gone += t.told.gone;
    }
    CHECK(begins > 400);
    CHECK(moved > 1000);
    CHECK(gone > 100);
    CHECK(slept > 12);
}

bool same(const contact_list& x, const physics::buffer<physics::contact_event>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const auto& a, const auto& b) {
        const auto is = [](auto p, auto q) { return p.index == q.index && p.generation == q.generation; };
        return is(a.shape_a, b.shape_a) && is(a.shape_b, b.shape_b) && is(a.body_a, b.body_a) &&
               is(a.body_b, b.body_b) && a.shape_data_a == b.shape_data_a && a.body_data_b == b.body_data_b &&
               a.gone == b.gone;
    });
}
CELL_CASE("events: copies, restored worlds and worlds that are assigned to tell what the first one does") {
    cell::dice dice(7200);
    crowd t;
    world other;
    add(other, at(0, 4));
    for (int i = 0; i < 120; ++i) {
        for (int k = dice.below(3); k > 0; --k) t.change(dice);
        snapshot before;
        physics::detail::world_access::data_of(t.w);
        before.save(physics::detail::world_access::state_of(t.w));
        world copy = t.w;
        other = t.w;
        CHECK(copy.contact_begin_events().empty());
        CHECK(other.contact_end_events().empty());
        t.step();
        const auto list = [](const auto& events) { return contact_list(events.begin(), events.end()); };
        const contact_list begin = list(t.w.contact_begin_events()), end = list(t.w.contact_end_events());
        const auto hits = t.w.hit_events().size();
        const auto slept = t.w.sleep_events().size(), woken = t.w.wake_events().size();
        if (i % 8 == 0) {
            before.restore(physics::detail::world_access::data_of(t.w));
            CHECK(t.w.contact_begin_events().empty());
            t.w.step(S(1.0 / 64));
        }
        copy.step(S(1.0 / 64));
        other.step(S(1.0 / 64));
        for (const world* w : {&copy, &other, &t.w}) {
            CHECK(same(begin, w->contact_begin_events()));
            CHECK(same(end, w->contact_end_events()));
            CHECK(w->hit_events().size() == hits);
            CHECK(w->sleep_events().size() == slept);
            CHECK(w->wake_events().size() == woken);
        }
    }
}

void run(world& w, int steps) {
    for (int i = 0; i < steps; ++i) w.step(S(1.0 / 64));
}
CELL_CASE("events: they change no bit of the motion") {
    world told;
    physics::world<silent> untold;
    const auto fill = [](auto& w) {
        add_floor(w);
        for (int i = 0; i < 12; ++i) add(w, at(0.3 * (i % 3), 0.6 + 0.9 * i), 0.5, 0.25);
    };
    fill(told);
    fill(untold);
    for (int i = 0; i < 200; ++i) {
        told.step(S(1.0 / 64));
        untold.step(S(1.0 / 64));
        CHECK(told.state_hash() == untold.state_hash());
    }
}

/// Lets balls fall from heights on the floor, and counts what is told.
CELL_CASE("events: a ball that falls hits once each time that it lands, as fast as it came") {
    for (const double e : {0.0, 0.5, 1.0})
        for (int phase = 0; phase < 8; ++phase) {
            world::settings_type settings;
            settings.gravity = along(1, -8);
            world w(settings);
            const body_id floor = add_floor(w);
            const body_id ball = add(w, at(0, 1.5 + phase / 64.0), 0.5, e);
            w.set_linear_velocity(ball, along(1, -1));
            int hits = 0, begins = 0;
            double mass = number(w.mass(ball).mass);
            for (int i = 0; i < 40; ++i) {
                const double speed = -number(w.linear_velocity(ball).y);
                w.step(S(1.0 / 64));
                begins += static_cast<int>(w.contact_begin_events().size());
                for (const auto& h : w.hit_events()) {
                    ++hits;
                    CHECK(h.body_a == floor);
                    CHECK(h.body_b == ball);
                    CHECK(gap(h.normal, along(1, 1)) <= rounding(8));
                    CHECK(std::abs(number(h.approach_speed) - speed) <= rounding(64, 8));
                    CHECK(std::abs(number(h.point.y)) < 0.3);
                    const double gained = mass * (number(w.linear_velocity(ball).y) + speed);
                    // Gravity acts in that step too.
                    CHECK(number(h.impulse) >= gained - 1e-3);
                    CHECK(number(h.impulse) <= gained + mass * 8 / 64 + 1e-3);
                }
            }
            CHECK(hits == 1);
            CHECK(begins == 1);
        }
}
CELL_CASE("events: two hundred balls hit one hub in the same step, and each is told") {
    world w(world::settings_type{.gravity = {}});
    const body_id hub = w.create_body();
    w.create_shape(hub, world::ball{S(40)}, {.density = S(4)});
    const int count = 200;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * 3.14159265358979 * i / count;
        const vec out = at(std::cos(angle), std::sin(angle));
        const body_id b = add(w, out * S(40.51), 0.5);
        w.set_linear_velocity(b, out * S(-4));
    }
    w.step(S(1.0 / 64));
    CHECK(w.hit_events().size() == count);
    CHECK(w.contact_begin_events().size() == count);
    CHECK(w.contacts(hub).size() == count);
    for (const auto& h : w.hit_events()) CHECK(std::abs(number(h.approach_speed) - 4) < 1e-3);
}
CELL_CASE("events: what rests, and falls asleep, tells nothing, and its contacts still answer") {
    world w;
    const body_id floor = add_floor(w), low = add(w, at(0, 0.5)), high = add(w, at(0, 1.5));
    int begins = 0;
    for (int i = 0; i < 256; ++i) {
        w.step(S(1.0 / 64));
        begins += static_cast<int>(w.contact_begin_events().size());
        CHECK(w.contact_end_events().empty());
        CHECK(w.hit_events().empty());
        CHECK(w.touching(floor, low));
        CHECK(w.touching(high, low));
        CHECK(!w.touching(floor, high));
    }
    CHECK(begins == 2);
    CHECK(w.is_asleep(low));
    CHECK(w.contacts(low).size() == 2);
    w.wake(low);
    w.step(S(1.0 / 64));
    CHECK(w.wake_events().size() == 2);
    CHECK(w.contact_begin_events().empty());
    CHECK(w.contact_end_events().empty());
    w.destroy_body(low);
    CHECK(w.contact_end_events().empty());
    w.step(S(1.0 / 64));
    CHECK(w.contact_end_events().size() == 2);
    for (const auto& e : w.contact_end_events()) CHECK(e.gone);
}
CELL_CASE("events: many contacts of one pair are one touch and one hit") {
    world w;
    add_floor(w);
    const world::ball ball{S(0.25)};
    const auto built =
        world::compound_geometry::build({{ball, at(0, 0)}, {ball, at(0.5, 0)}, {ball, at(1, 0)}, {ball, at(1.5, 0)}});
    const body_id b = w.create_body({.position = at(0, 0.255)});
    w.set_linear_velocity(b, along(1, -2));
    w.create_shape(b, built.shape());
    w.step(S(1.0 / 64));
    CHECK(w.contacts(b).size() == 4);
    CHECK(w.contact_begin_events().size() == 1);
    REQUIRE(w.hit_events().size() == 1);
    const double gained = number(w.linear_velocity(b).y) + 2 + 9.81 / 64;
    CHECK(std::abs(number(w.hit_events()[0].impulse) - gained * number(w.mass(b).mass)) < 1e-4);
    w.destroy_body(b);
    w.step(S(1.0 / 64));
    CHECK(w.contact_end_events().size() == 1);
}
CELL_CASE("events: a filter that comes and goes between two steps tells nothing, one that stays ends the touch") {
    world w;
    const body_id floor = add_floor(w), ball = add(w, at(0, 0.5));
    const shape_id shape = *w.shapes(ball).begin();
    run(w, 8);
    w.set_filter(shape, {.mask = 0});
    CHECK(!w.touching(floor, ball));
    w.set_filter(shape, {});
    w.step(S(1.0 / 64));
    CHECK(w.contact_end_events().empty());
    CHECK(w.contact_begin_events().empty());
    CHECK(w.touching(floor, ball));
    w.set_filter(shape, {.mask = 0});
    w.step(S(1.0 / 64));
    REQUIRE(w.contact_end_events().size() == 1);
    CHECK(!w.contact_end_events()[0].gone);
    // Another shape under the same number ends one touch and begins another.
    w.set_filter(shape, {});
    w.set_pose(ball, at(0, 0.5), {});
    run(w, 2);
    w.destroy_body(ball);
    const body_id again = add(w, at(0, 0.5));
    REQUIRE((*w.shapes(again).begin()).index == shape.index);
    w.step(S(1.0 / 64));
    REQUIRE(w.contact_end_events().size() == 1);
    REQUIRE(w.contact_begin_events().size() == 1);
    CHECK(w.contact_end_events()[0].gone);
    CHECK(w.contact_begin_events()[0].body_b == again);
}

CELL_CASE("events: a refused step leaves them as they were") {
    world w;
    add_floor(w);
    const body_id ball = add(w, at(0, 0.5));
    w.step(S(1.0 / 64));
    CHECK(w.contact_begin_events().size() == 1);
    CHECK_THROWS_AS(w.step(S(0)), physics::error);
    CHECK(w.contact_begin_events().size() == 1);
    CHECK(w.contains(ball));
}

CELL_CASE("contacts: those of a body and of a shape are those of all that name it, also while a loop changes them") {
    cell::dice dice(7300);
    crowd t;
    int found = 0;
    for (int i = 0; i < 80; ++i) {
        for (int k = dice.below(4); k > 0; --k) t.change(dice);
        t.step();
        // What has been asked for once is asked for again after changes.
        CHECK(t.w.contacts(t.bodies[0]).size() <= t.w.contacts().size());
        for (int k = dice.below(3); k > 0; --k) t.change(dice);
        const auto name = [](const world::contact_view& c) { return std::tuple(c.shape_a, c.shape_b, c.part); };
        for (const body_id b : t.w.bodies()) {
            std::vector<std::tuple<shape_id, shape_id, std::uint32_t>> expected, own;
            for (const auto& c : t.w.contacts())
                if (c.body_a == b || c.body_b == b) expected.push_back(name(c));
            for (const auto& c : t.w.contacts(b)) {
                own.push_back(name(c));
                CHECK(c.other(b) != b);
            }
            CHECK(own == expected);
            found += static_cast<int>(own.size());
            std::size_t of_shapes = 0;
            for (const shape_id s : t.w.shapes(b))
                for (const auto& c : t.w.contacts(s)) {
                    CHECK((c.shape_a == s || c.shape_b == s));
                    ++of_shapes;
                }
            CHECK(of_shapes == own.size());
        }
        // Those that it touches go while the loop runs; a contact that is gone has no bodies.
        const body_id b = t.any(dice);
        for (const auto& c : t.w.contacts(b)) {
            if (!c.body_a) continue;
            const body_id other = c.other(b);
            if (dice.below(2) || other == t.bodies[0]) continue;
            t.w.destroy_body(other);
            t.bodies.erase(std::find(t.bodies.begin(), t.bodies.end(), other));
        }
    }
    CHECK(found > 400);
}

}  // namespace events_laws
}  // namespace
