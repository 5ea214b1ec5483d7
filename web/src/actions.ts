// The keys of the viewer and what they do.
import { Vector3 } from 'three';
import type { App } from './context';
import { POINT_MODES, WORLD_MODES } from './display';
import { type Action, fillHelp, isTyping, isUndo, keyOf, toolbar } from './keys';
import type { Menu } from './menu';
import { byId, el, root } from './panel';
import type { Picking } from './picking';

function cycle<T>(values: readonly T[], value: T): T {
  return values[(values.indexOf(value) + 1) % values.length]!;
}

export function setPanel(open: boolean): void {
  root.dataset.panel = open ? 'open' : 'closed';
  byId('menu').setAttribute('aria-expanded', `${open}`);
}

async function screenshot(app: App): Promise<void> {
  const link = el('a', { download: 'underbrush.png', href: URL.createObjectURL(await app.viewer.picture()) });
  link.click();
  URL.revokeObjectURL(link.href);
}

async function copyLink(app: App, menu: Menu): Promise<void> {
  menu.keepLink();
  await new Promise((resolve) => setTimeout(resolve, 350));
  await navigator.clipboard.writeText(location.href);
  app.tell('The link is copied');
}

/** The actions of the viewer, each with its key. */
export function viewActions(app: App, menu: Menu, picking: Picking): Action[] {
  const { state, viewer } = app;
  const help = byId<HTMLDialogElement>('help');
  const look = (x: number, y: number, z: number) => () => viewer.lookFrom(new Vector3(x, y, z));
  const next = <K extends 'points' | 'worlds'>(key: K, modes: readonly (typeof state)[K][], box: { set: (v: never) => void }) => () => {
    state[key] = cycle(modes, state[key]);
    box.set(state[key] as never);
    app.apply();
  };
  const slice = () => {
    state.slice.on = !state.slice.on;
    if (state.slice.on && state.slice.at === 0) state.slice.at = viewer.navigation.target[state.slice.axis];
    menu.sliceOn.set(state.slice.on);
    menu.sliceAt.set(state.slice.at);
    app.apply();
  };
  const theme = () => {
    state.theme = root.dataset.theme === 'dark' ? 'light' : 'dark';
    app.apply();
  };
  return [
    { key: 'm', name: 'show or hide the menu', act: () => setPanel(root.dataset.panel === 'closed') },
    { key: 'f', name: 'look at everything', tool: 'All', act: () => app.frame() },
    { key: '1', name: 'look from above', tool: 'Top', act: look(0, -0.01, 1) },
    { key: '2', name: 'look from the south', act: look(0, -1, 0) },
    { key: '3', name: 'look from the east', act: look(1, 0, 0) },
    { key: 'c', name: 'colour points by the next quantity', act: next('points', POINT_MODES, menu.pointMode) },
    { key: 'v', name: 'colour elements by the next quantity', act: next('worlds', WORLD_MODES, menu.worldMode) },
    { key: 'x', name: 'slice on or off', tool: 'Slice', act: slice },
    { key: 'n', name: 'measure between two places', tool: 'Measure', act: () => picking.toggleMeasure() },
    {
      key: 'b',
      name: 'why did the picked beam end here, in the first model or scene',
      act: () => picking.followPicked(),
    },
    { key: ';', name: 'waveform and echoes of the picked beam, in the first model or scene', act: () => picking.receivePicked() },
    { key: 'p', name: 'save a picture', tool: 'Picture', act: () => app.run(screenshot(app)) },
    { key: 'l', name: 'copy a link to this view', tool: 'Link', act: () => app.run(copyLink(app, menu)) },
    { key: 't', name: 'dark or light', tool: 'Theme', act: theme },
    { key: '?', name: 'this help', tool: '?', act: () => (help.open ? help.close() : help.showModal()) },
    { key: 'Escape', name: 'close the details, put the tool down', act: () => app.closeDetails() },
  ];
}

/** Listens to the keyboard and fills the toolbar and the help. */
export function listen(app: App, picking: Picking, actions: Action[]): void {
  const { viewer } = app;
  byId('tools').append(...toolbar(actions));
  byId('menu').addEventListener('click', () => setPanel(root.dataset.panel === 'closed'));
  fillHelp(byId<HTMLDialogElement>('help'), app.list.program, actions);
  const middle = () => viewer.pick(...viewer.middle);
  const turns: Record<string, () => void> = {
    ArrowLeft: () => viewer.navigation.orbit(-0.1, 0),
    ArrowRight: () => viewer.navigation.orbit(0.1, 0),
    ArrowUp: () => viewer.navigation.orbit(0, 0.1),
    ArrowDown: () => viewer.navigation.orbit(0, -0.1),
    '+': () => viewer.navigation.zoom(0.8),
    '-': () => viewer.navigation.zoom(1.25),
    Enter: () => void picking.pick(middle()),
  };
  window.addEventListener('keydown', (event) => {
    if (isTyping(event) && !isUndo(event)) return;
    const action = actions.find((a) => a.key === keyOf(event));
    const turn = turns[event.key];
    // Enter and the arrows keep their meaning on buttons.
    viewer.navigation.used = true;
    if (turn && (event.key !== 'Enter' || event.target === viewer.canvas)) turn();
    else if (action) action.act();
    else if (!viewer.navigation.keyDown(event.key.toLowerCase())) return;
    else viewer.draw();
    if (event.target === viewer.canvas || isUndo(event)) event.preventDefault();
  });
  window.addEventListener('keyup', (event) => viewer.navigation.keyUp(event.key.toLowerCase()));
}
