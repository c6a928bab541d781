// SPDX-License-Identifier: GPL-3.0-or-later
// How numbers, names and states are written, and the few facts computed from the data.

export const minus = (text) => text.replace('-', '\u2212');

/** A few significant digits (four unless told), no trailing zeros. */
export function number(value, significant = 4) {
  if (typeof value !== 'number') return value === null || value === undefined ? '\u2013' : String(value);
  if (!Number.isFinite(value)) return '\u2013';
  if (value !== 0 && (Math.abs(value) >= 1e6 || Math.abs(value) < 1e-3)) return minus(value.toExponential(2));
  const digits = Math.abs(value) >= 1000 ? 0 : Math.max(0, significant - 1 - Math.floor(Math.log10(Math.abs(value) || 1)));
  return minus(String(Number(value.toFixed(Math.min(digits, 5)))));
}

export function percent(value) {
  const scaled = 100 * value;
  const digits = scaled !== 0 && Math.abs(scaled) < 1 ? 2 : 1;
  return `${minus(scaled.toFixed(digits))}\u00a0%`;
}

/** The reader of one data object: labels, formats and comparisons. */
export class Facts {
  constructor(data) {
    this.data = data;
    this.designs = data.designs ?? [];
    this.trials = data.trials ?? [];
    this.variables = data.variables ?? [];
    this.constraints = data.constraints ?? [];
    this.runs = data.runs ?? [];
    this.objective = data.objective ?? { name: '', sense: 'maximise' };
    this.maximise = !String(this.objective.sense ?? '').startsWith('min');
    this.names = shortNames(this.variables.map((variable) => variable.name));
  }

  info(score) { return this.data.score_info?.[score] ?? { label: score, format: 'number' }; }
  label(score) { return this.info(score).label; }
  score(name, value) {
    if (typeof value !== 'number') return number(value);
    return this.info(name).format === 'percent' ? percent(value) : number(value, 3);
  }

  /** With its standard error where it has one: "81.2 % \u00b1 0.3 %". */
  scoreWithError(name, scores) {
    const error = scores?.[`${name}.error`];
    const text = this.score(name, scores?.[name]);
    if (!isNumber(error)) return text;
    const isPercent = this.info(name).format === 'percent';
    return `${text} \u00b1 ${isPercent ? `${number(100 * error, 2)} %` : number(error, 2)}`;
  }

  /** A difference of two values, signed, and its unit: points for per cents. */
  difference(name, value) {
    const isPercent = this.info(name).format === 'percent';
    const text = isPercent ? minus((100 * value).toFixed(1)) : number(value, 3);
    return { text: `${value > 0 ? '+' : ''}${text}`, unit: isPercent ? 'points' : '' };
  }

  better(a, b) { return this.maximise ? a > b : a < b; }

  /** The most trustworthy value: with fresh seeds when there is one. */
  value(design, name) { return design.rescored?.[name] ?? design.scores?.[name]; }

  /** The limit of a constraint as "≥ 3", "≤ 1.0 %". */
  limit(constraint) {
    const parts = [];
    if (isNumber(constraint.min)) parts.push(`\u2265 ${this.score(constraint.name, constraint.min)}`);
    if (isNumber(constraint.max)) parts.push(`\u2264 ${this.score(constraint.name, constraint.max)}`);
    return parts.join(' and ');
  }

  meets(constraint, value) {
    if (!isNumber(value)) return false;
    return !(isNumber(constraint.min) && value < constraint.min) && !(isNumber(constraint.max) && value > constraint.max);
  }

  /** Objective, both definitions of h and everything constrained, in that order, once each. */
  mainScores() {
    const wanted = [this.objective.name, 'homogeneity.h_rms', 'homogeneity.h_abs', ...this.constraints.map((c) => c.name)];
    const present = (name) => this.designs.some((d) => isNumber(d.scores?.[name])) || this.trials.some((t) => isNumber(t.scores?.[name]));
    return [...new Set(wanted)].filter((name) => name && (name === this.objective.name || present(name)));
  }

  title(design) { return design.title ?? design.key; }
  role(design) {
    if (design.role) return design.role;
    if (['winner', 'baseline'].includes(design.key)) return design.key;
    return this.designs.length > 1 ? 'prototype' : 'design';
  }

  /** Best feasible objective up to each trial; null before the first one. */
  bestSoFar() {
    let best = null;
    return this.trials.map((trial) => {
      if (isGood(trial) && (best === null || this.better(trial.objective, best))) best = trial.objective;
      return best;
    });
  }

  /** Range of the objective that shows the interesting part: without the worst tail. */
  objectiveRange() {
    const values = this.trials.filter(isDone).map((trial) => trial.objective).sort((a, b) => a - b);
    const marks = this.designs.map((design) => design.scores?.[this.objective.name]).filter(isNumber);
    if (values.length + marks.length === 0) return [0, 1];
    const cut = Math.floor(values.length * 0.1);
    const kept = this.maximise ? values.slice(cut) : values.slice(0, values.length - cut);
    const all = [...kept, ...marks];
    const low = Math.min(...all);
    const high = Math.max(...all);
    const margin = (high - low || Math.abs(high) * 0.1 || 1) * 0.06;
    return [low - margin, high + margin];
  }
}

export const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
export const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
export const isDone = (trial) => !trial.failed && isNumber(trial.objective);
export const isGood = (trial) => isDone(trial) && trial.feasible !== false;
export const stateOf = (trial) => (trial.failed ? 'failed' : trial.feasible === false ? 'infeasible' : 'feasible');

export const microns = (unit) => (unit === 'um' ? '\u00b5m' : unit);

/** "lighting.tunnel.radius_mm" -> "radius (mm)", longer only where two would look the same. */
export function shortNames(paths) {
  for (let kept = 1; kept <= 4; ++kept) {
    const names = paths.map((path) => readable(path, kept));
    if (new Set(names).size === names.length) return names;
  }
  return paths;
}

function readable(path, kept) {
  const parts = path.split('.');
  let first = parts.length - kept;
  if (/^\d+$/.test(parts[parts.length - 1])) first -= 1;
  const text = parts.slice(Math.max(0, first)).join(' ');
  const unit = /_(mm|um|nm|deg|px|s|ms)(?= |$)/.exec(text);
  const name = text.replace(/_(mm|um|nm|deg|px|s|ms)(?= |$)/g, '').replaceAll('_', ' ');
  return unit ? `${name} (${unit[1] === 'deg' ? '\u00b0' : microns(unit[1])})` : name;
}
