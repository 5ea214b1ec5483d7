'use strict';
// Draws the plots and the three-dimensional view of a report; no libraries, nothing is loaded.
const by_id = (id) => document.getElementById(id);
function show_error(message) {
  const place = by_id('script-error');
  place.hidden = false;
  place.textContent += message + '\n';
}
window.onerror = (message, source, line) => show_error(`Script error: ${message} (line ${line})`);

const colour = (k) => `var(--m${k % 6})`;
const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

function button(parent, label, action, pressed) {
  const b = document.createElement('button');
  b.type = 'button';
  b.textContent = label;
  b.setAttribute('aria-pressed', String(!!pressed));
  b.onclick = () => action(b);
  parent.append(b);
  return b;
}
// Buttons of which one is pressed.
function choice(parent, labels, chosen, action) {
  const all = labels.map((label, k) => button(parent, label, () => {
    all.forEach((b, j) => b.setAttribute('aria-pressed', String(j === k)));
    action(k);
  }, k === chosen));
  return all;
}
function div(parent, name) {
  const d = document.createElement('div');
  d.className = name;
  parent.append(d);
  return d;
}
// The box of a plot at the width there is, in pixels of the page so that text keeps its size.
function frame_of(place) {
  const width = Math.max(280, Math.round(place.clientWidth || 600));
  const height = Math.round(Math.min(320, Math.max(220, width * 0.42)));
  return {width, height, left: 56, right: width - 8, top: 10, bottom: height - 30};
}
function nice_step(span, steps) {
  const power = 10 ** Math.floor(Math.log10(span / steps));
  return power * [1, 2, 5, 10].find((f) => f * power * steps >= span * 0.999);
}
const tidy = (x) => String(Number(x.toPrecision(6))).replace('-', '−');
const metres = (x) => (Math.abs(x) < 1e-9 ? 0 : x).toFixed(2).replace('-', '−');
function grid_line(f, y, label) {
  return `<line class="grid" x1="${f.left}" x2="${f.right}" y1="${y}" y2="${y}"/>` +
      `<text x="${f.left - 7}" y="${y + 4}" text-anchor="end">${label}</text>`;
}

// --- Histogram of range errors -----------------------------------------------------------------
function histogram_plot(root, data) {
  const place = root.querySelector('.histogram');
  const models = data.models.map((m, k) => ({k, name: m.name, ...m.histogram}))
      .filter((m) => m.below_bins_above)
      .map((m) => {
        const total = m.below_bins_above.reduce((a, b) => a + b, 0);
        return {...m, total, share: m.below_bins_above.map((n) => total ? n / total : 0)};
      });
  if (!models.some((m) => m.total)) {
    place.innerHTML = '<p class="caption">No beam hit in both logs.</p>';
    return;
  }
  const {from_m, to_m, bin_m} = models[0];
  const bins = models[0].share.length - 2;
  const top = Math.max(...models.map((m) => Math.max(...m.share.slice(1, -1)))) || 1;
  let log = false;
  const buttons = div(place, 'buttons');
  const plot = div(place, '');
  const readout = div(place, 'models');
  const caption = document.createElement('p');
  caption.className = 'caption';
  caption.textContent = `Simulated − measured range of the beams that hit in both, in bins of ` +
      `${tidy(bin_m * 100)} cm. Touch the plot to read it.`;
  place.append(caption);
  let f;
  const least = 1e-5;
  const y_of = (share) => {
    const part = log ? Math.log(Math.max(share, least) / least) / Math.log(top / least) : share / top;
    return f.bottom - part * (f.bottom - f.top);
  };
  const x_of = (bin) => f.left + (f.right - f.left) * bin / bins;

  function read(bin) {
    const percent = (s) => s ? `${(100 * s).toFixed(s < 0.001 ? 4 : 2)} %` : '0';
    const place_text = bin === null ? '' : `<span>${metres(from_m + bin * bin_m)} to ` +
        `${metres(from_m + (bin + 1) * bin_m)} m</span>`;
    readout.innerHTML = place_text + models.map((m) => {
      const text = bin === null ?
          `${percent(m.share[0] + m.share[bins + 1])} beyond ±${to_m} m` : percent(m.share[bin + 1]);
      return `<span><i style="background:${colour(m.k)}"></i>${escaped(m.name)}: ${text}</span>`;
    }).join('');
    const line = plot.querySelector('.reading');
    line.setAttribute('visibility', bin === null ? 'hidden' : 'visible');
    if (bin !== null) {
      line.setAttribute('x1', x_of(bin + 0.5));
      line.setAttribute('x2', x_of(bin + 0.5));
    }
  }
  function draw() {
    f = frame_of(plot);
    let svg = `<svg viewBox="0 0 ${f.width} ${f.height}" role="img" aria-label="Histogram of range errors">`;
    if (log) {
      for (let s = least; s <= top * 1.001; s *= 10) svg += grid_line(f, y_of(s), `${tidy(100 * s)} %`);
    } else {
      const step = nice_step(top, 4);
      for (let s = 0; s <= top * 1.001; s += step) svg += grid_line(f, y_of(s), `${tidy(100 * s)} %`);
    }
    for (let m = from_m; m <= to_m + 1e-9; m += nice_step(to_m - from_m, 8)) {
      svg += `<text x="${x_of((m - from_m) / bin_m)}" y="${f.bottom + 18}" text-anchor="middle">` +
          `${m > 0 ? '+' : ''}${tidy(m)}${Math.abs(m) < 1e-9 ? ' m' : ''}</text>`;
    }
    for (const m of models) {
      let path = '';
      for (let b = 0; b < bins; b++) {
        path += `${b ? 'L' : 'M'}${x_of(b).toFixed(1)} ${y_of(m.share[b + 1]).toFixed(1)}H${x_of(b + 1).toFixed(1)}`;
      }
      svg += `<path d="${path}V${f.bottom}H${f.left}Z" fill="${colour(m.k)}" opacity=".13"/>` +
          `<path d="${path}" fill="none" stroke="${colour(m.k)}" stroke-width="1.6" stroke-linejoin="round"/>`;
    }
    svg += `<line class="reading" y1="${f.top}" y2="${f.bottom}" visibility="hidden"/></svg>`;
    plot.innerHTML = svg;
    const picture = plot.firstChild;
    picture.onpointermove = picture.onpointerdown = (event) => {
      const box = picture.getBoundingClientRect();
      const x = (event.clientX - box.left) * f.width / box.width;
      const bin = Math.floor((x - f.left) / (f.right - f.left) * bins);
      read(bin >= 0 && bin < bins ? bin : null);
    };
    picture.onpointerleave = () => read(null);
    read(null);
  }
  choice(buttons, ['Linear', 'Logarithmic'], 0, (k) => { log = k === 1; draw(); });
  draw();
  return draw;
}

// --- Scores by range ---------------------------------------------------------------------------
const BAND_SCORES = [
  ['packet_error_m', 'Packet error', 'Packet error, m.', 3],
  ['median_range_error_m', 'Median range error', 'Median range error, m.', 3],
  ['cloud_error_m', 'Point cloud error', 'Point cloud error, m.', 4],
  ['recall', 'Recall', 'Recall: share of the real hits that are simulated as hits.', 4],
];
function bands_plot(root, data) {
  const place = root.querySelector('.bands');
  const bands = [...new Set(data.models.flatMap((m) => Object.keys(m.per_range)))]
      .filter((b) => b !== 'miss').sort((a, b) => parseFloat(a) - parseFloat(b));
  const names = bands.map((b) => escaped(b.endsWith('-') ? `> ${b.slice(0, -1)}` : b.replace('-', '–')));
  const value = (m, band, key) => m.per_range[band] ? m.per_range[band][key] : null;
  // A handful of beams would set the scale of the whole plot: such bands stand in the table only.
  const is_solid = (band) => Math.max(...data.models.map((m) => value(m, band, 'beams') || 0)) >= 100;
  const scores = BAND_SCORES.filter(([key]) =>
      data.models.some((m) => bands.some((b) => Number.isFinite(value(m, b, key)))));
  if (!scores.length) {
    place.innerHTML = '<p class="caption">No beam hit in both logs.</p>';
    return;
  }
  let score = scores[0];
  const buttons = div(place, 'buttons');
  const plot = div(place, '');
  const numbers = div(place, 'scroll');
  const caption = div(place, 'caption');
  function draw() {
    const [key, , text, digits] = score;
    const f = frame_of(plot);
    const of = (some) => data.models.flatMap((m) => some.map((b) => value(m, b, key))).filter(Number.isFinite);
    const solid = of(bands.filter(is_solid)), all = solid.length ? solid : of(bands);
    const most = Math.max(...all, 1e-6), least = key === 'recall' ? Math.min(...all, most - 1e-3) : 0;
    const step = nice_step(most - least, 4);
    const low = step * Math.floor(least / step + 1e-6), top = step * Math.ceil(most / step - 1e-6);
    const y_of = (v) => f.bottom - (v - low) / (top - low) * (f.bottom - f.top);
    const x_of = (j) => f.left + (f.right - f.left) * (j + 0.5) / bands.length;
    let svg = `<svg viewBox="0 0 ${f.width} ${f.height}" role="img" aria-label="${text}">`;
    for (let v = low; v <= top + step / 100; v += step) svg += grid_line(f, y_of(v), tidy(v));
    names.forEach((name, j) => {
      svg += `<text x="${x_of(j)}" y="${f.bottom + 18}" text-anchor="middle">${name}${j === names.length - 1 ? ' m' : ''}</text>`;
    });
    data.models.forEach((m, k) => {
      const points = bands.map((b, j) => [j, value(m, b, key)]).filter(([j, v]) => Number.isFinite(v) && (!solid.length || is_solid(bands[j])));
      const line = points.map(([j, v]) => `${x_of(j).toFixed(1)} ${y_of(v).toFixed(1)}`).join('L');
      if (line) svg += `<path d="M${line}" fill="none" stroke="${colour(k)}" stroke-width="2"/>`;
      for (const [j, v] of points) svg += `<circle cx="${x_of(j)}" cy="${y_of(v)}" r="4.5" fill="${colour(k)}"/>`;
    });
    plot.innerHTML = svg + '</svg>';
    const first = data.models[0];
    numbers.innerHTML = `<table><thead><tr><th>Measured range, m</th>${names.map((n) => `<th>${n}</th>`).join('')}</tr></thead><tbody>` +
        data.models.map((m, k) => `<tr><th><i style="background:${colour(k)}"></i>${escaped(m.name)}</th>` + bands.map((b) => {
          const v = value(m, b, key);
          return `<td>${Number.isFinite(v) ? v.toFixed(digits) : 'n/a'}</td>`;
        }).join('') + '</tr>').join('') +
        `<tr><th>beams</th>${bands.map((b) => `<td>${(value(first, b, 'beams') || 0).toLocaleString('en').replace(/,/g, '\u202f')}</td>`).join('')}</tr></tbody></table>`;
    caption.textContent = `${text} Bands of fewer than 100 beams stand in the table only.`;
  }
  choice(buttons, scores.map((s) => s[1]), 0, (k) => { score = scores[k]; draw(); });
  draw();
  return draw;
}

// --- Reliability -------------------------------------------------------------------------------
function reliability_plot(root, data) {
  const place = root.querySelector('.reliability');
  if (!place) return;
  const models = data.models.map((m, k) => ({k, name: m.name, ...m.reliability})).filter((m) => m.bins && m.bins.length);
  const plot = div(place, ''), readout = div(place, 'models'), caption = div(place, 'caption');
  const percent = (x) => `${tidy(Number((100 * x).toFixed(2)))} %`;
  readout.innerHTML = models.map((m) => `<span><i style="background:${colour(m.k)}"></i>${escaped(m.name)}: ` +
      `calibration error ${percent(m.error)}, mean probability ${percent(Math.abs(m.bias))} too ` +
      `${m.bias < 0 ? 'low' : 'high'}</span>`).join('');
  caption.textContent = 'Share of the beams that returned, by the probability of a return that the model gave them, ' +
      'in bins of 5 %. A calibrated model is on the diagonal. The area of a dot grows with its beams; the calibration ' +
      'error is the mean distance from the diagonal, over beams.';
  function draw() {
    const f = frame_of(plot);
    const x_of = (p) => f.left + (f.right - f.left) * p, y_of = (p) => f.bottom - (f.bottom - f.top) * p;
    let svg = `<svg viewBox="0 0 ${f.width} ${f.height}" role="img" aria-label="Reliability of the probability of a return">`;
    for (let p = 0; p <= 1.001; p += 0.25) {
      svg += grid_line(f, y_of(p), percent(p)) +
          `<text x="${x_of(p)}" y="${f.bottom + 18}" text-anchor="${p > 0.99 ? 'end' : 'middle'}">${percent(p)}</text>`;
    }
    svg += `<line class="reading" x1="${x_of(0)}" y1="${y_of(0)}" x2="${x_of(1)}" y2="${y_of(1)}"/>`;
    for (const m of models) {
      const most = Math.max(...m.bins.map((b) => b.beams));
      const at = m.bins.map((b) => [x_of(b.predicted).toFixed(1), y_of(b.returned).toFixed(1), b.beams]);
      svg += `<path d="M${at.map(([x, y]) => `${x} ${y}`).join('L')}" fill="none" stroke="${colour(m.k)}" stroke-width="1.6"/>`;
      for (const [x, y, n] of at) {
        svg += `<circle cx="${x}" cy="${y}" r="${(2 + 6 * Math.sqrt(n / most)).toFixed(1)}" fill="${colour(m.k)}" opacity=".8"/>`;
      }
    }
    plot.innerHTML = svg + '</svg>';
  }
  draw();
  return draw;
}

// --- Three dimensions --------------------------------------------------------------------------
const SHADER_OF_POINTS = `
attribute vec3 at; attribute float error;
uniform mat4 clip_from_box; uniform float ground, height, size; uniform bool by_error;
varying vec3 colour;
vec3 ramp(float f) {
  f = clamp(f, 0.0, 1.0);
  vec3 a = vec3(.29, .24, .59), b = vec3(.18, .48, .63), c = vec3(.20, .70, .51), d = vec3(.99, .91, .15);
  return f < .35 ? mix(a, b, f / .35) : f < .68 ? mix(b, c, (f - .35) / .33) : mix(c, d, (f - .68) / .32);
}
void main() {
  gl_Position = clip_from_box * vec4(at, 1.0);
  gl_PointSize = clamp(size / gl_Position.w, 1.5, 7.0);
  float e = (error - 100.0) / 100.0;
  vec3 grey = vec3(.50, .525, .565);
  colour = !by_error ? ramp(sqrt(max(0.0, (at.z - ground) / height)))
      : error > 254.5 ? vec3(.18, .90, .66) : error > 253.5 ? vec3(1.0, .84, .04)
      : e < 0.0 ? mix(grey, vec3(.145, .39, 1.0), min(1.0, -e)) : mix(grey, vec3(.94, .17, .17), min(1.0, e));
  if (!by_error && error > 254.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;
const SHADER_OF_COLOUR = `
precision mediump float; varying vec3 colour;
void main() {
  vec2 p = gl_PointCoord - .5;
  if (dot(p, p) > .25) discard;
  gl_FragColor = vec4(colour, 1.0);
}`;
const bytes_of = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

function points_view(root, data) {
  const view = root.querySelector('.view'), canvas = view.querySelector('canvas');
  const gl = canvas.getContext('webgl', {antialias: false, preserveDrawingBuffer: true});
  if (!gl || !data.clouds.some((c) => c.xyz.length)) return;
  view.hidden = false;
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, SHADER_OF_POINTS], [gl.FRAGMENT_SHADER, SHADER_OF_COLOUR]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    if (!gl.isContextLost()) show_error(`Script error: WebGL: ${gl.getProgramInfoLog(program)}`);
    view.hidden = true;
    return;
  }
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(14 / 255, 17 / 255, 22 / 255, 1);
  const at = gl.getAttribLocation(program, 'at'), error = gl.getAttribLocation(program, 'error');
  const uniform = (name) => gl.getUniformLocation(program, name);
  const places = {clip: uniform('clip_from_box'), ground: uniform('ground'), height: uniform('height'), size: uniform('size'), by_error: uniform('by_error')};
  const buffer = (bytes) => {
    const b = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, b);
    gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STATIC_DRAW);
    return b;
  };
  const clouds = data.clouds.map((c) => {
    const xyz = bytes_of(c.xyz);
    return {n: xyz.length / 6, xyz: buffer(xyz), error: c.error ? buffer(bytes_of(c.error)) : null};
  });
  const start = {yaw: -0.9, pitch: 0.62, far: 0.62, x: 0.5, y: 0.5, z: data.floor_m / data.box_m};
  let eye = {...start}, shown = 0, by_error = false, asked = false;

  function clip_from_box(aspect) {
    const cy = Math.cos(eye.yaw), sy = Math.sin(eye.yaw), cp = Math.cos(eye.pitch), sp = Math.sin(eye.pitch);
    const right = [cy, sy, 0], back = [sy * cp, -cy * cp, sp], up = [-sy * sp, cy * sp, cp];
    const move = (v) => -(v[0] * eye.x + v[1] * eye.y + v[2] * eye.z);
    const focal = 1.6 * Math.min(1, aspect), near = 0.002, end = 6;
    const fx = focal / aspect, d = (end + near) / (near - end), w = 2 * end * near / (near - end);
    const depth = move(back) - eye.far;
    const out = [];
    for (let k = 0; k < 3; k++) out.push(fx * right[k], focal * up[k], d * back[k], -back[k]);
    out.push(fx * move(right), focal * move(up), d * depth + w, -depth);
    return out;
  }
  function draw() {
    asked = false;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
    if (!w || !h) return;
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    gl.viewport(0, 0, w, h);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(places.clip, false, clip_from_box(w / h));
    gl.uniform1f(places.ground, data.floor_m / data.box_m);
    gl.uniform1f(places.height, data.height_m / data.box_m);
    gl.uniform1f(places.size, 1.3 * ratio);
    const cloud = clouds[shown];
    gl.uniform1i(places.by_error, by_error && cloud.error ? 1 : 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, cloud.xyz);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.UNSIGNED_SHORT, true, 6, 0);
    if (cloud.error) {
      gl.bindBuffer(gl.ARRAY_BUFFER, cloud.error);
      gl.enableVertexAttribArray(error);
      gl.vertexAttribPointer(error, 1, gl.UNSIGNED_BYTE, false, 1, 0);
    } else {
      gl.disableVertexAttribArray(error);
      gl.vertexAttrib1f(error, 100);
    }
    gl.drawArrays(gl.POINTS, 0, cloud.n);
  }
  const ask = () => { if (!asked) { asked = true; requestAnimationFrame(draw); } };

  const row = view.querySelector('.view-clouds');
  choice(row, data.clouds.map((c) => c.name), 0, (k) => { shown = k; say(); });
  div(row, 'gap');
  const colouring = button(row, 'Colour by error', () => { by_error = !by_error; say(); });
  function say() {
    colouring.disabled = shown === 0;
    colouring.style.opacity = shown === 0 ? 0.45 : 1;
    colouring.setAttribute('aria-pressed', String(by_error && shown > 0));
    view.querySelector('.view-error').hidden = !(by_error && shown > 0);
    view.querySelector('.view-height').hidden = by_error && shown > 0;
    ask();
  }
  handle_pointers(canvas, {
    turn(dx, dy) {
      eye.yaw -= dx * 0.007;
      eye.pitch = Math.min(1.57, Math.max(-0.2, eye.pitch + dy * 0.007));
      ask();
    },
    move(dx, dy) {
      const scale = eye.far / canvas.clientHeight * 1.3, c = Math.cos(eye.yaw), s = Math.sin(eye.yaw);
      eye.x -= scale * (dx * c + dy * s);
      eye.y -= scale * (dx * s - dy * c);
      ask();
    },
    zoom(factor) { eye.far = Math.min(3, Math.max(0.02, eye.far * factor)); ask(); },
    reset() { eye = {...start}; ask(); },
  });
  canvas.addEventListener('webglcontextlost', () => { view.hidden = true; });
  say();
  draw();
  return ask;
}

function handle_pointers(canvas, act) {
  const down = new Map();
  let last_tap = 0;
  const spread = () => {
    const [a, b] = [...down.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, {x: e.clientX, y: e.clientY});
    if (down.size === 1) {
      if (e.timeStamp - last_tap < 300) act.reset();
      last_tap = e.timeStamp;
    }
  });
  canvas.addEventListener('pointermove', (e) => {
    const p = down.get(e.pointerId);
    if (!p) return;
    const dx = e.clientX - p.x, dy = e.clientY - p.y;
    const before = down.size === 2 ? spread() : 0;
    p.x = e.clientX;
    p.y = e.clientY;
    if (down.size === 2) {
      if (spread() > 0) act.zoom(before / spread());
      act.move(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) {
      act.move(dx, dy);
    } else {
      act.turn(dx, dy);
    }
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (e) => down.delete(e.pointerId));
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => {
    e.preventDefault();
    act.zoom(Math.exp(e.deltaY * 0.0012));
  }, {passive: false});
  canvas.addEventListener('keydown', (e) => {
    const turns = {ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20]};
    if (turns[e.key]) act.turn(...turns[e.key]);
    else if (e.key === '+' || e.key === '-') act.zoom(e.key === '+' ? 0.85 : 1.18);
    else return;
    e.preventDefault();
  });
}

// --- Hold a simulated picture to see the real one ----------------------------------------------
function hold_pictures() {
  const pictures = [...document.querySelectorAll('.holds-real')];
  for (const picture of pictures) {
    const own = picture.src, real = picture.closest('.pictures').querySelector('img').src;
    const label = picture.closest('figure').querySelector('figcaption'), name = label.textContent;
    const show = (is_real) => {
      picture.src = is_real ? real : own;
      label.textContent = is_real ? 'real' : name;
    };
    picture.draggable = false;
    picture.addEventListener('pointerdown', () => show(true));
    for (const end of ['pointerup', 'pointercancel', 'pointerleave']) picture.addEventListener(end, () => show(false));
    picture.addEventListener('contextmenu', (e) => e.preventDefault());
  }
}

document.documentElement.classList.add('scripted');
hold_pictures();
const roots = document.querySelectorAll('.comparison');
const redraws = JSON.parse(by_id('data').textContent).flatMap((data, k) =>
    [histogram_plot, bands_plot, reliability_plot, points_view].map((draw) => draw(roots[k], data))).filter(Boolean);
// The contents lead to nothing that this browser does not show.
for (const link of document.querySelectorAll('nav span a')) {
  if (!by_id(link.hash.slice(1)).getClientRects().length) link.remove();
}
let last_width = window.innerWidth;
window.addEventListener('resize', () => {
  if (window.innerWidth === last_width) return;
  last_width = window.innerWidth;
  redraws.forEach((draw) => draw());
});
document.documentElement.dataset.drawn = 'yes';
