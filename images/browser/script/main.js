// The page: reads the data in it and assembles its sections.

import { Chart } from './curves.js';
import { read } from './data.js';
import { element, section } from './elements.js';
import { MapSection, readMap } from './maps.js';
import { waterfall } from './power.js';
import { StageSection } from './stage.js';
import { cards, figureTable, provenance, table } from './tables.js';

function header(run) {
  const warnings = run.provenance.warnings ?? [];
  return element('header', {},
    element('h1', {}, run.title, element('span', { class: 'verb' }, run.verb)),
    run.headline ? element('p', { class: 'headline' }, run.headline) : null,
    warnings.map((text) => element('p', { class: 'warning', role: 'alert' }, element('b', {}, 'Do not trust: '), text)),
    run.headlines.length > 0 ? cards(run.headlines) : null);
}

const bodies = (charts) => element('div', { class: 'charts' }, charts.map((chart) => chart.body));

// Section of the curves with the line of the slider: the first few directly, the others folded.
function alongTheSlider(stage, charts) {
  // Only the curves of the selected recording are visible.
  const atOnce = charts.some((chart) => chart.json.cursor.only_at) ? charts.length : stage?.bodies.length > 1 ? 6 : 4;
  const title = stage?.axes.some((axis) => axis.plays) ? 'Over time' : 'Along the slider';
  const more = charts.slice(atOnce);
  return section(title, bodies(charts.slice(0, atOnce)), more.length === 0 ? null
    : element('details', {}, element('summary', {}, `${more.length} more`), bodies(more)));
}

function build(run) {
  const main = document.getElementById('page');
  if (!run.with_text) main.append(header(run));
  const maps = run.maps.map(readMap);
  const byName = new Map(maps.map((map) => [map.name, map]));
  const charts = run.plots.map((plot) => new Chart(plot));
  const mapSection = maps.length > 0 ? new MapSection(maps, run.colours) : null;
  if (run.stage) {
    const stage = new StageSection(run.stage, byName, run.colours);
    stage.onmove = (at) => charts.forEach((chart) => chart.follow(at));
    stage.player.update();
    if (mapSection) {
      mapSection.onbin = (name, bin) => stage.markBin(name, bin);
      stage.onbin = (name, bin) => mapSection.follow(name, bin);
    }
    main.append(section('Scene', stage.body));
  }
  const isTold = (chart) => chart.json.cursor;
  const moving = charts.filter(isTold), others = charts.filter((chart) => !isTold(chart));
  if (moving.length > 0) main.append(alongTheSlider(run.stage, moving));
  const pair = element('div', { class: 'pair' });
  if (mapSection) pair.append(section('Maps', mapSection.body));
  if (run.power.length > 1) pair.append(section('Power losses', waterfall(run.power)));
  main.append(pair);
  if (others.length > 0) main.append(section('Curves', bodies(others)));
  if (run.figures.length > 0) main.append(section('Figures', ...figureTable(run.figures, run.figures_file)));
  if (run.tables.length > 0) main.append(section('Tables', ...run.tables.map(table)));
  if (run.notes.length > 0) {
    main.append(section('Notes', element('ul', {}, run.notes.map((note) => element('li', {}, note)))));
  }
  // The text of a report continues below the scene; the provenance follows it.
  main.closest('main').append(element('footer', {}, section('Provenance', provenance(run.provenance, run.command))));
}

build(read(document));
document.documentElement.dataset.ready = 'yes';
