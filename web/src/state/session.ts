// Who looks at this page, and whether the daemon wants to know.

import { computed, signal } from '@preact/signals';

import { getSession, logIn, logOut, type Role, type Session } from '../api/admin.ts';
import { carryToken, whenLoginWanted } from '../api/client.ts';

export type SessionState =
  | { readonly state: 'unknown' } // Not asked yet, or a daemon that knows no accounts.
  | { readonly state: 'open' } // Nobody has an account.
  | { readonly state: 'asked' } // The daemon wants a login.
  | { readonly state: 'in'; readonly user: string; readonly role: Role };

export const session = signal<SessionState>({ state: 'unknown' });

export function stateOf(told: Session): SessionState {
  if (!told.accounts) return { state: 'open' };
  if (!told.authenticated || told.role === null) return { state: 'asked' };
  return { state: 'in', user: told.user ?? '', role: told.role };
}

function take(told: Session): void {
  carryToken(told.csrfToken);
  session.value = stateOf(told);
}

// Whether the person may look after users, machines and the like.
export const isAdmin = computed(() => {
  const now = session.value;
  return now.state !== 'in' || now.role === 'admin';
});

export async function followSession(): Promise<void> {
  whenLoginWanted(() => {
    if (session.value.state !== 'asked') session.value = { state: 'asked' };
  });
  await getSession().then(take, () => undefined);
}

export async function enter(user: string, password: string): Promise<void> {
  take(await logIn(user, password));
}

export async function leave(): Promise<void> {
  await logOut();
  take(await getSession());
}
