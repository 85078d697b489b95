// Fails when what a first visit loads is too much: the page, its styles, and every script that the entry and
// the first page need, compressed. The 3D chunk and pages that are opened later do not count.

import { build } from 'esbuild';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import { options } from '../build.mjs';

const kMostBytes = 60_000;
const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '..');

const { metafile, outputFiles } = await build({ ...options, write: false, plugins: [] });
const bytes = new Map(outputFiles.map((file) => [path.relative(root, file.path), gzipSync(file.contents).length]));
const entry = Object.keys(metafile.outputs).find((name) => metafile.outputs[name].entryPoint === 'src/main.tsx');

const first = new Set();
const visit = (name) => {
  if (first.has(name)) return;
  first.add(name);
  const { imports, cssBundle } = metafile.outputs[name];
  if (cssBundle !== undefined) first.add(cssBundle);
  for (const { path: to, kind } of imports) if (kind === 'import-statement') visit(to);
};
visit(entry);
// Another language than English is one more file: the largest counts.
const languages = ['de', 'es', 'fr', 'zh'].map((tag) =>
  Object.keys(metafile.outputs).find((name) => metafile.outputs[name].entryPoint === `src/messages/${tag}/index.ts`),
);
const largest = Math.max(...languages.map((name) => bytes.get(name) ?? 0));
const page = gzipSync(readFileSync(path.join(root, 'src/index.html'))).length;
const total = [...first].reduce((sum, name) => sum + (bytes.get(name) ?? 0), page + largest);
const has3d = [...first].some((name) => Object.keys(metafile.outputs[name].inputs).some((input) => input.includes('node_modules/three/')));

console.log(`first load: ${(total / 1000).toFixed(1)} kB compressed, in ${first.size + 2} files`);
if (has3d) throw new Error('three.js is in the first load');
if (languages.includes(undefined)) throw new Error('a language is not a chunk of its own');
if (total > kMostBytes) throw new Error(`more than ${kMostBytes / 1000} kB`);
