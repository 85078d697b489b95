// The mesh of a job that is about to be woven again, and how it was woven.

import { signal } from '@preact/signals';

import { artifactText, jobMesh } from '../api/client.ts';
import { type QuadMesh, readQuads, readReport } from '../api/package_files.ts';
import { wovenCylinders, type WovenCylinders } from './cylinders.ts';
import { lookAtFile } from './mesh_looks.ts';

export interface WovenBefore {
  readonly job: string;
  readonly cylinders: WovenCylinders;
  readonly quads: QuadMesh;
}

export const kAgainKey = 0; // Of the mesh among the looks; files of a draft count from 1.
export const wovenBefore = signal<WovenBefore | null>(null);

async function loadCylinders(job: string): Promise<void> {
  const cylinders = wovenCylinders(readReport(JSON.parse(await artifactText(job, 'report.json')), 'report.json'));
  if (cylinders === null) return;
  wovenBefore.value = { job, cylinders, quads: readQuads(await artifactText(job, 'quads.obj')) };
}

// What can't be had leaves the form without a view: places can be typed then.
export async function lookAtJob(job: string, file: string): Promise<void> {
  if (wovenBefore.value?.job !== job) wovenBefore.value = null;
  const mesh = jobMesh(job).then((bytes) => lookAtFile(kAgainKey, new File([bytes], file)));
  await Promise.allSettled([mesh, loadCylinders(job)]);
}
