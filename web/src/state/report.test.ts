import assert from 'node:assert/strict';
import { test } from 'node:test';

import { reportFigures } from './report.ts';

test('figures that a report does not carry are left out, not shown as zero', () => {
  const { quality, facts } = reportFigures({
    quality: { overall: { angle_deviation_deg: { max: 12, avg: 2.5 }, area_distortion_percent: { avg: 0.4 } } },
    topology: { genus: 1, boundary_loops: 0 },
  });
  assert.deepEqual(quality.map((row) => row.name), ['angle_deviation_deg', 'area_distortion_percent']);
  assert.equal(quality[1]?.largest, null);
  assert.equal(facts.genus, 1);
  assert.equal(facts.densityPercent, null);
});

test('the total time is given or the sum of the stages', () => {
  assert.equal(reportFigures({ timings_s: { read: 0.5, nest: 2 } }).facts.totalS, 2.5);
  assert.equal(reportFigures({ timings_s: { read: 0.5, total: 3 } }).facts.totalS, 3);
});

test('a report of the wrong shape gives no figures and no fault', () => {
  assert.deepEqual(reportFigures({ quality: 'good', timings_s: null }).quality, []);
});
