// One job: how its computation goes, what came of it, and cutting it.

import { useEffect, useMemo } from 'preact/hooks';

import { packageUrl, removeJob } from '../api/client.ts';
import type { Job } from '../api/types.ts';
import { bytes, count, duration } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { currentCut, newestFirst } from '../state/feed.ts';
import { jobPackage, type JobPackage, loadPackage } from '../state/package_store.ts';
import { formatRoute } from '../state/route.ts';
import { attempt, changeDraft, feed, fetchJob, go, loadMaterials, receive } from '../state/store.ts';
import { AskButton, Chip } from './controls.tsx';
import { CutPanel } from './cut_panel.tsx';
import { FilesPanel } from './files_panel.tsx';
import { FoliationPanel } from './foliation_panel.tsx';
import { Icon } from './icons.tsx';
import { ModelPanel } from './model/model_panel.tsx';
import { ReportPanel } from './report_panel.tsx';
import { SheetPanel } from './sheet_panel.tsx';
import { StageRow } from './stage_row.tsx';

async function remove(job: Job): Promise<void> {
  if (!(await attempt(() => removeJob(job.id)))) return;
  receive({ type: 'job-removed', seq: null, id: job.id });
  go({ page: 'jobs' });
}

// Opens the form with this job's own parameters in it.
function weaveAgain(job: Job): void {
  changeDraft({ type: 'again', job: job.id, name: job.name, file: job.file.name, params: job.params });
  go({ page: 'jobs' });
}

const isFinished = (job: Job): boolean => job.state === 'ready' || job.state === 'done';

// Other results to lay beside this one.
function CompareWith(props: { readonly job: Job }) {
  const { job } = props;
  const others = newestFirst(feed.value.jobs).filter((one) => one.id !== job.id && isFinished(one));
  if (!isFinished(job) || others.length === 0) return null;
  return (
    <select
      class="button compare-with"
      aria-label={t.job.compare}
      value=""
      onChange={(event) => go({ page: 'compare', id: job.id, other: event.currentTarget.value })}
    >
      <option value="">{t.job.compare}</option>
      {others.slice(0, 50).map((one) => (
        <option key={one.id} value={one.id}>
          {one.name}
        </option>
      ))}
    </select>
  );
}

function JobActions(props: { readonly job: Job }) {
  const { job } = props;
  const finished = isFinished(job);
  return (
    <div class="buttons">
      {finished && (
        <a class="button" href={packageUrl(job.id)} download>
          <Icon name="download" />
          {t.files.package}
        </a>
      )}
      {finished && job.summary !== null && (
        <a class="button" href={formatRoute({ page: 'guide', id: job.id })}>
          <Icon name="book" />
          {t.guide.open}
        </a>
      )}
      {job.actions.includes('recompute') && (
        <button type="button" class="button" onClick={() => weaveAgain(job)}>
          <Icon name="edit" />
          {t.job.change}
        </button>
      )}
      <CompareWith job={job} />
      {job.actions.includes('cancel') && (
        <button type="button" class="button" onClick={() => void attempt(() => removeJob(job.id))}>
          {t.job.cancel}
        </button>
      )}
      {job.actions.includes('remove') && (
        <AskButton class="button" label={t.job.remove} question={t.job.reallyRemove} onConfirm={() => void remove(job)} />
      )}
    </div>
  );
}

function Summary(props: { readonly job: Job }) {
  const { summary } = props.job;
  if (summary === null) return null;
  const words = t.job.facts;
  const facts: readonly (readonly [string, string])[] = [
    [count(summary.quads), words.quads],
    [count(summary.strips), words.strips],
    [count(summary.pieces), words.pieces],
    [count(summary.sheets), words.sheets],
    [duration(summary.estimatedS), words.time],
  ];
  return (
    <ul class="summary">
      {facts.map(([value, name]) => (
        <li key={name}>
          <strong>{value}</strong> {name}
        </li>
      ))}
    </ul>
  );
}

function Warnings(props: { readonly job: Job }) {
  const warnings = props.job.summary?.warnings ?? [];
  if (warnings.length === 0) return null;
  return (
    <details class="warnings">
      <summary>
        <Icon name="warn" />
        {t.job.warnings} <span class="quiet">{warnings.length}</span>
      </summary>
      <ul>
        {warnings.map((warning) => (
          <li key={warning}>{warning}</li>
        ))}
      </ul>
    </details>
  );
}

function Failure(props: { readonly job: Job }) {
  const { error } = props.job;
  if (error === null) return null;
  return (
    <div class="failure" role="alert">
      <h2>{t.job.failed}</h2>
      <p>{error.detail}</p>
      <p class="quiet">
        {error.kind} {error.code}
      </p>
    </div>
  );
}

function Figures(props: { readonly job: Job; readonly content: JobPackage }) {
  const { job, figures, artifacts } = props.content;
  return (
    <>
      {figures.foliation !== null && <FoliationPanel job={props.job} figures={figures.foliation} />}
      <ReportPanel figures={figures} />
      <FilesPanel job={job} artifacts={artifacts} />
    </>
  );
}

function Result(props: { readonly job: Job }) {
  const { job } = props;
  useEffect(() => {
    void loadPackage(job.id);
    loadMaterials().catch(() => undefined);
  }, [job.id]);
  const cut = currentCut(feed.value, job.id);
  const now = jobPackage.value;
  const content = now.state === 'ready' && now.job === job.id ? now.content : null;
  // Machines and cuts report several times a second; these panels depend on none of it.
  const model = useMemo(() => content && <ModelPanel name={job.name} content={content} />, [job.name, content]);
  const again = job.actions.includes('recompute');
  const figures = useMemo(() => content && <Figures job={job} content={content} />, [content, again]);
  return (
    <>
      <CutPanel job={job} cut={cut} />
      {now.state === 'failed' && (
        <p class="failure" role="alert">
          {now.fault}
        </p>
      )}
      {now.state === 'loading' && <p class="quiet empty">{t.files.loading}</p>}
      {content !== null && (
        <div class="result">
          {model}
          <SheetPanel job={job} content={content} cut={cut} />
          {figures}
        </div>
      )}
    </>
  );
}

// Not there, or not yet.
function NoJob(props: { readonly known: boolean }) {
  return (
    <div class="page job-page">
      <a class="back" href="#/">
        <Icon name="left" />
        {t.job.back}
      </a>
      <div class="empty">
        <h1>{props.known ? t.job.missing : t.jobs.loading}</h1>
      </div>
    </div>
  );
}

export function JobPage(props: { readonly id: string }) {
  const { id } = props;
  const job = feed.value.jobs.get(id);
  const known = feed.value.known;
  useEffect(() => {
    if (job !== undefined || !known) return;
    fetchJob(id);
  }, [id, job === undefined, known]);
  if (job === undefined) return <NoJob known={known} />;
  const finished = isFinished(job);
  return (
    <div class="page job-page">
      <a class="back" href="#/">
        <Icon name="left" />
        {t.job.back}
      </a>
      <header class="job-head">
        <div class="job-title">
          <h1>{job.name}</h1>
          <Chip kind={job.state}>{t.jobState[job.state]}</Chip>
          <span class="quiet">
            {job.file.name} · {bytes(job.file.bytes)}
          </span>
        </div>
        <JobActions job={job} />
      </header>
      <Failure job={job} />
      {finished ? (
        <div class="job-facts">
          <Summary job={job} />
          <Warnings job={job} />
        </div>
      ) : (
        (job.error === null || job.progress.stage !== '') && <StageRow job={job} />
      )}
      {finished && <Result job={job} />}
    </div>
  );
}
