// Which strip goes where: through which quads, onto which sheets. Both ways.

import type { Layout, Strip, Strips } from '../api/package_files.ts';

export interface StripIndex {
  readonly strips: ReadonlyMap<string, Strip>;
  readonly order: readonly string[];
  readonly weftOfQuad: readonly (string | undefined)[];
  readonly warpOfQuad: readonly (string | undefined)[];
  readonly sheetsOfStrip: ReadonlyMap<string, readonly number[]>;
}

export function indexStrips(strips: Strips, layout: Layout): StripIndex {
  const weftOfQuad: (string | undefined)[] = [];
  const warpOfQuad: (string | undefined)[] = [];
  for (const strip of strips.strips) {
    const side = strip.family === 'weft' ? weftOfQuad : warpOfQuad;
    for (const quad of strip.quads) side[quad] = strip.id;
  }
  const stripOfPiece = new Map(strips.pieces.map((piece) => [piece.id, piece.strip]));
  const sheetsOfStrip = new Map<string, number[]>();
  for (const sheet of layout.sheets) {
    for (const { piece } of sheet.placements) {
      const strip = stripOfPiece.get(piece);
      if (strip === undefined) continue;
      const sheets = sheetsOfStrip.get(strip) ?? [];
      if (!sheets.includes(sheet.id)) sheets.push(sheet.id);
      sheetsOfStrip.set(strip, sheets);
    }
  }
  return {
    strips: new Map(strips.strips.map((strip) => [strip.id, strip])),
    order: strips.strips.map((strip) => strip.id),
    weftOfQuad,
    warpOfQuad,
    sheetsOfStrip,
  };
}

// The strip `step` places further on, round the end.
export function neighbourStrip(index: StripIndex, id: string | null, step: number): string | null {
  const count = index.order.length;
  if (count === 0) return null;
  const at = id === null ? -1 : index.order.indexOf(id);
  const next = at < 0 ? (step > 0 ? 0 : count - 1) : (at + step + count) % count;
  return index.order[next] ?? null;
}
