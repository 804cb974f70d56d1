// An arena seen from above: two teams without gravity, shots that spare their own, blasts with falloff, lines of sight.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "filming.hpp"

namespace {

struct duel
    : physics::recipe<float, 2, physics::shapes<physics::ball, physics::box>, physics::events<physics::event::hit>> {};
using world = physics::world<duel>;
using vec = world::vec;

enum : std::uint32_t { wall = 1, red = 2, blue = 4, shot = 8 };

/// Every body within reach gets an impulse away from there, less the farther it is; walls keep it off.
void explode(world& arena, vec at, float reach, float impulse) {
    arena.each_overlapping(world::ball{reach}, {at, {}}, {.kinds = physics::dynamic_bodies},
                           [&](physics::shape_id shape) {
                               const physics::body_id body = arena.body(shape);
                               const vec way = arena.position(body) - at;
                               const float distance = length(way);
                               if (distance >= reach || distance == 0 || arena.cast_ray(at, way, {.mask = wall}))
                                   return;
                               arena.apply_impulse(body, way * (impulse * (1 - distance / reach) / distance));
                           });
}

/// Two teams of discs among pillars.
class game {
public:
    world arena{{.gravity = {}}};

    struct fighter {
        physics::body_id body;
        std::uint32_t team;
        int health = 6, wait = 0;
    };
    std::vector<fighter> fighters;
    int shots = 0, wounds = 0, own_wounds = 0, blasts = 0;

    game() {
        const physics::body_id walls = arena.create_body({.type = physics::body_type::static_body});
        for (int side = 0; side < 4; ++side) {
            const bool is_upright = side % 2 == 0;
            const float way = side < 2 ? 1.0f : -1.0f;
            arena.create_shape(walls, world::box{is_upright ? vec{0.5f, 9} : vec{13, 0.5f}},
                               {.position = is_upright ? vec{12.5f * way, 0} : vec{0, 8.5f * way}});
        }
        for (int i = 0; i < 7; ++i)
            arena.create_shape(walls, world::ball{0.8f},
                               {.position = {3.0f * static_cast<float>(i) - 9, i % 2 == 0 ? 2.2f : -2.6f}});
        for (int i = 0; i < 16; ++i) {
            const std::uint32_t team = i % 2 == 0 ? red : blue;
            const vec place = {10 - static_cast<float>(i / 8), 3.9f * static_cast<float>(i / 2 % 4) - 6};
            // Damping stands for the floor.
            const physics::body_id body = arena.create_body({.position = team == red ? vec{-place.x, place.y} : place,
                                                             .linear_damping = 2,
                                                             .angular_damping = 2,
                                                             .user_data = fighters.size() + 1});
            arena.create_shape(body, world::ball{0.4f},
                               {.material = {.restitution = 0.3f}, .filter = {.category = team}});
            fighters.push_back({body, team});
        }
    }

    /// What it would see on a straight line: walls, and bodies of the other team.
    [[nodiscard]] bool sees(const fighter& from, const fighter& to) const {
        const vec a = arena.position(from.body), b = arena.position(to.body);
        const auto hit = arena.cast_ray(a, b - a, {.mask = wall | to.team, .except = from.body});
        return hit && hit.body == to.body;
    }
    [[nodiscard]] fighter* nearest_enemy(const fighter& me) {
        fighter* best = nullptr;
        float distance = 1000;
        for (fighter& other : fighters) {
            if (other.team == me.team || other.health <= 0) continue;
            const float d = length(arena.position(other.body) - arena.position(me.body));
            if (d < distance) best = &other, distance = d;
        }
        return best;
    }
    void act() {
        for (fighter& me : fighters) {
            if (me.health <= 0) continue;
            fighter* enemy = nearest_enemy(me);
            if (enemy == nullptr) return;
            const vec at = arena.position(me.body), way = normalized(arena.position(enemy->body) - at);
            const bool in_sight = sees(me, *enemy);
            // Towards it, or around what is between.
            const vec go = in_sight ? way : vec{way.x - way.y, way.y + way.x};
            arena.apply_force(me.body, go * 6);
            if (--me.wait > 0 || !in_sight) continue;
            me.wait = 50;
            ++shots;
            const physics::body_id bullet = arena.create_body({.position = at + way * 0.5f,
                                                               .linear_velocity = way * 18,
                                                               .continuous = true,
                                                               .user_data = 1000 + me.team});
            // It meets all but its own team, and other shots.
            arena.create_shape(bullet, world::ball{0.1f},
                               {.filter = {.category = shot, .mask = wall | ((red | blue) & ~me.team)}});
        }
    }
    void judge() {
        std::vector<physics::body_id> spent;
        for (const auto& h : arena.hit_events())
            for (const bool first : {true, false}) {
                const physics::body_id bullet = first ? h.body_a : h.body_b, other = first ? h.body_b : h.body_a;
                if (!arena.contains(bullet) || arena.user_data(bullet) < 1000) continue;
                const auto team = static_cast<std::uint32_t>(arena.user_data(bullet) - 1000);
                if (const std::uint64_t number = arena.user_data(other); number > 0 && number < 1000) {
                    fighter& victim = fighters[number - 1];
                    ++wounds;
                    own_wounds += victim.team == team;
                    if (--victim.health == 0) {
                        const vec at = arena.position(victim.body);
                        spent.push_back(victim.body);
                        explode(arena, at, 3, 4);
                        ++blasts;
                    }
                }
                spent.push_back(bullet);
            }
        for (const physics::body_id body : spent)
            if (arena.contains(body)) arena.destroy_body(body);
    }
    [[nodiscard]] int outside() const {
        return static_cast<int>(std::ranges::count_if(fighters, [&](const fighter& f) {
            const vec at = f.health > 0 ? arena.position(f.body) : vec{};
            return std::fabs(at.x) > 12 || std::fabs(at.y) > 8;
        }));
    }
    [[nodiscard]] int alive(std::uint32_t team) const {
        return static_cast<int>(
            std::ranges::count_if(fighters, [&](const fighter& f) { return f.team == team && f.health > 0; }));
    }
};

/// What a blast does to discs at several distances, of which a pillar hides the last one.
void blast(samples::film& film) {
    world arena{{.gravity = {}}};
    std::vector<physics::body_id> discs;
    const auto add = [&](vec at, physics::body_type type) {
        const physics::body_id id = arena.create_body({.type = type, .position = at});
        const bool is_wall = type == physics::body_type::static_body;
        arena.create_shape(id, world::ball{0.3f}, {.filter = {.category = is_wall ? wall : red}});
        return id;
    };
    for (int i = 1; i <= 4; ++i) {
        const float angle = 1.5f * static_cast<float>(i), away = static_cast<float>(i);
        discs.push_back(add({away * std::cos(angle), away * std::sin(angle)}, physics::body_type::dynamic_body));
    }
    add({-1.2f, 0}, physics::body_type::static_body);
    discs.push_back(add({-2, 0}, physics::body_type::dynamic_body));
    float fastest[5] = {};
    film.play("blast", arena, {}, 1, [&](double t) {
        if (t != 0) return;
        explode(arena, {}, 4, 2);
        for (std::size_t i = 0; i < 5; ++i) fastest[i] = length(arena.linear_velocity(discs[i]));
    });
    const double full = 2 / static_cast<double>(arena.mass(discs[0]).mass);
    film.expect("speed 1 m away, m/s", fastest[0], 0.749 * full, 0.751 * full);
    film.expect("speed 3 m away, m/s", fastest[2], 0.249 * full, 0.251 * full);
    film.expect("speed at the end of its reach, and behind a pillar", fastest[3] + fastest[4], 0);
}

void fight(samples::film& film) {
    game it;
    film.play(
        "duel", it.arena, {}, 25, [&](double) { it.act(); }, [&] { it.judge(); });
    film.fact("shots", it.shots, "%.0f");
    film.expect("wounds", it.wounds, 10, it.shots);
    film.expect("of them by their own team", it.own_wounds, 0);
    film.expect("blasts, one for each who fell", it.blasts, 16 - it.alive(red) - it.alive(blue));
    film.fact("red left", it.alive(red), "%.0f");
    film.fact("blue left", it.alive(blue), "%.0f");
    film.expect("fighters outside of the walls", it.outside(), 0);
}

}  // namespace

int main() {
    samples::film film("Arena", "two teams, blasts and lines of sight", "samples/out/arena.html");
    blast(film);
    fight(film);
    return film.finish();
}
