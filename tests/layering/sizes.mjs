// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node sizes.mjs [SOURCE_DIR]
//
// Checks how long files and functions are (CONTRIBUTING.md), and prints their median, 95 %, 99 % and
// maximum, and how many lines of tests there are to a line of the sources: of C++, with those in
// other languages (the report's pages, and what drives them), and of code in .cpp files, which is
// neither blank nor comment alone. One line per violation,
// `file:line: what is wrong`; exit 1 when there is any. A function's lines are those from its head to
// its closing brace; functions visit_keys, which list the keys of a table, may be longer. Needs
// universal-ctags.
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

import { attributeMacros } from "./room_headers.mjs";
import { SKIPPED, TOP, readTree } from "./room_tree.mjs";

const MAX_LINES = 60;
const MAX_LINES_OF_FILE = { ".cpp": 450, ".h": 300 };
const OF_ANY_LENGTH = "visit_keys";
const SCRIPTS = [".js", ".mjs", ".css", ".html", ".py", ".sh"];

/// All C++ files, tests included: { file, text, lines }.
function readFiles(root) {
  const names = [...readTree(root).folders].flatMap(([folder, { headers, sources }]) =>
    [...headers, ...sources].map((name) => `${folder}/${name}`),
  );
  return names.map((file) => {
    const text = readFileSync(path.join(root, file), "utf8");
    return { file, text, lines: text.split("\n").length - 1 };
  });
}

/// What is not C++, of tests and sources: { file, lines }.
function readScripts(root) {
  const isWanted = (name) =>
    SCRIPTS.includes(path.extname(name)) && !name.split(path.sep).some((part) => SKIPPED.has(part));
  return [...TOP, "tests"]
    .filter((top) => existsSync(path.join(root, top)))
    .flatMap((top) =>
      readdirSync(path.join(root, top), { recursive: true })
        .filter(isWanted)
        .map((name) => path.posix.join(top, name)),
    )
    .map((file) => {
      const text = readFileSync(path.join(root, file), "utf8");
      return { file, lines: text.split("\n").length - 1 };
    });
}

/// How many lines are neither blank nor comment alone.
function codeLines(text) {
  const withoutBlocks = text.replace(/^[ \t]*\/\*[\s\S]*?\*\/[ \t]*$/gm, "");
  return withoutBlocks.split("\n").filter((line) => !/^\s*(\/\/.*)?$/.test(line)).length;
}

/// The functions of the files, lambdas being lines of theirs: { file, line, name, lines }.
function readFunctions(root, files) {
  const options = [
    ...["--options=NONE", "--quiet", "--language-force=C++", "--output-format=json", "--sort=no"],
    ...["--kinds-C++=f", "--fields=+ne"],
    ...attributeMacros(files.map(({ text }) => text)).flatMap((name) => ["-D", `${name}=`]),
    ...["-L", "-", "-f", "-"],
  ];
  const input = files.map(({ file }) => file).join("\n");
  const { status, stdout, stderr, error } = spawnSync("ctags", options, {
    cwd: root,
    input,
    maxBuffer: 2 ** 30,
  });
  if (error !== undefined || status !== 0) {
    console.error(`sizes: needs universal-ctags: ${error?.message ?? stderr}`);
    process.exit(2);
  }
  const lines = stdout.toString().split("\n");
  return lines
    .filter((line) => line.includes('"_type": "tag"'))
    .map((line) => JSON.parse(line))
    .map(({ path: file, line, end, name }) => ({ file, line, name, lines: end - line + 1 }));
}

function violationsOf(files, functions) {
  const long = files
    .map(({ file, lines }) => ({ file, lines, most: MAX_LINES_OF_FILE[path.extname(file)] }))
    .filter(({ lines, most }) => lines > most)
    .map(
      ({ file, lines, most }) => `${file}:${lines}: has ${lines} lines, at most ${most} are allowed`,
    );
  const longFunctions = functions
    .filter(({ name, lines }) => name !== OF_ANY_LENGTH && lines > MAX_LINES)
    .map(
      ({ file, line, name, lines }) =>
        `${file}:${line}: ${name} has ${lines} lines, at most ${MAX_LINES} are allowed`,
    );
  return [...long, ...longFunctions];
}

function isTest({ file }) {
  return file.startsWith("tests/");
}

/// The smallest of sorted numbers that is not below the given share of them.
function quantile(sorted, share) {
  return sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)] ?? 0;
}

function printRow(name, things) {
  const sorted = things.map(({ lines }) => lines).sort((a, b) => a - b);
  const cells = [0.5, 0.95, 0.99, 1].map((share) => quantile(sorted, share));
  console.log(
    [name.padEnd(22), ...[sorted.length, ...cells].map((cell) => `${cell}`.padStart(8))].join(""),
  );
}

/// @param linesOf  of a file
function printRatio(name, files, linesOf) {
  const sum = (wanted) =>
    files.filter(wanted).reduce((lines, file) => lines + linesOf(file), 0);
  const [tests, sources] = [sum(isTest), sum((file) => !isTest(file))];
  console.log(`tests to sources: ${tests} / ${sources} ${name} = ${(tests / sources).toFixed(2)}`);
}

function printSizes(files, functions, scripts) {
  const heads = ["number", "median", "95 %", "99 %", "longest"];
  console.log(["lines of".padEnd(22), ...heads.map((head) => head.padStart(8))].join(""));
  for (const [name, wanted] of [
    ["sources", (thing) => !isTest(thing)],
    ["tests", isTest],
  ]) {
    printRow(`functions in ${name}`, functions.filter(wanted));
    printRow(`files in ${name}`, files.filter(wanted));
  }
  printRatio("lines", files, ({ lines }) => lines);
  printRatio("lines of all languages", [...files, ...scripts], ({ lines }) => lines);
  const bodies = files.filter(({ file }) => file.endsWith(".cpp"));
  printRatio("lines of code in .cpp files", bodies, ({ text }) => codeLines(text));
}

function main(roots) {
  if (roots.length > 1 || roots.some((word) => word.startsWith("-"))) {
    console.error("usage: node sizes.mjs [SOURCE_DIR]");
    return 2;
  }
  const own = path.dirname(fileURLToPath(import.meta.url));
  const root = roots[0] ?? path.join(own, "../..");
  const files = readFiles(root);
  const functions = readFunctions(root, files);
  printSizes(files, functions, readScripts(root));
  const violations = violationsOf(files, functions);
  violations.forEach((line) => console.log(line));
  console.log(
    violations.length > 0 ? `sizes: ${violations.length} violation(s)` : "sizes: no violation",
  );
  return violations.length > 0 ? 1 : 0;
}

process.exitCode = main(process.argv.slice(2));
