#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node study_searches.mjs --list
//        node study_searches.mjs --glint GLINT --gallery FOLDER --results FOLDER [--table] [PART ...]
//
// Searches of two gallery studies that must be at least as good as others. A part is
// STUDY/METHOD/SEED; without parts all of --list. Of gradient_tunnel gp with derivatives is compared
// with slsqp after 15 and 30 evaluations. Of ring_geometry `auto`, told that scores are noisy, has
// 120 evaluations and the study as it stands ("today") 300; the winners are scored again with fresh
// seeds and 512 samples. A run in RESULTS goes on where it was, and a part that has its scores is
// not run again. Called by script/bench search studies, which prints the table after it.
// Exit: 0 done, with --table all bars met; 1 one is missed or not shown; 2 an error.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, realpathSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

const SEEDS = 10;
const SAMPLES = 512;
const NEGATIVE = 1; // exit of a search that has found no design within the limits
const MORE_SAMPLES = 4; // what a run multiplies samples by when it scores a design again

const METHODS = {
  "gradient_tunnel/slsqp": { budgets: [15, 30], set: ["search.algorithm=slsqp"] },
  "gradient_tunnel/gp": {
    budgets: [15, 30],
    set: ["search.algorithm=gp", "search.derivatives=true"],
  },
  "ring_geometry/today": { budgets: [300], set: [], isRescored: true },
  "ring_geometry/auto": {
    budgets: [120],
    set: ["search.algorithm=auto", "search.noisy=true"],
    isRescored: true,
  },
};

export function allParts() {
  const seeds = Array.from({ length: SEEDS }, (_, i) => i + 1);
  return Object.keys(METHODS).flatMap((method) => seeds.map((seed) => `${method}/${seed}`));
}

function glintRun(glint, study, out, sets) {
  const options = sets.flatMap((set) => ["--set", set]);
  const args = ["run", study, "--quiet", "--out", out, ...options];
  const run = spawnSync(glint, args, { encoding: "utf8" });
  if (run.error || ![0, NEGATIVE].includes(run.status)) {
    throw new Error(`${study}: ${run.error?.message ?? run.stderr.trim()}`);
  }
  return JSON.parse(readFileSync(join(out, "result.json"), "utf8"));
}

// Larger is better in both studies, and nothing is below 0: so much is a search worth that has found
// no design within the limits.
function scoreOfBest(glint, result, out, isRescored) {
  if (result.status === "no_feasible") {
    return 0;
  }
  if (!isRescored) {
    return result.best.scores[result.objective];
  }
  const scene = join(out, "winner", "scene.toml");
  const samples = `render.paths.samples=${SAMPLES / MORE_SAMPLES}`;
  return glintRun(glint, scene, `${out}_again`, [samples]).rescored.baseline[result.objective];
}

const fileOf = (results, part) => join(results, `${part.replaceAll("/", "_")}.json`);

/** Scores of a part by the number of evaluations, as far as it has been run. */
function known(results, part) {
  const file = fileOf(results, part);
  return existsSync(file) ? JSON.parse(readFileSync(file, "utf8")) : {};
}

export function runPart(glint, gallery, results, part) {
  const [study, method, seed] = part.split("/");
  const { budgets, set, isRescored } = METHODS[`${study}/${method}`];
  const scores = known(results, part);
  const out = join(results, "runs", part.replaceAll("/", "_"));
  for (const budget of budgets.filter((one) => !(one in scores))) {
    const sets = [...set, `search.seed=${seed}`, `budget.evaluations=${budget}`];
    const result = glintRun(glint, join(gallery, study, "study.toml"), out, sets);
    const score = scoreOfBest(glint, result, out, isRescored);
    if (typeof score !== "number") {
      throw new Error(`${part}: the winner has no ${result.objective}`);
    }
    scores[budget] = score;
    mkdirSync(results, { recursive: true });
    writeFileSync(fileOf(results, part), JSON.stringify(scores));
  }
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

function errorOfMean(values) {
  const squares = values.reduce((sum, value) => sum + (value - mean(values)) ** 2, 0);
  return Math.sqrt(squares / (values.length - 1) / values.length);
}

/** @param scoresOf  of a part, { evaluations: score } */
export function barsOf(scoresOf) {
  const row = (method, after) =>
    allParts()
      .filter((part) => part.startsWith(`${method}/`))
      .map((part) => scoresOf(part)[after])
      .filter((score) => score !== undefined);
  const bar = (what, own, other, slackOf) => {
    const few = [own, other].find((values) => values.length < SEEDS);
    return few
      ? { what: `${what} (${few.length} of ${SEEDS} seeds)`, value: null }
      : { what, value: mean(own) - mean(other) + slackOf(other) };
  };
  const afterEach = METHODS["gradient_tunnel/gp"].budgets.map((after) =>
    bar(
      `gradient_tunnel: score of gp with derivatives less slsqp's, after ${after}`,
      row("gradient_tunnel/gp", after),
      row("gradient_tunnel/slsqp", after),
      () => 0,
    ),
  );
  const ofRing = bar(
    "ring_geometry: score after 120 less today's after 300, and today's standard error",
    row("ring_geometry/auto", 120),
    row("ring_geometry/today", 300),
    errorOfMean,
  );
  return [...afterEach, ofRing];
}

function printTable(bars) {
  for (const { what, value } of bars) {
    const verdict = value === null ? "not shown" : value >= 0 ? "met" : "missed";
    const shown = value === null ? "-" : value.toPrecision(3);
    console.log(`${verdict.padEnd(10)} ${shown.padStart(8)} >= 0  ${what}`);
  }
  return bars.every(({ value }) => value !== null && value >= 0) ? 0 : 1;
}

function main(args) {
  const text = { type: "string" };
  const flag = { type: "boolean" };
  const { values, positionals } = parseArgs({
    args,
    options: { glint: text, gallery: text, results: text, list: flag, table: flag },
    allowPositionals: true,
  });
  if (values.list) {
    console.log(allParts().join("\n"));
    return 0;
  }
  if (!values.results || (!values.table && !(values.glint && values.gallery))) {
    throw new Error("--glint, --gallery and --results are needed");
  }
  if (values.table) {
    return printTable(barsOf((part) => known(values.results, part)));
  }
  const unknown = positionals.find((part) => !allParts().includes(part));
  if (unknown !== undefined) {
    throw new Error(`${unknown}: no part of --list`);
  }
  for (const part of positionals.length > 0 ? positionals : allParts()) {
    runPart(values.glint, values.gallery, values.results, part);
    console.error(`${part}: ${JSON.stringify(known(values.results, part))}`);
  }
  return 0;
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
