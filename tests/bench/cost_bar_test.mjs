// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node cost_bar_test.mjs
//
// cost_bar.mjs passes up to the bar, fails beyond it in any row, and leaves a run without such rows alone.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const script = join(dirname(fileURLToPath(import.meta.url)), "cost_bar.mjs");
const folder = mkdtempSync(join(tmpdir(), "cost_bar_"));

function barOf(text) {
  const file = join(folder, "bench.json");
  writeFileSync(file, text);
  return spawnSync(process.execPath, [script, file, "of_embree", "3"], { encoding: "utf8" });
}

const rows = (...costs) => JSON.stringify({ benchmarks: [{ name: "other" }, ...costs.map((cost, i) => ({ name: `row${i}`, of_embree: cost }))] });

try {
  const passed = barOf(rows(2.6, 3));
  assert.equal(passed.status, 0);
  assert.match(passed.stdout, /row0: of_embree 2\.60, at most 3\nrow1: of_embree 3\.00, at most 3\n/);
  assert.equal(barOf(rows(2.6, 3.01)).status, 1);
  assert.equal(barOf(rows()).status, 0);
  assert.equal(barOf("").status, 0);
  assert.equal(spawnSync(process.execPath, [script, "bench.json", "of_embree"]).status, 2);
} finally {
  rmSync(folder, { recursive: true });
}
