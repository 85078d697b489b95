import assert from 'node:assert/strict';
import { test } from 'node:test';

import { ending, fileRows } from './files.ts';

const file = (path: string) => ({ path, bytes: 1, mediaType: '' });

test('the files of a sheet share a row, in the order of the sheets', () => {
  const rows = fileRows(['sheets/sheet-010.svg', 'report.json', 'sheets/sheet-002.svg', 'sheets/sheet-010.gcode'].map(file));
  assert.deepEqual(rows.map((row) => row.sheet), [null, 2, 10]);
  assert.deepEqual(rows[2]?.files.map(({ path }) => ending(path)), ['svg', 'gcode']);
});

test('a file that only looks like a sheet stands by itself', () => {
  assert.equal(fileRows([file('sheets/readme.txt')])[0]?.sheet, null);
});

test('the pages for scissors share a row before the sheets', () => {
  const rows = fileRows(['sheets/sheet-001.svg', 'scissors/page-001.svg', 'scissors/page-002.svg', 'strips.svg'].map(file));
  assert.deepEqual(rows.map((row) => row.files.length), [1, 2, 1]);
  assert.equal(rows[1]?.pages, true);
});
