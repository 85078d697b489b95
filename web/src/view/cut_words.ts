// What is said of a cut.

import type { Cut } from '../api/types.ts';
import { t } from '../messages/messages.ts';
import { feed } from '../state/store.ts';

export const deviceName = (id: string): string => feed.value.devices.get(id)?.name ?? id;

// A cut that waits only for its operator is ready, whatever its queue calls it.
export function cutWord(cut: Cut): string {
  const word = cut.actions.includes('start') ? t.cut.ready : t.cut.states[cut.state];
  return word(deviceName(cut.device));
}
