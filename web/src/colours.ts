// Colour maps that colour-blind people can read: viridis and cividis for numbers, the colours of
// Okabe and Ito for classes.
import { DataTexture, LinearFilter, NearestFilter, RepeatWrapping, RGBAFormat } from 'three';

export type MapName = 'viridis' | 'cividis' | 'grey';

// Values at equal steps from 0 to 1, as hexadecimal RGB.
const STOPS: Record<MapName, string> = {
  viridis:
    '440154 481a6c 472f7d 414487 39568c 31688e 2a788e 23888e 1f988b 22a884 35b779 54c568 7ad151 a5db36 d2e21b fde725',
  cividis:
    '00224e 002e6c 1a386f 31446b 434e6c 53596d 61646f 707073 7d7c78 8c8878 9b9476 aba074 bcad6e cdba66 dec958 fee838',
  grey: '202020 e8e8e8',
};

// Okabe and Ito, then the same lighter and darker.
const CLASS_COLOURS =
  '999999 0072b2 e69f00 009e73 f0e442 56b4e9 d55e00 cc79a7 80b9d9 f3cf80 80cfb9 f8f2a1 abdaf4 eaaf80 e6bcd3 00395a'.split(
    ' ',
  );

function rgb(hex: string): [number, number, number] {
  const v = parseInt(hex, 16);
  return [v >> 16, (v >> 8) & 255, v & 255];
}

/** The 256 colours of a map, as red, green, blue and 255. */
export function mapColours(name: MapName): Uint8Array<ArrayBuffer> {
  const stops = STOPS[name].split(' ').map(rgb);
  const data = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1);
    const k = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; ++c) {
      const a = stops[k]![c]!;
      data[4 * i + c] = Math.round(a + (at - k) * (stops[k + 1]![c]! - a));
    }
    data[4 * i + 3] = 255;
  }
  return data;
}

export function mapTexture(name: MapName): DataTexture {
  const texture = new DataTexture(mapColours(name), 256, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function classTexture(): DataTexture {
  const n = CLASS_COLOURS.length;
  const data = new Uint8Array(n * 4);
  CLASS_COLOURS.forEach((hex, i) => data.set([...rgb(hex), 255], 4 * i));
  const texture = new DataTexture(data, n, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.wrapS = RepeatWrapping;
  texture.needsUpdate = true;
  return texture;
}

export const CLASS_COUNT = CLASS_COLOURS.length;

export function classCss(label: number): string {
  return `#${CLASS_COLOURS[label % CLASS_COUNT]!}`;
}
