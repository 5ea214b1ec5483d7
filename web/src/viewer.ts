// The picture: a camera, what is drawn, and which thing lies under the cursor.
import {
  Box3,
  BufferGeometry,
  type Camera,
  Color,
  Frustum,
  Group,
  type LineSegments,
  Line,
  LineBasicMaterial,
  Matrix4,
  NoBlending,
  type Object3D,
  type OrthographicCamera,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { Cloud } from './cloud';
import type { Sides } from './compare';
import { Display, Pass } from './display';
import { Navigation } from './navigation';
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

/** Another view of the scene, drawn where an element of the page lies. */
export interface Inset {
  camera: OrthographicCamera;
  element: HTMLElement;
}

const PICK_PIXELS = 11;
const NONE = 0xffffffff;

export class Viewer {
  readonly display = new Display();
  readonly camera = new PerspectiveCamera(60, 1, 0.1, 10000);
  readonly navigation: Navigation;
  readonly clouds = new Set<Cloud>();
  readonly worlds = new Set<World>();
  budget = 2_000_000;
  /** Ellipsoids that are cast, ray by ray; the others are drawn as points. */
  ellipsoidBudget = 40_000;
  onDrawn: (() => void) | null = null;
  insets: Inset[] = [];
  /** Two files that are drawn side by side. */
  sides: Sides | null = null;

  /** Things that cannot be picked, such as the sensor's path. */
  readonly overlays = new Group();

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly marks = new Group();
  private readonly targets: Target[] = [];
  private readonly near = new WebGLRenderTarget(PICK_PIXELS, PICK_PIXELS);
  private dirty = true;
  private last = 0;
  /** When the camera moved last, and how many points are drawn while it moves, so that it moves smoothly. */
  private turned = -Infinity;
  private movingBudget = 1_000_000;
  private coarse = false;
  private drawn = 0;
  private soon = 0;
  /** How long the last picture took, and what tells that it is drawn. */
  private pictureMs = 0;
  private fence: WebGLSync | null = null;

  constructor(
    readonly canvas: HTMLCanvasElement,
    onPick: (picked: Picked | null) => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene.add(this.marks, this.overlays);
    this.navigation = new Navigation(
      this.camera,
      canvas,
      () => {
        this.turned = performance.now();
        this.draw();
      },
      (x, y) => onPick(this.pick(x, y)),
    );
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    const loop = (now: number) => {
      requestAnimationFrame(loop);
      this.navigation.fly((now - this.last) / 1000);
      this.last = now;
      const moving = now - this.turned < 250;
      if ((this.dirty || (this.coarse && !moving)) && this.isDrawn()) this.render(moving);
    };
    requestAnimationFrame(loop);
  }

  /** Whether the last picture is drawn: the next one must not wait behind it, or the page would answer late. */
  private isDrawn(): boolean {
    if (!this.fence) return true;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (gl.clientWaitSync(this.fence, 0, 0) === gl.TIMEOUT_EXPIRED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    this.pictureMs = performance.now() - this.drawn;
    return true;
  }

  /** Asks for a new picture. */
  draw(): void {
    this.dirty = true;
  }

  /** Asks for a new picture in a moment, once more has arrived. */
  drawSoon(): void {
    if (this.soon !== 0) return;
    // Where pictures take long, more is waited for between them, so that loading is not held up.
    const wait = Math.min(3000, Math.max(100, 3 * this.pictureMs));
    this.soon = window.setTimeout(() => {
      this.soon = 0;
      this.draw();
    }, wait);
  }

  setBackground(colour: string): void {
    this.scene.background = new Color(colour);
    this.draw();
  }

  target(target: Target): number {
    return this.targets.push(target) - 1;
  }

  replaceTarget(number: number, target: Target): void {
    this.targets[number] = target;
  }

  addCloud(cloud: Cloud): void {
    this.clouds.add(cloud);
    this.scene.add(cloud.group);
    this.draw();
  }

  addWorld(world: World): void {
    this.worlds.add(world);
    this.scene.add(world.group);
    this.draw();
  }

  add(object: Object3D): void {
    this.scene.add(object);
    this.draw();
  }

  remove(object: Object3D): void {
    object.removeFromParent();
    this.draw();
  }

  /** Replaces the marks: the picked beam, the measured line. */
  mark(...objects: Object3D[]): void {
    this.marks.clear();
    objects.forEach((o) => this.marks.add(o));
    this.draw();
  }

  measured(from: Vector3, to: Vector3): Line {
    const look = new LineBasicMaterial({ color: 0xcc79a7, depthTest: false });
    return new Line(new BufferGeometry().setFromPoints([from, to]), look);
  }

  /** Bounds of most of what is shown, in the scene's frame. */
  bounds(): Box3 {
    const box = new Box3();
    for (const cloud of this.clouds) {
      if (cloud.group.visible) box.union(cloud.core);
    }
    for (const world of this.worlds) {
      if (world.group.visible) box.union(world.bounds);
    }
    return box.isEmpty() ? new Box3(new Vector3(-10, -10, 0), new Vector3(10, 10, 5)) : box;
  }

  frameAll(): void {
    const box = this.bounds();
    this.display.uniforms.heights.value.set(box.min.z, box.max.z);
    const size = box.getSize(new Vector3());
    this.navigation.frame(box.getCenter(new Vector3()), Math.max(2, 0.6 * Math.max(size.x, size.y, size.z)));
  }

  get drawnPoints(): number {
    let points = 0;
    for (const cloud of this.clouds) points += cloud.group.visible ? cloud.drawnPoints : 0;
    return points;
  }

  /** Whether points that belong to the picture are still on their way. */
  get loading(): boolean {
    return this.dirty || this.coarse || this.soon !== 0 || [...this.clouds].some((cloud) => cloud.group.visible && cloud.loading);
  }

  /** Fits the picture to the canvas. */
  resize(): void {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = this.viewWidth / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private render(moving = false): void {
    this.dirty = false;
    const now = performance.now();
    const took = now - this.drawn;
    this.drawn = now;
    // Thirty pictures a second while the camera moves.
    if (moving && took < 2000) this.movingBudget *= took > 45 ? 0.75 : took < 30 ? 1.15 : 1;
    this.movingBudget = Math.min(this.budget, Math.max(50_000, this.movingBudget));
    this.coarse = moving && this.movingBudget < this.budget;
    const budget = this.coarse ? this.movingBudget : this.budget;
    const shown = [...this.clouds].filter((cloud) => cloud.group.visible);
    for (const cloud of shown) cloud.update(this.camera, this.canvas.clientHeight, budget / shown.length);
    const cast = this.ellipsoidBudget * (this.coarse ? this.movingBudget / this.budget : 1);
    const worlds = [...this.worlds].filter((world) => world.group.visible);
    for (const world of worlds) world.update(this.camera, this.canvas.clientHeight, cast / worlds.length);
    if (this.sides) this.renderSides(this.sides);
    else this.renderer.render(this.scene, this.camera);
    this.insets.forEach((inset) => this.renderInset(inset));
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (this.fence) gl.deleteSync(this.fence);
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.onDrawn?.();
  }

  /** Width of the picture that the camera makes: half of the canvas on a split screen. */
  private get viewWidth(): number {
    return Math.max(1, this.canvas.clientWidth / (this.sides?.mode === 'split' ? 2 : 1));
  }

  /** Calls `draw` while only one side's file can be seen. */
  private withOnly<T>(side: Group | null, draw: () => T): T {
    if (!side) return draw();
    const groups = [...this.clouds, ...this.worlds].map((thing) => thing.group);
    const before = groups.map((group) => group.visible);
    groups.forEach((group) => (group.visible = group.visible && group === side));
    const out = draw();
    groups.forEach((group, k) => (group.visible = before[k]!));
    return out;
  }

  private renderSides({ mode, left, right, share }: Sides): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const line = Math.round(width * (mode === 'split' ? 0.5 : share));
    this.renderer.setScissorTest(true);
    for (const [side, x, w] of [[left, 0, line], [right, line, width - line]] as const) {
      if (w <= 0) continue;
      this.renderer.setScissor(x, 0, w, height);
      if (mode === 'split') this.renderer.setViewport(x, 0, this.viewWidth, height);
      this.withOnly(side, () => this.renderer.render(this.scene, this.camera));
    }
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, width, height);
  }

  /** The side and the place within its picture of a place of the canvas. */
  private sideAt(x: number): { x: number; side: Group | null } {
    if (!this.sides) return { x, side: null };
    const { mode, left, right, share } = this.sides;
    const line = this.canvas.clientWidth * (mode === 'split' ? 0.5 : share);
    return { x: mode === 'split' && x >= line ? x - line : x, side: x < line ? left : right };
  }

  private renderInset({ camera, element }: Inset): void {
    const box = element.getBoundingClientRect();
    const y = this.canvas.clientHeight - box.bottom;
    this.renderer.setViewport(box.left, y, box.width, box.height);
    this.renderer.setScissor(box.left, y, box.width, box.height);
    this.renderer.setScissorTest(true);
    this.renderer.render(this.scene, camera);
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /** The height of the highest ground or surface over a place, in the scene's frame. */
  groundAt(x: number, y: number): number | null {
    const ray = new Raycaster(new Vector3(x, y, 1e5), new Vector3(0, 0, -1));
    return this.groundMet(ray)?.z ?? null;
  }

  /** The place of the ground under a pixel of the canvas, in the scene's frame. */
  groundUnder(x: number, y: number): Vector3 | null {
    const ray = new Raycaster();
    const across = this.sideAt(x).x / this.viewWidth;
    ray.setFromCamera(new Vector2(across * 2 - 1, 1 - (y / this.canvas.clientHeight) * 2), this.camera);
    return this.groundMet(ray);
  }

  private groundMet(ray: Raycaster): Vector3 | null {
    const shown = [...this.worlds].filter((world) => world.group.visible).map((world) => world.group);
    return ray.intersectObjects(shown, true)[0]?.point ?? null;
  }

  /** A picture of the view as a PNG. */
  picture(): Promise<Blob> {
    this.render();
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png');
    });
  }

  /** Draws the pixels around the cursor with numbers for colours, and returns them. */
  private numbers(camera: Camera, pass: Pass): Uint32Array {
    this.display.uniforms.pass.value = pass;
    this.renderer.setRenderTarget(this.near);
    this.renderer.setClearColor(0xffffff, 1);
    this.renderer.clear();
    this.renderer.render(this.scene, camera);
    const out = new Uint8Array(4 * PICK_PIXELS * PICK_PIXELS);
    this.renderer.readRenderTargetPixels(this.near, 0, 0, PICK_PIXELS, PICK_PIXELS, out);
    this.renderer.setRenderTarget(null);
    this.display.uniforms.pass.value = Pass.picture;
    return new Uint32Array(out.buffer);
  }

  /** Finds what lies at a place of the canvas (CSS pixels), or next to it. */
  pick(at: number, y: number): Picked | null {
    const { x, side } = this.sideAt(at);
    return this.withOnly(side, () => this.pickIn(x, y));
  }

  private pickIn(x: number, y: number): Picked | null {
    const background = this.scene.background;
    this.scene.background = null;
    this.marks.visible = this.overlays.visible = false;
    this.scene.traverse((o) => this.withoutBlending(o));
    const camera = this.camera.clone();
    const half = (PICK_PIXELS - 1) / 2;
    camera.setViewOffset(this.viewWidth, this.canvas.clientHeight, x - half, y - half, PICK_PIXELS, PICK_PIXELS);
    // Only what lies around the cursor is drawn; the picture that follows shows all again.
    const frustum = new Frustum().setFromProjectionMatrix(
      new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    this.clouds.forEach((cloud) => cloud.cull(frustum));
    this.worlds.forEach((world) => world.update(camera, this.canvas.clientHeight, this.ellipsoidBudget));
    const objects = this.numbers(camera, Pass.object);
    const parts = this.numbers(camera, Pass.part);
    this.scene.background = background;
    this.marks.visible = this.overlays.visible = true;
    this.draw();
    let best = -1;
    let nearest = Infinity;
    objects.forEach((object, k) => {
      if (object === NONE) return;
      const distance = Math.hypot((k % PICK_PIXELS) - half, Math.floor(k / PICK_PIXELS) - half);
      if (distance >= nearest) return;
      nearest = distance;
      best = k;
    });
    const target = best < 0 ? undefined : this.targets[objects[best]!];
    if (!target) return null;
    return this.whole(target, parts[best]!, x, y);
  }

  private withoutBlending(object: Object3D): void {
    const look = (object as LineSegments).material;
    if (look && !Array.isArray(look)) look.blending = NoBlending;
  }

  /** Adds to what was picked where it is, and to a mesh which of its triangles. */
  private whole(target: Target, part: number, x: number, y: number): Picked {
    if (target.kind === 'point') return { target, part, place: target.cloud.placeOf(part) };
    if (target.kind === 'beam') return { target, part, place: null };
    if (target.part === 'ellipsoid') {
      return { target, part, place: target.world.centreOf(target.instance, part) };
    }
    const at = new Vector2((x / this.viewWidth) * 2 - 1, 1 - (y / this.canvas.clientHeight) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const met = ray
      .intersectObject(target.world.group, true)
      .find((m) => this.targets[m.object.userData.pick as number] === target);
    return { target, part: met?.faceIndex ?? 0, place: met?.point ?? null };
  }
}
