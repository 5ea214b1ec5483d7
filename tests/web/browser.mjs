// Drives the page of `underbrush serve` in Chromium; browser.py starts the server and this script.
//   node browser.mjs PACKAGES CHROMIUM ADDRESS PICTURES
// PACKAGES is a folder with node_modules/playwright-core. Each check throws with a reason.
import { createRequire } from 'node:module';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { editActors } from './actors.mjs';
import { launched } from './chromium.mjs';
import { lookAtBeams } from './beams.mjs';
import { lookAtPage, lookAtPhone, lookEarly } from './page.mjs';
import { editLibrary } from './library.mjs';
import { comparisonTells, difference, looksAs, shrunk } from './references.mjs';
import { composeScene, labelLog } from './labels.mjs';

const [packages, executablePath, address, pictures] = process.argv.slice(2);
const { PROGRAM: program, FOLDER: folder, ONLY: part } = process.env;
const load = createRequire(join(packages, 'package.json'));
const axe = readFileSync(load.resolve('axe-core/axe.min.js'), 'utf8');

/** Pictures of which a copy is kept; references.mjs compares them. */
const KEPT = new Set(['log-top', 'log-1', 'log-5', 'beams', 'slice', 'path', 'model', 'scene', 'primitives', 'opaque',
  'compare-split', 'errors', 'packet-errors', 'library']);

function expect(ok, what) {
  if (!ok) throw new Error(what);
}

const browser = await launched(packages, executablePath);
const context = await browser.newContext({ viewport: { width: 900, height: 420 }, acceptDownloads: true });
const page = await context.newPage();
page.setDefaultTimeout(Number(process.env.PATIENCE ?? 120000)); // long, for machines that are busy
const complaints = [];
page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(`${m.type()}: ${m.text()}`));
page.on('pageerror', (e) => complaints.push(`exception: ${e.message}`));
page.on('request', (r) => {
  if (!/^http:\/\/127\.0\.0\.1:\d+\//.test(r.url()) && !/^(data|blob):/.test(r.url())) complaints.push(`request: ${r.url()}`);
});

const data = (name) => page.evaluate((n) => document.documentElement.dataset[n] ?? '', name);
/** Waits for the picture that follows from all that was done, with all points that belong to it. */
async function ready() {
  await page.waitForFunction(() => document.documentElement.dataset.opened === 'yes');
  await page.evaluate(() => new Promise((then) => requestAnimationFrame(() => requestAnimationFrame(then))));
  await page.waitForFunction(() => document.documentElement.dataset.state === 'ready', null, { polling: 50 });
}
const press = async (key) => page.locator('#view').press(key);
const details = () => page.locator('#details').innerText();

/** Facts of the view's pixels: how many are not background, in how many colours, and where some are that no panel
 * hides. */
async function picture(name) {
  await ready();
  if (KEPT.has(name)) await looksAs(page, name);
  if (pictures) {
    const url = await page.evaluate(() => document.querySelector('#view').toDataURL('image/png'));
    writeFileSync(join(pictures, `${name}.png`), Buffer.from(url.split(',')[1], 'base64'));
  }
  return page.evaluate(() => {
    const view = document.querySelector('#view');
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [view.width, view.height];
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(view, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, view.width, view.height).data.buffer);
    const colours = new Set();
    const free = [];
    const box = view.getBoundingClientRect();
    let drawn = 0;
    pixels.forEach((colour, k) => {
      if (colour === pixels[0]) return;
      ++drawn;
      colours.add(colour);
      free.push([box.left + (k % view.width), box.top + Math.floor(k / view.width)]);
    });
    const seen = free.filter(([x, y], k) => (free.length < 5000 || k % 7 === 0) && document.elementFromPoint(x, y) === view);
    const at = Array.from({ length: 12 }, (_, k) => seen[Math.floor(((k + 0.5) * seen.length) / 12)]);
    return { drawn, colours: colours.size, at: at.filter(Boolean) };
  });
}

/** Clicks drawn pixels until a thing of this kind is picked. */
async function pickOf(kind, shot) {
  for (const [x, y] of shot.at) {
    await page.evaluate(() => delete document.documentElement.dataset.picked);
    await page.mouse.click(x, y);
    await page.waitForFunction(() => document.documentElement.dataset.picked);
    if ((await data('picked')).startsWith(kind)) return;
    await press('Escape');
  }
  throw new Error(`no ${kind} could be picked at ${JSON.stringify(shot.at)}`);
}

/** Shows or hides one file. */
async function show(name, on) {
  await page.locator('#panel label.check', { hasText: new RegExp(`^${name} ?\\(`) }).locator('input').setChecked(on);
}

async function only(name) {
  for (const box of await page.locator('#panel label.check').all()) {
    const text = await box.innerText();
    if (!/\((log|model|primitives|scene|score)\)/.test(text)) continue;
    await box.locator('input').setChecked(text.startsWith(name));
  }
  await ready();
  await press('f');
  await ready();
}

/** Checks the page as it stands against the rules of axe-core. */
async function accessible(when) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document));
  const words = violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 80)).join(' | ')}`);
  expect(words.length === 0, `${when}: ${words.join('; ')}`);
}

if (!part) await viewEverything();

// Labels, boxes and commands. The console may complain of the server that is killed.
await page.setViewportSize({ width: 900, height: 420 });
const tools = { page, expect, ready, accessible, picture, program, folder, complaints };
const sound = [...complaints];
if (!part || part === 'labels') await labelLog(tools);
complaints.splice(0, complaints.length, ...sound, ...complaints.filter((c) => !/ERR_CONNECTION_REFUSED|409|Failed to fetch/.test(c)));
if (!part || part === 'labels') await composeScene(tools);
if (part !== 'library') await editActors(tools);
if (!part || part === 'library') await editLibrary(tools);

await browser.close();
expect(complaints.length === 0, `the console: ${complaints.join('; ')}`);
console.log('all kinds of files were opened');

/** The viewer: every kind of file. */
async function viewEverything() {
  // A log: points of all levels, every colouring, flight, picking, the beams of a scan.
  await page.goto(address);
  await ready();
  await only('log.ply');
  const returns = Number(process.env.RETURNS);
  expect(Number(await data('points')) === returns, `${await data('points')} points drawn, ${returns} are there`);
  let shot = await picture('log');
  expect(shot.drawn > 200 && shot.colours > 4, `a log of ${shot.drawn} pixels in ${shot.colours} colours`);
  const seen = new Set();
  for (let k = 0; k < 10; ++k) {
    await press('c');
    await picture(`log-${k}`);
    seen.add(await page.locator('#panel select').first().inputValue());
  }
  expect(seen.size === 10, 'ten colourings');
  const eye = await data('eye');
  await page.keyboard.down('w');
  await page.waitForTimeout(150);
  await page.keyboard.up('w');
  await press('ArrowLeft');
  await press('+');
  await page.waitForFunction((e) => document.documentElement.dataset.eye !== e, eye);
  await page.mouse.move(450, 200);
  await page.mouse.down();
  await page.mouse.move(500, 230, { steps: 3 });
  await page.mouse.up();
  await press('f');
  await press('1');
  shot = await picture('log-top');
  await accessible('the page');
  await pickOf('point', shot);
  await page.waitForFunction(() => /\brange\b/.test(document.querySelector('#details').innerText));
  expect(/ring/.test(await details()), 'a point tells its ring');
  await press('b');
  await page.waitForFunction(() => /reached by/.test(document.querySelector('#details').innerText));
  expect(/Simulated: /.test(await details()), 'why the beam ended');
  const wide = await page.evaluate(() => [...document.querySelectorAll('#details .scroll')].map((e) => e.scrollWidth - e.clientWidth));
  expect(wide.every((more) => more <= 0), `why the beam ends: ${wide} pixels are out of sight`);
  await accessible('the elements of a beam');
  await press('Escape');
  await page.locator('select[aria-label="Beams of a scan"]').selectOption({ index: 1 });
  await page.waitForFunction(() => /\d+ beams/.test(document.documentElement.dataset.beams ?? ''));
  expect((await picture('beams')).drawn > shot.drawn, 'beams are drawn');
  await page.locator('select[aria-label="Beams of a scan"]').selectOption({ index: 0 });

  await lookAtBeams({ page, expect, ready, accessible, picture, data, press });

  // Slice and measure.
  await press('x');
  expect((await picture('slice')).drawn < shot.drawn, 'a slice shows less');
  await press('x');
  await press('n');
  shot = await picture('measure');
  await pickOf('point', shot);
  await pickOf('point', { at: [...shot.at].reverse() });
  await page.waitForFunction(() => Number(document.documentElement.dataset.measured) >= 0);
  await press('Escape');

  // The worlds.
  for (const [name, kind] of [['model', 'world'], ['scene', 'world'], ['primitives', 'world']]) {
    await only(name);
    await press('1');
    shot = await picture(name);
    expect(shot.drawn > 100 && shot.colours > 5, `${name}: ${shot.drawn} pixels in ${shot.colours} colours`);
    await pickOf(kind, shot);
    const told = await details();
    expect(/element/i.test(told) && /hits/.test(told), `${name}: details of an element`);
    await press('Escape');
  }

  // The comparison of pictures can fail.
  for (let k = 0; k < 3; ++k) await press('+');
  await ready();
  const opaque = page.getByText('Ellipsoids opaque');
  const turn = (key) => async () => {
    await press(key);
    await ready();
  };
  const click = async () => {
    await opaque.click();
    await ready();
  };
  await comparisonTells(page, expect, [
    { name: 'another colouring', make: turn('v'), back: async () => { for (let k = 0; k < 3; ++k) await turn('v')(); } },
    { name: 'a small turn', make: turn('ArrowLeft'), back: turn('ArrowRight') },
    { name: 'ellipsoids that are opaque', make: click, back: click },
  ]);

  // Permeability: an opaque ellipsoid covers more of the picture than the share p of its pixels.
  const some = (await picture('permeable')).drawn;
  await page.getByText('Ellipsoids opaque').click();
  expect((await picture('opaque')).drawn > some, 'opaque ellipsoids cover more');
  await page.getByText('Ellipsoids opaque').click();

  // Scores, help, theme, a picture to keep, a link.
  await page.getByText('score.json (score)').click();
  await page.waitForFunction(() => /packet_error_m/.test(document.querySelector('#details').innerText));
  await press('Escape');
  await press('?');
  expect(await page.locator('#help').isVisible(), 'the help opens');
  await page.keyboard.press('Escape');
  const theme = await data('theme');
  await press('t');
  await accessible('the other theme');
  expect((await data('theme')) !== theme, 'the theme changes');
  const [download] = await Promise.all([page.waitForEvent('download'), press('p')]);
  expect(download.suggestedFilename() === 'underbrush.png', 'a picture is saved');
  await only('model');
  await press('ArrowUp');
  await ready();
  await page.waitForFunction(() => document.documentElement.dataset.link === 'new');
  const link = page.url();
  const [before, place] = [await picture('link-before'), await data('eye')];
  await page.goto('about:blank');
  await page.goto(link);
  await ready();
  const after = await picture('link-after');
  expect((await data('eye')) === place, 'a link restores the view');
  expect(Math.abs(after.drawn - before.drawn) < 0.02 * before.drawn, `a link restores the picture: ${before.drawn}, ${after.drawn}`);

  await lookEarly({ page, expect, ready, address: `${address}#${encodeURIComponent(JSON.stringify({ shown: [0] }))}`, returns });
  await page.goto('about:blank');
  await page.goto(address);
  await ready();
  await lookAtPage({ page, expect, ready, press, only, show, difference, shrunk });

  // The width of a phone: the menu starts closed, and nothing sticks out.
  await page.setViewportSize({ width: 360, height: 640 });
  await page.goto('about:blank');
  await page.goto(address);
  await ready();
  expect(!(await page.locator('#panel').isVisible()), 'the menu starts closed');
  await page.locator('#menu').click();
  expect(await page.locator('#panel').isVisible(), 'the menu opens');
  await lookAtPhone({ page, expect });
  const pageWidth = await page.evaluate(() => document.documentElement.scrollWidth);
  expect(pageWidth <= 360, `the page is ${pageWidth} pixels wide`);
  const named = await page.evaluate(() =>
    [...document.querySelectorAll('button, select, input')].filter((e) => !(e.labels?.length || e.innerText || e.ariaLabel)).length,
  );
  expect(named === 0, `${named} controls without a name`);
}
