// matter-js: JavaScript, in double. It measures in pixels, of which 100 are a metre, and in milliseconds.
const metre = 100;
const px = (v) => ({ x: v[0] * metre, y: v[1] * metre });

class World {
    constructor(Matter, scene, { dt, iterations }) {
        this.Matter = Matter;
        this.ms = dt * 1000;
        // Numbers of bodies decide in which order it looks at pairs.
        Matter.Common._nextId = 0;
        this.engine = Matter.Engine.create({ enableSleeping: scene.sleeps });
        const a = px(scene.gravity);
        Object.assign(this.engine.gravity, { x: a.x / 1e6, y: a.y / 1e6, scale: 1 });
        if (iterations > 0) {
            // As many more of the others as it ships with.
            this.engine.velocityIterations = iterations;
            this.engine.positionIterations = Math.ceil(1.5 * iterations);
            this.engine.constraintIterations = Math.ceil(iterations / 2);
        }
        this.bodies = [];
        const usual = World.usual ??= Matter.Detector.canCollide;
        Matter.Detector.canCollide = scene.joints.length === 0 ? usual
            : (a, b) => !a.apart.has(b) && usual(a, b);
    }
    add(b) {
        const { Body, Composite } = this.Matter;
        const s = b.shapes[0], angle = 2 * Math.atan2(b.rotation[2], b.rotation[3]);
        const body = this.shape(s, px(b.at), {
            friction: s.friction, restitution: s.restitution, frictionAir: 0, isStatic: b.role !== "free",
        });
        body.collisionFilter.apart = new Set();
        Body.setAngle(body, angle);
        if (b.role === "free") {
            // Its discs are polygons, and its inertia is four times what follows from them.
            Body.setMass(body, b.mass);
            Body.setInertia(body, b.inertia[2][2] * metre * metre);
            body.deltaTime = this.ms;
            const frame = Body._baseDelta / 1000;
            Body.setVelocity(body, { x: b.velocity[0] * metre * frame, y: b.velocity[1] * metre * frame });
            Body.setAngularVelocity(body, b.spin[2] * frame);
        }
        this.bodies.push(body);
        Composite.add(this.engine.world, body);
    }
    shape(s, at, options) {
        const { Bodies } = this.Matter;
        if (s.kind === "ball") return Bodies.circle(at.x, at.y, s.radius * metre, options);
        if (s.kind === "box")
            return Bodies.rectangle(at.x, at.y, 2 * s.half[0] * metre, 2 * s.half[1] * metre, options);
        if (s.kind === "capsule")
            return Bodies.rectangle(at.x, at.y, 2 * (s.half[0] + s.radius) * metre, 2 * s.radius * metre,
                { ...options, chamfer: { radius: s.radius * metre } });
        throw new Error(`it is not told of a ${s.kind}`);
    }
    join(j) {
        const { Constraint, Composite, Vector } = this.Matter;
        const bodyA = this.bodies[j.a], bodyB = this.bodies[j.b];
        bodyA.collisionFilter.apart.add(bodyB.collisionFilter);
        bodyB.collisionFilter.apart.add(bodyA.collisionFilter);
        Composite.add(this.engine.world, Constraint.create({
            bodyA, bodyB, length: 0,
            pointA: Vector.rotate(px(j.point_a), bodyA.angle), pointB: Vector.rotate(px(j.point_b), bodyB.angle),
        }));
    }
    drive() { throw new Error("it drives no bodies"); }
    step() { this.Matter.Engine.update(this.engine, this.ms); }
    state(i) {
        const { Body } = this.Matter;
        const b = this.bodies[i], v = Body.getVelocity(b), frame = Body._baseDelta / 1000;
        return {
            place: [b.position.x / metre, b.position.y / metre, 0],
            turn: [0, 0, Math.sin(b.angle / 2), Math.cos(b.angle / 2)],
            velocity: [v.x / metre / frame, v.y / metre / frame, 0],
            spin: [0, 0, Body.getAngularVelocity(b) / frame], mass: b.mass,
        };
    }
    gravity() { return [this.engine.gravity.x * 1e6 / metre, this.engine.gravity.y * 1e6 / metre, 0]; }
    free() { this.Matter.Engine.clear(this.engine); }
}

export const engines = [{
    name: "matter-js", dimension: 2, joints: 1, settings: "iterations",
    load: async () => {
        const { default: Matter } = await import("matter-js");
        return (scene, settings) => new World(Matter, scene, settings);
    },
}];
