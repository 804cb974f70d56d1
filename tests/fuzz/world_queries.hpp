// Queries of a world against a look at each of its shapes.
#pragma once

#include "world_checks.hpp"

namespace fuzz {

template <class World>
struct query_check {
    using S = typename World::scalar;
    static constexpr int D = World::dimension;
    using vec = physics::vec<S, D>;
    using transform = physics::transform<S, D>;
    using filter = physics::query_filter;

    const World& w;
    const filter& by;

    [[nodiscard]] bool sees(shape_id s) const {
        const auto f = w.filter(s);
        const auto kind = 1u << static_cast<unsigned>(w.type(w.body(s)));
        return (by.any_category || ((f.category & by.mask) && (by.category & f.mask))) && (by.kinds & kind) &&
               w.enabled(w.body(s)) && (by.sensors || !w.is_sensor(s)) && !(by.except && by.except == w.body(s));
    }
    template <class F>
    void each_seen(F&& f) const {
        for (const shape_id s : shapes_of(w))
            if (sees(s)) f(s);
    }

    /// Whether all is so near that distances are numbers.
    [[nodiscard]] bool is_near() const {
        for (const shape_id s : shapes_of(w))
            if (!(slack_of(w, s) < 1e9)) return false;
        for (const body_id b : w.bodies())
            for (int i = 0; i < World::dimension; ++i)
                if (std::abs(as_double(w.position(b)[i])) > 1e7 || std::abs(as_double(w.center_of_mass(b)[i])) > 1e7)
                    return false;
        return true;
    }

    void ray(vec origin, vec way) const {
        // First the world's own, which refuses what is bad.
        const auto first = w.cast_ray(origin, way, by);
        if (!is_near()) return;
        std::vector<std::pair<S, std::uint32_t>> expected, found;
        each_seen([&](shape_id s) {
            const auto hit = physics::cast_ray(w.shape(s), w.pose(w.body(s)), w.local_pose(s), origin, way);
            if (hit && (by.inside || !(hit.normal == vec{}))) expected.emplace_back(hit.fraction, s.index);
        });
        std::sort(expected.begin(), expected.end());
        w.each_hit_along_ray(origin, way, by, [&](const auto& hit) {
            FUZZ_REQUIRE(w.body(hit.shape) == hit.body && (hit.inside() || is_unit(hit.normal)));
            found.emplace_back(hit.fraction, hit.shape.index);
        });
        FUZZ_REQUIRE(found == expected);
        FUZZ_REQUIRE(static_cast<bool>(first) == !expected.empty());
        if (first) FUZZ_REQUIRE(std::pair(first.fraction, first.shape.index) == expected[0]);
    }
    template <class Shape>
    void overlaps(const Shape& probe, const transform& pose) const {
        std::set<shape_id> found;
        std::uint32_t last = 0;
        w.each_overlapping(probe, pose, by, [&](shape_id s) {
            FUZZ_REQUIRE(found.empty() || s.index > last);
            last = s.index;
            found.insert(s);
        });
        each_seen([&](shape_id s) {
            const double gap = gap_of(s, probe, pose);
            if (std::abs(gap) > slack(s, pose.position)) FUZZ_REQUIRE(found.count(s) == (gap < 0));
            found.erase(s);
        });
        FUZZ_REQUIRE(found.empty());
    }
    template <class Shape>
    void cast(const Shape& probe, const transform& pose, vec way) const {
        const auto hit = w.cast_shape(probe, pose, way, by);
        if (!is_near()) return;
        S first(2);
        each_seen([&](shape_id s) {
            w.shape(s).visit([&](const auto& other) {
                const auto at = pose_of(w, s);
                const auto one = cast_shape(other, probe, relative(at, pose), inverse_rotate(at.rotation, way));
                if (one && one.fraction < first) first = one.fraction;
            });
        });
        FUZZ_REQUIRE(static_cast<bool>(hit) == !(first > S(1)));
        if (hit) FUZZ_REQUIRE(hit.fraction == first && sees(hit.shape) && w.body(hit.shape) == hit.body);
    }
    void closest(vec point, S reach) const {
        const auto hit = w.closest_shape(point, reach, by);
        if (!is_near()) return;
        const physics::ball<S, D> tip{S(0)};
        S nearest{};
        bool any = false;
        each_seen([&](shape_id s) {
            w.shape(s).visit([&](const auto& other) {
                const auto at = relative(pose_of(w, s), transform{point, {}});
                const S d = physics::detail::separation_within(other, tip, at, reach).distance;
                if (!any || d < nearest) nearest = d;
                any = true;
            });
        });
        FUZZ_REQUIRE(static_cast<bool>(hit) == (any && !(nearest > reach)));
        if (hit) FUZZ_REQUIRE(hit.distance == nearest && sees(hit.shape));
    }
    template <class Shape>
    void collide(const Shape& probe, const transform& pose, S margin) const {
        std::map<shape_id, double> found;
        w.collide_shape(probe, pose, margin, by, [&](const auto& c) {
            FUZZ_REQUIRE(c.count > 0 && is_unit(c.normal) && w.body(c.shape) == c.body);
            found.emplace(c.shape, as_double(c.separation()));
        });
        each_seen([&](shape_id s) {
            const double gap = gap_of(s, probe, pose), room = as_double(margin);
            // Surfaces may have nothing on their backs.
            if (std::abs(gap - room) > slack(s, pose.position) + 1e-3)
                FUZZ_REQUIRE(found.count(s) == (gap < room) || (gap < room && is_surface(s)));
            found.erase(s);
        });
        FUZZ_REQUIRE(found.empty());
    }

    /// Batches say what single queries say.
    void batches(const transform& at, vec way) const {
        std::vector<physics::ray_query<S, D>> rays;
        std::vector<physics::shape_query<S, D>> casts;
        for (const vec to : {way, vec{}, -way}) {
            rays.push_back({at.position, to, by});
            casts.push_back({at, to, rays.size() == 2 ? filter{} : by});
        }
        const typename World::capsule probe{S(0.5), S(0.25)};
        std::vector<physics::world_hit<S, D>> of_rays(rays.size()), of_casts(rays.size());
        w.cast_rays(rays, of_rays);
        w.cast_shapes(probe, casts, of_casts);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            FUZZ_REQUIRE(is_same(of_rays[i], w.cast_ray(rays[i].origin, rays[i].translation, rays[i].filter)));
            FUZZ_REQUIRE(is_same(of_casts[i], w.cast_shape(probe, at, casts[i].translation, casts[i].filter)));
        }
    }

    /// What is drawn of a world where all is near is finite.
    void draw() const {
        struct {
            bool is_near;
            void point(vec at, physics::debug_color) const { FUZZ_REQUIRE(!is_near || physics::is_finite(at)); }
            void line(vec from, vec to, physics::debug_color by) const { point(from, by), point(to, by); }
            void text(vec at, const char*, physics::debug_color by) const { point(at, by); }
            void polygon(const vec* corners, std::uint32_t count, physics::debug_color by) const {
                FUZZ_REQUIRE(count > 2);
                for (std::uint32_t i = 0; i < count; ++i) point(corners[i], by);
            }
        } pen{is_near()};
        physics::debug_draw_options<S, D> all;
        all.contacts = all.boxes = all.tree = all.islands = all.frames = all.velocities = all.numbers = true;
        all.sides = 3;
        physics::debug_draw(w, pen, all);
    }

private:
    template <class Hit>
    static bool is_same(const Hit& one, const Hit& other) {
        return one.shape == other.shape && one.fraction == other.fraction;
    }
    template <class Shape>
    [[nodiscard]] double gap_of(shape_id s, const Shape& probe, const transform& pose) const {
        return w.shape(s).visit(
            [&](const auto& other) { return gap_between(other, probe, relative(pose_of(w, s), pose)); });
    }
    [[nodiscard]] bool is_surface(shape_id s) const {
        return w.shape(s).visit([]<class Shape>(const Shape&) { return physics::detail::is_surface<Shape, D>; });
    }
    [[nodiscard]] double slack(shape_id s, vec at) const {
        double most = 0;
        for (int i = 0; i < D; ++i) most = std::max(most, std::abs(as_double(at[i])));
        return slack_of(w, s) + 2e-5 * most;
    }
};

}  // namespace fuzz
