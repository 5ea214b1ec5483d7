// The points of a log: the nodes of its octree that are in view, up to a budget of points.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Frustum,
  Group,
  Matrix4,
  type PerspectiveCamera,
  Points as DrawnPoints,
  type ShaderMaterial,
  Vector2,
  Vector3,
} from 'three';
import { bytes } from './api';
import type { MapName } from './colours';
import { type Display, material, type PointMode, POINTS } from './display';
import { loadPoints, type Node, type Octree, type Points } from './octree';
import { type Extra, type Paint, paintPoints } from './point-colours';
import { type Batch, SQUARE_PIXELS } from './splat';
import { coreOf, shares } from './unpack';

const MOST_REQUESTS = 8;
const CELLS = 64;

interface Loaded extends Extra {
  points: Points;
  drawn: DrawnPoints;
  used: number;
  colours: Uint32Array;
  /** Which way of colouring `colours` follows. */
  painted: number;
}

/** Where the labels of points that people edit come from. */
export interface Marks {
  /** The classes that occur, by the numbers of the labels. */
  classes(): { number: number; name: string }[];
  /** The labels of these nodes are needed; `Cloud.setMarks` brings them. */
  need(nodes: Node[]): void;
}

const VERTEX = /* glsl */ `
  attribute vec4 colour;
  attribute float time;
  attribute vec4 rowBytes;
  uniform float size;
  uniform vec2 range;
  varying vec3 place;
  varying vec4 part;
  varying vec4 shown;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    part = rowBytes;
    shown = colour;
    gl_Position = projectionMatrix * viewMatrix * world;
    if (time < range.x || time > range.y || colour.a < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size;
  }
`;

const FRAGMENT = /* glsl */ `
  uniform float size;
  varying vec3 place;
  varying vec4 part;
  varying vec4 shown;
  void main() {
    if (sliced(place)) discard;
    vec2 off = gl_PointCoord - 0.5;
    if (size > ${SQUARE_PIXELS} && dot(off, off) > 0.25) discard;
    gl_FragColor = pass == 0 ? vec4(shown.rgb, 1.0) : pass == 1 ? bytesOf(object) : part;
  }
`;

export class Cloud {
  readonly group = new Group();
  readonly pick: number;
  /** Where most points lie, in the scene's frame: all but the outermost 2 % along each axis. */
  readonly core = new Box3();
  /** Points of the nodes that are drawn, and whether nodes in view are still on their way. */
  drawnPoints = 0;
  loading = false;

  private readonly loaded = new Map<Node, Loaded>();
  private readonly waiting = new Set<Node>();
  /** Nodes to load next, the largest on the screen first. */
  private wanted: Node[] = [];
  private readonly look: ShaderMaterial;
  private frame = 0;
  private failed = '';
  private marks: Marks | null = null;
  private other: number | null = null;
  private readonly paint: Paint;
  /** Counts the ways of colouring. */
  private way = 0;

  constructor(
    readonly octree: Octree,
    display: Display,
    readonly origin: Vector3,
    pick: number,
    private readonly changed: () => void,
  ) {
    this.pick = pick;
    const facts = octree.facts;
    const span = facts.last_time_s - facts.first_time_s;
    const own = { size: { value: 2 }, range: { value: new Vector2(-1, span + 1) }, object: { value: pick } };
    this.look = material(display, own, VERTEX, FRAGMENT);
    this.paint = {
      mode: 'height',
      map: 'viridis',
      heights: [0, 1],
      intensities: [...facts.intensity],
      span,
      rings: facts.most_ring,
      file: octree.file,
      hidden: new Set(),
    };
    const [x, y, z] = facts.origin_m;
    this.group.position.set(x - origin.x, y - origin.y, z - origin.z);
  }

  get error(): string {
    return this.failed;
  }

  /** How the points are coloured, for a legend. */
  get painted(): Readonly<Paint> {
    return this.paint;
  }

  /** Colours the points by a quantity; `heights` are those of the ends of the map, in the scene's frame. */
  setPaint(mode: PointMode, map: MapName, heights: [number, number]): void {
    const { paint } = this;
    if (paint.mode === mode && paint.map === map && paint.heights.every((v, k) => v === heights[k])) return;
    Object.assign(paint, { mode, map, heights: [...heights] });
    ++this.way;
  }

  /** Diameter of a point in pixels. */
  get size(): number {
    return this.look.uniforms.size!.value as number;
  }

  setSize(pixels: number): void {
    this.look.uniforms.size!.value = pixels;
  }

  /** Shows the times [from, to] only, in seconds since the first beam. */
  setTimes(from: number, to: number): void {
    (this.look.uniforms.range!.value as Vector2).set(from, to);
  }

  /** The times that are shown; null for all. */
  get times(): [number, number] | null {
    const { x, y } = this.look.uniforms.range!.value as Vector2;
    return x <= 0 && y >= this.paint.span ? null : [x, y];
  }

  /** Shows labels that people edit instead of the log's own, or no longer. */
  setMarksFrom(marks: Marks | null): void {
    this.marks = marks;
    for (const loaded of this.loaded.values()) loaded.marks = marks ? new Uint8Array(4 * loaded.points.count) : null;
    ++this.way;
    marks?.need([...this.loaded.keys()]);
  }

  /** The classes of the labels that people edit; null where nobody does. */
  get marked(): { number: number; name: string }[] | null {
    return this.marks?.classes() ?? null;
  }

  /** The nodes of these numbers that are in memory; all of them without numbers. */
  nodesInMemory(numbers?: Set<number>): Node[] {
    return [...this.loaded.keys()].filter((node) => !numbers || numbers.has(node.index));
  }

  /** Sets the labels of a node's points: class and selection, then the instance in three bytes. */
  setMarks(node: Node, values: Uint8Array): void {
    const loaded = this.loaded.get(node);
    if (!loaded?.marks) return;
    loaded.marks.set(values);
    loaded.painted = -1;
    this.changed();
  }

  /** Compares the ranges with those of another log of the same beams, which the modes `error` and `packet error` show. */
  async compareWith(other: number): Promise<void> {
    this.other = other;
    await this.loadErrors([...this.loaded.keys()]);
  }

  private async loadErrors(nodes: Node[]): Promise<void> {
    for (const node of nodes) {
      const data = await bytes(`errors?file=${this.octree.file}&other=${this.other}&nodes=${node.index}`);
      const loaded = this.loaded.get(node);
      if (loaded) Object.assign(loaded, { errors: new Float32Array(data), painted: -1 });
    }
    this.changed();
  }

  setHidden(hidden: Set<number>): void {
    this.paint.hidden = new Set(hidden);
    ++this.way;
    this.changed();
  }

  /** Loads the root, from whose points follow the extent of most points and the range of intensities. */
  async start(): Promise<void> {
    await this.load(this.octree.root);
    const points = this.loaded.get(this.octree.root)?.points;
    if (!points || points.count === 0) return;
    this.paint.intensities = shares(points.intensity);
    this.core.copy(coreOf(points.position)).translate(this.octree.root.box.min).translate(this.group.position);
  }

  /**
   * Chooses the nodes to draw, `budget` points at most, and keeps about twice `kept` points in memory. A node is divided
   * while its cells are wider than a pixel and a half.
   */
  update(camera: PerspectiveCamera, height: number, budget: number, kept = budget): void {
    ++this.frame;
    const frustum = new Frustum().setFromProjectionMatrix(
      new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    const pixels = height / (2 * Math.tan((camera.fov * Math.PI) / 360));
    const eye = camera.position.clone().sub(this.group.position);
    const open: { node: Node; size: number }[] = [];
    const push = (node: Node) => {
      const box = node.box.clone().translate(this.group.position);
      if (!frustum.intersectsBox(box)) return;
      const side = node.box.max.x - node.box.min.x;
      const distance = Math.max(node.box.distanceToPoint(eye), 0.1 * side);
      open.push({ node, size: (side / CELLS / distance) * pixels });
    };
    push(this.octree.root);
    const chosen = new Set<Node>();
    let points = 0;
    this.wanted = [];
    while (open.length > 0) {
      let best = 0;
      for (let k = 1; k < open.length; ++k) if (open[k]!.size > open[best]!.size) best = k;
      const { node, size } = open.splice(best, 1)[0]!;
      if (points + node.points > budget && points > 0) break;
      points += node.points;
      const there = this.loaded.get(node);
      if (there) {
        chosen.add(node);
        there.used = this.frame;
      } else {
        this.wanted.push(node);
      }
      if (size > 1.5) node.children.forEach(push);
    }
    this.loading = this.wanted.length > 0;
    this.loadNext();
    this.drawnPoints = 0;
    for (const [node, loaded] of this.loaded) {
      loaded.drawn.visible = chosen.has(node);
      if (!loaded.drawn.visible) continue;
      this.drawnPoints += node.points;
      if (loaded.painted !== this.way) this.colour(loaded);
    }
    this.forget(2 * kept);
  }

  private colour(loaded: Loaded): void {
    const base = loaded.drawn.position.z + this.group.position.z;
    const [low, high] = this.paint.heights;
    paintPoints(loaded.points, loaded, { ...this.paint, heights: [low - base, high - base] }, loaded.colours);
    loaded.painted = this.way;
    loaded.drawn.geometry.getAttribute('colour').needsUpdate = true;
  }

  /** The points that are drawn. */
  *batches(): Iterable<Batch> {
    for (const { points, drawn, colours } of this.loaded.values()) {
      if (!drawn.visible) continue;
      const { count, position, time } = points;
      yield { count, position, time, colours, offset: drawn.position.clone().add(this.group.position) };
    }
  }

  /** Draws only nodes that lie in a frustum, until the next `update`. */
  cull(frustum: Frustum): void {
    const box = new Box3();
    for (const [node, { drawn }] of this.loaded) {
      if (drawn.visible) drawn.visible = frustum.intersectsBox(box.copy(node.box).translate(this.group.position));
    }
  }

  /** Drops the nodes that were not in view for longest while more than `most` points are loaded. */
  private forget(most: number): void {
    let held = 0;
    for (const node of this.loaded.keys()) held += node.points;
    if (held <= most) return;
    const old = [...this.loaded].sort((a, b) => a[1].used - b[1].used);
    for (const [node, { drawn, used }] of old) {
      if (held <= most || used === this.frame) break;
      this.group.remove(drawn);
      drawn.geometry.dispose();
      this.loaded.delete(node);
      held -= node.points;
    }
  }

  private loadNext(): void {
    while (this.waiting.size < MOST_REQUESTS && this.wanted.length > 0) void this.load(this.wanted.shift()!);
  }

  private async load(node: Node): Promise<void> {
    if (this.waiting.has(node) || this.loaded.has(node)) return;
    this.waiting.add(node);
    try {
      const points = await loadPoints(this.octree.file, node);
      this.show(node, points);
      this.failed = '';
    } catch (error) {
      this.failed = String(error);
      await new Promise((resolve) => setTimeout(resolve, 2000)); // until it is tried again
    }
    this.waiting.delete(node);
    this.changed();
    if (!this.failed) this.loadNext();
  }

  private show(node: Node, points: Points): void {
    const geometry = new BufferGeometry();
    const add = (name: string, values: ArrayLike<number> & ArrayBufferView, size = 1, unit = false) =>
      geometry.setAttribute(name, new BufferAttribute(values as Float32Array, size, unit));
    add('position', points.position, 3);
    add('time', points.time);
    add('rowBytes', points.rowBytes, 4, true);
    const colours = new Uint32Array(points.count);
    add('colour', new Uint8Array(colours.buffer), 4, true);
    const drawn = new DrawnPoints(geometry, this.look);
    drawn.position.copy(node.box.min);
    drawn.frustumCulled = false;
    drawn.userData.pick = this.pick;
    this.group.add(drawn);
    drawn.layers.set(POINTS);
    const marks = this.marks ? new Uint8Array(4 * points.count) : null;
    this.loaded.set(node, { points, drawn, used: this.frame, colours, painted: -1, marks, errors: null });
    this.marks?.need([node]);
    if (this.other !== null) void this.loadErrors([node]);
  }

  /** The place of a point that is drawn, in the scene's frame, by its row. */
  placeOf(row: number): Vector3 | null {
    for (const { points, drawn } of this.loaded.values()) {
      if (!drawn.visible) continue;
      const k = points.row.indexOf(row);
      if (k >= 0) {
        return new Vector3().fromArray(points.position, 3 * k).add(drawn.position).add(this.group.position);
      }
    }
    return null;
  }

  dispose(): void {
    for (const { drawn } of this.loaded.values()) drawn.geometry.dispose();
    this.loaded.clear();
    this.look.dispose();
  }
}
