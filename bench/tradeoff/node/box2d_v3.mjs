// Box2D 3: C compiled to wasm with SIMD, in float.
class World {
    constructor(b2, scene, { dt, substeps }) {
        this.b2 = b2;
        this.dt = dt;
        this.substeps = substeps;
        const def = b2.b2DefaultWorldDef();
        this.fill(def.gravity, scene.gravity);
        def.enableSleep = scene.sleeps;
        def.workerCount = 0;
        def.maximumLinearSpeed = 1e5;
        this.world = b2.b2CreateWorld(def);
        this.bodies = [];
    }
    fill(to, v) { to.x = v[0], to.y = v[1]; }
    add(b) {
        const { b2 } = this;
        const def = b2.b2DefaultBodyDef();
        def.type = { fixed: b2.b2BodyType.b2_staticBody, driven: b2.b2BodyType.b2_kinematicBody,
            free: b2.b2BodyType.b2_dynamicBody }[b.role];
        this.fill(def.position, b.at);
        def.rotation.SetAngle(2 * Math.atan2(b.rotation[2], b.rotation[3]));
        this.fill(def.linearVelocity, b.velocity);
        def.angularVelocity = b.spin[2];
        const body = b2.b2CreateBody(this.world, def);
        this.bodies.push(body);
        for (const s of b.shapes) this.shape(body, s);
    }
    shape(body, s) {
        const { b2 } = this;
        const def = b2.b2DefaultShapeDef();
        def.density = s.density;
        def.material.friction = s.friction;
        def.material.restitution = s.restitution;
        if (s.kind === "box") b2.b2CreatePolygonShape(body, def, b2.b2MakeBox(s.half[0], s.half[1]));
        else if (s.kind === "ball") {
            const circle = new b2.b2Circle();
            this.fill(circle.center, [0, 0]);
            circle.radius = s.radius;
            b2.b2CreateCircleShape(body, def, circle);
        } else if (s.kind === "capsule") {
            const capsule = new b2.b2Capsule();
            this.fill(capsule.center1, [-s.half[0], 0]);
            this.fill(capsule.center2, [s.half[0], 0]);
            capsule.radius = s.radius;
            b2.b2CreateCapsuleShape(body, def, capsule);
        } else throw new Error(`it is not told of a ${s.kind}`);
    }
    join(j) {
        const { b2 } = this;
        const def = b2.b2DefaultRevoluteJointDef();
        def.base.bodyIdA = this.bodies[j.a];
        def.base.bodyIdB = this.bodies[j.b];
        this.fill(def.base.localFrameA.p, j.point_a);
        this.fill(def.base.localFrameB.p, j.point_b);
        b2.b2CreateRevoluteJoint(this.world, def);
    }
    drive(i, velocity, spin) {
        const v = new this.b2.b2Vec2(velocity[0], velocity[1]);
        this.b2.b2Body_SetLinearVelocity(this.bodies[i], v);
        this.b2.b2Body_SetAngularVelocity(this.bodies[i], spin[2]);
        v.delete();
    }
    step() { this.b2.b2World_Step(this.world, this.dt, this.substeps); }
    state(i) {
        const { b2 } = this;
        const body = this.bodies[i];
        const p = b2.b2Body_GetPosition(body), q = b2.b2Body_GetRotation(body), v = b2.b2Body_GetLinearVelocity(body);
        const half = Math.atan2(q.s, q.c) / 2;
        const found = { place: [p.x, p.y, 0], turn: [0, 0, Math.sin(half), Math.cos(half)], velocity: [v.x, v.y, 0],
            spin: [0, 0, b2.b2Body_GetAngularVelocity(body)], mass: b2.b2Body_GetMass(body) };
        for (const copy of [p, q, v]) copy.delete();
        return found;
    }
    gravity() {
        const g = this.b2.b2World_GetGravity(this.world);
        return [g.x, g.y, 0];
    }
    free() { this.b2.b2DestroyWorld(this.world); }
}

export const engines = [{
    name: "box2d-3-wasm", dimension: 2, joints: 1, settings: "substeps",
    load: async () => {
        const { default: Box2D } = await import("box2d3-wasm");
        const b2 = await Box2D();
        return (scene, settings) => new World(b2, scene, settings);
    },
}];
