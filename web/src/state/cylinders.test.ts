import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { QuadMesh } from '../api/package_files.ts';
import type { Welded } from '../mesh/look.ts';
import { cylinderOfTriangles, heightsIn, withHeight, wovenCylinders } from './cylinders.ts';

const kReport = {
  input: { scale: 10 },
  foliation: {
    mode: 'pants',
    weights: [20, 5],
    cylinders: [{ graph_edge: 1 }, { graph_edge: 0 }],
    alternatives: [
      { name: 'torus', chosen: false },
      { name: 'pants handle-loops-fiedler, equal weights', chosen: true },
    ],
  },
};

test('weights belong to the decomposition that was chosen', () => {
  const woven = wovenCylinders(kReport);
  assert.deepEqual(woven, { heights: [20, 5], edgeOf: [1, 0], pants: 'handle-loops', sweep: 'fiedler', scale: 10 });
});

test('a surface of one cylinder, or of none, has no weights to pick', () => {
  assert.equal(wovenCylinders({ ...kReport, foliation: { ...kReport.foliation, weights: [20] } }), null);
  assert.equal(wovenCylinders({ ...kReport, foliation: { ...kReport.foliation, mode: 'torus' } }), null);
  assert.equal(wovenCylinders({}), null);
});

// Unit squares side by side along x from `from`, all of one cylinder each.
function row(cylinders: readonly number[]): QuadMesh {
  const positions = cylinders.flatMap((_, k) => [k, 0, 0, k + 1, 0, 0, k + 1, 1, 0, k, 1, 0]);
  return {
    positions: Float64Array.from(positions),
    corners: Uint32Array.from(positions.slice(0, 4 * cylinders.length), (_, k) => k),
    quadCount: cylinders.length,
    cylinders: Uint32Array.from(cylinders),
  };
}

test('a triangle belongs to the cylinder of the nearest quad, in the scale of the mesh', () => {
  const triangleAt = (x: number) => [x, 0.02, 0, x + 0.02, 0.04, 0, x, 0.06, 0];
  const mesh: Welded = {
    positions: Float32Array.from([...triangleAt(0.04), ...triangleAt(0.24), ...triangleAt(5)]),
    triangles: Uint32Array.from({ length: 9 }, (_, k) => k),
    fileVertex: new Uint32Array(9),
    loops: [],
  };
  const woven = wovenCylinders(kReport);
  assert.ok(woven);
  assert.deepEqual([...cylinderOfTriangles(mesh, row([0, 0, 1]), woven)], [1, 0, 0]);
});

test('typed heights count where there are as many as cylinders', () => {
  const woven = wovenCylinders(kReport);
  assert.ok(woven);
  assert.deepEqual(heightsIn('3, 4', woven), [3, 4]);
  for (const typed of ['', '3', '3, 0', '3, x', '1 2 3']) assert.deepEqual(heightsIn(typed, woven), [20, 5], typed);
  assert.equal(withHeight('', woven, 1, 7.12345), '20, 7.12');
  assert.equal(withHeight('3, 4', woven, 0, 6), '6, 4');
});

test('a surface with holes at its tips was cut in the best of its ways', () => {
  const named = (name: string, chosen = false) => ({ name, chosen });
  const holed = 'pants with 5 holes';
  const alternatives = [named('disk'), named(holed, true), named(`${holed}: pants reeb-z, equal weights`), named(`${holed}: pants reeb-x, equal weights`)];
  assert.equal(wovenCylinders({ ...kReport, foliation: { ...kReport.foliation, alternatives } })?.sweep, 'z');
});
