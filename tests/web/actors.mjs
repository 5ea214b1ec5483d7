// Steps of browser.mjs about actors: the list, times, edits, dragging, and boxes in scans that become tracks.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { end, startServer } from './labels.mjs';

const fact = (page, name) => page.evaluate((n) => document.documentElement.dataset[n] ?? '', name);
const waitFor = (page, name, value) =>
  page.waitForFunction(([n, v]) => document.documentElement.dataset[n] === v, [name, value], { polling: 30 });

/** Where the page draws actors: place (world, m) and pixel of the canvas by name; null for one that is absent. */
async function places(page) {
  const out = {};
  for (const words of (await fact(page, 'actorsAt')).split('; ').map((text) => text.split(' '))) {
    const [x, y, z, px, py] = words.slice(1).map(Number);
    out[words[0]] = words[1] === 'absent' ? null : { at: [x, y, z], pixel: [px, py] };
  }
  return out;
}

async function setTime(page, time) {
  await page.getByLabel(/^Time, s/).evaluate((box, t) => {
    box.step = 'any';
    box.value = t;
    box.dispatchEvent(new Event('input'));
  }, `${time}`);
}

/** Plays, edits and drags actors, and simulates what was edited. */
export async function editActors({ page, expect, ready, accessible, picture, program, folder, complaints }) {
  const server = await startServer(program, folder, 'log.ply', 'model', 'actors', '--labels', 'work');
  const press = (key) => page.locator('#view').press(key);
  await page.goto(server.address);
  await ready();
  const show = (name, on) => page.locator('#panel label.check', { hasText: new RegExp(`^${name} ?\\(`) }).locator('input').setChecked(on);
  expect(!(await page.getByLabel('Actors', { exact: true }).isVisible()), 'no list without actors');
  await show('actors', true);
  await waitFor(page, 'actors', '1');
  await ready();
  const line = await page.getByLabel('Actors', { exact: true }).innerText();
  expect(/^other-1: other, 0\.\d s$/.test(line.trim()), `the list says: ${line}`);
  const told = await page.getByLabel('Facts of the actor').innerText();
  expect(/returns\s+\d+\s+scans\s+2\s+there for, s\s+0\.\d/.test(told), `the facts say: ${told}`);
  await accessible('actors');

  // The actor stands where the server says that it is at the time that is shown.
  const facts = await page.evaluate(async () => {
    const world = await (await fetch('./api/world?file=2')).json();
    const log = (await (await fetch('./api/octree?file=0')).json()).octree;
    const { actors } = await (await fetch('./api/actors?file=2')).json();
    return { origin: world.origin_m, first: log.first_time_s, poses: actors[0].parts[0].poses };
  });
  for (const time of [0.03, 0.08, 0.12]) {
    await setTime(page, time);
    const { at } = (await places(page))['other-1'];
    const t = facts.first + time;
    const k = Math.max(1, facts.poses.findIndex((p) => p[0] > t));
    const [a, b] = [facts.poses[k - 1], facts.poses[k]];
    const share = (t - a[0]) / (b[0] - a[0]);
    const off = at.map((v, c) => Math.abs(v - facts.origin[c] - a[c + 1] - share * (b[c + 1] - a[c + 1])));
    expect(Math.max(...off) < 2e-3, `at ${time} s it is ${off} m away from its place`);
  }

  // Playing takes the chosen speed.
  await page.getByLabel('Speed').selectOption('0.1');
  await setTime(page, 0.02);
  await press('\\');
  const began = Date.now();
  await page.waitForFunction(() => Number(document.documentElement.dataset.time) > 0.03);
  await press('\\');
  const played = Number(await fact(page, 'time')) - 0.02;
  expect(played < 0.1 * ((Date.now() - began) / 1000 + 0.5), `${played} s were played in ${Date.now() - began} ms`);

  // Edits, and taking them back.
  const button = (name) => page.locator('section', { has: page.getByLabel('Actors', { exact: true }) }).getByRole('button', { name, exact: true });
  await setTime(page, 0.08);
  const start = (await places(page))['other-1'].at;
  await button('Copy').click();
  await waitFor(page, 'actors', '2');
  await page.getByLabel('Actors', { exact: true }).selectOption('other-1-copy-2');
  await page.getByLabel('Delay, s', { exact: true }).fill('0.05');
  await button('Delay').click();
  await waitFor(page, 'edits', '2');
  const early = (await places(page))['other-1-copy-2'].at;
  expect(Math.abs(start[0] - early[0] - 0.5) < 0.05, `0.05 s later it is ${start[0] - early[0]} m behind`);
  await page.getByLabel('Actors', { exact: true }).selectOption('other-1');
  await button('Remove').click();
  await waitFor(page, 'actors', '1');
  await press(',');
  await waitFor(page, 'actors', '2');
  await button('Undo').click();
  await waitFor(page, 'edits', '1');
  await press('.');
  await waitFor(page, 'edits', '2');
  await press(',');
  await waitFor(page, 'edits', '1');

  // A drag takes the actor along, and leaves the camera.
  await press('f');
  await press('1');
  await ready();
  await page.getByLabel('Drag actors in the view').check();
  await setTime(page, 0.081);
  await page.getByLabel('Actors', { exact: true }).selectOption('other-1');
  await button('Turn round').click();
  await waitFor(page, 'edits', '2');
  const eye = await fact(page, 'eye');
  const [x, y] = (await places(page))['other-1'].pixel;
  const view = await page.locator('#view').boundingBox();
  const to = [x + 60, y + 40];
  await page.mouse.move(view.x + x, view.y + y);
  await page.mouse.down();
  await page.mouse.move(view.x + to[0], view.y + to[1], { steps: 4 });
  await page.mouse.up();
  await waitFor(page, 'edits', '3');
  const list = await places(page);
  const off = Object.values(list).map((p) => Math.hypot(p.pixel[0] - to[0], p.pixel[1] - to[1]));
  expect(Math.min(...off) < 3, `the dragged actor is ${Math.min(...off)} pixels from where it was dropped`);
  expect((await fact(page, 'eye')) === eye, 'the camera stays');
  await page.getByLabel('Drag actors in the view').uncheck();

  // The link keeps the edits.
  await page.waitForFunction(() => document.documentElement.dataset.link === 'new');
  await page.reload();
  await waitFor(page, 'edits', '3');
  await ready();
  await setTime(page, 0.081);
  expect(JSON.stringify(Object.keys(await places(page))) === JSON.stringify(Object.keys(list)), 'the copy is there after a reload');

  // The world with its actors beside the log.
  await page.getByLabel('Left', { exact: true }).selectOption({ label: 'log.ply' });
  await page.getByLabel('Right', { exact: true }).selectOption({ label: 'model' });
  await page.getByLabel('Compare').selectOption('split');
  await waitFor(page, 'compare', 'split');
  const both = await picture('actors-split');
  await button('Undo').click();
  await waitFor(page, 'edits', '2');
  expect((await picture('actors-back')).drawn !== both.drawn, 'the right side shows the actors');
  await press('.');
  await waitFor(page, 'edits', '3');
  await page.getByLabel('Compare').selectOption('off');

  // What was edited is simulated.
  await button('Replay').click();
  await page.waitForFunction(() => /simulate (done|failed)/.test(document.documentElement.dataset.jobs), null, { polling: 100 });
  expect(/simulate done/.test(await fact(page, 'jobs')), await fact(page, 'jobs'));
  expect(/--actors \S*edits-\w+\.json/.test(await page.locator('.jobs').innerText()), 'the command line names the edits');
  await page.waitForFunction(() => [...document.querySelectorAll('#panel label.check')].some((e) => /-scan-.*\(log\)/.test(e.innerText) && e.querySelector('input').checked));
  await ready();

  // What was written opens again, by the file picker and by a drop, and is written again to the same bytes.
  const status = (pattern) => page.waitForFunction((p) => new RegExp(p).test(document.querySelector('#status').innerText), pattern);
  const written = () => readdirSync(join(folder, 'work')).filter((f) => /^edits-.*json$/.test(f)).map((f) => join(folder, 'work', f));
  const [first] = written();
  const standing = async () => JSON.stringify(Object.entries(await places(page)).map(([name, place]) => [name, place?.at]));
  const placed = await standing();
  const openDropped = async (name, text) => {
    const dropped = await page.evaluateHandle(([n, t]) => {
      const data = new DataTransfer();
      data.items.add(new File([t], n, { type: 'application/json' }));
      return data;
    }, [name, text]);
    await page.dispatchEvent('#view', 'drop', { dataTransfer: dropped });
  };
  for (const open of [() => page.getByLabel('File of edits').setInputFiles(first), () => openDropped('mine.json', readFileSync(first, 'utf8'))]) {
    for (let k = 3; k > 0; --k) {
      await button('Undo').click();
      await waitFor(page, 'edits', `${k - 1}`);
    }
    expect((await standing()) !== placed, 'without its edits the actor is elsewhere');
    await open();
    await status('^Opened: (edits-.*|mine)[.]json, edits of [.][.]/actors$');
    await waitFor(page, 'edits', '3');
    expect((await standing()) === placed, 'the actors are where they were when the edits were written');
    expect((await page.getByLabel('Edits', { exact: true }).innerText()) === '3 edits', 'no edit is taken back');
    await button('Undo').click();
    await waitFor(page, 'edits', '2');
    await button('Redo').click();
    await waitFor(page, 'edits', '3');
    const before = written();
    await button('Write edits').click();
    await status('^Written: ');
    const [again] = written().filter((f) => !before.includes(f));
    expect(readFileSync(again).equals(readFileSync(first)), 'what was opened is written to the same bytes');
  }
  const list3 = JSON.parse(readFileSync(first, 'utf8'));
  for (const [text, told] of [
    [JSON.stringify({ ...list3, edits: [...list3.edits, { edit: 'remove', actor: 'nobody' }] }), "bad.json: edits\\[3\\].actor: there is no such actor: 'nobody'"],
    [JSON.stringify({ ...list3, version: 2 }), 'bad.json: version'],
    ['{"edits"', 'bad.json: not a list of edits'],
    ['', 'bad.json: not a list of edits'],
    [JSON.stringify({ ...list3, comment: 'x'.repeat(20000) }), 'bad.json: more edits than a request has room for'],
  ]) {
    await openDropped('bad.json', text);
    await status(`^${told}`);
    expect((await fact(page, 'edits')) === '3' && (await standing()) === placed, 'what cannot be opened changes nothing');
  }
  const refused = complaints.splice(0); // what the browser itself says of refused requests
  expect(refused.length === 4 && refused.every((c) => /status of (400|422)/.test(c)), `the console: ${refused.join('; ')}`);

  // Edits that were not written are lost only if a person says so.
  await button('Turn round').click();
  await waitFor(page, 'edits', '4');
  page.once('dialog', (dialog) => dialog.dismiss());
  await page.getByLabel('File of edits').setInputFiles(first);
  await page.waitForTimeout(200);
  expect((await fact(page, 'edits')) === '4', 'they stay');
  page.once('dialog', (dialog) => dialog.accept());
  await page.getByLabel('File of edits').setInputFiles(first);
  await waitFor(page, 'edits', '3');

  // A box that is carried on is a track.
  await page.getByLabel('File for boxes').selectOption({ label: 'log.ply' });
  await waitFor(page, 'saved', 'yes');
  await setTime(page, 0.03);
  await page.getByRole('button', { name: 'New box' }).click();
  await waitFor(page, 'boxes', '1');
  await page.getByRole('button', { name: 'Track', exact: true }).click();
  await page.waitForFunction(() => /track 1 in scan 0/.test(document.querySelector('select[aria-label=Boxes]').innerText));
  await page.getByRole('button', { name: 'Next scan' }).click();
  await page.waitForFunction(() => /track 1 in scan 1/.test(document.querySelector('select[aria-label=Boxes]').innerText));
  await page.getByRole('button', { name: 'Scan before' }).click();
  expect((await fact(page, 'boxes')) === '2', 'going back makes no box');
  await page.getByRole('button', { name: 'Tracks', exact: true }).click();
  await page.waitForFunction(() => /^Written: .*tracks-\w+\.csv, 2 boxes$/.test(document.querySelector('#status').innerText));
  await accessible('tracks');
  await press('7');
  await waitFor(page, 'saved', 'yes');

  // A server that is started with a list begins with its edits.
  const second = await startServer(program, folder, 'log.ply', first);
  await page.goto(second.address);
  await end(server, 'SIGINT');
  await ready();
  await waitFor(page, 'edits', '3');
  await setTime(page, 0.081);
  expect((await standing()) === placed, `the actors of the list are at ${await standing()}`);
  await ready();
  await page.goto('about:blank');
  await end(second, 'SIGINT');
}
