// Laws of convex hulls: what encloses points, whatever their places; its faces, integrals, bounds and support points.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "reals.hpp"

template struct physics::hull<cell::scalar, cell::dimension>;
template class physics::hull_geometry<cell::scalar, cell::dimension>;

namespace {
namespace hull_laws {

using hull = physics::hull<S, D>;
using geometry = physics::hull_geometry<S, D>;
using points = std::vector<vec>;
using mass_properties = physics::mass_properties<double, 3>;

static_assert(physics::solid_shape_for<hull, S, D>);
static_assert(std::is_trivially_copyable_v<hull>);

inline geometry build(const points& p) { return geometry::build(p.data(), static_cast<std::uint32_t>(p.size())); }
inline points rounded(const std::vector<reals>& exact) {
    points p;
    for (const reals q : exact) p.push_back(from_reals(q));
    return p;
}
inline reals at(const physics::vec<double, 2>& v) { return {v.x, v.y, 0}; }
inline reals at(const physics::vec<double, 3>& v) { return {v.x, v.y, v.z}; }
inline reals corner(const geometry& g, std::uint32_t i) { return at(g.data()->exact_vertex(i)); }
inline std::vector<int> face_sizes(const geometry& g) {
    std::vector<int> sizes;
    for (std::uint32_t f = 0; f < g.face_count(); ++f) sizes.push_back(static_cast<int>(g.face_size(f)));
    std::sort(sizes.begin(), sizes.end());
    return sizes;
}

/// Checks all that a hull promises of itself, and that it encloses the points it was made of; REQUIREs are too slow
/// for each, so it says what is wrong. slack: how much more than a tolerance is allowed.
inline std::string fault(const geometry& g, const points& input, double slack = 1) {
    const auto& h = *g.data();
    const double tolerance = h.tolerance, rounding = 64 * 0x1p-53 * (h.reach + tolerance);
    std::set<std::vector<double>> given;
    for (const vec p : input) given.insert({to_reals(p).x + 0.0, to_reals(p).y + 0.0, to_reals(p).z + 0.0});
    reals low = corner(g, 0), high = low;
    for (std::uint32_t i = 0; i < h.vertex_count; ++i) {
        const reals p = corner(g, i);
        if (!given.count({p.x, p.y, p.z})) return "a vertex is none of the points";
        if (!(g.vertex(i) == from_reals(p))) return "a vertex changed";
        for (int k = 0; k < D; ++k) {
            low[k] = std::fmin(low[k], p[k]);
            high[k] = std::fmax(high[k], p[k]);
            if (static_cast<double>(h.coordinate(k)[i]) != p[k]) return "lanes differ";
        }
    }
    if (at(h.lower).x != low.x || at(h.upper).x != high.x || at(h.lower).y != low.y || at(h.upper).z != high.z)
        return "bounds";
    if (h.padded_vertices() % 8 || h.padded_vertices() < h.vertex_count || h.padded_faces() % 8) return "padding";
    for (int k = 0; k < D; ++k) {
        if (reinterpret_cast<std::uintptr_t>(h.coordinate(0)) % 32 ||
            reinterpret_cast<std::uintptr_t>(h.face_normal(0)) % 32)
            return "alignment";
        for (std::uint32_t i = h.vertex_count; i < h.padded_vertices(); ++i)
            if (h.coordinate(k)[i] != h.coordinate(k)[h.vertex_count - 1]) return "padding is no vertex";
        for (std::uint32_t i = 0; i < h.padded_faces(); ++i) {
            const double n = h.normal(std::min(i, h.face_count - 1))[k];
            if (h.face_normal(k)[i] != static_cast<std::remove_cvref_t<decltype(*h.face_normal(k))>>(n))
                return "lanes of normals differ";
        }
    }
    // Faces: flat, convex, counter-clockwise, around everything.
    std::map<std::pair<int, int>, std::uint32_t> sides;
    double volume = 0;
    const reals base = corner(g, 0);
    for (std::uint32_t f = 0; f < h.face_count; ++f) {
        const reals n = at(h.normal(f));
        const std::uint32_t size_of_face = g.face_size(f);
        if (!(std::abs(size(n) - 1) < 1e-14)) return "a normal is no unit vector";
        if (size_of_face < D || (cell::is_2d && size_of_face != 2)) return "a face has too few corners";
        for (const vec p : input)
            if (dot(n, to_reals(p)) > h.offset(f) + slack * tolerance + rounding) return "a point is outside";
        double most = -HUGE_VAL;
        for (std::uint32_t i = 0; i < h.vertex_count; ++i) most = std::fmax(most, dot(n, corner(g, i)));
        if (!(std::abs(most - h.offset(f)) <= rounding)) return "an offset is not that of the farthest vertex";
        for (std::uint32_t k = 0; k < size_of_face; ++k) {
            const std::uint32_t from = g.face_vertex(f, k), to = g.face_vertex(f, (k + 1) % size_of_face);
            const reals a = corner(g, from), b = corner(g, to), c = corner(g, g.face_vertex(f, (k + 2) % size_of_face));
            if (h.offset(f) - dot(n, a) > 2 * slack * tolerance + rounding) return "a face is not flat";
            if (cell::is_2d) {
                if (k > 0) break;
                if (from != f || to != (f + 1) % h.vertex_count) return "face i is not the edge after vertex i";
                volume += cross(a - base, b - base).z / 2;
                continue;
            }
            if (!sides.insert({{int(from), int(to)}, f}).second) return "two faces run along an edge in one direction";
            for (std::uint32_t i = 0; i < size_of_face; ++i) {
                const reals q = corner(g, g.face_vertex(f, i));
                if (size(b - a) > tolerance && dot(cross(n, unit(b - a)), q - a) < -(2 * tolerance + rounding))
                    return "a face is not convex";
            }
            if (k + 2 < size_of_face)
                volume += dot(corner(g, g.face_vertex(f, 0)) - base, cross(b - base, c - base)) / 6;
        }
    }
    const double box = (high.x - low.x) * (high.y - low.y) * (cell::is_3d ? high.z - low.z : 1);
    if (!(volume > 0) || std::abs(volume - h.volume()) > 1e-9 * box) return "volume";
    std::set<std::pair<int, int>> links;
    for (std::uint32_t v = 0; v < h.vertex_count; ++v)
        for (std::uint32_t i = h.neighbours_begin(v); i < h.neighbours_end(v); ++i) {
            if (i > h.neighbours_begin(v) && h.neighbours()[i] <= h.neighbours()[i - 1]) return "neighbours' order";
            links.insert({int(v), int(h.neighbours()[i])});
        }
    for (const auto& [a, b] : links)
        if (!links.count({b, a}) || a == b) return "neighbours are not mutual";
    if (cell::is_2d) {
        if (links.size() != 2 * h.vertex_count || h.face_count != h.vertex_count) return "neighbours";
        for (std::uint32_t i = 0; i < h.vertex_count; ++i) {
            const reals a = corner(g, i), b = corner(g, (i + 1) % h.vertex_count);
            if (!(cross(b - a, corner(g, (i + 2) % h.vertex_count) - b).z > 0)) return "not strictly convex";
        }
        return "";
    }
    if (h.vertex_count + h.face_count != h.edge_count + 2) return "Euler's formula";
    if (links.size() != 2 * h.edge_count || sides.size() != 2 * h.edge_count) return "number of edges";
    for (std::uint32_t i = 0; i < h.edge_count; ++i) {
        const auto& e = h.edge(i);
        const int a = e.vertex[0], b = e.vertex[1];
        if (a >= b || e.face[0] == e.face[1]) return "an edge's ends or faces";
        if (!sides.count({a, b}) || sides[{a, b}] != e.face[0] || !sides.count({b, a}) || sides[{b, a}] != e.face[1])
            return "an edge's faces are not those along it";
        if (!links.count({a, b})) return "an edge makes no neighbours";
    }
    return "";
}

/// The corners of a box about the origin, and points between them: n to an edge.
inline std::vector<reals> lattice(reals half, int n) {
    std::vector<reals> p;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < (cell::is_3d ? n : 1); ++k) {
                const auto x = [&](int step, double h) { return h * (2.0 * step / (n - 1) - 1); };
                p.push_back({x(i, half.x), x(j, half.y), cell::is_3d ? x(k, half.z) : 0});
            }
    return p;
}
inline std::vector<reals> placed(std::vector<reals> p, const pose& where) {
    for (reals& q : p) q = where.apply(q);
    return p;
}
inline pose random_pose(cell::dice& dice, double far) { return to_pose(random_transform(dice, far)); }
inline std::vector<reals> on_sphere(cell::dice& dice, int n, double radius) {
    std::vector<reals> p;
    for (int i = 0; i < n; ++i) p.push_back(random_direction(dice) * radius);
    return p;
}
/// A regular n-gon, in 3D the bottom and top of a prism.
inline std::vector<reals> prism(int n, double radius, double height) {
    std::vector<reals> p;
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < (cell::is_3d ? 2 : 1); ++k) {
            const double angle = 2 * M_PI * i / n;
            p.push_back({radius * std::cos(angle), radius * std::sin(angle), k * height});
        }
    return p;
}
constexpr int corners_of_box = 1 << D;
constexpr int sides_of_box = 2 * D;

CELL_CASE("hull: random points agree with a search over all planes") {
    cell::dice dice(1);
    for (int round = 0; round < 150; ++round) {
        const std::size_t n = static_cast<std::size_t>(D + 1 + dice.below(12));
        points p;
        for (std::size_t i = 0; i < n; ++i) p.push_back(dice.vec<vec>(-2, 2));
        const geometry g = build(p);
        REQUIRE(fault(g, p) == "");
        std::set<std::vector<double>> expected, found;
        int planes = 0;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                for (std::size_t k = cell::is_3d ? j + 1 : n - 1; k < n; ++k) {
                    const reals a = to_reals(p[i]), b = to_reals(p[j]), c = to_reals(p[k]);
                    const reals normal = cell::is_3d ? cross(b - a, c - a) : reals{b.y - a.y, a.x - b.x, 0};
                    int above = 0, below = 0;
                    for (std::size_t l = 0; l < n; ++l) {
                        if (l == i || l == j || (cell::is_3d && l == k)) continue;
                        (dot(normal, to_reals(p[l]) - a) > 0 ? above : below) += 1;
                    }
                    if (above > 0 && below > 0) continue;
                    ++planes;
                    expected.insert({{a.x, a.y, a.z}, {b.x, b.y, b.z}});
                    if (cell::is_3d) expected.insert({c.x, c.y, c.z});
                }
        for (std::uint32_t i = 0; i < g.vertex_count(); ++i) {
            const reals q = corner(g, i);
            found.insert({q.x, q.y, q.z});
        }
        REQUIRE(found == expected);
        REQUIRE(static_cast<int>(g.face_count()) == planes);
    }
}

CELL_CASE("hull: a box has its corners and sides, however many points lie on these, turned and rounded") {
    cell::dice dice(2);
    for (const int n : {2, 3, 5, 9})
        for (int round = 0; round < 12; ++round) {
            CAPTURE(n);
            CAPTURE(round);
            const reals half{dice.number(0.5, 1), dice.number(0.5, 2), dice.number(0.5, 3)};
            pose where = random_pose(dice, round % 3 ? 2 : 0);
            if (round < 2) where = {};
            points p = rounded(placed(lattice(round ? half : reals{1, 1, 1}, n), where));
            const points once = p;
            for (int k = round % 4 ? 0 : 3; k > 0; --k) p.insert(p.end(), once.begin(), once.end());
            const geometry g = build(p);
            REQUIRE(fault(g, p) == "");
            REQUIRE(g.vertex_count() == corners_of_box);
            REQUIRE(face_sizes(g) == std::vector<int>(sides_of_box, cell::is_3d ? 4 : 2));
            const double volume = round ? half.x * half.y * (cell::is_3d ? half.z * 8 : 4) : corners_of_box;
            REQUIRE(std::abs(g.volume() - volume) <= 64 * epsilon * (1 + volume));
        }
}

CELL_CASE("hull: known solids have their faces and volumes, at every size and place") {
    cell::dice dice(3);
    const double golden = (1 + std::sqrt(5.0)) / 2;
    struct solid {
        std::vector<reals> p;
        std::size_t vertices;
        std::vector<int> faces;
        double volume;
    };
    std::vector<solid> solids;
    if constexpr (cell::is_2d) {
        for (const int n : {3, 5, 32, 100})
            solids.push_back(
                {prism(n, 1, 0), std::size_t(n), std::vector<int>(std::size_t(n), 2), n * std::sin(2 * M_PI / n) / 2});
    } else {
        std::vector<reals> octahedron, icosahedron, dodecahedron = lattice({1, 1, 1}, 2);
        for (int k = 0; k < 3; ++k)
            for (const double u : {-1.0, 1.0}) {
                reals q;
                q[k] = u;
                octahedron.push_back(q);
                for (const double w : {-1.0, 1.0}) {
                    q = {};
                    q[k] = u;
                    q[(k + 1) % 3] = w * golden;
                    icosahedron.push_back(q);
                    q = {};
                    q[k] = u / golden;
                    q[(k + 1) % 3] = w * golden;
                    dodecahedron.push_back(q);
                }
            }
        const auto n_times = [](int n, int size) { return std::vector<int>(std::size_t(n), size); };
        solids.push_back({{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, 4, n_times(4, 3), 8.0 / 3});
        solids.push_back({octahedron, 6, n_times(8, 3), 4.0 / 3});
        solids.push_back({icosahedron, 12, n_times(20, 3), 20 * golden * golden / 3});
        solids.push_back({dodecahedron, 20, n_times(12, 5), (15 + 7 * std::sqrt(5.0)) / 4 * std::pow(2 / golden, 3)});
        for (const int n : {3, 6, 32, 100, 257}) {
            std::vector<int> faces = n_times(n, 4);
            faces.insert(faces.end(), {n, n});
            std::sort(faces.begin(), faces.end());
            solids.push_back({prism(n, 1, 0.7), std::size_t(2 * n), faces, 0.7 * n * std::sin(2 * M_PI / n) / 2});
        }
    }
    for (const solid& s : solids)
        for (const double scale : {1.0, 1e-3, 1e3})
            for (int round = 0; round < 6; ++round) {
                CAPTURE(s.vertices);
                CAPTURE(scale);
                CAPTURE(round);
                pose where = random_pose(dice, 1);
                // A long way off, too, but that small features sink into the spacing of numbers there.
                const double away = round == 5 && scale == 1 && s.vertices < 50 ? 300 : scale;
                where.origin = where.origin * away;
                std::vector<reals> p = s.p;
                for (reals& q : p) q = q * scale;
                const points given = rounded(placed(p, where));
                const geometry g = build(given);
                REQUIRE(fault(g, given) == "");
                REQUIRE(g.vertex_count() == s.vertices);
                REQUIRE(face_sizes(g) == s.faces);
                const double expected = s.volume * std::pow(scale, D), reach = 4 * (scale + away);
                const double spacing = epsilon * (cell::is_fixed ? 1 : reach);
                REQUIRE(std::abs(g.volume() - expected) <= 64 * spacing * std::pow(scale, D - 1) + 1e-12 * expected);
            }
}

CELL_CASE("hull: it depends on the set of points only") {
    cell::dice dice(4);
    for (int round = 0; round < 20; ++round) {
        points p = rounded(on_sphere(dice, 60, 1));
        if (round % 2) p = rounded(placed(lattice({1, 2, 1}, 4), random_pose(dice, 1)));
        const geometry g = build(p);
        for (int again = 0; again < 5; ++again) {
            for (std::size_t i = p.size() - 1; i > 0; --i)
                std::swap(p[i], p[static_cast<std::size_t>(dice.below(static_cast<int>(i)))]);
            p.push_back(p[0]);
            const geometry other = build(p);
            REQUIRE(other.vertex_count() == g.vertex_count());
            REQUIRE(other.face_count() == g.face_count());
            REQUIRE(other.data()->digest == g.data()->digest);
            for (std::uint32_t i = 0; i < g.vertex_count(); ++i) REQUIRE(g.vertex(i) == other.vertex(i));
            for (std::uint32_t f = 0; f < g.face_count(); ++f) {
                REQUIRE(g.data()->normal(f) == other.data()->normal(f));
                REQUIRE(g.face_size(f) == other.face_size(f));
                for (std::uint32_t k = 0; k < g.face_size(f); ++k)
                    REQUIRE(g.face_vertex(f, k) == other.face_vertex(f, k));
            }
        }
        p[0] = p[0] + vec::filled(S(9));
        REQUIRE(build(p).data()->digest != g.data()->digest);
    }
}

CELL_CASE("hull: points on a sphere are all vertices, and on a coarse grid all is well, too") {
    cell::dice dice(5);
    for (const int n : {10, 100, 2000}) {
        const points p = rounded(on_sphere(dice, n, 3));
        const geometry g = build(p);
        CHECK(fault(g, p) == "");
        // On a circle, many of so many points are near the line between their neighbours.
        if (cell::is_3d || n <= 10) CHECK(g.vertex_count() == n);
        for (const double cells : {4.0, 16.0, 100.0}) {
            points q;
            for (const vec v : p) {
                reals r = to_reals(v);
                for (int k = 0; k < D; ++k) r[k] = std::floor(r[k] * cells) / cells;
                q.push_back(from_reals(r));
            }
            CAPTURE(cells);
            const geometry coarse = build(q);
            CHECK(fault(coarse, q) == "");
        }
    }
}

CELL_CASE("hull: noise of any size on flat faces, edges and corners") {
    cell::dice dice(6);
    for (int digits = 4; digits <= 17; ++digits)
        for (int round = 0; round < 6; ++round) {
            CAPTURE(digits);
            CAPTURE(round);
            const double noise = std::pow(10.0, -digits);
            const pose where = round % 2 ? random_pose(dice, 1) : pose{};
            std::vector<reals> p = placed(round < 4 ? lattice({1, 1, 0.5}, 5) : prism(40, 1, 0.5), where);
            // Points at random within one side, and on one edge.
            for (int i = 0; i < 60; ++i) {
                p.push_back(where.apply({dice.number(-0.5, 0.5), dice.number(-0.5, 0.5), cell::is_3d ? 0.5 : 0}));
                if (round < 4) p.push_back(where.apply({dice.number(-1, 1), 1, cell::is_3d ? 0.5 : 0}));
            }
            for (reals& q : p)
                for (int k = 0; k < D; ++k) q[k] += dice.number(-noise, noise);
            const points given = rounded(p);
            const geometry g = build(given);
            REQUIRE(fault(g, given, 8) == "");
            // What is below the spacing of numbers is flat again.
            if (noise <= 0.5 * epsilon && round < 4) CHECK(g.vertex_count() == corners_of_box);
            if (noise <= 0.5 * epsilon && round < 4) CHECK(g.face_count() == sides_of_box);
        }
}

CELL_CASE("hull: heaps of points that are nearly flat, nearly alike, nearly in line") {
    cell::dice dice(12);
    for (int round = 0; round < 360; ++round) {
        CAPTURE(round);
        const int kind = round % 6, n = 5 + dice.below(120);
        const double noise = std::pow(10.0, -dice.number(3, 18)), bend = std::pow(10.0, dice.number(0, 8));
        std::vector<reals> p;
        const auto add = [&](double x, double y, double z) { p.push_back({x, y, cell::is_3d ? z : 0}); };
        if (kind == 0)  // clouds about the corners of a box
            for (const reals c : lattice({1, 1, 1}, 2))
                for (int i = 0; i <= n / 6; ++i) p.push_back(c + random_direction(dice) * noise);
        for (int i = 0; i < n && kind == 1; ++i)  // few places
            add(dice.below(3), dice.below(3), dice.below(3));
        for (int i = 0; i < n && kind == 2; ++i)  // a cone, with points along its lines
            for (const double h : {0.0, 0.25, 0.5, 1.0})
                add((1 - h) * std::cos(2 * M_PI * i / n), (1 - h) * std::sin(2 * M_PI * i / n), h);
        for (int i = 0; i < n && kind == 3; ++i)  // two planes a millimetre apart
            add(dice.number(-1, 1), dice.number(-1, 1), dice.below(2) * 1e-3);
        for (int i = 0; i < n && kind == 4; ++i) {  // a dome, on a spike
            const double x = dice.number(-1, 1), y = cell::is_3d ? dice.number(-1, 1) : 0, z = -(x * x + y * y) / bend;
            add(x, cell::is_3d ? y : z, z);
        }
        if (kind == 4) add(0.5, -0.5, -1);
        for (int i = 0; i < n && kind == 5; ++i) {  // points on a few planes, on their edges, and inside
            reals q{dice.number(-1, 1), dice.number(-1, 1), cell::is_3d ? dice.number(-1, 1) : 0};
            q[dice.below(D)] = dice.below(2);
            if (i % 3 == 0) q[dice.below(D)] = dice.below(2);
            p.push_back(q);
        }
        for (reals& q : p)
            for (int k = 0; k < D && round % 4 > 1; ++k) q[k] += dice.number(-noise, noise);
        for (reals& q : p) q = q * std::pow(10.0, round % 5 - 2);
        const points given = rounded(placed(p, round % 2 ? random_pose(dice, 1) : pose{}));
        const geometry g = build(given);
        REQUIRE(fault(g, given, 8) == "");
    }
}

CELL_CASE("hull: as many vertices as have numbers, and no more") {
    // On a circle in floats, most of so many points are in line with their neighbours; in 3D it takes a second.
    if (cell::is_3d || epsilon > 1e-12) return;
    for (const int n : {65535, 65536}) {
        points p;
        for (int i = 0; i < n; ++i)
            p.push_back(from_reals({100 * std::cos(2 * M_PI * i / n), 100 * std::sin(2 * M_PI * i / n), 0}));
        try {
            const geometry g = build(p);
            CHECK(n == 65535);
            CHECK(g.vertex_count() == 65535);
            CHECK(std::abs(g.volume() / (M_PI * 1e4) - 1) < 1e-8);
            CHECK(g.face_vertex(65534, 1) == 0);
        } catch (const physics::error& e) {
            CHECK(n == 65536);
            CHECK(std::string(e.what()) ==
                  "physics: hull_geometry::build: number of vertices is 65536; it must be at most 65535");
        }
    }
}

CELL_CASE("hull: of as many vertices as wanted") {
    cell::dice dice(13);
    for (const int n : {50, 400})
        for (const std::uint32_t most : {D + 1u, 8u, 32u, 2000u}) {
            const points p = rounded(on_sphere(dice, n, 2));
            const geometry g = geometry::build(p.data(), static_cast<std::uint32_t>(n), {.max_vertices = most});
            REQUIRE(g.vertex_count() <= most);
            if (cell::is_3d || n == 50) REQUIRE(g.vertex_count() == std::min(most, static_cast<std::uint32_t>(n)));
            points kept;
            for (std::uint32_t i = 0; i < g.vertex_count(); ++i) kept.push_back(g.vertex(i));
            REQUIRE(fault(g, kept) == "");
            double outside = 0;
            for (const vec v : p)
                for (std::uint32_t f = 0; f < g.face_count(); ++f)
                    outside = std::fmax(outside, dot(at(g.data()->normal(f)), to_reals(v)) - g.data()->offset(f));
            REQUIRE(outside <= g.shortfall() + 2 * g.data()->tolerance);
            if (most > 400) REQUIRE(g.shortfall() == 0);
            if (most == 32) REQUIRE(g.shortfall() < (cell::is_2d ? 0.05 : 0.5));
        }
}

CELL_CASE("hull: flat discs and needles") {
    cell::dice dice(7);
    for (const double thin : {1e-2, 1e-3, 1e-4, 2e-5})
        for (int round = 0; round < 6; ++round) {
            CAPTURE(thin);
            CAPTURE(round);
            const pose where = round % 2 ? random_pose(dice, 0) : pose{};
            std::vector<reals> p = prism(round < 2 ? 4 : 24, 1, thin);
            if (round >= 4) {
                p = lattice({thin, thin, 1}, 2);
                if (cell::is_2d) p = lattice({thin, 1, 0}, 2);
            } else if (cell::is_2d) {
                for (reals& q : p) q.y *= thin;
            }
            const points given = rounded(placed(p, where));
            const geometry g = build(given);
            REQUIRE(fault(g, given) == "");
            if (cell::is_2d && round >= 2 && round < 4) continue;
            REQUIRE(g.vertex_count() == p.size());
            REQUIRE(g.face_count() == (cell::is_2d ? p.size() : p.size() / 2 + 2));
        }
}

/// Zeroth, first and second moments of a hull rounded by r, about the origin.
struct sums {
    double volume;
    reals first;
    double second[6];
};
inline mass_properties mass_at(const geometry& g, double r) {
    return g.data()->moments.mass(physics::detail::in_space(g.data()->centroid), r, 1);
}
inline sums sums_of(const geometry& g, double r) {
    const mass_properties m = mass_at(g, r);
    const auto& i = m.inertia;
    const reals c = at(m.center);
    const double half = (i.xx + i.yy + i.zz) / 2;
    return {m.mass,
            c * m.mass,
            {half - i.xx + m.mass * c.x * c.x, half - i.yy + m.mass * c.y * c.y, half - i.zz + m.mass * c.z * c.z,
             -i.xy + m.mass * c.x * c.y, -i.xz + m.mass * c.x * c.z, -i.yz + m.mass * c.y * c.z}};
}

CELL_CASE("hull: the mass of a rounded box is an integral over slices") {
    cell::dice dice(8);
    for (int round = 0; round < 30; ++round) {
        const reals half{dice.number(0.2, 2), dice.number(0.2, 2), cell::is_3d ? dice.number(0.2, 2) : 0};
        const double r = round % 3 ? dice.number(0.01, 2) : 0;
        const pose where = random_pose(dice, 3);
        const geometry g = build(rounded(placed(lattice(half, 2), where)));
        // The integral of x^2, and the volume, by slices across x: their cross section is a rounded rectangle.
        double volume = 0;
        reals square;
        for (int k = 0; k < D; ++k) {
            const double a = half[k], b = half[(k + 1) % D], c = cell::is_3d ? half[(k + 2) % D] : 0;
            const auto section = [&](double q) {
                return cell::is_3d ? 4 * b * c + 4 * q * (b + c) + M_PI * q * q : 2 * (b + q);
            };
            square[k] = 2 * a * a * a / 3 * section(r);
            volume = 2 * a * section(r);
            const int n = 256;
            for (int i = 0; i <= n; ++i) {
                const double angle = M_PI / 2 * i / n, x = a + r * std::sin(angle), q = r * std::cos(angle);
                const double part = 2 * section(q) * q * (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * (M_PI / 2) / n / 3;
                volume += part;
                square[k] += part * x * x;
            }
        }
        const mass_properties m = mass_at(g, r);
        const double allowed = 64 * (epsilon + 1e-11);
        REQUIRE(std::abs(m.mass - volume) <= allowed * (1 + volume));
        REQUIRE(size(at(m.center) - where.origin) <= allowed);
        // The inertia about each of the box's axes.
        for (int k = cell::is_2d ? 2 : 0; k < 3; ++k) {
            const reals e = where.axis[k], i = {m.inertia.xx * e.x + m.inertia.xy * e.y + m.inertia.xz * e.z,
                                                m.inertia.xy * e.x + m.inertia.yy * e.y + m.inertia.yz * e.z,
                                                m.inertia.xz * e.x + m.inertia.yz * e.y + m.inertia.zz * e.z};
            const double expected = square[(k + 1) % 3] + square[(k + 2) % 3];
            REQUIRE(size(i - e * expected) <= 4 * allowed * (1 + expected));
        }
        // In the scalar, with a density.
        const double density = dice.number(0.5, 4);
        const auto in_scalar = mass_of(g.shape(S(r)), S(density));
        REQUIRE(std::abs(cell::number(in_scalar.mass) - m.mass * density) <= allowed * (1 + m.mass * density));
        REQUIRE(size(to_reals(in_scalar.center) - at(m.center)) <= allowed);
        const auto in_double = mass_of(g.shape(S(r)).template as<double>(), density);
        REQUIRE(std::abs(in_double.mass - m.mass * density) <= allowed * (1 + m.mass * density));
    }
}

/// The part of a hull between two planes across x.
inline points slab(const geometry& g, double from, double to) {
    points p;
    for (std::uint32_t i = 0; i < g.vertex_count(); ++i) {
        const reals a = corner(g, i);
        if (a.x >= from && a.x <= to) p.push_back(from_reals(a));
        for (std::uint32_t j = 0; j < i; ++j)
            for (const double x : {from, to}) {
                const reals b = corner(g, j);
                if ((a.x < x) == (b.x < x)) continue;
                reals q = a + (b - a) * ((x - a.x) / (b.x - a.x));
                q.x = x;
                p.push_back(from_reals(q));
            }
    }
    return p;
}

CELL_CASE("hull: two rounded parts that overlap have the integrals of the whole and of the overlap") {
    cell::dice dice(9);
    for (int round = 0; round < 40; ++round) {
        points p;
        for (int i = 0; i < D + 1 + round % 20; ++i) p.push_back(dice.vec<vec>(-2, 2));
        const geometry whole = build(p);
        const double low = at(whole.data()->lower).x, high = at(whole.data()->upper).x;
        const double a = cell::number(S(low + (high - low) * 0.4)), b = cell::number(S(low + (high - low) * 0.6));
        const geometry left = build(slab(whole, low, b)), right = build(slab(whole, a, high));
        const geometry middle = build(slab(whole, a, b));
        for (const double r : {0.0, 0.1, 1.0, 4.0}) {
            CAPTURE(r);
            const sums one = sums_of(whole, r), both = sums_of(middle, r), x = sums_of(left, r), y = sums_of(right, r);
            const double allowed = 64 * epsilon + 1e-11, wide = std::pow(4 + r, 3), wider = wide * (4 + r) * (4 + r);
            REQUIRE(std::abs(one.volume + both.volume - x.volume - y.volume) <= allowed * wide);
            REQUIRE(size(one.first + both.first - x.first - y.first) <= allowed * wide * (4 + r));
            for (int k = 0; k < 6; ++k)
                REQUIRE(std::abs(one.second[k] + both.second[k] - x.second[k] - y.second[k]) <= allowed * wider);
        }
        // Far from the core it is a ball.
        const double r = 1e4, exact = cell::is_3d ? 8 * M_PI / 15 * std::pow(r, 5) : M_PI / 2 * std::pow(r, 4);
        REQUIRE(std::abs(mass_at(whole, r).inertia.zz / exact - 1) < 3e-3);
    }
}

CELL_CASE("hull: support points and bounds are those of all vertices") {
    cell::dice dice(10);
    for (const int n : {D + 1, 7, 8, 9, 40, 300})
        for (int round = 0; round < 20; ++round) {
            points p;
            for (int i = 0; i < n; ++i) p.push_back(dice.vec<vec>(-2, 2));
            const geometry g = build(round % 2 ? p : rounded(on_sphere(dice, n, 2)));
            const double r = round % 4 < 2 ? 0 : dice.number(0, 1);
            const hull shape = g.shape(S(r));
            REQUIRE(check(shape, "test"));
            const vec d = from_reals(random_direction(dice) * (round % 3 ? 1 : 0.01));
            double most = -HUGE_VAL;
            for (std::uint32_t i = 0; i < g.vertex_count(); ++i)
                most = std::fmax(most, dot(unit(to_reals(d)), corner(g, i)));
            REQUIRE(near(dot(unit(to_reals(d)), to_reals(support(shape, d))), most + cell::number(shape.radius), 64));
            REQUIRE(support(shape, vec{}) == g.vertex(0));

            const transform at = random_transform(dice, 8);
            const pose frame = to_pose(at);
            const auto box = bounds(shape, at);
            reals low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
            for (std::uint32_t i = 0; i < g.vertex_count(); ++i) {
                const vec moved = at * g.vertex(i);
                if (r == 0) REQUIRE(contains(grown(box, cell::tolerance(10)), {moved, moved}));
                const reals q = frame.apply(corner(g, i));
                for (int k = 0; k < D; ++k) {
                    low[k] = std::fmin(low[k], q[k] - cell::number(shape.radius));
                    high[k] = std::fmax(high[k], q[k] + cell::number(shape.radius));
                }
            }
            for (int k = 0; k < D; ++k) {
                REQUIRE(near(cell::number(box.lower[k]), low[k], 64));
                REQUIRE(near(cell::number(box.upper[k]), high[k], 64));
                REQUIRE(near(cell::number(box.upper[k]), high[k], 64));
            }
        }
    // Of alike vertices the first, of a padded row as well.
    const geometry square = build(rounded(lattice({1, 1, 1}, 2)));
    const vec first = support(square.shape(), from_reals({1, 0, 0}));
    for (std::uint32_t i = 0; i < square.vertex_count(); ++i)
        if (square.vertex(i).x == S(1)) {
            CHECK(first == square.vertex(i));
            break;
        }
}

CELL_CASE("hull: geometry lives as long as one of its owners") {
    const auto owners = [](const geometry& g) { return g.data()->owners; };
    geometry a = build(rounded(lattice({1, 1, 1}, 2)));
    CHECK(owners(a) == 1);
    {
        geometry b = a, c;
        CHECK(owners(a) == 2);
        c = b;
        CHECK(owners(a) == 3);
        b = std::move(c);
        CHECK(!c);
        CHECK(owners(a) == 2);
        const geometry& same = b;
        b = same;
        CHECK(owners(a) == 2);
    }
    CHECK(owners(a) == 1);
    const hull shape = a.shape();
    physics::detail::retain(shape.geometry);
    CHECK(owners(a) == 2);
    a = geometry{};
    CHECK(shape.geometry->owners == 1);
    CHECK(bounds(shape, transform{}).upper.x > S(0.99));
    physics::detail::release(shape.geometry);
    physics::detail::retain(nullptr);
    physics::detail::release(nullptr);
    CHECK(!a);
}

CELL_CASE("hull: a shape with another scalar is the same") {
    const geometry g = build(rounded(lattice({1, 2, 3}, 2)));
    const hull shape = g.shape(S(0.25)), back = shape.template as<double>().template as<S>();
    CHECK(back.geometry == shape.geometry);
    CHECK(back.radius == shape.radius);
    const double mass = cell::number(mass_of(shape, S(2)).mass);
    const auto in_floats = [&](const auto& original) {
        if constexpr (!std::same_as<S, archetype>) {
            const auto as_float = original.template as<float>();
            CHECK(as_float.radius == 0.25f);
            CHECK(std::abs(mass_of(as_float, 2.0f).mass - mass) < 1e-3);
        }
    };
    in_floats(shape);
    using any = physics::any_shape<S, D, physics::ball, physics::hull>;
    CHECK(bounds(any(shape), transform{}) == bounds(shape, transform{}));
}

template <class F>
std::string refusal(F&& f) {
    try {
        f();
        return "";
    } catch (const physics::error& e) {
        return e.what();
    }
}

CELL_CASE("hull: what has no volume is refused, with how much it lacks") {
    cell::dice dice(11);
    const auto says = [](const points& p) { return refusal([&] { static_cast<void>(build(p)); }); };
    const std::string few = cell::is_2d ? "a polygon needs at least 3" : "a polyhedron needs at least 4";
    CHECK(says({}) == "physics: hull_geometry::build: number of points is 0; " + few);
    CHECK(says(points(D)) == "physics: hull_geometry::build: number of points is " + std::to_string(D) + "; " + few);
    const std::string flat = "physics: hull_geometry::build: thickness of the points is 0; they must not lie ";
    CHECK(says(points(20)).rfind(flat, 0) == 0);
    CHECK(says(points(20, vec::filled(S(3)))).rfind(flat, 0) == 0);
    points line, level;
    for (int i = 0; i < 30; ++i) {
        line.push_back(from_reals({double(i), 2.0 * i, cell::is_3d ? 3.0 * i : 0}));
        level.push_back(from_reals({double(dice.below(10)), cell::is_3d ? double(dice.below(10)) : 2, 2}));
    }
    CHECK(says(line).rfind(flat, 0) == 0);
    CHECK(says(level).rfind(flat, 0) == 0);
    // Within rounding of a plane; and not.
    for (int round = 0; round < 40; ++round) {
        const pose where = random_pose(dice, round % 2 ? 1 : 0);
        std::vector<reals> p;
        for (int i = 0; i < 40; ++i)
            p.push_back(where.apply({dice.number(-1, 1), cell::is_3d ? dice.number(-1, 1) : 0, 0}));
        CHECK(says(rounded(p)).rfind("physics: hull_geometry::build: thickness of the points is ", 0) == 0);
        p.push_back(p[0] + where.axis[cell::is_3d ? 2 : 1] * 1e-3);
        CHECK(says(rounded(p)) == "");
    }
    CHECK(refusal([&] {
              const points p = rounded(lattice({1, 1, 1}, 2));
              static_cast<void>(geometry::build(p.data(), corners_of_box, {.max_vertices = 2}));
          }) == "physics: hull_geometry::build: max_vertices is 2; it must be at least " + std::to_string(D + 1) +
                    ", or 0 for all");
    if (cell::is_fixed) return;
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        points p = rounded(lattice({1, 1, 1}, 2));
        p[3][1] = S(bad);
        char expected[100];
        std::snprintf(expected, sizeof expected,
                      "physics: hull_geometry::build: points[3].y is %.9g; it must be finite", bad);
        CHECK(says(p) == expected);
    }
    points huge = rounded(lattice({1, 1, 1}, 2));
    huge[1].x = S(1e31);
    const std::string value = sizeof(S) == 4 ? "9.99999985e+30" : "1e+31";
    CHECK(says(huge) ==
          "physics: hull_geometry::build: largest coordinate is " + value + "; it must be from 1e-30 to 1e30");
}

CELL_CASE("hull: shapes without geometry or with a bad radius are refused") {
    const auto says = [](const hull& h) { return refusal([&] { check(h, "create_shape"); }); };
    CHECK(says(hull{}) ==
          "physics: create_shape: geometry is null; it must be the shape of a hull_geometry that was built");
    const geometry g = build(rounded(lattice({1, 1, 1}, 2)));
    CHECK(says(g.shape()) == "");
    CHECK(says(g.shape(S(-0.5))) == "physics: create_shape: radius is -0.5; it must not be negative");
    CHECK(geometry::build({vec::filled(S(0)), from_reals({1, 0, 0}), from_reals({0, 1, 0}), from_reals({0, 0, 1})})
              .vertex_count() == D + 1);
    const vec array[] = {vec::filled(S(0)), from_reals({1, 0, 0}), from_reals({0, 1, 0}), from_reals({0, 0, 1})};
    CHECK(geometry::build(array).vertex_count() == D + 1);
}

}  // namespace hull_laws
}  // namespace
