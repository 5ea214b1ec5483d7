// The labels of a log as the server keeps them: changes are sent one after the other, and what they
// touch is fetched anew.
import { bytes, Conflict, json, post, query } from './api';
import type { Cloud, Marks } from './cloud';
import type { Node } from './octree';
import { root } from './panel';

export interface LabelClass {
  number: number;
  name: string;
  points: number;
}

/** A box in world coordinates: its foot, heading, and extent in its own frame. */
export interface LabelBox {
  number: number;
  class: string;
  position_m: [number, number, number];
  yaw_rad: number;
  min_m: [number, number, number];
  max_m: [number, number, number];
  primitive?: { file: number; model: number };
  /** What moves has a box in each scan. */
  track?: number;
  scan?: number;
}

export interface LabelState {
  revision: number;
  undos: number;
  redos: number;
  /** Names of what undo takes back and redo applies again; empty without one. */
  last: string;
  next: string;
  set: string;
  journal: string;
  lost_bytes: number;
  selected: number;
  next_instance: number;
  classes: LabelClass[];
  nodes: number[];
  boxes: LabelBox[];
}

export interface EditReply {
  revision: number;
  rows: number;
  instance: number;
}

export type Change = Parameters<typeof post>[1];

const MOST_POINTS = 2_000_000; // of one request
const MOST_NODES = 500;

/** The labels of a file. `cloud` is null for a model, which has boxes only. */
export class Labelled implements Marks {
  state: LabelState | null = null;
  /** Changes that are on their way. */
  pending = 0;
  /** Why the last change was not kept, or ''. */
  trouble = '';
  private queue: Promise<unknown> = Promise.resolve();
  private wanted = new Set<Node>();
  private fetching = false;

  private static readonly all = new Set<Labelled>();

  constructor(
    readonly file: number,
    readonly cloud: Cloud | null,
    private readonly tell: () => void,
  ) {
    Labelled.all.add(this);
  }

  private changed(): void {
    const all = [...Labelled.all];
    root.dataset.saved = all.some((l) => l.trouble) ? 'no' : all.some((l) => l.loading) ? 'soon' : 'yes';
    this.tell();
  }

  /** Forgets the labels of a log that is labelled no longer. */
  close(): void {
    this.cloud?.setMarksFrom(null);
    Labelled.all.delete(this);
  }

  async open(): Promise<void> {
    this.state = await json<LabelState>(`labels?file=${this.file}`);
    this.cloud?.setMarksFrom(this);
    this.changed();
  }

  classes(): { number: number; name: string }[] {
    return (this.state?.classes ?? []).map(({ name, points }, number) => ({ number, name, points })).filter((c) => c.points > 0);
  }

  /** Whether labels of points in view are still on their way. */
  get loading(): boolean {
    return this.fetching || this.wanted.size > 0 || this.pending > 0;
  }

  /** Fetches what changed since the last known state. */
  async sync(): Promise<void> {
    const known = this.state?.revision ?? 0;
    const next = await json<LabelState>(`labels?file=${this.file}&since=${known}`);
    this.state = next;
    if (this.cloud) this.need(this.cloud.nodesInMemory(new Set(next.nodes)));
    this.changed();
  }

  /**
   * Sends a change once all before it were answered. If another window changed the labels meanwhile, what it did is
   * fetched, and a change that may be repeated on top of it is.
   */
  send<T>(path: string, change: Change, repeat: boolean): Promise<T> {
    ++this.pending;
    this.changed();
    const work = this.queue.then(() => this.sent<T>(path, change, repeat));
    this.queue = work.catch(() => {});
    return work.finally(() => {
      --this.pending;
      this.changed();
    });
  }

  private async sent<T>(path: string, change: Change, repeat: boolean): Promise<T> {
    try {
      const ask = () => post<T>(`labels/${path}`, { file: this.file, revision: this.state!.revision, ...change });
      const reply = await ask().catch(async (error: unknown) => {
        if (!(error instanceof Conflict)) throw error;
        await this.sync();
        if (!repeat) throw new Error('Another window changed the labels: look at what it did, then try again');
        return ask();
      });
      await this.sync();
      this.trouble = '';
      return reply;
    } catch (error) {
      this.trouble = error instanceof TypeError ? 'the program does not answer' : String((error as Error).message);
      throw error;
    }
  }

  edit(change: Change): Promise<EditReply> {
    return this.send<EditReply>('edit', change, true);
  }

  need(nodes: Node[]): void {
    nodes.forEach((node) => this.wanted.add(node));
    if (!this.fetching && this.wanted.size > 0) void this.fetchMarks();
  }

  private async fetchMarks(): Promise<void> {
    this.fetching = true;
    try {
      while (this.wanted.size > 0) {
        await Promise.resolve(); // so that nodes that arrive together are asked for together
        const nodes: Node[] = [];
        let points = 0;
        for (const node of this.wanted) {
          if (nodes.length >= MOST_NODES || (points > 0 && points + node.points > MOST_POINTS)) break;
          nodes.push(node);
          points += node.points;
          this.wanted.delete(node);
        }
        const data = await bytes(`labels/data?${query({ file: this.file, nodes: nodes.map((n) => n.index) })}`);
        let at = 0;
        for (const node of nodes) {
          this.cloud!.setMarks(node, new Uint8Array(data, at, 4 * node.points));
          at += 4 * node.points;
        }
      }
    } catch (error) {
      this.trouble = String(error);
    }
    this.fetching = false;
    this.changed();
  }
}
