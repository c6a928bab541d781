// SPDX-License-Identifier: GPL-3.0-or-later
// Convergence, parallel coordinates and slices, drawn by ECharts.
import * as echarts from 'echarts/core';
import { CustomChart, LineChart, ParallelChart, ScatterChart } from 'echarts/charts';
import { GridComponent, LegendComponent, MarkLineComponent, ParallelComponent, TooltipComponent } from 'echarts/components';
import { LabelLayout } from 'echarts/features';
import { CanvasRenderer, SVGRenderer } from 'echarts/renderers';
import { h, section } from './dom.js';
import { isDone, isGood, isNumber, number, plural, stateOf } from './format.js';

echarts.use([CustomChart, LineChart, ParallelChart, ScatterChart, GridComponent, LegendComponent, MarkLineComponent, ParallelComponent,
  TooltipComponent, LabelLayout, CanvasRenderer, SVGRenderer]);

// Okabe and Ito's colours, told apart by all common kinds of colour vision; shapes differ as well.
const kBlue = '#0072b2';
const kOrange = '#d55e00';
const kGrey = '#8a949e';
export const kInk = '#27313a';
const kRunColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#5b6670'];
const kManyTrials = 2000;  // above this a canvas is quicker than SVG, and as good on paper

export const kText = { fontFamily: getComputedStyle(document.body).fontFamily, color: kInk, fontSize: 12 };

let isAttached = false;
document.body.addEventListener('glint-attached', () => { isAttached = true; }, { once: true });

/** A chart that is drawn once its place has a size, and follows it; on a page that stands already with the next frame. */
export function chart(heightPx, label, points, option, ready) {
  const place = h('div', { class: 'chart', style: `height:${heightPx}px`, role: 'img', 'aria-label': label });
  const draw = () => {
    const renderer = points > kManyTrials ? 'canvas' : 'svg';
    const instance = echarts.init(place, null, { renderer });
    instance.setOption({ animation: false, textStyle: kText, ...option(place.clientWidth) });
    let width = place.clientWidth;
    new ResizeObserver(() => {
      if (place.clientWidth === width || place.clientWidth === 0) return;
      width = place.clientWidth;
      instance.resize();
      instance.setOption(option(width));
      fitToPaper();
    }).observe(place);
    ready?.(instance);
  };
  if (isAttached) requestAnimationFrame(draw);
  else document.body.addEventListener('glint-attached', draw, { once: true });
  return place;
}

/** With a view box a chart shrinks to the width of the paper instead of being cut. */
function fitToPaper() {
  for (const svg of document.querySelectorAll('.chart svg')) svg.setAttribute('viewBox', `0 0 ${svg.getAttribute('width')} ${svg.getAttribute('height')}`);
}

window.addEventListener('beforeprint', fitToPaper);

export const kHalo = { fontSize: 10.5, color: kInk, textBorderColor: '#fff', textBorderWidth: 3 };  // readable over lines

export const axisStyle = {
  axisLine: { onZero: false, lineStyle: { color: '#b8c0c7' } },
  axisTick: { show: false },
  axisLabel: { color: '#55606a' },
  nameTextStyle: { color: kInk },
  splitLine: { lineStyle: { color: '#eceff1' } },
};

export const encode = (text) => echarts.format.encodeHTML(text);

/** A score as an axis has it. */
export const valueLabel = (facts, name) => (value) => (facts.info(name).format === 'percent' ? `${Number((100 * value).toFixed(1))} %` : number(value));

const objectiveLabel = (facts, name = facts.objective.name) => valueLabel(facts, name);

function trialText(facts, trial) {
  const lines = [`<b>evaluation ${trial.number}</b>, ${stateOf(trial)}`, `${echarts.format.encodeHTML(facts.label(facts.objective.name))}: ${facts.score(facts.objective.name, trial.objective)}`];
  for (const constraint of [...facts.objectives.slice(1), ...facts.constraints]) {
    const value = trial.scores?.[constraint.name];
    if (isNumber(value)) lines.push(`${echarts.format.encodeHTML(facts.label(constraint.name))}: ${facts.score(constraint.name, value)}`);
  }
  facts.names.slice(0, 12).forEach((name, i) => lines.push(`${echarts.format.encodeHTML(name)}: ${echarts.format.encodeHTML(number(trial.values?.[i]))}`));
  return lines.join('<br>');
}

const tooltip = (facts) => ({
  trigger: 'item', confine: true, textStyle: { fontSize: 12, color: kInk },
  formatter: (item) => (item.data?.trial ? trialText(facts, item.data.trial) : item.name || item.seriesName),
});

const scatter = (name, trials, x, symbol, style, size) => ({
  name, type: 'scatter', symbol, symbolSize: size, itemStyle: style, emphasis: { scale: 1.6 },
  data: trials.map((trial) => ({ value: [x(trial), trial.objective], trial })),
});

const feasibleSeries = (facts, x, size = 7) => scatter('feasible', facts.trials.filter(isGood), x, 'circle', { color: kBlue, opacity: 0.55 }, size);
const infeasibleSeries = (facts, x, size = 7) => scatter('not feasible', facts.trials.filter((trial) => isDone(trial) && !isGood(trial)), x,
  'triangle', { color: 'transparent', borderColor: kOrange, borderWidth: 1.2, opacity: 0.75 }, size);

/** Dashed lines at the objective of baseline and prototypes; lines close together share a label. */
function designLines(facts, [low, high]) {
  const lines = facts.designs.filter((design) => facts.role(design) !== 'winner' && isNumber(design.scores?.[facts.objective.name]))
    .map((design) => ({ name: facts.title(design), yAxis: design.scores[facts.objective.name] })).sort((a, b) => a.yAxis - b.yAxis);
  for (let i = 1; i < lines.length; ++i) {
    if (lines[i].yAxis - lines[i - 1].yAxis > 0.05 * (high - low)) continue;
    lines[i].name = `${lines[i].name}, ${lines[i - 1].name}`;
    lines[i - 1].name = '';
  }
  return { silent: true, symbol: 'none', lineStyle: { color: '#6b7680', type: 'dashed', width: 1 },
    label: { formatter: '{b}', position: 'insideEndTop', color: '#55606a', fontSize: 11, textBorderColor: '#fff', textBorderWidth: 3 }, data: lines };
}

function convergenceNote(facts, [low, high]) {
  const hidden = facts.trials.filter((trial) => isDone(trial) && (trial.objective < low || trial.objective > high)).length;
  return [hidden && `${plural(hidden, 'evaluation')} outside the drawn range.`,
    designLines(facts, [low, high]).data.length > 0 && 'Dashed lines are the baseline and the prototypes, with the seeds of the search.'].filter(Boolean).join(' ');
}

export function convergenceSection(facts) {
  if (facts.front) return null;
  const done = facts.trials.filter(isDone);
  if (!done.length) return null;
  const range = facts.objectiveRange();
  const best = facts.bestSoFar();
  const full = h('input', { type: 'checkbox' });
  const name = facts.label(facts.objective.name);
  const values = done.map((trial) => trial.objective);
  const option = () => ({
    grid: { left: 56, right: 24, top: 40, bottom: 44 },
    legend: { top: 0, right: 16, itemWidth: 16, itemGap: 18, textStyle: kText },
    tooltip: tooltip(facts),
    xAxis: { type: 'value', name: 'evaluation', nameLocation: 'middle', nameGap: 28, min: 'dataMin', max: 'dataMax', minInterval: 1, ...axisStyle, splitLine: { show: false } },
    yAxis: { type: 'value', scale: true, name, nameLocation: 'end', nameTextStyle: { color: kInk, align: 'left' }, min: full.checked ? Math.min(range[0], ...values) : range[0],
      max: full.checked ? Math.max(range[1], ...values) : range[1], ...axisStyle, axisLabel: { color: '#55606a', formatter: objectiveLabel(facts), showMinLabel: false, showMaxLabel: false } },
    series: [
      feasibleSeries(facts, (trial) => trial.number), infeasibleSeries(facts, (trial) => trial.number),
      { name: 'best so far', type: 'line', step: 'end', symbol: 'none', silent: true, lineStyle: { color: kInk, width: 2 }, itemStyle: { color: kInk },
        data: facts.trials.map((trial, i) => [trial.number, best[i]]), markLine: designLines(facts, range) },
    ],
  });
  const place = chart(360, `Convergence of ${name}`, done.length, option, (instance) => {
    full.addEventListener('change', () => instance.setOption(option()));
  });
  return section('convergence', 'Convergence', convergenceNote(facts, range),
    h('label', { class: 'inline screen-only' }, full, ' Show the full range'), place);
}

/** Words on lines of at most so many letters. */
function wrapped(words, letters) {
  const lines = [''];
  for (const word of words.split(' ')) {
    const longer = lines[lines.length - 1] ? `${lines[lines.length - 1]} ${word}` : word;
    if (longer.length <= letters || !lines[lines.length - 1]) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines.join('\n');
}

function parallelAxes(facts, constraints, width) {
  const count = facts.variables.length + constraints.length + 1;
  const letters = Math.max(6, Math.floor(width / count / 6.6));
  const style = () => ({ nameGap: 12, nameTextStyle: { color: kInk, fontSize: 11, lineHeight: 14 },
    axisLabel: { ...kHalo, formatter: (value) => number(value) }, axisLine: { lineStyle: { color: '#9aa4ad' } }, axisTick: { show: false },
    areaSelectStyle: { width: 18, borderColor: kInk, color: kInk, opacity: 0.15 } });
  const variables = facts.variables.map((variable, i) => {
    const isChoice = variable.choices?.length || variable.kind === 'boolean';
    const scale = isChoice ? { type: 'category', data: (variable.choices ?? [false, true]).map(String) }
      : { type: variable.log && variable.low > 0 ? 'log' : 'value', min: variable.low, max: variable.high, splitNumber: 4, scale: true };
    const base = style();
    return { dim: i, name: facts.names[i], ...base, ...scale, axisLabel: isChoice ? kHalo : base.axisLabel };
  });
  const scored = constraints.map((constraint, k) => ({ dim: variables.length + k, name: facts.label(constraint.name), ...style(), type: 'value', scale: true,
    axisLabel: { ...kHalo, formatter: (value) => facts.score(constraint.name, value) } }));
  const last = { dim: variables.length + constraints.length, name: facts.label(facts.objective.name), ...style(), type: 'value', scale: true,
    axisLabel: { ...kHalo, formatter: objectiveLabel(facts) } };
  last.nameTextStyle = { ...last.nameTextStyle, fontWeight: 'bold' };
  return [...variables, ...scored, last].map((axis) => ({ ...axis, name: wrapped(axis.name, letters) }));
}

/** Light to dark blue with growing quality; lightness alone carries the order. */
export function shade(fraction) {
  const stops = [[214, 222, 230], [110, 166, 205], [8, 48, 107]];
  const at = Math.min(1, Math.max(0, fraction)) * 2;
  const i = Math.min(1, Math.floor(at));
  const mix = stops[i].map((value, k) => Math.round(value + (stops[i + 1][k] - value) * (at - i)));
  return `rgb(${mix.join(',')})`;
}

export function parallelSection(facts, onChoose) {
  const done = facts.trials.filter(isDone);
  if (facts.front || done.length < 2 || !facts.variables.length) return null;
  const constraints = facts.constraints.filter((constraint) => constraint.name !== facts.objective.name && done.some((trial) => isNumber(trial.scores?.[constraint.name])));
  const sorted = [...done].sort((a, b) => (facts.better(a.objective, b.objective) ? 1 : -1));
  const cell = (value) => (value === null || value === undefined ? '-' : typeof value === 'boolean' ? String(value) : value);
  const lines = sorted.map((trial, rank) => ({
    value: [...facts.variables.map((_, i) => cell(trial.values?.[i])), ...constraints.map((c) => cell(trial.scores?.[c.name])), trial.objective],
    lineStyle: { color: isGood(trial) ? shade(rank / (sorted.length - 1)) : '#e3a27d', type: isGood(trial) ? 'solid' : 'dashed', width: rank === sorted.length - 1 ? 2.5 : 1.1 },
    trial,
  }));
  const option = (width) => ({
    parallel: { left: 40, right: 60, top: 64, bottom: 22 },
    parallelAxis: parallelAxes(facts, constraints, width),
    tooltip: tooltip(facts),
    series: [{ type: 'parallel', data: lines, lineStyle: { opacity: 0.6 }, inactiveOpacity: 0.04, activeOpacity: 0.9, smooth: false, progressive: 0 }],
  });
  const count = h('span', { class: 'muted' }, `all ${done.length} evaluations`);
  const reset = h('button', { type: 'button', class: 'screen-only' }, 'Clear the brushes');
  const place = chart(380, 'Parallel coordinates', done.length, option, (instance) => {
    instance.on('axisareaselected', () => {
      const active = instance.getModel().getSeriesByIndex(0).getRawIndicesByActiveState('active');
      const brushed = active.length > 0 || instance.getModel().queryComponents({ mainType: 'parallelAxis' }).some((axis) => axis.activeIntervals?.length);
      count.textContent = brushed ? `${active.length} of ${done.length} evaluations chosen` : `all ${done.length} evaluations`;
      onChoose(brushed ? new Set(active.map((i) => sorted[i].number)) : null);
    });
    reset.addEventListener('click', () => {
      for (let i = 0; i <= facts.variables.length + constraints.length; ++i) instance.dispatchAction({ type: 'axisAreaSelect', parallelAxisIndex: i, intervals: [] });
    });
    place.chart = instance;
  });
  place.id = 'parallel-chart';
  return section('parallel', 'All variables together', 'Each line is one evaluation, darker is better, dashed is not feasible. Drag along an axis to keep what passes through; the table below follows.',
    h('p', { class: 'toolbar' }, h('span', { class: 'ramp' }), h('span', { class: 'muted' }, 'worst to best'), count, reset), place);
}

/** A choice of one objective of several, and what follows it: draw(objective) gives nodes. */
export function objectiveSelector(facts, names, draw) {
  const place = h('div', {});
  const show = (name) => place.replaceChildren(draw(name));
  const select = h('select', { 'aria-label': 'Objective', onchange: () => show(select.value) }, names.map((name) => h('option', { value: name }, facts.label(name))));
  show(names[0]);
  return [h('p', { class: 'toolbar' }, h('label', { class: 'inline' }, 'Score ', select)), place];
}

function sliceAxis(variable, name) {
  const common = { name, nameLocation: 'middle', nameGap: 26, ...axisStyle, splitLine: { show: false } };
  if (variable.choices?.length || variable.kind === 'boolean') return { type: 'category', data: (variable.choices ?? [false, true]).map(String), ...common };
  return { type: variable.log && variable.low > 0 ? 'log' : 'value', min: variable.low, max: variable.high, splitNumber: 4, ...common,
    axisLabel: { color: '#55606a', formatter: (value) => number(value), hideOverlap: true } };
}

function sliceCharts(facts, objective) {
  const done = facts.trials.filter(isDone);
  const range = facts.objectiveRange(objective);
  const of = (trials, x, look) => ({ ...look, data: trials.map((trial) => ({ value: [x(trial), facts.scoreOf(trial, objective.name)], trial })) });
  return h('div', { class: 'slices' }, facts.variables.map((variable, i) => {
    const x = (trial) => (typeof trial.values?.[i] === 'boolean' ? String(trial.values[i]) : trial.values?.[i] ?? '-');
    const option = () => ({
      grid: { left: 50, right: 14, top: 12, bottom: 42 }, tooltip: tooltip(facts), xAxis: sliceAxis(variable, facts.names[i]),
      yAxis: { type: 'value', min: range[0], max: range[1], splitNumber: 3, ...axisStyle, axisLabel: { color: '#55606a', formatter: objectiveLabel(facts, objective.name), showMinLabel: false, showMaxLabel: false } },
      series: [of(done.filter(isGood), x, feasibleSeries(facts, x, 5)), of(done.filter((trial) => !isGood(trial)), x, infeasibleSeries(facts, x, 5))],
    });
    return chart(210, `${facts.label(objective.name)} against ${facts.names[i]}`, done.length * facts.variables.length, option);
  }));
}

export function sliceSection(facts) {
  if (!facts.trials.some(isDone) || !facts.variables.length) return null;
  const lead = `${facts.front ? 'The chosen score' : facts.label(facts.objective.name)} upwards; filled circles are feasible, open triangles are not.`;
  const objective = (name) => facts.objectives.find((one) => one.name === name) ?? { name: facts.objective.name, maximise: facts.maximise };
  return section('slices', facts.front ? 'Each variable against an objective' : 'Each variable against the objective', lead,
    facts.front ? objectiveSelector(facts, facts.objectives.map(({ name }) => name), (name) => sliceCharts(facts, objective(name))) : sliceCharts(facts, objective(facts.objective.name)));
}

/** Best so far of several runs in one picture. */
export function runCurvesSection(facts) {
  const runs = facts.runs.filter((run) => run.best_so_far?.some(isNumber));
  if (!runs.length) return null;
  const symbols = ['circle', 'rect', 'triangle', 'diamond', 'pin', 'arrow'];
  const option = () => ({
    grid: { left: 56, right: 24, top: 40, bottom: 44 },
    legend: { top: 0, right: 16, itemGap: 18, textStyle: kText },
    tooltip: { trigger: 'axis', confine: true, valueFormatter: (value) => facts.score(facts.objective.name, value) },
    xAxis: { type: 'value', name: 'evaluation', nameLocation: 'middle', nameGap: 28, ...axisStyle, splitLine: { show: false } },
    yAxis: { type: 'value', scale: true, name: facts.label(facts.objective.name), ...axisStyle, nameTextStyle: { color: kInk, align: 'left' }, axisLabel: { color: '#55606a', formatter: objectiveLabel(facts) } },
    series: runs.map((run, i) => ({ name: run.title, type: 'line', step: 'end', symbol: symbols[i % symbols.length], symbolSize: 7, showSymbol: false,
      lineStyle: { width: 2, type: ['solid', 'dashed', 'dotted'][Math.floor(i / kRunColours.length) % 3] }, color: kRunColours[i % kRunColours.length],
      data: run.best_so_far.map((value, k) => [k + 1, isNumber(value) ? value : null]) })),
  });
  return section('curves', 'Convergence of the runs', 'Best feasible objective so far.', chart(340, 'Convergence of the runs', 0, option));
}
