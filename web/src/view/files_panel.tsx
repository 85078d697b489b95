// The package to take away: all of it, or single files.

import { artifactUrl, packageUrl } from '../api/client.ts';
import type { Artifact } from '../api/types.ts';
import { bytes } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { Panel } from './controls.tsx';
import { Icon } from './icons.tsx';

function label(path: string): string {
  return t.files.about[path] ?? path.replace(/^sheets\//, '');
}

export function FilesPanel(props: { readonly job: string; readonly artifacts: readonly Artifact[] }) {
  const { job, artifacts } = props;
  return (
    <Panel
      title={t.files.title}
      class="files"
      aside={
        <a class="button small" href={packageUrl(job)} download>
          <Icon name="download" />
          {t.files.all}
        </a>
      }
    >
      <ul class="file-list">
        {artifacts.map((file) => (
          <li key={file.path}>
            <a href={artifactUrl(job, file.path)} download={file.path.split('/').at(-1)} title={file.path}>
              {label(file.path)}
            </a>
            <span class="quiet">{bytes(file.bytes)}</span>
          </li>
        ))}
      </ul>
    </Panel>
  );
}
