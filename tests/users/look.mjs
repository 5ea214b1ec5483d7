// Opens the page of `underbrush serve` on labelled.ply and its model, uses it as a person does, and keeps pictures.
//   node look.mjs PACKAGES CHROMIUM ADDRESS PICTURES
import { join } from 'node:path';
import { launched } from '../web/chromium.mjs';

const [packages, executablePath, address, pictures] = process.argv.slice(2);
const browser = await launched(packages, executablePath);
const page = await (await browser.newContext({ viewport: { width: 900, height: 500 } })).newPage();
page.setDefaultTimeout(Number(process.env.PATIENCE ?? 120000));
const complaints = [];
page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(m.text()));
page.on('pageerror', (e) => complaints.push(e.message));

function expect(ok, what) {
  if (!ok) throw new Error(what);
  console.log(`  ${what}`);
}

async function ready() {
  await page.waitForFunction(() => document.documentElement.dataset.opened === 'yes');
  await page.evaluate(() => new Promise((then) => requestAnimationFrame(() => requestAnimationFrame(then))));
  await page.waitForFunction(() => document.documentElement.dataset.state === 'ready', null, { polling: 50 });
}

/** Keeps a picture of the page; returns the view's pixels, as a text of its own for each picture, and their colours. */
async function picture(name) {
  await ready();
  await page.screenshot({ path: join(pictures, `${name}.png`) });
  const seen = await page.evaluate(() => {
    const view = document.querySelector('#view');
    const context = new OffscreenCanvas(view.width, view.height).getContext('2d');
    context.drawImage(view, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, view.width, view.height).data.buffer);
    const drawn = pixels.filter((colour) => colour !== pixels[0]);
    return { drawn: drawn.length, colours: new Set(drawn).size, sum: pixels.reduce((a, b) => (31 * a + b) | 0, 0) };
  });
  expect(seen.drawn > 5000 && seen.colours > 20, `${name}: ${seen.drawn} pixels drawn in ${seen.colours} colours`);
  return seen;
}

await page.goto(address);
const first = await picture('first');
expect(Number(await page.evaluate(() => document.documentElement.dataset.points)) > 10000, 'points of the log are drawn');

await page.mouse.move(600, 260);
await page.mouse.down();
await page.mouse.move(700, 300, { steps: 5 });
await page.mouse.up();
const after = await picture('turned');
expect(after.sum !== first.sum, 'dragging turns the view');

await page.getByLabel('Points by').selectOption('class');
const classes = await picture('classes');
expect(classes.sum !== after.sum && /by class/.test(await page.locator('#legend').innerText()), 'colours and legend of classes');

await page.locator('#panel label.check', { hasText: /^labelled\.ply/ }).locator('input').setChecked(false);
expect((await picture('model')).sum !== classes.sum, 'the model alone');

await page.locator('#view').press('?');
expect(/Drag/i.test(await page.locator('body').innerText()), 'the help lists what to do');
await page.keyboard.press('Escape');
await browser.close();
if (complaints.length > 0) throw new Error(`the console: ${complaints.join('; ')}`);
