// ODE 0.16, as Debian packages it: in double, with assertions.
// peer: ode/ode.h=libode-dev -lode
#include <ode/ode.h>

#include "engine.hpp"

namespace bench {

namespace {

class ode final : public engine {
public:
    ode() {
        static const bool once = dInitODE2(0) != 0;
        static_cast<void>(once);
    }
    ~ode() override {
        if (!world_) return;
        dJointGroupDestroy(joints_);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
    }
    void begin(const scene& s) override {
        world_ = dWorldCreate();
        space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY);
        joints_ = dJointGroupCreate(0);
        // It shuffles its constraints.
        dRandSetSeed(0);
        if (s.iterations > 0) dWorldSetQuickStepNumIterations(world_, s.iterations);
        dWorldSetAutoDisableFlag(world_, s.sleeps);
        dWorldSetGravity(world_, s.gravity[0], s.gravity[1], s.gravity[2]);
    }
    void add(const body& b) override {
        const shape& s = b.shapes.front();
        const dGeomID geom = s.kind == form::ball ? dCreateSphere(space_, s.radius)
                                                  : dCreateBox(space_, 2 * s.half[0], 2 * s.half[1], 2 * s.half[2]);
        friction_ = s.friction, restitution_ = s.restitution;
        dBodyID made = nullptr;
        if (b.kind == role::free) {
            made = dBodyCreate(world_);
            dMass m;
            if (s.kind == form::ball) dMassSetSphere(&m, s.density, s.radius);
            else dMassSetBox(&m, s.density, 2 * s.half[0], 2 * s.half[1], 2 * s.half[2]);
            dBodySetMass(made, &m);
            dGeomSetBody(geom, made);
            dBodySetLinearVel(made, b.velocity[0], b.velocity[1], b.velocity[2]);
            dBodySetAngularVel(made, b.spin[0], b.spin[1], b.spin[2]);
        }
        const dQuaternion q = {b.rotation[3], b.rotation[0], b.rotation[1], b.rotation[2]};
        dGeomSetPosition(geom, b.at[0], b.at[1], b.at[2]);
        dGeomSetQuaternion(geom, q);
        bodies_.push_back(made);
        geoms_.push_back(geom);
    }
    void join(const joint& j) override {
        const dBodyID a = bodies_[static_cast<std::size_t>(j.a)], b = bodies_[static_cast<std::size_t>(j.b)];
        if (!a && !b) return;
        const dJointID made = dJointCreateBall(world_, nullptr);
        dJointAttach(made, a, b);
        dVector3 at;
        const dBodyID it = b ? b : a;
        const triple& point = b ? j.point_b : j.point_a;
        dBodyGetRelPointPos(it, point[0], point[1], point[2], at);
        dJointSetBallAnchor(made, at[0], at[1], at[2]);
    }
    void drive(int, const triple&, const triple&) override {}
    void step(double dt) override {
        dJointGroupEmpty(joints_);
        contacts_ = 0;
        dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) { static_cast<ode*>(self)->meet(a, b); });
        dWorldQuickStep(world_, dt);
    }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (std::size_t i = 0; i < geoms_.size(); ++i) {
            dQuaternion q;
            dGeomGetQuaternion(geoms_[i], q);
            state s = {to_triple(dGeomGetPosition(geoms_[i])), {q[1], q[2], q[3], q[0]}, {}, {}, 0};
            if (bodies_[i]) {
                dMass m;
                dBodyGetMass(bodies_[i], &m);
                s.velocity = to_triple(dBodyGetLinearVel(bodies_[i]));
                s.spin = to_triple(dBodyGetAngularVel(bodies_[i]));
                s.mass = m.mass;
            }
            states.push_back(s);
        }
    }
    [[nodiscard]] triple gravity() const override {
        dVector3 g;
        dWorldGetGravity(world_, g);
        return to_triple(g);
    }
    [[nodiscard]] int contacts() const override { return contacts_; }
    [[nodiscard]] int awake() const override {
        int count = 0;
        for (const dBodyID b : bodies_) count += b && dBodyIsEnabled(b);
        return count;
    }

private:
    static triple to_triple(const dReal* v) { return {v[0], v[1], v[2]}; }

    void meet(dGeomID a, dGeomID b) {
        const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
        if (!first && !second) return;
        if (first && second && dAreConnectedExcluding(first, second, dJointTypeContact)) return;
        dContactGeom found[4];
        const int count = dCollide(a, b, 4, found, sizeof(dContactGeom));
        contacts_ += count > 0;
        for (int k = 0; k < count; ++k) {
            dContact c = {};
            c.surface.mode = restitution_ > 0 ? dContactApprox1 | dContactBounce : dContactApprox1;
            c.surface.mu = friction_;
            c.surface.bounce = restitution_;
            c.geom = found[k];
            dJointAttach(dJointCreateContact(world_, joints_, &c), first, second);
        }
    }

    dWorldID world_ = nullptr;
    dSpaceID space_ = nullptr;
    dJointGroupID joints_ = nullptr;
    std::vector<dBodyID> bodies_;
    std::vector<dGeomID> geoms_;
    double friction_ = 0.6, restitution_ = 0;
    int contacts_ = 0;
};

const enlisted here({.name = "ode-0.16",
                     .settings = "QuickStep, 20 rounds, ERP 0.2, at most 4 points a pair, double",
                     .dimension = 3,
                     .make = [](int) -> std::unique_ptr<engine> { return std::make_unique<ode>(); },
                     // Its hulls are not made for heaps, and capsules are not told to it.
                     .plays = [](const scene& s) { return !s.has(form::hull) && !s.has(form::capsule); },
                     .has_joints = true});

}  // namespace

}  // namespace bench
