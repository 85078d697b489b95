import './styles/main.css';

import { render } from 'preact';

import { followSession } from './state/session.ts';
import { followSettings } from './state/settings.ts';
import { followAddress, followEvents } from './state/store.ts';
import { App } from './view/app.tsx';

followAddress();
void followSession().then(followEvents);
void followSettings().then(() => {
  const root = document.getElementById('app');
  if (root !== null) render(<App />, root);
});
