// From sheets to parts: choose a machine, say that the bed is clear, watch, load the next sheet, done.

import { useEffect, useState } from 'preact/hooks';

import { commandCut, type CutAction, queueCut } from '../api/client.ts';
import type { Cut, Device, Job } from '../api/types.ts';
import { count, duration, shortHash } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { isOver } from '../state/feed.ts';
import { attempt, connectedDevices, materialName } from '../state/store.ts';
import { AskButton, Bar } from './controls.tsx';
import { cutWord } from './cut_words.ts';
import { FinishForm } from './finish_form.tsx';

// The machine that the job was made for, if one was named.
function machineOf(job: Job): string {
  const { output } = job.params;
  return typeof output === 'object' && output !== null && 'device' in output ? String(output.device) : '';
}

function QueueForm(props: { readonly job: Job }) {
  const { job } = props;
  const devices = connectedDevices.value;
  const [device, setDevice] = useState(() => machineOf(job));
  const [busy, setBusy] = useState(false);
  const uncut = job.sheets.filter((sheet) => sheet.state !== 'cut').map((sheet) => sheet.id);
  const sheets = uncut.length === 0 ? job.sheets.map((sheet) => sheet.id) : uncut;
  const chosen = devices.find((one) => one.id === device) ?? devices[0];
  if (chosen === undefined) return <p class="quiet">{t.cut.noMachine}</p>;
  const queue = async (): Promise<void> => {
    setBusy(true);
    await attempt(() => queueCut(job.id, chosen.id, sheets));
    setBusy(false);
  };
  return (
    <div class="cut-queue">
      <p class={uncut.length === 0 ? 'cut-left cut-done' : 'cut-left'}>
        {uncut.length === 0 ? t.cut.allDone : t.cut.sheetsLeft(uncut.length)}
      </p>
      <label class="field inline">
        <span>{t.cut.machine}</span>
        <select value={chosen.id} onChange={(event) => setDevice(event.currentTarget.value)}>
          {devices.map((one: Device) => (
            <option key={one.id} value={one.id}>
              {one.name}
            </option>
          ))}
        </select>
      </label>
      <button type="button" class={uncut.length === 0 ? 'button' : 'button primary'} disabled={busy} onClick={() => void queue()}>
        {uncut.length === 0 ? t.cut.again : t.cut.queue}
      </button>
    </div>
  );
}

// The step that lets a laser fire: names the sheet and the exact program.
function ClearBed(props: { readonly cut: Cut; readonly job: Job; readonly action: 'start' | 'confirm-sheet' }) {
  const { cut, job, action } = props;
  const [clear, setClear] = useState(false);
  useEffect(() => setClear(false), [cut.programSha256]);
  const material = job.sheets.find((sheet) => sheet.id === cut.sheet)?.material ?? '';
  return (
    <div class="clear-bed">
      <div class="clear-bed-words">
        <h2>{t.cut.load(cut.sheet, materialName(material))}</h2>
        <p class="quiet">
          {t.cut.program} <code title={cut.programSha256}>{shortHash(cut.programSha256)}</code>
        </p>
        <label class="tick">
          <input type="checkbox" checked={clear} onChange={(event) => setClear(event.currentTarget.checked)} />
          <span>{t.cut.clear}</span>
        </label>
      </div>
      <div class="clear-bed-act">
        <button
          type="button"
          class="button fire"
          disabled={!clear}
          onClick={() => void attempt(() => commandCut(cut, action))}
        >
          {action === 'start' ? t.cut.start : t.cut.confirm(cut.sheet)}
        </button>
        <p class="quiet">{t.cut.startHint}</p>
      </div>
    </div>
  );
}

function secondsLeft(cut: Cut, job: Job): number {
  const at = cut.sheets.indexOf(cut.sheet);
  return cut.sheets.slice(Math.max(0, at)).reduce((sum, id, index) => {
    const estimate = job.sheets.find((sheet) => sheet.id === id)?.estimatedS ?? 0;
    return sum + estimate * (index === 0 ? 1 - cut.progress.fraction : 1);
  }, 0);
}

function CutProgressBar(props: { readonly cut: Cut; readonly job: Job }) {
  const { cut, job } = props;
  const { fraction, linesAcknowledged, linesTotal } = cut.progress;
  const label = t.cut.progress(cut.sheet, cut.sheets.indexOf(cut.sheet) + 1, cut.sheets.length);
  return (
    <div class="cut-progress">
      <Bar fraction={fraction} label={label} kind={cut.state === 'cutting' ? 'ember' : ''} />
      <p class="quiet">
        <span>{label}</span>
        <span>{t.cut.lines(count(linesAcknowledged), count(linesTotal))}</span>
        <span>{t.cut.left(duration(secondsLeft(cut, job)))}</span>
      </p>
    </div>
  );
}

function CutButtons(props: { readonly cut: Cut }) {
  const { cut } = props;
  const may = (action: CutAction): boolean => cut.actions.includes(action);
  const run = (action: CutAction) => () => void attempt(() => commandCut(cut, action));
  return (
    <div class="buttons">
      {may('pause') && (
        <button type="button" class="button" onClick={run('pause')}>
          {t.cut.pause}
        </button>
      )}
      {may('resume') && (
        <button type="button" class="button primary" onClick={run('resume')}>
          {t.cut.resume}
        </button>
      )}
      {may('abort') && (
        <AskButton class="button danger" label={t.cut.abort} question={t.cut.reallyAbort} onConfirm={run('abort')} />
      )}
    </div>
  );
}

function RunningCut(props: { readonly cut: Cut; readonly job: Job }) {
  const { cut, job } = props;
  const fires = (['start', 'confirm-sheet'] as const).find((action) => cut.actions.includes(action));
  const moving = cut.state === 'cutting' || cut.state === 'paused';
  return (
    <>
      <div class="cut-state">
        <p class={`cut-word cut-${cut.state}`}>{cutWord(cut)}</p>
        <CutButtons cut={cut} />
      </div>
      {moving && <CutProgressBar cut={cut} job={job} />}
      {fires !== undefined && <ClearBed cut={cut} job={job} action={fires} />}
    </>
  );
}

export function CutPanel(props: { readonly job: Job; readonly cut: Cut | null }) {
  const { job, cut } = props;
  const running = cut !== null && !isOver(cut);
  if (!running && !job.actions.includes('cut') && job.state !== 'done') return null;
  return (
    <section class={`panel cut ${running ? `running state-${cut.state}` : ''}`} aria-label={t.cut.title}>
      <div class="visually-hidden" aria-live="polite">
        {cut === null ? '' : cutWord(cut)}
      </div>
      {running ? (
        <RunningCut cut={cut} job={job} />
      ) : (
        <>
          {cut !== null && cut.state !== 'done' && (
            <p class={`cut-word cut-${cut.state}`}>
              {cutWord(cut)}
              {cut.reason !== '' && <span class="quiet"> {cut.reason}</span>}
            </p>
          )}
          {cut !== null && cut.actions.includes('finish') && <FinishForm cut={cut} />}
          {job.actions.includes('cut') ? <QueueForm job={job} /> : <p class="quiet">{t.cut.allDone}</p>}
        </>
      )}
    </section>
  );
}
