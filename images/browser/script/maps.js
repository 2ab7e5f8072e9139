// Maps as pictures with axes and a colour bar; pointer and keys show the value of a bin.

import { ColourScale, colourBar } from './colours.js';
import { Grid, numbers } from './data.js';
import { choice, element } from './elements.js';
import { estimate, readable, tickLabels, ticks, withUnit } from './format.js';

// A map of the page with decoded numbers.
export function readMap(json) {
  const values = numbers(json.value);
  const grid = new Grid(json, values, json.error ? numbers(json.error) : null);
  return { ...json, grid };
}

// Name and unit of a label such as "body x [m]".
function parts(label) {
  const match = /^(.*?)\s*\[(.*)\]$/.exec(label);
  return match ? { name: match[1], unit: match[2] } : { name: label, unit: '' };
}

function picture(map, scale) {
  const { width, height, values } = map.grid;
  const canvas = element('canvas', { width, height });
  const rgba = scale.pixels(values);
  const image = canvas.getContext('2d').createImageData(width, height);
  const line = 4 * width;
  // Rows of the map run upwards, rows of a canvas downwards.
  for (let y = 0; y < height; ++y) image.data.set(rgba.subarray(line * y, line * (y + 1)), line * (height - 1 - y));
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas;
}

function axis(low, high, label, upright) {
  const { values, step } = ticks(low, high, 6, parts(label).unit);
  const { labels, power } = tickLabels(values, step);
  const place = (value) => {
    const fraction = 100 * (value - low) / (high - low);
    return upright ? `bottom:${fraction}%` : `left:${fraction}%`;
  };
  const { name, unit } = parts(label);
  const full = [power, unit].filter(Boolean).join(' ');
  return element('div', { class: upright ? 'y-axis' : 'x-axis' },
    values.map((value, i) => element('span', { style: place(value) }, labels[i])),
    element('em', {}, full ? `${name} [${full}]` : name));
}

export class MapSection {
  constructor(maps, colours) {
    this.maps = maps;
    this.colours = colours;
    this.reading = element('p', { class: 'reading', 'aria-live': 'polite' });
    this.place = element('div', { class: 'map-place' });
    this.body = element('div', { class: 'map-section' },
      choice('Map', maps.map((map) => map.title), (i) => this.show(i)), this.place, this.reading);
    this.show(0);
  }

  show(index) {
    this.map = this.maps[index];
    const { map } = this;
    this.scale = new ColourScale(this.colours[map.colours], map.low, map.high);
    this.bar = colourBar(this.scale, map.unit);
    this.cross = element('i', { class: 'cross', hidden: true });
    this.field = element('div', {
      class: map.smooth ? 'field smooth' : 'field', tabindex: 0, role: 'application',
      'aria-label': `${map.title}. Arrow keys go from bin to bin and read its value.`,
      onpointermove: (event) => this.pointed(event), onpointerleave: () => this.at(null),
      onkeydown: (event) => this.key(event),
    }, picture(map, this.scale), this.cross);
    const ratio = map.equal_scale ? (map.x_high - map.x_low) / (map.y_high - map.y_low) : 4 / 3;
    this.field.style.aspectRatio = String(Math.min(Math.max(ratio, 0.25), 4));
    this.place.replaceChildren(element('div', { class: 'map' },
      axis(map.y_low, map.y_high, map.y_label, true), this.field, this.bar,
      axis(map.x_low, map.x_high, map.x_label, false)));
    this.bin = null;
    this.at(null);
  }

  pointed(event) {
    const box = this.field.getBoundingClientRect();
    this.at(this.map.grid.binAt((event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height));
  }

  key(event) {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!move) return;
    event.preventDefault();
    const { grid } = this.map;
    const from = this.bin ?? grid.binAt(0.5, 0.5);
    const x = Math.min(Math.max(from.x + move[0], 0), grid.width - 1);
    const y = Math.min(Math.max(from.y + move[1], 0), grid.height - 1);
    this.at({ x, y, index: y * grid.width + x });
  }

  // Shows the value of a bin; null: none.
  at(bin, tell = true) {
    const { map } = this;
    this.bin = bin;
    this.cross.hidden = bin === null;
    if (tell) this.onbin?.(map.name, bin);
    if (bin === null) {
      this.bar.mark(null);
      this.reading.textContent = map.factor > 1
        ? `${map.bins[0]} × ${map.bins[1]} bins, here averaged by ${map.factor} × ${map.factor}; the files have all.`
        : 'Point at the map, or go over it with the arrow keys, to read a bin.';
      return;
    }
    const { u, v } = map.grid.middle(bin);
    this.cross.style.left = `${100 * u}%`;
    this.cross.style.bottom = `${100 * v}%`;
    const value = map.grid.values[bin.index];
    const x = parts(map.x_label), y = parts(map.y_label);
    const where = `${x.name} ${withUnit(readable(map.x_low + u * (map.x_high - map.x_low)), x.unit)}, ` +
      `${y.name} ${withUnit(readable(map.y_low + v * (map.y_high - map.y_low)), y.unit)}`;
    const what = Number.isNaN(value) ? 'no surface here'
      : withUnit(estimate(value, map.grid.errors?.[bin.index] ?? 0), map.unit);
    this.reading.replaceChildren(element('b', {}, what), ` at ${where}`);
    this.bar.mark(value);
  }

  // Shows the bin of the map of this name at which the pointer is elsewhere on the page.
  follow(name, bin) {
    if (this.map.name === name) this.at(bin, false);
  }
}
