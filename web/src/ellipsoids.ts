// Ellipsoids as they are drawn: in blocks that lie together, each as cast ellipsoids where they are
// large on the screen, as points where they are small, and not at all out of view.
import {
  Box3,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Frustum,
  type Group,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Matrix4,
  Mesh,
  type Object3D,
  type PerspectiveCamera,
  Points,
  type ShaderMaterial,
  Sphere,
  Vector3,
} from 'three';
import { coreOf, floatColumn, numberColumn } from './unpack';

export const ELLIPSOID_BYTES = 52;
const BLOCK = 2048;
/** Places of the variances among xx, xy, xz, yy, yz, zz. */
const DIAGONAL = [0, 3, 5];
/** An ellipsoid whose mean width is less than so many pixels is drawn as a point. */
const SMALL_PIXELS = 3;

// A ray through a box around the ellipsoid is cast at the ellipsoid itself: x = mean + r L u with
// |u| = 1 and the Cholesky factor L of the covariance.
export const ELLIPSOID_VERTEX = /* glsl */ `
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

const SHARE_GLSL = /* glsl */ `
  // A hash of pixel and element: the share p of the pixels is drawn, whatever lies before or behind.
  float draw(vec2 pixel, float element) {
    vec3 v = fract(vec3(pixel, element) * vec3(0.1031, 0.1030, 0.0973));
    v += dot(v, v.yxz + 33.33);
    return fract((v.x + v.y) * v.z);
  }
  vec3 elementColour(vec3 facts, vec3 shown) {
    return worldMode == 0 ? mapped(facts.x) : worldMode == 1 ? classColour(facts.y)
      : worldMode == 2 ? heightColour(shown) : vec3(0.45, 0.6, 0.4);
  }
`;

export const ELLIPSOID_FRAGMENT = /* glsl */ `
  uniform int worldMode;
  uniform mat4 place;
  uniform float opaque;
  varying vec3 from;
  varying vec3 to;
  varying vec3 shownFacts;
  varying mat4 clip;
  varying mat3 factor;
  varying vec3 centre;
  ${SHARE_GLSL}
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
    float light = 0.55 + 0.45 * abs(dot(normalize(u), normalize(d)));
    gl_FragColor = pass == 0 ? vec4(elementColour(shownFacts, shown.xyz) * light, 1.0)
      : pass == 1 ? bytesOf(object) : bytesOf(int(shownFacts.z));
  }
`;

// A small ellipsoid as a point of its mean width; of a pixel that it covers in part, that part.
export const SPLAT_VERTEX = /* glsl */ `
  attribute vec3 facts;
  attribute float width;
  uniform float radius;
  uniform float pixels;
  varying vec3 shownFacts;
  varying vec3 shown;
  varying float cover;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    shown = world.xyz;
    shownFacts = facts;
    gl_Position = projectionMatrix * viewMatrix * world;
    float size = radius * width * length(modelMatrix[0].xyz) * pixels / max(gl_Position.w, 1e-3);
    cover = min(1.0, size * size);
    gl_PointSize = clamp(size, 1.0, 64.0);
  }
`;

export const SPLAT_FRAGMENT = /* glsl */ `
  uniform int worldMode;
  uniform float opaque;
  varying vec3 shownFacts;
  varying vec3 shown;
  varying float cover;
  ${SHARE_GLSL}
  void main() {
    if (sliced(shown)) discard;
    float share = opaque < 0.5 ? shownFacts.x * cover : cover;
    if (share < 1.0 && draw(floor(gl_FragCoord.xy), shownFacts.z) >= share) discard;
    gl_FragColor = pass == 0 ? vec4(elementColour(shownFacts, shown) * 0.85, 1.0)
      : pass == 1 ? bytesOf(object) : bytesOf(int(shownFacts.z));
  }
`;

/** Ellipsoids that lie together. */
interface Block {
  count: number;
  /** Around their means, in the frame of the model. */
  sphere: Sphere;
  /** Mean width of an ellipsoid of one standard deviation's radius, m. */
  width: number;
  cast: InstancedBufferGeometry;
  splats: BufferGeometry;
}

/** The ellipsoids of a model, in blocks. */
export interface EllipsoidBlocks {
  blocks: Block[];
  bounds: Box3;
  /** Where most of them lie. */
  core: Box3;
  /** The classes that occur. */
  labels: Set<number>;
}

/** Interleaves the bits of a place, ten for each axis. */
function morton(x: number, y: number, z: number): number {
  let out = 0;
  for (let bit = 0; bit < 10; ++bit) {
    out += (((x >> bit) & 1) + 2 * ((y >> bit) & 1) + 4 * ((z >> bit) & 1)) * 8 ** bit;
  }
  return out;
}

/** The numbers of the ellipsoids so that those near each other in space lie near each other in the list. */
function sorted(mean: Float32Array, bounds: Box3): Uint32Array {
  const n = mean.length / 3;
  const order = Uint32Array.from({ length: n }, (_, i) => i);
  if (n <= BLOCK) return order;
  const size = bounds.getSize(new Vector3());
  const scale = 1023 / Math.max(size.x, size.y, size.z, 1e-6);
  const { x, y, z } = bounds.min;
  const keys = new Float64Array(n);
  for (let i = 0; i < n; ++i) {
    keys[i] = morton((mean[3 * i]! - x) * scale, (mean[3 * i + 1]! - y) * scale, (mean[3 * i + 2]! - z) * scale);
  }
  return order.sort((a, b) => keys[a]! - keys[b]!);
}

/** Reads the answer `ellipsoids` of the server. */
export function ellipsoidBlocks(view: DataView): EllipsoidBlocks | null {
  const n = view.byteLength / ELLIPSOID_BYTES;
  if (n === 0) return null;
  const records = { start: 0, bytes: ELLIPSOID_BYTES, count: n };
  const mean = floatColumn(view, records, 0, 3);
  const covariance = floatColumn(view, records, 12, 6);
  const p = floatColumn(view, records, 36, 1);
  const label = numberColumn(view, records, 48);
  const bounds = new Box3().setFromArray(mean);
  const order = sorted(mean, bounds);
  const blocks: Block[] = [];
  for (let first = 0; first < n; first += BLOCK) {
    blocks.push(blockOf(order.subarray(first, Math.min(n, first + BLOCK)), { mean, covariance, p, label }));
  }
  // Their ends at one standard deviation, the lower and the upper ones.
  const ends = [-1, 1].map((side) => mean.map((v, k) => v + side * Math.sqrt(covariance[6 * Math.floor(k / 3) + DIAGONAL[k % 3]!]!)));
  const core = new Box3(coreOf(ends[0]!).min, coreOf(ends[1]!).max);
  return { blocks, bounds, core, labels: new Set(label) };
}

function blockOf(
  which: Uint32Array,
  columns: { mean: Float32Array; covariance: Float32Array; p: Float32Array; label: Uint32Array },
): Block {
  const n = which.length;
  const mean = new Float32Array(3 * n);
  const diagonal = new Float32Array(3 * n);
  const below = new Float32Array(3 * n);
  const facts = new Float32Array(3 * n);
  const width = new Float32Array(n);
  which.forEach((i, k) => {
    const f = (c: number) => columns.covariance[6 * i + c]!;
    const a = Math.sqrt(Math.max(f(0), 1e-12));
    const b = f(1) / a;
    const c = f(2) / a;
    const d = Math.sqrt(Math.max(f(3) - b * b, 1e-12));
    const e = (f(4) - b * c) / d;
    mean.set(columns.mean.subarray(3 * i, 3 * i + 3), 3 * k);
    diagonal.set([a, d, Math.sqrt(Math.max(f(5) - c * c - e * e, 1e-12))], 3 * k);
    below.set([b, c, e], 3 * k);
    facts.set([columns.p[i]!, columns.label[i]!, i], 3 * k);
    // The side of a square as large as the disc of the mean radius.
    width[k] = Math.sqrt((Math.PI * (f(0) + f(3) + f(5))) / 3);
  });
  const box = new BoxGeometry(1, 1, 1);
  const cast = new InstancedBufferGeometry();
  cast.index = box.index;
  cast.setAttribute('position', box.getAttribute('position'));
  cast.setAttribute('mean', new InstancedBufferAttribute(mean, 3));
  cast.setAttribute('diagonal', new InstancedBufferAttribute(diagonal, 3));
  cast.setAttribute('below', new InstancedBufferAttribute(below, 3));
  cast.setAttribute('facts', new InstancedBufferAttribute(facts, 3));
  cast.instanceCount = n;
  const splats = new BufferGeometry();
  splats.setAttribute('position', new BufferAttribute(mean, 3));
  splats.setAttribute('facts', new BufferAttribute(facts, 3));
  splats.setAttribute('width', new BufferAttribute(width, 1));
  const sphere = new Box3().setFromArray(mean).getBoundingSphere(new Sphere());
  return { count: n, sphere, width: width.reduce((sum, w) => sum + w, 0) / n, cast, splats };
}

/** A block where an instance of its model stands. */
export interface Placed {
  block: Block;
  frame: Group;
  pick: number;
  /** Made when they are first drawn. */
  cast: Mesh | null;
  splats: Points | null;
}

export interface Looks {
  cast: ShaderMaterial;
  splats: ShaderMaterial;
}

function set(object: Object3D, look: ShaderMaterial, { frame, pick }: Placed): void {
  frame.add(object);
  object.updateMatrixWorld(true);
  object.frustumCulled = false;
  object.raycast = () => {}; // picked by its pixels
  object.userData.pick = pick;
  const inverse = new Matrix4();
  object.onBeforeRender = (_renderer, _scene, camera) => {
    look.uniforms.object!.value = pick;
    if (look.uniforms.eye) {
      inverse.copy(object.matrixWorld).invert();
      (look.uniforms.eye.value as Vector3).setFromMatrixPosition(camera.matrixWorld).applyMatrix4(inverse);
      look.uniforms.place!.value = object.matrixWorld;
    }
    look.uniformsNeedUpdate = true;
  };
}

function show(placed: Placed, as: 'cast' | 'splats' | null, looks: Looks): void {
  if (as === 'cast' && !placed.cast) {
    placed.cast = new Mesh(placed.block.cast, looks.cast);
    set(placed.cast, looks.cast, placed);
  } else if (as === 'splats' && !placed.splats) {
    placed.splats = new Points(placed.block.splats, looks.splats);
    set(placed.splats, looks.splats, placed);
  }
  if (placed.cast) placed.cast.visible = as === 'cast';
  if (placed.splats) placed.splats.visible = as === 'splats';
}

/**
 * Chooses how each block is drawn: the largest on the screen as cast ellipsoids, up to `most` of them, the others as
 * points. Returns the number of ellipsoids in view and of those that are cast.
 */
export function chooseBlocks(
  all: Placed[],
  camera: PerspectiveCamera,
  height: number,
  radius: number,
  most: number,
  looks: Looks,
): { inView: number; cast: number } {
  const frustum = new Frustum().setFromProjectionMatrix(
    new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
  );
  const pixels = height / (2 * Math.tan((camera.fov * Math.PI) / 360));
  looks.splats.uniforms.pixels!.value = pixels;
  const sphere = new Sphere();
  const seen: { placed: Placed; size: number }[] = [];
  for (const placed of all) {
    const { block, frame } = placed;
    const scale = frame.scale.x;
    sphere.copy(block.sphere).applyMatrix4(frame.matrixWorld);
    sphere.radius += 3 * radius * block.width * scale;
    if (!frame.visible || !frustum.intersectsSphere(sphere)) {
      show(placed, null, looks);
      continue;
    }
    const distance = Math.max(sphere.center.distanceTo(camera.position) - sphere.radius, camera.near);
    seen.push({ placed, size: (radius * block.width * scale * pixels) / distance });
  }
  seen.sort((a, b) => b.size - a.size);
  const out = { inView: 0, cast: 0 };
  for (const { placed, size } of seen) {
    const { count } = placed.block;
    const cast = size >= SMALL_PIXELS && out.cast + count <= Math.max(most, count);
    show(placed, cast ? 'cast' : 'splats', looks);
    out.inView += count;
    if (cast) out.cast += count;
  }
  return out;
}
