// SPDX-License-Identifier: GPL-3.0-or-later
//
// Part of rooms.mjs: which rooms may ask how a scene is rendered.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import path from "node:path";

import { SKIPPED, hallOf, report } from "./room_tree.mjs";

/// The transport that a scene needs, the kind of its rays and lights, the method of [render] or of a
/// rung. Not what is read off an answer (ComparedMethod::is_noisy: whether pictures have noise) or
/// asked of the user (StarterLight: the light of `glint new`).
const QUESTION = new RegExp(
  [
    "\\b(needs_paths|is_sampled|has_tunnel|is_direct|is_blurred|follows_paths)\\b",
    "\\b(is_surrounding|first_tunnel_group)\\b",
    "[!=]= ?[\\w.>-]*tunnel_name\\b|\\btunnel_name [!=]=",
    "\\blights\\.empty\\(\\)",
    "(?<![A-Za-z])(?:Render)?Method::k\\w+",
    "\\bmethod [!=]= \"\\w+\"",
    "\\b(?:holds_alternative|get_if)<\\w+Settings>",
    "\\bis_same_v<[^>]*Settings>",
    "\\bpath_view_of\\b",
    "\\bcompared_(?:methods|paths)\\([^()]*\\)\\.(?:empty|size)\\(\\)",
    "\\.level ==",
  ].join("|"),
);
/// In the scripts of pages: a method, or what its points are called, against a word, and what is
/// looked up by it. They are told the kind of a method and whether its pictures have noise.
const QUESTION_OF_SCRIPT = new RegExp(
  [
    "\\bmethod\\s*[!=]==?\\s*['\"`]\\w+['\"`]",
    "['\"`]\\w+['\"`]\\s*[!=]==?\\s*[\\w.?]*\\bmethod\\b",
    "\\[[\\w.?]*\\.method\\]",
    "\\b(?:includes|startsWith)\\(['\"`](?:paths|sampled|integrated|closed|blurred|direct)\\b",
  ].join("|"),
);
const HALLS = new Set(["studies", "cli"]);
/// They give all others what follows from the answer.
const ASKING = new Set([
  "studies/definition",
  "studies/definition/ladder",
  "studies/imaging",
  "studies/imaging/blurred",
  "studies/imaging/direct",
  "studies/imaging/places",
  "studies/imaging/sampled",
  "studies/imaging/searched",
]);

/// Paths of the scripts below a folder, relative to the root.
function scriptsBelow(root, folder) {
  if (!existsSync(path.join(root, folder))) {
    return [];
  }
  const entries = readdirSync(path.join(root, folder), { withFileTypes: true });
  return entries.flatMap((entry) => {
    const file = path.posix.join(folder, entry.name);
    if (entry.isDirectory()) {
      return SKIPPED.has(entry.name) ? [] : scriptsBelow(root, file);
    }
    return entry.name.endsWith(".js") ? [file] : [];
  });
}

function checkText(file, text, question) {
  text.split("\n").forEach((code, i) => {
    const found = question.exec(code.replace(/\/\/.*/, ""));
    if (found !== null) {
      const allowed = [...ASKING].join(" and ");
      report(file, i + 1, `asks ${found[0]}: how a scene is rendered is asked in ${allowed} alone`);
    }
  });
}

export function checkQuestions(tree) {
  for (const [file, text] of tree.texts) {
    const room = path.posix.dirname(file);
    if (HALLS.has(hallOf(room)) && !ASKING.has(room)) {
      checkText(file, text, QUESTION);
    }
  }
  for (const file of [...HALLS].flatMap((hall) => scriptsBelow(tree.root, hall))) {
    checkText(file, readFileSync(path.join(tree.root, file), "utf8"), QUESTION_OF_SCRIPT);
  }
}
