import { readFileSync } from 'node:fs';
import { defineConfig } from 'vite';

const licence = readFileSync(new URL('./node_modules/three/LICENSE', import.meta.url), 'utf8');

// Three files with fixed names, which the program carries; see src/underbrush/serve/CMakeLists.txt.
export default defineConfig({
  base: './',
  esbuild: { legalComments: 'inline' },
  build: {
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 1000,
    rollupOptions: {
      output: {
        banner: `/*! This file contains three.js. SPDX-License-Identifier: MIT\n${licence}*/`,
        entryFileNames: 'app.js',
        assetFileNames: 'app.[ext]',
        inlineDynamicImports: true,
      },
    },
  },
});
