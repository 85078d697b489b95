// A new job with its mesh, as one multipart call. XMLHttpRequest, because fetch tells nothing of how far
// an upload is.

import { kApi, ownHeaders } from './client.ts';
import { readJob } from './payloads.ts';
import { Problem, problemFrom, unreachable } from './problem.ts';
import type { Job } from './types.ts';

export interface NewJob {
  readonly file: File;
  readonly name: string;
  readonly params: Readonly<Record<string, unknown>>;
}

export interface Upload {
  readonly done: Promise<Job>; // Rejects with a Problem; code "cancelled" after cancel().
  cancel(): void;
}

// A job that is sent twice by a retrying network is still one job.
function idempotencyKey(): string {
  const random = crypto.getRandomValues(new Uint8Array(16));
  return [...random].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

function formOf(job: NewJob): FormData {
  const form = new FormData();
  form.append('name', job.name);
  form.append('params', new Blob([JSON.stringify(job.params)], { type: 'application/json' }));
  form.append('mesh', job.file, job.file.name);
  return form;
}

export function uploadJob(job: NewJob, onProgress: (fraction: number) => void): Upload {
  const request = new XMLHttpRequest();
  const done = new Promise<Job>((resolve, reject) => {
    request.upload.onprogress = (event) => {
      if (event.lengthComputable) onProgress(event.loaded / event.total);
    };
    request.onerror = () => reject(unreachable());
    request.onabort = () => reject(new Problem(0, 'cancelled', ''));
    request.onload = () => {
      if (request.status < 200 || request.status > 299) {
        reject(problemFrom(request.status, request.responseText));
        return;
      }
      try {
        resolve(readJob(JSON.parse(request.responseText), ''));
      } catch (fault) {
        reject(new Problem(request.status, 'bad-payload', String(fault)));
      }
    };
  });
  request.open('POST', `${kApi}/jobs`);
  for (const [header, value] of Object.entries(ownHeaders())) request.setRequestHeader(header, value);
  request.setRequestHeader('Idempotency-Key', idempotencyKey());
  request.send(formOf(job));
  return { done, cancel: () => request.abort() };
}
