// Two results side by side: both in 3D, and every figure of both.

import { useEffect, useState } from 'preact/hooks';

import { getJob } from '../api/client.ts';
import type { Job } from '../api/types.ts';
import { duration, figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { compareRows, type CompareRow, differingParams } from '../state/compare.ts';
import { fetchPackage, type JobPackage } from '../state/package_store.ts';
import { formatRoute } from '../state/route.ts';
import { feed, loadMaterials, problemText } from '../state/store.ts';
import { Panel } from './controls.tsx';
import { Icon } from './icons.tsx';
import { ModelPanel } from './model/model_panel.tsx';

interface Side {
  readonly job: Job;
  readonly content: JobPackage;
}

async function fetchSide(id: string): Promise<Side> {
  const [job, content] = await Promise.all([feed.value.jobs.get(id) ?? getJob(id), fetchPackage(id)]);
  return { job, content };
}

function nameOf({ name, of }: CompareRow): string {
  if (name in t.compare.rows) return t.compare.rows[name as keyof typeof t.compare.rows];
  const quality = t.report.rows[name as keyof typeof t.report.rows];
  return of === 'average' ? t.compare.average(quality) : t.compare.most(quality);
}

function valueOf(row: CompareRow, side: 0 | 1): string {
  const value = row.values[side];
  if (value === null) return '–';
  if (row.name === 'time') return duration(value);
  const unit = row.name.endsWith('_deg') ? '°' : row.name.endsWith('_percent') || row.name === 'density' ? ' %' : '';
  return `${figure(value, Number.isInteger(value) ? 9 : 3)}${unit}`;
}

function Figures(props: { readonly a: Side; readonly b: Side }) {
  const { a, b } = props;
  const rows = compareRows({ job: a.job, figures: a.content.figures }, { job: b.job, figures: b.content.figures });
  return (
    <Panel title={t.compare.title} class="compare-figures">
      <table>
        <thead>
          <tr>
            <th scope="col">{t.compare.figure}</th>
            <th scope="col">{a.job.name}</th>
            <th scope="col">{b.job.name}</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={`${row.name}${row.of}`}>
              <th scope="row">{nameOf(row)}</th>
              {([0, 1] as const).map((side) => (
                <td key={side} class={row.better === side ? 'better' : ''}>
                  {valueOf(row, side)}
                  {row.better === side && <span class="visually-hidden"> ({t.compare.better})</span>}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </Panel>
  );
}

function Parameters(props: { readonly a: Job; readonly b: Job }) {
  const rows = differingParams(props.a.params, props.b.params);
  if (rows.length === 0) return null;
  return (
    <Panel title={t.compare.parameters} class="compare-figures compare-parameters">
      <table>
        <thead>
          <tr>
            <th scope="col">{t.compare.figure}</th>
            <th scope="col">{props.a.name}</th>
            <th scope="col">{props.b.name}</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(([path, one, two]) => (
            <tr key={path}>
              <th scope="row">
                <code>{path}</code>
              </th>
              <td>{one === '' ? '–' : one}</td>
              <td>{two === '' ? '–' : two}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </Panel>
  );
}

export function ComparePage(props: { readonly id: string; readonly other: string }) {
  const { id, other } = props;
  const [sides, setSides] = useState<readonly [Side, Side] | null>(null);
  const [fault, setFault] = useState('');
  useEffect(() => {
    loadMaterials().catch(() => undefined);
    Promise.all([fetchSide(id), fetchSide(other)]).then(setSides, (problem: unknown) => setFault(problemText(problem)));
  }, [id, other]);
  return (
    <div class="page compare-page">
      <a class="back" href={formatRoute({ page: 'job', id })}>
        <Icon name="left" />
        {feed.value.jobs.get(id)?.name ?? id}
      </a>
      <h1>{t.compare.title}</h1>
      {fault !== '' && (
        <p class="failure" role="alert">
          {fault}
        </p>
      )}
      {sides === null ? (
        fault === '' && <p class="quiet empty">{t.files.loading}</p>
      ) : (
        <div class="result">
          {sides.map(({ job, content }, index) => (
            <ModelPanel key={job.id} name={job.name} title={`${index + 1} · ${job.name}`} content={content} />
          ))}
          <Figures a={sides[0]} b={sides[1]} />
          <Parameters a={sides[0].job} b={sides[1].job} />
        </div>
      )}
    </div>
  );
}
