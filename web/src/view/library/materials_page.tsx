// Materials: what the strips are made of.

import { useEffect, useState } from 'preact/hooks';

import type { Material } from '../../api/types.ts';
import { removeMaterial } from '../../api/workshop.ts';
import { figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { isAdmin } from '../../state/session.ts';
import { attempt, loadMaterials, materials } from '../../state/store.ts';
import { AskButton } from '../controls.tsx';
import { Icon } from '../icons.tsx';
import { PageTabs } from '../tabs.tsx';
import { MaterialForm } from './material_form.tsx';

function MaterialCard(props: { readonly material: Material; readonly onEdit: () => void }) {
  const { material, onEdit } = props;
  const [sheet] = material.sheets;
  const origin = material.raw['origin'];
  const remove = (): void => {
    void attempt(async () => {
      await removeMaterial(material.id);
      await loadMaterials(true);
    });
  };
  return (
    <li class="panel material-card">
      <span class="material-colour" style={{ background: material.colour }} aria-hidden="true" />
      <div>
        <h2>{material.name}</h2>
        <p class="quiet">
          {figure(material.thicknessMm)} mm · {figure(material.weightGPerM2)} g/m²
        </p>
        {sheet !== undefined && <p class="quiet">{t.sheets.size(figure(sheet.widthMm, 5), figure(sheet.heightMm, 5))}</p>}
      </div>
      {isAdmin.value && (
        <div class="buttons">
          <button type="button" class="button small" aria-label={`${t.edit}: ${material.name}`} onClick={onEdit}>
            {t.edit}
          </button>
          {origin !== 'built-in' && (
            <AskButton
              class="button small"
              label={origin === 'changed' ? t.materials.restore : t.remove}
              question={t.job.reallyRemove}
              onConfirm={remove}
            />
          )}
        </div>
      )}
    </li>
  );
}

export function MaterialsPage() {
  const [edited, setEdited] = useState<Material | 'new' | null>(null);
  useEffect(() => void attempt(() => loadMaterials(true)), []);
  return (
    <div class="page">
      <PageTabs label={t.nav.materials} pages={['materials', 'stock']} />
      <header class="page-head">
        <h1>{t.tabs.materials}</h1>
        {isAdmin.value && (
          <button type="button" class="button" onClick={() => setEdited('new')}>
            <Icon name="plus" />
            {t.materials.add}
          </button>
        )}
      </header>
      <ul class="material-list">
        {materials.value.map((material) => (
          <MaterialCard key={material.id} material={material} onEdit={() => setEdited(material)} />
        ))}
      </ul>
      {edited !== null && <MaterialForm material={edited === 'new' ? null : edited} onClose={() => setEdited(null)} />}
    </div>
  );
}
