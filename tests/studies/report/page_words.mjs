// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node page_words.mjs ROOT
//
// How the report's page writes numbers and names, and what the filter of its table keeps.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const source = (name) => import(pathToFileURL(join(process.argv[2], 'studies/report/web', name)).href);
const { count, Facts, measured, number, percent, shortNames } = await source('format.js');
const { parseFilter } = await source('filter.js');
const { chosenText, frontWords, logTicks, panelsOf, setLine, staircase, ticks } = await source('front_words.js');
const { explainedScores, ranked, rankedTogether } = await source('verdict.js');
const { Selection } = await source('selection.js');

// Three significant digits for what was measured, also where the last are zeros.
for (const [value, text] of [[13, '13.0'], [12.34, '12.3'], [9.006, '9.01'], [0.38, '0.380'], [8.614e-4, '0.000861'], [0, '0'],
  [-2.5, '\u22122.50'], [9.996, '10.0'], [999.6, '1000'], [12.25, '12.3'], [1234.5, '1235'], [99999.5, '100000'], [1e6, '1.00\u00a0\u00d7\u00a010\u2076'], [5.123e-6, '5.12\u00a0\u00d7\u00a010\u207b\u2076'], [null, '\u2013'], [NaN, '\u2013']]) assert.equal(measured(value), text);
// Four for what was set, without zeros at the end.
for (const [value, text] of [[13, '13'], [12.35, '12.35'], [60, '60'], [0.1, '0.1'], [1000, '1000'], [123456, '123456'], ['flat', 'flat'], [true, 'true']]) assert.equal(number(value), text);
for (const [value, text] of [[0.801, '80.1\u00a0%'], [0.0063, '0.63\u00a0%'], [-0.3705, '\u221237.0\u00a0%'], [0, '0.0\u00a0%']]) assert.equal(percent(value), text);
assert.equal(count(321177600), '321 million');
assert.equal(count(1234), '1234');

// A value ends where the second digit of its error does.
const facts = new Facts({ score_info: { h: { label: 'h', format: 'percent' }, d: { label: 'd', format: 'number' } } });
assert.equal(facts.scoreWithError('h', { h: 0.8312, 'h.error': 0.00063 }), '83.120\u00a0% \u00b1 0.063\u00a0%');
assert.equal(facts.scoreWithError('d', { d: 12.345, 'd.error': 1.24 }), '12.3 \u00b1 1.2');
assert.equal(facts.scoreWithError('d', { d: 3 }), '3.00');

// Limits are written as they were set.
assert.equal(facts.limit({ name: 'h', min: 0.99555 }), '\u2265 99.555\u00a0%');
assert.equal(facts.limit({ name: 'h', max: 0.07 }), '\u2264 7\u00a0%');
assert.equal(facts.limit({ name: 'd', min: 3, max: 1234.56 }), '\u2265 3 and \u2264 1234.56');

// Names in words; numbers of a list count from 1 or have their axis.
assert.deepEqual(shortNames(['lighting.tunnel.radius_mm', 'lighting.tunnel.control_mm.2', 'part.rotation_deg.0', 'lighting.ring.position_mm.2', 'lighting.ring.segment_power.0', 'defects.dent.height_um']),
  ['radius (mm)', 'control point 3 (mm)', 'rotation about x (\u00b0)', 'position z (mm)', 'power of segment 1', 'height (\u00b5m)']);
assert.deepEqual(shortNames(['lighting.left.position_mm.0', 'lighting.right.position_mm.0']), ['left position x (mm)', 'right position x (mm)']);

// A variable that is called like a score on the page has its light's name, too; others keep theirs.
assert.deepEqual(shortNames(['lighting.tunnel.height_mm', 'lighting.tunnel.slot_mm'], ['height (mm)']), ['tunnel height (mm)', 'slot (mm)']);
const named = new Facts({ variables: [{ name: 'lighting.tunnel.height_mm' }], objective: { name: 'lighting.height_mm' }, score_info: { 'lighting.height_mm': { label: 'height (mm)', format: 'number' } } });
assert.deepEqual(named.names, ['tunnel height (mm)']);

// Round marks of a logarithmic axis.
assert.deepEqual(logTicks(6, 32), [10, 20]);
assert.deepEqual(logTicks(0.1, 0.5), [0.1, 0.2, 0.5]);
assert.deepEqual(logTicks(0.001, 100), [0.001, 0.01, 0.1, 1, 10, 100]);

// Which designs may be the compromise.
assert.equal(chosenText({ front: {} }), '');
assert.match(chosenText({ front: { probability_best: [{ title: 'Evaluation 5', probability: 0.84 }, { title: 'Half', probability: 0.16 }, { title: 'Other', probability: 0.001 }] } }),
  /for all: Evaluation 5 84\u00a0%, Half 16\u00a0%\.$/);
assert.match(chosenText({ front: { probability_best_unknown: 'how far noise moves h of Half is not known' } }), /No probability of being the compromise is told: how far .* not known\.$/);

// Of what the front is.
assert.match(frontWords({}).unbeaten, /^that no other one beats in everything$/);
assert.match(frontWords({ is_expected: true }).unbeaten, /^that no other one is expected to beat in everything, where the search\u2019s model/);
assert.equal(frontWords({ is_expected: true }).rest, 'the other evaluations, as they were seen');

// Runs that are not comparable have a table each, ordered by their own objective.
const runs = [{ title: 'a', group: 0, objective: { name: 'h', sense: 'maximise' } }, { title: 'b', group: 1, objective: { name: 'width', sense: 'minimise' } }, { title: 'c', group: 0 }];
const design = (run, scores) => ({ key: `${run} ${scores.h ?? scores.width}`, run, scores });
const apart = new Facts({ runs, objective: { name: 'h', sense: 'maximise' }, designs: [design('a', { h: 1 }), design('b', { width: 5 }), design('b', { width: 3 }), design('c', { h: 2 })] });
const tables = (compared) => rankedTogether(compared).map((group) => [group.caption, ...ranked(compared, group.designs, group.objective).map((one) => one.key)]);
assert.deepEqual(tables(apart), [['a, c', 'c 2', 'a 1'], ['b', 'b 3', 'b 5']]);
const together = new Facts({ ...apart.data, runs: runs.map((run) => ({ ...run, group: 0 })) });
assert.deepEqual(tables(together).map(([caption, ...keys]) => [caption, keys.length]), [['', 4]]);

// Each group's objective is explained; first scores are a search's only where something was searched.
const explained = new Facts({ ...apart.data, score_info: { h: { label: 'h', meaning: 'evenness' }, width: { label: 'width', meaning: 'how wide' } } });
assert.deepEqual(explainedScores(explained), ['h', 'width']);
const origins = new Facts({ ...apart.data, runs: runs.map((run) => ({ ...run, evaluations: run.title === 'b' ? 40 : null })) });
assert.deepEqual(origins.data.designs.map((one) => origins.origin(one)), ['study', 'search', 'search', 'study']);
assert.deepEqual([new Facts({ trials: [{ number: 1 }] }), new Facts({})].map((one) => one.origin({ key: 'baseline' })), ['search', 'study']);

// The filter works in the units that the table shows.
const rows = [{ h: 0.801, cnr: 4, state: 'feasible', radius: 80 }, { h: 0.7, cnr: null, state: 'infeasible', radius: 120 }, { h: 0.95, cnr: 2, state: 'failed', radius: 100 }];
const columns = [
  { name: 'state', heading: 'state', value: (row) => row.state, text: (row) => row.state },
  { name: 'homogeneity.h_rms', heading: 'h (rms)', isPercent: true, value: (row) => row.h, text: (row) => percent(row.h) },
  { name: 'defects.min_cnr', heading: 'smallest CNR', value: (row) => row.cnr, text: (row) => String(row.cnr) },
  { name: 'lighting.tunnel.radius_mm', heading: 'radius (mm)', value: (row) => row.radius, text: (row) => number(row.radius) }];
const kept = (text) => {
  const { keep, problems } = parseFilter(text, columns, rows);
  assert.deepEqual(problems, [], text);
  return rows.filter(keep).map((row) => rows.indexOf(row));
};
assert.deepEqual(kept(''), [0, 1, 2]);
assert.deepEqual(kept('h_rms > 80'), [0, 2]);
assert.deepEqual(kept('h_rms>80%'), [0, 2]);
assert.deepEqual(kept('cnr >= 4'), [0]);
assert.deepEqual(kept('radius < 110 feasible'), [0]);
assert.deepEqual(kept('infeasible'), [1]);
assert.deepEqual(kept('state = failed'), [2]);
// What cannot be meant is told, and keeps every row.
for (const [text, problem] of [['cnr => 3', '"=>" is no comparison'], ['((', 'no row has "(("'], ['size > 3', 'no column is called "size"'], ['cnr > x', '"x" is no number'], ['cnr >', 'what is cnr > to be compared with?']]) {
  const { keep, problems } = parseFilter(text, columns, rows);
  assert.equal(rows.filter(keep).length, 3, text);
  assert.equal(problems.length, 1, text);
  assert.ok(problems[0].startsWith(problem), problems[0]);
}

// Several objectives: what is chosen is what all brushes but the asking part's own have in common.
const selection = new Selection();
const heard = [];
selection.listen((_, what, source) => heard.push([what, source]));
assert.equal(selection.chosen(), null);
selection.brush('front', null);
assert.deepEqual(heard, []);
selection.brush('front', new Set([1, 2, 3]));
selection.brush('table', new Set([2, 3, 4, 5]));
assert.deepEqual(selection.chosen(), new Set([2, 3]));
assert.deepEqual(selection.chosen('table'), new Set([1, 2, 3]));
selection.brush('front', null);
assert.deepEqual(selection.chosen(), new Set([2, 3, 4, 5]));
selection.pick(4);
assert.deepEqual(heard, [['brush', 'front'], ['brush', 'table'], ['brush', 'front'], ['pick', null]]);

// A shell takes the line apart into the same words.
assert.equal(setLine({ 'lighting.tunnel.radius_mm': 120.25, 'lighting.tunnel.shape': 'flat', lighting_use: 'ring+dome' }),
  '--set lighting.tunnel.radius_mm=120.25 --set lighting.tunnel.shape=flat --set lighting_use=ring+dome');
assert.equal(setLine({ 'lighting.left wall.duty': true }), "--set 'lighting.left wall.duty'=true");

// A matrix of m objectives has a panel for each pair.
assert.deepEqual(panelsOf(['a', 'b']), [{ x: 'a', y: 'b', row: 0, column: 0 }]);
assert.equal(panelsOf(['a', 'b', 'c', 'd']).length, 6);

// No corner of the line is better than both designs beside it.
assert.deepEqual(staircase([[2, 1], [1, 2]], { maximise: true }), [[1, 2], [1, 1], [2, 1]]);
assert.deepEqual(staircase([[1, 2], [2, 1]], { maximise: false }), [[1, 2], [2, 2], [2, 1]]);

assert.deepEqual(ticks(0.21, 0.79), [0.4, 0.6]);
assert.deepEqual(ticks(60, 250), [100, 150, 200, 250]);
assert.deepEqual(ticks(0, 1), [0, 0.5, 1]);
assert.deepEqual(ticks(3, 3), [3]);
