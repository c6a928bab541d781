// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node negative_control.mjs
//
// Gives commands.mjs a page without a fault, and pages with one each, which it must refuse. A shell
// script stands in for the program.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const HERE = path.dirname(fileURLToPath(import.meta.url));
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "glint_docs_"));

/// Exits with its first argument's code where that is a number; writes out/a/run/report.html.
const STAND_IN = `#!/bin/sh
mkdir -p out/a/run && : > out/a/run/report.html
echo "told: $*"
case $1 in [0-9]*) exit "$1" ;; esac
`;

const SOUND = [
  "# Page",
  "```toml named.toml",
  "schema = 1",
  "```",
  "```sh",
  "script/test            # left out",
  "script/run a.toml      # run as glint run",
  "glint run a.toml \\",
  "  --quiet",
  "glint 3                # exit 3",
  "glint part named.toml && cat named.toml",
  "```",
  "The report is `out/a/run/report.html`.",
];

const FAULTS = {
  "a command that fails": [["glint 3                # exit 3", "glint 3"], /README\.md:\d+: glint 3: exit 3/],
  "another code than told": [["# exit 3", "# exit 1"], /exit 3/],
  "a block without a mark": [["```sh", "```"], /README\.md:5: a block without a mark/],
  "a file that is not written": [["report.html`", "figures.csv`"], /names out\/a\/run\/figures\.csv/],
  "a program that is not there": [["glint 3 ", "glnt 3 "], /exit 127/],
};

function follow(lines) {
  const folder = fs.mkdtempSync(path.join(scratch, "page_"));
  const program = path.join(folder, "glint");
  fs.writeFileSync(program, STAND_IN, { mode: 0o755 });
  fs.writeFileSync(path.join(folder, "README.md"), lines.join("\n"));
  const args = [path.join(HERE, "commands.mjs"), program, folder, path.join(folder, "work"), "README.md"];
  return spawnSync(process.execPath, args, { encoding: "utf8" });
}

try {
  const sound = follow(SOUND);
  assert.equal(sound.status, 0, sound.stdout + sound.stderr);
  assert.match(sound.stdout, /4 commands run in \d+ s, 1 left out/);
  assert.match(sound.stdout, /glint run a\.toml --quiet --budget 20s/);
  for (const [name, [[from, to], message]] of Object.entries(FAULTS)) {
    const lines = SOUND.map((line) => line.replace(from, to));
    assert.notDeepEqual(lines, SOUND, name);
    const result = follow(lines);
    assert.equal(result.status, 1, `${name}: ${result.stdout}${result.stderr}`);
    assert.match(result.stdout, message, name);
  }
  console.log(`${Object.keys(FAULTS).length} faults refused`);
} finally {
  fs.rmSync(scratch, { recursive: true });
}
