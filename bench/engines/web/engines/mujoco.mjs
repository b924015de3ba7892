// MuJoCo in f64, with Newton's solver. Contacts are soft; a contact that bounces is a spring with the damping of its
// restitution. It has no bodies that turn by themselves: a turntable is a flywheel.
import { moments } from '../scenes.mjs';
import { turn } from '../vectors.mjs';

const text = (numbers) => numbers.map((x) => x.toPrecision(17)).join(' ');
const sizes = { sphere: ([r]) => `${r}`, box: (edges) => text(edges.map((s) => s / 2)), hoop: ([r]) => `${r} 1e-6` };

function model(scene, rate, integrator) {
    let touch = scene.mu > 0 ? `condim='3' friction='${scene.mu} 0 0'` : "condim='1'";
    if (scene.e > 0) {
        const w = Math.PI * rate / 5, l = -Math.log(scene.e), z = l / Math.hypot(l, Math.PI);
        touch += ` solref='${-w * w} ${-2 * z * w}' solimp='0.99 0.99 0.001 0.5 2'`;
    }
    const bodies = scene.bodies.map((b) => {
        const joint = b.fixed ? `<joint type='hinge' axis='${text(b.w)}' armature='1e6'/>` : "<joint type='free'/>";
        const type = b.kind === 'hoop' ? 'cylinder' : b.kind;
        const geom = scene.flies ? '' : `<geom type='${type}' size='${sizes[b.kind](b.size)}' contype='2' conaffinity='3' ${touch}/>`;
        return `<body pos='${text(b.x)}' quat='${text(b.q)}'>${joint}<inertial pos='0 0 0' mass='${b.mass}' diaginertia='${text(moments(b))}'/>${geom}</body>`;
    });
    const planes = scene.planes.map(({ n, d }) => `<geom type='plane' size='0 0 1' zaxis='${text(n)}' pos='${text(n.map((c) => -c * d))}' contype='1' conaffinity='2' ${touch}/>`);
    return `<mujoco><size memory='64M'/><option timestep='${(1 / rate).toPrecision(17)}' gravity='${text(scene.gravity)}' integrator='${integrator}'
        solver='Newton'/><worldbody>${planes.join('')}${bodies.join('')}</worldbody></mujoco>`;
}

export async function mujoco(load, integrator) {
    const M = await (await load('mujoco-js/dist/mujoco_wasm.js')).default();
    let files = 0;
    return {
        name: 'MuJoCo', version: M.mj_versionString(), method: integrator, numbers: 'f64',
        make(scene, rate) {
            const file = `/scene${++files}.xml`;
            M.FS.writeFile(file, model(scene, rate, integrator));
            const made = M.MjModel.loadFromXML(file), data = new M.MjData(made);
            let first = 0;
            const qvel = data.qvel;
            for (const b of scene.bodies) {
                if (b.fixed) qvel[first++] = Math.hypot(...b.w);
                else for (const x of [...b.v, ...b.w]) qvel[first++] = x;
            }
            return {
                step: () => M.mj_step(made, data),
                states() {
                    const { qpos, qvel } = data;  // read anew: they move where memory grows
                    let p = 0, d = 0;
                    return scene.bodies.map((b) => {
                        if (b.fixed) { ++p; ++d; return { x: b.x, q: b.q, v: [0, 0, 0], w: b.w }; }
                        const q = [...qpos.slice(p + 3, p + 7)];
                        const state = { x: [...qpos.slice(p, p + 3)], q, v: [...qvel.slice(d, d + 3)], w: turn(q, [...qvel.slice(d + 3, d + 6)]) };
                        p += 7;
                        d += 6;
                        return state;
                    });
                },
                free() { data.delete(); made.delete(); },
            };
        },
    };
}
