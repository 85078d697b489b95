// A sheet as paths to draw: where each piece lies, and what is marked on it. Coordinates stay those of
// the sheet (origin lower left, y up); the view turns the picture over.

import type { Family, Layout, LayoutSheet, Mark, Piece, Placement, Point, Strips } from '../api/package_files.ts';

// Text as it is engraved: left end of its base line, turned counter-clockwise.
export interface Label {
  readonly text: string;
  readonly at: Point;
  readonly angleDeg: number;
  readonly heightMm: number;
}

export interface PieceDrawing {
  readonly piece: string;
  readonly strip: string;
  readonly family: Family;
  readonly outline: string; // SVG path data.
  readonly marks: string;
  readonly labels: readonly Label[];
}

export interface SheetDrawing {
  readonly id: number;
  readonly material: string;
  readonly widthMm: number;
  readonly heightMm: number;
  readonly pieces: readonly PieceDrawing[];
}

// Mirrored first (x → −x), then rotated about the piece's origin, then moved.
export function place(placement: Placement, [px, py]: Point): Point {
  const angle = (placement.rotationDeg * Math.PI) / 180;
  const x = placement.mirrored ? -px : px;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c * x - s * py + placement.xMm, s * x + c * py + placement.yMm];
}

export function pathData(points: readonly Point[]): string {
  return points.map(([x, y], index) => `${index === 0 ? 'M' : 'L'}${x.toFixed(2)} ${y.toFixed(2)}`).join('');
}

function drawLabel(mark: Mark, placement: Placement): Label {
  // A mirrored piece turns its text the other way round; it stays readable on the screen.
  const angleDeg = placement.rotationDeg + (placement.mirrored ? 180 - mark.angleDeg : mark.angleDeg);
  return { text: mark.text, at: place(placement, mark.at), angleDeg, heightMm: mark.heightMm };
}

function drawPiece(piece: Piece, family: Family, placement: Placement): PieceDrawing {
  const put = (points: readonly Point[]): readonly Point[] => points.map((point) => place(placement, point));
  return {
    piece: piece.id,
    strip: piece.strip,
    family,
    outline: `${pathData(put(piece.outline))}Z`,
    marks: piece.marks.map((mark) => pathData(put(mark.path))).join(''),
    labels: piece.marks.filter((mark) => mark.text !== '').map((mark) => drawLabel(mark, placement)),
  };
}

// One drawing per sheet. A placement of a piece that is not there is left out.
export function drawSheets(layout: Layout, strips: Strips): readonly SheetDrawing[] {
  const pieces = new Map(strips.pieces.map((piece) => [piece.id, piece]));
  const families = new Map(strips.strips.map((strip) => [strip.id, strip.family]));
  const draw = (placement: Placement): readonly PieceDrawing[] => {
    const piece = pieces.get(placement.piece);
    const family = piece === undefined ? undefined : families.get(piece.strip);
    return piece === undefined || family === undefined ? [] : [drawPiece(piece, family, placement)];
  };
  return layout.sheets.map((sheet: LayoutSheet) => ({
    id: sheet.id,
    material: sheet.material,
    widthMm: sheet.widthMm,
    heightMm: sheet.heightMm,
    pieces: sheet.placements.flatMap(draw),
  }));
}
