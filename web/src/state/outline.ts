// The outline of a sheet or remnant while it is drawn: corners in mm, in order, y up. Every change makes a new one.

import type { Point } from '../api/package_files.ts';

export type Outline = readonly Point[];

export const kFewest = 3; // Corners of an outline.

export function rectangle(width: number, height: number): Outline {
  return [[0, 0], [width, 0], [width, height], [0, height]];
}

const whole = (value: number, size: number): number => Math.round(Math.min(size, Math.max(0, value)));

// Corner `index` at `to`, on whole millimetres of the sheet that the outline lies on.
export function moveCorner(outline: Outline, index: number, to: Point, sheet: Point): Outline {
  const at: Point = [whole(to[0], sheet[0]), whole(to[1], sheet[1])];
  return outline.map((corner, k) => (k === index ? at : corner));
}

export function middle(outline: Outline, index: number): Point {
  const [from, to] = [outline[index] ?? [0, 0], outline[(index + 1) % outline.length] ?? [0, 0]];
  return [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
}

// With one more corner in the middle of the side after corner `index`.
export function splitSide(outline: Outline, index: number): Outline {
  const [x, y] = middle(outline, index);
  return [...outline.slice(0, index + 1), [Math.round(x), Math.round(y)], ...outline.slice(index + 1)];
}

export function dropCorner(outline: Outline, index: number): Outline {
  return outline.length <= kFewest ? outline : outline.filter((_, k) => k !== index);
}

// Twice the area to the left of `from` → `to` → `at`.
function turn(from: Point, to: Point, at: Point): number {
  return (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0]);
}

export function areaMm2(outline: Outline): number {
  const [first = [0, 0]] = outline;
  const parts = outline.map((corner, k) => turn(first, corner, outline[(k + 1) % outline.length] ?? first));
  return Math.abs(parts.reduce((sum, part) => sum + part, 0)) / 2;
}

function isBetween(from: Point, to: Point, at: Point): boolean {
  const within = (axis: 0 | 1): boolean => at[axis] >= Math.min(from[axis], to[axis]) && at[axis] <= Math.max(from[axis], to[axis]);
  return turn(from, to, at) === 0 && within(0) && within(1);
}

function meet([a, b]: readonly [Point, Point], [c, d]: readonly [Point, Point]): boolean {
  const apart = (x: number, y: number): boolean => (x > 0 && y < 0) || (x < 0 && y > 0);
  if (apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))) return true;
  return isBetween(a, b, c) || isBetween(a, b, d) || isBetween(c, d, a) || isBetween(c, d, b);
}

// True if two sides that are no neighbours meet, or neighbours run back over each other.
function crossesItself(outline: Outline): boolean {
  const count = outline.length;
  const side = (k: number): readonly [Point, Point] => [outline[k % count] ?? [0, 0], outline[(k + 1) % count] ?? [0, 0]];
  for (let k = 0; k < count; k += 1) {
    const [from, to] = side(k);
    const [, after] = side(k + 1);
    if (isBetween(from, to, after) || isBetween(to, after, from)) return true;
    for (let other = k + 2; other < count - (k === 0 ? 1 : 0); other += 1) {
      if (meet(side(k), side(other))) return true;
    }
  }
  return false;
}

export type OutlineFault = 'few' | 'crosses';

export function outlineFault(outline: Outline): OutlineFault | null {
  if (outline.length < kFewest || areaMm2(outline) < 1) return 'few';
  return crossesItself(outline) ? 'crosses' : null;
}
