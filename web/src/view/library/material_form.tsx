// A material: what it is, the sheets it comes in, and how the laser treats it.

import { useState } from 'preact/hooks';

import type { Material } from '../../api/types.ts';
import { putMaterial } from '../../api/workshop.ts';
import { t } from '../../messages/messages.ts';
import { kBeamWorks, materialFields, materialRecord, type MaterialDraft, materialFault } from '../../state/material_draft.ts';
import { attempt, loadMaterials, materials } from '../../state/store.ts';
import { Dialog, DialogButtons } from '../dialog.tsx';
import { idFor, TextField } from '../fields.tsx';

export function MaterialForm(props: { readonly material: Material | null; readonly onClose: () => void }) {
  const { material, onClose } = props;
  const words = t.materials;
  const [draft, setDraft] = useState<MaterialDraft>(() => materialFields(material?.raw ?? {}));
  const [busy, setBusy] = useState(false);
  const set = (values: Partial<MaterialDraft>): void => setDraft({ ...draft, ...values });
  const fault = materialFault(draft);
  const save = async (): Promise<void> => {
    setBusy(true);
    const id = material?.id ?? idFor(draft.name, materials.value.map((one) => one.id));
    const done = await attempt(async () => {
      await putMaterial(id, materialRecord(draft, material?.raw ?? {}));
      await loadMaterials(true);
    });
    setBusy(false);
    if (done) onClose();
  };
  const measure = (key: 'thickness' | 'weight' | 'kerf' | 'width' | 'height', unit: string) => (
    <TextField label={words.fields[key]} value={draft[key]} unit={unit} decimal bad={fault === key} onInput={(typed) => set({ [key]: typed })} />
  );
  return (
    <Dialog title={material === null ? words.addTitle : material.name} onClose={onClose}>
      <form
        class="dialog-form"
        onSubmit={(event) => {
          event.preventDefault();
          if (fault === null) void save();
        }}
      >
        <div class="measures">
          <TextField label={t.draft.name} value={draft.name} required onInput={(name) => set({ name })} />
          <TextField label={words.fields.colour} type="color" value={draft.colour} onInput={(colour) => set({ colour })} />
          {measure('thickness', 'mm')}
          {measure('weight', 'g/m²')}
          {measure('kerf', 'mm')}
          {measure('width', 'mm')}
          {measure('height', 'mm')}
        </div>
        <table class="laser-table">
          <thead>
            <tr>
              <th scope="col">{words.beam}</th>
              {(['power', 'feed', 'passes'] as const).map((key) => (
                <th key={key} scope="col">
                  {words.fields[key]}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {kBeamWorks.map((work) => (
              <tr key={work}>
                <th scope="row">{words.works[work]}</th>
                {(['power', 'feed', 'passes'] as const).map((key) => (
                  <td key={key}>
                    <input
                      type="text"
                      inputMode="decimal"
                      aria-label={`${words.works[work]}: ${words.fields[key]}`}
                      aria-invalid={fault === `${work}.${key}`}
                      value={draft.beam[work][key]}
                      onInput={(event) =>
                        set({ beam: { ...draft.beam, [work]: { ...draft.beam[work], [key]: event.currentTarget.value } } })
                      }
                    />
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
        <p class="fault" role="alert">
          {fault === null || fault === 'name' ? '' : words.fault}
        </p>
        <DialogButtons busy={busy} can={fault === null} label={t.save} onClose={onClose} />
      </form>
    </Dialog>
  );
}
