// Havok in f32. It has no planes: they are fixed boxes.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';
import { slab, thin, turning } from './common.mjs';

const xyzw = ([w, x, y, z]) => [x, y, z, w];

export async function havok(load, binary, version) {
    const H = await (await load('@babylonjs/havok/lib/esm/HavokPhysics_es.js')).default({ wasmBinary: await binary('@babylonjs/havok/lib/esm/HavokPhysics.wasm') });
    const origin = [0, 0, 0], upright = [0, 0, 0, 1], box = (edges) => H.HP_Shape_CreateBox(origin, upright, edges)[1];
    const shapeOf = ({ kind, size }) => kind === 'box' ? box(size)
        : kind === 'hoop' ? H.HP_Shape_CreateCylinder([0, 0, -thin], [0, 0, thin], size[0])[1] : H.HP_Shape_CreateSphere(origin, size[0])[1];
    return {
        name: 'Havok', version: version('@babylonjs/havok'), method: '', numbers: 'f32',
        make(scene, rate) {
            const world = H.HP_World_Create()[1], made = [];
            H.HP_World_SetGravity(world, scene.gravity);
            H.HP_World_SetIdealStepTime(world, 1 / rate);
            H.HP_World_SetSpeedLimit(world, 1000, 1000);
            const create = (shape, x, q, type) => {
                const body = H.HP_Body_Create()[1];
                H.HP_Shape_SetMaterial(shape, [scene.mu, scene.mu, scene.e, H.MaterialCombine.GEOMETRIC_MEAN, H.MaterialCombine.MAXIMUM]);
                H.HP_Body_SetShape(body, shape);
                H.HP_Body_SetQTransform(body, [x, xyzw(q)]);
                H.HP_Body_SetMotionType(body, type);
                made.push(body);
                return body;
            };
            for (const plane of scene.planes) {
                const { x, q, half } = slab(plane);
                H.HP_World_AddBody(world, create(box(half.map((h) => 2 * h)), x, q, H.MotionType.STATIC), false);
            }
            const bodies = scene.bodies.map((b) => {
                const body = create(shapeOf(b), b.x, b.q, b.fixed ? H.MotionType.KINEMATIC : H.MotionType.DYNAMIC);
                if (!b.fixed) H.HP_Body_SetMassProperties(body, [origin, b.mass, moments(b), upright]);
                H.HP_Body_SetLinearDamping(body, 0);
                H.HP_Body_SetAngularDamping(body, 0);
                H.HP_World_AddBody(world, body, false);
                H.HP_Body_SetLinearVelocity(body, b.v);
                H.HP_Body_SetAngularVelocity(body, turn(b.q, b.w));
                H.HP_Body_SetActivationControl(body, H.ActivationControl.ALWAYS_ACTIVE);
                return body;
            });
            const tables = turning(scene);
            let steps = 0;
            return {
                step() {
                    ++steps;
                    for (const { index, place, at } of tables) H.HP_Body_SetTargetQTransform(bodies[index], [place, xyzw(at(steps / rate))]);
                    H.HP_World_Step(world, 1 / rate);
                },
                states: () => bodies.map((b) => {
                    const [x, [qx, qy, qz, qw]] = H.HP_Body_GetQTransform(b)[1];
                    return { x: [...x], q: [qw, qx, qy, qz], v: [...H.HP_Body_GetLinearVelocity(b)[1]], w: [...H.HP_Body_GetAngularVelocity(b)[1]] };
                }),
                free() {
                    for (const body of made) { H.HP_World_RemoveBody(world, body); H.HP_Body_Release(body); }
                    H.HP_World_Release(world);
                },
            };
        },
    };
}
