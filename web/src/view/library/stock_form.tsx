// Adds sheets and remnants to the stock, or changes one.

import { useState } from 'preact/hooks';

import { putStock, type StockItem } from '../../api/workshop.ts';
import { t } from '../../messages/messages.ts';
import { type Outline, outlineFault, rectangle } from '../../state/outline.ts';
import { attempt, materials } from '../../state/store.ts';
import { Segmented } from '../controls.tsx';
import { Dialog, DialogButtons } from '../dialog.tsx';
import { idFor, numberOf, SelectField, TextField } from '../fields.tsx';
import { OutlineEditor } from './outline_editor.tsx';

const kLargest = 100_000; // mm.

function sizeIn(typed: string): number | null {
  const value = numberOf(typed);
  return value !== null && value > 0 && value <= kLargest ? value : null;
}

function useStockDraft(item: StockItem | null) {
  const [material, setMaterial] = useState(item === null ? (materials.value[0]?.id ?? '') : item.material);
  const [width, setWidth] = useState(String(item?.widthMm ?? 600));
  const [height, setHeight] = useState(String(item?.heightMm ?? 400));
  const [quantity, setQuantity] = useState(item?.quantity === null ? '' : String(item?.quantity ?? 1));
  const [drawn, setDrawn] = useState<Outline | null>(item === null || item.outline.length === 0 ? null : item.outline);
  const [w, h, q] = [sizeIn(width), sizeIn(height), numberOf(quantity)];
  const endless = quantity.trim() === '';
  const countIsGood = endless || (q !== null && Number.isInteger(q) && q > 0);
  const fault = drawn === null ? null : outlineFault(drawn);
  return {
    material, setMaterial, width, setWidth, height, setHeight, quantity, setQuantity, drawn, setDrawn, w, h, countIsGood, fault,
    count: endless ? null : q,
    can: w !== null && h !== null && countIsGood && fault === null,
  };
}

export function StockForm(props: {
  readonly item: StockItem | null; // Null: a new one.
  readonly taken: readonly string[];
  readonly onClose: () => void;
  readonly onDone: () => void;
}) {
  const { item, taken, onClose, onDone } = props;
  const now = useStockDraft(item);
  const [busy, setBusy] = useState(false);
  const words = t.stock.outline;
  const save = async (): Promise<void> => {
    if (now.w === null || now.h === null) return;
    const wish = { material: now.material, widthMm: now.w, heightMm: now.h, outline: now.drawn, quantity: now.count, kept: item?.kept ?? {} };
    setBusy(true);
    const done = await attempt(() => putStock(item?.id ?? idFor(`${now.material}-${now.width}x${now.height}`, taken), wish));
    setBusy(false);
    if (!done) return;
    onDone();
    onClose();
  };
  return (
    <Dialog title={item === null ? t.stock.add : t.stock.change} onClose={onClose}>
      <form
        class="dialog-form"
        onSubmit={(event) => {
          event.preventDefault();
          if (now.can) void save();
        }}
      >
        <SelectField
          label={t.stock.material}
          value={now.material}
          choices={[{ value: '', label: t.stock.any }, ...materials.value.map((one) => ({ value: one.id, label: one.name }))]}
          onChange={now.setMaterial}
        />
        <div class="measures">
          <TextField label={t.materials.fields.width} value={now.width} onInput={now.setWidth} unit="mm" decimal bad={now.w === null} />
          <TextField label={t.materials.fields.height} value={now.height} onInput={now.setHeight} unit="mm" decimal bad={now.h === null} />
          <TextField label={t.stock.quantity} value={now.quantity} onInput={now.setQuantity} placeholder={t.stock.endless} decimal bad={!now.countIsGood} />
        </div>
        <Segmented
          label={words.label}
          choices={[{ value: 'whole', label: words.whole }, { value: 'drawn', label: words.drawn }]}
          value={now.drawn === null ? 'whole' : 'drawn'}
          onChange={(kind) => now.setDrawn(kind === 'whole' ? null : (now.drawn ?? rectangle(now.w ?? 600, now.h ?? 400)))}
        />
        {now.drawn !== null && now.w !== null && now.h !== null && (
          <OutlineEditor outline={now.drawn} sheet={[now.w, now.h]} onChange={now.setDrawn} />
        )}
        <p class="fault" role="alert">
          {now.fault === null ? '' : words.faults[now.fault]}
        </p>
        <DialogButtons busy={busy} can={now.can} label={t.save} onClose={onClose} />
      </form>
    </Dialog>
  );
}
