// The woven surface in 3D, with its switches. Strips pointed at here light up on their sheets too.

import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';

import { figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { cylinderColour, type HeatMap, type HeatName, kHeatMaps } from '../../state/heat.ts';
import { chooseStrip, chosenStrip, hasSolidModel, type JobPackage, pointedStrip } from '../../state/package_store.ts';
import { Panel } from '../controls.tsx';
import { StripPicker } from '../strip_picker.tsx';
import { ZoomButtons } from '../zoom_buttons.tsx';
import type { ViewMode } from './model.ts';
import type { ModelScene } from './scene.ts';
import { type ExtraState, useHeat, useInput, useSolid } from './use_extras.ts';
import { live, type SceneState, turnByKey, useScene } from './use_scene.ts';

const kModes: readonly ViewMode[] = ['woven', 'solid', 'weft', 'warp', 'quads', 'cylinders', 'surface', 'leaves', 'heat'];
const kClickSlack = 5; // Pixels: a press that moves less is a click.

// Which heat map the report's table asked for last.
export const shownHeat = signal<HeatName | null>(null);

function usePointing(scene: ModelScene | null) {
  const pressed = useRef<{ x: number; y: number } | null>(null);
  const frame = useRef(0);
  return {
    onPointerDown: (event: PointerEvent) => (pressed.current = { x: event.clientX, y: event.clientY }),
    onPointerMove: (event: PointerEvent) => {
      if (scene === null || event.buttons !== 0 || event.pointerType === 'touch') return;
      cancelAnimationFrame(frame.current);
      frame.current = requestAnimationFrame(() => (pointedStrip.value = scene.stripAt(event.clientX, event.clientY)));
    },
    onPointerLeave: () => {
      cancelAnimationFrame(frame.current);
      pointedStrip.value = null;
    },
    onPointerUp: (event: PointerEvent) => {
      const from = pressed.current;
      pressed.current = null;
      if (scene === null || from === null) return;
      if (Math.hypot(event.clientX - from.x, event.clientY - from.y) > kClickSlack) return;
      const strip = scene.stripAt(event.clientX, event.clientY);
      chooseStrip(strip === chosenStrip.value ? null : strip);
    },
  };
}

function HeatLegend(props: { readonly map: HeatMap | null; readonly name: HeatName; readonly onChange: (name: HeatName) => void }) {
  const { map, name } = props;
  const unit = name === 'angle' ? '°' : ' %';
  return (
    <div class="heat-legend">
      <select
        aria-label={t.model.heat}
        value={name}
        onChange={(event) => {
          const chosen = kHeatMaps.find((one) => one === event.currentTarget.value);
          if (chosen !== undefined) props.onChange(chosen);
        }}
      >
        {kHeatMaps.map((one) => (
          <option key={one} value={one}>
            {t.model.heatNames[one]}
          </option>
        ))}
      </select>
      {map !== null && map.name === name && (
        <p class="heat-scale">
          <span>0</span>
          <span class="heat-bar" aria-hidden="true" />
          <span>
            {map.largest > map.top ? '≥ ' : ''}
            {figure(map.top, 2)}
            {unit}
          </span>
        </p>
      )}
    </div>
  );
}

function CylinderLegend(props: { readonly content: JobPackage }) {
  const { cylinders } = props.content.mesh;
  const numbers = [...new Set(cylinders)].sort((a, b) => a - b);
  return (
    <ul class="cylinder-legend" aria-label={t.foliation.cylinders}>
      {numbers.slice(0, 12).map((number) => (
        <li key={number}>
          <svg viewBox="0 0 10 10" aria-hidden="true">
            <rect width="10" height="10" rx="2" fill={cylinderColour(number)} />
          </svg>
          {number + 1}
        </li>
      ))}
      {numbers.length > 12 && <li>+{numbers.length - 12}</li>}
    </ul>
  );
}

function Note(props: { readonly scene: SceneState<ModelScene>; readonly extras: readonly ExtraState[] }) {
  const { scene, extras } = props;
  if (scene === 'none') return <p class="view-note">{t.model.none}</p>;
  if (scene === 'loading' || extras.includes('loading')) return <p class="view-note">{t.model.loading}</p>;
  return extras.includes('none') ? <p class="view-note">{t.model.noSolid}</p> : null;
}

function ModeSelect(props: { readonly content: JobPackage; readonly mode: ViewMode; readonly onChange: (mode: ViewMode) => void }) {
  const { mode, content } = props;
  const modes = kModes.filter((value) => value !== 'solid' || hasSolidModel(content));
  return (
    <div class="segmented wraps" role="group" aria-label={t.model.modesLabel}>
      {modes.map((value) => (
        <button
          key={value}
          type="button"
          class={`mode-${value}`}
          aria-pressed={value === mode}
          onClick={() => props.onChange(value)}
        >
          {t.model.modes[value]}
        </button>
      ))}
    </div>
  );
}

export function ModelPanel(props: { readonly name: string; readonly content: JobPackage; readonly title?: string }) {
  const { content } = props;
  const [mode, setMode] = useState<ViewMode>('woven');
  const [heat, setHeat] = useState<HeatName>('angle');
  const [setCanvas, state] = useScene(
    async (canvas) => (await import('./scene.ts')).createModelScene(canvas, content),
    [content],
  );
  const scene = live(state);
  const pointing = usePointing(scene);
  const solid = useSolid(scene, mode, content);
  const input = useInput(scene, mode, content);
  const [map, quality] = useHeat(scene, mode, heat, content);
  const extras = [mode === 'solid' ? solid : 'idle', mode === 'surface' || mode === 'leaves' ? input : 'idle', mode === 'heat' ? quality : 'idle'] as const;
  const pointed = pointedStrip.value;
  const chosen = chosenStrip.value;
  const wanted = shownHeat.value;
  useEffect(() => {
    if (wanted === null) return;
    setHeat(wanted);
    setMode('heat');
    shownHeat.value = null;
  }, [wanted]);
  useEffect(() => {
    scene?.show(mode);
    scene?.mark(pointed, chosen);
  }, [scene, mode, pointed, chosen]);
  return (
    <Panel title={props.title ?? t.model.title} class="model" aside={<ModeSelect content={content} mode={mode} onChange={setMode} />}>
      <div class="view">
        <canvas
          ref={setCanvas}
          role="img"
          tabIndex={0}
          aria-label={t.model.label(props.name)}
          data-ready={scene !== null}
          onKeyDown={(event) => scene !== null && turnByKey(scene, event)}
          {...pointing}
        />
        <Note scene={state} extras={extras} />
        {mode === 'heat' && <HeatLegend map={map} name={heat} onChange={setHeat} />}
        {mode === 'cylinders' && <CylinderLegend content={content} />}
      </div>
      <div class="view-foot">
        <StripPicker index={content.index} job={content.job} />
        <ZoomButtons
          fitLabel={t.model.reset}
          onZoom={(factor) => scene?.zoom(factor)}
          onFit={() => scene?.reset()}
        />
      </div>
    </Panel>
  );
}
