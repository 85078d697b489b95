import assert from 'node:assert/strict';
import { test } from 'node:test';

import { parseProgram } from './gcode.ts';

const program = [
  '; job torus, sheet 1',
  'G21 G90',
  'M4 S0',
  'G0 X10 Y5',
  'G1 X20 S400 F1200',
  'Y15',
  '',
  'G0 X0 Y0',
  'M5 S0',
].join('\n');

test('a move burns only in G1 with the laser on and power above zero', () => {
  const moves = parseProgram(program).moves;
  assert.deepEqual(moves.map((move) => move.burns), [false, true, true, false]);
});

test('motion words are modal: a bare coordinate goes on with the last motion', () => {
  assert.deepEqual(parseProgram(program).moves[2]?.points, [[20, 5], [20, 15]]);
});

test('file lines and sent lines are counted apart', () => {
  const { lines, sentLines, moves } = parseProgram(program);
  assert.equal(lines, 9);
  assert.equal(sentLines, 7);
  assert.equal(moves.at(-1)?.line, 8);
  assert.equal(moves.at(-1)?.sent, 6);
});

test('a closing line end is not a line of its own', () => {
  assert.equal(parseProgram('G0 X1\n').lines, 1);
});

test('relative inches become absolute millimetres', () => {
  const moves = parseProgram('G20 G91\nG0 X1\nG0 X1 Y-1').moves;
  assert.deepEqual(moves[1]?.points, [[25.4, 0], [50.8, -25.4]]);
});

test('an arc stays on its circle, turns the way it says and ends where it says', () => {
  const moves = parseProgram('M4 S1\nG0 X10 Y0\nG3 X0 Y10 I-10 J0').moves;
  const points = moves[1]?.points ?? [];
  assert.ok(points.length > 8);
  for (const [x, y] of points) {
    assert.ok(Math.abs(Math.hypot(x, y) - 10) < 1e-9);
    assert.ok(x >= -1e-9 && y >= -1e-9);
  }
  assert.deepEqual(points.at(-1), [0, 10]);
});

test('a full circle is drawn when an arc ends where it began', () => {
  const points = parseProgram('M4 S1\nG0 X10 Y0\nG2 X10 Y0 I-10 J0').moves[1]?.points ?? [];
  assert.ok(points.some(([x]) => x < -9.9));
});
