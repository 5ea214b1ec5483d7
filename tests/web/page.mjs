// Steps of browser.mjs about the page around the view: legends, framing beside panels, light, names, and phones.

/** Colours of the view's pixels that are not background, by place, and the places that no panel covers. */
const pixels = (page) => page.evaluate(() => {
  const view = document.querySelector('#view');
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [view.width, view.height];
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(view, 0, 0);
  const colours = new Uint32Array(context.getImageData(0, 0, view.width, view.height).data.buffer);
  const box = view.getBoundingClientRect();
  const out = { width: view.width, drawn: [], hidden: 0 };
  colours.forEach((colour, k) => {
    if (colour === colours[0]) return;
    out.drawn.push([k, colour]);
    const [x, y] = [box.left + (k % view.width), box.top + Math.floor(k / view.width)];
    if (document.elementFromPoint(x, y) !== view) ++out.hidden;
  });
  return out;
});

/** The least distance of two colours in OKLab, of CSS colours as `rgb(r, g, b)`. */
export function leastDistance(colours) {
  const labs = colours.map((css) => {
    const [r, g, b] = css.match(/\d+/g).map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    const [l, m, s] = [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
      [0.0883024619, 0.2817188376, 0.6299787005]].map(([x, y, z]) => Math.cbrt(x * r + y * g + z * b));
    return [0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s, 1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
      0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s];
  });
  let least = Infinity;
  labs.forEach((a, i) => labs.slice(i + 1).forEach((b) => (least = Math.min(least, Math.hypot(...a.map((v, k) => v - b[k]))))));
  return least;
}

const swatches = (page, where) => page.evaluate((w) => [...document.querySelectorAll(w)].map((e) => getComputedStyle(e).backgroundColor), where);

export async function lookAtPage({ page, expect, ready, press, only, show, difference, shrunk }) {
  const light = page.getByLabel('Eye-dome lighting of points');
  const drawer = page.getByLabel('Drawn by');
  const legend = async () => (await page.locator('#legend').innerText()).replace(/\s*\n\s*/g, '\n');

  // Log and model together: two colour maps, two scales, and points that the ground does not hide.
  await only('log.ply');
  await light.setChecked(false);
  await press('1');
  await ready();
  const points = await pixels(page);
  const colours = new Set(points.drawn.map(([, colour]) => colour));
  await show('model', true);
  await ready();
  const left = (await pixels(page)).drawn.filter(([, colour]) => colours.has(colour)).length;
  expect(left > 0.9 * points.drawn.length, `the ground hides points: ${left} of ${points.drawn.length} pixels are left`);
  const bars = await page.evaluate(() => [...document.querySelectorAll('#legend .bar')].map((e) => e.style.background));
  expect(bars.length === 2 && bars[0] !== bars[1], `colour maps of points and of elements: ${bars.join(' and ')}`);
  expect(/by height, m\n-?[\d.]+\n-?[\d.]+\n-?[\d.]+\n.*probability p\n0\n0.5\n1/.test(await legend()), `the legend: ${await legend()}`);

  // Everything that is framed lies beside the panels, those on the right too.
  await press('f');
  await ready();
  let seen = await pixels(page);
  expect(seen.hidden < 0.05 * seen.drawn.length, `panels cover ${seen.hidden} of ${seen.drawn.length} pixels`);
  await page.getByText('score.json (score)').click();
  await page.locator('#details').getByText('packet_error_m').first().waitFor();
  await press('f');
  await ready();
  seen = await pixels(page);
  expect(seen.hidden < 0.03 * seen.drawn.length, `the details cover ${seen.hidden} of ${seen.drawn.length} pixels`);
  await press('Escape');
  await page.getByText('score.json (score)').click();
  await press('Escape');

  // A legend of classes lists those of the log, in colours that differ.
  await show('model', false);
  await page.getByLabel('Points by').selectOption('class');
  await ready();
  expect(/by class\n(.+\n)*.+/.test(await legend()), `the legend of classes: ${await legend()}`);
  const classes = await swatches(page, '#legend .swatch');
  expect(classes.length > 0 && (classes.length === 1 || leastDistance(classes) > 0.08), `colours of classes: ${classes.join(' ')}`);
  await page.getByLabel('Points by').selectOption('height');

  // Eye-dome lighting darkens and takes nothing away; the processor and the graphics card draw the same picture.
  await press('f');
  await page.getByLabel('Point size').fill('6');
  for (const lit of [false, true]) {
    await light.setChecked(lit);
    const shots = [];
    for (const by of ['processor', 'graphics card']) {
      await drawer.selectOption(by);
      await ready();
      shots.push({ small: await shrunk(page), ...(await pixels(page)) });
    }
    const off = await difference(page, shots[0].small, shots[1].small);
    expect(off.mean < 2 && off.share < 0.01, `processor and graphics card, light ${lit}: ${JSON.stringify(off)}`);
    const sum = ({ drawn }) => drawn.reduce((s, [, c]) => s + (c & 255) + ((c >> 8) & 255) + ((c >> 16) & 255), 0);
    if (!lit) seen = shots[0];
    else expect(sum(shots[0]) < 0.99 * sum(seen) && shots[0].drawn.length === seen.drawn.length, 'light makes edges darker');
  }
  await page.getByLabel('Point size').fill('2');
  await drawer.selectOption('automatic');

  // Each side of a split screen has the name of its file.
  await press('0');
  await page.waitForFunction(() => document.documentElement.dataset.compare === 'split');
  await ready();
  const middle = await page.evaluate(() => {
    const box = document.querySelector('#view').getBoundingClientRect();
    return box.left + box.width / 2;
  });
  for (const [side, name] of [['left', 'log.ply'], ['right', 'model']]) {
    const label = page.locator(`.side.${side}`);
    const box = await label.boundingBox();
    expect(box && (box.x > middle) === (side === 'right') && (await label.innerText()) === name, `the name of the ${side} side`);
  }
  await press('0');
  await press('0');

  // Primitives stand apart: what they draw lies beside what the model draws.
  await only('model');
  await show('primitives', true);
  await press('1');
  await ready();
  const both = new Map((await pixels(page)).drawn);
  await page.getByText('primitives (primitives)').click(); // without looking at everything anew
  await ready();
  seen = await pixels(page);
  const world = new Map(seen.drawn);
  const box = (places) => places.reduce(([x0, x1, y0, y1], k) => {
    const [x, y] = [k % seen.width, Math.floor(k / seen.width)];
    return [Math.min(x0, x), Math.max(x1, x), Math.min(y0, y), Math.max(y1, y)];
  }, [Infinity, -Infinity, Infinity, -Infinity]);
  const [a, b] = [box([...both.keys()].filter((k) => !world.has(k))), box([...world.keys()])];
  expect(a[0] <= a[1] && (a[0] > b[1] || a[1] < b[0] || a[2] > b[3] || a[3] < b[2]), `primitives at ${a}, the model at ${b}`);
  for (const k of world.keys()) expect(both.get(k) === world.get(k), 'primitives are not within the world');

  // The help opens at its top.
  await press('?');
  const help = await page.evaluate(() => {
    const dialog = document.querySelector('#help');
    const heading = dialog.querySelector('h2').getBoundingClientRect();
    return dialog.scrollTop === 0 && heading.top >= 0 && dialog.scrollHeight > dialog.clientHeight;
  });
  expect(help, 'the help opens at its top');
  await page.keyboard.press('Escape');
}

/** A sample of a log is shown before its octree is there, and is gone afterwards. */
export async function lookEarly({ page, expect, ready, address, returns }) {
  let building = true;
  await page.route(/api\/octree\?/, (route) => (building ? route.fulfill({ json: { state: 'building', done: 0.5 } }) : route.continue()));
  await page.goto('about:blank');
  await page.goto(address);
  await page.waitForFunction(() => Number(document.documentElement.dataset.points) > 0);
  expect((await page.evaluate(() => document.documentElement.dataset.state)) === 'loading', 'a sample is not all');
  building = false;
  await ready();
  const points = Number(await page.evaluate(() => document.documentElement.dataset.points));
  expect(points === returns, `${points} points after the sample, ${returns} are there`);
  await page.unroute(/api\/octree\?/);
}

/** On a phone the open menu covers no button. */
export async function lookAtPhone({ page, expect }) {
  const covered = await page.evaluate(() => [...document.querySelectorAll('header button')].filter((button) => {
    const box = button.getBoundingClientRect();
    const at = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
    return !button.contains(at);
  }).map((button) => button.innerText));
  expect(covered.length === 0, `the menu covers ${covered.join(', ')}`);
}
