import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readQuads } from '../api/package_files.ts';
import { cylinderColours, heatColour, heatColours, heatMap, kHeatStops, quantile, readQuality } from './heat.ts';

const mesh = readQuads('v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\ng cylinder_0\nf 1 2 3 4\ng cylinder_3\nf 2 5 6 3\n');
const quality = readQuality(
  {
    per_quad: { distance_percent: [1, 3], area_percent: [-2, 4], planarity_percent: [0, 0] },
    per_vertex: { angle_deviation_deg: [1, 2, 3, 4, null, 6] },
  },
  '',
);

test('a quad has one figure, a vertex another', () => {
  assert.deepEqual([...heatMap(mesh, quality, 'distance').corners], [1, 1, 1, 1, 3, 3, 3, 3]);
  assert.deepEqual([...heatMap(mesh, quality, 'angle').corners], [1, 2, 3, 4, 2, Number.NaN, 6, 3]);
  assert.equal(heatMap(mesh, quality, 'area').largest, 4);
});

test('colours rise from the first stop to the last; what is unknown is grey', () => {
  assert.deepEqual(heatColour(0), kHeatStops[0]);
  heatColour(7).forEach((value, k) => assert.ok(Math.abs(value - (kHeatStops.at(-1)?.[k] ?? 0)) < 1e-9));
  assert.deepEqual(heatColour(Number.NaN), [0.6, 0.6, 0.6]);
  assert.equal(heatColours(heatMap(mesh, quality, 'planarity')).length, 24);
});

test('a quantile leaves outliers out', () => {
  assert.equal(quantile(Float32Array.from([...Array.from({ length: 99 }, () => 1), 100]), 0.98), 1);
  assert.equal(quantile(new Float32Array(), 0.5), 0);
});

test('cylinders have colours of their own', () => {
  const colours = cylinderColours(mesh);
  assert.notDeepEqual(colours.slice(0, 3), colours.slice(12, 15));
  assert.deepEqual(colours.slice(0, 3), colours.slice(9, 12));
});
