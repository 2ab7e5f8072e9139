// Sliders over the states of the stage, and playback if an axis is time.

import { element } from './elements.js';
import { readable, withUnit } from './format.js';

const steps = 2000;         // of a slider over time
const secondsToPlay = 20;   // from end to end

// The last state at or before a value of a rising axis, and the fraction of the way to the next
// one.
function between(values, value) {
  let low = 0, high = values.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle;
    else high = middle;
  }
  const span = values[high] - values[low];
  return [low, high, span > 0 ? Math.min(Math.max((value - values[low]) / span, 0), 1) : 0];
}

export class Player {
  // `show(from, to, fraction, at)`: two states, the fraction between them, and the values of the
  // axes.
  constructor(axes, show) {
    this.axes = axes;
    this.show = show;
    this.at = axes.map((axis) => axis.values[0]);
    this.sliders = [];
    this.outputs = [];
    this.element = element('div', { class: 'player' }, axes.map((axis, i) => this.row(axis, i)));
    this.element.hidden = axes.length === 0;
  }

  row(axis, i) {
    const last = axis.values.length - 1;
    const slider = element('input', {
      type: 'range', id: `axis-${i}`, min: 0, max: axis.plays ? steps : last, value: 0, step: axis.plays ? 'any' : 1,
      'aria-label': withUnit(axis.name, axis.unit ? `in ${axis.unit}` : ''),
      oninput: () => {
        this.stop();
        const position = Number(slider.value);
        this.move(i, axis.plays
          ? axis.values[0] + (axis.values[last] - axis.values[0]) * position / steps : axis.values[position]);
      },
    });
    const output = element('output', { for: `axis-${i}` });
    this.sliders.push(slider);
    this.outputs.push(output);
    const play = axis.plays ? element('button', { type: 'button', class: 'play', onclick: () => this.toggle(i) }, 'play') : null;
    if (play) this.button = play;
    return element('div', { class: 'axis' }, play, element('label', { for: `axis-${i}` }, axis.name), slider, output);
  }

  start() {
    this.update();
  }

  // Moves one axis and its slider.
  move(i, value) {
    this.at[i] = value;
    const { values, plays } = this.axes[i];
    const last = values.length - 1;
    this.sliders[i].value = plays
      ? steps * (value - values[0]) / (values[last] - values[0] || 1) : values.indexOf(value);
    this.update();
  }

  update() {
    let from = 0, to = 0, fraction = 0, stride = 1;
    this.axes.forEach((axis, i) => {
      const [low, high, part] = between(axis.values, this.at[i]);
      if (axis.plays) {
        from += low * stride;
        to += high * stride;
        fraction = part;
      } else {
        const node = part < 0.5 ? low : high;
        from += node * stride;
        to += node * stride;
      }
      stride *= axis.values.length;
      const name = axis.names[axis.values.indexOf(this.at[i])];
      const text = name ?? withUnit(readable(this.at[i], 4).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, ''), axis.unit);
      this.outputs[i].textContent = text;
      this.sliders[i].setAttribute('aria-valuetext', text);
    });
    this.show(from, to, fraction, [...this.at]);
  }

  toggle(i) {
    if (this.playing) {
      this.stop();
      return;
    }
    const { values } = this.axes[i];
    const first = values[0], last = values[values.length - 1];
    if (this.at[i] >= last) this.at[i] = first;
    this.button.textContent = 'pause';
    let before = null;
    const advance = (now) => {
      if (!this.playing) return;
      const passed = before === null ? 0 : (now - before) / 1000;
      before = now;
      const value = Math.min(this.at[i] + (last - first) * passed / secondsToPlay, last);
      this.move(i, value);
      if (value >= last) this.stop();
      else this.playing = requestAnimationFrame(advance);
    };
    this.playing = requestAnimationFrame(advance);
  }

  stop() {
    if (this.playing) cancelAnimationFrame(this.playing);
    this.playing = null;
    if (this.button) this.button.textContent = 'play';
  }
}
