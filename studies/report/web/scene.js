// SPDX-License-Identifier: GPL-3.0-or-later
// What was simulated: the part with its defects marked, camera, light, sizes of the defects.
import { h, pngUrl, section, svg } from './dom.js';

const kMaxMarks = 60;

const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/** Where a name may stand beside a frame: the first place within the picture that no other name takes; null: there is none. */
function placeOfName(frame, label, unit, [width, height], taken) {
  const [across, down] = [0.62 * 2.8 * unit * label.length, 3 * unit];
  const middle = { x: frame.x + 0.5 * (frame.width - across), y: frame.y + 0.5 * (frame.height - down) };
  const places = [[frame.x + frame.width + unit, middle.y], [frame.x - unit - across, middle.y], [middle.x, frame.y - down - 0.5 * unit], [middle.x, frame.y + frame.height + 0.5 * unit]];
  return places.map(([left, top]) => ({ left, top, right: left + across, bottom: top + down }))
    .find((box) => box.left >= 0 && box.right <= width && box.top >= 0 && box.bottom <= height && !taken.some((other) => overlap(box, other))) ?? null;
}

/** A frame about a defect with its name beside it, where there is room. */
function mark({ window_px: [left, top, width, height], label }, unit, size, taken) {
  const least = 6 * unit;
  const frame = { x: left - Math.max(0, least - width) / 2, y: top - Math.max(0, least - height) / 2, width: Math.max(width, least), height: Math.max(height, least) };
  const place = placeOfName(frame, label, unit, size, taken);
  if (place) taken.push(place);
  return svg('g', {}, svg('title', {}, label), svg('rect', { ...frame, fill: 'none', stroke: '#d55e00', 'stroke-width': 0.5 * unit }),
    place && svg('text', { x: place.left, y: place.top + 2.4 * unit, fill: '#a84300', 'font-size': 2.8 * unit,
      stroke: '#fff', 'stroke-width': 0.6 * unit, 'paint-order': 'stroke' }, label));
}

function markedPart({ picture, size_px: [width, height], marks, note }) {
  const taken = [];
  return h('figure', {}, svg('svg', { class: 'subject', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'The part with its defects marked' },
    svg('image', { width, height, preserveAspectRatio: 'none', href: pngUrl(picture) }),
    (marks ?? []).slice(0, kMaxMarks).map((one) => mark(one, Math.max(width, height) / 170, [width, height], taken))), note && h('figcaption', {}, note));
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
