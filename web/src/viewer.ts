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
  Plane,
  Raycaster,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { Cloud } from './cloud';
import { Display, PLAIN_MASK } from './display';
import { centreIn, type Free, freePart } from './framing';
import { Navigation } from './navigation';
import { PointsLayer } from './points-layer';
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
  readonly points: PointsLayer;

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly marks = new Group();
  private readonly picker: Picker;
  private dirty = true;
  private last = 0;
  /** When the camera moved last, and how many points are drawn while it moves, so that it moves smoothly. */
  private turned = -Infinity;
  private movingBudget = 500_000;
  private coarse = false;
  private drawn = 0;
  private soon = 0;
  /** How long the last picture took, and what tells that it is drawn. */
  private pictureMs = 0;
  private fence: WebGLSync | null = null;
  private free: Free = { left: 0, top: 0, width: 1, height: 1 };

  constructor(
    readonly canvas: HTMLCanvasElement,
    onPick: (picked: Picked | null) => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
    this.points = new PointsLayer(this.renderer, this.display);
    this.renderer.setPixelRatio(this.pixelRatio);
    this.scene.background = new Color();
    this.scene.add(this.marks, this.overlays, this.points.quad);
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

  /** Pixels of the picture for a CSS pixel. */
  get pixelRatio(): number {
    return this.points.software ? 1 : Math.min(window.devicePixelRatio, 2);
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

  removeCloud(cloud: Cloud): void {
    this.clouds.delete(cloud);
    this.scene.remove(cloud.group);
    cloud.dispose();
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

  /** Whether nothing is shown. */
  get isEmpty(): boolean {
    return ![...this.clouds, ...this.worlds].some((thing) => thing.group.visible);
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

  /** Shows everything in the part of the view that no panel covers, and fits the colours of heights to it. */
  frameAll(): void {
    const logs = [...this.clouds].filter((cloud) => cloud.group.visible);
    const heights = logs.reduce((box, cloud) => box.union(cloud.core), new Box3());
    const box = this.bounds();
    const { min, max } = heights.isEmpty() ? box : heights;
    this.display.uniforms.heights.value.set(min.z, max.z);
    this.frameBox(box);
  }

  /** Shows a box of the scene's frame in the part of the view that no panel covers. */
  frameBox(box: Box3): void {
    this.centre();
    const { width, height } = this.view;
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const across = (slope * Math.min(this.free.width, width)) / height;
    this.navigation.frame(box, across, (slope * this.free.height) / height);
  }

  /** Looks from a direction, at everything where everything was looked at before. */
  lookFrom(direction: Vector3): void {
    const { framed } = this.navigation;
    this.navigation.lookFrom(direction);
    if (framed) this.frameAll();
  }

  /** Puts the middle of the picture into the middle of what no panel covers. */
  private centre(): void {
    const { width, height } = this.view;
    this.free = freePart(this.canvas);
    if (this.sides) this.free = { left: 0, top: 0, width, height };
    centreIn(this.camera, this.free, width, height);
  }

  /** The place of the canvas (CSS pixels) at which the camera looks. */
  get middle(): [number, number] {
    return [this.free.left + this.free.width / 2, this.free.top + this.free.height / 2];
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
    this.centre();
    this.draw();
  }

  private render(moving = false): void {
    this.dirty = false;
    this.drawn = performance.now();
    // Some twenty pictures a second while the camera moves. Fewer points do not help below some number of them.
    if (moving) this.movingBudget *= this.pictureMs > 50 ? 0.85 : this.pictureMs < 35 ? 1.1 : 1;
    const least = this.points.splats ? 300_000 : 100_000;
    this.movingBudget = Math.min(this.budget, Math.max(least, this.movingBudget));
    this.coarse = moving && this.movingBudget < this.budget;
    const budget = this.coarse ? this.movingBudget : this.budget;
    const shown = [...this.clouds].filter((cloud) => cloud.group.visible);
    for (const cloud of shown) cloud.update(this.camera, this.canvas.clientHeight, budget / shown.length, this.budget / shown.length);
    const cast = this.ellipsoidBudget * (this.coarse ? this.movingBudget / this.budget : 1);
    const worlds = [...this.worlds].filter((world) => world.group.visible);
    for (const world of worlds) world.update(this.camera, this.canvas.clientHeight, cast / worlds.length);
    this.renderParts(shown);
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

  /** What is drawn beside the file of a side: what moves stands in the world of its side. */
  private beside(side: Group | null): Group[] {
    const worlds = [...this.worlds];
    return worlds.some((world) => world.group === side) ? worlds.filter((world) => world.moves).map((world) => world.group) : [];
  }

  /** Draws the picture: the points of each side, and then each side with them in it. */
  private renderParts(clouds: Cloud[]): void {
    const { renderer, scene, camera, points } = this;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = renderer.getPixelRatio();
    const split = this.sides?.mode === 'split';
    const parts = partsOf(this.sides, width).map((part) => {
      const shown = clouds.filter((cloud) => !part.side || part.side === cloud.group);
      const left = split ? part.from : 0;
      return { ...part, shown, left, ends: [part.from, part.from + part.width].map((x) => Math.round(x * ratio)) };
    });
    points.begin(clouds[0]?.size ?? 1, this.isDeep, scene.background as Color);
    for (const { side, shown, left, ends } of parts) {
      const pane = { left: left * ratio, width: this.view.width * ratio, from: ends[0]!, to: ends[1]! };
      if (clouds.length > 0) withOnly(this.groups, side, this.beside(side), () => points.add(scene, camera, shown, pane));
    }
    points.finish(camera);
    renderer.setScissorTest(parts.length > 1);
    for (const { side, from, width: wide, left } of parts) {
      renderer.setScissor(from, 0, wide, height);
      renderer.setViewport(left, 0, this.view.width, height);
      withOnly(this.groups, side, this.beside(side), () => points.show(scene, camera));
    }
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
  }

  /** Whether there is anything but points in the picture. */
  private get isDeep(): boolean {
    const flat: Object3D[] = [this.points.quad, ...[...this.clouds].map((cloud) => cloud.group)];
    const others = this.scene.children.filter((o) => o.visible && !flat.includes(o) && o !== this.marks && o !== this.overlays);
    return others.length + this.marks.children.length > 0 || this.overlays.children.some((o) => o.visible);
  }

  private renderInset({ camera, element }: Inset): void {
    const box = element.getBoundingClientRect();
    const x = box.left - this.canvas.getBoundingClientRect().left;
    const y = this.canvas.clientHeight - box.bottom;
    camera.layers.mask = PLAIN_MASK;
    this.renderer.setViewport(x, y, box.width, box.height);
    this.renderer.setScissor(x, y, box.width, box.height);
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

  /** The place at a height (m, the scene's frame) under a pixel of the canvas. */
  placeUnder(x: number, y: number, height: number): Vector3 | null {
    const { ray } = rayThrough(this.view, sideAt(this.sides, this.canvas.clientWidth, x).x, y);
    return ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -height), new Vector3());
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
    const picked = withOnly(this.groups, side, this.beside(side), () => this.picker.pick(this.view, x, y));
    this.draw();
    return picked;
  }
}
