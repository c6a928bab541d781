// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node tidy_units.mjs BUILD_DIR <FILES
//
// What clang-tidy has to read to see the given sources (a path from the root folder per line): the
// files of BUILD_DIR/compile_commands.json that are among them, or that include some of them because a
// room is compiled in one piece, one per line. A source that no entry compiles is printed on stderr;
// exit 1 then.
import { readFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.join(path.dirname(fileURLToPath(import.meta.url)), "../..");

/// The sources that an entry compiles: what its unity file includes, or itself.
function sourcesOf(file) {
  if (path.basename(path.dirname(file)) !== "Unity") {
    return [file];
  }
  return [...readFileSync(file, "utf8").matchAll(/^#include "(.*)"$/gm)].map(([, name]) => name);
}

const [folder] = process.argv.slice(2);
const wanted = new Set(
  readFileSync(0, "utf8").split("\n").filter(Boolean).map((name) => path.resolve(root, name)),
);
const entries = JSON.parse(readFileSync(path.join(folder, "compile_commands.json"), "utf8"));
const found = new Set();
for (const file of new Set(entries.map((entry) => entry.file))) {
  const sources = sourcesOf(file).filter((name) => wanted.has(name));
  sources.forEach((name) => found.add(name));
  if (sources.length > 0) {
    console.log(file);
  }
}
const missing = [...wanted].filter((name) => !found.has(name));
missing.forEach((name) => console.error(`tidy_units: no command compiles ${path.relative(root, name)}`));
process.exitCode = missing.length > 0 ? 1 : 0;
