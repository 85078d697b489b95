// The 3D view: ribbons of both families over the quad mesh, turned with the mouse or the keyboard.
// Loaded on demand, because three.js is most of the page's weight.

import { DoubleSide, Mesh, MeshBasicMaterial, Raycaster, Vector2 } from 'three';

import type { SolidModel } from '../../api/glb.ts';
import type { TriangleMesh } from '../../api/package_files.ts';
import { Model, type ModelContent, type ViewMode } from './model.ts';
import type { Palette } from './palette.ts';
import { Stage } from './stage.ts';

export interface ModelScene {
  show(mode: ViewMode): void;
  addSolid(model: SolidModel): void;
  addInput(surface: TriangleMesh): void;
  setHeat(colours: Float32Array): void; // Per corner of every quad.
  mark(pointed: string | null, chosen: string | null): void;
  stripAt(clientX: number, clientY: number): string | null;
  turn(dx: number, dy: number): void; // Radians.
  zoom(factor: number): void;
  reset(): void;
  paint(palette: Palette): void;
  dispose(): void;
}

// Throws if the browser has no WebGL.
export function createModelScene(canvas: HTMLCanvasElement, content: ModelContent): ModelScene {
  const model = new Model(content);
  const stage = new Stage(canvas, model.bounds, content.mesh.positions);
  stage.scene.add(model.root);
  const target = new Mesh(model.surface, new MeshBasicMaterial({ side: DoubleSide }));
  const raycaster = new Raycaster();

  function stripAt(clientX: number, clientY: number): string | null {
    const box = canvas.getBoundingClientRect();
    const x = ((clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((clientY - box.top) / box.height) * 2;
    raycaster.setFromCamera(new Vector2(x, y), stage.camera);
    const hit = raycaster.intersectObject(target)[0];
    if (hit === undefined || hit.faceIndex === null || hit.faceIndex === undefined || !hit.face) return null;
    return model.stripOf(hit.faceIndex >> 1, hit.face.normal.dot(raycaster.ray.direction) < 0);
  }

  const drawn = <T extends readonly unknown[]>(act: (...values: T) => void) => (...values: T): void => {
    act(...values);
    stage.draw();
  };

  return {
    show: drawn((mode: ViewMode) => model.show(mode)),
    addInput: drawn((surface: TriangleMesh) => model.addInput(surface)),
    setHeat: drawn((colours: Float32Array) => model.setHeat(colours)),
    addSolid: drawn((solid: SolidModel) => model.addSolid(solid)),
    mark: drawn((pointed: string | null, chosen: string | null) => model.mark(pointed, chosen)),
    paint: drawn((palette: Palette) => model.paint(palette)),
    stripAt,
    turn: (dx, dy) =>
      stage.move((around) => {
        around.theta -= dx;
        around.phi -= dy;
      }),
    zoom: (factor) => stage.move((around) => (around.radius /= factor)),
    reset: () => stage.reset(),
    dispose() {
      model.dispose();
      stage.dispose();
    },
  };
}
