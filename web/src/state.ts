// What a link restores: the view, what is shown, and how. It stands behind the # of the address.
import type { MapName } from './colours';
import type { PointMode, Slice, WorldMode } from './display';

export interface State {
  /** World coordinates, m, as `target`. */
  eye: [number, number, number] | null;
  target: [number, number, number] | null;
  /** Numbers of the files that are shown; null until some were chosen. */
  shown: number[] | null;
  points: PointMode;
  worlds: WorldMode;
  map: MapName;
  size: number;
  sigmas: number;
  opaque: boolean;
  slice: Slice;
  theme: 'dark' | 'light' | '';
}

export function initialState(): State {
  return {
    eye: null,
    target: null,
    shown: null,
    points: 'height',
    worlds: 'p',
    map: 'viridis',
    size: 2,
    sigmas: 1,
    opaque: false,
    slice: { on: false, axis: 'z', at: 0, thickness: 1 },
    theme: '',
  };
}

function isTriple(value: unknown): value is [number, number, number] {
  return Array.isArray(value) && value.length === 3 && value.every((v) => Number.isFinite(v));
}

/** Reads the part of an address behind #; whatever does not fit keeps its default. */
export function stateOf(hash: string): State {
  const state = initialState();
  try {
    const given = JSON.parse(decodeURIComponent(hash.replace(/^#/, '')) || '{}') as Partial<State>;
    if (isTriple(given.eye)) state.eye = given.eye;
    if (isTriple(given.target)) state.target = given.target;
    if (Array.isArray(given.shown)) state.shown = given.shown.filter((v) => Number.isInteger(v));
    const take = <K extends keyof State>(key: K) => {
      if (typeof given[key] === typeof state[key]) state[key] = given[key] as State[K];
    };
    (['points', 'worlds', 'map', 'size', 'sigmas', 'opaque', 'theme'] as const).forEach(take);
    if (given.slice && typeof given.slice === 'object') state.slice = { ...state.slice, ...given.slice };
  } catch {
    // not one of our links
  }
  return state;
}

export function hashOf(state: State): string {
  const round = (v: number) => Math.round(v * 1000) / 1000;
  const short = {
    ...state,
    slice: { ...state.slice, at: round(state.slice.at) },
    eye: state.eye?.map(round) ?? null,
    target: state.target?.map(round) ?? null,
  };
  return `#${encodeURIComponent(JSON.stringify(short))}`;
}
