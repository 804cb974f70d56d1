// Debug drawing: what a world consists of, as points, lines, polygons and text for a renderer of the user's.
#pragma once

#include "physics/kit/debug_draw_options.hpp"
#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Draws with doubles, and hands on vectors of the world.
template <class World, class Renderer>
class debug_pen {
public:
    static constexpr int D = World::dimension;
    using S = typename World::scalar;
    using options_type = debug_draw_options<S, D>;

    debug_pen(const World& w, Renderer& to, const options_type& with) : w_(w), to_(to), with_(with) {}

    void draw() {
        if (with_.islands) list_islands();
        if (with_.tree) draw_tree();
        for (const body_id b : w_.bodies()) draw_body(b);
        if constexpr (!std::same_as<joint_list, joints<>>)
            if (with_.joints)
                for (const joint_id j : w_.joints()) draw_joint(j, joint_list{});
        if (!with_.contacts) return;
        for (const auto& c : w_.contacts()) {
            for (int k = 0; k < c.count; ++k) {
                const auto& p = c.points[k];
                if (!is_seen({p.position, p.position})) continue;
                to_.point(p.position, c.touching ? with_.of_contact : with_.of_box);
                const S size = p.normal_impulse * with_.impulse_scale;
                to_.line(p.position, p.position + c.normal * max(size, S(0.05)), with_.of_normal);
            }
        }
    }

private:
    using vec = typename World::vec;
    using joint_list = typename World::joint_list;
    static constexpr bool has_polygons = requires(Renderer & to, const vec* corners, debug_color color) {
        to.polygon(corners, std::uint32_t{}, color);
    };

    [[nodiscard]] bool is_seen(const aabb<S, D>& box) const { return overlap(box, with_.view); }
    [[nodiscard]] debug_color color_of(body_id b) const {
        if (!w_.enabled(b)) return with_.of_disabled;
        switch (w_.type(b)) {
            case body_type::static_body: return with_.of_static;
            case body_type::kinematic_body: return with_.of_kinematic;
            default: break;
        }
        if (with_.islands) return island_color(b.index);
        return w_.is_asleep(b) ? with_.of_asleep : with_.of_awake;
    }
    /// Names each island by its body of the least number.
    void list_islands() {
        constexpr std::uint32_t none = null_index;
        for (const body_id b : w_.bodies()) {
            if (b.index >= island_.size()) island_.resize(b.index + 1, none);
            if (island_[b.index] != none || w_.type(b) != body_type::dynamic_body) continue;
            for (const body_id other : w_.island(b)) {
                if (other.index >= island_.size()) island_.resize(other.index + 1, none);
                island_[other.index] = b.index;
            }
        }
    }
    /// Bright, and of neighbouring numbers far apart.
    [[nodiscard]] debug_color island_color(std::uint32_t body) const {
        const std::uint32_t mixed = island_[body] * 2654435769u;
        const auto shade = [&](unsigned shift) { return static_cast<std::uint8_t>(96 + (mixed >> shift) % 160); };
        return {shade(4), shade(13), shade(22)};
    }
    void draw_tree() {
        const auto& broadphase = world_access::state_of(w_).broadphase;
        // Of fixed point the range in double may be rounded up.
        const double far = to_double(scalar_traits<S>::max()) * (1 - 0x1p-24);
        const auto draw_node = [&](const aabb<double, D>& node) {
            point<D> low, high;
            for (int i = 0; i < D; ++i) {
                low[i] = max(node.lower[i], max(to_double(with_.view.lower[i]), -far));
                high[i] = min(node.upper[i], min(to_double(with_.view.upper[i]), far));
                if (low[i] > high[i]) return;
            }
            color_ = with_.of_tree;
            box_lines(high * 0.5 - low * 0.5, mat<double, D>::identity(), high * 0.5 + low * 0.5);
        };
        if constexpr (requires { broadphase.each_node(draw_node); }) broadphase.each_node(draw_node);
    }
    void line(const point<D>& a, const point<D>& b) { to_.line(from_point<S>(a), from_point<S>(b), color_); }
    /// Adds a corner to the next polygon, where the renderer has such.
    void corner(const point<D>& at) {
        if constexpr (has_polygons) corners_.push_back(from_point<S>(at));
    }
    /// Fills what the corners enclose, by either order.
    void fill(bool reversed = false) {
        if constexpr (has_polygons) {
            const std::uint32_t n = corners_.size();
            for (std::uint32_t i = 0; reversed && i < n / 2; ++i) std::swap(corners_[i], corners_[n - 1 - i]);
            to_.polygon(static_cast<const vec*>(corners_.begin()), n, color_);
            corners_.clear();
        }
    }

    void draw_body(body_id b) {
        const debug_color color = color_of(b);
        const vec center = w_.center_of_mass(b);
        for (const shape_id id : w_.shapes(b)) {
            const auto pose = w_.pose(b) * w_.local_pose(id);
            color_ = w_.is_sensor(id) ? with_.of_sensor : color;
            w_.shape(id).visit([&](const auto& shape) {
                const auto box = bounds(shape, pose);
                if (!is_seen(box)) return;
                if (with_.shapes) draw_shape(shape, pose);
                if (!with_.boxes) return;
                color_ = with_.of_box;
                box_lines(to_point((box.upper - box.lower) * S(0.5)), mat<double, D>::identity(),
                          to_point(box.lower + (box.upper - box.lower) * S(0.5)));
            });
        }
        if (!is_seen({center, center})) return;
        if (with_.frames) {
            to_.point(center, color);
            for (int i = 0; i < D; ++i) {
                vec axis;
                axis[i] = S(0.25);
                debug_color shade{0, 0, 0};
                (i == 0 ? shade.red : i == 1 ? shade.green : shade.blue) = 255;
                to_.line(w_.position(b), w_.position(b) + w_.rotation(b) * axis, shade);
            }
        }
        if (with_.velocities && w_.type(b) != body_type::static_body)
            to_.line(center, center + w_.linear_velocity(b) * with_.velocity_scale, with_.of_velocity);
        if constexpr (requires { to_.text(center, "", color); })
            if (with_.numbers) {
                char digits[11];
                char* at = digits + 10;
                *at = 0;
                std::uint32_t rest = b.index;
                do *--at = static_cast<char>('0' + rest % 10);
                while ((rest /= 10) != 0);
                to_.text(center, static_cast<const char*>(at), color);
            }
    }

    template <class Shape>
    void draw_shape(const Shape& shape, const transform<S, D>& pose) {
        const mat<double, D> axes = to_matrix(pose.rotation);
        const point<D> at = to_point(pose.position);
        if constexpr (is_halfspace<Shape>) {
            // A stretch of its surface, and its normal.
            const point<D> n = axes * to_point(shape.normal), p = at + n * to_double(shape.offset);
            const point<D> t = perpendicular(n) * surface_reach;
            if constexpr (D == 2) {
                line(p - t, p + t);
            } else {
                const point<D> u = cross(n, t);
                line(p - t, p + t);
                line(p - u, p + u);
            }
            line(p, p + n);
        } else if constexpr (has_core<Shape>) {
            draw_core(core_of(shape), axes, at);
        } else {
            each_piece(
                shape, view_in(axes, at), [](const auto&) { return true; },
                [&](const core<D>& piece, const mat<double, D>& turned, const point<D>& where, std::uint32_t) {
                    draw_core(piece, axes * turned, axes * where + at);
                });
        }
    }
    /// The view in the axes of a shape.
    [[nodiscard]] aabb<double, D> view_in(const mat<double, D>& axes, const point<D>& at) const {
        const aabb<double, D> view{to_point(with_.view.lower), to_point(with_.view.upper)};
        const point<D> middle = transposed_times(axes, (view.lower + view.upper) * 0.5 - at),
                       half = (view.upper - view.lower) * 0.5;
        point<D> reach;
        for (int i = 0; i < D; ++i)
            for (int k = 0; k < D; ++k) reach[i] += abs(axes.column[i][k]) * half[k];
        return {middle - reach, middle + reach};
    }

    void draw_core(const core<D>& c, const mat<double, D>& axes, const point<D>& at) {
        const auto place = [&](const point<D>& p) { return axes * p + at; };
        switch (c.kind) {
            case core_kind::point:
                circles(place(c.corner[0]), axes, c.radius);
                // How it is turned.
                return line(place(c.corner[0]), place(c.corner[0]) + axes.column[0] * c.radius);
            case core_kind::segment: return draw_capsule(place(c.corner[0]), place(c.corner[1]), c.radius);
            case core_kind::triangle:
                for (int i = 0; i < 3; ++i) {
                    line(place(c.corner[i]), place(c.corner[(i + 1) % 3]));
                    corner(place(c.corner[i]));
                }
                // In 2D its corners may go either way round.
                if constexpr (D == 2) fill(cross(c.corner[1] - c.corner[0], c.corner[2] - c.corner[0]) < 0);
                else fill();
                return;
            case core_kind::box: return draw_box(c.corner[0], c.radius, axes, at);
            case core_kind::disc: return draw_frustum(c, axes, at);
            case core_kind::hull_of_floats: return draw_hull(*static_cast<const hull_data<float, D>*>(c.data), place);
            case core_kind::hull_of_doubles: return draw_hull(*static_cast<const hull_data<double, D>*>(c.data), place);
            case core_kind::custom: return draw_custom(c, axes, at);
        }
    }
    /// One circle in 2D, one about each axis in 3D.
    void circles(const point<D>& middle, const mat<double, D>& axes, double radius) {
        for (int i = 0; i < (D == 2 ? 1 : 3); ++i)
            circle(middle, axes.column[(i + 1) % D] * radius, axes.column[(i + 2) % D] * (D == 2 ? -radius : radius));
    }
    void circle(const point<D>& middle, const point<D>& x, const point<D>& y) {
        arc(middle, x, y, 4);
        if constexpr (D == 2 && has_polygons) {
            corners_.pop_back();
            fill();
        }
    }
    /// From x towards y, so many quarters of a circle; in 2D its ends become corners.
    void arc(const point<D>& middle, const point<D>& x, const point<D>& y, int quarters) {
        point<D> last = middle + x;
        if (D == 2) corner(last);
        const int share = with_.sides * quarters / 4, sides = share > 0 ? share : 1;
        for (int i = 1; i <= sides; ++i) {
            const auto [s, c] = sine_cosine(pi<double> / 2 * quarters * i / sides);
            const point<D> next = middle + x * c + y * s;
            line(last, next);
            if (D == 2) corner(next);
            last = next;
        }
    }
    void draw_capsule(const point<D>& from, const point<D>& to, double radius) {
        if (!(radius > 0)) return line(from, to);
        const point<D> out = normalized(to - from) * radius;
        point<D> sides[] = {perpendicular(normalized(out)) * radius, {}};
        if constexpr (D == 3) sides[1] = cross(normalized(out), sides[0]);
        for (int i = 0; i < D - 1; ++i) {
            arc(from, -sides[i], -out, 2);
            arc(to, sides[i], out, 2);
            for (const double s : {1.0, -1.0}) line(from + sides[i] * s, to + sides[i] * s);
        }
        if constexpr (D == 3)
            for (const auto& end : {from, to}) circle(end, sides[0], sides[1]);
        else fill();
    }
    void draw_box(const point<D>& half, double radius, const mat<double, D>& axes, const point<D>& at) {
        const auto place = [&](const point<D>& p) { return axes * p + at; };
        if (!(radius > 0)) box_lines(half, axes, at);
        if constexpr (D == 2) {
            // Counter-clockwise; the sides between the corners are as round as they are.
            for (int i = 0; i < 4; ++i) {
                const auto turned = [&](double x, double y) {
                    return i == 0   ? point<D>{x, y}
                           : i == 1 ? point<D>{-y, x}
                           : i == 2 ? point<D>{-x, -y}
                                    : point<D>{y, -x};
                };
                const point<D> x = turned(radius, 0), y = turned(0, radius), out = turned(1, 1), next = turned(-1, 1);
                const point<D> middle{out.x * half.x, out.y * half.y}, after{next.x * half.x, next.y * half.y};
                if (!(radius > 0)) {
                    corner(place(middle));
                    continue;
                }
                arc(place(middle), axes * x, axes * y, 1);
                line(place(middle + y), place(after + y));
            }
            fill();
        } else {
            for (int face = 0; face < 6; ++face) {
                const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
                const double side = face % 2 == 0 ? -1 : 1;
                point<D> p[4];
                for (int i = 0; i < 4; ++i) {
                    p[i][axis] = side * (half[axis] + radius);
                    p[i][u] = i == 0 || i == 3 ? -half[u] : half[u];
                    p[i][v] = i < 2 ? -half[v] : half[v];
                    corner(place(p[i]));
                }
                fill(face % 2 == 0);
                for (int i = 0; i < 4 && radius > 0; ++i) {
                    line(place(p[i]), place(p[(i + 1) % 4]));
                    // From this face to the next one about each of its corners.
                    point<D> x, y, middle = p[i];
                    x[axis] = side * radius;
                    y[u] = p[i][u] < 0 ? -radius : radius;
                    middle[axis] = side * half[axis];
                    arc(place(middle), axes * x, axes * y, 1);
                }
            }
        }
    }
    void box_lines(const point<D>& half, const mat<double, D>& axes, const point<D>& at) {
        for (int axis = 0; axis < D; ++axis)
            for (int i = 0; i < 1 << D; ++i) {
                if ((i >> axis & 1) != 0) continue;
                point<D> from;
                for (int k = 0; k < D; ++k) from[k] = (i >> k & 1) != 0 ? half[k] : -half[k];
                point<D> to = from;
                to[axis] = -from[axis];
                line(axes * from + at, axes * to + at);
            }
    }
    void draw_frustum(const core<D>& c, const mat<double, D>& axes, const point<D>& at) {
        if constexpr (D == 3) {
            const point<D> along = axes.column[0] * (c.corner[0].x + c.radius);
            const double low = c.corner[0].y + c.radius, high = c.corner[0].z + c.radius;
            circle(at - along, axes.column[1] * low, axes.column[2] * low);
            circle(at + along, axes.column[1] * high, axes.column[2] * high);
            for (const double s : {1.0, -1.0})
                for (int i = 1; i < 3; ++i)
                    line(at - along + axes.column[i] * (low * s), at + along + axes.column[i] * (high * s));
        }
    }
    template <class Hull, class Place>
    void draw_hull(const Hull& hull, Place&& place) {
        for (std::uint32_t f = 0; f < hull.face_count; ++f) {
            const std::uint32_t first = hull.face_begin(f), count = hull.face_end(f) - first;
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint32_t a = hull.face_vertices()[first + i],
                                    b = hull.face_vertices()[first + (i + 1 < count ? i + 1 : 0)];
                // Of both faces at an edge one draws it; in 2D a face is an edge.
                if (D == 2 ? i == 0 : a < b) line(place(hull.exact_vertex(a)), place(hull.exact_vertex(b)));
                if (D == 3 || i == 0) corner(place(hull.exact_vertex(a)));
            }
            if (D == 3 || f + 1 == hull.face_count) fill();
        }
    }
    /// Its outlines as seen along its axes.
    void draw_custom(const core<D>& c, const mat<double, D>& axes, const point<D>& at) {
        for (int axis = 0; axis < (D == 2 ? 1 : 3); ++axis) {
            point<D> last;
            for (int i = 0; i <= with_.sides; ++i) {
                const auto [s, o] = sine_cosine(2 * pi<double> * i / with_.sides);
                point<D> d;
                d[(axis + 1) % D] = o;
                d[(axis + 2) % D] = s;
                const point<D> next = axes * (c.support(d).at + d * c.radius) + at;
                if (i > 0) line(last, next);
                if (D == 2 && i > 0) corner(next);
                last = next;
            }
            if (D == 2) fill(true);
        }
    }

    template <template <class, int> class... Kinds>
    void draw_joint(joint_id j, joints<Kinds...>) {
        (draw_joint_of<Kinds<S, D>>(j), ...);
    }
    template <class Joint>
    void draw_joint_of(joint_id id) {
        if (!w_.template is_joint<Joint>(id)) return;
        const auto joint = w_.template joint<Joint>(id);
        const body_id a = w_.body_a(id), b = w_.body_b(id);
        vec at_a = w_.center_of_mass(a), at_b = w_.center_of_mass(b);
        if constexpr (requires { joint.frame_a.position; }) at_a = w_.pose(a) * joint.frame_a.position;
        else if constexpr (requires { joint.anchor_a; }) at_a = w_.pose(a) * joint.anchor_a;
        if constexpr (requires { joint.frame_b.position; }) at_b = w_.pose(b) * joint.frame_b.position;
        else if constexpr (requires { joint.anchor_b; }) at_b = w_.pose(b) * joint.anchor_b;
        if (!is_finite(at_a) || !is_finite(at_b)) return;
        if (!is_seen(merged(aabb<S, D>{min(at_a, at_b), max(at_a, at_b)}, aabb<S, D>{at_a, at_a}))) return;
        to_.point(at_a, with_.of_joint);
        to_.point(at_b, with_.of_joint);
        to_.line(at_a, at_b, with_.of_joint);
        if (w_.type(a) != body_type::static_body) to_.line(w_.center_of_mass(a), at_a, with_.of_joint);
        if (w_.type(b) != body_type::static_body) to_.line(w_.center_of_mass(b), at_b, with_.of_joint);
    }

    /// How much of the surface of a halfspace is drawn (m).
    static constexpr double surface_reach = 100;

    const World& w_;
    Renderer& to_;
    const options_type& with_;
    debug_color color_;
    /// Of each body by number.
    buffer<std::uint32_t> island_;
    buffer<vec> corners_;
};

}  // namespace detail

/// Draws a world by calls of renderer.point(at, color) and renderer.line(from, to, color), and, where it has these,
/// renderer.text(at, characters, color) and renderer.polygon(corners, count, color), with vectors of the world.
/// Polygons are convex and counter-clockwise as seen from outside: the faces of boxes, hulls and triangles, and in 2D
/// all that is solid. Triangles and surfaces are drawn without their radius. Refuses fewer than 3 sides. Reads only.
/// O(bodies + shapes + contacts + joints), with islands O(bodies / 64) for each island more.
template <class World, class Renderer>
void debug_draw(const World& w, Renderer&& renderer,
                const debug_draw_options<typename World::scalar, World::dimension>& with = {}) {
    if (with.sides < 3) {
        detail::refuse("debug_draw", "sides", with.sides, "it must be at least 3");
        return;
    }
    detail::scoped([&] { detail::debug_pen(w, renderer, with).draw(); });
}

PHYSICS_HPP_END
