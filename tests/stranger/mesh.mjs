// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes as strangers have them: read from STL (binary) and OBJ, turned and scaled at random.
import { createHash } from "node:crypto";
import fs from "node:fs";

/// Uniform numbers in [0, 1) that follow from the seed and the name alone.
export function* numbersOf(seed, name) {
  for (let count = 0; ; ++count) {
    const digest = createHash("sha256").update(`${seed} ${name} ${count}`).digest();
    yield digest.readUInt32BE(0) / 2 ** 32;
  }
}

/// Triangles, nine coordinates each.
export function readMesh(file) {
  return file.endsWith(".obj") ? readObj(fs.readFileSync(file, "utf8")) : readStl(fs.readFileSync(file));
}

function readObj(text) {
  const points = [];
  const triangles = [];
  for (const line of text.split("\n")) {
    const [kind, ...words] = line.trim().split(/\s+/);
    if (kind === "v") {
      points.push(words.slice(0, 3).map(Number));
    } else if (kind === "f") {
      const corners = words.map((word) => points.at(Number(word.split("/")[0]) - (Number(word) < 0 ? 0 : 1)));
      for (let i = 2; i < corners.length; ++i) {
        triangles.push([corners[0], corners[i - 1], corners[i]].flat());
      }
    }
  }
  return triangles;
}

function readStl(bytes) {
  const triangles = [];
  for (let i = 0; i < bytes.readUInt32LE(80); ++i) {
    const at = 84 + 50 * i + 12;
    triangles.push(Array.from({ length: 9 }, (_, k) => bytes.readFloatLE(at + 4 * k)));
  }
  return triangles;
}

/// A rotation drawn evenly from all (Shoemake's quaternion), rows of its matrix.
function rotationFrom(numbers) {
  const [u, v, w] = [numbers.next().value, numbers.next().value, numbers.next().value];
  const turn = 2 * Math.PI;
  const x = Math.sqrt(1 - u) * Math.sin(turn * v);
  const y = Math.sqrt(1 - u) * Math.cos(turn * v);
  const z = Math.sqrt(u) * Math.sin(turn * w);
  const s = Math.sqrt(u) * Math.cos(turn * w);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * s), 2 * (x * z + y * s)],
    [2 * (x * y + z * s), 1 - 2 * (x * x + z * z), 2 * (y * z - x * s)],
    [2 * (x * z - y * s), 2 * (y * z + x * s), 1 - 2 * (x * x + y * y)],
  ];
}

/// The mesh in any pose, its largest side 20 to 200 mm.
export function turned(triangles, numbers) {
  const rotation = rotationFrom(numbers);
  const moved = triangles.map((triangle) =>
    [0, 3, 6].flatMap((at) =>
      rotation.map((row) => row[0] * triangle[at] + row[1] * triangle[at + 1] + row[2] * triangle[at + 2]),
    ),
  );
  const sides = [0, 1, 2].map((axis) => {
    let low = Infinity;
    let high = -Infinity;
    for (const triangle of moved) {
      low = Math.min(low, triangle[axis], triangle[axis + 3], triangle[axis + 6]);
      high = Math.max(high, triangle[axis], triangle[axis + 3], triangle[axis + 6]);
    }
    return high - low;
  });
  const scale = (20 * 10 ** numbers.next().value) / Math.max(...sides);
  return moved.map((triangle) => triangle.map((one) => scale * one));
}

export function writeStl(file, triangles) {
  const bytes = Buffer.alloc(84 + 50 * triangles.length);
  bytes.writeUInt32LE(triangles.length, 80);
  triangles.forEach((triangle, i) => {
    triangle.forEach((one, k) => bytes.writeFloatLE(one, 84 + 50 * i + 12 + 4 * k));
  });
  fs.writeFileSync(file, bytes);
}
