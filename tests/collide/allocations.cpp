// No query allocates: every call for memory is counted, the library's own and those of the language.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <tuple>
#include <vector>

#include "counted_memory.hpp"

namespace {

using physics::fixed32;

/// What a cell of the test works with.
template <class Scalar, int Dimension>
struct setup {
    using S = Scalar;
    static constexpr int D = Dimension;
    using vec = physics::vec<S, D>;
    using rotation = physics::rotation<S, D>;
    using transform = physics::transform<S, D>;

    std::mt19937_64 engine{1};
    double number(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
    }
    vec place(double far) {
        vec v;
        for (int i = 0; i < D; ++i) v[i] = S(number(-far, far));
        return v;
    }
    rotation turn() {
        const auto n = [&] { return S(number(-1, 1)); };
        if constexpr (D == 2) return normalized(rotation{n(), n()});
        else return normalized(rotation{n(), n(), n(), n()});
    }
    transform pose(double far) { return {place(far), turn()}; }
    /// In touch, close by, far away; in a frame of its own, or along the axes.
    transform any_pose(int i) {
        const double far[] = {0.25, 1, 1.5, 4};
        transform t = pose(far[i % 4]);
        if (i % 5 == 0) t.rotation = {};
        if (i % 11 == 0) t.position = {};
        return t;
    }
};

template <class S, int D>
physics::hull_geometry<S, D> rock() {
    setup<S, D> random;
    std::vector<physics::vec<S, D>> points;
    for (int i = 0; i < 40; ++i) points.push_back(random.place(0.6));
    return physics::hull_geometry<S, D>::build(points.data(), 40);
}
template <class S>
physics::compound_geometry<S, 2> table(const physics::hull_geometry<S, 2>& hull) {
    std::vector<physics::compound_child<S, 2>> children;
    for (int i = 0; i < 6; ++i) children.push_back({physics::box<S, 2>{{S(0.25), S(0.5)}}, {S(i * 0.5 - 1.25), S(0)}});
    children.push_back({hull.shape(), {S(0), S(1)}});
    return physics::compound_geometry<S, 2>::build(children.data(), 7);
}
template <class S>
physics::compound_geometry<S, 3> table(const physics::hull_geometry<S, 3>& hull) {
    std::vector<physics::compound_child<S, 3>> children;
    for (int i = 0; i < 6; ++i)
        children.push_back({physics::box<S, 3>{{S(0.25), S(0.5), S(0.25)}}, {S(i * 0.5 - 1.25), S(0), S(0)}});
    children.push_back({hull.shape(), {S(0), S(1), S(0)}});
    return physics::compound_geometry<S, 3>::build(children.data(), 7);
}
std::vector<double> hills(int n) {
    std::vector<double> heights;
    for (int i = 0; i < n; ++i) heights.push_back(0.25 * ((i * 7) % 5) - 0.5);
    return heights;
}
template <class S>
std::vector<S> to_scalars(const std::vector<double>& values) {
    std::vector<S> result;
    for (const double x : values) result.push_back(S(x));
    return result;
}

/// All shapes of a dimension, and what keeps their geometry.
template <class S, int D>
struct shapes;
template <class S>
struct shapes<S, 2> {
    physics::hull_geometry<S, 2> hull = rock<S, 2>();
    physics::compound_geometry<S, 2> compound = table(hull);
    physics::chain_geometry<S, 2> chain = [] {
        std::vector<physics::vec<S, 2>> points;
        for (int i = 20; i >= 0; --i) points.push_back({S(0.5 * i - 5), S(0.25 * ((i * 7) % 5) - 0.5)});
        return physics::chain_geometry<S, 2>::build(points.data(), 21);
    }();
    physics::heightfield_geometry<S, 2> field = [] {
        const auto heights = to_scalars<S>(hills(20));
        return physics::heightfield_geometry<S, 2>::build(heights.data(), 20, S(0.5));
    }();
    physics::tile_grid_geometry<S, 2> tiles = [] {
        std::vector<std::uint8_t> cells;
        for (int i = 0; i < 64; ++i) cells.push_back(static_cast<std::uint8_t>((i * 5) % 7 < 3 ? 1 : 0));
        return physics::tile_grid_geometry<S, 2>::build(cells.data(), 8, 8, S(0.5));
    }();

    /// What the worlds hold; the other convex shapes meet in the same functions.
    auto usual() const {
        return std::tuple(physics::ball<S, 2>{}, physics::capsule<S, 2>{}, physics::box<S, 2>{}, hull.shape(),
                          hull.shape(S(0.125)));
    }
    auto unusual() const {
        return std::tuple(physics::rounded_box<S, 2>{{S(0.5), S(0.25)}, S(0.125)}, physics::segment<S, 2>{},
                          physics::triangle<S, 2>{});
    }
    auto of_parts() const {
        return std::tuple(chain.shape(), chain.shape(S(0.125)), field.shape(), tiles.shape(), compound.shape());
    }
    template <template <class...> class Recipe>
    using recipe =
        Recipe<physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::chain,
                               physics::heightfield, physics::tile_grid, physics::compound, physics::halfspace>>;
};
template <class S>
struct shapes<S, 3> {
    physics::hull_geometry<S, 3> hull = rock<S, 3>();
    physics::compound_geometry<S, 3> compound = table(hull);
    physics::mesh_geometry<S, 3> mesh = [] {
        std::vector<physics::vec<S, 3>> points;
        std::vector<std::uint32_t> triangles;
        const auto heights = hills(64);
        for (std::uint32_t i = 0; i < 64; ++i) points.push_back({S(0.5 * (i % 8)), S(heights[i]), S(0.5 * (i / 8))});
        for (std::uint32_t i = 0; i < 55; ++i)
            if (i % 8 < 7) triangles.insert(triangles.end(), {i, i + 8, i + 9, i, i + 9, i + 1});
        return physics::mesh_geometry<S, 3>::build(points.data(), 64, triangles.data(),
                                                   static_cast<std::uint32_t>(triangles.size() / 3));
    }();
    physics::heightfield_geometry<S, 3> field = [] {
        const auto heights = to_scalars<S>(hills(64));
        return physics::heightfield_geometry<S, 3>::build(heights.data(), 8, 8, S(0.5), S(0.5));
    }();

    auto usual() const {
        return std::tuple(physics::ball<S, 3>{}, physics::capsule<S, 3>{}, physics::box<S, 3>{}, hull.shape(),
                          hull.shape(S(0.125)), physics::cylinder<S, 3>{},
                          physics::cylinder<S, 3>{.rounding = S(0.125)});
    }
    auto unusual() const {
        return std::tuple(physics::rounded_box<S, 3>{{S(0.5), S(0.25), S(0.25)}, S(0.125)}, physics::segment<S, 3>{},
                          physics::triangle<S, 3>{}, physics::cone<S, 3>{},
                          physics::cone<S, 3>{.upper_radius = S(0.25), .rounding = S(0.125)});
    }
    auto of_parts() const { return std::tuple(mesh.shape(), mesh.shape(S(0.125)), field.shape(), compound.shape()); }
    template <template <class...> class Recipe>
    using recipe =
        Recipe<physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::cylinder,
                               physics::mesh, physics::heightfield, physics::compound, physics::halfspace>>;
};

/// Calls f with each shape of a tuple.
template <class Tuple, class F>
void each(const Tuple& tuple, F&& f) {
    std::apply([&](const auto&... shape) { (f(shape), ...); }, tuple);
}

TEST_CASE_TEMPLATE_DEFINE("allocations: no query of two shapes, and no ray", Cell, pairs) {
    using S = typename Cell::S;
    constexpr int D = Cell::D;
    const shapes<S, D> all;
    Cell random;
    const auto none = [&](auto&& query) {
        int hits = 0;
        for (int i = 0; i < 40; ++i) {
            const auto at = random.any_pose(i);
            const auto way = random.place(3);
            const unsigned long made = calls_of([&] { hits += query(at, way); });
            REQUIRE(made == 0);
        }
        CHECK(hits > 0);
    };
    const auto solids = std::tuple_cat(all.usual(), all.unusual(), std::tuple(physics::halfspace<S, D>{}));
    each(std::tuple_cat(solids, all.of_parts()), [&](const auto& a) {
        none([&](const auto& at, const auto& way) {
            return int(cast_ray(a, typename Cell::transform{}, at.position + way, -way * S(2)).hit);
        });
    });
    // The kernels see no more of a shape than its core: two others for each, one of them round, are enough.
    const auto others = std::tuple(physics::capsule<S, D>{}, all.hull.shape(S(0.125)));
    each(solids, [&](const auto& a) {
        each(others, [&](const auto& b) {
            none([&](const auto& at, const auto& way) {
                physics::gjk_cache cache;
                int touching = overlap(a, b, at) + overlap(a, b, at, cache);
                touching += !(distance(a, b, at).distance > S(0)) + !(distance(a, b, at, cache).distance > S(0));
                touching += !(separation(a, b, at).distance > S(0)) + !(separation(a, b, at, cache).distance > S(0));
                physics::sweep<S, D> still, moving;
                moving.start = at.position;
                moving.end = at.position + way;
                moving.rotation = at.rotation;
                if constexpr (D == 2) moving.turn = S(2);
                else moving.turn = way;
                touching += time_of_impact(a, still, b, moving).state == physics::impact_state::hit;
                return touching + int(cast_shape(a, b, at, way).hit);
            });
        });
    });
    each(all.of_parts(), [&](const auto& a) {
        each(others, [&](const auto& b) {
            none([&](const auto& at, const auto& way) {
                return int(cast_shape(a, b, at, way).hit) + !(separation(a, b, at, S(1)).distance > S(1));
            });
        });
    });
}

template <class S, int D>
struct world_of {
    template <class Set>
    struct level : physics::recipe<S, D, Set> {};
    using world = physics::world<typename shapes<S, D>::template recipe<level>>;
};

/// The default narrowphase for the shapes of a recipe, pair by pair.
template <class Policy, class S, int D, class Set>
struct narrowphase;
template <class Policy, class S, int D, template <class, int> class... Shapes>
struct narrowphase<Policy, S, D, physics::shapes<Shapes...>> {
    using any = physics::any_shape<S, D, Shapes...>;
    using query = physics::narrowphase_query<S, D, Shapes...>;
    using in = typename Policy::template in<S, D, Shapes...>;
};
template <class Set>
struct itself {
    using type = Set;
};

template <class Policy, class Cell>
void no_manifold_allocates() {
    using S = typename Cell::S;
    constexpr int D = Cell::D;
    using narrow = narrowphase<Policy, S, D, typename shapes<S, D>::template recipe<itself>::type>;
    const shapes<S, D> all;
    std::vector<typename narrow::any> any;
    each(std::tuple_cat(all.usual(), all.of_parts()), [&](const auto& shape) { any.emplace_back(shape); });
    any.emplace_back(physics::halfspace<S, D>{});
    Cell random;
    physics::manifold_list<S, D> found;
    found.reserve(4096);
    std::size_t contacts = 0;
    for (const auto& a : any)
        for (const auto& b : any)
            for (int i = 0; i < 30; ++i) {
                const typename narrow::query query{&a, &b, random.any_pose(i)};
                found.clear();
                const unsigned long made = calls_of([&] { narrow::in::collide(&query, 1, S(0.0625), found); });
                REQUIRE(made == 0);
                contacts += found.size();
            }
    CHECK(contacts > 2000);
}
TEST_CASE_TEMPLATE_DEFINE("allocations: no manifold, in a list that has room", Cell, manifolds) {
    no_manifold_allocates<physics::best_per_pair, Cell>();
    if constexpr (std::is_same_v<typename Cell::S, float>) no_manifold_allocates<physics::gjk_mpr, Cell>();
}

TEST_CASE_TEMPLATE_DEFINE("allocations: no query of a world", Cell, worlds) {
    using S = typename Cell::S;
    constexpr int D = Cell::D;
    using world = typename world_of<S, D>::world;
    const shapes<S, D> all;
    Cell random;
    world w;
    for (int i = 0; i < 6; ++i) {
        each(all.usual(), [&](const auto& shape) {
            const auto at = random.pose(8);
            const auto type = i % 2 ? physics::body_type::static_body : physics::body_type::dynamic_body;
            const auto body = w.create_body({.type = type, .position = at.position, .rotation = at.rotation});
            w.create_shape(body, shape);
        });
        each(all.of_parts(), [&](const auto& shape) {
            const auto at = random.pose(8);
            const auto body = w.create_body(
                {.type = physics::body_type::static_body, .position = at.position, .rotation = at.rotation});
            w.create_shape(body, shape);
        });
    }
    unsigned long hits = 0;
    const auto ask = [&](int i) {
        const auto at = random.pose(8);
        const auto way = random.place(8);
        const unsigned long made = calls_of([&] {
            hits += static_cast<bool>(w.cast_ray(at.position, way));
            w.each_hit_along_ray(at.position, way, {}, [&](const auto&) { ++hits; });
            if (i % 2) hits += static_cast<bool>(w.cast_shape(physics::box<S, D>{}, at, way));
            else hits += static_cast<bool>(w.cast_shape(all.hull.shape(), at, way));
            w.each_overlapping(physics::capsule<S, D>{S(1), S(1)}, at, {}, [&](auto) { ++hits; });
            w.each_at(at.position, {}, [&](auto) { ++hits; });
            hits += static_cast<bool>(w.closest_shape(at.position, S(2)));
        });
        REQUIRE(made == 0);
    };
    for (int i = 0; i < 100; ++i) ask(i);
    for (int i = 0; i < 4; ++i) w.step(S(1.0 / 64));
    for (int i = 0; i < 100; ++i) ask(i);
    CHECK(hits > 200);
}

template <class Broadphase, class Cell>
void no_search_allocates() {
    using S = typename Cell::S;
    constexpr int D = Cell::D;
    typename Broadphase::template in<physics::space<S, D>> proxies;
    Cell random;
    const auto box_at = [&](double far) {
        const auto at = random.place(far);
        return physics::aabb<S, D>{at, at + Cell::vec::filled(S(random.number(0.1, 1)))};
    };
    for (std::uint32_t i = 0; i < 500; ++i) proxies.insert(i, box_at(8));
    unsigned long hits = 0;
    for (int i = 0; i < 100; ++i) {
        const auto box = box_at(8);
        const physics::ray<S, D> ray{box.lower, random.place(16)};
        const unsigned long made = calls_of([&] {
            proxies.each_overlapping(box, {}, [&](std::uint32_t) { ++hits; });
            proxies.each_along(ray, {}, [&](const physics::proxy_hit<S>&) { return ++hits, S(1); });
        });
        REQUIRE(made == 0);
        if (i == 50) proxies.pairs([](std::uint32_t, std::uint32_t) { return true; });
    }
    CHECK(hits > 100);
}
TEST_CASE_TEMPLATE_DEFINE("allocations: no search of a broadphase", Cell, broadphases) {
    no_search_allocates<physics::dynamic_tree, Cell>();
    no_search_allocates<physics::sweep_and_prune, Cell>();
    no_search_allocates<physics::grid, Cell>();
    no_search_allocates<physics::hash_grid, Cell>();
    no_search_allocates<physics::all_pairs, Cell>();
}

#define ALL_CELLS setup<float, 2>, setup<float, 3>, setup<fixed32, 2>, setup<fixed32, 3>
TEST_CASE_TEMPLATE_INVOKE(pairs, ALL_CELLS);
TEST_CASE_TEMPLATE_INVOKE(manifolds, ALL_CELLS);
TEST_CASE_TEMPLATE_INVOKE(worlds, ALL_CELLS);
TEST_CASE_TEMPLATE_INVOKE(broadphases, ALL_CELLS);

TEST_CASE("allocations: those that there are are counted") {
    CHECK(calls_of([] { physics::buffer<int>().push_back(1); }) == 1);
    CHECK(calls_of([] { (void)rock<float, 3>(); }) > 2);
    // Volatile, as compilers may leave out a new expression whose result nobody sees.
    CHECK(calls_of([] {
              std::vector<int>* volatile list = new std::vector<int>(3);
              delete list;
          }) == 2);
}

}  // namespace
