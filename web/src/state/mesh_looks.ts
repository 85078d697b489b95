// What the draft's meshes are, looked at in a worker as soon as they are dropped.

import { signal } from '@preact/signals';

import type { MeshLook, Welded } from '../mesh/look.ts';
import type { WorkerAnswer } from '../mesh/worker.ts';

export type Looked =
  | { readonly state: 'looking' }
  | { readonly state: 'unreadable'; readonly fault: string }
  | { readonly state: 'seen'; readonly look: MeshLook; readonly welded: Welded };

export const looks = signal<ReadonlyMap<number, Looked>>(new Map());

const kLargestBytes = 300_000_000; // Beyond it the daemon alone has a look.
let worker: Worker | null = null;
const files = new Map<number, File>();

function put(key: number, looked: Looked): void {
  looks.value = new Map(looks.value).set(key, looked);
}

function startWorker(): Worker | null {
  const address = document.querySelector<HTMLMetaElement>('meta[name=mesh-worker]')?.content;
  if (address === undefined) return null;
  const made = new Worker(address, { type: 'module' });
  made.addEventListener('message', ({ data }: MessageEvent<WorkerAnswer>) => {
    if (!files.has(data.key)) return;
    put(data.key, 'fault' in data ? { state: 'unreadable', fault: data.fault } : { state: 'seen', look: data.look, welded: data.welded });
  });
  return made;
}

// Does nothing for a file that is known already.
export function lookAtFile(key: number, file: File): void {
  if (files.get(key) === file) return;
  files.set(key, file);
  if (file.size > kLargestBytes) return;
  worker ??= startWorker();
  put(key, { state: 'looking' });
  worker?.postMessage({ key, file });
}

export function forgetLooks(kept: ReadonlySet<number>): void {
  for (const key of [...files.keys()]) if (!kept.has(key)) files.delete(key);
  if ([...looks.value.keys()].some((key) => !kept.has(key))) {
    looks.value = new Map([...looks.value].filter(([key]) => kept.has(key)));
  }
}
