// Tools that draw on the picture: lasso, brush and rectangle. While one is in hand, dragging draws;
// the right button, the wheel and Space with dragging still move the camera.
import type { Navigation } from './navigation';

export type ToolName = 'lasso' | 'brush' | 'rectangle';

/** What was drawn, in CSS pixels of the canvas: a polygon, or a path with a radius. */
export interface Drawn {
  path: number[];
  radius: number;
  width: number;
  height: number;
  /** Numbers the strokes; parts of a stroke share it. */
  stroke: number;
  shift: boolean;
  alt: boolean;
}

const SVG = 'http://www.w3.org/2000/svg';
const MOST_CORNERS = 150;
const BRUSH_PART_MS = 200;

function randomStroke(): number {
  return (crypto.getRandomValues(new Uint32Array(1))[0]! | 1) >>> 0;
}

/** Leaves out corners of a closed path until few enough remain, those that matter least first. */
export function simplified(path: number[], most: number): number[] {
  let out = path;
  for (let tolerance = 1; out.length / 2 > most; tolerance *= 1.5) {
    const kept: number[] = [];
    for (let k = 0; k < path.length; k += 2) {
      const [x, y] = [path[k]!, path[k + 1]!];
      const n = kept.length;
      if (n === 0 || Math.hypot(x - kept[n - 2]!, y - kept[n - 1]!) >= tolerance) kept.push(x, y);
    }
    out = kept;
  }
  return out.map((v) => Math.round(v * 10) / 10);
}

export class Tools {
  tool: ToolName | null = null;
  radius = 20;
  private readonly layer: SVGSVGElement;
  private readonly shape: SVGPathElement;
  private readonly ring: SVGCircleElement;
  private path: number[] = [];
  private drawing = false;
  private steering = false;
  private stroke = 0;
  private part = 0;
  private space = false;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly navigation: Navigation,
    private readonly done: (drawn: Drawn) => void,
  ) {
    this.layer = document.createElementNS(SVG, 'svg');
    this.layer.id = 'draw';
    this.layer.setAttribute('aria-hidden', 'true');
    this.shape = document.createElementNS(SVG, 'path');
    this.ring = document.createElementNS(SVG, 'circle');
    this.layer.append(this.shape, this.ring);
    canvas.after(this.layer);
    this.layer.addEventListener('pointerdown', (e) => this.down(e));
    this.layer.addEventListener('pointermove', (e) => this.move(e));
    this.layer.addEventListener('pointerup', (e) => this.up(e));
    this.layer.addEventListener('pointercancel', (e) => this.up(e));
    this.layer.addEventListener('contextmenu', (e) => e.preventDefault());
    this.layer.addEventListener('wheel', (e) => {
      e.preventDefault();
      if (e.shiftKey && this.tool === 'brush') this.setRadius(this.radius * Math.exp(-e.deltaY * 0.001));
      else navigation.zoom(Math.exp(e.deltaY * 0.001));
    }, { passive: false });
    window.addEventListener('keydown', (e) => this.hold(e, true));
    window.addEventListener('keyup', (e) => this.hold(e, false));
    this.take(null);
  }

  /** Takes a tool, or puts it down. */
  take(tool: ToolName | null): void {
    this.tool = tool;
    this.drawing = false;
    this.path = [];
    this.layer.toggleAttribute('hidden', tool === null);
    this.layer.dataset.tool = tool ?? '';
    this.show();
  }

  setRadius(pixels: number): void {
    this.radius = Math.min(200, Math.max(2, pixels));
    this.show();
  }

  private hold(event: KeyboardEvent, down: boolean): void {
    if (event.key === ' ' && this.tool && !(event.target instanceof HTMLButtonElement)) {
      this.space = down;
      event.preventDefault();
    }
  }

  private at(e: PointerEvent): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }

  private down(e: PointerEvent): void {
    this.layer.setPointerCapture(e.pointerId);
    this.canvas.focus();
    if (e.button !== 0 || this.space) {
      this.steering = true;
      return;
    }
    this.drawing = true;
    this.stroke = randomStroke();
    this.part = performance.now();
    this.path = this.at(e);
    this.show();
  }

  private move(e: PointerEvent): void {
    const [x, y] = this.at(e);
    this.ring.setAttribute('cx', `${x}`);
    this.ring.setAttribute('cy', `${y}`);
    if (this.steering) {
      const scale = 4 / Math.max(1, this.canvas.clientHeight);
      if (e.shiftKey) this.navigation.shift(-e.movementX * scale * 0.25, e.movementY * scale * 0.25, 0);
      else this.navigation.orbit(e.movementX * scale, e.movementY * scale);
      return;
    }
    if (!this.drawing) return;
    if (this.tool === 'rectangle') {
      const [x0, y0] = [this.path[0]!, this.path[1]!];
      this.path = [x0, y0, x, y0, x, y, x0, y];
    } else {
      this.path.push(x, y);
    }
    this.show();
    if (this.tool === 'brush' && performance.now() - this.part > BRUSH_PART_MS) {
      this.send(e);
      this.path = [x, y];
      this.part = performance.now();
    }
  }

  private up(e: PointerEvent): void {
    if (this.steering) {
      this.steering = false;
      return;
    }
    if (!this.drawing) return;
    this.drawing = false;
    this.send(e);
    this.path = [];
    this.show();
  }

  private send(e: PointerEvent): void {
    const brush = this.tool === 'brush';
    const path = simplified(this.path, MOST_CORNERS);
    if (!brush && path.length < 6) return;
    this.done({
      path,
      radius: brush ? this.radius : 0,
      width: this.canvas.clientWidth,
      height: this.canvas.clientHeight,
      stroke: this.stroke,
      shift: e.shiftKey,
      alt: e.altKey,
    });
  }

  private show(): void {
    const points = [];
    for (let k = 0; k < this.path.length; k += 2) points.push(`${this.path[k]} ${this.path[k + 1]}`);
    const brush = this.tool === 'brush';
    this.shape.setAttribute('d', points.length > 0 ? `M${points.join('L')}${brush ? '' : 'Z'}` : '');
    this.shape.setAttribute('stroke-width', brush ? `${2 * this.radius}` : '1.5');
    this.shape.setAttribute('class', brush ? 'brush' : 'lasso');
    this.ring.setAttribute('r', brush ? `${this.radius}` : '0');
  }
}
