import assert from 'node:assert/strict';
import { test } from 'node:test';

import { evennessOf, reportFigures, sortedAlternatives } from './report.ts';

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

test('singular points are counted by their prongs, holes by their size', () => {
  const { foliation } = reportFigures({
    topology: { components: 2 },
    surface: { removed_area_percent: 1.5 },
    foliation: {
      mode: 'pants',
      cylinders: [{}, {}, {}],
      singularities: [{ prongs: 3 }, { prongs: 1 }, { prongs: 3 }],
      punctures: [{ vertex: 7, radius_mm: 2.5 }],
      cell_spread: { variation: 0.5, largest_edge: 3.4 },
      alternatives: [{ name: 'sphere-polar', cell_spread: { variation: 9, largest_edge: 80 }, removed_area_percent: 0.2, chosen: false }],
    },
  });
  assert.deepEqual(foliation, {
    mode: 'pants',
    cylinders: 3,
    points: [{ prongs: 1, count: 1 }, { prongs: 3, count: 2 }],
    holeRadiiMm: [2.5],
    removedPercent: 1.5,
    largest: 3.4,
    parts: 2,
    alternatives: [{ name: 'sphere-polar', largest: 80, variation: 9, removedPercent: 0.2, chosen: false }],
  });
});

test('a report without a foliation has no figures of one', () => {
  assert.equal(reportFigures({}).foliation, null);
});

test('cells are called coarse only where they are far larger than the mean', () => {
  assert.deepEqual([1, 3.4, 40].map(evennessOf), ['even', 'uneven', 'coarse']);
});

test('the chosen layout comes first, ways to cut the same surface apart', () => {
  const one = (name: string, largest: number, chosen = false) => ({ name, largest, variation: 1, removedPercent: 0, chosen });
  const { first, rest } = sortedAlternatives([
    one('sphere-pillowcase', 9),
    one('pants with 5 holes: pants reeb-x, equal weights', 2),
    one('pants with 4 holes', 5),
    one('pants with 5 holes', 6, true),
  ]);
  assert.deepEqual(first.map(({ name }) => name), ['pants with 5 holes', 'pants with 4 holes', 'sphere-pillowcase']);
  assert.deepEqual(rest.map(({ name }) => name), ['pants with 5 holes: pants reeb-x, equal weights']);
});
