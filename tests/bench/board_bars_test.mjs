// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node board_bars_test.mjs
//
// board_bars.mjs passes up to each bar, fails beyond one and where a row is missing, and leaves a run without
// such rows alone.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const BARS = join(dirname(fileURLToPath(import.meta.url)), "board_bars.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_board_bars_test_"));

/// The end of the program on these rows: name -> milliseconds.
function runOn(times) {
  const file = join(scratch, "board.json");
  const rows = Object.entries(times).map(([name, ms]) => ({ name: `find_by_${name}`, cpu_time: ms }));
  writeFileSync(file, rows.length === 0 ? "" : JSON.stringify({ benchmarks: rows }));
  return spawnSync(process.execPath, [BARS, file], { encoding: "utf8" });
}

const board = (own, other) => ({ "us/board": own, "opencv/board_fast_check": other });
const noBoard = (own, other) => ({ "us/no_board": own, "opencv/no_board_classic": other });

try {
  const met = runOn({ ...board(80, 80), ...noBoard(20, 100) });
  assert.equal(met.status, 0);
  assert.match(met.stdout, /board_fast_check: 1\.00, at most 1\n.*no_board_classic: 0\.20, at most 0\.2\n/);
  assert.equal(runOn({ ...board(81, 80), ...noBoard(20, 100) }).status, 1);
  assert.equal(runOn({ ...board(80, 80), ...noBoard(21, 100) }).status, 1);
  assert.equal(runOn({ "us/board": 80 }).status, 1);
  assert.equal(runOn({ "opencv/no_board_classic": 100 }).status, 1);
  assert.equal(runOn(noBoard(20, 100)).status, 0);
  assert.equal(runOn({}).status, 0);
  assert.equal(spawnSync(process.execPath, [BARS]).status, 2);
} finally {
  rmSync(scratch, { recursive: true });
}
