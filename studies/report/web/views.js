// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint render`: pictures with their defect maps, the lighting, scores of the first view.
import { h, picture, section, svgNode } from './dom.js';
import { isNumber, number, plural } from './format.js';

function legend(colours) {
  const entry = ({ name, colour }) => h('span', {}, h('i', { class: 'key', style: `background:${colour}` }), name);
  return h('p', { class: 'lead legend' }, h('span', {}, 'Defect map:'), colours.map(entry));
}

function caption(view) {
  const { camera, shadow, bounce } = view.rays;
  return [`${view.folder}: ${view.mean_samples.toFixed(0)} samples a pixel, ${camera} camera, ${shadow} shadow and ${bounce} reflected rays`,
    isNumber(view.relative_error) && `standard error of a pixel ${number(100 * view.relative_error, 2)} % of the brightness`,
    `${plural(view.defects_seen, 'defect')} in view.`].filter(Boolean).join('; ');
}

const figure = (image, name, text) => h('figure', {}, picture(image, name, 'frame'), text && h('figcaption', {}, text));

export function viewsSection(facts) {
  const data = facts.data.rendered;
  if (!data) return null;
  return section('views', 'Pictures', null, legend(data.legend), data.sheet && figure(data.sheet, 'all views'),
    h('div', { class: 'views' }, data.views.map((view) => figure(view.image, view.folder, caption(view)))));
}

export function lightingSection(facts) {
  const data = facts.data.rendered;
  return data ? section('lighting', 'Lighting', null, h('div', { class: 'drawing' }, svgNode(data.drawing))) : null;
}

const isOfOneDefect = (name) => /^defects\..*\./.test(name);

function scoresTable(scores, names) {
  const cell = (name) => h('td', { class: 'number' }, isNumber(scores[name]) ? number(scores[name]) : '');
  return h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, h('th', {}, 'score'), h('th', { class: 'number' }, 'value'), h('th', { class: 'number' }, 'standard error'))),
    h('tbody', {}, names.map((name) => h('tr', {}, h('td', {}, name), cell(name), cell(`${name}.error`))))));
}

export function viewScoresSection(facts) {
  const scores = facts.data.rendered?.scores;
  if (!scores) return null;
  const names = Object.keys(scores).filter((name) => !name.endsWith('.error') && isNumber(scores[name]));
  return section('scores', 'Scores of the first view', null, scoresTable(scores, names.filter((name) => !isOfOneDefect(name))),
    h('details', {}, h('summary', {}, 'Each defect'), scoresTable(scores, names.filter(isOfOneDefect))));
}
