// Animated PNGs with few colours, made of screenshots. Pixels that stay as they are are left out of a frame.
import { deflateSync, inflateSync } from 'node:zlib';

const SIGNATURE = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

function crcOf(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) c = TABLE[(c ^ byte) & 255] ^ (c >>> 8);
  return ~c >>> 0;
}

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, 'latin1'), data]);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crcOf(body), body.length + 4);
  return out;
}

const numbers = (...values) => {
  const out = Buffer.alloc(4 * values.length);
  values.forEach((v, k) => out.writeUInt32BE(v, 4 * k));
  return out;
};

/** Reads a PNG of 8 bits a channel, RGB or RGBA, that is not interlaced: {width, height, rgb}. */
export function decoded(png) {
  const parts = [];
  let [width, height, channels] = [0, 0, 3];
  for (let at = 8; at < png.length; ) {
    const size = png.readUInt32BE(at);
    const name = png.toString('latin1', at + 4, at + 8);
    const data = png.subarray(at + 8, at + 8 + size);
    if (name === 'IHDR') {
      [width, height] = [data.readUInt32BE(0), data.readUInt32BE(4)];
      if (data[8] !== 8 || (data[9] !== 2 && data[9] !== 6) || data[12] !== 0) throw new Error('another kind of PNG');
      channels = data[9] === 6 ? 4 : 3;
    }
    if (name === 'IDAT') parts.push(data);
    at += 12 + size;
  }
  const raw = inflateSync(Buffer.concat(parts));
  const step = width * channels;
  const lines = Buffer.alloc(step * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (step + 1)];
    for (let x = 0; x < step; ++x) {
      const left = x >= channels ? lines[y * step + x - channels] : 0;
      const up = y > 0 ? lines[(y - 1) * step + x] : 0;
      const corner = x >= channels && y > 0 ? lines[(y - 1) * step + x - channels] : 0;
      const p = left + up - corner;
      const [a, b, c] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      const by = [0, left, up, (left + up) >> 1, paeth][filter];
      lines[y * step + x] = raw[y * (step + 1) + 1 + x] + by;
    }
  }
  const rgb = Buffer.alloc(3 * width * height);
  for (let k = 0; k < width * height; ++k) lines.copy(rgb, 3 * k, channels * k, channels * k + 3);
  return { width, height, rgb };
}

/** The colours that occur most often, at most `most`, and which of them comes nearest to a colour. */
function paletteOf(frames, most) {
  const count = new Map();
  const key = (r, g, b) => ((r >> 3) << 10) | ((g >> 3) << 5) | (b >> 3);
  for (const { rgb } of frames) {
    for (let k = 0; k < rgb.length; k += 3) {
      const found = count.get(key(rgb[k], rgb[k + 1], rgb[k + 2]));
      if (found) ++found.n;
      else count.set(key(rgb[k], rgb[k + 1], rgb[k + 2]), { n: 1, colour: [rgb[k], rgb[k + 1], rgb[k + 2]] });
    }
  }
  const colours = [...count.values()].sort((a, b) => b.n - a.n).slice(0, most).map((c) => c.colour);
  const known = new Map();
  const nearest = (r, g, b) => {
    const at = key(r, g, b);
    if (known.has(at)) return known.get(at);
    let [best, least] = [0, Infinity];
    colours.forEach(([R, G, B], k) => {
      const off = 2 * (R - r) ** 2 + 4 * (G - g) ** 2 + 3 * (B - b) ** 2;
      if (off < least) [best, least] = [k, off];
    });
    known.set(at, best);
    return best;
  };
  return { colours, nearest };
}

/** The pixels of a frame as numbers of colours, from 1 on, in lines that begin with their filter; 0 where `last` is equal. */
function linesOf({ width, height, rgb }, nearest, last) {
  const out = Buffer.alloc((width + 1) * height);
  const full = Buffer.alloc(width * height);
  for (let k = 0; k < width * height; ++k) {
    full[k] = 1 + nearest(rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2]);
    out[k + Math.floor(k / width) + 1] = last && last[k] === full[k] ? 0 : full[k];
  }
  return { out, full };
}

/** An animated PNG of screenshots, each with the time (ms) that it is shown; a single one is an ordinary PNG. */
export function animated(shots, most = 127) {
  const frames = shots.map((shot) => ({ ...decoded(shot.png), ms: shot.ms }));
  const { width, height } = frames[0];
  const { colours, nearest } = paletteOf(frames, most);
  const header = Buffer.concat([numbers(width, height), Buffer.from([8, 3, 0, 0, 0])]);
  const parts = [SIGNATURE, chunk('IHDR', header)];
  if (frames.length > 1) parts.push(chunk('acTL', numbers(frames.length, 0)));
  parts.push(chunk('PLTE', Buffer.from([0, 0, 0, ...colours.flat()])), chunk('tRNS', Buffer.from([0])));
  let [number, last] = [0, null];
  frames.forEach((frame, k) => {
    const { out, full } = linesOf(frame, nearest, last);
    last = full;
    if (frames.length > 1) {
      const time = Buffer.alloc(6);
      time.writeUInt16BE(frame.ms, 0);
      time.writeUInt16BE(1000, 2);
      time[5] = k > 0 ? 1 : 0; // laid over the frame before
      parts.push(chunk('fcTL', Buffer.concat([numbers(number++, width, height, 0, 0), time])));
    }
    const data = deflateSync(out, { level: 9 });
    parts.push(k === 0 ? chunk('IDAT', data) : chunk('fdAT', Buffer.concat([numbers(number++), data])));
  });
  return Buffer.concat([...parts, chunk('IEND', Buffer.alloc(0))]);
}
