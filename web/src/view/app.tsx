// The whole page.

import { useEffect, useRef } from 'preact/hooks';

import { t } from '../messages/messages.ts';
import { feed, route } from '../state/store.ts';
import { DropCurtain } from './drop.tsx';
import { Header } from './header.tsx';
import { JobPage } from './job_page.tsx';
import { JobsPage } from './jobs_page.tsx';
import { MachinesPage } from './machines_page.tsx';
import { Notices } from './notices.tsx';

function Page() {
  const now = route.value;
  if (now.page === 'job') return <JobPage key={now.id} id={now.id} />;
  return now.page === 'machines' ? <MachinesPage /> : <JobsPage />;
}

function pageTitle(): string {
  const now = route.value;
  if (now.page === 'machines') return `${t.nav.machines} · ${t.title}`;
  const name = now.page === 'job' ? feed.value.jobs.get(now.id)?.name : undefined;
  return name === undefined ? t.title : `${name} · ${t.title}`;
}

export function App() {
  const main = useRef<HTMLElement>(null);
  const shown = useRef(route.value);
  const title = pageTitle();
  useEffect(() => void (document.title = title), [title]);
  // A new page begins at its top, for eyes and for screen readers.
  useEffect(() => {
    if (shown.current === route.value) return;
    shown.current = route.value;
    scrollTo(0, 0);
    main.current?.focus({ preventScroll: true });
  }, [route.value]);
  return (
    <>
      <a class="skip" href="#main" onClick={(event) => (event.preventDefault(), main.current?.focus())}>
        {t.skip}
      </a>
      <Header />
      <main id="main" ref={main} tabIndex={-1}>
        <Page />
      </main>
      <Notices />
      <DropCurtain />
    </>
  );
}
