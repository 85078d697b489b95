// A page whose code comes only when it is opened.

import type { ComponentType } from 'preact';
import { useEffect, useState } from 'preact/hooks';

import { t } from '../messages/messages.ts';

export function lazy<Props extends object>(load: () => Promise<ComponentType<Props>>): ComponentType<Props> {
  let known: ComponentType<Props> | null = null;
  return function Lazy(props: Props) {
    const [failed, setFailed] = useState(false);
    const [, setLoaded] = useState(false);
    useEffect(() => {
      if (known !== null) return;
      load().then(
        (component) => {
          known = component;
          setLoaded(true);
        },
        () => setFailed(true),
      );
    }, []);
    if (failed) return <p class="page empty" role="alert">{t.problem.stale}</p>;
    if (known === null) return <p class="page quiet empty">{t.jobs.loading}</p>;
    const Known = known;
    return <Known {...props} />;
  };
}
