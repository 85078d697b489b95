// The first page: bring a mesh, and see what became of the others.

import { useEffect, useState } from 'preact/hooks';

import type { Job } from '../api/types.ts';
import { age, count, duration } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { kRepeats } from '../state/draft.ts';
import { currentCut, newestFirst } from '../state/feed.ts';
import { formatRoute } from '../state/route.ts';
import { wholeFraction } from '../state/stages.ts';
import { draft, feed } from '../state/store.ts';
import { forget, type Sending, sendings } from '../state/uploads.ts';
import { Bar, Chip } from './controls.tsx';
import { ChooseFile } from './drop.tsx';
import { lazy } from './lazy.tsx';
import { Swatch } from './swatch.tsx';

const NewJob = lazy(() => import('./draft/new_job.tsx').then((form) => form.NewJob));

function Hero() {
  return (
    <section class="hero" aria-label={t.drop.title}>
      <div class="hero-words">
        <h1>{t.drop.title}</h1>
        <p>{t.drop.lead}</p>
        <p class="hero-act">
          <ChooseFile class="button primary" label={t.drop.choose} />
          <span class="quiet">{t.drop.formats}</span>
        </p>
      </div>
      <div class="hero-picture">
        <Swatch repeat={kRepeats['twill-2x2']} rows={8} columns={18} />
      </div>
    </section>
  );
}

function SendingRow(props: { readonly sending: Sending }) {
  const { key, name, fraction, fault } = props.sending;
  return (
    <li class="job-row sending">
      <span class="job-name">{fault === null ? t.upload.sending(name) : t.upload.failed(name)}</span>
      {fault === null ? <Bar fraction={fraction} label={t.upload.sending(name)} /> : <span class="fault" role="alert">{fault}</span>}
      <button type="button" class="button small" onClick={() => forget(key)}>
        {fault === null ? t.upload.cancel : t.dismiss}
      </button>
    </li>
  );
}

function JobFacts(props: { readonly job: Job }) {
  const { job } = props;
  if (job.state === 'computing') {
    return <Bar fraction={wholeFraction(job)} label={t.jobState.computing} />;
  }
  const cut = currentCut(feed.value, job.id);
  if (cut !== null && (cut.state === 'cutting' || cut.state === 'paused')) {
    return <Bar fraction={cut.progress.fraction} label={t.jobs.cutting} kind="ember" />;
  }
  if (job.error !== null) return <span class="quiet job-fault">{job.error.detail}</span>;
  if (job.summary === null) return <span class="quiet">{job.file.name}</span>;
  const { strips, sheets, estimatedS } = job.summary;
  return (
    <span class="quiet">
      {t.jobs.counts(count(strips), count(sheets))}, {duration(estimatedS)}
    </span>
  );
}

function JobRow(props: { readonly job: Job; readonly now: Date }) {
  const { job, now } = props;
  return (
    <li class="job-row" data-job={job.id}>
      <a class="job-name" href={formatRoute({ page: 'job', id: job.id })}>
        {job.name}
      </a>
      <JobFacts job={job} />
      <Chip kind={job.state}>{t.jobState[job.state]}</Chip>
      <time class="quiet" dateTime={job.createdAt}>
        {age(job.createdAt, now)}
      </time>
    </li>
  );
}

// The time, for ages on the page; moves on by itself.
function useNow(): Date {
  const [now, setNow] = useState(() => new Date());
  useEffect(() => {
    const timer = setInterval(() => setNow(new Date()), 30_000);
    return () => clearInterval(timer);
  }, []);
  return now;
}

export function JobsPage() {
  const now = useNow();
  const jobs = newestFirst(feed.value.jobs);
  const rows = jobs.length + sendings.value.length;
  return (
    <div class="page jobs-page">
      {draft.value.files.length === 0 && draft.value.again === null ? <Hero /> : <NewJob />}
      <section class="jobs" aria-label={t.jobs.title}>
        <h2>{t.jobs.title}</h2>
        {rows === 0 ? (
          <p class="quiet empty">{feed.value.known ? t.jobs.none : t.jobs.loading}</p>
        ) : (
          <ul class="job-list">
            {sendings.value.map((sending) => (
              <SendingRow key={`s${sending.key}`} sending={sending} />
            ))}
            {jobs.map((job) => (
              <JobRow key={job.id} job={job} now={now} />
            ))}
          </ul>
        )}
      </section>
    </div>
  );
}
