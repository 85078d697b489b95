// Reads and looks at meshes beside the page, which stays quick meanwhile.

import { lookAt } from './look.ts';
import { MeshFault, readMesh } from './read.ts';

export type WorkerAnswer =
  | ({ readonly key: number } & ReturnType<typeof lookAt>)
  | { readonly key: number; readonly fault: string };

addEventListener('message', (event: MessageEvent<{ readonly key: number; readonly file: File }>) => {
  const { key, file } = event.data;
  const answer = (value: WorkerAnswer): void => postMessage(value);
  file
    .arrayBuffer()
    .then((bytes) => answer({ key, ...lookAt(readMesh(file.name, bytes)) }))
    .catch((fault: unknown) => answer({ key, fault: fault instanceof MeshFault ? fault.message : 'unreadable' }));
});
