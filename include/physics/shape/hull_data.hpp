// What a convex hull is in memory: one block of vertices, faces, edges, neighbours and integrals.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/shape/geometry.hpp"
#include "physics/shape/hull_moments.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The numbers in which a hull's vertices lie in lanes: float for float, double for all others. Fixed point converts
/// to double exactly as long as its coordinates have 53 bits; those of Q32.32 to 2^20 m.
template <class S>
using hull_real = std::conditional_t<std::is_same_v<S, float>, float, double>;

/// An edge from vertex[0] to vertex[1]: face[0] runs along it in this direction, face[1] in the other.
struct hull_edge {
    std::uint16_t vertex[2];
    std::uint32_t face[2];
};

/// A hull as its builder gives it, in double. Faces are counter-clockwise as seen from outside.
template <int D>
struct hull_outline {
    buffer<vec<double, D>> vertices;
    /// Where each face begins in face_vertices, and where the last one ends.
    buffer<std::uint32_t> face_begin;
    buffer<std::uint16_t> face_vertices;
    /// In 3D each edge once, with vertex[0] < vertex[1], ascending; empty in 2D, where vertices take that place.
    buffer<hull_edge> edges;
    /// How far (m) points may lie outside faces that were taken for flat.
    double tolerance = 0;
    /// How far (m) points lie outside of a face since only so many vertices were wanted.
    double shortfall = 0;

    [[nodiscard]] bool empty() const { return vertices.empty(); }
    [[nodiscard]] std::uint32_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
};

/// A convex hull with coordinates in R. In 2D vertices are counter-clockwise and face i is the edge from vertex i to
/// the next; in 3D faces are polygons. Arrays of vertices and of normals are rows of R, one for each axis, padded to a
/// multiple of 8 by repeating the last and aligned to 32 bytes.
template <class R, int D>
struct hull_data : geometry_block {
    static constexpr int dimension = D;
    static constexpr std::uint32_t max_vertices = 65535;

    // What each step asks for comes first, in one cache line.
    std::uint32_t vertex_count, face_count, edge_count;
    /// The largest coordinate by magnitude, and the largest distance of a vertex from the origin (m).
    double reach, span;
    /// The distance of the centroid from the nearest face (m).
    double inradius;
    /// How far the vertices of a face may be from its plane (m), by the rounding of the numbers that were given.
    double tolerance;
    /// How far points lie outside of a face (m) since only so many vertices were wanted.
    double shortfall;
    /// A number that hulls with the same vertices share on every system.
    std::uint64_t digest;
    vec<double, D> lower, upper, centroid;
    hull_moments moments;

    /// How long rows are.
    [[nodiscard]] std::uint32_t padded_vertices() const { return padded(vertex_count); }
    [[nodiscard]] std::uint32_t padded_faces() const { return padded(face_count); }
    /// The vertices' coordinates along an axis: padded_vertices() numbers.
    [[nodiscard]] const R* coordinate(int axis) const {
        return at<R>(first_row()) + static_cast<std::uint32_t>(axis) * padded_vertices();
    }
    [[nodiscard]] vec<R, D> vertex(std::uint32_t i) const {
        vec<R, D> v;
        for (int axis = 0; axis < D; ++axis) v[axis] = coordinate(axis)[i];
        return v;
    }
    [[nodiscard]] vec<double, D> exact_vertex(std::uint32_t i) const {
        vec<double, D> v;
        for (int axis = 0; axis < D; ++axis) v[axis] = static_cast<double>(coordinate(axis)[i]);
        return v;
    }
    /// The unit outward normal of face i; dot(normal, v) <= offset for every vertex v, up to rounding in double.
    [[nodiscard]] const vec<double, D>& normal(std::uint32_t i) const { return at<vec<double, D>>(normals_)[i]; }
    [[nodiscard]] double offset(std::uint32_t i) const { return at<double>(offsets_)[i]; }
    /// The normals' components along an axis: padded_faces() numbers.
    [[nodiscard]] const R* face_normal(int axis) const {
        return coordinate(D) + static_cast<std::uint32_t>(axis) * padded_faces();
    }
    /// The vertices of face i: face_vertices()[face_begin(i)] to before face_vertices()[face_end(i)].
    [[nodiscard]] std::uint32_t face_begin(std::uint32_t i) const { return at<std::uint32_t>(face_begin_)[i]; }
    [[nodiscard]] std::uint32_t face_end(std::uint32_t i) const { return at<std::uint32_t>(face_begin_)[i + 1]; }
    [[nodiscard]] const std::uint16_t* face_vertices() const { return at<std::uint16_t>(face_vertices_); }
    /// The vertices that share an edge with vertex v: neighbours()[neighbours_begin(v)] to before its end, ascending.
    [[nodiscard]] std::uint32_t neighbours_begin(std::uint32_t v) const {
        return at<std::uint32_t>(neighbours_begin_)[v];
    }
    [[nodiscard]] std::uint32_t neighbours_end(std::uint32_t v) const {
        return at<std::uint32_t>(neighbours_begin_)[v + 1];
    }
    [[nodiscard]] const std::uint16_t* neighbours() const { return at<std::uint16_t>(neighbours_); }
    /// Edge i of edge_count; in 2D there are none, vertices take their place.
    [[nodiscard]] const hull_edge& edge(std::uint32_t i) const { return at<hull_edge>(edges_)[i]; }

    /// In 3D the edge between two vertices, which must be there. Cost: O(log n).
    [[nodiscard]] const hull_edge& edge_between(std::uint32_t a, std::uint32_t b) const {
        const std::uint32_t key = a < b ? a << 16 | b : b << 16 | a;
        std::uint32_t low = 0, high = edge_count;
        while (high - low > 1) {
            const std::uint32_t middle = low + (high - low) / 2;
            const hull_edge& e = edge(middle);
            (key < (std::uint32_t{e.vertex[0]} << 16 | e.vertex[1]) ? high : low) = middle;
        }
        return edge(low);
    }

    /// The volume (m^3; in 2D the area, m^2).
    [[nodiscard]] double volume() const { return moments.volume[0]; }
    /// The integral of (p - centroid) (p - centroid)^T over the hull (m^5; m^4 in 2D, where z is 0).

    /// A block from an outline, with one owner: the caller.
    static const hull_data* make(const hull_outline<D>& outline);

private:
    std::size_t normals_, offsets_, face_begin_, face_vertices_, neighbours_begin_, neighbours_, edges_;

    /// Where the rows of coordinates begin, and after them those of normals.
    static constexpr std::size_t first_row() { return (sizeof(hull_data) + alignment - 1) / alignment * alignment; }
    static std::uint32_t padded(std::uint32_t n) { return (n + 7) & ~std::uint32_t{7}; }

    template <class T>
    [[nodiscard]] const T* at(std::size_t offset) const {
        return reinterpret_cast<const T*>(reinterpret_cast<const unsigned char*>(this) + offset);
    }
    template <class T>
    [[nodiscard]] T* at(std::size_t offset) {
        return reinterpret_cast<T*>(reinterpret_cast<unsigned char*>(this) + offset);
    }
    void link(const hull_outline<D>& outline);
    void set_normal(std::uint32_t f, const vec<double, D>& n);
    void lift_offsets();
    void lift_offset(std::uint32_t f, buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo, std::uint32_t stamp);
    PHYSICS_HPP_COLD void refine_normal(buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo);
};

template <class R, int D>
const hull_data<R, D>* hull_data<R, D>::make(const hull_outline<D>& outline) {
    const std::uint32_t vertices = outline.vertices.size(), faces = outline.face_count();
    const std::uint32_t corners = outline.face_vertices.size();
    std::size_t end = first_row() + std::size_t{D} * (padded(vertices) + padded(faces)) * sizeof(R);
    const auto place = [&](std::size_t count, std::size_t bytes) {
        const std::size_t begin = (end + 31) & ~std::size_t{31};
        end = begin + count * bytes;
        return begin;
    };
    const std::size_t normals = place(faces, sizeof(vec<double, D>)), offsets = place(faces, sizeof(double));
    const std::size_t begins = place(std::size_t{faces} + 1, sizeof(std::uint32_t));
    const std::size_t neighbour_begins = place(std::size_t{vertices} + 1, sizeof(std::uint32_t));
    const std::size_t face_corners = place(corners, sizeof(std::uint16_t));
    // In 2D a vertex has two neighbours and a face two corners, in 3D a face's corner gives its vertex a neighbour.
    const std::size_t neighbours = place(corners, sizeof(std::uint16_t));
    const std::size_t edges = place(outline.edges.size(), sizeof(hull_edge));

    hull_data* h = new_geometry<hull_data>(end);
    h->vertex_count = vertices;
    h->face_count = faces;
    h->edge_count = outline.edges.size();
    h->tolerance = outline.tolerance;
    h->shortfall = outline.shortfall;
    h->normals_ = normals;
    h->offsets_ = offsets;
    h->face_begin_ = begins;
    h->neighbours_begin_ = neighbour_begins;
    h->face_vertices_ = face_corners;
    h->neighbours_ = neighbours;
    h->edges_ = edges;

    h->lower = h->upper = outline.vertices[0];
    h->reach = 0;
    h->digest = vertices;
    const std::uint32_t row = h->padded_vertices();
    for (std::uint32_t i = 0; i < row; ++i)
        for (int axis = 0; axis < D; ++axis) {
            const double x = outline.vertices[i < vertices ? i : vertices - 1][axis];
            h->template at<R>(first_row())[static_cast<std::uint32_t>(axis) * row + i] = static_cast<R>(x);
            h->lower[axis] = min(h->lower[axis], x);
            h->upper[axis] = max(h->upper[axis], x);
            h->reach = max(h->reach, abs(x));
            if (i < vertices) h->digest = (h->digest ^ scalar_traits<double>::bits(x)) * 0xff51afd7ed558ccdu;
            h->digest ^= h->digest >> 32;
        }
    h->span = 0;
    for (std::uint32_t i = 0; i < vertices; ++i) h->span = max(h->span, length(outline.vertices[i]));
    for (std::uint32_t i = 0; i <= faces; ++i) h->template at<std::uint32_t>(begins)[i] = outline.face_begin[i];
    for (std::uint32_t i = 0; i < corners; ++i)
        h->template at<std::uint16_t>(face_corners)[i] = outline.face_vertices[i];
    for (std::uint32_t i = 0; i < h->edge_count; ++i) h->template at<hull_edge>(edges)[i] = outline.edges[i];
    h->link(outline);
    for (std::uint32_t f = 0; f < faces; ++f)
        h->set_normal(f, hull_normal(outline.vertices.begin(), h->face_vertices() + h->face_begin(f),
                                     h->face_end(f) - h->face_begin(f)));
    h->lift_offsets();
    h->centroid = compute_hull_moments(*h, h->moments);
    h->inradius = h->offset(0) - dot(h->normal(0), h->centroid);
    for (std::uint32_t i = 1; i < faces; ++i)
        h->inradius = min(h->inradius, h->offset(i) - dot(h->normal(i), h->centroid));
    return h;
}

/// Fills the lists of neighbours. They ascend since edges do.
template <class R, int D>
void hull_data<R, D>::link(const hull_outline<D>& outline) {
    std::uint32_t* begins = at<std::uint32_t>(neighbours_begin_);
    std::uint16_t* list = at<std::uint16_t>(neighbours_);
    if constexpr (D == 2) {
        for (std::uint32_t v = 0; v < vertex_count; ++v) {
            const std::uint32_t before = v > 0 ? v - 1 : vertex_count - 1, after = v + 1 < vertex_count ? v + 1 : 0;
            begins[v] = 2 * v;
            list[2 * v] = static_cast<std::uint16_t>(before < after ? before : after);
            list[2 * v + 1] = static_cast<std::uint16_t>(before < after ? after : before);
        }
        begins[vertex_count] = 2 * vertex_count;
    } else {
        for (const hull_edge& e : outline.edges)
            for (const std::uint16_t v : e.vertex) ++begins[v + 1];
        for (std::uint32_t v = 0; v < vertex_count; ++v) begins[v + 1] += begins[v];
        buffer<std::uint32_t> next;
        for (std::uint32_t v = 0; v < vertex_count; ++v) next.push_back(begins[v]);
        for (const hull_edge& e : outline.edges)
            for (int k = 0; k < 2; ++k) list[next[e.vertex[k]]++] = e.vertex[1 - k];
    }
}

template <class R, int D>
void hull_data<R, D>::set_normal(std::uint32_t f, const vec<double, D>& n) {
    at<vec<double, D>>(normals_)[f] = n;
    R* const components = at<R>(first_row()) + std::uint32_t{D} * padded_vertices();
    for (std::uint32_t i = f; i < (f + 1 < face_count ? f + 1 : padded_faces()); ++i)
        for (int axis = 0; axis < D; ++axis)
            components[static_cast<std::uint32_t>(axis) * padded_faces() + i] = static_cast<R>(n[axis]);
}

/// An offset that no vertex exceeds. Faces that were merged have vertices above and below their planes, and rounding
/// may put a neighbour of theirs a little higher: what lies near the plane is searched from the face's own vertices, by
/// which all of it is connected.
template <class R, int D>
void hull_data<R, D>::lift_offset(std::uint32_t f, buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo,
                                  std::uint32_t stamp) {
    const vec<double, D> n = normal(f);
    double maximum = dot(n, exact_vertex(face_vertices()[face_begin(f)]));
    todo.clear();
    const auto visit = [&](std::uint32_t v) {
        if (seen_by[v] == stamp) return;
        seen_by[v] = stamp;
        const double height = dot(n, exact_vertex(v));
        if (height < maximum - 4 * tolerance) return;
        maximum = max(maximum, height);
        todo.push_back(v);
    };
    for (std::uint32_t i = face_begin(f); i < face_end(f); ++i) visit(face_vertices()[i]);
    while (!todo.empty()) {
        const std::uint32_t v = todo.back();
        todo.pop_back();
        for (std::uint32_t i = neighbours_begin(v); i < neighbours_end(v); ++i) visit(neighbours()[i]);
    }
    at<double>(offsets_)[f] = maximum;
}
template <class R, int D>
void hull_data<R, D>::lift_offsets() {
    buffer<std::uint32_t> seen_by, todo;
    seen_by.resize(vertex_count, 0);
    for (std::uint32_t f = 0; f < face_count; ++f) lift_offset(f, seen_by, todo, f + 1);
    if constexpr (D == 3) refine_normal(seen_by, todo);
}

/// A face hardly wider than the tolerance does not say how it is tilted about its length, so that its plane may cut
/// the hull: it then takes the middle between the faces along it.
template <class R, int D>
void hull_data<R, D>::refine_normal(buffer<std::uint32_t>& seen_by, buffer<std::uint32_t>& todo) {
    buffer<std::uint32_t> cutting;
    const auto cuts = [&](std::uint32_t f) {
        double minimum = offset(f);
        for (std::uint32_t i = face_begin(f); i < face_end(f); ++i)
            minimum = min(minimum, dot(normal(f), exact_vertex(face_vertices()[i])));
        return offset(f) - minimum > 2 * tolerance;
    };
    buffer<bool> bad;
    for (std::uint32_t f = 0; f < face_count; ++f) {
        bad.push_back(cuts(f));
        if (bad[f]) cutting.push_back(f);
    }
    std::uint32_t stamp = face_count;
    for (const std::uint32_t f : cutting) {
        vec<double, D> sum, along;
        for (std::uint32_t i = face_begin(f); i < face_end(f); ++i) {
            const hull_edge& e =
                edge_between(face_vertices()[i], face_vertices()[i + 1 < face_end(f) ? i + 1 : face_begin(f)]);
            const std::uint32_t other = e.face[0] == f ? e.face[1] : e.face[0];
            const vec<double, D> edge_vector = exact_vertex(e.vertex[1]) - exact_vertex(e.vertex[0]);
            if (length(edge_vector) > length(along)) along = edge_vector;
            if (!bad[other]) sum += normal(other) * length(edge_vector);
        }
        along = normalized(along);
        const vec<double, D> n = normalized(sum - along * dot(along, sum));
        if (n == vec<double, D>{}) continue;
        set_normal(f, n);
        lift_offset(f, seen_by, todo, ++stamp);
        bad[f] = cuts(f);
    }
}

}  // namespace detail

PHYSICS_HPP_END
