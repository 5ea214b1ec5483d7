// The menu: files, how things are coloured, slices, beams and times.
import { Vector3 } from 'three';
import type { ServedFile } from './api';
import { MAPS } from './colours';
import type { App } from './context';
import { scoreDetails, type DetailActions } from './details';
import { POINT_MODES, WORLD_MODES } from './display';
import { Legend } from './legend';
import { check, el, root, select, slider } from './panel';
import { DRAWERS } from './points-layer';
import { hashOf } from './state';
import { TimeBar } from './time';

export class Menu {
  readonly pointMode;
  readonly worldMode;
  readonly sliceOn;
  readonly sliceAt;
  /** True until the link that the page was opened with is restored. */
  restoring = true;
  /** The times of what moves, s, where no log is shown. */
  movingTimes: () => [number, number] | null = () => null;
  private readonly beamBox = el('select', { 'aria-label': 'Beams of a scan' });
  readonly time: TimeBar;
  readonly legend: Legend;
  private readonly fileBoxes = new Map<number, ReturnType<typeof check>>();
  private readonly fileRows = el('div');
  private linkTimer = 0;

  constructor(
    private readonly app: App,
    private readonly actions: DetailActions,
  ) {
    const { state, viewer } = app;
    const set = <K extends keyof typeof state>(key: K) => (value: (typeof state)[K]) => {
      state[key] = value;
      app.apply();
    };
    this.pointMode = select('Points by', POINT_MODES, state.points, set('points'));
    this.worldMode = select('Elements by', WORLD_MODES, state.worlds, set('worlds'));
    this.legend = new Legend(app);
    const map = select('Colours', MAPS, state.map, set('map'));
    const elementMap = select('Their colours', MAPS, state.elementMap, set('elementMap'));
    const size = slider('Point size', [1, 8, 0.5], state.size, set('size'));
    const sigmas = slider('Ellipsoids, σ', [0.5, 3.5, 0.1], state.sigmas, set('sigmas'));
    const opaque = check('Ellipsoids opaque (else p of their pixels)', state.opaque, set('opaque'));
    const lighting = check('Eye-dome lighting of points', state.lighting, set('lighting'));
    const legend = check('Legend', state.legend, set('legend'));
    const drawer = select('Drawn by', DRAWERS, state.drawer, set('drawer'));
    drawer.row.title = 'What draws the points; automatic takes the processor where there is no graphics card';
    const budget = slider('Points, millions', [0.1, 10, 0.1], viewer.budget / 1e6, (v) => {
      viewer.budget = v * 1e6;
      viewer.draw();
    });
    const slice = <K extends keyof typeof state.slice>(key: K) => (value: (typeof state.slice)[K]) => {
      state.slice[key] = value;
      if (key === 'axis') this.limits();
      app.apply();
    };
    this.sliceOn = check('Slice', state.slice.on, slice('on'));
    const axis = select('along', ['x', 'y', 'z'] as const, state.slice.axis, slice('axis'));
    this.sliceAt = slider('at, m', [-100, 100, 0.1], state.slice.at, slice('at'));
    const thickness = slider('thick, m', [0.05, 10, 0.05], state.slice.thickness, slice('thickness'));
    this.beamBox.addEventListener('change', () => app.run(this.showBeams()));
    this.time = new TimeBar(app);
    app.list.files.forEach((file) => this.addFile(file));
    app.section('Files', this.fileRows, ...app.list.notes.map((note) => el('p', { class: 'note' }, note)));
    app.section(
      'Display',
      ...[this.pointMode, map, size, lighting, budget, drawer].map((c) => c.row),
      ...[this.worldMode, elementMap, sigmas, opaque, legend].map((c) => c.row),
    );
    app.section('Slice', ...[this.sliceOn, axis, this.sliceAt, thickness].map((c) => c.row));
    app.section('Beams and time', this.beamBox, ...this.time.rows);
    app.onApply.push(() => this.apply());
  }

  /** Lists a file that is new. */
  addFile(file: ServedFile): void {
    const { app } = this;
    const box = check(`${file.name} (${file.kind})`, app.shown.has(file.id), (on) => app.run(this.toggle(file, on)));
    this.fileBoxes.set(file.id, box);
    this.fileRows.append(box.row);
  }

  async toggle(file: ServedFile, on: boolean): Promise<void> {
    const { app } = this;
    if (file.kind === 'score') {
      if (on) app.showDetails(await scoreDetails(file, this.actions));
      else app.closeDetails();
      return;
    }
    if (on) app.shown.add(file.id);
    else app.shown.delete(file.id);
    this.fileBoxes.get(file.id)?.set(on);
    const first = app.viewer.clouds.size + app.viewer.worlds.size === 0;
    await app.files.show(file.id, on);
    if (on && (first || (file.kind === 'primitives' && !this.restoring))) app.frame();
    this.limits();
    app.apply();
  }

  /** The times that are shown, in seconds since the first beam. */
  shownTimes(): [number, number] {
    return this.time.shown();
  }

  /** Keeps the view in the address, in a moment. */
  keepLink(): void {
    if (this.restoring) return;
    const { app } = this;
    clearTimeout(this.linkTimer);
    root.dataset.link = 'old';
    this.linkTimer = window.setTimeout(() => {
      // In world coordinates, because the scene's origin depends on which file was shown first.
      const origin = app.files.origin ?? new Vector3();
      const { camera, navigation } = app.viewer;
      const world = {
        ...app.state,
        eye: camera.position.clone().add(origin).toArray(),
        target: navigation.target.clone().add(origin).toArray(),
        shown: [...app.shown].sort((a, b) => a - b),
        slice: { ...app.state.slice, at: app.state.slice.at + origin[app.state.slice.axis] },
      };
      history.replaceState(null, '', hashOf(world));
      root.dataset.link = 'new';
    }, 300);
  }

  private apply(): void {
    const { state, viewer } = this.app;
    viewer.display.setMap(state.elementMap);
    viewer.display.setSlice(state.slice);
    viewer.points.lighting = state.lighting;
    viewer.points.drawer = state.drawer;
    this.legend.show();
    const [low, high] = viewer.display.uniforms.heights.value.toArray();
    for (const cloud of viewer.clouds) {
      cloud.setPaint(state.points, state.map, [low, high]);
      cloud.setSize(state.size * viewer.pixelRatio);
    }
    for (const world of viewer.worlds) {
      world.setMode(state.worlds);
      world.setRadius(state.sigmas);
      world.setOpaque(state.opaque);
    }
    root.dataset.theme =
      state.theme || (window.matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark');
    viewer.setBackground(getComputedStyle(root).getPropertyValue('--view').trim());
    this.keepLink();
  }

  private async showBeams(): Promise<void> {
    const [file, run] = this.beamBox.value.split(' ').map(Number);
    const { app } = this;
    app.tell(await app.files.showBeams(file ?? 0, this.beamBox.value === '' ? null : run!));
    this.legend.beams = this.beamBox.value !== '';
    this.legend.show();
    root.dataset.beams = app.status.textContent ?? '';
  }

  /** Fits the sliders to what is shown. */
  limits(): void {
    const { viewer, files, state } = this.app;
    const box = viewer.bounds();
    this.sliceAt.limits(box.min[state.slice.axis], box.max[state.slice.axis]);
    let end = 0;
    let first = Infinity;
    const runs = [el('option', { value: '' }, 'no beams')];
    for (const [id, cloud] of files.clouds) {
      const facts = cloud.octree.facts;
      end = Math.max(end, facts.last_time_s - facts.first_time_s);
      first = Math.min(first, facts.first_time_s);
      cloud.octree.runs.slice(0, 2000).forEach((run, k) => {
        const text = `${files.file(id).name}: scan ${run.scan}, ${(run.time - facts.first_time_s).toFixed(2)} s`;
        runs.push(el('option', { value: `${id} ${k}` }, text));
      });
    }
    const moving = files.clouds.size === 0 ? this.movingTimes() : null;
    if (moving) this.time.setSpan(moving[1] - moving[0], moving[0]);
    else this.time.setSpan(end, Number.isFinite(first) ? first : 0);
    this.app.run(this.time.showPaths());
    const kept = this.beamBox.value;
    this.beamBox.replaceChildren(...runs);
    this.beamBox.value = kept;
  }
}
