// The life of the event feed's connection, as a table of allowed moves.

export type Connection =
  | 'idle' // Not asked for yet.
  | 'connecting'
  | 'live'
  | 'waiting' // Lost; another try is due.
  | 'resting'; // Closed on purpose while nobody looks at the page.

export type ConnectionSignal = 'start' | 'opened' | 'lost' | 'retry' | 'hide' | 'show';

const kMoves: Readonly<Record<Connection, Partial<Record<ConnectionSignal, Connection>>>> = {
  idle: { start: 'connecting' },
  connecting: { opened: 'live', lost: 'waiting', hide: 'resting' },
  live: { lost: 'waiting', hide: 'resting' },
  waiting: { retry: 'connecting', show: 'connecting', hide: 'resting' },
  resting: { show: 'connecting' },
};

// Where `signal` leads, or the same state if it means nothing there.
export function nextConnection(now: Connection, signal: ConnectionSignal): Connection {
  return kMoves[now][signal] ?? now;
}

// How long to wait before try number `attempt` (1, 2, …): doubling, at most 10 s.
export function retryDelayMs(attempt: number): number {
  return Math.min(10_000, 500 * 2 ** Math.max(0, attempt - 1));
}
