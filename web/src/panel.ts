// Small pieces of the page: labelled controls, tables, buttons.

type Child = Node | string;

export const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
export const root = document.documentElement;

/** Makes an element with attributes and children. */
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const out = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, value);
  out.append(...children);
  return out;
}

export function button(text: string, title: string, act: () => void): HTMLButtonElement {
  const out = el('button', { type: 'button', title }, text);
  out.addEventListener('click', act);
  return out;
}

export function select<T extends string>(
  label: string,
  values: readonly T[],
  value: T,
  act: (value: T) => void,
): { row: HTMLElement; set: (value: T) => void } {
  const box = el('select', {}, ...values.map((v) => el('option', { value: v }, v)));
  box.value = value;
  box.addEventListener('change', () => act(box.value as T));
  return { row: el('label', { class: 'row' }, label, box), set: (v) => (box.value = v) };
}

export function slider(
  label: string,
  [low, high, step]: [number, number, number],
  value: number,
  act: (value: number) => void,
): { row: HTMLElement; set: (value: number) => void; limits: (low: number, high: number) => void; step: (step: number) => void } {
  const box = el('input', { type: 'range', min: `${low}`, max: `${high}`, step: `${step}` });
  const shown = el('output', {}, '');
  const tell = () => (shown.value = `${Math.round(Number(box.value) * 100) / 100}`);
  box.value = `${value}`;
  tell();
  box.addEventListener('input', () => {
    tell();
    act(Number(box.value));
  });
  return {
    row: el('label', { class: 'row' }, label, box, shown),
    set: (v) => {
      box.value = `${v}`;
      tell();
    },
    limits: (from, to) => {
      box.min = `${from}`;
      box.max = `${to}`;
      box.step = `${(to - from) / 1000}`;
      tell();
    },
    step: (by) => (box.step = `${by}`),
  };
}

export function check(
  label: string,
  on: boolean,
  act: (on: boolean) => void,
): { row: HTMLElement; set: (on: boolean) => void; on: () => boolean } {
  const box = el('input', { type: 'checkbox' });
  box.checked = on;
  box.addEventListener('change', () => act(box.checked));
  return { row: el('label', { class: 'row check' }, box, label), set: (v) => (box.checked = v), on: () => box.checked };
}

/** A table of two columns. */
export function facts(rows: [string, string][]): HTMLTableElement {
  const table = el('table');
  for (const [name, value] of rows) {
    table.append(el('tr', {}, el('th', { scope: 'row' }, name), el('td', {}, value)));
  }
  return table;
}

/** A table with a heading for each column. */
export function grid(headings: string[], rows: string[][]): HTMLTableElement {
  const head = el('tr', {}, ...headings.map((h) => el('th', { scope: 'col' }, h)));
  const body = rows.map((row) => el('tr', {}, ...row.map((cell) => el('td', {}, cell))));
  return el('table', { class: 'grid' }, el('thead', {}, head), el('tbody', {}, ...body));
}

/** A number with four significant digits, or a dash for none. */
export function shortened(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (Number.isInteger(value)) return `${value}`;
  const size = Math.abs(value);
  return size >= 1e4 ? value.toFixed(1) : size >= 1e-3 ? `${Number(value.toPrecision(4))}` : value.toExponential(2);
}
