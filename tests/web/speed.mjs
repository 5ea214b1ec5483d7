// Measures how soon the page of a server shows a log, and how smoothly it turns; browser.py --speed LOG starts it.
//   node speed.mjs PACKAGES CHROMIUM ADDRESS
import { launched } from './chromium.mjs';

const [packages, executablePath, address] = process.argv.slice(2);
const browser = await launched(packages, executablePath);
const page = await (await browser.newContext({ viewport: { width: 1280, height: 720 } })).newPage();
page.setDefaultTimeout(Number(process.env.PATIENCE ?? 120000));
const begun = performance.now();
const seconds = () => `${((performance.now() - begun) / 1000).toFixed(2)} s`;
const points = () => page.evaluate(() => `${(Number(document.documentElement.dataset.points) / 1e6).toFixed(3)} M points`);

await page.goto(address, { waitUntil: 'commit' });
await page.waitForFunction(() => Number(document.documentElement.dataset.points) > 1000, null, { polling: 20 });
console.log(`first picture after ${seconds()} with ${await points()}`);
await page.waitForFunction(() => document.documentElement.dataset.opened === 'yes' && document.documentElement.dataset.state === 'ready');
console.log(`whole picture after ${seconds()} with ${await points()}, drawn by the ${await page.evaluate(() => document.documentElement.dataset.drawer)}`);

// Each picture sets the place of the eye.
await page.evaluate(() => {
  globalThis.pictures = [];
  const tell = () => globalThis.pictures.push([performance.now(), Number(document.documentElement.dataset.points)]);
  new MutationObserver(tell).observe(document.documentElement, { attributes: true, attributeFilter: ['data-eye'] });
});
await page.mouse.move(700, 400);
await page.mouse.down();
for (const end = performance.now() + 8000, k = { n: 0 }; performance.now() < end; ++k.n) {
  await page.mouse.move(700 + 200 * Math.sin(k.n / 20), 400 + 10 * Math.sin(k.n / 7));
  await page.waitForTimeout(8);
}
await page.mouse.up();
const pictures = (await page.evaluate(() => globalThis.pictures)).filter(([at], _, all) => at > all[0][0] + 2000); // once it has settled
const shown = pictures.map(([, n]) => n).sort((a, b) => a - b);
const rate = (pictures.length - 1) / ((pictures.at(-1)[0] - pictures[0][0]) / 1000);
console.log(`while dragging ${rate.toFixed(1)} pictures a second with ${(shown[shown.length >> 1] / 1e6).toFixed(3)} M points`);
await browser.close();
