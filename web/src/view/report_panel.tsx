// The report's figures.

import { count, duration, figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import type { HeatName } from '../state/heat.ts';
import type { QualityName, QualityRow, ReportFigures } from '../state/report.ts';
import { Panel } from './controls.tsx';
import { shownHeat } from './model/model_panel.tsx';

export function measure(name: QualityName, value: number | null): string {
  if (value === null) return '–';
  return `${figure(value)}${name.endsWith('_deg') ? '°' : ' %'}`;
}

const kShortS = 10; // Below this, whole seconds say too little.

function computedIn(seconds: number): string {
  return seconds < kShortS ? `${figure(seconds, 2)} s` : duration(seconds);
}

export function Fact(props: { readonly name: string; readonly value: string | null }) {
  if (props.value === null) return null;
  return (
    <div>
      <dt>{props.name}</dt>
      <dd>{props.value}</dd>
    </div>
  );
}

function Facts(props: { readonly facts: ReportFigures['facts'] }) {
  const { facts } = props;
  const words = t.report.facts;
  const both = (a: number | null, b: number | null, say: (x: string, y: string) => string): string | null =>
    a === null || b === null ? null : say(figure(a, 9), figure(b, 9));
  return (
    <dl class="facts-list">
      <Fact name={words.mesh} value={both(facts.vertices, facts.faces, words.meshValue)} />
      <Fact name={words.topology} value={both(facts.genus, facts.boundaryLoops, words.topologyValue)} />
      <Fact name={words.density} value={facts.densityPercent === null ? null : `${figure(facts.densityPercent)} %`} />
      <Fact
        name={words.certificate}
        value={facts.certificate === null ? null : words.certificateValue(`${figure(facts.certificate * 100, 2)} %`)}
      />
      <Fact name={words.time} value={facts.totalS === null ? null : computedIn(facts.totalS)} />
    </dl>
  );
}

// Which heat map shows where a figure comes from.
const kHeatOf: Readonly<Partial<Record<QualityName, HeatName>>> = {
  angle_deviation_deg: 'angle',
  surface_distance_percent: 'distance',
  area_distortion_percent: 'area',
  planarity_percent: 'planarity',
};

function RowName(props: { readonly name: QualityName }) {
  const label = t.report.rows[props.name];
  const heat = kHeatOf[props.name];
  if (heat === undefined) return <>{label}</>;
  return (
    <button type="button" class="link" title={t.report.show(label)} onClick={() => (shownHeat.value = heat)}>
      {label}
    </button>
  );
}

function CylinderTable(props: { readonly figures: ReportFigures }) {
  const { cylinders, quality } = props.figures;
  if (cylinders.length < 2) return null;
  const largest = (rows: readonly QualityRow[], name: QualityName): string => {
    const row = rows.find((one) => one.name === name);
    return `${measure(name, row?.average ?? null)} / ${measure(name, row?.largest ?? null)}`;
  };
  return (
    <details class="by-cylinder">
      <summary>{t.report.perCylinder}</summary>
      <div class="table-box" tabIndex={0} role="group" aria-label={t.report.perCylinder}>
        <table>
          <thead>
            <tr>
              <th scope="col">{t.foliation.cylinders}</th>
              <th scope="col">{t.report.quads}</th>
              {quality.map(({ name }) => (
                <th key={name} scope="col">
                  {t.report.rows[name]}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {cylinders.map((one) => (
              <tr key={one.cylinder}>
                <th scope="row">{t.report.cylinder(count(one.cylinder + 1))}</th>
                <td>{count(one.quads)}</td>
                {quality.map(({ name }) => (
                  <td key={name}>{largest(one.quality, name)}</td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </details>
  );
}

export function ReportPanel(props: { readonly figures: ReportFigures }) {
  const { quality, facts } = props.figures;
  return (
    <Panel title={t.report.title} class="report">
      {quality.length > 0 && (
        <table>
          <thead>
            <tr>
              <th scope="col">
                <span class="visually-hidden">{t.report.title}</span>
              </th>
              <th scope="col">{t.report.average}</th>
              <th scope="col">{t.report.largest}</th>
            </tr>
          </thead>
          <tbody>
            {quality.map((row) => (
              <tr key={row.name}>
                <th scope="row">
                  <RowName name={row.name} />
                </th>
                <td>{measure(row.name, row.average)}</td>
                <td>{measure(row.name, row.largest)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <CylinderTable figures={props.figures} />
      <Facts facts={facts} />
    </Panel>
  );
}
