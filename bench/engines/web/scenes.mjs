// Scenes whose motion is known, and heaps: data that every engine reads, and laws that judge the run of an engine. They are
// those of bench/engines/contacts.cpp, bench/laws and host_sim/scenes, and some more.
//   body    kind, size (edges, radius, or radius and height; m), mass (kg), x (m), v (m/s), q, w (rad/s, body axes)
//   scene   gravity, e (restitution), mu (friction), seconds, bodies, planes n.x + d = 0; world: which of worlds.cpp
//   laws    name and a function of the run: its scene, start, end, and what `note` has kept
//   note    called with the run, the state of all bodies, the step and the steps in a second; after each step and before
import { angle, cross, dot, norm, sub, turn, turnBack } from './vectors.mjs';

const earth = [0, -9.81, 0], floor = { n: [0, 1, 0], d: 0 };
const still = { v: [0, 0, 0], w: [0, 0, 0], q: [1, 0, 0, 0] };
const ball = (radius, mass, x, more = {}) => ({ kind: 'sphere', size: [radius], mass, x, ...still, ...more });
const box = (size, mass, x, more = {}) => ({ kind: 'box', size, mass, x, ...still, ...more });

// Principal moments of inertia, kg m^2.
export function moments(body) {
    if (body.moments) return body.moments;
    const m = body.mass, [a, b, c] = body.size;
    switch (body.kind) {
    case 'sphere': return [0.4 * m * a * a, 0.4 * m * a * a, 0.4 * m * a * a];
    case 'box': return [m * (b * b + c * c) / 12, m * (a * a + c * c) / 12, m * (a * a + b * b) / 12];
    case 'hoop': return [m * a * a / 2, m * a * a / 2, m * a * a];
    default: throw Error(`no moments of a ${body.kind}`);
    }
}

// J, with w of a state in the world's axes.
function kineticEnergy(scene, states) {
    return scene.bodies.reduce((sum, body, i) => {
        if (body.fixed) return sum;
        const w = turnBack(states[i].q, states[i].w);
        return sum + 0.5 * (body.mass * dot(states[i].v, states[i].v) + moments(body).reduce((s, I, k) => s + I * w[k] * w[k], 0));
    }, 0);
}

// --- laws ------------------------------------------------------------------------------------------------------------

const distanceOf = (i) => (run) => norm(sub(run.end[i].x, run.start[i].x));
const sink = ['sink of the top, m', (run) => Math.abs(run.end.at(-1).x[1] - run.start.at(-1).x[1])];
const shift = ['largest shift sideways, m', (run) => Math.max(...run.end.map((s, i) => Math.hypot(s.x[0] - run.start[i].x[0], s.x[2] - run.start[i].x[2])))];
const heightOfTop = (height) => ['height of the top, m', (run) => Math.abs(run.end.at(-1).x[1] - height)];

// The orientation of a free top once a second: Euler's equations by RK4 in double, with steps of 1/4096 s.
function motionOfTop(I, spin, seconds) {
    const rate = ([a, b, c, d, x, y, z]) => [
        0.5 * (-b * x - c * y - d * z), 0.5 * (a * x + c * z - d * y), 0.5 * (a * y + d * x - b * z), 0.5 * (a * z + b * y - c * x),
        (I[1] - I[2]) * y * z / I[0], (I[2] - I[0]) * z * x / I[1], (I[0] - I[1]) * x * y / I[2]];
    const h = 1 / 4096, along = (s, k, part) => s.map((x, i) => x + part * k[i]);
    let state = [1, 0, 0, 0, ...spin];
    const all = [state];
    for (let n = 1; n <= seconds * 4096; ++n) {
        const a = rate(state), b = rate(along(state, a, h / 2)), c = rate(along(state, b, h / 2)), d = rate(along(state, c, h));
        state = state.map((x, i) => x + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]));
        const length = Math.hypot(...state.slice(0, 4));
        state = state.map((x, i) => i < 4 ? x / length : x);
        if (n % 4096 === 0) all.push(state);
    }
    return all;
}
let topTruth;
function noteTop(run, states, step, rate) {
    if (step % rate !== 0) return;
    topTruth ??= motionOfTop([1, 2, 3], [0.1, 2, 0.1], 100);
    const second = step / rate, off = angle(topTruth[second], states[0].q);
    run.off = Math.max(run.off ?? 0, off);
    if (run.off > 0.1) run.until ??= second - 1;
    const drift = Math.abs(kineticEnergy(run.scene, states) / kineticEnergy(run.scene, run.start) - 1);
    run.drift = Math.max(run.drift ?? 0, drift);
}

// The heights of a bouncing ball's apexes, from the heights after each step by a parabola through three.
function apexes(heights) {
    const all = [];
    for (let i = 1; i + 1 < heights.length; ++i) {
        const [a, b, c] = heights.slice(i - 1, i + 2);
        if (b > a && b >= c) all.push(b + (c - a) ** 2 / (8 * (2 * b - a - c)));
    }
    return all;
}
const bounce = (e, seconds, count) => ({
    name: `bouncing ball, e = ${e}`, world: 1, gravity: earth, e, mu: 0, seconds, bodies: [ball(0.1, 1, [0, 1.1, 0])], planes: [floor],
    note(run, states) { (run.heights ??= []).push(states[0].x[1]); },
    laws: [['worst apex, of the right height', (run) => {
        const tops = apexes(run.heights);
        return Math.max(...Array.from({ length: count }, (_, k) => Math.abs(((tops[k] ?? 0.1) - 0.1) / e ** (2 * (k + 1)) - 1)));
    }]],
});

// m, by the axes of separation; 0 where nothing overlaps. Boxes of one size.
function deepestOverlap({ scene, end }) {
    const axes = end.map((s) => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((a) => turn(s.q, a))), size = (i) => scene.bodies[i].size;
    const reach = (i, n) => 0.5 * axes[i].reduce((sum, a, k) => sum + size(i)[k] * Math.abs(dot(a, n)), 0);
    let most = 0;
    for (let i = 0; i < end.length; ++i) {
        for (const { n, d } of scene.planes) most = Math.max(most, reach(i, n) - dot(n, end[i].x) - d);
        for (let j = 0; j < i; ++j) {
            const between = sub(end[i].x, end[j].x);
            if (norm(between) > 0.5 * (norm(size(i)) + norm(size(j)))) continue;
            let least = Infinity;
            const look = (n) => {
                const length = norm(n), unit = n.map((x) => x / length);
                if (length > 1e-6) least = Math.min(least, reach(i, unit) + reach(j, unit) - Math.abs(dot(unit, between)));
            };
            for (const a of axes[i]) look(a);
            for (const a of axes[j]) { look(a); for (const b of axes[i]) look(cross(a, b)); }
            most = Math.max(most, least);
        }
    }
    return most;
}

// --- scenes ----------------------------------------------------------------------------------------------------------

const stack = (lift = 0) => Array.from({ length: 10 }, (_, i) => box([1, 1, 1], 10, [0, 0.5 + i + lift * (i + 1), 0]));
const pyramid = [0, 1, 2, 3].flatMap((row) => Array.from({ length: 4 - row }, (_, i) => box([1, 1, 1], 10, [-1.6875 + 0.5625 * row + 1.125 * i, 0.5 + row, 0])));
const triangle = [[0, 0], [0.0866025403784, 0.05], [0.0866025403784, -0.05], [0.173205080757, 0], [0.173205080757, 0.1], [0.173205080757, -0.1]];
const mirrored = [[0, 0], [1, 1], [2, 3], [4, 4], [5, 6]];
const onIncline = { world: 2, gravity: earth, e: 0, seconds: 4, planes: [{ n: [-0.6, 0.8, 0], d: 0 }],
    bodies: [box([0.5, 0.25, 0.5], 2, [-0.075, 0.1, 0], { q: [3 / Math.sqrt(10), 0, 0, 1 / Math.sqrt(10)] })] };
const atRest = { gravity: earth, e: 0, mu: 0.5, seconds: 10, planes: [floor] };

function heap(count) {
    // A generator of its own, so that the heap is the same everywhere.
    let seed = 7;
    const random = () => (seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648;
    const wall = 2.6, bodies = Array.from({ length: count }, (_, i) => {
        const q = [0, 0, 0, 0].map(() => random() - 0.5), length = Math.hypot(...q), layer = Math.floor(i / 25), k = i % 25;
        const x = (k % 5 - 2) * 0.95 + 0.02 * random(), z = (Math.floor(k / 5) - 2) * 0.95 + 0.02 * random();
        return box([0.5, 0.5, 0.5], 1, [x, 0.6 + 0.95 * layer, z], { q: q.map((c) => c / length) });
    });
    return { name: `heap of ${count} boxes`, world: 10, gravity: earth, e: 0, mu: 0.5, seconds: 4, bodies, isHeap: true,
        planes: [floor, ...[[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]].map((n) => ({ n, d: wall }))],
        laws: [['deepest overlap at the end, m', deepestOverlap]] };
}

export const scenes = [
    { name: 'free top, 100 s', world: 0, gravity: [0, 0, 0], e: 0, mu: 0, seconds: 100, planes: [], flies: true, note: noteTop,
        bodies: [{ kind: 'none', size: [0.5], moments: [1, 2, 3], mass: 1, x: [0, 0, 0], ...still, w: [0.1, 2, 0.1] }],
        laws: [['orientation, rad', (run) => run.off], ['within 0.1 rad for, s', (run) => run.until ?? 100], ['energy', (run) => run.drift]] },
    { name: 'projectile, 4 s', world: 0, gravity: earth, e: 0, mu: 0, seconds: 4, planes: [], flies: true,
        bodies: [ball(0.1, 1, [0, 0, 0], { v: [3, 18, 1], w: [1, 2, 3] })],
        laws: [['place, m', (run) => norm(sub(run.end[0].x, [12, 72 - 9.81 * 8, 4]))]] },
    { name: 'resting box', world: 2, ...atRest, seconds: 4, bodies: [box([0.5, 0.25, 0.5], 2, [0, 0.125, 0])], laws: [['place, m', distanceOf(0)]] },
    { name: 'stack of ten', world: 3, ...atRest, bodies: stack(), laws: [sink, shift] },
    { name: 'stack, set down', world: 3, ...atRest, bodies: stack(0.002), laws: [heightOfTop(9.5), shift] },
    { name: 'pyramid of ten', world: 3, ...atRest, bodies: pyramid, laws: [sink, shift] },
    { name: 'heavy on light, 100 : 1', world: 8, ...atRest, bodies: [box([1, 1, 1], 1, [0, 0.5, 0]), box([1, 1, 1], 100, [0, 1.5, 0])], laws: [sink, shift] },
    { name: 'heavy set down on light, 100 : 1', world: 8, ...atRest,
        bodies: [box([1, 1, 1], 1, [0, 0.502, 0]), box([1, 1, 1], 100, [0.1, 1.504, 0.05])], laws: [heightOfTop(1.5), shift] },
    { name: 'cradle', world: 4, gravity: earth, e: 1, mu: 0, seconds: 6,
        bodies: [-0.5, -0.25, 0, 0.25, 0.5].map((x, i) => ball(0.125, 1, [x, 0.125, 0], { v: [i === 0 ? 1 : 0, 0, 0] })),
        planes: [floor, { n: [1, 0, 0], d: 1.125 }, { n: [-1, 0, 0], d: 1.125 }],
        note(run, states, step, rate) {
            for (let i = 1; i < 4; ++i) run.moved = Math.max(run.moved ?? 0, norm(sub(states[i].x, run.start[i].x)));
            if (step === Math.round(rate / 4)) run.speed = Math.abs(states[4].v[0] - 1);
        },
        laws: [['speed of the last after 1/4 s, m/s', (run) => run.speed], ['largest way of an inner ball, m', (run) => run.moved]] },
    bounce(1, 10, 10), bounce(0.8, 5, 6),
    { name: 'break of six', world: 5, gravity: [0, 0, 0], e: 1, mu: 0, seconds: 1, planes: [],
        bodies: [ball(0.05, 0.17, [-0.5, 0, 0], { v: [3, 0, 0] }), ...triangle.map(([x, z]) => ball(0.05, 0.17, [x, 0, z]))],
        laws: [['off the mirror image, m', (run) => Math.max(...mirrored.map(([a, b]) => { const [x, y, z] = run.end[b].x; return norm(sub(run.end[a].x, [x, y, -z])); }))],
            ['gain of energy', (run) => kineticEnergy(run.scene, run.end) / kineticEnergy(run.scene, run.start) - 1]] },
    { name: 'incline, sticks (1.01)', ...onIncline, mu: 0.7575, laws: [['place, m', distanceOf(0)]] },
    { name: 'incline, slides (0.99)', ...onIncline, mu: 0.7425,
        laws: [['place, m', (run) => { const way = 9.81 * (0.75 - 0.7425) * 0.8 * 8, [x, y] = run.start[0].x; return norm(sub(run.end[0].x, [x - 0.8 * way, y - 0.6 * way, 0])); }]] },
    { name: 'turntable', world: 6, gravity: earth, e: 0, mu: 0.9, seconds: 4, planes: [],
        bodies: [box([30, 0.5, 30], 1, [0, -0.25, 0], { fixed: true, w: [0, 2, 0] }), ball(0.25, 2, [1, 0.25, 0], { v: [0, 0, 0.5], w: [10, 0, 0] })],
        laws: [['place after 4 s, m', (run) => { const W = 4 / 7, a = W * 4; return norm(sub(run.end[1].x, [1 + 0.5 / W * (1 - Math.cos(a)), 0.25, 0.5 / W * Math.sin(a)])); }]] },
    { name: 'leaning wheel', world: 7, gravity: earth, e: 0, mu: 2, seconds: 4, planes: [floor],
        bodies: [{ kind: 'hoop', size: [0.5], mass: 1.2, x: [0, 0.483194989067, 12], v: [3.95173492912, 0, 0], q: [0.991561893715, -0.12963414262, 0, 0], w: [0, 0.318243085979, -7.90346985824] }],
        laws: [['place after 4 s, m', (run) => { const a = 3.95173492912 / 3; return norm(sub(run.end[0].x, [12 * Math.sin(a), 0.483194989067, 12 * Math.cos(a)])); }]] },
    heap(25), heap(50), heap(100), heap(200),
];
