// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node cost_bar.mjs BENCH.json COUNTER MOST
//
// Prints what the rows with that counter have, a cost as a multiple of another library's in the same
// run (script/bench compare, cover). Exit 1 when one has more than MOST; a run without such rows, by
// its filter, is left alone.
import { readFileSync } from "node:fs";

const [file, counter, most] = process.argv.slice(2);
if (!(Number(most) > 0)) {
  console.error("usage: node cost_bar.mjs BENCH.json COUNTER MOST");
  process.exit(2);
}
// Google Benchmark leaves an empty file when no name matches the filter.
const text = readFileSync(file, "utf8").trim();
const rows = (text === "" ? [] : JSON.parse(text).benchmarks).filter((row) => counter in row);
for (const row of rows) {
  console.log(`${row.name}: ${counter} ${row[counter].toFixed(2)}, at most ${most}`);
}
process.exit(rows.every((row) => row[counter] <= Number(most)) ? 0 : 1);
