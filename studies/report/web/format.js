// SPDX-License-Identifier: GPL-3.0-or-later
// How numbers, names and states are written, and the few facts computed from the data.

export const minus = (text) => text.replace('-', '\u2212');

const kSuperscripts = '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079';

/** Very large and very small numbers: "3.21 \u00d7 10\u2078". */
function power(value, significant) {
  const [mantissa, exponent] = value.toExponential(significant - 1).split('e');
  const raised = [...String(Math.abs(Number(exponent)))].map((digit) => kSuperscripts[Number(digit)]).join('');
  return `${minus(mantissa)}\u00a0\u00d7\u00a010${Number(exponent) < 0 ? '\u207b' : ''}${raised}`;
}

/** So many significant digits, also where the last are zeros; never fewer than the whole number has. */
function rounded(value, significant) {
  if (typeof value !== 'number') return value === null || value === undefined ? '\u2013' : String(value);
  if (!Number.isFinite(value)) return '\u2013';
  if (value === 0) return '0';
  const size = Number(Math.abs(value).toPrecision(significant));
  if (size >= 1e6 || size < 1e-4) return power(value, significant);
  return minus(value.toFixed(Math.max(0, significant - 1 - Math.floor(Math.log10(size)))));
}

/** What was measured: three significant digits, "13.0", "0.380". */
export const measured = (value) => rounded(value, 3);

/** What was set: four significant digits (unless told), zeros at the end left out, "13", "12.35". */
export function number(value, significant = 4) {
  const text = rounded(value, significant);
  return typeof value === 'number' && /^[^\u00d7]*\.[^\u00d7]*$/.test(text) ? text.replace(/\.?0+$/, '') : text;
}

/** One decimal; two below 1 %. */
export function percent(value) {
  const scaled = 100 * value;
  const digits = scaled !== 0 && Math.abs(scaled) < 0.995 ? 2 : 1;
  return `${minus(scaled.toFixed(digits))}\u00a0%`;
}

/** A value and its standard error, both to the second digit of the error: "81.23 \u00b1 0.31". */
function withError(value, error, unit) {
  const digits = error > 0 ? Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(Number(error.toPrecision(2)))))) : 1;
  return `${minus(value.toFixed(digits))}${unit} \u00b1 ${error.toFixed(digits)}${unit}`;
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
    this.front = data.front?.objectives?.length > 1 ? data.front : null;
    this.objectives = this.front ? this.front.objectives.map((one) => ({ name: one.score, maximise: one.direction === 'maximise' }))
      : this.objective.name ? [{ name: this.objective.name, maximise: this.maximise }] : [];
    const scores = [...this.objectives, ...this.constraints].map(({ name }) => this.label(name));
    this.names = shortNames(this.variables.map((variable) => variable.name), scores);
  }

  info(score) { return this.data.score_info?.[score] ?? { label: score, format: 'number' }; }
  label(score) { return this.info(score).label; }

  /** What a score is, for a tip: the sentence of `glint explain` and the name in files. */
  meaning(score) { return [this.info(score).meaning, score].filter(Boolean).join('\n'); }
  score(name, value) {
    if (typeof value !== 'number') return number(value);
    return this.info(name).format === 'percent' ? percent(value) : measured(value);
  }

  /** With its standard error where it has one: "81.2 % \u00b1 0.3 %". */
  scoreWithError(name, scores) {
    const [value, error] = [scores?.[name], scores?.[`${name}.error`]];
    if (!isNumber(value) || !isNumber(error)) return this.score(name, value);
    return this.info(name).format === 'percent' ? withError(100 * value, 100 * error, '\u00a0%') : withError(value, error, '');
  }

  /** A difference of two values, signed, and its unit: points for per cents. */
  difference(name, value) {
    const isPercent = this.info(name).format === 'percent';
    const text = isPercent ? minus((100 * value).toFixed(1)) : measured(value);
    return { text: `${value > 0 ? '+' : ''}${text}`, unit: isPercent ? 'points' : '' };
  }

  better(a, b) { return this.maximise ? a > b : a < b; }

  /** What its first scores are of: the search that it stands beside, or the study alone. */
  origin(design) {
    const run = this.runs.find((one) => one.title === design.run);
    return (run ? run.evaluations > 0 : this.trials.length > 0) ? 'search' : 'study';
  }

  /** The most trustworthy value: with fresh seeds when there is one. */
  value(design, name) { return design.rescored?.[name] ?? design.scores?.[name]; }

  /** The limit of a constraint as it was set: "≥ 3", "≤ 1 %". */
  limit(constraint) {
    const isPercent = this.info(constraint.name).format === 'percent';
    const written = (value) => (isPercent ? `${number(100 * value, 8)}\u00a0%` : number(value, 8));
    const parts = [];
    if (isNumber(constraint.min)) parts.push(`\u2265 ${written(constraint.min)}`);
    if (isNumber(constraint.max)) parts.push(`\u2264 ${written(constraint.max)}`);
    return parts.join(' and ');
  }

  meets(constraint, value) {
    if (!isNumber(value)) return false;
    return !(isNumber(constraint.min) && value < constraint.min) && !(isNumber(constraint.max) && value > constraint.max);
  }

  /** A score of an evaluation. */
  scoreOf(trial, name) { return name === this.objective.name ? trial.objective : trial.scores?.[name]; }

  /** "smallest CNR, more is better". */
  axisName({ name, maximise }) { return `${this.label(name)}, ${maximise ? 'more' : 'less'} is better`; }

  /** Objectives, both definitions of h and everything constrained, in that order, once each. */
  mainScores() {
    const wanted = [this.objective.name, ...this.objectives.map((one) => one.name), 'homogeneity.h_rms', 'homogeneity.h_abs', ...this.constraints.map((c) => c.name)];
    const present = (name) => this.designs.some((d) => isNumber(d.scores?.[name])) || this.trials.some((t) => isNumber(t.scores?.[name]));
    return [...new Set(wanted)].filter((name) => name && (name === this.objective.name || present(name)));
  }

  title(design) { return design.title ?? design.key; }
  role(design) {
    if (design.role) return design.role;
    if (['winner', 'baseline'].includes(design.key)) return design.key;
    return this.designs.length > 1 ? 'prototype' : 'design';
  }

  /** What a design is called for its role: a winner that misses a limit is the closest one. */
  roleName(design) {
    const role = this.role(design);
    return role === 'winner' && design.feasible === false ? 'closest' : role;
  }

  /** Best feasible objective up to each trial; null before the first one. */
  bestSoFar() {
    let best = null;
    return this.trials.map((trial) => {
      if (isGood(trial) && (best === null || this.better(trial.objective, best))) best = trial.objective;
      return best;
    });
  }

  /** Range of an objective that shows the interesting part: without the worst tail. */
  objectiveRange({ name, maximise } = { name: this.objective.name, maximise: this.maximise }) {
    const values = this.trials.filter(isDone).map((trial) => this.scoreOf(trial, name)).filter(isNumber).sort((a, b) => a - b);
    const marks = [...this.designs, ...(this.front?.designs ?? [])].flatMap((design) => [design.scores?.[name], this.front && design.rescored?.[name]]).filter(isNumber);
    if (values.length + marks.length === 0) return [0, 1];
    const cut = Math.floor(values.length * 0.1);
    const kept = maximise ? values.slice(cut) : values.slice(0, values.length - cut);
    const all = [...kept, ...marks];
    const low = Math.min(...all);
    const high = Math.max(...all);
    const margin = (high - low || Math.abs(high) * 0.1 || 1) * 0.06;
    return [low - margin, high + margin];
  }
}

/** Of very many things: "321 million". */
export const count = (value) => (value >= 1e6 ? `${measured(value / 1e6)} million` : String(value));

export const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
export const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
export const isDone = (trial) => !trial.failed && isNumber(trial.objective);
export const isGood = (trial) => isDone(trial) && trial.feasible !== false;
export const stateOf = (trial) => (trial.failed ? 'failed' : trial.feasible === false ? 'infeasible' : 'feasible');

export const microns = (unit) => (unit === 'um' ? '\u00b5m' : unit);

/** "lighting.tunnel.radius_mm" -> "radius (mm)", longer only where two would look the same, or where something else is called so. */
export function shortNames(paths, taken = []) {
  for (let kept = 1; kept <= 4; ++kept) {
    const names = paths.map((path) => readable(path, kept));
    if (new Set(names).size === names.length) return names.map((name, i) => (taken.includes(name) ? readable(paths[i], kept + 1) : name));
  }
  return paths;
}

/** Keys of three numbers, and what the numbers are called; others count from 1. */
const kAlongAxes = ['x', 'y', 'z'];
const kVectors = ['position', 'direction', 'up', 'normal', 'centre'];

/** "control_mm", "2" -> "control point 3"; "rotation_deg", "2" -> "rotation about z". */
function element(key, index) {
  if (kVectors.includes(key)) return `${key} ${kAlongAxes[index] ?? index + 1}`;
  if (key === 'rotation') return `rotation about ${kAlongAxes[index] ?? index + 1}`;
  return { control: `control point ${index + 1}`, 'segment power': `power of segment ${index + 1}` }[key] ?? `${key} ${index + 1}`;
}

function readable(path, kept) {
  const parts = path.split('.');
  const index = /^\d+$/.test(parts[parts.length - 1]) ? Number(parts.pop()) : null;
  const key = parts[parts.length - 1];
  const unit = /_(mm|um|nm|deg|px|s|ms)$/.exec(key)?.[1];
  const plain = (unit ? key.slice(0, -unit.length - 1) : key).replaceAll('_', ' ');
  const name = [...parts.slice(Math.max(0, parts.length - kept), -1).map((part) => part.replaceAll('_', ' ')),
    index === null ? plain : element(plain, index)].join(' ');
  return unit ? `${name} (${unit === 'deg' ? '\u00b0' : microns(unit)})` : name;
}
