// The mesh of a draft, to be turned and picked on: its faces, its boundary loops, and what was picked.
// Loaded on demand, with three.js.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Raycaster,
  Sphere,
  SphereGeometry,
  Vector2,
  Vector3,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

import type { Welded } from '../../mesh/look.ts';
import { cylinderColour } from '../../state/heat.ts';
import type { Palette } from './palette.ts';
import { Stage } from './stage.ts';

export interface Marks {
  readonly vertices: readonly number[]; // By their numbers in the file.
  readonly paths: readonly (readonly number[])[]; // Likewise, of loops: three or more are drawn closed.
  readonly loops: readonly number[]; // Boundary loops that are marked.
}

export interface PickScene {
  at(clientX: number, clientY: number): { readonly vertex: number; readonly loop: number | null; readonly triangle: number } | null;
  mark(marks: Marks): void;
  // Colours the triangles by their cylinder, one of which may stand out; null: all alike.
  tint(ofTriangle: Uint32Array | null, chosen: number | null): void;
  turn(dx: number, dy: number): void;
  zoom(factor: number): void;
  reset(): void;
  paint(palette: Palette): void;
  dispose(): void;
}

const kBallRadius = 0.014; // Of the mesh's radius.
const kFaded = 0.72; // How far cylinders that were not picked go towards the plain surface.

class PickModel {
  readonly geometry = new BufferGeometry();
  readonly bounds: Sphere;
  private readonly place: ReadonlyMap<number, number>; // Of a vertex of the file.

  constructor(readonly mesh: Welded) {
    this.geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    this.geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
    this.bounds = this.geometry.boundingSphere ?? new Sphere();
    this.place = new Map(Array.from(mesh.fileVertex, (vertex, here) => [vertex, here]));
  }

  point(here: number): Vector3 {
    return new Vector3().fromArray(this.mesh.positions, 3 * here);
  }

  pointOf(fileVertex: number): Vector3 | null {
    const here = this.place.get(fileVertex);
    return here === undefined ? null : this.point(here);
  }

  nearestOf(face: number, to: Vector3): number {
    const corners = [0, 1, 2].map((k) => this.mesh.triangles[3 * face + k] ?? 0);
    return corners.reduce((best, one) => (this.point(one).distanceTo(to) < this.point(best).distanceTo(to) ? one : best));
  }

  // The boundary loop that comes nearest to a place, if it is near at all.
  loopNear(to: Vector3): number | null {
    let best: number | null = null;
    let nearest = 0.12 * this.bounds.radius;
    this.mesh.loops.forEach((loop, number) => {
      for (const here of loop) {
        const away = this.point(here).distanceTo(to);
        if (away >= nearest) continue;
        nearest = away;
        best = number;
      }
    });
    return best;
  }

  // Straight from point to point: the daemon finds the way over the surface.
  way(fileVertices: readonly number[]): number[] {
    const points = fileVertices.map((vertex) => this.pointOf(vertex)).filter((point) => point !== null);
    const last = points.length < 3 ? points.length - 1 : points.length;
    return points.slice(0, last).flatMap((point, k) => [...point.toArray(), ...(points[(k + 1) % points.length] ?? point).toArray()]);
  }

  segments(rings: readonly ArrayLike<number>[]): Float32Array {
    const ends: number[] = [];
    for (const ring of rings) {
      for (let k = 0; k < ring.length; k += 1) {
        ends.push(...this.point(ring[k] ?? 0).toArray(), ...this.point(ring[(k + 1) % ring.length] ?? 0).toArray());
      }
    }
    return Float32Array.from(ends);
  }
}

// The triangles apart from each other, each in the colour of its cylinder.
class Tinted {
  readonly geometry: BufferGeometry;
  readonly skin: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly colours: Float32Array;

  constructor(whole: BufferGeometry) {
    this.geometry = whole.toNonIndexed();
    this.colours = new Float32Array(this.geometry.getAttribute('position').array.length);
    this.geometry.setAttribute('color', new BufferAttribute(this.colours, 3));
    this.skin = new Mesh(
      this.geometry,
      new MeshLambertMaterial({ side: DoubleSide, flatShading: true, vertexColors: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
    );
  }

  paint(ofTriangle: Uint32Array, chosen: number | null, plain: Color): void {
    ofTriangle.forEach((edge, triangle) => {
      const colour = new Color(cylinderColour(edge));
      if (chosen !== null && edge !== chosen) colour.lerp(plain, kFaded);
      for (let corner = 0; corner < 3; corner += 1) colour.toArray(this.colours, 9 * triangle + 3 * corner);
    });
    const attribute = this.geometry.getAttribute('color');
    attribute.needsUpdate = true;
  }

  dispose(): void {
    this.geometry.dispose();
    this.skin.material.dispose();
  }
}

function lines(colourless: LineMaterial, segments: Float32Array): LineSegments2 | null {
  return segments.length === 0 ? null : new LineSegments2(new LineSegmentsGeometry().setPositions(segments), colourless);
}

// Throws if the browser has no WebGL.
export function createPickScene(canvas: HTMLCanvasElement, mesh: Welded): PickScene {
  const model = new PickModel(mesh);
  const stage = new Stage(canvas, model.bounds, mesh.positions);
  const skin = new Mesh(
    model.geometry,
    new MeshLambertMaterial({ side: DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
  );
  const rim = new LineMaterial({ linewidth: 3 });
  const path = new LineMaterial({ linewidth: 4, depthTest: false });
  const ball = new SphereGeometry(kBallRadius * model.bounds.radius, 18, 12);
  const spot = new MeshBasicMaterial({ depthTest: false, transparent: true });
  const rims = lines(rim, model.segments(mesh.loops));
  stage.scene.add(skin);
  if (rims !== null) stage.scene.add(rims);
  let marked: (Mesh | LineSegments2)[] = [];
  let tinted: Tinted | null = null;
  const raycaster = new Raycaster();

  function clear(): void {
    for (const one of marked) {
      stage.scene.remove(one);
      if (one.geometry !== ball) one.geometry.dispose();
    }
    marked = [];
  }

  return {
    at(clientX, clientY) {
      const box = canvas.getBoundingClientRect();
      const spotAt = new Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
      raycaster.setFromCamera(spotAt, stage.camera);
      const hit = raycaster.intersectObject(skin)[0];
      if (hit === undefined || hit.faceIndex === null || hit.faceIndex === undefined) return null;
      const here = model.nearestOf(hit.faceIndex, hit.point);
      return { vertex: mesh.fileVertex[here] ?? 0, loop: model.loopNear(hit.point), triangle: hit.faceIndex };
    },
    mark({ vertices, paths, loops }) {
      clear();
      for (const vertex of [...vertices, ...paths.flat()]) {
        const point = model.pointOf(vertex);
        if (point === null) continue;
        const one = new Mesh(ball, spot);
        one.position.copy(point);
        one.renderOrder = 2;
        marked.push(one);
      }
      const rings = model.segments(loops.map((number) => mesh.loops[number] ?? []));
      const chosen = lines(path, Float32Array.from([...rings, ...paths.flatMap((vertices) => model.way(vertices))]));
      if (chosen !== null) marked.push(chosen);
      if (marked.length > 0) stage.scene.add(...marked);
      stage.draw();
    },
    tint(ofTriangle, chosen) {
      skin.visible = ofTriangle === null;
      if (ofTriangle !== null) {
        if (tinted === null) stage.scene.add((tinted = new Tinted(model.geometry)).skin);
        tinted.paint(ofTriangle, chosen, skin.material.color);
      }
      if (tinted !== null) tinted.skin.visible = ofTriangle !== null;
      stage.draw();
    },
    turn: (dx, dy) =>
      stage.move((around) => {
        around.theta -= dx;
        around.phi -= dy;
      }),
    zoom: (factor) => stage.move((around) => (around.radius /= factor)),
    reset: () => stage.reset(),
    paint(palette) {
      skin.material.color.set(palette.surface);
      rim.color.set(palette.weft);
      path.color.set(palette.mark);
      spot.color.set(palette.mark);
      stage.draw();
    },
    dispose() {
      clear();
      tinted?.dispose();
      model.geometry.dispose();
      rims?.geometry.dispose();
      for (const one of [skin.material, rim, path, spot, ball]) one.dispose();
      stage.dispose();
    },
  };
}
