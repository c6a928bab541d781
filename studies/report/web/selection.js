// SPDX-License-Identifier: GPL-3.0-or-later
// What is chosen across the page: evaluations by brushes of several parts, and the one that is looked at.

export class Selection {
  constructor() {
    this.brushes = new Map();
    this.picked = null;
    this.listeners = [];
  }

  /** @param change  called as change(selection, 'brush' | 'pick', source) */
  listen(change) { this.listeners.push(change); }

  /** @param numbers  a Set of evaluations, or null: this part chooses nothing */
  brush(source, numbers) {
    if (numbers === null && !this.brushes.has(source)) return;
    if (numbers === null) this.brushes.delete(source);
    else this.brushes.set(source, numbers);
    this.tell('brush', source);
  }

  /** An evaluation by its number, or a design by its key. */
  pick(what) {
    this.picked = what;
    this.tell('pick', null);
  }

  tell(what, source) {
    for (const change of this.listeners) change(this, what, source);
  }

  /** What all brushes have in common, but for those of one part; null: nothing is brushed. */
  chosen(but = null) {
    const sets = [...this.brushes].filter(([source]) => source !== but).map(([, numbers]) => numbers);
    if (!sets.length) return null;
    const [first, ...others] = sets.sort((a, b) => a.size - b.size);
    return new Set([...first].filter((number) => others.every((one) => one.has(number))));
  }
}
