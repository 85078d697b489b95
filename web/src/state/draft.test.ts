import assert from 'node:assert/strict';
import { test } from 'node:test';

import { draftFault, draftParams, kNewDraft, kRepeats, reduceDraft } from './draft.ts';
import { kNoPicks } from './picks.ts';

const file = (name: string): File => ({ name, size: 1 }) as File;

test('a dropped file is named after itself and can be renamed', () => {
  const two = reduceDraft(kNewDraft, { type: 'add', files: [file('kitten.obj'), file('torus.off')] });
  assert.deepEqual(two.files.map((entry) => entry.name), ['kitten', 'torus']);
  const renamed = reduceDraft(two, { type: 'rename', key: two.files[1]?.key ?? 0, name: 'Ring' });
  assert.deepEqual(renamed.files.map((entry) => entry.name), ['kitten', 'Ring']);
});

test('keys stay unique when files come and go', () => {
  const one = reduceDraft(kNewDraft, { type: 'add', files: [file('a.obj'), file('b.obj')] });
  const two = reduceDraft(reduceDraft(one, { type: 'drop', key: 1 }), { type: 'add', files: [file('c.obj')] });
  assert.equal(new Set(two.files.map((entry) => entry.key)).size, two.files.length);
});

test('a file that was refused comes back under the name it was given', () => {
  const one = reduceDraft(kNewDraft, { type: 'add', files: [file('a.obj')] });
  const named = reduceDraft(one, { type: 'rename', key: 1, name: 'Ring' });
  const later = reduceDraft(reduceDraft(named, { type: 'clear' }), { type: 'add', files: [file('b.obj')] });
  const back = reduceDraft(later, { type: 'put-back', files: named.files });
  assert.deepEqual(back.files.map(({ key, name }) => [key, name]), [[1, 'b'], [2, 'Ring']]);
});

test('clearing forgets the files and keeps the settings', () => {
  const set = reduceDraft(kNewDraft, { type: 'set', values: { stripWidthMm: '6' } });
  const cleared = reduceDraft(reduceDraft(set, { type: 'add', files: [file('a.obj')] }), { type: 'clear' });
  assert.deepEqual(cleared, set);
});

test('sizes must be positive numbers, and a strip narrower than a third of the shape', () => {
  const fault = (longestSideMm: string, stripWidthMm: string): string | null =>
    draftFault({ ...kNewDraft, longestSideMm, stripWidthMm });
  assert.equal(fault('300', '10'), null);
  assert.equal(fault('300', '7,5'), null);
  assert.equal(fault('', '10'), 'longest-side');
  assert.equal(fault('300', '-1'), 'strip-width');
  assert.equal(fault('30', '12'), 'strip-too-wide');
});

test('materials are only named when chosen', () => {
  assert.deepEqual(draftParams(kNewDraft), {
    scale: { longest_side_mm: 300 },
    grid: { strip_width_mm: 10, may_narrow: true },
    weave: { pattern: 'plain' },
  });
  assert.deepEqual(draftParams({ ...kNewDraft, warp: 'felt' })['material'], { warp: 'felt' });
});

test('only what differs from the own choice of the daemon is sent', () => {
  assert.equal(draftParams(kNewDraft)['foliation'], undefined);
  const chosen = { ...kNewDraft, mode: 'pants', sweep: 'z', punctures: 'none', components: 'largest' } as const;
  assert.deepEqual(draftParams(chosen)['foliation'], { mode: 'pants', function: 'z', punctures: 'none', components: 'largest' });
});

test('how pairs of pants are cut is not sent with a mode that has none: the daemon would refuse it', () => {
  const disk = { ...kNewDraft, mode: 'disk', pants: 'tunnel-loops', sweep: 'x' } as const;
  assert.deepEqual(draftParams(disk)['foliation'], { mode: 'disk' });
  assert.deepEqual(draftParams({ ...disk, mode: 'auto' })['foliation'], { pants: 'tunnel-loops', function: 'x' });
});

test('places count for one file alone, in the modes that have them', () => {
  const picks = { ...kNoPicks, places: '12, 1895' };
  assert.deepEqual(draftParams({ ...kNewDraft, picks })['foliation'], { singularities: [{ near: 12 }, { near: 1895 }] });
  assert.deepEqual(draftParams({ ...kNewDraft, picks, mode: 'torus' })['foliation'], { mode: 'torus' });
  const two = reduceDraft({ ...kNewDraft, picks }, { type: 'add', files: [file('a.obj'), file('b.obj')] });
  assert.equal(draftParams(two)['foliation'], undefined);
  const wrong = { ...kNewDraft, picks: { ...kNoPicks, places: 'top' } };
  assert.equal(draftFault(wrong), 'picks');
  assert.equal(draftFault({ ...wrong, mode: 'disk' }), null);
});

test('a job that is woven again begins with its own parameters', () => {
  const params = draftParams({ ...kNewDraft, mode: 'disk', pattern: 'satin-5', stripWidthMm: '7.5', units: 'mm', more: { 'fit.joint': 'slot' } });
  const again = reduceDraft(kNewDraft, { type: 'again', job: 'j1', name: 'Vase', file: 'vase.obj', params });
  assert.deepEqual(draftParams(again), params);
  assert.equal(again.again?.job, 'j1');
  assert.equal(reduceDraft(again, { type: 'clear' }).again, null);
});

test('every repeat is a full matrix in which both families come to the top', () => {
  for (const [pattern, rows] of Object.entries(kRepeats)) {
    const cells = rows.flat();
    assert.ok(rows.every((row) => row.length === rows[0]?.length), pattern);
    assert.ok(cells.includes(0) && cells.includes(1), pattern);
  }
});

test('sheets at hand and the machine it is made for are said, and read back', () => {
  const draft = { ...kNewDraft, sheets: 'only' as const, machine: 'big', more: { 'nesting.time_s': '3', 'output.dialect': 'marlin' } };
  const params = draftParams(draft);
  assert.deepEqual(params['nesting'], { time_s: 3, stock: 'store', only_stock: true });
  assert.deepEqual(params['output'], { dialect: 'marlin', device: 'big' });
  const again = reduceDraft(kNewDraft, { type: 'again', job: 'j1', name: 'Vase', file: 'vase.obj', params });
  assert.deepEqual([again.sheets, again.machine], ['only', 'big']);
  assert.deepEqual(draftParams(again), params);
  assert.equal('nesting' in draftParams(kNewDraft), false);
});
