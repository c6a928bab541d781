// SPDX-License-Identifier: GPL-3.0-or-later
//
// What hidden.toml of the gallery's robot_cell hides, and what follows from it.
import { readFileSync } from "node:fs";
import path from "node:path";

const OBJECT_PX_MM = 0.05; // of pictures 1224 px wide
const WORKING_DISTANCE_MM = 180;
const CORNERS_MM = [[-24, -18], [24, -18], [24, 18], [-24, 18]];
const PLACES = 50; // along an edge
const DRAWN_MM = [0, 50, 30]; // the camera on the flange, not turned

const read = (source, name) => readFileSync(path.join(source, "studies/gallery/robot_cell", name), "utf8");

/// The value of `key = ...` in the hidden file: a number or some.
export function hidden(source, key) {
  return JSON.parse(new RegExp(`^${key} = (.*)$`, "m").exec(read(source, "hidden.toml"))[1]);
}

/// Rotation matrix, rows, of a rotation vector in rad (Rodrigues).
export function rotation(v) {
  const angle = Math.hypot(...v);
  const [x, y, z] = v.map((component) => component / (angle || 1));
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const t = 1 - c;
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}

/// The angle between two rotations, degrees. Of rotation vectors in rad.
export function angleBetween_deg(a, b) {
  const [first, second] = [rotation(a), rotation(b)];
  let trace = 0;
  for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) trace += first[k][i] * second[k][i];
  return (Math.acos(Math.min(1, (trace - 1) / 2)) * 180) / Math.PI;
}

/// Of the hidden camera on the flange, a rotation vector.
export const hiddenTurn_rad = (source) => hidden(source, "camera_rotation_deg").map((angle) => (angle * Math.PI) / 180);

const less = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const unit = (a) => a.map((x) => x / Math.hypot(...a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/// Position, direction and up of each view of the study.
function views(source) {
  const found = read(source, "study.toml").matchAll(
    /\[\[viewpoint\]\]\s*position_mm = (.*)\s*direction = (.*)\s*up = (.*)/g);
  return [...found].map((match) => match.slice(1).map((text) => JSON.parse(text)));
}

/// From the camera of the drawing to the hidden one, which the flange takes along.
function hiddenCamera(source) {
  const turn = rotation(hiddenTurn_rad(source));
  const shift = less(hidden(source, "camera_position_mm"), DRAWN_MM);
  return (point) => [0, 1, 2].map((i) => dot(turn.map((row) => row[i]), less(point, shift)));
}

/// Distance of the plate's edges in the hidden camera's pictures from where the drawing has them,
/// along the edges' normals, mean over all views [px]: pinhole cameras, the hidden p1 and p2.
export function predictedOffset_px(source, width_px) {
  const focal_px = (WORKING_DISTANCE_MM / OBJECT_PX_MM) * (width_px / 1224);
  const [p1, p2] = [hidden(source, "p1"), hidden(source, "p2")];
  const inHidden = hiddenCamera(source);
  const drawn = ([x, y, z]) => [(focal_px * x) / z, (focal_px * y) / z];
  const seen = (point) => {
    const [x, y, z] = inHidden(point);
    const [u, v] = [x / z, y / z];
    const r2 = u * u + v * v;
    return [focal_px * (u + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)),
      focal_px * (v + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v)];
  };
  let [sum, length] = [0, 0];
  for (const [position, direction, up] of views(source)) {
    const right = unit(cross(direction, up));
    const axes = [right, cross(unit(direction), right), unit(direction)];
    const inCamera = (point) => axes.map((axis) => dot(axis, less(point, position)));
    CORNERS_MM.forEach((from, edge) => {
      const to = CORNERS_MM[(edge + 1) % 4];
      const along = less(drawn(inCamera([...to, 0])), drawn(inCamera([...from, 0])));
      const normal = unit([-along[1], along[0]]);
      for (let k = 0; k < PLACES; ++k) {
        const share = (k + 0.5) / PLACES;
        const point = inCamera([...from.map((x, i) => x + share * (to[i] - x)), 0]);
        sum += Math.hypot(...along) * Math.abs(dot(less(seen(point), drawn(point)), normal));
        length += Math.hypot(...along);
      }
    });
  }
  return sum / length;
}
