// How the surface is laid out, among what fits together.

import { t } from '../../messages/messages.ts';
import type { Draft } from '../../state/draft.ts';
import {
  kComponents,
  kModes,
  kPantsSources,
  kPunctures,
  kSweepFunctions,
  usesPants,
} from '../../state/foliation_choices.ts';
import { SelectField } from '../fields.tsx';

type Values = Partial<Pick<Draft, 'mode' | 'pants' | 'sweep' | 'punctures' | 'components'>>;

export function FoliationChoices(props: { readonly draft: Draft; readonly onChange: (values: Values) => void }) {
  const { onChange } = props;
  const { mode, pants, sweep, punctures, components } = props.draft;
  const words = t.draft.foliation;
  const named = <V extends string>(all: readonly V[], names: Readonly<Record<V, string>>) =>
    all.map((value) => ({ value, label: names[value] }));
  return (
    <details class="draft-more">
      <summary>{words.title}</summary>
      <div class="measures">
        <SelectField label={words.mode} value={mode} choices={named(kModes, t.modes)} onChange={(chosen) => onChange({ mode: chosen })} />
        {usesPants(mode) && (
          <>
            <SelectField
              label={words.pants}
              value={pants}
              choices={named(kPantsSources, words.pantsNames)}
              onChange={(chosen) => onChange({ pants: chosen })}
            />
            <SelectField
              label={words.sweep}
              value={sweep}
              choices={named(kSweepFunctions, words.sweepNames)}
              onChange={(chosen) => onChange({ sweep: chosen })}
            />
          </>
        )}
        <SelectField
          label={words.punctures}
          value={punctures}
          choices={named(kPunctures, words.punctureNames)}
          onChange={(chosen) => onChange({ punctures: chosen })}
        />
        <SelectField
          label={words.components}
          value={components}
          choices={named(kComponents, words.componentNames)}
          onChange={(chosen) => onChange({ components: chosen })}
        />
      </div>
    </details>
  );
}
