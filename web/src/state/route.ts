// The page's address: what comes after the #.

export const kPlainPages = ['jobs', 'queue', 'machines', 'materials', 'stock', 'settings', 'people', 'audit'] as const;
export type PlainPage = (typeof kPlainPages)[number];

export type Route =
  | { readonly page: PlainPage }
  | { readonly page: 'job'; readonly id: string }
  | { readonly page: 'guide'; readonly id: string }
  | { readonly page: 'compare'; readonly id: string; readonly other: string };

function decoded(word: string): string {
  try {
    return decodeURIComponent(word);
  } catch {
    return word;
  }
}

export function parseRoute(hash: string): Route {
  const [first = '', second = '', third = '', fourth = ''] = hash.replace(/^#?\/?/, '').split('/').map(decoded);
  if (first === 'jobs' && second !== '') {
    if (third === 'guide') return { page: 'guide', id: second };
    if (third === 'compare' && fourth !== '') return { page: 'compare', id: second, other: fourth };
    return { page: 'job', id: second };
  }
  return { page: kPlainPages.find((page) => page === first) ?? 'jobs' };
}

export function formatRoute(route: Route): string {
  switch (route.page) {
    case 'job':
      return `#/jobs/${encodeURIComponent(route.id)}`;
    case 'guide':
      return `#/jobs/${encodeURIComponent(route.id)}/guide`;
    case 'compare':
      return `#/jobs/${encodeURIComponent(route.id)}/compare/${encodeURIComponent(route.other)}`;
    case 'jobs':
      return '#/';
    default:
      return `#/${route.page}`;
  }
}

// The entry of the main navigation that a page belongs to.
export type Section = 'jobs' | 'queue' | 'machines' | 'materials' | 'settings';

export function sectionOf({ page }: Route): Section {
  if (page === 'queue' || page === 'machines' || page === 'materials') return page;
  if (page === 'stock') return 'materials';
  return page === 'settings' || page === 'people' || page === 'audit' ? 'settings' : 'jobs';
}
