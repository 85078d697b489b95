// What a mesh is, seen at a glance: its topology, its size, and what is wrong with it.

import type { RawMesh } from './read.ts';

export interface MeshLook {
  readonly vertices: number; // As used by faces, those in one place counted once.
  readonly faces: number; // As the file has them.
  readonly components: number;
  readonly boundaryLoops: number;
  readonly genus: number | null; // Of all components together; null where the surface is no manifold.
  readonly euler: number;
  readonly sizeMm: readonly [number, number, number]; // In units of the file.
  readonly area: number; // Likewise, squared.
  readonly defects: Defects;
}

export interface Defects {
  readonly nonManifoldEdges: number;
  readonly turnedFaces: number; // Edges that both their faces run along the same way.
  readonly degenerateFaces: number;
  readonly duplicateVertices: number;
  readonly unusedVertices: number;
}

// The same mesh, ready to be drawn and picked on.
export interface Welded {
  readonly positions: Float32Array;
  readonly triangles: Uint32Array;
  readonly fileVertex: Uint32Array; // The number in the file of each vertex here.
  readonly loops: readonly Uint32Array[]; // Boundary loops, vertices in order.
}

function weld(mesh: RawMesh): { readonly first: Uint32Array; readonly duplicates: number } {
  const places = new Map<string, number>();
  const count = mesh.positions.length / 3;
  const first = new Uint32Array(count);
  let duplicates = 0;
  for (let v = 0; v < count; v += 1) {
    const key = `${mesh.positions[3 * v]},${mesh.positions[3 * v + 1]},${mesh.positions[3 * v + 2]}`;
    const known = places.get(key);
    if (known === undefined) places.set(key, v);
    else duplicates += 1;
    first[v] = known ?? v;
  }
  return { first, duplicates };
}

class Sets {
  private readonly parent: Uint32Array;

  constructor(size: number) {
    this.parent = Uint32Array.from({ length: size }, (_, k) => k);
  }

  root(k: number): number {
    let at = k;
    while (this.parent[at] !== at) {
      this.parent[at] = this.parent[this.parent[at] ?? at] ?? at;
      at = this.parent[at] ?? at;
    }
    return at;
  }

  join(a: number, b: number): void {
    this.parent[this.root(a)] = this.root(b);
  }
}

interface Edge {
  readonly from: number;
  readonly to: number;
  uses: number;
  along: number; // Faces that run from → to.
}

function edgesOf(triangles: Uint32Array, vertices: number): ReadonlyMap<number, Edge> {
  const edges = new Map<number, Edge>();
  for (let at = 0; at < triangles.length; at += 1) {
    const from = triangles[at] ?? 0;
    const to = triangles[at % 3 === 2 ? at - 2 : at + 1] ?? 0;
    const key = Math.min(from, to) * vertices + Math.max(from, to);
    const known = edges.get(key);
    if (known === undefined) edges.set(key, { from, to, uses: 1, along: 1 });
    else {
      known.uses += 1;
      if (known.from === from) known.along += 1;
    }
  }
  return edges;
}

function loopsOf(edges: Iterable<Edge>): readonly Uint32Array[] {
  const next = new Map<number, number[]>();
  const link = (a: number, b: number): void => void (next.get(a)?.push(b) ?? next.set(a, [b]));
  for (const { from, to, uses } of edges) {
    if (uses !== 1) continue;
    link(from, to);
    link(to, from);
  }
  const loops: Uint32Array[] = [];
  for (const start of next.keys()) {
    if ((next.get(start)?.length ?? 0) === 0) continue;
    const loop: number[] = [];
    for (let at: number | undefined = start; at !== undefined; ) {
      loop.push(at);
      const to: number | undefined = next.get(at)?.pop();
      if (to === undefined) break;
      const back: number[] = next.get(to) ?? [];
      back.splice(back.indexOf(at), 1);
      at = to === start ? undefined : to;
    }
    if (loop.length >= 3) loops.push(Uint32Array.from(loop));
  }
  return loops;
}

function areaOf(positions: Float64Array, triangles: Uint32Array): number {
  let area = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const at = (k: number, axis: number): number => positions[3 * (triangles[t + k] ?? 0) + axis] ?? 0;
    const side = (k: number): readonly number[] => [0, 1, 2].map((axis) => at(k, axis) - at(0, axis));
    const [[a = 0, b = 0, c = 0], [d = 0, e = 0, f = 0]] = [side(1), side(2)];
    area += Math.hypot(b * f - c * e, c * d - a * f, a * e - b * d) / 2;
  }
  return area;
}

function sizeOf(positions: Float64Array, used: Iterable<number>): readonly [number, number, number] {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const v of used) {
    for (let axis = 0; axis < 3; axis += 1) {
      const value = positions[3 * v + axis] ?? 0;
      low[axis] = Math.min(low[axis] ?? 0, value);
      high[axis] = Math.max(high[axis] ?? 0, value);
    }
  }
  const span = (axis: number): number => (high[axis] ?? 0) - (low[axis] ?? 0);
  return [span(0), span(1), span(2)];
}

// Without faces that are no triangles.
function soundTriangles(mesh: RawMesh, first: Uint32Array): { readonly triangles: Uint32Array; readonly degenerate: number } {
  const kept: number[] = [];
  for (let t = 0; t < mesh.triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => first[mesh.triangles[t + k] ?? 0] ?? 0) as [number, number, number];
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return { triangles: Uint32Array.from(kept), degenerate: (mesh.triangles.length - kept.length) / 3 };
}

export function lookAt(mesh: RawMesh): { readonly look: MeshLook; readonly welded: Welded } {
  const count = mesh.positions.length / 3;
  const { first, duplicates } = weld(mesh);
  const { triangles, degenerate } = soundTriangles(mesh, first);
  const used = new Set(triangles);
  const edges = edgesOf(triangles, count);
  const sets = new Sets(count);
  let [nonManifold, turned] = [0, 0];
  for (const edge of edges.values()) {
    sets.join(edge.from, edge.to);
    if (edge.uses > 2) nonManifold += 1;
    else if (edge.uses === 2 && edge.along !== 1) turned += 1;
  }
  const components = new Set([...used].map((v) => sets.root(v))).size;
  const loops = loopsOf(edges.values());
  const euler = used.size - edges.size + triangles.length / 3;
  // χ = 2·components − 2·genus − loops
  const doubled = 2 * components - loops.length - euler;
  const look: MeshLook = {
    vertices: used.size,
    faces: mesh.polygons,
    components,
    boundaryLoops: loops.length,
    genus: nonManifold > 0 || doubled < 0 || doubled % 2 !== 0 ? null : doubled / 2,
    euler,
    sizeMm: sizeOf(mesh.positions, used),
    area: areaOf(mesh.positions, triangles),
    defects: {
      nonManifoldEdges: nonManifold,
      turnedFaces: turned,
      degenerateFaces: degenerate,
      duplicateVertices: duplicates,
      unusedVertices: count - duplicates - used.size,
    },
  };
  const order = [...used].sort((a, b) => a - b);
  const place = new Map(order.map((v, k) => [v, k]));
  const here = (v: number): number => place.get(v) ?? 0;
  const welded: Welded = {
    positions: Float32Array.from(order.flatMap((v) => [0, 1, 2].map((axis) => mesh.positions[3 * v + axis] ?? 0))),
    triangles: triangles.map(here),
    fileVertex: Uint32Array.from(order),
    loops: loops.map((loop) => loop.map(here)),
  };
  return { look, welded };
}
