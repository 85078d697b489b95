// The jobs as queue and as history.

import type { Cut, Job, JobState } from '../api/types.ts';
import { isOver } from './feed.ts';

// Those that wait or compute, in the order in which they will be: `next` is what the daemon says of it.
export function waitingJobs(jobs: ReadonlyMap<string, Job>, next: readonly string[]): readonly Job[] {
  const place = (job: Job): number => {
    const at = next.indexOf(job.id);
    return at < 0 ? Infinity : at;
  };
  const order = (a: Job, b: Job): number =>
    Number(b.state === 'computing') - Number(a.state === 'computing') ||
    (place(a) === place(b) ? 0 : place(a) - place(b)) ||
    b.priority - a.priority ||
    a.createdAt.localeCompare(b.createdAt) ||
    a.id.localeCompare(b.id);
  return [...jobs.values()].filter(({ state }) => state === 'queued' || state === 'computing').sort(order);
}

// Cuts that are not over, first those in work, then in the order in which they were queued.
export function waitingCuts(cuts: ReadonlyMap<string, Cut>): readonly Cut[] {
  const order = (a: Cut, b: Cut): number =>
    Number(a.state === 'waiting') - Number(b.state === 'waiting') || a.createdAt.localeCompare(b.createdAt) || a.id.localeCompare(b.id);
  return [...cuts.values()].filter((cut) => !isOver(cut)).sort(order);
}

export interface HistoryFilter {
  readonly words: string;
  readonly state: JobState | 'all';
}

export function history(jobs: ReadonlyMap<string, Job>, filter: HistoryFilter): readonly Job[] {
  const words = filter.words.trim().toLowerCase();
  return [...jobs.values()]
    .filter(({ state }) => state !== 'queued' && state !== 'computing')
    .filter(({ state }) => filter.state === 'all' || state === filter.state)
    .filter((job) => words === '' || `${job.name} ${job.file.name}`.toLowerCase().includes(words))
    .sort((a, b) => b.createdAt.localeCompare(a.createdAt) || b.id.localeCompare(a.id));
}

export interface Totals {
  readonly jobs: number;
  readonly strips: number;
  readonly laserS: number;
}

export function totals(jobs: readonly Job[]): Totals {
  const done = jobs.flatMap(({ summary }) => (summary === null ? [] : [summary]));
  return {
    jobs: jobs.length,
    strips: done.reduce((sum, one) => sum + one.strips, 0),
    laserS: done.reduce((sum, one) => sum + one.estimatedS, 0),
  };
}
