import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { Job } from '../api/types.ts';
import { formatRoute, parseRoute } from './route.ts';
import { stagesOf } from './stages.ts';

const job = (state: Job['state'], stage: string, fraction = 0.5): Job =>
  ({ state, progress: { stage, fraction } }) as Job;
const states = (one: Job): string => stagesOf(one).map((stage) => stage.state[0]).join('');

test('stages before the running one are done, those after wait', () => {
  assert.equal(states(job('computing', 'quads')), 'dddrwwww');
});

test('a queued job has begun nothing, a ready one has finished all', () => {
  assert.equal(states(job('queued', '')), 'wwwwwwww');
  assert.equal(states(job('ready', 'package')), 'dddddddd');
});

test('a failed job shows where it failed', () => {
  assert.equal(states(job('failed', 'repair')), 'dfwwwwww');
});

test('addresses survive the way there and back', () => {
  for (const route of [{ page: 'jobs' }, { page: 'machines' }, { page: 'job', id: 'j_a/ä' }] as const) {
    assert.deepEqual(parseRoute(formatRoute(route)), route);
  }
  assert.deepEqual(parseRoute('#/nonsense'), { page: 'jobs' });
});
