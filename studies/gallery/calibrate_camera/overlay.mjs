// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node studies/gallery/calibrate_camera/overlay.mjs [GLINT] [DATA]
//
// Lays the rendered board over photographs of a real one. Calibrates the set twice, by OpenCV's best
// closed form and by Glint, renders the board at the robot's poses with both cameras and writes
// overlay.jpg beside itself: red is the photograph, cyan the rendering, grey where they agree.
// GLINT is build/release/glint unless told, DATA the folder with img*.png, poses.csv and board.json
// (../shared/data/calibration/board_on_robot). Needs oiiotool; takes about a minute.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { inverse, multiply, poseOf, poseToml, readPoses } from "./poses.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, "../../..");
const glint = resolve(process.argv[2] ?? join(root, "build/release/glint"));
const data = resolve(process.argv[3] ?? join(root, "../shared/data/calibration/board_on_robot"));
const shown = ["img00.png", "img07.png", "img12.png"];
const photoPx = [1920, 1200];
const cropPx = 420;
const tilePx = 280;

const run = (program, args) =>
  execFileSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "inherit"] });

const work = mkdtempSync(join(tmpdir(), "glint_overlay_"));
const pictures = readdirSync(data)
  .filter((name) => /^img.*\.png$/.test(name))
  .sort()
  .map((name) => join(data, name));
// The first square of a board is dark: seen that way this one has its long side along y.
const { cols, rows, square_mm: square } = JSON.parse(readFileSync(join(data, "board.json"), "utf8"));
const board = join(work, "board.toml");
writeFileSync(
  board,
  `[board]\ncols = ${rows}\nrows = ${cols}\nsquare_mm = ${square}\nsetup = "eye_to_hand"\n`,
);

const calibrate = (name, more) =>
  JSON.parse(
    run(glint, ["calibrate", ...pictures, "--board", board, "--poses", join(data, "poses.csv"),
      "--out", join(work, name), "--json", "--quiet", ...more]),
  );

const partFromBoard = () => {
  run(glint, ["calibrate", "--print_board", board, "--out", join(work, "board"), "--quiet"]);
  const text = readFileSync(join(work, "board/board_part.toml"), "utf8");
  const at = /then (\S+) (\S+) (\S+) mm/.exec(text).slice(1).map(Number);
  return { r: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], t: at };
};

const poses = readPoses(join(data, "poses.csv"));

/// Renders the board at the shown pictures' poses; the board is on the flange, the camera beside.
const render = (name, calibration, fromBoard) => {
  const flangeFromPart = multiply(poseOf(calibration.board.pose), inverse(fromBoard));
  const views = shown.map(
    (picture) => "[[viewpoint]]\n" + poseToml("viewpoint.base_from_flange", poses.get(picture)),
  );
  const scene =
    `schema = 2\ninclude = ["${join(work, name, "calibration.toml")}", ` +
    `"${join(work, "board/board_part.toml")}"]\n[sensor]\nblur_px = 0.6\n` +
    `[lighting.environment]\n[render.paths]\nsamples = 16\nmax_reflections = 1\n` +
    poseToml("cell.flange_from_part", flangeFromPart) + views.join("");
  writeFileSync(join(work, `${name}.toml`), scene);
  run(glint, ["render", join(work, `${name}.toml`), "--out", join(work, `${name}_views`), "--quiet"]);
};

/// Where the middle of the board is seen, but for the lens's distortion.
const middlePx = (calibration, picture) => {
  const view = multiply(
    inverse(poseOf(calibration.hand_eye)),
    multiply(poses.get(picture), poseOf(calibration.board.pose)),
  );
  const at = multiply(view, {
    r: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    t: [((rows - 1) * square) / 2, ((cols - 1) * square) / 2, 0],
  }).t;
  const { focal_px: focal, center_px: center } = calibration.intrinsics;
  return [0, 1].map((i) => center[i] + (focal[i] * at[i]) / at[2]);
};

/// A window about a place that stays in the picture.
const crop = (middle, side) => {
  const [left, top] = middle.map((at, i) =>
    Math.round(Math.min(Math.max(at - side / 2, 0), photoPx[i] - side)),
  );
  return `${side}x${side}+${left}+${top}`;
};

const meanGrey = (file, window) =>
  Number(run("oiiotool", [file, "--ch", "0", "--cut", window, "--echo", "{TOP.AVGCOLOR}"]));

/// Both pictures with the same mean on the board, as exposures differ.
const tile = (photo, view, middle, out) => {
  const window = crop(middle, cropPx);
  const inner = crop(middle, 120);
  const gain = view ? meanGrey(photo, inner) / meanGrey(join(view, "image.png"), inner) : 1;
  const grey = (file, more = []) => [file, "--ch", "0", ...more, "--cut", window];
  const rendered = view
    ? [
        ...grey(photo),
        ...grey(join(view, "part_mask.png"), ["--mulc", "-1", "--addc", "1"]), "--mul",
        ...grey(join(view, "image.png"), ["--mulc", String(gain)]), ...grey(join(view, "part_mask.png")), "--mul", "--add",
      ]
    : grey(photo);
  run("oiiotool", [
    ...grey(photo), ...rendered, "--dup", "--chappend", "--chappend", "--chnames", "R,G,B",
    "--resize:filter=lanczos3", `${tilePx}x${tilePx}`, "-d", "uint8", "-o", out,
  ]);
  return out;
};

try {
  const after = calibrate("after", []);
  const [best] = after.methods
    .filter((method) => method.name !== "glint" && !method.failed)
    .sort((a, b) => a.prediction_rms_px - b.prediction_rms_px);
  const before = calibrate("before", ["--method", best.name]);
  const fromBoard = partFromBoard();
  render("before", before, fromBoard);
  render("after", after, fromBoard);
  const tiles = shown.flatMap((picture, i) => {
    const middle = middlePx(after, picture);
    return [null, "before_views", "after_views"].map((views, k) =>
      tile(join(data, picture), views && join(work, views, `view_0${i + 1}`), middle,
        join(work, `tile_${i}_${k}.png`)),
    );
  });
  run("oiiotool", ["--nosoftwareattrib", ...tiles, "--mosaic:pad=4", "3x3", "--compression", "jpeg:88", "-o", join(here, "overlay.jpg")]);
  console.log(`before: ${best.name}, pictures left out are off by ${best.prediction_rms_px.toFixed(2)} px rms`);
  console.log(`after: glint, by ${after.prediction_rms_px.toFixed(2)} px rms`);
} finally {
  rmSync(work, { recursive: true, force: true });
}
