// How much of a sheet is burnt: the program's moves up to the last line the machine acknowledged.

import type { CutProgress } from '../api/types.ts';
import type { CutProgram, Move } from '../lib/gcode.ts';
import { pathData } from './sheets.ts';

// Finished stretches are drawn once and never touched again; only the last one grows.
const kChunk = 200;

export interface BurnPlan {
  readonly program: CutProgram;
  readonly chunks: readonly string[]; // Path data of every kChunk moves, whole.
}

export interface Burnt {
  readonly chunks: readonly string[];
  readonly growing: string;
  readonly beam: readonly [number, number] | null; // Where the head is thought to be.
}

// Moves that follow on from each other share one stroke.
export function burnPath(moves: readonly Move[]): string {
  let data = '';
  let dark = true;
  for (const move of moves) {
    if (move.burns) data += dark ? pathData(move.points) : pathData(move.points).replace(/^M[^L]*/, '');
    dark = !move.burns;
  }
  return data;
}

export function planBurn(program: CutProgram): BurnPlan {
  const chunks: string[] = [];
  for (let at = 0; at + kChunk <= program.moves.length; at += kChunk) {
    chunks.push(burnPath(program.moves.slice(at, at + kChunk)));
  }
  return { program, chunks };
}

// How many moves are done. Lines are counted as the sender counts them: those that hold a command, or
// all lines of the file; `linesTotal` tells which.
export function movesDone(program: CutProgram, progress: CutProgress): number {
  const { linesTotal, linesAcknowledged } = progress;
  const bySent = linesTotal !== program.lines;
  const total = bySent ? program.sentLines : program.lines;
  const scale = linesTotal > 0 && linesTotal !== total ? total / linesTotal : 1;
  const reached = linesAcknowledged * scale;
  let [low, high] = [0, program.moves.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    const move = program.moves[middle];
    const line = move === undefined ? Infinity : bySent ? move.sent : move.line;
    if (line <= reached) low = middle + 1;
    else high = middle;
  }
  return low;
}

export function burntSoFar(plan: BurnPlan, progress: CutProgress): Burnt {
  return burntAfter(plan, movesDone(plan.program, progress));
}

function burntAfter(plan: BurnPlan, done: number): Burnt {
  const whole = Math.floor(done / kChunk);
  return {
    chunks: plan.chunks.slice(0, whole),
    growing: burnPath(plan.program.moves.slice(whole * kChunk, done)),
    beam: plan.program.moves[done - 1]?.points.at(-1) ?? null,
  };
}

// The part of a move that is done after `share` of its length.
function partOf(move: Move, share: number): Move {
  const lengths = move.points.map((to, index) => {
    const from = move.points[index - 1] ?? to;
    return Math.hypot(to[0] - from[0], to[1] - from[1]);
  });
  let left = share * lengths.reduce((sum, length) => sum + length, 0);
  const points: (readonly [number, number])[] = [];
  for (const [index, to] of move.points.entries()) {
    const from = move.points[index - 1] ?? to;
    const length = lengths[index] ?? 0;
    if (length > left) {
      const at = length === 0 ? 0 : left / length;
      points.push([from[0] + at * (to[0] - from[0]), from[1] + at * (to[1] - from[1])]);
      break;
    }
    left -= length;
    points.push(to);
  }
  return { ...move, points };
}

// What is burnt `seconds` into the program, to the very point.
export function burntAt(plan: BurnPlan, seconds: number): Burnt & { readonly line: number } {
  const { moves } = plan.program;
  let [low, high] = [0, moves.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((moves[middle]?.endS ?? Infinity) <= seconds) low = middle + 1;
    else high = middle;
  }
  const whole = burntAfter(plan, low);
  const move = moves[low];
  if (move === undefined) return { ...whole, line: plan.program.lines };
  const part = partOf(move, (seconds - move.startS) / Math.max(1e-9, move.endS - move.startS));
  const kept = moves.slice(whole.chunks.length * kChunk, low);
  return { ...whole, growing: burnPath([...kept, part]), beam: part.points.at(-1) ?? whole.beam, line: move.line };
}
