// The page's address: what comes after the #.

export type Route =
  | { readonly page: 'jobs' }
  | { readonly page: 'job'; readonly id: string }
  | { readonly page: 'machines' };

export function parseRoute(hash: string): Route {
  const words = hash.replace(/^#?\/?/, '').split('/');
  if (words[0] === 'machines') return { page: 'machines' };
  if (words[0] === 'jobs' && words[1]) return { page: 'job', id: decodeURIComponent(words[1]) };
  return { page: 'jobs' };
}

export function formatRoute(route: Route): string {
  if (route.page === 'machines') return '#/machines';
  if (route.page === 'job') return `#/jobs/${encodeURIComponent(route.id)}`;
  return '#/';
}
