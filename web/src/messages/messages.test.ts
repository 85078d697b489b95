import assert from 'node:assert/strict';
import { test } from 'node:test';

import { de } from './de/index.ts';
import { en } from './en/index.ts';
import { es } from './es/index.ts';
import { fr } from './fr/index.ts';
import { kLanguageNames, kLanguages, languageFor, speak, t } from './messages.ts';
import { zh } from './zh/index.ts';

const kOthers = { de, es, fr, zh } as const;

type Saying = (...args: unknown[]) => string;
type Leaf = string | Saying;

function leavesOf(tree: object, path = ''): ReadonlyMap<string, Leaf> {
  const leaves = new Map<string, Leaf>();
  for (const [key, value] of Object.entries(tree)) {
    const here = path === '' ? key : `${path}.${key}`;
    if (typeof value === 'object') for (const [below, leaf] of leavesOf(value, here)) leaves.set(below, leaf);
    else leaves.set(here, value as Leaf);
  }
  return leaves;
}

const english = leavesOf(en);

// What a saying makes of arguments that can be found again in it; lists and counts are tried as such.
function placeholders(say: Saying): readonly string[] {
  const tries: readonly ((k: number) => unknown)[] = [(k) => `<${k}>`, (k) => [700 + k, 800 + k], (k) => [900 + k]];
  const found: string[] = [];
  for (const [number, give] of tries.entries()) {
    const args = Array.from({ length: say.length }, (_, k) => give(k));
    let said: string;
    try {
      said = say(...args);
    } catch {
      continue; // Not of that kind.
    }
    const seen = said.match(/<\d>|[789]\d\d/g) ?? [];
    found.push(`${number}: ${[...seen].sort().join(' ')}`);
  }
  return found;
}

for (const [name, words] of Object.entries(kOthers)) {
  const leaves = leavesOf(words);

  test(`${name} has every key and no other`, () => {
    assert.deepEqual([...leaves.keys()].sort(), [...english.keys()].sort());
  });

  test(`${name} has the same placeholders`, () => {
    for (const [key, leaf] of english) {
      const other = leaves.get(key);
      assert.equal(typeof other, typeof leaf, key);
      if (typeof leaf === 'function' && typeof other === 'function') {
        assert.equal(other.length, leaf.length, key);
        assert.deepEqual(placeholders(other), placeholders(leaf), key);
      }
    }
  });

  test(`${name} is a translation, not a copy`, () => {
    const texts = [...english].filter(([, leaf]) => typeof leaf === 'string' && /[a-z]{3}/.test(leaf));
    const same = texts.filter(([key, leaf]) => leaves.get(key) === leaf).map(([key]) => key);
    assert.ok(same.length < 0.06 * texts.length, `${same.length} of ${texts.length} as in English: ${same.join(', ')}`);
    for (const [key, leaf] of leaves) assert.ok(typeof leaf !== 'string' || leaf.trim() !== '', key);
  });
}

test('every count is said for one and for many', () => {
  for (const words of [en, de, es, fr, zh]) {
    for (const one of [1, 2, 5]) assert.match(words.draft.submit(one), /\S/);
    assert.notEqual(words.cut.sheetsLeft(1), '');
    assert.match(words.cut.sheetsLeft(7), /7/);
  }
});

test('the language is the first wanted one that there is', () => {
  assert.equal(languageFor(['nl', 'fr-CA', 'en']), 'fr');
  assert.equal(languageFor(['zh-TW']), 'zh');
  assert.equal(languageFor([]), 'en');
});

test('what was loaded is spoken', async () => {
  for (const language of kLanguages) {
    await speak(language);
    const words = language === 'en' ? en : kOthers[language];
    assert.equal(t.nav.jobs, words.nav.jobs);
    assert.ok(kLanguageNames[language].length > 0);
  }
  await speak('en');
});
