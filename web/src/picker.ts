// Finds which thing lies under the cursor: the pixels around it are drawn with numbers for colours.
import {
  type Camera,
  Frustum,
  type Group,
  type LineSegments,
  Matrix4,
  NoBlending,
  type Object3D,
  type PerspectiveCamera,
  Raycaster,
  type Scene,
  Vector2,
  type Vector3,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import type { Cloud } from './cloud';
import { type Display, Pass, PLAIN_MASK } from './display';
import type { World } from './world';

export type Target =
  | { kind: 'point'; cloud: Cloud }
  | { kind: 'beam'; file: number }
  | { kind: 'world'; world: World; instance: number; part: 'ellipsoid' | 'ground' | 'surface' };

/** What lies under the cursor: a target, the number of its part, and the place in the scene's frame. */
export interface Picked {
  target: Target;
  part: number;
  place: Vector3 | null;
}

/** What is drawn, and with what. */
interface Drawn {
  renderer: WebGLRenderer;
  scene: Scene;
  display: Display;
  clouds: Set<Cloud>;
  worlds: Set<World>;
  /** What cannot be picked. */
  unpickable: Group[];
}

/** A picture of the scene, and the number of ellipsoids that are cast in it; sizes in CSS pixels. */
export interface View {
  camera: PerspectiveCamera;
  width: number;
  height: number;
  ellipsoids: number;
}

const PICK_PIXELS = 11;
const NONE = 0xffffffff;

export class Picker {
  private readonly targets: Target[] = [];
  private readonly near = new WebGLRenderTarget(PICK_PIXELS, PICK_PIXELS);

  constructor(private readonly drawn: Drawn) {}

  /** Adds a target and returns the number that its pixels are drawn with. */
  add(target: Target): number {
    return this.targets.push(target) - 1;
  }

  replace(number: number, target: Target): void {
    this.targets[number] = target;
  }

  /** Finds what lies at a place of a view (CSS pixels), or next to it. The next picture must be drawn anew. */
  pick(view: View, x: number, y: number): Picked | null {
    const { scene, clouds, worlds, unpickable } = this.drawn;
    const background = scene.background;
    scene.background = null;
    unpickable.forEach((group) => (group.visible = false));
    scene.traverse((o) => this.withoutBlending(o));
    const camera = view.camera.clone();
    camera.layers.mask = PLAIN_MASK;
    const half = (PICK_PIXELS - 1) / 2;
    const { offsetX, offsetY } = view.camera.view ?? { offsetX: 0, offsetY: 0 };
    camera.setViewOffset(view.width, view.height, x - half + offsetX, y - half + offsetY, PICK_PIXELS, PICK_PIXELS);
    // Only what lies around the cursor is drawn; the picture that follows shows all again.
    const frustum = new Frustum().setFromProjectionMatrix(
      new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    clouds.forEach((cloud) => cloud.cull(frustum));
    worlds.forEach((world) => world.update(camera, view.height, view.ellipsoids));
    const objects = this.numbers(camera, Pass.object);
    const parts = this.numbers(camera, Pass.part);
    scene.background = background;
    unpickable.forEach((group) => (group.visible = true));
    const best = nearestTo(objects, half);
    const target = best < 0 ? undefined : this.targets[objects[best]!];
    return target ? this.whole(target, parts[best]!, view, x, y) : null;
  }

  /** Draws the pixels around the cursor with numbers for colours, and returns them. */
  private numbers(camera: Camera, pass: Pass): Uint32Array {
    const { renderer, display } = this.drawn;
    display.uniforms.pass.value = pass;
    renderer.setRenderTarget(this.near);
    renderer.setClearColor(0xffffff, 1);
    renderer.clear();
    renderer.render(this.drawn.scene, camera);
    const out = new Uint8Array(4 * PICK_PIXELS * PICK_PIXELS);
    renderer.readRenderTargetPixels(this.near, 0, 0, PICK_PIXELS, PICK_PIXELS, out);
    renderer.setRenderTarget(null);
    display.uniforms.pass.value = Pass.picture;
    return new Uint32Array(out.buffer);
  }

  private withoutBlending(object: Object3D): void {
    const look = (object as LineSegments).material;
    if (look && !Array.isArray(look)) look.blending = NoBlending;
  }

  /** Adds to what was picked where it is, and to a mesh which of its triangles. */
  private whole(target: Target, part: number, view: View, x: number, y: number): Picked {
    if (target.kind === 'point') return { target, part, place: target.cloud.placeOf(part) };
    if (target.kind === 'beam') return { target, part, place: null };
    if (target.part === 'ellipsoid') {
      return { target, part, place: target.world.centreOf(target.instance, part) };
    }
    const met = rayThrough(view, x, y)
      .intersectObject(target.world.group, true)
      .find((m) => this.targets[m.object.userData.pick as number] === target);
    return { target, part: met?.faceIndex ?? 0, place: met?.point ?? null };
  }
}

/** The index of the pixel nearest to the middle that shows an object, or -1. */
function nearestTo(objects: Uint32Array, half: number): number {
  let best = -1;
  let nearest = Infinity;
  objects.forEach((object, k) => {
    if (object === NONE) return;
    const distance = Math.hypot((k % PICK_PIXELS) - half, Math.floor(k / PICK_PIXELS) - half);
    if (distance >= nearest) return;
    nearest = distance;
    best = k;
  });
  return best;
}

/** The ray through a place of a view (CSS pixels). */
export function rayThrough(view: View, x: number, y: number): Raycaster {
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2((x / view.width) * 2 - 1, 1 - (y / view.height) * 2), view.camera);
  return ray;
}
