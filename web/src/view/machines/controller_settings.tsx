// What the machine's controller keeps of itself, and changing it one value at a time.

import { useState } from 'preact/hooks';

import { commandDevice } from '../../api/client.ts';
import type { Device } from '../../api/types.ts';
import { listSettings, type MachineSetting } from '../../api/workshop.ts';
import { t } from '../../messages/messages.ts';
import { attempt } from '../../state/store.ts';
import { numberOf } from '../fields.tsx';
import { useCall } from '../use_call.ts';

function SettingRow(props: { readonly device: Device; readonly setting: MachineSetting; readonly onChanged: () => void }) {
  const { device, setting, onChanged } = props;
  const [typed, setTyped] = useState(String(setting.value));
  const value = numberOf(typed);
  const changed = value !== null && value !== setting.value;
  const save = async (): Promise<void> => {
    if (await attempt(() => commandDevice(device.id, 'setting', { key: setting.key, value }))) onChanged();
  };
  return (
    <tr>
      <th scope="row">
        <code>{setting.key}</code> {setting.name}
      </th>
      <td>
        <input
          type="text"
          inputMode="decimal"
          aria-label={`${setting.key} ${setting.name}`}
          aria-invalid={value === null}
          value={typed}
          disabled={!device.actions.includes('setting')}
          onInput={(event) => setTyped(event.currentTarget.value)}
        />
      </td>
      <td>
        <button type="button" class="button small" disabled={!changed} onClick={() => void save()}>
          {t.save}
        </button>
      </td>
    </tr>
  );
}

function SettingTable(props: { readonly device: Device }) {
  const { device } = props;
  const [called, load] = useCall(() => listSettings(device.id));
  if (called.state === 'loading') return <p class="quiet">{t.jobs.loading}</p>;
  if (called.state === 'failed') return <p class="quiet">{called.fault}</p>;
  if (called.value.length === 0) return <p class="quiet">{t.machines.noController}</p>;
  return (
    <div class="table-box" tabIndex={0} role="group" aria-label={t.machines.controller}>
      <table class="laser-table">
        <tbody>
          {called.value.map((setting) => (
            <SettingRow key={`${setting.key}=${setting.value}`} device={device} setting={setting} onChanged={() => void load()} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

// Asked for only once it is opened.
export function ControllerSettings(props: { readonly device: Device }) {
  const [open, setOpen] = useState(false);
  return (
    <details class="console" onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>{t.machines.controller}</summary>
      {open && <SettingTable device={props.device} />}
    </details>
  );
}
