// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint calibrate`: contact sheet, residuals over the picture, methods, standard deviations; the data is the object of
// calibration.json and what studies/calibrate/calibrate_page.cpp adds to it.
import { curvesChart } from './curves.js';
import { badge, h, pngUrl, section, svg } from './dom.js';
import { isNumber, minus, number, plural } from './format.js';

const kEnlarged = 100;  // how much longer residuals are drawn than they are
const kFound = '#ff9500';
const kResidual = '#00beff';

const cell = (text) => h('td', { class: 'number' }, text);
const heading = (text) => h('th', { class: 'number' }, text);
const fixed = (value, digits) => (isNumber(value) ? minus(value.toFixed(digits)) : '\u2013');

/** To two digits of the standard deviation. */
function withSigma(value, sigma) {
  if (!isNumber(value)) return ['\u2013', '\u2013'];
  if (!isNumber(sigma) || sigma <= 0) return [number(value, 6), sigma === 0 ? 'fixed' : 'unknown'];
  const digits = Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
  return [minus(value.toFixed(digits)), sigma.toFixed(digits)];
}

function table(head, rows, caption) {
  return h('div', {}, caption && h('h3', {}, caption), h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, head)), h('tbody', {}, rows))));
}

/** All corners as small circles and their residuals as lines, one path each. */
function corners(list, size) {
  const radius = size[0] / 160;
  let found = '';
  let lines = '';
  for (let i = 0; i + 3 < list.length; i += 4) {
    const [x, y, dx, dy] = list.slice(i, i + 4);
    found += `M${x - radius} ${y}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0`;
    lines += `M${x} ${y}l${kEnlarged * dx} ${kEnlarged * dy}`;
  }
  return [svg('path', { d: found, fill: 'none', stroke: kFound, 'stroke-width': size[0] / 640 }),
    svg('path', { d: lines, fill: 'none', stroke: kResidual, 'stroke-width': size[0] / 320 })];
}

function drawn(picture, size) {
  return svg('svg', { class: 'marked', viewBox: `0 0 ${size[0]} ${size[1]}`, role: 'img', 'aria-label': `${picture.file}: corners and residuals` },
    picture.image && svg('image', { width: size[0], height: size[1], preserveAspectRatio: 'none', href: pngUrl(picture.image) }), corners(picture.corners, size));
}

function enlarged(picture, size) {
  const close = () => dialog.close();
  const dialog = h('dialog', { class: 'enlarged sheet', onclick: close }, drawn(picture, size), h('p', {}, picture.file));
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

function contact(picture, size) {
  const state = picture.accepted ? h('span', { class: 'muted' }, `rms ${fixed(picture.rms_px, 3)} px`) : badge('bad', 'rejected');
  return h('figure', { class: 'contact' }, h('button', { class: 'picture', type: 'button', title: 'Show large', onclick: () => enlarged(picture, size) }, drawn(picture, size)),
    h('figcaption', {}, h('b', {}, picture.file), ' ', state, !picture.accepted && h('span', {}, ` ${picture.reason}`)));
}

export function contactSection(facts) {
  const data = facts.data.calibration;
  if (!data) return null;
  const size = [data.intrinsics.width_px, data.intrinsics.height_px];
  const lead = h('p', { class: 'lead legend' }, h('span', {}, h('i', { class: 'outline hole', style: `color:${kFound}` }), 'corner found'),
    h('span', {}, h('i', { class: 'key', style: `background:${kResidual};height:3px` }), `residual, drawn ${kEnlarged} times as long`));
  return section('pictures', 'Pictures', null, lead, h('div', { class: 'contacts' }, data.pictures.map((picture) => contact(picture, size))));
}

/** The next number at or below it that is 1, 2 or 5 times a power of ten. */
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [5, 2, 1].find((step) => step * power <= value * 1.000001);
}

/** White to blue. */
const shade = (share) => `rgb(${[[255, 60], [255, 130], [255, 190]].map(([low, high]) => Math.round(low + (high - low) * Math.min(1, share))).join(',')})`;

function mapDrawing(data) {
  const { cols, rows, cells } = data.residual_map;
  const [width, height] = [data.intrinsics.width_px, data.intrinsics.height_px];
  const side = width / cols;
  const most = Math.max(1e-12, ...cells.map((one) => one.rms_px));
  const long = Math.max(1e-12, ...cells.filter((one) => one.corners >= 3).map((one) => Math.hypot(...one.mean_px)));
  const scale = (0.8 * side) / long;
  const rectangle = (one, i) => svg('rect', { x: (i % cols) * (width / cols), y: Math.floor(i / cols) * (height / rows), width: width / cols, height: height / rows,
    fill: one.corners ? shade(one.rms_px / most) : '#eceff1', stroke: '#fff', 'stroke-width': width / 640 }, svg('title', {}, `${plural(one.corners, 'corner')}, rms ${fixed(one.rms_px, 3)} px, mean ${one.mean_px.map((v) => fixed(v, 3)).join(', ')} px`));
  const arrow = (one, i) => {
    if (one.corners < 3) return null;
    const from = [((i % cols) + 0.5) * (width / cols), (Math.floor(i / cols) + 0.5) * (height / rows)];
    const to = from.map((at, k) => at + scale * one.mean_px[k]);
    const back = (turn) => [0, 1].map((k) => to[k] - 0.25 * scale * (one.mean_px[k] * Math.cos(turn) + (k ? 1 : -1) * one.mean_px[1 - k] * Math.sin(turn)));
    return svg('path', { d: `M${from}L${to}M${back(0.5)}L${to}L${back(-0.5)}`, fill: 'none', stroke: '#1d252c', 'stroke-width': width / 400 });
  };
  const key = roundBelow(long);
  const bar = svg('svg', { viewBox: `0 0 ${width} ${side * 0.5}`, class: 'map-key' }, svg('path', { d: `M${side * 0.2} ${side * 0.25}h${scale * key}`, stroke: '#1d252c', 'stroke-width': width / 300 }),
    svg('text', { x: side * 0.4 + scale * key, y: side * 0.33, 'font-size': side * 0.24, fill: '#1d252c' }, `mean residual of ${number(key)} px; darkest field: rms ${fixed(most, 3)} px; grey: no corners`));
  return h('div', {}, svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'residual-map', role: 'img', 'aria-label': 'Residuals over the picture' }, cells.map(rectangle), cells.map(arrow)), bar);
}

function growth(data) {
  const rings = data.growth;
  const line = (name, key) => ({ name, is_joined: true, points: rings.filter((ring) => isNumber(ring[key])).map((ring) => [0.5 * (ring.from_px + ring.to_px), ring[key]]) });
  const rows = rings.map((ring) => h('tr', {}, cell(`${ring.from_px.toFixed(0)} to ${ring.to_px.toFixed(0)}`), cell(ring.corners), cell(fixed(ring.rms_px, 3)), cell(fixed(ring.error_px, 3))));
  return h('div', {}, curvesChart({ title: 'From the centre to the edge', x: 'distance from the middle of the picture (px)', y: 'px',
    series: [line('residuals, rms', 'rms_px'), line('computed point, standard deviation', 'error_px')] }),
    table([heading('distance px'), heading('corners'), heading('residuals px'), heading('computed point px')], rows));
}

export function residualSection(facts) {
  const data = facts.data.calibration;
  if (!data?.residual_map) return null;
  const point = data.hand_eye ? 'The computed point is one on the board, seen from a robot pose without error.'
    : 'The computed point is where a ray that is known falls, a turn of the camera taken out.';
  return section('residuals', 'Residuals over the picture', `Mean residual and rms of the corners in each part of the picture. Arrows that agree with their neighbours show what the lens model lacks. ${point}`,
    h('div', { class: 'pair' }, mapDrawing(data), growth(data)));
}

export function comparedSection(facts) {
  const methods = facts.data.calibration?.methods;
  if (!methods?.length) return null;
  const best = Math.min(...methods.filter((one) => !one.failed).map((one) => one.prediction_rms_px));
  const { prediction_folds: folds, prediction_5fold_splits: splits } = facts.data.calibration;
  const row = (one) => h('tr', {}, h('td', {}, one.name === 'glint' ? 'Glint, joint solution' : `OpenCV, ${one.name}`),
    cell(one.failed ? 'failed' : fixed(one.prediction_rms_px, 3)), cell(one.failed ? '' : `${(one.prediction_rms_px / best).toFixed(1)} x`),
    splits > 0 && cell(one.failed ? '' : fixed(one.prediction_5fold_rms_px, 3)));
  return section('compared', 'Methods compared', `How each method predicts the corners of pictures that it was not given, from the robot\u2019s pose alone; rms. ${folds} parts are left out one after another${splits > 0 ? `; beside it the mean of ${plural(splits, 'random split')} into five parts` : ''}.`,
    table([h('th', {}, 'method'), heading('prediction px'), heading('over the best'), splits > 0 && heading('in five parts px')], methods.map(row)));
}

/** The pictures without which the solution moves farthest, drawn against each other. */
export function influenceSection(facts) {
  const data = facts.data.calibration;
  const pulling = data?.pictures.filter((one) => isNumber(one.influence?.cook)).sort((a, b) => b.influence.cook - a.influence.cook);
  if (!pulling?.length) return null;
  const most = Math.max(pulling[0].influence.cook, 1e-12);
  const bar = (one) => h('td', { class: 'wide' }, h('i', { class: 'key', style: `display:block;height:8px;background:${one.influence.cook > 1 ? kFound : kResidual};width:${((100 * one.influence.cook) / most).toFixed(1)}%` }));
  const row = (one) => h('tr', {}, h('td', {}, one.file), cell(number(one.influence.cook, 2)), bar(one), cell(number(one.influence.focal_px, 2)), cell(number(one.influence.center_px, 2)),
    data.hand_eye && [cell(number(one.influence.hand_eye_mm, 2)), cell(number(one.influence.hand_eye_deg, 2))]);
  return section('influence', 'Which pictures pull', 'How far all moves when a picture is left out, in standard deviations together (Cook\u2019s distance; over 1 a picture alone moves the solution by one) and in single figures. One that pulls hard deserves a second look or company.',
    table([h('th', {}, 'picture'), heading('Cook'), h('th', {}, ''), heading('focal length px'), heading('centre px'), data.hand_eye && [heading('hand-eye mm'), heading('hand-eye degrees')]], pulling.slice(0, 12).map(row)));
}

export function nextSection(facts) {
  const data = facts.data.calibration;
  if (!data?.next?.views?.length) return null;
  const at = (one) => one.base_from_flange && h('td', { class: 'number' }, `${one.base_from_flange.translation_mm.map((v) => fixed(v, 1)).join(', ')}; ${one.base_from_flange.rotation_vector_rad.map((v) => fixed(v, 4)).join(', ')}`);
  const row = (one, i) => h('tr', {}, cell(i + 1), h('td', { class: 'wide' }, one.text), cell(fixed(one.point_error_px, 3)), at(one));
  const isPosed = Boolean(data.next.views[0].base_from_flange);
  return section('next', 'What to photograph next', `The views that would tell most, the best first. A computed point is known to ${fixed(data.next.point_error_px, 3)} px now; the table has what is expected with a view and those before it.`,
    table([heading(''), h('th', {}, 'view'), heading('computed point px'), isPosed && heading('base_from_flange: mm; rotation vector rad')], data.next.views.map(row)));
}

export function pictureTableSection(facts) {
  const data = facts.data.calibration;
  if (!data) return null;
  const isPosed = Boolean(data.hand_eye);
  const row = (one) => h('tr', { class: one.accepted ? '' : 'infeasible' }, h('td', {}, one.file), h('td', {}, one.accepted ? 'yes' : 'no'), cell(one.corners.length / 4), cell(fixed(one.rms_px, 3)),
    isPosed && [cell(fixed(one.prediction_px, 3)), cell(fixed(one.chi_square, 1)), cell(one.board_turn ?? '\u2013'), h('td', {}, one.pose ?? '')], h('td', { class: 'wide' }, one.reason));
  return section('list', 'Table of pictures', isPosed && 'Chi-square: how badly the robot\u2019s pose agrees with the others, 6 on average when all is well. Turns: how often the board was turned round to agree.',
    table([h('th', {}, 'picture'), h('th', {}, 'used'), heading('corners'), heading('rms px'), isPosed && [heading('left out px'), heading('chi-square'), heading('turns'), h('th', {}, 'pose')], h('th', {}, 'why not')], data.pictures.map(row)));
}

const kCameraAxes = ['x, to the right', 'y, downwards', 'z, along the view'];
const kBoardAxes = ['x, along its rows', 'y, along its columns', 'z, into it'];

function lensRows(data) {
  const { intrinsics } = data;
  const { sigma } = intrinsics;
  const share = (value, error) => (error > 0 ? `${number((100 * error) / value, 2)} % of it` : '');
  const prior = (key, i) => (intrinsics.prior?.[key][i] > 0 ? `known beforehand to ${number(intrinsics.prior[key][i], 3)}` : intrinsics.prior ? 'kept as given' : '');
  const one = (name, value, error, unit, what, known) => ({ name, value, error, unit, what: [what, known].filter(Boolean).join('; ') });
  return [one('focal length along x', intrinsics.focal_px[0], sigma.focal_px[0], 'px', share(intrinsics.focal_px[0], sigma.focal_px[0]), prior('focal_px', 0)),
    one('focal length along y', intrinsics.focal_px[1], sigma.focal_px[1], 'px', share(intrinsics.focal_px[1], sigma.focal_px[1]), prior('focal_px', 1)),
    one('centre x', intrinsics.center_px[0], sigma.center_px[0], 'px', 'a shift of it looks like a turn of the camera', prior('center_px', 0)),
    one('centre y', intrinsics.center_px[1], sigma.center_px[1], 'px', '', prior('center_px', 1)),
    ...['k1', 'k2', 'k3'].map((name, i) => one(`radial ${name}`, intrinsics.radial[i], sigma.radial[i], '', '', prior('radial', i))),
    ...['p1', 'p2'].map((name, i) => one(`tangential ${name}`, intrinsics.tangential[i], sigma.tangential[i], '', '', prior('tangential', i)))];
}

/** Increments of hand-eye and board stand in the source's own frame: the camera's, the board's. */
function poseRows(data, first, pose, of, axes) {
  const root = (i) => Math.sqrt(Math.max(0, data.covariance[first + i]?.[first + i] ?? NaN));
  const isKnown = data.covariance.length > first;
  return axes.flatMap((axis, i) => [
    { name: `${of}, place along its ${axis}`, value: pose.translation_mm[i], error: isKnown ? root(3 + i) : null, unit: 'mm', what: '', isOther: true },
    { name: `${of}, turn about its ${axis}`, value: (pose.rotation_vector_rad[i] * 180) / Math.PI, error: isKnown ? (root(i) * 180) / Math.PI : null, unit: 'degrees', what: '', isOther: true }]);
}

const accuracyRow = (one) => {
  const [value, sigma] = withSigma(one.value, one.error);
  return h('tr', {}, h('td', {}, one.name), !one.isOther && cell(value), cell(sigma), h('td', {}, one.unit), !one.isOther && h('td', { class: 'wide muted' }, one.what));
};

/** What of the intrinsics goes together so much that one alone says little. */
function coupled(data) {
  const names = ['fx', 'fy', 'cx', 'cy', 'k1', 'k2', 'k3', 'p1', 'p2'];
  const found = [];
  for (let i = 0; i < 9; ++i) {
    for (let k = 0; k < i; ++k) {
      const scale = Math.sqrt(data.covariance[i][i] * data.covariance[k][k]);
      const share = scale > 0 ? data.covariance[i][k] / scale : 0;
      if (Math.abs(share) > 0.9) found.push(`${names[k]} and ${names[i]} (${minus(share.toFixed(2))})`);
    }
  }
  return found.length > 0 && h('p', { class: 'caption' }, `Correlated by more than 0.9, so that one makes up for the other: ${found.join(', ')}.`);
}

function cellFigures(data) {
  const { noise, board, hand_eye: pose } = data;
  const line = (name, value, unit) => h('tr', {}, h('td', {}, name), cell(isNumber(value) ? number(value, 5) : '\u2013'), h('td', {}, unit));
  return table([h('th', {}, 'what'), heading('value'), h('th', {}, '')], [
    line('error of a corner along one axis', noise.corner_px, 'px'), line('robot, error of its place along one axis', noise.robot_mm, 'mm'), line('robot, error of its rotation about one axis', noise.robot_deg, 'degrees'),
    line('board places that the pictures say one by one, scatter', pose.scatter_mm, 'mm'), line('the same, rotation', pose.scatter_deg, 'degrees'),
    h('tr', {}, h('td', {}, 'orientation of the board, settled by'), cell(board.orientation), h('td', {})),
    line('true size of the squares over the given one', board.measured_scale.factor, ''), line('its standard deviation', board.measured_scale.sigma, ''),
    line('error of a computed point, middle of the picture', data.point_error_px.center, 'px'), line('in its corners', data.point_error_px.edge, 'px')], 'What the data say of robot, corners and board');
}

export function accuracySection(facts) {
  const data = facts.data.calibration;
  if (!data) return null;
  const head = [h('th', {}, 'what'), heading('value'), heading('standard deviation'), h('th', {}, ''), h('th', {}, '')];
  const lens = h('div', {}, table(head, lensRows(data).map(accuracyRow), 'Intrinsics'), coupled(data));
  if (!data.hand_eye) return section('accuracy', 'How well it is known', 'Standard deviations of what was estimated.', h('div', { class: 'pair' }, lens));
  const short = [h('th', {}, 'what'), heading('standard deviation'), h('th', {}, '')];
  const poses = table(short, [...poseRows(data, 9, data.hand_eye, 'camera', kCameraAxes), ...poseRows(data, 15, data.board.pose, 'board', kBoardAxes)].map(accuracyRow), `Camera on the ${data.hand_eye.to}, board on the ${data.board.pose.to}`);
  return section('accuracy', 'How well it is known', 'Standard deviations of what was estimated; errors of places and turns stand in the frame of the camera and of the board themselves.',
    h('div', { class: 'pair' }, lens, poses, cellFigures(data)));
}
