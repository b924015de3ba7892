// Rapier: the deterministic build, or the one with SIMD, in f32.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';
import { thin } from './common.mjs';

const at = ([x, y, z]) => ({ x, y, z }), numbers = ({ x, y, z }) => [x, y, z];
const toZ = { w: Math.SQRT1_2, x: Math.SQRT1_2, y: 0, z: 0 };  // its cylinders are along y

export async function rapier(load, build) {
    const name = `@dimforge/rapier3d-${build}-compat`, module = await load(`${name}/dist/rapier.mjs`), R = module.default ?? module;
    await R.init();
    return {
        name: 'Rapier', method: build, version: R.version(), numbers: 'f32',
        make(scene, rate) {
            const world = new R.World(at(scene.gravity));
            world.timestep = 1 / rate;
            const touch = (shape) => shape.setFriction(scene.mu).setRestitution(scene.e);
            for (const { n, d } of scene.planes) {
                const fixed = world.createRigidBody(R.RigidBodyDesc.fixed().setTranslation(...n.map((c) => -c * d)));
                world.createCollider(touch(new R.ColliderDesc(new R.HalfSpace(at(n)))), fixed);
            }
            const shapeOf = ({ kind, size }) => kind === 'sphere' ? R.ColliderDesc.ball(size[0])
                : kind === 'box' ? R.ColliderDesc.cuboid(...size.map((s) => s / 2)) : R.ColliderDesc.cylinder(thin, size[0]).setRotation(toZ);
            const bodies = scene.bodies.map((b) => {
                const description = b.fixed ? R.RigidBodyDesc.kinematicVelocityBased() : R.RigidBodyDesc.dynamic(), [w, x, y, z] = b.q;
                description.setTranslation(...b.x).setRotation({ w, x, y, z }).setLinvel(...b.v).setAngvel(at(turn(b.q, b.w))).setCanSleep(false);
                if (!b.fixed) description.setAdditionalMassProperties(b.mass, at([0, 0, 0]), at(moments(b)), { w: 1, x: 0, y: 0, z: 0 });
                const body = world.createRigidBody(description);
                if (!scene.flies) world.createCollider(touch(shapeOf(b)).setDensity(0), body);
                return body;
            });
            return {
                step: () => world.step(),
                states: () => bodies.map((b) => {
                    const { w, x, y, z } = b.rotation();
                    return { x: numbers(b.translation()), q: [w, x, y, z], v: numbers(b.linvel()), w: numbers(b.angvel()) };
                }),
                free: () => world.free(),
            };
        },
    };
}
