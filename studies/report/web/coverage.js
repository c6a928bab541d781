// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint cover`: the part coloured by what inspects it, and what each view adds.
import { h, picture, section } from './dom.js';
import { number } from './format.js';

const percent = (share, digits = 1) => `${(100 * share).toFixed(digits)} %`;

function legend(entries) {
  const entry = ({ name, colour, share }) => h('span', {}, h('i', { class: 'key', style: `background:${colour}` }), `${name}: ${percent(share)}`);
  return h('p', { class: 'lead legend' }, entries.map(entry));
}

const figure = ({ image, caption }) => h('figure', {}, picture(image, caption, 'frame'), h('figcaption', {}, caption));

export function coverageSection(facts) {
  const data = facts.data.coverage;
  if (!data) return null;
  return section('coverage', 'The part, coloured by what inspects it', null, legend(data.legend), h('div', { class: 'views' }, data.pictures.map(figure)));
}

/** What a view adds in full colour, what else it sees in a pale one. */
function bar(view) {
  const part = (share, colour) => h('i', { style: `display:inline-block;height:0.8em;width:${(100 * share).toFixed(2)}%;background:${colour}` });
  return h('div', { style: 'width:16em;white-space:nowrap;font-size:1em' }, part(view.adds, '#084594'), part(view.sees - view.adds, '#c6dbef'));
}

function viewTable(views) {
  const heads = ['view', 'adds', 'sees', 'alone', ''];
  const row = (view) => h('tr', {}, h('td', {}, view.name), ['adds', 'sees', 'only'].map((name) => h('td', { class: 'number' }, percent(view[name], 2))), h('td', {}, bar(view)));
  return h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, heads.map((text, i) => h('th', { class: i > 0 && i < 4 ? 'number' : '' }, text)))), h('tbody', {}, views.map(row))));
}

function shareTable(data) {
  const rows = [...data.ck.map((share, i) => [i === 0 ? 'inspected by a view (C1)' : `by ${i + 1} or more views from directions apart (C${i + 1})`, percent(share, 2)]),
    ['views that inspect a place, on average', number(data.redundancy, 3)],
    ['the whole surface', `${number(data.area_mm2, 4)} mm\u00b2`],
    ['its largest piece that no view inspects', `${number(data.largest_gap_mm2, 4)} mm\u00b2`],
    ...Object.entries(data.states).filter(([name, share]) => name !== 'inspected' && share > 0).map(([name, share]) => [`not inspected: ${name}`, percent(share, 2)])];
  return h('div', { class: 'scroll' }, h('table', { class: 'evaluations' }, h('tbody', {}, rows.map(([name, text]) => h('tr', {}, h('td', {}, name), h('td', { class: 'number' }, text))))));
}

export function coverageViewsSection(facts) {
  const data = facts.data.coverage;
  if (!data) return null;
  return section('shares', 'What each view adds',
    'Shares of the surface: "adds" is what no view above it inspects, so that the column sums to C1; "alone" is what would be lost without the view.',
    viewTable(data.views), shareTable(data));
}
