// The page: opens scenes, lets time pass, and turns what the user does into hits and runs.
class App {
    static frameBudget = 11;  // ms of each frame for steps, of 16.7
    static plotInterval = 250;  // ms between drawings of the plots

    async start() {
        this.speed = 1;
        this.push = 1;  // m/s: what a hit of strength 1 changes the velocity by
        this.paused = true;
        const scenes = [...document.querySelectorAll('script.scene')];
        this.shipped = new Map(scenes.map(scene => [scene.dataset.name, scene.textContent.replace(/^\n/, '')]));
        this.module = await Engine.compiled(document.getElementById('engine').textContent);
        this.view = new View(document.getElementById('view'));
        this.plots = new Plots(document.getElementById('plots'));
        this.panel = new Panel(this, new Costs(JSON.parse(document.getElementById('costs_data').textContent)));
        this.panel.listScenes([...this.shipped.keys()]);
        this.controls = new Controls(this, document.getElementById('view'));
        addEventListener('resize', () => this.plots.resize());
        addEventListener('error', event => this.panel.tell(event.message, true));
        addEventListener('unhandledrejection', event => this.panel.tell(event.reason.message, true));
        const first = document.querySelector('script.scene[data-first]')?.dataset.name ?? 'cube.toml';
        await this.openShipped(first);
        requestAnimationFrame(time => this.#frame(time));
    }

    openShipped(name) { return this.open(this.shipped.get(name), name); }
    async openFile(file) {
        if (!file) return;
        if (file.size > 32e6) this.panel.tell(`${file.name}: larger than 32 MB, expected a scene file (TOML)`, true);
        else await this.open(await file.text(), file.name);
    }
    // Opens a scene or a saved session. Where it has an error, what was open stays.
    async open(toml, name) {
        const opening = this.opening = {};
        let engine;
        try {
            engine = await Engine.open(this.module, toml, name);
        } catch (error) {
            this.panel.tell(error.message, true);
            return false;
        }
        if (opening !== this.opening) return false;  // another was opened meanwhile
        const { scene } = engine, saved = scene.saved_way;
        // Every scene runs in f64.
        const played = engine.obstacle(saved) === '' ? saved : { ...saved, numbers: 'f64', carry: false };
        this.engine = engine;
        this.name = name;
        this.toml = toml;
        const euler = { ...played, integrator: 'explicit_euler' };
        this.ways = played.integrator === 'explicit_euler' ? [played] : [played, euler];
        this.body = Math.max(0, scene.bodies.findIndex(body => !body.fixed));
        this.panel.showScene(name, toml);
        const notes = played === saved ? [] : [engine.obstacle(saved), 'It runs in f64 here.'];
        this.panel.tell([...scene.warnings, ...notes].join('\n'));
        this.#begin(scene.saved_steps, false);
        this.pause(scene.saved_steps > 0);
        return true;
    }

    // The same scene and hits with other runs, at the same time.
    restart() {
        const { furthest } = this.game;
        this.#begin(this.game.target, true);
        this.game.furthest = furthest;
    }
    changeWay(index, change) {
        const way = { ...this.ways[index], ...change }, obstacle = this.engine.obstacle(way);
        if (obstacle === '') this.ways[index] = way;
        this.panel.tell(obstacle, obstacle !== '');
        this.restart();
    }
    addGhost() {
        this.ways.push({ ...this.ways[0], integrator: 'semi_implicit_euler' });
        this.restart();
    }
    removeGhost(index) {
        this.ways.splice(index, 1);
        this.restart();
    }

    pause(paused) {
        this.paused = paused;
        this.dueSteps = 0;
    }
    step(count) { this.seek(this.game.target + count); }
    seek(step) {
        this.pause(true);
        this.game.target = Math.max(0, step);
    }
    // Takes all steps that are wanted, and those of the references; for tests.
    finish() { this.game.finish(); }

    nextBody() {
        const { bodies } = this.engine.scene;
        for (let i = 1; i <= bodies.length; ++i) {
            const body = (this.body + i) % bodies.length;
            if (!bodies[body].fixed) return void (this.body = body);
        }
    }
    pick(x, y) {
        const picked = this.view.pick(x, y);
        if (!picked || this.engine.scene.bodies[picked.body].fixed) return undefined;
        this.body = picked.body;
        return picked;
    }
    preview(pull) { this.view.preview(pull && { ...pull, direction: scale(pull.normal, -1) }); }

    // Pushes the face of a box that meets a direction on the screen, any other body at its centre.
    pushTowards(onScreen, strength) {
        const direction = this.view.direction(onScreen), body = this.engine.scene.bodies[this.body];
        if (body.shape !== 'box') return this.#hit(false, scale(direction, this.#impulse(strength)), [0, 0, 0]);
        const { orientation } = new BodyState(this.game.state(this.game.played), this.body);
        const inBody = turned(conjugate(orientation), direction);
        const axis = [0, 1, 2].reduce((best, i) => Math.abs(inBody[i]) > Math.abs(inBody[best]) ? i : best, 0);
        return this.pushFace(axis, -Math.sign(inBody[axis]), strength);
    }
    // Pushes a face of a box inwards at its centre; of another body, along its axis at its centre.
    pushFace(axis, side, strength) {
        const body = this.engine.scene.bodies[this.body], impulse = [0, 0, 0], point = [0, 0, 0];
        impulse[axis] = -side * this.#impulse(strength);
        if (body.shape === 'box') point[axis] = side * body.size[axis] / 2;
        this.#hit(!body.point_mass, impulse, point);
    }
    // Pushes a body inwards at a point of its surface.
    pushAt({ body, point, normal }, strength) {
        this.body = body;
        const { shape, point_mass } = this.engine.scene.bodies[body];
        const outward = shape === 'sphere' ? scale(point, 1 / norm(point)) : normal;
        const impulse = scale(outward, -this.#impulse(strength)), digits = x => Number(x.toFixed(5));
        this.#hit(!point_mass, impulse.map(digits), point_mass ? [0, 0, 0] : point.map(digits));
    }

    text() { return this.engine.saved(); }
    get fileName() { return `${this.name.replace(/^.*\//, '').replace(/(_session)?\.toml$/, '')}_session.toml`; }
    save() { this.#whenThere(() => this.#save()); }
    #save() {
        const { trouble } = this.game.played;
        if (trouble?.issue === 'range_left' && trouble.time < this.game.time) {
            this.panel.tell(`${Panel.trouble(trouble)}. Go back to before it to save the session.`, true);
            return;
        }
        const link = document.createElement('a');
        link.href = URL.createObjectURL(new Blob([this.text()], { type: 'application/toml' }));
        link.download = this.fileName;
        link.click();
        URL.revokeObjectURL(link.href);
        this.panel.tell(`saved ${this.fileName}; it replays to ${this.engine.hash(0)}`);
    }
    get commands() {
        const file = /^[\w.\/-]+$/.test(this.fileName) ? this.fileName : `'${this.fileName.replace(/'/g, `'\\''`)}'`;
        return `build/host/tumble run ${file}\nbuild/host/tumble compare ${file} --core cortex-m0\n`;
    }
    async copyCommands() {
        await navigator.clipboard?.writeText(this.commands).catch(() => {});
        this.panel.tell(`Save, then:\n${this.commands}`);
    }

    // Rounded, so that a saved session is short.
    #impulse(strength) {
        return Number((this.engine.scene.bodies[this.body].mass * this.push * strength).toPrecision(4));
    }
    #hit(inBody, impulse, point) {
        const { body } = this;
        if (this.engine.scene.bodies[body].fixed) return;
        this.#whenThere(() => {
            this.game.hit(body, inBody, impulse, point);
            this.plotted = 0;
            this.panel.hideHint();
        });
    }
    // Does something as soon as the runs are where they were sent.
    #whenThere(action) {
        if (this.stopped) return;
        if (this.game.isThere) action();
        else this.waiting.push(action);
    }
    #begin(step, keepsCamera) {
        if (this.engine.isDead) return;
        this.controls.forget();
        this.waiting = [];
        this.game = new Game(this.engine, this.ways, document.getElementById('reference').checked);
        this.game.target = step;
        this.view.show(this.game, keepsCamera);
        this.panel.listRuns(this.game);
        this.plotted = this.dueSteps = 0;
        this.stopped = false;
    }

    #frame(time) {
        requestAnimationFrame(next => this.#frame(next));
        const passed = Math.min(0.1, (time - (this.last ?? time)) / 1000);
        this.last = time;
        if (this.stopped) return;
        try {
            this.#pass(passed);
            this.view.draw();
            this.panel.show(this.game);
            if (time - this.plotted > App.plotInterval || this.plotted === 0) {
                this.plots.draw(this.game, this.game.lanes.map((_, i) => Panel.colour(i)));
                this.plotted = time;
            }
        } catch (error) {
            this.stopped = true;  // the engine is of no more use
            this.panel.tell(`${error.message}\nOpen a scene to go on.`, true);
        }
    }
    // Lets time pass. Where the steps take longer than they last, the game is slower than the clock.
    #pass(seconds) {
        const { game } = this;
        if (game.isThere) for (const action of this.waiting.splice(0)) action();
        if (!this.paused && game.isThere) {
            this.dueSteps += seconds * this.speed / game.scene.step_s;
            game.target = game.now + Math.floor(this.dueSteps);
            this.dueSteps -= Math.floor(this.dueSteps);
        }
        const from = game.time, before = game.played.trouble?.issue;
        game.advance(App.frameBudget);
        const { trouble } = game.played;
        if (trouble?.issue === 'range_left' && before !== 'range_left' && trouble.time >= from) {
            this.pause(true);
            game.target = game.now;
            this.panel.tell(Panel.trouble(trouble), true);
        }
    }
}

const app = new App();
window.tumble = app;
app.start().then(() => { window.ready = true; },
    error => { document.getElementById('message').textContent = error.message; });
