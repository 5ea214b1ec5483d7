'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const page = document.getElementById('page');
const names = Object.keys(data.scores.models);
const ink = ['var(--a)', 'var(--b)', 'var(--c)', 'var(--d)'];
const colourOf = name => ink[names.indexOf(name) % ink.length];

function add(parent, tag, props = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (key in node) node[key] = value; else node.setAttribute(key, value);
  }
  node.append(...children);
  parent.append(node);
  return node;
}
function drawn(parent, tag, props, text) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [key, value] of Object.entries(props)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  parent.append(node);
  return node;
}
const show = (x, digits) => x === null || x === undefined ? 'n/a' : x.toFixed(digits);
const percent = x => (100 * x).toFixed(x < 0.1 ? 2 : 1) + ' %';

const metrics = [
  ['packet_error_m', 'Packet error, m', 'mean distance of simulated and real point where both have one', 3, -1],
  ['f1', 'F1', 'hits and misses right: harmonic mean of precision and recall', 4, 1],
  ['precision', 'Precision', 'simulated hits that are real', 4, 1],
  ['recall', 'Recall', 'real hits that are simulated', 4, 1],
  ['cloud_error_m', 'Point cloud error, m', 'mean distance to the nearest point of the other cloud, both ways', 4, -1],
  ['density_aware_chamfer', 'Density-aware Chamfer', '0 same cloud, 1 nothing alike; sees clumping', 4, -1],
  ['median_range_error_m', 'Median range error, m', 'half of the true hits are nearer than this', 3, -1],
  ['nll_per_beam', 'Neg. log-likelihood', 'of the real outcome under the model, a beam', 3, -1],
  ['crps_m', 'CRPS of the range, m', 'distance of the predicted distribution from the outcome', 3, -1]];

function table(head, rows) {
  const box = add(page, 'div', {className: 'scroll'}), t = add(box, 'table');
  const tr = add(add(t, 'thead'), 'tr');
  head.forEach(h => add(tr, 'th', {}, h));
  const body = add(t, 'tbody');
  for (const row of rows) {
    const r = add(body, 'tr');
    for (const cell of row) {
      const {text, best, small} = typeof cell === 'string' ? {text: cell} : cell;
      const td = add(r, 'td', {className: best ? 'best' : ''}, text);
      if (small) add(td, 'small', {}, small);
    }
  }
}

function headline() {
  add(page, 'h1', {}, data.title);
  add(page, 'p', {className: 'lead'}, `${data.scores.beams.toLocaleString('en')} beams, each answered by ` +
    (names.length > 1 ? 'every model' : 'the model') + ' and compared with what was measured.');
  if (data.note) add(page, 'div', {className: 'banner'}, data.note);
  table(['', ...names], metrics.map(([key, title, small, digits, sign]) => {
    const values = names.map(n => data.scores.models[n][key]);
    const known = values.filter(v => v !== null);
    const best = known.length > 1 ? (sign > 0 ? Math.max(...known) : Math.min(...known)) : NaN;
    return [{text: title, small}, ...values.map(v => ({text: show(v, digits), best: v === best}))];
  }));
}

function figures(title, caption, list) {
  add(page, 'h2', {}, title);
  if (caption) add(page, 'p', {className: 'caption'}, caption);
  const grid = add(page, 'div', {className: 'pictures'});
  for (const [name, source] of list) {
    const f = add(grid, 'figure');
    add(f, 'img', {src: source, alt: `${title}: ${name}`});
    add(f, 'figcaption', {}, name);
  }
}

function legend() {
  const box = add(page, 'div', {className: 'legend'});
  for (const [colour, text] of [['rgb(20,80,220)', `too near by ${data.error_span_m} m or more`], ['rgb(205,205,205)', 'agrees'],
    ['rgb(200,20,20)', `too far by ${data.error_span_m} m or more`], ['rgb(214,39,190)', 'false hit: nothing there'],
    ['rgb(240,180,0)', 'false miss: drawn at the real point']]) {
    const item = add(box, 'span');
    add(item, 'i', {style: `background:${colour}`});
    item.append(text);
  }
}

function wide(list) {
  for (const [name, source] of list) {
    add(page, 'p', {className: 'caption'}, name);
    add(add(page, 'div', {className: 'wide'}), 'img', {src: source, alt: name});
  }
}

function pictures() {
  const [real, ...sims] = data.pictures;
  const perPixel = real.metres_per_pixel;
  figures('From above', `All beams, highest point of each pixel (${(100 * perPixel).toFixed(0)} cm), coloured by height.`,
    data.pictures.map(p => [p.name, p.above]));
  figures('Where it goes wrong', 'Every beam at its simulated point, coloured by range error.', sims.map(p => [p.name, p.error]));
  legend();
  add(page, 'h2', {}, `One scan (${data.scan}) as the sensor sees it`);
  add(page, 'p', {className: 'caption'}, 'Ring by azimuth, forward in the middle; violet near, yellow far, white no return.');
  wide([['real', real.range]]);
  for (const p of sims) wide([[p.name, p.range], [`${p.name}: error`, p.range_error]]);
}

function axes(width, height, left, bottom, xs, ys, xText, yText) {
  const svg = drawn(page, 'svg', {viewBox: `0 0 ${width} ${height}`, role: 'img'});
  const x = v => left + (v - xs[0]) / (xs[1] - xs[0]) * (width - left - 12);
  const y = v => height - bottom - (v - ys[0]) / (ys[1] - ys[0]) * (height - bottom - 14);
  drawn(svg, 'line', {x1: left, x2: width - 12, y1: y(ys[0]), y2: y(ys[0]), stroke: 'var(--line)'});
  drawn(svg, 'text', {x: width - 12, y: height - 4, 'text-anchor': 'end'}, xText);
  drawn(svg, 'text', {x: 6, y: 12}, yText);
  return {svg, x, y};
}

function lineLegend() {
  const box = add(page, 'div', {className: 'legend'});
  for (const n of names) add(box, 'span', {}, add(document.createElement('span'), 'i', {style: `background:${colourOf(n)}`}), n);
}

function histogram() {
  add(page, 'h2', {}, 'Range error');
  add(page, 'p', {className: 'caption'}, 'Simulated minus real range of the true hits; the ends hold all beyond.');
  const log = add(page, 'button', {type: 'button'}, 'log scale');
  lineLegend();
  const place = add(page, 'div');
  const plot = logarithmic => {
    place.replaceChildren();
    const series = names.map(n => {
      const h = data.scores.models[n].range_error_histogram, all = h.below_bins_above.reduce((a, b) => a + b, 0) || 1;
      return h.below_bins_above.map((c, k) => [h.from_m + (k - 0.5) * h.bin_m, c / all]);
    });
    const floor = 1e-5, f = v => logarithmic ? Math.log10(Math.max(v, floor)) : v;
    const top = f(Math.max(floor, ...series.flat().map(p => p[1]))), h0 = data.scores.models[names[0]].range_error_histogram;
    const a = axes(900, 320, 56, 26, [h0.from_m, h0.to_m], [f(0), top], 'm', 'share of true hits');
    place.append(a.svg);
    for (let m = h0.from_m; m <= h0.to_m; m += 0.5) drawn(a.svg, 'text', {x: a.x(m), y: 310, 'text-anchor': 'middle'}, m.toFixed(1));
    for (let k = 1; k <= 4; k++) {
      const v = f(0) + (top - f(0)) * k / 4;
      drawn(a.svg, 'line', {x1: 56, x2: 888, y1: a.y(v), y2: a.y(v), stroke: 'var(--line)', 'stroke-dasharray': '2 4'});
      drawn(a.svg, 'text', {x: 50, y: a.y(v) + 4, 'text-anchor': 'end'}, percent(logarithmic ? 10 ** v : v));
    }
    series.forEach((s, k) => drawn(a.svg, 'polyline', {points: s.map(p => `${a.x(p[0])},${a.y(f(p[1]))}`).join(' '),
      fill: 'none', stroke: colourOf(names[k]), 'stroke-width': 2}));
  };
  log.onclick = () => {
    const on = log.getAttribute('aria-pressed') !== 'true';
    log.setAttribute('aria-pressed', on);
    plot(on);
  };
  plot(false);
}

function bars(title, caption, keys, value, text) {
  if (!keys.length) return;
  add(page, 'h2', {}, title);
  add(page, 'p', {className: 'caption'}, caption);
  lineLegend();
  const top = Math.max(1e-9, ...names.flatMap(n => keys.map(k => value(n, k) ?? 0)));
  const a = axes(900, 260, 20, 26, [0, keys.length], [0, top * 1.12], '', '');
  page.append(a.svg);
  const width = 840 / keys.length * 0.8 / names.length;
  keys.forEach((k, i) => {
    drawn(a.svg, 'text', {x: a.x(i + 0.5), y: 252, 'text-anchor': 'middle'}, k);
    names.forEach((n, j) => {
      const v = value(n, k), left = a.x(i + 0.1) + j * width;
      if (v === null || v === undefined) return;
      drawn(a.svg, 'rect', {x: left, y: a.y(v), width: Math.max(1, width - 3), height: a.y(0) - a.y(v), fill: colourOf(n)});
      drawn(a.svg, 'text', {x: left + width / 2, y: a.y(v) - 3, 'text-anchor': 'middle'}, text(v));
    });
  });
}

function confusion() {
  add(page, 'h2', {}, 'Hits and misses');
  for (const n of names) {
    const s = data.scores.models[n], share = x => `${x.toLocaleString('en')}  (${percent(x / Math.max(1, s.beams))})`;
    table([n, 'real hit', 'real miss'], [['simulated hit', share(s.true_hits), share(s.false_hits)],
      ['simulated miss', share(s.false_misses), share(s.true_misses)]]);
  }
}

function breakdown() {
  const all = data.scores.models;
  const ranges = Object.keys(all[names[0]].per_range).filter(k => k !== 'miss');
  bars('Packet error by range', 'm, by the real range.', ranges, (n, k) => all[n].per_range[k]?.packet_error_m, v => v.toFixed(2));
  bars('Recall by range', 'Real hits that are simulated as hits.', ranges, (n, k) => all[n].per_range[k]?.recall, v => v.toFixed(3));
  const classes = Object.keys(all[names[0]].per_class);
  if (!classes.length) return;
  add(page, 'h2', {}, 'By class');
  table(['class', 'beams', ...names.flatMap(n => [`${n}: packet error, m`, `${n}: recall`])], classes.map(c => [
    c, all[names[0]].per_class[c].beams.toLocaleString('en'),
    ...names.flatMap(n => [show(all[n].per_class[c]?.packet_error_m, 3), show(all[n].per_class[c]?.recall, 4)])]));
}

function bytesOf(text) {
  const raw = atob(text), out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out;
}

function pointView() {
  const canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl', {antialias: true});
  if (!gl) return;
  add(page, 'h2', {}, 'Look around');
  add(page, 'p', {className: 'caption'}, `Up to 40 000 points a cloud within ${data.view_m} m of scan ${data.scan}: drag to turn, pinch or scroll to zoom, two fingers or shift-drag to move.`);
  const clouds = [];
  for (const p of data.pictures) {
    clouds.push([p.name, p.points]);
    if (p.error_points) clouds.push([`${p.name}: error`, p.error_points]);
  }
  const bar = add(page, 'div');
  page.append(canvas);
  const shader = (type, source) => {
    const s = gl.createShader(type);
    gl.shaderSource(s, source);
    gl.compileShader(s);
    return s;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `attribute vec3 at; attribute vec3 ink; uniform mat4 m; uniform float size;
    varying vec3 c; void main() { gl_Position = m * vec4(at * 2.0 - 1.0, 1.0); gl_PointSize = clamp(size / gl_Position.w, 1.5, 7.0); c = ink; }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, 'precision mediump float; varying vec3 c; void main() { gl_FragColor = vec4(c, 1.0); }'));
  gl.linkProgram(program);
  gl.useProgram(program);
  const at = gl.getAttribLocation(program, 'at'), colour = gl.getAttribLocation(program, 'ink');
  const buffers = clouds.map(([, text]) => {
    const bytes = bytesOf(text), n = bytes.length / 10, b = gl.createBuffer();
    const packed = new Uint8Array(n * 12);  // aligned rows: 3 × uint16, 2 spare, 3 × uint8, 1 spare
    for (let i = 0; i < n; i++) {
      packed.set(bytes.subarray(10 * i, 10 * i + 6), 12 * i);
      packed.set(bytes.subarray(10 * i + 6, 10 * i + 9), 12 * i + 8);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, b);
    gl.bufferData(gl.ARRAY_BUFFER, packed, gl.STATIC_DRAW);
    return [b, n];
  });
  let shown = 0, yaw = 0.6, pitch = 0.7, far = 1.1, cx = 0, cy = 0;
  const draw = () => {
    const scale = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * scale;
    canvas.height = canvas.clientHeight * scale;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.063, 0.082, 0.102, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const sy = Math.sin(yaw), cyw = Math.cos(yaw), sp = Math.sin(pitch), cp = Math.cos(pitch);
    const right = [cyw, sy, 0], back = [sy * cp, -cyw * cp, sp], up = [-sy * sp, cyw * sp, cp];
    const target = [cx, cy, -0.03], eye = target.map((t, k) => t + far * back[k]);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], zoom = 1.6, aspect = canvas.width / canvas.height;
    const rows = [right.map(v => v * zoom / aspect), up.map(v => v * zoom), back.map(v => -v)];
    const t = rows.map(r => -dot(r, eye)), near = 0.01, end = 8, a = (end + near) / (end - near), b = -2 * end * near / (end - near);
    const m = [];
    for (let k = 0; k < 3; k++) m.push(rows[0][k], rows[1][k], rows[2][k] * a, rows[2][k]);
    m.push(t[0], t[1], t[2] * a + b, t[2]);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'm'), false, new Float32Array(m));
    gl.uniform1f(gl.getUniformLocation(program, 'size'), 2.2 * scale);
    const [buffer, n] = buffers[shown];
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.UNSIGNED_SHORT, true, 12, 0);
    gl.enableVertexAttribArray(colour);
    gl.vertexAttribPointer(colour, 3, gl.UNSIGNED_BYTE, true, 12, 8);
    gl.drawArrays(gl.POINTS, 0, n);
  };
  clouds.forEach(([name], k) => {
    const button = add(bar, 'button', {type: 'button'}, name);
    button.setAttribute('aria-pressed', k === 0);
    button.onclick = () => {
      shown = k;
      [...bar.children].forEach((b, j) => b.setAttribute('aria-pressed', j === k));
      draw();
    };
  });
  const fingers = new Map();
  canvas.onpointerdown = e => { fingers.set(e.pointerId, [e.clientX, e.clientY]); canvas.setPointerCapture(e.pointerId); };
  canvas.onpointerup = canvas.onpointercancel = e => fingers.delete(e.pointerId);
  canvas.onpointermove = e => {
    const last = fingers.get(e.pointerId);
    if (!last) return;
    const dx = e.clientX - last[0], dy = e.clientY - last[1], others = [...fingers].filter(([id]) => id !== e.pointerId);
    if (others.length) {
      const o = others[0][1], d = (x, y) => Math.hypot(x - o[0], y - o[1]);
      far = Math.min(4, Math.max(0.05, far * d(...last) / Math.max(1, d(e.clientX, e.clientY))));
    }
    if (others.length || e.shiftKey) {
      const s = 0.0015 * far;
      cx -= s * (Math.cos(yaw) * dx + Math.sin(yaw) * dy);
      cy -= s * (Math.sin(yaw) * dx - Math.cos(yaw) * dy);
    } else {
      yaw -= dx * 0.006;
      pitch = Math.min(1.55, Math.max(0.02, pitch + dy * 0.006));
    }
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    draw();
  };
  canvas.onwheel = e => { e.preventDefault(); far = Math.min(4, Math.max(0.05, far * Math.exp(e.deltaY * 0.001))); draw(); };
  window.addEventListener('resize', draw);
  draw();
}

function provenance() {
  const box = add(page, 'details');
  add(box, 'summary', {}, 'Where these figures come from');
  add(box, 'pre', {}, JSON.stringify(data.scores.provenance, null, 2));
}

try {
  page.replaceChildren();
  headline();
  pictures();
  pointView();
  confusion();
  histogram();
  breakdown();
  provenance();
  document.body.dataset.drawn = 'yes';
} catch (error) {
  add(page, 'p', {id: 'failure', className: 'banner'}, `This page could not draw itself: ${error.stack}`);
}
