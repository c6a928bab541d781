// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of populations: parts by their biggest defect and the sum of all, probability of detection, lightings compared.
import { axisStyle, chart, encode, kHalo, kInk, kText } from './charts.js';
import { h } from './dom.js';
import { isNumber, microns, number, percent, plural } from './format.js';

const kColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const kSymbols = ['circle', 'rect', 'triangle', 'diamond'];

/** Rejected parts are drawn first, so that the few among the good ones are seen. */
const kGrades = {
  Rejected: { symbol: 'triangle', colour: '#c0392b' },
  Acceptable: { symbol: 'rect', colour: '#e69f00' },
  Perfect: { symbol: 'circle', colour: '#009e73' },
};

const kHint = { confine: true, textStyle: { fontSize: 12, color: kInk } };
const kSilent = { symbol: 'none', silent: true, tooltip: { show: false } };
const kMiddle = { nameLocation: 'middle', ...axisStyle };

/** The next number at or above it that is 1, 2 or 5 times a power of ten. */
function roundAbove(value) {
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  return power * ([1, 2, 5].find((step) => step * power >= value * 0.999999) ?? 10);
}

/** 1, 2 and 5 times powers of ten. */
function roundNumbers(low, high) {
  const values = [];
  for (let value = roundAbove(low); value <= high * 1.000001; value = roundAbove(value * 1.1)) values.push(value);
  return values;
}

/** Grid lines and labels of an axis at these values. */
const ticksAt = (customValues, formatter) => ({ ...kMiddle, axisTick: { show: false, customValues }, splitLine: { ...axisStyle.splitLine, customValues },
  axisLabel: { ...axisStyle.axisLabel, customValues, formatter, hideOverlap: true } });

/** An axis from 0 on by square roots, to which values are given as their roots. */
function rootAxis(most) {
  const roots = [0];
  for (const root of roundNumbers(1e-4 * most, most).map(Math.sqrt)) {
    if (root - roots[roots.length - 1] >= 0.08 * Math.sqrt(most)) roots.push(root);
  }
  return { type: 'value', min: 0, max: Math.sqrt(most), ...ticksAt(roots, (root) => number(root * root)) };
}

/** The box within which parts get a grade; a side beyond the chart is left out. */
function limitSeries(grade, biggest, sum, most) {
  const { colour } = kGrades[grade];
  const x = Math.sqrt(Math.min(biggest ?? Infinity, most.biggest));
  const y = Math.sqrt(Math.min(sum ?? Infinity, most.sum));
  const isAtTop = y * y >= most.sum;
  const label = { show: true, formatter: `${grade} below`, position: [6, isAtTop ? { Perfect: 18, Acceptable: 4 }[grade] : -14], ...kHalo, color: colour };
  return { ...kSilent, name: `limits of ${grade}`, type: 'line', symbol: 'circle', symbolSize: 1, color: colour, lineStyle: { width: 1.6, type: 'dashed' },
    data: [x * x < most.biggest && [x, 0], [x, y], isAtTop && '-', { value: [0, y], label }].filter(Boolean) };
}

function sizesText(point, unit) {
  const found = `biggest ${number(point.biggest)} ${unit}, sum ${number(point.sum)} ${unit}`;
  return [point.name && `<b>${encode(point.name)}</b>`, found, `${point.grade}${point.is_wrong ? ', sorted otherwise' : ''}`].filter(Boolean).join('<br>');
}

function sizesSeries(points) {
  const place = (point) => [Math.sqrt(point.biggest), Math.sqrt(point.sum)];
  const ofGrade = ([grade, look]) => ({ name: grade, type: 'scatter', symbol: look.symbol, symbolSize: 8, color: look.colour,
    data: points.filter((point) => point.grade === grade).map((point) => ({ value: place(point), point,
      itemStyle: { color: point.is_tested ? look.colour : '#fff', borderColor: look.colour, borderWidth: 1.3 } })) });
  const wrong = points.filter((point) => point.is_wrong && point.is_tested);
  return [...Object.entries(kGrades).map(ofGrade), { name: 'sorted otherwise', type: 'scatter', symbol: 'circle', symbolSize: 17, silent: true,
    itemStyle: { color: 'transparent', borderColor: kInk, borderWidth: 1.6 }, data: wrong.map(place) }].filter((series) => series.data.length > 0);
}

/** Sum of all defects against the biggest, as figures 24 and 25 of the first seed have them: { title, unit, limits, points }. */
export function sizesChart({ title, unit, limits, points }) {
  const high = (name) => 1.08 * points.reduce((most, point) => Math.max(most, point[name]), 1);
  const most = { biggest: high('biggest'), sum: high('sum') };
  const series = sizesSeries(points);
  const hasMore = limits.acceptable_biggest > limits.perfect_biggest || limits.acceptable_sum > limits.perfect_sum;
  const lines = [limitSeries('Perfect', limits.perfect_biggest, limits.perfect_sum, most),
    hasMore && limitSeries('Acceptable', limits.acceptable_biggest, limits.acceptable_sum, most)].filter(Boolean);
  const option = () => ({
    grid: { left: 64, right: 20, top: 40, bottom: 46 },
    legend: { top: 0, left: 56, itemWidth: 12, itemHeight: 12, itemGap: 16, textStyle: kText, data: series.map((one) => one.name) },
    tooltip: { ...kHint, formatter: (item) => sizesText(item.data.point, encode(unit)) },
    xAxis: { ...rootAxis(most.biggest), name: `biggest defect of the part (${unit})`, nameGap: 28 },
    yAxis: { ...rootAxis(most.sum), name: `sum of all its defects (${unit})`, nameGap: 46 },
    series: [...lines, ...series],
  });
  const none = points.filter((point) => point.sum <= 0).length;
  const caption = [points.some((point) => !point.is_tested) && 'Filled marks: limits tested on the part; open ones: learned from it.',
    none > 0 && `${plural(none, 'part')} with none, at the corner.`].filter(Boolean).join(' ');
  return h('div', {}, h('h3', {}, title), chart(420, title, points.length, option), h('p', { class: 'muted' }, caption));
}

/** An interval as a bar: data are [at, low, high] along an axis; `aside` moves it, in pixels. */
function bars(name, data, colour, aside, isUpright) {
  const end = (api, k) => api.coord(isUpright ? [api.value(0), api.value(k)] : [api.value(k), api.value(0)]).map((at, i) => at + (i === (isUpright ? 0 : 1) ? aside : 0));
  const renderItem = (params, api) => {
    const [low, high] = [end(api, 1), end(api, 2)];
    return { type: 'line', shape: { x1: low[0], y1: low[1], x2: high[0], y2: high[1] }, style: { stroke: colour, lineWidth: 1.4 } };
  };
  return { ...kSilent, name, type: 'custom', renderItem, data, color: colour, encode: isUpright ? { x: 0, y: [1, 2] } : { y: 0, x: [1, 2] } };
}

function bandSeries(name, points, colour) {
  const renderItem = (params, api) => ({ type: 'polygon', style: { fill: colour, opacity: 0.16 },
    shape: { points: [...points.map((point) => api.coord([point.size, 100 * point.low])), ...[...points].reverse().map((point) => api.coord([point.size, 100 * point.high]))] } });
  return { ...kSilent, name, type: 'custom', clip: true, renderItem, color: colour, data: [[points[0].size, 50]] };
}

function levelText(level, unit) {
  return `${number(level.size, 3)} ${encode(unit)}: ${level.hits} of ${level.defects - level.masked} found, ${percent(level.share.value)}<br>${percent(level.share.low)} to ${percent(level.share.high)}`;
}

/** Band, curve, counted shares and the tips of a90 of one design; designs stand a little beside each other. */
function podSeries([key, design], i, all, curve, unit) {
  const colour = kColours[i % kColours.length];
  const symbol = kSymbols[i % kSymbols.length];
  const aside = 5 * (i - 0.5 * (all.length - 1));
  const levels = design.levels.filter((level) => level.share);
  const tip = (size, isOpen) => isNumber(size) && { name: key, type: 'scatter', symbol: 'triangle', symbolSize: 10, symbolOffset: [0, 5], z: isOpen ? 4 : 5, color: colour,
    itemStyle: { color: isOpen ? '#fff' : colour, borderColor: colour, borderWidth: 1.2, opacity: 1 },
    data: [{ value: [size, 90], text: `${isOpen ? 'a90/95' : 'a90'}: ${number(size, 3)} ${encode(unit)}` }] };
  return [curve && bandSeries(key, curve, colour),
    curve && { ...kSilent, name: key, type: 'line', color: colour, lineStyle: { width: 2 }, data: curve.map((point) => [point.size, 100 * point.value]) },
    bars(key, levels.map((level) => [level.size, 100 * level.share.low, 100 * level.share.high]), colour, aside, true),
    { name: key, type: 'scatter', symbol, symbolSize: 8, symbolOffset: [aside, 0], color: colour, itemStyle: { color: '#fff', borderColor: colour, borderWidth: 1.3, opacity: 1 },
      data: levels.map((level) => ({ value: [level.size, 100 * level.share.value], text: levelText(level, unit) })) },
    tip(design.fit?.a90_95, true), tip(design.fit?.a90.value, false)].filter(Boolean);
}

/** Probability of detection against size: { pod, curves } of a run's result.json and pod_curves.json. */
export function podChart({ pod, curves }) {
  const designs = Object.entries(pod.designs);
  const sizes = designs[0][1].levels.map((level) => level.size);
  const unit = microns(pod.unit);
  const title = `How surely a ${pod.group} is found`;
  const words = (key) => `${pod.designs[key].title}${pod.designs[key].fit ? '' : ' (no curve: found shares do not rise with size)'}`;
  const top = 24 + 20 * designs.length;
  const ninety = { ...kSilent, type: 'line', data: [], markLine: { silent: true, symbol: 'none', label: { show: false }, lineStyle: { color: '#8a949e', type: 'dotted' }, data: [{ yAxis: 90 }] } };
  const option = (width) => ({
    grid: { left: 62, right: 20, top, bottom: 46 },
    legend: { top: 0, left: 54, orient: 'vertical', itemWidth: 12, itemHeight: 12, itemGap: 8, formatter: words, data: designs.map(([key], i) => ({ name: key, icon: kSymbols[i % kSymbols.length] })),
      textStyle: { ...kText, width: width - 120, overflow: 'truncate' } },
    tooltip: { ...kHint, formatter: (item) => `<b>${encode(pod.designs[item.seriesName].title)}</b><br>${item.data.text}` },
    xAxis: { type: 'log', min: 0.9 * sizes[0], max: 1.1 * sizes[sizes.length - 1], ...ticksAt(roundNumbers(0.9 * sizes[0], 1.1 * sizes[sizes.length - 1]), (value) => number(value, 2)),
      name: `${pod.size.split('_')[0].replace('height', 'depth')} of the defect (${unit})`, nameGap: 28 },
    yAxis: { type: 'value', min: 0, max: 100, name: 'defects found where the line looks (%)', nameGap: 36, ...kMiddle },
    series: [...designs.flatMap((design, i) => podSeries(design, i, designs, curves?.[design[0]], unit)), ninety],
  });
  return h('div', {}, h('h3', {}, title), chart(top + 400, title, 0, option),
    h('p', { class: 'muted' }, `Bars and bands: ${number(100 * pod.confidence)} % confidence. Tips at 90 %: a90, open ones a90/95.`));
}

/** Designs below each other by one figure: marks are { name, colour, symbol, isOpen, aside, estimate(design, key), place(value), text(value) }. */
function designsChart(title, axis, designs, marks) {
  const shown = (mark) => designs.map(([key, design], row) => ({ row, title: design.title, estimate: mark.estimate(design, key) })).filter((one) => one.estimate);
  const text = (mark, { title: of, estimate }) => `<b>${encode(of)}</b><br>${mark.name}: ${mark.text(estimate.value)} (${mark.text(estimate.low)} to ${mark.text(estimate.high)})`;
  const series = marks.flatMap((mark) => [
    bars(mark.name, shown(mark).map(({ row, estimate }) => [row, mark.place(estimate.low), mark.place(estimate.high)]), mark.colour, mark.aside, false),
    { name: mark.name, type: 'scatter', symbol: mark.symbol, symbolSize: 9, symbolOffset: [0, mark.aside], color: mark.colour,
      itemStyle: { color: mark.isOpen ? '#fff' : mark.colour, borderColor: mark.colour, borderWidth: 1.4, opacity: 1 },
      data: shown(mark).map((one) => ({ value: [mark.place(one.estimate.value), one.row], text: text(mark, one) })) }]);
  const top = 56;
  const option = (width) => ({
    grid: { left: Math.min(220, 0.4 * width), right: 24, top, bottom: 46 },
    legend: { top: 0, left: 0, orient: 'vertical', itemWidth: 12, itemHeight: 12, itemGap: 8, textStyle: kText, data: marks.map(({ name, symbol }) => ({ name, icon: symbol })) },
    tooltip: { ...kHint, formatter: (item) => item.data.text },
    xAxis: { ...axis, nameGap: 28 },
    yAxis: { type: 'category', inverse: true, data: designs.map(([, design]) => design.title), ...axisStyle, splitLine: { show: false },
      axisLabel: { color: kInk, width: Math.min(220, 0.4 * width) - 16, overflow: 'truncate', interval: 0 } },
    series,
  });
  return chart(top + 46 + 38 * designs.length, title, 0, option);
}

/** Shares and rates of designs beside each other: { designs } of sorting in result.json. */
export function lightingsChart({ designs: byKey }) {
  const designs = Object.entries(byKey);
  const title = 'How sorting moves with lighting, noise and fringes';
  const learned = (design) => design.share_right;
  const own = (design, key) => (key === 'baseline' ? null : design.share_right_with_own_limits);
  const rate = (design) => design.false_alarms.per_part;
  const least = Math.min(...designs.flatMap(([key, design]) => [learned(design).low, (own(design, key) ?? learned(design)).low]));
  const most = Math.max(...designs.map(([, design]) => rate(design).high));
  const share = { place: (value) => 100 * value, text: percent };
  const shareAxis = { type: 'value', min: Math.min(90, 10 * Math.floor(10 * least)), max: 100, ...kMiddle, name: 'tested parts in the expert\u2019s class (%)' };
  const rateAxis = { ...rootAxis(most > 0 ? roundAbove(most) : 1), name: 'false alarms on a flawless part' };
  return h('div', { class: 'wide' }, h('h3', {}, title), h('div', { class: 'pair' },
    designsChart(title, shareAxis, designs, [
      { ...share, name: 'limits learned at that lighting', colour: '#0072b2', symbol: 'circle', aside: -6, estimate: learned },
      { ...share, name: 'limits of the study\u2019s own lighting', colour: '#56b4e9', symbol: 'diamond', isOpen: true, aside: 6, estimate: own }]),
    designsChart('False alarms', rateAxis, designs, [{ name: 'false alarms', colour: '#d55e00', symbol: 'rect', aside: 0, estimate: rate, place: Math.sqrt, text: (value) => number(value, 3) }])));
}
