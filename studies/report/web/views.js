// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint render`: pictures with their defect maps, the lighting, scores of the first view.
import { h, picture, section, svgNode } from './dom.js';
import { count, isNumber, number, plural } from './format.js';

function legend(colours) {
  const entry = ({ name, colour }) => h('span', {}, h('i', { class: 'key', style: `background:${colour}` }), name);
  return h('p', { class: 'lead legend' }, h('span', {}, 'Defect map:'), colours.map(entry));
}

function caption(view) {
  const { camera, shadow, bounce } = view.rays;
  return [`${view.folder}: ${view.mean_samples.toFixed(0)} samples a pixel, ${count(camera)} camera, ${count(shadow)} shadow and ${count(bounce)} reflected rays`,
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

const isOfOneDefect = (name) => /^defects\..*\./.test(name);

function scoresTable(facts, scores, names) {
  const row = (name) => h('tr', { title: name }, h('td', {}, facts.label(name)), h('td', { class: 'number' }, facts.scoreWithError(name, scores)),
    h('td', { class: 'wide muted' }, facts.info(name).meaning ?? ''));
  return h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, h('th', {}, 'score'), h('th', { class: 'number' }, 'value'), h('th', {}, 'what it is'))), h('tbody', {}, names.map(row))));
}

function viewScores(facts, scores) {
  const names = Object.keys(scores).filter((name) => !name.endsWith('.error') && isNumber(scores[name]));
  return h('div', {}, h('h3', {}, 'Scores of the first view'), scoresTable(facts, scores, names.filter((name) => !isOfOneDefect(name))),
    h('details', { class: 'screen-only' }, h('summary', {}, 'Each defect'), scoresTable(facts, scores, names.filter(isOfOneDefect))));
}

export function lightingSection(facts) {
  const data = facts.data.rendered;
  return data ? section('lighting', data.scores ? 'Lighting and scores' : 'Lighting', null,
    h('div', { class: 'scene' }, h('div', { class: 'drawing' }, svgNode(data.drawing)), data.scores && viewScores(facts, data.scores))) : null;
}
