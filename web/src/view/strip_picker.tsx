// One strip by name: what is pointed at, and a way to step through all of them by keyboard.

import { recutJob } from '../api/client.ts';
import { t } from '../messages/messages.ts';
import { chooseStrip, chosenStrip, pointedStrip } from '../state/package_store.ts';
import { neighbourStrip, type StripIndex } from '../state/strip_index.ts';
import { attempt, feed, go, receive } from '../state/store.ts';
import { AskButton } from './controls.tsx';
import { Icon } from './icons.tsx';

function about(index: StripIndex, id: string): string {
  const strip = index.strips.get(id);
  if (strip === undefined) return '';
  const sheets = t.strip.sheets(index.sheetsOfStrip.get(id) ?? []);
  return t.strip.about(t.strip.family[strip.family], strip.quads.length, sheets);
}

// One strip that was spoilt is cut again from a fresh piece of material.
function Recut(props: { readonly job: string; readonly strip: string }) {
  const { job, strip } = props;
  if (feed.value.jobs.get(job)?.actions.includes('recut') !== true) return null;
  const recut = (): void => {
    void attempt(async () => {
      const made = await recutJob(job, [strip]);
      receive({ type: 'job', seq: null, job: made });
      go({ page: 'job', id: made.id });
    });
  };
  return <AskButton class="button small" label={t.strip.recut} question={t.strip.recutNow} onConfirm={recut} />;
}

export function StripPicker(props: { readonly index: StripIndex; readonly job: string }) {
  const { index } = props;
  const chosen = chosenStrip.value;
  const shown = pointedStrip.value ?? chosen;
  const step = (by: number): void => chooseStrip(neighbourStrip(index, chosen, by));
  return (
    <div class="strip-picker">
      <button type="button" class="plain" aria-label={t.strip.previous} onClick={() => step(-1)}>
        <Icon name="left" />
      </button>
      <select
        aria-label={t.strip.label}
        value={chosen ?? ''}
        onChange={(event) => chooseStrip(event.currentTarget.value || null)}
      >
        <option value="">{t.strip.none}</option>
        {index.order.map((id) => (
          <option key={id} value={id}>
            {id}
          </option>
        ))}
      </select>
      <button type="button" class="plain" aria-label={t.strip.next} onClick={() => step(1)}>
        <Icon name="right" />
      </button>
      <p class="strip-about quiet">
        {shown === null ? (
          t.strip.hint
        ) : (
          <>
            <strong class={`strip-id ${index.strips.get(shown)?.family ?? ''}`}>{shown}</strong> {about(index, shown)}
          </>
        )}
      </p>
      {chosen !== null && <Recut job={props.job} strip={chosen} />}
    </div>
  );
}
