// Moves the camera: around a target (drag), along (shift or right button), nearer (wheel, pinch),
// and as in flight (W A S D Q E).
import { type Box3, type PerspectiveCamera, Spherical, Vector3 } from 'three';
import { distanceTo } from './framing';

const UP = new Vector3(0, 0, 1);
const FLY_KEYS = ['w', 'a', 's', 'd', 'q', 'e'];

export class Navigation {
  readonly target = new Vector3();
  /** Whether a person has moved the camera. */
  used = false;
  /** Whether it still looks at what it was told to look at. */
  framed = false;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private readonly keys = new Set<string>();
  private moved = 0;

  constructor(
    readonly camera: PerspectiveCamera,
    private readonly canvas: HTMLCanvasElement,
    private readonly changed: () => void,
    private readonly clicked: (x: number, y: number) => void,
  ) {
    camera.up.copy(UP);
    canvas.addEventListener('pointerdown', (e) => this.down(e));
    canvas.addEventListener('pointermove', (e) => this.move(e));
    canvas.addEventListener('pointerup', (e) => this.up(e));
    canvas.addEventListener('pointercancel', (e) => this.pointers.delete(e.pointerId));
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener(
      'wheel',
      (e) => {
        e.preventDefault();
        this.used = true;
        this.zoom(Math.exp(e.deltaY * 0.001));
      },
      { passive: false },
    );
    window.addEventListener('blur', () => this.keys.clear());
  }

  /** Looks at all of a box, without a turn, within slopes of the picture to the sides and up. */
  frame(box: Box3, across: number, upright: number): void {
    const back = this.camera.position.clone().sub(this.target);
    if (back.lengthSq() < 1e-9) back.set(-0.6, -1, 0.7);
    back.normalize();
    box.getCenter(this.target);
    this.framed = true;
    this.camera.position.copy(this.target).addScaledVector(back, distanceTo(box, back.clone().negate(), across, upright));
    this.apply();
  }

  /** Looks from a direction: the eye lies there as seen from the target. */
  lookFrom(direction: Vector3): void {
    const distance = this.camera.position.distanceTo(this.target);
    this.camera.position.copy(this.target).addScaledVector(direction.normalize(), distance);
    this.apply();
  }

  set(eye: Vector3, target: Vector3): void {
    this.framed = false;
    this.camera.position.copy(eye);
    this.target.copy(target);
    this.apply();
  }

  orbit(left: number, up: number): void {
    this.framed = false;
    const back = this.camera.position.clone().sub(this.target);
    // Spherical has y up.
    const s = new Spherical().setFromVector3(new Vector3(back.x, back.z, -back.y));
    s.theta -= left;
    s.phi = Math.min(Math.PI - 0.01, Math.max(0.01, s.phi - up));
    const turned = new Vector3().setFromSpherical(s);
    this.camera.position.copy(this.target).add(new Vector3(turned.x, -turned.z, turned.y));
    this.apply();
  }

  zoom(factor: number): void {
    this.framed = false;
    const back = this.camera.position.clone().sub(this.target).multiplyScalar(factor);
    if (back.length() < 0.05 || back.length() > 1e6) return;
    this.camera.position.copy(this.target).add(back);
    this.apply();
  }

  /** Moves eye and target by a share of their distance: to the right, up, and ahead. */
  shift(right: number, up: number, ahead: number): void {
    this.framed = false;
    const distance = this.camera.position.distanceTo(this.target);
    const forward = this.target.clone().sub(this.camera.position).normalize();
    const side = forward.clone().cross(UP).normalize();
    const above = side.clone().cross(forward);
    const by = side
      .multiplyScalar(right * distance)
      .addScaledVector(above, up * distance)
      .addScaledVector(forward, ahead * distance);
    this.camera.position.add(by);
    this.target.add(by);
    this.apply();
  }

  keyDown(key: string): boolean {
    if (!FLY_KEYS.includes(key)) return false;
    this.keys.add(key);
    return true;
  }

  keyUp(key: string): void {
    this.keys.delete(key);
  }

  /** Flies on for `seconds` while keys are held. Returns whether it moved. */
  fly(seconds: number): boolean {
    if (this.keys.size === 0) return false;
    const held = (key: string) => Number(this.keys.has(key));
    const by = Math.min(seconds, 0.1) * 0.8;
    this.shift((held('d') - held('a')) * by, (held('e') - held('q')) * by, (held('w') - held('s')) * by);
    return true;
  }

  private apply(): void {
    const distance = this.camera.position.distanceTo(this.target);
    this.camera.near = Math.max(0.01, distance / 500);
    this.camera.far = distance * 100 + 2000;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.changed();
  }

  private down(e: PointerEvent): void {
    this.used = true;
    this.canvas.setPointerCapture(e.pointerId);
    this.canvas.focus();
    this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    if (this.pointers.size === 1) this.moved = 0;
    else this.moved = 100;
  }

  private move(e: PointerEvent): void {
    const last = this.pointers.get(e.pointerId);
    if (!last) return;
    const dx = e.clientX - last.x;
    const dy = e.clientY - last.y;
    this.moved += Math.abs(dx) + Math.abs(dy);
    const scale = 1 / Math.max(1, this.canvas.clientHeight);
    if (this.pointers.size >= 2) {
      const other = [...this.pointers].find(([id]) => id !== e.pointerId)![1];
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const after = Math.hypot(e.clientX - other.x, e.clientY - other.y);
      if (before > 1 && after > 1) this.zoom(before / after);
      this.shift((-dx / 2) * scale, (dy / 2) * scale, 0);
    } else if (e.buttons & 2 || e.shiftKey) {
      this.shift(-dx * scale, dy * scale, 0);
    } else if (this.moved > 4) {
      this.orbit(4 * dx * scale, 4 * dy * scale);
    }
    this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
  }

  private up(e: PointerEvent): void {
    if (!this.pointers.delete(e.pointerId)) return;
    if (this.moved <= 4 && e.button === 0) {
      const box = this.canvas.getBoundingClientRect();
      this.clicked(e.clientX - box.left, e.clientY - box.top);
    }
  }
}
