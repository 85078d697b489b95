import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readSolidModel } from './glb.ts';

// One triangle of 10 mm, as the package's writer lays it out.
function glb(change: (file: Record<string, unknown>) => void = () => {}): ArrayBuffer {
  const file = {
    asset: { version: '2.0' },
    nodes: [{ name: 'woven', children: [1] }, { name: 'W7', mesh: 0, extras: { family: 'weft' } }],
    materials: ['weft', 'warp'].map((name, k) => ({ name, pbrMetallicRoughness: { baseColorFactor: [k, 0.5, 0.25, 1] } })),
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3' },
      { bufferView: 1, componentType: 5123, count: 3, type: 'SCALAR' },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: 36 },
      { buffer: 0, byteOffset: 36, byteLength: 6 },
    ],
    buffers: [{ byteLength: 44 }],
  };
  change(file);
  const json = new TextEncoder().encode(JSON.stringify(file));
  const length = Math.ceil(json.length / 4) * 4;
  const buffer = new ArrayBuffer(12 + 8 + length + 8 + 44);
  const view = new DataView(buffer);
  [0x46546c67, 2, buffer.byteLength, length, 0x4e4f534a].forEach((word, k) => view.setUint32(4 * k, word, true));
  new Uint8Array(buffer).fill(0x20, 20, 20 + length).set(json, 20);
  const bytes = 20 + length;
  view.setUint32(bytes, 44, true);
  view.setUint32(bytes + 4, 0x004e4942, true);
  [0, 0, 0, 0.01, 0, 0, 0, 0.01, 0].forEach((value, k) => view.setFloat32(bytes + 8 + 4 * k, value, true));
  [0, 1, 2].forEach((value, k) => view.setUint16(bytes + 8 + 36 + 2 * k, value, true));
  return buffer;
}

test('a strip comes with its id, its family and millimetres', () => {
  const { strips, colours } = readSolidModel(glb());
  assert.equal(strips.length, 1);
  assert.deepEqual([strips[0]?.id, strips[0]?.family], ['W7', 'weft']);
  assert.deepEqual([...(strips[0]?.positions ?? [])].map(Math.round), [0, 0, 0, 10, 0, 0, 0, 10, 0]);
  assert.deepEqual([...(strips[0]?.indices ?? [])], [0, 1, 2]);
  assert.deepEqual(colours, { weft: [0, 0.5, 0.25], warp: [1, 0.5, 0.25] });
});

test('a file that is cut off is refused', () => {
  const whole = glb();
  for (const length of [0, 11, 19, 60, whole.byteLength - 4]) {
    assert.throws(() => readSolidModel(whole.slice(0, length)));
  }
});

test('an accessor that reaches behind the bytes is refused', () => {
  const wrong = glb((file) => ((file['accessors'] as { count: number }[])[1]!.count = 99));
  assert.throws(() => readSolidModel(wrong), /bytes are missing/);
});
