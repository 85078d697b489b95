import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readCut, readJob } from '../api/payloads.ts';
import { history, totals, waitingCuts, waitingJobs } from './history.ts';

const job = (id: string, state: string, more: object = {}) =>
  readJob({ id, name: `Job ${id}`, state, created_at: `2026-01-0${id}T00:00:00Z`, ...more }, '');
const map = <T extends { readonly id: string }>(...items: readonly T[]): ReadonlyMap<string, T> => new Map(items.map((one) => [one.id, one]));

test('what computes comes first, then what the daemon says, then priority', () => {
  const jobs = map(job('1', 'queued'), job('2', 'queued', { priority: 5 }), job('3', 'computing'), job('4', 'queued'), job('5', 'ready'));
  assert.deepEqual(waitingJobs(jobs, ['4', '1']).map(({ id }) => id), ['3', '4', '1', '2']);
  assert.deepEqual(waitingJobs(jobs, []).map(({ id }) => id), ['3', '2', '1', '4']);
});

test('history is what is over, newest first, as far as it was asked for', () => {
  const jobs = map(job('1', 'done'), job('2', 'failed'), job('3', 'queued'), job('4', 'ready'));
  assert.deepEqual(history(jobs, { words: '', state: 'all' }).map(({ id }) => id), ['4', '2', '1']);
  assert.deepEqual(history(jobs, { words: 'jOb 2', state: 'all' }).map(({ id }) => id), ['2']);
  assert.deepEqual(history(jobs, { words: '', state: 'done' }).map(({ id }) => id), ['1']);
});

test('totals count what has a summary', () => {
  const summary = { quads: 1, strips: 7, pieces: 9, sheets: 1, estimated_s: 60 };
  assert.deepEqual(totals([job('1', 'done', { summary }), job('2', 'failed')]), { jobs: 2, strips: 7, laserS: 60 });
});

test('cuts that are over do not wait', () => {
  const cut = (id: string, state: string) => readCut({ id, job: '1', device: 'd', sheets: [1], state, created_at: id }, '');
  assert.deepEqual(waitingCuts(map(cut('1', 'waiting'), cut('2', 'done'), cut('3', 'cutting'))).map(({ id }) => id), ['3', '1']);
});
