// Draws the pictures of the front page: pictures.mjs PAGE COMMAND DIRECTORY.
import { statSync } from 'node:fs';
import { join } from 'node:path';
import { Browser } from './browser.mjs';
import { directory, url } from './command.mjs';

// The scene, the step at which it is drawn, and whether explicit Euler's ghost is beside it.
const pictures = [['cube', 400, true], ['contacts/drop', 150, false], ['contacts/pyramid', 60, false],
                  ['contacts/cradle', 330, false], ['contacts/kinematic', 260, false], ['pendulum', 420, true]];
const largest = 40000;  // bytes

const browser = await Browser.open(`${url}#smooth`, { width: 480, height: 320 });
await browser.value(`document.body.classList.add('picture')`);
for (const [name, step, hasGhost] of pictures) {
    await browser.run(async (name, step, hasGhost) => {
        await tumble.openShipped(`${name}.toml`);
        if (!hasGhost) tumble.removeGhost(1);
        tumble.seek(step);
        tumble.finish();
        tumble.view.draw();
        tumble.view.aim(false);
        tumble.view.draw();
        await new Promise(requestAnimationFrame);
        await new Promise(requestAnimationFrame);
    }, name, step, hasGhost);
    const file = join(directory, `${name.replace(/.*\//, '')}.png`);
    await browser.picture(file);
    const { size } = statSync(file);
    console.log(`${file}: ${size} bytes`);
    if (size > largest) process.exitCode = 1;
}
await browser.close();
