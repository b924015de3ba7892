// Joints are drawn where both of their sides are, until they break; a click on a jointed body pushes it, and the session
// replays to the hash of the command.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Browser } from './browser.mjs';
import { directory, tumble, url } from './command.mjs';

const body = (name, position, orientation) => `[[body]]\nname = "${name}"\nshape = { box = [0.4, 0.1, 0.2] }\nmass = 1
position = [${position}]\norientation = [${orientation}]\n`;
const joint = (kind, body, to, more) =>
    `[[joint]]\nname = "${body} joint"\nkind = "${kind}"\nbody = "${body}"\n${to ? `to_body = "${to}"\n` : ''}${more}\n`;
// Each kind of joint, between bodies that are turned; the rope is slack at first, and at last all break.
const kinds = `[world]\ngravity = [0.0, -9.81, 0.0]\nstep = "1/512"\nduration = 8.0
[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0
${[['post', [0, 0, 0], [0.8, 0.6, 0, 0]], ['arm', [0.5, 0, 0], [0.8, 0, 0, 0.6]], ['rod', [1, 0, 0.1], [0.6, 0, 0.8, 0]],
   ['cross', [0, 0, 0.6], [0.6, 0, -0.8, 0]], ['cart', [0, 1, 0], [0.8, 0.36, 0.48, 0]], ['bob', [0.3, 0.5, 0], [1, 0, 0, 0]],
   ['yoke', [0, 0, -0.6], [0.6, 0.8, 0, 0]]].map(b => body(...b)).join('')}
${joint('fixed', 'post', '', 'anchor = [0, 0.1, 0]')}
${joint('hinge', 'arm', 'post', 'anchor = [0.25, 0, 0]\naxis = [0.5, 0.2, 1]')}
${joint('ball', 'rod', 'arm', 'anchor = [0.75, 0, 0.1]')}
${joint('universal', 'cross', 'post', 'anchor = [0, 0, 0.3]\naxis = [1, 1, 0]\nto_axis = [1, -1, 0]')}
${joint('slider', 'cart', '', 'anchor = [0, 1, 0.1]\naxis = [1, -0.3, 0]\nlimits = [-0.2, 0.4]')}
${joint('distance', 'bob', 'cart', 'point = [0.3, 0.5, 0.1]\nto_point = [0, 0.9, 0]\nmost = 0.8')}
${joint('universal', 'yoke', '', 'anchor = [0, 0, -0.4]\naxis = [1, 0, 0]\nto_axis = [0, 1, 0]')}
${['post', 'arm', 'rod', 'cross', 'cart', 'bob', 'yoke'].map(
    name => `[[event]]\ntime = 2.0\nkind = "break_joint"\njoint = "${name} joint"\n`).join('')}`;

const browser = await Browser.open(url);
assert.equal(await browser.run(toml => tumble.open(toml, 'kinds.toml'), kinds), true);

// At a step: of each object of a joint whether it is seen, its colour, the distances of its places from those of the two
// sides, m, and the angle to its axis on each side, rad. The sides are moved here from the start by their bodies alone.
const objects = step => browser.run(step => {
    const { view, game } = tumble, { engine } = game, move = to => { tumble.seek(to); tumble.finish(); view.draw(); };
    const pose = (state, i) => i < 0 ? { position: [0, 0, 0], orientation: [1, 0, 0, 0] } : new BodyState(state, i);
    move(0);
    const start = game.state(game.played);
    move(step);
    const now = game.state(game.played);
    view.world.updateMatrixWorld();
    const way = (i, of) => turned(pose(now, i).orientation, turned(conjugate(pose(start, i).orientation), of));
    const place = (i, at) => add([...pose(now, i).position], way(i, subtract(at, [...pose(start, i).position])));
    const angle = (a, b) => Math.atan2(norm(cross(a, b)), Math.abs(dot(a, b)));
    return engine.scene.joints.flatMap(({ kind, body, to_body, point, to, axis, to_axis }, j) =>
        view.joints[j].map((object, k) => {
            const numbers = object.geometry.attributes.position, points = Array.from({ length: numbers.count }, (_, i) =>
                object.localToWorld(new THREE.Vector3().fromBufferAttribute(numbers, i)).toArray());
            const told = { kind, visible: object.visible, colour: object.material.color.getHex() };
            const apart = (at, side, of) => norm(subtract(at, place(side, of)));
            if (object.isLine) return { ...told, apart: [apart(points[0], body, point), apart(points[1], to_body, to)] };
            object.geometry.computeBoundingBox();
            const centre = object.localToWorld(object.geometry.boundingBox.getCenter(new THREE.Vector3())).toArray();
            told.apart = [[body, point], [to_body, to]].map(([side, of]) => apart(centre, side, of));
            if (kind === 'slider') told.apart.pop();  // the pin moves along with the body
            const [own, other] = k === 0 ? [[body, axis], [to_body, axis]] : [[to_body, to_axis], [body, axis]];
            if (norm(own[1]) === 0) return told;
            const along = way(...own), long = points.map(p => subtract(p, centre))
                .reduce((sum, p) => add(sum, scale(p, Math.sign(dot(p, along)))), [0, 0, 0]);
            told.lean = [angle(long, along)];
            if (kind !== 'universal') told.lean.push(angle(long, way(...other)));
            else if (k === 1) told.lean.push(Math.PI / 2 - angle(long, way(...other)));  // the axes stay perpendicular
            return told;
        }));
}, step);
for (const step of [0, 60, 700]) {
    const told = await objects(step);
    assert.deepEqual(told.map(o => o.kind), ['fixed', 'hinge', 'ball', 'universal', 'universal', 'slider', 'distance',
                                             'universal', 'universal']);
    for (const { kind, visible, apart, lean } of told) {
        assert.ok(visible, `${kind} at step ${step} is seen`);
        for (const m of apart) assert.ok(m < 1e-4, `${kind} at step ${step} is ${m} m off`);
        for (const rad of lean ?? []) assert.ok(rad < 1e-3, `${kind} at step ${step} leans by ${rad} rad`);
    }
}
const colours = [];
for (const step of [1, 700]) colours.push((await objects(step)).find(o => o.kind === 'distance').colour);
assert.deepEqual(colours, await browser.value('[View.slack, View.joint]'), 'a rope is slack, and then taut');
assert.ok((await objects(1030)).every(o => !o.visible), 'joints that broke are not seen');

// Pins are seen.
const pixels = hidden => browser.run(async hidden => {
    await tumble.openShipped('joints/chain.toml');
    tumble.removeGhost(1);
    tumble.seek(120);
    tumble.finish();
    const { view } = tumble, gl = view.renderer.getContext(), { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    if (hidden) for (const object of view.joints.flat()) object.parent.remove(object);
    view.draw();
    view.aim();
    view.draw();
    const colours = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, colours);
    let grey = 0;
    for (let i = 0; i < colours.length; i += 4) {
        const [r, g, b] = colours.subarray(i, i + 3);
        grey += r > 110 && Math.abs(r - g) < 12 && Math.abs(g - b) < 12;
    }
    return grey;
}, hidden);
const seen = await pixels(false), rest = await pixels(true);
assert.ok(seen > rest + 200, `${seen} pixels with the joints of a chain, ${rest} without`);

// Where a point of an object is drawn, in pixels of the window.
await browser.value(`window.drawn = (object, point) => {
    const { view } = tumble, box = view.renderer.domElement.getBoundingClientRect();
    for (let i = 0; i < 2; ++i, view.aim(false)) view.draw();
    const at = object.localToWorld(point.clone()).project(view.camera);
    return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
}, 0`);
await browser.run(toml => tumble.open(toml, 'kinds.toml'), kinds);
const onPin = await browser.run(() => {
    tumble.seek(100);
    tumble.finish();
    const pin = tumble.view.joints[1][0], { attributes, boundingSphere } = pin.geometry;
    const end = new THREE.Vector3().fromBufferAttribute(attributes.position, 0).lerp(boundingSphere.center, 0.1);
    return tumble.engine.scene.bodies[tumble.view.pick(...drawn(pin, end)).body].name;
});
assert.equal(onPin, 'arm', 'a click on a pin is one on its body');

let clicks = 0;
for (const name of ['double_pendulum', 'gyroscope', 'chain', 'arm']) {
    await browser.run(name => tumble.openShipped(`joints/${name}.toml`), name);
    const bodies = await browser.value('tumble.engine.scene.bodies.length');
    for (const [i, step] of [20, 45, 80, 140].entries()) {
        // The middle of a body, but of a ring a point of its tube.
        const [x, y, before] = await browser.run((body, step) => {
            tumble.seek(step);
            tumble.finish();
            const group = tumble.view.lanes[0].children[body], { position } = group.children[0].geometry.attributes;
            const isRing = tumble.engine.scene.bodies[body].shape === 'hoop', point = new THREE.Vector3();
            return [...drawn(group, isRing ? point.fromBufferAttribute(position, 0) : point), tumble.game.hits.length];
        }, i % bodies, step);
        await browser.drag(x, y, x + 30, y + 10);
        await browser.value('new Promise(requestAnimationFrame)');
        clicks += await browser.value('tumble.game.hits.length') - before;
    }
    const { toml, hash } = await browser.run(() => {
        tumble.seek(240);
        tumble.finish();
        return { toml: tumble.text(), hash: tumble.engine.hash(0) };
    });
    const file = join(directory, `${name}.toml`);
    writeFileSync(file, toml);
    const { status, out, err } = tumble('run', file, '--check', 'off', '--json');
    assert.equal(status, 0, `${name}: ${err}`);
    assert.equal(JSON.parse(out).state_hash, hash, name);
}
assert.ok(clicks >= 12, `${clicks} clicks of 16 hit`);
assert.deepEqual(browser.errors, []);
console.log(`${seen - rest} pixels of joints, ${clicks} clicks hit`);
await browser.close();
