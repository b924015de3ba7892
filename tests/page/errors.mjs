// A malformed scene is answered as in the terminal, and what was open stays. A scene that leaves its range says which body
// and when, and the page goes on.
import assert from 'node:assert/strict';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser, wait } from './browser.mjs';
import { directory, page, tumble, url } from './command.mjs';

assert.ok(statSync(page).size < 6.5e6, `the page has ${statSync(page).size} bytes`);
assert.ok(!/<(script|link|img|iframe)[^>]*(src|href)=/.test(readFileSync(page, 'latin1')), 'the page loads something');

const browser = await Browser.open(url);
const message = () => browser.value(`document.getElementById('message').textContent`);
const scene = (world, body) => `[world]\nstep = 0.01\nduration = 10.0\n${world}\n[[body]]\nname = "stone"\n${body}\n`;
const stone = 'shape = { sphere = 0.1 }\nmass = 1.0';
for (const [toml, told] of [
    [scene('gravty = [0, -9.81, 0]', stone), /bad\.toml:4: world\.gravty: unknown key \(did you mean "gravity"\?\), expected/],
    [scene('', 'shape = { sphere = -0.1 }\nmass = 1.0'),
     /bad\.toml:7: body\[0\]\.shape\.sphere: got -0\.1, expected a positive finite number/],
    [scene('', 'mass = '), /bad\.toml:7: TOML syntax: /],
    ['', /bad\.toml:1: world: missing, expected the table \[world\]/],
]) {
    assert.equal(await browser.run(toml => tumble.open(toml, 'bad.toml'), toml), false);
    assert.match(await message(), told);
    // The same words as the command's.
    const file = join(directory, 'bad.toml');
    writeFileSync(file, toml);
    assert.equal(await message(), tumble('run', file).err.trim().replace(file, 'bad.toml'));
    const now = await browser.value('tumble.game.now');
    for (let i = 0; await browser.value('tumble.game.now') === now; ++i) {
        assert.ok(i < 200, 'the scene that was open goes on');
        await wait(20);
        await browser.value('tumble.pause(false)');
    }
}

const falls = scene('gravity = [0, -90.0, 0]', `${stone}\nvelocity = [0.0, -100.0, 0.0]`);
assert.equal(await browser.run(toml => tumble.open(toml, 'falls.toml'), falls), true);
for (let i = 0; !await browser.value('tumble.paused'); ++i) {
    assert.ok(i < 500, 'a body that leaves the range pauses the game');
    await wait(20);
}
assert.match(await message(), /range_left: stone at 1\.1[0-9]* s: velocity exceeds [0-9.]+ m\/s/);
// `tumble view` writes a page that begins with another scene; what is wrong with the scene is told in the terminal.
const file = join(directory, 'a "stone".toml'), shown = join(directory, 'shown.html');
writeFileSync(file, scene('', stone).replace('stone', 'pebble'));
assert.equal(tumble('view', file, '--output', shown).status, 0);
assert.equal(tumble('view', join(directory, 'bad.toml'), '--output', shown).status, 2);
const other = await Browser.open(pathToFileURL(shown).href);
assert.deepEqual(await other.value('[tumble.name, tumble.engine.scene.bodies[0].name]'), ['a "stone".toml', 'pebble']);
await other.close();

// Without a reference, frames go on: where a scene has events of control, and where the player wants none.
const goesOn = async why => {
    await browser.value('tumble.pause(false)');
    const now = await browser.value('tumble.game.now');
    for (let i = 0; await browser.value('tumble.game.now') <= now + 2; ++i) {
        assert.ok(i < 200, why);
        await wait(20);
    }
};
const driven = `${scene('', stone)}[[event]]\ntime = 0.05\nkind = "velocity"\nbody = "stone"\nvalue = [1, 0, 0]\n`;
assert.equal(await browser.run(toml => tumble.open(toml, 'driven.toml'), driven), true);
await goesOn('a scene with events goes on');
await browser.value(`tumble.openShipped('cube.toml')`);
await browser.value(`document.getElementById('reference').click()`);
await goesOn('a game without a reference goes on');
await browser.value(`document.getElementById('reference').click()`);

// A key is a push, also after something was chosen; a pull over which a scene is opened is forgotten.
await browser.value(`(() => {
    const list = document.getElementById('scene');
    list.focus();
    list.value = 'brick.toml';
    list.dispatchEvent(new Event('change', { bubbles: true }));
})()`);
await wait(500);
await browser.key('ArrowRight');
await wait(200);
assert.deepEqual(await browser.value('[tumble.name, tumble.game.hits.length]'), ['brick.toml', 1]);
await browser.run(() => {
    tumble.controls.pull = { body: 0, point: [0, 0, 0], normal: [1, 0, 0], strength: 1 };
    return tumble.openShipped('ball.toml');
});
assert.equal(await browser.value('tumble.controls.pull'), undefined);

// A session beyond the range is not saved, one before it is.
await browser.run(toml => tumble.open(toml, 'falls.toml'), falls);
await browser.run(() => { tumble.seek(150); tumble.finish(); tumble.save(); });
assert.match(await message(), /range_left: stone.*Go back to before it to save the session/);
await browser.run(() => { tumble.seek(50); tumble.finish(); tumble.save(); });
assert.match(await message(), /saved falls_session\.toml/);

// A body of another session is still pushed.
await browser.value('tumble.openShipped("ball.toml")');
await wait(300);
assert.ok(await browser.value('tumble.game.now') > 0);
assert.deepEqual(browser.errors, []);
await browser.close();
