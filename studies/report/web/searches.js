// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluations of a search against its winner's quality; the data is the object of search.json.
import { axisStyle, chart, encode, kInk, kText } from './charts.js';
import { h, section } from './dom.js';
import { isNumber, number } from './format.js';

const kColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#b58900'];

const isShown = (step) => isNumber(step.top) && step.is_feasible;

function seriesOf(data, method, i) {
  const color = kColours[i % kColours.length];
  const thin = method.runs.map((run) => ({ name: method.method, type: 'line', symbol: 'none', color, lineStyle: { width: 1, opacity: 0.3 }, silent: true, data: run.steps.filter(isShown).map((step) => [step.evaluations, step.top]) }));
  const median = { name: method.method, type: 'line', symbol: 'circle', symbolSize: 8, color, lineStyle: { width: 3 }, z: 5,
    data: method.summary.filter((one) => isNumber(one.median)).map((one) => ({ value: [one.evaluations, one.median],
      words: [`${method.method}, ${one.evaluations} evaluations`, `median ${number(one.median, 5)}`, `${number(one.low, 5)} to ${number(one.high, 5)}`, `${one.feasible} of ${one.runs} winners feasible`].map(encode).join('<br>') })) };
  return [...thin, median].filter((series) => series.data.length);
}

export function searchesSection(facts) {
  const data = facts.data.searches;
  if (!data?.methods?.length) return null;
  const series = data.methods.flatMap((method, i) => seriesOf(data, method, i));
  const values = data.methods.flatMap((method) => method.runs.flatMap((run) => run.steps.filter(isShown).map((step) => step.top)));
  const range = Math.max(...values) - Math.min(...values) || 1e-3;
  const digits = Math.max(0, Math.ceil(-Math.log10(range)) + 2);
  const round = (value) => Number(value.toFixed(digits));
  const option = () => ({
    grid: { left: 72, right: 28, top: 62, bottom: 46 },
    legend: { top: 0, left: 56, right: 16, itemWidth: 18, textStyle: kText },
    tooltip: { trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter: (item) => item.data?.words ?? encode(item.seriesName) },
    xAxis: { type: 'log', name: 'evaluations', nameLocation: 'middle', nameGap: 28, min: 1, max: Math.max(2, data.evaluations), ...axisStyle, axisLabel: { color: '#55606a', formatter: (value) => number(value) } },
    yAxis: { type: 'value', name: `${data.score} of the winner, scored again`, min: round(Math.min(...values) - 0.05 * range), max: round(Math.max(...values) + 0.05 * range), ...axisStyle, nameTextStyle: { color: kInk, align: 'left' } },
    series,
  });
  const better = data.direction === 'maximise' ? 'Up is better' : 'Down is better';
  return section('searches', 'Evaluations against the winner\u2019s quality', `${better}, left is faster. Thin lines are single searches, thick ones their median.`,
    values.length > 0 ? chart(430, 'Winner\u2019s quality against evaluations', values.length, option) : h('p', { class: 'muted' }, 'No search has a feasible winner yet.'));
}

export function searchesTableSection(facts) {
  const data = facts.data.searches;
  if (!data?.methods?.length) return null;
  const cell = (text) => h('td', { class: 'number' }, text);
  const value = (one) => (isNumber(one) ? number(one, 5) : '\u2013');
  const rows = data.methods.flatMap((method) => [...method.summary.map((one) => h('tr', {}, h('td', {}, method.method), cell(String(one.evaluations)), cell(value(one.median)), cell(value(one.low)), cell(value(one.high)), cell(`${one.feasible} of ${one.runs}`))),
    ...(method.problem ? [h('tr', { class: 'failed' }, h('td', {}, method.method), h('td', { colspan: '5' }, method.problem))] : [])]);
  const heads = ['algorithm', 'evaluations', 'median', 'smallest', 'largest', 'feasible'];
  return section('searched', 'All searches', `${data.score} of the best design so far, scored again with finer sampling and fresh random numbers; over the seeds whose winner then keeps all limits.`, h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, heads.map((text, i) => h('th', { class: i > 0 ? 'number' : '' }, text)))), h('tbody', {}, rows))));
}
