import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { Material } from '../api/types.ts';
import { dialectOf, fitsBed } from './machine_choice.ts';

test('a machine is spoken to as its firmware says, or as its address does', () => {
  const of = (uri: string, firmware: string): string => dialectOf({ uri, status: { firmware } });
  assert.equal(of('serial:///dev/ttyUSB0', 'Marlin 2.1'), 'marlin');
  assert.equal(of('sim:marlin', 'Grbl 1.1h'), 'grbl');
  assert.equal(of('sim:smoothie', ''), 'smoothie');
  assert.equal(of('tcp://laser', ''), 'grbl');
});

test('a sheet must lie on the bed as it is drawn', () => {
  const material = (widthMm: number, heightMm: number) => ({ sheets: [{ widthMm, heightMm }] }) as unknown as Material;
  assert.equal(fitsBed({ bedMm: [600, 400] }, undefined), true);
  assert.equal(fitsBed({ bedMm: [400, 400] }, undefined), false);
  assert.equal(fitsBed({ bedMm: [400, 600] }, material(600, 400)), false);
  assert.equal(fitsBed({ bedMm: [] }, material(5000, 5000)), true);
});
