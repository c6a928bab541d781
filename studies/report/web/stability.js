// SPDX-License-Identifier: GPL-3.0-or-later
// Where methods fail: every cell of every sweep with its verdict; the data is the object of stability.json.
import { axisStyle, chart, encode, kInk } from './charts.js';
import { h, section } from './dom.js';
import { isNumber, number } from './format.js';

const kVerdicts = {
  right: { colour: '#c9e7db', symbol: 'circle', ink: '#009e73' },
  told: { colour: '#fbe3a6', symbol: 'diamond', ink: '#b58900' },
  refused: { colour: '#d9dee3', symbol: 'triangle', ink: '#7a858e' },
  'silently wrong': { colour: '#f2a68b', symbol: 'rect', ink: '#b8321a' },
};

const kUnits = { h_points: 'points of h', contrast_percent: '% of contrast', picture: 'of full scale', mean: 'of full scale, mean' };
const kMinRatio = 1e-4;

/** How far the worst quantity is off, in bounds. */
const ratio = (cell) => cell.error / cell.bound;

function cellWords(cell) {
  const lines = [`${cell.verdict}, ${cell.method}`];
  for (const [name, one] of Object.entries(cell.errors)) lines.push(`${number(one.error, 3)} ${kUnits[name]} (allowed ${number(one.bound)}): ${number(one.measured, 5)}, reference ${number(one.reference, 5)}`);
  if (cell.message) lines.push(cell.message);
  return lines;
}

function cellNode(cell) {
  const worst = isNumber(cell.error) ? `${number(cell.error, 2)} ${kUnits[cell.quantity]}` : cell.verdict === 'refused' ? 'refused' : 'compared with the next';
  return h('td', { title: cellWords(cell).join('\n'), style: `background: ${kVerdicts[cell.verdict].colour}; min-width: 4.6em; max-width: 7em; padding: 3px 5px; vertical-align: top; line-height: 1.25` },
    h('b', {}, number(cell.value)), h('br'), h('small', {}, worst));
}

function sweepRow(sweep, columns) {
  const empty = Math.max(0, columns - sweep.cells.length);
  return h('tr', {}, h('th', { style: 'text-align: left; font-weight: 500; min-width: 12em; max-width: 16em' }, h('b', {}, sweep.name), h('br'), h('small', {}, sweep.title)),
    sweep.cells.map(cellNode), empty > 0 && h('td', { colspan: String(empty) }));
}

function legend(data) {
  const counts = { right: data.totals.right, told: data.totals.told, refused: data.totals.refused, 'silently wrong': data.totals.silently_wrong };
  return h('p', {}, Object.entries(counts).map(([name, count]) => h('span', { style: `background: ${kVerdicts[name].colour}; padding: 2px 8px; margin-right: 8px` }, `${count} ${name}`)));
}

function sweepChart(sweep) {
  const points = sweep.cells.map((cell, i) => ({ cell, i })).filter(({ cell }) => isNumber(cell.error));
  if (!points.length) return null;
  const option = () => ({
    grid: { left: 58, right: 16, top: 26, bottom: 42 },
    tooltip: { trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk }, formatter: (item) => cellWords(item.data.cell).map(encode).join('<br>') },
    xAxis: { type: 'category', data: sweep.cells.map((cell) => number(cell.value)), name: sweep.swept, nameLocation: 'middle', nameGap: 26, nameTruncate: { maxWidth: 220 }, ...axisStyle },
    yAxis: { type: 'log', name: 'error / bound', min: kMinRatio, ...axisStyle, nameTextStyle: { color: kInk, align: 'left' }, axisLabel: { color: '#55606a', formatter: (value) => number(value) } },
    series: [{ type: 'line', color: kInk, symbolSize: 10, showAllSymbol: true, lineStyle: { width: 1, opacity: 0.4 },
      data: points.map(({ cell, i }) => ({ value: [i, Math.max(kMinRatio, ratio(cell))], cell, symbol: kVerdicts[cell.verdict].symbol, itemStyle: { color: kVerdicts[cell.verdict].ink } })),
      markLine: { silent: true, symbol: 'none', label: { show: false }, lineStyle: { color: '#b8321a', type: 'dotted' }, data: [{ yAxis: 1 }] } }],
  });
  return h('div', {}, h('h3', {}, sweep.name), chart(230, `Error of ${sweep.name}`, points.length, option));
}

function remarks(data) {
  const rows = data.sweeps.flatMap((sweep) => sweep.cells.filter((cell) => cell.message).map((cell) => h('tr', {}, h('td', {}, sweep.name), h('td', { class: 'number' }, number(cell.value)), h('td', {}, cell.verdict), h('td', {}, cell.message))));
  return rows.length ? h('div', { class: 'scroll' }, h('table', { class: 'evaluations' }, h('thead', {}, h('tr', {}, ['sweep', 'value', 'verdict', 'what the program says'].map((text) => h('th', {}, text)))), h('tbody', {}, rows))) : null;
}

export function stabilitySection(facts) {
  const data = facts.data.stability;
  if (!data?.sweeps?.length) return null;
  const columns = Math.max(...data.sweeps.map((sweep) => sweep.cells.length));
  return section('stability', 'Sweeps', 'One row a sweep, from harmless to hopeless. Each cell has the value of the key or ratio and the error that is largest against its bound; hover for all figures.',
    legend(data), h('div', { class: 'scroll' }, h('table', { style: 'border-spacing: 3px; border-collapse: separate' }, h('tbody', {}, data.sweeps.map((sweep) => sweepRow(sweep, columns))))));
}

export function stabilityChartSection(facts) {
  const data = facts.data.stability;
  if (!data?.sweeps?.length) return null;
  return section('errors', 'Errors', 'The largest error of each cell in units of its bound; above the dotted line it is beyond. Refused cells have none.', h('div', { class: 'slices' }, data.sweeps.map(sweepChart)));
}

export function stabilityRemarkSection(facts) {
  const data = facts.data.stability;
  const table = data?.sweeps?.length ? remarks(data) : null;
  return table && section('remarks', 'Refusals and warnings', 'What the program says in cells that it refuses or that are beyond a bound.', table);
}
