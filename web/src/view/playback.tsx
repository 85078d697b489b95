// A sheet's program played as the machine would run it: from the exact bytes, at a speed of one's choice.

import { useEffect, useRef, useState } from 'preact/hooks';

import { clock, count, figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import type { BurnPlan } from '../state/burn.ts';
import { Icon } from './icons.tsx';

const kSpeeds = [1, 5, 20, 100, 400] as const;

export interface Playing {
  readonly seconds: number;
}

export function Playback(props: {
  readonly plan: BurnPlan;
  readonly seconds: number;
  readonly line: number;
  readonly onSeek: (seconds: number) => void;
  readonly onClose: () => void;
}) {
  const { plan, seconds, line, onSeek, onClose } = props;
  const { totalS, burnMm, travelMm, lines } = plan.program;
  const [running, setRunning] = useState(true);
  const [speed, setSpeed] = useState<number>(20);
  const now = useRef(seconds);
  now.current = seconds;
  useEffect(() => {
    if (!running) return undefined;
    let frame = 0;
    let last = performance.now();
    const tick = (time: number): void => {
      const next = Math.min(totalS, now.current + ((time - last) / 1000) * speed);
      last = time;
      onSeek(next);
      if (next >= totalS) setRunning(false);
      else frame = requestAnimationFrame(tick);
    };
    frame = requestAnimationFrame(tick);
    return () => cancelAnimationFrame(frame);
  }, [running, speed, totalS]);
  const toggle = (): void => {
    if (!running && seconds >= totalS) onSeek(0);
    setRunning(!running);
  };
  return (
    <div class="playback" role="group" aria-label={t.sheets.play}>
      <button type="button" class="plain" aria-label={running ? t.sheets.pause : t.sheets.play} onClick={toggle}>
        <Icon name={running ? 'pause' : 'play'} />
      </button>
      <input
        type="range"
        min={0}
        max={totalS}
        step="any"
        value={seconds}
        aria-label={t.sheets.time}
        aria-valuetext={clock(seconds)}
        onInput={(event) => {
          setRunning(false);
          onSeek(Number(event.currentTarget.value));
        }}
      />
      <span class="playback-time">
        {clock(seconds)} / {clock(totalS)}
      </span>
      <select aria-label={t.sheets.speed} value={speed} onChange={(event) => setSpeed(Number(event.currentTarget.value))}>
        {kSpeeds.map((value) => (
          <option key={value} value={value}>
            {value}×
          </option>
        ))}
      </select>
      <button type="button" class="plain" aria-label={t.close} onClick={onClose}>
        <Icon name="close" />
      </button>
      <p class="quiet playback-about">
        {t.sheets.playAbout(count(line), count(lines), figure(burnMm / 1000), figure(travelMm / 1000))}
      </p>
    </div>
  );
}
