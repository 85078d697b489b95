// Two results laid side by side, figure by figure.

import type { Job } from '../api/types.ts';
import type { QualityName, ReportFigures } from './report.ts';

export type CompareName = 'quads' | 'strips' | 'pieces' | 'sheets' | 'time' | 'cylinders' | 'largest' | 'density';

export interface CompareRow {
  readonly name: CompareName | QualityName;
  readonly of: 'count' | 'average' | 'most';
  readonly values: readonly [number | null, number | null];
  readonly better: 0 | 1 | null; // Which of the two, where less or more is better at all.
}

const kMoreIsBetter = new Set<string>(['density']);
const kNeither = new Set<string>(['quads', 'strips', 'cylinders']);

function row(name: CompareRow['name'], of: CompareRow['of'], a: number | null | undefined, b: number | null | undefined): CompareRow {
  const values = [a ?? null, b ?? null] as const;
  const [first, second] = values;
  const known = first !== null && second !== null && first !== second && !kNeither.has(name);
  const less = known && first < second ? 0 : 1;
  return { name, of, values, better: !known ? null : kMoreIsBetter.has(name) ? (less === 0 ? 1 : 0) : less };
}

export interface Result {
  readonly job: Job;
  readonly figures: ReportFigures;
}

export function compareRows(a: Result, b: Result): readonly CompareRow[] {
  const [one, two] = [a.job.summary, b.job.summary];
  const counts = [
    row('quads', 'count', one?.quads, two?.quads),
    row('strips', 'count', one?.strips, two?.strips),
    row('pieces', 'count', one?.pieces, two?.pieces),
    row('sheets', 'count', one?.sheets, two?.sheets),
    row('time', 'count', one?.estimatedS, two?.estimatedS),
    row('cylinders', 'count', a.figures.facts.cylinders, b.figures.facts.cylinders),
    row('largest', 'count', a.figures.foliation?.largest, b.figures.foliation?.largest),
    row('density', 'count', a.figures.facts.densityPercent, b.figures.facts.densityPercent),
  ];
  const quality = a.figures.quality.flatMap(({ name, average, largest }) => {
    const other = b.figures.quality.find((candidate) => candidate.name === name);
    return [row(name, 'average', average, other?.average), row(name, 'most', largest, other?.largest)];
  });
  return [...counts, ...quality].filter(({ values }) => values[0] !== null || values[1] !== null);
}

type Params = Readonly<Record<string, unknown>>;

function leaves(params: unknown, path: string): readonly (readonly [string, string])[] {
  if (typeof params !== 'object' || params === null || Array.isArray(params)) return [[path, JSON.stringify(params)]];
  return Object.entries(params).flatMap(([key, value]) => leaves(value, path === '' ? key : `${path}.${key}`));
}

// The parameters in which they differ: path, and what each says.
export function differingParams(a: Params, b: Params): readonly (readonly [string, string, string])[] {
  const [one, two] = [new Map(leaves(a, '')), new Map(leaves(b, ''))];
  return [...new Set([...one.keys(), ...two.keys()])]
    .filter((path) => one.get(path) !== two.get(path))
    .sort()
    .map((path) => [path, one.get(path) ?? '', two.get(path) ?? '']);
}
