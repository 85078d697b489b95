import assert from 'node:assert/strict';
import { test } from 'node:test';

import { draftFault, draftParams, kNewDraft, kRepeats, reduceDraft } from './draft.ts';

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

test('places of singular points are vertices, sent in the modes that have such points', () => {
  const wanted = { ...kNewDraft, near: ' 12, 1895' } as const;
  assert.deepEqual(draftParams(wanted)['foliation'], { singularities: [{ near: 12 }, { near: 1895 }] });
  assert.deepEqual(draftParams({ ...wanted, mode: 'torus' })['foliation'], { mode: 'torus' });
  for (const typed of ['top', '1.5', '-3', '7 7']) assert.equal(draftFault({ ...kNewDraft, near: typed }), 'near', typed);
  assert.equal(draftFault({ ...kNewDraft, mode: 'disk', near: 'top' }), null);
});

test('every repeat is a full matrix in which both families come to the top', () => {
  for (const [pattern, rows] of Object.entries(kRepeats)) {
    const cells = rows.flat();
    assert.ok(rows.every((row) => row.length === rows[0]?.length), pattern);
    assert.ok(cells.includes(0) && cells.includes(1), pattern);
  }
});
