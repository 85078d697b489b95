// The job that is about to be made: files dropped on the page, and how they are to be woven.

import { stem } from '../lib/format.ts';

export const kPatterns = ['plain', 'twill-2x2', 'double-warp', 'double-weft', 'satin-5', 'basket-2x2'] as const;
export type Pattern = (typeof kPatterns)[number];

// How the surface is foliated: the words of the job parameters, the daemon's own choice first.
export const kModes = [
  'auto',
  'pants',
  'one-form',
  'disk',
  'annulus',
  'torus',
  'sphere-pillowcase',
  'sphere-polar',
] as const;
export type FoliationMode = (typeof kModes)[number];
export const kPantsSources = ['reeb', 'handle-loops', 'tunnel-loops'] as const;
export type PantsSource = (typeof kPantsSources)[number];
export const kSweepFunctions = ['auto', 'harmonic', 'x', 'y', 'z', 'fiedler'] as const;
export type SweepFunction = (typeof kSweepFunctions)[number];
export const kPunctures = ['auto', 'none'] as const;
export type Punctures = (typeof kPunctures)[number];
export const kComponents = ['each', 'largest'] as const;
export type Components = (typeof kComponents)[number];

export interface DraftFile {
  readonly key: number;
  readonly file: File;
  readonly name: string;
}

export interface Draft {
  readonly files: readonly DraftFile[];
  readonly longestSideMm: string; // As typed.
  readonly stripWidthMm: string;
  readonly pattern: Pattern;
  readonly weft: string; // Material ids; empty: the daemon's choice.
  readonly warp: string;
  readonly mode: FoliationMode;
  readonly pants: PantsSource; // These two count in the modes of usesPants() alone.
  readonly sweep: SweepFunction;
  readonly punctures: Punctures;
  readonly components: Components;
  readonly near: string; // As typed: vertices near which singular points are wanted.
}

export const kNewDraft: Draft = {
  files: [],
  longestSideMm: '300',
  stripWidthMm: '10',
  pattern: 'plain',
  weft: '',
  warp: '',
  mode: 'auto',
  pants: 'reeb',
  sweep: 'auto',
  punctures: 'auto',
  components: 'each',
  near: '',
};

// Whether the surface may be cut into pairs of pants in this mode.
export function usesPants(mode: FoliationMode): boolean {
  return mode === 'auto' || mode === 'pants';
}

// Whether the leaves can have singular points in this mode.
export function usesPlaces(mode: FoliationMode): boolean {
  return mode !== 'disk' && mode !== 'annulus' && mode !== 'torus';
}

export type DraftAction =
  | { readonly type: 'add'; readonly files: readonly File[] }
  | { readonly type: 'put-back'; readonly files: readonly DraftFile[] }
  | { readonly type: 'drop'; readonly key: number }
  | { readonly type: 'rename'; readonly key: number; readonly name: string }
  | { readonly type: 'set'; readonly values: Partial<Omit<Draft, 'files'>> }
  | { readonly type: 'clear' };

function withFiles(draft: Draft, files: readonly Omit<DraftFile, 'key'>[]): Draft {
  const next = Math.max(0, ...draft.files.map((entry) => entry.key)) + 1;
  const added = files.map(({ file, name }, index) => ({ key: next + index, file, name }));
  return { ...draft, files: [...draft.files, ...added] };
}

export function reduceDraft(draft: Draft, action: DraftAction): Draft {
  switch (action.type) {
    case 'add':
      return withFiles(draft, action.files.map((file) => ({ file, name: stem(file.name) })));
    case 'put-back':
      return withFiles(draft, action.files);
    case 'drop':
      return { ...draft, files: draft.files.filter((entry) => entry.key !== action.key) };
    case 'rename':
      return {
        ...draft,
        files: draft.files.map((entry) => (entry.key === action.key ? { ...entry, name: action.name } : entry)),
      };
    case 'set':
      return { ...draft, ...action.values };
    case 'clear':
      return { ...draft, files: [] };
  }
}

export type DraftFault = 'longest-side' | 'strip-width' | 'strip-too-wide' | 'near';

function positive(typed: string): number | null {
  const value = Number(typed.trim().replace(',', '.'));
  return typed.trim() !== '' && Number.isFinite(value) && value > 0 ? value : null;
}

// The vertices typed, or null where that is no list of different numbers.
function verticesOf(typed: string): readonly number[] | null {
  const words = typed.split(/[\s,;]+/).filter((word) => word !== '');
  const vertices = words.map(Number);
  const isList = words.every((word) => /^\d{1,9}$/.test(word)) && new Set(vertices).size === vertices.length;
  return isList ? vertices : null;
}

export function draftFault(draft: Draft): DraftFault | null {
  const longest = positive(draft.longestSideMm);
  const strip = positive(draft.stripWidthMm);
  if (longest === null) return 'longest-side';
  if (strip === null) return 'strip-width';
  if (strip > longest / 3) return 'strip-too-wide';
  return usesPlaces(draft.mode) && verticesOf(draft.near) === null ? 'near' : null;
}

// What differs from the daemon's own choice.
function foliationParams(draft: Draft): Readonly<Record<string, unknown>> {
  const cut = usesPants(draft.mode);
  const near = usesPlaces(draft.mode) ? (verticesOf(draft.near) ?? []) : [];
  return {
    ...(draft.mode === 'auto' ? {} : { mode: draft.mode }),
    ...(cut && draft.pants !== 'reeb' ? { pants: draft.pants } : {}),
    ...(cut && draft.sweep !== 'auto' ? { function: draft.sweep } : {}),
    ...(draft.punctures === 'auto' ? {} : { punctures: draft.punctures }),
    ...(draft.components === 'each' ? {} : { components: draft.components }),
    ...(near.length === 0 ? {} : { singularities: near.map((vertex) => ({ near: vertex })) }),
  };
}

// The job parameters that `draft` stands for. Only for a draft without fault.
export function draftParams(draft: Draft): Readonly<Record<string, unknown>> {
  const material = {
    ...(draft.weft === '' ? {} : { weft: draft.weft }),
    ...(draft.warp === '' ? {} : { warp: draft.warp }),
  };
  const foliation = foliationParams(draft);
  return {
    scale: { longest_side_mm: positive(draft.longestSideMm) },
    ...(Object.keys(foliation).length === 0 ? {} : { foliation }),
    grid: { strip_width_mm: positive(draft.stripWidthMm), may_narrow: true },
    weave: { pattern: draft.pattern },
    ...(Object.keys(material).length === 0 ? {} : { material }),
  };
}

// One repeat of each pattern, rows of weft by columns of warp: 1 where warp lies on top.
export const kRepeats: Readonly<Record<Pattern, readonly (readonly number[])[]>> = {
  plain: [[0, 1], [1, 0]],
  'twill-2x2': [[1, 1, 0, 0], [0, 1, 1, 0], [0, 0, 1, 1], [1, 0, 0, 1]],
  'double-warp': [[1, 1, 0, 0], [0, 0, 1, 1]],
  'double-weft': [[1, 0], [1, 0], [0, 1], [0, 1]],
  'satin-5': [[1, 0, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 1], [0, 1, 0, 0, 0], [0, 0, 0, 1, 0]],
  'basket-2x2': [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 1], [0, 0, 1, 1]],
};
