// How hands put a job's strips together: the moves of weave.json (fab/weave/README.md), checked.

import { flag, list, number, oneOf, optional, PayloadError, type Reader, record, text } from '../lib/check.ts';
import type { Family } from './package_files.ts';

export type CrossingWay = 'over' | 'under' | 'threaded';

export interface MoveCrossing {
  readonly quad: number;
  readonly strip: string; // The one that is crossed.
  readonly way: CrossingWay; // Of the strip that is laid.
}

export interface LayMove {
  readonly kind: 'lay' | 'thread';
  readonly region: number;
  readonly strip: string;
  readonly pieces: readonly string[];
  readonly crossings: readonly MoveCrossing[]; // In the order in which they are made.
}

export interface JointMove {
  readonly kind: 'close' | 'join';
  readonly region: number;
  readonly strip: string;
  readonly piece: string;
  readonly onto: string; // Empty: several.
  readonly atStart: boolean;
  readonly onTable: boolean;
  readonly quad: number;
  readonly tucked: number; // Crossing strips under which the tab is pushed.
}

export type AssemblyMove = LayMove | JointMove;

export interface AssemblyRegion {
  readonly cylinders: readonly number[];
  readonly part: number;
  readonly base: Family;
}

export interface Assembly {
  readonly regions: readonly AssemblyRegion[];
  readonly moves: readonly AssemblyMove[];
}

export const kNoAssembly: Assembly = { regions: [], moves: [] };

const readCrossing: Reader<MoveCrossing> = (value, path) => {
  if (!Array.isArray(value)) throw new PayloadError(`${path}: expected [quad, strip, way]`);
  return {
    quad: number(value[0], `${path}/0`),
    strip: text(value[1], `${path}/1`),
    way: oneOf<CrossingWay>('over', 'under', 'threaded')(value[2], `${path}/2`),
  };
};

const readMove: Reader<AssemblyMove> = (value, path) => {
  const get = record(value, path);
  const kind = get('kind', oneOf('lay', 'thread', 'close', 'join'));
  const common = { region: get('region', optional(number, 0)), strip: get('strip', text) };
  if (kind === 'lay' || kind === 'thread') {
    return {
      kind,
      ...common,
      pieces: get('pieces', optional(list(text), [])),
      crossings: get('crossings', optional(list(readCrossing), [])),
    };
  }
  return {
    kind,
    ...common,
    piece: get('piece', text),
    onto: get('onto', optional(text, '')),
    atStart: get('end', optional(text, 'end')) === 'start',
    onTable: get('where', optional(text, 'in-place')) === 'table',
    quad: get('crossing', optional(number, 0)),
    tucked: get('tucked', optional((v, at) => (typeof v === 'boolean' ? Number(flag(v, at)) : number(v, at)), 0)),
  };
};

const readRegion: Reader<AssemblyRegion> = (value, path) => {
  const get = record(value, path);
  return {
    cylinders: get('cylinders', optional(list(number), [])),
    part: get('part', optional(number, 0)),
    base: get('base', optional(oneOf<Family>('weft', 'warp'), 'warp')),
  };
};

// Packages of an older make have no moves.
export const readAssembly: Reader<Assembly> = (value, path) => {
  const get = record(value, path);
  return {
    regions: get('regions', optional(list(readRegion), [])),
    moves: get('moves', optional(list(readMove), [])),
  };
};
