// A library of primitives: its table, and edits that `primitives merge --edits` takes.
import { Box3Helper, Color } from 'three';
import { json, MOST_EDIT_TEXT, post, type PrimitiveEdit, type PrimitiveSetFacts, query } from './api';
import type { App } from './context';
import type { JobsPanel } from './jobs';
import { type Action, isUndo, keyOf } from './keys';
import { editsIn, PrimitiveEdits } from './library-edits';
import { LibraryTable } from './library-table';
import type { Menu } from './menu';
import { button, el, root } from './panel';
import type { World } from './world';

/** The edits in parts for which a request has room. */
function partsOf(edits: PrimitiveEdit[]): PrimitiveEdit[][] {
  const out: PrimitiveEdit[][] = [];
  let room = 0;
  for (const edit of edits) {
    const size = encodeURIComponent(JSON.stringify(edit)).length + 3;
    if (size > room) {
      out.push([]);
      room = MOST_EDIT_TEXT;
    }
    out.at(-1)!.push(edit);
    room -= size;
  }
  return out;
}

export class Library {
  private world: World | null = null;
  private edits: PrimitiveEdits | null = null;
  /** The edits that a file holds, as text. */
  private filed = '[]';
  private readonly table: LibraryTable;
  private readonly section: HTMLElement;
  private readonly told = el('p', { class: 'note', 'aria-label': 'Edits of primitives' });
  private readonly command = el('code');
  private readonly toggleButton = button('Table', 'Show or hide the table of the primitives (#)', () => this.toggle());
  private readonly undoButton = button('Undo', 'Take the last edit of a primitive back (<)', () => this.step(true));
  private readonly redoButton = button('Redo', 'Apply it again (>)', () => this.step(false));

  constructor(
    private readonly app: App,
    private readonly menu: Menu,
    private readonly jobs: JobsPanel | null,
  ) {
    this.table = new LibraryTable({
      change: (models, to) =>
        this.change(() => {
          const done = this.edits!.change(models, to);
          if (done < models.length) this.app.tell(`${done} primitives changed; ${models.length - done} may not become ${to.class}`);
        }, to.name !== undefined),
      show: (model) => this.look(model),
      close: () => this.toggle(),
    });
    document.body.append(this.table.element);
    const file = el('input', { type: 'file', accept: '.json', hidden: '', 'aria-label': 'List of edits of a library' });
    file.addEventListener('change', () => {
      if (file.files?.[0]) app.run(this.openList(file.files[0]));
      file.value = '';
    });
    const step = (text: string, title: string, work: () => Promise<unknown>) => button(text, title, () => app.run(work()));
    this.section = app.section(
      'Library',
      el('div', { class: 'buttons' }, this.toggleButton, this.undoButton, this.redoButton),
      this.told,
      file,
      el(
        'div',
        { class: 'buttons' },
        button('Open edits', 'Open a list of edits of these primitives', () => file.click()),
        ...(jobs
          ? [
              step('Write edits', 'Write the edits to the folder for labels, for primitives merge --edits', () => this.write()),
              step('Merge', 'Write the edits, and merge the set with them into a new library', () => this.merge()),
            ]
          : []),
      ),
      el('div', { role: 'group', 'aria-label': 'Command that applies the edits' }, this.command),
    );
    // Undo and redo of a desktop program belong to the table while it has the focus.
    this.table.element.addEventListener('keydown', (e) => {
      if (!isUndo(e)) return;
      e.stopPropagation();
      e.preventDefault();
      this.step(keyOf(e) === 'z');
    });
    app.onApply.push(() => app.run(this.open()));
    app.onClose.push(() => this.world?.showAlone(null));
    this.show();
  }

  /** Takes the first set of primitives that is shown. */
  private async open(): Promise<void> {
    const world = [...this.app.viewer.worlds].find((w) => w.group.visible && w.file.kind === 'primitives') ?? null;
    if (world === this.world) return;
    this.world?.showAlone(null);
    [this.world, this.edits, this.filed] = [world, null, '[]'];
    this.command.textContent = '';
    const facts = world && (await json<PrimitiveSetFacts>(`primitives?${query({ file: world.file.id })}`));
    if (world !== this.world) return;
    if (world && facts) {
      this.edits = new PrimitiveEdits(facts);
      const { library } = this.app.state;
      this.table.open(world.file.name, this.edits, (model) => `./api/thumbnail?${query({ file: world.file.id, model: `${model}` })}`);
      if (library?.file === world.file.id && library.edits.length > 0) {
        try {
          this.edits.replace(library.edits);
        } catch (error) {
          this.app.fail(error); // The primitives may be others than those of the link.
        }
      }
      if (library?.file === world.file.id && library.open) this.table.toggle(true);
    } else {
      this.table.toggle(false);
    }
    this.show();
    this.table.show();
  }

  private toggle(): void {
    if (!this.edits) return this.app.tell('Show a set of primitives first');
    this.table.toggle(this.table.element.hidden);
    if (this.table.element.hidden) this.app.closeDetails(); // which shows all primitives again
    this.show();
  }

  /** Changes the edits. The table stays as it is where only a name changes. */
  private change(act: () => void, stays = false): void {
    try {
      act();
    } catch (error) {
      this.app.fail(error);
    }
    if (!stays) this.table.show();
    this.show();
  }

  private step(back: boolean): void {
    const { edits } = this;
    if (edits) this.change(() => (back ? edits.undo() : edits.redo()));
  }

  private text(): string {
    return JSON.stringify(this.edits?.list() ?? []);
  }

  /** Shows the counts, and keeps the edits in the link. */
  private show(): void {
    const { edits, world } = this;
    this.section.hidden = !edits;
    const open = !this.table.element.hidden;
    this.toggleButton.setAttribute('aria-pressed', `${open}`);
    if (!edits || !world) return;
    const out = edits.rows.filter((r) => r.out).length;
    const list = edits.list();
    this.undoButton.disabled = edits.undos === 0;
    this.redoButton.disabled = edits.redos === 0;
    const saved = this.text() === this.filed ? '' : '; not written yet';
    this.told.textContent = `${edits.rows.length} primitives, ${out} thrown out, ${list.length - out} changed${saved}`;
    root.dataset.primitiveEdits = `${list.length}`;
    this.app.state.library = list.length > 0 || open ? { file: world.file.id, open, edits: list } : null;
    this.menu.keepLink();
  }

  /** Shows a primitive alone in the view, with its box. */
  private look(model: number): void {
    const box = this.world!.boxOf(model);
    this.world!.showAlone(model);
    this.app.viewer.frameBox(box);
    this.app.viewer.mark(new Box3Helper(box, new Color(0xf0e442)));
    root.dataset.primitive = this.edits!.rows[model]!.folder;
  }

  /** Opens a file of edits in place of the edits so far. */
  private async openList(file: File): Promise<void> {
    const { edits } = this;
    if (!edits) throw new Error('Show a set of primitives first');
    if (![this.filed, '[]'].includes(this.text()) && !confirm('The edits so far were not written. Open others in their place?')) return;
    try {
      edits.replace(editsIn(await file.text(), edits.facts.set));
    } catch (error) {
      throw new Error(`${file.name}: ${(error as Error).message}`);
    }
    this.filed = this.text();
    this.table.show();
    this.show();
    this.app.tell(`Opened: ${file.name}`);
  }

  /** Writes the edits; returns the names of the file and of the library that they make. */
  private async write(): Promise<{ edits: string; name: string }> {
    const { edits, world } = this;
    if (!edits || !world) throw new Error('Show a set of primitives first');
    if (edits.list().length === 0) throw new Error('There are no edits to write');
    const file = this.jobs!.freshName('primitive-edits', '.json');
    const name = this.jobs!.freshName(world.file.name.replace(/^.*\//, ''));
    const text = this.text();
    const parts = partsOf(edits.list());
    let path = '';
    for (const [k, part] of parts.entries()) {
      const more = k + 1 < parts.length;
      const told = { file: world.file.id, name: file, set: edits.facts.set, edits: JSON.stringify(part), more };
      ({ path } = await post<{ path: string }>('primitives/write', told));
    }
    this.filed = text;
    const job = query({ verb: 'primitives', primitives: `${world.file.id}`, edits: file, name });
    this.command.textContent = (await json<{ command: string }>(`jobs/command?${job}`)).command;
    this.show();
    this.app.tell(`Written: ${path}`);
    return { edits: file, name };
  }

  /** Merges the set with its edits, and shows the result in its place. */
  private async merge(): Promise<void> {
    const { world } = this;
    const written = await this.write();
    const open = !this.table.element.hidden;
    const made = await this.jobs!.runAndShow('primitives', { primitives: world!.file.id, ...written });
    this.app.state.library = { file: made, open, edits: [] };
    await this.menu.toggle(world!.file, false);
  }

  actions(): Action[] {
    return [
      { key: '#', name: 'library: show or hide the table', act: () => this.toggle() },
      { key: '<', name: 'library: undo', act: () => this.step(true) },
      { key: '>', name: 'library: redo', act: () => this.step(false) },
    ];
  }
}
