// SPDX-License-Identifier: GPL-3.0-or-later
// A transparent canvas over a drawing, for what changes while one brushes: it alone is drawn anew.
import { h } from './dom.js';

export class Overlay {
  /** @param place  an element whose size it has, placed */
  constructor(place) {
    this.place = place;
    this.canvas = h('canvas', { class: 'overlay screen-only', 'aria-hidden': 'true' });
    place.append(this.canvas);
  }

  /** The empty canvas, in pixels of the page. */
  begin() {
    const [width, height] = [this.place.clientWidth, this.place.clientHeight];
    const ratio = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const context = this.canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return context;
  }
}

/** What lies below fades. */
export function wash(context, { left, top, width, height }) {
  context.fillStyle = 'rgba(255, 255, 255, 0.8)';
  context.fillRect(left, top, width, height);
}

/** Discs of one colour as one path: quick for thousands. @param points  [x, y] */
export function discs(context, points, radius, colour) {
  context.fillStyle = colour;
  context.beginPath();
  for (const [x, y] of points) {
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
  context.fill();
}

/** A way the mouse goes with its button down: move(place) while it does, end(place, far), far where it was no click. */
export function follow(event, at, move, end) {
  const start = at(event);
  const onMove = (next) => move(at(next));
  const onEnd = (next) => {
    window.removeEventListener('pointermove', onMove);
    window.removeEventListener('pointerup', onEnd);
    const stop = at(next);
    end(stop, Math.hypot(stop[0] - start[0], stop[1] - start[1]) > 5);
  };
  window.addEventListener('pointermove', onMove);
  window.addEventListener('pointerup', onEnd);
}
