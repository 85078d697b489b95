// Places on the surface: picked on the 3D model, or typed.

import { useState } from 'preact/hooks';

import { t } from '../../messages/messages.ts';
import type { Draft } from '../../state/draft.ts';
import { pickFault, type PickTool, toolsFor } from '../../state/picks.ts';
import type { Looked } from '../../state/mesh_looks.ts';
import { numberOf, TextField } from '../fields.tsx';
import { MeshView } from './mesh_view.tsx';

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
      {canPick && tool !== 'weights' && (
        <button type="button" class="button small" aria-pressed={on} onClick={props.onTool}>
          {on ? t.picks.picking : t.picks.pick}
        </button>
      )}
    </div>
  );
}

export function PicksPanel(props: {
  readonly draft: Draft;
  readonly looked: Looked | undefined;
  readonly onChange: (values: Partial<Pick<Draft, 'picks'>>) => void;
}) {
  const { draft, looked, onChange } = props;
  const [tool, setTool] = useState<PickTool | null>(null);
  const [radius, setRadius] = useState('5');
  const tools = toolsFor(draft.mode, draft.pants);
  const active = tool !== null && tools.includes(tool) ? tool : null;
  const set = (of: PickTool, typed: string): void => onChange({ picks: { ...draft.picks, [of]: typed } });
  const seen = looked?.state === 'seen' ? looked : null;
  const fault = pickFault(draft.picks, draft.mode, draft.pants);
  return (
    <div class={seen === null ? 'picks' : 'picks with-view'}>
      {seen !== null && (
        <MeshView
          name={draft.files[0]?.name ?? ''}
          mesh={seen.welded}
          picks={draft.picks}
          tools={tools}
          tool={active}
          radiusMm={numberOf(radius) ?? 5}
          onPick={set}
        />
      )}
      <div class="pick-tools">
        <p class="quiet">{seen === null ? t.picks.typeOnly : active === null ? t.picks.lead : t.picks.tools[active].hint}</p>
        {tools.map((one) => (
          <ToolRow
            key={one}
            tool={one}
            typed={draft.picks[one]}
            bad={fault === one}
            on={active === one}
            canPick={seen !== null}
            onTyped={(typed) => set(one, typed)}
            onTool={() => setTool(active === one ? null : one)}
          />
        ))}
        {active === 'holes' && <TextField label={t.picks.radius} value={radius} unit="mm" decimal onInput={setRadius} bad={numberOf(radius) === null} />}
      </div>
    </div>
  );
}
