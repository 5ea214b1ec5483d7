// Which times are shown, playing them, and the path of the sensor.
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Points, PointsMaterial } from 'three';
import { bytes } from './api';
import type { App } from './context';
import type { Action } from './keys';
import type { Octree } from './octree';
import { button, check, el, root, select, slider } from './panel';

const SPEEDS = ['0.1', '0.25', '0.5', '1', '2', '5'] as const;

/** The path of one sensor: times since the first beam (s), and places relative to the cloud. */
interface Path {
  times: Float32Array;
  places: Float32Array;
  group: Group;
  dot: Points;
}

async function loadPath(file: number): Promise<Path> {
  const data = new Float32Array((await bytes(`trajectory?file=${file}`)).slice(4));
  const n = data.length / 4;
  const times = new Float32Array(n);
  const places = new Float32Array(3 * n);
  for (let k = 0; k < n; ++k) {
    times[k] = data[4 * k]!;
    places.set(data.subarray(4 * k + 1, 4 * k + 4), 3 * k);
  }
  const group = new Group();
  const line = new BufferGeometry();
  line.setAttribute('position', new BufferAttribute(places, 3));
  const at = new BufferGeometry();
  at.setAttribute('position', new BufferAttribute(new Float32Array(3), 3));
  const dot = new Points(at, new PointsMaterial({ color: 0xf0e442, size: 10, sizeAttenuation: false, depthTest: false }));
  const path = new Line(line, new LineBasicMaterial({ color: 0xe69f00 }));
  [path, dot].forEach((object) => {
    object.frustumCulled = false;
    object.renderOrder = 9;
  });
  group.add(path, dot);
  return { times, places, group, dot };
}

/** Places the dot where the sensor is at a time. */
function putDot(path: Path, time: number): void {
  const { times, places, dot } = path;
  let k = times.findIndex((t) => t >= time);
  if (k < 0) k = times.length - 1;
  const before = Math.max(0, k - 1);
  const span = times[k]! - times[before]!;
  const share = span > 0 ? Math.min(1, Math.max(0, (time - times[before]!) / span)) : 1;
  const at = dot.geometry.getAttribute('position') as BufferAttribute;
  for (let c = 0; c < 3; ++c) {
    const [a, b] = [places[3 * before + c]!, places[3 * k + c]!];
    at.array[c] = a + share * (b - a);
  }
  at.needsUpdate = true;
}

export class TimeBar {
  /** Rows for the menu. */
  readonly rows: HTMLElement[];
  /** Called with the time when another one is shown. */
  readonly onTime: ((time: number) => void)[] = [];
  /** The time of the log at which the bar begins, s. */
  first = 0;
  private span = 0;
  private speed = 1;
  private time = 0;
  private window = 0;
  private readonly timeSlider;
  private readonly windowSlider;
  private readonly pathBox;
  private readonly playButton = button('Play', 'Play or stop the time (\\)', () => this.play());
  private readonly paths = new Map<number, Path>();
  private playing = 0;
  private last = 0;

  constructor(private readonly app: App) {
    this.timeSlider = slider('Time, s', [0, 1, 0.01], 1, (v) => this.set(v, this.window));
    this.windowSlider = slider('and before, s', [0, 1, 0.01], 1, (v) => this.set(this.time, v));
    this.windowSlider.row.title = 'Points of so many seconds before the time are shown';
    this.pathBox = check('Path of the sensor', false, () => app.run(this.showPaths()));
    const speed = select('Speed', SPEEDS, '1', (v) => (this.speed = Number(v)));
    speed.row.title = 'Seconds of the log that pass in a second';
    this.rows = [this.timeSlider.row, this.windowSlider.row, el('div', { class: 'buttons' }, this.playButton), speed.row, this.pathBox.row];
  }

  /** The times that are shown, in seconds since the first beam. */
  shown(): [number, number] {
    return [Math.max(0, this.time - this.window), this.time];
  }

  /** Fits the sliders to the longest log that is shown; all times are shown. */
  setSpan(span: number, first: number): void {
    if (span === this.span && first === this.first) return;
    this.span = span;
    this.first = first;
    this.timeSlider.limits(0, span);
    this.windowSlider.limits(0, span);
    this.set(span, span);
  }

  set(time: number, window: number): void {
    this.time = time;
    this.window = window;
    this.timeSlider.set(time);
    this.windowSlider.set(window);
    const [from, to] = this.shown();
    for (const cloud of this.app.viewer.clouds) {
      const { first_time_s: first, last_time_s: last } = cloud.octree.facts;
      cloud.setTimes(from - 1e-3, to >= last - first - 1e-3 ? last - first + 1 : to);
    }
    this.paths.forEach((path) => putDot(path, time));
    this.onTime.forEach((act) => act(time));
    root.dataset.time = time.toFixed(3);
    this.app.viewer.draw();
  }

  /** Shows the times of a scan of a log alone, or all if there is no such scan. */
  showScan({ runs, facts }: Octree, scan: number | null): void {
    const [from, to] = [facts.first_time_s, facts.last_time_s];
    const first = runs.findIndex((run) => run.scan === scan);
    if (first < 0) return this.set(to - from, to - from);
    const next = runs.slice(first).find((run) => run.scan !== scan);
    const [begin, end] = [runs[first]!.time, next?.time ?? to];
    this.set(end - from, end - begin);
  }

  /** The scan of a log at the time that is shown. */
  scanShown({ runs, facts }: Octree): number {
    const before = runs.filter((run) => run.time - facts.first_time_s < this.time - 1e-6);
    return (before.at(-1) ?? runs[0])?.scan ?? 0;
  }

  /** Shows the paths of the logs that are shown, or hides them. */
  async showPaths(): Promise<void> {
    const { files, viewer } = this.app;
    const on = this.pathBox.on();
    for (const [id, cloud] of files.clouds) {
      if (on && cloud.group.visible && !this.paths.has(id)) {
        const path = await loadPath(id);
        path.group.position.copy(cloud.group.position);
        putDot(path, this.time);
        this.paths.set(id, path);
        viewer.overlays.add(path.group);
      }
      const path = this.paths.get(id);
      if (path) path.group.visible = on && cloud.group.visible;
    }
    root.dataset.paths = String([...this.paths.values()].filter((path) => path.group.visible).length);
    viewer.draw();
  }

  private play(): void {
    if (this.playing) {
      cancelAnimationFrame(this.playing);
      this.playing = 0;
      this.playButton.textContent = 'Play';
      return;
    }
    if (this.window >= this.span) this.set(0, Math.max(this.span / 20, Math.min(this.span, 0.2)));
    if (this.time >= this.span) this.set(0, this.window);
    this.playButton.textContent = 'Stop';
    this.last = performance.now();
    const step = (now: number) => {
      this.set(Math.min(this.span, this.time + (this.speed * (now - this.last)) / 1000), this.window);
      this.last = now;
      if (this.time >= this.span) this.play();
      else this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
  }

  actions(): Action[] {
    const path = () => {
      this.pathBox.set(!this.pathBox.on());
      this.app.run(this.showPaths());
    };
    return [
      { key: '\\', name: 'play or stop the time', act: () => this.play() },
      { key: "'", name: 'path of the sensor', act: path },
    ];
  }
}
