// A strip from its beginning to its end, with every crossing drawn as it is made: the strip over the bar,
// or the bar over the strip. Each is a button that says how far one has got.

import { useEffect, useRef } from 'preact/hooks';

import type { MoveCrossing } from '../../api/assembly_file.ts';
import type { Family } from '../../api/package_files.ts';
import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';

// `family` is that of the strip that is laid; the others are of the other one.
export function CrossingPicture(props: { readonly way: MoveCrossing['way']; readonly family: Family }) {
  const { way, family } = props;
  const strip = <rect class={`band-${family}`} x="-1" y="17" width="50" height="26" />;
  const bar = <rect class={`band-${family === 'weft' ? 'warp' : 'weft'}`} x="11" y="-1" width="26" height="62" />;
  return (
    <svg class="crossing-picture" viewBox="0 0 48 60" aria-hidden="true">
      {way === 'over' ? bar : strip}
      <rect class="band-shade" {...(way === 'over' ? { x: 11, y: 12, width: 26, height: 36 } : { x: 6, y: 17, width: 36, height: 26 })} />
      {way === 'over' ? strip : bar}
      {way === 'threaded' && <circle class="band-ring" cx="24" cy="30" r="19" />}
    </svg>
  );
}

export function CrossingBand(props: {
  readonly id: string;
  readonly family: Family;
  readonly crossings: readonly MoveCrossing[];
  readonly at: number;
  readonly onGo: (at: number) => void;
}) {
  const { id, family, crossings, at, onGo } = props;
  const list = useRef<HTMLOListElement>(null);
  useEffect(() => {
    const current = list.current?.children[Math.min(at, crossings.length - 1)];
    if (!(current instanceof HTMLElement) || list.current === null) return;
    list.current.scrollTo({ left: current.offsetLeft - list.current.clientWidth / 2 + current.clientWidth / 2 });
  }, [at, id]);
  return (
    <ol class="band" ref={list} aria-label={t.guide.band(id)}>
      {crossings.map((crossing, index) => (
        <li key={index}>
          <button
            type="button"
            class={`crossing ${index < at ? 'made' : ''}`}
            aria-current={index === at ? 'step' : undefined}
            onClick={() => onGo(index === at ? index + 1 : index)}
          >
            <CrossingPicture way={crossing.way} family={family} />
            <span class="visually-hidden">{count(index + 1)}: </span>
            <span class="crossing-id">{crossing.strip}</span>{' '}
            <span class="crossing-way">{t.guide.ways[crossing.way]}</span>
          </button>
        </li>
      ))}
    </ol>
  );
}
