// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: node printed_page.mjs BROWSER PAGE.html [--pdf FILE] [--png FILE --width PX]
//
// Prints a page on A4 by a headless Chromium, which it steers through a pipe, and writes one JSON object:
//   pages     of the PDF
//   overlaps  [ [what, what] ]: pairs of drawings, pictures and texts whose boxes share an area in the layout for paper, and of words of the
//             PDF, drawings' too, that stand on top of each other (by pdftotext of poppler-utils)
//   boxes     how many boxes were compared
//   words     how many words of the PDF; null without pdftotext
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { Browser } from './browser.mjs';

const [browser, page, ...rest] = process.argv.slice(2);
const option = (name) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : null);
const kPaperWidthPx = Math.round(((210 - 2 * 12) / 25.4) * 96);  // between the margins of style.css

/** In the page: pairs of boxes that share more than a hair. A box within another's own element is no overlap. */
function overlaps() {
  const isShown = (node) => node.getClientRects().length > 0 && getComputedStyle(node).visibility !== 'hidden';
  const hasText = (node) => [...node.childNodes].some((child) => child.nodeType === Node.TEXT_NODE && child.textContent.trim());
  const isInDrawing = (node) => node.parentElement.closest('svg, .chart') !== null;
  const nodes = [...document.querySelectorAll('main *, header *')].filter((node) => isShown(node) && !isInDrawing(node) &&
    (['svg', 'IMG', 'CANVAS'].includes(node.tagName) || node.classList.contains('chart') || hasText(node)));
  const boxOf = (node) => {
    const { left, top, right, bottom } = node.getBoundingClientRect();
    return { node, left, top, right, bottom };
  };
  const boxes = nodes.map(boxOf).filter((box) => box.right > box.left && box.bottom > box.top);
  const name = ({ node }) => `${node.tagName.toLowerCase()}${node.className?.baseVal ?? node.className ? `.${node.className.baseVal ?? node.className}` : ''} "${node.textContent.trim().slice(0, 40)}"`;
  const kTogether = 'p, li, th, td, h1, h2, h3, h4, .scaled, .parallel';  // what is meant to lie in one place
  const pairs = [];
  for (let i = 0; i < boxes.length; ++i) {
    for (let k = i + 1; k < boxes.length; ++k) {
      const [a, b] = [boxes[i], boxes[k]];
      if (a.node.contains(b.node) || b.node.contains(a.node) || (a.node.closest(kTogether) ?? a.node) === b.node.closest(kTogether)) continue;
      const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (width > 1.5 && height > 1.5) pairs.push([name(a), name(b)]);
    }
  }
  return { boxes: boxes.length, overlaps: pairs.slice(0, 20) };
}

/** Words of a PDF that stand on top of others of their page; how many words there are, null without pdftotext. */
function wordsOf(pdf) {
  const folder = mkdtempSync(join(tmpdir(), 'glint-pdf-'));
  try {
    writeFileSync(join(folder, 'a.pdf'), pdf);
    const run = spawnSync('pdftotext', ['-bbox', join(folder, 'a.pdf'), join(folder, 'a.html')]);
    if (run.error) return { words: null, overlaps: [] };
    const pages = readFileSync(join(folder, 'a.html'), 'utf8').split('<page ').slice(1);
    const boxes = pages.map((page) => [...page.matchAll(/<word xMin="([\d.-]+)" yMin="([\d.-]+)" xMax="([\d.-]+)" yMax="([\d.-]+)">(.*?)<\/word>/g)]
      .map(([, left, top, right, bottom, text]) => ({ left: Number(left), top: Number(top), right: Number(right), bottom: Number(bottom), text })));
    return { words: boxes.flat().length, overlaps: boxes.flatMap(overlappingWords) };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Letters with a white rim are printed twice in one place, and are not always taken for the same words. */
function isSameText(a, b) {
  const [whole, part] = a.text.length < b.text.length ? [b, a] : [a, b];
  return whole.text.includes(part.text) && part.left > whole.left - 3 && part.right < whole.right + 3 && part.top > whole.top - 3 && part.bottom < whole.bottom + 3;
}

function overlappingWords(words) {
  const pairs = [];
  for (let i = 0; i < words.length; ++i) {
    for (let k = i + 1; k < words.length; ++k) {
      const [a, b] = [words[i], words[k]];
      const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (isSameText(a, b)) continue;
      // Boxes of lines reach a little into those above and below.
      if (width > 1 && height > 0.4 * Math.min(a.bottom - a.top, b.bottom - b.top)) pairs.push([a.text, b.text]);
    }
  }
  return pairs;
}

const chromium = new Browser(browser);
const limit = setTimeout(() => { chromium.close(); process.exit(1); }, 120000);
try {
  await chromium.attach();
  await chromium.resize(Number(option('--width') ?? 1440));
  await chromium.open(pathToFileURL(resolve(page)).href);
  if (option('--png')) {
    writeFileSync(option('--png'), await chromium.screenshot());
  }
  await chromium.resize(kPaperWidthPx);
  await chromium.send('Emulation.setEmulatedMedia', { media: 'print' });
  await chromium.evaluate(`window.dispatchEvent(new Event('beforeprint')); new Promise((done) => setTimeout(done, 300))`);
  const found = await chromium.evaluate(`(${overlaps})()`);
  await chromium.evaluate(`window.dispatchEvent(new Event('afterprint'))`);
  const { data } = await chromium.send('Page.printToPDF', { preferCSSPageSize: true, printBackground: true });
  const pdf = Buffer.from(data, 'base64');
  if (option('--pdf')) writeFileSync(option('--pdf'), pdf);
  const pages = pdf.toString('latin1').match(/\/Type\s*\/Page\b(?!s)/g)?.length ?? 0;
  const { words, overlaps: printed } = wordsOf(pdf);
  console.log(JSON.stringify({ pages, boxes: found.boxes, words, overlaps: [...found.overlaps, ...printed].slice(0, 20) }));
} finally {
  clearTimeout(limit);
  chromium.close();
}
