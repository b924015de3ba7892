// Keys, mouse and touch: hits, pause, steps.
class Controls {
    // right, up, towards the viewer
    static pushes = { ArrowRight: [1, 0, 0], KeyD: [1, 0, 0], ArrowLeft: [-1, 0, 0], KeyA: [-1, 0, 0], ArrowUp: [0, 0, -1],
                      KeyW: [0, 0, -1], ArrowDown: [0, 0, 1], KeyS: [0, 0, 1], PageUp: [0, 1, 0], PageDown: [0, -1, 0] };
    // The faces of a box: axis and side.
    static faces = { Digit1: [0, -1], Digit2: [0, 1], Digit3: [1, -1], Digit4: [1, 1], Digit5: [2, -1], Digit6: [2, 1] };
    static stronger = 3;         // with shift
    static pixelsPerPush = 40;  // a pull by so many adds the strength of a click

    constructor(app, canvas) {
        this.app = app;
        addEventListener('keydown', event => this.#key(event));
        canvas.addEventListener('pointerdown', event => this.#down(event));
        canvas.addEventListener('pointermove', event => this.#move(event));
        for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => this.#up(event));
        addEventListener('dragover', event => event.preventDefault());
        addEventListener('drop', event => {
            event.preventDefault();
            if (event.dataTransfer.files.length > 0) app.openFile(event.dataTransfer.files[0]);
        });
    }

    // A pull that goes on is of another scene.
    forget() {
        this.pull = undefined;
        this.app.view.orbit.enabled = true;
        this.app.preview(undefined);
    }

    #key(event) {
        if (event.ctrlKey || event.metaKey || event.altKey || ['SELECT', 'TEXTAREA'].includes(event.target.tagName)) return;
        const { app } = this, strength = event.shiftKey ? Controls.stronger : 1;
        const done = (() => {
            if (Controls.pushes[event.code]) return app.pushTowards(Controls.pushes[event.code], strength), true;
            if (Controls.faces[event.code]) return app.pushFace(...Controls.faces[event.code], strength), true;
            switch (event.key) {
            case ' ': return app.pause(!app.paused), true;
            case '.': return app.step(1), true;
            case ',': return app.step(-1), true;
            case 'r': return app.seek(0), true;
            case 'b': return app.nextBody(), true;
            default: return false;
            }
        })();
        if (!done) return;
        event.preventDefault();
        document.activeElement?.blur();
    }

    // A press on a body begins a hit; one beside turns the view.
    #down(event) {
        const picked = event.button === 0 && event.isPrimary ? this.app.pick(event.clientX, event.clientY) : undefined;
        if (!picked) return;
        this.pull = { ...picked, x: event.clientX, y: event.clientY, strength: 1 };
        this.app.view.orbit.enabled = false;
        event.target.setPointerCapture(event.pointerId);
        this.app.preview(this.pull);
    }
    #move(event) {
        if (!this.pull) return;
        this.pull.strength = 1 + Math.hypot(event.clientX - this.pull.x, event.clientY - this.pull.y) / Controls.pixelsPerPush;
        this.app.preview(this.pull);
    }
    #up(event) {
        const { pull } = this;
        if (!pull) return;
        this.pull = undefined;
        this.app.view.orbit.enabled = true;
        this.app.preview(undefined);
        if (event.type === 'pointerup') this.app.pushAt(pull, pull.strength * (event.shiftKey ? Controls.stronger : 1));
    }
}
