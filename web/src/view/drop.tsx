// Meshes come in by being dropped anywhere on the page, or picked from a file chooser.

import { useEffect, useState } from 'preact/hooks';

import { t } from '../messages/messages.ts';
import { changeDraft, go } from '../state/store.ts';
import { Icon } from './icons.tsx';

const kEndings = '.stl,.obj,.off,.ply';

function take(files: FileList | null | undefined): void {
  if (files === null || files === undefined || files.length === 0) return;
  changeDraft({ type: 'add', files: [...files] });
  go({ page: 'jobs' });
}

const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;

// A curtain over the whole page while a file hangs over it.
export function DropCurtain() {
  const [over, setOver] = useState(false);
  useEffect(() => {
    const abort = new AbortController();
    const on = (type: 'dragenter' | 'dragover' | 'dragleave' | 'drop', act: (event: DragEvent) => void): void => {
      document.addEventListener(type, (event) => hasFiles(event) && act(event), { signal: abort.signal });
    };
    on('dragenter', () => setOver(true));
    on('dragover', (event) => event.preventDefault());
    on('dragleave', (event) => event.relatedTarget === null && setOver(false));
    on('drop', (event) => {
      event.preventDefault();
      setOver(false);
      take(event.dataTransfer?.files);
    });
    return () => abort.abort();
  }, []);
  if (!over) return null;
  return (
    <div class="curtain">
      <p>
        <Icon name="upload" />
        {t.drop.here}
      </p>
    </div>
  );
}

export function ChooseFile(props: { readonly class: string; readonly label: string }) {
  return (
    <label class={`file-button ${props.class}`}>
      <Icon name="plus" />
      {props.label}
      <input
        type="file"
        multiple
        accept={kEndings}
        class="visually-hidden"
        onChange={(event) => {
          take(event.currentTarget.files);
          event.currentTarget.value = '';
        }}
      />
    </label>
  );
}
