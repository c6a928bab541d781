// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node stopped_calibration.mjs SOURCE_DIR FOLDER
//
// studies/gallery/robot_cell/loop.sh with a program whose `glint calibrate --cell` ends with exit code
// 1, with a calibration and without one: only with one there is anything to go on with.
import { spawnSync } from "node:child_process";
import { mkdirSync, rmSync, writeFileSync } from "node:fs";
import path from "node:path";

const [source, folder] = process.argv.slice(2);
const program = path.join(folder, "glint");
let failures = 0;

function expect(text, value, wanted) {
  console.log(`${value === wanted ? "ok  " : "FAIL"}  ${text}: ${value}`);
  failures += value === wanted ? 0 : 1;
}

/// Exit code, and whether it says that it goes on.
function loop(out) {
  const ended = spawnSync("bash", [path.join(source, "studies/gallery/robot_cell/loop.sh"), out], {
    env: { ...process.env, GLINT: program, CALIBRATE_ONLY: "1" },
    encoding: "utf8",
  });
  return [ended.status, ended.stdout.includes("going on")];
}

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
writeFileSync(program, '#!/bin/sh\ncase "$1 $2" in "calibrate --cell") exit 1 ;; esac\n', { mode: 0o755 });

const [stoppedCode, stoppedGoesOn] = loop(path.join(folder, "stopped"));
expect("exit code without a calibration", stoppedCode, 1);
expect("goes on without a calibration", stoppedGoesOn, false);

const calibration = path.join(folder, "calibrated/calibrate/calibration");
mkdirSync(calibration, { recursive: true });
writeFileSync(path.join(calibration, "calibration.toml"), "");
const [code, goesOn] = loop(path.join(folder, "calibrated"));
expect("exit code with a calibration", code, 0);
expect("goes on with a calibration", goesOn, true);
process.exit(failures);
