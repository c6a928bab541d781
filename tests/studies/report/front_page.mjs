// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node front_page.mjs BROWSER PAGE.html [--png FILE --width PX]
//
// Uses the page of a study with several objectives as a reader does, in a headless Chromium, and writes one JSON object of what it saw:
//   first     what is looked at when the page opens: { title, pictures }, pictures with what they are
//   clicked   the same after a click on the first point of the front that is not the compromise; `wanted` its evaluation
//   far       the same after a click on an evaluation that is not on the front
//   framed    after a frame is drawn around the left half of the front's chart: { inside, evaluations, designs, dimmed, points, lines }: evaluations in
//             it by the data, rows that the tables tell of, pictures that are dimmed, and of both charts { count, pixels }: what they show as chosen
//   cleared   the same after a click on the button
//   axis      the same after the lower half of the first axis of the parallel coordinates is chosen
//   filtered  the same after a filter of the table, unfiltered: after it is gone
//   sorted    evaluations of the table of the front, sorted by its second objective: { up, down } as numbers
//   set       the line of the first row to copy
//   cpu_ms    CPU time of the whole browser for a brush until the page was drawn anew, on average
//   ms        the same by the clock, smallest first
import { writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { Browser } from '../../cli/browser.mjs';

const [browser, page, ...rest] = process.argv.slice(2);
const option = (name) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : null);

/** In the page: what the test asks for. */
function install() {
  const data = JSON.parse(document.getElementById('data').textContent);
  const names = data.front.objectives.map((one) => one.score);
  const chart = document.querySelector('#front-chart').chart;
  const value = (trial, name) => (name === data.objective.name ? trial.objective : trial.scores[name]);
  const done = data.trials.filter((trial) => !trial.failed);
  const members = new Set(data.front.designs.map((design) => design.trial));
  const corner = () => document.querySelector('#front-chart').getBoundingClientRect();
  const settled = () => new Promise((ready) => requestAnimationFrame(() => requestAnimationFrame(ready)));
  window.seen = {
    members, done, names, value, settled,
    show: () => document.querySelector('#front-chart').scrollIntoView({ block: 'start', behavior: 'instant' }),
    pixel(trial) {
      const [x, y] = chart.convertToPixel({ gridIndex: 0 }, [value(trial, names[0]), value(trial, names[1])]);
      return [corner().left + x, corner().top + y];
    },
    /** The left half of the first panel. */
    leftHalf() {
      const { x, y, width, height } = chart.getModel().getComponent('grid', 0).coordinateSystem.getRect();
      return [[corner().left + x + 2, corner().top + y + 2], [corner().left + x + width / 2, corner().top + y + height - 2]];
    },
    inside([a, b]) {
      const [from, to] = [a, b].map(([x, y]) => chart.convertFromPixel({ gridIndex: 0 }, [x - corner().left, y - corner().top]));
      return done.filter((trial) => [0, 1].every((i) => value(trial, names[i]) >= Math.min(from[i], to[i]) && value(trial, names[i]) <= Math.max(from[i], to[i]))).length;
    },
    detail: () => ({ title: document.querySelector('#front-detail h3').textContent,
      pictures: ['img.frame', 'img.closeup', '.drawing svg', '.no-picture'].filter((one) => document.querySelector(`#front-detail ${one}`)) }),
    /** Evaluations that the charts show as chosen: what they say, and whether anything is drawn. */
    counts() {
      const shown = (place) => {
        const canvas = document.querySelector(`${place} .overlay`);
        const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        return { count: canvas.dataset.kept === '' ? null : Number(canvas.dataset.kept), pixels: pixels.filter((value, i) => i % 4 === 3 && value > 0).length };
      };
      return { evaluations: Number.parseInt(document.querySelector('#evaluations .toolbar .muted').textContent, 10), designs: document.querySelectorAll('#front-table tbody tr:not([hidden])').length,
        dimmed: document.querySelectorAll('.thumb.off').length, points: shown('#front-chart'), lines: shown('#parallel-chart') };
    },
    /** Two places of the first axis of the parallel coordinates, in the window. */
    axis(from, to) {
      const place = document.querySelector('#parallel-chart');
      place.scrollIntoView({ block: 'center', behavior: 'instant' });
      const { left, top } = place.getBoundingClientRect();
      return [from, to].map((share) => [left + place.parallel.xs[0], top + place.parallel.y(share)]);
    },
    selectAxis: (share) => document.querySelector('#parallel-chart').parallel.brush(0, share > 0 ? [0, share] : null),
    below: (share) => done.filter((trial) => trial.values[0] <= data.variables[0].low + share * (data.variables[0].high - data.variables[0].low)).length,
    filter: (text) => {
      const field = document.querySelector('#evaluations input[type=search]');
      field.value = text;
      field.dispatchEvent(new Event('input'));
    },
    async timed(act) {
      await settled();
      const start = performance.now();
      act();
      await settled();
      return performance.now() - start;
    },
  };
}

const chromium = new Browser(browser);
const limit = setTimeout(() => { chromium.close(); process.exit(1); }, 170000);
const kBrushes = 24;

/** Of all processes of the browser, so that what else the machine does counts for nothing. */
const cpuMs = async () => 1000 * (await chromium.sendToBrowser('SystemInfo.getProcessInfo')).processInfo.reduce((sum, one) => sum + one.cpuTime, 0);
const seen = (expression) => chromium.evaluate(`window.seen.${expression}`);
try {
  await chromium.attach();
  await chromium.resize(Number(option('--width') ?? 1400));
  await chromium.open(pathToFileURL(resolve(page)).href);
  await chromium.evaluate(`(${install})()`);
  if (option('--png')) writeFileSync(option('--png'), await chromium.screenshot());
  await seen('show()');
  const result = { first: await seen('detail()') };

  const front = await chromium.evaluate(`JSON.parse(document.getElementById('data').textContent).front`);
  const wanted = front.designs.find((design) => design.trial !== front.chosen.trial).trial;
  await chromium.click(await seen(`pixel(seen.done.find((trial) => trial.number === ${wanted}))`));
  result.clicked = { ...await seen('detail()'), wanted };
  // The evaluation farthest from all of the front lies under no other mark.
  const far = await chromium.evaluate(`(() => { const place = (t) => seen.pixel(t); const others = seen.done.filter((t) => seen.members.has(t.number)).map(place);
    const gap = (t) => Math.min(...others.map(([x, y]) => Math.hypot(x - place(t)[0], y - place(t)[1])));
    const box = seen.leftHalf(); const shown = seen.done.filter((t) => !seen.members.has(t.number) && place(t)[0] > box[0][0] && place(t)[1] < box[1][1]);
    return shown.reduce((a, b) => (gap(b) > gap(a) ? b : a)).number; })()`);
  await chromium.click(await seen(`pixel(seen.done.find((trial) => trial.number === ${far}))`));
  result.far = await seen('detail()');

  const box = await seen('leftHalf()');
  await chromium.drag(...box);
  await seen('settled()');
  result.framed = { inside: await seen(`inside(${JSON.stringify(box)})`), ...await seen('counts()') };
  await chromium.evaluate(`[...document.querySelectorAll('#front button')].find((one) => one.textContent === 'Clear the frame').click()`);
  result.cleared = await seen('counts()');

  await chromium.drag(...await seen('axis(0, 0.5)'));
  result.axis = { inside: await seen('below(0.5)'), ...await seen('counts()') };
  await seen('selectAxis(0)');
  await seen(`filter('infeasible')`);
  result.filtered = await seen('counts()');
  await seen(`filter('')`);
  result.unfiltered = await seen('counts()');

  result.sorted = {};
  for (const direction of ['down', 'up']) {
    result.sorted[direction] = await chromium.evaluate(`(() => { const name = seen.names[1]; const head = [...document.querySelectorAll('#front-table th')].find((one) => one.title.endsWith(name)); head.querySelector('button').click();
      return [...document.querySelectorAll('#front-table tbody tr')].map((row) => seen.value(seen.done.find((t) => t.number === Number.parseInt(row.firstChild.textContent, 10)), name)); })()`);
  }
  result.set = await chromium.evaluate(`document.querySelector('#front-table .copy').title`);

  const brushes = Array.from({ length: kBrushes }, (_, k) => (k % 2 ? `selectAxis(${0.3 + 0.03 * k})` : `filter('${k % 4 ? 'feasible' : 'infeasible'}')`));
  const before = await cpuMs();
  result.ms = [];
  for (const brush of brushes) result.ms.push(await seen(`timed(() => seen.${brush})`));
  result.cpu_ms = ((await cpuMs()) - before) / kBrushes;
  result.ms.sort((a, b) => a - b);
  console.log(JSON.stringify(result));
} finally {
  clearTimeout(limit);
  chromium.close();
}
