import './styles/main.css';

import { render } from 'preact';

import { followAddress, followEvents } from './state/store.ts';
import { App } from './view/app.tsx';

followAddress();
followEvents();
const root = document.getElementById('app');
if (root !== null) render(<App />, root);
