import assert from 'node:assert/strict';
import { test } from 'node:test';

import { parseProgram } from '../lib/gcode.ts';
import { burnPath, burntSoFar, movesDone, planBurn } from './burn.ts';

const program = parseProgram('; head\nG21 G90\nM4 S0\nG0 X1 Y1\nG1 X2 S500\nG1 Y2\nG0 X0 Y0\nM5');
const progress = (linesAcknowledged: number, linesTotal: number) => ({
  linesTotal,
  linesAcknowledged,
  linesSent: linesAcknowledged,
  fraction: 0,
});

test('an acknowledged line counts among sent lines or file lines, as the total says', () => {
  assert.equal(movesDone(program, progress(4, 7)), 2);
  assert.equal(movesDone(program, progress(4, 8)), 1);
  assert.equal(movesDone(program, progress(0, 7)), 0);
  assert.equal(movesDone(program, progress(7, 7)), 4);
});

test('a total that fits neither count is scaled', () => {
  assert.equal(movesDone(program, progress(14, 14)), 4);
});

test('moves that follow each other are one stroke, dark moves are not drawn', () => {
  assert.equal(burnPath(program.moves), 'M1.00 1.00L2.00 1.00L2.00 2.00');
});

test('what is burnt in pieces is what the whole program burns', () => {
  const many = ['G21 G90', 'M4 S0', 'G0 X0 Y0'];
  for (let i = 1; i <= 1000; i += 1) many.push(`G1 X${i} Y${i % 7} S100`);
  const plan = planBurn(parseProgram(many.join('\n')));
  const burnt = burntSoFar(plan, progress(1003, 1003));
  const drawn = [...burnt.chunks, burnt.growing].join('');
  for (let i = 1; i <= 1000; i += 1) assert.ok(drawn.includes(`${i}.00 ${i % 7}.00`));
  assert.deepEqual(burnt.beam, [1000, 1000 % 7]);
  assert.equal(burntSoFar(plan, progress(0, 1003)).beam, null);
});
