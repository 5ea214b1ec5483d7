// Range images of a scan: what was measured, what another log or a world says, and the error. A
// click on a pixel picks its beam.
import { bytes, query, type ServedFile } from './api';
import { mapColours } from './colours';
import type { App } from './context';
import type { Action } from './keys';
import { button, el, root, slider } from './panel';

const NO_BEAM = 0xffffffff;
const MISS: Colour = [24, 26, 30];
const EMPTY: Colour = [70, 74, 80];
const FALSE_HIT: Colour = [213, 94, 0];
const FALSE_MISS: Colour = [86, 180, 233];
const IMAGES = ['measured', 'simulated', 'error'] as const;
type Colour = readonly [number, number, number];

interface Image {
  file: number;
  beside: ServedFile | null;
  width: number;
  height: number;
  row: Uint32Array;
  measured: Float32Array;
  /** Null where there is nothing beside the measured ranges. */
  other: Float32Array | null;
}

async function loadImage(file: number, run: number, beside: ServedFile | null, seed: number): Promise<Image> {
  const kind = beside?.kind === 'log' ? { other: beside.id } : beside ? { world: beside.id, seed } : {};
  const data = await bytes(`range_image?${query({ file, run, ...kind })}`);
  const [width, height, both] = new Uint32Array(data, 0, 3) as unknown as [number, number, number];
  const n = width * height;
  const out: Image = {
    file,
    beside,
    width,
    height,
    row: new Uint32Array(n),
    measured: new Float32Array(n),
    other: both ? new Float32Array(n) : null,
  };
  const words = new Uint32Array(data, 12);
  const ranges = new Float32Array(data, 12);
  for (let k = 0; k < n; ++k) {
    out.row[k] = words[3 * k]!;
    out.measured[k] = ranges[3 * k + 1]!;
    if (out.other) out.other[k] = ranges[3 * k + 2]!;
  }
  return out;
}

/** The range below which 98 % of the returns lie. */
function farthest(ranges: Float32Array): number {
  const hits = ranges.filter((r) => r > 0).sort();
  return hits.length > 0 ? hits[Math.floor(0.98 * (hits.length - 1))]! : 1;
}

export class RangeImages {
  private readonly logBox = el('select', { 'aria-label': 'Log of the range image' });
  private readonly besideBox = el('select', { 'aria-label': 'Beside the range image' });
  private readonly scanSlider;
  private readonly view = el('section', { id: 'images', 'aria-label': 'Range images', hidden: '' });
  private readonly crosses: HTMLElement[] = [];
  private image: Image | null = null;
  private map = '';
  private run = 0;
  /** Pixel that the keyboard is at. */
  private at = 0;
  private asked = 0;

  constructor(
    private readonly app: App,
    private readonly show: (id: number) => Promise<void>,
    private readonly pick: (file: number, row: number) => Promise<void>,
  ) {
    this.scanSlider = slider('Scan', [0, 1, 1], 0, (k) => this.choose(Math.round(k)));
    const again = () => !this.view.hidden && app.run(this.draw());
    this.logBox.addEventListener('change', () => this.choose(0));
    this.besideBox.addEventListener('change', again);
    const toggle = button('Range images', 'Show or hide the range images of the scan (/)', () => this.toggle());
    app.section(
      'Range images',
      el('label', { class: 'row' }, 'Log', this.logBox),
      el('label', { class: 'row' }, 'Beside it', this.besideBox),
      this.scanSlider.row,
      toggle,
    );
    document.body.append(this.view);
    app.onApply.push(() => this.repaint());
    this.refresh();
  }

  /** Lists the files anew. */
  refresh(): void {
    const fill = (box: HTMLSelectElement, options: HTMLOptionElement[]) => {
      const kept = box.value;
      box.replaceChildren(...options);
      if (options.some((o) => o.value === kept)) box.value = kept;
    };
    const option = (f: ServedFile) => el('option', { value: `${f.id}` }, f.name);
    const worlds = [...this.app.of('model'), ...this.app.of('scene')];
    fill(this.logBox, this.app.of('log').map(option));
    fill(this.besideBox, [el('option', { value: '' }, 'nothing'), ...[...this.app.of('log'), ...worlds].map(option)]);
  }

  private get runs() {
    return this.app.files.clouds.get(Number(this.logBox.value))?.octree.runs ?? [];
  }

  private choose(run: number): void {
    this.run = run;
    if (!this.view.hidden) this.app.run(this.draw());
  }

  /** Shows the scan of a time, in seconds since the first beam. */
  goTo(time: number): void {
    const cloud = this.app.files.clouds.get(Number(this.logBox.value));
    if (this.view.hidden || !cloud) return;
    const at = time + cloud.octree.facts.first_time_s;
    const next = Math.max(0, cloud.octree.runs.filter((run) => run.time <= at).length - 1);
    if (next === this.run) return;
    this.scanSlider.set(next);
    this.choose(next);
  }

  toggle(): void {
    this.view.hidden = !this.view.hidden;
    root.dataset.images = '';
    if (!this.view.hidden) this.app.run(this.draw());
  }

  /** Asks for the images and draws them. */
  private async draw(): Promise<void> {
    if (this.logBox.value === '') throw new Error('There is no log');
    const number = ++this.asked;
    const log = Number(this.logBox.value);
    const beside = this.besideBox.value === '' ? null : this.app.files.file(Number(this.besideBox.value));
    await this.show(log);
    if (beside?.kind === 'log') await this.show(beside.id);
    this.scanSlider.limits(0, Math.max(1, this.runs.length - 1));
    this.scanSlider.step(1);
    this.run = Math.min(this.run, this.runs.length - 1);
    const image = await loadImage(log, this.run, beside, this.app.list.seed);
    if (number !== this.asked) return; // something else was asked for meanwhile
    this.image = image;
    this.paint();
    const hits = image.measured.filter((r) => r > 0).length;
    root.dataset.images = `${image.width} x ${image.height}, ${hits} hits${image.other ? ', both' : ''}`;
  }

  /** Draws the images anew where the colours are others. */
  private repaint(): void {
    if (this.image && this.map !== this.app.state.map) this.paint();
  }

  private paint(): void {
    const image = this.image!;
    const { beside } = image;
    this.map = this.app.state.map;
    const scan = this.runs[this.run];
    const name = this.app.files.file(image.file).name;
    this.crosses.length = 0;
    const far = farthest(image.measured);
    const scale = `0 (dark) to ${far.toFixed(0)} m`;
    const texts = {
      measured: `Measured: ${name}, scan ${scan?.scan ?? 0}; ${scale}; black: no return`,
      simulated: `${beside?.kind === 'log' ? 'Beside it' : 'Simulated'}: ${beside?.name ?? ''}; ${scale}`,
      error: 'Error: 0 (dark) to 1 m and more; orange: a hit where none was measured; blue: a hit is missing',
    };
    const shown = image.other ? IMAGES : IMAGES.slice(0, 1);
    this.view.replaceChildren(
      el('div', { class: 'head' }, el('h2', {}, 'Range images'), button('×', 'Close the range images', () => this.toggle())),
      ...shown.map((kind) => this.figure(kind, texts[kind], far)),
    );
  }

  private figure(kind: (typeof IMAGES)[number], text: string, far: number): HTMLElement {
    const image = this.image!;
    const canvas = el('canvas', {
      width: `${image.width}`,
      height: `${image.height}`,
      tabindex: '0',
      role: 'img',
      'aria-label': `Range image, ${kind}: arrows move, Enter picks the beam`,
    });
    const context = canvas.getContext('2d')!;
    const pixels = context.createImageData(image.width, image.height);
    const map = mapColours(this.app.state.map);
    for (let k = 0; k < image.row.length; ++k) {
      const colour = this.colour(kind, k, far, map);
      pixels.data.set([colour[0], colour[1], colour[2], 255], 4 * k);
    }
    context.putImageData(pixels, 0, 0);
    canvas.addEventListener('click', (e) => {
      const x = Math.floor((e.offsetX / canvas.clientWidth) * image.width);
      const y = Math.floor((e.offsetY / canvas.clientHeight) * image.height);
      this.choosePixel(Math.min(y, image.height - 1) * image.width + Math.min(x, image.width - 1));
    });
    canvas.addEventListener('keydown', (e) => this.steer(e));
    const cross = el('span', { class: 'cross', hidden: '' });
    this.crosses.push(cross);
    return el('figure', {}, el('div', { class: 'image' }, canvas, cross), el('figcaption', {}, text));
  }

  private colour(kind: (typeof IMAGES)[number], k: number, far: number, map: Uint8Array): Colour {
    const { row, measured, other } = this.image!;
    if (row[k] === NO_BEAM) return EMPTY;
    const mapped = (share: number): Colour => {
      const at = 4 * Math.round(255 * Math.min(1, Math.max(0, share)));
      return [map[at]!, map[at + 1]!, map[at + 2]!];
    };
    const range = kind === 'simulated' ? other![k]! : measured[k]!;
    if (kind !== 'error') return range > 0 ? mapped(range / far) : MISS;
    const simulated = other![k]!;
    if (range === 0 && simulated === 0) return MISS;
    if (range === 0) return FALSE_HIT;
    if (simulated === 0) return FALSE_MISS;
    return mapped(Math.sqrt(Math.abs(simulated - range)));
  }

  private steer(event: KeyboardEvent): void {
    const { width, height } = this.image!;
    const [x, y] = [this.at % width, Math.floor(this.at / width)];
    const moves: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const by = moves[event.key];
    if (by) {
      this.at = Math.min(height - 1, Math.max(0, y + by[1])) * width + ((x + by[0] + width) % width);
      this.cross(this.at);
    } else if (event.key === 'Enter') {
      this.choosePixel(this.at);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  private choosePixel(k: number): void {
    this.at = k;
    this.cross(k);
    const row = this.image!.row[k]!;
    if (row === NO_BEAM) this.app.tell('No beam of the scan is at this pixel');
    else this.app.run(this.pick(this.image!.file, row));
  }

  private cross(k: number): void {
    const { width, height } = this.image!;
    for (const cross of this.crosses) {
      cross.hidden = k < 0;
      cross.style.left = `${(100 * ((k % width) + 0.5)) / width}%`;
      cross.style.top = `${(100 * (Math.floor(k / width) + 0.5)) / height}%`;
    }
  }

  /** Marks the pixel of a beam that was picked elsewhere, if the images show it. */
  mark(file: number, row: number): void {
    if (!this.image || this.view.hidden || this.image.file !== file) return;
    const k = this.image.row.indexOf(row);
    if (k >= 0) this.at = k;
    this.cross(k);
  }

  actions(): Action[] {
    return [{ key: '/', name: 'range images of a scan', act: () => this.toggle() }];
  }
}
