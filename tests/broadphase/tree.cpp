// Packed trees: compact on any input, complete, and no worse for what has happened to them.
#include <doctest/doctest.h>

#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace physics::detail;

using space = physics::space<float, 3>;
using index = tree_index<space>;

struct source {
    std::mt19937 engine{7};
    float number(double low, double high) {
        return static_cast<float>(low + (high - low) * (static_cast<double>(engine()) / 4294967296.0));
    }
};

std::vector<packed_item> arranged(std::vector<packed_item> items) {
    std::vector<packed_item> spare(items.size());
    arrange<3>(items.data(), spare.data(), static_cast<std::uint32_t>(items.size()));
    return items;
}
std::vector<packed_item> uniform(std::uint32_t count, source& random) {
    std::vector<packed_item> items(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        for (float& m : items[i].middle) m = random.number(0, 1);
        items[i].id = i;
    }
    return items;
}
/// The sides of the boxes around each `eights` items in a row, on average.
double side_of(const std::vector<packed_item>& items, std::size_t eights) {
    double sum = 0;
    std::size_t groups = 0;
    for (std::size_t i = 0; i + eights <= items.size(); i += eights, ++groups)
        for (int k = 0; k < 3; ++k) {
            float low = items[i].middle[k], high = low;
            for (std::size_t n = i; n < i + eights; ++n) {
                low = std::min(low, items[n].middle[k]);
                high = std::max(high, items[n].middle[k]);
            }
            sum += high - low;
        }
    return sum / (3.0 * static_cast<double>(groups));
}

TEST_CASE("arrange: a permutation, whose eights, and eights of eights, are compact") {
    source random;
    for (const std::uint32_t count : {0u, 1u, 8u, 9u, 63u, 64u, 65u, 1000u, 4096u, 5000u}) {
        const auto items = arranged(uniform(count, random));
        std::vector<bool> seen(count);
        for (const packed_item& item : items) {
            REQUIRE(!seen[item.id]);
            seen[item.id] = true;
        }
        if (count < 1000) continue;
        // Cubes that hold as many have this side.
        CHECK(side_of(items, 8) <= 1.1 * std::cbrt(8.0 / count));
        CHECK(side_of(items, 64) <= 1.2 * std::cbrt(64.0 / count));
    }
}

TEST_CASE("arrange: strays, clusters, lines and equal places do not spoil it") {
    source random;
    const std::uint32_t count = 4096;
    const auto plain = uniform(count, random);
    const double fair = side_of(arranged(plain), 8);
    auto strays = plain;
    for (int k = 0; k < 8; ++k) strays[static_cast<std::size_t>(k) * 500].middle[k % 3] = std::ldexp(1.0f, 10 * k + 20);
    auto sorted = arranged(strays);
    std::erase_if(sorted, [](const packed_item& i) { return i.middle[0] + i.middle[1] + i.middle[2] > 3; });
    CHECK(side_of(sorted, 8) <= 3 * fair);
    // Eight clusters, each a thousand times smaller.
    auto clusters = plain;
    for (packed_item& i : clusters)
        for (int k = 0; k < 3; ++k) i.middle[k] = i.middle[k] / 1000 + static_cast<float>(i.id >> k & 1);
    CHECK(side_of(arranged(clusters), 8) <= 3 * fair * 2 / 1000);
    // Halves, quarters, eighths, ...: every item another order of magnitude.
    std::vector<packed_item> series(126);
    for (std::uint32_t i = 0; i < series.size(); ++i) series[i] = {{std::ldexp(1.0f, -static_cast<int>(i)), 0, 0}, i};
    std::shuffle(series.begin(), series.end(), random.engine);
    const auto in_order = arranged(series);
    for (std::size_t i = 0; i + 8 < 90; i += 8) {
        const auto larger = [](const packed_item& a, const packed_item& b) { return a.middle[0] < b.middle[0]; };
        const auto most = *std::max_element(in_order.data() + i, in_order.data() + i + 8, larger);
        const auto least = *std::min_element(in_order.data() + i + 8, in_order.data() + i + 16, larger);
        CHECK(most.middle[0] <= std::max(least.middle[0], 1e-28f));
    }
    // All in one place: any order will do, and it ends.
    arranged(std::vector<packed_item>(100000));
}

/// Boxes in a tree, and how many blocks a search looks at on average.
struct population {
    proxies<space> all;
    index trees;
    std::vector<space::aabb> boxes;
    source random;

    explicit population(std::uint32_t count) : boxes(count) {
        for (std::uint32_t id = 0; id < count; ++id) {
            boxes[id] = anywhere();
            all.insert(id, boxes[id], {});
            trees.insert(all, id);
        }
        step();
    }
    space::aabb anywhere() {
        const space::vec at{random.number(0, 30), random.number(0, 30), random.number(0, 30)};
        return {at, at + space::vec{1, 1, 1}};
    }
    void move(std::uint32_t id, space::vec way) {
        boxes[id].lower += way;
        boxes[id].upper += way;
        if (!all.holds(id, boxes[id])) all.move(id, boxes[id], way);
    }
    void step() {
        trees.update(all, all.dirty_for_index().begin(), all.dirty_for_index().size());
        all.flush_to_index();
        trees.find(all, [](std::uint32_t, std::uint32_t) {});
        trees.end_search();
        all.clear_dirty();
    }
    double cost(const index& of) {
        double sum = 0;
        for (int i = 0; i < 500; ++i) sum += of.blocks_tested(anywhere());
        return sum / 500;
    }
    /// Against trees into which the same boxes have just come.
    double relative_cost() {
        index fresh;
        for (std::uint32_t id = 0; id < boxes.size(); ++id) fresh.insert(all, id);
        fresh.update(all, nullptr, 0);
        return cost(trees) / cost(fresh);
    }
};

TEST_CASE("tree: long runs of drifting, teleporting, coming and going leave queries as cheap as they were") {
    const std::uint32_t count = 4000;
    population fresh(count);
    CHECK(fresh.cost(fresh.trees) <= 16);
    for (const int kind : {0, 1, 2, 3}) {
        CAPTURE(kind);
        population p(count);
        double worst = 0;
        for (int step = 0; step < 400; ++step) {
            for (std::uint32_t id = 0; id < count; ++id) {
                const auto rare = p.random.engine() % 100;
                const space::vec little{p.random.number(-0.2, 0.2), p.random.number(-0.2, 0.2),
                                        p.random.number(-0.2, 0.2)};
                // All drift; a few drift; a few teleport; two streams pass through each other.
                if (kind == 0) p.move(id, little);
                if (kind == 1 && rare < 3) p.move(id, little);
                if (kind == 2 && rare < 2) p.move(id, p.anywhere().lower - p.boxes[id].lower);
                if (kind == 3) p.move(id, {id % 2 ? 0.1f : -0.1f, 0, 0});
                // What drifts out comes back in.
                for (int k = 0; k < 3; ++k) {
                    space::vec back{};
                    back[k] = p.boxes[id].lower[k] > 31 ? -31.0f : p.boxes[id].lower[k] < -1 ? 31.0f : 0.0f;
                    if (back[k] != 0) p.move(id, back);
                }
            }
            p.step();
            if (step % 50 == 49) worst = std::max(worst, p.relative_cost());
        }
        CHECK(worst <= 2);
    }
}

TEST_CASE("tree: insertion in sorted order, and one by one with queries in between, makes no worse a tree") {
    const std::uint32_t count = 4000;
    population sorted(0);
    for (std::uint32_t id = 0; id < count; ++id) {
        const float x = static_cast<float>(id) * 0.01f, y = static_cast<float>(id % 50);
        sorted.all.insert(id, {{x, y, 0}, {x + 1, y + 1, 1}}, {});
        sorted.trees.insert(sorted.all, id);
        if (id % 16 == 0) sorted.trees.update(sorted.all, nullptr, 0);
    }
    double sum = 0;
    for (int i = 0; i < 40; ++i)
        sum += sorted.trees.blocks_tested({{static_cast<float>(i), 20, 0}, {static_cast<float>(i) + 1, 21, 1}});
    CHECK(sum / 40 <= 24);
}

TEST_CASE("tree: a million boxes in one place, of which few move") {
    proxies<space> all;
    index trees;
    const std::uint32_t count = 1000000;
    for (std::uint32_t id = 0; id < count; ++id) {
        all.insert(id, {{0, 0, 0}, {1, 1, 1}}, {.movable = false});
        trees.insert(all, id);
    }
    all.insert(count, {{5, 0, 0}, {6, 1, 1}}, {});
    trees.insert(all, count);
    const auto step = [&] {
        std::uint32_t found = 0;
        trees.update(all, all.dirty_for_index().begin(), all.dirty_for_index().size());
        all.flush_to_index();
        trees.find(all, [&](std::uint32_t, std::uint32_t) { ++found; });
        trees.end_search();
        all.clear_dirty();
        return found;
    };
    CHECK(step() == 0);
    all.move(count, {{0.5, 0, 0}, {1.5, 1, 1}}, {});
    CHECK(step() == count);
    CHECK(step() == 0);
    std::uint32_t seen = 0;
    trees.each_near(all, {{0, 0, 0}, {0, 0, 0}}, [&](const auto&) { return ++seen < 10; });
    CHECK(seen == 10);
}

}  // namespace
