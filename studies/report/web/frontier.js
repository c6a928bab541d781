// SPDX-License-Identifier: GPL-3.0-or-later
// Error against CPU time of every method of rendering; the data is the object of frontier.json.
import { axisStyle, chart, encode, kHalo, kText } from './charts.js';
import { badge, h, section } from './dom.js';
import { isNumber, number } from './format.js';

const kKinds = [
  { name: 'frame_rmse', title: 'Error of the pictures', axis: 'RMSE of radiance, full scale 1', limit: 0.006, rounding: 1e-6 },
  { name: 'h_error_points', title: 'Error of the homogeneity h_rms', axis: 'points', limit: 0.05, rounding: 1e-4 },
  { name: 'contrast_error_percent', title: 'Error of the worst defect\u2019s contrast', axis: '%', limit: 2, rounding: 1e-3 },
];

/** How points look, by their `kind`; the automatic choice has a ring of its own. */
const kLooks = [
  { colour: '#0072b2', facets: '#56b4e9', symbol: 'circle', size: 11, label: 'top' },
  { colour: '#d55e00', facets: '#cc79a7', symbol: 'diamond', size: 14, label: 'bottom' },
  { colour: '#009e73', facets: '#009e73', symbol: 'rect', size: 11, label: 'bottom' },
  null,
  { colour: '#0072b2', facets: '#56b4e9', symbol: 'circle', size: 11, label: 'bottom' },
  { colour: '#d55e00', facets: '#d55e00', symbol: 'diamond', size: 14, label: 'bottom' },
  { colour: '#009e73', facets: '#009e73', symbol: 'rect', size: 11, label: 'bottom' },
];
/** Files of older versions tell no kind. */
const lookOf = (point) => kLooks[point.kind ?? 0];
const kCurrentColour = '#c23b22';
const kInk = '#27313a';

const hasNoisyReference = (data) => data.reference?.is_noisy === true;
const hasOtherReflections = (data, point) => point.max_reflections > 0 && point.max_reflections !== data.points[0].max_reflections;

/** What of a point is not the scene's own, beside its resolution. */
function deviation(data, point) {
  if (point.realisation && point.realisation !== 'own') return { name: ', defects realised otherwise', colour: '#009e73', symbol: 'rect' };
  if (hasOtherReflections(data, point)) return { name: ', other reflections', colour: '#d55e00', symbol: 'diamond' };
  return null;
}

/** Points of one look: kind of method, resolution, and whether the surface is the study's own. */
function families(data) {
  const own = data.points[0]?.tessellation;
  const found = new Map();
  for (const point of data.points) {
    const look = lookOf(point);
    if (!look || point.problem) continue;
    const isFacets = point.tessellation !== own;
    const isHalf = point.resolution !== 'full';
    const other = deviation(data, point);
    const isSingle = isFacets || other !== null;
    const resolution = isHalf ? `, ${point.resolution} resolution` : '';
    const name = `${point.kind_name ?? 'methods'}${resolution}${isFacets ? ', facets' : ''}${other?.name ?? ''}`;
    if (!found.has(name)) found.set(name, { ...look, name, isHalf, isFacets, isSingle, colour: other?.colour ?? (isFacets ? look.facets : look.colour), symbol: other?.symbol ?? (isFacets ? 'triangle' : look.symbol), points: [] });
    found.get(name).points.push(point);
  }
  return [...found.values()];
}

const ms = (seconds) => `${number(1e3 * seconds, 3)} ms`;

/** What stands beside a point: how many rays, or how exact the directions are. */
function mark(point, family) {
  if (family.isFacets) return point.tessellation.replace('facets ', '').replace(' um', ' \u00b5m');
  if (point.realisation && point.realisation !== 'own') return point.realisation;
  if (point.samples) return family.isSingle ? `${point.max_reflections} refl.` : String(point.samples);
  if (point.rays_per_px) return String(point.rays_per_px);
  return isNumber(point.max_direction_error_mrad) ? `${number(point.max_direction_error_mrad)} mrad` : '';
}

function pointText(point) {
  const lines = [`<b>${encode(point.label)}</b>`, `${encode(point.tessellation)}`, `one more candidate: ${ms(point.cpu_s)}`, `first candidate: ${number(point.cold_s, 3)} s`,
    point.samples ? `${point.samples} samples, at most ${point.max_reflections} reflections; ${number(point.rays)} rays counted; ${point.pictures} picture${point.pictures > 1 ? 's' : ''} with other random numbers` : `${number(point.traced_per_px, 3)} rays a pixel traced; mean of the scan: ${encode(point.form)}, ${point.frame_pixels} pixels frame by frame`];
  if (isNumber(point.frame_rmse)) lines.push(`frame error: ${number(point.frame_rmse, 3)}, away from edges ${number(point.smooth_frame_rmse, 3)}`);
  lines.push(`error of h: ${number(point.h_error_points, 3)} points`);
  const defects = Object.entries(point.defects).map(([name, one]) => ({ name, worst: Math.max(one.weber_error_percent, one.change_error_percent), ...one })).sort((a, b) => b.worst - a.worst);
  for (const one of defects.slice(0, 4)) lines.push(`${encode(one.name)}: contrast ${number(one.weber_error_percent, 3)} %, change ${number(one.change_error_percent, 3)} %`);
  if (defects.length > 4) lines.push(`and ${defects.length - 4} less wrong defects`);
  return lines.join('<br>');
}

const errorOf = (kind, point) => (kind.score ? point.scores?.[kind.score]?.error : point[kind.name]);
const drawable = (kind) => (point) => !point.problem && !point.is_reference && isNumber(errorOf(kind, point)) && point.cpu_s > 0;
/** Errors as small as rounding, or as half the reference's own noise, stand at that size. */
const error = (kind, point) => Math.max(errorOf(kind, point), kind.rounding);

/** Of paths the noise of the reference takes the place of rounding; the study's own score has a chart too. */
function kindsOf(data) {
  if (!hasNoisyReference(data)) return kKinds;
  const noise = (name) => data.reference.scores?.[name]?.standard_error ?? 0;
  const own = { frame_rmse: data.reference.own_frame_rmse ?? 0, h_error_points: 100 * noise('homogeneity.h_rms'), contrast_error_percent: 0 };
  const kinds = kKinds.map((kind) => ({ ...kind, axis: kind.name === 'frame_rmse' ? 'RMSE of grey values, full scale 1' : kind.axis, limit: kind.name === 'h_error_points' ? 0.5 : kind.name === 'frame_rmse' ? 0.01 : 5, own: own[kind.name], rounding: Math.max(kind.rounding, 0.5 * own[kind.name]) }));
  const score = data.ranking?.score ?? data.objective;
  if (score && score !== 'homogeneity.h_rms' && data.reference.scores?.[score]) kinds.push({ name: 'score', score, title: `Error of ${score}`, axis: 'its own unit', own: noise(score), rounding: Math.max(1e-9, 0.5 * noise(score)) });
  return kinds;
}

const place = (kind) => (point) => [1e3 * point.cpu_s, error(kind, point)];

function familySeries(family, kind) {
  const points = family.points.filter(drawable(kind)).sort((a, b) => (a.is_noisy && b.is_noisy ? a.cpu_s - b.cpu_s : 0));
  return { name: family.name, type: 'line', symbol: family.symbol, symbolSize: family.size, color: family.colour,
    labelLayout: { hideOverlap: true },
    itemStyle: { color: family.isHalf ? '#fff' : family.colour, borderColor: family.colour, borderWidth: 1.6, opacity: 1 },
    lineStyle: { color: family.colour, width: family.isSingle ? 0 : 1.2, opacity: 0.45, type: family.isHalf ? 'dashed' : 'solid' },
    data: points.map((point) => ({ value: place(kind)(point), point, label: { show: true, formatter: mark(point, family), position: family.label, ...kHalo, color: family.colour } })) };
}

/** The front as steps: between two of its points the cheaper one is the best to be had. */
function frontSeries(data, kind) {
  const points = data.points.filter((point) => point.on_front?.includes(kind.name)).filter(drawable(kind)).sort((a, b) => a.cpu_s - b.cpu_s);
  return { name: 'Pareto front', type: 'line', step: 'end', symbol: 'none', silent: true, color: kInk, itemStyle: { opacity: 0 }, lineStyle: { color: kInk, width: 1.4, type: 'dashed', opacity: 0.7 },
    data: points.map(place(kind)),
    markLine: { silent: true, precision: 9, symbol: 'none', lineStyle: { color: '#9aa4ad', type: 'dotted', width: 1 },
      label: { position: 'insideEndTop', color: '#55606a', fontSize: 11, formatter: '{b}', textBorderColor: '#fff', textBorderWidth: 3 }, data: marks(data, kind) } };
}

function marks(data, kind) {
  const lines = kind.limit ? [{ name: `asked for: ${number(kind.limit)}`, yAxis: kind.limit }] : [];
  const own = kind.own ?? (kind.name === 'frame_rmse' ? data.reference?.own_frame_rmse : 0);
  if (own > 0) lines.push({ name: 'the reference\u2019s own error, about', yAxis: own });
  const reference = data.points.find((point) => point.is_reference);
  if (reference?.cpu_s > 0) lines.push({ name: `reference: ${reference.rays_per_px} rays`, xAxis: 1e3 * reference.cpu_s, label: { position: 'insideEndTop' } });
  return lines;
}

function choiceSeries(data, kind) {
  const points = data.points.filter((point) => point.is_choice).filter(drawable(kind));
  return { name: 'the program\u2019s own choice', type: 'scatter', symbol: 'circle', symbolSize: 24, z: 5, color: kInk, itemStyle: { color: 'transparent', borderColor: kInk, borderWidth: 2 },
    data: points.map((point) => ({ value: place(kind)(point), point })) };
}

function currentSeries(data, kind) {
  const points = data.points.filter((point) => point.is_current).filter(drawable(kind));
  return { name: 'the scene\u2019s own setting', type: 'scatter', symbol: 'circle', symbolSize: 28, z: 6, color: kCurrentColour, itemStyle: { color: 'transparent', borderColor: kCurrentColour, borderWidth: 2 },
    data: points.map((point) => ({ value: place(kind)(point), point })) };
}

/** Both ends of an axis at 1, 2 or 5 times a power of ten, so that no point lies on the frame. */
function ends(values) {
  const steps = [1, 2, 5];
  const power = (value) => 10 ** Math.floor(Math.log10(value));
  const below = (value) => power(value) * steps.filter((step) => step * power(value) <= value * 1.0001).pop();
  const above = (value) => power(value) * (steps.find((step) => step * power(value) >= value) ?? 10);
  return { min: below(0.8 * Math.min(...values)), max: above(1.25 * Math.max(...values)) };
}

function frontierChart(data, kind) {
  const groups = families(data).filter((family) => family.points.some(drawable(kind)));
  const shown = data.points.filter(drawable(kind));
  if (!shown.length) return null;
  const lines = marks(data, kind);
  const x = ends([...shown.map((point) => 1e3 * point.cpu_s), ...lines.map((line) => line.xAxis).filter(isNumber)]);
  const y = ends([...shown.map((point) => error(kind, point)), ...lines.map((line) => line.yAxis).filter(isNumber)]);
  const label = { color: '#55606a', formatter: (value) => number(value) };
  const option = () => ({
    grid: { left: 62, right: 28, top: 84, bottom: 46 },
    legend: { top: 0, left: 56, right: 16, itemWidth: 18, itemGap: 16, textStyle: kText },
    tooltip: { trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter: (item) => (item.data?.point ? pointText(item.data.point) : item.name || item.seriesName) },
    xAxis: { type: 'log', name: hasNoisyReference(data) ? 'CPU time of one more picture and its scores, all threads (ms)' : 'CPU time of one more candidate, one thread (ms)', nameLocation: 'middle', nameGap: 28, ...x, ...axisStyle, axisLabel: label },
    yAxis: { type: 'log', name: kind.axis, ...y, ...axisStyle, nameTextStyle: { color: kInk, align: 'left' }, axisLabel: label },
    series: [...groups.map((family) => familySeries(family, kind)), frontSeries(data, kind), choiceSeries(data, kind), currentSeries(data, kind)].filter((series) => series.data.length || series.markLine),
  });
  return h('div', {}, h('h3', {}, kind.title), chart(470, `${kind.title} against CPU time`, shown.length, option));
}

function row(point) {
  const cell = (value, factor = 1) => h('td', { class: 'number' }, isNumber(value) ? number(factor * value, 3) : '\u2013');
  const worst = (name) => { const all = Object.values(point.defects ?? {}).map((one) => one[name]); return all.length ? Math.max(...all) : null; };
  const name = h('td', {}, point.label.replace(' um', ' \u00b5m'), ' ', point.is_choice && badge('winner', 'own choice'), point.is_current && badge('winner', 'scene\u2019s setting'), point.is_reference && badge('neutral', 'reference'), !point.is_choice && point.on_front?.length > 0 && badge('good', 'front'));
  if (point.problem) return h('tr', { class: 'failed' }, name, h('td', { colspan: '7' }, point.problem));
  return h('tr', {}, name, cell(point.cpu_s, 1e3), cell(point.cold_s),
    cell(point.frame_rmse), cell(point.smooth_frame_rmse), cell(point.h_error_points), cell(worst('weber_error_percent')), cell(worst('change_error_percent')));
}

const kHeadings = ['method', 'one more (ms)', 'first (s)', 'frame error', 'away from edges', 'h (points)', 'contrast (%)', 'change (%)'];

export function frontierSection(facts) {
  const data = facts.data.frontier;
  if (!data?.points?.length) return null;
  const reduced = data.pixel_factor > 1 ? ` Pictures are reduced to ${data.width_px} x ${data.height_px} px, 1/${data.pixel_factor} of the scene\u2019s along both sides.` : '';
  const numbers = hasNoisyReference(data) ? 'samples a pixel, or the most reflections' : 'rays a pixel or the allowed error of a ray\u2019s direction';
  return section('frontier', 'Error against CPU time', `Left is faster, down is more exact. Filled marks are full resolution, open marks less of it; numbers beside them are ${numbers}. Hover for cold costs and single defects.${reduced}`,
    kindsOf(data).map((kind) => frontierChart(data, kind)));
}

/** Every score along the ladder of samples. */
export function frontierScoreSection(facts) {
  const data = facts.data.frontier;
  const scores = data?.reference?.scores;
  if (!scores) return null;
  const ladder = data.points.filter((point) => point.scores && point.resolution === 'full' && point.realisation === 'own' && !hasOtherReflections(data, point) && point.tessellation === data.points[0].tessellation);
  const cell = (value) => h('td', { class: 'number' }, isNumber(value) ? number(value, 2) : '\u2013');
  const head = ['score', 'reference', 'its noise', ...ladder.map((point) => `${point.samples} samples${point.is_current ? ' (now)' : ''}`)];
  return section('score_errors', 'Error of every score', 'In the score\u2019s own unit: root of the mean square distance of one picture\u2019s score from the reference, less the reference\u2019s own noise. 0: not told apart from it.', h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, head.map((text, i) => h('th', { class: i > 0 ? 'number' : '' }, text)))),
    h('tbody', {}, Object.entries(scores).map(([name, score]) => h('tr', {}, h('td', {}, name), h('td', { class: 'number' }, number(score.value)), cell(score.standard_error), ladder.map((point) => cell(point.scores[name]?.error))))))));
}

/** Whether methods put designs into the right order. */
export function frontierRankingSection(facts) {
  const ranking = facts.data.frontier?.ranking;
  if (!ranking) return null;
  const cell = (text) => h('td', { class: 'number' }, text);
  const heads = ['method', 'a design (ms)', 'Kendall\u2019s tau', 'pairs', 'its winner behind', ''];
  const rowOf = (one) => h('tr', {}, h('td', {}, one.label.replace(' um', ' \u00b5m')), cell(number(1e3 * one.cpu_s, 3)), cell(number(one.tau, 3)), cell(String(one.pairs)), cell(`${number(one.winner_behind, 3)} \u00b1 ${number(one.winner_behind_standard_error, 2)}`),
    h('td', {}, one.is_right ? badge('good', 'right order') : badge('neutral', 'not shown'), one.score && one.score !== ranking.score && ` by ${one.score}`));
  return section('ranking', 'Order of designs', `${ranking.designs} designs spread over the variables, ordered by ${ranking.score}, against ${ranking.reference}. Pairs that the reference cannot tell apart (standard error ${number(ranking.standard_error, 2)}) do not count; right is tau of at least 0.9 and a winner within two standard errors of the best.`, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, heads.map((text, i) => h('th', { class: i > 0 ? 'number' : '' }, text)))), h('tbody', {}, ranking.methods.map(rowOf)))));
}

export function frontierTableSection(facts) {
  const data = facts.data.frontier;
  if (!data?.points?.length) return null;
  return section('measured', 'All methods', hasNoisyReference(data) ? 'CPU time of one more picture with its scores, all threads, and of the first one with the part; errors of frames (also in the region of interest alone), of h_rms, and of the worst defect in the mean image (contrast) and in its best frame (change).' : 'Time of one more candidate on one thread and of the first one; errors of frames (also without edges of light and part and without defects), of h_rms, and of the worst defect in the mean image (contrast) and in its best frame (change).', h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, kHeadings.map((text, i) => h('th', { class: i > 0 ? 'number' : '' }, text)))), h('tbody', {}, data.points.map(row)))));
}
