// SPDX-License-Identifier: GPL-3.0-or-later
//
// Draws the figures of what counts from where: node docs/images/conventions.mjs writes
// ring_segments.svg, stripes_frame_0.svg and depth_map.svg beside itself. What they show is asserted
// by RingLight.SegmentsAndLedsRunClockwiseFromTheRightOfThePicture,
// Tunnel.StripesOfFrameZeroBeginAtTheOffsetAndMoveAlongX and
// RenderViews.TellDepthAndPositionOfEachPixel.
import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const ink = "#27313a";
const soft = "#6b7680";
const lights = ["#e69f00", "#56b4e9", "#009e73", "#cc79a7"];
const bright = "#e69f00";
const dark = "#4a545d";
const blue = "#0072b2";

const round = (value) => String(Math.round(value * 100) / 100);
const tag = (name, attributes, content = "") => {
  const list = Object.entries(attributes)
    .map(([key, value]) => ` ${key}="${typeof value === "number" ? round(value) : value}"`)
    .join("");
  return content === "" ? `<${name}${list}/>` : `<${name}${list}>${content}</${name}>`;
};
const text = (x, y, words, more = {}) => tag("text", { x, y, ...more }, words);
const line = (x1, y1, x2, y2, more = {}) => tag("line", { x1, y1, x2, y2, stroke: ink, ...more });
const circle = (cx, cy, r, more = {}) => tag("circle", { cx, cy, r, ...more });
const rect = (x, y, width, height, more = {}) => tag("rect", { x, y, width, height, ...more });
const path = (d, more = {}) => tag("path", { d, fill: "none", stroke: ink, ...more });

/// An arrow with a head of its own; markers are not drawn by every viewer.
const arrow = (x1, y1, x2, y2, colour = ink) => {
  const length = Math.hypot(x2 - x1, y2 - y1);
  const [dx, dy] = [(x2 - x1) / length, (y2 - y1) / length];
  const head = [
    [x2, y2],
    [x2 - 9 * dx - 4 * dy, y2 - 9 * dy + 4 * dx],
    [x2 - 9 * dx + 4 * dy, y2 - 9 * dy - 4 * dx],
  ];
  return (
    line(x1, y1, x2 - 6 * dx, y2 - 6 * dy, { stroke: colour, "stroke-width": 1.4 }) +
    tag("polygon", { points: head.map((p) => p.map(round).join(",")).join(" "), fill: colour })
  );
};

const page = (width, height, title, parts) =>
  tag(
    "svg",
    {
      xmlns: "http://www.w3.org/2000/svg",
      viewBox: `0 0 ${width} ${height}`,
      "font-family": "sans-serif",
      "font-size": 12,
      fill: ink,
    },
    ["", tag("title", {}, title), rect(0, 0, width, height, { fill: "#fff" }), ...parts, ""].join("\n"),
  ) + "\n";

/// A point at an angle that runs clockwise from the right, as in a picture with y downwards.
const around = (cx, cy, r, angle) => [cx + r * Math.cos(angle), cy + r * Math.sin(angle)];

const sector = (cx, cy, inner, outer, from, to, fill) => {
  const [a, b] = [around(cx, cy, outer, from), around(cx, cy, outer, to)];
  const [c, d] = [around(cx, cy, inner, to), around(cx, cy, inner, from)];
  const at = (p) => p.map(round).join(" ");
  return path(
    `M${at(a)} A${outer} ${outer} 0 0 1 ${at(b)} L${at(c)} A${inner} ${inner} 0 0 0 ${at(d)} Z`,
    { fill, stroke: "#fff", "stroke-width": 2 },
  );
};

const segmentRing = (cx, cy) => {
  const parts = [];
  for (let k = 0; k < 4; ++k) {
    const from = (k * Math.PI) / 2;
    parts.push(sector(cx, cy, 58, 96, from, from + Math.PI / 2, lights[k]));
    const [x, y] = around(cx, cy, 77, from + Math.PI / 4);
    parts.push(text(x, y + 5, k, { "text-anchor": "middle", "font-size": 15, "font-weight": "bold" }));
  }
  return parts;
};

const ledRing = (cx, cy) => {
  const parts = [circle(cx, cy, 77, { fill: "none", stroke: "#ccd2d7" })];
  for (let i = 0; i < 12; ++i) {
    const angle = (2 * Math.PI * (i + 0.5)) / 12;
    const [x, y] = around(cx, cy, 77, angle);
    parts.push(circle(x, y, 13, { fill: lights[Math.floor((i * 4) / 12)] }));
    parts.push(text(x, y + 4, i, { "text-anchor": "middle" }));
  }
  return parts;
};

const axesOfRing = (cx, cy) => [
  arrow(cx, cy, cx + 46, cy),
  text(cx + 34, cy - 6, "x"),
  arrow(cx, cy, cx, cy + 46),
  text(cx + 6, cy + 42, "y"),
  path(`M${cx + 28} ${cy + 6} A28 28 0 0 1 ${cx + 6} ${cy + 28}`, { stroke: soft }),
  line(cx + 52, cy, cx + 118, cy, { stroke: soft, "stroke-dasharray": "5 3" }),
  text(cx + 102, cy - 6, "0°", { fill: soft }),
];

const barOf = (x, y) => {
  const parts = [];
  for (let k = 0; k < 4; ++k) {
    parts.push(rect(x + 40 * k, y, 38, 22, { fill: lights[k] }));
    parts.push(text(x + 40 * k + 19, y + 16, k, { "text-anchor": "middle", "font-weight": "bold" }));
  }
  return parts.concat([arrow(x, y + 40, x + 46, y + 40), text(x + 34, y + 56, "x")]);
};

const ringSegments = () =>
  page(820, 300, "Segments and LEDs of ring and bar, as the camera sees them", [
    text(20, 24, "As the camera sees them: picture's right is right, its top is up", { "font-size": 14 }),
    text(140, 56, "segments = 4", { "text-anchor": "middle" }),
    ...segmentRing(140, 170),
    ...axesOfRing(140, 170),
    text(390, 56, "leds = 12, segments = 4", { "text-anchor": "middle" }),
    ...ledRing(390, 170),
    ...axesOfRing(390, 170),
    text(630, 56, "bar, segments = 4", { "text-anchor": "middle" }),
    ...barOf(552, 96),
    text(552, 196, "Both count from x towards y: clockwise."),
    text(552, 214, "Segment 0 begins at x, LED 0 stands half"),
    text(552, 232, "a pitch behind it. roll_deg > 0 turns the"),
    text(552, 250, "whole light clockwise."),
  ]);

const stripesFrom = (left, top, width, height, from_mm, mmPerUnit, offset_mm) => {
  const [period_mm, duty] = [16, 0.5];
  const parts = [rect(left, top, width, height, { fill: dark })];
  const to_mm = from_mm + width * mmPerUnit;
  const first = Math.floor((from_mm - offset_mm) / period_mm);
  for (let k = first; offset_mm + k * period_mm < to_mm; ++k) {
    const begin = Math.max(from_mm, offset_mm + k * period_mm);
    const end = Math.min(to_mm, offset_mm + (k + duty) * period_mm);
    if (end > begin) {
      parts.push(
        rect(left + (begin - from_mm) / mmPerUnit, top, (end - begin) / mmPerUnit, height, { fill: bright }),
      );
    }
  }
  return parts;
};

const obliqueStripes = (left, top, width, height, turn) => {
  const [period, middle, half] = [48, left + width / 2, height / 2];
  const parts = [
    tag("clipPath", { id: "wall" }, rect(left, top, width, height)),
    rect(left, top, width, height, { fill: dark }),
  ];
  const along = period / Math.cos(turn);
  const lean = half * Math.tan(turn);
  const polygons = [];
  for (let k = -8; k < 8; ++k) {
    const x = middle + k * along;
    // Up is y > 0, where stripes of a turn > 0 lie further to -x.
    const points = [
      [x - lean, top],
      [x - lean + along / 2, top],
      [x + lean + along / 2, top + height],
      [x + lean, top + height],
    ];
    polygons.push(tag("polygon", { points: points.map((p) => p.map(round).join(",")).join(" "), fill: bright }));
  }
  return parts.concat([tag("g", { "clip-path": "url(#wall)" }, polygons.join(""))]);
};

const stripesFrame0 = () => {
  const [left, unit] = [60, 1 / 3]; // mm per drawing unit
  const at = (x_mm) => left + (x_mm + 40) / unit;
  const tick = (x_mm, y, words) => [
    line(at(x_mm), y, at(x_mm), y + 8),
    text(at(x_mm), y + 22, words, { "text-anchor": "middle" }),
  ];
  return page(760, 402, "Where the stripes stand in frame 0 and which way they move", [
    text(20, 24, "The wall from inside, seen from above: x to the right", { "font-size": 14 }),
    text(left, 50, "frame 0: offset_mm = 4, period_mm = 16, duty = 0.5"),
    ...stripesFrom(left, 60, 240, 34, -40, unit, 4),
    ...tick(0, 94, "0"),
    ...tick(4, 94, ""),
    ...tick(12, 94, "12"),
    ...tick(20, 94, "20"),
    text(at(4), 116, "4", { "text-anchor": "middle" }),
    text(at(40) + 26, 74, "A bright stripe begins at x = offset_mm and is duty x period_mm"),
    text(at(40) + 26, 92, "long. The tunnel's middle stands at x = 0."),
    text(left, 158, "frame 1: step_mm = 4"),
    ...stripesFrom(left, 168, 240, 34, -40, unit, 8),
    ...tick(8, 202, "8"),
    ...tick(16, 202, "16"),
    arrow(at(4), 150, at(8) + 1, 150, blue),
    text(at(40) + 26, 182, "Frame k has moved by k x step_mm towards +x: stripes, LEDs"),
    text(at(40) + 26, 200, "and ends together."),
    text(left, 268, "orientation_deg = 30, unrolled"),
    ...obliqueStripes(left, 278, 240, 90, Math.PI / 6),
    arrow(left - 20, 323, left - 20, 282),
    text(left - 46, 276, "y &gt; 0"),
    arrow(left + 250, 323, left + 292, 323),
    text(left + 282, 316, "x"),
    text(at(40) + 76, 300, "Stripes are lines of equal x cos o + s sin o, with s along the"),
    text(at(40) + 76, 318, "cross-section from its top, positive where y is: a turn o &gt; 0"),
    text(at(40) + 76, 336, "leans them towards -x at positive y. They still move along +x."),
  ]);
};

const depthMap = () => {
  const [cx, cy, ground] = [150, 64, 250];
  const [px, py] = [268, 214];
  return page(760, 300, "Which depth a depth map holds", [
    text(20, 24, "geometry.exr, depth_mm: along the view, not along the ray", { "font-size": 14 }),
    tag("polygon", { points: `40,${ground} 40,240 130,240 ${px - 40},230 ${px},${py} 330,206 330,${ground}`, fill: "#9db4c6", stroke: ink }),
    rect(cx - 13, cy - 32, 26, 20, { fill: "#fff", stroke: ink }),
    rect(cx - 8, cy - 12, 16, 12, { fill: "#fff", stroke: ink }),
    arrow(cx, cy, cx, 236, soft),
    text(cx - 8, 178, "the view, z", { "text-anchor": "end", fill: soft }),
    line(cx, cy, px, py, { stroke: blue, "stroke-width": 1.4 }),
    text(226, 128, "ray of a pixel", { fill: blue }),
    circle(px, py, 3.5, { fill: blue }),
    line(cx + 4, cy, 372, cy, { stroke: soft, "stroke-dasharray": "5 3" }),
    line(px + 6, py, 372, py, { stroke: soft, "stroke-dasharray": "5 3" }),
    arrow(362, (cy + py) / 2, 362, cy + 1),
    arrow(362, (cy + py) / 2, 362, py - 1),
    text(372, (cy + py) / 2 + 4, "depth_mm", { "font-weight": "bold" }),
    text(cx + 18, cy - 10, "pinhole: depth 0"),
    text(480, 84, "The z coordinate in the camera's frame, in mm:"),
    text(480, 102, "a plane across the view has one depth in all"),
    text(480, 120, "pixels. The length of the ray is the depth"),
    text(480, 138, "divided by the cosine of its angle to the view."),
    text(480, 166, "Mean over the pixel's samples on the part,"),
    text(480, 184, "0 beside it. position_mm.x, .y, .z is the"),
    text(480, 202, "same point in the scene's frame."),
  ]);
};

const folder = dirname(fileURLToPath(import.meta.url));
for (const [name, svg] of [
  ["ring_segments.svg", ringSegments()],
  ["stripes_frame_0.svg", stripesFrame0()],
  ["depth_map.svg", depthMap()],
]) {
  writeFileSync(join(folder, name), svg);
}
