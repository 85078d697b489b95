// Sheets and remnants at hand, drawn to one scale.

import { useEffect, useState } from 'preact/hooks';

import { listStock, removeStock, type StockItem } from '../../api/workshop.ts';
import { count, figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { rectangle } from '../../state/outline.ts';
import { formatRoute } from '../../state/route.ts';
import { pathData } from '../../state/sheets.ts';
import { attempt, feed, loadMaterials, materialName, materials } from '../../state/store.ts';
import { AskButton } from '../controls.tsx';
import { Icon } from '../icons.tsx';
import { PageTabs } from '../tabs.tsx';
import { useCall } from '../use_call.ts';
import { StockForm } from './stock_form.tsx';

export function StockPicture(props: { readonly item: StockItem; readonly scaleMm: number }) {
  const { item, scaleMm } = props;
  const outline = item.outline.length > 0 ? item.outline : rectangle(item.widthMm, item.heightMm);
  const low = (axis: 0 | 1): number => Math.min(...outline.map((at) => at[axis]));
  const rings = [outline, ...item.holes].map((ring) => `${pathData(ring)}Z`).join('');
  const colour = materials.value.find((one) => one.id === item.material)?.colour ?? '#bbbbbb';
  return (
    <svg class="stock-picture" viewBox={`0 0 ${scaleMm} ${item.heightMm + 4}`} aria-hidden="true">
      <g transform={`translate(${(scaleMm - item.widthMm) / 2 - low(0)} ${item.heightMm + 2 + low(1)}) scale(1 -1)`}>
        <path d={rings} fill={colour} fill-rule="evenodd" />
      </g>
    </svg>
  );
}

function StockCard(props: { readonly item: StockItem; readonly scaleMm: number; readonly onChange: () => void; readonly onEdit: () => void }) {
  const { item, scaleMm, onChange, onEdit } = props;
  const job = feed.value.jobs.get(item.fromJob);
  const many = item.quantity === null ? t.stock.endless : t.stock.pieces(item.quantity);
  const remove = (): void => {
    void attempt(async () => {
      await removeStock(item.id);
      onChange();
    });
  };
  return (
    <li class="panel stock-card">
      <StockPicture item={item} scaleMm={scaleMm} />
      <h2>{item.material === '' ? t.stock.any : materialName(item.material)}</h2>
      <p class="quiet">
        {t.sheets.size(figure(item.widthMm, 4), figure(item.heightMm, 4))} · {item.outline.length > 0 ? t.stock.remnant : many}
        {item.planned > 0 && ` · ${t.stock.planned(count(item.planned))}`}
      </p>
      {item.note !== '' && <p>{item.note}</p>}
      <div class="buttons">
        {item.fromJob !== '' && (
          <a class="button small" href={formatRoute({ page: 'job', id: item.fromJob })}>
            {job?.name ?? item.fromJob}
          </a>
        )}
        <button type="button" class="button small" onClick={onEdit}>
          {t.edit}
        </button>
        <AskButton class="button small" label={t.remove} question={t.job.reallyRemove} onConfirm={remove} />
      </div>
    </li>
  );
}

export function StockPage() {
  const [called, load] = useCall(listStock);
  const [form, setForm] = useState<'new' | StockItem | null>(null);
  useEffect(() => void loadMaterials().catch(() => undefined), []);
  const items = called.state === 'there' ? called.value : [];
  const scaleMm = Math.max(100, ...items.map((item) => item.widthMm)) + 4;
  return (
    <div class="page">
      <PageTabs label={t.nav.materials} pages={['materials', 'stock']} />
      <header class="page-head">
        <h1>{t.tabs.stock}</h1>
        {called.state === 'there' && (
          <button type="button" class="button" onClick={() => setForm('new')}>
            <Icon name="plus" />
            {t.stock.add}
          </button>
        )}
      </header>
      {called.state === 'failed' && <p class="quiet empty">{called.fault}</p>}
      {called.state === 'loading' && <p class="quiet empty">{t.jobs.loading}</p>}
      {called.state === 'there' && items.length === 0 && <p class="quiet empty">{t.stock.none}</p>}
      <ul class="stock-list">
        {items.map((item) => (
          <StockCard key={item.id} item={item} scaleMm={scaleMm} onChange={() => void load()} onEdit={() => setForm(item)} />
        ))}
      </ul>
      {form !== null && (
        <StockForm
          item={form === 'new' ? null : form}
          taken={items.map((item) => item.id)}
          onClose={() => setForm(null)}
          onDone={() => void load()}
        />
      )}
    </div>
  );
}
