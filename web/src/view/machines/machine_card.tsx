// One machine: its live state, what may be done with it now, and its STOP.

import { useState } from 'preact/hooks';

import { commandDevice } from '../../api/client.ts';
import type { Device } from '../../api/types.ts';
import { count, figure, millimetres } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { isConnected } from '../../state/feed.ts';
import { formatRoute } from '../../state/route.ts';
import { isAdmin } from '../../state/session.ts';
import { attempt, feed } from '../../state/store.ts';
import { Bar, Chip } from '../controls.tsx';
import { Icon } from '../icons.tsx';
import { stop } from '../stop_button.tsx';
import { Console } from './console.tsx';
import { ControllerSettings } from './controller_settings.tsx';
import { JogPad } from './jog_pad.tsx';
import { MachineForm } from './machine_form.tsx';
import { Overrides } from './overrides.tsx';

const kCommands = ['connect', 'home', 'unlock', 'frame', 'hold', 'resume', 'reset', 'disconnect'] as const;

function Position(props: { readonly device: Device }) {
  const { workPositionMm, machinePositionMm, feedMmPerMin } = props.device.status;
  const position = workPositionMm.length >= 2 ? workPositionMm : machinePositionMm;
  if (position.length < 2) return null;
  return (
    <dl class="position" aria-label={t.machines.position}>
      {['X', 'Y'].map((axis, index) => (
        <div key={axis}>
          <dt>{axis}</dt>
          <dd>{millimetres(position[index] ?? 0)}</dd>
        </div>
      ))}
      <div>
        <dt>{t.machines.feed}</dt>
        <dd>{count(feedMmPerMin)}</dd>
      </div>
    </dl>
  );
}

// The bed seen from above, with the head on it.
function Bed(props: { readonly device: Device }) {
  const { bedMm, status } = props.device;
  const [width, height] = [bedMm[0] ?? 0, bedMm[1] ?? 0];
  const [x, y] = [status.workPositionMm[0] ?? 0, status.workPositionMm[1] ?? 0];
  if (width <= 0 || height <= 0) return null;
  const inside = (value: number, size: number): number => Math.min(size, Math.max(0, value));
  return (
    <svg class="bed" viewBox={`-6 -6 ${width + 12} ${height + 12}`} aria-hidden="true">
      <rect class="bed-plate" width={width} height={height} rx={8} />
      <path class="bed-grid" d={`M${width / 2} 0V${height}M0 ${height / 2}H${width}`} />
      <g class={status.powerS > 0 ? 'head hot' : 'head'} transform={`translate(${inside(x, width)} ${height - inside(y, height)})`}>
        <path d="M-20 0h40M0 -20v40" />
        <circle r={9} />
      </g>
    </svg>
  );
}

function CurrentCut(props: { readonly device: Device }) {
  const cut = props.device.cut === null ? undefined : feed.value.cuts.get(props.device.cut);
  if (cut === undefined) return null;
  const job = feed.value.jobs.get(cut.job);
  return (
    <div class="machine-cut">
      <a href={formatRoute({ page: 'job', id: cut.job })}>{job?.name ?? cut.job}</a>
      <Bar fraction={cut.progress.fraction} label={t.machines.cutting} kind="ember" />
    </div>
  );
}

function Message(props: { readonly device: Device }) {
  const { alarmCode, message } = props.device.status;
  const alarm = alarmCode === null ? '' : t.machines.alarm(alarmCode);
  if (alarm === '' && message === '') return null;
  return (
    <p class="machine-message" role="alert">
      {alarm} {message}
    </p>
  );
}

function Body(props: { readonly device: Device }) {
  const { device } = props;
  return (
    <>
      <div class="machine-body">
        <div class="machine-where">
          <Bed device={device} />
          <Position device={device} />
        </div>
        {device.actions.includes('jog') && <JogPad device={device} />}
      </div>
      <Overrides device={device} />
    </>
  );
}

function Commands(props: { readonly device: Device }) {
  const { device } = props;
  const can = kCommands.filter((command) => device.actions.includes(command));
  if (can.length === 0) return null;
  return (
    <div class="buttons">
      {can.map((command) => (
        <button key={command} type="button" class="button" onClick={() => void attempt(() => commandDevice(device.id, command))}>
          {t.machines.commands[command]}
        </button>
      ))}
    </div>
  );
}

export function MachineCard(props: { readonly device: Device }) {
  const { device } = props;
  const { status } = device;
  const [open, setOpen] = useState(false);
  const about = [device.uri, status.firmware, device.bedMm.length >= 2 ? `${device.bedMm.map((v) => figure(v, 5)).join(' × ')} mm` : ''];
  return (
    <li class={`panel machine machine-${status.state}`}>
      <header class="panel-head">
        <h2>{device.name}</h2>
        <span class="machine-head">
          {isConnected(device) && (
            <button type="button" class="button small stop-one" aria-label={`${t.stop.button}: ${device.name}`} onClick={() => void stop(device)}>
              {t.stop.button}
            </button>
          )}
          <Chip kind={`device-${status.state}`}>{t.machines.states[status.state] ?? status.state}</Chip>
          {isAdmin.value && (
            <button type="button" class="plain" aria-label={t.machines.settingsOf(device.name)} onClick={() => setOpen(true)}>
              <Icon name="gear" />
            </button>
          )}
        </span>
      </header>
      <Message device={device} />
      {isConnected(device) && <Body device={device} />}
      <CurrentCut device={device} />
      <Commands device={device} />
      {isConnected(device) && <Console device={device} />}
      {isConnected(device) && <ControllerSettings device={device} />}
      <p class="quiet machine-about">{about.filter((word) => word !== '').join(' · ')}</p>
      {open && <MachineForm device={device} onClose={() => setOpen(false)} />}
    </li>
  );
}
