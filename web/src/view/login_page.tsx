// Where the daemon knows accounts: who are you?

import { useState } from 'preact/hooks';

import { Problem } from '../api/problem.ts';
import { t } from '../messages/messages.ts';
import { enter } from '../state/session.ts';
import { problemText } from '../state/store.ts';
import { TextField } from './fields.tsx';
import { Logo } from './icons.tsx';

export function LoginPage() {
  const [user, setUser] = useState('');
  const [password, setPassword] = useState('');
  const [fault, setFault] = useState('');
  const [busy, setBusy] = useState(false);
  const go = async (): Promise<void> => {
    setBusy(true);
    try {
      await enter(user.trim(), password);
      location.reload(); // The event feed begins anew, now with the right to it.
    } catch (problem) {
      setFault(problem instanceof Problem && problem.status === 401 ? t.login.wrong : problemText(problem));
      setPassword('');
    }
    setBusy(false);
  };
  return (
    <div class="page login-page">
      <form
        class="panel login"
        onSubmit={(event) => {
          event.preventDefault();
          void go();
        }}
      >
        <Logo />
        <h1>{t.login.title}</h1>
        <TextField label={t.login.user} value={user} onInput={setUser} complete="username" required />
        <TextField label={t.login.password} type="password" value={password} onInput={setPassword} complete="current-password" required />
        <p class="fault" role="alert">
          {fault}
        </p>
        <button type="submit" class="button primary" disabled={busy || user.trim() === '' || password === ''}>
          {t.login.enter}
        </button>
      </form>
    </div>
  );
}
