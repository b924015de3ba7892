// Debian's Chromium without a window, driven over its debugging pipe. Every error that the page throws or writes to its
// console is kept.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// Of keys that are not letters or digits, the name of the place on the keyboard and the code of the key.
const places = { ' ': ['Space', 32], '.': ['Period', 190], ',': ['Comma', 188], PageUp: ['PageUp', 33],
                 PageDown: ['PageDown', 34], ArrowLeft: ['ArrowLeft', 37], ArrowUp: ['ArrowUp', 38],
                 ArrowRight: ['ArrowRight', 39], ArrowDown: ['ArrowDown', 40] };
const placeOf = key => {
    const upper = key.toUpperCase();
    return places[key] ?? [(/[0-9]/.test(key) ? 'Digit' : 'Key') + upper, upper.charCodeAt(0)];
};

export const wait = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));

export class Browser {
    errors = [];

    // A page of this size, loaded; `ready` is an expression that is true when it can be used.
    static async open(url, { width = 1280, height = 720, ready = 'window.ready === true' } = {}) {
        const browser = new Browser();
        browser.profile = mkdtempSync(join(tmpdir(), 'page-'));
        browser.process = spawn('chromium', ['--headless=new', '--no-sandbox', '--enable-unsafe-swiftshader',
            '--remote-debugging-pipe', `--window-size=${width},${height}`, '--hide-scrollbars',
            `--user-data-dir=${browser.profile}`, 'about:blank'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
        browser.process.stdio[4].on('data', data => browser.#read(data));
        const { targetId } = await browser.#call('Target.createTarget', { url: 'about:blank' });
        browser.session = (await browser.#call('Target.attachToTarget', { targetId, flatten: true })).sessionId;
        for (const domain of ['Runtime', 'Log', 'Page']) await browser.page(`${domain}.enable`);
        await browser.page('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: width < 600 });
        const start = performance.now();
        await browser.page('Page.navigate', { url });
        while (!await browser.value(ready)) {
            if (performance.now() - start > 60000)
                throw new Error(`the page is not ready after 60 s; ${browser.errors.join('\n')}`);
            await wait(20);
        }
        browser.readyAfter = performance.now() - start;
        return browser;
    }
    async close() {
        const ended = new Promise(resolve => this.process.on('exit', resolve));
        await this.#call('Browser.close');
        await ended;
        rmSync(this.profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
    }

    page(method, parameters) { return this.#call(method, parameters, this.session); }
    // The value of an expression, or of the promise that it is.
    async value(expression) {
        const { result, exceptionDetails } =
            await this.page('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    }
    // The value of a function of the page's own names, with arguments that JSON can hold.
    run(body, ...values) { return this.value(`(${body})(${values.map(v => JSON.stringify(v)).join(', ')})`); }

    async key(key, { shift = false } = {}) {
        const [code, windowsVirtualKeyCode] = placeOf(key), modifiers = shift ? 8 : 0;
        for (const type of ['keyDown', 'keyUp'])
            await this.page('Input.dispatchKeyEvent', { type, key, code, windowsVirtualKeyCode, modifiers });
    }
    // Presses at one point and lets go at another.
    async drag(x, y, toX = x, toY = y) {
        const left = { button: 'left', buttons: 1, clickCount: 1 };
        const event = (type, atX, atY) => this.page('Input.dispatchMouseEvent', { type, x: atX, y: atY, ...left });
        await event('mousePressed', x, y);
        if (toX !== x || toY !== y) await event('mouseMoved', toX, toY);
        await event('mouseReleased', toX, toY);
    }
    async touch(x, y) {
        await this.page('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y }] });
        await this.page('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    }
    async picture(file, format = 'png', quality) {
        const { data } = await this.page('Page.captureScreenshot', { format, quality });
        writeFileSync(file, Buffer.from(data, 'base64'));
    }

    #text = '';
    #next = 1;
    #waiting = new Map();
    #read(data) {
        this.#text += data;
        for (let end; (end = this.#text.indexOf('\0')) >= 0;) {
            const message = JSON.parse(this.#text.slice(0, end));
            this.#text = this.#text.slice(end + 1);
            if (message.id) {
                const [resolve, reject] = this.#waiting.get(message.id);
                this.#waiting.delete(message.id);
                if (message.error) reject(new Error(message.error.message));
                else resolve(message.result);
            } else if (message.method === 'Runtime.exceptionThrown') {
                const { exception, text } = message.params.exceptionDetails;
                this.errors.push(exception?.description ?? text);
            } else if (message.method === 'Log.entryAdded' && message.params.entry.level === 'error') {
                this.errors.push(message.params.entry.text);
            } else if (message.method === 'Runtime.consoleAPICalled' && ['error', 'assert'].includes(message.params.type)) {
                this.errors.push(message.params.args.map(a => a.value ?? a.description).join(' '));
            }
        }
    }
    #call(method, params = {}, sessionId) {
        return new Promise((resolve, reject) => {
            this.#waiting.set(this.#next, [resolve, reject]);
            this.process.stdio[3].write(JSON.stringify({ id: this.#next++, method, params, sessionId }) + '\0');
        });
    }
}
