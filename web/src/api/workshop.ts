// Machines, ports, materials and stock, as they are looked after.

import { type Fields, fields, flag, list, number, optional, point, type Reader, record, text } from '../lib/check.ts';
import { read, send } from './client.ts';
import type { Point } from './package_files.ts';
import { listUnder } from './payloads.ts';

export interface Port {
  readonly uri: string;
  readonly description: string;
  readonly trouble: string;
}

const readPort: Reader<Port> = (value, path) => {
  const get = record(value, path);
  return {
    uri: get('uri', text),
    description: get('description', optional(text, '')),
    trouble: get('trouble', optional(text, '')),
  };
};

export const listPorts = (): Promise<readonly Port[]> => read('/ports', listUnder('ports', readPort));

export interface DeviceWish {
  readonly name: string;
  readonly uri: string;
  readonly bedMm: readonly [number, number];
  readonly autoStart: boolean;
}

export async function putDevice(id: string, { name, uri, bedMm, autoStart }: DeviceWish): Promise<void> {
  await send('PUT', `/devices/${encodeURIComponent(id)}`, { name, uri, bed_mm: bedMm, auto_start: autoStart });
}

export async function removeDevice(id: string): Promise<void> {
  await send('DELETE', `/devices/${encodeURIComponent(id)}`);
}

export async function putMaterial(id: string, material: Readonly<Record<string, unknown>>): Promise<void> {
  await send('PUT', `/materials/${encodeURIComponent(id)}`, material);
}

export async function removeMaterial(id: string): Promise<void> {
  await send('DELETE', `/materials/${encodeURIComponent(id)}`);
}

// A sheet or a remnant at hand.
export interface StockItem {
  readonly id: string;
  readonly material: string;
  readonly widthMm: number;
  readonly heightMm: number;
  readonly outline: readonly Point[]; // Empty: the whole rectangle.
  readonly holes: readonly (readonly Point[])[];
  readonly quantity: number | null; // Null: as many as wanted.
  readonly planned: number;
  readonly note: string;
  readonly fromJob: string;
  readonly kept: Fields; // What is not changed here, and is sent back as it came.
}

const kKept = ['holes', 'defects', 'keep_out', 'cost', 'note'] as const;

function keptOf(value: unknown): Fields {
  const all = value as Fields;
  return Object.fromEntries(kKept.filter((key) => all[key] !== undefined).map((key) => [key, all[key]]));
}

function sizeOf(outline: readonly Point[]): readonly [number, number] {
  const across = (axis: 0 | 1): number => {
    const all = outline.map((at) => at[axis]);
    return all.length === 0 ? 0 : Math.max(...all) - Math.min(...all);
  };
  return [across(0), across(1)];
}

export const readStockItem: Reader<StockItem> = (value, path) => {
  const get = record(value, path);
  const outline = get('outline', optional(list(point), []));
  const [width, height] = sizeOf(outline);
  return {
    id: get('id', text),
    material: get('material', optional(text, '')),
    widthMm: get('width_mm', optional(number, width)),
    heightMm: get('height_mm', optional(number, height)),
    outline,
    holes: get('holes', optional(list(list(point)), [])),
    quantity: 'quantity' in (value as object) ? get('quantity', optional(number, null)) : 1,
    planned: get('planned', optional(number, 0)),
    note: get('note', optional(text, '')),
    fromJob: get('from_job', optional(text, '')),
    kept: keptOf(value),
  };
};

export const listStock = (): Promise<readonly StockItem[]> => read('/stock', listUnder('stock', readStockItem));

export interface StockWish {
  readonly material: string;
  readonly widthMm: number;
  readonly heightMm: number;
  readonly outline: readonly Point[] | null; // Null: the whole rectangle.
  readonly quantity: number | null; // Null: as many as wanted.
  readonly kept: Fields;
}

export async function putStock(id: string, wish: StockWish): Promise<void> {
  const shape = wish.outline === null ? { width_mm: wish.widthMm, height_mm: wish.heightMm } : { outline: wish.outline };
  const body = { ...wish.kept, ...shape, material: wish.material, quantity: wish.quantity };
  await send('PUT', `/stock/${encodeURIComponent(id)}`, body);
}

export async function removeStock(id: string): Promise<void> {
  await send('DELETE', `/stock/${encodeURIComponent(id)}`);
}

// The queue of jobs to compute.
export interface QueueState {
  readonly paused: boolean;
  readonly reason: string;
  readonly next: readonly string[]; // Jobs, in the order in which they will be computed.
}

export const getQueue = (): Promise<QueueState> =>
  read('/queue', (value, path) => {
    const get = record(value, path);
    return {
      paused: get('paused', optional(flag, false)),
      reason: get('reason', optional(text, '')),
      next: get('next', optional(list((one, at) => record(one, at)('id', text)), [])),
    };
  });

export async function pauseQueue(paused: boolean): Promise<void> {
  await send('POST', `/queue/${paused ? 'pause' : 'resume'}`, {});
}

export async function moveJob(id: string, change: { readonly priority?: number; readonly position?: number }): Promise<void> {
  await send('PATCH', `/jobs/${id}`, change);
}

export async function retryJob(id: string): Promise<void> {
  await send('POST', `/jobs/${id}/retry`, {});
}

export interface Version {
  readonly name: string;
  readonly version: string;
}

export const getVersion = (): Promise<Version> =>
  read('/version', (value, path) => {
    const get = record(value, path);
    return { name: get('name', optional(text, '')), version: get('version', optional(text, '')) };
  });

// What a machine's controller keeps of itself.
export interface MachineSetting {
  readonly key: string;
  readonly value: number;
  readonly name: string;
}

const readSetting: Reader<MachineSetting> = (value, path) => {
  const get = record(value, path);
  return { key: get('key', text), value: get('value', number), name: get('name', optional(text, '')) };
};

export const listSettings = (device: string): Promise<readonly MachineSetting[]> =>
  read(`/devices/${encodeURIComponent(device)}/settings`, listUnder('settings', readSetting));

// A set of job parameters under a name.
export interface Preset {
  readonly id: string;
  readonly name: string;
  readonly params: Readonly<Record<string, unknown>>;
}

const readPreset: Reader<Preset> = (value, path) => {
  const get = record(value, path);
  const id = get('id', text);
  return { id, name: get('name', optional(text, '')) || id, params: get('params', optional(fields, {})) };
};

export const listPresets = (): Promise<readonly Preset[]> => read('/presets', listUnder('presets', readPreset));

export async function putPreset(id: string, name: string, params: Preset['params']): Promise<void> {
  await send('PUT', `/presets/${encodeURIComponent(id)}`, { name, params });
}
