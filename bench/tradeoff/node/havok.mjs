// Havok: C++ compiled to wasm with SIMD, in float.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

class World {
    constructor(hk, scene, { dt }) {
        this.hk = hk;
        this.dt = dt;
        this.down = scene.gravity;
        this.sleeps = scene.sleeps;
        this.world = this.got(hk.HP_World_Create());
        this.got(hk.HP_World_SetGravity(this.world, scene.gravity));
        this.got(hk.HP_World_SetIdealStepTime(this.world, dt));
        this.got(hk.HP_World_SetSpeedLimit(this.world, 1e5, 1e5));
        this.bodies = [];
        this.shapes = [];
        this.joints = [];
    }
    /** The value of an answer, which begins with how it went. */
    got(answer) {
        const [result, value] = Array.isArray(answer) ? answer : [answer];
        if (result !== this.hk.Result.RESULT_OK) throw new Error("Havok refuses a call");
        return value;
    }
    add(b) {
        const { hk } = this;
        const s = b.shapes[0], shape = this.shape(s), body = this.got(hk.HP_Body_Create());
        const mean = hk.MaterialCombine.ARITHMETIC_MEAN;
        this.got(hk.HP_Shape_SetMaterial(shape, [s.friction, s.friction, s.restitution, mean, mean]));
        this.got(hk.HP_Shape_SetDensity(shape, s.density));
        this.got(hk.HP_Body_SetShape(body, shape));
        const { STATIC, KINEMATIC, DYNAMIC } = hk.MotionType;
        this.got(hk.HP_Body_SetMotionType(body, { fixed: STATIC, driven: KINEMATIC, free: DYNAMIC }[b.role]));
        if (b.role === "free")
            this.got(hk.HP_Body_SetMassProperties(body, this.got(hk.HP_Shape_BuildMassProperties(shape))));
        this.got(hk.HP_Body_SetLinearDamping(body, 0));
        this.got(hk.HP_Body_SetAngularDamping(body, 0));
        this.got(hk.HP_Body_SetQTransform(body, [b.at, b.rotation]));
        this.got(hk.HP_World_AddBody(this.world, body, false));
        this.got(hk.HP_Body_SetLinearVelocity(body, b.velocity));
        this.got(hk.HP_Body_SetAngularVelocity(body, b.spin));
        if (!this.sleeps) this.got(hk.HP_Body_SetActivationControl(body, hk.ActivationControl.ALWAYS_ACTIVE));
        this.bodies.push({ body, free: b.role === "free" });
        this.shapes.push(shape);
    }
    shape(s) {
        const { hk } = this;
        const zero = [0, 0, 0];
        if (s.kind === "ball") return this.got(hk.HP_Shape_CreateSphere(zero, s.radius));
        if (s.kind === "box")
            return this.got(hk.HP_Shape_CreateBox(zero, [0, 0, 0, 1], s.half.map((x) => 2 * x)));
        const ends = [[-s.half[0], 0, 0], [s.half[0], 0, 0]];
        if (s.kind === "capsule") return this.got(hk.HP_Shape_CreateCapsule(...ends, s.radius));
        throw new Error(`it is not told of a ${s.kind}`);
    }
    join(j) {
        const { hk } = this;
        const made = this.got(hk.HP_Constraint_Create());
        this.got(hk.HP_Constraint_SetParentBody(made, this.bodies[j.a].body));
        this.got(hk.HP_Constraint_SetChildBody(made, this.bodies[j.b].body));
        this.got(hk.HP_Constraint_SetAnchorInParent(made, j.point_a, [1, 0, 0], [0, 1, 0]));
        this.got(hk.HP_Constraint_SetAnchorInChild(made, j.point_b, [1, 0, 0], [0, 1, 0]));
        const { LINEAR_X, LINEAR_Y, LINEAR_Z } = hk.ConstraintAxis;
        for (const axis of [LINEAR_X, LINEAR_Y, LINEAR_Z])
            this.got(hk.HP_Constraint_SetAxisMode(made, axis, hk.ConstraintAxisLimitMode.LOCKED));
        this.got(hk.HP_Constraint_SetCollisionsEnabled(made, 0));
        this.got(hk.HP_Constraint_SetEnabled(made, 1));
        this.joints.push(made);
    }
    drive(i, velocity, spin) {
        this.got(this.hk.HP_Body_SetLinearVelocity(this.bodies[i].body, velocity));
        this.got(this.hk.HP_Body_SetAngularVelocity(this.bodies[i].body, spin));
    }
    step() { this.hk.HP_World_Step(this.world, this.dt); }
    state(i) {
        const { hk } = this;
        const { body, free } = this.bodies[i];
        const [place, turn] = this.got(hk.HP_Body_GetQTransform(body));
        const mass = free ? this.got(hk.HP_Body_GetMassProperties(body))[1] : 0;
        return { place, turn, velocity: this.got(hk.HP_Body_GetLinearVelocity(body)),
            spin: this.got(hk.HP_Body_GetAngularVelocity(body)), mass };
    }
    /** It does not tell. */
    gravity() { return this.down; }
    free() {
        const { hk } = this;
        for (const joint of this.joints) hk.HP_Constraint_Release(joint);
        for (const { body } of this.bodies) {
            hk.HP_World_RemoveBody(this.world, body);
            hk.HP_Body_Release(body);
        }
        for (const shape of this.shapes) hk.HP_Shape_Release(shape);
        hk.HP_World_Release(this.world);
    }
}

export const engines = [{
    name: "havok-wasm", dimension: 3, joints: 1, settings: "none",
    load: async () => {
        const { default: HavokPhysics } = await import("@babylonjs/havok");
        // It would fetch that.
        const { resolve } = createRequire(import.meta.url);
        const wasmBinary = readFileSync(resolve("@babylonjs/havok/lib/esm/HavokPhysics.wasm"));
        const hk = await HavokPhysics({ wasmBinary });
        return (scene, settings) => new World(hk, scene, settings);
    },
}];
