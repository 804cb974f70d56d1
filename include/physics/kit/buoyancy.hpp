// Water: what bodies displace of it lifts them.
#pragma once

#include "physics/kit/fields.hpp"

PHYSICS_HPP_BEGIN

/// Water below a plane.
template <class S, int D>
struct water {
    /// Unit vector out of the water, and the height of its surface along that (m).
    vec<S, D> up = upwards();
    S height = S(0);
    /// kg/m^3, in 2D kg/m^2.
    S density = S(1000);
    /// How fast it flows (m/s), and the rate (1/s) at which what it displaces takes over its speed.
    vec<S, D> velocity = {};
    S drag = S(2);

private:
    static constexpr vec<S, D> upwards() {
        vec<S, D> v;
        v.y = S(1);
        return v;
    }
};

namespace detail {

/// Of a solid, what is below a plane: its volume (in 2D its area), and the integral of places over it.
template <int D>
struct displaced {
    double volume = 0;
    point<D> first;

    void add(double size, const point<D>& at) {
        volume += size;
        first += at * size;
    }
};

/// Sums what is below a plane over pieces with cores. Places are relative to a point of the plane, so that the piece's
/// cut in it adds nothing to the divergence theorem's sum over its faces.
template <int D>
class displacement {
public:
    /// The plane goes through the origin of places.
    explicit displacement(const point<D>& up) : up_(up) {}

    void add(const placed_core<D>& solid) {
        const core<D>& c = *solid.shape;
        const mat<double, D>& axes = solid.axes;
        const point<D>& at = solid.at;
        const auto place = [&](const point<D>& p) { return axes * p + at; };
        switch (c.kind) {
            case core_kind::point: return add_round(place(c.corner[0]), perpendicular(up_), 0, 0, 0, c.radius);
            case core_kind::segment: {
                const auto [axis, size] = direction_and_length_of(place(c.corner[1]) - place(c.corner[0]));
                return add_round((place(c.corner[0]) + place(c.corner[1])) * 0.5, size > 0 ? axis : perpendicular(up_),
                                 size * 0.5, 0, 0, c.radius);
            }
            case core_kind::disc: {
                point<D> x;
                x.x = 1;
                return add_round(at, axes * x, c.corner[0].x, c.corner[0].y, c.corner[0][D - 1], c.radius);
            }
            case core_kind::hull_of_floats: return add_faces(*static_cast<const hull_data<float, D>*>(c.data), place);
            case core_kind::hull_of_doubles: return add_faces(*static_cast<const hull_data<double, D>*>(c.data), place);
            case core_kind::box: return add_box(c.corner[0], place);
            case core_kind::triangle: {
                if constexpr (D == 2)
                    for (int i = 0; i < 3; ++i) add_edge(place(c.corner[i]), place(c.corner[(i + 1) % 3]));
                return;
            }
            case core_kind::custom: {
                // Something between its supports along the axes.
                point<D> half, middle;
                for (int i = 0; i < D; ++i) {
                    point<D> d;
                    d[i] = 1;
                    const double high = c.support(d).at[i], low = c.support(-d).at[i];
                    half[i] = (high - low) * 0.5;
                    middle[i] = (high + low) * 0.5;
                }
                return add_box(half, [&](const point<D>& p) { return place(p + middle); });
            }
        }
    }
    [[nodiscard]] const displaced<D>& below() const { return below_; }
    /// The same of the whole solid.
    [[nodiscard]] const displaced<D>& whole() const { return whole_; }

private:
    /// A side that a polygon has, counter-clockwise.
    void add_edge(point<D> a, point<D> b) {
        if constexpr (D == 2) {
            add_triangle(whole_, a, b);
            const double height_a = dot(up_, a), height_b = dot(up_, b);
            if (height_a > 0 && height_b > 0) return;
            if (height_a > 0) a += (b - a) * (height_a / (height_a - height_b));
            else if (height_b > 0) b += (a - b) * (height_b / (height_b - height_a));
            add_triangle(below_, a, b);
        }
    }
    static void add_triangle(displaced<D>& to, const point<D>& a, const point<D>& b) {
        if constexpr (D == 2) to.add(0.5 * cross(a, b), (a + b) / 3.0);
    }
    /// A face of a polyhedron, whose corner(i) follow each other counter-clockwise as seen from outside.
    template <class Corner>
    void add_face(std::uint32_t count, Corner&& corner) {
        point<D> first, last;
        bool has_first = false, has_last = false;
        const auto add = [&](const point<D>& p) {
            if (!has_first) first = p;
            else if (has_last) add_tetrahedron(below_, first, last, p);
            has_last = has_first;
            has_first = true;
            last = p;
        };
        for (std::uint32_t i = 0; i < count; ++i) {
            const point<D> a = corner(i), b = corner(i + 1 < count ? i + 1 : 0);
            if (i > 0 && i + 1 < count) add_tetrahedron(whole_, corner(0), a, b);
            const double height_a = dot(up_, a), height_b = dot(up_, b);
            if (!(height_a > 0)) add(a);
            if ((height_a > 0) != (height_b > 0)) add(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    static void add_tetrahedron(displaced<D>& to, const point<D>& a, const point<D>& b, const point<D>& c) {
        if constexpr (D == 3) to.add(dot(a, cross(b, c)) / 6, (a + b + c) / 4.0);
    }
    template <class Hull, class Place>
    void add_faces(const Hull& hull, Place&& place) {
        for (std::uint32_t f = 0; f < hull.face_count; ++f) {
            const std::uint16_t* const corners = hull.face_vertices() + hull.face_begin(f);
            const auto corner = [&](std::uint32_t i) { return place(hull.exact_vertex(corners[i])); };
            if constexpr (D == 2) add_edge(corner(0), corner(1));
            else add_face(hull.face_end(f) - hull.face_begin(f), corner);
        }
    }
    template <class Place>
    void add_box(const point<D>& half, Place&& place) {
        // Corners of a rectangle, counter-clockwise.
        constexpr double first[] = {-1, 1, 1, -1}, second[] = {-1, -1, 1, 1};
        if constexpr (D == 2) {
            const auto corner = [&](int i) { return place(point<D>{half.x * first[i % 4], half.y * second[i % 4]}); };
            for (int i = 0; i < 4; ++i) add_edge(corner(i), corner(i + 1));
        } else {
            for (int axis = 0; axis < D; ++axis)
                for (const double side : {1.0, -1.0})
                    add_face(4, [&](std::uint32_t i) {
                        const int k = (axis + 1) % D, l = (axis + 2) % D;
                        point<D> p;
                        p[axis] = half[axis] * side;
                        p[k] = half[k] * first[i] * side;
                        p[l] = half[l] * second[i];
                        return place(p);
                    });
        }
    }
    /// A round solid, by slices across its axis: a frustum of these radii at -half and half, and all within a rounding
    /// of it.
    void add_round(const point<D>& middle, const point<D>& axis, double half, double low, double high,
                   double rounding) {
        constexpr int slices = 64;
        const double reach = half + rounding, width = 2 * reach / slices;
        const point<D> aside = up_ - axis * dot(up_, axis);
        const double steep = length(aside);
        const point<D> rise = steep > 1e-9 ? aside / steep : point<D>{};
        for (int i = 0; i < slices; ++i) {
            const double x = (i + 0.5) * width - reach, beyond = physics::abs(x) - half;
            const double along = half > 0 ? min(max(x / half, -1.0), 1.0) : 0;
            double radius = (low + high) * 0.5 + (high - low) * 0.5 * along;
            radius += beyond > 0 ? physics::sqrt(max(rounding * rounding - beyond * beyond, 0.0)) : rounding;
            const point<D> at = middle + axis * x;
            const double height = dot(up_, at);
            // How far the slice reaches on the side of the water, from its middle.
            const double to = steep > 1e-9 ? min(max(-height / steep, -radius), radius) : height > 0 ? -radius : radius;
            const double rest = physics::sqrt(max(radius * radius - to * to, 0.0));
            if constexpr (D == 2) {
                whole_.add(2 * radius * width, at);
                below_.add((to + radius) * width, at);
                below_.first += rise * ((to * to - radius * radius) * 0.5 * width);
            } else {
                const double turn = radius > 0 ? physics::acos(min(max(-to / radius, -1.0), 1.0)) : 0;
                whole_.add(pi<double> * radius * radius * width, at);
                below_.add((radius * radius * turn + to * rest) * width, at);
                below_.first += rise * (-2.0 / 3 * rest * rest * rest * width);
            }
        }
    }

    point<D> up_;
    displaced<D> below_, whole_;
};

/// What a shape at a pose displaces of water: volume, and centre if that is not 0. By its exact volume, in the parts of
/// its pieces.
template <class Shape, class S, int D>
displaced<D> displaced_by(const Shape& shape, const transform<S, D>& pose, const water<S, D>& of) {
    const point<D> up = unit(to_point(of.up)), at = to_point(pose.position);
    const double height = dot(up, at) - to_double(of.height);
    // Places are relative to the point of the surface below it.
    const point<D> origin = at - up * height;
    const mat<double, D> axes = to_matrix(pose.rotation);
    displacement<D> sum(up);
    if constexpr (has_core<Shape> || is_compound<Shape, D>)
        each_solid(shape, axes, up * height, everywhere(pose.rotation),
                   [&](const placed_core<D>& c, std::uint32_t) { sum.add(c); });
    displaced<D> below = sum.below();
    if (!(below.volume > 0) || !(sum.whole().volume > 0)) return {};
    below.first = below.first / below.volume + origin;
    if constexpr (requires { mass_of(shape, S(1)); })
        below.volume *= to_double(mass_of(shape, S(1)).mass) / sum.whole().volume;
    return below;
}

/// How a body that floats answers impulses, in double.
template <int D>
struct floating_body {
    double inverse_mass;
    /// About the axes of the world; 0 where nothing turns it.
    [[no_unique_address]] std::conditional_t<D == 2, double, symmetric<double>> inverse_inertia;
    vec<double, D> gravity;
    twist<double, D> velocity;

    template <class Inertia, class S>
    void set_turning(const Inertia& inertia, const rotation<S, D>& turn, const angular<S, D>& spin) {
        velocity.angular = converted<double>(spin);
        if constexpr (D == 2) inverse_inertia = inertia > Inertia(0) ? 1 / to_double(inertia) : 0;
        else inverse_inertia = rotated(inverse<double>(converted<double>(inertia)), matrix(converted<double>(turn)));
    }
    [[nodiscard]] angular<double, D> spin_by(const vec<double, D>& impulse, const vec<double, D>& r) const {
        if constexpr (D == 2) return inverse_inertia * cross(r, impulse);
        else return times(inverse_inertia, cross(r, impulse));
    }
    /// The force on a point at r from its centre of mass of what pushes it with `lift`, less by `stiffness` (N/m) the
    /// farther it comes along the unit vector `up`, and takes it along with `flow` at a rate (kg/s): by where and how
    /// fast it is at the end of h seconds, so that no step is too long. Where it swings slowly it is left to swing.
    [[nodiscard]] vec<double, D> force(const vec<double, D>& r, const vec<double, D>& up, const vec<double, D>& lift,
                                       double stiffness, const vec<double, D>& flow, double rate, double h) const {
        const auto response = [&](const vec<double, D>& impulse) {
            return impulse * inverse_mass + cross(spin_by(impulse, r), r);
        };
        const double steps = h * h * stiffness * dot(up, response(up)), rise = stiffness * h * steps / (1 + steps);
        const vec<double, D> free = velocity_at(velocity, r) + gravity * h;
        // v at the end: (1 + h rate response) v + h rise response(up) (up . v) = free + h response(lift + rate flow).
        const auto slowed = [&](vec<double, D> x) {
            vec<double, D> rows[D];
            for (int i = 0; i < D; ++i) {
                vec<double, D> axis{};
                axis[i] = 1;
                rows[i] = axis + response(axis) * (h * rate);
            }
            // A symmetric matrix, whose pivots are 1 or more.
            for (int i = 0; i < D; ++i)
                for (int k = 0; k < D; ++k) {
                    if (k == i) continue;
                    const double part = rows[k][i] / rows[i][i];
                    rows[k] -= rows[i] * part;
                    x[k] -= x[i] * part;
                }
            for (int i = 0; i < D; ++i) x[i] /= rows[i][i];
            return x;
        };
        const vec<double, D> risen = slowed(response(up) * (h * rise));
        vec<double, D> v = slowed(free + response(lift + flow * rate) * h);
        v -= risen * (dot(up, v) / (1 + dot(up, risen)));
        return lift - up * (rise * dot(up, v)) + (flow - v) * rate;
    }
};

}  // namespace detail

/// Lifts all bodies that are awake, in a next step of dt seconds, by the weight of the water that they displace, and
/// slows them down in it: call it before each step. What sleeps it lets sleep: wake it where the water rises; what
/// floats on nothing else stays awake. Exact for boxes, hulls, triangles and their compounds; round shapes by 64
/// slices, to 1 %; what is rounded by its core. No step is so long that drag turns a body around, or that what is light
/// is thrown. Refuses an up that is no unit vector, and negative numbers. O(bodies + shapes), and 1 to 5 us for each
/// shape near the surface.
template <class World>
void apply_buoyancy(World& w, const water<typename World::scalar, World::dimension>& of, typename World::scalar dt) {
    using S = typename World::scalar;
    constexpr int D = World::dimension;
    const char* f = "apply_buoyancy";
    if (!detail::check_in_range(f, "up", of.up) || !detail::check_in_range(f, "height", of.height) ||
        !detail::check_not_negative(f, "density", of.density) || !detail::check_in_range(f, "velocity", of.velocity) ||
        !detail::check_not_negative(f, "drag", of.drag) || !detail::check_positive(f, "dt", dt))
        return;
    if (const double size = detail::to_double(length(of.up)); !(size > 0.999 && size < 1.001)) {
        detail::refuse(f, "length of up", size, "it must be 1, to less than 0.001");
        return;
    }
    detail::scoped([&] {
        const vec<double, D> pull = detail::converted<double>(w.settings().gravity),
                             up = detail::unit(detail::to_point(of.up));
        const double h = detail::to_double(dt), fall = max(-dot(pull, up), 0.0),
                     density = detail::to_double(of.density);
        detail::each_awake(w, [&](body_id b) {
            double water_mass = 0, stiffness = 0;
            vec<double, D> center;
            for (const shape_id shape : w.shapes(b)) {
                if (w.is_sensor(shape)) continue;
                const auto pose = w.pose(b) * w.local_pose(shape);
                const auto own = w.shape(shape).visit([&](const auto& s) { return detail::displaced_by(s, pose, of); });
                if (!(own.volume > 0)) continue;
                const double mass = density * own.volume;
                water_mass += mass;
                center += (own.first - center) * (mass / water_mass);
                // No stiffer: what is below holds the cone from its lowest point to the plane of the surface, and its
                // centre is at most D / (D + 1) as deep as that point.
                const double depth = max(detail::to_double(of.height) - dot(up, own.first), 1e-9);
                stiffness += D * D / (D + 1.0) * mass * fall / depth;
            }
            if (!(water_mass > 0)) return;
            const auto mass = w.mass(b);
            detail::floating_body<D> body{1 / detail::to_double(mass.mass), {}, {}, {}};
            body.gravity = pull * detail::to_double(w.gravity_scale(b));
            body.velocity.linear = detail::converted<double>(w.linear_velocity(b));
            constexpr bool turns = requires { w.apply_torque(b, w.angular_velocity(b)); };
            if constexpr (turns)
                if (!w.rotation_locked(b)) body.set_turning(mass.inertia, w.rotation(b), w.angular_velocity(b));
            const vec<double, D> r = center - detail::converted<double>(w.center_of_mass(b));
            const double rate = detail::to_double(of.drag) * water_mass;
            const vec<double, D> force =
                body.force(r, up, pull * -water_mass, stiffness, detail::converted<double>(of.velocity), rate, h);
            w.apply_force_at(b, detail::converted<S>(force), detail::converted<S>(center));
            if constexpr (turns) {
                // Its spin goes as its speed does.
                const auto spin = body.velocity.angular + body.spin_by(force, r) * h;
                const auto kept = detail::converted<S>(spin * (rate / (1 / body.inverse_mass + rate * h)));
                if constexpr (D == 2) w.apply_torque(b, -(kept * mass.inertia));
                else w.apply_torque(b, -(w.rotation(b) * times(mass.inertia, inverse_rotate(w.rotation(b), kept))));
            }
        });
    });
}

PHYSICS_HPP_END
