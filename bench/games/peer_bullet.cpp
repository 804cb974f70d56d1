// The same asked of Bullet.
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -I/usr/include/bullet -lBulletDynamics
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -lBulletCollision -lLinearMath
#include <btBulletDynamicsCommon.h>

#include "row.hpp"

namespace bench::games {
namespace {

struct field_of_boxes {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btCollisionWorld w{&dispatcher, &broadphase, &configuration};
    btBoxShape box{{0.5f, 0.5f, 0.5f}}, large{{4, 4, 4}};
    std::vector<std::unique_ptr<btCollisionObject>> all;
    btCollisionObject probe;
    dice random;

    explicit field_of_boxes(int things) {
        // Without the slack that its hull casts have.
        box.setMargin(0.001f);
        for (int i = 0; i < things; ++i) {
            all.push_back(std::make_unique<btCollisionObject>());
            all.back()->setCollisionShape(&box);
            btTransform at = btTransform::getIdentity();
            at.setOrigin(place());
            all.back()->setWorldTransform(at);
            w.addCollisionObject(all.back().get());
        }
        probe.setCollisionShape(&large);
        w.updateAabbs();
    }
    field_of_boxes(const field_of_boxes&) = delete;
    ~field_of_boxes() {
        for (auto& one : all) w.removeCollisionObject(one.get());
    }
    btVector3 place() {
        const float x = static_cast<float>(field * random.number()), y = static_cast<float>(field * random.number());
        return {x, y, static_cast<float>(field * random.number())};
    }
    btVector3 way() { return place().normalized() * static_cast<float>(ray_length); }
};
template <class Ask>
row ask_row(const char* what, const size& by, Ask&& ask) {
    return query_row<field_of_boxes>(what, "Bullet", 3, by, ask);
}
struct counts : btCollisionWorld::ContactResultCallback {
    long found = 0;
    btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        ++found;
        return 0;
    }
};

const adds rows_of_bullet([](const size& by, std::vector<row>& rows) {
    rows.push_back(ask_row("closest hit of a ray", by, [](field_of_boxes& f) {
        const btVector3 from = f.place(), to = from + f.way();
        btCollisionWorld::ClosestRayResultCallback hit(from, to);
        f.w.rayTest(from, to, hit);
        return hit.hasHit() ? 1L : 0L;
    }));
    rows.push_back(ask_row("closest hit of a swept box", by, [](field_of_boxes& f) {
        const btVector3 from = f.place(), to = from + f.way();
        btCollisionWorld::ClosestConvexResultCallback hit(from, to);
        btTransform start = btTransform::getIdentity(), end = start;
        start.setOrigin(from);
        end.setOrigin(to);
        f.w.convexSweepTest(&f.box, start, end, hit);
        return hit.hasHit() ? 1L : 0L;
    }));
    rows.push_back(ask_row("all that a box of 8 m overlaps", by, [](field_of_boxes& f) {
        btTransform at = btTransform::getIdentity();
        at.setOrigin(f.place());
        f.probe.setWorldTransform(at);
        counts c;
        f.w.contactTest(&f.probe, c);
        return c.found;
    }));
});

}  // namespace
}  // namespace bench::games
