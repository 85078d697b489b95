// The bar that is always there: where one is, whether the page is live, and the STOP buttons.

import { t } from '../messages/messages.ts';
import { formatRoute, type Route } from '../state/route.ts';
import { connection, route } from '../state/store.ts';
import { Logo } from './icons.tsx';
import { StopBar } from './stop_bar.tsx';

function NavLink(props: { readonly to: Route; readonly here: boolean; readonly children: string }) {
  return (
    <a href={formatRoute(props.to)} aria-current={props.here ? 'page' : undefined}>
      {props.children}
    </a>
  );
}

export function Header() {
  const { page } = route.value;
  const state = connection.value;
  return (
    <header class="top">
      <a class="brand" href="#/" aria-label={t.title}>
        <Logo />
        <span>{t.title}</span>
      </a>
      <nav aria-label={t.nav.label}>
        <NavLink to={{ page: 'jobs' }} here={page !== 'machines'}>
          {t.nav.jobs}
        </NavLink>
        <NavLink to={{ page: 'machines' }} here={page === 'machines'}>
          {t.nav.machines}
        </NavLink>
      </nav>
      <p class={`connection connection-${state}`} role="status">
        <span class="dot" aria-hidden="true" />
        <span class="connection-word">{t.connection[state]}</span>
      </p>
      <StopBar />
    </header>
  );
}
