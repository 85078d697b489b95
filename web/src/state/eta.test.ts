import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readJob } from '../api/payloads.ts';
import { secondsLeft, workDone } from './eta.ts';
import { kStages } from './stages.ts';

const at = (stage: string, fraction: number) =>
  readJob({ id: 'j', state: 'computing', created_at: '', progress: { stage, fraction } }, '');

test('work never shrinks from stage to stage and ends at one', () => {
  let before = 0;
  for (const stage of kStages) {
    for (const fraction of [0, 0.5, 1]) {
      const now = workDone(at(stage, fraction));
      assert.ok(now >= before - 1e-12, stage);
      before = now;
    }
  }
  assert.ok(Math.abs(before - 1) < 1e-9);
});

test('half the work in ten seconds leaves ten', () => {
  const half = at('quads', 2 / 3);
  assert.ok(Math.abs((secondsLeft(half, { sinceMs: 0, share: 0 }, 10_000) ?? 0) - 10) < 0.01);
});

test('nothing is said before anything can be known', () => {
  assert.equal(secondsLeft(at('foliation', 0.5), { sinceMs: 0, share: 0 }, 500), null);
  assert.equal(secondsLeft(at('read', 0.1), { sinceMs: 0, share: 0 }, 60_000), null);
});
