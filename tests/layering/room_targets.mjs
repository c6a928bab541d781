// SPDX-License-Identifier: GPL-3.0-or-later
//
// Part of rooms.mjs: what the CMakeLists.txt of a room declares, holds and links.
import { MAP, readOptional, report, targetOf } from "./room_tree.mjs";

const SECTIONS = new Set(["HEADERS", "SOURCES", "PUBLIC", "PRIVATE", "INTERFACE"]);

/// The calls of a command as { name, line, words: [{ word, line, section }] }.
function cmakeCalls(text, command) {
  const code = text.replace(/#[^\n]*/g, "");
  const lineAt = (at) => code.slice(0, at).split("\n").length;
  return [...code.matchAll(new RegExp(`\\b${command}\\s*\\(([^)]*)\\)`, "g"))].map((call) => {
    const begin = call.index + call[0].indexOf("(") + 1;
    let section = "SOURCES";
    const words = [];
    for (const { 0: word, index } of call[1].matchAll(/[^\s"]+/g)) {
      if (SECTIONS.has(word)) {
        section = word;
      } else {
        words.push({ word, line: lineAt(begin + index), section });
      }
    }
    return { name: words.shift()?.word ?? "", line: lineAt(call.index), words };
  });
}

/// What a CMakeLists.txt says of its room: { isProgram, name, line, files, links, more }.
function readTarget(text) {
  const libraries = cmakeCalls(text, "glint_library");
  const programs = cmakeCalls(text, "add_executable");
  const [call, ...more] = [...libraries, ...programs];
  const linked = cmakeCalls(text, "target_link_libraries").flatMap(({ words }) => words);
  return (
    call && {
      isProgram: libraries.length === 0,
      name: libraries.length === 0 ? call.name : `glint::${call.name}`,
      line: call.line,
      // Generated files come with the path of a variable.
      files: call.words.filter(({ word }) => !word.includes("${")),
      links: [...call.words, ...linked].filter(({ word }) => word.startsWith("glint::")),
      more,
    }
  );
}

function checkName(file, target, room, row) {
  const wanted = target.isProgram ? target.name : targetOf(room);
  if (target.name !== wanted) {
    report(file, target.line, `declares ${target.name}, must be ${wanted}`);
  }
  if (row !== undefined && row.target !== wanted) {
    report(MAP, row.line, `${room}/ has the target ${row.target}, must be ${wanted}`);
  }
}

function checkFiles(file, target, { headers, sources }) {
  const check = (section, wanted, allowed) => {
    const listed = target.files.filter((w) => w.section === section);
    for (const { word, line } of listed.filter((w) => !allowed.includes(w.word))) {
      report(file, line, `${section} lists ${word}, which is no such file of this folder`);
    }
    for (const name of wanted.filter((n) => !listed.some((w) => w.word === n))) {
      report(file, target.line, `${section} lacks ${name}`);
    }
  };
  // Nobody includes a program's headers, so it need not list them.
  check("HEADERS", target.isProgram ? [] : headers, headers);
  check("SOURCES", sources, target.isProgram ? [...headers, ...sources] : sources);
}

function checkSuperfluous(file, target, tree, room, includes) {
  const included = new Set(includes.map(({ to }) => targetOf(to)));
  for (const { word, line } of target.links.filter((link) => !included.has(link.word))) {
    const isTarget = tree.rooms.some((other) => other !== room && targetOf(other) === word);
    const fault = isTarget ? "but includes nothing of it" : "which is the target of no other room";
    report(file, line, `links ${word}, ${fault}`);
  }
}

/// @param allowed  includes; what must not be included need not be linked either
function checkMissing(target, room, allowed) {
  const linked = new Set(target.links.map(({ word }) => word));
  for (const include of allowed) {
    const wanted = targetOf(include.to);
    if (!linked.has(wanted)) {
      linked.add(wanted);
      const fault = `but ${room}/CMakeLists.txt does not link ${wanted}`;
      report(include.file, include.line, `includes "${include.target}", ${fault}`);
    }
  }
}

function checkRoom(tree, room, row, includes, allowed) {
  const file = `${room}/CMakeLists.txt`;
  const text = readOptional(tree.root, file);
  const target = readTarget(text ?? "");
  if (text === undefined) {
    report(file, undefined, "is missing");
  } else if (target === undefined) {
    report(file, 1, "declares no target by glint_library() or add_executable()");
  } else {
    target.more.forEach(({ line }) => report(file, line, "declares a second target"));
    checkName(file, target, room, row);
    checkFiles(file, target, tree.folders.get(room));
    checkSuperfluous(file, target, tree, room, includes);
    checkMissing(target, room, allowed);
  }
}

/// @param allowed  those of the includes that the map allows
export function checkTargets(tree, map, includes, allowed) {
  for (const room of tree.rooms) {
    const isFrom = ({ from }) => from === room;
    checkRoom(tree, room, map.get(room), includes.filter(isFrom), allowed.filter(isFrom));
  }
  for (const hall of tree.halls.filter((h) => !tree.rooms.includes(h) && map.has(h))) {
    const { line, target } = map.get(hall);
    if (target !== "-") {
      report(MAP, line, `${hall}/ has the target ${target}, must be - as it holds no files`);
    }
  }
}
