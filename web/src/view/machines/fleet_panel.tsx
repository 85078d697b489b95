// The daemons of a fleet: what each has in work, and how to let one rest. Nothing where a daemon works alone.

import { useEffect, useState } from 'preact/hooks';

import { commandNode, type Fleet, type FleetNode, forgetNode, getFleet } from '../../api/fleet.ts';
import { count, duration } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { attempt, feed } from '../../state/store.ts';
import { AskButton, Chip, Panel } from '../controls.tsx';

const kAskEveryMs = 4000; // Nodes send no events of their own.
const kCommands = ['pause', 'drain', 'resume'] as const;

const named = (names: object, key: string): string => (names as Readonly<Record<string, string>>)[key] ?? key;

function nodeWork(node: FleetNode): string {
  const words = t.machines.fleet;
  const machines = node.machines.map((id) => feed.value.devices.get(id)?.name ?? id).join(', ');
  const parts = [
    named(words.roles, node.role),
    machines,
    node.workers > 0 ? words.computing(count(node.computing), count(node.workers)) : '',
    node.cutting > 0 ? words.cutting(count(node.cutting)) : '',
    node.state === 'silent' ? words.silent(duration(node.silentS)) : '',
  ];
  return parts.filter((part) => part !== '').join(' · ');
}

function NodeRow(props: { readonly node: FleetNode; readonly here: boolean; readonly load: () => void }) {
  const { node, here, load } = props;
  const words = t.machines.fleet;
  return (
    <li class="person fleet-node">
      <strong>{node.id}</strong>
      <Chip kind={`node-${node.state}`}>{named(words.states, node.state)}</Chip>
      <span class="quiet">
        {nodeWork(node)}
        {here && ` · ${words.here}`}
      </span>
      <span class="buttons">
        {kCommands
          .filter((command) => node.actions.includes(command))
          .map((command) => (
            <button
              key={command}
              type="button"
              class="button small"
              aria-label={`${words.commands[command]}: ${node.id}`}
              title={words.hints[command]}
              onClick={() => void attempt(() => commandNode(node.id, command)).then(load)}
            >
              {words.commands[command]}
            </button>
          ))}
        {node.actions.includes('forget') && (
          <AskButton
            class="button small"
            label={words.forget}
            question={t.job.reallyRemove}
            onConfirm={() => void attempt(() => forgetNode(node.id)).then(load)}
          />
        )}
      </span>
    </li>
  );
}

export function FleetPanel() {
  const [fleet, setFleet] = useState<Fleet | null>(null);
  const load = (): void => void getFleet().then(setFleet, () => undefined);
  useEffect(() => {
    load();
    const timer = setInterval(load, kAskEveryMs);
    return () => clearInterval(timer);
  }, []);
  if (fleet === null || fleet.alone) return null;
  return (
    <Panel title={t.machines.fleet.title} class="fleet">
      <ul class="people">
        {fleet.nodes.map((node) => (
          <NodeRow key={node.id} node={node} here={node.id === fleet.node} load={load} />
        ))}
      </ul>
    </Panel>
  );
}
