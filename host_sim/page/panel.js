// What stands beside the view: the scene, the runs with their verdicts, costs and messages. It calls back `app`.
class Panel {
    constructor(app, costs) {
        this.app = app;
        this.costs = costs;
        const at = id => document.getElementById(id);
        this.at = at;
        at('scene').addEventListener('change', event => app.openShipped(event.target.value));
        at('file').addEventListener('change', event => app.openFile(event.target.files[0]));
        at('add').addEventListener('click', () => app.addGhost());
        at('save').addEventListener('click', () => app.save());
        at('copy').addEventListener('click', () => app.copyCommands());
        at('play').addEventListener('click', () => app.pause(!app.paused));
        at('step').addEventListener('click', () => app.step(1));
        at('restart').addEventListener('click', () => app.seek(0));
        at('time').addEventListener('input', event => app.seek(Number(event.target.value)));
        at('speed').addEventListener('change', event => { app.speed = Number(event.target.value); });
        at('push').addEventListener('input', event => { app.push = Number(event.target.value); this.showPush(); });
        at('follow').addEventListener('change', event => { app.view.follows = event.target.checked; });
        at('aim').addEventListener('click', () => app.view.aim());
        at('reference').addEventListener('change', () => app.restart());
        at('anew').addEventListener('click', () => app.open(app.toml, app.name));
        at('more').addEventListener('click', () => {
            document.body.classList.toggle('narrow_open');
            app.plots.resize();
        });
        // A key is a push, not another choice.
        document.addEventListener('change', event => event.target.blur());
        this.showPush();
    }

    listScenes(names) {
        for (const name of names) this.at('scene').add(new Option(name.replace('.toml', ''), name));
    }
    // The scene's name, and what the comment at the start of its file says of it.
    showScene(name, toml) {
        this.at('scene').value = name;
        const comment = toml.match(/^(#.*\n)+/)?.[0] ?? '';
        const [about, ...known] = comment.replace(/^# ?/gm, '').split(/\n\s*\n/);
        this.at('about').textContent = about.replace(/\n/g, ' ').trim();
        this.at('known').textContent = known.join(' ').replace(/\n/g, ' ').trim();
    }
    showPush() { this.at('push_value').textContent = `${this.app.push} m/s`; }
    hideHint() { this.at('hint').hidden = true; }
    // A message is shown until the next.
    tell(text, isError = false) {
        this.at('message').textContent = text;
        this.at('message').className = isError ? 'error' : '';
    }

    // The table of runs, anew.
    listRuns(game) {
        const rows = this.at('runs');
        rows.textContent = '';
        this.answers = game.lanes.map((lane, i) => {
            const row = rows.appendChild(document.createElement('div'));
            row.className = 'run';
            const line = row.appendChild(document.createElement('div'));
            const swatch = line.appendChild(document.createElement('span'));
            swatch.className = 'swatch';
            swatch.style.background = Panel.colour(i);
            const choose = (name, options, value, change) => {
                const select = line.appendChild(document.createElement('select'));
                select.title = name;
                select.setAttribute('aria-label', `${name} of run ${i + 1}`);
                for (const [text, own] of options) select.add(new Option(text, own));
                select.value = value;
                select.addEventListener('change', () => this.app.changeWay(i, change(select.value)));
            };
            choose('integrator', game.engine.integrators.map(n => [n, n]), lane.way.integrator, integrator => ({ integrator }));
            choose('number system', [['q32', 'q32'], ['f32 plain', 'f32'], ['f64', 'f64']], lane.way.numbers,
                numbers => ({ numbers, carry: numbers === 'q32' }));
            if (i > 0) {
                const steps = [-2, -1, 0, 1, 2, 4].map(halvings => [`step${Lane.factor(halvings)}`, halvings]);
                choose('step', steps, String(lane.way.halvings), halvings => ({ halvings: Number(halvings) }));
                const remove = line.appendChild(document.createElement('button'));
                remove.textContent = '×';
                remove.title = 'remove this ghost';
                remove.addEventListener('click', () => this.app.removeGhost(i));
            } else line.appendChild(document.createElement('span')).textContent = `step ${game.scene.step} s`;
            const answer = row.appendChild(document.createElement('div'));
            answer.className = 'answer';
            return answer;
        });
        this.at('add').disabled = game.lanes.length > View.ghosts.length;
        const costs = this.at('costs'), table = this.costs.table(game.played.way, game.scene.step_s);
        costs.textContent = '';
        costs.append(table ?? 'no rows for this method');
    }

    // What changes while the game goes on.
    show(game) {
        const hash = game.isThere ? game.engine.hash(game.played.index) : `… ${game.target}`;
        this.at('clock').textContent = `${game.time.toFixed(3)} s   step ${game.now}   ${hash}`;
        const slider = this.at('time');
        slider.max = Math.max(game.furthest, 1);
        if (document.activeElement !== slider || game.isThere) slider.value = game.now;
        this.at('play').textContent = this.app.paused ? '▶' : '❚❚';
        this.at('play').title = this.app.paused ? 'go on (space)' : 'pause (space)';
        game.lanes.forEach((lane, i) => { this.answers[i].textContent = Panel.verdict(game, lane); });
        const { body } = this.app;
        this.at('body').textContent = game.scene.bodies[body]?.name ?? '-';
    }

    static colour(i) { return `#${[View.played, ...View.ghosts][i].toString(16).padStart(6, '0')}`; }
    // The words are those of `tumble run`: what the status told, and how accurate the run is.
    static verdict(game, lane) {
        const accuracy = Panel.#accuracy(game, lane);
        return lane.trouble ? `${Panel.trouble(lane.trouble)}; before, ${accuracy}` : accuracy;
    }
    static trouble({ issue, body, time, what }) {
        return `${issue}: ${body} at ${Panel.#seconds(time)}${what ? `: ${what}` : ''}`;
    }
    static #seconds(time) { return `${+time.toPrecision(4)} s`; }
    static #accuracy(game, lane) {
        const v = game.verdict(lane), number = x => x === 0 ? '0' : x.toPrecision(2);
        const within = error => `${number(error.m)} m and ${number(error.rad)} rad`, time = Panel.#seconds(v.time ?? 0);
        switch (v.kind) {
        case 'right': return `right: error at most ${within(v)}${v.time < game.time - 0.2 ? ` until ${time}` : ''}`;
        case 'wrong': return `wrong from ${time} on: ${v.body} is off by ${within(v)}`;
        case 'no_reference':
            return `no reference from ${time} on: two fine runs differ by ${within(v.doubt)}; ` +
                   `right before, within ${within(v)}`;
        default: return 'no reference';
        }
    }
}
