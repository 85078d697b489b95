import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { Layout, Mark, Strips } from '../api/package_files.ts';
import { drawSheets, place } from './sheets.ts';

const still = { piece: 'W1.1', xMm: 0, yMm: 0, rotationDeg: 0, mirrored: false };

test('a placement mirrors, then rotates, then moves', () => {
  const [x, y] = place({ ...still, xMm: 10, yMm: 20, rotationDeg: 90, mirrored: true }, [3, 1]);
  assert.ok(Math.abs(x - 9) < 1e-12);
  assert.ok(Math.abs(y - 17) < 1e-12);
});

const line: Mark = { kind: 'score', path: [[1, 0], [1, 1]], text: '', at: [0, 0], angleDeg: 0, heightMm: 0 };
const label: Mark = { kind: 'engrave', path: [], text: 'W1.1', at: [1, 2], angleDeg: 30, heightMm: 3 };

test('pieces are drawn with their strip and family, unknown ones left out', () => {
  const strips: Strips = {
    strips: [{ id: 'W1', family: 'weft', closed: false, quads: [0], pieces: ['W1.1'] }],
    pieces: [{ id: 'W1.1', strip: 'W1', outline: [[0, 0], [4, 0], [4, 1]], marks: [line, label] }],
  };
  const layout: Layout = {
    densityPercent: 1,
    unplaced: [],
    sheets: [
      { id: 1, material: 'paper', family: 'weft', widthMm: 60, heightMm: 40, placements: [{ ...still, xMm: 1 }, { ...still, piece: 'P9.1' }] },
    ],
  };
  const pieces = drawSheets(layout, strips)[0]?.pieces ?? [];
  assert.equal(pieces.length, 1);
  assert.equal(pieces[0]?.family, 'weft');
  assert.equal(pieces[0]?.outline, 'M1.00 0.00L5.00 0.00L5.00 1.00Z');
  assert.equal(pieces[0]?.marks, 'M2.00 0.00L2.00 1.00');
  assert.deepEqual(pieces[0]?.labels, [{ text: 'W1.1', at: [2, 2], angleDeg: 30, heightMm: 3 }]);
});
