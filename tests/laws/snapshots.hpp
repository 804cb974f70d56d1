// Laws of snapshots of worlds: brought back to a moment, any world of the recipe goes on from there by the same bits.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cell.hpp"

namespace {
namespace snapshot_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using physics::body_id;
using physics::body_type;
using physics::shape_id;
using vec = physics::vec<S, D>;
using state_access = physics::detail::world_access;

/// Few shapes, for the compiler's sake; with geometry, all that may refer to some.
using few = physics::shapes<physics::ball, physics::box, physics::halfspace>;
#if CELL_DIMENSION == 2
using surface = physics::chain_geometry<S, D>;
using many =
    physics::shapes<physics::ball, physics::box, physics::halfspace, physics::hull, physics::compound, physics::chain>;
#else
using surface = physics::mesh_geometry<S, D>;
using many =
    physics::shapes<physics::ball, physics::box, physics::halfspace, physics::hull, physics::compound, physics::mesh>;
#endif
template <class... Policies>
struct of : physics::recipe<S, D, Policies...> {};
using in_tree = of<few>;
using swept_along = of<few, physics::sweep_and_prune, physics::sequential_impulse>;
using in_cells = of<few, physics::grid, physics::without<physics::feature::sleeping>>;
using in_hashed_cells =
    of<few, physics::hash_grid, physics::sequential_impulse, physics::speculative, physics::incremental_manifolds>;
using one_by_one = of<few, physics::all_pairs, physics::without<physics::feature::continuous>>;
using with_geometry = of<many>;

template <class Recipe>
using snapshot_of = physics::detail::raw_snapshot<typename physics::detail::plan_of<Recipe>::type>;
template <class Recipe>
snapshot_of<Recipe> snapshot(const physics::world<Recipe>& w) {
    snapshot_of<Recipe> made;
    made.save(state_access::state_of(w));
    return made;
}
template <class Recipe>
bool restore(const snapshot_of<Recipe>& from, physics::world<Recipe>& w) {
    return from.restore(state_access::data_of(w));
}
template <class Snapshot>
bool same_bytes(const Snapshot& a, const Snapshot& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

inline vec at(double x, double y, double z = 0) {
    vec v;
    v[0] = S(x);
    v[1] = S(y);
    if constexpr (D == 3) v[2] = S(z);
    return v;
}
template <class Angular = physics::angular<S, D>>
Angular spin(double size) {
    if constexpr (D == 2) return S(size);
    else return {S(-0.5 * size), S(0.75 * size), S(size)};
}

/// Blocks of geometry that shapes of a yard share.
struct quarry {
    physics::hull_geometry<S, D> rock;
    physics::compound_geometry<S, D> twins;
    surface hill;

    quarry() {
        std::vector<vec> corners;
        for (int i = 0; i < 1 << D; ++i)
            corners.push_back(at(i & 1 ? 0.4 : -0.4, i & 2 ? 0.3 : -0.3, i & 4 ? 0.5 : -0.5));
        corners.push_back(at(0.1, 0.6, 0.1));
        rock = decltype(rock)::build(corners.data(), static_cast<std::uint32_t>(corners.size()));
        twins = decltype(twins)::build(
            {{physics::box<S, D>{vec::filled(S(0.25))}, at(-0.25, 0)}, {physics::ball<S, D>{S(0.3)}, at(0.3, 0.1)}});
#if CELL_DIMENSION == 2
        const vec line[] = {at(3, 0), at(0, 1), at(-3, 0)};
        hill = surface::build(line, 3);
#else
        const vec points[] = {at(-3, 0, -3), at(3, 0, -3), at(0, 1, 0), at(-3, 0, 3), at(3, 0, 3)};
        const std::uint32_t triangles[] = {0, 2, 1, 1, 2, 4, 4, 2, 3, 3, 2, 0};
        hill = surface::build(points, 5, triangles, 4);
#endif
    }
};

/// Whether values have no padding: that of two states which are the same may differ.
template <class T>
constexpr bool is_solid =
    std::is_arithmetic_v<T> || std::has_unique_object_representations_v<T> || std::is_same_v<T, vec> ||
    std::is_same_v<T, physics::aabb<S, D>> || std::is_same_v<T, physics::broadphase_settings<S>> ||
    std::is_same_v<T, physics::detail::box_block<D>>;

/// A number of all that lasts and has no padding, shapes of trees and what only saves work included. The rest, of which
/// the state hash knows most, is counted.
template <class State>
std::uint64_t number_of_numbers(const State& s) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](const void* from, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i)
            hash = (hash ^ static_cast<const unsigned char*>(from)[i]) * 0x100000001b3u;
    };
    physics::detail::each_value_of(s, [&](const auto& piece) {
        using T = std::remove_cvref_t<decltype(piece)>;
        if constexpr (physics::detail::is_buffer<T>) {
            const std::uint32_t count = piece.size();
            add(&count, sizeof count);
            if constexpr (is_solid<std::remove_cvref_t<decltype(*piece.begin())>>)
                add(piece.begin(), count * sizeof *piece.begin());
        } else if constexpr (is_solid<std::remove_all_extents_t<T>>) {
            add(&piece, sizeof piece);
        }
    });
    return hash;
}

/// What there is to see of a world between two steps, but for its tag.
struct seen {
    std::uint64_t hash, numbers, handles, steps;
    std::uint32_t awake, contacts, hit, touched;
    bool operator==(const seen&) const = default;
};
/// What a world has been through, so that a law does not hold for want of events.
struct events {
    int sleepers = 0, reused = 0, swept = 0, contacts = 0, waiting = 0;
};

/// A world in which bodies of all kinds come and go, are pushed, carried, shot and left alone. What happens in a tick
/// follows from its number and the world's state alone.
template <class Recipe>
class yard {
public:
    using world = physics::world<Recipe>;
    static constexpr bool has_geometry = world::any_shape::has_geometry;
    world w;

    explicit yard(std::uint64_t seed, int bodies = 14) : w(settings()), seed_(seed) {
        const body_id ground = w.create_body({.type = body_type::static_body});
        static_cast<void>(w.create_shape(ground, typename world::halfspace{}));
        if constexpr (has_geometry)
            static_cast<void>(w.create_shape(w.create_body({.type = body_type::static_body, .position = at(12, 0)}),
                                             stones_.hill.shape()));
        cell::dice dice(seed);
        for (int i = 0; i < bodies; ++i) {
            const body_id body = w.create_body({.position = at(1.25 * i - 8, 0.5), .user_data = dice.bits()});
            static_cast<void>(w.create_shape(body, typename world::box{vec::filled(S(0.5))}));
            if (i % 3 == 0) add_body(dice, at(1.25 * i - 8, 1.5));
        }
        add_body(dice, at(12, 2));
        const body_id slab = w.create_body({.type = body_type::kinematic_body, .position = at(-12, 1)});
        static_cast<void>(w.create_shape(slab, typename world::box{at(0.25, 1, 1)}));
    }

    /// From one tick to another; adds what is seen at the end of each.
    void play(std::uint64_t from, std::uint64_t to, std::vector<seen>& log) {
        for (std::uint64_t tick = from; tick < to; ++tick) {
            w.step(S(1.0 / 64));
            log.push_back(look());
            act(tick);
        }
    }
    void note(events& all) const {
        const auto& s = state_access::state_of(w);
        all.contacts += static_cast<int>(w.contacts().size());
        all.swept += static_cast<int>(w.continuous_report().swept);
        all.reused += s.bodies.count() < s.bodies.slots();
        for (const body_id b : w.bodies()) {
            all.sleepers += w.is_asleep(b);
            all.reused += b.generation > 1;
            all.waiting += s.bodies[b.index].has_external_force() || s.bodies[b.index].has_target;
        }
    }
    [[nodiscard]] seen look() const {
        std::uint64_t handles = 0;
        const auto add = [&](auto id) {
            handles = (handles ^ (std::uint64_t{id.index} << 16 | id.generation)) * 0x9e3779b97f4a7c15u;
        };
        for (const body_id b : w.bodies()) {
            add(b);
            handles ^= w.user_data(b);
            for (const shape_id s : w.shapes(b)) add(s);
        }
        std::uint32_t touched = 0;
        w.each_overlapping(typename world::box{vec::filled(S(1.5))}, {at(0, 1), {}}, {}, [&](shape_id) { ++touched; });
        const auto hit = w.cast_ray(at(-20, 0.75), at(40, 0.25));
        return {w.state_hash(),  number_of_numbers(state_access::state_of(w)),
                handles,         w.steps(),
                w.awake_count(), w.contacts().size(),
                hit.shape.index, touched};
    }

private:
    static typename world::settings_type settings() {
        typename world::settings_type with{.gravity = at(0, -10)};
        if constexpr (requires { with.sleeping.time; }) with.sleeping.time = S(0.125);
        return with;
    }
    body_id add_body(cell::dice& dice, vec where) {
        const body_id body = w.create_body({.position = where,
                                            .angular_velocity = spin(dice.number(-1, 1)),
                                            .continuous = world_sweeps && dice.below(4) == 0,
                                            .user_data = dice.bits()});
        add_shape(dice, body);
        return body;
    }
    void add_shape(cell::dice& dice, body_id body) {
        const int kind = dice.below(has_geometry ? 4 : 2);
        if (kind == 0) static_cast<void>(w.create_shape(body, typename world::ball{dice.real(0.2, 0.5)}));
        if (kind == 1) static_cast<void>(w.create_shape(body, typename world::box{dice.vec<vec>(0.2, 0.5)}));
        if constexpr (has_geometry) {
            if (kind == 2) static_cast<void>(w.create_shape(body, stones_.rock.shape()));
            if (kind == 3) static_cast<void>(w.create_shape(body, stones_.twins.shape()));
        }
    }
    void act(std::uint64_t tick) {
        cell::dice dice(seed_ + 7919 * tick);
        std::vector<body_id> all;
        for (const body_id b : w.bodies())
            if (w.type(b) != body_type::static_body) all.push_back(b);
        const auto any = [&] { return all[static_cast<std::size_t>(dice.below(static_cast<int>(all.size())))]; };
        const body_id body = any();
        const bool dynamic = w.type(body) == body_type::dynamic_body, enabled = w.enabled(body);
        switch (dice.below(16)) {
            case 0: add_body(dice, at(dice.number(-8, 8), dice.number(3, 5))); break;
            case 1:
                if (all.size() < 10) add_body(dice, at(dice.number(-8, 8), 4));
                else w.destroy_body(body);
                break;
            case 2:
                if (dynamic && enabled) w.apply_impulse(body, at(0, 3));
                break;
            case 3:
                if (dynamic && enabled) w.apply_torque(body, spin(dice.number(-5, 5)));
                break;
            case 4: w.set_linear_velocity(body, at(dice.number(-90, 90), 5)); break;
            case 5: w.set_pose(body, w.position(body) + at(0, 0.25), w.rotation(body)); break;
            case 6: w.set_gravity_scale(body, dice.real(0.5, 1)); break;
            case 7:
                if (dynamic) add_shape(dice, body);
                break;
            case 8:
                for (const shape_id s : w.shapes(body)) {
                    w.destroy_shape(s);
                    break;
                }
                break;
            case 9: w.set_type(body, dynamic ? body_type::kinematic_body : body_type::dynamic_body); break;
            case 10: {
                auto with = w.settings();
                // Wakes all.
                if (dice.below(4) == 0) with.gravity = at(0, dice.number(-11, -9));
                with.broadphase.margin = dice.real(0, 0.1);
                w.set_settings(with);
                break;
            }
            case 11:
            case 12: w.set_enabled(body, !enabled); break;
            default: break;
        }
        // Some wait for the next step with a force or a target.
        if (tick % 4 == 1 && w.contains(body) && w.type(body) == body_type::dynamic_body && w.enabled(body))
            w.apply_force(body, at(dice.number(-50, 50), 20));
        for (const body_id b : w.bodies())
            if (w.type(b) == body_type::kinematic_body && w.enabled(b) && tick % 3 == 0)
                w.move_to(b, w.position(b) + at(0.0625, 0), w.rotation(b));
    }
    static constexpr bool world_sweeps = physics::detail::plan_of<Recipe>::type::sweeps;

    quarry stones_;
    std::uint64_t seed_;
};

// Fixed point is slow where compilers do not optimise.
constexpr std::uint64_t ticks = 72, ahead = cell::is_fixed ? 10 : 20;

/// At some moments of some histories: the same steps again, in the same world and in others.
template <class Recipe>
void check_going_on(std::uint64_t seed) {
    cell::dice dice(seed);
    yard<Recipe> y(seed), other(seed + 1, 5), moved(seed + 2, 20);
    std::vector<seen> ignored;
    // Worlds with other histories: one that has been larger, and one that has moved.
    moved.play(0, 40, ignored);
    other.play(0, 8, ignored);
    snapshot_of<Recipe> of;
    events all;
    for (std::uint64_t tick = 0; tick < ticks;) {
        std::vector<seen> before, again, elsewhere, afresh, there;
        const std::uint64_t end = tick + ahead;
        of.save(state_access::state_of(y.w));
        y.note(all);
        const seen now = y.look();
        y.play(tick, end, before);
        y.note(all);
        REQUIRE(restore(of, y.w));
        CHECK(y.look() == now);
        CHECK(same_bytes(snapshot(y.w), of));
        y.play(tick, end, again);
        CHECK(before == again);

        // Who acts is the yard's; where it acts is another world.
        std::swap(y.w, other.w);
        REQUIRE(restore(of, y.w));
        CHECK(y.look() == now);
        y.play(tick, end, elsewhere);
        CHECK(before == elsewhere);
        std::swap(y.w, other.w);

        const snapshot_of<Recipe> copy = of;
        of = snapshot_of<Recipe>();
        auto place = std::make_unique<physics::world<Recipe>>(std::move(moved.w));
        std::swap(y.w, *place);
        REQUIRE(restore(copy, y.w));
        CHECK(y.look() == now);
        y.play(tick, end, there);
        CHECK(before == there);
        std::swap(y.w, *place);
        moved.w = std::move(*place);

        physics::world<Recipe> fresh;
        REQUIRE(restore(copy, fresh));
        std::swap(y.w, fresh);
        CHECK(y.look() == now);
        y.play(tick, end, afresh);
        CHECK(before == afresh);

        REQUIRE(restore(copy, y.w));
        const std::uint64_t on = tick + 1 + static_cast<std::uint64_t>(dice.below(30));
        y.play(tick, on, ignored);
        tick = on;
    }
    using plan = typename physics::detail::plan_of<Recipe>::type;
    CHECK((all.sleepers > 0) == plan::sleeps);
    CHECK(all.reused > 0);
    CHECK(all.contacts > 20);
    CHECK(all.waiting > 0);
}

CELL_CASE("snapshots: steps from a snapshot are the steps from the moment it was made, in this world and in others") {
    check_going_on<in_tree>(1);
    check_going_on<in_tree>(2);
    check_going_on<with_geometry>(3);
    check_going_on<with_geometry>(4);
}
CELL_CASE("snapshots: they hold what every broadphase and both solvers go on from") {
    check_going_on<swept_along>(5);
    check_going_on<in_cells>(6);
    check_going_on<in_hashed_cells>(7);
    check_going_on<one_by_one>(8);
}

CELL_CASE("snapshots: nothing of what came after stays, and what has gone since is there again") {
    using world = physics::world<in_tree>;
    yard<in_tree> y(9);
    std::vector<seen> ignored;
    y.play(0, 30, ignored);
    world& w = y.w;
    const body_id gone = w.create_body({.position = at(0, 9), .user_data = 5});
    const shape_id round = w.create_shape(gone, world::ball{S(0.25)});
    const auto of = snapshot(w);
    const seen then = y.look();
    w.destroy_body(gone);
    std::vector<body_id> born;
    std::vector<shape_id> made;
    for (int i = 0; i < 60; ++i) {
        born.push_back(w.create_body({.position = at(i, 12)}));
        made.push_back(w.create_shape(born.back(), world::box{}));
    }
    w.step(S(1.0 / 64));
    CHECK_FALSE(w.contains(gone));
    // What made room for more is at hand, what filled it is not.
    const world copy = w;
    REQUIRE(restore(of, w));
    CHECK(y.look() == then);
    CHECK(w.contains(gone));
    CHECK(w.contains(round));
    CHECK(w.user_data(gone) == 5);
    CHECK(w.body(round) == gone);
    for (const body_id b : born) CHECK_FALSE(w.contains(b));
    for (const shape_id s : made) CHECK_FALSE(w.contains(s));
    CHECK(copy.contains(born.back()));
    // The same calls give the same numbers again.
    w.destroy_body(gone);
    for (const body_id b : born) CHECK(w.create_body() == b);

    // A world keeps its tag: its own handles serve it, those of others do not.
    world other;
    REQUIRE(restore(of, other));
    CHECK(other.state_hash() == then.hash);
    CHECK_FALSE(other.contains(gone));
    const body_id same{gone.index, gone.generation, other.create_body().world};
    CHECK(other.contains(same));
    CHECK(other.user_data(same) == 5);
    world twin = w;
    REQUIRE(restore(of, twin));
    CHECK(twin.contains(gone));
    // Also to nothing at all.
    const auto empty = snapshot(world());
    REQUIRE(restore(empty, w));
    CHECK(w.body_count() == 0);
    CHECK(w.shape_count() == 0);
    CHECK(w.contacts().size() == 0);
    CHECK(w.state_hash() == world().state_hash());
    REQUIRE(restore(of, w));
    CHECK(y.look() == then);
}

/// An executor whose workers take turns, the last part first.
struct turns {
    [[nodiscard]] std::uint32_t workers() const { return 4; }
    void run(std::uint32_t parts, const physics::task_set& what) const {
        for (std::uint32_t k = parts; k-- > 0;) what(k, k % 4);
    }
};

CELL_CASE("snapshots: what one worker has saved several go on from, and the other way round") {
    using world = physics::world<in_tree>;
    world w({.gravity = at(0, -10)});
    static_cast<void>(w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{}));
    for (int i = 0; i < 400; ++i)
        static_cast<void>(w.create_shape(w.create_body({.position = at(2 * (i % 100), 0.5 + i / 100)}),
                                         world::box{vec::filled(S(0.5))}));
    physics::thread_pool pool(2);
    turns four;
    const auto hashes = [&](auto&& step) {
        std::vector<std::uint64_t> all;
        for (int i = 0; i < 4; ++i) {
            step();
            all.push_back(w.state_hash());
        }
        return all;
    };
    const auto alone = [&] { w.step(S(1.0 / 64)); };
    const auto together = [&] { w.step(S(1.0 / 64), pool); };
    for (int round = 0; round < 2; ++round) {
        for (int i = 0; i < 4; ++i) round == 0 ? alone() : together();
        const auto of = snapshot(w);
        const auto expected = hashes(alone);
        CHECK(restore(of, w));
        CHECK(hashes(together) == expected);
        CHECK(restore(of, w));
        CHECK(hashes([&] { w.step(S(1.0 / 64), four); }) == expected);
    }
}

CELL_CASE("snapshots: they keep the geometry of shapes alive, and no longer than they hold it") {
    using world = physics::world<with_geometry>;
    const auto owners = [](const auto& geometry) { return static_cast<int>(geometry.data()->owners); };
    const quarry q;
    const int alone = owners(q.rock);
    {
        snapshot_of<with_geometry> of, other;
        {
            world w;
            const body_id b = w.create_body({.type = body_type::static_body});
            for (int i = 0; i < 3; ++i) static_cast<void>(w.create_shape(b, q.rock.shape()));
            const shape_id last = w.create_shape(b, q.rock.shape());
            w.destroy_shape(last);
            CHECK(owners(q.rock) == alone + 3);
            of.save(state_access::state_of(w));
            CHECK(owners(q.rock) == alone + 6);
            of.save(state_access::state_of(w));
            CHECK(owners(q.rock) == alone + 6);
            CHECK(restore(of, w));
            CHECK(owners(q.rock) == alone + 6);
        }
        CHECK(owners(q.rock) == alone + 3);
        other = of;
        CHECK(owners(q.rock) == alone + 6);
        const auto& itself = other;
        other = itself;
        CHECK(owners(q.rock) == alone + 6);
        other = std::move(of);
        CHECK(owners(q.rock) == alone + 3);
        {
            snapshot_of<with_geometry> third(other);
            const auto fourth = std::move(third);
            CHECK(owners(q.rock) == alone + 6);
            world w;
            CHECK(restore(fourth, w));
            CHECK(owners(q.rock) == alone + 9);
            CHECK(w.cast_ray(at(-2, 0), at(4, 0)));
        }
        const world nothing;
        other.save(state_access::state_of(nothing));
        CHECK(owners(q.rock) == alone);
    }
    // The last owner of all.
    snapshot_of<with_geometry> last;
    seen then;
    {
        yard<with_geometry> y(11);
        std::vector<seen> ignored;
        y.play(0, 20, ignored);
        then = y.look();
        last.save(state_access::state_of(y.w));
    }
    yard<with_geometry> y(12);
    REQUIRE(restore(last, y.w));
    last = {};
    CHECK(y.look() == then);
    std::vector<seen> log;
    y.play(20, 40, log);
    CHECK(log.size() == 20);
}

CELL_CASE("snapshots: an empty one is refused and nothing changes; a visitor may restore the world that it looks at") {
    using world = physics::world<in_tree>;
    yard<in_tree> y(13);
    std::vector<seen> ignored;
    y.play(0, 10, ignored);
    const auto of = snapshot(y.w);
    y.play(10, 12, ignored);
    const seen now = y.look();
    const auto refusal = [&](const snapshot_of<in_tree>& from) {
        try {
            static_cast<void>(restore(from, y.w));
        } catch (const physics::error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    CHECK(refusal({}) == "physics: restore: snapshot is empty; it must have been saved");
    CHECK(y.look() == now);
    int asked = 0;
    y.w.each_overlapping(world::box{vec::filled(S(9))}, {}, {}, [&](shape_id) {
        if (++asked == 2) CHECK(refusal(of).empty());
    });
    CHECK(asked >= 2);
    CHECK(y.look() != now);
}

}  // namespace snapshot_laws
}  // namespace
