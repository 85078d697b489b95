// Meshes on their way to the daemon.

import { signal } from '@preact/signals';

import { recomputeJob } from '../api/client.ts';
import { Problem } from '../api/problem.ts';
import type { Job } from '../api/types.ts';
import { type NewJob, type Upload, uploadJob } from '../api/upload.ts';
import { draftParams } from './draft.ts';
import { attempt, changeDraft, draft, go, problemText, receive } from './store.ts';

export interface Sending {
  readonly key: number;
  readonly name: string;
  readonly fraction: number;
  readonly fault: string | null;
}

export const sendings = signal<readonly Sending[]>([]);
const uploads = new Map<number, Upload>();
let nextKey = 1;

function update(key: number, values: Partial<Sending>): void {
  sendings.value = sendings.value.map((one) => (one.key === key ? { ...one, ...values } : one));
}

export function forget(key: number): void {
  uploads.get(key)?.cancel();
  uploads.delete(key);
  sendings.value = sendings.value.filter((one) => one.key !== key);
}

async function send(job: NewJob): Promise<Job | null> {
  const key = nextKey++;
  sendings.value = [...sendings.value, { key, name: job.name, fraction: 0, fault: null }];
  const upload = uploadJob(job, (fraction) => update(key, { fraction }));
  uploads.set(key, upload);
  try {
    const made = await upload.done;
    receive({ type: 'job', seq: null, job: made });
    forget(key);
    return made;
  } catch (fault) {
    uploads.delete(key);
    if (fault instanceof Problem && fault.code === 'cancelled') return null;
    update(key, { fault: problemText(fault) });
    return null;
  }
}

// The same mesh with the draft's parameters. The draft stays if they are refused.
async function weaveAgain(job: string): Promise<void> {
  const done = await attempt(async () => {
    const made = await recomputeJob(job, draftParams(draft.value));
    receive({ type: 'job', seq: null, job: made });
    go({ page: 'job', id: made.id });
  });
  if (done) changeDraft({ type: 'clear' });
}

// Sends the draft's files. A single one is opened as soon as it is a job. Files that were refused come
// back into the draft, so that a wrong setting can be mended.
export async function sendDraft(): Promise<void> {
  const { files, again } = draft.value;
  if (again !== null) return weaveAgain(again.job);
  const params = draftParams(draft.value);
  changeDraft({ type: 'clear' });
  const made = await Promise.all(files.map(({ file, name }) => send({ file, name: name.trim() || file.name, params })));
  const refused = files.filter((_, index) => made[index] === null);
  changeDraft({ type: 'put-back', files: refused });
  const only = made[0];
  if (made.length === 1 && only) go({ page: 'job', id: only.id });
}
