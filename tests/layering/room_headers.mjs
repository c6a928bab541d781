// SPDX-License-Identifier: GPL-3.0-or-later
//
// Part of rooms.mjs: are the functions of x.cpp declared in x.h? Needs universal-ctags.
import { spawnSync } from "node:child_process";

import { report } from "./room_tree.mjs";

/// Of functions, in one line.
const MAX_NAMES = 3;

/// Macros that stand for attributes or nothing: ctags could take them for parts of a type.
export function attributeMacros(texts) {
  const macros = new Set();
  for (const text of texts) {
    const found = text.matchAll(/^#[ \t]*define (\w+)[ \t]*($|inline\b|\[\[|__attribute)/gm);
    [...found].forEach(([, name]) => macros.add(name));
  }
  return [...macros];
}

/// The tags of all files: file -> those of ctags in the order of their lines, each with its `key`,
/// the whole name: "glint::Rng::normal".
function readTags(tree) {
  const options = [
    ...["--options=NONE", "--quiet", "--language-force=C++", "--output-format=json", "--sort=no"],
    ...["--kinds-C++=cfpsu", "--fields=+nsS", "--fields-C++=+{properties}{specialization}"],
    ...attributeMacros(tree.texts.values()).flatMap((name) => ["-D", `${name}=`]),
    ...["-L", "-", "-f", "-"],
  ];
  const input = [...tree.texts.keys()].join("\n");
  const { status, stdout, stderr, error } = spawnSync("ctags", options, {
    cwd: tree.root,
    input,
    maxBuffer: 2 ** 30,
  });
  if (error !== undefined || status !== 0) {
    console.error(`rooms: needs universal-ctags: ${error?.message ?? stderr}`);
    process.exit(2);
  }
  const tags = new Map([...tree.texts.keys()].map((file) => [file, []]));
  const lines = stdout.toString().split("\n");
  for (const line of lines.filter((text) => text.includes('"_type": "tag"'))) {
    const tag = JSON.parse(line);
    tags.get(tag.path).push({ ...tag, key: [tag.scope, tag.name].filter(Boolean).join("::") });
  }
  return tags;
}

function isFunction({ kind }) {
  return kind === "function" || kind === "prototype";
}

/// "const std::vector<int>& values = {}" -> "vector<int>&": what declaration and definition of a
/// parameter have in common.
function typeOf(parameter) {
  return parameter
    .replace(/=.*/, "")
    .replace(/\(.*\)/g, "()")
    .replace(/\b(const|__restrict)\b|\w+ *:: */g, " ")
    .trim()
    .replace(/(?<=[\w>] |[&*]) *(?!(?:int|char|long|short|double)$)\w+$/, "")
    .replaceAll(" ", "");
}

/// "(int a, std::pair<int, int> b = {1, 2})" -> "int,pair<int,int>"
function typesOf(signature) {
  const parameters = [""];
  let depth = 0;
  for (const character of signature.slice(signature.indexOf("(") + 1, signature.lastIndexOf(")"))) {
    depth += "(<[{".includes(character) ? 1 : ")>]}".includes(character) ? -1 : 0;
    if (character === "," && depth === 0) {
      parameters.push("");
    } else {
      parameters[parameters.length - 1] += character;
    }
  }
  return parameters.map(typeOf).join(",");
}

/// The functions with external linkage that a source file defines.
function findDefined(tags) {
  const kinds = new Set(["class", "struct", "union"]);
  const own = tags.filter(({ kind }) => kinds.has(kind)).map(({ key }) => key);
  return tags.filter((tag) => {
    const properties = (tag.properties ?? "").split(",");
    // "A::~A() = default;" counts as a prototype.
    const isDefinition = tag.kind === "function" || properties.includes("default");
    const isHidden = tag.key.includes("__anon") || properties.includes("static");
    const isOfOwnClass = own.some((key) => tag.key.startsWith(`${key}::`));
    return isFunction(tag) && isDefinition && !isHidden && !isOfOwnClass && tag.key !== "main";
  });
}

/// Overloads are told apart by their parameters; operators and specialisations are not, as ctags
/// writes their declarations and definitions differently.
function isDeclared(defined, tags) {
  const isSpecial = defined.name.startsWith("operator") || defined.specialization !== undefined;
  const types = typesOf(defined.signature ?? "");
  return tags
    .filter((tag) => isFunction(tag) && tag.key === defined.key)
    .some(({ signature }) => isSpecial || typesOf(signature ?? "") === types);
}

function nameOf({ key }) {
  return `${key.replace(/^glint::/, "")}()`;
}

function reportLacking(file, header, hasHeader, lacking) {
  if (hasHeader) {
    for (const tag of lacking) {
      report(file, tag.line, `defines ${nameOf(tag)}, which ${header} does not declare`);
    }
    return;
  }
  const names = [...new Set(lacking.map(nameOf))];
  const rest = names.length > MAX_NAMES ? ` and ${names.length - MAX_NAMES} more` : "";
  if (names.length > 0) {
    const shown = names.slice(0, MAX_NAMES).join(", ");
    report(file, undefined, `has no header ${header} for ${shown}${rest}`);
  }
}

/// The tags of a source file with the aliases of its parameters' types replaced: headers spell out
/// what the file has a shorter name for.
function withoutAliases(tags, text) {
  const aliases = [...text.matchAll(/^ *using (\w+) = ([^;]+);/gm)];
  const spellOut = (signature, [, alias, type]) =>
    signature.replace(new RegExp(`\\b${alias}\\b`, "g"), type);
  return tags.map((tag) => ({ ...tag, signature: aliases.reduce(spellOut, tag.signature ?? "") }));
}

export function checkHeaders(tree) {
  const tags = readTags(tree);
  for (const room of tree.rooms) {
    const { headers, sources } = tree.folders.get(room);
    for (const source of sources) {
      const file = `${room}/${source}`;
      const header = source.replace(/\.cpp$/, ".h");
      // The commands of the program share one header.
      const places = room === "cli" ? [header, "commands.h"] : [header];
      const declared = places.flatMap((name) => tags.get(`${room}/${name}`) ?? []);
      const defined = withoutAliases(findDefined(tags.get(file)), tree.texts.get(file));
      const lacking = defined.filter((tag) => !isDeclared(tag, declared));
      reportLacking(file, header, headers.includes(header), lacking);
    }
  }
}
