// What a click does: facts of what lies there, why a beam ended, and measuring.
import { Vector3 } from 'three';
import { type Beam, type BeamEchoes, json, query, type ServedFile, type Trace } from './api';
import { markBeam } from './beams';
import type { App } from './context';
import { beamDetails, type DetailActions, elementDetails, traceDetails } from './details';
import { root, shortened } from './panel';
import type { Picked } from './picker';
import { waveformDetails } from './waveform';

export class Picking {
  readonly actions: DetailActions;
  /** Called with the file and the row of a beam that was picked. */
  readonly onBeam: ((file: number, row: number) => void)[] = [];
  private picked: { beam: Beam; file: number } | null = null;
  private measuring: Vector3[] | null = null;
  private sensor = '';

  constructor(private readonly app: App) {
    this.actions = {
      worlds: () => [...app.of('model'), ...app.of('scene')],
      follow: (beam, file, world) => app.run(this.follow(beam, file, world)),
      receive: (beam, file, world, sensor) => app.run(this.receive(beam, file, world, sensor)),
      sensors: app.list.sensors,
      sensor: () => this.sensor,
      close: () => app.closeDetails(),
    };
    app.onClose.push(() => {
      this.picked = null;
      this.measuring = null;
    });
  }

  /** Follows the picked beam through the first world. */
  followPicked(): void {
    const world = this.actions.worlds()[0];
    if (this.picked && world) this.actions.follow(this.picked.beam, this.picked.file, world);
  }

  /** Shows the waveform of the picked beam in the first world. */
  receivePicked(): void {
    const world = this.actions.worlds()[0];
    if (this.picked && world) this.actions.receive(this.picked.beam, this.picked.file, world, this.sensor);
  }

  toggleMeasure(): void {
    this.measuring = this.measuring ? null : [];
    this.app.tell(this.measuring ? 'Measure: pick the first place' : '');
    if (!this.measuring) this.app.viewer.mark();
  }

  async pick(hit: Picked | null): Promise<void> {
    root.dataset.picked = hit ? `${hit.target.kind} ${hit.part}` : 'nothing';
    if (this.measuring) return this.measure(hit?.place ?? null);
    if (!hit) return this.app.closeDetails();
    try {
      if (hit.target.kind === 'point') await this.showBeam(hit.target.cloud.octree.file, hit.part);
      else if (hit.target.kind === 'beam') await this.showBeam(hit.target.file, hit.part);
      else this.app.showDetails(elementDetails(hit, this.actions));
    } catch (error) {
      this.app.fail(error);
    }
  }

  private async follow(beam: Beam, file: number, world: ServedFile): Promise<void> {
    const { app } = this;
    const trace = await json<Trace>(`trace?file=${file}&row=${beam.row}&world=${world.id}&seed=${app.list.seed}`);
    app.viewer.mark(markBeam(beam, trace, app.files.origin!));
    app.showDetails(traceDetails(trace, world, this.actions));
  }

  private async receive(beam: Beam, file: number, world: ServedFile, sensor: string): Promise<void> {
    const { app } = this;
    this.sensor = sensor;
    const seed = app.list.seed;
    const told = await json<BeamEchoes>(`echoes?${query({ file, row: beam.row, world: world.id, sensor, seed })}`);
    app.viewer.mark(markBeam(beam, null, app.files.origin!, told.echoes.map((e) => e.range_m)));
    app.showDetails(waveformDetails(told, beam, world, this.actions));
  }

  /** Shows a beam by one of its rows. */
  async showBeam(file: number, row: number): Promise<void> {
    const { app } = this;
    const beam = await json<Beam>(`beam?file=${file}&row=${row}`);
    this.picked = { beam, file };
    app.viewer.mark(markBeam(beam, null, app.files.origin!));
    app.showDetails(beamDetails(beam, app.files.file(file), this.actions));
    this.onBeam.forEach((act) => act(file, row));
  }

  private measure(place: Vector3 | null): void {
    const { app } = this;
    if (!place || !this.measuring) return;
    this.measuring.push(place);
    const [from, to] = this.measuring;
    if (!from || !to) {
      app.tell('Measure: pick the second place');
      return;
    }
    const by = to.clone().sub(from);
    app.viewer.mark(app.viewer.measured(from, to));
    app.tell(
      `Distance ${shortened(by.length())} m, level ${shortened(Math.hypot(by.x, by.y))} m, ` +
        `height ${shortened(by.z)} m`,
    );
    root.dataset.measured = String(by.length());
    this.measuring = [];
  }
}
