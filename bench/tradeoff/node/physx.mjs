// PhysX 5: C++ compiled to wasm with SIMD, in float, by each of its two solvers.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

class World {
    constructor(px, physics, cpu, solver, scene, { dt, iterations }) {
        this.px = px;
        this.physics = physics;
        this.dt = dt;
        this.iterations = iterations;
        this.sleeps = scene.sleeps;
        const desc = new px.PxSceneDesc(physics.getTolerancesScale());
        this.vector(scene.gravity, (g) => desc.gravity = g);
        desc.cpuDispatcher = cpu;
        desc.filterShader = px.PxTopLevelFunctions.prototype.DefaultFilterShader();
        desc.solverType = px.PxSolverTypeEnum[solver];
        this.scene = physics.createScene(desc);
        px.destroy(desc);
        this.bodies = [];
        this.materials = [];
        this.joints = [];
    }
    /** Calls f with a vector, and takes that away again. */
    vector(v, f) {
        const made = new this.px.PxVec3(...v), result = f(made);
        this.px.destroy(made);
        return result;
    }
    pose(at, turn, f) {
        const { px } = this;
        const q = new px.PxQuat(...turn);
        const made = this.vector(at, (p) => new px.PxTransform(p, q)), result = f(made);
        for (const used of [q, made]) px.destroy(used);
        return result;
    }
    add(b) {
        const { px, physics } = this;
        const s = b.shapes[0];
        const material = physics.createMaterial(s.friction, s.friction, s.restitution);
        const flags = new px.PxShapeFlags(px.PxShapeFlagEnum.eSIMULATION_SHAPE);
        const geometry = this.geometry(s), shape = physics.createShape(geometry, material, true, flags);
        // The filter that it is bound with lets nothing collide otherwise.
        const filter = new px.PxFilterData(1, 1, 0, 0);
        shape.setSimulationFilterData(filter);
        // Along x, as here.
        const body = this.pose(b.at, b.rotation,
            (at) => b.role === "fixed" ? physics.createRigidStatic(at) : physics.createRigidDynamic(at));
        body.attachShape(shape);
        shape.release();
        for (const used of [flags, geometry, filter]) px.destroy(used);
        if (b.role === "driven") body.setRigidBodyFlag(px.PxRigidBodyFlagEnum.eKINEMATIC, true);
        if (b.role === "free") this.move(body, b, s);
        this.scene.addActor(body);
        this.bodies.push({ body, free: b.role === "free" });
        this.materials.push(material);
    }
    move(body, b, s) {
        this.px.PxRigidBodyExt.prototype.updateMassAndInertia(body, s.density);
        body.setLinearDamping(0);
        body.setAngularDamping(0);
        body.setMaxLinearVelocity(1e5);
        body.setMaxAngularVelocity(1e5);
        if (!this.sleeps) body.setSleepThreshold(0);
        if (this.iterations > 0) body.setSolverIterationCounts(this.iterations, 1);
        this.vector(b.velocity, (v) => body.setLinearVelocity(v));
        this.vector(b.spin, (w) => body.setAngularVelocity(w));
    }
    geometry(s) {
        const { px } = this;
        if (s.kind === "ball") return new px.PxSphereGeometry(s.radius);
        if (s.kind === "box") return new px.PxBoxGeometry(...s.half);
        if (s.kind === "capsule") return new px.PxCapsuleGeometry(s.radius, s.half[0]);
        throw new Error(`it is not told of a ${s.kind}`);
    }
    join(j) {
        const straight = [0, 0, 0, 1];
        this.joints.push(this.pose(j.point_a, straight, (a) => this.pose(j.point_b, straight, (b) =>
            this.px.PxTopLevelFunctions.prototype.SphericalJointCreate(this.physics, this.bodies[j.a].body, a,
                this.bodies[j.b].body, b))));
    }
    drive() { throw new Error("it drives no bodies"); }
    step() {
        this.scene.simulate(this.dt);
        this.scene.fetchResults(true);
    }
    state(i) {
        const { body, free } = this.bodies[i];
        // What it gives is overwritten by the next of its kind.
        const xyz = (v) => [v.x, v.y, v.z], { p, q } = body.getGlobalPose();
        const found = { place: xyz(p), turn: [q.x, q.y, q.z, q.w], velocity: [0, 0, 0], spin: [0, 0, 0], mass: 0 };
        if (!free) return found;
        found.velocity = xyz(body.getLinearVelocity());
        found.spin = xyz(body.getAngularVelocity());
        found.mass = body.getMass();
        return found;
    }
    gravity() {
        const g = this.scene.getGravity();
        return [g.x, g.y, g.z];
    }
    free() {
        for (const joint of this.joints) joint.release();
        for (const { body } of this.bodies) body.release();
        this.scene.release();
        for (const material of this.materials) material.release();
    }
}

/** Its package runs in browsers alone: it is shown one while it loads. */
async function load() {
    const script = createRequire(import.meta.url).resolve("physx-js-webidl");
    const wasmBinary = readFileSync(script.replace(/mjs$/, "wasm"));
    const { versions } = process;
    Object.defineProperty(process, "versions", { value: { ...versions, node: undefined }, configurable: true });
    globalThis.window ??= globalThis;
    globalThis.document ??= {};
    try {
        const { default: PhysX } = await import("physx-js-webidl");
        return await PhysX({ wasmBinary });
    } finally {
        Object.defineProperty(process, "versions", { value: versions, configurable: true });
    }
}

const by = (name, solver) => ({
    name, dimension: 3, joints: 1, settings: "iterations",
    load: async () => {
        const px = await load();
        const top = px.PxTopLevelFunctions.prototype, version = top.PHYSICS_VERSION ?? px.PHYSICS_VERSION;
        const foundation = top.CreateFoundation(version, new px.PxDefaultAllocator(), new px.PxDefaultErrorCallback());
        const physics = top.CreatePhysics(version, foundation, new px.PxTolerancesScale());
        top.InitExtensions(physics);
        const cpu = top.DefaultCpuDispatcherCreate(0);
        return (scene, settings) => new World(px, physics, cpu, solver, scene, settings);
    },
});
export const engines = [by("physx-5-wasm", "ePGS"), by("physx-5-tgs-wasm", "eTGS")];
