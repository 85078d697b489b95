import assert from 'node:assert/strict';
import { test } from 'node:test';

import { nextConnection, retryDelayMs } from './connection.ts';

test('a lost connection waits, then tries again', () => {
  assert.equal(nextConnection('live', 'lost'), 'waiting');
  assert.equal(nextConnection('waiting', 'retry'), 'connecting');
});

test('a late signal of a connection that was closed on purpose changes nothing', () => {
  assert.equal(nextConnection('resting', 'lost'), 'resting');
  assert.equal(nextConnection('resting', 'opened'), 'resting');
});

test('coming back to the page reconnects at once', () => {
  assert.equal(nextConnection('resting', 'show'), 'connecting');
  assert.equal(nextConnection('waiting', 'show'), 'connecting');
  assert.equal(nextConnection('live', 'show'), 'live');
});

test('waits double up to ten seconds', () => {
  assert.deepEqual([1, 2, 3, 4, 5, 6, 60].map(retryDelayMs), [500, 1000, 2000, 4000, 8000, 10000, 10000]);
});
