// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node stability_table.mjs STABILITY.json PAGE.md
//
// Writes the table of docs/stability.md, between its two marks, from the object of stability.json.
import { readFileSync, renameSync, writeFileSync } from 'node:fs';

const [, , source, page] = process.argv;
const data = JSON.parse(readFileSync(source, 'utf8'));
const kUnits = { h_points: 'points of h', contrast_percent: '% of contrast', picture: 'of full scale', mean: 'of full scale (mean)' };
const number = (value) => String(Number(value.toPrecision(2)));

function row(sweep) {
  const count = (verdict) => sweep.cells.filter((cell) => cell.verdict === verdict).length;
  const right = sweep.cells.filter((cell) => cell.verdict === 'right' && cell.error !== null);
  const worst = right.reduce((a, b) => (a && a.error / a.bound >= b.error / b.bound ? a : b), null);
  const values = sweep.cells.map((cell) => cell.value);
  const text = worst ? `${number(worst.error)} ${kUnits[worst.quantity]}` : '-';
  return `| \`${sweep.name}\` | ${number(values[0])} to ${number(values.at(-1))} | ${count('right')} | ${count('told')} | ${count('refused')} | ${count('silently wrong')} | ${text} |`;
}

const begin = '<!-- table of script/bench stability -->';
const end = '<!-- end of the table -->';
const text = readFileSync(page, 'utf8');
const [from, to] = [text.indexOf(begin), text.indexOf(end)];
if (from < 0 || to < from) {
  console.error(`${page}: the marks "${begin}" and "${end}" are missing`);
  process.exit(2);
}
const table = ['| sweep | from, to | right | told | refused | silently wrong | largest error of those that are right |', '|---|---|---|---|---|---|---|', ...data.sweeps.map(row)];
writeFileSync(`${page}.new`, `${text.slice(0, from + begin.length)}\n${table.join('\n')}\n${text.slice(to)}`);
renameSync(`${page}.new`, page);
