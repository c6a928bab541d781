// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node goals_table_test.mjs
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const TABLE = join(dirname(fileURLToPath(import.meta.url)), "goals_table.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_goals_table_test_"));

function runOn(goals) {
  const file = join(scratch, "result.json");
  writeFileSync(file, JSON.stringify({ goals }));
  return spawnSync("node", [TABLE, file], { encoding: "utf8" });
}

try {
  const near = { name: "translation", unit: "mm", found: 0.02, goal: 0.05, is_met: true };
  const far = { name: "focal length", unit: "px", found: 3, goal: 2.5, is_met: false };
  assert.equal(runOn([near]).status, 0);
  const missed = runOn([near, far]);
  assert.equal(missed.status, 1);
  assert.match(missed.stdout, /translation +0\.0200 mm, goal 0\.05\n/);
  assert.match(missed.stdout, /focal length +3\.0000 px, goal 2\.5 MISSED\n/);
} finally {
  rmSync(scratch, { recursive: true });
}
