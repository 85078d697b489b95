// The steps of one story, one story to a file: where one fails, those after it would only wait in vain.

import assert from 'node:assert/strict';
import { test } from 'node:test';

let broken = '';

export function step(name, act) {
  test(name, async () => {
    assert.equal(broken, '', 'an earlier step failed');
    broken = name;
    await act();
    broken = '';
  });
}
