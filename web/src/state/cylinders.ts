// The cylinders that a surface fell into when it was woven before, laid over its mesh: so that their weights
// can be picked on the model.

import type { QuadMesh } from '../api/package_files.ts';
import type { Welded } from '../mesh/look.ts';
import { kPantsSources, kSweepFunctions, type PantsSource, type SweepFunction } from './foliation_choices.ts';

type Params = Readonly<Record<string, unknown>>;

// What a report says of them; heights by edge of the graph, as `foliation.weights` wants them.
export interface WovenCylinders {
  readonly heights: readonly number[];
  readonly edgeOf: readonly number[]; // Per cylinder of the quad mesh.
  readonly pants: PantsSource; // The decomposition they belong to: other ones number theirs otherwise.
  readonly sweep: SweepFunction;
  readonly scale: number; // Turns units of the file into mm.
}

const at = (value: unknown, key: string): unknown => (typeof value === 'object' && value !== null ? (value as Params)[key] : undefined);
const listOf = (value: unknown): readonly unknown[] => (Array.isArray(value) ? value : []);
const isNumber = (value: unknown): value is number => typeof value === 'number' && Number.isFinite(value);

// The name of the decomposition that was chosen. One with holes is named without it: its own ways follow it,
// the best one first.
function chosenWay(foliation: unknown): string {
  const alternatives = listOf(at(foliation, 'alternatives'));
  const chosen = String(at(alternatives.find((one) => at(one, 'chosen') === true), 'name') ?? '');
  const names = alternatives.map((one) => String(at(one, 'name')));
  return /pants \S+, /.test(chosen) ? chosen : (names.find((name) => name.startsWith(`${chosen}: pants `)) ?? chosen);
}

// Null where the surface is not cut into several cylinders.
export function wovenCylinders(report: Params): WovenCylinders | null {
  const foliation = report['foliation'];
  const heights = listOf(at(foliation, 'weights')).filter(isNumber);
  const scale = at(report['input'], 'scale');
  if (at(foliation, 'mode') !== 'pants' || heights.length < 2 || !isNumber(scale)) return null;
  const [, source, sweep] = /pants ([a-z-]+)-([a-z]+)/.exec(chosenWay(foliation)) ?? [];
  return {
    heights,
    edgeOf: listOf(at(foliation, 'cylinders')).map((one, index) => Number(at(one, 'graph_edge') ?? index)),
    pants: source === 'loops' ? 'user' : (kPantsSources.find((one) => one === source) ?? 'reeb'),
    sweep: kSweepFunctions.find((one) => one === sweep) ?? 'auto',
    scale,
  };
}

// Points in cubes, to find the nearest one quickly.
class Cubes {
  private readonly cubes = new Map<string, number[]>();

  constructor(private readonly points: Float64Array, private readonly side: number) {
    for (let k = 0; 3 * k < points.length; k += 1) {
      const key = this.keyOf(points[3 * k] ?? 0, points[3 * k + 1] ?? 0, points[3 * k + 2] ?? 0);
      const known = this.cubes.get(key);
      if (known === undefined) this.cubes.set(key, [k]);
      else known.push(k);
    }
  }

  private keyOf(x: number, y: number, z: number): string {
    return [x, y, z].map((value) => Math.floor(value / this.side)).join();
  }

  private away(k: number, x: number, y: number, z: number): number {
    return Math.hypot((this.points[3 * k] ?? 0) - x, (this.points[3 * k + 1] ?? 0) - y, (this.points[3 * k + 2] ?? 0) - z);
  }

  // The nearest point within about `side`; of all points where none is so near.
  nearest(x: number, y: number, z: number): number {
    const near: number[] = [];
    for (const dx of [-1, 0, 1]) {
      for (const dy of [-1, 0, 1]) {
        for (const dz of [-1, 0, 1]) {
          near.push(...(this.cubes.get(this.keyOf(x + dx * this.side, y + dy * this.side, z + dz * this.side)) ?? []));
        }
      }
    }
    const candidates: Iterable<number> = near.length > 0 ? near : Array.from({ length: this.points.length / 3 }, (_, k) => k);
    let [best, least] = [0, Infinity];
    for (const k of candidates) {
      const away = this.away(k, x, y, z);
      if (away < least) [best, least] = [k, away];
    }
    return best;
  }
}

function centres(quads: QuadMesh): { readonly points: Float64Array; readonly widest: number } {
  const points = new Float64Array(3 * quads.quadCount);
  let widest = 0;
  for (let q = 0; q < quads.quadCount; q += 1) {
    const corner = (k: number, axis: number): number => quads.positions[3 * (quads.corners[4 * q + k] ?? 0) + axis] ?? 0;
    for (let axis = 0; axis < 3; axis += 1) points[3 * q + axis] = (corner(0, axis) + corner(1, axis) + corner(2, axis) + corner(3, axis)) / 4;
    widest = Math.max(widest, Math.hypot(corner(0, 0) - corner(2, 0), corner(0, 1) - corner(2, 1), corner(0, 2) - corner(2, 2)));
  }
  return { points, widest };
}

// The edge of the graph that each triangle of the mesh belongs to: that of the nearest quad.
export function cylinderOfTriangles(mesh: Welded, quads: QuadMesh, woven: WovenCylinders): Uint32Array {
  const { points, widest } = centres(quads);
  if (quads.quadCount === 0) return new Uint32Array(mesh.triangles.length / 3);
  const cubes = new Cubes(points, widest || 1);
  return Uint32Array.from({ length: mesh.triangles.length / 3 }, (_, t) => {
    const middle = (axis: number): number =>
      (woven.scale / 3) * [0, 1, 2].reduce((sum, k) => sum + (mesh.positions[3 * (mesh.triangles[3 * t + k] ?? 0) + axis] ?? 0), 0);
    return woven.edgeOf[quads.cylinders[cubes.nearest(middle(0), middle(1), middle(2))] ?? 0] ?? 0;
  });
}

// The heights that were typed, where there are as many as cylinders; else those of the last time.
export function heightsIn(typed: string, woven: WovenCylinders): readonly number[] {
  const given = typed.split(/[\s,]+/).filter((word) => word !== '').map(Number);
  const fits = given.length === woven.heights.length && given.every((height) => Number.isFinite(height) && height > 0);
  return fits ? given : woven.heights;
}

// Those heights as text, with another one for `edge`. Three figures are enough: only proportions count.
export function withHeight(typed: string, woven: WovenCylinders, edge: number, height: number): string {
  return heightsIn(typed, woven)
    .map((old, k) => String(Number((k === edge ? height : old).toPrecision(3))))
    .join(', ');
}
