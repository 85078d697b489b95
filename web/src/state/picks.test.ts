import assert from 'node:assert/strict';
import { test } from 'node:test';

import { kNoPicks, picked, pickFault, pickParams, picksOf, toolsFor } from './picks.ts';

const click = (vertex: number, loop: number | null = null) => ({ vertex, loop, radiusMm: 5 });

test('a click adds, a second one takes away', () => {
  assert.equal(picked('places', '3', click(7)), '3, 7');
  assert.equal(picked('places', '3, 7', click(3)), '7');
  assert.equal(picked('corners', '1, 2, 3, 4', click(9)), '2, 3, 4, 9');
  assert.equal(picked('holes', '', click(4)), '4:5');
  assert.equal(picked('holes', '4:5', click(4)), '');
});

test('a loop is closed by its first vertex', () => {
  let loops = '';
  for (const vertex of [1, 2, 3, 1, 8]) loops = picked('loops', loops, click(vertex));
  assert.equal(loops, '1 2 3; 8');
});

test('boundaries are picked by their loop', () => {
  assert.equal(picked('sources', '', click(12, 0)), '0');
  assert.equal(picked('sinks', '1', click(12)), '1');
});

test('what is wrong is named, and only where it counts', () => {
  const picks = { ...kNoPicks, corners: '1, 2' };
  assert.equal(pickFault(picks, 'disk', 'reeb'), 'corners');
  assert.equal(pickFault(picks, 'auto', 'reeb'), null);
  assert.equal(pickFault({ ...kNoPicks, loops: '1 2' }, 'pants', 'user'), 'loops');
  assert.ok(!toolsFor('torus', 'reeb').includes('places'));
});

test('picks survive the way to parameters and back', () => {
  const picks = { ...kNoPicks, places: '12, 40', holes: '7:5, 9:2.5', loops: '1 2 3; 7 8 9', weights: '1, 2.5' };
  assert.deepEqual(picksOf(pickParams(picks, 'pants', 'user')), picks);
  const form = { ...kNoPicks, sources: '0', sinks: '1, 2' };
  assert.deepEqual(picksOf(pickParams(form, 'one-form', 'reeb')), form);
});
