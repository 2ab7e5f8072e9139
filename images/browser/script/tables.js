// Figures, tables and provenance.

import { element } from './elements.js';
import { estimate, readable } from './format.js';

export function cards(figures) {
  return element('div', { class: 'cards' }, figures.map((figure) => element('div', {},
    element('b', { 'data-key': figure.key, 'data-value': figure.value, 'data-error': figure.error },
      estimate(figure.value, figure.error), figure.unit ? element('small', {}, ` ${figure.unit}`) : null),
    element('span', {}, figure.label))));
}

export function figureTable(figures, file) {
  const body = element('tbody', {}, figures.map((figure) => element('tr', {},
    element('td', {}, figure.label),
    element('td', { class: 'number', 'data-key': figure.key, 'data-value': figure.value, 'data-error': figure.error },
      estimate(figure.value, figure.error)),
    element('td', {}, figure.unit),
    element('td', {}, element('code', {}, figure.key)))));
  const filter = element('input', {
    type: 'search', placeholder: 'find a figure', 'aria-label': 'Find a figure',
    oninput: () => {
      const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
      for (const row of body.rows) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
    },
  });
  return [filter, element('div', { class: 'scroll' }, element('table', { id: 'figures' },
    element('thead', {}, element('tr', {}, ['figure', 'value ± standard error', 'unit', `in ${file}`].map((h) => element('th', {}, h)))),
    body))];
}

export function table(json) {
  const shown = Math.max(0, ...json.columns.map((column) => column.cells.length));
  const rows = [];
  for (let i = 0; i < shown; ++i) {
    rows.push(element('tr', {}, json.columns.map(({ cells }) => {
      const cell = cells[i];
      return typeof cell === 'string' ? element('td', {}, cell)
        : element('td', { class: 'number', title: cell === null ? null : String(cell) }, readable(cell, 5));
    })));
  }
  const count = shown < json.rows ? `the first ${shown} of ${json.rows} rows; ${json.name}.csv contains all rows` : `${json.rows} rows`;
  return element('details', {}, element('summary', {}, json.title || json.name, element('small', {}, ` ${count}`)),
    element('div', { class: 'scroll' }, element('table', {},
      element('thead', {}, element('tr', {}, json.columns.map((column) => element('th', {}, column.name)))),
      element('tbody', {}, rows))));
}

export function provenance(json, command) {
  const row = (name, ...value) => [element('dt', {}, name), element('dd', {}, ...value)];
  return element('dl', { class: 'provenance' },
    row('Command', element('code', {}, command)),
    row('Program', `${json.program} ${json.version}, git ${json.git_hash}`),
    row('Seed', String(json.seed)),
    json.rays ? row('Rays', String(json.rays).replace(/\B(?=(\d{3})+$)/g, '\u202f')) : [],
    row('Inputs', element('ul', {}, Object.entries(json.inputs).map(([file, hash]) =>
      element('li', {}, `${file} `, element('code', {}, hash))))));
}
