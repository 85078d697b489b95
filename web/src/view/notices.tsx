// What went wrong or was done, said once, at the foot of the page.

import { t } from '../messages/messages.ts';
import { dismiss, notices } from '../state/store.ts';
import { Icon } from './icons.tsx';

export function Notices() {
  return (
    <div class="notices" aria-live="assertive" role="status">
      {notices.value.map((notice) => (
        <div key={notice.key} class={`notice notice-${notice.kind}`}>
          <p>{notice.text}</p>
          <button type="button" class="plain" aria-label={t.dismiss} onClick={() => dismiss(notice.key)}>
            <Icon name="close" />
          </button>
        </div>
      ))}
    </div>
  );
}
