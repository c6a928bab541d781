// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node study_searches_test.mjs
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { allParts, barsOf, runPart } from "./study_searches.mjs";

const SCRIPT = join(dirname(fileURLToPath(import.meta.url)), "study_searches.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_study_searches_test_"));

// Stands for glint: a search scores its number of evaluations, a scene a thousand and its samples.
const GLINT = join(scratch, "glint");
writeFileSync(GLINT, `#!/usr/bin/env node
const fs = require("node:fs");
const args = process.argv.slice(2);
fs.appendFileSync(${JSON.stringify(join(scratch, "calls"))}, args.join(" ") + "\\n");
const out = args[args.indexOf("--out") + 1];
const set = (key) => Number(args.find((one) => one.startsWith(key + "="))?.split("=")[1]);
fs.mkdirSync(out, { recursive: true });
const isScene = args[1].endsWith("scene.toml");
const result = isScene
  ? { status: "done", rescored: { baseline: args[1].includes("_7/") ? {} : { s: 1000 + set("render.paths.samples") } } }
  : {
      status: set("search.seed") === 9 ? "no_feasible" : "done",
      objective: "s",
      best: { scores: { s: set("budget.evaluations") } },
    };
fs.writeFileSync(out + "/result.json", JSON.stringify(result));
process.exit(result.status === "no_feasible" ? 1 : set("search.seed") === 10 ? 2 : 0);
`);
chmodSync(GLINT, 0o755);

const calls = () => readFileSync(join(scratch, "calls"), "utf8").trim().split("\n");
const found = (name) => JSON.parse(readFileSync(join(scratch, "results", `${name}.json`), "utf8"));
const run = (part) => runPart(GLINT, "/gallery", join(scratch, "results"), part);

try {
  assert.equal(allParts().length, 40);

  // One run goes on from 15 to 30 evaluations; what has its scores is not run again.
  run("gradient_tunnel/gp/3");
  assert.deepEqual(found("gradient_tunnel_gp_3"), { 15: 15, 30: 30 });
  assert.equal(calls().length, 2);
  assert.match(calls()[1], /^run \/gallery\/gradient_tunnel\/study\.toml .*--set search\.derivatives=true --set search\.seed=3 --set budget\.evaluations=30$/);
  run("gradient_tunnel/gp/3");
  assert.equal(calls().length, 2);
  writeFileSync(join(scratch, "results", "gradient_tunnel_gp_3.json"), '{"15":14}');
  run("gradient_tunnel/gp/3");
  assert.deepEqual(found("gradient_tunnel_gp_3"), { 15: 14, 30: 30 });

  // The winner of noisy scores counts as it is scored again, with 4 x 128 samples.
  run("ring_geometry/auto/2");
  assert.deepEqual(found("ring_geometry_auto_2"), { 120: 1128 });
  assert.match(calls().at(-1), /ring_geometry_auto_2\/winner\/scene\.toml/);
  run("ring_geometry/today/9");
  assert.deepEqual(found("ring_geometry_today_9"), { 300: 0 }, "no design within the limits");

  assert.throws(() => run("gradient_tunnel/slsqp/10"), /gradient_tunnel\/study\.toml/);

  assert.throws(() => run("ring_geometry/auto/7"), /ring_geometry\/auto\/7: the winner has no s/);

  // Bars.
  const scores = (own) => (part) => {
    const [study, method, seed] = part.split("/");
    const isOwn = method === "gp";
    return study === "ring_geometry"
      ? { 120: own, 300: 10 + (seed % 2 === 0 ? 3 : -3) }
      : { 15: isOwn ? 0.8 : 0.7, 30: isOwn ? 0.8 : 0.9 };
  };
  const [after15, after30, ring] = barsOf(scores(9.5));
  assert.ok(Math.abs(after15.value - 0.1) < 1e-12);
  assert.ok(Math.abs(after30.value + 0.1) < 1e-12);
  assert.ok(Math.abs(ring.value - (9.5 - 10 + 1)) < 1e-12, "ten values 3 off: an error of 1");
  assert.ok(barsOf(scores(8.5))[2].value < 0);
  const lacking = (part) => (part === "gradient_tunnel/slsqp/4" ? {} : scores(9)(part));
  const [none] = barsOf(lacking);
  assert.equal(none.value, null);
  assert.match(none.what, /9 of 10 seeds/);

  // What is not shown is not met.
  const options = ["--results", join(scratch, "results"), "--table"];
  const table = spawnSync("node", [SCRIPT, ...options], { encoding: "utf8" });
  assert.equal(table.status, 1);
  assert.match(table.stdout, /^not shown +- >= 0 {2}gradient_tunnel: .* after 15 \(1 of 10 seeds\)$/m);
  const wrong = ["--glint", GLINT, "--gallery", "/gallery", "--results", scratch, "ring"];
  assert.equal(spawnSync("node", [SCRIPT, ...wrong]).status, 2);
} finally {
  rmSync(scratch, { recursive: true });
}
