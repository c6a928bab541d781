// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the page from the JSON object in it; see studies/report/report.h for its fields.
import { analysisSection } from './analysis.js';
import { accuracySection, comparedSection, contactSection, influenceSection, nextSection, pictureTableSection, residualSection } from './calibration.js';
import { designSection } from './cards.js';
import { badge, h, section } from './dom.js';
import { Facts, isNumber, plural } from './format.js';
import { convergenceSection, parallelSection, runCurvesSection, sliceSection } from './charts.js';
import { coverageSection, coverageViewsSection } from './coverage.js';
import { frontSections, hypervolumeSection } from './front.js';
import { inspectorSection, inspectorTableSection } from './inspector.js';
import { searchesSection, searchesTableSection } from './searches.js';
import { frontierRankingSection, frontierScoreSection, frontierSection, frontierTableSection } from './frontier.js';
import { stabilityChartSection, stabilityRemarkSection, stabilitySection } from './stability.js';
import { foundSection, gradesSection, partsSection } from './inspection.js';
import { comparisonSection, pairsSection, yardstickSection } from './comparison.js';
import { panelSections } from './panels.js';
import { frontParallelSection } from './parallel.js';
import { sceneSection } from './scene.js';
import { Selection } from './selection.js';
import { evaluationSection, failureSection } from './table.js';
import { causesSection, misfitSection, overlapSection, rankingSection, refitSection } from './validation.js';
import { verdictSection } from './verdict.js';
import { lightingSection, viewsSection } from './views.js';

const kStatus = {
  done: ['good', 'search complete'],
  budget: ['neutral', 'budget used up'],
  interrupted: ['bad', 'interrupted'],
  no_feasible: ['bad', 'no feasible design'],
};

function masthead(facts) {
  const { data } = facts;
  const [kind, text] = kStatus[data.status] ?? ['neutral', data.status];
  const counts = facts.runs.length ? `${plural(facts.runs.reduce((sum, run) => sum + (run.evaluations ?? 0), 0), 'evaluation')} in all`
    : facts.trials.length ? `${plural(facts.trials.length, 'evaluation')}, ${facts.trials.filter((trial) => trial.failed).length} failed`
      : facts.designs.length ? `${plural(facts.designs.length, 'design')}, no search` : null;
  return h('header', { class: 'masthead' }, h('p', { class: 'brand' }, 'Glint', h('span', {}, ' report')),
    h('h1', {}, data.title ?? 'Report'), data.subtitle && h('p', { class: 'lead' }, data.subtitle),
    h('p', { class: 'meta' }, text && badge(kind, text), counts && h('span', {}, counts), document.getElementById('when')));
}

const kShort = { residuals: 'Residuals', compared: 'Methods', influence: 'Influence', next: 'Next pictures', accuracy: 'Accuracy', list: 'Table', scene: 'Part', designs: 'Designs', parallel: 'Parallel coordinates', slices: 'Variables', frontier: 'Error and time', inspector: 'Found and false', filters: 'All filters', searches: 'Searches', searched: 'All searches', stability: 'Sweeps', errors: 'Errors', remarks: 'Refusals', measured: 'All methods', ranking: 'Order of designs', score_errors: 'Scores', yardstick: 'Yardstick', overlap: 'Overlap', misfit: 'Misfit', sides: 'Designs', refit: 'Refit', methods: 'Method', origin: 'Configuration', curves: 'Convergence', front: 'Front', 'front-designs': 'Designs of the front' };

function navigation(sections) {
  return h('nav', {}, sections.map((node) => h('a', { href: `#${node.id}` }, kShort[node.id] ?? node.querySelector('h2').textContent)));
}

function methodSection(facts) {
  const methods = facts.data.methods ?? [];
  if (!methods.length) return null;
  return section('methods', 'Method and accuracy', null, h('ul', { class: 'methods' }, methods.map((line) => h('li', {}, line))));
}

const flat = (value) => (value !== null && typeof value === 'object' ? JSON.stringify(value) : String(value));

function originSection(facts) {
  const { config_toml: config, provenance } = facts.data;
  const rows = Object.entries(provenance ?? {}).map(([name, value]) => h('tr', {}, h('th', {}, name.replaceAll('_', ' ')), h('td', {}, flat(value))));
  const licences = document.getElementById('licences')?.textContent.trim();
  return section('origin', 'Configuration and provenance', null,
    rows.length > 0 && h('table', { class: 'provenance' }, h('tbody', {}, rows)),
    config && h('details', { class: 'screen-only' }, h('summary', {}, 'Resolved configuration (TOML)'), h('pre', {}, config)),
    licences && h('details', { class: 'screen-only' }, h('summary', {}, 'Licences of the software in this file'), h('pre', {}, licences)));
}

function runTable(facts) {
  if (!facts.runs.length) return null;
  const names = [...new Set([facts.objective.name, ...facts.runs.flatMap((run) => Object.keys(run.scores ?? {}))])].filter((name) => name && !name.endsWith('.error') && name.split('.').length < 3).slice(0, 8);
  const cell = (run, name) => h('td', {}, h('b', {}, facts.score(name, run.rescored?.[name] ?? run.scores?.[name])),
    isNumber(run.rescored?.[name]) && h('small', {}, `${facts.origin({ run: run.title })} ${facts.score(name, run.scores?.[name])}`));
  const row = (run) => h('tr', {}, h('th', {}, run.title), h('td', {}, kStatus[run.status]?.[1] ?? run.status ?? ''),
    h('td', {}, run.evaluations ?? '\u2013'), h('td', {}, run.failed ?? '\u2013'), h('td', {}, run.feasible === false ? 'no' : run.feasible ? 'yes' : '\u2013'),
    names.map((name) => cell(run, name)));
  return section('runs', 'Runs', 'The best design of each run; bold numbers come from fresh seeds where there are any.',
    h('div', { class: 'scroll' }, h('table', { class: 'board' },
      h('thead', {}, h('tr', {}, ['run', 'status', 'evaluations', 'failed', 'feasible'].map((text) => h('th', {}, text)), names.map((name) => h('th', { title: facts.meaning(name) }, facts.label(name))))),
      h('tbody', {}, facts.runs.map(row)))));
}

function main() {
  const data = JSON.parse(document.getElementById('data').textContent);
  const facts = new Facts(data);
  const selection = new Selection();
  const front = frontSections(facts, selection);
  const table = evaluationSection(facts, selection);
  const sections = [
    verdictSection(facts), sceneSection(facts), ...panelSections(facts), runTable(facts), runCurvesSection(facts), ...front, designSection(facts), convergenceSection(facts), hypervolumeSection(facts),
    parallelSection(facts, (chosen) => selection.brush('parallel', chosen)), frontParallelSection(facts, selection), sliceSection(facts), analysisSection(facts), table?.node, failureSection(facts),
    frontierSection(facts), frontierRankingSection(facts), frontierTableSection(facts), frontierScoreSection(facts), inspectorSection(facts), inspectorTableSection(facts), searchesSection(facts), searchesTableSection(facts), stabilitySection(facts), stabilityChartSection(facts), stabilityRemarkSection(facts), viewsSection(facts), lightingSection(facts), coverageSection(facts), coverageViewsSection(facts),
    contactSection(facts), residualSection(facts), comparedSection(facts), accuracySection(facts), influenceSection(facts),
    nextSection(facts), pictureTableSection(facts),
    partsSection(facts), gradesSection(facts), foundSection(facts), overlapSection(facts), causesSection(facts), misfitSection(facts), rankingSection(facts), refitSection(facts), pairsSection(facts), yardstickSection(facts), comparisonSection(facts), methodSection(facts), originSection(facts),
  ].filter(Boolean);
  document.getElementById('report').append(masthead(facts), navigation(sections), h('main', {}, sections));
  document.body.dispatchEvent(new CustomEvent('glint-attached'));
}

/** On paper the variables are unfolded; the rest is for the screen. */
function unfoldForPrint() {
  let opened = [];
  window.addEventListener('beforeprint', () => {
    opened = [...document.querySelectorAll('details.variables:not([open])')];
    for (const details of opened) details.open = true;
  });
  window.addEventListener('afterprint', () => {
    for (const details of opened) details.open = false;
  });
}

main();
unfoldForPrint();
