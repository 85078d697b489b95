import assert from 'node:assert/strict';
import { test } from 'node:test';

import { fieldFault, kFields, kGroups, moreFault, moreOf, moreParams, standardText } from './params.ts';

test('what nobody touched is not sent', () => {
  const all = Object.fromEntries(kGroups.flatMap((group) => kFields[group].map((spec) => [spec.path, standardText(spec)])));
  assert.deepEqual(moreParams(all), {});
  assert.equal(moreFault(all), null);
});

test('parameters survive the way into the form and out of it', () => {
  const params = {
    grid: { rows: 12, planar: 'gentle', even_cells: true },
    fit: { joint: 'slot', clearance_mm: 0.35, crimp: false },
    nesting: { rotation: '0,90,180,270' },
    weave: { max_float: 3 },
  };
  assert.deepEqual(moreParams(moreOf(params)), params);
});

test('numbers out of range and words are refused, points and commas taken', () => {
  assert.equal(moreFault({ 'cut.tabs': '1.5' }), 'cut.tabs');
  assert.equal(moreFault({ 'nesting.time_s': 'long' }), 'nesting.time_s');
  assert.equal(moreFault({ 'fit.tab_mm': '7,5' }), null);
  assert.deepEqual(moreParams({ 'fit.tab_mm': '7,5' }), { fit: { tab_mm: 7.5 } });
  const spec = kFields.cut[1];
  assert.ok(spec !== undefined && !fieldFault(spec, ''));
});
