// What the parts of the page share: the files, the view, how things are shown, and what is told.
import { type FileList, type ServedFile } from './api';
import type { Files } from './files';
import { byId, el, root } from './panel';
import type { State } from './state';
import type { Viewer } from './viewer';

export class App {
  readonly status = byId('status');
  readonly details = byId('details');
  readonly panel = byId('panel');
  /** Called when what is shown or how has changed. */
  readonly onApply: (() => void)[] = [];
  /** Called when the details are closed. */
  readonly onClose: (() => void)[] = [];

  constructor(
    readonly list: FileList,
    readonly state: State,
    readonly viewer: Viewer,
    readonly files: Files,
    readonly shown: Set<number>,
  ) {}

  tell(text: string): void {
    this.status.textContent = text;
  }

  fail(error: unknown): void {
    this.tell(error instanceof Error ? error.message : String(error));
    root.dataset.error = this.status.textContent ?? '';
  }

  /** Runs what a person asked for; what it throws is told. */
  run(work: Promise<unknown>): void {
    work.catch((error: unknown) => this.fail(error));
  }

  apply(): void {
    this.onApply.forEach((act) => act());
  }

  /** Shows everything, in colours that fit it. */
  frame(): void {
    this.viewer.frameAll();
    this.apply();
  }

  showDetails(parts: HTMLElement[]): void {
    this.details.replaceChildren(...parts);
    this.details.hidden = false;
    this.details.scrollTop = 0;
  }

  closeDetails(): void {
    this.details.hidden = true;
    this.onClose.forEach((act) => act());
    this.viewer.mark();
    this.viewer.canvas.focus();
  }

  /** A section of the menu with a heading. */
  section(title: string, ...parts: HTMLElement[]): HTMLElement {
    const out = el('section', {}, el('h2', {}, title), ...parts);
    this.panel.append(out);
    return out;
  }

  of(kind: ServedFile['kind']): ServedFile[] {
    return this.files.list.filter((file) => file.kind === kind);
  }
}
