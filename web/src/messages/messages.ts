// The words in the reader's language. `t` always speaks the language of the moment: what renders from it
// renders again when that changes.

import { signal } from '@preact/signals';

import { formatIn } from '../lib/format.ts';
import { en, type Messages } from './en/index.ts';

export const kLanguages = ['en', 'de', 'es', 'fr', 'zh'] as const;
export type Language = (typeof kLanguages)[number];

// As their own readers write them; and the tag that tells browsers and screen readers.
export const kLanguageNames: Readonly<Record<Language, string>> = {
  en: 'English',
  de: 'Deutsch',
  es: 'Español',
  fr: 'Français',
  zh: '简体中文',
};
const kTags: Readonly<Record<Language, string>> = { en: 'en', de: 'de', es: 'es', fr: 'fr', zh: 'zh-Hans' };

const kLoaders: Readonly<Record<Language, () => Promise<Messages>>> = {
  en: () => Promise.resolve(en),
  de: () => import('./de/index.ts').then(({ de }) => de),
  es: () => import('./es/index.ts').then(({ es }) => es),
  fr: () => import('./fr/index.ts').then(({ fr }) => fr),
  zh: () => import('./zh/index.ts').then(({ zh }) => zh),
};

export const language = signal<Language>('en');
const words = signal<Messages>(en);

export const t: Messages = new Proxy({} as Messages, {
  get: (_, key) => words.value[key as keyof Messages],
});

// The first of the wanted languages that there is a translation for.
export function languageFor(wanted: readonly string[]): Language {
  for (const tag of wanted) {
    const found = kLanguages.find((one) => one === tag.toLowerCase().split('-')[0]);
    if (found !== undefined) return found;
  }
  return 'en';
}

// Where a translation cannot be loaded, the language stays what it was.
export async function speak(next: Language): Promise<void> {
  const loaded = await kLoaders[next]();
  formatIn(kTags[next]);
  words.value = loaded;
  language.value = next;
  globalThis.document?.documentElement.setAttribute('lang', kTags[next]);
}
