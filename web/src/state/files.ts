// A package's files as they are listed: each by itself, those of a sheet together, and the pages for scissors.

import type { Artifact } from '../api/types.ts';

export interface FileRow {
  readonly sheet: number | null;
  readonly pages?: true; // The pages for scissors, in their order.
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
  const pages = artifacts.filter((file) => file.path.startsWith('scissors/'));
  for (const file of artifacts) {
    if (pages.includes(file)) continue;
    const sheet = sheetOf(file.path);
    if (sheet === null) single.push({ sheet, files: [file] });
    else sheets.set(sheet, [...(sheets.get(sheet) ?? []), file]);
  }
  const ordered = [...sheets].sort(([a], [b]) => a - b);
  const scissors: readonly FileRow[] = pages.length > 0 ? [{ sheet: null, pages: true, files: pages }] : [];
  return [...single, ...scissors, ...ordered.map(([sheet, files]) => ({ sheet, files }))];
}
