// SPDX-License-Identifier: GPL-3.0-or-later
//
// What docs/inspect.md says that its reader has: folders of pictures of parts, a person's grades of
// them, limits of the classes.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

const SCENE = `[part]
shape = "strip"
length_mm = 60
width_mm = 24
[camera]
width_px = 360
height_px = 180
object_pixel_mm = 0.2
[sensor]
gain = 2
[scan]
positions = 24
[lighting.tunnel]
radius_mm = 120
slot_mm = 0
blocks_view = false
[defects.dent]
x_mm = [5]
y_mm = [2]
height_um = 8
diameter_mm = 2
`;

/// Renders a strip with a dent of that width and keeps its frames alone. Width 0: no dent.
function picturesOf(glint, folder, to, width_mm) {
  const scene = path.join(folder, "strip.toml");
  const out = path.join(folder, "out", "given");
  fs.writeFileSync(scene, SCENE);
  const dent =
    width_mm > 0
      ? [`defects.dent.diameter_mm=${width_mm}`, `defects.dent.height_um=${40 * width_mm}`]
      : ["defects.dent.height_um=0.001"];
  const args = ["render", scene, "--out", out, "--quiet", ...dent.flatMap((one) => ["--set", one])];
  const result = spawnSync(glint, args, { encoding: "utf8" });
  if (result.status !== 0) {
    throw new Error(`the given pictures cannot be made: ${result.stderr}`);
  }
  fs.mkdirSync(path.dirname(path.join(folder, to)), { recursive: true });
  fs.renameSync(path.join(out, "baseline", "sequence"), path.join(folder, to));
  fs.rmSync(out, { recursive: true });
  fs.rmSync(scene);
}

/// parts/a ... parts/f with judged.csv, new/g, and grading.toml, whose limits no part exceeds.
export function writePictures(glint, folder) {
  const grades = { a: "perfect", b: "perfect", c: "acceptable", d: "acceptable", e: "rejected", f: "rejected" };
  const widths_mm = { a: 0, b: 0, c: 1.4, d: 1.5, e: 3, f: 3.2 };
  for (const [name, width_mm] of Object.entries(widths_mm)) {
    picturesOf(glint, folder, `parts/${name}`, width_mm);
  }
  picturesOf(glint, folder, "new/g", 0);
  const lines = Object.entries(grades).map(([name, grade]) => `${name},${grade}`);
  fs.writeFileSync(path.join(folder, "judged.csv"), `part,grade\n${lines.join("\n")}\n`);
  const limits = ["perfect_biggest", "perfect_sum", "acceptable_biggest", "acceptable_sum"];
  const table = (kind) => `[inspection.${kind}]\n${limits.map((key) => `${key} = 1e5\n`).join("")}`;
  fs.writeFileSync(path.join(folder, "grading.toml"), table("holes") + table("scratches"));
}
