// What a run concludes: the verdict, what was found with its numbers, bars, and what would tell more.

import { palette } from './colours.js';
import { element, section } from './elements.js';
import { estimate, readable } from './format.js';

const signs = { good: '\u2713', found: '\u25c6', open: '?' };

export function verdict(json) {
  return element('div', { class: `verdict ${json.face}` },
    element('p', { class: 'verdict-words' }, element('span', { 'aria-hidden': 'true' }, signs[json.face]), json.words),
    element('p', { class: 'verdict-sentence' }, json.sentence));
}

function card(finding) {
  const tested = finding.from_zero && finding.figures.some((figure) => figure.error > 0);
  const rows = finding.figures.map((figure) => element('tr', {},
    element('td', {}, figure.label),
    element('td', { class: 'number', 'data-key': figure.key, 'data-value': figure.value, 'data-error': figure.error },
      estimate(figure.value, figure.error)),
    element('td', {}, figure.unit),
    tested ? element('td', { class: 'number' },
      figure.error > 0 ? `${readable(Math.abs(figure.value) / figure.error, 2)} \u03c3` : '\u2013') : null));
  const titles = ['parameter', 'value \u00b1 1 \u03c3', 'unit', ...(tested ? ['from zero'] : [])];
  return element('article', { class: 'finding' },
    element('h3', {}, finding.title, finding.remark ? element('small', {}, ` ${finding.remark}`) : null),
    finding.texts.map((text) => element('p', {}, text)),
    rows.length === 0 ? null : element('div', { class: 'scroll' }, element('table', {},
      element('thead', {}, element('tr', {}, titles.map((h) => element('th', {}, h)))),
      element('tbody', {}, rows))));
}

export function findings(run) {
  const steps = run.next_steps.length === 0 ? null
    : element('div', { class: 'next-steps' }, element('h3', {}, 'What would settle the rest'),
      element('ul', {}, run.next_steps.map((text) => element('li', {}, text))));
  return section(run.findings_title, element('div', { class: 'findings' }, run.findings.map(card)), steps);
}

// Horizontal bars from zero; negative ones to the left.
export function barChart(json) {
  const values = json.bars.map((bar) => bar.value ?? 0);
  const low = Math.min(0, ...values), high = Math.max(0, ...values);
  const span = high - low || 1;
  const percent = (value) => `${(100 * value / span).toFixed(3)}%`;
  return element('figure', { class: 'bars' }, element('figcaption', {}, json.title),
    element('div', { class: 'bar-rows' }, json.bars.map((bar) => {
      const value = bar.value ?? 0;
      return element('div', { class: bar.highlighted ? 'bar-row strong' : 'bar-row' },
        element('span', { class: 'bar-label' }, bar.label),
        element('span', { class: 'bar-track' }, element('i', {
          style: `left:${percent(Math.min(value, 0) - low)};width:${percent(Math.abs(value))};` +
            `background:${bar.highlighted ? palette.blue : palette.grey}`,
        })),
        element('span', { class: 'bar-value' }, readable(bar.value)),
        element('span', { class: 'bar-note' }, bar.note));
    })),
    element('p', { class: 'bar-axis' }, json.x_label));
}
