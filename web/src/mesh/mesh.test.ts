import assert from 'node:assert/strict';
import { test } from 'node:test';

import { lookAt } from './look.ts';
import { readMesh } from './read.ts';

const bytes = (text: string): ArrayBuffer => new TextEncoder().encode(text).buffer as ArrayBuffer;
const kCorners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] as const;
const kFaces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] as const;
const lines = (rows: readonly (readonly number[])[]): string => rows.map((row) => row.join(' ')).join('\n');

const obj = `v ${kCorners.map((at) => at.join(' ')).join('\nv ')}\nf ${kFaces.map((f) => f.map((v) => `${v + 1}/1/1`).join(' ')).join('\nf ')}\n`;
const off = `OFF # a comment\n4 4 6\n${lines(kCorners)}\n${lines(kFaces.map((f) => [3, ...f, 255, 0, 0]))}\n`;
const ply = `ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n${lines(kCorners)}\n${lines(kFaces.map((f) => [3, ...f]))}\n`;
const stl = `solid t\n${kFaces.map((f) => `facet normal 0 0 0\nouter loop\n${f.map((v) => `vertex ${kCorners[v]?.join(' ')}`).join('\n')}\nendloop\nendfacet`).join('\n')}\nendsolid t\n`;

function binaryStl(): ArrayBuffer {
  const view = new DataView(new ArrayBuffer(84 + 50 * kFaces.length));
  view.setUint32(80, kFaces.length, true);
  kFaces.forEach((face, f) =>
    face.forEach((v, k) => kCorners[v]?.forEach((value, axis) => view.setFloat32(84 + 50 * f + 12 + 12 * k + 4 * axis, value, true))),
  );
  return view.buffer;
}

function binaryPly(little: boolean): ArrayBuffer {
  const head = ply.slice(0, ply.indexOf('end_header')).replace('ascii', little ? 'binary_little_endian' : 'binary_big_endian');
  const start = new TextEncoder().encode(`${head}end_header\n`);
  const all = new Uint8Array(start.length + 4 * 12 + 4 * 13);
  all.set(start);
  const view = new DataView(all.buffer);
  let at = start.length;
  for (const value of kCorners.flat()) view.setFloat32((at += 4) - 4, value, little);
  for (const face of kFaces) {
    view.setUint8(at++, 3);
    for (const v of face) view.setInt32((at += 4) - 4, v, little);
  }
  return all.buffer;
}

test('a tetrahedron is one in every format', () => {
  const files: readonly (readonly [string, ArrayBuffer])[] = [
    ['a.obj', bytes(obj)], ['a.OFF', bytes(off)], ['a.ply', bytes(ply)], ['a.stl', bytes(stl)],
    ['b.stl', binaryStl()], ['le.ply', binaryPly(true)], ['be.ply', binaryPly(false)],
  ];
  for (const [name, file] of files) {
    const { look } = lookAt(readMesh(name, file));
    const { vertices, faces, components, boundaryLoops, genus, euler, sizeMm } = look;
    assert.deepEqual({ vertices, faces, components, boundaryLoops, genus, euler }, { vertices: 4, faces: 4, components: 1, boundaryLoops: 0, genus: 0, euler: 2 }, name);
    assert.deepEqual(sizeMm, [1, 1, 1], name);
    assert.ok(Math.abs(look.area - (1.5 + Math.sqrt(3) / 2)) < 1e-6, name);
  }
});

function torus(columns: number, rows: number, skip = 0): string {
  const vertex = (i: number, j: number): number => (i % columns) * rows + (j % rows) + 1;
  let text = '';
  for (let i = 0; i < columns; i += 1) {
    for (let j = 0; j < rows; j += 1) {
      const [u, v] = [(2 * Math.PI * i) / columns, (2 * Math.PI * j) / rows];
      text += `v ${(3 + Math.cos(v)) * Math.cos(u)} ${(3 + Math.cos(v)) * Math.sin(u)} ${Math.sin(v)}\n`;
    }
  }
  for (let k = skip; k < columns * rows; k += 1) {
    const [i, j] = [Math.floor(k / rows), k % rows];
    text += `f ${vertex(i, j)} ${vertex(i + 1, j)} ${vertex(i + 1, j + 1)} ${vertex(i, j + 1)}\n`;
  }
  return text;
}

test('a torus has genus 1, with a face left out a boundary too', () => {
  assert.equal(lookAt(readMesh('t.obj', bytes(torus(9, 7)))).look.genus, 1);
  const { look, welded } = lookAt(readMesh('t.obj', bytes(torus(9, 7, 1))));
  assert.deepEqual([look.genus, look.boundaryLoops], [1, 1]);
  assert.equal(welded.loops[0]?.length, 4);
});

test('defects are counted', () => {
  const bad = `${obj}v 5 5 5\nv 0 0 0\nf 1 1 2\nf 2 1 3\nf 2 3 4\n`;
  const { defects } = lookAt(readMesh('bad.obj', bytes(bad))).look;
  assert.equal(defects.duplicateVertices, 1);
  assert.equal(defects.unusedVertices, 1);
  assert.equal(defects.degenerateFaces, 1);
  assert.ok(defects.nonManifoldEdges > 0);
});

test('vertices keep their numbers of the file', () => {
  const { welded } = lookAt(readMesh('a.stl', bytes(stl)));
  assert.deepEqual([...welded.fileVertex], [0, 1, 2, 5]);
});

test('what is no mesh says where', () => {
  for (const [name, text] of [['a.obj', 'v 0 0 0\nf 1 2 3\n'], ['a.off', 'OFF\n9 9'], ['a.ply', 'ply\n'], ['a.step', 'x'], ['a.obj', '']] as const) {
    assert.throws(() => readMesh(name, bytes(text)), { name: 'MeshFault' }, name);
  }
});
