// The pictures of the assembly guide: what lies already in its own colours, the strips of the step lit up,
// the rest as faint lines. Loaded on demand, with three.js.

import {
  type BufferGeometry,
  ConeGeometry,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Sphere,
  SphereGeometry,
  Vector3,
} from 'three';

import type { Family, QuadMesh } from '../../api/package_files.ts';
import { buildRibbons } from '../../state/ribbons.ts';
import type { StripIndex } from '../../state/strip_index.ts';
import { edgeGeometry, quadsOf, ribbonGeometry, stepsFor, surfaceGeometry } from './geometry.ts';
import type { Palette } from './palette.ts';
import { Stage } from './stage.ts';

export interface GuideContent {
  readonly mesh: QuadMesh;
  readonly warpOnTop: Uint8Array;
  readonly index: StripIndex;
}

// What one picture shows.
export interface GuideShot {
  readonly laid: ReadonlySet<string>;
  readonly current: readonly string[];
  readonly arrow: string | null; // A strip whose beginning and direction are shown.
  readonly quad: number | null; // The crossing at hand.
}

export interface GuideScene {
  show(shot: GuideShot): void;
  face(strips: readonly string[]): void; // Turns the model so that these strips are seen best.
  turn(dx: number, dy: number): void;
  zoom(factor: number): void;
  paint(palette: Palette): void;
  copyTo(canvas: HTMLCanvasElement): void; // The picture as it is now.
  dispose(): void;
}

interface Part {
  readonly laid: Mesh<BufferGeometry, MeshLambertMaterial>;
  readonly now: Mesh<BufferGeometry, MeshLambertMaterial>;
}

class GuideModel {
  readonly surface: BufferGeometry;
  readonly bounds: Sphere;
  readonly parts: Readonly<Record<Family, Part>>;
  readonly edges: LineSegments<BufferGeometry, LineBasicMaterial>;
  readonly arrow: Mesh<ConeGeometry, MeshBasicMaterial>;
  readonly spot: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly ribbons: Readonly<Record<Family, BufferGeometry>>;
  private readonly made: BufferGeometry[] = [];

  constructor(private readonly content: GuideContent) {
    const { mesh, warpOnTop } = content;
    const steps = stepsFor(mesh.quadCount);
    const ribbon = (family: Family): BufferGeometry => ribbonGeometry(buildRibbons(mesh, warpOnTop, family, { steps }));
    this.surface = surfaceGeometry(mesh);
    this.bounds = this.surface.boundingSphere ?? new Sphere();
    this.ribbons = { weft: ribbon('weft'), warp: ribbon('warp') };
    const part = (family: Family): Part => ({
      laid: new Mesh(quadsOf(this.ribbons[family], []), new MeshLambertMaterial({ side: DoubleSide, vertexColors: true })),
      now: new Mesh(quadsOf(this.ribbons[family], []), new MeshLambertMaterial({ side: DoubleSide, vertexColors: true })),
    });
    this.parts = { weft: part('weft'), warp: part('warp') };
    this.edges = new LineSegments(edgeGeometry(mesh, this.surface), new LineBasicMaterial({ transparent: true, opacity: 0.28 }));
    const size = this.bounds.radius;
    this.arrow = new Mesh(new ConeGeometry(0.028 * size, 0.085 * size, 20), new MeshBasicMaterial());
    this.spot = new Mesh(new SphereGeometry(0.022 * size, 20, 14), new MeshBasicMaterial({ depthTest: false, transparent: true }));
    this.spot.renderOrder = 2;
  }

  corner(quad: number, k: number): Vector3 {
    const { positions, corners } = this.content.mesh;
    const at = 3 * (corners[4 * quad + k] ?? 0);
    return new Vector3(positions[at], positions[at + 1], positions[at + 2]);
  }

  centre(quad: number): Vector3 {
    return [0, 1, 2, 3].reduce((sum, k) => sum.add(this.corner(quad, k)), new Vector3()).multiplyScalar(0.25);
  }

  normal(quad: number): Vector3 {
    const [a, b, c, d] = [0, 1, 2, 3].map((k) => this.corner(quad, k)) as [Vector3, Vector3, Vector3, Vector3];
    return c.sub(a).cross(d.sub(b)).normalize();
  }

  // Along the strip, in the direction in which it is laid.
  direction(quad: number, family: Family): Vector3 {
    const [a, b, c, d] = [0, 1, 2, 3].map((k) => this.corner(quad, k)) as [Vector3, Vector3, Vector3, Vector3];
    const along = family === 'weft' ? b.add(c).sub(a).sub(d) : c.add(d).sub(a).sub(b);
    return along.normalize();
  }

  fill(part: Part, family: Family, laid: readonly number[], now: readonly number[]): void {
    for (const [mesh, quads] of [[part.laid, laid], [part.now, now]] as const) {
      mesh.geometry = quadsOf(this.ribbons[family], quads);
      mesh.visible = quads.length > 0;
      this.made.push(mesh.geometry);
    }
    // They share the ribbons' vertices, which only the ribbons themselves give back.
    if (this.made.length > 64) this.made.splice(0, 32).forEach((old) => old.setIndex(null));
  }

  dispose(): void {
    for (const family of ['weft', 'warp'] as const) {
      this.ribbons[family].dispose();
      this.parts[family].laid.material.dispose();
      this.parts[family].now.material.dispose();
    }
    for (const one of [this.surface, this.edges.geometry, this.arrow.geometry, this.spot.geometry]) one.dispose();
    for (const one of [this.edges.material, this.arrow.material, this.spot.material]) one.dispose();
  }
}

// Throws if the browser has no WebGL.
export function createGuideScene(canvas: HTMLCanvasElement, content: GuideContent): GuideScene {
  const { index } = content;
  const model = new GuideModel(content);
  const stage = new Stage(canvas, model.bounds, content.mesh.positions);
  const { weft, warp } = model.parts;
  stage.scene.add(weft.laid, weft.now, warp.laid, warp.now, model.edges, model.arrow, model.spot);

  const quadsIn = (family: Family, ids: Iterable<string>): readonly number[] =>
    [...ids].flatMap((id) => {
      const strip = index.strips.get(id);
      return strip?.family === family ? [...strip.quads] : [];
    });

  function putArrow(id: string | null): void {
    const strip = id === null ? undefined : index.strips.get(id);
    const first = strip?.quads[0];
    model.arrow.visible = strip !== undefined && first !== undefined;
    if (strip === undefined || first === undefined) return;
    const along = model.direction(first, strip.family);
    const lift = 0.03 * model.bounds.radius;
    model.arrow.position.copy(model.centre(first)).addScaledVector(model.normal(first), lift);
    model.arrow.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along);
  }

  function show(shot: GuideShot): void {
    const current = new Set(shot.current);
    const laid = [...shot.laid].filter((id) => !current.has(id));
    for (const family of ['weft', 'warp'] as const) {
      model.fill(model.parts[family], family, quadsIn(family, laid), quadsIn(family, current));
    }
    putArrow(shot.arrow);
    model.spot.visible = shot.quad !== null;
    if (shot.quad !== null) model.spot.position.copy(model.centre(shot.quad));
    stage.draw();
  }

  return {
    show,
    face(strips) {
      const quads = strips.flatMap((id) => [...(index.strips.get(id)?.quads ?? [])]);
      const towards = quads.reduce((sum, quad) => sum.add(model.normal(quad)), new Vector3());
      // A ring looks every way alike: then the standard view does.
      if (towards.length() > 0.25 * quads.length) stage.lookFrom(towards.normalize());
      else stage.reset();
    },
    turn: (dx, dy) =>
      stage.move((around) => {
        around.theta -= dx;
        around.phi -= dy;
      }),
    zoom: (factor) => stage.move((around) => (around.radius /= factor)),
    paint(palette) {
      weft.laid.material.color.set(palette.weft);
      warp.laid.material.color.set(palette.warp);
      for (const part of [weft, warp]) part.now.material.color.set(palette.mark);
      model.edges.material.color.set(palette.ghost);
      model.arrow.material.color.set(palette.critical);
      model.spot.material.color.set(palette.critical);
      stage.draw();
    },
    copyTo(target) {
      stage.renderer.render(stage.scene, stage.camera);
      target.getContext('2d')?.drawImage(canvas, 0, 0, target.width, target.height);
    },
    dispose() {
      model.dispose();
      stage.dispose();
    },
  };
}
