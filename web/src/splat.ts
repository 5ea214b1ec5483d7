// Draws points with the processor: where a program stands in for the graphics card, it takes microseconds for each
// point, and a loop takes nanoseconds. The picture is the one that the graphics card would draw.
import { Matrix4, type Vector3 } from 'three';

/** Points to draw. */
export interface Batch {
  count: number;
  /** Relative to `offset`, m. */
  position: Float32Array;
  offset: Vector3;
  time: Float32Array;
  /** Red, green, blue and opacity; 0 where a point is not drawn. */
  colours: Uint32Array;
}

/** What of a batch is drawn. */
export interface Filter {
  /** Seconds since the first point of the log; null for all. */
  times: [number, number] | null;
  /** Component of the place in the scene's frame and the least and greatest value of it; null for all. */
  slice: { axis: number; low: number; high: number } | null;
}

/** A part of the canvas in pixels: where the camera's picture lies, and the columns of it that are drawn. */
export interface Pane {
  left: number;
  width: number;
  from: number;
  to: number;
}

/** How dark a step of depth makes the pixels behind it, and the darkest. */
export const DOME = 60;
export const DARKEST = 0.2;

/** Points up to this diameter are squares. */
export const SQUARE_PIXELS = 2.5;

export class Splatter {
  width = 0;
  height = 0;
  /** Colours of the pixels, row by row from below. */
  colour = new Uint32Array(0);
  /** One over the distance along the view of what is nearest in each pixel; 0 where there is no point. */
  near = new Float32Array(0);
  private readonly matrix = new Matrix4();

  /** Begins a picture of a size, all pixels of which have the colour `background`. */
  begin(width: number, height: number, background: number): void {
    if (width !== this.width || height !== this.height) {
      [this.width, this.height] = [width, height];
      this.colour = new Uint32Array(width * height);
      this.near = new Float32Array(width * height);
    }
    this.colour.fill(background);
    this.near.fill(0);
  }

  /** Draws points as discs of `size` pixels. */
  draw(batch: Batch, clipFromScene: Matrix4, pane: Pane, size: number, filter: Filter): void {
    const { position, colours, count } = batch;
    const kept = filter.times || filter.slice ? this.filtered(batch, filter) : null;
    const m = this.matrix.makeTranslation(batch.offset).premultiply(clipFromScene).elements;
    const { colour, near, width, height } = this;
    const [halfX, halfY] = [pane.width / 2, height / 2];
    const [x0, x1, x2, x3] = [m[0]!, m[4]!, m[8]!, m[12]!];
    const [y0, y1, y2, y3] = [m[1]!, m[5]!, m[9]!, m[13]!];
    const [w0, w1, w2, w3] = [m[3]!, m[7]!, m[11]!, m[15]!];
    const z0 = m[2]!, z1 = m[6]!, z2 = m[10]!, z3 = m[14]!;
    const [left, right] = [Math.max(0, pane.from), Math.min(width, pane.to)];
    const offsets = discOf(size);
    const middleX = pane.left + halfX - size / 2 + 0.5;
    const middleY = halfY - size / 2 + 0.5;
    const simple = size === 2;
    for (let k = 0, j = 0; k < count; ++k, j += 3) {
      const c = colours[k]!;
      if (c === 0 || (kept && kept[k] === 0)) continue;
      const x = position[j]!, y = position[j + 1]!, z = position[j + 2]!;
      const w = w0 * x + w1 * y + w2 * z + w3;
      if (w <= 0 || z0 * x + z1 * y + z2 * z + z3 < -w) continue; // before the nearest plane
      const n = 1 / w;
      const px = Math.floor(middleX + halfX * n * (x0 * x + x1 * y + x2 * z + x3));
      const py = Math.floor(middleY + halfY * n * (y0 * x + y1 * y + y2 * z + y3));
      if (simple && px >= left && px < right - 1 && py >= 0 && py < height - 1) {
        const at = py * width + px;
        if (n > near[at]!) { near[at] = n; colour[at] = c; }
        if (n > near[at + 1]!) { near[at + 1] = n; colour[at + 1] = c; }
        if (n > near[at + width]!) { near[at + width] = n; colour[at + width] = c; }
        if (n > near[at + width + 1]!) { near[at + width + 1] = n; colour[at + width + 1] = c; }
        continue;
      }
      if (px < left - size || px >= right || py < -size || py >= height) continue;
      for (let o = 0; o < offsets.length; o += 2) {
        const u = px + offsets[o]!, v = py + offsets[o + 1]!;
        if (u < left || u >= right || v < 0 || v >= height) continue;
        const at = v * width + u;
        if (n > near[at]!) { near[at] = n; colour[at] = c; }
      }
    }
  }

  /** For each point whether it is drawn. */
  private filtered({ count, position, offset, time }: Batch, { times, slice }: Filter): Uint8Array {
    const kept = new Uint8Array(count).fill(1);
    if (times) for (let k = 0; k < count; ++k) if (time[k]! < times[0] || time[k]! > times[1]) kept[k] = 0;
    if (!slice) return kept;
    const [low, high] = [slice.low - offset.getComponent(slice.axis), slice.high - offset.getComponent(slice.axis)];
    for (let k = 0, j = slice.axis; k < count; ++k, j += 3) if (position[j]! < low || position[j]! > high) kept[k] = 0;
    return kept;
  }

  /** Eye-dome lighting: a pixel is darker, the nearer the pixels on both sides of it are on average. */
  shade(step: number): void {
    const { colour, near, width, height } = this;
    const row = step * width;
    for (let y = step; y < height - step; ++y) {
      for (let at = y * width + step, end = (y + 1) * width - step; at < end; ++at) {
        const n = near[at]!;
        if (n === 0) continue;
        const across = (near[at - step] || n) + (near[at + step] || n) - 2 * n;
        const along = (near[at - row] || n) + (near[at + row] || n) - 2 * n;
        const dark = (across > 0 ? across : 0) + (along > 0 ? along : 0);
        if (dark < 0.001 * n) continue;
        const f = Math.max(DARKEST, n / (n + 0.5 * DOME * dark));
        const c = colour[at]!;
        colour[at] = (((c & 255) * f) | ((((c >> 8) & 255) * f) << 8) | ((((c >> 16) & 255) * f) << 16) | 0xff000000) >>> 0;
      }
    }
  }
}

const discs = new Map<number, Int32Array>();

/** The pixels of a disc, right of and above its lowest corner. */
function discOf(size: number): Int32Array {
  const known = discs.get(size);
  if (known) return known;
  const out: number[] = [];
  const square = size <= SQUARE_PIXELS;
  const n = square ? Math.max(1, Math.round(size)) : Math.ceil(size);
  for (let v = 0; v < n; ++v) {
    for (let u = 0; u < n; ++u) {
      const [x, y] = [(u + 0.5) / size - 0.5, (v + 0.5) / size - 0.5];
      if (square || x * x + y * y <= 0.25) out.push(u, v);
    }
  }
  const disc = Int32Array.from(out);
  discs.set(size, disc);
  return disc;
}
