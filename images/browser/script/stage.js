// The section around the stage: selection of the content, sliders, labels and values.

import { colourBar, palette } from './colours.js';
import { numbers } from './data.js';
import { check, choice, element, svg } from './elements.js';
import { estimate, readable, withUnit } from './format.js';
import { Player } from './player.js';
import { StageView, bodyColours } from './view.js';

const looks = [['above', [0, -1e-3, 1]], ['south', [0, -1, 0]], ['east', [1, 0, 0]]];

function unpack(json) {
  const { states } = json;
  for (const name of ['attitude', 'arrow', 'arrow_error', 'figure', 'figure_error']) {
    states[name] = numbers(states[name]);
  }
  return { ...json, rays: json.rays.map((rays) => numbers(rays)), axes: json.axes.map((axis) => ({ ...axis, values: numbers(axis.values) })) };
}

// The lab's axes in a corner.
function triad(view) {
  const names = ['x', 'y', 'z'];
  const lines = names.map(() => svg('line', { x1: 0, y1: 0 }));
  const letters = names.map((name) => svg('text', {}, name));
  const picture = svg('svg', { class: 'triad', viewBox: '-40 -40 80 80', 'aria-hidden': 'true' }, lines, letters);
  picture.update = () => {
    view.axes().forEach(([x, y], i) => {
      lines[i].setAttribute('x2', 26 * x);
      lines[i].setAttribute('y2', 26 * y);
      letters[i].setAttribute('x', 34 * x);
      letters[i].setAttribute('y', 34 * y);
    });
  };
  return picture;
}

export class StageSection {
  // `maps`: maps of the page by name; `link`: called when a bin is under the pointer.
  constructor(json, maps, colours) {
    this.stage = unpack(json);
    this.canvas = element('canvas', {
      id: 'stage', tabindex: 0, role: 'img',
      'aria-label': 'The scene in three dimensions. Arrow keys turn it, plus and minus move closer or away, Home resets.',
    });
    this.labels = element('div', { class: 'labels', 'aria-hidden': 'true' });
    this.tip = element('div', { class: 'tip', hidden: true });
    this.frame = element('div', { class: 'stage' }, this.canvas, this.labels, this.tip);
    this.readings = element('dl', { class: 'readings', 'aria-live': 'polite' });
    this.bar = element('div', { class: 'bar' });
    try {
      this.view = new StageView(this.canvas, this.stage, maps, colours);
    } catch (error) {
      this.view = null;
      this.canvas.remove();
      this.frame.append(element('p', { class: 'missing' },
        `The 3D scene is not shown: the browser does not support WebGL (${error.message}).`));
    }
    this.player = new Player(this.stage.axes, (from, to, fraction, at) => this.show(from, to, fraction, at));
    this.body = element('div', { class: 'stage-section' },
      element('div', { class: 'stage-left' }, this.frame, this.player.element, this.tools()),
      element('aside', { class: 'stage-right' }, this.bar, this.readings,
        json.remark ? element('p', { class: 'remark' }, json.remark) : null));
    if (this.view) this.connect();
    this.player.start();
  }

  tools() {
    const { view } = this;
    if (!view) return null;
    const items = [];
    if (view.paintings.length > 0) {
      items.push(choice('Painted', [...view.paintings.map((p) => p.title), 'nothing'], (i) => this.paint(i)));
      this.paint(0);
    }
    if (this.stage.lamps.length > 0) {
      items.push(check('lamps', true, (on) => { view.lamps.visible = on; view.draw(); }),
        check('rays', true, (on) => { view.rays.lines.visible = on; view.draw(); }));
    }
    for (const arrow of view.arrows) {
      items.push(check(arrow.name, true, (on) => {
        arrow.wanted = on;
        arrow.group.visible = on && arrow.value > 0;
        view.draw();
      }));
    }
    view.bodies.forEach((body, i) => {
      if (view.bodies.length > 1) {
        const item = check(this.stage.bodies[i].name, true, (on) => { body.visible = on; view.draw(); });
        item.append(element('i', { class: 'swatch', style: `--mark:${bodyColours[i] ?? palette.grey}` }));
        items.push(item);
      }
    });
    const button = (name, says, act) =>
      element('button', { type: 'button', 'aria-label': says, title: says, onclick: act }, name);
    const buttons = [
      button('all', 'All of the scene', () => view.reset()),
      button('close', 'The body from close by', () => view.closeUp()),
      ...looks.map(([name, direction]) => button(name, `Seen from ${name}`, () => view.lookFrom(direction))),
    ];
    return element('div', { class: 'tools' }, items, element('span', { class: 'looks' }, 'view', buttons));
  }

  connect() {
    const { view } = this;
    const axes = triad(view);
    this.frame.append(axes);
    const arrowLabels = view.arrows.map((arrow) => {
      const label = element('span', { style: `color:${arrow.colour}` }, arrow.name);
      this.labels.append(label);
      return label;
    });
    view.ondraw = () => {
      axes.update();
      const placed = [];
      view.arrows.forEach((arrow, i) => {
        const label = arrowLabels[i];
        label.hidden = !arrow.group.visible || !view.bodies[0].visible;
        if (label.hidden) return;
        const [x, tipY] = view.onScreen(arrow.tip);
        const width = label.offsetWidth, height = label.offsetHeight;
        // Below the labels that it would cover.
        const y = placed.reduce((free, other) => (
          x < other.x + other.width && other.x < x + width && Math.abs(free - other.y) < height ? other.y + height : free
        ), tipY);
        placed.push({ x, y, width });
        placed.sort((a, b) => a.y - b.y);
        label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      });
    };
    this.canvas.addEventListener('pointermove', (event) => this.hover(event));
    this.canvas.addEventListener('pointerleave', () => this.leave());
    view.draw();
  }

  paint(index) {
    this.view.paint(index);
    const { painting } = this.view;
    this.bar.replaceChildren();
    if (!painting) return;
    this.scaleBar = colourBar(painting.scale, painting.unit);
    this.bar.append(element('p', { class: 'bar-title' }, painting.title), this.scaleBar);
  }

  hover(event) {
    const found = event.buttons === 0 ? this.view.pick(event.clientX, event.clientY) : null;
    if (!found) {
      this.leave();
      return;
    }
    const { surface, bin } = found;
    const value = surface.grid.values[bin.index];
    const text = withUnit(estimate(value, surface.grid.errors?.[bin.index] ?? 0), this.view.painting.unit);
    const box = this.frame.getBoundingClientRect();
    this.tip.replaceChildren(element('b', {}, text), element('span', {}, surface.name));
    this.tip.hidden = false;
    const x = Math.min(event.clientX - box.left + 14, box.width - this.tip.offsetWidth - 6);
    this.tip.style.transform = `translate(${x}px, ${event.clientY - box.top + 14}px)`;
    this.scaleBar.mark(value);
    this.onbin?.(surface.map, bin);
  }

  leave() {
    this.tip.hidden = true;
    this.scaleBar?.mark(null);
  }

  // Marks on the body the bin of a page map that is under the pointer.
  markBin(map, bin) {
    const surface = this.view?.painting?.surfaces.find((s) => s.map === map) ?? null;
    if (!surface || !bin) {
      this.view?.mark(null);
      return;
    }
    const { u, v } = surface.grid.middle(bin);
    this.view.mark(surface, u, v);
  }

  show(from, to, fraction, at) {
    this.view?.show(from, to, fraction);
    const nearest = fraction < 0.5 ? from : to;
    const rows = [];
    const row = (label, value, unit, colour, remark) => {
      rows.push(element('dt', colour ? { style: `--mark:${colour}`, class: 'marked' } : {}, label,
        remark ? element('small', {}, ` ${remark}`) : null),
      element('dd', {}, withUnit(value, unit)));
    };
    const { states } = this.stage;
    this.stage.figures.forEach((figure, i) => {
      const k = nearest * this.stage.figures.length + i;
      row(figure.label, estimate(states.figure[k], states.figure_error[k]), figure.unit);
    });
    this.stage.arrows.forEach((arrow, i) => {
      const k = 3 * (nearest * this.stage.arrows.length + i);
      const vector = [...states.arrow.subarray(k, k + 3)], error = [...states.arrow_error.subarray(k, k + 3)];
      const drawn = this.view?.arrows[i];
      row(`${arrow.name} [${arrow.unit}]`, readable(Math.hypot(...vector)), '', drawn?.colour ?? palette.black,
        arrow.remark);
      ['x', 'y', 'z'].forEach((axis, c) => row(`body ${axis}`, estimate(vector[c], error[c]), ''));
      if (drawn && !drawn.isSignificant && drawn.value > 0) {
        rows.push(element('dd', { class: 'wide' }, 'within two standard errors of zero: drawn pale'));
      }
    });
    this.readings.replaceChildren(...rows);
    this.onmove?.(at);
  }
}
