// SPDX-License-Identifier: GPL-3.0-or-later
//
// Poses for the scripts beside: { r: rows of a rotation, t: mm }, target_from_source.
import { readFileSync } from "node:fs";

/// a after b.
export const multiply = (a, b) => ({
  r: a.r.map((row) => [0, 1, 2].map((k) => row.reduce((sum, x, j) => sum + x * b.r[j][k], 0))),
  t: a.t.map((x, i) => x + a.r[i].reduce((sum, y, j) => sum + y * b.t[j], 0)),
});
export const inverse = ({ r, t }) => {
  const back = [0, 1, 2].map((i) => [0, 1, 2].map((k) => r[k][i]));
  return { r: back, t: back.map((row) => -row.reduce((sum, x, j) => sum + x * t[j], 0)) };
};
/// Axis times angle in rad, mm.
export const poseFromVector = ([x, y, z], t) => {
  const angle = Math.hypot(x, y, z);
  const [a, b, c] = angle > 0 ? [x / angle, y / angle, z / angle] : [0, 0, 1];
  const [s, q] = [Math.sin(angle), 1 - Math.cos(angle)];
  const r = [
    [1 - q * (b * b + c * c), q * a * b - s * c, q * a * c + s * b],
    [q * a * b + s * c, 1 - q * (a * a + c * c), q * b * c - s * a],
    [q * a * c - s * b, q * b * c + s * a, 1 - q * (a * a + b * b)],
  ];
  return { r, t };
};
const vectorDeg = ({ r }) => {
  // By the quaternion, which is well determined for every angle.
  const w = Math.sqrt(Math.max(0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2;
  const part = (i, j, k) =>
    Math.sqrt(Math.max(0, 1 + r[i][i] - r[j][j] - r[k][k])) / 2 * Math.sign(r[k][j] - r[j][k] || 1);
  const axis = [part(0, 1, 2), part(1, 2, 0), part(2, 0, 1)];
  const length = Math.hypot(...axis);
  const angle = (2 * Math.atan2(length, w) * 180) / Math.PI;
  return axis.map((x) => (length > 0 ? (x / length) * angle : 0));
};
/// A table of a scene.
export const poseToml = (table, pose) =>
  `[${table}]\ntranslation_mm = [${pose.t.join(", ")}]\n` +
  `rotation_vector_deg = [${vectorDeg(pose).join(", ")}]\n`;
/// Of a pose in calibration.json.
export const poseOf = (json) => poseFromVector(json.rotation_vector_rad, json.translation_mm);

/// Picture -> pose, of lines `picture, 16 numbers of a matrix row by row`.
export const readPoses = (file) =>
  new Map(
    readFileSync(file, "utf8")
      .trim()
      .split("\n")
      .map((line) => line.split(","))
      .map(([name, ...n]) => {
        const m = n.map(Number);
        return [name, { r: [m.slice(0, 3), m.slice(4, 7), m.slice(8, 11)], t: [m[3], m[7], m[11]] }];
      }),
  );
