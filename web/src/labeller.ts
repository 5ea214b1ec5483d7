// The labeller: it puts tools, classes and the labels of the chosen log together.
import { Matrix4 } from 'three';
import { json, query, type ServedFile } from './api';
import type { App } from './context';
import type { Action } from './keys';
import { ClassList, histogram } from './label-panel';
import { type Change, Labelled } from './labelled';
import type { Menu } from './menu';
import { button, check, el, root, select, slider } from './panel';
import { type Drawn, type ToolName, Tools } from './tools';

export const MODES = ['paint', 'select', 'add', 'take away'] as const;
export type Mode = (typeof MODES)[number];

interface Counted {
  points: number;
  histogram: Record<string, { low: number; high: number; counts: number[] }>;
}

export class Labeller {
  labelled: Labelled | null = null;
  current = 1;
  mode: Mode = 'paint';
  readonly hidden = new Set<number>();
  readonly locked = new Set<number>();
  readonly tools: Tools;
  /** Called when another file is labelled or its labels changed. */
  readonly onChange: (() => void)[] = [];
  private depth = 0;
  private onlyTimes = false;
  private readonly classes: ClassList;
  private readonly saved = el('p', { class: 'note', role: 'status', 'aria-label': 'Saved' });
  private readonly facts = el('div');
  private readonly body = el('div', { hidden: '' });
  private readonly choice = el('select', { 'aria-label': 'Log to label' });
  private readonly modeBox;
  private readonly scan = el('select', { 'aria-label': 'Scan to label' });
  private readonly toolButtons = new Map<ToolName | null, HTMLButtonElement>();
  private readonly undoButton = button('Undo', 'Undo (Z)', () => this.step(true));
  private readonly redoButton = button('Redo', 'Redo (Y)', () => this.step(false));

  constructor(
    readonly app: App,
    private readonly menu: Menu,
  ) {
    this.tools = new Tools(app.viewer.canvas, app.viewer.navigation, (drawn) => this.drawn(drawn));
    this.classes = new ClassList({
      choose: (k) => this.choose(k),
      hide: (k) => this.toggle(this.hidden, k),
      lock: (k) => this.toggle(this.locked, k),
      isolate: (k) => this.isolate(k),
    });
    this.modeBox = select('Drawing', MODES, this.mode, (v) => (this.mode = v));
    this.scan.addEventListener('change', () => this.showScan());
    this.choice.addEventListener('change', () => app.run(this.open(this.choice.value === '' ? null : Number(this.choice.value))));
    app.onClose.push(() => this.take(null));
    this.build();
    this.listLogs();
  }

  // --- which log ---------------------------------------------------------------------------------

  /** Lists the logs that can be labelled. */
  listLogs(): void {
    const kept = this.choice.value;
    this.choice.replaceChildren(
      el('option', { value: '' }, 'choose a log to label'),
      ...this.app.of('log').map((f) => el('option', { value: `${f.id}` }, f.name)),
    );
    this.choice.value = kept;
  }

  async open(id: number | null): Promise<void> {
    this.labelled?.close();
    this.labelled = null;
    this.body.hidden = id === null;
    this.choice.value = id === null ? '' : `${id}`;
    if (id === null) return this.changed();
    const file = this.app.files.file(id);
    await this.menu.toggle(file, true); // waits where it is being opened
    const next = new Labelled(id, this.app.files.clouds.get(id)!, () => this.changed());
    await next.open();
    this.labelled = next;
    next.cloud!.setHidden(this.hidden);
    this.listScans();
    this.app.state.points = 'class';
    this.menu.pointMode.set('class');
    this.app.apply();
    this.changed();
  }

  /** Lists the scans of the log, to label one of them alone. */
  private listScans(): void {
    const scans = [...new Set(this.labelled!.cloud!.octree.runs.map((run) => run.scan))].slice(0, 5000);
    this.scan.replaceChildren(el('option', { value: '' }, 'all'), ...scans.map((s) => el('option', { value: `${s}` }, `${s}`)));
  }

  /** Shows the times of the chosen scan alone, or all. */
  private showScan(): void {
    this.menu.time.showScan(this.labelled!.cloud!.octree, this.scan.value === '' ? null : Number(this.scan.value));
  }

  get file(): ServedFile | null {
    return this.labelled ? this.app.files.file(this.labelled.file) : null;
  }

  // --- drawing -----------------------------------------------------------------------------------

  take(tool: ToolName | null): void {
    if (tool && !this.labelled) {
      this.app.tell('Choose a log to label in the menu');
      return;
    }
    this.tools.take(this.tools.tool === tool ? null : tool);
    root.dataset.tool = this.tools.tool ?? '';
    this.toolButtons.forEach((b, name) => b.setAttribute('aria-pressed', `${name === this.tools.tool}`));
  }

  /** Which points may be changed: not hidden, not locked, in the slice and the times that are shown. */
  conditions(): Change {
    const { state, files } = this.app;
    const out: Change = { hidden: [...this.hidden], locked: [...this.locked] };
    if (state.slice.on) {
      const k = ['x', 'y', 'z'].indexOf(state.slice.axis);
      const at = state.slice.at + files.origin!.getComponent(k);
      const half = state.slice.thickness / 2;
      out.slab = [0, 1, 2].map((c) => Number(c === k)).concat(at - half, at + half);
    }
    if (this.onlyTimes) out.times = this.menu.shownTimes();
    if (this.scan.value !== '') out.scan = Number(this.scan.value);
    return out;
  }

  /** What is done to the points that are meant. */
  private deed(shift: boolean, alt: boolean): { name: string; change: Change } {
    const state = this.labelled!.state!;
    if (this.mode === 'paint') {
      const to = alt ? 0 : this.current;
      return { name: state.classes[to]!.name, change: { class: to, of_class: alt ? this.current : null } };
    }
    const mode = shift ? 'add' : alt ? 'take away' : this.mode;
    const select = mode === 'add' ? 'add' : mode === 'take away' ? 'remove' : 'only';
    return { name: mode, change: { select } };
  }

  /** Takes what was drawn for another purpose; returns whether it did. */
  intercept: ((drawn: Drawn) => boolean) | null = null;

  /** Does to the points in a place what drawing would do to them. */
  change(place: Change, source: string): void {
    const { name, change } = this.deed(false, false);
    this.send({ ...this.conditions(), ...place, ...change, name: `${source}: ${name}` });
  }

  private drawn(drawn: Drawn): void {
    if (this.intercept?.(drawn) || !this.labelled) return;
    if (this.app.viewer.sides?.mode === 'split') {
      this.app.tell('Draw on one picture: leave the split screen first (0)');
      return;
    }
    const { camera } = this.app.viewer;
    const { cloud } = this.labelled;
    camera.updateMatrixWorld();
    const matrix = new Matrix4()
      .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
      .multiply(new Matrix4().makeTranslation(cloud!.group.position));
    const { name, change } = this.deed(drawn.shift, drawn.alt);
    // A brush in the mode `select` begins a selection with its first part and then adds to it.
    if (drawn.radius > 0 && change.select === 'only') {
      if (this.lastStroke === drawn.stroke) change.select = 'add';
      this.lastStroke = drawn.stroke;
    }
    const shape: Change = {
      matrix: matrix.elements,
      path: drawn.path,
      radius: drawn.radius,
      width: drawn.width,
      height: drawn.height,
      depth: this.depth,
    };
    const tool = this.tools.tool ?? 'lasso';
    this.send({ ...this.conditions(), ...shape, ...change, stroke: drawn.stroke, name: `${tool}: ${name}` });
  }
  private lastStroke = 0;

  private send(change: Change): void {
    this.app.run(
      this.labelled!.edit(change).then((reply) => {
        root.dataset.edited = `${reply.rows}`;
        this.app.tell(`${reply.rows} points changed`);
      }),
    );
  }

  /** Changes the selected points. */
  private ofSelected(change: Change, name: string): void {
    if (!this.labelled?.state?.selected) {
      this.app.tell('Nothing is selected');
      return;
    }
    this.send({ ...this.conditions(), of_selected: 1, ...change, name });
  }

  private step(back: boolean): void {
    if (!this.labelled) return;
    this.app.run(this.labelled.send(back ? 'undo' : 'redo', {}, false));
  }

  // --- classes -----------------------------------------------------------------------------------

  private choose(k: number): void {
    const n = this.labelled?.state?.classes.length ?? 1;
    this.current = (k + n) % n;
    this.changed();
  }

  private toggle(set: Set<number>, k: number): void {
    if (!set.delete(k)) set.add(k);
    this.labelled?.cloud?.setHidden(this.hidden);
    this.changed();
  }

  private isolate(k: number): void {
    const others = (this.labelled?.state?.classes ?? []).map((_, i) => i).filter((i) => i !== k);
    const alone = others.every((i) => this.hidden.has(i));
    this.hidden.clear();
    if (!alone) others.forEach((i) => this.hidden.add(i));
    this.labelled?.cloud?.setHidden(this.hidden);
    this.changed();
  }

  // --- the panel ---------------------------------------------------------------------------------

  private build(): void {
    const tool = (name: ToolName | null, text: string, key: string) => {
      const out = button(text, `${text} (${key})`, () => this.take(name));
      this.toolButtons.set(name, out);
      return out;
    };
    const depth = slider('Depth limit, m', [0, 5, 0.05], 0, (v) => (this.depth = v));
    depth.row.title = 'Only points at most this far behind the nearest; 0 = all that lie behind';
    const brush = slider('Brush, pixels', [2, 100, 1], this.tools.radius, (v) => this.tools.setRadius(v));
    const times = check('Only the times shown below', false, (v) => (this.onlyTimes = v));
    this.body.append(
      el('div', { class: 'buttons' }, tool(null, 'Move', 'Escape'), tool('lasso', 'Lasso', 'O'),
        tool('brush', 'Brush', 'I'), tool('rectangle', 'Rectangle', 'K')),
      ...[this.modeBox, depth, brush, times].map((c) => c.row),
      el('label', { class: 'row', title: 'Only points of this scan are changed' }, 'Scan', this.scan),
      el('div', { class: 'buttons' }, this.undoButton, this.redoButton),
      this.saved,
      this.classes.element,
      this.facts,
      el('div', { class: 'buttons' }, ...this.selectionButtons()),
    );
    this.app.section('Label', this.choice, this.body);
  }

  private selectionButtons(): HTMLElement[] {
    return [
      button('Slab', 'Give the class to all points of the slice, or select them (J)', () => this.slab()),
      button('Give class', 'Give the class to what is selected (R)', () => this.giveClass()),
      button('New instance', 'Make one instance of what is selected, also to split or to merge (G)', () => this.newInstance()),
      button('No instance', 'Take the instance off what is selected', () => this.ofSelected({ instance: 0 }, 'no instance')),
      button('Clear', 'Select nothing (U)', () => this.ofSelected({ select: 'remove' }, 'clear')),
      button('Histogram', 'Heights and intensities of what is selected', () => this.app.run(this.showHistogram())),
    ];
  }

  private giveClass(): void {
    this.ofSelected({ class: this.current }, this.labelled?.state?.classes[this.current]?.name ?? '');
  }

  private newInstance(): void {
    this.ofSelected({ instance: 'new' }, 'new instance');
  }

  private slab(): void {
    if (!this.labelled || !this.app.state.slice.on) {
      this.app.tell('Switch the slice on first (X)');
      return;
    }
    this.change({}, 'slab');
  }

  private async showHistogram(): Promise<void> {
    if (!this.labelled) return;
    const counted = await json<Counted>(`labels/count?${query({ file: this.labelled.file, of_selected: 1 })}`);
    const parts = Object.entries(counted.histogram).map(([name, h]) => histogram(name.replace('_m', ', m'), h));
    const close = button('×', 'Close (Escape)', () => this.app.closeDetails());
    this.app.showDetails([
      el('div', { class: 'head' }, el('h2', {}, `${counted.points} selected points`), close),
      ...parts,
    ]);
  }

  /** Shows the present state. */
  private changed(): void {
    const state = this.labelled?.state;
    if (state) {
      this.classes.show(state, this.current, this.hidden, this.locked);
      this.undoButton.disabled = state.undos === 0;
      this.redoButton.disabled = state.redos === 0;
      this.undoButton.textContent = state.undos > 0 ? `Undo “${state.last}” (${state.undos})` : 'Undo';
      this.redoButton.textContent = state.redos > 0 ? `Redo “${state.next}” (${state.redos})` : 'Redo';
      const { pending, trouble } = this.labelled!;
      this.saved.textContent = trouble
        ? `Not saved: ${trouble}`
        : pending > 0
          ? `Saving ${pending}…`
          : `All is saved (state ${state.revision})${state.lost_bytes ? `; ${state.lost_bytes} damaged bytes were set aside` : ''}`;
      this.facts.textContent = `${state.selected} points selected`;
      root.dataset.revision = `${state.revision}`;
      root.dataset.selected = `${state.selected}`;
    }
    this.onChange.forEach((act) => act());
    this.app.viewer.draw();
  }

  /** The keys of the labeller. */
  actions(): Action[] {
    const radius = (factor: number) => () => this.tools.setRadius(this.tools.radius * factor);
    const nextMode = () => {
      this.mode = MODES[(MODES.indexOf(this.mode) + 1) % MODES.length]!;
      this.modeBox.set(this.mode);
    };
    return [
      { key: 'o', name: 'label: lasso', act: () => this.take('lasso') },
      { key: 'i', name: 'label: brush', act: () => this.take('brush') },
      { key: 'k', name: 'label: rectangle', act: () => this.take('rectangle') },
      { key: 'j', name: 'label: the slice as a slab', act: () => this.slab() },
      { key: 'h', name: 'label: paint, select, add, take away', act: nextMode },
      { key: ',', name: 'label: the class before', act: () => this.choose(this.current - 1) },
      { key: '.', name: 'label: the next class', act: () => this.choose(this.current + 1) },
      { key: '[', name: 'label: smaller brush', act: radius(0.8) },
      { key: ']', name: 'label: larger brush', act: radius(1.25) },
      { key: 'r', name: 'label: give the class to what is selected', act: () => this.giveClass() },
      { key: 'g', name: 'label: make an instance of what is selected', act: () => this.newInstance() },
      { key: 'u', name: 'label: select nothing', act: () => this.ofSelected({ select: 'remove' }, 'clear') },
      { key: '4', name: 'label: hide the class', act: () => this.toggle(this.hidden, this.current) },
      { key: '5', name: 'label: lock the class', act: () => this.toggle(this.locked, this.current) },
      { key: '6', name: 'label: show only the class', act: () => this.isolate(this.current) },
      { key: 'z', name: 'label: undo', act: () => this.step(true) },
      { key: 'y', name: 'label: redo', act: () => this.step(false) },
    ];
  }
}
