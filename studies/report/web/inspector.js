// SPDX-License-Identifier: GPL-3.0-or-later
// Defects found against false reports, by filters of the inspection; the data is the object of inspector.json.
import { axisStyle, chart, encode, kInk, kText } from './charts.js';
import { badge, h, section } from './dom.js';
import { isNumber, number } from './format.js';

const kColours = { gaussian: '#0072b2', difference: '#009e73', matched: '#d55e00', structure: '#cc79a7', phase: '#56b4e9' };
const kSymbols = ['circle', 'rect', 'triangle', 'diamond', 'pin', 'arrow'];
const kKinds = [['gaussian', 'gaussian'], ['difference', 'difference of gaussians'], ['matched', 'matched'], ['structure', 'structure'], ['phase', 'phase']];

const kindOf = (point) => point.label.split(' ')[0];
const percent = (share) => `${number(100 * share, 3)} %`;

/** Where false reports are drawn that did not occur at all: at half a report over all flawless pictures. */
const least = (data) => 0.5 / data.flawless;
const place = (data, one) => [Math.max(least(data), one.false_reports.value), 100 * one.detected.value];

function words(point, one) {
  return [point.label, `threshold ${number(one.threshold, 3)} of full scale${one.sigmas ? `, ${number(one.sigmas, 3)} sigmas` : ''}`,
    `${percent(one.detected.value)} found (${percent(one.detected.low)} to ${percent(one.detected.high)})`,
    `${number(one.false_reports.value, 3)} false reports a picture (${number(one.false_reports.low, 2)} to ${number(one.false_reports.high, 2)})`].map(encode).join('<br>');
}

const tooltip = { trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter: (item) => item.data?.words ?? encode(item.name || item.seriesName) };
const legend = { top: 0, left: 56, right: 16, itemWidth: 18, itemGap: 14, textStyle: kText };

function ring(data, points) {
  return { name: 'the scene\u2019s own threshold', type: 'scatter', symbol: 'circle', symbolSize: 24, z: 6, color: '#c23b22', itemStyle: { color: 'transparent', borderColor: '#c23b22', borderWidth: 2 },
    data: points.filter((point) => point.own).map((point) => ({ value: place(data, point.own), words: words(point, point.own) })) };
}

/** One small chart a kind of filter, as curves of all kinds would cover each other. */
function curveChart(data, measured, [kind, title]) {
  const points = measured.filter((point) => kindOf(point) === kind && point.curve.length);
  if (!points.length) return null;
  const xMax = Math.max(...measured.flatMap((point) => point.curve.map((one) => one.false_reports.value)), 1);
  const option = () => ({
    grid: { left: 62, right: 28, top: 62, bottom: 46 }, legend, tooltip,
    xAxis: { type: 'log', name: 'false reports on a flawless picture', nameLocation: 'middle', nameGap: 28, min: 10 ** Math.floor(Math.log10(least(data))), max: 10 ** Math.ceil(Math.log10(xMax)), ...axisStyle, axisLabel: { color: '#55606a', formatter: (value) => number(value) } },
    yAxis: { type: 'value', name: 'defects found (%)', min: 0, max: 100, ...axisStyle, nameTextStyle: { color: kInk, align: 'left' } },
    series: [...points.map((point, i) => ({ name: point.label.replace('difference of gaussians, ', ''), type: 'line', symbol: kSymbols[i % kSymbols.length], symbolSize: 7, color: kColours[kind], lineStyle: { width: point.is_current ? 3 : 1.5, opacity: 1 - 0.14 * i }, itemStyle: { opacity: 1 - 0.14 * i },
      data: [...point.curve].reverse().map((one) => ({ value: place(data, one), words: words(point, one) })),
      markLine: i === 0 ? { silent: true, symbol: 'none', lineStyle: { color: '#7a858e', type: 'dashed' }, label: { formatter: 'allowed', position: 'insideEndTop' }, data: [{ xAxis: Math.max(least(data), data.allowed_false_reports) }] } : undefined })),
    ring(data, points)].filter((series) => series.data.length),
  });
  return h('div', {}, h('h3', {}, title), chart(330, `Defects found by ${title}`, points.length, option));
}

function costChart(data, measured) {
  const points = measured.filter((point) => point.best && isNumber(point.cpu_s));
  if (!points.length) return null;
  const at = (point) => ({ value: [1e3 * point.cpu_s, 100 * point.best.detected.value], words: `${words(point, point.best)}<br>${number(1e3 * point.cpu_s, 3)} ms a picture` });
  const times = points.map((point) => 1e3 * point.cpu_s);
  const front = points.filter((point) => point.on_front).sort((a, b) => a.cpu_s - b.cpu_s);
  const option = () => ({
    grid: { left: 62, right: 40, top: 62, bottom: 46 }, legend, tooltip,
    xAxis: { type: 'log', name: 'CPU time of the inspection of one picture, one thread (ms)', nameLocation: 'middle', nameGap: 28, min: 0.8 * Math.min(...times), max: 1.6 * Math.max(...times), ...axisStyle, axisLabel: { color: '#55606a', showMinLabel: false, showMaxLabel: false, formatter: (value) => number(value) } },
    yAxis: { type: 'value', name: `defects found (%) at no more than ${data.allowed_false_reports} false reports`, min: 0, max: 100, ...axisStyle, nameTextStyle: { color: kInk, align: 'left' } },
    series: [...kKinds.map(([kind, title]) => ({ name: title, type: 'scatter', symbolSize: 12, color: kColours[kind], label: { show: true, position: 'right', color: kInk, fontSize: 11, formatter: (item) => item.data.mark }, labelLayout: { hideOverlap: true },
      data: points.filter((point) => kindOf(point) === kind).map((point) => ({ ...at(point), mark: point.label.replace(/^\D*/, '') })) })).filter((series) => series.data.length),
    { name: 'front', type: 'line', step: 'end', symbol: 'none', color: '#7a858e', lineStyle: { type: 'dashed', width: 1.5 }, data: front.map(at) },
    { name: 'the scene\u2019s own filter', type: 'scatter', symbol: 'circle', symbolSize: 26, z: 6, color: '#c23b22', itemStyle: { color: 'transparent', borderColor: '#c23b22', borderWidth: 2 }, data: points.filter((point) => point.is_current).map(at) }].filter((series) => series.data.length),
  });
  return h('div', {}, h('h3', {}, 'Found against time'), chart(360, 'Defects found against CPU time', points.length, option));
}

function row(point) {
  const cell = (value, text = (one) => number(one, 3)) => h('td', { class: 'number' }, isNumber(value) ? text(value) : '\u2013');
  const name = h('td', {}, point.label, ' ', point.is_current && badge('winner', 'scene\u2019s filter'), point.on_front && badge('good', 'front'));
  if (point.problem) return h('tr', { class: 'failed' }, name, h('td', { colspan: '6' }, point.problem));
  return h('tr', {}, name, cell(isNumber(point.cpu_s) ? 1e3 * point.cpu_s : null), cell(point.region_share, percent), cell(point.best?.detected.value, percent), cell(point.best?.false_reports.value), cell(point.best?.sigmas), cell(point.own?.detected.value, percent));
}

export function inspectorSection(facts) {
  const data = facts.data.inspector;
  if (!data?.points?.length) return null;
  const measured = data.points.filter((point) => !point.problem);
  return section('inspector', 'Defects found against false reports', `${data.parts} parts with defects and ${data.flawless} flawless ones; a curve is one filter at thresholds from 3 to 85 sigmas. Up is better, left is quieter. No false report at all is drawn at ${number(least(data), 2)}.`,
    costChart(data, measured), kKinds.map((kind) => curveChart(data, measured, kind)));
}

export function inspectorTableSection(facts) {
  const data = facts.data.inspector;
  if (!data?.points?.length) return null;
  const heads = ['filter', 'a picture (ms)', 'looked at', 'found', 'false reports', 'at sigmas', 'found at own threshold'];
  return section('filters', 'All filters', `Found: the most defects at no more than ${data.allowed_false_reports} false reports a picture (inspection.false_alarms_per_picture). Looked at: the share of the part that is even enough under this light.`, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, heads.map((text, i) => h('th', { class: i > 0 ? 'number' : '' }, text)))), h('tbody', {}, data.points.map(row)))));
}
