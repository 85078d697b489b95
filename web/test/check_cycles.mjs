// Fails when modules of src/ import each other in a circle, or import against the order of the rooms:
// lib <- api <- state <- view.

import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const source = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../src');
const mayImport = {
  lib: ['lib'],
  mesh: ['mesh'],
  messages: ['messages', 'lib'],
  api: ['api', 'lib'],
  state: ['state', 'mesh', 'api', 'lib', 'messages'],
  view: ['view', 'state', 'mesh', 'api', 'lib', 'messages'],
};

function modules(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const full = path.join(folder, entry.name);
    if (entry.isDirectory()) return modules(full);
    return /\.tsx?$/.test(entry.name) ? [full] : [];
  });
}

function importsOf(file) {
  const found = readFileSync(file, 'utf8').matchAll(/(?:from|import)\s*\(?\s*'(\.[^']+)'/g);
  return [...found].map((match) => path.resolve(path.dirname(file), match[1]));
}

const name = (file) => path.relative(source, file);
const files = modules(source);
const graph = new Map(files.map((file) => [file, importsOf(file).filter((to) => /\.tsx?$/.test(to))]));
const faults = [];

for (const [file, targets] of graph) {
  const allowed = mayImport[name(file).split(path.sep)[0]];
  for (const to of targets) {
    if (!graph.has(to)) faults.push(`${name(file)} imports ${name(to)}, which does not exist`);
    else if (allowed !== undefined && !allowed.includes(name(to).split(path.sep)[0])) {
      faults.push(`${name(file)} may not import ${name(to)}`);
    }
  }
}

const done = new Set();
function visit(file, trail) {
  const start = trail.indexOf(file);
  if (start >= 0) {
    faults.push(`circle: ${[...trail.slice(start), file].map(name).join(' -> ')}`);
    return;
  }
  if (done.has(file)) return;
  for (const to of graph.get(file) ?? []) visit(to, [...trail, file]);
  done.add(file);
}
for (const file of files) visit(file, []);

for (const fault of faults) console.error(fault);
console.log(`${files.length} modules, ${faults.length} faults in their imports`);
process.exitCode = faults.length === 0 ? 0 : 1;
