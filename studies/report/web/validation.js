// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `glint validate`: overlap before and after calibration, causes, misfit against what was predicted, designs on both sides; the
// data is the object of result.json and what studies/validate/validate_page.cpp adds to it.
import { badge, h, picture, section } from './dom.js';
import { isNumber, number } from './format.js';

const fixed = (value, digits) => (isNumber(value) ? value.toFixed(digits) : '\u2013');
const percent = (value, digits = 1) => (isNumber(value) ? `${(100 * value).toFixed(digits)} %` : '\u2013');
const cell = (text) => h('td', { class: 'number' }, text);
const table = (head, rows) => h('div', { class: 'scroll' }, h('table', { class: 'evaluations' },
  h('thead', {}, h('tr', {}, head.map((text, i) => h('th', { class: i > 0 ? 'number' : null }, text)))), h('tbody', {}, rows)));
const words = (name) => name.replaceAll('_', ' ');

function overlay(image, text) {
  return image && h('figure', {}, picture(image, text, 'frame'), h('figcaption', {}, text));
}

function beforeShown(row) {
  return h('div', { class: 'pair' }, overlay(row.overlay, `${row.view} before the calibration: edges ${fixed(row.mean_distance_px, 2)} px apart.`),
    overlay(row.overlay_after, `${row.view} after it.`));
}

export function overlapSection(facts) {
  const data = facts.data.validation;
  if (!data?.before.length) return null;
  const { edges } = data;
  return section('overlap', 'Overlap before and after the calibration', `The simulated part in red on the photograph. Edges lie ${fixed(edges.before_calibration_px, 2)} px apart with the design's own camera, ${fixed(edges.mean_distance_px, 2)} px with the calibrated one.`,
    data.before.filter((row) => row.overlay).map(beforeShown));
}

function valuesText(values) {
  return Object.entries(values).map(([name, value]) => `${words(name)} ${number(value.value, 3)}${value.sigma > 0 ? ` \u00b1 ${number(value.sigma, 2)}` : ''}`).join(', ');
}

export function causesSection(facts) {
  const data = facts.data.validation;
  if (!data) return null;
  const row = (cause) => h('tr', {}, h('td', {}, words(cause.name), cause.of && ` of ${words(cause.of)}`), cell(valuesText(cause.values)),
    h('td', {}, badge(cause.within_tolerance ? 'neutral' : 'bad', cause.within_tolerance ? 'a refit sets it right' : 'beyond tolerance')),
    h('td', {}, cause.or.length ? `or ${cause.or.map(words).join(', ')}` : ''));
  return section('why', 'Causes', data.causes.length ? 'Beyond what calibration, placement and noise explain.' : 'Nothing beyond what calibration, placement and noise explain.',
    data.causes.length > 0 && table(['cause', 'value', 'judged', ''], data.causes.map(row)));
}

export function misfitSection(facts) {
  const data = facts.data.validation;
  if (!data) return null;
  const { edges } = data;
  const px = (name, seen, budget) => h('tr', {}, h('td', {}, name), cell(`${fixed(seen, 3)} px`), cell(budget === null ? '\u2013' : `${fixed(budget, 3)} px`));
  const rows = [px('edges, mean distance', edges.mean_distance_px, edges.limit_px), px('pose (part, hand-eye, robot)', edges.pose_px, edges.pose_budget_px), px('lens', edges.lens_px, edges.lens_budget_px), px('not explained', edges.rest_px, edges.noise_px)];
  const grey = data.grey.map((row) => h('tr', {}, h('td', {}, `grey values of ${row.design}: as designed, exposed alike, after the fit`), cell([row.before_share, row.exposed_share, row.after_share].map((value) => percent(value)).join(', ')), cell(percent(row.limit_share))));
  const texture = h('tr', {}, h('td', {}, 'texture, log10 of spectra'), cell(fixed(data.texture.spectrum_log10, 3)), cell(fixed(data.texture.limit, 3)));
  return section('misfit', 'Where the misfit comes from', 'Root mean squares along the edges, and what calibration and placement predicted; grey values as shares of their mean.',
    table(['part', 'seen', 'predicted or allowed'], [...rows, ...grey, texture]));
}

const estimate = (value, digits = 4) => (!value ? '\u2013' : isNumber(value.low) ? `${fixed(value.value, digits)} (${fixed(value.low, digits)} to ${fixed(value.high, digits)})`
  : `${fixed(value.value, digits)}${value.interval ? ` (${value.interval})` : ''}`);

function scoreRows(data) {
  const names = [...new Set(data.designs.flatMap((design) => Object.keys(design.scores ?? {})))]
    .filter((name) => data.rankings.some((by) => by.objective === name) || name === 'homogeneity.h_rms' || /^defects\.[^.]+\.contrast$/.test(name));
  return data.designs.flatMap((design) => names.filter((name) => design.scores?.[name]).map((name) => h('tr', {}, h('td', {}, `${design.name}: ${name}`), cell(estimate(design.scores[name].simulated)), cell(estimate(design.scores[name].real)))));
}

function foundRows(design) {
  const seen = design.inspection;
  if (!seen.defects) return [];
  const rate = (value) => (value ? `${percent(value.value, 0)} (${percent(value.low, 0)} to ${percent(value.high, 0)})` : '\u2013');
  const beyond = seen.defects - seen.defects_real;
  return [h('tr', {}, h('td', {}, `${design.name}: defects found of ${seen.defects}${beyond > 0 ? `, ${beyond} of them outside the photographs` : ''}; of ${seen.found_on_both} on both sides ${seen.same_class} of the same class`), cell(rate(seen.rate_simulated)), cell(rate(seen.rate_real))),
    h('tr', {}, h('td', {}, `${design.name}: found ones of the right class`), cell(rate(seen.right_class_simulated)), cell(rate(seen.right_class_real)))];
}

export function rankingSection(facts) {
  const data = facts.data.validation;
  if (!data) return null;
  const verdict = (pair) => (pair.against ? badge('bad', 'reversed') : pair.level ? badge('neutral', 'cannot be told') : badge('good', 'the same'));
  const row = (pair) => h('tr', {}, h('td', {}, `${pair.first} against ${pair.second}`), cell(estimate(pair.simulated)), cell(estimate(pair.real)), h('td', {}, verdict(pair)));
  const ordered = ({ objective, ranking, reason }) => (ranking
    ? [h('h3', {}, `Ranking by ${objective}`), h('p', {}, `Simulated ${ranking.simulated.join(', ')}; in reality ${ranking.real.join(', ')}.`), table(['first is better by', 'simulated', 'real', 'order'], ranking.pairs.map(row))]
    : [h('h3', {}, `Ranking by ${objective}`), h('p', {}, `None: ${reason}.`)]);
  return section('sides', 'Designs on both sides', null,
    table(['score', 'simulated', 'real'], [...scoreRows(data), ...data.designs.flatMap(foundRows)].filter(Boolean)), data.rankings.map(ordered));
}

export function refitSection(facts) {
  const data = facts.data.validation;
  if (!data?.refit) return null;
  const { refit } = data;
  const light = (row) => h('li', {}, `${row.name}: moved by ${row.moved_mm.map((value) => fixed(value, 2)).join(', ')} mm`, row.segment_power.length > 0 && `; powers ${row.segment_power.map((value) => fixed(value, 2)).join(', ')}`);
  const scored = refit.rescored;
  const row = (design) => h('tr', {}, h('td', {}, design.name), cell(fixed(design.before, 4)), cell(fixed(design.after, 4)));
  return section('refit', 'All designs with what the refit found', scored && (scored.untold ? `Whether ${scored.untold} takes the place of ${scored.winner_before} cannot be told: less than two standard errors of rendering apart.` : scored.changed ? `The winner changes: ${scored.winner_after} instead of ${scored.winner_before}.` : `The winner stays: ${scored.winner_after}.`),
    h('ul', { class: 'notes' }, h('li', {}, `exposure \u00d7 ${fixed(refit.exposure, 3)}, roughness \u00d7 ${fixed(refit.roughness, 3)}`), refit.lights.map(light)),
    scored && table(['design', `${scored.objective} before`, 'after'], scored.designs.map(row)));
}
