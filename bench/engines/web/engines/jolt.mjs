// Jolt in f32. Its memory is fixed at 128 MB: the rooms for bodies and pairs are as large as the heaps need.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';
import { thin } from './common.mjs';

const numbers = (v) => [v.GetX(), v.GetY(), v.GetZ()];

export async function jolt(load, modules, version) {
    const wasm = `${modules}/jolt-physics/dist/jolt-physics.wasm.wasm`;
    const J = await (await load('jolt-physics/dist/jolt-physics.wasm.js')).default({ locateFile: () => wasm, print() {} });
    const still = 0, moving = 1, vector = (v) => new J.Vec3(...v), quaternion = ([w, x, y, z]) => new J.Quat(x, y, z, w);
    const shapeOf = ({ kind, size }) => {
        if (kind === 'none') return new J.SphereShape(size[0]);
        if (kind === 'sphere') return new J.SphereShape(size[0]);
        if (kind === 'box') return new J.BoxShape(vector(size.map((s) => s / 2)), Math.min(0.05, Math.min(...size) / 4), null);
        const disc = new J.CylinderShapeSettings(thin, size[0], 0, null);
        return new J.RotatedTranslatedShapeSettings(vector([0, 0, 0]), new J.Quat(Math.SQRT1_2, 0, 0, Math.SQRT1_2), disc).Create().Get();
    };
    return {
        name: 'Jolt', version: version('jolt-physics'), method: '', numbers: 'f32',
        make(scene, rate) {
            const settings = new J.JoltSettings();
            Object.assign(settings, { mMaxBodies: 1100, mMaxBodyPairs: 16384, mMaxContactConstraints: 8192, mMaxWorkerThreads: 0 });
            const pairs = new J.ObjectLayerPairFilterTable(2), layers = new J.BroadPhaseLayerInterfaceTable(2, 2);
            if (!scene.flies) for (const other of [still, moving]) pairs.EnableCollision(other, moving);
            for (const layer of [still, moving]) layers.MapObjectToBroadPhaseLayer(layer, new J.BroadPhaseLayer(layer));
            settings.mObjectLayerPairFilter = pairs;
            settings.mBroadPhaseLayerInterface = layers;
            settings.mObjectVsBroadPhaseLayerFilter = new J.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
            const system = new J.JoltInterface(settings), physics = system.GetPhysicsSystem(), all = physics.GetBodyInterface();
            J.destroy(settings);
            physics.SetGravity(vector(scene.gravity));
            if (scene.e > 0) {
                const bounce = physics.GetPhysicsSettings();
                bounce.mMinVelocityForRestitution = 0;
                physics.SetPhysicsSettings(bounce);
            }
            const touch = (creation) => Object.assign(creation, { mFriction: scene.mu, mRestitution: scene.e });
            for (const { n, d } of scene.planes) {
                const shape = new J.PlaneShape(new J.Plane(vector(n), d), null, 100);
                const creation = new J.BodyCreationSettings(shape, new J.RVec3(0, 0, 0), new J.Quat(0, 0, 0, 1), J.EMotionType_Static, still);
                all.AddBody(all.CreateBody(touch(creation)).GetID(), J.EActivation_DontActivate);
            }
            const bodies = scene.bodies.map((b) => {
                const type = b.fixed ? J.EMotionType_Kinematic : J.EMotionType_Dynamic;
                const creation = touch(new J.BodyCreationSettings(shapeOf(b), new J.RVec3(...b.x), quaternion(b.q), type, moving));
                Object.assign(creation, { mLinearVelocity: vector(b.v), mAngularVelocity: vector(turn(b.q, b.w)), mLinearDamping: 0, mAngularDamping: 0,
                    mAllowSleeping: false, mApplyGyroscopicForce: true, mMaxAngularVelocity: 1000,
                    mOverrideMassProperties: J.EOverrideMassProperties_MassAndInertiaProvided });
                creation.mMassPropertiesOverride.mMass = b.mass;
                creation.mMassPropertiesOverride.mInertia = J.Mat44.prototype.sIdentity().sScaleVec3(vector(moments(b)));
                const body = all.CreateBody(creation);
                all.AddBody(body.GetID(), J.EActivation_Activate);
                return body;
            });
            return {
                step: () => system.Step(1 / rate, 1),
                states: () => bodies.map((b) => {
                    const q = b.GetRotation(), orientation = [q.GetW(), q.GetX(), q.GetY(), q.GetZ()];
                    return { x: numbers(b.GetPosition()), q: orientation, v: numbers(b.GetLinearVelocity()), w: numbers(b.GetAngularVelocity()) };
                }),
                free: () => J.destroy(system),
            };
        },
    };
}
