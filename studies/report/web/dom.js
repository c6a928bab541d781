// SPDX-License-Identifier: GPL-3.0-or-later
// Small helpers to build the page; texts are always set as text, never as markup.

/** An element with properties and children; null and false children are left out. */
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'class') element.className = value;
    else if (name === 'style') element.style.cssText = value;
    else if (name in element && typeof value !== 'string') element[name] = value;
    else element.setAttribute(name, value === true ? '' : value);
  }
  append(element, children);
  return element;
}

function append(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
}

/** The same for an element of a drawing. */
export function svg(tag, attributes, ...children) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  append(element, children);
  return element;
}

/** A titled section of the page; `lead` is the sentence under the heading. */
export function section(id, title, lead, ...children) {
  return h('section', { id }, h('h2', {}, title), lead && h('p', { class: 'lead' }, lead), children);
}

/** A rounded label; kinds are styled in style.css. */
export const badge = (kind, text) => h('span', { class: `badge ${kind}` }, text);

export const pngUrl = (base64) =>
  base64.startsWith('data:') ? base64 : `data:image/png;base64,${base64}`;

/** Parses SVG text into a node of this document, without anything that could run. */
export function svgNode(text) {
  const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');
  if (parsed.querySelector('parsererror')) return h('p', { class: 'muted' }, 'The drawing is damaged.');
  for (const node of parsed.querySelectorAll('script, foreignObject')) node.remove();
  return document.importNode(parsed.documentElement, true);
}

/** Shows a picture at its full size until it is clicked away. */
export function enlarge(source, caption) {
  const close = () => dialog.close();
  const dialog = h('dialog', { class: 'enlarged', onclick: close },
    h('img', { src: source, alt: caption }), h('p', {}, caption));
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** A picture that opens large on a click or on Enter. */
export function picture(base64, caption, className = '') {
  const image = h('img', { src: pngUrl(base64), alt: caption, class: className });
  return h('button', { class: 'picture', type: 'button', title: 'Show large', onclick: () => enlarge(image.src, caption) }, image);
}
