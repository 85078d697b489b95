// Who did what.

import { useEffect, useState } from 'preact/hooks';

import { type AuditEntry, listAudit } from '../../api/admin.ts';
import { dateTime } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { attempt } from '../../state/store.ts';
import { PageTabs } from '../tabs.tsx';
import { useCall } from '../use_call.ts';

function Rows(props: { readonly entries: readonly AuditEntry[] }) {
  const { columns, nobody, host } = t.audit;
  return (
    <div class="panel table-box" tabIndex={0} role="group" aria-label={t.audit.title}>
      <table class="history">
        <thead>
          <tr>
            {(['at', 'user', 'action', 'status', 'remote'] as const).map((key) => (
              <th key={key} scope="col">
                {columns[key]}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {props.entries.map((entry) => (
            <tr key={entry.seq}>
              <td>{dateTime(entry.at, 'medium')}</td>
              <td>{entry.user ?? nobody}</td>
              <td class="audit-action">
                {entry.action} {entry.note !== '' && <span class="quiet">{entry.note}</span>}
              </td>
              <td>{entry.status === 0 ? '' : entry.status}</td>
              <td>{entry.remote === '' ? host : entry.remote}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

export function AuditPage() {
  const [called] = useCall(() => listAudit(null));
  const [entries, setEntries] = useState<readonly AuditEntry[]>([]);
  const [next, setNext] = useState<string | null>(null);
  useEffect(() => {
    if (called.state !== 'there') return;
    setEntries(called.value.entries);
    setNext(called.value.next);
  }, [called]);
  const more = async (): Promise<void> => {
    await attempt(async () => {
      const page = await listAudit(next);
      setEntries([...entries, ...page.entries]);
      setNext(page.next);
    });
  };
  return (
    <div class="page settings-page">
      <PageTabs label={t.nav.settings} pages={['settings', 'people', 'audit']} />
      <h1>{t.audit.title}</h1>
      {called.state === 'failed' && <p class="quiet empty">{called.fault}</p>}
      {called.state === 'loading' && <p class="quiet empty">{t.jobs.loading}</p>}
      {called.state === 'there' && entries.length === 0 && <p class="quiet empty">{t.audit.none}</p>}
      {entries.length > 0 && <Rows entries={entries} />}
      {next !== null && (
        <button type="button" class="button" onClick={() => void more()}>
          {t.audit.more}
        </button>
      )}
    </div>
  );
}
