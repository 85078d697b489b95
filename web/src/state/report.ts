// The report's figures as rows to show. A report may carry less than all of them.

import { fields, number, optional } from '../lib/check.ts';

type Report = Readonly<Record<string, unknown>>;

export type QualityName =
  | 'angle_deviation_deg'
  | 'surface_distance_percent'
  | 'area_distortion_percent'
  | 'planarity_percent'
  | 'angle_deviation_bound_deg'
  | 'crossing_angle_deviation_deg';

export interface QualityRow {
  readonly name: QualityName;
  readonly average: number | null;
  readonly largest: number | null;
}

export interface Alternative {
  readonly name: string;
  readonly largest: number;
  readonly variation: number;
  readonly removedPercent: number;
  readonly chosen: boolean;
}

export interface FoliationFigures {
  readonly mode: string;
  readonly cylinders: number;
  readonly points: readonly { readonly prongs: number; readonly count: number }[]; // Rising prongs.
  readonly holeRadiiMm: readonly number[];
  readonly removedPercent: number;
  readonly largest: number | null; // Edge of the largest cells, in mean edges.
  readonly parts: number;
  readonly alternatives: readonly Alternative[];
}

export interface CylinderFigures {
  readonly cylinder: number;
  readonly quads: number;
  readonly grid: readonly [number, number] | null; // Rows and columns.
  readonly quality: readonly QualityRow[];
}

export interface ReportFigures {
  readonly foliation: FoliationFigures | null;
  readonly quality: readonly QualityRow[];
  readonly cylinders: readonly CylinderFigures[];
  readonly facts: {
    readonly vertices: number | null;
    readonly faces: number | null;
    readonly genus: number | null;
    readonly boundaryLoops: number | null;
    readonly cylinders: number | null;
    readonly densityPercent: number | null;
    readonly certificate: number | null;
    readonly totalS: number | null;
  };
}

const kQuality: readonly QualityName[] = [
  'angle_deviation_deg',
  'crossing_angle_deviation_deg',
  'surface_distance_percent',
  'area_distortion_percent',
  'planarity_percent',
];

function at(report: unknown, ...path: readonly string[]): unknown {
  return path.reduce<unknown>(
    (value, key) => (typeof value === 'object' && value !== null ? fields(value, '')[key] : undefined),
    report,
  );
}

function numberAt(report: unknown, ...path: readonly string[]): number | null {
  const value = at(report, ...path);
  return typeof value === 'number' ? optional(number, null)(value, path.join('/')) : null;
}

function countAt(report: unknown, ...path: readonly string[]): number | null {
  const value = at(report, ...path);
  return Array.isArray(value) ? value.length : null;
}

function listAt(report: unknown, ...path: readonly string[]): readonly unknown[] {
  const value = at(report, ...path);
  return Array.isArray(value) ? value : [];
}

function textAt(report: unknown, ...path: readonly string[]): string {
  const value = at(report, ...path);
  return typeof value === 'string' ? value : '';
}

function pointsOf(report: Report): FoliationFigures['points'] {
  const counts = new Map<number, number>();
  for (const point of listAt(report, 'foliation', 'singularities')) {
    const prongs = numberAt(point, 'prongs');
    if (prongs !== null) counts.set(prongs, (counts.get(prongs) ?? 0) + 1);
  }
  return [...counts].sort(([a], [b]) => a - b).map(([prongs, count]) => ({ prongs, count }));
}

function foliationFigures(report: Report): FoliationFigures | null {
  if (textAt(report, 'foliation', 'mode') === '') return null;
  const known = (value: number | null): value is number => value !== null;
  return {
    mode: textAt(report, 'foliation', 'mode'),
    cylinders: listAt(report, 'foliation', 'cylinders').length,
    points: pointsOf(report),
    holeRadiiMm: listAt(report, 'foliation', 'punctures').map((hole) => numberAt(hole, 'radius_mm')).filter(known),
    removedPercent: numberAt(report, 'surface', 'removed_area_percent') ?? 0,
    largest: numberAt(report, 'foliation', 'cell_spread', 'largest_edge'),
    parts: numberAt(report, 'topology', 'components') ?? 1,
    alternatives: listAt(report, 'foliation', 'alternatives').map((one) => ({
      name: textAt(one, 'name'),
      largest: numberAt(one, 'cell_spread', 'largest_edge') ?? 0,
      variation: numberAt(one, 'cell_spread', 'variation') ?? 0,
      removedPercent: numberAt(one, 'removed_area_percent') ?? 0,
      chosen: at(one, 'chosen') === true,
    })),
  };
}

// The chosen one first, then the others by the size of their largest cells. Ways to cut one and the same
// surface ("pants reeb-x, equal weights") come after what differs more.
export function sortedAlternatives(all: readonly Alternative[]): {
  readonly first: readonly Alternative[];
  readonly rest: readonly Alternative[];
} {
  const sorted = [...all].sort((a, b) => Number(b.chosen) - Number(a.chosen) || a.largest - b.largest);
  const isWayToCut = ({ name, chosen }: Alternative): boolean => !chosen && /(^|: )pants \S+, /.test(name);
  return { first: sorted.filter((one) => !isWayToCut(one)), rest: sorted.filter(isWayToCut) };
}

export type Evenness = 'even' | 'uneven' | 'coarse';

// How much the largest cells stand out, given their edge in mean edges.
export function evennessOf(largest: number): Evenness {
  if (largest < 2.5) return 'even';
  return largest < 6 ? 'uneven' : 'coarse';
}

function qualityRows(figures: unknown): readonly QualityRow[] {
  return kQuality
    .map((name) => ({ name, average: numberAt(figures, name, 'avg'), largest: numberAt(figures, name, 'max') }))
    .filter((row) => row.average !== null || row.largest !== null);
}

function cylinderFigures(report: Report): readonly CylinderFigures[] {
  const grids = listAt(report, 'foliation', 'cylinders');
  return listAt(report, 'quality', 'cylinders').map((one, index) => {
    const cylinder = numberAt(one, 'cylinder') ?? index;
    const [rows, columns] = [numberAt(grids[cylinder], 'rows'), numberAt(grids[cylinder], 'cols')];
    return {
      cylinder,
      quads: numberAt(one, 'quads') ?? 0,
      grid: rows === null || columns === null ? null : [rows, columns],
      quality: qualityRows(one),
    };
  });
}

export function reportFigures(report: Report): ReportFigures {
  const timings = Object.values((at(report, 'timings_s') as object | undefined) ?? {});
  const seconds = timings.filter((value): value is number => typeof value === 'number');
  return {
    foliation: foliationFigures(report),
    quality: qualityRows(at(report, 'quality', 'overall')),
    cylinders: cylinderFigures(report),
    facts: {
      vertices: numberAt(report, 'input', 'vertices'),
      faces: numberAt(report, 'input', 'faces'),
      genus: numberAt(report, 'topology', 'genus'),
      boundaryLoops: numberAt(report, 'topology', 'boundary_loops'),
      cylinders: countAt(report, 'foliation', 'cylinders'),
      densityPercent: numberAt(report, 'nesting', 'density_percent') ?? numberAt(report, 'nesting', 'density'),
      certificate: numberAt(report, 'certificate', 'largest_deviation_relative'),
      totalS:
        numberAt(report, 'timings_s', 'total') ??
        (seconds.length === 0 ? null : seconds.reduce((sum, value) => sum + value, 0)),
    },
  };
}
