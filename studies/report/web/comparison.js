// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint compare`: table of pairs, overlay, blink and wipe, difference, rings, spectra; the data is the object of
// result.json and what studies/compare/compare_page.cpp adds to it.
import { axisStyle, chart, kInk } from './charts.js';
import { h, picture, pngUrl, section } from './dom.js';
import { isNumber, number, plural } from './format.js';

const kBlinkMs = 600;
const kSimulated = '#d55e00';
const kReal = '#0072b2';

const fixed = (value, digits) => (isNumber(value) ? value.toFixed(digits) : '\u2013');
const cell = (value, digits) => h('td', { class: 'number' }, fixed(value, digits));
const slope = (value) => (value ? `${fixed(value.value, 2)} (${fixed(value.low, 2)} to ${fixed(value.high, 2)})` : '\u2013');
const table = (head, rows) => h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
  h('thead', {}, h('tr', {}, head.map((text, i) => h('th', { class: i > 0 ? 'number' : null }, text)))), h('tbody', {}, rows)));

function pairRow(pair, i) {
  const name = `${pair.simulated} / ${pair.real}`;
  return h('tr', {}, h('td', {}, pair.overlay ? h('a', { href: `#pair${i + 1}` }, name) : name), cell(pair.iou, 4), cell(pair.mean_distance_px, 3), cell(pair.hd95_px, 3), cell(pair.offset_px, 3),
    h('td', { class: 'number' }, slope(pair.ring_slope)), cell(pair.ssim, 3), cell(pair.gmsd, 3), cell(pair.correlation, 3), cell(pair.histogram_distance, 4), cell(pair.exposure.gain, 3));
}

export function pairsSection(facts) {
  const data = facts.data.comparison;
  if (!data) return null;
  return section('pairs', 'Pairs', 'Simulated and real picture; distances in pixels, grey in shares of full scale after exposures were matched.',
    table(['pair', 'IoU', 'mean distance px', '95 % px', 'offset px', 'slope, px per 1000 px', 'SSIM', 'GMSD', 'correlation', 'histogram', 'gain'], data.pairs.map(pairRow)));
}

const kMeasures = { histogram_distance: 'grey values (Wasserstein, over their mean)', radial_spectrum: 'spectrum (rms of log10)', cooccurrence_contrast: 'contrast of neighbours (|ln|)', autocorrelation_length: 'autocorrelation length (|ln|)' };

export function yardstickSection(facts) {
  const stick = facts.data.comparison?.yardstick;
  if (!stick) return null;
  const row = (measure) => h('tr', {}, h('td', {}, kMeasures[measure.name] ?? measure.name), cell(measure.real, 3), h('td', { class: 'number' }, measure.real_quartiles.map((value) => fixed(value, 3)).join(' to ')), cell(measure.simulated, 3), cell(measure.multiple, 2));
  return section('yardstick', 'Photographs among each other', `Medians over ${stick.pairs} pairs of ${stick.reals} photographs, and of the simulated picture against them.`,
    table(['distance', 'among photographs', 'quartiles', 'simulated to photographs', 'multiple'], stick.measures.map(row)));
}

/** Both pictures on top of each other: a slider wipes, a button blinks. */
function wipe(pair) {
  const upper = h('img', { src: pngUrl(pair.simulated_image), alt: 'simulated', class: 'upper' });
  const slider = h('input', { type: 'range', min: '0', max: '100', value: '50', 'aria-label': 'share of the simulated picture' });
  const show = (share) => { upper.style.clipPath = `inset(0 ${100 - share}% 0 0)`; };
  slider.addEventListener('input', () => show(Number(slider.value)));
  let timer = null;
  const button = h('button', { type: 'button', class: 'blink', onclick: () => {
    if (timer) { clearInterval(timer); timer = null; show(Number(slider.value)); button.textContent = 'Blink'; return; }
    let isShown = false;
    timer = setInterval(() => { isShown = !isShown; show(isShown ? 100 : 0); }, kBlinkMs);
    button.textContent = 'Stop';
  } }, 'Blink');
  show(50);
  return h('figure', { class: 'screen-only wipe' }, h('div', { class: 'stack' }, h('img', { src: pngUrl(pair.real_image), alt: 'photograph' }), upper),
    h('figcaption', {}, 'simulated left of the slider, photograph right of it ', slider, button));
}

function scaleBar(scale) {
  return h('p', { class: 'diverging' }, h('span', {}, `\u2212${number(scale)}`), h('i', {}), h('span', {}, `+${number(scale)} of full scale`));
}

function ringChart(pair) {
  const rings = pair.rings.filter((ring) => ring.points > 0);
  if (!rings.length) return null;
  const points = (key) => rings.filter((ring) => isNumber(ring[key])).map((ring) => [0.5 * (ring.inner_px + ring.outer_px), ring[key]]);
  const series = (name, key, colour, symbol) => ({ name, type: 'line', data: points(key), symbol, symbolSize: 7, itemStyle: { color: colour }, lineStyle: { color: colour } });
  const option = () => ({
    grid: { left: 64, right: 16, top: 34, bottom: 46 },
    legend: { top: 0, textStyle: { color: kInk } },
    xAxis: { type: 'value', name: 'distance from the middle of the picture (px)', nameLocation: 'middle', nameGap: 28, ...axisStyle },
    yAxis: { type: 'value', name: 'offset (px)', nameLocation: 'middle', nameGap: 46, scale: true, ...axisStyle, axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value) } },
    series: [series('radial', 'radial_px', kSimulated, 'circle'), series('tangential', 'tangential_px', kReal, 'diamond')],
  });
  return h('div', {}, h('h4', {}, 'Offset of edges against the radius'), chart(240, `Offset against the radius of ${pair.real}`, 0, option));
}

function spectrumChart(pair) {
  if (!pair.texture) return null;
  const curve = (name, texture, colour) => ({ name, type: 'line', showSymbol: false, lineStyle: { color: colour }, itemStyle: { color: colour },
    data: texture.radial_spectrum.map((value, i) => [(i + 0.5) / texture.window_px, value]).filter(([at, value]) => at > 0.004 && value > 0) });
  const axis = { ...axisStyle, axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value), hideOverlap: true } };
  const option = () => ({
    grid: { left: 64, right: 16, top: 34, bottom: 46 },
    legend: { top: 0, textStyle: { color: kInk } },
    xAxis: { type: 'log', name: 'cycles per pixel', nameLocation: 'middle', nameGap: 28, ...axis },
    yAxis: { type: 'log', name: 'power (px\u00b2)', nameLocation: 'middle', nameGap: 46, ...axis },
    series: [curve('simulated', pair.texture.simulated, kSimulated), curve('photograph', pair.texture.real, kReal)],
  });
  return h('div', {}, h('h4', {}, 'Spectrum of the surface'), chart(240, `Spectra of ${pair.real}`, 0, option));
}

/** Power by direction: the lay of a surface is a peak across it. */
function angularChart(pair) {
  if (!pair.texture) return null;
  const curve = (name, texture, colour) => ({ name, type: 'line', showSymbol: false, lineStyle: { color: colour }, itemStyle: { color: colour },
    data: texture.angular_spectrum.map((value, i) => [(i + 0.5) * 180 / texture.angular_spectrum.length, value]) });
  const option = () => ({
    grid: { left: 64, right: 16, top: 34, bottom: 46 },
    legend: { top: 0, textStyle: { color: kInk } },
    xAxis: { type: 'value', min: 0, max: 180, interval: 45, name: 'direction of the wave (degrees)', nameLocation: 'middle', nameGap: 28, ...axisStyle },
    yAxis: { type: 'value', name: 'share of the power', nameLocation: 'middle', nameGap: 46, ...axisStyle, axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value) } },
    series: [curve('simulated', pair.texture.simulated, kSimulated), curve('photograph', pair.texture.real, kReal)],
  });
  return h('div', {}, h('h4', {}, 'Spectrum by direction'), chart(240, `Spectra by direction of ${pair.real}`, 0, option));
}

/** Lay, lengths and neighbours of both surfaces. */
function textureTable(pair) {
  if (!pair.texture) return null;
  const sides = [pair.texture.simulated, pair.texture.real];
  const row = (name, text) => h('tr', {}, h('td', {}, name), sides.map((side) => h('td', { class: 'number' }, text(side))));
  const neighbours = ({ contrast, correlation, energy, entropy_bits: entropy }) => `${number(contrast, 3)}, ${number(correlation, 3)}, ${number(energy, 3)}, ${number(entropy, 3)} bits`;
  return h('div', {}, h('h4', {}, 'Texture of the surface'), h('p', { class: 'lead' }, `In windows of ${sides[0].window_px} px, of greys over their mean.`),
    table(['', 'simulated', 'photograph'], [row('spread of grey', (side) => fixed(side.spread, 4)), row('autocorrelation length px (shortest, longest)', (side) => `${fixed(side.autocorrelation_px, 2)}, ${fixed(side.longest_px, 2)}`),
      row('direction of the lay (strength)', (side) => `${fixed(side.lay_deg, 1)}\u00b0 (${fixed(side.lay_strength, 2)})`), row('neighbours: contrast, correlation, energy, entropy', (side) => neighbours(side.cooccurrence))]));
}

function causesTable(pair) {
  if (!pair.causes.length) return null;
  const row = (cause) => h('tr', {}, h('td', {}, cause.name), h('td', { class: 'number' }, `${number(cause.value, 3)} ${cause.unit}`), h('td', { class: 'number' }, isNumber(cause.sigma) ? `\u00b1 ${number(cause.sigma, 2)} ${cause.unit}` : '\u2013'),
    h('td', { class: 'number' }, `${(100 * cause.share).toFixed(0)} %`), h('td', {}, cause.group ? `not separable from ${cause.group.filter((name) => name !== cause.name).join(', ')}` : ''));
  return h('div', {}, h('h4', {}, 'Causes'), table(['cause', 'value', 'sigma', 'explains', ''], pair.causes.map(row)));
}

/** What a table of so many edges does not show. */
function unlistedEdges(pair, rows) {
  const { count, outline_share: share } = pair.unlisted_edges ?? { count: 0, outline_share: 0 };
  const more = pair.edges.length - rows;
  if (more <= 0 && !count && share < 5e-4) return null;
  return h('p', { class: 'lead' }, more > 0 ? `${more} shorter ones are in result.json. ` : '',
    count || share >= 5e-4 ? `Not listed: ${count} further edge${count === 1 ? '' : 's'}; ${(100 * share).toFixed(1)} % of the outline.` : '');
}

function edgesTable(pair) {
  if (!(pair.edges?.length > 1)) return pair.edges && unlistedEdges(pair, 12);
  const figures = (edge, keys) => keys.map((key) => cell(edge[key], 3));
  if (!pair.edges[0].surface) {
    const row = (edge) => h('tr', {}, h('td', {}, edge.name), h('td', { class: 'number' }, edge.middle_px.map((value) => value.toFixed(0)).join(', ')), h('td', { class: 'number' }, edge.points),
      figures(edge, ['mean_px', 'offset_px', 'sigma_px']), edge.shift_px.map((value) => cell(value, 2)));
    return h('div', {}, h('h4', {}, 'Edge by edge'), table(['edge', 'middle px', 'points', 'mean distance px', 'offset px', 'sigma px', 'shift x px', 'shift y px'], pair.edges.slice(0, 12).map(row)), unlistedEdges(pair, 12));
  }
  const row = (edge) => h('tr', {}, h('td', {}, edge.surface === edge.beyond ? `${edge.name} on ${edge.surface}` : `${edge.name}: ${edge.surface} | ${edge.beyond}`), h('td', { class: 'number' }, edge.middle_mm.map((value) => value.toFixed(1)).join(', ')),
    cell(edge.length_mm, 1), figures(edge, ['mean_px', 'offset_px', 'sigma_px', 'offset_mm']));
  return h('div', {}, h('h4', {}, 'Edges of the part'), h('p', { class: 'lead' }, 'Between the surfaces that the simulated view shows; the offset is > 0 where the photograph\u2019s edge lies on the side of the second one.'),
    table(['edge', 'middle mm', 'length mm', 'mean px', 'offset px', 'sigma px', 'offset mm'], pair.edges.slice(0, 24).map(row)), unlistedEdges(pair, 24));
}

/** Grey values by ninths of the part's extent, as they lie in the picture. */
function regionsTable(pair) {
  const regions = pair.regions ?? [];
  if (regions.length < 2) return null;
  const row = (region) => h('tr', {}, h('td', {}, region.name), cell(region.grey, 3), cell(region.difference, 3), cell(region.residual_rms, 3), cell(region.correlation, 3), cell(region.ssim, 3), cell(region.gmsd, 3), cell(region.histogram_distance, 4));
  return h('div', {}, h('h4', {}, 'Region by region'), h('p', { class: 'lead' }, 'Grey, differences, rms and histogram distance in shares of full scale.'), table(['ninth of the part', 'grey of the photograph', 'minus simulated', 'rms', 'correlation', 'SSIM', 'GMSD', 'histogram'], regions.map(row)));
}

function inspectionTable(pair) {
  const { inspection } = pair;
  if (!inspection) return null;
  const contrast = (seen) => (seen.contrast ? `${(100 * seen.contrast.value).toFixed(1)} % (${(100 * seen.contrast.low).toFixed(1)} to ${(100 * seen.contrast.high).toFixed(1)})` : '\u2013');
  const sides = ['simulated', 'real'];
  const unfound = (side) => (side.found === null ? 'outside the picture' : 'missed');
  const row = (defect) => h('tr', {}, h('td', {}, defect.label), sides.map((side) => h('td', { class: 'number' }, defect[side].found_as ?? unfound(defect[side]))), sides.map((side) => h('td', { class: 'number' }, contrast(defect[side]))));
  const total = (side) => `${inspection[side].found} found, ${inspection[side].missed} missed, ${plural(inspection[side].false_alarms, 'false alarm')}`;
  return h('div', {}, h('h4', {}, 'Inspection of both'), h('p', { class: 'lead' }, `Simulated: ${total('simulated')}. Photograph: ${total('real')}.`),
    inspection.notes.length > 0 && h('ul', { class: 'notes' }, inspection.notes.map((note) => h('li', {}, note))),
    table(['defect', 'simulated', 'photograph', 'contrast simulated', 'contrast in the photograph'], inspection.defects.map(row)));
}

function pairShown(pair, i) {
  const figure = (image, name, ...text) => h('figure', {}, picture(image, name, 'frame'), h('figcaption', {}, text));
  return h('article', { class: 'part', id: `pair${i + 1}` }, h('h3', {}, `${pair.simulated} / ${pair.real}`),
    h('p', { class: 'lead' }, `Outlines: simulated by ${pair.outline.simulated.replace('_', ' ')}, real by ${pair.outline.real.replace('_', ' ')}; ${pair.outline.points} points took part, ${(100 * pair.outline.share).toFixed(0)} % of all.`),
    pair.notes.length > 0 && h('ul', { class: 'notes' }, pair.notes.map((note) => h('li', {}, note))),
    h('div', { class: 'pair' }, figure(pair.overlay, `overlay of ${pair.real}`, 'The simulated part in red on the photograph; located edges of the photograph in blue.'),
      figure(pair.difference, `difference of ${pair.real}`, 'Photograph minus simulated picture.', scaleBar(pair.difference_scale))),
    wipe(pair),
    h('div', { class: 'pair paper-only' }, figure(pair.simulated_image, `simulated ${pair.simulated}`, 'Simulated.'), figure(pair.real_image, `photograph ${pair.real}`, 'Photograph.')),
    causesTable(pair), edgesTable(pair), regionsTable(pair), inspectionTable(pair), textureTable(pair), h('div', { class: 'pair' }, ringChart(pair), spectrumChart(pair), angularChart(pair)));
}

export function comparisonSection(facts) {
  const pairs = facts.data.comparison?.pairs;
  if (!pairs) return null;
  const shown = pairs.filter((pair) => pair.overlay);
  return section('compared', 'What differs', null, shown.map(pairShown), shown.length < pairs.length && h('p', { class: 'lead' }, `The first ${shown.length} pairs; the folder has pictures of all.`));
}
