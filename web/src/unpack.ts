// Records of fixed size in binary answers, read column by column, and where most of what they hold lies.
import { Box3 } from 'three';

/** Reads `width` float32 of each record, from byte `at` of the record on. */
export function floatColumn(
  view: DataView,
  records: { start: number; bytes: number; count: number },
  at: number,
  width: number,
): Float32Array {
  const out = new Float32Array(width * records.count);
  for (let i = 0; i < records.count; ++i) {
    const from = records.start + i * records.bytes + at;
    for (let k = 0; k < width; ++k) out[width * i + k] = view.getFloat32(from + 4 * k, true);
  }
  return out;
}

/** Reads one uint32 of each record. */
export function numberColumn(
  view: DataView,
  records: { start: number; bytes: number; count: number },
  at: number,
): Uint32Array {
  const out = new Uint32Array(records.count);
  for (let i = 0; i < records.count; ++i) out[i] = view.getUint32(records.start + i * records.bytes + at, true);
  return out;
}

/** Each value twice, for the two ends of a line. */
export function twice(values: Uint32Array): Uint32Array {
  const out = new Uint32Array(2 * values.length);
  values.forEach((v, i) => out.fill(v, 2 * i, 2 * i + 2));
  return out;
}

/** The values below which 2 % and 98 % of the values lie. */
export function shares(values: Float32Array): [number, number] {
  const sorted = Float32Array.from(values).sort();
  const at = (q: number) => sorted[Math.floor(q * (sorted.length - 1))]!;
  return [at(0.02), at(0.98)];
}

/** Where most of some places lie: all but the outermost 2 % along each axis. Of many, some are looked at. */
export function coreOf(places: Float32Array): Box3 {
  const box = new Box3();
  const n = places.length / 3;
  if (n === 0) return box;
  const step = Math.ceil(n / 20_000);
  for (let axis = 0; axis < 3; ++axis) {
    const [low, high] = shares(Float32Array.from({ length: Math.ceil(n / step) }, (_, k) => places[3 * k * step + axis]!));
    box.min.setComponent(axis, low);
    box.max.setComponent(axis, high);
  }
  return box;
}
