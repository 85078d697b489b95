// Bundles every src/**/*.test.ts for Node and runs the bundles with node's own test runner, whose last
// lines count what ran.

import { build } from 'esbuild';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '..');

function specs(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const full = path.join(folder, entry.name);
    if (entry.isDirectory()) return specs(full);
    return /\.test\.tsx?$/.test(entry.name) ? [full] : [];
  });
}

// Inside node_modules, so that bundles find their external packages and git never sees them.
const out = mkdtempSync(path.join(root, 'node_modules', '.specs-'));
try {
  await build({
    absWorkingDir: root,
    entryPoints: specs(path.join(root, 'src')),
    outbase: 'src',
    outdir: out,
    outExtension: { '.js': '.mjs' },
    bundle: true,
    platform: 'node',
    format: 'esm',
    target: 'node18',
    jsx: 'automatic',
    jsxImportSource: 'preact',
    packages: 'external',
    sourcemap: 'inline',
  });
  const bundles = readdirSync(out, { recursive: false, withFileTypes: true }).flatMap(function walk(entry) {
    const full = path.join(entry.path ?? entry.parentPath, entry.name);
    return entry.isDirectory() ? readdirSync(full, { withFileTypes: true }).flatMap(walk) : [full];
  });
  const run = spawnSync(process.execPath, ['--enable-source-maps', '--test', ...bundles.sort()], { stdio: 'inherit' });
  process.exitCode = run.status ?? 1;
} finally {
  rmSync(out, { recursive: true, force: true });
}
