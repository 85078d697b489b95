// The page's live state as signals, and the few commands that change it. Everything shown is computed
// from here.

import { computed, signal } from '@preact/signals';

import { getCut, getJob, listCuts, listDevices, listJobs, listMaterials } from '../api/client.ts';
import { Problem } from '../api/problem.ts';
import { type EventStream, openEventStream } from '../api/event_stream.ts';
import type { Device, FeedEvent, Material } from '../api/types.ts';
import { t } from '../messages/messages.ts';
import { type Connection, type ConnectionSignal, nextConnection, retryDelayMs } from './connection.ts';
import { type Draft, type DraftAction, kNewDraft, reduceDraft } from './draft.ts';
import { type Doubtful, doubtfulAfter, isConnected, kEmptyFeed, reduceFeed } from './feed.ts';
import { newsOf, notify } from './notify.ts';
import { formatRoute, parseRoute, type Route } from './route.ts';
import { settings } from './settings.ts';

export const feed = signal(kEmptyFeed);
export const connection = signal<Connection>('idle');
export const route = signal<Route>({ page: 'jobs' });
export const draft = signal<Draft>(kNewDraft);
export const connectedDevices = computed<readonly Device[]>(() => [...feed.value.devices.values()].filter(isConnected));

export const materials = signal<readonly Material[]>([]);

export async function loadMaterials(again = false): Promise<void> {
  if (again || materials.value.length === 0) materials.value = await listMaterials();
}

export function materialName(id: string): string {
  return materials.value.find((material) => material.id === id)?.name ?? id;
}

export interface Notice {
  readonly key: number;
  readonly kind: 'problem' | 'said';
  readonly text: string;
}

export const notices = signal<readonly Notice[]>([]);
let nextNotice = 1;

export function say(kind: Notice['kind'], text: string): void {
  const notice = { key: nextNotice++, kind, text };
  notices.value = [...notices.value.filter((other) => other.text !== text).slice(-2), notice];
  if (kind === 'said') setTimeout(() => dismiss(notice.key), 6000);
}

export function dismiss(key: number): void {
  notices.value = notices.value.filter((notice) => notice.key !== key);
}

export function problemText(fault: unknown): string {
  if (!(fault instanceof Problem)) return String(fault);
  return fault.status === 0 ? t.problem.unreachable : fault.message;
}

// Runs a call and shows its problem, if it has one. True if it went well.
export async function attempt(call: () => Promise<unknown>): Promise<boolean> {
  try {
    await call();
    return true;
  } catch (fault) {
    say('problem', problemText(fault));
    return false;
  }
}

// One that the lists did not hold. That there is none, the page says itself.
export function fetchJob(id: string): void {
  getJob(id).then(
    (job) => receive({ type: 'job', seq: null, job }),
    (fault: unknown) => {
      if (!(fault instanceof Problem && fault.status === 404)) say('problem', problemText(fault));
    },
  );
}

async function askAgain({ cuts, jobs }: Doubtful): Promise<void> {
  for (const id of cuts) receive({ type: 'cut', seq: null, cut: await getCut(id) });
  for (const id of jobs) receive({ type: 'job', seq: null, job: await getJob(id) });
}

export function receive(event: FeedEvent): void {
  const before = feed.value;
  const news = settings.value.notify ? newsOf(before, event) : null;
  feed.value = reduceFeed(before, event);
  if (news !== null) notify(news);
  // What can't be had now comes with the next event.
  askAgain(doubtfulAfter(before, event)).catch(() => undefined);
}

// After a machine was added, changed or forgotten, of which no event tells.
export async function refreshDevices(): Promise<void> {
  const devices = await listDevices();
  feed.value = { ...feed.value, devices: new Map(devices.map((device) => [device.id, device])) };
}

export function changeDraft(action: DraftAction): void {
  draft.value = reduceDraft(draft.value, action);
}

export function go(to: Route): void {
  location.hash = formatRoute(to);
}

export function followAddress(): void {
  const read = (): void => {
    route.value = parseRoute(location.hash);
  };
  addEventListener('hashchange', read);
  read();
}

// While the event feed is down, the lists are asked for: a plain call may get through where a long
// answer does not, and machines must be known for their STOP buttons to be there.
async function askForAll(): Promise<void> {
  const [jobs, cuts, devices] = await Promise.all([listJobs(), listCuts(), listDevices()]);
  if (connection.value !== 'live') receive({ type: 'snapshot', seq: null, jobs, cuts, devices });
}

// A page out of sight gives its connection back after this long: browsers allow only six to one host.
const kRestAfterMs = 60_000;

// Keeps the event feed open for as long as the page lives.
export function followEvents(): void {
  let stream: EventStream | null = null;
  let lastId = '';
  let attempts = 0;
  let rest: ReturnType<typeof setTimeout> | undefined;

  function open(): void {
    stream = openEventStream(lastId, {
      opened: () => {
        attempts = 0;
        move('opened');
      },
      event: receive,
      lost: () => move('lost'),
    });
  }

  function close(): void {
    lastId = stream?.lastEventId() ?? lastId;
    stream?.close();
    stream = null;
  }

  function move(signal: ConnectionSignal): void {
    const before = connection.value;
    const after = nextConnection(before, signal);
    if (before === after) return;
    connection.value = after;
    if (after === 'connecting') open();
    if (after === 'waiting' || after === 'resting') close();
    if (after === 'waiting') {
      setTimeout(() => move('retry'), retryDelayMs((attempts += 1)));
      askForAll().catch(() => undefined);
    }
  }

  document.addEventListener('visibilitychange', () => {
    clearTimeout(rest);
    if (document.visibilityState === 'visible') move('show');
    else rest = setTimeout(() => move('hide'), kRestAfterMs);
  });
  addEventListener('online', () => move('show'));
  move('start');
}
