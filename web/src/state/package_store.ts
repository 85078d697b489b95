// The package of the job that is looked at: fetched once, checked, indexed.

import { signal } from '@preact/signals';

import { artifactBytes, artifactText, listArtifacts } from '../api/client.ts';
import { type Assembly, readAssembly } from '../api/assembly_file.ts';
import type { SolidModel } from '../api/glb.ts';
import { type CriticalGraph, type QuadMesh, readCriticalGraph, readLayout, readQuads, readReport, readStrips, readSurface, readWeave, type Strips, type TriangleMesh } from '../api/package_files.ts';
import type { Artifact } from '../api/types.ts';
import type { Reader } from '../lib/check.ts';
import { parseProgram } from '../lib/gcode.ts';
import { type BurnPlan, planBurn } from './burn.ts';
import { type QualityFile, readQuality } from './heat.ts';
import { reportFigures, type ReportFigures } from './report.ts';
import { drawSheets, type SheetDrawing } from './sheets.ts';
import { problemText } from './store.ts';
import { indexStrips, type StripIndex } from './strip_index.ts';

export interface JobPackage {
  readonly job: string;
  readonly artifacts: readonly Artifact[];
  readonly mesh: QuadMesh;
  readonly warpOnTop: Uint8Array;
  readonly assembly: Assembly;
  readonly strips: Strips;
  readonly index: StripIndex;
  readonly sheets: readonly SheetDrawing[];
  readonly figures: ReportFigures;
  readonly critical: CriticalGraph;
}

export type PackageState =
  | { readonly state: 'none' }
  | { readonly state: 'loading'; readonly job: string }
  | { readonly state: 'failed'; readonly job: string; readonly fault: string }
  | { readonly state: 'ready'; readonly job: string; readonly content: JobPackage };

export const jobPackage = signal<PackageState>({ state: 'none' });

// The strip that is pointed at, and the one that was chosen.
export const pointedStrip = signal<string | null>(null);
export const chosenStrip = signal<string | null>(null);
export const shownSheet = signal<number | null>(null);

async function json<T>(job: string, path: string, reader: Reader<T>): Promise<T> {
  return reader(JSON.parse(await artifactText(job, path)), path);
}

const kNoCriticalGraph: CriticalGraph = { lines: [], points: [], leaves: { weft: [], warp: [] } };
const kMostLeafBytes = 60_000_000; // The page does well without larger ones.

// Only for drawing: a package without it is shown all the same.
async function criticalGraph(job: string, artifacts: readonly Artifact[]): Promise<CriticalGraph> {
  const leaves = artifacts.find((artifact) => artifact.path === 'leaves.json');
  if (leaves === undefined || leaves.bytes > kMostLeafBytes) return kNoCriticalGraph;
  return json(job, leaves.path, readCriticalGraph).catch(() => kNoCriticalGraph);
}

export async function fetchPackage(job: string): Promise<JobPackage> {
  const [artifacts, mesh, strips, woven, layout, report] = await Promise.all([
    listArtifacts(job),
    artifactText(job, 'quads.obj').then(readQuads),
    json(job, 'strips.json', readStrips),
    json(job, 'weave.json', (value, path) => ({ warpOnTop: readWeave(value, path), assembly: readAssembly(value, path) })),
    json(job, 'layout.json', readLayout),
    json(job, 'report.json', readReport),
  ]);
  return {
    job,
    artifacts,
    mesh,
    ...woven,
    strips,
    index: indexStrips(strips, layout),
    sheets: drawSheets(layout, strips),
    figures: reportFigures(report),
    critical: await criticalGraph(job, artifacts),
  };
}

// Does nothing if the package of `job` is there or on its way.
export async function loadPackage(job: string): Promise<void> {
  const now = jobPackage.value;
  if (now.state !== 'none' && now.state !== 'failed' && now.job === job) return;
  jobPackage.value = { state: 'loading', job };
  pointedStrip.value = null;
  chosenStrip.value = null;
  shownSheet.value = null;
  burnPlans.clear();
  const result = await fetchPackage(job).then(
    (content): PackageState => ({ state: 'ready', job, content }),
    (fault: unknown): PackageState => ({ state: 'failed', job, fault: problemText(fault) }),
  );
  // Another job may have been opened while this one was fetched.
  if (jobPackage.value.state === 'loading' && jobPackage.value.job === job) jobPackage.value = result;
}

const kSolidPath = 'woven.glb';

// Packages made with output.models = false have none.
export function hasSolidModel(content: JobPackage): boolean {
  return content.artifacts.some((artifact) => artifact.path === kSolidPath);
}

export async function loadSolidModel(job: string): Promise<SolidModel> {
  const [{ readSolidModel }, bytes] = await Promise.all([import('../api/glb.ts'), artifactBytes(job, kSolidPath)]);
  return readSolidModel(bytes);
}

export async function loadSurface(job: string): Promise<TriangleMesh> {
  return readSurface(await artifactText(job, 'surface.ply'));
}

export const loadQuality = (job: string): Promise<QualityFile> => json(job, 'quality.json', readQuality);

export function sheetProgramPath(sheet: number): string {
  return `sheets/sheet-${String(sheet).padStart(3, '0')}.gcode`;
}

const burnPlans = new Map<string, Promise<BurnPlan>>();

export function loadBurnPlan(job: string, sheet: number): Promise<BurnPlan> {
  const key = `${job}/${sheet}`;
  const known = burnPlans.get(key);
  if (known !== undefined) return known;
  const plan = artifactText(job, sheetProgramPath(sheet)).then((source) => planBurn(parseProgram(source)));
  plan.catch(() => burnPlans.delete(key));
  burnPlans.set(key, plan);
  return plan;
}

// Chooses a strip (or none), and brings the first sheet it lies on into view.
export function chooseStrip(id: string | null): void {
  chosenStrip.value = id;
  const now = jobPackage.value;
  if (id === null || now.state !== 'ready') return;
  const sheets = now.content.index.sheetsOfStrip.get(id) ?? [];
  if (shownSheet.value === null || !sheets.includes(shownSheet.value)) shownSheet.value = sheets[0] ?? shownSheet.value;
}
