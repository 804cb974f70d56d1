// Chipmunk 7, as Debian packages it: in double, with assertions.
// peer: chipmunk/chipmunk.h=chipmunk-dev -lchipmunk -lm
#include <chipmunk/chipmunk.h>

#include "engine.hpp"

namespace bench {

namespace {

class chipmunk final : public engine {
public:
    ~chipmunk() override {
        for (cpConstraint* c : constraints_) {
            cpSpaceRemoveConstraint(space_, c);
            cpConstraintFree(c);
        }
        for (cpShape* s : shapes_) {
            cpSpaceRemoveShape(space_, s);
            cpShapeFree(s);
        }
        for (cpBody* b : bodies_) {
            cpSpaceRemoveBody(space_, b);
            cpBodyFree(b);
        }
        if (space_) cpSpaceFree(space_);
    }
    void begin(const scene& s) override {
        space_ = cpSpaceNew();
        cpSpaceSetGravity(space_, cpv(s.gravity[0], s.gravity[1]));
        if (s.iterations > 0) cpSpaceSetIterations(space_, s.iterations);
        // Its own default is that nothing sleeps.
        cpSpaceSetSleepTimeThreshold(space_, s.sleeps ? 0.5 : INFINITY);
    }
    void add(const body& b) override {
        cpBody* const made = b.kind == role::fixed    ? cpBodyNewStatic()
                             : b.kind == role::driven ? cpBodyNewKinematic()
                                                      : cpBodyNew(0, 0);
        bodies_.push_back(cpSpaceAddBody(space_, made));
        for (const shape& s : b.shapes) add(s);
        cpBodySetPosition(made, cpv(b.at[0], b.at[1]));
        cpBodySetAngle(made, angle_of(b.rotation));
        if (b.kind == role::fixed) return cpSpaceReindexShapesForBody(space_, made);
        cpBodySetVelocity(made, cpv(b.velocity[0], b.velocity[1]));
        cpBodySetAngularVelocity(made, b.spin[2]);
    }
    void join(const joint& j) override {
        cpBody *const a = bodies_[static_cast<std::size_t>(j.a)], *const b = bodies_[static_cast<std::size_t>(j.b)];
        const auto keep = [&](cpConstraint* made) {
            cpConstraintSetCollideBodies(made, cpFalse);
            constraints_.push_back(cpSpaceAddConstraint(space_, made));
        };
        keep(cpPivotJointNew2(a, b, cpv(j.point_a[0], j.point_a[1]), cpv(j.point_b[0], j.point_b[1])));
        // Angles are those of the bodies.
        const double now = cpBodyGetAngle(b) - cpBodyGetAngle(a);
        if (j.rigid) keep(cpRotaryLimitJointNew(a, b, now, now));
        else if (j.lower < j.upper) keep(cpRotaryLimitJointNew(a, b, now + j.lower, now + j.upper));
        if (j.friction > 0) {
            cpConstraint* const motor = cpSimpleMotorNew(a, b, 0);
            cpConstraintSetMaxForce(motor, j.friction);
            keep(motor);
        }
    }
    void drive(int body, const triple& velocity, const triple& spin) override {
        cpBodySetVelocity(bodies_[static_cast<std::size_t>(body)], cpv(velocity[0], velocity[1]));
        cpBodySetAngularVelocity(bodies_[static_cast<std::size_t>(body)], spin[2]);
    }
    void step(double dt) override { cpSpaceStep(space_, dt); }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (cpBody* b : bodies_) {
            const cpVect p = cpBodyGetPosition(b), v = cpBodyGetVelocity(b);
            states.push_back({{p.x, p.y, 0},
                              turned(cpBodyGetAngle(b)),
                              {v.x, v.y, 0},
                              {0, 0, cpBodyGetAngularVelocity(b)},
                              cpBodyGetMass(b)});
        }
    }
    [[nodiscard]] triple gravity() const override {
        return {cpSpaceGetGravity(space_).x, cpSpaceGetGravity(space_).y, 0};
    }
    [[nodiscard]] int contacts() const override {
        int count = 0;
        for (cpBody* b : bodies_)
            cpBodyEachArbiter(
                b,
                [](cpBody* self, cpArbiter* arbiter, void* sum) {
                    CP_ARBITER_GET_BODIES(arbiter, first, second)
                    static_cast<void>(second);
                    *static_cast<int*>(sum) += first == self;
                },
                &count);
        return count;
    }
    [[nodiscard]] int awake() const override {
        int count = 0;
        for (cpBody* b : bodies_) count += cpBodyGetType(b) == CP_BODY_TYPE_DYNAMIC && !cpBodyIsSleeping(b);
        return count;
    }

private:
    void add(const shape& s) {
        std::vector<cpVect> points;
        const auto at = [&](const triple& p) {
            const triple q = s.at + rotated(s.rotation, p);
            return cpv(q[0], q[1]);
        };
        if (s.kind == form::box)
            for (const double x : {-1.0, 1.0})
                for (const double y : {-x, x}) points.push_back(at({-x * s.half[0], y * s.half[1], 0}));
        for (const triple& p : s.points) points.push_back(at(p));
        cpBody* const b = bodies_.back();
        if (s.kind == form::chain) {
            for (std::size_t i = 0, n = points.size(); i < n; ++i) {
                cpShape* const side = cpSegmentShapeNew(b, points[i], points[(i + 1) % n], 0);
                cpSegmentShapeSetNeighbors(side, points[(i + n - 1) % n], points[(i + 2) % n]);
                keep(side, s);
            }
            return;
        }
        cpShape* made = nullptr;
        if (s.kind == form::ball) made = cpCircleShapeNew(b, s.radius, at({}));
        else if (s.kind == form::capsule || s.kind == form::segment)
            made = cpSegmentShapeNew(b, at({-s.half[0], 0, 0}), at({s.half[0], 0, 0}), s.radius);
        else made = cpPolyShapeNew(b, static_cast<int>(points.size()), points.data(), cpTransformIdentity, s.radius);
        keep(made, s);
    }
    void keep(cpShape* made, const shape& s) {
        // It multiplies the coefficients of both.
        cpShapeSetFriction(made, std::sqrt(s.friction));
        cpShapeSetElasticity(made, std::sqrt(s.restitution));
        shapes_.push_back(cpSpaceAddShape(space_, made));
        if (cpBodyGetType(bodies_.back()) == CP_BODY_TYPE_DYNAMIC) cpShapeSetDensity(made, s.density);
    }

    cpSpace* space_ = nullptr;
    std::vector<cpBody*> bodies_;
    std::vector<cpShape*> shapes_;
    std::vector<cpConstraint*> constraints_;
};

const enlisted here({.name = "chipmunk-7",
                     .settings = "10 rounds, slop 0.1 m, double",
                     .dimension = 2,
                     .make = [](int) -> std::unique_ptr<engine> { return std::make_unique<chipmunk>(); },
                     // A step of the 19,794 joints of joint_grid takes it seconds.
                     .plays = [](const scene& s) { return s.joints.size() < 10'000; },
                     .has_joints = true});

}  // namespace

}  // namespace bench
