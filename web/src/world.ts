// A model, a scene or a set of primitives: ellipsoids that a share p of the light meets, and meshes.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  BackSide,
  DoubleSide,
  Group,
  Mesh,
  type PerspectiveCamera,
  Quaternion,
  type ShaderMaterial,
  Vector3,
} from 'three';
import { bytes, type ServedFile, type WorldFacts, json } from './api';
import { type Display, material, WORLD_MODES, type WorldMode } from './display';
import { coreOf } from './unpack';
import {
  chooseBlocks,
  ELLIPSOID_BYTES,
  ELLIPSOID_FRAGMENT,
  ELLIPSOID_VERTEX,
  ellipsoidBlocks,
  type EllipsoidBlocks,
  type Looks,
  type Placed,
  SPLAT_FRAGMENT,
  SPLAT_VERTEX,
} from './ellipsoids';

/** A mesh lies so far behind its place where points are before it. */
const BEHIND_M = 0.3;

const MESH_VERTEX = /* glsl */ `
  attribute float p;
  varying vec3 shown;
  varying vec3 seen;
  varying float share;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    shown = world.xyz;
    share = p;
    vec4 view = viewMatrix * world;
    seen = view.xyz;
    gl_Position = projectionMatrix * view;
    // Points on a mesh, half of which lie a little below it, are drawn before it.
    vec4 behind = projectionMatrix * vec4(seen + normalize(seen) * float(${BEHIND_M}), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
  }
`;

const MESH_FRAGMENT = /* glsl */ `
  uniform int worldMode;
  varying vec3 shown;
  varying vec3 seen;
  varying float share;
  void main() {
    if (sliced(shown)) discard;
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    vec3 colour = worldMode == 0 ? mapped(share) : worldMode == 2 ? heightColour(shown) : vec3(0.62, 0.55, 0.45);
    float light = 0.5 + 0.5 * abs(dot(normal, normalize(seen)));
    gl_FragColor = pass == 0 ? vec4(colour * light, 1.0) : pass == 1 ? bytesOf(object) : bytesOf(0);
  }
`;

/** Hit probability of an element, and the beams from which it was learnt. */
export interface HitFacts {
  p: number;
  hits: number;
  misses: number;
}

/** Facts of an ellipsoid, for its details. */
export interface EllipsoidFacts extends HitFacts {
  label: number;
  semiAxes: [number, number, number];
}

type PickWorld = (target: { world: World; instance: number; part: 'ellipsoid' | 'ground' | 'surface' }) => number;

interface ModelData {
  ellipsoids: DataView;
  blocks: EllipsoidBlocks | null;
  meshes: { kind: 'ground' | 'surface'; geometry: BufferGeometry; data: ArrayBuffer }[];
}

function meshGeometry(data: ArrayBuffer): BufferGeometry {
  const [vertices = 0, triangles = 0] = new Uint32Array(data, 0, 2);
  const place = new Float32Array(data, 8, 3 * vertices);
  const index = new Uint32Array(data, 8 + 12 * vertices, 3 * triangles);
  const p = new Float32Array(data, 8 + 12 * vertices + 12 * triangles, triangles);
  const ofVertex = new Float32Array(vertices); // the mean over its triangles
  const count = new Uint16Array(vertices);
  index.forEach((v, k) => {
    ofVertex[v] = ofVertex[v]! + p[Math.floor(k / 3)]!;
    count[v] = count[v]! + 1;
  });
  ofVertex.forEach((sum, v) => (ofVertex[v] = sum / Math.max(1, count[v]!)));
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(place, 3));
  geometry.setAttribute('p', new BufferAttribute(ofVertex, 1));
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.computeBoundingBox();
  geometry.userData.core = coreOf(place);
  return geometry;
}

export class World {
  readonly group = new Group();
  /** Where most of it lies, in the scene's frame. */
  readonly bounds = new Box3();
  /** Classes of its ellipsoids. */
  readonly labels = new Set<number>();
  /** Ellipsoids in view, and how many of them are cast instead of drawn as points. */
  drawnEllipsoids = 0;
  castEllipsoids = 0;
  private readonly home: Vector3;
  private meshMaterial: ShaderMaterial | null = null;
  private readonly ellipsoidLooks: Looks;
  private readonly placed: Placed[] = [];
  private readonly models = new Map<number, ModelData>();
  /** The frames of each instance; those after the first are copies. */
  private readonly frames: Group[][] = [];
  private pick: PickWorld = () => 0;
  private radius = 1;

  private constructor(
    readonly file: ServedFile,
    readonly facts: WorldFacts,
    private readonly display: Display,
    origin: Vector3,
  ) {
    this.group.position.set(...facts.origin_m).sub(origin);
    this.home = this.group.position.clone();
    const shared = { radius: { value: 1 }, opaque: { value: 0 }, object: { value: 0 } };
    const eye = { eye: { value: new Vector3() }, place: { value: this.group.matrixWorld } };
    this.ellipsoidLooks = {
      cast: material(display, { ...shared, ...eye }, ELLIPSOID_VERTEX, ELLIPSOID_FRAGMENT),
      splats: material(display, { ...shared, pixels: { value: 1 } }, SPLAT_VERTEX, SPLAT_FRAGMENT),
    };
    this.ellipsoidLooks.cast.side = BackSide;
  }

  /** Reads a world. `pick` gives each drawn instance a number. */
  static async open(
    file: ServedFile,
    display: Display,
    origin: Vector3,
    pick: PickWorld,
    tell: (done: number) => void,
  ): Promise<World> {
    const facts = await json<WorldFacts>(`world?file=${file.id}`);
    const world = new World(file, facts, display, origin);
    const used = [...new Set(facts.instances.map((i) => i.model))];
    for (const [k, model] of used.entries()) {
      world.models.set(model, await world.load(model));
      tell((k + 1) / used.length);
    }
    world.pick = pick;
    facts.instances.forEach((_, k) => world.place(k));
    return world;
  }

  private async load(model: number): Promise<ModelData> {
    const query = `file=${this.file.id}&model=${model}`;
    const facts = this.facts.models[model]!;
    const view = new DataView(await bytes(`ellipsoids?${query}`));
    const meshes: ModelData['meshes'] = [];
    if (facts.ground_triangles > 0) {
      const data = await bytes(`ground?${query}`);
      meshes.push({ kind: 'ground', geometry: meshGeometry(data), data });
    }
    if (facts.surface_triangles > 0) {
      const data = await bytes(`surface?${query}`);
      meshes.push({ kind: 'surface', geometry: meshGeometry(data), data });
    }
    return { ellipsoids: view, blocks: ellipsoidBlocks(view), meshes };
  }

  /** Draws an instance, once more if it is drawn already. */
  private place(k: number): Group {
    const { pick } = this;
    const instance = this.facts.instances[k]!;
    const model = this.models.get(instance.model)!;
    const frame = new Group();
    frame.position.set(...instance.at_m);
    const [w, x, y, z] = instance.rotation_wxyz;
    frame.quaternion.copy(new Quaternion(x, y, z, w));
    frame.scale.setScalar(instance.scale);
    this.group.add(frame);
    (this.frames[k] ??= []).push(frame);
    if (model.blocks) {
      const number = pick({ world: this, instance: k, part: 'ellipsoid' });
      for (const block of model.blocks.blocks) {
        this.placed.push({ block, frame, pick: number, cast: null, splats: null });
      }
    }
    for (const { kind, geometry } of model.meshes) {
      const mesh = new Mesh(geometry, this.meshLook());
      mesh.userData.pick = pick({ world: this, instance: k, part: kind });
      mesh.onBeforeRender = () => {
        const look = mesh.material as ShaderMaterial;
        look.uniforms.object!.value = mesh.userData.pick as number;
        look.uniformsNeedUpdate = true;
      };
      frame.add(mesh);
    }
    this.group.updateMatrixWorld(true);
    model.blocks?.labels.forEach((label) => this.labels.add(label));
    for (const box of [model.blocks?.core, ...model.meshes.map((m) => m.geometry.userData.core as Box3)]) {
      if (box) this.bounds.union(box.clone().applyMatrix4(frame.matrixWorld));
    }
    return frame;
  }

  /** The box of a primitive in the scene's frame. */
  boxOf(instance: number): Box3 {
    const { min, max } = this.facts.models[this.facts.instances[instance]!.model]!.box_m!;
    return new Box3(new Vector3(...min), new Vector3(...max)).applyMatrix4(this.frames[instance]![0]!.matrixWorld);
  }

  /** Shows one instance alone, or all again. */
  showAlone(instance: number | null): void {
    this.frames.forEach((frames, k) => frames.forEach((frame) => (frame.visible = instance === null || k === instance)));
  }

  /** Whether something in it moves. */
  get moves(): boolean {
    return this.facts.instances.some((instance) => instance.moves);
  }

  /** Shows the moving instances at these poses, each as often as it is named, and no others of them. */
  moveTo(poses: { instance: number; at: Vector3; turn: Quaternion }[]): void {
    const used = new Map<number, number>();
    for (const { instance, at, turn } of poses) {
      const n = used.get(instance) ?? 0;
      used.set(instance, n + 1);
      const frame = this.frames[instance]![n] ?? this.place(instance);
      frame.position.copy(at);
      frame.quaternion.copy(turn);
    }
    this.facts.instances.forEach(({ moves }, k) => {
      if (moves) this.frames[k]!.forEach((frame, n) => (frame.visible = n < (used.get(k) ?? 0)));
    });
    this.group.updateMatrixWorld(true);
  }

  /** Chooses which ellipsoids are cast, at most `most` of them, and which are drawn as points. */
  update(camera: PerspectiveCamera, height: number, most: number): void {
    const { inView, cast } = chooseBlocks(this.placed, camera, height, this.radius, most, this.ellipsoidLooks);
    this.drawnEllipsoids = inView;
    this.castEllipsoids = cast;
  }

  /** Puts it beside a box, south of it and on its lowest height, or (without one) where it belongs. */
  standBeside(box: Box3 | null): void {
    const to = this.home.clone();
    this.bounds.translate(this.home.clone().sub(this.group.position)); // as it lies at home
    if (box && !box.isEmpty()) {
      const gap = 2 + 0.05 * (box.max.y - box.min.y);
      const middle = (b: Box3) => (b.min.x + b.max.x) / 2;
      to.add(new Vector3(middle(box) - middle(this.bounds), box.min.y - gap - this.bounds.max.y, box.min.z - this.bounds.min.z));
    }
    this.bounds.translate(to.clone().sub(this.home));
    this.group.position.copy(to);
    this.group.updateMatrixWorld(true);
  }

  private meshLook(): ShaderMaterial {
    this.meshMaterial ??= material(this.display, { object: { value: 0 } }, MESH_VERTEX, MESH_FRAGMENT);
    this.meshMaterial.side = DoubleSide;
    return this.meshMaterial;
  }

  setMode(mode: WorldMode): void {
    this.display.uniforms.worldMode.value = WORLD_MODES.indexOf(mode);
  }

  /** Draws ellipsoids at so many standard deviations. */
  setRadius(sigmas: number): void {
    this.radius = sigmas;
    this.ellipsoidLooks.cast.uniforms.radius!.value = sigmas; // shared with the points
  }

  setOpaque(opaque: boolean): void {
    this.ellipsoidLooks.cast.uniforms.opaque!.value = Number(opaque);
  }

  ellipsoid(instance: number, index: number): EllipsoidFacts {
    const view = this.models.get(this.facts.instances[instance]!.model)!.ellipsoids;
    const f = (k: number) => view.getFloat32(index * ELLIPSOID_BYTES + 4 * k, true);
    const u = (k: number) => view.getUint32(index * ELLIPSOID_BYTES + 4 * k, true);
    const deviations = [f(3), f(6), f(8)].map(Math.sqrt) as [number, number, number];
    return { p: f(9), hits: u(10), misses: u(11), label: u(12), semiAxes: deviations };
  }

  /** Facts of a triangle by its number in the mesh. */
  triangle(instance: number, part: 'ground' | 'surface', index: number): HitFacts {
    const model = this.models.get(this.facts.instances[instance]!.model)!;
    const view = new DataView(model.meshes.find((m) => m.kind === part)!.data);
    const [vertices, triangles] = [view.getUint32(0, true), view.getUint32(4, true)];
    const at = 8 + 12 * vertices + 12 * triangles + 4 * index;
    return {
      p: view.getFloat32(at, true),
      hits: view.getUint32(at + 4 * triangles, true),
      misses: view.getUint32(at + 8 * triangles, true),
    };
  }

  /** The mean of an ellipsoid in the scene's frame. */
  centreOf(instance: number, index: number): Vector3 {
    const view = this.models.get(this.facts.instances[instance]!.model)!.ellipsoids;
    const f = (k: number) => view.getFloat32(index * ELLIPSOID_BYTES + 4 * k, true);
    return new Vector3(f(0), f(1), f(2)).applyMatrix4(this.frames[instance]![0]!.matrixWorld);
  }

  dispose(): void {
    for (const { blocks, meshes } of this.models.values()) {
      blocks?.blocks.forEach((block) => [block.cast, block.splats].forEach((geometry) => geometry.dispose()));
      meshes.forEach((m) => m.geometry.dispose());
    }
    [this.meshMaterial, this.ellipsoidLooks.cast, this.ellipsoidLooks.splats].forEach((look) => look?.dispose());
  }
}
