// SPDX-License-Identifier: GPL-3.0-or-later
//
// A headless Chromium that is steered through a pipe.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** The protocol of Chromium's developer tools over file descriptors 3 and 4: JSON texts that end in a zero byte. */
export class Browser {
  constructor(program) {
    this.profile = mkdtempSync(join(tmpdir(), 'glint-browser-'));
    this.child = spawn(program, ['--headless', '--no-sandbox', '--disable-gpu', '--remote-debugging-pipe', `--user-data-dir=${this.profile}`, 'about:blank'],
      { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
    this.waiting = new Map();
    this.last = 0;
    let text = '';
    this.child.stdio[4].on('data', (block) => {
      const parts = (text + block).split('\0');
      text = parts.pop();
      for (const part of parts) this.answer(JSON.parse(part));
    });
  }

  answer({ id, result, error }) {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    this.waiting.delete(id);
    if (error) waiting.reject(new Error(error.message));
    else waiting.resolve(result);
  }

  send(method, params = {}, sessionId = this.session) {
    const id = ++this.last;
    this.child.stdio[3].write(`${JSON.stringify({ id, method, params, ...(sessionId && { sessionId }) })}\0`);
    return new Promise((done, failed) => { this.waiting.set(id, { resolve: done, reject: failed }); });
  }

  /** Not to its page. */
  sendToBrowser(method) { return this.send(method, {}, ''); }

  async attach() {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    this.session = sessionId;
    await this.send('Page.enable');
    await this.send('Emulation.setScrollbarsHidden', { hidden: true });
  }

  async open(url) {
    await this.send('Page.navigate', { url });
    await this.evaluate(`new Promise((done) => { const look = () => (document.readyState === 'complete' && document.querySelector('main') ? setTimeout(done, 500) : setTimeout(look, 50)); look(); })`);
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  resize(width, height = 1000) {
    return this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  }

  /** A picture of the whole page, or of one element of it. @param selector  of CSS; null: the page */
  async screenshot(selector = null) {
    const box = await this.evaluate(`(() => { const { left, top, width, height } = (${selector ? `document.querySelector(${JSON.stringify(selector)})` : 'document.documentElement'}).getBoundingClientRect();
      return { x: left + scrollX, y: top + scrollY, width, height }; })()`);
    const { data } = await this.send('Page.captureScreenshot', { captureBeyondViewport: true, clip: { ...box, scale: 1 } });
    return Buffer.from(data, 'base64');
  }

  /** The left button pressed at one place of the window and let go at another. */
  async drag([x, y], [toX, toY]) {
    const mouse = (type, at, extra) => this.send('Input.dispatchMouseEvent', { type, x: at[0], y: at[1], button: 'left', clickCount: 1, ...extra });
    await mouse('mousePressed', [x, y], { buttons: 1 });
    if (x !== toX || y !== toY) await mouse('mouseMoved', [toX, toY], { buttons: 1 });
    await mouse('mouseReleased', [toX, toY], { buttons: 0 });
  }

  click(place) { return this.drag(place, place); }

  close() {
    this.child.on('exit', () => rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 }));
    this.child.kill();
  }
}
