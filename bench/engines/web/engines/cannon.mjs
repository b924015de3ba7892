// cannon-es in f64: JavaScript without WebAssembly.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';
import { thin } from './common.mjs';

const numbers = ({ x, y, z }) => [x, y, z];

export async function cannon(load, version) {
    const C = await load('cannon-es/dist/cannon-es.js');
    const toZ = new C.Quaternion(Math.SQRT1_2, 0, 0, Math.SQRT1_2);  // its cylinders are along y
    const shapeOf = ({ kind, size }) => kind === 'sphere' ? new C.Sphere(size[0])
        : kind === 'box' ? new C.Box(new C.Vec3(...size.map((s) => s / 2))) : new C.Cylinder(size[0], size[0], 2 * thin, 32);
    return {
        name: 'cannon-es', version: version('cannon-es'), method: '', numbers: 'f64',
        make(scene, rate) {
            const world = new C.World({ gravity: new C.Vec3(...scene.gravity), allowSleep: false });
            Object.assign(world.defaultContactMaterial, { friction: scene.mu, restitution: scene.e });
            for (const { n, d } of scene.planes) {
                const plane = new C.Body({ mass: 0, shape: new C.Plane() });
                plane.quaternion.setFromVectors(new C.Vec3(0, 0, 1), new C.Vec3(...n));
                plane.position.set(...n.map((c) => -c * d));
                world.addBody(plane);
            }
            const bodies = scene.bodies.map((b) => {
                const type = b.fixed ? C.Body.KINEMATIC : C.Body.DYNAMIC;
                const body = new C.Body({ mass: b.fixed ? 0 : b.mass, type, linearDamping: 0, angularDamping: 0, allowSleep: false });
                if (!scene.flies) body.addShape(shapeOf(b), new C.Vec3(), b.kind === 'hoop' ? toZ : undefined);
                const [w, x, y, z] = b.q;
                body.position.set(...b.x);
                body.quaternion.set(x, y, z, w);
                body.velocity.set(...b.v);
                body.angularVelocity.set(...turn(b.q, b.w));
                world.addBody(body);
                if (!b.fixed) {
                    body.inertia.set(...moments(b));
                    body.invInertia.set(...moments(b).map((I) => 1 / I));
                    body.updateInertiaWorld(true);
                    body.updateMassProperties = () => {};
                }
                return body;
            });
            return {
                step: () => world.step(1 / rate),
                states: () => bodies.map((b) => {
                    const { w, x, y, z } = b.quaternion;
                    return { x: numbers(b.position), q: [w, x, y, z], v: numbers(b.velocity), w: numbers(b.angularVelocity) };
                }),
                free() {},
            };
        },
    };
}
