import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readAssembly } from '../api/assembly_file.ts';
import { crossingRuns, idRanges, kAtTheStart, laidBefore, planSteps, readProgress, reduceGuide } from './assembly.ts';

const lay = (strip: string, region = 0, crossings: unknown[] = []) => ({ kind: 'lay', region, strip, pieces: [`${strip}.1`], crossings });
const joint = (strip: string, more: object = {}) => ({
  kind: 'join', region: 0, strip, piece: `${strip}.1`, onto: `${strip}.2`, end: 'end', where: 'in-place', crossing: 0, tucked: 0, ...more,
});

const given = readAssembly(
  {
    regions: [{ cylinders: [0], part: 0, base: 'warp' }],
    moves: [
      joint('P1', { where: 'table' }),
      lay('P1'),
      lay('P2'),
      lay('W1', 0, [[0, 'P1', 'over'], [1, 'P2', 'under']]),
      joint('W1', { kind: 'close', onto: 'W1.1' }),
      lay('W2', 0, [[2, 'P1', 'under'], [3, 'P2', 'threaded']]),
      joint('P1'),
      lay('P7', 1),
    ],
  },
  '',
);

test('every move is in one step, in an order that hands can follow', () => {
  const steps = planSteps(given);
  assert.deepEqual(steps.map(({ kind, strips }) => [kind, ...strips]), [
    ['table', 'P1'], ['base', 'P1', 'P2'], ['weave', 'W1'], ['weave', 'W2'], ['joints', 'P1'], ['base', 'P7'],
  ]);
  assert.equal(steps.reduce((sum, step) => sum + step.lays.length + step.joints.length, 0), given.moves.length);
  assert.equal(steps[2]?.joints[0]?.kind, 'close');
});

test('what lies before a step is all that was laid', () => {
  assert.deepEqual([...laidBefore(planSteps(given), 3)], ['P1', 'P2', 'W1']);
});

test('ids in a row are said as a range', () => {
  assert.equal(idRanges(['P3', 'P4', 'P5', 'P1', 'P2']), 'P3–P5, P1, P2');
  assert.equal(idRanges(['W9', 'W8', 'W7', 'P6']), 'W9–W7, P6');
  assert.equal(idRanges([]), '');
});

test('crossings the same way make one run', () => {
  const runs = crossingRuns([
    { quad: 0, strip: 'P1', way: 'over' },
    { quad: 1, strip: 'P2', way: 'over' },
    { quad: 2, strip: 'P3', way: 'under' },
  ]);
  assert.deepEqual(runs, [{ way: 'over', strips: ['P1', 'P2'] }, { way: 'under', strips: ['P3'] }]);
});

test('progress survives a round trip and nonsense', () => {
  const later = reduceGuide(reduceGuide(kAtTheStart, { type: 'next' }, 6), { type: 'part', id: 'P1.1' }, 6);
  assert.deepEqual(readProgress(JSON.stringify(later), 6), { step: 1, crossing: 0, parts: ['P1.1'] });
  assert.equal(readProgress('{"step":99}', 6).step, 6);
  assert.deepEqual(readProgress('no json', 6), kAtTheStart);
  assert.equal(reduceGuide({ ...kAtTheStart, step: 6 }, { type: 'next' }, 6).step, 6);
});
