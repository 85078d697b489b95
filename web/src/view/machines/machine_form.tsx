// A machine's settings: a new one, or those of one that is there.

import { useEffect, useState } from 'preact/hooks';

import { listPorts, type Port, putDevice, removeDevice } from '../../api/workshop.ts';
import type { Device } from '../../api/types.ts';
import { t } from '../../messages/messages.ts';
import { attempt, feed, refreshDevices } from '../../state/store.ts';
import { AskButton } from '../controls.tsx';
import { Dialog, DialogButtons } from '../dialog.tsx';
import { idFor, numberOf, TextField, Tick } from '../fields.tsx';

const kSimulated: readonly string[] = ['sim:grbl', 'sim:marlin', 'sim:smoothie', 'sim:lihuiyu'];

function PortPicker(props: { readonly value: string; readonly onPick: (uri: string) => void }) {
  const [ports, setPorts] = useState<readonly Port[]>([]);
  const look = (): void => void listPorts().then(setPorts, () => undefined);
  useEffect(look, []);
  const choices = [
    ...ports.map((port) => ({ uri: port.uri, about: port.trouble === '' ? port.description : port.trouble })),
    ...kSimulated.map((uri) => ({ uri, about: t.machines.simulated })),
  ];
  return (
    <fieldset class="ports">
      <legend>{t.machines.found}</legend>
      <ul>
        {choices.map(({ uri, about }) => (
          <li key={uri}>
            <button type="button" class="port" aria-pressed={props.value === uri} onClick={() => props.onPick(uri)}>
              <code>{uri}</code> <span class="quiet">{about}</span>
            </button>
          </li>
        ))}
      </ul>
      <button type="button" class="button small" onClick={look}>
        {t.machines.lookAgain}
      </button>
    </fieldset>
  );
}

export function MachineForm(props: { readonly device: Device | null; readonly onClose: () => void }) {
  const { device, onClose } = props;
  const [name, setName] = useState(device?.name ?? '');
  const [uri, setUri] = useState(device?.uri ?? '');
  const [width, setWidth] = useState(String(device?.bedMm[0] ?? 600));
  const [height, setHeight] = useState(String(device?.bedMm[1] ?? 400));
  const [autoStart, setAutoStart] = useState(device?.autoStart ?? false);
  const [busy, setBusy] = useState(false);
  const [w, h] = [numberOf(width), numberOf(height)];
  const can = name.trim() !== '' && uri.trim() !== '' && w !== null && w > 0 && h !== null && h > 0;
  const run = async (call: () => Promise<void>): Promise<void> => {
    setBusy(true);
    if (await attempt(call)) {
      await refreshDevices();
      onClose();
    }
    setBusy(false);
  };
  const save = (): Promise<void> => {
    const id = device?.id ?? idFor(name, [...feed.value.devices.keys()]);
    return run(() => putDevice(id, { name: name.trim(), uri: uri.trim(), bedMm: [w ?? 0, h ?? 0], autoStart }));
  };
  return (
    <Dialog title={device === null ? t.machines.addTitle : t.machines.settingsOf(device.name)} onClose={onClose}>
      <form
        class="dialog-form"
        onSubmit={(event) => {
          event.preventDefault();
          if (can) void save();
        }}
      >
        <TextField label={t.draft.name} value={name} onInput={setName} required />
        <TextField label={t.machines.address} value={uri} onInput={setUri} required placeholder="grbl:/dev/ttyUSB0?baud=115200" />
        <PortPicker value={uri} onPick={setUri} />
        <div class="measures">
          <TextField label={t.machines.bedWidth} value={width} onInput={setWidth} unit="mm" decimal bad={w === null} />
          <TextField label={t.machines.bedHeight} value={height} onInput={setHeight} unit="mm" decimal bad={h === null} />
        </div>
        <Tick checked={autoStart} onChange={setAutoStart}>
          {t.machines.autoStart}
        </Tick>
        <DialogButtons busy={busy} can={can} label={t.save} onClose={onClose} />
        {device !== null && (
          <AskButton
            class="button danger"
            label={t.machines.forget}
            question={t.job.reallyRemove}
            onConfirm={() => void run(() => removeDevice(device.id))}
          />
        )}
      </form>
    </Dialog>
  );
}
