// Compares pictures of the view with those that are kept beside this file, as small means of squares of pixels.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const FOLDER = join(dirname(fileURLToPath(import.meta.url)), 'references');
const SQUARE = 6; // pixels
/** Greatest mean difference of a colour, of 255, and greatest share of squares that differ by more than FAR. */
const MEAN = 2;
const FAR = 48;
const SHARE = 0.01;

/** The view as a PNG in which each pixel is the mean of a square of the view's. */
export async function shrunk(page) {
  return page.evaluate((square) => {
    const view = document.querySelector('#view');
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [Math.floor(view.width / square), Math.floor(view.height / square)];
    const whole = document.createElement('canvas');
    [whole.width, whole.height] = [view.width, view.height];
    const from = whole.getContext('2d', { willReadFrequently: true });
    from.drawImage(view, 0, 0);
    const pixels = from.getImageData(0, 0, whole.width, whole.height).data;
    const to = canvas.getContext('2d');
    const out = to.createImageData(canvas.width, canvas.height);
    for (let y = 0; y < canvas.height; ++y) {
      for (let x = 0; x < canvas.width; ++x) {
        const sum = [0, 0, 0];
        for (let v = 0; v < square; ++v) {
          for (let u = 0; u < square; ++u) {
            const at = 4 * ((y * square + v) * whole.width + x * square + u);
            for (let c = 0; c < 3; ++c) sum[c] += pixels[at + c];
          }
        }
        out.data.set([...sum.map((s) => Math.round(s / square ** 2)), 255], 4 * (y * canvas.width + x));
      }
    }
    to.putImageData(out, 0, 0);
    return canvas.toDataURL('image/png');
  }, SQUARE);
}

/** How two small pictures differ: the mean of all colours, and the share of pixels with one that differs by more than FAR. */
export async function difference(page, a, b) {
  return page.evaluate(async ([first, second, far]) => {
    const pixelsOf = async (url) => {
      const picture = new Image();
      picture.src = url;
      await picture.decode();
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [picture.width, picture.height];
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(picture, 0, 0);
      return { data: context.getImageData(0, 0, picture.width, picture.height).data, size: `${picture.width} x ${picture.height}` };
    };
    const [one, two] = [await pixelsOf(first), await pixelsOf(second)];
    if (one.size !== two.size) return { mean: 255, share: 1 };
    let [sum, many] = [0, 0];
    for (let k = 0; k < one.data.length; k += 4) {
      let most = 0;
      for (let c = 0; c < 3; ++c) {
        const off = Math.abs(one.data[k + c] - two.data[k + c]);
        sum += off;
        most = Math.max(most, off);
      }
      many += Number(most > far);
    }
    return { mean: (4 * sum) / (3 * one.data.length), share: (4 * many) / one.data.length };
  }, [a, b, FAR]);
}

const isSame = ({ mean, share }) => mean <= MEAN && share <= SHARE;

/** Compares the view with the picture of this name that is kept, or keeps it where UPDATE is set. */
export async function looksAs(page, name) {
  const file = join(FOLDER, `${name}.png`);
  const now = await shrunk(page);
  if (process.env.UPDATE) writeFileSync(file, Buffer.from(now.split(',')[1], 'base64'));
  if (!existsSync(file)) throw new Error(`tests/web/references/${name}.png is not there: run browser.py --update`);
  const kept = `data:image/png;base64,${readFileSync(file).toString('base64')}`;
  const off = await difference(page, kept, now);
  if (process.env.TELL) console.log(name, off.mean.toFixed(3), off.share.toFixed(4));
  if (!isSame(off)) {
    throw new Error(`${name} looks otherwise than tests/web/references/${name}.png: colours differ by ${off.mean.toFixed(1)} ` +
      `on average, ${(100 * off.share).toFixed(1)} % of the squares by more than ${FAR}; browser.py --update keeps the new one`);
  }
}

/** Checks that the comparison tells pictures apart that a person does. */
export async function comparisonTells(page, expect, changed) {
  const before = await shrunk(page);
  expect(isSame(await difference(page, before, before)), 'a picture is like itself');
  for (const change of changed) {
    await change.make();
    const off = await difference(page, before, await shrunk(page));
    expect(!isSame(off), `${change.name} is not seen: ${JSON.stringify(off)}`);
    await change.back();
  }
}
