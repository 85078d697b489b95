import assert from 'node:assert/strict';
import { test } from 'node:test';

import { readFleet } from './fleet.ts';

test('a daemon alone has no nodes', () => {
  assert.deepEqual(readFleet({ alone: true, node: null, nodes: [] }, ''), { alone: true, node: '', nodes: [] });
});

test('a node needs a name, a role and a state, nothing else', () => {
  const { nodes } = readFleet({ alone: false, node: 'n1', nodes: [{ id: 'n1', role: 'station', state: 'drained' }] }, '');
  assert.deepEqual(nodes[0]?.machines, []);
  assert.equal(nodes[0]?.state, 'drained');
  assert.throws(() => readFleet({ alone: false, node: 'n1', nodes: [{ id: 'n1' }] }, ''));
});
