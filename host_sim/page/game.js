// A scene that is played: its runs side by side in the time of the played one, what they did at sampled steps, and how
// far they are from a reference. It draws nothing.

// A run of the engine, and its states at sampled steps.
class Lane {
    constructor(way, index) {
        this.way = way;
        this.index = index;
        this.samples = [];
        this.trouble = undefined;  // what the status told: that it left the range, or else the first
    }
    static factor(halvings) {
        return halvings === 0 ? '' : halvings > 0 ? ` / ${2 ** halvings}` : ` × ${2 ** -halvings}`;
    }
}

// The state of one body in a sample.
class BodyState {
    constructor(state, body) {
        const at = Engine.numbersOfBody * body, part = (from, count) => state.subarray(at + from, at + from + count);
        this.position = part(0, 3);
        this.orientation = part(6, 4);
        this.asleep = state[at + 13] === 1;
        this.contacts = state[at + 14];
    }
}

class Game {
    // The played way comes first, then the ghosts.
    constructor(engine, ways, hasReference) {
        this.engine = engine;
        this.scene = engine.scene;
        // About 60 samples a second of the scene.
        this.stride = Math.max(1, Math.round(1 / 60 / this.scene.step_s));
        this.target = this.now = this.furthest = 0;
        this.hits = engine.hits();
        engine.removeRuns();
        const lane = way => new Lane(way, engine.addRun(way));
        this.lanes = ways.map(lane);
        // Two methods at a sixteenth of the step: their distance is the doubt. Where an event of control acts in each
        // step, another step is another scene.
        const finer = integrator => ({ integrator, numbers: 'f64', carry: false, halvings: 4 });
        const fine = hasReference && !this.scene.has_events ? [finer('rk4'), finer('suzuki4')] : [];
        this.references = fine.map(lane);  // every scene runs in f64
        this.referenceStep = 0;
        this.#forgetErrors(0);
        this.#record();
    }

    get played() { return this.lanes[0]; }
    get time() { return this.now * this.scene.step_s; }
    get isThere() { return this.now === this.target; }

    // Takes steps until all runs are at `target` or the time is over, then steps of the references.
    advance(milliseconds) {
        const end = performance.now() + milliseconds;
        while (!this.isThere) {
            const next = this.target < this.now ? this.target : this.#nextSample(this.now, this.target);
            if (!this.#move(this.lanes, next, end)) return;
            this.now = next;
            this.furthest = Math.max(this.furthest, this.now);
            this.#record();
        }
        for (const lane of this.lanes) {
            if (lane.trouble?.issue === 'range_left') continue;
            const troubles = this.engine.troubles(lane.index);
            const trouble = troubles.find(t => t.issue === 'range_left') ?? (lane.trouble ? undefined : troubles[0]);
            if (trouble) lane.trouble = { ...trouble, time: trouble.step * this.scene.step_s * 2 ** -lane.way.halvings };
        }
        this.#follow(end);
    }
    // The same without an end; for tests.
    finish() { this.advance(Infinity); }

    // Hits a body of the played run and forgets the future.
    hit(body, inBody, impulse, point) {
        this.engine.hit(body, inBody, impulse, point);
        this.hits = this.engine.hits();
        const kept = Math.floor(this.now / this.stride);
        for (const lane of [...this.lanes, ...this.references]) lane.samples.length = Math.min(lane.samples.length, kept + 1);
        this.target = this.furthest = this.now;
        for (const lane of this.lanes) if (lane.trouble?.time >= this.time) lane.trouble = undefined;
        this.referenceStep = Math.min(this.referenceStep, kept * this.stride);
        this.#forgetErrors(kept + 1);
    }

    state(lane) { return this.engine.state(lane.index); }

    // What is known of the accuracy of a lane: { kind: right, wrong, no_reference or none, time, m, rad, body }.
    verdict(lane) { return this.known.get(lane) ?? { kind: 'none' }; }
    // Errors of a lane at a sample: { m, rad }, or nothing where there is no reference.
    error(lane, sample) { return this.errors.get(lane)?.[sample]; }

    #nextSample(from, most) { return Math.min(most, (Math.floor(from / this.stride) + 1) * this.stride); }
    #move(lanes, step, end) {
        for (const lane of lanes)
            while (!this.engine.goTo(lane.index, step, 16)) if (performance.now() > end) return false;
        return true;
    }
    #record() {
        if (this.now % this.stride !== 0) return;
        const sample = this.now / this.stride;
        for (const lane of this.lanes) lane.samples[sample] ??= this.state(lane);
        if (this.played.samples.length > Game.mostSamples) this.#thin();
    }
    // Leaves every other sample out.
    #thin() {
        const thinned = list => list.filter((_, i) => i % 2 === 0);
        this.stride *= 2;
        for (const lane of [...this.lanes, ...this.references]) lane.samples = thinned(lane.samples);
        for (const [lane, errors] of this.errors) this.errors.set(lane, thinned(errors));
        this.doubts = thinned(this.doubts);
        this.moved = thinned(this.moved);
        this.referenceStep = Math.max(0, this.doubts.length - 1) * this.stride;
    }
    static mostSamples = 4096;

    // The references go from sample to sample, as far as the runs have been.
    #follow(end) {
        if (this.references.length < 2) return;
        const last = this.played.samples.length - 1;
        for (;;) {
            if (!this.#move(this.references, this.referenceStep, end)) return;
            const sample = this.referenceStep / this.stride;
            for (const lane of this.references) lane.samples[sample] ??= this.state(lane);
            this.#compare(sample);
            if (sample >= last || performance.now() > end) return;
            this.referenceStep += this.stride;
        }
    }

    static share = 0.1;     // of the way of a body: an error in position above it is wrong
    static angle = 0.1;     // rad
    static doubtful = 0.2;  // of both: references that differ by more decide nothing

    #forgetErrors(from) {
        if (from === 0) this.errors = new Map(this.lanes.map(lane => [lane, []]));
        this.doubts = (this.doubts ?? []).slice(0, from);
        this.moved = (this.moved ?? []).slice(0, from);
        for (const errors of this.errors.values()) errors.length = Math.min(errors.length, from);
        this.known = new Map();
        if (this.references.length < 2) return;
        for (const lane of this.lanes) this.known.set(lane, { kind: 'right', m: 0, rad: 0, time: 0 });
        for (let sample = 0; sample < this.doubts.length; ++sample) this.#judge(sample);
    }
    #compare(sample) {
        if (this.doubts.length > sample) return;
        const [fine, other] = this.references.map(lane => lane.samples[sample]), start = this.references[0].samples[0];
        const distances = (a, b) => this.scene.bodies.map((_, body) => {
            const one = new BodyState(a, body), two = new BodyState(b, body);
            return { m: norm(subtract(one.position, two.position)), rad: angleBetween(one.orientation, two.orientation) };
        });
        this.doubts[sample] = distances(fine, other);
        this.moved[sample] = distances(fine, start).map((d, body) => Math.max(d.m, this.moved[sample - 1]?.[body] ?? 0));
        for (const lane of this.lanes) {
            // A longer step ends at some samples only.
            const period = 2 ** Math.max(0, -lane.way.halvings);
            if (sample * this.stride % period === 0) this.errors.get(lane)[sample] = distances(lane.samples[sample], fine);
        }
        this.#judge(sample);
    }
    #judge(sample) {
        const time = sample * this.stride * this.scene.step_s;
        for (const lane of this.lanes) {
            const known = this.known.get(lane), errors = this.errors.get(lane)[sample];
            if (!errors || known.kind !== 'right' || lane.trouble?.time < time) continue;
            known.time = time;
            this.scene.bodies.forEach((body, b) => {
                if (known.kind !== 'right') return;
                const most = Math.max(Game.share * this.moved[sample][b], this.scene.tolerance), doubt = this.doubts[sample][b];
                if (!(doubt.m <= Game.doubtful * most && doubt.rad <= Game.doubtful * Game.angle))
                    Object.assign(known, { kind: 'no_reference', body: body.name, doubt });
                else if (!(errors[b].m <= most && errors[b].rad <= Game.angle))
                    Object.assign(known, { kind: 'wrong', body: body.name, m: errors[b].m, rad: errors[b].rad });
                else
                    Object.assign(known, { m: Math.max(known.m, errors[b].m), rad: Math.max(known.rad, errors[b].rad) });
            });
        }
    }
}
