// What the reader chose for this browser: language, colours, notifications. Kept in its local storage.

import { computed, effect, signal } from '@preact/signals';

import { type Language, languageFor, kLanguages, speak } from '../messages/messages.ts';

export const kThemes = ['system', 'light', 'dark'] as const;
export type Theme = (typeof kThemes)[number];

export interface Settings {
  readonly language: Language | 'auto';
  readonly theme: Theme;
  readonly notify: boolean; // The browser's own notifications, once it was asked.
}

export const kStandardSettings: Settings = { language: 'auto', theme: 'system', notify: false };
const kKey = 'leafcutter.settings';

// Whatever was stored, as far as it still means something.
export function readSettings(stored: string | null): Settings {
  let given: Partial<Record<keyof Settings, unknown>> = {};
  try {
    given = (JSON.parse(stored ?? '{}') ?? {}) as typeof given;
  } catch {
    // Someone else's text under our name.
  }
  return {
    language: kLanguages.find((one) => one === given.language) ?? 'auto',
    theme: kThemes.find((one) => one === given.theme) ?? 'system',
    notify: given.notify === true,
  };
}

// Private windows may refuse any storage: settings then live as long as the page.
export function recall(key: string): string | null {
  try {
    return globalThis.localStorage?.getItem(key) ?? null;
  } catch {
    return null;
  }
}

export function keep(key: string, value: string): void {
  try {
    globalThis.localStorage?.setItem(key, value);
  } catch {
    // See above.
  }
}

export const settings = signal<Settings>(readSettings(recall(kKey)));
const systemDark = signal(false);

// Which of the two colour schemes is shown.
export const scheme = computed<'light' | 'dark'>(() => {
  const { theme } = settings.value;
  return theme === 'system' ? (systemDark.value ? 'dark' : 'light') : theme;
});

export function changeSettings(values: Partial<Settings>): void {
  settings.value = { ...settings.value, ...values };
  keep(kKey, JSON.stringify(settings.value));
}

// Settles language and colours before the first picture, and follows them from then on.
export async function followSettings(): Promise<void> {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const look = (): void => void (systemDark.value = dark.matches);
  dark.addEventListener('change', look);
  look();
  effect(() => document.documentElement.setAttribute('data-scheme', scheme.value));
  const wanted = (): Language => {
    const { language } = settings.value;
    return language === 'auto' ? languageFor(navigator.languages) : language;
  };
  await speak(wanted()).catch(() => undefined);
  effect(() => void speak(wanted()).catch(() => undefined));
}
