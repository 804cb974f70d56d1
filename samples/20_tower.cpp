// A tower of blocks, of which one is picked by a point and dragged out; an undo brings it back.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

struct blocks
    : physics::recipe<float, 3, physics::joints<physics::target_joint>, physics::events<physics::event::sleep>> {};
using world = physics::world<blocks>;
using vec = world::vec;

constexpr int floors = 10;
constexpr float tall = 0.15f, wide = 0.25f;

/// Holds a body by a point as a mouse does.
class hand {
public:
    explicit hand(world& arena)
        : arena_(arena), anchor_(arena.create_body({.type = physics::body_type::static_body})) {}

    /// Takes the body that is at a point, if one can be moved there.
    bool take(vec at) {
        arena_.each_at(at, {.kinds = physics::dynamic_bodies}, [&](physics::shape_id found) {
            body = arena_.body(found);
            return false;
        });
        if (!body) return false;
        joint_ = arena_.create_joint(
            anchor_, body,
            world::target_joint{.target = at, .anchor_b = inverse(arena_.pose(body)) * at, .max_force = 600});
        return true;
    }
    void move(vec to) {
        if (!arena_.contains(joint_)) return;
        auto joint = arena_.joint<world::target_joint>(joint_);
        joint.target = to;
        arena_.set_joint(joint_, joint);
    }
    void let_go() {
        if (arena_.contains(joint_)) arena_.destroy_joint(joint_);
    }

    physics::body_id body;

private:
    world& arena_;
    physics::body_id anchor_;
    physics::joint_id joint_;
};

}  // namespace

int main() {
    samples::film film("Tower", "a block is dragged out, and an undo brings it back", "samples/out/tower.html");
    world arena = scenes::grounded<world>();
    for (int floor = 0; floor < floors; ++floor)
        for (int i = -1; i <= 1; ++i) {
            const bool along_x = floor % 2 == 0;
            const float aside = wide * static_cast<float>(i), y = tall * (static_cast<float>(floor) + 0.5f);
            const physics::body_id block =
                arena.create_body({.position = {along_x ? 0 : aside, y, along_x ? aside : 0}});
            const vec half = {along_x ? 1.5f * wide : wide / 2, tall / 2, along_x ? wide / 2 : 1.5f * wide};
            arena.create_shape(block, world::box{half}, {.density = 500, .material = {.friction = 0.4f}});
        }
    hand player(arena);
    const vec handle = {1.4f * wide, tall * 6.5f, wide};
    const auto highest = [&] {
        float top = 0;
        for (const physics::body_id id : arena.bodies()) top = std::max(top, arena.position(id).y);
        return top;
    };

    world image;
    std::uint64_t hash_at_image = 0, hash_after_undo = 0, hashes[2] = {};
    std::uint32_t asleep_at_first = 0, awake_when_taken = 0, joints_after_undo = 1;
    float top_at_first = 0, top_at_end = 0, way = 0;
    bool found = false;
    // Twice the same: the second time from the undone world on.
    film.play(
        "drag and undo", arena, {}, 22,
        [&](double t) {
            const double at = t < 12 ? t : t - 10;
            if (t == 2) {
                asleep_at_first = 3 * floors - arena.awake_count();
                top_at_first = highest();
                hash_at_image = arena.state_hash();
                image = arena;
            }
            if (t == 12) {
                way = length(arena.position(player.body) - vec{0, tall * 6.5f, wide});
                hashes[0] = arena.state_hash();
                top_at_end = highest();
                arena = image;
                hash_after_undo = arena.state_hash();
                joints_after_undo = arena.joint_count();
            }
            if (at == 2) found = player.take(handle);
            if (at > 2 && at < 5) player.move(handle + vec{0.5f * static_cast<float>(at - 2), 0, 0});
            if (at > 5) player.let_go();
        },
        [&] {
            if (player.body) awake_when_taken = std::max(awake_when_taken, arena.awake_count());
        });
    hashes[1] = arena.state_hash();
    film.expect("blocks asleep before one is taken", asleep_at_first, 3 * floors);
    film.expect("a block is found at the point", found, 1);
    film.expect("blocks awake while it is dragged", awake_when_taken, 3 * floors);
    film.expect("way of the block, m", way, 1, 3);
    film.expect("top of the tower lower by, mm", 1000 * (top_at_first - top_at_end), -1, 5);
    film.expect("asleep again at the end", 3 * floors - arena.awake_count(), 3 * floors);
    film.expect("joints after the undo", joints_after_undo, 0);
    film.expect("hash after the undo is that of the image", hash_after_undo == hash_at_image, 1);
    film.expect("the same drag again ends with the same hash", hashes[0] == hashes[1], 1);
    return film.finish();
}
