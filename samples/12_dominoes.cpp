// Dominoes: fifty in a spiral, and in the plane in a row; a ball hits the first, contact events tell how they fall.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

template <int D>
struct floor_of_dominoes : physics::recipe<float, D, physics::events<physics::event::contact, physics::event::sleep>> {
};

constexpr int count = 50;
constexpr float half_thick = 0.05f, half_tall = 0.4f, half_wide = 0.2f, apart = 0.4f;

/// Where a domino stands, and where the next one is from there.
template <int D>
struct place {
    physics::vec<float, D> at, way;
};
template <int D>
std::vector<place<D>> places() {
    std::vector<place<D>> all;
    if constexpr (D == 2) {
        for (int i = 0; i < count; ++i) all.push_back({{apart * static_cast<float>(i), half_tall}, {1, 0}});
    } else {
        // Equal ways along a spiral from the outside in, whose turns are 1.2 m apart.
        const float growth = 1.2f / (2 * 3.14159265f);
        float angle = 6 * 3.14159265f;
        for (int i = 0; i < count; ++i) {
            const float radius = growth * angle, cosine = std::cos(angle), sine = std::sin(angle);
            all.push_back({{radius * cosine, half_tall, radius * sine},
                           normalized(physics::vec<float, 3>{radius * sine - growth * cosine, 0,
                                                             -radius * cosine - growth * sine})});
            angle -= apart / std::hypot(radius, growth);
        }
    }
    return all;
}

template <int D>
void topple(samples::film& film, const char* title) {
    using world = physics::world<floor_of_dominoes<D>>;
    world arena = scenes::grounded<world>();
    typename world::vec up, half = world::vec::filled(half_wide);
    up.y = 1;
    half.x = half_thick;
    half.y = half_tall;

    const std::vector<place<D>> row = places<D>();
    for (int i = 1; i <= count; ++i) {
        const auto& [at, way] = row[static_cast<std::size_t>(i) - 1];
        typename world::body_def def{.position = at, .user_data = static_cast<std::uint64_t>(i)};
        if constexpr (D == 3) def.rotation = physics::rotation<float, 3>::from_x_axis(way);
        arena.create_shape(arena.create_body(def), typename world::box{half}, {.density = 500});
    }
    // Rolling resistance does not end its spin about the vertical: damping does.
    const physics::body_id ball = arena.create_body({
        .position = row[0].at - row[0].way * 0.8f + up * 0.3f,
        .linear_velocity = row[0].way * 3.0f,
        .angular_damping = 0.5f,
    });
    arena.create_shape(ball, typename world::ball{0.2f}, {.density = 1000, .material = {.rolling_resistance = 0.02f}});

    std::vector<std::uint64_t> hit;  // numbers of dominoes, in the order in which the ones before touched them
    int slept = 0;
    double last_at = 0, now = 0;
    film.play(
        title, arena, {}, 16, [&](double t) { now = t; },
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
        fallen += arena.user_data(id) > 0 && std::fabs((arena.rotation(id) * up).y) < 0.9f;
    film.expect("dominoes touched by the one before, in order", in_order, count - 1);
    film.expect("fallen", fallen, count);
    film.fact("the last one is touched after, s", last_at);
    film.expect("asleep at the end, with the ball", slept, count + 1);
    film.expect("awake at the end", arena.awake_count(), 0);
}

}  // namespace

int main() {
    samples::film film("Dominoes", "fifty in a row and in a spiral, and a ball", "samples/out/dominoes.html");
    topple<2>(film, "row");
    topple<3>(film, "spiral");
    return film.finish();
}
