import assert from 'node:assert/strict';
import { test } from 'node:test';

import { createSseParser, type ServerEvent } from './sse.ts';

const stream =
  'retry: 2000\n\n: heartbeat\n\nid: 7\nevent: job\ndata: {"a":1}\n\n' +
  'event: device\r\ndata:one\r\ndata: two\r\n\r\nid: 8\rdata: last\r\r';

const expected: ServerEvent[] = [
  { type: 'job', data: '{"a":1}', lastEventId: '7' },
  { type: 'device', data: 'one\ntwo', lastEventId: '7' },
  { type: 'message', data: 'last', lastEventId: '8' },
];

test('every split of the stream gives the same events', () => {
  for (let cut = 0; cut <= stream.length; cut += 1) {
    const parser = createSseParser();
    const events = [...parser.feed(stream.slice(0, cut)), ...parser.feed(stream.slice(cut)), ...parser.feed('\n')];
    assert.deepEqual(events, expected, `cut at ${cut}`);
  }
});

test('an event without data is none, but its id counts', () => {
  const parser = createSseParser();
  assert.deepEqual(parser.feed('id: 4\nevent: job\n\n'), []);
  assert.equal(parser.feed('data: x\n\n')[0]?.lastEventId, '4');
});

test('the id goes on from the one a connection began with', () => {
  assert.equal(createSseParser('41').feed('data: x\n\n')[0]?.lastEventId, '41');
});
