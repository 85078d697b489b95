// The bar that is always there: where one is, whether the page is live, and the STOP button.

import { t } from '../messages/messages.ts';
import { formatRoute, type Section, sectionOf } from '../state/route.ts';
import { session } from '../state/session.ts';
import { connection, route } from '../state/store.ts';
import { Icon, type IconName, Logo } from './icons.tsx';
import { StopButton } from './stop_button.tsx';

const kSections: readonly { readonly section: Section; readonly icon: IconName }[] = [
  { section: 'jobs', icon: 'weave' },
  { section: 'queue', icon: 'list' },
  { section: 'machines', icon: 'laser' },
  { section: 'materials', icon: 'sheet' },
  { section: 'settings', icon: 'gear' },
];

// Where one may go, and whether what is shown there is live.
function Ways() {
  const here = sectionOf(route.value);
  const state = connection.value;
  return (
    <>
      <nav class="main-nav" aria-label={t.nav.label}>
        {kSections.map(({ section, icon }) => (
          <a key={section} href={formatRoute({ page: section })} aria-current={section === here ? 'page' : undefined}>
            <Icon name={icon} />
            <span>{t.nav[section]}</span>
          </a>
        ))}
      </nav>
      <p class={`connection connection-${state}`} role="status">
        <span class="dot" aria-hidden="true" />
        <span class="connection-word">{t.connection[state]}</span>
      </p>
    </>
  );
}

// Before the login there is nowhere to go, but machines can be stopped.
export function Header() {
  return (
    <header class="top">
      <a class="brand" href="#/" aria-label={t.title}>
        <Logo />
        <span>{t.title}</span>
      </a>
      {session.value.state !== 'asked' && <Ways />}
      <StopButton />
    </header>
  );
}
