// SPDX-License-Identifier: GPL-3.0-or-later
//
// Part of rooms.mjs: a type's name stands for one type. Two of the same name in one namespace
// compile and link, and then one room runs the functions that were made for the other's.
import { report } from "./room_tree.mjs";

const NAMESPACE = /^namespace ([\w:]+) \{/;
const TYPE = /^(?:struct|class|enum class|enum)(?: alignas\([^)]*\))? (\w+)(?: final)?(?: :[^;]*)?(?: \{.*)?$/;

export function checkTypes(tree) {
  const places = new Map();
  for (const [file, text] of tree.texts) {
    if (!file.endsWith(".h") || file.startsWith("tests/")) {
      continue;
    }
    let space = "";
    text.split("\n").forEach((code, i) => {
      space = NAMESPACE.exec(code)?.[1] ?? space;
      const found = TYPE.exec(code);
      if (found === null || code.endsWith(";")) {
        return;
      }
      const name = `${space}::${found[1]}`;
      const first = places.get(name);
      if (first === undefined) {
        places.set(name, `${file}:${i + 1}`);
      } else {
        report(file, i + 1, `defines ${name}, as ${first} does: the name is taken`);
      }
    });
  }
}
