// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node studies/gallery/fit_to_board/figure.mjs RUN [GLINT] [DATA]
//
// Writes fitted.jpg beside itself: for a photograph that was fitted and one that was not the
// photograph, the scene at the start, the scene as found, and what is left of both (photograph minus
// scene, four times as strong, grey is none). RUN is the folder of a run of fit.toml; GLINT is
// build/release/glint unless told, DATA the folder with img*.png
// (../shared/data/calibration/board_on_robot). Needs oiiotool.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, "../../..");
const folder = resolve(process.argv[2] ?? join(root, "out/fit/run"));
const glint = resolve(process.argv[3] ?? join(root, "build/release/glint"));
const data = resolve(process.argv[4] ?? join(root, "../shared/data/calibration/board_on_robot"));
/// Windows of the scene's pixels; view is the number in the file of views.
const shown = [
  { name: "img00", views: "views_fitted", view: 1, window: "120x120+234+50" },
  { name: "img10", views: "views_held_out", view: 2, window: "120x120+358+148" },
];
const sceneSize = "480x300";
const tileSize = "240x240";
const gain = 4;

const run = (program, args) =>
  execFileSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "inherit"] });
const work = mkdtempSync(join(tmpdir(), "glint_figure_"));

/// Renders all views of a file; sets: keys of the scene and their values.
function render(views, name, sets) {
  const scene = join(work, `${views}.toml`);
  writeFileSync(scene, `schema = 2\ninclude = ["${join(here, "scene.toml")}", "${join(here, `${views}.toml`)}"]\n`);
  const out = join(work, `${views}_${name}`);
  const chosen = Object.entries(sets).flatMap(([key, value]) => ["--set", `${key}=${value}`]);
  run(glint, ["render", scene, ...chosen, "--out", out, "--quiet"]);
  return out;
}

/// One row of the figure.
function tiles({ name, views, view, window }, found) {
  const photo = [join(data, `${name}.png`), "--ch", "0", "--resize:filter=box", sceneSize];
  const pictures = [{}, found].map((sets, i) => join(render(views, i === 0 ? "start" : "found", sets), `view_0${view}`));
  // Grey in a mask is not compared.
  const mask = [join(here, `mask_${name.slice(3)}.png`), "--ch", "0", "--subc", "0.75", "--mulc", "100", "--clamp:min=0:max=1"];
  const files = [];
  const write = (args) => {
    files.push(join(work, `${name}_${files.length}.png`));
    run("oiiotool", [...args, "--cut", window, "--resize:filter=box", tileSize, "-d", "uint8", "-o", files.at(-1)]);
  };
  write(photo);
  for (const picture of pictures) {
    write([join(picture, "image.png"), "--ch", "0"]);
  }
  for (const picture of pictures) {
    write([...photo, join(picture, "image.png"), "--ch", "0", "--sub", ...mask, "--mul", "--mulc", String(gain), "--addc", "0.5"]);
  }
  return files;
}

try {
  const { best } = JSON.parse(readFileSync(join(folder, "result.json"), "utf8"));
  const files = shown.flatMap((row) => tiles(row, best.variables));
  run("oiiotool", ["--nosoftwareattrib", ...files, "--mosaic:pad=4", "5x2", "--compression", "jpeg:85", "-o", join(here, "fitted.jpg")]);
} finally {
  rmSync(work, { recursive: true, force: true });
}
