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
  ends_at: number | null;
  met_in_all: number;
  miss_probability: number;
  met: Met[];
}

async function reply(path: string, headers: Record<string, string> = {}): Promise<Response> {
  const response = await fetch(`./api/${path}`, { headers });
  if (response.ok) return response;
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
