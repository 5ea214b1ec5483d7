// The octree of a log, as docs/reference/octree.md lays it out.
import { Box3, Vector3 } from 'three';
import { bytes, json, octreeBytes, type OctreeFacts, type OctreeState, type Triple } from './api';
import { coreOf } from './unpack';

const NODE_BYTES = 24;
const RUN_BYTES = 32;
const POINT_BYTES = 29;
const PART_BYTES = 8 << 20;
const FIRST_WAIT_MS = 50;
const PREVIEW_BYTES = 32;

export interface Node {
  /** Row of the table of nodes. */
  index: number;
  at: number;
  points: number;
  level: number;
  children: Node[];
  /** The columns of its points, where they are there from the start. */
  data?: ArrayBuffer;
  /** Relative to the octree's origin, m. */
  box: Box3;
}

/** A scan, or a part of one. */
export interface Run {
  firstRow: number;
  rows: number;
  scan: number;
  time: number;
}

/** Columns of a node's points. */
export interface Points {
  count: number;
  position: Float32Array;
  intensity: Float32Array;
  time: Float32Array;
  row: Uint32Array;
  /** The row's bytes, which picking draws as a colour. */
  rowBytes: Uint8Array;
  ring: Uint16Array;
  label: Uint16Array;
  echo: Uint8Array;
}

export interface Octree {
  file: number;
  facts: OctreeFacts;
  root: Node;
  nodes: number;
  runs: Run[];
}

async function table(file: number, at: number, count: number): Promise<DataView> {
  const out = new Uint8Array(count);
  for (let done = 0; done < count; done += PART_BYTES) {
    const n = Math.min(PART_BYTES, count - done);
    out.set(new Uint8Array(await octreeBytes(file, at + done, n)), done);
  }
  return new DataView(out.buffer);
}

function treeOf(view: DataView, count: number, facts: OctreeFacts): Node {
  const low = new Vector3(...facts.root_low_m);
  const side = new Vector3(facts.root_side_m, facts.root_side_m, facts.root_side_m);
  const nodes: Node[] = [];
  for (let k = 0; k < count; ++k) {
    nodes.push({
      index: k,
      at: Number(view.getBigUint64(k * NODE_BYTES, true)),
      points: view.getUint32(k * NODE_BYTES + 8, true),
      level: view.getUint8(k * NODE_BYTES + 17),
      children: [],
      box: new Box3(low.clone(), low.clone().add(side)),
    });
  }
  for (let k = 0; k < count; ++k) {
    const node = nodes[k]!;
    let child = view.getUint32(k * NODE_BYTES + 12, true);
    const mask = view.getUint8(k * NODE_BYTES + 16);
    const half = node.box.max.clone().sub(node.box.min).multiplyScalar(0.5);
    for (let octant = 0; octant < 8; ++octant) {
      if (!((mask >> octant) & 1)) continue;
      const one = nodes[child++]!;
      const bits = new Vector3(octant & 1, (octant >> 1) & 1, octant >> 2);
      one.box.min.copy(node.box.min).add(bits.multiply(half));
      one.box.max.copy(one.box.min).add(half);
      node.children.push(one);
    }
  }
  return nodes[0]!;
}

function runsOf(view: DataView, count: number): Run[] {
  const runs: Run[] = [];
  for (let k = 0; k < count; ++k) {
    runs.push({
      firstRow: Number(view.getBigUint64(k * RUN_BYTES, true)),
      rows: view.getUint32(k * RUN_BYTES + 16, true),
      scan: view.getUint32(k * RUN_BYTES + 20, true),
      time: view.getFloat64(k * RUN_BYTES + 24, true),
    });
  }
  return runs;
}

/**
 * Waits for the octree of a log; `tell` learns the share that is built. `preview` shows the log until then: it ends before
 * the octree is begun, which needs the whole machine.
 */
export async function openOctree(file: number, tell: (done: number) => void, preview: () => Promise<void>): Promise<Octree> {
  const { state } = await json<OctreeState>(`octree?file=${file}&build=0`);
  const previewed = state === 'ready' || preview();
  if (state === 'absent') await previewed;
  for (let wait = FIRST_WAIT_MS; ; wait = Math.min(wait * 1.5, 1000)) {
    const state = await json<OctreeState>(`octree?file=${file}`);
    if (state.state === 'absent') continue;
    if (state.state === 'failed') throw new Error(state.error);
    if (state.state === 'ready') {
      const nodes = await table(file, state.nodes_at, state.nodes * NODE_BYTES);
      const runs = await table(file, state.runs_at, state.runs * RUN_BYTES);
      return {
        file,
        facts: state.octree,
        root: treeOf(nodes, state.nodes, state.octree),
        nodes: state.nodes,
        runs: runsOf(runs, state.runs),
      };
    }
    tell(state.done);
    await new Promise((resolve) => setTimeout(resolve, wait));
  }
}

export async function loadPoints(file: number, node: Node): Promise<Points> {
  const n = node.points;
  const data = node.data ?? (n > 0 ? await octreeBytes(file, node.at, n * POINT_BYTES) : new ArrayBuffer(0));
  return {
    count: n,
    position: new Float32Array(data, 0, 3 * n),
    intensity: new Float32Array(data, 12 * n, n),
    time: new Float32Array(data, 16 * n, n),
    row: new Uint32Array(data, 20 * n, n),
    rowBytes: new Uint8Array(data, 20 * n, 4 * n),
    ring: new Uint16Array(data, 24 * n, n),
    label: new Uint16Array(data, 26 * n, n),
    echo: new Uint8Array(data, 28 * n, n),
  };
}

/** A sample of a log as an octree of one node, or null where there is none. */
export async function openPreview(file: number): Promise<Octree | null> {
  const reply = await bytes(`preview?file=${file}`).catch(() => null);
  if (!reply) return null;
  const count = new Uint32Array(reply, 0, 1)[0]!;
  if (count === 0) return null;
  const origin = [...new Float64Array(reply, 8, 3)] as Triple;
  const root: Node = { index: 0, at: 0, points: count, level: 0, children: [], box: new Box3(), data: reply.slice(PREVIEW_BYTES) };
  const { position, intensity, time, ring, echo } = await loadPoints(file, root);
  const most = (values: ArrayLike<number>) => Array.prototype.reduce.call(values, (a, b) => Math.max(a as number, b as number), 0) as number;
  const core = coreOf(position);
  root.box.setFromArray(position);
  const low = root.box.min.toArray();
  position.forEach((v, k) => (position[k] = v - low[k % 3]!)); // as in a node
  const facts: OctreeFacts = {
    rows: 0,
    beams: 0,
    points: count,
    origin_m: origin,
    root_low_m: [0, 0, 0],
    root_side_m: 0,
    low_m: core.min.toArray(),
    high_m: core.max.toArray(),
    first_time_s: 0,
    last_time_s: most(time),
    intensity: [0, most(intensity)],
    most_ring: most(ring),
    most_echo: most(echo),
    labels: [],
  };
  return { file, facts, root, nodes: 1, runs: [] };
}
