// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node board_bars.mjs BOARD.json
//
// Prints what looking for a checkerboard costs as a multiple of OpenCV's search in the same run (script/bench
// board): with its fast check where a board is, at most 1; of its classic search where none is, at most 0.2.
// Exit 1 when it costs more, or one of two rows is missing; rows that the filter left out altogether are left
// alone.
import { readFileSync } from "node:fs";

const BARS = [
  ["board", "board_fast_check", 1],
  ["no_board", "no_board_classic", 0.2],
];

const file = process.argv[2];
if (file === undefined) {
  console.error("usage: node board_bars.mjs BOARD.json");
  process.exit(2);
}
// Google Benchmark leaves an empty file when no name matches the filter.
const text = readFileSync(file, "utf8").trim();
const rows = text === "" ? [] : JSON.parse(text).benchmarks;
const timeOf = (name) => rows.find((row) => row.name === name)?.cpu_time;

let isMet = true;
for (const [ours, theirs, most] of BARS) {
  const [own, other] = [timeOf(`find_by_us/${ours}`), timeOf(`find_by_opencv/${theirs}`)];
  if (own === undefined && other === undefined) {
    continue;
  }
  const share = own / other; // NaN when one is missing
  console.log(`find_by_us/${ours} over find_by_opencv/${theirs}: ${share.toFixed(2)}, at most ${most}`);
  isMet &&= share <= most;
}
process.exit(isMet ? 0 : 1);
