// A window over the page: the browser's own dialog, which keeps the focus inside and closes with Escape.

import type { ComponentChildren } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import { t } from '../messages/messages.ts';
import { Icon } from './icons.tsx';

export function Dialog(props: { readonly title: string; readonly onClose: () => void; readonly children: ComponentChildren }) {
  const element = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    element.current?.showModal();
    return () => element.current?.close();
  }, []);
  return (
    <dialog ref={element} class="dialog" aria-label={props.title} onClose={props.onClose}>
      <header class="panel-head">
        <h2>{props.title}</h2>
        <button type="button" class="plain" aria-label={t.close} onClick={props.onClose}>
          <Icon name="close" />
        </button>
      </header>
      {props.children}
    </dialog>
  );
}

// What a dialog's form ends with.
export function DialogButtons(props: { readonly busy: boolean; readonly can: boolean; readonly label: string; readonly onClose: () => void }) {
  return (
    <div class="buttons">
      <button type="submit" class="button primary" disabled={props.busy || !props.can}>
        {props.label}
      </button>
      <button type="button" class="button" onClick={props.onClose}>
        {t.cancel}
      </button>
    </div>
  );
}
