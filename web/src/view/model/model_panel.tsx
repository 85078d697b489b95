// The woven surface in 3D, with its switches. Strips pointed at here light up on their sheets too.

import { useEffect, useRef, useState } from 'preact/hooks';

import { t } from '../../messages/messages.ts';
import { chooseStrip, chosenStrip, hasSolidModel, type JobPackage, loadSolidModel, pointedStrip } from '../../state/package_store.ts';
import { Panel, Segmented } from '../controls.tsx';
import { StripPicker } from '../strip_picker.tsx';
import { ZoomButtons } from '../zoom_buttons.tsx';
import type { Palette, ViewMode } from './model.ts';
import type { ModelScene } from './scene.ts';

const kModes: readonly ViewMode[] = ['woven', 'solid', 'weft', 'warp', 'surface'];
const kTurn = Math.PI / 24;
const kClickSlack = 5; // Pixels: a press that moves less is a click.

function palette(element: Element): Palette {
  const style = getComputedStyle(element);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  return {
    weft: colour('--weft'),
    warp: colour('--warp'),
    surface: colour('--model-surface'),
    line: colour('--model-line'),
    mark: colour('--mark'),
    critical: colour('--critical'),
  };
}

function turnByKey(scene: ModelScene, event: KeyboardEvent): void {
  const acts: Readonly<Record<string, () => void>> = {
    ArrowLeft: () => scene.turn(-kTurn, 0),
    ArrowRight: () => scene.turn(kTurn, 0),
    ArrowUp: () => scene.turn(0, kTurn),
    ArrowDown: () => scene.turn(0, -kTurn),
    '+': () => scene.zoom(1.2),
    '=': () => scene.zoom(1.2),
    '-': () => scene.zoom(1 / 1.2),
    Home: () => scene.reset(),
  };
  const act = acts[event.key];
  if (act === undefined || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  act();
}

type SceneState = ModelScene | 'loading' | 'none';

// Fetches the model with real thickness once it is looked at. Says whether it is on its way or failed.
function useSolid(scene: SceneState, wanted: boolean, job: string): 'idle' | 'loading' | 'none' {
  const [state, setState] = useState<'idle' | 'loading' | 'none'>('idle');
  const fetched = useRef<ModelScene | null>(null);
  useEffect(() => {
    if (!wanted || typeof scene === 'string' || fetched.current === scene) return;
    fetched.current = scene;
    setState('loading');
    loadSolidModel(job).then(
      (model) => {
        if (fetched.current === scene) scene.addSolid(model);
        setState('idle');
      },
      (fault: unknown) => {
        console.warn('no woven model', fault);
        setState('none');
      },
    );
  }, [scene, wanted, job]);
  return state;
}

// The scene on `canvas`, once three.js has come; follows the colour scheme.
function useScene(content: JobPackage): [(canvas: HTMLCanvasElement | null) => void, SceneState] {
  const canvas = useRef<HTMLCanvasElement | null>(null);
  const [state, setState] = useState<SceneState>('loading');
  useEffect(() => {
    let scene: ModelScene | null = null;
    let gone = false;
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const repaint = (): void => {
      if (canvas.current !== null) scene?.paint(palette(canvas.current));
    };
    setState('loading');
    import('./scene.ts')
      .then(({ createModelScene }) => {
        if (gone || canvas.current === null) return;
        scene = createModelScene(canvas.current, content);
        repaint();
        setState(scene);
      })
      .catch((fault: unknown) => {
        console.warn('no 3D', fault);
        setState('none');
      });
    dark.addEventListener('change', repaint);
    return () => {
      gone = true;
      dark.removeEventListener('change', repaint);
      scene?.dispose();
    };
  }, [content]);
  return [(element) => (canvas.current = element), state];
}

function usePointing(scene: SceneState) {
  const pressed = useRef<{ x: number; y: number } | null>(null);
  const frame = useRef(0);
  const live = typeof scene === 'string' ? null : scene;
  return {
    onPointerDown: (event: PointerEvent) => (pressed.current = { x: event.clientX, y: event.clientY }),
    onPointerMove: (event: PointerEvent) => {
      if (live === null || event.buttons !== 0 || event.pointerType === 'touch') return;
      cancelAnimationFrame(frame.current);
      frame.current = requestAnimationFrame(() => (pointedStrip.value = live.stripAt(event.clientX, event.clientY)));
    },
    onPointerLeave: () => {
      cancelAnimationFrame(frame.current);
      pointedStrip.value = null;
    },
    onPointerUp: (event: PointerEvent) => {
      const from = pressed.current;
      pressed.current = null;
      if (live === null || from === null) return;
      if (Math.hypot(event.clientX - from.x, event.clientY - from.y) > kClickSlack) return;
      const strip = live.stripAt(event.clientX, event.clientY);
      chooseStrip(strip === chosenStrip.value ? null : strip);
    },
  };
}

export function ModelPanel(props: { readonly name: string; readonly content: JobPackage }) {
  const [mode, setMode] = useState<ViewMode>('woven');
  const [setCanvas, scene] = useScene(props.content);
  const pointing = usePointing(scene);
  const solid = useSolid(scene, mode === 'solid', props.content.job);
  const pointed = pointedStrip.value;
  const chosen = chosenStrip.value;
  useEffect(() => {
    if (typeof scene === 'string') return;
    scene.show(mode);
    scene.mark(pointed, chosen);
  }, [scene, mode, pointed, chosen]);
  const live = typeof scene === 'string' ? null : scene;
  const modes = kModes.filter((value) => value !== 'solid' || hasSolidModel(props.content));
  const choices = modes.map((value) => ({ value, label: t.model.modes[value], class: `mode-${value}` }));
  return (
    <Panel
      title={t.model.title}
      class="model"
      aside={<Segmented label={t.model.modesLabel} choices={choices} value={mode} onChange={setMode} />}
    >
      <div class="view">
        <canvas
          ref={setCanvas}
          role="img"
          tabIndex={0}
          aria-label={t.model.label(props.name)}
          data-ready={live !== null}
          onKeyDown={(event) => live !== null && turnByKey(live, event)}
          {...pointing}
        />
        {scene === 'loading' && <p class="view-note">{t.model.loading}</p>}
        {solid === 'loading' && <p class="view-note">{t.model.loading}</p>}
        {solid === 'none' && mode === 'solid' && <p class="view-note">{t.model.noSolid}</p>}
        {scene === 'none' && <p class="view-note">{t.model.none}</p>}
      </div>
      <div class="view-foot">
        <StripPicker index={props.content.index} />
        <ZoomButtons
          fitLabel={t.model.reset}
          onZoom={(factor) => live?.zoom(factor)}
          onFit={() => live?.reset()}
        />
      </div>
    </Panel>
  );
}
