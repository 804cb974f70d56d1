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

/// Adds all bodies of a world.
template <class World>
void add_bodies(recorded_scene& scene, const World& world) {
    for (const physics::body_id id : world.bodies()) {
        std::vector<shape> shapes;
        for (const physics::shape_id s : world.shapes(id))
            world.shape(s).visit(
                [&](const auto& shape) { shapes.push_back(drawn(shape, pose_of(world.local_pose(s)))); });
        const bool fixed = world.type(id) == physics::body_type::static_body;
        scene.add_body(fixed ? motion::fixed : motion::dynamic, shapes, pose_of(world.pose(id)));
    }
}

/// Stores where all bodies are, and their contacts.
template <class World>
void add_frame(recorded_scene& scene, const World& world) {
    const auto n = [](auto x) { return static_cast<double>(x); };
    const auto depth = [&](const typename World::vec& v) {
        return World::dimension == 3 ? n(v[World::dimension - 1]) : 0;
    };
    int number = 0;
    for (const physics::body_id id : world.bodies()) scene.place(number++, pose_of(world.pose(id)));
    for (const auto contact : world.contacts())
        for (int k = 0; k < contact.count; ++k) {
            const auto& p = contact.points[k];
            scene.add({n(p.position.x), n(p.position.y), depth(p.position), n(contact.normal.x), n(contact.normal.y),
                       depth(contact.normal), n(p.normal_impulse)});
        }
    scene.commit();
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

/// Adds joints between bodies that have been added.
template <class World>
void add_joints(recorded_scene& scene, const World& world, const std::vector<held_points<World>>& joints) {
    std::map<std::uint32_t, int> numbers;
    for (const physics::body_id id : world.bodies()) numbers.emplace(id.index, static_cast<int>(numbers.size()));
    const auto pose_at = [](const auto& point) {
        return pose_of(physics::transform<typename World::scalar, World::dimension>{point, {}});
    };
    for (const auto& joint : joints)
        scene.add_joint(numbers.at(joint.body_a.index), pose_at(joint.in_a), numbers.at(joint.body_b.index),
                        pose_at(joint.in_b));
}

/// A page of scenes, played one after the other, with what was found of each below it and on the terminal.
class film {
public:
    film(const std::string& title, const std::string& subtitle, std::string path)
        : page_(title, subtitle), path_(std::move(path)) {}

    /// Plays a world, with these joints drawn, in steps of 1/60 s; calls before(seconds so far) ahead of each.
    template <class World, class Before>
    void play(const char* title, World& world, const std::vector<held_points<World>>& joints, double seconds,
              Before&& before) {
        using S = typename World::scalar;
        scene_ = &page_.add_scene(
            {.title = title, .scalar = physics::scalar_traits<S>::name(), .dimension = World::dimension});
        add_bodies(*scene_, world);
        add_joints(*scene_, world, joints);
        const int steps = static_cast<int>(60 * seconds);
        for (int i = 0; i <= steps; ++i) {
            if (scene_->due(i)) add_frame(*scene_, world);
            if (i == steps) break;
            before(i / 60.0);
            world.step(S(1.0 / 60));
        }
        std::printf("%s: %u bodies, %u joints, %.0f s\n", title, world.body_count(), world.joint_count(), seconds);
    }
    /// Tells what was found of the last scene.
    void fact(const char* label, double value, const char* format = "%.2f") {
        char text[40];
        std::snprintf(text, sizeof text, format, value);
        std::printf("    %-52s %s\n", label, text);
        scene_->fact(label, text);
    }
    /// Writes the page; returns what main() returns.
    int finish() {
        try {
            page_.write_html(path_);
            std::printf("\n%s plays the motion in any browser\n", path_.c_str());
            return EXIT_SUCCESS;
        } catch (const std::exception& failure) {
            std::fprintf(stderr, "%s\n", failure.what());
            return EXIT_FAILURE;
        }
    }

private:
    recording page_;
    std::string path_;
    recorded_scene* scene_ = nullptr;
};

}  // namespace samples
