// The picture of a step: the strips that lie, those of the step lit up, the crossing at hand.

import { useEffect, useMemo } from 'preact/hooks';

import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { laidBefore, type Step } from '../../state/assembly.ts';
import type { JobPackage } from '../../state/package_store.ts';
import { live, turnByKey, useScene } from '../model/use_scene.ts';
import type { GuideShot } from '../model/guide_scene.ts';

export function shotOf(steps: readonly Step[], at: number, crossing: number | null): GuideShot {
  const step = steps[at];
  const [lay] = step?.lays ?? [];
  const single = step?.kind === 'weave' && lay !== undefined;
  return {
    laid: laidBefore(steps, at),
    current: step?.strips ?? [],
    arrow: single ? lay.strip : null,
    quad: single && crossing !== null ? (lay.crossings[crossing]?.quad ?? null) : null,
  };
}

export function StepPicture(props: {
  readonly content: JobPackage;
  readonly steps: readonly Step[];
  readonly at: number;
  readonly crossing: number;
}) {
  const { content, steps, at, crossing } = props;
  const [setCanvas, state] = useScene(
    async (canvas) => (await import('../model/guide_scene.ts')).createGuideScene(canvas, content),
    [content],
  );
  const scene = live(state);
  const shot = useMemo(() => shotOf(steps, at, crossing), [steps, at, crossing]);
  useEffect(() => scene?.show(shot), [scene, shot]);
  useEffect(() => scene?.face(shot.current), [scene, at]);
  return (
    <div class="view guide-picture">
      <canvas
        ref={setCanvas}
        role="img"
        tabIndex={0}
        aria-label={t.guide.picture(count(at + 1))}
        data-ready={scene !== null}
        onKeyDown={(event) => scene !== null && turnByKey(scene, event)}
      />
      {state === 'loading' && <p class="view-note">{t.model.loading}</p>}
      {state === 'none' && <p class="view-note">{t.model.none}</p>}
    </div>
  );
}
