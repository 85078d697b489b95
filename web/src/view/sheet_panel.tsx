// The nested sheets of a job, one at a time; follows the cut that is running.

import { useEffect, useState } from 'preact/hooks';

import type { Cut, Job } from '../api/types.ts';
import { figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { burntAt, type Burnt, type BurnPlan, burntSoFar } from '../state/burn.ts';
import { type JobPackage, loadBurnPlan, shownSheet } from '../state/package_store.ts';
import { materialName } from '../state/store.ts';
import { Panel, Segmented } from './controls.tsx';
import { Icon } from './icons.tsx';
import { Playback } from './playback.tsx';
import { SheetCanvas } from './sheet_canvas.tsx';

// How the machine has got on with `sheet`: nothing, part of it, or all.
function burntShare(sheet: number, job: Job, cut: Cut | null): Cut['progress'] | null {
  if (cut !== null && cut.sheet === sheet && cut.progress.linesTotal > 0) return cut.progress;
  const isCut = job.sheets.some((one) => one.id === sheet && one.state === 'cut');
  return isCut ? { linesTotal: 1, linesSent: 1, linesAcknowledged: 1, fraction: 1 } : null;
}

function usePlan(sheet: number, job: Job, wanted: boolean): BurnPlan | null {
  const [plan, setPlan] = useState<{ readonly sheet: number; readonly plan: BurnPlan } | null>(null);
  useEffect(() => {
    let gone = false;
    if (wanted) {
      loadBurnPlan(job.id, sheet).then(
        (loaded) => gone || setPlan({ sheet, plan: loaded }),
        (fault: unknown) => console.warn('no program', fault),
      );
    }
    return () => {
      gone = true;
    };
  }, [job.id, sheet, wanted]);
  return plan === null || plan.sheet !== sheet ? null : plan.plan;
}

export function SheetPanel(props: { readonly job: Job; readonly content: JobPackage; readonly cut: Cut | null }) {
  const { job, content, cut } = props;
  const cutSheet = cut?.sheet;
  useEffect(() => {
    if (cutSheet !== undefined && cutSheet > 0) shownSheet.value = cutSheet;
  }, [cutSheet]);
  const sheet = content.sheets.find((one) => one.id === shownSheet.value) ?? content.sheets[0];
  const [seconds, setSeconds] = useState<number | null>(null); // Of the recording; null: none is played.
  const share = sheet === undefined ? null : burntShare(sheet.id, job, cut);
  const plan = usePlan(sheet?.id ?? 0, job, share !== null || seconds !== null);
  useEffect(() => setSeconds(null), [sheet?.id]);
  if (sheet === undefined) return null;
  const played = plan === null || seconds === null ? null : burntAt(plan, seconds);
  const burnt: Burnt | null = played ?? (plan === null || share === null ? null : burntSoFar(plan, share));
  const isCut = (id: number): boolean => job.sheets.some((one) => one.id === id && one.state === 'cut');
  const choices = content.sheets.map(({ id }) => ({ value: id, label: String(id), class: isCut(id) ? 'is-cut' : '' }));
  return (
    <Panel
      title={t.sheets.title}
      class="sheets"
      aside={
        <Segmented label={t.sheets.tabs} choices={choices} value={sheet.id} onChange={(id) => (shownSheet.value = id)} />
      }
    >
      <SheetCanvas
        sheet={sheet}
        burnt={burnt}
        hot={played !== null || (cut?.state === 'cutting' && cut.sheet === sheet.id)}
        about={
          <p class="sheet-about quiet">
            {t.sheets.one(sheet.id)} · {materialName(sheet.material)} ·{' '}
            {t.sheets.size(figure(sheet.widthMm, 4), figure(sheet.heightMm, 4))}
            {isCut(sheet.id) && <span class="tag">{t.sheets.cut}</span>}
          </p>
        }
        over={
          plan !== null && seconds !== null ? (
            <Playback plan={plan} seconds={seconds} line={played?.line ?? 0} onSeek={setSeconds} onClose={() => setSeconds(null)} />
          ) : null
        }
      >
        {seconds === null && (
          <button type="button" class="button small" onClick={() => setSeconds(0)}>
            <Icon name="play" />
            {t.sheets.play}
          </button>
        )}
      </SheetCanvas>
    </Panel>
  );
}
