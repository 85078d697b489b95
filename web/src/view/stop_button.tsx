// The button that stops machines. It calls the daemon by itself and waits for nothing: neither the event
// feed, nor a dialog, nor another call. It is on every page, whether machines are known or not.

import { useEffect } from 'preact/hooks';

import { commandDevice, listDevices } from '../api/client.ts';
import type { Device } from '../api/types.ts';
import { t } from '../messages/messages.ts';
import { isConnected } from '../state/feed.ts';
import { connectedDevices, problemText, say } from '../state/store.ts';

export async function stop(device: Device): Promise<void> {
  try {
    await commandDevice(device.id, 'stop');
    say('said', t.stop.sent(device.name));
  } catch (fault) {
    say('problem', `${t.problem.stop(device.name)} (${problemText(fault)})`);
  }
}

// The machines that are known get it at once. If none are, the daemon is asked for them first.
async function stopAll(): Promise<void> {
  const known = connectedDevices.value;
  if (known.length > 0) {
    await Promise.all(known.map(stop));
    return;
  }
  try {
    const found = (await listDevices()).filter(isConnected);
    await Promise.all(found.map(stop));
    if (found.length === 0) say('said', t.stop.none);
  } catch (fault) {
    say('problem', `${t.problem.stop(t.stop.all)} (${problemText(fault)})`);
  }
}

const kDoublePressMs = 600;

// Escape also closes windows and lists of suggestions, often at the second press: there it stops nothing.
function closesSomething(event: KeyboardEvent): boolean {
  return event.target instanceof Element && event.target.closest('dialog, input, select, textarea') !== null;
}

// Ctrl + . stops everything, everywhere; so does Esc Esc where Escape has no other meaning.
function useStopKeys(): void {
  useEffect(() => {
    let lastEscape = -Infinity;
    const onKey = (event: KeyboardEvent): void => {
      const escape = event.key === 'Escape' && !event.repeat && !closesSomething(event);
      const twice = escape && event.timeStamp - lastEscape < kDoublePressMs;
      if (escape) lastEscape = event.timeStamp;
      if (!twice && !(event.key === '.' && event.ctrlKey)) return;
      event.preventDefault();
      void stopAll();
    };
    addEventListener('keydown', onKey, { capture: true });
    return () => removeEventListener('keydown', onKey, { capture: true });
  }, []);
}

export function StopButton() {
  useStopKeys();
  const devices = connectedDevices.value;
  const only = devices.length === 1 ? devices[0] : undefined;
  const name = only?.name ?? t.stop.all;
  return (
    <button type="button" class="stop" title={t.stop.hint} onClick={() => void stopAll()}>
      <span class="stop-word">{t.stop.button}</span>{' '}
      <span class="stop-name">{name}</span>
    </button>
  );
}
