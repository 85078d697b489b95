// All pieces by the sheet they come from, to be ticked off as they are laid ready.

import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import type { GuideProgress } from '../../state/assembly.ts';
import type { JobPackage } from '../../state/package_store.ts';
import { materialName } from '../../state/store.ts';

export function PartsList(props: {
  readonly content: JobPackage;
  readonly progress: GuideProgress;
  readonly onTick: (id: string) => void;
}) {
  const { content, progress, onTick } = props;
  const found = new Set(progress.parts);
  const all = content.sheets.reduce((sum, sheet) => sum + sheet.pieces.length, 0);
  return (
    <div class="parts">
      <p class="quiet">{t.guide.found(count(found.size), count(all))}</p>
      {content.sheets.map((sheet) => (
        <section key={sheet.id}>
          <h2>{t.guide.sheet(count(sheet.id), materialName(sheet.material))}</h2>
          <ul class="parts-list">
            {sheet.pieces.map(({ piece, family }) => (
              <li key={piece}>
                <label class={`part ${family}`}>
                  <input type="checkbox" checked={found.has(piece)} onChange={() => onTick(piece)} />
                  <span>{piece}</span>
                </label>
              </li>
            ))}
          </ul>
        </section>
      ))}
    </div>
  );
}
