// What is to be computed and cut, in its order, and what was.

import { useEffect, useState } from 'preact/hooks';

import { recomputeJob } from '../api/client.ts';
import type { Cut, Job, JobState } from '../api/types.ts';
import { getQueue, moveJob, pauseQueue, retryJob } from '../api/workshop.ts';
import { count, dateTime, duration } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { history, totals, waitingCuts, waitingJobs } from '../state/history.ts';
import { formatRoute } from '../state/route.ts';
import { wholeFraction } from '../state/stages.ts';
import { attempt, feed, go, receive } from '../state/store.ts';
import { Bar, Chip, Panel } from './controls.tsx';
import { cutWord } from './cut_words.ts';
import { SelectField, TextField } from './fields.tsx';
import { Icon } from './icons.tsx';
import { useCall } from './use_call.ts';

const kStates: readonly JobState[] = ['ready', 'done', 'failed', 'cancelled'];
const kShown = 100;

function JobLink(props: { readonly job: Job }) {
  return <a href={formatRoute({ page: 'job', id: props.job.id })}>{props.job.name}</a>;
}

// Order within the queue is the daemon's to keep: these only ask for it.
function QueuedRow(props: { readonly job: Job; readonly at: number; readonly next: readonly string[]; readonly onMoved: () => void }) {
  const { job, at, next, onMoved } = props;
  const position = next.indexOf(job.id) + 1; // 0: it does not wait.
  const can = job.state === 'queued' && position > 0;
  const move = (to: number): void => void attempt(() => moveJob(job.id, { position: to })).then(onMoved);
  return (
    <li class="queue-row">
      <span class="queue-number">{count(at + 1)}</span>
      <JobLink job={job} />
      {job.state === 'computing' ? (
        <Bar fraction={wholeFraction(job)} label={t.jobState.computing} />
      ) : (
        <Chip kind={job.state}>{t.jobState[job.state]}</Chip>
      )}
      {can && (
        <span class="queue-moves">
          <button type="button" class="plain" aria-label={t.queue.first(job.name)} disabled={position === 1} onClick={() => move(1)}>
            <Icon name="first" />
          </button>
          <button type="button" class="plain" aria-label={t.queue.up(job.name)} disabled={position === 1} onClick={() => move(position - 1)}>
            <Icon name="up" />
          </button>
          <button type="button" class="plain" aria-label={t.queue.down(job.name)} disabled={position === next.length} onClick={() => move(position + 1)}>
            <Icon name="down" />
          </button>
        </span>
      )}
    </li>
  );
}

function ComputeQueue() {
  const [queue, load] = useCall(getQueue);
  const next = queue.state === 'there' ? queue.value.next : [];
  const jobs = waitingJobs(feed.value.jobs, next);
  const waiting = jobs.filter((job) => job.state === 'queued').map((job) => `${job.id}/${job.version}`).join();
  useEffect(() => void load(), [waiting]);
  const paused = queue.state === 'there' && queue.value.paused;
  const toggle = async (): Promise<void> => {
    if (await attempt(() => pauseQueue(!paused))) await load();
  };
  const button = queue.state === 'there' && (
    <button type="button" class="button small" onClick={() => void toggle()}>
      <Icon name={paused ? 'play' : 'pause'} />
      {paused ? t.queue.resume : t.queue.pause}
    </button>
  );
  return (
    <Panel title={t.queue.computing} aside={button}>
      {paused && <p class="queue-paused">{t.queue.paused} {queue.value.reason}</p>}
      {jobs.length === 0 ? (
        <p class="quiet">{t.queue.nothing}</p>
      ) : (
        <ol class="queue-list">
          {jobs.map((job, index) => (
            <QueuedRow key={job.id} job={job} at={index} next={next} onMoved={() => void load()} />
          ))}
        </ol>
      )}
    </Panel>
  );
}

function CutRow(props: { readonly cut: Cut }) {
  const { cut } = props;
  const job = feed.value.jobs.get(cut.job);
  const moving = cut.state === 'cutting' || cut.state === 'paused';
  return (
    <li class="queue-row">
      {job === undefined ? <span>{cut.job}</span> : <JobLink job={job} />}
      <span class="quiet">{cutWord(cut)}</span>
      {moving && <Bar fraction={cut.progress.fraction} label={t.jobs.cutting} kind="ember" />}
    </li>
  );
}

function CutQueue() {
  const cuts = waitingCuts(feed.value.cuts);
  return (
    <Panel title={t.queue.cutting}>
      {cuts.length === 0 ? (
        <p class="quiet">{t.queue.nothing}</p>
      ) : (
        <ol class="queue-list">
          {cuts.map((cut) => (
            <CutRow key={cut.id} cut={cut} />
          ))}
        </ol>
      )}
    </Panel>
  );
}

async function again(job: Job): Promise<void> {
  await attempt(async () => {
    if (job.actions.includes('retry')) {
      await retryJob(job.id);
      return;
    }
    const made = await recomputeJob(job.id, job.params);
    receive({ type: 'job', seq: null, job: made });
    go({ page: 'job', id: made.id });
  });
}

function HistoryRow(props: { readonly job: Job }) {
  const { job } = props;
  const { summary } = job;
  const can = job.actions.includes('recompute') || job.actions.includes('retry');
  return (
    <tr>
      <th scope="row">
        <JobLink job={job} />
      </th>
      <td>
        <Chip kind={job.state}>{t.jobState[job.state]}</Chip>
      </td>
      <td>{summary === null ? '' : count(summary.strips)}</td>
      <td>{summary === null ? '' : count(summary.sheets)}</td>
      <td>{summary === null ? '' : duration(summary.estimatedS)}</td>
      <td>{dateTime(job.createdAt)}</td>
      <td>
        {can && (
          <button type="button" class="button small" onClick={() => void again(job)}>
            {job.actions.includes('retry') ? t.queue.retry : t.queue.again}
          </button>
        )}
      </td>
    </tr>
  );
}

function HistoryTable() {
  const [words, setWords] = useState('');
  const [state, setState] = useState<JobState | 'all'>('all');
  const jobs = history(feed.value.jobs, { words, state });
  const sum = totals(jobs);
  const columns = t.queue.columns;
  const states = [{ value: 'all' as const, label: t.queue.all }, ...kStates.map((value) => ({ value, label: t.jobState[value] }))];
  return (
    <Panel title={t.queue.history}>
      <div class="history-filter">
        <TextField label={t.queue.search} value={words} onInput={setWords} />
        <SelectField<JobState | 'all'> label={t.queue.state} value={state} choices={states} onChange={setState} />
        <p class="quiet">{t.queue.statistics(count(sum.jobs), count(sum.strips), duration(sum.laserS))}</p>
      </div>
      {jobs.length === 0 ? (
        <p class="quiet">{history(feed.value.jobs, { words: '', state: 'all' }).length === 0 ? t.queue.noHistory : t.queue.notFound}</p>
      ) : (
        <div class="table-box" tabIndex={0} role="group" aria-label={t.queue.history}>
          <table class="history">
            <thead>
              <tr>
                {(['name', 'state', 'strips', 'sheets', 'time', 'date'] as const).map((key) => (
                  <th key={key} scope="col">
                    {columns[key]}
                  </th>
                ))}
                <td />
              </tr>
            </thead>
            <tbody>
              {jobs.slice(0, kShown).map((job) => (
                <HistoryRow key={job.id} job={job} />
              ))}
            </tbody>
          </table>
        </div>
      )}
    </Panel>
  );
}

export function QueuePage() {
  return (
    <div class="page queue-page">
      <h1>{t.queue.title}</h1>
      <ComputeQueue />
      <CutQueue />
      <HistoryTable />
    </div>
  );
}
