// The labeller's part of the menu: tools, classes with their locks, the selection, undo and redo.
import { classColours } from './colours';
import type { LabelState } from './labelled';
import { button, el } from './panel';

export interface ClassActions {
  choose: (index: number) => void;
  hide: (index: number) => void;
  lock: (index: number) => void;
  isolate: (index: number) => void;
}

/** The list of classes: each is chosen, hidden, locked or shown alone. */
export class ClassList {
  readonly element = el('div', { class: 'classes', role: 'group', 'aria-label': 'Classes to label' });
  private readonly rows: { points: HTMLElement; radio: HTMLInputElement; hide: HTMLButtonElement; lock: HTMLButtonElement }[] = [];

  constructor(private readonly actions: ClassActions) {}

  /** Builds the rows anew where the classes are others. */
  show(state: LabelState, current: number, hidden: Set<number>, locked: Set<number>): void {
    if (this.rows.length !== state.classes.length) this.build(state);
    state.classes.forEach((label, k) => {
      const row = this.rows[k]!;
      row.points.textContent = `${label.points}`;
      row.radio.checked = k === current;
      row.hide.setAttribute('aria-pressed', `${hidden.has(k)}`);
      row.lock.setAttribute('aria-pressed', `${locked.has(k)}`);
    });
  }

  private build(state: LabelState): void {
    this.rows.length = 0;
    this.element.replaceChildren();
    state.classes.forEach((label, k) => {
      const radio = el('input', { type: 'radio', name: 'label-class', value: `${k}` });
      radio.addEventListener('change', () => this.actions.choose(k));
      const swatch = el('span', { class: 'swatch' });
      swatch.style.background = classColours.css(k);
      const points = el('span', { class: 'count' });
      const named = (text: string, what: string, act: () => void) => {
        const out = button(text, `${what} ${label.name}`, act);
        out.setAttribute('aria-label', `${what} ${label.name}`);
        return out;
      };
      const hide = named('◌', 'Hide', () => this.actions.hide(k));
      const lock = named('⚿', 'Lock', () => this.actions.lock(k));
      const alone = named('◉', 'Show only', () => this.actions.isolate(k));
      this.rows.push({ points, radio, hide, lock });
      this.element.append(
        el('div', { class: 'class' }, el('label', {}, radio, swatch, label.name), points, hide, lock, alone),
      );
    });
  }
}

/** A histogram as a small picture made of a table's bars, with its ends. */
export function histogram(title: string, data: { low: number; high: number; counts: number[] }): HTMLElement {
  const most = Math.max(1, ...data.counts);
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${data.counts.length} 20`);
  svg.setAttribute('preserveAspectRatio', 'none');
  svg.setAttribute('class', 'histogram');
  svg.setAttribute('role', 'img');
  const span = `${data.low.toFixed(2)} to ${data.high.toFixed(2)}`;
  svg.setAttribute('aria-label', `${title} of the selection, ${span}`);
  data.counts.forEach((n, k) => {
    const bar = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
    const height = (20 * n) / most;
    for (const [key, value] of Object.entries({ x: k, y: 20 - height, width: 0.9, height })) bar.setAttribute(key, `${value}`);
    svg.append(bar);
  });
  return el('figure', {}, svg, el('figcaption', {}, `${title}: ${span}`));
}
