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

export function isTyping(event: KeyboardEvent): boolean {
  const at = event.target;
  return at instanceof HTMLInputElement || at instanceof HTMLSelectElement || event.ctrlKey || event.metaKey;
}

export function toolbar(actions: Action[]): HTMLElement[] {
  return actions
    .filter((a) => a.tool)
    .map((a) => button(a.tool!, `${a.name} (${a.key === 'Escape' ? a.key : a.key.toUpperCase()})`, a.act));
}

export function fillHelp(dialog: HTMLDialogElement, program: string, actions: Action[]): void {
  const rows = actions.map((a): [string, string] => [a.key === ' ' ? 'space' : a.key.toUpperCase(), a.name]);
  dialog.replaceChildren(
    el('h2', {}, 'Keys'),
    facts([...FIXED, ...rows]),
    el('p', {}, program),
    button('Close', 'Close', () => dialog.close()),
  );
}
