// The library's broadphases as contestants of the broadphase benchmark.
#pragma once

#include <physics.hpp>

#include "scene.hpp"

namespace bench {

template <class Policy, class S, int D>
class ours final : public broadphase {
public:
    void build(const scene& s) override {
        std::uint32_t id = 0;
        for (const box& b : s.boxes) it_.insert(id++, to_aabb(b), {});
        it_.update();
    }
    void frame(const bench::moves& m) override {
        for (std::size_t i = 0; i < m.ids.size(); ++i)
            it_.move(m.ids[i], to_aabb(m.boxes[i]), to_vec(m.ways[i].data()));
        pairs_ = it_.pairs([](std::uint32_t, std::uint32_t) { return true; }).size();
    }
    double cast(const std::vector<segment>& rays, const box* tight) override {
        double sum = 0;
        for (const segment& ray : rays) {
            float fraction = 1;
            it_.each_along({to_vec(ray.from), to_vec(ray.way)}, {}, [&](const physics::proxy_hit<S>& hit) {
                shorten<D>(fraction, ray, tight[hit.id]);
                return S(fraction);
            });
            sum += fraction;
        }
        return sum;
    }
    std::size_t search(const std::vector<box>& regions, const box* tight) override {
        std::size_t found = 0;
        for (const box& region : regions)
            it_.each_overlapping(to_aabb(region), {},
                                 [&](std::uint32_t id) { found += overlap<D>(region, tight[id]); });
        return found;
    }
    [[nodiscard]] std::size_t pairs() const override { return pairs_; }
    bool without_margins() override {
        it_.configure({.margin = S(0), .prediction = S(0)});
        return true;
    }

private:
    using space = physics::space<S, D>;

    static typename space::vec to_vec(const float* from) {
        typename space::vec v;
        for (int i = 0; i < D; ++i) v[i] = S(from[i]);
        return v;
    }
    static typename space::aabb to_aabb(const box& b) { return {to_vec(b.lower), to_vec(b.upper)}; }

    typename Policy::template in<space> it_;
    std::size_t pairs_ = 0;
};

}  // namespace bench
