import assert from 'node:assert/strict';
import { test } from 'node:test';

import { formatRoute, kPlainPages, parseRoute, type Route, sectionOf } from './route.ts';

test('every address leads back to its page', () => {
  const routes: readonly Route[] = [
    ...kPlainPages.map((page): Route => ({ page })),
    { page: 'job', id: 'a/b' },
    { page: 'guide', id: 'j 1' },
    { page: 'compare', id: 'j1', other: 'j2' },
  ];
  for (const route of routes) assert.deepEqual(parseRoute(formatRoute(route)), route);
});

test('an unknown address is the first page', () => {
  for (const hash of ['', '#', '#/nowhere', '#/%E0%A4%A']) assert.deepEqual(parseRoute(hash), { page: 'jobs' });
});

test('a page lights up its section', () => {
  assert.equal(sectionOf({ page: 'stock' }), 'materials');
  assert.equal(sectionOf({ page: 'audit' }), 'settings');
  assert.equal(sectionOf({ page: 'guide', id: 'x' }), 'jobs');
});
