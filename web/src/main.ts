// The page of `underbrush serve`: it puts the parts together.
import './style.css';
import { Vector3 } from 'three';
import { listen, setPanel, viewActions } from './actions';
import { Actors } from './actors';
import { type FileList, json } from './api';
import { Compare } from './compare';
import { App } from './context';
import { Files } from './files';
import { JobsPanel } from './jobs';
import { Labeller } from './labeller';
import { Library } from './library';
import { Menu } from './menu';
import { button, byId, root } from './panel';
import { Picking } from './picking';
import { Placing } from './placing';
import { RangeImages } from './range-image';
import { stateOf } from './state';
import { Viewer } from './viewer';
import { Workflow } from './workflow';

const state = stateOf(location.hash);
const viewer = new Viewer(byId<HTMLCanvasElement>('view'), (picked) => void picking.pick(picked));
const list = await json<FileList>('files');
const files = new Files(list.files, viewer, (text, own) => {
  const status = byId('status');
  if (status.textContent?.startsWith(own)) status.textContent = text;
});
const shown = new Set(state.shown ?? list.files.filter((f) => f.kind !== 'score').slice(0, 2).map((f) => f.id));
state.edits ??= list.edits ?? null;
if (state.edits && !state.shown) shown.add(state.edits.file);
const app = new App(list, state, viewer, files, shown);
const picking = new Picking(app);
const menu = new Menu(app, picking.actions);
files.onPreview = () => look();
const labeller = list.labels ? new Labeller(app, menu) : null;
const compare = new Compare(app, (id) => menu.toggle(files.file(id), true), (mode) => menu.pointMode.set(mode));
const images = new RangeImages(app, (id) => menu.toggle(files.file(id), true), (file, row) => picking.showBeam(file, row));
picking.onBeam.push((file, row) => images.mark(file, row));
menu.time.onTime.push((time) => images.goTo(time));
const jobs = list.jobs ? new JobsPanel(app, menu) : null;
const workflow = labeller && jobs ? new Workflow(app, labeller, jobs, menu) : null;
const placing = workflow ? new Placing(app, labeller!, jobs!, workflow, menu.time) : null;
const actors = new Actors(app, menu, jobs, workflow && ((edits) => workflow.simulate(edits)));
const library = new Library(app, menu, jobs);
jobs?.onFiles.push(() => compare.refresh(), () => images.refresh());
labeller?.onChange.push(() => menu.legend.show());
const actions = [...viewActions(app, menu, picking), ...menu.time.actions(), ...images.actions(), ...compare.actions(), ...actors.actions(), ...library.actions(), ...(labeller?.actions() ?? []), ...(placing?.actions() ?? [])];

listen(app, picking, actions);
window.matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => app.apply());

viewer.onDrawn = () => {
  const points = viewer.drawnPoints;
  root.dataset.points = String(points);
  root.dataset.state = viewer.loading || files.loading || labeller?.labelled?.loading ? 'loading' : 'ready';
  root.dataset.drawer = viewer.points.splats ? 'processor' : 'graphics card';
  root.dataset.eye = viewer.camera.position.toArray().map((v) => v.toFixed(3)).join(' ');
  const failed = [...viewer.clouds].map((cloud) => cloud.error).find(Boolean);
  if (failed) app.fail(failed);
  byId('tools').dataset.points = points > 0 ? `${(points / 1e6).toFixed(2)} M points` : '';
  menu.keepLink();
};

/** Looks where the link says, or at everything, unless a person has begun to look around. */
function look(): void {
  if (viewer.navigation.used) return app.apply();
  app.frame(); // sets the heights of the colours
  if (!state.eye || !state.target || !files.origin) return;
  const local = (at: [number, number, number]) => new Vector3(...at).sub(files.origin!);
  viewer.navigation.set(local(state.eye), local(state.target));
}

// Panels stand below the buttons, in however many rows these are.
const header = document.querySelector('header')!;
const below = () => root.style.setProperty('--head', `${Math.ceil(header.getBoundingClientRect().bottom) + 8}px`);
new ResizeObserver(below).observe(header);
below();
setPanel(window.innerWidth > 700);
app.apply();
for (const file of list.files) {
  if (shown.has(file.id)) await menu.toggle(file, true).catch((error: unknown) => app.fail(error));
}
const onlyScores = list.files.every((f) => f.kind === 'score');
if (onlyScores && list.files[0]) await menu.toggle(list.files[0], true).catch((error: unknown) => app.fail(error));
look();
if (state.eye && files.origin) {
  state.slice.at -= files.origin[state.slice.axis];
  menu.sliceAt.set(state.slice.at);
}
app.apply();
menu.restoring = false;
root.dataset.opened = 'yes';
app.panel.append(button('Keys', 'Keys (?)', () => byId<HTMLDialogElement>('help').showModal()));
viewer.canvas.focus();
viewer.draw();
