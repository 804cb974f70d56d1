// Embree's ray caster over boxes, for the broadphase benchmark.
#pragma once

#include <embree3/rtcore.h>

#include "scene.hpp"

namespace bench {

class embree final : public broadphase {
public:
    ~embree() override {
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
    }
    void build(const scene& s) override {
        if (scene_) rtcReleaseScene(scene_);
        // One thread: its CPU time is what we measure.
        if (!device_) device_ = rtcNewDevice("threads=1");
        scene_ = rtcNewScene(device_);
        boxes_ = s.boxes;
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes_.size()));
        rtcSetGeometryUserData(geometry, boxes_.data());
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, intersect);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    double cast(const std::vector<segment>& rays, const box* tight) override {
        context c{};
        rtcInitIntersectContext(&c);
        c.tight = tight;
        double sum = 0;
        for (const segment& ray : rays) {
            c.ray = &ray;
            RTCRayHit hit{};
            hit.ray = {ray.from[0], ray.from[1], ray.from[2], 0, ray.way[0], ray.way[1], ray.way[2], 0, 1, ~0u, 0, 0};
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &c, &hit);
            sum += hit.ray.tfar;
        }
        return sum;
    }
    [[nodiscard]] bool moving() const override { return false; }

private:
    struct context : RTCIntersectContext {
        const segment* ray;
        const box* tight;
    };
    static void bounds(const RTCBoundsFunctionArguments* a) {
        const box& b = static_cast<const box*>(a->geometryUserPtr)[a->primID];
        *a->bounds_o = {b.lower[0], b.lower[1], b.lower[2], 0, b.upper[0], b.upper[1], b.upper[2], 0};
    }
    static void intersect(const RTCIntersectFunctionNArguments* a) {
        if (!a->valid[0]) return;
        const auto* c = static_cast<const context*>(a->context);
        auto* hit = reinterpret_cast<RTCRayHit*>(a->rayhit);
        const float before = hit->ray.tfar;
        shorten<3>(hit->ray.tfar, *c->ray, c->tight[a->primID]);
        if (hit->ray.tfar < before) hit->hit.geomID = a->geomID;
    }

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::vector<box> boxes_;
};

}  // namespace bench
