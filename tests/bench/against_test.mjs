// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node against_test.mjs
//
// Tests against.mjs with shell scripts that stand in for benchmark programs, and script/bench
// --against in a small repository whose build writes such scripts. Each check is also given
// copies of against.mjs with a mistake in them and must refuse those.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import {
  appendFileSync,
  chmodSync,
  copyFileSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const HERE = dirname(fileURLToPath(import.meta.url));
const AGAINST = join(HERE, "against.mjs");
const scratch = mkdtempSync(join(tmpdir(), "glint_against_test_"));
process.env.TMPDIR = scratch; // what a killed comparison leaves goes with the rest
let folders = 0;

function newFolder() {
  const folder = join(scratch, `${++folders}`);
  mkdirSync(folder);
  return folder;
}

// Lists the lines of the file NAME.rows beside it; of a row it gives the next word of NAME.times/I
// (I is the number of the row), which is a time in milliseconds or something that goes wrong. The
// other kind of time is always 5. Every run is a line of the file `log`. There are thousands of
// runs: nearly everything is done by the shell itself.
const STAND_IN = `#!/bin/sh
for option; do
  case $option in
    --benchmark_list_tests*) list=yes ;;
    --benchmark_filter=*) filter=\${option#*=} ;;
    --benchmark_out=*) out=\${option#*=} ;;
  esac
done
if [ -n "$list" ]; then
  grep -E -e "$filter" "$0.rows"
  exit 0
fi
row=$(grep -n -E -e "$filter" "$0.rows")
number=\${row%%:*}
name=\${row#*:}
echo "$0 $name" >>"\${0%/*}/../log"
times=$0.times/$number
read -r time others <"$times"
echo "$others $time" >"$times"
error=
key=cpu_time other=real_time
case $name in */real_time | two_threads/*) key=real_time other=cpu_time ;; esac
case $time in
  crash) kill -SEGV $$ ;;
  error) error='"error_occurred": true, "error_message": "blobs differ",' time=0 ;;
  silent) exit 0 ;;
  quits) echo "Sorry" >&2; exit 3 ;;
  stop) kill -TERM $PPID; sleep 5; exit 0 ;;
  die) kill -KILL $PPID; exit 0 ;;
esac
{
  echo '{"context": {}, "benchmarks": ['
  echo "{\\"name\\": \\"$name\\", \\"run_type\\": \\"iteration\\", $error"
  echo "\\"$key\\": $time, \\"$other\\": 5, \\"time_unit\\": \\"ms\\","
  echo '"counter": NaN'
  echo '}]}'
} >"$out"
`;

// rows: { name: [times] }
function writeProgram(folder, rows) {
  const path = join(folder, "glint_bench");
  mkdirSync(`${path}.times`, { recursive: true });
  writeFileSync(path, STAND_IN);
  chmodSync(path, 0o755);
  writeFileSync(`${path}.rows`, Object.keys(rows).map((name) => `${name}\n`).join(""));
  Object.values(rows).forEach((times, i) =>
    writeFileSync(join(`${path}.times`, `${i + 1}`), `${times.join(" ")}\n`),
  );
}

function writePair(older, newer) {
  const folder = newFolder();
  for (const [side, rows] of [["old", older], ["new", newer]]) {
    mkdirSync(join(folder, side));
    writeProgram(join(folder, side), rows);
  }
  return folder;
}

function run(against, folder, ...options) {
  const sides = ["--old", join(folder, "old"), "--new", join(folder, "new")];
  const kept = ["--results", join(folder, "results.json"), "--program", "glint_bench"];
  const done = spawnSync(process.execPath, [against, ...sides, ...kept, ...options], {
    encoding: "utf8",
  });
  return { ...done, text: done.stdout + done.stderr };
}

function expectExit(done, code) {
  assert.equal(done.status, code, done.text);
}

const logOf = (folder) =>
  readFileSync(join(folder, "log"), "utf8")
    .trim()
    .split("\n")
    .map((line) => line.replace(/^.*\/(old|new)\/glint_bench /, "$1 "));

const countRuns = (folder, line) => logOf(folder).filter((other) => other === line).length;
const resultsOf = (folder) => JSON.parse(readFileSync(join(folder, "results.json"), "utf8"));
const verdictOf = (done, row) =>
  done.stdout.split("\n").find((line) => line.startsWith(`${row} `))?.trim().split(/\s{2,}/);

// Mulberry32: the same noise in every run of the test.
function makeRandom(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

// n values spread evenly by +-spread around the middle, in random order.
function noise(random, n, middle, spread) {
  return Array.from({ length: n }, () => middle * (1 + spread * (2 * random() - 1)));
}

// ---- Checks: each takes the path of against.mjs and throws when something is wrong.

const checks = {
  async indexIsThatOfBinomialSums(against) {
    const { boundIndex, fewestRounds } = await import(pathToFileURL(against));
    const choose = (n, k) => (k === 0 ? 1n : (choose(n, k - 1) * BigInt(n - k + 1)) / BigInt(k));
    // P(Binomial(n, 1/2) < k) <= 1/20, in whole numbers.
    const holds = (n, k) => {
      let sum = 0n;
      for (let i = 0; i < k; ++i) {
        sum += choose(n, i);
      }
      return 20n * sum <= 2n ** BigInt(n);
    };
    for (let n = 5; n <= 30; ++n) {
      const k = boundIndex(n);
      assert.ok(k >= 1 && holds(n, k) && !holds(n, k + 1), `index ${k} of ${n}`);
    }
    // By hand: (1 + 11 + 55) / 2048 = 0.033, with 165 more 0.113.
    assert.equal(boundIndex(11), 3);
    // 1/32 = 0.031, 1/16 = 0.0625.
    assert.equal(boundIndex(4), 0);
    assert.equal(fewestRounds(), 5);
  },

  // 3.27 % of the lower ends must lie above the true median: 4000 draws, +-4 sigma of 0.28 %.
  async lowerEndHoldsAsOftenAsItSays(against) {
    const { judge, LIMIT } = await import(pathToFileURL(against));
    const random = makeRandom(1);
    let failed = 0;
    for (let draw = 0; draw < 4000; ++draw) {
      failed += judge(noise(random, 11, LIMIT, 0.2)).verdict === "slower" ? 1 : 0;
    }
    assert.ok(failed / 4000 > 0.0214 && failed / 4000 < 0.044, `${failed} of 4000 fail`);
  },

  equalProgramsPass(against) {
    const rows = { "scan/0": [2], "odd.name+(1)|x/[2]*": [3], "scan/01": [4] };
    const folder = writePair(rows, rows);
    const done = run(against, folder);
    expectExit(done, 0);
    const numbers = ["1.000", "1.000", "1.000", "2.000", "2.000"];
    assert.deepEqual(verdictOf(done, "scan/0"), ["scan/0", ...numbers, "ok"]);
    assert.match(done.stdout, /none of 3 rows is slower by more than 3.0 %/);
    assert.match(done.stdout, /11 rounds; .* 96.7 % confidence/);
    for (const row of Object.keys(rows)) {
      assert.equal(countRuns(folder, `old ${row}`), 11);
      assert.equal(countRuns(folder, `new ${row}`), 11);
    }
    assert.deepEqual(logOf(folder).slice(0, 2), ["new scan/0", "old scan/0"]);
    assert.deepEqual(logOf(folder).slice(6, 8), ["old scan/0", "new scan/0"]);
  },

  slowRowFailsAndIsNamed(against) {
    const random = makeRandom(2);
    const noisy = (middle) => noise(random, 11, middle, 0.03);
    const folder = writePair(
      { fine: noisy(2), slow: noisy(2), quick: noisy(2) },
      { fine: noisy(2), slow: noisy(2.2), quick: noisy(1.8) },
    );
    const done = run(against, folder);
    expectExit(done, 1);
    assert.match(done.stdout, /1 of 3 rows failed or slower by more than 3.0 %: slow$/m);
    const verdicts = ["slow", "fine", "quick"].map((row) => verdictOf(done, row)[6]);
    assert.deepEqual(verdicts, ["slower", "ok", "faster"]);
    assert.match(done.stdout.split("\n")[1], /^slow /, "the worst row comes first");
  },

  noiseAroundEqualityPasses(against) {
    const random = makeRandom(3);
    const rows = () =>
      Object.fromEntries([1, 2, 3, 4].map((i) => [`row/${i}`, noise(random, 11, 2, 0.2)]));
    expectExit(run(against, writePair(rows(), rows())), 0);
  },

  threadedRowsAreJudgedByRealTime(against) {
    const slow = { plain: [2], "jobs2/real_time": [2.2], "two_threads/0": [2.2] };
    const folder = writePair({ plain: [2], "jobs2/real_time": [2], "two_threads/0": [2] }, slow);
    const done = run(against, folder);
    expectExit(done, 1);
    assert.match(done.stdout, /2 of 3 rows failed.*: jobs2\/real_time, two_threads\/0$/m);
  },

  failuresAreNamedAndOthersGoOn(against) {
    const bad = { crashes: ["crash"], errs: ["error"], mute: ["silent"], quits: ["quits"] };
    const good = { crashes: [1], errs: [1], mute: [1], quits: [1], fine: [1], latelyNot: [1] };
    const late = { latelyNot: [1, 1, 1, "crash"] };
    const folder = writePair({ ...good, ...late }, { ...good, ...bad });
    const done = run(against, folder);
    expectExit(done, 1);
    assert.equal(verdictOf(done, "crashes")[6], "failed, new: killed by SIGSEGV");
    assert.equal(verdictOf(done, "errs")[6], "failed, new: blobs differ");
    assert.equal(verdictOf(done, "mute")[6], "failed, new: wrote no JSON");
    assert.equal(verdictOf(done, "quits")[6], "failed, new: exit code 3, Sorry");
    assert.equal(verdictOf(done, "latelyNot")[6], "failed, old: killed by SIGSEGV");
    assert.equal(verdictOf(done, "fine")[6], "ok");
    assert.match(done.stdout, /5 of 6 rows failed/);
    assert.equal(countRuns(folder, "new crashes"), 1, "no second run of what has failed");
  },

  rowsOfOneVersionAreNamed(against) {
    const shared = { both: [1], other: [1] };
    const folder = writePair({ ...shared, gone: [1] }, { ...shared, added: [1] });
    const done = run(against, folder, "both|gone|added");
    expectExit(done, 0);
    assert.match(done.stderr, /only in the old version, not compared: gone$/m);
    assert.match(done.stderr, /only in the new version, not compared: added$/m);
    assert.match(done.stdout, /none of 1 rows/);
  },

  interruptedComparisonGoesOn(against) {
    for (const end of ["stop", "die"]) {
      // In round 4 the second row kills the comparison before it is done.
      const times = [2, 2, 2, end, ...Array(20).fill(2)];
      const folder = writePair({ a: [2], b: times }, { a: [2], b: [2] });
      const killed = run(against, folder);
      assert.ok(killed.status === 143 || killed.signal === "SIGKILL", killed.text);
      assert.equal(killed.stdout, "", "nothing is judged yet");
      assert.ok(existsSync(join(folder, "results.json")), "rounds are kept");
      const kept = resultsOf(folder).rows;
      assert.deepEqual([kept.a.pairs.length, kept.b.pairs.length], [3, 3]);
      const done = run(against, folder);
      expectExit(done, 0);
      assert.match(done.stderr, /6 of 22 pairs of runs are there from before/);
      // Round 4 is run again as a whole.
      assert.equal(countRuns(folder, "old a"), 12);
      assert.equal(countRuns(folder, "old b"), 12);
      const whole = resultsOf(folder).rows;
      assert.deepEqual(whole.a.pairs.slice(0, 3), kept.a.pairs);
      assert.deepEqual([whole.a.pairs.length, whole.b.pairs.length], [11, 11]);
      assert.ok(readdirSync(folder).every((name) => !name.endsWith(".tmp")));
    }
  },

  keptRoundsOfOtherProgramsDoNotCount(against) {
    const folder = writePair({ a: [2] }, { a: [2] });
    expectExit(run(against, folder), 0);
    expectExit(run(against, folder), 0);
    assert.equal(countRuns(folder, "new a"), 11, "the second call has nothing to run");
    expectExit(run(against, folder, "--rounds", "13"), 0);
    assert.equal(countRuns(folder, "new a"), 13, "two rounds more");
    appendFileSync(join(folder, "new", "glint_bench"), "# changed\n");
    expectExit(run(against, folder), 0);
    assert.equal(countRuns(folder, "new a"), 24, "a new program begins anew");
    appendFileSync(join(folder, "old", "glint_bench"), "# changed\n");
    expectExit(run(against, folder), 0);
    assert.equal(countRuns(folder, "new a"), 35, "an old one too");
    expectExit(run(against, folder, "--min_time", "0.2"), 0);
    assert.equal(countRuns(folder, "new a"), 46, "and another length of runs");
  },

  programBuiltMeanwhileStopsIt(against) {
    const folder = writePair({ a: [2] }, { a: [2] });
    const program = join(folder, "new", "glint_bench");
    writeFileSync(program, STAND_IN.replace("error=\n", `error=\necho '# built' >>"$0"\n`));
    const done = run(against, folder);
    expectExit(done, 2);
    assert.match(done.stderr, /new\/glint_bench was built anew during the comparison/);
    assert.ok(!existsSync(join(folder, "results.json")));
  },

  wrongUsageIsTold(against) {
    const folder = writePair({ a: [2] }, { a: [2] });
    const told = [
      [["--rounds", "4"], /--rounds is a whole number of 5 to 1000, not "4"/],
      [["--rounds", "6.5"], /--rounds/],
      [["--min_time", "0"], /--min_time is in seconds/],
      [["--repeats", "3"], /repeats/],
      [["a", "b"], /one FILTER is allowed, not 2/],
      [["nothing"], /no row that both versions have matches nothing/],
      [["--program", "glint_none"], /glint_none does not list its rows/],
    ];
    for (const [options, message] of told) {
      const done = run(against, folder, ...options);
      expectExit(done, 2);
      assert.match(done.stderr, message);
    }
    assert.ok(!existsSync(join(folder, "log")), "nothing was run");
    expectExit(run(against, folder, "--rounds", "5"), 0);
  },
};

// ---- script/bench --against, with a build that only writes stand-ins

// Times come from the file `ms` of the tree that is built.
const COMMON = `root=$(cd "$(dirname "$(readlink -f "\${BASH_SOURCE[0]}")")/.." && pwd)
build_preset() {
  local folder=$root/build/$1/tests/bench program
  echo "built $(basename "$root") \${*:2}" >>"$BUILDS"
  for program in "\${@:2}"; do
    mkdir -p "$folder/$program.times"
    cp "$STAND_IN" "$folder/$program"
    chmod +x "$folder/$program"
    echo "row_of_$program" >"$folder/$program.rows"
    cp "$root/ms" "$folder/$program.times/1"
  done
}
`;

function makeRepository() {
  const root = join(newFolder(), "repository");
  mkdirSync(join(root, "script"), { recursive: true });
  mkdirSync(join(root, "tests/bench"), { recursive: true });
  copyFileSync(join(HERE, "../../script/bench"), join(root, "script/bench"));
  copyFileSync(AGAINST, join(root, "tests/bench/against.mjs"));
  writeFileSync(join(root, "script/common.sh"), COMMON);
  writeFileSync(join(root, "script/bootstrap"), "#!/bin/sh\n");
  chmodSync(join(root, "script/bootstrap"), 0o755);
  writeFileSync(join(root, ".gitignore"), "/build/\n");
  writeFileSync(join(root, "tests/bench/CMakeLists.txt"), "add_executable(glint_bench a.cpp)\n");
  writeFileSync(join(root, "ms"), "2\n");
  return root;
}

// How to call programs in the repository.
function callsIn(root, builds) {
  const standIn = join(root, "../stand_in");
  writeFileSync(standIn, STAND_IN);
  // A hook of git that runs the tests sets variables which would name its own repository.
  const clean = Object.entries(process.env).filter(([name]) => !name.startsWith("GIT_"));
  const env = { ...Object.fromEntries(clean), STAND_IN: standIn, BUILDS: builds };
  const call = (program, ...args) => {
    const done = spawnSync(program, args, { cwd: root, env, encoding: "utf8" });
    return { ...done, text: done.stdout + done.stderr };
  };
  const git = (...args) => {
    const who = ["-c", "user.name=Test", "-c", "user.email=test@example.org"];
    const done = call("git", ...who, ...args);
    expectExit(done, 0);
    return done.stdout.trim();
  };
  return { git, bench: (...args) => call("bash", "script/bench", ...args) };
}

// A commit of 2 ms, and changes to 2.2 ms and one more program that are not committed.
function checkScript() {
  const root = makeRepository();
  const builds = join(root, "../builds");
  const { git, bench } = callsIn(root, builds);
  git("init", "--quiet");
  git("add", ".");
  git("commit", "--quiet", "-m", "old");
  const commit = git("rev-parse", "HEAD");
  const tree = join(root, "build/against", commit.slice(0, 12));
  appendFileSync(join(root, "tests/bench/CMakeLists.txt"), "add_executable(glint_paths_bench p)\n");
  writeFileSync(join(root, "ms"), "2.2\n");

  for (const args of [[], ["no_such_commit"], ["--rounds", "7"], ["HEAD", "--rounds", "2"]]) {
    expectExit(bench("--against", ...args), 2);
  }
  assert.match(bench("--against", "none").stderr, /needs a commit of this repository, "none"/);
  assert.ok(!existsSync(builds), "nothing is built for wrong options");

  const slower = bench("--against", "HEAD", "--rounds", "5");
  expectExit(slower, 1);
  assert.match(slower.stdout, /1 of 1 rows failed or .*: row_of_glint_bench$/m);
  assert.match(slower.stderr, /HEAD has no glint_paths_bench, left out/);
  assert.deepEqual(readFileSync(builds, "utf8").trim().split("\n"), [
    `built ${commit.slice(0, 12)} glint_bench`,
    "built repository glint_bench",
  ]);
  assert.equal(resultsOf(tree).rows.row_of_glint_bench.pairs.length, 5);
  assert.equal(git("status", "--porcelain", "--untracked-files=all").includes("build"), false);

  checkWorktreeIsKept(tree, commit, bench);
  assert.match(bench("--help").stdout, /--against REF [^]*when it cannot be done\.\n$/);
}

// It is used again, and made again when somebody has deleted it.
function checkWorktreeIsKept(tree, commit, bench) {
  const again = bench("--against", commit, "row", "--rounds", "5");
  expectExit(again, 1);
  assert.match(again.stderr, /5 of 5 pairs of runs are there from before/);
  rmSync(tree, { recursive: true });
  expectExit(bench("--against", commit, "--rounds", "5"), 1);
  writeFileSync(join(tree, "ms"), "3\n");
  const edited = bench("--against", commit, "--rounds", "5");
  expectExit(edited, 2);
  assert.match(edited.stderr, /is not as it was checked out, delete it/);
}

// ---- Negative controls: mistakes, and the check that must find each.

const MISTAKES = [
  ["indexIsThatOfBinomialSums", "return k;", "return k + 1;"],
  ["lowerEndHoldsAsOftenAsItSays", "inOrder[k - 1]", "inOrder[k]"],
  ["equalProgramsPass", "exactly(name)}`", "name}`"],
  ["equalProgramsPass", "round % 2 === 0", "true"],
  ["slowRowFailsAndIsNamed", "LIMIT = 1.03", "LIMIT = 1.2"],
  ["slowRowFailsAndIsNamed", "pair.new_ms / pair.old_ms", "pair.old_ms / pair.new_ms"],
  ["noiseAroundEqualityPasses", "lower > LIMIT", "upper > LIMIT"],
  ["threadedRowsAreJudgedByRealTime", 'usesRealTime(name) ? "real_time" :', ""],
  ["failuresAreNamedAndOthersGoOn", "run.error_occurred ||", "false &&"],
  ["failuresAreNamedAndOthersGoOn", "if (code !== 0) {", "if (false) {"],
  ["rowsOfOneVersionAreNamed", "alone.length > 0", "false"],
  ["interruptedComparisonGoesOn", "row.pairs = isSame ? kept.pairs : [];", "row.pairs = [];"],
  ["interruptedComparisonGoesOn", "      save();\n", ""],
  ["keptRoundsOfOtherProgramsDoNotCount", "kept[key] === value", "true"],
  ["programBuiltMeanwhileStopsIt", "    checkUnchanged(hashes);\n", ""],
  ["wrongUsageIsTold", "rounds < fewest", "rounds < 1"],
];

async function checkMistake([check, right, wrong]) {
  const source = readFileSync(AGAINST, "utf8");
  assert.equal(source.split(right).length, 2, `against.mjs has "${right}" once`);
  const copy = join(newFolder(), "against.mjs");
  writeFileSync(copy, source.replace(right, () => wrong));
  // It must be refused for what it does, not as something that cannot run.
  expectExit(spawnSync(process.execPath, [copy, "--check"], { encoding: "utf8" }), 0);
  const refusal = { name: "AssertionError" };
  await assert.rejects(async () => checks[check](copy), refusal, `"${wrong}" is not seen`);
}

async function main() {
  let failed = 0;
  const attempt = async (name, work) => {
    try {
      await work();
      console.log(`ok      ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
  };
  for (const [name, check] of Object.entries(checks)) {
    await attempt(name, () => check(AGAINST));
  }
  await attempt("scriptBuildsBothTrees", checkScript);
  for (const mistake of MISTAKES) {
    await attempt(`${mistake[0]} refuses "${mistake[2].trim()}"`, () => checkMistake(mistake));
  }
  rmSync(scratch, { recursive: true, force: true });
  process.exitCode = failed === 0 ? 0 : 1;
}

await main();
