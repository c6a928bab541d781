// SPDX-License-Identifier: GPL-3.0-or-later
// What the page of several objectives computes without a browser.

/** Of a variable's value to the shell. */
const quoted = (text) => (/^[\w.+-]*$/.test(text) ? text : `'${text}'`);

/** The options that make `glint render` or `glint run` take these values. */
export const setLine = (variables) => Object.entries(variables ?? {}).map(([path, value]) => `--set ${quoted(path)}=${quoted(String(value))}`).join(' ');

/** A pair of objectives and where it is drawn: below the diagonal of a matrix. */
export function panelsOf(objectives) {
  const panels = [];
  for (let row = 1; row < objectives.length; ++row) {
    for (let column = 0; column < row; ++column) panels.push({ x: objectives[column], y: objectives[row], row: row - 1, column });
  }
  return panels;
}

/** Corners of what the front reaches in two objectives: no point between two designs is promised. */
export function staircase(points, x, y) {
  const sorted = [...points].sort((a, b) => a[0] - b[0]);
  const takesOwn = x.maximise;  // of two neighbours' y the one that holds between them
  return sorted.flatMap((point, i) => (i === 0 ? [point] : [takesOwn ? [sorted[i - 1][0], point[1]] : [point[0], sorted[i - 1][1]], point]));
}

/** Some round numbers between two. */
export function ticks(low, high, about = 4) {
  if (!(high > low)) return [low];
  const power = 10 ** Math.floor(Math.log10((high - low) / about));
  const step = power * [1, 2, 5, 10].find((one) => (high - low) / (one * power) <= about + 0.5);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** Some round numbers between two above 0, evenly in their logarithm: 1, 2, 5, 10, .. as far as there are a few of them. */
export function logTicks(low, high) {
  const decades = Array.from({ length: Math.ceil(Math.log10(high)) - Math.floor(Math.log10(low)) + 1 }, (_, i) => 10 ** (Math.floor(Math.log10(low)) + i));
  const within = (steps) => decades.flatMap((one) => steps.map((step) => Number((one * step).toPrecision(12)))).filter((one) => one >= low && one <= high);
  const some = within([1, 2, 5]);
  return some.length > 6 ? within([1]) : some;
}

/** How the page speaks of a front: of what evaluations have shown, or of what the search's model expects of them. */
export function frontWords(front) {
  return front.is_expected
    ? { unbeaten: 'that no other one is expected to beat in everything, where the search\u2019s model of all evaluations expects them', rest: 'the other evaluations, as they were seen', beaten: 'not on the expected front', history: ' Each evaluation counts by what the model expects of it in the end.', band: 'the model\u2019s standard deviations make of it' }
    : { unbeaten: 'that no other one beats in everything', rest: 'evaluations that one of them beats in everything', beaten: 'beaten in everything', history: '', band: 'the scores\u2019 own errors make of it' };
}

/** Which designs may be the compromise, for all the noise of their scores. */
export function chosenText(facts) {
  const unknown = facts.front.probability_best_unknown;
  if (unknown) return ` No probability of being the compromise is told: ${unknown}.`;
  const likely = (facts.front.probability_best ?? []).filter((one) => one.probability >= 0.005);
  const share = ({ probability }) => (probability < 0.995 ? `${Math.round(100 * probability)}\u00a0%` : 'over 99\u00a0%');
  return likely.length ? ` Probability of being the compromise, from scans with the same noise for all: ${likely.slice(0, 6).map((one) => `${one.title} ${share(one)}`).join(', ')}${likely.length > 6 ? ', and others' : ''}.` : '';
}
