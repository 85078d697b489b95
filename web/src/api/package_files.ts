// The files of a finished package, checked: quad mesh, strips, weave, layout and report.

import { fields, list, number, oneOf, optional, PayloadError, point, type Reader, record, text } from '../lib/check.ts';

export type Point = readonly [number, number];
export type Family = 'weft' | 'warp';

// Corners a b c d of quad q are corners[4q .. 4q+3]; a→b runs along weft strips, a→d along warp strips.
export interface QuadMesh {
  readonly positions: Float64Array; // x y z per vertex, mm.
  readonly corners: Uint32Array;
  readonly quadCount: number;
}

export interface Strip {
  readonly id: string;
  readonly family: Family;
  readonly closed: boolean;
  readonly quads: readonly number[];
  readonly pieces: readonly string[];
}

export interface Mark {
  readonly kind: string;
  readonly path: readonly Point[]; // Empty for text.
  readonly text: string; // Empty for a line.
  readonly at: Point;
  readonly angleDeg: number;
  readonly heightMm: number;
}

export interface Piece {
  readonly id: string;
  readonly strip: string;
  readonly outline: readonly Point[];
  readonly marks: readonly Mark[];
}

export interface Strips {
  readonly strips: readonly Strip[];
  readonly pieces: readonly Piece[];
}

export interface Placement {
  readonly piece: string;
  readonly xMm: number;
  readonly yMm: number;
  readonly rotationDeg: number;
  readonly mirrored: boolean;
}

export interface LayoutSheet {
  readonly id: number;
  readonly material: string;
  readonly family: string;
  readonly widthMm: number;
  readonly heightMm: number;
  readonly placements: readonly Placement[];
}

export interface Layout {
  readonly sheets: readonly LayoutSheet[];
  readonly densityPercent: number;
  readonly unplaced: readonly string[];
}

export type Point3 = readonly [number, number, number];

// What leaves.json says of the cylinders' borders: lines along them, and where those meet.
export interface CriticalGraph {
  readonly lines: readonly (readonly Point3[])[];
  readonly points: readonly Point3[];
}

const family = oneOf<Family>('weft', 'warp');

const readStrip: Reader<Strip> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', text),
    family: get('family', family),
    closed: get('closed', optional((v) => v === true, false)),
    quads: get('quads', list(number)),
    pieces: get('pieces', optional(list(text), [])),
  };
};

const readMark: Reader<Mark> = (value, path) => {
  const get = record(value, path);
  return {
    kind: get('kind', text),
    path: get('path', optional(list(point), [])),
    text: get('text', optional(text, '')),
    at: get('at', optional(point, [0, 0] as const)),
    angleDeg: get('angle_deg', optional(number, 0)),
    heightMm: get('height_mm', optional(number, 0)),
  };
};

const readPiece: Reader<Piece> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', text),
    strip: get('strip', text),
    outline: get('outline', list(point)),
    marks: get('marks', optional(list(readMark), [])),
  };
};

export const readStrips: Reader<Strips> = (value, path) => {
  const get = record(value, path);
  return { strips: get('strips', list(readStrip)), pieces: get('pieces', list(readPiece)) };
};

const readPlacement: Reader<Placement> = (value, path) => {
  const get = record(value, path);
  return {
    piece: get('piece', text),
    xMm: get('x_mm', number),
    yMm: get('y_mm', number),
    rotationDeg: get('rotation_deg', optional(number, 0)),
    mirrored: get('mirrored', optional((v) => v === true, false)),
  };
};

const readLayoutSheet: Reader<LayoutSheet> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', number),
    material: get('material', optional(text, '')),
    family: get('family', optional(text, '')),
    widthMm: get('width_mm', number),
    heightMm: get('height_mm', number),
    placements: get('placements', list(readPlacement)),
  };
};

export const readLayout: Reader<Layout> = (value, path) => {
  const get = record(value, path);
  return {
    sheets: get('sheets', list(readLayoutSheet)),
    densityPercent: get('density_percent', optional(number, 0)),
    unplaced: get('unplaced', optional(list(text), [])),
  };
};

const point3: Reader<Point3> = (value, path) => {
  const [x, y, z] = list(number)(value, path);
  if (x === undefined || y === undefined || z === undefined) throw new PayloadError(`${path}: expected a point [x, y, z]`);
  return [x, y, z];
};

export const readCriticalGraph: Reader<CriticalGraph> = (value, path) => {
  const get = record(value, path);
  return {
    lines: get('critical_graph', optional(list((line, at) => record(line, at)('points', list(point3))), [])),
    points: get('singularities', optional(list((one, at) => record(one, at)('position', point3)), [])),
  };
};

// 1 where warp lies on top, per quad.
export const readWeave: Reader<Uint8Array> = (value, path) =>
  Uint8Array.from(record(value, path)('warp_on_top', list((v) => (v === 1 || v === true ? 1 : 0))));

export const readReport: Reader<Readonly<Record<string, unknown>>> = fields;

export function readQuads(source: string): QuadMesh {
  const positions: number[] = [];
  const corners: number[] = [];
  for (const line of source.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') {
      positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    } else if (words[0] === 'f') {
      if (words.length !== 5) throw new PayloadError(`quads.obj: a face of ${words.length - 1} corners`);
      for (const word of words.slice(1)) corners.push(Number.parseInt(word, 10) - 1);
    }
  }
  const vertices = positions.length / 3;
  if (!positions.every(Number.isFinite)) throw new PayloadError('quads.obj: a coordinate is no number');
  if (!corners.every((v) => v >= 0 && v < vertices)) throw new PayloadError('quads.obj: no such vertex');
  return {
    positions: Float64Array.from(positions),
    corners: Uint32Array.from(corners),
    quadCount: corners.length / 4,
  };
}
