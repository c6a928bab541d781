// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node against.mjs --old FOLDER --new FOLDER --results FILE --program NAME...
//                         [FILTER] [--rounds N] [--min_time SECONDS]
//        node against.mjs --check [FILTER] [--rounds N] [--min_time SECONDS]
//
// Compares the rows of benchmark programs of two builds (script/bench --against). Old and new take
// turns, every run a process of its own, so that what disturbs the machine for a while disturbs
// both. A row fails when the one-sided lower 95 % bound of its median ratio new/old is above
// 1.03. FILE keeps the rounds: the same command goes on where it was interrupted.
// --check only checks the options. Exit code 0 when no row fails, 1 when one does, 2 when nothing
// can be compared.
import { spawn, spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import {
  existsSync,
  mkdtempSync,
  readFileSync,
  realpathSync,
  renameSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { constants, tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

export const LIMIT = 1.03;
const CONFIDENCE = 0.95;
const MAX_ROUNDS = 1000;
const INTERRUPTS = ["SIGINT", "SIGTERM", "SIGHUP"];

// What keeps the whole comparison from being made; of one row, it is a BenchmarkError.
class UsageError extends Error {}
class BenchmarkError extends Error {}

// ---- Statistics

// P(Binomial(n, 1/2) <= k)
function binomialHalf(n, k) {
  let term = 0.5 ** n;
  let sum = 0;
  for (let i = 0; i <= k; ++i) {
    sum += term;
    term *= (n - i) / (i + 1);
  }
  return sum;
}

// The largest k for which the k-th smallest of n values (from 1) lies below the median of their
// distribution with 95 % confidence; 0 when there is none. It lies above only if fewer than k
// values lie below the median, and each does with probability 1/2, whatever the distribution.
export function boundIndex(n) {
  let k = 0;
  while (k < n && binomialHalf(n, k) <= 1 - CONFIDENCE) {
    ++k;
  }
  return k;
}

// Fewer rounds have no such k: even their smallest ratio lies above the median too often.
export function fewestRounds() {
  let n = 1;
  while (boundIndex(n) < 1) {
    ++n;
  }
  return n;
}

const sorted = (values) => [...values].sort((a, b) => a - b);

function median(values) {
  const inOrder = sorted(values);
  const middle = Math.floor(inOrder.length / 2);
  return inOrder.length % 2 === 1 ? inOrder[middle] : (inOrder[middle - 1] + inOrder[middle]) / 2;
}

export function judge(ratios) {
  const inOrder = sorted(ratios);
  const k = boundIndex(ratios.length);
  const lower = inOrder[k - 1];
  const upper = inOrder[ratios.length - k];
  const verdict = lower > LIMIT ? "slower" : upper < 1 / LIMIT ? "faster" : "ok";
  return { ratio: median(ratios), lower, upper, verdict };
}

// ---- One run of one row

const MS_PER_UNIT = { ns: 1e-6, us: 1e-3, ms: 1, s: 1e3 };

// Rows whose time is wall time: those that say so in their names, and those whose work is done by
// several threads, as the CPU time is that of one.
function usesRealTime(name) {
  return /\/(real|manual)_time(\/|$)/.test(name) || /^two_threads(\/|$)/.test(name);
}

// Milliseconds from what Google Benchmark wrote about one row.
export function figureOf(text, name) {
  let runs;
  try {
    // Google Benchmark writes counters as they are, JSON knows no such numbers.
    runs = JSON.parse(text.replace(/: (NaN|-?Infinity)(?=,?$)/gm, ": null")).benchmarks;
  } catch {
    throw new BenchmarkError("wrote no JSON");
  }
  runs = (runs ?? []).filter((run) => run.run_type !== "aggregate");
  const wrong = runs.find((run) => run.error_occurred || run.error_message !== undefined);
  if (wrong !== undefined) {
    throw new BenchmarkError(wrong.error_message || "says that an error occurred");
  }
  const key = usesRealTime(name) ? "real_time" : "cpu_time";
  const times_ms = runs.map((run) => run[key] * MS_PER_UNIT[run.time_unit]);
  if (times_ms.length === 0 || !times_ms.every((time) => time > 0 && Number.isFinite(time))) {
    throw new BenchmarkError("gives no time");
  }
  return median(times_ms);
}

// Only what Google Benchmark's regular expressions (POSIX, extended) treat specially.
const exactly = (name) => `^${name.replace(/[.[\\()*+?{|^$]/g, "\\$&")}$`;

let scratch; // the folder of the program's output
let running; // the benchmark's process

function cleanUp() {
  running?.kill("SIGTERM");
  if (scratch !== undefined) {
    rmSync(scratch, { recursive: true, force: true });
  }
}

function interrupt(signal) {
  console.error("\ninterrupted; the same command goes on after the last whole round");
  process.exit(128 + constants.signals[signal]);
}

function runOnce(program, name, minTime) {
  const file = join(scratch, "row.json");
  rmSync(file, { force: true });
  const options = [
    `--benchmark_filter=${exactly(name)}`,
    `--benchmark_min_time=${minTime}`,
    `--benchmark_out=${file}`,
    "--benchmark_out_format=json",
  ];
  return new Promise((resolve, reject) => {
    let complaint = "";
    running = spawn(program, options, { stdio: ["ignore", "ignore", "pipe"] });
    running.stderr.on("data", (data) => {
      complaint = (complaint + data).slice(-1000);
    });
    running.on("error", (error) => reject(new BenchmarkError(error.message)));
    running.on("close", (code, signal) => {
      running = undefined;
      if (INTERRUPTS.includes(signal)) {
        interrupt(signal); // Ctrl-C that reached the benchmark first: no fault of its own
      }
      if (code !== 0) {
        const last = complaint.trim().split("\n").pop();
        const end = signal === null ? `exit code ${code}` : `killed by ${signal}`;
        reject(new BenchmarkError(last ? `${end}, ${last}` : end));
      }
      resolve(file);
    });
  }).then((path) => figureOf(existsSync(path) ? readFileSync(path, "utf8") : "", name));
}

// Whatever the second of two runs has of the first, neither version shall always have it.
async function measurePair(row, round, minTime) {
  const start = performance.now();
  const pair = {};
  for (const side of round % 2 === 0 ? ["old", "new"] : ["new", "old"]) {
    try {
      pair[`${side}_ms`] = await runOnce(row[side], row.name, minTime);
    } catch (error) {
      error.message = `${side}: ${error.message}`;
      throw error;
    }
  }
  return { ...pair, seconds: (performance.now() - start) * 1e-3 };
}

// ---- Rows

function listRows(folder, programs, filter) {
  const rows = new Map();
  for (const program of programs) {
    const path = join(folder, program);
    const options = ["--benchmark_list_tests=true", `--benchmark_filter=${filter}`];
    const { status, error, stdout, stderr } = spawnSync(path, options, { encoding: "utf8" });
    if (status !== 0) {
      throw new UsageError(`${path} does not list its rows: ${error?.message ?? stderr.trim()}`);
    }
    for (const name of stdout.split("\n").filter((line) => line !== "")) {
      rows.set(name, path);
    }
  }
  return rows;
}

const sha256 = (path) => createHash("sha256").update(readFileSync(path)).digest("hex");

function commonRows(options) {
  const older = listRows(options.old, options.programs, options.filter);
  const newer = listRows(options.new, options.programs, options.filter);
  const hashes = new Map([...older.values(), ...newer.values()].map((p) => [p, undefined]));
  for (const path of hashes.keys()) {
    hashes.set(path, sha256(path));
  }
  for (const [which, rows, others] of [["old", older, newer], ["new", newer, older]]) {
    const alone = [...rows.keys()].filter((name) => !others.has(name));
    if (alone.length > 0) {
      console.error(`only in the ${which} version, not compared: ${alone.join(", ")}`);
    }
  }
  const names = [...newer.keys()].filter((name) => older.has(name));
  if (names.length === 0) {
    throw new UsageError(`no row that both versions have matches ${options.filter}`);
  }
  const rows = names.map((name) => ({ name, old: older.get(name), new: newer.get(name) }));
  for (const row of rows) {
    row.key = {
      old_sha256: hashes.get(row.old),
      new_sha256: hashes.get(row.new),
      min_time: options.minTime,
    };
  }
  return { rows, hashes };
}

// ---- Kept results: { rows: { name: { old_sha256, new_sha256, min_time, pairs } } }

function readResults(file) {
  if (!existsSync(file)) {
    return { rows: {} };
  }
  try {
    const results = JSON.parse(readFileSync(file, "utf8"));
    return { rows: { ...results.rows } };
  } catch {
    console.error(`${file} cannot be read, beginning anew`);
    return { rows: {} };
  }
}

// Pairs count only for the same two programs: anything else would mix versions.
function takeKept(rows, results, rounds) {
  let count = 0;
  for (const row of rows) {
    const kept = results.rows[row.name];
    const isSame = kept && Object.entries(row.key).every(([key, value]) => kept[key] === value);
    row.pairs = isSame ? kept.pairs : [];
    count += Math.min(row.pairs.length, rounds);
  }
  return count;
}

// Renamed into place, so that whatever happens the file holds whole rounds.
function saveResults(file, results, rows) {
  for (const row of rows) {
    results.rows[row.name] = { ...row.key, pairs: row.pairs };
  }
  const temporary = `${file}.${process.pid}.tmp`;
  writeFileSync(temporary, `${JSON.stringify(results, undefined, 1)}\n`);
  renameSync(temporary, file);
}

// A build that goes on beside the comparison would make one row of two versions.
function checkUnchanged(hashes) {
  for (const [path, hash] of hashes) {
    if (!existsSync(path) || sha256(path) !== hash) {
      throw new UsageError(`${path} was built anew during the comparison`);
    }
  }
}

// ---- Progress, on stderr

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

function secondsLeft(rows, rounds) {
  const seconds = (row) => row.pairs.map((pair) => pair.seconds);
  const all = rows.flatMap(seconds);
  const left = (row) => (row.error ? 0 : Math.max(0, rounds - row.pairs.length));
  const each = (row) => mean(row.pairs.length > 0 ? seconds(row) : all);
  return all.length === 0 ? NaN : rows.reduce((sum, row) => sum + left(row) * each(row), 0);
}

function inWords(seconds) {
  if (Number.isNaN(seconds)) {
    return "time left unknown";
  }
  return seconds < 90 ? `${Math.ceil(seconds)} s left` : `${Math.ceil(seconds / 60)} min left`;
}

function makeProgress(rows, rounds) {
  const clear = () => process.stderr.isTTY && process.stderr.write("\r\x1b[K");
  let last = performance.now();
  return {
    clear,
    // One line, rewritten on a terminal; a line a minute elsewhere.
    show(round, row) {
      const left = inWords(secondsLeft(rows, rounds));
      const text = `round ${round} of ${rounds}, ${left}: ${row.name}`;
      if (process.stderr.isTTY) {
        clear();
        process.stderr.write(text.slice(0, (process.stderr.columns || 80) - 1));
      } else if (performance.now() - last >= 60e3) {
        console.error(text);
        last = performance.now();
      }
    },
  };
}

// ---- The comparison

async function measureRounds(rows, options, progress, save) {
  for (let round = 1; round <= options.rounds; ++round) {
    const missing = rows.filter((row) => !row.error && row.pairs.length < round);
    for (const row of missing) {
      progress.show(round, row);
      try {
        row.pairs.push(await measurePair(row, round, options.minTime));
      } catch (error) {
        if (!(error instanceof BenchmarkError)) {
          throw error;
        }
        row.error = error.message;
        progress.clear();
        console.error(`${row.name} failed, ${row.error}`);
      }
    }
    if (missing.length > 0) {
      save();
    }
  }
}

// Rows without a ratio have failed: they come first, then slower ones, then by ratio.
function compareRows(a, b) {
  const rank = (row) => (row.ratio === undefined ? 2 : row.verdict === "slower" ? 1 : 0);
  return rank(b) - rank(a) || b.ratio - a.ratio || 0;
}

function summaryOf(row, rounds) {
  if (row.error) {
    return { name: row.name, verdict: `failed, ${row.error}` };
  }
  const pairs = row.pairs.slice(0, rounds);
  return {
    name: row.name,
    ...judge(pairs.map((pair) => pair.new_ms / pair.old_ms)),
    old_ms: median(pairs.map((pair) => pair.old_ms)),
    new_ms: median(pairs.map((pair) => pair.new_ms)),
  };
}

function printTable(summaries) {
  const fixed = (value) => (value === undefined ? "-" : value.toFixed(3));
  const time = (value) => (value >= 1000 ? value.toFixed(0) : value?.toPrecision(4) ?? "-");
  const table = [["row", "ratio", "lower", "upper", "old ms", "new ms", "verdict"]];
  for (const row of summaries) {
    const numbers = [row.ratio, row.lower, row.upper].map(fixed);
    table.push([row.name, ...numbers, time(row.old_ms), time(row.new_ms), row.verdict]);
  }
  const widths = table[0].map((_, i) => Math.max(...table.map((cells) => cells[i].length)));
  const last = widths.length - 1;
  for (const cells of table) {
    const padded = cells.map((cell, i) =>
      i === 0 ? cell.padEnd(widths[i]) : i === last ? cell : cell.padStart(widths[i]),
    );
    console.log(padded.join("  "));
  }
}

// The last lines, and the exit code.
function conclude(summaries, rounds) {
  const percent = (part) => (100 * part).toFixed(1);
  const confidence = percent(1 - binomialHalf(rounds, boundIndex(rounds) - 1));
  console.log(`\n${rounds} rounds; lower and upper each hold with ${confidence} % confidence`);
  const bad = summaries.filter((row) => row.verdict === "slower" || row.ratio === undefined);
  const limit = `slower by more than ${percent(LIMIT - 1)} %`;
  if (bad.length === 0) {
    console.log(`none of ${summaries.length} rows is ${limit}`);
    return 0;
  }
  const names = bad.map((row) => row.name).join(", ");
  console.log(`${bad.length} of ${summaries.length} rows failed or ${limit}: ${names}`);
  return 1;
}

// ---- Options

const TEXT = { type: "string" };
const OPTIONS = {
  check: { type: "boolean" },
  old: TEXT,
  new: TEXT,
  results: TEXT,
  program: { type: "string", multiple: true, default: [] },
  rounds: { type: "string", default: "11" },
  // Seconds. Setting a row up takes about a second, so less than this would not save much time.
  min_time: { type: "string", default: "0.1" },
};

export function readOptions(args) {
  let parsed;
  try {
    parsed = parseArgs({ args, options: OPTIONS, allowPositionals: true });
  } catch (error) {
    throw new UsageError(error.message);
  }
  const { values, positionals } = parsed;
  const rounds = Number(values.rounds);
  const fewest = fewestRounds();
  if (!Number.isInteger(rounds) || rounds < fewest || rounds > MAX_ROUNDS) {
    const why = `fewer than ${fewest} cannot give ${100 * CONFIDENCE} % confidence`;
    throw new UsageError(
      `--rounds is a whole number of ${fewest} to ${MAX_ROUNDS}, not "${values.rounds}": ${why}`,
    );
  }
  const minTime = Number(values.min_time);
  if (!(minTime > 0 && minTime <= 60)) {
    throw new UsageError(`--min_time is in seconds, above 0 and up to 60, not ${values.min_time}`);
  }
  if (positionals.length > 1) {
    throw new UsageError(`one FILTER is allowed, not ${positionals.length} of them`);
  }
  return { ...values, programs: values.program, rounds, minTime, filter: positionals[0] ?? "." };
}

async function main(args) {
  const options = readOptions(args);
  if (options.check) {
    return 0;
  }
  if (!options.old || !options.new || !options.results || options.programs.length === 0) {
    throw new UsageError("--old, --new, --results and --program are needed");
  }
  const { rows, hashes } = commonRows(options);
  const results = readResults(options.results);
  const kept = takeKept(rows, results, options.rounds);
  if (kept > 0) {
    const share = `${kept} of ${rows.length * options.rounds} pairs of runs`;
    console.error(`${share} are there from before; to begin anew delete ${options.results}`);
  }
  scratch = mkdtempSync(join(tmpdir(), "glint_against_"));
  process.on("exit", cleanUp);
  INTERRUPTS.forEach((signal) => process.on(signal, interrupt));
  const progress = makeProgress(rows, options.rounds);
  process.on("exit", progress.clear);
  await measureRounds(rows, options, progress, () => {
    checkUnchanged(hashes);
    saveResults(options.results, results, rows);
  });
  progress.clear();
  const summaries = rows.map((row) => summaryOf(row, options.rounds)).sort(compareRows);
  printTable(summaries);
  return conclude(summaries, options.rounds);
}

// Tests import this file.
if (process.argv[1] && realpathSync(process.argv[1]) === fileURLToPath(import.meta.url)) {
  main(process.argv.slice(2)).then(
    (code) => {
      process.exitCode = code;
    },
    (error) => {
      console.error(`bench: ${error instanceof UsageError ? error.message : error.stack}`);
      process.exitCode = 2;
    },
  );
}
