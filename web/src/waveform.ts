// The waveform that an instrument receives of a beam, and its echoes.
import type { Beam, BeamEchoes, ServedFile } from './api';
import { type DetailActions, head } from './details';
import { el, grid, shortened } from './panel';

const SVG = 'http://www.w3.org/2000/svg';
const [WIDTH, HEIGHT, LEFT, BOTTOM] = [420, 170, 34, 24];

function shape(name: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const out = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, `${value}`);
  out.textContent = text;
  return out;
}

/** The signal over range, with the threshold, the echoes, and the range that was measured. */
function plot(told: BeamEchoes, measured: number | null): SVGElement {
  const ends = [...told.range_m, ...told.echoes.map((e) => e.range_m), ...(measured === null ? [] : [measured])];
  const [low, high] = ends.length > 0 ? [Math.min(...ends) - 0.5, Math.max(...ends) + 0.5] : [0, 1];
  const most = Math.max(2 * told.threshold, ...told.signal) * 1.05;
  const x = (range: number) => LEFT + ((range - low) / (high - low)) * (WIDTH - LEFT - 6);
  const y = (signal: number) => (HEIGHT - BOTTOM) * (1 - Math.max(signal, 0) / most);
  const svg = shape('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'waveform', role: 'img', 'aria-label': 'Waveform over range' });
  const step = told.range_m.length > 1 ? told.range_m[1]! - told.range_m[0]! : 1;
  let path = '';
  told.range_m.forEach((range, k) => {
    const gap = k === 0 || range - told.range_m[k - 1]! > 1.5 * step;
    path += `${gap ? 'M' : 'L'}${x(range).toFixed(1)} ${y(told.signal[k]!).toFixed(1)}`;
  });
  const level = y(told.threshold);
  svg.append(shape('path', { d: `M${LEFT} ${level}H${WIDTH}`, class: 'threshold' }));
  if (measured !== null) svg.append(shape('path', { d: `M${x(measured)} 0V${HEIGHT - BOTTOM}`, class: 'measured' }));
  told.echoes.forEach((e) => svg.append(shape('path', { d: `M${x(e.range_m)} 0V${HEIGHT - BOTTOM}`, class: 'echo' })));
  svg.append(shape('path', { d: path, class: 'signal' }));
  svg.append(shape('path', { d: `M${LEFT} 0V${HEIGHT - BOTTOM}H${WIDTH}`, class: 'axis' }));
  for (let k = 0; k <= 4; ++k) {
    const range = low + (k / 4) * (high - low);
    svg.append(shape('text', { x: x(range), y: HEIGHT - 8, 'text-anchor': k === 4 ? 'end' : 'middle' }, range.toFixed(1)));
  }
  for (const signal of [0, told.threshold, most / 1.05]) {
    svg.append(shape('text', { x: LEFT - 3, y: Math.max(9, y(signal) + 3), 'text-anchor': 'end' }, shortened(Math.round(signal))));
  }
  return svg;
}

/** The waveform and the echoes of a beam in a world. */
export function waveformDetails(told: BeamEchoes, beam: Beam, world: ServedFile, actions: DetailActions): HTMLElement[] {
  const names = [...new Set(told.echoes.flatMap((e) => Object.keys(e)))];
  const rows = told.echoes.map((e) => names.map((name) => shortened(e[name])));
  const echoes = beam.echoes_m.length > 0 ? `${beam.echoes_m.map(shortened).join(', ')} m` : 'a miss';
  return [
    head('Waveform', actions),
    el(
      'p',
      {},
      `Beam ${beam.beam} in ${world.name} as ${told.sensor} receives it, ${told.sub_rays} sub-rays, seed ${told.seed}. ` +
        `Measured (red): ${echoes}. Dashed: threshold; yellow: echoes. The signal is in units of the noise in the dark.`,
    ),
    el('figure', {}, plot(told, beam.range_m) as unknown as HTMLElement, el('figcaption', {}, 'Signal over range, m')),
    told.echoes.length > 0
      ? el('div', { class: 'scroll', tabindex: '0' }, grid(names, rows))
      : el('p', {}, 'The instrument reports no echo.'),
  ];
}
