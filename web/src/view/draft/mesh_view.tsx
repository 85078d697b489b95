// The mesh of a draft in 3D, and the places picked on it.

import { useEffect, useMemo, useRef } from 'preact/hooks';

import type { Welded } from '../../mesh/look.ts';
import { t } from '../../messages/messages.ts';
import { holesIn, loopsIn, numbersIn, picked, type Picks, type PickTool } from '../../state/picks.ts';
import type { Marks } from '../model/pick_scene.ts';
import { live, turnByKey, useScene } from '../model/use_scene.ts';
import { ZoomButtons } from '../zoom_buttons.tsx';

const kClickSlack = 5;

function marksOf(picks: Picks, tools: readonly PickTool[]): Marks {
  const on = (tool: PickTool): string => (tools.includes(tool) ? picks[tool] : '');
  return {
    vertices: [
      ...(['corners', 'poles', 'places'] as const).flatMap((tool) => numbersIn(on(tool)) ?? []),
      ...(holesIn(on('holes')) ?? []).map((hole) => hole.vertex),
    ],
    paths: loopsIn(on('loops')) ?? on('loops').split(';').map((part) => numbersIn(part) ?? []),
    loops: (['sources', 'sinks'] as const).flatMap((tool) => numbersIn(on(tool)) ?? []),
  };
}

export function MeshView(props: {
  readonly name: string;
  readonly mesh: Welded;
  readonly picks: Picks;
  readonly tools: readonly PickTool[];
  readonly tool: PickTool | null;
  readonly radiusMm: number;
  readonly cylinders: Uint32Array | null; // Of each triangle, where their weights may be picked.
  readonly edge: number | null; // The cylinder that was picked.
  readonly onPick: (tool: PickTool, typed: string) => void;
  readonly onEdge: (edge: number) => void;
}) {
  const { name, mesh, picks, tools, tool, radiusMm, cylinders, edge, onPick, onEdge } = props;
  const [setCanvas, state] = useScene(
    async (canvas) => (await import('../model/pick_scene.ts')).createPickScene(canvas, mesh),
    [mesh],
  );
  const scene = live(state);
  const marks = useMemo(() => marksOf(picks, tools), [picks, tools]);
  useEffect(() => scene?.mark(marks), [scene, marks]);
  const tints = tool === 'weights' ? cylinders : null;
  useEffect(() => scene?.tint(tints, edge), [scene, tints, edge]);
  const pressed = useRef<{ x: number; y: number } | null>(null);
  const release = (event: PointerEvent): void => {
    const from = pressed.current;
    pressed.current = null;
    if (scene === null || tool === null || from === null) return;
    if (Math.hypot(event.clientX - from.x, event.clientY - from.y) > kClickSlack) return;
    const hit = scene.at(event.clientX, event.clientY);
    if (hit === null) return;
    if (tool === 'weights') onEdge(cylinders?.[hit.triangle] ?? 0);
    else onPick(tool, picked(tool, picks[tool], { ...hit, radiusMm }));
  };
  return (
    <div class="view mesh-view">
      <canvas
        ref={setCanvas}
        role="img"
        tabIndex={0}
        class={tool === null ? '' : 'picking'}
        aria-label={t.model.label(name)}
        data-ready={scene !== null}
        onKeyDown={(event) => scene !== null && turnByKey(scene, event)}
        onPointerDown={(event) => (pressed.current = { x: event.clientX, y: event.clientY })}
        onPointerUp={release}
      />
      {state === 'loading' && <p class="view-note">{t.model.loading}</p>}
      {state === 'none' && <p class="view-note">{t.model.none}</p>}
      <span class="mesh-zoom">
        <ZoomButtons fitLabel={t.model.reset} onZoom={(factor) => scene?.zoom(factor)} onFit={() => scene?.reset()} />
      </span>
    </div>
  );
}
