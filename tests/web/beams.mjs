// Steps of browser.mjs about beams: range images, the path of the sensor and the time, waveforms.

/** Range images of a scan beside a model, a beam picked in them, and its waveform. */
export async function lookAtBeams({ page, expect, ready, accessible, picture, data, press }) {
  await page.locator('#view').press('/');
  await page.getByLabel('Beside the range image').selectOption({ label: 'scene' });
  await page.waitForFunction(() => /both/.test(document.documentElement.dataset.images));
  const [width, height] = (await data('images')).match(/\d+/g).map(Number);
  const canvases = page.locator('#images canvas');
  expect((await canvases.count()) === 3 && width > 20 && height > 3, `range images of ${width} x ${height} pixels`);
  const colours = (k) => page.evaluate((n) => {
    const shown = document.querySelectorAll('#images canvas')[n];
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [shown.width, shown.height];
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(shown, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
  }, k);
  for (const k of [0, 1, 2]) expect((await colours(k)) > 4, `image ${k} has ${await colours(k)} colours`);
  await accessible('range images');

  // A pixel picks its beam; the keyboard does as well.
  const box = await canvases.nth(0).boundingBox();
  await page.mouse.click(box.x + (box.width * (Math.floor(width / 2) + 0.5)) / width, box.y + (box.height * (height - 0.5)) / height);
  await page.waitForFunction(() => /\brow\b/.test(document.querySelector('#details').innerText));
  const rowOf = async () => Number((await page.locator('#details').innerText()).match(/\brow\s+(\d+)/)[1]);
  const row = await rowOf();
  const told = await page.evaluate(async ([x, w, h]) => {
    const bytes = await (await fetch('./api/range_image?file=0&run=0')).arrayBuffer();
    return new Uint32Array(bytes, 12)[3 * ((h - 1) * w + x)];
  }, [Math.floor(width / 2), width, height]);
  expect(row === told, `the pixel of row ${told} picked row ${row}`);
  await canvases.nth(0).press('ArrowLeft');
  await canvases.nth(0).press('Enter');
  await page.waitForFunction((r) => !new RegExp(`\\brow\\s+${r}\\b`).test(document.querySelector('#details').innerText), row);

  // What a sensor of the catalogue receives of it.
  await page.locator('#details').getByLabel('Sensor').selectOption('velodyne-vlp16');
  await page.locator('#details').getByRole('button', { name: 'Waveform and echoes (scene)' }).click();
  await page.locator('svg.waveform').waitFor();
  expect(/velodyne-vlp16 receives it/.test(await page.locator('#details').innerText()), 'the sensor is named');
  await accessible('a waveform');
  await page.locator('#view').press('Escape');
  await page.locator('#view').press('/');
  expect(!(await page.locator('#images').isVisible()), 'the range images close');

  // The path of the sensor, and a short time of the log.
  const before = (await picture('path-off')).drawn;
  await press("'");
  await page.waitForFunction(() => document.documentElement.dataset.paths === '1');
  const whole = await picture('path');
  expect(whole.drawn !== before, 'the path is drawn');
  await press("'");
  await press('\\');
  await page.waitForFunction(() => Number(document.documentElement.dataset.time) > 0.1);
  // On a busy machine the time may have come to its end, and stopped, before this.
  const playing = page.locator('button', { hasText: /^Stop$/ });
  if (await playing.count() > 0) await press('\\');
  await page.locator('button', { hasText: /^Play$/ }).waitFor({ state: 'attached' });
  const move = (name, share) => page.getByLabel(name).evaluate((e, to) => {
    e.value = to * e.max;
    e.dispatchEvent(new Event('input'));
  }, share);
  await move('Time, s', 0.5);
  await move('and before, s', 0.1);
  expect((await picture('time')).drawn < before, 'a short time shows fewer points');
  await move('Time, s', 1);
  await move('and before, s', 1);
  await ready();
}
