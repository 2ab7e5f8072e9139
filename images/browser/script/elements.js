// Elements of the page. Texts become text nodes and never markup.

const svgSpace = 'http://www.w3.org/2000/svg';

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat()) {
    if (child !== null && child !== undefined) node.append(child);
  }
  return node;
}

export function element(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}

export function svg(name, attributes = {}, ...children) {
  return fill(document.createElementNS(svgSpace, name), attributes, children);
}

export function section(title, ...children) {
  const id = title.toLowerCase().replace(/[^a-z]+/g, '-');
  return element('section', { 'aria-labelledby': id }, element('h2', { id }, title), ...children);
}

// A labelled selection list; `choose` is called with the index.
export function choice(label, names, choose, chosen = 0) {
  const select = element('select', {
    'aria-label': label,
    onchange: () => choose(select.selectedIndex),
  }, names.map((name, i) => element('option', { value: i, selected: i === chosen }, name)));
  return element('label', { class: 'choice' }, element('span', {}, label), select);
}

export function check(label, on, change) {
  const box = element('input', { type: 'checkbox', checked: on, onchange: () => change(box.checked) });
  return element('label', { class: 'check' }, box, label);
}
