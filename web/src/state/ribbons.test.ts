import assert from 'node:assert/strict';
import { test } from 'node:test';

import type { QuadMesh } from '../api/package_files.ts';
import { buildRibbons, heightAlong, quadNeighbours, vertexNormals } from './ribbons.ts';

// A flat n × n sheet in the xy plane, facing up; quads in rows along x.
function sheet(n: number): QuadMesh {
  const positions: number[] = [];
  const corners: number[] = [];
  for (let j = 0; j <= n; j += 1) for (let i = 0; i <= n; i += 1) positions.push(i, j, 0);
  for (let j = 0; j < n; j += 1) {
    for (let i = 0; i < n; i += 1) {
      const a = j * (n + 1) + i;
      corners.push(a, a + 1, a + n + 2, a + n + 1);
    }
  }
  return { positions: Float64Array.from(positions), corners: Uint32Array.from(corners), quadCount: n * n, cylinders: new Uint32Array(n * n) };
}

const checker = (n: number): Uint8Array => Uint8Array.from({ length: n * n }, (_, q) => ((q % n) + Math.floor(q / n)) % 2);

test('neighbours are mutual, and missing at the rim', () => {
  const neighbours = quadNeighbours(sheet(3));
  assert.deepEqual([...neighbours.slice(0, 4)], [-1, 1, 3, -1]);
  assert.deepEqual([...neighbours.slice(16, 20)], [1, 5, 7, 3]);
});

test('normals of a flat sheet point up', () => {
  const normals = vertexNormals(sheet(2));
  for (let v = 0; v < 9; v += 1) assert.deepEqual([...normals.slice(3 * v, 3 * v + 3)], [0, 0, 1]);
});

test('weft and warp lie on opposite sides in the middle of every cell', () => {
  const mesh = sheet(3);
  const middle = (family: 'weft' | 'warp', quad: number): number => {
    const { positions } = buildRibbons(mesh, checker(3), family, { steps: 4, lift: 0.085 });
    return positions[3 * (quad * 10 + 4) + 2] ?? 0;
  };
  for (let q = 0; q < 9; q += 1) {
    const warpUp = checker(3)[q] === 1;
    assert.ok(Math.abs(middle('warp', q) - (warpUp ? 0.085 : -0.085)) < 1e-6);
    assert.ok(Math.abs(middle('weft', q) + middle('warp', q)) < 1e-6);
  }
});

test('a ribbon is continuous from cell to cell, in height and tangent', () => {
  const [end, endSlope] = heightAlong(1, 1, -1, 1);
  const [start, startSlope] = heightAlong(0, -1, 1, -1);
  assert.ok(Math.abs(end - start) < 1e-12);
  assert.ok(Math.abs(endSlope - startSlope) < 1e-12);
});

test('a strip that floats over two cells stays level between them', () => {
  assert.deepEqual(heightAlong(1, -1, 1, 1), [1, 0]);
});

test('all triangles of both families face as the quads do', () => {
  for (const family of ['weft', 'warp'] as const) {
    const { positions, normals, indices } = buildRibbons(sheet(2), checker(2), family);
    for (let t = 0; t < indices.length; t += 3) {
      const [p, q, r] = [0, 1, 2].map((k) => 3 * (indices[t + k] ?? 0)) as [number, number, number];
      const x = (at: number): number => positions[at] ?? 0;
      const area = (x(q) - x(p)) * (x(r + 1) - x(p + 1)) - (x(q + 1) - x(p + 1)) * (x(r) - x(p));
      assert.ok(area > 0, `${family} triangle ${t / 3}`);
      assert.ok((normals[p + 2] ?? 0) > 0.5);
    }
  }
});

test('each quad owns one run of triangles', () => {
  const { indices, indicesPerQuad } = buildRibbons(sheet(2), checker(2), 'weft', { steps: 3 });
  assert.equal(indices.length, 4 * indicesPerQuad);
  const second = indices.slice(indicesPerQuad, 2 * indicesPerQuad);
  assert.ok(second.every((vertex) => vertex >= 8 && vertex < 16));
});
