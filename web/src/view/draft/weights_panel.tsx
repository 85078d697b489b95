// How high each cylinder is to be, beside the model on which they are picked.

import { useLayoutEffect, useRef } from 'preact/hooks';

import { count, figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { heightsIn, withHeight, type WovenCylinders } from '../../state/cylinders.ts';
import { cylinderColour } from '../../state/heat.ts';

const kWidest = 8; // Times as high as last time, and so many times lower.

function HeightRow(props: {
  readonly edge: number;
  readonly height: number;
  readonly before: number;
  readonly chosen: boolean;
  readonly onChoose: () => void;
  readonly onHeight: (height: number) => void;
}) {
  const { edge, height, before, chosen } = props;
  const slider = useRef<HTMLInputElement>(null);
  // Before it is painted: keys pressed as soon as the row is seen to be chosen are meant for its slider.
  useLayoutEffect(() => {
    if (chosen) slider.current?.focus();
  }, [chosen]);
  const times = height / before;
  return (
    <li class={chosen ? 'weight chosen' : 'weight'}>
      <label>
        <svg viewBox="0 0 10 10" aria-hidden="true">
          <rect width="10" height="10" rx="2" fill={cylinderColour(edge)} />
        </svg>
        <span>{t.report.cylinder(count(edge + 1))}</span>
        <input
          ref={slider}
          type="range"
          min={-Math.log2(kWidest)}
          max={Math.log2(kWidest)}
          step={0.05}
          value={Math.log2(times)}
          aria-valuetext={t.picks.times(figure(times, 2))}
          onFocus={props.onChoose}
          onInput={(event) => props.onHeight(before * 2 ** Number(event.currentTarget.value))}
        />
        <output>{t.picks.times(figure(times, 2))}</output>
      </label>
    </li>
  );
}

export function WeightsPanel(props: {
  readonly woven: WovenCylinders;
  readonly typed: string;
  readonly edge: number | null; // The one that was picked.
  readonly onEdge: (edge: number) => void;
  readonly onTyped: (typed: string) => void;
}) {
  const { woven, typed, edge, onEdge, onTyped } = props;
  return (
    <ul class="weights" aria-label={t.picks.tools.weights.name}>
      {heightsIn(typed, woven).map((height, k) => (
        <HeightRow
          key={k}
          edge={k}
          height={height}
          before={woven.heights[k] ?? height}
          chosen={edge === k}
          onChoose={() => onEdge(k)}
          onHeight={(now) => onTyped(withHeight(typed, woven, k, now))}
        />
      ))}
    </ul>
  );
}
