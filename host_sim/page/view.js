// The scene in three dimensions: the played run in solid colours, ghosts see-through, and what acts.
class View {
    static background = 0x12161c;
    static played = 0xf0a040;
    static ghosts = [0x4da3ff, 0x5fd38d, 0xd16bd1, 0xf0e060];
    static asleep = 0x8a6236;
    static spring = 0xe8e070;
    static joint = 0xe6e9ee;
    static slack = 0x6b7380;  // a rope
    static hitShown = 0.35;  // s of the scene for which the arrow of a hit stays

    constructor(canvas) {
        // Smooth edges double the time of a frame where the processor draws; #smooth in the address asks for them.
        const antialias = location.hash === '#smooth' || !drawsInSoftware();
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias });
        this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
        this.camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1000);
        this.orbit = new THREE.OrbitControls(this.camera, canvas);
        this.orbit.enableKeys = false;
        this.follows = true;
    }

    // A game anew; `keepsCamera` where the scene is the same.
    show(game, keepsCamera) {
        this.game = game;
        this.world = new THREE.Scene();
        this.world.background = new THREE.Color(View.background);
        const sun = new THREE.DirectionalLight(0xffffff, 0.75);
        sun.position.set(4, 8, 5);
        this.world.add(sun, new THREE.AmbientLight(0xffffff, 0.5));
        this.world.add(this.marks = new THREE.Group());

        const { bodies, planes, springs, joints } = game.scene, state = game.state(game.played);
        this.lanes = game.lanes.map((lane, i) => {
            const group = new THREE.Group();
            bodies.forEach(body => group.add(i === 0 ? bodyObject(body, body.fixed ? 0x8892a0 : View.played, 1)
                                                     : bodyObject(body, View.ghosts[i - 1], body.fixed ? 0 : 0.35)));
            this.world.add(group);
            return group;
        });
        const { centre, radius } = this.#extent([state]);
        this.planes = planes.map(plane => planeObject(plane, centre, Math.max(20, 6 * radius)));
        this.planes.forEach(plane => this.world.add(plane));
        this.lines = springs.map(spring => this.#line(spring, View.spring));
        this.joints = joints.map(joint => this.#joint(joint, state));  // objects of each
        // The path of the centre of mass of all bodies that move.
        this.path = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xc8b080 }));
        this.path.frustumCulled = false;
        this.world.add(this.path);

        // Without a floor nothing else would show that a body moves.
        if (planes.length === 0 && bodies.every(body => !body.fixed || reach(body) < radius)) {
            const grid = new THREE.GridHelper(40 * radius, 40, 0x35404c, 0x20272f);
            grid.position.set(centre[0], centre[1] - 1.5 * radius, centre[2]);
            this.world.add(grid);
        }

        this.shownPath = '';
        this.centre = this.#centreOfMass(state);
        if (keepsCamera) return;
        this.#aim(centre, radius);
    }
    // Looks at the whole scene, from where it has been to where it is now; or as it is now.
    aim(hasPast = true) {
        const samples = hasPast ? this.game.played.samples : [], every = Math.max(1, Math.ceil(samples.length / 200));
        const been = samples.filter((sample, i) => sample && i % every === 0 && i * this.game.stride <= this.game.now);
        const { centre, radius } = this.#extent([...been, this.game.state(this.game.played)]);
        this.#aim(centre, radius);
    }

    draw() {
        const { game } = this, state = game.state(game.played);
        this.#place(this.lanes[0], state);
        game.lanes.slice(1).forEach((lane, i) => this.#place(this.lanes[i + 1], game.state(lane), state));
        this.#placeLines(state);
        this.#showJoints();
        this.#drawPath();
        this.#mark(state);
        const centre = this.#centreOfMass(state);
        if (this.follows && centre.every(Number.isFinite)) {
            const moved = new THREE.Vector3(...subtract(centre, this.centre));
            this.camera.position.add(moved);
            this.orbit.target.add(moved);
            this.centre = centre;
        }
        this.#fit();
        this.orbit.update();
        // A wall between the viewer and the scene is not drawn.
        for (const plane of this.planes) plane.visible = plane.userData.isFree(this.camera.position);
        this.renderer.render(this.world, this.camera);
    }

    // The body under a point of the window, with the point and the outward normal in the body's axes; or nothing.
    pick(x, y) {
        const box = this.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
        ray.setFromCamera({ x: 2 * (x - box.left) / box.width - 1, y: 1 - 2 * (y - box.top) / box.height }, this.camera);
        const hit = ray.intersectObject(this.lanes[0], true).find(h => h.face && h.object.visible);
        if (!hit) return undefined;
        const body = this.lanes[0].children.indexOf(hit.object.parent), group = this.lanes[0].children[body];
        return { body, point: group.worldToLocal(hit.point.clone()).toArray(), normal: hit.face.normal.toArray() };
    }
    // The direction of the world that is nearest to a direction on the screen, [right, up, towards the viewer].
    direction([right, up, near]) {
        if (up !== 0) return [0, up, 0];
        const flat = new THREE.Vector3(right, 0, near).applyAxisAngle(new THREE.Vector3(0, 1, 0), this.#azimuth());
        return Math.abs(flat.x) > Math.abs(flat.z) ? [Math.sign(flat.x), 0, 0] : [0, 0, Math.sign(flat.z)];
    }
    // An arrow at a point of a body, in its axes, while a pull goes on.
    preview(pull) { this.pull = pull; }

    #azimuth() {
        const way = subtract(this.camera.position.toArray(), this.orbit.target.toArray());
        return Math.atan2(way[0], way[2]);
    }
    #moving() { return this.game.scene.bodies.map((body, i) => ({ body, i })).filter(({ body }) => !body.fixed); }
    #centreOfMass(state) {
        const moving = this.#moving(), mass = moving.reduce((sum, { body }) => sum + body.mass, 0), centre = [0, 0, 0];
        for (const { body, i } of moving)
            for (let axis = 0; axis < 3; ++axis) centre[axis] += state[Engine.numbersOfBody * i + axis] * body.mass / mass;
        return centre;
    }
    // Of all bodies in these states.
    #extent(states) {
        const { bodies, springs, joints } = this.game.scene, low = Array(3).fill(Infinity), high = Array(3).fill(-Infinity);
        const include = (at, r) => at.forEach((x, axis) => {
            low[axis] = Math.min(low[axis], x - r);
            high[axis] = Math.max(high[axis], x + r);
        });
        // What is fixed and large is ground, of which the middle will do.
        const large = 4 * Math.max(...this.#moving().map(({ body }) => reach(body)), 0.1);
        for (const state of states)
            bodies.forEach((body, i) => {
                const { position } = new BodyState(state, i);
                if (position.every(Number.isFinite)) include(position, body.fixed && reach(body) > large ? 0 : reach(body));
            });
        for (const { to_body, to } of [...springs, ...joints]) if (to_body < 0) include(to, 0);
        return { centre: scale(add(low, high), 0.5), radius: Math.max(norm(subtract(high, low)) / 2, 0.05) };
    }
    #aim(centre, radius) {
        this.#fit();
        const narrow = Math.min(1, this.camera.aspect);
        const away = 1.1 * radius / Math.sin(this.camera.fov * Math.PI / 360) / narrow;
        this.orbit.target.set(...centre);
        this.camera.position.set(...centre).addScaledVector(this.#direction(), away);
        this.camera.near = away / 200;
        this.camera.far = 200 * away;
        this.camera.updateProjectionMatrix();
        this.arrowLength = 0.8 * Math.max(0.15, Math.min(radius, 2));
    }
    // From above, and from the side on which planes are seen best.
    #direction() {
        const unit = ({ normal }) => new THREE.Vector3(...normal).normalize();
        const seen = way => this.game.scene.planes.reduce((sum, plane) => sum + Math.min(0.5, way.dot(unit(plane))), 0);
        const ways = [[0.45, 1], [-0.45, 1], [0.45, -1], [-0.45, -1]].map(([x, z]) => new THREE.Vector3(x, 0.4, z).normalize());
        return ways.reduce((best, way) => seen(way) > seen(best) + 1e-6 ? way : best);
    }
    #fit() {
        const canvas = this.renderer.domElement, { clientWidth: width, clientHeight: height } = canvas.parentElement;
        if (this.size === `${width} ${height}` || width === 0) return;
        this.size = `${width} ${height}`;
        this.renderer.setSize(width, height);
        // What was seen across a narrow window stays in it.
        const shorter = () => Math.min(1, this.camera.aspect), before = shorter();
        this.camera.aspect = width / height;
        this.camera.position.sub(this.orbit.target).multiplyScalar(before / shorter()).add(this.orbit.target);
        this.camera.updateProjectionMatrix();
    }

    // `played`: of a ghost, the state of the played run.
    #place(group, state, played) {
        group.children.forEach((object, i) => {
            const body = new BodyState(state, i), [w, x, y, z] = body.orientation;
            object.visible = object.userData.surface.opacity > 0 && body.position.every(Number.isFinite) &&
                             (!played || this.#differs(body, new BodyState(played, i), reach(this.game.scene.bodies[i])));
            if (!object.visible) return;
            object.position.set(...body.position);
            object.quaternion.set(x, y, z, w);
            if (!played) object.userData.surface.color.set(body.asleep ? View.asleep : object.userData.colour);
        });
    }
    // Is a ghost seen beside the played body, by more than a few thousandths of its size?
    #differs(ghost, played, size) {
        return norm(subtract([...ghost.position], [...played.position])) +
               size * angleBetween(ghost.orientation, played.orientation) > 0.004 * size;
    }
    #worldPoint(state, index, point) {
        if (index < 0) return point;
        const body = new BodyState(state, index);
        return add([...body.position], turned(body.orientation, point));
    }
    // Between points of bodies in their axes; of the world where `to_body` is below 0.
    #line({ body, point, to_body, to }, colour) {
        const line = new THREE.Line(segment([0, 0, 0], [1, 0, 0]), new THREE.LineBasicMaterial({ color: colour }));
        line.frustumCulled = false;
        this.world.add(line);
        return { line, body, point, to_body, to };
    }
    #placeLines(state) {
        for (const { line, body, point, to_body, to } of this.lines)
            line.geometry.setFromPoints([this.#worldPoint(state, body, point), this.#worldPoint(state, to_body, to)]
                .map(at => new THREE.Vector3(...at)));
    }
    // The objects of a joint: the line of a distance, or pins that move with a body. `start`: where it is as it is told.
    #joint({ kind, body, point, axis, to_body, to, to_axis }, start) {
        const inAxes = (side, way) => side < 0 ? way : turned(conjugate(new BodyState(start, side).orientation), way);
        const on = (side, at) => side < 0 ? at : inAxes(side, subtract(at, new BodyState(start, side).position));
        if (kind === 'distance') {
            this.lines.push(this.#line({ body, point: on(body, point), to_body, to: on(to_body, to) }, View.joint));
            return [this.lines[this.lines.length - 1].line];
        }
        const pin = (side, way) => {
            const geometry = jointGeometry(kind, this.game.scene.bodies[body], inAxes(body, way));
            geometry.lookAt(new THREE.Vector3(...inAxes(side, way))).translate(...on(side, point));
            const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: View.joint }));
            (side < 0 ? this.world : this.lanes[0].children[side]).add(mesh);
            return mesh;
        };
        return kind === 'universal' ? [pin(body, axis), pin(to_body, to_axis)] : [pin(body, axis)];
    }
    #showJoints() {
        const { engine, played } = this.game;
        engine.joints(played.index).forEach((now, i) => {
            for (const object of this.joints[i]) {
                object.visible = now > 0;
                if (object.isLine) object.material.color.set(now === 1 ? View.slack : View.joint);
            }
        });
    }
    #drawPath() {
        const { samples } = this.game.played, { stride } = this.game, last = Math.floor(this.game.now / stride);
        const shown = `${last} ${stride} ${this.game.hits.length}`;
        if (shown === this.shownPath) return;
        this.shownPath = shown;
        const every = Math.max(1, Math.ceil(last / 1000)), points = [];
        for (let i = 0; i <= last; i += every)
            if (samples[i]) points.push(new THREE.Vector3(...this.#centreOfMass(samples[i])));
        this.path.visible = points.length > 1;
        if (!this.path.visible) return;
        this.path.geometry.dispose();
        this.path.geometry = new THREE.BufferGeometry().setFromPoints(points);
    }

    // Arrows are kept: a program of the GPU whose last material is gone is compiled anew.
    #arrow(from, vector, length, colour) {
        if (this.arrows === this.marks.children.length) this.marks.add(arrowObject());
        const arrow = this.marks.children[this.arrows++];
        arrow.position.set(...from);
        arrow.setDirection(new THREE.Vector3(...vector).normalize());
        arrow.setLength(length, Math.min(0.3 * length, 0.12), Math.min(0.18 * length, 0.07));
        arrow.setColor(colour);
    }
    // Arrows of hits, forces and torques that act now, and of the impulses of contacts.
    #mark(state) {
        this.arrows = 0;
        const { game } = this, { scene } = game, long = this.arrowLength;
        const inWorld = (item, vector) => item.in_body ? turned(new BodyState(state, item.body).orientation, vector) : vector;
        for (const hit of game.hits) {
            const age = game.time - hit.step * scene.step_s;
            if (!(age >= 0 && age < View.hitShown) || norm(hit.impulse) === 0) continue;
            const vector = inWorld(hit, hit.impulse), at = this.#worldPoint(state, hit.body, hit.point);
            const length = long * Math.min(1, Math.max(0.4, norm(vector) / scene.bodies[hit.body].mass / 3));
            this.#arrow(subtract(at, scale(vector, length / norm(vector))), vector, length, 0xff5050);
        }
        for (const force of scene.forces) {
            if (game.time < force.from || game.time >= force.until) continue;
            const at = this.#worldPoint(state, force.body, force.point);
            if (norm(force.force) > 0) this.#arrow(at, inWorld(force, force.force), long, 0x40e0d0);
            if (norm(force.torque) > 0) this.#arrow(at, inWorld(force, force.torque), long, 0xc080ff);
        }
        if (scene.touches) {
            const contacts = game.engine.contacts(game.played.index);
            const impulse = c => add(scale(c.normal, c.normalImpulse), c.frictionImpulse);
            const most = Math.max(...contacts.map(c => norm(impulse(c))), 1e-12);
            for (const c of contacts.slice(0, 60))
                if (norm(impulse(c)) > 0.01 * most)
                    this.#arrow(c.point, impulse(c), 0.7 * long * norm(impulse(c)) / most, 0x60ff60);
        }
        if (this.pull) {
            const body = new BodyState(state, this.pull.body), at = this.#worldPoint(state, this.pull.body, this.pull.point);
            const vector = turned(body.orientation, this.pull.direction), length = long * (0.4 + this.pull.strength / 6);
            this.#arrow(subtract(at, scale(vector, length)), vector, length, 0xffffff);
        }
        this.marks.children.forEach((arrow, i) => { arrow.visible = i < this.arrows; });
    }
}

// Does the processor draw, without a GPU? Not known in a browser that hides its GPU.
function drawsInSoftware() {
    const gl = document.createElement('canvas').getContext('webgl'), info = gl?.getExtension('WEBGL_debug_renderer_info');
    const isSoftware = info && /swiftshader|llvmpipe|software/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return Boolean(isSoftware);
}
