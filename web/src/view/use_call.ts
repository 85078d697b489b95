// What a call answers, and whether this daemon knows it at all.

import { useEffect, useState } from 'preact/hooks';

import { Problem } from '../api/problem.ts';
import { t } from '../messages/messages.ts';
import { problemText } from '../state/store.ts';

export type Called<T> =
  | { readonly state: 'loading' }
  | { readonly state: 'failed'; readonly fault: string }
  | { readonly state: 'there'; readonly value: T };

export function useCall<T>(call: () => Promise<T>): readonly [Called<T>, () => Promise<void>] {
  const [called, setCalled] = useState<Called<T>>({ state: 'loading' });
  const load = (): Promise<void> =>
    call().then(
      (value) => setCalled({ state: 'there', value }),
      (fault: unknown) => {
        const unknown = fault instanceof Problem && (fault.status === 404 || fault.status === 405);
        setCalled({ state: 'failed', fault: unknown ? t.problem.notYet : problemText(fault) });
      },
    );
  useEffect(() => void load(), []);
  return [called, load];
}
