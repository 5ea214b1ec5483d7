// Starts Debian's Chromium, which draws without a graphics card, for the tests of the page.
import { createRequire } from 'node:module';
import { join } from 'node:path';

/** `packages` is the folder in which playwright-core is installed. */
export function launched(packages, executablePath) {
  const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
  return chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--disable-gpu-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}
