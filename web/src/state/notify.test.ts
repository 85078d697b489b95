import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readCut, readJob } from '../api/payloads.ts';
import { kEmptyFeed, reduceFeed } from './feed.ts';
import { newsOf } from './notify.ts';

const job = (state: string) => readJob({ id: 'j1', name: 'Vase', state, created_at: '2026-01-01T00:00:00Z' }, '');
const cut = (state: string) => readCut({ id: 'c1', job: 'j1', device: 'd', sheets: [1], state }, '');

test('a job that becomes ready is news, once', () => {
  const before = reduceFeed(kEmptyFeed, { type: 'job', seq: 1, job: job('computing') });
  const event = { type: 'job', seq: 2, job: job('ready') } as const;
  assert.match(newsOf(before, event) ?? '', /Vase/);
  assert.equal(newsOf(reduceFeed(before, event), event), null);
  assert.equal(newsOf(kEmptyFeed, event), null);
});

test('a cut that needs hands is news', () => {
  const known = reduceFeed(kEmptyFeed, { type: 'job', seq: 1, job: job('ready') });
  const before = reduceFeed(known, { type: 'cut', seq: 2, cut: cut('cutting') });
  for (const state of ['awaiting-sheet', 'interrupted', 'done']) {
    assert.match(newsOf(before, { type: 'cut', seq: 3, cut: cut(state) }) ?? '', /Vase/, state);
  }
  assert.equal(newsOf(before, { type: 'cut', seq: 3, cut: cut('paused') }), null);
});
