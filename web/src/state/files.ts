// A package's files as they are listed: each by itself, those of a sheet together.

import type { Artifact } from '../api/types.ts';

export interface FileRow {
  readonly sheet: number | null;
  readonly files: readonly Artifact[];
}

// "sheets/sheet-012.svg" -> 12
function sheetOf(path: string): number | null {
  const match = /^sheets\/sheet-(\d+)\./.exec(path);
  return match === null ? null : Number(match[1]);
}

export function ending(path: string): string {
  return path.slice(path.lastIndexOf('.') + 1);
}

export function fileRows(artifacts: readonly Artifact[]): readonly FileRow[] {
  const single: FileRow[] = [];
  const sheets = new Map<number, Artifact[]>();
  for (const file of artifacts) {
    const sheet = sheetOf(file.path);
    if (sheet === null) single.push({ sheet, files: [file] });
    else sheets.set(sheet, [...(sheets.get(sheet) ?? []), file]);
  }
  const ordered = [...sheets].sort(([a], [b]) => a - b);
  return [...single, ...ordered.map(([sheet, files]) => ({ sheet, files }))];
}
