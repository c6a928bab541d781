// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict: one sentence, the big numbers and the table that ranks the designs.
import { badge, h, section } from './dom.js';
import { isNumber } from './format.js';

/** The design the big numbers are about: the winner, or the only one where nothing was searched. */
function subject(facts) {
  if (facts.runs.length) return null;
  const winner = facts.designs.find((design) => facts.role(design) === 'winner');
  return winner ?? (facts.designs.length === 1 && !facts.trials.length ? facts.designs[0] : null);
}

function figure(label, value, note, tone = '', unit = '') {
  return h('div', { class: `figure ${tone}` }, h('p', { class: 'label' }, label), h('p', { class: 'value' }, value, unit && h('small', {}, ` ${unit}`)), h('p', { class: 'note' }, note ?? ''));
}

function scoreFigure(facts, design, name) {
  const fresh = design.rescored?.[name];
  const note = isNumber(fresh) ? `fresh seeds; ${facts.score(name, design.scores?.[name])} in the search` : 'with the seeds of the search';
  return figure(facts.label(name), facts.score(name, facts.value(design, name)), facts.trials.length ? note : '');
}

/** One of several objectives: with its error, and where the baseline is. */
function objectiveFigure(facts, design, baseline, { name, maximise }) {
  const value = facts.value(design, name);
  const there = baseline && facts.value(baseline, name);
  const isKnown = isNumber(value) && isNumber(there) && value !== there;
  const error = design.rescored?.[`${name}.error`];
  const note = [maximise ? 'more is better' : 'less is better', isNumber(error) && `standard error ${facts.score(name, error)}`, isNumber(there) && `baseline ${facts.score(name, there)}`].filter(Boolean).join('; ');
  return figure(facts.label(name), facts.score(name, value), note, isKnown ? (value > there === maximise ? 'up' : 'down') : '');
}

function gainFigure(facts, design, other, label) {
  const name = facts.objective.name;
  const here = facts.value(design, name);
  const there = other && facts.value(other, name);
  if (!isNumber(here) || !isNumber(there)) return null;
  const tone = here === there ? '' : facts.better(here, there) ? 'up' : 'down';
  const { text, unit } = facts.difference(name, here - there);
  return figure(label, text, `from ${facts.score(name, there)} (${facts.title(other)})`, tone, unit);
}

function constraintFigure(facts, design, constraint) {
  const value = facts.value(design, constraint.name);
  const ok = facts.meets(constraint, value);
  return figure(facts.label(constraint.name), facts.score(constraint.name, value), `${ok ? '\u2713 meets' : '\u2717 misses'} ${facts.limit(constraint)}`, ok ? '' : 'down');
}

/** The best of the designs, feasible ones first. */
function bestOf(facts, designs) {
  const all = designs.filter((design) => isNumber(facts.value(design, facts.objective.name)));
  const feasible = all.filter((design) => design.feasible !== false);
  const valued = feasible.length ? feasible : all;
  return valued.reduce((best, design) =>
    (best && !facts.better(facts.value(design, facts.objective.name), facts.value(best, facts.objective.name)) ? best : design), null);
}

const columns = (shown) => h('div', { class: 'figures', style: `--count:${Math.ceil(shown.length / Math.ceil(shown.length / 6))};--half:${Math.ceil(shown.length / Math.ceil(shown.length / 3))}` }, shown);

function figures(facts) {
  const given = facts.data.verdict?.figures;
  if (given) return columns(given.map((one) => figure(one.label, one.value, one.note, one.tone, one.unit)));
  const design = subject(facts);
  if (!design) return null;
  const main = facts.mainScores().filter((name) => !facts.constraints.some((one) => one.name === name));
  const baseline = facts.designs.find((one) => facts.role(one) === 'baseline');
  const prototype = bestOf(facts, facts.designs.filter((one) => facts.role(one) === 'prototype'));
  if (facts.front) return columns([...facts.objectives.map((one) => objectiveFigure(facts, design, baseline, one)), ...facts.constraints.filter((one) => !facts.objectives.some(({ name }) => name === one.name)).map((constraint) => constraintFigure(facts, design, constraint))]);
  const shown = [main.map((name) => scoreFigure(facts, design, name)),
    baseline !== design && gainFigure(facts, design, baseline, 'against the baseline'),
    prototype !== design && gainFigure(facts, design, prototype, 'against the best prototype'),
    facts.constraints.map((constraint) => constraintFigure(facts, design, constraint))].flat().filter(Boolean);
  return columns(shown);
}

/** The best first; what has no value last. */
export function ranked(facts, designs, { name, maximise }) {
  const value = (design) => facts.value(design, name);
  const order = (a, b) => {
    const wins = [a, b].map((design) => Number(facts.role(design) === 'winner'));
    if (!facts.runs.length && wins[0] !== wins[1]) return wins[1] - wins[0];
    if (!isNumber(value(a)) || !isNumber(value(b))) return Number(isNumber(value(b))) - Number(isNumber(value(a)));
    return maximise ? value(b) - value(a) : value(a) - value(b);
  };
  return [...designs].sort(order);
}

/** What is ranked together: all designs, or of runs those of each group, by its objective. */
export function rankedTogether(facts) {
  const own = { name: facts.objective.name, maximise: facts.maximise };
  const groups = [...new Set(facts.runs.map((run) => run.group ?? 0))];
  if (groups.length < 2) return [{ designs: facts.designs, objective: own, caption: '' }];
  return groups.map((group) => {
    const runs = facts.runs.filter((run) => (run.group ?? 0) === group);
    const titles = runs.map((run) => run.title);
    const objective = runs[0].objective ? { name: runs[0].objective.name, maximise: !String(runs[0].objective.sense ?? '').startsWith('min') } : own;
    return { designs: facts.designs.filter((design) => titles.includes(design.run)), objective, caption: titles.join(', ') };
  });
}

function groupBoard(facts, { designs, objective, caption }) {
  const isGiven = (name) => name && designs.some((design) => isNumber(facts.value(design, name)));
  const names = facts.runs.length ? [...new Set([objective.name, ...facts.mainScores()])].filter(isGiven) : facts.mainScores();
  const cell = (design, name) => {
    const constraint = facts.constraints.find((one) => one.name === name);
    const fresh = design.rescored?.[name];
    const fails = constraint && !facts.meets(constraint, facts.value(design, name));
    return h('td', { class: fails ? 'fails' : '' }, h('b', {}, facts.score(name, facts.value(design, name)), fails && ' \u2717'),
      isNumber(fresh) && h('small', {}, `${facts.origin(design)} ${facts.score(name, design.scores?.[name])}`));
  };
  const row = (design) => h('tr', { class: facts.runs.length ? '' : facts.role(design) },
    h('th', {}, h('a', { href: `#design-${design.key}` }, facts.title(design)), ' ',
      !facts.runs.length && facts.title(design).toLowerCase() !== facts.role(design) && badge(facts.role(design), facts.roleName(design))),
    names.map((name) => cell(design, name)),
    h('td', {}, design.feasible === undefined || design.feasible === null ? '\u2013' : design.feasible ? badge('good', 'feasible') : badge('bad', 'not feasible')));
  const objectives = facts.runs.length ? [objective] : facts.objectives;
  const sense = (one) => (facts.front || facts.runs.length ? (one.maximise ? 'maximise' : 'minimise') : facts.objective.sense);
  const heading = (name) => {
    const constraint = facts.constraints.find((one) => one.name === name);
    return h('th', { title: facts.meaning(name) }, facts.label(name), constraint && h('small', {}, facts.limit(constraint)), objectives.filter((one) => one.name === name).map((one) => h('small', {}, `objective, ${sense(one)}`)));
  };
  return [caption ? h('h3', {}, caption) : null, h('div', { class: 'scroll' }, h('table', { class: 'board' },
    h('thead', {}, h('tr', {}, h('th', {}, 'design'), names.map(heading), h('th', {}, 'constraints'))),
    h('tbody', {}, ranked(facts, designs, objective).map(row))))];
}

function board(facts) {
  if (facts.designs.length < 2) return null;
  return rankedTogether(facts).map((group) => groupBoard(facts, group));
}

/** Scores of the board that have a sentence in `glint explain`: objectives of all groups, and what is shown of each. */
export function explainedScores(facts) {
  const names = new Set([...rankedTogether(facts).map(({ objective }) => objective.name), ...facts.mainScores()]);
  return [...names].filter((name) => name && facts.info(name).meaning);
}

function meanings(facts) {
  const names = explainedScores(facts);
  return names.length > 0 && h('dl', { class: 'meanings' }, names.map((name) => [h('dt', {}, facts.label(name)), h('dd', {}, facts.info(name).meaning)]));
}

export function verdictSection(facts) {
  const verdict = facts.data.verdict ?? {};
  const table = board(facts);
  const hasFresh = facts.designs.some((design) => Object.keys(design.rescored ?? {}).length > 0);
  return section('verdict', verdict.title ?? 'Verdict', null, h('p', { class: `sentence ${verdict.tone ?? ''}` }, verdict.sentence ?? 'No result yet.'),
    (verdict.details ?? []).map((line) => h('p', { class: 'detail' }, line)), figures(facts), table,
    table && hasFresh && h('p', { class: 'caption' }, `Bold: scored again with fresh seeds and finer sampling${facts.trials.length ? ', which the search never saw. Small: the number the search worked with.' : '. Small: with the seeds of the study.'}`), meanings(facts));
}
