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
  private past: Step[] = [];
  private undone: Step[] = [];
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

  /** Throws a primitive out or brings it back, renames or relabels it. Throws where it cannot be. */
  change(model: number, to: { out?: boolean; name?: string; class?: string }): void {
    const before = this.facts.primitives[model]!;
    const { out, name, class: label } = { ...this.rows[model]!, ...to };
    const bytes = new TextEncoder().encode(name).length;
    if (bytes > this.facts.most_name_bytes) throw new Error(`A name has ${this.facts.most_name_bytes} bytes at most`);
    if (out && this.rows.every((row) => row.out || row.model === model)) throw new Error('One primitive at least must remain');
    const primitive = before.folder;
    const edit: PrimitiveEdit = out ? { primitive, remove: true } : { primitive };
    if (!out && label !== before.class) edit.class = label;
    if (!out && name !== before.name) edit.name = name;
    const after = Object.keys(edit).length > 1 ? edit : undefined;
    this.past.push({ primitive, before: this.edits.get(primitive), after });
    this.undone = [];
    this.take(primitive, after);
  }

  undo(): void {
    const last = this.past.pop();
    if (!last) return;
    this.undone.push(last);
    this.take(last.primitive, last.before);
  }

  redo(): void {
    const next = this.undone.pop();
    if (!next) return;
    this.past.push(next);
    this.take(next.primitive, next.after);
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
    this.past = [...edits].map(([primitive, after]) => ({ primitive, before: undefined, after }));
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
