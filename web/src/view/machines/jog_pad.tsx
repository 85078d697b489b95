// Moves a machine's head by hand. A short press is one step. A press that lasts moves on in small steps for
// as long as it lasts: each is sent only when the one before was taken, so that nothing goes on moving when
// the key is let go, the window loses its focus or the line breaks.

import { useEffect, useRef, useState } from 'preact/hooks';

import { commandDevice, jogDevice } from '../../api/client.ts';
import type { Device } from '../../api/types.ts';
import { figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { problemText, say } from '../../state/store.ts';
import { Segmented } from '../controls.tsx';
import { Icon, type IconName } from '../icons.tsx';

const kSteps = [0.1, 1, 10, 50] as const;
const kFeedMmPerMin = 3000;
const kHoldAfterMs = 350;
const kHeldStepMs = 120; // How long a step of a held key moves.

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

const pause = (ms: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, ms));

class Jogger {
  private held = 0; // Changes with every press and release: older loops end.
  private lasts = false; // The press is one that moves on.

  constructor(readonly device: string) {}

  press({ dx, dy }: Direction, stepMm: number): void {
    const mine = (this.held += 1);
    this.lasts = false;
    const go = (mm: number): Promise<void> =>
      jogDevice(this.device, { dxMm: dx * mm, dyMm: dy * mm, feedMmPerMin: kFeedMmPerMin });
    const hold = async (): Promise<void> => {
      await go(stepMm);
      await pause(kHoldAfterMs);
      if (this.held !== mine) return;
      this.lasts = true;
      const small = Math.min(stepMm, (kFeedMmPerMin / 60_000) * kHeldStepMs);
      while (this.held === mine) {
        await go(small);
        await pause(kHeldStepMs * 0.8);
      }
    };
    hold().catch((fault: unknown) => {
      if (this.held === mine) say('problem', problemText(fault));
      this.held += 1;
    });
  }

  // Safe to call at any time. The step of a short press is gone to its end.
  release(canCancel: boolean): void {
    this.held += 1;
    if (canCancel && this.lasts) commandDevice(this.device, 'jog-cancel').catch(() => undefined);
  }
}

export function JogPad(props: { readonly device: Device }) {
  const { device } = props;
  const [step, setStep] = useState<number>(10);
  const jogger = useRef(new Jogger(device.id));
  const down = useRef<string | null>(null);
  const canCancel = device.actions.includes('jog-cancel');
  const release = (): void => {
    if (down.current === null) return;
    down.current = null;
    jogger.current.release(canCancel);
  };
  const press = (direction: Direction): void => {
    down.current = direction.name;
    jogger.current.press(direction, step);
  };
  useEffect(() => {
    const letGo = (): void => release();
    addEventListener('blur', letGo);
    document.addEventListener('visibilitychange', letGo);
    return () => {
      removeEventListener('blur', letGo);
      document.removeEventListener('visibilitychange', letGo);
      letGo();
    };
  }, [canCancel]);
  const onKeyDown = (event: KeyboardEvent): void => {
    const direction = kDirections.find((one) => one.key === event.key);
    if (direction === undefined) return;
    event.preventDefault();
    if (!event.repeat && down.current === null) press(direction);
  };
  return (
    <div class="jog">
      <div
        class="jog-pad"
        role="group"
        aria-label={t.machines.jog}
        title={t.machines.jogKeys}
        onKeyDown={onKeyDown}
        onKeyUp={release}
        onFocusOut={release}
      >
        {kDirections.map((direction) => (
          <button
            key={direction.name}
            type="button"
            class={`jog-${direction.name}`}
            aria-label={t.machines.directions[direction.name]}
            onPointerDown={(event) => {
              event.currentTarget.setPointerCapture(event.pointerId);
              press(direction);
            }}
            onPointerUp={release}
            onPointerCancel={release}
            onClick={(event) => {
              // Pressed by a screen reader: no pointer, no key.
              if (event.detail !== 0) return;
              press(direction);
              release();
            }}
            onKeyDown={(event) => {
              if (event.key !== 'Enter' && event.key !== ' ') return;
              event.preventDefault();
              if (!event.repeat && down.current === null) press(direction);
            }}
          >
            <Icon name={direction.name satisfies IconName} />
          </button>
        ))}
      </div>
      <Segmented
        label={t.machines.step}
        choices={kSteps.map((value) => ({ value: value as number, label: figure(value) }))}
        value={step}
        onChange={setStep}
      />
      <p class="quiet jog-hint">{t.machines.jogKeys}</p>
    </div>
  );
}
