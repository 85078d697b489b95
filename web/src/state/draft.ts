// The job that is about to be made: files dropped on the page, and how they are to be woven.

import { stem } from '../lib/format.ts';
import {
  type Components,
  type FoliationMode,
  kComponents,
  kModes,
  kPantsSources,
  kPunctures,
  kSweepFunctions,
  type PantsSource,
  type Punctures,
  type SweepFunction,
  usesPants,
} from './foliation_choices.ts';
import { moreFault, moreOf, type MoreParams, moreParams } from './params.ts';
import { kNoPicks, pickFault, pickParams, type Picks, picksOf } from './picks.ts';

export const kPatterns = ['plain', 'twill-2x2', 'double-warp', 'double-weft', 'satin-5', 'basket-2x2'] as const;
export type Pattern = (typeof kPatterns)[number];

// New sheets, those at hand before new ones, or nothing but those at hand.
export const kSheetSources = ['new', 'stock', 'only'] as const;
export type SheetSource = (typeof kSheetSources)[number];

export interface DraftFile {
  readonly key: number;
  readonly file: File;
  readonly name: string;
}

interface Again {
  readonly job: string;
  readonly name: string;
  readonly file: string; // Name of its mesh's file.
}

export interface Draft {
  readonly files: readonly DraftFile[];
  readonly again: Again | null; // A job to be woven once more.
  readonly units: 'longest' | 'mm'; // Scaled to a length, or the file's numbers are millimetres.
  readonly longestSideMm: string; // As typed.
  readonly stripWidthMm: string;
  readonly pattern: Pattern;
  readonly weft: string; // Material ids; empty: the daemon's choice.
  readonly warp: string;
  readonly sheets: SheetSource;
  readonly machine: string; // Id of the one it is made for; empty: any.
  readonly mode: FoliationMode;
  readonly pants: PantsSource; // These two count in the modes of usesPants() alone.
  readonly sweep: SweepFunction;
  readonly punctures: Punctures;
  readonly components: Components;
  readonly picks: Picks; // Places on the surface; count for a single file alone.
  readonly more: MoreParams;
}

export const kNewDraft: Draft = {
  files: [],
  again: null,
  units: 'longest',
  longestSideMm: '300',
  stripWidthMm: '10',
  pattern: 'plain',
  weft: '',
  warp: '',
  sheets: 'new',
  machine: '',
  mode: 'auto',
  pants: 'reeb',
  sweep: 'auto',
  punctures: 'auto',
  components: 'each',
  picks: kNoPicks,
  more: {},
};

export type DraftAction =
  | { readonly type: 'add'; readonly files: readonly File[] }
  | { readonly type: 'put-back'; readonly files: readonly DraftFile[] }
  | { readonly type: 'drop'; readonly key: number }
  | { readonly type: 'rename'; readonly key: number; readonly name: string }
  | { readonly type: 'set'; readonly values: Partial<Omit<Draft, 'files' | 'again'>> }
  | ({ readonly type: 'again'; readonly params: Params } & Again)
  | { readonly type: 'preset'; readonly params: Params }
  | { readonly type: 'clear' };

type Params = Readonly<Record<string, unknown>>;

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
    case 'again':
      return { ...draftOf(action.params), again: { job: action.job, name: action.name, file: action.file } };
    case 'preset':
      return { ...draftOf(action.params), files: draft.files, again: draft.again, picks: draft.picks };
    case 'clear':
      return { ...draft, files: [], again: null, picks: kNoPicks };
  }
}

export type DraftFault = 'longest-side' | 'strip-width' | 'strip-too-wide' | 'picks' | 'more';

function positive(typed: string): number | null {
  const value = Number(typed.trim().replace(',', '.'));
  return typed.trim() !== '' && Number.isFinite(value) && value > 0 ? value : null;
}

// Places are those of one surface.
function countingPicks(draft: Draft): Picks {
  return draft.files.length > 1 ? kNoPicks : draft.picks;
}

export function draftFault(draft: Draft): DraftFault | null {
  const longest = positive(draft.longestSideMm);
  const strip = positive(draft.stripWidthMm);
  if (draft.units === 'longest' && longest === null) return 'longest-side';
  if (strip === null) return 'strip-width';
  if (draft.units === 'longest' && longest !== null && strip > longest / 3) return 'strip-too-wide';
  if (pickFault(countingPicks(draft), draft.mode, draft.pants) !== null) return 'picks';
  return moreFault(draft.more) === null ? null : 'more';
}

// What differs from the daemon's own choice.
function foliationParams(draft: Draft): Readonly<Record<string, unknown>> {
  const cut = usesPants(draft.mode);
  return {
    ...(draft.mode === 'auto' ? {} : { mode: draft.mode }),
    ...(cut && draft.pants !== 'reeb' ? { pants: draft.pants } : {}),
    ...(cut && draft.sweep !== 'auto' ? { function: draft.sweep } : {}),
    ...(draft.punctures === 'auto' ? {} : { punctures: draft.punctures }),
    ...(draft.components === 'each' ? {} : { components: draft.components }),
    ...pickParams(countingPicks(draft), draft.mode, draft.pants),
  };
}

function stockParams(sheets: SheetSource): Params {
  if (sheets === 'new') return {};
  return sheets === 'only' ? { stock: 'store', only_stock: true } : { stock: 'store' };
}

// The job parameters that `draft` stands for. Only for a draft without fault.
export function draftParams(draft: Draft): Readonly<Record<string, unknown>> {
  const material = {
    ...(draft.weft === '' ? {} : { weft: draft.weft }),
    ...(draft.warp === '' ? {} : { warp: draft.warp }),
  };
  const foliation = foliationParams(draft);
  const { grid, weave, nesting, output, ...more } = moreParams(draft.more);
  const placing = { ...nesting, ...stockParams(draft.sheets) };
  const made = { ...output, ...(draft.machine === '' ? {} : { device: draft.machine }) };
  return {
    scale: draft.units === 'mm' ? { units: 'mm' } : { longest_side_mm: positive(draft.longestSideMm) },
    ...(Object.keys(foliation).length === 0 ? {} : { foliation }),
    grid: { strip_width_mm: positive(draft.stripWidthMm), may_narrow: true, ...grid },
    weave: { pattern: draft.pattern, ...weave },
    ...(Object.keys(material).length === 0 ? {} : { material }),
    ...(Object.keys(placing).length === 0 ? {} : { nesting: placing }),
    ...(Object.keys(made).length === 0 ? {} : { output: made }),
    ...more,
  };
}

function within(params: Params, group: string, key: string): unknown {
  const part = params[group];
  return typeof part === 'object' && part !== null ? (part as Params)[key] : undefined;
}

function sheetSourceOf(params: Params): SheetSource {
  const stock = within(params, 'nesting', 'stock');
  const wanted = stock === 'store' || (Array.isArray(stock) && stock.length > 0);
  if (!wanted) return 'new';
  return within(params, 'nesting', 'only_stock') === true ? 'only' : 'stock';
}

// The way back: the draft that a job's parameters stand for. What the form has no place for is dropped.
export function draftOf(params: Params): Draft {
  const named = <T extends string>(group: string, key: string, all: readonly T[], otherwise: T): T =>
    all.find((one) => one === within(params, group, key)) ?? otherwise;
  const typed = (group: string, key: string, otherwise: string): string => {
    const value = within(params, group, key);
    return typeof value === 'number' || typeof value === 'string' ? String(value) : otherwise;
  };
  return {
    ...kNewDraft,
    units: within(params, 'scale', 'units') === 'mm' ? 'mm' : 'longest',
    longestSideMm: typed('scale', 'longest_side_mm', kNewDraft.longestSideMm),
    stripWidthMm: typed('grid', 'strip_width_mm', kNewDraft.stripWidthMm),
    pattern: named('weave', 'pattern', kPatterns, 'plain'),
    weft: typed('material', 'weft', ''),
    warp: typed('material', 'warp', ''),
    sheets: sheetSourceOf(params),
    machine: typed('output', 'device', ''),
    mode: named('foliation', 'mode', kModes, 'auto'),
    pants: named('foliation', 'pants', kPantsSources, 'reeb'),
    sweep: named('foliation', 'function', kSweepFunctions, 'auto'),
    punctures: named('foliation', 'punctures', kPunctures, 'auto'),
    components: named('foliation', 'components', kComponents, 'each'),
    picks: picksOf((params['foliation'] ?? {}) as Params),
    more: moreOf(params),
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
