// Edits of the primitives of a set: what is thrown out, renamed and relabelled, with undo and redo.
import type { PrimitiveEdit, PrimitiveFacts, PrimitiveSetFacts } from './api';

/** A primitive after the edits. */
export interface Row extends PrimitiveFacts {
  /** Its number in the set. */
  model: number;
  out: boolean;
}

/** A change of what is edited of one primitive; without an edit it is as the set has it. */
interface Step {
  primitive: string;
  before: PrimitiveEdit | undefined;
  after: PrimitiveEdit | undefined;
}

export class PrimitiveEdits {
  readonly rows: Row[];
  private readonly edits = new Map<string, PrimitiveEdit>();
  /** What was done at once is undone at once. */
  private past: Step[][] = [];
  private undone: Step[][] = [];
  private readonly numbers = new Map<string, number>();

  constructor(readonly facts: PrimitiveSetFacts) {
    facts.primitives.forEach(({ folder }, model) => this.numbers.set(folder, model));
    this.rows = facts.primitives.map((p, model) => ({ ...p, model, out: false }));
  }

  get undos(): number {
    return this.past.length;
  }

  get redos(): number {
    return this.undone.length;
  }

  /** The edits in the order of the set. */
  list(): PrimitiveEdit[] {
    return [...this.edits.values()].sort((a, b) => this.numbers.get(a.primitive)! - this.numbers.get(b.primitive)!);
  }

  /** The classes that a primitive may get. */
  classesOf(model: number): string[] {
    const own = this.facts.primitives[model]!.class;
    return this.facts.classes.find((c) => c.name === own)?.may_become ?? [own];
  }

  /**
   * Throws primitives out or brings them back, renames or relabels them, as one step. Those that may not get the class
   * stay as they are. Returns the number of those that are changed; throws where it cannot be or none is.
   */
  change(models: number[], to: { out?: boolean; name?: string; class?: string }): number {
    const { class: wanted } = to;
    const able = models.filter((m) => wanted === undefined || this.classesOf(m).includes(wanted));
    if (models.length === 0) throw new Error('There is nothing to change');
    if (able.length === 0) throw new Error(`None of these may become ${wanted}`);
    const bytes = new TextEncoder().encode(to.name ?? '').length;
    if (bytes > this.facts.most_name_bytes) throw new Error(`A name has ${this.facts.most_name_bytes} bytes at most`);
    const chosen = new Set(able);
    if (to.out && this.rows.every((row) => row.out || chosen.has(row.model))) throw new Error('One primitive at least must remain');
    const steps = able.map((model) => this.stepOf(model, to));
    this.past.push(steps);
    this.undone = [];
    steps.forEach(({ primitive, after }) => this.take(primitive, after));
    return able.length;
  }

  private stepOf(model: number, to: { out?: boolean; name?: string; class?: string }): Step {
    const before = this.facts.primitives[model]!;
    const { out, name, class: label } = { ...this.rows[model]!, ...to };
    const primitive = before.folder;
    const edit: PrimitiveEdit = out ? { primitive, remove: true } : { primitive };
    if (!out && label !== before.class) edit.class = label;
    if (!out && name !== before.name) edit.name = name;
    return { primitive, before: this.edits.get(primitive), after: Object.keys(edit).length > 1 ? edit : undefined };
  }

  undo(): void {
    const last = this.past.pop();
    if (!last) return;
    this.undone.push(last);
    last.forEach((step) => this.take(step.primitive, step.before));
  }

  redo(): void {
    const next = this.undone.pop();
    if (!next) return;
    this.past.push(next);
    next.forEach((step) => this.take(step.primitive, step.after));
  }

  /** Takes a list in place of the edits so far, each of which can be undone. Throws with the place of what cannot be. */
  replace(list: unknown): void {
    const edits = new Map<string, PrimitiveEdit>();
    if (!Array.isArray(list)) throw new Error('edits: must be a list');
    list.forEach((given: PrimitiveEdit | null, k) => {
      const model = this.numbers.get(given?.primitive ?? '');
      if (!given || model === undefined) throw new Error(`edits[${k}].primitive: there is no such primitive`);
      if (edits.has(given.primitive)) throw new Error(`edits[${k}].primitive: an edit before names it, too`);
      const { primitive, remove, class: label, name } = given;
      if (label !== undefined && !this.classesOf(model).includes(label)) throw new Error(`edits[${k}].class: not for this primitive`);
      if (name !== undefined && typeof name !== 'string') throw new Error(`edits[${k}].name: must be a text`);
      const change = { ...(label === undefined ? {} : { class: label }), ...(name === undefined ? {} : { name }) };
      edits.set(primitive, remove === true ? { primitive, remove } : { primitive, ...change });
    });
    [...this.edits.keys()].forEach((primitive) => this.take(primitive, undefined));
    edits.forEach((edit, primitive) => this.take(primitive, edit));
    this.past = [...edits].map(([primitive, after]) => [{ primitive, before: undefined, after }]);
    this.undone = [];
  }

  private take(primitive: string, edit: PrimitiveEdit | undefined): void {
    if (edit) this.edits.set(primitive, edit);
    else this.edits.delete(primitive);
    const model = this.numbers.get(primitive)!;
    const { name, class: label } = this.facts.primitives[model]!;
    Object.assign(this.rows[model]!, { name: edit?.name ?? name, class: edit?.class ?? label, out: edit?.remove === true });
  }
}

/** Reads the content of a file of edits for a set. Throws with the place of what is wrong. */
export function editsIn(text: string, set: string): unknown {
  let list: { format?: unknown; version?: unknown; set?: unknown; edits?: unknown };
  try {
    list = JSON.parse(text) as typeof list;
  } catch {
    throw new Error('not JSON');
  }
  if (list?.format !== 'underbrush-primitive-edits') throw new Error('not a list of edits of primitives');
  if (list.version !== 1) throw new Error('version: must be 1');
  if (list.set !== undefined && list.set !== set) throw new Error('set: the edits were made for another set, or for this one before it changed');
  return list.edits;
}
