// All the other parameters, by what they are about. What nobody touches stays as the daemon has it.

import { t } from '../../messages/messages.ts';
import { fieldFault, type FieldSpec, type Group, kFields, kGroups, type MoreParams, standardText } from '../../state/params.ts';
import { SelectField, TextField, Tick } from '../fields.tsx';

function wordsOf(path: string): { readonly label: string; readonly choices: Readonly<Record<string, string>> } {
  const words = (t.params.fields as Readonly<Record<string, string>>)[path] ?? path;
  const choices = (t.params.choices as Readonly<Record<string, Readonly<Record<string, string>>>>)[path] ?? {};
  return { label: words, choices };
}

function Field(props: { readonly spec: FieldSpec; readonly typed: string | undefined; readonly onChange: (typed: string) => void }) {
  const { spec, typed, onChange } = props;
  const { label, choices } = wordsOf(spec.path);
  const value = typed ?? standardText(spec);
  if (spec.kind === 'flag') {
    return (
      <Tick checked={value === 'true'} onChange={(checked) => onChange(String(checked))}>
        {label}
      </Tick>
    );
  }
  if (spec.kind === 'choice') {
    return (
      <SelectField label={label} value={value} choices={spec.choices.map((one) => ({ value: one, label: choices[one] ?? one }))} onChange={onChange} />
    );
  }
  return (
    <TextField
      label={label}
      value={value}
      decimal
      bad={fieldFault(spec, typed)}
      placeholder={spec.standard === null ? t.params.automatic : ''}
      {...(spec.unit === undefined ? {} : { unit: spec.unit })}
      onInput={onChange}
    />
  );
}

function changedIn(group: Group, more: MoreParams): number {
  return kFields[group].filter((spec) => more[spec.path] !== undefined && more[spec.path] !== standardText(spec)).length;
}

export function MoreFields(props: { readonly more: MoreParams; readonly onChange: (more: MoreParams) => void }) {
  const { more, onChange } = props;
  return (
    <>
      {kGroups.map((group) => {
        const changed = changedIn(group, more);
        return (
          <details key={group} class="draft-more">
            <summary>
              {t.params.groups[group]} {changed > 0 && <span class="tag">{t.params.changed(changed)}</span>}
            </summary>
            <div class="measures">
              {kFields[group].map((spec) => (
                <Field
                  key={spec.path}
                  spec={spec}
                  typed={more[spec.path]}
                  onChange={(typed) => onChange({ ...more, [spec.path]: typed })}
                />
              ))}
            </div>
          </details>
        );
      })}
    </>
  );
}
