// The files of a finished package, checked: quad mesh, strips, weave, layout and report.

import { fields, list, number, oneOf, optional, PayloadError, point, type Reader, record, text } from '../lib/check.ts';

export type Point = readonly [number, number];
export type Family = 'weft' | 'warp';

// Corners a b c d of quad q are corners[4q .. 4q+3]; a→b runs along weft strips, a→d along warp strips.
export interface QuadMesh {
  readonly positions: Float64Array; // x y z per vertex, mm.
  readonly corners: Uint32Array;
  readonly quadCount: number;
  readonly cylinders: Uint32Array; // Per quad.
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

// What leaves.json says: leaves of both foliations, the cylinders' borders, and where those meet.
export interface CriticalGraph {
  readonly lines: readonly (readonly Point3[])[];
  readonly points: readonly Point3[];
  readonly leaves: Readonly<Record<Family, readonly (readonly Point3[])[]>>;
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

interface Leaf {
  readonly family: Family;
  readonly points: readonly Point3[];
}

const readLeaf: Reader<Leaf> = (value, path) => {
  const get = record(value, path);
  const points = get('points', list(point3));
  const first = points[0];
  const closes = get('closed', optional((v) => v === true, false)) && first !== undefined;
  return { family: get('family', family), points: closes ? [...points, first] : points };
};

export const readCriticalGraph: Reader<CriticalGraph> = (value, path) => {
  const get = record(value, path);
  const leaves = get('leaves', optional(list(readLeaf), []));
  const of = (name: Family): readonly (readonly Point3[])[] =>
    leaves.filter((leaf) => leaf.family === name).map((leaf) => leaf.points);
  return {
    leaves: { weft: of('weft'), warp: of('warp') },
    lines: get('critical_graph', optional(list((line, at) => record(line, at)('points', list(point3))), [])),
    points: get('singularities', optional(list((one, at) => record(one, at)('position', point3)), [])),
  };
};

export interface TriangleMesh {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
}

// surface.ply: ASCII, x y z first in every vertex, triangles only.
export function readSurface(source: string): TriangleMesh {
  const lines = source.split('\n');
  const end = lines.indexOf('end_header');
  const counts = /element vertex (\d+)[^]*element face (\d+)/.exec(lines.slice(0, end).join('\n'));
  if (end < 0 || counts === null) throw new PayloadError('surface.ply: no such header');
  const [vertices, faces] = [Number(counts[1]), Number(counts[2])];
  const positions = new Float32Array(3 * vertices);
  const indices = new Uint32Array(3 * faces);
  for (let v = 0; v < vertices; v += 1) {
    positions.set((lines[end + 1 + v] ?? '').split(' ', 3).map(Number), 3 * v);
  }
  for (let f = 0; f < faces; f += 1) {
    indices.set((lines[end + 1 + vertices + f] ?? '').split(' ').slice(1, 4).map(Number), 3 * f);
  }
  if (!indices.every((v) => v < vertices)) throw new PayloadError('surface.ply: no such vertex');
  return { positions, indices };
}

// 1 where warp lies on top, per quad.
export const readWeave: Reader<Uint8Array> = (value, path) =>
  Uint8Array.from(record(value, path)('warp_on_top', list((v) => (v === 1 || v === true ? 1 : 0))));

export const readReport: Reader<Readonly<Record<string, unknown>>> = fields;

export function readQuads(source: string): QuadMesh {
  const positions: number[] = [];
  const corners: number[] = [];
  const cylinders: number[] = [];
  let cylinder = 0;
  for (const line of source.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') {
      positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    } else if (words[0] === 'f') {
      if (words.length !== 5) throw new PayloadError(`quads.obj: a face of ${words.length - 1} corners`);
      for (const word of words.slice(1)) corners.push(Number.parseInt(word, 10) - 1);
      cylinders.push(cylinder);
    } else if (words[0] === 'g') {
      cylinder = Number(/^cylinder_(\d+)$/.exec(words[1] ?? '')?.[1] ?? 0);
    }
  }
  const vertices = positions.length / 3;
  if (!positions.every(Number.isFinite)) throw new PayloadError('quads.obj: a coordinate is no number');
  if (!corners.every((v) => v >= 0 && v < vertices)) throw new PayloadError('quads.obj: no such vertex');
  return {
    positions: Float64Array.from(positions),
    corners: Uint32Array.from(corners),
    quadCount: corners.length / 4,
    cylinders: Uint32Array.from(cylinders),
  };
}
