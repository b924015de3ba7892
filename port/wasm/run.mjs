// Runs a module with WASI under node: run.mjs MODULE. The module has standard output, a clock and an exit, but no files,
// arguments, environment or network. The status is the module's. A trap prints a message to standard output and ends
// with status 128.
import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';

const wasi = new WASI({ version: 'preview1', returnOnExit: true });
const bytes = await readFile(process.argv[2]);
const { instance } = await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: wasi.wasiImport });
try {
    process.exitCode = wasi.start(instance);
} catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError || error instanceof RangeError)) throw error;
    // The stack grows down to address 0, and what is below wraps to the end of the address space.
    const overflow = error instanceof RangeError || instance.exports.__stack_pointer.value < 0;
    process.stdout.write(`fault: ${error.message}${overflow ? ', stack overflow' : ''}\n`);
    process.exitCode = 128;
}
