// One connection to the daemon's event feed, until it ends or is closed. Read with fetch and not with
// EventSource: only so can a page say where it stopped after its own reconnect, and see a silent line.

import { kApi } from './client.ts';
import { readEvent } from './payloads.ts';
import { createSseParser } from './sse.ts';
import type { FeedEvent } from './types.ts';

export interface EventStreamHandlers {
  opened(): void;
  event(event: FeedEvent): void;
  lost(): void; // Called once, unless close() came first.
}

export interface EventStream {
  close(): void;
  lastEventId(): string;
}

// The daemon sends a heartbeat every 15 s; three missed ones mean that nobody is there.
const kSilenceMs = 45_000;

export function openEventStream(lastEventId: string, handlers: EventStreamHandlers): EventStream {
  const abort = new AbortController();
  let id = lastEventId;
  let closed = false;
  let watchdog: ReturnType<typeof setTimeout> | undefined;

  function heard(): void {
    clearTimeout(watchdog);
    watchdog = setTimeout(() => abort.abort(), kSilenceMs);
  }

  function deliver(type: string, data: string): void {
    try {
      const event = readEvent(type, JSON.parse(data));
      if (event !== null) handlers.event(event);
    } catch (fault) {
      console.warn('event dropped', type, fault);
    }
  }

  async function run(): Promise<void> {
    const headers: Record<string, string> = { Accept: 'text/event-stream' };
    if (id !== '') headers['Last-Event-ID'] = id;
    heard();
    const response = await fetch(`${kApi}/events`, { headers, signal: abort.signal, cache: 'no-store' });
    if (!response.ok || response.body === null) throw new Error(`HTTP ${response.status}`);
    handlers.opened();
    const parser = createSseParser(id);
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      heard();
      for (const event of parser.feed(value)) {
        id = event.lastEventId;
        deliver(event.type, event.data);
      }
    }
  }

  run()
    .catch(() => undefined)
    .finally(() => {
      clearTimeout(watchdog);
      if (!closed) handlers.lost();
    });

  return {
    close() {
      closed = true;
      abort.abort();
    },
    lastEventId: () => id,
  };
}
