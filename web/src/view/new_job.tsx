// The form that turns dropped meshes into jobs.

import { useEffect, useId } from 'preact/hooks';

import { bytes } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import {
  type Draft,
  type DraftFile,
  draftFault,
  kComponents,
  kModes,
  kPantsSources,
  kPatterns,
  kPunctures,
  kRepeats,
  kSweepFunctions,
  usesPants,
  usesPlaces,
} from '../state/draft.ts';
import { attempt, changeDraft, draft, loadMaterials, materials } from '../state/store.ts';
import { sendDraft } from '../state/uploads.ts';
import { ChooseFile } from './drop.tsx';
import { Icon } from './icons.tsx';
import { Swatch } from './swatch.tsx';

const set = (values: Partial<Omit<Draft, 'files'>>): void => changeDraft({ type: 'set', values });

function FileRow(props: { readonly entry: DraftFile }) {
  const { key, file, name } = props.entry;
  return (
    <li class="draft-file">
      <label class="field">
        <span>{t.draft.name}</span>
        <input
          type="text"
          value={name}
          maxLength={120}
          onInput={(event) => changeDraft({ type: 'rename', key, name: event.currentTarget.value })}
        />
      </label>
      <span class="quiet file-name">
        {file.name} · {bytes(file.size)}
      </span>
      <button
        type="button"
        class="plain"
        aria-label={t.draft.remove(file.name)}
        onClick={() => changeDraft({ type: 'drop', key })}
      >
        <Icon name="close" />
      </button>
    </li>
  );
}

function Measure(props: { readonly label: string; readonly value: string; readonly bad: boolean; readonly onInput: (typed: string) => void }) {
  return (
    <label class="field measure">
      <span>{props.label}</span>
      <span class="with-unit">
        <input
          type="text"
          inputMode="decimal"
          value={props.value}
          aria-invalid={props.bad}
          onInput={(event) => props.onInput(event.currentTarget.value)}
        />
        <span aria-hidden="true">mm</span>
      </span>
    </label>
  );
}

function PatternPicker() {
  const group = useId();
  return (
    <fieldset class="patterns">
      <legend>{t.draft.pattern}</legend>
      <div class="pattern-row">
        {kPatterns.map((pattern) => (
          <label key={pattern} class="pattern">
            <input
              type="radio"
              name={group}
              class="visually-hidden"
              checked={draft.value.pattern === pattern}
              onChange={() => set({ pattern })}
            />
            <Swatch repeat={kRepeats[pattern]} rows={6} columns={6} />
            <span>{t.patterns[pattern]}</span>
          </label>
        ))}
      </div>
    </fieldset>
  );
}

function MaterialSelect(props: { readonly label: string; readonly family: 'weft' | 'warp' }) {
  const { family } = props;
  const chosen = materials.value.find((material) => material.id === draft.value[family]);
  return (
    <label class="field">
      <span>{props.label}</span>
      <span class="with-colour">
        <span class={`colour ${chosen === undefined ? family : ''}`} style={chosen === undefined ? {} : { background: chosen.colour }} />
        <select value={draft.value[family]} onChange={(event) => set({ [family]: event.currentTarget.value })}>
          <option value="">{t.draft.standard}</option>
          {materials.value.map((material) => (
            <option key={material.id} value={material.id}>
              {material.name}
            </option>
          ))}
        </select>
      </span>
    </label>
  );
}

function Choices<Value extends string>(props: {
  readonly label: string;
  readonly names: Readonly<Record<Value, string>>;
  readonly all: readonly Value[];
  readonly value: Value;
  readonly onChoose: (value: Value) => void;
}) {
  const { names, all } = props;
  const choose = (name: string): void => {
    const value = all.find((one) => one === name);
    if (value !== undefined) props.onChoose(value);
  };
  return (
    <label class="field">
      <span>{props.label}</span>
      <select value={props.value} onChange={(event) => choose(event.currentTarget.value)}>
        {all.map((value) => (
          <option key={value} value={value}>
            {names[value]}
          </option>
        ))}
      </select>
    </label>
  );
}

function FoliationChoices() {
  const { mode, pants, sweep, punctures, components, near } = draft.value;
  const words = t.draft.foliation;
  return (
    <details class="foliation-choices">
      <summary>{words.title}</summary>
      <div class="measures">
        <Choices label={words.mode} names={t.modes} all={kModes} value={mode} onChoose={(chosen) => set({ mode: chosen })} />
        {usesPants(mode) && (
          <>
            <Choices label={words.pants} names={words.pantsNames} all={kPantsSources} value={pants} onChoose={(chosen) => set({ pants: chosen })} />
            <Choices label={words.sweep} names={words.sweepNames} all={kSweepFunctions} value={sweep} onChoose={(chosen) => set({ sweep: chosen })} />
          </>
        )}
        <Choices label={words.punctures} names={words.punctureNames} all={kPunctures} value={punctures} onChoose={(chosen) => set({ punctures: chosen })} />
        <Choices label={words.components} names={words.componentNames} all={kComponents} value={components} onChoose={(chosen) => set({ components: chosen })} />
        {usesPlaces(mode) && (
          <label class="field">
            <span>{words.near}</span>
            <input type="text" inputMode="numeric" value={near} onInput={(event) => set({ near: event.currentTarget.value })} />
          </label>
        )}
      </div>
    </details>
  );
}

export function NewJob() {
  useEffect(() => void attempt(() => loadMaterials()), []);
  const now = draft.value;
  const fault = draftFault(now);
  return (
    <form
      class="panel new-job"
      aria-label={t.draft.title}
      onSubmit={(event) => {
        event.preventDefault();
        if (fault === null) void sendDraft();
      }}
    >
      <header class="panel-head">
        <h2>{t.draft.title}</h2>
        <ChooseFile class="button small" label={t.drop.more} />
      </header>
      <ul class="draft-files">
        {now.files.map((entry) => (
          <FileRow key={entry.key} entry={entry} />
        ))}
      </ul>
      <PatternPicker />
      <div class="measures">
        <Measure
          label={t.draft.size}
          value={now.longestSideMm}
          bad={fault === 'longest-side'}
          onInput={(longestSideMm) => set({ longestSideMm })}
        />
        <Measure
          label={t.draft.strip}
          value={now.stripWidthMm}
          bad={fault === 'strip-width' || fault === 'strip-too-wide'}
          onInput={(stripWidthMm) => set({ stripWidthMm })}
        />
        <MaterialSelect label={t.draft.weft} family="weft" />
        <MaterialSelect label={t.draft.warp} family="warp" />
      </div>
      <FoliationChoices />
      <p class="fault" role="alert">
        {fault === null ? '' : t.draft.faults[fault]}
      </p>
      <div class="buttons">
        <button type="submit" class="button primary" disabled={fault !== null}>
          {t.draft.submit(now.files.length)}
        </button>
        <button type="button" class="button" onClick={() => changeDraft({ type: 'clear' })}>
          {t.draft.cancel}
        </button>
      </div>
    </form>
  );
}
