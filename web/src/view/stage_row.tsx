// The computation's stages as a row of steps, and a loom that fills as they pass.

import { useEffect, useRef, useState } from 'preact/hooks';

import type { Job } from '../api/types.ts';
import { duration, percent } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { kRepeats } from '../state/draft.ts';
import { secondsLeft, type Watched, workDone } from '../state/eta.ts';
import { stagesOf, wholeFraction } from '../state/stages.ts';
import { Swatch } from './swatch.tsx';

const kColumns = 48;

function Loom(props: { readonly fraction: number }) {
  return (
    <div class="loom">
      <Swatch repeat={kRepeats.plain} rows={9} columns={kColumns} woven={Math.round(props.fraction * kColumns)} />
    </div>
  );
}

function Remaining(props: { readonly job: Job }) {
  const { job } = props;
  const watched = useRef<Watched | null>(null);
  const [now, setNow] = useState(() => Date.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 1000);
    return () => clearInterval(timer);
  }, []);
  if (job.state !== 'computing') return null;
  watched.current ??= { sinceMs: Date.now(), share: workDone(job) };
  const left = secondsLeft(job, watched.current, now);
  return (
    <p class="quiet stage-eta">
      {percent(workDone(job))}
      {left !== null && ` · ${t.cut.left(duration(left))}`}
    </p>
  );
}

export function StageRow(props: { readonly job: Job }) {
  const stages = stagesOf(props.job);
  const running = stages.find((stage) => stage.state === 'running');
  return (
    <div class="stages-box">
      <ol class="stages" aria-label={t.stagesLabel}>
        {stages.map((stage) => (
          <li key={stage.name} class={`stage stage-${stage.state}`} aria-current={stage.state === 'running' ? 'step' : undefined}>
            <span class="stage-bar">
              <span class="stage-fill" style={{ transform: `scaleX(${stage.fraction})` }} />
            </span>
            <span class="stage-name">{t.stages[stage.name]}</span>
          </li>
        ))}
      </ol>
      <Remaining job={props.job} />
      {(props.job.state === 'computing' || props.job.state === 'queued') && <Loom fraction={wholeFraction(props.job)} />}
      <p class="visually-hidden" aria-live="polite">
        {running === undefined ? t.jobState[props.job.state] : t.stages[running.name]}
      </p>
    </div>
  );
}
