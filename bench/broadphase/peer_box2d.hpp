// Box2D 2.4's broadphase, for the broadphase benchmark.
#pragma once

#include <box2d/b2_broad_phase.h>

#include "scene.hpp"

namespace bench {

class box2d final : public broadphase {
public:
    void build(const scene& s) override {
        for (std::size_t i = 0; i < s.boxes.size(); ++i)
            proxies_.push_back(it_.CreateProxy(to_aabb(s.boxes[i]), reinterpret_cast<void*>(i)));
    }
    void frame(const bench::moves& m) override {
        for (std::size_t i = 0; i < m.ids.size(); ++i)
            it_.MoveProxy(proxies_[m.ids[i]], to_aabb(m.boxes[i]), {m.ways[i][0], m.ways[i][1]});
        it_.UpdatePairs(this);
    }
    void AddPair(void*, void*) { ++candidates_; }

    double cast(const std::vector<segment>& rays, const box* tight) override {
        struct closest {
            const b2BroadPhase& it;
            const box* tight;
            const segment* ray = nullptr;
            float fraction = 1;
            float RayCastCallback(const b2RayCastInput&, int32 proxy) {
                shorten<2>(fraction, *ray, tight[number(it, proxy)]);
                return fraction;
            }
        } found{it_, tight};
        double sum = 0;
        for (const segment& ray : rays) {
            found.ray = &ray;
            found.fraction = 1;
            b2RayCastInput input;
            input.p1 = {ray.from[0], ray.from[1]};
            input.p2 = input.p1 + b2Vec2(ray.way[0], ray.way[1]);
            input.maxFraction = 1;
            it_.RayCast(&found, input);
            sum += found.fraction;
        }
        return sum;
    }
    std::size_t search(const std::vector<box>& regions, const box* tight) override {
        struct all {
            const b2BroadPhase& it;
            const box* tight;
            const box* region = nullptr;
            std::size_t count = 0;
            bool QueryCallback(int32 proxy) {
                count += overlap<2>(*region, tight[number(it, proxy)]);
                return true;
            }
        } found{it_, tight};
        for (const box& region : regions) {
            found.region = &region;
            it_.Query(&found, to_aabb(region));
        }
        return found.count;
    }
    [[nodiscard]] bool knows_pairs() const override { return false; }

private:
    static b2AABB to_aabb(const box& b) {
        b2AABB result;
        result.lowerBound = {b.lower[0], b.lower[1]};
        result.upperBound = {b.upper[0], b.upper[1]};
        return result;
    }
    static std::size_t number(const b2BroadPhase& it, int32 proxy) {
        return reinterpret_cast<std::size_t>(it.GetUserData(proxy));
    }

    b2BroadPhase it_;
    std::vector<int32> proxies_;
    std::size_t candidates_ = 0;
};

}  // namespace bench
