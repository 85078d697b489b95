// The form that turns dropped meshes, or a job that is there, into new jobs.

import { useEffect, useId } from 'preact/hooks';

import { bytes } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { type Draft, type DraftFile, draftFault, kPatterns, kRepeats } from '../../state/draft.ts';
import { scaleOf } from '../../state/estimate.ts';
import { forgetLooks, lookAtFile, type Looked, looks } from '../../state/mesh_looks.ts';
import { attempt, changeDraft, draft, loadMaterials, materials } from '../../state/store.ts';
import { sendDraft } from '../../state/uploads.ts';
import { kAgainKey, lookAtJob, wovenBefore } from '../../state/woven_before.ts';
import { ChooseFile } from '../drop.tsx';
import { numberOf, TextField } from '../fields.tsx';
import { Icon } from '../icons.tsx';
import { Swatch } from '../swatch.tsx';
import { EstimateLine } from './estimate_line.tsx';
import { FoliationChoices } from './foliation_choices.tsx';
import { MeshFacts } from './mesh_facts.tsx';
import { MoreFields } from './more_fields.tsx';
import { PresetPicker } from './preset_picker.tsx';
import { SheetFields } from './sheet_fields.tsx';
import { PicksPanel } from './picks_panel.tsx';

const set = (values: Partial<Omit<Draft, 'files' | 'again'>>): void => changeDraft({ type: 'set', values });

// Millimetres in the file, or scaled so that the longest side is as long as was said.
function scaleFor(looked: Looked | undefined, now: Draft): number {
  if (looked?.state !== 'seen') return 1;
  return scaleOf(looked.look, now.units === 'mm' ? null : numberOf(now.longestSideMm));
}

function FileRow(props: { readonly entry: DraftFile; readonly looked: Looked | undefined; readonly scale: number }) {
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
      <div class="file-about">
        <span class="quiet file-name">
          {file.name} · {bytes(file.size)}
        </span>
        <MeshFacts looked={props.looked} scale={props.scale} file={file.name} />
      </div>
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

function Measures(props: { readonly fault: string | null }) {
  const { fault } = props;
  const { units, longestSideMm, stripWidthMm } = draft.value;
  return (
    <div class="measures">
      <label class="field">
        <span>{t.draft.units}</span>
        <select value={units} onChange={(event) => set({ units: event.currentTarget.value === 'mm' ? 'mm' : 'longest' })}>
          <option value="longest">{t.draft.unitNames.longest}</option>
          <option value="mm">{t.draft.unitNames.mm}</option>
        </select>
      </label>
      {units === 'longest' && (
        <TextField
          label={t.draft.size}
          value={longestSideMm}
          unit="mm"
          decimal
          bad={fault === 'longest-side'}
          onInput={(typed) => set({ longestSideMm: typed })}
        />
      )}
      <TextField
        label={t.draft.strip}
        value={stripWidthMm}
        unit="mm"
        decimal
        bad={fault === 'strip-width' || fault === 'strip-too-wide'}
        onInput={(typed) => set({ stripWidthMm: typed })}
      />
      <MaterialSelect label={t.draft.weft} family="weft" />
      <MaterialSelect label={t.draft.warp} family="warp" />
      <SheetFields draft={draft.value} onChange={set} />
    </div>
  );
}

function useLooks({ files, again }: Draft): void {
  useEffect(() => {
    forgetLooks(new Set([...files.map((entry) => entry.key), ...(again === null ? [] : [kAgainKey])]));
    for (const { key, file } of files) lookAtFile(key, file);
  }, [files, again === null]);
  useEffect(() => {
    if (again !== null) void lookAtJob(again.job, again.file);
  }, [again?.job]);
}

// The mesh of the job that is woven again.
function AgainRow(props: { readonly file: string; readonly looked: Looked | undefined; readonly scale: number }) {
  const { file, looked, scale } = props;
  return (
    <div class="file-about again-file">
      <span class="quiet file-name">{file}</span>
      <MeshFacts looked={looked} scale={scale} file={file} />
    </div>
  );
}

export function NewJob() {
  useEffect(() => void attempt(() => loadMaterials()), []);
  const now = draft.value;
  useLooks(now);
  const fault = draftFault(now);
  const keys = now.again === null ? now.files.map((entry) => entry.key) : [kAgainKey];
  const seen = keys.map((key) => looks.value.get(key));
  const looked = seen.length === 1 ? seen[0] : undefined;
  const before = now.again !== null && wovenBefore.value?.job === now.again.job ? wovenBefore.value : null;
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
        <h1>{now.again === null ? t.draft.title : t.draft.again(now.again.name)}</h1>
        {now.again === null && <ChooseFile class="button small" label={t.drop.more} />}
      </header>
      <ul class="draft-files">
        {now.files.map((entry) => {
          const one = looks.value.get(entry.key);
          return <FileRow key={entry.key} entry={entry} looked={one} scale={scaleFor(one, now)} />;
        })}
      </ul>
      {now.again !== null && <AgainRow file={now.again.file} looked={looked} scale={scaleFor(looked, now)} />}
      <PresetPicker />
      <PatternPicker />
      <Measures fault={fault} />
      <EstimateLine draft={now} looks={seen} />
      <FoliationChoices draft={now} onChange={set} />
      {now.files.length <= 1 && (
        <details class="draft-more" open={looked?.state === 'seen'}>
          <summary>{t.picks.title}</summary>
          <PicksPanel draft={now} name={now.again?.name ?? now.files[0]?.name ?? ''} looked={looked} before={before} onChange={set} />
        </details>
      )}
      <MoreFields more={now.more} onChange={(more) => set({ more })} />
      <p class="fault" role="alert">
        {fault === null ? '' : t.draft.faults[fault]}
      </p>
      <div class="buttons">
        <button type="submit" class="button primary" disabled={fault !== null}>
          {t.draft.submit(Math.max(1, now.files.length))}
        </button>
        <button type="button" class="button" onClick={() => changeDraft({ type: 'clear' })}>
          {t.draft.cancel}
        </button>
      </div>
    </form>
  );
}
