// The points of a log: the nodes of its octree that are in view, up to a budget of points.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  Frustum,
  Group,
  Matrix4,
  NearestFilter,
  type PerspectiveCamera,
  Points as DrawnPoints,
  RGBAFormat,
  type ShaderMaterial,
  Vector2,
  Vector3,
} from 'three';
import { bytes } from './api';
import { type Display, material, POINT_MODES, type PointMode } from './display';
import { loadPoints, type Node, type Octree, type Points } from './octree';

const MOST_REQUESTS = 8;
const CELLS = 64;
const MOST_CLASSES = 128;

interface Loaded {
  points: Points;
  drawn: DrawnPoints;
  used: number;
}

/** Where the labels of points that people edit come from. */
export interface Marks {
  /** The labels of these nodes are needed; `Cloud.setMarks` brings them. */
  need(nodes: Node[]): void;
}

const VERTEX = /* glsl */ `
  attribute float intensity;
  attribute float time;
  attribute float ring;
  attribute float label;
  attribute float echo;
  attribute vec4 rowBytes;
  attribute vec4 mark;
  attribute vec2 error;
  uniform float size;
  uniform int mode;
  uniform bool marked;
  uniform sampler2D hidden;
  varying float chosen;
  uniform vec2 intensities;
  uniform vec2 times;
  uniform vec2 range;
  uniform float rings;
  uniform float file;
  varying float value;
  varying vec3 place;
  varying vec4 part;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    part = rowBytes;
    value = 0.0;
    if (mode == 1) value = (intensity - intensities.x) / max(intensities.y - intensities.x, 1e-6);
    if (mode == 2) value = (time - times.x) / max(times.y - times.x, 1e-6);
    if (mode == 3) value = ring / max(rings, 1.0);
    if (mode == 4) value = echo;
    if (mode == 5) value = label;
    if (mode == 6) value = file + 1.0;
    if (mode == 8) value = error.x;
    if (mode == 9) value = error.y;
    chosen = 0.0;
    float ownClass = mod(mark.x, 128.0);
    if (marked) {
      chosen = mark.x >= 128.0 ? 1.0 : 0.0;
      if (mode == 5) value = ownClass;
      float number = mark.y + 256.0 * mark.z + 65536.0 * mark.w;
      if (mode == 7) value = number < 0.5 ? 0.0 : 1.0 + mod(number * 5.0, 14.0);
    }
    gl_Position = projectionMatrix * viewMatrix * world;
    if (time < range.x || time > range.y) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    if (marked && texture2D(hidden, vec2((ownClass + 0.5) / 128.0, 0.5)).r > 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size;
  }
`;

const FRAGMENT = /* glsl */ `
  uniform int mode;
  varying float value;
  varying float chosen;
  varying vec3 place;
  varying vec4 part;
  void main() {
    if (sliced(place)) discard;
    vec2 off = gl_PointCoord - 0.5;
    if (dot(off, off) > 0.25) discard;
    vec3 colour = mode == 0 ? heightColour(place)
      : mode >= 8 ? (abs(value) > 1e8 ? vec3(0.84, 0.37, 0.0) : mapped(sqrt(min(abs(value), 1.0)))) : mode >= 4 ? classColour(value) : mapped(value);
    if (chosen > 0.5) colour = mix(colour, vec3(1.0, 0.35, 0.75), 0.8);
    gl_FragColor = pass == 0 ? vec4(colour, 1.0) : pass == 1 ? bytesOf(object) : part;
  }
`;

/** For each class whether its points are hidden. */
function hiddenTexture(): DataTexture {
  const texture = new DataTexture(new Uint8Array(4 * MOST_CLASSES), MOST_CLASSES, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

/** The values below which 2 % and 98 % of the values lie. */
function shares(values: Float32Array): [number, number] {
  const sorted = Float32Array.from(values).sort();
  const at = (q: number) => sorted[Math.floor(q * (sorted.length - 1))]!;
  return [at(0.02), at(0.98)];
}

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
    this.look = material(
      display,
      {
        size: { value: 2 },
        mode: { value: 0 },
        intensities: { value: new Vector2(...facts.intensity) },
        times: { value: new Vector2(0, span) },
        range: { value: new Vector2(-1, span + 1) },
        rings: { value: facts.most_ring },
        file: { value: octree.file },
        object: { value: pick },
        marked: { value: false },
        hidden: { value: hiddenTexture() },
      },
      VERTEX,
      FRAGMENT,
    );
    const [x, y, z] = facts.origin_m;
    this.group.position.set(x - origin.x, y - origin.y, z - origin.z);
  }

  get error(): string {
    return this.failed;
  }

  setMode(mode: PointMode): void {
    this.look.uniforms.mode!.value = POINT_MODES.indexOf(mode);
  }

  setSize(pixels: number): void {
    this.look.uniforms.size!.value = pixels;
  }

  /** Shows the times [from, to] only, in seconds since the first beam. */
  setTimes(from: number, to: number): void {
    (this.look.uniforms.range!.value as Vector2).set(from, to);
  }

  /** Shows labels that people edit instead of the log's own, or no longer. */
  setMarksFrom(marks: Marks | null): void {
    this.marks = marks;
    this.look.uniforms.marked!.value = marks !== null;
    marks?.need([...this.loaded.keys()]);
  }

  /** The nodes of these numbers that are in memory; all of them without numbers. */
  nodesInMemory(numbers?: Set<number>): Node[] {
    return [...this.loaded.keys()].filter((node) => !numbers || numbers.has(node.index));
  }

  /** Sets the labels of a node's points: class and selection, then the instance in three bytes. */
  setMarks(node: Node, values: Uint8Array): void {
    const attribute = this.loaded.get(node)?.drawn.geometry.getAttribute('mark') as BufferAttribute | undefined;
    if (!attribute) return;
    (attribute.array as Uint8Array).set(values);
    attribute.needsUpdate = true;
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
      this.loaded.get(node)?.drawn.geometry.setAttribute('error', new BufferAttribute(new Float32Array(data), 2));
    }
    this.changed();
  }

  setHidden(hidden: Set<number>): void {
    const texture = this.look.uniforms.hidden!.value as DataTexture;
    const data = texture.image.data as Uint8Array;
    for (let k = 0; k < MOST_CLASSES; ++k) data[4 * k] = hidden.has(k) ? 255 : 0;
    texture.needsUpdate = true;
    this.changed();
  }

  /** Loads the root, from whose points follow the extent of most points and the range of intensities. */
  async start(): Promise<void> {
    await this.load(this.octree.root);
    const points = this.loaded.get(this.octree.root)?.points;
    if (!points || points.count === 0) return;
    const [low, high] = shares(points.intensity);
    (this.look.uniforms.intensities!.value as Vector2).set(low, high);
    const axis = (k: number) => shares(points.position.filter((_, i) => i % 3 === k));
    const [x, y, z] = [axis(0), axis(1), axis(2)];
    this.core.min.set(x[0], y[0], z[0]).add(this.octree.root.box.min).add(this.group.position);
    this.core.max.set(x[1], y[1], z[1]).add(this.octree.root.box.min).add(this.group.position);
  }

  /** Chooses the nodes to draw. A node is divided while its cells are wider than a pixel and a half. */
  update(camera: PerspectiveCamera, height: number, budget: number): void {
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
    for (const [node, { drawn }] of this.loaded) {
      drawn.visible = chosen.has(node);
      if (drawn.visible) this.drawnPoints += node.points;
    }
    this.forget(2 * budget);
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
    add('intensity', points.intensity);
    add('time', points.time);
    add('ring', points.ring);
    add('label', points.label);
    add('echo', points.echo);
    add('rowBytes', points.rowBytes, 4, true);
    add('mark', new Uint8Array(4 * points.count), 4);
    const drawn = new DrawnPoints(geometry, this.look);
    drawn.position.copy(node.box.min);
    drawn.frustumCulled = false;
    drawn.userData.pick = this.pick;
    this.group.add(drawn);
    this.loaded.set(node, { points, drawn, used: this.frame });
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
