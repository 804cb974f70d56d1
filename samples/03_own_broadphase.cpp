// A broadphase of your own: a table of buckets for a side-scroller, and the same world as with any other.
#include <physics.hpp>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <vector>

// An index knows where boxes are; the library does the rest: margins, filters, which pairs begin and end, exact
// queries. This one cuts the level into columns of 4 m; a box is in the list of every column that it touches.
template <class Space>
class columns {
public:
    using aabb = typename Space::aabb;

    void insert(const auto& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        places_[id] = span_of(all.box(id));
        for (int c = places_[id].first; c <= places_[id].last; ++c) lists_[c].push_back(id);
    }
    void erase(const auto&, std::uint32_t id) {
        for (int c = places_[id].first; c <= places_[id].last; ++c) std::erase(lists_[c], id);
    }
    // These have left their boxes.
    void update(const auto& all, const std::uint32_t* ids, std::uint32_t n) {
        for (std::uint32_t i = 0; i < n; ++i) {
            if (!all.has(ids[i])) continue;
            erase(all, ids[i]);
            insert(all, ids[i]);
        }
    }
    // Each two that share a column, one of which has moved: once, in the first column that they share.
    bool find(const auto& all, auto&& emit) const {
        for (int c = 0; c < count; ++c)
            for (std::size_t i = 0; i < lists_[c].size(); ++i)
                for (std::size_t k = 0; k < i; ++k) {
                    const std::uint32_t a = lists_[c][i], b = lists_[c][k];
                    const bool here = c == std::max(places_[a].first, places_[b].first);
                    if (here && (all.stale(a) || all.stale(b))) emit(a, b);
                }
        return false;
    }
    // What may overlap a box: for queries.
    void each_near(const auto&, const aabb& box, auto&& visit) const {
        const span s = span_of(box);
        for (int c = s.first; c <= s.last; ++c)
            for (const std::uint32_t id : lists_[c])
                if (c == std::max(places_[id].first, s.first) && !visit(id)) return;
    }

private:
    static constexpr int count = 32;
    struct span {
        int first = 0, last = 0;
    };

    // What is beside the level is in its first or last column: nothing is lost.
    static int column(typename Space::scalar x) {
        const double c = (static_cast<double>(x) + 64) / 4;
        return c > 0 ? c < count ? static_cast<int>(c) : count - 1 : 0;
    }
    static span span_of(const aabb& box) { return {column(box.lower.x), column(box.upper.x)}; }

    std::vector<std::uint32_t> lists_[count];
    std::vector<span> places_;
};

// A policy names its stage, and binds itself to the space of the recipe.
struct side_scroller {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = physics::indexed_broadphase<Space, columns<Space>>;
};

struct plain : physics::recipe<float, 2> {};
struct own : physics::recipe<float, 2, side_scroller> {};
struct swept : physics::recipe<float, 2, physics::sweep_and_prune> {};
struct gridded : physics::recipe<float, 2, physics::grid> {};
struct hashed : physics::recipe<float, 2, physics::hash_grid> {};

// A level with steps, on which crates rain; ten seconds of it.
template <class Recipe>
std::uint64_t play(const char* name) {
    using world = physics::world<Recipe>;
    world level{{.gravity = {0, -10}}};
    level.create_shape(level.create_body({.type = physics::body_type::static_body}), typename world::halfspace{});
    for (int i = 0; i < 20; ++i) {
        const float x = static_cast<float>(6 * i - 57), height = static_cast<float>(i % 4 + 2) / 4;
        const auto step = level.create_body({.type = physics::body_type::static_body, .position = {x, height}});
        level.create_shape(step, typename world::box{{1.5f, height}});
    }
    for (int i = 0; i < 150; ++i) {
        const float x = static_cast<float>(3 * i - 220) / 4, y = static_cast<float>(8 + i * 7 % 11) / 2;
        const auto crate = level.create_body({.position = {x, y}});
        level.create_shape(crate, typename world::box{{0.5f, static_cast<float>(i % 3 + 2) / 8}});
        if (i % 10 == 0) level.set_linear_velocity(crate, {i % 20 ? 9.0f : -9.0f, 0});
    }
    for (int frame = 0; frame < 600; ++frame) level.step(1.0f / 60);
    std::printf("%-16s %4u contacts, state %016" PRIx64 "\n", name, level.contacts().size(), level.state_hash());
    return level.state_hash();
}

int main() {
    const std::uint64_t expected = play<plain>("dynamic_tree");
    bool same = play<own>("your own") == expected;
    same = play<swept>("sweep_and_prune") == expected && same;
    same = play<gridded>("grid") == expected && same;
    same = play<hashed>("hash_grid") == expected && same;
    std::puts(same ? "What moves how does not depend on how pairs are found." : "They differ: this is a bug.");
    return same ? 0 : 1;
}
