// The one place where the daemon's JSON is checked and becomes our types.

import {
  type Fields,
  fields,
  flag,
  list,
  number,
  oneOf,
  optional,
  PayloadError,
  type Reader,
  record,
  text,
} from '../lib/check.ts';
import type * as wire from './schema.ts';
import type {
  Artifact,
  Beam,
  Cut,
  CutProgress,
  Device,
  DeviceStatus,
  FeedEvent,
  Job,
  JobError,
  JobSheet,
  JobSummary,
  Material,
} from './types.ts';

const names = list(text);

const readSheet: Reader<JobSheet> = (value, path) => {
  const get = record(value, path);
  return {
    id: get('id', number),
    material: get('material', optional(text, '')),
    state: get('state', optional(text, 'uncut')),
    programSha256: get('program_sha256', optional(text, '')),
    estimatedS: get('estimated_s', optional(number, 0)),
  };
};

const readSummary: Reader<JobSummary> = (value, path) => {
  const get = record(value, path);
  return {
    quads: get('quads', number),
    strips: get('strips', number),
    pieces: get('pieces', number),
    sheets: get('sheets', number),
    estimatedS: get('estimated_s', optional(number, 0)),
    warnings: get('warnings', optional(names, [])),
  };
};

const readJobError: Reader<JobError> = (value, path) => {
  const get = record(value, path);
  return {
    kind: get('kind', optional(text, '')),
    code: get('code', optional(text, '')),
    detail: get('detail', optional(text, '')),
  };
};

const readStage: Reader<Job['progress']> = (value, path) => {
  const get = record(value, path);
  return { stage: get('stage', optional(text, '')), fraction: get('fraction', optional(number, 0)) };
};

const readFile: Reader<Job['file']> = (value, path) => {
  const get = record(value, path);
  return { name: get('name', optional(text, '')), bytes: get('bytes', optional(number, 0)) };
};

export const readJob: Reader<Job> = (value, path) => {
  const get = record<wire.Job & { readonly priority?: number }>(value, path);
  return {
    id: get('id', text),
    name: get('name', optional(text, '')),
    state: get('state', oneOf('queued', 'computing', 'ready', 'done', 'failed', 'cancelled')),
    createdAt: get('created_at', text),
    version: get('version', optional(number, 0)),
    file: get('file', optional(readFile, { name: '', bytes: 0 })),
    params: get('params', optional(fields, {})),
    progress: get('progress', optional(readStage, { stage: '', fraction: 0 })),
    error: get('error', optional(readJobError, null)),
    summary: get('summary', optional(readSummary, null)),
    sheets: get('sheets', optional(list(readSheet), [])),
    cuts: get('cuts', optional(names, [])),
    priority: get('priority', optional(number, 0)),
    actions: get('actions', optional(names, [])),
  };
};

const readCutProgress: Reader<CutProgress> = (value, path) => {
  const get = record(value, path);
  return {
    linesTotal: get('lines_total', optional(number, 0)),
    linesSent: get('lines_sent', optional(number, 0)),
    linesAcknowledged: get('lines_acknowledged', optional(number, 0)),
    fraction: get('fraction', optional(number, 0)),
  };
};

const kNoProgress: CutProgress = { linesTotal: 0, linesSent: 0, linesAcknowledged: 0, fraction: 0 };

const readBeam: Reader<Beam> = (value, path) => {
  const get = record<NonNullable<wire.Cut['beam']>>(value, path);
  return {
    percent: get('percent', optional(number, 0)),
    burntMm: get('burnt_mm', optional(number, 0)),
    leastMm: get('least_mm', optional(number, 0)),
    mostMm: get('most_mm', optional(number, 0)),
    totalMm: get('total_mm', optional(number, 0)),
    line: get('line', optional(number, 0)),
    certain: get('certain', optional(flag, false)),
    positionKept: get('position_kept', optional(flag, false)),
  };
};

export const readCut: Reader<Cut> = (value, path) => {
  const get = record<wire.Cut>(value, path);
  const sheets = get('sheets', list(number));
  return {
    id: get('id', text),
    job: get('job', text),
    device: get('device', text),
    sheets,
    sheet: get('sheet', optional(number, sheets[0] ?? 1)),
    state: get(
      'state',
      oneOf('waiting', 'armed', 'cutting', 'paused', 'awaiting-sheet', 'done', 'aborted', 'failed', 'interrupted'),
    ),
    programSha256: get('program_sha256', optional(text, '')),
    progress: get('progress', optional(readCutProgress, kNoProgress)),
    beam: get('beam', optional(readBeam, null)),
    restOf: get('rest_of', optional(text, null)),
    reason: get('reason', optional(text, '')),
    version: get('version', optional(number, 0)),
    createdAt: get('created_at', optional(text, '')),
    actions: get('actions', optional(names, [])),
  };
};

const readStatus: Reader<DeviceStatus> = (value, path) => {
  const get = record<NonNullable<wire.Device['status']>>(value, path);
  return {
    state: get('state', optional(text, 'unknown')),
    machinePositionMm: get('machine_position_mm', optional(list(number), [])),
    workPositionMm: get('work_position_mm', optional(list(number), [])),
    feedMmPerMin: get('feed_mm_per_min', optional(number, 0)),
    overridePercent: get('override_percent', optional(list(number), [])),
    powerS: get('power_s', optional(number, 0)),
    alarmCode: get('alarm_code', optional(number, null)) || null, // Codes begin at 1.
    message: get('message', optional(text, '')),
    firmware: get('firmware', optional(text, '')),
  };
};

export const readDevice: Reader<Device> = (value, path) => {
  const get = record<wire.Device>(value, path);
  const id = get('id', text);
  return {
    id,
    name: get('name', optional(text, '')) || id,
    uri: get('uri', optional(text, '')),
    autoStart: get('auto_start', optional(flag, false)),
    bedMm: get('bed_mm', optional(list(number), [])),
    status: get('status', readStatus),
    cut: get('cut', optional(text, null)),
    console: get('console', optional(names, [])),
    actions: get('actions', optional(names, [])),
  };
};

const readSize: Reader<{ widthMm: number; heightMm: number }> = (value, path) => {
  const get = record(value, path);
  return { widthMm: get('width_mm', number), heightMm: get('height_mm', number) };
};

const readLaser: Reader<Material['cut']> = (value, path) => {
  const get = record<wire.Laser>(value, path);
  return { feedMmPerMin: get('feed_mm_per_min', optional(number, 1000)), passes: get('passes', optional(number, 1)) };
};

export const readMaterial: Reader<Material> = (value, path) => {
  const get = record<wire.Material>(value, path);
  const id = get('id', text);
  return {
    id,
    name: get('name', optional(text, id)),
    colour: get('colour', optional(text, '#888888')),
    thicknessMm: get('thickness_mm', optional(number, 0)),
    weightGPerM2: get('weight_g_per_m2', optional(number, 0)),
    sheets: get('sheets', optional(list(readSize), [])),
    cut: get('cut', optional(readLaser, { feedMmPerMin: 1000, passes: 1 })),
    raw: fields(value, path),
  };
};

export const readArtifact: Reader<Artifact> = (value, path) => {
  const get = record<wire.Artifact>(value, path);
  return {
    path: get('path', text),
    bytes: get('bytes', number),
    mediaType: get('media_type', optional(text, '')),
  };
};

// A list under one key, as all collections come: {"jobs": [...]}.
export const listUnder =
  <T>(key: string, item: Reader<T>): Reader<readonly T[]> =>
  (value, path) =>
    record(value, path)(key, list(item));

// An event may tell of something that has been removed since.
function removal(type: string, payload: Fields, seq: number | null): FeedEvent | null {
  const id = payload['removed'];
  return typeof id === 'string' && (type === 'job' || type === 'cut') ? { type: `${type}-removed`, seq, id } : null;
}

// `type` is the event's name, `data` its parsed JSON. Null for an event this page does not know.
export function readEvent(type: string, data: unknown): FeedEvent | null {
  const payload = fields(data, '');
  const seq = optional(number, null)(payload['seq'], '/seq');
  const removed = removal(type, payload, seq);
  if (removed !== null) return removed;
  if (type === 'job') return { type, seq, job: readJob(payload['job'], '/job') };
  if (type === 'cut') return { type, seq, cut: readCut(payload['cut'], '/cut') };
  if (type === 'device') return { type, seq, device: readDevice(payload['device'], '/device') };
  if (type !== 'snapshot') return null;
  return {
    type,
    seq,
    jobs: listUnder('jobs', readJob)(payload, ''),
    cuts: listUnder('cuts', readCut)(payload, ''),
    devices: listUnder('devices', readDevice)(payload, ''),
  };
}

export { PayloadError };
