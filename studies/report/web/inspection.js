// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint inspect`: table of parts, their figures, what was found on each; the data is the object of result.json and
// what studies/inspect/inspect_page.cpp adds to it.
import { axisStyle, chart, kHalo } from './charts.js';
import { badge, h, pngUrl, section, svg } from './dom.js';
import { minus, number, plural } from './format.js';
import { sizesChart } from './population.js';

const kMaxRows = 60;  // of a part's table, and numbers in its picture; the CSV file has all

/** As in the overlay.png of studies/inspect/inspect_marks.cpp. */
const kMarks = { hole: '#ff9500', scratch: '#00beff', missed: '#ff2dc8' };
const kBadges = { Perfect: 'good', Acceptable: 'fair', Rejected: 'bad' };

const gradeBadge = (grade) => grade && badge(kBadges[grade], grade);
const cell = (text) => h('td', { class: 'number' }, text);
const heading = (text) => h('th', { class: 'number' }, text);
const defectsOf = (part) => part.holes.count + part.scratches.count;

/** Names of files are no addresses: "#1.png", "javascript:x". */
const address = (path) => `./${path.split('/').map(encodeURIComponent).join('/')}`;

function partRow(part, i) {
  const sizes = [part.holes, part.scratches].flatMap((kind) => [kind.biggest, kind.sum]);
  const truth = part.truth ? [part.truth.found, part.truth.missed, part.truth.false_alarms] : [];
  return h('tr', {}, h('td', {}, h('a', { href: part.image ? `#part${i + 1}` : address(part.overlay) }, part.name)),
    h('td', {}, gradeBadge(part.grade), part.label && part.grade && part.label !== part.grade && ` label: ${part.label}`),
    sizes.map((size) => cell(number(size))), cell(defectsOf(part)), cell(number(part.threshold)), cell(number(part.noise)), truth.map(cell));
}

export function partsSection(facts) {
  const data = facts.data.inspection;
  if (!data) return null;
  const figures = ['biggest', 'sum', 'biggest', 'sum', 'defects', 'threshold', 'noise', ...(data.truth ? ['found', 'missed', 'false alarms'] : [])];
  return section('parts', 'Parts', null, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, h('th', { colspan: '2' }), h('th', { class: 'number', colspan: '2' }, `holes and bumps (${data.unit})`), h('th', { class: 'number', colspan: '2' }, `scratches (${data.unit})`), h('th', { colspan: String(figures.length - 4) })),
      h('tr', {}, h('th', {}, 'part'), h('th', {}, 'grade'), figures.map(heading))),
    h('tbody', {}, data.parts.map(partRow)))));
}

export function gradesSection(facts) {
  const data = facts.data.inspection;
  if (!data || data.parts.length < 2 || !data.parts.every((part) => part.grade)) return null;
  const sizes = (kind, title) => sizesChart({ title, unit: data.unit, limits: data.limits[kind],
    points: data.parts.map((part) => ({ ...part[kind], name: part.name, grade: part.label ?? part.grade, is_tested: !data.learned || !part.label, is_wrong: Boolean(part.label) && part.label !== part.grade })) });
  return section('grades', 'Biggest defect and sum of all', !data.parts.every((part) => part.label) && 'Parts without a label are drawn as what they were sorted into.',
    h('div', { class: 'pair' }, sizes('holes', 'Holes and bumps'), sizes('scratches', 'Scratches')));
}

function mark({ outline, kind }, width, title, text) {
  const corners = outline.split(' ').map((corner) => corner.split(',').map(Number));
  const right = corners.reduce((most, corner) => (corner[0] > most[0] ? corner : most));
  return svg('g', {}, svg('title', {}, title),
    svg('polygon', { points: outline, fill: 'none', stroke: kMarks[kind], 'stroke-width': width, 'stroke-dasharray': kind === 'missed' ? 4 * width : 'none' }),
    text && svg('text', { x: right[0] + 2 * width, y: right[1] + 4 * width, fill: kMarks[kind], 'font-size': 9 * width }, text));
}

function markedPicture(part) {
  const [width, height] = part.size_px;
  const line = Math.max(0.6, width / 950);
  return svg('svg', { class: 'marked', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `${part.name}: what was found` },
    svg('image', { width, height, preserveAspectRatio: 'none', href: pngUrl(part.image) }),
    part.defects.map((defect, i) => mark(defect, line, `${defect.kind} ${defect.number}: ${defect.area_px} px`, i < kMaxRows && defect.number)),
    part.missed.map((defect) => mark({ ...defect, kind: 'missed' }, line, `missed: ${defect.label}`)));
}

function legend(part) {
  const entry = (kind, text) => h('span', {}, h('i', { class: `outline ${kind}`, style: `color:${kMarks[kind]}` }), text);
  return h('p', { class: 'lead legend' }, h('span', {}, 'Grey values stretched; darkened areas were not inspected.'),
    entry('hole', 'hole or bump'), entry('scratch', 'scratch'), part.truth && entry('missed', 'missed'));
}

function defectsTable(part) {
  if (!part.defects.length) return h('p', { class: 'lead' }, 'No defect was found.');
  const fixed = (value, digits) => cell(minus(value.toFixed(digits)));
  const row = (defect) => h('tr', {}, cell(defect.number), h('td', {}, `${defect.is_bright ? 'bright' : 'dark'} ${defect.kind === 'hole' ? 'spot' : defect.kind}`), fixed(defect.x_px, 1), fixed(defect.y_px, 1),
    cell(defect.area_px), cell(number(defect.weight)), cell(number(defect.peak)), fixed(defect.length_px, 1), fixed(defect.width_px, 1), fixed(defect.angle_deg, 0), fixed(defect.elongation, 2),
    part.truth && h('td', {}, defect.known_as));
  const count = defectsOf(part);
  return h('div', {}, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, heading('number'), h('th', {}, 'kind'), ['x px', 'y px', 'area px', 'weight', 'peak', 'length px', 'width px', 'angle deg', 'elongation'].map(heading), part.truth && h('th', {}, 'is'))),
    h('tbody', {}, part.defects.slice(0, kMaxRows).map(row)))),
  count > kMaxRows && h('p', { class: 'lead' }, `The ${kMaxRows} biggest of ${count}; defects.csv has all.`));
}

/** Pixels by their response, with the threshold on the sides, 1 bright and -1 dark, that defects may lie on. */
function histogram(part, sides) {
  const { reach, counts } = part.histogram;
  const bin = (2 * reach) / counts.length;
  const bars = counts.map((count, i) => [-reach + i * bin, -reach + (i + 1) * bin, count]).filter((bar) => bar[2] > 0);
  const renderItem = (params, api) => {
    const [left, top] = api.coord([api.value(0), api.value(2)]);
    const [right, bottom] = api.coord([api.value(1), 0.5]);
    const middle = 0.5 * (api.value(0) + api.value(1));
    const isBeyond = sides.some((side) => side * middle >= part.threshold);
    return { type: 'rect', shape: { x: left, y: top, width: right - left, height: bottom - top }, style: { fill: isBeyond ? '#d55e00' : '#7f9db5' } };
  };
  const option = () => ({
    grid: { left: 62, right: 16, top: 16, bottom: 46 },
    xAxis: { type: 'value', min: -reach, max: reach, name: 'response (share of full scale)', nameLocation: 'middle', nameGap: 28, ...axisStyle,
      axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value), showMinLabel: false, showMaxLabel: false, hideOverlap: true } },
    yAxis: { type: 'log', min: 0.5, max: Math.max(10, 2 * Math.max(...counts)), name: 'pixels', nameLocation: 'middle', nameGap: 44, ...axisStyle,
      axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value), showMinLabel: false, showMaxLabel: false } },
    series: [{ type: 'custom', silent: true, renderItem, data: bars, encode: { x: [0, 1], y: 2 },
      markLine: { silent: true, symbol: 'none', precision: 9, lineStyle: { color: '#b84a00', type: 'solid', width: 1.5 },
        data: sides.map((side) => ({ xAxis: side * part.threshold, label: { show: side === sides[sides.length - 1], formatter: 'threshold', position: 'insideEndBottom', ...kHalo, color: '#b84a00' } })) } }],
  });
  return h('div', { class: 'histogram' }, h('h4', {}, 'Pixels by response'), chart(240, `Pixels by response of ${part.name}`, 0, option));
}

function partFound(part, i, sides) {
  const [width, height] = part.size_px;
  return h('article', { class: 'part', id: `part${i + 1}` }, h('h3', {}, part.name, ' ', gradeBadge(part.grade)),
    h('p', { class: 'lead' }, `${plural(part.pictures, 'picture')}, ${width} x ${height} px, ${part.bits} bits; part from: ${part.mask}. Inspected: ${(100 * part.bright_share).toFixed(1)} % of what is bright.`),
    part.notes.length > 0 && h('ul', { class: 'notes' }, part.notes.map((note) => h('li', {}, note))),
    markedPicture(part), legend(part), h('div', { class: 'side' }, defectsTable(part), histogram(part, sides)));
}

export function foundSection(facts) {
  const parts = facts.data.inspection?.parts;
  if (!parts) return null;
  const shown = parts.filter((part) => part.image);
  return section('found', 'What was found', null, shown.map((part, i) => partFound(part, i, facts.data.inspection.sides)),
    shown.length < parts.length && h('p', { class: 'lead' }, `The first ${shown.length} parts; the folder has pictures of all.`));
}
