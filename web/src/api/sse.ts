// Server-sent events as a pure state machine: text in, events out, for any split of the stream.
// After the HTML standard, section 9.2.6 "Interpreting an event stream".

export interface ServerEvent {
  readonly type: string;
  readonly data: string;
  readonly lastEventId: string;
}

export interface SseParser {
  // The events that `chunk` completed. Comments and `retry` are ignored.
  feed(chunk: string): readonly ServerEvent[];
}

export function createSseParser(lastEventId = ''): SseParser {
  let id = lastEventId;
  let pending = '';
  let type = '';
  let data: string[] = [];

  function take(line: string): ServerEvent | null {
    if (line === '') {
      const event = data.length > 0 ? { type: type || 'message', data: data.join('\n'), lastEventId: id } : null;
      type = '';
      data = [];
      return event;
    }
    const colon = line.indexOf(':');
    const field = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? '' : line.slice(colon + 1).replace(/^ /, '');
    if (field === 'event') type = value;
    else if (field === 'data') data.push(value);
    else if (field === 'id' && !value.includes('\0')) id = value;
    return null;
  }

  function feed(chunk: string): readonly ServerEvent[] {
    pending += chunk;
    // A carriage return at the very end may be half of a CRLF: wait for what follows.
    const end = pending.endsWith('\r') ? pending.length - 1 : pending.length;
    const lines = pending.slice(0, end).split(/\r\n|\r|\n/);
    pending = (lines.pop() ?? '') + pending.slice(end);
    return lines.map(take).filter((event) => event !== null);
  }

  return { feed };
}
