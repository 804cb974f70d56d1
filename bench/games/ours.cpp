// What games ask of a world of ours.
#include <physics.hpp>

#include "../../samples/scenes.hpp"
#include "row.hpp"

namespace bench::games {
namespace {

using physics::body_type;
using namespace physics::event;

template <int D>
struct plain : physics::recipe<float, D> {};
template <int D>
struct with_contacts : physics::recipe<float, D, physics::events<contact>> {};
template <int D>
struct with_hits : physics::recipe<float, D, physics::events<contact, hit>> {};
template <int D>
struct with_sensors : physics::recipe<float, D, physics::events<sensor>> {};
template <int D>
struct with_rule : physics::recipe<float, D, physics::one_way_platforms> {};

/// Steps of a pyramid at rest: begin() changes what is measured.
template <class Recipe, class Begin>
row step_row(const char* what, const size& by, Begin&& begin) {
    using world = physics::world<Recipe>;
    auto w = std::make_shared<world>(scenes::grounded<world>());
    if constexpr (world::dimension == 2) scenes::pyramid(*w, by.rows);
    else scenes::square_pyramid(*w, by.rows / 3);
    auto settings = w->settings();
    settings.sleeping.enabled = false;
    w->set_settings(settings);
    begin(*w);
    for (int i = 0; i < 120; ++i) w->step(1.0f / 60);
    return {what, "step", "ours", world::dimension, [w, frames = by.frames] {
                const stopwatch clock;
                for (int i = 0; i < frames; ++i) w->step(1.0f / 60);
                return clock.ns() / frames;
            }};
}

/// A field of boxes, and whether there was a step since they came.
template <int D, bool HasStepped = true>
struct field_of_boxes {
    using world = physics::world<plain<D>>;
    using vec = typename world::vec;

    world w;
    dice random;

    explicit field_of_boxes(int things) {
        const auto all = w.create_body({.type = body_type::static_body});
        for (int i = 0; i < things; ++i)
            w.create_shape(all, typename world::box{vec::filled(0.5f)}, {.position = place()});
        if (HasStepped) w.step(1.0f / 60);
    }
    vec place() {
        vec v;
        for (int i = 0; i < D; ++i) v[i] = static_cast<float>(field * random.number());
        return v;
    }
    vec way() {
        vec v = place();
        while (!(length(v) > 0)) v = place();
        return normalized(v) * static_cast<float>(ray_length);
    }
};
template <int D, class Ask>
row ask_row(const char* what, const size& by, Ask&& ask) {
    return query_row<field_of_boxes<D>>(what, "ours", D, by, ask);
}

/// The bodies of a scene at rest go one by one.
template <class Recipe, class Build>
row destroy_row(const char* what, Build&& build) {
    using world = physics::world<Recipe>;
    constexpr int D = world::dimension;
    auto from = std::make_shared<world>(scenes::grounded<world>());
    build(*from);
    for (int i = 0; i < 120; ++i) from->step(1.0f / 60);
    return {what, "body", "ours", D, [from] {
                world w = *from;
                double count = 0;
                const stopwatch clock;
                for (const auto b : w.bodies()) {
                    w.destroy_body(b);
                    ++count;
                }
                return clock.ns() / count;
            }};
}

template <int D>
row character_row(const size& by) {
    using world = physics::world<plain<D>>;
    struct scene {
        world w;
        physics::character<world> hero;

        scene() : hero(world::capsule::upright(1.8f, 0.3f), {}, up()) {
            const auto floor = w.create_body({.type = body_type::static_body});
            for (int i = -40; i < 40; ++i) {
                auto half = world::vec::filled(5);
                half.x = half.y = 0.5f;
                // A step of 10 cm up and down again each four metres.
                typename world::vec at;
                at.x = static_cast<float>(i);
                at.y = (i & 4) != 0 ? -0.4f : -0.5f;
                w.create_shape(floor, typename world::box{half}, {.position = at});
            }
            w.step(1.0f / 60);
        }
        static typename world::vec up() {
            typename world::vec v;
            v.y = 1;
            return v;
        }
    };
    auto s = std::make_shared<scene>();
    return {"walks over tiles and steps", "move", "ours", D, [s, moves = by.queries / 4] {
                typename world::vec walk;
                const stopwatch clock;
                for (int i = 0; i < moves; ++i) {
                    walk.x = (i / 240) % 2 == 0 ? 4.0f : -4.0f;
                    s->hero.move(s->w, walk, 1.0f / 60);
                }
                return clock.ns() / moves;
            }};
}

template <int D>
void add_rows(const size& by, std::vector<row>& rows) {
    const auto nothing = [](auto&) {};
    rows.push_back(step_row<plain<D>>("bare", by, nothing));
    rows.push_back(step_row<with_contacts<D>>("begin and end of contacts", by, nothing));
    rows.push_back(step_row<with_hits<D>>("and hits", by, nothing));
    rows.push_back(step_row<plain<D>>("a filter of its own for each body", by, [](auto& w) {
        for (const auto b : w.bodies())
            for (const auto s : w.shapes(b))
                w.set_filter(s, {.category = 1u << b.index % 31, .group = static_cast<std::int32_t>(b.index % 2) + 1});
    }));
    rows.push_back(step_row<with_rule<D>>("a contact rule, one-way platforms", by, nothing));
    rows.push_back(step_row<with_sensors<D>>("sensors in the recipe, none there", by, nothing));
    rows.push_back(step_row<with_sensors<D>>("1,000 sensors away from it", by, [](auto& w) {
        using world = std::remove_reference_t<decltype(w)>;
        const auto still = w.create_body({.type = body_type::static_body});
        for (int i = 0; i < 1000; ++i) {
            typename world::vec at;
            at.x = 200 + static_cast<float>(i);
            w.create_shape(still, typename world::ball{0.25f}, {.position = at, .sensor = true});
        }
    }));
    rows.push_back(ask_row<D>("closest hit of a ray", by, [](auto& f) {
        const auto from = f.place();
        return static_cast<bool>(f.w.cast_ray(from, f.way())) ? 1L : 0L;
    }));
    rows.push_back(query_row<field_of_boxes<D, false>>("a ray, all boxes created just now", "ours", D, by, [](auto& f) {
        const auto from = f.place();
        return static_cast<bool>(f.w.cast_ray(from, f.way())) ? 1L : 0L;
    }));
    rows.push_back(ask_row<D>("closest hit of a swept box", by, [](auto& f) {
        using world = std::remove_reference_t<decltype(f.w)>;
        const auto from = f.place();
        return f.w.cast_shape(typename world::box{world::vec::filled(0.5f)}, {from, {}}, f.way()) ? 1L : 0L;
    }));
    rows.push_back(ask_row<D>("all that a box of 8 m overlaps", by, [](auto& f) {
        using world = std::remove_reference_t<decltype(f.w)>;
        long found = 0;
        f.w.each_overlapping(typename world::box{world::vec::filled(4)}, {f.place(), {}}, {},
                             [&](physics::shape_id) { ++found; });
        return found;
    }));
    rows.push_back(character_row<D>(by));
    const auto build_pyramid = [&](auto& w) {
        if constexpr (D == 2) scenes::pyramid(w, by.rows);
        else scenes::square_pyramid(w, by.rows / 3);
    };
    rows.push_back(destroy_row<plain<D>>("destroys a pyramid one by one", build_pyramid));
    rows.push_back(destroy_row<with_contacts<D>>("the same with contact events", build_pyramid));
    rows.push_back(destroy_row<plain<D>>("destroys crates that sleep alone", [&](auto& w) {
        for (int i = 0; i < by.things; ++i) scenes::add_crate(w, 2 * i, 0.5);
    }));
}
const adds rows_of_ours([](const size& by, std::vector<row>& rows) {
    add_rows<2>(by, rows);
    add_rows<3>(by, rows);
});

}  // namespace
}  // namespace bench::games
