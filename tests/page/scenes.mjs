// Every shipped scene opens, and 300 steps of three methods in each number system of the page end at the hash of
// `tumble run`; nothing is written to the console.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Browser } from './browser.mjs';
import { directory, tumble, url } from './command.mjs';

const steps = 300;
const methods = ['verlet', 'rk4', 'explicit_euler'];
const systems = [['q32', true], ['f32', false], ['f64', false]];

const browser = await Browser.open(url);
let compared = 0;
const used = new Set();
for (const [name, toml] of await browser.value('[...tumble.shipped]')) {
    const ways = methods.flatMap(
        integrator => systems.map(([numbers, carry]) => ({ integrator, numbers, carry, halvings: 0 })));
    const { step, hashes } = await browser.run(async (name, ways, steps) => {
        await tumble.openShipped(name);
        tumble.seek(steps);
        tumble.finish();
        const engine = await Engine.open(tumble.module, tumble.shipped.get(name), name);
        const hashes = ways.map(way => {
            if (engine.obstacle(way) !== '') return null;
            engine.removeRuns();
            engine.addRun(way);
            engine.goTo(0, steps, 1e6);
            return engine.hash(0);
        });
        return { step: engine.scene.step_s, hashes };
    }, name, ways, steps);
    assert.ok(hashes.some(hash => hash), `${name} runs in no way of the page`);
    const file = join(directory, name.replace('/', '_'));
    // A copy that lasts longer than 300 steps: the scene ends where it wants to, and forces last as long as they do.
    writeFileSync(file, toml.replace(/^duration *= *[0-9.e+-]+/m, `duration = ${Math.max(100, 2 * steps * step)}`));
    ways.forEach(({ integrator, numbers, carry }, i) => {
        if (!hashes[i]) return;
        const { status, out, err } = tumble('run', file, '--duration', `${steps * step}`, '--integrator', integrator,
            '--numbers', numbers, '--carry', carry ? 'on' : 'off', '--check', 'off', '--json');
        const run = out === '' ? assert.fail(`${name}: status ${status}: ${err}`) : JSON.parse(out);
        if (run.steps !== steps) return;  // it left its range
        assert.equal(hashes[i], run.state_hash, `${name}, ${integrator} in ${numbers}`);
        ++compared;
        used.add(numbers);
    });
}
assert.deepEqual(browser.errors, []);
assert.equal(used.size, systems.length);
assert.ok(compared > 200, `${compared} runs were compared`);
console.log(`${compared} runs agree`);
await browser.close();
