// Places picked on a surface, as text that can be typed as well: vertices by their numbers in the file.

import { type FoliationMode, type PantsSource, usesPants, usesPlaces } from './foliation_choices.ts';

export const kPickTools = ['corners', 'poles', 'places', 'holes', 'loops', 'sources', 'sinks', 'weights'] as const;
export type PickTool = (typeof kPickTools)[number];

// corners, poles, places: "12, 40"; holes: "12:5, 40:8" (vertex and radius in mm); loops: "1 2 3; 7 8 9";
// sources, sinks: numbers of boundary loops; weights: numbers above 0.
export type Picks = Readonly<Record<PickTool, string>>;

export const kNoPicks: Picks = { corners: '', poles: '', places: '', holes: '', loops: '', sources: '', sinks: '', weights: '' };

// Which places mean something in a mode.
export function toolsFor(mode: FoliationMode, pants: PantsSource): readonly PickTool[] {
  return kPickTools.filter((tool) => {
    if (tool === 'corners') return mode === 'disk';
    if (tool === 'poles') return mode === 'sphere-polar';
    if (tool === 'places') return usesPlaces(mode);
    if (tool === 'loops') return usesPants(mode) && pants === 'user';
    if (tool === 'weights') return usesPants(mode);
    if (tool === 'sources' || tool === 'sinks') return mode === 'one-form';
    return true;
  });
}

function words(typed: string): readonly string[] {
  return typed.split(/[\s,]+/).filter((word) => word !== '');
}

// The different whole numbers that were typed, or null where it is no list of them.
export function numbersIn(typed: string): readonly number[] | null {
  const all = words(typed);
  const numbers = all.map(Number);
  return all.every((word) => /^\d{1,9}$/.test(word)) && new Set(numbers).size === numbers.length ? numbers : null;
}

export interface Hole {
  readonly vertex: number;
  readonly radiusMm: number;
}

export function holesIn(typed: string): readonly Hole[] | null {
  const holes = typed.split(/[\s,;]+/).filter((word) => word !== '').map((word): Hole | null => {
    const match = /^(\d{1,9}):(\d+(?:\.\d+)?)$/.exec(word);
    return match !== null && Number(match[2]) > 0 ? { vertex: Number(match[1]), radiusMm: Number(match[2]) } : null;
  });
  return holes.every((hole): hole is Hole => hole !== null) ? holes : null;
}

export function loopsIn(typed: string): readonly (readonly number[])[] | null {
  const loops = typed.split(';').filter((part) => part.trim() !== '').map(numbersIn);
  return loops.every((loop): loop is readonly number[] => loop !== null && loop.length >= 3) ? loops : null;
}

function weightsIn(typed: string): readonly number[] | null {
  const weights = words(typed).map(Number);
  return weights.every((weight) => Number.isFinite(weight) && weight > 0) ? weights : null;
}

function toolFault(tool: PickTool, typed: string): boolean {
  if (typed.trim() === '') return false;
  if (tool === 'holes') return holesIn(typed) === null;
  if (tool === 'loops') return loopsIn(typed) === null;
  if (tool === 'weights') return weightsIn(typed) === null;
  const numbers = numbersIn(typed);
  const wanted = tool === 'corners' ? 4 : tool === 'poles' ? 2 : null;
  return numbers === null || (wanted !== null && numbers.length !== wanted);
}

export function pickFault(picks: Picks, mode: FoliationMode, pants: PantsSource): PickTool | null {
  return toolsFor(mode, pants).find((tool) => toolFault(tool, picks[tool])) ?? null;
}

type Params = Readonly<Record<string, unknown>>;

// The part of `foliation` that the picks stand for. Only for picks without fault.
export function pickParams(picks: Picks, mode: FoliationMode, pants: PantsSource): Params {
  const tools = toolsFor(mode, pants).filter((tool) => picks[tool].trim() !== '');
  const params: Record<string, unknown> = {};
  for (const tool of tools) {
    const typed = picks[tool];
    if (tool === 'places') params['singularities'] = (numbersIn(typed) ?? []).map((near) => ({ near }));
    else if (tool === 'holes') {
      params['punctures'] = (holesIn(typed) ?? []).map(({ vertex, radiusMm }) => ({ vertex, radius_mm: radiusMm }));
    } else if (tool === 'loops') params['loops'] = loopsIn(typed);
    else if (tool === 'weights') params['weights'] = weightsIn(typed);
    else params[tool] = numbersIn(typed);
  }
  return params;
}

function listText(value: unknown, each: (one: unknown) => string | null, between = ', '): string {
  if (!Array.isArray(value)) return '';
  const parts = value.map(each);
  return parts.includes(null) ? '' : parts.join(between);
}

const numberText = (one: unknown): string | null => (typeof one === 'number' ? String(one) : null);
const at = (one: unknown, key: string): unknown => (typeof one === 'object' && one !== null ? (one as Params)[key] : undefined);

// The way back. What was said in another form than this one writes is dropped.
export function picksOf(foliation: Params): Picks {
  return {
    corners: listText(foliation['corners'], numberText),
    poles: listText(foliation['poles'], numberText),
    places: listText(foliation['singularities'], (one) => numberText(at(one, 'near'))),
    holes: listText(foliation['punctures'], (one) => {
      const [vertex, radius] = [numberText(at(one, 'vertex')), numberText(at(one, 'radius_mm'))];
      return vertex === null || radius === null ? null : `${vertex}:${radius}`;
    }),
    loops: listText(foliation['loops'], (one) => listText(one, numberText, ' ') || null, '; '),
    sources: listText(foliation['sources'], numberText),
    sinks: listText(foliation['sinks'], numberText),
    weights: listText(foliation['weights'], numberText),
  };
}

// What a click on a vertex, or on boundary loop `loop` beside it, makes of the typed text.
export function picked(tool: PickTool, typed: string, click: { readonly vertex: number; readonly loop: number | null; readonly radiusMm: number }): string {
  const { vertex, loop, radiusMm } = click;
  const toggled = (number: number, most = Infinity): string => {
    const now = numbersIn(typed) ?? [];
    const next = now.includes(number) ? now.filter((one) => one !== number) : [...now, number];
    return next.slice(-most).join(', ');
  };
  if (tool === 'weights') return typed;
  if (tool === 'sources' || tool === 'sinks') return loop === null ? typed : toggled(loop);
  if (tool === 'corners') return toggled(vertex, 4);
  if (tool === 'poles') return toggled(vertex, 2);
  if (tool === 'places') return toggled(vertex);
  if (tool === 'holes') {
    const now = holesIn(typed) ?? [];
    const kept = now.filter((hole) => hole.vertex !== vertex);
    const next = kept.length < now.length ? kept : [...now, { vertex, radiusMm }];
    return next.map((hole) => `${hole.vertex}:${hole.radiusMm}`).join(', ');
  }
  // A loop grows point by point; its first point again closes it.
  const parts = typed.split(';').map((part) => part.trim());
  const last = numbersIn(parts.at(-1) ?? '') ?? [];
  const closes = last.length >= 3 && last[0] === vertex;
  if (closes) return `${typed}; `;
  return [...parts.slice(0, -1), [...last.filter((one) => one !== vertex), vertex].join(' ')].join('; ');
}
