// What a draft comes to, before anything is computed: from the surface's area alone. Both families cover
// the surface once, in strips of the chosen width.

import type { Material } from '../api/types.ts';
import type { MeshLook } from '../mesh/look.ts';

export interface Estimate {
  readonly sizeMm: readonly [number, number, number];
  readonly strips: number;
  readonly sheets: number;
  readonly laserS: number;
  readonly weightG: number;
}

const kDensity = 0.62; // Of sheets, as the nesting search reaches it with strips.
const kCutPerStripMm = 2.25; // Both long sides and the ends, per mm of strip.
const kMarksPerStripMm = 1.1; // Ticks and labels, at about twice the feed of cutting.
const kWayShare = 0.15; // Of the time, for moving without beam.
const kStandard = { widthMm: 600, heightMm: 400, feed: 1200, passes: 1, weight: 160 };

// How many cylinders the surface falls into: as many as pairs of pants have seams.
function cylinders({ genus, boundaryLoops, components }: MeshLook): number {
  const handles = genus ?? 0;
  return Math.max(1, components, handles === 1 && boundaryLoops === 0 ? 1 : 3 * handles - 3 * components + 2 * boundaryLoops);
}

function familyOf(material: Material | undefined): typeof kStandard {
  const [sheet] = material?.sheets ?? [];
  return {
    widthMm: sheet?.widthMm ?? kStandard.widthMm,
    heightMm: sheet?.heightMm ?? kStandard.heightMm,
    feed: material?.cut.feedMmPerMin ?? kStandard.feed,
    passes: material?.cut.passes ?? kStandard.passes,
    weight: material?.weightGPerM2 ?? kStandard.weight,
  };
}

// `scale` turns units of the file into mm.
export function scaleOf(look: MeshLook, longestMm: number | null): number {
  const longest = Math.max(...look.sizeMm);
  return longestMm === null || longest === 0 ? 1 : longestMm / longest;
}

export function estimate(look: MeshLook, scale: number, stripMm: number, weft?: Material, warp?: Material): Estimate {
  const area = look.area * scale * scale;
  const length = area / stripMm; // Of one family's strips together.
  const each = 0.95 * Math.sqrt(area / cylinders(look));
  const families = [familyOf(weft), familyOf(warp)];
  const sum = (of: (family: typeof kStandard) => number): number => families.reduce((total, family) => total + of(family), 0);
  const beam = (family: typeof kStandard): number =>
    (60 * length * (kCutPerStripMm * family.passes + kMarksPerStripMm / 2)) / family.feed;
  return {
    sizeMm: [look.sizeMm[0] * scale, look.sizeMm[1] * scale, look.sizeMm[2] * scale],
    strips: Math.max(2, Math.round((2 * length) / each)),
    sheets: sum((family) => Math.ceil(area / (kDensity * family.widthMm * family.heightMm))),
    laserS: sum(beam) * (1 + kWayShare),
    weightG: sum((family) => (area / 1e6) * family.weight),
  };
}
