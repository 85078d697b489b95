import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readDevice } from '../api/payloads.ts';
import type { Cut, Device, Job } from '../api/types.ts';
import { currentCut, doubtfulAfter, kEmptyFeed, newestFirst, reduceFeed } from './feed.ts';

function job(id: string, over: Partial<Job> = {}): Job {
  return {
    id,
    name: id,
    state: 'queued',
    createdAt: `2026-01-01T00:00:0${id.length}Z`,
    version: 1,
    file: { name: 'a.obj', bytes: 1 },
    params: {},
    progress: { stage: '', fraction: 0 },
    error: null,
    summary: null,
    sheets: [],
    cuts: [],
    priority: 0,
    actions: [],
    ...over,
  };
}

function cut(id: string, state: Cut['state'], createdAt: string): Cut {
  const progress = { linesTotal: 0, linesSent: 0, linesAcknowledged: 0, fraction: 0 };
  return {
    id, state, createdAt, progress, job: 'a', device: 'sim', sheets: [1], sheet: 1, programSha256: '', reason: '', beam: null, restOf: null,
    version: 0, actions: [],
  };
}

const device = (state: string): Device =>
  readDevice({ id: 'sim', name: 'Simulated laser', status: { state } }, '');

test('a snapshot replaces all that was known', () => {
  const before = reduceFeed(kEmptyFeed, { type: 'job', seq: 1, job: job('a') });
  const after = reduceFeed(before, { type: 'snapshot', seq: 2, jobs: [job('b')], cuts: [], devices: [] });
  assert.deepEqual([...after.jobs.keys()], ['b']);
  assert.equal(after.known, true);
});

test('an older version of a job never replaces a newer one', () => {
  const ready = reduceFeed(kEmptyFeed, { type: 'job', seq: 5, job: job('a', { version: 5, state: 'ready' }) });
  const late = reduceFeed(ready, { type: 'job', seq: 4, job: job('a', { version: 4, state: 'computing' }) });
  assert.equal(late.jobs.get('a')?.state, 'ready');
});

test('reducing leaves the feed it was given as it was', () => {
  reduceFeed(kEmptyFeed, { type: 'job', seq: 1, job: job('a') });
  assert.equal(kEmptyFeed.jobs.size, 0);
});

test('a removed job is gone', () => {
  const before = reduceFeed(kEmptyFeed, { type: 'job', seq: 1, job: job('a') });
  assert.equal(reduceFeed(before, { type: 'job-removed', seq: 2, id: 'a' }).jobs.size, 0);
});

test('jobs are listed newest first', () => {
  const jobs = new Map([job('a'), job('bbb'), job('cc')].map((one) => [one.id, one]));
  assert.deepEqual(newestFirst(jobs).map((one) => one.id), ['bbb', 'cc', 'a']);
});

test('a machine that changes its state puts its open cuts in doubt, an ended one not', () => {
  const cuts = [cut('c1', 'waiting', '1'), cut('c2', 'done', '2')];
  const feed = reduceFeed(kEmptyFeed, { type: 'snapshot', seq: 1, jobs: [], cuts, devices: [device('run')] });
  assert.deepEqual(doubtfulAfter(feed, { type: 'device', seq: null, device: device('idle') }).cuts, ['c1']);
  assert.deepEqual(doubtfulAfter(feed, { type: 'device', seq: null, device: device('run') }).cuts, []);
});

test('a cut that changes its state puts its job in doubt, progress does not', () => {
  const feed = reduceFeed(kEmptyFeed, { type: 'cut', seq: 1, cut: cut('c1', 'cutting', '1') });
  assert.deepEqual(doubtfulAfter(feed, { type: 'cut', seq: 2, cut: cut('c1', 'done', '1') }).jobs, ['a']);
  assert.deepEqual(doubtfulAfter(feed, { type: 'cut', seq: 2, cut: cut('c1', 'cutting', '1') }).jobs, []);
});

test('a running cut matters more than a later one that ended', () => {
  let feed = reduceFeed(kEmptyFeed, { type: 'cut', seq: 1, cut: cut('c1', 'cutting', '2026-01-01T00:00:01Z') });
  feed = reduceFeed(feed, { type: 'cut', seq: 2, cut: cut('c2', 'aborted', '2026-01-01T00:00:02Z') });
  assert.equal(currentCut(feed, 'a')?.id, 'c1');
  assert.equal(currentCut(feed, 'other'), null);
});
