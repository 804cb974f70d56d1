// What a world is told, out of a fuzzer's bytes: mostly what games say, and as often as an input asks for it nonsense.
#pragma once

#include "input.hpp"

namespace fuzz {

template <class S>
S absurd(unsigned which) {
    const S largest = physics::scalar_traits<S>::max(), smallest = physics::scalar_traits<S>::epsilon();
    if constexpr (physics::detail::is_fixed<S>) {
        const S list[] = {largest,        -largest, largest / S(2), largest / S(4), -largest / S(2), S(40000),
                          S(-1000000000), smallest, -smallest,      S(46341),       largest / S(64), S(0)};
        return list[which % std::size(list)];
    } else {
        using limits = std::numeric_limits<S>;
        const S root = std::sqrt(largest);
        const S list[] = {limits::quiet_NaN(),
                          limits::infinity(),
                          -limits::infinity(),
                          largest,
                          -largest,
                          limits::denorm_min(),
                          limits::min(),
                          root,
                          -root,
                          S(1) / root,
                          largest / S(4),
                          S(1e10),
                          S(-1e6),
                          S(-0.0),
                          smallest,
                          S(1e-10),
                          largest * S(0.99999f)};
        return list[which % std::size(list)];
    }
}

/// Numbers of one world.
template <class S, int D>
class values {
public:
    using vec = physics::vec<S, D>;
    using transform = physics::transform<S, D>;
    static constexpr double pi = 3.14159265358979324;

    /// How much of it is nonsense, the first byte says.
    explicit values(input& in) : in_(in) {
        constexpr int shares[] = {0, 0, 0, 2, 8, 24};
        wild_ = shares[in.below(6)];
    }
    [[nodiscard]] bool is_wild() const { return wild_ > 0; }
    bool empty() const { return in_.empty(); }
    unsigned byte() { return in_.byte(); }
    int below(int n) { return in_.below(n); }
    /// Once in n times.
    bool rarely(int n) { return in_.below(n) == n - 1; }

    /// Up to `scale`, of both signs; 0 once there are no more bytes.
    S real(double scale) {
        const unsigned b = byte();
        if (is_absurd(b)) return absurd<S>(byte());
        return static_cast<S>(static_cast<signed char>(b) / 128.0 * scale);
    }
    S positive(double scale) {
        const unsigned b = byte();
        if (is_absurd(b)) return absurd<S>(byte());
        return static_cast<S>((b + 1) / 256.0 * scale);
    }
    /// Often 0.
    S share(double scale) {
        const unsigned b = byte();
        if (is_absurd(b)) return absurd<S>(byte());
        return b < 160 ? S(0) : static_cast<S>((b - 159) / 96.0 * scale);
    }
    vec vector(double scale) {
        vec v;
        for (int i = 0; i < D; ++i) v[i] = real(scale);
        return v;
    }
    physics::angular<S, D> angular(double scale) {
        if constexpr (D == 2) return real(scale);
        else return vector(scale);
    }
    physics::rotation<S, D> turn() {
        const unsigned kind = byte();
        if (kind < 100) return {};
        if constexpr (D == 2) {
            if (is_absurd(kind)) return {real(2), real(2)};
            return physics::rotation<S, 2>::from_angle(static_cast<S>((kind - 100) / 128.0 * 2 * pi));
        } else {
            if (is_absurd(kind)) return {real(2), real(2), real(2), real(2)};
            double q[4], size = 0;
            for (double& x : q) {
                x = static_cast<signed char>(byte()) / 128.0;
                size += x * x;
            }
            if (!(size > 0.01)) return {};
            size = std::sqrt(size);
            return {static_cast<S>(q[0] / size), static_cast<S>(q[1] / size), static_cast<S>(q[2] / size),
                    static_cast<S>(q[3] / size)};
        }
    }
    transform pose(double scale) {
        transform t;
        t.position = vector(scale);
        t.rotation = turn();
        return t;
    }
    physics::collision_filter filter() {
        if (!rarely(4)) return {};
        const unsigned b = byte();
        return {1u << (b & 3), b & 4 ? 5u : physics::all_categories, b & 8 ? (b & 16 ? 1 : -1) : 0};
    }
    physics::material<S, D> material() {
        physics::material<S, D> m;
        if (!rarely(3)) return m;
        m.friction = share(1);
        m.restitution = share(1);
        m.rolling_resistance = share(0.2);
        if constexpr (D == 2) m.surface_velocity = share(2);
        else m.surface_velocity = vec{share(2), share(2), share(2)};
        return m;
    }
    physics::mass_properties<S, D> mass() {
        physics::mass_properties<S, D> m;
        m.mass = positive(4);
        if (byte() & 1) m.center = vector(0.5);
        if (byte() & 1) return m;
        if constexpr (D == 2) m.inertia = positive(2);
        else {
            m.inertia.xx = positive(2);
            m.inertia.yy = positive(2);
            m.inertia.zz = positive(2);
            m.inertia.xy = share(0.5);
        }
        return m;
    }
    /// Changes some members of a struct that lists them.
    template <class T>
    void change(T& it) {
        if constexpr (physics::detail::names_members<T>) {
            T::each_member(it, [this](auto& member) { this->change(member); });
        } else if (rarely(4)) {
            change_value(it);
        }
    }
    /// Calls f with a shape of a recipe that has these.
    template <class F>
    void shape(F&& f) {
        switch (in_.below(12)) {
            case 0: f(physics::ball<S, D>{positive(1)}); break;
            case 1: {
                const S half = positive(1);
                f(physics::capsule<S, D>{half, positive(0.5)});
                break;
            }
            case 2: {
                physics::box<S, D> box;
                for (int i = 0; i < D; ++i) box.half_extents[i] = positive(1);
                f(box);
                break;
            }
            case 3: {
                physics::halfspace<S, D> ground;
                if (rarely(4)) ground = {vector(1), real(1)};
                f(ground);
                break;
            }
            case 4: f(rock().shape(share(0.25))); break;
            case 5: {
                physics::rounded_box<S, D> box;
                for (int i = 0; i < D; ++i) box.half_extents[i] = positive(1);
                box.radius = share(0.25);
                f(box);
                break;
            }
            case 6: {
                const vec a = vector(1), b = vector(1);
                f(physics::segment<S, D>{a, b, share(0.25)});
                break;
            }
            case 7: {
                const vec a = vector(1), b = vector(1), c = vector(1);
                f(physics::triangle<S, D>{a, b, c, share(0.25)});
                break;
            }
            case 8:
            case 9: round_shape(f); break;
            default: with_parts(*this, f);
        }
    }

private:
    /// What is round about an axis.
    template <class F>
    void round_shape(F&& f) {
        const bool is_cone = rarely(2);
        const S half = positive(1), radius = positive(0.5);
        if constexpr (D == 2) {
            f(physics::capsule<S, D>{half, radius});
        } else if (is_cone) {
            const S upper = share(0.5);
            f(physics::cone<S, D>{half, radius, upper, share(0.25)});
        } else {
            f(physics::cylinder<S, D>{half, radius, share(0.25)});
        }
    }
    [[nodiscard]] bool is_absurd(unsigned b) const { return static_cast<int>(b) > 127 - wild_ && b < 128; }
    void change_value(S& x) { x = rarely(2) ? real(4) : positive(2); }
    void change_value(vec& v) { v = vector(1); }
    void change_value(transform& t) { t = pose(1); }
    void change_value(bool& x) { x = !x; }
    void change_value(physics::rotation<S, D>& r) { r = turn(); }
    static const physics::hull_geometry<S, D>& rock() {
        static const auto built = [] {
            std::vector<vec> corners;
            for (const double a : {0.0, 1.0, 2.5, 4.0, 5.5}) {
                vec v;
                v[0] = static_cast<S>(std::cos(a) / 2);
                v[1] = static_cast<S>(std::sin(a) / 2);
                corners.push_back(v);
                if constexpr (D == 3) corners.back()[2] = static_cast<S>(0.5);
                if constexpr (D == 3) v[2] = static_cast<S>(-0.25), corners.push_back(v);
            }
            return physics::hull_geometry<S, D>::build(corners.data(), static_cast<std::uint32_t>(corners.size()));
        }();
        return built;
    }

    input& in_;
    int wild_ = 0;
};

}  // namespace fuzz
