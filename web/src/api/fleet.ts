// The daemons that work together on one database.

import { flag, list, number, optional, type Reader, record, text } from '../lib/check.ts';
import { read, send } from './client.ts';

export interface FleetNode {
  readonly id: string;
  readonly role: string;
  readonly state: string;
  readonly version: string;
  readonly silentS: number;
  readonly machines: readonly string[];
  readonly workers: number;
  readonly computing: number;
  readonly cutting: number;
  readonly actions: readonly string[];
}

export interface Fleet {
  readonly alone: boolean;
  readonly node: string; // The one that answers.
  readonly nodes: readonly FleetNode[];
}

const readNode: Reader<FleetNode> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', text),
    role: get('role', text),
    state: get('state', text),
    version: get('version', optional(text, '')),
    silentS: get('silent_s', optional(number, 0)),
    machines: get('machines', optional(list(text), [])),
    workers: get('workers', optional(number, 0)),
    computing: get('computing', optional(number, 0)),
    cutting: get('cutting', optional(number, 0)),
    actions: get('actions', optional(list(text), [])),
  };
};

export const readFleet: Reader<Fleet> = (value, path) => {
  const get = record(value, path);
  return { alone: get('alone', flag), node: get('node', optional(text, '')), nodes: get('nodes', list(readNode)) };
};

export const getFleet = (): Promise<Fleet> => read('/fleet', readFleet);

export async function commandNode(id: string, command: 'pause' | 'drain' | 'resume'): Promise<void> {
  await send('POST', `/fleet/${encodeURIComponent(id)}/${command}`, {});
}

export async function forgetNode(id: string): Promise<void> {
  await send('DELETE', `/fleet/${encodeURIComponent(id)}`);
}
