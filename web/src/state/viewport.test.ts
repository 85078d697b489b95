import assert from 'node:assert/strict';
import { test } from 'node:test';

import { centre, fit, panBy, zoomAt } from './viewport.ts';

const sheet = { x: 0, y: 0, width: 600, height: 400 };

test('zooming keeps the point under the pointer', () => {
  const view = fit(sheet);
  const at = { x: 150, y: 100 };
  const closer = zoomAt(view, sheet, at, 4);
  const place = (box: typeof view): number => (at.x - box.x) / box.width;
  assert.ok(Math.abs(place(view) - place(closer)) < 1e-12);
  assert.ok(Math.abs(closer.width - view.width / 4) < 1e-9);
  assert.ok(Math.abs(closer.width / closer.height - view.width / view.height) < 1e-12);
});

test('zooming out ends with the whole sheet, zooming in has an end', () => {
  const view = fit(sheet);
  assert.deepEqual(zoomAt(zoomAt(view, sheet, { x: 10, y: 10 }, 5), sheet, { x: 500, y: 300 }, 0.01), view);
  assert.ok(zoomAt(view, sheet, centre(view), 1e6).width > 5);
});

test('the sheet cannot be panned out of sight', () => {
  const view = zoomAt(fit(sheet), sheet, { x: 300, y: 200 }, 4);
  const middle = centre(panBy(view, sheet, 1e5, -1e5));
  assert.ok(Math.abs(middle.x - 600) < 1e-9);
  assert.ok(Math.abs(middle.y) < 1e-9);
});
