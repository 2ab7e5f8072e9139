// Colour maps equal to those of the program's pictures, and the palette of curves and arrows.
// Source of the palette: M. Okabe and K. Ito, "Color Universal Design" (2008).

import { element } from './elements.js';
import { readable, tickLabels, ticks } from './format.js';

export const palette = {
  blue: '#0072b2', vermilion: '#d55e00', green: '#009e73', grey: '#7a828b',
  purple: '#aa4499', orange: '#e69f00', sky: '#56b4e9', black: '#1b1f24',
};
export const curveColours =
  [palette.blue, palette.vermilion, palette.green, palette.purple, palette.orange, palette.sky, palette.black];

export class ColourScale {
  // `hex`: 256 colours of six digits each.
  constructor(hex, low, high) {
    this.low = low;
    this.high = high;
    this.bytes = new Uint8Array(256 * 3);
    for (let i = 0; i < this.bytes.length; ++i) this.bytes[i] = parseInt(hex.substr(2 * i, 2), 16);
  }

  // Index in `bytes` of the three bytes of a value; −1 for NaN.
  at(value) {
    if (Number.isNaN(value)) return -1;
    const fraction = (value - this.low) / (this.high - this.low);
    return 3 * Math.min(255, Math.max(0, Math.floor(256 * fraction)));
  }

  // Values as red, green, blue and opacity, row by row; NaN is transparent.
  pixels(values) {
    const rgba = new Uint8ClampedArray(4 * values.length);
    for (let i = 0; i < values.length; ++i) {
      const at = this.at(values[i]);
      if (at < 0) continue;
      rgba.set(this.bytes.subarray(at, at + 3), 4 * i);
      rgba[4 * i + 3] = 255;
    }
    return rgba;
  }
}

// A vertical bar with numbers and unit; `mark(value)` marks a value, `mark(null)` removes the mark.
export function colourBar(scale, unit) {
  const canvas = element('canvas', { width: 1, height: 256 });
  const context = canvas.getContext('2d');
  const image = context.createImageData(1, 256);
  for (let i = 0; i < 256; ++i) {
    image.data.set(scale.bytes.subarray(3 * (255 - i), 3 * (255 - i) + 3), 4 * i);
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  const { values, step } = ticks(scale.low, scale.high, 5);
  const { labels, power } = tickLabels(values, step);
  const place = (value) => `${100 * (1 - (value - scale.low) / (scale.high - scale.low))}%`;
  const marker = element('i', { class: 'marker', hidden: true });
  const bar = element('div', {
    class: 'colour-bar', role: 'img',
    'aria-label': `Colour bar from ${readable(scale.low)} to ${readable(scale.high)} ${unit}`,
  },
  element('span', { class: 'unit' }, [power, unit].filter(Boolean).join(' ')),
  element('div', { class: 'ramp' }, canvas, marker,
    values.map((value, i) => element('span', { style: `top:${place(value)}` }, labels[i]))));
  bar.mark = (value) => {
    marker.hidden = value === null || Number.isNaN(value);
    if (!marker.hidden) {
      marker.style.top = place(Math.min(Math.max(value, scale.low), scale.high));
    }
  };
  return bar;
}
