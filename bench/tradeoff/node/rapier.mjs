// Rapier, in the plane and in space: Rust compiled to wasm, in float. What it calls solver iterations are substeps.
class World {
    constructor(RAPIER, scene, { dt, substeps }) {
        this.RAPIER = RAPIER;
        this.flat = scene.dimension === 2;
        this.sleeps = scene.sleeps;
        this.world = new RAPIER.World(this.vector(scene.gravity));
        this.world.timestep = dt;
        if (substeps > 0) this.world.numSolverIterations = substeps;
        this.bodies = [];
    }
    vector(v) { return this.flat ? { x: v[0], y: v[1] } : { x: v[0], y: v[1], z: v[2] }; }
    triple(v) { return [v.x, v.y, v.z ?? 0]; }
    /** A turn as it wants it. */
    rotation(q) { return this.flat ? 2 * Math.atan2(q[2], q[3]) : { x: q[0], y: q[1], z: q[2], w: q[3] }; }
    add(b) {
        const { RigidBodyDesc } = this.RAPIER;
        const desc = b.role === "fixed" ? RigidBodyDesc.fixed()
            : b.role === "driven" ? RigidBodyDesc.kinematicVelocityBased() : RigidBodyDesc.dynamic();
        desc.setTranslation(...b.at).setRotation(this.rotation(b.rotation)).setLinvel(...b.velocity)
            .setAngvel(this.flat ? b.spin[2] : this.vector(b.spin)).setCanSleep(this.sleeps);
        const body = this.world.createRigidBody(desc);
        for (const s of b.shapes)
            this.world.createCollider(this.shape(s).setDensity(s.density).setFriction(s.friction)
                .setRestitution(s.restitution), body);
        body.recomputeMassPropertiesFromColliders();
        this.bodies.push(body);
    }
    shape(s) {
        const { ColliderDesc } = this.RAPIER;
        if (s.kind === "box") return ColliderDesc.cuboid(...s.half.slice(0, this.flat ? 2 : 3));
        if (s.kind === "ball") return ColliderDesc.ball(s.radius);
        // Along y.
        if (s.kind === "capsule")
            return ColliderDesc.capsule(s.half[0], s.radius)
                .setRotation(this.rotation([0, 0, Math.SQRT1_2, Math.SQRT1_2]));
        throw new Error(`it is not told of a ${s.kind}`);
    }
    join(j) {
        const { JointData } = this.RAPIER;
        const points = [this.vector(j.point_a), this.vector(j.point_b)];
        const data = this.flat ? JointData.revolute(...points) : JointData.spherical(...points);
        this.world.createImpulseJoint(data, this.bodies[j.a], this.bodies[j.b], true).setContactsEnabled(false);
    }
    drive(i, velocity, spin) {
        this.bodies[i].setLinvel(this.vector(velocity), true);
        this.bodies[i].setAngvel(this.flat ? spin[2] : this.vector(spin), true);
    }
    step() { this.world.step(); }
    state(i) {
        const b = this.bodies[i], q = b.rotation(), w = b.angvel();
        return {
            place: this.triple(b.translation()), velocity: this.triple(b.linvel()), mass: b.mass(),
            turn: this.flat ? [0, 0, Math.sin(q / 2), Math.cos(q / 2)] : [q.x, q.y, q.z, q.w],
            spin: this.flat ? [0, 0, w] : this.triple(w),
        };
    }
    gravity() { return this.triple(this.world.gravity); }
    free() { this.world.free(); }
}

const from = (name, dimension, load) => ({
    name, dimension, joints: 1, settings: "substeps",
    load: async () => {
        const { default: RAPIER } = await load();
        await RAPIER.init();
        return (scene, settings) => new World(RAPIER, scene, settings);
    },
});
export const engines = [
    from("rapier2d-wasm", 2, () => import("@dimforge/rapier2d-compat")),
    from("rapier2d-simd-wasm", 2, () => import("@dimforge/rapier2d-simd-compat")),
    from("rapier3d-simd-wasm", 3, () => import("@dimforge/rapier3d-simd-compat")),
];
