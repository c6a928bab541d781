// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node goals_table.mjs RESULT.json
//
// Prints the goals of a calibration that was tried out, and how far what was found is off. Exit 1
// when one of them is missed.
import { readFileSync } from "node:fs";
import process from "node:process";

const { goals } = JSON.parse(readFileSync(process.argv[2], "utf8"));
for (const { name, unit, found, goal, is_met: isMet } of goals) {
  console.log(`${name.padEnd(44)} ${found.toFixed(4)} ${unit}, goal ${goal} ${isMet ? "" : "MISSED"}`.trimEnd());
}
process.exit(goals.every((one) => one.is_met) ? 0 : 1);
