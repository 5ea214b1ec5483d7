// What the colours of the picture mean: a scale or a list for points, for elements and for beams.
import { classColours, mapCss } from './colours';
import type { Cloud } from './cloud';
import type { App } from './context';
import { el } from './panel';

/** The words of the scales. */
const POINT_WORDS: Record<string, string> = {
  height: 'Points by height, m',
  intensity: 'Points by intensity',
  time: 'Points by time, s',
  ring: 'Points by ring',
  return: 'Points by number of the return',
  class: 'Points by class',
  file: 'Points by file',
  instance: 'Points by instance',
  error: 'Points by error of the range, m',
  'packet error': 'Points by error of the packet, m',
};
const ELEMENT_WORDS: Record<string, string> = { p: 'Elements by hit probability p', class: 'Elements by class', height: 'Elements by height, m' };
const BEAMS: [string, string][] = [['#57b5e8', 'hit'], ['#e69e00', 'miss'], ['#f2cf80', 'inferred miss']];
const MISSING = '#d65e00';

type Row = [colour: string, name: string];

const heading = (title: string) => el('p', { class: 'title' }, title);

function list(title: string, rows: Row[]): HTMLElement {
  const items = rows.map(([colour, name]) => {
    const swatch = el('span', { class: 'swatch' });
    swatch.style.background = colour;
    return el('li', {}, swatch, name);
  });
  return el('div', {}, heading(title), el('ul', {}, ...items));
}

function scale(title: string, gradient: string, ends: (number | string)[]): HTMLElement {
  const bar = el('div', { class: 'bar' });
  bar.style.background = gradient;
  const numbers = ends.filter((v) => typeof v === 'number');
  const span = Math.max(...numbers) - Math.min(...numbers);
  const digits = span > 0 ? Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(span)))) : 2;
  const told = ends.map((v) => el('span', {}, typeof v === 'number' ? `${Number(v.toFixed(digits))}` : v));
  return el('div', {}, heading(title), bar, el('div', { class: 'ends' }, ...told));
}

const three = (low: number, high: number) => [low, (low + high) / 2, high];

export class Legend {
  private readonly box = el('section', { id: 'legend', 'aria-label': 'Legend' });
  /** Whether beams of a scan are shown. */
  beams = false;

  constructor(private readonly app: App) {
    document.body.append(this.box);
  }

  /** Shows what the colours mean now. */
  show(): void {
    const { viewer, state } = this.app;
    const clouds = [...viewer.clouds].filter((cloud) => cloud.group.visible);
    const worlds = [...viewer.worlds].filter((world) => world.group.visible);
    for (const cloud of clouds) classColours.add(cloud.octree.facts.labels.map((l) => l.number));
    const parts: HTMLElement[] = [];
    if (clouds.length > 0) parts.push(...this.points(clouds));
    if (worlds.length > 0 && state.worlds !== 'plain') parts.push(this.elements());
    if (this.beams) parts.push(list('Beams', BEAMS));
    this.box.replaceChildren(...parts);
    this.box.hidden = parts.length === 0 || !state.legend;
  }

  private heights(): number[] {
    const { viewer, files } = this.app;
    const base = files.origin?.z ?? 0;
    const { x, y } = viewer.display.uniforms.heights.value;
    return three(x + base, y + base);
  }

  private points(clouds: Cloud[]): HTMLElement[] {
    const { state, files } = this.app;
    const title = POINT_WORDS[state.points]!;
    const map = mapCss(state.map);
    const first = clouds[0]!;
    if (state.points === 'height') return [scale(title, map, this.heights())];
    if (state.points === 'intensity') {
      return clouds.map((cloud) => {
        const name = clouds.length > 1 ? `, ${files.file(cloud.octree.file).name}` : '';
        return scale(`${title}${name}`, map, three(...cloud.painted.intensities));
      });
    }
    if (state.points === 'time') return [scale(title, map, three(0, Math.max(...clouds.map((c) => c.painted.span))))];
    if (state.points === 'ring') return [scale(title, map, [0, Math.max(...clouds.map((c) => c.painted.rings))])];
    if (state.points === 'error' || state.points === 'packet error') {
      const roots = mapCss(state.map, (share) => share * share);
      return [scale(title, roots, [0, 0.5, '1 and more']), list('', [[MISSING, 'no hit in the other log']])];
    }
    if (state.points === 'return') {
      const most = Math.min(8, Math.max(...clouds.map((cloud) => cloud.octree.facts.most_echo)));
      return [list(title, Array.from({ length: most }, (_, k): Row => [classColours.css(k + 1), `${k + 1}`]))];
    }
    if (state.points === 'file') {
      return [list(title, clouds.map((c): Row => [classColours.css(c.octree.file + 1), files.file(c.octree.file).name]))];
    }
    if (state.points === 'instance') return [list(title, [[classColours.css(0), 'none; others by turns']])];
    return [list(title, this.classes(first.marked ?? clouds.flatMap((cloud) => cloud.octree.facts.labels)))];
  }

  private classes(labels: { number: number; name: string }[]): Row[] {
    const names = new Map(labels.map((l) => [l.number, l.name]));
    if (names.size === 0) return [[classColours.css(0), 'no classes']];
    return [...names].map(([label, name]): Row => [classColours.css(label), name]);
  }

  private elements(): HTMLElement {
    const { state, viewer } = this.app;
    const title = ELEMENT_WORDS[state.worlds]!;
    if (state.worlds === 'p') return scale(title, mapCss(state.elementMap), [0, 0.5, 1]);
    if (state.worlds === 'height') return scale(title, mapCss(state.elementMap), this.heights());
    const classes = new Map<number, string>();
    for (const world of viewer.worlds) {
      if (!world.group.visible) continue;
      for (const label of world.labels) classes.set(label, world.facts.classes[label] ?? `${label}`);
    }
    const rows = [...classes].sort((a, b) => a[0] - b[0]).map(([label, name]): Row => [classColours.css(label), name]);
    return list(title, [...rows, ['#9e8c73', 'meshes']]);
  }
}
