// One strip by name: what is pointed at, and a way to step through all of them by keyboard.

import { t } from '../messages/messages.ts';
import { chooseStrip, chosenStrip, pointedStrip } from '../state/package_store.ts';
import { neighbourStrip, type StripIndex } from '../state/strip_index.ts';
import { Icon } from './icons.tsx';

function about(index: StripIndex, id: string): string {
  const strip = index.strips.get(id);
  if (strip === undefined) return '';
  const sheets = t.strip.sheets(index.sheetsOfStrip.get(id) ?? []);
  return t.strip.about(t.strip.family[strip.family], strip.quads.length, sheets);
}

export function StripPicker(props: { readonly index: StripIndex }) {
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
    </div>
  );
}
