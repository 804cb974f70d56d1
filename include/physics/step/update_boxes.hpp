// Where shapes are after a step, and what the broadphase knows of them.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Poses -> poses and boxes of shapes, and where these are heading; bodies with a target are there, to the bit. Shapes
/// and broadphase are what a step writes before it has succeeded: unless they are to be kept, they are brought back.
/// O(shapes that move).
template <class Plan>
class box_update {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using moved_bodies = solver_api::moved_bodies<S, D, Plan::rotates>;

public:
    box_update(const pool<typename Plan::body>& bodies, const awake_list& awake, const moved_bodies& moved, S margin,
               S h, shape_pool<Plan>& shapes, typename Plan::broadphase& broadphase)
        : bodies_(bodies),
          awake_(awake),
          moved_(moved),
          margin_(margin),
          step_(h),
          shapes_(shapes),
          boxes_(broadphase) {}
    box_update(const box_update&) = delete;
    box_update& operator=(const box_update&) = delete;
    ~box_update() {
        if (has_begun_ && !is_kept_) restore();
    }

    /// False if a box or a frame is beyond the scalar's range, or the executor fails.
    bool run(arena& scratch, task_runner& tasks) {
        reserve_changes(boxes_, shapes_.slots(), 0);
        has_begun_ = true;
        if (!(tasks.is_serial() ? update() : update(scratch, tasks))) return false;
        // To go back too: what is brought back finds the memory.
        reserve_changes(boxes_, shapes_.slots(), moves_);
        if constexpr (requires { boxes_.update(); }) boxes_.update();
        return true;
    }
    void keep() { is_kept_ = true; }

private:
    bool update() {
        bool fit = true;
        for (std::uint32_t k = 0; k < awake_.size() && fit; ++k)
            fit = place_shapes(k,
                               [&](std::uint32_t n, const aabb<S, D>& box) {
                                   if (fit = fit && is_box(box); fit) move(k, n, box);
                               }) &&
                  fit;
        return fit;
    }
    /// Boxes that are left move one by one: what the broadphase makes of them may depend on their order.
    bool update(arena& scratch, task_runner& tasks) {
        enum : std::uint8_t { stays = 0, leaves = 1, lost = 2 };
        const std::uint32_t count = awake_.size();
        auto* changes = scratch.template allocate<std::uint8_t>(count);
        tasks.parallel_for(count, 128, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t k = first; k < end; ++k) {
                changes[k] = stays;
                const bool fits = place_shapes(k, [&](std::uint32_t n, const aabb<S, D>& box) {
                    if constexpr (requires { boxes_.holds(n, box); })
                        if (boxes_.holds(n, box)) return;
                    changes[k] = !is_box(box) || changes[k] == lost ? lost : leaves;
                });
                if (!fits) changes[k] = lost;
            }
        });
        bool fit = tasks.ran_all_tasks();
        for (std::uint32_t k = 0; k < count; ++k) fit = fit && changes[k] != lost;
        for (std::uint32_t k = 0; k < count && fit; ++k)
            if (changes[k] == leaves)
                each_shape(bodies_, shapes_, awake_[k],
                           [&](std::uint32_t n, const auto& shape) { move(k, n, box_within(margin_, shape)); });
        return fit;
    }
    PHYSICS_HPP_COLD void restore() {
        const auto restore_boxes = [&] {
            for (const std::uint32_t i : awake_) refresh_boxes<Plan>(bodies_, margin_, shapes_, boxes_, i);
            if constexpr (requires { boxes_.update(); }) boxes_.update();
        };
        run_if_memory_lasts(restore_boxes);
    }
    /// Puts the shapes of a body where it is now, and calls f(shape's number, box) for each. False if its frame is out
    /// of range, which may be far from its centre of mass.
    template <class F>
    bool place_shapes(std::uint32_t k, F&& f) {
        const auto& b = bodies_[awake_[k]];
        const transform<S, D> pose = pose_after(b, moved_[k]);
        const vec<S, D> center = b.has_target ? pose * b.mass.center : moved_[k].center;
        each_shape(bodies_, shapes_, awake_[k], [&](std::uint32_t n, auto& shape) {
            update_pose(shape, pose, center);
            f(n, box_within(margin_, shape));
        });
        return is_in_range(pose.position);
    }
    void move(std::uint32_t k, std::uint32_t n, const aabb<S, D>& box) {
        boxes_.move(n, box, moved_.velocity(k).linear * step_);
        ++moves_;
    }

    const pool<typename Plan::body>& bodies_;
    const awake_list& awake_;
    const moved_bodies& moved_;
    S margin_, step_;
    shape_pool<Plan>& shapes_;
    typename Plan::broadphase& boxes_;
    std::uint32_t moves_ = 0;
    bool has_begun_ = false, is_kept_ = false;
};

}  // namespace detail

PHYSICS_HPP_END
