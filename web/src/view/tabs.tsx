// Pages that belong together, side by side over each of them.

import { t } from '../messages/messages.ts';
import { formatRoute, type PlainPage } from '../state/route.ts';
import { route } from '../state/store.ts';

export function PageTabs(props: { readonly label: string; readonly pages: readonly PlainPage[] }) {
  return (
    <nav class="page-tabs" aria-label={props.label}>
      {props.pages.map((page) => (
        <a key={page} href={formatRoute({ page })} aria-current={route.value.page === page ? 'page' : undefined}>
          {t.tabs[page]}
        </a>
      ))}
    </nav>
  );
}
