// run.mjs DIRECTORY BITS [SCENE]: a row for each engine, scene, step and law: the error, microseconds of a step, and bytes of
// WebAssembly. All engines run in this process. DIRECTORY has node_modules and the modules of worlds.cpp; BITS is
// TUMBLE_BITS; SCENE is part of a name.
//
// A time is the least of seven runs, in which the work is the same, for each eight steps: the mean of the first second, and
// the dearest eight. Of a heap it is the processor time of the steps of the run that is judged, the least of three runs.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { cannon } from './engines/cannon.mjs';
import { havok } from './engines/havok.mjs';
import { jolt } from './engines/jolt.mjs';
import { mujoco } from './engines/mujoco.mjs';
import { physx } from './engines/physx.mjs';
import { rapier } from './engines/rapier.mjs';
import { tumble } from './engines/tumble.mjs';
import { scenes } from './scenes.mjs';

const [, , directory, bits, wanted = ''] = process.argv, modules = `${directory}/node_modules`;
const rates = [256, 60], chunk = 8, repetitions = 7, heapRepetitions = 3;
const load = (path) => import(`${modules}/${path}`), binary = (path) => readFile(`${modules}/${path}`);
const version = (name) => JSON.parse(readFileSync(`${modules}/${name}/package.json`)).version;

// The bytes of the largest module of WebAssembly that an engine compiles.
let compiled = 0;
const note = (bytes) => { compiled = Math.max(compiled, bytes?.byteLength ?? 0); };
for (const name of ['instantiate', 'compile']) {
    const original = WebAssembly[name];
    WebAssembly[name] = (source, ...rest) => { note(source); return original.call(WebAssembly, source, ...rest); };
}
WebAssembly.Module = new Proxy(WebAssembly.Module, { construct: (of, args) => { note(args[0]); return new of(...args); } });

const engines = [
    () => tumble(directory, 'q32'), () => tumble(directory, 'f32_plain'), () => tumble(directory, 'f64'),
    () => rapier(load, 'deterministic'), () => rapier(load, 'simd'), () => jolt(load, modules, version), () => havok(load, binary, version),
    () => physx(load, binary), () => mujoco(load, 'Euler'), () => mujoco(load, 'RK4'), () => cannon(load, version),
];

const digest = (states) => createHash('sha256').update(Float64Array.from(states.flatMap((s) => [...s.x, ...s.q, ...s.v, ...s.w]))).digest('hex');

// The whole run, and for a heap the processor time of each step, microseconds.
function judged(engine, scene, rate) {
    const world = engine.make(scene, rate), run = { scene, start: world.states() }, costs = [];
    scene.note?.(run, run.start, 0, rate);
    for (let step = 1; step <= scene.seconds * rate; ++step) {
        const before = scene.isHeap ? process.cpuUsage().user : 0;
        world.step();
        if (scene.isHeap) costs.push(process.cpuUsage().user - before);
        scene.note?.(run, world.states(), step, rate);
    }
    run.end = world.states();
    run.trouble = world.trouble?.() ?? '';
    world.free();
    return { run, costs };
}
// Microseconds of each of the chunks of the first second.
function timed(engine, scene, rate) {
    const world = engine.make(scene, rate), costs = [];
    for (let i = 0; i < rate / chunk; ++i) {
        const before = performance.now();
        for (let k = 0; k < chunk; ++k) world.step();
        costs.push(1000 * (performance.now() - before) / chunk);
    }
    world.free();
    return costs;
}
const least = (runs) => runs[0].map((_, i) => Math.min(...runs.map((costs) => costs[i])));
const mean = (costs) => costs.reduce((a, b) => a + b) / costs.length;
// The dearest eight steps in a row.
const dearest = (costs) => Math.max(...costs.slice(0, 1 - chunk).map((_, i) => mean(costs.slice(i, i + chunk))));

function print(engine, scene, rate) {
    const row = { scene: scene.name, core: 'node', engine: engine.name, version: engine.version, integrator: engine.method, numbers: engine.numbers,
        carry: engine.carry ?? false, step_s: 1 / rate, wasm_bytes: engine.bytes, tumble_bits: Number(bits) };
    let laws = Object.fromEntries(scene.laws.map(([law]) => [law, null]));
    try {
        const runs = Array.from({ length: scene.isHeap ? heapRepetitions : 2 }, () => judged(engine, scene, rate)), { run } = runs[0];
        laws = Object.fromEntries(scene.laws.map(([law, measure]) => [law, measure(run)]));
        row.repeats = runs.every((other) => digest(other.run.end) === digest(run.end));
        if (run.trouble) row.trouble = run.trouble;
        const costs = least(scene.isHeap ? runs.map((other) => other.costs) : Array.from({ length: repetitions }, () => timed(engine, scene, rate)));
        row.us_per_step = mean(costs);
        row.us_worst_eight = scene.isHeap ? dearest(costs) : Math.max(...costs);
    } catch (error) { row.failure = String(error).slice(0, 200); }
    for (const [law, error] of Object.entries(laws)) {
        const ofLaw = { ...row, law };
        if (Number.isFinite(error)) ofLaw.error = error;
        else ofLaw.failure ??= 'not a number';
        console.log(JSON.stringify(ofLaw));
    }
}

for (const open of engines) {
    compiled = 0;
    const engine = await open();
    engine.bytes = engine.measured ? readFileSync(engine.measured).length : compiled;
    for (const rate of rates)
        for (const scene of scenes)
            if (scene.name.includes(wanted) && !(scene.isHeap && rate !== 60)) print(engine, scene, rate);
}
process.exit(0);
