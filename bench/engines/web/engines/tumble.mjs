// This kernel as modules of WebAssembly (worlds.cpp), in one number system.
import { readFile } from 'node:fs/promises';
import { turn } from '../vectors.mjs';

const kinds = { none: 0, sphere: 1, box: 2, hoop: 3 };
const issues = ['range_left', 'step_bound_hit', 'contacts_full', 'world_full', 'step_too_long', 'left_over'];

async function open(file) {
    const module = await WebAssembly.compile(await readFile(file));
    // The C library asks for an environment and for files, of which there are none.
    const none = new Proxy({}, { get: (_, name) => () => { if (name === 'proc_exit') throw Error('the module ended'); return 0; } });
    const kernel = (await WebAssembly.instantiate(module, { wasi_snapshot_preview1: none, env: none })).exports;
    kernel._initialize();
    return kernel;
}

export async function tumble(directory, numbers) {
    const small = await open(`${directory}/${numbers}.wasm`), large = await open(`${directory}/heap_${numbers}.wasm`);
    const [name, plain] = numbers.split('_');
    return {
        name: 'tumble', version: '', method: 'verlet', numbers: name, carry: !plain && name !== 'f64', measured: `${directory}/one_${numbers}.wasm`,
        make(scene, rate) {
            const kernel = scene.isHeap ? large : small;
            kernel.begin(...scene.gravity, 1, rate, scene.e, scene.mu);
            for (const b of scene.bodies)
                kernel.body(kinds[b.kind], ...(b.moments ?? [...b.size, 0, 0].slice(0, 3)), b.mass, ...b.x, ...b.q, ...b.v, ...b.w, b.fixed ? 1 : 0);
            for (const p of scene.planes) kernel.plane(...p.n, p.d);
            if (kernel.make_world(scene.world) === 0) throw Error(`no world ${scene.world}`);
            return {
                step: () => kernel.step(),
                states() {
                    const all = new Float64Array(kernel.memory.buffer, kernel.state(), scene.bodies.length * 13);
                    return scene.bodies.map((_, i) => {
                        const [x0, x1, x2, w, a, b, c, v0, v1, v2, ...spin] = all.subarray(13 * i, 13 * i + 13), q = [w, a, b, c];
                        return { x: [x0, x1, x2], q, v: [v0, v1, v2], w: turn(q, spin) };
                    });
                },
                trouble: () => issues.filter((_, bit) => kernel.status() >> bit & 1).join(', '),
                free() {},
            };
        },
    };
}
