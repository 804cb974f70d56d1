// Jolt: C++ compiled to wasm without SIMD, in float.
const layer = 0;

class World {
    constructor(Jolt, scene, { dt, iterations }) {
        this.Jolt = Jolt;
        this.dt = dt;
        this.sleeps = scene.sleeps;
        // One layer, all of which collides.
        const settings = new Jolt.JoltSettings();
        const pairs = new Jolt.ObjectLayerPairFilterTable(1);
        pairs.EnableCollision(layer, layer);
        const broad = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
        broad.MapObjectToBroadPhaseLayer(layer, new Jolt.BroadPhaseLayer(0));
        settings.mObjectLayerPairFilter = pairs;
        settings.mBroadPhaseLayerInterface = broad;
        settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, pairs, 1);
        this.jolt = new Jolt.JoltInterface(settings);
        Jolt.destroy(settings);
        this.system = this.jolt.GetPhysicsSystem();
        this.vector(scene.gravity, (g) => this.system.SetGravity(g));
        if (iterations > 0) {
            const how = this.system.GetPhysicsSettings();
            how.mNumVelocitySteps = iterations;
            // As many more as it ships with.
            how.mNumPositionSteps = Math.ceil(iterations / 5);
            this.system.SetPhysicsSettings(how);
        }
        this.interface = this.system.GetBodyInterface();
        this.bodies = [];
        if (scene.joints.length > 0) {
            this.groups = new Jolt.GroupFilterTable(scene.bodies.length);
            for (const { a, b } of scene.joints) this.groups.DisableCollision(a, b);
        }
    }
    /** Calls f with a vector, and takes that away again. */
    vector(v, f, Type = this.Jolt.Vec3) {
        const made = new Type(...v), result = f(made);
        this.Jolt.destroy(made);
        return result;
    }
    add(b) {
        const { Jolt } = this;
        const s = b.shapes[0], at = new Jolt.RVec3(...b.at), turn = new Jolt.Quat(...b.rotation);
        const type = { fixed: Jolt.EMotionType_Static, driven: Jolt.EMotionType_Kinematic,
            free: Jolt.EMotionType_Dynamic }[b.role];
        const shape = this.shape(s);
        const settings = new Jolt.BodyCreationSettings(shape, at, turn, type, layer);
        settings.mFriction = s.friction;
        settings.mRestitution = s.restitution;
        settings.mLinearDamping = settings.mAngularDamping = 0;
        settings.mMaxLinearVelocity = settings.mMaxAngularVelocity = 1e5;
        settings.mAllowSleeping = this.sleeps;
        this.vector(b.velocity, (v) => settings.mLinearVelocity = v);
        this.vector(b.spin, (w) => settings.mAngularVelocity = w);
        if (this.groups) {
            const group = new Jolt.CollisionGroup(this.groups, 0, this.bodies.length);
            settings.mCollisionGroup = group;
            Jolt.destroy(group);
        }
        const body = this.interface.CreateBody(settings);
        this.interface.AddBody(body.GetID(), Jolt.EActivation_Activate);
        this.bodies.push(body);
        shape.Release();
        for (const used of [at, turn, settings]) Jolt.destroy(used);
    }
    shape(s) {
        const { Jolt } = this;
        let made;
        if (s.kind === "ball") made = new Jolt.SphereShapeSettings(s.radius);
        // Its boxes are rounded by 5 cm, of which there may be less.
        else if (s.kind === "box")
            made = this.vector(s.half, (half) => new Jolt.BoxShapeSettings(half, Math.min(0.05, ...s.half)));
        else if (s.kind === "capsule") made = new Jolt.CapsuleShapeSettings(s.half[0], s.radius);
        else throw new Error(`it is not told of a ${s.kind}`);
        made.mDensity = s.density;
        if (s.kind === "capsule") {
            // Along y.
            const turn = new Jolt.Quat(0, 0, Math.SQRT1_2, Math.SQRT1_2);
            made = this.vector([0, 0, 0], (zero) => new Jolt.RotatedTranslatedShapeSettings(zero, turn, made));
            Jolt.destroy(turn);
        }
        const shape = made.Create().Get();
        // So that it outlives the settings until there is a body.
        shape.AddRef();
        Jolt.destroy(made);
        return shape;
    }
    join(j) {
        const { Jolt } = this;
        const settings = new Jolt.PointConstraintSettings();
        settings.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
        this.vector(j.point_a, (p) => settings.mPoint1 = p, Jolt.RVec3);
        this.vector(j.point_b, (p) => settings.mPoint2 = p, Jolt.RVec3);
        this.system.AddConstraint(settings.Create(this.bodies[j.a], this.bodies[j.b]));
        Jolt.destroy(settings);
    }
    drive(i, velocity, spin) {
        this.vector(velocity, (v) => this.bodies[i].SetLinearVelocity(v));
        this.vector(spin, (w) => this.bodies[i].SetAngularVelocity(w));
    }
    step() { this.jolt.Step(this.dt, 1); }
    state(i) {
        const body = this.bodies[i], xyz = (v) => [v.GetX(), v.GetY(), v.GetZ()];
        const place = xyz(body.GetPosition()), q = body.GetRotation();
        const turn = [q.GetX(), q.GetY(), q.GetZ(), q.GetW()];
        const mass = body.IsDynamic() ? 1 / body.GetMotionProperties().GetInverseMass() : 0;
        return { place, turn, velocity: xyz(body.GetLinearVelocity()), spin: xyz(body.GetAngularVelocity()), mass };
    }
    gravity() {
        const g = this.system.GetGravity();
        return [g.GetX(), g.GetY(), g.GetZ()];
    }
    free() {
        for (const body of this.bodies) {
            this.interface.RemoveBody(body.GetID());
            this.interface.DestroyBody(body.GetID());
        }
        this.Jolt.destroy(this.jolt);
    }
}

export const engines = [{
    name: "jolt-wasm", dimension: 3, joints: 1, settings: "iterations",
    load: async () => {
        const { default: load } = await import("jolt-physics/wasm-compat");
        const Jolt = await load();
        return (scene, settings) => new World(Jolt, scene, settings);
    },
}];
