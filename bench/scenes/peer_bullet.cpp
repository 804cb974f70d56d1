// Bullet 3, as Debian packages it, in float.
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -I/usr/include/bullet -lBulletDynamics
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -lBulletCollision -lLinearMath
#include <bullet/btBulletDynamicsCommon.h>

#include "engine.hpp"
#include "judge.hpp"

namespace bench {

namespace {

btVector3 to_bt(const triple& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
triple from_bt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

class bullet final : public engine {
public:
    ~bullet() override {
        if (!world_) return;
        for (const auto& j : joints_) world_->removeConstraint(j.get());
        for (const auto& b : bodies_) world_->removeRigidBody(b.get());
    }
    void begin(const scene& s) override {
        world_ = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broadphase_, &solver_, &configuration_);
        world_->setGravity(to_bt(s.gravity));
        if (s.iterations > 0) world_->getSolverInfo().m_numIterations = s.iterations;
        sleeps_ = s.sleeps;
    }
    void add(const body& b) override {
        const shape& s = b.shapes.front();
        const bool free = b.kind == role::free;
        if (s.kind == form::ball) shapes_.push_back(std::make_unique<btSphereShape>(static_cast<float>(s.radius)));
        else if (s.kind == form::box) shapes_.push_back(std::make_unique<btBoxShape>(to_bt(s.half)));
        else if (s.kind == form::capsule)
            shapes_.push_back(
                std::make_unique<btCapsuleShapeX>(static_cast<float>(s.radius), static_cast<float>(2 * s.half[0])));
        else if (s.kind == form::cylinder)
            shapes_.push_back(std::make_unique<btCylinderShapeX>(to_bt({s.half[0], s.radius, s.radius})));
        else if (s.kind == form::mesh) {
            meshes_.push_back(std::make_unique<btTriangleMesh>());
            for (std::size_t i = 0; i < s.triangles.size(); i += 3)
                meshes_.back()->addTriangle(to_bt(s.points[s.triangles[i]]), to_bt(s.points[s.triangles[i + 1]]),
                                            to_bt(s.points[s.triangles[i + 2]]));
            shapes_.push_back(std::make_unique<btBvhTriangleMeshShape>(meshes_.back().get(), true));
        } else {
            auto hull = std::make_unique<btConvexHullShape>();
            for (const triple& p : s.points) hull->addPoint(to_bt(p), false);
            hull->recalcLocalAabb();
            shapes_.push_back(std::move(hull));
        }
        // A hull's mass is not Bullet's to find.
        float mass = 0;
        btVector3 inertia(0, 0, 0);
        if (free) {
            const bench::mass m = mass_of(b, 3);
            mass = static_cast<float>(m.value);
            inertia = to_bt({m.inertia[0][0], m.inertia[1][1], m.inertia[2][2]});
        }
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shapes_.back().get(), inertia);
        // It multiplies the coefficients of both.
        info.m_friction = static_cast<float>(std::sqrt(s.friction));
        info.m_restitution = static_cast<float>(std::sqrt(s.restitution));
        const auto q = b.rotation;
        info.m_startWorldTransform = btTransform(btQuaternion(static_cast<float>(q[0]), static_cast<float>(q[1]),
                                                              static_cast<float>(q[2]), static_cast<float>(q[3])),
                                                 to_bt(b.at));
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        if (!sleeps_) bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
        world_->addRigidBody(bodies_.back().get());
        if (!free) return;
        bodies_.back()->setLinearVelocity(to_bt(b.velocity));
        bodies_.back()->setAngularVelocity(to_bt(b.spin));
    }
    void join(const joint& j) override {
        joints_.push_back(std::make_unique<btPoint2PointConstraint>(*bodies_[static_cast<std::size_t>(j.a)],
                                                                    *bodies_[static_cast<std::size_t>(j.b)],
                                                                    to_bt(j.point_a), to_bt(j.point_b)));
        world_->addConstraint(joints_.back().get(), true);
    }
    void drive(int, const triple&, const triple&) override {}
    void step(double dt) override { world_->stepSimulation(static_cast<float>(dt), 0); }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (const auto& b : bodies_) {
            const btQuaternion q = b->getWorldTransform().getRotation();
            states.push_back({from_bt(b->getWorldTransform().getOrigin()),
                              {q.x(), q.y(), q.z(), q.w()},
                              from_bt(b->getLinearVelocity()),
                              from_bt(b->getAngularVelocity()),
                              b->getMass()});
        }
    }
    [[nodiscard]] triple gravity() const override { return from_bt(world_->getGravity()); }
    [[nodiscard]] int contacts() const override {
        int count = 0;
        for (int i = 0; i < world_->getDispatcher()->getNumManifolds(); ++i) {
            const btPersistentManifold* m = world_->getDispatcher()->getManifoldByIndexInternal(i);
            bool touching = false;
            for (int k = 0; k < m->getNumContacts(); ++k)
                touching = touching || m->getContactPoint(k).getAppliedImpulse() > 0;
            count += touching;
        }
        return count;
    }
    [[nodiscard]] int awake() const override {
        int count = 0;
        for (const auto& b : bodies_) count += !b->isStaticObject() && b->isActive();
        return count;
    }

private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    bool sleeps_ = false;
    std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
    std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

const enlisted here({.name = "bullet-3",
                     .settings = "10 rounds, split impulses; hulls have a skin of 4 cm",
                     .dimension = 3,
                     .make = [](int) -> std::unique_ptr<engine> { return std::make_unique<bullet>(); },
                     .has_joints = true});

}  // namespace

}  // namespace bench
