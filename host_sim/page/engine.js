// The kernel in WebAssembly, as engine.cpp exports it. An Engine holds one scene and its runs. After an error it is
// dead: of no more use.
class Engine {
    static async compiled(base64) {
        const bytes = Uint8Array.from(atob(base64), c => c.charCodeAt(0));
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
        return WebAssembly.compile(await new Response(stream).arrayBuffer());
    }

    // A scene from its text; `name` stands for the file in messages.
    static async open(module, toml, name) {
        const engine = new Engine();
        const raise = (text, size) => { throw new Error(engine.#decoded(text, size)); };
        // The C library asks for an environment and for files, of which there are none.
        const none = new Proxy({}, { get: (_, call) => () => call.startsWith('environ') ? 0 : 8 });
        const instance = await WebAssembly.instantiate(module, { page: { raise }, wasi_snapshot_preview1: none });
        engine.#kernel = instance.exports;
        engine.#kernel._initialize();
        engine.integrators = JSON.parse(engine.#text('integrator_names'));
        engine.scene = JSON.parse(engine.#text('open', toml, name));
        return engine;
    }

    // Why the scene cannot be run so; empty where it can. A way: integrator, numbers, carry, halvings of the step.
    obstacle(way) { return this.#text('obstacle', way.integrator, way.numbers, way.carry ? 1 : 0, way.halvings); }
    addRun(way) { return this.#call('add_run', way.integrator, way.numbers, way.carry ? 1 : 0, way.halvings); }
    removeRuns() { this.#call('remove_runs'); }

    // Takes at most `most` steps towards the start of a step of the scene. True where the run is there.
    goTo(run, step, most) { return this.#call('go_to', run, step, most) === 1; }
    // The step in which it acts. impulse, N s, and point, m, in the body's axes, or impulse in the world's.
    hit(body, inBody, impulse, point) { return this.#call('hit', body, inBody ? 1 : 0, ...impulse, ...point); }
    hits() { return JSON.parse(this.#text('hits')); }
    saved() { return this.#text('saved'); }
    hash(run) { return this.#text('hash', run); }
    troubles(run) { return JSON.parse(this.#text('troubles', run)); }

    // position, velocity, orientation, spin, asleep, contacts of each body; then energies and angular momentum.
    state(run) {
        const address = this.#call('state', run), count = Engine.numbersOfBody * this.scene.bodies.length + 5;
        return new Float64Array(this.#kernel.memory.buffer, address, count).slice();
    }
    static numbersOfBody = 15;

    contacts(run) {
        const address = this.#call('contacts', run), [count] = new Float64Array(this.#kernel.memory.buffer, address, 1);
        const all = new Float64Array(this.#kernel.memory.buffer, address + 8, 10 * count).slice();
        return Array.from({ length: count }, (_, i) => {
            const c = all.subarray(10 * i, 10 * i + 10);
            return { normal: c.subarray(0, 3), point: c.subarray(3, 6), normalImpulse: c[6],
                     frictionImpulse: c.subarray(7, 10) };
        });
    }

    // What each joint of the scene does: 2, it holds; 1, it is a rope that is slack; 0, it is broken or removed.
    joints(run) {
        const address = this.#call('joints', run);
        return new Float64Array(this.#kernel.memory.buffer, address, this.scene.joints.length).slice();
    }

    isDead = false;
    #kernel;
    #decoded(address, size) { return new TextDecoder().decode(new Uint8Array(this.#kernel.memory.buffer, address, size)); }
    // Texts become an address and a size.
    #call(name, ...values) {
        if (this.isDead) throw new Error('the engine has ended with an error');
        try {
            return this.#called(name, ...values);
        } catch (error) {
            this.isDead = true;
            throw error;
        }
    }
    #called(name, ...values) {
        const texts = [], plain = [];
        for (const value of values) {
            if (typeof value !== 'string') { plain.push(value); continue; }
            const bytes = new TextEncoder().encode(value), address = this.#kernel.allocate(bytes.length + 1);
            new Uint8Array(this.#kernel.memory.buffer, address, bytes.length).set(bytes);
            texts.push(address);
            plain.push(address, bytes.length);
        }
        const result = this.#kernel[name](...plain);
        for (const address of texts) this.#kernel.release(address);
        return result;
    }
    #text(name, ...values) {
        const address = this.#call(name, ...values), memory = new Uint8Array(this.#kernel.memory.buffer);
        return this.#decoded(address, memory.indexOf(0, address) - address);
    }
}
