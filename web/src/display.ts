// What all drawn things share: how they are coloured, cut by the slice, and drawn for picking.
import { ShaderMaterial, type Texture, Vector2, Vector3 } from 'three';
import { CLASS_COUNT, classColours, type MapName, mapTexture } from './colours';

export const POINT_MODES = ['height', 'intensity', 'time', 'ring', 'return', 'class', 'file', 'instance', 'error', 'packet error'] as const;
export type PointMode = (typeof POINT_MODES)[number];
export const WORLD_MODES = ['p', 'class', 'height', 'plain'] as const;
export type WorldMode = (typeof WORLD_MODES)[number];
export type Axis = 'x' | 'y' | 'z';

export interface Slice {
  on: boolean;
  axis: Axis;
  at: number;
  thickness: number;
}

/** What a fragment's colour means: a picture, the number of an object, or of its part. */
export const enum Pass {
  picture = 0,
  object = 1,
  part = 2,
}

/** Layers of the scene: things, points, and the quad that puts the picture of the points among the things. */
const THINGS = 0;
export const POINTS = 1;
export const QUAD = 2;
/** What a camera sees that draws points as they are, as the picker does, and one that sees their finished picture. */
export const PLAIN_MASK = (1 << THINGS) | (1 << POINTS);
export const PICTURE_MASK = (1 << THINGS) | (1 << QUAD);

interface Uniform<T> {
  value: T;
}

/** Uniforms that all materials share by reference. */
export class Display {
  readonly uniforms: {
    map: Uniform<Texture>;
    classes: Uniform<Texture>;
    heights: Uniform<Vector2>;
    sliceNormal: Uniform<Vector3>;
    sliceRange: Uniform<Vector2>;
    pass: Uniform<number>;
    object: Uniform<number>;
    worldMode: Uniform<number>;
  };

  constructor() {
    this.uniforms = {
      map: { value: mapTexture('earth') },
      classes: { value: classColours.texture },
      heights: { value: new Vector2(0, 10) },
      sliceNormal: { value: new Vector3(0, 0, 1) },
      sliceRange: { value: new Vector2(-1e30, 1e30) },
      pass: { value: Pass.picture },
      object: { value: 0 },
      worldMode: { value: 0 },
    };
  }

  /** Sets the colour map of elements. */
  setMap(name: MapName): void {
    this.uniforms.map.value.dispose();
    this.uniforms.map.value = mapTexture(name);
  }

  setSlice(slice: Slice): void {
    const normal = this.uniforms.sliceNormal.value;
    normal.set(Number(slice.axis === 'x'), Number(slice.axis === 'y'), Number(slice.axis === 'z'));
    const half = slice.thickness / 2;
    const range = this.uniforms.sliceRange.value;
    if (slice.on) range.set(slice.at - half, slice.at + half);
    else range.set(-1e30, 1e30);
  }
}

/** GLSL that fragments share. `place` is in the scene's frame. */
export const SHARED_GLSL = /* glsl */ `
  uniform sampler2D map;
  uniform sampler2D classes;
  uniform vec2 heights;
  uniform vec3 sliceNormal;
  uniform vec2 sliceRange;
  uniform int pass;
  uniform int object;
  bool sliced(vec3 place) {
    float d = dot(sliceNormal, place);
    return d < sliceRange.x || d > sliceRange.y;
  }
  vec3 mapped(float x) { return texture2D(map, vec2(clamp(x, 0.002, 0.998), 0.5)).rgb; }
  vec3 classColour(float label) {
    return texture2D(classes, vec2((mod(label, ${CLASS_COUNT}.0) + 0.5) / ${CLASS_COUNT}.0, 0.5)).rgb;
  }
  vec3 heightColour(vec3 place) { return mapped((place.z - heights.x) / max(heights.y - heights.x, 1e-3)); }
  vec4 bytesOf(int n) {
    return vec4(float(n & 255), float((n >> 8) & 255), float((n >> 16) & 255), float((n >> 24) & 255)) / 255.0;
  }
`;

/** A material with its own uniforms beside the shared ones. */
export function material(
  display: Display,
  own: Record<string, Uniform<unknown>>,
  vertexShader: string,
  fragmentShader: string,
): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { ...display.uniforms, ...own },
    vertexShader,
    fragmentShader: SHARED_GLSL + fragmentShader,
    toneMapped: false,
  });
}
