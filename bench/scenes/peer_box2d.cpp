// Box2D 2.4, as Debian packages it.
// peer: box2d/box2d.h=libbox2d-dev -lbox2d
#include <box2d/box2d.h>

#include "engine.hpp"

namespace bench {

namespace {

b2Vec2 to_b2(const triple& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1])}; }

class box2d final : public engine {
public:
    void begin(const scene& s) override {
        world_ = std::make_unique<b2World>(to_b2(s.gravity));
        world_->SetAllowSleeping(s.sleeps);
        if (s.iterations > 0) rounds_ = s.iterations, position_rounds_ = (3 * s.iterations + 7) / 8;
        // Which sweeps a heap against what is driven once for each of its bodies: seconds a step.
        world_->SetContinuousPhysics(!s.drives());
    }
    void add(const body& b) override {
        b2BodyDef def;
        def.type = b.kind == role::fixed ? b2_staticBody : b.kind == role::driven ? b2_kinematicBody : b2_dynamicBody;
        def.position = to_b2(b.at);
        def.angle = static_cast<float>(angle_of(b.rotation));
        def.linearVelocity = to_b2(b.velocity);
        def.angularVelocity = static_cast<float>(b.spin[2]);
        bodies_.push_back(world_->CreateBody(&def));
        for (const shape& s : b.shapes) add(s);
    }
    void join(const joint& j) override {
        b2Body *const a = bodies_[static_cast<std::size_t>(j.a)], *const b = bodies_[static_cast<std::size_t>(j.b)];
        if (j.rigid) {
            b2WeldJointDef def;
            def.bodyA = a, def.bodyB = b;
            def.localAnchorA = to_b2(j.point_a), def.localAnchorB = to_b2(j.point_b);
            def.referenceAngle = b->GetAngle() - a->GetAngle();
            world_->CreateJoint(&def);
            return;
        }
        b2RevoluteJointDef def;
        def.bodyA = a, def.bodyB = b;
        def.localAnchorA = to_b2(j.point_a), def.localAnchorB = to_b2(j.point_b);
        def.referenceAngle = b->GetAngle() - a->GetAngle();
        def.enableMotor = j.friction > 0;
        def.maxMotorTorque = static_cast<float>(j.friction);
        def.enableLimit = j.lower < j.upper;
        def.lowerAngle = static_cast<float>(j.lower), def.upperAngle = static_cast<float>(j.upper);
        world_->CreateJoint(&def);
    }
    void drive(int body, const triple& velocity, const triple& spin) override {
        bodies_[static_cast<std::size_t>(body)]->SetLinearVelocity(to_b2(velocity));
        bodies_[static_cast<std::size_t>(body)]->SetAngularVelocity(static_cast<float>(spin[2]));
    }
    void step(double dt) override { world_->Step(static_cast<float>(dt), rounds_, position_rounds_); }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (const b2Body* b : bodies_) {
            const b2Vec2 p = b->GetPosition(), v = b->GetLinearVelocity();
            states.push_back(
                {{p.x, p.y, 0}, turned(b->GetAngle()), {v.x, v.y, 0}, {0, 0, b->GetAngularVelocity()}, b->GetMass()});
        }
    }
    [[nodiscard]] triple gravity() const override { return {world_->GetGravity().x, world_->GetGravity().y, 0}; }
    [[nodiscard]] int contacts() const override {
        int count = 0;
        for (const b2Contact* c = world_->GetContactList(); c; c = c->GetNext()) count += c->IsTouching();
        return count;
    }
    [[nodiscard]] int awake() const override {
        int count = 0;
        for (const b2Body* b : bodies_) count += b->GetType() == b2_dynamicBody && b->IsAwake();
        return count;
    }

private:
    void add(const shape& s) {
        b2FixtureDef def;
        def.density = static_cast<float>(s.density);
        def.friction = static_cast<float>(s.friction);
        def.restitution = static_cast<float>(s.restitution);
        b2CircleShape circle;
        b2PolygonShape polygon;
        const auto angle = static_cast<float>(angle_of(s.rotation));
        const auto disc = [&](const triple& at) {
            circle.m_p = to_b2(s.at + rotated(s.rotation, at));
            circle.m_radius = static_cast<float>(s.radius);
            def.shape = &circle;
            bodies_.back()->CreateFixture(&def);
        };
        if (s.kind == form::ball) return disc({});
        if (s.kind == form::segment) {
            b2EdgeShape edge;
            edge.SetTwoSided(to_b2(s.at + rotated(s.rotation, s.half * -1)), to_b2(s.at + rotated(s.rotation, s.half)));
            def.shape = &edge;
            bodies_.back()->CreateFixture(&def);
            return;
        }
        if (s.kind == form::box)
            polygon.SetAsBox(static_cast<float>(s.half[0]), static_cast<float>(s.half[1]), to_b2(s.at), angle);
        if (s.kind == form::hull) {
            std::vector<b2Vec2> points;
            for (const triple& p : s.points) points.push_back(to_b2(s.at + rotated(s.rotation, p)));
            polygon.Set(points.data(), static_cast<int32>(points.size()));
        }
        if (s.kind == form::capsule) {
            // There are none: a box with two circles, whose halves within it weigh twice; the mass is put right.
            polygon.SetAsBox(static_cast<float>(s.half[0]), static_cast<float>(s.radius), to_b2(s.at), angle);
            disc({s.half[0], 0, 0});
            disc({-s.half[0], 0, 0});
        }
        def.shape = &polygon;
        bodies_.back()->CreateFixture(&def);
        if (s.kind == form::capsule && bodies_.back()->GetType() == b2_dynamicBody) {
            const double l = s.half[0], r = s.radius, pi = 3.14159265358979323846;
            const double middle = s.density * 4 * l * r, ends = s.density * pi * r * r;
            b2MassData mass;
            mass.center.SetZero();
            mass.mass = static_cast<float>(middle + ends);
            mass.I = static_cast<float>(middle * (l * l + r * r) / 3 +
                                        ends * (r * r / 2 + l * l + 2 * l * 4 * r / (3 * pi)));
            bodies_.back()->SetMassData(&mass);
        }
    }

    int rounds_ = 8, position_rounds_ = 3;
    std::unique_ptr<b2World> world_;
    std::vector<b2Body*> bodies_;
};

const enlisted here({.name = "box2d-2.4",
                     .settings = "8 velocity and 3 position rounds, slop 5 mm, skin 2 * 5 mm,"
                                 " continuous unless bodies are driven",
                     .dimension = 2,
                     .make = [](int) -> std::unique_ptr<engine> { return std::make_unique<box2d>(); },
                     // In spinner its boxes reach ahead four times as far as bodies fly: a step takes it seconds.
                     .plays = [](const scene& s) { return !s.has(form::chain); },
                     .has_joints = true});

}  // namespace

}  // namespace bench
