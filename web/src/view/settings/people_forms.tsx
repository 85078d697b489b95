// New users, new passwords, new keys.

import { useState } from 'preact/hooks';

import { addKey, addUser, changeUser, kRoles, type Role } from '../../api/admin.ts';
import { t } from '../../messages/messages.ts';
import { session } from '../../state/session.ts';
import { attempt, say } from '../../state/store.ts';
import { Dialog, DialogButtons } from '../dialog.tsx';
import { numberOf, SelectField, TextField, Tick } from '../fields.tsx';

const kShortestPassword = 10;

const roleChoices = () => kRoles.map((value) => ({ value, label: t.people.roles[value] }));

export function UserForm(props: { readonly first: boolean; readonly onClose: () => void }) {
  const { first, onClose } = props;
  const [name, setName] = useState('');
  const [password, setPassword] = useState('');
  const [role, setRole] = useState<Role>(first ? 'admin' : 'operator');
  const [busy, setBusy] = useState(false);
  const can = /^[a-z0-9._-]{1,64}$/.test(name) && password.length >= kShortestPassword;
  const save = async (): Promise<void> => {
    setBusy(true);
    const done = await attempt(() => addUser({ name, role, password }));
    setBusy(false);
    if (!done) return;
    onClose();
    // From now on the daemon asks who one is.
    if (first) location.reload();
  };
  return (
    <Dialog title={t.people.addUser} onClose={onClose}>
      <form class="dialog-form" onSubmit={(event) => (event.preventDefault(), can && void save())}>
        <TextField label={t.people.name} value={name} onInput={setName} placeholder={t.people.nameHint} complete="username" required />
        <TextField
          label={t.people.password}
          type="password"
          value={password}
          onInput={setPassword}
          placeholder={t.people.passwordHint}
          complete="new-password"
          required
        />
        {!first && <SelectField<Role> label={t.people.role} value={role} choices={roleChoices()} onChange={setRole} />}
        <DialogButtons busy={busy} can={can} label={t.save} onClose={onClose} />
      </form>
    </Dialog>
  );
}

export function PasswordForm(props: { readonly user: string; readonly onClose: () => void }) {
  const { user, onClose } = props;
  const [password, setPassword] = useState('');
  const [oldPassword, setOld] = useState('');
  const [busy, setBusy] = useState(false);
  const now = session.value;
  const own = now.state === 'in' && now.user === user;
  const can = password.length >= kShortestPassword && (!own || oldPassword !== '');
  const save = async (): Promise<void> => {
    setBusy(true);
    const done = await attempt(() => changeUser(user, own ? { password, oldPassword } : { password }));
    setBusy(false);
    if (!done) return;
    say('said', t.people.changed);
    onClose();
  };
  return (
    <Dialog title={`${t.people.change}: ${user}`} onClose={onClose}>
      <form class="dialog-form" onSubmit={(event) => (event.preventDefault(), can && void save())}>
        {own && (
          <TextField label={t.people.oldPassword} type="password" value={oldPassword} onInput={setOld} complete="current-password" required />
        )}
        <TextField
          label={t.people.newPassword}
          type="password"
          value={password}
          onInput={setPassword}
          placeholder={t.people.passwordHint}
          complete="new-password"
          required
        />
        <DialogButtons busy={busy} can={can} label={t.save} onClose={onClose} />
      </form>
    </Dialog>
  );
}

function Secret(props: { readonly secret: string; readonly onClose: () => void }) {
  const copy = (): void => {
    navigator.clipboard?.writeText(props.secret).then(
      () => say('said', t.people.copied),
      () => undefined,
    );
  };
  return (
    <div class="dialog-form">
      <p>{t.people.secret}</p>
      <p>
        <code class="secret">{props.secret}</code>
      </p>
      <div class="buttons">
        <button type="button" class="button primary" onClick={copy}>
          {t.people.copy}
        </button>
        <button type="button" class="button" onClick={props.onClose}>
          {t.close}
        </button>
      </div>
    </div>
  );
}

export function KeyForm(props: { readonly onClose: () => void }) {
  const { onClose } = props;
  const [label, setLabel] = useState('');
  const [role, setRole] = useState<Role>('submitter');
  const [mayFire, setMayFire] = useState(false);
  const [days, setDays] = useState('');
  const [busy, setBusy] = useState(false);
  const [secret, setSecret] = useState<string | null>(null);
  const ends = numberOf(days);
  const can = label.trim() !== '' && (days.trim() === '' || (ends !== null && Number.isInteger(ends) && ends >= 1 && ends <= 3650));
  const save = async (): Promise<void> => {
    setBusy(true);
    await attempt(async () => setSecret(await addKey({ label: label.trim(), role, mayFire, expiresInDays: ends })));
    setBusy(false);
  };
  return (
    <Dialog title={t.people.addKey} onClose={onClose}>
      {secret !== null ? (
        <Secret secret={secret} onClose={onClose} />
      ) : (
        <form class="dialog-form" onSubmit={(event) => (event.preventDefault(), can && void save())}>
          <TextField label={t.people.label} value={label} onInput={setLabel} required />
          <SelectField<Role> label={t.people.role} value={role} choices={roleChoices()} onChange={setRole} />
          <TextField label={t.people.expires} value={days} onInput={setDays} placeholder={t.people.never} decimal />
          <Tick checked={mayFire} onChange={setMayFire}>
            {t.people.mayFire}
          </Tick>
          <DialogButtons busy={busy} can={can} label={t.people.addKey} onClose={onClose} />
        </form>
      )}
    </Dialog>
  );
}
