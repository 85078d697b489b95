// The moves of an assembly gathered into steps that a person ticks off: joints on the table, a base of
// strips side by side, one strip woven in, joints between regions. Every move is in exactly one step.

import type { Assembly, AssemblyMove, JointMove, LayMove, MoveCrossing } from '../api/assembly_file.ts';

export type StepKind = 'table' | 'base' | 'weave' | 'joints';

export interface Step {
  readonly kind: StepKind;
  readonly region: number;
  readonly lays: readonly LayMove[];
  readonly joints: readonly JointMove[];
  readonly strips: readonly string[]; // Those that the step is about.
}

const kMostTableJoints = 36;
const kMostJoints = 18;
const kMostBase = 60;

const isLay = (move: AssemblyMove): move is LayMove => move.kind === 'lay' || move.kind === 'thread';

interface Draft {
  readonly kind: StepKind;
  readonly region: number;
  readonly lays: LayMove[];
  readonly joints: JointMove[];
}

class Planner {
  readonly steps: Draft[] = [];

  table(joints: readonly JointMove[]): void {
    for (let at = 0; at < joints.length; at += kMostTableJoints) {
      const part = joints.slice(at, at + kMostTableJoints);
      this.steps.push({ kind: 'table', region: part[0]?.region ?? 0, lays: [], joints: part });
    }
  }

  add(move: AssemblyMove): void {
    if (isLay(move)) this.lay(move);
    else this.join(move);
  }

  private last(kind: StepKind, region: number): Draft | null {
    const last = this.steps.at(-1);
    return last?.kind === kind && last.region === region ? last : null;
  }

  private start(kind: StepKind, region: number): Draft {
    const step: Draft = { kind, region, lays: [], joints: [] };
    this.steps.push(step);
    return step;
  }

  private lay(move: LayMove): void {
    if (move.crossings.length > 0) {
      this.start('weave', move.region).lays.push(move);
      return;
    }
    const open = this.last('base', move.region);
    const step = open !== null && open.lays.length < kMostBase ? open : this.start('base', move.region);
    step.lays.push(move);
  }

  // A joint of the strip that was just woven belongs to its step.
  private join(move: JointMove): void {
    const woven = this.last('weave', move.region);
    if (woven?.lays.some((laid) => laid.strip === move.strip)) {
      woven.joints.push(move);
      return;
    }
    const open = this.last('joints', move.region);
    const step = open !== null && open.joints.length < kMostJoints ? open : this.start('joints', move.region);
    step.joints.push(move);
  }
}

export function planSteps(assembly: Assembly): readonly Step[] {
  const planner = new Planner();
  let region = -1;
  for (const move of assembly.moves) {
    if (move.region !== region) {
      region = move.region;
      const isTable = (one: AssemblyMove): one is JointMove => !isLay(one) && one.onTable && one.region === region;
      planner.table(assembly.moves.filter(isTable));
    }
    if (isLay(move) || !move.onTable) planner.add(move);
  }
  return planner.steps.map((step) => {
    const moves = step.lays.length > 0 ? step.lays : step.joints;
    return { ...step, strips: [...new Set(moves.map((move) => move.strip))] };
  });
}

// The strips that lie already when step `at` begins.
export function laidBefore(steps: readonly Step[], at: number): ReadonlySet<string> {
  return new Set(steps.slice(0, at).flatMap((step) => step.lays.map((move) => move.strip)));
}

// "W1–W5, W7": ids that count up or down by one are put together.
export function idRanges(ids: readonly string[]): string {
  const parsed = ids.map((id) => /^(\D*)(\d+)$/.exec(id));
  const parts: string[] = [];
  for (let at = 0; at < ids.length; ) {
    let end = at;
    const number = (k: number): number => Number(parsed[k]?.[2]);
    const by = number(at + 1) - number(at);
    const goesOn = (k: number): boolean =>
      parsed[k]?.[1] !== undefined && parsed[k]?.[1] === parsed[at]?.[1] && number(k) - number(k - 1) === by;
    if (Math.abs(by) === 1) while (end + 1 < ids.length && goesOn(end + 1)) end += 1;
    if (end - at >= 2) parts.push(`${ids[at]}–${ids[end]}`);
    else parts.push(...ids.slice(at, end + 1));
    at = end + 1;
  }
  return parts.join(', ');
}

// Crossings that follow each other and go the same way.
export interface CrossingRun {
  readonly way: MoveCrossing['way'];
  readonly strips: readonly string[];
}

export function crossingRuns(crossings: readonly MoveCrossing[]): readonly CrossingRun[] {
  const runs: { way: MoveCrossing['way']; strips: string[] }[] = [];
  for (const { way, strip } of crossings) {
    const last = runs.at(-1);
    if (last?.way === way) last.strips.push(strip);
    else runs.push({ way, strips: [strip] });
  }
  return runs;
}

// How far someone has got: steps done, and the crossing of the step at hand.
export interface GuideProgress {
  readonly step: number; // The one at hand; the number of steps when all are done.
  readonly crossing: number;
  readonly parts: readonly string[]; // Pieces found and laid ready.
}

export const kAtTheStart: GuideProgress = { step: 0, crossing: 0, parts: [] };

export function readProgress(stored: string | null, steps: number): GuideProgress {
  try {
    const given = JSON.parse(stored ?? 'null') as Partial<GuideProgress> | null;
    const whole = (value: unknown, most: number): number =>
      Number.isInteger(value) ? Math.min(most, Math.max(0, value as number)) : 0;
    const parts = Array.isArray(given?.parts) ? given.parts.filter((id): id is string => typeof id === 'string') : [];
    return { step: whole(given?.step, steps), crossing: whole(given?.crossing, 100_000), parts };
  } catch {
    return kAtTheStart;
  }
}

export type GuideAction =
  | { readonly type: 'next' }
  | { readonly type: 'back' }
  | { readonly type: 'go'; readonly step: number }
  | { readonly type: 'crossing'; readonly at: number }
  | { readonly type: 'part'; readonly id: string }
  | { readonly type: 'restart' };

export function reduceGuide(now: GuideProgress, action: GuideAction, steps: number): GuideProgress {
  const to = (step: number): GuideProgress => ({ ...now, step: Math.min(steps, Math.max(0, step)), crossing: 0 });
  switch (action.type) {
    case 'next':
      return to(now.step + 1);
    case 'back':
      return to(now.step - 1);
    case 'go':
      return to(action.step);
    case 'crossing':
      return { ...now, crossing: Math.max(0, action.at) };
    case 'part':
      return {
        ...now,
        parts: now.parts.includes(action.id) ? now.parts.filter((id) => id !== action.id) : [...now.parts, action.id],
      };
    case 'restart':
      return kAtTheStart;
  }
}
