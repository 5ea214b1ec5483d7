// Placing primitives on a model's ground, and composing a scene of them.
import { Vector3 } from 'three';
import { json, post, type WorldFacts } from './api';
import { Boxes } from './boxes';
import type { App } from './context';
import type { JobsPanel } from './jobs';
import type { Action } from './keys';
import type { Labeller } from './labeller';
import { button, el, slider } from './panel';
import type { Drawn } from './tools';
import type { TimeBar } from './time';
import type { Workflow } from './workflow';

export class Placing {
  readonly boxes: Boxes;
  private readonly target = el('select', { 'aria-label': 'File for boxes' });
  private readonly gallery = el('div', { class: 'gallery', role: 'group', 'aria-label': 'Primitives' });
  private facts: WorldFacts | null = null;
  private set = -1;
  private scattered = -1;
  private spacing = 3;

  constructor(
    private readonly app: App,
    private readonly labeller: Labeller,
    private readonly jobs: JobsPanel,
    private readonly workflow: Workflow,
    time: TimeBar,
  ) {
    this.boxes = new Boxes(app, time);
    this.target.addEventListener('change', () => app.run(this.openBoxes()));
    const spacing = slider('Scatter, m', [0.5, 20, 0.5], this.spacing, (v) => (this.spacing = v));
    app.section(
      'Boxes and placing',
      this.target,
      this.boxes.element,
      el(
        'div',
        { class: 'buttons' },
        button('Label inside', 'Give the class to the points in the box', () => this.labelInside()),
        button('Primitives', 'Show the primitives of the chosen set', () => app.run(this.showGallery())),
        button('Compose', 'Compose a scene of the boxes with the chosen primitives', () => app.run(this.compose())),
        button('Tracks', 'Write the boxes of tracks as lists of objects, for actors --boxes', () => app.run(this.writeTracks())),
        button('Learn actors', 'Learn what moves in the log from the boxes of tracks', () => app.run(this.learnActors())),
      ),
      spacing.row,
      this.gallery,
    );
    const canvas = app.viewer.canvas;
    canvas.addEventListener('dragover', (e) => e.preventDefault());
    canvas.addEventListener('drop', (e) => {
      e.preventDefault();
      const model = Number(e.dataTransfer?.getData('text/x-primitive') ?? 'x');
      if (Number.isInteger(model)) app.run(this.put(model, e.offsetX, e.offsetY));
    });
    labeller.intercept = (drawn) => this.scatter(drawn);
    labeller.onChange.push(() => {
      if (this.boxes.document === labeller.labelled) this.boxes.show();
    });
    jobs.onFiles.push(() => this.listTargets());
    app.onClose.push(() => (this.scattered = -1));
    this.listTargets();
  }

  private listTargets(): void {
    const kept = this.target.value;
    this.target.replaceChildren(
      el('option', { value: '' }, 'choose a model or log for boxes'),
      ...[...this.app.of('model'), ...this.app.of('log')].map((f) => el('option', { value: `${f.id}` }, f.name)),
    );
    this.target.value = kept;
  }

  private async openBoxes(): Promise<void> {
    const id = this.target.value === '' ? null : Number(this.target.value);
    if (id !== null && !this.app.shown.has(id)) await this.workflow.showFile(id);
    if (id !== null && this.app.files.file(id).kind === 'log' && this.labeller.labelled?.file !== id) {
      await this.labeller.open(id);
    }
    const { labelled } = this.labeller;
    await this.boxes.open(id, labelled?.file === id ? labelled : null);
    if (id !== null && this.app.files.file(id).kind === 'model') this.workflow.model.set(id);
  }

  private labelInside(): void {
    const box = this.boxes.condition();
    if (!box || !this.labeller.labelled) {
      this.app.tell('Choose a box, and a log to label');
      return;
    }
    this.labeller.change({ box }, 'box');
  }

  private async showGallery(): Promise<void> {
    this.set = this.workflow.set.id;
    this.facts = await json<WorldFacts>(`world?file=${this.set}`);
    this.gallery.replaceChildren(
      ...this.facts.models.slice(0, 200).map((model, k) => {
        const picture = el('img', { src: `./api/thumbnail?file=${this.set}&model=${k}`, alt: '', loading: 'lazy', width: '56' });
        const tile = el('button', { type: 'button', draggable: 'true', title: `${model.name}: drag into the view, or click for the middle of it; Shift + click, then draw with the brush, scatters` }, picture, el('span', {}, model.name));
        tile.addEventListener('dragstart', (e) => e.dataTransfer?.setData('text/x-primitive', `${k}`));
        tile.addEventListener('click', (e) => (e.shiftKey ? this.beginScatter(k) : this.app.run(this.putInMiddle(k))));
        return tile;
      }),
    );
  }

  private putInMiddle(model: number): Promise<void> {
    return this.put(model, ...this.app.viewer.middle);
  }

  /** Puts a primitive on the ground at a place of the picture. */
  private async put(model: number, x: number, y: number, turn = 0, stroke = 0): Promise<void> {
    const at = this.app.viewer.groundUnder(x, y);
    if (!at) throw new Error('There is no ground there: show a model with a ground');
    await this.putAt(model, at, turn, stroke);
  }

  private async putAt(model: number, at: Vector3, turn: number, stroke: number): Promise<void> {
    const facts = this.facts!.models[model]!;
    const place = at.clone().add(this.app.files.origin!);
    await this.boxes.add(
      {
        class: facts.class!,
        position_m: [place.x, place.y, place.z].map((v) => Math.round(v * 1000) / 1000) as [number, number, number],
        yaw_rad: turn,
        min_m: facts.box_m!.min,
        max_m: facts.box_m!.max,
        primitive: { file: this.set, model },
      },
      stroke,
    );
  }

  private beginScatter(model: number): void {
    this.scattered = model;
    this.labeller.tools.take('brush');
    this.app.tell('Draw with the brush where the primitive shall stand; Escape ends');
  }

  /** Scatters the primitive along what the brush drew. Returns whether it did. */
  private scatter(drawn: Drawn): boolean {
    if (this.scattered < 0 || drawn.radius === 0) return false;
    const draw = () => crypto.getRandomValues(new Uint32Array(1))[0]! / 2 ** 32;
    const placed: Vector3[] = [];
    for (let k = 0; k + 1 < drawn.path.length; k += 2) {
      const [angle, r] = [2 * Math.PI * draw(), drawn.radius * Math.sqrt(draw())];
      const at = this.app.viewer.groundUnder(drawn.path[k]! + r * Math.cos(angle), drawn.path[k + 1]! + r * Math.sin(angle));
      if (at && placed.every((p) => p.distanceTo(at) >= this.spacing)) placed.push(at);
    }
    const model = this.scattered;
    const all = async () => {
      for (const at of placed) await this.putAt(model, at, 2 * Math.PI * draw(), drawn.stroke);
    };
    this.app.run(all());
    return true;
  }

  private async compose(): Promise<void> {
    const { document } = this.boxes;
    if (!document) throw new Error('Choose a model for boxes first');
    const annotation = this.jobs.freshName('placed', '.json');
    const ground = this.workflow.model.id;
    await post('labels/export', { file: document.file, format: 'annotation', name: annotation, ground });
    const name = this.jobs.freshName('scene');
    const scene = await this.jobs.runAndShow('compose', { annotation, primitives: this.workflow.set.id, nearest: 1, name });
    this.workflow.world.set(scene);
  }

  /** Writes the boxes of tracks; returns the name of the file. */
  private async writeTracks(): Promise<string> {
    const { document } = this.boxes;
    if (!document) throw new Error('Choose a log for boxes first');
    const name = this.jobs.freshName('tracks', '.csv');
    const reply = await post<{ path: string; boxes: number }>('labels/export', { file: document.file, format: 'tracks', name });
    this.app.tell(`Written: ${reply.path}, ${reply.boxes} boxes`);
    return name;
  }

  private async learnActors(): Promise<void> {
    const boxes = await this.writeTracks();
    await this.jobs.runAndShow('actors', { log: this.boxes.document!.file, boxes, name: this.jobs.freshName('actors') });
  }

  actions(): Action[] {
    const step = (back: boolean) => () => {
      const { document } = this.boxes;
      if (document) this.app.run(document.send(back ? 'undo' : 'redo', {}, false));
    };
    return [
      { key: '7', name: 'boxes: undo', act: step(true) },
      { key: '8', name: 'boxes: redo', act: step(false) },
      { key: '9', name: 'boxes: label the points inside', act: () => this.labelInside() },
    ];
  }
}
