// How the surface was laid out, how even its cells are, and what else was looked at.

import { recomputeJob } from '../api/client.ts';
import type { Job } from '../api/types.ts';
import { figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { alternativeParams, modeNamed } from '../state/recompute.ts';
import { type Alternative, evennessOf, type FoliationFigures, sortedAlternatives } from '../state/report.ts';
import { attempt, go, receive } from '../state/store.ts';
import { Panel } from './controls.tsx';
import { Fact } from './report_panel.tsx';

// Of one way to cut into pairs of pants: "reeb-z, weights by length, evened".
function wayName(source: string, sweep: string, rest: string): string {
  const { pantsNames, sweepNames } = t.draft.foliation;
  const known = <V extends string>(names: Readonly<Record<V, string>>, name: string): string => names[name as V] ?? name;
  const parts = rest.split(', ').filter((part) => part !== '').map((part) => known(t.foliation.ways, part));
  return [known(pantsNames, source === 'loops' ? 'user' : source), known(sweepNames, sweep), ...parts].join(', ');
}

// "torus", "pants with 5 holes", "pants reeb-z, equal weights", or two of them with a colon between.
function layoutName(name: string): string {
  const parts = name.split(': ');
  if (parts.length > 1) return parts.map(layoutName).join(': ');
  const mode = modeNamed(name);
  if (mode !== null) return t.modes[mode];
  const [, holed, holes] = /^([a-z-]+) with (\d+) holes?$/.exec(name) ?? [];
  if (holed !== undefined) return t.foliation.withHoles(layoutName(holed), Number(holes));
  const [, source, sweep, rest] = /^pants ([a-z-]+)-([a-z]+)(.*)$/.exec(name) ?? [];
  return source === undefined || sweep === undefined ? name : wayName(source, sweep, rest ?? '');
}

function percentOf(value: number): string {
  return `${figure(value, 2)} %`;
}

async function weaveLike(job: Job, name: string): Promise<void> {
  const params = alternativeParams(job.params, name);
  if (params === null) return;
  await attempt(async () => {
    const made = await recomputeJob(job.id, params);
    receive({ type: 'job', seq: null, job: made });
    go({ page: 'job', id: made.id });
  });
}

function AlternativeRow(props: { readonly job: Job; readonly one: Alternative }) {
  const { job, one } = props;
  const can = !one.chosen && job.actions.includes('recompute') && modeNamed(one.name) !== null;
  return (
    <tr class={one.chosen ? 'chosen' : ''}>
      <th scope="row">
        {layoutName(one.name)} {one.chosen && <span class="tag">{t.foliation.chosen}</span>}
        {can && (
          <button type="button" class="button small" onClick={() => void weaveLike(job, one.name)}>
            {t.foliation.recompute}
          </button>
        )}
      </th>
      <td>{figure(one.largest, 2)}</td>
      <td class="wide-only">{figure(one.variation, 2)}</td>
      <td>{percentOf(one.removedPercent)}</td>
    </tr>
  );
}

function AlternativeTable(props: { readonly job: Job; readonly rows: readonly Alternative[] }) {
  const { name, largest, variation, removed } = t.foliation.columns;
  return (
    <table class="alternatives">
      <caption class="visually-hidden">{t.foliation.alternatives}</caption>
      <thead>
        <tr>
          {[name, largest, variation, removed].map((title) => (
            <th key={title} scope="col" class={title === variation ? 'wide-only' : ''}>
              {title}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {props.rows.map((one) => (
          <AlternativeRow key={one.name} job={props.job} one={one} />
        ))}
      </tbody>
    </table>
  );
}

function Alternatives(props: { readonly job: Job; readonly all: readonly Alternative[] }) {
  const { first, rest } = sortedAlternatives(props.all);
  if (first.length === 0) return null;
  return (
    <div>
      <h3>{t.foliation.alternatives}</h3>
      <AlternativeTable job={props.job} rows={first} />
      {rest.length > 0 && (
        <details>
          <summary>{t.foliation.more(rest.length)}</summary>
          <AlternativeTable job={props.job} rows={rest} />
        </details>
      )}
    </div>
  );
}

export function FoliationPanel(props: { readonly job: Job; readonly figures: FoliationFigures }) {
  const { job, figures } = props;
  const { largest, points, holeRadiiMm: holes } = figures;
  const said = points.map(({ prongs, count }) => t.foliation.point(prongs, count)).join(', ');
  return (
    <Panel title={t.foliation.title} class="foliation">
      {largest !== null && <p>{t.foliation.evenness[evennessOf(largest)](figure(largest, 2))}</p>}
      <dl class="facts-list">
        <Fact name={t.foliation.mode} value={layoutName(figures.mode)} />
        <Fact name={t.foliation.cylinders} value={figure(figures.cylinders)} />
        <Fact name={t.foliation.points} value={said === '' ? t.foliation.noPoints : said} />
        <Fact
          name={t.foliation.holes}
          value={holes.length === 0 ? t.foliation.noHoles : `${holes.length}: ${t.foliation.hole(holes.map((mm) => figure(mm, 2)).join(', '))}`}
        />
        <Fact name={t.foliation.removed} value={percentOf(figures.removedPercent)} />
        {figures.parts > 1 && <Fact name={t.foliation.parts} value={figure(figures.parts)} />}
      </dl>
      <Alternatives job={job} all={figures.alternatives} />
    </Panel>
  );
}
