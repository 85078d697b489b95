// Sets of parameters that were given a name: taken into the form, or kept from it.

import { useEffect, useState } from 'preact/hooks';

import { listPresets, type Preset, putPreset } from '../../api/workshop.ts';
import { t } from '../../messages/messages.ts';
import { draftFault, draftParams } from '../../state/draft.ts';
import { attempt, changeDraft, draft, say } from '../../state/store.ts';
import { idFor, TextField } from '../fields.tsx';

export function PresetPicker() {
  const [presets, setPresets] = useState<readonly Preset[] | null>(null);
  const [naming, setNaming] = useState<string | null>(null);
  const load = (): Promise<void> => listPresets().then(setPresets, () => undefined);
  useEffect(() => void load(), []);
  if (presets === null) return null; // A daemon that knows none.
  const keepAs = async (name: string): Promise<void> => {
    const id = presets.find((one) => one.name === name)?.id ?? idFor(name, presets.map((one) => one.id));
    if (!(await attempt(() => putPreset(id, name, draftParams(draft.value))))) return;
    say('said', t.draft.preset.kept(name));
    setNaming(null);
    await load();
  };
  return (
    <div class="preset-picker">
      <label class="field">
        <span>{t.draft.preset.label}</span>
        <select
          value=""
          onChange={(event) => {
            const chosen = presets.find((one) => one.id === event.currentTarget.value);
            if (chosen !== undefined) changeDraft({ type: 'preset', params: chosen.params });
          }}
        >
          <option value="">{t.draft.preset.choose}</option>
          {presets.map((preset) => (
            <option key={preset.id} value={preset.id}>
              {preset.name}
            </option>
          ))}
        </select>
      </label>
      {naming === null ? (
        <button type="button" class="button" disabled={draftFault(draft.value) !== null} onClick={() => setNaming('')}>
          {t.draft.preset.keep}
        </button>
      ) : (
        <>
          <TextField label={t.draft.preset.name} value={naming} onInput={setNaming} />
          <button type="button" class="button" disabled={naming.trim() === ''} onClick={() => void keepAs(naming.trim())}>
            {t.save}
          </button>
        </>
      )}
    </div>
  );
}
