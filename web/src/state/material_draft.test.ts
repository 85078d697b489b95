import assert from 'node:assert/strict';
import { test } from 'node:test';

import { materialFault, materialFields, materialRecord } from './material_draft.ts';

const wire = {
  id: 'oak', origin: 'own', name: 'Oak', colour: '#b98a56', thickness_mm: 0.6, weight_g_per_m2: 420, kerf_mm: 0.18, grain_deg: 90,
  sheets: [{ width_mm: 500, height_mm: 300, price: 4 }, { width_mm: 250, height_mm: 300 }],
  cut: { power_percent: 70, feed_mm_per_min: 900, passes: 2 },
  score: { power_percent: 20, feed_mm_per_min: 2000, passes: 1 },
  engrave: { power_percent: 10, feed_mm_per_min: 3000, passes: 1 },
};

test('a material that nobody touched is saved as it was', () => {
  const { id, origin, ...rest } = wire;
  assert.deepEqual(materialRecord(materialFields(wire), wire), rest);
});

test('a new one has values that can be saved once it has a name', () => {
  const fresh = materialFields({});
  assert.equal(materialFault(fresh), 'name');
  assert.equal(materialFault({ ...fresh, name: 'Felt' }), null);
});

test('what is out of range is named', () => {
  const draft = materialFields(wire);
  assert.equal(materialFault({ ...draft, thickness: '0' }), 'thickness');
  assert.equal(materialFault({ ...draft, kerf: '-0,1' }), 'kerf');
  assert.equal(materialFault({ ...draft, beam: { ...draft.beam, cut: { ...draft.beam.cut, passes: '1,5' } } }), 'cut.passes');
});
