// How much longer a computation takes, from how it has gone so far. The stages' shares of the whole are
// those that the computation itself reckons with; the nesting search runs for a time that was asked for.

import type { Job } from '../api/types.ts';
import { kStages, type StageName } from './stages.ts';

const kShare: Readonly<Record<StageName, number>> = {
  read: 0.03, repair: 0.05, foliation: 0.32, quads: 0.15, strips: 0.1, nest: 0.2, toolpath: 0.08, package: 0.07,
};

// When a job was first seen at work, and how far it was then.
export interface Watched {
  readonly sinceMs: number;
  readonly share: number;
}

// Between 0 and 1, stages counted as long as they usually take.
export function workDone(job: Job): number {
  const at = kStages.findIndex((stage) => stage === job.progress.stage);
  if (at < 0) return 0;
  const before = kStages.slice(0, at).reduce((sum, stage) => sum + kShare[stage], 0);
  return before + kShare[kStages[at] ?? 'read'] * job.progress.fraction;
}

// Null where it would be a guess out of the blue.
export function secondsLeft(job: Job, watched: Watched, nowMs: number): number | null {
  const done = workDone(job);
  const gained = done - watched.share;
  const spentS = (nowMs - watched.sinceMs) / 1000;
  if (spentS < 2 || gained < 0.02) return null;
  return ((1 - done) / gained) * spentS;
}
