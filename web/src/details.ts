// What the page tells of the thing that was picked.
import { json, type Beam, type ServedFile, type Trace } from './api';
import { button, el, facts, grid, shortened } from './panel';
import type { Picked } from './picker';

export interface DetailActions {
  /** The worlds in which a beam can be followed. */
  worlds: () => ServedFile[];
  follow: (beam: Beam, file: number, world: ServedFile) => void;
  /** Shows the waveform of a beam; `sensor` is '' for the log's own. */
  receive: (beam: Beam, file: number, world: ServedFile, sensor: string) => void;
  sensors: string[];
  /** The sensor that was chosen last. */
  sensor: () => string;
  close: () => void;
}

function place(at: readonly number[]): string {
  return at.map((v) => v.toFixed(3)).join(', ');
}

export function head(title: string, actions: DetailActions): HTMLElement {
  return el('div', { class: 'head' }, el('h2', {}, title), button('×', 'Close (Escape)', actions.close));
}

/** Facts of a beam, and a way to ask why it ended. */
export function beamDetails(beam: Beam, file: ServedFile, actions: DetailActions): HTMLElement[] {
  const outcome = beam.hit ? `${shortened(beam.range_m)} m` : beam.inferred ? 'inferred miss' : 'miss';
  const rows: [string, string][] = [
    ['log', file.name],
    ['row', `${beam.row}`],
    ['beam', `${beam.beam}`],
    ['range', outcome],
    ['end', `${place(beam.end_m)} m`],
    ['origin', `${place(beam.origin_m)} m`],
    ['intensity', shortened(beam.intensity)],
    ['time', `${beam.time_s.toFixed(6)} s`],
    ['ring', `${beam.ring}`],
    ['scan', `${beam.scan}`],
    ['packet', `${beam.packet}`],
  ];
  if (beam.echoes_m.length > 1) rows.push(['echoes', beam.echoes_m.map((r) => `${shortened(r)} m`).join(', ')]);
  for (const [name, value] of Object.entries(beam.columns ?? {})) rows.push([name, shortened(value)]);
  const ask = actions.worlds().map((world) =>
    button(`Why did this beam end here? (${world.name})`, 'Follow the beam (B)', () =>
      actions.follow(beam, file.id, world),
    ),
  );
  if (actions.worlds().length === 0) return [head('Beam', actions), facts(rows)];
  const sensor = el('select', {}, ...['', ...actions.sensors].map((s) => el('option', { value: s }, s || "the log's own")));
  sensor.value = actions.sensor();
  const waves = actions.worlds().map((world) =>
    button(`Waveform and echoes (${world.name})`, 'What the sensor receives of this beam (;)', () =>
      actions.receive(beam, file.id, world, sensor.value),
    ),
  );
  return [head('Beam', actions), facts(rows), ...ask, el('label', { class: 'row' }, 'Sensor', sensor), ...waves];
}

/** The elements that a beam meets, in order, with their trials. */
export function traceDetails(trace: Trace, world: ServedFile, actions: DetailActions): HTMLElement[] {
  const real = trace.real_range_m === null ? 'a miss' : `${shortened(trace.real_range_m)} m`;
  const answer = trace.simulated_range_m === null ? 'a miss' : `${shortened(trace.simulated_range_m)} m`;
  const end =
    trace.ends_by === 'keyframe'
      ? `${answer}, from a keyframe of the model and not from its elements`
      : trace.ends_by === 'unknown space'
      ? `${answer}, in space that no beam of the model's log crossed`
      : trace.ends_at === null
      ? 'no element stops it: a miss'
      : `the ${trace.met[trace.ends_at]?.kind ?? 'element'} no. ${trace.ends_at + 1} stops it at ${answer}`;
  const few = (value: number) => (value === 0 ? '0' : value < 0.001 ? value.toExponential(0) : value.toFixed(3));
  const rows = trace.met.map((m, k) => [
    `${k + 1}${k === trace.ends_at ? ' ◀' : ''}`,
    m.range_m.toFixed(2),
    `${m.kind} ${m.index}`,
    m.class,
    few(m.p),
    few(m.draw),
    m.accepts ? 'stops' : 'passes',
    few(m.reach),
    `${m.hits}/${m.misses}`,
  ]);
  const headings = ['no.', 'range, m', 'element', 'class', 'p', 'draw', 'trial', 'reached by', 'hits/misses'];
  const table = grid(headings, rows);
  table.classList.add('wide');
  return [
    head('Why the beam ends', actions),
    el(
      'p',
      {},
      `Beam ${trace.beam} in ${world.name}, seed ${trace.seed}. Measured: ${real}. Simulated: ${end}. ` +
        `It meets ${trace.met_in_all} elements; a beam passes all of them with probability ` +
        `${shortened(trace.miss_probability)}. An element stops the beam if its draw is below p.`,
    ),
    el('div', { class: 'scroll', tabindex: '0' }, table),
  ];
}

/** Facts of an element of a world. */
export function elementDetails(picked: Picked, actions: DetailActions): HTMLElement[] {
  if (picked.target.kind !== 'world') return [];
  const { world, instance, part } = picked.target;
  const placed = world.facts.instances[instance]!;
  const model = world.facts.models[placed.model]!;
  const rows: [string, string][] = [
    ['file', world.file.name],
    ['model', model.name],
    ['instance', `${instance}, ${placed.class}${placed.moves ? ', moves' : ''}`],
    ['element', part === 'ellipsoid' ? `ellipsoid ${picked.part}` : `${part}, triangle ${picked.part}`],
  ];
  const hit = part === 'ellipsoid' ? world.ellipsoid(instance, picked.part) : world.triangle(instance, part, picked.part);
  rows.push(['p', shortened(hit.p)], ['hits', `${hit.hits}`], ['misses', `${hit.misses}`]);
  if (part === 'ellipsoid') {
    const e = world.ellipsoid(instance, picked.part);
    rows.push(
      ['class', world.facts.classes[e.label] ?? `${e.label}`],
      ['deviations in x, y, z', `${e.semiAxes.map(shortened).join(', ')} m`],
    );
  }
  if (picked.place) {
    const origin = world.facts.origin_m;
    const at = picked.place.clone().sub(world.group.position).toArray();
    rows.push(['place', `${place(at.map((v, k) => v + origin[k as 0 | 1 | 2]))} m`]);
  }
  return [head('Element', actions), facts(rows)];
}

type Scores = Record<string, number | null | Record<string, number | null>>;

/** The scores of a simulation as tables. */
export async function scoreDetails(file: ServedFile, actions: DetailActions): Promise<HTMLElement[]> {
  const all = await json<Scores & { models: Record<string, Scores & { per_class?: Record<string, Scores> }> }>(
    `score?file=${file.id}`,
  );
  const names = Object.keys(all.models);
  const first = all.models[names[0]!]!;
  const isNumber = (v: unknown): v is number | null => v === null || typeof v === 'number';
  const keys = Object.keys(first).filter((k) => isNumber(first[k]));
  const rows = keys.map((k) => [k, ...names.map((n) => shortened(all.models[n]![k] as number | null))]);
  const out = [head(file.name, actions), el('div', { class: 'scroll', tabindex: '0' }, grid(['score', ...names], rows))];
  for (const part of ['per_class', 'per_range'] as const) {
    const parts = first[part] as unknown as Record<string, Record<string, number | null>> | undefined;
    if (!parts || Object.keys(parts).length === 0) continue;
    const wanted = ['beams', 'f1', 'packet_error_m', 'median_range_error_m'];
    const table = Object.entries(parts).map(([name, s]) => [name, ...wanted.map((k) => shortened(s[k]))]);
    out.push(
      el('h3', {}, part === 'per_class' ? `${names[0]!}, by class` : `${names[0]!}, by range (m)`),
      el('div', { class: 'scroll', tabindex: '0' }, grid(['part', ...wanted], table)),
    );
  }
  return out;
}
