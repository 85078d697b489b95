// The machines, each as a card with its live state and what may be done with it now.

import { useState } from 'preact/hooks';

import { t } from '../../messages/messages.ts';
import { isAdmin } from '../../state/session.ts';
import { feed } from '../../state/store.ts';
import { Icon } from '../icons.tsx';
import { FleetPanel } from './fleet_panel.tsx';
import { MachineCard } from './machine_card.tsx';
import { MachineForm } from './machine_form.tsx';

export function MachinesPage() {
  const devices = [...feed.value.devices.values()];
  const [adding, setAdding] = useState(false);
  return (
    <div class="page">
      <header class="page-head">
        <h1>{t.machines.title}</h1>
        {isAdmin.value && (
          <button type="button" class="button" onClick={() => setAdding(true)}>
            <Icon name="plus" />
            {t.machines.add}
          </button>
        )}
      </header>
      {devices.length === 0 ? (
        <p class="quiet empty">{feed.value.known ? t.machines.none : t.jobs.loading}</p>
      ) : (
        <ul class="machines">
          {devices.map((device) => (
            <MachineCard key={device.id} device={device} />
          ))}
        </ul>
      )}
      <FleetPanel />
      {adding && <MachineForm device={null} onClose={() => setAdding(false)} />}
    </div>
  );
}
