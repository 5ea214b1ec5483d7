// A box from above, from the side and from the front, with edges to drag: the three views are linked, because all of
// them show and change the same box.
import { OrthographicCamera, Vector3 } from 'three';
import { el } from './panel';
import type { Inset, Viewer } from './viewer';

/** A box in the scene's frame: its foot, heading, and extent in its own frame. */
export interface SceneBox {
  position: Vector3;
  yaw: number;
  min: Vector3;
  max: Vector3;
}

interface View {
  name: string;
  /** Axes of the box that point to the right, up and towards the viewer, with their signs. */
  right: [0 | 1 | 2, 1 | -1];
  up: [0 | 1 | 2, 1 | -1];
  back: [0 | 1 | 2, 1 | -1];
}

const VIEWS: View[] = [
  { name: 'above', right: [0, 1], up: [1, 1], back: [2, 1] },
  { name: 'the side', right: [0, 1], up: [2, 1], back: [1, -1] },
  { name: 'the front', right: [1, 1], up: [2, 1], back: [0, 1] },
];
const WIDTH = 180;
const HEIGHT = 130;
const GRIP = 10; // pixels next to an edge

function axisOf(box: SceneBox, [axis, sign]: [0 | 1 | 2, 1 | -1]): Vector3 {
  const out = new Vector3().setComponent(axis, sign);
  return out.applyAxisAngle(new Vector3(0, 0, 1), box.yaw);
}

export class BoxViews {
  private readonly frame = el('div', { id: 'box-views', hidden: '' });
  private readonly panes: { view: View; pane: HTMLElement; outline: HTMLElement; inset: Inset }[] = [];
  private box: SceneBox | null = null;
  private drag: { view: number; x: number; y: number; start: SceneBox; edges: string; perPixel: number } | null = null;

  constructor(
    private readonly viewer: Viewer,
    /** Called while the box is dragged, and with `done` when it is let go. */
    private readonly changed: (box: SceneBox, done: boolean) => void,
  ) {
    VIEWS.forEach((view, k) => {
      const outline = el('div', { class: 'outline' });
      const pane = el('div', { class: 'pane', title: `The box from ${view.name}: drag edges, the middle, or outside to turn` }, outline);
      pane.addEventListener('pointerdown', (e) => this.down(e, k));
      pane.addEventListener('pointermove', (e) => this.move(e));
      pane.addEventListener('pointerup', () => this.up());
      this.frame.append(pane);
      const inset = { camera: new OrthographicCamera(), element: pane };
      this.panes.push({ view, pane, outline, inset });
    });
    document.body.append(this.frame);
  }

  show(box: SceneBox | null): void {
    this.box = box;
    this.frame.hidden = box === null;
    this.viewer.insets = box ? this.panes.map((p) => p.inset) : [];
    if (box) this.place(box);
    this.viewer.draw();
  }

  /** Half of what a pane shows, along its width and its height, m. */
  private half(box: SceneBox): number {
    const size = box.max.clone().sub(box.min);
    return Math.max(1, 0.9 * Math.max(size.x, size.y, size.z));
  }

  private place(box: SceneBox): void {
    const up = new Vector3(0, 0, 1);
    const middle = box.min.clone().add(box.max).multiplyScalar(0.5).applyAxisAngle(up, box.yaw).add(box.position);
    const half = this.half(box);
    const size = box.max.clone().sub(box.min);
    for (const { view, outline, inset } of this.panes) {
      const camera = inset.camera;
      const ratio = WIDTH / HEIGHT;
      [camera.left, camera.right, camera.top, camera.bottom] = [-half * ratio, half * ratio, half, -half];
      const back = axisOf(box, view.back);
      camera.near = 0.01;
      camera.far = 40 * half;
      camera.position.copy(middle).addScaledVector(back, 20 * half);
      camera.up.copy(axisOf(box, view.up));
      camera.lookAt(middle);
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      const pixels = HEIGHT / (2 * half);
      const [w, h] = [size.getComponent(view.right[0]) * pixels, size.getComponent(view.up[0]) * pixels];
      outline.style.width = `${w}px`;
      outline.style.height = `${h}px`;
      outline.style.left = `${(WIDTH - w) / 2}px`;
      outline.style.top = `${(HEIGHT - h) / 2}px`;
    }
  }

  private down(e: PointerEvent, view: number): void {
    if (!this.box) return;
    const { pane, outline } = this.panes[view]!;
    pane.setPointerCapture(e.pointerId);
    const frame = outline.getBoundingClientRect();
    const near = (a: number, b: number) => Math.abs(a - b) < GRIP;
    let edges = near(e.clientX, frame.left) ? 'l' : near(e.clientX, frame.right) ? 'r' : '';
    edges += near(e.clientY, frame.top) ? 't' : near(e.clientY, frame.bottom) ? 'b' : '';
    const inside = e.clientX > frame.left - GRIP && e.clientX < frame.right + GRIP && e.clientY > frame.top - GRIP && e.clientY < frame.bottom + GRIP;
    if (!inside) edges = 'turn';
    const start = { ...this.box, position: this.box.position.clone(), min: this.box.min.clone(), max: this.box.max.clone() };
    this.drag = { view, x: e.clientX, y: e.clientY, start, edges, perPixel: (2 * this.half(this.box)) / HEIGHT };
  }

  private move(e: PointerEvent): void {
    if (!this.drag) return;
    const { view, x, y, start, edges, perPixel } = this.drag;
    const { right, up } = VIEWS[view]!;
    const dx = (e.clientX - x) * perPixel * right[1];
    const dy = (y - e.clientY) * perPixel * up[1];
    const box: SceneBox = { position: start.position.clone(), yaw: start.yaw, min: start.min.clone(), max: start.max.clone() };
    if (edges === 'turn') {
      if (view === 0) box.yaw = start.yaw + (e.clientX - x) * 0.01;
    } else if (edges === '') {
      box.position.addScaledVector(axisOf(start, [right[0], 1]), dx).addScaledVector(axisOf(start, [up[0], 1]), dy);
    } else {
      const shift = (corner: Vector3, axis: number, by: number) => corner.setComponent(axis, corner.getComponent(axis) + by);
      if (edges.includes('l')) shift(box.min, right[0], dx);
      if (edges.includes('r')) shift(box.max, right[0], dx);
      if (edges.includes('t')) shift(box.max, up[0], dy);
      if (edges.includes('b')) shift(box.min, up[0], dy);
      if (box.max.clone().sub(box.min).toArray().some((v) => v < 0.05)) return;
    }
    this.box = box;
    this.changed(box, false);
  }

  private up(): void {
    if (this.drag && this.box) {
      this.changed(this.box, true);
      this.place(this.box);
    }
    this.drag = null;
  }
}
