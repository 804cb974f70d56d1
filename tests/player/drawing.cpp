// Lines of debug drawing in a recording: what a reader unpacks is what was drawn, within the stored resolution.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>

#include "../../samples/recording.hpp"
#include "reading.hpp"

namespace {

constexpr int ends = 6;
struct stroke {
    std::array<int, 2> body{};
    std::array<int, ends> at{}, change{}, size{};
    int colour = 0;
    bool foreseen = true;
};

/// Unpacks the lines of scenes in space.
struct line_reader {
    std::vector<std::uint16_t> models = std::vector<std::uint16_t>(22 * 66, 32768);
    std::array<std::uint16_t, 2> comes{32768, 32768}, stays{32768, 32768};
    std::uint16_t tinted = 32768;
    std::vector<std::uint16_t> foreseen = std::vector<std::uint16_t>(8, 32768);
    std::vector<int> tints;
    std::vector<stroke> lines;
    std::array<int, 2> known_of{};
    std::array<std::map<int, int>, 3> gone;

    int number(bit_reader& in, int model) { return in.number(models.data() + model * 66); }

    void read(bit_reader& in, std::size_t bodies) {
        tints.resize(bodies);
        for (int& tint : tints)
            if (in.get(tinted)) tint = number(in, 0);
        std::vector<stroke> next;
        stroke last;
        bool came = false, went = false;
        const auto arrive = [&] {
            for (came = false; in.get(comes[came]); came = true) {
                last.colour = number(in, 0);
                for (std::size_t k = 0; k < ends; ++k) {
                    if (k % 3 == 0) last.body[k / 3] += number(in, 1);
                    last.at[k] += number(in, 2 + static_cast<int>(k % 3));
                }
                last = {last.body, last.at, {}, {}, last.colour, true};
                next.push_back(last);
            }
        };
        for (stroke one : lines) {
            arrive();
            const bool remains = in.get(stays[went]);
            went = !remains;
            if (!remains) continue;
            move(in, one, last.foreseen);
            next.push_back(last = one);
        }
        arrive();
        for (auto& axis : gone) axis.clear();
        lines = next;
    }
    void move(bit_reader& in, stroke& one, bool was_foreseen) {
        if (one.body != known_of)
            for (auto& axis : gone) axis.clear();
        known_of = one.body;
        const auto copied = [&](std::size_t k) -> std::optional<int> {
            const auto same = gone[k % 3].find(one.at[k]), opposite = gone[k % 3].find(-one.at[k]);
            if (same != gone[k % 3].end()) return same->second;
            if (opposite != gone[k % 3].end()) return -opposite->second;
            return {};
        };
        std::array<int, ends> expected{};
        bool all = true;
        for (std::size_t k = 0; k < ends; ++k) {
            all &= copied(k).has_value();
            expected[k] = copied(k).value_or(one.at[k] + one.change[k]);
        }
        const bool hit = in.get(foreseen[(all ? 4u : 0u) + (was_foreseen ? 2u : 0u) + (one.foreseen ? 1u : 0u)]);
        const auto from = one.at;
        for (std::size_t k = 0; k < ends; ++k) {
            int to = expected[k];
            if (!hit) {
                const auto copy = copied(k);
                const int rest = number(in, copy ? 5 : (k < 3 ? 6 : 14) + one.size[k]);
                if (!copy) {
                    one.size[k] = 0;
                    for (int left = std::abs(rest); left > 0 && one.size[k] < 7; left /= 2) ++one.size[k];
                }
                to = copy.value_or(from[k] + one.change[k]) + rest;
            }
            one.change[k] = to - from[k];
            gone[k % 3][from[k]] = to;
            one.at[k] = to;
        }
        one.foreseen = hit;
    }
};

std::vector<std::uint32_t> palette_of(const std::string& json) {
    std::vector<std::uint32_t> colours;
    const std::string name = "\"palette\":[";
    for (std::size_t at = json.find(name) + name.size(); json[at - 1] != ']'; at = json.find_first_of(",]", at) + 1)
        colours.push_back(static_cast<std::uint32_t>(std::stoul(json.substr(at))));
    return colours;
}

samples::drawn_line line_of(const std::array<double, 3>& from, const std::array<double, 3>& to, std::uint32_t colour,
                            int body) {
    samples::drawn_line one;
    one.from = from;
    one.to = to;
    one.colour = colour;
    one.body = body;
    return one;
}
/// The edges of a box.
void add_box(std::vector<samples::drawn_line>& to, const std::array<double, 3>& low, const std::array<double, 3>& high,
             int body) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (unsigned i = 0; i < 8; ++i) {
            if ((i >> axis & 1u) != 0) continue;
            std::array<double, 3> a{}, b{};
            for (std::size_t k = 0; k < 3; ++k) a[k] = b[k] = (i >> k & 1u) != 0 ? high[k] : low[k];
            b[axis] = high[axis];
            to.push_back(line_of(a, b, 0x6060a0, body));
        }
}

/// Scenes of two bodies that stay where they are, so that the stream has lines alone after its first frame.
samples::recorded_scene still_scene() {
    samples::recorded_scene scene({.title = "drawn", .scalar = "float", .dimension = 3, .drawing = true});
    for (const double x : {-3.0, 4.0})
        scene.add_body(samples::motion::fixed, {samples::box(0.5, 0.5, 0.5)}, samples::solid(x, 1, 0));
    return scene;
}

}  // namespace

TEST_CASE("lines come back: boxes that grow and slide, lines that come, go, jump and change their colour, dots") {
    std::mt19937_64 bits(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11) / 9007199254740992.0;
    };
    samples::recorded_scene scene = still_scene();
    std::vector<std::vector<samples::drawn_line>> drawn;
    std::vector<std::uint32_t> tints;
    for (int f = 0; f < 150; ++f) {
        std::vector<samples::drawn_line> now;
        const double t = 0.1 * f;
        add_box(now, {-4 - t, 0.1 * t, -1}, {-2 + t, 2 + 0.2 * t, 1}, 0);
        // It is not there for a while.
        if (f < 40 || f > 50) add_box(now, {3 + t, 0, -1}, {5 + t, 2, std::sin(t) + 2}, 1);
        now.push_back(line_of({4, 1, 0}, {4, 1, f % 3 ? 0.0 : t}, 0x60e0e0, 1));
        for (std::uint64_t count = bits() % 4; count > 0; --count)
            now.push_back(line_of({between(-9, 9), 0, between(-9, 9)}, {0, between(-9, 9), 0},
                                  bits() % 2 ? 0xff0000u : 0x00ff00u, -1));
        for (const samples::drawn_line& one : now) scene.draw(one);
        tints.push_back(f % 10 < 5 ? 0xabcdefu : 0x123456u);
        scene.tint(1, tints.back());
        drawn.push_back(now);
        scene.commit();
    }
    const std::string json = scene.json();
    const std::vector<std::uint32_t> colours = palette_of(json);
    const double grid = field(json, "grid"), step = 16 * grid;
    const std::array<std::array<double, 3>, 2> places = {{{-3, 1, 0}, {4, 1, 0}}};

    bit_reader in(unpacked(json));
    // The poses of the first frame, of which this test knows only how many numbers they take.
    std::vector<std::uint16_t> models(7 * 8 * 66, 32768), counts(66, 32768);
    std::array<std::uint16_t, 2> moved{32768, 32768};
    for (int body = 0; body < 2; ++body)
        if (in.get(moved[0]))
            for (int k = 0; k < 7; ++k) in.number(models.data() + k * 8 * 66);
    line_reader reader;
    std::size_t total = 0;
    for (std::size_t f = 0; f < drawn.size(); ++f) {
        REQUIRE(in.number(counts.data()) == 0);  // new contacts
        reader.read(in, 2);
        REQUIRE(reader.lines.size() == drawn[f].size());
        total += drawn[f].size();
        CHECK(colours.at(static_cast<std::size_t>(reader.tints[1])) == tints[f]);
        for (std::size_t i = 0; i < drawn[f].size(); ++i) {
            const stroke& read = reader.lines[i];
            double worst = 0;
            for (std::size_t k = 0; k < ends; ++k) {
                const double at = places[static_cast<std::size_t>(read.body[k / 3])][k % 3] + read.at[k] * step;
                worst = std::max(worst, std::fabs(at - (k < 3 ? drawn[f][i].from : drawn[f][i].to)[k % 3]));
            }
            CHECK(worst <= 0.501 * step + grid);
            CHECK(colours.at(static_cast<std::size_t>(read.colour)) == drawn[f][i].colour);
        }
    }
    CHECK(field(json, "lines") == static_cast<double>(total));
}

TEST_CASE("lines that rest, or that a body takes along, cost nearly nothing") {
    const auto size_of = [](double speed, int frames, bool drawing = true) {
        samples::recorded_scene scene({.title = "drawn", .scalar = "float", .dimension = 3, .drawing = drawing});
        for (int b = 0; b < 100; ++b) scene.add_body(samples::motion::dynamic, {samples::box(0.5, 0.5, 0.5)});
        for (int f = 0; f < frames; ++f) {
            for (int b = 0; b < 100; ++b) {
                const double x = 2 * b + speed * f / 30, y = 1 + std::sin(speed * f * (b + 1) / 300.0);
                scene.place(b, samples::solid(x, y, 0));
                std::vector<samples::drawn_line> box;
                add_box(box, {x - 0.5, y - 0.5, -0.5}, {x + 0.5, y + 0.5, 0.5}, b);
                for (std::size_t i = 0; drawing && i < box.size(); ++i) scene.draw(box[i]);
            }
            scene.commit();
        }
        return scene.json().size();
    };
    const std::size_t once = size_of(0, 1), rest = size_of(0, 301);
    MESSAGE("1,200 lines at rest: " << once << " bytes for the first frame, " << rest << " for 301");
    CHECK(rest - once < 1000);
    const std::size_t bodies = size_of(3, 301, false), both = size_of(3, 301);
    MESSAGE("100 bodies in motion: " << bodies << " bytes, with their boxes " << both);
    CHECK(both - bodies < bodies / 3);
}

TEST_CASE("drawing is refused where it is not stored, and bad lines with the value") {
    samples::recorded_scene scene = still_scene();
    CHECK_THROWS_WITH(scene.draw(line_of({0, std::nan(""), 0}, {}, 0, 0)),
                      "samples: recording: line is nan; it must be finite");
    CHECK_THROWS_AS(scene.draw(line_of({}, {}, 0, 2)), std::out_of_range);
    CHECK_THROWS_AS(scene.tint(2, 0), std::out_of_range);
    samples::recorded_scene plain({.title = "plain", .scalar = "float", .dimension = 3});
    CHECK_THROWS_AS(plain.draw(samples::drawn_line{}), std::logic_error);
    plain.commit();
    CHECK(plain.json().find("palette") == std::string::npos);
}
