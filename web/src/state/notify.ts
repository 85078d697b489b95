// Says what happened while nobody looked: through the browser's own notifications, by consent.

import { t } from '../messages/messages.ts';
import type { FeedEvent } from '../api/types.ts';
import type { Feed } from './feed.ts';

export function canNotify(): NotificationPermission | 'missing' {
  return 'Notification' in globalThis ? Notification.permission : 'missing';
}

export async function askToNotify(): Promise<boolean> {
  if (canNotify() === 'missing') return false;
  return (await Notification.requestPermission()) === 'granted';
}

// What is worth a word about `event`, given what was known before it. Null: nothing.
export function newsOf(before: Feed, event: FeedEvent): string | null {
  if (event.type === 'job') {
    const was = before.jobs.get(event.job.id)?.state;
    if (was === undefined || was === event.job.state) return null;
    if (event.job.state === 'ready') return t.notify.ready(event.job.name);
    return event.job.state === 'failed' ? t.notify.failed(event.job.name) : null;
  }
  if (event.type !== 'cut') return null;
  const was = before.cuts.get(event.cut.id)?.state;
  const name = before.jobs.get(event.cut.job)?.name ?? event.cut.job;
  if (was === undefined || was === event.cut.state) return null;
  if (event.cut.state === 'awaiting-sheet') return t.notify.sheet(name);
  if (event.cut.state === 'interrupted') return t.notify.interrupted(name);
  return event.cut.state === 'done' ? t.notify.cut(name) : null;
}

export function notify(text: string): void {
  if (canNotify() !== 'granted' || document.visibilityState === 'visible') return;
  try {
    new Notification(t.title, { body: text, tag: text });
  } catch {
    // Some phones only let service workers do this.
  }
}
