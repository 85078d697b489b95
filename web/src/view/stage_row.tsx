// The computation's stages as a row of steps, and a loom that fills as they pass.

import type { Job } from '../api/types.ts';
import { t } from '../messages/messages.ts';
import { kRepeats } from '../state/draft.ts';
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
      {(props.job.state === 'computing' || props.job.state === 'queued') && <Loom fraction={wholeFraction(props.job)} />}
      <p class="visually-hidden" aria-live="polite">
        {running === undefined ? t.jobState[props.job.state] : t.stages[running.name]}
      </p>
    </div>
  );
}
