// On a phone: the panel stands below the scene and is as wide as the window, its plots too, controls are large enough for a
// finger, and a touch pushes a body.
import assert from 'node:assert/strict';
import { Browser, wait } from './browser.mjs';
import { url } from './command.mjs';

const finger = 40;  // px, the least height of a control

const browser = await Browser.open(url, { width: 390, height: 844 });
await browser.page('Emulation.setTouchEmulationEnabled', { enabled: true });
await browser.run(async () => {
    await tumble.openShipped('ball.toml');
    tumble.pause(true);
});

const isHintShown = () => browser.value(`document.getElementById('hint').getClientRects().length > 0`);
assert.ok(await isHintShown(), 'the page says what a touch does');
const box = await browser.value(`document.getElementById('view').getBoundingClientRect().toJSON()`);
await browser.value('tumble.view.draw(), tumble.view.aim(), tumble.view.draw()');
await browser.touch(box.left + box.width / 2, box.top + box.height / 2);
for (let i = 0; await browser.value('tumble.game.hits.length') === 0; ++i) {
    assert.ok(i < 200, 'a touch pushes the ball');
    await wait(20);
}
assert.ok(!await isHintShown(), 'who has pushed a body knows how');

await browser.run(async () => {
    await tumble.openShipped('contacts/stack.toml');
    document.getElementById('more').click();
    for (const part of document.querySelectorAll('details')) part.open = true;
    tumble.seek(20);
    tumble.finish();
});
await wait(1000);
const { scene, panel, window, scrolled, small, plots } = await browser.run(finger => {
    const at = selector => document.querySelector(selector).getBoundingClientRect().toJSON();
    const isSmall = e => e.getClientRects().length > 0 && e.getBoundingClientRect().height < finger;
    return {
        scene: at('main'), panel: at('aside'), window: innerWidth,
        scrolled: document.querySelector('aside').scrollWidth,
        small: [...document.querySelectorAll('button, select, .button')].filter(isSmall).map(e => e.id || e.title || e.textContent),
        plots: [...document.querySelectorAll('.plot:not([hidden])')].map(
            plot => [plot.clientWidth, plot.clientHeight, plot.querySelector('canvas').clientWidth]),
    };
}, finger);
assert.ok(scene.height > 200 && scene.bottom <= panel.top, `the scene ends at ${scene.bottom} px, the panel begins at ${panel.top}`);
assert.ok(panel.width === window && scrolled === window, `the panel has ${scrolled} px of ${window}`);
assert.deepEqual(small, [], `controls lower than ${finger} px`);
assert.ok(plots.length >= 3);
for (const [width, height, drawn] of plots)
    assert.ok(width > 300 && width <= window && height < 150 && drawn === width, `a plot of ${width} x ${height}, drawn ${drawn} wide`);
assert.deepEqual(browser.errors, []);
await browser.close();
