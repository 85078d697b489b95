import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readCriticalGraph } from '../api/package_files.ts';
import { segmentsOf } from './critical.ts';

test('a line of three points is two segments, a single point none', () => {
  const segments = segmentsOf([[[0, 0, 0], [1, 0, 0], [1, 2, 0]], [[5, 5, 5]]]);
  assert.deepEqual([...segments], [0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 2, 0]);
});

test('leaves without a critical graph give nothing to draw', () => {
  assert.deepEqual(readCriticalGraph({ leaves: [] }, ''), { lines: [], points: [], leaves: { weft: [], warp: [] } });
});

test('a point that is no point is refused by its path', () => {
  const wrong = { critical_graph: [{ points: [[0, 0, 0], [1, 2]] }], singularities: [] };
  assert.throws(() => readCriticalGraph(wrong, 'leaves.json'), /critical_graph\/0\/points\/1/);
});

test('lines and singular points are read', () => {
  const graph = readCriticalGraph(
    { critical_graph: [{ points: [[0, 0, 0], [1, 2, 3]] }], singularities: [{ position: [4, 5, 6], prongs: 3 }] },
    '',
  );
  assert.deepEqual(graph.lines, [[[0, 0, 0], [1, 2, 3]]]);
  assert.deepEqual(graph.points, [[4, 5, 6]]);
});

test('a closed leaf ends where it begins', () => {
  const points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];
  const { leaves } = readCriticalGraph({ leaves: [{ family: 'warp', closed: true, points }] }, '');
  assert.deepEqual(leaves.warp[0], [...points, points[0]]);
  assert.deepEqual(leaves.weft, []);
});
