// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node commands.mjs GLINT SOURCE_DIR WORK_DIR [--rules | PAGE...]
//
// Follows the pages for users word for word: runs every command of their blocks marked ```sh, one
// after the other, each page in a folder of its own that holds what a clone holds of what commands
// read. A command must exit 0, or with what its comment says ("# ... exit 1"); where a page
// names files below out/ they must be there in its end. Blocks without a mark are refused: ```sh is
// what a reader types, ```text what is printed. A block ```toml NAME or ```csv NAME is written to the file
// NAME.
//
// What is not run, run in another way, or made shorter stands in the tables below, each with its
// reason; with --rules nothing is run, and a row that nothing on any page needs is refused. Without
// PAGEs: README.md, docs/*.md and the READMEs of the gallery. Exit 1 when something failed, 77 when the meshes that pages name
// are not beside the clone.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

import { writePictures } from "./given.mjs";

const [glint, source, work, ...chosen] = process.argv.slice(2);

const LONGEST_S = 600;

const NOT_RUN = [
  { what: /^script\/test\b/, why: "runs the tests, this one among them" },
  { what: /^script\/bench\b/, why: "builds another preset and measures for minutes" },
  { what: /^apt-get\b/, why: "changes the machine" },
  { what: /^cmake --install\b/, why: "tests/install does it" },
  { what: /\bcpack\b/, why: "tests/install does it" },
];

/// The search is as long as a reader has time for; the rest of what is shorter is more of the same.
const IN_ANOTHER_WAY = [
  { what: /^script\/run\b/, to: "glint run", why: "the build is there" },
  { what: /(\bglint run\b.*) --budget \S+/, to: "$1", why: "20 s are enough to see it run" },
  { what: /(\bglint run\b.*)/, to: "$1 --budget 20s", why: "20 s are enough to see it run" },
  {
    what: /(\bglint run \S*sort_parts\S*)/,
    to: "$1 --set sorting.parts=20 --set sorting.flawless=60 --set sorting.prototype_parts=20 --set sorting.prototype_flawless=20",
    why: "a population is not part of the budget; more parts are more of the same",
  },
  {
    what: /(\bglint run \S*pod\/\S*)/,
    to: "$1 --set pod.levels=6 --set pod.parts=1 --set pod.flawless=60 --set pod.prototype_flawless=60",
    why: "likewise",
  },
  {
    what: /(\bglint render \S*(?:gear_ring|viewpoints)\S*)/,
    to: "$1 --set render.paths.samples=2",
    why: "more samples are less noise",
  },
];

/// What a page says its reader has.
const GIVEN = {
  "docs/inspect.md": { make: writePictures, why: "pictures of the reader's own parts" },
};

const used = new Set();

// --- Pages ---------------------------------------------------------------------------------------

/// Fenced blocks as { line, mark, name, lines }.
function blocksOf(text) {
  const blocks = [];
  let open;
  text.split("\n").forEach((content, i) => {
    if (!content.startsWith("```")) {
      open?.lines.push(content);
    } else if (open) {
      blocks.push(open);
      open = undefined;
    } else {
      const [mark, name] = content.slice(3).trim().split(/\s+/);
      open = { line: i + 1, mark, name, lines: [] };
    }
  });
  return blocks;
}

/// Commands of a block as { line, text, comment }; lines that end in a backslash go on.
function commandsOf(block) {
  const commands = [];
  let begun = "";
  block.lines.forEach((content, i) => {
    const text = begun + content.trim();
    begun = text.endsWith("\\") ? `${text.slice(0, -1).trim()} ` : "";
    if (begun === "" && text !== "" && !text.startsWith("#")) {
      const [, command, comment] = /^(.*?)(?:\s+#\s(.*))?$/.exec(text);
      commands.push({ line: block.line + 1 + i, text: command, comment: comment ?? "" });
    }
  });
  return commands;
}

/// Paths below out/ in `inline code` that are names and no patterns.
function namedFiles(text) {
  const prose = text.replace(/^```[\s\S]*?^```/gm, "");
  const names = [...prose.matchAll(/`(out\/[\w./*-]+)`/g)].map((match) => match[1]);
  return [...new Set(names)].filter((name) => !/[A-Z]/.test(name));
}

// --- Running -------------------------------------------------------------------------------------

function clone(page) {
  const folder = path.join(work, page.replaceAll(/[/.]/g, "_"), "clone");
  fs.rmSync(path.dirname(folder), { recursive: true, force: true });
  fs.mkdirSync(path.join(folder, "build", "release"), { recursive: true });
  for (const name of ["studies", "docs"]) {
    const from = path.join(source, name);
    if (fs.existsSync(from)) {
      fs.cpSync(from, path.join(folder, name), { recursive: true });
    }
  }
  fs.symlinkSync(path.resolve(glint), path.join(folder, "build", "release", "glint"));
  fs.symlinkSync(path.resolve(source, "..", "shared"), path.join(folder, "..", "shared"));
  return folder;
}

/// The command as it is run; undefined: it is not.
function rewritten(text) {
  const left = NOT_RUN.find(({ what }) => what.test(text));
  if (left) {
    used.add(left);
    return undefined;
  }
  let changed = text;
  for (const rule of IN_ANOTHER_WAY) {
    if (rule.what.test(changed)) {
      used.add(rule);
      changed = changed.replace(rule.what, rule.to);
    }
  }
  return changed;
}

function shell(text, folder) {
  const begin = process.hrtime.bigint();
  const result = spawnSync("bash", ["-c", text], {
    cwd: folder,
    encoding: "utf8",
    timeout: LONGEST_S * 1000,
    maxBuffer: 2 ** 28,
    env: { ...process.env, PATH: `${path.join(folder, "build", "release")}:${process.env.PATH}` },
  });
  return { ...result, seconds: Number(process.hrtime.bigint() - begin) / 1e9 };
}

/// How the program may end: 0, or what the comment behind the command says.
function expectedCode(comment) {
  const said = /\bexit(?: code)? (\d+)/.exec(comment);
  return said ? Number(said[1]) : 0;
}

class Follower {
  constructor(page) {
    this.page = page;
    this.folder = clone(page);
    this.failures = [];
    this.counts = { run: 0, left: 0, without_meshes: 0 };
    this.functions = [];
    this.seconds = 0;
  }

  fail(line, text) {
    this.failures.push(`${this.page}:${line}: ${text}`);
  }

  follow() {
    const text = fs.readFileSync(path.join(source, this.page), "utf8");
    const given = GIVEN[this.page];
    if (given) {
      given.make(path.resolve(glint), this.folder);
    }
    for (const block of blocksOf(text)) {
      if (!block.mark) {
        this.fail(block.line, "a block without a mark: ```sh for commands, ```text for others");
      } else if (["toml", "csv"].includes(block.mark) && block.name) {
        fs.writeFileSync(path.join(this.folder, block.name), block.lines.join("\n"));
      } else if (block.mark === "sh") {
        commandsOf(block).forEach((command) => this.run(command));
      }
    }
    if (this.counts.without_meshes === 0) {
      this.check_named(text);
    }
  }

  run({ line, text, comment }) {
    if (/^\w+\(\) \{.*\}$/.test(text)) {
      this.functions.push(text);
      return;
    }
    const command = rewritten(text);
    if (command === undefined) {
      ++this.counts.left;
      return;
    }
    const meshes = [text, ...this.functions].join(" ").includes("../shared/");
    if (meshes && !fs.existsSync(path.join(this.folder, "..", "shared", "data", "meshes"))) {
      ++this.counts.without_meshes;
      return;
    }
    ++this.counts.run;
    const result = shell([...this.functions, command].join("\n"), this.folder);
    this.seconds += result.seconds;
    console.log(`${this.page}:${line}: ${command} (exit ${result.status}, ${result.seconds.toFixed(1)} s)`);
    if (result.status !== expectedCode(comment)) {
      const told = (result.stderr + result.stdout).trim().split("\n").slice(-8).join("\n  ");
      this.fail(line, `${command}: exit ${result.status ?? result.signal}\n  ${told}`);
    }
  }

  check_named(text) {
    for (const name of namedFiles(text)) {
      if (shell(`compgen -G '${name}' > /dev/null`, this.folder).status !== 0) {
        this.fail(0, `names ${name}, which its commands do not write`);
      }
    }
  }
}

function allPages() {
  const docs = fs.existsSync(path.join(source, "docs")) ? fs.readdirSync(path.join(source, "docs")) : [];
  const gallery = path.join(source, "studies", "gallery");
  const studies = fs.existsSync(gallery) ? fs.readdirSync(gallery).sort() : [];
  return [
    "README.md",
    ...docs.filter((name) => name.endsWith(".md")).sort().map((name) => `docs/${name}`),
    ...studies.map((name) => `studies/gallery/${name}/README.md`),
  ];
}

/// Refuses rows that no page needs. @return what is wrong
function unusedRules() {
  for (const page of allPages()) {
    const blocks = blocksOf(fs.readFileSync(path.join(source, page), "utf8"));
    blocks.filter(({ mark }) => mark === "sh").flatMap(commandsOf).forEach(({ text }) => rewritten(text));
    used.add(GIVEN[page]);
  }
  return [...NOT_RUN, ...IN_ANOTHER_WAY, ...Object.values(GIVEN)]
    .filter((rule) => !used.has(rule))
    .map((rule) => `commands.mjs: no page needs the rule ${rule.what ?? "GIVEN"} (${rule.why})`);
}

if (chosen[0] === "--rules") {
  const unused = unusedRules();
  console.log(unused.join("\n"));
  process.exit(unused.length > 0 ? 1 : 0);
}
fs.mkdirSync(work, { recursive: true });
const followed = (chosen.length > 0 ? chosen : allPages()).map((page) => {
  const follower = new Follower(page);
  follower.follow();
  return follower;
});
const failures = followed.flatMap((follower) => follower.failures);
for (const { page, counts, seconds } of followed) {
  if (counts.run + counts.left + counts.without_meshes > 0) {
    console.log(
      `${page}: ${counts.run} commands run in ${seconds.toFixed(0)} s, ${counts.left} left out, ` +
        `${counts.without_meshes} without their meshes`,
    );
  }
}
console.log(failures.join("\n"));
const without = followed.reduce((sum, { counts }) => sum + counts.without_meshes, 0);
process.exit(failures.length > 0 ? 1 : without > 0 ? 77 : 0);
