// A job's way through the computation, as a row of steps.

import type { Job } from '../api/types.ts';

// In the order in which the computation reports them.
export const kStages = ['read', 'repair', 'foliation', 'quads', 'strips', 'nest', 'toolpath', 'package'] as const;
export type StageName = (typeof kStages)[number];

export interface Stage {
  readonly name: StageName;
  readonly state: 'waiting' | 'running' | 'done' | 'failed';
  readonly fraction: number;
}

// How far the whole computation is, between 0 and 1: stages count alike.
export function wholeFraction(job: Job): number {
  const at = kStages.findIndex((stage) => stage === job.progress.stage);
  return at < 0 ? 0 : (at + job.progress.fraction) / kStages.length;
}

export function stagesOf(job: Job): readonly Stage[] {
  const finished = job.state === 'ready' || job.state === 'done';
  const at = kStages.indexOf(job.progress.stage as StageName);
  const stopped = job.state === 'failed' || job.state === 'cancelled';
  return kStages.map((name, index): Stage => {
    if (finished || index < at) return { name, state: 'done', fraction: 1 };
    if (index > at || job.state === 'queued') return { name, state: 'waiting', fraction: 0 };
    return { name, state: stopped ? 'failed' : 'running', fraction: job.progress.fraction };
  });
}
