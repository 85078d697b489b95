// A 3D scene on a canvas, once its chunk has come; follows the colour scheme and goes with its component.

import { effect } from '@preact/signals';
import { type Inputs, useEffect, useRef, useState } from 'preact/hooks';

import { scheme } from '../../state/settings.ts';
import { type Palette, palette } from './palette.ts';

interface Scene {
  paint(colours: Palette): void;
  dispose(): void;
}

export type SceneState<T> = T | 'loading' | 'none';

export function useScene<T extends Scene>(
  make: (canvas: HTMLCanvasElement) => Promise<T>,
  inputs: Inputs,
): [(canvas: HTMLCanvasElement | null) => void, SceneState<T>] {
  const canvas = useRef<HTMLCanvasElement | null>(null);
  const [state, setState] = useState<SceneState<T>>('loading');
  useEffect(() => {
    let scene: T | null = null;
    let gone = false;
    const repaint = (): void => {
      if (canvas.current !== null) scene?.paint(palette(canvas.current));
    };
    const stop = effect(() => {
      void scheme.value;
      repaint();
    });
    setState('loading');
    if (canvas.current !== null) {
      make(canvas.current).then(
        (made) => {
          scene = made;
          if (gone) return made.dispose();
          repaint();
          setState(() => made);
        },
        (fault: unknown) => {
          console.warn('no 3D', fault);
          if (!gone) setState('none');
        },
      );
    }
    return () => {
      gone = true;
      stop();
      scene?.dispose();
    };
  }, inputs);
  return [(element) => (canvas.current = element), state];
}

// The scene itself, if it is there.
export function live<T>(state: SceneState<T>): T | null {
  return typeof state === 'string' ? null : (state as T);
}

const kTurn = Math.PI / 24;

export interface Turnable {
  turn(dx: number, dy: number): void; // Radians.
  zoom(factor: number): void;
  reset?(): void;
}

export function turnByKey(scene: Turnable, event: KeyboardEvent): void {
  const acts: Readonly<Record<string, () => void>> = {
    ArrowLeft: () => scene.turn(-kTurn, 0),
    ArrowRight: () => scene.turn(kTurn, 0),
    ArrowUp: () => scene.turn(0, kTurn),
    ArrowDown: () => scene.turn(0, -kTurn),
    '+': () => scene.zoom(1.2),
    '=': () => scene.zoom(1.2),
    '-': () => scene.zoom(1 / 1.2),
    Home: () => scene.reset?.(),
  };
  const act = acts[event.key];
  if (act === undefined || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  event.stopPropagation();
  act();
}
