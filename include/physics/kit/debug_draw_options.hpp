// What debug drawing shows, and in which colours.
#pragma once

#include "physics/space/aabb.hpp"

PHYSICS_HPP_BEGIN

/// What is drawn is coloured so.
struct debug_color {
    std::uint8_t red = 255, green = 255, blue = 255, alpha = 255;
    friend bool operator==(debug_color, debug_color) = default;
};

/// What is drawn, and how.
template <class S, int D>
struct debug_draw_options {
    /// Outlines of shapes, coloured by what their bodies do.
    bool shapes = true;
    /// Points that touch, their normals, and their impulses of the last step, so long for 1 N s (m).
    bool contacts = false;
    S impulse_scale = S(0.1);
    /// From the centres of both bodies to where the joint acts.
    bool joints = true;
    /// Boxes of shapes, and of the nodes of the broadphase's tree, where it has one.
    bool boxes = false;
    bool tree = false;
    /// Dynamic bodies have a colour for each island, awake or asleep.
    bool islands = false;
    /// Centres of mass and axes of bodies; their velocities, so long for 1 m/s (m).
    bool frames = false;
    bool velocities = false;
    S velocity_scale = S(0.1);
    /// The numbers of bodies, where the renderer has text.
    bool numbers = false;
    /// Only what reaches into this box is drawn (m).
    aabb<S, D> view = everything();
    /// Into how many sides circles are cut.
    int sides = 24;

    debug_color of_static{128, 128, 128}, of_kinematic{64, 128, 255}, of_awake{255, 176, 64}, of_asleep{112, 96, 80},
        of_disabled{64, 64, 64}, of_sensor{96, 208, 96}, of_contact{255, 64, 64}, of_normal{255, 224, 64},
        of_joint{208, 96, 208}, of_box{96, 96, 160}, of_tree{72, 72, 104}, of_velocity{96, 224, 224};

private:
    static constexpr aabb<S, D> everything() {
        const S maximum = scalar_traits<S>::max();
        return {vec<S, D>::filled(-maximum), vec<S, D>::filled(maximum)};
    }
};

PHYSICS_HPP_END
