// What a player does is saved as a scene that the command and a core replay to the page's hash; scrubbing does not change
// it, a hit in the past branches, and a saved session goes on bit for bit.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Browser, wait } from './browser.mjs';
import { directory, tumble, url } from './command.mjs';

const browser = await Browser.open(url);
const now = () => browser.value('tumble.game.now');
const hits = () => browser.value('tumble.game.hits.length');
const hash = () => browser.value('tumble.finish(), tumble.engine.hash(0)');
const seek = step => browser.run(step => { tumble.seek(step); tumble.finish(); }, step);
// Presses a key; the hit is there when the next frame is drawn.
const push = async (key, how) => {
    const before = await hits();
    await browser.key(key, how);
    for (let i = 0; await hits() === before; ++i) {
        assert.ok(i < 200, `no hit by ${key}`);
        await wait(10);
    }
};

await browser.run(() => tumble.openShipped('cube.toml'));
await browser.value('tumble.pause(true)');
const own = await hits();
await seek(40);
await push('ArrowRight');
await push('w', { shift: true });
await push('4');
await browser.key(' ');  // goes on
const begun = await now();
while (await now() < begun + 60) await wait(20);
await browser.key(' ');  // pauses
const paused = await now();
await wait(200);
assert.equal(await now(), paused, 'time passes while the game is paused');
await browser.key('.');
assert.equal(await browser.value('tumble.finish(), tumble.game.now'), paused + 1, 'one step');

// A click on the body: where it is drawn.
const [x, y] = await browser.value(`(() => {
    tumble.view.draw();
    const { position } = new BodyState(tumble.game.state(tumble.game.played), 0);
    const at = new THREE.Vector3(...position).project(tumble.view.camera);
    const box = document.getElementById('view').getBoundingClientRect();
    return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
})()`);
const before = await hits();
await browser.drag(x, y);
assert.equal(await hits(), before + 1, 'a click hits');
await browser.drag(x, y, x + 60, y + 20);
assert.equal(await hits(), before + 2, 'a pull hits');
const strengths = await browser.value('tumble.game.hits.slice(-2).map(hit => norm(hit.impulse))');
assert.ok(strengths[1] > 2 * strengths[0], 'a longer pull is stronger');

// Back and forth.
await seek(400);
const end = await hash();
for (const step of [100, 399, 0, 250, 400]) await seek(step);
assert.equal(await hash(), end, 'the hash after scrubbing is the hash without');
const replayed = await browser.run(async steps => {
    const engine = await Engine.open(tumble.module, tumble.text(), 'saved.toml');
    engine.addRun(engine.scene.saved_way);
    engine.goTo(0, steps, 1e6);
    return engine.hash(0);
}, 400);
assert.equal(replayed, end, 'a saved session replays');

// A hit in the past forgets those after it.
await seek(60);
await push('PageUp');
assert.ok(await hits() < before + 2 && await hits() >= own + 1, 'the future is forgotten');
await seek(500);
const branched = await hash();
assert.notEqual(branched, end);

// The command and a core.
const toml = await browser.value('tumble.text()'), file = join(directory, await browser.value('tumble.fileName'));
writeFileSync(file, toml);
const run = tumble('run', file, '--json');
assert.equal(run.status, 0, run.err);
assert.equal(JSON.parse(run.out).state_hash, branched);
const compared = tumble('compare', file, '--core', 'cortex-m0');
assert.equal(compared.status, 0, compared.out + compared.err);
assert.match(compared.out, new RegExp(`hash ${branched}`));

// Dropped again, it goes on.
await seek(500);
await push('ArrowLeft');
await seek(600);
const unbroken = await hash();
await browser.run((toml, name) => tumble.open(toml, name), toml, 'dropped.toml');
assert.equal(await browser.value('tumble.finish(), tumble.game.now'), 500, 'it begins where it was saved');
await browser.value('tumble.pause(true)');
await push('ArrowLeft');
await seek(600);
assert.equal(await hash(), unbroken, 'a saved session goes on bit for bit');

// Saved twice, in another method.
await browser.run(() => tumble.changeWay(0, { integrator: 'rk4', numbers: 'f64', carry: false }));
const other = await hash();
writeFileSync(file, await browser.value('tumble.text()'));
const again = tumble('run', file, '--json');
assert.equal(again.status, 0, again.err);
assert.equal(JSON.parse(again.out).state_hash, other);
assert.equal(JSON.parse(again.out).integrator, 'rk4');

assert.deepEqual(browser.errors, []);
console.log(`${await hits()} hits, ${branched}`);
await browser.close();
