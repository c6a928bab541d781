// SPDX-License-Identifier: GPL-3.0-or-later
// The front of several objectives: a scatter of two, a matrix of more; the design that is looked at; pictures; the table. All follow each other.
import { axisStyle, chart, encode, kHalo, kInk, kText, valueLabel } from './charts.js';
import { closeupFigure } from './cards.js';
import { badge, h, picture, pngUrl, section, svg, svgNode } from './dom.js';
import { chosenText, frontWords, panelsOf, setLine, staircase } from './front_words.js';
import { isDone, isGood, isNumber, number, percent, plural, shortNames, stateOf } from './format.js';
import { discs, follow, Overlay, wash } from './overlay.js';
import { order } from './table.js';

const kBlue = '#0072b2';
const kGrey = '#aab4bd';
const kOrange = '#d55e00';
const kTold = 5e-4;  // an error of less than that part of its value changes none of the digits that are shown
const kReach = { design: 14, trial: 9 };  // pixels around a mark in which a click means it
const kCross = 'path://M0,2L2,0L5,3L8,0L10,2L7,5L10,8L8,10L5,7L2,10L0,8L3,5Z';
const kPrintedRows = 12;
const kShortNamePx = 190;  // a panel has no room for more than the score's name below
const kManyTrials = 300;  // above this a canvas: the parts follow each other within 100 ms

/** What the page knows of an evaluation: its place on the front, and the variables by their paths. */
class Members {
  constructor(facts) {
    this.facts = facts;
    this.designs = facts.front.designs ?? [];
    this.byTrial = new Map(this.designs.map((design) => [design.trial, design]));
    this.trials = new Map(facts.trials.map((trial) => [trial.number, trial]));
    this.chosen = facts.front.chosen?.trial ?? null;
    this.words = frontWords(facts.front);
    this.winner = facts.designs.find((design) => facts.role(design) === 'winner' && design.trial === this.chosen);
  }

  variablesOf(number) {
    const design = this.byTrial.get(number);
    if (design) return design.variables;
    const values = this.trials.get(number)?.values ?? [];
    return Object.fromEntries(this.facts.variables.map((variable, i) => [variable.name, values[i]]).filter(([, value]) => value !== null && value !== undefined));
  }

  /** As the search saw it, with errors where there are any. */
  searched(number) {
    const design = this.byTrial.get(number);
    const trial = this.trials.get(number);
    const own = { ...trial?.scores, ...(isNumber(trial?.objective) && { [this.facts.objective.name]: trial.objective }) };
    for (const [name, error] of Object.entries(design?.errors ?? {})) own[`${name}.error`] = error;
    return own;
  }

  /** ", expected 81 % ± 2 %" of a design of a front that is made of it. */
  expected(number, name) {
    const design = this.byTrial.get(number);
    const value = this.facts.front.is_expected ? design?.expected?.[name] : null;
    return value ? `, expected ${this.facts.scoreWithError(name, { [name]: value.value, [`${name}.error`]: value.sd })}` : '';
  }

  fresh(number) {
    const design = this.byTrial.get(number);
    if (!design?.rescored) return (number === this.chosen && this.winner?.rescored) || {};
    const told = Object.entries(design.rescored_errors ?? {}).filter(([name, error]) => error > kTold * Math.abs(design.rescored[name]));
    return { ...design.rescored, ...Object.fromEntries(told.map(([name, error]) => [`${name}.error`, error])) };
  }

  /** Marks of a design of the front: [kind, text]. */
  badges(number) {
    const design = this.byTrial.get(number);
    return [number === this.chosen && ['winner', 'compromise'], design && number !== this.chosen && ['good', 'front'],
      design?.dominated_by && ['bad', `beaten by ${design.dominated_by} with fresh seeds`], design?.keeps_limits === false && ['bad', 'misses a limit with fresh seeds']].filter(Boolean);
  }
}

/** The text of a point's tip. */
function pointText(facts, members, { trial, design }) {
  const scores = trial ? members.searched(trial.number) : design.scores;
  const head = trial ? `<b>evaluation ${trial.number}</b>, ${[stateOf(trial), members.byTrial.has(trial.number) && 'on the front'].filter(Boolean).join(', ')}` : `<b>${encode(facts.title(design))}</b>`;
  const lines = [head, ...[...facts.objectives, ...facts.constraints].map(({ name }) => `${encode(facts.label(name))}: ${facts.scoreWithError(name, scores)}${trial ? members.expected(trial.number, name) : ''}`)];
  if (trial) facts.names.slice(0, 10).forEach((name, i) => lines.push(`${encode(name)}: ${encode(number(trial.values?.[i]))}`));
  return lines.join('<br>');
}

class FrontChart {
  constructor(facts, members, selection) {
    Object.assign(this, { facts, members, selection, panels: panelsOf(facts.objectives) });
    this.count = facts.objectives.length - 1;
    this.done = facts.trials.filter(isDone);
    this.full = h('input', { type: 'checkbox', onchange: () => this.instance?.setOption(this.option(this.place.clientWidth)) });
    this.clear = h('button', { type: 'button', class: 'screen-only', onclick: () => this.brush(null) }, 'Clear the frame');
    this.heightPx = this.count === 1 ? 460 : Math.min(250 * this.count + 70, 1100);
    this.place = chart(this.heightPx, 'The front', this.done.length > kManyTrials ? Infinity : 0, (width) => this.option(width), (instance) => this.start(instance));
    this.place.id = 'front-chart';
    this.frame = h('div', { class: 'brush-frame', hidden: true });
    selection.listen(() => this.follow());
  }

  start(instance) {
    this.instance = instance;
    this.place.chart = instance;
    this.overlay = new Overlay(this.place);
    this.place.append(this.frame);
    this.place.addEventListener('pointerdown', (event) => this.press(event));
    this.follow();
  }

  range(objective) {
    const [low, high] = this.facts.objectiveRange(objective);
    if (!this.full.checked) return [low, high];
    const values = this.done.map((trial) => this.facts.scoreOf(trial, objective.name)).filter(isNumber);
    return [Math.min(low, ...values), Math.max(high, ...values)];
  }

  grids(width) {
    const [left, right, top, bottom] = [74, 22, 12, 54];
    const gap = 18;
    const cell = { width: (width - left - right - gap * (this.count - 1)) / this.count, height: (this.heightPx - top - bottom - gap * (this.count - 1)) / this.count };
    return this.panels.map((panel) => ({ left: left + panel.column * (cell.width + gap), top: top + panel.row * (cell.height + gap), width: cell.width, height: cell.height }));
  }

  axes(width) {
    const narrow = this.grids(width)[0].width < kShortNamePx;
    const axis = (objective, index, isShown, side) => {
      const [min, max] = this.range(objective);
      const arrow = objective.maximise ? ' \u2192' : ' \u2190';  // along the name, which is turned at y
      return { type: 'value', gridIndex: index, min, max, splitNumber: this.count === 1 ? 5 : 3, name: isShown ? `${side === 'x' && narrow ? this.facts.label(objective.name) : this.facts.axisName(objective)}${arrow}` : '', nameLocation: 'middle', nameGap: side === 'x' ? 30 : 52, ...axisStyle,
        nameTextStyle: { color: kInk, fontSize: this.count > 2 || width < 620 ? 11 : 12, overflow: 'break', width: Math.max(120, width / this.count - 60) },
        axisLabel: { color: '#55606a', show: isShown, showMinLabel: false, showMaxLabel: false, hideOverlap: true, formatter: valueLabel(this.facts, objective.name) } };
    };
    return { xAxis: this.panels.map((panel, k) => axis(panel.x, k, panel.row === this.count - 1, 'x')), yAxis: this.panels.map((panel, k) => axis(panel.y, k, panel.column === 0, 'y')) };
  }

  placeOf(scores, panel) { return [scores?.[panel.x.name], scores?.[panel.y.name]]; }

  /** Where a trial is drawn: of the front what the front is made of. */
  point(trial, panel) {
    const design = this.members.byTrial.get(trial.number);
    return design ? this.placeOf(design.scores, panel) : [this.facts.scoreOf(trial, panel.x.name), this.facts.scoreOf(trial, panel.y.name)];
  }

  /** The designs beside the search: baseline and prototypes, as the search would score them. */
  others() { return this.facts.designs.filter((design) => this.facts.role(design) !== 'winner'); }

  series() {
    const common = (k, id) => ({ id: `${k}/${id}`, xAxisIndex: k, yAxisIndex: k, type: 'scatter', emphasis: { scale: 1.4 } });
    const item = (panel) => (trial) => ({ value: this.point(trial, panel), trial });
    const beaten = this.done.filter((trial) => isGood(trial) && !this.members.byTrial.has(trial.number));
    const infeasible = this.done.filter((trial) => !isGood(trial));
    return this.panels.flatMap((panel, k) => [
      { ...common(k, 'infeasible'), name: 'not feasible', symbol: 'triangle', symbolSize: 5, itemStyle: { color: 'transparent', borderColor: kOrange, borderWidth: 1, opacity: 0.5 }, data: infeasible.map(item(panel)) },
      { ...common(k, 'beaten'), name: this.members.words.beaten, symbol: 'circle', symbolSize: 6, itemStyle: { color: kGrey, opacity: 0.75 }, data: beaten.map(item(panel)) },
      ...this.linkSeries(panel, k), ...this.freshSeries(panel, k),
      { ...common(k, 'front'), name: 'front', symbol: 'circle', symbolSize: 10, itemStyle: { color: kBlue }, z: 5, data: this.frontData(panel) },
      { ...common(k, 'others'), name: 'baseline and prototypes', symbol: 'rect', symbolSize: 10, itemStyle: { color: kInk, borderColor: '#fff', borderWidth: 1 }, z: 6, labelLayout: { hideOverlap: true },
        data: this.others().map((design) => ({ value: this.placeOf(design.scores, panel), design, name: this.facts.title(design) })),
        label: { show: this.count === 1, position: 'right', ...kHalo, formatter: ({ name }) => name } },
    ]);
  }

  frontData(panel) {
    return this.members.designs.map((design) => {
      const isChosen = design.trial === this.members.chosen;
      return { value: this.placeOf(design.scores, panel), trial: this.members.trials.get(design.trial), symbolSize: isChosen ? 16 : 10, symbol: isChosen ? 'diamond' : 'circle',
        itemStyle: { color: kBlue, borderColor: '#fff', borderWidth: 1 } };
    });
  }

  /** The front linked, where it is a line. */
  linkSeries(panel, k) {
    if (this.count > 1) return [];
    const points = this.members.designs.map((design) => this.placeOf(design.scores, panel));
    return [{ id: `${k}/link`, name: 'front', type: 'line', symbol: 'none', silent: true, xAxisIndex: k, yAxisIndex: k, color: kBlue, lineStyle: { color: kBlue, width: 1.4, opacity: 0.7 }, itemStyle: { color: kBlue }, z: 4, data: staircase(points, panel.x, panel.y) }];
  }

  /** Where fresh seeds put the designs that were scored again. */
  freshSeries(panel, k) {
    const again = this.members.designs.filter((design) => design.rescored);
    const moves = again.map((design) => [...this.placeOf(design.scores, panel), ...this.placeOf(design.rescored, panel)]);
    return [
      { id: `${k}/moves`, name: 'with fresh seeds', type: 'custom', silent: true, clip: true, xAxisIndex: k, yAxisIndex: k, encode: { x: [0, 2], y: [1, 3] }, data: moves, z: 4, renderItem: (_, api) => {
        const [x1, y1] = api.coord([api.value(0), api.value(1)]);
        const [x2, y2] = api.coord([api.value(2), api.value(3)]);
        return { type: 'line', shape: { x1, y1, x2, y2 }, style: { stroke: kOrange, lineWidth: 1.2 } };
      } },
      { id: `${k}/fresh`, name: 'with fresh seeds', type: 'scatter', symbol: 'emptyCircle', symbolSize: 7, xAxisIndex: k, yAxisIndex: k, color: kOrange, itemStyle: { color: kOrange, borderWidth: 1.6 }, z: 6,
        data: again.map((design) => ({ value: this.placeOf(design.rescored, panel), trial: this.members.trials.get(design.trial), ...(design.dominated_by || design.keeps_limits === false ? { symbol: kCross, symbolSize: 9, itemStyle: { color: kOrange, borderWidth: 0 } } : {}) })) }];
  }

  legend() {
    const mark = (shape) => svg('svg', { viewBox: '-8 -8 16 16', width: 14, height: 14, 'aria-hidden': 'true' }, shape);
    const disc = (r, fill, stroke = 'none') => svg('circle', { r, fill, stroke, 'stroke-width': 2 });
    const again = this.members.designs.some((design) => design.rescored);
    const entries = [[mark(disc(5, kBlue)), 'front'], [mark(svg('path', { d: 'M0-7L7 0L0 7L-7 0Z', fill: kBlue })), 'compromise'],
      again && [mark(disc(4.5, 'none', kOrange)), 'with fresh seeds'], again && [mark(svg('path', { d: 'M-5-5L5 5M-5 5L5-5', stroke: kOrange, 'stroke-width': 2.2 })), 'beaten then, or beyond a limit'],
      [mark(disc(4, kGrey)), this.members.words.beaten], this.done.some((trial) => !isGood(trial)) && [mark(svg('path', { d: 'M0-5L5 4L-5 4Z', fill: 'none', stroke: kOrange, 'stroke-width': 1.4 })), 'not feasible'],
      this.others().length > 0 && [mark(svg('rect', { x: -5, y: -5, width: 10, height: 10, fill: kInk })), 'baseline and prototypes'], [mark(disc(7, 'none', kOrange)), 'looked at']];
    return h('p', { class: 'legend front-legend' }, entries.filter(Boolean).map(([icon, text]) => h('span', {}, icon, ' ', text)));
  }

  option(width) {
    const grid = this.grids(width);
    this.drawn = grid.map((one, k) => ({ ...one, x: this.range(this.panels[k].x), y: this.range(this.panels[k].y) }));
    if (this.instance) requestAnimationFrame(() => this.follow());
    return {
      grid, ...this.axes(width), series: this.series(),
      tooltip: { trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter: ({ data }) => (data?.trial || data?.design ? pointText(this.facts, this.members, data) : '') },
    };
  }

  /** Where a value of a panel is, in pixels of the chart; as its axes have it. */
  pixelOf(k, [x, y]) {
    const grid = this.drawn[k];
    const along = (value, [low, high]) => (value - low) / (high - low);
    return [grid.left + grid.width * along(x, grid.x), grid.top + grid.height * (1 - along(y, grid.y))];
  }

  /** After a brush or a pick of any part: what is chosen is drawn above the rest. */
  follow() {
    if (!this.instance) return;
    const kept = this.selection.chosen();
    const context = this.overlay.begin();
    const inside = kept ? this.done.filter((trial) => kept.has(trial.number)) : [];
    this.overlay.canvas.dataset.kept = kept ? inside.length : '';
    this.panels.forEach((panel, k) => {
      const grid = this.drawn[k];
      context.save();
      context.beginPath();
      context.rect(grid.left, grid.top, grid.width, grid.height);
      context.clip();
      if (kept) {
        wash(context, grid);
        const isMember = (trial) => this.members.byTrial.has(trial.number);
        discs(context, inside.filter((trial) => !isMember(trial)).map((trial) => this.pixelOf(k, this.point(trial, panel))), 3, '#5b656e');
        discs(context, inside.filter(isMember).map((trial) => this.pixelOf(k, this.point(trial, panel))), 5, kBlue);
      }
      this.ring(context, k, panel);
      context.restore();
    });
  }

  /** Around what is looked at. */
  ring(context, k, panel) {
    const what = this.selection.picked;
    const trial = this.members.trials.get(what);
    const value = trial ? this.point(trial, panel) : this.placeOf(this.facts.designs.find((design) => design.key === what)?.scores, panel);
    if (!value.every(isNumber)) return;
    const [x, y] = this.pixelOf(k, value);
    Object.assign(context, { strokeStyle: kOrange, lineWidth: 2.5 });
    context.beginPath();
    context.arc(x, y, 10, 0, 2 * Math.PI);
    context.stroke();
  }

  at(event) {
    const { left, top } = this.place.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  press(event) {
    const start = this.at(event);
    const k = this.panels.findIndex((_, index) => this.instance.containPixel({ gridIndex: index }, start));
    if (k < 0 || event.button !== 0) return;
    follow(event, (next) => this.at(next), (place) => this.showFrame(start, place), (place, far) => (far ? this.choose(k, start, place) : this.pickAt(k, start)));
  }

  showFrame(a, b) {
    this.frame.hidden = false;
    this.frame.style.cssText = `left:${Math.min(a[0], b[0])}px;top:${Math.min(a[1], b[1])}px;width:${Math.abs(a[0] - b[0])}px;height:${Math.abs(a[1] - b[1])}px`;
  }

  /** Evaluations in a rectangle of one panel. */
  choose(k, a, b) {
    const panel = this.panels[k];
    const [from, to] = [a, b].map((pixel) => this.instance.convertFromPixel({ gridIndex: k }, pixel));
    const between = (value, i) => value >= Math.min(from[i], to[i]) && value <= Math.max(from[i], to[i]);
    this.brush(new Set(this.done.filter((trial) => this.point(trial, panel).every(between)).map((trial) => trial.number)));
  }

  brush(numbers) {
    this.frame.hidden = numbers === null;
    this.selection.brush('front', numbers);
  }

  /** Designs first, then the front, then any evaluation. */
  pickAt(k, pixel) {
    const panel = this.panels[k];
    const near = (list, value, reach) => {
      const distance = (one) => {
        const [x, y] = this.pixelOf(k, value(one));
        return Math.hypot(x - pixel[0], y - pixel[1]);
      };
      return list.filter((one) => value(one).every(isNumber)).map((one) => ({ one, far: distance(one) })).filter(({ far }) => far <= reach).sort((a, b) => a.far - b.far)[0]?.one;
    };
    const front = near(this.members.designs, (design) => this.placeOf(design.scores, panel), kReach.design) ?? near(this.members.designs.filter((design) => design.rescored), (design) => this.placeOf(design.rescored, panel), kReach.trial);
    if (front) return this.selection.pick(front.trial);
    const other = near(this.others(), (design) => this.placeOf(design.scores, panel), kReach.design);
    if (other) return this.selection.pick(other.key);
    const trial = near(this.done, (one) => this.point(one, panel), kReach.trial);
    return trial ? this.selection.pick(trial.number) : this.brush(null);
  }
}

async function copy(text, button) {
  const shown = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = h('textarea', { class: 'off-screen' }, text);
    document.body.append(field);
    field.select();
    document.execCommand('copy');
    field.remove();
  }
  button.textContent = 'Copied';
  setTimeout(() => { button.textContent = shown; }, 1200);
}

const copyButton = (label, text) => h('button', { type: 'button', class: 'copy screen-only', title: text, onclick: (event) => { event.stopPropagation(); copy(text, event.currentTarget); } }, label);

/** What is looked at: pictures, drawing, scores, variables. */
class Detail {
  constructor(facts, members, selection) {
    Object.assign(this, { facts, members, selection });
    this.node = h('div', { class: 'detail-panel', id: 'front-detail', 'aria-live': 'polite' });
    selection.listen((_, what) => what === 'pick' && this.draw());
    this.draw();
  }

  scores(searched, fresh) {
    const { facts } = this;
    const hasFresh = Object.keys(fresh ?? {}).length > 0;
    const names = [...new Set([...facts.objectives, ...facts.constraints].map(({ name }) => name))];
    const row = (name) => {
      const constraint = facts.constraints.find((one) => one.name === name);
      const fails = constraint && !facts.meets(constraint, fresh?.[name] ?? searched?.[name]);
      return h('tr', { class: fails ? 'fails' : '' }, h('th', { title: facts.meaning(name) }, facts.label(name), constraint && h('small', {}, ` ${facts.limit(constraint)}`)),
        h('td', {}, facts.scoreWithError(name, searched)), hasFresh && h('td', {}, h('b', {}, facts.scoreWithError(name, fresh)), fails && ' \u2717'));
    };
    return h('table', { class: 'scores' }, h('thead', {}, h('tr', {}, h('th', {}), h('th', {}, 'search'), hasFresh && h('th', {}, 'fresh seeds'))), h('tbody', {}, names.map(row)));
  }

  variables(variables) {
    const paths = Object.keys(variables ?? {});
    const names = shortNames(paths);
    return paths.length > 0 && h('details', { class: 'variables', open: paths.length <= 6 }, h('summary', {}, 'Variables'),
      h('table', { class: 'scores' }, h('tbody', {}, paths.map((path, i) => h('tr', {}, h('th', { title: path }, names[i]), h('td', {}, number(variables[path])))))));
  }

  /** The chosen design has a card, in runs of before the front had pictures too. */
  picturesOf(card) { return card ? { aspect: card.aspect ?? card.frames?.[0], closeups: card.closeups, drawing: card.drawing } : {}; }

  pictures(shown, title) {
    const image = shown.aspect ?? shown.frames?.[0] ?? shown.thumbnail;
    return [image ? picture(image, `${title}: mean image`, 'frame') : h('p', { class: 'muted no-picture' }, 'No picture was kept of this evaluation; its scene is rendered by glint render with the line below.'),
      shown.thumbnail && !shown.aspect && h('p', { class: 'muted' }, 'A small picture: only the designs that add most to the hypervolume are kept in full.'),
      shown.closeups?.length > 0 && h('div', { class: 'closeups' }, shown.closeups.slice(0, 4).map((one) => closeupFigure(this.facts, { title, key: title }, one)))];
  }

  draw() {
    const { facts, members } = this;
    const what = this.selection.picked;
    const design = typeof what === 'string' ? facts.designs.find((one) => one.key === what) : null;
    const number = design ? design.trial : what;
    const own = design ?? { ...(what === members.chosen ? this.picturesOf(members.winner) : {}), ...members.byTrial.get(what) };
    const title = design ? facts.title(design) : `Evaluation ${what}`;
    const probability = own.probability_on_front;
    const line = design ? '' : setLine(members.variablesOf(what));
    this.node.replaceChildren(
      h('h3', {}, title),
      h('p', { class: 'badges' }, design ? badge(facts.role(design), facts.roleName(design)) : members.badges(number).map(([kind, text]) => badge(kind, text)), !design && !members.byTrial.has(what) && badge('neutral', members.words.beaten)),
      h('div', { class: 'detail-columns' }, h('div', {}, this.pictures(own, title)),
        h('div', {}, this.scores(design ? design.scores : members.searched(what), design ? design.rescored : members.fresh(what)),
          isNumber(probability) && h('p', { class: 'muted' }, `Beaten by none of the designs scored again: probability ${Math.round(100 * probability)}\u00a0%, by their errors.`),
          this.variables(design ? design.variables : members.variablesOf(what)),
          own.folder && h('p', { class: 'muted path' }, `Scene: ${own.folder}/scene.toml in the folder of the run `, copyButton('Copy', `${own.folder}/scene.toml`)),
          line && h('p', { class: 'muted path screen-only' }, h('code', {}, line), ' ', copyButton('Copy', line))),
        own.drawing && h('div', { class: 'drawing' }, svgNode(own.drawing))));
  }
}

/** Small pictures of the front, from one end to the other. */
class Gallery {
  constructor(facts, members, selection) {
    const first = facts.objectives[0];
    const sign = first.maximise ? -1 : 1;
    const shown = members.designs.filter((design) => design.aspect || design.thumbnail).sort((a, b) => sign * (a.scores[first.name] - b.scores[first.name]));
    const values = (design) => facts.objectives.map(({ name }) => facts.score(name, design.rescored?.[name] ?? design.scores[name])).join(' \u00b7 ');
    this.cards = new Map(shown.map((design) => [design.trial, h('button', { type: 'button', class: `thumb${design.shown === 'full' ? '' : ' screen-only'}`, onclick: () => selection.pick(design.trial), title: `Look at evaluation ${design.trial}` },
      h('img', { src: pngUrl(design.thumbnail ?? design.aspect), alt: `Evaluation ${design.trial}` }), h('span', {}, h('b', {}, `${design.trial}`), design.trial === members.chosen ? ' compromise' : design.dominated_by ? ' beaten' : ''), h('span', {}, values(design)))]));
    this.node = this.cards.size > 0 && h('div', { class: 'gallery', id: 'front-pictures' }, [...this.cards.values()]);
    this.selection = selection;
    selection.listen(() => this.follow());
    this.follow();
  }

  follow() {
    const kept = this.selection.chosen();
    for (const [trial, card] of this.cards) {
      card.classList.toggle('off', kept !== null && !kept.has(trial));
      card.classList.toggle('picked', this.selection.picked === trial);
    }
  }
}

class FrontTable {
  constructor(facts, members, selection) {
    Object.assign(this, { facts, members, selection });
    this.columns = this.makeColumns();
    this.sorted = this.columns.find((column) => column.name === facts.objectives[0].name);
    this.ascending = !facts.objectives[0].maximise;
    this.head = h('tr', {}, this.columns.map((column) => h('th', { title: column.meaning ?? column.name }, h('button', { type: 'button', onclick: () => this.sort(column) }, column.heading))), h('th', { class: 'screen-only' }, ''));
    this.body = h('tbody', {});
    this.count = h('span', { class: 'muted' });
    this.node = [h('p', { class: 'toolbar' }, this.count), h('div', { class: 'scroll tall' }, h('table', { class: 'evaluations', id: 'front-table' }, h('thead', {}, this.head), this.body))];
    selection.listen(() => this.follow());
    this.draw();
  }

  makeColumns() {
    const { facts, members } = this;
    const isTotal = facts.front.hypervolume > 0;
    const seen = (one) => one.searched ?? one.scores;
    const scored = (name) => [{ name, heading: facts.label(name), meaning: facts.meaning(name), value: (one) => seen(one)[name], text: (one) => facts.scoreWithError(name, { ...seen(one), [`${name}.error`]: one.errors?.[name] }) },
      members.designs.some((one) => isNumber(one.expected?.[name]?.value)) && { name: `${name} expected`, heading: `${facts.label(name)}, expected`, meaning: `${facts.meaning(name)}\nexpected by the model of all evaluations, with its standard deviation`, value: (one) => one.expected?.[name]?.value, text: (one) => (one.expected?.[name] ? facts.scoreWithError(name, { [name]: one.expected[name].value, [`${name}.error`]: one.expected[name].sd }) : '\u2013') },
      members.designs.some((one) => isNumber(one.rescored?.[name]) && one.rescored[name] !== seen(one)[name]) && { name: `${name} fresh`, heading: `${facts.label(name)}, fresh seeds`, meaning: `${facts.meaning(name)}\nscored again with fresh seeds`, value: (one) => one.rescored?.[name], text: (one) => (one.rescored ? facts.scoreWithError(name, members.fresh(one.trial)) : '\u2013') }];
    return [
      { name: 'trial', heading: '#', value: (one) => one.trial, text: (one) => String(one.trial) },
      ...facts.objectives.flatMap(({ name }) => scored(name)),
      isTotal && { name: 'contribution', heading: 'adds to volume', meaning: 'share of the hypervolume that would be lost without the design', value: (one) => one.contribution, text: (one) => (isNumber(one.contribution) ? percent(one.contribution / facts.front.hypervolume) : '\u2013') },
      members.designs.some((one) => isNumber(one.probability_on_front)) && { name: 'probability', heading: 'on the front', meaning: 'probability that none of the designs scored again beats it, by their errors', value: (one) => one.probability_on_front, text: (one) => (isNumber(one.probability_on_front) ? `${Math.round(100 * one.probability_on_front)}\u00a0%` : '\u2013') },
      members.designs.some((one) => isNumber(one.probability_best)) && { name: 'probability_best', heading: 'compromise', meaning: 'probability that the choice takes it of all designs scored again and the prototypes, by the noise of their scores', value: (one) => one.probability_best, text: (one) => (isNumber(one.probability_best) ? `${Math.round(100 * one.probability_best)}\u00a0%` : '\u2013') },
      ...facts.variables.map((variable, i) => ({ name: variable.name, heading: facts.names[i], value: (one) => one.variables?.[variable.name], text: (one) => number(one.variables?.[variable.name]) })),
    ].filter(Boolean);
  }

  sort(column) {
    this.ascending = this.sorted === column ? !this.ascending : false;
    this.sorted = column;
    this.draw();
  }

  draw() {
    const compare = order(this.sorted, this.ascending);
    const rows = [...this.members.designs].sort((a, b) => compare(a, b) || a.trial - b.trial);
    const badges = (one) => this.members.badges(one.trial).filter(([kind]) => kind !== 'good').map(([kind, text]) => [' ', badge(kind, text.replace(/ with fresh seeds$/, ''))]);
    this.rows = new Map(rows.map((one, i) => [one.trial, h('tr', { class: i < kPrintedRows ? '' : 'screen-only', onclick: () => this.selection.pick(one.trial) },
      this.columns.map((column) => h('td', { class: column.name === 'trial' ? '' : 'number' }, column.text(one), column.name === 'trial' && badges(one))), h('td', { class: 'screen-only' }, copyButton('Copy --set', setLine(one.variables))))]));
    this.body.replaceChildren(...this.rows.values());
    this.columns.forEach((column, i) => this.head.children[i].setAttribute('aria-sort', column === this.sorted ? (this.ascending ? 'ascending' : 'descending') : 'none'));
    this.follow();
  }

  follow() {
    const kept = this.selection.chosen();
    const all = this.rows.size;
    for (const [trial, row] of this.rows) {
      row.hidden = kept !== null && !kept.has(trial);
      row.classList.toggle('picked', this.selection.picked === trial);
    }
    const shown = [...this.rows.keys()].filter((trial) => !kept || kept.has(trial)).length;
    this.count.textContent = kept ? `${shown} of ${plural(all, 'design')}, chosen by brushes` : `${plural(all, 'design')}; click a heading to sort, a row to look at it`;
  }
}

/** Sections of a study with several objectives; none where there is one. */
export function frontSections(facts, selection) {
  if (!facts.front) return [];
  const members = new Members(facts);
  if (!members.designs.length) return [section('front', 'The front', 'No design meets every limit, so that there is none to choose from.')];
  selection.picked = members.chosen;
  const view = new FrontChart(facts, members, selection);
  const gallery = new Gallery(facts, members, selection);
  const again = members.designs.some((design) => design.rescored);
  const lead = `Blue: the ${plural(members.designs.length, 'design')} ${members.words.unbeaten}, the compromise as a diamond${facts.objectives.length === 2 ? '; the line bounds what they reach' : ''}. Grey: ${members.words.rest}.${again ? ' Open orange circles: the same designs with fresh seeds, crosses where one is beaten then or misses a limit.' : ''} Click a point to look at it, drag a frame to choose.`;
  const table = new FrontTable(facts, members, selection);
  return [
    section('front', 'The front', lead, h('p', { class: 'toolbar screen-only' }, h('label', { class: 'inline' }, view.full, ' Show the full range'), view.clear),
      h('div', { class: `front${facts.objectives.length > 3 ? ' wide' : ''}` }, h('div', { class: 'front-view' }, view.legend(), view.place), new Detail(facts, members, selection).node,
        gallery.node && h('div', { class: 'front-gallery' }, h('h4', {}, `Pictures along the front, ${facts.objectives[0].maximise ? 'largest' : 'smallest'} ${facts.label(facts.objectives[0].name)} first`), gallery.node))),
    section('front-designs', 'Designs of the front', again ? `Each was scored by the search; those that add most to the hypervolume were scored again with fresh seeds, and \u00b1 is a standard error.${chosenText(facts)}` : null, table.node),
  ];
}

/** The hypervolume after each evaluation, with what the noise of the scores makes of it. */
export function hypervolumeSection(facts) {
  const history = facts.front?.history ?? [];
  if (history.length < 2) return null;
  const noise = (facts.front.noise_history ?? []).filter(([at]) => at >= 1 && at <= history.length);
  const again = facts.front.rescored;
  const words = frontWords(facts.front);
  const hasOwn = noise.some(([, half]) => half > 0);
  const part = !hasOwn && isNumber(again?.noise) && again.hypervolume > 0 ? again.noise / again.hypervolume : 0;
  const hasNoise = hasOwn || part > 0;
  const line = history.map((value, i) => [i + 1, value]);
  /** Between the places where it is known. */
  const ownHalf = (at) => {
    const next = noise.find(([place]) => place >= at) ?? noise[noise.length - 1];
    const last = noise.findLast(([place]) => place <= at) ?? [0, 0];
    return next[0] === last[0] ? next[1] : last[1] + ((next[1] - last[1]) * (at - last[0])) / (next[0] - last[0]);
  };
  const halves = hasNoise ? history.map((value, i) => (hasOwn ? ownHalf(i + 1) : part * value)) : [];
  const ends = (i) => [history[i] - halves[i], history[i] + halves[i]];
  const band = halves.flatMap((_, i) => [...(i > 0 ? [[i + 1, ...ends(i - 1)]] : []), [i + 1, ...ends(i)]]);
  const most = band.reduce((largest, [, , high]) => Math.max(largest, high), Math.max(...history));
  const option = () => ({
    grid: { left: 70, right: 24, top: 40, bottom: 44 }, legend: { top: 0, right: 16, itemGap: 18, textStyle: kText, data: ['hypervolume', hasNoise && '95 % of the noise'].filter(Boolean) },
    tooltip: { trigger: 'axis', confine: true, textStyle: { fontSize: 12, color: kInk }, valueFormatter: (value) => number(value) },
    xAxis: { type: 'value', name: 'evaluation', nameLocation: 'middle', nameGap: 28, min: 1, max: history.length, minInterval: 1, ...axisStyle, splitLine: { show: false } },
    yAxis: { type: 'value', min: 0, max: most > 0 ? 1.05 * most : 1, name: 'hypervolume', ...axisStyle, nameTextStyle: { color: kInk, align: 'left' }, axisLabel: { color: '#55606a', formatter: (value) => number(value), showMaxLabel: false } },
    series: [
      { name: 'hypervolume', type: 'line', step: 'end', symbol: 'none', color: kBlue, lineStyle: { width: 2 }, data: line },
      ...(hasNoise ? [{ name: '95 % of the noise', type: 'custom', silent: true, clip: true, color: kBlue, itemStyle: { color: kBlue, opacity: 0.2 }, tooltip: { show: false }, data: [[1, 0]],
        renderItem: (_, api) => ({ type: 'polygon', shape: { points: [...band.map(([x, , high]) => api.coord([x, high])), ...band.map(([x, low]) => api.coord([x, Math.max(0, low)])).reverse()] }, style: { fill: kBlue, opacity: 0.2 } }) }] : []),
    ],
  });
  const notes = ['What the front encloses with the reference, in the product of the scores\u2019 units; more is better.' + words.history, hasOwn ? `The band is what ${words.band}.` : part > 0 ? 'The band is the share that the errors of the designs scored again make of it.' : 'The scores tell no error of their own, so that there is no band.',
    again && isNumber(again.hypervolume) && again.searched > 0 && `The ${plural(again.designs, 'design')} scored again enclose ${number(again.searched, 3)} by the search and ${number(again.hypervolume, 3)}${isNumber(again.noise) && again.noise > 0 ? ` \u00b1 ${percent(again.noise / again.hypervolume)}` : ''} with fresh seeds.`];
  return section('hypervolume', 'Hypervolume', notes.filter(Boolean).join(' '), chart(300, 'Hypervolume against evaluations', 0, option));
}
