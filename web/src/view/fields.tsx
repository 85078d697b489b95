// Labelled inputs, as all forms use them.

import type { ComponentChildren } from 'preact';

export function TextField(props: {
  readonly label: string;
  readonly value: string;
  readonly onInput: (typed: string) => void;
  readonly type?: 'text' | 'password' | 'color';
  readonly unit?: string;
  readonly bad?: boolean;
  readonly required?: boolean;
  readonly decimal?: boolean;
  readonly placeholder?: string;
  readonly complete?: string;
  readonly list?: string;
}) {
  return (
    <label class="field">
      <span>{props.label}</span>
      <span class={props.unit === undefined ? '' : 'with-unit'}>
        <input
          type={props.type ?? 'text'}
          inputMode={props.decimal === true ? 'decimal' : 'text'}
          value={props.value}
          aria-invalid={props.bad === true}
          required={props.required ?? false}
          placeholder={props.placeholder ?? ''}
          autocomplete={props.complete ?? 'off'}
          {...(props.list === undefined ? {} : { list: props.list })}
          onInput={(event) => props.onInput(event.currentTarget.value)}
        />
        {props.unit !== undefined && <span aria-hidden="true">{props.unit}</span>}
      </span>
    </label>
  );
}

export function SelectField<Value extends string>(props: {
  readonly label: string;
  readonly value: Value;
  readonly choices: readonly { readonly value: Value; readonly label: string }[];
  readonly onChange: (value: Value) => void;
}) {
  return (
    <label class="field">
      <span>{props.label}</span>
      <select
        value={props.value}
        onChange={(event) => {
          const chosen = props.choices.find((one) => one.value === event.currentTarget.value);
          if (chosen !== undefined) props.onChange(chosen.value);
        }}
      >
        {props.choices.map((one) => (
          <option key={one.value} value={one.value}>
            {one.label}
          </option>
        ))}
      </select>
    </label>
  );
}

export function Tick(props: { readonly checked: boolean; readonly onChange: (checked: boolean) => void; readonly children: ComponentChildren }) {
  return (
    <label class="tick">
      <input type="checkbox" checked={props.checked} onChange={(event) => props.onChange(event.currentTarget.checked)} />
      <span>{props.children}</span>
    </label>
  );
}

// A number as typed, with point or comma; null if it is none.
export function numberOf(typed: string): number | null {
  const value = Number(typed.trim().replace(',', '.'));
  return typed.trim() !== '' && Number.isFinite(value) ? value : null;
}

// "Big laser!" → "big-laser": an id made of a name, unlike those that are taken.
export function idFor(name: string, taken: readonly string[]): string {
  const plain = name.normalize('NFKD').toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-+|-+$/g, '').slice(0, 40) || 'item';
  for (let number = 1; ; number += 1) {
    const id = number === 1 ? plain : `${plain}-${number}`;
    if (!taken.includes(id)) return id;
  }
}
