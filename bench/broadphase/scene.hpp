// Worlds of boxes for the broadphase benchmark: how they lie, how they move, what is asked of them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace bench {

/// In float, whatever the contestant's scalar; in 2D, z is 0.
struct box {
    float lower[3], upper[3];
};
struct segment {
    float from[3], way[3];
};
/// One frame: who moves, to which box, by how much.
struct moves {
    std::vector<std::uint32_t> ids;
    std::vector<box> boxes;
    std::vector<std::array<float, 3>> ways;
};

class dice {
public:
    explicit dice(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return z ^ z >> 31;
    }
    float number(float low, float high) { return low + (high - low) * static_cast<float>(next() >> 40) * 0x1p-24f; }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((next() >> 32) * n >> 32); }

private:
    std::uint64_t state_;
};

enum class layout { uniform, mixed, corridor };
inline const char* name_of(layout kind) {
    return kind == layout::uniform ? "uniform" : kind == layout::mixed ? "mixed" : "corridor";
}

/// Uniform: half extents of 0.25 to 0.5 m, so dense that a box with margins of 5 cm meets about 2 others. Mixed: 90 %
/// of the half extents are 4 to 10 cm, 0.5 % 2 to 6 m, the rest between, in 64 clusters on one proxy a square metre;
/// in 3D, 4 m high. Corridor: boxes as in the uniform world, and as dense, in a strip 8 m wide and high.
struct scene {
    layout kind;
    int dimension;
    float side;
    std::vector<box> boxes;

    scene(layout as, int D, std::uint32_t n) : kind(as), dimension(D) {
        const auto d = static_cast<float>(D), count = static_cast<float>(n);
        side = kind == layout::mixed ? std::sqrt(count) : std::pow(count * std::pow(1.7f, d) / 2, 1 / d);
        std::array<std::array<float, 3>, 64> clusters;
        for (auto& c : clusters)
            for (float& x : c) x = chance_.number(0, side);
        for (std::uint32_t i = 0; i < n; ++i) {
            order_.push_back(i);
            boxes.push_back(kind == layout::mixed ? mixed(clusters[chance_.below(64)]) : uniform());
        }
    }
    /// Moves a part of all, chosen anew, by up to 5 cm along each axis.
    void step(double part, moves& m) {
        const auto n = static_cast<std::uint32_t>(boxes.size());
        const auto count = static_cast<std::uint32_t>(std::ceil(part * n));
        for (std::uint32_t i = 0; i < count && count < n; ++i) std::swap(order_[i], order_[i + chance_.below(n - i)]);
        m.ids.assign(order_.begin(), order_.begin() + count);
        m.boxes.clear();
        m.ways.clear();
        for (const std::uint32_t id : m.ids) {
            std::array<float, 3> way{};
            for (int i = 0; i < dimension; ++i) {
                way[i] = chance_.number(-0.05f, 0.05f);
                boxes[id].lower[i] += way[i];
                boxes[id].upper[i] += way[i];
            }
            m.boxes.push_back(boxes[id]);
            m.ways.push_back(way);
        }
    }
    float anywhere(dice& chance, int axis) const { return chance.number(0, extent(axis)); }
    /// How far the world reaches along an axis.
    float extent(int axis) const {
        if (kind == layout::mixed) return dimension == 3 && axis == 1 ? 4 : side;
        if (kind == layout::uniform) return side;
        const float wide = 8;
        return axis > 0 ? wide : wide * std::pow(side / wide, static_cast<float>(dimension));
    }

private:
    box uniform() {
        box b{};
        for (int i = 0; i < dimension; ++i) {
            const float half = chance_.number(0.25f, 0.5f), at = anywhere(chance_, i);
            b.lower[i] = at - half;
            b.upper[i] = at + half;
        }
        return b;
    }
    box mixed(const std::array<float, 3>& cluster) {
        box b{};
        const float sort = chance_.number(0, 1), spread = side / 16;
        for (int i = 0; i < dimension; ++i) {
            const float half = sort < 0.9f     ? chance_.number(0.04f, 0.1f)
                               : sort < 0.995f ? chance_.number(0.1f, 2)
                                               : chance_.number(2, 6);
            float at = cluster[i];
            for (int k = 0; k < 3; ++k) at += chance_.number(-spread, spread);
            if (dimension == 3 && i == 1) at = anywhere(chance_, 1);
            b.lower[i] = at - half;
            b.upper[i] = at + half;
        }
        return b;
    }

    dice chance_{1};
    std::vector<std::uint32_t> order_;
};

struct questions {
    std::vector<segment> rays;
    std::vector<box> regions;

    questions(const scene& s, std::uint32_t n) {
        dice chance(2);
        for (std::uint32_t i = 0; i < n; ++i) {
            segment ray{};
            box region{};
            float square = 0;
            do {
                square = 0;
                for (int k = 0; k < s.dimension; ++k) {
                    ray.way[k] = chance.number(-1, 1);
                    square += ray.way[k] * ray.way[k];
                }
            } while (square > 1 || square < 0.01f);
            for (int k = 0; k < s.dimension; ++k) {
                ray.from[k] = s.anywhere(chance, k);
                ray.way[k] *= 50 / std::sqrt(square);
                const float at = s.anywhere(chance, k), half = chance.number(1, 2);
                region.lower[k] = at - half;
                region.upper[k] = at + half;
            }
            rays.push_back(ray);
            regions.push_back(region);
        }
    }
};

template <int D>
bool overlap(const box& a, const box& b) {
    for (int i = 0; i < D; ++i)
        if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
    return true;
}
/// Shortens a ray, given as a fraction of its way, to where it enters a box.
template <int D>
void shorten(float& fraction, const segment& ray, const box& b) {
    float near = 0, far = fraction;
    for (int i = 0; i < D; ++i) {
        const float inverse = 1 / ray.way[i];
        float in = (b.lower[i] - ray.from[i]) * inverse, out = (b.upper[i] - ray.from[i]) * inverse;
        if (in > out) std::swap(in, out);
        if (in > near) near = in;
        if (out < far) far = out;
    }
    if (near <= far) fraction = near;
}

inline std::size_t slow_pairs(const scene& s) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < s.boxes.size(); ++i)
        for (std::size_t k = i + 1; k < s.boxes.size(); ++k) count += overlap<3>(s.boxes[i], s.boxes[k]);
    return count;
}

/// What is compared.
class broadphase {
public:
    virtual ~broadphase() = default;
    virtual void build(const scene& s) = 0;
    /// Without moves: the first search for pairs.
    virtual void frame(const moves&) {}
    /// The sum of the fractions up to where rays meet the first box without margins; how many such boxes regions meet.
    virtual double cast(const std::vector<segment>& rays, const box* tight) = 0;
    virtual std::size_t search(const std::vector<box>&, const box*) { return 0; }
    /// How many pairs there are now.
    [[nodiscard]] virtual std::size_t pairs() const { return 0; }
    [[nodiscard]] virtual bool knows_pairs() const { return true; }
    /// False for what is built for queries only, anew each time.
    [[nodiscard]] virtual bool moving() const { return true; }
    /// Switches margins off, before build(), where that can be.
    virtual bool without_margins() { return false; }
};

struct contestant {
    std::string name, scalar;
    /// How many proxies it can bear.
    std::uint32_t most;
    std::unique_ptr<broadphase> (*make)();
};
template <class T>
std::unique_ptr<broadphase> make() {
    return std::make_unique<T>();
}

}  // namespace bench
