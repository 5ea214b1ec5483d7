// Steps of browser.mjs about labels, boxes and commands: they start servers of their own, which may write.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { leastDistance } from './page.mjs';

const servers = new Set();
process.on('exit', () => servers.forEach((child) => child.kill('SIGKILL'))); // also after a failure

/** Starts `underbrush serve` and waits for its address. */
export async function startServer(program, folder, ...words) {
  const child = spawn(program, ['serve', ...words, '--cache', 'cache'], { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] });
  servers.add(child);
  child.once('exit', () => servers.delete(child));
  for await (const line of createInterface({ input: child.stdout })) {
    const found = line.match(/^open (\S+) in a browser/);
    if (found) return { child, address: found[1] };
  }
  throw new Error('the server did not start');
}

export async function end(server, signal) {
  const over = new Promise((resolve) => server.child.once('exit', resolve));
  server.child.kill(signal);
  await over;
}

/** Waits until all labels are saved and shown. */
const saved = (page) => page.waitForFunction(() => document.documentElement.dataset.saved === 'yes', null, { polling: 30 });

async function drag(page, path, steps = 4) {
  await page.mouse.move(...path[0]);
  await page.mouse.down();
  for (const at of path.slice(1)) await page.mouse.move(...at, { steps });
  await page.mouse.up();
}

async function labelState(page) {
  return page.evaluate(async () => (await fetch('./api/labels?file=0')).json());
}

const named = (state, name) => state.classes.find((c) => c.name === name).points;

async function openLog(page, ready) {
  await page.getByLabel('Log to label').selectOption({ label: 'forest.ply' });
  await saved(page);
  await page.locator('#view').press('f');
  await page.locator('#view').press('1');
  await ready();
}

const WIDE = [[330, 70], [880, 70], [880, 400], [330, 400]]; // most of the view beside the menu

/** Lassos, undoes, paints, and finds after a crash what was painted. */
export async function labelLog({ page, expect, ready, accessible, program, folder }) {
  let server = await startServer(program, folder, 'forest.ply', '--labels', 'work');
  await page.goto(server.address);
  await ready();
  await openLog(page, ready);
  await accessible('the labeller');
  const colours = await page.evaluate(() => [...document.querySelectorAll('.class .swatch')].map((e) => getComputedStyle(e).backgroundColor));
  expect(colours.length >= 14 && leastDistance(colours) > 0.08, `colours of classes differ by ${leastDistance(colours).toFixed(3)} at least`);
  await page.getByLabel('Drawing').selectOption('select');
  await page.locator('#view').press('o');
  await drag(page, [...WIDE, WIDE[0]]);
  await saved(page);
  const lassoed = await labelState(page);
  expect(lassoed.selected >= 1000, `a lasso around ${lassoed.selected} points`);
  const step = (name) => page.locator('.buttons button', { hasText: new RegExp(`^${name}`) }).first().innerText();
  expect(/^Undo “lasso: select” \(\d+\)$/.test(await step('Undo')), `the step is named: ${await step('Undo')}`);
  await page.locator('#view').press('z');
  await saved(page);
  expect((await labelState(page)).selected === 0, 'undo takes the lasso back');
  expect(/^Redo “lasso: select” \(1\)$/.test(await step('Redo')), `the next step is named: ${await step('Redo')}`);
  await page.locator('#view').press('y');
  await saved(page);
  expect((await labelState(page)).selected === lassoed.selected, 'redo brings it again');
  await page.locator('input[name=label-class][value="2"]').check(); // grass
  await page.locator('#view').press('r');
  await saved(page);
  let state = await labelState(page);
  expect(named(state, 'grass') >= lassoed.selected, `${named(state, 'grass')} points are grass`);
  await page.getByRole('button', { name: 'Histogram' }).click();
  await page.locator('svg.histogram').first().waitFor();
  // A locked class keeps its points; the keys work after the mouse was used.
  await page.getByRole('button', { name: 'Lock grass' }).click();
  await page.locator('input[name=label-class][value="8"]').check();
  await page.locator('#view').press('r');
  await saved(page);
  expect(named(await labelState(page), 'grass') === named(state, 'grass'), 'a locked class is left alone');
  await page.getByRole('button', { name: 'Lock grass' }).click();

  // The program is killed while the brush is still drawing.
  await page.getByLabel('Drawing').selectOption('paint');
  await page.locator('#view').press('i');
  await page.mouse.move(400, 230);
  await page.mouse.down();
  const before = (await labelState(page)).revision;
  for (let k = 0; k < 12; ++k) {
    await page.mouse.move(400 + 30 * k, 230 + (k % 2) * 40, { steps: 3 });
    await page.waitForTimeout(60);
  }
  await page.waitForFunction((r) => Number(document.documentElement.dataset.revision) >= r + 2, before);
  state = await labelState(page);
  await end(server, 'SIGKILL');
  await page.mouse.up();
  await page.waitForFunction(() => document.documentElement.dataset.saved === 'no');
  expect(/Not saved/.test(await page.locator('[aria-label=Saved]').innerText()), 'the page says that it cannot save');
  await page.goto('about:blank');
  server = await startServer(program, folder, 'forest.ply', '--labels', 'work');
  await page.goto(server.address);
  await ready();
  await openLog(page, ready);
  const after = await labelState(page);
  expect(after.revision >= state.revision, `state ${after.revision} of ${state.revision} after the crash`);
  expect(named(after, 'medium_tree') >= named(state, 'medium_tree'), 'what the brush had painted is there');
  // The stroke is undone as one.
  await page.locator('#view').press('z');
  await saved(page);
  expect(named(await labelState(page), 'medium_tree') < named(after, 'medium_tree'), 'the stroke can be undone');

  // Labels of one scan alone, and labels from a file: what was written is read again.
  await page.getByLabel('Scan to label').selectOption({ index: 1 });
  await page.getByLabel('Scan to label').selectOption({ index: 0 });
  await page.getByRole('button', { name: '.label file' }).click();
  await page.waitForFunction(() => /^Written: /.test(document.querySelector('#status').innerText));
  const written = await labelState(page);
  await page.getByLabel('Drawing').selectOption('paint');
  await page.locator('input[name=label-class][value="1"]').check();
  await drag(page, [[450, 200], [600, 200]]);
  await saved(page);
  await page.getByLabel('File of labels').focus();
  await page.waitForFunction(() => [...document.querySelectorAll('select[aria-label="File of labels"] option')].some((o) => /\.label$/.test(o.value)));
  await page.getByLabel('File of labels').selectOption(await page.evaluate(() => [...document.querySelectorAll('select[aria-label="File of labels"] option')].find((o) => /\.label$/.test(o.value)).value));
  await page.getByRole('button', { name: 'Import' }).click();
  await page.waitForFunction(() => /those of .*label$/.test(document.querySelector('#status').innerText));
  await saved(page);
  const read = await labelState(page);
  expect(read.undos > written.undos && read.classes.some((c) => c.points > 0), 'labels come back from a file');
  await page.locator('#view').press('z');
  await saved(page);
  await page.locator('#view').press('z');
  await saved(page);

  // Another window changes the labels: both changes are kept.
  const other = await page.context().newPage();
  await other.goto(server.address);
  await other.getByLabel('Log to label').selectOption({ label: 'forest.ply' });
  await saved(other);
  await page.locator('#view').press('i');
  await drag(page, [[450, 200], [600, 200]]);
  await saved(page);
  const first = await labelState(page);
  await other.getByLabel('Drawing').selectOption('take away');
  await other.locator('#view').press('o');
  await drag(other, [...WIDE, WIDE[0]]);
  await saved(other);
  const both = await labelState(page);
  expect(both.undos === first.undos + 1 && both.selected < first.selected, 'two windows add to each other');
  await page.locator('#view').press('z');
  await page.waitForFunction(() => /Another window/.test(document.querySelector('#status').innerText));
  expect((await labelState(page)).undos === both.undos, 'a window does not undo what it has not seen');
  await other.close();
  await page.locator('#view').press('Escape');
  await end(server, 'SIGINT');
}

/** Places three primitives, composes a scene of them and simulates it. */
export async function composeScene({ page, expect, ready, accessible, picture, program, folder }) {
  const server = await startServer(program, folder, 'log.ply', 'model', 'primitives', '--labels', 'work');
  await page.goto(server.address);
  await ready();
  await page.getByLabel('File for boxes').selectOption({ label: 'model' });
  await saved(page);
  await page.locator('#view').press('f');
  await page.locator('#view').press('1');
  await ready();
  await page.getByRole('button', { name: 'Primitives', exact: true }).click();
  const tiles = page.locator('.gallery button');
  await tiles.first().waitFor();
  await page.evaluate(() => document.querySelector('.gallery img').decode());
  for (const [x, y] of [[200, 200], [300, 260], [380, 180]]) {
    const boxes = Number((await page.evaluate(() => document.documentElement.dataset.boxes)) || 0);
    await tiles.nth(boxes % (await tiles.count())).dragTo(page.locator('#view'), { targetPosition: { x, y } });
    await page.waitForFunction((n) => Number(document.documentElement.dataset.boxes) === n, boxes + 1);
  }
  await page.getByRole('button', { name: 'Turn', exact: true }).click();
  await page.waitForFunction(() => Number(document.querySelectorAll('.number input')[3].value) === 15);
  await accessible('boxes');
  // The right edge of the view from above is dragged: the box gets longer.
  const long = () => page.evaluate(() => Number(document.querySelectorAll('.number input')[4].value));
  const length = await long();
  const edge = await page.locator('.pane .outline').first().boundingBox();
  await drag(page, [[edge.x + edge.width, edge.y + edge.height / 2], [edge.x + edge.width + 12, edge.y + edge.height / 2]]);
  await page.waitForFunction((l) => Number(document.querySelectorAll('.number input')[4].value) > l, length);
  await page.locator('#view').press('7');
  await page.waitForFunction((l) => Number(document.querySelectorAll('.number input')[4].value) === l, length);
  await page.getByRole('button', { name: 'Compose', exact: true }).click();
  await page.waitForFunction(() => /compose (done|failed)/.test(document.documentElement.dataset.jobs), null, { polling: 100 });
  await page.waitForFunction(() => [...document.querySelectorAll('#panel label.check')].some((e) => /^scene-.*\(scene\)/.test(e.innerText)));
  const scene = await page.evaluate(async () => {
    const { files } = await (await fetch('./api/files')).json();
    return (await fetch(`./api/world?file=${files.findLast((f) => f.kind === 'scene').id}`)).json();
  });
  expect(scene.instances.filter((i) => /tree|shrub/.test(i.class)).length === 3, `a scene of ${scene.instances.length} instances`);
  const points = () => page.evaluate(() => Number(document.documentElement.dataset.points));
  const real = await points();
  // The options of a command are those of the program's table.
  await page.getByText('Options of simulate', { exact: true }).click();
  const form = page.locator('details', { has: page.getByText('Options of simulate', { exact: true }) });
  await form.getByLabel('seed', { exact: true }).fill('5');
  await form.getByText('Thin rays', { exact: true }).click();
  await form.getByLabel('draw', { exact: true }).selectOption('median');
  await accessible('options');
  await page.getByRole('button', { name: 'Simulate' }).click();
  await page.waitForFunction(() => /simulate (done|failed)/.test(document.documentElement.dataset.jobs), null, { polling: 100 });
  await page.waitForFunction(() => [...document.querySelectorAll('#panel label.check')].some((e) => /-scan-.*\(log\)/.test(e.innerText)));
  await page.waitForFunction((n) => Number(document.documentElement.dataset.points) > n, real); // it is shown
  await ready();
  const command = await page.locator('.jobs').innerText();
  expect(/underbrush simulate .*--like .*log.ply --seed 5 --draw median -o/.test(command), `the command line is shown: ${command}`);
  await page.getByRole('button', { name: 'Output of simulate' }).click();
  await page.locator('pre.log').waitFor();
  // The scan beside the real log: two pictures of one camera, and the errors of its ranges.
  await page.getByLabel('Left', { exact: true }).selectOption({ label: 'log.ply' });
  await page.getByLabel('Right', { exact: true }).selectOption({ index: (await page.getByLabel('Right', { exact: true }).locator('option').count()) - 1 });
  const whole = await picture('compare-off');
  await page.getByLabel('Compare').selectOption('swipe');
  await page.waitForFunction(() => document.documentElement.dataset.compare === 'swipe');
  const swiped = await picture('compare-swipe');
  await page.getByLabel('Compare').selectOption('split');
  await page.waitForFunction(() => document.documentElement.dataset.compare === 'split');
  const split = await picture('compare-split');
  expect(swiped.drawn !== whole.drawn && split.drawn !== swiped.drawn, 'both sides are drawn');
  await page.getByRole('button', { name: 'Errors' }).click();
  await page.waitForFunction(() => /^Errors from/.test(document.querySelector('#status').innerText));
  await page.getByText('Options of score', { exact: true }).click();
  await page.getByLabel('Training log').selectOption({ label: 'log.ply' });
  await page.getByRole('button', { name: 'Score' }).click();
  await page.waitForFunction(() => /score (done|failed)/.test(document.documentElement.dataset.jobs), null, { polling: 100 });
  await page.waitForFunction(() => /packet_error_m/.test(document.querySelector('#details').innerText));
  const scored = await page.locator('.jobs').innerText();
  expect(/underbrush score .* --model .*scene-.* --train .*log.ply/.test(scored), `the score has its baselines: ${scored}`);
  await page.locator('#view').press('Escape');
  const errors = await picture('errors');
  expect(errors.colours > 4, 'errors have colours');
  await page.getByLabel('Points by').selectOption('packet error');
  const packets = await picture('packet-errors');
  expect(packets.colours > 4 && packets.colours !== errors.colours, 'errors of packets have colours of their own');
  await page.locator('#view').press('Escape');
  await end(server, 'SIGINT');
}
