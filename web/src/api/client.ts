// The calls of the REST interface. Every function rejects with a Problem, and with nothing else.

import { PayloadError, type Reader } from '../lib/check.ts';
import { listUnder, readArtifact, readCut, readDevice, readJob, readMaterial } from './payloads.ts';
import { Problem, problemFrom, unreachable } from './problem.ts';
import type { Artifact, Cut, Device, Job, Material } from './types.ts';

export const kApi = '/api/v1';

// Marks a call as made by our own page: a form on someone else's page cannot send this header.
export const kOwnPage = { 'X-Leafcutter': 'dashboard' } as const;

// The token that a session's own calls carry, and who is told when the daemon wants a login.
let csrfToken: string | null = null;
let onLoginWanted: () => void = () => undefined;

export function carryToken(token: string | null): void {
  csrfToken = token;
}

export function whenLoginWanted(told: () => void): void {
  onLoginWanted = told;
}

export function ownHeaders(): Record<string, string> {
  return csrfToken === null ? { ...kOwnPage } : { ...kOwnPage, 'X-CSRF-Token': csrfToken };
}

async function answer(path: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(kApi + path, init);
  } catch {
    throw unreachable();
  }
  if (response.status === 401) onLoginWanted();
  if (!response.ok) throw problemFrom(response.status, await response.text().catch(() => ''));
  return response;
}

export async function read<T>(path: string, reader: Reader<T>): Promise<T> {
  return readAnswer(path, await answer(path, { headers: { Accept: 'application/json' } }), reader);
}

async function readAnswer<T>(path: string, response: Response, reader: Reader<T>): Promise<T> {
  try {
    return reader(await response.json(), '');
  } catch (fault) {
    const detail = fault instanceof PayloadError ? fault.message : 'not JSON';
    throw new Problem(response.status, 'bad-payload', `${path}: ${detail}`);
  }
}

export async function send(method: string, path: string, body?: unknown): Promise<Response> {
  const headers = ownHeaders();
  if (body === undefined) return answer(path, { method, headers });
  headers['Content-Type'] = 'application/json';
  return answer(path, { method, headers, body: JSON.stringify(body), keepalive: true });
}

// A call whose answer matters.
export async function sendAndRead<T>(method: string, path: string, body: unknown, reader: Reader<T>): Promise<T> {
  return readAnswer(path, await send(method, path, body), reader);
}

export const listJobs = (): Promise<readonly Job[]> => read('/jobs?limit=200', listUnder('jobs', readJob));
export const getJob = (id: string): Promise<Job> => read(`/jobs/${id}`, readJob);
export const getCut = (id: string): Promise<Cut> => read(`/cuts/${id}`, readCut);
export const listCuts = (): Promise<readonly Cut[]> => read('/cuts', listUnder('cuts', readCut));
export const listDevices = (): Promise<readonly Device[]> =>
  read('/devices', listUnder('devices', readDevice));
export const listMaterials = (): Promise<readonly Material[]> =>
  read('/materials', listUnder('materials', readMaterial));
export const listArtifacts = (job: string): Promise<readonly Artifact[]> =>
  read(`/jobs/${job}/artifacts`, listUnder('artifacts', readArtifact));

export async function removeJob(id: string): Promise<void> {
  await send('DELETE', `/jobs/${id}`);
}

// A new job from the mesh of an old one.
export async function recomputeJob(id: string, params: Readonly<Record<string, unknown>>): Promise<Job> {
  return sendAndRead('POST', `/jobs/${id}/recompute`, { params }, readJob);
}

// Single pieces or whole strips again, as a job that is ready to be cut.
export async function recutJob(id: string, pieces: readonly string[]): Promise<Job> {
  return sendAndRead('POST', `/jobs/${id}/recut`, { pieces }, readJob);
}

export async function queueCut(job: string, device: string, sheets: readonly number[]): Promise<void> {
  await send('POST', `/jobs/${job}/cuts`, { device, sheets });
}

// The rest of a cut that ended early, said by someone who looked at the sheet and the machine.
export interface FinishWords {
  readonly homed: boolean;
  readonly burntMm: number | null; // As seen on the sheet, where the daemon isn't sure.
}

export async function finishCut(cut: string, words: FinishWords): Promise<Cut> {
  const body = {
    material_in_place: true,
    ...(words.homed ? { homed: true } : {}),
    ...(words.burntMm === null ? {} : { burnt_mm: words.burntMm }),
  };
  return sendAndRead('POST', `/cuts/${cut}/finish`, body, readCut);
}

export type CutAction = 'start' | 'confirm-sheet' | 'pause' | 'resume' | 'abort';

// Start and confirm-sheet name the exact program and say that the bed is clear.
export async function commandCut(cut: Cut, action: CutAction): Promise<void> {
  const fires = action === 'start' || action === 'confirm-sheet';
  const body = fires ? { program_sha256: cut.programSha256, bed_clear: true } : {};
  await send('POST', `/cuts/${cut.id}/${action}`, body);
}

export interface Jog {
  readonly dxMm: number;
  readonly dyMm: number;
  readonly feedMmPerMin: number;
}

export async function commandDevice(id: string, command: string, more: Readonly<Record<string, unknown>> = {}): Promise<void> {
  await send('POST', `/devices/${id}/commands`, { command, ...more });
}

export async function jogDevice(id: string, jog: Jog): Promise<void> {
  const body = { command: 'jog', dx_mm: jog.dxMm, dy_mm: jog.dyMm, feed_mm_per_min: jog.feedMmPerMin };
  await send('POST', `/devices/${id}/commands`, body);
}

export function artifactUrl(job: string, path: string): string {
  return `${kApi}/jobs/${job}/artifacts/${path.split('/').map(encodeURIComponent).join('/')}`;
}

export function packageUrl(job: string): string {
  return `${kApi}/jobs/${job}/package.zip`;
}

// The mesh that a job was made from, as it was sent.
export async function jobMesh(job: string): Promise<ArrayBuffer> {
  return (await answer(`/jobs/${job}/mesh`, {})).arrayBuffer();
}

export async function artifactText(job: string, path: string): Promise<string> {
  const url = artifactUrl(job, path).slice(kApi.length);
  return (await answer(url, {})).text();
}

export async function artifactBytes(job: string, path: string): Promise<ArrayBuffer> {
  const url = artifactUrl(job, path).slice(kApi.length);
  return (await answer(url, {})).arrayBuffer();
}
