// Errors, energy, angular momentum and contacts of all runs over time, with marks at hits and contacts.
class Plots {
    static rows = 500;  // at most, of one drawing

    constructor(root) {
        this.boxes = [];
        const plot = (title, options, y = { pixelsPerLabel: 22 }) => {
            const box = root.appendChild(document.createElement('div'));
            box.className = 'plot';
            this.boxes.push(box);
            const graph = new Dygraph(box, [[0, null]], {
                title, labels: ['t', ' '], titleHeight: 18, axisLabelFontSize: 10, strokeWidth: 1.3, legend: 'never',
                axisLineColor: '#5d6b7a', gridLineColor: '#2a333d', xRangePad: 2, animatedZooms: false, interactionModel: {},
                axes: { y: { axisLabelWidth: 52, axisLabelFormatter: Plots.label, ...y }, x: { axisLabelWidth: 34 } },
                underlayCallback: (canvas, area, graph) => this.#underlay(canvas, area, graph), ...options });
            // Where the panel is hidden, it gives the box a size of its own, which would hide the style's.
            box.style.width = box.style.height = '';
            return graph;
        };
        const logarithmic = { logscale: true, valueRange: Plots.decades([]) };
        const error = title => plot(title, logarithmic, { ticker: Plots.powers });
        this.plots = [
            { graph: error('position error, m'), of: (lane, i) => this.#largest(lane, i, 'm') },
            { graph: error('orientation error, rad'), of: (lane, i) => this.#largest(lane, i, 'rad') },
            { graph: plot('energy, J', {}), of: (lane, i) => this.#tail(lane, i, t => t[0] + t[1]) },
            { graph: plot('angular momentum, kg m²/s', {}),
              of: (lane, i) => this.#tail(lane, i, t => Math.hypot(t[2], t[3], t[4])) },
            { graph: plot('contact points', {}), of: (lane, i) => this.#contacts(lane, i) },
        ];
    }

    // To the room of the panel, which has none while it is hidden.
    resize() {
        this.plots.forEach(({ graph }, i) => {
            const { clientWidth: width, clientHeight: height } = this.boxes[i];
            if (width > 0 && height > 0) graph.resize();
        });
    }

    draw(game, colours) {
        this.game = game;
        const touching = game.played.samples.map((_, i) => this.#contacts(game.played, i));
        this.begun = [...touching.keys()].filter(i => touching[i] > touching[i - 1]);  // samples in which more touches
        const count = game.played.samples.length, every = Math.max(1, Math.ceil(count / Plots.rows));
        const hasReference = game.references.length > 1;
        this.plots.forEach(({ graph, of }, index) => {
            const hidden = (index < 2 && !hasReference) || (index === 4 && !game.scene.touches);
            const wasHidden = graph.maindiv_.hidden;
            graph.maindiv_.hidden = hidden;
            if (hidden) return;
            if (wasHidden) this.resize();
            const rows = [];
            for (let i = 0; i < count; i = i < count - 1 ? Math.min(i + every, count - 1) : count)
                rows.push([i * game.stride * game.scene.step_s, ...game.lanes.map(lane => of(lane, i))]);
            const options = { file: rows, labels: ['t', ...game.lanes.map((_, i) => `${i}`)], colors: colours };
            if (index < 2) options.valueRange = Plots.decades(rows);
            graph.updateOptions(options);
        });
    }

    // The powers of ten about all positive values.
    static decades(rows) {
        const values = rows.flatMap(row => row.slice(1)).filter(x => x > 0 && Number.isFinite(x));
        if (values.length === 0) return [1e-9, 1];
        const least = values.reduce((a, b) => Math.min(a, b)), most = 1.01 * values.reduce((a, b) => Math.max(a, b));
        return [10 ** Math.floor(Math.log10(least)), 10 ** Math.ceil(Math.log10(most))];
    }
    // Some powers of ten between two numbers, as marks of an axis of so many pixels.
    static powers(least, most, pixels) {
        const first = Math.ceil(Math.log10(least) - 1e-6), last = Math.floor(Math.log10(most) + 1e-6), marks = [];
        const every = Math.ceil((last - first + 1) / Math.max(2, pixels / 18));
        for (let power = last; power >= first; power -= every) marks.push({ v: 10 ** power, label: `1e${power}` });
        return marks;
    }
    // Few characters, since the axis is narrow.
    static label(value) {
        if (value === 0) return '0';
        const size = Math.abs(value);
        return size >= 0.01 && size < 1e4 ? String(+value.toPrecision(4)) : value.toExponential(0).replace('e+', 'e');
    }
    #largest(lane, i, key) {
        const errors = this.game.error(lane, i);
        const largest = errors ? Math.max(...errors.map(e => e[key])) : NaN;
        return largest > 0 ? largest : null;  // a logarithm
    }
    #tail(lane, i, of) {
        const sample = lane.samples[i], value = sample ? of(sample.subarray(sample.length - 5)) : NaN;
        return Number.isFinite(value) ? value : null;
    }
    #contacts(lane, i) {
        const sample = lane.samples[i];
        return sample ? this.game.scene.bodies.reduce((sum, _, b) => sum + new BodyState(sample, b).contacts, 0) : null;
    }
    #underlay(canvas, area, graph) {
        if (!this.game) return;
        const line = (time, colour) => {
            const x = graph.toDomXCoord(time);
            canvas.fillStyle = colour;
            canvas.fillRect(x, area.y, 1, area.h);
        };
        // Where bodies begin to touch, and where the player hits.
        const { stride, scene } = this.game;
        for (const i of this.begun) line(i * stride * scene.step_s, '#2f5f3a');
        for (const hit of this.game.hits) line(hit.step * scene.step_s, '#a03838');
        line(this.game.time, '#8892a0');
    }
}
