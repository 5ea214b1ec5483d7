// What a link restores: the view, what is shown, and how. It stands behind the # of the address.
import type { GivenEdits, PrimitiveEdit } from './api';
import { MAPS, type MapName } from './colours';
import { POINT_MODES, type PointMode, type Slice, WORLD_MODES, type WorldMode } from './display';
import { type Drawer, DRAWERS } from './points-layer';

export interface State {
  /** World coordinates, m, as `target`. */
  eye: [number, number, number] | null;
  target: [number, number, number] | null;
  /** Numbers of the files that are shown; null until some were chosen. */
  shown: number[] | null;
  points: PointMode;
  worlds: WorldMode;
  /** Colour maps of points and of elements. */
  map: MapName;
  elementMap: MapName;
  size: number;
  sigmas: number;
  opaque: boolean;
  /** Eye-dome lighting of points, and what draws them. */
  lighting: boolean;
  drawer: Drawer;
  legend: boolean;
  slice: Slice;
  theme: 'dark' | 'light' | '';
  edits: GivenEdits | null;
  /** Edits of the primitives of a file, and whether their table is open. */
  library: { file: number; open: boolean; edits: PrimitiveEdit[] } | null;
}

export function initialState(): State {
  return {
    eye: null,
    target: null,
    shown: null,
    points: 'height',
    worlds: 'p',
    map: 'viridis',
    elementMap: 'earth',
    size: 2,
    sigmas: 1,
    opaque: false,
    lighting: true,
    drawer: 'automatic',
    legend: true,
    slice: { on: false, axis: 'z', at: 0, thickness: 1 },
    theme: '',
    edits: null,
    library: null,
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
    (['size', 'sigmas', 'opaque', 'lighting', 'legend', 'theme'] as const).forEach(take);
    const choose = <K extends 'points' | 'worlds' | 'map' | 'elementMap' | 'drawer'>(key: K, words: readonly State[K][]) => {
      if (words.includes(given[key] as State[K])) state[key] = given[key] as State[K];
    };
    choose('points', POINT_MODES);
    choose('worlds', WORLD_MODES);
    choose('map', MAPS);
    choose('elementMap', MAPS);
    choose('drawer', DRAWERS);
    if (Number.isInteger(given.edits?.file) && Array.isArray(given.edits?.list?.edits)) state.edits = given.edits;
    if (Number.isInteger(given.library?.file) && Array.isArray(given.library?.edits)) state.library = given.library;
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
