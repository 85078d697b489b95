// Places on the surface: picked on the 3D model, or typed.

import { useMemo, useState } from 'preact/hooks';

import { t } from '../../messages/messages.ts';
import { cylinderOfTriangles } from '../../state/cylinders.ts';
import type { Draft } from '../../state/draft.ts';
import { pickFault, type PickTool, toolsFor } from '../../state/picks.ts';
import type { Looked } from '../../state/mesh_looks.ts';
import type { WovenBefore } from '../../state/woven_before.ts';
import { numberOf, TextField } from '../fields.tsx';
import { MeshView } from './mesh_view.tsx';
import { WeightsPanel } from './weights_panel.tsx';

function ToolRow(props: {
  readonly tool: PickTool;
  readonly typed: string;
  readonly bad: boolean;
  readonly on: boolean;
  readonly canPick: boolean;
  readonly onTyped: (typed: string) => void;
  readonly onTool: () => void;
}) {
  const { tool, typed, bad, on, canPick } = props;
  const words = t.picks.tools[tool];
  return (
    <div class="pick-tool">
      <TextField label={words.name} value={typed} bad={bad} placeholder={words.hint} onInput={props.onTyped} />
      {canPick && (
        <button type="button" class="button small" aria-pressed={on} onClick={props.onTool}>
          {on ? t.picks.picking : t.picks.pick}
        </button>
      )}
    </div>
  );
}

type Values = Partial<Pick<Draft, 'picks' | 'mode' | 'pants' | 'sweep'>>;

export function PicksPanel(props: {
  readonly draft: Draft;
  readonly name: string;
  readonly looked: Looked | undefined;
  readonly before: WovenBefore | null; // How the mesh was woven, if it was.
  readonly onChange: (values: Values) => void;
}) {
  const { draft, name, looked, before, onChange } = props;
  const [tool, setTool] = useState<PickTool | null>(null);
  const [radius, setRadius] = useState('5');
  const [edge, setEdge] = useState<number | null>(null);
  const tools = toolsFor(draft.mode, draft.pants);
  const active = tool !== null && tools.includes(tool) ? tool : null;
  const set = (of: PickTool, typed: string): void => onChange({ picks: { ...draft.picks, [of]: typed } });
  const seen = looked?.state === 'seen' ? looked : null;
  const cylinders = useMemo(
    () => (seen === null || before === null ? null : cylinderOfTriangles(seen.welded, before.quads, before.cylinders)),
    [seen?.welded, before],
  );
  // Weights belong to the cylinders they were picked on: to that decomposition and no other.
  const weigh = (typed: string): void => {
    const { pants = draft.pants, sweep = draft.sweep } = before?.cylinders ?? {};
    onChange({ picks: { ...draft.picks, weights: typed }, mode: 'pants', pants, sweep });
  };
  const fault = pickFault(draft.picks, draft.mode, draft.pants);
  const lead = seen === null ? t.picks.typeOnly : active === null ? t.picks.lead : active === 'weights' ? t.picks.weigh : t.picks.tools[active].hint;
  return (
    <div class={seen === null ? 'picks' : 'picks with-view'}>
      {seen !== null && (
        <MeshView
          name={name}
          mesh={seen.welded}
          picks={draft.picks}
          tools={tools}
          tool={active}
          radiusMm={numberOf(radius) ?? 5}
          cylinders={cylinders}
          edge={edge}
          onPick={set}
          onEdge={setEdge}
        />
      )}
      <div class="pick-tools">
        <p class="quiet">{lead}</p>
        {tools.map((one) => (
          <ToolRow
            key={one}
            tool={one}
            typed={draft.picks[one]}
            bad={fault === one}
            on={active === one}
            canPick={seen !== null && (one !== 'weights' || cylinders !== null)}
            onTyped={(typed) => set(one, typed)}
            onTool={() => setTool(active === one ? null : one)}
          />
        ))}
        {active === 'holes' && <TextField label={t.picks.radius} value={radius} unit="mm" decimal onInput={setRadius} bad={numberOf(radius) === null} />}
        {active === 'weights' && before !== null && (
          <WeightsPanel woven={before.cylinders} typed={draft.picks.weights} edge={edge} onEdge={setEdge} onTyped={weigh} />
        )}
      </div>
    </div>
  );
}
