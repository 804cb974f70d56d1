// The recording of the samples: what a reader unpacks is what was recorded, within the stored resolution.
#include "../../samples/recording.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "reading.hpp"

namespace {

using row = std::array<int, 7>;
struct frame {
    std::vector<row> bodies, contacts;
};

/// Unpacks all frames; `moves` says which bodies are not static.
std::vector<frame> decode(const std::string& json, const std::vector<bool>& moves) {
    const bool plane = field(json, "dimension") == 2;
    bit_reader in(unpacked(json));
    std::vector<std::uint16_t> models(22 * 8 * 66, 32768), flags(5, 32768);
    const auto model = [&](int kind, int size) { return models.data() + (kind * 8 + size) * 66; };
    const auto size_of = [](int value) {
        int bits = 0;
        for (unsigned left = static_cast<unsigned>(std::abs(value)); left; left >>= 1) ++bits;
        return std::min(bits, 7);
    };
    struct track {
        row now{}, before{}, size{};
        bool moved = false;
    };
    std::vector<track> bodies(moves.size()), contacts;
    std::vector<frame> frames;
    std::uint32_t check = 2166136261u;
    const auto note = [&](int value) { check = (check ^ static_cast<std::uint32_t>(value)) * 16777619u; };

    for (int f = 0; f < field(json, "frames"); ++f) {
        frame out;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            track& one = bodies[b];
            if (moves[b] || f == 0) {
                one.moved = in.get(flags[one.moved]);
                for (std::size_t k = 0; k < (plane ? 3 : 7); ++k) {
                    const int former = one.now[k];
                    if (one.moved) {
                        const int rest = in.number(model(static_cast<int>(k), one.size[k]));
                        one.size[k] = size_of(rest);
                        one.now[k] = rest + (f ? 2 * former - one.before[k] : 0);
                    }
                    one.before[k] = f ? former : one.now[k];
                    note(one.now[k]);
                }
            }
            out.bodies.push_back(one.now);
        }
        std::vector<track> next;
        const auto read = [&](track contact, bool continued) {
            const bool moved = !continued || in.get(flags[2 + contact.moved]);
            for (std::size_t k = 0; moved && k < 7; ++k) {
                if (plane && (k == 2 || k == 5)) continue;
                int step = 0;
                if (continued) {
                    const int rest = in.number(model(static_cast<int>(7 + k), contact.size[k]));
                    contact.size[k] = size_of(rest);
                    step = contact.before[k] + rest;
                } else {
                    step = in.number(model(static_cast<int>(15 + k), 0));
                }
                contact.now[k] += step;
                contact.before[k] = continued && k < 3 ? step : 0;  // here: the change, not the value
            }
            contact.moved = moved;
            for (int value : contact.now) note(value);
            next.push_back(contact);
        };
        for (const track& contact : contacts)
            if (in.get(flags[4])) read(contact, true);
        track last;
        for (int fresh = in.number(model(14, 0)); fresh > 0; --fresh) {
            last = {last.now, {}, {}, true};
            read(last, false);
            last = next.back();
        }
        contacts = next;
        note(static_cast<int>(contacts.size()));
        for (const track& contact : contacts) out.contacts.push_back(contact.now);
        frames.push_back(out);
    }
    CHECK(static_cast<double>(check) == field(json, "check"));
    return frames;
}

struct source {
    std::mt19937_64 bits;
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11) / 9007199254740992.0;
    }
    samples::pose pose(double range) {
        std::array<double, 4> q{};
        double length = 0;
        for (double& value : q) value = between(-1, 1), length += value * value;
        length = std::sqrt(length);
        return samples::solid(between(-range, range), between(-range, range), between(-range, range), q[0] / length,
                              q[1] / length, q[2] / length, q[3] / length);
    }
    samples::touch touch(double range) {
        const samples::pose p = pose(range);
        const double n = std::sqrt(p.qx * p.qx + p.qy * p.qy + p.qz * p.qz);
        return {p.x, p.y, p.z, p.qx / n, p.qy / n, p.qz / n, std::exp2(between(-12, 12))};
    }
};

/// The distance of a stored contact from a recorded one, in units of what rounding may do; below 1 is the same one.
double apart(const row& stored, const samples::touch& made, double grid, bool plane) {
    double worst = 0;
    const std::array<double, 6> want = {made.x / (4 * grid), made.y / (4 * grid), plane ? 0 : made.z / (4 * grid),
                                        made.nx * 64,        made.ny * 64,        plane ? 0 : made.nz * 64};
    for (std::size_t k = 0; k < 6; ++k) worst = std::max(worst, std::fabs(stored[k] - want[k]) / 0.51);
    const double level = made.impulse > 0 ? std::clamp(3 * std::log2(made.impulse), -61.0, 120.0) : -61;
    return std::max(worst, std::fabs(stored[6] - level) / 0.82);
}

}  // namespace

TEST_CASE("wild motion in space comes back: jumps, turned signs, contacts that come and go") {
    source from{std::mt19937_64(1)};
    samples::recorded_scene scene({.title = "wild", .scalar = "double", .dimension = 3, .every = 1});
    const std::vector<bool> moves = {false, true, true, true, true};
    for (bool moving : moves) {
        const samples::motion kind = moving ? samples::motion::dynamic : samples::motion::fixed;
        scene.add_body(kind, {samples::box(1, 2, 0.25)}, from.pose(9));
    }
    std::vector<std::vector<samples::pose>> poses;
    std::vector<std::vector<samples::touch>> touches;
    std::vector<samples::pose> now(moves.size());
    for (samples::pose& one : now) one = from.pose(9);
    for (int f = 0; f < 200; ++f) {
        touches.emplace_back();
        for (std::size_t b = 0; b < moves.size(); ++b) {
            if (!moves[b] && f > 0) continue;
            // Body 1 jumps, 2 rests, 3 turns its sign only, 4 rests for a while and then goes.
            if (b == 1) now[b] = from.pose(f % 7 ? 3 : 3e4);
            if (b == 3) now[b].qx *= -1, now[b].qy *= -1, now[b].qz *= -1, now[b].qw *= -1;
            if (b == 4 && f > 100) now[b].x += 0.013 * f;
            scene.place(static_cast<int>(b), now[b]);
        }
        for (std::uint64_t count = from.bits() % 12; count > 0; --count) touches.back().push_back(from.touch(2));
        if (f > 0 && f % 2) {
            // The former ones stay, and each gets a close twin.
            for (samples::touch old : touches[static_cast<std::size_t>(f - 1)]) {
                touches.back().push_back(old);
                old.x += 0.01;
                touches.back().push_back(old);
            }
        }
        for (const samples::touch& one : touches.back()) scene.add(one);
        poses.push_back(now);
        scene.commit();
    }
    const std::string json = scene.json();
    const double grid = field(json, "grid"), turn = field(json, "turn");
    const std::vector<frame> frames = decode(json, moves);
    REQUIRE(frames.size() == poses.size());
    for (std::size_t f = 0; f < frames.size(); ++f) {
        for (std::size_t b = 0; b < moves.size(); ++b) {
            const samples::pose& p = poses[f][b];
            const row& q = frames[f].bodies[b];
            CHECK(std::fabs(q[0] * grid - p.x) <= 0.5001 * grid);
            CHECK(std::fabs(q[1] * grid - p.y) <= 0.5001 * grid);
            CHECK(std::fabs(q[2] * grid - p.z) <= 0.5001 * grid);
            const std::array<double, 4> want = {p.qx, p.qy, p.qz, p.qw};
            double same = 0, error = 0;
            for (std::size_t k = 0; k < 4; ++k) same += q[3 + k] * want[k];
            for (std::size_t k = 0; k < 4; ++k)
                error = std::max(error, std::fabs(q[3 + k] * turn - (same < 0 ? -want[k] : want[k])));
            CHECK(error <= 0.5001 * turn);
        }
        // Every stored contact is one of the recorded ones, and each of these is stored once.
        REQUIRE(frames[f].contacts.size() == touches[f].size());
        std::vector<bool> used(touches[f].size());
        for (const row& stored : frames[f].contacts) {
            std::size_t best = 0;
            double least = 1;
            for (std::size_t i = 0; i < used.size(); ++i) {
                const double distance = apart(stored, touches[f][i], grid, false);
                if (!used[i] && distance <= least) least = distance, best = i;
            }
            CHECK(least < 1);
            used[best] = true;
        }
        CHECK(std::count(used.begin(), used.end(), true) == static_cast<std::ptrdiff_t>(used.size()));
    }
}

TEST_CASE("a disc that rolls for many turns keeps an angle without jumps") {
    samples::recorded_scene scene({.title = "roll", .scalar = "float", .dimension = 2, .every = 1});
    scene.add_body(samples::motion::dynamic, {samples::sphere(0.5)});
    for (int f = 0; f < 400; ++f) {
        scene.place(0, samples::flat(0.2 * f, 0.5, std::cos(0.4 * f), -std::sin(0.4 * f)));
        scene.commit();
    }
    const std::string json = scene.json();
    const std::vector<frame> frames = decode(json, {true});
    for (int f = 0; f < 400; ++f) {
        CHECK(std::fabs(frames[static_cast<std::size_t>(f)].bodies[0][2] * field(json, "turn") + 0.4 * f) < 1e-3);
    }
}

TEST_CASE("385 bodies for 20 seconds stay within the budget of a page, and rest costs nearly nothing") {
    source from{std::mt19937_64(2)};
    const auto size = [&](double speed, double jitter) {
        samples::recorded_scene scene({.title = "budget", .scalar = "float", .dimension = 3});
        std::vector<samples::pose> now;
        std::vector<std::array<double, 3>> ways;
        std::vector<samples::touch> touches;
        for (int b = 0; b < 385; ++b) {
            now.push_back(from.pose(6));
            ways.push_back({from.between(-1, 1), from.between(-1, 1), from.between(-1, 1)});
            scene.add_body(samples::motion::dynamic, {samples::box(0.5, 0.5, 0.5)});
        }
        for (int c = 0; c < 1500; ++c) touches.push_back(from.touch(6));
        for (int f = 0; f < 601; ++f) {
            for (int b = 0; b < 385; ++b) {
                const auto i = static_cast<std::size_t>(b);
                // Free flight with a kick now and then, and a steady tumble.
                if (from.bits() % 20 == 0) ways[i][1] = from.between(-1, 1);
                const double angle = 0.1 * speed * f + b, c = std::cos(angle), s = std::sin(angle);
                now[i].x += ways[i][0] * speed / 30 + jitter * from.between(-1, 1);
                now[i].y += ways[i][1] * speed / 30;
                now[i].z += ways[i][2] * speed / 30;
                scene.place(b, samples::solid(now[i].x, now[i].y, now[i].z, 0.6 * s, 0, 0.8 * s, c));
            }
            for (samples::touch& one : touches) {
                one.x += jitter * from.between(-1, 1);
                one.impulse *= std::exp2(100 * jitter * from.between(-1, 1));
                scene.add(one);
            }
            scene.commit();
        }
        return scene.json().size();
    };
    const std::size_t rest = size(0, 0), motion = size(3, 0.002);
    MESSAGE("at rest: " << rest << " bytes; in motion, contacts trembling: " << motion << " bytes");
    CHECK(rest < 60'000);
    CHECK(motion < 4'000'000);
}

TEST_CASE("joints are stored once, by their bodies and a point of each") {
    samples::recorded_scene scene({.title = "rod", .scalar = "float", .dimension = 2});
    for (const samples::motion kind : {samples::motion::fixed, samples::motion::dynamic})
        scene.add_body(kind, {samples::sphere(0.5)});
    scene.add_joint(0, samples::flat(0.25, -1), 1, samples::flat(0, 2.5));
    scene.add_joint(1, {}, 0, {});
    CHECK_THROWS_AS(scene.add_joint(0, {}, 2, {}), std::out_of_range);
    CHECK_THROWS_AS(scene.add_joint(-1, {}, 1, {}), std::out_of_range);
    CHECK_THROWS_WITH(scene.add_joint(0, samples::flat(std::numeric_limits<double>::infinity(), 0), 1, {}),
                      "samples: recording: point of a joint is inf; it must be finite");
    scene.commit();
    CHECK_THROWS_AS(scene.add_joint(0, {}, 1, {}), std::logic_error);
    CHECK(scene.json().find("\"joints\":[[0,1,0.25,-1,0,0,2.5,0],[1,0,0,0,0,0,0,0]]") != std::string::npos);
}

TEST_CASE("bad input is refused with the field and the value") {
    samples::recorded_scene scene({.title = "bad", .scalar = "float", .dimension = 2});
    scene.add_body(samples::motion::dynamic, {samples::sphere(0.5)});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(scene.place(0, samples::flat(nan, 0)),
                      "samples: recording: pose of body 0 is nan; it must be finite");
    CHECK_THROWS_AS(scene.place(1, samples::flat(0, 0)), std::out_of_range);
    CHECK_THROWS_AS(scene.add({0, 0, 0, 1, 0, 0, nan}), std::invalid_argument);
    CHECK_THROWS_WITH(samples::recorded_scene({.title = "", .scalar = "", .dimension = 4}),
                      "samples: recording: dimension is 4; it must be 2 or 3");
    scene.commit();
    CHECK_THROWS_AS(scene.add_body(samples::motion::fixed, {}), std::logic_error);
    scene.place(0, samples::flat(1e9, 0));
    CHECK_THROWS_AS(scene.commit(), std::invalid_argument);
}

TEST_CASE("the page is one file that asks for no other, and says its own size") {
    samples::recording page("<b> & \"c\"", "</script><script>alert(1)</script>");
    samples::recorded_scene& scene = page.add_scene({.title = "</script>", .scalar = "float", .dimension = 2});
    scene.add_body(samples::motion::dynamic, {samples::capsule(0.5, 1)});
    scene.fact("steps", "0");
    scene.commit();
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "physics_recording_test";
    const std::filesystem::path path = folder / "deeper" / "page.html";
    const std::size_t bytes = page.write_html(path);
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    std::filesystem::remove_all(folder);
    const std::string html = text.str();
    CHECK(html.size() == bytes);
    CHECK(field(html, "bytes") == static_cast<double>(bytes));
    CHECK(html.find("<title>&lt;b> &amp; ") != std::string::npos);
    CHECK(html.find("alert(1)</script>") == std::string::npos);
    for (const char* outside : {"src=\"", "http:", "https:", "@import", "url("}) {
        CAPTURE(outside);
        CHECK(html.find(outside) == std::string::npos);
    }
    CHECK_THROWS_AS(page.write_html(path, folder / "nowhere"), std::runtime_error);
}
