// Records the motion of a world: what its bodies, joints and contacts are to a page.
#pragma once

#include <physics.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "recording.hpp"

namespace samples {

template <class S>
pose pose_of(const physics::transform<S, 2>& t) {
    const auto n = [](S x) { return static_cast<double>(x); };
    return flat(n(t.position.x), n(t.position.y), n(t.rotation.cosine), n(t.rotation.sine));
}
template <class S>
pose pose_of(const physics::transform<S, 3>& t) {
    const auto n = [](S x) { return static_cast<double>(x); };
    return solid(n(t.position.x), n(t.position.y), n(t.position.z), n(t.rotation.x), n(t.rotation.y), n(t.rotation.z),
                 n(t.rotation.w));
}

template <class S, int D>
shape drawn(const physics::ball<S, D>& b, pose at) {
    return sphere(static_cast<double>(b.radius), at);
}
template <class S, int D>
shape drawn(const physics::capsule<S, D>& c, pose at) {
    return capsule(static_cast<double>(c.radius), static_cast<double>(c.half_length), at);
}
template <class S, int D>
shape drawn(const physics::box<S, D>& b, pose at) {
    return box(static_cast<double>(b.half_extents.x), static_cast<double>(b.half_extents.y),
               D == 3 ? static_cast<double>(b.half_extents[D - 1]) : 0, at);
}
template <class S, int D>
shape drawn(const physics::halfspace<S, D>& h, pose at) {
    return halfspace(static_cast<double>(h.normal.x), static_cast<double>(h.normal.y),
                     D == 3 ? static_cast<double>(h.normal[D - 1]) : 0, static_cast<double>(h.offset), at);
}

template <class S, int D>
shape drawn(const physics::rounded_box<S, D>& b, pose at) {
    return drawn(physics::box<S, D>{b.half_extents + physics::vec<S, D>::filled(b.radius)}, at);
}
template <class S, int D>
void draw(std::vector<shape>& to, const physics::chain<S, D>& c, pose at) {
    const auto& g = *c.geometry;
    std::vector<double> points = {g.point(0).x, g.point(0).y};
    for (std::uint32_t i = 0; i < g.segment_count(); ++i) points.insert(points.end(), {g.end_of(i).x, g.end_of(i).y});
    to.push_back(line(std::move(points), at));
}
/// Follows the outline, loop by loop.
template <class S, int D>
void draw(std::vector<shape>& to, const physics::tile_grid<S, D>& t, pose at) {
    const auto& g = *t.geometry;
    std::vector<bool> done(g.segment_count());
    for (std::uint32_t first = 0; first < g.segment_count(); ++first) {
        std::vector<double> points;
        for (std::uint32_t i = first; !done[i]; i = g.links_of(i).after) {
            done[i] = true;
            points.insert(points.end(), {g.point(i).x, g.point(i).y});
        }
        if (!points.empty()) to.push_back(polygon(std::move(points), at));
    }
}
/// Others are drawn as one shape.
template <class Shape>
void draw(std::vector<shape>& to, const Shape& shape, pose at) {
    to.push_back(drawn(shape, at));
}

/// Where a joint acts, in the frames of its bodies.
template <class Joint>
auto point_a(const Joint& joint) {
    if constexpr (requires { joint.anchor_a; }) return joint.anchor_a;
    else if constexpr (requires { joint.target; }) return joint.target;
    else return joint.frame_a.position;
}
template <class Joint>
auto point_b(const Joint& joint) {
    if constexpr (requires { joint.anchor_b; }) return joint.anchor_b;
    else return joint.frame_b.position;
}

/// A joint as it is seen: a point of one body, and one of another that it is held to, or near.
template <class World>
struct held_points {
    physics::body_id body_a, body_b;
    typename World::vec in_a, in_b;

    /// From the one to the other in the world.
    typename World::vec apart(const World& world) const {
        return world.pose(body_b) * in_b - world.pose(body_a) * in_a;
    }
};
/// The joints of a world that are of these kinds: joints_of<physics::ball_joint, physics::weld_joint>(world).
template <template <class, int> class... Kinds, class World>
std::vector<held_points<World>> joints_of(const World& world) {
    std::vector<held_points<World>> all;
    const auto add = [&]<template <class, int> class Kind>(physics::joint_id id) {
        using joint_type = Kind<typename World::scalar, World::dimension>;
        if (!world.template is_joint<joint_type>(id)) return;
        const auto joint = world.template joint<joint_type>(id);
        if constexpr (requires { joint.ground_a; }) {
            // A rope over wheels of the world, which a body that stands still holds.
            for (const physics::body_id still : world.bodies()) {
                if (world.type(still) != physics::body_type::static_body) continue;
                const auto in_still = inverse(world.pose(still));
                const auto a = in_still * joint.ground_a, b = in_still * joint.ground_b;
                all.push_back({world.body_a(id), still, joint.anchor_a, a});
                all.push_back({still, still, a, b});
                all.push_back({still, world.body_b(id), b, joint.anchor_b});
                return;
            }
        }
        all.push_back({world.body_a(id), world.body_b(id), point_a(joint), point_b(joint)});
    };
    for (const physics::joint_id id : world.joints()) (add.template operator()<Kinds>(id), ...);
    return all;
}
/// How far any of these joints has opened (m).
template <class World>
double largest_gap(const World& world, const std::vector<held_points<World>>& joints) {
    double largest = 0;
    for (const auto& joint : joints)
        largest = std::max(largest, static_cast<double>(physics::length(joint.apart(world))));
    return largest;
}

/// What debug drawing streams of a world: its lines and points, and the colours of bodies by their numbers.
template <class World>
struct line_sink {
    const std::map<std::string, int>& numbers;
    std::vector<drawn_line> lines;
    std::vector<std::pair<int, std::uint32_t>> tints;

    void line(const typename World::vec& from, const typename World::vec& to, physics::debug_color color) {
        drawn_line one{{}, {}, number_of(color), -1};
        double longest = 0;
        for (int i = 0; i < World::dimension; ++i) {
            const auto k = static_cast<std::size_t>(i);
            one.from[k] = static_cast<double>(from[i]);
            one.to[k] = static_cast<double>(to[i]);
            longest = std::max(longest, std::abs(one.to[k] - one.from[k]));
        }
        // The box of a halfspace has no end.
        if (longest < 1000) lines.push_back(one);
    }
    void point(const typename World::vec& at, physics::debug_color color) { line(at, at, color); }
    /// Comes after the lines of the body.
    void text(const typename World::vec&, const char* name, physics::debug_color color) {
        const int body = numbers.at(name);
        tints.emplace_back(body, number_of(color));
        for (; named < lines.size(); ++named) lines[named].body = body;
    }

    std::size_t named = 0;

private:
    static std::uint32_t number_of(physics::debug_color c) {
        return static_cast<std::uint32_t>(c.red << 16 | c.green << 8 | c.blue);
    }
};

/// The motion of a world whose bodies may come and go, until it is written to a scene.
template <class World>
class motion_track {
public:
    /// With what debug drawing streams, or without.
    explicit motion_track(bool draws) : draws_(draws) {}

    /// Stores where all bodies are, their contacts, and what debug drawing streams.
    void add_frame(const World& world) {
        const auto n = [](auto x) { return static_cast<double>(x); };
        const auto depth = [&](const typename World::vec& v) {
            return World::dimension == 3 ? n(v[World::dimension - 1]) : 0;
        };
        const int now = static_cast<int>(frames_.size());
        frame& next = frames_.emplace_back();
        for (const physics::body_id id : world.bodies()) {
            const pose at = pose_of(world.pose(id));
            const auto [found, is_new] = numbers_.emplace(id, static_cast<int>(bodies_.size()));
            if (is_new) bodies_.push_back(body_of(world, id, at));
            auto& spans = bodies_[static_cast<std::size_t>(found->second)].spans;
            if (spans.empty() || spans.back().second + 1 < now) spans.emplace_back(now, now);
            spans.back().second = now;
            next.poses.emplace_back(found->second, at);
        }
        for (const auto contact : world.contacts())
            for (int k = 0; k < contact.count; ++k) {
                const auto& p = contact.points[k];
                next.touches.push_back({n(p.position.x), n(p.position.y), depth(p.position), n(contact.normal.x),
                                        n(contact.normal.y), depth(contact.normal), n(p.normal_impulse)});
            }
        if (draws_) add_drawing(world, next);
    }
    /// Writes it to a scene, with joints between bodies that were there.
    void write(recorded_scene& scene, const std::vector<held_points<World>>& joints) const {
        const int last = static_cast<int>(frames_.size()) - 1;
        for (const body& one : bodies_) {
            const int number = scene.add_body(one.kind, one.shapes, one.start);
            if (one.spans.size() == 1 && one.spans[0] == std::pair{0, last}) continue;
            for (const auto& [from, to] : one.spans) scene.show(number, from, to);
        }
        const auto pose_at = [](const auto& point) {
            return pose_of(physics::transform<typename World::scalar, World::dimension>{point, {}});
        };
        for (const auto& joint : joints)
            scene.add_joint(numbers_.at(joint.body_a), pose_at(joint.in_a), numbers_.at(joint.body_b),
                            pose_at(joint.in_b));
        for (const frame& one : frames_) {
            for (const auto& [number, at] : one.poses) scene.place(number, at);
            for (const touch& contact : one.touches) scene.add(contact);
            for (const drawn_line& line : one.lines) scene.draw(line);
            for (const auto& [number, colour] : one.tints) scene.tint(number, colour);
            scene.commit();
        }
    }

private:
    struct body {
        motion kind;
        std::vector<shape> shapes;
        pose start;
        /// First and last frames in which it is there.
        std::vector<std::pair<int, int>> spans;
    };
    struct frame {
        std::vector<std::pair<int, pose>> poses;
        std::vector<touch> touches;
        std::vector<drawn_line> lines;
        std::vector<std::pair<int, std::uint32_t>> tints;
    };

    /// Boxes, joints and velocities; and in place of outlines the colours of bodies, by islands of those that are awake
    /// and by state of the others.
    void add_drawing(const World& world, frame& next) {
        std::map<std::string, int> numbers;
        for (const physics::body_id id : world.bodies()) numbers[std::to_string(id.index)] = numbers_.at(id);
        line_sink<World> drawn{numbers, {}, {}}, islands{numbers, {}, {}};
        physics::debug_draw_options<typename World::scalar, World::dimension> with;
        with.shapes = false;
        with.numbers = with.boxes = with.velocities = true;
        physics::debug_draw(world, drawn, with);
        with.islands = true;
        with.joints = with.boxes = with.velocities = false;
        physics::debug_draw(world, islands, with);
        next.lines = std::move(drawn.lines);
        std::size_t i = 0;
        for (const physics::body_id id : world.bodies()) {
            const bool is_awake = world.type(id) == physics::body_type::dynamic_body && !world.is_asleep(id);
            next.tints.push_back((is_awake ? islands : drawn).tints[i++]);
        }
    }

    static body body_of(const World& world, physics::body_id id, const pose& at) {
        const auto type = world.type(id);
        body fresh{type == physics::body_type::static_body      ? motion::fixed
                   : type == physics::body_type::kinematic_body ? motion::kinematic
                                                                : motion::dynamic,
                   {},
                   at,
                   {}};
        for (const physics::shape_id s : world.shapes(id)) {
            const std::size_t first = fresh.shapes.size();
            world.shape(s).visit([&](const auto& shape) { draw(fresh.shapes, shape, pose_of(world.local_pose(s))); });
            for (std::size_t i = first; i < fresh.shapes.size(); ++i) fresh.shapes[i].hollow = world.is_sensor(s);
        }
        return fresh;
    }

    bool draws_;
    std::map<physics::body_id, int> numbers_;
    std::vector<body> bodies_;
    std::vector<frame> frames_;
};

/// A page of scenes, played one after the other, with what was found of each below it and on the terminal.
class film {
public:
    film(const std::string& title, const std::string& subtitle, std::string path)
        : page_(title, subtitle), path_(std::move(path)) {}

    /// Plays a world, with these joints drawn, in steps of 1/60 s; calls before(seconds so far) ahead of each, and
    /// after() behind it.
    template <class World, class Before, class After>
    void play(const char* title, World& world, const std::vector<held_points<World>>& joints, double seconds,
              Before&& before, After&& after) {
        using S = typename World::scalar;
        // Of more it would take as much space as the motion; a joint has five lines.
        const bool draws = world.body_count() + 2 * world.joint_count() <= 80;
        scene_ = &page_.add_scene({.title = title,
                                   .scalar = physics::scalar_traits<S>::name(),
                                   .dimension = World::dimension,
                                   .drawing = draws});
        motion_track<World> track(draws);
        const int steps = static_cast<int>(60 * seconds);
        for (int i = 0; i <= steps; ++i) {
            if (scene_->due(i)) track.add_frame(world);
            if (i == steps) break;
            before(i / 60.0);
            world.step(S(1.0 / 60));
            after();
        }
        track.write(*scene_, joints);
        std::printf("%s: %u bodies, %u joints, %.0f s\n", title, world.body_count(), world.joint_count(), seconds);
    }
    template <class World, class Before>
    void play(const char* title, World& world, const std::vector<held_points<World>>& joints, double seconds,
              Before&& before) {
        play(title, world, joints, seconds, before, [] {});
    }
    /// Tells what was found of the last scene.
    void fact(const char* label, double value, const char* format = "%.2f") {
        char text[40];
        std::snprintf(text, sizeof text, format, value);
        tell(label, text, "");
    }
    /// Tells what was found beside what should be; what is not so makes main() fail.
    void expect(const char* label, double value, double least, double greatest) {
        const bool holds = value >= least && value <= greatest;
        char text[40], range[80];
        std::snprintf(text, sizeof text, "%.6g", value);
        if (least == greatest) std::snprintf(range, sizeof range, "expected %.6g", least);
        else std::snprintf(range, sizeof range, "expected %.6g to %.6g", least, greatest);
        tell(label, text, std::string(range) + (holds ? "" : "  WRONG"));
        has_failed_ |= !holds;
    }
    void expect(const char* label, double value, double exactly) { expect(label, value, exactly, exactly); }
    /// Writes the page, if it has a path; returns what main() returns.
    int finish() {
        try {
            if (!path_.empty()) {
                page_.write_html(path_);
                std::printf("\n%s plays the motion in any browser\n", path_.c_str());
            }
            return has_failed_ ? EXIT_FAILURE : EXIT_SUCCESS;
        } catch (const std::exception& failure) {
            std::fprintf(stderr, "%s\n", failure.what());
            return EXIT_FAILURE;
        }
    }

private:
    void tell(const std::string& label, const char* text, const std::string& expected) {
        std::printf("    %-52s %-10s %s\n", label.c_str(), text, expected.c_str());
        if (scene_ != nullptr) scene_->fact(expected.empty() ? label : label + " (" + expected + ")", text);
    }

    recording page_;
    std::string path_;
    recorded_scene* scene_ = nullptr;
    bool has_failed_ = false;
};

}  // namespace samples
