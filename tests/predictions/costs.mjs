// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node costs.mjs GLINT SOURCE_DIR WORK_DIR [STUDY...]
//
// Compares the CPU seconds that `glint check` predicts for studies of the gallery with those that
// `glint run` takes (cpu_s of its run.json): search, re-scoring, writing and populations apart, and
// their sum. Long searches get fewer evaluations, the same number for both. CPU seconds, since the
// clock on the wall shows what else the machine does.
//
// Of each kind of cost, those below SHORTEST_S are left out: there a clock's tick and one cold cache
// decide. Of the others, and of the sums, at least 8 of 10 must be predicted within 30 %. Prints the
// ratios, predicted / taken; WORK_DIR/costs.json has the seconds. Exit 1 otherwise.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

const WANTED_SHARE = 0.8;
const LARGEST_ERROR = 0.3;
const SHORTEST_S = 0.5;

/// Study file, and what makes it shorter.
const STUDIES = {
  tunnel_shape: [],
  gradient_tunnel: [],
  fringe_design: [],
  my_part: [],
  worst_dent: [],
  visible_first: ["budget.evaluations=20"],
  ring_geometry: ["budget.evaluations=40"],
  sort_parts: [],
  pod: [],
  even_first: [
    "objective.maximise=homogeneity.h_rms",
    'constraints."homogeneity.h_rms".min=0',
    'constraints."defects.min_cnr".min=3',
    "defects.dent.height_um=2",
    "defects.dent.count=20",
    "search.algorithm=cobyla",
    "budget.evaluations=60",
  ],
};

/// The study of which another is a variant.
const BASES = { even_first: "visible_first" };

const KINDS = ["search", "rescoring", "writing", "populations", "total"];

const [glint, source, work, ...chosen] = process.argv.slice(2);

function objectOf(args) {
  const result = spawnSync(glint, [...args, "--json", "--quiet", "--threads", "2"], {
    encoding: "utf8",
    maxBuffer: 2 ** 28,
  });
  if (result.error || result.stdout.trim() === "") {
    throw new Error(`glint ${args.join(" ")}: ${result.error?.message ?? result.stderr}`);
  }
  return JSON.parse(result.stdout);
}

function fileOf(name) {
  return path.join(source, "studies", "gallery", BASES[name] ?? name, "study.toml");
}

function compare(name) {
  const file = fileOf(name);
  const settings = STUDIES[name].flatMap((one) => ["--set", one]);
  const out = path.join(work, name);
  const predicted = objectOf(["check", file, ...settings]).predicted_cpu_s;
  objectOf(["run", file, ...settings, "--out", out]);
  const taken = JSON.parse(fs.readFileSync(path.join(out, "run.json"), "utf8")).cpu_s;
  taken.total = Object.values(taken).reduce((sum, one) => sum + one, 0);
  return { name, predicted, taken };
}

/// undefined: too short to tell.
function ratioOf({ predicted, taken }, kind) {
  return taken[kind] < SHORTEST_S ? undefined : predicted[kind] / taken[kind];
}

function cellOf(row, kind) {
  const ratio = ratioOf(row, kind);
  const seconds = `${row.predicted[kind].toFixed(1)}/${row.taken[kind].toFixed(1)}`;
  return `${seconds.padStart(13)}${(ratio === undefined ? "-" : ratio.toFixed(2)).padStart(6)}`;
}

const isRight = (ratio) => Math.abs(ratio - 1) <= LARGEST_ERROR;

fs.rmSync(work, { recursive: true, force: true });
fs.mkdirSync(work, { recursive: true });
console.log(`predicted/taken CPU s, ratio${KINDS.map((kind) => kind.padStart(19)).join("").slice(11)}`);
const rows = (chosen.length > 0 ? chosen : Object.keys(STUDIES)).map((name) => {
  const row = compare(name);
  console.log(`${name.padEnd(17)}${KINDS.map((kind) => cellOf(row, kind)).join("")}`);
  return row;
});
fs.writeFileSync(path.join(work, "costs.json"), `${JSON.stringify(rows, null, 2)}\n`);
const failures = KINDS.filter((kind) => {
  const ratios = rows.map((row) => ratioOf(row, kind)).filter((ratio) => ratio !== undefined);
  const right = ratios.filter(isRight).length;
  console.log(`${kind}: ${right} of ${ratios.length} within ${100 * LARGEST_ERROR} %`);
  return right < WANTED_SHARE * ratios.length;
});
process.exit(failures.length > 0 ? 1 : 0);
