// The same asked of Box2D 2.4.
// peer: box2d/box2d.h=libbox2d-dev -lbox2d
#include <box2d/box2d.h>

#include "row.hpp"

namespace bench::games {
namespace {

/// The pyramid of samples/scenes.hpp.
struct pyramid {
    b2World w{{0, -10}};
    std::vector<b2Body*> boxes;

    explicit pyramid(int rows) {
        w.SetAllowSleeping(false);
        b2PolygonShape shape;
        shape.SetAsBox(200, 1, {0, -1}, 0);
        b2BodyDef still;
        w.CreateBody(&still)->CreateFixture(&shape, 0);
        shape.SetAsBox(0.5f, 0.5f);
        for (int k = 0; k < rows; ++k)
            for (int i = 0; i < rows - k; ++i) {
                b2BodyDef def;
                def.type = b2_dynamicBody;
                def.position = {1.05f * (static_cast<float>(i) - 0.5f * static_cast<float>(rows - k - 1)),
                                0.5f + static_cast<float>(k)};
                boxes.push_back(w.CreateBody(&def));
                boxes.back()->CreateFixture(&shape, 1)->SetFriction(0.6f);
            }
    }
};
struct counts_events : b2ContactListener {
    long begun = 0, ended = 0;
    void BeginContact(b2Contact*) override { ++begun; }
    void EndContact(b2Contact*) override { ++ended; }
};
struct counts_impulses : counts_events {
    float largest = 0;
    void PostSolve(b2Contact*, const b2ContactImpulse* impulse) override {
        for (int i = 0; i < impulse->count; ++i) largest = std::max(largest, impulse->normalImpulses[i]);
    }
};
struct asks_first : b2ContactListener {
    long asked = 0;
    void PreSolve(b2Contact*, const b2Manifold*) override { ++asked; }
};

template <class Begin>
row step_row(const char* what, const size& by, Begin&& begin) {
    auto p = std::make_shared<pyramid>(by.rows);
    auto kept = begin(*p);
    for (int i = 0; i < 120; ++i) p->w.Step(1.0f / 60, 8, 3);
    return {what, "step", "Box2D 2.4", 2, [p, kept, frames = by.frames] {
                const stopwatch clock;
                for (int i = 0; i < frames; ++i) p->w.Step(1.0f / 60, 8, 3);
                return clock.ns() / frames;
            }};
}

struct field_of_boxes {
    b2World w{{0, 0}};
    dice random;

    explicit field_of_boxes(int things) {
        b2BodyDef still;
        b2Body* const all = w.CreateBody(&still);
        for (int i = 0; i < things; ++i) {
            b2PolygonShape shape;
            shape.SetAsBox(0.5f, 0.5f, place(), 0);
            all->CreateFixture(&shape, 0);
        }
    }
    b2Vec2 place() {
        const float x = static_cast<float>(field * random.number());
        return {x, static_cast<float>(field * random.number())};
    }
    b2Vec2 way() {
        b2Vec2 v = place();
        v.Normalize();
        return static_cast<float>(ray_length) * v;
    }
};
template <class Ask>
row ask_row(const char* what, const size& by, Ask&& ask) {
    return query_row<field_of_boxes>(what, "Box2D 2.4", 2, by, ask);
}
struct closest : b2RayCastCallback {
    bool hit = false;
    float ReportFixture(b2Fixture*, const b2Vec2&, const b2Vec2&, float fraction) override {
        hit = true;
        return fraction;
    }
};
struct overlapping : b2QueryCallback {
    b2PolygonShape box;
    b2Transform at;
    long found = 0;
    bool ReportFixture(b2Fixture* f) override {
        found += b2TestOverlap(&box, 0, f->GetShape(), 0, at, f->GetBody()->GetTransform());
        return true;
    }
};

const adds rows_of_box2d([](const size& by, std::vector<row>& rows) {
    rows.push_back(step_row("bare", by, [](pyramid&) { return 0; }));
    rows.push_back(step_row("begin and end of contacts", by, [](pyramid& p) {
        auto l = std::make_shared<counts_events>();
        p.w.SetContactListener(l.get());
        return l;
    }));
    rows.push_back(step_row("and hits", by, [](pyramid& p) {
        auto l = std::make_shared<counts_impulses>();
        p.w.SetContactListener(l.get());
        return l;
    }));
    rows.push_back(step_row("a filter of its own for each body", by, [](pyramid& p) {
        for (std::size_t i = 0; i < p.boxes.size(); ++i) {
            b2Filter f;
            f.categoryBits = static_cast<std::uint16_t>(1u << i % 15);
            f.groupIndex = static_cast<std::int16_t>(i % 2 + 1);
            p.boxes[i]->GetFixtureList()->SetFilterData(f);
        }
        return 0;
    }));
    rows.push_back(step_row("a contact rule, one-way platforms", by, [](pyramid& p) {
        auto l = std::make_shared<asks_first>();
        p.w.SetContactListener(l.get());
        return l;
    }));
    rows.push_back(step_row("1,000 sensors away from it", by, [](pyramid& p) {
        b2BodyDef still;
        b2Body* const body = p.w.CreateBody(&still);
        for (int i = 0; i < 1000; ++i) {
            b2CircleShape ball;
            ball.m_radius = 0.25f;
            ball.m_p = {200 + static_cast<float>(i), 0};
            b2FixtureDef def;
            def.shape = &ball;
            def.isSensor = true;
            body->CreateFixture(&def);
        }
        return 0;
    }));
    rows.push_back(ask_row("closest hit of a ray", by, [](field_of_boxes& f) {
        closest c;
        const b2Vec2 from = f.place();
        f.w.RayCast(&c, from, from + f.way());
        return c.hit ? 1L : 0L;
    }));
    rows.push_back(ask_row("all that a box of 8 m overlaps", by, [](field_of_boxes& f) {
        overlapping o;
        const b2Vec2 at = f.place();
        o.box.SetAsBox(4, 4);
        o.at.Set(at, 0);
        b2AABB box;
        box.lowerBound = at - b2Vec2(4, 4);
        box.upperBound = at + b2Vec2(4, 4);
        f.w.QueryAABB(&o, box);
        return o.found;
    }));
    rows.push_back({"destroys a pyramid one by one", "body", "Box2D 2.4", 2, [rows_of_boxes = by.rows] {
                        pyramid p(rows_of_boxes);
                        for (int i = 0; i < 120; ++i) p.w.Step(1.0f / 60, 8, 3);
                        const stopwatch clock;
                        for (b2Body* const b : p.boxes) p.w.DestroyBody(b);
                        return clock.ns() / static_cast<double>(p.boxes.size());
                    }});
    rows.push_back({"destroys crates that sleep alone", "body", "Box2D 2.4", 2, [things = by.things] {
                        b2World w({0, -10});
                        b2PolygonShape shape;
                        shape.SetAsBox(2.0f * static_cast<float>(things), 1, {0, -1}, 0);
                        b2BodyDef still;
                        w.CreateBody(&still)->CreateFixture(&shape, 0);
                        shape.SetAsBox(0.5f, 0.5f);
                        std::vector<b2Body*> crates;
                        for (int i = 0; i < things; ++i) {
                            b2BodyDef def;
                            def.type = b2_dynamicBody;
                            def.position = {2 * static_cast<float>(i), 0.5f};
                            crates.push_back(w.CreateBody(&def));
                            crates.back()->CreateFixture(&shape, 1);
                        }
                        for (int i = 0; i < 120; ++i) w.Step(1.0f / 60, 8, 3);
                        const stopwatch clock;
                        for (b2Body* const b : crates) w.DestroyBody(b);
                        return clock.ns() / static_cast<double>(crates.size());
                    }});
});

}  // namespace
}  // namespace bench::games
