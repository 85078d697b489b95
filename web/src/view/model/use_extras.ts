// What a scene shows only when it is asked for: fetched once, when it is first looked at.

import { useEffect, useRef, useState } from 'preact/hooks';

import { type HeatMap, heatColours, heatMap, type HeatName, type QualityFile } from '../../state/heat.ts';
import { type JobPackage, loadQuality, loadSolidModel, loadSurface } from '../../state/package_store.ts';
import type { ViewMode } from './model.ts';
import type { ModelScene } from './scene.ts';

export type ExtraState = 'idle' | 'loading' | 'none';

// Runs `load` once per scene, when `wanted` first becomes true.
function useOnce(scene: ModelScene | null, wanted: boolean, load: (scene: ModelScene) => Promise<void>): ExtraState {
  const [state, setState] = useState<ExtraState>('idle');
  const done = useRef<ModelScene | null>(null);
  useEffect(() => {
    if (!wanted || scene === null || done.current === scene) return;
    done.current = scene;
    setState('loading');
    load(scene).then(
      () => setState('idle'),
      (fault: unknown) => {
        console.warn('not there to be drawn', fault);
        setState('none');
      },
    );
  }, [scene, wanted]);
  return state;
}

export function useSolid(scene: ModelScene | null, mode: ViewMode, content: JobPackage): ExtraState {
  const load = async (to: ModelScene): Promise<void> => to.addSolid(await loadSolidModel(content.job));
  return useOnce(scene, mode === 'solid', load);
}

export function useInput(scene: ModelScene | null, mode: ViewMode, content: JobPackage): ExtraState {
  const load = async (to: ModelScene): Promise<void> => to.addInput(await loadSurface(content.job));
  return useOnce(scene, mode === 'surface' || mode === 'leaves', load);
}

// The heat map that is shown, once its figures have come.
export function useHeat(
  scene: ModelScene | null,
  mode: ViewMode,
  name: HeatName,
  content: JobPackage,
): readonly [HeatMap | null, ExtraState] {
  const [quality, setQuality] = useState<QualityFile | null>(null);
  const [map, setMap] = useState<HeatMap | null>(null);
  const state = useOnce(scene, mode === 'heat', async () => setQuality(await loadQuality(content.job)));
  useEffect(() => {
    if (scene === null || quality === null || mode !== 'heat') return;
    const made = heatMap(content.mesh, quality, name);
    scene.setHeat(heatColours(made));
    setMap(made);
  }, [scene, quality, name, mode]);
  return [map, state];
}
