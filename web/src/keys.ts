// Every action has a key; the help lists them.
import { button, el, facts } from './panel';

export interface Action {
  key: string;
  name: string;
  act: () => void;
  /** Text of its button in the toolbar, if it has one. */
  tool?: string;
}

const FIXED: [string, string][] = [
  ['drag', 'turn about the target'],
  ['shift + drag, right button', 'move along'],
  ['wheel, pinch, + and -', 'nearer and farther'],
  ['arrows', 'turn'],
  ['W A S D, Q E', 'fly ahead, left, back, right, down, up'],
  ['click, Enter', 'pick what is under the cursor, or in the middle of the view'],
];

/** Whether a key belongs to the control that has the focus, or to the browser. */
export function isTyping(event: KeyboardEvent): boolean {
  const at = event.target;
  if (event.ctrlKey || event.metaKey || at instanceof HTMLSelectElement) return true;
  if (!(at instanceof HTMLInputElement)) return false;
  if (!['checkbox', 'radio', 'range'].includes(at.type)) return true;
  return /^(Arrow|Home|End|Page| $)/.test(event.key);
}

/** The key of an action: also Ctrl + Z and its like. */
export function keyOf(event: KeyboardEvent): string {
  if (!(event.ctrlKey || event.metaKey)) return event.key;
  return event.key === 'Z' ? 'y' : event.key;
}

/** Whether this is the undo or redo of a desktop program. */
export function isUndo(event: KeyboardEvent): boolean {
  const typing = event.target instanceof HTMLInputElement && !['checkbox', 'radio', 'range'].includes(event.target.type);
  return (event.ctrlKey || event.metaKey) && ['z', 'Z', 'y'].includes(event.key) && !typing;
}

export function toolbar(actions: Action[]): HTMLElement[] {
  return actions
    .filter((a) => a.tool)
    .map((a) => button(a.tool!, `${a.name} (${a.key === 'Escape' ? a.key : a.key.toUpperCase()})`, a.act));
}

export function fillHelp(dialog: HTMLDialogElement, program: string, actions: Action[]): void {
  const rows = actions.map((a): [string, string] => [a.key === ' ' ? 'space' : a.key.toUpperCase(), a.name]);
  dialog.replaceChildren(
    el('div', { class: 'head' }, el('h2', {}, 'Keys'), button('×', 'Close (Escape)', () => dialog.close())),
    facts([...FIXED, ...rows]),
    el('p', {}, program),
  );
}
