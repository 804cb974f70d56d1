// A number that two worlds share exactly when they are in the same state.
#pragma once

#include "physics/world/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Mixes words into 64 bits, by value: neither byte order nor padding enters. Source: the finaliser of
/// Steele, Lea, Flood, Fast splittable pseudorandom number generators (2014).
class hasher {
public:
    void add(std::uint64_t word) {
        hash_ = (hash_ ^ word) * 0xff51afd7ed558ccdu;
        hash_ ^= hash_ >> 32;
        hash_ *= 0xc4ceb9fe1a85ec53u;
        hash_ ^= hash_ >> 29;
    }
    template <scalar_type S>
    void add(S x) {
        add(scalar_traits<S>::bits(x));
    }
    template <class S, int D>
    void add(vec<S, D> v) {
        for (int i = 0; i < D; ++i) add(v[i]);
    }
    template <class S>
    void add(rotation<S, 2> r) {
        add(r.cosine);
        add(r.sine);
    }
    template <class S>
    void add(rotation<S, 3> r) {
        add(r.imaginary());
        add(r.w);
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0x9e3779b97f4a7c15u;
};

template <class Plan>
std::uint64_t state_hash(const state<Plan>& s) {
    hasher h;
    h.add(s.steps);
    h.add(std::uint64_t{s.bodies.count()});
    s.bodies.each([&](std::uint32_t i, const auto& b) {
        h.add(std::uint64_t{i} << 32 | s.bodies.generation(i));
        h.add(b.center);
        h.add(b.rotation);
        h.add(b.velocity.linear);
        h.add(b.velocity.angular);
        h.add(b.force);
        h.add(b.torque);
    });
    h.add(std::uint64_t{s.contacts.size()});
    for (const auto& c : s.contacts) {
        h.add(std::uint64_t{c.shape_a} << 32 | c.shape_b);
        h.add(c.normal);
        for (int k = 0; k < c.count; ++k) {
            h.add(std::uint64_t{c.points[k].feature});
            h.add(c.points[k].normal_impulse);
            h.add(c.points[k].friction_impulse);
        }
    }
    return h.value();
}

}  // namespace detail

PHYSICS_HPP_END
