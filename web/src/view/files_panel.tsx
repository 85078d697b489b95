// The package to take away: all of it, or single files.

import { artifactUrl, packageUrl } from '../api/client.ts';
import type { Artifact } from '../api/types.ts';
import { bytes } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { ending, type FileRow, fileRows } from '../state/files.ts';
import { Panel } from './controls.tsx';
import { Icon } from './icons.tsx';

function FileLink(props: { readonly job: string; readonly file: Artifact; readonly children: string }) {
  const { path } = props.file;
  return (
    <a href={artifactUrl(props.job, path)} download={path.split('/').at(-1)} title={path}>
      {props.children}
    </a>
  );
}

function Row(props: { readonly job: string; readonly row: FileRow }) {
  const { job, row } = props;
  const [first] = row.files;
  if (row.sheet !== null) {
    return (
      <li>
        <span>{t.sheets.one(row.sheet)}</span>
        <span class="file-kinds">
          {row.files.map((file) => (
            <FileLink key={file.path} job={job} file={file}>
              {t.files.kinds[ending(file.path)] ?? ending(file.path)}
            </FileLink>
          ))}
        </span>
      </li>
    );
  }
  if (row.pages === true) {
    return (
      <li>
        <span>{t.files.pages}</span>
        <span class="file-kinds">
          {row.files.map((file, index) => (
            <FileLink key={file.path} job={job} file={file}>
              {`${index + 1}`}
            </FileLink>
          ))}
        </span>
      </li>
    );
  }
  if (first === undefined) return null;
  return (
    <li>
      <FileLink job={job} file={first}>
        {t.files.about[first.path] ?? first.path}
      </FileLink>
      <span class="quiet">{bytes(first.bytes)}</span>
    </li>
  );
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
        {fileRows(artifacts).map((row) => (
          <Row key={row.sheet ?? row.files[0]?.path} job={job} row={row} />
        ))}
      </ul>
    </Panel>
  );
}
