// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel coordinates of a study with several objectives: all evaluations once, and above them what is chosen, so that a thousand lines follow the mouse.
import { valueLabel } from './charts.js';
import { h, section, svg } from './dom.js';
import { isDone, isGood, isNumber, number } from './format.js';
import { logTicks, ticks } from './front_words.js';
import { follow, Overlay, wash } from './overlay.js';

const kHeightPx = 400;
const kEdge = { left: 46, right: 70, top: 58, bottom: 16 };
const kLooks = { infeasible: ['#e3a27d', 1, [4, 3]], beaten: ['#aebac4', 1, []], front: ['#08306b', 1.7, []], chosen: ['#08306b', 3.4, []], picked: ['#d55e00', 3, []] };
const kReachPx = 6;

const kMarksApart = 0.06;  // of an axis, for two numbers not to touch

/** An axis: what it is called, where a value lies on it (0 bottom, 1 top), and its marks as [share, text]. */
function variableAxis(facts, variable, i) {
  const value = (trial) => trial.values?.[i];
  if (variable.choices?.length || variable.kind === 'boolean') {
    const choices = (variable.choices?.length ? variable.choices : [false, true]).map(String);
    const share = (one) => (choices.indexOf(String(one)) + 0.5) / choices.length;
    return { name: facts.names[i], value, share: (one) => (one === null || one === undefined ? NaN : share(one)), marks: choices.map((one) => [share(one), one]) };
  }
  const scale = variable.log && variable.low > 0 ? Math.log10 : (one) => one;
  const [low, high] = [scale(variable.low), scale(variable.high)];
  const share = (one) => (isNumber(one) ? (scale(one) - low) / (high - low || 1) : NaN);
  const isApart = (one) => Math.min(share(one), 1 - share(one)) > kMarksApart;
  const at = variable.log && variable.low > 0 ? [variable.low, ...logTicks(variable.low, variable.high).filter(isApart), variable.high] : ticks(low, high);
  return { name: facts.names[i], value, share, marks: [...new Set(at)].map((one) => [share(one), number(one)]) };
}

function scoreAxis(facts, name, done, suffix, isBold) {
  const value = (trial) => facts.scoreOf(trial, name);
  const all = done.map(value).filter(isNumber);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const share = (one) => (isNumber(one) ? (high > low ? (one - low) / (high - low) : 0.5) : NaN);
  const label = valueLabel(facts, name);
  return { name: `${facts.label(name)}${suffix}`, isBold, value, share, marks: ticks(low, high).map((one) => [share(one), label(one)]) };
}

class Parallel {
  constructor(facts, done, selection) {
    Object.assign(this, { facts, done, selection, members: new Set((facts.front.designs ?? []).map((design) => design.trial)), brushes: new Map() });
    const isObjective = (name) => facts.objectives.some((one) => one.name === name);
    const limited = facts.constraints.filter(({ name }) => !isObjective(name) && done.some((trial) => isNumber(trial.scores?.[name])));
    this.axes = [...facts.variables.map((variable, i) => variableAxis(facts, variable, i)), ...limited.map(({ name }) => scoreAxis(facts, name, done, '', false)),
      ...facts.objectives.map(({ name, maximise }) => scoreAxis(facts, name, done, maximise ? ' \u2191' : ' \u2193', true))];
    this.shares = done.map((trial) => this.axes.map((axis) => axis.share(axis.value(trial))));
    this.base = h('canvas', { class: 'base' });
    this.frame = svg('svg', { class: 'axes' });
    this.node = h('div', { class: 'parallel', id: 'parallel-chart', role: 'img', 'aria-label': 'Parallel coordinates' }, this.base, this.frame);
    this.overlay = new Overlay(this.node);
    this.count = h('span', { class: 'muted' });
    this.node.addEventListener('pointerdown', (event) => this.press(event));
    this.node.parallel = this;
    new ResizeObserver(() => this.layout()).observe(this.node);
    selection.listen(() => this.drawChosen());
    this.tell();
  }

  kind(trial) {
    if (trial.number === this.facts.front.chosen?.trial) return 'chosen';
    return this.members.has(trial.number) ? 'front' : isGood(trial) ? 'beaten' : 'infeasible';
  }

  layout() {
    const width = this.node.clientWidth;
    if (width === 0 || width === this.width) return;
    this.width = width;
    const gap = (width - kEdge.left - kEdge.right) / Math.max(1, this.axes.length - 1);
    this.xs = this.axes.map((_, i) => kEdge.left + i * gap);
    this.gap = gap;
    const ratio = window.devicePixelRatio || 1;
    Object.assign(this.base, { width: Math.round(width * ratio), height: Math.round(kHeightPx * ratio) });
    const context = this.base.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const kind of ['infeasible', 'beaten', 'front', 'chosen']) this.lines(context, this.done.filter((trial) => this.kind(trial) === kind), kind, 0.65);
    this.drawAxes();
    this.drawChosen();
  }

  y(share) { return kEdge.top + (1 - share) * (kHeightPx - kEdge.top - kEdge.bottom); }

  /** One path for all: quick. A value that is missing breaks the line. */
  lines(context, trials, kind, opacity) {
    const [colour, lineWidth, dash] = kLooks[kind];
    Object.assign(context, { strokeStyle: colour, lineWidth, globalAlpha: opacity, lineJoin: 'bevel' });
    context.setLineDash(trials.length > 200 ? [] : dash);
    this.index ??= new Map(this.done.map((trial, i) => [trial.number, i]));
    for (const trial of trials) {
      const shares = this.shares[this.index.get(trial.number)];
      context.beginPath();
      shares.forEach((share, i) => {
        if (Number.isNaN(share)) return;
        if (i === 0 || Number.isNaN(shares[i - 1])) context.moveTo(this.xs[i], this.y(share));
        else context.lineTo(this.xs[i], this.y(share));
      });
      context.stroke();
    }
    context.globalAlpha = 1;
    context.setLineDash([]);
  }

  drawAxes() {
    this.frame.setAttribute('viewBox', `0 0 ${this.width} ${kHeightPx}`);
    const lettersOf = Math.max(7, Math.floor((this.gap - 8) / 6.2));
    const text = (x, y, words, look) => svg('text', { x, y, ...look }, words);
    this.frame.replaceChildren(...this.axes.flatMap((axis, i) => {
      const x = this.xs[i];
      const rows = wrapped(axis.name, lettersOf);
      const titles = rows.map((row, k) => text(x, kEdge.top - 14 - 13 * (rows.length - 1 - k), row, { 'text-anchor': 'middle', 'font-size': 11, 'font-weight': axis.isBold ? 700 : 400, fill: '#27313a' }));
      const marks = axis.marks.filter(([share]) => share >= -0.001 && share <= 1.001).map(([share, words]) => text(x + 6, this.y(share) + 4, words, { 'font-size': 10.5, fill: '#27313a', stroke: '#fff', 'stroke-width': 3, 'paint-order': 'stroke' }));
      return [svg('line', { x1: x, x2: x, y1: this.y(0), y2: this.y(1), stroke: '#87919a' }), ...titles, ...marks];
    }));
  }

  /** What is chosen here and elsewhere, and the line that is looked at. */
  drawChosen() {
    if (!this.width) return;
    const kept = this.selection.chosen();
    const context = this.overlay.begin();
    this.overlay.canvas.dataset.kept = kept ? kept.size : '';
    if (kept) {
      wash(context, { left: 0, top: kEdge.top - 2, width: this.width, height: kHeightPx - kEdge.top });
      const inside = this.done.filter((trial) => kept.has(trial.number));
      for (const kind of ['infeasible', 'beaten', 'front', 'chosen']) this.lines(context, inside.filter((trial) => this.kind(trial) === kind), kind, inside.length > 300 ? 0.6 : 0.85);
    }
    this.lines(context, this.done.filter((trial) => trial.number === this.selection.picked), 'picked', 0.9);
    context.fillStyle = 'rgba(29, 37, 44, 0.16)';
    for (const [i, [low, high]] of this.brushes) {
      context.fillRect(this.xs[i] - 9, this.y(high), 18, this.y(low) - this.y(high));
      Object.assign(context, { strokeStyle: '#27313a', lineWidth: 1 });
      context.strokeRect(this.xs[i] - 9, this.y(high), 18, this.y(low) - this.y(high));
    }
  }

  /** Keeps what passes between two places of an axis, as shares of its length; null: all. */
  brush(i, between) {
    if (between === null) this.brushes.delete(i);
    else this.brushes.set(i, between);
    this.change();
  }

  clear() {
    this.brushes.clear();
    this.change();
  }

  change() {
    const passes = (shares) => [...this.brushes].every(([i, [low, high]]) => shares[i] >= low && shares[i] <= high);
    const numbers = this.brushes.size ? new Set(this.done.filter((_, k) => passes(this.shares[k])).map((trial) => trial.number)) : null;
    this.tell(numbers);
    if (numbers || this.selection.brushes.has('parallel')) this.selection.brush('parallel', numbers);
    else this.drawChosen();
  }

  tell(numbers = null) { this.count.textContent = numbers ? `${numbers.size} of ${this.done.length} evaluations chosen` : `all ${this.done.length} evaluations`; }

  at(event) {
    const { left, top } = this.node.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  /** Along an axis: a brush; elsewhere: the line that is nearest. */
  press(event) {
    const [x, y] = this.at(event);
    const i = this.xs.findIndex((one) => Math.abs(one - x) <= 12);
    if (event.button !== 0) return;
    if (i < 0) {
      this.pickAt(x, y);
      return;
    }
    const share = (place) => Math.min(1, Math.max(0, 1 - (place - kEdge.top) / (kHeightPx - kEdge.top - kEdge.bottom)));
    event.preventDefault();
    const show = ([, to]) => this.brush(i, [Math.min(share(y), share(to)), Math.max(share(y), share(to))]);
    follow(event, (next) => this.at(next), show, (place, far) => (far ? show(place) : this.brush(i, null)));
  }

  pickAt(x, y) {
    const i = this.xs.findIndex((one, k) => x >= one && x <= this.xs[k + 1]);
    if (i < 0) return;
    const part = (x - this.xs[i]) / this.gap;
    const far = this.shares.map((shares) => Math.abs(this.y(shares[i] + part * (shares[i + 1] - shares[i])) - y));
    const weight = (k) => (this.members.has(this.done[k].number) ? 0.6 : 1) * far[k];
    const best = far.reduce((least, one, k) => (!Number.isNaN(one) && one <= kReachPx && (least < 0 || weight(k) < weight(least)) ? k : least), -1);
    if (best >= 0) this.selection.pick(this.done[best].number);
  }
}

/** Words on rows of about so many letters. */
function wrapped(words, letters) {
  const rows = [''];
  for (const word of words.split(' ')) {
    const row = rows[rows.length - 1];
    if (row && row.length + 1 + word.length > letters) rows.push(word);
    else rows[rows.length - 1] = row ? `${row} ${word}` : word;
  }
  return rows.slice(0, 4);
}

export function frontParallelSection(facts, selection) {
  const done = facts.trials.filter(isDone);
  if (!facts.front || done.length < 2 || !facts.variables.length) return null;
  const chart = new Parallel(facts, done, selection);
  return section('parallel', 'All variables together', 'Each line is one evaluation; dark blue ones are the front, the thickest is the compromise, brown ones are not feasible. Drag along an axis to keep what passes through: front, pictures and tables follow. Click a line to look at its design.',
    h('p', { class: 'toolbar' }, chart.count, h('button', { type: 'button', class: 'screen-only', onclick: () => chart.clear() }, 'Clear the brushes')), chart.node);
}
