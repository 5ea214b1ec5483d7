// Makes the pictures of the page for the docs; browser.py --animate FOLDER starts it.
//   node animate.mjs PACKAGES CHROMIUM FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { launched } from './chromium.mjs';
import { animated } from './apng.mjs';
import { end, startServer } from './labels.mjs';

const [packages, executablePath, pictures] = process.argv.slice(2);
const { PROGRAM: program, FOLDER: folder } = process.env;
const browser = await launched(packages, executablePath);

/** Opens the page of a server in a window of this size; `act` gets the page and a function that takes a frame. */
async function film(name, words, size, colours, act) {
  const server = await startServer(program, folder, ...words);
  const context = await browser.newContext({ viewport: { width: size[0], height: size[1] }, colorScheme: 'light' });
  const page = await context.newPage();
  page.setDefaultTimeout(Number(process.env.PATIENCE ?? 120000));
  await page.goto(server.address);
  const shots = [];
  const ready = async () => {
    await page.waitForFunction(() => document.documentElement.dataset.opened === 'yes');
    await page.evaluate(() => new Promise((then) => requestAnimationFrame(() => requestAnimationFrame(then))));
    await page.waitForFunction(() => document.documentElement.dataset.state === 'ready', null, { polling: 50 });
  };
  const frame = async (ms) => {
    await ready();
    shots.push({ png: await page.screenshot({ animations: 'disabled', caret: 'hide' }), ms });
  };
  const press = (key) => page.locator('#view').press(key);
  await ready();
  await act({ page, frame, press, ready });
  const bytes = animated(shots, colours);
  writeFileSync(join(pictures, `${name}.png`), bytes);
  console.log(`${name}.png: ${shots.length} frames, ${(bytes.length / 1024).toFixed(0)} KiB`);
  await context.close();
  await end(server, 'SIGINT');
}

const VIEW = ['labelled.ply', 'model'];

/** Picks the first drawn pixel of a beam's row in the range image, by its share of the width and height. */
async function clickImage(page, x, y) {
  const box = await page.locator('#images canvas').first().boundingBox();
  await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  await page.waitForFunction(() => /\brow\b/.test(document.querySelector('#details').innerText));
}

/** Chooses the model for the range images; the menu may be closed. */
function beside(page) {
  return page.evaluate(() => {
    const box = document.querySelector('select[aria-label="Beside the range image"]');
    box.value = [...box.options].find((o) => o.text === 'model').value;
  });
}

/** Asks for the waveform of the picked beam. */
async function waveform(page) {
  await page.locator('#details').getByLabel('Sensor').selectOption('ouster-os1-64');
  await page.locator('#details').getByRole('button', { name: /Waveform/ }).click();
  await page.locator('svg.waveform').waitFor();
}

await film('serve', VIEW, [1100, 640], 250, async ({ page, frame, press }) => {
  await press('m');
  await press('f');
  for (let k = 0; k < 4; ++k) await press('+');
  await beside(page);
  await press('/');
  await page.waitForFunction(() => /both/.test(document.documentElement.dataset.images));
  await press('f'); // beside the range images
  for (let k = 0; k < 4; ++k) await press('+');
  await clickImage(page, 0.62, 0.55);
  await waveform(page);
  await frame(0);
});

await film('serve-look', VIEW, [420, 260], 63, async ({ frame, press }) => {
  await press('m');
  await press('f');
  for (let k = 0; k < 5; ++k) await press('+');
  for (let k = 0; k < 12; ++k) {
    if (k === 6) await press('c');
    await frame(250);
    await press('ArrowLeft');
  }
});

await film('serve-beams', VIEW, [820, 440], 95, async ({ page, frame, press }) => {
  await press('m');
  await press('f');
  for (let k = 0; k < 4; ++k) await press('+');
  await frame(800);
  await beside(page);
  await press('/');
  await page.waitForFunction(() => /both/.test(document.documentElement.dataset.images));
  await press('f'); // beside the range images
  for (let k = 0; k < 4; ++k) await press('+');
  await frame(1500);
  for (const [x, y] of [[0.2, 0.55], [0.3, 0.6]]) {
    await clickImage(page, x, y);
    await frame(1200);
    await press('b');
    await page.waitForFunction(() => /reached by/.test(document.querySelector('#details').innerText));
    await frame(1500);
  }
  await page.locator('#images canvas').first().press('Enter');
  await waveform(page);
  await frame(2500);
});

await film('serve-label', ['whole.ply', '--labels', 'work'], [760, 420], 63, async ({ page, frame, press }) => {
  await page.getByLabel('Log to label').selectOption({ label: 'whole.ply' });
  await page.waitForFunction(() => document.documentElement.dataset.saved === 'yes');
  await press('f');
  await press('1');
  await frame(600);
  await page.locator('input[name=label-class][value="8"]').check();
  await press('o');
  const saved = () => page.waitForFunction(() => document.documentElement.dataset.saved === 'yes', null, { polling: 30 });
  for (const path of [[[380, 90], [520, 90], [520, 200], [380, 200]], [[420, 210], [560, 210], [560, 310], [420, 310]]]) {
    await page.mouse.move(...path[0]);
    await page.mouse.down();
    for (const at of path.slice(1)) {
      await page.mouse.move(...at, { steps: 4 });
      await frame(250);
    }
    await page.mouse.up();
    await saved();
    await frame(900);
  }
  await press('z');
  await saved();
  await frame(900);
});

await browser.close();
