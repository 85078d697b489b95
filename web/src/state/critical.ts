// Polylines as the segments that are drawn.

import type { Point3 } from '../api/package_files.ts';

// Both ends of every segment, one after the other: x y z x y z.
export function segmentsOf(lines: readonly (readonly Point3[])[]): Float32Array {
  const ends: number[] = [];
  for (const line of lines) {
    line.forEach((point, index) => {
      const before = line[index - 1];
      if (before !== undefined) ends.push(...before, ...point);
    });
  }
  return Float32Array.from(ends);
}
