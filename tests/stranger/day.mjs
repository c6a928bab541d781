// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node day.mjs GLINT MESH_DIR WORK_DIR [--turned] [--seed N] [--parts NAME,NAME...]
//                     [--evaluations N]
//
// A stranger's day: eleven parts that no study was made for, each with `glint new` and `glint run`
// and nothing else. Eight are real meshes as they are, with the unit a person would guess; three
// are parametric parts, written as meshes and turned and scaled at random. --turned turns and
// scales the eight, too. Random numbers follow from the seed and the part's name. --evaluations ends
// each search earlier than its study says, for a quick look.
//
// A part is shown better when the winner's objective, the worst defect's CNR or d', is larger than the
// baseline's by more than the noise of eight repeated scans, and its limits hold. Of every other part
// the verdict must say why not. Exit 1 when fewer than nine of eleven are shown better, when a
// verdict is silent or praises what is not so; 77 without the meshes.
// Prints a table; WORK_DIR/day.json has the same.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

import { numbersOf, readMesh, turned, writeStl } from "./mesh.mjs";

const WANTED_SHARE = 9 / 11;

/// Student's t for 95 % with seven degrees of freedom.
const STUDENT_7 = 2.365;

/// Codes of docs/verdict.md that say why no design shows a defect better.
const REASONS = ["defects_hidden", "objective_flat", "no_feasible", "on_limits", "all_failed"];

const MESHES = {
  fandisk: { file: "fandisk.obj", unit: "inch" },
  pivot_arm: { file: "moveo_pivot_arm.stl", unit: "mm" },
  servo_gear: { file: "moveo_servo_gear.stl", unit: "mm" },
  t3m1c: { file: "moveo_t3m1c.stl", unit: "mm" },
  foot: { file: "odri_foot_structure.stl", unit: "mm" },
  pulley: { file: "odri_pulley_at3_t30_output.stl", unit: "mm" },
  rocker_arm: { file: "rocker-arm.obj", unit: "inch" },
  bunny: { file: "stanford-bunny.obj", unit: "m" },
};

const GENERATED = {
  made_gear: '[part]\nshape = "spur_gear"\n',
  made_strip: '[part]\nshape = "strip"\nlength_mm = 90\nwidth_mm = 44\nradius_along_mm = 300\nradius_across_mm = 60\n',
  made_cap: '[part]\nshape = "sphere_cap"\n',
};

// --- Options -------------------------------------------------------------------------------------

const [glint, meshes, work, ...rest] = process.argv.slice(2);
const value = (name, otherwise) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : otherwise);
const seed = Number(value("--seed", "1"));
const all_turned = rest.includes("--turned");
const evaluations = value("--evaluations", "");
const wanted = value("--parts", Object.keys({ ...MESHES, ...GENERATED }).join(",")).split(",");

if (!fs.existsSync(path.join(meshes, MESHES.bunny.file))) {
  console.log(`skipped: ${meshes} has no meshes`);
  process.exit(77);
}

// --- One part ------------------------------------------------------------------------------------

function run(args) {
  const begin = process.hrtime.bigint();
  const result = spawnSync(glint, args, { cwd: work, encoding: "utf8", maxBuffer: 2 ** 28 });
  if (result.error) {
    throw result.error;
  }
  return { ...result, seconds: Number(process.hrtime.bigint() - begin) / 1e9 };
}

/// The JSON object that the program prints; throws with what it says when it fails.
function objectOf(args) {
  const result = run([...args, "--json", "--quiet"]);
  if (result.stdout.trim() === "") {
    throw new Error(`glint ${args.join(" ")}: exit ${result.status}: ${result.stderr.trim()}`);
  }
  return { ...JSON.parse(result.stdout), code: result.status, seconds: result.seconds };
}

/// The mesh's file and unit, turned and scaled where that is wanted.
function meshOf(name) {
  if (name in MESHES && !all_turned) {
    return { file: path.join(meshes, MESHES[name].file), unit: MESHES[name].unit };
  }
  let from = name in MESHES ? path.join(meshes, MESHES[name].file) : path.join(work, `${name}.off.stl`);
  if (name in GENERATED) {
    fs.writeFileSync(path.join(work, `${name}.part.toml`), GENERATED[name]);
    objectOf(["part", `${name}.part.toml`, "--out", from]);
  }
  const file = path.join(work, `${name}.stl`);
  writeStl(file, turned(readMesh(from), numbersOf(seed, name)));
  return { file, unit: "mm" };
}

/// 400 mm, and more for what would fill the tunnel.
function distanceOf(size_mm) {
  return Math.max(400, Math.ceil((3 * Math.hypot(...size_mm)) / 50) * 50);
}

const mean = (values) => values.reduce((sum, one) => sum + one, 0) / values.length;

/// Baseline's and winner's objective over repeated scans with common noise: means, and the
/// half-width of the interval that holds 95 % of single differences.
function comparison(folder, objective) {
  const of = (design) =>
    JSON.parse(fs.readFileSync(path.join(folder, design, "scores.json"), "utf8")).repeated[objective];
  const [before, after] = [of("baseline"), of("winner")];
  const differences = after.map((one, k) => one - before[k]);
  const middle = mean(differences);
  const variance = mean(differences.map((one) => (one - middle) ** 2)) * (8 / 7);
  return { before: mean(before), after: mean(after), noise: STUDENT_7 * Math.sqrt(variance) };
}

/// How a run of a part ended, as one row of the table.
function rowOf(name, started, result, seconds) {
  const { objective } = result;
  const codes = (result.verdict?.findings ?? []).map(({ code }) => code);
  const row = { name, objective, seconds, codes, tone: result.verdict?.tone, notes: started.notes };
  if (!result.best) {
    return { ...row, is_better: false, is_explained: codes.some((code) => REASONS.includes(code)) };
  }
  const { before, after, noise } = comparison(path.join(work, "out", name, "run"), objective);
  const is_better = after - before > noise && result.status !== "no_feasible";
  return {
    ...row,
    ...{ before, after, noise, ratio: after / before, is_better },
    is_explained: is_better || codes.some((code) => REASONS.includes(code)),
    is_honest: is_better || !(codes.includes("defects_clearer") || row.tone === "good"),
  };
}

function dayOf(name) {
  const begin = process.hrtime.bigint();
  const seconds = () => Number(process.hrtime.bigint() - begin) / 1e9;
  try {
    const { file, unit } = meshOf(name);
    const { size_mm } = objectOf(["part", file, "--unit", unit]);
    const distance_mm = distanceOf(size_mm);
    const study = `${name}.toml`;
    const place = ["--working_distance_mm", `${distance_mm}`, "--out", study];
    const started = objectOf(["new", file, "--unit", unit, ...place]);
    const new_s = seconds();
    const shorter = evaluations === "" ? [] : ["--set", `budget.evaluations=${evaluations}`];
    const result = objectOf(["run", study, ...shorter]);
    return { size_mm, distance_mm, new_s, ...rowOf(name, started, result, seconds()) };
  } catch (error) {
    return { name, codes: [], seconds: seconds(), is_better: false, is_explained: false, problem: `${error.message}` };
  }
}

// --- The table -----------------------------------------------------------------------------------

const number = (one) => (one === undefined ? "-" : Math.abs(one) < 10 ? one.toFixed(2) : one.toFixed(1));

function lineOf(row) {
  const cells = [number(row.before), number(row.after), number(row.noise), number(row.ratio)];
  const state = row.is_better ? "better" : row.is_explained ? "explained" : "SILENT";
  return (
    `${row.name.padEnd(12)}${cells.map((cell) => cell.padStart(9)).join("")}` +
    `${row.seconds.toFixed(0).padStart(7)}  ${state.padEnd(10)}` +
    `${row.problem ?? `${row.tone}: ${row.codes.join(" ")}`}`
  );
}

fs.rmSync(work, { recursive: true, force: true });
fs.mkdirSync(work, { recursive: true });
console.log(
  `${"part".padEnd(12)}${["baseline", "winner", "noise", "ratio"].map((one) => one.padStart(9)).join("")}` +
    `${"s".padStart(7)}  ${"".padEnd(10)}verdict`,
);
const rows = wanted.map((name) => {
  const row = dayOf(name);
  console.log(lineOf(row));
  for (const note of row.notes ?? []) {
    console.log(`${"".padEnd(12)}${note}`);
  }
  return row;
});
fs.writeFileSync(path.join(work, "day.json"), `${JSON.stringify({ seed, all_turned, parts: rows }, null, 2)}\n`);
const better = rows.filter(({ is_better }) => is_better).length;
const silent = rows.filter(({ is_explained }) => !is_explained);
const praised = rows.filter(({ is_honest }) => is_honest === false);
const minutes = rows.reduce((sum, { seconds }) => sum + seconds, 0) / 60;
console.log(
  `${better} of ${rows.length} parts show their dent better, ${silent.length} without a reason, ` +
    `${praised.length} praised for nothing; ${minutes.toFixed(1)} minutes`,
);
process.exit(better >= WANTED_SHARE * rows.length && silent.length + praised.length === 0 ? 0 : 1);
