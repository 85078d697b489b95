// Writes src/api/schema.ts, the types of what the daemon answers, from its own description.
//   node generate_types.mjs [--check]     with --check: fails if the file is not what it would write

import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const root = path.dirname(fileURLToPath(import.meta.url));
const source = path.resolve(root, '../server/http/openapi.json');
const target = path.join(root, 'src/api/schema.ts');

const quoted = (name) => (/^[A-Za-z_]\w*$/.test(name) ? name : JSON.stringify(name));
const literal = (value) => JSON.stringify(value);

function objectType(schema, indent) {
  const required = new Set(schema.required ?? []);
  const inner = `${indent}  `;
  const lines = Object.entries(schema.properties ?? {}).map(
    ([name, value]) => `${inner}readonly ${quoted(name)}${required.has(name) ? '' : '?'}: ${typeOf(value, inner)};`,
  );
  return lines.length === 0 ? 'Readonly<Record<string, unknown>>' : `{\n${lines.join('\n')}\n${indent}}`;
}

function typeOf(schema, indent = '') {
  if (schema.$ref !== undefined) return schema.$ref.split('/').at(-1);
  if (schema.const !== undefined) return literal(schema.const);
  if (schema.enum !== undefined) return schema.enum.map(literal).join(' | ');
  for (const key of ['oneOf', 'anyOf']) {
    if (schema[key] !== undefined) return schema[key].map((one) => typeOf(one, indent)).join(' | ');
  }
  if (schema.allOf !== undefined) return schema.allOf.map((one) => typeOf(one, indent)).join(' & ');
  if (Array.isArray(schema.type)) return schema.type.map((type) => typeOf({ ...schema, type }, indent)).join(' | ');
  if (schema.type === 'array') return `readonly (${typeOf(schema.items ?? {}, indent)})[]`;
  if (schema.type === 'object' || schema.properties !== undefined) return objectType(schema, indent);
  return { string: 'string', integer: 'number', number: 'number', boolean: 'boolean', null: 'null' }[schema.type] ?? 'unknown';
}

function write() {
  const { components, paths } = JSON.parse(readFileSync(source, 'utf8'));
  const types = Object.entries(components.schemas).map(([name, schema]) => `export type ${name} = ${typeOf(schema)};`);
  const calls = Object.entries(paths)
    .flatMap(([address, item]) =>
      ['get', 'post', 'put', 'patch', 'delete'].filter((method) => item[method]).map((method) => `${method.toUpperCase()} ${address}`),
    )
    .map((call) => `  | ${literal(call)}`);
  return `// Made by generate_types.mjs from the daemon's openapi.json: change that, not this.\n\n${types.join('\n\n')}\n\nexport type Call =\n${calls.join('\n')};\n`;
}

const made = write();
if (process.argv.includes('--check')) {
  const there = readFileSync(target, 'utf8');
  if (there !== made) {
    console.error('src/api/schema.ts is not what openapi.json says: run "npm run types"');
    process.exit(1);
  }
  console.log('schema.ts is current');
} else {
  writeFileSync(target, made);
}
