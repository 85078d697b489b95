import assert from 'node:assert/strict';
import { test } from 'node:test';

import { alternativeParams } from './recompute.ts';

test('another layout keeps everything but what belonged to the old one', () => {
  const params = { grid: { strip_width_mm: 6 }, foliation: { mode: 'pants', weights: [1, 2], components: 'largest' } };
  assert.deepEqual(alternativeParams(params, 'sphere-pillowcase'), {
    grid: { strip_width_mm: 6 },
    foliation: { mode: 'sphere-pillowcase', components: 'largest' },
  });
});

test('a job that said nothing of its foliation gets the mode alone', () => {
  assert.deepEqual(alternativeParams({}, 'disk'), { foliation: { mode: 'disk' } });
});

test('a name that is no mode cannot be asked for', () => {
  assert.equal(alternativeParams({}, 'pants with 5 holes'), null);
  assert.equal(alternativeParams({}, 'auto'), null);
});
