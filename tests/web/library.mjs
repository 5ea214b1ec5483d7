// Steps of browser.mjs about libraries: the table is sorted and filtered, primitives are renamed, relabelled and thrown
// out, and the program applies what was written.
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { end, startServer } from './labels.mjs';

const fact = (page, name) => page.evaluate((n) => document.documentElement.dataset[n] ?? '', name);
const waitFor = (page, name, value) =>
  page.waitForFunction(([n, v]) => document.documentElement.dataset[n] === v, [name, value], { polling: 30 });

export async function editLibrary({ page, expect, ready, accessible, picture, program, folder, complaints }) {
  const merge = (...words) => execFileSync(program, ['primitives', 'merge', ...words], { cwd: folder });
  execFileSync(program, ['meshes', 'tree.obj', '-o', 'meshes'], { cwd: folder });
  merge('primitives', 'meshes', '--of-site', 'creek', 'yard', '--of-license', 'CC-BY-4.0', 'MIT', '-o', 'library');
  const list = (name) => JSON.parse(execFileSync(program, ['primitives', 'list', name, '--json', '-'], { cwd: folder })).primitives;
  const before = list('library');
  merge('library', 'library', 'library', '--keep-duplicates', '-o', 'many');
  const server = await startServer(program, folder, 'model', 'library', 'many', '--labels', 'work');
  await page.goto('about:blank');
  await page.goto(server.address);
  await ready();
  const press = (key) => page.locator('#view').press(key);
  const show = (name, on) => page.locator('#panel label.check', { hasText: new RegExp(`^${name} ?\\(`) }).locator('input').setChecked(on);
  await show('library', false);
  await page.getByRole('button', { name: 'Table', exact: true }).waitFor({ state: 'hidden' });
  await show('model', false);
  await show('library', true);
  await page.getByRole('button', { name: 'Table', exact: true }).click();
  await waitFor(page, 'library', '13 13 0');
  await accessible('the library');

  // What is told is what `primitives list` says.
  const table = page.getByRole('table', { name: 'Primitives of the library' });
  const column = async (title) => {
    const titles = await table.getByRole('columnheader').allInnerTexts();
    const at = titles.findIndex((text) => text.replace(/[▲▼]/g, '').trim() === title);
    expect(at >= 0, `no column ${title} in ${titles}`);
    return table.locator('tbody tr').evaluateAll((rows, k) => rows.map((row) => {
      const cell = row.cells[k];
      return cell.querySelector('input, select')?.value ?? cell.innerText.trim();
    }), at);
  };
  const order = [...before].sort((a, b) => (a.folder < b.folder ? -1 : 1));
  for (const [title, key] of [['Primitive', 'folder'], ['Site', 'site'], ['Licence', 'license'], ['Name', 'name']]) {
    expect(JSON.stringify(await column(title)) === JSON.stringify(order.map((p) => p[key])), `the column ${title}: ${await column(title)}`);
  }
  expect(JSON.stringify(await column('Height, m')) === JSON.stringify(order.map((p) => p.height_m.toFixed(2))), 'the heights');
  const shown = await table.locator('tbody img').first().evaluate(async (img) => (await img.decode(), img.naturalWidth));
  expect(shown === 160, `a thumbnail of ${shown} pixels`);

  // Sorting, by a click and by the keyboard.
  const head = (title) => table.getByRole('columnheader', { name: title });
  const sorted = (values, sign) => values.every((v, k) => k === 0 || sign * (Number(v) - Number(values[k - 1])) >= 0);
  await head('Height, m').getByRole('button').click();
  expect((await head('Height, m').getAttribute('aria-sort')) === 'ascending' && sorted(await column('Height, m'), 1), 'the lowest is first');
  await page.keyboard.press('Enter');
  expect((await head('Height, m').getAttribute('aria-sort')) === 'descending' && sorted(await column('Height, m'), -1), 'the highest is first');
  await head('Points').getByRole('button').focus();
  await page.keyboard.press('Enter');
  expect((await head('Height, m').getAttribute('aria-sort')) === 'none' && sorted(await column('Points'), 1), 'the fewest points are first');
  await head('Class').getByRole('button').click();
  expect((await column('Class'))[0] === 'large_shrub' && (await column('Class')).at(-1) === 'large_tree', 'classes have their own order');

  // Filters.
  await page.getByLabel('Class or kind').selectOption('tree');
  await waitFor(page, 'library', '9 13 0');
  await page.getByLabel('Search in names, classes and origins').fill('medium MIT');
  await waitFor(page, 'library', '3 13 0');
  expect((await page.getByLabel('Primitives shown').innerText()) === '3 of 13 shown, 0 thrown out', 'the count');
  await page.getByLabel('Class or kind').selectOption('medium_shrub');
  await waitFor(page, 'library', '0 13 0');
  await page.getByLabel('Class or kind').selectOption('');
  await page.getByLabel('Search in names, classes and origins').fill('');
  await waitFor(page, 'library', '13 13 0');

  // All rows that the filters leave are changed at once, and undone at once.
  const trees = before.map((p) => ({ ...p, class: p.folder.split('/')[0] })).filter((p) => p.class.endsWith('_tree'));
  const all = (text) => page.getByRole('group', { name: 'All shown' }).getByRole('button', { name: `${text} all shown` });
  await page.getByLabel('Class or kind').selectOption('tree');
  await all('Throw out').click();
  await waitFor(page, 'library', '9 13 9');
  await page.getByLabel('Kept or thrown out').selectOption('thrown out');
  await page.getByLabel('Search in names, classes and origins').fill('MIT');
  await all('Bring back').click();
  await waitFor(page, 'primitiveEdits', `${trees.filter((p) => p.license !== 'MIT').length}`);
  await page.keyboard.press('Control+z');
  await page.keyboard.press('Control+z');
  await waitFor(page, 'primitiveEdits', '0');
  await page.getByLabel('Search in names, classes and origins').fill('');
  await page.getByLabel('Kept or thrown out').selectOption('kept and thrown out');
  await page.getByLabel('Class of all shown').selectOption('small_tree');
  await all('Relabel').click();
  await waitFor(page, 'primitiveEdits', `${trees.filter((p) => p.class !== 'small_tree').length}`);
  expect((await column('Class')).every((c) => c === 'small_tree'), 'all trees are small');
  await press('<');
  await waitFor(page, 'primitiveEdits', '0');
  await page.getByLabel('Class or kind').selectOption('');
  await waitFor(page, 'library', '13 13 0');

  // A row is shown in the view.
  await press('f');
  const eye = await fact(page, 'eye');
  await page.getByRole('button', { name: 'Show medium_tree/0002' }).click();
  await waitFor(page, 'primitive', 'medium_tree/0002');
  await page.waitForFunction((e) => document.documentElement.dataset.eye !== e, eye);
  const alone = await picture('library');
  await press('Escape');
  expect((await picture('library-all')).drawn > alone.drawn, 'the primitive was shown alone');

  // Rename, relabel, throw out; the focus stays, and Tab goes on.
  const name = page.getByLabel('Name of medium_tree/0002');
  await name.fill('Eiche am Bach');
  await page.keyboard.press('Tab');
  await waitFor(page, 'primitiveEdits', '1');
  expect((await page.evaluate(() => document.activeElement.ariaLabel)) === 'Class of medium_tree/0002', 'Tab goes on to the class');
  const choices = await page.getByLabel('Class of large_shrub/0002').locator('option').allInnerTexts();
  expect(choices.includes('small_tree') && !choices.some((c) => /patch|ground|grass/.test(c)), `classes for a shrub: ${choices}`);
  await page.getByLabel('Class of large_shrub/0002').selectOption('small_tree');
  await waitFor(page, 'primitiveEdits', '2');
  expect((await page.evaluate(() => document.activeElement.ariaLabel)) !== null, 'the focus is somewhere');
  await page.getByRole('button', { name: 'Throw out large_shrub/0001' }).click();
  await waitFor(page, 'library', '13 13 1');
  expect((await page.evaluate(() => document.activeElement.ariaLabel)) === 'Bring back large_shrub/0001', 'the focus stays');
  await page.getByLabel('Kept or thrown out').selectOption('thrown out');
  await waitFor(page, 'library', '1 13 1');
  await page.getByRole('button', { name: 'Bring back large_shrub/0001' }).click();
  await waitFor(page, 'library', '0 13 0');
  await page.getByLabel('Kept or thrown out').selectOption('kept');
  await page.getByRole('button', { name: 'Throw out large_shrub/0003' }).press('Enter');
  await waitFor(page, 'library', '12 13 1');
  await page.getByLabel('Kept or thrown out').selectOption('kept and thrown out');
  await accessible('an edited library');

  // Undo and redo: by buttons, by keys, and as in a desktop program.
  const button = (text) => page.locator('section', { has: page.getByLabel('Edits of primitives', { exact: true }) }).getByRole('button', { name: text, exact: true });
  await button('Undo').click();
  await waitFor(page, 'library', '13 13 0');
  await press('<');
  await waitFor(page, 'library', '13 13 1');
  await press('<');
  await press('<');
  await waitFor(page, 'primitiveEdits', '1');
  expect((await page.getByLabel('Class of large_shrub/0002').inputValue()) === 'large_shrub', 'the class is that of the set again');
  for (let k = 0; k < 3; ++k) await press('>');
  await page.getByRole('button', { name: 'Show medium_tree/0002' }).press('Control+y');
  await waitFor(page, 'library', '13 13 1');
  await waitFor(page, 'primitiveEdits', '3');
  await page.getByRole('button', { name: 'Show medium_tree/0002' }).press('Control+z');
  await waitFor(page, 'library', '13 13 0');
  await button('Redo').click();
  await waitFor(page, 'library', '13 13 1');
  expect(/^13 primitives, 1 thrown out, 2 changed; not written yet$/.test(await page.getByLabel('Edits of primitives', { exact: true }).innerText()), 'the counts');

  // The link keeps the edits and the table.
  await page.waitForFunction(() => document.documentElement.dataset.link === 'new');
  await page.reload();
  await ready();
  await waitFor(page, 'primitiveEdits', '3');
  expect((await page.getByLabel('Name of medium_tree/0002').inputValue()) === 'Eiche am Bach', 'the name is there after a reload');

  // The program applies what was written.
  const status = (pattern) => page.waitForFunction((p) => new RegExp(p).test(document.querySelector('#status').innerText), pattern);
  const files = () => readdirSync(join(folder, 'work')).filter((f) => /^primitive-edits-.*json$/.test(f)).map((f) => join(folder, 'work', f));
  await button('Write edits').click();
  await status('^Written: ');
  const [written] = files();
  const command = await page.getByLabel('Command that applies the edits').innerText();
  const words = command.split(' ');
  expect(words.slice(0, 3).join(' ') === 'underbrush primitives merge' && words.includes(written), `the command: ${command}`);
  execFileSync(program, [...words.slice(1, -1), 'edited'], { cwd: folder });
  const after = list('edited');
  const told = (p) => [p.height_m, p.site, p.license].join(' ');
  expect(after.length === 12 && !after.some((p) => p.folder === 'large_shrub/0004'), `after the edits: ${after.map((p) => p.folder)}`);
  expect(after.find((p) => p.folder === 'medium_tree/0002').name === 'Eiche am Bach', 'the name is in the library');
  const moved = after.filter((p) => p.folder.startsWith('small_tree') && p.license === 'CC-BY-4.0');
  expect(moved.length === 1 && told(moved[0]) === told(before[1]), `relabelled: ${JSON.stringify(moved)}`);

  // A list that was written opens again, and one of another set does not.
  const open = (path) => page.getByLabel('List of edits of a library').setInputFiles(path);
  for (let k = 3; k > 0; --k) await button('Undo').click();
  await open(written);
  await status('^Opened: ');
  await waitFor(page, 'primitiveEdits', '3');
  const text = JSON.parse(readFileSync(written, 'utf8'));
  for (const [change, reason] of [
    [{ set: `xxh3:${'0'.repeat(32)}` }, 'bad.json: set: the edits were made for another set'],
    [{ edits: [...text.edits, { primitive: 'large_tree/0009', remove: true }] }, 'bad.json: edits\\[3\\].primitive: there is no such'],
    [{ format: 'x' }, 'bad.json: not a list of edits of primitives'],
  ]) {
    writeFileSync(join(folder, 'bad.json'), JSON.stringify({ ...text, ...change }));
    await open(join(folder, 'bad.json'));
    await status(`^${reason}`);
    await waitFor(page, 'primitiveEdits', '3');
  }

  // The page merges by itself, and goes on with the result.
  await button('Merge').click();
  await page.waitForFunction(() => /primitives (done|failed)/.test(document.documentElement.dataset.jobs), null, { polling: 100 });
  expect(/primitives done/.test(await fact(page, 'jobs')), await fact(page, 'jobs'));
  await waitFor(page, 'library', '12 12 0');
  await ready();
  expect((await page.getByLabel('Name of medium_tree/0002').inputValue()) === 'Eiche am Bach', 'the name in the result');
  expect((await page.getByLabel('Edits of primitives', { exact: true }).innerText()) === '12 primitives, 0 thrown out, 0 changed', 'the result has no edits');
  await all('Throw out').click();
  await status('^One primitive at least must remain');
  await waitFor(page, 'library', '12 12 0');
  for (let k = 0; k < 12; ++k) await page.getByRole('button', { name: /^Throw out \w+\// }).first().click();
  await status('^One primitive at least must remain');
  await waitFor(page, 'library', '12 12 11');

  // A list for which one request has no room is written whole.
  await show('library-[\\w-]+', false);
  await show('many', true);
  await page.getByRole('button', { name: 'Table', exact: true }).click();
  await waitFor(page, 'library', '39 39 0');
  const named = list('many').map((p, k) => ({ primitive: p.folder, name: `${k} ${'木'.repeat(60)}` }));
  writeFileSync(join(folder, 'long.json'), JSON.stringify({ format: text.format, version: 1, edits: named }));
  await open(join(folder, 'long.json'));
  await waitFor(page, 'primitiveEdits', '39');
  const known = files();
  await button('Write edits').click();
  await status('^Written: ');
  const [long] = files().filter((f) => !known.includes(f));
  expect(JSON.stringify(JSON.parse(readFileSync(long, 'utf8')).edits) === JSON.stringify(named), 'the long list is whole');

  // On a phone nothing sticks out.
  await page.setViewportSize({ width: 360, height: 640 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  expect(wide <= 360, `the page is ${wide} pixels wide`);
  await page.setViewportSize({ width: 900, height: 420 });
  await page.getByRole('button', { name: 'Close the table' }).click();
  expect(!(await page.locator('#library').isVisible()), 'the table closes');
  await page.goto('about:blank');
  await end(server, 'SIGINT');
  expect(complaints.length === 0, `the console: ${complaints.join('; ')}`);
}
