// Bullet's broadphases, for the broadphase benchmark.
#pragma once

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <type_traits>

#include "scene.hpp"

namespace bench {

template <class Broadphase>
class bullet final : public broadphase {
public:
    void build(const scene& s) override {
        if constexpr (std::is_same_v<Broadphase, btDbvtBroadphase>) {
            it_ = std::make_unique<Broadphase>();
        } else {
            const float far = s.side + 20;
            it_ = std::make_unique<Broadphase>(btVector3(-20, -20, -20), btVector3(far, far, far),
                                               static_cast<unsigned short>(s.boxes.size() + 2));
        }
        for (std::size_t i = 0; i < s.boxes.size(); ++i)
            proxies_.push_back(it_->createProxy(low(s.boxes[i]), high(s.boxes[i]), 0, user(i), 1, 1, nullptr));
    }
    ~bullet() override {
        for (btBroadphaseProxy* p : proxies_) it_->destroyProxy(p, nullptr);
    }
    void frame(const bench::moves& m) override {
        for (std::size_t i = 0; i < m.ids.size(); ++i)
            it_->setAabb(proxies_[m.ids[i]], low(m.boxes[i]), high(m.boxes[i]), nullptr);
        it_->calculateOverlappingPairs(nullptr);
    }
    double cast(const std::vector<segment>& rays, const box* tight) override {
        struct closest final : btBroadphaseRayCallback {
            const segment* ray;
            const box* tight;
            float fraction;
            bool process(const btBroadphaseProxy* p) override {
                shorten<3>(fraction, *ray, tight[number(p)]);
                return true;
            }
        } found;
        double sum = 0;
        found.tight = tight;
        for (const segment& ray : rays) {
            const btVector3 from(ray.from[0], ray.from[1], ray.from[2]), way(ray.way[0], ray.way[1], ray.way[2]);
            found.ray = &ray;
            found.fraction = 1;
            const btVector3 direction = way.normalized();
            for (int i = 0; i < 3; ++i) {
                found.m_rayDirectionInverse[i] = 1 / direction[i];
                found.m_signs[i] = direction[i] < 0;
            }
            found.m_lambda_max = direction.dot(way);
            it_->rayTest(from, from + way, found);
            sum += found.fraction;
        }
        return sum;
    }
    std::size_t search(const std::vector<box>& regions, const box* tight) override {
        struct all final : btBroadphaseAabbCallback {
            const box *region, *tight;
            std::size_t count = 0;
            bool process(const btBroadphaseProxy* p) override {
                count += overlap<3>(*region, tight[number(p)]);
                return true;
            }
        } found;
        found.tight = tight;
        for (const box& region : regions) {
            found.region = &region;
            it_->aabbTest(low(region), high(region), found);
        }
        return found.count;
    }
    [[nodiscard]] std::size_t pairs() const override {
        return static_cast<std::size_t>(it_->getOverlappingPairCache()->getNumOverlappingPairs());
    }

private:
    static btVector3 low(const box& b) { return {b.lower[0], b.lower[1], b.lower[2]}; }
    static btVector3 high(const box& b) { return {b.upper[0], b.upper[1], b.upper[2]}; }
    static void* user(std::size_t i) { return reinterpret_cast<void*>(i); }
    static std::size_t number(const btBroadphaseProxy* p) { return reinterpret_cast<std::size_t>(p->m_clientObject); }

    std::unique_ptr<Broadphase> it_;
    std::vector<btBroadphaseProxy*> proxies_;
};

}  // namespace bench
