#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node evaluations.mjs --new GLINT [--old GLINT] [--rounds N] [--evaluations N] FOLDER ...
//
// CPU seconds of whole evaluations in a search: what a candidate costs from the search's question to
// the row in its database. Each round runs study.toml of each folder with each program, one thread, one job, the
// old and the new one first by turns, and takes `cpu_s.search` of run.json over the number of
// evaluations; what a run does beside its search does not count. With --old also the ratio new/old
// of each round, its median, and whether both left the same trials.csv. Called by script/bench.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, realpathSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

const NIGHT_S = 10 * 3600;
const CORES = 2;

export function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

// Evaluations in ten hours on two cores, in three digits: candidates of a batch do not wait for each
// other but at its end.
export function perNight(secondsEach) {
  return Number(((CORES * NIGHT_S) / secondsEach).toPrecision(3));
}

// CPU seconds an evaluation, and the trials. A failed run is an error: its figures mean nothing.
function runOnce(glint, folderOfStudy, evaluations) {
  const study = join(folderOfStudy, "study.toml");
  const folder = mkdtempSync(join(tmpdir(), "glint_evaluations_"));
  const out = join(folder, "run");
  try {
    const set = `budget.evaluations=${evaluations}`;
    const options = ["--threads", "1", "--jobs", "1", "--quiet", "--out", out];
    const done = spawnSync(glint, ["run", study, "--set", set, ...options], { encoding: "utf8" });
    if (done.status !== 0 && done.status !== 1) {
      throw new Error(`${glint} run ${study}: ${done.error?.message ?? done.stderr.trim()}`);
    }
    const trials = readFileSync(join(out, "trials.csv"), "utf8");
    const count = trials.trimEnd().split("\n").length - 1;
    const seconds = JSON.parse(readFileSync(join(out, "run.json"), "utf8")).cpu_s.search;
    return { seconds: seconds / count, trials };
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

function measure(study, options) {
  const programs = options.old ? ["new", "old"] : ["new"];
  const seconds = { new: [], old: [] };
  let isSame = true;
  for (let round = 1; round <= options.rounds; ++round) {
    const order = round % 2 === 1 ? programs : [...programs].reverse();
    const trials = {};
    for (const which of order) {
      const once = runOnce(options[which], study, options.evaluations);
      seconds[which].push(once.seconds);
      trials[which] = once.trials;
    }
    isSame = isSame && (!options.old || trials.new === trials.old);
    console.error(`${basename(study)}: round ${round} of ${options.rounds}`);
  }
  const each = median(seconds.new);
  const row = { study: basename(study), new_ms: 1e3 * each, night: perNight(each) };
  if (options.old) {
    const ratios = seconds.new.map((value, i) => value / seconds.old[i]);
    row.old_ms = 1e3 * median(seconds.old);
    row.ratio = median(ratios);
    row.low = Math.min(...ratios);
    row.high = Math.max(...ratios);
    row.same = isSame ? "yes" : "NO";
  }
  return row;
}

function printTable(rows, hasOld) {
  const digits = (value) => value.toPrecision(3);
  const of = ["ratio", "low", "high"];
  const comparison = ["old ms", "ratio", "smallest", "largest", "same trials"];
  const names = ["study", "ms an evaluation", "evaluations a night", ...(hasOld ? comparison : [])];
  console.log(`| ${names.join(" | ")} |`);
  console.log(`|${"---|".repeat(names.length)}`);
  for (const row of rows) {
    const old = [digits(row.old_ms ?? 0), ...of.map((key) => row[key]?.toFixed(3)), row.same];
    const cells = [row.study, digits(row.new_ms), row.night, ...(hasOld ? old : [])];
    console.log(`| ${cells.join(" | ")} |`);
  }
}

function main(args) {
  const text = { type: "string" };
  const { values, positionals } = parseArgs({
    args,
    options: {
      new: text,
      old: text,
      rounds: { type: "string", default: "9" },
      evaluations: { type: "string", default: "200" },
    },
    allowPositionals: true,
  });
  const options = {
    ...values,
    rounds: Number(values.rounds),
    evaluations: Number(values.evaluations),
  };
  for (const key of ["rounds", "evaluations"]) {
    if (!Number.isInteger(options[key]) || options[key] < 1) {
      throw new Error(`--${key} is a whole number from 1 on, not "${values[key]}"`);
    }
  }
  if (!options.new || positionals.length === 0) {
    throw new Error("--new and a study are needed");
  }
  const rows = positionals.map((study) => measure(study, options));
  printTable(rows, Boolean(options.old));
  return rows.every((row) => row.same !== "NO") ? 0 : 1;
}

// Tests import this file.
if (process.argv[1] && realpathSync(process.argv[1]) === fileURLToPath(import.meta.url)) {
  try {
    process.exitCode = main(process.argv.slice(2));
  } catch (error) {
    console.error(`bench: ${error.message}`);
    process.exitCode = 2;
  }
}
