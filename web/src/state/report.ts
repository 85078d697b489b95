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

export interface ReportFigures {
  readonly quality: readonly QualityRow[];
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

export function reportFigures(report: Report): ReportFigures {
  const quality = kQuality
    .map((name) => ({
      name,
      average: numberAt(report, 'quality', 'overall', name, 'avg'),
      largest: numberAt(report, 'quality', 'overall', name, 'max'),
    }))
    .filter((row) => row.average !== null || row.largest !== null);
  const timings = Object.values((at(report, 'timings_s') as object | undefined) ?? {});
  const seconds = timings.filter((value): value is number => typeof value === 'number');
  return {
    quality,
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
