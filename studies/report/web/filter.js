// SPDX-License-Identifier: GPL-3.0-or-later
// The filter of the table of evaluations: "h_rms > 80 cnr >= 3 feasible".

const kStates = ['feasible', 'infeasible', 'failed'];
const kComparison = /([^\s<>=]+)\s*([<>=]+)\s*([^\s<>=]*)/g;
const kCompare = { '<': (a, b) => a < b, '>': (a, b) => a > b, '<=': (a, b) => a <= b, '>=': (a, b) => a >= b, '=': (a, b) => a === b };

/** The column of that name or heading, or the first that has it in its name. */
function columnOf(name, columns) {
  const wanted = name.toLowerCase();
  const names = (column) => [column.name, column.heading].map((one) => one.toLowerCase());
  return columns.find((column) => names(column).includes(wanted)) ?? columns.find((column) => names(column).some((one) => one.includes(wanted)));
}

/** A condition on rows, or what is wrong with the comparison. Numbers are in the unit that the table shows. */
function comparison(name, sign, wanted, columns) {
  const column = columnOf(name, columns);
  if (!column) return { problem: `no column is called "${name}"` };
  const compare = kCompare[sign];
  if (!compare) return { problem: `"${sign}" is no comparison; there are < > <= >= =` };
  if (wanted === '') return { problem: `what is ${name} ${sign} to be compared with?` };
  const limit = Number(wanted.replace('\u2212', '-').replace(/%$/, ''));
  if (Number.isNaN(limit)) {
    if (sign !== '=') return { problem: `"${wanted}" is no number` };
    return { keep: (row) => String(column.value(row)).toLowerCase() === wanted.toLowerCase() };
  }
  const scale = column.isPercent ? 100 : 1;
  return { keep: (row) => typeof column.value(row) === 'number' && compare(scale * column.value(row), limit) };
}

/** A word that stands in a row, or the state it is in. */
function word(text, columns, rows) {
  if (kStates.includes(text)) return { keep: (row) => columns.some((column) => column.name === 'state' && column.value(row) === text) };
  const keep = (row) => columns.some((column) => column.text(row).toLowerCase().includes(text));
  return rows.some(keep) ? { keep } : { problem: `no row has "${text}"` };
}

/**
 * What a filter keeps, and what is wrong with it: { keep(row), problems: [texts] }. What is wrong keeps every row.
 * @param columns  { name, heading, value(row), text(row), isPercent }
 */
export function parseFilter(text, columns, rows) {
  const found = [];
  const rest = text.replace(kComparison, (whole, name, sign, wanted) => {
    found.push(comparison(name, sign, wanted, columns));
    return ' ';
  });
  for (const one of rest.toLowerCase().split(/\s+/).filter(Boolean)) found.push(word(one, columns, rows));
  const conditions = found.flatMap(({ keep }) => keep ?? []);
  return { keep: (row) => conditions.every((keep) => keep(row)), problems: found.flatMap(({ problem }) => problem ?? []) };
}
