// The colours of points, computed once for each node of an octree and kept until how they are coloured changes.
import { CLASS_COUNT, classColours, type MapName, mapColours } from './colours';
import type { PointMode } from './display';
import type { Points } from './octree';

/** How the points of a log are coloured. */
export interface Paint {
  mode: PointMode;
  map: MapName;
  /** Heights of the ends of the map, m, in the frame of the node's heights. */
  heights: [number, number];
  intensities: [number, number];
  /** Seconds from the first to the last point. */
  span: number;
  rings: number;
  file: number;
  /** Classes that are not drawn, of those that people edit. */
  hidden: Set<number>;
}

/** What belongs to a node beside its points. */
export interface Extra {
  /** Class and selection, then the instance in three bytes, of each point; null where nobody edits. */
  marks: Uint8Array | null;
  /** Two errors of each point; null before they are known. */
  errors: Float32Array | null;
}

const NO_ERROR = 1e8; // and more where the other log has no hit
const ORANGE = 0xff005ed6; // as bytes blue, green, red behind the opacity
const words = (bytes: Uint8Array) => new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);

/** Between a colour and the one of a selection. */
function chosen(colour: number): number {
  const part = (shift: number, to: number) => Math.round(0.2 * ((colour >> shift) & 255) + 0.8 * to) << shift;
  return (0xff000000 | part(0, 255) | part(8, 89) | part(16, 191)) >>> 0;
}

/** The quantity of each point from 0 to 1, for the modes that have a colour map. */
function quantity(points: Points, extra: Extra, paint: Paint): ((k: number) => number) | null {
  const share = (values: ArrayLike<number>, low: number, high: number) => {
    const scale = 1 / Math.max(high - low, 1e-6);
    return (k: number) => (values[k]! - low) * scale;
  };
  const { position, intensity, time, ring } = points;
  if (paint.mode === 'height') {
    const [low, high] = paint.heights;
    const scale = 1 / Math.max(high - low, 1e-3);
    return (k) => (position[3 * k + 2]! - low) * scale;
  }
  if (paint.mode === 'intensity') return share(intensity, ...paint.intensities);
  if (paint.mode === 'time') return share(time, 0, paint.span);
  if (paint.mode === 'ring') return share(ring, 0, Math.max(paint.rings, 1));
  if (paint.mode !== 'error' && paint.mode !== 'packet error') return null;
  const { errors } = extra;
  const which = paint.mode === 'error' ? 0 : 1;
  return (k) => (errors ? Math.sqrt(Math.min(1, Math.abs(errors[2 * k + which]!))) : 0);
}

/** The number of the class colour of each point, for the other modes. */
function kindOf(points: Points, { marks }: Extra, paint: Paint): (k: number) => number {
  if (paint.mode === 'return') return (k) => points.echo[k]!;
  if (paint.mode === 'file') return () => paint.file + 1;
  if (paint.mode === 'instance') {
    if (!marks) return () => 0;
    const number = (k: number) => marks[4 * k + 1]! + 256 * marks[4 * k + 2]! + 65536 * marks[4 * k + 3]!;
    return (k) => (number(k) === 0 ? 0 : 1 + ((number(k) * 5) % 14));
  }
  return marks ? (k) => marks[4 * k]! % 128 : (k) => points.label[k]!;
}

/** Fills `out` with the colours of a node's points as red, green, blue and opacity: 0 where a point is not drawn. */
export function paintPoints(points: Points, extra: Extra, paint: Paint, out: Uint32Array): void {
  const value = quantity(points, extra, paint);
  if (value) {
    const colours = words(mapColours(paint.map));
    for (let k = 0; k < points.count; ++k) out[k] = colours[Math.min(255, Math.max(0, Math.round(255 * value(k))))]!;
    const { errors } = extra;
    const which = paint.mode === 'error' ? 0 : paint.mode === 'packet error' ? 1 : -1;
    if (errors && which >= 0) {
      for (let k = 0; k < points.count; ++k) if (Math.abs(errors[2 * k + which]!) > NO_ERROR) out[k] = ORANGE;
    }
  } else {
    const kind = kindOf(points, extra, paint);
    const colours = words(classColours.texture.image.data as Uint8Array);
    for (let k = 0; k < points.count; ++k) out[k] = colours[kind(k) % CLASS_COUNT]!;
  }
  const { marks } = extra;
  if (!marks) return;
  for (let k = 0; k < points.count; ++k) {
    if (paint.hidden.has(marks[4 * k]! % 128)) out[k] = 0;
    else if (marks[4 * k]! >= 128) out[k] = chosen(out[k]!);
  }
}
