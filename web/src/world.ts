// A model, a scene or a set of primitives: ellipsoids that a share p of the light meets, and meshes.
import {
  Box3,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  BackSide,
  DoubleSide,
  Group,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  Quaternion,
  type ShaderMaterial,
  Vector3,
} from 'three';
import { bytes, type ServedFile, type WorldFacts, json } from './api';
import { type Display, material, WORLD_MODES, type WorldMode } from './display';
import { floatColumn, numberColumn } from './unpack';

const ELLIPSOID_BYTES = 52;

// A ray through a box around the ellipsoid is cast at the ellipsoid itself: x = mean + r L u with
// |u| = 1 and the Cholesky factor L of the covariance.
const ELLIPSOID_VERTEX = /* glsl */ `
  attribute vec3 mean;
  attribute vec3 diagonal;
  attribute vec3 below;
  attribute vec3 facts;
  uniform float radius;
  uniform vec3 eye;
  varying vec3 from;
  varying vec3 to;
  varying vec3 shownFacts;
  varying mat4 clip;
  varying mat3 factor;
  varying vec3 centre;
  vec3 solved(vec3 v) {
    float x = v.x / diagonal.x;
    float y = (v.y - below.x * x) / diagonal.y;
    return vec3(x, y, (v.z - below.y * x - below.z * y) / diagonal.z);
  }
  void main() {
    factor = mat3(diagonal.x, below.x, below.y, 0.0, diagonal.y, below.z, 0.0, 0.0, diagonal.z) * radius;
    vec3 extent = radius * vec3(diagonal.x, length(vec2(below.x, diagonal.y)), length(vec3(below.y, below.z, diagonal.z)));
    vec3 corner = mean + position * 2.0 * extent;
    from = solved(eye - mean) / radius;
    to = solved(corner - mean) / radius;
    centre = mean;
    shownFacts = facts;
    clip = projectionMatrix * modelViewMatrix;
    gl_Position = clip * vec4(corner, 1.0);
  }
`;

const ELLIPSOID_FRAGMENT = /* glsl */ `
  uniform int worldMode;
  uniform mat4 place;
  uniform float opaque;
  varying vec3 from;
  varying vec3 to;
  varying vec3 shownFacts;
  varying mat4 clip;
  varying mat3 factor;
  varying vec3 centre;
  // A hash of pixel and element: the share p of the pixels is drawn, whatever lies before or behind.
  float draw(vec2 pixel, float element) {
    vec3 v = fract(vec3(pixel, element) * vec3(0.1031, 0.1030, 0.0973));
    v += dot(v, v.yxz + 33.33);
    return fract((v.x + v.y) * v.z);
  }
  void main() {
    vec3 d = to - from;
    float a = dot(d, d), b = dot(from, d), c = dot(from, from) - 1.0;
    float root = b * b - a * c;
    if (root < 0.0) discard;
    float t = (-b - sqrt(root)) / a;
    if (t < 0.0) t = (-b + sqrt(root)) / a;
    if (t < 0.0) discard;
    vec3 u = from + t * d;
    vec3 at = centre + factor * u;
    vec4 shown = place * vec4(at, 1.0);
    if (sliced(shown.xyz)) discard;
    if (opaque < 0.5 && draw(floor(gl_FragCoord.xy), shownFacts.z) >= shownFacts.x) discard;
    vec4 screen = clip * vec4(at, 1.0);
    gl_FragDepth = 0.5 + 0.5 * screen.z / screen.w;
    vec3 colour = worldMode == 0 ? mapped(shownFacts.x) : worldMode == 1 ? classColour(shownFacts.y)
      : worldMode == 2 ? heightColour(shown.xyz) : vec3(0.45, 0.6, 0.4);
    float light = 0.55 + 0.45 * abs(dot(normalize(u), normalize(d)));
    gl_FragColor = pass == 0 ? vec4(colour * light, 1.0) : pass == 1 ? bytesOf(object) : bytesOf(int(shownFacts.z));
  }
`;

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

interface ModelData {
  ellipsoids: DataView;
  geometry: InstancedBufferGeometry | null;
  meshes: { kind: 'ground' | 'surface'; geometry: BufferGeometry; data: ArrayBuffer }[];
}

function ellipsoidGeometry(view: DataView): InstancedBufferGeometry | null {
  const n = view.byteLength / ELLIPSOID_BYTES;
  if (n === 0) return null;
  const records = { start: 0, bytes: ELLIPSOID_BYTES, count: n };
  const mean = floatColumn(view, records, 0, 3);
  const covariance = floatColumn(view, records, 12, 6);
  const p = floatColumn(view, records, 36, 1);
  const label = numberColumn(view, records, 48);
  const diagonal = new Float32Array(3 * n);
  const below = new Float32Array(3 * n);
  const facts = new Float32Array(3 * n);
  for (let i = 0; i < n; ++i) {
    const f = (k: number) => covariance[6 * i + k]!;
    const a = Math.sqrt(Math.max(f(0), 1e-12));
    const b = f(1) / a;
    const c = f(2) / a;
    const d = Math.sqrt(Math.max(f(3) - b * b, 1e-12));
    const e = (f(4) - b * c) / d;
    diagonal.set([a, d, Math.sqrt(Math.max(f(5) - c * c - e * e, 1e-12))], 3 * i);
    below.set([b, c, e], 3 * i);
    facts.set([p[i]!, label[i]!, i], 3 * i);
  }
  const box = new BoxGeometry(1, 1, 1);
  const geometry = new InstancedBufferGeometry();
  geometry.index = box.index;
  geometry.setAttribute('position', box.getAttribute('position'));
  geometry.setAttribute('mean', new InstancedBufferAttribute(mean, 3));
  geometry.setAttribute('diagonal', new InstancedBufferAttribute(diagonal, 3));
  geometry.setAttribute('below', new InstancedBufferAttribute(below, 3));
  geometry.setAttribute('facts', new InstancedBufferAttribute(facts, 3));
  geometry.instanceCount = n;
  geometry.boundingBox = new Box3().setFromArray(mean);
  return geometry;
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
  return geometry;
}

export class World {
  readonly group = new Group();
  readonly bounds = new Box3();
  private readonly looks: ShaderMaterial[] = [];
  private readonly models = new Map<number, ModelData>();
  private radius = 1;

  private constructor(
    readonly file: ServedFile,
    readonly facts: WorldFacts,
    private readonly display: Display,
    origin: Vector3,
  ) {
    this.group.position.set(...facts.origin_m).sub(origin);
  }

  /** Reads a world. `pick` gives each drawn instance a number. */
  static async open(
    file: ServedFile,
    display: Display,
    origin: Vector3,
    pick: (target: { world: World; instance: number; part: 'ellipsoid' | 'ground' | 'surface' }) => number,
    tell: (done: number) => void,
  ): Promise<World> {
    const facts = await json<WorldFacts>(`world?file=${file.id}`);
    const world = new World(file, facts, display, origin);
    const used = [...new Set(facts.instances.map((i) => i.model))];
    for (const [k, model] of used.entries()) {
      world.models.set(model, await world.load(model));
      tell((k + 1) / used.length);
    }
    facts.instances.forEach((_, k) => world.place(k, pick));
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
    return { ellipsoids: view, geometry: ellipsoidGeometry(view), meshes };
  }

  private place(
    k: number,
    pick: (target: { world: World; instance: number; part: 'ellipsoid' | 'ground' | 'surface' }) => number,
  ): void {
    const instance = this.facts.instances[k]!;
    const model = this.models.get(instance.model)!;
    const frame = new Group();
    frame.position.set(...instance.at_m);
    const [w, x, y, z] = instance.rotation_wxyz;
    frame.quaternion.copy(new Quaternion(x, y, z, w));
    frame.scale.setScalar(instance.scale);
    this.group.add(frame);
    if (model.geometry) {
      const mesh = new Mesh(model.geometry, this.ellipsoidLook());
      mesh.frustumCulled = false;
      mesh.raycast = () => {}; // picked by its pixels
      mesh.userData.pick = pick({ world: this, instance: k, part: 'ellipsoid' });
      const inverse = mesh.matrixWorld.clone();
      mesh.onBeforeRender = (_renderer, _scene, camera) => {
        const look = mesh.material as ShaderMaterial;
        inverse.copy(mesh.matrixWorld).invert();
        (look.uniforms.eye!.value as Vector3).setFromMatrixPosition(camera.matrixWorld).applyMatrix4(inverse);
        look.uniforms.place!.value = mesh.matrixWorld;
        look.uniforms.object!.value = mesh.userData.pick as number;
        look.uniformsNeedUpdate = true;
      };
      frame.add(mesh);
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
    for (const box of [model.geometry?.boundingBox, ...model.meshes.map((m) => m.geometry.boundingBox)]) {
      if (box) this.bounds.union(box.clone().applyMatrix4(frame.matrixWorld));
    }
  }

  private ellipsoidLook(): ShaderMaterial {
    if (!this.looks[0]) {
      const own = {
        radius: { value: this.radius },
        eye: { value: new Vector3() },
        place: { value: this.group.matrixWorld },
        opaque: { value: 0 },
        object: { value: 0 },
      };
      this.looks[0] = material(this.display, own, ELLIPSOID_VERTEX, ELLIPSOID_FRAGMENT);
      this.looks[0].side = BackSide;
    }
    return this.looks[0];
  }

  private meshLook(): ShaderMaterial {
    if (!this.looks[1]) {
      this.looks[1] = material(this.display, { object: { value: 0 } }, MESH_VERTEX, MESH_FRAGMENT);
      this.looks[1].side = DoubleSide;
    }
    return this.looks[1];
  }

  setMode(mode: WorldMode): void {
    this.display.uniforms.worldMode.value = WORLD_MODES.indexOf(mode);
  }

  /** Draws ellipsoids at so many standard deviations. */
  setRadius(sigmas: number): void {
    this.radius = sigmas;
    if (this.looks[0]) this.looks[0].uniforms.radius!.value = sigmas;
  }

  setOpaque(opaque: boolean): void {
    if (this.looks[0]) this.looks[0].uniforms.opaque!.value = Number(opaque);
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
    return new Vector3(f(0), f(1), f(2)).applyMatrix4(this.group.children[instance]!.matrixWorld);
  }

  dispose(): void {
    for (const { geometry, meshes } of this.models.values()) {
      geometry?.dispose();
      meshes.forEach((m) => m.geometry.dispose());
    }
    this.looks.forEach((look) => look.dispose());
  }
}
