// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node studies/gallery/fit_to_board/inputs.mjs [GLINT] [DATA]
//
// Writes what the studies beside include: calibration.toml (of all photographs, by glint calibrate;
// with pixels four times as large), inputs.toml (the sheet, and where the calibration saw it in the robot's
// hand), views_fitted.toml and views_held_out.toml (the robot's poses), ink.png (the
// print) and a mask for each photograph used.
// GLINT is build/release/glint unless told, DATA the folder with img*.png, poses.csv and board.json
// (../shared/data/calibration/board_on_robot). Needs oiiotool; takes about a minute.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { inverse, multiply, poseOf, poseToml, readPoses } from "../calibrate_camera/poses.mjs";
import { reducedCalibration } from "./reduced_calibration.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, "../../..");
const glint = resolve(process.argv[2] ?? join(root, "build/release/glint"));
const data = resolve(process.argv[3] ?? join(root, "../shared/data/calibration/board_on_robot"));

const views = { views_fitted: ["img00", "img12", "img15", "img18"], views_held_out: ["img05", "img10"] };
const squares = [8, 10];
const marginMm = 5; // of paper around the squares, which is not compared: text and tape are on it
const roomMm = 4; // around the paper, for poses that are looked for
const lineMm = 0.25; // printed around the squares
const inkShare = 0.05; // of the paper's reflectance
const texelsPerMm = 10;
const thicknessMm = 1;
const reduction = 4; // pixels of a photograph to one of the scene

const run = (program, args) =>
  execFileSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "inherit"] });

const work = mkdtempSync(join(tmpdir(), "glint_board_"));

/// The first square of a board is dark: seen that way this one has its long side along y.
function calibrate() {
  const board = join(work, "board.toml");
  const { square_mm: square } = JSON.parse(readFileSync(join(data, "board.json"), "utf8"));
  writeFileSync(
    board,
    `[board]\ncols = ${squares[0] - 1}\nrows = ${squares[1] - 1}\nsquare_mm = ${square}\nsetup = "eye_to_hand"\n`,
  );
  const pictures = readdirSync(data)
    .filter((name) => /^img.*\.png$/.test(name))
    .sort()
    .map((name) => join(data, name));
  const out = join(work, "calibration");
  return JSON.parse(
    run(glint, ["calibrate", ...pictures, "--board", board, "--poses", join(data, "poses.csv"), "--out", out,
      "--json", "--quiet"]),
  );
}

/// The print: squares, the first one dark, and the line around them.
function writeInk(squareMm) {
  const [width, height] = squares.map((n) => Math.round((n * squareMm + 2 * marginMm) * texelsPerMm));
  const dark = Math.round(255 * inkShare);
  const texel = (x, y) => {
    const at = [x, y].map((i) => (i + 0.5) / texelsPerMm - marginMm);
    const beyond = Math.max(...at.map((v, k) => Math.max(-v, v - squares[k] * squareMm)));
    if (Math.abs(beyond) <= lineMm / 2) {
      return dark;
    }
    const [col, row] = at.map((v) => Math.floor(v / squareMm));
    return beyond < 0 && (col + row) % 2 === 0 ? dark : 255;
  };
  const texels = Uint8Array.from({ length: width * height }, (_, i) => texel(i % width, Math.floor(i / width)));
  const raw = join(work, "ink.pgm");
  writeFileSync(raw, Buffer.concat([Buffer.from(`P5\n${width} ${height}\n255\n`), texels]));
  run("oiiotool", ["--nosoftwareattrib", raw, "--compression", "zip:9", "-o", join(here, "ink.png")]);
  return [width / texelsPerMm, height / texelsPerMm];
}

/// The sheet on the flange. Its frame has its origin in its middle, +y up the page and +z out of it.
function writeInputs(calibration, sizeMm) {
  const square = calibration.board.square_mm;
  const partFromBoard = {
    r: [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    t: [square * (1 - squares[0] / 2), square * (squares[1] / 2 - 1), thicknessMm / 2],
  };
  const place = multiply(poseOf(calibration.board.pose), inverse(partFromBoard));
  writeFileSync(
    join(here, "inputs.toml"),
    "# By inputs.mjs: the sheet, and where the calibration saw it in the robot's hand.\n" +
      `[part]\nshape = "plate"\nlength_mm = ${sizeMm[0]}\nwidth_mm = ${sizeMm[1]}\nthickness_mm = ${thicknessMm}\n\n` +
      `[material.texture]\ncolour_file = "ink.png"\nencoding = "linear"\nsize_mm = [${sizeMm.join(", ")}]\n\n` +
      poseToml("cell.flange_from_part", place),
  );
}

function writeViews() {
  const poses = readPoses(join(data, "poses.csv"));
  for (const [file, pictures] of Object.entries(views)) {
    const tables = pictures.map(
      (name) => `\n# ${name}.png\n[[viewpoint]]\n${poseToml("viewpoint.base_from_flange", poses.get(`${name}.png`))}`,
    );
    writeFileSync(join(here, `${file}.toml`), `# By inputs.mjs: poses of the robot's flange, of poses.csv.\n${tables.join("")}`);
  }
}

/// Masks of all views of a sheet: pixels that are wholly on it.
function masksOf(views, sizeMm) {
  const scene = join(work, "masks.toml");
  writeFileSync(scene, `schema = 2\ninclude = ["${join(here, "scene.toml")}", "${join(here, `${views}.toml`)}"]\n`);
  const out = join(work, `${views}_${sizeMm[0]}`);
  const sets = ["--set", `part.length_mm=${sizeMm[0]}`, "--set", `part.width_mm=${sizeMm[1]}`];
  run(glint, ["render", scene, "--masks", ...sets, "--out", out, "--quiet"]);
  return (i) => join(out, `view_0${i + 1}`, "part_mask.png");
}

/// Bright where the squares are seen as the calibration says, grey where the paper around them is.
function writeMasks(squareMm) {
  const size = (aroundMm) => squares.map((n) => n * squareMm + 2 * aroundMm);
  for (const [file, pictures] of Object.entries(views)) {
    const [ofSquares, ofPaper] = [0, marginMm + roomMm].map((aroundMm) => masksOf(file, size(aroundMm)));
    for (const [i, name] of pictures.entries()) {
      run("oiiotool", ["--nosoftwareattrib", ofSquares(i), ofPaper(i), "--mulc", "0.5", "--max", "-d", "uint8", "-o",
        join(here, `mask_${name.slice(3)}.png`)]);
    }
  }
}

try {
  const calibration = calibrate();
  const found = readFileSync(join(work, "calibration/calibration.toml"), "utf8");
  writeFileSync(join(here, "calibration.toml"), reducedCalibration(found, reduction));
  writeInputs(calibration, writeInk(calibration.board.square_mm));
  writeViews();
  writeMasks(calibration.board.square_mm);
  console.log(`squares of ${calibration.board.square_mm} mm, ${calibration.prediction_rms_px.toFixed(2)} px rms`);
} finally {
  rmSync(work, { recursive: true, force: true });
}
