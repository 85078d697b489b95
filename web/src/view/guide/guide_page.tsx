// The assembly guide: one step at a time, made for a phone at the bench and one free hand.

import { useEffect, useMemo, useRef, useState } from 'preact/hooks';

import { artifactUrl } from '../../api/client.ts';
import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { type GuideAction, type GuideProgress, planSteps, readProgress, reduceGuide, type Step } from '../../state/assembly.ts';
import { jobPackage, type JobPackage, loadPackage } from '../../state/package_store.ts';
import { formatRoute } from '../../state/route.ts';
import { keep, recall } from '../../state/settings.ts';
import { feed, fetchJob, loadMaterials } from '../../state/store.ts';
import { AskButton, Segmented } from '../controls.tsx';
import { Icon } from '../icons.tsx';
import { CrossingBand } from './band.tsx';
import { PartsList } from './parts_list.tsx';
import { PrintedGuide } from './printed.tsx';
import { StepPicture } from './step_picture.tsx';
import { stepTitle, stepWords } from './words.ts';

const keyOf = (job: string): string => `leafcutter.guide.${job}`;

type Dispatch = (action: GuideAction) => void;

function useProgress(job: string, steps: readonly Step[]): readonly [GuideProgress, Dispatch] {
  const [progress, setProgress] = useState(() => readProgress(recall(keyOf(job)), steps.length));
  useEffect(() => setProgress(readProgress(recall(keyOf(job)), steps.length)), [job, steps.length]);
  const dispatch = (action: GuideAction): void =>
    setProgress((now) => {
      const next = reduceGuide(now, action, steps.length);
      keep(keyOf(job), JSON.stringify(next));
      return next;
    });
  return [progress, dispatch];
}

function StepView(props: { readonly content: JobPackage; readonly step: Step; readonly progress: GuideProgress; readonly dispatch: Dispatch }) {
  const { content, step, progress, dispatch } = props;
  const { before, after } = stepWords(step);
  const [lay] = step.lays;
  const family = content.index.strips.get(lay?.strip ?? '')?.family ?? 'weft';
  const regions = content.assembly.regions.length;
  return (
    <div class="guide-words">
      {regions > 1 && <p class="quiet">{t.guide.region(count(step.region + 1), count(regions))}</p>}
      <h2 aria-live="polite">{stepTitle(step)}</h2>
      {before.map((text) => (
        <p key={text}>{text}</p>
      ))}
      {step.kind === 'weave' && lay !== undefined && (
        <CrossingBand
          id={lay.strip}
          family={family}
          crossings={lay.crossings}
          at={progress.crossing}
          onGo={(at) => dispatch({ type: 'crossing', at })}
        />
      )}
      {after.length > 0 && (
        <ul class="guide-joints">
          {after.map((text) => (
            <li key={text}>{text}</li>
          ))}
        </ul>
      )}
    </div>
  );
}

function StepList(props: { readonly steps: readonly Step[]; readonly at: number; readonly onGo: (step: number) => void }) {
  const list = useRef<HTMLOListElement>(null);
  useEffect(() => list.current?.querySelector('[aria-current]')?.scrollIntoView({ block: 'center' }), []);
  return (
    <ol class="step-list" ref={list}>
      {props.steps.map((step, index) => (
        <li key={index}>
          <button
            type="button"
            class={index < props.at ? 'made' : ''}
            aria-current={index === props.at ? 'step' : undefined}
            onClick={() => props.onGo(index)}
          >
            <span class="step-number">{index < props.at ? <Icon name="check" /> : count(index + 1)}</span>
            {stepTitle(step)}
          </button>
        </li>
      ))}
    </ol>
  );
}

function Finished(props: { readonly content: JobPackage; readonly dispatch: Dispatch }) {
  return (
    <div class="guide-finished">
      <Icon name="check" />
      <h2>{t.guide.finished}</h2>
      <p>{t.guide.finishedText(count(props.content.index.order.length))}</p>
      <AskButton class="button" label={t.guide.restart} question={t.guide.reallyRestart} onConfirm={() => props.dispatch({ type: 'restart' })} />
    </div>
  );
}

type Tab = 'step' | 'all' | 'parts';

function Bench(props: { readonly job: string; readonly content: JobPackage; readonly steps: readonly Step[]; readonly tab: Tab; readonly onTab: (tab: Tab) => void }) {
  const { job, content, steps, tab, onTab } = props;
  const [progress, dispatch] = useProgress(job, steps);
  const at = Math.min(progress.step, steps.length);
  const step = steps[at];
  useEffect(() => {
    const onKey = (event: KeyboardEvent): void => {
      const typing = event.target instanceof HTMLElement && event.target.closest('input, select, textarea, canvas') !== null;
      if (typing || tab !== 'step' || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === 'ArrowRight' || event.key === 'PageDown') dispatch({ type: 'next' });
      else if (event.key === 'ArrowLeft' || event.key === 'PageUp') dispatch({ type: 'back' });
      else return;
      event.preventDefault();
    };
    addEventListener('keydown', onKey);
    return () => removeEventListener('keydown', onKey);
  }, [tab, steps]);
  const jump = (to: number): void => {
    dispatch({ type: 'go', step: to });
    onTab('step');
  };
  return (
    <>
      <p class="guide-at">
        <span class="guide-bar" aria-hidden="true">
          <span style={{ transform: `scaleX(${steps.length === 0 ? 0 : at / steps.length})` }} />
        </span>
        <span>{step === undefined ? t.guide.finished : t.guide.step(count(at + 1), count(steps.length))}</span>
      </p>
      {tab === 'all' && <StepList steps={steps} at={at} onGo={jump} />}
      {tab === 'parts' && <PartsList content={content} progress={progress} onTick={(id) => dispatch({ type: 'part', id })} />}
      {tab === 'step' && (
        <>
          <div class="guide-step">
            <StepPicture content={content} steps={steps} at={at} crossing={progress.crossing} />
            {step === undefined ? (
              <Finished content={content} dispatch={dispatch} />
            ) : (
              <StepView key={at} content={content} step={step} progress={progress} dispatch={dispatch} />
            )}
          </div>
          <div class="guide-buttons">
            <button type="button" class="button" disabled={at === 0} onClick={() => dispatch({ type: 'back' })}>
              <Icon name="left" />
              {t.guide.back}
            </button>
            <button type="button" class="button primary" disabled={step === undefined} onClick={() => dispatch({ type: 'next' })}>
              {t.guide.next}
              <Icon name="right" />
            </button>
          </div>
        </>
      )}
    </>
  );
}

function Guide(props: { readonly job: string; readonly name: string; readonly content: JobPackage }) {
  const { job, name, content } = props;
  const [tab, setTab] = useState<Tab>('step');
  const [printing, setPrinting] = useState(false);
  const steps = useMemo(() => planSteps(content.assembly), [content]);
  const hasPdf = content.artifacts.some((file) => file.path === 'guide.pdf');
  const tabs = (['step', 'all', 'parts'] as const).map((value) => ({ value, label: value === 'step' ? t.guide.title : t.guide[value] }));
  return (
    <>
      <div class="guide-tools">
        <Segmented label={t.guide.title} choices={tabs} value={tab} onChange={setTab} />
        <div class="buttons">
          <button type="button" class="button small" disabled={printing || steps.length === 0} onClick={() => setPrinting(true)}>
            <Icon name="print" />
            {printing ? t.guide.printing : t.guide.print}
          </button>
          {hasPdf && (
            <a class="button small" href={artifactUrl(job, 'guide.pdf')} download>
              <Icon name="download" />
              {t.guide.pdf}
            </a>
          )}
        </div>
      </div>
      {steps.length === 0 ? (
        <p class="quiet empty">{t.guide.none}</p>
      ) : (
        <Bench job={job} content={content} steps={steps} tab={tab} onTab={setTab} />
      )}
      {printing && <PrintedGuide name={name} content={content} steps={steps} onDone={() => setPrinting(false)} />}
    </>
  );
}

export function GuidePage(props: { readonly id: string }) {
  const { id } = props;
  const job = feed.value.jobs.get(id);
  const { known } = feed.value;
  useEffect(() => {
    if (known && job === undefined) fetchJob(id);
  }, [id, known, job === undefined]);
  useEffect(() => {
    void loadPackage(id);
    loadMaterials().catch(() => undefined);
  }, [id]);
  const now = jobPackage.value;
  const content = now.state === 'ready' && now.job === id ? now.content : null;
  return (
    <div class="page guide-page">
      <a class="back" href={formatRoute({ page: 'job', id })}>
        <Icon name="left" />
        {job?.name ?? id}
      </a>
      <h1 class="visually-hidden">
        {t.guide.title}: {job?.name ?? id}
      </h1>
      {now.state === 'failed' && (
        <p class="failure" role="alert">
          {now.fault}
        </p>
      )}
      {content === null ? (
        now.state !== 'failed' && <p class="quiet empty">{t.files.loading}</p>
      ) : (
        <Guide job={id} name={job?.name ?? id} content={content} />
      )}
    </div>
  );
}
