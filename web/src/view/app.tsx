// The whole page.

import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';

import { t } from '../messages/messages.ts';
import { sectionOf } from '../state/route.ts';
import { session } from '../state/session.ts';
import { feed, route } from '../state/store.ts';
import { DropCurtain } from './drop.tsx';
import { Header } from './header.tsx';
import { JobsPage } from './jobs_page.tsx';
import { lazy } from './lazy.tsx';
import { Notices } from './notices.tsx';

const JobPage = lazy(() => import('./job_page.tsx').then((page) => page.JobPage));
const GuidePage = lazy(() => import('./guide/guide_page.tsx').then((page) => page.GuidePage));
const ComparePage = lazy(() => import('./compare_page.tsx').then((page) => page.ComparePage));
const MachinesPage = lazy(() => import('./machines/machines_page.tsx').then((page) => page.MachinesPage));
const QueuePage = lazy(() => import('./queue_page.tsx').then((page) => page.QueuePage));
const MaterialsPage = lazy(() => import('./library/materials_page.tsx').then((page) => page.MaterialsPage));
const StockPage = lazy(() => import('./library/stock_page.tsx').then((page) => page.StockPage));
const SettingsPage = lazy(() => import('./settings/settings_page.tsx').then((page) => page.SettingsPage));
const PeoplePage = lazy(() => import('./settings/people_page.tsx').then((page) => page.PeoplePage));
const AuditPage = lazy(() => import('./settings/audit_page.tsx').then((page) => page.AuditPage));
const LoginPage = lazy(() => import('./login_page.tsx').then((page) => page.LoginPage));

function Page() {
  const now = route.value;
  if (session.value.state === 'asked') return <LoginPage />;
  switch (now.page) {
    case 'job':
      return <JobPage key={now.id} id={now.id} />;
    case 'guide':
      return <GuidePage key={now.id} id={now.id} />;
    case 'compare':
      return <ComparePage key={`${now.id}/${now.other}`} id={now.id} other={now.other} />;
    case 'machines':
      return <MachinesPage />;
    case 'queue':
      return <QueuePage />;
    case 'materials':
      return <MaterialsPage />;
    case 'stock':
      return <StockPage />;
    case 'settings':
      return <SettingsPage />;
    case 'people':
      return <PeoplePage />;
    case 'audit':
      return <AuditPage />;
    case 'jobs':
      return <JobsPage />;
  }
}

function pageTitle(): string {
  const now = route.value;
  const name = 'id' in now ? feed.value.jobs.get(now.id)?.name : undefined;
  if (name !== undefined) return now.page === 'guide' ? `${t.guide.title}: ${name} · ${t.title}` : `${name} · ${t.title}`;
  return now.page === 'jobs' ? t.title : `${t.nav[sectionOf(now)]} · ${t.title}`;
}

export function App() {
  const main = useRef<HTMLElement>(null);
  const shown = useRef(route.value);
  const title = pageTitle();
  useEffect(() => void (document.title = title), [title]);
  // A new page begins at its top, for eyes and for screen readers; before it is painted, so that no key goes astray.
  useLayoutEffect(() => {
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
