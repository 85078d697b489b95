// What the daemon says, as the dashboard holds it: camel case, checked, immutable. Lengths are mm,
// times seconds, dates RFC 3339.

export type JobState = 'queued' | 'computing' | 'ready' | 'done' | 'failed' | 'cancelled';

export interface JobSheet {
  readonly id: number;
  readonly material: string;
  readonly state: string; // "uncut" or "cut".
  readonly programSha256: string;
  readonly estimatedS: number;
}

export interface JobSummary {
  readonly quads: number;
  readonly strips: number;
  readonly pieces: number;
  readonly sheets: number;
  readonly estimatedS: number;
  readonly warnings: readonly string[];
}

export interface JobError {
  readonly kind: string;
  readonly code: string;
  readonly detail: string;
}

export interface Job {
  readonly id: string;
  readonly name: string;
  readonly state: JobState;
  readonly createdAt: string;
  readonly version: number;
  readonly file: { readonly name: string; readonly bytes: number };
  readonly params: Readonly<Record<string, unknown>>; // As they were sent.
  readonly progress: { readonly stage: string; readonly fraction: number };
  readonly error: JobError | null;
  readonly summary: JobSummary | null;
  readonly sheets: readonly JobSheet[];
  readonly cuts: readonly string[];
  readonly priority: number;
  readonly actions: readonly string[];
}

export type CutState =
  | 'waiting'
  | 'armed'
  | 'cutting'
  | 'paused'
  | 'awaiting-sheet'
  | 'done'
  | 'aborted'
  | 'failed'
  | 'interrupted';

export interface CutProgress {
  readonly linesTotal: number;
  readonly linesSent: number;
  readonly linesAcknowledged: number;
  readonly fraction: number; // Of the current sheet.
}

// How far the beam got in a cut that ended early.
export interface Beam {
  readonly percent: number;
  readonly burntMm: number;
  readonly leastMm: number;
  readonly mostMm: number;
  readonly totalMm: number;
  readonly line: number;
  readonly certain: boolean;
  readonly positionKept: boolean; // Otherwise the machine has to be homed first.
}

export interface Cut {
  readonly id: string;
  readonly beam: Beam | null;
  readonly restOf: string | null;
  readonly job: string;
  readonly device: string;
  readonly sheets: readonly number[];
  readonly sheet: number;
  readonly state: CutState;
  readonly programSha256: string;
  readonly progress: CutProgress;
  readonly reason: string;
  readonly version: number;
  readonly createdAt: string;
  readonly actions: readonly string[];
}

export interface DeviceStatus {
  readonly state: string;
  readonly machinePositionMm: readonly number[];
  readonly workPositionMm: readonly number[];
  readonly feedMmPerMin: number;
  readonly powerS: number;
  readonly overridePercent: readonly number[]; // Feed, rapid, power; empty: not known.
  readonly alarmCode: number | null;
  readonly message: string;
  readonly firmware: string;
}

export interface Device {
  readonly id: string;
  readonly name: string;
  readonly uri: string;
  readonly autoStart: boolean;
  readonly bedMm: readonly number[];
  readonly status: DeviceStatus;
  readonly cut: string | null;
  readonly console: readonly string[];
  readonly actions: readonly string[];
}

export interface Material {
  readonly id: string;
  readonly name: string;
  readonly colour: string;
  readonly thicknessMm: number;
  readonly weightGPerM2: number;
  readonly sheets: readonly { readonly widthMm: number; readonly heightMm: number }[];
  readonly cut: { readonly feedMmPerMin: number; readonly passes: number };
  readonly raw: Readonly<Record<string, unknown>>; // All of it, as it came.
}

export interface Artifact {
  readonly path: string;
  readonly bytes: number;
  readonly mediaType: string;
}

export type FeedEvent =
  | { readonly type: 'job'; readonly seq: number | null; readonly job: Job }
  | { readonly type: 'job-removed' | 'cut-removed'; readonly seq: number | null; readonly id: string }
  | { readonly type: 'cut'; readonly seq: number | null; readonly cut: Cut }
  | { readonly type: 'device'; readonly seq: number | null; readonly device: Device }
  | {
      readonly type: 'snapshot';
      readonly seq: number | null;
      readonly jobs: readonly Job[];
      readonly cuts: readonly Cut[];
      readonly devices: readonly Device[];
    };

export interface FieldFault {
  readonly pointer: string; // "/grid/strip_width_mm"
  readonly detail: string;
}
