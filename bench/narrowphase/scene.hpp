// Pairs of convex shapes for the narrowphase benchmark: what they are, how they lie, how they move, the true answers.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../../tests/laws/convex_oracle.hpp"

// The oracle is private to the unit that includes it, and this program is one unit.
#pragma GCC diagnostic ignored "-Wsubobject-linkage"

namespace bench {

class dice {
public:
    explicit dice(std::uint64_t seed) : state_(seed) {}
    double number(double low, double high) {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return low + (high - low) * static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
    }
    std::array<double, 3> direction(int dimension) {
        for (;;) {
            const std::array<double, 3> v{number(-1, 1), number(-1, 1), dimension == 3 ? number(-1, 1) : 0};
            const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if (square > 1 || square < 0.01) continue;
            const double s = 1 / std::sqrt(square);
            return {v[0] * s, v[1] * s, v[2] * s};
        }
    }

private:
    std::uint64_t state_;
};

/// A unit quaternion (x, y, z, w) and a position; A's pose is always the identity.
struct pose {
    std::array<double, 4> turn{0, 0, 0, 1};
    std::array<double, 3> at{};

    [[nodiscard]] oracle::frame exact() const {
        return oracle::frame::of_quaternion(turn[0], turn[1], turn[2], turn[3], {at[0], at[1], at[2]});
    }
};
inline std::array<double, 4> unit(std::array<double, 4> q) {
    const double s = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    return {q[0] * s, q[1] * s, q[2] * s, q[3] * s};
}
inline std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return {
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

/// A sphere is a point with a radius, a capsule a segment along x with one.
struct solid {
    enum class kind { sphere, capsule, box, hull };

    kind of = kind::box;
    /// Of a box and, in x, of a capsule.
    std::array<double, 3> half{};
    double radius = 0;
    std::vector<std::array<double, 3>> points;
    /// Triangles, counterclockwise from outside; of a solid in space that has corners.
    std::vector<std::array<int, 3>> faces;
    oracle::polytope exact;
};

inline solid make_solid(int dimension, const std::string& what, dice& chance) {
    solid s;
    for (int i = 0; i < dimension; ++i) s.half[i] = chance.number(0.125, 0.5);
    const auto add = [&](double x, double y, double z) {
        s.points.push_back({x * s.half[0], y * s.half[1], z * s.half[2]});
    };
    if (what == "sphere") {
        s.of = solid::kind::sphere;
        s.radius = s.half[0];
        add(0, 0, 0);
    } else if (what == "capsule") {
        s.of = solid::kind::capsule;
        s.radius = s.half[1] / 2;
        add(-1, 0, 0), add(1, 0, 0);
    } else if (what == "box") {
        for (int i = 0; i < (1 << dimension); ++i) add(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    } else {
        // On an ellipsoid or an ellipse, so that all are corners.
        s.of = solid::kind::hull;
        const int corners = std::stoi(what.substr(4));
        for (int i = 0; i < corners; ++i) {
            const double angle = 2 * M_PI * (i + chance.number(-0.3, 0.3)) / corners;
            const std::array<double, 3> v = chance.direction(3);
            dimension == 2 ? add(std::cos(angle), std::sin(angle), 0) : add(v[0], v[1], v[2]);
        }
    }
    std::vector<oracle::point> corners;
    for (const auto& p : s.points) corners.push_back({p[0], p[1], p[2]});
    s.exact = {dimension, corners, s.radius};
    if (s.of == solid::kind::hull)
        for (const auto& [i, k, m] : s.exact.faces()) {
            const auto& a = corners[i];
            const bool outwards = dot(a, cross(corners[k] - a, corners[m] - a)) > 0;
            const int first = static_cast<int>(i), second = static_cast<int>(k), third = static_cast<int>(m);
            s.faces.push_back({first, outwards ? second : third, outwards ? third : second});
        }
    else if (s.of == solid::kind::box)
        s.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return s;
}

/// Apart by 0.25 m; overlapping by 1 cm; by 60 % of what they do with one centre; boxes face to face, 1 cm deep, also
/// such that move a thousandth of what the others do.
enum class state { apart, shallow, deep, stacked, resting };
inline const char* name_of(state s) {
    constexpr const char* names[] = {"0.25 m apart", "1 cm deep", "60 % deep", "stacked", "at rest"};
    return names[static_cast<int>(s)];
}

/// Some pairs of two kinds of solids in one state, for some frames.
struct pair_set {
    static constexpr int frames = 16;

    int dimension;
    std::string first, second;
    state in;
    std::vector<solid> solids_a, solids_b;
    /// B in A, by frame, then by pair.
    std::vector<pose> poses[frames];
    /// The answers to the first frame and the one in which they are farthest from it.
    static constexpr int judged[] = {0, 4};
    std::vector<oracle::answer> answers[2];

    pair_set(int D, std::string a, std::string b, state s, int pairs) : dimension(D), first(a), second(b), in(s) {
        dice chance(static_cast<std::uint64_t>(D) * 1000 + static_cast<std::uint64_t>(s) + a.size() * 31 + b.size());
        // Finding the faces of many corners is slow, by means that are obviously right.
        const int distinct = a == "hull128" ? 16 : pairs;
        for (int i = 0; i < distinct; ++i) {
            solids_a.push_back(make_solid(D, a, chance));
            solids_b.push_back(make_solid(D, b, chance));
        }
        for (int i = 0; i < pairs; ++i) lay(i, chance);
        for (int k = 0; k < 2; ++k)
            for (int i = 0; i < pairs; ++i)
                answers[k].push_back(measure(i, poses[judged[k]][static_cast<std::size_t>(i)]));
    }
    [[nodiscard]] std::size_t pairs() const { return poses[0].size(); }
    /// Which of the solids make a pair: not always the same two.
    [[nodiscard]] std::size_t number_a(std::size_t pair) const { return pair % solids_a.size(); }
    [[nodiscard]] std::size_t number_b(std::size_t pair) const {
        return (pair + pair / solids_b.size()) % solids_b.size();
    }
    [[nodiscard]] const solid& a(std::size_t pair) const { return solids_a[number_a(pair)]; }
    [[nodiscard]] const solid& b(std::size_t pair) const { return solids_b[number_b(pair)]; }
    /// How far apart a pair is along a vector, in one of the frames that are judged.
    [[nodiscard]] double apart_along(int k, std::size_t pair, oracle::point n) const {
        const auto& moved = poses[judged[k]][pair];
        return static_cast<double>(separation_along(a(pair).exact, b(pair).exact.moved(moved.exact()), n));
    }

private:
    [[nodiscard]] oracle::answer measure(int pair, const pose& at) const {
        const auto i = static_cast<std::size_t>(pair);
        return signed_distance(a(i).exact, b(i).exact.moved(at.exact()));
    }
    void lay(int pair, dice& chance) {
        pose at;
        const auto way = chance.direction(dimension);
        const auto shift = [&](const oracle::point& n, oracle::real by) {
            for (int i = 0; i < dimension; ++i) at.at[i] += static_cast<double>(n[i] * by);
        };
        const bool on_top = in == state::stacked || in == state::resting;
        const double pace = in == state::resting ? 0.001 : 1;
        if (on_top) {
            const auto i = static_cast<std::size_t>(pair);
            const double angle = chance.number(-M_PI, M_PI);
            if (dimension == 3) at.turn = {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
            at.at = {chance.number(-0.1, 0.1), a(i).half[1] + b(i).half[1] - 0.01,
                     dimension == 3 ? chance.number(-0.1, 0.1) : 0};
        } else {
            do at.turn = {chance.number(-1, 1), chance.number(-1, 1), chance.number(-1, 1), chance.number(-1, 1)};
            while (std::abs(at.turn[2]) + std::abs(at.turn[3]) < 0.1);
            if (dimension == 2) at.turn[0] = at.turn[1] = 0;
            at.turn = unit(at.turn);
            if (in == state::deep) {
                // Along a way out the depth is concave: from one centre, where it is largest, by chords.
                const oracle::real wanted = 0.6L * measure(pair, at).distance;
                oracle::real low = 0, high = 3, at_low = wanted / 0.6L, at_high = 0;
                const auto go = [&](oracle::real to) {
                    for (int i = 0; i < dimension; ++i) at.at[i] = way[i] * static_cast<double>(to);
                    return measure(pair, at).distance;
                };
                at_high = go(high);
                for (int round = 0; round < 6; ++round) {
                    const oracle::real x = low + (high - low) * (wanted - at_low) / (at_high - at_low), at_x = go(x);
                    if (std::fabs(at_x - wanted) < -0.02L * wanted) break;
                    (at_x < wanted ? low : high) = x;
                    (at_x < wanted ? at_low : at_high) = at_x;
                }
            } else {
                for (int i = 0; i < dimension; ++i) at.at[i] = 3 * way[i];
                const oracle::answer far = measure(pair, at);
                shift(far.normal, (in == state::apart ? 0.25L : -0.01L) - far.distance);
            }
        }
        // To and fro, 1 cm and 0.01 rad a frame; where they overlap, across the normal, else they would part.
        const oracle::answer start = measure(pair, at);
        auto along = chance.direction(dimension);
        if (in != state::apart) {
            double slope = 0, square = 0;
            for (int i = 0; i < 3; ++i) slope += along[i] * static_cast<double>(start.normal[i]);
            for (int i = 0; i < 3; ++i) along[i] -= slope * static_cast<double>(start.normal[i]);
            for (int i = 0; i < 3; ++i) square += along[i] * along[i];
            for (int i = 0; i < 3; ++i) along[i] /= std::sqrt(square) + 1e-30;
        }
        // A turn about the normal changes no depth along it; in the plane there is none.
        auto about = chance.direction(3);
        if (in != state::apart)
            for (int i = 0; i < 3; ++i) about[i] = static_cast<double>(start.normal[i]);
        for (int frame = 0; frame < frames; ++frame) {
            const int step = frame <= 4 ? frame : frame <= 12 ? 8 - frame : frame - 16;
            const double half = 0.005 * pace * step;
            pose moved = at;
            for (int i = 0; i < 3; ++i) moved.at[i] += 0.01 * pace * step * along[i];
            if (dimension == 3)
                moved.turn = unit(product({half * about[0], half * about[1], half * about[2], 1}, at.turn));
            else if (!on_top) moved.turn = unit(product({0, 0, half, 1}, at.turn));
            if (dimension == 2 && in != state::apart) {
                const oracle::answer turned = measure(pair, moved);
                for (int i = 0; i < 2; ++i)
                    moved.at[i] += static_cast<double>(turned.normal[i] * (start.distance - turned.distance));
            }
            poses[frame].push_back(moved);
        }
    }
};

enum class task { distance, boolean, penetration, manifold };
inline const char* name_of(task t) {
    constexpr const char* names[] = {"distance", "boolean", "penetration", "manifold"};
    return names[static_cast<int>(t)];
}

/// What a contestant says of a pair. Boolean: distance 1 or -1. Manifold: the least separation; 1 for no contact.
struct outcome {
    double distance = NAN;
    /// From A to B; null where it is not told.
    double normal[3] = {};
};

/// Who competes. Not called for what it does not know how to do.
class solver {
public:
    virtual ~solver() = default;
    [[nodiscard]] virtual bool can(const pair_set& s, task t) const = 0;
    /// Whether it remembers anything of a pair.
    [[nodiscard]] virtual bool remembers(task) const { return false; }
    /// Builds shapes; not measured.
    virtual void load(const pair_set& s) = 0;
    /// All pairs of one frame; warm: with what was remembered of each pair.
    virtual void run(task t, int frame, bool warm, outcome* out) = 0;
};

struct contestant {
    std::string name, scalar;
    std::unique_ptr<solver> it;
};

}  // namespace bench
