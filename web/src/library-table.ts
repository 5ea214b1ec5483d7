// The table of a set's primitives: it is sorted and filtered, and its cells are edited in place.
import type { PrimitiveEdits, Row } from './library-edits';
import { button, byId, el, root } from './panel';

const ROWS = 200; // that are added at a time
const COLUMNS = [
  ['folder', 'Primitive'],
  ['name', 'Name'],
  ['class', 'Class'],
  ['height_m', 'Height, m'],
  ['width_m', 'Width, m'],
  ['points', 'Points'],
  ['elements', 'Elements'],
  ['site', 'Site'],
  ['season', 'Season'],
  ['sensor', 'Sensor'],
  ['license', 'Licence'],
] as const;
type Column = (typeof COLUMNS)[number][0];
const ORDER = new Intl.Collator('en', { numeric: true });
const FATES = ['kept and thrown out', 'kept', 'thrown out'];

export interface TableActions {
  /** Changes primitives at once. */
  change: (models: number[], to: { out?: boolean; name?: string; class?: string }) => void;
  show: (model: number) => void;
  close: () => void;
}

export class LibraryTable {
  readonly element = el('section', { id: 'library', 'aria-label': 'Library', hidden: '' });
  private edits: PrimitiveEdits | null = null;
  private pictures = (_: number) => '';
  private column: Column = 'folder';
  private down = false;
  private most = ROWS;
  private chosen = -1;
  private readonly heading = el('h2');
  private readonly kind = el('select', { 'aria-label': 'Class or kind' });
  private readonly fate = el('select', { 'aria-label': 'Kept or thrown out' }, ...FATES.map((f) => el('option', { value: f }, f)));
  private readonly text = el('input', { type: 'search', placeholder: 'Search', 'aria-label': 'Search in names, classes and origins' });
  private readonly classOfAll = el('select', { 'aria-label': 'Class of all shown' });
  private readonly counted = el('span', { class: 'count', role: 'status', 'aria-label': 'Primitives shown' });
  private readonly heads = new Map<Column, HTMLElement>();
  private readonly body = el('tbody');
  private readonly more = button('More', 'Show more rows', () => {
    this.most += ROWS;
    this.show();
  });

  constructor(private readonly actions: TableActions) {
    const head = el('tr', {}, el('th', { scope: 'col' }, 'Picture'));
    for (const [column, title] of COLUMNS) {
      const cell = el('th', { scope: 'col', 'aria-sort': 'none' }, button(title, `Sort by ${title.toLowerCase()}`, () => this.sortBy(column)));
      this.heads.set(column, cell);
      head.append(cell);
    }
    head.append(el('th', { scope: 'col' }, 'Thrown out'));
    const table = el('table', { class: 'grid', 'aria-label': 'Primitives of the library' }, el('thead', {}, head), this.body);
    const again = () => {
      this.most = ROWS;
      this.show();
    };
    [this.kind, this.fate].forEach((box) => box.addEventListener('change', again));
    this.text.addEventListener('input', again);
    const bulk = el(
      'div',
      { class: 'filters', role: 'group', 'aria-label': 'All shown' },
      button('Throw out all shown', 'Throw out every primitive that the filters leave', () => this.changeAll({ out: true })),
      button('Bring back all shown', 'Bring back every primitive that the filters leave', () => this.changeAll({ out: false })),
      this.classOfAll,
      button('Relabel all shown', 'Give every primitive that the filters leave this class', () => this.changeAll({ class: this.classOfAll.value })),
    );
    const close = button('×', 'Close the table (#)', () => this.actions.close());
    close.setAttribute('aria-label', 'Close the table');
    this.element.append(
      el('div', { class: 'head' }, this.heading, el('div', { class: 'filters' }, this.kind, this.fate, this.text), bulk, this.counted, close),
      el('div', { class: 'scroll', tabindex: '0', role: 'group', 'aria-label': 'Table of the library' }, table, this.more),
    );
  }

  /** Takes another set; `pictures` gives the address of a primitive's thumbnail. */
  open(name: string, edits: PrimitiveEdits, pictures: (model: number) => string): void {
    [this.edits, this.pictures, this.chosen, this.most] = [edits, pictures, -1, ROWS];
    this.heading.textContent = name;
    const { classes } = edits.facts;
    const kinds = [...new Set(classes.map((c) => c.kind))];
    this.kind.replaceChildren(
      el('option', { value: '' }, 'all classes'),
      ...kinds.map((kind) => el('option', { value: kind }, kind === 'patch' ? 'cells of patches' : `all ${kind}s`)),
      ...classes.map((c) => el('option', { value: c.name }, c.name)),
    );
    this.classOfAll.replaceChildren(...classes.map((c) => el('option', { value: c.name }, c.name)));
    this.show();
  }

  private sortBy(column: Column): void {
    this.down = this.column === column && !this.down;
    this.column = column;
    this.show();
  }

  /** Changes all rows that the filters leave, those below the last row too. */
  private changeAll(to: { out?: boolean; class?: string }): void {
    const differs = (row: Row) => (to.out === undefined ? !row.out && row.class !== to.class : row.out !== to.out);
    const rows = this.sorted().filter(differs);
    this.actions.change(rows.map((row) => row.model), to);
  }

  /** The rows that the filters leave, in order. */
  private sorted(): Row[] {
    const { rows, facts } = this.edits!;
    const classes = facts.classes.map((c) => c.name);
    const [wanted, words] = [this.kind.value, this.text.value.toLowerCase().split(/\s+/)];
    const found = rows.filter((r) => {
      const kind = facts.classes.find((c) => c.name === r.class)?.kind;
      const text = [r.folder, r.name, r.class, r.set, r.site, r.season, r.sensor, r.license].join(' ').toLowerCase();
      return (
        (wanted === '' || wanted === r.class || wanted === kind) &&
        (this.fate.value === FATES[0] || r.out === (this.fate.value === FATES[2])) &&
        words.every((word) => text.includes(word))
      );
    });
    const { column } = this;
    const compare = (a: Row, b: Row) => {
      if (column === 'class') return classes.indexOf(a.class) - classes.indexOf(b.class);
      const [x, y] = [a[column], b[column]];
      return typeof x === 'number' && typeof y === 'number' ? x - y : ORDER.compare(`${x}`, `${y}`);
    };
    return found.sort((a, b) => (this.down ? -1 : 1) * compare(a, b) || a.model - b.model);
  }

  /** Shows the present state; the control that has the focus keeps it, or the one below it gets it. */
  show(): void {
    if (!this.edits) return;
    for (const [column, head] of this.heads) {
      head.setAttribute('aria-sort', column !== this.column ? 'none' : this.down ? 'descending' : 'ascending');
    }
    const focused = document.activeElement as HTMLElement | null;
    const [control, model] = this.body.contains(focused) ? [focused!.dataset.control, focused!.dataset.model] : [];
    const below = focused?.closest('tr')?.nextElementSibling?.querySelector<HTMLElement>(`[data-control="${control}"]`)?.dataset.model;
    const rows = this.sorted();
    this.body.replaceChildren(...rows.slice(0, this.most).map((row) => this.row(row)));
    this.more.hidden = rows.length <= this.most;
    const of = (m: string | undefined) => this.body.querySelector<HTMLElement>(`[data-control="${control}"][data-model="${m}"]`);
    if (control) (of(model) ?? of(below))?.focus();
    this.count(rows.length);
  }

  private count(shown: number): void {
    const { rows } = this.edits!;
    const out = rows.filter((r) => r.out).length;
    this.counted.textContent = `${shown} of ${rows.length} shown, ${out} thrown out`;
    root.dataset.library = `${shown} ${rows.length} ${out}`;
  }

  private row(row: Row): HTMLElement {
    const { model, folder } = row;
    const named = <T extends HTMLElement>(out: T, control: string, label: string): T => {
      out.setAttribute('aria-label', `${label} ${folder}`);
      Object.assign(out.dataset, { control, model: `${model}` });
      return out;
    };
    const picture = el('img', { src: this.pictures(model), alt: '', loading: 'lazy', width: '40', height: '40' });
    const look = named(button('', 'Show it in the view', () => this.choose(model)), 'show', 'Show');
    look.append(picture);
    const name = named(el('input', { type: 'text' }), 'name', 'Name of');
    name.value = row.name;
    // The table stays as it is, so that Tab goes on to the next control.
    name.addEventListener('change', () => {
      this.actions.change([model], { name: name.value.trim() });
      name.value = row.name;
    });
    const label = named(el('select', {}, ...this.edits!.classesOf(model).map((c) => el('option', { value: c }, c))), 'class', 'Class of');
    label.value = row.class;
    label.addEventListener('change', () => this.actions.change([model], { class: label.value }));
    [name, label].forEach((box) => (box.disabled = row.out));
    const fate = row.out ? 'Bring back' : 'Throw out';
    const out = named(button(fate, `${fate} ${folder}`, () => this.actions.change([model], { out: !row.out })), 'out', fate);
    const text = (value: string) => el('td', {}, value);
    const number = (value: number, digits = 0) => el('td', { class: 'number' }, value.toFixed(digits));
    const line = el(
      'tr',
      {},
      el('td', {}, look),
      text(folder),
      el('td', {}, name),
      el('td', {}, label),
      number(row.height_m, 2),
      number(row.width_m, 2),
      number(row.points),
      number(row.elements),
      ...[row.site, row.season, row.sensor, row.license].map(text),
      el('td', {}, out),
    );
    line.classList.toggle('out', row.out);
    line.classList.toggle('chosen', model === this.chosen);
    line.addEventListener('click', (e) => {
      if (!(e.target as HTMLElement).closest('button, input, select')) this.choose(model);
    });
    return line;
  }

  private choose(model: number): void {
    this.chosen = model;
    this.show();
    this.actions.show(model);
  }

  /** Opens or closes the table. */
  toggle(open: boolean): void {
    const inside = this.element.contains(document.activeElement);
    this.element.hidden = !open;
    if (inside && !open) byId('view').focus();
  }
}
