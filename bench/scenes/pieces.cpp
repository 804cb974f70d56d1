// What the judge makes of shapes: their masses, and how deep they overlap.
#include "judge.hpp"

#include <algorithm>
#include <tuple>

namespace bench {

namespace {

using points = std::vector<triple>;
constexpr double pi = 3.14159265358979323846;

triple unit(const triple& v) { return v * (1 / length(v)); }

/// Calls f(a, b, c, d) for the faces of a hull in space, as triangles seen counter-clockwise from outside. Every plane
/// through three points that has all others on one side; meant for a dozen points.
template <class F>
void each_triangle(const points& p, F&& f) {
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = i + 1; j < p.size(); ++j)
            for (std::size_t k = j + 1; k < p.size(); ++k) {
                const triple n = unit(cross(p[j] - p[i], p[k] - p[i]));
                double least = 0, most = 0;
                for (const triple& q : p) {
                    least = std::min(least, dot(n, q - p[i]));
                    most = std::max(most, dot(n, q - p[i]));
                }
                if (most < 1e-9) f(p[i], p[j], p[k]);
                else if (least > -1e-9) f(p[i], p[k], p[j]);
            }
}

/// Adds a direction unless it is there, up to sign.
void add_axis(points& axes, const triple& v) {
    const triple n = unit(v);
    for (const triple& a : axes)
        if (std::fabs(dot(a, n)) > 1 - 1e-9) return;
    axes.push_back(n);
}

/// A convex shape in the frame of its body.
piece made(const shape& s, int dimension) {
    piece p;
    if (s.kind == form::ball) p.points = {{0, 0, 0}};
    if (s.kind == form::capsule || s.kind == form::cylinder || s.kind == form::segment)
        p.points = {{-s.half[0], 0, 0}, {s.half[0], 0, 0}};
    if (s.kind == form::hull) p.points = s.points;
    if (s.kind == form::box && dimension == 2)
        p.points = {{-s.half[0], -s.half[1], 0},
                    {s.half[0], -s.half[1], 0},
                    {s.half[0], s.half[1], 0},
                    {-s.half[0], s.half[1], 0}};
    if (s.kind == form::box && dimension == 3)
        for (int k = 0; k < 8; ++k)
            p.points.push_back(
                {k & 1 ? s.half[0] : -s.half[0], k & 2 ? s.half[1] : -s.half[1], k & 4 ? s.half[2] : -s.half[2]});
    (s.kind == form::cylinder ? p.disc : p.radius) = s.radius;
    if (dimension == 2) {
        for (std::size_t i = 0; i < p.points.size() && p.points.size() > 1; ++i) {
            const triple e = p.points[(i + 1) % p.points.size()] - p.points[i];
            p.normals.push_back(unit({e[1], -e[0], 0}));
        }
    } else if (s.kind == form::box) {
        p.normals = p.edges = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    } else if (s.kind == form::capsule || s.kind == form::cylinder) {
        p.edges = {{1, 0, 0}};
        if (s.kind == form::cylinder) p.normals = p.edges;
    } else if (s.kind == form::hull) {
        each_triangle(p.points, [&](const triple& a, const triple& b, const triple& c) {
            add_axis(p.normals, cross(b - a, c - a));
            // A diagonal of a face is an axis too many, which does no harm.
            add_axis(p.edges, b - a);
            add_axis(p.edges, c - b);
            add_axis(p.edges, a - c);
        });
    }
    for (triple& q : p.points) q = s.at + rotated(s.rotation, q);
    for (points* axes : {&p.normals, &p.edges})
        for (triple& q : *axes) q = rotated(s.rotation, q);
    return p;
}
struct range {
    double lower, upper;
};
range along(const piece& p, const triple& axis) {
    range r = {dot(axis, p.points[0]), dot(axis, p.points[0])};
    for (const triple& q : p.points) {
        r.lower = std::min(r.lower, dot(axis, q));
        r.upper = std::max(r.upper, dot(axis, q));
    }
    return r;
}

double distance_to_segment(const triple& p, const triple& a, const triple& b) {
    const triple e = b - a;
    const double ee = dot(e, e), t = ee > 0 ? std::clamp(dot(p - a, e) / ee, 0.0, 1.0) : 0;
    return length(p - (a + e * t));
}
/// Of the corners of one to the edges of the other.
double corner_distance(const points& a, const points& b) {
    double least = 1e300;
    for (const triple& p : a)
        for (std::size_t i = 0; i < b.size(); ++i)
            least = std::min(least, distance_to_segment(p, b[i], b[(i + 1) % b.size()]));
    return least;
}

double overlap2(const piece& a, const piece& b) {
    const double radius = a.radius + b.radius;
    double gap = -1e300;
    for (const auto& [p, q] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (const triple& n : p->normals) {
            gap = std::max(gap, along(*q, n).lower - along(*p, n).upper);
            if (gap > radius) return 0;
        }
    // Cores that are apart, or have no edges, are as far from each other as their nearest corner and edge.
    if (gap > 0 || (a.points.size() == 1 && b.points.size() == 1))
        gap = radius > 0 ? std::min(corner_distance(a.points, b.points), corner_distance(b.points, a.points)) : 0;
    return std::max(0.0, radius - gap);
}

/// How far the intervals of both must move along an axis of any length to be apart; negative if they are.
bool depth_along(const piece& a, const piece& b, const triple& axis, double& depth) {
    const range p = along(a, axis), q = along(b, axis);
    depth = std::min(depth, std::min(p.upper - q.lower, q.upper - p.lower));
    return depth > 0;
}
double overlap_of_polytopes(const piece& a, const piece& b) {
    double depth = 1e300;
    for (const piece* p : {&a, &b})
        for (const triple& n : p->normals)
            if (!depth_along(a, b, n, depth)) return 0;
    for (const triple& e : a.edges)
        for (const triple& f : b.edges) {
            const triple n = cross(e, f);
            const double l = length(n);
            // Parallel edges give no axis that faces do not.
            if (l > 1e-6 && !depth_along(a, b, n * (1 / l), depth)) return 0;
        }
    return depth;
}
/// Of a ball and a box, whose three axes are its normals.
double overlap_with_box(const piece& ball, const piece& box) {
    triple out = {};
    double within = 1e300;
    for (int k = 0; k < 3; ++k) {
        const triple& n = box.normals[static_cast<std::size_t>(k)];
        const range r = along(box, n);
        const double x = dot(n, ball.points[0]);
        out[static_cast<std::size_t>(k)] = std::max({0.0, r.lower - x, x - r.upper});
        within = std::min({within, x - r.lower, r.upper - x});
    }
    return std::max(0.0, within > 0 ? ball.radius + within : ball.radius - length(out));
}

/// How far a piece reaches in the direction of a unit vector.
double reach(const piece& p, const triple& d) {
    double most = dot(p.points[0], d);
    for (const triple& q : p.points) most = std::max(most, dot(q, d));
    if (p.disc == 0) return most + p.radius;
    const double along_axis = dot(p.normals[0], d);
    return most + p.disc * std::sqrt(std::max(0.0, 1 - along_axis * along_axis));
}
/// The least way that takes them apart, over all directions: from the best of those of faces, edges, axes and
/// middles downhill, by steps of ever smaller angles.
double overlap_by_search(const piece& a, const piece& b) {
    triple best = {0, 1, 0};
    double least = 1e300;
    const auto apart = [&](const triple& d) {
        const double depth = reach(a, d) + reach(b, d * -1);
        if (depth < least) {
            least = depth;
            best = d;
        }
        return least <= 0;
    };
    const auto either_way = [&](const triple& v) {
        const double l = length(v);
        return l > 1e-6 && (apart(v * (1 / l)) || apart(v * (-1 / l)));
    };
    triple between = {};
    for (const triple& p : a.points) between = between - p * (1.0 / static_cast<double>(a.points.size()));
    for (const triple& q : b.points) between = between + q * (1.0 / static_cast<double>(b.points.size()));
    if (either_way(between)) return 0;
    for (const piece* p : {&a, &b})
        for (const triple& n : p->normals)
            if (either_way(n)) return 0;
    for (const triple& e : a.edges)
        for (const triple& f : b.edges)
            if (either_way(cross(e, f))) return 0;
    // From the axis of what is round to the corners of the other: there a crease lies across the way downhill.
    for (const auto& [p, q, way] : {std::tuple(&a, &b, 1.0), std::tuple(&b, &a, -1.0)})
        if (p->points.size() == 2)
            for (const triple& corner : q->points) {
                const triple out = corner - p->points[0];
                if (either_way((out - p->edges[0] * dot(out, p->edges[0])) * way)) return 0;
            }
    double twist = 0;
    for (double angle = 0.25; angle > 1e-6; angle /= 2)
        for (double before = 1e300; least < before;) {
            before = least;
            const triple d = best, side = unit(cross(d, std::fabs(d[0]) < 0.6 ? triple{1, 0, 0} : triple{0, 1, 0}));
            const triple other = cross(d, side);
            // Another frame each time, so that no valley lies across all of them.
            twist += 1;
            for (int k = 0; k < 8; ++k) {
                const double at = twist + k * pi / 4;
                if (apart(unit(d + (side * std::cos(at) + other * std::sin(at)) * angle))) return 0;
            }
            // Where one corner takes over from the next there is a crease, across their edge: along it too.
            for (const points* edges : {&a.edges, &b.edges})
                for (const triple& e : *edges) {
                    const double off = dot(e, d);
                    if (std::fabs(off) > 2 * angle) continue;
                    const triple in = d - e * off, way = cross(e, d) * angle;
                    if (apart(unit(in)) || apart(unit(in + way)) || apart(unit(in - way))) return 0;
                }
        }
    return least;
}

mass mass2(const shape& s) {
    mass m;
    double about = 0;  // inertia about the shape's own centre
    if (s.kind == form::ball) {
        m.value = s.density * pi * s.radius * s.radius;
        about = m.value * s.radius * s.radius / 2;
    } else if (s.kind == form::capsule) {
        const double l = s.half[0], r = s.radius, middle = s.density * 4 * l * r, ends = s.density * pi * r * r;
        m.value = middle + ends;
        about = middle * (l * l + r * r) / 3 + ends * (r * r / 2 + l * l + 2 * l * 4 * r / (3 * pi));
    } else {
        shape corners = s;
        corners.at = {};
        corners.rotation = {0, 0, 0, 1};
        const points p = made(corners, 2).points;
        double about_origin = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            const triple &a = p[i], &b = p[(i + 1) % p.size()];
            const double area = (a[0] * b[1] - a[1] * b[0]) / 2 * s.density;
            m.value += area;
            m.center = m.center + (a + b) * (area / 3);
            about_origin += area / 6 * (dot(a, a) + dot(a, b) + dot(b, b));
        }
        m.center = m.center * (1 / m.value);
        about = about_origin - m.value * dot(m.center, m.center);
    }
    m.center = s.at + rotated(s.rotation, m.center);
    m.inertia[2][2] = about;
    return m;
}

/// A shape in space at its body's origin: other places are not needed.
mass mass3(const shape& s) {
    mass m;
    if (s.kind == form::ball) {
        m.value = s.density * 4 / 3 * pi * s.radius * s.radius * s.radius;
        for (std::size_t k = 0; k < 3; ++k) m.inertia[k][k] = m.value * 0.4 * s.radius * s.radius;
        return m;
    }
    if (s.kind == form::capsule || s.kind == form::cylinder) {
        const double l = s.half[0], r = s.radius, middle = s.density * 2 * pi * r * r * l;
        const double ends = s.kind == form::capsule ? s.density * 4 / 3 * pi * r * r * r : 0;
        m.value = middle + ends;
        m.inertia[0][0] = middle * r * r / 2 + ends * r * r * 0.4;
        m.inertia[1][1] = m.inertia[2][2] =
            middle * (r * r / 4 + l * l / 3) + ends * (r * r * 0.4 + l * l + l * r * 0.75);
        return m;
    }
    if (s.kind == form::box) {
        m.value = s.density * 8 * s.half[0] * s.half[1] * s.half[2];
        for (std::size_t k = 0; k < 3; ++k)
            m.inertia[k][k] = m.value / 3 * (dot(s.half, s.half) - s.half[k] * s.half[k]);
        return m;
    }
    // Tetrahedra from the origin; second moments of each are those of its corners, together.
    std::array<triple, 3> second = {};
    each_triangle(s.points, [&](const triple& a, const triple& b, const triple& c) {
        const double volume = dot(a, cross(b, c)) / 6 * s.density;
        const triple sum = a + b + c;
        m.value += volume;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                second[i][j] += volume / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
    });
    const double trace = second[0][0] + second[1][1] + second[2][2];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) m.inertia[i][j] = (i == j ? trace : 0) - second[i][j];
    return m;
}

}  // namespace

std::vector<piece> pieces_of(const shape& s, int dimension) {
    if (s.kind != form::chain && s.kind != form::mesh) return {made(s, dimension)};
    points corners;
    for (const triple& p : s.points) corners.push_back(s.at + rotated(s.rotation, p));
    std::vector<piece> all;
    if (s.kind == form::chain)
        for (std::size_t i = 0; i < corners.size(); ++i) {
            shape part;
            part.kind = form::hull;
            part.points = {corners[i], corners[(i + 1) % corners.size()]};
            all.push_back(made(part, 2));
        }
    for (std::size_t i = 0; i < s.triangles.size(); i += 3) {
        piece p;
        for (std::size_t k = 0; k < 3; ++k) p.points.push_back(corners[s.triangles[i + k]]);
        for (std::size_t k = 0; k < 3; ++k) p.edges.push_back(unit(p.points[(k + 1) % 3] - p.points[k]));
        p.normals = {unit(cross(p.edges[0], p.edges[1]))};
        all.push_back(std::move(p));
    }
    return all;
}

piece moved(piece p, const state& at) {
    for (triple& q : p.points) q = at.at + rotated(at.rotation, q);
    for (points* axes : {&p.normals, &p.edges})
        for (triple& q : *axes) q = rotated(at.rotation, q);
    return p;
}

mass mass_of(const body& b, int dimension) {
    if (b.kind != role::free) return {};
    if (dimension == 3) return mass3(b.shapes.front());
    mass sum;
    for (const shape& s : b.shapes) {
        const mass m = mass2(s);
        sum.value += m.value;
        sum.center = sum.center + m.center * m.value;
    }
    sum.center = sum.center * (1 / sum.value);
    for (const shape& s : b.shapes) {
        const mass m = mass2(s);
        const triple away = m.center - sum.center;
        sum.inertia[2][2] += m.inertia[2][2] + m.value * dot(away, away);
    }
    return sum;
}

double overlap(const piece& a, const piece& b, int dimension) {
    if (dimension == 2) return overlap2(a, b);
    const bool ball_a = a.points.size() == 1, ball_b = b.points.size() == 1;
    if (ball_a && ball_b) return std::max(0.0, a.radius + b.radius - length(a.points[0] - b.points[0]));
    if (ball_a && b.normals.size() == 3) return overlap_with_box(a, b);
    if (ball_b && a.normals.size() == 3) return overlap_with_box(b, a);
    if (a.radius + b.radius + a.disc + b.disc == 0) return overlap_of_polytopes(a, b);
    return overlap_by_search(a, b);
}

}  // namespace bench
