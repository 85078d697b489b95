// How fast and how strong a running program goes, in percent of what it says.

import { commandDevice } from '../../api/client.ts';
import type { Device } from '../../api/types.ts';
import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { attempt } from '../../state/store.ts';

const kNames = ['feed', 'rapid', 'power'] as const;
const kStep = 10;
// A controller knows three speeds for moves without beam.
const kRapids: readonly number[] = [25, 50, 100];

function next(name: (typeof kNames)[number], now: number, by: 1 | -1): number {
  if (name !== 'rapid') return Math.min(200, Math.max(10, now + by * kStep));
  const at = kRapids.findIndex((value) => value >= now);
  return kRapids[Math.min(kRapids.length - 1, Math.max(0, (at < 0 ? kRapids.length - 1 : at) + by))] ?? 100;
}

export function Overrides(props: { readonly device: Device }) {
  const { device } = props;
  const { overridePercent } = device.status;
  if (overridePercent.length < 3) return null;
  const change = (name: string, to: number): void =>
    void attempt(() => commandDevice(device.id, 'override', { [name]: to }));
  return (
    <div class="overrides" role="group" aria-label={t.machines.overrides}>
      {kNames.map((name, index) => {
        const now = overridePercent[index] ?? 100;
        const label = t.machines.overrideNames[name];
        return (
          <div key={name} class="override">
            <span>{label}</span>
            <button type="button" class="button small" aria-label={t.machines.less(label)} onClick={() => change(name, next(name, now, -1))}>
              −
            </button>
            <button type="button" class="button small override-now" title={t.machines.standard} onClick={() => change(name, 100)}>
              {count(now)} %
            </button>
            <button type="button" class="button small" aria-label={t.machines.more(label)} onClick={() => change(name, next(name, now, 1))}>
              +
            </button>
          </div>
        );
      })}
    </div>
  );
}
