// A wrecking ball on a chain swings into a wall whose bricks hold together by joints that break.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

template <int D>
struct site : physics::recipe<float, D, physics::joints<physics::ball_joint, physics::weld_joint>> {};

/// A wall of bricks, each welded to its neighbours, and a ball that swings into it; in the plane it is one brick wide.
template <int D>
void demolish(samples::film& film, const char* title, double strength) {
    using world = physics::world<site<D>>;
    world arena = scenes::grounded<world>();
    constexpr int columns = D == 2 ? 1 : 8, rows = 12;
    std::vector<physics::body_id> bricks;
    const auto weld = [&](int a, int b) {
        arena.create_joint_at(bricks[static_cast<std::size_t>(a)], bricks[static_cast<std::size_t>(b)],
                              arena.pose(bricks[static_cast<std::size_t>(a)]), typename world::weld_joint{},
                              {.collide_connected = true, .break_force = strength, .break_torque = strength / 4});
    };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            typename world::body_def def;
            typename world::vec half = world::vec::filled(0.25f);
            half.x = 0.2f;
            half.y = 0.25f;
            def.position.x = 3;
            def.position.y = 0.25f + 0.5f * static_cast<float>(row);
            if constexpr (D == 3) def.position.z = 0.5f * (static_cast<float>(column) - 0.5f * (columns - 1));
            const physics::body_id brick = arena.create_body(def);
            arena.create_shape(brick, typename world::box{half}, {.density = 40});
            bricks.push_back(brick);
            const int now = static_cast<int>(bricks.size()) - 1;
            if (column > 0) weld(now - 1, now);
            if (row > 0) weld(now - columns, now);
        }
    const int welds = static_cast<int>(arena.joint_count());
    const physics::body_id ball = scenes::wrecking_ball(arena, 1, 10.5, 1.3);
    auto chain = samples::joints_of<physics::ball_joint>(arena);

    int broken = 0, too_early = 0, let_go = 0;
    float fastest = 0, widest = 0;
    bool has_arrived = false;
    film.play(
        title, arena, chain, 8, [](double) {},
        [&] {
            has_arrived = has_arrived || arena.position(ball).x > 1.7f;
            fastest = std::max(fastest, length(arena.linear_velocity(ball)));
            widest = std::max(widest, static_cast<float>(samples::largest_gap(arena, chain)));
            for (const auto& one : arena.broken_joints()) {
                ++broken;
                too_early += !has_arrived;
                let_go += !arena.joint_enabled(one.joint);
            }
        });
    int fallen = 0, held = 0;
    for (const physics::body_id brick : bricks) fallen += std::fabs(arena.position(brick).x - 3) > 0.3f;
    for (const physics::joint_id id : arena.joints()) held += arena.joint_enabled(id);
    film.expect("joints of the wall that broke", broken, welds / 4, welds);
    film.expect("of them before the ball was there", too_early, 0);
    film.expect("of them no longer enabled", let_go, broken);
    film.expect("joints that still hold, chain included", held, welds + 8 - broken);
    film.expect("bricks moved from their place", fallen, 6, rows * columns);
    film.fact("fastest the ball swung, m/s", fastest);
    // At the hit: what breaks holds until the end of the step.
    film.expect("widest joint of the chain, mm", 1000 * widest, 0, 40);
}

}  // namespace

int main() {
    samples::film film("Wrecking ball", "a chain, a ball, and a wall whose joints break",
                       "samples/out/wrecking_ball.html");
    demolish<2>(film, "a pillar", 2000);
    demolish<3>(film, "a wall", 2000);
    return film.finish();
}
