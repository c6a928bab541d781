// SPDX-License-Identifier: GPL-3.0-or-later
//
// Part of rooms.mjs: the rooms and halls of a source tree, and the list of violations.
import { readFileSync, readdirSync } from "node:fs";
import path from "node:path";

export const MAP = "CONTRIBUTING.md";
// Whatever else lies in the root folder (build folders, environments) is none of the sources.
export const TOP = ["core", "simulator", "defects", "metrics", "optimizer", "hardware", "studies", "cli"];
export const SKIPPED = new Set(["node_modules"]);
const NO_ROOMS = new Set(["tests"]);

export const violations = [];

export function report(file, line, text) {
  violations.push({ file, line, text });
}

export function hallOf(folder) {
  const parts = folder.split("/");
  return parts.slice(0, parts[0] === "simulator" ? 2 : 1).join("/");
}

/// "simulator/render" -> "render"
export function hallName(hall) {
  return path.posix.basename(hall);
}

/// "simulator/render/wall" -> "wall"; empty for the hall's own folder
export function nameInHall(folder) {
  return folder.slice(hallOf(folder).length + 1);
}

/// "simulator/render/wall" -> "render/wall"
export function shortName(folder) {
  return path.posix.join(hallName(hallOf(folder)), nameInHall(folder));
}

export function targetOf(folder) {
  return `glint::${shortName(folder).replaceAll("/", "::")}`;
}

/// All folders with C++ files, tests included: folder -> { headers, sources }, sorted.
function readFolders(root, folder = "", folders = new Map()) {
  const entries = readdirSync(path.join(root, folder), { withFileTypes: true });
  entries.sort((a, b) => (a.name < b.name ? -1 : 1));
  const named = (end) =>
    entries.filter((e) => e.isFile() && e.name.endsWith(end)).map((e) => e.name);
  const [headers, sources] = [named(".h"), named(".cpp")];
  if (folder !== "" && headers.length + sources.length > 0) {
    folders.set(folder, { headers, sources });
  }
  const isWanted = (name) =>
    folder === "" ? TOP.includes(name) || NO_ROOMS.has(name) : !SKIPPED.has(name);
  for (const entry of entries) {
    if (entry.isDirectory() && isWanted(entry.name)) {
      readFolders(root, path.posix.join(folder, entry.name), folders);
    }
  }
  return folders;
}

/// What all checks look at.
export function readTree(root) {
  const folders = readFolders(root);
  const rooms = [...folders.keys()].filter((folder) => !NO_ROOMS.has(folder.split("/")[0]));
  const halls = [...new Set(rooms.map(hallOf))];
  const texts = new Map();
  for (const room of rooms) {
    const { headers, sources } = folders.get(room);
    for (const name of [...headers, ...sources]) {
      texts.set(`${room}/${name}`, readFileSync(path.join(root, room, name), "utf8"));
    }
  }
  return { root, folders, rooms, halls, texts };
}

export function readOptional(root, file) {
  try {
    return readFileSync(path.join(root, file), "utf8");
  } catch {
    return undefined;
  }
}

/// Includes of other rooms: { file, line, target, from, to }, from and to being rooms.
export function findIncludes(tree) {
  const tops = new Set([...tree.folders.keys()].map((folder) => folder.split("/")[0]));
  const includes = [];
  for (const [file, text] of tree.texts) {
    const from = path.posix.dirname(file);
    text.split("\n").forEach((code, i) => {
      const target = /^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]/.exec(code)?.[1];
      // What is not written from the root is check.sh's business.
      if (!target?.includes("/") || !tops.has(target.split("/")[0])) {
        return;
      }
      const to = path.posix.dirname(target);
      if (!tree.rooms.includes(to)) {
        report(file, i + 1, `includes "${target}", which lies in no room`);
      } else if (to !== from) {
        includes.push({ file, line: i + 1, target, from, to });
      }
    });
  }
  return includes;
}

/// from -> to -> the first include that makes the arrow; `node` gives the ends of an include.
export function arrowsOf(includes, node = (folder) => folder) {
  const arrows = new Map();
  for (const include of includes) {
    const [from, to] = [node(include.from), node(include.to)];
    if (from !== to) {
      arrows.set(from, arrows.get(from) ?? new Map());
      arrows.get(from).set(to, arrows.get(from).get(to) ?? include);
    }
  }
  return arrows;
}
