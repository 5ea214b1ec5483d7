// Colour maps that colour-blind people can read: viridis and cividis for numbers of points, earth for those of
// elements, and colours for classes that differ for all eyes.
import { DataTexture, LinearFilter, NearestFilter, RGBAFormat } from 'three';

export const MAPS = ['viridis', 'cividis', 'earth', 'grey'] as const;
export type MapName = (typeof MAPS)[number];

// Values at equal steps from 0 to 1, as hexadecimal RGB.
const STOPS: Record<MapName, string> = {
  viridis:
    '440154 481a6c 472f7d 414487 39568c 31688e 2a788e 23888e 1f988b 22a884 35b779 54c568 7ad151 a5db36 d2e21b fde725',
  cividis:
    '00224e 002e6c 1a386f 31446b 434e6c 53596d 61646f 707073 7d7c78 8c8878 9b9476 aba074 bcad6e cdba66 dec958 fee838',
  earth: '46332a 5e4030 785038 976445 b67a53 d19468 e6b286 f5d3ad',
  grey: '202020 e8e8e8',
};

// The colours of Okabe and Ito, then each the farthest from all before it in OKLab, for normal eyes, deuteranopes and
// protanopes.
const CLASS_COLOURS = (
  '707070 0072b2 e69f00 009e73 f0e442 56b4e9 d55e00 cc79a7 770066 0000cc 44ffee 005500 cc00ff 77cc88 554499 aa0033 ' +
  'aa77ee bbccff 00ff99 dd00bb dd0044 bbaabb 774466 5500ee ff5555 995500 aa4499 99ddcc 551199 99aa88 aadd66 7766dd'
).split(' ');
/** Numbers of classes that the texture has room for. */
export const CLASS_COUNT = 512;

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

/** The stops of a map as a CSS gradient from left to right; `at` moves a stop from its share of the way. */
export function mapCss(name: MapName, at: (share: number) => number = (share) => share): string {
  const stops = STOPS[name].split(' ');
  const placed = stops.map((hex, k) => `#${hex} ${(100 * at(k / (stops.length - 1))).toFixed(1)}%`);
  return `linear-gradient(to right, ${placed.join(', ')})`;
}

/** Gives each class a colour. Small numbers have fixed ones; greater numbers get those that no class has yet. */
export class ClassColours {
  readonly texture = new DataTexture(new Uint8Array(4 * CLASS_COUNT), CLASS_COUNT, 1, RGBAFormat);
  private readonly places = new Map<number, number>();

  constructor() {
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    for (let label = 0; label < CLASS_COUNT; ++label) this.paint(label);
  }

  /** Makes sure that these classes have colours that differ, as far as there are so many. */
  add(labels: number[]): void {
    for (const label of labels) {
      if (this.places.has(label)) continue;
      this.places.set(label, this.freePlace(label));
      this.paint(label);
    }
  }

  css(label: number): string {
    return `#${this.hex(label)}`;
  }

  private freePlace(label: number): number {
    const n = CLASS_COLOURS.length;
    if (label < n) return label;
    const taken = new Set(this.places.values());
    for (let place = n - 1; place > 0; --place) if (!taken.has(place)) return place;
    return label % n;
  }

  private hex(label: number): string {
    return CLASS_COLOURS[this.places.get(label) ?? label % CLASS_COLOURS.length]!;
  }

  private paint(label: number): void {
    (this.texture.image.data as Uint8Array).set([...rgb(this.hex(label)), 255], 4 * (label % CLASS_COUNT));
    this.texture.needsUpdate = true;
  }
}

export const classColours = new ClassColours();
