import assert from 'node:assert/strict';
import { test } from 'node:test';

import { age, bytes, duration, figure, percent, stem } from './format.ts';

test('durations change unit where the next one reads better', () => {
  assert.equal(duration(0.4), '0 s');
  assert.equal(duration(59.4), '59 s');
  assert.equal(duration(59.6), '1 min');
  assert.equal(duration(3900), '1 h 05 min');
});

test('a percentage never says 100 before it is all done', () => {
  assert.equal(percent(0.9999), '99 %');
  assert.equal(percent(1), '100 %');
  assert.equal(percent(-1), '0 %');
});

test('sizes are decimal', () => {
  assert.equal(bytes(999), '999 B');
  assert.equal(bytes(1500), '1.5 kB');
  assert.equal(bytes(2_340_000), '2.34 MB');
});

test('figures keep small and large values readable', () => {
  assert.equal(figure(0.0123456), '0.0123');
  assert.equal(figure(81.26), '81.3');
});

test('ages are relative today and dates before', () => {
  const now = new Date('2026-03-04T12:00:00Z');
  assert.equal(age('2026-03-04T11:58:00Z', now), '2 minutes ago');
  assert.equal(age('2026-03-04T09:00:00Z', now), '3 hours ago');
  assert.match(age('2026-01-02T09:00:00Z', now), /Jan 2, 2026/);
  assert.equal(age('nonsense', now), '');
});

test('a stem drops only the last ending', () => {
  assert.equal(stem('rocker-arm.v2.obj'), 'rocker-arm.v2');
  assert.equal(stem('.obj'), '.obj');
});
