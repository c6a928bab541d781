// SPDX-License-Identifier: GPL-3.0-or-later
// What the scores of a run owe to each variable, and how they answer; the data is that of studies/analysis/run_analysis.h.
import { axisStyle, chart, encode, kInk, kText, objectiveSelector, shade } from './charts.js';
import { h, section } from './dom.js';
import { number, plural } from './format.js';

const kBlue = '#0072b2';
const kOrange = '#d55e00';
const share = (value) => `${Math.round(100 * value)}\u00a0%`;

/** A score as it is read on an axis. */
const scoreLabel = (facts, name) => (value) => (facts.info(name).format === 'percent' ? `${Number((100 * value).toFixed(1))} %` : number(value, 3));

/** Names as elsewhere in the report, of variables that it knows. */
function shortName(facts, variable) {
  const i = facts.variables.findIndex((one) => one.name === variable);
  return i < 0 ? variable : facts.names[i];
}

const tip = (formatter) => ({ trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter });

/** A line between the ends of an interval, at a row of the chart. */
function intervalSeries(name, colour, rows, shift) {
  return { name, type: 'custom', silent: true, data: rows, color: colour, encode: { x: [0, 1], y: 2 },
    renderItem: (_, api) => {
      const [from, y] = api.coord([api.value(0), api.value(2)]);
      const [to] = api.coord([api.value(1), api.value(2)]);
      return { type: 'line', shape: { x1: from, x2: to, y1: y + shift, y2: y + shift }, style: { stroke: colour, lineWidth: 2, opacity: 0.6 } };
    } };
}

function importanceChart(facts, score, branch) {
  const rows = [...branch.importance].sort((a, b) => a.total - b.total);
  const marks = (name, key, colour, symbol, shift) => ({ name, type: 'scatter', symbol, symbolSize: 10, symbolOffset: [0, shift], color: colour, itemStyle: { color: colour },
    data: rows.map((row, i) => ({ value: [row[key], i], row })) });
  const text = ({ row }) => `<b>${encode(row.variable)}</b><br>alone ${share(row.first)} (${share(row.first_low)} to ${share(row.first_high)})<br>in all ${share(row.total)} (${share(row.total_low)} to ${share(row.total_high)})`;
  const option = () => ({
    grid: { left: 12, right: 24, top: 34, bottom: 42, containLabel: true },
    legend: { top: 0, left: 12, itemWidth: 14, itemGap: 16, textStyle: kText, data: ['with all its interactions', 'alone'] },
    tooltip: tip((item) => (item.data?.row ? text(item.data) : '')),
    xAxis: { type: 'value', min: 0, max: 1, name: 'share of the variance', nameLocation: 'middle', nameGap: 26, ...axisStyle, axisLabel: { color: '#55606a', formatter: (value) => share(value) } },
    yAxis: { type: 'category', data: rows.map((row) => shortName(facts, row.variable)), ...axisStyle },
    series: [intervalSeries('interval in all', kBlue, rows.map((row, i) => [row.total_low, row.total_high, i]), -5),
      intervalSeries('interval alone', kOrange, rows.map((row, i) => [row.first_low, row.first_high, i]), 5),
      marks('with all its interactions', 'total', kBlue, 'circle', -5), marks('alone', 'first', kOrange, 'diamond', 5)],
  });
  return chart(90 + 40 * rows.length, `What ${facts.label(score)} owes to each variable`, 0, option);
}

/** The area between two curves over the same places. */
function bandSeries(at, low, high) {
  return { name: 'band', type: 'custom', silent: true, clip: true, data: [[at[0], low[0]]],
    renderItem: (_, api) => ({ type: 'polygon', shape: { points: [...at.map((x, i) => api.coord([x, high[i]])), ...at.map((x, i) => api.coord([x, low[i]])).reverse()] },
      style: { fill: kBlue, opacity: 0.18 } }) };
}

function responseChart(facts, score, response, [low, high]) {
  const label = scoreLabel(facts, score);
  const name = shortName(facts, response.variable);
  const variable = facts.variables.find((one) => one.name === response.variable) ?? {};
  const isText = typeof response.at[0] !== 'number';
  const at = isText ? response.at.map((_, i) => i) : response.at;
  const x = isText ? { type: 'category', data: response.at } : { type: variable.log ? 'log' : 'value', min: at[0], max: at[at.length - 1], splitNumber: 4 };
  const line = (key, title, style) => ({ name: title, type: 'line', symbol: isText ? 'circle' : 'none', color: style.color, lineStyle: style, data: response[key].map((value, i) => [at[i], value]) });
  const option = () => ({
    grid: { left: 56, right: 16, top: 14, bottom: 42 },
    tooltip: { trigger: 'axis', confine: true, textStyle: { fontSize: 12, color: kInk }, valueFormatter: label },
    xAxis: { ...x, name, nameLocation: 'middle', nameGap: 26, ...axisStyle, splitLine: { show: false }, axisLabel: { color: '#55606a', hideOverlap: true, formatter: (value) => (isText ? value : number(value)) } },
    yAxis: { type: 'value', min: low, max: high, splitNumber: 3, ...axisStyle, axisLabel: { color: '#55606a', formatter: label, showMinLabel: false, showMaxLabel: false } },
    series: [bandSeries(at, response.average_low, response.average_high), line('average', 'average', { color: kBlue, width: 2 }),
      ...(response.best.length ? [line('best', 'through the best', { color: kOrange, width: 1.6, type: 'dashed' })] : [])],
  });
  return chart(210, `${facts.label(score)} over ${name}`, 0, option);
}

function mapChart(facts, score, map) {
  const label = scoreLabel(facts, score);
  const low = Math.min(...map.mean);
  const high = Math.max(...map.mean);
  const columns = map.at_x.length;
  const cells = map.mean.map((mean, i) => [i % columns, Math.floor(i / columns), mean, map.mean_low[i], map.mean_high[i]]);
  const written = (value) => (typeof value === 'number' ? number(value, 3) : value);
  const text = ([x, y, mean, from, to]) => `${encode(shortName(facts, map.x))} ${written(map.at_x[x])}, ${encode(shortName(facts, map.y))} ${written(map.at_y[y])}<br><b>${label(mean)}</b> (${label(from)} to ${label(to)})`;
  const axis = (name, values, gap) => ({ type: 'category', data: values.map(written), name, nameLocation: 'middle', nameGap: gap, ...axisStyle, splitLine: { show: false }, axisLabel: { color: '#55606a', hideOverlap: true } });
  const option = () => ({
    grid: { left: 76, right: 20, top: 12, bottom: 46 },
    tooltip: tip((item) => text(item.value)),
    xAxis: axis(shortName(facts, map.x), map.at_x, 28), yAxis: axis(shortName(facts, map.y), map.at_y, 54),
    series: [{ type: 'custom', data: cells, renderItem: (_, api) => {
      const [x, y] = api.coord([api.value(0), api.value(1)]);
      const [width, height] = api.size([1, 1]);
      return { type: 'rect', shape: { x: x - width / 2, y: y - height / 2, width: width + 0.5, height: height + 0.5 }, style: { fill: shade(high > low ? (api.value(2) - low) / (high - low) : 0.5) } };
    } }],
  });
  return h('div', {}, h('h4', {}, `${shortName(facts, map.x)} and ${shortName(facts, map.y)} together`),
    h('p', { class: 'toolbar' }, h('span', { class: 'ramp' }), h('span', { class: 'muted' }, `${label(low)} to ${label(high)}, average over the others`)), chart(360, `${facts.label(score)} over two variables`, 0, option));
}

/** Both ends of all responses, so that flat ones look flat. */
function range(responses) {
  const all = responses.flatMap((one) => [...one.average_low, ...one.average_high, ...one.best]);
  const margin = 0.04 * (Math.max(...all) - Math.min(...all));
  return [Math.min(...all) - margin, Math.max(...all) + margin];
}

function branchBlock(facts, score, branch) {
  const title = branch.name && h('h4', {}, branch.name);
  if (!branch.is_enough) {
    return h('div', { class: 'lacking' }, title, h('p', {}, h('b', {}, 'Not enough evidence. '), `${branch.reason}.${branch.wanted ? ` Space-filling designs wanted here: ${branch.wanted}.` : ''}`));
  }
  const ends = range(branch.responses);
  return h('div', {}, title, h('p', { class: 'muted' }, `Q2 = ${branch.q2.toFixed(2)} from ${plural(branch.points, 'design')}.`), importanceChart(facts, score, branch),
    h('div', { class: 'slices' }, branch.responses.map((response) => responseChart(facts, score, response, ends))), branch.map && mapChart(facts, score, branch.map));
}

function choiceLine(facts, { choices }) {
  return choices.map((one) => h('p', {}, `The choice of ${shortName(facts, one.variable)} explains ${share(one.first)} (${share(one.first_low)} to ${share(one.first_high)}) of the variance over all kinds.`));
}

function scoreBlock(facts, one) {
  const left = [one.without && `${plural(one.without, 'design')} without it`, one.left_out && `${one.left_out} more than the model takes`].filter(Boolean);
  return h('div', { class: 'analysed' }, h('h3', {}, facts.label(one.score)),
    left.length > 0 && h('p', { class: 'muted' }, `Left out: ${left.join(', ')}.`), choiceLine(facts, one), one.branches.map((branch) => branchBlock(facts, one.score, branch)));
}

export function analysisSection(facts) {
  const data = facts.data.analysis;
  if (!data?.scores?.length) return null;
  return section('analysis', 'What matters',
    `A Gaussian process of ${plural(data.scores[0].points, 'design')}${data.added ? `, ${data.added} of them added for the analysis` : ''}. Shares of the variance over the whole box with 95 % intervals; curves: average over all other variables with its 95 % band, dashed: through the best design. Nothing is drawn where leave-one-out or the spread of the designs does not bear it.`,
    facts.front ? objectiveSelector(facts, data.scores.map(({ score }) => score), (name) => scoreBlock(facts, data.scores.find(({ score }) => score === name))) : data.scores.map((one) => scoreBlock(facts, one)));
}
