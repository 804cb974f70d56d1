// Laws of changes in the midst of things: visitors of queries and loops over a world may change it as if they came
// after it had answered; an executor in the middle of a step may not.
#pragma once

#include <string>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace changing_laws {

/// Boxes in a row on the ground, each with a second one on it, all asleep if there is time for it; the fourth body has
/// two shapes more.
struct shelf {
    world w{{.gravity = along(1, -10)}};
    body_id ground;
    std::vector<body_id> boxes;

    explicit shelf(int steps, int columns = 6) {
        ground = w.create_body({.type = body_type::static_body, .position = along(1, -0.5)});
        vec half = vec::filled(S(20));
        half[0] = S(columns + 14);
        half[1] = S(0.5);
        w.create_shape(ground, world::box{half});
        for (int i = 0; i < columns; ++i)
            for (int k = 0; k < 2; ++k) {
                boxes.push_back(w.create_body({.position = at(2 * i - columns + 1, 0.5 + k)}));
                w.create_shape(boxes.back(), world::box{vec::filled(S(0.5))});
            }
        for (const double x : {-0.25, 0.25}) w.create_shape(boxes[3], world::ball{S(0.25)}, {.position = at(x, 0.25)});
        run(w, steps);
    }
    [[nodiscard]] world::box everything() const { return world::box{vec::filled(S(15))}; }
};

/// What somebody does to a thing that was found.
using action = void (*)(shelf&, shape_id);
const action actions[] = {
    [](shelf& s, shape_id i) { s.w.wake(s.w.body(i)); },
    [](shelf& s, shape_id i) {
        if (s.w.type(s.w.body(i)) == body_type::dynamic_body) s.w.apply_impulse(s.w.body(i), at(1, 5));
    },
    [](shelf& s, shape_id i) {
        if (s.w.type(s.w.body(i)) == body_type::dynamic_body) s.w.apply_force(s.w.body(i), at(3, 5));
    },
    [](shelf& s, shape_id i) { s.w.destroy_body(s.w.body(i)); },
    [](shelf& s, shape_id i) { s.w.destroy_shape(i); },
    // The neighbours, which are found before or after.
    [](shelf& s, shape_id i) {
        const std::uint32_t first = s.w.body(i).index;
        for (const body_id b : s.w.bodies())
            if (b.index == first + 1 || b.index + 1 == first) s.w.destroy_body(b);
    },
    [](shelf& s, shape_id i) { s.w.set_pose(s.w.body(i), s.w.position(s.w.body(i)) + at(0.25, 2), {}); },
    [](shelf& s, shape_id i) {
        s.w.create_shape(s.w.create_body({.position = at(0, 8)}),
                         s.w.shape(i).visit([](auto) { return world::ball{S(0.25)}; }));
    },
    [](shelf& s, shape_id i) { s.w.create_shape(s.w.body(i), world::ball{S(0.25)}, {.position = at(0, 1)}); },
    [](shelf& s, shape_id i) { s.w.set_type(s.w.body(i), body_type::kinematic_body); },
    [](shelf& s, shape_id i) { s.w.set_enabled(s.w.body(i), !s.w.enabled(s.w.body(i))); },
    [](shelf& s, shape_id i) { s.w.set_material(i, {.friction = S(0.125)}); },
    [](shelf& s, shape_id) { s.w.step(S(1.0 / 64)); },
    [](shelf& s, shape_id) { s.w.set_settings({.gravity = at(1, -5), .contact_margin = S(0.125)}); },
    // A query in the query, which changes the world itself.
    [](shelf& s, shape_id i) {
        const vec above = s.w.position(s.w.body(i)) + at(0, 1);
        s.w.each_at(above, {}, [&](shape_id other) { s.w.destroy_body(s.w.body(other)); });
    },
    [](shelf& s, shape_id i) {
        s.w.destroy_body(s.w.body(i));
        // It takes the place of what has gone, and is not what was found.
        s.w.create_shape(s.w.create_body({.position = at(0, 3)}), world::ball{S(0.25)});
    },
};

/// Calls with(shelf, visit) and then goes on: visit(id) as things are found, or afterwards.
template <class With>
void check_as_if_after(int steps, With&& with) {
    int k = 0;
    for (const action act : actions) {
        CAPTURE(k++);
        shelf within(steps), after = within;
        REQUIRE(within.w.state_hash() == after.w.state_hash());
        std::vector<shape_id> found, seen, expected;
        with(within, [&](shape_id id) {
            seen.push_back(id);
            act(within, id);
        });
        with(after, [&](shape_id id) { found.push_back(id); });
        REQUIRE(found.size() > 3);
        for (const shape_id id : found) {
            if (!after.w.contains(id)) continue;
            expected.push_back(id);
            act(after, id);
        }
        CHECK(seen == expected);
        CHECK(within.w.state_hash() == after.w.state_hash());
        run(within.w, 20);
        run(after.w, 20);
        CHECK(within.w.state_hash() == after.w.state_hash());
        CHECK(within.w.contacts().size() == after.w.contacts().size());
    }
}

CELL_CASE("changes: visitors of queries may change the world, asleep or awake, as if they came after the query") {
    for (const int steps : {3, 100}) {
        const shelf asleep(steps);
        CHECK((asleep.w.awake_count() == 0) == (steps == 100));
        check_as_if_after(steps, [](const shelf& s, auto&& visit) {
            s.w.each_overlapping(s.everything(), {at(0, 1), {}}, {}, visit);
        });
        check_as_if_after(steps, [](const shelf& s, auto&& visit) {
            s.w.each_hit_along_ray(at(-19, 0.5), along(0, 38), {},
                                   [&](const world::world_hit& hit) { visit(hit.shape); });
        });
    }
}

CELL_CASE("changes: visitors hear of shapes in order, and say when they have enough") {
    const shelf s(3);
    std::vector<std::uint32_t> numbers;
    s.w.each_overlapping(s.everything(), {}, {}, [&](shape_id id) { numbers.push_back(id.index); });
    CHECK(numbers.size() == s.w.shape_count());
    for (std::size_t i = 1; i < numbers.size(); ++i) CHECK(numbers[i - 1] < numbers[i]);
    int asked = 0;
    s.w.each_overlapping(s.everything(), {}, {}, [&](shape_id) { return ++asked < 3; });
    CHECK(asked == 3);
    // A hundred, more than fit into the first sort, from the last to the first.
    world w{{.gravity = {}}};
    std::vector<body_id> row;
    for (int i = 0; i < 100; ++i) {
        row.push_back(w.create_body({.position = at(2 * (i * 37 % 100), 0)}));
        w.create_shape(row.back(), world::ball{S(0.5)});
    }
    std::vector<S> fractions;
    const auto all = [&](const world::world_hit& hit) { fractions.push_back(hit.fraction); };
    w.each_hit_along_ray(at(-2, 0), along(0, 250), {}, all);
    REQUIRE(fractions.size() == 100);
    for (std::size_t i = 1; i < 100; ++i) CHECK(fractions[i - 1] < fractions[i]);
    asked = 0;
    w.each_hit_along_ray(at(-2, 0), along(0, 250), {}, [&](const world::world_hit& hit) {
        CHECK(hit.fraction == fractions[static_cast<std::size_t>(asked)]);
        return ++asked < 42;
    });
    CHECK(asked == 42);
}

CELL_CASE("changes: a visitor may assign to its world, or move from it") {
    shelf s(3), other(50);
    int asked = 0;
    s.w.each_overlapping(s.everything(), {}, {}, [&](shape_id) {
        if (++asked == 2) s.w = world();
    });
    CHECK(asked == 2);
    CHECK(s.w.body_count() == 0);
    s = shelf(3);
    asked = 0;
    s.w.each_overlapping(s.everything(), {}, {}, [&](shape_id id) {
        CHECK(s.w.contains(id));
        ++asked;
        s.w = other.w;
    });
    CHECK(asked == 1);
    asked = 0;
    world taken;
    s.w.each_hit_along_ray(at(-19, 0.5), along(0, 38), {}, [&](const auto&) {
        ++asked;
        taken = std::move(s.w);
    });
    CHECK(asked == 1);
    CHECK(taken.state_hash() == other.w.state_hash());
    asked = 0;
    for (const auto& c : taken.contacts()) {
        CHECK(c.count > 0);
        if (++asked == 2) taken = world();
    }
    CHECK(asked == 2);
    taken = other.w;
    for (const body_id b : taken.bodies()) {
        CHECK(taken.contains(b));
        taken = world();
    }
}

CELL_CASE("changes: a loop over contacts sees each that lasts once, whatever it does") {
    for (const int steps : {3, 100}) {
        int k = 0;
        for (const action act : actions) {
            CAPTURE(k++);
            if (act == actions[11]) continue;  // A step finds other contacts.
            shelf s(steps);
            struct sides {
                shape_id a, b;
                bool operator==(const sides&) const = default;
            };
            std::vector<sides> before, seen;
            for (const auto& c : s.w.contacts()) before.push_back({c.shape_a, c.shape_b});
            REQUIRE(before.size() == s.w.contacts().size());
            REQUIRE(before.size() > 11);
            for (std::size_t i = 1; i < before.size(); ++i) {
                const auto first = [](const sides& x) { return std::min(x.a.index, x.b.index); };
                CHECK(first(before[i - 1]) <= first(before[i]));
            }
            std::size_t next = 0;
            for (const auto& c : s.w.contacts()) {
                const sides here{c.shape_a, c.shape_b};
                // What was skipped is gone.
                while (next < before.size() && !(before[next] == here)) {
                    const auto& [a, b] = before[next++];
                    const bool stays = s.w.contains(a) && s.w.contains(b) &&
                                       (s.w.type(s.w.body(a)) == body_type::dynamic_body ||
                                        s.w.type(s.w.body(b)) == body_type::dynamic_body);
                    CHECK_FALSE(stays);
                }
                REQUIRE(next < before.size());
                ++next;
                CHECK(s.w.contains(here.a));
                CHECK(s.w.contains(here.b));
                const shape_id of = s.w.body(here.a) == s.ground ? here.b : here.a;
                act(s, of);
            }
            run(s.w, 5);
        }
    }
    // A step in each turn: the loop ends, whatever it finds.
    shelf s(3);
    int turns = 0;
    for (const auto& c : s.w.contacts()) {
        CHECK(s.w.contains(c.shape_a));
        s.w.step(S(1.0 / 64));
        REQUIRE(++turns < 100);
    }
    CHECK(turns > 5);
    // A view taken once more, of what is gone.
    shelf t(100);
    const auto first = t.w.contacts().begin();
    const auto seen = *first;
    CHECK((*first).shape_a == seen.shape_a);
    t.w.wake(seen.body_b);
    CHECK((*first).shape_a == seen.shape_a);
    t.w.destroy_body(seen.body_a == t.ground ? seen.body_b : seen.body_a);
    CHECK((*first).count == 0);
    CHECK_FALSE((*first).shape_a);
}

CELL_CASE("changes: a loop over a body's shapes sees each that lasts once, and no other body's") {
    using change = void (*)(shelf&, shape_id);
    const change changes[] = {
        [](shelf& s, shape_id i) { s.w.destroy_shape(i); },
        [](shelf& s, shape_id i) { s.w.destroy_body(s.w.body(i)); },
        // Behind it; all others; all, for another body's.
        [](shelf& s, shape_id i) {
            for (const shape_id other : s.w.shapes(s.boxes[3]))
                if (other.index < i.index) return s.w.destroy_shape(other);
        },
        [](shelf& s, shape_id i) {
            for (const shape_id other : s.w.shapes(s.boxes[3]))
                if (!(other == i)) s.w.destroy_shape(other);
        },
        [](shelf& s, shape_id) {
            while (s.w.shapes(s.boxes[3]).begin() != s.w.shapes(s.boxes[3]).end())
                s.w.destroy_shape(*s.w.shapes(s.boxes[3]).begin());
            for (int k = 0; k < 3; ++k) s.w.create_shape(s.boxes[0], world::ball{S(0.125)});
        },
        [](shelf& s, shape_id) { s.w.create_shape(s.boxes[3], world::ball{S(0.125)}); },
        [](shelf& s, shape_id i) {
            s.w.destroy_shape(i);
            s.w.create_shape(s.boxes[3], world::ball{S(0.125)});
        },
    };
    int k = 0;
    for (const change make : changes) {
        CAPTURE(k++);
        shelf s(3);
        std::vector<shape_id> before, seen;
        for (const shape_id i : s.w.shapes(s.boxes[3])) before.push_back(i);
        REQUIRE(before.size() == 3);
        for (const shape_id i : s.w.shapes(s.boxes[3])) {
            CHECK(s.w.contains(i));
            CHECK(s.w.body(i) == s.boxes[3]);
            seen.push_back(i);
            make(s, i);
            REQUIRE(seen.size() < 20);
        }
        std::size_t next = 0;
        for (const shape_id i : before) {
            if (next < seen.size() && seen[next] == i) ++next;
            else CHECK_FALSE(s.w.contains(i));
        }
        CHECK(next == seen.size());
        run(s.w, 5);
    }
    // Places that are used again keep a body's shapes in order.
    shelf s(3);
    const shape_id first = *s.w.shapes(s.boxes[0]).begin();
    s.w.create_shape(s.boxes[0], world::ball{S(0.125)});
    s.w.create_shape(s.boxes[0], world::ball{S(0.25)});
    s.w.destroy_shape(first);
    s.w.create_shape(s.boxes[0], world::ball{S(0.375)});
    std::uint32_t last = 0xffffffffu;
    for (const shape_id i : s.w.shapes(s.boxes[0])) {
        CHECK(i.index < last);
        last = i.index;
    }
    CHECK(last == first.index);
}

CELL_CASE("changes: a loop over bodies may destroy and create them, and ends") {
    shelf s(3);
    const std::uint32_t count = s.w.body_count();
    std::uint32_t turns = 0;
    for (const body_id b : s.w.bodies()) {
        CHECK(s.w.contains(b));
        s.w.create_body();
        ++turns;
    }
    CHECK(turns == count);
    CHECK(s.w.body_count() == 2 * count);
    for (const body_id b : s.w.bodies()) s.w.destroy_body(b);
    CHECK(s.w.body_count() == 0);
}

/// Does something with its world in the middle of a step.
struct meddler {
    shelf& s;
    void (*meddle)(shelf&, meddler&);
    std::string said = "not refused";
    int times = 0;

    [[nodiscard]] std::uint32_t workers() const { return 2; }
    void run(std::uint32_t parts, const physics::task_set& what) {
        ++times;
        said = refusal([&] { meddle(s, *this); });
        for (std::uint32_t k = 0; k < parts; ++k) what(k, 0);
    }
};

CELL_CASE("changes: in the middle of a step a world refuses all of them, by name, and the step goes on") {
    struct entry {
        std::string name;
        void (*call)(shelf&, meddler&);
    };
    const entry entries[] = {
        {"step", [](shelf& s, meddler&) { s.w.step(S(1.0 / 64)); }},
        {"step", [](shelf& s, meddler& m) { s.w.step(S(1.0 / 64), m); }},
        {"create_body", [](shelf& s, meddler&) { s.w.create_body(); }},
        {"create_shape", [](shelf& s, meddler&) { s.w.create_shape(s.boxes[0], world::ball{}); }},
        {"destroy_body", [](shelf& s, meddler&) { s.w.destroy_body(s.boxes[0]); }},
        {"destroy_shape", [](shelf& s, meddler&) { s.w.destroy_shape(*s.w.shapes(s.boxes[0]).begin()); }},
        {"set_pose", [](shelf& s, meddler&) { s.w.set_pose(s.boxes[0], at(0, 9), {}); }},
        {"set_type", [](shelf& s, meddler&) { s.w.set_type(s.boxes[0], body_type::static_body); }},
        {"set_enabled", [](shelf& s, meddler&) { s.w.set_enabled(s.boxes[0], false); }},
        {"set_settings", [](shelf& s, meddler&) { s.w.set_settings({}); }},
        {"wake", [](shelf& s, meddler&) { s.w.wake(s.boxes[0]); }},
        {"apply_force", [](shelf& s, meddler&) { s.w.apply_force(s.boxes[0], at(1, 1)); }},
        {"apply_impulse", [](shelf& s, meddler&) { s.w.apply_impulse(s.boxes[0], at(1, 1)); }},
        {"set_linear_velocity", [](shelf& s, meddler&) { s.w.set_linear_velocity(s.boxes[0], at(1, 1)); }},
        {"set_mass",
         [](shelf& s, meddler&) {
             s.w.set_mass(s.boxes[0], {S(1), {}, {}});
         }},
        {"set_material",
         [](shelf& s, meddler&) { s.w.set_material(*s.w.shapes(s.boxes[0]).begin(), {.friction = S(0)}); }},
        {"set_user_data", [](shelf& s, meddler&) { s.w.set_user_data(s.boxes[0], 7); }},
    };
    for (const entry& e : entries) {
        CAPTURE(e.name);
        // Large enough to be shared out.
        shelf s(3, 150), twin(3, 150);
        meddler by{s, e.call};
        for (int i = 0; i < 3; ++i) {
            s.w.step(S(1.0 / 64), by);
            twin.w.step(S(1.0 / 64));
        }
        REQUIRE(by.times > 0);
        CHECK(by.said == "physics: " + e.name + ": world is in a step; it can be changed before and after");
        CHECK(s.w.state_hash() == twin.w.state_hash());
        e.call(s, by);
    }
    // Nor does one that is cut short stay in its step.
    shelf s(3, 150);
    struct thrower {
        [[nodiscard]] std::uint32_t workers() const { return 2; }
        void run(std::uint32_t, const physics::task_set&) { throw 1; }
    } by;
    CHECK_THROWS_AS(s.w.step(S(1.0 / 64), by), int);
    s.w.step(S(1.0 / 64));
}

}  // namespace changing_laws
}  // namespace
