// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node print_table.mjs BENCH.json
//
// Prints what Google Benchmark wrote as a table, counters first: they are ratios and can be
// compared between machines, times cannot. Rows of repeated runs show their aggregates.
import { readFileSync } from "node:fs";

// Keys that every benchmark has; all other numbers are counters.
const STANDARD = new Set([
  "aggregate_unit",
  "cpu_time",
  "family_index",
  "iterations",
  "per_family_instance_index",
  "real_time",
  "repetition_index",
  "repetitions",
  "threads",
]);

function countersOf(rows) {
  const names = new Set();
  for (const row of rows) {
    for (const [key, value] of Object.entries(row)) {
      if (typeof value === "number" && !STANDARD.has(key)) {
        names.add(key);
      }
    }
  }
  // Rates in items or bytes depend on the machine: behind the ratios.
  const isRate = (name) => name.endsWith("_per_second");
  return [...names].sort((a, b) => isRate(a) - isRate(b));
}

function format(value) {
  if (typeof value !== "number") {
    return "-";
  }
  for (const [limit, suffix] of [
    [1e9, "G"],
    [1e6, "M"],
    [1e4, "k"],
  ]) {
    if (Math.abs(value) >= limit) {
      return `${(value / (limit === 1e4 ? 1e3 : limit)).toPrecision(3)}${suffix}`;
    }
  }
  return Math.abs(value) >= 100 ? value.toFixed(0) : value.toPrecision(3);
}

function nameOf(row) {
  return row.label ? `${row.name} (${row.label})` : row.name;
}

const file = process.argv[2];
if (file === undefined) {
  console.error("usage: node print_table.mjs BENCH.json");
  process.exit(2);
}
// Google Benchmark leaves an empty file when no name matches the filter.
const text = readFileSync(file, "utf8");
if (text.trim() === "") {
  process.exit(0);
}
const rows = JSON.parse(text).benchmarks;
const failed = rows.filter((row) => row.error_occurred);
const shown = rows.filter((row) => !row.error_occurred);
const counters = countersOf(shown);
const table = [
  [...counters, "CPU time", "name"],
  ...shown.map((row) => [
    ...counters.map((name) => format(row[name])),
    `${format(row.cpu_time)} ${row.time_unit}`,
    nameOf(row),
  ]),
];
const widths = table[0].map((_, i) => Math.max(...table.map((cells) => cells[i].length)));
for (const cells of table) {
  const last = cells.length - 1;
  console.log(
    cells.map((cell, i) => (i === last ? cell : cell.padStart(widths[i]))).join("  "),
  );
}
for (const row of failed) {
  console.log(`${row.name} failed: ${row.error_message}`);
}
process.exit(failed.length > 0 ? 1 : 0);
