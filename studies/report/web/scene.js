// SPDX-License-Identifier: GPL-3.0-or-later
// What was simulated: the part with its defects marked, camera, light, sizes of the defects.
import { h, pngUrl, section, svg } from './dom.js';

const kMostMarks = 60;

/** A frame about a defect with its name beside it, on the side with more room. */
function mark({ window_px: [left, top, width, height], label }, unit, pictureWidth) {
  const least = 3 * unit;
  const [x, y] = [left - Math.max(0, least - width / 2), top - Math.max(0, least - height / 2)];
  const [across, down] = [Math.max(width, 2 * least), Math.max(height, 2 * least)];
  const isLeft = x + across > 0.8 * pictureWidth;
  return svg('g', {}, svg('rect', { x, y, width: across, height: down, fill: 'none', stroke: '#d55e00', 'stroke-width': 0.5 * unit }),
    svg('text', { x: isLeft ? x - unit : x + across + unit, y: y + 0.5 * down + 0.9 * unit, 'text-anchor': isLeft ? 'end' : 'start', fill: '#a84300', 'font-size': 2.8 * unit,
      stroke: '#fff', 'stroke-width': 0.6 * unit, 'paint-order': 'stroke' }, label));
}

function markedPart({ picture, size_px: [width, height], marks, note }) {
  return h('figure', {}, svg('svg', { class: 'subject', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'The part with its defects marked' },
    svg('image', { width, height, preserveAspectRatio: 'none', href: pngUrl(picture) }),
    (marks ?? []).slice(0, kMostMarks).map((one) => mark(one, Math.max(width, height) / 170, width))), note && h('figcaption', {}, note));
}

function defectTable({ head, rows, more }) {
  return h('div', {}, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' }, h('thead', {}, h('tr', {}, head.map((text) => h('th', {}, text)))),
    h('tbody', {}, rows.map((row) => h('tr', {}, row.map((text) => h('td', {}, text))))))), more && h('p', { class: 'muted' }, more));
}

export function sceneSection(facts) {
  const { scene } = facts.data;
  if (!scene) return null;
  const lines = h('table', { class: 'provenance facts' }, h('tbody', {}, (scene.facts ?? []).map(([name, text]) => h('tr', {}, h('th', {}, name), h('td', {}, text)))));
  return section('scene', 'What was simulated', null, h('div', { class: 'scene' }, scene.picture && markedPart(scene),
    h('div', {}, lines, scene.defects?.rows.length > 0 && defectTable(scene.defects))));
}
