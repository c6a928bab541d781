// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node evaluations_test.mjs
//
// Tests evaluations.mjs with shell scripts that stand in for glint: they write the CPU time and the
// trials that they are told.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { median, perNight } from "./evaluations.mjs";

const EVALUATIONS = join(dirname(fileURLToPath(import.meta.url)), "evaluations.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_evaluations_test_"));

// A run of four trials that took so many CPU seconds.
function standIn(name, cpuSeconds, lastTrial = "4,0.5", status = 0) {
  const path = join(scratch, name);
  const json = `{"cpu_s": {"search": ${cpuSeconds}, "writing": 99}}`;
  writeFileSync(
    path,
    `#!/bin/sh
while [ "$1" != --out ]; do shift; done
mkdir -p "$2"
printf 'trial,h\\n1,0.1\\n2,0.2\\n3,0.3\\n${lastTrial}\\n' > "$2/trials.csv"
echo '${json}' > "$2/run.json"
echo failed >&2
exit ${status}
`,
  );
  chmodSync(path, 0o755);
  return path;
}

function run(...options) {
  const study = join(scratch, "some_study");
  mkdirSync(study, { recursive: true });
  return spawnSync("node", [EVALUATIONS, ...options, study], { encoding: "utf8" });
}

try {
  assert.equal(median([3, 1, 2]), 2);
  assert.equal(median([4, 1, 2, 3]), 2.5);
  assert.equal(perNight(0.02), 3600000);
  assert.equal(perNight(7), 10300); // 72000 / 7 = 10285.7

  // 2 s over 4 evaluations: 500 ms, 144 000 a night.
  const alone = run("--new", standIn("new", 2), "--rounds", "1");
  assert.equal(alone.status, 0, alone.stderr);
  assert.match(alone.stdout, /^\| some_study \| 500 \| 144000 \|$/m);

  const both = ["--new", standIn("new", 1.2), "--old", standIn("old", 2), "--rounds", "3"];
  const compared = run(...both);
  assert.equal(compared.status, 0, compared.stderr);
  assert.match(compared.stdout, /\| 300 \| 240000 \| 500 \| 0\.600 \| 0\.600 \| 0\.600 \| yes \|/);

  const other = run("--new", standIn("new", 1), "--old", standIn("other", 1, "4,0.6"), "--rounds", "2");
  assert.equal(other.status, 1, "other trials are told");
  assert.match(other.stdout, /\| NO \|/);

  const broken = run("--new", standIn("broken", 1, "4,0.5", 3));
  assert.equal(broken.status, 2);
  assert.match(broken.stderr, /failed/);

  const infeasible = run("--new", standIn("infeasible", 2, "4,0.5", 1), "--rounds", "1");
  assert.equal(infeasible.status, 0, "a search without a feasible design was a search");

  for (const wrong of [["--rounds", "0"], ["--evaluations", "x"], ["--oops", "1"]]) {
    assert.equal(run("--new", standIn("new", 1), ...wrong).status, 2, wrong.join(" "));
  }
  console.log("evaluations.mjs does as it says");
} finally {
  rmSync(scratch, { recursive: true, force: true });
}
