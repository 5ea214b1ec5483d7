// The page of `underbrush serve`: it puts the parts together.
import './style.css';
import { Vector3 } from 'three';
import { type Beam, type FileList, json, type ServedFile, type Trace } from './api';
import { markBeam } from './beams';
import { classCss } from './colours';
import { beamDetails, type DetailActions, elementDetails, scoreDetails, traceDetails } from './details';
import { POINT_MODES, WORLD_MODES } from './display';
import { Files } from './files';
import { type Action, fillHelp, isTyping, toolbar } from './keys';
import { button, check, el, select, shortened, slider } from './panel';
import { hashOf, stateOf } from './state';
import { type Picked, Viewer } from './viewer';

const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const root = document.documentElement;
const state = stateOf(location.hash);
const status = byId('status');
const details = byId('details');
const help = byId<HTMLDialogElement>('help');
const viewer = new Viewer(byId<HTMLCanvasElement>('view'), (picked) => void onPick(picked));
const list = await json<FileList>('files');
const files = new Files(list.files, viewer, (text) => (status.textContent = text));
const shown = new Set(state.shown ?? list.files.filter((f) => f.kind !== 'score').slice(0, 2).map((f) => f.id));
let restoring = true;
let picked: { beam: Beam; file: number } | null = null;
let measuring: Vector3[] | null = null;

function fail(error: unknown): void {
  status.textContent = error instanceof Error ? error.message : String(error);
  root.dataset.error = status.textContent;
}

// --- details -------------------------------------------------------------------------------------

const actions: DetailActions = {
  worlds: list.files.filter((f) => f.kind === 'model' || f.kind === 'scene'),
  follow: (beam, file, world) => void follow(beam, file, world).catch(fail),
  close: () => closeDetails(),
};

function showDetails(parts: HTMLElement[]): void {
  details.replaceChildren(...parts);
  details.hidden = false;
}

function closeDetails(): void {
  details.hidden = true;
  picked = null;
  measuring = null;
  viewer.mark();
  viewer.canvas.focus();
}

async function follow(beam: Beam, file: number, world: ServedFile): Promise<void> {
  const trace = await json<Trace>(`trace?file=${file}&row=${beam.row}&world=${world.id}&seed=${list.seed}`);
  viewer.mark(markBeam(beam, trace, files.origin!));
  showDetails(traceDetails(trace, world, actions));
}

async function showBeam(file: number, row: number): Promise<void> {
  const beam = await json<Beam>(`beam?file=${file}&row=${row}`);
  picked = { beam, file };
  viewer.mark(markBeam(beam, null, files.origin!));
  showDetails(beamDetails(beam, files.file(file), actions));
}

function measure(place: Vector3 | null): void {
  if (!place || !measuring) return;
  measuring.push(place);
  const [from, to] = measuring;
  if (!from || !to) {
    status.textContent = 'Measure: pick the second place';
    return;
  }
  const by = to.clone().sub(from);
  viewer.mark(viewer.measured(from, to));
  status.textContent =
    `Distance ${shortened(by.length())} m, level ${shortened(Math.hypot(by.x, by.y))} m, ` +
    `height ${shortened(by.z)} m`;
  root.dataset.measured = String(by.length());
  measuring = [];
}

async function onPick(hit: Picked | null): Promise<void> {
  root.dataset.picked = hit ? `${hit.target.kind} ${hit.part}` : 'nothing';
  if (measuring) return measure(hit?.place ?? null);
  if (!hit) return closeDetails();
  try {
    if (hit.target.kind === 'point') await showBeam(hit.target.cloud.octree.file, hit.part);
    else if (hit.target.kind === 'beam') await showBeam(hit.target.file, hit.part);
    else showDetails(elementDetails(hit, actions));
  } catch (error) {
    fail(error);
  }
}

// --- the panel -----------------------------------------------------------------------------------

const panel = byId('panel');

function apply(): void {
  viewer.display.setMap(state.map);
  viewer.display.setSlice(state.slice);
  for (const cloud of viewer.clouds) {
    cloud.setMode(state.points);
    cloud.setSize(state.size * Math.min(window.devicePixelRatio, 2));
  }
  for (const world of viewer.worlds) {
    world.setMode(state.worlds);
    world.setRadius(state.sigmas);
    world.setOpaque(state.opaque);
  }
  root.dataset.theme =
    state.theme || (window.matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark');
  showLegend();
  viewer.setBackground(getComputedStyle(root).getPropertyValue('--view').trim());
  keepLink();
}

/** Lists the classes with their colours while points are coloured by class. */
function showLegend(): void {
  const labels = new Map<number, string>();
  for (const cloud of viewer.clouds) {
    if (cloud.group.visible) cloud.octree.facts.labels.forEach((l) => labels.set(l.number, l.name));
  }
  legend.hidden = state.points !== 'class' || labels.size === 0;
  legend.replaceChildren(
    ...[...labels].map(([label, name]) => {
      const swatch = el('span', { class: 'swatch' });
      swatch.style.background = classCss(label);
      return el('li', {}, swatch, name);
    }),
  );
}

let linkTimer = 0;
function keepLink(): void {
  if (restoring) return;
  clearTimeout(linkTimer);
  root.dataset.link = 'old';
  linkTimer = window.setTimeout(() => {
    // In world coordinates, because the scene's origin depends on which file was shown first.
    const origin = files.origin ?? new Vector3();
    const world = {
      ...state,
      eye: viewer.camera.position.clone().add(origin).toArray(),
      target: viewer.navigation.target.clone().add(origin).toArray(),
      shown: [...shown].sort((a, b) => a - b),
      slice: { ...state.slice, at: state.slice.at + origin[state.slice.axis] },
    };
    history.replaceState(null, '', hashOf(world));
    root.dataset.link = 'new';
  }, 300);
}

function cycle<T>(values: readonly T[], value: T): T {
  return values[(values.indexOf(value) + 1) % values.length]!;
}

const pointMode = select('Points by', POINT_MODES, state.points, (v) => {
  state.points = v;
  apply();
});
const worldMode = select('Elements by', WORLD_MODES, state.worlds, (v) => {
  state.worlds = v;
  apply();
});
const map = select('Colours', ['viridis', 'cividis', 'grey'] as const, state.map, (v) => {
  state.map = v;
  apply();
});
const size = slider('Point size', [1, 8, 0.5], state.size, (v) => {
  state.size = v;
  apply();
});
const sigmas = slider('Ellipsoids, σ', [0.5, 3.5, 0.1], state.sigmas, (v) => {
  state.sigmas = v;
  apply();
});
const opaque = check('Ellipsoids opaque (else p of their pixels)', state.opaque, (v) => {
  state.opaque = v;
  apply();
});
const budget = slider('Points, millions', [0.1, 10, 0.1], viewer.budget / 1e6, (v) => {
  viewer.budget = v * 1e6;
  viewer.draw();
});
const sliceOn = check('Slice', state.slice.on, (v) => {
  state.slice.on = v;
  apply();
});
const axis = select('along', ['x', 'y', 'z'] as const, state.slice.axis, (v) => {
  state.slice.axis = v;
  limits();
  apply();
});
const sliceAt = slider('at, m', [-100, 100, 0.1], state.slice.at, (v) => {
  state.slice.at = v;
  apply();
});
const thickness = slider('thick, m', [0.05, 10, 0.05], state.slice.thickness, (v) => {
  state.slice.thickness = v;
  apply();
});
const beamBox = el('select', { 'aria-label': 'Beams of a scan' });
beamBox.addEventListener('change', () => void showBeams().catch(fail));
const timeFrom = slider('Time from, s', [0, 1, 0.01], 0, () => times());
const timeTo = slider('to, s', [0, 1, 0.01], 1, () => times());
const legend = el('ul', { class: 'legend', 'aria-label': 'Classes' });
const fileBoxes = new Map<number, ReturnType<typeof check>>();

function times(): void {
  const value = (row: HTMLElement) => Number(row.querySelector('input')!.value);
  for (const cloud of viewer.clouds) {
    const end = cloud.octree.facts.last_time_s - cloud.octree.facts.first_time_s;
    const to = value(timeTo.row);
    cloud.setTimes(value(timeFrom.row) - 1e-3, to >= end - 1e-3 ? end + 1 : to);
  }
  viewer.draw();
}

async function showBeams(): Promise<void> {
  const [file, run] = beamBox.value.split(' ').map(Number);
  status.textContent = await files.showBeams(file ?? 0, beamBox.value === '' ? null : run!);
  root.dataset.beams = status.textContent;
}

/** Fits the sliders to what is shown. */
function limits(): void {
  const box = viewer.bounds();
  sliceAt.limits(box.min[state.slice.axis], box.max[state.slice.axis]);
  let end = 0;
  const runs = [el('option', { value: '' }, 'no beams')];
  for (const [id, cloud] of files.clouds) {
    const facts = cloud.octree.facts;
    end = Math.max(end, facts.last_time_s - facts.first_time_s);
    cloud.octree.runs.slice(0, 2000).forEach((run, k) => {
      const text = `${files.file(id).name}: scan ${run.scan}, ${(run.time - facts.first_time_s).toFixed(2)} s`;
      runs.push(el('option', { value: `${id} ${k}` }, text));
    });
  }
  timeFrom.limits(0, end);
  timeTo.limits(0, end);
  timeTo.set(end);
  const kept = beamBox.value;
  beamBox.replaceChildren(...runs);
  beamBox.value = kept;
}

async function toggle(file: ServedFile, on: boolean): Promise<void> {
  if (file.kind === 'score') {
    if (on) showDetails(await scoreDetails(file, actions));
    else closeDetails();
    return;
  }
  if (on) shown.add(file.id);
  else shown.delete(file.id);
  fileBoxes.get(file.id)?.set(on);
  const first = viewer.clouds.size + viewer.worlds.size === 0;
  await files.show(file.id, on);
  if (first && on) viewer.frameAll();
  limits();
  apply();
}

for (const file of list.files) {
  const box = check(`${file.name} (${file.kind})`, shown.has(file.id), (on) => void toggle(file, on).catch(fail));
  fileBoxes.set(file.id, box);
}
panel.append(
  el('h2', {}, 'Files'),
  ...[...fileBoxes.values()].map((box) => box.row),
  ...list.notes.map((note) => el('p', { class: 'note' }, note)),
  el('h2', {}, 'Display'),
  pointMode.row,
  legend,
  ...[worldMode, map, size, sigmas, opaque, budget].map((c) => c.row),
  el('h2', {}, 'Slice'),
  ...[sliceOn, axis, sliceAt, thickness].map((c) => c.row),
  el('h2', {}, 'Beams and time'),
  beamBox,
  timeFrom.row,
  timeTo.row,
);

// --- actions and keys ----------------------------------------------------------------------------

function setPanel(open: boolean): void {
  root.dataset.panel = open ? 'open' : 'closed';
  byId('menu').setAttribute('aria-expanded', `${open}`);
}

async function screenshot(): Promise<void> {
  const link = el('a', { download: 'underbrush.png', href: URL.createObjectURL(await viewer.picture()) });
  link.click();
  URL.revokeObjectURL(link.href);
}

async function copyLink(): Promise<void> {
  keepLink();
  await new Promise((resolve) => setTimeout(resolve, 350));
  await navigator.clipboard.writeText(location.href);
  status.textContent = 'The link is copied';
}

const all: Action[] = [
  { key: 'm', name: 'show or hide the menu', act: () => setPanel(root.dataset.panel === 'closed') },
  { key: 'f', name: 'look at everything', tool: 'All', act: () => viewer.frameAll() },
  { key: '1', name: 'look from above', tool: 'Top', act: () => viewer.navigation.lookFrom(new Vector3(0, -0.01, 1)) },
  { key: '2', name: 'look from the south', act: () => viewer.navigation.lookFrom(new Vector3(0, -1, 0)) },
  { key: '3', name: 'look from the east', act: () => viewer.navigation.lookFrom(new Vector3(1, 0, 0)) },
  {
    key: 'c',
    name: 'colour points by the next quantity',
    act: () => {
      state.points = cycle(POINT_MODES, state.points);
      pointMode.set(state.points);
      apply();
    },
  },
  {
    key: 'v',
    name: 'colour elements by the next quantity',
    act: () => {
      state.worlds = cycle(WORLD_MODES, state.worlds);
      worldMode.set(state.worlds);
      apply();
    },
  },
  {
    key: 'x',
    name: 'slice on or off',
    tool: 'Slice',
    act: () => {
      state.slice.on = !state.slice.on;
      if (state.slice.on && state.slice.at === 0) state.slice.at = viewer.navigation.target[state.slice.axis];
      sliceOn.set(state.slice.on);
      sliceAt.set(state.slice.at);
      apply();
    },
  },
  {
    key: 'n',
    name: 'measure between two places',
    tool: 'Measure',
    act: () => {
      measuring = measuring ? null : [];
      status.textContent = measuring ? 'Measure: pick the first place' : '';
      if (!measuring) viewer.mark();
    },
  },
  {
    key: 'b',
    name: 'why did the picked beam end here, in the first model or scene',
    act: () => {
      const world = actions.worlds[0];
      if (picked && world) actions.follow(picked.beam, picked.file, world);
    },
  },
  { key: 'p', name: 'save a picture', tool: 'Picture', act: () => void screenshot().catch(fail) },
  { key: 'l', name: 'copy a link to this view', tool: 'Link', act: () => void copyLink().catch(fail) },
  {
    key: 't',
    name: 'dark or light',
    tool: 'Theme',
    act: () => {
      state.theme = root.dataset.theme === 'dark' ? 'light' : 'dark';
      apply();
    },
  },
  { key: '?', name: 'this help', tool: '?', act: () => (help.open ? help.close() : help.showModal()) },
  { key: 'Escape', name: 'close the details', act: () => closeDetails() },
];

byId('tools').append(...toolbar(all));
byId('menu').addEventListener('click', () => all[0]!.act());
fillHelp(help, list.program, all);

const turns: Record<string, () => void> = {
  ArrowLeft: () => viewer.navigation.orbit(-0.1, 0),
  ArrowRight: () => viewer.navigation.orbit(0.1, 0),
  ArrowUp: () => viewer.navigation.orbit(0, 0.1),
  ArrowDown: () => viewer.navigation.orbit(0, -0.1),
  '+': () => viewer.navigation.zoom(0.8),
  '-': () => viewer.navigation.zoom(1.25),
  Enter: () => void onPick(viewer.pick(viewer.canvas.clientWidth / 2, viewer.canvas.clientHeight / 2)),
};
window.addEventListener('keydown', (event) => {
  if (isTyping(event)) return;
  const action = all.find((a) => a.key === event.key);
  const turn = turns[event.key];
  // Enter and the arrows keep their meaning on buttons.
  if (turn && (event.key !== 'Enter' || event.target === viewer.canvas)) turn();
  else if (action) action.act();
  else if (!viewer.navigation.keyDown(event.key.toLowerCase())) return;
  else viewer.draw();
  if (event.target === viewer.canvas) event.preventDefault();
});
window.addEventListener('keyup', (event) => viewer.navigation.keyUp(event.key.toLowerCase()));
window.matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => apply());

viewer.onDrawn = () => {
  const points = viewer.drawnPoints;
  root.dataset.points = String(points);
  root.dataset.state = viewer.loading || files.loading ? 'loading' : 'ready';
  root.dataset.eye = viewer.camera.position.toArray().map((v) => v.toFixed(3)).join(' ');
  const failed = [...viewer.clouds].map((cloud) => cloud.error).find(Boolean);
  if (failed) fail(failed);
  byId('tools').dataset.points = points > 0 ? `${(points / 1e6).toFixed(2)} M points` : '';
  keepLink();
};

// --- start ---------------------------------------------------------------------------------------

setPanel(window.innerWidth > 700);
apply();
for (const file of list.files) {
  if (shown.has(file.id)) await toggle(file, true).catch(fail);
}
if (list.files.every((f) => f.kind === 'score') && list.files[0]) await toggle(list.files[0], true).catch(fail);
if (state.eye && state.target && files.origin) {
  const local = (at: [number, number, number]) => new Vector3(...at).sub(files.origin!);
  viewer.frameAll(); // sets the heights of the colours
  viewer.navigation.set(local(state.eye), local(state.target));
  state.slice.at -= files.origin[state.slice.axis];
  sliceAt.set(state.slice.at);
} else {
  viewer.frameAll();
}
apply();
restoring = false;
root.dataset.opened = 'yes';
panel.append(button('Keys', 'Keys (?)', () => help.showModal()));
viewer.canvas.focus();
viewer.draw();
