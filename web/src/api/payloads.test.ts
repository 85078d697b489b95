import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readQuads, readWeave } from './package_files.ts';
import { readCut, readDevice, readEvent, readJob } from './payloads.ts';
import { problemFrom } from './problem.ts';

const job = { id: 'j_1', name: 'Torus', state: 'computing', created_at: '2026-01-01T00:00:00Z' };

test('a job just made needs no summary, error or sheets', () => {
  const read = readJob({ ...job, error: null, summary: null, progress: { stage: 'foliation', fraction: 0.4 } }, '');
  assert.equal(read.progress.stage, 'foliation');
  assert.equal(read.summary, null);
  assert.deepEqual(read.sheets, []);
});

test('a fault names the path of the field', () => {
  assert.throws(() => readJob({ ...job, state: 'melted' }, ''), /\/state: expected queued or/);
  assert.throws(() => readJob({ ...job, sheets: [{ id: 1 }, { id: '2' }] }, ''), /\/sheets\/1\/id: expected a finite/);
});

test('a device without a name goes by its id', () => {
  assert.equal(readDevice({ id: 'sim', name: '', status: { state: 'idle' } }, '').name, 'sim');
});

test('a cut that has not begun stands at its first sheet', () => {
  const cut = readCut({ id: 'c_1', job: 'j_1', device: 'sim', sheets: [2, 3], state: 'waiting' }, '');
  assert.equal(cut.sheet, 2);
  assert.equal(cut.progress.fraction, 0);
});

test('events are told apart by their name, and unknown ones are passed over', () => {
  assert.equal(readEvent('job', { seq: 3, job })?.seq, 3);
  assert.equal(readEvent('snapshot', { seq: 9, jobs: [job], cuts: [], devices: [] })?.type, 'snapshot');
  assert.equal(readEvent('weather', {}), null);
  assert.deepEqual(readEvent('cut', { seq: 4, removed: 'c_1' }), { type: 'cut-removed', seq: 4, id: 'c_1' });
});

test('a problem keeps its detail and the fields at fault', () => {
  const body = JSON.stringify({
    title: 'Invalid parameters',
    status: 422,
    code: 'invalid-params',
    detail: 'grid.strip_width_mm: must be > 0',
    errors: [{ pointer: '/grid/strip_width_mm', detail: 'must be > 0' }],
  });
  const problem = problemFrom(422, body);
  assert.equal(problem.message, 'grid.strip_width_mm: must be > 0');
  assert.equal(problem.faults[0]?.pointer, '/grid/strip_width_mm');
});

test('an answer that is no problem document still says its status', () => {
  assert.equal(problemFrom(502, '<html>').message, 'HTTP 502');
});

test('quads are read with their order and corners, texture numbers ignored', () => {
  const mesh = readQuads('v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng cylinder_0\nf 1 2/1 3 4\n');
  assert.equal(mesh.quadCount, 1);
  assert.deepEqual([...mesh.corners], [0, 1, 2, 3]);
});

test('a face that is no quad, or names a missing vertex, is refused', () => {
  assert.throws(() => readQuads('v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3'), /a face of 3 corners/);
  assert.throws(() => readQuads('v 0 0 0\nf 1 1 1 2'), /no such vertex/);
  assert.throws(() => readQuads('v 0 x 0'), /no number/);
});

test('the weave is one or zero per quad', () => {
  assert.deepEqual([...readWeave({ warp_on_top: [1, 0, true] }, '')], [1, 0, 1]);
});
