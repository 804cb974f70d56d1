// Dominoes: fifty in a spiral, of which a ball hits the first; contact events tell in which order they fall.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

struct floor_of_dominoes : physics::recipe<float, 3, physics::events<physics::event::contact, physics::event::sleep>> {
};
using world = physics::world<floor_of_dominoes>;
using rotation = physics::rotation<float, 3>;

constexpr int count = 50;
constexpr float half_thick = 0.05f, half_tall = 0.4f, half_wide = 0.2f, apart = 0.4f;

}  // namespace

int main() {
    samples::film film("Dominoes", "fifty in a spiral, and a ball", "samples/out/dominoes.html");
    world arena = scenes::grounded<world>();

    // Equal ways along a spiral from the outside in, whose turns are 1.2 m apart.
    const float growth = 1.2f / (2 * 3.14159265f);
    float angle = 6 * 3.14159265f;
    world::vec start, way;
    for (int i = 1; i <= count; ++i) {
        const float radius = growth * angle, cosine = std::cos(angle), sine = std::sin(angle);
        const world::vec at = {radius * cosine, half_tall, radius * sine};
        const world::vec onward =
            normalized(world::vec{radius * sine - growth * cosine, 0, -radius * cosine - growth * sine});
        const physics::body_id domino = arena.create_body({
            .position = at,
            .rotation = rotation::from_x_axis(onward),
            .user_data = static_cast<std::uint64_t>(i),
        });
        arena.create_shape(domino, world::box{{half_thick, half_tall, half_wide}}, {.density = 500});
        if (i == 1) start = at, way = onward;
        angle -= apart / std::hypot(radius, growth);
    }
    // Rolling resistance does not end its spin about the vertical: damping does.
    const physics::body_id ball = arena.create_body({
        .position = start - way * 0.8f + world::vec{0, 0.3f, 0},
        .linear_velocity = way * 3.0f,
        .angular_damping = 0.5f,
    });
    arena.create_shape(ball, world::ball{0.2f}, {.density = 1000, .material = {.rolling_resistance = 0.02f}});

    std::vector<std::uint64_t> hit;  // numbers of dominoes, in the order in which the ones before touched them
    int slept = 0;
    double last_at = 0, now = 0;
    film.play(
        "spiral", arena, {}, 16, [&](double t) { now = t; },
        [&] {
            for (const auto& e : arena.contact_begin_events()) {
                const auto [less, more] = std::minmax(e.body_data_a, e.body_data_b);
                if (less == 0 || more != less + 1 || std::ranges::find(hit, more) != hit.end()) continue;
                hit.push_back(more);
                last_at = now;
            }
            slept += static_cast<int>(arena.sleep_events().size()) - static_cast<int>(arena.wake_events().size());
        });
    int in_order = 0, fallen = 0;
    for (std::size_t i = 0; i < hit.size(); ++i) in_order += hit[i] == i + 2;
    for (const physics::body_id id : arena.bodies())
        fallen += arena.user_data(id) > 0 && std::fabs((arena.rotation(id) * world::vec{0, 1, 0}).y) < 0.9f;
    film.expect("dominoes touched by the one before, in order", in_order, count - 1);
    film.expect("fallen", fallen, count);
    film.fact("the last one is touched after, s", last_at);
    film.expect("asleep at the end, with the ball", slept, count + 1);
    film.expect("awake at the end", arena.awake_count(), 0);
    return film.finish();
}
