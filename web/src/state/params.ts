// The job parameters that have a plain field in the form: where they stand, what they may be, and what the
// daemon takes if nothing is said. The words for them are in the messages, under the same names.

export type FieldSpec =
  | {
      readonly kind: 'number';
      readonly path: string;
      readonly standard: number | null; // Null: the daemon decides.
      readonly least: number;
      readonly most: number;
      readonly whole?: true;
      readonly unit?: string;
    }
  | { readonly kind: 'choice'; readonly path: string; readonly standard: string; readonly choices: readonly string[] }
  | { readonly kind: 'flag'; readonly path: string; readonly standard: boolean };

const number = (path: string, standard: number | null, least: number, most: number, unit = ''): FieldSpec => ({
  kind: 'number', path, standard, least, most, ...(unit === '' ? {} : { unit }),
});
const whole = (path: string, standard: number | null, least: number, most: number): FieldSpec => ({
  kind: 'number', path, standard, least, most, whole: true,
});
const choice = (path: string, ...choices: readonly string[]): FieldSpec => ({
  kind: 'choice', path, choices, standard: choices[0] ?? '',
});
const flag = (path: string, standard: boolean): FieldSpec => ({ kind: 'flag', path, standard });

export const kGroups = ['grid', 'fit', 'nesting', 'cut', 'output'] as const;
export type Group = (typeof kGroups)[number];

export const kFields: Readonly<Record<Group, readonly FieldSpec[]>> = {
  grid: [
    whole('grid.rows', null, 1, 100_000),
    whole('grid.cols', null, 1, 100_000),
    choice('grid.spacing', 'uniform', 'curvature', 'curvature-area'),
    choice('grid.junctions', 'conforming', 'independent'),
    choice('grid.parity', 'even', 'any'),
    choice('grid.planar', 'off', 'gentle', 'full'),
    flag('grid.even_cells', false),
    whole('weave.max_float', null, 1, 100_000),
  ],
  fit: [
    choice('fit.columns', 'per-cylinder', 'through'),
    choice('fit.joint', 'glue', 'cell', 'slot'),
    number('fit.clearance_mm', 0.2, 0, 100, 'mm'),
    number('fit.tab_mm', 8, 0, 1000, 'mm'),
    number('fit.max_piece_mm', 900, 1, 20_000, 'mm'),
    choice('fit.cell_marks', 'ticks', 'lines', 'none'),
    number('fit.score_deg', 15, 0, 180, '°'),
    number('fit.text_mm', 4, 1, 100, 'mm'),
    flag('fit.crimp', true),
    flag('fit.labels', true),
    flag('fit.weave_marks', true),
  ],
  nesting: [
    number('nesting.time_s', 10, 0.1, 86_400, 's'),
    number('nesting.spacing_mm', 1, 0, 1000, 'mm'),
    number('nesting.margin_mm', 5, 0, 1000, 'mm'),
    choice('nesting.rotation', 'free', '0,180', '0,90,180,270', '0'),
    whole('nesting.seed', 1, 0, 2_000_000_000),
  ],
  cut: [
    number('cut.lead_in_mm', 0, 0, 20, 'mm'),
    number('cut.over_cut_mm', null, 0, 20, 'mm'),
    whole('cut.tabs', 0, 0, 100),
    number('cut.tab_mm', 0.5, 0.05, 5, 'mm'),
    number('cut.heat', 0, 0, 1),
    flag('cut.common_edges', false),
  ],
  output: [
    choice('output.dialect', 'grbl', 'marlin', 'smoothie'),
    choice('output.paper', 'a4', 'a3', 'letter'),
    flag('output.models', true),
  ],
};

const kAll: readonly FieldSpec[] = kGroups.flatMap((group) => kFields[group]);

// What was typed or chosen, by path. What is absent is as the daemon would have it.
export type MoreParams = Readonly<Record<string, string>>;

export function standardText(spec: FieldSpec): string {
  return spec.standard === null ? '' : String(spec.standard);
}

function numberIn(typed: string): number {
  return typed.trim() === '' ? Number.NaN : Number(typed.trim().replace(',', '.'));
}

export function fieldFault(spec: FieldSpec, typed: string | undefined): boolean {
  if (spec.kind !== 'number' || typed === undefined || typed === standardText(spec)) return false;
  if (typed.trim() === '' && spec.standard === null) return false;
  const value = numberIn(typed);
  return !(value >= spec.least && value <= spec.most) || (spec.whole === true && !Number.isInteger(value));
}

// The first field that keeps the job from being sent.
export function moreFault(more: MoreParams): string | null {
  return kAll.find((spec) => fieldFault(spec, more[spec.path]))?.path ?? null;
}

type Tree = Record<string, Record<string, unknown>>;

// Only what differs from the daemon's own choice.
export function moreParams(more: MoreParams): Readonly<Tree> {
  const tree: Tree = {};
  for (const spec of kAll) {
    const typed = more[spec.path];
    if (typed === undefined || typed === standardText(spec) || typed.trim() === '') continue;
    const [group = '', key = ''] = spec.path.split('.');
    const value = spec.kind === 'number' ? numberIn(typed) : spec.kind === 'flag' ? typed === 'true' : typed;
    tree[group] = { ...tree[group], [key]: value };
  }
  return tree;
}

// The way back: what a job's parameters say about the fields.
export function moreOf(params: Readonly<Record<string, unknown>>): MoreParams {
  const more: Record<string, string> = {};
  for (const spec of kAll) {
    const [group = '', key = ''] = spec.path.split('.');
    const part = params[group];
    const value = typeof part === 'object' && part !== null ? (part as Record<string, unknown>)[key] : undefined;
    const fits = spec.kind === 'flag' ? typeof value === 'boolean' : typeof value === 'number' || typeof value === 'string';
    if (fits && String(value) !== standardText(spec) && value !== 'auto') more[spec.path] = String(value);
  }
  return more;
}
