import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { MeshLook } from '../mesh/look.ts';
import { estimate, scaleOf } from './estimate.ts';

const kNoDefects = { nonManifoldEdges: 0, turnedFaces: 0, degenerateFaces: 0, duplicateVertices: 0, unusedVertices: 0 };
const look = (area: number, genus: number, boundaryLoops: number): MeshLook => ({
  vertices: 100, faces: 200, components: 1, boundaryLoops, genus, euler: 0, sizeMm: [3, 2, 1], area, defects: kNoDefects,
});

// What the computation made of the built-in samples at 14 mm: [area mm², genus, loops, strips, sheets, seconds, grams].
const kMeasured = [
  [100_559, 2, 0, 88, 2, 2588, 32.7],
  [73_900, 0, 1, 40, 2, 1561, 23.7],
] as const;

test('estimates come near to what was computed', () => {
  for (const [area, genus, loops, strips, sheets, seconds, grams] of kMeasured) {
    const guess = estimate(look(area, genus, loops), 1, 14);
    const near = (value: number, real: number, share: number): void => assert.ok(Math.abs(value / real - 1) < share, `${value} for ${real}`);
    near(guess.strips, strips, 0.35);
    assert.equal(guess.sheets, sheets);
    near(guess.laserS, seconds, 0.4);
    near(guess.weightG, grams, 0.1);
  }
});

test('the size follows the longest side', () => {
  const scale = scaleOf(look(10, 0, 0), 300);
  assert.deepEqual(estimate(look(10, 0, 0), scale, 10).sizeMm, [300, 200, 100]);
  assert.equal(scaleOf(look(10, 0, 0), null), 1);
});
