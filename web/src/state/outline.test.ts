import assert from 'node:assert/strict';
import { test } from 'node:test';

import { areaMm2, dropCorner, middle, moveCorner, type Outline, outlineFault, rectangle, splitSide } from './outline.ts';

const kSheet = rectangle(60, 40);

test('a corner moves on whole millimetres and stays on the sheet', () => {
  assert.deepEqual(moveCorner(kSheet, 2, [50.4, 19.6], [60, 40])[2], [50, 20]);
  assert.deepEqual(moveCorner(kSheet, 2, [900, -3], [60, 40])[2], [60, 0]);
  assert.deepEqual(kSheet[2], [60, 40]);
});

test('a side is split in its middle, the last one too', () => {
  assert.deepEqual(middle(kSheet, 3), [0, 20]);
  assert.deepEqual(splitSide(kSheet, 0)[1], [30, 0]);
  assert.deepEqual(splitSide(kSheet, 3).at(-1), [0, 20]);
  assert.equal(outlineFault(splitSide(kSheet, 0)), null);
});

test('three corners are the fewest', () => {
  const triangle = dropCorner(kSheet, 1);
  assert.deepEqual(triangle, [[0, 0], [60, 40], [0, 40]]);
  assert.equal(dropCorner(triangle, 0), triangle);
});

test('the area does not depend on where the outline begins or which way it goes', () => {
  const bent: Outline = [[0, 0], [60, 0], [60, 10], [20, 10], [20, 40], [0, 40]];
  assert.equal(areaMm2(bent), 60 * 10 + 20 * 30);
  assert.equal(areaMm2([...bent].reverse()), areaMm2(bent));
  assert.equal(areaMm2([...bent.slice(3), ...bent.slice(0, 3)]), areaMm2(bent));
});

test('what is no outline is told', () => {
  assert.equal(outlineFault(kSheet), null);
  assert.equal(outlineFault([[0, 0], [10, 0]]), 'few');
  assert.equal(outlineFault([[0, 0], [10, 0], [20, 0]]), 'few');
  assert.equal(outlineFault([[0, 0], [10, 10], [10, 0], [0, 8]]), 'crosses');
  assert.equal(outlineFault([[0, 0], [10, 0], [5, 0], [5, 8]]), 'crosses', 'back over itself');
  assert.equal(outlineFault([[0, 0], [10, 0], [10, 10], [5, 0], [0, 10]]), 'crosses', 'touches a side');
});
