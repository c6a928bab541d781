// SPDX-License-Identifier: GPL-3.0-or-later
// The designs side by side: sequence player, aspect image, defects, scores, drawing.
import { badge, enlarge, h, picture, pngUrl, section, svgNode } from './dom.js';
import { isNumber, number, percent, shortNames } from './format.js';

const kFrameMs = 110;

/** Moves the frames of all players, together or one by one. */
class Players {
  constructor() {
    this.list = [];
    this.linked = true;
  }

  add(player) { this.list.push(player); }
  group(player) { return this.linked ? this.list : [player]; }

  seek(player, fraction) {
    for (const other of this.group(player)) other.show(Math.round(fraction * (other.count - 1)));
  }

  step(player) {
    const next = (player.index + 1) % player.count;
    for (const other of this.group(player)) other.show(other === player ? next : (other.index + 1) % other.count);
  }

  toggle(player) {
    const wasPlaying = player.timer !== null;
    for (const other of this.list) other.stop();
    if (wasPlaying) return;
    player.timer = setInterval(() => this.step(player), kFrameMs);
    player.button.textContent = 'Pause';
  }
}

class Player {
  constructor(frames, title, players) {
    this.frames = frames;
    this.count = frames.length;
    this.index = 0;
    this.timer = null;
    this.image = h('img', { alt: `${title}: image sequence`, class: 'frame' });
    this.slider = h('input', { type: 'range', min: '0', max: String(this.count - 1), value: '0', 'aria-label': `${title}: position of the fringes`,
      oninput: () => players.seek(this, this.count > 1 ? this.slider.valueAsNumber / (this.count - 1) : 0) });
    this.label = h('output', {});
    this.button = h('button', { type: 'button', class: 'play', onclick: () => players.toggle(this) }, 'Play');
    this.node = h('div', { class: 'player' },
      h('button', { class: 'picture', type: 'button', title: 'Show large', onclick: () => enlarge(this.image.src, `${title}, image ${this.index + 1} of ${this.count}`) }, this.image),
      this.count > 1 && h('div', { class: 'controls' }, this.button, this.slider, this.label));
    this.show(0);
  }

  show(index) {
    this.index = Math.min(index, this.count - 1);
    this.image.src = pngUrl(this.frames[this.index]);
    this.slider.value = String(this.index);
    this.label.textContent = `${this.index + 1} / ${this.count}`;
  }

  stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.button.textContent = 'Play';
  }
}

const block = (kind, title, ...children) => h('div', { class: `block ${kind}` }, title && h('h4', {}, title), children);

function stateBadge(design) {
  if (design.feasible === undefined || design.feasible === null) return null;
  return design.feasible ? badge('good', 'feasible') : badge('bad', 'not feasible');
}

function header(facts, design) {
  const role = facts.role(design);
  const trial = isNumber(design.trial) ? `evaluation ${design.trial}` : null;
  return h('header', {}, h('h3', {}, facts.title(design)),
    h('p', {}, role !== 'design' && badge(role, facts.roleName(design)), stateBadge(design), [design.run, trial].filter(Boolean).map((text) => h('span', { class: 'muted' }, text))));
}

function sequence(facts, design, players) {
  if (!design.frames?.length) return block('sequence', 'Sequence', h('p', { class: 'muted' }, 'No images were kept.'));
  const player = new Player(design.frames, facts.title(design), players);
  players.add(player);
  return block('sequence', design.frames.length > 1 ? `Sequence of ${design.frames.length} images` : 'Image', player.node);
}

function aspect(facts, design) {
  if (!design.aspect) return block('mean');
  return block('mean', 'Mean image of the sequence', picture(design.aspect, `${facts.title(design)}: mean image`, 'frame'));
}

/** The longest of 1, 2 and 5 times powers of ten that is at most so long. */
function roundBelow(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [5, 2, 1].find((step) => step * power <= length * 1.000001);
}

/** A bar of a round length over the lower left corner of a picture. */
function scaleBar({ pixel_mm: pixel, size_px: size }) {
  if (!isNumber(pixel) || !size) return null;
  const length = roundBelow(0.45 * pixel * size[0]);
  const text = length < 0.1 ? `${number(1000 * length)} \u00b5m` : `${number(length)} mm`;
  return h('span', { class: 'scale' }, h('i', { style: `width:${(100 * length) / (pixel * size[0])}%` }), h('em', {}, text));
}

export function closeupFigure(facts, design, closeup) {
  const scores = Object.entries(closeup.scores ?? {}).slice(0, 3).map(([name, value]) =>
    h('span', { title: facts.meaning(name) }, `${facts.label(name)} ${facts.score(name, value)}`));
  const shown = [closeup.picture, isNumber(closeup.low) && `black ${percent(closeup.low)}, white ${percent(closeup.high)}`].filter(Boolean).join(': ');
  return h('figure', {}, closeup.image && h('div', { class: 'scaled' }, picture(closeup.image, `${facts.title(design)}: ${closeup.label}`, 'closeup'), scaleBar(closeup)),
    h('figcaption', {}, h('b', {}, closeup.label), closeup.size && h('span', { class: 'screen-only' }, closeup.size), shown && h('span', { class: 'screen-only' }, shown), scores));
}

function closeups(facts, design) {
  if (!design.closeups?.length) return block('defects');
  const lead = design.closeups.some((closeup) => isNumber(closeup.low)) && h('p', { class: 'muted' }, 'Grey values stretched: black and white are shares of full scale.');
  return block('defects', 'Defects, close up', lead, h('div', { class: 'closeups' }, design.closeups.map((closeup) => closeupFigure(facts, design, closeup))));
}

function scores(facts, design) {
  const main = facts.mainScores();
  const names = [...main, ...Object.keys(design.scores ?? {}).filter((name) => !main.includes(name) && !name.endsWith('.error'))];
  const hasFresh = Object.keys(design.rescored ?? {}).length > 0;
  const row = (name) => {
    const constraint = facts.constraints.find((one) => one.name === name);
    const fails = constraint && !facts.meets(constraint, facts.value(design, name));
    return h('tr', { class: [main.includes(name) ? 'main' : '', fails ? 'fails' : ''].join(' ').trim() },
      h('th', { title: facts.meaning(name) }, facts.label(name), constraint && h('small', {}, ` ${facts.limit(constraint)}`)),
      h('td', {}, facts.scoreWithError(name, design.scores), fails && !hasFresh && ' \u2717'),
      hasFresh && h('td', {}, facts.scoreWithError(name, design.rescored), fails && ' \u2717'));
  };
  const head = hasFresh && h('thead', {}, h('tr', {}, h('th', {}), h('th', {}, facts.origin(design)), h('th', {}, 'fresh seeds')));
  const table = (list) => h('table', { class: 'scores' }, head && head.cloneNode(true), h('tbody', {}, list.map(row)));
  const rest = names.slice(main.length);
  if (!names.length) return block('numbers', 'Scores', h('p', { class: 'muted' }, 'No scores.'));
  return block('numbers', 'Scores', table(names.slice(0, main.length)),
    rest.length > 0 && h('details', { class: 'screen-only' }, h('summary', {}, `${rest.length} more`), table(rest)));
}

function drawing(design) {
  if (!design.drawing) return block('sheet');
  return block('sheet', 'Lighting, to scale', h('div', { class: 'drawing' }, svgNode(design.drawing)));
}

/** What is said of every design is said once, below them. */
function commonNotes(designs) {
  const [first, ...others] = designs;
  return others.length ? (first.notes ?? []).filter((note) => others.every((design) => design.notes?.includes(note))) : [];
}

const notesList = (notes, kind = '') => notes.length > 0 && h('ul', { class: `notes ${kind}` }, notes.map((note) => h('li', {}, note)));

function settings(facts, design, common) {
  const paths = Object.keys(design.variables ?? {});
  const notes = (design.notes ?? []).filter((note) => !common.includes(note));
  if (!paths.length && !notes.length) return block('settings');
  const names = shortNames(paths);
  const rows = paths.map((path, i) => h('tr', {}, h('th', { title: path }, names[i]), h('td', {}, number(design.variables[path]))));
  return block('settings', null,
    paths.length > 0 && h('details', { class: 'variables', open: paths.length <= 6 || facts.role(design) === 'winner' }, h('summary', {}, 'Variables'), h('table', { class: 'scores' }, h('tbody', {}, rows))),
    notesList(notes, 'screen-only'));
}

/** Of three columns: the last rows take two wider cards where three would leave a gap. */
function columns(index, count) {
  const wide = count === 1 ? 0 : [0, 4, 2][count % 3];
  return index >= count - wide ? 'half' : 'third';
}

/** One card a design, pictures aligned across cards. */
export function designSection(facts) {
  if (!facts.designs.length) return null;
  const players = new Players();
  const place = (design) => ({ winner: 0, baseline: 1 })[facts.role(design)] ?? 2;
  const ordered = [...facts.designs].sort((a, b) => place(a) - place(b));
  const common = commonNotes(ordered);
  const cards = ordered.map((design, i) => h('article', { class: `card ${facts.role(design)} ${columns(i, ordered.length)}`, id: `design-${design.key}` },
    header(facts, design), sequence(facts, design, players), aspect(facts, design),
    h('div', { class: 'rest' }, closeups(facts, design), scores(facts, design), drawing(design), settings(facts, design, common))));
  const linked = players.list.filter((player) => player.count > 1).length > 1 && h('label', { class: 'inline screen-only' },
    h('input', { type: 'checkbox', checked: true, onchange: (event) => { players.linked = event.target.checked; } }), ' Move all sequences together');
  const title = facts.designs.length > 1 ? 'Designs side by side' : 'The design';
  return section('designs', title, 'All pictures are linear grey values after the sensor, drawn with the same exposure. Click one to see it large.', linked,
    h('div', { class: 'cards' }, cards), notesList(common));
}
