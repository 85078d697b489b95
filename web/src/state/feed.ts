// What the page knows of the daemon: a fold over its events.

import type { Cut, Device, FeedEvent, Job } from '../api/types.ts';

export interface Feed {
  readonly jobs: ReadonlyMap<string, Job>;
  readonly cuts: ReadonlyMap<string, Cut>;
  readonly devices: ReadonlyMap<string, Device>;
  readonly known: boolean; // A whole picture has come once.
}

export const kEmptyFeed: Feed = { jobs: new Map(), cuts: new Map(), devices: new Map(), known: false };

function byId<T extends { readonly id: string }>(items: readonly T[]): ReadonlyMap<string, T> {
  return new Map(items.map((item) => [item.id, item]));
}

function withItem<T extends { readonly id: string }>(map: ReadonlyMap<string, T>, item: T): ReadonlyMap<string, T> {
  return new Map(map).set(item.id, item);
}

function without<T>(map: ReadonlyMap<string, T>, id: string): ReadonlyMap<string, T> {
  const rest = new Map(map);
  rest.delete(id);
  return rest;
}

type Versioned = { readonly id: string; readonly version: number };

// An answer to a call may overtake or trail the event of the same change: the newer version stays.
function isStale<T extends Versioned>(known: ReadonlyMap<string, T>, item: T): boolean {
  return item.version < (known.get(item.id)?.version ?? 0);
}

export function reduceFeed(feed: Feed, event: FeedEvent): Feed {
  switch (event.type) {
    case 'job':
      return isStale(feed.jobs, event.job) ? feed : { ...feed, jobs: withItem(feed.jobs, event.job) };
    case 'job-removed':
      return { ...feed, jobs: without(feed.jobs, event.id) };
    case 'cut-removed':
      return { ...feed, cuts: without(feed.cuts, event.id) };
    case 'cut':
      return isStale(feed.cuts, event.cut) ? feed : { ...feed, cuts: withItem(feed.cuts, event.cut) };
    case 'device':
      return { ...feed, devices: withItem(feed.devices, event.device) };
    case 'snapshot':
      return { jobs: byId(event.jobs), cuts: byId(event.cuts), devices: byId(event.devices), known: true };
  }
}

export function newestFirst<T extends { readonly createdAt: string; readonly id: string }>(
  items: ReadonlyMap<string, T>,
): readonly T[] {
  const order = (a: T, b: T): number => b.createdAt.localeCompare(a.createdAt) || b.id.localeCompare(a.id);
  return [...items.values()].sort(order);
}

const kEnded = new Set(['done', 'aborted', 'failed', 'interrupted']);

export function isOver(cut: Cut): boolean {
  return kEnded.has(cut.state);
}

export interface Doubtful {
  readonly cuts: readonly string[];
  readonly jobs: readonly string[];
}

// What may be done with a cut depends on its machine, and with a job on its cuts, but neither sends an
// event of its own for that: these must be asked for again after `event` came upon `before`.
export function doubtfulAfter(before: Feed, event: FeedEvent): Doubtful {
  if (event.type === 'device') {
    const { id, status } = event.device;
    if (before.devices.get(id)?.status.state === status.state) return { cuts: [], jobs: [] };
    const open = [...before.cuts.values()].filter((cut) => cut.device === id && !isOver(cut));
    return { cuts: open.map((cut) => cut.id), jobs: [] };
  }
  if (event.type === 'cut' && before.cuts.get(event.cut.id)?.state !== event.cut.state) {
    return { cuts: [], jobs: [event.cut.job] };
  }
  return { cuts: [], jobs: [] };
}

// The job's cut that matters now: one that is not over, else the last one.
export function currentCut(feed: Feed, job: string): Cut | null {
  const mine = newestFirst(feed.cuts).filter((cut) => cut.job === job);
  return mine.find((cut) => !isOver(cut)) ?? mine[0] ?? null;
}

export function isConnected(device: Device): boolean {
  return device.status.state !== 'disconnected';
}
