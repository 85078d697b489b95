import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { Layout, Strips } from '../api/package_files.ts';
import { indexStrips, neighbourStrip } from './strip_index.ts';

const strips: Strips = {
  strips: [
    { id: 'W1', family: 'weft', closed: false, quads: [0, 1], pieces: ['W1.1', 'W1.2'] },
    { id: 'P1', family: 'warp', closed: false, quads: [1], pieces: ['P1.1'] },
  ],
  pieces: ['W1.1', 'W1.2', 'P1.1'].map((id) => ({ id, strip: id.slice(0, 2), outline: [], marks: [] })),
};
const at = (piece: string) => ({ piece, xMm: 0, yMm: 0, rotationDeg: 0, mirrored: false });
const sheet = (id: number, ...pieces: string[]) => ({
  id, material: '', family: '', widthMm: 1, heightMm: 1, placements: pieces.map(at),
});
const layout: Layout = { densityPercent: 0, unplaced: [], sheets: [sheet(1, 'W1.1'), sheet(3, 'W1.2', 'P1.1')] };

test('quads know their weft and warp, strips their sheets', () => {
  const index = indexStrips(strips, layout);
  assert.equal(index.weftOfQuad[1], 'W1');
  assert.equal(index.warpOfQuad[1], 'P1');
  assert.equal(index.warpOfQuad[0], undefined);
  assert.deepEqual(index.sheetsOfStrip.get('W1'), [1, 3]);
  assert.deepEqual(index.sheetsOfStrip.get('P1'), [3]);
});

test('stepping through the strips goes round the end', () => {
  const index = indexStrips(strips, layout);
  assert.equal(neighbourStrip(index, null, 1), 'W1');
  assert.equal(neighbourStrip(index, null, -1), 'P1');
  assert.equal(neighbourStrip(index, 'P1', 1), 'W1');
  assert.equal(neighbourStrip(index, 'W1', -1), 'P1');
});
