import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readJob } from '../api/payloads.ts';
import { compareRows, differingParams } from './compare.ts';
import { reportFigures } from './report.ts';

const result = (strips: number, seconds: number, angle: number, density: number) => ({
  job: readJob({ id: 'j', state: 'ready', created_at: '', summary: { quads: 1, strips, pieces: strips, sheets: 2, estimated_s: seconds } }, ''),
  figures: reportFigures({ quality: { overall: { angle_deviation_deg: { avg: angle, max: 2 * angle } } }, nesting: { density_percent: density } }),
});

test('less is better, but for how much of a sheet is used', () => {
  const rows = compareRows(result(40, 100, 4, 60), result(50, 80, 3, 50));
  const better = Object.fromEntries(rows.map(({ name, of, better: who }) => [`${name}/${of}`, who]));
  assert.equal(better['time/count'], 1);
  assert.equal(better['angle_deviation_deg/average'], 1);
  assert.equal(better['density/count'], 0);
  assert.equal(better['strips/count'], null);
  assert.equal(better['sheets/count'], null);
});

test('parameters that differ are told by their paths', () => {
  const rows = differingParams({ grid: { strip_width_mm: 10 }, weave: { pattern: 'plain' } }, { grid: { strip_width_mm: 8, rows: 3 }, weave: { pattern: 'plain' } });
  assert.deepEqual(rows, [['grid.rows', '', '3'], ['grid.strip_width_mm', '10', '8']]);
});
