// Beams as lines: those of a scan, and one beam with what it meets in a world.
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Points,
  PointsMaterial,
  type ShaderMaterial,
  Vector3,
} from 'three';
import { bytes, type Beam, type Trace } from './api';
import { type Display, material } from './display';
import { floatColumn, numberColumn, twice } from './unpack';

const BEAM_BYTES = 32;

const VERTEX = /* glsl */ `
  attribute vec4 rowBytes;
  attribute float kind;
  varying vec3 place;
  varying vec4 part;
  varying float outcome;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    part = rowBytes;
    outcome = kind;
    gl_Position = projectionMatrix * viewMatrix * world;
  }
`;

// Hits are blue, misses orange, inferred misses light orange: the colours of Okabe and Ito.
const FRAGMENT = /* glsl */ `
  varying vec3 place;
  varying vec4 part;
  varying float outcome;
  void main() {
    if (sliced(place)) discard;
    vec3 colour = outcome > 1.5 ? vec3(0.95, 0.81, 0.5) : outcome > 0.5 ? vec3(0.34, 0.71, 0.91) : vec3(0.9, 0.62, 0.0);
    gl_FragColor = pass == 0 ? vec4(colour, 1.0) : pass == 1 ? bytesOf(object) : part;
  }
`;

/** The beams of a run of a log. */
export async function loadBeams(
  file: number,
  run: number,
  display: Display,
  place: Vector3,
  pick: number,
): Promise<{ lines: LineSegments; beams: number; step: number }> {
  const view = new DataView(await bytes(`beams?file=${file}&run=${run}`));
  const beams = view.getUint32(0, true);
  const step = view.getUint32(4, true);
  const records = { start: 8, bytes: BEAM_BYTES, count: beams };
  const position = floatColumn(view, records, 0, 6);
  const rows = twice(numberColumn(view, records, 24));
  const kind = Float32Array.from(twice(numberColumn(view, records, 28)));
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  geometry.setAttribute('rowBytes', new BufferAttribute(new Uint8Array(rows.buffer), 4, true));
  geometry.setAttribute('kind', new BufferAttribute(kind, 1));
  const look: ShaderMaterial = material(display, { object: { value: pick } }, VERTEX, FRAGMENT);
  const lines = new LineSegments(geometry, look);
  lines.position.copy(place);
  lines.frustumCulled = false;
  return { lines, beams, step };
}

/** Marks one beam: its line, a dot for each element that it meets, and a dot for each simulated echo. */
export function markBeam(beam: Beam, trace: Trace | null, origin: Vector3, echoes: number[] = []): Group {
  const group = new Group();
  const from = new Vector3(...beam.origin_m).sub(origin);
  const direction = new Vector3(...beam.direction);
  const to = new Vector3(...beam.end_m).sub(origin);
  const line = new BufferGeometry().setFromPoints([from, to]);
  group.add(new LineSegments(line, new LineBasicMaterial({ color: 0xd55e00 })));
  const dots = (at: Vector3[], color: number, size: number) => {
    const geometry = new BufferGeometry().setFromPoints(at);
    const look = new PointsMaterial({ color, size, sizeAttenuation: false, depthTest: false });
    group.add(new Points(geometry, look));
  };
  if (beam.hit) dots([to], 0xd55e00, 10);
  const at = (range: number) => from.clone().addScaledVector(direction, range);
  if (echoes.length > 0) dots(echoes.map(at), 0xf0e442, 10);
  if (trace) {
    dots(trace.met.filter((m) => !m.accepts).map((m) => at(m.range_m)), 0x56b4e9, 7);
    dots(trace.met.filter((m) => m.accepts).map((m) => at(m.range_m)), 0xcc79a7, 7);
    if (trace.simulated_range_m !== null) dots([at(trace.simulated_range_m)], 0xf0e442, 10);
  }
  group.traverse((child) => (child.renderOrder = 10));
  return group;
}

export function disposeAll(group: Group | LineSegments): void {
  group.traverse((child) => {
    if (child instanceof LineSegments || child instanceof Points) {
      (child.geometry as BufferGeometry).dispose();
      (child.material as ShaderMaterial).dispose();
    }
  });
}
