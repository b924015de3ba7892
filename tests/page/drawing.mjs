// The impulses of contacts are seen though the bodies are before them, and a frame compiles no program of the GPU.
import assert from 'node:assert/strict';
import { Browser } from './browser.mjs';
import { url } from './command.mjs';

const browser = await Browser.open(url);
for (const scene of ['contacts/stack', 'contacts/pyramid']) {
    const { green, programs } = await browser.run(async scene => {
        await tumble.openShipped(`${scene}.toml`);
        tumble.removeGhost(1);  // it is before them, and blue
        tumble.seek(2);
        tumble.finish();
        const { view } = tumble, gl = view.renderer.getContext(), { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
        const newest = () => Math.max(...view.renderer.info.programs.map(program => program.id));
        view.draw();
        const before = newest(), pixels = new Uint8Array(4 * width * height);
        for (let i = 0; i < 3; ++i) view.draw();
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        let green = 0;
        for (let i = 0; i < pixels.length; i += 4) green += pixels[i] < 140 && pixels[i + 1] > 200 && pixels[i + 2] < 140;
        return { green, programs: newest() - before };
    }, scene);
    assert.ok(green > 20, `${scene}: ${green} pixels of the arrows of contacts`);
    assert.equal(programs, 0, `${scene}: programs that a frame compiled`);
}
assert.deepEqual(browser.errors, []);
await browser.close();
