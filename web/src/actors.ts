// What moves in a scene: a list, replay along the time bar, and edits that `simulate --actors` takes.
import { BufferGeometry, Group, Line, LineBasicMaterial, Quaternion, Vector3 } from 'three';
import { type Actor, type ActorEdit, type ActorPart, type EditList, json, MOST_EDIT_TEXT, post, query, type TimedPose } from './api';
import type { App } from './context';
import type { JobsPanel } from './jobs';
import type { Action } from './keys';
import type { Menu } from './menu';
import { button, check, el, facts, root, select } from './panel';
import { sideAt, viewWidth } from './sides';
import type { World } from './world';

/** How far from an actor (CSS pixels) a drag takes hold of it. */
const REACH_PX = 40;
const DRAGS = ['all of its path', 'its path for 1 s', 'its path for 3 s'] as const;
const WITHIN_S = { 'all of its path': null, 'its path for 1 s': 1, 'its path for 3 s': 3 };

/** JSON without spaces; text that is none stays what it is, unless it is empty. */
function shortest(text: string): string {
  try {
    return JSON.stringify(JSON.parse(text));
  } catch {
    return text || 'null';
  }
}

interface Placed {
  at: Vector3;
  turn: Quaternion;
}

function placed(pose: TimedPose): Placed {
  const [, x, y, z, qw, qx, qy, qz] = pose;
  return { at: new Vector3(x, y, z), turn: new Quaternion(qx, qy, qz, qw) };
}

/** Where a part is at a time (s): before its first pose and after its last it stands still. */
function poseAt({ poses }: ActorPart, time: number): Placed {
  const k = poses.findIndex((pose) => pose[0] > time);
  if (k <= 0) return placed(k < 0 ? poses.at(-1)! : poses[0]!);
  const [before, after] = [poses[k - 1]!, poses[k]!];
  const share = (time - before[0]) / (after[0] - before[0]);
  const [a, b] = [placed(before), placed(after)];
  return { at: a.at.lerp(b.at, share), turn: a.turn.slerp(b.turn, share) };
}

/** The times from the first to the last pose of an actor, s. */
function timesOf(actor: Actor): [number, number] {
  const poses = actor.parts.flatMap((part) => part.poses);
  const first = Math.max(Math.min(...actor.parts.map((part) => part.from_s ?? -Infinity)), Math.min(...poses.map((p) => p[0])));
  const last = Math.min(Math.max(...actor.parts.map((part) => part.to_s ?? Infinity)), Math.max(...poses.map((p) => p[0])));
  return [first, last];
}

export class Actors {
  private world: World | null = null;
  private editable = false;
  private actors: Actor[] = [];
  private edits: EditList = { actors: '', edits: [] };
  /** The edits that a file holds, as text. */
  private filed = '[]';
  private undone: ActorEdit[] = [];
  private chosen = '';
  private readonly list = el('select', { 'aria-label': 'Actors', size: '5' });
  private readonly seconds = el('input', { type: 'number', value: '0.5', step: '0.1', 'aria-label': 'Delay, s' });
  private readonly facts = el('div', { 'aria-label': 'Facts of the actor', role: 'group' });
  private readonly told = el('p', { class: 'note', 'aria-label': 'Edits' });
  private readonly paths = new Group();
  private readonly dragBox;
  private within: (typeof DRAGS)[number] = DRAGS[0];
  private drag: { name: string; pointer: number; from: Vector3; by: Vector3 } | null = null;
  private readonly section: HTMLElement;
  private queue: Promise<unknown> = Promise.resolve();

  constructor(
    private readonly app: App,
    private readonly menu: Menu,
    private readonly jobs: JobsPanel | null,
    /** Runs a simulation with the edits of a file of the folder for labels. */
    private readonly simulate: ((edits: string) => Promise<void>) | null,
  ) {
    this.list.addEventListener('change', () => this.choose(this.list.value));
    this.dragBox = check('Drag actors in the view', false, () => this.show());
    const drags = select('A drag moves', DRAGS, this.within, (v) => (this.within = v));
    const edit = (text: string, title: string, act: () => void) => button(text, title, act);
    this.section = app.section(
      'Actors',
      this.list,
      this.facts,
      el(
        'div',
        { class: 'buttons' },
        edit('Remove', 'Take the actor away', () => this.add({ edit: 'remove', actor: this.chosen })),
        edit('Turn round', 'Turn the actor by half a turn where it is', () => this.add({ edit: 'move', actor: this.chosen, yaw_rad: Math.PI })),
        edit('Copy', 'Add the same actor once more', () => this.copy()),
        edit('Delay', 'Let the actor do everything so many seconds later', () =>
          this.add({ edit: 'delay', actor: this.chosen, by_s: Number(this.seconds.value) }),
        ),
        edit('Undo', 'Take the last edit of an actor back (,)', () => this.undo()),
        edit('Redo', 'Apply it again (.)', () => this.redo()),
      ),
      el('label', { class: 'row number' }, 'Delay, s', this.seconds),
      this.dragBox.row,
      drags.row,
      this.told,
    );
    const file = el('input', { type: 'file', accept: '.json', hidden: '', 'aria-label': 'File of edits' });
    file.addEventListener('change', () => {
      if (file.files?.[0]) app.run(this.openList(file.files[0]));
      file.value = '';
    });
    this.section.append(file, el('div', { class: 'buttons' }, button('Open edits', 'Open a file of edits; it can be dropped on the page, too', () => file.click())));
    window.addEventListener('dragover', (e) => e.preventDefault());
    window.addEventListener('drop', (e) => {
      e.preventDefault();
      const dropped = e.dataTransfer?.files[0];
      if (dropped) app.run(this.openList(dropped));
    });
    if (jobs) {
      this.section.append(
        el(
          'div',
          { class: 'buttons' },
          button('Write edits', 'Write the edits to the folder for labels, for simulate --actors', () => app.run(this.write())),
          button('Replay', 'Simulate the beams of the chosen log in the chosen world with these actors', () => app.run(this.replay())),
        ),
      );
    }
    app.viewer.overlays.add(this.paths);
    menu.time.onTime.push(() => this.place());
    menu.movingTimes = () => this.times();
    app.onApply.push(() => app.run(this.open()));
    const { canvas } = app.viewer;
    // Before the camera's listeners, which a drag of an actor must not reach.
    canvas.addEventListener('pointerdown', (e) => this.down(e), { capture: true });
    canvas.addEventListener('pointermove', (e) => this.move(e), { capture: true });
    canvas.addEventListener('pointerup', (e) => this.up(e), { capture: true });
    this.show();
  }

  /** Takes the first scene that is shown and in which something moves. */
  private async open(): Promise<void> {
    const world = [...this.app.viewer.worlds].find((w) => w.group.visible && w.moves) ?? null;
    if (world === this.world) return;
    this.world = world;
    [this.edits, this.undone, this.actors, this.filed] = [{ actors: '', edits: [] }, [], [], '[]'];
    const { edits } = this.app.state;
    const kept = edits && edits.file === world?.file.id ? JSON.stringify(edits.list) : '';
    // The actors may be others than those of the link.
    if (world) await this.fetch(kept).catch((error: unknown) => (this.app.fail(error), this.fetch('')));
    if (world) {
      for (const pose of this.actors.flatMap((a) => a.parts.flatMap((part) => part.poses))) {
        world.bounds.expandByPoint(placed(pose).at.add(world.group.position));
      }
      if (this.app.viewer.navigation.framed) this.app.frame();
    }
    this.menu.limits();
    this.show();
  }

  /** Asks the server what moves with a list of edits, which is that of a file if it has a name. */
  private async fetch(edits: string, name = ''): Promise<void> {
    const world = this.world!;
    if (encodeURIComponent(edits).length > MOST_EDIT_TEXT) throw new Error(`${name || 'edits'}: more edits than a request has room for`);
    const reply = await json<{ editable: boolean; list: EditList; actors: Actor[] }>(`actors?${query({ file: world.file.id, edits, name })}`);
    if (world !== this.world) return;
    ({ actors: this.actors, editable: this.editable, list: this.edits } = reply);
    const begun = this.app.list.edits?.file === world.file.id;
    this.app.state.edits = begun || this.edits.edits.length > 0 ? { file: world.file.id, list: this.edits } : null;
  }

  /** The edits as text. */
  private text(): string {
    return JSON.stringify(this.edits.edits);
  }

  /** Opens a file of edits in place of the edits so far. */
  private async openList(file: File): Promise<void> {
    await this.queue;
    if (!this.world || !this.editable) throw new Error('Show a folder of actors, in which all moves, first');
    if (![this.filed, '[]'].includes(this.text()) && !confirm('The edits so far were not written. Open others in their place?')) return;
    await this.fetch(shortest(await file.text()), file.name);
    this.undone = [];
    this.filed = this.text();
    this.show();
    this.app.tell(`Opened: ${file.name}, edits of ${this.edits.actors}`);
  }

  /** Changes the list of edits once all changes before are done; `next` returns null for no change. */
  private change(next: () => ActorEdit[] | null): void {
    const work = this.queue.then(async () => {
      const edits = next();
      if (edits && this.world) await this.fetch(JSON.stringify({ ...this.edits, edits }));
    });
    this.queue = work.catch(() => {});
    this.app.run(work.finally(() => this.show()));
  }

  private add(edit: ActorEdit): void {
    if (!this.editable) return this.app.tell('Only a folder of actors, in which all moves, can be edited');
    if (this.chosen === '') return this.app.tell('Choose an actor first');
    this.change(() => {
      this.undone = [];
      return [...this.edits.edits, edit];
    });
  }

  private copy(): void {
    const names = new Set(this.actors.map((a) => a.name));
    let k = 2;
    while (names.has(`${this.chosen}-copy-${k}`)) ++k;
    const as = `${this.chosen}-copy-${k}`;
    this.add({ edit: 'copy', actor: this.chosen, as });
    void this.queue.then(() => this.choose(as));
  }

  private undo(): void {
    this.change(() => {
      const last = this.edits.edits.at(-1);
      if (last) this.undone.push(last);
      return last ? this.edits.edits.slice(0, -1) : null;
    });
  }

  private redo(): void {
    this.change(() => {
      const next = this.undone.pop();
      return next ? [...this.edits.edits, next] : null;
    });
  }

  private async write(): Promise<string> {
    if (!this.world) throw new Error('Show a folder of actors first');
    await this.queue;
    const name = this.jobs!.freshName('edits', '.json');
    const reply = await post<{ path: string }>('actors/write', { file: this.world.file.id, name, edits: JSON.stringify(this.edits) });
    this.filed = this.text();
    this.app.tell(`Written: ${reply.path}`);
    return name;
  }

  private async replay(): Promise<void> {
    if (this.simulate) await this.simulate(await this.write());
  }

  private choose(name: string): void {
    this.chosen = name;
    this.show();
  }

  private times(): [number, number] | null {
    if (this.actors.length === 0) return null;
    const all = this.actors.map(timesOf);
    return [Math.min(...all.map((t) => t[0])), Math.max(...all.map((t) => t[1]))];
  }

  /** The times that are shown, in the log's time. */
  private shownTimes(): [number, number] {
    const [from, to] = this.menu.time.shown();
    return [this.menu.time.first + from, this.menu.time.first + to];
  }

  /** The parts of an actor at the time that is shown: the one of that time, else what was there in the times before it. */
  private now(actor: Actor): ActorPart | null {
    const [from, to] = this.shownTimes();
    const there = actor.parts.filter((part) => (part.from_s ?? -Infinity) <= to && (part.to_s ?? Infinity) > from);
    return there.at(-1) ?? null;
  }

  /** Where an actor is drawn now, relative to the world. */
  private placeOf(actor: Actor): (Placed & { instance: number }) | null {
    const part = this.now(actor);
    if (!part) return null;
    const time = Math.min(this.shownTimes()[1], part.to_s ?? Infinity);
    const out = poseAt(part, time);
    if (this.drag?.name === actor.name) out.at.add(this.drag.by);
    return { ...out, instance: part.instance };
  }

  /** Moves what moves to the time that is shown. */
  private place(): void {
    if (!this.world) return;
    const places = this.actors.map((actor) => ({ actor, place: this.placeOf(actor) }));
    this.world.moveTo(places.flatMap(({ place }) => (place ? [place] : [])));
    const origin = new Vector3(...this.world.facts.origin_m);
    const told = (at: Vector3) => [...at.clone().add(origin).toArray(), ...this.pixelOf(at)].map((v) => v.toFixed(3)).join(' ');
    root.dataset.actorsAt = places.map(({ actor, place }) => `${actor.name} ${place ? told(place.at) : 'absent'}`).join('; ');
    this.app.viewer.draw();
  }

  /** Shows the list, the paths, and everything in its place. */
  private show(): void {
    this.section.hidden = !this.world;
    if (!this.actors.some((a) => a.name === this.chosen)) this.chosen = this.actors[0]?.name ?? '';
    const seconds = (a: Actor) => (timesOf(a)[1] - timesOf(a)[0]).toFixed(1);
    this.list.replaceChildren(...this.actors.map((a) => el('option', { value: a.name }, `${a.name}: ${a.class}, ${seconds(a)} s`)));
    this.list.value = this.chosen;
    const actor = this.actors.find((a) => a.name === this.chosen);
    const number = (n: number | null) => (n === null ? 'unknown' : `${n}`);
    this.facts.replaceChildren(
      ...(actor ? [facts([['returns', number(actor.returns)], ['scans', number(actor.scans)], ['there for, s', seconds(actor)]])] : []),
    );
    this.told.textContent = `${this.edits.edits.length} edits${this.undone.length > 0 ? `, ${this.undone.length} taken back` : ''}`;
    root.dataset.actors = `${this.actors.length}`;
    root.dataset.edits = `${this.edits.edits.length}`;
    this.paths.clear();
    this.paths.visible = this.world !== null; // where it is empty, the picture needs no depth
    if (this.world) {
      this.paths.position.copy(this.world.group.position);
      for (const actor of this.actors) this.paths.add(this.pathOf(actor));
      this.place();
    }
    this.app.viewer.draw();
  }

  private pathOf(actor: Actor): Line {
    const poses = actor.parts.flatMap((part) => part.poses).sort((a, b) => a[0] - b[0]);
    const points = poses.map((pose) => placed(pose).at);
    const look = new LineBasicMaterial({ color: actor.name === this.chosen ? 0xf0e442 : 0x56b4e9, depthTest: false });
    const line = new Line(new BufferGeometry().setFromPoints(points), look);
    line.frustumCulled = false;
    line.renderOrder = 9;
    return line;
  }

  // --- dragging ----------------------------------------------------------------------------------

  /** The pixel of a place of the world, in the picture that the camera makes; none behind the camera. */
  private pixelOf(at: Vector3): [number, number] {
    const { camera, canvas, sides } = this.app.viewer;
    const seen = at.clone().add(this.world!.group.position).project(camera);
    if (seen.z >= 1) return [Infinity, Infinity];
    return [((seen.x + 1) / 2) * viewWidth(sides, canvas.clientWidth), ((1 - seen.y) / 2) * canvas.clientHeight];
  }

  /** The actor next to a place of the canvas, where it is near enough, and its height in the scene's frame. */
  private near(x: number, y: number): { name: string; height: number } | null {
    const { canvas, sides } = this.app.viewer;
    const across = sideAt(sides, canvas.clientWidth, x).x;
    let best = null;
    let least = REACH_PX;
    for (const actor of this.actors) {
      const place = this.placeOf(actor);
      if (!place) continue;
      const [px, py] = this.pixelOf(place.at);
      const off = Math.hypot(px - across, py - y);
      if (off < least) [best, least] = [{ name: actor.name, height: place.at.z + this.world!.group.position.z }, off];
    }
    return best;
  }

  private down(e: PointerEvent): void {
    if (!this.dragBox.on() || !this.world || !this.editable || e.button !== 0) return;
    const found = this.near(e.offsetX, e.offsetY);
    const from = found && this.app.viewer.placeUnder(e.offsetX, e.offsetY, found.height);
    if (!found || !from) return;
    e.stopImmediatePropagation();
    this.app.viewer.canvas.setPointerCapture(e.pointerId);
    this.choose(found.name);
    this.drag = { name: found.name, pointer: e.pointerId, from, by: new Vector3() };
  }

  private move(e: PointerEvent): void {
    if (!this.drag || e.pointerId !== this.drag.pointer) return;
    e.stopImmediatePropagation();
    const to = this.app.viewer.placeUnder(e.offsetX, e.offsetY, this.drag.from.z);
    if (to) this.drag.by = to.sub(this.drag.from);
    this.place();
  }

  private up(e: PointerEvent): void {
    if (!this.drag || e.pointerId !== this.drag.pointer) return;
    e.stopImmediatePropagation();
    const { name, by } = this.drag;
    this.drag = null;
    const translation = by.toArray().map((v) => Math.round(v * 1000) / 1000) as [number, number, number];
    if (Math.hypot(...translation) < 0.01) return this.place();
    const within = WITHIN_S[this.within];
    const time = Math.round(this.shownTimes()[1] * 1e6) / 1e6;
    this.add({ edit: 'shift', actor: name, translation_m: translation, ...(within === null ? {} : { at_s: time, within_s: within }) });
  }

  actions(): Action[] {
    return [
      { key: ',', name: 'actors: undo', act: () => this.undo() },
      { key: '.', name: 'actors: redo', act: () => this.redo() },
    ];
  }
}
