// The report's figures.

import { duration, figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import type { QualityName, ReportFigures } from '../state/report.ts';
import { Panel } from './controls.tsx';

function measure(name: QualityName, value: number | null): string {
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
                <th scope="row">{t.report.rows[row.name]}</th>
                <td>{measure(row.name, row.average)}</td>
                <td>{measure(row.name, row.largest)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <Facts facts={facts} />
    </Panel>
  );
}
