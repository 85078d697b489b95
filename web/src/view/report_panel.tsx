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

const kFewCylinders = 12; // More are shown on demand.
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

// The figures of the paper's second table, in its order: most and mean of the angle, of the distance, and the
// mean of the area.
const kPaper = [
  ['angle_deviation_deg', 'largest'],
  ['angle_deviation_deg', 'average'],
  ['surface_distance_percent', 'largest'],
  ['surface_distance_percent', 'average'],
  ['area_distortion_percent', 'average'],
] as const;

function PaperRow(props: { readonly name: string; readonly quads: string; readonly quality: readonly QualityRow[]; readonly whole?: boolean }) {
  const { name, quads, quality } = props;
  return (
    <tr class={props.whole === true ? 'whole' : ''}>
      <th scope="row">{name}</th>
      <td>{quads}</td>
      {kPaper.map(([figure, of]) => (
        <td key={figure + of}>{measure(figure, quality.find((one) => one.name === figure)?.[of] ?? null)}</td>
      ))}
    </tr>
  );
}

// One row for every cylinder, as the paper has one for every part of its models.
function PaperTable(props: { readonly figures: ReportFigures }) {
  const { cylinders, quality } = props.figures;
  if (cylinders.length === 0) return null;
  const words = t.report.rows;
  return (
    <details class="by-cylinder" open={cylinders.length <= kFewCylinders}>
      <summary>{t.report.perCylinder}</summary>
      <div class="table-box" tabIndex={0} role="group" aria-label={t.report.perCylinder}>
        <table class="paper-table">
          <thead>
            <tr>
              <th scope="col" rowSpan={2}>{t.foliation.cylinders}</th>
              <th scope="col" rowSpan={2}>{t.report.gridQuads}</th>
              <th scope="colgroup" colSpan={2}>{words.angle_deviation_deg}</th>
              <th scope="colgroup" colSpan={2}>{words.surface_distance_percent}</th>
              <th scope="colgroup">{words.area_distortion_percent}</th>
            </tr>
            <tr>
              {kPaper.map(([figure, of]) => (
                <th key={figure + of} scope="col">{t.report[of]}</th>
              ))}
            </tr>
          </thead>
          <tbody>
            {cylinders.map(({ cylinder, quads, grid, quality: own }) => (
              <PaperRow
                key={cylinder}
                name={t.report.cylinder(count(cylinder + 1))}
                quads={grid === null ? count(quads) : `${count(quads)} (${grid[0]}, ${grid[1]})`}
                quality={own}
              />
            ))}
            {cylinders.length > 1 && (
              <PaperRow name={t.report.overall} quads={count(cylinders.reduce((sum, one) => sum + one.quads, 0))} quality={quality} whole />
            )}
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
      <PaperTable figures={props.figures} />
      <Facts facts={facts} />
    </Panel>
  );
}
