// SPDX-License-Identifier: GPL-3.0-or-later
// Marks and lines over two axes: { title, x, y: what the axes are, series: [{ name, is_line, is_joined: marks with a line, points: [[x, y]] }] }.
import { axisStyle, chart, kText } from './charts.js';
import { h } from './dom.js';
import { number } from './format.js';

const kColours = ['#0072b2', '#5b6670', '#d55e00', '#009e73'];
const kSymbols = ['circle', 'triangle', 'rect', 'diamond'];

export function curvesChart({ title, x, y, series }) {
  const axis = (name, nameGap) => ({ type: 'value', name, nameLocation: 'middle', nameGap, ...axisStyle,
    axisLabel: { ...axisStyle.axisLabel, formatter: (value) => number(value), hideOverlap: true } });
  const one = ({ name, is_line: isLine, is_joined: isJoined, points }, i) => ({ name, type: isLine || isJoined ? 'line' : 'scatter', data: points, silent: true, symbol: isLine ? 'none' : kSymbols[i % 4], symbolSize: 8,
    color: kColours[i % 4], lineStyle: { width: 1.6 }, itemStyle: { color: kColours[i % 4] } });
  const option = () => ({
    grid: { left: 70, right: 20, top: 40, bottom: 46 },
    legend: { top: 0, left: 56, itemWidth: 16, itemGap: 16, textStyle: kText },
    xAxis: axis(x, 28), yAxis: axis(y, 52), series: series.map(one),
  });
  return h('div', {}, h('h3', {}, title), chart(340, title, 0, option));
}
