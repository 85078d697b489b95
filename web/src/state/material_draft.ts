// A material as it is typed into its form, and back.

export const kBeamWorks = ['cut', 'score', 'engrave'] as const;
export type BeamWork = (typeof kBeamWorks)[number];

export interface BeamDraft {
  readonly power: string;
  readonly feed: string;
  readonly passes: string;
}

export interface MaterialDraft {
  readonly name: string;
  readonly colour: string;
  readonly thickness: string;
  readonly weight: string;
  readonly kerf: string;
  readonly width: string; // Of the sheet that is preferred.
  readonly height: string;
  readonly beam: Readonly<Record<BeamWork, BeamDraft>>;
}

type Wire = Readonly<Record<string, unknown>>;

const part = (value: unknown): Wire => (typeof value === 'object' && value !== null ? (value as Wire) : {});
const typed = (value: unknown, otherwise: number): string => String(typeof value === 'number' ? value : otherwise);

const kBeam: Readonly<Record<BeamWork, readonly [number, number]>> = { cut: [60, 1200], score: [20, 2400], engrave: [15, 3000] };

export function materialFields(wire: Wire): MaterialDraft {
  const sheets = Array.isArray(wire['sheets']) ? wire['sheets'] : [];
  const sheet = part(sheets[0]);
  const beam = (work: BeamWork): BeamDraft => {
    const laser = part(wire[work]);
    return {
      power: typed(laser['power_percent'], kBeam[work][0]),
      feed: typed(laser['feed_mm_per_min'], kBeam[work][1]),
      passes: typed(laser['passes'], 1),
    };
  };
  return {
    name: typeof wire['name'] === 'string' ? wire['name'] : '',
    colour: typeof wire['colour'] === 'string' ? wire['colour'] : '#c9a227',
    thickness: typed(wire['thickness_mm'], 0.2),
    weight: typed(wire['weight_g_per_m2'], 160),
    kerf: typed(wire['kerf_mm'], 0.15),
    width: typed(sheet['width_mm'], 600),
    height: typed(sheet['height_mm'], 400),
    beam: { cut: beam('cut'), score: beam('score'), engrave: beam('engrave') },
  };
}

function value(text: string): number {
  const number = Number(text.trim().replace(',', '.'));
  return text.trim() === '' ? Number.NaN : number;
}

// Which field keeps the material from being saved.
export function materialFault(draft: MaterialDraft): string | null {
  if (draft.name.trim() === '') return 'name';
  for (const key of ['thickness', 'weight', 'width', 'height'] as const) if (!(value(draft[key]) > 0)) return key;
  if (!(value(draft.kerf) >= 0)) return 'kerf';
  for (const work of kBeamWorks) {
    const { power, feed, passes } = draft.beam[work];
    if (!(value(power) >= 0 && value(power) <= 100)) return `${work}.power`;
    if (!(value(feed) > 0)) return `${work}.feed`;
    if (!(Number.isInteger(value(passes)) && value(passes) >= 1)) return `${work}.passes`;
  }
  return null;
}

// As the daemon takes it. What the form doesn't show stays as it was. Only for a draft without fault.
export function materialRecord(draft: MaterialDraft, before: Wire): Wire {
  const { id: _id, origin: _origin, ...kept } = before;
  const others = Array.isArray(before['sheets']) ? before['sheets'].slice(1) : [];
  const first = Array.isArray(before['sheets']) ? part(before['sheets'][0]) : {};
  const laser = (work: BeamWork): Wire => ({
    ...part(before[work]),
    power_percent: value(draft.beam[work].power),
    feed_mm_per_min: value(draft.beam[work].feed),
    passes: value(draft.beam[work].passes),
  });
  return {
    ...kept,
    name: draft.name.trim(),
    colour: draft.colour,
    thickness_mm: value(draft.thickness),
    weight_g_per_m2: value(draft.weight),
    kerf_mm: value(draft.kerf),
    sheets: [{ ...first, width_mm: value(draft.width), height_mm: value(draft.height) }, ...others],
    cut: laser('cut'),
    score: laser('score'),
    engrave: laser('engrave'),
  };
}
