// The woven surface as triangles: every quad carries one cell of a weft ribbon and one of a warp
// ribbon, lifted to either side of the surface as the weave says, and passing smoothly from cell to
// cell. Plain arrays, for any renderer.

import type { Family, QuadMesh } from '../api/package_files.ts';

type Vec3 = readonly [number, number, number];

export interface Ribbons {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly shades: Float32Array; // Grey per vertex as r g b: darker where the ribbon dives under.
  readonly indices: Uint32Array;
  readonly indicesPerQuad: number; // Quad q's triangles are indices[q·n .. (q+1)·n).
}

export interface RibbonOptions {
  readonly steps?: number; // Segments along a cell.
  readonly gap?: number; // Part of a cell's width left free on each side.
  readonly lift?: number; // Height over the surface, in mean edge lengths.
}

// Sides of a quad: a–b, b–c, c–d, d–a.
const kNone = -1;

function read3(values: ArrayLike<number>, at: number): Vec3 {
  return [values[3 * at] ?? 0, values[3 * at + 1] ?? 0, values[3 * at + 2] ?? 0];
}

const add = (p: Vec3, q: Vec3, t: number): Vec3 => [p[0] + t * q[0], p[1] + t * q[1], p[2] + t * q[2]];
const sub = (p: Vec3, q: Vec3): Vec3 => add(p, q, -1);
const cross = (p: Vec3, q: Vec3): Vec3 => [
  p[1] * q[2] - p[2] * q[1],
  p[2] * q[0] - p[0] * q[2],
  p[0] * q[1] - p[1] * q[0],
];
const unit = (p: Vec3): Vec3 => {
  const length = Math.hypot(...p) || 1;
  return [p[0] / length, p[1] / length, p[2] / length];
};

function corner(mesh: QuadMesh, quad: number, k: number): number {
  return mesh.corners[4 * quad + k] ?? 0;
}

// Area-weighted vertex normals.
export function vertexNormals(mesh: QuadMesh): Float64Array {
  const normals = new Float64Array(mesh.positions.length);
  for (let q = 0; q < mesh.quadCount; q += 1) {
    const [a, b, c, d] = [0, 1, 2, 3].map((k) => read3(mesh.positions, corner(mesh, q, k))) as [Vec3, Vec3, Vec3, Vec3];
    const normal = cross(sub(c, a), sub(d, b));
    for (let k = 0; k < 4; k += 1) {
      const at = 3 * corner(mesh, q, k);
      for (let axis = 0; axis < 3; axis += 1) normals[at + axis] = (normals[at + axis] ?? 0) + (normal[axis] ?? 0);
    }
  }
  for (let v = 0; v < normals.length / 3; v += 1) normals.set(unit(read3(normals, v)), 3 * v);
  return normals;
}

// The quad across each side, or -1: neighbours[4q + side].
export function quadNeighbours(mesh: QuadMesh): Int32Array {
  const neighbours = new Int32Array(mesh.corners.length).fill(kNone);
  const open = new Map<number, number>();
  const vertices = mesh.positions.length / 3;
  for (let slot = 0; slot < mesh.corners.length; slot += 1) {
    const from = mesh.corners[slot] ?? 0;
    const to = mesh.corners[slot % 4 === 3 ? slot - 3 : slot + 1] ?? 0;
    const edge = Math.min(from, to) * vertices + Math.max(from, to);
    const other = open.get(edge);
    if (other === undefined) {
      open.set(edge, slot);
    } else {
      open.delete(edge);
      neighbours[slot] = other >> 2;
      neighbours[other] = slot >> 2;
    }
  }
  return neighbours;
}

export function meanEdge(mesh: QuadMesh): number {
  let sum = 0;
  for (let slot = 0; slot < mesh.corners.length; slot += 1) {
    const from = read3(mesh.positions, mesh.corners[slot] ?? 0);
    const to = read3(mesh.positions, mesh.corners[slot % 4 === 3 ? slot - 3 : slot + 1] ?? 0);
    sum += Math.hypot(...sub(to, from));
  }
  return mesh.corners.length === 0 ? 1 : sum / mesh.corners.length;
}

// Height along a cell, between −1 and 1, and its derivative: half a cosine from the middle of one cell
// to the middle of the next, so that ribbons join with one tangent.
export function heightAlong(t: number, before: number, here: number, after: number): readonly [number, number] {
  const other = t < 0.5 ? before : after;
  const away = Math.abs(t - 0.5);
  const height = here + ((other - here) * (1 - Math.cos(Math.PI * away))) / 2;
  const slope = ((other - here) * Math.PI * Math.sin(Math.PI * away)) / 2;
  return [height, t < 0.5 ? -slope : slope];
}

interface Patch {
  readonly points: readonly [Vec3, Vec3, Vec3, Vec3];
  readonly normals: readonly [Vec3, Vec3, Vec3, Vec3];
}

function bilinear([a, b, c, d]: Patch['points'], u: number, v: number): Vec3 {
  const low = add(a, sub(b, a), u);
  const high = add(d, sub(c, d), u);
  return add(low, sub(high, low), v);
}

interface CellHeights {
  readonly before: number;
  readonly here: number;
  readonly after: number;
}

class RibbonWriter {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly shades: Float32Array;
  readonly indices: Uint32Array;
  private vertex = 0;
  private index = 0;

  constructor(
    quads: number,
    private readonly steps: number,
    private readonly gap: number,
    private readonly lift: number,
  ) {
    const vertices = quads * 2 * (steps + 1);
    this.positions = new Float32Array(3 * vertices);
    this.normals = new Float32Array(3 * vertices);
    this.shades = new Float32Array(3 * vertices);
    this.indices = new Uint32Array(quads * 6 * steps);
  }

  cell(patch: Patch, family: Family, heights: CellHeights): void {
    const first = this.vertex;
    for (let step = 0; step <= this.steps; step += 1) {
      for (const across of [this.gap, 1 - this.gap]) this.point(patch, family, step / this.steps, across, heights);
    }
    for (let step = 0; step < this.steps; step += 1) {
      const [p, q, r, s] = [0, 1, 2, 3].map((k) => first + 2 * step + k) as [number, number, number, number];
      // Weft runs along u with v across, warp along v with u across: opposite turns.
      this.indices.set(family === 'weft' ? [p, r, q, q, r, s] : [p, q, r, q, s, r], this.index);
      this.index += 6;
    }
  }

  private point(patch: Patch, family: Family, along: number, across: number, heights: CellHeights): void {
    const [u, v] = family === 'weft' ? [along, across] : [across, along];
    const [a, b, c, d] = patch.points;
    const normal = unit(bilinear(patch.normals, u, v));
    const [height, slope] = heightAlong(along, heights.before, heights.here, heights.after);
    const rise = slope * this.lift;
    let du = add(sub(b, a), sub(sub(c, d), sub(b, a)), v);
    let dv = add(sub(d, a), sub(sub(c, b), sub(d, a)), u);
    if (family === 'weft') du = add(du, normal, rise);
    else dv = add(dv, normal, rise);
    const at = 3 * this.vertex;
    this.positions.set(add(bilinear(patch.points, u, v), normal, height * this.lift), at);
    this.normals.set(unit(cross(du, dv)), at);
    this.shades.fill(0.5 + 0.25 * (height + 1), at, at + 3);
    this.vertex += 1;
  }
}

// `warpOnTop` per quad, as weave.json has it.
export function buildRibbons(mesh: QuadMesh, warpOnTop: Uint8Array, family: Family, options: RibbonOptions = {}): Ribbons {
  const { steps = 4, gap = 0.085, lift = 0.11 } = options;
  const normals = vertexNormals(mesh);
  const neighbours = quadNeighbours(mesh);
  const writer = new RibbonWriter(mesh.quadCount, steps, gap, lift * meanEdge(mesh));
  const sides = family === 'weft' ? ([3, 1] as const) : ([0, 2] as const);
  const height = (quad: number): number => ((warpOnTop[quad] === 1) === (family === 'warp') ? 1 : -1);
  for (let q = 0; q < mesh.quadCount; q += 1) {
    const four = (values: ArrayLike<number>): Patch['points'] => [
      read3(values, corner(mesh, q, 0)),
      read3(values, corner(mesh, q, 1)),
      read3(values, corner(mesh, q, 2)),
      read3(values, corner(mesh, q, 3)),
    ];
    const beyond = (side: number): number => {
      const other = neighbours[4 * q + side] ?? kNone;
      return height(other === kNone ? q : other);
    };
    const heights = { before: beyond(sides[0]), here: height(q), after: beyond(sides[1]) };
    writer.cell({ points: four(mesh.positions), normals: four(normals) }, family, heights);
  }
  const { positions, normals: ribbonNormals, shades, indices } = writer;
  return { positions, normals: ribbonNormals, shades, indices, indicesPerQuad: 6 * steps };
}
