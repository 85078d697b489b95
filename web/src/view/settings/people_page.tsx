// Users, and the keys by which programs come in.

import { useState } from 'preact/hooks';

import { type Key, kRoles, listKeys, listUsers, removeKey, removeUser, type Role, type User, changeUser } from '../../api/admin.ts';
import { dateTime } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { session } from '../../state/session.ts';
import { attempt } from '../../state/store.ts';
import { AskButton, Panel } from '../controls.tsx';
import { PageTabs } from '../tabs.tsx';
import { useCall } from '../use_call.ts';
import { KeyForm, PasswordForm, UserForm } from './people_forms.tsx';

function RoleSelect(props: { readonly user: User; readonly onChange: (role: Role) => void }) {
  return (
    <select
      aria-label={`${props.user.name}: ${t.people.role}`}
      value={props.user.role}
      onChange={(event) => {
        const chosen = kRoles.find((one) => one === event.currentTarget.value);
        if (chosen !== undefined) props.onChange(chosen);
      }}
    >
      {kRoles.map((role) => (
        <option key={role} value={role}>
          {t.people.roles[role]}
        </option>
      ))}
    </select>
  );
}

function UserRow(props: { readonly user: User; readonly load: () => void; readonly onPassword: () => void }) {
  const { user, load, onPassword } = props;
  const run = (call: () => Promise<void>): void => void attempt(call).then(load);
  return (
    <li class="person">
      <strong>{user.name}</strong>
      <RoleSelect user={user} onChange={(role) => run(() => changeUser(user.name, { role }))} />
      <span class="quiet">{t.people.since(dateTime(user.createdAt))}</span>
      <span class="buttons">
        <button type="button" class="button small" aria-label={`${t.people.change}: ${user.name}`} onClick={onPassword}>
          {t.people.change}
        </button>
        <AskButton class="button small" label={t.remove} question={t.job.reallyRemove} onConfirm={() => run(() => removeUser(user.name))} />
      </span>
    </li>
  );
}

function Users() {
  const [called, load] = useCall(listUsers);
  const [form, setForm] = useState<'new' | User | null>(null);
  const users = called.state === 'there' ? called.value : [];
  const close = (): void => {
    setForm(null);
    void load();
  };
  const add = called.state === 'there' && (
    <button type="button" class="button small" onClick={() => setForm('new')}>
      {t.people.addUser}
    </button>
  );
  return (
    <Panel title={t.people.users} aside={add}>
      {called.state === 'failed' && <p class="quiet">{called.fault}</p>}
      {session.value.state === 'open' && <p class="queue-paused">{t.people.firstUser}</p>}
      <ul class="people">
        {users.map((user) => (
          <UserRow key={user.name} user={user} load={() => void load()} onPassword={() => setForm(user)} />
        ))}
      </ul>
      {form === 'new' && <UserForm first={users.length === 0} onClose={close} />}
      {form !== null && form !== 'new' && <PasswordForm user={form.name} onClose={close} />}
    </Panel>
  );
}

function KeyRow(props: { readonly one: Key; readonly load: () => void }) {
  const { one, load } = props;
  const words = t.people;
  return (
    <li class="person">
      <strong>{one.label}</strong>
      <span>
        {words.roles[one.role]}
        {one.mayFire && ` · ${words.mayFire}`}
      </span>
      <span class="quiet">
        {one.user} · {one.expiresAt === null ? words.never : words.ends(dateTime(one.expiresAt))} ·{' '}
        {one.usedAt === null ? words.unused : words.used(dateTime(one.usedAt))}
      </span>
      <AskButton class="button small" label={t.remove} question={t.job.reallyRemove} onConfirm={() => void attempt(() => removeKey(one.id)).then(load)} />
    </li>
  );
}

function Keys() {
  const [called, load] = useCall(listKeys);
  const [making, setMaking] = useState(false);
  const keys = called.state === 'there' ? called.value : [];
  const add = called.state === 'there' && (
    <button type="button" class="button small" onClick={() => setMaking(true)}>
      {t.people.addKey}
    </button>
  );
  return (
    <Panel title={t.people.keys} aside={add}>
      {called.state === 'failed' && <p class="quiet">{called.fault}</p>}
      {called.state === 'there' && keys.length === 0 && <p class="quiet">{t.people.noKeys}</p>}
      <ul class="people">
        {keys.map((one) => (
          <KeyRow key={one.id} one={one} load={() => void load()} />
        ))}
      </ul>
      {making && (
        <KeyForm
          onClose={() => {
            setMaking(false);
            void load();
          }}
        />
      )}
    </Panel>
  );
}

export function PeoplePage() {
  return (
    <div class="page settings-page">
      <PageTabs label={t.nav.settings} pages={['settings', 'people', 'audit']} />
      <h1>{t.tabs.people}</h1>
      <Users />
      <Keys />
    </div>
  );
}
