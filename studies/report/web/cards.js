// SPDX-License-Identifier: GPL-3.0-or-later
// The designs side by side: sequence player, aspect image, defects, scores, drawing.
import { badge, enlarge, h, picture, pngUrl, section, svgNode } from './dom.js';
import { isNumber, number, shortNames } from './format.js';

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

const block = (title, ...children) => h('div', { class: 'block' }, title && h('h4', {}, title), children);

function stateBadge(design) {
  if (design.feasible === undefined || design.feasible === null) return null;
  return design.feasible ? badge('good', 'feasible') : badge('bad', 'not feasible');
}

function header(facts, design) {
  const role = facts.role(design);
  const trial = isNumber(design.trial) ? `evaluation ${design.trial}` : null;
  return h('header', {}, h('h3', {}, facts.title(design)),
    h('p', {}, role !== 'design' && badge(role, role), stateBadge(design), [design.run, trial].filter(Boolean).map((text) => h('span', { class: 'muted' }, text))));
}

function sequence(facts, design, players) {
  if (!design.frames?.length) return block('Sequence', h('p', { class: 'muted' }, 'No images were kept.'));
  const player = new Player(design.frames, facts.title(design), players);
  players.add(player);
  return block(design.frames.length > 1 ? `Sequence of ${design.frames.length} images` : 'Image', player.node);
}

function aspect(facts, design) {
  if (!design.aspect) return block(null);
  return block('Mean image of the sequence', picture(design.aspect, `${facts.title(design)}: mean image`, 'frame'));
}

function closeups(facts, design) {
  if (!design.closeups?.length) return block(null);
  const cells = design.closeups.map((closeup) => {
    const scores = Object.entries(closeup.scores ?? {}).slice(0, 3).map(([name, value]) =>
      h('span', {}, `${facts.label(name).split(': ').pop()} ${facts.score(name, value)}`));
    return h('figure', {}, closeup.image && picture(closeup.image, `${facts.title(design)}: ${closeup.label}`, 'closeup'),
      h('figcaption', {}, h('b', {}, closeup.label), scores));
  });
  return block('Defects, close up', h('div', { class: 'closeups' }, cells));
}

function scores(facts, design) {
  const main = facts.mainScores();
  const names = [...main, ...Object.keys(design.scores ?? {}).filter((name) => !main.includes(name) && !name.endsWith('.error'))];
  const hasFresh = Object.keys(design.rescored ?? {}).length > 0;
  const row = (name) => {
    const constraint = facts.constraints.find((one) => one.name === name);
    const fails = constraint && !facts.meets(constraint, facts.value(design, name));
    return h('tr', { class: [main.includes(name) ? 'main' : '', fails ? 'fails' : ''].join(' ').trim() },
      h('th', { title: name }, facts.label(name), constraint && h('small', {}, ` ${facts.limit(constraint)}`)),
      h('td', {}, facts.scoreWithError(name, design.scores), fails && !hasFresh && ' \u2717'),
      hasFresh && h('td', {}, facts.scoreWithError(name, design.rescored), fails && ' \u2717'));
  };
  const head = hasFresh && h('thead', {}, h('tr', {}, h('th', {}), h('th', {}, 'search'), h('th', {}, 'fresh seeds')));
  const table = (list) => h('table', { class: 'scores' }, head && head.cloneNode(true), h('tbody', {}, list.map(row)));
  const rest = names.slice(main.length);
  if (!names.length) return block('Scores', h('p', { class: 'muted' }, 'No scores.'));
  return block('Scores', table(names.slice(0, main.length)),
    rest.length > 0 && h('details', {}, h('summary', {}, `${rest.length} more`), table(rest)));
}

function drawing(design) {
  if (!design.drawing) return block(null);
  return block('Lighting, to scale', h('div', { class: 'drawing' }, svgNode(design.drawing)));
}

function settings(facts, design) {
  const paths = Object.keys(design.variables ?? {});
  if (!paths.length && !design.notes?.length) return block(null);
  const names = shortNames(paths);
  const rows = paths.map((path, i) => h('tr', {}, h('th', { title: path }, names[i]), h('td', {}, number(design.variables[path]))));
  return block(null,
    paths.length > 0 && h('details', { open: paths.length <= 6 || facts.role(design) === 'winner' }, h('summary', {}, 'Variables'), h('table', { class: 'scores' }, h('tbody', {}, rows))),
    design.notes?.length > 0 && h('ul', { class: 'notes' }, design.notes.map((note) => h('li', {}, note))));
}

/** One card a design, rows aligned across cards. */
export function designSection(facts) {
  if (!facts.designs.length) return null;
  const players = new Players();
  const place = (design) => ({ winner: 0, baseline: 1 })[facts.role(design)] ?? 2;
  const ordered = [...facts.designs].sort((a, b) => place(a) - place(b));
  const cards = ordered.map((design) => h('article', { class: `card ${facts.role(design)}`, id: `design-${design.key}` },
    header(facts, design), sequence(facts, design, players), aspect(facts, design), closeups(facts, design),
    scores(facts, design), drawing(design), settings(facts, design)));
  const linked = players.list.filter((player) => player.count > 1).length > 1 && h('label', { class: 'inline screen-only' },
    h('input', { type: 'checkbox', checked: true, onchange: (event) => { players.linked = event.target.checked; } }), ' Move all sequences together');
  const title = facts.designs.length > 1 ? 'Designs side by side' : 'The design';
  return section('designs', title, 'All pictures are linear grey values after the sensor, drawn with the same exposure. Click one to see it large.', linked,
    h('div', { class: 'cards' }, cards));
}
