// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node kinematics_factor_test.mjs
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const FACTOR = join(dirname(fileURLToPath(import.meta.url)), "kinematics_factor.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_kinematics_factor_test_"));

/// The end of the program on these rows: name -> microseconds a pose.
function runOn(times) {
  const file = join(scratch, "cell.json");
  const rows = Object.entries(times).map(([name, us]) => ({
    name: `cell/inverse/${name}`,
    us_a_pose: us,
  }));
  writeFileSync(file, rows.length === 0 ? "" : JSON.stringify({ benchmarks: rows }));
  return spawnSync("node", [FACTOR, file], { encoding: "utf8" });
}

try {
  const fast = runOn({ closed_form: 2, kdl_lma: 60 });
  assert.equal(fast.status, 0);
  assert.match(fast.stdout, /closed form: 30\.0, at least 30/);
  assert.equal(runOn({ closed_form: 2, kdl_lma: 59.8 }).status, 1);
  assert.equal(runOn({ closed_form: 2 }).status, 1);
  assert.equal(runOn({ kdl_lma: 60 }).status, 1);
  assert.equal(runOn({}).status, 0);
  assert.equal(runOn({ other: 1 }).status, 0);
} finally {
  rmSync(scratch, { recursive: true });
}
