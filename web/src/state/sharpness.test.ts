import assert from 'node:assert/strict';
import { test } from 'node:test';

import { kCoarsest, nextRatio } from './sharpness.ts';

test('slow frames get coarser, down to the coarsest', () => {
  let ratio = 2;
  for (let frame = 0; frame < 20; frame += 1) {
    const next = nextRatio(ratio, 2, 300);
    assert.ok(next < ratio || ratio === kCoarsest);
    ratio = next;
  }
  assert.equal(ratio, kCoarsest);
});

test('fast frames get sharper, up to what the screen has', () => {
  let ratio = kCoarsest;
  for (let frame = 0; frame < 20; frame += 1) ratio = nextRatio(ratio, 1, 10);
  assert.equal(ratio, 1);
});

test('what is quick enough stays as it is', () => {
  assert.equal(nextRatio(0.8, 1, 40), 0.8);
});
