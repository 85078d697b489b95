// The words in the reader's language.

import { en, type Messages } from './en.ts';

const kLanguages: Readonly<Record<string, Messages>> = { en };

export function messagesFor(languages: readonly string[]): Messages {
  for (const language of languages) {
    const words = kLanguages[language.split('-')[0] ?? ''];
    if (words !== undefined) return words;
  }
  return en;
}

export const t: Messages = messagesFor(globalThis.navigator?.languages ?? []);
