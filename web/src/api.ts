// Requests to the server. Addresses are relative to the page's, which holds the token.

export type FileKind = 'log' | 'model' | 'primitives' | 'scene' | 'score';
export type Triple = [number, number, number];

export interface ServedFile {
  id: number;
  name: string;
  kind: FileKind;
}

export interface FileList {
  program: string;
  files: ServedFile[];
  notes: string[];
  seed: number;
  /** Names of the sensors of the catalogue. */
  sensors: string[];
  /** Whether labels can be edited, and commands be started. */
  labels: boolean;
  jobs: boolean;
  /** The list of edits that the server was started with. */
  edits?: GivenEdits;
}

export interface OctreeFacts {
  rows: number;
  beams: number;
  points: number;
  origin_m: Triple;
  root_low_m: Triple;
  root_side_m: number;
  low_m: Triple;
  high_m: Triple;
  first_time_s: number;
  last_time_s: number;
  intensity: [number, number];
  most_ring: number;
  most_echo: number;
  labels: { number: number; name: string; points: number }[];
}

export type OctreeState =
  | { state: 'absent' }
  | { state: 'building'; done: number }
  | { state: 'failed'; error: string }
  | {
      state: 'ready';
      bytes: number;
      nodes_at: number;
      nodes: number;
      runs_at: number;
      runs: number;
      octree: OctreeFacts;
    };

export interface WorldFacts {
  kind: FileKind;
  origin_m: Triple;
  models: {
    name: string;
    fitter: string;
    tau: number;
    ellipsoids: number;
    ground_triangles: number;
    surface_triangles: number;
    /** Of a primitive, in its own frame. */
    class?: string;
    box_m?: { min: Triple; max: Triple };
  }[];
  instances: {
    model: number;
    class: string;
    at_m: Triple;
    rotation_wxyz: [number, number, number, number];
    scale: number;
    moves: boolean;
  }[];
  classes: string[];
}

/** A pose: time (s), place relative to the world's origin (m), and a quaternion w x y z. */
export type TimedPose = [number, number, number, number, number, number, number, number];

/** What moves as one model for a while; null = without an end. */
export interface ActorPart {
  instance: number;
  from_s: number | null;
  to_s: number | null;
  poses: TimedPose[];
}

export interface Actor {
  name: string;
  class: string;
  /** What it was learnt from, where that is known. */
  returns: number | null;
  scans: number | null;
  parts: ActorPart[];
}

/** One of the edits of share/schemas/actor-edits.json that name no file. */
export interface ActorEdit {
  edit: 'remove' | 'move' | 'shift' | 'delay' | 'copy';
  actor: string;
  translation_m?: Triple;
  yaw_rad?: number;
  at_s?: number;
  within_s?: number;
  by_s?: number;
  as?: string;
}

/** The content of a file of edits (share/schemas/actor-edits.json). */
export interface EditList {
  actors: string;
  edits: ActorEdit[];
}

/** Edits of the actors of a file. */
export interface GivenEdits {
  file: number;
  list: EditList;
}

/** What is told of a primitive of a set. */
export interface PrimitiveFacts {
  /** Its folder in the set, CLASS/NUMBER. */
  folder: string;
  /** The name that a person gave it, or ''. */
  name: string;
  class: string;
  height_m: number;
  width_m: number;
  points: number;
  elements: number;
  /** Where it comes from; '' where that is not known. */
  set: string;
  site: string;
  season: string;
  sensor: string;
  license: string;
}

export interface PrimitiveSetFacts {
  /** The hash by which edits name the set. */
  set: string;
  most_name_bytes: number;
  classes: { name: string; kind: string; may_become: string[] }[];
  primitives: PrimitiveFacts[];
}

/** An edit of share/schemas/primitive-edits.json. */
export interface PrimitiveEdit {
  primitive: string;
  remove?: true;
  class?: string;
  name?: string;
}

export interface Beam {
  row: number;
  beam: number;
  hit: boolean;
  inferred: boolean;
  range_m: number | null;
  origin_m: Triple;
  direction: Triple;
  end_m: Triple;
  intensity: number;
  time_s: number;
  ring: number;
  scan: number;
  packet: number;
  columns?: Record<string, number>;
  echoes_m: number[];
}

export interface Met {
  range_m: number;
  sigma_m: number;
  distance: number;
  p: number;
  draw: number;
  accepts: boolean;
  reach: number;
  kind: 'ground' | 'surface' | 'ellipsoid';
  index: number;
  instance: number;
  class: string;
  hits: number;
  misses: number;
}

export interface Trace {
  row: number;
  beam: number;
  seed: number;
  real_range_m: number | null;
  simulated_range_m: number | null;
  /** The probability that the beam ends in space that no beam of the log crossed. */
  unknown_probability: number;
  ends_by: 'element' | 'keyframe' | 'unknown space' | 'miss';
  ends_at: number | null;
  met_in_all: number;
  miss_probability: number;
  met: Met[];
}

/** What an instrument receives of a beam. */
export interface BeamEchoes {
  sensor: string;
  seed: number;
  sub_rays: number;
  /** In units of the noise in the dark, as `signal`. */
  threshold: number;
  range_m: number[];
  signal: number[];
  echoes: ({ range_m: number; intensity: number } & Record<string, number>)[];
}

/** The labels were changed elsewhere; `revision` is the present one. */
export class Conflict extends Error {
  constructor(readonly revision: number) {
    super('the labels were changed in another window');
  }
}

async function reply(path: string, headers: Record<string, string> = {}, method = 'GET'): Promise<Response> {
  const response = await fetch(`./api/${path}`, { headers, method });
  if (response.ok) return response;
  if (response.status === 409) throw new Conflict(((await response.json()) as { revision: number }).revision);
  let reason = `${response.status}`;
  try {
    reason = ((await response.json()) as { error: string }).error;
  } catch {
    // not from the server's own code
  }
  throw new Error(reason);
}

export async function json<T>(path: string): Promise<T> {
  return (await (await reply(path)).json()) as T;
}

export async function bytes(path: string): Promise<ArrayBuffer> {
  return (await reply(path)).arrayBuffer();
}

/** Bytes [at, at + count) of the octree of a log. */
export async function octreeBytes(file: number, at: number, count: number): Promise<ArrayBuffer> {
  const range = `bytes=${at}-${at + count - 1}`;
  return (await reply(`octree/data?file=${file}`, { Range: range })).arrayBuffer();
}

/** The most characters of a list of edits in a request, whose address has 8 KiB. */
export const MOST_EDIT_TEXT = 7500;

type Parameter = string | number | boolean | readonly number[] | null | undefined;

/** The parameters of a request; those without a value are left out. */
export function query(parameters: Record<string, Parameter>): string {
  const parts = Object.entries(parameters)
    .filter(([, value]) => value !== null && value !== undefined && value !== '' && value !== false)
    .filter(([, value]) => !Array.isArray(value) || value.length > 0)
    .map(([key, value]) => `${key}=${encodeURIComponent(value === true ? '1' : String(value)).replaceAll('%2C', ',')}`);
  return parts.join('&');
}

/** Asks for a change. Throws `Conflict` where it was made for an older state. */
export async function post<T>(path: string, parameters: Record<string, Parameter>): Promise<T> {
  return (await (await reply(`${path}?${query(parameters)}`, {}, 'POST')).json()) as T;
}
