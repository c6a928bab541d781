// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node schema_test.mjs GLINT SOURCE_DIR WORK_DIR
//
// Judges study files by the schema that `glint explain --schema` prints, with the validator of
// taplo, the TOML language server of most editors: every study of the gallery is valid, every broken
// one is refused, and each broken file without its fault is valid. taplo comes from npm into
// WORK_DIR once. Exit 77 with the reason where npm or the network is missing.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

const TAPLO = "@taplo/cli@0.7.0";
const [glint, source, work] = process.argv.slice(2);

function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(77);
}

function run(program, args, options = {}) {
  const result = spawnSync(program, args, { encoding: "utf8", ...options });
  if (result.error) {
    throw new Error(`${program}: ${result.error.message}`);
  }
  return result;
}

function installTaplo() {
  const script = path.join(work, "node_modules", "@taplo", "cli", "dist", "cli.js");
  if (!fs.existsSync(script)) {
    if (spawnSync("npm", ["--version"]).error) {
      skip("npm is not installed");
    }
    const args = ["install", "--no-audit", "--no-fund", "--prefix", work, TAPLO];
    if (run("npm", args, { timeout: 120000 }).status !== 0) {
      skip(`npm cannot install ${TAPLO}`);
    }
  }
  return script;
}

// --- Broken studies ------------------------------------------------------------------------------

const SOUND = `schema = 1
title = "A study"
include = []
[part]
shape = "strip"
[sensor]
bits = 8
[lighting.tunnel]
shape = "free"
radius_mm = 90
control_mm = [60, 70, 80]
[lighting.left]
type = "ring"
inner_radius_mm = 20
[lighting.dome]
[[viewpoint]]
position_mm = [0, 0, 300]
[defects.nicks]
type = "dent"
height_um = [1, 5]
count = 3
[variables]
"lighting.tunnel.radius_mm" = { min = 60, max = 200, log = true }
"lighting.tunnel.shape" = { choices = ["free", "ellipse"] }
[prototypes.round]
title = "Round"
"lighting.tunnel.radius_mm" = 100
[objective]
maximise = "defects.min_cnr"
[constraints]
"homogeneity.h_rms" = { min = 0.5, weight = 2 }
[budget]
evaluations = 20
wall_clock = "1h"
`;

/// What each replaces in the sound study.
const BROKEN = {
  "unknown table": ["[sensor]", "[sensors]"],
  "unknown key": ["radius_mm = 90", "raduis_mm = 90"],
  "key at the top": ['title = "A study"', 'titel = "A study"'],
  "text for a number": ["radius_mm = 90", 'radius_mm = "90 mm"'],
  "number for a text": ['title = "A study"', "title = 7"],
  "below the range": ["radius_mm = 90", "radius_mm = -4"],
  "above the range": ["bits = 8", "bits = 99"],
  "no whole number": ["evaluations = 20", "evaluations = 20.5"],
  "unknown choice": ['shape = "strip"', 'shape = "gear"'],
  "unknown kind of light": ['type = "ring"', 'type = "lamp"'],
  "key of another kind of light": ["inner_radius_mm = 20", "control_mm = [60, 70]"],
  "key of a light of its name": ["[lighting.dome]", "[lighting.dome]\nslot_mm = 3"],
  "too few numbers": ["position_mm = [0, 0, 300]", "position_mm = [0, 300]"],
  "list of one table": ["[[viewpoint]]", "[viewpoint]"],
  "range of three": ["height_um = [1, 5]", "height_um = [1, 5, 7]"],
  "unknown key of a defect": ["count = 3", "counts = 3"],
  "unknown key of a variable": ["log = true", "logarithmic = true"],
  "two aims": ["[objective]", '[objective]\nminimise = "homogeneity.mean"'],
  "no aim": ['maximise = "defects.min_cnr"', ""],
  "a limit without a bound": ["{ min = 0.5, weight = 2 }", "{ weight = 2 }"],
  "another schema": ["schema = 1", "schema = 3"],
};

// --- The test ------------------------------------------------------------------------------------

fs.mkdirSync(work, { recursive: true });
const taplo = installTaplo();
const schema = path.join(work, "study.schema.json");
fs.writeFileSync(schema, run(glint, ["explain", "--schema"]).stdout);

let failures = 0;

/// The files that taplo refuses, of those given; it names each of them.
function refused(files) {
  const args = [taplo, "lint", "--no-auto-config", "--colors", "never", "--schema", `file://${schema}`];
  const result = run(process.execPath, [...args, ...files], { cwd: work });
  const told = result.stdout + result.stderr;
  const found = files.filter((file) => told.includes(file));
  if ((result.status === 0) !== (found.length === 0)) {
    throw new Error(`taplo names no file: ${told}`);
  }
  return { found, told };
}

function writeStudy(name, text) {
  const file = path.join(work, "studies", `${name.replaceAll(" ", "_")}.toml`);
  fs.mkdirSync(path.dirname(file), { recursive: true });
  fs.writeFileSync(file, text);
  return file;
}

function fail(text) {
  ++failures;
  console.log(text);
}

// Boards, cells and what a simulated cell is in truth are files of other kinds.
const OTHER_KINDS = ["board.toml", "cell.toml", "truth.toml", "robot_cell/hidden.toml"];
const gallery = path.join(source, "studies", "gallery");
const valid = fs
  .readdirSync(gallery, { recursive: true })
  .filter((name) => name.endsWith(".toml") && !OTHER_KINDS.some((kind) => name.endsWith(kind)))
  .map((name) => path.join(gallery, name));
if (valid.length < 12) {
  fail(`only ${valid.length} studies found in ${gallery}`);
}
const judged = refused([...valid, writeStudy("sound", SOUND)]);
if (judged.found.length > 0) {
  fail(`refused: ${judged.found.join(", ")}\n${judged.told}`);
}
const broken = Object.entries(BROKEN).map(([name, [from, to]]) => {
  const text = SOUND.replace(from, to);
  if (text === SOUND) {
    fail(`${name}: the text to replace is not there`);
  }
  return writeStudy(name, text);
});
const { found } = refused(broken);
for (const file of broken.filter((one) => !found.includes(one))) {
  fail(`accepted: ${file}`);
}
console.log(`${valid.length} studies, ${broken.length} broken ones, ${failures} failures`);
process.exit(failures === 0 ? 0 : 1);
