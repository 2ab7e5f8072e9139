// Curves over one axis, in one or several stacked charts; values under the pointer.

import { curveColours, palette } from './colours.js';
import { numbers } from './data.js';
import { element, svg } from './elements.js';
import { estimate, readable, tickLabels, ticks } from './format.js';

const width = 640, left = 78, right = 22, gap = 14, foot = 44;

// Colour of a curve; dashed if all colours are used.
function lookOf(json, order) {
  const repeats = json.style === 'line' && !palette[json.colour] && order >= curveColours.length;
  return {
    stroke: palette[json.colour] ?? curveColours[order % curveColours.length],
    style: repeats ? 'dashed' : json.style,
  };
}

function readCurve(json, order) {
  return {
    ...json, x: numbers(json.x), y: numbers(json.y), error: json.error ? numbers(json.error) : null,
    ...lookOf(json, order),
  };
}

// Lowest and highest finite value. `robust`: of the central 99.6 %, so that outliers do not flatten
// the rest.
function range(arrays, log, robust) {
  const finite = [];
  for (const array of arrays) for (const v of array) if (Number.isFinite(v) && (!log || v > 0)) finite.push(v);
  if (finite.length === 0) return [0, 1];
  finite.sort((a, b) => a - b);
  const cut = robust ? Math.floor(0.002 * finite.length) : 0;
  let low = finite[cut], high = finite[finite.length - 1 - cut];
  if (log) return high > low ? [low, high] : [low / 2, high * 2];
  const span = high - low;
  const tiny = 1e-12 * Math.max(Math.abs(low), Math.abs(high));
  if (span <= tiny) return low === 0 ? [-1, 1] : [low - 0.5 * Math.abs(low), high + 0.5 * Math.abs(high)];
  return [low - 0.05 * span, high + 0.05 * span];
}

class Scale {
  constructor([low, high], from, to, log) {
    Object.assign(this, { low, high, from, to, log });
  }
  place(value) {
    const f = this.log ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return this.from + f * (this.to - this.from);
  }
  value(place) {
    const f = (place - this.from) / (this.to - this.from);
    return this.log ? this.low * (this.high / this.low) ** f : this.low + f * (this.high - this.low);
  }
  ticks(most, label = '') {
    if (!this.log) {
      const { values, step } = ticks(this.low, this.high, most, label.endsWith('[deg]') ? 'deg' : '');
      return { values, ...tickLabels(values, step) };
    }
    const values = [];
    const first = Math.ceil(Math.log10(this.low) - 1e-9), last = Math.floor(Math.log10(this.high) + 1e-9);
    const stride = Math.max(1, Math.ceil((last - first + 1) / most));
    for (let e = first; e <= last; e += stride) values.push(10 ** e);
    return { values, labels: values.map((v) => readable(v, 1)), power: '' };
  }
}

const rounded = (number) => number.toFixed(1);

// Drawable points, in runs without gaps.
function runs(curve, x, y) {
  const all = [];
  let run = [];
  for (let i = 0; i < curve.x.length; ++i) {
    const px = x.place(curve.x[i]), py = y.place(curve.y[i]);
    if (Number.isFinite(px) && Number.isFinite(py)) {
      run.push([px, py, i]);
    } else if (run.length > 0) {
      all.push(run);
      run = [];
    }
  }
  if (run.length > 0) all.push(run);
  return all;
}

function drawCurve(curve, x, y) {
  const marks = [];
  const zero = Math.min(Math.max(y.log ? Math.max(y.from, y.to) : y.place(0), Math.min(y.from, y.to)), Math.max(y.from, y.to));
  for (const run of runs(curve, x, y)) {
    if (curve.style === 'bars') {
      const half = 0.4 * Math.abs(x.place(1) - x.place(0));
      for (const [px, py] of run) {
        marks.push(svg('rect', { x: rounded(px - half), width: rounded(2 * half), y: rounded(Math.min(py, zero)),
          height: rounded(Math.abs(py - zero)), fill: curve.stroke }));
      }
      continue;
    }
    const points = curve.style === 'points';
    if (curve.error && !points) {
      const edge = (sign) => run.map(([px, , i]) => `${rounded(px)},${rounded(y.place(curve.y[i] + sign * curve.error[i]))}`);
      marks.push(svg('polygon', { points: [...edge(1), ...edge(-1).reverse()].join(' '), fill: curve.stroke, opacity: 0.18 }));
    }
    if (points) {
      const size = run.length > 200 ? 1.3 : 3;
      marks.push(svg('path', { d: run.map(([px, py]) => `M${rounded(px)},${rounded(py)}h0`).join(''), stroke: curve.stroke,
        'stroke-width': 2 * size, 'stroke-linecap': 'round' }));
      if (curve.error && run.length <= 200) {
        marks.push(svg('path', { stroke: curve.stroke, d: run.map(([px, , i]) =>
          `M${rounded(px)},${rounded(y.place(curve.y[i] - curve.error[i]))}V${rounded(y.place(curve.y[i] + curve.error[i]))}`).join('') }));
      }
      continue;
    }
    marks.push(svg('polyline', { points: run.map(([px, py]) => `${rounded(px)},${rounded(py)}`).join(' '), fill: 'none',
      stroke: curve.stroke, 'stroke-width': 1.7, 'stroke-dasharray': curve.style === 'dashed' ? '6 4' : null,
      'stroke-linejoin': 'round' }));
  }
  return marks;
}

// Index of the point of a curve nearest to x; null if there is none.
function nearest(curve, x) {
  let best = -1, least = Infinity;
  for (let i = 0; i < curve.x.length; ++i) {
    const apart = Math.abs(curve.x[i] - x);
    if (apart < least && Number.isFinite(curve.y[i])) {
      least = apart;
      best = i;
    }
  }
  return best < 0 ? null : best;
}

let clips = 0;

export class Chart {
  constructor(json) {
    this.json = json;
    this.panels = json.panels.map((panel) => ({ ...panel, curves: panel.curves.map(readCurve) }));
    this.reading = element('p', { class: 'reading', 'aria-live': 'polite' }, this.hint());
    this.body = element('figure', { class: 'chart' }, element('figcaption', {}, json.title), this.draw(), this.legend(), this.reading);
  }

  hint() {
    const thinned = this.panels.flatMap((panel) => panel.curves).find((curve) => curve.thinned_from > 0);
    return 'Point at the curves, or use the arrow keys, to read them.' +
      (thinned ? ` Drawn are the extremes of intervals of ${readable(thinned.thinned_from, 6).replace(/\.0+$/, '')} points; the files have all.` : '');
  }

  draw() {
    const inner = this.panels.length > 1 ? 132 : 240;
    const all = this.panels.flatMap((panel) => panel.curves);
    const hasBars = all.some((curve) => curve.style === 'bars');
    let xRange = range(all.map((curve) => curve.x), this.json.x_log, false);
    if (!this.json.x_log && !hasBars && all.some((curve) => curve.x.length > 1)) {
      const tight = [Infinity, -Infinity];
      for (const curve of all) for (const v of curve.x) { tight[0] = Math.min(tight[0], v); tight[1] = Math.max(tight[1], v); }
      if (tight[1] > tight[0]) xRange = tight;
    } else if (hasBars) {
      xRange = [xRange[0] - 0.4, xRange[1] + 0.4];
    }
    this.x = new Scale(xRange, left, width - right, this.json.x_log);
    const height = this.panels.length * (inner + gap) + foot + 10;
    const clip = `clip-${++clips}`;
    this.line = svg('line', { class: 'pointer', y1: 10, y2: height - foot - gap, visibility: 'hidden' });
    this.cursor = svg('line', { class: 'cursor', y1: 10, y2: height - foot - gap, visibility: 'hidden' });
    const picture = svg('svg', {
      viewBox: `0 0 ${width} ${height}`, tabindex: 0, role: 'img', 'aria-label': `${this.json.title} over ${this.json.x_label}`,
      onpointermove: (event) => this.pointed(event), onpointerleave: () => this.at(null), onkeydown: (event) => this.key(event),
    }, svg('clipPath', { id: clip }, svg('rect', { x: left, y: 0, width: width - left - right, height })));
    this.panels.forEach((panel, i) => {
      const top = 10 + i * (inner + gap), bottom = top + inner;
      const values = panel.curves.flatMap((curve) => (curve.error && curve.style !== 'bars' && curve.x.length < 300
        ? [curve.y, curve.y.map((v, k) => v - (curve.error[k] || 0)), curve.y.map((v, k) => v + (curve.error[k] || 0))] : [curve.y]));
      if (panel.curves.some((curve) => curve.style === 'bars')) values.push([0]);
      const y = new Scale(range(values, panel.log, panel.robust), bottom, top, panel.log);
      picture.append(this.frame(panel, y, top, bottom));
      const inside = svg('g', { 'clip-path': `url(#${clip})` });
      for (const level of panel.levels) {
        inside.append(svg('line', { class: 'level', x1: left, x2: width - right, y1: y.place(level), y2: y.place(level) }));
      }
      for (const curve of panel.curves) inside.append(...drawCurve(curve, this.x, y));
      picture.append(inside);
    });
    picture.append(this.xAxis(height - foot - gap + 4), this.cursor, this.line);
    return picture;
  }

  frame(panel, y, top, bottom) {
    const group = svg('g', { class: 'frame' });
    for (const [from, to] of this.json.shaded) {
      const x1 = Math.max(this.x.place(from), left), x2 = Math.min(this.x.place(to), width - right);
      if (x2 > x1) group.append(svg('rect', { class: 'shade', x: x1, width: x2 - x1, y: top, height: bottom - top }));
    }
    const { values, labels, power } = y.ticks(bottom - top > 200 ? 6 : 4, panel.y_label);
    values.forEach((value, i) => {
      const at = y.place(value);
      group.append(svg('line', { class: 'grid', x1: left, x2: width - right, y1: at, y2: at }),
        svg('text', { x: left - 8, y: at + 4.5, 'text-anchor': 'end' }, labels[i]));
    });
    const middle = (top + bottom) / 2;
    const label = power ? (panel.y_label.includes('[') ? panel.y_label.replace('[', `[${power} `) : `${panel.y_label} ${power}`) : panel.y_label;
    group.append(svg('text', { class: 'label', transform: `translate(16 ${middle}) rotate(-90)`, 'text-anchor': 'middle' }, label),
      svg('rect', { class: 'box', x: left, y: top, width: width - left - right, height: bottom - top }));
    return group;
  }

  xAxis(y) {
    const { values, labels, power } = this.x.ticks(7, this.json.x_label);
    const name = power ? `${this.json.x_label} ${power}` : this.json.x_label;
    return svg('g', { class: 'frame' },
      values.map((value, i) => svg('text', { x: this.x.place(value), y: y + 12, 'text-anchor': 'middle' }, labels[i])),
      svg('text', { class: 'label', x: (left + width - right) / 2, y: y + 34, 'text-anchor': 'middle' }, name));
  }

  legend() {
    const named = this.panels.flatMap((panel) => panel.curves).filter((curve) => curve.label);
    return element('p', { class: 'keys' }, named.map((curve) =>
      element('span', {}, element('i', { class: curve.style, style: `--stroke:${curve.stroke}` }), curve.label)));
  }

  pointed(event) {
    const box = event.currentTarget.getBoundingClientRect();
    this.at(this.x.value((event.clientX - box.left) / box.width * width));
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const from = this.read ?? this.x.value((left + width - right) / 2);
    this.at(this.x.value(Math.min(Math.max(this.x.place(from) + step * (width - left - right) / 100, left), width - right)));
  }

  // Shows the values of all curves at x; null: none.
  at(x) {
    this.read = x;
    const inside = x !== null && this.x.place(x) >= left - 0.5 && this.x.place(x) <= width - right + 0.5;
    this.line.setAttribute('visibility', inside ? 'visible' : 'hidden');
    if (!inside) {
      this.reading.textContent = this.hint();
      return;
    }
    const curves = this.panels.flatMap((panel) => panel.curves.map((curve) => ({ curve, label: curve.label || panel.y_label })));
    const first = curves.map(({ curve }) => nearest(curve, x)).find((i) => i !== null);
    const place = this.x.place(x);
    this.line.setAttribute('x1', place);
    this.line.setAttribute('x2', place);
    if (first === undefined) return;
    this.reading.replaceChildren(element('b', {}, `${this.json.x_label}: ${readable(x)}`),
      ...curves.slice(0, 12).map(({ curve, label }) => {
        const i = nearest(curve, x);
        return element('span', {}, element('i', { class: curve.style, style: `--stroke:${curve.stroke}` }),
          `${label}: ${i === null ? '–' : estimateOrNumber(curve, i)}`);
      }));
  }

  // Moves the line of the slider.
  follow(values) {
    const { cursor } = this.json;
    if (!cursor) return;
    const { only_at: only } = cursor;
    const place = this.x.place(values[cursor.axis] * cursor.x_per_unit + cursor.x_from);
    const at = Math.min(Math.max(place, left), width - right);
    this.isFollowed = !only || values[only.axis] === only.value;
    this.body.hidden = !this.isFollowed;
    this.cursor.setAttribute('visibility', this.isFollowed && Math.abs(at - place) < 1 ? 'visible' : 'hidden');
    this.cursor.setAttribute('x1', at);
    this.cursor.setAttribute('x2', at);
  }
}

function estimateOrNumber(curve, i) {
  const error = curve.error?.[i];
  return error > 0 ? estimate(curve.y[i], error) : readable(curve.y[i], 5);
}
