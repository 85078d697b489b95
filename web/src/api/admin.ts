// Who may do what: the session, users, keys, and the log of what was done.

import { flag, list, number, oneOf, optional, type Reader, record, text } from '../lib/check.ts';
import { read, send, sendAndRead } from './client.ts';
import { listUnder } from './payloads.ts';

export const kRoles = ['viewer', 'submitter', 'operator', 'admin'] as const;
export type Role = (typeof kRoles)[number];
const role = oneOf<Role>(...kRoles);

export interface Session {
  readonly accounts: boolean; // Somebody has one; if not, everything is open.
  readonly authenticated: boolean;
  readonly user: string | null;
  readonly role: Role | null;
  readonly csrfToken: string | null;
}

export interface User {
  readonly name: string;
  readonly role: Role;
  readonly createdAt: string;
}

export interface Key {
  readonly id: string;
  readonly user: string;
  readonly label: string;
  readonly role: Role;
  readonly mayFire: boolean;
  readonly createdAt: string;
  readonly expiresAt: string | null;
  readonly usedAt: string | null;
}

export interface AuditEntry {
  readonly seq: number;
  readonly at: string;
  readonly user: string | null;
  readonly remote: string;
  readonly action: string;
  readonly note: string;
  readonly status: number;
}

const readSession: Reader<Session> = (value, path) => {
  const get = record(value, path);
  return {
    accounts: get('accounts', optional(flag, false)),
    authenticated: get('authenticated', optional(flag, true)),
    user: get('user', optional(text, null)),
    role: get('role', optional(role, null)),
    csrfToken: get('csrf_token', optional(text, null)),
  };
};

const readUser: Reader<User> = (value, path) => {
  const get = record(value, path);
  return { name: get('name', text), role: get('role', role), createdAt: get('created_at', optional(text, '')) };
};

const readKey: Reader<Key> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', text),
    user: get('user', optional(text, '')),
    label: get('label', optional(text, '')),
    role: get('role', role),
    mayFire: get('may_fire', optional(flag, false)),
    createdAt: get('created_at', optional(text, '')),
    expiresAt: get('expires_at', optional(text, null)),
    usedAt: get('used_at', optional(text, null)),
  };
};

const readEntry: Reader<AuditEntry> = (value, path) => {
  const get = record(value, path);
  return {
    seq: get('seq', number),
    at: get('at', text),
    user: get('user', optional(text, null)),
    remote: get('remote', optional(text, '')),
    action: get('action', text),
    note: get('note', optional(text, '')),
    status: get('status', optional(number, 0)),
  };
};

export const getSession = (): Promise<Session> => read('/session', readSession);
export const logIn = (user: string, password: string): Promise<Session> =>
  sendAndRead('POST', '/session', { user, password }, readSession);

export async function logOut(): Promise<void> {
  await send('DELETE', '/session');
}

export const listUsers = (): Promise<readonly User[]> => read('/users', listUnder('users', readUser));

export interface NewUser {
  readonly name: string;
  readonly role: Role;
  readonly password: string;
}

export async function addUser(user: NewUser): Promise<void> {
  await send('POST', '/users', user);
}

export interface UserChange {
  readonly role?: Role;
  readonly password?: string;
  readonly oldPassword?: string;
}

export async function changeUser(name: string, { role: to, password, oldPassword }: UserChange): Promise<void> {
  await send('PUT', `/users/${encodeURIComponent(name)}`, { role: to, password, old_password: oldPassword });
}

export async function removeUser(name: string): Promise<void> {
  await send('DELETE', `/users/${encodeURIComponent(name)}`);
}

export const listKeys = (): Promise<readonly Key[]> => read('/keys', listUnder('keys', readKey));

export interface NewKey {
  readonly label: string;
  readonly role: Role;
  readonly mayFire: boolean;
  readonly expiresInDays: number | null;
}

// The key itself, which is told this once.
export async function addKey(key: NewKey): Promise<string> {
  const body = { label: key.label, role: key.role, may_fire: key.mayFire, expires_in_days: key.expiresInDays };
  return sendAndRead('POST', '/keys', body, (value, path) => record(value, path)('key', text));
}

export async function removeKey(id: string): Promise<void> {
  await send('DELETE', `/keys/${encodeURIComponent(id)}`);
}

export interface AuditPage {
  readonly entries: readonly AuditEntry[];
  readonly next: string | null;
}

export function listAudit(cursor: string | null): Promise<AuditPage> {
  const path = `/audit?limit=100${cursor === null ? '' : `&cursor=${encodeURIComponent(cursor)}`}`;
  return read(path, (value, at) => {
    const get = record(value, at);
    return { entries: get('entries', list(readEntry)), next: get('next_cursor', optional(text, null)) };
  });
}
