// PhysX in f32, with its TGS solver. It has no cylinders: a wheel is a prism of 64 corners.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';
import { thin, turning } from './common.mjs';

const numbers = ({ x, y, z }) => [x, y, z];

export async function physx(load, binary) {
    // Its loader takes node for an unknown place. It runs as in a browser.
    const versions = Object.getOwnPropertyDescriptor(process, 'versions');
    Object.defineProperty(process, 'versions', { value: {}, configurable: true });
    globalThis.window ??= globalThis;
    const wasmBinary = await binary('physx-js-webidl/physx-js-webidl.wasm'), P = await (await load('physx-js-webidl/physx-js-webidl.mjs')).default({ wasmBinary });
    Object.defineProperty(process, 'versions', versions);
    delete globalThis.window;
    const v = P.PHYSICS_VERSION, foundation = P.CreateFoundation(v, new P.PxDefaultAllocator(), new P.PxDefaultErrorCallback());
    const scale = new P.PxTolerancesScale(), sdk = P.CreatePhysics(v, foundation, scale), dispatcher = P.DefaultCpuDispatcherCreate(0);
    P.InitExtensions(sdk);
    const vector = (a) => new P.PxVec3(...a), pose = (x, [w, a, b, c]) => new P.PxTransform(vector(x), new P.PxQuat(a, b, c, w));
    const disc = (radius) => {
        const points = new P.PxArray_PxVec3(128), description = new P.PxConvexMeshDesc();
        for (let i = 0; i < 128; ++i) {
            const a = Math.PI * (i >> 1) / 32;
            points.set(i, vector([radius * Math.cos(a), radius * Math.sin(a), i & 1 ? thin : -thin]));
        }
        description.flags = new P.PxConvexFlags(P.PxConvexFlagEnum.eCOMPUTE_CONVEX);
        Object.assign(description.points, { count: 128, stride: 12, data: points.begin() });
        return new P.PxConvexMeshGeometry(P.CreateConvexMesh(new P.PxCookingParams(scale), description));
    };
    const geometryOf = ({ kind, size }) => kind === 'sphere' ? new P.PxSphereGeometry(size[0])
        : kind === 'box' ? new P.PxBoxGeometry(...size.map((s) => s / 2)) : disc(size[0]);
    return {
        name: 'PhysX', version: `${v >> 24}.${v >> 16 & 255}.${v >> 8 & 255}`, method: 'TGS', numbers: 'f32',
        make(scene, rate) {
            const description = new P.PxSceneDesc(scale);
            Object.assign(description, { gravity: vector(scene.gravity), cpuDispatcher: dispatcher, filterShader: P.DefaultFilterShader(), solverType: P.PxSolverTypeEnum.eTGS });
            if (scene.e > 0) description.bounceThresholdVelocity = 1e-6;
            const world = sdk.createScene(description), material = sdk.createMaterial(scene.mu, scene.mu, scene.e), actors = [];
            const add = (actor, geometry) => {
                if (geometry) {
                    const shape = sdk.createShape(geometry, material, true, new P.PxShapeFlags(P.PxShapeFlagEnum.eSIMULATION_SHAPE));
                    shape.setSimulationFilterData(new P.PxFilterData(1, 1, 0, 0));
                    actor.attachShape(shape);
                }
                world.addActor(actor);
                actors.push(actor);
            };
            for (const { n, d } of scene.planes) {
                const [x, y, z] = n, c = Math.sqrt((1 + x) / 2);  // a plane's normal is its x axis
                const q = c < 1e-9 ? [0, 0, 0, 1] : [c, 0, -z / (2 * c), y / (2 * c)];
                add(sdk.createRigidStatic(pose(n.map((a) => -a * d), q)), new P.PxPlaneGeometry());
            }
            const bodies = scene.bodies.map((b) => {
                const actor = sdk.createRigidDynamic(pose(b.x, b.q));
                actor.setMass(b.mass);
                actor.setMassSpaceInertiaTensor(vector(moments(b)));
                for (const call of ['setLinearDamping', 'setAngularDamping', 'setSleepThreshold', 'setStabilizationThreshold']) actor[call]?.(0);
                actor.setMaxAngularVelocity(1000);
                actor.setRigidBodyFlag(P.PxRigidBodyFlagEnum.eENABLE_GYROSCOPIC_FORCES, true);
                if (b.fixed) actor.setRigidBodyFlag(P.PxRigidBodyFlagEnum.eKINEMATIC, true);
                add(actor, scene.flies ? null : geometryOf(b));
                if (!b.fixed) {
                    actor.setLinearVelocity(vector(b.v));
                    actor.setAngularVelocity(vector(turn(b.q, b.w)));
                }
                return actor;
            });
            const tables = turning(scene);
            let steps = 0;
            return {
                step() {
                    ++steps;
                    for (const { index, place, at } of tables) bodies[index].setKinematicTarget(pose(place, at(steps / rate)));
                    world.simulate(1 / rate);
                    world.fetchResults(true);
                },
                states: () => bodies.map((b) => {
                    const { p, q } = b.getGlobalPose();
                    return { x: numbers(p), q: [q.w, q.x, q.y, q.z], v: numbers(b.getLinearVelocity()), w: numbers(b.getAngularVelocity()) };
                }),
                free() {
                    for (const actor of actors) { world.removeActor(actor); actor.release(); }
                    world.release();
                },
            };
        },
    };
}
