// Moves a machine's head by hand: four buttons and the arrow keys.

import { useState } from 'preact/hooks';

import { jogDevice } from '../api/client.ts';
import { t } from '../messages/messages.ts';
import { attempt } from '../state/store.ts';
import { Segmented } from './controls.tsx';
import { Icon, type IconName } from './icons.tsx';

const kSteps = [0.1, 1, 10, 50] as const;
const kFeedMmPerMin = 3000;

interface Direction {
  readonly name: 'up' | 'down' | 'left' | 'right';
  readonly key: string;
  readonly dx: number;
  readonly dy: number;
}

const kDirections: readonly Direction[] = [
  { name: 'up', key: 'ArrowUp', dx: 0, dy: 1 },
  { name: 'left', key: 'ArrowLeft', dx: -1, dy: 0 },
  { name: 'right', key: 'ArrowRight', dx: 1, dy: 0 },
  { name: 'down', key: 'ArrowDown', dx: 0, dy: -1 },
];

export function JogPad(props: { readonly device: string }) {
  const [step, setStep] = useState<number>(10);
  const move = ({ dx, dy }: Direction): void => {
    void attempt(() => jogDevice(props.device, { dxMm: dx * step, dyMm: dy * step, feedMmPerMin: kFeedMmPerMin }));
  };
  const onKey = (event: KeyboardEvent): void => {
    const direction = kDirections.find((one) => one.key === event.key);
    // A held key repeats faster than a head moves: one step a press.
    if (direction === undefined || event.repeat) return;
    event.preventDefault();
    move(direction);
  };
  return (
    <div class="jog">
      <div class="jog-pad" role="group" aria-label={t.machines.jog} title={t.machines.jogKeys} onKeyDown={onKey}>
        {kDirections.map((direction) => (
          <button
            key={direction.name}
            type="button"
            class={`jog-${direction.name}`}
            aria-label={t.machines.directions[direction.name]}
            onClick={() => move(direction)}
          >
            <Icon name={direction.name satisfies IconName} />
          </button>
        ))}
      </div>
      <Segmented
        label={t.machines.step}
        choices={kSteps.map((value) => ({ value: value as number, label: String(value) }))}
        value={step}
        onChange={setStep}
      />
    </div>
  );
}
