// The power balance as a waterfall chart. Each loss begins at the power that remains before it.

import { palette } from './colours.js';
import { element } from './elements.js';
import { estimate, readable, withUnit } from './format.js';

export function waterfall(stages) {
  const whole = stages[0].value;
  let left = 0;
  const rows = stages.map((stage) => {
    const from = stage.total ? 0 : left - stage.value;
    const to = stage.total ? stage.value : left;
    left = stage.total ? stage.value : from;
    const percent = (value) => `${(100 * value / whole).toFixed(3)}%`;
    const bar = element('i', {
      class: stage.total ? 'total' : 'loss',
      style: `left:${percent(Math.max(from, 0))};width:${percent(Math.max(to - Math.max(from, 0), 0))};` +
        `background:${stage.total ? palette.blue : palette.vermilion}`,
    });
    const amount = withUnit(estimate(stage.value, stage.error), 'W');
    return element('div', { class: 'fall', tabindex: 0, title: `${stage.label}: ${amount}` },
      element('span', { class: 'fall-label' }, stage.label),
      element('span', { class: 'fall-track' }, bar),
      element('span', { class: 'fall-value' }, `${stage.total || stage.value === 0 ? '' : '−'}${amount}`),
      element('span', { class: 'fall-part' }, `${readable(100 * stage.value / whole, 3)} %`));
  });
  return element('div', { class: 'waterfall' }, rows);
}
