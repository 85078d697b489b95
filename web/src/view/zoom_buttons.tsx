// Nearer, farther, all of it: beside every view that can be zoomed.

import { t } from '../messages/messages.ts';
import { Icon } from './icons.tsx';

const kStep = 1.4;

export function ZoomButtons(props: {
  readonly fitLabel: string;
  readonly onZoom: (factor: number) => void;
  readonly onFit: () => void;
}) {
  return (
    <div class="zoom-buttons">
      <button type="button" class="plain" aria-label={t.view.zoomOut} onClick={() => props.onZoom(1 / kStep)}>
        <Icon name="minus" />
      </button>
      <button type="button" class="plain" aria-label={t.view.zoomIn} onClick={() => props.onZoom(kStep)}>
        <Icon name="plus" />
      </button>
      <button type="button" class="plain" aria-label={props.fitLabel} onClick={props.onFit}>
        <Icon name="fit" />
      </button>
    </div>
  );
}
