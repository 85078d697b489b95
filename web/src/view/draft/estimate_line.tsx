// What the draft comes to with the settings of the moment.

import { count, duration, figure, weight } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import type { Draft } from '../../state/draft.ts';
import { estimate, scaleOf } from '../../state/estimate.ts';
import type { Looked } from '../../state/mesh_looks.ts';
import { materials } from '../../state/store.ts';
import { numberOf } from '../fields.tsx';

export function EstimateLine(props: { readonly draft: Draft; readonly looks: readonly (Looked | undefined)[] }) {
  const { draft, looks } = props;
  const strip = numberOf(draft.stripWidthMm);
  const longest = draft.units === 'mm' ? null : numberOf(draft.longestSideMm);
  if (strip === null || strip <= 0 || (draft.units === 'longest' && (longest === null || longest <= 0))) return null;
  const material = (id: string) => materials.value.find((one) => one.id === id);
  const all = looks.flatMap((looked) => {
    if (looked?.state !== 'seen') return [];
    return [estimate(looked.look, scaleOf(looked.look, longest), strip, material(draft.weft), material(draft.warp))];
  });
  if (all.length === 0) return null;
  const sum = (of: (one: (typeof all)[number]) => number): number => all.reduce((total, one) => total + of(one), 0);
  const rounded = (value: number): string => count(Number(value.toPrecision(2)));
  const words = t.estimate;
  const facts: readonly (readonly [string, string])[] = [
    [rounded(sum((one) => one.strips)), words.strips],
    [count(sum((one) => one.sheets)), words.sheets],
    [duration(sum((one) => one.laserS)), words.time],
    [weight(Number(sum((one) => one.weightG).toPrecision(2))), words.weight],
  ];
  return (
    <section class="estimate" aria-label={words.title} aria-live="polite">
      <span class="quiet">{words.title}</span>
      <ul class="summary">
        {facts.map(([value, name]) => (
          <li key={name}>
            <strong>{value}</strong> {name}
          </li>
        ))}
        {all.length === 1 && all[0] !== undefined && (
          <li>
            <strong>{all[0].sizeMm.map((side) => figure(side, 3)).join(' × ')}</strong> mm
          </li>
        )}
      </ul>
    </section>
  );
}
