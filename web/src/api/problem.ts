// What went wrong with a call, as RFC 9457 problem details say it.

import { list, number, optional, type Reader, record, text } from '../lib/check.ts';
import type { FieldFault } from './types.ts';

export class Problem extends Error {
  override name = 'Problem';

  constructor(
    readonly status: number, // 0: the daemon was not reached.
    readonly code: string,
    detail: string,
    readonly faults: readonly FieldFault[] = [],
  ) {
    super(detail);
  }
}

const readFault: Reader<FieldFault> = (value, path) => {
  const get = record(value, path);
  return { pointer: get('pointer', text), detail: get('detail', text) };
};

// The problem in an answer that was not a success. Any body will do: proxies answer in HTML.
export function problemFrom(status: number, body: string): Problem {
  try {
    const get = record(JSON.parse(body), '');
    const title = get('title', optional(text, ''));
    const detail = get('detail', optional(text, '')) || title;
    return new Problem(
      get('status', optional(number, status)),
      get('code', optional(text, '')),
      detail || `HTTP ${status}`,
      get('errors', optional(list(readFault), [])),
    );
  } catch {
    return new Problem(status, '', `HTTP ${status}`);
  }
}

export function unreachable(): Problem {
  return new Problem(0, 'unreachable', '');
}
