// The buttons that stop machines. They call the daemon by themselves and wait for nothing: neither the
// event feed, nor a dialog, nor another call.

import { useEffect } from 'preact/hooks';

import { commandDevice } from '../api/client.ts';
import type { Device } from '../api/types.ts';
import { t } from '../messages/messages.ts';
import { connectedDevices, problemText, say } from '../state/store.ts';

async function stop(device: Device): Promise<void> {
  try {
    await commandDevice(device.id, 'stop');
    say('said', t.stop.sent(device.name));
  } catch (fault) {
    say('problem', `${t.problem.stop(device.name)} (${problemText(fault)})`);
  }
}

const kDoublePressMs = 600;

// Ctrl + . and Esc Esc stop everything.
function useStopKeys(): void {
  useEffect(() => {
    let lastEscape = -Infinity;
    const onKey = (event: KeyboardEvent): void => {
      const twice = event.key === 'Escape' && !event.repeat && event.timeStamp - lastEscape < kDoublePressMs;
      if (event.key === 'Escape') lastEscape = event.timeStamp;
      if (!twice && !(event.key === '.' && event.ctrlKey)) return;
      event.preventDefault();
      for (const device of connectedDevices.value) void stop(device);
    };
    addEventListener('keydown', onKey, { capture: true });
    return () => removeEventListener('keydown', onKey, { capture: true });
  }, []);
}

export function StopBar() {
  useStopKeys();
  const devices = connectedDevices.value;
  if (devices.length === 0) return null;
  return (
    <div class="stop-bar" role="group" aria-label={t.stop.label}>
      {devices.map((device) => (
        <button
          key={device.id}
          type="button"
          class="stop"
          title={t.stop.hint}
          data-device={device.id}
          onClick={() => void stop(device)}
        >
          <span class="stop-word">{t.stop.button}</span>
          <span class="stop-name">{device.name}</span>
        </button>
      ))}
    </div>
  );
}
