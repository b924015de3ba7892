// The command `tumble`, for the tests of the page. Arguments of every test: the page, the command, a directory to write to.
import { spawnSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [page, command, directory] = process.argv.slice(2).map(path => resolve(path));
mkdirSync(directory, { recursive: true });

export const url = pathToFileURL(page).href;
export { directory, page };

// { status, out, err } of a call of the command.
export const tumble = (...words) => {
    const { status, stdout, stderr, error } = spawnSync(command, words, { encoding: 'utf8', maxBuffer: 1 << 28 });
    if (error) throw error;
    return { status, out: stdout, err: stderr };
};
