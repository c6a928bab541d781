// SPDX-License-Identifier: GPL-3.0-or-later
// Sections of populations: charts, and tables as the program made them; see studies/report/report.h.
import { curvesChart } from './curves.js';
import { h, section } from './dom.js';
import { lightingsChart, podChart, sizesChart } from './population.js';

const kNumber = /^(> )?[-\u2013]?[0-9.]+( |$)/;
const kCharts = { curves: curvesChart, lightings: lightingsChart, pod: podChart, sizes: sizesChart };

function table(data) {
  if (!data.rows?.length) return data.caption ? h('p', { class: 'muted' }, data.caption) : null;
  const isNumeric = data.head.map((_, i) => i > 0 && data.rows.every((row) => kNumber.test(row[i]) || row[i] === '-'));
  const cell = (tag) => (text, i) => h(tag, { class: isNumeric[i] ? 'number' : '' }, text);
  return h('div', {}, data.caption && h('p', {}, data.caption), h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
    h('thead', {}, h('tr', {}, data.head.map(cell('th')))), h('tbody', {}, data.rows.map((row) => h('tr', {}, row.map(cell('td'))))))));
}

export function panelSections(facts) {
  return (facts.data.panels ?? []).map((panel) => section(panel.id, panel.title, panel.lead,
    h('div', { class: 'pair' }, (panel.charts ?? []).map((data) => kCharts[data.kind](data))), (panel.tables ?? []).map(table)));
}
