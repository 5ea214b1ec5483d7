// Two files side by side with one camera: split screen, or a line that is swiped over the picture.
import type { App } from './context';
import type { Action } from './keys';
import { button, el, root, select, slider } from './panel';

export const COMPARE_MODES = ['off', 'split', 'swipe'] as const;
export type CompareMode = (typeof COMPARE_MODES)[number];

export class Compare {
  private mode: CompareMode = 'off';
  private share = 0.5;
  private readonly boxes = ['Left', 'Right'].map((name) => {
    const box = el('select', { 'aria-label': name });
    box.addEventListener('change', () => this.app.run(this.apply()));
    return { box, row: el('label', { class: 'row' }, name, box) };
  });
  private readonly modeBox;
  /** Names of the files over their pictures, and the line between them. */
  private readonly names = ['left', 'right'].map((side) => el('p', { class: `side ${side}` }));
  private readonly over = el('div', { id: 'sides', hidden: '' }, ...this.names, el('div', { class: 'line' }));

  constructor(
    private readonly app: App,
    private readonly show: (id: number) => Promise<void>,
    private readonly shown: (mode: 'error' | 'packet error') => void,
  ) {
    this.modeBox = select('Compare', COMPARE_MODES, 'off', (mode) => this.set(mode));
    const line = slider('Line', [0, 1, 0.01], 0.5, (v) => {
      this.share = v;
      app.run(this.apply());
    });
    const errors = button('Errors', 'Colour both logs by the error of the range, beam by beam', () => app.run(this.errors()));
    app.section('Side by side', this.modeBox.row, ...this.boxes.map((b) => b.row), line.row, errors);
    app.viewer.canvas.after(this.over);
    this.refresh();
  }

  /** Lists the files anew. */
  refresh(): void {
    const files = this.app.files.list.filter((f) => f.kind !== 'score');
    this.boxes.forEach(({ box }, k) => {
      const kept = box.value;
      box.replaceChildren(...files.map((f) => el('option', { value: `${f.id}` }, f.name)));
      box.value = kept || `${files[Math.min(k, files.length - 1)]?.id ?? ''}`;
    });
  }

  private set(mode: CompareMode): void {
    this.mode = mode;
    this.modeBox.set(mode);
    this.app.run(this.apply());
  }

  /** Compares both logs beam by beam. */
  private async errors(): Promise<void> {
    const ids = this.boxes.map(({ box }) => Number(box.value));
    for (const id of ids) await this.show(id);
    const [left, right] = ids.map((id) => this.app.files.clouds.get(id));
    if (!left || !right) throw new Error('Errors need two logs, left and right');
    await Promise.all([left.compareWith(right.octree.file), right.compareWith(left.octree.file)]);
    const mode = this.app.state.points === 'packet error' ? 'packet error' : 'error';
    this.app.state.points = mode;
    this.shown(mode);
    this.app.apply();
    this.app.tell('Errors from 0 (dark) to 1 m and more (bright); orange where the other log has no hit');
  }

  private async apply(): Promise<void> {
    const { viewer, files } = this.app;
    const [left, right] = this.boxes.map(({ box }) => Number(box.value));
    if (this.mode === 'off' || this.boxes.some(({ box }) => box.value === '')) {
      viewer.sides = null;
    } else {
      await this.show(left!);
      await this.show(right!);
      const group = (id: number) => (files.clouds.get(id) ?? files.worlds.get(id))!.group;
      viewer.sides = { mode: this.mode, left: group(left!), right: group(right!), share: this.share };
    }
    root.dataset.compare = this.mode;
    this.over.hidden = viewer.sides === null;
    this.over.style.setProperty('--at', `${100 * (this.mode === 'split' ? 0.5 : this.share)}%`);
    [left, right].forEach((id, k) => (this.names[k]!.textContent = viewer.sides ? files.file(id!).name : ''));
    viewer.resize();
    if (viewer.navigation.framed) this.app.frame();
  }

  actions(): Action[] {
    const next = () => this.set(COMPARE_MODES[(COMPARE_MODES.indexOf(this.mode) + 1) % COMPARE_MODES.length]!);
    return [{ key: '0', name: 'side by side: off, split screen, swipe', act: next }];
  }
}
