// Figures of every quad as colours: quality heat maps, and cylinders told apart.

import type { QuadMesh } from '../api/package_files.ts';
import { list, number, optional, type Reader, record } from '../lib/check.ts';

export const kHeatMaps = ['angle', 'distance', 'area', 'planarity'] as const;
export type HeatName = (typeof kHeatMaps)[number];

// What quality.json says, as far as it is drawn.
export interface QualityFile {
  readonly angleDeg: readonly number[]; // Per vertex.
  readonly distancePercent: readonly number[]; // Per quad, as the next two.
  readonly areaPercent: readonly number[];
  readonly planarityPercent: readonly number[];
}

// Not every vertex has every figure.
const figures = list((value, path) => optional(number, Number.NaN)(value, path));

export const readQuality: Reader<QualityFile> = (value, path) => {
  const quads = record(record(value, path)('per_quad', (v) => v), `${path}/per_quad`);
  const vertices = record(record(value, path)('per_vertex', (v) => v), `${path}/per_vertex`);
  return {
    angleDeg: vertices('angle_deviation_deg', figures),
    distancePercent: quads('distance_percent', figures),
    areaPercent: quads('area_percent', figures),
    planarityPercent: quads('planarity_percent', figures),
  };
};

export interface HeatMap {
  readonly name: HeatName;
  readonly corners: Float32Array; // One figure per corner of every quad; NaN where there is none.
  readonly top: number; // What the hottest colour stands for; larger ones are drawn like it.
  readonly largest: number;
}

// The value that `share` of the figures do not exceed.
export function quantile(values: Float32Array, share: number): number {
  const known = values.filter((value) => !Number.isNaN(value)).sort();
  if (known.length === 0) return 0;
  return known[Math.min(known.length - 1, Math.floor(share * known.length))] ?? 0;
}

const kShown = 0.98; // A few outliers must not turn all else into one colour.

export function heatMap(mesh: QuadMesh, quality: QualityFile, name: HeatName): HeatMap {
  const perQuad = { distance: quality.distancePercent, area: quality.areaPercent, planarity: quality.planarityPercent };
  const corners = Float32Array.from({ length: 4 * mesh.quadCount }, (_, slot) => {
    const value = name === 'angle' ? quality.angleDeg[mesh.corners[slot] ?? -1] : perQuad[name][slot >> 2];
    return value === undefined ? Number.NaN : Math.abs(value);
  });
  const largest = quantile(corners, 1);
  return { name, corners, top: quantile(corners, kShown) || largest || 1, largest };
}

type Rgb = readonly [number, number, number];

// From dark blue over green to yellow (viridis): rising lightness, told apart by colour-blind eyes too.
export const kHeatStops: readonly Rgb[] = [
  [0.267, 0.005, 0.329],
  [0.254, 0.265, 0.53],
  [0.164, 0.471, 0.558],
  [0.135, 0.659, 0.518],
  [0.478, 0.821, 0.319],
  [0.993, 0.906, 0.144],
];
const kUnknown: Rgb = [0.6, 0.6, 0.6];

export function heatColour(share: number): Rgb {
  if (Number.isNaN(share)) return kUnknown;
  const at = Math.min(1, Math.max(0, share)) * (kHeatStops.length - 1);
  const low = Math.min(kHeatStops.length - 2, Math.floor(at));
  const [from, to] = [kHeatStops[low] ?? kUnknown, kHeatStops[low + 1] ?? kUnknown];
  const mix = (k: 0 | 1 | 2): number => from[k] + (to[k] - from[k]) * (at - low);
  return [mix(0), mix(1), mix(2)];
}

// red, green, blue per corner of every quad.
export function heatColours(map: HeatMap): Float32Array {
  const colours = new Float32Array(3 * map.corners.length);
  map.corners.forEach((value, slot) => colours.set(heatColour(value / map.top), 3 * slot));
  return colours;
}

// Twelve that stand apart (Paul Tol's "muted" and kin), then again from the first.
export const kCylinderColours: readonly string[] = [
  '#88ccee', '#cc6677', '#ddcc77', '#117733', '#8d7bd0', '#44aa99', '#e08a50', '#aa4499', '#999933', '#6699cc', '#cc99bb', '#bbbbbb',
];

export function cylinderColour(cylinder: number): string {
  return kCylinderColours[cylinder % kCylinderColours.length] ?? '#bbbbbb';
}

function rgbOf(hex: string): Rgb {
  const part = (at: number): number => Number.parseInt(hex.slice(at, at + 2), 16) / 255;
  return [part(1), part(3), part(5)];
}

export function cylinderColours(mesh: QuadMesh): Float32Array {
  const colours = new Float32Array(12 * mesh.quadCount);
  for (let slot = 0; slot < 4 * mesh.quadCount; slot += 1) {
    colours.set(rgbOf(cylinderColour(mesh.cylinders[slot >> 2] ?? 0)), 3 * slot);
  }
  return colours;
}
