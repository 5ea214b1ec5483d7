// The picture: a camera, and what is drawn.
import {
  Box3,
  BufferGeometry,
  Color,
  Group,
  Line,
  LineBasicMaterial,
  type Object3D,
  type OrthographicCamera,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { Cloud } from './cloud';
import { Display } from './display';
import { Navigation } from './navigation';
import { type Picked, Picker, rayThrough, type Target, type View } from './picker';
import { partsOf, sideAt, type Sides, viewWidth, withOnly } from './sides';
import type { World } from './world';

/** Another view of the scene, drawn where an element of the page lies. */
export interface Inset {
  camera: OrthographicCamera;
  element: HTMLElement;
}

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
  private readonly picker: Picker;
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
    const { renderer, scene, display, clouds, worlds } = this;
    this.picker = new Picker({ renderer, scene, display, clouds, worlds, unpickable: [this.marks, this.overlays] });
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
    return this.picker.add(target);
  }

  replaceTarget(number: number, target: Target): void {
    this.picker.replace(number, target);
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
    this.camera.aspect = this.view.width / height;
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

  /** The picture that the camera makes. */
  private get view(): View {
    const { clientWidth, clientHeight: height } = this.canvas;
    return { camera: this.camera, width: viewWidth(this.sides, clientWidth), height, ellipsoids: this.ellipsoidBudget };
  }

  private get groups(): Group[] {
    return [...this.clouds, ...this.worlds].map((thing) => thing.group);
  }

  private renderSides(sides: Sides): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setScissorTest(true);
    for (const part of partsOf(sides, width)) {
      this.renderer.setScissor(part.from, 0, part.width, height);
      if (sides.mode === 'split') this.renderer.setViewport(part.from, 0, this.view.width, height);
      withOnly(this.groups, part.side, () => this.renderer.render(this.scene, this.camera));
    }
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, width, height);
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
    return this.groundMet(rayThrough(this.view, sideAt(this.sides, this.canvas.clientWidth, x).x, y));
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

  /** Finds what lies at a place of the canvas (CSS pixels), or next to it. */
  pick(at: number, y: number): Picked | null {
    const { x, side } = sideAt(this.sides, this.canvas.clientWidth, at);
    const picked = withOnly(this.groups, side, () => this.picker.pick(this.view, x, y));
    this.draw();
    return picked;
  }
}
