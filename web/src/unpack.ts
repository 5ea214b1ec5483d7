// Records of fixed size in binary answers, read column by column.

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
