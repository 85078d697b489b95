// Bundles the dashboard into dist/: index.html, and everything else under assets/ with a hash in its
// name, so that a server may let browsers keep it for ever. `--watch` builds again on every change.

import { build, context } from 'esbuild';
import { mkdir, readFile, rm, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const root = path.dirname(fileURLToPath(import.meta.url));
const dist = path.join(root, 'dist');

// Puts the hashed names of this build's entries into the page.
const pagePlugin = {
  name: 'page',
  setup(b) {
    b.onEnd(async ({ metafile, errors }) => {
      if (errors.length > 0 || metafile === undefined) return;
      const names = {};
      for (const [file, output] of Object.entries(metafile.outputs)) {
        if (output.entryPoint === undefined) continue;
        names[path.basename(output.entryPoint)] = '/' + path.relative(dist, path.join(root, file));
        if (output.cssBundle !== undefined) {
          names['style.css'] = '/' + path.relative(dist, path.join(root, output.cssBundle));
        }
      }
      const page = await readFile(path.join(root, 'src/index.html'), 'utf8');
      const filled = page.replace(/\{\{([\w.]+)\}\}/g, (whole, name) => {
        if (names[name] === undefined) throw new Error(`index.html asks for ${whole}, which was not built`);
        return names[name];
      });
      await mkdir(dist, { recursive: true });
      await writeFile(path.join(dist, 'index.html'), filled);
    });
  },
};

export const options = {
  absWorkingDir: root,
  entryPoints: ['src/main.tsx', 'src/mesh/worker.ts', 'src/icon.svg'],
  outdir: 'dist/assets',
  entryNames: '[name]-[hash]',
  chunkNames: '[name]-[hash]',
  assetNames: '[name]-[hash]',
  loader: { '.svg': 'copy' },
  bundle: true,
  splitting: true,
  format: 'esm',
  target: ['es2022'],
  jsx: 'automatic',
  jsxImportSource: 'preact',
  minify: true,
  legalComments: 'none',
  metafile: true,
  logLevel: 'warning',
  plugins: [pagePlugin],
};

async function run() {
  await rm(dist, { recursive: true, force: true });
  if (process.argv.includes('--watch')) {
    await (await context(options)).watch();
  } else {
    const { metafile } = await build(options);
    for (const [file, output] of Object.entries(metafile.outputs)) {
      const packed = gzipSync(await readFile(path.join(root, file))).length;
      console.log(`${file}  ${(output.bytes / 1024).toFixed(1)} kB, ${(packed / 1024).toFixed(1)} kB compressed`);
    }
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) await run();
