// cannon-es: JavaScript, in double.
const xyz = (v) => [v.x, v.y, v.z];

class World {
    constructor(CANNON, scene, { dt, iterations }) {
        this.CANNON = CANNON;
        this.dt = dt;
        this.world = new CANNON.World({ gravity: new CANNON.Vec3(...scene.gravity), allowSleep: scene.sleeps });
        // The one that it ships with tries all pairs.
        this.world.broadphase = new CANNON.SAPBroadphase(this.world);
        if (iterations > 0) this.world.solver.iterations = iterations;
        this.bodies = [];
    }
    add(b) {
        const { Body, Material, Vec3, Quaternion } = this.CANNON;
        const s = b.shapes[0];
        // It multiplies the coefficients of both.
        const material = new Material({ friction: Math.sqrt(s.friction), restitution: Math.sqrt(s.restitution) });
        const body = new Body({
            mass: b.role === "free" ? b.mass : 0,
            type: { fixed: Body.STATIC, driven: Body.KINEMATIC, free: Body.DYNAMIC }[b.role],
            position: new Vec3(...b.at), quaternion: new Quaternion(...b.rotation),
            velocity: new Vec3(...b.velocity), angularVelocity: new Vec3(...b.spin),
            linearDamping: 0, angularDamping: 0, material,
        });
        this.shape(body, s);
        this.bodies.push(body);
        this.world.addBody(body);
        if (b.role !== "free") return;
        // Its own are those of the box around.
        const inertia = [0, 1, 2].map((k) => b.inertia[k][k]);
        body.inertia.set(...inertia);
        body.invInertia.set(...inertia.map((i) => 1 / i));
        body.updateInertiaWorld(true);
    }
    shape(body, s) {
        const { Box, Sphere, Cylinder, Vec3, Quaternion } = this.CANNON;
        if (s.kind === "box") body.addShape(new Box(new Vec3(...s.half)));
        else if (s.kind === "ball") body.addShape(new Sphere(s.radius));
        else if (s.kind === "capsule") {
            // There are none. Cylinders lie along y.
            const across = new Quaternion(0, 0, Math.SQRT1_2, Math.SQRT1_2);
            body.addShape(new Cylinder(s.radius, s.radius, 2 * s.half[0], 12), new Vec3(), across);
            for (const x of [-s.half[0], s.half[0]]) body.addShape(new Sphere(s.radius), new Vec3(x, 0, 0));
        } else throw new Error(`it has no ${s.kind}`);
    }
    join(j) {
        const { PointToPointConstraint, Vec3 } = this.CANNON;
        const made = new PointToPointConstraint(this.bodies[j.a], new Vec3(...j.point_a), this.bodies[j.b],
            new Vec3(...j.point_b));
        made.collideConnected = false;
        this.world.addConstraint(made);
    }
    drive(i, velocity, spin) {
        this.bodies[i].velocity.set(...velocity);
        this.bodies[i].angularVelocity.set(...spin);
    }
    step() { this.world.step(this.dt); }
    state(i) {
        const b = this.bodies[i], q = b.quaternion;
        return { place: xyz(b.position), turn: [q.x, q.y, q.z, q.w], velocity: xyz(b.velocity),
            spin: xyz(b.angularVelocity), mass: b.mass };
    }
    gravity() { return xyz(this.world.gravity); }
    free() {}
}

export const engines = [{
    name: "cannon-es", dimension: 3, joints: 1, settings: "iterations",
    load: async () => {
        const CANNON = await import("cannon-es");
        return (scene, settings) => new World(CANNON, scene, settings);
    },
}];
