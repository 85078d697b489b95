// What the strips are cut from, and on which machine.

import { useEffect, useState } from 'preact/hooks';

import { listStock } from '../../api/workshop.ts';
import { figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { type Draft, kSheetSources, type SheetSource } from '../../state/draft.ts';
import { dialectOf, fitsBed, newSheet } from '../../state/machine_choice.ts';
import { feed, materials } from '../../state/store.ts';
import { SelectField } from '../fields.tsx';

type Values = Partial<Pick<Draft, 'sheets' | 'machine' | 'more'>>;

function useStockCount(): number {
  const [count, setCount] = useState(0);
  useEffect(() => {
    listStock().then((items) => setCount(items.length), () => undefined);
  }, []);
  return count;
}

export function SheetFields(props: { readonly draft: Draft; readonly onChange: (values: Values) => void }) {
  const { draft, onChange } = props;
  const stock = useStockCount();
  const devices = [...feed.value.devices.values()];
  const chosen = devices.find((one) => one.id === draft.machine);
  const used = (['weft', 'warp'] as const).map((family) => materials.value.find((one) => one.id === draft[family]));
  const { widthMm, heightMm } = newSheet(used[0]);
  const words: Readonly<Record<SheetSource, string>> = {
    new: t.draft.sheetNames.new(t.sheets.size(figure(widthMm, 4), figure(heightMm, 4))),
    stock: t.draft.sheetNames.stock,
    only: t.draft.sheetNames.only,
  };
  // Without anything at hand there is nothing to choose.
  const sources = kSheetSources.filter((one) => one === 'new' || stock > 0 || one === draft.sheets);
  const takeMachine = (id: string): void => {
    const device = devices.find((one) => one.id === id);
    const more = device === undefined ? draft.more : { ...draft.more, 'output.dialect': dialectOf(device) };
    onChange({ machine: id, more });
  };
  return (
    <>
      <SelectField
        label={t.draft.sheets}
        value={draft.sheets}
        choices={sources.map((value) => ({ value, label: words[value] }))}
        onChange={(sheets) => onChange({ sheets })}
      />
      <SelectField
        label={t.cut.machine}
        value={draft.machine}
        choices={[{ value: '', label: t.draft.anyMachine }, ...devices.map(({ id, name }) => ({ value: id, label: name }))]}
        onChange={takeMachine}
      />
      {chosen !== undefined && draft.sheets !== 'only' && used.some((material) => !fitsBed(chosen, material)) && (
        <p class="mesh-warn bed-warn">{t.draft.bedTooSmall(chosen.name, chosen.bedMm.slice(0, 2).map((side) => figure(side, 4)).join(' × '))}</p>
      )}
    </>
  );
}
