// Oriented boxes: annotations of a log, or plants that are placed on a model's ground.
import { Box3, Box3Helper, Color, Group, Vector3 } from 'three';
import { BoxViews, type SceneBox } from './box-views';
import type { App } from './context';
import { type LabelBox, Labelled } from './labelled';
import type { Octree } from './octree';
import { button, el, root } from './panel';
import type { TimeBar } from './time';

type NewBox = Omit<LabelBox, 'number'>;

const OBJECT_CLASS = /shrub|tree/;
/** Classes of what moves, and so of tracks. */
const MOVING = ['car', 'van', 'truck', 'cyclist', 'pedestrian', 'other'];

/** The boxes of one file, and the one that is chosen. */
export class Boxes {
  document: Labelled | null = null;
  chosen = 0;
  private readonly group = new Group();
  private readonly views: BoxViews;
  private readonly list = el('select', { 'aria-label': 'Boxes', size: '4' });
  private readonly classes = el('select');
  private readonly numbers: HTMLInputElement[] = [];
  readonly element: HTMLElement;

  constructor(
    private readonly app: App,
    private readonly time: TimeBar,
  ) {
    this.views = new BoxViews(app.viewer, (box, done) => this.dragged(box, done));
    app.viewer.add(this.group);
    this.list.addEventListener('change', () => this.goTo(Number(this.list.value)));
    time.onTime.push(() => this.draw(this.boxes));
    this.classes.addEventListener('change', () => this.alter((box) => (box.class = this.classes.value)));
    const fields = ['x', 'y', 'z', 'turn, °', 'long', 'wide', 'high'].map((name, k) => {
      const field = el('input', { type: 'number', step: k === 3 ? '5' : '0.1' });
      field.addEventListener('change', () => this.typed());
      this.numbers.push(field);
      return el('label', { class: 'row number' }, name, field);
    });
    this.element = el('div', {}, this.list, el('label', { class: 'row' }, 'Class', this.classes), ...fields, this.buttons());
  }

  private buttons(): HTMLElement {
    return el(
      'div',
      { class: 'buttons' },
      button('New box', 'A box at the target of the camera', () => this.app.run(this.addHere())),
      button('Turn', 'Turn by 15°', () => this.alter((box) => (box.yaw_rad += Math.PI / 12))),
      button('To the ground', 'Drop the box to the ground', () => this.alter((box) => this.drop(box))),
      button('Copy', 'Copy the box beside itself', () => this.app.run(this.copy())),
      button('Delete', 'Delete the box', () => this.app.run(this.remove())),
      button('Track', 'Make the box the first one of something that moves, in the scan that is shown', () => this.beginTrack()),
      button('Scan before', 'The box of the track in the scan before, carried there if it has none', () => this.app.run(this.carry(-1))),
      button('Next scan', 'The box of the track in the next scan, carried there if it has none', () => this.app.run(this.carry(1))),
    );
  }

  /** Shows the boxes of a file: a log or a model. */
  async open(file: number | null, shared: Labelled | null): Promise<void> {
    this.document = file === null ? null : (shared ?? new Labelled(file, null, () => this.show()));
    if (this.document && !this.document.state) await this.document.open();
    this.show();
  }

  get boxes(): LabelBox[] {
    return this.document?.state?.boxes ?? [];
  }

  private origin(): Vector3 {
    return this.app.files.origin ?? new Vector3();
  }

  choose(number: number): void {
    this.chosen = number;
    this.show();
  }

  private current(): LabelBox | undefined {
    return this.boxes.find((box) => box.number === this.chosen);
  }

  /** Adds a box and chooses it. */
  async add(box: NewBox, stroke = 0): Promise<void> {
    if (!this.document) throw new Error('Choose a model or a log for boxes first');
    const reply = await this.document.send<{ number: number }>('box', { value: JSON.stringify(box), stroke }, true);
    this.choose(reply.number);
  }

  private addHere(): Promise<void> {
    const at = this.app.viewer.navigation.target.clone().add(this.origin());
    const box: NewBox = { class: 'medium_tree', position_m: [at.x, at.y, at.z], yaw_rad: 0, min_m: [-1, -1, 0], max_m: [1, 1, 3] };
    this.drop(box);
    return this.add(box);
  }

  private async copy(): Promise<void> {
    const box = this.current();
    if (!box) return;
    const { number: _, ...copy } = structuredClone(box);
    copy.position_m[0] += box.max_m[0] - box.min_m[0] + 0.5;
    this.drop(copy);
    await this.add(copy);
  }

  /** The log of the boxes; null for a model. */
  private get octree(): Octree | null {
    return this.document?.cloud?.octree ?? null;
  }

  /** Chooses a box, and shows the scan of one that has a scan. */
  private goTo(number: number): void {
    this.choose(number);
    const box = this.current();
    if (box?.scan !== undefined && this.octree) this.time.showScan(this.octree, box.scan);
  }

  private beginTrack(): void {
    const { octree } = this;
    if (!octree) return this.app.tell('Tracks are of a log: choose one for boxes');
    this.alter((box) => {
      if (box.track !== undefined) return;
      box.track = 1 + Math.max(0, ...this.boxes.map((b) => b.track ?? 0));
      box.scan = this.time.scanShown(octree);
      if (!MOVING.includes(box.class)) box.class = 'car';
      this.time.showScan(octree, box.scan);
    });
  }

  /** Goes to the box of the same track in the scan before or after; where there is none, the motion goes on evenly. */
  private async carry(by: 1 | -1): Promise<void> {
    const box = this.current();
    if (!box || box.track === undefined || !this.octree) throw new Error('Choose a box of a track first');
    const scans = [...new Set(this.octree.runs.map((run) => run.scan))];
    const k = scans.indexOf(box.scan!);
    const scan = scans[k + by];
    if (scan === undefined) throw new Error('There is no such scan');
    const of = (wanted: number | undefined) => this.boxes.find((b) => b.track === box.track && b.scan === wanted);
    const there = of(scan);
    if (there) return this.goTo(there.number);
    const { number: _, ...next } = structuredClone(box);
    const last = of(scans[k - by]);
    if (last) {
      next.position_m = next.position_m.map((v, c) => Math.round((2 * v - last.position_m[c as 0]!) * 1000) / 1000) as [number, number, number];
      const turn = box.yaw_rad - last.yaw_rad;
      next.yaw_rad += Math.atan2(Math.sin(turn), Math.cos(turn));
    }
    await this.add({ ...next, scan });
    this.time.showScan(this.octree, scan);
  }

  private async remove(): Promise<void> {
    if (this.chosen) await this.document?.send('box', { number: this.chosen }, true);
  }

  /** Puts the foot of a box on the ground of the models that are shown, where there is one. */
  drop(box: NewBox): void {
    const at = new Vector3(...box.position_m).sub(this.origin());
    const ground = this.app.viewer.groundAt(at.x, at.y);
    if (ground !== null) box.position_m[2] = ground + this.origin().z;
  }

  private alter(change: (box: LabelBox) => void): void {
    const old = this.current();
    if (!old || !this.document) return;
    const box = structuredClone(old);
    change(box);
    const { number, ...value } = box;
    this.app.run(this.document.send('box', { number, value: JSON.stringify(value) }, true));
  }

  private typed(): void {
    const [x, y, z, turn, long, wide, high] = this.numbers.map((n) => Number(n.value));
    this.alter((box) => {
      box.position_m = [x!, y!, z!];
      box.yaw_rad = (turn! * Math.PI) / 180;
      const size = [long!, wide!, high!];
      for (const k of [0, 1, 2] as const) {
        const old = box.max_m[k] - box.min_m[k];
        if (Math.abs(old - size[k]!) < 1e-3) continue;
        if (k < 2) box.min_m[k] -= (size[k]! - old) / 2;
        box.max_m[k] = box.min_m[k] + size[k]!;
      }
    });
  }

  private sceneBox(box: LabelBox): SceneBox {
    return {
      position: new Vector3(...box.position_m).sub(this.origin()),
      yaw: box.yaw_rad,
      min: new Vector3(...box.min_m),
      max: new Vector3(...box.max_m),
    };
  }

  private dragged(scene: SceneBox, done: boolean): void {
    const box = this.current();
    if (!box) return;
    const round = (v: Vector3) => v.toArray().map((c) => Math.round(c * 1000) / 1000) as [number, number, number];
    const next = {
      ...box,
      position_m: round(scene.position.clone().add(this.origin())),
      yaw_rad: Math.round(scene.yaw * 1e5) / 1e5,
      min_m: round(scene.min),
      max_m: round(scene.max),
    };
    if (done) this.alter((b) => Object.assign(b, next));
    else this.draw(this.boxes.map((b) => (b.number === box.number ? next : b)));
  }

  private draw(boxes: LabelBox[]): void {
    this.group.children.slice().forEach((child) => child.removeFromParent());
    const shown = this.octree && this.time.scanShown(this.octree);
    for (const box of boxes) {
      if (box.scan !== undefined && box.scan !== shown) continue;
      const scene = this.sceneBox(box);
      const frame = new Group();
      frame.position.copy(scene.position);
      frame.rotation.z = scene.yaw;
      frame.add(new Box3Helper(new Box3(scene.min, scene.max), new Color(box.number === this.chosen ? 0xf0e442 : 0x56b4e9)));
      this.group.add(frame);
    }
    this.app.viewer.draw();
  }

  /** Shows the present state. */
  show(): void {
    const { boxes } = this;
    if (!this.current()) this.chosen = boxes.at(-1)?.number ?? 0;
    const moves = this.current()?.track !== undefined;
    const plants = (this.document?.state?.classes ?? []).map((c) => c.name).filter((n) => OBJECT_CLASS.test(n));
    const names = moves ? MOVING : plants;
    if (this.classes.dataset.names !== names.join()) {
      this.classes.dataset.names = names.join();
      this.classes.replaceChildren(...names.map((n) => el('option', { value: n }, n)));
    }
    const track = (b: LabelBox) => (b.track === undefined ? '' : `, track ${b.track} in scan ${b.scan}`);
    this.list.replaceChildren(...boxes.map((b) => el('option', { value: `${b.number}` }, `${b.number} ${b.class}${track(b)}`)));
    this.list.value = `${this.chosen}`;
    const box = this.current();
    if (box) {
      this.classes.value = box.class;
      const size = [0, 1, 2].map((k) => box.max_m[k as 0]! - box.min_m[k as 0]!);
      [...box.position_m, (box.yaw_rad * 180) / Math.PI, ...size].forEach((v, k) => (this.numbers[k]!.value = `${Math.round(v * 1000) / 1000}`));
    }
    this.views.show(box ? this.sceneBox(box) : null);
    root.dataset.boxes = `${boxes.length}`;
    this.draw(boxes);
  }

  /** The chosen box as a condition on points: centre, size and heading, in world coordinates. */
  condition(): number[] | null {
    const box = this.current();
    if (!box) return null;
    const scene = this.sceneBox(box);
    const middle = scene.min.clone().add(scene.max).multiplyScalar(0.5);
    middle.applyAxisAngle(new Vector3(0, 0, 1), scene.yaw).add(scene.position).add(this.origin());
    return [...middle.toArray(), ...scene.max.clone().sub(scene.min).toArray(), scene.yaw];
  }
}
