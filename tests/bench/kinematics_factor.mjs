// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node kinematics_factor.mjs CELL.json
//
// Prints by what factor the inverse kinematics in closed form is faster than KDL's solver in the same
// run (script/bench cell). Exit 1 when it is less than 30, or one of the two rows is missing; a run
// that has neither, by its filter, is left alone.
import { readFileSync } from "node:fs";

const MIN_FACTOR = 30;

const file = process.argv[2];
if (file === undefined) {
  console.error("usage: node kinematics_factor.mjs CELL.json");
  process.exit(2);
}
// Google Benchmark leaves an empty file when no name matches the filter.
const text = readFileSync(file, "utf8").trim();
const rows = text === "" ? [] : JSON.parse(text).benchmarks;
const timeOf = (name) => rows.find((row) => row.name === name)?.us_a_pose;
const ours = timeOf("cell/inverse/closed_form");
const theirs = timeOf("cell/inverse/kdl_lma");
if (ours === undefined && theirs === undefined) {
  process.exit(0);
}
const factor = theirs / ours; // NaN when one is missing
console.log(`KDL's time over that of the closed form: ${factor.toFixed(1)}, at least ${MIN_FACTOR}`);
process.exit(factor >= MIN_FACTOR ? 0 : 1);
