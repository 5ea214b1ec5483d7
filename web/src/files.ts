// The files on the page: which are shown, and loading them.
import { type LineSegments, Vector3 } from 'three';
import { json, type ServedFile, type WorldFacts } from './api';
import { disposeAll, loadBeams } from './beams';
import { Cloud } from './cloud';
import { openOctree, openPreview } from './octree';
import type { Viewer } from './viewer';
import { World } from './world';

const NO_TARGET = 0xfffffffe;
const MOST_WAIT_MS = 1000;

/** Waits until the page has drawn what it holds now; a page that is hidden draws nothing, and does not wait for long. */
function nextPicture(): Promise<void> {
  return new Promise((resolve) => {
    requestAnimationFrame(() => requestAnimationFrame(() => resolve()));
    setTimeout(resolve, MOST_WAIT_MS);
  });
}

export class Files {
  readonly clouds = new Map<number, Cloud>();
  readonly worlds = new Map<number, World>();
  /** The world coordinates of the scene's origin; set by the first file that is shown. */
  origin: Vector3 | null = null;
  private readonly opening = new Map<number, Promise<void>>();
  private beams: LineSegments | null = null;
  /** Samples of logs whose octrees are not there yet. */
  private readonly previews = new Map<number, Cloud>();
  /** Called when a sample of a log is shown. */
  onPreview: () => void = () => {};

  constructor(
    readonly list: ServedFile[],
    private readonly viewer: Viewer,
    /** Tells how far a file is read, in place of a message that begins with `own`. */
    private readonly tell: (text: string, own: string) => void,
  ) {}

  file(id: number): ServedFile {
    return this.list[id]!;
  }

  /** Shows or hides a file; the first time it is loaded. */
  async show(id: number, on: boolean): Promise<void> {
    if (on && !this.opening.has(id)) {
      this.opening.set(id, this.open(this.file(id)));
      this.opening.get(id)!.catch(() => this.opening.delete(id));
      this.viewer.draw(); // which tells that something is loading
    }
    if (on) await this.opening.get(id);
    const group = this.clouds.get(id)?.group ?? this.worlds.get(id)?.group;
    if (group) group.visible = on;
    this.arrange();
    this.viewer.draw();
  }

  /** Primitives, which have no places of their own in the world, stand beside everything else that is shown. */
  private arrange(): void {
    const sets = [...this.worlds.values()].filter((world) => world.file.kind === 'primitives');
    const hidden = sets.filter((set) => set.group.visible);
    hidden.forEach((set) => (set.group.visible = false));
    const others = this.viewer.isEmpty ? null : this.viewer.bounds();
    hidden.forEach((set) => (set.group.visible = true));
    sets.forEach((set) => set.standBeside(others));
  }

  get loading(): boolean {
    if (this.previews.size > 0) return true;
    return [...this.opening.keys()].some((id) => !this.clouds.has(id) && !this.worlds.has(id));
  }

  private async open(file: ServedFile): Promise<void> {
    const own = `${file.name}: `;
    const tell = (done: number) => this.tell(`${own}${Math.round(100 * done)} %`, own);
    this.tell(own, '');
    if (file.kind === 'log') {
      const octree = await openOctree(file.id, tell, () => this.preview(file));
      this.origin ??= new Vector3(...octree.facts.origin_m);
      const pick = this.viewer.target({ kind: 'beam', file: file.id }); // replaced below
      const cloud = new Cloud(octree, this.viewer.display, this.origin, pick, () => this.viewer.drawSoon());
      await cloud.start();
      this.viewer.replaceTarget(pick, { kind: 'point', cloud });
      this.clouds.set(file.id, cloud);
      this.viewer.addCloud(cloud);
      this.endPreview(file.id, cloud);
    } else {
      const facts = await json<WorldFacts>(`world?file=${file.id}`);
      this.origin ??= new Vector3(...facts.origin_m);
      const world = await World.open(
        file,
        this.viewer.display,
        this.origin,
        (target) => this.viewer.target({ kind: 'world', ...target }),
        tell,
      );
      this.worlds.set(file.id, world);
      this.viewer.addWorld(world);
    }
    this.tell('', own);
  }

  /** Shows a sample of a log, which its octree will replace. */
  private async preview(file: ServedFile): Promise<void> {
    const octree = await openPreview(file.id);
    if (!octree || this.clouds.has(file.id)) return;
    this.origin ??= new Vector3(...octree.facts.origin_m);
    const cloud = new Cloud(octree, this.viewer.display, this.origin, NO_TARGET, () => this.viewer.drawSoon());
    await cloud.start();
    if (this.clouds.has(file.id)) return;
    this.previews.set(file.id, cloud);
    this.viewer.addCloud(cloud);
    this.onPreview();
    await nextPicture();
  }

  /** Takes the sample away once the log's own points are there. */
  private endPreview(id: number, cloud: Cloud): void {
    const preview = this.previews.get(id);
    if (!preview) return;
    if (cloud.group.visible && cloud.loading && cloud.drawnPoints < preview.drawnPoints) {
      setTimeout(() => this.endPreview(id, cloud), 50);
      return;
    }
    this.previews.delete(id);
    this.viewer.removeCloud(preview);
  }

  /** Shows the beams of a run of a log, or none. */
  async showBeams(file: number, run: number | null): Promise<string> {
    if (this.beams) {
      this.viewer.remove(this.beams);
      disposeAll(this.beams);
      this.beams = null;
    }
    const cloud = this.clouds.get(file);
    if (run === null || !cloud) return '';
    const pick = this.viewer.target({ kind: 'beam', file });
    const { lines, beams, step } = await loadBeams(file, run, this.viewer.display, cloud.group.position, pick);
    this.beams = lines;
    this.viewer.add(lines);
    return step > 1 ? `${beams} beams, each ${step}th` : `${beams} beams`;
  }
}

