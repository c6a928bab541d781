// SPDX-License-Identifier: GPL-3.0-or-later
// The table of evaluations (sorted, filtered, in pages) and the list of failures.
import { badge, h, section } from './dom.js';
import { parseFilter } from './filter.js';
import { isNumber, number, stateOf } from './format.js';

const kPageRows = 25;
const kPrintedRows = 10;

const scoreColumn = (facts, name) => ({ name, heading: facts.label(name), meaning: facts.meaning(name), isNumber: true, isPercent: facts.info(name).format === 'percent' });

/** What the table shows: name, heading, meaning, value for sorting, text. */
function columns(facts) {
  const scored = facts.mainScores().filter((name) => name !== facts.objective.name && facts.trials.some((trial) => isNumber(trial.scores?.[name])));
  return [
    { name: 'number', heading: '#', value: (trial) => trial.number, text: (trial) => String(trial.number) },
    { name: 'state', heading: 'state', value: stateOf, text: stateOf },
    facts.trials.some((trial) => trial.kind) && { name: 'kind', heading: 'origin', value: (trial) => trial.kind ?? '', text: (trial) => trial.kind ?? '' },
    { ...scoreColumn(facts, facts.objective.name || 'objective'), value: (trial) => trial.objective, text: (trial) => facts.score(facts.objective.name, trial.objective) },
    ...scored.map((name) => ({ ...scoreColumn(facts, name), value: (trial) => trial.scores?.[name], text: (trial) => facts.score(name, trial.scores?.[name]) })),
    ...facts.variables.map((variable, i) => ({ name: variable.name, heading: facts.names[i], isNumber: !variable.choices?.length, value: (trial) => trial.values?.[i], text: (trial) => number(trial.values?.[i]) })),
  ].filter(Boolean);
}

const missing = (value) => value === undefined || value === null || (typeof value === 'number' && Number.isNaN(value));

export function order(column, ascending) {
  return (a, b) => {
    const left = column.value(a);
    const right = column.value(b);
    if (missing(left) || missing(right)) return Number(missing(left)) - Number(missing(right));  // gaps last, either way
    const sign = left < right ? -1 : left > right ? 1 : (a.number ?? 0) - (b.number ?? 0);
    return ascending ? sign : -sign;
  };
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

function download(all, trials) {
  const rows = [all.map((column) => column.name), ...trials.map((trial) => all.map((column) => String(column.value(trial) ?? '')))];
  const text = rows.map((row) => row.map(quoted).join(',')).join('\n');
  const link = h('a', { href: URL.createObjectURL(new Blob([text], { type: 'text/csv' })), download: 'evaluations.csv' });
  link.click();
  URL.revokeObjectURL(link.href);
}

class EvaluationTable {
  constructor(facts, selection) {
    this.facts = facts;
    this.selection = selection;
    this.columns = columns(facts);
    this.sorted = this.columns.find((column) => column.name === (facts.objective.name || 'objective'));
    this.ascending = !facts.maximise;
    this.page = 0;
    this.chosen = null;
    this.filter = h('input', { type: 'search', placeholder: 'filter: feasible   h_rms > 80   radius < 120', 'aria-label': 'Filter', oninput: () => this.filtered() });
    this.count = h('span', { class: 'muted' });
    this.problems = h('span', { class: 'fails', role: 'status' });
    this.head = h('tr', {}, this.columns.map((column) => h('th', { title: column.meaning ?? column.name }, h('button', { type: 'button', onclick: () => this.sort(column) }, column.heading))));
    this.body = h('tbody', {});
    this.onPaper = h('p', { class: 'muted paper-only' });
    this.pager = h('p', { class: 'toolbar screen-only' });
    const save = h('button', { type: 'button', class: 'screen-only', onclick: () => download(this.columns, this.rows()) }, 'Save as CSV');
    this.node = section('evaluations', 'Evaluations', null, h('p', { class: 'toolbar' }, h('span', { class: 'grow screen-only' }, this.filter), this.count, this.problems, save),
      h('div', { class: 'scroll' }, h('table', { class: 'evaluations' }, h('thead', {}, this.head), this.body)), this.pager, this.onPaper);
    this.draw();
    selection.listen((_, what, source) => {
      if (what === 'brush' && source !== 'table') this.choose(selection.chosen('table'));
      else if (facts.front && what === 'pick') this.markPicked();
    });
  }

  /** What passes the filter is chosen on the whole page, where its other parts follow. */
  filtered() {
    this.restart();
    if (!this.facts.front) return;
    const { keep, problems } = parseFilter(this.filter.value, this.columns, this.facts.trials);
    const isOn = this.filter.value.trim() !== '' && !problems.length;
    this.selection.brush('table', isOn ? new Set(this.facts.trials.filter(keep).map((trial) => trial.number)) : null);
  }

  rows() {
    const { keep, problems } = parseFilter(this.filter.value, this.columns, this.facts.trials);
    this.problems.textContent = problems.join('; ');
    return this.facts.trials.filter((trial) => (!this.chosen || this.chosen.has(trial.number)) && keep(trial)).sort(order(this.sorted, this.ascending));
  }

  sort(column) {
    this.ascending = this.sorted === column ? !this.ascending : !column.isNumber;
    this.sorted = column;
    this.restart();
  }

  choose(numbers) {
    this.chosen = numbers;
    this.restart();
  }

  rowLook(trial, i) {
    const name = `${stateOf(trial)}${i < kPrintedRows ? '' : ' screen-only'}`;
    if (!this.facts.front || trial.failed) return { class: name };
    return { class: `${name} link`, 'data-trial': trial.number, onclick: () => this.selection.pick(trial.number) };
  }

  markPicked() {
    for (const row of this.body.children) row.classList.toggle('picked', row.getAttribute('data-trial') === String(this.selection.picked));
  }

  restart() {
    this.page = 0;
    this.draw();
  }

  draw() {
    const rows = this.rows();
    const pages = Math.max(1, Math.ceil(rows.length / kPageRows));
    const shown = rows.slice(this.page * kPageRows, (this.page + 1) * kPageRows);
    const cell = (column, trial) => h('td', { class: column.isNumber ? 'number' : '' }, column.name === 'state' ? badge({ feasible: 'good', infeasible: 'neutral', failed: 'bad' }[stateOf(trial)], stateOf(trial)) : column.text(trial));
    this.body.replaceChildren(...shown.map((trial, i) => h('tr', this.rowLook(trial, i), this.columns.map((column) => cell(column, trial)))));
    if (this.facts.front) this.markPicked();
    if (!rows.length) this.body.replaceChildren(h('tr', {}, h('td', { colspan: String(this.columns.length), class: 'muted' }, 'Nothing passes the filter.')));
    this.columns.forEach((column, i) => this.head.children[i].setAttribute('aria-sort', column === this.sorted ? (this.ascending ? 'ascending' : 'descending') : 'none'));
    this.count.textContent = `${rows.length} of ${this.facts.trials.length}${this.chosen ? ', chosen above' : ''}`;
    const go = (step) => () => { this.page += step; this.draw(); };
    this.onPaper.textContent = rows.length > kPrintedRows ? `The first ${Math.min(shown.length, kPrintedRows)} of ${rows.length}; trials.csv in the folder of the run has all.` : '';
    this.pager.replaceChildren(...(pages === 1 ? [] : [h('button', { type: 'button', disabled: this.page === 0, onclick: go(-1) }, 'Previous'),
      h('span', { class: 'muted' }, `page ${this.page + 1} of ${pages}`), h('button', { type: 'button', disabled: this.page === pages - 1, onclick: go(1) }, 'Next')]));
  }
}

export const evaluationSection = (facts, selection) => (facts.trials.length ? new EvaluationTable(facts, selection) : null);

/** Failed evaluations, grouped by their reason. */
export function failureSection(facts) {
  if (!facts.trials.length) return null;
  const groups = new Map();
  for (const trial of facts.trials.filter((one) => one.failed)) {
    const reason = trial.message || 'no reason recorded';
    groups.set(reason, [...(groups.get(reason) ?? []), trial.number]);
  }
  if (!groups.size) return section('failures', 'Failures', 'No evaluation failed.');
  const numbers = (list) => list.slice(0, 12).join(', ') + (list.length > 12 ? ', \u2026' : '');
  const rows = [...groups].sort((a, b) => b[1].length - a[1].length).map(([reason, list]) => h('tr', {}, h('td', { class: 'number' }, list.length), h('td', { class: 'wide' }, reason), h('td', { class: 'muted' }, numbers(list))));
  return section('failures', 'Failures', 'A failed evaluation is recorded with its reason and the search goes on.',
    h('div', { class: 'scroll' }, h('table', { class: 'failures' }, h('thead', {}, h('tr', {}, ['count', 'reason', 'evaluations'].map((text) => h('th', {}, text)))), h('tbody', {}, rows))));
}
