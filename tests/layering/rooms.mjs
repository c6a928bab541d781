// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node rooms.mjs [--arrows] [SOURCE_DIR]
//
// Checks that the rooms of the sources are what the module map of CONTRIBUTING.md says: which rooms
// there are, what each may include, what its CMake target holds and links, that the functions of
// x.cpp are declared in x.h, and that only two rooms ask how a scene is rendered. One line per
// violation, `file:line: what is wrong`; exit 1 when there is any. On success one line per hall:
// its rooms, the levels of the longest way down through them, and how many pairs of them see each
// other.
//   --arrows  prints for each room which rooms it includes, to write the map from; checks nothing
//
// A room is a folder with .h or .cpp files directly in it, a hall a top folder or simulator/<x>
// with all rooms below it. Needs universal-ctags.
import path from "node:path";
import { fileURLToPath } from "node:url";

import { checkHeaders } from "./room_headers.mjs";
import { checkQuestions } from "./room_questions.mjs";
import { checkTargets } from "./room_targets.mjs";
import {
  MAP,
  arrowsOf,
  findIncludes,
  hallName,
  hallOf,
  nameInHall,
  readOptional,
  readTree,
  report,
  shortName,
  violations,
} from "./room_tree.mjs";
import { checkTypes } from "./room_types.mjs";

const MAX_SOURCES = 18;

// --- The module map ------------------------------------------------------------------------------

/// The table's rows as { line, cells }, without its head.
function tableRows(text) {
  const lines = text.split("\n").map((content, i) => ({ content, line: i + 1 }));
  const begin = lines.findIndex(({ content }) => content.trim() === "## Module map");
  const section = begin < 0 ? [] : lines.slice(begin + 1);
  const end = section.findIndex(({ content }) => content.startsWith("## "));
  return section
    .slice(0, end < 0 ? undefined : end)
    .filter(({ content }) => content.startsWith("|"))
    .slice(2)
    .map(({ content, line }) => {
      const cells = content.trim().replace(/\|$/, "").split("|").slice(1);
      return { line, cells: cells.map((cell) => cell.replaceAll("`", "").trim()) };
    });
}

/// Room -> { line, target, sees }; what is wrong with a row is reported.
function readMap(tree) {
  const rows = tableRows(readOptional(tree.root, MAP) ?? "");
  if (rows.length === 0) {
    report(MAP, 1, 'has no table under "## Module map"');
  }
  const map = new Map();
  const named = new Set();
  for (const { line, cells } of rows) {
    const room = cells[0].replace(/\/$/, "");
    named.add(room);
    if (cells.length !== 4) {
      report(MAP, line, `has ${cells.length} cells, must be room, target, what it holds, may see`);
    } else if (map.has(room)) {
      report(MAP, line, `${room}/ has a row already, line ${map.get(room).line}`);
    } else if (!tree.rooms.includes(room) && !tree.halls.includes(room)) {
      report(MAP, line, `${room}/ is no folder with .h or .cpp files, nor a hall`);
    } else {
      map.set(room, { line, target: cells[1], sees: [] });
      map.get(room).sees = readSees(tree, room, line, cells[3]);
    }
  }
  for (const room of new Set([...tree.halls, ...tree.rooms])) {
    if (rows.length > 0 && !named.has(room)) {
      report(MAP, undefined, `${room}/ has no row in the module map`);
    }
  }
  return map;
}

/// The names in a cell "may see" as { name, seen, isHall }, seen being a hall or a room.
function readSees(tree, room, line, cell) {
  const sees = [];
  for (const name of cell === "-" ? [] : cell.split(/[\s,]+/).filter((word) => word !== "")) {
    const found = meaningsOf(tree, room, name);
    if (found.length !== 1) {
      report(MAP, line, `${room}/ may see "${name}": ${faultOf(tree, name, found)}`);
    } else if (sees.some(({ seen }) => seen === found[0].seen)) {
      report(MAP, line, `${room}/ may see "${name}": named twice`);
    } else {
      sees.push({ name, ...found[0] });
    }
  }
  return sees;
}

/// What a name in the row of a room may mean: rooms of the same hall, in a hall's row other halls.
/// Whole paths are understood, too.
function meaningsOf(tree, room, name) {
  const hall = hallOf(room);
  const rooms = tree.rooms
    .filter((other) => hallOf(other) === hall && other !== room)
    .filter((other) => [other, nameInHall(other) || hallName(hall)].includes(name));
  const halls = (room === hall ? tree.halls : [])
    .filter((other) => other !== hall)
    .filter((other) => [other, hallName(other)].includes(name));
  return [
    ...rooms.map((seen) => ({ seen, isHall: false })),
    ...halls.map((seen) => ({ seen, isHall: true })),
  ];
}

function faultOf(tree, name, found) {
  if (found.length > 1) {
    return `may be ${found.map(({ seen }) => `${seen}/`).join(" or ")}; write the path`;
  }
  const isHall = tree.halls.some((hall) => [hall, hallName(hall)].includes(name));
  return isHall ? "only the row of a hall names other halls" : "there is no such room";
}

// --- Arrows --------------------------------------------------------------------------------------

/// Returns the includes that the map allows.
function checkArrows(includes, map) {
  const used = new Set();
  const allowed = includes.filter(({ file, line, target, from, to }) => {
    const isSameHall = hallOf(from) === hallOf(to);
    const [viewer, seen] = isSameHall ? [from, to] : [hallOf(from), hallOf(to)];
    const entry = map.get(viewer)?.sees.find((e) => e.seen === seen && e.isHall !== isSameHall);
    used.add(entry);
    // A row that is missing is reported already.
    if (entry === undefined && map.has(viewer)) {
      const arrow = `${shortName(viewer)} must not see ${shortName(seen)}`;
      report(file, line, `includes "${target}": ${arrow}`);
    }
    return entry !== undefined;
  });
  for (const [room, { line, sees }] of map) {
    for (const entry of sees.filter((e) => !used.has(e))) {
      report(MAP, line, `${room}/ may see ${entry.name}, but nothing here includes it`);
    }
  }
  return allowed;
}

/// The shortest way along arrows that leads from a node back to it, without its end.
function shortestCircle(arrows, start) {
  const before = new Map([[start, undefined]]);
  for (const node of before.keys()) {
    for (const next of arrows.get(node)?.keys() ?? []) {
      if (next === start) {
        const circle = [];
        for (let at = node; at !== undefined; at = before.get(at)) {
          circle.unshift(at);
        }
        return circle;
      }
      if (!before.has(next)) {
        before.set(next, node);
      }
    }
  }
  return undefined;
}

function isReachable(arrows, from, to) {
  const seen = new Set([from]);
  for (const node of seen) {
    (arrows.get(node) ?? new Map()).forEach((_, next) => seen.add(next));
  }
  return seen.has(to);
}

/// One circle, a shortest, of each group of nodes that all reach each other.
function findCircles(arrows) {
  const all = [...arrows.keys()].map((node) => shortestCircle(arrows, node));
  const shown = [];
  for (const circle of all.filter(Boolean).sort((a, b) => a.length - b.length)) {
    const isKnown = ([node]) =>
      isReachable(arrows, node, circle[0]) && isReachable(arrows, circle[0], node);
    if (!shown.some(isKnown)) {
      shown.push(circle);
    }
  }
  return shown;
}

function reportCircle(arrows, circle) {
  const steps = circle.map((node, i) => arrows.get(node).get(circle[(i + 1) % circle.length]));
  const names = [...circle, circle[0]].map(shortName).join(" -> ");
  const lines = steps.map(({ file, line, target }) => `\n    ${file}:${line} includes "${target}"`);
  report(steps[0].file, steps[0].line, `is part of the circle ${names}${lines.join("")}`);
}

function checkCircles(includes) {
  const arrows = arrowsOf(includes);
  const circles = findCircles(arrows);
  circles.forEach((circle) => reportCircle(arrows, circle));
  // Rooms of several halls in a circle are a circle of the halls, too: once is enough.
  if (circles.every((circle) => new Set(circle.map(hallOf)).size === 1)) {
    const between = arrowsOf(includes, hallOf);
    findCircles(between).forEach((circle) => reportCircle(between, circle));
  }
}

// --- Sizes and summary ---------------------------------------------------------------------------

function checkSizes(tree) {
  for (const [folder, { sources }] of tree.folders) {
    if (sources.length > MAX_SOURCES) {
      const fault = `holds ${sources.length} .cpp files, at most ${MAX_SOURCES} are allowed`;
      report(folder, undefined, fault);
    }
  }
}

/// The longest way down from a node, counted in nodes; there are no circles.
function levelsBelow(arrows, node) {
  const below = [...(arrows.get(node)?.keys() ?? [])].map((next) => levelsBelow(arrows, next));
  return 1 + Math.max(0, ...below);
}

function counted(count, noun) {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

function printHalls(tree, includes) {
  for (const hall of tree.halls) {
    const inside = includes.filter(({ from, to }) => hallOf(from) === hall && hallOf(to) === hall);
    const arrows = arrowsOf(inside);
    const rooms = tree.rooms.filter((room) => hallOf(room) === hall);
    const levels = Math.max(...rooms.map((room) => levelsBelow(arrows, room)));
    const numArrows = [...arrows.values()].reduce((sum, ends) => sum + ends.size, 0);
    const size = `${counted(rooms.length, "room")} on ${counted(levels, "level")}`;
    console.log(`${hallName(hall)}: ${size}, ${counted(numArrows, "arrow")}`);
  }
}

/// For each room those of its hall, then those of other halls; for each hall the other halls.
function printArrows(tree, includes) {
  const list = (nodes) => (nodes.length === 0 ? "-" : nodes.join(" "));
  const between = arrowsOf(includes, hallOf);
  for (const room of tree.rooms) {
    const seen = [...(arrowsOf(includes).get(room)?.keys() ?? [])].sort();
    const inside = seen.filter((other) => hallOf(other) === hallOf(room));
    const outside = seen.filter((other) => hallOf(other) !== hallOf(room));
    const names = inside.map((other) => nameInHall(other) || hallName(other));
    console.log(`${room}/: ${list(names)} | ${list(outside.map(shortName))}`);
  }
  for (const hall of tree.halls) {
    const seen = [...(between.get(hall)?.keys() ?? [])].map(hallName).sort();
    console.log(`hall ${hall}/: ${list(seen)}`);
  }
}

function printViolations() {
  const place = ({ file, line }) => (line === undefined ? file : `${file}:${line}`);
  violations.sort((a, b) => {
    const byFile = a.file < b.file ? -1 : Number(a.file > b.file);
    return byFile || (a.line ?? 0) - (b.line ?? 0);
  });
  violations.forEach((violation) => console.log(`${place(violation)}: ${violation.text}`));
  console.log(`rooms: ${violations.length} violation(s)`);
}

function main(words) {
  const options = words.filter((word) => word.startsWith("-"));
  const roots = words.filter((word) => !word.startsWith("-"));
  if (roots.length > 1 || options.some((option) => option !== "--arrows")) {
    console.error("usage: node rooms.mjs [--arrows] [SOURCE_DIR]");
    return 2;
  }
  const own = path.dirname(fileURLToPath(import.meta.url));
  const tree = readTree(roots[0] ?? path.join(own, "../.."));
  const includes = findIncludes(tree);
  if (options.length > 0) {
    printArrows(tree, includes);
    return 0;
  }
  const map = readMap(tree);
  const allowed = checkArrows(includes, map);
  checkCircles(includes);
  checkTargets(tree, map, includes, allowed);
  checkHeaders(tree);
  checkQuestions(tree);
  checkTypes(tree);
  checkSizes(tree);
  if (violations.length > 0) {
    printViolations();
    return 1;
  }
  printHalls(tree, includes);
  console.log("rooms: no violation");
  return 0;
}

process.exitCode = main(process.argv.slice(2));
